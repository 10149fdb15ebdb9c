"""Conformance of a launch detector.

| asked | how it is tried |
|---|---|
| answers | `step` gives True or False, whatever it reads: NaN, infinite, beyond physics, stamps that are absurd |
| sees | a push of 0.6 s after 3 s of rest is recognised, once, and rest is not |
| time, not samples | with two of three samples lost a launch is recognised as soon, but for the thinner clock |
| gaps | a gap of 0.1 s in the rest, and lost and late samples, change nothing that matters |
| recovers | 3 s after the last nonsense a launch is recognised as if there had been none |
| reset | after `reset` it decides as a new one, whatever the clock says |
| replay | two of them, fed the same, have the same answers and the same state at each sample |
| memory | what it holds does not grow |
"""

import math
import random
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from uavsim.failure import PartError, said
from uavsim.onboard.interface import Detector
from uavsim.onboard.launch.guarded import STATE, GuardedDetector
from uavsim.testing.hostile import Force, readings
from uavsim.testing.invariants import DETECTOR_RECOVERY, Memory, expect

REST, PUSH = (3.0, 0.0, -9.4), (70.0, 0.0, -9.4)  # m/s²; of a rail, and of a launch of 7 g
WAIT, STROKE = 3.0, 0.6  # s
MANY = 24_000  # hostile readings
SLACK = 0.021  # s; a rule that runs at 50 Hz meets the push up to one run later
LOST = 3  # of as many samples one is left; more would be a gap

Make = Callable[[float], Detector]
"""Makes a detector for a rate in Hz; a class does."""


def check_detector(
    make: Make,
    *,
    rate: float = 1000.0,
    rest: tuple[float, float, float] = REST,
    push: tuple[float, float, float] = PUSH,
) -> None:
    """Hold a launch detector to what ours are held to.

    Parameters
    ----------
    make : callable
        A class, or whatever gives a detector for a rate: ``make(rate)``.
    rate : float
        Samples a second, Hz.
    rest, push : tuple of float
        Specific force at rest, and one that it must recognise within 0.6 s, body axes, m/s².

    Raises
    ------
    AssertionError
        What is wrong, in a line.
    """
    name = getattr(make, "__name__", "the detector")
    trial = _Trial(name, make, rate, rest, push)
    trial.has_methods()
    delay = trial.sees()
    trial.counts_time(delay)
    trial.bears_gaps(delay)
    trial.answers_whatever_it_reads()
    trial.recovers(delay)
    trial.is_as_new_after_reset()
    trial.replays()


