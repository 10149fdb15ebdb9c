"""A pressure as a random walk in white noise: the scalar Kalman filter and its steady state.

P⁻ = P + Q,    K = P⁻/(P⁻ + R),    x = x + K·(z − x),    P = (1 − K)·P⁻ = K·R,    K²/(1 − K) = Q/R at last
"""

from math import inf, nan, sqrt
from typing import Annotated, Protocol

from annotated_types import Ge, Gt

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.settings import EstimatorSettings


def process_noise(settings: EstimatorSettings, noise: NoiseModel) -> tuple[float, float]:
    """Return Q of the total and of the static pressure's filter, Pa²: K²/(1 − K) times the variance tuned for.

    A sensor without noise leaves no choice: any Q makes the gain 1.
    """
    total = noise.total_sd if noise.total_tuned_sd is None else noise.total_tuned_sd
    static = noise.static_sd if noise.static_tuned_sd is None else noise.static_tuned_sd
    return (
        settings.q_total or growth(settings.gain_total, total**2) or 1.0,
        settings.q_static or growth(settings.gain_static, static**2) or 1.0,
    )


def growth(gain: float, r: float) -> float:
    """Return Q for which a random walk's filter settles at `gain` on readings of variance `r`: K²/(1 − K) r."""
    return gain * gain / (1.0 - gain) * r


def steady_gain(q: Annotated[float, Gt(0.0)], r: Annotated[float, Ge(0.0)]) -> float:
    """Find the gain at which the filter of a random walk settles, the root of K²/(1 − K) = q/r in 0…1.

    Parameters
    ----------
    q, r : float
        Growth of the walk's variance a sample and variance of a reading, of the same unit.

    Raises
    ------
    ValueError
        q ≤ 0 or r < 0.

    Examples
    --------
    >>> round(steady_gain(3.2, 1.0), 12)
    0.8
    """
    if not (q > 0.0 and r >= 0.0):
        raise ValueError("q must be above 0 and r not below")
    return 2.0 / (1.0 + sqrt(1.0 + 4.0 * r / q))


class Channel(Protocol):
    """A filter of one pressure."""

    value: float  # Pa, NaN before the first reading
    variance: float  # Pa², infinite before the first reading
    nis: float  # normalised innovation squared of the last reading, NaN if it was the first or no pressure

    def add(self, reading: float) -> None:
        """Take the reading of one conversion, Pa; one that is no pressure only lets the variance grow."""

    def restart(self) -> None:
        """Know nothing: the next reading is the first."""


class RandomWalk:
    """Scalar Kalman filter of a random walk in white noise, started by its first reading.

    Parameters
    ----------
    q, r : float
        Growth of the walk's variance a sample and variance of a reading, Pa².
    """

    __slots__ = ("_q", "_r", "nis", "value", "variance")

    def __init__(self, q: float, r: float) -> None:
        self._q, self._r = q, r
        self.restart()

    def restart(self) -> None:
        """Know nothing."""
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        """Predict, and update if the reading is a pressure."""
        prior = self.variance + self._q
        if not 0.0 < reading < inf:
            self.variance, self.nis = prior, nan
        elif prior == inf:
            self.value, self.variance = reading, self._r
        else:
            innovation, spread = reading - self.value, prior + self._r
            gain = prior / spread
            self.value += gain * innovation
            self.variance = gain * self._r
            self.nis = innovation * innovation / spread
