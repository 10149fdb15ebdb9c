"""The rail: a latch, a push over a stroke, and two shoes that hold the aircraft until they leave its end.

Each shoe is a linear spring-damper normal and lateral to the rail (it runs in a slot, so both signs act); roll is
held by the shoes' width. Along the rail the latch, a spring-damper too, carries m g sin(theta) until release; from
then on only a stop behind the shoes is left, which pushes but does not pull. The push is

    F(t) = m g0 n(t),   n rises linearly to its plateau, stays, and falls linearly to 0 at the end of the stroke,

where the fall begins at the first moment at which the remaining way is no longer than what the aircraft will run
while the push dies away: v t_fall + (n g0 / 3 - g sin(theta) / 2) t_fall^2. The front shoe leaves first; for the time
that the rear one still holds, gravity turns the nose down (tip-off).

Everything is SI; the rail's frame is (along, right, down), the body's (forward, right, down).
"""

from dataclasses import dataclass
from math import cos, pi, sin

from uavsim.plants.settings import LauncherSettings
from uavsim.truth import STANDARD_GRAVITY

CONTACT_FREQUENCY = 40.0  # Hz, of the aircraft on its shoes: stiff, and stable at a step of 1 ms
ROLL_FREQUENCY = 15.0  # Hz, of the aircraft held in roll by the shoes' width; its small inertia allows no more at 1 ms
DAMPING_RATIO = 0.7
CREEP_SPEED = 0.01  # m/s, below which friction fades to 0, so that a resting aircraft is not shaken

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Motion:
    """Where the aircraft is: NED displacement of its centre of gravity, its velocity, Euler angles, body rates."""

    displacement: Vector  # m, since rest
    velocity: Vector  # m/s
    attitude: Vector  # rad: roll, pitch, heading
    rates: Vector  # rad/s


@dataclass(frozen=True, slots=True)
class RailForces:
    """What the rail does to the aircraft, N and N m, in body axes (down and right are positive)."""

    axial: float
    front_normal: float
    front_lateral: float
    rear_normal: float
    rear_lateral: float
    roll_moment: float


