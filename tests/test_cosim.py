"""The loop on real flights: one seed is one flight, onboard sees readings and nothing else, order and time hold."""

import gc
import hashlib
import itertools
import json
import math
import subprocess
import sys
import weakref
from collections.abc import Callable
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2, kstest

import uavsim
from sensors import Streams, Vibration
from uavsim import cosim
from uavsim.cosim import CHUNK, Cosimulation, Onboard, draw, plant_settings, replay
from uavsim.flight import UNITS, Flight
from uavsim.plants import columns
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Commands
from uavsim.scenario import Scenario, load_scenario
from uavsim.truth import FELT, STANDARD_GRAVITY

SHORT = "duration=7"  # s: release at 2-4 s, the wings are out and the motor runs 1 s later


def flown(simulation: Cosimulation) -> Flight:
    while not simulation.ended:
        simulation.advance(CHUNK)
    return simulation.finish()


def short(*overrides: str, seed: int = 1, scenario: str = "catapult") -> Scenario:
    return load_scenario(scenario, overrides=[SHORT, *overrides], seed=seed)


def resting(*overrides: str, wait: float = 2.0, seed: int = 1) -> Flight:
    """The wait on the rail alone, released 0.2 s before the record ends."""
    times = [f"launcher.wait_min={wait}", f"launcher.wait_max={wait}", f"duration={wait + 0.2}"]
    return uavsim.fly("catapult", seed=seed, overrides=[*times, *overrides])


def bits(table: pd.DataFrame) -> dict[str, bytes]:
    """Every column as it lies in memory: tells -0.0 from 0.0, and one NaN is the same as itself."""
    return {
        name: "\n".join(column).encode() if name == "phase" else column.to_numpy().tobytes()
        for name, column in table.items()
    }


def same(one: Flight, other: Flight, *tables: str) -> None:
    for name in tables or tuple(UNITS):
        assert bits(one.tables[name]) == bits(other.tables[name]), f"{name} differs"
    assert one.events == other.events


def column(flight: Flight, table: str, name: str) -> np.ndarray:
    return flight.tables[table][name].to_numpy()


def event(flight: Flight, name: str) -> float:
    (t,) = (e["t"] for e in flight.events if e["event"] == name)
    return float(t)


@pytest.fixture(scope="module")
def launch() -> Flight:
    """`catapult`, the first seven seconds."""
    return uavsim.fly(short())


# -- a seed is a flight ----------------------------------------------------------------------------------------------


def test_the_same_seed_is_the_same_flight_twice_in_one_process(launch: Flight) -> None:
    again = uavsim.fly("catapult", seed=1, overrides=[SHORT])
    same(launch, again)
    assert json.dumps(launch.score) == json.dumps(again.score)


DIGEST = """
import hashlib, json, sys, uavsim
flight = uavsim.fly(sys.argv[1], seed=1, overrides=["duration=7"])
digest = lambda t: hashlib.sha256(t.drop(columns="phase", errors="ignore").to_numpy(float).tobytes()).hexdigest()
print(json.dumps([flight.events, flight.score, {name: digest(t) for name, t in flight.tables.items()}]))
"""


@pytest.mark.parametrize("scenario", ["catapult", "gusty"])
def test_the_same_seed_is_the_same_flight_in_another_process(scenario: str) -> None:
    """Tables, events and score; `gusty` with turbulence."""
    other = subprocess.run([sys.executable, "-c", DIGEST, scenario], capture_output=True, text=True, check=True)
    flight = uavsim.fly(short(scenario=scenario))
    digests = {
        name: hashlib.sha256(table.drop(columns="phase", errors="ignore").to_numpy(float).tobytes()).hexdigest()
        for name, table in flight.tables.items()
    }
    assert json.loads(other.stdout) == json.loads(json.dumps([flight.events, flight.score, digests]))


THREADS = """
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from uavsim.cosim import flown
from uavsim.scenario import load_scenario
sys.setswitchinterval(1e-4)
scenarios = [load_scenario(name, overrides=["duration=4.5"]) for name in ("catapult", "gusty")] * 2
alone = [flown(scenario) for scenario in scenarios[:2]] * 2
with ThreadPoolExecutor(len(scenarios)) as threads:
    together = list(threads.map(flown, scenarios))
for one, other in zip(alone, together, strict=True):
    assert one.events == other.events and one.score == other.score
    assert all(table.equals(other.tables[name]) for name, table in one.tables.items())
print("the same")
"""


def test_flights_in_several_threads_are_what_each_is_alone_and_the_threads_ends_are_harmless() -> None:
    """JSBSim has a logger for each thread and lets go of it when that ends, without the interpreter's lock."""
    found = subprocess.run([sys.executable, "-c", THREADS], capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout) == (0, "the same\n"), found.stderr


def test_another_flight_before_it_changes_nothing(launch: Flight) -> None:
    """No state is left in the process: two flights that advance by turns are what each is alone."""
    one, other = Cosimulation(short()), Cosimulation(short(seed=2, scenario="gusty"))
    while not (one.ended and other.ended):
        one.advance(77)
        other.advance(130)
    same(one.finish(), launch)


