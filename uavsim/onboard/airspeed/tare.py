"""The tare of a pair: its mean difference under the cover."""

from math import inf

from uavsim.onboard.airspeed.interface import NoiseModel


class Tare:
    """Mean of p_t − p_s over the readings with start < t ≤ end, and what the noise leaves of its variance."""

    __slots__ = ("_count", "_new_static", "_new_total", "_start", "_static_variance", "_sum", "_total_variance", "end")

    def __init__(self, start: float, end: float, noise: NoiseModel) -> None:
        self._start, self.end = start, end
        self._total_variance, self._static_variance = noise.total_sd**2, noise.static_sd**2
        self._sum = 0.0
        self._count = self._new_total = self._new_static = 0

    def add(self, t: float, difference: float, new_total: bool, new_static: bool) -> None:
        """Take one reading; a conversion that is read twice weighs twice, but brings its noise only once."""
        if self._start < t <= self.end and -inf < difference < inf:
            self._sum += difference
            self._count += 1
            self._new_total += new_total
            self._new_static += new_static

    def result(self) -> tuple[float, float]:
        """Return the mean, Pa, and its variance, Pa²; zeros if nothing was read."""
        if not self._count:
            return 0.0, 0.0
        variance = self._total_variance / max(1, self._new_total) + self._static_variance / max(1, self._new_static)
        return self._sum / self._count, variance
