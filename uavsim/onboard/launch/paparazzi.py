"""Paparazzi's catapult module: the force reaches 1.5 g at five calls in a row.

Gravity is not taken off. What is left out of the real one is said in `autopilot`. Source: the public firmware.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated

from annotated_types import Interval

from uavsim.onboard.launch.autopilot import Periodic, need_of
from uavsim.onboard.launch.axis import GRAVITY
from uavsim.onboard.launch.bounds import Force, Frequency
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import UPWARDS, Level, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE


@dataclass(frozen=True, slots=True)
class PaparazziSettings:
    """Paparazzi's catapult module, `kind = "paparazzi"`.

    Attributes
    ----------
    acceleration : float
        m/s², with gravity, that is reached: 1.5 g. NAV_CATAPULT_ACCELERATION_THRESHOLD, which is in g.
    calls : int
        Calls in a row at which it is. NAV_CATAPULT_ACCELERATION_DETECTION.
    call_rate : float
        Calls a second, Hz: that of the airframe's main loop.
    """

    acceleration: Force = 1.5 * GRAVITY
    calls: Annotated[int, Interval(ge=1, le=10_000)] = 5
    call_rate: Frequency = 60.0


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

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        return Loop(_loop, (self._acceleration, self._interval, self._period), (self._calls,), y=(0, 0))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Paparazzi`: p threshold, interval, period; q calls; x elapsed; y[1] calls in a row."""
    threshold, interval, period = p
    calls, elapsed, row = q[0], x[0], y[1]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        t = (k0 + i) / rate
        elapsed += t - then if k0 + i != first else period
        then = t
        if elapsed < interval:
            continue
        elapsed = 0.0
        row = row + 1 if threshold <= wide(f[i]) < MOST_FORCE else 0
        if row >= calls:
            row, first = 0, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[0], y[1] = elapsed, first, row
    return alarms


one_axis(
    "paparazzi",
    Paparazzi,
    group="paparazzi",
    level=Level("paparazzi.acceleration", factors=UPWARDS),
    second=Second("paparazzi.calls", (1, 2, 3, 4, 5, 7), whole=True),
    need=need_of("paparazzi", "calls", lambda s, _: (s.paparazzi.calls - 1) / s.paparazzi.call_rate),
    autopilot=True,
    short="paparaz",
)
