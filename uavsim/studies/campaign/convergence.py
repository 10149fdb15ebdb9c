"""Running estimates: what would have been said after the first n flights, for n from 1 to all.

An estimate that still wanders by more than its interval, or an interval that is still too wide, asks for more flights.
The intervals at different n are not independent, and none of them is a test that may be stopped by looking at it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.intervals import share_interval
from uavsim.studies.quantiles import quantile_ranks

Array = NDArray[np.float64]

POINTS = 80  # numbers of flights at which estimates are made


@dataclass(frozen=True, slots=True, eq=False)
class Running:
    """An estimate and its 95 % interval after n flights, shape (m,) each; NaN where there is none."""

    n: NDArray[np.int64]
    value: Array
    low: Array
    high: Array


def sizes(flights: int, points: int = POINTS) -> NDArray[np.int64]:
    """Return numbers of flights, evenly on a logarithmic scale, from 1 to all."""
    if flights < 1:
        return np.empty(0, dtype=np.int64)
    return np.unique(np.geomspace(1, flights, points).round().astype(np.int64))


def running_share(true: NDArray[np.bool_], points: int = POINTS) -> Running:
    """Return the share of flights of which something is true, with Clopper and Pearson's interval."""
    n = sizes(true.size, points)
    counts = np.cumsum(true)[n - 1]
    bounds = np.array([share_interval(int(k), int(m)) for k, m in zip(counts, n, strict=True)]).reshape(-1, 2)
    return Running(n, counts / n, bounds[:, 0], bounds[:, 1])


def running_quantile(values: Array, probability: float, points: int = POINTS) -> Running:
    """Return a quantile of the flights that have a value, with its order-statistic interval; inf is above all."""
    n = sizes(values.size, points)
    found = np.full((3, n.size), np.nan)
    for i, m in enumerate(n):
        sample = np.sort(values[:m][~np.isnan(values[:m])])
        if not sample.size:
            continue
        place = probability * (sample.size - 1)
        below, above = sample[int(np.floor(place))], sample[int(np.ceil(place))]
        found[0, i] = below if below == above or place % 1.0 == 0.0 else below + (place % 1.0) * (above - below)
        low, high = quantile_ranks(sample.size, probability)
        if low >= 1:
            found[1, i] = sample[low - 1]
        if high <= sample.size:
            found[2, i] = sample[high - 1]
    return Running(n, *found)
