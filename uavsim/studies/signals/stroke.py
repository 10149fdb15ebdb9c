"""A catapult's stroke: kinematic acceleration along the rail against time, with the faults that it can have."""

from dataclasses import dataclass
from math import inf, pi
from typing import Literal

import numpy as np

from uavsim.studies.signals.ranges import Array

Shape = Literal["half-sine", "trapezoid", "catapult"]

CATAPULT_PEAK = 66.0  # m/s², kinematic, mean of 90 recorded strokes of an electromechanical catapult
CATAPULT_TIME = 0.61  # s, from no force to no force
CATAPULT_KNOTS = (0.18, 0.28, 0.47)  # s: end of the plateau, of the slope, of the second plateau
CATAPULT_SECOND = 53.0 / CATAPULT_PEAK  # second plateau over the first
WEAK_RISE = 0.02  # s, rise of a hang-fire's weak force
BREAK_RAMP = 0.005  # s, in which a broken stroke's force goes and comes back


@dataclass(frozen=True, slots=True)
class Stroke:
    """Kinematic acceleration along the rail, beginning at t = 0; see `LaunchSettings` for the attributes.

    Raises
    ------
    ValueError
        If the rise takes more than half of a trapezoid or outlasts the catapult's plateau, or the weak force is above
        half the peak.
    """

    shape: Shape
    peak: float  # m/s²
    duration: float  # s
    rise: float = 0.0  # s
    hang: float = 0.0  # s
    weak: float = 0.0  # of the peak
    break_at: float = inf  # s after the stroke itself begins
    gap: float = 0.0  # s

    def __post_init__(self) -> None:
        longest = {"half-sine": inf, "trapezoid": self.duration / 2, "catapult": CATAPULT_KNOTS[0]}[self.shape]
        if not 0.0 <= self.rise <= longest:
            raise ValueError(
                f"a {self.shape} of {self.duration:g} s cannot rise in {self.rise:g} s, only {longest:g} s"
            )
        if not (self.peak >= 0.0 and self.duration > 0.0 and 0.0 <= self.weak <= 0.5 and self.hang >= 0.0):
            raise ValueError("peak and hang must be at least 0, duration above 0 and weak between 0 and 0.5")

    @property
    def end(self) -> float:
        """When the force has gone for good, s after the first force."""
        return self.hang + self.duration

    def force(self, t: Array) -> Array:
        """Return the acceleration at `t`, s after the first force: shape of `t`, m/s²."""
        own = t - self.hang
        force = self._pulse(own)
        if self.hang > 0.0:  # the weak force lasts until the stroke exceeds it, which it does before its middle
            weak = self.weak * self.peak * np.clip(t / WEAK_RISE, 0.0, 1.0)
            force = np.where(own < self.duration / 2, np.maximum(force, weak), force)
        if self.gap > 0.0 and self.break_at < inf:
            knots = self.break_at + np.cumsum([0.0, BREAK_RAMP, self.gap, BREAK_RAMP])
            force = force * np.interp(own, knots, [1.0, 0.0, 0.0, 1.0])
        return force

    def _pulse(self, t: Array) -> Array:
        if self.shape == "half-sine":
            inside = (t > 0.0) & (t < self.duration)
            return np.where(inside, self.peak * np.sin(pi / self.duration * t), 0.0)
        if self.shape == "trapezoid":
            rise = max(self.rise, 1e-9)  # a jump, as far as any clock can tell
            return np.interp(t, [0.0, rise, self.duration - rise, self.duration], [0.0, self.peak, self.peak, 0.0])
        knots = np.array([0.0, max(self.rise, 1e-9), *CATAPULT_KNOTS, CATAPULT_TIME]) * (self.duration / CATAPULT_TIME)
        second = CATAPULT_SECOND * self.peak
        return np.interp(t, knots, [0.0, self.peak, self.peak, second, second, 0.0])
