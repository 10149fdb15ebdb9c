"""Dispersions: what is drawn, by what, and how a flight of a campaign becomes a scenario of its own.

Authorities: the distributions' own functions in scipy.stats, by the test of Kolmogorov and Smirnov; Fisher's z for a
coefficient of correlation. Each says how many draws it takes and how often chance alone would fail it; seeds are fixed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.special import ndtr, ndtri

import uavsim
from sensors import presets
from sensors.data_files import read_toml
from uavsim.cosim import Cosimulation, draw, replay
from uavsim.dispersions import drawn, keys, resolved
from uavsim.flight import write_toml
from uavsim.plants.air.weather import PRESETS
from uavsim.scenario import Scenario, load_scenario
from uavsim.spread.correlated import correlated, factor
from uavsim.spread.distribution import Distribution
from uavsim.spread.settings import Correlation
from uavsim.studies.trials import Flown

RARE = 1e-4  # probability of a test that fails by chance, with another seed
FRICTION = {"key": "launcher.friction", "distribution": "uniform", "low": 0.0, "high": 0.1}
MASS = {"key": "aircraft.mass_factor", "distribution": "normal", "sd": 0.02}
LIFT = {"key": "aircraft.lift_factor", "distribution": "normal", "sd": 0.05}
DRAG = {"key": "aircraft.drag_factor", "distribution": "normal", "sd": 0.08}


def scenario(*dispersions: dict[str, Any], correlations: Any = (), **more: Any) -> Scenario:
    return Scenario.from_dict({"dispersions": list(dispersions), "correlations": list(correlations), **more})


def between(one: dict[str, Any], other: dict[str, Any], coefficient: float) -> dict[str, Any]:
    return {"between": [one["key"], other["key"]], "coefficient": coefficient}


def sample(of: Scenario, count: int) -> dict[str, np.ndarray]:
    found = [drawn(of, i) for i in range(count)]
    return {key: np.array([one[key] for one in found]) for key in keys(of)}


# -- one draw leaves another as it is --------------------------------------------------------------------------------


def test_one_more_dispersion_leaves_all_others_as_they_were_wherever_it_stands() -> None:
    few = scenario(MASS, FRICTION, LIFT, correlations=[between(MASS, LIFT, 0.7)], seed=5)
    more = {"key": "launcher.rise", "distribution": "truncated-normal", "sd": 0.004, "low": 0.02}
    texts = {"key": "accelerometer.preset", "distribution": "choice", "values": ["adxl345", "lsm6dso32"]}
    for many in ((more, MASS, FRICTION, LIFT), (MASS, DRAG, FRICTION, texts, LIFT), (MASS, FRICTION, LIFT, DRAG)):
        other = scenario(*many, correlations=[between(MASS, LIFT, 0.7)], seed=5)
        for index in range(20):
            before, after = drawn(few, index), drawn(other, index)
            assert {key: after[key] for key in before} == before


def test_one_more_that_is_correlated_changes_nothing_before_it() -> None:
    few = scenario(MASS, LIFT, correlations=[between(MASS, LIFT, 0.7)])
    many = scenario(MASS, LIFT, DRAG, correlations=[between(MASS, LIFT, 0.7), between(LIFT, DRAG, -0.4)])
    for index in range(20):
        before, after = drawn(few, index), drawn(many, index)
        assert {key: after[key] for key in before} == before


def test_dispersions_leave_wait_force_noise_and_units_as_they_were() -> None:
    plain, index = load_scenario("catapult", overrides=["duration=6", "index=4"]), 4
    varied = resolved(replace(plain, dispersions=scenario(MASS, FRICTION).dispersions), index)
    assert varied.launcher.friction != plain.launcher.friction
    one, other = draw(plain), draw(varied)
    assert (one.release_time, one.plant_seed) == (other.release_time, other.plant_seed)
    assert other.force_factor == one.force_factor / varied.aircraft.mass_factor
    quiet, shaken = (Cosimulation(s) for s in (plain, varied))
    for simulation in (quiet, shaken):
        simulation.advance(1000)  # it waits on its rail, and only noise and unit are read
    a, b = (np.array(simulation.readings).reshape(-1, 4) for simulation in (quiet, shaken))
    assert np.array_equal(a[:, 0], b[:, 0])
    assert np.abs(a - b).max() < 0.05  # what a heavier one shakes on its shoes


def test_a_flight_is_of_seed_and_index_alone() -> None:
    found = scenario(MASS, FRICTION, seed=9)
    assert drawn(found, 3) == drawn(replace(found, index=8), 3)
    assert drawn(found, 3) != drawn(found, 4)
    assert drawn(found, 3) != drawn(replace(found, seed=10), 3)


# -- distributions ---------------------------------------------------------------------------------------------------

TRUNCATED = {"key": "launcher.friction", "distribution": "truncated-normal", "mean": 0.02, "sd": 0.02, "low": 0.0}
TAIL = {**TRUNCATED, "mean": 0.0, "sd": 0.02, "low": 0.14, "high": 0.2}  # 7 standard deviations out


@pytest.mark.parametrize(
    ("one", "cdf"),
    [
        (FRICTION, stats.uniform(0.0, 0.1).cdf),
        (MASS, stats.norm(1.0, 0.02).cdf),
        (TRUNCATED, stats.truncnorm(-1.0, math.inf, 0.02, 0.02).cdf),
        ({**TRUNCATED, "high": 0.03}, stats.truncnorm(-1.0, 0.5, 0.02, 0.02).cdf),
        (TAIL, stats.truncnorm(7.0, 10.0, 0.0, 0.02).cdf),
        ({"key": "launcher.elevation_deg", "distribution": "normal", "sd": 0.04, "relative": True},
         stats.norm(12.5, 0.5).cdf),
        ({"key": "launcher.elevation_deg", "distribution": "uniform", "low": 0.9, "high": 1.2, "relative": True},
         stats.uniform(11.25, 3.75).cdf),
        ({"key": "environment.wind_from_deg", "distribution": "uniform", "low": -180.0, "high": 180.0},
         stats.uniform(-180.0, 360.0).cdf),
        ({"key": "accelerometer.mounting_error_deg[1]", "distribution": "normal", "sd": 0.5},
         stats.norm(0.0, 0.5).cdf),
    ],
)  # fmt: skip
def test_drawn_values_follow_their_distribution(one: dict[str, Any], cdf: Any) -> None:
    """Kolmogorov-Smirnov, 2000 draws: by chance below 1e-4 once in 10 000 times."""
    values = sample(scenario(one), 2000)[one["key"]]
    assert stats.kstest(values, cdf).pvalue > RARE
    assert values.min() >= one.get("low", -math.inf) * (12.5 if one.get("relative") else 1.0)


def test_a_negative_value_of_the_key_takes_factors_too() -> None:
    turned = {"key": "launcher.heading_deg", "distribution": "uniform", "low": 0.5, "high": 1.0, "relative": True}
    values = sample(scenario(turned, launcher={"heading_deg": -40.0}), 500)["launcher.heading_deg"]
    assert -40.0 <= values.min() < -39.0
    assert -21.0 < values.max() <= -20.0


def test_choices_and_whole_numbers_come_as_often_as_is_said() -> None:
    """χ², 2000 draws: by chance below 1e-4 once in 10 000 times."""
    found = scenario(
        {"key": "accelerometer.preset", "distribution": "choice", "values": ["adxl345", "lsm6dso32", "bmi088"],
         "weights": [1, 2, 0.5]},
        {"key": "environment.turbulence_severity", "distribution": "uniform", "low": 2, "high": 5},
        {"key": "flight_computer.height", "distribution": "choice", "values": [0.5, 2.0], "relative": True},
        detector={"threshold": 30.0},
    )  # fmt: skip
    values = sample(found, 2000)
    for key, shares in (
        ("accelerometer.preset", {"adxl345": 2 / 7, "lsm6dso32": 4 / 7, "bmi088": 1 / 7}),
        ("environment.turbulence_severity", dict.fromkeys((2, 3, 4, 5), 0.25)),
        ("flight_computer.height", {0.5 * found.flight_computer.height: 0.5, 2.0 * found.flight_computer.height: 0.5}),
    ):
        counts = [int((values[key] == value).sum()) for value in shares]
        assert sum(counts) == 2000
        assert stats.chisquare(counts, [2000 * share for share in shares.values()]).pvalue > RARE
    assert type(drawn(found, 0)["environment.turbulence_severity"]) is int


def test_a_choice_may_be_of_truths_and_kinds() -> None:
    found = scenario(
        {"key": "detector.kind", "distribution": "choice", "values": ["sliding-window", "threshold-window"]},
        {"key": "detector.window", "distribution": "uniform", "low": 0.015, "high": 0.02},
        {"key": "air_data.acceleration_sensitivity", "distribution": "choice", "values": [True, False]},
        {"key": "environment.preset", "distribution": "choice", "values": ["hot", "cold", ""]},
        detector={"kind": "sliding-window", "threshold": 45.0},
    )
    flown = [resolved(found, i) for i in range(40)]
    assert {s.detector.kind for s in flown} == {"sliding-window", "threshold-window"}
    assert {s.air_data.acceleration_sensitivity for s in flown} == {True, False}
    assert len({s.detector.window for s in flown}) == 40
    for s in flown:
        said = PRESETS[s.environment.preset].keys if s.environment.preset else {"temperature_offset": 0.0}
        assert s.environment.temperature_offset == said["temperature_offset"]
        assert Scenario.from_dict(s.to_dict()) == s  # which checks all of it


def test_a_preset_that_is_drawn_takes_the_place_of_the_scenarios_own() -> None:
    found = scenario(
        {"key": "environment.preset", "distribution": "choice", "values": ["cold"]},
        environment={"preset": "moderate", "wind_from_deg": 30.0},
    )
    cold = resolved(found, 0).environment
    assert cold.temperature_offset == PRESETS["cold"].keys["temperature_offset"]
    assert (cold.wind_speed, cold.turbulence_severity, cold.wind_from_deg) == (0.0, 3, 30.0)


def test_a_sensor_of_ones_own_that_is_drawn_is_read_and_the_others_stay_as_they_were_read(tmp_path: Path) -> None:
    from sensors.catalogue import path_of

    own = tmp_path / "mine.toml"
    own.write_text(path_of("adxl345").read_text())
    found = load_scenario(
        "catapult",
        overrides=[
            f"air_data.total.preset={path_of('bmp388')}", "detector.threshold=30",
            f'dispersions=[{{key="accelerometer.preset",distribution="choice",values=["{own}","adxl345"]}}]',
        ],
    )  # fmt: skip
    flown = {str(resolved(found, i).accelerometer.preset): resolved(found, i) for i in range(20)}
    assert set(flown) == {str(own), "adxl345"}
    assert flown[str(own)].accelerometer.preset.text == own.read_text()  # type: ignore[attr-defined]
    assert all(s.air_data.total.preset is found.air_data.total.preset for s in flown.values())


# -- correlations ----------------------------------------------------------------------------------------------------


def test_correlations_come_back_from_what_is_drawn() -> None:
    """Fisher's z of 2000 draws has a standard error of 0.022; 4 of them by chance once in 16 000 times."""
    wanted = {(0, 1): 0.8, (1, 2): -0.5, (0, 2): -0.2}
    all_ = (MASS, LIFT, DRAG)
    found = scenario(*all_, correlations=[between(all_[a], all_[b], r) for (a, b), r in wanted.items()])
    values = list(sample(found, 2000).values())
    for (a, b), r in wanted.items():
        seen = float(np.corrcoef(values[a], values[b])[0, 1])
        assert abs(math.atanh(seen) - math.atanh(r)) < 4.0 / math.sqrt(1997)
    for one, column in zip(all_, values, strict=True):
        assert stats.kstest(column, stats.norm(1.0, one["sd"]).cdf).pvalue > RARE


