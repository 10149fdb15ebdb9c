"""Quantiles of a sample with distribution-free bands.

The interval between two order statistics x_(l) and x_(u) covers the q-quantile of any continuous distribution with
probability P(l <= B < u), B binomial (n, q) (David & Nagaraja, Order Statistics, 3rd ed., 7.1). For few flights and
extreme quantiles no such interval exists; then the band is open on that side.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class QuantileBand:
    """A sample quantile and its band; None where the sample is too small for a bound."""

    probability: float
    value: float
    low: float | None
    high: float | None


def quantile_band(sample: NDArray[np.float64], probability: float, confidence: float = 0.95) -> QuantileBand:
    """Estimate a quantile with its distribution-free confidence interval.

    Parameters
    ----------
    sample
        Shape (n,), finite.
    probability
        Of the quantile, 0 … 1 exclusive.
    confidence
        Two-sided; each side is covered with (1 + confidence) / 2.

    Raises
    ------
    ValueError
        If the sample is empty or the probabilities lie outside (0, 1).
    """
    if sample.size == 0 or not np.all(np.isfinite(sample)):
        raise ValueError("a quantile needs at least one value, and finite ones")
    ordered = np.sort(sample)
    low, high = quantile_ranks(ordered.size, probability, confidence)
    return QuantileBand(
        probability,
        float(np.quantile(ordered, probability)),
        float(ordered[low - 1]) if low >= 1 else None,
        float(ordered[high - 1]) if high <= ordered.size else None,
    )


@cache
def quantile_ranks(n: int, probability: float, confidence: float = 0.95) -> tuple[int, int]:
    """Ranks, 1 … n, of the order statistics that bound a quantile; 0 and n + 1 where there is no bound.

    Raises
    ------
    ValueError
        If the probabilities lie outside (0, 1).
    """
    from scipy.stats import binom

    if not 0.0 < probability < 1.0 or not 0.0 < confidence < 1.0:
        raise ValueError("probabilities must lie between 0 and 1")
    tail = (1.0 - confidence) / 2.0
    counts = binom.cdf(np.arange(n + 1), n, probability)  # P(B <= k)
    # x_(l) is below the quantile unless fewer than l values are: P(B <= l - 1) <= tail.
    low = int(np.searchsorted(counts, tail, side="right"))  # the largest l that satisfies it
    # x_(u) is above the quantile unless u values or more are: P(B >= u) = 1 - P(B <= u - 1) <= tail.
    high = int(np.searchsorted(counts, 1.0 - tail, side="left")) + 1
    return low, high


@dataclass(frozen=True, slots=True)
class EcdfBand:
    """Share of a sample that is not above each value, a step at each, and its band.

    The first value is -inf: up to the least of the sample the share is 0, and its band is not.
    """

    value: NDArray[np.float64]
    share: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def ecdf_band(sample: NDArray[np.float64], confidence: float = 0.95) -> EcdfBand:
    """Estimate a distribution function with its pointwise exact band.

    k of n values not above x are binomial (n, F(x)), so F(x) lies between the Clopper-Pearson bounds B(tail; k, n - k
    + 1) and B(1 - tail; k + 1, n - k), quantiles of the beta distribution (Biometrika 26, 1934, 404-413).

    Parameters
    ----------
    sample
        Shape (n,); inf is what never happened: it counts in n only.
    confidence
        Two-sided, at each value on its own.

    Returns
    -------
    EcdfBand
        Shape (m + 1,) each, m the number of different finite values.

    Raises
    ------
    ValueError
        If the sample is empty or holds NaN, or the confidence lies outside (0, 1).
    """
    from scipy.stats import beta

    if sample.size == 0 or np.isnan(sample).any():
        raise ValueError("a distribution needs at least one value, and no NaN")
    if not 0.0 < confidence < 1.0:
        raise ValueError("the confidence must lie between 0 and 1")
    n, tail = sample.size, (1.0 - confidence) / 2.0
    value, counts = np.unique(sample[sample < np.inf], return_counts=True)
    k = np.concatenate([[0], np.cumsum(counts)])
    low, high = np.zeros(k.size), np.ones(k.size)
    low[1:] = beta.ppf(tail, k[1:], n - k[1:] + 1)
    some = k < n
    high[some] = beta.ppf(1.0 - tail, k[some] + 1, n - k[some])
    return EcdfBand(np.concatenate([[-np.inf], value]), k / n, low, high)
