"""One flight of a campaign: its row, its airspeed error on a common time axis, and the flight itself if it is kept.

A flight is a function of its plan and its position alone. It is bounded in steps; a limit of time on a clock ends it
without a row, for a row depends on nothing that a clock says.
"""

import math
import time
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uavsim.cosim import CHUNK, Cosimulation
from uavsim.flight import Flight
from uavsim.onboard.airspeed.kinds import is_aided
from uavsim.scenario import Scenario
from uavsim.score import HIDDEN
from uavsim.score_keys import NUMBERS
from uavsim.studies.airspeed_flights import Course, course
from uavsim.studies.campaign.keep import Keep
from uavsim.studies.campaign.plan import Plan
from uavsim.studies.engine import TimeUp

ERROR_STEP = 0.1  # s, bin of the common time axis of errors
ERROR_START = -1.0  # s after the true launch at which it begins
COURSES = 60  # flights whose courses are kept; the information of the bound is averaged over them
TRACED = 1000  # flights whose errors over time are kept; quantiles over more of them look no different
APART = (
    "seed",
    "outcome",
    "versions",
    "plugins",
    "requirements",
    "remarks",
)  # of a score: not of a row, or by another name
WHOLE = ("index", "seed", "run", "replicate", "stream")  # columns of whole numbers; all other numbers have a fraction

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ErrorTrace:
    """Airspeed error of one flight against time since the true launch.

    Attributes
    ----------
    seed : int
    filtered, raw : ndarray
        Binned rms, m/s.
    nees : ndarray
        (Error over claimed standard deviation)² of the last row of each bin; NaN without one, and below V*.
    course : Course or None
        Of the first `COURSES` flights with the aided estimator: what its bound is computed from.
    index : int
        Of the flight in its campaign.
    """

    seed: int
    filtered: Array
    raw: Array
    nees: Array
    course: Course | None = None
    index: int = 0


class Flown(NamedTuple):
    """What a flight gave.

    Attributes
    ----------
    row : dict
        Plain values by column.
    trace : ErrorTrace or None
        Of the first `TRACED`.
    flight : Flight or None
        If it is kept.
    """

    row: dict[str, Any]
    trace: ErrorTrace | None
    flight: Flight | None


def fly_position(plan: Plan, keep: Keep, limit: float | None, position: int) -> Flown:
    """Fly one.

    Parameters
    ----------
    plan, position
        Which.
    keep
        Whether the whole flight comes back.
    limit
        Time on a clock that it may take, s.

    Raises
    ------
    TimeUp
        It took longer.
    ValueError
        What it drew cannot be flown; one line.
    """
    scenario = plan.flight(position)
    flight = _fly(scenario, limit)
    row = row_of(flight, index=plan.index(position), columns=plan.columns(position))
    traced = (
        trace(flight, scenario, plan.index(position), with_course=position < COURSES) if position < TRACED else None
    )
    return Flown(row, traced, flight if keep.wants(position, row) else None)


def _fly(scenario: Scenario, limit: float | None) -> Flight:
    simulation = Cosimulation(scenario)
    end = math.inf if limit is None else time.monotonic() + limit
    while not simulation.ended:
        simulation.advance(CHUNK)
        if time.monotonic() > end:
            raise TimeUp(f"it took longer than {limit:g} s")
    return simulation.finish()


def row_of(flight: Flight, *, index: int, columns: dict[str, Any]) -> dict[str, Any]:
    """Return a flight's row: who it is, what it drew, and its score with keys joined by dots."""
    score = flight.score
    flat = _flat({name: value for name, value in score.items() if name not in APART})
    told = {"index": index, "seed": score["seed"], "outcome": score["outcome"], **columns, **flat}
    row = {name: _plain(name, value) for name, value in told.items()}
    return {**row, "requirements.met": all(r["met"] for r in score["requirements"])}


def _plain(name: str, value: Any) -> Any:
    """Whole numbers only where a column never lacks one: a column has one type in all parts of a table."""
    if value is None:
        return math.nan
    if isinstance(value, bool) and name in NUMBERS:
        return float(value)  # it may be null in another flight
    return float(value) if isinstance(value, int) and not isinstance(value, bool) and name not in WHOLE else value


def _flat(value: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, item in value.items():
        if isinstance(item, dict):
            flat |= _flat(item, f"{prefix}{key}.")
        else:
            flat[prefix + key] = item
    return flat


def as_expected(row: dict[str, Any]) -> bool:
    """Whether a flight ended as its scenario expects and met its requirements."""
    return bool(row["outcome"] == row["expected"] and row["requirements.met"])


# -- errors over time --------------------------------------------------------------------------------------------------


def trace(flight: Flight, scenario: Scenario, index: int, *, with_course: bool) -> ErrorTrace:
    """Return a flight's airspeed errors over time; empty if it was never launched."""
    true_time = flight.score["launch"]["true_time"]
    if true_time is None:
        empty = np.empty(0)
        return ErrorTrace(flight.score["seed"], empty, empty, empty, index=index)
    estimate, truth = flight.estimate, flight.truth
    time = estimate["t"].to_numpy(float)
    airspeed = np.interp(time, truth["t"].to_numpy(), truth["airspeed"].to_numpy())
    bins = np.floor((time - true_time - ERROR_START) / ERROR_STEP).astype(int)
    filtered, raw = (
        _binned_rms(estimate[column].to_numpy(float) - airspeed, bins) for column in ("airspeed", "airspeed_raw")
    )
    bounded = is_aided(scenario.estimator.kind) and flight.score["launch"]["detected_time"] is not None
    return ErrorTrace(
        flight.score["seed"],
        filtered,
        raw,
        nees=_last_nees(estimate["airspeed"].to_numpy(float), airspeed, estimate["airspeed_sd"].to_numpy(float), bins),
        course=course(flight) if with_course and bounded and flight.score["airspeed"]["rmse"] is not None else None,
        index=index,
    )


def _last_nees(speed: Array, true: Array, sd: Array, bins: NDArray[np.int_]) -> Array:
    """NEES of the last row of each bin; rows below V* say nothing."""
    found = np.full(int(bins.max(initial=-1)) + 1, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        nees = np.where((sd > 0.0) & (speed >= HIDDEN * sd), ((speed - true) / sd) ** 2, np.nan)
    use = bins >= 0
    found[bins[use]] = nees[use]  # of several the last one stays
    return found


def _binned_rms(error: Array, bins: NDArray[np.int_]) -> Array:
    use = (bins >= 0) & np.isfinite(error)
    count = np.bincount(bins[use])
    total = np.bincount(bins[use], error[use] ** 2)
    rms = np.full(count.size, np.nan)
    np.divide(total, count, out=rms, where=count > 0)
    np.sqrt(rms, out=rms)
    return rms