def drawn(seed: int) -> dict[str, Any]:
    """All that a seed draws for `gusty`: the launch, the units, their clocks, and the first of every noise."""
    scenario = short(seed=seed, scenario="gusty")
    simulation = Cosimulation(scenario)
    accelerometer, head = simulation.accelerometer, simulation.head
    first = {"total": head.total.end, "static": head.static.end}
    vibration = Vibration(scenario.vibration, Streams(seed), dt=1e-3, release_time=2.0, plateau=80.0)
    simulation.advance(600)
    plant = simulation.plant.truth()
    draws = {
        "release": simulation.draws.release_time,
        "force": simulation.draws.force_factor,
        "turbulence seed": simulation.draws.plant_seed,
        "turbulence": plant["wind_n"][600],
        "vibration": vibration.step()[0],
        "accelerometer phase": accelerometer.phase,
        "poll phase": simulation.air_readings[0],
    }
    draws |= {f"bias {i}": b for i, b in enumerate(accelerometer.bias)}
    draws |= {f"scale {i}": s for i, s in enumerate(accelerometer.scale_error)}
    for name, sensor in (("total", head.total), ("static", head.static)):
        for what in ("offset", "scale_error", "rate_error", "temperature_offset"):
            draws[f"{name} {what}"] = getattr(sensor, what)
        draws[f"{name} first conversion"] = first[name]
        draws[f"{name} pressure"] = simulation.air_readings[6 * 40 + (1 if name == "total" else 2)]
    return draws


def test_two_seeds_differ_in_everything_that_a_seed_draws() -> None:
    """Only what the part does not have (its datasheet gives no spread) is 0, and so the same."""
    one, other = drawn(1), drawn(2)
    equal = {name for name in one if one[name] == other[name]}
    assert {name for name in equal if one[name] != 0.0} == set()
    assert all(name.endswith("scale_error") for name in equal)
    assert len({value for value in one.values() if value != 0.0}) == len(one) - len(equal)  # and no two are one draw
    again = drawn(1)
    assert one == again


def test_drawn_launches_are_evenly_spread() -> None:
    """200 seeds; wait in 2-4 s, force ±2 %: Kolmogorov-Smirnov, fails by chance once in 10⁴; sees 15 % of shift."""
    scenario = load_scenario("catapult")
    draws = [draw(scenario.with_seed(seed)) for seed in range(200)]
    wait = np.array([d.release_time for d in draws])
    force = np.array([d.force_factor for d in draws])
    assert wait.min() >= 2.0
    assert wait.max() <= 4.0
    assert kstest(wait, "uniform", args=(2.0, 2.0)).pvalue > 1e-4
    assert kstest(force, "uniform", args=(0.98, 0.04)).pvalue > 1e-4
    assert abs(np.corrcoef(wait, force)[0, 1]) < 0.28  # 4 standard deviations of 1/√200
    assert len({d.plant_seed for d in draws}) == 200
    assert np.array_equal(wait, np.round(wait, 3))


def test_a_flight_of_a_campaign_is_drawn_from_its_index() -> None:
    """Flight 0 is the seed's own; another index is another flight under the same seed."""
    scenario = load_scenario("catapult", seed=5)
    assert draw(scenario, 0) == draw(scenario)
    assert draw(scenario, 1) != draw(scenario)
    assert Cosimulation(replace(scenario, index=1)).accelerometer.bias != Cosimulation(scenario).accelerometer.bias


def test_the_force_that_was_drawn_is_the_force_that_flies(launch: Flight) -> None:
    """Plateau of the push over mass = 8 g times the draw, to 1e-6: push/(m g0), the specific force that it gives."""
    scenario = Scenario.from_dict(launch.scenario)
    mass = JsbsimPlant(plant_settings(scenario, draw(scenario))).truth()["mass"][0]
    plateau = column(launch, "truth", "catapult_force").max() / mass / STANDARD_GRAVITY
    assert plateau == pytest.approx(8.0 * draw(scenario).force_factor, rel=1e-6)


# -- replay ----------------------------------------------------------------------------------------------------------

WAYS: dict[str, tuple[str, ...]] = {  # a packaged scenario and what is changed of it
    "catapult": ("catapult",),
    "gusty": ("gusty",),
    "weak-launch": ("weak-launch",),
    "rough-rail": ("rough-rail",),
    "paper-filterpy": ("catapult", "estimator.kind=paper-filterpy"),
    "bernoulli": ("catapult", "estimator.model=bernoulli"),
    "tare in the open": ("catapult", "air_data.tare=open"),
    "no tare": ("catapult", "air_data.tare=none"),
    "ADXL345": ("catapult", "accelerometer.preset=adxl345"),
    "BMP581": ("catapult", "air_data.total.preset=bmp581", "air_data.static.preset=bmp581"),
    "a slow bus": ("catapult", "air_data.rate=20"),
    "a fast bus": ("catapult", "air_data.rate=1000"),
}


@pytest.mark.parametrize("way", WAYS)
def test_replay_of_its_own_readings_gives_the_flight(way: str, tmp_path: Path) -> None:
    """Events, estimate and detector bit for bit, from memory and from the disk; the files byte for byte."""
    scenario, *overrides = WAYS[way]
    flight = uavsim.fly(short(*overrides, scenario=scenario))
    same(replay(flight), flight)
    assert replay(flight).score == flight.score
    first = flight.save(tmp_path / "flight")
    again = replay(uavsim.load(first)).save(tmp_path / "again")
    for name in ("events.json", "estimate.parquet", "detector.parquet", "score.json"):
        assert (first / name).read_bytes() == (again / name).read_bytes()


