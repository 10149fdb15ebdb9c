"""The one loop that joins plant, sensors and onboard on one clock.

    plant --truth--> sensors --readings--> flight computer --commands--> plant

The plant, the aircraft in JSBSim or a rig, steps at its own interval. After each step every sensor whose sample is due
gives it, in the order of the time stamps (an accelerometer reading before a pressure reading of the same instant), and
the flight computer takes it; its commands act from the plant's next step on.
"""

import math
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from operator import attrgetter
from pathlib import Path
from struct import Struct
from typing import TYPE_CHECKING, Any
from weakref import proxy

from sensors import Accelerometer, AirDataHead, Streams, Vibration
from sensors.mounting import attitude, linear
from uavsim import __version__, airdata, part_range
from uavsim.beliefs import NO_CALIBRATION, Calibration, believed_air, believed_flow, believed_noise, calibrated
from uavsim.criteria import TOUCHED
from uavsim.dispersions import resolved
from uavsim.failure import FAILED, PartError, built
from uavsim.flight import Flight, frame, frame_of_floats, frame_of_rows
from uavsim.judged import Judged
from uavsim.onboard import airspeed, launch
from uavsim.onboard.flight_computer import FlightComputer
from uavsim.onboard.flow_through import FlowThrough, FlowThroughSettings
from uavsim.onboard.interface import AirReading, Estimate, Reading
from uavsim.onboard.launch.guarded import STATE, GuardedDetector
from uavsim.onboard.rail_offset import RailOffset
from uavsim.onboard.readiness import Readiness
from uavsim.plants.air.weather import moves
from uavsim.plants.guarded import GuardedPlant
from uavsim.plants.launchers.push import IDEAL
from uavsim.plants.plant import STEP_RATES, Plant, Run
from uavsim.scenario import Scenario, load_scenario, with_kinds
from uavsim.score import score
from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

CHUNK = 500  # steps between two looks at the progress
DETECTOR_LEAD = 1.0  # s before release from which the detector's state is recorded
DETECTOR_TRAIL = 0.1  # s after recognition until which it is
READING = Struct("4d")  # of the accelerometer: time stamp, s, and specific force, m/s²

Progress = Callable[[float], None]
"""Called now and then with the share of the flight that is done, 0 … 1."""


@dataclass(frozen=True, slots=True)
class Draws:
    """What a seed draws besides noise and sensor units."""

    release_time: float  # s
    force_factor: float
    plant_seed: int
    calibration: Calibration = NO_CALIBRATION
    """What a calibration of the units that fly found."""


def draw(scenario: Scenario, index: int | None = None) -> Draws:
    """Draw the launch of flight `index`, or the scenario's own, of the campaign `scenario.seed`.

    The latch lets go on a step of the coarsest rate, which is one of every other: all of them fly the same launch. The
    force factor is that of the specific force: the catapult is set for an aircraft of the mass that it should have.
    """
    streams = Streams(scenario.seed, scenario.index if index is None else index)
    launcher = scenario.launcher
    wait = streams("launcher.wait").uniform(launcher.wait_min, launcher.wait_max)
    spread = launcher.force_spread
    return Draws(
        release_time=round(wait * STEP_RATES[0]) / STEP_RATES[0],
        force_factor=float(streams("launcher.force").uniform(1.0 - spread, 1.0 + spread)) * scenario.push_factor,
        plant_seed=streams.integer("plant"),
        calibration=calibrated(scenario, streams),
    )


def shaken(scenario: Scenario, draws: Draws, plant: Plant) -> tuple[float, float]:
    """Specific force that the push comes to, m/s², 0 if nothing rings, and in which time, s."""
    launcher = scenario.launcher
    if not scenario.plant.chosen.rings or launcher.misfire:
        return 0.0, launcher.rise
    if launcher.kind == IDEAL:
        return launcher.peak_specific_force_g * STANDARD_GRAVITY * draws.force_factor, launcher.rise
    none: tuple[float, float] = (0.0, launcher.rise)  # somebody's plant that does not say what its machine does
    return getattr(plant, "shakes", none)


