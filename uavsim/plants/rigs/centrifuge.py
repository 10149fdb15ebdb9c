"""A centrifuge as a rig: the box hangs at radius r on an arm that turns about a vertical axis.

Body z points along the arm to the hub, body x up the axis, body y the way it moves (z = inward, y = forward, x = up:
right-handed, and at rest it is a body that stands on its tail). What is felt is all that gravity does not give:

    f_z = ω² r       to the hub, the centripetal acceleration
    f_y = ω' r       along the way, while the speed changes
    f_x = g          up, the floor of the box, whatever the speed

ω rises evenly from 0 when the wait is over, is held and falls evenly; ω_hold = √(load/arm), and r = arm + radius error,
so that the load at the sensor differs from what was set by r/arm. g is the standard one.
"""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Annotated

import numpy as np
from annotated_types import Interval

from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.truth import STANDARD_GRAVITY


@dataclass(frozen=True, slots=True)
class CentrifugeSettings:
    """A centrifuge, `plant.kind = "centrifuge"`: the arm at rest, spun up, held, spun down, at rest.

    It begins to turn when the launcher's wait is over.

    Attributes
    ----------
    arm
        Radius that the load is set for, m.
    load_g
        Centripetal load at that radius while the speed is held, g; the speed is the root of load/arm.
    radius_error
        How much further out the sensor sits than the arm is long, m.
    spin_up
        Time in which the speed grows evenly, s.
    hold
        Time for which it is held, s.
    spin_down
        Time in which it goes back to 0 evenly, s.
    """

    arm: Annotated[float, Interval(ge=0.05, le=20)] = 1.0
    load_g: Annotated[float, Interval(ge=0, le=200)] = 4.0
    radius_error: Annotated[float, Interval(ge=-1, le=1)] = 0.0
    spin_up: Annotated[float, Interval(ge=0.01, le=600)] = 5.0
    hold: Annotated[float, Interval(ge=0, le=3000)] = 8.0
    spin_down: Annotated[float, Interval(ge=0.01, le=600)] = 5.0

    @property
    def length(self) -> float:
        """How long the run takes after the wait, s."""
        return self.spin_up + self.hold + self.spin_down


def centrifuge(settings: CentrifugeSettings, run: Run) -> PrescribedPlant:
    """Make the plant of one run.

    Raises
    ------
    ValueError
        If the sensor would sit on the axis or beyond it.
    """
    s, time = settings, run.time
    radius = s.arm + s.radius_error
    if radius <= 0.0:
        raise ValueError(f"plant.centrifuge.radius_error = {s.radius_error:g}: must be above -arm, {-s.arm:g} m")
    corners = run.release_time + np.cumsum([0.0, s.spin_up, s.hold, s.spin_down])
    fastest = sqrt(s.load_g * STANDARD_GRAVITY / s.arm)
    omega = np.interp(time, corners, [0.0, fastest, fastest, 0.0])
    piece = np.searchsorted(corners, time, side="right")  # 0 before, 1 up, 2 held, 3 down, 4 after
    slope = np.array([0.0, fastest / s.spin_up, 0.0, -fastest / s.spin_down, 0.0])[piece]
    # the angle turned is exact, since the speed is linear between any two rows and its corners
    begun = np.concatenate([[0.0], np.cumsum(0.5 * fastest * np.array([s.spin_up, 2.0 * s.hold, s.spin_down]))])
    start = np.array([0.0, 0.0, fastest, fastest, 0.0])[piece]
    since = np.where(piece > 0, time - corners[np.maximum(piece - 1, 0)], 0.0)
    angle = begun[np.maximum(piece - 1, 0)] + since * (start + 0.5 * slope * since)
    cosine, sine, still = np.cos(angle), np.sin(angle), np.zeros_like(time)
    columns = {
        "fx": np.full_like(time, STANDARD_GRAVITY),
        "fy": slope * radius,
        "fz": omega**2 * radius,
        "north": radius * (1.0 - cosine),  # it starts south of the hub, which lies ahead of body z
        "east": radius * sine,
        "altitude": np.full_like(time, run.environment.ground_elevation + run.launcher.height),
        "vn": omega * radius * sine,
        "ve": omega * radius * cosine,
        "vd": still,
        "roll": still,
        "pitch": np.full_like(time, 0.5 * pi),
        "heading": -angle,  # at a pitch of 90° body z points along the heading, and the hub falls behind to the left
        "p": omega,
        "q": still,
        "r": still,
    }
    return PrescribedPlant(run, columns)


KINDS.add(Kind("centrifuge", centrifuge, group="centrifuge", launches=False, ours=True))
