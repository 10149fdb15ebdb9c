"""The air that a scenario asks for: weathers by name, what cannot be, and what deserves a word."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import uavsim
from uavsim.cosim import Cosimulation, replay
from uavsim.plants.air.weather import PRESETS
from uavsim.scenario import Scenario, load_scenario

WINDY = """
[environment]
wind_speed = 3.0
turbulence_wind_20ft = 3.0
humidity = 0.4
"""


def test_a_weather_says_what_nothing_else_says() -> None:
    air = Scenario.from_dict({"environment": {"preset": "moderate", "wind_speed": 14.0}}).environment
    assert air.wind_speed == 14.0
    assert air.turbulence_wind_20ft == pytest.approx(30 * 1852 / 3600, abs=1e-3)
    assert air.turbulence_severity == 4
    assert Scenario.from_dict({}).environment.preset == ""


def test_a_weather_that_is_asked_for_comes_before_what_the_file_says(tmp_path: Path) -> None:
    file = tmp_path / "windy.toml"
    file.write_text(WINDY)
    asked = load_scenario(file, overrides=["environment.preset=light"]).environment
    assert (asked.wind_speed, asked.humidity) == (PRESETS["light"].keys["wind_speed"], 0.4)  # light says no humidity
    assert load_scenario(file, overrides=['environment.preset="light"']).environment == asked
    later = load_scenario(file, overrides=["environment.preset=light", "environment.wind_speed=5"]).environment
    assert (later.wind_speed, later.turbulence_wind_20ft) == (5.0, asked.turbulence_wind_20ft)
    file.write_text(f'{WINDY}preset = "light"\n')
    assert load_scenario(file).environment.wind_speed == 3.0


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_every_weather_can_be_read_and_comes_back_from_its_record(name: str) -> None:
    scenario = Scenario.from_dict({"environment": {"preset": name}})
    assert Scenario.from_dict(scenario.to_dict()) == scenario
    assert PRESETS[name].source
    assert scenario.environment != Scenario().environment


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            "environment.preset=sever",
            "environment.preset = 'sever': is unknown; did you mean 'severe'? there are calm,",
        ),
        ("environment.ground_elevation=4001", "must be a number from -400 to 4000"),
        ("environment.ground_elevation=-401", "must be a number from -400 to 4000"),
        ("environment.sea_level_pressure=1013", "must be a number from 87000 to 108500"),
        ("environment.humidity=45", "must be a number from 0 to 1"),
        ("environment.turbulence_wind_20ft=26", "must be a number from 0 to 25"),
        ("environment.turbulence_model=dryden", "must be 'mil-f-8785c' or 'mil-hdbk-1797'"),
        ("environment.wind_profile=logarithmic", "must be 'log', 'power' or 'uniform'"),
        ("environment.gust_at=launch", "must be 'time', 'release', 'rail-exit'"),
        ("environment.gusts=[{speed=3,at='never'}]", "must be 'time', 'release', 'rail-exit'"),
        ("environment.gusts=[{sped=3}]", "unknown key 'sped' in environment.gusts[0]; did you mean 'speed'?"),
        ("environment.gusts=[{speed=16}]", "environment.gusts[0].speed = 16: must be a number from -15 to 15"),
    ],
)
def test_weather_that_cannot_be_is_refused_in_a_line(given: str, says: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        load_scenario("catapult", overrides=[given])
    assert says in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_the_logarithmic_law_has_wind_at_the_launcher() -> None:
    calm, windy = "environment.wind_speed=0", "environment.wind_speed=2"
    given = ["environment.roughness=1.9"]
    load_scenario("catapult", overrides=[*given, calm])
    load_scenario("catapult", overrides=[*given, windy, "launcher.height=2"])
    load_scenario("catapult", overrides=[*given, windy, "environment.wind_profile=power"])
    with pytest.raises(ValueError, match=r"environment.roughness = 1.9 m: must be below launcher.height = 1.5 m"):
        load_scenario("catapult", overrides=[*given, windy])


def test_wind_that_lifts_the_aircraft_off_its_rail_is_refused() -> None:
    """25 m/s at 20 ft under a folded aircraft that points up by 40° lift more than its 78 N of weight."""
    given = ["launcher.elevation_deg=40", "launcher.height=10", "environment.wind_speed=25"]
    with pytest.raises(
        ValueError, match=r"environment.wind_speed: the wind would lift the aircraft off the rail: \d+ N"
    ):
        Cosimulation(load_scenario("catapult", overrides=given))
    Cosimulation(load_scenario("catapult", overrides=[*given, "environment.wind_from_deg=90"]))  # beside its nose


def test_turbulence_of_another_wind_is_said_before_the_flight_and_kept(tmp_path: Path) -> None:
    command = [
        sys.executable, "-m", "uavsim.cli", "fly", "catapult", "--no-plots", "--out", str(tmp_path / "f"),
        "--set", "duration=5", "--set", "environment.turbulence_wind_20ft=8",
        "--set", 'environment.gusts=[{speed=2,at="time",delay=9}]',
    ]  # fmt: skip
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "Note: environment.turbulence_wind_20ft = 8 m/s is the turbulence of another wind" in found.stderr
    assert "never came" not in found.stderr
    said = " ".join(found.stdout.split())
    assert "never came: it was to begin at 9.00 s, and the flight ended at 5.00 s" in said
    remarks = json.loads((tmp_path / "f" / "score.json").read_text())["remarks"]
    assert [remark.split()[0] for remark in remarks if "rotation" not in remark] == [
        "environment.turbulence_wind_20ft",
        "the",
    ]
    flight = uavsim.load(tmp_path / "f")
    assert replay(flight).score["remarks"] == remarks


def test_wind_and_turbulence_that_agree_need_no_word() -> None:
    given = ["environment.wind_speed=6", "environment.turbulence_wind_20ft=6.5"]
    remarks = Cosimulation(load_scenario("catapult", overrides=given)).remarks
    assert [r for r in remarks if "rotation" not in r] == []


def test_a_rig_says_that_no_wind_reaches_it() -> None:
    (remark,) = Cosimulation(load_scenario("launch-curve", overrides=["environment.wind_speed=3"])).remarks
    assert remark == "plant.kind = 'launch-curve' is a rig: wind, turbulence and gusts do not reach it"
    assert Cosimulation(load_scenario("launch-curve")).remarks == []


def test_how_the_air_turns_is_not_an_aircrafts_property() -> None:
    with pytest.raises(ValueError, match=r"aircraft\.properties\.air/p-rad_sec: is how the air turns"):
        load_scenario("catapult", overrides=["aircraft.properties.air/p-rad_sec=1"])
