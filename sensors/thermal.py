"""How warm a die is: it follows the air with a lag and settles above it by what it heats itself.

    τ dT/dt = T_air + ΔT - T

Exact for an air temperature that is linear between two looks at it. Before it was switched on it had the temperature
of the air: after a time p in steady air it is at T_air + ΔT (1 - e^{-p/τ}).

Source: Bosch BMP390 data sheet BST-BMP390-DS002-07, table 2, note 3: the die's temperature "is typically above
ambient", by self-heating and the board's. No datasheet gives figures.
"""

from math import exp, expm1, isfinite, nan

from sensors.settings import ThermalSettings


class Die:
    """The temperature of one die.

    Parameters
    ----------
    settings : ThermalSettings

    Attributes
    ----------
    temperature : float
        At the last step, K; NaN before the first, and while the air's is no number.
    """

    __slots__ = ("_air", "_lag", "_powered_for", "_self_heating", "_t", "_warmth", "temperature")

    def __init__(self, settings: ThermalSettings) -> None:
        self._self_heating = settings.self_heating
        self._lag = settings.lag
        self._powered_for = settings.powered_for
        self.temperature = nan
        self._t = self._air = nan
        self._warmth = nan  # last temperature that was a number, K

    def step(self, t: float, air_temperature: float) -> float:
        """Go on to time `t`, s, not before the last one, where the air has this temperature, K; return the die's."""
        if not isfinite(air_temperature):
            self.temperature = nan
            return nan
        settled = air_temperature + self._self_heating
        if isfinite(self._warmth):
            elapsed = (t - self._t) / self._lag
            # The lag's error against where it would settle, as of any first-order low-pass (`sensors.filters`).
            behind = expm1(-elapsed) / elapsed if elapsed > 0.0 else -1.0
            error = (self._warmth - self._air - self._self_heating) * exp(-elapsed)
            error += (air_temperature - self._air) * behind
        else:
            error = -self._self_heating * exp(-self._powered_for / self._lag)
        self._t, self._air = t, air_temperature
        self.temperature = self._warmth = settled + error
        return self.temperature
