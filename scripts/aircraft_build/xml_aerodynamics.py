"""The aerodynamics as JSBSim's XML: each part in the flow that it meets, on its own dynamic pressure.

Forces are in stability axes (there JSBSim's X is drag and Z lift, Y the body's y), moments in body axes about the
reference point. Wing, tail and the fuselage's lift go with the pressure of the flow in the plane of symmetry, fin and
the fuselage's side with that in the plane of the wing. Every rate is the body's less the air's (air/p-rad_sec, …).

    tail     α_i = α - ε(α, w) g_ε + (q l + α' l ε_α) cos α / V ± p y cos α / V + δ_i     right half +, left half -
             normal N(α_i) and axial A(α_i) along its own chord, so in body axes N and A + N δ_i
    fin      β_f = atan2(v - r l + p z, u), the fuselage's side with atan2(v, u)
    ground   over x = (16 h/b)², h: height of the wing above the ground, b: its span as it is now
             C_Di · φ,  φ = x/(1 + x)            McCormick, Aerodynamics, Aeronautics, and Flight Mechanics, ch. 7
             C_L · K,  K = (1 + s)/(1 + s φ)     lifting line whose induced angle is φ of the free one; s = a₀/(π A)
             ε · g_ε,  g_ε = 1/(1 + (b/4h)²)     images of the trailing vortices, wing and tail level (DATCOM §4.7)

Lift and drag, the whole force along their axes, and the pitching moment are multiplied with factor/lift, factor/drag
and factor/pitch, 1 unless a scenario says otherwise: what is not known of an aircraft's aerodynamics.

A function before the axes is worked out once a step, in this order; the pressures of the planes are of this step there.
"""

import numpy as np

from .aerodynamics import ALPHAS, HEIGHTS, LOCAL, SIDESLIPS, Tables
from .factors import factor
from .geometry import WING_POSITIONS, Geometry
from .mach import MACHS

FOOT = 0.3048  # m

WING, ALPHA_DEG, ALPHA, BETA = "fcs/wing-pos-norm", "aero/alpha-deg", "aero/alpha-rad", "aero/beta-rad"
AREA, SPAN, CHORD = "metrics/Sw-sqft", "metrics/bw-ft", "metrics/cbarw-ft"
BY_SPAN, BY_CHORD = "aero/bi2vel", "aero/ci2vel"  # b/2V and c/2V
P, Q, R = (f"aero/{axis}-rad_sec" for axis in "pqr")
COS, SIN = "aero/cos-alpha", "aero/sin-alpha"
UPRIGHT, SIDEWAYS = "aero/qbar-area-symmetry", "aero/qbar-area-side"  # q̄ S of the two planes
GROUND = "aero/ground-spans"  # h/b
WING_LIFT = "aero/wing-lift"  # C_L of wing and fuselage, far from the ground
BODY_SLIP, FIN_SLIP, FIN_SIDE = "aero/body-slip-rad", "aero/fin-slip-rad", "aero/fin-side"
ROLLING, FLOW = "aero/tail-rolling-rad", "aero/tail-flow-rad"  # p y/V, and α_i but for it and δ_i
RIGHT, LEFT = "aero/tail-right-rad", "aero/tail-left-rad"
NORMAL_RIGHT, NORMAL_LEFT = "aero/tail-right-normal", "aero/tail-left-normal"
AXIAL_RIGHT, AXIAL_LEFT = "aero/tail-right-axial", "aero/tail-left-axial"
MACH = "velocities/mach"
MACH_WING, MACH_TAIL, MACH_FIN = "aero/mach-wing", "aero/mach-tail", "aero/mach-fin"  # factors on a part's lift
NORMAL, AXIAL = "aero/tail-normal", "aero/tail-axial"  # of both halves
KEYS = {
    ALPHA_DEG: ALPHAS,
    WING: WING_POSITIONS,
    GROUND: HEIGHTS,
    BODY_SLIP: np.radians(SIDESLIPS),
    **dict.fromkeys((FIN_SLIP, RIGHT, LEFT), np.radians(LOCAL)),
    MACH: MACHS,
}
"""Keys of a table's rows, by the property that they are of."""


def aerodynamics_xml(geometry: Geometry, t: Tables) -> str:
    """Write what is worked out once a step, and the six axes."""
    functions = _compressibility(t) | _flow(t) | _fin(geometry, t) | _tail(geometry, t)
    axes = _forces(t) | _moments(geometry, t)
    return (
        "  <aerodynamics>\n"
        + "".join(f'    <function name="{name}">{text}</function>\n' for name, text in functions.items())
        + "".join(
            f'    <axis name="{axis}"{_frame(axis)}>\n'
            + "".join(f'      <function name="aero/{name}">{text}</function>\n' for name, text in parts.items())
            + "    </axis>\n"
            for axis, parts in axes.items()
        )
        + "  </aerodynamics>\n"
    )