def tare_window(scenario: Scenario, release_time: float) -> airspeed.TareWindow | None:
    """When the tare is taken, s: by the crew's countdown it is over when the cover is off."""
    air = scenario.air_data
    end = release_time - air.cover_off
    return None if air.tare == "none" else (end - air.tare_duration, end)


class WatchedDetector:
    """A launch detector whose state is written down at each step from a given time on, as far as it tells it."""

    def __init__(self, detector: launch.Detector, record_from: float) -> None:
        self.detector = detector
        self.rows: list[tuple[Any, ...]] = []
        self._from = record_from
        tells_all = not isinstance(detector, GuardedDetector) and all(hasattr(detector, name) for name in STATE)
        self._state: Callable[[launch.Detector], Iterable[Any]] = attrgetter(*STATE) if tells_all else _told

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one reading; see the detector's own."""
        recognised = self.detector.step(t, fx, fy, fz)
        if t >= self._from:
            self.rows.append((t, *self._state(self.detector), recognised))
        return recognised

    def reset(self) -> None:
        """Forget everything and watch again."""
        self.detector.reset()


def _told(detector: launch.Detector) -> list[Any]:
    """Return the state that a detector tells of, None for the rest."""
    return [getattr(detector, name, None) for name in STATE]


@dataclass(frozen=True, slots=True)
class Believed:
    """What the onboard code of one flight is told before it: of sensors, air, and when the head is under its cover."""

    rate: float  # of the accelerometer, Hz
    noise: airspeed.NoiseModel
    air: airspeed.EstimatorSettings
    tare: airspeed.TareWindow | None
    flow: FlowThroughSettings | None
    """What is undone of a thermal differential sensor's readings; None: nothing."""


def believed(scenario: Scenario, release_time: float, calibration: Calibration) -> Believed:
    """What the onboard code of a scenario's flight believes."""
    return Believed(
        scenario.accelerometer.description().rate,
        believed_noise(scenario, calibration),
        believed_air(scenario, calibration),
        tare_window(scenario, release_time),
        believed_flow(scenario),
    )


class Onboard:
    """The flight computer of a scenario, fed with readings; keeps what it says.

    The same object serves the loop and the replay of recorded readings, so what a recording gives does not depend on
    which of the two it came from.

    Parameters
    ----------
    scenario
        Its flight computer, its launch's axis and how its accelerometer is mounted.
    told
        What is believed of sensors and air.
    detector
        Recognises the launch.
    release_time
        From when on a detection counts, s.
    """

    def __init__(self, scenario: Scenario, told: Believed, detector: launch.Detector, release_time: float) -> None:
        self._release_time = release_time
        self._detector = WatchedDetector(detector, release_time - DETECTOR_LEAD)
        self.computer = FlightComputer(
            scenario.flight_computer,
            self._detector,
            airspeed.build(told.air, told.noise, told.tare),
            told.rate,
            scenario.launch_axis,
            rail := RailOffset(told.noise),
            Readiness(told.noise, rail),
        )
        self.accelerometer = self._aligned(scenario.accelerometer.mounting_deg)
        self._flow = None if told.flow is None else FlowThrough(told.flow)
        self.estimates: list[Estimate] = []

    @classmethod
    def of(cls, scenario: Scenario, release_time: float, calibration: Calibration) -> "Onboard":
        """That of a scenario's flight."""
        told = believed(scenario, release_time, calibration)
        return cls(scenario, told, launch.build(scenario.detector, told.rate), release_time)

    def _aligned(self, mounting_deg: tuple[float, float, float]) -> Callable[[float, float, float, float], None]:
        """Return what takes a reading, turned from the case's axes as they are known into the body's."""
        take, turn = self.computer.accelerometer, linear(attitude(*mounting_deg))
        if turn is None:
            return take

        def turned(t: float, fx: float, fy: float, fz: float) -> None:
            take(t, *turn(fx, fy, fz))

        return turned

    def air_data(self, reading: AirReading) -> None:
        """Take one reading of the head."""
        if self._flow is not None:
            reading = self._flow.row(reading)
        estimate = self.computer.air_data(*reading)
        if estimate is not None:
            self.estimates.append(estimate)

    def read(self, readings: Sequence[Reading], air: Sequence[AirReading]) -> None:
        """Take what both sensors have read, in the order of the stamps."""
        next_air = 0
        for row in readings:
            while next_air < len(air) and air[next_air][0] < row[0]:
                self.air_data(air[next_air])
                next_air += 1
            self.accelerometer(*row)
        for reading in air[next_air:]:
            self.air_data(reading)

    def detections(self, times: "NDArray[np.float64]") -> list[tuple[Any, ...]]:
        """Return the detector's state from 1 s before release to recognition + 0.1 s, at all samples' `times`, s."""
        rows = self._detector.rows
        found = next((i for i, row in enumerate(rows) if row[-1] and row[0] >= self._release_time), None)
        if found is None:
            return rows
        t, *state, _ = rows[found]
        after = times[(times > t) & (times <= t + DETECTOR_TRAIL)]
        return rows[: found + 1] + [(float(later), *state, False) for later in after]


