"""AltOS's lift-off by acceleration and speed, without its barometer.

The acceleration, without gravity, is above 20 m/s², and its integral above 5 m/s. What is left out of the real one is
said in `autopilot`. Source: the public firmware, whose values are fixed.
"""

from dataclasses import dataclass
from math import isfinite, nan
from typing import Annotated

from annotated_types import Interval

from uavsim.onboard.launch.autopilot import NO_MEAN, RestMean, need_of, on_rail, plausible
from uavsim.onboard.launch.axis import OneAxis
from uavsim.onboard.launch.bounds import Force
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE


@dataclass(frozen=True, slots=True)
class AltOsSettings:
    """AltOS's lift-off by acceleration and speed, `kind = "altos"`; the firmware's values are fixed.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that is exceeded.
    speed : float
        m/s, the integral of the acceleration, that is exceeded.
    """

    acceleration: Force = 20.0
    speed: Annotated[float, Interval(ge=0.0, le=1000.0)] = 5.0


class AltOs(OneAxis):
    """AltOS's lift-off by acceleration and speed.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², without gravity.
    speed : float
        m/s, the integral of the acceleration, which does not fall below 0.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    gained : float
        That integral, m/s.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible is left out. A gap sets the integral to 0.
    """

    __slots__ = ("_acceleration", "_mean", "_speed", "gained")

    def __init__(self, rate: float, *, acceleration: float = 20.0, speed: float = 5.0, axis: Axis = "+x") -> None:
        super().__init__(rate, axis)
        require(isfinite(acceleration) and isfinite(speed), "acceleration and speed must be finite")
        self._acceleration, self._speed = acceleration, speed

    def _clear(self) -> None:
        self._mean = RestMean()
        self.gained = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        self._mean.add(f, dt)
        a = f - self._mean.gravity if plausible(f) else nan
        if late:
            self.gained = 0.0
        if a != a:
            return False
        self.gained = max(0.0, self.gained + a * dt)
        self.triggered = a > self._acceleration
        return self.triggered and self.gained > self._speed

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        return Loop(_loop, (self._acceleration, self._speed, self._period), x=(*NO_MEAN, 0.0))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`AltOs`: p threshold, speed, period; x mean at rest, gained."""
    threshold, speed, period = p
    mean, known, summed, time, gained = x[0], x[1], x[2], x[3], x[4]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        mean, known, summed, time = on_rail(v, dt, mean, known, summed, time)
        a = v - mean
        if not (a == a and abs(v) < MOST_FORCE):
            continue
        gained += a * dt
        if not gained > 0.0:
            gained = 0.0
        if a > threshold and gained > speed:
            mean = nan
            known = summed = time = gained = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4] = mean, known, summed, time, gained
    y[0] = first
    return alarms


one_axis(
    "altos",
    AltOs,
    group="altos",
    level=Level("altos.acceleration", factors=UPWARDS),
    second=Second("altos.speed", (0.5, 1.0, 2.0, 3.0, 5.0)),
    need=need_of("altos", "speed", lambda settings, push: settings.altos.speed / push),
)
