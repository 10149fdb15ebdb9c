"""What every part on board promises, whatever it reads: checks that take what makes a part.

* A step returns: never an exception, never an answer of another kind than the protocol's.
* No estimate is valid that is not finite or outside the plausible; no standard deviation and no NIS is below 0.
* Memory is constant: what a part holds does not grow with what it has read.
* It recovers: so long after the last nonsense a launch is recognised and a flight estimated as if there had been none.
"""

import math
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any

from uavsim.onboard.airspeed import Estimate, Estimator
from uavsim.onboard.flight_computer import FlightComputer
from uavsim.onboard.launch import Detector
from uavsim.onboard.plausible import LEAST_PRESSURE, MOST_PRESSURE
from uavsim.onboard.stamps import LATEST
from uavsim.testing.hostile import Force, Row, Sample

REST, PUSH = 3.0, 60.0  # m/s²; of a rail, and of a launch that every detector recognises
DETECTOR_RECOVERY = 3.0  # s; a mean on the rail that was spoilt is used for 1.5, and a new one takes two blocks of 0.5
STEPS = 20_000  # readings between two looks at the memory
KEPT = (list, dict, set, deque, bytearray)  # what a class of somebody's may hold for all its objects
LOOSE = 50  # things that may be held more than before: a gap more, a reading more


def expect(condition: bool, problem: object) -> None:
    """Raise AssertionError that says what is wrong, unless the condition holds."""
    if not condition:
        raise AssertionError(problem)


def footprint(thing: Any) -> int:
    """Return how many things a part holds, itself included: numbers of arrays and lists, attributes, and so on."""
    seen: set[int] = set()
    count, stack = 0, [thing]
    while stack:
        held = stack.pop()
        if id(held) in seen or isinstance(held, type) or callable(held):
            continue
        seen.add(id(held))
        count += 1
        if isinstance(held, str | bytes | bytearray):
            count += len(held)
        elif isinstance(held, dict):
            stack += held.values()
        elif isinstance(held, list | tuple | set | deque):
            count += len(held)
            stack += [each for each in held if not isinstance(each, int | float | str)]
        elif hasattr(held, "nbytes"):
            count += int(held.nbytes) // 8
        else:
            names = [name for kind in type(held).__mro__ for name in getattr(kind, "__slots__", ())]
            stack += [getattr(held, name) for name in names if hasattr(held, name)]
            stack += [each for kind in type(held).__mro__ for each in vars(kind).values() if isinstance(each, KEPT)]
            stack += vars(held).values() if hasattr(held, "__dict__") else []
    return count


class Memory:
    """Looks at a part now and then; `check` at the end."""

    def __init__(self, part: Any, steps: int = STEPS) -> None:
        self.part, self.sizes, self.k, self.steps = part, [footprint(part)], 0, steps

    def look(self) -> None:
        """Count a reading; look at every so many."""
        self.k += 1
        if self.k % self.steps == 0:
            self.sizes.append(footprint(self.part))

    def check(self) -> None:
        """Look once more; AssertionError if it has grown."""
        self.sizes.append(footprint(self.part))
        half = (len(self.sizes) + 1) // 2
        expect(max(self.sizes[half:]) <= max(self.sizes[:half]) + LOOSE, f"memory grows: {self.sizes}")


def honest(estimate: Estimate | None, fastest: float) -> None:
    """Check an estimate, whatever led to it."""
    if estimate is None:
        return
    t, speed, sd, raw, total, static, valid, nis_total, nis_static = estimate
    expect(-LATEST < t < LATEST, estimate)
    expect(valid is True or valid is False, estimate)
    expect(not any(value < 0.0 for value in (speed, sd, raw, nis_total, nis_static)), estimate)
    if valid:
        expect(0.0 <= speed <= fastest, estimate)
        expect(0.0 <= sd <= fastest, estimate)
        expect(LEAST_PRESSURE <= static <= MOST_PRESSURE, estimate)
        expect(math.isfinite(total), estimate)


def detector_returns(make: Callable[[], Detector], forces: Iterable[Force]) -> int:
    """Drive a detector; it is reset after each launch that it recognises. Return how many those were."""
    detector = make()
    memory, found = Memory(detector), 0
    for t, fx, fy, fz in forces:
        answer = detector.step(t, fx, fy, fz)
        expect(answer is True or answer is False, (answer, t, fx, fy, fz))
        if answer:
            found += 1
            expect(detector.step(t, fx, fy, fz) is False, "recognised twice")
            detector.reset()
        memory.look()
    memory.check()
    return found


