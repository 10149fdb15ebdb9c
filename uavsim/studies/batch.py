"""The same scenario flown with several seeds.

Each flight is one process's work from its seed alone, so the result does not depend on how many work or in which order
they finish. Of every flight its score is kept as one row, and its airspeed error on a common time axis; whole flights
are kept only where somebody will want to look: the first, and those that did not end as expected.
"""

import math
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.cosim import draw, flown
from uavsim.flight import Flight
from uavsim.interrupts import Interrupts
from uavsim.onboard.airspeed.kinds import is_aided
from uavsim.plugins import load, loaded
from uavsim.scenario import Scenario, scenario_of
from uavsim.score import HIDDEN
from uavsim.studies.airspeed_flights import Course, course
from uavsim.studies.processes import each

if TYPE_CHECKING:
    import pandas as pd

ERROR_STEP = 0.1  # s, bin of the common time axis of errors
COURSES = 60  # flights whose courses are kept; the information of the bound is averaged over them
APART = (
    "seed",
    "outcome",
    "versions",
    "plugins",
    "requirements",
    "remarks",
)  # of a score: not of a row, or by another name
ERROR_START = -1.0  # s after the true launch at which it begins

Progress = Callable[[int, int], None]
"""Called with the number of finished flights and of all."""
Result = tuple[dict[str, Any], "ErrorTrace", Flight | None]
"""Row, errors, and the flight itself if it is kept."""
Finished = Callable[[list[tuple[int, Result]]], None]
"""Called with flights' positions among the seeds and what they gave; nothing interrupts it."""


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
    """

    seed: int
    filtered: NDArray[np.float64]
    raw: NDArray[np.float64]
    nees: NDArray[np.float64]
    course: Course | None = None


@dataclass(frozen=True)
class Batch:
    """What several flights gave.

    Attributes
    ----------
    runs
        A row a flight: index, seed, outcome, what was drawn (`draw.…`) and the score's keys joined by dots.
    traces
        Airspeed errors, in the order of `runs`.
    kept
        Whole flights by seed.
    complete
        False if it was interrupted, or a flight could not be flown.
    wall_time
        s.
    lost
        Seeds of flights that could not be flown: their process died twice.
    """

    scenario: Scenario
    runs: "pd.DataFrame"
    traces: list[ErrorTrace]
    kept: dict[int, Flight]
    complete: bool
    wall_time: float
    lost: tuple[int, ...] = ()

    @property
    def error_time(self) -> NDArray[np.float64]:
        """Middles of the bins of `traces`, s after the true launch."""
        count = max((trace.filtered.size for trace in self.traces), default=0)
        return np.asarray(ERROR_START + ERROR_STEP * (np.arange(count) + 0.5), dtype=np.float64)


def fly_seeds(
    scenario: Scenario,
    seeds: list[int],
    *,
    workers: int | None = None,
    progress: Progress | None = None,
    keep: Finished | None = None,
) -> Batch:
    """Fly a scenario once a seed.

    Parameters
    ----------
    scenario
        What to fly; its own seed is not used.
    seeds
        One flight each.
    workers
        Processes that fly; None: one a processor.
    progress
        Called after each flight.
    keep
        Called with what is finished before it counts as finished: writes it down.

    Returns
    -------
    Batch
        Rows and traces in the order of `seeds`, whatever order they finished in. An interrupt (Ctrl-C) ends it early:
        then it holds the flights that were finished, with `complete` false.
    """
    import pandas as pd

    scenario = scenario.checked()  # once for all flights
    started = time.monotonic()
    done: dict[int, Result] = {}
    lost: list[int] = []

    def finished(results: list[tuple[int, Result]]) -> None:
        if keep is not None:
            keep(results)
        for position, result in results:
            done[position] = result
            if progress is not None:
                progress(len(done), len(seeds))

    workers = workers or os.cpu_count() or 1
    try:
        if workers == 1 or len(seeds) <= 1:
            _in_turn(scenario, seeds, finished)
        else:
            fly_one = partial(_one_of, scenario)
            lost = each(
                fly_one,
                list(enumerate(seeds)),
                workers=min(workers, len(seeds)),
                done=finished,
                first=partial(load, loaded()),
            )
    except KeyboardInterrupt:
        pass  # what was finished tells it
    ordered = [done[position] for position in sorted(done)]
    return Batch(
        scenario=scenario,
        runs=pd.DataFrame([row for row, _, _ in ordered]),
        traces=[trace for _, trace, _ in ordered],
        kept={flight.score["seed"]: flight for _, _, flight in ordered if flight is not None},
        complete=len(done) == len(seeds),
        wall_time=time.monotonic() - started,
        lost=tuple(seeds[position] for position in lost),
    )


def _in_turn(scenario: Scenario, seeds: list[int], finished: Finished) -> None:
    for position, seed in enumerate(seeds):
        result = _one(scenario, seed, position=position)
        with Interrupts():
            finished([(position, result)])


def _one_of(scenario: Scenario, which: tuple[int, int]) -> Result:
    """Fly a seed, given with its position."""
    position, seed = which
    return _one(scenario, seed, position=position)


def _one(scenario: Scenario, seed: int, *, position: int) -> Result:
    """Fly one seed of a scenario that was checked; the whole flight comes back only if somebody will look at it."""
    own = scenario.with_seed(seed)
    flight = flown(own)
    draws = draw(own)
    row = {
        "index": 0,
        "seed": seed,
        "outcome": flight.score["outcome"],
        "draw.release_time": draws.release_time,
        "draw.force_factor": draws.force_factor,
        **_flat({name: value for name, value in flight.score.items() if name not in APART}),
        "requirements.met": all(r["met"] for r in flight.score["requirements"]),
    }
    unexpected = flight.score["outcome"] != flight.score["expected"]
    return row, _trace(flight, with_course=position < COURSES), flight if position == 0 or unexpected else None


def _flat(value: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, item in value.items():
        if isinstance(item, dict):
            flat |= _flat(item, f"{prefix}{key}.")
        else:
            flat[prefix + key] = math.nan if item is None else item
    return flat


def _trace(flight: Flight, *, with_course: bool) -> ErrorTrace:
    true_time = flight.score["launch"]["true_time"]
    if true_time is None:
        empty = np.empty(0)
        return ErrorTrace(flight.score["seed"], empty, empty, empty)
    estimate, truth = flight.estimate, flight.truth
    time = estimate["t"].to_numpy(float)
    airspeed = np.interp(time, truth["t"].to_numpy(), truth["airspeed"].to_numpy())
    bins = np.floor((time - true_time - ERROR_START) / ERROR_STEP).astype(int)
    filtered, raw = (
        _binned_rms(estimate[column].to_numpy(float) - airspeed, bins) for column in ("airspeed", "airspeed_raw")
    )
    bounded = is_aided(scenario_of(flight).estimator.kind) and flight.score["launch"]["detected_time"] is not None
    return ErrorTrace(
        flight.score["seed"],
        filtered,
        raw,
        nees=_last_nees(estimate["airspeed"].to_numpy(float), airspeed, estimate["airspeed_sd"].to_numpy(float), bins),
        course=course(flight) if with_course and bounded and flight.score["airspeed"]["rmse"] is not None else None,
    )


def _last_nees(
    speed: NDArray[np.float64], true: NDArray[np.float64], sd: NDArray[np.float64], bins: NDArray[np.int_]
) -> NDArray[np.float64]:
    """NEES of the last row of each bin; rows below V* say nothing."""
    found = np.full(int(bins.max(initial=-1)) + 1, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        nees = np.where((sd > 0.0) & (speed >= HIDDEN * sd), ((speed - true) / sd) ** 2, np.nan)
    use = bins >= 0
    found[bins[use]] = nees[use]  # of several the last one stays
    return found


def _binned_rms(error: NDArray[np.float64], bins: NDArray[np.int_]) -> NDArray[np.float64]:
    use = (bins >= 0) & np.isfinite(error)
    count = np.bincount(bins[use])
    total = np.bincount(bins[use], error[use] ** 2)
    rms = np.full(count.size, np.nan)
    np.divide(total, count, out=rms, where=count > 0)
    np.sqrt(rms, out=rms)
    return rms
