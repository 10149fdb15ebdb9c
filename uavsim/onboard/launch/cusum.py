"""Clipped cumulative sum: Page's test for a rise of the mean, with each sample's say bounded.

    S = max(0, S + clip(f - c, -fall, +rise)·dt),    recognised at S > h

f is the force along the launch axis, m/s²; c the `reference`, above a sustained load and below the weakest launch; S
and h (`limit`) are speeds, m/s. The clip above bounds what a shock adds: with a rise of 1 g one of 5 ms adds 5 g·ms,
however strong it is, where h is 14 g·ms. The clip below forgets it within half its time. One state; unlike a count
above a threshold it keeps by how much a sample exceeds. Source: Page, Biometrika 41 (1954) 100; the clip is Huber's
way to bound the influence of one sample.
"""

from math import isfinite

from uavsim.onboard.launch.axis import GRAVITY, OneAxis
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.plausible import MOST_FORCE


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
