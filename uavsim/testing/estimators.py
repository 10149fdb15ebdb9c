"""Conformance of an airspeed estimator.

| asked | how it is tried |
|---|---|
| answers | `step` gives None, (airspeed, sd, valid) or a whole estimate; what is valid is a number from 0 on |
| estimates | on a sound flight it is valid in cruise, for most readings |
| bears | NaN before the first conversion, gaps, late, doubled and absurd stamps, values that are none or far out |
| recovers | 2 s after the last nonsense it says what one says that has read none |
| replay | two of them, fed the same, give the same, bit for bit |
| memory | what it holds does not grow |
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from uavsim.failure import PartError, said
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel, PaperFilter
from uavsim.onboard.airspeed.guarded import GuardedEstimator
from uavsim.onboard.airspeed.kinds import kind_of
from uavsim.onboard.interface import Estimate
from uavsim.onboard.plausible import FASTEST
from uavsim.testing.hostile import COVERED, START, STROKE, Force, Row, Sample, flight, readings
from uavsim.testing.invariants import Memory, expect

KNOWLEDGE = NoiseModel(3.7, 3.7, 0.5, total_window=8e-3, static_window=8e-3, accelerometer_sd=0.3)
"""What is believed of the sensors here: two BMP390 and an accelerometer at 1 kHz."""
LAUNCHED, UNFOLDING = START + 0.02, START + STROKE + 0.1  # s; what it is told, and when
HURT = START + STROKE + 1.5, START + STROKE + 2.5  # s; from when to when something is wrong
SETTLED = 2.0  # s after that
END = HURT[1] + SETTLED + 1.0  # s
MANY = 20_000  # hostile readings

Make = Callable[..., Any]
"""Makes an estimator: ``make(settings, knowledge, tare_window)``; a class does."""


def check_estimator(make: Make, *, knowledge: NoiseModel = KNOWLEDGE) -> None:
    """Hold an airspeed estimator to what ours are held to; how near it is to the truth is not asked.

    Parameters
    ----------
    make : callable
        A class that is built by ``make(settings, knowledge, tare_window)``, with its own `Settings` or None.
    knowledge : NoiseModel
        What it is told of the sensors.

    Raises
    ------
    AssertionError
        What is wrong, in a line.
    """
    trial = _Trial(getattr(make, "__name__", "the estimator"), make, knowledge)
    sound = trial.fly(flight(END))
    trial.estimates(sound)
    trial.replays(sound)
    trial.bears_nan_before_the_first_conversion()
    trial.bears_whatever_it_reads()
    trial.recovers(sound)


class _Trial:
    """What is tried of one estimator."""

    def __init__(self, name: str, make: Make, knowledge: NoiseModel) -> None:
        self.name, self.make, self.knowledge = name, make, knowledge

    def new(self) -> GuardedEstimator:
        """Make one; whatever it answers is looked at as in flight."""
        settings = EstimatorSettings()
        try:
            made = kind_of(self.make, self.name).build(settings, self.knowledge, COVERED)  # type: ignore[arg-type]
        except Exception as error:
            raise AssertionError(
                f"{self.name} cannot be made by {self.name}(settings, knowledge, tare_window): {said(error)}"
            ) from error
        return GuardedEstimator(self.name, made, PaperFilter(settings, self.knowledge, COVERED))

    def take(self, estimator: GuardedEstimator, reading: Force | Row) -> Estimate | None:
        """Let it take a reading of either sensor."""
        try:
            if len(reading) == 4:
                if estimator.aided:
                    estimator.accelerometer(*reading)
                return None
            estimate = estimator.step(*reading)
            estimator.tidy()
        except PartError as failure:
            raise AssertionError(f"{failure}; the reading was {reading}") from failure
        return estimate

    def fly(self, stream: Iterable[Sample]) -> list[tuple[float, Estimate]]:
        """Let it read a flight; return when each estimate was told, s, and the estimate."""
        estimator, found = self.new(), []
        told = [(UNFOLDING, "unfolding"), (LAUNCHED, "launched")]
        for reading, t, _ in stream:
            estimate = self.take(estimator, reading)
            if estimate is not None:
                found.append((t, estimate))
            if len(reading) == 4 and told and t >= told[-1][0]:
                try:
                    getattr(estimator, told.pop()[1])(t)
                except PartError as failure:
                    raise AssertionError(str(failure)) from failure
        return found

    def estimates(self, sound: list[tuple[float, Estimate]]) -> None:
        """Say something in cruise, at most readings."""
        cruise = [e for t, e in sound if t >= HURT[0]]
        valid = sum(e[6] for e in cruise)
        expected = 100.0 * (END - HURT[0])
        expect(
            valid >= 0.5 * expected,
            f"{self.name} has {valid} valid estimates of {expected:.0f} readings in a sound cruise at 32 m/s",
        )
        fastest = max(e[1] for e in cruise if e[6])
        expect(fastest <= FASTEST, f"{self.name} says {fastest:g} m/s in a cruise at 32 m/s")

    def replays(self, sound: list[tuple[float, Estimate]]) -> None:
        """Give the same for the same readings."""
        again = self.fly(flight(END))
        expect(len(again) == len(sound), f"{self.name} gives {len(sound)} estimates, and {len(again)} the second time")
        for (t, one), (_, other) in zip(sound, again, strict=True):
            same = all(a == b or (a != a and b != b) for a, b in zip(one, other, strict=True))
            expect(same, f"{self.name} gives other answers for the same readings at {t:.3f} s: {one}, {other}")

    def bears_nan_before_the_first_conversion(self) -> None:
        """Read rows of a head whose sensors are not there yet."""
        estimator = self.new()
        for k in range(20):
            nan = math.nan
            estimate = self.take(estimator, (0.01 * k, nan, nan, nan, nan, nan))
            expect(
                estimate is None or not estimate[6],
                f"{self.name} calls an airspeed valid before anything was read: {estimate}",
            )

    def bears_whatever_it_reads(self) -> None:
        """Read nonsense, and hold no more for it."""
        estimator = self.new()
        memory = Memory(estimator, MANY // 4)
        for reading in readings(1, MANY):
            if all(abs(value) < MOST or value != value for value in reading):
                self.take(estimator, reading)
            memory.look()
        try:
            memory.check()
        except AssertionError as error:
            raise AssertionError(f"{self.name} holds ever more: {error}") from None

    def recovers(self, sound: list[tuple[float, Estimate]]) -> None:
        """Say, some time after nonsense, what one says that has read none."""
        expected = {round(t, 4): e for t, e in sound if t >= HURT[1] + SETTLED}
        for what, hurt in NONSENSE.items():
            late = [(t, e) for t, e in self.fly(_hurt(flight(END), hurt)) if t >= HURT[1] + SETTLED]
            expect(
                len(late) >= 0.5 * len(expected),
                f"{self.name} does not recover: {SETTLED:g} s after {what} it gives {len(late)} estimates, and "
                f"{len(expected)} without",
            )
            for t, (_, speed, sd, *_, valid, _, _) in late:
                usual = expected.get(round(t, 4))
                if usual is None or not usual[6]:
                    continue
                near = abs(speed - usual[1]) <= max(1.0, 4.0 * sd, 4.0 * usual[2])
                expect(
                    bool(valid) and near,
                    f"{self.name} does not recover: {SETTLED:g} s after {what} it says {speed:.2f} ± {sd:.2f} m/s"
                    f"{'' if valid else ', not valid'}, and {usual[1]:.2f} without",
                )


MOST = 1e18  # what is read here at most: no sensor overflows a double


def _column(index: int, value: float) -> Callable[[Row], Row]:
    def hurt(row: Row) -> Row:
        values = list(row)
        values[index] = value
        return (values[0], values[1], values[2], values[3], values[4], values[5])

    return hurt


def _ahead(step: float) -> Callable[[Row], Row]:
    return lambda row: (row[0] + step, *row[1:])


NONSENSE: dict[str, Callable[[Row], Row] | None] = {
    "a gap of a second": None,
    "a total pressure that was NaN": _column(1, math.nan),
    "a static pressure that was NaN": _column(2, math.nan),
    "a temperature that was NaN": _column(3, math.nan),
    "a total pressure of 0 Pa": _column(1, 0.0),
    "a static pressure of -5 Pa": _column(2, -5.0),
    "a total pressure of 1e9 Pa": _column(1, 1e9),
    "stamps that were 1e9 s ahead": _ahead(1e9),
    "stamps that were 10 s behind": _ahead(-10.0),
}
"""What one row in five of the head is for a second; None: there are no rows."""


def _hurt(stream: Iterable[Sample], hurt: Callable[[Row], Row] | None) -> Iterator[Sample]:
    rows = 0
    for reading, t, speed in stream:
        if len(reading) == 4 or not HURT[0] <= t < HURT[1]:
            yield reading, t, speed
            continue
        rows += 1
        if hurt is not None:
            yield (hurt(reading) if rows % 5 == 0 else reading), t, speed
