"""The air at rest at the place: pressure, temperature and humidity of the day; and weathers by name.

    H_p = H + H_std(QNH),  p = p_std(H_p),  T = T_std(H) + offset          ISO 2533, ICAO Doc 8168 (altimeter setting)

H is the geopotential height of the ground, p_std the standard atmosphere's pressure by height and H_std its inverse. So
the temperature's offset leaves the pressure at the ground as it is; above it the pressure falls as that air's does.
"""

from typing import Any, NamedTuple

from uavsim import airdata
from uavsim.plants.air.settings import EnvironmentSettings

EARTH_RADIUS = 6_356_766.0  # m, ISO 2533: of the geopotential height
KNOT = 1852.0 / 3600.0  # m/s
DOUBT = 0.2  # share by which the turbulence's wind may differ from the mean wind before it is remarked on
LEAST_DOUBT = 0.5  # m/s, likewise


class Ground(NamedTuple):
    """Still air at the ground."""

    pressure: float  # Pa
    temperature: float  # K
    vapour_fraction: float  # mole fraction


def at_ground(environment: EnvironmentSettings) -> Ground:
    """Return pressure, temperature and humidity of the air at the ground."""
    elevation = environment.ground_elevation
    geopotential = EARTH_RADIUS * elevation / (EARTH_RADIUS + elevation)
    height = geopotential + airdata.standard_height(environment.sea_level_pressure)
    pressure = float(airdata.standard_pressure(height))
    temperature = float(airdata.standard_temperature(geopotential)) + environment.temperature_offset
    fraction = 0.0
    if environment.humidity > 0.0:
        fraction = float(
            airdata.vapour_fraction(relative_humidity=environment.humidity, pressure=pressure, temperature=temperature)
        )
    return Ground(pressure, temperature, fraction)


def moves(environment: EnvironmentSettings) -> bool:
    """Whether the air moves at all."""
    return environment.wind_speed > 0.0 or environment.turbulence_wind_20ft > 0.0 or bool(environment.all_gusts)


def doubts(environment: EnvironmentSettings) -> list[str]:
    """Say, a line each, what contradicts itself and is flown all the same."""
    declared, wind = environment.turbulence_wind_20ft, environment.wind_speed
    if declared > 0.0 and abs(declared - wind) > max(DOUBT * max(declared, wind), LEAST_DOUBT):
        return [
            f"environment.turbulence_wind_20ft = {declared:g} m/s is the turbulence of another wind than wind_speed = "
            f"{wind:g} m/s, both at 20 ft"
        ]
    return []


class Preset(NamedTuple):
    """A weather by name."""

    what: str
    source: str
    keys: dict[str, Any]


def _rough(knots: float, severity: int) -> dict[str, Any]:
    speed = round(knots * KNOT, 3)
    return {"wind_speed": speed, "turbulence_wind_20ft": speed, "turbulence_severity": severity}


_MIL = "MIL-F-8785C 3.7.3.4: wind at 20 ft; figure 7: probability of exceedance above 2000 ft"
_STILL = {"wind_speed": 0.0, "turbulence_wind_20ft": 0.0, "gust_speed": 0.0, "gusts": []}
_STANDARD = {"temperature_offset": 0.0, "sea_level_pressure": 101_325.0, "humidity": 0.0}


def _day(celsius: float, elevation: float, humidity: float = 0.0) -> dict[str, Any]:
    """Keys of a day of a temperature at an elevation, m."""
    standard = float(airdata.standard_temperature(EARTH_RADIUS * elevation / (EARTH_RADIUS + elevation)))
    offset = round(celsius + 273.15 - standard, 2)
    return {"ground_elevation": elevation, "temperature_offset": offset, "humidity": humidity}


PRESETS: dict[str, Preset] = {
    "calm": Preset("standard atmosphere at rest", "ISO 2533", _STILL | _STANDARD),
    "light": Preset("15 kn and light turbulence, exceeded 1 in 100 aloft", _MIL, _rough(15.0, 3)),
    "moderate": Preset("30 kn and moderate turbulence, exceeded 1 in 1000 aloft", _MIL, _rough(30.0, 4)),
    "severe": Preset("45 kn and severe turbulence, exceeded 1 in 100 000 aloft", _MIL, _rough(45.0, 6)),
    "hot": Preset("43.3 °C (110 °F) at sea level", "AR 70-38, basic climatic type, high temperature", _day(43.3, 0.0)),
    "cold": Preset(
        "−31.7 °C (−25 °F) at sea level", "AR 70-38, basic climatic type, low temperature", _day(-31.7, 0.0)
    ),
    "humid": Preset(
        "35 °C and 74 % at sea level", "AR 70-38, basic climatic type, variable high humidity", _day(35.0, 0.0, 0.74)
    ),
    "hot-high": Preset(
        "35 °C (95 °F) at 1219 m (4000 ft)", "US Army requirement for hovering, 4000 ft and 95 °F", _day(35.0, 1219.2)
    ),
    "low-pressure": Preset(
        "950 hPa: a deep storm's day", "round number; record lows are lower", {"sea_level_pressure": 95_000.0}
    ),
    "high-pressure": Preset(
        "1050 hPa: a strong high's day", "round number; record highs are higher", {"sea_level_pressure": 105_000.0}
    ),
}
"""Weathers by name. What one does not say keeps its default, or what the scenario says."""
