"""The mean wind by height and from every side.

Authority: MIL-F-8785C 3.7.3.2, W₂₀ ln(h/z₀)/ln(20 ft/z₀), and the power law, both written out here, to rounding.
"""

from math import atan2, cos, degrees, hypot, log, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uavsim.plants.air.settings import EnvironmentSettings
from uavsim.plants.air.wind import mean_wind

FOOT = 0.3048
HEIGHTS = (0.5, 1.5, 6.096, 20.0, 60.0, 250.0, 304.8)  # m
PROFILES = ("log", "power", "uniform")


def speed(environment: EnvironmentSettings, height: float) -> float:
    return hypot(*mean_wind(environment, height))


@pytest.mark.parametrize("feet", [3.0, 10.0, 20.0, 100.0, 1000.0])
@pytest.mark.parametrize("z0", [0.15, 2.0])
def test_logarithmic(feet: float, z0: float) -> None:
    """Roughness of take-off and landing, 0.15 ft, and of all else, 2 ft; z₀ is given in m, the law in feet."""
    environment = EnvironmentSettings(wind_speed=8.0, roughness=z0 * FOOT)
    assert speed(environment, feet * FOOT) == pytest.approx(8.0 * log(feet / z0) / log(20.0 / z0), rel=1e-12)


def test_the_roughness_is_by_itself_that_of_take_off_and_landing() -> None:
    assert EnvironmentSettings().roughness == pytest.approx(0.15 * FOOT)


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("exponent", [0.1, 1.0 / 7.0, 0.4])
def test_power(height: float, exponent: float) -> None:
    environment = EnvironmentSettings(wind_speed=8.0, wind_profile="power", wind_exponent=exponent)
    assert speed(environment, height) == pytest.approx(8.0 * (height / (20.0 * FOOT)) ** exponent, rel=1e-12)


@pytest.mark.parametrize("height", [-1.0, 0.0, *HEIGHTS, 900.0])
def test_uniform(height: float) -> None:
    assert speed(EnvironmentSettings(wind_speed=8.0, wind_profile="uniform"), height) == pytest.approx(8.0)


@pytest.mark.parametrize("profile", PROFILES)
def test_at_20_ft_it_is_what_the_scenario_says(profile: str) -> None:
    environment = EnvironmentSettings(wind_speed=8.0, wind_profile=profile, wind_from_deg=30.0, wind_veer=40.0)  # type: ignore[arg-type]
    north, east = mean_wind(environment, 6.096)
    assert (north, east) == pytest.approx((-8.0 * cos(radians(30.0)), -8.0 * sin(radians(30.0))), rel=1e-12)


@pytest.mark.parametrize("profile", PROFILES)
def test_above_1000_ft_it_stays_without_a_jump(profile: str) -> None:
    """Continuous at 304.8 m, 1e-6 m/s over 1 mm, and the same from there on, in speed and direction."""
    environment = EnvironmentSettings(wind_speed=8.0, wind_profile=profile, wind_veer=20.0)  # type: ignore[arg-type]
    top = mean_wind(environment, 304.8)
    assert mean_wind(environment, 304.799) == pytest.approx(top, abs=1e-4)
    for height in (304.801, 500.0, 2000.0):
        assert mean_wind(environment, height) == pytest.approx(top, abs=1e-12)
    assert mean_wind(environment, 200.0) != pytest.approx(top, abs=0.1)


@pytest.mark.parametrize("height", [-1.0, 0.0, 0.01, 0.04572])
def test_there_is_no_logarithmic_wind_below_the_roughness(height: float) -> None:
    assert mean_wind(EnvironmentSettings(wind_speed=8.0), height) == (0.0, 0.0) or height > 0.045
    assert speed(EnvironmentSettings(wind_speed=8.0), height) == pytest.approx(0.0, abs=1e-9)


def test_nor_a_wind_by_power_below_the_ground() -> None:
    environment = EnvironmentSettings(wind_speed=8.0, wind_profile="power")
    assert speed(environment, 0.0) == speed(environment, -3.0) == 0.0


@given(st.floats(-360, 360), st.floats(-60, 60), st.floats(0.1, 25), st.floats(0.5, 400), st.sampled_from(PROFILES))
@settings(max_examples=200, deadline=None)
def test_from_every_side(side: float, veer: float, wind: float, height: float, profile: str) -> None:
    """It blows from where it is said to, turned to the right by the veer for each 100 m above 20 ft; 1e-9 of its speed.

    To turn the side turns the wind, and neither side nor veer changes its speed.
    """
    environment = EnvironmentSettings(
        wind_speed=wind,
        wind_from_deg=side,
        wind_veer=veer,
        wind_profile=profile,  # type: ignore[arg-type]
    )
    north, east = mean_wind(environment, height)
    plain = speed(EnvironmentSettings(wind_speed=wind, wind_profile=profile), height)  # type: ignore[arg-type]
    assert hypot(north, east) == pytest.approx(plain, rel=1e-12)
    source = side + veer * (min(height, 304.8) - 6.096) / 100.0
    assert -north == pytest.approx(plain * cos(radians(source)), abs=1e-9 * wind)
    assert -east == pytest.approx(plain * sin(radians(source)), abs=1e-9 * wind)


def test_a_west_wind_that_veers_comes_from_the_north_west_above() -> None:
    """From 270° at 20 ft; 45° further to the right, clockwise seen from above, at 106.096 m."""
    north, east = mean_wind(EnvironmentSettings(wind_speed=8.0, wind_from_deg=270.0, wind_veer=45.0), 106.096)
    assert east > 0.0 > north
    assert degrees(atan2(-east, -north)) % 360.0 == pytest.approx(315.0)


def test_more_wind_is_more_at_every_height() -> None:
    for profile in PROFILES:
        found = [speed(EnvironmentSettings(wind_speed=w, wind_profile=profile), 60.0) for w in (0.0, 4.0, 8.0)]  # type: ignore[arg-type]
        assert found[0] == 0.0
        assert found[2] == pytest.approx(2.0 * found[1])
        heights = [speed(EnvironmentSettings(wind_speed=8.0, wind_profile=profile), h) for h in HEIGHTS]  # type: ignore[arg-type]
        assert np.all(np.diff(heights) >= 0.0)
