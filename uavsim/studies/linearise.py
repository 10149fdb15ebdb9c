"""Trim, derivatives and modes of an aircraft over airspeed and wing position, flown in JSBSim with its controls fixed.

Trimmed level flight is where nothing changes over `SPAN` seconds: Newton's method in angle of attack, pitch control and
a constant thrust. The state's change over that time, from small steps either way, gives the transition matrix Φ; a mode
is an eigenvalue of ln Φ / SPAN. Derivatives are central differences of the coefficients about the trim, moments about
the centre of gravity, rates by q c/2V, p b/2V and r b/2V (any textbook of flight dynamics, e.g. Etkin & Reid,
*Dynamics of Flight*, 3rd ed., ch. 4-6). The static margin is -dC_m/dC_L with the control where it is in trim. The speed
of stall is that of level flight at the greatest C_L below `STEEPEST` with a neutral control.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uavsim.plants.columns import FT, LBF, SLUG
from uavsim.plants.free import SPAN, Array, Free, checked, pitch_control

STEPS = np.array([0.3, 0.3, 0.01, 0.01, 0.3, 0.01, 0.01, 0.01])  # ft/s and rad: a degree of flow at 20 m/s
ALPHA_STEP = 0.5  # deg
RATE_STEP = 0.01  # of q c/2V and its fellows: within the linear range of any of them
TAIL_STEP = math.radians(0.5)
ITERATIONS, SETTLED = 25, 1e-4  # of Newton; change of the state over SPAN in ft/s and rad
BOLDEST = 0.1  # rad, by which an angle moves in one of them: beyond, tables of a stall turn it back
STEEPEST = 25  # deg
WINGS = (0.0, 0.25, 0.5, 0.75, 1.0)
OF_STALL = (1.2, 1.5, 2.0, 2.5, 3.0)
"""Airspeeds that are flown unless others are asked for, over that of stall with the wing out."""


class NoTrimError(ValueError):
    """No level flight was found."""


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode.

    Attributes
    ----------
    name
        'short period', 'phugoid', 'Dutch roll', 'roll', 'spiral', or what stands in their place.
    value
        Eigenvalue, 1/s; of a pair that with the positive imaginary part.
    """

    name: str
    value: complex

    @property
    def damping(self) -> float:
        """Of the undamped motion: -Re λ/|λ|."""
        return -self.value.real / abs(self.value)


@dataclass(frozen=True, slots=True)
class Point:
    """Level flight at one wing position and airspeed.

    Attributes
    ----------
    wing, airspeed
        0 folded … 1 out, and m/s.
    problem
        Why there is none; then the rest is empty.
    alpha, control, thrust
        Of the trim, rad, rad and N.
    derivatives
        By name; per rad and without unit.
    modes
        Of the longitudinal and then of the lateral motion.
    """

    wing: float
    airspeed: float
    problem: str = ""
    alpha: float = math.nan
    control: float = math.nan
    thrust: float = math.nan
    derivatives: dict[str, float] | None = None
    modes: tuple[Mode, ...] = ()


@dataclass(frozen=True, slots=True)
class Linearised:
    """An aircraft over airspeed and wing position.

    Attributes
    ----------
    name
        Of the aircraft.
    pitch
        Properties that pitch it.
    mass
        kg.
    stall, greatest_lift
        m/s with the wing out, and its C_L.
    points
        Level flights, the wing's position outermost.
    """

    name: str
    pitch: tuple[str, ...]
    mass: float
    stall: float
    greatest_lift: float
    points: tuple[Point, ...]


def linearise(
    model: str | Path,
    airspeeds: Iterable[float] = (),
    wings: Iterable[float] = WINGS,
    pitch: Iterable[str] = (),
    progress: Callable[[float], None] = lambda _: None,
) -> Linearised:
    """Linearise an aircraft.

    Parameters
    ----------
    model
        A packaged name or a folder.
    airspeeds
        m/s; none: `OF_STALL`.
    wings
        Positions; a fixed wing has one.
    pitch
        Properties that pitch it, rad; none: found.
    progress
        Told the share that is done.

    Raises
    ------
    ValueError
        One line: all that the aircraft lacks, or what is impossible in its files.
    """
    airframe, folds = checked(model)
    controls = tuple(pitch) or pitch_control(airframe)
    positions = tuple(wings) if folds else (1.0,)
    greatest, stall, mass = _stall(Free(airframe, pitch=controls, steady=True))
    speeds = tuple(airspeeds) or tuple(float(round(share * stall)) for share in OF_STALL)
    points: list[Point] = []
    for wing in positions:
        free, steady = (Free(airframe, wing, pitch=controls, steady=s) for s in (False, True))
        for speed in speeds:
            points.append(_point(free, steady, wing, speed))
            progress(len(points) / (len(positions) * len(speeds)))
    return Linearised(airframe.name, controls, mass, stall, greatest, tuple(points))


