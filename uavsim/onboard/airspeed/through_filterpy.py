"""The published estimator through the filterpy package, to show that `RandomWalk` is the textbook's filter."""

from math import inf, isnan, nan
from typing import Any

import numpy as np

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.airspeed.random_walk import Channel, process_noise
from uavsim.onboard.airspeed.settings import EstimatorSettings


@one_of_ours("paper-filterpy")
class FilterpyFilter(PaperFilter):
    """The same estimator with the Kalman filter of the filterpy package, two states and one reading at a time.

    It is tens of times slower; its use is to show that `RandomWalk` is the textbook's filter.
    """

    __slots__ = ()

    @staticmethod
    def _channels(settings: EstimatorSettings, noise: NoiseModel) -> tuple[Channel, Channel]:
        from filterpy.kalman import KalmanFilter

        both = KalmanFilter(dim_x=2, dim_z=1)
        q_total, q_static = process_noise(settings, noise)
        return (
            _FilterpyChannel(both, 0, q_total, noise.total_sd**2),
            _FilterpyChannel(both, 1, q_static, noise.static_sd**2),
        )


class _FilterpyChannel:
    """One state of a filterpy filter of two random walks."""

    __slots__ = ("_filter", "_h", "_index", "_q", "_r", "nis", "value", "variance")

    def __init__(self, both: Any, index: int, q: float, r: float) -> None:
        self._filter, self._index = both, index
        self._h = np.zeros((1, 2))
        self._h[0, index] = 1.0
        self._q = np.zeros((2, 2))
        self._q[index, index] = q
        self._r = np.array([[r]])
        self.restart()

    def restart(self) -> None:
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        both, index = self._filter, self._index
        missing = not 0.0 < reading < inf
        self.nis = nan
        if isnan(self.value):
            if missing:
                return
            both.x[index, 0] = reading
            both.P[index, index] = self._r[0, 0]
        else:
            both.predict(Q=self._q)
            if not missing:
                both.update(np.array([[reading]]), R=self._r, H=self._h)
                self.nis = float(both.y[0, 0] ** 2 / both.S[0, 0])
        self.value, self.variance = float(both.x[index, 0]), float(both.P[index, index])
