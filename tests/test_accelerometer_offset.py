"""Offsets of the accelerometer, flown: they are in the belief, so no port is blamed and the airspeed stays right.

The bound on the error is that of the pressures alone, `rmse_raw`: an offset must not make the filter worse than none.
Coverage of 95 % intervals of one flight, whose errors are correlated over seconds, is held to 0.9.
"""

import pytest

import sensors
import uavsim
from sensors import AccelerometerDescription
from uavsim.flight import Flight

PARTS = [name for name in sensors.presets() if isinstance(sensors.preset(name), AccelerometerDescription)]


def fly(*overrides: str, seed: int = 1, scenario: str = "catapult") -> Flight:
    return uavsim.fly(scenario, seed=seed, overrides=overrides)


def check(flight: Flight) -> None:
    airspeed = flight.score["airspeed"]
    assert flight.score["outcome"] == "cruise"
    assert airspeed["rmse"] < airspeed["rmse_raw"]
    assert airspeed["coverage_95"] >= 0.9
    assert [e for e in flight.events if e["event"] == "airspeed_fault"] == []


@pytest.mark.parametrize("bias", [-5.0, -2.0, 1.0, 2.0, 3.0, 5.0])
def test_an_offset_is_survived(bias: float) -> None:
    check(fly(f"accelerometer.bias={bias}", seed=2))


def test_an_offset_with_a_noisy_sensor_is_survived() -> None:
    """What the README shows."""
    check(fly("air_data.total.noise_scale=3", "accelerometer.bias=2.0"))


@pytest.mark.parametrize("part", PARTS)
def test_each_part_flies(part: str) -> None:
    check(fly(f"accelerometer.preset={part}", seed=1))


def test_an_offset_that_is_kept_from_the_belief_is_not_survived() -> None:
    """Through [mismatch]: what the belief is good for."""
    flight = fly("accelerometer.bias=3.0", "mismatch.accelerometer_offset=0")
    assert flight.score["airspeed"]["rmse"] > flight.score["airspeed"]["rmse_raw"]


def test_an_offset_beyond_the_stroke_ends_level_opens_the_wings() -> None:
    """12 m/s² is more than the 1 g below which f_x, less what it was on the rail, must fall."""
    flight = fly("accelerometer.bias=12.0")
    assert {"stroke_end", "wings_commanded"} <= {e["event"] for e in flight.events}
    assert flight.score["outcome"] == "cruise"
