"""Assumptions about sensors, flown: each setting does in the loop what its docstring says.

Figures are those of mechanics and of gas dynamics; tolerances cover noise and what the filter lags behind. The
published estimator flies: it takes what the pressures say, where the aided one weighs them against the force.
"""

import math

import numpy as np
import pytest

import uavsim
from uavsim.flight import Flight
from uavsim.truth import STANDARD_GRAVITY

# An accelerometer and a head without errors: what is left is the setting under test.
IDEAL = (
    "accelerometer.unit=ideal",
    "accelerometer.noise_scale=0",
    "accelerometer.vibration_scale=0",
    "accelerometer.errors.drift=0",
    "accelerometer.errors.random_walk=0",
    "accelerometer.errors.bandwidth=false",
    "air_data.position=[0,0,0]",  # next to the centre of gravity, whose flow the truth is
    "air_data.total_port.probe=ideal",
    "air_data.static_port.error=0",
    "air_data.static_port.error_alpha2=0",
    "air_data.static_port.error_beta2=0",
    "air_data.total.unit=ideal",
    "air_data.static.unit=ideal",
    "air_data.total.noise_scale=0",
    "air_data.static.noise_scale=0",
    "air_data.total.errors.drift=0",
    "air_data.static.errors.drift=0",
    "air_data.total.errors.random_walk=0",
    "air_data.static.errors.random_walk=0",
    "air_data.total.errors.quantisation=false",
    "air_data.static.errors.quantisation=false",
)
REST = ("launcher.wait_min=2", "launcher.wait_max=2", "duration=2.2")
WHOLE_STROKE = ("launcher.wait_min=2", "launcher.wait_max=2", "launcher.force_spread=0", "duration=3")


def fly(*overrides: str, seed: int = 1, scenario: str = "catapult") -> Flight:
    return uavsim.fly(scenario, seed=seed, overrides=["estimator.kind=paper", *overrides])


def values(flight: Flight, table: str, *names: str) -> np.ndarray:
    return flight.tables[table][list(names)].to_numpy().T


def true_at(flight: Flight, name: str, t: np.ndarray) -> np.ndarray:
    return np.interp(t, flight.truth["t"], flight.truth[name])


# -- accelerometer ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mounting", [(0, 0, 0), (0, 90, 0), (180, 0, 0), (90, 0, -90), (10, -20, 30)])
def test_what_is_known_of_the_mounting_is_undone_on_board(mounting: tuple[int, int, int]) -> None:
    """Readings are in the case's axes: Rᵀ f; the launch is seen all the same, at the same sample or the next."""
    plain, turned = (
        fly(*IDEAL, *WHOLE_STROKE),
        fly(*IDEAL, *WHOLE_STROKE, f"accelerometer.mounting_deg={list(mounting)}"),
    )
    rotation = rotation_of(*mounting)
    step = 32 * STANDARD_GRAVITY / 2**15
    case = values(turned, "accelerometer", "fx", "fy", "fz")
    assert np.abs(rotation @ case - values(plain, "accelerometer", "fx", "fy", "fz")).max() <= 2.0 * step
    late = turned.score["launch"]["detected_time"] - plain.score["launch"]["detected_time"]
    assert abs(late) < 1.5 / 833.0


def rotation_of(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """R_z R_y R_x, written out from elementary turns."""
    r, p, y = np.radians([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, math.cos(r), -math.sin(r)], [0, math.sin(r), math.cos(r)]])
    about_y = np.array([[math.cos(p), 0, math.sin(p)], [0, 1, 0], [-math.sin(p), 0, math.cos(p)]])
    about_z = np.array([[math.cos(y), -math.sin(y), 0], [math.sin(y), math.cos(y), 0], [0, 0, 1]])
    rotation: np.ndarray = about_z @ about_y @ about_x
    return rotation


