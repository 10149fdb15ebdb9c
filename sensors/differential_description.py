"""What is known of a differential pressure sensor before one is bought: its datasheet as numbers, in one mode.

The terms are those of an absolute sensor (`sensors.pressure_description`), with pressures that are differences: the
range has two signs, and the scale error turns about 0. A total error band of ±E over the temperatures is read as a
bound on offset, temperature coefficient and scale together; each preset's sources say how it was divided.

There are two principles. A membrane feels the difference itself. A thermal part lets a little air flow through a
channel and measures how the flow carries heat away, so its reading depends on the density of that air:

    reading = Δp · p/p_cal        p: absolute pressure, p_cal that of the calibration (Sensirion SDP3x: 966 hPa)

`calibration_pressure` is p_cal, and 0 of a membrane. What the flow loses in the tubes is in `sensors.differential`.
"""

from dataclasses import dataclass
from math import inf, sqrt

from sensors.pressure_description import PressureDescription
from sensors.rules import number
from sensors.term import term

CALIBRATION_PA = number(0.0, 2e5)  # Pa: 0 is a membrane; nobody calibrates above two atmospheres
FLOW_KG = number(0.0, 1e-3)  # kg/s: a gram a second, a tube of 10 mm; parts have below 1e-6
FLOW_PA = number(1e-3, 1e6)  # Pa: where the flow bends from proportional to the root; parts have tens

SEA_LEVEL_PRESSURE = 101_325.0  # Pa (ISO 2533)
SEA_LEVEL_SOUND = 340.294  # m/s (ISO 2533)


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferentialDescription(PressureDescription):
    """A differential pressure sensor with thermometer in one mode; SI throughout.

    Attributes
    ----------
    range : (float, float)
        Least and greatest reading, Pa.
    calibration_pressure : float
        Absolute pressure at which a thermal part reads the difference itself, Pa; 0: it does not depend on it.
    flow : float
        Mass flow ṁ_c of a thermal part in ṁ = ½ ṁ_c (√(1 + 8 Δp/Δp_c) − 1), kg/s; 0: nothing flows.
    flow_pressure : float
        Δp_c in it, Pa.
    """

    calibration_pressure: float = term("calibration_pressure_pa", CALIBRATION_PA, default=0.0)
    flow: float = term("flow_kg", FLOW_KG, default=0.0)
    flow_pressure: float = term("flow_pressure_pa", FLOW_PA, default=inf)


def fastest(
    description: DifferentialDescription, pressure: float = SEA_LEVEL_PRESSURE, sound: float = SEA_LEVEL_SOUND
) -> float:
    """Return the airspeed at which the readings of a part end, m/s, by the isentropic relation without tubes.

    Parameters
    ----------
    description : DifferentialDescription
    pressure, sound : float
        Static pressure, Pa, and speed of sound, m/s; those of the standard atmosphere at sea level by default.

    Examples
    --------
    >>> from sensors import preset
    >>> round(fastest(preset("ms4525do")), 1)
    104.9
    """
    difference = description.range[1]
    if description.calibration_pressure > 0.0:
        difference *= description.calibration_pressure / pressure
    return sound * sqrt(5.0 * ((1.0 + difference / pressure) ** (2.0 / 7.0) - 1.0))