FREE = RailForces(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def body_axes(attitude: Vector) -> tuple[Vector, Vector, Vector]:
    """Body x, y, z as unit vectors in NED, from Euler angles (roll, pitch, heading) in rad."""
    roll, pitch, heading = attitude
    sr, cr, sp, cp, sh, ch = sin(roll), cos(roll), sin(pitch), cos(pitch), sin(heading), cos(heading)
    return (
        (cp * ch, cp * sh, -sp),
        (sr * sp * ch - cr * sh, sr * sp * sh + cr * ch, sr * cp),
        (cr * sp * ch + sr * sh, cr * sp * sh - sr * ch, cr * cp),
    )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class Rail:
    """Rail, latch and catapult for one launch.

    Parameters
    ----------
    settings
        The launcher.
    mass, roll_inertia
        Of the aircraft, kg and kg m^2.
    gravity
        At the place, m/s^2.
    front, rear
        The shoes relative to the centre of gravity at rest, body axes, m.
    release_time
        When the latch lets go, s.
    force_factor
        This launch's push over the nominal one.
    """

    def __init__(
        self,
        settings: LauncherSettings,
        *,
        mass: float,
        roll_inertia: float,
        gravity: float,
        front: Vector,
        rear: Vector,
        release_time: float,
        force_factor: float = 1.0,
    ) -> None:
        if front[0] <= rear[0]:
            raise ValueError("the front launch shoe must lie ahead of the rear one")
        self.settings = settings
        self.release_time = release_time
        self.along, self.right, self.down = body_axes(
            (0.0, settings.elevation_deg * pi / 180.0, settings.heading_deg * pi / 180.0)
        )
        self.plateau = mass * STANDARD_GRAVITY * settings.peak_specific_force_g * force_factor  # N
        backward = -gravity * self.along[2]  # m/s^2, g sin(theta)
        self._run_out = (self.plateau / mass / 3.0 - backward / 2.0) * settings.fall**2  # m, at no speed
        self._rest = (front, rear)
        angular = 2.0 * pi * CONTACT_FREQUENCY
        self._stiffness, self._damping = mass * angular**2, 2.0 * DAMPING_RATIO * mass * angular
        rolling = 2.0 * pi * ROLL_FREQUENCY
        self._roll_stiffness = roll_inertia * rolling**2
        self._roll_damping = 2.0 * DAMPING_RATIO * roll_inertia * rolling
        weight_normal = mass * gravity * self.down[2]
        base = front[0] - rear[0]
        self._axial_rest = mass * backward
        # Moment balance about the centre of gravity; the axial force acts at its height.
        self._front_rest = -weight_normal * (-rear[0]) / base
        self._rear_rest = -weight_normal * front[0] / base
        self._front_leaves = settings.stroke - base
        self._fall_start: float | None = None
        self.travel = 0.0
        self.push = 0.0
        self.active = True

    def _push_at(self, time: float, speed: float) -> float:
        """Force of the catapult at `time`, N."""
        s = self.settings
        since = time - self.release_time
        if since <= 0.0:
            return 0.0
        if self._fall_start is None:
            if since > s.rise and self.travel + speed * s.fall + self._run_out >= s.stroke:
                self._fall_start = time
            return self.plateau * min(since / s.rise, 1.0)
        return self.plateau * max(1.0 - (time - self._fall_start) / s.fall, 0.0)

    def forces(self, time: float, motion: Motion, shoes: tuple[Vector, Vector]) -> RailForces:
        """Forces on the aircraft at `time`; `shoes` relative to the present centre of gravity, body axes, m."""
        along, right, down = self.along, self.right, self.down
        axes = body_axes(motion.attitude)
        self.travel = _dot(motion.displacement, along)
        speed = _dot(motion.velocity, along)
        if self.travel >= self.settings.stroke:
            self.active, self.push = False, 0.0
            return FREE

        normal_loads, lateral_loads, couple = [], [], 0.0
        for shoe, rest, load, leaves in (
            (shoes[0], self._rest[0], self._front_rest, self._front_leaves),
            (shoes[1], self._rest[1], self._rear_rest, self.settings.stroke),
        ):
            if self.travel >= leaves:
                normal_loads.append(0.0)
                lateral_loads.append(0.0)
                continue
            x, y, z = shoe
            normal_loads.append(load + self._spring(down, axes, motion, (x, y, z), rest[2]))
            # The slot's width takes the couple that a lateral force at the shoe would roll the aircraft with, so the
            # lateral guidance acts at the height of the centre of gravity and roll is held on its own.
            lateral = self._spring(right, axes, motion, (x, y, 0.0), rest[1])
            lateral_loads.append(lateral)
            couple += z * lateral

        support = self._axial_rest - self._stiffness * self.travel - self._damping * speed
        if time > self.release_time:
            support = max(support, 0.0)
        self.push = self._push_at(time, speed)
        rubbing = self.settings.friction * (abs(normal_loads[0]) + abs(normal_loads[1]))
        friction = -rubbing * max(-1.0, min(1.0, speed / CREEP_SPEED)) if time > self.release_time else 0.0
        roll = _dot(axes[1], down)
        return RailForces(
            axial=self.push + support + friction,
            front_normal=normal_loads[0],
            front_lateral=lateral_loads[0],
            rear_normal=normal_loads[1],
            rear_lateral=lateral_loads[1],
            roll_moment=couple - self._roll_stiffness * roll - self._roll_damping * motion.rates[0],
        )

    def _spring(
        self, axis: Vector, axes: tuple[Vector, Vector, Vector], motion: Motion, place: Vector, level: float
    ) -> float:
        """Force of one shoe's spring and damper along `axis` (NED) at a place on the body, N; `level` at rest, m."""
        x, y, z = place
        p, q, r = motion.rates
        a, b, c = _dot(axes[0], axis), _dot(axes[1], axis), _dot(axes[2], axis)
        moved = _dot(motion.displacement, axis) + a * x + b * y + c * z - level
        speed = _dot(motion.velocity, axis) + a * (q * z - r * y) + b * (r * x - p * z) + c * (p * y - q * x)
        return -0.5 * (self._stiffness * moved + self._damping * speed)
