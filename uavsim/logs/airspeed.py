"""The airspeed of a log: the onboard code of a flight, fed with the log's readings.

Detector and pressures of a log may be days of somebody's life: the aircraft is carried about, flies, lands and flies
again. So a log is cut where the aircraft stands still between two flights, and each flight has a flight computer of its
own, as one that is switched on there:

    at rest: tare    launch recognised: hand-over    flight    at rest again: the next

The launch is the one that the detector has found. Where none is found, as of a throw by hand, a take-off from wheels or
a log that begins in the air, the aircraft flies from when on its pressures alone have told a valid airspeed of
`FLIES` for `HOLDS`; it is told so (`FlightComputer.airborne`), and the log has the event ``in_flight``.

The pair is tared at rest before a launch (`taring`), unless it is said otherwise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import inf
from typing import Literal

import numpy as np

from uavsim.cosim import Believed, Onboard
from uavsim.failure import PartError
from uavsim.logs.beliefs import KEYS, Noise, believed_of_log, known_age, parse_noise, untared
from uavsim.logs.clocks import Delay, delay_of
from uavsim.logs.head import Head, head_of, lacking
from uavsim.logs.pushed import odd_rise
from uavsim.logs.quiet import Rests, rests_of
from uavsim.logs.recording import Array, Recording
from uavsim.logs.taring import Tared, tared
from uavsim.onboard.interface import AirReading, Estimate, Reading
from uavsim.scenario import Scenario, load_scenario

# m/s and s: no fixed wing flies slower, no gust and no breath into a pitot lasts so long. By hand
FLIES, HOLDS = 9.0, 3.0
BETWEEN = 3.0  # s at rest that part two flights. By hand
KEPT = 60.0  # s of rest before a launch that are replayed; a flight computer has nothing from an hour of standing about


@dataclass(frozen=True, slots=True)
class AirSettings:
    """How the airspeed of a log is estimated.

    Attributes
    ----------
    scenario
        Flight computer, estimator, and the parts that are believed in.
    named
        Keys that the user gave, without their values.
    noise
        What the user says of it.
    """

    scenario: Scenario
    named: tuple[str, ...] = ()
    noise: Noise = field(default_factory=Noise)


def air_settings(given: Sequence[str], noise: str | None = None) -> AirSettings:
    """Settings from ``KEY=VALUE`` of a scenario and from what the user says of the noise.

    Raises
    ------
    ValueError
        One line: a key that means nothing for a log, or a value that is not allowed.
    """
    keys = [text.partition("=")[0].strip() for text in given]
    other = [key for key in keys if key.partition(".")[0] not in KEYS or "." not in key]
    if other:
        raise ValueError(f"--set {other[0]!r}: of a log only {', '.join(f'{key}.…' for key in KEYS)} can be set")
    scenario = load_scenario("catapult", overrides=given)
    return AirSettings(scenario, tuple(keys), Noise() if noise is None else parse_noise(noise))


@dataclass(frozen=True, slots=True)
class Span:
    """One flight of a log: from when to when it is replayed, its launch and its tare, s."""

    start: float
    end: float
    launch: float | None
    tare: Tared | None


@dataclass(frozen=True, slots=True, eq=False)
class Aired:
    """What the onboard code makes of a log.

    Attributes
    ----------
    rows : numpy.ndarray
        What the head says, shape (n, 6), on the force's clock.
    estimates : list
        Of all flights, in their order.
    events : list
        What was noticed, each with `t` and `event`; no launch is among them, which the detector has told.
    spans : tuple of Span
    delay : Delay or None
        What both clocks differ by, if a launch shows it.
    head : Head
    told : Believed
    said : tuple of str
        What was believed, assumed and found, a sentence each.
    reason : str
        What ended it before its end; empty if nothing did.
    """

    rows: Array
    estimates: list[Estimate]
    events: list[dict[str, object]]
    spans: tuple[Span, ...]
    delay: Delay | None
    head: Head
    told: Believed
    said: tuple[str, ...]
    reason: str = ""


def air_of(recording: Recording, settings: AirSettings, launches: list[float]) -> Aired | str | None:
    """Estimate the airspeed of a log; a sentence that says what is lacking, or None if there are no pressures at all.

    Parameters
    ----------
    recording
        Readings.
    settings
        How.
    launches
        When the detector recognised one, s.
    """
    head = head_of(recording.series)
    if head is None:
        return lacking(recording.series)
    if recording.cuts:
        return "no airspeed is estimated: the clock began anew within the log; replay its parts one by one"
    settings = _of_kind(settings, head)
    said = list(head.remarks)
    age = known_age(settings.scenario, settings.named)
    delay = delay_of(head, recording.readings, launches)
    if delay is not None:
        head = _on_one_clock(head, delay, age, said)
    if not _share(recording.readings, head):
        return (
            f"no airspeed is estimated: pressures of {head.total.t[0]:.3f} to {head.total.t[-1]:.3f} s and force of "
            f"{recording.span[0]:.3f} to {recording.span[1]:.3f} s share no time, and no launch shows in both"
        )
    if odd := odd_rise(head, recording.readings, launches):
        return f"no airspeed is estimated: {odd}"
    rests = rests_of(recording.readings, head)
    spans = cut(recording, head, rests, launches, settings)
    belief = believed_of_log(
        recording,
        head,
        settings.scenario,
        named=settings.named,
        noise=settings.noise,
        rests=rests,
    )
    said += belief.said
    rows = head.rows()
    estimates: list[Estimate] = []
    events: list[dict[str, object]] = []
    reason = ""
    for span in spans:
        said.append(_told_of(span))
        told = belief.told
        if span.tare is None:
            told = replace(told, noise=untared(told.noise, head))
        else:
            told = replace(told, tare=span.tare.window, noise=replace(told.noise, covered=span.tare.still))
        onboard = OfLog(settings.scenario, told, Recognised([at for at in launches if span.start <= at < span.end]))
        try:
            onboard.read(_readings(recording.readings, span), _readings(rows, span))  # type: ignore[arg-type]
        except PartError as failure:
            reason = str(failure)
        estimates += onboard.estimates
        events += [event for event in onboard.computer.events if event["event"] != "launch_detected"]
        if reason:
            break
    return Aired(rows, estimates, events, tuple(spans), delay, head, belief.told, tuple(said), reason)


def _of_kind(settings: AirSettings, head: Head) -> AirSettings:
    """Settings of a scenario whose head is of the log's kind."""
    scenario = settings.scenario
    kind: Literal["absolute", "differential"] = "differential" if head.differential else "absolute"
    if scenario.air_data.kind == kind:
        return settings
    return replace(settings, scenario=replace(scenario, air_data=replace(scenario.air_data, kind=kind)))


