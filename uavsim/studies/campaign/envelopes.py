"""Quantiles over many flights at each time, each with its distribution-free band.

At one time the band of a quantile is that of `studies.quantiles`: two order statistics of the flights that still fly
then. It holds at each time on its own, not for the curve as a whole: neighbouring times are alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.quantiles import quantile_ranks

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """A quantile at each time and its band, shape (n,) each; NaN where there are no flights, or too few for a bound."""

    probability: float
    value: Array
    low: Array
    high: Array


def envelopes(values: Array, probabilities: Sequence[float], confidence: float = 0.95) -> list[Envelope]:
    """Estimate quantiles over flights at each time.

    Parameters
    ----------
    values
        Shape (flights, n); NaN where a flight has no value, inf is above all others.
    probabilities
        Of the quantiles, 0 … 1 exclusive.
    confidence
        Two-sided, of each band at each time.
    """
    ordered = np.sort(values, axis=0)  # NaN last
    counts = np.asarray(np.isfinite(values) | np.isinf(values)).sum(axis=0)
    found = []
    for probability in probabilities:
        value, low, high = (np.full(values.shape[1], np.nan) for _ in range(3))
        for count in np.unique(counts[counts > 0]):
            at = counts == count
            column = ordered[:, at]
            place = probability * (count - 1)
            below, above = column[int(np.floor(place))], column[int(np.ceil(place))]
            with np.errstate(invalid="ignore"):
                value[at] = np.where(below == above, below, below + (place % 1.0) * (above - below))
            first, last = quantile_ranks(int(count), probability, confidence)
            if first >= 1:
                low[at] = column[first - 1]
            if last <= count:
                high[at] = column[last - 1]
        found.append(Envelope(probability, value, low, high))
    return found


def mean_square_band(
    squares: Array, confidence: float = 0.95, *, resamples: int = 200, seed: int = 0
) -> tuple[Array, Array]:
    """Percentile bootstrap over flights of the root of the mean square at each time.

    Parameters
    ----------
    squares
        Shape (flights, n); NaN where a flight has no value.
    resamples, seed
        Of the bootstrap; its own stream, so the same data give the same band.
    """
    m = len(squares)
    weights = np.random.default_rng(seed).multinomial(m, np.full(m, 1.0 / m), size=resamples).astype(np.float64)
    there = np.isfinite(squares)
    with np.errstate(invalid="ignore", divide="ignore"):
        roots = np.sqrt((weights @ np.where(there, squares, 0.0)) / (weights @ there))
    tail = 50.0 * (1.0 - confidence)
    known = np.isfinite(roots).all(axis=0)
    low, high = (np.full(squares.shape[1], np.nan) for _ in range(2))
    if known.any():
        low[known], high[known] = np.percentile(roots[:, known], (tail, 100.0 - tail), axis=0)
    return low, high
