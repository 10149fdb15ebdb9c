"""iNav's launch by acceleration ("bungee") or by its satellites' speed ("throw"), for 40 ms.

bungee    the force behind a low-pass above 1.9 g, and, where an attitude is told, tilted by less than 45°
throw     where satellites tell a speed: six of them or more, above 3 m/s, and the force forwards

Gravity is not taken off. What is left out of the real one, its swing by the yaw rate too, is said in `autopilot`.
Source: the public firmware.
"""

from dataclasses import dataclass
from math import cos, isfinite, pi, radians, sin, sqrt
from typing import Annotated

from annotated_types import Interval

from uavsim.onboard.launch.autopilot import need_of, plausible
from uavsim.onboard.launch.axis import OneAxis
from uavsim.onboard.launch.bounds import Force, Frequency, Time
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE

SATELLITES, SPEED = 6, 3.0  # –, m/s; fewer, or slower, give iNav no course


@dataclass(frozen=True, slots=True)
class InavSettings:
    """iNav's launch by acceleration, `kind = "inav"`.

    Attributes
    ----------
    acceleration : float
        m/s², with gravity, that is exceeded. nav_fw_launch_accel, which is in cm/s².
    time : float
        Time for which, s. nav_fw_launch_detect_time, which is in ms.
    cutoff : float
        Of the second-order low-pass before it, Hz. acc_lpf_hz.
    velocity : float
        Speed over ground, m/s, that is exceeded in a throw, where a log has satellites. nav_fw_launch_velocity,
        which is in cm/s.
    max_angle_deg : float
        Most tilt of a launch by acceleration, degrees, where a log has an attitude. nav_fw_launch_max_angle.
    """

    acceleration: Force = 18.63
    time: Time = 0.04
    cutoff: Frequency = 15.0
    velocity: Annotated[float, Interval(gt=0.0, le=100.0)] = 3.0
    max_angle_deg: Annotated[float, Interval(gt=0.0, le=180.0)] = 45.0


class Inav(OneAxis):
    """iNav's launch by acceleration ("bungee"), and by the speed of satellites ("throw") where that is told.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², with gravity; nav_fw_launch_accel.
    time : float
        Time above it, s; nav_fw_launch_detect_time.
    cutoff : float
        Of the low-pass, Hz; there is none where the rate is not above twice this. acc_lpf_hz.
    velocity : float
        Speed over ground of a throw, m/s; nav_fw_launch_velocity.
    max_angle_deg : float
        Most tilt of a launch by acceleration, degrees; nav_fw_launch_max_angle.
    axis : str
        Signed body axis that points along the launch.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    The low-pass begins at rest at the first force. One that is NaN or implausible is not above and
    passes the low-pass by.
    """

    __slots__ = (
        "_a1", "_a2", "_acceleration", "_b0", "_cutoff", "_held", "_least_cos", "_level", "_needed", "_started",
        "_thrown", "_velocity", "_z1", "_z2",
    )  # fmt: skip

    def __init__(
        self,
        rate: float,
        *,
        acceleration: float = 18.63,
        time: float = 0.040,
        cutoff: float = 15.0,
        velocity: float = 3.0,
        max_angle_deg: float = 45.0,
        axis: Axis = "+x",
    ) -> None:
        super().__init__(rate, axis)
        require(all(map(isfinite, (acceleration, velocity, max_angle_deg))), "all must be finite")
        self._velocity, self._least_cos = velocity, cos(radians(max_angle_deg))
        self._level, self._thrown = True, False
        require(all(isfinite(x) and x > 0.0 for x in (time, cutoff)), "time and cutoff must be above 0")
        self._acceleration, self._needed = acceleration, time / ROUNDING
        self._b0, self._a1, self._a2 = lowpass(cutoff / rate) if rate > 2.0 * cutoff else (1.0, 0.0, 0.0)
        self._cutoff = rate > 2.0 * cutoff

    def attitude(self, roll: float, pitch: float) -> None:
        """Take an attitude, rad; NaN: not known, and no gate."""
        self._level = not cos(roll) * cos(pitch) < self._least_cos if isfinite(roll) and isfinite(pitch) else True

    def satellites(self, speed: float, number: float) -> None:
        """Take the speed over ground of so many satellites, m/s; NaN: not known."""
        self._thrown = number >= SATELLITES and speed > SPEED and speed > self._velocity

    def _clear(self) -> None:
        self._started = False
        self._held = self._z1 = self._z2 = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if late:
            self._clear()
        if not (plausible(f) and self._is_launch(self._filtered(f))):
            self._held = 0.0
            self.triggered = False
            return False
        self._held += dt
        self.triggered = True
        return self._held >= self._needed

    def _is_launch(self, f: float) -> bool:
        return (f > self._acceleration and self._level) or (self._thrown and f > 0.0)

    def _filtered(self, f: float) -> float:
        if not self._cutoff:
            return f
        b0, a1, a2 = self._b0, self._a1, self._a2
        if not self._started:
            self._started = True
            self._z1, self._z2 = f * (1.0 - b0), f * (b0 - a2)
        out = b0 * f + self._z1
        self._z1 = 2.0 * b0 * f - a1 * out + self._z2
        self._z2 = b0 * f - a2 * out
        return out

    def loop(self) -> Loop:
        """Return the same rule over arrays, by acceleration alone."""
        p = self._acceleration, self._needed, self._period, self._b0, self._a1, self._a2
        return Loop(_loop, p, (int(self._cutoff),), x=(0.0, 0.0, 0.0), y=(0, 0))


def lowpass(share: float) -> tuple[float, float, float]:
    """Return b0, a1 and a2 of a second-order Butterworth low-pass; b1 = 2 b0, b2 = b0.

    Parameters
    ----------
    share : float
        Cutoff over sampling rate, below 0.5. Bilinear transform: R. Bristow-Johnson's cookbook with Q = 1/√2.
    """
    w = 2.0 * pi * share
    alpha = sin(w) / sqrt(2.0)
    return (1.0 - cos(w)) / (2.0 + 2.0 * alpha), -2.0 * cos(w) / (1.0 + alpha), (1.0 - alpha) / (1.0 + alpha)


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Inav`: p threshold, hold, period, b0, a1, a2; q whether there is a low-pass; x held, z1, z2; y[1] started."""
    threshold, hold, period, b0, a1, a2 = p
    held, z1, z2 = x[0], x[1], x[2]
    first, started, alarms = y[0], y[1] != 0, 0
    for i in range(f.size):
        v = wide(f[i])
        level = v
        if not abs(v) < MOST_FORCE:
            held = 0.0
            continue
        if q[0]:
            if not started:
                started, z1, z2 = True, v * (1.0 - b0), v * (b0 - a2)
            level = b0 * v + z1
            z1 = 2.0 * b0 * v - a1 * level + z2
            z2 = b0 * v - a2 * level
        if not level > threshold:
            held = 0.0
            continue
        k = k0 + i
        held += k / rate - (k - 1) / rate if k != first else period
        if held >= hold:
            held, started, first = 0.0, False, k + 1
            out[alarms] = k
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2] = held, z1, z2
    y[0], y[1] = first, started
    return alarms


one_axis(
    "inav",
    Inav,
    group="inav",
    level=Level("inav.acceleration", factors=UPWARDS),
    second=Second("inav.time", (0.005, 0.010, 0.020, 0.040)),
    need=need_of("inav", "time", lambda settings, _: settings.inav.time),
    autopilot=True,
)
