"""A flight on a prescribed course: manoeuvres and pushes that no aircraft here flies, with a truth that is consistent.

A point rests on the launcher's rail, is pushed along it (`plants.course.push`) and then flies leg after leg through the
air (`plants.course.legs`); the body that carries the sensors stands in the flow as the load asks for
(`plants.course.attitude`). In NED, with the mean wind w̄ at the point's height h:

    v = V (cos γ cos χ, cos γ sin χ, -sin γ) + w̄(h)         on the rail: along it, at the speed of the push
    f = Rᵀ (v' - (0, 0, g)),   x' = v                         what an accelerometer at the point feels
    v_air = v - w,   α = atan2(w_b, u_b),   β = asin(v_b/|v_air|),   M = |v_air|/√(γ R T)

w is all motion of the air: the mean wind, turbulence and gusts of the environment as an aircraft has them
(`plants.air.moving`). What is beside the mean wind moves the air at the head and not the point, which is too heavy for
a gust to lift. So along the path f is V' + g sin γ exactly, whatever makes it, and the lift brings n²/V² terms into f_x
by the angle of attack. Pressure and temperature have the standard atmosphere's lapse from the ground's on:

    T = T_g + L (h - h_g),   p = p_g (T/T_g)^(-g/(R L))       L = -6.5 K/km

The course does not obey commands: wings and motor that the flight computer commands change nothing.
"""

from dataclasses import dataclass
from itertools import chain, islice, repeat
from math import degrees, inf, radians
from typing import Annotated

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.airdata import GAMMA, GAS_CONSTANT_DRY_AIR, MOLAR_MASS_DRY_AIR, MOLAR_MASS_WATER
from uavsim.plants.air.moving import COLUMNS, MovingAir, State
from uavsim.plants.air.weather import EARTH_RADIUS, at_ground, doubts
from uavsim.plants.air.wind import mean_wind
from uavsim.plants.course import attitude, legs
from uavsim.plants.course.legs import LegSettings
from uavsim.plants.course.push import Kind as PushKind
from uavsim.plants.course.push import Push, along_rail
from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.plants.settings import EnvironmentSettings
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

LAPSE = -6.5e-3  # K/m, ISO 2533 below 11 km
SLOWEST = 3.0  # m/s of airspeed at the end of the push, below which no wing carries and no direction is one
STALLED = radians(30.0)  # angle of attack that no wing reaches with more lift: the leg asks for what cannot be
SETTLING = 0.020  # s before the record in which the air moves already: one block of its filters
DOWN = np.array([0.0, 0.0, STANDARD_GRAVITY])


@dataclass(frozen=True, slots=True)
class FlightPathSettings:
    """A flight on a prescribed course, `plant.kind = "flight-path"`: the wait on the rail, a push, then leg after leg.

    Level, rise, fall, stroke, elevation, heading and height are the launcher's; there is no friction. Wind, turbulence
    and gusts are the environment's.

    Attributes
    ----------
    push
        "catapult", over the stroke; "motor", for a time; "bungee", whose force falls with the way; "throw", by hand.
    burn
        How long a motor pushes from the release on, s.
    swing
        How long a hand pushes, s.
    legs
        What is flown after the push, one after the other; the last one's end is held. Without any it goes on as the
        push has left it.
    wing_loading
        Mass over wing area, kg/m²: with the lift slope it says how far the body turns for a load.
    lift_slope
        Lift coefficient per angle of attack, 1/rad.
    zero_lift_deg
        Angle of attack at which there is no lift, degrees.
    span
        The wing's, m: what the rotation of turbulence goes by.
    """

    push: PushKind = "catapult"
    burn: Annotated[float, Interval(ge=0.05, le=60)] = 7.0
    swing: Annotated[float, Interval(ge=0.05, le=2)] = 0.3
    legs: tuple[LegSettings, ...] = ()
    wing_loading: Annotated[float, Interval(ge=1, le=1000)] = 25.0
    lift_slope: Annotated[float, Interval(ge=0.5, le=10)] = 4.8
    zero_lift_deg: Annotated[float, Interval(ge=-15, le=5)] = -4.8
    span: Annotated[float, Interval(ge=0.1, le=50)] = 1.8

    def time_of(self, kind: PushKind) -> float:
        """How long that pushes, s; inf for what ends with the stroke."""
        return {"motor": self.burn, "throw": self.swing}.get(kind, inf)


