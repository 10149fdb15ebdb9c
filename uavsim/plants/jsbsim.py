"""JSBSim as a plant: an aircraft on a rail, then in the air, one row of truth a step.

The only module that imports jsbsim. Facts it rests on:

* In one `run()` JSBSim propagates the state first and evaluates forces with it last, so position, velocity, forces and
  angular acceleration read after a step all belong to its end. The non-gravitational force over mass is then the
  specific force at the centre of gravity without the one-step lag of JSBSim's own pilot accelerations.
* For the same reason what is set before a `run()` acts in the step after the one that this makes. On the rail rates are
  integrated rectangularly, an acceleration for one step, so the rail gives the mean force over that step (`rail`,
  `held`); what is felt at a row's own time is then the mean of two rows. Off the rail both are of two steps again.
* At the accelerometer, r from the centre of gravity, is felt besides  w' x r + w x (w x r) + 2 w x r' + r''. The last
  two act while the wing opens and the centre of gravity moves; they are backward differences of second order.
* Nodes are looked up once. Each step's raw values are packed into one buffer; SI and derived columns are computed for
  the whole flight at the end (`truth`), and in the loop only for what a sensor reads (`force`, `air`).
* Writing a property that does not exist would silently create it, so every name is checked against the catalogue.
"""

import ctypes
import re
from collections.abc import Callable, Iterator
from difflib import get_close_matches
from math import atan2, cos, exp, inf, isfinite, pi, sin, sqrt
from pathlib import Path
from struct import unpack_from
from tempfile import TemporaryDirectory
from typing import Any
from weakref import proxy

import numpy as np
from jsbsim import BaseError, FGFDMExec, FGLogger, FGPropertyNode, set_logger
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.airdata import GAS_CONSTANT_DRY_AIR, MOLAR_MASS_DRY_AIR, MOLAR_MASS_WATER
from uavsim.plants import held, varied
from uavsim.plants.air.moving import MovingAir
from uavsim.plants.air.moving import State as AirState
from uavsim.plants.air.weather import at_ground, doubts
from uavsim.plants.airframe import Airframe
from uavsim.plants.airframe.figures import of_inertia
from uavsim.plants.columns import (
    AIR,
    AIR_OFFSET,
    ALTITUDE,
    ATTITUDE,
    CENTRE,
    FELT,
    FT,
    INCH,
    INDEX,
    MOTION,
    OF_RECORD,
    OF_ROW,
    OWN,
    PSF,
    RANKINE,
    RAW,
    ROW,
    SLUG,
    SLUG_FT2,
    THROTTLE,
    WING,
)
from uavsim.plants.hangar import find_airframe, is_packaged
from uavsim.plants.interface import (
    COMMANDS,
    FORCES,
    PARTS,
    SHOES,
    TURNS,
    WING_POSITION,
    Interface,
    interface_of,
    problems,
)
from uavsim.plants.plant import Commands, Run
from uavsim.plants.rail import Motion, Rail, RailForces, Vector, body_axes, turned
from uavsim.plants.settings import AircraftSettings
from uavsim.truth import STANDARD_GRAVITY

SETTLING_TIME = 1.0  # s on the latched rail before the record starts, for the shoes to come to rest
SETTLED = 0.5  # s of it, at whose end the shoes are at rest
WING_OUT = 0.99
DRIED = 0.02  # share of the vapour that may be lost before it is refused: two laws of saturation differ by 0.6 %

_WIND = ("atmosphere/wind-north-fps", "atmosphere/wind-east-fps", "atmosphere/wind-down-fps")
POINT_MASS = "inertia/pointmass-weight-lbs"  # and the number of it
INCHES = 12.0  # in a foot
STILL = 1e-4  # in/s of airspeed, below which its quotient with the Mach number is not taken for the speed of sound
BEYOND = 1e11  # (in/s)², 8 km/s beside the centre of gravity: nothing turns like that but what is about to diverge
CONTACT = re.compile(r"(gear|contact)/unit(\[\d+\])?/WOW")  # whether a wheel or another point of it is on the ground

RATES_BY = ("simulation/integrator/rate/rotational", "simulation/integrator/rate/translational")
MEAN_OF_STEP = 1.0  # rectangular: an acceleration acts for the step after it, so the rail gives the mean over that
TWO_STEPS = 3.0  # Adams-Bashforth of second order, in flight; the rectangular loses 2 % of a roll while the wings open

_UNHEARD = "uavsim/unheard/"  # where the properties stand of a part that the aircraft goes without
GET = FGPropertyNode.get_double_value
Row = tuple[float, ...]
Array = NDArray[np.float64]


