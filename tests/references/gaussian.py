"""The filter's state and covariance as a vector and a matrix, for references that want them."""

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.airspeed import EnergyFilter
from uavsim.onboard.airspeed.energy_model import transition

Array = NDArray[np.float64]
STATES = ("v", "b", "p", "s", "d", "k")
NAMES = {(i, j): STATES[i] + STATES[j] for i in range(6) for j in range(i, 6)}


class MatrixFilter(EnergyFilter):
    """`EnergyFilter` whose steady flight is the three calls, so that a reference has to replace no more than those."""

    __slots__ = ()

    def gaussian(self) -> tuple[Array, Array]:
        """Return mean and covariance now."""
        p = np.empty((6, 6))
        for (i, j), name in NAMES.items():
            p[i, j] = p[j, i] = getattr(self, name)
        return np.array([getattr(self, name) for name in STATES]), p

    def put(self, x: Array, p: Array) -> None:
        """Take a mean and a covariance."""
        for name, value in zip(STATES, x.tolist(), strict=True):
            setattr(self, name, value)
        for (i, j), name in NAMES.items():
            setattr(self, name, 0.5 * float(p[i, j] + p[j, i]))

    def shares(self, dt: float, railed: bool) -> tuple[float, float]:
        """Return what b and s keep of themselves over a step."""
        return (1.0, 1.0) if railed else (1.0 - dt / self._bias_time, 1.0 - dt / self._slope_time)

    def jacobian(self, dt: float, gained: float, density: float, railed: bool) -> Array:
        """Return F of the step that begins now."""
        keep, stay = self.shares(dt, railed)
        middle = self.v + 0.5 * (gained - dt * (self.b + self.s))
        f = np.eye(6)
        for (i, j), value in transition(self.s, middle, density=density, dt=dt, keep=keep, stay=stay).items():
            f[i, j] = value
        return f

    def fly(
        self, dt, gained, variance, density, static, static_variance, ahead, total, total_variance, heat
    ) -> tuple[float, float]:
        """Advance and take both pressures; see `EnergyModel.fly`."""
        self.predict(dt, gained, variance, density, False)
        nis = self.static(static, static_variance, ahead)
        return nis, self.total(total, total_variance, 0.0, heat)