@pytest.mark.parametrize("coefficient", [1.0, -1.0])
def test_a_whole_correlation_is_one_and_the_same_draw(coefficient: float) -> None:
    values = sample(scenario(MASS, LIFT, correlations=[between(MASS, LIFT, coefficient)]), 50)
    scaled = [(values[one["key"]] - 1.0) / one["sd"] for one in (MASS, LIFT)]
    assert scaled[1] == pytest.approx(coefficient * scaled[0], rel=1e-9, abs=1e-9)


def test_the_factor_is_choleskys_and_takes_a_singular_matrix() -> None:
    rows = [[1.0, 0.6, 0.3], [0.6, 1.0, -0.2], [0.3, -0.2, 1.0]]
    assert np.array(factor(rows)) == pytest.approx(np.linalg.cholesky(np.array(rows)), abs=1e-15)
    singular = np.outer([1.0, -1.0, 1.0], [1.0, -1.0, 1.0])
    lower = np.array(factor(singular.tolist()))
    assert lower @ lower.T == pytest.approx(singular)


def test_what_hangs_together_by_a_third_is_one_group() -> None:
    normals = {"a": 1.0, "b": -0.5, "c": 0.3, "d": 2.0}
    links = [Correlation(("a", "c"), 0.6), Correlation(("c", "d"), 0.5)]
    found = correlated(normals, links)
    assert (found["a"], found["b"]) == (1.0, -0.5)
    assert found["c"] == pytest.approx(0.6 + 0.8 * 0.3)
    rows = np.linalg.cholesky(np.array([[1.0, 0.6, 0.0], [0.6, 1.0, 0.5], [0.0, 0.5, 1.0]]))
    assert found["d"] == pytest.approx(rows[2] @ [1.0, 0.3, 2.0])


