"""Fly until each requirement is decided, or the budget ends.

Flights are random draws of one seed, judged at predetermined numbers of them, always the first ones by their index. So
the verdict depends on the scenario, the seed, the confidence and the budget alone: not on how many workers fly, nor on
the order in which they finish, nor on whether the run was interrupted and taken up again.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from uavsim.folders import StandingPlace
from uavsim.requirements import OUTCOME, Requirement
from uavsim.scenario import Scenario
from uavsim.studies.campaign.campaign import Flights, Progress, fly_plan, given_scenario, keep_later
from uavsim.studies.campaign.evidence import HOUR
from uavsim.studies.campaign.exposures import Exposures
from uavsim.studies.campaign.keep import NOTHING, Keep
from uavsim.studies.campaign.outlook import Outlook, outlook
from uavsim.studies.campaign.plan import Plan, Random
from uavsim.studies.campaign.record import ABOUT, Record, frame, taken_up
from uavsim.studies.campaign.verification import Verification, check_confidence, judge, schedule, verdicts
from uavsim.studies.engine import Crew, Left, engine
from uavsim.studies.false_alarms import PIECE

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.studies.engine import Client

BUDGET = 3000  # flights: P ≥ 0.995 is decided within it in 93 of 100 runs where it is 0.999
ALWAYS = (OUTCOME, "index", "flight.duration", "launch.release_time", "launch.true_time")


@dataclass(frozen=True)
class Verified:
    """What flights say, and the flights.

    Attributes
    ----------
    verification
        Verdicts.
    scenario
        What flew, with the requirements that were judged.
    frame
        Rows of the flights that were judged.
    left
        Flights that could not be flown; nothing after the first of them is judged.
    """

    verification: Verification
    scenario: Scenario
    frame: "pd.DataFrame"
    left: tuple[Left, ...] = ()

    @property
    def met(self) -> bool:
        """Whether it is shown that all requirements are met."""
        return self.verification.met


def verify(
    scenario: "str | Path | Scenario" = "dispersed",
    *,
    runs: int = BUDGET,
    confidence: float = 0.95,
    requirements: "Sequence[Requirement] | str | Path | None" = None,
    seed: int | None = None,
    overrides: Iterable[str] = (),
    out: "str | Path | None" = None,
    resume: bool = False,
    workers: int | None = None,
    client: "Client | None" = None,
    progress: Progress | None = None,
) -> Verified:
    """Test a scenario's requirements statistically.

    Parameters
    ----------
    scenario
        A packaged name, the path of a TOML file, or a `Scenario`.
    runs
        Flights at most; fewer if all is decided.
    confidence
        Of each statement; 0.5 … 1 exclusive.
    requirements
        Instead of the scenario's own: requirements, the name of a pack or its path.
    seed
        Instead of the scenario's own.
    overrides
        ``KEY=VALUE`` each; only with a name or path.
    out
        Folder of a campaign to write the flights into; None: none is kept but as rows of what is returned.
    resume
        Go on with what `out` holds.
    workers
        Processes of this machine; None: one a processor; 0: all is flown in this one.
    client
        A client of `distributed` that flies instead; used as it is, and left open.
    progress
        Called as flights are finished.

    Returns
    -------
    Verified
        Verdicts, and a frame with a row a flight.

    Raises
    ------
    ValueError
        One line: what cannot be verified or taken up, and why.
    OSError
        `out` is not empty, or cannot be written.
    ClusterError
        The workers cannot be used.
    """
    if runs < 1:
        raise ValueError(f"runs = {runs}: must be at least 1")
    check_confidence(confidence)
    plan = Random(asking(given_scenario(scenario, seed=seed, overrides=overrides), requirements), runs)
    with (
        TemporaryDirectory(prefix="uavsim-") as passing,
        StandingPlace(passing if out is None else out, resume=resume) as place,
        engine(workers=workers, client=client) as crew,
    ):
        known = resume and (place.folder / ABOUT).is_file()
        record = Record(place.folder, plan, keep="none", before=taken_up(place.folder, plan) if known else None)
        return fly_until_decided(record, crew, NOTHING, confidence, progress=progress)


def asking(scenario: Scenario, requirements: "Sequence[Requirement] | str | Path | None" = None) -> Scenario:
    """Return the scenario with the requirements that are asked for in place of its own.

    Raises
    ------
    ValueError
        It has none, or what names a pack names none.
    """
    from uavsim import requirements as packs
    from uavsim.settings import SettingError

    found: Sequence[Requirement] = scenario.requirements
    if isinstance(requirements, str | Path):
        found = packs.read(requirements)
    elif requirements is not None:
        found = requirements
    try:
        packs.check(found)
    except SettingError as error:
        raise ValueError(error.problem) from None
    if not found:
        raise ValueError(
            f"{scenario.name}: has no [[requirements]] to verify; give --requirements FILE or one of "
            f"{', '.join(packs.packaged_names())}"
        )
    return replace(scenario, requirements=tuple(found))


def outlooks(scenario: Scenario, confidence: float, budget: int) -> list[tuple[Requirement, Outlook]]:
    """What to expect of each requirement before the start."""
    return [(one, outlook(one, confidence, budget, hours=_hours(scenario, one))) for one in scenario.requirements]


def _hours(scenario: Scenario, requirement: Requirement) -> float:
    """Exposure of a flight as it is planned, hours."""
    launcher = scenario.launcher
    wait = 0.5 * (launcher.wait_min + launcher.wait_max)
    if requirement.disturbed:
        return PIECE / HOUR
    return max(wait if requirement.exposure == "armed" else scenario.duration - wait, 1e-3) / HOUR


def fly_until_decided(
    record: Record,
    crew: Crew,
    keep: Keep,
    confidence: float,
    *,
    limit: float | None = None,
    progress: Progress | None = None,
) -> Verified:
    """Fly from look to look until each requirement of a record's scenario is decided or its plan ends.

    Parameters
    ----------
    record
        Of the folder; its plan is random, its size the budget.
    crew
        Who flies.
    keep
        Which flights are kept whole.
    confidence
        Of each statement.
    limit
        Time on a clock that one flight may take, s.
    progress
        Called as flights are finished.
    """
    plan = record.plan
    scenario, requirements = plan.scenario, plan.scenario.requirements
    columns = list(dict.fromkeys((*ALWAYS, *(one.key for one in requirements if not one.disturbed))))
    exposures = Exposures(plan)
    before, spent = 0, 0.0
    for look in schedule(requirements, confidence, plan.size):
        flown = fly_plan(record, crew, keep, positions=range(before, look), limit=limit, progress=progress)
        spent += flown.wall_time
        seen = exposures.beside(_first(frame(record.folder, columns), look))
        decided = len(seen) > 0 and "undecided" not in verdicts(requirements, seen, confidence)
        if decided or flown.left or look == plan.size:
            break
        before = look
    if not len(seen):
        raise ValueError(f"no flight is finished: {flown.left[0].why}")
    keep_later(record, crew, keep, limit)
    found = judge(requirements, seen, confidence)
    record.describe(complete=not flown.left, wall_time=spent, left=flown.left)
    rows = exposures.beside(_first(frame(record.folder), found.runs))
    return Verified(found, scenario, rows, flown.left)


def _first(rows: "pd.DataFrame", count: int) -> "pd.DataFrame":
    """Rows of the first flights, as far as none is missing."""
    ordered = rows[rows["index"] < count].sort_values("index")
    whole = int((ordered["index"].to_numpy() == range(len(ordered))).cumprod().sum()) if len(ordered) else 0
    return ordered.iloc[:whole].reset_index(drop=True)


def flights_of(record: Record, found: Verified) -> Flights:
    """Return the campaign's folder as others look at it."""
    plan: Plan = record.plan
    return Flights(record.folder, plan, found.left, not found.left)
