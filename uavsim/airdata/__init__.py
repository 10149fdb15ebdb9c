"""Air data: what pressures and temperature say about density, Mach number and airspeed.

Pure equations, SI, keyword arguments. Floats give floats through `math` (fast enough for the loop), anything else gives
float64 arrays through NumPy, element by element with broadcasting; both take the same equations. NaN in gives NaN out.
A pressure ≤ 0 Pa, a temperature outside 150–400 K (degrees Celsius by mistake) and the like are a ValueError; a total
pressure below the static one is data. Temperatures are those of the undisturbed air, not of a probe that the flow has
warmed, but for `static_temperature`, which tells the one from the other.

| module | equations |
|---|---|
| `moist` | density of moist air by CIPM-2007, Z, humidity |
| `pressures` | isentropic total, static, impact and dynamic pressure, Mach number |
| `speeds` | true airspeed, compressible and by Bernoulli, and back |
| `calibrated` | calibrated, equivalent and true airspeed, each from each |
| `recovery` | temperature of air that the flow past a thermometer has warmed |
| `heights` | pressure height, standard atmosphere |
| `surfaces` | polynomials and tables in Mach number, angle of attack and sideslip |
| `position` | position error of the ports, and its correction |

Derivatives, for filters: `NAME_gradient` beside NAME, `.gradient` of surfaces and of a position error.
"""

from uavsim.airdata.calibrated import (
    STANDARD_SPEED_OF_SOUND,
    calibrated_airspeed,
    calibrated_airspeed_gradient,
    calibrated_from_equivalent,
    calibrated_from_mach,
    calibrated_from_true,
    equivalent_airspeed,
    equivalent_airspeed_gradient,
    equivalent_from_calibrated,
    equivalent_from_true,
    impact_pressure_at_calibrated,
    mach_from_calibrated,
    true_from_calibrated,
    true_from_equivalent,
)
from uavsim.airdata.constants import (
    GAMMA,
    GAS_CONSTANT_DRY_AIR,
    MACH_ROUNDING,
    MAX_TEMPERATURE,
    MIN_TEMPERATURE,
    MOLAR_GAS_CONSTANT,
    MOLAR_MASS_DRY_AIR,
    MOLAR_MASS_WATER,
    STANDARD_GRAVITY,
    STANDARD_PRESSURE,
    STANDARD_TEMPERATURE,
    ZERO_CELSIUS,
)
from uavsim.airdata.heights import (
    hypsometric_height,
    pressure_height,
    pressure_height_gradient,
    standard_height,
    standard_pressure,
    standard_temperature,
)
from uavsim.airdata.moist import (
    compressibility_factor,
    moist_air_density,
    moist_air_density_gradient,
    saturation_vapour_pressure,
    vapour_fraction,
    vapour_fraction_at_dew_point,
)
from uavsim.airdata.position import PositionError, impact_over_dynamic, pressure_coefficient
from uavsim.airdata.pressures import (
    dynamic_pressure,
    impact_pressure,
    isentropic_total,
    mach,
    mach_gradient,
    static_pressure,
    total_pressure,
    total_pressure_gradient,
)
from uavsim.airdata.recovery import recovery_temperature, static_temperature, static_temperature_gradient
from uavsim.airdata.speeds import (
    Model,
    Negative,
    airspeed,
    airspeed_curvature,
    airspeed_gradient,
    bernoulli_airspeed,
    compressible_airspeed,
    speed_of_sound,
    total_at_airspeed,
)
from uavsim.airdata.surfaces import Polynomial, Table
from uavsim.airdata.values import Numbers

__all__ = [
    "GAMMA",
    "GAS_CONSTANT_DRY_AIR",
    "MACH_ROUNDING",
    "MAX_TEMPERATURE",
    "MIN_TEMPERATURE",
    "MOLAR_GAS_CONSTANT",
    "MOLAR_MASS_DRY_AIR",
    "MOLAR_MASS_WATER",
    "STANDARD_GRAVITY",
    "STANDARD_PRESSURE",
    "STANDARD_SPEED_OF_SOUND",
    "STANDARD_TEMPERATURE",
    "ZERO_CELSIUS",
    "Model",
    "Negative",
    "Numbers",
    "Polynomial",
    "PositionError",
    "Table",
    "airspeed",
    "airspeed_curvature",
    "airspeed_gradient",
    "bernoulli_airspeed",
    "calibrated_airspeed",
    "calibrated_airspeed_gradient",
    "calibrated_from_equivalent",
    "calibrated_from_mach",
    "calibrated_from_true",
    "compressibility_factor",
    "compressible_airspeed",
    "dynamic_pressure",
    "equivalent_airspeed",
    "equivalent_airspeed_gradient",
    "equivalent_from_calibrated",
    "equivalent_from_true",
    "hypsometric_height",
    "impact_over_dynamic",
    "impact_pressure",
    "impact_pressure_at_calibrated",
    "isentropic_total",
    "mach",
    "mach_from_calibrated",
    "mach_gradient",
    "moist_air_density",
    "moist_air_density_gradient",
    "pressure_coefficient",
    "pressure_height",
    "pressure_height_gradient",
    "recovery_temperature",
    "saturation_vapour_pressure",
    "speed_of_sound",
    "standard_height",
    "standard_pressure",
    "standard_temperature",
    "static_pressure",
    "static_temperature",
    "static_temperature_gradient",
    "total_at_airspeed",
    "total_pressure",
    "total_pressure_gradient",
    "true_from_calibrated",
    "true_from_equivalent",
    "vapour_fraction",
    "vapour_fraction_at_dew_point",
]