# -- points of the unit cube -----------------------------------------------------------------------------------------


def test_a_point_stands_for_the_inverse_of_each_distribution() -> None:
    choice = {"key": "accelerometer.unit", "distribution": "choice", "values": ["random", "ideal"], "weights": [3, 1]}
    severity = {"key": "environment.turbulence_severity", "distribution": "uniform", "low": 2, "high": 5}
    found = scenario(FRICTION, MASS, {**TRUNCATED, "key": "launcher.rise", "low": 0.01}, choice, severity)
    values = drawn(found, 0, np.array([0.25, 0.975, 0.4, 0.74, 0.99]))
    assert values["launcher.friction"] == pytest.approx(0.025)
    assert values["aircraft.mass_factor"] == pytest.approx(1.0 + 0.02 * 1.959964, rel=1e-7)
    assert values["launcher.rise"] == pytest.approx(stats.truncnorm(-0.5, math.inf, 0.02, 0.02).ppf(0.4), rel=1e-12)
    assert (values["accelerometer.unit"], values["environment.turbulence_severity"]) == ("random", 5)
    assert drawn(found, 0, np.full(5, 0.76))["accelerometer.unit"] == "ideal"
    assert drawn(found, 1, np.full(5, 0.3)) == drawn(found, 0, np.full(5, 0.3))


