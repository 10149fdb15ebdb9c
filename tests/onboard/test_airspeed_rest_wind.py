"""The wind that the head sees on the rail, and gusts that fall with height; figures by hand."""

import math

import numpy as np
import pytest

from uavsim.onboard.airspeed import AidedFilter, AidedSettings, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.gust import LOWEST, gust_density, shear_density
from uavsim.onboard.airspeed.rest_wind import HIDDEN, rest_difference, turning, wind_at_rest

DENSITY = 1.225
STATIC = 101_325.0


def rows(difference: float, sd: float = 0.0, count: int = 40, seed: int = 1) -> list[tuple[float, ...]]:
    """Conversions every 10 ms from 1 s on, tared already."""
    noise = sd * np.random.default_rng(seed).standard_normal(count)
    times = [1.0 + 0.01 * k for k in range(count)]
    return [(t, STATIC + difference + e, STATIC, 288.15, t, t) for t, e in zip(times, noise.tolist(), strict=True)]


def seen(readings: list[tuple[float, ...]], **changes: float) -> tuple[float, float]:
    given = {"start": 0.9, "end": 2.0, "density": DENSITY} | changes
    found = rest_difference(readings, start=given["start"], end=given["end"], each=4.0)
    return wind_at_rest(found, 0.0, 0.0, given["density"])


def test_a_wind_well_above_the_noise_is_seen() -> None:
    """6 m/s are 22.05 Pa; σ = 2/√40 = 0.316 Pa makes σ_w = σ/(ρ w) = 0.043 m/s."""
    wind, sd = seen(rows(0.5 * DENSITY * 36.0))
    assert wind == pytest.approx(6.0, rel=1e-12)
    assert sd == pytest.approx(2.0 / math.sqrt(40.0) / (DENSITY * 6.0), rel=1e-12)


def test_the_seen_wind_is_off_by_what_is_claimed() -> None:
    """500 draws; χ² of 500 at 1e-4 either side: 0.78 … 1.25."""
    found = [seen(rows(0.5 * DENSITY * 36.0, sd=2.0, seed=k)) for k in range(500)]
    assert 0.78 < np.mean([((w - 6.0) / sd) ** 2 for w, sd in found]) < 1.25


def test_what_the_noise_hides_is_none_and_as_uncertain() -> None:
    wind, sd = seen(rows(0.1))
    star = math.sqrt(2.0 * 2.0 / math.sqrt(40.0) / DENSITY)
    assert wind == 0.0
    assert sd == pytest.approx(math.hypot(math.sqrt(0.2 / DENSITY), HIDDEN * star), rel=1e-9)
    assert seen(rows(-3.0)) == (0.0, pytest.approx(HIDDEN * star))


def test_covered_and_late_conversions_and_too_few_say_nothing() -> None:
    readings = rows(22.05)
    assert seen(readings, start=1.36) == (0.0, math.inf)  # two are left
    assert seen(readings, end=1.011) == (0.0, math.inf)
    assert seen([(t, math.nan, p, T, a, b) for t, _, p, T, a, b in readings]) == (0.0, math.inf)
    assert seen([readings[0]] * 40) == (0.0, math.inf)  # one conversion, read again and again
    assert seen(readings, density=math.nan) == (0.0, math.inf)


def test_a_headwind_is_told_from_a_tailwind_where_one_reading_can() -> None:
    assert turning(0.0, 4.0, DENSITY) == 0.0
    assert turning(6.0, 4.0, DENSITY) == pytest.approx(7.8)  # 0.3 w
    assert turning(3.0, 4.0, DENSITY) == pytest.approx(3.0 + 6.0 / (DENSITY * 3.0))
    assert turning(1.0, 4.0, DENSITY) == pytest.approx(2.5)  # at most 1.5 w


@pytest.mark.parametrize("wind", [5.0, -5.0])
def test_a_launch_in_wind_is_known_by_its_end(wind: float) -> None:
    """80 m/s² for 0.3 s from a rail in 5 m/s from ahead or behind; noise of 1 Pa; at the end right to 0.3 m/s."""
    noise = NoiseModel(1.0, 1.0, 0.0, accelerometer_sd=0.1)
    estimator = AidedFilter(EstimatorSettings(), noise, (0.5, 1.5))
    generator = np.random.default_rng(3)
    estimate = None
    for k in range(2301):
        t = k * 1e-3
        push = 80.0 if t >= 2.0 else 0.0
        estimator.accelerometer(t, 2.0 + push + 0.1 * generator.standard_normal(), 0.0, -9.6)
        if k == 2040:
            estimator.launched(t)
        if k % 10 == 0:
            speed = 0.0 if t <= 1.5 else wind + 80.0 * max(t - 2.0, 0.0)
            total = STATIC * (1.0 + speed**2 / (7.0 * 287.055 * 288.15)) ** 3.5
            p_t, p_s = total + generator.standard_normal(), STATIC + generator.standard_normal()
            estimate = estimator.step(t, p_t, p_s, 288.15, t, t)
    assert estimate is not None
    assert estimate[1] == pytest.approx(wind + 24.0, abs=0.3)
    assert abs(estimate[1] - wind - 24.0) < 4.0 * estimate[2]


# -- gusts -----------------------------------------------------------------------------------------------------------


def test_gusts_fall_with_height_down_to_those_of_calm_air() -> None:
    declared = AidedSettings(gust_sd=1.0, gust_length=100.0, gust_height=20.0)
    assert gust_density(declared, 20.0) == pytest.approx(0.02)
    # (0.177 + 0.000823 h)^0.4/h with h of 131.2, 65.6 and 10 ft
    assert gust_density(declared, 40.0) == pytest.approx(0.01 * (0.2850 / 0.2310) ** 0.4, rel=1e-3)
    least = 0.02 * 20.0 / LOWEST * (0.18523 / 0.2310) ** 0.4
    assert gust_density(declared, -5.0) == gust_density(declared, LOWEST) == pytest.approx(least, rel=1e-3)
    assert gust_density(declared, 2000.0) == gust_density(declared, 304.8)
    weak = AidedSettings(gust_sd=0.3, gust_length=100.0, gust_height=20.0)
    assert gust_density(weak, 1e6) == pytest.approx(2.0 * 0.04 / 100.0)


def test_without_a_height_they_are_the_same_everywhere() -> None:
    plain = AidedSettings(gust_sd=1.0, gust_length=100.0)
    assert gust_density(plain, 3.0) == gust_density(plain, 300.0) == pytest.approx(0.02)
    assert gust_density(AidedSettings(), 3.0) == pytest.approx(2.0 * 0.04 / 200.0)


def test_the_airspeed_wanders_by_the_winds_growth_while_it_climbs() -> None:
    """w² |ḣ|/h a second, ḣ = V s/g: 2.4 m/s a factor e, 3 m/s² · V/g, 12 m: 2.4² · 3/(9.80665 · 12) m/s² of density."""
    grows = AidedSettings(shear=2.4)
    assert shear_density(grows, 12.0, 3.0) == pytest.approx(2.4**2 * 3.0 / (9.80665 * 12.0), rel=1e-12)
    assert shear_density(grows, 12.0, -3.0) == shear_density(grows, 12.0, 3.0)
    assert shear_density(grows, 1.0, 3.0) == shear_density(grows, LOWEST, 3.0)
    assert shear_density(grows, 12.0, 0.0) == shear_density(AidedSettings(), 12.0, 3.0) == 0.0
