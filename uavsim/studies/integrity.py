"""Integrity as a figure: how probable it is that a valid airspeed is more than 3 m/s wrong for more than 1 s.

    P(hazard in a flight) = 1 − Π(1 − λ_i·T·P_i)·Π(1 − p_j·P_j),        P_i = P(hazard | fault of class i)

λ_i is the rate at which faults of class i begin in flight, p_j the probability that one is there at the start, T the
length of a flight: stated, in a file (`fault-rates.toml` beside this module; every rate in it is an assumption). P_i
comes from flights with that fault: k of n had the hazard, `airspeed.hazard` of the score. The rate per flight hour is
the probability of a flight over T.

Intervals. P_i has its exact one (Clopper and Pearson). The bounds of the total put all P_i at their bounds at once,
each with an error of α/m, m the number of classes: by Bonferroni they hold together with at least the stated
confidence. They are about the flights that are missing, not about the rates, which are stated.

Beside it, of flights without a fault: what misleads of itself, false flags and losses of validity per flight hour with
exact intervals of a Poisson process (Garwood). The last two are what continuity loses. These have their own line: an
hour of flights without an event bounds a rate at 3.7 per hour, and no sum with fault rates of 1e-4 would show them.

What a conditional probability holds: one fault, which lasts to the end of the record, some ten seconds later. A hazard
that takes longer to grow is not seen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Gt, Interval, MinLen

from sensors.choice import shown
from sensors.data_files import read_toml
from uavsim import settings
from uavsim.scenario import load_scenario
from uavsim.settings import SettingError
from uavsim.studies.engine import engine, processes
from uavsim.studies.faults import Case, flown_case
from uavsim.studies.intervals import rate_interval, share_interval

PACKAGED = Path(__file__).with_name("fault-rates.toml")
HOUR = 3600.0  # s
CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class FaultClass:
    """A kind of fault, how often it comes, and the flights that show what it does.

    Attributes
    ----------
    name : str
    rate : float
        1/h, or the probability that a flight begins with it.
    per : str
        "hour" or "flight".
    source : str
        Where the rate is from, or that it is an assumption and why.
    scenario, overrides
        What is flown.
    where, fault, begins
        List of faults of the scenario, the faults in it without their times, and within which two times they begin, s.
    """

    name: Annotated[str, MinLen(1)]
    rate: Annotated[float, Interval(ge=0.0, le=1e6)]
    per: Literal["hour", "flight"]
    source: Annotated[str, MinLen(1)]
    scenario: str = "catapult"
    overrides: tuple[str, ...] = ()
    where: str = ""
    fault: str = ""
    begins: tuple[float, float] = (9.5, 14.0)

    @property
    def case(self) -> Case:
        """As fault campaigns fly it."""
        return Case(self.scenario, self.overrides, self.where or None, self.fault, self.begins)


@dataclass(frozen=True, slots=True)
class Healthy:
    """What is flown without a fault."""

    scenarios: tuple[str, ...] = ("catapult",)


@dataclass(frozen=True, slots=True)
class Rates:
    """A file of fault rates.

    Attributes
    ----------
    description : str
    flight_hours : float
        Length of a flight, h.
    healthy : Healthy
    classes : tuple of FaultClass
    """

    description: str = ""
    flight_hours: Annotated[float, Gt(0.0)] = 0.5
    healthy: Healthy = Healthy()
    classes: tuple[FaultClass, ...] = ()


def read_rates(path: Path = PACKAGED) -> Rates:
    """Read fault rates.

    Raises
    ------
    ValueError
        One line that names the file and what is wrong with it.
    """
    try:
        rates = settings.read(Rates, read_toml(path))
        _check(rates)
    except (SettingError, ValueError) as error:
        said = error.problem if isinstance(error, SettingError) else str(error)
        raise ValueError(f"{path}: {said}") from None
    return rates


def _check(rates: Rates) -> None:
    names = [one.name for one in rates.classes]
    if not names:
        raise ValueError("holds no [[classes]]")
    for i, one in enumerate(rates.classes):
        where = f"classes[{i}] ({shown(one.name)})"
        if names.index(one.name) != i:
            raise ValueError(f"{where}: there are two of that name")
        if one.per == "flight" and one.rate > 1.0:
            raise ValueError(f"{where}: rate = {one.rate:g}: per flight it is a probability, at most 1")
        if bool(one.where) != bool(one.fault):
            raise ValueError(f"{where}: where and fault come together")
        if not 0.0 <= one.begins[0] <= one.begins[1]:
            raise ValueError(f"{where}: begins: must be two times, s, from 0 on, the second not before the first")
        fault = ",".join(f"{{{one_fault},start={one.begins[1]}}}" for one_fault in one.fault.split("|"))
        keys = [*one.overrides, *([f"{one.where}=[{fault}]"] if one.where else [])]
        try:
            load_scenario(one.scenario, overrides=keys)
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None


# -- flights -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Seen:
    """What one flight showed.

    Attributes
    ----------
    hazard : bool
    flags, false_flags, losses : int
    hours : float
        From the true launch to the end, h.
    """

    hazard: bool
    flags: int
    false_flags: int
    losses: int
    hours: float


def fly_one(case: Case, seed: int) -> Seen:
    """Fly one flight of a case."""
    _, flown = flown_case(case, seed)
    return seen(flown.finish().score)


def seen(score: dict[str, Any]) -> Seen:
    """Return what a flight's score says."""
    airspeed, launch = score["airspeed"], score["launch"]["true_time"]
    flags, false = airspeed["flags"], airspeed["false_flags"]
    duration = score["flight"]["duration"]
    hours = 0.0 if launch is None or duration is None else max(0.0, duration - launch) / HOUR
    return Seen(bool(airspeed["hazard"]), flags, false, airspeed["losses"] or 0, hours)