@pytest.mark.parametrize("edge", [0.0, 1.0])
def test_the_corners_of_the_cube_are_numbers_within_the_bounds(edge: float) -> None:
    found = load_scenario("dispersed-sensors")
    assert isinstance(resolved(found, 0, np.full(len(keys(found)), edge)), Scenario)


def test_a_point_is_correlated_as_random_values_are() -> None:
    found = scenario(MASS, LIFT, correlations=[between(MASS, LIFT, 0.6)])
    z = ndtri(np.array([0.2, 0.7]))
    values = drawn(found, 0, np.array([0.2, 0.7]))
    assert values["aircraft.lift_factor"] == pytest.approx(1.0 + 0.05 * (0.6 * z[0] + 0.8 * z[1]))


@pytest.mark.parametrize("point", [[0.5], [0.5, 0.5, 0.5], [0.5, 1.2], [math.nan, 0.5]])
def test_a_point_outside_the_cube_is_refused(point: list[float]) -> None:
    with pytest.raises(ValueError, match="must have 2 coordinates from 0 to 1"):
        drawn(scenario(MASS, FRICTION), 0, np.array(point))


@pytest.mark.parametrize(
    "one",
    [
        Distribution("normal", 3.0, 2.0),
        Distribution("truncated-normal", 3.0, 2.0, 1.0, 4.0),
        Distribution("truncated-normal", 3.0, 2.0, 13.0),
        Distribution("truncated-normal", 3.0, 2.0, high=-9.0),
        Distribution("uniform", low=-1.0, high=4.0),
    ],
)
def test_the_probability_below_a_value_is_the_coordinate_that_gives_it(one: Distribution) -> None:
    for u in (1e-9, 0.003, 0.4, 0.77, 0.999):
        value = one.of_normal(float(ndtri(u))) if one.is_normal else float(one.of_uniform(u))
        assert one.below(value) == pytest.approx(u, rel=1e-6, abs=1e-12)
        assert one.above(value) == pytest.approx(1.0 - u, rel=1e-6)


def test_the_probability_out_of_bounds_has_its_digits_far_out() -> None:
    assert Distribution("normal", 0.0, 1.0).above(7.0) == pytest.approx(float(ndtr(-7.0)), rel=1e-9)
    assert Distribution("uniform", low=1, high=9, whole=True).above(7.0) == pytest.approx(2.0 / 9.0)


