"""The flight on a prescribed course.

Authorities: kinematics (specific force against the twice differentiated position, turned by the recorded attitude:
0.01 m/s², but for the rows at which a push begins, bends or ends); energy (the work of the specific force along the
path is what kinetic and potential energy gain); the closed forms of a bungee (a quarter of a harmonic swing) and of a
coordinated turn (g tan μ/V); the standard atmosphere.
"""

from dataclasses import replace
from math import cos, degrees, pi, radians, sin, sqrt, tan
from typing import Any

import numpy as np
import pytest

from uavsim import airdata, fly
from uavsim.cosim import replay
from uavsim.plants.course.legs import LegSettings
from uavsim.plants.plant import Run
from uavsim.plants.rigs.flight_path import FlightPath, FlightPathSettings, still_air
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.scenario import Scenario
from uavsim.spread.read import unread
from uavsim.truth import STANDARD_GRAVITY as G

START = 2.0  # s, of the release
RUN = Run(EnvironmentSettings(), LauncherSettings(), duration=40.0, release_time=START)
ROUGH = EnvironmentSettings(
    ground_elevation=400.0, wind_speed=6.0, wind_from_deg=60.0, turbulence_wind_20ft=5.0, wind_veer=20.0
)
LEGS = (
    LegSettings(3.0, airspeed=35.0, throttle=1.0),
    LegSettings(3.0, climb_deg=0.0),
    LegSettings(2.0, load_g=0.0),
    LegSettings(2.0, load_g=3.0),
    LegSettings(2.0, climb_deg=0.0, airspeed=30.0),
    LegSettings(2.0, bank_deg=60.0),
    LegSettings(6.0),
    LegSettings(2.0, bank_deg=0.0),
    LegSettings(5.0, airspeed=80.0),
    LegSettings(2.0, load_g=4.0),
    LegSettings(3.0, climb_deg=5.0),
)


def truth(settings: FlightPathSettings, run: Run = RUN) -> dict[str, Any]:
    plant = FlightPath(settings, run)
    plant.k = run.time.size - 1
    return plant.truth()


def vectors(c: dict[str, Any], *names: str) -> Any:
    return np.stack([c[name] for name in names], axis=1)


def from_positions(c: dict[str, Any], rate: float) -> Any:
    """Specific force in body axes of all rows but the first and the last."""
    at = np.stack([c["north"], c["east"], -c["altitude"]], axis=1)
    force = np.diff(at, 2, axis=0) * rate**2 - [0.0, 0.0, G]
    (cr, sr), (cp, sp), (ch, sh) = ((np.cos(c[n][1:-1]), np.sin(c[n][1:-1])) for n in ("roll", "pitch", "heading"))
    axes = (
        (cp * ch, cp * sh, -sp),
        (sr * sp * ch - cr * sh, sr * sp * sh + cr * ch, sr * cp),
        (cr * sp * ch + sr * sh, cr * sp * sh - sr * ch, cr * cp),
    )
    return np.stack([sum(force[:, i] * axis[i] for i in range(3)) for axis in axes], axis=1)


PUSHED = {
    "catapult": FlightPathSettings(legs=LEGS),
    "motor": FlightPathSettings(push="motor", burn=7.0, legs=LEGS[1:]),
    "bungee": FlightPathSettings(push="bungee", legs=LEGS),
    "throw": FlightPathSettings(push="throw", wing_loading=6.0, legs=LEGS),
}


@pytest.mark.parametrize("push", PUSHED)
@pytest.mark.parametrize("air", [EnvironmentSettings(), ROUGH], ids=["calm", "rough"])
def test_what_is_felt_is_what_the_positions_say(push: str, air: EnvironmentSettings) -> None:
    level = 3.0 if push == "motor" else 8.0
    run = replace(RUN, environment=air, launcher=LauncherSettings(peak_specific_force_g=level, elevation_deg=20.0))
    c = truth(PUSHED[push], run)
    error = np.abs(from_positions(c, 1000.0) - vectors(c, "fx", "fy", "fz")[1:-1]).max(axis=1)
    assert np.sort(error)[-13] < 0.01  # release, rise, fall, end of the rail and of the push, and their neighbours
    assert np.abs(np.diff(vectors(c, "north", "east", "altitude"), axis=0)).max() < 0.2  # and nothing jumps


