"""Flights in the loop held against the bound: the airspeed's error from the true launch on, and what could be had.

Each flight's truth gives a course as `studies.cramer_rao` wants it: the airspeed V, the height h, and the slope of the
energy-rate relation,

    s = g ḣ/V = −g v_d/V,

and the specific force along body x less that at rest. The information is averaged over the courses; the schedule of
readings is the first flight's.

The aided filter starts from readings of before the launch, kept until the launch is recognised. What it makes of them
is computed on board in one go at the recognition and told nobody; here the filter is run on a flight's own readings
once more, and what it would have said at each of them is written down.
"""

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sensors.mounting import attitude, linear
from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.beliefs import believed_air, believed_noise
from uavsim.cosim import draw, tare_window
from uavsim.flight import Flight
from uavsim.onboard.airspeed import (
    AidedFilter,
    Estimate,
    EstimatorSettings,
    NoiseModel,
    PaperFilter,
    TareWindow,
)
from uavsim.onboard.airspeed.rail_wind import CALM
from uavsim.onboard.airspeed.rest_force import BLOCK, WANDER
from uavsim.onboard.airspeed.rest_wind import HIDDEN, VISIBLE
from uavsim.onboard.rail_offset import RailOffset, known
from uavsim.scenario import scenario_of
from uavsim.studies.cramer_rao import AirspeedBound, Courses, Schedule, Start
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]
B = TypeVar("B", bound=AirspeedBound)

STEP = 2e-3  # s, of the common time axis of courses
LEAD = 0.6  # s before the true launch from which a course is kept; the filter starts later
SLOWEST = 0.5  # m/s; below it the climb's share of gravity is that of the rail
NORMAL_95 = 1.959964  # quantile of 97.5 %


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """One flight's true course on times from `-LEAD` on in steps of `STEP` since the true launch; shape (n,) each.

    The air's speed along body x is None in a course that was kept by an earlier version.
    """

    airspeed: Array
    slope: Array
    static: Array
    force: Array
    temperature: float
    along: Array | None = None