def test_replay_of_a_flight_that_was_ended_says_how_it_ended() -> None:
    """Its truth alone does not tell: it stops, and no crash is in it."""
    vast = "aircraft.properties.metrics/Sw-sqft=1e9"
    flight = uavsim.fly("catapult", seed=1, overrides=["duration=5", vast])
    assert flight.score["outcome"] == "diverged"
    assert replay(flight).score == flight.score


def test_replay_needs_no_truth(launch: Flight) -> None:
    """Onboard is fed by readings alone: with another truth beside them its events and estimates are the same."""
    truth = launch.truth.copy()
    numbers = [name for name in truth if name not in ("t", "phase")]
    truth[numbers] = 0.0
    same(replay(Flight(launch.scenario, {**launch.tables, "truth": truth}, [], {})), launch, "estimate", "detector")


def test_a_record_in_degrees_celsius_is_refused_in_one_line(launch: Flight) -> None:
    """But a thermometer that was made to fail may say 15."""
    air = launch.air_data.copy()
    air["temperature"] -= 273.15
    with pytest.raises(ValueError, match=r"^air_data: temperature must be in K; .*: degrees Celsius\?$"):
        replay(Flight(launch.scenario, {**launch.tables, "air_data": air}, [], {}))
    failed = uavsim.fly(short('air_data.thermometer_faults=[{kind="dead",size=15}]'))
    same(replay(failed), failed)