@pytest.mark.parametrize("push", PUSHED)
def test_work_becomes_energy(push: str) -> None:
    """∫ f·v dt = ½ v² + g h, in still air and from the row after the release on."""
    level = 3.0 if push == "motor" else 8.0
    run = replace(RUN, launcher=LauncherSettings(peak_specific_force_g=level))
    c = truth(PUSHED[push], run)
    v = vectors(c, "vn", "ve", "vd")
    u = c["airspeed"] * np.cos(c["alpha"]) * np.cos(c["beta"])
    side, w = c["airspeed"] * np.sin(c["beta"]), c["airspeed"] * np.sin(c["alpha"]) * np.cos(c["beta"])
    power = (vectors(c, "fx", "fy", "fz") * np.stack([u, side, w], axis=1)).sum(axis=1)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]))]) / 1000.0
    energy = 0.5 * (v**2).sum(axis=1) + G * (c["altitude"] - c["altitude"][0])
    assert np.abs(work - energy).max() < 2e-3 * energy.max()
    assert energy.max() > 500.0


def test_a_bungee_is_a_quarter_of_a_swing() -> None:
    """s'' = A (1 - s/S), level: v = √(A S) at the end, after ½π √(S/A), but for the rise of 30 ms."""
    rail = LauncherSettings(elevation_deg=0.0, stroke=10.0, rise=0.001)
    c = truth(FlightPathSettings(push="bungee"), replace(RUN, launcher=rail, duration=4.0))
    level = 8.0 * G
    exit_row = int(np.flatnonzero(c["rail_s"] >= 10.0)[0])
    assert exit_row / 1000.0 - START == pytest.approx(0.5 * pi * sqrt(10.0 / level), abs=0.002)
    assert c["vn"][exit_row] == pytest.approx(sqrt(level * 10.0), rel=2e-3)


def test_a_motor_pushes_for_its_time_and_a_catapult_for_its_stroke() -> None:
    rail = LauncherSettings(peak_specific_force_g=3.0, elevation_deg=30.0)
    c = truth(FlightPathSettings(push="motor", burn=7.0), replace(RUN, launcher=rail, duration=10.0))
    pushing = np.flatnonzero(c["fx"] > 1.5 * G) / 1000.0 - START
    assert pushing[0] == pytest.approx(0.015, abs=0.003)
    assert pushing[-1] == pytest.approx(6.97, abs=0.003)
    assert c["airspeed"][-1] == pytest.approx((3.0 - sin(radians(30.0))) * G * 6.955, rel=0.01)
    c = truth(FlightPathSettings(), replace(RUN, duration=4.0))
    left = int(np.flatnonzero(c["rail_s"] >= 5.2)[0])
    assert c["fx"][left - 10] > 0.0
    assert c["fx"][left + 10] < 0.5 * G


def test_the_load_of_a_manoeuvre_is_reached_and_turns_the_path() -> None:
    """A push-over to 0 g and a pull-up to 4 g in the middle of their legs; f_x holds the lift's share by α."""
    legs = (LegSettings(6.0, airspeed=60.0), LegSettings(2.0, climb_deg=0.0), LegSettings(2.0, load_g=4.0))
    c = truth(FlightPathSettings(legs=(*legs, LegSettings(3.0, load_g=0.0))))
    across = -(c["fz"] * np.cos(c["alpha"]) - c["fx"] * np.sin(c["alpha"]))
    start = int(np.flatnonzero(c["rail_s"] >= 5.2)[0])
    assert across[start + 9000] / G == pytest.approx(4.0, abs=1e-3)
    assert across[start + 11500] / G == pytest.approx(0.0, abs=1e-3)
    q = 0.5 * 1.225 * 60.0**2
    alpha = degrees(4.0 * G * 25.0 / (q * 4.8)) - 4.8
    assert np.degrees(c["alpha"][start + 9000]) == pytest.approx(alpha, abs=0.15)  # ρ is that at 100 m
    path = np.arctan2(-c["vd"], c["vn"])
    expected = G * sin(path[start + 9000]) * cos(c["alpha"][start + 9000]) + 4.0 * G * sin(c["alpha"][start + 9000])
    assert c["fx"][start + 9000] == pytest.approx(expected, abs=0.02)


