"""Build an aircraft's JSBSim files from its geometry: python scripts/build_aircraft.py aircraft/fw8.

Aerodynamics: AeroSandbox's AeroBuildup (strips with NeuralFoil sections, slender fuselage) over wing position w and
angle of attack α, for wing, fuselage and fin together and for the tail alone in the wing's downwash

    ε(α, w) = Γ/V · mean of g(y)/4π over the tail's span,   Γ/V = L_wing / (ρ V² b'),   b' = (π/4) b(w),

where g/4π is the downwash of a horseshoe vortex of unit circulation (Biot-Savart; the span b' of an elliptic wing's
rolled-up wake, e.g. Katz & Plotkin, Low-Speed Aerodynamics, 2nd ed., §4.9). Derivatives are central differences.

Mass: boxes and points that stay, and for each wing panel two point masses on its axis which have the panel's mass,
centre of mass and radius of gyration; JSBSim moves them along the arcs about the pivot (systems/wing.xml).

Writes AIRCRAFT_DIR/NAME.xml and AIRCRAFT_DIR/engine/*.xml; nothing in them is edited by hand. The header carries the
SHA-256 of geometry.toml, which a test compares. Structural frame of both: x aft, y right, z up.
"""

from __future__ import annotations

import hashlib
import math
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

Geometry = dict[str, Any]
Vector = tuple[float, float, float]

WING_POSITIONS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0)
ALPHAS: tuple[int, ...] = (
    *(-90, -60, -40, -30, -25, -20, -16, -14, -12, -10, -8, -6, -4, -2, 0, 2, 4, 6, 8, 10),
    *(11, 12, 13, 14, 15, 16, 18, 20, 25, 30, 40, 60, 90),
)  # deg; JSBSim holds the last row beyond ±90, where the moment still turns the nose back into the wind
BETA_STEP = 6.0  # deg, half width of the differences over sideslip
RATE_STEP = 0.02  # of p b/2V, q c/2V and r b/2V
TAIL_STEP = 8.0  # deg of tail deflection: a secant to where the tail begins to stall

KG_TO_LB = 1.0 / 0.45359237  # exact, international pound
PA_TO_PSF = 1.0 / 47.880259  # lbf/ft²
SEA_LEVEL_DENSITY = 1.225  # kg/m³, standard atmosphere
VORTEX_CORE = 0.05  # m, radius inside which the trailing vortices' field is cut off (about a third of the chord)


# -- mass ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Body:
    """Mass (kg), centre of mass (m) and the moments Ixx, Iyy, Izz and product Ixz = Σ m x z (kg m²) about it."""

    mass: float
    centre: Vector
    ixx: float
    iyy: float
    izz: float
    ixz: float


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


def sweep(geometry: Geometry, w: float) -> float:
    """Sweep angle (rad) at wing position w, 0 folded to 1 out."""
    wing = geometry["wing"]
    return math.radians(wing["sweep_folded_deg"] + w * (wing["sweep_out_deg"] - wing["sweep_folded_deg"]))


def panel_masses(geometry: Geometry) -> tuple[tuple[float, float, float], ...]:
    """Mass (kg), distance outwards along the panel and forwards of the pivot (m) of the two points of one panel."""
    wing = geometry["wing"]
    out = wing["length"] * wing["mass_span_fraction"]
    apart = wing["length"] * wing["gyration_span_fraction"]
    forward = wing["chord"] * (wing["pivot_chord_fraction"] - wing["mass_chord_fraction"])
    return tuple((wing["mass"] / 2, out + side * apart, forward) for side in (-1, 1))


def place(geometry: Geometry, w: float, out: float, forward: float) -> tuple[float, float]:
    """Structural x, y (m) of a point of the right panel given along and across the panel from its pivot."""
    s, c = math.sin(sweep(geometry, w)), math.cos(sweep(geometry, w))
    x, y = geometry["wing"]["pivot"]
    return x + out * s - forward * c, y + out * c + forward * s


