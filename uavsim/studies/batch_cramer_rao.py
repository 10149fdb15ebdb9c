"""Several flights against the bound: the least that their readings allow, and how near the estimator came.

The information is averaged over the courses of the first 60 flights, `studies.cramer_rao`. The schedule of readings is
that of a whole flight that was kept. Both errors are root mean squares in the bins of the campaign's error traces.

Both have a sampling error. That of the bound is the bootstrap's over the courses, `campaign.resampled_bound`; that of
the RMSE the bootstrap's over the flights. The interval of their ratio adds both on a logarithmic scale.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.flight import Flight, load
from uavsim.studies.airspeed_flights import NORMAL_95, bound_of, together
from uavsim.studies.batch import Batch
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP
from uavsim.studies.campaign.resampled_bound import ResampledBound

if TYPE_CHECKING:
    from uavsim.studies.campaign.many import Many

Array = NDArray[np.float64]

FEWEST = 2  # flights, from which on something is averaged
ENOUGH = 10  # flights, from which on a bootstrap over them says something
RESAMPLES = 400  # of the RMSE
TRIED = 5  # kept flights among which one that was detected is looked for
STRETCHES = {"first_2_s": (0.1, 2.0), "after": (2.0, np.inf)}  # s since the true launch


@dataclass(frozen=True, slots=True)
class AgainstBound:
    """Errors over the flights in one stretch of time, m/s: the estimator's, the bound's, and the first over the second.

    Attributes
    ----------
    rmse, bound, ratio : float
    low, high : float or None
        95 % interval of the ratio; None with fewer than `ENOUGH` flights.
    """

    rmse: float
    bound: float
    ratio: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Least:
    """The least error in bins of time, shape (n,) each.

    Attributes
    ----------
    time : ndarray
        Middles of the bins, s since the true launch.
    sd : ndarray
        Least standard deviation, m/s.
    error : ndarray
        Standard error of its logarithm, from the choice of courses.
    courses : int
        How many it is averaged over.
    """

    time: Array
    sd: Array
    error: Array
    courses: int

    @property
    def low(self) -> Array:
        """Lower 95 % bound, m/s."""
        return np.asarray(self.sd * np.exp(-NORMAL_95 * self.error), dtype=np.float64)

    @property
    def high(self) -> Array:
        """Upper 95 % bound, m/s."""
        return np.asarray(self.sd * np.exp(NORMAL_95 * self.error), dtype=np.float64)


def least_error(flown: "Batch | Many") -> Least | None:
    """Return the least error that readings allow.

    None without enough courses of the aided estimator, or a kept flight whose schedule can be taken.
    """
    courses = [trace.course for trace in flown.traces if trace.course is not None]
    flight = next(_detected(flown), None)
    if len(courses) < FEWEST or flight is None:
        return None
    t, least = bound_of(flight, together(courses), ResampledBound)
    sd = least.sd()
    if not np.isfinite(sd).all():
        return None
    bins = np.floor((t - ERROR_START) / ERROR_STEP).astype(int)
    middles = ERROR_START + ERROR_STEP * (np.arange(bins[0], bins[-1] + 1) + 0.5)
    counts = np.maximum(np.bincount(bins - bins[0]), 1)
    with np.errstate(all="ignore"):
        errors = np.std(np.log(np.array(least.resampled)), axis=1, ddof=1)
    known = np.isfinite(errors)
    error = np.interp(middles, t[least.at][known], errors[known]) if known.any() else np.zeros(middles.size)
    return Least(middles, np.sqrt(np.bincount(bins - bins[0], sd**2) / counts), error, len(courses))


def _detected(flown: "Batch | Many") -> Iterator[Flight]:
    """Yield kept flights whose launch was detected."""
    for kept in list(flown.kept.values())[:TRIED]:
        flight = load(kept) if isinstance(kept, Path) else kept
        if flight.score["launch"]["detected_time"] is not None:
            yield flight


def against_bound(flown: "Batch | Many") -> dict[str, AgainstBound]:
    """Return, for each of `STRETCHES` that the flights reach, how near they came; empty without a bound.

    A flight whose error is far beyond all others' would decide the mean alone; it is left out.
    """
    from uavsim.studies.campaign.far import far_traces
    from uavsim.studies.campaign.many import many

    told = many(flown)
    least = told.least
    if least is None:
        return {}
    time, allowed = least.time, least.sd
    errors = np.full((len(flown.traces), time.size), np.nan)
    offset = round((time[0] - ERROR_START) / ERROR_STEP - 0.5)
    for row, trace in zip(errors, flown.traces, strict=True):
        values = trace.filtered[offset : offset + time.size]
        row[: values.size] = values
    errors = errors[~far_traces(told, time, errors)]
    found = {}
    for name, (start, end) in STRETCHES.items():
        part = (time >= start) & (time < end)
        there = np.isfinite(errors[:, part])
        if there.any():
            rmse = float(np.sqrt(np.mean(errors[:, part][there] ** 2)))
            limit = float(np.sqrt(np.mean(np.broadcast_to(allowed[part] ** 2, there.shape)[there])))
            ratio = rmse / limit
            spread = _spread(errors[:, part], float(np.mean(least.error[part])))
            bounds = (None, None) if spread is None else (ratio * exp(-spread), ratio * exp(spread))
            found[name] = AgainstBound(rmse, limit, ratio, *bounds)
    return found


def _spread(errors: Array, of_bound: float) -> float | None:
    """Half the width of the interval of the ratio's logarithm; None where flights are too few."""
    there = np.isfinite(errors)
    flew = there.any(axis=1)
    m = int(flew.sum())
    if m < ENOUGH:
        return None
    sums = np.where(there, errors**2, 0.0).sum(axis=1)[flew]
    counts = there.sum(axis=1)[flew]
    weights = np.random.default_rng(0).multinomial(m, np.full(m, 1.0 / m), size=RESAMPLES).astype(np.float64)
    with np.errstate(all="ignore"):
        logs = 0.5 * np.log((weights @ sums) / (weights @ counts))
    spread = float(np.std(logs, ddof=1))
    return NORMAL_95 * float(np.hypot(spread, of_bound)) if np.isfinite(spread) else None
