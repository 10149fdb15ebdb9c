"""Shape of wing, tail and fin for AeroSandbox: streamwise sections in the structural frame."""

from typing import Any

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

from .geometry import Geometry, Vector, place

INSET = 0.01  # m, sections keep this far from a corner where the chord would vanish
ROUNDING = 1e-9  # m


def wing_shape(geometry: Geometry, w: float) -> asb.Wing:
    """Cut the turned rectangle of the panel into streamwise sections, and carry it through the fuselage.

    A streamwise section of a swept panel is longer but not thicker: its relative thickness and camber shrink.
    """
    wing = geometry["wing"]
    corners = _panel(geometry, w)
    side, tip = wing["pivot"][1], corners[:, 1].max()
    stations = sorted({side, tip - INSET} | {y for y in corners[:, 1] if side + INSET < y < tip - INSET})
    airfoil = _airfoil(wing["airfoil"])
    sections = []
    for y in [0.0, *stations]:
        front, back = _cut(corners, max(y, side))
        thin = airfoil.scale(scale_x=1.0, scale_y=min(1.0, wing["chord"] / (back - front)))
        sections.append(asb.WingXSec([front, y, 0.0], back - front, wing["incidence_deg"], tripped(thin, geometry)))
    return asb.Wing("wing", sections, symmetric=True)


def _panel(geometry: Geometry, w: float) -> np.ndarray:
    """Corners of the right panel, 4 × 2 of x, y."""
    wing = geometry["wing"]
    front = wing["pivot_chord_fraction"] * wing["chord"]
    back = (wing["pivot_chord_fraction"] - 1) * wing["chord"]
    inner, outer = -wing["inner_length"], wing["length"]
    around = ((inner, front), (outer, front), (outer, back), (inner, back))
    return np.array([place(geometry, w, out, forward) for out, forward in around])


def _cut(corners: np.ndarray, y: float) -> tuple[float, float]:
    """Smallest and largest x of a convex polygon (n × 2 of x, y) on the line of constant y."""
    found = []
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if min(y0, y1) - ROUNDING <= y <= max(y0, y1) + ROUNDING:
            found += [x0, x1] if abs(y1 - y0) < ROUNDING else [x0 + (x1 - x0) * (y - y0) / (y1 - y0)]
    return min(found), max(found)


def tail_shape(geometry: Geometry) -> asb.Wing:
    """Both halves of the tail, at zero deflection."""
    tail = geometry["tail"]
    airfoil = tripped(_airfoil(tail["airfoil"]), geometry)
    sections = []
    for end in ("root", "tip"):
        chord = tail[f"{end}_chord"]
        front = [tail["quarter_chord_x"] - 0.25 * chord, tail[f"{end}_y"], tail["z"]]
        sections.append(asb.WingXSec(front, chord, 0.0, airfoil))
    return asb.Wing("tail", sections, symmetric=True)


def fin_shape(geometry: Geometry) -> asb.Wing:
    """Give the fixed fin on top of the boat tail."""
    fin = geometry["fin"]
    airfoil = tripped(_airfoil(fin["airfoil"]), geometry)
    sections = []
    for end in ("root", "tip"):
        chord = fin[f"{end}_chord"]
        front = [fin["quarter_chord_x"] - 0.25 * chord, 0.0, fin[f"{end}_z"]]
        sections.append(asb.WingXSec(front, chord, 0.0, airfoil))
    return asb.Wing("fin", sections, symmetric=False)


def airplane(geometry: Geometry, wings: list[asb.Wing], point: Vector | None = None) -> asb.Airplane:
    """Join shapes under the reference area, span, chord and point, or another point."""
    ref, name = geometry["reference"], geometry["name"]
    return asb.Airplane(name, point or ref["point"], wings, s_ref=ref["area"], c_ref=ref["chord"], b_ref=ref["span"])


class Tripped(asb.KulfanAirfoil):  # type: ignore[misc]
    """A section whose boundary layers are turbulent from a fraction of the chord on, on both sides."""

    transition = 1.0

    def get_aero_from_neuralfoil(self, *args: Any, **settings: Any) -> Any:
        """Forces and moment, as AeroBuildup asks for them."""
        settings |= {"xtr_upper": self.transition, "xtr_lower": self.transition}
        return super().get_aero_from_neuralfoil(*args, **settings)


def tripped(airfoil: asb.KulfanAirfoil, geometry: Geometry) -> Tripped:
    """The same section with the geometry's transition."""
    sides = airfoil.lower_weights, airfoil.upper_weights
    section = Tripped(airfoil.name, *sides, airfoil.leading_edge_weight, airfoil.TE_thickness, airfoil.N1, airfoil.N2)
    section.transition = geometry["reference"]["transition_chord_fraction"]
    return section


def _airfoil(name: str) -> asb.KulfanAirfoil:
    return asb.Airfoil(name).to_kulfan_airfoil()
