"""The mean wind by height above the ground.

    "log"      W₂₀ ln(h/z₀)/ln(6.096 m/z₀)
    "power"    W₂₀ (h/6.096 m)^n
    "uniform"  W₂₀

The first is that of MIL-F-8785C 3.7.3.2, there from 3 ft to 1000 ft, here from z₀, where it is 0. Above 1000 ft, where
the law of low altitude ends, all are as there. It comes from `from` + veer (h − 6.096 m), clockwise.
"""

from math import cos, log, pi, radians, sin

from uavsim.compiled import compiled
from uavsim.plants.air.settings import EnvironmentSettings

REFERENCE = 6.096  # m: 20 ft
TOP = 304.8  # m: 1000 ft
LOG, POWER, UNIFORM = 0.0, 1.0, 2.0
Law = tuple[float, float, float, float, float]
"""Kind; its scale, m/s; its own number; where it blows to at 20 ft, rad; veer, rad/m."""


def law(environment: EnvironmentSettings) -> Law:
    """Return the numbers of the mean wind."""
    speed, towards = environment.wind_speed, radians(environment.wind_from_deg) + pi
    veer = radians(environment.wind_veer) / 100.0
    if environment.wind_profile == "log":
        return LOG, speed / log(REFERENCE / environment.roughness), environment.roughness, towards, veer
    if environment.wind_profile == "power":
        return POWER, speed, environment.wind_exponent, towards, veer
    return UNIFORM, speed, 0.0, towards, veer


@compiled
def speed_at(height: float, kind: float, scale: float, own: float) -> float:
    """Mean wind speed, m/s, at a height above the ground, m, by a law's first numbers."""
    if kind == UNIFORM or scale == 0.0:
        return scale
    h = min(height, TOP)
    if kind == LOG:
        return scale * log(h / own) if h > own else 0.0
    return scale * (h / REFERENCE) ** own if h > 0.0 else 0.0


@compiled
def towards_at(height: float, towards: float, veer: float) -> float:
    """Where the mean wind blows to, rad from north, at a height above the ground, m."""
    return towards + veer * (min(max(height, 0.0), TOP) - REFERENCE)


def growth(environment: EnvironmentSettings, height: float) -> float:
    """How fast the mean wind grows with the logarithm of the height, dW/d(ln h), m/s, at a height above ground, m."""
    kind, scale, own, _, _ = law(environment)
    if kind == LOG:
        return scale
    return own * scale * (min(height, TOP) / REFERENCE) ** own if kind == POWER else 0.0


def mean_wind(environment: EnvironmentSettings, height: float) -> tuple[float, float]:
    """Mean wind, m/s to the north and to the east, at a height above the ground, m."""
    kind, scale, own, towards, veer = law(environment)
    speed, angle = speed_at.function(height, kind, scale, own), towards_at.function(height, towards, veer)
    return speed * cos(angle), speed * sin(angle)
