"""One window of n samples, opened by m samples in a row above a trigger G1 and tested at its end: N / n ≥ k₁.

N counts the samples above the threshold G2; those m are the first of the n. Shares are compared in whole numbers. The
window is a time: a sample that follows lost ones counts for them. A sample that is NaN or implausible does not exceed;
a gap abandons what was counted. Source: "threshold + sequence + time window", to which the published method compares
itself.
"""

from math import isfinite

from uavsim.onboard.launch.axis import Counting, least, whole
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import WINDOWS, Level, Second, Window, one_axis
from uavsim.onboard.launch.levels import above_trigger, lines_of
from uavsim.onboard.plausible import MOST_FORCE


class SequenceWindow(Counting):
    """One window, opened by some samples in a row above a trigger and tested at its end.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    threshold : float
        G2, m/s². A sample counts if it is strictly above.
    window : float
        Its length, s; n = round(window·rate), at least 1.
    ratio : float
        k₁, the share of samples above the threshold at which the launch is recognised, 0 < k₁ ≤ 1.
    trigger : float, optional
        G1 ≥ G2, m/s². None: equal to it.
    axis : str
        Signed body axis that points along the launch.
    sequence : float
        Time for which samples in a row must be above G1, s; m = round(sequence·rate), at least 1. They are the first of
        the window.

    Attributes
    ----------
    level, count, total : int
        1, samples above the threshold, and samples in the open window; 0 while none is open.
    triggered : bool
        Whether the window is open or has recognised a launch.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Examples
    --------
    >>> detector = SequenceWindow(1000.0, threshold=45.0, window=0.005, ratio=0.8, sequence=0.003)
    >>> force = 60.0, 60.0, 0.0, 60.0, 60.0, 60.0, 0.0, 60.0
    >>> [detector.step(0.001 * k, f, 0.0, -9.8) for k, f in enumerate(force)].index(True)
    7
    """

    __slots__ = ("_needed", "_row", "_samples", "_sequence", "_threshold", "_trigger")

    def __init__(
        self,
        rate: float,
        *,
        threshold: float,
        window: float,
        ratio: float,
        sequence: float,
        trigger: float | None = None,
        axis: Axis = "+x",
    ) -> None:
        self._threshold = threshold
        self._trigger = threshold if trigger is None else trigger
        require(isfinite(self._trigger) and isfinite(threshold), "trigger and threshold must be finite")
        require(self._trigger >= threshold, "trigger must not be below threshold")
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        self._samples, self._sequence = whole(window, rate, "window"), whole(sequence, rate, "sequence")
        require(self._sequence <= self._samples, "sequence must not be longer than the window")
        self._needed = least(ratio, self._samples)
        super().__init__(rate, axis)

    def _clear(self) -> None:
        self._row = 0
        self.level = self.count = self.total = 0
        self.triggered = False

    def _count(self, f: float) -> bool:
        if self.triggered:
            self.total += 1
            self.count += self._threshold < f < MOST_FORCE
        elif self._trigger < f < MOST_FORCE:
            self._row += 1
            if self._row < self._sequence:
                return False
            self.level, self.count, self.total, self.triggered = 1, self._row, self._row, True
        else:
            self._row = 0
            return False
        if self.total < self._samples:
            return False
        if self.count >= self._needed:
            return True
        self._clear()
        return False

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        q = self._samples, self._sequence, self._needed
        return Loop(_loop, (self._trigger, self._threshold), q, y=(0,) * 4)


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SequenceWindow`: p trigger, threshold; q samples, sequence, needed; y row, count, total (0: none is open)."""
    trigger, threshold = p
    samples, least, needed = q
    row, count, total, alarms = y[1], y[2], y[3], 0
    for i in range(f.size):
        v = wide(f[i])
        if total == 0:
            if not trigger < v < MOST_FORCE:
                row = 0
                continue
            row += 1
            if row < least:
                continue
            count = total = row
        else:
            total += 1
            count += threshold < v < MOST_FORCE
        if total < samples:
            continue
        recognised = count >= needed
        row = count = total = 0
        if recognised:
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2], y[3] = row, count, total
    return alarms


one_axis(
    "sequence-window",
    SequenceWindow,
    reads=("threshold", "trigger", "window", "ratio", "sequence"),
    level=Level("threshold", beside=("trigger",)),
    second=Second("window", WINDOWS),
    need=above_trigger,
    lines=lines_of,
    window=lambda settings: Window(1, settings.ratio),
)