def _frame(axis: str) -> str:
    return ' frame="STABILITY"' if axis in ("X", "Y", "Z") else ""


def _compressibility(t: Tables) -> dict[str, str]:
    """The factors of the Mach number; none of a slow aircraft."""
    factors = {MACH_WING: "mach-wing", MACH_TAIL: "mach-tail", MACH_FIN: "mach-fin"}
    return {name: _table(table, t, MACH) for name, table in factors.items() if table in t}


def _lifted(t: Tables, factor_of: str, value: str) -> str:
    """A part's lift, or what goes with it, at the Mach number; as it is of a slow aircraft."""
    return _product(factor_of, value) if "mach-wing" in t else value


def _flow(t: Tables) -> dict[str, str]:
    """Rates in the air, pressures, the height over the ground, and the wing's lift."""
    return {
        **{f"aero/{a}-rad_sec": _difference(f"velocities/{a}-aero-rad_sec", f"air/{a}-rad_sec") for a in "pqr"},
        COS: _of("cos", ALPHA),
        SIN: _of("sin", ALPHA),
        UPRIGHT: _product("aero/qbarUW-psf", AREA),
        SIDEWAYS: _product("aero/qbarUV-psf", AREA),
        GROUND: _product("aero/h_b-mac-ft", _table("span-ratio", t, WING)),
        WING_LIFT: _lifted(t, MACH_WING, _table("CL", t, ALPHA_DEG)),
    }


def _fin(geometry: Geometry, t: Tables) -> dict[str, str]:
    """The flow at the fuselage's side and at the fin, and the fin's side force."""
    u, v = "velocities/u-aero-fps", "velocities/v-aero-fps"
    rolling, yawing = _product(P, _fin_z(geometry) / FOOT), _product(R, _table("fin-arm", t, WING))
    return {
        BODY_SLIP: _of("atan2", v, u),
        FIN_SLIP: _of("atan2", _sum(v, rolling, yawing), u),
        FIN_SIDE: _lifted(t, MACH_FIN, _table("fin-side", t, FIN_SLIP)),
    }


def _tail(geometry: Geometry, t: Tables) -> dict[str, str]:
    """The flow at the two halves of the tail, and their forces in body axes."""
    downwash = _product(_lifted(t, MACH_WING, _table("epsilon", t, ALPHA_DEG)), _table("ground-downwash", t, GROUND))
    pitching = _product(_table("tail-arm", t, WING), Q)
    late = _product(_lifted(t, MACH_WING, _table("downwash-lag", t, WING)), "aero/alphadot-rad_sec")
    deflection = {RIGHT: "fcs/tail-right-rad", LEFT: "fcs/tail-left-rad"}
    return {
        FLOW: _sum(_difference(ALPHA, downwash), _product(BY_CHORD, COS, _sum(pitching, late))),
        ROLLING: _product(2 * _tail_y(geometry) / geometry["reference"]["span"], BY_SPAN, COS, P),
        RIGHT: _sum(FLOW, ROLLING, deflection[RIGHT]),
        LEFT: _sum(_difference(FLOW, ROLLING), deflection[LEFT]),
        NORMAL_RIGHT: _lifted(t, MACH_TAIL, _table("tail-normal", t, RIGHT)),
        NORMAL_LEFT: _lifted(t, MACH_TAIL, _table("tail-normal", t, LEFT)),
        AXIAL_RIGHT: _sum(_table("tail-axial", t, RIGHT), _product(NORMAL_RIGHT, deflection[RIGHT])),
        AXIAL_LEFT: _sum(_table("tail-axial", t, LEFT), _product(NORMAL_LEFT, deflection[LEFT])),
        NORMAL: _sum(NORMAL_RIGHT, NORMAL_LEFT),
        AXIAL: _sum(AXIAL_RIGHT, AXIAL_LEFT),
    }


def _forces(t: Tables) -> dict[str, dict[str, str]]:
    """Drag, side force and lift."""
    induced = _product(WING_LIFT, WING_LIFT, _table("ground-drag", t, GROUND))
    rise = [_table("drag-rise", t, MACH)] if "drag-rise" in t else []
    drag = _sum(_table("CD", t, ALPHA_DEG), *rise, induced, _product(SIN, NORMAL), _product(COS, AXIAL))
    wing = _product(WING_LIFT, _table("ground-lift", t, GROUND))
    lift = _sum(wing, _difference(_product(COS, NORMAL), _product(SIN, AXIAL)))
    return {
        "X": {"drag": _product(factor("drag"), UPRIGHT, drag)},
        "Y": {"side": _product(SIDEWAYS, _sum(FIN_SIDE, _table("fuselage-side", t, BODY_SLIP)))},
        "Z": {"lift": _product(factor("lift"), UPRIGHT, lift)},
    }


