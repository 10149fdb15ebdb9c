"""The rail: a latch, a push over a stroke, and two shoes that hold the aircraft until they leave its end.

Each shoe is a linear spring-damper normal and lateral to the rail (it runs in a slot, so both signs act); roll is
held by the shoes' width. Along the rail the latch, a spring-damper too, carries m g sin(theta) until release; from
then on only a stop behind the shoes is left, which pushes but does not pull. What pushes is in `launchers`. The front
shoe leaves first; for the time that the rear one still holds, gravity turns the nose down (tip-off).

What is given is the mean over a step, so that its impulse is right whatever the step: a shoe that leaves within one
counts for the share of it during which it holds; springs are taken with the motion of the step's middle. At 26 m/s a
step of 1 ms is 26 mm of way.

Everything is SI; the rail's frame is (along, right, down), the body's (forward, right, down).
"""

from math import cos, pi, sin, tan
from typing import NamedTuple

from uavsim.plants.launchers.kinds import make_push
from uavsim.plants.launchers.push import Load
from uavsim.plants.settings import LauncherSettings

CONTACT_FREQUENCY = 40.0  # Hz, of the aircraft's mass on both shoes: stiff, and stable at a step of 1 ms
ROLL_FREQUENCY = 15.0  # Hz, of the aircraft held in roll by the shoes' width; its small inertia allows no more at 1 ms
DAMPING_RATIO = 0.7
ROUNDING = 1e-9  # s, within which a step ends at the release
CREEP_SPEED = 0.01  # m/s, below which friction fades to 0, so that a resting aircraft is not shaken

Vector = tuple[float, float, float]
Seen = tuple[float, float, float, float, float]
"""Along one axis: the body's x, y and z, 1, its displacement, m, and its velocity, m/s."""


class Motion(NamedTuple):
    """Where the aircraft is: NED displacement of its centre of gravity, its velocity, Euler angles, body rates."""

    displacement: Vector  # m, since rest
    velocity: Vector  # m/s
    attitude: Vector  # rad: roll, pitch, heading
    rates: Vector  # rad/s


class RailForces(NamedTuple):
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


def turned(attitude: Vector, rates: Vector, time: float) -> Vector:
    """Euler angles a short `time` later at constant body rates, to first order, rad."""
    roll, pitch, heading = attitude
    p, q, r = rates
    sideways = q * sin(roll) + r * cos(roll)
    return (
        roll + time * (p + sideways * tan(pitch)),
        pitch + time * (q * cos(roll) - r * sin(roll)),
        heading + time * sideways / cos(pitch),
    )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _seen(axis: Vector, axes: tuple[Vector, Vector, Vector], motion: Motion) -> Seen:
    """Return what of the body's axes, its displacement and its velocity is along an axis in NED."""
    x, y, z = axes
    return _dot(x, axis), _dot(y, axis), _dot(z, axis), _dot(motion.displacement, axis), _dot(motion.velocity, axis)


