"""The aerodynamics as JSBSim's XML: six axes, each a sum of table × properties."""

import numpy as np

from .aerodynamics import ALPHAS, Tables
from .geometry import WING_POSITIONS

Term = tuple[str, ...]
"""A table and the properties that it is multiplied with."""

P, Q, R = (f"velocities/{axis}-aero-rad_sec" for axis in "pqr")
BY_SPAN, BY_CHORD = "aero/bi2vel", "aero/ci2vel"  # b/2V and c/2V
ALPHA_RATE = "aero/alphadot-rad_sec"
BETA, SLIP = "aero/beta-rad", "aero/slip"  # β and sin β
ELEVATOR, AILERON = "fcs/tail-symmetric-rad", "fcs/tail-differential-rad"
SPAN, CHORD = "metrics/bw-ft", "metrics/cbarw-ft"
PRESSURE, AREA = "aero/qbar-psf", "metrics/Sw-sqft"
ACROSS, ALONG = "aero/qbar-area", "aero/qbar-area-along"  # q̄ S and q̄ S cos β


def aerodynamics_xml(t: Tables) -> str:
    """Write the six axes: forces in wind axes, moments in body axes about the reference point.

    The tables hold for sideslip as small as flight has it. So that the rail in a side wind, where the angle of attack
    means nothing, is no worse than approximate, they act with q̄ S cos β and the slip is sin β; what is left at 90° is
    the drag of the side, CDbb sin² β + CDbbbb sin⁴ β.
    """
    drag: list[Term] = [("CD",), ("CDde", ELEVATOR), ("CDee", ELEVATOR, ELEVATOR), ("CDaa", AILERON, AILERON)]
    side_drag: list[Term] = [("CDbb", SLIP, SLIP), ("CDbbbb", SLIP, SLIP, SLIP, SLIP)]
    axes = {
        "LIFT": _function("lift", (ALONG,), t, _longitudinal("CL")),
        "DRAG": _function("drag", (ALONG,), t, drag) + _function("side-drag", (ACROSS,), t, side_drag),
        "SIDE": _function("side", (ALONG,), t, _lateral("CY")),
        "ROLL": _function("roll", (ALONG, SPAN), t, _lateral("Cl")),
        "PITCH": _function("pitch", (ALONG, CHORD), t, _longitudinal("Cm")),
        "YAW": _function("yaw", (ALONG, SPAN), t, _lateral("Cn")),
    }
    # functions before the axes see JSBSim's own q̄ S of the step before (at first: not yet written); q̄ is fresh
    return (
        f'  <aerodynamics>\n    <function name="{SLIP}"><sin>{_properties(BETA)}</sin></function>\n'
        f'    <function name="{ALONG}"><product>{_properties(PRESSURE, AREA)}<cos>{_properties(BETA)}</cos></product>'
        "</function>\n"
        + "".join(f'    <axis name="{axis}">\n{functions}    </axis>\n' for axis, functions in axes.items())
        + "  </aerodynamics>\n"
    )


def _lateral(c: str) -> list[Term]:
    return [(f"{c}b", SLIP), (f"{c}p", BY_SPAN, P), (f"{c}r", BY_SPAN, R), (f"{c}da", AILERON)]


def _longitudinal(c: str) -> list[Term]:
    return [(c,), (f"{c}q", BY_CHORD, Q), (f"{c}ad", BY_CHORD, ALPHA_RATE), (f"{c}de", ELEVATOR)]


def _function(name: str, factors: tuple[str, ...], t: Tables, terms: list[Term]) -> str:
    """Write the product of the factors and the sum of table × property × … for each term."""
    lines = []
    for table, *properties in terms:
        term = f"{_properties(*properties)}{_table(table, t[table])}"
        lines.append(f"          <product>{term}          </product>\n" if properties else f"          {term}")
    return (
        f'      <function name="aero/{name}">\n        <product>{_properties(*factors)}<sum>\n{"".join(lines)}'
        "        </sum></product>\n      </function>\n"
    )


def _table(name: str, values: np.ndarray) -> str:
    """Write a table over angle of attack (rows) and wing position (columns), or over wing position alone."""
    if len(values) == 1:
        rows = [f"          {w:>11.3f}{v:>11.5f}" for w, v in zip(WING_POSITIONS, values[0], strict=True)]
        variables = '<independentVar lookup="row">fcs/wing-pos-norm</independentVar>'
    else:
        rows = [" " * 14 + "".join(f"{w:>11.3f}" for w in WING_POSITIONS)]
        rows += [f"{a:>14d}" + "".join(f"{v:>11.5f}" for v in row) for a, row in zip(ALPHAS, values, strict=True)]
        variables = (
            '<independentVar lookup="row">aero/alpha-deg</independentVar>'
            '<independentVar lookup="column">fcs/wing-pos-norm</independentVar>'
        )
    lines = "\n".join(rows)
    return f'<table name="aero/{name}">{variables}\n          <tableData>\n{lines}\n          </tableData></table>\n'


def _properties(*names: str) -> str:
    return "".join(f"<property>{name}</property>" for name in names)