def centre_of_gravity(geometry: Geometry, w: float) -> tuple[float, float]:
    """Mass (kg) of the whole and structural x (m) of its centre of gravity at wing position w."""
    body = fixed_body(geometry)
    mass, moment = body.mass, body.mass * body.centre[0]
    for m, out, forward in panel_masses(geometry):
        mass += 2 * m
        moment += 2 * m * place(geometry, w, out, forward)[0]
    return mass, moment / mass


# -- shape ---------------------------------------------------------------------------------------------------------


def cut(corners: np.ndarray, y: float) -> tuple[float, float]:
    """Smallest and largest x of a convex polygon (n × 2 of x, y) on the line of constant y."""
    found = []
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if min(y0, y1) - 1e-9 <= y <= max(y0, y1) + 1e-9:
            found += [x0, x1] if abs(y1 - y0) < 1e-9 else [x0 + (x1 - x0) * (y - y0) / (y1 - y0)]
    return min(found), max(found)


def wing_shape(geometry: Geometry, w: float) -> asb.Wing:
    """Cut the turned rectangle of the panel into streamwise sections, and carry it through the fuselage.

    A streamwise section of a swept panel is longer but not thicker: its relative thickness and camber shrink.
    """
    wing = geometry["wing"]
    chord, fore = wing["chord"], wing["pivot_chord_fraction"]
    panel = (
        (-wing["inner_length"], fore),
        (wing["length"], fore),
        (wing["length"], fore - 1),
        (-wing["inner_length"], fore - 1),
    )
    corners = np.array([place(geometry, w, out, forward * chord) for out, forward in panel])
    side, tip = wing["pivot"][1], corners[:, 1].max()
    inset = 0.01  # m, short of a corner where the chord would vanish
    stations = sorted({side, tip - inset} | {y for y in corners[:, 1] if side + inset < y < tip - inset})
    airfoil = asb.Airfoil(wing["airfoil"]).to_kulfan_airfoil()
    sections = []
    for y in [0.0, *stations]:
        front, back = cut(corners, max(y, side))
        thin = airfoil.scale(scale_x=1.0, scale_y=min(1.0, chord / (back - front)))
        sections.append(asb.WingXSec([front, y, 0.0], back - front, wing["incidence_deg"], thin))
    return asb.Wing("wing", sections, symmetric=True)


def tail_shape(geometry: Geometry, symmetric_deg: float, differential_deg: float) -> asb.Wing:
    """Both halves of the tail; trailing edge down is positive, left down and right up is positive differential."""
    tail = geometry["tail"]
    # AeroSandbox turns the left half of an antisymmetric surface the other way: positive here is right half down
    surfaces = [
        asb.ControlSurface("pitch", True, symmetric_deg, 0.0),
        asb.ControlSurface("roll", False, -differential_deg, 0.0),
    ]
    sections = [
        asb.WingXSec(
            [tail["quarter_chord_x"] - 0.25 * tail[f"{end}_chord"], tail[f"{end}_y"], tail["z"]],
            tail[f"{end}_chord"],
            tail["incidence_deg"],
            asb.Airfoil(tail["airfoil"]).to_kulfan_airfoil(),
            surfaces,
        )
        for end in ("root", "tip")
    ]
    return asb.Wing("tail", sections, symmetric=True)


def fin_shape(geometry: Geometry) -> asb.Wing:
    """Give the fixed fin on top of the boat tail."""
    fin = geometry["fin"]
    airfoil = asb.Airfoil(fin["airfoil"]).to_kulfan_airfoil()
    sections = [
        asb.WingXSec(
            [fin["quarter_chord_x"] - 0.25 * fin[f"{e}_chord"], 0.0, fin[f"{e}_z"]], fin[f"{e}_chord"], 0.0, airfoil
        )
        for e in ("root", "tip")
    ]
    return asb.Wing("fin", sections, symmetric=False)