class Course:
    """The motion of a run: its ground velocity, acceleration and attitude at each row.

    Parameters
    ----------
    settings : FlightPathSettings
    run : Run

    Attributes
    ----------
    left : int
        Row at which the rail is left.
    way : ndarray
        Along the rail, m.
    height : ndarray
        Above the ground, m.
    position, velocity, acceleration : ndarray, shape (n, 3)
        NED, m from the place of release, m/s, m/s².
    airspeed, climb : ndarray
        Without turbulence and gusts: m/s, and rad; 0 on the rail.
    rotations : ndarray, shape (n, 3, 3)
    throttle : ndarray
    begun : int
        How many legs are begun.
    """

    def __init__(self, settings: FlightPathSettings, run: Run) -> None:
        legs.check(settings.legs)
        self.settings, self.run = settings, run
        self.time = run.time
        rail, rate, n = run.launcher, run.step_rate, self.time.size
        elevation, heading = radians(rail.elevation_deg), radians(rail.heading_deg)
        self._axes = attitude.about("z", np.array([heading])) @ attitude.about("y", np.array([elevation]))
        along = self._axes[0, :, 0]
        level = rail.peak_specific_force_g * STANDARD_GRAVITY * run.force_factor
        push = Push(settings.push, level, settings.time_of(settings.push), rail)
        moved = along_rail(push, rate)
        first = round(run.release_time * rate)
        self.left = last = first + moved.way.size - 1
        self._fast = float(moved.speed[-1])
        self.velocity, self.acceleration = np.zeros((n, 3)), np.zeros((n, 3))
        self.position, self.way = np.zeros((n, 3)), np.zeros(n)
        on_rail = slice(first, min(last, n))
        size = max(on_rail.stop - first, 0)
        self.way[on_rail] = moved.way[:size]
        self.way[last:] = moved.way[-1]
        self.velocity[on_rail] = moved.speed[:size, None] * along
        self.acceleration[on_rail] = moved.acceleration[:size, None] * along
        self.position[on_rail] = moved.way[:size, None] * along
        self.airspeed, self.climb, self.throttle = np.zeros(n), np.zeros(n), np.zeros(n)
        self.rotations = np.repeat(self._axes, n, axis=0)
        self.begun = 0
        if last < n:
            self._fly(push, moved.fall, last, along)
        self.height = rail.height - self.position[:, 2]

    def _fly(self, push: Push, fall: float, last: int, along: Array) -> None:
        """Fill in what is flown from row `last` on."""
        settings, run, rate, n = self.settings, self.run, self.run.step_rate, self.time.size
        environment = run.environment
        start = along * self.way[-1]
        height = run.launcher.height - float(start[2])
        begin = along * self._fast - np.array([*mean_wind(environment, height), 0.0])
        speed = float(np.linalg.norm(begin))
        climb, direction = float(np.arcsin(-begin[2] / speed)), float(np.arctan2(begin[1], begin[0]))
        pushed = self._pushed(push, fall, speed, climb, last)
        if not pushed[0].min() > SLOWEST:
            raise ValueError(
                f"plant.flight_path.push: the airspeed at its end is {pushed[0].min():.1f} m/s; it must be above "
                f"{SLOWEST:g} m/s"
            )
        flown, self.begun = legs.fly(settings.legs, legs.Now(speed, climb, 0.0, 0.0), direction, pushed, n - last, rate)
        v, v_rate, climb_rate, turn = flown.airspeed, flown.airspeed_rate, flown.climb_rate, flown.direction_rate
        cc, sc, cd, sd = np.cos(flown.climb), np.sin(flown.climb), np.cos(flown.direction), np.sin(flown.direction)
        in_air = v[:, None] * np.stack([cc * cd, cc * sd, -sc], axis=1)
        rise = -start[2] + _integral(-in_air[:, 2], rate)
        self._check_ground(rise)
        wind = np.array([(*mean_wind(environment, run.launcher.height + up), 0.0) for up in rise.tolist()])
        fresh = np.stack([cc * cd, cc * sd, -sc], axis=1) * v_rate[:, None]
        fresh += (v * climb_rate)[:, None] * np.stack([-sc * cd, -sc * sd, -cc], axis=1)
        fresh += (v * turn * cc)[:, None] * np.stack([-sd, cd, 0.0 * sd], axis=1)
        self.velocity[last:] = in_air + wind
        self.acceleration[last:] = fresh + (np.gradient(wind, axis=0) * rate if len(wind) > 1 else 0.0)
        moved = [start[i] + _integral(self.velocity[last:, i], rate) for i in range(3)]
        self.position[last:] = np.stack(moved, axis=1)
        self.airspeed[last:], self.climb[last:], self.throttle[last:] = v, flown.climb, flown.throttle
        lift = (v * climb_rate + STANDARD_GRAVITY * cc) / np.cos(flown.bank)
        path = attitude.about("z", flown.direction) @ attitude.about("y", flown.climb)
        body = path @ attitude.about("x", flown.bank) @ attitude.about("y", self._alpha(lift, v, rise))
        self.rotations[last:] = attitude.settling(body, self._axes[0], (self.time - self.time[last])[last:])

    def _pushed(self, push: Push, fall: float, speed: float, climb: float, last: int) -> tuple[Array, Array]:
        """Return V and V' from the rail's end to that of the push; one row where both are the same."""
        if push.kind != "motor":
            return np.array([speed]), np.zeros(1)
        dt = 1.0 / self.run.step_rate
        begun = (last / self.run.step_rate) - self.run.release_time
        count = max(round((push.length - begun) * self.run.step_rate), 0) + 1
        force = np.array([push.force(begun + dt * i, 0.0, fall) for i in range(count)])
        gain = force - STANDARD_GRAVITY * np.sin(climb)
        return speed + _integral(gain, self.run.step_rate), gain

    def _alpha(self, lift: Array, v: Array, rise: Array) -> Array:
        """Angle of attack, rad, for a specific force across the path, m/s²."""
        s = self.settings
        pressure, temperature = still_air(self.run.environment, self.run.launcher.height + rise)
        dynamic = 0.5 * pressure / (GAS_CONSTANT_DRY_AIR * temperature) * v * v
        alpha: Array = radians(s.zero_lift_deg) + lift * s.wing_loading / (dynamic * s.lift_slope)
        worst = int(np.argmax(np.abs(alpha)))
        if not abs(alpha[worst]) < STALLED:
            raise ValueError(
                f"plant.flight_path.legs: {lift[worst] / STANDARD_GRAVITY:.1f} g at {v[worst]:.1f} m/s, "
                f"{self.time[self.left + worst]:.1f} s from the start, ask for an angle of attack of "
                f"{degrees(alpha[worst]):.0f}°; {degrees(STALLED):.0f}° is the most that a wing takes"
            )
        return alpha

    def _check_ground(self, rise: Array) -> None:
        """Refuse a course that goes into the ground."""
        low = np.flatnonzero(self.run.launcher.height + rise <= 0.0)
        if low.size:
            raise ValueError(
                f"plant.flight_path.legs: the course goes into the ground {self.time[self.left + low[0]]:.1f} s from "
                "the start; climb before it"
            )


