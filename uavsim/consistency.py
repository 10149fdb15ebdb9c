"""Whether an estimator knows its own error: NEES, NIS, coverage and whiteness against what chance allows.

With e the error and σ the standard deviation claimed, ν an innovation over its own standard deviation:

    NEES = (e/σ)²,    mean over m runs at one time: χ²_m/m,    1 ± 1.96·√(2/m) for many
    NIS  = ν²,        one for each scalar reading on average
    coverage at 1, 2, 3 σ of Gaussian errors: 68.27, 95.45, 99.73 %
    whiteness: autocorrelations r_k of ν over n readings, Q = n(n + 2) Σ r_k²/(n − k), χ² of as many degrees as lags

Sources: Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, 5.4.2; Ljung &
Box, Biometrika 65 (1978); for squares in place of ν: McLeod & Li, J. Time Series Analysis 4 (1983).

Errors of one run at neighbouring times are alike, so one flight proves little: its mean NEES leaves 0.9–1.1 in 15–69 %
of the cases even if all is as it should be. Ensembles decide, at each time by themselves.
"""

from dataclasses import dataclass
from math import erf, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIGMAS = (1.0, 2.0, 3.0)
EXPECTED_COVERAGE = tuple(erf(k / sqrt(2.0)) for k in SIGMAS)
LEAST = 2  # values from which on a statistic is given
LAGS = 10


def nees(error: Array, sd: Array) -> Array:
    """(e/σ)², NaN where no deviation above 0 is claimed; shapes broadcast."""
    claimed = np.where(sd > 0.0, sd, np.nan)
    found: Array = np.square(np.asarray(error, dtype=np.float64) / claimed)
    return found


def mean_band(runs: int, confidence: float = 0.95) -> tuple[float, float]:
    """Interval in which the mean over `runs` of a consistent scalar NEES or NIS lies: quantiles of χ²_m/m.

    Raises
    ------
    ValueError
        No run, or a confidence outside 0…1.
    """
    from scipy.special import chdtri

    if runs < 1 or not 0.0 < confidence < 1.0:
        raise ValueError("there must be at least one run, and a confidence between 0 and 1")
    low, high = (float(chdtri(runs, 0.5 * (1.0 - side * confidence))) / runs for side in (-1.0, 1.0))
    return low, high


def coverage(error: Array, sd: Array) -> tuple[float, float, float]:
    """Share of errors within 1, 2 and 3 claimed standard deviations; NaN without any."""
    ratio = nees(error, sd).ravel()
    ratio = ratio[np.isfinite(ratio)]
    if not ratio.size:
        return np.nan, np.nan, np.nan
    one, two, three = (float(np.mean(ratio <= k * k)) for k in SIGMAS)
    return one, two, three


def autocorrelation(sequence: Array, lags: int = LAGS) -> Array:
    """Autocorrelations at lags 1 … `lags`, shape (lags,), of a sequence from which missing values are left out.

    Raises
    ------
    ValueError
        Fewer values than lags + 2.
    """
    x = np.asarray(sequence, dtype=np.float64)
    x = x[np.isfinite(x)]
    if x.size < lags + 2:
        raise ValueError(f"{x.size} values are too few for {lags} lags")
    x = x - x.mean()
    power = float(x @ x)
    found: Array = np.array([float(x[k:] @ x[:-k]) / power if power > 0.0 else 0.0 for k in range(1, lags + 1)])
    return found


def ljung_box(sequence: Array, lags: int = LAGS) -> tuple[float, float]:
    """Return Ljung and Box's Q and the probability that white noise exceeds it.

    For a sequence of NIS, squares as they are, this is McLeod and Li's test.

    Raises
    ------
    ValueError
        Fewer values than lags + 2.
    """
    from scipy.special import chdtrc

    n = int(np.isfinite(sequence).sum())
    r = autocorrelation(sequence, lags)
    q = n * (n + 2.0) * float(np.sum(r**2 / (n - np.arange(1, lags + 1))))
    return q, float(chdtrc(lags, q))


@dataclass(frozen=True, slots=True)
class Consistency:
    """Of an ensemble, or of one flight, over some of its times; NaN where there is nothing to say.

    Attributes
    ----------
    runs, samples : int
        How many there are; times with a claim.
    nees : float
        Mean of NEES over runs and times.
    nees_inside : float
        Share of times at which the mean over the runs lies in its 95 % band.
    nis : float
        Mean of NIS per scalar reading.
    coverage : tuple of float
        At 1, 2 and 3 σ.
    white : float
        Share of runs whose innovations pass Ljung and Box's test at 5 %: 0.95 if white.
    """

    runs: int
    samples: int
    nees: float
    nees_inside: float
    nis: float
    coverage: tuple[float, float, float]
    white: float

    @property
    def warning(self) -> str:
        """What to say beside a single flight's figures."""
        return "one flight proves little: judge coverage and NEES over many" if self.runs == 1 else ""


def judge(error: Array, sd: Array, nis: Array | None = None, innovations: Array | None = None) -> Consistency:
    """Judge an ensemble over the times given.

    Parameters
    ----------
    error, sd : ndarray
        Shape (m, n) for m runs, or (n,) for one flight; m/s. NaN is left out, and a deviation of 0.
    nis : ndarray, optional
        Of scalar readings, any shape; NaN where there was none.
    innovations : ndarray, optional
        Shape (m, r) or (r,): innovations over their standard deviations, in order.
    """
    ratio = np.atleast_2d(nees(error, sd))
    known = np.isfinite(ratio)
    counts = known.sum(axis=0)
    whole = counts == len(ratio)
    low, high = mean_band(len(ratio))
    means = ratio[:, whole].mean(axis=0)
    passed = [
        ljung_box(row)[1] > 0.05
        for row in np.atleast_2d(np.empty((0, 0)) if innovations is None else innovations)
        if np.isfinite(row).sum() >= LAGS + LEAST
    ]
    measured = np.empty(0) if nis is None else nis[np.isfinite(nis)]
    return Consistency(
        runs=len(ratio),
        samples=int((counts > 0).sum()),
        nees=float(ratio[known].mean()) if known.any() else np.nan,
        nees_inside=float(np.mean((means >= low) & (means <= high))) if means.size else np.nan,
        nis=float(measured.mean()) if measured.size else np.nan,
        coverage=coverage(np.atleast_2d(error), np.atleast_2d(sd)),
        white=float(np.mean(passed)) if passed else np.nan,
    )
