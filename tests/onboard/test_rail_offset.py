"""The accelerometer's offset on the rail: what is found of readings made by hand.

Authority: the posterior of a Gaussian prior and one Gaussian measurement, K = σ²/(σ² + σ_e²); at rest a body of
elevation θ feels (g sin θ, 0, −g cos θ).
"""

from collections.abc import Callable
from dataclasses import replace
from math import cos, hypot, radians, sin

import numpy as np
import pytest

from uavsim.onboard.airspeed import NoiseModel
from uavsim.onboard.rail_offset import RailOffset, known

G = 9.80665
ELEVATION = radians(12.5)
FELT = (G * sin(ELEVATION), 0.0, -G * cos(ELEVATION))
NOISE = NoiseModel(
    3.7, 3.7, 0.5, accelerometer_sd=0.8, accelerometer_rate=200.0, accelerometer_offset_sd=0.2, side_offset_sd=0.2,
    lift_offset_sd=0.2, own_offset_sd=0.2, own_side_offset_sd=0.2, own_lift_offset_sd=0.2, rail_elevation=ELEVATION,
    rail_elevation_sd=radians(0.5),
)  # fmt: skip
WIDE = replace(NOISE, accelerometer_offset_sd=5.0, side_offset_sd=5.0, lift_offset_sd=5.0)
Course = Callable[[float], tuple[float, float, float]]


def read(noise: NoiseModel, course: Course, until: float = 3.0) -> RailOffset:
    """Feed readings at 200 Hz with white noise of 0.8 m/s²."""
    rail, random = RailOffset(noise), np.random.default_rng(5)
    for k in range(round(until * 200.0)):
        t = k / 200.0
        x, y, z = (f + 0.8 * float(random.standard_normal()) for f in course(t))
        rail.add(t, x, y, z)
    return rail


def with_offset(x: float, y: float, z: float) -> Course:
    return lambda _: (FELT[0] + x, FELT[1] + y, FELT[2] + z)


@pytest.mark.parametrize("offset", [(5.0, -5.0, 5.0), (-20.0, 20.0, -20.0), (0.0, 0.0, 0.0)])
def test_a_believed_offset_is_found_on_each_axis(offset: tuple[float, float, float]) -> None:
    """To five times the noise of a mean over a second, 0.8/√200 m/s², where the prior has hardly a word."""
    believed = replace(WIDE, accelerometer_offset_sd=20.0, side_offset_sd=20.0, lift_offset_sd=20.0)
    found = read(believed, with_offset(*offset))
    assert found.found
    assert found.offset == pytest.approx(offset, abs=0.3)
    assert found.sd[0] == pytest.approx(G * cos(ELEVATION) * radians(0.5), rel=0.01)
    assert found.sd == pytest.approx(known(believed))


def test_rail_and_description_share_a_remainder_by_their_variances() -> None:
    rail_sd = hypot(G * cos(ELEVATION) * radians(0.5), 0.015 * sin(ELEVATION))
    gain = 0.2**2 / (0.2**2 + rail_sd**2)
    found = read(NOISE, with_offset(0.5, 0.0, 0.0))
    assert found.offset[0] == pytest.approx(0.5 * gain, abs=0.15)
    assert found.sd[0] == pytest.approx(gain**0.5 * rail_sd)


def test_a_remainder_beyond_four_deviations_is_told_once_with_both_readings_of_it() -> None:
    """3 m/s² of f_x are an offset, or a rail that stands 18.2° higher: asin(0.216 + 0.306) − 12.5°."""
    found = read(NOISE, with_offset(3.0, 0.0, 0.0))
    assert found.odd is not None
    along, lift, elevation = found.odd
    assert (along, lift) == pytest.approx((3.0, 0.0), abs=0.3)
    assert elevation == pytest.approx(18.97, abs=2.0)
    assert read(NOISE, with_offset(0.4, 0.0, 0.0)).odd is None


def test_what_is_beyond_four_deviations_stays_in_the_bar() -> None:
    """A part that is held upright must not have 8 m/s² taken off."""
    found = read(NOISE, lambda _: (G, 0.0, 0.0))
    assert found.offset[0] == pytest.approx(0.8)
    assert found.sd[0] > 4.0


def test_handling_and_the_begin_of_a_stroke_find_nothing() -> None:
    """Turned by 40° in a second, and 8 g in the last 30 ms of a block: the offset stays what it was before."""

    def handled(t: float) -> tuple[float, float, float]:
        if t < 1.2:
            return FELT
        pitch = ELEVATION + radians(40.0) * sin(4.0 * (t - 1.2))
        return G * sin(pitch), 0.0, -G * cos(pitch)

    before = read(WIDE, lambda _: FELT, until=1.2).offset
    assert read(WIDE, handled, until=4.0).offset == before

    def launched(t: float) -> tuple[float, float, float]:
        return (FELT[0] + 80.0, *FELT[1:]) if t >= 1.47 else FELT

    assert read(WIDE, launched, until=1.6).offset == before


def test_without_a_rail_nothing_is_taken_off() -> None:
    found = read(replace(NOISE, rail_elevation=None), with_offset(5.0, 0.0, 0.0))
    assert not found.found
    assert found.offset == (0.0, 0.0, 0.0)


def test_readings_that_are_no_numbers_begin_a_block_anew() -> None:
    nan = float("nan")
    found = read(WIDE, lambda t: (nan, nan, nan) if 0.4 < t < 1.1 else FELT, until=2.0)
    assert not found.found
    assert read(WIDE, lambda t: (nan, nan, nan) if 0.4 < t < 1.1 else FELT, until=2.4).found
