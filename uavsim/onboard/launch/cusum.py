"""Clipped cumulative sum: Page's test for a rise of the mean, with each sample's say bounded.

    S = max(0, S + clip(f - c, -fall, +rise)·dt),    recognised at S > h

f is the force along the launch axis, m/s²; c the `reference`, above a sustained load and below the weakest launch; S
and h (`limit`) are speeds, m/s. The clip above bounds what a shock adds: with a rise of 1 g one of 5 ms adds 5 g·ms,
however strong it is, where h is 14 g·ms. The clip below forgets it within half its time. One state; unlike a count
above a threshold it keeps by how much a sample exceeds. Source: Page, Biometrika 41 (1954) 100; the clip is Huber's
way to bound the influence of one sample.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated

from annotated_types import Interval

from uavsim.onboard.launch.axis import GRAVITY, OneAxis
from uavsim.onboard.launch.bounds import Force
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import REFERENCES, WIDELY, Level, Need, Panel, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE

G_MS = 1e-3 * GRAVITY  # m/s in 1 g·ms


@dataclass(frozen=True, slots=True)
class CusumSettings:
    """Clipped cumulative sum, `kind = "cusum"`.

    Attributes
    ----------
    reference : float
        c, m/s². 44.13 is 4.5 g.
    limit : float
        h, m/s. 0.1373 is 14 g·ms.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    """

    reference: Force = 44.13
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.1373
    rise: Force = 9.80665
    fall: Force = 19.6133


class Cusum(OneAxis):
    """Recognise a launch by the clipped sum of what exceeds a level.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    reference : float
        c, m/s²; 4.5 g.
    limit : float
        h, m/s; 14 g·ms.
    rise, fall : float
        Bounds of what a sample adds and takes off, m/s²; 1 g and 2 g.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    sum : float
        S, m/s.
    level, count, total : int
        0: there are no windows.
    triggered : bool
        Whether S is above 0.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible takes off as much as no force does. A sample after a gap counts for three nominal
    periods; S is kept.

    Examples
    --------
    >>> detector = Cusum(1000.0)
    >>> steps = [detector.step(0.001 * k, 60.0, 0.0, -9.8) for k in range(20)]
    >>> steps.index(True)  # fourteen samples only reach the limit
    14
    """

    __slots__ = ("_fall", "_limit", "_reference", "_rise", "sum")

    def __init__(
        self,
        rate: float,
        *,
        reference: float = 4.5 * GRAVITY,
        limit: float = 0.014 * GRAVITY,
        rise: float = 1.0 * GRAVITY,
        fall: float = 2.0 * GRAVITY,
        axis: Axis = "+x",
    ) -> None:
        require(isfinite(reference), "reference must be finite")
        require(all(isfinite(x) and x > 0.0 for x in (limit, rise, fall)), "limit, rise and fall must be above 0")
        self._reference, self._rise, self._fall = reference, rise, -fall
        self._limit = limit * ROUNDING  # a sum that equals the limit must not pass it by rounding of the times
        super().__init__(rate, axis)

    @property
    def limit(self) -> float:
        """What the sum is held against, m/s."""
        return self._limit

    def _clear(self) -> None:
        self.sum = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        excess = f - self._reference
        if excess > self._rise:
            excess = self._rise if f < MOST_FORCE else self._fall
        elif not excess > self._fall:  # NaN too
            excess = self._fall
        total = self.sum + excess * dt
        if total > 0.0:
            self.sum = total
            self.triggered = True
            return total > self._limit
        self.sum = 0.0
        self.triggered = False
        return False

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        return Loop(_loop, (self._reference, self._rise, self._fall, self._limit, self._period))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Cusum`: p reference, rise, -fall, limit, period; x the sum, never below 0."""
    reference, rise, fall, limit, period = p
    total, first, alarms = x[0], y[0], 0
    for i in range(f.size):
        v = wide(f[i])
        excess: float = v - reference
        if total == 0.0 and not excess > 0.0:
            continue
        if excess > rise:
            excess = rise if v < MOST_FORCE else fall
        elif not excess > fall:  # NaN too
            excess = fall
        k = k0 + i
        total += excess * (k / rate - (k - 1) / rate if k != first else period)
        if not total > 0.0:
            total = 0.0
        elif total > limit:
            total, first = 0.0, k + 1
            out[alarms] = k
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[0] = total, first
    return alarms


one_axis(
    "cusum",
    Cusum,
    group="cusum",
    level=Level("cusum.limit", "m/s", WIDELY),
    second=Second("cusum.reference", REFERENCES, over_push=True),
    need=lambda s, _: Need("cusum.reference", s.cusum.reference, "cusum.limit", s.cusum.limit / s.cusum.rise),
    lines=lambda s: {"c": s.cusum.reference},
    panels=(Panel("S, g·ms", (("sum S", "sum"), ("limit h", "limit")), G_MS),),
)
