"""The last n samples, tested at every one: N / n ≥ k₁, with N those above the threshold.

Shares are compared in whole numbers. The window is a time: a sample that follows lost ones counts for them. A sample
that is NaN or implausible does not exceed; a gap abandons what was counted. Source: "threshold + sliding time window",
to which the published method compares itself.
"""

from math import isfinite

from uavsim.onboard.launch.axis import Counting, least, whole
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import WINDOWS, Level, Second, Window, one_axis
from uavsim.onboard.launch.levels import above, line
from uavsim.onboard.plausible import MOST_FORCE


class SlidingWindow(Counting):
    """The last n samples, tested at every one.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    threshold : float
        m/s². A sample counts if it is strictly above.
    window : float
        Its length, s; n = round(window·rate), at least 1.
    ratio : float
        k₁, the share of samples above the threshold at which the launch is recognised, 0 < k₁ ≤ 1.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    level, count, total : int
        1, samples above the threshold among the last n, and n; 0 while none is above.
    triggered : bool
        Whether one is above.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    Samples before the first, or before a gap, are as such that do not exceed: a launch that begins at once is
    recognised when k₁·n samples exceed, not after n.

    Examples
    --------
    >>> detector = SlidingWindow(1000.0, threshold=45.0, window=0.010, ratio=0.8)
    >>> steps = [detector.step(0.001 * k, 60.0, 0.0, -9.8) for k in range(20)]
    >>> steps.index(True)
    7
    """

    __slots__ = ("_needed", "_next", "_ring", "_samples", "_threshold")

    def __init__(self, rate: float, *, threshold: float, window: float, ratio: float, axis: Axis = "+x") -> None:
        require(isfinite(threshold), "threshold must be finite")
        self._threshold = threshold
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        self._samples = whole(window, rate, "window")
        self._needed = least(ratio, self._samples)
        super().__init__(rate, axis)

    def _clear(self) -> None:
        self._ring = bytearray(self._samples)
        self._next = 0
        self.level = self.count = self.total = 0
        self.triggered = False

    def _count(self, f: float) -> bool:
        above = self._threshold < f < MOST_FORCE
        if not self.count:
            if not above:
                return False  # a ring of zeros need not turn
            self.level, self.total, self.triggered = 1, self._samples, True
        ring, k = self._ring, self._next
        count = self.count + above - ring[k]
        ring[k] = above
        k += 1
        self._next = 0 if k == self._samples else k
        self.count = count
        if not count:
            self.level, self.total, self.triggered = 0, 0, False
        return count >= self._needed

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        return Loop(_loop, (self._threshold,), (self._samples, self._needed), y=(0,) * (3 + self._samples))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SlidingWindow`: p threshold; q samples, needed; y[1] count, y[2] place in the ring, y[3:] the ring."""
    threshold = p[0]
    samples, needed = q
    count, place, alarms = y[1], y[2], 0
    ring = y[3:]
    for i in range(f.size):
        above = 1 if threshold < wide(f[i]) < MOST_FORCE else 0
        if count + above == 0:
            continue
        count += above - ring[place]
        ring[place] = above
        place += 1
        if place == samples:
            place = 0
        if count >= needed:
            count = place = 0
            ring[:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2] = count, place
    return alarms


one_axis(
    "sliding-window",
    SlidingWindow,
    reads=("threshold", "window", "ratio"),
    level=Level("threshold"),
    second=Second("window", WINDOWS),
    need=above,
    lines=line,
    window=lambda settings: Window(1, settings.ratio),
)
