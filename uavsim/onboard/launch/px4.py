"""PX4's launch detector: the acceleration without gravity above 30 m/s² for more than 50 ms.

It runs at 50 Hz, and each run counts for the time since the last, 10 … 50 ms. Until March 2026 it looked at one body
axis, since then at the magnitude. What is left out of the real one is said in `autopilot`. Source: the public firmware.
"""

from dataclasses import dataclass
from math import isfinite, nan, sqrt

from uavsim.onboard.launch.autopilot import LOOP, NO_MEAN, Gravity, Periodic, need_of, on_rail
from uavsim.onboard.launch.bounds import Force, Time
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE


@dataclass(frozen=True, slots=True)
class Px4Settings:
    """PX4's launch detector, `kind = "px4"` or `"px4-norm"`.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that is exceeded. FW_LAUN_AC_THLD.
    time : float
        Time for which, s; exceeded too, in runs of 20 ms. FW_LAUN_AC_T.
    """

    acceleration: Force = 30.0
    time: Time = 0.05


class Px4(Periodic):
    """PX4's launch detector on one body axis, as until March 2026.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², without gravity; FW_LAUN_AC_THLD.
    time : float
        Time above it that is exceeded, s; FW_LAUN_AC_T.
    axis : str
        Signed body axis that points along the launch.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible is not above.
    """

    __slots__ = ("_acceleration", "_exceeded", "_gravity", "_held")

    def __init__(self, rate: float, *, acceleration: float = 30.0, time: float = 0.050, axis: Axis = "+x") -> None:
        self._gravity = self._felt_along(axis)
        super().__init__(rate, LOOP, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(isfinite(time) and time > 0.0, "time must be above 0 s")
        self._acceleration, self._exceeded = acceleration, time * ROUNDING

    @staticmethod
    def _felt_along(axis: Axis) -> Gravity:
        return Gravity(axis)

    def attitude(self, roll: float, pitch: float) -> None:
        """Take an attitude, rad, by which gravity is taken off from now on; NaN: by the mean again."""
        self._gravity.attitude(roll, pitch)

    def _clear(self) -> None:
        super()._clear()
        self._gravity.clear()
        self._held = 0.0

    def _watch(self, f: float, dt: float, late: bool) -> None:
        self._gravity.means[0].add(f, dt)
        if late:
            self._held = 0.0

    def _run(self, f: float, elapsed: float) -> bool:
        return self._judge(f - self._gravity.along() if f < MOST_FORCE else nan, elapsed)

    def _judge(self, a: float, elapsed: float) -> bool:
        self._held = self._held + min(max(elapsed, 0.010), 0.050) if a > self._acceleration else 0.0
        self.triggered = self._held > 0.0
        return self._held > self._exceeded

    def loop(self) -> Loop:
        """Return the same rule over arrays, by the mean of the force at rest."""
        p = self._acceleration, self._exceeded, self._interval, self._period
        return Loop(_loop, p, x=(*NO_MEAN, 0.0, 0.0))


class Px4Norm(Px4):
    """PX4's launch detector on the magnitude of the acceleration, as since March 2026; settings of `Px4`.

    A sample that is NaN or implausible along any axis is not above, and is left out of the mean.
    """

    __slots__ = ("_felt",)

    @staticmethod
    def _felt_along(axis: Axis) -> Gravity:
        return Gravity("+x", "+y", "+z")

    def _clear(self) -> None:
        super()._clear()
        self._felt = 0.0, 0.0, 0.0

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; see `Detector`."""
        most = MOST_FORCE
        sound = -most < fx < most and -most < fy < most and -most < fz < most
        self._felt = (fx, fy, fz) if sound else (nan, nan, nan)
        return super().step(t, fx, fy, fz)

    def _watch(self, f: float, dt: float, late: bool) -> None:
        x, y, z = self._gravity.means
        fx, fy, fz = self._felt
        if fx == fx:
            x.add(fx, dt)
            y.add(fy, dt)
            z.add(fz, dt)
        if late:
            self._held = 0.0

    def _run(self, f: float, elapsed: float) -> bool:
        x, y, z = (felt - self._gravity.along(axis) for axis, felt in enumerate(self._felt))
        return self._judge(sqrt(x * x + y * y + z * z), elapsed)

    def loop(self) -> Loop:
        """Return the same rule over arrays, by the mean of the force at rest."""
        p = self._acceleration, self._exceeded, self._interval, self._period
        return Loop(_loop_of_norm, p, x=(*NO_MEAN * 3, 0.0, 0.0), rows=("+x", "+y", "+z"))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Px4`: p threshold, hold, interval, period; x mean at rest, elapsed, held."""
    threshold, hold, interval, period = p
    mean, known, summed, time, elapsed, held = x[0], x[1], x[2], x[3], x[4], x[5]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        mean, known, summed, time = on_rail(v, dt, mean, known, summed, time)
        elapsed += dt
        if elapsed < interval:
            continue
        worth, elapsed = min(max(elapsed, 0.010), 0.050), 0.0
        held = held + worth if v - mean > threshold and v < MOST_FORCE else 0.0
        if held > hold:
            mean = nan
            known = summed = time = elapsed = held = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5], y[0] = mean, known, summed, time, elapsed, held, first
    return alarms


@compiled
def _loop_of_norm(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Px4Norm`, f (3, n): as the other; x the means of x, y and z, elapsed, held."""
    threshold, hold, interval, period = p
    mx, kx, sx, tx = x[0], x[1], x[2], x[3]
    my, ky, sy, ty = x[4], x[5], x[6], x[7]
    mz, kz, sz, tz = x[8], x[9], x[10], x[11]
    elapsed, held = x[12], x[13]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.shape[1]):
        t = (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        fx, fy, fz = wide(f[0, i]), wide(f[1, i]), wide(f[2, i])
        sound = abs(fx) < MOST_FORCE and abs(fy) < MOST_FORCE and abs(fz) < MOST_FORCE
        if sound:
            mx, kx, sx, tx = on_rail(fx, dt, mx, kx, sx, tx)
            my, ky, sy, ty = on_rail(fy, dt, my, ky, sy, ty)
            mz, kz, sz, tz = on_rail(fz, dt, mz, kz, sz, tz)
        elapsed += dt
        if elapsed < interval:
            continue
        worth, elapsed = min(max(elapsed, 0.010), 0.050), 0.0
        a, b, c = fx - mx, fy - my, fz - mz
        held = held + worth if sound and sqrt(a * a + b * b + c * c) > threshold else 0.0
        if held > hold:
            mx = my = mz = nan
            kx = sx = tx = ky = sy = ty = kz = sz = tz = elapsed = held = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3] = mx, kx, sx, tx
    x[4], x[5], x[6], x[7] = my, ky, sy, ty
    x[8], x[9], x[10], x[11] = mz, kz, sz, tz
    x[12], x[13], y[0] = elapsed, held, first
    return alarms


for _name, _cls, _short in (("px4", Px4, ""), ("px4-norm", Px4Norm, "px4 norm")):
    one_axis(
        _name,
        _cls,
        group="px4",
        level=Level("px4.acceleration", factors=UPWARDS),
        second=Second("px4.time", (0.015, 0.030, 0.050, 0.070)),
        need=need_of("px4", "time", lambda settings, _: settings.px4.time),
        autopilot=True,
        short=_short,
    )
