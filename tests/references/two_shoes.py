"""A body that is pushed along a rail on two shoes, in the rail's plane, integrated to a relative error of 1e-9.

Written from Newton's and Euler's equations alone, as a second opinion on the plant's rail: no step, no air, no roll.

s along the rail, d down from it, δ the pitch above it; the body's axes are x̂ = (cos δ, −sin δ), ẑ = (sin δ, cos δ).
A shoe at (x, z) from the centre of gravity has moved off the rail by w, and is held by half a spring and half a damper:

    w_i = d − x_i sin δ + z_i cos δ − z_i          N_i = N_i0 − (k ẇ_i + c w_i')/2        while s < l_i
    m s'' = A cos δ − m g sin θ                    A = P(t) + max(L, 0) − μ Σ|N_i| clip(s'/0.01 m/s, −1, 1)
    m d'' = Σ N_i − A sin δ + m g cos θ            L = m g sin θ − k s − c s'
    I δ'' = A z_A − Σ N_i (x_i cos δ + z_i sin δ)

A acts along x̂ at z_A below the centre of gravity. The push P rises evenly, stays, and falls evenly from the moment at
which s + s' t_f + (P_0/(3 m) − g sin θ/2) t_f² = l. Every corner of it ends a piece of the integration.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
CREEP = 0.01  # m/s


@dataclass(frozen=True)
class Launch:
    """Everything that the equations have, SI; shoes and line of the push from the centre of gravity, (x, z) and z."""

    mass: float
    inertia: float
    gravity: float
    elevation: float  # rad
    front: tuple[float, float]
    rear: tuple[float, float]
    line: float
    push: float  # N
    rise: float
    fall: float
    stroke: float
    friction: float
    frequency: float = 40.0  # Hz
    damping: float = 0.7


@dataclass(frozen=True)
class Exit:
    """When the rear shoe leaves: s since release, m/s, rad/s and rad above the rail."""

    time: float
    speed: float
    pitch_rate: float
    pitch: float


def fly(launch: Launch) -> Exit:
    """Integrate from rest until the rear shoe has left.

    Raises
    ------
    ValueError
        If it does not leave within 5 s.
    """
    c = launch
    base = c.front[0] - c.rear[0]
    stiffness, damping = c.mass * (2.0 * np.pi * c.frequency) ** 2, 4.0 * np.pi * c.damping * c.frequency * c.mass
    along, down = c.gravity * np.sin(c.elevation), c.gravity * np.cos(c.elevation)
    rest = (c.mass * down * c.rear[0] / base, -c.mass * down * c.front[0] / base)
    leaves = (c.stroke - base, c.stroke)
    run_out = (c.push / c.mass / 3.0 - along / 2.0) * c.fall**2

    def push(t: float, falls: float) -> float:
        return c.push * max(0.0, min(1.0, t / c.rise) - max(0.0, t - falls) / c.fall)

    def motion(t: float, y: Array, falls: float, held: list[bool]) -> list[float]:
        s, d, pitch, speed, sink, rate = y
        sine, cosine = np.sin(pitch), np.cos(pitch)
        loads, moment = [], 0.0
        for (x, z), load, holds in zip((c.front, c.rear), rest, held, strict=True):
            off = d - x * sine + z * (cosine - 1.0)
            going = sink - (x * cosine + z * sine) * rate
            force = load - 0.5 * (stiffness * off + damping * going) if holds else 0.0
            loads.append(force)
            moment -= force * (x * cosine + z * sine)
        axial = push(t, falls) + max(c.mass * along - stiffness * s - damping * speed, 0.0)
        axial -= c.friction * (abs(loads[0]) + abs(loads[1])) * np.clip(speed / CREEP, -1.0, 1.0)
        return [
            speed, sink, rate,
            axial * cosine / c.mass - along,
            (sum(loads) - axial * sine) / c.mass + down,
            (axial * c.line + moment) / c.inertia,
        ]  # fmt: skip

    def at_end(value: Callable[[Array], float]) -> Callable[..., float]:
        def event(t: float, y: Array, *_: object) -> float:
            return value(y)

        event.terminal = True  # type: ignore[attr-defined]
        return event

    t, y, falls, held = 0.0, np.zeros(6), np.inf, [True, True]
    while held[1]:
        corners = [at_end(lambda y, end=end: y[0] - end) for end, holds in zip(leaves, held, strict=True) if holds]
        if falls == np.inf and t >= c.rise:
            corners.append(at_end(lambda y: y[0] + y[3] * c.fall + run_out - c.stroke))
            if corners[-1](t, y) >= 0.0:
                falls = t
                continue
        end = next(corner for corner in (c.rise, falls, falls + c.fall, 5.0) if corner > t)
        end = min(end, 5.0)
        piece = solve_ivp(
            motion, (t, end), y, args=(falls, held), events=corners, method="DOP853", rtol=1e-9, atol=1e-11
        )
        t, y = float(piece.t[-1]), piece.y[:, -1]
        if t >= 5.0:
            raise ValueError("it does not leave the rail")
        for i, found in enumerate(piece.t_events):
            if not found.size:
                continue
            if i == len(held) - held.count(False):  # the last corner: the push begins to fall
                falls = t
            else:
                held[held.index(True)] = False
            break
    return Exit(t, float(y[3]), float(y[5]), float(y[2]))
