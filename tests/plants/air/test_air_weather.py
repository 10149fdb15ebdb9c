"""Pressure, temperature and humidity of the day at the ground, and those that JSBSim then flies in.

Authorities: ISO 2533, written out here; published tables at some heights; CIPM-2007 (`airdata.moist_air_density`, held
against its own published figures elsewhere) for the density, which JSBSim's ideal mixture misses by 1.1 ‰ at most.
"""

from math import exp
from typing import Any

import numpy as np
import pytest

from uavsim.airdata import moist_air_density, saturation_vapour_pressure
from uavsim.plants.air.settings import EnvironmentSettings
from uavsim.plants.air.weather import PRESETS, at_ground, doubts, moves
from uavsim.plants.columns import FT, SLUG
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.settings import LauncherSettings
from uavsim.scenario import load_scenario

G, R, LAPSE, P0, T0, RADIUS = 9.80665, 287.05287, 0.0065, 101_325.0, 288.15, 6_356_766.0  # ISO 2533


def standard(elevation: float, qnh: float = P0) -> tuple[float, float]:
    """Pressure and temperature at an elevation, m, by ISO 2533; an altimeter set to `qnh`, Pa, shows that elevation."""
    geopotential = RADIUS * elevation / (RADIUS + elevation)
    power = G / (R * LAPSE)
    below = T0 / LAPSE * (1.0 - (qnh / P0) ** (1.0 / power))
    return P0 * (1.0 - LAPSE * (geopotential + below) / T0) ** power, T0 - LAPSE * geopotential


def rested(**environment: Any) -> JsbsimPlant:
    """Return a plant after 20 ms on the rail."""
    plant = JsbsimPlant(Run(EnvironmentSettings(**environment), LauncherSettings(), 0.1, 5.0))
    for _ in range(20):
        plant.step()
    return plant


# -- at the ground -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("elevation", [-400.0, 0.0, 420.0, 1219.2, 4000.0])
@pytest.mark.parametrize("qnh", [87_000.0, 95_000.0, P0, 105_000.0, 108_500.0])
@pytest.mark.parametrize("offset", [-60.0, 0.0, 40.0])
def test_the_ground_is_iso_2533_with_the_altimeters_setting(elevation: float, qnh: float, offset: float) -> None:
    """1e-7; an offset of the temperature leaves the pressure."""
    found = at_ground(
        EnvironmentSettings(ground_elevation=elevation, sea_level_pressure=qnh, temperature_offset=offset)
    )
    pressure, temperature = standard(elevation, qnh)
    assert found.pressure == pytest.approx(pressure, rel=1e-7)
    assert found.temperature == pytest.approx(temperature + offset, rel=1e-12)
    assert found.vapour_fraction == 0.0


@pytest.mark.parametrize(
    ("feet", "pressure", "temperature"), [(0, 101325, 288.15), (4000, 87511, 280.23), (10000, 69682, 268.34)]
)
def test_the_ground_is_as_tables_have_it(feet: float, pressure: float, temperature: float) -> None:
    """ICAO Doc 7488, by geopotential height; to its last digit, 1 Pa and 0.01 K."""
    height = feet * 0.3048
    found = at_ground(EnvironmentSettings(ground_elevation=RADIUS * height / (RADIUS - height)))
    assert found.pressure == pytest.approx(pressure, abs=1.0)
    assert found.temperature == pytest.approx(temperature, abs=0.01)


@pytest.mark.parametrize("humidity", [0.2, 0.74, 1.0])
def test_vapour_is_that_share_of_what_saturates(humidity: float) -> None:
    """Partial pressure over saturation pressure; CIPM's enhancement of saturated air is within 0.6 %."""
    for celsius, elevation in ((35.0, 0.0), (15.0, 1500.0)):
        offset = celsius + 273.15 - standard(elevation)[1]
        ground = at_ground(
            EnvironmentSettings(ground_elevation=elevation, temperature_offset=offset, humidity=humidity)
        )
        asked = humidity * saturation_vapour_pressure(ground.temperature) / ground.pressure
        assert ground.vapour_fraction == pytest.approx(asked, rel=6e-3)
        assert ground.vapour_fraction > asked