class Cosimulation:
    """One flight in the loop, advanced in steps of the plant.

    Parameters
    ----------
    scenario
        What to fly; its dispersions are drawn (`uavsim.dispersions`).
    plant
        Instead of the scenario's own; for tests.
    """

    def __init__(self, scenario: Scenario, plant: Plant | None = None) -> None:
        self.scenario = scenario = resolved(scenario, scenario.index)
        self.draws = draw(scenario)
        self.plant = make_plant(scenario, self.draws) if plant is None else plant
        streams = Streams(scenario.seed, scenario.index)
        release = self.draws.release_time
        self.dt = dt = 1.0 / scenario.plant.step_rate
        push, rise = shaken(scenario, self.draws, self.plant)
        self.vibration = Vibration(
            scenario.vibration,
            streams,
            dt=dt,
            release_time=release,
            plateau=push,
            rise=rise,
            scale=scenario.accelerometer.vibration_scale,
        )
        air = scenario.air_data
        around = proxy(self.plant)  # sensors hold themselves, and with them a plant, until the collector comes
        self.head = AirDataHead(
            air,
            streams,
            around,
            dt=dt,
            covered_until=release - air.cover_off if air.tare == "covered" else -math.inf,
        )
        self.accelerometer = Accelerometer.from_settings(
            scenario.accelerometer,
            streams,
            dt=dt,
            surroundings=around,
        )
        self.onboard = Onboard.of(scenario, release, self.draws.calibration)
        self.readings = array("d")  # flat, as the bytes of a table: neither the collector nor the end pays for floats
        self.air_readings = array("d")
        self.steps = round(scenario.duration * scenario.plant.step_rate)
        self.ended = self.reason = ""
        with self._told():
            self._begin()

    def advance(self, steps: int) -> None:
        """Fly up to `steps` plant steps; `ended` tells why it stopped early, `reason` more of it."""
        with self._told():
            self._advance(steps)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """End the flight where a part that is not ours fails."""
        try:
            yield
        except PartError as failure:
            self.ended, self.reason = FAILED, str(failure)

    def _advance(self, steps: int) -> None:
        plant, onboard, head = self.plant, self.onboard, self.head
        step, felt, sense, feel = (
            plant.step,
            self.vibration.on,
            self.accelerometer.step,
            head.feel if head.full else None,
        )
        keep, pack = self.readings.frombytes, READING.pack
        take, computer = onboard.accelerometer, onboard.computer
        on_rail, commands = plant.on_rail, computer.commands
        air: Sequence[AirReading]
        for _ in range(min(steps, self.steps - plant.k)):
            step()
            t = plant.t
            if not plant.aloft:
                self.ended = TOUCHED if plant.finite else "diverged"
                return
            force = felt(plant.force)
            if feel is not None:
                feel(t, force)
            readings = sense((t, force))
            air = head.step(t) if head.due <= t else ()
            for reading in readings:
                if air and air[0][0] < reading[0]:
                    air = self._take_air(air, reading[0])
                due, fx, fy, fz = reading  # `take(*reading)` costs twice as much
                keep(pack(due, fx, fy, fz))
                take(due, fx, fy, fz)
            if air:
                self._take_air(air, math.inf)
            if computer.commands is not commands:
                commands = computer.commands
                plant.command(commands)
            if on_rail and not plant.on_rail:
                on_rail = False
                self.vibration.leave_rail(t + self.dt)  # this step's has been felt
        if plant.k >= self.steps:
            self.ended = "completed" if plant.finite else "diverged"

    def _begin(self) -> None:
        """Let all that feel have the plant as it stands before its first step."""
        force = self.vibration.on(self.plant.force)
        if self.head.full:
            self.head.feel(self.plant.t, force)
        self.accelerometer.step((self.plant.t, force))

    def _take_air(self, rows: Sequence[AirReading], until: float) -> Sequence[AirReading]:
        """Hand on the rows with a time stamp before `until`; return the rest."""
        while rows and rows[0][0] < until:
            self.air_readings.extend(rows[0])
            self.onboard.air_data(rows[0])
            rows = rows[1:]
        return rows

    @property
    def remarks(self) -> list[str]:
        """What of plant and air deserves a word, a line each; at the end there may be more of it."""
        said = [*part_range.remark(self.scenario), *getattr(self.plant, "remarks", ())]
        kind = self.scenario.plant.chosen
        if not (kind.flies or kind.air) and moves(self.scenario.environment):
            said.append(
                f"plant.kind = {self.scenario.plant.kind!r} is a rig: wind, turbulence and gusts do not reach it"
            )
        return said

    def finish(self) -> Flight:
        """Turn what was recorded into a flight with its score."""
        return _flight(self)


