"""The aided filter through filterpy's unscented Kalman filter: a reference, some hundred times slower.

The same six states, the same equations and the same noise as `energy`, but no derivative by hand: 13 sigma points go
through the model (Julier & Uhlmann 2004; van der Merwe 2004, α = 0.5, β = 2, κ = 0). Where the two agree the
linearisation and its second-order terms cost nothing. Spikes are not gated here.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.energy import RAIL_SHARE, EnergyFilter

Array = NDArray[np.float64]

STATES = ("v", "b", "p", "s", "d", "k")
NAMES = {(i, j): STATES[i] + STATES[j] for i in range(6) for j in range(i, 6)}
LEAST = 1e-18  # on the diagonal, for the Cholesky factor of what is known exactly


class UnscentedEnergy(EnergyFilter):
    """`EnergyFilter` with its three steps through filterpy."""

    __slots__ = ("_filter",)

    def __init__(self, **settings: float) -> None:
        from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

        super().__init__(**settings)
        points = MerweScaledSigmaPoints(6, alpha=0.5, beta=2.0, kappa=0.0)
        self._filter: Any = UnscentedKalmanFilter(6, 1, 1.0, hx=None, fx=None, points=points)

    def _load(self) -> Any:
        f = self._filter
        f.x = np.array([getattr(self, name) for name in STATES])
        for (i, j), name in NAMES.items():
            f.P[i, j] = f.P[j, i] = getattr(self, name)
        f.P[range(6), range(6)] += LEAST
        f.sigmas_f = f.points_fn.sigma_points(f.x, f.P)
        return f

    def _store(self) -> None:
        f = self._filter
        for name, value in zip(STATES, f.x.tolist(), strict=True):
            setattr(self, name, value)
        for (i, j), name in NAMES.items():
            setattr(self, name, 0.5 * float(f.P[i, j] + f.P[j, i]))

    def predict(self, dt: float, gained: float, variance: float, density: float, railed: bool) -> None:
        """Advance; see `EnergyFilter`."""
        keep, stay = (1.0, 1.0) if railed else (1.0 - dt / self._bias_time, 1.0 - dt / self._slope_time)

        def move(x: Array, _: float) -> Array:
            v, b, p, s, d, k = x
            change = gained - dt * (b + s)
            return np.array([v + change, keep * b, p - density * (v + 0.5 * change) * s * dt, stay * s, d, k])

        share = RAIL_SHARE if railed else 1.0
        bias, slope = share * self._bias_density * dt, share * self._slope_density * dt
        across = -density * (self.v + 0.5 * (gained - dt * (self.b + self.s))) * dt
        q = np.diag([variance, bias, self._static_density * dt, slope, self._difference_density * dt, 0.0])
        if not railed:
            q[0, 0] += dt * dt / 3.0 * (bias + slope)
            q[2, 2] += across * across / 3.0 * slope
            q[0, 1] = q[1, 0] = -0.5 * dt * bias
            q[0, 3] = q[3, 0] = -0.5 * dt * slope
            q[2, 3] = q[3, 2] = 0.5 * across * slope
            q[0, 2] = q[2, 0] = -across * dt / 3.0 * slope
        f = self._load()
        f.Q = q
        f.predict(dt=dt, fx=move)
        self._store()

    def static(self, reading: float, variance: float, ahead: float) -> float:
        """Take a static pressure; see `EnergyFilter`."""
        return self._take(reading, variance, lambda x: np.array([x[2] + ahead * x[3]]))

    def total(self, reading: float, variance: float, pushed: float, heat: float) -> float:
        """Take a total pressure; see `EnergyFilter`."""
        return self._take(
            reading, variance, lambda x: np.array([x[2] * (1.0 + x[0] * x[0] / heat) ** 3.5 + x[4] + pushed * x[5]])
        )

    def _take(self, reading: float, variance: float, expected: Any) -> float:
        f = self._load()
        f.update(np.array([reading]), R=np.array([[variance]]), hx=expected)
        self._store()
        self.innovation, self.taken = float(f.y[0]), True
        return float(f.y[0] ** 2 / f.S[0, 0])


class UnscentedFilter(AidedFilter):
    """The aided estimator with that core."""

    __slots__ = ()
    core = UnscentedEnergy
