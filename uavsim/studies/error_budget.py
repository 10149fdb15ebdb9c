"""Error budget of an air-data head: what each cause makes of the airspeed at each speed, as a standard deviation.

    σ_V = ∂V/∂p_t·σ_Δp = σ_Δp/(ρ_t·V)       of a pressure error;     σ_V = V·σ_T/(2·T)     of the thermometer

with ρ_t the density at the stagnation point (`airdata.speeds`). So noise and tare fall as 1/V, the position error, a
share of the dynamic pressure, and the thermometer grow as V, and the lag in an acceleration does not depend on V. Below
0.8 V*, V* = √(2 σ_Δp/ρ), the slope of the root means nothing and is stopped there, as `onboard.airspeed.paper` says.

| cause | error of p_t − p_s |
|---|---|
| noise | one reading of each sensor, rounding included |
| tare | noise of the mean under the cover; in the open, ½ρw² of the wind; none: what the pair may be apart |
| drift | the pair's walk since the tare |
| warming | temperature coefficient of both offsets, times what the dies change since the tare |
| thermometer | none: it makes V·σ_T/(2·T) |
| position | what a calibration leaves of the static port's error at stated angles, a share of q_c |
| lag | age of the total pressure in a stated acceleration; difference of both ages in a stated climb |
| force | air column in the tubes and sensitivity of the membranes, times the same acceleration |

Of a head with a differential sensor the pair is that sensor alone: of the static one only the density's share is left.
Its scale error is a share of q_c, too, and stands in `position`.

All but the conditions come from the descriptions of the parts (`sensors.knowledge`) and the keys of `[air_data]`.
"""

from dataclasses import asdict, dataclass
from math import exp, hypot, radians, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors import AirDataSettings, HeadKnowledge, PressureDescription, known_of_head
from sensors.knowledge import PortKnowledge
from uavsim import airdata
from uavsim.plants.air.weather import at_ground
from uavsim.scenario import Scenario
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

SPEEDS = tuple(np.arange(5.0, 60.1, 5.0).tolist())  # m/s
SLOPE_ENDS = 0.8  # V*, below which the slope of the root is that at this speed
TERMS = ("noise", "tare", "drift", "warming", "thermometer", "position", "lag", "force")


@dataclass(frozen=True, slots=True)
class Conditions:
    """What a budget is for; no description holds it. Standard deviations where an angle or a change is meant.

    Attributes
    ----------
    static : float
        Static pressure, Pa.
    temperature : float
        Of the air, K.
    since_tare : float
        s.
    warmer : float
        How far the dies have changed since the tare beside what is left of their warm-up, K: some 150 m of climb.
    acceleration, climb : float
        Along the flight path, m/s², and upwards, m/s: a throttle change and a climb of small aircraft.
    alpha, beta : float
        Angles of attack and sideslip, rad.
    wind : float
        On the head while an open pair is tared, m/s.
    """

    static: float = airdata.STANDARD_PRESSURE
    temperature: float = airdata.STANDARD_TEMPERATURE
    since_tare: float = 60.0
    warmer: float = 1.0
    acceleration: float = 1.0
    climb: float = 3.0
    alpha: float = radians(3.0)
    beta: float = radians(3.0)
    wind: float = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Budget:
    """What each cause makes of the airspeed.

    Attributes
    ----------
    parts : (str, str)
        Total and static sensor, with their modes.
    conditions : Conditions
    speeds : array
        m/s.
    terms : dict of arrays
        Standard deviation of each cause at each speed, m/s.
    total : array
        All of them as independent ones, m/s.
    """

    parts: tuple[str, str]
    conditions: Conditions
    speeds: Array
    terms: dict[str, Array]
    total: Array

    def numbers(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "parts": list(self.parts),
            "conditions": asdict(self.conditions),
            "speed": self.speeds.tolist(),
            "airspeed_sd": {**{name: sd.tolist() for name, sd in self.terms.items()}, "total": self.total.tolist()},
        }


def of_scenario(scenario: Scenario, speeds: tuple[float, ...] = SPEEDS) -> Budget:
    """Return the budget of a scenario's head, in the air of its place, at the wind that its estimator reckons with."""
    ground = at_ground(scenario.environment)
    conditions = Conditions(ground.pressure, ground.temperature, wind=scenario.estimator.wind_sd)
    return budget(scenario.air_data, conditions, speeds)