class _Silence(FGLogger):
    """Keeps JSBSim's console chatter to itself; what matters comes back as exceptions and checks."""

    def set_level(self, level: Any) -> None: ...
    def file_location(self, filename: str, line: int) -> None: ...
    def message(self, message: str) -> None: ...
    def format(self, fmt: Any) -> None: ...
    def flush(self) -> None: ...


SILENCE = _Silence()  # one for all: JSBSim has a logger for each thread, see `_opened`


class JsbsimPlant:
    """An aircraft that waits on a rail, is catapulted and flies.

    Attributes
    ----------
    k, t
        Steps since the start of the record, and their time, s.
    row
        Raw values after this step, in JSBSim's units.
    force
        Specific force at the accelerometer after this step, body axes, m/s^2.
    on_rail
        Whether a shoe is still on the rail.
    aloft
        Whether the altitude of the centre of gravity is a number and above the ground, and off the rail none of the
        points of contact that the aircraft has touches it.
    failure
        What JSBSim said when it could not go on; empty as long as it can.

    Raises
    ------
    ValueError
        Unknown aircraft; a property that it does not have or that is read-only.
    """

    def __init__(self, settings: Run) -> None:
        self.settings = settings
        self._rate = settings.step_rate
        self.dt = 1.0 / settings.step_rate
        self.k = 0
        self.t = 0.0
        self._fdm = self._load(settings.aircraft)
        self._catalogue = read_catalogue(self._fdm)
        self._interface = self._checked_interface()
        self._place()
        self._run: Callable[[], bool] = self._fdm.run
        self._nodes = [self._node(name) for name, _ in RAW.values()]
        self._commands = [self._node(name) for name in COMMANDS]
        self._eye = self._place_of(settings.accelerometer_position)
        self._head = self._place_of(settings.head_position)
        self._contacts = [self._node(name) for name in self._catalogue if CONTACT.fullmatch(name)]
        self._forces = [(self._node(name), unit) for name, unit in FORCES]
        self._shoes = tuple(tuple(map(self._value, places)) for places in SHOES)
        self.row: Row = self._read()
        self._gravity = self._value("accelerations/gravity-ft_sec2") * FT
        self.rail = self._rail()
        self.on_rail = True
        self._settling = round(SETTLING_TIME * settings.step_rate)
        self._moving = MovingAir(
            settings.environment,
            settings.launcher.heading_deg,
            span=self._value("metrics/bw-ft") * FT,
            step_rate=settings.step_rate,
            steps=self._settling + round(settings.duration * settings.step_rate) + 1,
            seed=settings.random_seed,
        )
        self._moving.tell("time", 0.0)
        self._moving.tell("release", settings.release_time)
        names = (*_WIND, *TURNS) if self._interface.turns else _WIND
        told: list[Callable[[float], object]] = [self._node(name).set_double_value for name in names]
        self._air_to = told + [float] * (len(_WIND) + len(TURNS) - len(told))  # an aircraft without turns is told none
        self._blown: Iterator[tuple[float, ...]] | None = None
        self._attended = True
        self._left: int | None = None  # step at which it has left the rail
        self._datum = self.row
        self.aloft = True
        self.failure = ""
        self._ground = settings.environment.ground_elevation / FT
        self._settle()
        self._buffer = bytearray((round(settings.duration * settings.step_rate) + 2) * ROW.size)
        self._size = 0
        self._offsets = (self._lever(self.row),) * 3  # of the sensor from the centre of gravity, newest first
        self._still = True
        self._acted: Vector | None = self._felt(self.row)  # specific force that acts from the last row on; on the rail
        self._record(self.row)

    # -- setting up --------------------------------------------------------------------------------------------------

    def _load(self, aircraft: AircraftSettings) -> FGFDMExec:
        airframe = find_airframe(aircraft.model)
        self._functions = airframe.checked.functions
        fdm = load_airframe(airframe)
        fdm.set_dt(self.dt)
        fdm.set_property_value("simulation/integrator/position/rotational", TWO_STEPS)
        for name in RATES_BY:
            fdm.set_property_value(name, MEAN_OF_STEP)
        return fdm

    def _checked_interface(self) -> Interface:
        """Tell which parts it has, and let what it goes without stand where nothing hears it, with the wing out."""
        if found := problems(self._catalogue, self._functions):
            raise ValueError(f"aircraft.model: {self.settings.aircraft.model}: {'; '.join(found)}")
        interface = interface_of(self._catalogue)
        for name in interface.absent:
            self._fdm.set_property_value(_UNHEARD + name, 1.0 if name == WING_POSITION else 0.0)
        return interface

    def _node(self, name: str) -> FGPropertyNode:
        if name in self._interface.absent:
            name = _UNHEARD + name
        elif name not in self._catalogue:
            raise ValueError(
                f"aircraft.model: {self.settings.aircraft.model!r} lacks the property {name!r} that uavsim needs"
            )
        node = self._fdm.get_property_manager().get_node(name)
        assert node is not None, name  # it is in the catalogue
        return node

    def _value(self, name: str) -> float:
        return float(self._node(name).get_double_value())

    def _set(self, name: str, value: float) -> None:
        self._node(name).set_double_value(value)

    def _place(self) -> None:
        """Initial conditions at rest on the rail, and the air at rest; JSBSim's own turbulence is off."""
        s = self.settings
        air, launcher = s.environment, s.launcher
        for name in ("simulation/randomseed", "atmosphere/randomseed"):  # an aircraft's own functions may draw
            self._set(name, float(s.random_seed))
        self._set("atmosphere/turb-type", 0.0)
        self._set("ic/terrain-elevation-ft", air.ground_elevation / FT)
        self._set("ic/lat-geod-deg", air.latitude_deg)
        self._set("ic/h-sl-ft", (air.ground_elevation + launcher.height) / FT)
        self._set("ic/psi-true-deg", launcher.heading_deg)
        self._set("ic/theta-deg", launcher.elevation_deg)
        self._set("atmosphere/delta-T", air.temperature_offset / RANKINE)
        self._apply(s.aircraft.properties)
        for name, factor in varied.factors(s.aircraft).items():
            self._set(self._varies(varied.FACTORS[name], name), factor)
        self._start()
        if varied.is_ballasted(s.aircraft):
            self._ballast()
            self._start()
        self._check_body()
        self._weather()

    def _start(self) -> None:
        """Let JSBSim take in its initial conditions."""
        try:
            started = self._fdm.run_ic()
        except (BaseError, RuntimeError) as error:
            _leave_up(self._fdm)
            raise ValueError(f"aircraft.model: {_said(error, self.settings.aircraft.model)}") from error
        if not started:
            raise ValueError("aircraft.model: JSBSim cannot start it from rest on the rail")

    def _varies(self, needed: str, *names: str) -> str:
        """Return a property that settings of the aircraft need; say which of them, where it lacks."""
        aircraft = self.settings.aircraft
        if "W" not in self._catalogue.get(needed, ""):
            plain = AircraftSettings()
            name = next(n for n in names if getattr(aircraft, n) != getattr(plain, n))
            raise ValueError(varied.missing(aircraft, name, getattr(aircraft, name), needed))
        return needed

    def _ballast(self) -> None:
        """Place ballast on the body's x axis, for another mass and another centre of gravity."""
        self._check_body()
        asked = ("mass_factor", "cg_shift")
        mass = self._value("inertia/mass-slugs") * SLUG
        given = varied.ballast(self.settings.aircraft, mass, self._inertia()[1])
        weight = self._value("inertia/weight-lbs")
        x, y, z = (self._value(f"inertia/cg-{axis}-in") for axis in "xyz")
        for number, share, ahead in zip(varied.BALLAST, (given.fore, given.aft), (given.arm, -given.arm), strict=True):
            which = self._value(self._varies(number, *asked))
            index = f"[{which:.0f}]" if which else ""
            places = {"X": x - ahead / INCH, "Y": y, "Z": z}
            for axis, place in places.items():
                self._set(self._varies(f"inertia/pointmass-location-{axis}-inches{index}", *asked), place)
            self._set(self._varies(f"inertia/pointmass-weight-lbs{index}", *asked), share * weight)

    def _weather(self) -> None:
        """Give the air the pressure of the day, and its vapour; JSBSim's own standard is 0.5 Pa above ISO 2533."""
        environment = self.settings.environment
        self._doubts = doubts(environment)
        ground = at_ground(environment)
        fall = exp(-STANDARD_GRAVITY * self.settings.launcher.height / (GAS_CONSTANT_DRY_AIR * ground.temperature))
        share = ground.pressure * fall / (self._value("atmosphere/P-psf") * PSF)
        self._set("atmosphere/P-sl-psf", share * self._value("atmosphere/P-sl-psf"))
        if ground.vapour_fraction > 0.0:  # not by "atmosphere/RH", which goes by the pressure before the day's
            moles = ground.vapour_fraction / (1.0 - ground.vapour_fraction)
            grams = 1000.0 * moles * MOLAR_MASS_WATER / MOLAR_MASS_DRY_AIR
            self._set("atmosphere/vapor-fraction-ppm", 1000.0 * grams)
            kept = self._value("atmosphere/vapor-fraction-ppm") / 1000.0
            if kept < (1.0 - DRIED) * grams:
                raise ValueError(
                    f"environment.humidity = {environment.humidity:g} is {grams:.0f} g of vapour per kg of dry air, "
                    f"and JSBSim's air holds no more than {kept:.0f}"
                )

    def _check_body(self) -> None:
        """Refuse a body that cannot be, as JSBSim has it with all that was set: mass, inertia, size."""
        mass = self._value("inertia/mass-slugs") * SLUG
        moments = self._inertia()
        sizes = [self._value(f"metrics/{name}") for name in ("bw-ft", "cbarw-ft", "Sw-sqft")]
        if not (0.0 < mass < inf and all(map(isfinite, moments)) and all(0.0 < size < inf for size in sizes)):
            raise ValueError("aircraft.model: its mass, span, chord and wing area must be above 0, its inertia finite")
        if problem := of_inertia(*moments):
            raise ValueError(f"aircraft.model: {problem}")

    def _apply(self, properties: dict[str, float]) -> None:
        for name, value in properties.items():
            where = f"aircraft.properties: {name!r}"
            access = self._catalogue.get(name)
            if access is None:
                near = get_close_matches(name, self._catalogue, n=1, cutoff=0.5)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                raise ValueError(f"{where} is no property of {self.settings.aircraft.model!r}{hint}")
            if "W" not in access:
                raise ValueError(f"{where} is read-only in JSBSim")
            if name.startswith(POINT_MASS) and value < 0.0:  # the body as a whole may pass for one all the same
                raise ValueError(f"{where} = {value:g}: is a mass and must be at least 0")
            self._set(name, value)

    def _place_of(self, position: Vector) -> Vector:
        """Place of a sensor in structural axes (x aft, y right, z up), inches."""
        x, y, z = (self._value(f"metrics/eyepoint-{axis}-in") for axis in "xyz")
        forward, right, down = position
        return x - forward / INCH, y + right / INCH, z - down / INCH

    def _inertia(self) -> list[float]:
        """Return the tensor of inertia about the centre of gravity: xx, yy, zz, xy, xz, yz, kg m²."""
        return [self._value(f"inertia/i{axes}-slugs_ft2") * SLUG_FT2 for axes in ("xx", "yy", "zz", "xy", "xz", "yz")]

    def _rail(self) -> Rail:
        s = self.settings
        front, rear = self._shoe_offsets(self.row)
        mass, inertia = self.row[INDEX["mass"]] * SLUG, self._inertia()
        if problem := held.problem(mass, inertia, front, rear, s.step_rate):
            raise ValueError(problem)
        return Rail(
            s.launcher,
            mass=mass,
            roll_inertia=inertia[0],
            gravity=self._gravity,
            front=front,
            rear=rear,
            release_time=s.release_time,
            step=self.dt,
            force_factor=s.force_factor,
            pressure=self._value("atmosphere/P-psf") * PSF,
        )

    @property
    def shakes(self) -> tuple[float, float]:
        """Specific force, m/s², that the push comes to, and in which time, s: what makes the airframe ring."""
        machine = self.rail.machine
        return machine.peak / (self.row[INDEX["mass"]] * SLUG), machine.rise

    def _settle(self) -> None:
        if self._moving.active:
            self._blown = self._motion_from(-self._settling * self.dt)
        loads, counted = 0.0, round(SETTLED * self.settings.step_rate)
        for k in range(-self._settling, 0):
            forces = self._hold(k * self.dt)
            if k >= -counted:
                loads += (forces.front_normal + forces.rear_normal) / counted
            if self._blown is not None:
                self._blow(self._blown)
            try:
                self._run()
            except (BaseError, RuntimeError) as error:
                _leave_up(self._fdm)
                raise ValueError(f"aircraft.model: {_said(error, self.settings.aircraft.model)}") from error
            self.row = self._read()
        if loads > 0.0:
            raise ValueError(
                f"environment.wind_speed: the wind would lift the aircraft off the rail: {loads:.0f} N hold it down"
            )

    # -- each step ---------------------------------------------------------------------------------------------------

    def command(self, commands: Commands) -> None:
        """Set the onboard computer's commands; they act from the next step on."""
        for node, value in zip(self._commands, commands, strict=True):
            node.set_double_value(value)
        if self._moving.gusts.awaited:
            if commands[0] > 0.0:
                self._moving.tell("wings-commanded", self.t)
            if commands[1] > 0.0:
                self._moving.tell("motor-on", self.t)
            self._attended = True

    def step(self) -> None:
        """Advance by one step and record it."""
        if self._attended:
            self._attend()
        if self._blown is not None:
            self._blow(self._blown)
        try:
            self._run()
        except (BaseError, RuntimeError) as error:  # of the aircraft's own functions
            _leave_up(self._fdm)
            self.failure = _said(error, self.settings.aircraft.model)
        self.k += 1
        self.t = self.k / self._rate
        self.row = row = tuple(map(GET, self._nodes))
        self._record(row)
        self.aloft = row[ALTITUDE] > self._ground and not self.failure  # false too for NaN
        if self._contacts and not self.on_rail:
            self.aloft = self.aloft and not any(map(GET, self._contacts))

    def step_unrecorded(self) -> None:
        """Advance by one step of bare JSBSim: the measure that recording is compared with."""
        if self._attended:
            self.row = self._read()
            self._attend()
        if self._blown is not None:
            if self._moving.blows:
                self.row = self._read()
            self._blow(self._blown)
        self._run()
        self.k += 1
        self.t = self.k / self._rate

    def _read(self) -> Row:
        return tuple(map(GET, self._nodes))

    def _record(self, row: Row) -> None:
        self.force = self._felt(row)
        if self._acted is not None:
            self._centre(self._acted)
        ROW.pack_into(self._buffer, self._size, *row, self.rail.push, *self.force)
        self._size += ROW.size

    def _centre(self, acted: Vector) -> None:
        """On the rail a row's forces are the mean of the step that follows it: at its own time is the mean of two."""
        now = self.force
        self.force = (0.5 * (acted[0] + now[0]), 0.5 * (acted[1] + now[1]), 0.5 * (acted[2] + now[2]))
        self._acted = now

    def _attend(self) -> None:
        """Look after what is not always there: the rail, gusts that wait for an event, air that begins to move."""
        moving = self._moving
        if self.on_rail:
            self._hold(self.t)
        elif self._left is not None:
            self._fly_free(self._left)
        if moving.gusts.awaited and self.row[WING] >= WING_OUT and (self._interface.folds or not self.on_rail):
            moving.tell("wing-out", self.t)
        if moving.active and self._blown is None:
            self._blown = self._motion_from(self.t)
        self._attended = self.on_rail or self._left is not None or bool(moving.gusts.awaited)

    def _blow(self, blown: Iterator[tuple[float, ...]]) -> None:
        """Let the air move through the step that begins."""
        motion = next(blown, None)
        if motion is None:  # the last gust is over, and until another one comes
            self._blown = None
            return
        north, east, down, p, q, r, _, _ = motion
        to_north, to_east, to_down, turn_p, turn_q, turn_r = self._air_to
        to_north(north / FT)
        to_east(east / FT)
        to_down(down / FT)
        turn_p(p)
        turn_q(q)
        turn_r(r)

    def _motion_from(self, time: float) -> Iterator[tuple[float, ...]]:
        """Let the air move from `time` on; it does not hold the aircraft, which goes with its last user."""
        aircraft = proxy(self)
        return self._moving.motion(time, lambda: aircraft._state())  # noqa: PLW0108 (a bound method would hold it)

    def _state(self) -> AirState:
        """What the air is told of the aircraft."""
        row = self.row
        return AirState(
            (row[ALTITUDE] - self._ground) * FT, -row[INDEX["vd"]] * FT, row[INDEX["airspeed"]] * FT, *ATTITUDE(row)
        )

    def _hold(self, time: float) -> RailForces:
        """Set the rail's forces: JSBSim takes them in at the end of the coming step, and they act in the one after."""
        ahead = 1.5 * self.dt
        forces = self.rail.forces(time + ahead, self._motion(ahead), self._shoe_offsets(self.row))
        self._push(forces)
        if not self.rail.active:
            self.on_rail, self._left = False, self.k
            self._moving.tell("rail-exit", self.t)
        return forces

    def _fly_free(self, left: int) -> None:
        """Integrate in two steps again once neither of the two has a force of the rail in it."""
        if self.k >= left + 2:
            for name in RATES_BY:
                self._set(name, TWO_STEPS)
            self._left = self._acted = None

    def _motion(self, ahead: float) -> Motion:
        """Return the motion `ahead` of the present, s, from the present accelerations."""
        row = self.row
        north, east, altitude, vn, ve, vd = MOTION(row)
        north0, east0, altitude0, *_ = MOTION(self._datum)
        fx, fy, fz, mass, _, _, _, p, q, r, p_dot, q_dot, r_dot = row[FELT]
        x, y, z = body_axes(ATTITUDE(row))
        an = (fx * x[0] + fy * y[0] + fz * z[0]) / mass
        ae = (fx * x[1] + fy * y[1] + fz * z[1]) / mass
        ad = (fx * x[2] + fy * y[2] + fz * z[2]) / mass + self._gravity / FT
        half = 0.5 * ahead
        return Motion(
            (
                (north - north0 + ahead * (vn + half * an)) * FT,
                (east - east0 + ahead * (ve + half * ae)) * FT,
                (altitude0 - altitude + ahead * (vd + half * ad)) * FT,
            ),
            ((vn + ahead * an) * FT, (ve + ahead * ae) * FT, (vd + ahead * ad) * FT),
            turned(ATTITUDE(row), (p + half * p_dot, q + half * q_dot, r + half * r_dot), ahead),
            (p + ahead * p_dot, q + ahead * q_dot, r + ahead * r_dot),
        )

    def _push(self, f: RailForces) -> None:
        values = (f.axial, f.front_normal, f.front_lateral, f.rear_normal, f.rear_lateral, f.roll_moment)
        for (node, unit), value in zip(self._forces, values, strict=True):
            node.set_double_value(value / unit)

    def _shoe_offsets(self, row: Row) -> tuple[Vector, Vector]:
        """Both shoes relative to the centre of gravity, body axes, m (structural x is aft, z is up)."""
        x, y, z = CENTRE(row)
        front, rear = self._shoes
        return (
            ((x - front[0]) * INCH, (front[1] - y) * INCH, (z - front[2]) * INCH),
            ((x - rear[0]) * INCH, (rear[1] - y) * INCH, (z - rear[2]) * INCH),
        )

    # -- what sensors read -------------------------------------------------------------------------------------------

    def _lever(self, row: Row) -> Vector:
        x, y, z = CENTRE(row)
        eye = self._eye
        return ((x - eye[0]) * INCH, (eye[1] - y) * INCH, (z - eye[2]) * INCH)

    def _felt(self, row: Row) -> Vector:
        """Specific force at the accelerometer, body axes, m/s^2."""
        fx, fy, fz, mass, cx, cy, cz, p, q, r, p_dot, q_dot, r_dot = row[FELT]
        eye = self._eye
        x, y, z = (cx - eye[0]) * INCH, (eye[1] - cy) * INCH, (cz - eye[2]) * INCH
        scale = FT / mass
        turn = p * x + q * y + r * z
        spin = p * p + q * q + r * r
        felt = (
            fx * scale + q_dot * z - r_dot * y + p * turn - spin * x,
            fy * scale + r_dot * x - p_dot * z + q * turn - spin * y,
            fz * scale + p_dot * y - q_dot * x + r * turn - spin * z,
        )
        newest = self._offsets[0]
        if self._still and x == newest[0] and z == newest[2]:
            return felt
        return self._with_moving_cg(felt, (x, y, z), (p, q, r))

    def _with_moving_cg(self, felt: Vector, offset: Vector, rates: Vector) -> Vector:
        """Add 2 w x r' + r'' while the centre of gravity moves in the body."""
        history = zip(offset, *self._offsets, strict=True)
        moving = [_derivatives(*values, self.dt) for values in history]
        (u, u_dot), (v, v_dot), (w, w_dot) = moving
        p, q, r = rates
        a, b, _ = self._offsets
        self._offsets = (offset, a, b)
        self._still = offset == a == b
        return (
            felt[0] + 2.0 * (q * w - r * v) + u_dot,
            felt[1] + 2.0 * (r * u - p * w) + v_dot,
            felt[2] + 2.0 * (p * v - q * u) + w_dot,
        )

    def air(self, time: float) -> Vector:
        """Total, static pressure, Pa, and temperature, K, at the head at any recorded `time`, linear within a step.

        How much faster the head is than the centre of gravity is taken from the nearest row.
        """
        steps = time * self._rate
        k = int(steps)
        if k >= self.k:
            k = self.k - 1
        share = steps - k
        at = k * ROW.size
        mach0, static0, temperature0 = AIR.unpack_from(self._buffer, at + AIR_OFFSET)
        mach, static, temperature = AIR.unpack_from(self._buffer, at + ROW.size + AIR_OFFSET)
        static = (static0 + share * (static - static0)) * PSF
        mach = mach0 + share * (mach - mach0)
        if moves := self._beside(OF_RECORD.unpack_from(self._buffer, at if share < 0.5 else at + ROW.size)):
            mach += moves[0]
        total = airdata.isentropic_total(static, mach)
        return total, static, (temperature0 + share * (temperature - temperature0)) * RANKINE

    def flow(self) -> tuple[float, float, float, float, float, float, float]:
        """Total, static pressure, Pa, temperature, K, Mach number, alpha, beta, rad, and throttle after this step."""
        here = OF_ROW(self.row)
        _, mach, static, temperature, _, _, _, _, _, _, alpha, beta = here
        static *= PSF
        if moves := self._beside(here):
            faster, u, v, w = moves
            mach, alpha, beta = mach + faster, atan2(w, u), atan2(v, sqrt(u * u + w * w))
        total = airdata.isentropic_total(static, mach)
        return total, static, temperature * RANKINE, mach, alpha, beta, self.row[THROTTLE]

    def flow_at(self, time: float) -> tuple[float, float, float, float, float, float, float]:
        """As `flow`, at any recorded `time`, s: pressures, temperature and Mach number as of `air`, else nearest."""
        total, static, temperature = self.air(time)
        k = round(time * self._rate)
        at = (k if k < self.k else self.k) * ROW.size
        here = OF_RECORD.unpack_from(self._buffer, at)
        alpha, beta = here[10], here[11]
        if moves := self._beside(here):
            _, u, v, w = moves
            alpha, beta = atan2(w, u), atan2(v, sqrt(u * u + w * w))
        mach = sqrt(max(0.0, 5.0 * ((total / static) ** (2.0 / 7.0) - 1.0)))
        (throttle,) = unpack_from("d", self._buffer, at + 8 * THROTTLE)
        return total, static, temperature, mach, alpha, beta, throttle

    def _beside(self, here: Row) -> tuple[float, float, float, float] | None:
        """How the head moves, which has ω × r beside the centre of gravity, or nothing if it has none.

        Returns
        -------
        tuple
            Its Mach number less that of the centre of gravity, and its velocity in the air, body axes, in/s.
        """
        speed, mach, _, temperature, x, y, z, p, q, r, alpha, beta = here
        a, b, c = self._head
        x -= a  # ahead, to the right and down
        y = b - y
        z -= c
        u = q * z - r * y
        v = r * x - p * z
        w = p * y - q * x
        if not 0.0 < u * u + v * v + w * w < BEYOND:
            return None
        speed *= INCHES
        ahead = speed * cos(beta)
        u += ahead * cos(alpha)
        v += speed * sin(beta)
        w += ahead * sin(alpha)
        there = sqrt(u * u + v * v + w * w)
        if speed > STILL:
            return mach * (there - speed) / speed, u, v, w
        return there * INCH / airdata.speed_of_sound(temperature * RANKINE) - mach, u, v, w

    @property
    def finite(self) -> bool:
        """Whether the whole state is finite, and JSBSim could work it out."""
        return all(map(isfinite, self.row)) and not self.failure

    # -- the record --------------------------------------------------------------------------------------------------

    def truth(self) -> dict[str, Array]:
        """Columns of the truth (`uavsim.truth.UNITS`), SI, one value a step."""
        table = np.frombuffer(memoryview(self._buffer).toreadonly(), count=self._size // 8).reshape(-1, ROW.size // 8)
        raw = {name: table[:, i] * factor for i, (name, (_, factor)) in enumerate(RAW.items())}
        raw["t"] = np.arange(len(table)) / self.settings.step_rate
        raw |= {name: table[:, len(RAW) + i] for i, name in enumerate(OWN)}
        raw["north"] = raw["north"] - self._datum[INDEX["north"]] * FT
        raw["east"] = raw["east"] - self._datum[INDEX["east"]] * FT
        raw["rail_s"] = self._travel(raw)
        raw["heading"] = _continuous(raw["heading"])
        raw |= self._moving.record(self._settling, raw["t"])
        with np.errstate(all="ignore"):  # unchecked: it may have diverged
            raw["p_total"] = airdata.isentropic_total(raw["p_static"], raw["mach"], np)
        return raw

    @property
    def remarks(self) -> list[str]:
        """What deserves a word: a line each, more of them at the end than at the start."""
        said = list(self._doubts)
        if self.settings.environment.turbulence_wind_20ft > 0.0 and not self._interface.turns:
            said.append(
                f"{self.settings.aircraft.model} flies without the turbulence's rotation (p, q, r): it has no "
                f"{', '.join(TURNS)} that its damping reads"
            )
        if not self._interface.stabilised:
            said.append(
                f"{self.settings.aircraft.model} flies without a stabiliser: it has no "
                f"{', '.join(PARTS['stabiliser'])}, so the commands of pitch and roll reach nothing"
            )
        return said + (self._moving.gusts.missed(self.t) if self.k else [])

    def _travel(self, c: dict[str, Array]) -> Array:
        """Way along the rail, m, kept once the last shoe has left."""
        rise = c["altitude"] - self._datum[ALTITUDE] * FT
        along = self.rail.along
        travel: Array = along[0] * c["north"] + along[1] * c["east"] - along[2] * rise
        left = np.flatnonzero(travel >= self.settings.launcher.stroke)
        if left.size:
            travel[left[0] :] = travel[left[0]]
        return travel


def load_airframe(airframe: Airframe) -> FGFDMExec:
    """Let JSBSim read an aircraft that was checked.

    One of one's own is read from a copy, whatever becomes of the original. The copy stands in the folder for temporary
    files (`tempfile`) while it is read; the command line has that inside the folder that it writes.

    Raises
    ------
    ValueError
        One line: what JSBSim says of it, or which properties it reads that nobody has.
    """
    if is_packaged(airframe):
        return _opened(airframe, Path(airframe))
    with TemporaryDirectory(prefix=".uavsim-") as place:
        return _opened(airframe, airframe.write(Path(place)))


def _opened(airframe: Airframe, folder: Path) -> FGFDMExec:
    # A thread's end lets go of its logger without the interpreter's lock: were it the last to do so, it would end the
    # process. This one is never let go of.
    _leave_up(SILENCE)
    set_logger(SILENCE)
    fdm = FGFDMExec(None)
    fdm.set_debug_level(0)
    for name in airframe.checked.early:
        fdm.set_property_value(name, 0.0)
    try:
        loaded = fdm.load_model_with_paths(
            folder.name, str(folder.parent), str(folder / "engine"), str(folder / "systems"), True
        )
    except (BaseError, RuntimeError) as error:
        _leave_up(fdm)
        raise ValueError(f"aircraft.model: {_said(error, airframe)}") from error
    if not loaded:
        _leave_up(fdm)
        raise ValueError(f"aircraft.model: JSBSim cannot load {airframe}/{folder.name}.xml")
    fdm.disable_output()
    manager = fdm.get_property_manager()
    missing = [name for name in airframe.checked.reads if not manager.hasNode(name)]
    if missing:
        _leave_up(fdm)
        named = "; ".join(f"{airframe.checked.reads[name]}: {name!r}" for name in missing)
        are = "is a property" if len(missing) == 1 else "are properties"
        more = "".join(f"; {clause}" for clause in problems(read_catalogue(fdm), airframe.checked.functions))
        raise ValueError(
            f"aircraft.model: {airframe}: {named} {are} that neither JSBSim nor the aircraft has; declare "
            f'{"it" if len(missing) == 1 else "them"} as <property value="0">{more}'
        )
    return fdm


def _said(error: Exception, aircraft: str) -> str:
    """What JSBSim says of an aircraft's file, in one line, whatever folder it was read from."""
    where = rf"In file .*?/(?={re.escape(Path(aircraft).name)}/)"
    return re.sub(where, "In file ", " ".join(str(error).split()))


def _leave_up(thing: FGFDMExec | FGLogger) -> None:
    """Never take this down: JSBSim works its functions out once more then, and what fails there ends the process."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))


def _continuous(angle: Array) -> Array:
    """Return an angle that JSBSim wraps at 0 and 2 pi without its jumps, first within ±pi of 0, rad."""
    continuous: Array = np.unwrap(angle)
    continuous -= 2.0 * pi * np.round(continuous[0] / (2.0 * pi))
    return continuous


def _derivatives(now: float, before: float, two_before: float, three_before: float, dt: float) -> tuple[float, float]:
    """First and second derivative at the newest of four equidistant values, backward differences of second order."""
    first = (3.0 * now - 4.0 * before + two_before) / (2.0 * dt)
    second = (2.0 * now - 5.0 * before + 4.0 * two_before - three_before) / dt**2
    return first, second


def read_catalogue(fdm: FGFDMExec) -> dict[str, str]:
    """Property names with their access: 'R', 'W' or 'RW'."""
    entries = fdm.get_property_catalog()
    lines = entries if isinstance(entries, list) else str(entries).splitlines()
    catalogue = {}
    for line in lines:
        name, _, access = line.strip().rpartition(" ")
        catalogue[name] = access.strip("()")
    return catalogue
