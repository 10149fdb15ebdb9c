"""Quantiles of a sample with distribution-free bands.

The interval between two order statistics x_(l) and x_(u) covers the q-quantile of any continuous distribution with
probability P(l <= B < u), B binomial (n, q) (David & Nagaraja, Order Statistics, 3rd ed., 7.1). For few flights and
extreme quantiles no such interval exists; then the band is open on that side.
"""

from dataclasses import dataclass

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
    from scipy.stats import binom  # noqa: PLC0415 (a third of a second that most commands do not need)

    if sample.size == 0:
        raise ValueError("a quantile needs at least one value")
    if not 0.0 < probability < 1.0 or not 0.0 < confidence < 1.0:
        raise ValueError("probabilities must lie between 0 and 1")
    ordered = np.sort(sample)
    n, tail = ordered.size, (1.0 - confidence) / 2.0
    counts = binom.cdf(np.arange(n + 1), n, probability)  # P(B <= k)
    # x_(l) is below the quantile unless fewer than l values are: P(B <= l - 1) <= tail.
    low = int(np.searchsorted(counts, tail, side="right"))  # the largest l that satisfies it
    # x_(u) is above the quantile unless u values or more are: P(B >= u) = 1 - P(B <= u - 1) <= tail.
    high = int(np.searchsorted(counts, 1.0 - tail, side="left")) + 1
    return QuantileBand(
        probability,
        float(np.quantile(ordered, probability)),
        float(ordered[low - 1]) if low >= 1 else None,
        float(ordered[high - 1]) if high <= n else None,
    )