def test_a_leg_that_the_record_ends_in_is_flown_as_far() -> None:
    legs = (LegSettings(2.0, airspeed=60.0, climb_deg=0.0), LegSettings(6.0, load_g=1.5))
    whole = truth(FlightPathSettings(legs=legs), replace(RUN, duration=12.0))
    cut = truth(FlightPathSettings(legs=legs), replace(RUN, duration=6.0))
    for name in ("fx", "fz", "altitude", "airspeed"):
        assert cut[name][:-2] == pytest.approx(whole[name][:5999], abs=1e-9)


def test_a_coordinated_turn() -> None:
    """χ' = g tan μ/V, 1/cos μ of load, and no force to the side, in any mean wind."""
    air = EnvironmentSettings(wind_speed=8.0, wind_from_deg=200.0, wind_profile="uniform")
    legs = (LegSettings(4.0, airspeed=40.0, climb_deg=0.0), LegSettings(2.0, bank_deg=60.0))
    c = truth(FlightPathSettings(legs=legs), replace(RUN, environment=air, duration=15.0))
    late = slice(9_500, 14_000)
    assert np.gradient(c["heading"])[late] * 1000.0 == pytest.approx(G * tan(radians(60.0)) / 40.0, rel=1e-4)
    assert np.hypot(c["fx"], c["fz"])[late] == pytest.approx(2.0 * G, rel=1e-4)
    assert np.abs(c["fy"][late]).max() < 1e-6
    assert np.abs(c["beta"][late]).max() < 1e-9
    assert c["airspeed"][late] == pytest.approx(40.0, abs=1e-9)
    assert c["r"][late] == pytest.approx(G * tan(radians(60.0)) / 40.0 * 0.5, rel=5e-3)  # χ' cos μ cos α


def test_air_and_pressures_agree() -> None:
    """Standard lapse from the ground; M, p_t and the airspeed by their equations; v - w is what flies."""
    air = replace(ROUGH, temperature_offset=12.0, gust_speed=4.0, gust_at="rail-exit", gust_delay=1.0)
    c = truth(FlightPathSettings(legs=LEGS), replace(RUN, environment=air))
    r = 6_356_766.0
    height = r * c["altitude"] / (r + c["altitude"])
    warm = airdata.standard_temperature(height) + 12.0
    assert c["temperature"] == pytest.approx(warm, abs=1e-9)
    ground = airdata.standard_pressure(r * 400.0 / (r + 400.0))
    base = airdata.standard_temperature(r * 400.0 / (r + 400.0)) + 12.0
    assert c["p_static"] == pytest.approx(ground * (warm / base) ** 5.25588, rel=1e-7)
    through = vectors(c, "vn", "ve", "vd") - vectors(c, "wind_n", "wind_e", "wind_d")
    assert np.linalg.norm(through, axis=1) == pytest.approx(c["airspeed"], abs=1e-9)
    found = airdata.airspeed(total=c["p_total"], static=c["p_static"], temperature=c["temperature"])
    assert found == pytest.approx(c["airspeed"], abs=1e-3)
    assert np.ptp(c["gust_n"]) == pytest.approx(4.0, rel=1e-3)
    assert np.std(c["wind_n"] - c["mean_wind_n"] - c["gust_n"]) > 0.2
    assert c["airspeed"][:1000].mean() > 3.0  # the wind blows on the rail
    on_rail = np.hypot(c["mean_wind_n"], c["mean_wind_e"])[:1000]
    assert on_rail == pytest.approx(6.0 * np.log(2.0 / 0.04572) / np.log(6.096 / 0.04572), rel=0.1)