def airplane(geometry: Geometry, wings: list[asb.Wing], fuselages: list[asb.Fuselage]) -> asb.Airplane:
    """Join shapes under the reference area, span, chord and point."""
    ref = geometry["reference"]
    return asb.Airplane("fw8", ref["point"], wings, fuselages, s_ref=ref["area"], c_ref=ref["chord"], b_ref=ref["span"])


def fuselage_shape(geometry: Geometry) -> asb.Fuselage:
    """Give the body of revolution."""
    body = geometry["fuselage"]
    sections = [asb.FuselageXSec([x, 0.0, 0.0], radius=d / 2) for x, d in zip(body["x"], body["diameter"], strict=True)]
    return asb.Fuselage("fuselage", sections)


# -- aerodynamics --------------------------------------------------------------------------------------------------


def downwash(geometry: Geometry, wing: asb.Wing, lift_over_dynamic_pressure: np.ndarray) -> np.ndarray:
    """Mean downwash angle (deg) over the tail's span, of the horseshoe vortex that carries L/q (m²) of the wing."""
    tail, half = geometry["tail"], math.pi / 8 * wing.span()
    x = tail["quarter_chord_x"] - wing.aerodynamic_center()[0]
    y = np.linspace(tail["root_y"], tail["tip_y"], 21)
    field = np.zeros_like(y)  # of unit circulation, times 4 π
    for arm in (half - y, half + y):  # from the two trailing vortices inwards
        trailing = arm / (arm**2 + VORTEX_CORE**2) * (1 + x / np.hypot(arm, x))
        bound = arm / (x * np.hypot(arm, x))
        field += trailing + bound
    circulation_over_speed = lift_over_dynamic_pressure / (4 * half)  # Γ/V = L / (ρ V² b'), b' = 2 half
    return np.asarray(np.degrees(circulation_over_speed * field.mean() / (4 * math.pi)))


class Model:
    """Coefficients of the whole aircraft from AeroSandbox at one wing position, about the reference point."""

    def __init__(self, geometry: Geometry, w: float) -> None:
        self.geometry = geometry
        ref = geometry["reference"]
        self.airspeed, self.chord, self.span = ref["airspeed"], ref["chord"], ref["span"]
        self.atmosphere = asb.Atmosphere(ref["altitude"])
        self.wing = wing_shape(geometry, w)
        self.front = airplane(geometry, [self.wing, fin_shape(geometry)], [fuselage_shape(geometry)])

    def point(self, alpha: np.ndarray, beta: float = 0.0, rates: Vector = (0.0, 0.0, 0.0)) -> asb.OperatingPoint:
        """Angles in degrees, rates as p b/2V, q c/2V, r b/2V."""
        ones = np.ones_like(alpha)
        lengths = (self.span, self.chord, self.span)
        turning = [2 * self.airspeed / length * rate * ones for length, rate in zip(lengths, rates, strict=True)]
        return asb.OperatingPoint(self.atmosphere, self.airspeed, alpha, beta * ones, *turning)

    def ahead_of_tail(self, here: asb.OperatingPoint) -> tuple[Any, np.ndarray]:
        """Wing, fuselage and fin, and the wing's downwash at the tail (deg)."""
        result = asb.AeroBuildup(self.front, here).run()
        lift = result["wing_aero_components"][0].L
        return result, downwash(self.geometry, self.wing, lift / here.dynamic_pressure())

    def coefficients(
        self,
        alpha: np.ndarray,
        beta: float = 0.0,
        rates: Vector = (0.0, 0.0, 0.0),
        tail: tuple[float, float] = (0.0, 0.0),
    ) -> np.ndarray:
        """CL, CD, CY (wind axes), Cl, Cm, Cn (body axes), 6 × len(alpha); tail: symmetric, differential (deg)."""
        here = self.point(alpha, beta, rates)
        front, epsilon = self.ahead_of_tail(here)
        shape = airplane(self.geometry, [tail_shape(self.geometry, *tail)], [])
        behind = asb.AeroBuildup(shape, self.point(alpha - epsilon, beta, rates)).run()
        eta = self.geometry["tail"]["efficiency"]
        force = [a + eta * b for a, b in zip(front["F_g"], behind["F_g"], strict=True)]
        moment = [a + eta * b for a, b in zip(front["M_g"], behind["M_g"], strict=True)]
        x, y, z = here.convert_axes(*force, from_axes="geometry", to_axes="wind")
        roll, pitch, yaw = here.convert_axes(*moment, from_axes="geometry", to_axes="body")
        area = self.geometry["reference"]["area"]
        drag = -x + here.dynamic_pressure() * self.geometry["fuselage"]["drag_area_extra"]
        forces = np.array([-z, drag, y, roll / self.span, pitch / self.chord, yaw / self.span])
        return np.asarray(forces / (here.dynamic_pressure() * area))

    def odd(self, alpha: np.ndarray, **step: Any) -> np.ndarray:
        """Half of f(+step) - f(-step), 6 × len(alpha)."""
        return np.asarray(self.coefficients(alpha, **step) - self.coefficients(alpha, **_negated(step))) / 2

    def even(self, alpha: np.ndarray, **step: Any) -> np.ndarray:
        """Half of f(+step) + f(-step) less f(0), 6 × len(alpha)."""
        both = self.coefficients(alpha, **step) + self.coefficients(alpha, **_negated(step))
        return np.asarray(both / 2 - self.coefficients(alpha))

    def downwash_slope(self, alpha: np.ndarray) -> np.ndarray:
        """Change of the downwash with angle of attack, dε/dα."""
        steps = [self.ahead_of_tail(self.point(alpha + step))[1] for step in (1.0, -1.0)]
        return np.asarray(steps[0] - steps[1]) / 2