def test_a_mounting_error_is_not_known_on_board() -> None:
    """5° nose up on a rail of 12.5°: the case reads what it would at 17.5°."""
    flight = fly(*IDEAL, *REST, "accelerometer.mounting_error_deg=[0,5,0]")
    fx, _, fz = values(flight, "accelerometer", "fx", "fy", "fz")[:, 200:1500].mean(axis=1)
    assert math.degrees(math.atan2(fx, -fz)) == pytest.approx(17.5, abs=0.02)


def test_the_lever_arm_is_felt_and_is_part_of_the_truth() -> None:
    """0.3 m ahead of the own place: f_z differs by (p r - q̇) 0.3 m; tip-off and flight turn the nose.

    A launch that is missed: no command ever parts the two flights. q̇ is a central difference over 2 ms: away from the
    shoes' contacts 5 %.
    """
    weak = [*IDEAL, "launcher.wait_min=2", "launcher.wait_max=2", "duration=3.2"]
    here = fly(*weak, scenario="weak-launch")
    ahead = fly(*weak, "accelerometer.position=[0.3,0,0]", scenario="weak-launch")
    t = here.truth["t"].to_numpy()
    p, q, r = (here.truth[c].to_numpy() for c in "pqr")
    for flight in (here, ahead):
        read_t, fz = values(flight, "accelerometer", "t", "fz")
        assert np.abs(fz - true_at(flight, "fz", read_t))[read_t > 0.01].max() <= 32 * STANDARD_GRAVITY / 2**15
    difference = ahead.truth["fz"].to_numpy() - here.truth["fz"].to_numpy()
    expected = (p * r - np.gradient(q, t)) * 0.3
    free = t > here.score["flight"]["rail_exit_time"] + 0.01
    assert np.abs(expected[free]).max() > 0.1
    assert np.abs(difference - expected)[free][:-1].max() < 0.05 * np.abs(expected[free]).max()


def test_delay_makes_the_detection_late() -> None:
    plain, late = fly(*WHOLE_STROKE), fly(*WHOLE_STROKE, "accelerometer.delay=0.010")
    assert late.score["launch"]["latency"] - plain.score["launch"]["latency"] == pytest.approx(0.010, abs=2.5 / 833.0)


@pytest.mark.parametrize(
    ("fault", "outcome"),
    [
        ('{kind="stuck",axis="x"}', "missed_launch"),
        ('{kind="invalid"}', "missed_launch"),
        ('{kind="dropout"}', "missed_launch"),
        ('{kind="spike",probability=0.002,size=150}', "cruise"),  # one sample in 500 opens no wings
        ('{kind="dropout",probability=0.1}', "cruise"),
    ],
)
def test_what_an_accelerometer_fault_does_to_the_launch(fault: str, outcome: str) -> None:
    flight = fly(f"accelerometer.faults=[{fault}]")
    assert flight.score["outcome"] == outcome
    assert flight.score["launch"]["false_detections"] == 0


def test_vibration_of_a_motor_is_felt_and_aliases() -> None:
    """A tone of 300 Hz read at 416 Hz through the part's low-pass stands at 416 - 300 = 116 Hz."""
    shaken = fly(
        *REST, "accelerometer.rate=416", "vibration.tones=[{frequency_hz=300,amplitude_g=[0,1,0]}]"
    )  # fmt: skip
    _, fy = values(shaken, "accelerometer", "t", "fy")
    spectrum = np.abs(np.fft.rfft((fy - fy.mean()) * np.hanning(fy.size)))
    peak = np.fft.rfftfreq(fy.size, 1 / 416)[np.argmax(spectrum)]
    assert peak == pytest.approx(116.0, abs=1.0)


# -- head ------------------------------------------------------------------------------------------------------------