# -- a flight's own scenario -----------------------------------------------------------------------------------------


def test_resolving_leaves_none_and_changes_only_what_is_drawn() -> None:
    found = load_scenario("dispersed")
    own, values = resolved(found, 7), drawn(found, 7)
    assert (own.index, own.dispersions, own.correlations) == (7, (), ())
    assert resolved(own, 7) is own
    same = replace(
        own, aircraft=found.aircraft, launcher=found.launcher, environment=found.environment,
        accelerometer=found.accelerometer, air_data=found.air_data,
        dispersions=found.dispersions, correlations=found.correlations, index=0,
    )  # fmt: skip
    assert same == found
    assert own.aircraft.mass_factor == values["aircraft.mass_factor"]
    assert own.accelerometer.mounting_error_deg == (0.0, values["accelerometer.mounting_error_deg[1]"], 0.0)
    assert Scenario.from_dict(own.to_dict()) == own


def test_a_dispersed_flight_flies_again_from_its_folder_to_the_same_bytes(tmp_path: Path) -> None:
    overrides = ["duration=7", "index=2"]
    flown = uavsim.fly("dispersed", seed=3, overrides=overrides)
    flown.save(tmp_path / "first")
    written = read_toml(tmp_path / "first" / "scenario.toml")
    assert (written["dispersions"], written["correlations"], written["index"]) == ([], [], 2)
    again = uavsim.fly(tmp_path / "first")
    again.save(tmp_path / "again")
    files = sorted(p.relative_to(tmp_path / "first") for p in (tmp_path / "first").rglob("*") if p.is_file())
    assert {str(file) for file in files} >= {"scenario.toml", "score.json", "truth.parquet"}
    for file in files:
        assert (tmp_path / "first" / file).read_bytes() == (tmp_path / "again" / file).read_bytes(), file
    heard = replay(flown)
    assert heard.events == flown.events
    assert heard.tables["estimate"].equals(flown.tables["estimate"])
    loaded = load_scenario("dispersed", overrides=overrides, seed=3)
    assert flown.scenario["aircraft"]["mass_factor"] == drawn(loaded, 2)["aircraft.mass_factor"]


def test_a_scenario_with_dispersions_comes_back_from_its_file(tmp_path: Path) -> None:
    found = load_scenario("dispersed-sensors")
    write_toml(tmp_path / "scenario.toml", found.to_dict())
    assert load_scenario(tmp_path / "scenario.toml") == found


def test_all_can_be_switched_off() -> None:
    plain = load_scenario("dispersed", overrides=["dispersions=[]"])
    assert (
        resolved(plain, 5).to_dict() | {"index": 0, "correlations": plain.to_dict()["correlations"]} == plain.to_dict()
    )
    assert drawn(plain, 5) == {}


def test_a_draw_that_cannot_be_is_one_line_with_its_number_and_its_values() -> None:
    """Waits that are drawn past each other: no bound of a single key tells."""
    waits = [
        {"key": f"launcher.wait_{end}", "distribution": "normal", "mean": mean, "sd": 0.2, "relative": False}
        for end, mean in (("min", 3.6), ("max", 3.8))
    ]
    found = scenario(*waits, seed=4, name="waits")
    lines = []
    for index in range(30):
        try:
            resolved(found, index)
        except ValueError as error:
            lines.append(str(error))
    assert 0 < len(lines) < 30
    for line in lines:
        assert re.match(
            r"waits: seed 4, index \d+ draws launcher\.wait_min = [\d.]+, launcher\.wait_max = [\d.]+: "
            r"launcher\.wait_max = [\d.]+: must be at least wait_min = [\d.]+ s$",
            line,
        ), line


# -- what is wrong, and what the line says ---------------------------------------------------------------------------

ONE = '{key="launcher.friction",distribution="normal",mean=0.2,sd=0.01}'
TWO = ONE + ',{key="launcher.elevation_deg",distribution="normal",sd=0.1}'
THREE = TWO + ',{key="launcher.heading_deg",distribution="normal",sd=0.1}'
FOUR = THREE + ',{key="launcher.rise",distribution="uniform",low=0.02,high=0.04}'


def of(key: str, rest: str) -> str:
    return f'{{key="{key}",{rest}}}'


NORMAL, UNIFORM = 'distribution="normal",sd=0.01', 'distribution="uniform",low=1,high=4'