def _negated(step: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(-v for v in value) if isinstance(value, tuple) else -value for key, value in step.items()}


def tables(geometry: Geometry) -> dict[str, np.ndarray]:
    """All coefficients and derivatives (per rad), len(ALPHAS) × len(WING_POSITIONS).

    The drag's curvatures over sideslip and tail deflection (CDbb, CDee, CDaa, per rad², and CDbbbb to reach the drag
    of the side at 90°) and the derivatives over α' c/2V (CLad, Cmad: the tail meets the downwash that left the wing
    l/V ago) hold at the linear angle of attack: 1 × len(WING_POSITIONS).
    """
    alpha = np.array(ALPHAS, dtype=float)
    linear = np.array([geometry["reference"]["linear_alpha_deg"]])
    beta, deflection = math.radians(BETA_STEP), math.radians(TAIL_STEP)
    columns: dict[str, list[np.ndarray]] = {}

    def keep(names: str, values: np.ndarray) -> None:
        for name, row in zip(names.split(), values, strict=True):
            columns.setdefault(name, []).append(row)

    for w in WING_POSITIONS:
        model = Model(geometry, w)
        keep("CL CD CY0 Cl0 Cm Cn0", model.coefficients(alpha))
        keep("CYb Clb Cnb", model.odd(alpha, beta=BETA_STEP)[[2, 3, 5]] / beta)
        keep("CYp Clp Cnp", model.odd(alpha, rates=(RATE_STEP, 0.0, 0.0))[[2, 3, 5]] / RATE_STEP)
        keep("CLq Cmq", model.odd(alpha, rates=(0.0, RATE_STEP, 0.0))[[0, 4]] / RATE_STEP)
        keep("CYr Clr Cnr", model.odd(alpha, rates=(0.0, 0.0, RATE_STEP))[[2, 3, 5]] / RATE_STEP)
        keep("CLde CDde Cmde", model.odd(alpha, tail=(TAIL_STEP, 0.0))[[0, 1, 4]] / deflection)
        keep("CYda Clda Cnda", model.odd(alpha, tail=(0.0, TAIL_STEP))[[2, 3, 5]] / deflection)

        curvature = model.even(linear, beta=BETA_STEP)[1] / beta**2
        keep("CDbb CDbbbb", np.array([curvature, model.coefficients(linear, beta=89.9)[1] - curvature]))
        keep("CDee", model.even(linear, tail=(TAIL_STEP, 0.0))[[1]] / deflection**2)
        keep("CDaa", model.even(linear, tail=(0.0, TAIL_STEP))[[1]] / deflection**2)
        arm = geometry["tail"]["quarter_chord_x"] - model.wing.aerodynamic_center()[0]
        lag = 2 * arm / model.chord * model.downwash_slope(linear)
        keep("CLad Cmad", lag * model.odd(linear, tail=(TAIL_STEP, 0.0))[[0, 4]] / deflection)
    result = {name: np.array(rows).T for name, rows in columns.items()}
    for zero in ("CY0", "Cl0", "Cn0"):
        if np.abs(result.pop(zero)).max() > 1e-6:
            raise ValueError(f"a symmetric shape has {zero} without sideslip")
    return result