class RememberingFilter(AidedFilter):
    """The aided filter, which writes down what it says of the readings that it is started with.

    Attributes
    ----------
    history : list of tuple
        Estimates in flight, those before the recognition included.
    """

    __slots__ = ("history",)

    def __init__(self, settings: EstimatorSettings, noise: NoiseModel, tare_window: TareWindow | None = None) -> None:
        self.history: list[Estimate] = []
        super().__init__(settings, noise, tare_window)

    def _fly(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        estimate = super()._fly(t, p_total, p_static, temperature, t_total, t_static)
        if estimate is not None:
            self.history.append(estimate)
        return estimate


def replayed(flight: Flight) -> Array:
    """Return t, airspeed, its standard deviation and the raw airspeed from where the filter starts on; shape (r, 4)."""
    scenario = scenario_of(flight)
    draws = draw(scenario)
    noise = believed_noise(scenario, draws.calibration)
    estimator = RememberingFilter(
        believed_air(scenario, draws.calibration), noise, tare_window(scenario, draws.release_time)
    )
    rail = RailOffset(noise)
    turn = linear(attitude(*scenario.accelerometer.mounting_deg))
    launch = flight.score["launch"]["detected_time"]
    wings = next((e["t"] for e in flight.events if e["event"] == "wings_commanded"), None)
    forces = iter(flight.accelerometer.to_numpy().tolist())
    force = next(forces, None)
    for row in flight.air_data.to_numpy().tolist():
        while force is not None and force[0] <= row[0]:
            t, fx, fy, fz = force
            if turn is not None:
                fx, fy, fz = turn(fx, fy, fz)
            if not estimator.flying:
                rail.add(t, fx, fy, fz)
            estimator.accelerometer(t, *rail.take_off(fx, fy, fz))
            if t == launch:
                if rail.found:
                    estimator.rested(rail.offset, rail.sd)
                estimator.launched(launch)
            if force[0] == wings:
                estimator.unfolding(force[0])
            force = next(forces, None)
        estimator.step(*row)
    return np.array([e[:4] for e in estimator.history]).reshape(-1, 4)


def course(flight: Flight) -> Course:
    """Return a flight's course; it must have been launched."""
    truth = flight.truth
    t = truth["t"].to_numpy() - flight.score["launch"]["true_time"]
    speed, down, force = (truth[name].to_numpy() for name in ("airspeed", "vd", "fx"))
    rest = float(force[(t > -LEAD) & (t < flight.score["launch"]["release_time"] + t[0] - truth["t"].iloc[0])].mean())
    slope = np.where(speed > SLOWEST, -STANDARD_GRAVITY * down / np.maximum(speed, SLOWEST), rest)
    axis = np.arange(-LEAD, t[-1], STEP)
    return Course(
        airspeed=np.interp(axis, t, speed),
        slope=np.interp(axis, t, slope),
        static=np.interp(axis, t, truth["p_static"].to_numpy()),
        force=np.interp(axis, t, force - rest),
        temperature=float(truth["temperature"].iloc[-1]),
        along=np.interp(axis, t, speed * np.cos(truth["alpha"].to_numpy()) * np.cos(truth["beta"].to_numpy())),
    )


def together(courses: list[Course]) -> Courses:
    """Put courses on one time axis, as long as the shortest."""
    n = min(c.airspeed.size for c in courses)
    return Courses(
        t=np.asarray(-LEAD + STEP * np.arange(n), dtype=np.float64),
        airspeed=np.stack([c.airspeed[:n] for c in courses]),
        slope=np.stack([c.slope[:n] for c in courses]),
        static=np.stack([c.static[:n] for c in courses]),
        force=np.stack([c.force[:n] for c in courses]),
        temperature=float(np.mean([c.temperature for c in courses])),
        along=np.stack([(c.airspeed if c.along is None else c.along)[:n] for c in courses]),
    )


def bound(flight: Flight, courses: Courses) -> tuple[Array, Array]:
    """Return the times of a flight's readings since its true launch, s, and the least standard deviation, m/s.

    Parameters
    ----------
    flight : Flight
        Whose schedule is taken.
    courses : Courses
        Those of many flights, its own among them, or its own alone.
    """
    t, least = bound_of(flight, courses, AirspeedBound)
    return t, least.sd()


def bound_of(flight: Flight, courses: Courses, kind: type[B]) -> tuple[Array, B]:
    """Return the times of a flight's readings since its true launch, s, and the bound, which is not yet computed."""
    scenario = scenario_of(flight)
    noise = believed_noise(scenario, draw(scenario).calibration)
    noise = replace(noise, accelerometer_offset_sd=known(noise)[0])
    settings = believed_air(scenario)
    score = flight.score["launch"]
    true, detected = score["true_time"], score["detected_time"]
    readings = flight.air_data
    t = readings["t"].to_numpy() - true
    start = max(detected - true - settings.aided.replay, -LEAD + STEP)
    rows = (t > start) & (t < courses.t[-1] - STEP)
    total_end, static_end = (readings[name].to_numpy()[rows] - true for name in ("t_total", "t_static"))
    air = scenario.air_data
    rates = np.array([sensor.description().rate for sensor in air.sensors()])
    seen = np.maximum(1.0, air.tare_duration * np.minimum(rates, air.rate))
    static_sd = 0.0 if noise.differential else noise.static_sd  # of the pair's difference
    tare = float(np.hypot(noise.total_sd / np.sqrt(seen[0]), static_sd / np.sqrt(seen[1])))
    rest = float(np.hypot(noise.accelerometer_sd / np.sqrt(BLOCK * noise.accelerometer_rate), WANDER))
    wings = [e["t"] - true for e in flight.events if e["event"] == "wings_commanded"]
    schedule = Schedule(start, t[rows], total_end, static_end, wings[0] if wings else np.inf)
    speed = np.interp(start, courses.t, courses.airspeed.mean(axis=0))
    at_rest = (air.cover_off + start) * min(air.rate, rates[0])
    seen_sd = float(np.hypot(noise.total_sd, static_sd) / np.sqrt(max(1.0, at_rest)))
    declared = settings.aided.rail_wind_sd
    if declared > 0.0 or air.tare == "none":
        apart = tare if air.tare == "covered" else noise.difference_sd
        begun = Start(rest, apart, declared if declared > 0.0 else CALM, seen_sd)
        return t[rows], kind(courses, schedule, settings, noise, begun)
    sigma = float(np.hypot(seen_sd, tare))
    square = 2.0 * sigma * GAS_CONSTANT_DRY_AIR * courses.temperature / float(courses.static[:, 0].mean())
    wind_sd = 0.5 * square / speed if speed * speed >= VISIBLE**2 * square else HIDDEN * np.sqrt(square)
    begun = Start(rest, tare, min(float(wind_sd), settings.wind_sd))
    return t[rows], kind(courses, schedule, settings, noise, begun)


def true_airspeed(flight: Flight, time: Array) -> Array:
    """Airspeed at some times, m/s."""
    found: Array = np.interp(time, flight.truth["t"].to_numpy(), flight.truth["airspeed"].to_numpy())
    return found


# -- an ensemble -----------------------------------------------------------------------------------------------------

PHASES = ("launch", "detected", "stroke", "unfolding", "climb", "cruise")
LAUNCH = 0.3  # s after the true launch
UNFOLDED = 0.1  # s after the wing is out, in which what it has shaken dies away
CLIMB = 2.0  # s after the wing is out


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """One flight held against the truth.

    Attributes
    ----------
    flight : Flight
    rows : ndarray
        Shape (r, 4): time since the true launch, s, error of the estimate, its standard deviation, and error of the
        raw airspeed, m/s.
    course : Course
    edges : dict
        First and last time of each of `PHASES`, s: "launch", the first 0.3 s; "detected", the same from the recognition
        on; "stroke" as in the score; "unfolding", from the rail's end until the wing is out; "climb", two seconds from
        there; "cruise", the rest.
    hold : float
        Rms of the true airspeed about the set one from when it first reaches it, m/s.
    """

    flight: Flight
    rows: Array
    course: Course
    edges: dict[str, tuple[float, float]]
    hold: float


def hold(flight: Flight) -> Held:
    """Hold a flight that has launched and unfolded its wings against the truth."""
    launch, end = flight.score["launch"], flight.score["flight"]
    true = launch["true_time"]
    found = replayed(flight)
    speed = true_airspeed(flight, found[:, 0])
    rows = np.column_stack([found[:, 0] - true, found[:, 1] - speed, found[:, 2], found[:, 3] - speed])
    off = end["rail_exit_time"] - true
    out = off if end["wing_out_time"] is None else end["wing_out_time"] - true  # a fixed wing is out all along
    edges = {
        "launch": (0.0, LAUNCH),
        "detected": (launch["latency"], LAUNCH),
        "stroke": (0.05, off),
        "unfolding": (off, out + UNFOLDED),
        "climb": (out + UNFOLDED, out + CLIMB),
        "cruise": (out + CLIMB, np.inf),
    }
    aim = scenario_of(flight).flight_computer.airspeed
    flown = flight.truth["airspeed"].to_numpy()
    reached = flown[int(np.argmax(flown >= aim)) :]
    return Held(flight, rows, course(flight), edges, float(np.sqrt(np.mean((reached - aim) ** 2))))


@dataclass(frozen=True, slots=True)
class PhaseFigures:
    """Of all flights together in one phase: rms errors and the bound's, m/s; NEES; share within ±1.96 sd."""

    rmse: float
    raw: float
    bound: float
    nees: float
    coverage: float

    @property
    def ratio(self) -> float:
        """RMSE over the bound."""
        return self.rmse / self.bound

    @property
    def reduction(self) -> float:
        """By how much the RMSE is below that of the raw airspeed, %."""
        return 100.0 * (1.0 - self.rmse / self.raw)


def figures(flights: list[Held]) -> dict[str, PhaseFigures]:
    """Put an ensemble of flights of one scenario against its bound, phase by phase."""
    least_t, least = bound(flights[0].flight, together([f.course for f in flights]))
    found = {}
    for phase in PHASES:
        rows = np.concatenate([_part(f, phase) for f in flights])
        t, error, sd, raw = rows[np.isfinite(rows).all(axis=1)].T
        allowed = np.interp(t, least_t, least)
        found[phase] = PhaseFigures(
            rmse=_rms(error),
            raw=_rms(raw),
            bound=_rms(allowed),
            nees=float(np.mean((error / sd) ** 2)),
            coverage=float(np.mean(np.abs(error) <= NORMAL_95 * sd)),
        )
    return found


def paper_rmse(flights: list[Held], gain: float, phase: str = "launch") -> float:
    """RMSE of the published filter on the same readings, m/s, with a gain on the total pressure."""
    errors = []
    for held in flights:
        scenario = scenario_of(held.flight)
        draws = draw(scenario)
        settings = EstimatorSettings(kind="paper", gain_total=gain)
        estimator = PaperFilter(
            settings, believed_noise(scenario, draws.calibration), tare_window(scenario, draws.release_time)
        )
        true = held.flight.score["launch"]["true_time"]
        start, end = held.edges[phase]
        for row in held.flight.air_data.to_numpy().tolist():
            estimate = estimator.step(*row)
            if estimate is not None and start <= row[0] - true < end:
                errors.append((row[0], estimate[1], held.flight))
    return _rms(np.array([speed - float(true_airspeed(flight, np.array([t]))[0]) for t, speed, flight in errors]))


def _part(held: Held, phase: str) -> Array:
    start, end = held.edges[phase]
    return held.rows[(held.rows[:, 0] >= start) & (held.rows[:, 0] < end)]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