# -- in JSBSim ---------------------------------------------------------------------------------------------------------

DAYS: dict[str, dict[str, Any]] = {
    "standard": {},
    "hot": {"temperature_offset": 28.15},
    "cold": {"temperature_offset": -46.7},
    "low-lying": {"ground_elevation": -400.0},
    "hot-high": {"ground_elevation": 1219.2, "temperature_offset": 27.92},
    "high": {"ground_elevation": 4000.0, "temperature_offset": -20.0},
    "storm": {"sea_level_pressure": 95_000.0, "ground_elevation": 300.0},
    "fair": {"sea_level_pressure": 105_000.0},
    "humid": {"temperature_offset": 19.85, "humidity": 0.74},
    "humid-storm": {"temperature_offset": 19.85, "humidity": 0.74, "sea_level_pressure": 95_000.0},
    "humid-high": {
        "temperature_offset": 25.0,
        "humidity": 0.6,
        "ground_elevation": 2500.0,
        "sea_level_pressure": 104_000.0,
    },
}


@pytest.mark.parametrize("day", DAYS)
def test_jsbsim_flies_in_the_air_of_the_day(day: str) -> None:
    """Pressure at the aircraft by hydrostatics from the ground, 2e-6; temperature 1 mK; density by CIPM-2007, 1.1 ‰.

    CIPM-2007 has air's compressibility, 1.07 ‰ at −32 °C, and JSBSim has not. The share of vapour by itself: 1 ‰.
    """
    environment = EnvironmentSettings(**DAYS[day])
    ground, plant = at_ground(environment), rested(**DAYS[day])
    truth = plant.truth()
    height = LauncherSettings().height
    assert truth["altitude"][-1] == pytest.approx(environment.ground_elevation + height, abs=1e-3)
    asked = ground.pressure * exp(-G * height / (R * ground.temperature))
    assert truth["p_static"][-1] == pytest.approx(asked, rel=2e-6)
    assert truth["temperature"][-1] == pytest.approx(ground.temperature - LAPSE * height, abs=1e-3)
    density = plant._value("atmosphere/rho-slugs_ft3") * SLUG / FT**3
    asked = moist_air_density(
        pressure=float(truth["p_static"][-1]), temperature=ground.temperature, vapour_fraction=ground.vapour_fraction
    )
    assert density == pytest.approx(asked, rel=1.1e-3)
    mixed = ground.vapour_fraction / (1.0 - ground.vapour_fraction) * 0.018015 / 0.028966  # kg/kg
    assert plant._value("atmosphere/vapor-fraction-ppm") == pytest.approx(1e6 * mixed, rel=1e-3, abs=1e-9)
    assert plant.remarks == []


def test_a_share_of_vapour_that_jsbsim_does_not_hold_is_refused() -> None:
    """Its most is 35 g/kg at sea level, a dew point of 34 °C; the 49 g/kg of saturated air of 40 °C are not flown."""
    said = "environment.humidity = 1 is 49 g of vapour per kg of dry air, and JSBSim's air holds no more than 35"
    with pytest.raises(ValueError, match=f"^{said}$"):
        rested(temperature_offset=25.0, humidity=1.0)


def test_pressure_falls_with_height_as_that_air_does() -> None:
    """A record of the climb: dp/p = −g dh/(R T) from row to row, integrated, 1e-5 of the pressure."""
    environment = EnvironmentSettings(temperature_offset=20.0, sea_level_pressure=98_000.0, ground_elevation=800.0)
    plant = JsbsimPlant(Run(environment, LauncherSettings(), 1.6, 0.2))
    for _ in range(1600):
        plant.step()
    truth = plant.truth()
    assert np.ptp(truth["altitude"]) > 2.5
    fall = np.diff(truth["altitude"]) / (0.5 * (truth["temperature"][1:] + truth["temperature"][:-1]))
    asked = truth["p_static"][0] * np.exp(-G / R * np.concatenate([[0.0], np.cumsum(fall)]))
    assert truth["p_static"] == pytest.approx(asked, rel=1e-5)
    assert truth["temperature"] + LAPSE * truth["altitude"] == pytest.approx(T0 + 20.0, abs=2e-3)