# -- XML -----------------------------------------------------------------------------------------------------------


def table_xml(name: str, values: np.ndarray) -> str:
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


def _function_xml(name: str, factors: tuple[str, ...], t: dict[str, np.ndarray], terms: list[tuple[str, ...]]) -> str:
    """Write the product of the factors and the sum of table × property × … for each term."""
    lines = []
    for table, *properties in terms:
        own = "".join(f"<property>{p}</property>" for p in properties)
        term = f"{own}{table_xml(table, t[table])}"
        lines.append(f"          <product>{term}          </product>\n" if properties else f"          {term}")
    common = "".join(f"<property>{p}</property>" for p in factors)
    return (
        f'      <function name="aero/{name}">\n        <product>{common}<sum>\n{"".join(lines)}'
        "        </sum></product>\n      </function>\n"
    )


def aerodynamics_xml(t: dict[str, np.ndarray]) -> str:
    """Write the six axes: forces in wind axes, moments in body axes about the reference point.

    The tables hold for sideslip as small as flight has it. So that the rail in a side wind, where the angle of attack
    means nothing, is no worse than approximate, they act with q̄ S cos β and the slip is sin β; what is left at 90° is
    the drag of the side, CDbb sin² β + CDbbbb sin⁴ β.
    """
    p, q, r = (f"velocities/{axis}-aero-rad_sec" for axis in "pqr")
    by_span, by_chord, alpha_rate = "aero/bi2vel", "aero/ci2vel", "aero/alphadot-rad_sec"
    slip, elevator, aileron = "aero/slip", "fcs/tail-symmetric-rad", "fcs/tail-differential-rad"
    along, span, chord = "aero/qbar-area-along", "metrics/bw-ft", "metrics/cbarw-ft"

    def lateral(c: str) -> list[tuple[str, ...]]:
        return [(f"{c}b", slip), (f"{c}p", by_span, p), (f"{c}r", by_span, r), (f"{c}da", aileron)]

    def longitudinal(c: str) -> list[tuple[str, ...]]:
        return [(c,), (f"{c}q", by_chord, q), (f"{c}ad", by_chord, alpha_rate), (f"{c}de", elevator)]

    drag: list[tuple[str, ...]] = [("CD",), ("CDde", elevator), ("CDee", elevator, elevator)]
    drag.append(("CDaa", aileron, aileron))
    side_drag: list[tuple[str, ...]] = [("CDbb", slip, slip), ("CDbbbb", slip, slip, slip, slip)]
    axes = {
        "LIFT": _function_xml("lift", (along,), t, longitudinal("CL")),
        "DRAG": _function_xml("drag", (along,), t, drag)
        + _function_xml("side-drag", ("aero/qbar-area",), t, side_drag),
        "SIDE": _function_xml("side", (along,), t, lateral("CY")),
        "ROLL": _function_xml("roll", (along, span), t, lateral("Cl")),
        "PITCH": _function_xml("pitch", (along, chord), t, longitudinal("Cm")),
        "YAW": _function_xml("yaw", (along, span), t, lateral("Cn")),
    }
    # functions before the axes see JSBSim's own q̄ S of the step before (at first: not yet written); q̄ is fresh
    beta = "<property>aero/beta-rad</property>"
    pressure = "<property>aero/qbar-psf</property><property>metrics/Sw-sqft</property>"
    return (
        f'  <aerodynamics>\n    <function name="{slip}"><sin>{beta}</sin></function>\n'
        f'    <function name="{along}"><product>{pressure}<cos>{beta}</cos></product></function>\n'
        + "".join(f'    <axis name="{axis}">\n{functions}    </axis>\n' for axis, functions in axes.items())
        + "  </aerodynamics>\n"
    )