def _stall(free: Free) -> tuple[float, float, float]:
    """Greatest C_L with a neutral control, the airspeed at which it carries the weight, m/s, and the mass, kg."""
    free.set_controls(0.0, 0.0)
    greatest = max(float(free.lift_and_moment(alpha)[0]) for alpha in range(STEEPEST + 1))
    if not greatest > 0.0:
        raise ValueError(f"{free.name}: has no lift up to {STEEPEST}° of angle of attack")
    pressure = free.fdm["inertia/weight-lbs"] / (free.fdm["metrics/Sw-sqft"] * greatest)
    speed = math.sqrt(2.0 * pressure / free.fdm["atmosphere/rho-slugs_ft3"]) * FT
    return greatest, speed, free.fdm["inertia/mass-slugs"] * SLUG


def _point(free: Free, steady: Free, wing: float, speed: float) -> Point:
    try:
        alpha, tail, push = trim(free, speed)
        longitudinal, lateral = roots(free, speed, (alpha, tail, push))
    except (NoTrimError, np.linalg.LinAlgError) as error:
        return Point(wing, speed, str(error))
    found = derivatives(steady, speed, alpha, tail)
    return Point(wing, speed, "", alpha, tail, push * LBF, found, tuple(named(longitudinal, lateral)))


def level(alpha: float, speed: float) -> Array:
    """State of level flight."""
    fps = speed / FT
    return np.array([fps * math.cos(alpha), fps * math.sin(alpha), 0, alpha, 0, 0, 0, 0])


def trim(free: Free, speed: float) -> tuple[float, float, float]:
    """Angle of attack (rad), tail (rad) and push (lbf) of level flight: Newton's method."""
    scale = 0.5 * free.fdm["inertia/weight-lbs"]

    def change(x: Array) -> Array:
        free.set_controls(x[1], scale * x[2])
        state = level(x[0], speed)
        return np.asarray(free.fly(state) - state)[:3]

    x, step = np.array([0.02, 0.0, 0.1]), 1e-3
    for _ in range(ITERATIONS):
        off = change(x)
        if np.abs(off).max() <= 0.01 * SETTLED:
            break
        jacobian = np.array([(change(x + step * e) - change(x - step * e)) / (2 * step) for e in np.eye(3)]).T
        if not (np.isfinite(jacobian).all() and np.isfinite(off).all()) or np.linalg.matrix_rank(jacobian) < 3:
            raise NoTrimError("no level flight was found")
        x = x - np.clip(np.linalg.solve(jacobian, off), -BOLDEST, BOLDEST)
    if not np.abs(change(x)).max() <= SETTLED:
        raise NoTrimError("no level flight was found")
    if abs(x[0]) > math.radians(STEEPEST):
        raise NoTrimError(f"level flight at {math.degrees(x[0]):.0f}° of angle of attack only")
    return float(x[0]), float(x[1]), float(scale * x[2])


def roots(free: Free, speed: float, at: tuple[float, float, float] | None = None) -> tuple[Array, Array]:
    """Eigenvalues (1/s) of longitudinal and lateral motion about level flight, trimmed unless it is given."""
    alpha, tail, push = trim(free, speed) if at is None else at
    free.set_controls(tail, push)
    state = level(alpha, speed)
    columns = [(free.fly(state + d) - free.fly(state - d)) / 2 for d in np.diag(STEPS)]
    transition = np.array(columns).T / STEPS
    parts = transition[:4, :4], transition[4:, 4:]
    values = [np.log(np.linalg.eigvals(part).astype(complex)) / SPAN for part in parts]
    return values[0], values[1]


