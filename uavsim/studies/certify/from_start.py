"""What is broken before the launch: whether it is seen in time, said rightly and not taken back.

Times are from the truth. A flag is an event `airspeed_fault`; it stands until `airspeed_recovered`. The aircraft is
launched all the same, so each rule is about what is told:

    cover on,          from 0.3 s after the launch on each row is flagged or not valid, a flag comes at the latest 1 s
    total shut         after the wings are out (after the rail + 4 s if they never come), and blames the total port or
                       both
    total dead,        no valid airspeed is more than 3 m/s wrong later than 0.3 s after the launch
    static dead
    static shut        the static port is blamed before the aircraft is 10 m above its place of release, and until then
                       the bar is honest: no valid airspeed is off by more than 3.5 standard deviations
    accelerometer dead not ready before the release, with the accelerometer named
    thermometer        blamed within 5 s of its breaking, or not ready with the thermometer named; of one that sends no
                       number, nothing (its last value stays), or a temperature that cannot be

A dead sensor repeats its last value, or says the same number of its own from its first reading on; either is flown. A
cover is there from the beginning, and the tare is taken under it. None may be taken back while it lasts, which is to
the end. Half of the flights break at 0 s, half within the first 1.5 s; every second pair flies in gusts.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sensors import Streams
from uavsim.flight import Flight
from uavsim.studies.certify.figures import WRONG, Errors, Row, readiness
from uavsim.studies.certify.healthy import GUSTY
from uavsim.studies.certify.tasks import Task, numbers
from uavsim.studies.certify.verdict import Check, Verdict
from uavsim.studies.intervals import share_interval

EACH, ENOUGH = 300, 292
AFTER_LAUNCH = 0.3  # s
AFTER_WINGS = 1.0  # s
FOLDED = 4.0  # s after the rail's end
NAMED_WITHIN = 10.0  # m
HONEST = 3.5  # standard deviations
NAMED_AFTER = 5.0  # s
LATEST = 1.5  # s: the release is not before 1.6 s
SHOWN = 6  # flights of each case


def cover_on(flight: Flight) -> str:
    """Return what is wrong with a flight whose total port is covered; nothing if it is right."""
    errors, flags = Errors(flight), flagged_spans(flight)
    launch = flight.score["launch"]["true_time"]
    late = errors.t >= launch + AFTER_LAUNCH
    bad = late & errors.valid & ~covered_by(flags, errors.t)
    wings, exit_time = (flight.score["flight"][key] for key in ("wing_out_time", "rail_exit_time"))
    limit = exit_time + FOLDED if wings is None else wings + AFTER_WINGS
    first = blames(flight)[0] if blames(flight) else None
    if bad.any():
        return f"valid and not flagged for {bad.sum()} rows from {errors.t[bad][0] - launch:.2f} s after the launch on"
    if first is None or first["t"] > limit:
        return "never flagged" if first is None else f"flagged {first['t'] - limit:.2f} s too late"
    return "" if first["channel"] in ("total", "both") else f"blames the {first['channel']}"


def dead(flight: Flight) -> str:
    """Return what is wrong with a flight one of whose pressures is dead."""
    errors = Errors(flight)
    launch = flight.score["launch"]["true_time"]
    bad = errors.valid & (errors.t >= launch + AFTER_LAUNCH) & ~(np.abs(errors.error) <= WRONG)
    if not bad.any():
        return ""
    k = int(np.argmax(np.where(bad, np.abs(errors.error), 0.0)))
    return f"valid and {errors.error[k]:.1f} m/s off {errors.t[k] - launch:.2f} s after the launch"


def static_shut(flight: Flight) -> str:
    """Return what is wrong with a flight whose static port is shut."""
    errors = Errors(flight)
    launch, truth = flight.score["launch"]["true_time"], flight.truth
    named = next((e for e in blames(flight) if e["channel"] == "static"), None)
    up = truth["altitude"].to_numpy() - float(truth["altitude"].iloc[0])
    passed = np.flatnonzero(up >= NAMED_WITHIN)
    limit = float(truth["t"].iloc[passed[0]]) if passed.size else float("inf")
    wrong = next((e for e in blames(flight) if e["channel"] != "static"), None)
    if wrong is not None and (named is None or wrong["t"] < named["t"]):
        return f"blames the {wrong['channel']} at {wrong['t'] - launch:.2f} s"
    if named is None or named["t"] > limit:
        return "never named" if named is None else f"named {named['t'] - limit:.2f} s after 10 m"
    until = errors.valid & (errors.t >= launch) & (errors.t < named["t"])
    off = until & ~(np.abs(errors.error) <= HONEST * errors.sd)
    return f"a bar that is not honest for {off.sum()} rows" if off.any() else ""


def not_ready(flight: Flight, channel: str) -> str:
    """Return what is wrong with a flight that must not be ready because of a part."""
    ready, reasons = readiness(flight, flight.score["launch"]["release_time"])
    if ready is None:
        return "readiness is not told"
    if ready:
        return "ready"
    return "" if channel in reasons else f"not ready because of: {reasons}"


def named(flight: Flight, channel: str) -> str:
    """Return what is wrong with a flight whose part must be blamed, or be the reason of not being ready."""
    first = next((e["t"] for e in blames(flight) if e["channel"] == channel), None)
    if first is not None and first <= LATEST + NAMED_AFTER:
        return ""
    found = not_ready(flight, channel)
    return found and (found if first is None else f"blamed at {first:.2f} s")


def blames(flight: Flight) -> list[dict[str, Any]]:
    """Return the events that blame a channel."""
    return [e for e in flight.events if "fault" in e["event"]]


def flagged_spans(flight: Flight) -> list[tuple[float, float]]:
    """Times from each flag to its return."""
    spans: list[tuple[float, float]] = []
    since: dict[str, float] = {}
    for event in flight.events:
        channel = str(event.get("channel", ""))
        if "fault" in event["event"]:
            since.setdefault(channel, event["t"])
        elif event["event"] == "airspeed_recovered":
            ended = [channel] if channel in since else list(since)
            spans += [(since.pop(one), event["t"]) for one in ended]
    return spans + [(begun, float("inf")) for begun in since.values()]


def covered_by(spans: Sequence[tuple[float, float]], t: Any) -> Any:
    """Which of some times lie within spans."""
    found = np.zeros(np.shape(t), bool)
    for begun, ended in spans:
        found |= (t >= begun) & (t < ended)
    return found


def hold(judged: Callable[[Flight], str], flight: Flight) -> Row:
    """Return whether a flight is right, and what is wrong with it."""
    launched = flight.score["launch"]["true_time"] is not None
    wrong = judged(flight) if launched else "not launched"
    back = [e["t"] for e in flight.events if e["event"] == "airspeed_recovered"]
    if back and not wrong:
        wrong = f"taken back at {back[0]:.2f} s"
    return {"right": not wrong, "wrong": wrong}


@dataclass(frozen=True, slots=True)
class Case:
    """Something that is broken.

    Attributes
    ----------
    ways : tuple of str
        Overrides, ``KEY=VALUE`` with ``START`` for the time at which it breaks; flights take them in turn.
    judged : callable
    """

    ways: tuple[str, ...]
    judged: Callable[[Flight], str]


def _faults(where: str, *kinds: str) -> tuple[str, ...]:
    return tuple(f"{where}=[{{{kind},start=START}}]" for kind in kinds)


STUCK, SILENT, NO_NUMBER = 'kind="stuck"', 'kind="dropout"', 'kind="invalid"'
THERMOMETER = partial(named, channel="thermometer")
CASES: dict[str, Case] = {
    "cover on": Case(("air_data.cover_left_on=true",), cover_on),
    "total shut": Case(_faults("air_data.total_port.faults", 'kind="blocked"'), cover_on),
    "total dead": Case(_faults("air_data.total.faults", STUCK, 'kind="dead",size=98000'), dead),
    "static dead": Case(_faults("air_data.static.faults", STUCK, 'kind="dead",size=98000'), dead),
    "static shut": Case(_faults("air_data.static_port.faults", 'kind="blocked"'), static_shut),
    "accelerometer dead": Case(
        _faults("accelerometer.faults", STUCK, 'kind="dead",size=0'), partial(not_ready, channel="accelerometer")
    ),
    "thermometer NaN": Case(_faults("air_data.thermometer_faults", NO_NUMBER), THERMOMETER),
    "thermometer silent": Case(_faults("air_data.thermometer_faults", SILENT), THERMOMETER),
    "thermometer out of range": Case(
        _faults("air_data.thermometer_faults", 'kind="dead",size=500', 'kind="dead",size=100'), THERMOMETER
    ),
}
SIZE = EACH * len(CASES)
SECTION = 10_000  # numbers from one case to the next, so that a further case changes none


def task(number: int, seed: int) -> Task:
    """Return a flight of the set."""
    place, flight = divmod(number, SECTION)
    name = list(CASES)[place]
    case = CASES[name]
    drawn = float(Streams(seed, number)("certify.start").uniform(0.01, LATEST))
    start = 0.0 if flight % 2 == 0 else round(drawn, 3)
    gusts = flight // 2 % 2 == 1
    way = case.ways[flight // 4 % len(case.ways)].replace("START", f"{start:g}")
    levels = {"case": name, "start": start, "wind": "gusty" if gusts else "calm"}
    overrides = (*(GUSTY if gusts else ()), "duration=20", way)
    return Task(number, "catapult", overrides, seed, levels, rule=partial(hold, case.judged))


def tasks(seed: int, count: int | None = None) -> list[Task]:
    """Return the set, or as many flights of each case as a part of it holds."""
    return [task(number, seed) for number in numbers(len(CASES), EACH, SECTION, count)]


def judge(rows: Sequence[Row], seed: int, before: dict[str, Any] | None = None) -> Verdict:
    """Hold the set against what is asked of it: at least 292 of 300, or as large a share of fewer."""
    del before
    checks, table, found = [], [], []
    for name in CASES:
        some = [row for row in rows if row["case"] == name]
        if not some:
            continue
        right = sum(bool(row.get("right")) for row in some)
        low, high = share_interval(right, len(some))
        reasons = sorted({_kind(row) for row in some if not row.get("right")})
        counts = {one: sum(_kind(row) == one for row in some if not row.get("right")) for one in reasons}
        told = "; ".join(f"{count} {one}" for one, count in sorted(counts.items(), key=lambda one: -one[1]))
        enough = right >= ENOUGH / EACH * len(some)
        met = None if len(some) < EACH and enough else enough
        said = f"{right} of {len(some)}" + (f" ({told})" if told else "")
        checks.append(Check(name, f"≥ {ENOUGH} of {EACH}", said, met))
        table.append({"case": name, "flights": len(some), "right": right, "low": low, "high": high, "wrong": told})
        for row in [row for row in some if not row.get("right")][:SHOWN]:
            command = task(int(row["number"]), seed).command()
            wrong = row.get("wrong") or f"{row['outcome']}: {row.get('reason', '')}"
            found.append({"number": row["number"], "case": name, "wrong": wrong, "command": command})
    ready = readiness_rows(rows)
    if ready:
        checks.append(_ready(ready))
    return Verdict(tuple(checks), {"cases": table, "readiness": ready}, found)


DEAD = {
    "a pressure": ("total dead", "static dead"),
    "the accelerometer": ("accelerometer dead",),
    "the thermometer": ("thermometer NaN", "thermometer silent", "thermometer out of range"),
}


def readiness_rows(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return how often an aircraft was ready though a sensor of it was dead, with 95 % bounds.

    Of one that dies within the last second and a half before the release less has been seen than of one that is dead
    from the beginning; both are told. What nothing shows before the launch, a cover or a port that is shut, is left
    out.
    """
    found = []
    for sensor, cases in DEAD.items():
        for when, early in (("from the beginning", True), ("later", False)):
            some = [row for row in rows if row["case"] in cases and (row["start"] == 0.0) is early]
            if not some:
                continue
            told = [row for row in some if row.get("ready") is not None]
            wrong = sum(bool(row["ready"]) for row in told)
            low, high = share_interval(wrong, len(told)) if told else (None, None)
            name = {"dead": sensor, "since": when}
            found.append({**name, "flights": len(some), "told": len(told), "ready": wrong, "low": low, "high": high})
    return found


def _ready(found: Sequence[dict[str, Any]]) -> Check:
    flights, told, wrong = (sum(row[key] for row in found) for key in ("flights", "told", "ready"))
    low, high = share_interval(wrong, told) if told else (0.0, 1.0)
    said = f"{wrong} of {told}; {100 * low:.2f} … {100 * high:.2f} %"
    note = "95 %, Clopper-Pearson; no bound is asked of it but the accelerometer's own"
    return Check("ready though a sensor is dead", "told", said, None if told < flights else True, note)


def _kind(row: Row) -> str:
    """What is wrong with a flight, without its numbers."""
    wrong = str(row.get("wrong") or row["outcome"])
    words = [word for word in wrong.split() if not any(sign.isdigit() for sign in word)]
    return " ".join(words)