def _integral(values: Array, rate: float) -> Array:
    """Integral from the first row on, by the trapezoidal rule."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))]) / rate


def still_air(environment: EnvironmentSettings, height: Array) -> tuple[Array, Array]:
    """Return pressure, Pa, and temperature, K, of the air at rest at heights above the ground, m."""
    ground = at_ground(environment)
    above = environment.ground_elevation + height
    geopotential = EARTH_RADIUS * above / (EARTH_RADIUS + above)
    base = EARTH_RADIUS * environment.ground_elevation / (EARTH_RADIUS + environment.ground_elevation)
    temperature = ground.temperature + LAPSE * (geopotential - base)
    power = -STANDARD_GRAVITY / (GAS_CONSTANT_DRY_AIR * LAPSE)
    return ground.pressure * (temperature / ground.temperature) ** power, temperature


def moving_air(course: Course) -> tuple[Array, dict[str, Array], MovingAir]:
    """Return the air's motion at each row, m/s, NED, the truth's columns of what it is made of, and what made it."""
    run, settings = course.run, course.settings
    before = round(SETTLING * run.step_rate)
    rows = course.time.size + before
    roll, pitch, heading = attitude.angles(course.rotations)
    moving = MovingAir(run.environment, run.launcher.heading_deg, settings.span, run.step_rate, rows, run.random_seed)
    for event, time in (("time", 0.0), ("release", run.release_time), ("rail-exit", course.left / run.step_rate)):
        moving.tell(event, time)
    asked = iter(range(0, rows + before, before))

    def state() -> State:
        k = min(max(next(asked) - before, 0), course.time.size - 1)
        speed = float(np.linalg.norm(course.velocity[k] - [*mean_wind(run.environment, float(course.height[k])), 0.0]))
        turned = (float(angle[k]) for angle in (roll, pitch, heading))
        return State(float(course.height[k]), float(-course.velocity[k, 2]), speed, *turned)

    blown = moving.motion(-before / run.step_rate, state) if moving.active else iter(())
    still = repeat((0.0,) * COLUMNS)
    all_rows = np.array(list(islice(chain(blown, still), rows - 1)))
    return all_rows[before - 1 :, :3], moving.record(before, course.time), moving


class FlightPath(PrescribedPlant):
    """A course that is played; see the module."""

    def __init__(self, settings: FlightPathSettings, run: Run) -> None:
        course = Course(settings, run)
        wind, parts, self._moving = moving_air(course)
        self._left, self._run, self._course = course.left, run, course
        super().__init__(run, columns(course, wind) | parts)

    def step(self) -> None:
        """Go on to the next row."""
        super().step()
        self.on_rail = self.k < self._left

    @property
    def remarks(self) -> list[str]:
        """What deserves a word: what the air says, and legs that are not reached."""
        said = doubts(self._run.environment) + (self._moving.gusts.missed(self.t) if self.k else [])
        begun, all_ = self._course.begun, len(self._course.settings.legs)
        if begun < all_:
            said.append(f"plant.flight_path.legs[{begun}] is not reached within duration = {self._run.duration:g} s")
        return said


def columns(course: Course, wind: Array) -> dict[str, Array]:
    """Return the truth's columns of a course in air that moves, m/s, NED."""
    rotations, run = course.rotations, course.run
    felt = np.einsum("kji,kj->ki", rotations, course.acceleration - DOWN)
    u, v, w = np.einsum("kji,kj->ki", rotations, course.velocity - wind).T
    airspeed = np.sqrt(u * u + v * v + w * w)
    pressure, temperature = still_air(run.environment, course.height)
    vapour = at_ground(run.environment).vapour_fraction
    molar = 1.0 - vapour + vapour * MOLAR_MASS_WATER / MOLAR_MASS_DRY_AIR
    mach = airspeed / np.sqrt(GAMMA * GAS_CONSTANT_DRY_AIR / molar * temperature)
    if not mach.max() < 1.0:
        raise ValueError(f"plant.flight_path: the course reaches Mach {mach.max():.2f}; it must stay below 1")
    roll, pitch, heading = attitude.angles(rotations)
    turning = attitude.rates(rotations, run.step_rate)
    found = {
        "airspeed": airspeed,
        "mach": mach,
        "p_static": pressure,
        "p_total": airdata.total_pressure(static=pressure, mach=mach),
        "temperature": temperature,
        "altitude": run.environment.ground_elevation + course.height,
        "roll": roll,
        "pitch": pitch,
        "heading": heading,
        "alpha": np.arctan2(w, u),
        "beta": np.arctan2(v, np.hypot(u, w)),
        "throttle": course.throttle,
        "rail_s": course.way,
    }
    for names, values in (
        (("fx", "fy", "fz"), felt),
        (("vn", "ve", "vd"), course.velocity),
        (("wind_n", "wind_e", "wind_d"), wind),
        (("north", "east"), course.position),
        (("p", "q", "r"), turning),
    ):
        found |= {name: values[:, i] for i, name in enumerate(names)}
    return found


KINDS.add(
    Kind(
        "flight-path",
        FlightPath,
        group="flight_path",
        launcher=(
            "peak_specific_force_g", "force_factor", "force_spread", "rise", "fall", "stroke", "elevation_deg",
            "heading_deg",
        ),
        air=True,
        ours=True,
    )
)  # fmt: skip