class Recognised:
    """A detector that says when a launch was recognised by the one that has watched the log."""

    def __init__(self, launches: Sequence[float]) -> None:
        self._launches = frozenset(launches)

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take a reading; True on one that decided."""
        return t in self._launches

    def reset(self) -> None:
        """Nothing is kept."""


class OfLog(Onboard):
    """The flight computer of a log, which is told that it flies where no launch was recognised."""

    def __init__(self, scenario: Scenario, told: Believed, detector: Recognised) -> None:
        super().__init__(scenario, told, detector, inf)
        self._since = inf

    def air_data(self, reading: AirReading) -> None:
        """Take one reading of the head."""
        before = len(self.estimates)
        super().air_data(reading)
        if self.computer.state != "waiting" or len(self.estimates) == before:
            return
        t, airspeed, *_, valid, _, _ = self.estimates[-1]
        if not (valid and airspeed >= FLIES):
            self._since = inf
        elif self._since == inf:
            self._since = t
        elif t - self._since >= HOLDS:
            self.computer.airborne(t)


def _on_one_clock(head: Head, delay: Delay, age: float, said: list[str]) -> Head:
    """Set the head's clock, if it is not that of the force; `age` is what its pressures are known to be late by, s."""
    large = abs(delay.delay) >= 1.0
    what = f"{abs(delay.delay):.3f} s" if large else f"{1e3 * abs(delay.delay):.1f} ± {1e3 * delay.sd:.1f} ms"
    seen = f"the launch shows in the pressure {what} {'later' if delay.delay > 0.0 else 'earlier'} than in the force"
    if age > 0.0:
        seen += f" ({1e3 * age:.1f} ms are known of)"
    shift = -delay.beyond(age, head.total.period)
    if shift == 0.0:
        said.append(f"{seen}: one clock")
        return head
    said.append(f"{seen}: the head's clock is set by {shift:+.4f} s")
    together = head.static.source.rpartition(": ")[0] == head.total.source.rpartition(": ")[0]
    if not together and abs(shift) > 1.0:
        said.append("the static pressure of another table is taken to have the same clock as the total one")
    warm = None if head.temperature is None else head.temperature.later(shift)
    return replace(head, total=head.total.later(shift), static=head.static.later(shift), temperature=warm)


def _share(readings: Array, head: Head) -> bool:
    return bool(head.total.t[0] < readings[-1, 0] and head.total.t[-1] > readings[0, 0])


def cut(recording: Recording, head: Head, rests: Rests, launches: list[float], settings: AirSettings) -> list[Span]:
    """Cut a log into flights where the aircraft stands still, and find each one's tare."""
    first, last = recording.span
    between = [rest for rest in rests.still if rest.length >= BETWEEN and rest.start > first + BETWEEN]
    edges = [first]
    for rest in between:
        after = [at for at in launches if at > rest.start]
        if after and any(edges[-1] <= at < rest.start for at in launches):
            edges.append(max(rest.start, min(rest.end, after[0]) - KEPT))
    edges.append(inf)
    spans = []
    for start, end in pairwise(edges):
        launch = next((at for at in launches if start <= at < end), None)
        tare = tared(head, rests, start, end, launch, settings.scenario, settings.named)
        spans.append(Span(start, min(end, last + 1.0), launch, tare))
    return spans


def _told_of(span: Span) -> str:
    what = "no launch recognised" if span.launch is None else f"launch at {span.launch:.3f} s"
    if span.tare is None:
        return f"{what}: the pair is not tared, for the log has no rest before"
    start, end = span.tare.window
    how = ("under a cover" if span.tare.told else "in still air") if span.tare.still else "in the open"
    return f"{what}: tared {how} from {start:.2f} to {end:.2f} s"


def _readings(rows: Array, span: Span) -> list[Reading] | list[AirReading]:
    """Rows of a span as plain numbers."""
    first, last = np.searchsorted(rows[:, 0], (span.start, span.end))
    found: list[Reading] = list(map(tuple, rows[first:last].tolist()))
    return found
