"""The centrifuge: forces against ω²r, ω'r and g, its axes against the motion they describe, its run in the loop.

Authority is mechanics: the specific force is the second derivative of the position less gravity, in body axes.
"""

from pathlib import Path

import numpy as np
import pytest

import uavsim
from uavsim.cosim import replay
from uavsim.flight import Flight, load
from uavsim.plants.plant import Run
from uavsim.plants.rail import body_axes
from uavsim.plants.rigs.centrifuge import CentrifugeSettings, centrifuge
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.scenario import load_scenario
from uavsim.studies.batch import fly_seeds
from uavsim.truth import STANDARD_GRAVITY

ARM, OFF, LOAD = 1.7, 0.03, 15.0  # m, m, g
UP, HOLD, DOWN, RELEASE, END = 1.5, 1.0, 2.0, 0.4, 6.0  # s
SETTINGS = CentrifugeSettings(arm=ARM, load_g=LOAD, radius_error=OFF, spin_up=UP, hold=HOLD, spin_down=DOWN)


def truth(settings: CentrifugeSettings = SETTINGS) -> dict[str, np.ndarray]:
    plant = centrifuge(settings, Run(EnvironmentSettings(), LauncherSettings(), END, RELEASE))
    for _ in range(round(1000 * END)):
        plant.step()
    return plant.truth()


def test_the_force_to_the_hub_is_omega_squared_r_on_every_row() -> None:
    """Exactly, to the last bit but two: the same product of the same numbers."""
    c = truth()
    np.testing.assert_allclose(c["fz"], c["p"] ** 2 * (ARM + OFF), rtol=4e-16, atol=0.0)


def test_the_load_that_was_set_is_held_at_the_arm_and_more_further_out() -> None:
    c = truth()
    held = (c["t"] > RELEASE + UP) & (c["t"] < RELEASE + UP + HOLD)
    np.testing.assert_allclose(c["fz"][held], LOAD * STANDARD_GRAVITY * (ARM + OFF) / ARM, rtol=1e-12)
    rest = (c["t"] < RELEASE) | (c["t"] > RELEASE + UP + HOLD + DOWN + 1e-9)
    assert np.all(c["fz"][rest] == 0.0)


def test_one_g_stays_on_the_axis_that_stands_upright() -> None:
    assert np.all(truth()["fx"] == STANDARD_GRAVITY)


def test_along_the_way_it_feels_the_change_of_the_speed() -> None:
    """ω' r over each piece, by differences of ω: linear between corners, so exact to rounding (1e-9)."""
    c = truth()
    slope = np.diff(c["p"]) / 1e-3 * (ARM + OFF)
    corners = RELEASE + np.cumsum([0.0, UP, HOLD, DOWN])
    clear = np.min(np.abs(c["t"][:-1, None] + 5e-4 - corners), axis=1) > 1.5e-3
    np.testing.assert_allclose(c["fy"][:-1][clear], slope[clear], atol=1e-9)
    assert c["fy"].max() == pytest.approx(np.sqrt(LOAD * STANDARD_GRAVITY / ARM) / UP * (ARM + OFF))


def test_what_spins_it_up_is_what_it_has() -> None:
    """Work of the force along the way is the kinetic energy: f_y ωr dt sums to (ωr)²/2, trapezium rule, 0.1 %."""
    c = truth()
    speed = c["p"] * (ARM + OFF)
    power = c["fy"] * speed
    turning = c["t"] < RELEASE + UP + 0.5 * HOLD
    work = np.trapezoid(power[turning], c["t"][turning])
    assert work == pytest.approx(0.5 * speed[turning][-1] ** 2, rel=1e-3)


