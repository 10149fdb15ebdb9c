"""Speed along a wing's section at its edge: NeuralFoil's, outside the boundary layer, or our own potential flow.

NeuralFoil (Sharpe and Hansman, arXiv:2503.16323) is a network trained on XFOIL that gives u_e/U at 32 stations of each
side, with the boundary layer's displacement in it. Between its first station, at 1/64 of chord, and the nose, where the
stagnation point is, the vortex sheet of `section` serves in any case. NeuralFoil needs AeroSandbox and CasADi, 300 MB,
so it is the extra `survey`; without it the vortex sheet serves everywhere.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.survey.section import naca_flow

Array = NDArray[np.float64]
Source = Literal["auto", "neuralfoil", "panels"]
EdgeSpeed = Callable[[Any], Any]
"""Angle of attack of the section, rad -> speed over that of the stream, signed along the surface."""

SOURCES: tuple[Source, ...] = ("auto", "neuralfoil", "panels")
STATIONS = 32  # of NeuralFoil on each side
FIRST = 0.5 / STATIONS  # of chord
ANGLES = np.radians(np.arange(-14.0, 16.01, 1.0))  # rad, where NeuralFoil is asked; held constant beyond


def choose_source(asked: Source) -> Literal["neuralfoil", "panels"]:
    """Return what gives the speed at the edge.

    Raises
    ------
    ValueError
        NeuralFoil is asked for and not installed.
    """
    if asked == "panels":
        return "panels"
    try:
        import aerosandbox  # noqa: F401
        import neuralfoil  # noqa: F401
    except ImportError:
        if asked == "neuralfoil":
            raise ValueError("NeuralFoil is not installed; pip install 'uavsim[survey]'") from None
        return "panels"
    return "neuralfoil"


def edge_speed(airfoil: str, place: float, source: str, reynolds: float) -> EdgeSpeed:
    """Return the speed at x/c = `place`, above 0 on the upper, below 0 on the lower side, 0 the leading edge."""
    if source == "neuralfoil" and abs(place) >= FIRST:
        speeds = _network(airfoil, reynolds)[0 if place > 0.0 else 1]
        stations = (np.arange(STATIONS) + 0.5) / STATIONS
        column = np.array([np.interp(abs(place), stations, row) for row in speeds])
        sign = 1.0 if place > 0.0 else -1.0
        return lambda alpha: sign * np.interp(alpha, ANGLES, column)
    flow = naca_flow(airfoil)
    along_x, along_y = flow.speed_at(place, 0.0), flow.speed_at(place, 0.5 * np.pi)
    return lambda alpha: along_x * np.cos(alpha) + along_y * np.sin(alpha)


@lru_cache(maxsize=8)
def _network(airfoil: str, reynolds: float) -> tuple[Array, Array]:
    """Speeds of the upper and the lower side, (angles, stations)."""
    import aerosandbox
    import neuralfoil

    found = neuralfoil.get_aero_from_airfoil(
        aerosandbox.Airfoil(airfoil.lower()), alpha=np.degrees(ANGLES), Re=reynolds, model_size="large"
    )
    upper, lower = (
        np.stack([np.asarray(found[f"{side}_bl_ue/vinf_{i}"], dtype=float) for i in range(STATIONS)], axis=1)
        for side in ("upper", "lower")
    )
    return upper, np.abs(lower)


def disagreement(airfoil: str, places: tuple[float, ...], reynolds: float, alphas: Array) -> dict[float, float]:
    """Largest difference of NeuralFoil's speed and ours over angles, rad, a place; needs NeuralFoil."""
    return {
        place: float(
            np.max(
                np.abs(
                    edge_speed(airfoil, place, "neuralfoil", reynolds)(alphas)
                    - edge_speed(airfoil, place, "panels", reynolds)(alphas)
                )
            )
        )
        for place in places
    }