def head_errors(flight: Flight) -> tuple[np.ndarray, np.ndarray]:
    """Readings of the head less the truth at the middle of their conversions (BMP390, x1: 4.82 ms), from 0.05 s on."""
    t_total, t_static, p_total, p_static, t = values(
        flight, "air_data", "t_total", "t_static", "p_total", "p_static", "t"
    )
    half = 0.5 * 4.82e-3
    return (
        (p_total - true_at(flight, "p_total", t_total - half))[t > 0.05],
        (p_static - true_at(flight, "p_static", t_static - half))[t > 0.05],
    )


def test_an_ideal_head_reads_the_truth() -> None:
    total, static = head_errors(fly(*IDEAL, *WHOLE_STROKE, "air_data.tare=none"))
    assert np.abs(total).max() < 0.1
    assert np.abs(static).max() < 0.1


def test_the_pipe_adds_the_weight_of_its_air() -> None:
    """ρ f_x L in the stroke: 5 cm at 8 g are 4.8 Pa on the total port; the static pipe stands upright."""
    plain = head_errors(fly(*IDEAL, *WHOLE_STROKE, "air_data.tare=none"))
    flight = fly(*IDEAL, *WHOLE_STROKE, "air_data.tare=none", "air_data.pipe=0.05")
    total, static = head_errors(flight)
    t = flight.air_data["t"].to_numpy()
    t = t[t > 0.05]
    plateau = (t > 2.06) & (t < 2.30)
    density = 1.225
    assert total[plateau].mean() == pytest.approx(density * 8 * STANDARD_GRAVITY * 0.05, rel=0.1)
    upright = density * STANDARD_GRAVITY * math.cos(math.radians(12.5)) * 0.05
    assert static[plateau].mean() == pytest.approx(upright, abs=0.1)  # the sensor is below its port
    assert np.abs(plain[0]).max() < 0.1


def test_a_membrane_that_faces_ahead_feels_the_push() -> None:
    """A typical unit, 0.2 Pa/(m/s²) along its normal: 15.7 Pa at 8 g on the total sensor, gravity on the static one."""
    typical = ["air_data.total.unit=typical", "air_data.static.unit=typical"]
    settings = [o for o in IDEAL if not o.startswith(("air_data.total.unit", "air_data.static.unit"))] + typical
    plain = fly(*settings, *WHOLE_STROKE, "air_data.tare=none")
    feeling = fly(*settings, *WHOLE_STROKE, "air_data.tare=none", "air_data.acceleration_sensitivity=true")
    t = feeling.air_data["t"].to_numpy()
    plateau = (t > 2.06) & (t < 2.30)
    for name, f in (("p_total", 8.0), ("p_static", -math.cos(math.radians(12.5)))):
        difference = (feeling.air_data[name] - plain.air_data[name])[plateau].mean()
        assert difference == pytest.approx(0.2 * f * STANDARD_GRAVITY, abs=0.3)


def test_a_blocked_port_holds_its_pressure() -> None:
    flight = fly(scenario="blocked-pitot")
    t, p_total = values(flight, "air_data", "t", "p_total")
    held = p_total[t > 12.05]
    assert np.abs(held - held.mean()).max() < 5.5 * 3.7  # of 2000 readings none is 5.5 σ off but once in 10⁴ runs
    assert np.ptp(flight.truth["p_total"][flight.truth["t"] > 13.0]) > 50.0
    assert flight.score["outcome"] == "timeout"


def test_position_error_is_a_share_of_the_impact_pressure() -> None:
    """c₀ = 0.05 at 32 m/s: p_static + 0.05 q_c, and so an airspeed of √0.95 of the true one."""
    flight = fly(
        *IDEAL, "air_data.static_port.error=0.05", "mismatch.position=0", "mismatch.position_sd=0", "duration=20"
    )
    cruise = flight.air_data["t"].to_numpy() > 12.0
    _, static = head_errors(flight)
    impact = true_at(flight, "p_total", flight.air_data["t"]) - true_at(flight, "p_static", flight.air_data["t"])
    kept = flight.air_data["t"].to_numpy() > 0.05
    share = static[cruise[kept]] / impact[cruise]
    assert share.mean() == pytest.approx(0.05, rel=0.02)
    ratio = flight.estimate["airspeed"].to_numpy() / true_at(flight, "airspeed", flight.estimate["t"])
    assert ratio[flight.estimate["t"] > 12.0].mean() == pytest.approx(math.sqrt(0.95), rel=2e-3)


