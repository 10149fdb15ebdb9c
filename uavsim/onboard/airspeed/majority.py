"""Mean of a pressure difference that is a constant in noise, by the majority of its readings.

A sensor may be broken for a while. A mean over right and wrong readings would then be off for the whole flight. So
readings that are further than `STRAY` from the mean so far make a second mean. The mean of more readings counts.
"""

from math import sqrt

# Pa, and standard deviations of a difference added to it: further than that from the mean is neither noise nor some
# seconds of drift. By hand; test_nothing_raises holds the check
STRAY, STRAY_SD = 300.0, 20.0


class Group:
    """Readings of about the same difference: their number, their sum, Pa, and the new conversions of each."""

    __slots__ = ("count", "new_static", "new_total", "sum")

    def __init__(self) -> None:
        self.sum = 0.0
        self.count = self.new_total = self.new_static = 0

    def holds(self, difference: float, stray: float) -> bool:
        """Whether a difference belongs here; the first always does."""
        return not self.count or abs(difference - self.sum / self.count) <= stray


class Majority:
    """Two groups of differences.

    Parameters
    ----------
    variance : float
        Of the noise of a difference, Pa².

    Attributes
    ----------
    most : Group
        That of more readings.
    """

    __slots__ = ("_other", "_stray", "most")

    def __init__(self, variance: float) -> None:
        self._stray = STRAY + STRAY_SD * sqrt(variance)
        self.most, self._other = Group(), Group()

    def add(self, difference: float, new_total: bool = True, new_static: bool = True) -> None:
        """Take the difference of a reading, Pa, and whether its conversions are new."""
        group = self.most
        if not group.holds(difference, self._stray):
            if not self._other.holds(difference, self._stray):
                self._other = Group()
            group = self._other
        group.sum += difference
        group.count += 1
        group.new_total += new_total
        group.new_static += new_static
        if self._other.count > self.most.count:
            self.most, self._other = self._other, self.most
