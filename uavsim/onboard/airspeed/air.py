"""The air that the aided filter flies in: its density, its gusts, and airspeed from a pressure ratio.

The temperature is the thermometer's. The density is that at the filter's own static pressure, ρ = p/(R T), R with the
vapour that is known of.
"""

from uavsim.airdata import GAS_CONSTANT_DRY_AIR, STANDARD_TEMPERATURE
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.energy_model import isentropic_speed
from uavsim.onboard.airspeed.gust import GRAVITY, growth, gust_density, shear_density
from uavsim.onboard.airspeed.settings import AidedSettings

SLOWEST = 1.0  # m/s; below it the gust's correlation time is that of this airspeed


class Air:
    """What is known of it.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of the gusts.
    calibration : float
        Factor between the airspeed of the pressures in dry air and the one told.
    lightness : float
        Density of dry air over that of the air as it is, at the same pressure and temperature.

    Attributes
    ----------
    temperature : float
        K.
    measured : bool
        Whether a thermometer has told it; else it is that of the standard atmosphere.
    gas, heat : float
        R T and 7 R T, m²/s²; the second has the square of the calibration in it.
    density : float
        ρ, kg/m³.
    gust : float
        2 σ²/L of the gusts, with the growth of the mean wind in a climb, m/s².
    shear : float
        The latter alone, m/s².
    growth : float
        By which share of itself the airspeed grows in a climb into a wind that is known, 1/s.
    ground : float
        Static pressure at the launch, Pa; NaN while it is not known.
    """

    __slots__ = (
        "_aided",
        "_calibration",
        "_falls",
        "_grows",
        "_lightness",
        "density",
        "gas",
        "ground",
        "growth",
        "gust",
        "heat",
        "measured",
        "shear",
        "temperature",
    )

    def __init__(self, aided: AidedSettings, calibration: float, lightness: float = 1.0) -> None:
        self._aided, self._calibration, self._lightness = aided, calibration, lightness
        self._grows = aided.shear > 0.0 or bool(aided.shear_along)
        self._falls = (aided.gust_height > 0.0 and aided.gust_sd > 0.0) or self._grows
        self.growth = 0.0
        self.gust, self.shear = gust_density(aided, 0.0), 0.0
        self.ground = self.density = float("nan")
        self.begin(0.0)

    def begin(self, temperature: float) -> None:
        """Begin with a temperature, K, or without one: 0."""
        self.measured = temperature > 0.0
        self.warm(temperature if self.measured else STANDARD_TEMPERATURE)

    def warm(self, temperature: float) -> None:
        """Take a temperature, K."""
        self.temperature, self.gas = temperature, GAS_CONSTANT_DRY_AIR * temperature * self._lightness
        self.heat = SEVEN_R * temperature * self._calibration * self._calibration

    def at(self, static: float, slope: float) -> None:
        """Take static pressure, Pa, and g sin γ, m/s², of the moment: density and, by the height, gusts follow."""
        self.density = static / self.gas
        if self._falls:
            height = (self.ground - static) / (GRAVITY * self.density)
            self.gust = gust_density(self._aided, height)
            if self._grows:
                self.shear = shear_density(self._aided, height, slope)
                self.gust += self.shear
                self.growth = growth(self._aided, height, slope)

    def speed(self, total: float, static: float) -> float:
        """Return the airspeed of two pressures, Pa; 0 if the total pressure is not above the static one."""
        return isentropic_speed(max(0.0, (total - static) / static), self.heat)
