"""Fly a plan into its folder, and look at what is there."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from uavsim.flight import load
from uavsim.folders import StandingPlace
from uavsim.scenario import Scenario, load_scenario
from uavsim.score_keys import NUMBERS
from uavsim.studies.campaign.flown import ErrorTrace, Flown, fly_position
from uavsim.studies.campaign.keep import Keep, keep_of
from uavsim.studies.campaign.plan import Design, Plan, Random, position_of
from uavsim.studies.campaign.record import ABOUT, FLIGHTS, Record, frame, plan_in, taken_up, traces
from uavsim.studies.engine import Crew, Left, engine

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.flight import Flight
    from uavsim.studies.engine import Client

SAMPLINGS = ("random", "latin-hypercube", "sobol")
SLOWEST = 5e-3  # s a step of a plant, with the slowest plug-in that is let fly
LEAST_LIMIT = 600.0  # s
TELLING = 30.0  # s between two times at which the record says how far it is

Progress = Callable[[int, int, Mapping[str, int]], None]
"""Called with the number of finished flights, of all, and how those that are finished ended."""


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
    holder : object
        What keeps the folder in being, if it is one that vanishes with this.
    """

    folder: Path
    plan: Plan
    left: tuple[Left, ...] = ()
    complete: bool = True
    wall_time: float = 0.0
    holder: object = None

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


def campaign(
    scenario: "str | Path | Scenario" = "dispersed",
    *,
    runs: int,
    seed: int | None = None,
    overrides: Iterable[str] = (),
    sampling: str = "random",
    out: "str | Path | None" = None,
    resume: bool = False,
    keep: str = "none",
    workers: int | None = None,
    client: "Client | None" = None,
    progress: Progress | None = None,
) -> Flights:
    """Fly a scenario many times, each flight with its own draws.

    Parameters
    ----------
    scenario
        A packaged name, the path of a TOML file, or a `Scenario`.
    runs
        How many flights.
    seed
        Instead of the scenario's own.
    overrides
        ``KEY=VALUE`` each; only with a name or path.
    sampling
        "random", or for means "latin-hypercube" or "sobol".
    out
        Folder to write; None: one that vanishes with what is returned.
    resume
        Go on with what `out` holds.
    keep
        Which flights are kept whole, see `keep`.
    workers
        Processes of this machine; None: one a processor; 0: all is flown in this one.
    client
        A client of `distributed` that flies instead; used as it is, and left open.
    progress
        Called as flights are finished.

    Returns
    -------
    Flights
        Its `runs` are a frame, a row a flight.

    Raises
    ------
    ValueError
        One line: what cannot be flown or taken up, and why.
    OSError
        `out` is not empty, or cannot be written.
    ClusterError
        The workers cannot be used.
    """
    if not isinstance(runs, int) or runs < 1:
        raise ValueError(f"runs = {runs!r}: must be a whole number of at least 1")
    plan = sampled(given_scenario(scenario, seed=seed, overrides=overrides), runs, sampling)
    rule = keep_of(keep, NUMBERS)
    holder = TemporaryDirectory(prefix="uavsim-")
    with (
        StandingPlace(holder.name if out is None else out, resume=resume) as place,
        engine(workers=workers, client=client) as crew,
    ):
        known = resume and (place.folder / ABOUT).is_file()
        record = Record(place.folder, plan, keep=keep, before=taken_up(place.folder, plan) if known else None)
        return replace(fly_plan(record, crew, rule, progress=progress), holder=holder if out is None else None)


def given_scenario(
    scenario: "str | Path | Scenario", *, seed: int | None = None, overrides: Iterable[str] = ()
) -> Scenario:
    """Return a scenario that is given by name, path or as itself, checked."""
    if isinstance(scenario, Scenario):
        return (scenario if seed is None else scenario.with_seed(seed)).checked()
    return load_scenario(scenario, overrides=overrides, seed=seed)


def sampled(scenario: Scenario, runs: int, sampling: str) -> Plan:
    """Return what flies.

    Raises
    ------
    ValueError
        No such sampling, or a number of flights that it does not have.
    """
    if sampling not in SAMPLINGS:
        raise ValueError(f"sampling {sampling[:40]!r}: must be one of {', '.join(SAMPLINGS)}")
    if sampling == "random":
        return Random(scenario, runs)
    plan = Design(scenario, runs, sampling)
    _ = plan.points  # which cannot be made of any number
    return plan


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
    told = [started]  # when the record last said how far it is

    def describe(left: Sequence[Left]) -> tuple[bool, float]:
        complete, spent = record.finished == plan.size, time.monotonic() - started
        record.describe(complete=complete, wall_time=spent, left=left)
        return complete, spent

    def done(results: list[tuple[int, Flown]]) -> None:
        record.keep([(wanted[i], flown) for i, flown in results])
        if time.monotonic() - told[0] > TELLING:
            told[0] = time.monotonic()
            describe(())
        if progress is not None:
            progress(record.finished, plan.size, record.outcomes)

    try:
        not_done = crew.each(partial(fly_position, plan, keep, limit), wanted, done=done, limit=limit)
        left = [Left(wanted[one.position], one.why) for one in not_done]
        if record.finished == plan.size:
            keep_later(record, crew, keep, limit)
    except BaseException:
        with suppress(OSError):  # what ended it says more
            describe(())
        raise
    return Flights(record.folder, plan, tuple(left), *describe(left))


def keep_later(record: Record, crew: Crew, keep: Keep, limit: float | None = None) -> None:
    """Fly those once more that only all rows together tell; nothing by another rule."""
    if not keep.later:
        return
    plan = record.plan
    limit = limit_of(plan) if limit is None else limit
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
