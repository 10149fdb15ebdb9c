"""Launches that detectors are tried on, and what counts as detecting one.

A trial is a recording with one launch in it; a detector begins with it and its first alarm decides:

    before the onset                       a false alarm; the launch is not detected, for the wing has opened by then
    until 0.3 s after the stroke's end     a detection; its latency counts from the onset, and from the 4.5 g crossing
    later, or never                        a miss

With a flight computer behind it, what opens the wings is judged too (`uavsim.studies.wing_commands`): a bump that was
no launch is forgotten after its delay, and a launch counts that was followed to its end with enough speed gained. The
wings are commanded a delay after that: before the stroke's end that is on the rail, and the launch is lost.

`Drawn` draws from the distributions of `uavsim.studies.signals`. `Flown` flies a scenario: as long as nothing is
commanded the truth does not depend on what the sensor reads, so one flight of JSBSim serves any number of sensors. It
is exact, not an approximation: the plant is flown without a command, as before every detection.
"""

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sensors import Accelerometer, Streams, Vibration
from uavsim.cosim import draw, make_plant, shaken
from uavsim.dispersions import resolved
from uavsim.judged import Judged
from uavsim.onboard.flight_computer import FlightComputerSettings
from uavsim.onboard.launch import DetectorSettings
from uavsim.scenario import Scenario
from uavsim.studies.detections import BatchDetector
from uavsim.studies.signals import LaunchSettings, LaunchTruth, record_launches
from uavsim.studies.wing_commands import commands

Array = NDArray[np.float64]

WAIT = (1.5, 2.0)  # s before onset: rules that take the mean on the rail off see nothing in their first second
GRACE = 0.3  # s after the stroke's end until which an alarm is a detection
FLIGHTS = 4  # of JSBSim, which the sensors of `Flown` share
NOISE = 1_000_000  # first index of the sensors' streams, apart from those of flights
LONGEST = 2.0  # s after release until which a flight without a command is followed


@dataclass(frozen=True, slots=True)
class Trials:
    """Recordings of launches.

    Attributes
    ----------
    force
        Of each trial, shape (n, 3), m/s².
    start, rate
        Of each trial: time of its first sample, s, and samples a second, Hz.
    truths
        Onset, crossing and end of each, s.
    """

    force: Sequence[Array]
    start: Array
    rate: Array
    truths: tuple[LaunchTruth, ...]


class Launches(Protocol):
    """Where trials come from; trial i of a seed is the same whatever others are read."""

    @property
    def rate(self) -> float:
        """Nominal samples a second, Hz."""

    def read(self, seed: int, first: int, count: int) -> Trials:
        """Return trials `first` … `first` + `count` - 1 of a seed."""


@dataclass(frozen=True)
class Drawn:
    """Launches from distributions: a wait of 1.5 to 2 s, whatever the settings say, and `rate` Hz."""

    settings: LaunchSettings = field(default_factory=LaunchSettings)
    rate: float = 1000.0

    def read(self, seed: int, first: int, count: int) -> Trials:
        """Return some trials; see `Launches`."""
        recorded = record_launches(replace(self.settings, wait=WAIT), seed, count, self.rate, first)
        return Trials(list(recorded.f), np.zeros(count), np.full(count, self.rate), recorded.truths)


@dataclass(frozen=True)
class Flown:
    """Launches of a scenario: few flights of JSBSim, each felt by any number of sensor units.

    Every trial draws its own unit of the accelerometer, its noise, clock and vibration. Samples come at the unit's own
    rate; jitter of the sampling instants is drawn, but detectors are told regular times.

    Attributes
    ----------
    scenario
        What is flown; a seed that is read takes the place of its own.
    flights
        How many flights a seed has; trial i is felt in flight i mod `flights`.
    """

    scenario: Scenario
    flights: int = FLIGHTS

    @property
    def rate(self) -> float:
        """Samples a second, Hz."""
        return self.scenario.accelerometer.description().rate

    @cached_property
    def _known(self) -> "dict[tuple[int, int], _Flight]":
        return {}

    def fly(self, seed: int) -> None:
        """Fly what a seed needs, so that reading is quick."""
        for i in range(self.flights):
            if (seed, i) not in self._known:
                self._known[seed, i] = _fly(resolved(self.scenario.with_seed(seed), i))

    def read(self, seed: int, first: int, count: int) -> Trials:
        """Return some trials; see `Launches`.

        Raises
        ------
        ValueError
            If the catapult does not move the aircraft.
        """
        self.fly(seed)
        with _uncollected():
            felt = [
                _feel(self._known[seed, i % self.flights], Streams(seed, NOISE + i))
                for i in range(first, first + count)
            ]
        force, start, rate, truths = zip(*felt, strict=True) if felt else ((), (), (), ())
        return Trials(force, np.array(start, float), np.array(rate, float), tuple(truths))


@dataclass(frozen=True)
class _Flight:
    """Truth of a flight without commands: force at each step, release, rail exit and judged times, s."""

    scenario: Scenario  # its own, with what was drawn
    force: tuple[tuple[float, float, float], ...]
    first: int  # step of the first force
    release: float
    exit: float
    push: float  # m/s²
    rise: float  # s, of it
    truth: LaunchTruth


