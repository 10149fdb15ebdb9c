"""Airspeed from the readings of an air-data head: filter the pressures, then take the root.

The published method that this project tests: total and static pressure are random walks, each seen through white
noise, and each has a scalar Kalman filter (its Algorithm 1 with f(x) = h(x) = x). A new reading z does

    P⁻ = P + Q,    K = P⁻/(P⁻ + R),    x = x + K·(z − x),    P = (1 − K)·P⁻ = K·R

with Q the growth of the walk's variance a sample and R the variance of a reading, both Pa². K settles where
K²/(1 − K) = Q/R (`steady_gain`). NIS, the innovation squared over what the filter expects of it, (z − x)²/(P⁻ + R),
has the mean 1 if pressure and sensor are as the filter believes. The airspeed follows from the filtered pressures and
the measured temperature by `airdata`; the mean of p_t − p_s under the cover, the pair's tare, is taken off p_t first.

Standard deviation of the airspeed
----------------------------------
With σ the standard deviation of p_t − p_s as the filter knows it, Bernoulli's V²·ρ/2 = p_t − p_s sets a speed below
which the noise hides the airspeed and above which it is small:

    V* = √(2σ/ρ),        σ_V = σ/(ρ·V) = V*²/(2·V)   for V ≫ V*

The second is the derivative of the root and within 5 % from V = 1.9·V* on. At V = 0 it has no meaning: there p_t − p_s
is Gaussian about 0 and clipped, E[V²] = (2/ρ)·σ/√(2π) = 0.399·V*², an rms error of 0.632·V*. Stopping the law at
0.8·V*, σ_V = V*²/(2·max(V, 0.8·V*)), gives 0.625·V* there and joins the two. An airspeed is called valid from 2·V* on,
4σ of p_t − p_s; below V* nothing better is known than what the wind may be, so σ_V is never above `wind_sd` there.

Compressibility changes the slope, not the law: for the isentropic relation dV/dp_t = 1/(ρ₀·V) with the stagnation
density ρ₀ = ρ·(p_t/p_s)^(1/γ), and for either relation dV/dp_s = −(p_t/p_s)·dV/dp_t, which holds the share of p_s in
the density. Temperature adds dV/dT = V/(2T). So, with τ² the variance of the tare,

    σ² = P_t + τ² + (p_t/p_s)²·P_s,        σ_V² = [V*²/(2·max(V, 0.8·V*))·ρ/ρ₀]² + [V·σ_T/(2T)]²
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isnan, nan, sqrt
from typing import Annotated, Any, Literal, Protocol

import numpy as np
from annotated_types import Ge, Gt, Interval

from uavsim import airdata
from uavsim.airdata import MAX_TEMPERATURE, MIN_TEMPERATURE

Estimate = tuple[float, float, float, float, float, float, bool, float, float]
"""t s, airspeed, airspeed_sd, airspeed_raw m/s, p_total (tared), p_static Pa, valid, nis_total, nis_static."""

FLOOR = 0.8  # V*; below it the linear law would exceed the rms error of the clipped root
VALID = 2.0  # V*; from here on the airspeed is called valid


@dataclass(frozen=True, slots=True)
class EstimatorSettings:
    """Which airspeed estimator is flown, and its settings.

    Attributes
    ----------
    kind : str
        "paper", the published method; "paper-filterpy", the same through the filterpy package.
    model : str
        Relation of pressures and airspeed, "compressible" or "bernoulli".
    gain_total, gain_static : float
        Steady gains of the two filters: Q is set so that a sensor of the noise that the part's description says gets
        them. A quieter part of another description gets the same gain; what `[mismatch]` makes the filter believe does
        change it.
    q_total, q_static : float or None
        Q itself, growth of the pressure's variance from one sample to the next, Pa², in place of the gain.
    wind_sd : float
        Standard deviation of the airspeed while nothing is measured, m/s: that of the wind.
    vapour_fraction : float
        Mole fraction of water vapour in the air.
    calibration : float
        K, which multiplies the airspeed.
    """

    kind: Literal["paper", "paper-filterpy"] = "paper"
    model: airdata.Model = "compressible"
    gain_total: Annotated[float, Interval(gt=0.0, lt=1.0)] = 0.8
    gain_static: Annotated[float, Interval(gt=0.0, lt=1.0)] = 0.3
    q_total: Annotated[float, Interval(gt=0.0, le=1e8)] | None = None
    q_static: Annotated[float, Interval(gt=0.0, le=1e8)] | None = None
    wind_sd: Annotated[float, Interval(gt=0.0, le=100.0)] = 3.0
    vapour_fraction: Annotated[float, Interval(ge=0.0, le=0.2)] = 0.0
    calibration: Annotated[float, Interval(gt=0.0, le=10.0)] = 1.0


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """What the estimator believes of its sensors: standard deviations of one reading.

    Attributes
    ----------
    total_sd, static_sd : float
        Of the two pressures, Pa.
    temperature_sd : float
        Of the temperature, K; its turn-on error included.
    total_tuned_sd, static_tuned_sd : float or None
        Those that the filters' gains were chosen for, Pa; None: the same as are believed.
    """

    total_sd: Annotated[float, Ge(0.0)]
    static_sd: Annotated[float, Ge(0.0)]
    temperature_sd: Annotated[float, Ge(0.0)]
    total_tuned_sd: Annotated[float, Ge(0.0)] | None = None
    static_tuned_sd: Annotated[float, Ge(0.0)] | None = None


def process_noise(settings: EstimatorSettings, noise: NoiseModel) -> tuple[float, float]:
    """Return Q of the total and of the static pressure's filter, Pa²: K²/(1 − K) times the variance tuned for.

    A sensor without noise leaves no choice: any Q makes the gain 1.
    """
    total = noise.total_sd if noise.total_tuned_sd is None else noise.total_tuned_sd
    static = noise.static_sd if noise.static_tuned_sd is None else noise.static_tuned_sd
    return (
        settings.q_total or growth(settings.gain_total, total**2) or 1.0,
        settings.q_static or growth(settings.gain_static, static**2) or 1.0,
    )


def growth(gain: float, r: float) -> float:
    """Return Q for which a random walk's filter settles at `gain` on readings of variance `r`: K²/(1 − K) r."""
    return gain * gain / (1.0 - gain) * r


