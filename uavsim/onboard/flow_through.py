"""What a thermal differential sensor has read, turned into the pressure difference at the ports.

Air flows through such a part, so that it reads less in thin air, and the flow loses pressure in the tubes. With the
reading r, the absolute pressure p and the temperature T of the air, undone in the opposite order,

    Δp_s = r p_cal/p,      Δp = Δp_s ± a (√(1 + 8 |Δp_s|/Δp_c) − 1),      a = 64 μ Σ(L/d⁴) ṁ_c R T/(π p)

p_cal is the pressure of the calibration, ṁ_c and Δp_c are the part's flow, L and d the tubes'; μ follows Sutherland's
law. The first puts 17 % to the airspeed at 3000 m (701 hPa) of a part of 966 hPa, and takes 2 % off at sea level.

p and T are those of the row, held until they have moved by `MOVED` and `WARMED`: a sensor that is stuck goes on to read
the same number, which the watch over the ports looks for.
"""

from dataclasses import dataclass
from math import inf, nan, pi, sqrt

from uavsim.airdata import GAS_CONSTANT_DRY_AIR, STANDARD_TEMPERATURE
from uavsim.onboard.interface import AirReading
from uavsim.onboard.plausible import LEAST_PRESSURE, LEAST_TEMPERATURE, MOST_PRESSURE, MOST_TEMPERATURE

SUTHERLAND, SUTHERLAND_TEMPERATURE = 1.458e-6, 110.4  # kg/(m s √K) and K (ISO 2533)
MOVED = 20.0  # Pa: 2e-4 of the reading, 0.003 m/s at 32 m/s; some standard deviations of a barometer's noise
WARMED = 0.5  # K: as much of the tubes' loss, itself some per cent


@dataclass(frozen=True, slots=True)
class FlowThroughSettings:
    """What is known of a thermal part and its tubes.

    Attributes
    ----------
    calibration_pressure : float
        p_cal, Pa; 0: the reading does not depend on the absolute pressure.
    flow, flow_pressure : float
        ṁ_c, kg/s, and Δp_c, Pa.
    hose : float
        Σ L/d⁴ of the tubes, 1/m³.
    share : float
        Of all that, what is undone: 1, or what is believed of it.
    """

    calibration_pressure: float
    flow: float = 0.0
    flow_pressure: float = inf
    hose: float = 0.0
    share: float = 1.0


class FlowThrough:
    """Corrects the rows of a head."""

    __slots__ = ("_factor", "_loss", "_pressure", "_settings", "_static", "_temperature")

    def __init__(self, settings: FlowThroughSettings) -> None:
        self._settings = settings
        self._pressure, self._temperature = nan, STANDARD_TEMPERATURE
        self._static = nan
        self._factor, self._loss = 1.0, 0.0

    def row(self, reading: AirReading) -> AirReading:
        """Return a row of the head with its total pressure corrected."""
        t, p_total, p_static, temperature, t_total, t_static = reading
        return t, self.total(p_total, p_static, temperature), p_static, temperature, t_total, t_static

    def total(self, p_total: float, p_static: float, temperature: float) -> float:
        """Return the total pressure, Pa, of what was read, Pa and K; NaN before there was a static pressure."""
        if p_static == p_static:
            self._static = p_static
        held = self._pressure
        if LEAST_PRESSURE <= p_static <= MOST_PRESSURE and not abs(p_static - held) <= MOVED:
            held = p_static
        warm = self._temperature
        if LEAST_TEMPERATURE <= temperature <= MOST_TEMPERATURE and not abs(temperature - warm) <= WARMED:
            warm = temperature
        if held != self._pressure or warm != self._temperature:
            self._hold(held, warm)
        difference = p_total - self._static
        return self._static + difference + self._settings.share * (self.difference(difference) - difference)

    def difference(self, reading: float) -> float:
        """Return the difference at the ports, Pa, of one that the part has read, in the air that is held."""
        size = abs(reading) * self._factor
        if self._loss > 0.0:
            size += self._loss * (sqrt(1.0 + 8.0 * size / self._settings.flow_pressure) - 1.0)
        return size if reading > 0.0 else -size

    def _hold(self, pressure: float, temperature: float) -> None:
        s = self._settings
        self._pressure, self._temperature = pressure, temperature
        self._factor = s.calibration_pressure / pressure if s.calibration_pressure > 0.0 else 1.0
        viscosity = SUTHERLAND * temperature * sqrt(temperature) / (temperature + SUTHERLAND_TEMPERATURE)
        self._loss = 64.0 * viscosity * s.hose * s.flow * GAS_CONSTANT_DRY_AIR * temperature / (pi * pressure)
