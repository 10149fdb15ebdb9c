"""Build an aircraft's JSBSim files from its geometry: python scripts/build_aircraft.py aircraft/fw8.

Aerodynamics: AeroSandbox's AeroBuildup (strips with NeuralFoil sections, slender fuselage) over wing position w and
angle of attack α, for wing, fuselage and fin together and for the tail alone in the wing's downwash

    ε(α, w) = L_wing / (ρ V² b') · 1/(4π) · ∫ g(y) dy over the tail's span,

the field of one horseshoe vortex of span b' = (π/4) b(w) whose circulation carries the wing's lift
(Katz & Plotkin, Low-Speed Aerodynamics, §5.3). The derivatives are central differences of the same model.

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

import aerosandbox as asb
import numpy as np

Geometry = dict[str, Any]
Vector = tuple[float, float, float]

WING_POSITIONS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0)
# deg; JSBSim holds the last row beyond ±90, where the moment still turns the nose back into the wind
ALPHAS = (
    -90,
    -60,
    -40,
    -30,
    -25,
    -20,
    -16,
    -14,
    -12,
    -10,
    -8,
    -6,
    -4,
    -2,
    0,
    2,
    4,
    6,
    8,
    10,
    11,
    12,
    13,
    14,
    15,
    16,
    18,
    20,
)
ALPHAS += (25, 30, 40, 60, 90)
BETA_STEP = 4.0  # deg, half width of the differences over sideslip
RATE_STEP = 0.02  # of p b/2V, q c/2V and r b/2V
TAIL_STEP = 4.0  # deg of tail deflection

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


def downwash(geometry: Geometry, w: float, circulation: np.ndarray, airspeed: float) -> np.ndarray:
    """Mean downwash angle (rad) over the tail's span of a horseshoe vortex of the given circulation (m²/s)."""
    half = math.pi / 8 * wing_shape(geometry, w).span()
    tail = geometry["tail"]
    bound_x = wing_shape(geometry, w).aerodynamic_center()[0]
    x = tail["quarter_chord_x"] - bound_x
    y = np.linspace(tail["root_y"], tail["tip_y"], 21)
    field = np.zeros_like(y)
    for arm in (half - y, half + y):  # distance inwards of the two trailing vortices
        reach = np.hypot(arm, x)
        trailing = arm / (arm**2 + VORTEX_CORE**2) * (1 + x / reach)
        bound = arm / (x * reach)
        field += trailing + bound
    return circulation * field.mean() / (4 * math.pi) / airspeed


