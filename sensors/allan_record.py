"""The overlapping Allan deviation of a record, and how well it is known.

With x_i the sum of the first i readings, N of them and x_0 = 0 included, at an averaging time of m readings

    σ² = 1/(2 m² (N - 2m)) Σ (x_{i+2m} - 2 x_{i+m} + x_i)²            NIST SP 1065, eq. 11

edf σ̂²/σ² is as good as χ² with edf degrees of freedom. These depend on the noise, S(f) ∝ f^α, by the correlation of
its second differences (Greenhall & Riley, "Uncertainty of stability variances based on finite differences", Proc. 35th
PTTI, 2003, eqs. 7 to 10 and table 2, here for d = 2, F = S = m): with M = N - 2m terms in the sum and r = M/m

    s_w(t) = |t|³, t⁴ ln|t|, |t|⁵                                     for α = 0, -1, -2
    s_x(t) = m² (2 s_w(t) - s_w(t - 1/m) - s_w(t + 1/m))              for m → ∞ that of α + 2, s_w: -|t|, t² ln|t|, |t|³
    s_z(t) = 6 s_x(t) - 4 s_x(t ± 1) + s_x(t ± 2)
    1/edf  = 1/(M s_z(0)²) [s_z(0)² + (1 - J/M) s_z(J/m)² + 2 Σ_{0<j<J} (1 - j/M) s_z(j/m)²],   J = min(M, 3m)

where up to 100 terms are summed. Where there would be more, 1/edf = (a₀ - a₁/r)/r with their table 2 if r > 3, else the
sum is that of 100 terms with the same r.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_TERMS = 100
LONG = {0: (2.0 / 3.0, 1.0 / 3.0), -1: (0.852, 0.375), -2: (1.079, 0.368)}
"""a₀ and a₁ by α: Greenhall & Riley's table 2, the Allan variance's column."""


def overlapping(values: Array, multiples: Sequence[int]) -> Array:
    """Return the overlapping Allan deviation at averaging times of whole readings.

    Parameters
    ----------
    values : numpy.ndarray
        Equally spaced readings, shape (n,).
    multiples : sequence of int
        m, each at least 1 and at most n/2.

    Returns
    -------
    numpy.ndarray
        In the readings' unit, one for each of `multiples`.

    Raises
    ------
    ValueError
        If an averaging time is not among these.
    """
    for m in multiples:
        if not 1 <= m <= values.size // 2:
            raise ValueError(f"an averaging time of {m} readings: must be from 1 to half of the record's {values.size}")
    summed = np.concatenate(([0.0], np.cumsum(values - values.mean())))
    return np.array([_deviation(summed, m) for m in multiples])


def _deviation(x: Array, m: int) -> float:
    second = x[2 * m :] - 2.0 * x[m:-m] + x[: -2 * m]
    return float(np.sqrt(second @ second / (2.0 * second.size)) / m)


def degrees_of_freedom(alpha: int, m: int, size: int) -> float:
    """Return the equivalent degrees of freedom of an overlapping Allan variance.

    Parameters
    ----------
    alpha : int
        Exponent of the density S(f) ∝ f^α: 0, -1 or -2.
    m : int
        Readings of the averaging time.
    size : int
        Readings of the record, at least 2 m.
    """
    terms = size + 1 - 2 * m
    ratio, lags = terms / m, min(terms, 3 * m)
    if lags <= MOST_TERMS:
        return _summed(alpha, m if 3 * m <= MOST_TERMS else None, terms, m)
    if ratio > 3.0:
        a0, a1 = LONG[alpha]
        return ratio / (a0 - a1 / ratio)
    return _summed(alpha, None, MOST_TERMS, MOST_TERMS / ratio)


def _summed(alpha: int, m: int | None, terms: int, stride: float) -> float:
    """Return the degrees of freedom by the sum over lags j, in steps of 1/stride; no m: in the limit of large m."""
    lags = min(terms, int(3 * stride))
    j = np.arange(lags + 1.0)
    weight = np.where((j > 0.0) & (j < lags), 2.0, 1.0) * (1.0 - j / terms)
    z = _correlation(j / stride, alpha, m)
    return terms * float(z[0] ** 2 / (weight @ z**2))


def _correlation(t: Array, alpha: int, m: int | None) -> Array:
    """Return s_z(t)."""
    rise = POWERS[alpha + 2] if m is None else _differences(POWERS[alpha], m)
    return 6.0 * rise(t) - 4.0 * (rise(t - 1.0) + rise(t + 1.0)) + rise(t - 2.0) + rise(t + 2.0)


def _differences(power: Callable[[Array], Array], m: int) -> Callable[[Array], Array]:
    """Return s_x of a finite m."""
    return lambda t: m * m * (2.0 * power(t) - power(t - 1.0 / m) - power(t + 1.0 / m))


def _with_logarithm(t: Array, power: int) -> Array:
    """Return t^power ln|t|, 0 at 0."""
    size = np.abs(t)
    found: Array = size**power * np.log(np.where(size > 0.0, size, 1.0))
    return found


POWERS: dict[int, Callable[[Array], Array]] = {
    2: lambda t: -np.abs(t),
    1: lambda t: _with_logarithm(t, 2),
    0: lambda t: np.abs(t) ** 3,
    -1: lambda t: _with_logarithm(t, 4),
    -2: lambda t: np.abs(t) ** 5,
}
"""s_w by α."""


def interval(deviation: Array, edf: Array, confidence: float) -> tuple[Array, Array]:
    """Return the bounds of an Allan deviation that is known with `edf` degrees of freedom (NIST SP 1065, eq. 45)."""
    from scipy.special import gammaincinv  # late: it takes a quarter of a second

    tail = 0.5 * (1.0 - confidence)
    low, high = (deviation * np.sqrt(edf / (2.0 * gammaincinv(0.5 * edf, q))) for q in (1.0 - tail, tail))
    return low, high