def derivatives(steady: Free, speed: float, alpha: float, tail: float) -> dict[str, float]:
    """Coefficients and their derivatives about a trim; `CL_control` and `Cm_control` are by the pitch control, rad."""
    fdm, at = steady.fdm, math.degrees(alpha)
    steady.speed = speed
    chord, span = (0.5 * fdm[f"metrics/{name}-ft"] * FT / speed for name in ("cbarw", "bw"))

    def of(alpha_deg: float = at, beta_deg: float = 0.0, rates: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
        x, y, z, l, m, n = steady.coefficients(alpha_deg, beta_deg, rates)  # noqa: E741 (the field's name)
        a = math.radians(alpha_deg)
        cos, sin = math.cos(a), math.sin(a)
        return np.array([x * sin - z * cos, -x * cos - z * sin, y, l, m, n])

    def slope(low: Array, high: Array, step: float) -> dict[str, float]:
        return dict(zip(("CL", "CD", "CY", "Cl", "Cm", "Cn"), ((high - low) / (2.0 * step)).tolist(), strict=True))

    steady.set_controls(tail, 0.0)
    lift, drag, *_ = of().tolist()
    by_alpha = slope(of(at - ALPHA_STEP), of(at + ALPHA_STEP), math.radians(ALPHA_STEP))
    by_beta = slope(of(beta_deg=-ALPHA_STEP), of(beta_deg=ALPHA_STEP), math.radians(ALPHA_STEP))
    by_rate = [
        slope(of(rates=_only(axis, -RATE_STEP / arm)), of(rates=_only(axis, RATE_STEP / arm)), RATE_STEP)
        for axis, arm in enumerate((span, chord, span))
    ]
    steady.set_controls(tail - TAIL_STEP, 0.0)
    less = of()
    steady.set_controls(tail + TAIL_STEP, 0.0)
    by_tail = slope(less, of(), TAIL_STEP)
    p, q, r = by_rate
    return {
        "CL": lift,
        "CD": drag,
        "lift_over_drag": lift / drag,
        "static_margin": -by_alpha["Cm"] / by_alpha["CL"],
        **{f"{name}_alpha": by_alpha[name] for name in ("CL", "CD", "Cm")},
        **{f"{name}_q": q[name] for name in ("CL", "Cm")},
        **{f"{name}_control": by_tail[name] for name in ("CL", "Cm")},
        **{f"{name}_beta": by_beta[name] for name in ("CY", "Cl", "Cn")},
        **{f"{name}_p": p[name] for name in ("CY", "Cl", "Cn")},
        **{f"{name}_r": r[name] for name in ("CY", "Cl", "Cn")},
    }


def _only(axis: int, rate: float) -> tuple[float, float, float]:
    """Rates about the three axes, of which one is not 0."""
    p, q, r = (rate if axis == each else 0.0 for each in range(3))
    return p, q, r


def named(longitudinal: Array, lateral: Array) -> Iterator[Mode]:
    """Give each eigenvalue its name: pairs and single ones, the fastest first."""
    for values, pairs, singles in (
        (longitudinal, ("short period", "phugoid"), ("pitch", "pitch, slower", "pitch, slow", "pitch, slowest")),
        (lateral, ("Dutch roll", "roll and spiral"), ("roll", "spiral", "lateral", "lateral, slowest")),
    ):
        turning = sorted((complex(v) for v in values if v.imag > 0), key=abs, reverse=True)
        straight = sorted((complex(v) for v in values if not v.imag), key=abs, reverse=True)
        slow = len(turning) == 1 and values is longitudinal and straight and abs(turning[0]) < abs(straight[-1])
        names: tuple[str, ...] = pairs[1:] if slow else pairs  # of the one pair beside two faster single ones
        yield from (Mode(name, value) for name, value in zip(names, turning, strict=False))
        yield from (Mode(name, value) for name, value in zip(singles, straight, strict=False))


def describe(value: complex) -> str:
    """A mode in words."""
    if value.imag:
        size, turn = abs(value), 2 * math.pi
        return f"period {turn / value.imag:6.2f} s, {size / turn:5.2f} Hz, damping {-value.real / size:5.3f}"
    if value.real > 0:
        return f"doubles in {math.log(2) / value.real:.1f} s"
    return f"time constant {-1 / value.real:.3f} s"
