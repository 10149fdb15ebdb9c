"""The tare of a pair: its mean difference under the cover.

Under the cover the difference is a constant in noise. A sensor that is broken for a while shows another one, and a mean
over both would be off for the whole flight. So readings that are further than `STRAY` from the mean so far make a mean
of their own, beside the first, and that of more readings is the tare.
"""

from math import inf, sqrt

from uavsim.onboard.airspeed.interface import NoiseModel

STRAY, STRAY_SD = 300.0, 20.0  # Pa, and standard deviations of a difference beside: no noise, and no drift in seconds


class Group:
    """Readings of about the same difference: their number, sum, Pa, and conversions of either pressure."""

    __slots__ = ("count", "new_static", "new_total", "sum")

    def __init__(self) -> None:
        self.sum = 0.0
        self.count = self.new_total = self.new_static = 0

    def holds(self, difference: float, stray: float) -> bool:
        """Whether a difference belongs here, as any does while there is none."""
        return not self.count or abs(difference - self.sum / self.count) <= stray

    def add(self, difference: float, new_total: bool, new_static: bool) -> None:
        """Take a reading."""
        self.sum += difference
        self.count += 1
        self.new_total += new_total
        self.new_static += new_static


class Tare:
    """Mean of p_t − p_s over the readings with start < t ≤ end, and what the noise leaves of its variance."""

    __slots__ = ("_first", "_other", "_start", "_static_variance", "_stray", "_total_variance", "end")

    def __init__(self, start: float, end: float, noise: NoiseModel) -> None:
        self._start, self.end = start, end
        self._total_variance, self._static_variance = noise.total_sd**2, noise.static_sd**2
        self._stray = STRAY + STRAY_SD * sqrt(self._total_variance + self._static_variance)
        self._first, self._other = Group(), Group()

    def add(self, t: float, difference: float, new_total: bool, new_static: bool) -> None:
        """Take one reading; a conversion that is read twice weighs twice, but brings its noise only once."""
        if not (self._start < t <= self.end and -inf < difference < inf):
            return
        if self._first.holds(difference, self._stray):
            self._first.add(difference, new_total, new_static)
            return
        if not self._other.holds(difference, self._stray):
            self._other = Group()
        self._other.add(difference, new_total, new_static)
        if self._other.count > self._first.count:
            self._first, self._other = self._other, self._first

    def result(self) -> tuple[float, float]:
        """Return the mean, Pa, and its variance, Pa²; zeros if nothing was read."""
        found = self._first
        if not found.count:
            return 0.0, 0.0
        variance = self._total_variance / max(1, found.new_total) + self._static_variance / max(1, found.new_static)
        return found.sum / found.count, variance