class Model:
    """Coefficients of the whole aircraft from AeroSandbox, about the reference point."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry = geometry
        ref = geometry["reference"]
        self.airspeed, self.chord, self.span = ref["airspeed"], ref["chord"], ref["span"]
        self.atmosphere = asb.Atmosphere(ref["altitude"])
        self.fuselage = fuselage_shape(geometry)
        self.fin = fin_shape(geometry)

    def coefficients(
        self,
        w: float,
        alpha: np.ndarray,
        beta: float = 0.0,
        rates: Vector = (0.0, 0.0, 0.0),
        tail: tuple[float, float] = (0.0, 0.0),
    ) -> np.ndarray:
        """CL, CD, CY (wind axes), Cl, Cm, Cn (body axes), 6 × len(alpha).

        Alpha, beta and tail deflections (symmetric, differential) in degrees; rates as p b/2V, q c/2V, r b/2V.
        """
        geometry, speed = self.geometry, self.airspeed
        p, q, r = 2 * speed / self.span * rates[0], 2 * speed / self.chord * rates[1], 2 * speed / self.span * rates[2]

        def point(a: np.ndarray) -> asb.OperatingPoint:
            ones = np.ones_like(a)
            return asb.OperatingPoint(self.atmosphere, speed, a, beta * ones, p * ones, q * ones, r * ones)

        here = point(alpha)
        front = asb.AeroBuildup(airplane(geometry, [wing_shape(geometry, w), self.fin], [self.fuselage]), here).run()
        lift = front["wing_aero_components"][0].L
        wing_span = math.pi / 4 * wing_shape(geometry, w).span()
        epsilon = np.degrees(downwash(geometry, w, lift / (self.atmosphere.density() * speed * wing_span), speed))
        behind = asb.AeroBuildup(airplane(geometry, [tail_shape(geometry, *tail)], []), point(alpha - epsilon)).run()
        eta = geometry["tail"]["efficiency"]
        force = [a + eta * b for a, b in zip(front["F_g"], behind["F_g"], strict=True)]
        moment = [a + eta * b for a, b in zip(front["M_g"], behind["M_g"], strict=True)]
        x, y, z = here.convert_axes(*force, from_axes="geometry", to_axes="wind")
        roll, pitch, yaw = here.convert_axes(*moment, from_axes="geometry", to_axes="body")
        area = geometry["reference"]["area"]
        pressure = here.dynamic_pressure() * area
        extra = geometry["fuselage"]["drag_area_extra"] / area
        return np.array([
            -z / pressure, -x / pressure + extra, y / pressure,
            roll / pressure / self.span, pitch / pressure / self.chord, yaw / pressure / self.span,
        ])  # fmt: skip

    def difference(self, w: float, alpha: np.ndarray, **half_step: Any) -> np.ndarray:
        """Half of f(+step) - f(-step), 6 × len(alpha)."""
        plus = self.coefficients(w, alpha, **half_step)
        minus = self.coefficients(w, alpha, **{k: _negated(v) for k, v in half_step.items()})
        return (plus - minus) / 2


def _negated(value: float | tuple[float, ...]) -> float | tuple[float, ...]:
    return tuple(-v for v in value) if isinstance(value, tuple) else -value


def tables(geometry: Geometry) -> dict[str, np.ndarray]:
    """All coefficients and derivatives (per rad), each len(ALPHAS) × len(WING_POSITIONS)."""
    model, alpha = Model(geometry), np.array(ALPHAS, dtype=float)
    columns: dict[str, list[np.ndarray]] = {}

    def keep(names: str, values: np.ndarray) -> None:
        for name, row in zip(names.split(), values, strict=True):
            columns.setdefault(name, []).append(row)

    for w in WING_POSITIONS:
        keep("CL CD CY0 Cl0 Cm Cn0", model.coefficients(w, alpha))
        sideslip = model.difference(w, alpha, beta=BETA_STEP) / math.radians(BETA_STEP)
        keep("CYb Clb Cnb", sideslip[[2, 3, 5]])
        roll = model.difference(w, alpha, rates=(RATE_STEP, 0.0, 0.0)) / RATE_STEP
        keep("CYp Clp Cnp", roll[[2, 3, 5]])
        pitch = model.difference(w, alpha, rates=(0.0, RATE_STEP, 0.0)) / RATE_STEP
        keep("CLq Cmq", pitch[[0, 4]])
        yaw = model.difference(w, alpha, rates=(0.0, 0.0, RATE_STEP)) / RATE_STEP
        keep("CYr Clr Cnr", yaw[[2, 3, 5]])
        elevator = model.difference(w, alpha, tail=(TAIL_STEP, 0.0)) / math.radians(TAIL_STEP)
        keep("CLde CDde Cmde", elevator[[0, 1, 4]])
        aileron = model.difference(w, alpha, tail=(0.0, TAIL_STEP)) / math.radians(TAIL_STEP)
        keep("CYda Clda Cnda", aileron[[2, 3, 5]])
    result = {name: np.array(rows).T for name, rows in columns.items()}
    for zero in ("CY0", "Cl0", "Cn0"):  # the shape is symmetric: without sideslip there is nothing
        assert np.abs(result.pop(zero)).max() < 1e-6, zero
    return result


# -- XML -----------------------------------------------------------------------------------------------------------


def table_xml(name: str, values: np.ndarray) -> str:
    """Write a table over angle of attack (rows) and wing position (columns)."""
    head = " " * 16 + "".join(f"{w:>11.3f}" for w in WING_POSITIONS)
    rows = [f"            {a:>4d}" + "".join(f"{v:>11.5f}" for v in row) for a, row in zip(ALPHAS, values, strict=True)]
    return f"""<table name="aero/{name}">
          <independentVar lookup="row">aero/alpha-deg</independentVar>
          <independentVar lookup="column">fcs/wing-pos-norm</independentVar>
          <tableData>
{head}
{chr(10).join(rows)}
          </tableData>
        </table>"""


def _times(name: str, values: np.ndarray, *properties: str) -> str:
    factors = "".join(f"<property>{p}</property>" for p in properties)
    return f"        <product>{factors}\n        {table_xml(name, values)}</product>\n"


def aerodynamics_xml(t: dict[str, np.ndarray]) -> str:
    """Write the six axes: forces in wind axes, moments in body axes about the reference point."""
    p, q, r = (f"velocities/{axis}-aero-rad_sec" for axis in "pqr")
    by_span, by_chord = "aero/bi2vel", "aero/ci2vel"
    beta, elevator, aileron = "aero/beta-rad", "fcs/tail-symmetric-rad", "fcs/tail-differential-rad"

    def lateral(axis: str) -> str:
        return (
            _times(f"C{axis}b", t[f"C{axis}b"], beta)
            + _times(f"C{axis}p", t[f"C{axis}p"], by_span, p)
            + _times(f"C{axis}r", t[f"C{axis}r"], by_span, r)
            + _times(f"C{axis}da", t[f"C{axis}da"], aileron)
        )

    terms = {
        ("LIFT", "lift", ""): table_xml("CL", t["CL"]) + _times("CLq", t["CLq"], by_chord, q) + _times("CLde", t["CLde"], elevator),
        ("DRAG", "drag", ""): table_xml("CD", t["CD"]) + _times("CDde", t["CDde"], elevator),
        ("SIDE", "side", ""): lateral("Y"),
        ("ROLL", "roll", "metrics/bw-ft"): lateral("l"),
        ("PITCH", "pitch", "metrics/cbarw-ft"): table_xml("Cm", t["Cm"]) + _times("Cmq", t["Cmq"], by_chord, q) + _times("Cmde", t["Cmde"], elevator),
        ("YAW", "yaw", "metrics/bw-ft"): lateral("n"),
    }  # fmt: skip
    axes = [
        f"""    <axis name="{axis}">
      <function name="aero/{name}">
        <product><property>aero/qbar-area</property>{f"<property>{arm}</property>" if arm else ""}<sum>
        {body}</sum></product>
      </function>
    </axis>"""
        for (axis, name, arm), body in terms.items()
    ]
    return "  <aerodynamics>\n" + "\n".join(axes) + "\n  </aerodynamics>\n"


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
    # JSBSim's body x and z are minus the structural ones: the product keeps its sign
    lines.append(f'    <ixz unit="KG*M2">{body.ixz:.8f}</ixz>')
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
    name = geometry["name"]
    return (
        f'  <propulsion>\n    <engine file="{name}_motor">{place_of}\n'
        f'      <thruster file="{name}_propeller">{place_of}<sense>{geometry["propeller"]["sense"]}</sense></thruster>\n'
        "    </engine>\n  </propulsion>\n"
    )


def reactions_xml(geometry: Geometry) -> str:
    """Write the launcher's forces (positive: push forwards, shoes lift the aircraft or push it right) and the wing's moment."""
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
    lines.append(
        '    <moment name="wing-inertia" frame="BODY"><function><value>1</value></function>'
        f"<direction>{_xyz((0, 0, 0))}</direction></moment>"
    )
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
        f"  <maxvolts>{motor['max_voltage']}</maxvolts>\n  <velocityconstant>{motor['velocity_constant']}</velocityconstant>\n"
        f"  <coilresistance>{motor['coil_resistance']}</coilresistance>\n  <noloadcurrent>{motor['no_load_current']}</noloadcurrent>\n"
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
        "  <fileheader>\n    <author>uavsim</author>\n    <description>Electric folding-wing aircraft</description>\n  </fileheader>\n"
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
    header = (
        "<!-- Generated by scripts/build_aircraft.py from geometry.toml: do not edit.\n"
        f"     aerosandbox {asb.__version__}\n     geometry.toml sha256 {hashlib.sha256(source.read_bytes()).hexdigest()} -->\n"
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
