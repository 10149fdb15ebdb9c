"""The moving air in flights: what JSBSim is told is what acts, from the first row, on every field.

Authority: the air's own generator, which is held against the specification beside; definitions of the truth's columns.
"""

import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from references import dryden as specification

import uavsim
from uavsim.flight import Flight
from uavsim.plants.air.settings import EnvironmentSettings, GustSettings
from uavsim.plants.columns import FT
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.settings import LauncherSettings

RELEASE = 0.2  # s
Truth = dict[str, np.ndarray]


def plant_of(duration: float = 0.6, seed: int = 1, **environment: Any) -> JsbsimPlant:
    plant = JsbsimPlant(
        Run(EnvironmentSettings(**environment), LauncherSettings(), duration, RELEASE, random_seed=seed)
    )
    for _ in range(round(duration * 1000)):
        plant.step()
    return plant


def wind(truth: Any) -> np.ndarray:
    return np.column_stack([truth[f"wind_{axis}"] for axis in "ned"])


def turbulence(truth: Any) -> np.ndarray:
    """What is left of the wind without mean and gusts."""
    mean = np.column_stack([truth["mean_wind_n"], truth["mean_wind_e"], 0.0 * truth["mean_wind_n"]])
    return wind(truth) - mean - np.column_stack([truth[f"gust_{axis}"] for axis in "ned"])


@pytest.fixture(scope="module", params=[0.0, 8.0], ids=["still", "windy"])
def rough(request: pytest.FixtureRequest) -> Flight:
    return uavsim.fly(
        "catapult",
        seed=3,
        overrides=["environment.turbulence_wind_20ft=8", f"environment.wind_speed={request.param}", "duration=8"],
    )


def test_there_is_turbulence_from_the_first_row_on(rough: Flight) -> None:
    """With and without a mean wind, also at rest on the rail; it never stands still, and it does not jump.

    A millisecond changes it by a few cm/s: σ √(3 V τ/L) at 35 m/s and L_w = 3 m is 0.15 m/s.
    """
    found = turbulence(rough.truth)
    assert np.abs(found[0]).min() > 1e-6
    assert (np.abs(np.diff(found, axis=0)).max(axis=1) > 0.0).all()
    assert np.abs(np.diff(found, axis=0)).max() < 6 * 0.15
    assert rough.truth[["air_p", "air_q", "air_r"]].to_numpy()[0].all()
    mean = np.hypot(rough.truth["mean_wind_n"], rough.truth["mean_wind_e"])
    assert (mean > 4.0).all() or (mean == 0.0).all()


def test_declared_without_a_wind_it_is_remarked_on(rough: Flight) -> None:
    blows = rough.truth["mean_wind_n"].abs().max() > 0.0
    said = [
        line for line in rough.score["remarks"] if "turbulence_wind_20ft = 8 m/s is the turbulence of another" in line
    ]
    assert len(said) == (0 if blows else 1)


def test_on_the_rail_it_is_as_strong_as_the_law_says() -> None:
    """One value each of 50 seeds, at 1.5 m, where it is as at 10 ft: χ² at 1 % over three; a variance of 2 is seen."""
    environment = {"turbulence_wind_20ft": 8.0}
    found = np.array([turbulence(plant_of(0.01, seed, **environment).truth())[0] for seed in range(50)])
    air = specification.low(3.048, 8.0)
    findings = [
        specification.of_power(name, float(np.mean(values**2) / sd**2), len(values))
        for name, values, sd in zip("uvw", found.T, (air.sd_u, air.sd_v, air.sd_w), strict=True)
    ]
    assert specification.holm(findings) == []


@pytest.mark.parametrize("elevation", [-400.0, 1219.2, 3000.0])
def test_every_field_has_the_same_turbulence(elevation: float) -> None:
    """Same seed, at rest on the rail, until the release: to 1e-3 m/s, as what is felt at rest differs a little."""
    environment = {"turbulence_wind_20ft": 8.0, "wind_speed": 8.0}
    low = plant_of(0.2, **environment).truth()
    there = plant_of(0.2, ground_elevation=elevation, **environment).truth()
    assert wind(there) == pytest.approx(wind(low), abs=1e-3)
    for name in ("air_p", "air_q", "air_r"):
        assert there[name] == pytest.approx(low[name], abs=1e-3)
    assert np.ptp(wind(low)) > 0.1


def test_the_truth_is_what_was_told_to_jsbsim_and_acts_in_the_same_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each row's wind is what was written before the step that led to it; airspeed is the speed through that air."""
    plant = JsbsimPlant(
        Run(
            EnvironmentSettings(
                wind_speed=6.0, turbulence_wind_20ft=6.0, gusts=(GustSettings(3.0, "up", "step", "time", 0.1),)
            ),
            LauncherSettings(),
            0.6,
            RELEASE,
        )
    )
    told = []
    for _ in range(600):
        plant.step()
        told.append([plant._value(f"atmosphere/wind-{axis}-fps") * FT for axis in ("north", "east", "down")])
    truth = plant.truth()
    assert wind(truth)[1:] == pytest.approx(np.array(told), abs=1e-9)
    assert np.ptp(told, axis=0).min() > 0.1
    velocity = np.column_stack([truth["vn"], truth["ve"], truth["vd"]])
    assert truth["airspeed"] == pytest.approx(np.linalg.norm(velocity - wind(truth), axis=1), abs=1e-6)


