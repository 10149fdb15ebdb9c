"""Windows with one level: counts of the samples above a threshold G2 in n samples, against the share k₁.

    opened by a sample above G1:      N / n ≥ k₁ tested at the end of n samples          (`ThresholdWindow`)
    opened by m such in a row:        the same, those m the first of the n               (`SequenceWindow`)
    the last n samples:               the same, tested at every sample                   (`SlidingWindow`)

Shares are compared in whole numbers. Windows are times, as of the published method: a sample that follows lost ones
counts for them. Sources: "threshold + time window", "threshold + sequence + time window" and
"threshold + sliding time window", to which the published method compares itself. A sample that is NaN or
implausible does not exceed; a gap abandons what was counted.
"""

from fractions import Fraction
from math import isfinite

from uavsim.onboard.launch.axis import Counting, whole
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.plausible import MOST_FORCE


class ThresholdWindow(MultiLevelWindow):
    """One window, opened by a sample above a trigger and tested at its end.

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
    rearm : bool
        Whether it opens again after it failed; if not it is dead until `reset`.

    Raises
    ------
    ValueError
        Settings outside their bounds.
    """

    __slots__ = ()

    def __init__(
        self,
        rate: float,
        *,
        threshold: float,
        window: float,
        ratio: float,
        trigger: float | None = None,
        axis: Axis = "+x",
        rearm: bool = True,
    ) -> None:
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        super().__init__(
            trigger=threshold if trigger is None else trigger,
            threshold=threshold,
            samples=whole(window, rate, "window"),
            levels=1,
            ratio=ratio,
            axes=(axis,),
            rearm=rearm,
            period=1.0 / rate,
        )


class SlidingWindow(Counting):
    """The last n samples, tested at every one.

    Parameters
    ----------
    rate, threshold, window, ratio, axis
        As of `ThresholdWindow`; there is no trigger.

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


class SequenceWindow(Counting):
    """One window, opened by some samples in a row above a trigger and tested at its end.

    Parameters
    ----------
    rate, threshold, window, ratio, trigger, axis
        As of `ThresholdWindow`.
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


def least(ratio: float, samples: int) -> int:
    """Least whole count that is at least the share of the samples; 0.8 of 10 is 8."""
    require(0.0 < ratio <= 1.0, "ratio must be above 0 and at most 1")
    share = Fraction(ratio).limit_denominator()
    return -(-share.numerator * samples // share.denominator)
