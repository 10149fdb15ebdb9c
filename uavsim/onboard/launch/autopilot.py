"""What the rules that autopilots fly have in common: the mean on the rail, and a rate of their own.

PX4        a > 30 m/s² for more than 50 ms, run at 50 Hz, each run worth 10 … 50 ms      gravity-free
ArduPilot  mean of 5 values at 50 Hz ≥ 15 m/s², then 0.2 s without another look          gravity-free
iNav       f > 18.63 m/s² (1.9 g) for 40 ms behind a 15 Hz second-order low-pass         raw
Paparazzi  f ≥ 1.5 g at 5 calls in a row, at 60 Hz                                       raw
AltOS      a > 20 m/s² and a speed of 5 m/s, the integral of a                           gravity-free

They are flown with their defaults, as far as specific force alone decides. The real ones take gravity off by attitude.
Here it is the mean of the force on the rail that is taken off, over blocks of 0.5 s and with one block of delay, so
that the launch is not in it: they see nothing in the first second. Left out are gates on attitude, heading and
satellite speed, the filters of their estimators, and AltOS's barometer. A gap begins anew. Sources: the public firmware
of each; ArduPilot's level is what its manual gives for throws and bungees.
"""

from math import isfinite, nan
from typing import TYPE_CHECKING

from uavsim.compiled import compiled
from uavsim.onboard.launch.axis import OneAxis
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import Need
from uavsim.onboard.plausible import MOST_FORCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from uavsim.onboard.launch.settings import DetectorSettings

BLOCK = 0.5  # s, over which the force on the rail is averaged
LOOP = 50.0  # Hz, at which PX4 runs its detector and ArduPlane its main loop
NO_MEAN = nan, nan, 0.0, 0.0  # state of `on_rail` before the first force


class RailMean:
    """Mean of the force over a block of time, of which the one before the last full one is used.

    Attributes
    ----------
    before : float
        That mean, m/s²; NaN as long as there is none.
    """

    __slots__ = ("_last", "_sum", "_time", "before")

    def __init__(self) -> None:
        self.before = self._last = nan
        self._sum = self._time = 0.0

    def add(self, f: float, dt: float) -> None:
        """Take the force, m/s², of a sample that stands for dt, s; one that is NaN or implausible is left out."""
        if -MOST_FORCE < f < MOST_FORCE:
            self._sum += f * dt
            self._time += dt
            if self._time * ROUNDING >= BLOCK:
                self.before, self._last = self._last, self._sum / self._time
                self._sum = self._time = 0.0


@compiled
def on_rail(
    v: float, dt: float, before: float, last: float, summed: float, time: float, block: float, rounding: float
) -> tuple[float, float, float, float]:
    """Return the state of `RailMean` after one more force: the mean before, the last one, sum and time of the block."""
    if -MOST_FORCE < v < MOST_FORCE:
        summed += v * dt
        time += dt
        if time * rounding >= block:
            return last, summed / time, 0.0, 0.0
    return before, last, summed, time


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
