"""The aircraft held by the rail: at which frequencies it swings on its shoes, and which steps that survives.

About rest, in the five displacements u = (right, down, roll, pitch, yaw) that the shoes hold,

    M u'' = -K u - C u',   K = Σ k/2 n nᵀ + k_r r rᵀ,   C the same with the dampers

with n the displacement of a shoe's place along the rail's normal, or to the right at the height of the centre of
gravity, and r the roll. The rail knows only the motion at the beginning of a step, and gives for the step that follows
the force of its middle, one and a half steps ahead (`plants.jsbsim`):

    u''_{j+1} = -M⁻¹ [K (u + h u' + h²/2 u'')_j + C (u' + h u'')_j],   h = 1.5 dt
    u'_{j+1} = u'_j + dt u''_j
    u_{j+1} = u_j + dt (23 u'_j - 16 u'_{j-1} + 5 u'_{j-2})/12     angles: (3 u'_j - u'_{j-1})/2

It survives the step if no eigenvalue of this recursion is outside the unit circle.
"""

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.plant import STEP_RATES, Vector
from uavsim.plants.rail import CONTACT_FREQUENCY, DAMPING_RATIO, ROLL_FREQUENCY

Array = NDArray[np.float64]

THREE_STEPS = np.array([23.0, -16.0, 5.0]) / 12.0  # Adams-Bashforth's weights of JSBSim for the position
TWO_STEPS = np.array([1.5, -0.5, 0.0])  # and for the attitude


def problem(mass: float, inertia: Sequence[float], front: Vector, rear: Vector, step_rate: float) -> str:
    """Say in one line why the rail cannot hold an aircraft at a step rate; nothing if it can.

    Parameters
    ----------
    mass
        kg.
    inertia
        About the centre of gravity, entries of the tensor: xx, yy, zz, xy, xz, yz, kg m².
    front, rear
        Shoes from the centre of gravity, body axes, m.
    step_rate
        Hz.
    """
    springs, dampers = _per_inertia(mass, inertia, front, rear)
    if _survives(springs, dampers, step_rate):
        return ""
    swings = f"the aircraft swings on its shoes at {fastest(springs):.0f} Hz"
    finer = [rate for rate in STEP_RATES if rate > step_rate and _survives(springs, dampers, rate)]
    if finer:
        return f"plant.step_rate = {step_rate:g}: {swings}, which does not survive it; it takes {finer[0]} Hz"
    return (
        f"aircraft.model: {swings}, which no plant.step_rate up to {STEP_RATES[-1]} Hz survives; its shoes are "
        f"{front[0] - rear[0]:.3g} m apart, too far for its moments of inertia"
    )


def fastest(springs: Array) -> float:
    """Return the highest frequency of stiffness over inertia, Hz."""
    return float(np.sqrt(np.abs(np.linalg.eigvals(springs)).max())) / (2.0 * pi)


def _per_inertia(mass: float, inertia: Sequence[float], front: Vector, rear: Vector) -> tuple[Array, Array]:
    """Return stiffness and damping over inertia, M⁻¹ K and M⁻¹ C."""
    xx, yy, zz, xy, xz, yz = inertia
    inertias = np.diag([mass, mass, 0.0, 0.0, 0.0])
    inertias[2:, 2:] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    shoes = np.zeros((5, 5))
    for x, y, _ in (front, rear):
        for moved in ([0.0, 1.0, y, -x, 0.0], [1.0, 0.0, 0.0, 0.0, x]):
            shoes += 0.5 * mass * np.outer(moved, moved)
    rolled = np.diag([0.0, 0.0, xx, 0.0, 0.0])
    contact, roll = 2.0 * pi * CONTACT_FREQUENCY, 2.0 * pi * ROLL_FREQUENCY
    inverse = np.linalg.inv(inertias)
    springs: Array = inverse @ (shoes * contact**2 + rolled * roll**2)
    dampers: Array = inverse @ (2.0 * DAMPING_RATIO * (shoes * contact + rolled * roll))
    return springs, dampers


def _survives(springs: Array, dampers: Array, step_rate: float) -> bool:
    """Whether a disturbance does not grow from step to step."""
    dt, n = 1.0 / step_rate, len(springs)
    ahead, one, none = 1.5 * dt, np.eye(n), np.zeros((n, n))
    weights = [np.diag(dt * np.where(np.arange(n) < 2, *pair)) for pair in zip(THREE_STEPS, TWO_STEPS, strict=True)]
    step = np.block(  # of u, u' and its two predecessors, u''
        [
            [one, *weights, none],
            [none, one, none, none, dt * one],
            [none, one, none, none, none],
            [none, none, one, none, none],
            [-springs, -ahead * springs - dampers, none, none, -0.5 * ahead**2 * springs - ahead * dampers],
        ]
    )
    return bool(np.abs(np.linalg.eigvals(step)).max() <= 1.0)
