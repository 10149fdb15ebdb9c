"""ArduPlane's check before an automatic take-off: a mean of five values reaches a level, then a delay runs.

The values are taken at 50 Hz, without gravity. A level of 0 is no test: the delay begins at once. Where more than one
event is asked for, the mean has to exceed the level forwards, backwards, forwards and so on, each within 0.5 s of the
one before: the aircraft is shaken to arm it. During the delay nothing is looked at, unless an attitude is told: one
that no launch has ends the delay. What is left out of the real one is said in `autopilot`. Sources: the public
firmware; the level is what its manual gives for throws and bungees.
"""

from dataclasses import dataclass
from math import inf, isfinite, nan, radians
from typing import Annotated

from annotated_types import Interval

from uavsim.onboard.launch.autopilot import LOOP, NO_MEAN, Gravity, Periodic, need_of, on_rail, plausible
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE

APART = 0.5  # s between two events of acceleration at the most
PITCH, ROLL = (radians(-30.0), radians(45.0)), radians(30.0)  # rad, open bounds of an attitude that a launch may have


@dataclass(frozen=True, slots=True)
class ArduPilotSettings:
    """ArduPlane's check of the forward acceleration, `kind = "ardupilot"`.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that the mean of five values at 50 Hz reaches. TKOFF_THR_MINACC; 15 is what its manual
        gives for throws and bungees, the firmware's own default 0 is no test: it launches as soon as the delay is over.
    count : int
        Events of acceleration, forwards and backwards by turns. TKOFF_ACCEL_CNT.
    delay : float
        Time from then to the launch, s. TKOFF_THR_DELAY, which is in tenths of a second.
    """

    acceleration: Annotated[float, Interval(ge=0.0, le=2000.0)] = 15.0
    count: Annotated[int, Interval(ge=1, le=10)] = 1
    delay: Annotated[float, Interval(ge=0.0, le=12.7)] = 0.2


class ArduPilot(Periodic):
    """ArduPlane's check of the forward acceleration before an automatic take-off.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    acceleration : float
        m/s², without gravity, that the mean of five values at 50 Hz reaches; 0: no test. TKOFF_THR_MINACC.
    count : int
        Events of acceleration that are needed; beyond 1 they alternate, +, -, +. TKOFF_ACCEL_CNT.
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
    A force that is NaN or implausible counts as no acceleration. A gap forgets values and events and ends the delay.
    """

    __slots__ = ("_acceleration", "_count", "_delay", "_events", "_gravity", "_since", "_upset", "_values", "_waited")

    def __init__(
        self, rate: float, *, acceleration: float = 15.0, count: int = 1, delay: float = 0.2, axis: Axis = "+x"
    ) -> None:
        self._gravity, self._upset = Gravity(axis), False
        super().__init__(rate, LOOP, axis)
        require(isfinite(acceleration), "acceleration must be finite")
        require(count == int(count) >= 1, "count must be a whole number, at least 1")
        require(isfinite(delay) and delay >= 0.0, "delay must not be below 0 s")
        self._acceleration, self._count, self._delay = acceleration, count, delay / ROUNDING

    def attitude(self, roll: float, pitch: float) -> None:
        """Take an attitude, rad: by it gravity is taken off, and a launch is one within bounds; NaN: not known."""
        self._gravity.attitude(roll, pitch)
        self._upset = pitch <= PITCH[0] or pitch >= PITCH[1] or abs(roll) > ROLL

    def _clear(self) -> None:
        self._gravity.clear()
        self._forget()

    def _forget(self) -> None:
        super()._clear()
        self._values = (0.0,) * 5
        self._waited, self._since, self._events = 0.0, inf, 0
        self.triggered = False

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if not self.triggered or late:
            return super()._take(f, dt, late)
        self._gravity.means[0].add(f, dt)
        if self._upset:
            self._forget()
            return False
        self._waited += dt
        return self._waited >= self._delay

    def _watch(self, f: float, dt: float, late: bool) -> None:
        self._gravity.means[0].add(f, dt)
        if late:
            self._forget()

    def _run(self, f: float, elapsed: float) -> bool:
        a = f - self._gravity.along() if plausible(f) else nan
        self._values = (*self._values[1:], a if a == a else 0.0)
        self._since += elapsed
        self.triggered = self._is_armed() and not self._upset
        return self.triggered and self._delay <= 0.0

    def _is_armed(self) -> bool:
        """Whether the delay begins."""
        level = 5.0 * self._acceleration
        if level == 0.0:
            return True
        a, b, c, d, e = self._values  # not sum(), which compensates its rounding in some versions of Python
        five = a + b + c + d + e
        if self._count == 1:
            return five >= level
        if self._since > APART:
            self._events = 0
        if (five < -level) if self._events % 2 else (five > level):
            self._events, self._since = self._events + 1, 0.0
        return self._events >= self._count

    def loop(self) -> Loop:
        """Return the same rule over arrays, by the mean of the force at rest."""
        p = self._acceleration, self._delay, self._interval, self._period
        return Loop(_loop, p, (self._count,), x=(*NO_MEAN, *(0.0,) * 7, inf), y=(0, 0, 0))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`ArduPilot`: p threshold, delay, interval, period; q events; x mean, elapsed, waited, five values, since.

    y[1] tells whether the delay runs, y[2] how many events there were.
    """
    threshold, delay, interval, period = p
    needed = q[0]
    mean, known, summed, time, elapsed, waited = x[0], x[1], x[2], x[3], x[4], x[5]
    v0, v1, v2, v3, v4, since = x[6], x[7], x[8], x[9], x[10], x[11]
    first, waiting, events, alarms, then = y[0], y[1] != 0, y[2], 0, (k0 - 1) / rate
    level = 5.0 * threshold
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        mean, known, summed, time = on_rail(v, dt, mean, known, summed, time)
        if waiting:
            waited += dt
            launched = waited >= delay
        else:
            elapsed += dt
            if elapsed < interval:
                continue
            since += elapsed
            elapsed, a = 0.0, v - mean
            v0, v1, v2, v3, v4 = v1, v2, v3, v4, a if a == a and abs(v) < MOST_FORCE else 0.0
            five = v0 + v1 + v2 + v3 + v4
            if level == 0.0:
                waiting = True
            elif needed == 1:
                waiting = five >= level
            else:
                if since > APART:
                    events = 0
                if (events % 2 == 1 and five < -level) or (events % 2 == 0 and five > level):
                    events, since = events + 1, 0.0
                waiting = events >= needed
            launched = waiting and delay <= 0.0
        if launched:
            mean = nan
            known = summed = time = elapsed = waited = v0 = v1 = v2 = v3 = v4 = 0.0
            waiting, events, since, first = False, 0, inf, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5] = mean, known, summed, time, elapsed, waited
    x[6], x[7], x[8], x[9], x[10], x[11] = v0, v1, v2, v3, v4, since
    y[0], y[1], y[2] = first, waiting, events
    return alarms


one_axis(
    "ardupilot",
    ArduPilot,
    group="ardupilot",
    level=Level("ardupilot.acceleration", factors=UPWARDS),
    second=Second("ardupilot.delay", (0.0, 0.1, 0.2)),
    need=need_of("ardupilot", "acceleration", lambda *_: 1.0 / LOOP),  # the delay needs no force
    autopilot=True,
    short="ardupil",
)
