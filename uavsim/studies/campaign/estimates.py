"""Intervals of what a fixed number of flights shows; one number a flight, for samples within one are not independent.

    share       exact binomial (Clopper & Pearson)              `uavsim.studies.intervals`
    rate        exact Poisson (Garwood)                         `uavsim.studies.intervals`
    quantile    between order statistics, distribution-free     `uavsim.studies.quantiles`
    mean        Student's, or the studentised bootstrap         below
    ratio       of sums, the studentised bootstrap over flights below

They are two-sided: each bound errs with (1 - confidence)/2. **A one-sided bound at confidence c is that side of the
two-sided interval at 2 c - 1** (`one_sided`). The upper 95 % bound of p95 needs 59 flights (0.95⁵⁹ < 0.05), that of p99
299; with fewer there is none, and None says so.

**Means.** Student's bound errs by φ(z) γ (2 z² + 1)/(6 √n) on each side, to first order in 1/√n, where γ is the
skewness (Hall, The Bootstrap and Edgeworth Expansion, 1992, 2.6). Where that is less than a tenth of the error that is
asked for, with the sample's γ, Student's is taken. Else the bootstrap of the studentised mean is, which has no error
of that order, or Student's bound where that lies further out. Which it was is what `method` says. Below 20 flights
nobody can tell the shape, and there is no interval; nor is there one where all flights have the same value.

**Ratios.** A figure that pools what happens within flights, such as the mean square error over all samples of all
flights, is a ratio of sums Σa/Σb over flights. Whole flights are drawn again, never samples.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.intervals import rate_interval, share_interval
from uavsim.studies.quantiles import quantile_ranks

Floats = NDArray[np.float64]

LEAST = 20  # flights that an interval of a mean or a ratio needs
NEGLIGIBLE_SHARE = 0.1  # of the error that is asked for: what skewness may add before the bootstrap is taken
LEAST_BEYOND = 10  # resamples that must lie beyond a bound
MOST_RESAMPLES = 20_000
CHUNK = 200_000  # numbers drawn at once: as much as a processor's cache holds
STUDENT, BOOTSTRAP, NONE = "Student", "studentised bootstrap", "none"


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure with its bounds; None where there are too few flights for one.

    Attributes
    ----------
    value
        Of the sample.
    low, high
        Bounds of the true value.
    method
        How they were found.
    """

    value: float | None
    low: float | None
    high: float | None
    method: str


def one_sided(confidence: float) -> float:
    """Confidence of the two-sided interval whose sides each hold with the one that is given."""
    return 2.0 * confidence - 1.0


def share(count: int, trials: int, confidence: float = 0.95) -> Estimate:
    """Probability of what came true in `count` of `trials` flights."""
    return Estimate(count / trials, *share_interval(count, trials, confidence), "exact binomial")


def rate(count: int, exposure: float, confidence: float = 0.95) -> Estimate:
    """Rate of what came `count` times in an exposure, one over its unit."""
    return Estimate(count / exposure, *rate_interval(count, exposure, confidence), "exact Poisson")


def quantile(values: Floats, probability: float, confidence: float = 0.95) -> Estimate:
    """Quantile of one value a flight.

    Parameters
    ----------
    values
        Shape (n,); ±inf stands for what has no value and is worse than any.
    probability
        Of the quantile, 0 … 1 exclusive.
    confidence
        Two-sided.
    """
    ordered = np.sort(values)
    low, high = quantile_ranks(ordered.size, probability, confidence)
    middle = float(np.quantile(ordered, probability, method="higher"))
    return Estimate(
        _finite(middle),
        _finite(ordered[low - 1]) if low >= 1 else None,
        _finite(ordered[high - 1]) if high <= ordered.size else None,
        "order statistics",
    )


def mean(values: Floats, confidence: float = 0.95) -> Estimate:
    """Mean of one value a flight, shape (n,), finite."""
    low, high, method = mean_bounds(values, 0.5 * (1.0 - confidence))
    return Estimate(_finite(values.mean()), _finite(low), _finite(high), method)


