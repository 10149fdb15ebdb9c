"""The offline best: the aided filter's states smoothed over the whole flight (Rauch, Tung & Striebel 1965).

Forward, each interval leaves the state and covariance before and after it and the transition F between; backward,

    x̂ = x + C (x̂' − x'⁻),    P̂ = P + C (P̂' − P'⁻) Cᵀ,    C = P Fᵀ (P'⁻)⁻¹

from the last time to the first, dashes being one interval later. What no causal filter can reach is what this one has
over it; it is no estimator that flies.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.energy import EnergyFilter

Array = NDArray[np.float64]
STATES = ("v", "b", "p", "s", "d", "k")
NAMES = {(i, j): STATES[i] + STATES[j] for i in range(6) for j in range(i, 6)}


class _Recorded(EnergyFilter):
    """The filter's core, which keeps what every interval started from and ended with."""

    __slots__ = ("intervals",)

    def __init__(self, **settings: float) -> None:
        super().__init__(**settings)
        self.intervals: list[tuple[Array, Array, Array, Array, Array]] = []

    def gaussian(self) -> tuple[Array, Array]:
        """Return mean and covariance now."""
        p = np.empty((6, 6))
        for (i, j), name in NAMES.items():
            p[i, j] = p[j, i] = getattr(self, name)
        return np.array([getattr(self, name) for name in STATES]), p

    def predict(self, dt: float, gained: float, variance: float, density: float, railed: bool) -> None:
        """Advance; see `EnergyFilter`."""
        x, p = self.gaussian()
        keep, stay = (1.0, 1.0) if railed else (1.0 - dt / self._bias_time, 1.0 - dt / self._slope_time)
        f = np.diag([1.0, keep, 1.0, stay, 1.0, 1.0])
        f[0, 1] = f[0, 3] = -dt
        f[2, 0] = -density * self.s * dt
        f[2, 3] = -density * (self.v + 0.5 * (gained - dt * (self.b + self.s))) * dt
        super().predict(dt, gained, variance, density, railed)
        self.intervals.append((x, p, f, *self.gaussian()))


class RecordedFilter(AidedFilter):
    """The aided estimator that remembers all, to be smoothed; of growing memory and for studies alone."""

    __slots__ = ("_ends",)
    core = _Recorded

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._ends: list[float] = []

    def _advance(self, to: float) -> None:
        core = self.energy
        assert isinstance(core, _Recorded)
        before = len(core.intervals)
        super()._advance(to)
        if len(core.intervals) > before:
            self._ends.append(to)

    def launched(self, t: float) -> None:
        """Start; see `AidedFilter`."""
        if not self.flying:
            self._ends = []
        super().launched(t)

    def smoothed(self) -> "Smoothed":
        """Smooth what has been flown.

        Raises
        ------
        ValueError
            Nothing has been flown.
        """
        core = self.energy
        assert isinstance(core, _Recorded)
        if not core.intervals:
            raise ValueError("nothing has been flown that could be smoothed")
        x, p = core.gaussian()
        speeds, deviations = [x[0]], [p[0, 0]]
        for before, spread, f, after, wide in reversed(core.intervals):
            back = np.linalg.solve(wide, f @ spread).T
            x = before + back @ (x - after)
            p = spread + back @ (p - wide) @ back.T
            speeds.append(x[0])
            deviations.append(p[0, 0])
        # the first is the start itself; the others stand at the ends of the intervals
        return Smoothed(
            np.array(self._ends), np.array(speeds[-2::-1]), np.sqrt(np.maximum(np.array(deviations[-2::-1]), 0.0))
        )


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """Smoothed airspeed, m/s, and its standard deviation at times t, s; shape (n,) each."""

    t: Array
    airspeed: Array
    sd: Array
