"""The aided filter through filterpy's unscented Kalman filter: a reference, some hundred times slower.

The same six states, the same equations and the same noise as `energy_model`, but no derivative: 13 sigma points go
through the model (Julier & Uhlmann 2004; van der Merwe 2004, α = 0.5, β = 2, κ = 0). Where the two agree the
linearisation and its second-order terms cost nothing. Spikes are not gated here.
"""

from typing import Any

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

from references.gaussian import Array, MatrixFilter
from uavsim.onboard.airspeed import AidedFilter
from uavsim.onboard.airspeed.energy_model import RAIL_SHARE, P, S, process_noise, step, total_pressure

LEAST = 1e-18  # on the diagonal, for the Cholesky factor of what is known exactly


class UnscentedEnergy(MatrixFilter):
    """`EnergyFilter` with its three steps through filterpy."""

    __slots__ = ("_filter",)

    def __init__(self, **settings: float) -> None:
        super().__init__(**settings)
        points = MerweScaledSigmaPoints(6, alpha=0.5, beta=2.0, kappa=0.0)
        self._filter: Any = UnscentedKalmanFilter(6, 1, 1.0, hx=None, fx=None, points=points)

    def _load(self) -> Any:
        f = self._filter
        f.x, f.P = self.gaussian()
        f.P[range(6), range(6)] += LEAST
        f.sigmas_f = f.points_fn.sigma_points(f.x, f.P)
        return f

    def predict(self, dt: float, gained: float, variance: float, density: float, railed: bool) -> None:
        """Advance; see `EnergyModel`."""
        keep, stay = self.shares(dt, railed)

        def move(x: Array, _: float) -> Array:
            return np.array([*step(*x[:4], dt=dt, gained=gained, density=density, keep=keep, stay=stay), *x[4:]])

        share = RAIL_SHARE if railed else 1.0
        noise = process_noise(
            self.jacobian(dt, gained, density, railed)[P, S],
            dt=dt,
            variance=variance,
            bias=share * self._bias_density * dt,
            slope=share * self._slope_density * dt,
            walk=self._static_density * dt,
            drift=self._difference_density * dt,
        )
        f = self._load()
        f.Q = np.zeros((6, 6))
        for (i, j), value in noise.items():
            f.Q[i, j] = value
        f.predict(dt=dt, fx=move)
        self.put(f.x, f.P)

    def static(self, reading: float, variance: float, ahead: float) -> float:
        """Take a static pressure; see `EnergyModel`."""
        return self._take(reading, variance, lambda x: x[P] + ahead * x[S])

    def total(self, reading: float, variance: float, pushed: float, heat: float) -> float:
        """Take a total pressure; see `EnergyModel`."""
        return self._take(reading, variance, lambda x: total_pressure(x[0], x[2], x[4], x[5], pushed=pushed, heat=heat))

    def _take(self, reading: float, variance: float, expected: Any) -> float:
        f = self._load()
        f.update(np.array([reading]), R=np.array([[variance]]), hx=lambda x: np.array([expected(x)]))
        self.put(f.x, f.P)
        self.innovation, self.taken = float(f.y[0]), True
        return float(f.y[0] ** 2 / f.S[0, 0])


class UnscentedFilter(AidedFilter):
    """The aided estimator with that core."""

    __slots__ = ()
    core = UnscentedEnergy