# -- by name -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "celsius", "elevation", "humidity"),
    [("hot", 43.3, 0.0, 0.0), ("cold", -31.7, 0.0, 0.0), ("humid", 35.0, 0.0, 0.74), ("hot-high", 35.0, 1219.2, 0.0)],
)
def test_a_preset_is_as_hot_as_its_source_says(name: str, celsius: float, elevation: float, humidity: float) -> None:
    """0.01 K, to which the offset is written."""
    environment = load_scenario("catapult", overrides=(f"environment.preset={name}",)).environment
    assert environment.ground_elevation == elevation
    assert environment.humidity == humidity
    assert at_ground(environment).temperature == pytest.approx(celsius + 273.15, abs=0.01)
    assert at_ground(environment).pressure == pytest.approx(standard(elevation)[0], rel=1e-7)


@pytest.mark.parametrize(("name", "knots", "curve"), [("light", 15, 3), ("moderate", 30, 4), ("severe", 45, 6)])
def test_a_preset_is_as_rough_as_its_source_says(name: str, knots: float, curve: int) -> None:
    """MIL-F-8785C 3.7.3.4: 15, 30, 45 kn at 20 ft; aloft exceeded once in 10², 10³, 10⁵: curves 3, 4, 6 of figure 7."""
    environment = load_scenario("catapult", overrides=(f"environment.preset={name}",)).environment
    assert environment.wind_speed == environment.turbulence_wind_20ft == pytest.approx(knots * 1852 / 3600, abs=6e-4)
    assert environment.turbulence_severity == curve
    assert doubts(environment) == []


def test_calm_takes_what_a_scenario_blows() -> None:
    gusty = load_scenario("gusty").environment
    assert moves(gusty)
    calm = load_scenario("gusty", overrides=("environment.preset=calm",)).environment
    assert not moves(calm)
    assert calm.sea_level_pressure == P0


@pytest.mark.parametrize(("name", "pressure"), [("low-pressure", 95_000.0), ("high-pressure", 105_000.0)])
def test_a_preset_of_the_pressure(name: str, pressure: float) -> None:
    environment = load_scenario("catapult", overrides=(f"environment.preset={name}",)).environment
    assert at_ground(environment).pressure == pytest.approx(pressure, rel=1e-7)


@pytest.mark.parametrize("name", PRESETS)
def test_what_else_is_said_comes_before_a_preset(name: str) -> None:
    changed = {"ground_elevation": 77.0, "temperature_offset": 3.0, "humidity": 0.1, "wind_speed": 2.5}
    overrides = [f"environment.preset={name}", *(f"environment.{key}={value}" for key, value in changed.items())]
    environment = load_scenario("catapult", overrides=tuple(overrides)).environment
    assert {key: getattr(environment, key) for key in changed} == changed
    others = {key: value for key, value in PRESETS[name].keys.items() if key not in changed and key != "gusts"}
    assert {key: getattr(environment, key) for key in others} == others


def test_a_preset_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r"environment\.preset = 'sever': is unknown; did you mean 'severe'\?"):
        load_scenario("catapult", overrides=("environment.preset=sever",))


@pytest.mark.parametrize(
    ("declared", "wind", "doubted"),
    [
        (0.0, 8.0, 0),
        (8.0, 8.0, 0),
        (8.0, 6.5, 0),
        (8.0, 6.3, 1),
        (6.3, 8.0, 1),
        (8.0, 0.0, 1),
        (0.5, 0.0, 0),
        (0.6, 0.0, 1),
    ],
)
def test_turbulence_of_another_wind_is_doubted(declared: float, wind: float, doubted: int) -> None:
    """A fifth of the greater one, or half a metre a second."""
    found = doubts(EnvironmentSettings(turbulence_wind_20ft=declared, wind_speed=wind))
    assert len(found) == doubted
    assert all(f"{declared:g} m/s" in line and f"{wind:g} m/s" in line for line in found)