def plant_settings(scenario: Scenario, draws: Draws) -> Run:
    """What the plant of a scenario's flight is told."""
    return Run(
        environment=scenario.environment,
        launcher=scenario.launcher,
        duration=scenario.duration,
        release_time=draws.release_time,
        force_factor=draws.force_factor,
        random_seed=draws.plant_seed,
        step_rate=scenario.plant.step_rate,
        aircraft=scenario.aircraft,
        accelerometer_position=scenario.accelerometer.position,
        head_position=scenario.air_data.position,
    )


def make_plant(scenario: Scenario, draws: Draws) -> Plant:
    """Make the plant of a scenario's flight.

    Raises
    ------
    ValueError
        An aircraft or property that does not exist; a rig that cannot be.
    """
    kind, run = scenario.plant.chosen, plant_settings(scenario, draws)
    if kind.ours:
        return kind.cls(scenario.plant.own, run)
    with built(f"plant {kind.name!r}"):
        return GuardedPlant(kind.name, kind.cls(scenario.plant.own, run), run)


def fly(
    scenario: "str | Path | Scenario" = "catapult",
    *,
    seed: int | None = None,
    overrides: Iterable[str] = (),
    detector: "str | type | None" = None,
    estimator: "str | type | None" = None,
    plant: "str | Callable[..., Plant] | None" = None,
    progress: Progress | None = None,
) -> Flight:
    """Fly a scenario.

    Parameters
    ----------
    scenario
        A packaged name, the path of a TOML file, or a `Scenario`.
    seed
        Instead of the scenario's own.
    overrides
        ``KEY=VALUE`` each; only with a name or path.
    detector, estimator, plant
        A registered name, or a class of one's own (`uavsim.plugins`), instead of the scenario's, with its own settings
        as they are by default. One that is not registered is registered by its class's name.
    progress
        Called now and then with the share that is done.

    Returns
    -------
    Flight
        With its tables, events and score, whatever the outcome.

    Raises
    ------
    ValueError
        One line that names file, key and what is allowed.
    """
    if not isinstance(scenario, Scenario):
        settings = load_scenario(scenario, overrides=overrides, seed=seed)
    else:
        settings = (scenario if seed is None else scenario.with_seed(seed)).checked()
    return flown(with_kinds(settings, detector=detector, estimator=estimator, plant=plant), progress)


