"""At which airspeed the readings of a head end, in the air of the field.

An absolute total sensor ends where the total pressure is its greatest, p_t = p (1 + M²/5)^3.5 (ISO 2533), a
differential one where the difference p_t − p is. A thermal part counts molecules, so that its end in Pa is that at its
calibration times p_cal/p. Beyond it there is no airspeed but that of the integral of the specific force.
"""

from math import inf, isfinite, sqrt

from sensors import DifferentialDescription
from uavsim import airdata
from uavsim.plants.air.weather import at_ground
from uavsim.scenario import Scenario

MARGIN = 1.1  # times the airspeed that is held: gusts and a dive. By hand


def fastest_read(scenario: Scenario) -> float:
    """Return the airspeed at which the total channel ends, m/s; infinity where readings do not end."""
    first, _ = scenario.air_data.sensors()
    part, air = first.description(), at_ground(scenario.environment)
    if not part.errors.saturation:
        return inf
    total = part.range[1]
    if isinstance(part, DifferentialDescription):
        thin = part.calibration_pressure / air.pressure if part.calibration_pressure > 0.0 else 1.0
        total = air.pressure + thin * total
    if total <= air.pressure:
        return 0.0
    mach = sqrt(5.0 * ((total / air.pressure) ** (2.0 / 7.0) - 1.0))
    return float(mach * airdata.speed_of_sound(air.temperature))


def remark(scenario: Scenario) -> list[str]:
    """Return a line if the head's readings end near the airspeed that is to be held, or below."""
    if not scenario.plant.chosen.flies:
        return []
    ends, held = fastest_read(scenario), scenario.flight_computer.airspeed
    if not isfinite(ends) or ends > MARGIN * held:
        return []
    first, _ = scenario.air_data.sensors()
    key = "differential" if isinstance(first.description(), DifferentialDescription) else "total"
    return [
        f"air_data.{key}.preset = '{first.description().name}' ends at {ends:.0f} m/s in the air of the field, and "
        f"flight_computer.airspeed = {held:g} m/s is to be held: beyond its end there is no airspeed"
    ]
