"""What breaks in flight: the campaigns of `uavsim.studies.faults`, 500 flights a case.

Asked is what the table of docs/faults.md says:

    healthy-…, spikes           no flag
    blocked and iced ports, stuck sensors, faster leaks, static ports
                                flagged within 2 s in at least 99 % of the flights, the right port first in at least
                                95 %, none crashed, none for nothing, none taken back while it lasts
    blocked-calm                flagged within 2 s of the true error passing 2 m/s in at least 99 %
    blocked-for-3-s             the same as the first, and taken back
    slow-leak-gusts             flagged within 2 s in at least 95 %

of every port that is flagged, what is told after that with `valid` is right: mean coverage at least 0.85.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from math import inf, isfinite, nan
from typing import Any

from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.tasks import numbers
from uavsim.studies.certify.verdict import Check, Verdict
from uavsim.studies.faults import CASES, FaultFlight, Summary, fly_case, summarise

EACH = 500
SECTION = 10_000  # seeds from one case to the next
WITHIN, SLOW, RIGHT, HONEST = 0.99, 0.95, 0.95, 0.85
HEALTHY = ("healthy-gusty", "healthy-calm", "healthy-climb", "healthy-speeds", "spikes")
BY_ERROR = ("blocked-calm",)
LEAK = "slow-leak-gusts"
FREED = "blocked-for-3-s"
SIZE = EACH * len(CASES)
SHOWN = 4  # flights of each case


@dataclass(frozen=True, slots=True)
class FaultTask:
    """A flight of a case.

    Attributes
    ----------
    number : int
        In the set: `SECTION` times the case's place, and the flight.
    seed : int
        The set's root; the flight's own seed is that plus its number.
    """

    number: int
    seed: int

    @property
    def case(self) -> str:
        """Its case."""
        return list(CASES)[self.number // SECTION]

    def fly(self) -> Row:
        """Fly it; numbers that do not exist are None."""
        flown = asdict(fly_case(CASES[self.case], self.seed + self.number))
        kept = {
            key: None if isinstance(value, float) and not isfinite(value) else value for key, value in flown.items()
        }
        return {"number": self.number, "case": self.case, **kept}

    def command(self) -> str:
        """Return what flies it again."""
        return f"python scripts/fault_campaign.py {self.case} --flights 1 --seed {self.seed + self.number}"


def tasks(seed: int, count: int | None = None) -> list[FaultTask]:
    """Return the set, or as many flights of each case as a part of it holds."""
    return [FaultTask(number, seed) for number in numbers(len(CASES), EACH, SECTION, count)]


def judge(rows: Sequence[Row], seed: int, before: dict[str, Any] | None = None) -> Verdict:
    """Hold the set against what is asked of it."""
    del before
    checks, table, found = [], [], []
    for name in CASES:
        some = [flight_of(row) for row in rows if row["case"] == name]
        if not some:
            continue
        s = summarise(name, some)
        checks.append(_check(name, s))
        table.append(_row(name, s))
        bad = [f for f in some if _is_wrong(name, f)][:SHOWN]
        for f in bad:
            wrong = f"{f.channel or 'no flag'} {f.kind} after {f.delay:.2f} s, false {f.false}, {f.outcome}"
            command = FaultTask(f.seed - seed, seed).command()
            found.append({"number": f.seed - seed, "case": name, "wrong": wrong, "command": command})
    return Verdict(tuple(checks), {"cases": table}, found)


def flight_of(row: Row) -> FaultFlight:
    """Return what a row tells of."""
    values: dict[str, Any] = {one.name: row[one.name] for one in fields(FaultFlight)}
    values = {key: nan if value is None else value for key, value in values.items()}
    return FaultFlight(**values)


def _is_wrong(name: str, flight: FaultFlight) -> bool:
    if name in HEALTHY:
        return flight.false > 0 or isfinite(flight.flagged)
    late = flight.unseen if name in BY_ERROR else flight.delay
    return bool(flight.false or late > 2.0 or flight.channel != CASES[name].channel)


def _check(name: str, s: Summary) -> Check:
    low, high = s.interval(s.false if name in HEALTHY else s.within)
    if name in HEALTHY:
        flagged = s.flights - s.missed if CASES[name].where else s.false
        found = f"{flagged} of {s.flights} flagged, crashed {s.crashed}"
        return Check(name, "0 flagged", found, flagged == 0 and s.crashed == 0)
    seen, least = (s.seen if name in BY_ERROR else s.within), (SLOW if name == LEAK else WITHIN)
    taken_back = s.flights - s.recovered if name == FREED else s.recovered
    told = f"{seen} of {s.flights}, right port {s.blamed}, for nothing {s.false}, crashed {s.crashed}, "
    told += f"{'not taken back' if name == FREED else 'taken back'} {taken_back}, coverage {s.coverage:.3f}"
    honest = not isfinite(s.coverage) or s.coverage >= HONEST
    met = seen >= least * s.flights and s.blamed >= RIGHT * (s.flights - s.missed)
    met = met and s.false == s.crashed == taken_back == 0 and honest
    wanted = f"≥ {100 * least:g} % within 2 s" + (" of 2 m/s off" if name in BY_ERROR else "")
    return Check(name, wanted, told, met, f"95 % interval {100 * low:.1f} … {100 * high:.1f} %")


def _row(name: str, s: Summary) -> dict[str, Any]:
    middle, late, longest = (None if one == inf else one for one in s.delays)
    return {
        "case": name,
        "flights": s.flights,
        "in 2 s": s.within,
        "in 2 s of 2 m/s off": s.seen,
        "median, s": middle,
        "99 %, s": late,
        "longest, s": longest,
        "right port": s.blamed,
        "missed": s.missed,
        "false": s.false,
        "taken back": s.recovered,
        "crashed": s.crashed,
        "coverage": _or_none(s.coverage),
        "greatest error, m/s": _or_none(s.error),
    }


def _or_none(value: float) -> float | None:
    return value if isfinite(value) else None
