"""Rules that autopilots fly, with their defaults, as far as specific force alone decides.

PX4        a > 30 m/s² for more than 50 ms, run at 50 Hz, each run worth 10 … 50 ms      gravity-free
ArduPilot  mean of 5 values at 50 Hz ≥ 15 m/s², then 0.2 s without another look          gravity-free
iNav       f > 18.63 m/s² (1.9 g) for 40 ms behind a 15 Hz second-order low-pass         raw
Paparazzi  f ≥ 1.5 g at 5 calls in a row, at 60 Hz                                       raw
AltOS      a > 20 m/s² and a speed of 5 m/s, the integral of a                           gravity-free

The real ones take gravity off by attitude. Here it is the mean of the force on the rail that is taken off, over blocks
of 0.5 s and with one block of delay, so that the launch is not in it: they see nothing in the first second. Left out
are gates on attitude, heading and satellite speed, the filters of their estimators, and AltOS's barometer. A gap begins
anew. Sources: the public firmware of each; ArduPilot's level is what its manual gives for throws and bungees.
"""

from math import cos, isfinite, nan, pi, sin, sqrt

from uavsim.onboard.launch.axis import GRAVITY, OneAxis
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.plausible import MOST_FORCE

BLOCK = 0.5  # s, over which the force on the rail is averaged
LOOP = 50.0  # Hz, at which PX4 runs its detector and ArduPlane its main loop


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

    __slots__ = ("_acceleration", "_exceeded", "_held", "_mean")

    def __init__(self, rate: float, *, acceleration: float = 30.0, time: float = 0.050, axis: Axis = "+x") -> None:
        super().__init__(rate, LOOP, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(isfinite(time) and time > 0.0, "time must be above 0 s")
        self._acceleration, self._exceeded = acceleration, time * ROUNDING

    def _clear(self) -> None:
        super()._clear()
        self._mean = RailMean()
        self._held = 0.0

    def _watch(self, f: float, dt: float, late: bool) -> None:
        self._mean.add(f, dt)
        if late:
            self._held = 0.0

    def _run(self, f: float, elapsed: float) -> bool:
        return self._judge(f - self._mean.before if f < MOST_FORCE else nan, elapsed)

    def _judge(self, a: float, elapsed: float) -> bool:
        self._held = self._held + min(max(elapsed, 0.010), 0.050) if a > self._acceleration else 0.0
        self.triggered = self._held > 0.0
        return self._held > self._exceeded


class Px4Norm(Px4):
    """PX4's launch detector on the magnitude of the acceleration, as since March 2026; settings of `Px4`.

    A sample that is NaN or implausible along any axis is not above, and is left out of the mean.
    """

    __slots__ = ("_blocks", "_felt")

    def _clear(self) -> None:
        super()._clear()
        self._blocks = RailMean(), RailMean(), RailMean()
        self._felt = 0.0, 0.0, 0.0

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; see `Detector`."""
        most = MOST_FORCE
        sound = -most < fx < most and -most < fy < most and -most < fz < most
        self._felt = (fx, fy, fz) if sound else (nan, nan, nan)
        return super().step(t, fx, fy, fz)

    def _watch(self, f: float, dt: float, late: bool) -> None:
        x, y, z = self._blocks
        fx, fy, fz = self._felt
        if fx == fx:
            x.add(fx, dt)
            y.add(fy, dt)
            z.add(fz, dt)
        if late:
            self._held = 0.0

    def _run(self, f: float, elapsed: float) -> bool:
        x, y, z = (felt - block.before for felt, block in zip(self._felt, self._blocks, strict=True))
        return self._judge(sqrt(x * x + y * y + z * z), elapsed)


class ArduPilot(Periodic):
    """ArduPlane's check of the forward acceleration before an automatic take-off.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², without gravity, that the mean of five values at 50 Hz reaches; TKOFF_THR_MINACC, whose own default, 0, is
        no test.
    delay : float
        From then to the launch, s; TKOFF_THR_DELAY.
    axis : str
        Signed body axis that points along the launch.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible counts as no acceleration. A gap forgets the values and ends the delay.
    """

    __slots__ = ("_acceleration", "_delay", "_mean", "_values", "_waited")

    def __init__(self, rate: float, *, acceleration: float = 15.0, delay: float = 0.2, axis: Axis = "+x") -> None:
        super().__init__(rate, LOOP, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(isfinite(delay) and delay >= 0.0, "delay must not be below 0 s")
        self._acceleration, self._delay = acceleration, delay / ROUNDING

    def _clear(self) -> None:
        self._mean = RailMean()
        self._forget()

    def _forget(self) -> None:
        super()._clear()
        self._values = (0.0,) * 5
        self._waited = 0.0
        self.triggered = False

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if not self.triggered or late:
            return super()._take(f, dt, late)
        self._mean.add(f, dt)
        self._waited += dt
        return self._waited >= self._delay

    def _watch(self, f: float, dt: float, late: bool) -> None:
        self._mean.add(f, dt)
        if late:
            self._forget()

    def _run(self, f: float, elapsed: float) -> bool:
        a = f - self._mean.before if _plausible(f) else nan
        self._values = (*self._values[1:], a if a == a else 0.0)
        a, b, c, d, e = self._values  # not sum(), which compensates its rounding in some versions of Python
        self.triggered = a + b + c + d + e >= 5.0 * self._acceleration
        return self.triggered and self._delay <= 0.0


class Inav(OneAxis):
    """iNav's launch by acceleration ("bungee").

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

    __slots__ = ("_a1", "_a2", "_acceleration", "_b0", "_cutoff", "_held", "_needed", "_started", "_z1", "_z2")

    def __init__(
        self,
        rate: float,
        *,
        acceleration: float = 18.63,
        time: float = 0.040,
        cutoff: float = 15.0,
        axis: Axis = "+x",
    ) -> None:
        super().__init__(rate, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(all(isfinite(x) and x > 0.0 for x in (time, cutoff)), "time and cutoff must be above 0")
        self._acceleration, self._needed = acceleration, time / ROUNDING
        self._b0, self._a1, self._a2 = lowpass(cutoff / rate) if rate > 2.0 * cutoff else (1.0, 0.0, 0.0)
        self._cutoff = rate > 2.0 * cutoff

    def _clear(self) -> None:
        self._started = False
        self._held = self._z1 = self._z2 = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if late:
            self._clear()
        if not (_plausible(f) and self._filtered(f) > self._acceleration):
            self._held = 0.0
            self.triggered = False
            return False
        self._held += dt
        self.triggered = True
        return self._held >= self._needed

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


class Paparazzi(Periodic):
    """Paparazzi's catapult module.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², with gravity; reached is enough. NAV_CATAPULT_ACCELERATION_THRESHOLD is in g.
    calls : int
        How many in a row.
    call_rate : float
        Calls a second, Hz; at a lower rate of samples each is a call.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    level, count, total : int
        1, calls in a row, and those that are needed; 0 while there is none.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible at a call is one below.
    """

    __slots__ = ("_acceleration", "_calls")

    def __init__(
        self,
        rate: float,
        *,
        acceleration: float = 1.5 * GRAVITY,
        calls: int = 5,
        call_rate: float = 60.0,
        axis: Axis = "+x",
    ) -> None:
        super().__init__(rate, call_rate, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(calls == int(calls) >= 1, "calls must be a whole number, at least 1")
        self._acceleration, self._calls = acceleration, calls

    def _clear(self) -> None:
        super()._clear()
        self._begin()

    def _begin(self) -> None:
        self.level = self.count = self.total = 0
        self.triggered = False

    def _watch(self, f: float, dt: float, late: bool) -> None:
        if late:
            self._begin()

    def _run(self, f: float, elapsed: float) -> bool:
        if not self._acceleration <= f < MOST_FORCE:
            self._begin()
            return False
        self.level, self.count, self.total, self.triggered = 1, self.count + 1, self._calls, True
        return self.count >= self._calls


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
        self._mean = RailMean()
        self.gained = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        self._mean.add(f, dt)
        a = f - self._mean.before if _plausible(f) else nan
        if late:
            self.gained = 0.0
        if a != a:
            return False
        self.gained = max(0.0, self.gained + a * dt)
        self.triggered = a > self._acceleration
        return self.triggered and self.gained > self._speed


def _plausible(f: float) -> bool:
    return -MOST_FORCE < f < MOST_FORCE


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
