"""Fly until each requirement is decided, or the budget ends.

Flights are random draws of one seed, judged at predetermined numbers of them, always the first ones by their index. So
the verdict depends on the scenario, the seed, the confidence and the budget alone: not on how many workers fly, nor on
the order in which they finish, nor on whether the run was interrupted and taken up again.
"""

import tempfile
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.requirements import OUTCOME, Requirement
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.campaign.campaign import Flights, Progress, fly_plan, keep_later
from uavsim.studies.campaign.evidence import HOUR
from uavsim.studies.campaign.keep import Keep, keep_of
from uavsim.studies.campaign.outlook import Outlook, outlook
from uavsim.studies.campaign.plan import Plan, Random
from uavsim.studies.campaign.record import Record, frame
from uavsim.studies.campaign.verification import Verification, judge, schedule, verdicts
from uavsim.studies.engine import Crew, Left, engine

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
    scenario: "str | Path | Scenario" = "catapult",
    *,
    runs: int = BUDGET,
    confidence: float = 0.95,
    requirements: "Sequence[Requirement] | str | Path | None" = None,
    seed: int | None = None,
    out: "str | Path | None" = None,
    workers: int | None = None,
    client: "Client | None" = None,
) -> Verified:
    """Test a scenario's requirements statistically.

    Parameters
    ----------
    scenario
        A packaged name, a path, or a scenario.
    runs
        Flights at most.
    confidence
        Of each statement; 0.5 … 1 exclusive.
    requirements
        Instead of the scenario's own: requirements, the name of a pack or its path.
    seed
        Instead of the scenario's own.
    out
        Folder of a campaign to write the flights into; None: none is kept.
    workers
        Processes of this machine; None: one a processor, 0: this one.
    client
        A client of `distributed` that flies instead; used as it is.

    Raises
    ------
    ValueError
        One line: what cannot be verified, and why.
    """
    loaded = load_scenario(scenario) if isinstance(scenario, str | Path) else scenario
    asked = asking(loaded if seed is None else loaded.with_seed(seed), requirements)
    plan = Random(asked, runs)
    place = tempfile.TemporaryDirectory() if out is None else nullcontext(str(out))
    with place as folder, engine(workers=workers, client=client) as crew:
        Path(folder).mkdir(parents=True, exist_ok=True)
        record = Record(Path(folder), plan, keep="none")
        return fly_until_decided(record, crew, keep_of("none", ()), confidence)


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
    columns = list(dict.fromkeys((*ALWAYS, *(one.key for one in requirements))))
    before, spent = 0, 0.0
    for look in schedule(requirements, confidence, plan.size):
        flown = fly_plan(record, crew, keep, positions=range(before, look), limit=limit, progress=progress)
        spent += flown.wall_time
        seen = _first(frame(record.folder, columns), look)
        decided = len(seen) > 0 and "undecided" not in verdicts(requirements, seen, confidence)
        if decided or flown.left or look == plan.size:
            break
        before = look
    if not len(seen):
        raise ValueError(f"no flight is finished: {flown.left[0].why}")
    keep_later(record, crew, keep, limit)
    found = judge(requirements, seen, confidence)
    record.describe(complete=not flown.left, wall_time=spent, left=flown.left)
    return Verified(found, scenario, _first(frame(record.folder), found.runs), flown.left)


def _first(rows: "pd.DataFrame", count: int) -> "pd.DataFrame":
    """Rows of the first flights, as far as none is missing."""
    ordered = rows[rows["index"] < count].sort_values("index")
    whole = int((ordered["index"].to_numpy() == range(len(ordered))).cumprod().sum()) if len(ordered) else 0
    return ordered.iloc[:whole].reset_index(drop=True)


def flights_of(record: Record, found: Verified) -> Flights:
    """Return the campaign's folder as others look at it."""
    plan: Plan = record.plan
    return Flights(record.folder, plan, found.left, not found.left)