@contextmanager
def _uncollected() -> Iterator[None]:
    """Keep the collector from counting a unit's long lists again and again: half of the time."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


def _fly(scenario: Scenario) -> _Flight:
    drawn = draw(scenario)
    plant = make_plant(scenario, drawn)
    last = min(scenario.duration, drawn.release_time + LONGEST)
    left, exit_time = plant.on_rail, inf
    while plant.t < min(last, exit_time + GRACE) and plant.finite and plant.aloft:
        plant.step()
        if left and not plant.on_rail:
            left, exit_time = False, plant.t
    table = plant.truth()
    judged = Judged(scenario, {"truth": table}, [], drawn.release_time, "", {})
    onset = judged.true_time
    if onset is None:
        raise ValueError(f"{scenario.name}: the aircraft does not move within {LONGEST:g} s of its release")
    axis = scenario.launch_axis
    force = np.column_stack([table[name] for name in ("fx", "fy", "fz")])
    axial = force[:, "xyz".index(axis[1])] * (-1.0 if axis[0] == "-" else 1.0)
    end = min(exit_time, float(judged.time[-1]))
    first = max(0, round((drawn.release_time - WAIT[0]) * scenario.plant.step_rate))
    push, rise = shaken(scenario, drawn, plant)
    truth = LaunchTruth(onset, judged.crossing_time, float(axial.max()), end)
    rows: tuple[tuple[float, float, float], ...] = tuple(map(tuple, force[first:].tolist()))
    return _Flight(scenario, rows, first, drawn.release_time, exit_time, push, rise, truth)


def uncommanded(scenario: Scenario, index: int = 0) -> tuple[Array, float, float]:
    """Fly one flight without a command.

    Returns
    -------
    tuple
        True force from `WAIT` before its release on, shape (n, 3), m/s²; steps a second, Hz; and when the stroke ends,
        s after the first of them.

    Raises
    ------
    ValueError
        If the catapult does not move the aircraft.
    """
    flight, rate = _fly(resolved(scenario, index)), scenario.plant.step_rate
    return np.array(flight.force), float(rate), flight.truth.end - flight.first / rate


def _feel(flight: _Flight, streams: Streams) -> tuple[Array, float, float, LaunchTruth]:
    """Let one unit feel a flight; return its readings, the time of the first, its rate, and the truth, s."""
    scenario = flight.scenario
    settings, rate = scenario.accelerometer, scenario.plant.step_rate
    dt, begin = 1.0 / rate, flight.first / rate
    vibration = Vibration(
        scenario.vibration,
        streams,
        dt=dt,
        release_time=flight.release - begin,
        plateau=flight.push,
        rise=flight.rise,
        scale=settings.vibration_scale,
    )
    part = Accelerometer.from_settings(settings, streams, dt=dt)
    readings: list[float] = []
    exited, step, left = flight.exit - begin, part.step, False
    for k, force in enumerate(flight.force):
        t = k / rate
        for reading in step((t, vibration.on(force))):
            readings.extend(reading)
        if not left and t >= exited:
            left = True
            vibration.leave_rail(t + dt)
    table = np.array(readings).reshape(-1, 4)
    actual = part.description.rate * (1.0 + part.rate_error)
    return table[:, 1:], begin + float(table[0, 0]), actual, flight.truth


@dataclass(frozen=True, slots=True)
class Verdicts:
    """What a detector made of some trials, each shape (trials,): latencies in s, NaN where there is none.

    Attributes
    ----------
    early
        Whether its first alarm was before the onset.
    since_onset, since_crossing
        Latencies of those that were detected, s.
    commanded
        Whether the flight computer behind it opens the wings after the stroke; all False without one.
    on_rail
        Whether it opens them before.
    """

    early: NDArray[np.bool_]
    since_onset: Array
    since_crossing: Array
    commanded: NDArray[np.bool_]
    on_rail: NDArray[np.bool_]

    @property
    def detected(self) -> NDArray[np.bool_]:
        """Whether the launch was detected."""
        return np.isfinite(self.since_onset)


def judge(
    settings: DetectorSettings, trials: Trials, rate: float, computer: FlightComputerSettings | None = None
) -> Verdicts:
    """Try a detector.

    Parameters
    ----------
    settings
        Of the detector.
    trials
        What it is tried on.
    rate
        Nominal samples a second for which it is built, Hz.
    computer
        Of the aircraft behind it; None: the wings are not looked at.

    Raises
    ------
    ValueError
        Settings that do not fit together.
    """
    detector = BatchDetector(settings, rate)
    found = detector.first(trials.force, trials.rate)
    alarm = np.where(found >= 0, trials.start + found / trials.rate, inf)
    onset = np.array([truth.onset for truth in trials.truths])
    end = np.array([truth.end for truth in trials.truths])
    crossing = np.array([np.nan if truth.crossing is None else truth.crossing for truth in trials.truths])
    early = alarm < onset
    seen = np.where(~early & (alarm <= end + GRACE), alarm, np.nan)
    opened = np.full(len(end), inf)
    if computer is not None:
        for i, first in enumerate(found.tolist()):
            over = commands(detector, trials.force[i], computer, first=first, rate=float(trials.rate[i]))
            if over.size:
                opened[i] = trials.start[i] + over[0] / trials.rate[i] + computer.wing_delay
    return Verdicts(early, seen - onset, seen - crossing, np.isfinite(opened) & (opened >= end), opened < end)


def join(parts: Sequence[Verdicts]) -> Verdicts:
    """Put verdicts on several lots of trials together."""
    return Verdicts(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Verdicts)))