def chosen(*values: Any) -> str:
    return f'distribution="choice",values=[{",".join(map(repr, values))}]'.replace("True", "true")


@pytest.mark.parametrize(
    ("file", "given", "says"),
    [
        ("catapult", of("launcher.fricton", NORMAL),
         "unknown key 'launcher.fricton'; did you mean 'launcher.friction'?"),
        ("catapult", of("launcher", NORMAL), "launcher is a group; its keys are kind, peak_specific_force_g"),
        ("catapult", of("launcher.friction", NORMAL),
         "dispersions[0] ('launcher.friction'): 15.9 % of draws would be below 0, which it cannot be; narrow it or use "
         "truncated-normal with low"),
        ("catapult", of("launcher.friction", 'distribution="normal",sd=0.0018'), "1.38e-06 % of draws would be below"),
        ("catapult", of("launcher.friction", 'distribution="truncated-normal",mean=0.01,sd=0.01,high=0.1'),
         "15.9 % of draws would be below 0"),
        ("catapult", of("launcher.friction", 'distribution="uniform",low=0.1,high=0.6'),
         "20 % of draws would be above 0.5, which it cannot be; narrow it"),
        ("catapult", of("environment.turbulence_severity", 'distribution="uniform",low=1,high=9'), "22.2 % of draws"),
        ("catapult", of("launcher.friction", 'distribution="normal",sd=0'),
         "dispersions[0].sd = 0: must be a number above 0"),
        ("catapult", of("launcher.friction", 'distribution="gauss",sd=1'), "must be 'normal', 'uniform'"),
        ("catapult", '{key="launcher.friction"}', "dispersions[0]: distribution is missing"),
        ("catapult", '{distribution="normal",sd=1}', "dispersions[0]: key is missing"),
        ("catapult", of("launcher.friction", 'distribution="normal"'), "'normal' needs sd"),
        ("catapult", of("launcher.friction", 'distribution="uniform",low=0.1'), "'uniform' needs high"),
        ("catapult", of("launcher.friction", 'distribution="truncated-normal",sd=3'), "needs low or high"),
        ("catapult", of("launcher.friction", 'distribution="choice"'), "'choice' needs values"),
        ("catapult", of("launcher.friction", NORMAL + ",low=3,values=[1]"),
         "'normal' has no low and no values; it has sd, mean"),
        ("catapult", of("launcher.friction", 'distribution="uniform",low=0.2,high=0.1'),
         "low = 0.2 must be below high = 0.1"),
        ("catapult", of("launcher.friction", 'distribution="truncated-normal",sd=0.001,low=0.3'),
         "lies from low to high; at least 1e-12 must"),
        ("catapult", of("launcher.friction", chosen(0.1, 0.9)),
         "launcher.friction = 0.9: must be a number from 0 to 0.5"),
        ("catapult", of("launcher.friction", chosen("a")), "launcher.friction = 'a': must be a number"),
        ("catapult", of("launcher.friction", chosen(0.1, 0.2) + ",weights=[1]"), "has 1 weights and 2 values"),
        ("catapult", of("launcher.friction", chosen(0.1, 0.2) + ",weights=[0,0]"), "weights must not all be 0"),
        ("catapult", of("launcher.friction", chosen(0.1, 0.2) + ",weights=[1,-1]"),
         "must be a list, each a number of at least 0"),
        ("catapult", ONE + "," + ONE, "dispersions[1] ('launcher.friction'): launcher.friction is dispersed already"),
        ("catapult", of("environment.turbulence_severity", NORMAL),
         "takes whole numbers, which only 'uniform' and 'choice'"),
        ("catapult", of("environment.turbulence_severity", 'distribution="uniform",low=1.5,high=3'),
         "takes whole numbers, so low = 1.5 must be one"),
        ("catapult", of("environment.turbulence_severity", chosen(1, 2) + ",relative=true"),
         "takes no number with a fraction"),
        ("catapult", of("accelerometer.preset", NORMAL), "takes no number; of texts and truths only 'choice' can draw"),
        ("catapult", of("accelerometer.preset", chosen("bmp390")), "is a pressure sensor, not an accelerometer"),
        ("catapult", of("accelerometer.preset", chosen("adxl34")), "preset 'adxl34' is unknown; nearest: adxl345"),
        ("catapult", of("accelerometer.range_g", chosen(32, 4)),
         "(accelerometer.range_g), value 4.0: detector.threshold"),
        ("catapult", of("accelerometer.rate", NORMAL), "has no value of its own in the scenario, so give mean"),
        ("catapult", of("accelerometer.rate", NORMAL + ",mean=800"), "rate 800.0 is unknown; nearest: 833"),
        ("catapult", of("accelerometer.bias", NORMAL + ",relative=true"), "is 0, and no factor changes that"),
        ("catapult", of("accelerometer.bias[0]", NORMAL),
         "there is no such entry; accelerometer.bias is no list there"),
        ("catapult", of("accelerometer.mounting_deg[3]", NORMAL), "accelerometer.mounting_deg has 3 entries"),
        ("catapult", of("accelerometer.mounting_deg", NORMAL), "of a list of numbers give an entry, KEY[0]"),
        ("catapult", of("requirements", NORMAL), "is no number, text or truth"),
        ("catapult", of("seed", UNIFORM), "it is what everything is drawn from and cannot be dispersed"),
        ("catapult", of("name", chosen("a")), "it names the scenario and cannot be dispersed"),
        ("catapult", of("dispersions", UNIFORM), "is no number, text or truth"),
        ("wind-tunnel", of("launcher.stroke", UNIFORM), "is not read by plant.kind = 'wind-tunnel', a rig"),
        ("wind-tunnel", of("aircraft.mass_factor", NORMAL), "is not read by plant.kind = 'wind-tunnel', a rig"),
        ("wind-tunnel", of("environment.wind_speed", UNIFORM), "is not read by plant.kind = 'wind-tunnel', a rig"),
        ("launch-curve", of("launcher.friction", UNIFORM), "is not read by plant.kind = 'launch-curve', a rig"),
        ("catapult", of("plant.centrifuge.arm", UNIFORM), "is not read by plant.kind = 'jsbsim'"),
        ("catapult", of("detector.levels", UNIFORM), "is not read by detector.kind = 'adaptive-cusum', which reads"),
        ("catapult", of("detector.kind", chosen("adaptive-cusum", "cusum"))
         + "," + of("detector.adaptive.limit", 'distribution="uniform",low=1,high=3'), "is not read by"),
        ("catapult", of("launcher.wait_max", 'distribution="uniform",low=1.7,high=4'),
         "dispersions (launcher.wait_max), value 1.7: launcher.wait_max = 1.7: must be at least wait_min = 2 s"),
        ("catapult", of("aircraft.properties.ap/gain/pitch", NORMAL),
         "has no value of its own in [aircraft.properties]"),
        ("catapult", of("aircraft.properties.simulation/dt", NORMAL + ",mean=1"), "is JSBSim's own"),
        ("catapult", of("launcher.friction", chosen("a", 0.1) + ",relative=true"), "so each must be a number"),
        ("catapult", "3", "must be a group of key, distribution"),
        ("catapult", of("launcher.friction", NORMAL + ",sigma=3"), "unknown key 'sigma' in dispersions[0]"),
    ],
)  # fmt: skip
def test_a_wrong_dispersion_is_one_line_that_says_what_is_allowed(file: str, given: str, says: str) -> None:
    with pytest.raises(ValueError, match=r"^--set: ") as caught:
        load_scenario(file, overrides=[f"dispersions=[{given}]"])
    line = str(caught.value)
    assert says in line
    assert len(line.splitlines()) == 1
    assert len(line) < 700


