"""What is known of an accelerometer before one is bought: its datasheet as numbers, at one range, rate and filter.

White noise: σ = n √(ENBW), n the one-sided density. Where the part's own filter leaves all of f/2 of an output rate f,
its decimation is steep, ENBW = f/2 and σ = n √(f/2). Where it passes less, the readings' noise is that of n behind one
or two poles at the output rate, and ENBW is theirs (`sensors.noise.enbw`).

Every term has a factor on what the datasheet says of it (`AccelerometerErrors`): 0 switches it off, 3 is three times as
bad. The factors become part of the description, so the simulated unit and a filter go by the same numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot, inf, pi, sqrt
from typing import TypeVar

from sensors.choice import choose
from sensors.noise import enbw
from sensors.rules import listed, number
from sensors.term import percent, scaled, term
from sensors.unit import CLOCK, CORRELATION, G0, DriftModel, Factor, Triple

Item = TypeVar("Item")

UG, MG = 1e-6 * G0, 1e-3 * G0  # µg and mg, m/s²

OFFSET_MG = listed(number(0.0, 1e5), count=3)  # mg: 100 g; a part of ±400 g is off by 1 g
OFFSET_TC_MG = listed(number(0.0, 1e3), count=3)  # mg/K: 1 g/K, of which the range must hold 100 K (`datasheet_check`)
SCALE = number(0.0, 50.0)  # %: at 100 % the axis would read nothing, or the other way round
SCALE_TC = number(0.0, 0.3)  # %/K: 30 % over the 100 K between the coldest and the warmest day
CROSS_AXIS = number(0.0, 50.0)  # %: the sine of 30°, where an axis would not be told from its neighbour
NONLINEARITY = number(0.0, 20.0)  # % of the range: the curve k₃ u³ turns back beyond 25 %
RECTIFICATION = number(0.0, 1e5)  # µg/g²: 0.1 g of offset from 1 g rms; the worst parts have 1000
DRIFT = number(0.0, 1e6)  # µg: 1 g of bias that wanders; parts have below 1000
WALK = number(0.0, 1e6)  # µg/√s: 1 g after a second; parts have below 100

LATER = 1.0  # K, by which a die may be warmer than on the rail: a climb of 150 m, or its own heat
SWITCHED_ON = 60.0  # s, over which a walk of the offset counts
UNQUANTISED_BITS = 40  # stand for no quantisation: steps of range/2^39, 6e-10 m/s² at ±32 g


def milli_g(values: Sequence[float]) -> Triple:
    """Return three values in mg, m/s²."""
    x, y, z = values
    return x * MG, y * MG, z * MG


def micro_g(value: float) -> float:
    """Return a value in µg, m/s²."""
    return value * UG


def per_g2(value: float) -> float:
    """Return a value in µg/g², 1/(m/s²)."""
    return value * UG / G0**2


@dataclass(frozen=True, slots=True)
class AccelerometerErrors:
    """Factors on the datasheet's figures for the accelerometer: 0 is without, 1 as the datasheet has it.

    Attributes
    ----------
    bias : float
        Zero-g offset at turn-on.
    scale : float
        Scale error.
    cross_axis : float
        Misalignment and cross-axis sensitivity.
    nonlinearity : float
        Cubic nonlinearity, and the quadratic one that rectifies vibration.
    temperature : float
        Temperature coefficients of offset and scale.
    drift : float
        In-run bias instability.
    random_walk : float
        In-run random walk of the bias.
    clock : float
        Error of the output rate.
    drift_model : str
        How the bias instability wanders: "gauss-markov", one correlation time, or "flicker", true 1/f noise.
    bandwidth : bool
        Whether the signal passes the part's low-pass; the noise keeps its figure.
    saturation : bool
        Whether readings end at the range.
    quantisation : bool
        Whether readings come in steps.
    """

    bias: Factor = 1.0
    scale: Factor = 1.0
    cross_axis: Factor = 1.0
    nonlinearity: Factor = 1.0
    temperature: Factor = 1.0
    drift: Factor = 1.0
    random_walk: Factor = 1.0
    clock: Factor = 1.0
    drift_model: DriftModel = "gauss-markov"
    bandwidth: bool = True
    saturation: bool = True
    quantisation: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class AccelerometerDescription:
    """A three-axis accelerometer at one range, rate and filter; SI, but for names that end in _g.

    Attributes
    ----------
    name, document : str
        The preset's name; where its numbers are from.
    ranges_g, rates, filters : tuple
        What the part can be set to: ±range in g, output rates in Hz, names of its low-pass settings.
    range_g, rate, filter : float, float, str
        What it is set to.
    bits : tuple of int
        Width of a reading, sign included, for each of `ranges_g`.
    bandwidths : tuple of tuple of float
        -3 dB frequency, Hz, for each of `filters` and each of `rates`; 0 where the part has no such combination.
    poles : int
        Poles of the low-pass that stands for the part's signal path, 1 or 2 (Butterworth); 0: a reading is the mean of
        the signal since the one before, a moving average, whatever `bandwidths` says.
    noise_densities : tuple of (x, y, z)
        One-sided root density of the white noise for each of `ranges_g`, (m/s²)/√Hz.
    noise_rate_floor : float
        Rate below which the noise a sample stays as it is at this rate, Hz (0: none).
    bias_sd, bias_limit : (x, y, z)
        Zero-g offset at turn-on: standard deviation over units and bound, m/s².
    bias_tc_sd, bias_tc_limit : (x, y, z)
        Its temperature coefficient, alike, (m/s²)/K.
    scale_sd, scale_limit, scale_tc_sd, scale_tc_limit : float
        Scale error, a fraction, and its temperature coefficient, 1/K, alike.
    cross_axis_sd, cross_axis_limit : float
        Each off-diagonal term of the sensitivity matrix, a fraction, alike.
    nonlinearity_sd : float
        Greatest deviation from the best straight line, of the range: that of a cubic.
    rectification_sd : float
        Offset that vibration adds, by its mean square: the coefficient of a quadratic, 1/(m/s²).
    drift_sd, correlation_time : float
        In-run bias drift as a Gauss-Markov process, m/s² and s.
    random_walk : float
        In-run bias random walk, (m/s²)/√s.
    rate_sd, rate_limit : float
        Relative error of the output rate, alike.
    errors : AccelerometerErrors
        Factors that are already in the numbers above, and what is switched off.
    """

    name: str
    document: str
    ranges_g: tuple[float, ...]
    rates: tuple[float, ...]
    filters: tuple[str, ...]
    range_g: float
    rate: float
    filter: str
    bits: tuple[int, ...]
    bandwidths: tuple[tuple[float, ...], ...]
    poles: int
    noise_densities: tuple[Triple, ...]
    noise_rate_floor: float = term("noise_rate_floor", number(0.0, 40_000.0), default=0.0)  # Hz: a rate of the part
    bias_sd: Triple = term("offset_mg", OFFSET_MG, milli_g, factor="bias")
    bias_limit: Triple = term("offset_limit_mg", OFFSET_MG, milli_g, factor="bias")
    bias_tc_sd: Triple = term("offset_tc_mg", OFFSET_TC_MG, milli_g, factor="temperature")
    bias_tc_limit: Triple = term("offset_tc_limit_mg", OFFSET_TC_MG, milli_g, factor="temperature")
    scale_sd: float = term("scale_percent", SCALE, percent, factor="scale")
    scale_limit: float = term("scale_limit_percent", SCALE, percent, factor="scale")
    scale_tc_sd: float = term("scale_tc_percent", SCALE_TC, percent, factor="temperature", default=0.0)
    scale_tc_limit: float = term("scale_tc_limit_percent", SCALE_TC, percent, factor="temperature", default=inf)
    cross_axis_sd: float = term("cross_axis_percent", CROSS_AXIS, percent, factor="cross_axis", default=0.0)
    cross_axis_limit: float = term("cross_axis_limit_percent", CROSS_AXIS, percent, factor="cross_axis", default=inf)
    nonlinearity_sd: float = term("nonlinearity_percent", NONLINEARITY, percent, factor="nonlinearity", default=0.0)
    rectification_sd: float = term("rectification_ug", RECTIFICATION, per_g2, factor="nonlinearity", default=0.0)
    drift_sd: float = term("drift_ug", DRIFT, micro_g, factor="drift")
    correlation_time: float = term("correlation_time", CORRELATION)
    random_walk: float = term("random_walk_ug", WALK, micro_g, factor="random_walk")
    rate_sd: float = term("rate_percent", CLOCK, percent, factor="clock", default=0.0)
    rate_limit: float = term("rate_limit_percent", CLOCK, percent, factor="clock", default=inf)
    errors: AccelerometerErrors = AccelerometerErrors()

    def select(
        self, *, range_g: float | None = None, rate: float | None = None, filter: str | None = None
    ) -> "AccelerometerDescription":
        """Return the same part set to another range (g), output rate (Hz) or low-pass; ValueError if it has none."""
        part = replace(
            self,
            range_g=self.range_g if range_g is None else choose(f"{self.name}: range_g", float(range_g), self.ranges_g),
            rate=self.rate if rate is None else choose(f"{self.name}: rate", float(rate), self.rates),
            filter=self.filter if filter is None else choose(f"{self.name}: filter", filter, self.filters),
        )
        if not part.datasheet_bandwidth:
            available = [rate for rate, width in zip(part.rates, part._passed, strict=True) if width]
            listed = ", ".join(f"{rate:g}" for rate in available)
            raise ValueError(
                f"{self.name}: filter {part.filter!r} does not exist at {part.rate:g} Hz; allowed: {listed}"
            )
        return part

    def scaled(self, noise_scale: float, errors: AccelerometerErrors | None = None) -> "AccelerometerDescription":
        """Return a part with its white noise and its errors times these factors, for the unit and for a filter."""
        e = AccelerometerErrors() if errors is None else errors
        return replace(
            self,
            noise_densities=tuple(_times(density, noise_scale) for density in self.noise_densities),
            **scaled(self, e),
            errors=e,
        )

    @property
    def range(self) -> float:
        """Largest specific force of either sign, m/s²."""
        return self.range_g * G0

    @property
    def resolution(self) -> float:
        """Least significant bit, m/s²."""
        bits = self._at_range(self.bits) if self.errors.quantisation else UNQUANTISED_BITS
        return self.range / float(1 << (bits - 1))

    @property
    def datasheet_bandwidth(self) -> float:
        """The -3 dB frequency of the part's signal path at this rate and filter, Hz; 0 if there is no such setting."""
        return self._passed[self.rates.index(self.rate)]

    @property
    def bandwidth(self) -> float:
        """The -3 dB frequency that the signal passes, Hz: the datasheet's, or infinite if it is switched off."""
        return self.datasheet_bandwidth if self.errors.bandwidth else float("inf")

    @property
    def noise_bandwidth(self) -> float:
        """The -3 dB frequency of the low-pass behind the noise, Hz; half the rate, none, where readings are means."""
        return self.datasheet_bandwidth if self.poles else 0.5 * self.rate

    @property
    def noise_density(self) -> Triple:
        """One-sided root density of the white noise at this range, (m/s²)/√Hz."""
        return self._at_range(self.noise_densities)

    @property
    def white_sd(self) -> Triple:
        """Standard deviation a sample of the white noise ahead of the part's low-pass, at the output rate, m/s²."""
        return _times(self.noise_density, sqrt(max(self.rate, self.noise_rate_floor) / 2.0))

    @property
    def noise_sd(self) -> Triple:
        """Standard deviation a sample of the readings' noise at this range, rate and filter, m/s²."""
        passed = enbw(self.noise_bandwidth, self.rate, self.poles or 1) / (self.rate / 2.0)
        return _times(self.white_sd, sqrt(passed))

    @property
    def reading_sd(self) -> Triple:
        """Standard deviation of a reading's noise with its rounding, m/s²."""
        x, y, z = (hypot(sd, self.resolution / sqrt(12.0)) for sd in self.noise_sd)
        return x, y, z

    @property
    def lag(self) -> float:
        """Age of a steady signal behind the part's low-pass, s."""
        if not self.errors.bandwidth:
            return 0.0
        if not self.poles:
            return 0.5 / self.rate
        return sqrt(self.poles) / (2.0 * pi * self.bandwidth)  # Butterworth: 1/ω for one pole, √2/ω for two

    def gain_sd(self, warmer: float) -> float:
        """Standard deviation of the scale error, a fraction, of a die off 25 °C by so much, K."""
        return hypot(self.scale_sd, self.scale_tc_sd * warmer)

    def offset_sd(self, axis: int, *, warmer: float, shaking: float, down: float) -> float:
        """Return the standard deviation of what an axis reads at rest less the truth, all terms together, m/s².

        Parameters
        ----------
        axis : int
            0, 1, 2 for x, y, z.
        warmer : float
            By how much the die may be off 25 °C, K.
        shaking : float
            Rms of the vibration, m/s².
        down : float
            Share of the 1 g that is along the axis, -1 … 1.
        """
        return hypot(
            self.bias_sd[axis],
            self.bias_tc_sd[axis] * warmer,
            self.drift_sd,
            self.random_walk * sqrt(SWITCHED_ON),
            self.rectification_sd * shaking**2,
            self.gain_sd(warmer) * G0 * down,
            self.cross_axis_sd * G0 * sqrt(max(0.0, 1.0 - down * down)),
        )

    def wander_sd(self, *, shaking: float) -> float:
        """Return by how much an offset that was found at rest may have moved in a flight of a minute, m/s².

        Drift, random walk, a die that has become warmer by `LATER`, and what vibration is rectified to, which shakes
        by `shaking`, m/s² rms, in flight and hardly at rest: of the worst axis.
        """
        return hypot(
            self.drift_sd,
            self.random_walk * sqrt(SWITCHED_ON),
            max(self.bias_tc_sd) * LATER,
            self.rectification_sd * shaking**2,
        )

    @property
    def _passed(self) -> tuple[float, ...]:
        """-3 dB frequency at each rate with this filter, Hz."""
        return self.bandwidths[self.filters.index(self.filter)]

    def _at_range(self, per_range: tuple[Item, ...]) -> Item:
        return per_range[self.ranges_g.index(self.range_g)]


def _times(triple: Triple, factor: float) -> Triple:
    x, y, z = triple
    return x * factor, y * factor, z * factor
