"""Trim: the symmetric tail deflection that balances the pitching moment about the centre of gravity.

    δ = -(Cm + a CL) / (Cm_δ + a CL_δ),   a = (x_cg - x_ref) / c,

with the coefficients about the reference point, at the stabiliser's angle of attack.
"""

import numpy as np

from .aerodynamics import ALPHAS, Tables
from .geometry import WING_POSITIONS, Geometry
from .mass import centre_of_gravity


def trim_deflections(geometry: Geometry, t: Tables) -> list[float]:
    """Deflection (rad) at each wing position."""
    ref, alpha = geometry["reference"], geometry["stabiliser"]["trim_alpha_deg"]
    result = []
    for k, w in enumerate(WING_POSITIONS):
        lift, lift_de, moment, moment_de = (np.interp(alpha, ALPHAS, t[n][:, k]) for n in ("CL", "CLde", "Cm", "Cmde"))
        arm = (centre_of_gravity(geometry, w) - ref["point"][0]) / ref["chord"]
        result.append(-float((moment + arm * lift) / (moment_de + arm * lift_de)))
    return result
