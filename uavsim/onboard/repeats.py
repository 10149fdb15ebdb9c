"""How often a live sensor may repeat a number: by its noise and its rounding, from the description.

Noise of standard deviation σ that is rounded to steps Δ gives the same number twice with, at the most (a level in the
middle of a step),

    p = erf(Δ/(2√2 σ)),    for σ ≫ Δ on average Δ/(2√π σ),

and n + 1 times in a row with pⁿ. A row for which that is below `RARE` is no live sensor's. Where the noise is far below
a step p is 1, and repetition says nothing.

A digital filter makes neighbours alike: of a first-order one of the time constant τ, read every T, they differ by
noise of σ √(T/(T + τ)) alone.
"""

from math import ceil, erf, inf, log, nan, sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from uavsim.onboard.airspeed.interface import NoiseModel

RARE = 1e-9  # a reading: once in four months at 100 Hz
# readings. A shorter row is never held against a sensor: description and unit may differ. By hand
LEAST = 25
# readings. A live sensor that repeats itself for longer can be told from a dead one by other tests sooner. By hand
MOST = 3000
# readings in a row that chance makes while noise is at least half a step; longer rows are those of a coarse sensor,
# whose readings say less each. By hand; test_a_sensor_of_coarse_steps_may_repeat_itself
FINE = 6.0


def alike(sd: float, step: float, lag: float = 0.0, rate: float = 100.0) -> float:
    """Return p: how probable it is, at the most, that a live sensor repeats its last number.

    Parameters
    ----------
    sd : float
        Of a reading, rounding included, any unit.
    step : float
        By which it is rounded, the same unit; 0: not known, or not rounded.
    lag : float
        Time constant of its filter, s.
    rate : float
        Readings a second, Hz.
    """
    if not sd > 0.0:  # nothing makes its numbers differ
        return 1.0
    if not step > 0.0:
        return 0.0
    variance = (sd * sd - step * step / 12.0) / (1.0 + lag * rate)
    return erf(step / (2.0 * sqrt(2.0 * variance))) if variance > 0.0 else 1.0


def longest_row(p: float) -> float:
    """Return how many times a number may be repeated; infinity where repetition says nothing."""
    if p <= 0.0:
        return LEAST
    if p >= 1.0:
        return inf
    row = ceil(log(RARE) / log(p))
    return inf if row > MOST else max(LEAST, row)


def force_row(noise: "NoiseModel") -> float:
    """Return how many times a live accelerometer may repeat a number: by the noise of the part alone, unshaken."""
    return longest_row(
        alike(noise.accelerometer_white_sd, noise.accelerometer_step, noise.accelerometer_lag, noise.accelerometer_rate)
    )


def warmth_row(noise: "NoiseModel") -> float:
    """Return the same of the thermometer: where its steps are far above its noise infinity, for it cannot be told."""
    return longest_row(
        alike(noise.temperature_white_sd, noise.temperature_step, noise.temperature_lag, noise.head_rate)
    )


class Row:
    """How often the last number has come again.

    Parameters
    ----------
    most : float
        How often it may; infinity: repetition says nothing.

    Attributes
    ----------
    stuck : bool
        Whether it has come again for longer than noise allows.
    """

    __slots__ = ("_last", "_most", "_same", "stuck")

    def __init__(self, most: float) -> None:
        self._most = most
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._last, self._same, self.stuck = nan, 0, False

    def add(self, value: float) -> None:
        """Take a new value."""
        if value == self._last:
            self._same += 1
            self.stuck = self._same >= self._most
        elif value == value:
            self._last, self._same, self.stuck = value, 0, False


def apart(p: float) -> float:
    """Return how many readings say as much as one, where a number is repeated with a probability p."""
    if p >= 1.0:
        return 1e3
    return max(1.0, min(1e3, 1.0 / (1.0 - p)) / FINE)