def _xyz(position: list[float] | Vector) -> str:
    return "".join(f"<{axis}>{value:.6g}</{axis}>" for axis, value in zip("xyz", position, strict=True))


def location_xml(name: str, position: list[float] | Vector) -> str:
    """Write a named place in the structural frame."""
    return f'    <location name="{name}" unit="M">{_xyz(position)}</location>\n'


def metrics_xml(geometry: Geometry) -> str:
    """Write reference quantities; the eyepoint is the place of the inertial sensor."""
    ref = geometry["reference"]
    return (
        "  <metrics>\n"
        f'    <wingarea unit="M2">{ref["area"]}</wingarea>\n    <wingspan unit="M">{ref["span"]}</wingspan>\n'
        f'    <chord unit="M">{ref["chord"]}</chord>\n'
        + location_xml("AERORP", ref["point"])
        + location_xml("EYEPOINT", geometry["imu"]["position"])
        + location_xml("VRP", (0.0, 0.0, 0.0))
        + "  </metrics>\n"
    )


def mass_xml(geometry: Geometry) -> str:
    """Write what stays as the empty aircraft and the panels as point masses 0, 1 right and 2, 3 left, folded."""
    body = fixed_body(geometry)
    lines = [
        f'    <{n} unit="KG*M2">{v:.8f}</{n}>' for n, v in (("ixx", body.ixx), ("iyy", body.iyy), ("izz", body.izz))
    ]
    # x and z both change sign from structural to body axes, so Σ m x z stays; "negated" wants it as in the tensor
    lines.append(f'    <ixz unit="KG*M2">{-body.ixz:.8f}</ixz>')
    lines.append(f'    <emptywt unit="KG">{body.mass:.6f}</emptywt>')
    lines.append(location_xml("CG", body.centre).rstrip())
    for side, sign in (("right", 1), ("left", -1)):
        for end, (m, out, forward) in zip(("inner", "outer"), panel_masses(geometry), strict=True):
            x, y = place(geometry, 0.0, out, forward)
            lines.append(
                f'    <pointmass name="{side}-{end}"><weight unit="KG">{m:.6f}</weight>'
                f'<location unit="M">{_xyz((x, sign * y, 0.0))}</location></pointmass>'
            )
    return '  <mass_balance negated_crossproduct_inertia="true">\n' + "\n".join(lines) + "\n  </mass_balance>\n"


def propulsion_xml(geometry: Geometry) -> str:
    """Write motor and propeller at their place; no tanks."""
    place_of = f'<location unit="M">{_xyz(geometry["motor"]["position"])}</location>'
    name, sense = geometry["name"], geometry["propeller"]["sense"]
    return (
        f'  <propulsion>\n    <engine file="{name}_motor">\n'
        f'      <thruster file="{name}_propeller">{place_of}<sense>{sense}</sense></thruster>\n'
        "    </engine>\n  </propulsion>\n"
    )


