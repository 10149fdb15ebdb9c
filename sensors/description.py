"""What is known of a part before one is bought: its datasheet as numbers, in one range, rate and mode.

One description serves two readers. The simulator draws a unit from it (`draw_error` for each turn-on error, the noise
sequences from its densities); a filter takes its plain numbers from it (`noise_sd`, `random_walk`, `correlation_time`,
`resolution`, …). That the two agree is then the rule, and a mismatch is something that a study chooses.

White noise of an accelerometer: σ = n √(ENBW), with n the one-sided density. Its decimation filter passes f/2 of an
output rate f and is steep, so ENBW = f/2 and σ = n √(f/2). White noise of a pressure sensor: the datasheet's figure a
conversion, for its mode, used as it is.
"""

from dataclasses import dataclass, replace
from math import acos, pi, sqrt
from typing import Literal, TypeVar

import numpy as np

from sensors.choice import choose

Triple = tuple[float, float, float]

Item = TypeVar("Item")

Unit = Literal["random", "typical", "ideal"]

G0 = 9.80665  # standard gravity, m/s² (CGPM 1901)

# x + ROUND - ROUND is x rounded to a whole number, ties to even, for |x| < 2^51, and NaN for NaN: the sum has no bits
# left below 1 (IEEE 754 double). It costs half of what round() does.
ROUND = 1.5 * 2.0**52


def draw_error(generator: np.random.Generator, sd: float, limit: float, unit: Unit) -> float:
    """Return a turn-on error of one unit.

    Parameters
    ----------
    generator : numpy.random.Generator
    sd : float
        Standard deviation over units.
    limit : float
        The datasheet's guaranteed bound: a part beyond it is not sold, so it is drawn again.
    unit : {"random", "typical", "ideal"}
        Drawn; off by exactly one standard deviation; without error.
    """
    if unit == "ideal":
        return 0.0
    if unit == "typical":
        return sd
    while True:
        error = float(generator.normal()) * sd
        if abs(error) <= limit:
            return error


@dataclass(frozen=True, slots=True)
class AccelerometerDescription:
    """A three-axis accelerometer at one range and rate; SI, but for names that end in _g.

    Attributes
    ----------
    name, document : str
        The preset's name; where its numbers are from.
    ranges_g, rates : tuple of float
        What the part can be set to: ±range in g, output rates in Hz.
    range_g, rate : float
        What it is set to.
    bits : tuple of int
        Width of a reading, sign included, for each of `ranges_g`.
    noise_densities : tuple of (x, y, z)
        One-sided root density of the white noise for each of `ranges_g`, (m/s²)/√Hz.
    noise_rate_floor : float
        Rate below which the noise a sample stays as it is at this rate, Hz (0: none).
    bias_sd, bias_limit : (x, y, z)
        Zero-g offset at turn-on: standard deviation over units and bound, m/s².
    scale_sd, scale_limit : float
        Scale error, a fraction, alike.
    drift_sd, correlation_time : float
        In-run bias drift as a Gauss-Markov process, m/s² and s.
    random_walk : float
        In-run bias random walk, (m/s²)/√s.
    """

    name: str
    document: str
    ranges_g: tuple[float, ...]
    rates: tuple[float, ...]
    range_g: float
    rate: float
    bits: tuple[int, ...]
    noise_densities: tuple[Triple, ...]
    noise_rate_floor: float
    bias_sd: Triple
    bias_limit: Triple
    scale_sd: float
    scale_limit: float
    drift_sd: float
    correlation_time: float
    random_walk: float

    def select(self, *, range_g: float | None = None, rate: float | None = None) -> "AccelerometerDescription":
        """Return the same part set to another range (g) or output rate (Hz); ValueError if it has none such."""
        return replace(
            self,
            range_g=self.range_g if range_g is None else choose(f"{self.name}: range_g", float(range_g), self.ranges_g),
            rate=self.rate if rate is None else choose(f"{self.name}: rate", float(rate), self.rates),
        )

    def scaled(self, noise_scale: float) -> "AccelerometerDescription":
        """Return a part that is as this one but for its white noise: an assumption about the part, unit and filter."""
        densities = tuple((x * noise_scale, y * noise_scale, z * noise_scale) for x, y, z in self.noise_densities)
        return replace(self, noise_densities=densities)

    @property
    def range(self) -> float:
        """Largest specific force of either sign, m/s²."""
        return self.range_g * G0

    @property
    def resolution(self) -> float:
        """Least significant bit, m/s²."""
        return self.range / float(1 << (self._at_range(self.bits) - 1))

    @property
    def bandwidth(self) -> float:
        """The -3 dB frequency of the part's signal path, Hz."""
        return self.rate / 2.0

    @property
    def noise_density(self) -> Triple:
        """One-sided root density of the white noise at this range, (m/s²)/√Hz."""
        return self._at_range(self.noise_densities)

    @property
    def noise_sd(self) -> Triple:
        """Standard deviation of the white noise a sample at this range and rate, m/s²."""
        root = sqrt(max(self.rate, self.noise_rate_floor) / 2.0)
        x, y, z = self.noise_density
        return x * root, y * root, z * root

    def _at_range(self, per_range: tuple[Item, ...]) -> Item:
        return per_range[self.ranges_g.index(self.range_g)]


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


