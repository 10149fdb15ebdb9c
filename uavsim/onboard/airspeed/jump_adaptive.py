"""Pressures that stand still for a while and then move: a random walk whose filter opens when innovations say so.

Between changes the filter averages: Q is small and K falls as 1/n until it settles. A change shows as innovations
of one sign. Two CUSUMs (Page 1954) watch the innovation over its standard deviation, ν,

    S₊ = max(0, S₊ + ν − κ),    S₋ = max(0, S₋ − ν − κ)

and where one passes its level h the variance is put back to that of one reading and the sums to 0, so that the filter
begins anew from where it is, faster for as long as the change lasts. κ = 1/2 is best against a change of one standard
deviation a sample (Moustakides 1986); h sets how rarely noise alone opens the filter.
"""

from math import inf, nan, sqrt

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.airspeed.random_walk import Channel
from uavsim.onboard.airspeed.settings import EstimatorSettings

DRIFT = 0.5  # κ, standard deviations
LEVEL = 5.0  # h: with κ = 1/2 in white noise once in 465 readings a side
GROWTH = 3e-4  # Q/R of the closed filter: it averages over some 60 readings


class JumpChannel:
    """Filter of one pressure; see `Channel`.

    Parameters
    ----------
    r : float
        Variance of a reading, Pa².
    """

    __slots__ = ("_down", "_q", "_r", "_up", "nis", "value", "variance")

    def __init__(self, r: float) -> None:
        self._r, self._q = r, GROWTH * r
        self.restart()

    def restart(self) -> None:
        """Know nothing."""
        self._up = self._down = 0.0
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        """Predict, and update if the reading is a pressure."""
        prior = self.variance + self._q
        if not 0.0 < reading < inf:
            self.variance, self.nis = prior, nan
            return
        if prior == inf:
            self.value, self.variance = reading, self._r
            return
        innovation, spread = reading - self.value, prior + self._r
        nu = innovation / sqrt(spread) if spread > 0.0 else 0.0
        self._up = max(0.0, self._up + nu - DRIFT)
        self._down = max(0.0, self._down - nu - DRIFT)
        self.nis = nu * nu
        if self._up > LEVEL or self._down > LEVEL:
            prior, self._up, self._down = self._r, 0.0, 0.0
            spread = prior + self._r
        gain = prior / spread if spread > 0.0 else 1.0
        self.value += gain * innovation
        self.variance = gain * self._r


@one_of_ours("jump-adaptive")
class JumpAdaptive(PaperFilter):
    """The two pressures filtered so, then the root; everything else as in `PaperFilter`."""

    __slots__ = ()

    @staticmethod
    def _channels(settings: EstimatorSettings, noise: NoiseModel) -> tuple[Channel, Channel]:
        return JumpChannel(noise.total_sd**2), JumpChannel(noise.static_sd**2)
