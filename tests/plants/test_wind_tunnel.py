"""The wind tunnel by itself and with sensors in it.

Authorities: the answer of a first-order lag to steps and ramps; NACA Report 1135, table I (four printed digits); the
Dryden longitudinal spectrum's correlation e^{-τ V/L}; the definition of angle of attack and sideslip by the body
components of the stream.
"""

from dataclasses import replace
from math import atan2, cos, exp, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from uavsim import airdata, fly, settings
from uavsim.cosim import replay
from uavsim.plants.choice import PlantSettings
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import room
from uavsim.plants.rigs.wind_tunnel import WindTunnelSettings, stream, turbulence, wind_tunnel
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.settings import SettingError
from uavsim.truth import STANDARD_GRAVITY, UNITS

START = 2.0  # s, end of the wait
RUN = Run(environment=EnvironmentSettings(), launcher=LauncherSettings(), duration=30.0, release_time=START)


def run_to(plant: Any, time: float) -> Any:
    for _ in range(round(time * 1000.0)):
        plant.step()
    return plant


def test_each_speed_is_approached_with_the_lag_and_held() -> None:
    """V = V_set - (V_set - V_before) e^{-t/τ} after each step, to rounding."""
    speed, _, _ = stream(WindTunnelSettings(speeds=(10.0, 25.0), hold=5.0, settling=0.5), RUN)
    assert np.all(speed[: round(START * 1000) + 1] == 0.0)
    first = 10.0 * (1.0 - exp(-5.0 / 0.5))
    for time, expected in (
        (START + 0.5, 10.0 * (1.0 - exp(-1.0))),
        (START + 5.0, first),
        (START + 6.0, 25.0 - (25.0 - first) * exp(-2.0)),
        (30.0, 25.0 - (25.0 - first) * exp(-23.0 / 0.5)),
    ):
        assert speed[round(time * 1000)] == pytest.approx(expected, rel=1e-12)


def test_without_settling_the_speed_jumps() -> None:
    speed, _, _ = stream(WindTunnelSettings(speeds=(10.0, 5.0), hold=5.0, settling=0.0), RUN)
    assert speed[1999] == 0.0
    assert speed[2000] == speed[6999] == 10.0
    assert speed[7000] == speed[-1] == 5.0


def test_a_ramp_is_followed_one_time_constant_behind() -> None:
    """The answer of a first-order lag to a ramp of slope b trails it by b τ once it has settled."""
    speed, _, _ = stream(WindTunnelSettings(speeds=(40.0,), ramp=20.0, hold=1.0, settling=0.5), RUN)
    late = START + 15.0
    assert speed[round(late * 1000)] == pytest.approx(2.0 * (15.0 - 0.5), rel=1e-9)


def test_the_lag_agrees_with_its_differential_equation() -> None:
    """Central differences of the speed against (s - v)/τ on ramps and holds, to their own error of order h²."""
    chosen = WindTunnelSettings(speeds=(12.0, 30.0, 4.0), ramp=1.5, hold=2.0, settling=0.7)
    speed, _, _ = stream(chosen, RUN)
    knots = START + np.array([0.0, 1.5, 3.5, 5.0, 7.0, 8.5, 10.5])
    aim = np.interp(RUN.time, np.append(0.0, knots), [0.0, 0.0, 12.0, 12.0, 30.0, 30.0, 4.0, 4.0])
    slope = (speed[2:] - speed[:-2]) / 2e-3
    away = np.abs(RUN.time[1:-1, None] - knots).min(axis=1) > 2e-3  # a corner has no derivative of the second order
    assert np.max(np.abs(slope - (aim - speed)[1:-1] / 0.7)[away]) < 1e-4