def steady_gain(q: Annotated[float, Gt(0.0)], r: Annotated[float, Ge(0.0)]) -> float:
    """Find the gain at which the filter of a random walk settles, the root of K²/(1 − K) = q/r in 0…1.

    Parameters
    ----------
    q, r : float
        Growth of the walk's variance a sample and variance of a reading, of the same unit.

    Raises
    ------
    ValueError
        q ≤ 0 or r < 0.

    Examples
    --------
    >>> round(steady_gain(3.2, 1.0), 12)
    0.8
    """
    if not (q > 0.0 and r >= 0.0):
        raise ValueError("q must be above 0 and r not below")
    return 2.0 / (1.0 + sqrt(1.0 + 4.0 * r / q))


class Channel(Protocol):
    """A filter of one pressure."""

    value: float  # Pa, NaN before the first reading
    variance: float  # Pa², infinite before the first reading
    nis: float  # normalised innovation squared of the last reading, NaN if it was the first or no pressure

    def add(self, reading: float) -> None:
        """Take the reading of one conversion, Pa; one that is no pressure only lets the variance grow."""


class RandomWalk:
    """Scalar Kalman filter of a random walk in white noise, started by its first reading.

    Parameters
    ----------
    q, r : float
        Growth of the walk's variance a sample and variance of a reading, Pa².
    """

    __slots__ = ("_q", "_r", "nis", "value", "variance")

    def __init__(self, q: float, r: float) -> None:
        self._q, self._r = q, r
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        """Predict, and update if the reading is a pressure."""
        prior = self.variance + self._q
        if not 0.0 < reading < inf:
            self.variance, self.nis = prior, nan
        elif prior == inf:
            self.value, self.variance = reading, self._r
        else:
            innovation, spread = reading - self.value, prior + self._r
            gain = prior / spread
            self.value += gain * innovation
            self.variance = gain * self._r
            self.nis = innovation * innovation / spread


class _Tare:
    """Mean of p_t − p_s over the readings with start < t ≤ end, and what the noise leaves of its variance."""

    __slots__ = ("_count", "_new_static", "_new_total", "_start", "_static_variance", "_sum", "_total_variance", "end")

    def __init__(self, start: float, end: float, noise: NoiseModel) -> None:
        self._start, self.end = start, end
        self._total_variance, self._static_variance = noise.total_sd**2, noise.static_sd**2
        self._sum = 0.0
        self._count = self._new_total = self._new_static = 0

    def add(self, t: float, difference: float, new_total: bool, new_static: bool) -> None:
        """Take one reading; a conversion that is read twice weighs twice, but brings its noise only once."""
        if self._start < t <= self.end and -inf < difference < inf:
            self._sum += difference
            self._count += 1
            self._new_total += new_total
            self._new_static += new_static

    def result(self) -> tuple[float, float]:
        """Return the mean, Pa, and its variance, Pa²; zeros if nothing was read."""
        if not self._count:
            return 0.0, 0.0
        variance = self._total_variance / max(1, self._new_total) + self._static_variance / max(1, self._new_static)
        return self._sum / self._count, variance


