"""What is asked of flights: bounds on a number of the score, of each flight or of what many flights do.

    statistic       reads                                       asks
    every           minimum, maximum                            minimum ≤ value ≤ maximum in each flight
    probability     equals | minimum, maximum;                  P(event) ≥ at_least, or ≤ at_most; the event is
                    at_least | at_most                          outcome = equals, or minimum ≤ value ≤ maximum
    p50, p95, pQ    minimum | maximum                           quantile of the number over flights
    mean            minimum | maximum                           mean of the number over flights
    rate_per_hour   equals | nothing; minimum | maximum;        events an hour of exposure: flights that end as
                    exposure                                    `equals`, or a count summed

A single flight is judged by what asks each flight, `every`; the others are judged by `uavsim verify`.

**A flight without a value** (null in the score, NaN in a row) never helps. It meets no bound of `every`. Of a
`probability` it counts against what is asked: as no event under `at_least`, as an event under `at_most`. Of a quantile
it counts as the worst value, +inf under a maximum, -inf under a minimum. A `mean` over flights of which one has no
value does not exist: the requirement stays undecided, and the number of such flights is said. Of a `rate_per_hour` it
counts as one event, unless it has no exposure.

**Exposure** is in hours, of one flight:

* armed: min(`launch.release_time`, `flight.duration`), from the first sample that the detector sees to the release.
  It is the time in which a detection counts among `launch.false_detections`.
* flight: `flight.duration` − `launch.true_time`, from the true launch to the end of the record; 0 without a launch.
* handling, vibration, soft drops, held load: ten minutes of disturbances without a launch beside each flight, read by
  its detector and flight computer (`uavsim.studies.campaign.exposures`). What they count: `launch.false_detections` of
  the detector alone, and `launch.false_wing_commands`, which is no number of the score: on the rail of a flight that
  lasts some seconds there is none, and one that opens its wings there ends as `false_launch`.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from sensors.choice import nearest, shown
from sensors.data_files import read_toml
from uavsim import settings
from uavsim.score_keys import NUMBERS, Outcome
from uavsim.settings import SettingError

Exposure = Literal["armed", "flight", "handling", "vibration", "soft drops", "held load"]

PACKAGED = Path(__file__).resolve().parent
OUTCOME = "outcome"  # the one key of the score that is no number and may be asked for
WINGS = "launch.false_wing_commands"  # without a launch; counted in disturbances only
OF_FLIGHT = ("airspeed.flags", "airspeed.false_flags", "airspeed.losses", "airspeed.hazard")
COUNTS = ("launch.false_detections", WINGS, *OF_FLIGHT)  # numbers of events, which a rate may be of
FLOWN = ("armed", "flight")  # exposures of a flight itself
DISTURBED = ("handling", "vibration", "soft drops", "held load")  # those of disturbances beside it
ALLOWED = {
    **{OUTCOME: FLOWN, "launch.false_detections": ("armed", *DISTURBED), WINGS: DISTURBED},
    **dict.fromkeys(OF_FLIGHT, ("flight",)),
}
"""Exposures in which something can happen."""
STATISTICS = ("every", "probability", "p50", "p95", "p99", "mean", "rate_per_hour")
QUANTILE = re.compile(r"p([0-9]{1,2}(?:\.[0-9]{1,3})?)")
BOUNDS = ("equals", "minimum", "maximum", "at_least", "at_most", "exposure")
READS = {
    "every": ("minimum", "maximum"),
    "probability": ("equals", "minimum", "maximum", "at_least", "at_most"),
    "quantile": ("minimum", "maximum"),
    "mean": ("minimum", "maximum"),
    "rate_per_hour": ("equals", "minimum", "maximum", "exposure"),
}
"""Which bounds a statistic reads."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """A bound on a number of the score, of each flight or of many; see [verification.md](verification.md).

    Attributes
    ----------
    key
        Of the score, joined by dots, or `outcome`; null meets no bound.
    statistic
        What is bounded: `every` flight's own number, the `probability` of an event, a quantile over flights (`p50`,
        `p95`, `p99`, `p` and a number), the `mean`, or the `rate_per_hour`. Only `every` judges a single flight.
    equals
        Outcome that is the event, where the key is `outcome`.
    minimum, maximum
        Bounds, in the number's own unit; of `probability` they say which values are the event.
    at_least, at_most
        Bounds on the event's probability.
    exposure
        Hours that a rate is over: `armed`, until the release; `flight`, after the true launch; or disturbances beside
        each flight: `handling`, `vibration`, `soft drops`, `held load`.
    """

    key: str
    statistic: str = "every"
    equals: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    exposure: Exposure | None = None

    @property
    def of_each_flight(self) -> bool:
        """Whether a single flight can be judged by it."""
        return self.statistic == "every"

    @property
    def quantile(self) -> float | None:
        """Probability of the quantile that is bounded, 0 … 1; None if none is."""
        found = QUANTILE.fullmatch(self.statistic)
        return float(found[1]) / 100.0 if found and float(found[1]) > 0.0 else None

    @property
    def kind(self) -> str:
        """The statistic, with all quantiles as one."""
        return "quantile" if self.quantile is not None else self.statistic

    @property
    def is_upper(self) -> bool:
        """Whether what is bounded must not be greater than its bound."""
        return (self.at_most if self.kind == "probability" else self.maximum) is not None

    @property
    def bound(self) -> float | None:
        """Bound on the statistic; of `every` None, for it has two."""
        if self.kind == "every":
            return None
        if self.kind == "probability":
            return self.at_most if self.at_least is None else self.at_least
        return self.minimum if self.maximum is None else self.maximum

    @property
    def disturbed(self) -> bool:
        """Whether it is asked of disturbances beside the flights, not of the flights."""
        return self.exposure in DISTURBED

    @property
    def column(self) -> str:
        """Where a row of many flights has it."""
        return f"{self.key}.{self.exposure}" if self.disturbed else self.key

    def __str__(self) -> str:
        """As people write it."""
        sign = "≤" if self.is_upper else "≥"
        if self.kind == "probability":
            return f"P({self.event}) {sign} {self.bound:g}"
        if self.kind == "rate_per_hour":
            per = f"hour of {self.exposure}" if self.disturbed else f"{self.exposure} hour"
            return f"{self.event} {sign} {self.bound:g} per {per}"
        if self.kind == "every":
            return f"{self.event}, every flight"
        return f"{self.statistic} of {self.key} {sign} {self.bound:g}"

    @property
    def event(self) -> str:
        """What counts in a flight, as people write it."""
        if self.equals is not None:
            return f"{self.key} = {self.equals}"
        if self.kind == "rate_per_hour" or (self.minimum is None and self.maximum is None):
            return self.key
        low = "" if self.minimum is None else f"{self.minimum:g} ≤ "
        return f"{low}{self.key}" + ("" if self.maximum is None else f" ≤ {self.maximum:g}")


@dataclass(frozen=True, slots=True)
class Pack:
    """A file of requirements.

    Attributes
    ----------
    description
        For people.
    requirements
        At least one.
    """

    description: str = ""
    requirements: tuple[Requirement, ...] = ()


def packaged_names() -> list[str]:
    """Names of the packs that are shipped."""
    return sorted(file.stem for file in PACKAGED.glob("*.toml"))


def read(source: str | Path) -> tuple[Requirement, ...]:
    """Read a pack: the name of a shipped one, or the path of a TOML file with [[requirements]].

    Raises
    ------
    ValueError
        One line that names the file, the entry and what is allowed.
    """
    name = str(source)
    path = PACKAGED / f"{name}.toml" if name in packaged_names() else Path(name)
    if not path.is_file():
        near = nearest(name, packaged_names(), cutoff=0.3)
        hint = f"did you mean {near!r}? " if near else ""
        raise ValueError(f"there is no file {shown(name)}; {hint}packaged: {', '.join(packaged_names())}")
    try:
        found = settings.read(Pack, read_toml(path)).requirements
        check(found)
    except SettingError as error:
        raise ValueError(f"{name}: {error.problem}") from None
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if not found:
        raise ValueError(f"{name}: holds no [[requirements]]")
    return found


# -- checking --------------------------------------------------------------------------------------------------------


def check(requirements: Iterable[Requirement]) -> None:
    """Refuse what asks for something that does not exist, or does not say what it asks for.

    Raises
    ------
    SettingError
        On the first thing that is wrong.
    """
    for i, one in enumerate(requirements):
        where = f"requirements[{i}]"
        for look in (_check_statistic, _check_key, _check_fields, _check_bounds, _check_event):
            problem = look(one)
            if problem:
                raise SettingError(f"{where}{problem}", "requirements")


def _check_statistic(r: Requirement) -> str:
    if r.kind in READS:
        return ""
    near = nearest(r.statistic, STATISTICS)
    hint = f"; did you mean {near!r}?" if near else ""
    return (
        f".statistic = {shown(r.statistic)}: must be one of {', '.join(STATISTICS)} or p with a number below 100{hint}"
    )


def _check_key(r: Requirement) -> str:
    counts = r.kind == "rate_per_hour"
    outcome = r.kind in ("probability", "rate_per_hour")
    if r.key == OUTCOME and outcome:
        return ""
    known = (*(COUNTS if counts else NUMBERS), *((OUTCOME,) if outcome else ()))
    if r.key in known:
        return ""
    if counts:
        return f".key = {shown(r.key)}: statistic = 'rate_per_hour' counts {' or '.join(known)}"
    near = nearest(r.key, known)
    hint = f"; did you mean {near!r}?" if near else "; see score.json for those there are"
    return f".key = {shown(r.key)}: is no number of the score{hint}"


def _check_fields(r: Requirement) -> str:
    reads = READS[r.kind]
    for name in BOUNDS:
        if getattr(r, name) is not None and name not in reads:
            return f" ({r.key}): {name} is not read by statistic = '{r.statistic}', which reads {', '.join(reads)}"
    return ""


def _check_bounds(r: Requirement) -> str:
    where = f" ({r.key})"
    if r.minimum is not None and r.maximum is not None and r.minimum > r.maximum:
        return f"{where}: minimum is above maximum"
    if r.kind == "every":
        return ""
    names = ("at_least", "at_most") if r.kind == "probability" else ("minimum", "maximum")
    given = [name for name in names if getattr(r, name) is not None]
    if len(given) != 1:
        return f"{where}: statistic = '{r.statistic}' needs {' or '.join(names)}, one of them"
    if r.kind == "probability" and not 0.0 < (r.bound or 0.0) < 1.0:
        return f"{where}: {given[0]} = {r.bound:g}: must be a probability above 0 and below 1"
    if r.kind == "rate_per_hour" and not (r.bound or 0.0) > 0.0:
        return f"{where}: {given[0]} = {r.bound:g}: must be a rate above 0"
    return ""


def _check_event(r: Requirement) -> str:
    where, counts = f" ({r.key})", r.kind == "rate_per_hour"
    if r.kind not in ("probability", "rate_per_hour"):
        return ""
    if counts and r.exposure not in ALLOWED[r.key]:
        said = "exposure is missing; it" if r.exposure is None else f"exposure = {r.exposure!r}:"
        return f"{where}: {said} must be one of {', '.join(ALLOWED[r.key])}"
    if r.key == OUTCOME:
        return _check_outcome(r)
    if r.equals is not None:
        return f"{where}: equals is for outcome; a number has minimum and maximum"
    if not counts and r.minimum is None and r.maximum is None:
        return f"{where}: needs minimum or maximum, or both, to say which values are the event"
    return ""


def _check_outcome(r: Requirement) -> str:
    known = get_args(Outcome)
    if r.equals is None:
        return f" ({r.key}): equals is missing; it must be one of {', '.join(known)}"
    if r.kind == "probability" and (r.minimum is not None or r.maximum is not None):
        return f" ({r.key}): has no minimum or maximum; it equals one of {', '.join(known)}"
    if r.equals in known:
        return ""
    near = nearest(r.equals, known)
    hint = f"; did you mean {near!r}?" if near else ""
    return f" ({r.key}): equals = {shown(r.equals)}: must be one of {', '.join(known)}{hint}"