def budget(air: AirDataSettings, conditions: Conditions | None = None, speeds: tuple[float, ...] = SPEEDS) -> Budget:
    """Return the budget of an air-data head.

    Parameters
    ----------
    air : AirDataSettings
    conditions : Conditions, optional
    speeds : tuple of float
        True airspeeds, m/s, above 0.
    """
    c = Conditions() if conditions is None else conditions
    speed = np.asarray(speeds, dtype=float)
    total = airdata.total_at_airspeed(airspeed=speed, static=c.static, temperature=c.temperature)
    by_total, by_static, by_warmth = airdata.airspeed_gradient(total=total, static=c.static, temperature=c.temperature)
    impact = total - c.static
    density = c.static / (airdata.GAS_CONSTANT_DRY_AIR * c.temperature)
    head, parts = known_of_head(air), tuple(sensor.description() for sensor in air.sensors())
    one, other = head.total.noise_sd, head.static.noise_sd
    paired = _paired(air)
    if head.difference is not None:
        by_static = by_static + by_total  # p_t moves with p_s
    pressures = {
        "noise": np.hypot(by_total * one, by_static * other),
        "tare": by_total * _tare_sd(air, head, c, density),
        "drift": by_total * hypot(*(part.walk for part in paired)) * sqrt(c.since_tare),
        "warming": by_total * _warming_sd(air, c),
        "position": by_total * impact * hypot(_position(head.ports, c), head.scale_sd),
        "lag": by_total * _lag(head.total, head.static, c, density, speed),
        "force": by_total
        * c.acceleration
        * hypot(head.column, head.total.membrane_sd, head.static.membrane_sd if len(paired) > 1 else 0.0),
    }
    spread = np.sqrt(sum(np.square(sd) for sd in pressures.values())) / by_total  # Pa
    stop = speed / np.maximum(speed, SLOPE_ENDS * np.sqrt(2.0 * spread / density))
    terms = {name: stop * sd for name, sd in pressures.items()}
    terms["thermometer"] = by_warmth * head.temperature_sd
    terms = {name: terms[name] for name in TERMS}
    names = [f"{part.name} {part.mode.name}" for part in parts]
    all_of_them = np.sqrt(sum(np.square(sd) for sd in terms.values()))
    return Budget((names[0], names[1]), c, speed, terms, np.asarray(all_of_them))


def _paired(air: AirDataSettings) -> tuple[PressureDescription, ...]:
    """Return the parts whose errors are in the pressure difference."""
    first, static = air.sensors()
    return (first.description(),) if air.kind == "differential" else (first.description(), static.description())


def _tare_sd(air: AirDataSettings, head: HeadKnowledge, c: Conditions, density: float) -> float:
    """Error that the tare leaves in the pair's difference, Pa."""
    parts = _paired(air)
    if air.tare == "none":
        return head.difference_sd
    readings = [max(1.0, air.tare_duration * min(air.rate, part.rate)) for part in parts]
    noise = hypot(*(part.noise_sd / sqrt(count) for part, count in zip(parts, readings, strict=True)))
    return hypot(noise, 0.5 * density * c.wind**2) if air.tare == "open" else noise


def _warming_sd(air: AirDataSettings, c: Conditions) -> float:
    """What the temperature makes of the pair since the tare, Pa."""
    left = air.thermal.self_heating * exp(-air.thermal.powered_for / air.thermal.lag)
    coefficient = hypot(*(part.offset_tc_sd for part in _paired(air)))
    return coefficient * hypot(left, c.warmer)


def _position(ports: PortKnowledge, c: Conditions) -> float:
    """What is not known of the static port's position error, as a share of q_c; angles are standard deviations."""
    angles = ports.alpha_sd * c.alpha, ports.alpha2_sd * c.alpha**2, ports.beta2_sd * c.beta**2
    return hypot(ports.position_sd, *angles)


def _lag(total: Any, static: Any, c: Conditions, density: float, speed: Array) -> Array:
    """Error by the ages of both pressures, Pa: ρ V V̇ of the total one, ρ g of the climb of both."""
    ages = [0.5 * one.window + one.lag for one in (total, static)]
    climb = density * STANDARD_GRAVITY * c.climb * (ages[0] - ages[1])
    return np.asarray(np.hypot(ages[0] * density * speed * c.acceleration, climb))
