"""What all of our launch detectors make of time; what a detector takes and gives is in `uavsim.onboard.interface`.

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

from typing import Literal

Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]

GAP_PERIODS = 3.0  # nominal sample periods; a longer gap inside a window abandons it, and no sample counts for more
ROUNDING = 1.0 + 1e-6  # –; times are k/rate in floating point, so a gap of exactly three periods may read longer


def require(condition: bool, message: str) -> None:
    """Raise ValueError with the message unless the condition holds."""
    if not condition:
        raise ValueError(message)


def periods(dt: float, period: float) -> int:
    """Nominal periods that a sample stands for: 1 to `GAP_PERIODS`, or 0 after a gap."""
    if dt > GAP_PERIODS * ROUNDING * period:
        return 0
    return max(1, int(dt / period + 0.5))
