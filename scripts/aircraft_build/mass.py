"""Mass: boxes that stay, and for each wing panel two point masses on its axis.

The two points have the panel's mass, centre of mass and radius of gyration; JSBSim moves them along the arcs about the
pivot (systems/wing.xml).
"""

from dataclasses import dataclass
from typing import NamedTuple

from .geometry import Geometry, Vector, place


@dataclass(frozen=True)
class Body:
    """Mass (kg), centre of mass (m) and the moments Ixx, Iyy, Izz and product Ixz = Σ m x z (kg m²) about it."""

    mass: float
    centre: Vector
    ixx: float
    iyy: float
    izz: float
    ixz: float


class PointMass(NamedTuple):
    """Mass (kg), distance outwards along the panel and forwards of the pivot (m)."""

    mass: float
    out: float
    forward: float


def fixed_body(geometry: Geometry) -> Body:
    """Add up everything that does not move, each item a homogeneous box."""
    items = geometry["item"]
    mass = sum(i["mass"] for i in items)
    cx, cy, cz = (sum(i["mass"] * i["position"][k] for i in items) / mass for k in range(3))
    ixx = iyy = izz = ixz = 0.0
    for i in items:
        m, (x, y, z), (a, b, c) = i["mass"], i["position"], i["size"]
        x, y, z = x - cx, y - cy, z - cz
        ixx += m * (y * y + z * z + (b * b + c * c) / 12)
        iyy += m * (x * x + z * z + (a * a + c * c) / 12)
        izz += m * (x * x + y * y + (a * a + b * b) / 12)
        ixz += m * x * z
    return Body(mass, (cx, cy, cz), ixx, iyy, izz, ixz)


def panel_masses(geometry: Geometry) -> tuple[PointMass, PointMass]:
    """Inner and outer point of one panel."""
    wing = geometry["wing"]
    out = wing["length"] * wing["mass_span_fraction"]
    apart = wing["length"] * wing["gyration_span_fraction"]
    forward = wing["chord"] * (wing["pivot_chord_fraction"] - wing["mass_chord_fraction"])
    return PointMass(wing["mass"] / 2, out - apart, forward), PointMass(wing["mass"] / 2, out + apart, forward)


def centre_of_gravity(geometry: Geometry, w: float) -> float:
    """Structural x (m) of the centre of gravity of the whole at wing position w, with a full tank if it has one."""
    body = fixed_body(geometry)
    mass, moment = body.mass, body.mass * body.centre[0]
    if "turbine" in geometry:
        mass += geometry["turbine"]["fuel"]
        moment += geometry["turbine"]["fuel"] * geometry["turbine"]["tank"][0]
    for m, out, forward in panel_masses(geometry):
        mass += 2 * m
        moment += 2 * m * place(geometry, w, out, forward)[0]
    return float(moment / mass)
