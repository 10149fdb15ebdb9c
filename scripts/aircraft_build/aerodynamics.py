"""Aerodynamics part by part, each in the flow that it meets.

Wing, tail and fin are AeroSandbox's AeroBuildup (strips with NeuralFoil sections, all angles), each alone; the fuselage
is in `fuselage.py`. The tail is in the wing's downwash

    ε(α, w) = Γ/V · mean of g(y)/4π over the tail's span,   Γ/V = L_wing / (ρ V² b'),   b' = (π/4) b(w),

where g/4π is the downwash of a horseshoe vortex of unit circulation (Biot-Savart; the span b' of an elliptic wing's
rolled-up wake, e.g. Katz & Plotkin, Low-Speed Aerodynamics, 2nd ed., §4.9). Derivatives are central differences.

Boundary layers are tripped (`shape.Tripped`). With free transition that on the lower side of a NACA 4412 at a Reynolds
number of 3.4e5 runs from 37 % of the chord at -1° to the trailing edge at 1°: the lift slope goes from 0.10 to 0.13 per
degree and back, downwash and tail follow, and the whole aircraft's static margin halves where it cruises.
"""

import math
from typing import Any

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

from .fuselage import Fuselage
from .geometry import WING_POSITIONS, Geometry, Vector, sweep
from .mach import mach_tables
from .mass import centre_of_gravity
from .shape import airplane, fin_shape, tail_shape, wing_shape

ALPHAS: tuple[int, ...] = (
    *(-180, -150, -120, -90, -60, -40, -28, -20, -16, -14, -12, -8, -4, -2, 0, 2, 4, 6, 8, 9, 10, 11, 12, 13, 14),
    *(16, 18, 20, 22, 25, 28, 34, 40, 50, 60, 90, 120, 150, 180),
)  # deg
_SIDE = (0, 2, 4, 8, 12, 16, 18, 20, 22, 24, 28, 40, 60, 90, 120, 150, 180, 210)
LOCAL: tuple[int, ...] = (*(-a for a in reversed(_SIDE[1:])), *_SIDE)  # deg, of the flow at the tail's halves and fin
_HALF = (5, 10, 20, 35, 50, 70, 90, 110, 130, 150, 165, 180)
SIDESLIPS: tuple[int, ...] = (*(-a for a in reversed(_HALF)), 0, *_HALF)  # deg, at the fuselage
HEIGHTS = (0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.5, 5.0)  # spans
SECTION_SLOPE = 2 * math.pi  # a₀, per rad, of a thin section
RATE_STEP = 0.05  # of p b/2V, q c/2V and r b/2V: 2.9° at the tip of a rolling wing, so that no stall is a spike
VORTEX_CORE = 0.05  # m, radius inside which the trailing vortices' field is cut off (about a third of the chord)
FULL_DOWNWASH, NO_DOWNWASH = 30.0, 90.0  # deg of |α|: the wake passes the tail, and is all ahead of it
FOOT = 0.3048  # m
NOTHING = 1e-6  # of a coefficient that symmetry makes zero

COEFFICIENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")  # forces in stability axes, moments in body axes

Tables = dict[str, np.ndarray]


def tables(geometry: Geometry) -> Tables:
    """All coefficients, by the reference area, span and chord; derivatives per rad; rows of keys by columns.

    Over `ALPHAS` × `WING_POSITIONS`, wing, fuselage and the fin's drag: CL, CD, Cm; the wing over p b/2V and r b/2V:
    Clp, Cnp, Clr, Cnr; the downwash at the tail, epsilon (rad).
    Over `WING_POSITIONS`: Cmq of the wing at the linear angle of attack; its Cl per CL β (sweep-roll); 2 l/c of the
    tail (tail-arm) and what the downwash lags (downwash-lag), over q c/2V and α' c/2V; -l of the fin, ft (fin-arm);
    b/b(w) (span-ratio).
    Of an aircraft for which it counts, over the Mach number: mach-wing, mach-tail, mach-fin, drag-rise (`mach`).
    Over `LOCAL`: forces of one half of the tail (tail-normal, tail-axial), the fin's side force (fin-side).
    Over `SIDESLIPS`: fuselage-side and fuselage-yaw. Over `HEIGHTS`: ground-lift, ground-drag, ground-downwash.
    """
    columns = [_of_wing(geometry, w) for w in WING_POSITIONS]
    over_alpha = {name: np.array([column[name] for column in columns]).T for name in columns[0]}
    single = [_of_position(geometry, w) for w in WING_POSITIONS]
    over_wing = {name: np.array([[values[name]] for values in single]) for name in single[0]}
    others = _of_local_flow(geometry) | _of_side(geometry) | ground(geometry, np.array(HEIGHTS))
    single_columns = {name: values[:, np.newaxis] for name, values in others.items()}
    return over_alpha | over_wing | single_columns | mach_tables(geometry)


