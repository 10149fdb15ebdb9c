"""Aerodynamics: AeroSandbox's AeroBuildup (strips with NeuralFoil sections, slender fuselage) over w and α.

Wing, fuselage and fin are solved together, the tail alone in the wing's downwash

    ε(α, w) = Γ/V · mean of g(y)/4π over the tail's span,   Γ/V = L_wing / (ρ V² b'),   b' = (π/4) b(w),

where g/4π is the downwash of a horseshoe vortex of unit circulation (Biot-Savart; the span b' of an elliptic wing's
rolled-up wake, e.g. Katz & Plotkin, Low-Speed Aerodynamics, 2nd ed., §4.9). Derivatives are central differences.
"""

import math
from typing import Any

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

from .geometry import WING_POSITIONS, Geometry, Vector
from .shape import airplane, fin_shape, fuselage_shape, tail_shape, wing_shape

ALPHAS: tuple[int, ...] = (
    *(-90, -60, -40, -30, -25, -20, -16, -14, -12, -10, -8, -6, -4, -2, 0, 2, 4, 6, 8, 10),
    *(11, 12, 13, 14, 15, 16, 18, 20, 25, 30, 40, 60, 90),
)  # deg; JSBSim holds the last row beyond ±90, where the moment still turns the nose back into the wind
BETA_STEP = 6.0  # deg, half width of the differences over sideslip
ABEAM = 89.9  # deg of sideslip at which the drag of the side is met
RATE_STEP = 0.02  # of p b/2V, q c/2V and r b/2V
TAIL_STEP = 8.0  # deg of tail deflection: a secant to where the tail begins to stall
VORTEX_CORE = 0.05  # m, radius inside which the trailing vortices' field is cut off (about a third of the chord)
NOTHING = 1e-6  # of a coefficient that symmetry makes zero

COEFFICIENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")  # forces in wind axes, moments in body axes
LATERAL, LONGITUDINAL = ("CY", "Cl", "Cn"), ("CL", "Cm")

Tables = dict[str, np.ndarray]


def tables(geometry: Geometry) -> Tables:
    """All coefficients and derivatives (per rad), len(ALPHAS) × len(WING_POSITIONS).

    The drag's curvatures over sideslip and tail deflection (CDbb, CDee, CDaa, per rad², and CDbbbb to reach the drag
    of the side at 90°) and the derivatives over α' c/2V (CLad, Cmad: the tail meets the downwash that left the wing
    l/V ago) hold at the linear angle of attack: 1 × len(WING_POSITIONS).
    """
    models = [Model(geometry, w) for w in WING_POSITIONS]
    columns = [_over_alpha(model) | _at_linear_alpha(model) for model in models]
    return {name: np.array([column[name] for column in columns]).T for name in columns[0]}