def test_self_heating_reads_as_warm_air() -> None:
    """5 K, settled: the thermometer is 5 K off, the airspeed 5/2/288 = 0.87 %; its lag costs 0.1 K in the climb."""
    flight = fly(*IDEAL, "air_data.thermal.self_heating=5", "air_data.thermal.powered_for=3600", "duration=15")
    t, temperature = values(flight, "air_data", "t", "temperature")
    off = (temperature - true_at(flight, "temperature", t))[t > 0.1]
    assert off == pytest.approx(5.0, abs=0.12)
    ratio = flight.estimate["airspeed"].to_numpy() / true_at(flight, "airspeed", flight.estimate["t"])
    assert ratio[flight.estimate["t"] > 10.0].mean() == pytest.approx(math.sqrt(1.0 + 5.0 / 288.0), rel=1e-3)


@pytest.mark.parametrize("scenario", ["untared", "cheap-sensors", "blocked-pitot", "iced-pitot"])
def test_scenarios_about_sensors_end_as_they_say(scenario: str) -> None:
    # the push tells what an untared pair differs by; the pressures alone do not
    kind = "aided" if scenario == "untared" else "paper"
    flight = uavsim.fly(scenario, seed=1, overrides=[f"estimator.kind={kind}"])
    assert flight.score["outcome"] == flight.score["expected"]
    assert flight.score["launch"]["false_detections"] == 0


@pytest.mark.parametrize("scenario", ["catapult", "cheap-sensors"])
def test_a_term_more_changes_no_draw_of_any_other(scenario: str) -> None:
    """Up to the detection (then the flights part) every reading without the term is the same, bit for bit.

    A spike on the total pressure at one time alone changes that channel alone; a fault of a fault's kind, a second
    vibration or a delay of another sensor draws from streams of its own.
    """
    plain = fly(*REST, scenario=scenario)
    for added, untouched in (
        (
            'air_data.total.faults=[{kind="spike",size=100,probability=0.5}]',
            ("fx", "fy", "fz", "p_static", "temperature"),
        ),
        (
            'accelerometer.faults=[{kind="spike",size=100,probability=0.5,axis="x"}]',
            ("fy", "fz", "p_total", "p_static"),
        ),
        ("accelerometer.delay_jitter=0.001", ("p_total", "p_static", "temperature")),
        ("air_data.static.errors.drift_model=flicker", ("fx", "fy", "fz", "p_total")),
        ("accelerometer.errors.drift_model=flicker", ("p_total", "p_static", "temperature")),
    ):
        other = fly(*REST, added, scenario=scenario)
        for name in untouched:
            table = "accelerometer" if name.startswith("f") else "air_data"
            assert plain.tables[table][name].to_numpy().tobytes() == other.tables[table][name].to_numpy().tobytes(), (
                name
            )


@pytest.mark.parametrize(
    "quiet", [IDEAL, IDEAL[8:10], (*IDEAL[8:10], "air_data.total.preset=ms5611", "air_data.static.preset=ms5611")]
)
def test_sensors_without_noise_are_no_fault(quiet: tuple[str, ...]) -> None:
    """A sweep of the noise down to nothing flies: neither stillness nor steps of a part are taken for a shut port."""
    flight = uavsim.fly("catapult", seed=1, overrides=["duration=22", *quiet])
    assert [e for e in flight.events if e["event"] == "airspeed_fault"] == []
    assert flight.score["airspeed"]["rmse"] < 0.1
