"""What is known of an absolute pressure sensor before one is bought: its datasheet as numbers, in one mode.

White noise: the datasheet's figure a conversion, for its mode, used as it is; quantisation is part of it. The part's
digital filter y += a (x - y) leaves a/(2 - a) of its variance and correlates what it leaves.

Every term has a factor on what the datasheet says of it (`PressureErrors`): 0 switches it off, 3 is three times as bad.
The factors become part of the description, so the simulated unit and a filter go by the same numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import acos, inf, pi, sqrt
from typing import Self

from sensors.choice import choose
from sensors.rules import listed, number
from sensors.term import percent, scaled, term
from sensors.unit import CLOCK, CORRELATION, DriftModel, Factor

OFFSET_PA = number(0.0, 2e4)  # Pa: a fifth of the atmosphere; cheap parts are off by 1500
OFFSET_TC_PA = number(0.0, 100.0)  # Pa/K: 10 kPa over 100 K; the worst parts have 15
SOLDER_PA = listed(number(-2e4, 2e4), count=2)  # Pa: as the offset
ACCELERATION_PA = number(0.0, 100.0)  # Pa/(m/s²): 1 kPa/g, a membrane of 100 kg/m²; parts have below 1
SCALE = number(0.0, 0.5)  # a fraction: at 1 it would read nothing
DRIFT_PA = number(0.0, 1e4)  # Pa: a tenth of the atmosphere, wandering; parts have below 10
WALK_PA = number(0.0, 1e3)  # Pa/√s: 1 kPa after a second; parts have below 0.1
WARMTH = number(0.0, 50.0)  # K: a thermometer that is further off tells no air from any other
RESOLUTION_K = number(1e-6, 10.0)  # K: below its noise by far, to a thermometer in tens of kelvin

UNQUANTISED_STEP = 1e-9  # Pa and K: stands for no quantisation
FASTEST_FILTER = 2.0 * (sqrt(2.0) - 1.0)  # a of the y += a (x - y) that is 3 dB down at half the rate; above, nowhere


def pair(values: Sequence[float]) -> tuple[float, float]:
    """Return the two values of a list."""
    low, high = values
    return float(low), float(high)


@dataclass(frozen=True, slots=True)
class PressureErrors:
    """Factors on the datasheet's figures for a pressure sensor: 0 is without, 1 as the datasheet has it.

    Attributes
    ----------
    offset : float
        Offset at turn-on.
    solder : float
        Shift of the offset by soldering.
    scale : float
        Scale error.
    temperature : float
        Temperature coefficient of the offset.
    acceleration : float
        Acceleration sensitivity of the membrane.
    thermometer : float
        Offset of the thermometer.
    drift : float
        In-run drift.
    random_walk : float
        In-run random walk.
    clock : float
        Error of the part's oscillator.
    drift_model : str
        How the drift wanders: "gauss-markov", one correlation time, or "flicker", true 1/f noise.
    saturation : bool
        Whether readings end at the range.
    quantisation : bool
        Whether readings come in steps.
    """

    offset: Factor = 1.0
    solder: Factor = 1.0
    scale: Factor = 1.0
    temperature: Factor = 1.0
    acceleration: Factor = 1.0
    thermometer: Factor = 1.0
    drift: Factor = 1.0
    random_walk: Factor = 1.0
    clock: Factor = 1.0
    drift_model: DriftModel = "gauss-markov"
    saturation: bool = True
    quantisation: bool = True


@dataclass(frozen=True, slots=True)
class PressureMode:
    """One oversampling setting of a pressure sensor.

    Attributes
    ----------
    name : str
        Oversampling of pressure/temperature, "x1/x1".
    noise_sd : float
        Standard deviation of one conversion, its quantisation included, digital filter off, Pa.
    resolution : float
        Step of a reading, Pa.
    temperature_noise_sd : float
        The same of the thermometer, K.
    conversion_time : float
        Length of the conversion window, s.
    rate : float
        Conversions a second when the part runs freely.
    """

    name: str
    noise_sd: float
    resolution: float
    temperature_noise_sd: float
    conversion_time: float
    rate: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PressureDescription:
    """An absolute pressure sensor with thermometer in one mode; SI throughout.

    Attributes
    ----------
    name, document : str
        The preset's name; where its numbers are from.
    modes : tuple of PressureMode
        What the part can be set to.
    mode : PressureMode
        What it is set to.
    iir_weights : tuple of (int, float)
        For each filter coefficient, as the datasheet prints it (0: off), the weight a of y += a (x - y).
    iir : int
        The coefficient that it is set to.
    range : (float, float)
        Least and greatest pressure, Pa.
    reference_pressure : float
        Where the absolute accuracy is stated, Pa: the scale error turns about this point.
    offset_sd, offset_limit : float
        Turn-on offset: standard deviation over units and bound, Pa.
    offset_tc_sd, offset_tc_limit : float
        Its temperature coefficient, Pa/K, alike.
    solder : (float, float)
        Shift of the offset by soldering, least and greatest, Pa: three standard deviations from their middle.
    acceleration_sd, acceleration_limit : float
        Sensitivity of the membrane to specific force along its normal, Pa/(m/s²), alike.
    scale_sd, scale_limit : float
        Scale error, Pa/Pa, alike.
    rate_sd, rate_limit : float
        Relative error of the part's oscillator, alike.
    drift_sd, correlation_time : float
        In-run drift as a Gauss-Markov process, Pa and s.
    random_walk : float
        In-run random walk, Pa/√s.
    temperature_offset_sd, temperature_offset_limit : float
        Offset of the thermometer, K.
    temperature_resolution : float
        Step of its reading, K.
    noise_scale : float
        Factor on the white noise of pressure and temperature.
    errors : PressureErrors
        Factors that are already in the numbers above, and what is switched off.
    """

    name: str
    document: str
    modes: tuple[PressureMode, ...]
    mode: PressureMode
    iir_weights: tuple[tuple[int, float], ...]
    iir: int
    range: tuple[float, float]
    reference_pressure: float
    offset_sd: float = term("offset_pa", OFFSET_PA, factor="offset")
    offset_limit: float = term("offset_limit_pa", OFFSET_PA, factor="offset")
    offset_tc_sd: float = term("offset_tc_pa", OFFSET_TC_PA, factor="temperature")
    offset_tc_limit: float = term("offset_tc_limit_pa", OFFSET_TC_PA, factor="temperature")
    solder: tuple[float, float] = term("solder_pa", SOLDER_PA, pair, factor="solder", default=(0.0, 0.0))
    acceleration_sd: float = term("acceleration_pa", ACCELERATION_PA, factor="acceleration", default=0.0)
    acceleration_limit: float = term("acceleration_limit_pa", ACCELERATION_PA, factor="acceleration", default=inf)
    scale_sd: float = term("scale", SCALE, factor="scale")
    scale_limit: float = term("scale_limit", SCALE, factor="scale")
    rate_sd: float = term("rate_percent", CLOCK, percent, factor="clock", default=0.0)
    rate_limit: float = term("rate_limit_percent", CLOCK, percent, factor="clock", default=inf)
    drift_sd: float = term("drift_pa", DRIFT_PA, factor="drift")
    correlation_time: float = term("correlation_time", CORRELATION)
    random_walk: float = term("random_walk_pa", WALK_PA, factor="random_walk")
    temperature_offset_sd: float = term("temperature_offset_k", WARMTH, factor="thermometer")
    temperature_offset_limit: float = term("temperature_offset_limit_k", WARMTH, factor="thermometer")
    temperature_resolution: float = term("temperature_resolution_k", RESOLUTION_K)
    noise_scale: float = 1.0
    errors: PressureErrors = PressureErrors()

    def select(self, *, mode: str | None = None, iir: int | None = None) -> Self:
        """Return the same part in another mode ("x8/x1") or with another filter coefficient; ValueError if none."""
        chosen = self.mode
        if mode is not None:
            names = [known.name for known in self.modes]
            chosen = self.modes[names.index(choose(f"{self.name}: mode", mode, names))]
        coefficients = [coefficient for coefficient, _ in self.iir_weights]
        return replace(
            self, mode=chosen, iir=self.iir if iir is None else choose(f"{self.name}: iir", iir, coefficients)
        )

    def scaled(self, noise_scale: float, errors: PressureErrors | None = None) -> Self:
        """Return a part with its white noise and its errors times these factors, for the unit and for a filter."""
        e = PressureErrors() if errors is None else errors
        return replace(
            self,
            noise_scale=self.noise_scale * noise_scale,
            **scaled(self, e),
            errors=e,
        )

    @property
    def resolution(self) -> float:
        """Step of a pressure reading before the digital filter, Pa."""
        return self.mode.resolution if self.errors.quantisation else UNQUANTISED_STEP

    @property
    def temperature_step(self) -> float:
        """Step of a temperature reading before the digital filter, K."""
        return self.temperature_resolution if self.errors.quantisation else UNQUANTISED_STEP

    @property
    def rate(self) -> float:
        """Nominal conversions a second, Hz."""
        return self.mode.rate

    @property
    def iir_weight(self) -> float:
        """Weight a of the digital filter y += a (x - y); 1 when it is off."""
        return dict(self.iir_weights)[self.iir]

    @property
    def noise_sd(self) -> float:
        """Standard deviation of the noise a reading, quantisation included, behind the digital filter, Pa.

        The filter y += a (x - y) passes the fraction a/(2 - a) of a white sequence's variance, and correlates what it
        passes from one reading to the next.
        """
        return _with_quantisation(self.mode.noise_sd * self.noise_scale, self.resolution) * self._iir_gain

    @property
    def temperature_noise_sd(self) -> float:
        """The same of the thermometer, K."""
        sd = self.mode.temperature_noise_sd * self.noise_scale
        return _with_quantisation(sd, self.temperature_step) * self._iir_gain

    @property
    def white_sd(self) -> float:
        """Standard deviation of the noise before quantisation and filter, Pa: what quantisation adds is taken off."""
        return _without_quantisation(self.mode.noise_sd * self.noise_scale, self.resolution)

    @property
    def temperature_white_sd(self) -> float:
        """The same of the thermometer, K."""
        return _without_quantisation(self.mode.temperature_noise_sd * self.noise_scale, self.temperature_step)

    @property
    def lag(self) -> float:
        """Age of a pressure behind the digital filter, beside that of half a conversion, s."""
        a = self.iir_weight
        return (1.0 - a) / a / self.rate

    @property
    def walk(self) -> float:
        """What drift and random walk are together, as a random walk, Pa/√s.

        A drift of standard deviation σ and correlation time τ wanders at first as a random walk of density 2σ²/τ.
        """
        return sqrt(2.0 * self.drift_sd**2 / self.correlation_time + self.random_walk**2)

    @property
    def bandwidth(self) -> float:
        """The -3 dB frequency, Hz: of the digital filter, else of the mean over the conversion window."""
        a = self.iir_weight
        if a > FASTEST_FILTER:
            return 0.4429 / self.mode.conversion_time  # sinc(f T) = 1/√2 at f T = 0.4429
        return acos(1.0 - a * a / (2.0 * (1.0 - a))) / (2.0 * pi) * self.rate

    @property
    def _iir_gain(self) -> float:
        return sqrt(self.iir_weight / (2.0 - self.iir_weight))


def _with_quantisation(sd: float, step: float) -> float:
    """Return the standard deviation of a reading: that of its noise, but at least that of rounding to `step`."""
    return max(sd, step / sqrt(12.0))


def _without_quantisation(sd: float, step: float) -> float:
    """Return the standard deviation that, with rounding to `step` (variance step²/12), makes `sd`."""
    return sqrt(max(sd * sd - step * step / 12.0, 0.0))