def _moments(geometry: Geometry, t: Tables) -> dict[str, dict[str, str]]:
    """Rolling, pitching and yawing moment about the reference point."""
    ref = geometry["reference"]
    y, z = _tail_y(geometry) / ref["span"], _fin_z(geometry) / ref["span"]
    tail = (geometry["tail"]["quarter_chord_x"] - ref["point"][0]) / ref["chord"]
    fin = (geometry["fin"]["quarter_chord_x"] - ref["point"][0]) / ref["span"]
    rolling = _sum(_product(P, _table("Clp", t, ALPHA_DEG)), _product(R, _table("Clr", t, ALPHA_DEG)))
    yawing = _sum(_product(P, _table("Cnp", t, ALPHA_DEG)), _product(R, _table("Cnr", t, ALPHA_DEG)))
    swept = _product(_table("sweep-roll", t, WING), COS, WING_LIFT, BETA)
    roll = _sum(
        swept, _product(BY_SPAN, _lifted(t, MACH_WING, rolling)), _product(y, _difference(NORMAL_LEFT, NORMAL_RIGHT))
    )
    pitching = _product(BY_CHORD, Q, _lifted(t, MACH_WING, _table("Cmq", t, WING)))
    pitch = _sum(_lifted(t, MACH_WING, _table("Cm", t, ALPHA_DEG)), pitching, _product(-tail, NORMAL))
    yaw = _sum(_product(BY_SPAN, _lifted(t, MACH_WING, yawing)), _product(y, _difference(AXIAL_RIGHT, AXIAL_LEFT)))
    side = _sum(_product(-fin, FIN_SIDE), _table("fuselage-yaw", t, BODY_SLIP))
    return {
        "ROLL": {"roll": _product(UPRIGHT, SPAN, roll), "fin-roll": _product(SIDEWAYS, SPAN, z, FIN_SIDE)},
        "PITCH": {"pitch": _product(factor("pitch"), UPRIGHT, CHORD, pitch)},
        "YAW": {"yaw": _product(UPRIGHT, SPAN, yaw), "fin-yaw": _product(SIDEWAYS, SPAN, side)},
    }


def _fin_z(geometry: Geometry) -> float:
    fin = geometry["fin"]
    return _mean_chord_at(fin["root_z"], fin["tip_z"], fin["root_chord"], fin["tip_chord"])


def _tail_y(geometry: Geometry) -> float:
    tail = geometry["tail"]
    return _mean_chord_at(tail["root_y"], tail["tip_y"], tail["root_chord"], tail["tip_chord"])


def _mean_chord_at(root: float, tip: float, root_chord: float, tip_chord: float) -> float:
    """Where along a trapezoidal panel its mean aerodynamic chord is, m."""
    return root + (tip - root) / 3 * (root_chord + 2 * tip_chord) / (root_chord + tip_chord)


# -- functions and tables ---------------------------------------------------------------------------------------------

Operand = str | float


def _of(operation: str, *operands: Operand) -> str:
    return f"<{operation}>{''.join(map(_operand, operands))}</{operation}>"


def _sum(*operands: Operand) -> str:
    return _of("sum", *operands)


def _product(*operands: Operand) -> str:
    return _of("product", *operands)


def _difference(*operands: Operand) -> str:
    return _of("difference", *operands)


def _operand(operand: Operand) -> str:
    if isinstance(operand, float):
        return f"<value>{operand:.7g}</value>"
    return operand if operand.startswith("<") else f"<property>{operand}</property>"


def _table(name: str, t: Tables, key: str) -> str:
    """Write a table over its rows' keys, and the wing position if it has columns; each half of the tail its own."""
    values = t[name]
    rows = [f"{k:>14.6g}" + "".join(f"{v:>11.5f}" for v in row) for k, row in zip(KEYS[key], values, strict=True)]
    axes = f'<independentVar lookup="row">{key}</independentVar>'
    if values.shape[1] > 1:
        rows = [" " * 14 + "".join(f"{w:>11.3f}" for w in WING_POSITIONS), *rows]
        axes += f'<independentVar lookup="column">{WING}</independentVar>'
    lines = "\n".join(rows)
    half = {RIGHT: "-right", LEFT: "-left"}.get(key, "")
    return f'<table name="aero/table/{name}{half}">{axes}<tableData>\n{lines}\n</tableData></table>'