def reactions_xml(geometry: Geometry) -> str:
    """Write what the launcher and the opening wing do to the aircraft.

    Positive: push forwards, shoes lift the aircraft or push it right, the rail's moment rolls it right. The wing's
    moment has magnitude 1 and the components l, m, n, which systems/wing.xml sets.
    """
    rail = geometry["rail"]
    forces = [("push", "push", (1, 0, 0))]
    for shoe in ("front", "rear"):
        forces += [
            (f"{shoe}-shoe-normal", f"{shoe}_shoe", (0, 0, -1)),
            (f"{shoe}-shoe-lateral", f"{shoe}_shoe", (0, 1, 0)),
        ]
    lines = [
        f'    <force name="{name}" frame="BODY"><location unit="M">{_xyz(rail[at])}</location>'
        f"<direction>{_xyz(direction)}</direction></force>"
        for name, at, direction in forces
    ]
    lines += [
        f'    <moment name="rail-roll" frame="BODY"><direction>{_xyz((1, 0, 0))}</direction></moment>',
        '    <moment name="wing-inertia" frame="BODY"><function><value>1</value></function>'
        f"<direction>{_xyz((0, 0, 0))}</direction></moment>",
    ]
    return "  <external_reactions>\n" + "\n".join(lines) + "\n  </external_reactions>\n"


def constants_xml(geometry: Geometry) -> str:
    """Hand the systems the numbers they need, in JSBSim's units (inches, pounds) or SI as named."""
    wing, tail, gains = geometry["wing"], geometry["tail"], geometry["stabiliser"]
    inches = 1 / 0.0254
    (m, inner, forward), (_, outer, _) = panel_masses(geometry)
    values = {
        "wing/opening-rate-per_sec": 1 / wing["opening_time"],
        "wing/sweep-folded-rad": math.radians(wing["sweep_folded_deg"]),
        "wing/sweep-travel-rad": math.radians(wing["sweep_out_deg"] - wing["sweep_folded_deg"]),
        "wing/pivot-x-in": wing["pivot"][0] * inches,
        "wing/pivot-y-in": wing["pivot"][1] * inches,
        "wing/inner-mass-out-in": inner * inches,
        "wing/outer-mass-out-in": outer * inches,
        "wing/masses-forward-in": forward * inches,
        "wing/point-mass-slug": m * KG_TO_LB / 32.174049,
        "tail/deflection-max-rad": math.radians(tail["deflection_max_deg"]),
        "tail/deflection-rate-max-rad_sec": math.radians(tail["deflection_rate_max_deg"]),
        "ap/gain/reference-qbar-psf": 0.5 * SEA_LEVEL_DENSITY * gains["reference_airspeed"] ** 2 * PA_TO_PSF,
        "ap/gain/least-qbar-psf": 0.5 * SEA_LEVEL_DENSITY * gains["least_airspeed"] ** 2 * PA_TO_PSF,
        "ap/gain/pitch": gains["pitch"],
        "ap/gain/pitch-integral-per_sec": gains["pitch_integral"],
        "ap/gain/pitch-rate-sec": gains["pitch_rate"],
        "ap/gain/roll-folded": gains["roll_folded"],
        "ap/gain/roll-gain-on-opening": gains["roll_out"] - gains["roll_folded"],
        "ap/gain/roll-integral-per_sec": gains["roll_integral"],
        "ap/gain/roll-rate-sec": gains["roll_rate"],
    }
    return "".join(f'    <property value="{v:.9g}">{n}</property>\n' for n, v in values.items())


def trim_deflections(geometry: Geometry, t: dict[str, np.ndarray]) -> list[float]:
    """Symmetric tail deflection (rad) that balances the moments about the centre of gravity, for each wing position."""
    ref, alpha = geometry["reference"], geometry["stabiliser"]["trim_alpha_deg"]
    result = []
    for k, w in enumerate(WING_POSITIONS):
        lift, lift_de, moment, moment_de = (np.interp(alpha, ALPHAS, t[n][:, k]) for n in ("CL", "CLde", "Cm", "Cmde"))
        arm = (centre_of_gravity(geometry, w)[1] - ref["point"][0]) / ref["chord"]
        result.append(-float((moment + arm * lift) / (moment_de + arm * lift_de)))
    return result


def trim_xml(geometry: Geometry, t: dict[str, np.ndarray]) -> str:
    """Write the stabiliser's feed-forward over the wing position."""
    rows = "".join(
        f"          {w:6.3f} {d:9.5f}\n" for w, d in zip(WING_POSITIONS, trim_deflections(geometry, t), strict=True)
    )
    return (
        '    <channel name="trim"><fcs_function name="ap/tail-trim-rad"><function><table>\n'
        '        <independentVar lookup="row">fcs/wing-pos-norm</independentVar>\n'
        f"        <tableData>\n{rows}        </tableData></table></function></fcs_function></channel>\n"
    )