class Model:
    """Coefficients of parts from AeroSandbox, about the reference point or another."""

    def __init__(self, geometry: Geometry, parts: list[asb.Wing], point: Vector | None = None) -> None:
        ref = geometry["reference"]
        self.airspeed, self.chord, self.span, self.area = ref["airspeed"], ref["chord"], ref["span"], ref["area"]
        self.atmosphere = asb.Atmosphere(ref["altitude"])
        self.shape = airplane(geometry, parts, point)

    def coefficients(
        self, alpha: np.ndarray, beta: np.ndarray | float = 0.0, rates: Vector = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """The six `COEFFICIENTS`, 6 × len(alpha). Angles in degrees, rates as p b/2V, q c/2V, r b/2V."""
        ones = np.ones_like(alpha)
        lengths = (self.span, self.chord, self.span)
        turning = [2 * self.airspeed / length * rate * ones for length, rate in zip(lengths, rates, strict=True)]
        point = asb.OperatingPoint(self.atmosphere, self.airspeed, alpha, beta * ones, *turning)
        result = asb.AeroBuildup(self.shape, point, model_size="large").run()
        x, y, z = (value * ones for value in result["F_b"])
        roll, pitch, yaw = (value * ones for value in result["M_b"])
        c, s = np.cos(np.radians(alpha)), np.sin(np.radians(alpha))
        forces = [x * s - z * c, -x * c - z * s, y, roll / self.span, pitch / self.chord, yaw / self.span]
        return np.array(forces) / (0.5 * self.atmosphere.density() * self.airspeed**2 * self.area)

    def odd(self, alpha: np.ndarray, **step: Any) -> np.ndarray:
        """Half of f(+step) - f(-step), 6 × len(alpha)."""
        return np.asarray(self.coefficients(alpha, **step) - self.coefficients(alpha, **_negated(step))) / 2


def _of_wing(geometry: Geometry, w: float) -> Tables:
    """Wing and fuselage at one wing position, over `ALPHAS`."""
    wing = wing_shape(geometry, w)
    model, alpha = Model(geometry, [wing]), np.array(ALPHAS, dtype=float)
    straight = model.coefficients(alpha)
    if np.abs(straight[[2, 3, 5]]).max() > NOTHING:
        raise ValueError("a symmetric shape has a side force, or rolls or yaws, without sideslip")
    fin = float(Model(geometry, [fin_shape(geometry)]).coefficients(np.zeros(1))[1, 0])
    return {
        **_named("", straight + Fuselage(geometry, fin).coefficients(alpha), ("CL", "CD", "Cm")),
        **_named("p", _rolling(wing) * model.odd(alpha, rates=(RATE_STEP, 0.0, 0.0)) / RATE_STEP, ("Cl", "Cn")),
        **_named("r", model.odd(alpha, rates=(0.0, 0.0, RATE_STEP)) / RATE_STEP, ("Cl", "Cn")),
        "epsilon": downwash(geometry, wing, straight[0]) * _wake_passes_tail(alpha),
    }


def _of_position(geometry: Geometry, w: float) -> dict[str, float]:
    """Single values of one wing position."""
    ref, wing, centre = geometry["reference"], wing_shape(geometry, w), centre_of_gravity(geometry, w)
    linear = np.array([ref["linear_alpha_deg"]])
    lifts = Model(geometry, [wing]).coefficients(linear + np.array([-0.5, 0.5]))[0]
    slope = float(downwash(geometry, wing, np.diff(lifts))[0] / math.radians(1.0))
    turning = Model(geometry, [wing], (centre, *ref["point"][1:])).odd(linear, rates=(0.0, RATE_STEP, 0.0))[:, 0]
    return {
        "Cmq": float(turning[4] - (centre - ref["point"][0]) / ref["chord"] * turning[0]) / RATE_STEP,
        "downwash-lag": 2 * tail_arm(geometry, wing) / ref["chord"] * slope,
        "tail-arm": 2 * (geometry["tail"]["quarter_chord_x"] - centre) / ref["chord"],
        "fin-arm": -(geometry["fin"]["quarter_chord_x"] - centre) / FOOT,
        "sweep-roll": _roll_of_sweep(geometry, w, wing),
        "span-ratio": float(ref["span"] / wing.span()),
    }


def ground(geometry: Geometry, spans: np.ndarray) -> Tables:
    """What the ground does to lift, induced drag (over CL²) and downwash, at heights of so many spans.

    The equations stand in `xml_aerodynamics.py`; the wing's own induced drag is taken as that of an elliptic one.
    """
    aspect = geometry["reference"]["span"] ** 2 / geometry["reference"]["area"]
    s, x = SECTION_SLOPE / (math.pi * aspect), (16 * spans) ** 2
    share = x / (1 + x)
    lift = (1 + s) / (1 + s * share)
    drag = (share * lift**2 - 1) / (math.pi * aspect)
    return {"ground-lift": lift, "ground-drag": drag, "ground-downwash": x / (16 + x)}


def _rolling(wing: asb.Wing) -> float:
    """Lift slope of a rolling wing over that of the straight one: (A + 2)/(A + 4), lifting line of elliptic wings."""
    aspect = float(wing.aspect_ratio())
    return (aspect + 2) / (aspect + 4)


def _roll_of_sweep(geometry: Geometry, w: float, wing: asb.Wing) -> float:
    """Rolling moment of a swept wing per CL β: each half's lift goes with cos²(Λ ∓ β).

    tan Λ is held beyond 45°: it grows without bound, while what folds becomes a slender body. Folded this is a quarter
    of CL β by the wing's own span, where slender-wing theory has a third for a delta.
    """
    swept = min(sweep(geometry, w), math.radians(45.0))
    return -_rolling(wing) * 2 * math.tan(swept) * float(wing.span()) / 4 / float(geometry["reference"]["span"])


def downwash(geometry: Geometry, wing: asb.Wing, lift: np.ndarray) -> np.ndarray:
    """Mean angle (rad) over the tail's span, of the horseshoe vortex that carries the wing's lift coefficient."""
    tail, half, x = geometry["tail"], math.pi / 8 * wing.span(), tail_arm(geometry, wing)
    y = np.linspace(tail["root_y"], tail["tip_y"], 21)
    field = np.zeros_like(y)  # of unit circulation, times 4 π
    for arm in (half - y, half + y):  # from the two trailing vortices inwards
        trailing = arm / (arm**2 + VORTEX_CORE**2) * (1 + x / np.hypot(arm, x))
        bound = arm / (x * np.hypot(arm, x))
        field += trailing + bound
    circulation_over_speed = lift * geometry["reference"]["area"] / (4 * half)  # Γ/V = L / (ρ V² b'), b' = 2 half
    return np.asarray(circulation_over_speed * field.mean() / (4 * math.pi))


def tail_arm(geometry: Geometry, wing: asb.Wing) -> float:
    """Distance of the tail's quarter chord behind the wing's aerodynamic centre, m."""
    return float(geometry["tail"]["quarter_chord_x"] - wing.aerodynamic_center()[0])


def _wake_passes_tail(alpha: np.ndarray) -> np.ndarray:
    """1 where the tail is in the wing's wake, 0 where it is not behind it, smooth between."""
    s = np.clip((NO_DOWNWASH - np.abs(alpha)) / (NO_DOWNWASH - FULL_DOWNWASH), 0, 1)
    return np.asarray(s * s * (3 - 2 * s))


def _of_local_flow(geometry: Geometry) -> Tables:
    """One half of the tail, along and across its chord, and the fin's side force, over `LOCAL`."""
    angle = np.array(LOCAL, dtype=float)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    half = geometry["tail"]["efficiency"] / 2 * Model(geometry, [tail_shape(geometry)]).coefficients(angle)
    alone = _at_fin_alone(geometry, angle)
    fin = Model(geometry, [fin_shape(geometry)]).coefficients(np.zeros_like(angle), beta=alone)[2]
    return {
        "tail-normal": half[0] * c + half[1] * s,
        "tail-axial": half[1] * c - half[0] * s,
        "fin-side": (fin - fin[::-1]) / 2,  # odd to the last digit
    }


def _at_fin_alone(geometry: Geometry, angle: np.ndarray) -> np.ndarray:
    """Sideslip (deg) at which the fin alone has the force that it has on its end plate at this one.

    Its slope is that of the larger aspect ratio (Helmbold), it stalls as much earlier, and 90° and 180° stay.
    """
    alone = float(fin_shape(geometry).aspect_ratio())
    slopes = [a / (2 + math.hypot(a, 2)) for a in (alone, alone * geometry["fin"]["end_plate"])]
    return angle + (slopes[1] / slopes[0] - 1) * np.degrees(np.sin(2 * np.radians(angle))) / 2


def _of_side(geometry: Geometry) -> Tables:
    """The fuselage's side over `SIDESLIPS`: normal force and pitching moment of a body of revolution, turned."""
    ref, angle = geometry["reference"], np.array(SIDESLIPS, dtype=float)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    body = Fuselage(geometry).coefficients(angle)
    return {
        "fuselage-side": -(body[0] * c + body[1] * s),
        "fuselage-yaw": -body[4] * ref["chord"] / ref["span"],
    }


def _named(suffix: str, values: np.ndarray, names: tuple[str, ...]) -> Tables:
    """Pick rows of 6 × n values by the names of their coefficients."""
    return {name + suffix: values[COEFFICIENTS.index(name)] for name in names}


def _negated(step: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(-v for v in value) if isinstance(value, tuple) else -value for key, value in step.items()}
