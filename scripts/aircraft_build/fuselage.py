"""The fuselage: a body of revolution at any angle to the flow, after Jorgensen, NASA TR R-474 (1977).

    C_N A = A_b sin 2α' cos(α'/2) + η c_d A_p sin² α'            α' = α up to 90°, 180° - α beyond
    C_m A = ±(V - A_b (l - x_m)) sin 2α' cos(α'/2) + η c_d A_p (x_m - x_c) sin² α'      + up to 90°, - beyond
    C_A   = C_A0 cos² α',  backwards up to 90°, forwards beyond

A_b and V are the area of the end that the flow leaves and the body's volume; A_p and x_c the side's area and its
centroid; l - x_m the distance of that end from the reference point. The first terms are slender-body theory, the
second ones the drag of a cylinder across the flow. (AeroSandbox's own body holds up to 90° only.)
"""

import math

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

from .geometry import Geometry

CYLINDER_DRAG = 1.2  # c_d across the flow below the drag crisis (Jorgensen, table 1)
SHARE = 0.67  # η at a fineness of 9, from a fit to Jorgensen's figure: the flow gets round the ends


class Fuselage:
    """Coefficients of the fuselage by the reference area and chord, about the reference point.

    What is fixed to it, such as the fin, adds its drag coefficient along the axis.
    """

    def __init__(self, geometry: Geometry, fixed: float = 0.0) -> None:
        body, ref = geometry["fuselage"], geometry["reference"]
        x = np.linspace(body["x"][0], body["x"][-1], 2001)
        diameter = np.interp(x, body["x"], body["diameter"])
        area, chord, point = ref["area"], ref["chord"], ref["point"][0]
        ends = math.pi / 4 * diameter[-1] ** 2 / area, math.pi / 4 * diameter[0] ** 2 / area  # flow leaves aft, ahead
        volume = np.trapezoid(math.pi / 4 * diameter**2, x) / (area * chord)
        side = SHARE * CYLINDER_DRAG / area
        self._lift = ends
        self._munk = (volume - ends[0] * (x[-1] - point) / chord, -(volume - ends[1] * (point - x[0]) / chord))
        self._across = side * np.trapezoid(diameter, x)
        self._across_moment = side * np.trapezoid(diameter * (point - x), x) / chord
        self._axial = _drag_area(geometry) / area + fixed

    def coefficients(self, alpha_deg: np.ndarray) -> np.ndarray:
        """CL, CD in stability axes, and CY, Cl, Cm, Cn: 6 × len(alpha)."""
        alpha = np.radians(alpha_deg)
        c, s = np.cos(alpha), np.sin(alpha)
        sharp = np.arcsin(np.abs(s))  # α' of 0 to 90°
        slender = np.sign(s) * np.sin(2 * sharp) * np.cos(sharp / 2)
        ahead, crossflow = c >= 0, s * np.abs(s)
        normal = np.where(ahead, *self._lift) * slender + self._across * crossflow
        moment = np.where(ahead, *self._munk) * slender + self._across_moment * crossflow
        axial = self._axial * c * np.abs(c)
        nought = np.zeros_like(alpha)
        return np.array([normal * c - axial * s, normal * s + axial * c, nought, nought, moment, nought])


def _drag_area(geometry: Geometry) -> float:
    """Drag area (m²) along the axis: AeroSandbox's skin friction and base, and what the geometry adds."""
    body, ref = geometry["fuselage"], geometry["reference"]
    sections = [asb.FuselageXSec([x, 0.0, 0.0], radius=d / 2) for x, d in zip(body["x"], body["diameter"], strict=True)]
    point = asb.OperatingPoint(asb.Atmosphere(ref["altitude"]), ref["airspeed"])
    alone = asb.Airplane("fuselage", ref["point"], [], [asb.Fuselage("fuselage", sections)], s_ref=1, c_ref=1, b_ref=1)
    drag = float(np.squeeze(asb.AeroBuildup(alone, point).run()["D"]))
    return drag / float(point.dynamic_pressure()) + float(body["drag_area_extra"])