def mean_bounds(values: Floats, tail: float) -> tuple[float, float, str]:
    """Bounds of a mean that each err with the probability `tail`; ∓inf where there is none, and the method."""
    from scipy.special import ndtri, stdtrit

    n = values.size
    sd = float(values.std(ddof=1)) if n >= LEAST else 0.0
    centre = float(values.mean()) if n else np.nan
    if not sd > 1e-12 * abs(centre):
        return -np.inf, np.inf, NONE
    error = sd / np.sqrt(n)
    skewness = float(np.mean(((values - centre) / sd) ** 3))
    z = float(ndtri(1.0 - tail))
    density = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
    t = float(stdtrit(n - 1, 1.0 - tail))
    if abs(skewness) * (2.0 * z * z + 1.0) * density / (6.0 * np.sqrt(n)) <= NEGLIGIBLE_SHARE * tail:
        return centre - t * error, centre + t * error, STUDENT
    low, high = _studentised_quantiles(_studentised(values.tobytes(), b""), tail)
    return centre - max(high, t) * error, centre - min(low, -t) * error, BOOTSTRAP


def ratio(numerators: Floats, denominators: Floats, confidence: float = 0.95) -> Estimate:
    """Ratio of sums over flights, Σ numerators / Σ denominators.

    Parameters
    ----------
    numerators, denominators
        Shape (n,), finite, one of each a flight; the sum of the denominators is above 0.
    confidence
        Two-sided.
    """
    value = float(numerators.sum() / denominators.sum())
    n = numerators.size
    error = float(_ratio_error(numerators, denominators, np.asarray(value)))
    if n < LEAST or not error > 0.0:
        return Estimate(value, None, None, NONE)
    tail = 0.5 * (1.0 - confidence)
    low, high = _studentised_quantiles(_studentised(numerators.tobytes(), denominators.tobytes()), tail)
    return Estimate(value, _finite(value - high * error), _finite(value - low * error), BOOTSTRAP)


def _ratio_error(numerators: Floats, denominators: Floats, value: Floats) -> Floats:
    """Standard error of ratios, linearised; flights are the last axis."""
    residuals = numerators - value[..., None] * denominators
    error: Floats = residuals.std(axis=-1, ddof=1) / denominators.mean(axis=-1) / np.sqrt(numerators.shape[-1])
    return error


@lru_cache(maxsize=64)
def _studentised(numerators: bytes, denominators: bytes) -> Floats:
    """Sorted studentised errors of resampled means, or ratios; the draws depend on the number of flights alone."""
    a = np.frombuffer(numerators)
    b = np.frombuffer(denominators) if denominators else None
    rng, found, left = np.random.default_rng(a.size), [], MOST_RESAMPLES
    while left:
        size = min(left, max(1, CHUNK // a.size))
        drawn = rng.integers(0, a.size, (size, a.size), dtype=np.int32)
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = _of_means(a, drawn) if b is None else _of_ratios(a, b, drawn)
        found.append(np.nan_to_num(errors, nan=0.0, posinf=np.inf, neginf=-np.inf))
        left -= size
    return np.sort(np.concatenate(found))


def _of_means(values: Floats, drawn: NDArray[np.int32]) -> Floats:
    """Errors of the means of resamples over their own standard errors."""
    n = values.size
    again = (values - values.mean())[drawn]
    total = again.sum(axis=1)
    square = np.maximum(np.einsum("ij,ij->i", again, again) - total**2 / n, 0.0)
    errors: Floats = total / np.sqrt(square * n / (n - 1.0))
    return errors


def _of_ratios(numerators: Floats, denominators: Floats, drawn: NDArray[np.int32]) -> Floats:
    """Errors of the ratios of resamples over their own standard errors."""
    tops, bottoms = numerators[drawn], denominators[drawn]
    values = tops.sum(axis=1) / bottoms.sum(axis=1)
    errors: Floats = (values - numerators.sum() / denominators.sum()) / _ratio_error(tops, bottoms, values)
    return errors


def _studentised_quantiles(errors: Floats, tail: float) -> tuple[float, float]:
    """Quantiles at both tails; ∓inf where fewer resamples than `LEAST_BEYOND` lie beyond."""
    beyond = int(tail * (errors.size + 1))
    if beyond < LEAST_BEYOND:
        return -np.inf, np.inf
    return float(errors[beyond - 1]), float(errors[-beyond])


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