class PaperFilter:
    """The published estimator, stepped with each reading of the head.

    Parameters
    ----------
    settings : EstimatorSettings
        Its tuning.
    noise : NoiseModel
        What it believes of the sensors.
    tare_window : tuple of float, optional
        Readings with tare_window[0] < t ≤ tare_window[1], s, are under the cover: their mean p_t − p_s is the tare,
        and up to the second time the airspeed is held at 0. None: no tare and no cover.

    Notes
    -----
    A reading that is NaN, infinite or ≤ 0 Pa (for the thermometer: outside 150–400 K) is missing. A missing pressure
    lets that channel's variance grow; a missing temperature leaves the last one in use. Without a reading in its
    window the tare is 0.
    """

    __slots__ = (
        "_compressible",
        "_heating",
        "_relation",
        "_scale",
        "_star",
        "_static",
        "_t",
        "_t_static",
        "_t_total",
        "_tare",
        "_tare_variance",
        "_taring",
        "_temperature",
        "_temperature_share",
        "_total",
        "_wind_sd",
    )

    def __init__(
        self, settings: EstimatorSettings, noise: NoiseModel, tare_window: tuple[float, float] | None = None
    ) -> None:
        self._total, self._static = self._channels(settings, noise)
        self._compressible = settings.model == "compressible"
        self._relation: Callable[[float, float, float], float] = (
            airdata.compressible_airspeed if self._compressible else airdata.bernoulli_airspeed
        )
        # Airspeed over that of dry air with K = 1; the lighter moist air is faster for the same pressures.
        reference = {"pressure": 101_325.0, "temperature": 288.15, "compressibility": 1.0}
        moist = airdata.moist_air_density(**reference, vapour_fraction=settings.vapour_fraction)
        scale_squared = settings.calibration**2 * airdata.moist_air_density(**reference) / moist
        self._scale = sqrt(scale_squared)
        self._star = scale_squared * 2.0 * airdata.MOLAR_GAS_CONSTANT / airdata.MOLAR_MASS_DRY_AIR
        self._heating = 0.5 * (airdata.GAMMA - 1.0) / (airdata.GAMMA * airdata.GAS_CONSTANT_DRY_AIR * scale_squared)
        self._temperature_share = 0.5 * noise.temperature_sd
        self._wind_sd = settings.wind_sd
        self._t = self._t_total = self._t_static = -inf
        self._temperature = nan
        self._tare = self._tare_variance = 0.0
        self._taring = None if tare_window is None else _Tare(*tare_window, noise)

    @staticmethod
    def _channels(settings: EstimatorSettings, noise: NoiseModel) -> tuple[Channel, Channel]:
        q_total, q_static = process_noise(settings, noise)
        return RandomWalk(q_total, noise.total_sd**2), RandomWalk(q_static, noise.static_sd**2)

    def step(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head and say what is known after it.

        Parameters
        ----------
        t : float
            Time of the reading, s.
        p_total, p_static : float
            Pressures, Pa.
        temperature : float
            Of the air, K.
        t_total, t_static : float
            End of the conversions that the pressures come from, s. One that is not later than the channel's last
            brings no information and is not taken again.

        Returns
        -------
        tuple or None
            t, airspeed, airspeed_sd, airspeed_raw, p_total, p_static, valid, nis_total, nis_static, as `Estimate`;
            airspeed_raw is that of this reading alone, NaN where it lacks something; the pressures are the filtered
            ones, p_total tared; the last two are NaN where a channel has no new conversion. None if t is NaN or not
            later than the last.
        """
        if not t > self._t:
            return None
        self._t = t
        new_total, new_static = t_total > self._t_total, t_static > self._t_static
        if new_total:
            self._t_total = t_total
            self._total.add(p_total)
        if new_static:
            self._t_static = t_static
            self._static.add(p_static)
        if MIN_TEMPERATURE <= temperature <= MAX_TEMPERATURE:
            self._temperature = temperature
        else:
            temperature = nan
        measured = 0.0 < p_total < inf and 0.0 < p_static < inf
        covered = False
        if self._taring is not None:
            covered = t <= self._taring.end
            if covered:
                self._taring.add(t, p_total - p_static if measured else nan, new_total, new_static)
            else:
                self._tare, self._tare_variance = self._taring.result()
                self._taring = None

        tare = self._tare
        raw = self._scale * self._relation(p_total - tare, p_static, temperature) if measured else nan
        total, static = self._total.value - tare, self._static.value
        speed = self._scale * self._relation(total, static, self._temperature)
        nis_total, nis_static = self._total.nis if new_total else nan, self._static.nis if new_static else nan
        if covered or isnan(speed):
            return t, 0.0, self._wind_sd, raw, total, static, False, nis_total, nis_static
        sd, valid = self._spread(speed, total / static, static)
        return t, speed, sd, raw, total, static, valid, nis_total, nis_static

    def _spread(self, speed: float, ratio: float, static: float) -> tuple[float, bool]:
        """Return the airspeed's standard deviation and whether it is valid, by the law above."""
        temperature = self._temperature
        sigma = sqrt(self._total.variance + self._tare_variance + ratio * ratio * self._static.variance)
        star_squared = self._star * temperature * sigma / static
        star = sqrt(star_squared)
        if self._compressible and speed > 0.0:  # ρ/ρ₀ = (T_t/T)/(p_t/p_s)
            star_squared *= (1.0 + self._heating * speed * speed / temperature) / ratio
        floor = FLOOR * star
        at = speed if speed > floor else floor
        pressure_share = 0.5 * star_squared / at if at > 0.0 else 0.0  # at = 0 only without any noise
        temperature_share = self._temperature_share * speed / temperature
        sd = sqrt(pressure_share * pressure_share + temperature_share * temperature_share)
        if speed < star and sd > self._wind_sd:
            sd = self._wind_sd
        return sd, speed >= VALID * star


class FilterpyFilter(PaperFilter):
    """The same estimator with the Kalman filter of the filterpy package, two states and one reading at a time.

    It is tens of times slower; its use is to show that `RandomWalk` is the textbook's filter.
    """

    __slots__ = ()

    @staticmethod
    def _channels(settings: EstimatorSettings, noise: NoiseModel) -> tuple[Channel, Channel]:
        from filterpy.kalman import KalmanFilter

        both = KalmanFilter(dim_x=2, dim_z=1)
        q_total, q_static = process_noise(settings, noise)
        return (
            _FilterpyChannel(both, 0, q_total, noise.total_sd**2),
            _FilterpyChannel(both, 1, q_static, noise.static_sd**2),
        )


class _FilterpyChannel:
    """One state of a filterpy filter of two random walks."""

    __slots__ = ("_filter", "_h", "_index", "_q", "_r", "nis", "value", "variance")

    def __init__(self, both: Any, index: int, q: float, r: float) -> None:
        self._filter, self._index = both, index
        self._h = np.zeros((1, 2))
        self._h[0, index] = 1.0
        self._q = np.zeros((2, 2))
        self._q[index, index] = q
        self._r = np.array([[r]])
        self.value, self.variance, self.nis = nan, inf, nan

    def add(self, reading: float) -> None:
        both, index = self._filter, self._index
        missing = not 0.0 < reading < inf
        self.nis = nan
        if isnan(self.value):
            if missing:
                return
            both.x[index, 0] = reading
            both.P[index, index] = self._r[0, 0]
        else:
            both.predict(Q=self._q)
            if not missing:
                both.update(np.array([[reading]]), R=self._r, H=self._h)
                self.nis = float(both.y[0, 0] ** 2 / both.S[0, 0])
        self.value, self.variance = float(both.x[index, 0]), float(both.P[index, index])


def build(
    settings: EstimatorSettings, noise: NoiseModel, tare_window: tuple[float, float] | None = None
) -> PaperFilter:
    """Make the estimator of the given kind.

    Parameters
    ----------
    settings : EstimatorSettings
        What to build.
    noise : NoiseModel
        What it believes of its sensors.
    tare_window : tuple of float, optional
        When the pair is under its cover, s, as `PaperFilter`.

    Returns
    -------
    PaperFilter
        An estimator with `step`.
    """
    return (FilterpyFilter if settings.kind == "paper-filterpy" else PaperFilter)(settings, noise, tare_window)
