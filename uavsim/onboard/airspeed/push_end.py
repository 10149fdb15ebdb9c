"""When the push has ended, by the force itself: a catapult's after 0.3 s, a bungee's after 2 s, a motor's after 7 s.

The push is over when the mean of f_x less that at rest has been below `LEVEL` for `HOLD` and does not grow: in flight
thrust less drag is a few m/s². The ports are watched `SETTLE` later, behind unfolding and pull-up.
"""

from math import inf

LEVEL = 6.0  # m/s²: 0.6 g. An aircraft with more thrust than that over its drag is still being pushed. By hand
GROWS = 2.0  # m/s² by which the mean may be above the one that is three times as slow. By hand
MEAN, SLOW = 0.1, 0.3  # s of both means
HOLD = 0.3  # s. By hand, three of the mean
# s from then on. With the 0.7 s at which a catapult's end is seen the watch begins 2 s after its recognition, which is
# behind the unfolding (1 s) and the pull-up; docs/faults.md holds the check, the healthy flights
SETTLE = 1.3


class PushEnd:
    """Looks for the end of one push.

    Attributes
    ----------
    steady_from : float
        From when on flight is steady, s; inf before that is known.
    """

    __slots__ = ("_mean", "_quiet", "_slow", "steady_from")

    def __init__(self) -> None:
        self.forget()

    def forget(self, steady_from: float = inf) -> None:
        """Begin anew; `steady_from`, s, where it is known."""
        self._mean = self._slow = 0.0
        self._quiet, self.steady_from = inf, steady_from

    @property
    def lasts(self) -> bool:
        """Whether the force is still one of a push."""
        return self._quiet == inf and self.steady_from == inf

    def add(self, t: float, force: float, dt: float) -> None:
        """Take the mean of f_x less that at rest, m/s², over a time that ended at `t`, s."""
        self._mean += (force - self._mean) * (dt / MEAN if dt < MEAN else 1.0)
        self._slow += (force - self._slow) * (dt / SLOW if dt < SLOW else 1.0)
        if self._mean > LEVEL or self._mean > self._slow + GROWS:
            self._quiet = inf
        elif self._quiet == inf:
            self._quiet = t
        elif t - self._quiet >= HOLD:
            self.steady_from = t + SETTLE
