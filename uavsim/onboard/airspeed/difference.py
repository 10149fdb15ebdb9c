"""The total channel of a head: a total pressure, or the difference that a differential sensor has read.

A row of a head with a differential sensor holds p_total = p_static + Δp. Its total channel is Δp = p_total − p_static,
whose noise has nothing to do with the static sensor's. So that a difference of 0 or below passes as a pressure where
pressures are filtered and gated, it is kept as Δp + `ZERO`, as if the part's other side were at that pressure. What is
taken off the channel to have Δp, or p_t of an absolute sensor, is its `zero`.
"""

from math import nan

from uavsim.airdata import STANDARD_PRESSURE
from uavsim.onboard.airspeed.interface import NoiseModel

ZERO = STANDARD_PRESSURE  # Pa: well inside of what a pressure may be, whatever the sign of the difference
# 1/Pa. The sum in the row has rounded Δp by up to 2⁻³⁷ Pa. Rounded to 2⁻²⁰ Pa a repeated reading is the same number
# again, and no part has such a fine step
FINE = 2.0**20


def channel_range(noise: NoiseModel) -> tuple[float, float]:
    """Return between which values of the total channel the sensor's range lies, Pa."""
    low, high = noise.total_range
    return (low + ZERO, high + ZERO) if noise.differential else (low, high)


class Difference:
    """Takes the total channel out of rows.

    Parameters
    ----------
    differential : bool
        Whether the head has a differential sensor.

    Attributes
    ----------
    zero : float
        What the channel has above the pressure that it stands for, Pa.
    static : float
        The last static pressure that was a number, Pa.
    """

    __slots__ = ("differential", "static", "zero")

    def __init__(self, differential: bool) -> None:
        self.differential = differential
        self.zero = ZERO if differential else 0.0
        self.static = nan

    def read(self, p_total: float, p_static: float) -> float:
        """Return the total channel of a row of two pressures, Pa; the rows come in their order.

        While the static sensor gives no number, the head adds the last one that it gave.
        """
        if not self.differential:
            return p_total
        if p_static == p_static:
            self.static = p_static
        difference = p_total - self.static
        if not -ZERO < difference < ZERO:  # NaN, or no difference of two pressures
            return nan
        return round(difference * FINE) / FINE + ZERO