@dataclass(frozen=True, slots=True)
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
    """

    name: str
    document: str
    modes: tuple[PressureMode, ...]
    mode: PressureMode
    iir_weights: tuple[tuple[int, float], ...]
    iir: int
    range: tuple[float, float]
    reference_pressure: float
    offset_sd: float
    offset_limit: float
    scale_sd: float
    scale_limit: float
    rate_sd: float
    rate_limit: float
    drift_sd: float
    correlation_time: float
    random_walk: float
    temperature_offset_sd: float
    temperature_offset_limit: float
    temperature_resolution: float
    noise_scale: float = 1.0

    def select(self, *, mode: str | None = None, iir: int | None = None) -> "PressureDescription":
        """Return the same part in another mode ("x8/x1") or with another filter coefficient; ValueError if none."""
        chosen = self.mode
        if mode is not None:
            names = [known.name for known in self.modes]
            chosen = self.modes[names.index(choose(f"{self.name}: mode", mode, names))]
        coefficients = [coefficient for coefficient, _ in self.iir_weights]
        return replace(
            self, mode=chosen, iir=self.iir if iir is None else choose(f"{self.name}: iir", iir, coefficients)
        )

    def scaled(self, noise_scale: float) -> "PressureDescription":
        """Return a part that is as this one but for its white noise: an assumption about the part, unit and filter."""
        return replace(self, noise_scale=self.noise_scale * noise_scale)

    @property
    def resolution(self) -> float:
        """Step of a pressure reading before the digital filter, Pa."""
        return self.mode.resolution

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
        return self.mode.noise_sd * self.noise_scale * self._iir_gain

    @property
    def temperature_noise_sd(self) -> float:
        """The same of the thermometer, K."""
        return self.mode.temperature_noise_sd * self.noise_scale * self._iir_gain

    @property
    def white_sd(self) -> float:
        """Standard deviation of the noise before quantisation and filter, Pa: what quantisation adds is taken off."""
        return _without_quantisation(self.mode.noise_sd * self.noise_scale, self.resolution)

    @property
    def temperature_white_sd(self) -> float:
        """The same of the thermometer, K."""
        return _without_quantisation(self.mode.temperature_noise_sd * self.noise_scale, self.temperature_resolution)

    @property
    def bandwidth(self) -> float:
        """The -3 dB frequency, Hz: of the digital filter, or of the mean over the conversion window if that is off."""
        a = self.iir_weight
        if a == 1.0:
            return 0.4429 / self.mode.conversion_time  # sinc(f T) = 1/√2 at f T = 0.4429
        return acos(1.0 - a * a / (2.0 * (1.0 - a))) / (2.0 * pi) * self.rate

    @property
    def _iir_gain(self) -> float:
        return sqrt(self.iir_weight / (2.0 - self.iir_weight))


def _without_quantisation(sd: float, step: float) -> float:
    """Return the standard deviation that, with rounding to `step` (variance step²/12), makes `sd`."""
    return sqrt(max(sd * sd - step * step / 12.0, 0.0))
