"""What a launch detector is: specific force goes in sample by sample, and the launch comes out once.

Specific force f is in body axes (forward, right, down), m/s²; it holds gravity, so a rail at the angle θ reads
g sin θ along x at rest. Time is the sample's own, s.

Detectors count time, not samples. Sums and holds add the time dt since the last sample; windows, whose counts are
whole, let a sample stand for the nearest whole number of nominal periods in dt, as if those that are missing had read
what it reads. So a lost sample costs neither time nor a decision. No sample counts for more than `GAP_PERIODS`.

| sample | its effect |
|---|---|
| the first | counts for one nominal period |
| dt up to `GAP_PERIODS` | counts for dt; in windows round(dt·rate) times, at least once |
| dt above that, a gap | windows, holds and rows begin anew with it, counted once; `Cusum` adds `GAP_PERIODS` |
| its time does not follow the last (`uavsim.onboard.stamps`) | ignored, or as after a gap if the clock took a step |
| its force NaN or implausible (`uavsim.onboard.plausible`) | does not exceed; its time counts |
"""

from typing import Literal, Protocol

Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]

GAP_PERIODS = 3.0  # nominal sample periods; a longer gap inside a window abandons it, and no sample counts for more
ROUNDING = 1.0 + 1e-6  # –; times are k/rate in floating point, so a gap of exactly three periods may read longer


class Detector(Protocol):
    """A launch detector.

    Attributes
    ----------
    level, count, total : int
        Window being filled (or just ended), samples in it that speak for a launch, and samples in it; 0 where a
        detector has no windows.
    triggered : bool
        Whether something speaks for a launch, or it has been recognised.
    """

    level: int
    count: int
    total: int
    triggered: bool

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; True on the one at which the launch is recognised, then False until `reset`.

        Parameters
        ----------
        t : float
            Time of the sample, s.
        fx, fy, fz : float
            Specific force in body axes, m/s².
        """

    def reset(self) -> None:
        """Forget everything: ready for the first sample, whatever its time."""


def require(condition: bool, message: str) -> None:
    """Raise ValueError with the message unless the condition holds."""
    if not condition:
        raise ValueError(message)


def periods(dt: float, period: float) -> int:
    """Nominal periods that a sample stands for: 1 to `GAP_PERIODS`, or 0 after a gap."""
    if dt > GAP_PERIODS * ROUNDING * period:
        return 0
    return max(1, int(dt / period + 0.5))