class Model:
    """Coefficients of the whole aircraft from AeroSandbox at one wing position, about the reference point."""

    def __init__(self, geometry: Geometry, w: float) -> None:
        self.geometry = geometry
        ref = geometry["reference"]
        self.airspeed, self.chord, self.span = ref["airspeed"], ref["chord"], ref["span"]
        self.atmosphere = asb.Atmosphere(ref["altitude"])
        self.wing = wing_shape(geometry, w)
        self.front = airplane(geometry, [self.wing, fin_shape(geometry)], [fuselage_shape(geometry)])

    @property
    def tail_arm(self) -> float:
        """Distance of the tail's quarter chord behind the wing's aerodynamic centre, m."""
        return float(self.geometry["tail"]["quarter_chord_x"] - self.wing.aerodynamic_center()[0])

    def coefficients(
        self,
        alpha: np.ndarray,
        beta: float = 0.0,
        rates: Vector = (0.0, 0.0, 0.0),
        tail: tuple[float, float] = (0.0, 0.0),
    ) -> np.ndarray:
        """The six `COEFFICIENTS`, 6 × len(alpha).

        Angles in degrees, rates as p b/2V, q c/2V, r b/2V; tail: symmetric, differential (deg).
        """
        here = self._point(alpha, beta, rates)
        front, epsilon = self._ahead_of_tail(here)
        shape = airplane(self.geometry, [tail_shape(self.geometry, *tail)], [])
        behind = asb.AeroBuildup(shape, self._point(alpha - epsilon, beta, rates)).run()
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
        steps = [self._ahead_of_tail(self._point(alpha + step))[1] for step in (1.0, -1.0)]
        return np.asarray(steps[0] - steps[1]) / 2

    def _point(self, alpha: np.ndarray, beta: float = 0.0, rates: Vector = (0.0, 0.0, 0.0)) -> asb.OperatingPoint:
        ones = np.ones_like(alpha)
        lengths = (self.span, self.chord, self.span)
        turning = [2 * self.airspeed / length * rate * ones for length, rate in zip(lengths, rates, strict=True)]
        return asb.OperatingPoint(self.atmosphere, self.airspeed, alpha, beta * ones, *turning)

    def _ahead_of_tail(self, here: asb.OperatingPoint) -> tuple[Any, np.ndarray]:
        """Wing, fuselage and fin, and the wing's downwash at the tail (deg)."""
        result = asb.AeroBuildup(self.front, here).run()
        lift = result["wing_aero_components"][0].L
        return result, self._downwash(lift / here.dynamic_pressure())

    def _downwash(self, lift_over_dynamic_pressure: np.ndarray) -> np.ndarray:
        """Mean angle (deg) over the tail's span, of the horseshoe vortex that carries L/q (m²) of the wing."""
        tail, half, x = self.geometry["tail"], math.pi / 8 * self.wing.span(), self.tail_arm
        y = np.linspace(tail["root_y"], tail["tip_y"], 21)
        field = np.zeros_like(y)  # of unit circulation, times 4 π
        for arm in (half - y, half + y):  # from the two trailing vortices inwards
            trailing = arm / (arm**2 + VORTEX_CORE**2) * (1 + x / np.hypot(arm, x))
            bound = arm / (x * np.hypot(arm, x))
            field += trailing + bound
        circulation_over_speed = lift_over_dynamic_pressure / (4 * half)  # Γ/V = L / (ρ V² b'), b' = 2 half
        return np.asarray(np.degrees(circulation_over_speed * field.mean() / (4 * math.pi)))


def _over_alpha(model: Model) -> Tables:
    """Coefficients without sideslip, and first derivatives, at each of `ALPHAS`."""
    alpha = np.array(ALPHAS, dtype=float)
    beta, deflection = math.radians(BETA_STEP), math.radians(TAIL_STEP)
    straight = model.coefficients(alpha)
    for name, values in _named("", straight, LATERAL).items():
        if np.abs(values).max() > NOTHING:
            raise ValueError(f"a symmetric shape has {name} without sideslip")
    return {
        **_named("", straight, ("CL", "CD", "Cm")),
        **_named("b", model.odd(alpha, beta=BETA_STEP) / beta, LATERAL),
        **_named("p", model.odd(alpha, rates=(RATE_STEP, 0.0, 0.0)) / RATE_STEP, LATERAL),
        **_named("q", model.odd(alpha, rates=(0.0, RATE_STEP, 0.0)) / RATE_STEP, LONGITUDINAL),
        **_named("r", model.odd(alpha, rates=(0.0, 0.0, RATE_STEP)) / RATE_STEP, LATERAL),
        **_named("de", model.odd(alpha, tail=(TAIL_STEP, 0.0)) / deflection, ("CL", "CD", "Cm")),
        **_named("da", model.odd(alpha, tail=(0.0, TAIL_STEP)) / deflection, LATERAL),
    }


def _at_linear_alpha(model: Model) -> Tables:
    """Curvatures of drag, and derivatives over α', at the linear angle of attack."""
    alpha = np.array([model.geometry["reference"]["linear_alpha_deg"]])
    beta, deflection = math.radians(BETA_STEP), math.radians(TAIL_STEP)
    drag = COEFFICIENTS.index("CD")
    curvature = model.even(alpha, beta=BETA_STEP)[drag] / beta**2
    lag = 2 * model.tail_arm / model.chord * model.downwash_slope(alpha)
    return {
        "CDbb": curvature,
        "CDbbbb": model.coefficients(alpha, beta=ABEAM)[drag] - curvature,
        "CDee": model.even(alpha, tail=(TAIL_STEP, 0.0))[drag] / deflection**2,
        "CDaa": model.even(alpha, tail=(0.0, TAIL_STEP))[drag] / deflection**2,
        **_named("ad", lag * model.odd(alpha, tail=(TAIL_STEP, 0.0)) / deflection, LONGITUDINAL),
    }


def _named(suffix: str, values: np.ndarray, names: tuple[str, ...]) -> Tables:
    """Pick rows of 6 × n values by the names of their coefficients."""
    return {name + suffix: values[COEFFICIENTS.index(name)] for name in names}


def _negated(step: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(-v for v in value) if isinstance(value, tuple) else -value for key, value in step.items()}
