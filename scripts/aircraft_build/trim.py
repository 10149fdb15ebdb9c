"""Trim: the symmetric tail deflection that balances the pitching moment about the centre of gravity.

    δ: Cm + a CL - (l/c) 2 N(α - ε + δ) = 0,   a = (x_cg - x_ref)/c,   l = x_tail - x_cg

with the coefficients about the reference point, at the stabiliser's angle of attack, and N a tail half's normal force.
"""

import math

import numpy as np

from .aerodynamics import ALPHAS, LOCAL, Tables
from .geometry import WING_POSITIONS, Geometry
from .mass import centre_of_gravity

ATTACHED = 8.0  # deg of flow at the tail within which the moment is looked for


def trim_deflections(geometry: Geometry, t: Tables) -> list[float]:
    """Deflection (rad) at each wing position."""
    ref, alpha = geometry["reference"], geometry["stabiliser"]["trim_alpha_deg"]
    near = np.abs(LOCAL) <= ATTACHED
    angles, normals = np.array(LOCAL)[near], t["tail-normal"][near, 0]
    result = []
    for k, w in enumerate(WING_POSITIONS):
        lift, moment, epsilon = (np.interp(alpha, ALPHAS, t[n][:, k]) for n in ("CL", "Cm", "epsilon"))
        centre, chord = centre_of_gravity(geometry, w), ref["chord"]
        wanted = moment + (centre - ref["point"][0]) / chord * lift
        needed = wanted * chord / (geometry["tail"]["quarter_chord_x"] - centre) / 2
        result.append(math.radians(float(np.interp(needed, normals, angles)) - alpha) + float(epsilon))
    return result
