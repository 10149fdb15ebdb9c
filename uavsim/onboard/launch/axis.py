"""What detectors of one signed axis share: which force they look at, the clock, and recognising once.

A sample stands for the time since the last, dt, the first for one nominal period. A gap is a dt above `GAP_PERIODS`
nominal periods; the sample after it stands for no more than those, and so does the one that shows that the clock has
taken a step (`uavsim.onboard.stamps`, where it is said which samples are left out for their times).
"""

from fractions import Fraction
from math import inf, isfinite, nan
from typing import get_args

from uavsim.onboard.launch.detector import GAP_PERIODS, ROUNDING, Axis, periods, require
from uavsim.onboard.stamps import Stamps, jump

GRAVITY = 9.80665  # m/s², ISO 80000-3


class OneAxis:
    """A detector of the force along one signed body axis; what it does with a sample is a subclass's `_take`.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    level, count, total, triggered
        As of every `Detector`.

    Raises
    ------
    ValueError
        Settings outside their bounds.
    """

    __slots__ = (
        "_forward",
        "_index",
        "_longest",
        "_period",
        "_recognised",
        "_sign",
        "_stamps",
        "_t",
        "count",
        "level",
        "total",
        "triggered",
    )

    def __init__(self, rate: float, axis: Axis = "+x") -> None:
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        require(axis in get_args(Axis), f"axis must be one of {', '.join(get_args(Axis))}")
        self._period = 1.0 / rate
        self._longest = GAP_PERIODS * ROUNDING / rate
        self._stamps = Stamps(jump(rate))
        self._forward = axis == "+x"
        self._index, self._sign = "xyz".index(axis[1]), -1.0 if axis[0] == "-" else 1.0
        self.reset()

    def reset(self) -> None:
        """Forget everything: ready for the first sample, whatever its time."""
        self._t = nan
        self._recognised = False
        self.level = self.count = self.total = 0
        self.triggered = False
        self._clear()

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; True on the one at which the launch is recognised, then False until `reset`.

        Parameters
        ----------
        t : float
            Time of the sample, s.
        fx, fy, fz : float
            Specific force in body axes, m/s².
        """
        if self._recognised:
            return False
        dt = t - self._t
        late = False
        if not 0.0 < dt <= self._longest:
            if not self._stamps.admit(t, self._t):
                return False
            late = dt == dt  # else the first
            dt = GAP_PERIODS * self._period if late else self._period
        self._t = t
        f = fx if self._forward else self._sign * (fx, fy, fz)[self._index]
        if self._take(f, dt, late):
            self._recognised = self.triggered = True
            return True
        return False

    def _clear(self) -> None:
        """Forget what samples said."""
        raise NotImplementedError

    def _take(self, f: float, dt: float, late: bool) -> bool:
        """Take the force, m/s², of a sample that stands for dt, s; `late`: after a gap or a step of the clock.

        One that is NaN or implausible does not exceed.
        """
        raise NotImplementedError


class Counting(OneAxis):
    """A detector whose windows are whole numbers of samples; what it does with one of them is a subclass's `_count`."""

    __slots__ = ("_once",)

    def __init__(self, rate: float, axis: Axis = "+x") -> None:
        super().__init__(rate, axis)
        self._once = 1.5 * self._period  # s; up to here a sample counts once

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if dt > self._once and self._catch_up(f, dt, late):
            return True
        return self._count(f)

    def _catch_up(self, f: float, dt: float, late: bool) -> bool:
        """Count the sample for those that were lost before it; after a gap forget them instead."""
        if late:
            self._clear()
            return False
        return any(self._count(f) for _ in range(periods(dt, self._period) - 1))

    def _count(self, f: float) -> bool:
        """Count a sample of the force f, m/s², which may be NaN or implausible; True if it recognises."""
        raise NotImplementedError


def whole(seconds: float, rate: float, name: str) -> int:
    """Samples in a time, at least 1."""
    require(0.0 < seconds < inf, f"{name} must be above 0 s")
    return max(1, round(seconds * rate))


def least(ratio: float, samples: int) -> int:
    """Least whole count that is at least the share of the samples; 0.8 of 10 is 8."""
    require(0.0 < ratio <= 1.0, "ratio must be above 0 and at most 1")
    share = Fraction(ratio).limit_denominator()
    return -(-share.numerator * samples // share.denominator)