def test_the_axes_are_those_of_the_motion() -> None:
    """Second differences of the position less gravity, turned into body axes by the attitude, give the force.

    Away from the corners of the speed, second differences over 1 ms are right to ω⁴ r dt²/12 < 1e-2 m/s²·1e-3 and
    rounding of 1e-16 m/dt² = 1e-9 m/s²; tolerance 2e-3 m/s².
    """
    c = truth()
    position = np.column_stack([c["north"], c["east"], -c["altitude"]])
    acceleration = (position[2:] - 2.0 * position[1:-1] + position[:-2]) / 1e-6
    felt = acceleration - np.array([0.0, 0.0, STANDARD_GRAVITY])
    corners = RELEASE + np.cumsum([0.0, UP, HOLD, DOWN])
    for i in range(50, len(felt) - 50, 97):
        if np.min(np.abs(c["t"][i + 1] - corners)) < 3e-3:
            continue
        axes = np.array(body_axes((c["roll"][i + 1], c["pitch"][i + 1], c["heading"][i + 1])))
        found = axes @ felt[i]
        np.testing.assert_allclose(found, [c["fx"][i + 1], c["fy"][i + 1], c["fz"][i + 1]], atol=2e-3)
        velocity = np.array([c["vn"][i + 1], c["ve"][i + 1], c["vd"][i + 1]])
        np.testing.assert_allclose(axes @ velocity, [0.0, c["p"][i + 1] * (ARM + OFF), 0.0], atol=1e-9)
        # the heading is about down, the rate p about body x, which is up
        assert (c["heading"][i + 2] - c["heading"][i]) / 2e-3 == pytest.approx(-c["p"][i + 1], abs=1e-3)


def test_the_sensor_must_sit_on_the_arm() -> None:
    with pytest.raises(ValueError, match="radius_error"):
        truth(CentrifugeSettings(arm=0.5, radius_error=-0.5))


# -- in the loop -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def strong() -> Flight:
    return uavsim.fly("centrifuge-15g")


def test_4_g_is_no_launch() -> None:
    """What was published: 4.1 g read at a load of 4 g, 2.5 % more, and no recognition."""
    flight = uavsim.fly("centrifuge-4g")
    assert flight.score["outcome"] == flight.score["expected"] == "completed"
    assert flight.score["launch"]["detections"] == 0
    assert flight.score["launch"]["crossing_time"] is None
    assert all(r["met"] for r in flight.score["requirements"])
    assert held(flight) == pytest.approx(4.10, abs=0.01)


def test_15_g_is_a_launch_once(strong: Flight) -> None:
    """What was published: 15.15 g read at a load of 15 g, 1 % more, and recognised."""
    launch = strong.score["launch"]
    assert launch["detections"] == 1
    assert launch["true_time"] is None
    assert launch["latency"] is None
    assert 0.0 < launch["latency_from_crossing"] < 0.2
    assert all(r["met"] for r in strong.score["requirements"])
    assert held(strong) == pytest.approx(15.15, abs=0.01)
    said = [e["event"] for e in strong.events if not e["event"].startswith("airspeed_")]  # no air is felt to move
    launched = [name for name in said if name not in ("ready", "not_ready", "accelerometer_offset")]
    assert launched == ["launch_detected", "stroke_end", "wings_commanded", "motor_on"]
    assert "airspeed_lost" in [e["event"] for e in strong.events]


def held(flight: Flight) -> float:
    """Mean reading to the hub while the speed is held, g."""
    start = flight.score["launch"]["release_time"] + flight.scenario["plant"]["centrifuge"]["spin_up"]
    readings = flight.accelerometer
    return float(readings["fz"][(readings["t"] > start) & (readings["t"] < start + 7.0)].mean()) / STANDARD_GRAVITY


def test_where_there_is_no_airspeed_there_is_no_figure_of_it(strong: Flight) -> None:
    airspeed = strong.score["airspeed"]
    assert airspeed["rmse"] is airspeed["valid_fraction"] is airspeed["cruise"]["rmse"] is None
    assert strong.score["flight"]["rail_exit_time"] is strong.score["flight"]["wing_out_time"] is None
    assert set(strong.truth["phase"]) == {"run"}


def test_it_replays_byte_for_byte(strong: Flight, tmp_path: Path) -> None:
    again = replay(load(strong.save(tmp_path / "rig")))
    assert again.events == strong.events
    assert again.score == strong.score
    assert again.estimate.equals(strong.estimate)
    assert again.detector.equals(strong.detector)


def test_several_seeds_make_a_table() -> None:
    flown = fly_seeds(load_scenario("centrifuge-15g", overrides=["plant.centrifuge.hold=0"]), [3, 4], workers=1)
    assert flown.runs["launch.detections"].tolist() == [1, 1]
    assert flown.runs["airspeed.rmse"].isna().all()


def test_a_run_must_fit_into_the_record() -> None:
    with pytest.raises(ValueError, match=r"duration = 20: must hold the longest wait.* 18 s"):
        load_scenario("centrifuge-4g", overrides=["duration=20"])
