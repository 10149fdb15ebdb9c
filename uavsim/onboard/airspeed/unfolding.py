"""The wings that unfold: masses which move push the accelerometer about, and for a while ∫ f_x is trusted less.

Over the time `unfolding_time` from the wings' command on, the integral of f_x wanders from the airspeed by a random
walk of `unfolding_rate`, (m/s)/√s.
"""

from math import inf

from uavsim.onboard.airspeed.settings import AidedSettings


class Unfolding:
    """What unfolding adds to the airspeed's variance.

    Attributes
    ----------
    end : float
        When it is over, s; −inf while the wings are folded.
    """

    __slots__ = ("_begin", "_density", "_time", "end")

    def __init__(self, aided: AidedSettings) -> None:
        self._time, self._density = aided.unfolding_time, aided.unfolding_rate**2
        self.forget()

    def forget(self) -> None:
        """Be told that the wings are folded, or out for good."""
        self._begin, self.end = inf, -inf

    def begin(self, t: float) -> None:
        """Be told that the wings are commanded out at `t`, s."""
        self._begin, self.end = t, t + self._time

    def variance(self, start: float, end: float) -> float:
        """Return what it adds from one time to another, s, m²/s²."""
        if end <= self._begin or start >= self.end:
            return 0.0
        return self._density * (min(end, self.end) - max(start, self._begin))
