"""The tare of a pair: its mean difference under the cover."""

from math import inf

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.majority import Majority


class Tare:
    """Mean of p_t − p_s over most of the readings with start < t ≤ end, and what the noise leaves of its variance."""

    __slots__ = ("_differences", "_start", "_static_variance", "_total_variance", "end")

    def __init__(self, start: float, end: float, noise: NoiseModel) -> None:
        self._start, self.end = start, end
        self._total_variance = noise.total_sd**2
        self._static_variance = 0.0 if noise.differential else noise.static_sd**2
        self._differences = Majority(self._total_variance + self._static_variance)

    def add(self, t: float, difference: float, new_total: bool, new_static: bool) -> None:
        """Take one reading; a conversion that is read twice weighs twice, but brings its noise only once."""
        if self._start < t <= self.end and -inf < difference < inf:
            self._differences.add(difference, new_total, new_static)

    def result(self) -> tuple[float, float]:
        """Return the mean, Pa, and its variance, Pa²; zeros if nothing was read."""
        found = self._differences.most
        if not found.count:
            return 0.0, 0.0
        variance = self._total_variance / max(1, found.new_total) + self._static_variance / max(1, found.new_static)
        return found.sum / found.count, variance