def fly(
    cases: Sequence[Case],
    flights: int,
    *,
    first_seed: int,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> list[list[Seen]]:
    """Fly each case with the same seeds, in several processes.

    Raises
    ------
    ValueError
        If no flight is asked for.
    """
    if flights < 1:
        raise ValueError(f"flights: {flights} is not at least 1")
    parts = [(case, seed) for case in cases for seed in range(first_seed, first_seed + flights)]
    found: dict[int, Seen] = {}

    def done(results: list[tuple[int, Seen]]) -> None:
        found.update(results)
        if progress is not None:
            progress(len(found) / len(parts))

    with engine(workers=processes(workers, len(parts))) as crew:
        left = crew.each(partial(_fly_part), parts, done=done)
    if left:
        raise RuntimeError(f"flight {left[0].position}: {left[0].why}")
    return [[found[i * flights + j] for j in range(flights)] for i in range(len(cases))]


def _fly_part(part: tuple[Case, int]) -> Seen:
    return fly_one(*part)


# -- figures -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Bounded:
    """An estimate with its bounds."""

    value: float
    low: float
    high: float

    def times(self, factor: float) -> "Bounded":
        """Return it in another unit."""
        return Bounded(factor * self.value, factor * self.low, factor * self.high)


@dataclass(frozen=True, slots=True)
class ClassRisk:
    """What a class of faults contributes.

    Attributes
    ----------
    fault : FaultClass
    flights, flagged, hazards : int
        Flown; with a flag after the fault began; with the hazard.
    given : Bounded
        P(hazard | fault), with its own exact interval.
    per_flight : Bounded
        Probability of the hazard in a flight by this class.
    """

    fault: FaultClass
    flights: int
    flagged: int
    hazards: int
    given: Bounded
    per_flight: Bounded


@dataclass(frozen=True, slots=True)
class Integrity:
    """All figures.

    Attributes
    ----------
    rates : Rates
    classes : tuple of ClassRisk
    per_flight, per_hour : Bounded
        Of the hazard by all classes; the bounds hold together.
    hours : float
        Flown without a fault, h.
    healthy : dict of Bounded
        "hazards", "false_flags" and "losses" per flight hour without a fault.
    counts : dict of int
        The same, counted.
    """

    rates: Rates
    classes: tuple[ClassRisk, ...]
    per_flight: Bounded
    per_hour: Bounded
    hours: float
    healthy: dict[str, Bounded]
    counts: dict[str, int]


def combine(
    rates: Rates, faulty: Sequence[Sequence[Seen]], healthy: Sequence[Seen], confidence: float = CONFIDENCE
) -> Integrity:
    """Combine stated rates with what was flown.

    Parameters
    ----------
    rates
        Classes in the order of `faulty`.
    faulty, healthy
        What flights with each class of faults and without any showed.
    confidence
        Of each interval, and of the total's.
    """
    together = 1.0 - (1.0 - confidence) / len(rates.classes)
    found, joint = [], []
    for fault, flown in zip(rates.classes, faulty, strict=True):
        hazards, n = sum(one.hazard for one in flown), len(flown)
        expected = fault.rate * (rates.flight_hours if fault.per == "hour" else 1.0)
        given = Bounded(hazards / n, *share_interval(hazards, n, confidence))
        flagged = sum(one.flags > one.false_flags for one in flown)
        found.append(ClassRisk(fault, n, flagged, hazards, given, given.times(min(expected, 1.0))))
        joint.append(Bounded(hazards / n, *share_interval(hazards, n, together)).times(min(expected, 1.0)))
    total = Bounded(*(_any(getattr(one, end) for one in joint) for end in ("value", "low", "high")))
    hours = sum(one.hours for one in healthy)
    counts = {
        "hazards": sum(one.hazard for one in healthy),
        "false_flags": sum(one.false_flags for one in healthy),
        "losses": sum(one.losses for one in healthy),
    }
    return Integrity(
        rates,
        tuple(found),
        total,
        total.times(1.0 / rates.flight_hours),
        hours,
        {name: Bounded(count / hours, *rate_interval(count, hours, confidence)) for name, count in counts.items()},
        counts,
    )


def _any(probabilities: Any) -> float:
    """Return the probability that any of independent events happens."""
    none = 1.0
    for one in probabilities:
        none *= 1.0 - one
    return 1.0 - none


def study(
    rates: Rates,
    flights: int,
    *,
    first_seed: int = 1,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Integrity:
    """Fly `flights` of each class and of each healthy scenario, and combine them with the rates."""
    healthy = [Case(name) for name in rates.healthy.scenarios]
    cases = [*(fault.case for fault in rates.classes), *healthy]
    flown = fly(cases, flights, first_seed=first_seed, workers=workers, progress=progress)
    split = len(rates.classes)
    return combine(rates, flown[:split], [one for group in flown[split:] for one in group])
