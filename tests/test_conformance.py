"""`uavsim.testing`: ours pass it, and each fault that it is for is found and named."""

import itertools
import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import uavsim
from uavsim.onboard import airspeed, launch
from uavsim.onboard.airspeed import EstimatorSettings
from uavsim.onboard.launch import DetectorSettings
from uavsim.plants.choice import KINDS, PlantSettings
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.testing import check_detector, check_estimator, check_plant


@pytest.mark.parametrize("kind", launch.KINDS)
def test_our_detectors_pass(kind: str) -> None:
    check_detector(lambda rate: launch.build(DetectorSettings(kind=kind), rate))


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=[pytest.mark.slow] if kind == "paper-filterpy" else []) for kind in airspeed.KINDS],
)
def test_our_estimators_pass(kind: str) -> None:
    class Ours(uavsim.onboard.airspeed.Estimator):
        def __new__(cls, _settings: None, knowledge: Any, tare_window: Any) -> Any:
            return airspeed.build(EstimatorSettings(kind=kind), knowledge, tare_window)

        def step(self, *_: float) -> None: ...

    check_estimator(Ours)


class Held:
    """A detector in few lines: the force has been above a level for 10 ms."""

    def __init__(self, rate: float) -> None:
        self.longest = 3.5 / rate
        self.reset()

    def reset(self) -> None:
        self.since: float | None = None
        self.last = math.nan
        self.done = False

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        if not 0.0 < t - self.last <= self.longest:
            self.since = None  # the first, a gap, or a stamp that is none
        self.last = t
        if not 40.0 < fx < 4000.0:
            self.since = None
        elif self.since is None:
            self.since = t
        elif t - self.since >= 0.010 and not self.done:
            self.done = True
            return True
        return False


def test_a_detector_in_few_lines_passes() -> None:
    check_detector(Held)


class CountsSamples(Held):
    def __init__(self, rate: float) -> None:
        self.needed = round(0.010 * rate)
        super().__init__(rate)

    def reset(self) -> None:
        super().reset()
        self.count = 0

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.count = self.count + 1 if 40.0 < fx < 4000.0 else 0
        seen, self.done = self.count >= self.needed and not self.done, self.done or self.count >= self.needed
        return seen


class Repeats(Held):
    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        seen = super().step(t, fx, fy, fz)
        return seen or self.done


class Raises(Held):
    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        if fx != fx:
            raise ValueError("math domain error")
        return super().step(t, fx, fy, fz)


class Answers(Held):
    def step(self, t: float, fx: float, fy: float, fz: float) -> Any:
        return 1 if super().step(t, fx, fy, fz) else None


class Grows(Held):
    def __init__(self, rate: float) -> None:
        self.all: list[float] = []
        super().__init__(rate)

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.all.append(fx)
        return super().step(t, fx, fy, fz)


class Deaf(Held):
    """A stamp far ahead is taken for the time."""

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        if t <= self.last:
            return False
        return super().step(t, fx, fy, fz)


class Poisoned(Held):
    """A mean over 5 ms that NaN goes into and never out of."""

    def reset(self) -> None:
        super().reset()
        self.mean = self.then = 0.0

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.mean += min(1.0, abs(t - self.then) / 0.005) * (fx - self.mean)
        self.then = t
        return super().step(t, self.mean, fy, fz)


class KeepsOn(Held):
    """A time above the level that survives a reset."""

    above = then = 0.0

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        dt, self.then = min(abs(t - self.then), 0.003), t
        self.above = self.above + dt if 40.0 < fx < 4000.0 else max(0.0, self.above - 1e-3 * dt)
        if self.above < 0.010 or self.done:
            return False
        self.done = True
        return True


class Throws(Held):
    """Dice: how long the force is held."""

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self.extra = random.uniform(0.0, 0.02)

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        seen = super().step(t - self.extra if self.since is not None and fx > 40.0 else t, fx, fy, fz)
        self.last = t
        return seen


class Nervous(Held):
    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        return super().step(t, fx + 45.0, fy, fz)


class Blind(Held):
    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        return False


class NoReset:
    def __init__(self, rate: float) -> None: ...

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        return False


class NotMade(Held):
    def __init__(self, rate: float, extra: int) -> None:
        super().__init__(rate)


@pytest.mark.parametrize(
    ("cls", "says"),
    [
        (CountsSamples, "counts samples, not time"),
        (Repeats, "recognises a launch twice"),
        (Raises, r"Raises\.step\(.*\) raises ValueError: math domain error"),
        (Answers, "it must give True or False"),
        (Grows, "holds ever more"),
        (Deaf, "does not recover: 3 s after stamps that were 1e9 s ahead"),
        (Poisoned, "does not recover: 3 s after readings that were NaN"),
        (KeepsOn, "KeepsOn is not as new after reset"),
        (
            Throws,
            "gives other answers|recognises a launch at rest|is not as new|counts samples|does not recover|does not",
        ),
        (Nervous, "recognises a launch at rest"),
        (Blind, "does not recognise a push"),
        (NoReset, "has no method 'reset'"),
        (NotMade, "cannot be made"),
    ],
)
def test_a_detectors_fault_is_found(cls: Callable[[float], Any], says: str) -> None:
    with pytest.raises(AssertionError, match=says) as caught:
        check_detector(cls)
    assert "\n" not in str(caught.value)


class Pressures(uavsim.onboard.airspeed.Estimator):
    """An estimator in few lines."""

    @dataclass(frozen=True)
    class Settings:
        density: float = 1.2

    def __init__(self, settings: Any, knowledge: Any, tare_window: Any) -> None:
        self.density = settings.density if settings else 1.2

    def step(self, t: float, p_total: float, p_static: float, *_: float) -> Any:
        q = p_total - p_static
        if not 0.0 < q < 1e4:
            return math.nan, math.nan, False
        return (2.0 * q / self.density) ** 0.5, 0.5, True


