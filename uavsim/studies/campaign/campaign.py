"""Fly a plan into its folder, and look at what is there."""

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.flight import load
from uavsim.scenario import Scenario
from uavsim.studies.campaign.flown import ErrorTrace, Flown, fly_position
from uavsim.studies.campaign.keep import Keep
from uavsim.studies.campaign.plan import Plan, position_of
from uavsim.studies.campaign.record import FLIGHTS, Record, frame, plan_in, traces
from uavsim.studies.engine import Crew, Left

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.flight import Flight

SLOWEST = 5e-3  # s a step of a plant, with the slowest plug-in that is let fly
LEAST_LIMIT = 600.0  # s

Progress = Callable[[int, int, Mapping[str, int]], None]
"""Called with the number of finished flights, of all, and how those of this run ended."""


@dataclass(frozen=True)
class Flights:
    """A campaign's folder.

    Attributes
    ----------
    folder : Path
    plan : Plan
    left : tuple of Left
        Flights that could not be flown.
    complete : bool
    wall_time : float
        s, of this run.
    """

    folder: Path
    plan: Plan
    left: tuple[Left, ...] = ()
    complete: bool = True
    wall_time: float = 0.0

    @property
    def scenario(self) -> Scenario:
        """What all flights have in common, with its dispersions."""
        return self.plan.scenario

    def frame(self, columns: list[str] | None = None) -> "pd.DataFrame":
        """Rows sorted by index; of the columns that are wanted those that there are."""
        return frame(self.folder, columns)

    @property
    def runs(self) -> "pd.DataFrame":
        """All rows: index, seed, outcome, what was drawn and varied, and the score's keys joined by dots."""
        return self.frame()

    @property
    def traces(self) -> list[ErrorTrace]:
        """Airspeed errors over time of the first flights."""
        return traces(self.folder)

    def kept(self) -> list[int]:
        """Indices of the flights that were kept."""
        folder = self.folder / FLIGHTS
        return sorted(int(p.name) for p in folder.iterdir() if p.name.isdigit()) if folder.is_dir() else []

    def flight(self, index: int) -> "Flight":
        """A flight that was kept."""
        return load(self.folder / FLIGHTS / str(index))

    def again(self, index: int) -> Scenario:
        """What flew as flight `index`; it flies again to the same bytes.

        Raises
        ------
        ValueError
            There is none.
        """
        return scenario_in(self.plan, index)


def opened(folder: str | Path) -> Flights:
    """Look at a campaign's folder.

    Raises
    ------
    ValueError
        It is none; one line that names the file.
    """
    plan = plan_in(Path(folder))
    found = Flights(Path(folder), plan)
    return replace(found, complete=len(found.frame(["index"])) == plan.size)


def scenario_in(plan: Plan, index: int) -> Scenario:
    """Return what flies as flight `index` of a plan.

    Raises
    ------
    ValueError
        There is none.
    """
    position = position_of(plan, index)
    if position is None:
        first, last = plan.index(0), plan.index(plan.size - 1)
        raise ValueError(f"--index {index}: there is no such flight; they are {first} to {last}")
    return plan.flight(position)


def limit_of(plan: Plan) -> float:
    """Return how long a flight may take on a clock, s: far longer than any that is not stuck."""
    scenario = plan.scenario
    return max(LEAST_LIMIT, SLOWEST * scenario.duration * scenario.plant.step_rate)


def fly_plan(
    record: Record,
    crew: Crew,
    keep: Keep,
    *,
    positions: Sequence[int] | None = None,
    limit: float | None = None,
    progress: Progress | None = None,
) -> Flights:
    """Fly what is missing in a folder.

    Parameters
    ----------
    record
        Of the folder; it knows the plan.
    crew
        Who flies.
    keep
        Which flights are kept whole.
    positions
        Only those of them.
    limit
        Time on a clock that one flight may take, s; None: `limit_of` the plan.
    progress
        Called as flights are finished.

    Raises
    ------
    KeyboardInterrupt
        Somebody wants to end; what was finished is written, and the record says that it is not complete.
    """
    plan, started = record.plan, time.monotonic()
    limit = limit_of(plan) if limit is None else limit
    wanted = record.missing if positions is None else sorted(set(record.missing).intersection(positions))
    outcomes: Counter[str] = Counter()

    def done(results: list[tuple[int, Flown]]) -> None:
        record.keep([(wanted[i], flown) for i, flown in results])
        outcomes.update(flown.row["outcome"] for _, flown in results)
        if progress is not None:
            progress(record.finished, plan.size, outcomes)

    left: list[Left] = []
    try:
        left = [
            Left(wanted[one.position], one.why)
            for one in crew.each(partial(fly_position, plan, keep, limit), wanted, done=done, limit=limit)
        ]
        if keep.later and record.finished == plan.size:
            _keep_later(record, crew, keep, limit)
    finally:
        complete = record.finished == plan.size
        spent = time.monotonic() - started
        record.describe(complete=complete, wall_time=spent, left=left)
    return Flights(record.folder, plan, tuple(left), complete, spent)


def _keep_later(record: Record, crew: Crew, keep: Keep, limit: float) -> None:
    """Fly those once more that only all rows together tell."""
    plan = record.plan
    kept = record.folder / FLIGHTS
    indices = [i for i in keep.among(frame(record.folder, keep.columns)) if not (kept / str(i)).is_dir()]
    positions = [position_of(plan, index) for index in indices]

    def done(results: list[tuple[int, Flown]]) -> None:
        for i, flown in results:
            if flown.flight is not None:
                record.keep_flight(indices[i], flown.flight)

    crew.each(partial(_fly_whole, plan, limit), positions, done=done, limit=limit)


def _fly_whole(plan: Plan, limit: float, position: int) -> Flown:
    return fly_position(plan, Keep("all"), limit, position)


def first_flight(flights: Flights) -> "tuple[int, Flight] | None":
    """Return the first flight that was kept, with its index; None if there is none."""
    kept = flights.kept()
    return (kept[0], flights.flight(kept[0])) if kept else None