def launch_after(detector: Detector, begin: float, rest: float, rate: float = 1000.0) -> float:
    """Rest, then push for 0.6 s; return how long after the push's begin it is recognised, s, NaN if it is not."""
    for k in range(round(rest * rate)):
        if detector.step(begin + k / rate, REST, 0.0, -9.4):
            detector.reset()
    onset = begin + rest
    for k in range(round(0.6 * rate)):
        if detector.step(onset + k / rate, PUSH, 0.0, -9.4):
            return k / rate
    return math.nan


def detector_recovers(detector: Detector, nonsense: Iterable[Force], begin: float, latest: float) -> None:
    """Check that `DETECTOR_RECOVERY` of sound readings after nonsense a launch is recognised.

    Parameters
    ----------
    detector : Detector
    nonsense : iterable of tuple
        What it reads first; a launch that it recognises there is followed by a reset, as in flight.
    begin : float
        Time of the first sound reading, s.
    latest : float
        After the launch's begin, s: what a new one takes, and what it may be later by.
    """
    for reading in nonsense:
        if detector.step(*reading):
            detector.reset()
    delay = launch_after(detector, begin, DETECTOR_RECOVERY)
    expect(0.0 <= delay <= latest, f"recognised after {delay} s, not within {latest} s")


def estimator_returns(
    make: Callable[[], Estimator], readings: Iterable[Force | Row], fastest: float, tell: Callable[[Any, float], None]
) -> int:
    """Drive an estimator; `tell` says to it what a flight computer might. Return how many estimates were valid."""
    estimator = make()
    memory, valid, last = Memory(estimator), 0, 0.0
    for reading in readings:
        if len(reading) == 4:
            estimator.accelerometer(*reading)
            last = reading[0]
        else:
            estimate = estimator.step(*reading)
            honest(estimate, fastest)
            valid += estimate is not None and estimate[6]
        tell(estimator, last)
        memory.look()
    memory.check()
    return valid


def computer_returns(make: Callable[[], FlightComputer], readings: Iterable[Force | Row], fastest: float) -> list[str]:
    """Drive a flight computer; what it notes is taken out as a logger would. Return the names of its events."""
    computer = make()
    memory, names = Memory(computer), set()
    for reading in readings:
        if len(reading) == 4:
            computer.accelerometer(*reading)
        else:
            honest(computer.air_data(*reading), fastest)
        wing, throttle, pitch, roll, engaged = computer.commands
        expect(wing in (0.0, 1.0), computer.commands)
        expect(engaged in (0.0, 1.0), computer.commands)
        expect(0.0 <= throttle <= 1.0, computer.commands)
        expect(abs(pitch) <= 1.0, computer.commands)
        expect(roll == 0.0, computer.commands)
        if computer.events:
            expect(
                all(-LATEST < event["t"] < LATEST for event in computer.events),
                'all(-LATEST < event["t"] < LATEST for event in computer.events)',
            )
            names |= {event["event"] for event in computer.events}
            computer.events.clear()
        memory.look()
    memory.check()
    return sorted(names)


def estimator_recovers(
    make: Callable[[], Estimator],
    stream: Iterable[Sample],
    *,
    tell: Iterable[tuple[float, str]],
    sound: float,
    within: float,
    fastest: float,
) -> None:
    """Check that so long after the last nonsense every estimate is valid and right.

    Parameters
    ----------
    make : callable
    stream : iterable
        Readings of a flight, with nonsense in it, when they were taken, s, and the true airspeed, m/s.
    tell : iterable of tuple
        When it is told what, s: "launched", "unfolding".
    sound : float
        From when on all readings are sound, s.
    within : float
        How long after that, s.
    fastest : float
        m/s.

    Notes
    -----
    Right is within 1 m/s, or four standard deviations if that is more. At 90 % of the readings there is an estimate.
    """
    estimator, waits = make(), sorted(tell, reverse=True)
    read = told = 0
    for reading, t, truth in stream:
        if len(reading) == 4:
            estimator.accelerometer(*reading)
            if waits and t >= waits[-1][0]:
                getattr(estimator, waits.pop()[1])(t)
            continue
        estimate = estimator.step(*reading)
        estimator.tidy()
        honest(estimate, fastest)
        if t >= sound + within:
            read += 1
            if estimate is not None:
                told += 1
                _, speed, sd, *_, valid, _, _ = estimate
                expect(valid, f"not valid at {t:.3f} s: {estimate}")
                expect(abs(speed - truth) <= max(1.0, 4.0 * sd), f"{speed} ± {sd} at {t:.3f} s, truth {truth}")
    expect(not waits, "the stream has no launch")
    expect(read > 0, "the stream ends too soon")
    expect(told >= 0.9 * read, f"{told} estimates of {read} readings")