def test_an_estimator_in_few_lines_passes() -> None:
    check_estimator(Pressures)


class Divides(Pressures):
    def step(self, t: float, p_total: float, p_static: float, *_: float) -> Any:
        q = p_total - p_static
        return None if q != q else (math.sqrt(2.0 * q / self.density), 0.5, True)


class ValidNan(Pressures):
    def step(self, t: float, p_total: float, p_static: float, *rest: float) -> Any:
        speed, _, _ = super().step(t, p_total, p_static, *rest)
        return speed, 0.5, True


class Negative(Pressures):
    def step(self, t: float, p_total: float, p_static: float, *rest: float) -> Any:
        speed, _, valid = super().step(t, p_total, p_static, *rest)
        return speed, -0.5, valid


class Words(Pressures):
    def step(self, *reading: float) -> Any:
        return "fast"


class Silent(Pressures):
    def step(self, *reading: float) -> Any:
        return None


class Lasting(Pressures):
    """A mean that nonsense stays in."""

    mean = 0.0

    def step(self, t: float, p_total: float, p_static: float, *rest: float) -> Any:
        q = p_total - p_static
        if q == q:
            self.mean += 1e-3 * (q - self.mean)
        return super().step(t, p_static + max(1.0, q if t < 4.0 else self.mean), p_static, *rest)


class Hoards(Pressures):
    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.rows: list[float] = []

    def step(self, t: float, p_total: float, p_static: float, *rest: float) -> Any:
        self.rows.append(p_total)
        return super().step(t, p_total, p_static, *rest)


class Dice(Pressures):
    drawn = itertools.count()

    def step(self, t: float, p_total: float, p_static: float, *rest: float) -> Any:
        return super().step(t, p_total + 1e-3 * next(self.drawn), p_static, *rest)


@pytest.mark.parametrize(
    ("cls", "says"),
    [
        (Divides, "raised ValueError"),
        (ValidNan, "a valid airspeed is a number from 0 on"),
        (Negative, "the standard deviation of a valid airspeed"),
        (Words, r"answered 'fast' at .*; it must be None"),
        (Silent, "has 0 valid estimates"),
        (Lasting, "does not recover: 2 s after a total pressure of 0 Pa"),
        (Hoards, "holds ever more"),
        (Dice, "gives other answers for the same readings"),
    ],
)
def test_an_estimators_fault_is_found(cls: type, says: str) -> None:
    with pytest.raises(AssertionError, match=says) as caught:
        check_estimator(cls)
    assert "\n" not in str(caught.value)


def test_an_estimator_is_made_with_its_settings_and_what_is_known() -> None:
    class Odd(Pressures):
        def __init__(self, settings: Any) -> None: ...

    with pytest.raises(AssertionError, match=r"cannot be made by Odd\(settings, knowledge, tare_window\)"):
        check_estimator(Odd)


@pytest.mark.parametrize("kind", KINDS)
def test_our_plants_pass(kind: str) -> None:
    check_plant(KINDS[kind].cls, settings=PlantSettings(kind=kind).own)


class Bench(PrescribedPlant):
    """A plant in few lines: a push along x."""

    @dataclass(frozen=True)
    class Settings:
        push: float = 60.0

    def __init__(self, settings: Any, run: Run) -> None:
        since = run.time - run.release_time
        push = np.where((since >= 0.0) & (since < 0.4), settings.push, 3.0)
        super().__init__(run, {"fx": push, "fy": 0.0 * push, "fz": 0.0 * push - 9.4})


def test_a_plant_in_few_lines_passes() -> None:
    check_plant(Bench)


class Stuck(Bench):
    def step(self) -> None: ...


class Crashes(Bench):
    def step(self) -> None:
        super().step()
        if self.k == 70:
            raise ZeroDivisionError("division by zero")


class Lies(Bench):
    def truth(self) -> Any:
        return {**super().truth(), "fx": super().truth()["fx"] + 1.0}


class Lacks(Bench):
    def truth(self) -> Any:
        truth = dict(super().truth())
        del truth["wing"]
        return truth


class Drawn(Bench):
    drawn = itertools.count()

    def truth(self) -> Any:
        return {**super().truth(), "roll": np.full(self.k + 1, float(next(self.drawn)))}


class Vacuum(Bench):
    def air(self, time: float) -> Any:
        return 0.0, 0.0, 288.15


class Flat(Bench):
    def step(self) -> None:
        super().step()
        self.force = 1.0, 2.0  # type: ignore[assignment]


class Own(Bench):
    """A step of its own."""

    def __init__(self, settings: Any, run: Run) -> None:
        super().__init__(settings, Run(run.environment, run.launcher, run.duration, run.release_time))


@pytest.mark.parametrize(
    ("cls", "says"),
    [
        (Stuck, "is at step 0, 0 s, and should be at 1"),
        (Crashes, r"raised ZeroDivisionError: division by zero at 0\.07"),
        (Lies, "m/s² off the truth's fx, fy, fz"),
        (Lacks, "lacks the column 'wing'"),
        (Drawn, "the column 'roll' differs"),
        (Vacuum, "static pressure of 0 Pa"),
        (Flat, r"has force = \(1\.0, 2\.0\)"),
        (Own, "is at step 1, 0.001 s, and should be at 1, 0.0005 s"),
    ],
)
def test_a_plants_fault_is_found(cls: type, says: str) -> None:
    with pytest.raises(AssertionError, match=says) as caught:
        check_plant(cls)
    assert "\n" not in str(caught.value)
