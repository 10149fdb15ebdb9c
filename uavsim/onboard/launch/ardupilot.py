"""ArduPlane's check before an automatic take-off: a mean of five values reaches a level, then a delay runs.

The values are taken at 50 Hz, without gravity. During the delay nothing is looked at. What is left out of the real one
is said in `autopilot`. Sources: the public firmware; the level is what its manual gives for throws and bungees.
"""

from dataclasses import dataclass
from math import isfinite, nan
from typing import Annotated

import numpy as np
from annotated_types import Interval

from uavsim.onboard.launch.autopilot import BLOCK, LOOP, NO_MEAN, Periodic, RailMean, need_of, on_rail, plausible
from uavsim.onboard.launch.bounds import Force
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE


@dataclass(frozen=True, slots=True)
class ArduPilotSettings:
    """ArduPlane's check of the forward acceleration, `kind = "ardupilot"`.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that the mean of five values at 50 Hz reaches. TKOFF_THR_MINACC; 15 is what its manual
        gives for throws and bungees, the firmware's own default 0 is no test.
    delay : float
        Time from then to the launch, s. TKOFF_THR_DELAY, which is in tenths of a second.
    """

    acceleration: Force = 15.0
    delay: Annotated[float, Interval(ge=0.0, le=12.7)] = 0.2


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
        a = f - self._mean.before if plausible(f) else nan
        self._values = (*self._values[1:], a if a == a else 0.0)
        a, b, c, d, e = self._values  # not sum(), which compensates its rounding in some versions of Python
        self.triggered = a + b + c + d + e >= 5.0 * self._acceleration
        return self.triggered and self._delay <= 0.0

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        p = self._acceleration, self._delay, self._interval, self._period, BLOCK, ROUNDING
        return Loop(_loop, p, x=(*NO_MEAN, *(0.0,) * 7), y=(0, 0))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`ArduPilot`: p threshold, delay, interval, period, block, rounding; x mean, elapsed, waited, five values.

    y[1] tells whether the delay runs.
    """
    threshold, delay, interval, period, block, rounding = p
    before, last, summed, time, elapsed, waited = x[0], x[1], x[2], x[3], x[4], x[5]
    v0, v1, v2, v3, v4 = x[6], x[7], x[8], x[9], x[10]
    first, waiting, alarms, then = y[0], y[1] != 0, 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        before, last, summed, time = on_rail(v, dt, before, last, summed, time, block, rounding)
        if waiting:
            waited += dt
            launched = waited >= delay
        else:
            elapsed += dt
            if elapsed < interval:
                continue
            elapsed, a = 0.0, v - before
            v0, v1, v2, v3, v4 = v1, v2, v3, v4, a if a == a and abs(v) < MOST_FORCE else 0.0
            waiting = v0 + v1 + v2 + v3 + v4 >= 5.0 * threshold
            launched = waiting and delay <= 0.0
        if launched:
            before = last = np.nan
            summed = time = elapsed = waited = v0 = v1 = v2 = v3 = v4 = 0.0
            waiting, first = False, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5] = before, last, summed, time, elapsed, waited
    x[6], x[7], x[8], x[9], x[10] = v0, v1, v2, v3, v4
    y[0], y[1] = first, waiting
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