def test_the_rotation_is_told_in_its_order() -> None:
    """What goes to the aircraft's three properties of the air's rotation is the truth of the row that follows."""
    environment = EnvironmentSettings(wind_speed=6.0, turbulence_wind_20ft=6.0)
    plant = JsbsimPlant(Run(environment, LauncherSettings(), 0.3, RELEASE))
    told: tuple[list[float], ...] = ([], [], [])
    plant._air_to[3:] = [each.append for each in told]
    for _ in range(300):
        plant.step()
    truth = plant.truth()
    for axis, each in zip("pqr", told, strict=True):
        assert np.array_equal(truth[f"air_{axis}"][1:], each)
        assert np.ptp(each) > 0.0


def test_what_it_turns_by_and_what_it_blows_come_from_one_place() -> None:
    """Truth less mean wind and gusts is the generator's turbulence: its own columns of p, q, r go with w and v.

    At rest on the rail q = −(w − m)·π/4b, so q is as −w at high frequencies: their steps correlate by −1.
    """
    truth = plant_of(0.2, turbulence_wind_20ft=8.0, wind_speed=8.0, wind_from_deg=180.0).truth()
    steps = np.diff(turbulence(truth), axis=0)
    assert np.corrcoef(steps[:, 2], np.diff(truth["air_q"]))[0, 1] < -0.99
    assert np.corrcoef(steps[:, 1], np.diff(truth["air_r"]))[0, 1] > 0.99


def test_the_mean_wind_is_that_of_the_height() -> None:
    """The truth's columns by MIL-F-8785C's formula at the aircraft's height of 20 ms before at most; 1 cm/s."""
    truth = plant_of(1.2, wind_speed=8.0, wind_from_deg=300.0).truth()
    asked = 8.0 * np.log(truth["altitude"] / 0.04572) / np.log(6.096 / 0.04572)
    speed = np.hypot(truth["mean_wind_n"], truth["mean_wind_e"])
    assert speed == pytest.approx(asked, abs=1e-2)
    assert np.ptp(asked) > 0.5
    assert truth["mean_wind_n"] / speed == pytest.approx(-0.5, abs=1e-9)
    assert truth["mean_wind_e"] / speed == pytest.approx(np.sqrt(0.75), abs=1e-9)


def test_without_turbulence_nothing_else_blows() -> None:
    truth = plant_of(0.6, wind_speed=8.0, wind_veer=20.0).truth()
    assert turbulence(truth) == pytest.approx(np.zeros((601, 3)), abs=1e-9)
    assert not np.column_stack([truth[f"air_{axis}"] for axis in "pqr"]).any()


def test_jsbsims_own_turbulence_is_off() -> None:
    """Kind 0, and its intensities have no say: a calm flight has no wind at all, whatever they are."""
    plant = plant_of(0.3)
    assert plant._value("atmosphere/turb-type") == 0.0
    assert not wind(plant.truth()).any()
    for axis in ("north", "east", "down"):
        assert plant._value(f"atmosphere/turb-{axis}-fps") == 0.0
        assert plant._value(f"atmosphere/gust-{axis}-fps") == 0.0
        assert plant._value("atmosphere/cosine-gust/magnitude-ft_sec") == 0.0


def test_a_gust_that_never_comes_is_in_the_score() -> None:
    flight = uavsim.fly("catapult", overrides=["environment.gust_speed=3", "environment.gust_delay=500", "duration=5"])
    assert [line for line in flight.score["remarks"] if "never came: it was to begin at" in line]


CODE = """
import sys
from uavsim.plants.air.moving import MovingAir, State
from uavsim.plants.air.settings import EnvironmentSettings
air = MovingAir(EnvironmentSettings(turbulence_wind_20ft=8.0, wind_speed=5.0, wind_veer=9.0), 0.0, 2.0, 1000.0, 40, 7)
for height in (2.0, 60.0, 450.0, 900.0):
    for row in air.ahead(State(height, 5.0, 32.0, 0.3, 0.1, 2.0)).tolist():
        print(*map(repr, row))
"""


def test_without_a_compiler_the_air_is_the_same() -> None:
    """In a process with NUMBA_DISABLE_JIT, plain Python: 1e-12."""
    found = []
    for off in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": off, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", CODE]
        printed = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
        found.append([[float(value) for value in line.split()] for line in printed.splitlines()])
    assert np.array(found[0]) == pytest.approx(np.array(found[1]), rel=1e-12, abs=1e-12)
    assert len(found[0]) == 80
