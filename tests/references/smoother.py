"""The offline best: the aided filter's states smoothed over the whole flight (Rauch, Tung & Striebel 1965).

Forward, each interval leaves the state and covariance before and after it and the transition F between; backward,

    x̂ = x + C (x̂' − x'⁻),    P̂ = P + C (P̂' − P'⁻) Cᵀ,    C = P Fᵀ (P'⁻)⁻¹

from the last time to the first, dashes being one interval later. What no causal filter can reach is what this one has
over it; it is no estimator that flies.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.gaussian import Array, MatrixFilter
from uavsim.onboard.airspeed import AidedFilter
from uavsim.onboard.airspeed.progress import Progress


class _Recorded(MatrixFilter):
    """The filter's core, which keeps what every interval started from and ended with."""

    __slots__ = ("intervals",)

    def __init__(self, **settings: float) -> None:
        super().__init__(**settings)
        self.intervals: list[tuple[Array, Array, Array, Array, Array]] = []

    def predict(self, dt: float, gained: float, variance: float, density: float, railed: bool) -> None:
        """Advance; see `EnergyModel`."""
        x, p = self.gaussian()
        f = self.jacobian(dt, gained, density, railed)
        super().predict(dt, gained, variance, density, railed)
        self.intervals.append((x, p, f, *self.gaussian()))


class _RecordedProgress(Progress):
    """The filter's instants, all of which are kept."""

    __slots__ = ("ends",)

    def __init__(self, *arguments: Any, **parts: Any) -> None:
        super().__init__(*arguments, **parts)
        self.ends: list[float] = []

    def go(self, to: float, dt: float) -> tuple[float, float]:
        """Go on; see `Progress`."""
        self.ends.append(to)
        return super().go(to, dt)


class RecordedFilter(AidedFilter):
    """The aided estimator that remembers all, to be smoothed; of growing memory and for studies alone."""

    __slots__ = ()
    core = _Recorded
    progress = _RecordedProgress

    def _ends(self) -> list[float]:
        progress = self._progress
        assert isinstance(progress, _RecordedProgress)
        return progress.ends

    def launched(self, t: float) -> None:
        """Start; see `AidedFilter`."""
        if not self.flying:
            self._ends().clear()
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
            np.array(self._ends()), np.array(speeds[-2::-1]), np.sqrt(np.maximum(np.array(deviations[-2::-1]), 0.0))
        )


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """Smoothed airspeed, m/s, and its standard deviation at times t, s; shape (n,) each."""

    t: Array
    airspeed: Array
    sd: Array