def flown(scenario: Scenario, progress: Progress | None = None) -> Flight:
    """Fly a scenario that has been checked, as one that was read or is another's with another seed; else as `fly`."""
    simulation = Cosimulation(scenario)
    while not simulation.ended:
        simulation.advance(CHUNK)
        if progress is not None:
            progress(simulation.plant.k / simulation.steps)
    return simulation.finish()


def check_units(flight: Flight, scenario: Scenario) -> None:
    """Refuse a record whose temperatures are in degrees Celsius; ValueError, one line.

    A thermometer that was made to fail may say anything, and so may some readings of a whole one: it is the middle one
    that counts, of a thermometer without faults.
    """
    middle = float(flight.air_data["temperature"].median())  # NaN where there is none
    if middle < airdata.MIN_TEMPERATURE and not scenario.air_data.thermometer_faults:
        raise ValueError(f"air_data: temperature must be in K; half of it is below {middle:.4g}: degrees Celsius?")


def replay(flight: Flight) -> Flight:
    """Feed a flight's own readings through the same onboard code.

    Returns
    -------
    Flight
        Its events and estimates equal the flight's bit for bit; truth, where there is one, is handed through and
        scores them.

    Raises
    ------
    ValueError
        As of `check_units`.
    """
    scenario = Scenario.from_dict(flight.scenario)
    check_units(flight, scenario)
    draws = draw(scenario)
    onboard = Onboard.of(scenario, draws.release_time, draws.calibration)
    readings: list[Reading] = [(a, b, c, d) for a, b, c, d in flight.accelerometer.to_numpy().tolist()]
    air: list[AirReading] = [(a, b, c, d, e, f) for a, b, c, d, e, f in flight.air_data.to_numpy().tolist()]
    with suppress(PartError):  # which ended the flight, too
        onboard.read(readings, air)
    tables = dict(flight.tables)
    tables["estimate"] = frame_of_rows("estimate", onboard.estimates)
    tables["detector"] = frame_of_rows("detector", onboard.detections(flight.accelerometer["t"].to_numpy()))
    tables = {name: tables[name] for name in flight.tables}
    ended = flight.score.get("outcome", "")
    said = flight.score.get("reason") or ""
    judged = Judged(scenario, tables, onboard.computer.events, draws.release_time, ended, _versions(), said)
    kept = {name: flight.score[name] for name in ("remarks",) if name in flight.score}
    return Flight(scenario.to_dict(), _derived(judged), onboard.computer.events, score(judged) | kept)


def _flight(simulation: Cosimulation) -> Flight:
    plant, onboard = simulation.plant, simulation.onboard
    truth = plant.truth()
    if isinstance(plant, GuardedPlant) and plant.problem and not simulation.reason:
        simulation.ended, simulation.reason = FAILED, plant.problem
    accelerometer = frame_of_floats("accelerometer", simulation.readings)
    tables = {
        "accelerometer": accelerometer,
        "air_data": frame_of_floats("air_data", simulation.air_readings),
        "estimate": frame_of_rows("estimate", onboard.estimates),
        "detector": frame_of_rows("detector", onboard.detections(accelerometer["t"].to_numpy())),
    }
    judged = Judged(
        simulation.scenario,
        {"truth": truth, **tables},
        onboard.computer.events,
        simulation.draws.release_time,
        simulation.ended,
        _versions(),
        simulation.reason or plant.failure,
    )
    result = score(judged) | {"remarks": simulation.remarks}
    return Flight(simulation.scenario.to_dict(), _derived(judged), onboard.computer.events, result)


def _derived(judged: Judged) -> "dict[str, pd.DataFrame]":
    """Return the tables of what was judged, with the columns that follow from others."""
    tables = dict(judged.tables)
    if "truth" in tables:
        phase = {"phase": judged.phases(), **judged.true_airspeeds.columns()}
        tables["truth"] = frame("truth", {**tables["truth"], **phase})
    if "estimate" in tables:
        tables["estimate"] = tables["estimate"].assign(**judged.told_airspeeds.columns())
    return tables


@cache
def _versions() -> dict[str, str]:
    """Versions of what flies; a score takes a copy."""
    return {"uavsim": __version__, **{name: version(name) for name in ("jsbsim", "numpy", "scipy", "filterpy")}}