def links(*of_three: tuple[int, int, float]) -> str:
    names = ("launcher.friction", "launcher.elevation_deg", "launcher.heading_deg", "launcher.rise", "launcher.fall")
    told = (f'{{between=["{names[a]}","{names[b]}"],coefficient={r}}}' for a, b, r in of_three)
    return f"correlations=[{','.join(told)}]"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (links((0, 1, 0.9), (0, 2, 0.9), (1, 2, -0.5)),
         "correlations: coefficients of launcher.friction, launcher.elevation_deg, launcher.heading_deg cannot all be "
         "so: the matrix has the eigenvalue -0.547, and none may be below 0"),
        (links((0, 3, 0.5)), "launcher.rise is not drawn from a normal distribution; only such go together"),
        (links((0, 4, 0.5)), "'launcher.fall' is not dispersed; there are launcher.friction, launcher.elevation_deg"),
        (links((0, 0, 0.5)), "must be two different keys"),
        (links((0, 1, 0.5), (1, 0, 0.5)), "are correlated already"),
        (links((0, 1, 1.5)), "coefficient = 1.5: must be a number from -1 to 1"),
        ('correlations=[{between=["launcher.friction"],coefficient=0.5}]', "must be a list of 2, each text"),
        ('correlations=[{between=["launcher.friction","launcher.rise"]}]', "coefficient is missing"),
    ],
)  # fmt: skip
def test_a_wrong_correlation_is_one_line(given: str, says: str) -> None:
    with pytest.raises(ValueError, match=r"^--set: ") as caught:
        load_scenario("catapult", overrides=[f"dispersions=[{FOUR}]", given])
    assert says in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