def motor_xml(geometry: Geometry) -> str:
    """Write the three constants of the brushless motor."""
    motor = geometry["motor"]
    return (
        f'<brushless_dc_motor name="{geometry["name"]} motor">\n'
        f"  <maxvolts>{motor['max_voltage']}</maxvolts>\n"
        f"  <velocityconstant>{motor['velocity_constant']}</velocityconstant>\n"
        f"  <coilresistance>{motor['coil_resistance']}</coilresistance>\n"
        f"  <noloadcurrent>{motor['no_load_current']}</noloadcurrent>\n"
        "</brushless_dc_motor>\n"
    )


def propeller_xml(geometry: Geometry) -> str:
    """Write the fixed-pitch propeller with its tables over the advance ratio."""
    prop = geometry["propeller"]

    def table(name: str, key: str) -> str:
        rows = "".join(f"    {j:6.3f} {c:9.5f}\n" for j, c in zip(prop["advance_ratio"], prop[key], strict=True))
        return f'  <table name="{name}" type="internal"><tableData>\n{rows}  </tableData></table>\n'

    return (
        f'<propeller name="{geometry["name"]} propeller">\n  <ixx unit="KG*M2">{prop["inertia"]}</ixx>\n'
        f'  <diameter unit="M">{prop["diameter"]}</diameter>\n  <numblades>{prop["blades"]}</numblades>\n'
        "  <minpitch>0</minpitch>\n  <maxpitch>0</maxpitch>\n"
        + table("C_THRUST", "thrust_coefficient")
        + table("C_POWER", "power_coefficient")
        + "</propeller>\n"
    )


def aircraft_xml(geometry: Geometry, header: str) -> str:
    """Write the whole model; the hand-written systems come by name."""
    coefficients = tables(geometry)
    return (
        f'<?xml version="1.0"?>\n{header}<fdm_config name="{geometry["name"]}" version="2.0" release="BETA">\n'
        "  <fileheader>\n    <author>uavsim</author>\n"
        "    <description>Electric folding-wing aircraft</description>\n  </fileheader>\n"
        + metrics_xml(geometry)
        + mass_xml(geometry)
        + "  <ground_reactions></ground_reactions>\n"
        + reactions_xml(geometry)
        + propulsion_xml(geometry)
        + f'  <system name="constants">\n{constants_xml(geometry)}{trim_xml(geometry, coefficients)}  </system>\n'
        + '  <system file="wing"/>\n  <system file="stabiliser"/>\n'
        + aerodynamics_xml(coefficients)
        + "</fdm_config>\n"
    )


def read_geometry(path: Path) -> Geometry:
    """Read geometry.toml."""
    with path.open("rb") as file:
        return tomllib.load(file)


def build(directory: Path) -> list[Path]:
    """Write the aircraft's generated files and return their paths."""
    source = directory / "geometry.toml"
    geometry = read_geometry(source)
    digest = hashlib.sha256(source.read_bytes()).hexdigest()
    header = (
        "<!-- Generated by scripts/build_aircraft.py from geometry.toml: do not edit.\n"
        f"     aerosandbox {asb.__version__}\n     geometry.toml sha256 {digest} -->\n"
    )
    name = geometry["name"]
    contents = {
        directory / "engine" / f"{name}_motor.xml": f'<?xml version="1.0"?>\n{header}{motor_xml(geometry)}',
        directory / "engine" / f"{name}_propeller.xml": f'<?xml version="1.0"?>\n{header}{propeller_xml(geometry)}',
        directory / f"{name}.xml": aircraft_xml(geometry, header),
    }
    for path, text in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    return list(contents)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: build_aircraft.py AIRCRAFT_DIR")
    for written in build(Path(sys.argv[1])):
        print(written)
