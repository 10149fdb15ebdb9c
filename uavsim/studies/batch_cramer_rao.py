"""Several flights against the bound: the least that their readings allow, and how near the estimator came.

The information is averaged over the courses of the first 60 flights, `studies.cramer_rao`. The schedule of readings is
that of a whole flight that was kept. Both errors are root mean squares in the bins of the campaign's error traces.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.airspeed_flights import bound, together
from uavsim.studies.batch import Batch
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP

Array = NDArray[np.float64]

FEWEST = 2  # flights, from which on something is averaged
STRETCHES = {"first_2_s": (0.1, 2.0), "after": (2.0, np.inf)}  # s since the true launch


@dataclass(frozen=True, slots=True)
class AgainstBound:
    """Errors over the flights in one stretch of time, m/s: the estimator's, the bound's, and the first over the second.

    Attributes
    ----------
    rmse, bound, ratio : float
    """

    rmse: float
    bound: float
    ratio: float


def least_error(flown: Batch) -> tuple[Array, Array] | None:
    """Middles of bins, s since the true launch, and the least standard deviation there, m/s.

    None without enough courses of the aided estimator, or a flight whose schedule can be taken.
    """
    courses = [trace.course for trace in flown.traces if trace.course is not None]
    flight = next(iter(flown.kept.values()), None)
    if len(courses) < FEWEST or flight is None or flight.score["launch"]["detected_time"] is None:
        return None
    t, sd = bound(flight, together(courses))
    if not np.isfinite(sd).all():
        return None
    bins = np.floor((t - ERROR_START) / ERROR_STEP).astype(int)
    middles = ERROR_START + ERROR_STEP * (np.arange(bins[0], bins[-1] + 1) + 0.5)
    counts = np.maximum(np.bincount(bins - bins[0]), 1)
    return middles, np.sqrt(np.bincount(bins - bins[0], sd**2) / counts)


def against_bound(flown: Batch) -> dict[str, AgainstBound]:
    """Return, for each of `STRETCHES` that the flights reach, how near they came; empty without a bound."""
    least = least_error(flown)
    if least is None:
        return {}
    time, allowed = least
    errors = np.full((len(flown.traces), time.size), np.nan)
    offset = round((time[0] - ERROR_START) / ERROR_STEP - 0.5)
    for row, trace in zip(errors, flown.traces, strict=True):
        values = trace.filtered[offset : offset + time.size]
        row[: values.size] = values
    found = {}
    for name, (start, end) in STRETCHES.items():
        part = (time >= start) & (time < end)
        there = np.isfinite(errors[:, part])
        if there.any():
            rmse = float(np.sqrt(np.mean(errors[:, part][there] ** 2)))
            limit = float(np.sqrt(np.mean(np.broadcast_to(allowed[part] ** 2, there.shape)[there])))
            found[name] = AgainstBound(rmse, limit, rmse / limit)
    return found