KEYS = st.sampled_from([
    "launcher.friction", "launcher.wait_min", "aircraft.mass_factor", "accelerometer.preset", "accelerometer.bias",
    "accelerometer.rate", "accelerometer.mounting_deg[1]", "environment.preset", "environment.turbulence_severity",
    "environment.gust_length_s", "detector.kind", "detector.rearm", "estimator.kind", "plant.kind", "plant.step_rate",
    "aircraft.properties.ap/gain/pitch", "aircraft.model", "duration", "launcher", "air_data.total.iir", "x", "",
])  # fmt: skip
NUMBERS = st.none() | st.sampled_from([0.0, 1.0, -1.0, 0.01, 2, 3, 1e-30, 1e15, math.nan, 2.5]) | st.floats()
ANY = st.lists(st.sampled_from([0, 1, 0.02, 2.5, True, "adxl345", "hot", "cusum", "aided", "fw8", "wind-tunnel", 2000]))
TABLES = st.fixed_dictionaries(
    {"key": KEYS, "distribution": st.sampled_from(["normal", "uniform", "truncated-normal", "choice", "x"])},
    optional={"mean": NUMBERS, "sd": NUMBERS, "low": NUMBERS, "high": NUMBERS, "values": ANY,
              "weights": st.lists(NUMBERS, max_size=3), "relative": st.booleans() | st.none()},
)  # fmt: skip
PAIRS = st.fixed_dictionaries({"between": st.lists(KEYS, min_size=1, max_size=3), "coefficient": NUMBERS})


@settings(deadline=None, max_examples=250, derandomize=True)
@given(st.lists(TABLES, max_size=3), st.lists(PAIRS, max_size=2))
def test_any_table_is_drawn_or_one_line(dispersions: list[dict[str, Any]], pairs: list[dict[str, Any]]) -> None:
    values = {"dispersions": dispersions, "correlations": pairs}
    plain = {name: [{k: v for k, v in one.items() if v is not None} for one in rows] for name, rows in values.items()}
    found = made_or_line(Scenario.from_dict, plain, "here")
    if isinstance(found, str):
        assert found.startswith("here: ")
        return
    assert Scenario.from_dict(found.to_dict()) == found
    for index in range(3):
        own = made_or_line(resolved, found, index)
        if isinstance(own, str):  # what is drawn together may be impossible
            assert f"index {index}" in own
        else:
            assert Scenario.from_dict(own.to_dict()) == own


def made_or_line(make: Callable[..., Scenario], *given: Any) -> Scenario | str:
    try:
        return make(*given)
    except ValueError as error:
        lines = str(error).splitlines()
    assert len(lines) == 1
    return lines[0]


def test_every_preset_of_a_pressure_sensor_can_be_drawn() -> None:
    parts = [name for name in presets() if name.startswith(("bmp", "dps", "lps"))]
    choice = {"key": "air_data.total.preset", "distribution": "choice", "values": parts}
    found = sample(scenario(choice), 100)["air_data.total.preset"]
    assert set(found) == set(parts)


def test_launches_for_detectors_are_drawn_as_flights_are() -> None:
    """The studies of detection fly few launches; each is the flight of its number."""
    stroke = {"key": "launcher.stroke", "distribution": "uniform", "low": 3.0, "high": 6.0}
    found = scenario(stroke, duration=6.0)
    launches = Flown(found, flights=2)
    read = launches.read(seed=4, first=0, count=2)
    for index, truth in enumerate(read.truths):
        way = float(drawn(found.with_seed(4), index)["launcher.stroke"])
        run = math.sqrt(2.0 * way / truth.peak)  # all of the push from the start
        assert 1.0 < (truth.end - truth.onset) / run < 1.4  # it rises and falls, and the slope is against it