def test_a_run_takes_its_ramps_and_holds() -> None:
    plant = PlantSettings(
        kind="wind-tunnel", wind_tunnel=WindTunnelSettings(speeds=(1.0, 2.0, 3.0), ramp=2.0, hold=5.0)
    )
    assert plant.length == 21.0
    assert replace(plant, wind_tunnel=WindTunnelSettings(machs=(0.3, 0.5), hold=4.0)).length == 8.0


@pytest.mark.parametrize(
    ("mach", "pressure_ratio", "temperature_ratio"), [(0.3, 0.9395, 0.9823), (0.6, 0.7840, 0.9328)]
)
def test_mach_numbers_give_the_printed_ratios(mach: float, pressure_ratio: float, temperature_ratio: float) -> None:
    """NACA 1135, table I: p/p_t and T/T_t, to half of the last printed digit."""
    plant = run_to(wind_tunnel(WindTunnelSettings(machs=(mach,), hold=20.0), RUN), 20.0)
    total, static, temperature, found, *_ = plant.flow()
    pressure, warm = room(RUN.environment)
    assert found == pytest.approx(mach, rel=1e-12)
    assert static == pressure
    assert static / total == pytest.approx(pressure_ratio, abs=5.1e-5)
    assert temperature / warm == pytest.approx(temperature_ratio, abs=5.1e-5)


def test_the_condition_of_the_published_survey() -> None:
    """Mach 0.6 at 300 K and 101 325 Pa: 208.33 m/s and 129.24 kPa in total."""
    hot = replace(RUN, environment=EnvironmentSettings(temperature_offset=33.45))
    truth = run_to(wind_tunnel(WindTunnelSettings(machs=(0.6,), hold=20.0), hot), 20.0).truth()
    last = {name: values[-1] for name, values in truth.items()}
    assert last["temperature"] == pytest.approx(300.0, abs=1e-6)
    assert last["p_static"] == pytest.approx(101_325.0, abs=1e-6)
    assert last["airspeed"] == pytest.approx(0.6 * sqrt(1.4 * 287.05287 * 300.0), rel=1e-9)
    assert last["p_total"] == pytest.approx(101_325.0 * 1.072**3.5, rel=1e-9)


def test_total_temperature_is_that_of_the_room_and_its_drift() -> None:
    """T + V²/(2 c_p) = T_0 + drift t, with c_p = 3.5 · 287.05287 J/(kg K)."""
    chosen = WindTunnelSettings(speeds=(40.0, 20.0), temperature_drift=0.02, turbulence=0.02)
    speed, mach, temperature = stream(chosen, RUN)
    np.testing.assert_allclose(temperature + speed**2 / (7.0 * 287.05287), 288.15 + 0.02 * RUN.time, rtol=1e-13)
    np.testing.assert_allclose(speed, mach * airdata.speed_of_sound(temperature), rtol=1e-12)


def test_truth_is_read_back_by_the_compressible_relation() -> None:
    truth = run_to(wind_tunnel(WindTunnelSettings(speeds=(5.0, 280.0), hold=5.0), RUN), 12.0).truth()
    assert list(truth) == list(UNITS)
    back = airdata.airspeed(total=truth["p_total"], static=truth["p_static"], temperature=truth["temperature"])
    np.testing.assert_allclose(back, truth["airspeed"], rtol=1e-9, atol=1e-6)


# -- turbulence ------------------------------------------------------------------------------------------------------


def test_turbulence_has_its_strength_and_its_length() -> None:
    """Variance 1 and correlation e^{-1} over L/V, from blocks that are ten correlation lengths long.

    10 000 blocks of one value each (correlated by e^{-10}): chi-square at 1e-4 a side, so a standard deviation that is
    off by 3.5 % is caught nine times in ten. The lag product of two Gaussians with correlation ρ has the variance
    1 + ρ²: at 4 standard errors, 0.043 away from e^{-1}.
    """
    n, every = 10_000, 500
    speed, dt, scale = 20.0, 1e-3, 1.0  # correlation time 50 ms
    x = turbulence(np.full(n * every, speed), dt, scale, seed=5)
    apart, later = x[::every], x[50::every]
    low, high = chi2.ppf([1e-4, 1.0 - 1e-4], n)
    assert low < np.sum(apart**2) < high
    product = float(np.mean(apart * later))
    assert abs(product - exp(-1.0)) < 4.0 * sqrt((1.0 + exp(-2.0)) / n)