def test_a_changed_reading_changes_the_replay(launch: Flight) -> None:
    """Without this the tests above could not fail."""
    air = launch.air_data.copy()
    air.loc[len(air) // 2, "p_total"] += 1.0
    again = replay(Flight(launch.scenario, {**launch.tables, "air_data": air}, [], {}))
    assert bits(again.estimate) != bits(launch.estimate)
    assert again.estimate["airspeed"].iloc[: len(air) // 2].equals(launch.estimate["airspeed"].iloc[: len(air) // 2])


def test_onboard_is_made_of_the_scenario() -> None:
    """It is told what to fly, when the crew will release and what the head's calibration gave, no more."""
    assert list(signature(Onboard.of).parameters) == ["scenario", "release_time", "calibration"]
    assert list(signature(Onboard.__init__).parameters) == ["self", "scenario", "told", "detector", "release_time"]


# -- the step --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [2000, 8000])
def test_a_finer_step_flies_the_same_launch(rate: int, launch: Flight) -> None:
    """Same release and sample times to the bit; speed off the rail to 0.05 %, tip-off to 0.5 %, latency to a sample."""
    flight = uavsim.fly(short(f"plant.step_rate={rate}"))
    truth = flight.truth
    assert len(truth) == 7 * rate + 1
    assert truth["t"].to_numpy()[:: rate // 1000].tobytes() == launch.truth["t"].to_numpy().tobytes()
    assert flight.score["launch"]["release_time"] == launch.score["launch"]["release_time"]
    for table in ("accelerometer", "air_data"):
        assert bits(flight.tables[table][["t"]]) == bits(launch.tables[table][["t"]])
    speed, coarse = (f.score["flight"]["rail_exit_speed"] for f in (flight, launch))
    assert speed == pytest.approx(coarse, rel=5e-4)
    assert _tip_off(flight) == pytest.approx(_tip_off(launch), rel=5e-3)
    period = 1.0 / Scenario().accelerometer.description().rate
    assert abs(flight.score["launch"]["latency"] - launch.score["launch"]["latency"]) < 0.9 * period
    same(replay(flight), flight)
    assert replay(flight).score == flight.score


def _tip_off(flight: Flight) -> float:
    row = np.searchsorted(column(flight, "truth", "t"), flight.score["flight"]["rail_exit_time"])
    return float(column(flight, "truth", "q")[row])


@pytest.mark.parametrize("scenario", ["wind-tunnel", "centrifuge-4g", "launch-curve"])
def test_rigs_take_the_step_that_they_are_told(scenario: str) -> None:
    coarse, fine = (uavsim.fly(scenario, overrides=[f"plant.step_rate={rate}"]) for rate in (1000, 2000))
    assert len(fine.truth) == 2 * len(coarse.truth) - 1
    assert fine.score["outcome"] == coarse.score["outcome"] == "completed"
    assert fine.score["launch"]["release_time"] == coarse.score["launch"]["release_time"]
    for name in ("fx", "fy", "fz"):
        one, other = column(coarse, "truth", name), column(fine, "truth", name)[::2]
        assert other == pytest.approx(one, abs=1e-6, nan_ok=True)


# -- poison ----------------------------------------------------------------------------------------------------------

READ_BY_THE_HEAD = (
    "mach", "p_static", "temperature", "airspeed", "alpha", "beta", "p", "q", "r", "cg_x", "cg_y", "cg_z",
    "throttle",
)  # fmt: skip
RAW = {name: i for i, name in enumerate(columns.RAW)}


class Poisoned(JsbsimPlant):
    """A plant that shows and records NaN in all but what sensors read; its own mechanics keep the truth."""

    spared: tuple[str, ...] = READ_BY_THE_HEAD

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(plant_settings(scenario, draw(scenario)))
        self._own = self.row
        self._columns = [i for name, i in RAW.items() if name not in self.spared]
        self._columns += range(len(RAW), len(RAW) + len(columns.OWN))

    def step(self) -> None:
        self.row = self._own
        super().step()
        self._own = self.row
        self.row = tuple(v if n in self.spared else math.nan for n, v in zip(RAW, self._own, strict=True))
        last = np.frombuffer(self._buffer, count=columns.ROW.size // 8, offset=self._size - columns.ROW.size)
        last[self._columns] = math.nan

    @property
    def finite(self) -> bool:
        """As the loop's ground check needs it."""
        return all(map(math.isfinite, self._own))


def steered(plant: JsbsimPlant, scenario: Scenario) -> tuple[list[float], list[float], list[Any], list[Any]]:
    simulation = Cosimulation(scenario, plant=plant)
    while not simulation.ended:
        simulation.advance(CHUNK)
    onboard = simulation.onboard
    return simulation.readings, simulation.air_readings, onboard.estimates, onboard.computer.events


@pytest.mark.parametrize("scenario", ["catapult", "gusty"])
def test_nan_in_every_truth_column_that_no_sensor_reads_changes_nothing(scenario: str) -> None:
    """Readings, estimates and events bit for bit (repr tells every bit of a float)."""
    settings = short(scenario=scenario)
    clean = steered(JsbsimPlant(plant_settings(settings, draw(settings))), settings)
    poisoned = Poisoned(settings)
    assert repr(steered(poisoned, settings)) == repr(clean)
    shown = {name for name, values in poisoned.truth().items() if np.isfinite(values[1:]).all()}
    assert shown >= {"cg_x", "cg_y", "cg_z"}  # where it is, and not a column of a flight
    shown -= {"cg_x", "cg_y", "cg_z"}
    shown -= {name for name in shown if name.startswith(("mean_wind_", "gust_", "air_"))}  # the air's own record
    assert shown == {"t", "throttle", *FELT} - {
        "fx",
        "fy",
        "fz",
    }  # the force is handed on as it is felt, not by the record
    assert clean[3][-1]["event"] == "motor_on"


@pytest.mark.parametrize("lost", READ_BY_THE_HEAD)
def test_nan_in_a_column_that_the_head_reads_is_noticed(lost: str) -> None:
    """Without this the test above could not fail."""
    settings = short()

    class Blind(Poisoned):
        spared = tuple(name for name in READ_BY_THE_HEAD if name != lost)

    clean = steered(JsbsimPlant(plant_settings(settings, draw(settings))), settings)
    assert repr(steered(Blind(settings), settings)[1]) != repr(clean[1])


# -- filterpy --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scenario", ["catapult", "gusty"])
def test_filterpy_gives_the_same_estimates_from_the_same_readings(scenario: str) -> None:
    """To 1e-9 of a metre per second, and of the pressure 1e-12; in the loop the scalar form flies."""
    flight = uavsim.fly(short("estimator.kind=paper", scenario=scenario))
    other = short("estimator.kind=paper-filterpy", scenario=scenario)
    again = replay(Flight(other.to_dict(), flight.tables, [], {}))
    assert again.events == flight.events
    for name in ("airspeed", "airspeed_sd", "airspeed_raw"):
        np.testing.assert_allclose(column(again, "estimate", name), column(flight, "estimate", name), rtol=0, atol=1e-9)
    for name in ("p_total", "p_static"):
        np.testing.assert_allclose(column(again, "estimate", name), column(flight, "estimate", name), rtol=1e-12)
    assert np.array_equal(column(again, "estimate", "valid"), column(flight, "estimate", "valid"))


def test_filterpy_flies_in_the_loop() -> None:
    """The rounding of 1e-9 goes round the loop; after seven seconds it is still no more than 1e-6 m/s."""
    launch = uavsim.fly(short("estimator.kind=paper"))
    flight = uavsim.fly(short("estimator.kind=paper-filterpy"))
    assert [e["event"] for e in flight.events] == [e["event"] for e in launch.events]
    difference = column(flight, "estimate", "airspeed") - column(launch, "estimate", "airspeed")
    assert np.abs(difference).max() < 1e-6


# -- one clock -------------------------------------------------------------------------------------------------------


def test_sample_times_are_phase_plus_k_over_rate(launch: Flight) -> None:
    """Exactly, with nothing accumulated; the phase lies in the first period; none is missing to the end."""
    scenario = Scenario.from_dict(launch.scenario)
    end = column(launch, "truth", "t")[-1]
    for table, rate in (("accelerometer", scenario.accelerometer.description().rate), ("air_data", 100.0)):
        t = column(launch, table, "t")
        assert 0.0 <= t[0] < 1.0 / rate
        assert t.tolist() == [t[0] + k / rate for k in range(t.size)]
        assert end - 1.0 / rate < t[-1] <= end
    assert Cosimulation(scenario).accelerometer.phase == column(launch, "accelerometer", "t")[0]


@pytest.mark.parametrize("channel", ["total", "static"])
def test_conversions_run_on_their_own_clocks(launch: Flight, channel: str) -> None:
    """Ends of conversion k/rate after the first by the unit's own oscillator; the newest finished one is read."""
    unit = getattr(Cosimulation(Scenario.from_dict(launch.scenario)).head, channel)
    rate = unit.description.rate * (1.0 + unit.rate_error)
    polled, end = column(launch, "air_data", "t"), column(launch, "air_data", f"t_{channel}")
    known = np.isfinite(end)
    assert known.sum() >= known.size - 3
    periods = (end[known] - unit.end) * rate
    np.testing.assert_allclose(periods, np.round(periods), atol=1e-9)
    age = (polled[known] - end[known]) * rate
    assert age.min() >= 0.0
    assert age.max() < 1.0


def test_replay_hands_on_the_readings_in_the_order_of_the_flight(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is recorded today would not show it, but a computer that joins both kinds of readings would."""
    orders: list[list[tuple[float, int]]] = []

    class Watched(Onboard):
        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            order: list[tuple[float, int]] = []
            orders.append(order)
            take, take_air = self.accelerometer, self.air_data
            self.accelerometer = lambda *r: (order.append((r[0], 0)), take(*r))[1]
            self.air_data = lambda r: (order.append((r[0], 1)), take_air(r))[1]

    monkeypatch.setattr(cosim, "Onboard", Watched)
    replay(uavsim.fly(short()))
    assert len(orders[0]) > 6000
    assert orders[0] == orders[1]


@pytest.mark.parametrize("rate", [100.0, 1000.0])
def test_readings_reach_onboard_in_the_order_of_their_time_stamps(rate: float) -> None:
    simulation = Cosimulation(short(f"air_data.rate={rate}"))
    onboard, order = simulation.onboard, []

    def watched(kind: int, take: Callable[..., None]) -> Callable[..., None]:
        def step(*reading: Any) -> None:
            order.append((reading[0][0] if kind else reading[0], kind, simulation.plant.t))
            take(*reading)

        return step

    onboard.accelerometer = watched(0, onboard.accelerometer)
    onboard.air_data = watched(1, onboard.air_data)
    flight = flown(simulation)
    assert len(order) == len(flight.accelerometer) + len(flight.air_data)
    assert order == sorted(order)  # an accelerometer reading before a pressure reading of the same instant
    assert all(step - 1.0 / 1000.0 < stamp <= step for stamp, _, step in order)  # within the step that made it due


class Taped(JsbsimPlant):
    """Keeps the commands it was given, with the time at which they were."""

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(plant_settings(scenario, draw(scenario)))
        self.tape: list[tuple[float, tuple[float, ...]]] = []

    def command(self, commands: Commands) -> None:
        self.tape.append((self.t, commands))
        super().command(commands)


def test_commands_act_after_the_reading_that_caused_them() -> None:
    """Given within the plant step in which the reading was due, and seen in the truth from the next step on only."""
    scenario = short()
    plant = Taped(scenario)
    flight = flown(Cosimulation(scenario, plant=plant))
    t = column(flight, "truth", "t")
    for name, place, table in (("wings_commanded", 0, "wing"), ("motor_on", 1, "throttle")):
        noticed = event(flight, name)
        given = next(time for time, commands in plant.tape if commands[place] > 0.0)
        moved = t[np.argmax(column(flight, "truth", table) > 0.0)]
        assert noticed <= given < noticed + 1e-3
        assert given < moved < given + 0.05
    stroke_end = event(flight, "stroke_end")
    assert next(time for time, commands in plant.tape if commands[4] == 1.0) == pytest.approx(stroke_end, abs=1e-3)


def test_estimates_are_those_of_the_readings(launch: Flight) -> None:
    assert np.array_equal(column(launch, "estimate", "t"), column(launch, "air_data", "t"))


# -- the record ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fixture", ["catapult", "weak_launch"])
def test_the_detectors_table_is_around_the_launch(fixture: str, request: pytest.FixtureRequest) -> None:
    """Every sample from 1 s before release to recognition + 0.1 s; to the end if there is none."""
    flight: Flight = request.getfixturevalue(fixture)
    release, detected = flight.score["launch"]["release_time"], flight.score["launch"]["detected_time"]
    t = column(flight, "accelerometer", "t")
    last = math.inf if detected is None else detected + 0.1
    assert np.array_equal(column(flight, "detector", "t"), t[(t >= release - 1.0) & (t <= last)])
    recognised = flight.detector[flight.detector["recognised"].astype(bool)]
    assert recognised["t"].tolist() == ([] if detected is None else [detected])
    total, count = column(flight, "detector", "total"), column(flight, "detector", "count")
    assert np.all(count <= total)
    assert np.all((total == 0) == (column(flight, "detector", "level") == 0))


def test_the_detectors_count_is_that_of_the_readings() -> None:
    """From the last trigger to recognition: samples since, and those of them above the threshold, counted anew."""
    flight = uavsim.fly("catapult", seed=1, overrides=["detector.kind=multi-level-window", "duration=6"])
    scenario = Scenario.from_dict(flight.scenario)
    table, detected = flight.detector, flight.score["launch"]["detected_time"]
    at = table[table["t"] == detected].iloc[0]
    readings = flight.accelerometer[flight.accelerometer["t"] <= detected].tail(int(at["total"]))
    above = readings["fx"] > scenario.detector.threshold
    assert above.sum() == at["count"]
    assert above.iloc[0]
    window = round(scenario.detector.window * scenario.accelerometer.description().rate)
    assert at["total"] == window * at["level"]
    assert at["count"] / at["total"] >= scenario.detector.ratio


def test_truth_says_its_phases(catapult: Flight) -> None:
    truth, launch, flight = catapult.truth, catapult.score["launch"], catapult.score["flight"]
    assert [name for name, _ in itertools.groupby(truth["phase"])] == ["rail", "stroke", "transition", "cruise"]
    first = truth.groupby("phase")["t"].min()
    assert launch["true_time"] + 0.05 <= first["stroke"] < launch["true_time"] + 0.0511
    assert first["transition"] == flight["rail_exit_time"]
    assert flight["wing_out_time"] + 2.0 <= first["cruise"] < flight["wing_out_time"] + 2.0011


def test_tables_have_the_columns_of_the_contract(catapult: Flight) -> None:
    for name, table in catapult.tables.items():
        assert list(table.columns) == list(UNITS[name])
        assert np.all(np.diff(table["t"]) > 0.0)
        told = [column for column in table.select_dtypes("number") if not column.startswith("nis")]
        numbers = table[told].to_numpy()  # a reading that is not taken has no innovation
        assert np.isfinite(numbers[5:]).all()  # before the first conversion is finished a pressure is NaN


def test_times_of_the_score_are_those_of_the_truth(catapult: Flight) -> None:
    truth, launch = catapult.truth, catapult.score["launch"]
    assert launch["release_time"] == draw(Scenario.from_dict(catapult.scenario)).release_time
    assert truth["catapult_force"][truth["t"] < launch["release_time"]].max() == 0.0
    assert truth["catapult_force"][truth["t"] >= launch["release_time"]].iloc[0] > 0.0  # of the step that begins there
    moved = truth[(truth["rail_s"] > 1e-3) & (truth["t"] >= launch["release_time"])]
    assert launch["true_time"] == moved["t"].iloc[0]
    assert launch["crossing_time"] == truth["t"][truth["fx"] > 4.5 * STANDARD_GRAVITY].iloc[0]
    assert launch["detected_time"] == event(catapult, "launch_detected")
    assert 0.0 < launch["latency"] < 0.1


# -- what happens ----------------------------------------------------------------------------------------------------


def test_catapult_cruises(catapult: Flight) -> None:
    assert catapult.score["outcome"] == "cruise"
    done = [e["event"] for e in catapult.events]
    assert done == ["ready", "launch_detected", "stroke_end", "wings_commanded", "motor_on"]
    late = event(catapult, "wings_commanded") - catapult.score["flight"]["rail_exit_time"]
    assert 0.0 < late <= 0.3


@pytest.mark.parametrize("wind", ["environment.wind_speed=6", "environment.wind_speed=0"])
def test_under_the_cover_the_airspeed_is_0_and_invalid(wind: str) -> None:
    """Until 0.5 s before release, wind or not; then the wind is seen."""
    flight = resting(wind, wait=3.0)
    release = flight.score["launch"]["release_time"]
    e = flight.estimate
    covered = e[e["t"] <= release - 0.5]
    assert len(covered) == pytest.approx(250, abs=1)
    assert (covered["airspeed"] == 0.0).all()
    assert not covered["valid"].any()
    assert (covered["airspeed_sd"] == 3.0).all()
    seen = e[(e["t"] > release - 0.45) & (e["t"] <= release)]
    if wind.endswith("=6"):
        assert seen["airspeed"].mean() == pytest.approx(4.28, abs=0.5)  # 6 m/s at 20 ft, by the law at 1.5 m
    else:
        assert (seen["airspeed"] > 0.0).any()
        assert not seen["valid"].any()


def test_the_tare_takes_the_pairs_difference_off() -> None:
    """200 Pa between the two sensors: without a tare 18 m/s at rest, with it next to nothing."""
    apart = "air_data.total.offset_pa=200"
    speed = {}
    for tare in ("covered", "open", "none"):
        flight = uavsim.fly(short(apart, f"air_data.tare={tare}"))
        e, release = flight.estimate, flight.score["launch"]["release_time"]
        speed[tare] = e["airspeed_raw"][(e["t"] > release - 0.45) & (e["t"] <= release + 0.005)]
        if tare != "none":
            rest = flight.score["airspeed"]["transition"]
            assert abs(rest["bias"]) < 0.3
    assert speed["none"].mean() > 10.0
    assert speed["covered"].mean() < 4.0


def test_a_missed_launch_leaves_the_wings_folded_and_the_motor_off(weak_launch: Flight) -> None:
    assert weak_launch.score["outcome"] == "missed_launch"
    assert {e["event"] for e in weak_launch.events} <= {"ready", "not_ready"}
    assert column(weak_launch, "truth", "wing").max() == 0.0
    assert column(weak_launch, "truth", "throttle").max() == 0.0


def test_a_push_of_6_g_turns_the_weak_launch_into_cruise() -> None:
    flight = uavsim.fly("weak-launch", overrides=["launcher.peak_specific_force_g=6"])
    assert flight.score["outcome"] == "cruise"


def test_the_weak_launch_is_one_of_4_g(weak_launch: Flight) -> None:
    """4.0 ± 0.1 g of true specific force, rail gravity included, for at least 0.2 s."""
    force = column(weak_launch, "truth", "fx") / STANDARD_GRAVITY
    assert force.max() == pytest.approx(4.0, abs=0.1)
    assert (force > 3.9).sum() >= 200


def knocked(flight: Flight, at: float, level: float = 10.0, duration: float = 0.06) -> Flight:
    """The same readings with a knock added along body x."""
    readings = flight.accelerometer.copy()
    during = (readings["t"] >= at) & (readings["t"] < at + duration)
    readings.loc[during, "fx"] += level * STANDARD_GRAVITY
    return replay(Flight(flight.scenario, {**flight.tables, "accelerometer": readings}, [], {}))


def test_a_knock_on_the_rail_does_not_open_the_wings(catapult: Flight) -> None:
    """10 g for 60 ms, 1.8 s before release: recognised, no launch, watching again a second later, then the launch."""
    launch = catapult.score["launch"]
    at = launch["release_time"] - 1.8
    flight = knocked(catapult, at)
    done = [e for e in flight.events if e["event"] not in ("ready", "not_ready")]
    assert [e["event"] for e in done] == [
        "launch_detected", "not_a_launch", "rearmed", "launch_detected", "stroke_end", "wings_commanded", "motor_on"
    ]  # fmt: skip
    times = [e["t"] for e in done]
    assert at < times[0] < at + 0.06
    assert done[1]["speed_gain"] < 10.0
    assert times[1] < at + 0.12
    assert times[2] - times[1] == pytest.approx(1.0, abs=0.002)
    assert times[3] == launch["detected_time"]
    assert flight.score["outcome"] == "cruise"
    assert flight.score["launch"]["false_detections"] == 1
    assert flight.score["launch"]["latency"] == launch["latency"]


def test_a_knock_just_before_release_costs_the_launch(catapult: Flight) -> None:
    """Within the second of rearming nobody watches: what it costs is told as a missed launch."""
    flight = knocked(catapult, catapult.score["launch"]["release_time"] - 0.3)
    assert flight.score["outcome"] == "missed_launch"
    assert "wings_commanded" not in [e["event"] for e in flight.events]


class Deaf(JsbsimPlant):
    """Obeys no command: wings folded, no motor."""

    def command(self, commands: Commands) -> None:
        pass


def test_a_crash_ends_the_flight_and_is_a_result() -> None:
    scenario = load_scenario("catapult")
    flight = flown(Cosimulation(scenario, plant=Deaf(plant_settings(scenario, draw(scenario)))))
    assert flight.score["outcome"] == "crashed"
    assert flight.score["reason"].startswith(f"touched the ground at {column(flight, 'truth', 't')[-1]:.2f} s: sink ")
    assert column(flight, "truth", "altitude")[-1] <= 0.0
    assert column(flight, "truth", "altitude")[:-1].min() > 0.0
    assert flight.score["flight"]["duration"] < 10.0
    json.dumps(flight.score, allow_nan=False)


def test_a_diverged_flight_is_a_result_with_what_was_flown() -> None:
    """The wind becomes NaN at 5 s, and with it the state a step later."""
    scenario = short(scenario="catapult")

    class Diverging(JsbsimPlant):
        def step(self) -> None:
            if self.k == 5000:
                self._set("atmosphere/wind-north-fps", math.nan)
            super().step()

    flight = flown(Cosimulation(scenario, plant=Diverging(plant_settings(scenario, draw(scenario)))))
    assert flight.score["outcome"] == "diverged"
    assert 5.0 <= flight.score["flight"]["duration"] <= 5.01
    assert flight.score["airspeed"]["stroke"]["rmse"] is not None
    json.dumps(flight.score, allow_nan=False)


# -- assumptions about noise and bias --------------------------------------------------------------------------------

QUIET = ("accelerometer.vibration_scale=0",)


def spread(flight: Flight, table: str, name: str) -> float:
    return float(column(flight, table, name)[3:].std(ddof=1))


def interval(samples: int) -> tuple[float, float]:
    """Range of a ratio of two independent standard deviations of white noise, all but once in 10⁵ (two-sided each)."""
    low, high = (chi2.ppf(p, samples - 1) / (samples - 1) for p in (2.5e-6, 1 - 2.5e-6))
    return math.sqrt(low / high), math.sqrt(high / low)


@pytest.mark.parametrize("scale", [0.0, 4.0])
def test_accelerometer_noise_scale(scale: float) -> None:
    """Waiting, without vibration: the noise is `scale` times the part's; at 0 only rounding is left."""
    part = Scenario().accelerometer.description()
    flight = resting(*QUIET, f"accelerometer.noise_scale={scale}")
    rest = flight.accelerometer[flight.accelerometer["t"] < 2.0]
    if scale == 0.0:
        assert np.ptp(rest["fy"]) <= 2.0 * part.resolution
    else:
        low, high = interval(len(rest))
        noise = math.hypot(scale * part.noise_sd[1], part.resolution / math.sqrt(12.0))
        assert low < rest["fy"].std() / noise < high


def test_accelerometer_bias_is_added() -> None:
    """On all axes or on each its own; to a digit of the part, as rounding may fall either way."""
    step = Scenario().accelerometer.description().resolution
    plain = resting()
    for text, bias in (("1.5", (1.5, 1.5, 1.5)), ("[0.5, -1.0, 2.0]", (0.5, -1.0, 2.0))):
        biased = resting(f"accelerometer.bias={text}")
        for name, offset in zip(("fx", "fy", "fz"), bias, strict=True):
            difference = column(biased, "accelerometer", name) - column(plain, "accelerometer", name)
            rest = column(plain, "accelerometer", "t") < 2.0
            assert np.abs(difference[rest] - offset).max() <= step * 1.0001


def test_vibration_scale_is_a_factor_on_all_vibration() -> None:
    """With no noise, the shaking that is left after rounding is twice that of scale 1, to a digit of the part."""
    step = Scenario().accelerometer.description().resolution
    readings = {}
    for scale in (0, 1, 2):
        flight = resting("accelerometer.noise_scale=0", f"accelerometer.vibration_scale={scale}")
        readings[scale] = column(flight, "accelerometer", "fy")
    one, two = readings[1] - readings[0], readings[2] - readings[0]
    assert np.abs(two - 2.0 * one).max() <= 3.0 * step
    assert one[:1500].std() == pytest.approx(0.05 * STANDARD_GRAVITY, rel=0.15)


def test_vibration_is_that_of_the_phase() -> None:
    """1 g rms in one phase at a time, seen along y: until release, until the rail's end, after; and nowhere else."""
    phases = ("waiting", "stroke", "flight")
    for shaken in phases:
        levels = [f"vibration.{phase}_rms_g={int(phase == shaken)}" for phase in phases]
        flight = uavsim.fly(short(*levels, "vibration.ring_fraction=0"))
        times, t = flight.score["launch"], column(flight, "accelerometer", "t")
        release, end = times["release_time"], flight.score["flight"]["rail_exit_time"]
        true = np.interp(t, column(flight, "truth", "t"), column(flight, "truth", "fy"))
        felt = column(flight, "accelerometer", "fy") - true
        spans = {"waiting": (0.0, release), "stroke": (release + 0.01, end), "flight": (end + 0.5, end + 2.0)}
        for phase, (first, last) in spans.items():
            rms = felt[(t >= first) & (t < last)].std() / STANDARD_GRAVITY
            assert 0.6 < rms < 1.2 if phase == shaken else rms < 0.1


def shaken(*overrides: str) -> tuple[Flight, np.ndarray, np.ndarray]:
    """A flight without a sensor's errors, its sample times and what it felt along y beside the true force, g."""
    ideal = ("noise_scale=0", "errors.bandwidth=false", 'unit="ideal"')
    flight = uavsim.fly(short("vibration.ring_fraction=0", *(f"accelerometer.{key}" for key in ideal), *overrides))
    t = column(flight, "accelerometer", "t")
    true = np.interp(t, column(flight, "truth", "t"), column(flight, "truth", "fy"))
    return flight, t, (column(flight, "accelerometer", "fy") - true) / STANDARD_GRAVITY


def test_the_rails_vibration_ends_with_the_rail() -> None:
    """1 g rms in the stroke alone: felt until the last shoe is off, and gone from the second step after it on."""
    flight, t, felt = shaken("vibration.waiting_rms_g=0", "vibration.flight_rms_g=0", "vibration.stroke_rms_g=1")
    end = flight.score["flight"]["rail_exit_time"]
    assert felt[(t >= end - 0.05) & (t < end)].std() > 0.3
    assert np.abs(felt[(t > end + 0.002) & (t < end + 0.04)]).max() < 1e-3


def test_a_vibration_that_is_alike_in_all_phases_does_not_notice_the_rails_end() -> None:
    """It goes on with the row of the next step: as in a launch that does not leave the rail, to a digit of the part."""
    alike = [f"vibration.{phase}_rms_g=0.5" for phase in ("waiting", "stroke", "flight")]
    flight, t, felt = shaken(*alike)
    held, _, there = shaken(*alike, "launcher.peak_specific_force_g=0.1")
    end = flight.score["flight"]["rail_exit_time"]
    assert held.score["flight"]["rail_exit_time"] is None
    after = (t > end - 0.1) & (t < end + 0.1)
    assert felt[after].std() > 0.3
    digit = Scenario().accelerometer.description().resolution / STANDARD_GRAVITY
    assert np.abs(felt[: there.size] - there[: felt.size])[after].max() < 2.0 * digit


@pytest.mark.parametrize("channel", ["total", "static"])
def test_pressure_noise_scale_and_offset(channel: str) -> None:
    """Of this channel alone; the other's readings stay what they were."""
    name, other = f"p_{channel}", "p_static" if channel == "total" else "p_total"
    plain = resting()
    scaled = resting(f"air_data.{channel}.noise_scale=5")
    part = Scenario().air_data.total.description()
    low, high = interval(len(plain.air_data) - 3)
    assert low < spread(scaled, "air_data", name) / (5.0 * part.noise_sd) < high
    assert bits(scaled.air_data[[other]]) == bits(plain.air_data[[other]])
    moved = resting(f"air_data.{channel}.offset_pa=250")
    difference = column(moved, "air_data", name)[3:] - column(plain, "air_data", name)[3:]
    assert np.abs(difference - 250.0).max() <= part.resolution * 1.0001
    assert bits(moved.air_data[[other]]) == bits(plain.air_data[[other]])


def test_a_noisier_head_is_believed_to_be_noisier() -> None:
    """One description serves unit and filter: five times the noise, a wider band, and a lower gain."""
    plain, scaled = (resting(f"air_data.{c}.noise_scale={s}", wait=2.0) for c, s in (("total", 1), ("total", 5)))
    wide = [f.estimate["airspeed_sd"].iloc[-25:].mean() for f in (plain, scaled)]
    assert wide[1] > wide[0]


@pytest.mark.parametrize("scenario", ["catapult", "gusty"])
def test_a_plant_goes_with_its_flight_and_does_not_wait_for_the_collector(scenario: str) -> None:
    """Its record takes 300 B a step: flights of a campaign that are over must not add up."""
    simulation = Cosimulation(short("duration=4.5", scenario=scenario))
    plant = weakref.ref(simulation.plant)
    gc.collect()
    gc.disable()
    try:
        flight = flown(simulation)
        del simulation
        assert plant() is None
    finally:
        gc.enable()
    assert flight.truth["t"].iloc[-1] == 4.5


def test_force_of_the_launcher_is_a_key() -> None:
    flight = uavsim.fly(short("launcher.peak_specific_force_g=6", "launcher.force_spread=0"))
    assert column(flight, "truth", "fx").max() / STANDARD_GRAVITY == pytest.approx(6.0, abs=0.05)