def test_the_air_at_rest_is_that_in_which_the_aircraft_flies() -> None:
    """By height, 0.02 Pa and 1e-6 K: JSBSim's atmosphere of a warm, humid day of low pressure at 1500 m."""
    day = ("ground_elevation=1500", "temperature_offset=20", "sea_level_pressure=99000", "humidity=0.6")
    flight = fly("catapult", seed=3, overrides=["duration=8", *(f"environment.{key}" for key in day)])
    environment = Scenario.from_dict(flight.scenario).environment
    pressure, temperature = still_air(environment, flight.truth["altitude"].to_numpy() - 1500.0)
    assert np.ptp(flight.truth["altitude"]) > 4.0
    assert flight.truth["p_static"].to_numpy() == pytest.approx(pressure, abs=0.02)
    assert flight.truth["temperature"].to_numpy() == pytest.approx(temperature, abs=1e-6)


def test_it_flies_with_what_is_on_board_and_replays() -> None:
    flight = fly("manoeuvres", seed=3, overrides=["duration=9"])
    names = [event["event"] for event in flight.events]
    assert names[:5] == ["ready", "launch_detected", "stroke_end", "wings_commanded", "motor_on"]
    assert flight.score["outcome"] == "completed"
    assert 0.005 < flight.score["launch"]["latency"] < 0.03
    assert any("legs[" in remark for remark in flight.score["remarks"])
    again = replay(flight)
    assert again.events == flight.events
    assert again.estimate.equals(flight.estimate)


def test_the_wash_of_the_propeller_at_full_throttle_is_at_both_ports() -> None:
    """At η = 1: p_t + e_t q_c at the total port, p_s + (1 + e_s) c₀ q_c at the static one, of a BMP581."""
    quiet = [
        f"air_data.{name}.{key}"
        for name in ("total", "static")
        for key in ("preset=bmp581", "noise_scale=0", "unit=ideal")
    ]
    wash = (
        "total_port.slipstream=0.2", "static_port.slipstream=0.5", "static_port.error=0.04",
        "static_port.error_alpha2=0", "static_port.error_beta2=0",
    )  # fmt: skip
    legs = "plant.flight_path.legs=[{duration=2,airspeed=40,climb_deg=0},{duration=1,throttle=1}]"
    still = [f"air_data.{name}.errors.{what}=0" for name in ("total", "static") for what in ("drift", "random_walk")]
    flight = fly(
        "manoeuvres", seed=3, overrides=[*quiet, *still, *(f"air_data.{key}" for key in wash), legs, "duration=9"]
    )
    true, read = flight.truth.iloc[-1], flight.air_data.iloc[-1]
    q = true["p_total"] - true["p_static"]
    assert true["throttle"] == 1.0
    assert q > 900.0
    assert read["p_total"] - true["p_total"] == pytest.approx(0.2 * q, abs=0.1)
    assert read["p_static"] - true["p_static"] == pytest.approx(1.5 * 0.04 * q, abs=0.1)


@pytest.mark.parametrize(
    ("settings", "level", "says"),
    [
        (FlightPathSettings(legs=(LegSettings(2.0, load_g=2.0, climb_deg=3.0),)), 8.0, "load_g or climb_deg"),
        (FlightPathSettings(legs=(LegSettings(10.0, load_g=6.0),)), 8.0, r"legs\[0\]: its path gets steeper than 85"),
        (FlightPathSettings(legs=(LegSettings(5.0, climb_deg=-30.0), LegSettings(9.0))), 8.0, "goes into the ground"),
        (FlightPathSettings(legs=(LegSettings(3.0, airspeed=12.0), LegSettings(5.0, bank_deg=70.0))), 8.0, "angle of"),
        (FlightPathSettings(push="bungee"), 0.3, "does not bring it to the end"),
    ],
)
def test_what_cannot_be_flown_is_refused_in_a_line(settings: FlightPathSettings, level: float, says: str) -> None:
    run = replace(RUN, launcher=LauncherSettings(peak_specific_force_g=level))
    with pytest.raises(ValueError, match=says) as refused:
        FlightPath(settings, run)
    assert "\n" not in str(refused.value)


def test_it_says_which_keys_it_reads() -> None:
    scenario = Scenario.from_dict({"plant": {"kind": "flight-path"}})
    assert unread(scenario, "environment.wind_speed") == ""
    assert unread(scenario, "launcher.stroke") == ""
    assert unread(scenario, "launcher.friction") == "is not read by plant.kind = 'flight-path', a rig"
    assert unread(scenario, "plant.wind_tunnel.hold") != ""
