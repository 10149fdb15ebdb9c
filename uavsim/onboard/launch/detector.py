"""What a launch detector is: specific force goes in sample by sample, and the launch comes out once.

Specific force f is in body axes (forward, right, down), m/s²; it holds gravity, so a rail at the angle θ reads
g sin θ along x at rest. Time is the sample's own, s.
"""

from typing import Literal, Protocol

Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]

GAP_PERIODS = 3.0  # sample periods; a longer gap inside a window abandons it, and no sample counts for more time
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