def _share(left: float, way: float) -> float:
    """Share of a step on `way` for which a shoe holds that leaves after `left`."""
    return 0.0 if left <= 0.0 else 1.0 if left >= way else left / way


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
    step
        Over which forces are averaged, s.
    force_factor
        This launch's push over the nominal one.
    pressure
        Of the air at the launcher, Pa.

    Attributes
    ----------
    machine
        What pushes.
    travel
        Way along the rail at the beginning of the step that was asked for last, m.
    push
        Mean force of the catapult over that step, N.
    active
        Whether a shoe was on the rail at its beginning.
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
        step: float,
        force_factor: float = 1.0,
        pressure: float = 101_325.0,
    ) -> None:
        if front[0] <= rear[0]:
            raise ValueError("the front launch shoe must lie ahead of the rear one")
        self.settings = settings
        self.release_time = release_time
        self._step = step
        self.along, self.right, self.down = body_axes(
            (0.0, settings.elevation_deg * pi / 180.0, settings.heading_deg * pi / 180.0)
        )
        backward = -gravity * self.along[2]  # m/s^2, g sin(theta)
        self.machine = make_push(settings, Load(mass, backward, settings.stroke, step, force_factor, pressure))
        self._ends = settings.stroke if settings.ends_at is None else settings.ends_at
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
        self.travel = 0.0
        self.push = 0.0
        self.active = True

    def _mean_push(self, start: float, speed: float, held: float, against: float) -> float:
        """Mean force of the launcher over the step from `start`, s, of which it acts for the share `held`, N."""
        settings, step = self.settings, self._step
        since = start - self.release_time - settings.hang_fire
        if since + step < ROUNDING or settings.misfire:
            return 0.0
        held = min(held, _share(self._ends - self.travel, speed * step))
        return self.machine.mean(since, self.travel, speed, held, against) if held > 0.0 else 0.0

    def forces(self, time: float, motion: Motion, shoes: tuple[Vector, Vector]) -> RailForces:
        """Mean forces on the aircraft over the step whose middle is `time`, s.

        Parameters
        ----------
        time
            Middle of the step, s.
        motion
            At that time.
        shoes
            Front and rear, from the centre of gravity, body axes, m.
        """
        along, right, down = self.along, self.right, self.down
        axes = body_axes(motion.attitude)
        middle = _dot(motion.displacement, along)
        speed = _dot(motion.velocity, along)
        way = speed * self._step
        self.travel = middle - 0.5 * way
        if self.travel >= self.settings.stroke:
            self.active, self.push = False, 0.0
            return FREE

        held = [_share(leaves - self.travel, way) for leaves in (self._front_leaves, self.settings.stroke)]
        normal, lateral = _seen(down, axes, motion), _seen(right, axes, motion)
        normal_loads, lateral_loads, couple = [], [], 0.0
        for shoe, rest, load, share in (
            (shoes[0], self._rest[0], self._front_rest, held[0]),
            (shoes[1], self._rest[1], self._rear_rest, held[1]),
        ):
            if share == 0.0:
                normal_loads.append(0.0)
                lateral_loads.append(0.0)
                continue
            x, y, z = shoe
            normal_loads.append(share * (load + self._spring(normal, motion.rates, shoe, rest[2])))
            # The slot's width takes the couple that a lateral force at the shoe would roll the aircraft with, so the
            # lateral guidance acts at the height of the centre of gravity and roll is held on its own.
            sideways = share * self._spring(lateral, motion.rates, (x, y, 0.0), rest[1])
            lateral_loads.append(sideways)
            couple += z * sideways

        support = self._axial_rest - self._stiffness * middle - self._damping * speed
        if time > self.release_time:
            support = max(support, 0.0)
        rubbing = self.settings.friction * (abs(normal_loads[0]) + abs(normal_loads[1]))
        friction = -rubbing * max(-1.0, min(1.0, speed / CREEP_SPEED)) if time > self.release_time else 0.0
        self.push = self._mean_push(time - 0.5 * self._step, speed, held[1], -friction)
        rolling = self._roll_stiffness * _dot(axes[1], down) + self._roll_damping * motion.rates[0]
        return RailForces(
            axial=self.push + support + friction,
            front_normal=normal_loads[0],
            front_lateral=lateral_loads[0],
            rear_normal=normal_loads[1],
            rear_lateral=lateral_loads[1],
            roll_moment=couple - held[1] * rolling,
        )

    def _spring(self, seen: Seen, rates: Vector, place: Vector, level: float) -> float:
        """Force of one shoe's spring and damper along an axis at a place on the body, N; `level` at rest, m."""
        a, b, c, displacement, velocity = seen
        x, y, z = place
        p, q, r = rates
        moved = displacement + a * x + b * y + c * z - level
        speed = velocity + a * (q * z - r * y) + b * (r * x - p * z) + c * (p * y - q * x)
        return -0.5 * (self._stiffness * moved + self._damping * speed)