class _Trial:
    """What is tried of one detector."""

    def __init__(
        self,
        name: str,
        make: Make,
        rate: float,
        rest: tuple[float, float, float],
        push: tuple[float, float, float],
    ) -> None:
        self.name, self.make, self.rate, self.rest, self.push = name, make, rate, rest, push

    def new(self) -> Any:
        """Make one."""
        try:
            return self.make(self.rate)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise AssertionError(f"{self.name} cannot be made by {self.name}({self.rate:g}): {said(error)}") from error

    def step(self, detector: Any, reading: Force) -> bool:
        """Step it; its answer must be True or False."""
        try:
            answer = detector.step(*reading)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise AssertionError(f"{self.name}.step{reading} raises {said(error)}") from error
        expect(
            isinstance(answer, bool) or type(answer).__name__ in ("bool_", "bool"),
            f"{self.name}.step{reading} gives {answer!r}; it must give True or False",
        )
        return bool(answer)

    def has_methods(self) -> None:
        """`step` and `reset`."""
        detector = self.new()
        for method in ("step", "reset"):
            expect(callable(getattr(detector, method, None)), f"{self.name} has no method {method!r}")

    def launch(self, begin: float = 0.0, wait: float = WAIT, every: int = 1) -> Iterator[tuple[Force, float]]:
        """Yield readings of a rest and a push, and the time since the push began, s; one of `every` samples."""
        for k in range(0, round((wait + STROKE) * self.rate), every):
            since = k / self.rate - wait
            force = self.push if since >= 0.0 else self.rest
            yield (begin + k / self.rate, *force), since

    def delay(self, detector: Any, launch: Iterable[tuple[Force, float]]) -> float:
        """Time after the push's begin at which it is recognised, s; NaN if it is not."""
        found = math.nan
        for reading, since in launch:
            if not self.step(detector, reading):
                continue
            expect(since >= 0.0, f"{self.name} recognises a launch at rest, {-since:.3f} s before the push begins")
            expect(math.isnan(found), f"{self.name} recognises a launch twice; after True it must wait for reset")
            found = since
        return found

    def sees(self) -> float:
        """Recognise a plain launch."""
        found = self.delay(self.new(), self.launch())
        expect(
            found == found,
            f"{self.name} does not recognise a push of {self.push} m/s² for {STROKE:g} s after rest; another may be "
            "asked for by push=",
        )
        return found

    def counts_time(self, delay: float) -> None:
        """See as soon with samples lost: what counts is time."""
        found = self.delay(self.new(), self.launch(every=LOST))
        latest = 1.5 * delay + LOST * 3.0 / self.rate
        if delay > SLACK:
            latest += SLACK
        expect(
            found <= latest,
            f"{self.name} counts samples, not time: it recognises a launch {_ms(delay)} after its begin, and "
            f"{_ms(found)} with two of three samples lost",
        )

    def bears_gaps(self, delay: float) -> None:
        """Miss samples at rest, and read some late or twice, as on any bus."""
        draw = random.Random(1)
        kept: list[tuple[Force, float]] = []
        for reading, since in self.launch():
            quiet = since < -0.5
            if quiet and (-2.0 < since < -1.9 or draw.random() < 0.01):
                continue
            kept.append((reading, since))
            if quiet and draw.random() < 0.01:
                kept.append((reading, since))
        found = self.delay(self.new(), kept)
        expect(
            found <= delay + SLACK,
            f"{self.name} recognises a launch {_ms(found)} after its begin, and {_ms(delay)} without a gap of 0.1 s "
            "and lost and doubled samples in the rest before",
        )

    def answers_whatever_it_reads(self) -> None:
        """Read nonsense, and hold no more for it."""
        detector = self.new()
        memory = Memory(detector, MANY // 6)
        for reading in readings(1, MANY):
            if len(reading) == 4 and self.step(detector, reading):
                self.reset(detector)
            memory.look()
        try:
            memory.check()
        except AssertionError as error:
            raise AssertionError(f"{self.name} holds ever more: {error}") from None

    def reset(self, detector: Any) -> None:
        """Reset it."""
        try:
            detector.reset()
        except Exception as error:
            raise AssertionError(f"{self.name}.reset() raises {said(error)}") from error

    def recovers(self, delay: float) -> None:
        """Recognise a launch some time after nonsense, each kind of it alone."""
        for what, nonsense in NONSENSE.items():
            detector, t = self.new(), 0.0
            for k in range(round(self.rate)):
                t = k / self.rate
                reading = nonsense((t, *self.rest)) if k % 10 == 5 else (t, *self.rest)
                if self.step(detector, reading):
                    self.reset(detector)
            begin = t + 1.0 / self.rate
            found = self.delay(detector, self.launch(begin, DETECTOR_RECOVERY))
            expect(
                found <= delay + SLACK,
                f"{self.name} does not recover: {DETECTOR_RECOVERY:g} s after {what} it recognises a launch "
                f"{_ms(found)} after its begin, and {_ms(delay)} without",
            )

    def is_as_new_after_reset(self) -> None:
        """Decide after `reset` as a new one does."""
        used = self.new()
        for reading, _ in self.launch():
            self.step(used, reading)
        self.reset(used)
        try:
            again = self.delay(used, self.launch(-7.0))
        except AssertionError as error:
            raise AssertionError(f"{self.name} is not as new after reset: {error}") from None
        new = self.delay(self.new(), self.launch(-7.0))
        expect(
            again == new,
            f"{self.name} is not as new after reset: it recognises a launch {_ms(again)} after its begin, a new one "
            f"{_ms(new)}",
        )
        half, begun = self.new(), -0.2
        for reading, since in self.launch():
            if since < 0.5 * new:
                self.step(half, reading)
        self.reset(half)
        again = self.delay(half, self.launch(begun))
        expect(again == new, f"{self.name} keeps something of a launch that had begun when it was reset")

    def replays(self) -> None:
        """Give the same answers and states for the same readings."""
        first, second = (self._trace() for _ in range(2))
        for one, other in zip(first, second, strict=True):
            expect(
                one == other, f"{self.name} gives other answers for the same readings at {one[0]:.3f} s: {one}, {other}"
            )

    def _state(self, detector: Any) -> list[str]:
        """What is recorded of it: numbers and a flag, where it has them."""
        told = GuardedDetector(self.name, detector)
        try:
            return [repr(getattr(told, name)) for name in STATE]
        except PartError as failure:
            raise AssertionError(f"{failure}; it must be a number, triggered a flag, or None") from failure

    def _trace(self) -> list[tuple[Any, ...]]:
        detector, rows = self.new(), []
        draw = random.Random(2)
        for reading, _ in self.launch():
            t, fx, fy, fz = reading
            seen = self.step(detector, (t, fx + draw.gauss(0.0, 2.0), fy, fz))
            rows.append((t, seen, *self._state(detector)))
        return rows


def _force(value: float) -> Callable[[Force], Force]:
    return lambda reading: (reading[0], value, value, value)


def _stamp(step: float) -> Callable[[Force], Force]:
    return lambda reading: (reading[0] + step, *reading[1:])


NONSENSE: dict[str, Callable[[Force], Force]] = {
    "readings that were NaN": _force(math.nan),
    "readings that were infinite": _force(math.inf),
    "readings of -1e300 m/s²": _force(-1e300),
    "stamps that were NaN": _stamp(math.nan),
    "stamps that were 1e9 s ahead": _stamp(1e9),
    "stamps that were 10 s ahead": _stamp(10.0),
    "stamps that were 10 s behind": _stamp(-10.0),
}
"""What one reading in ten is for a second."""


def _ms(seconds: float) -> str:
    return "never" if math.isnan(seconds) else f"{1e3 * seconds:.0f} ms"