def test_turbulence_is_a_share_of_the_speed_and_stands_still_in_still_air() -> None:
    chosen = WindTunnelSettings(speeds=(20.0, 40.0), hold=14.0, settling=0.0)
    calm, _, _ = stream(chosen, RUN)
    rough, _, _ = stream(replace(chosen, turbulence=0.01, turbulence_length=0.2), RUN)
    assert np.all(rough[:2000] == 0.0)
    moving = calm > 0.0
    share = rough[moving] / calm[moving] - 1.0
    # 28 s at 10 and 5 ms of correlation are at least 1400 independent values: 4 standard errors of a deviation, 7.6 %
    assert np.std(share) == pytest.approx(0.01, rel=0.076)


def test_a_seed_fixes_every_bit_and_another_is_another() -> None:
    chosen = WindTunnelSettings(turbulence=0.05)
    one, again = stream(chosen, RUN)[0], stream(chosen, RUN)[0]
    other = stream(chosen, replace(RUN, random_seed=2))[0]
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


# -- the head in the stream ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (12.0, 0.0), (0.0, -20.0), (25.0, 30.0)])
def test_angles_are_those_of_the_stream_in_body_axes(alpha: float, beta: float) -> None:
    """α = atan2(w, u) and sin β = v/V of the stream turned by heading and pitch; 1 g whatever the angle."""
    chosen = WindTunnelSettings(alpha_deg=alpha, beta_deg=beta)
    truth = run_to(wind_tunnel(chosen, RUN), 10.0).truth()
    row = {name: float(values[-1]) for name, values in truth.items()}
    ahead = (
        row["vn"] - row["wind_n"],
        row["ve"] - row["wind_e"],
        row["vd"] - row["wind_d"],
    )  # velocity through the air
    psi, theta = row["heading"], row["pitch"]
    forward = ahead[0] * cos(psi) + ahead[1] * sin(psi)
    v = -ahead[0] * sin(psi) + ahead[1] * cos(psi)
    u, w = forward * cos(theta) - ahead[2] * sin(theta), forward * sin(theta) + ahead[2] * cos(theta)
    assert atan2(w, u) == pytest.approx(radians(alpha), abs=1e-12)
    assert v / row["airspeed"] == pytest.approx(sin(radians(beta)), abs=1e-12)
    assert (row["alpha"], row["beta"]) == (radians(alpha), radians(beta))
    assert row["fx"] == pytest.approx(STANDARD_GRAVITY * sin(theta))
    assert row["fz"] == pytest.approx(-STANDARD_GRAVITY * cos(theta))
    assert row["fy"] == 0.0


QUIET = [
    "launcher.wait_min=2.0", "launcher.wait_max=2.0", "duration=10.0", "plant.wind_tunnel.speeds=[40.0]",
    "plant.wind_tunnel.hold=8.0", "plant.wind_tunnel.settling=0.0", "air_data.total.noise_scale=0.0",
    "air_data.static.noise_scale=0.0",
]  # fmt: skip


def at_the_end(*more: str) -> tuple[Any, Any]:
    flight = fly("wind-tunnel", overrides=[*QUIET, *more])
    return flight, flight.air_data.iloc[-1]


def test_sensors_without_noise_read_the_truth() -> None:
    flight, last = at_the_end()
    truth = flight.truth.iloc[-1]
    assert flight.score["outcome"] == "completed"
    assert last["p_total"] == pytest.approx(truth["p_total"], abs=1e-6)
    assert last["p_static"] == pytest.approx(truth["p_static"], abs=1e-6)


