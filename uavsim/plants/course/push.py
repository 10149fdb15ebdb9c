"""What pushes a point along a rail, and how it moves there.

    s'' = n(τ, s) - g sin θ                                      τ since release, θ the rail's elevation; no friction

The latch carries g sin θ until the push does. A is the specific force of the launcher times the drawn factor:

    catapult  n = A trapezoid(τ): rises in t_r, stays, and falls in t_f so that it is 0 at the end of the stroke S;
              the fall begins where s + v t_f + (A/3 - g sin θ/2) t_f² reaches S
    motor     n = A trapezoid(τ) for a given time, whatever the rail is long: what is left of it pushes in the air
    bungee    n = A min(τ/t_r, 1) (1 - s/S): a spring that is slack at the end of the stroke
    throw     n = A sin(π τ/T): a hand, which guides as long as it pushes

The equation is solved by the classical Runge-Kutta method, a step a row.
"""

from dataclasses import dataclass
from math import ceil, inf, pi, radians, sin
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.settings import LauncherSettings
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]
Kind = Literal["catapult", "motor", "bungee", "throw"]

LONGEST = 20.0  # s on the rail, after which it is said that the push does not get up it; a real one takes under 2 s


@dataclass(frozen=True, slots=True)
class Push:
    """What pushes.

    Attributes
    ----------
    kind
        "catapult", "motor", "bungee" or "throw".
    level
        A, m/s².
    length
        How long a motor or a hand pushes, s; inf for what ends with the stroke.
    launcher
        Rise, fall, stroke and elevation.
    """

    kind: Kind
    level: float
    length: float
    launcher: LauncherSettings

    @property
    def back(self) -> float:
        """What of gravity is along the rail, m/s²."""
        return STANDARD_GRAVITY * sin(radians(self.launcher.elevation_deg))

    def force(self, since: float, way: float, fall: float) -> float:
        """Specific force of the push along the rail, m/s², s after release; `fall` is when a trapezoid begins to."""
        rail = self.launcher
        if self.kind == "throw":
            return self.level * sin(pi * since / self.length) if 0.0 <= since < self.length else 0.0
        risen = min(max(since / rail.rise, 0.0), 1.0)
        if self.kind == "bungee":
            return self.level * risen * max(1.0 - way / rail.stroke, 0.0)
        return self.level * max(risen - max(since - fall, 0.0) / rail.fall, 0.0)


@dataclass(frozen=True, slots=True)
class Rail:
    """The motion along the rail, one value a row from the release to the row at which it is left.

    Attributes
    ----------
    way, speed, acceleration
        m, m/s, m/s².
    fall
        When a trapezoid begins to fall, s after release.
    """

    way: Array
    speed: Array
    acceleration: Array
    fall: float


def along_rail(push: Push, rate: float) -> Rail:
    """Move a point along the rail until it leaves it.

    Parameters
    ----------
    push : Push
    rate : float
        Rows a second.

    Raises
    ------
    ValueError
        If the push does not bring it to the end.
    """
    rail, dt = push.launcher, 1.0 / rate
    fall = push.length - rail.fall if push.kind == "motor" else inf
    run_out = (push.level / 3.0 - push.back / 2.0) * rail.fall**2

    def acceleration(since: float, way: float, speed: float) -> float:
        pushed = push.force(since, way, fall) - push.back
        return max(pushed, 0.0) if way <= 0.0 and speed <= 0.0 else pushed

    way = speed = 0.0
    rows = [(0.0, 0.0, acceleration(0.0, 0.0, 0.0))]
    for k in range(ceil(LONGEST * rate)):
        since = k * dt
        if push.kind == "catapult" and fall == inf and way + speed * rail.fall + run_out >= rail.stroke:
            fall = since
        half = since + 0.5 * dt
        a1 = acceleration(since, way, speed)
        a2 = acceleration(half, way + 0.5 * dt * speed, speed + 0.5 * dt * a1)
        a3 = acceleration(half, way + 0.5 * dt * (speed + 0.5 * dt * a1), speed + 0.5 * dt * a2)
        a4 = acceleration(since + dt, way + dt * (speed + 0.5 * dt * a2), speed + dt * a3)
        way += dt * (speed + dt / 6.0 * (a1 + a2 + a3))
        speed += dt / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        rows.append((way, speed, acceleration(since + dt, way, speed)))
        if speed < 0.0:
            break
        if (since + dt >= push.length) if push.kind == "throw" else (way >= rail.stroke):
            s, v, a = np.array(rows).T
            return Rail(s, v, a, fall)
    raise ValueError(
        f"launcher.peak_specific_force_g: a {push.kind} that gives {push.level:.3g} m/s² does not bring it to the end "
        f"of a stroke of {rail.stroke:g} m at an elevation of {rail.elevation_deg:g}°"
    )
