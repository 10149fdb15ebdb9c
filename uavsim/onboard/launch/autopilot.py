"""What the rules that autopilots fly have in common: gravity taken off, a rate of their own, an attitude if told.

PX4        a > 30 m/s² for more than 50 ms, run at 50 Hz, each run worth 10 … 50 ms      gravity-free
ArduPilot  mean of 5 values at 50 Hz ≥ 15 m/s², then 0.2 s without another look          gravity-free
iNav       f > 18.63 m/s² (1.9 g) for 40 ms behind a 15 Hz second-order low-pass         raw
Paparazzi  f ≥ 1.5 g at 5 calls in a row, at 60 Hz                                       raw
AltOS      a > 20 m/s² and a speed of 5 m/s, the integral of a                           gravity-free

They are flown with their defaults, as far as specific force alone decides. PX4 and ArduPilot take gravity off by
attitude, and so are they flown where one is told (`Gravity.attitude`), as from a log that has it. Without, and for
AltOS always, gravity is the mean of the force at rest:

    m ← m + (b - m)·0.1 s / min(T, 2 s)      b: mean of a block of 0.1 s; it counts if |b| ≤ 1.25 g

T is the time of the blocks that have counted. A block that no rest can read is none of gravity: neither a launch nor
an arrest in a net moves m, and vibration, whose mean is 0, does not spoil it. Before the first block that counts
gravity is the mean of the samples of the one that runs, ±1 g at the most, so that they see from the first sample on.
What it costs: an aircraft that is turned is followed in some 2 s instead of at once.

Left out are gates on heading, ArduPilot's on the speed of its satellites, the filters of their estimators, and AltOS's
barometer. A gap begins anew, but for m. Sources: the public firmware of each; ArduPilot's level is what its manual
gives for throws and bungees. AltOS means over 5.12 s and uses the mean of the 5.12 s before.
"""

from math import cos, isfinite, nan, sin
from typing import TYPE_CHECKING

from uavsim.compiled import compiled
from uavsim.onboard.launch.axis import GRAVITY, OneAxis, signed
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import Need
from uavsim.onboard.plausible import MOST_FORCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from uavsim.onboard.launch.settings import DetectorSettings

BLOCK = 0.1  # s, over which the force is averaged: a launch that begins within it spoils no more than this
# s, of the mean over blocks: of vibration of 3 g rms, or a launch's part of a block, 0.5 m/s² are left in it
MEMORY = 2.0
MOST_AT_REST = 1.25 * GRAVITY  # m/s²: gravity, the zero-g offset of a coarse part (0.2 g), and what vibration leaves
LOOP = 50.0  # Hz, at which PX4 runs its detector and ArduPlane its main loop
NO_MEAN = nan, 0.0, 0.0, 0.0  # state of `RestMean` and of `on_rail` before the first force


class RestMean:
    """The force at rest along an axis, as the mean of those blocks of time that can be rest.

    Attributes
    ----------
    gravity : float
        That force, m/s²; NaN before the first sample.
    """

    __slots__ = ("_known", "_sum", "_time", "gravity")

    def __init__(self) -> None:
        self.gravity, self._known, self._sum, self._time = NO_MEAN

    def add(self, f: float, dt: float) -> None:
        """Take the force, m/s², of a sample that stands for dt, s; one that is NaN or implausible is left out."""
        if -MOST_FORCE < f < MOST_FORCE:
            self._sum += f * dt
            self._time += dt
            if self._known == 0.0:
                self.gravity = min(max(self._sum / self._time, -GRAVITY), GRAVITY)
            if self._time * ROUNDING >= BLOCK:
                block = self._sum / self._time
                self._sum = self._time = 0.0
                if -MOST_AT_REST <= block <= MOST_AT_REST:
                    self._known = min(self._known + BLOCK, MEMORY)
                    self.gravity += (block - self.gravity) * (BLOCK / self._known)


@compiled
def on_rail(
    v: float, dt: float, mean: float, known: float, summed: float, time: float
) -> tuple[float, float, float, float]:
    """Return the state of `RestMean` after one more force: mean, time of its blocks, sum and time of the last one."""
    if -MOST_FORCE < v < MOST_FORCE:
        summed += v * dt
        time += dt
        if known == 0.0:
            mean = min(max(summed / time, -GRAVITY), GRAVITY)
        if time * ROUNDING >= BLOCK:
            block = summed / time
            summed = time = 0.0
            if -MOST_AT_REST <= block <= MOST_AT_REST:
                known = min(known + BLOCK, MEMORY)
                mean += (block - mean) * (BLOCK / known)
    return mean, known, summed, time


class Gravity:
    """Gravity along the body axes: by attitude where one is told, else the mean of the force at rest.

    Parameters
    ----------
    *axes : str
        Signed body axes.
    """

    __slots__ = ("_axes", "_told", "means")

    def __init__(self, *axes: Axis) -> None:
        self._axes = tuple(signed(axis) for axis in axes)
        self._told: tuple[float, ...] | None = None
        self.clear()

    def clear(self) -> None:
        """Forget the force at rest; an attitude stays."""
        self.means = tuple(RestMean() for _ in self._axes)

    def attitude(self, roll: float, pitch: float) -> None:
        """Take an attitude, rad; NaN: it is not known any more."""
        if not (isfinite(roll) and isfinite(pitch)):
            self._told = None
            return
        felt = (GRAVITY * sin(pitch), -GRAVITY * cos(pitch) * sin(roll), -GRAVITY * cos(pitch) * cos(roll))
        self._told = tuple(sign * felt[index] for index, sign in self._axes)

    def along(self, which: int = 0) -> float:
        """Return what is felt of it along an axis, m/s², by its place among those that were given."""
        return self.means[which].gravity if self._told is None else self._told[which]


class Periodic(OneAxis):
    """A rule that runs at a rate of its own, with the sample that is there; at every sample where those are fewer.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    run_rate : float
        Runs a second, Hz.
    axis : str
        Signed body axis that points along the launch.
    """

    __slots__ = ("_elapsed", "_interval")

    def __init__(self, rate: float, run_rate: float, axis: Axis) -> None:
        super().__init__(rate, axis)
        require(isfinite(run_rate) and run_rate > 0.0, "call_rate must be above 0 Hz")
        self._interval = 1.0 / run_rate - 0.5 / rate  # s; half a sample of tolerance, so that jitter skips no run

    def _clear(self) -> None:
        self._elapsed = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        self._watch(f, dt, late)
        elapsed = self._elapsed + dt
        if elapsed < self._interval:
            self._elapsed = elapsed
            return False
        self._elapsed = 0.0
        return self._run(f, elapsed)

    def _watch(self, f: float, dt: float, late: bool) -> None:
        """Take what a rule needs of every sample; begin anew after a gap (`late`)."""
        raise NotImplementedError

    def _run(self, f: float, elapsed: float) -> bool:
        """Run with the force f, m/s², so long after the last run, s."""
        raise NotImplementedError


def plausible(f: float) -> bool:
    """Whether a force is a number and no more than what an accelerometer reads."""
    return -MOST_FORCE < f < MOST_FORCE


def need_of(group: str, key: str, time: "Callable[[DetectorSettings, float], float]") -> "Callable[..., Need]":
    """Return what a rule needs that has its level in `group`.acceleration; `time` from settings and push, s."""

    def need(settings: "DetectorSettings", push: float) -> Need:
        level = getattr(settings, group).acceleration
        return Need(f"{group}.acceleration", level, f"{group}.{key}", time(settings, push))

    return need