def test_a_port_in_suction_makes_the_static_pressure_fall() -> None:
    """A position error of -0.27 of the impact pressure, and nothing else: 5.9 m/s too much at 40."""
    flight, last = at_the_end("air_data.static_port.error=-0.27")
    truth = flight.truth.iloc[-1]
    impact = truth["p_total"] - truth["p_static"]
    assert last["p_static"] - truth["p_static"] == pytest.approx(-0.27 * impact, rel=1e-9)
    assert last["p_total"] == pytest.approx(truth["p_total"], rel=1e-12)


def test_a_plain_probe_loses_total_pressure_at_an_angle_and_a_shielded_one_does_not() -> None:
    """1 % of the impact pressure at 20° for the plain tube, by definition of its limit; nothing for the shielded."""
    losses = []
    for probe in ("plain", "kiel"):
        flight, last = at_the_end(f"air_data.total_port.probe={probe}", "plant.wind_tunnel.alpha_deg=20.0")
        truth = flight.truth.iloc[-1]
        losses.append((truth["p_total"] - last["p_total"]) / (truth["p_total"] - truth["p_static"]))
    assert losses[0] == pytest.approx(0.01, rel=1e-6)
    assert losses[1] == pytest.approx(0.01 / 9.0, rel=1e-6)  # (20 - 10)²/(40 - 10)² of its 1 %


def test_an_offset_is_the_bias_of_the_first_plateau_and_no_error() -> None:
    """50 Pa on the total sensor: `pressure.total.bias`, to four standard errors of the mean of 200 (4.7 Pa).

    What is left is the noise and the error of that mean: 16.54 Pa to 10 %.
    """
    flight = fly("wind-tunnel", overrides=[*QUIET[:5], "air_data.total.offset_pa=50.0", "estimator.kind=paper"])
    found = flight.score["pressure"]["total"]
    assert found["bias"] == pytest.approx(50.0, abs=4.7)
    assert found["rmse_raw"] == pytest.approx(16.54, rel=0.1)


def test_a_run_is_scored_from_its_first_to_its_last_row_and_replays_byte_for_byte() -> None:
    flight = fly("wind-tunnel", overrides=QUIET[:5])
    assert (
        flight.score["airspeed"]["samples"] >= 990
    )  # of 1000 readings in 10 s, less those before the first conversion
    again = replay(flight)
    assert again.estimate.equals(flight.estimate)
    assert again.score == flight.score


# -- bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"machs": [1.2]}, r"wind_tunnel\.machs"),
        ({"speeds": [-5.0]}, r"wind_tunnel\.speeds"),
        ({"speeds": []}, r"wind_tunnel\.speeds"),
        ({"hold": 0.0}, r"wind_tunnel\.hold"),
        ({"turbulence": 0.5}, r"wind_tunnel\.turbulence"),
        ({"speed": [5.0]}, "speeds"),
    ],
)
def test_settings_that_cannot_be_are_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(SettingError, match=words):
        settings.read(PlantSettings, {"kind": "wind-tunnel", "wind_tunnel": values})


@pytest.mark.parametrize(
    ("chosen", "cold"),
    [
        (WindTunnelSettings(speeds=(300.0,)), -60.0),  # Mach 1.1
        (WindTunnelSettings(machs=(0.9,), turbulence=0.2), 0.0),
    ],
)
def test_what_leads_beyond_mach_1_is_refused(chosen: WindTunnelSettings, cold: float) -> None:
    with pytest.raises(ValueError, match=r"plant\.wind_tunnel: what is set reaches Mach"):
        stream(chosen, replace(RUN, environment=EnvironmentSettings(temperature_offset=cold)))


def test_air_outside_what_is_known_is_refused() -> None:
    with pytest.raises(ValueError, match=r"plant\.wind_tunnel: the air gets"):
        stream(WindTunnelSettings(temperature_drift=0.1), replace(RUN, duration=1200.0))
