"""Pressures that rise and fall at rates which wander: a Kalman filter of pressure and its change a sample, each.

    p ← p + ṗ + w/2,    ṗ ← ṗ + w,    w of variance q a sample,    z = p + noise of variance R

the discrete white-noise acceleration model (Bar-Shalom, Li & Kirubarajan 2001, 6.3.2) counted in samples. A ramp is
followed without lag, which a random walk does not. Its gains settle at α and β with (Kalata 1984)

    β = 2·(2 − α) − 4·√(1 − α),        q/R = β²/(1 − α)

so q follows from the pressure's gain α, the same setting as for the random walk.
"""

from math import inf, nan, sqrt

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.airspeed.random_walk import Channel
from uavsim.onboard.airspeed.settings import EstimatorSettings


def rate_growth(gain: float, r: float) -> float:
    """Return q for which the filter settles at the gain α on readings of variance `r`."""
    root = sqrt(1.0 - gain)
    beta = 2.0 * (2.0 - gain) - 4.0 * root
    return (beta / root) ** 2 * r


class RampChannel:
    """Filter of one pressure; see `Channel`.

    Parameters
    ----------
    q, r : float
        Variance of the rate's growth a sample and of a reading, Pa².
    """

    __slots__ = ("_cross", "_q", "_r", "_rate", "_rate_variance", "nis", "value", "variance")

    def __init__(self, q: float, r: float) -> None:
        self._q, self._r = q, r
        self.restart()

    def restart(self) -> None:
        """Know nothing."""
        self._rate = self._cross = self._rate_variance = 0.0
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        """Predict, and update if the reading is a pressure."""
        if self.variance == inf:
            if 0.0 < reading < inf:  # the rate may be anything that two readings can show
                self.value, self.variance, self._rate_variance = reading, self._r, self._r + self._q
            return
        self.value += self._rate
        self.variance += 2.0 * self._cross + self._rate_variance + 0.25 * self._q
        self._cross += self._rate_variance + 0.5 * self._q
        self._rate_variance += self._q
        if not 0.0 < reading < inf:
            self.nis = nan
            return
        innovation, spread = reading - self.value, self.variance + self._r
        alpha, beta = (self.variance / spread, self._cross / spread) if spread > 0.0 else (1.0, 0.0)
        self.value += alpha * innovation
        self._rate += beta * innovation
        self.nis = innovation * innovation / spread if spread > 0.0 else nan
        self._rate_variance -= beta * self._cross
        self._cross *= 1.0 - alpha
        self.variance = alpha * self._r


@one_of_ours("constant-velocity")
class ConstantVelocity(PaperFilter):
    """The two pressures filtered so, then the root; everything else as in `PaperFilter`."""

    __slots__ = ()

    @staticmethod
    def _channels(settings: EstimatorSettings, noise: NoiseModel) -> tuple[Channel, Channel]:
        tuned = (
            noise.total_sd if noise.total_tuned_sd is None else noise.total_tuned_sd,
            noise.static_sd if noise.static_tuned_sd is None else noise.static_tuned_sd,
        )
        return (
            RampChannel(settings.q_total or rate_growth(settings.gain_total, tuned[0] ** 2), noise.total_sd**2),
            RampChannel(settings.q_static or rate_growth(settings.gain_static, tuned[1] ** 2), noise.static_sd**2),
        )
