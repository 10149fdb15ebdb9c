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

Of a differential sensor (`difference`) the total channel is Δp = p_t − p_s itself, filtered alike; p_t is the filtered
static pressure and Δp together, and of the static sensor's noise only the share of p_s in the density is left,
(p_t/p_s − 1)² P_s below. A scale error σ_k of Δp adds V·σ_k/2.

Compressibility changes the slope, not the law: for the isentropic relation dV/dp_t = 1/(ρ₀·V) with the stagnation
density ρ₀ = ρ·(p_t/p_s)^(1/γ), and for either relation dV/dp_s = −(p_t/p_s)·dV/dp_t, which holds the share of p_s in
the density. Temperature adds dV/dT = V/(2T). So, with τ² the variance of the tare,

    σ² = P_t + τ² + (p_t/p_s)²·P_s,        σ_V² = [V*²/(2·max(V, 0.8·V*))·ρ/ρ₀]² + [V·σ_T/(2T)]²
"""

from collections.abc import Callable
from math import inf, isnan, nan, sqrt

from uavsim import airdata
from uavsim.onboard.airspeed.difference import Difference
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.measured import limits
from uavsim.onboard.airspeed.random_walk import Channel, RandomWalk, process_noise
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.airspeed.tare import Tare
from uavsim.onboard.interface import Estimate, Estimator
from uavsim.onboard.plausible import FASTEST, LEAST_PRESSURE, MOST_PRESSURE
from uavsim.onboard.stamps import Conversions, Stamps, jump

FLOOR = 0.8  # V*; below it the linear law would exceed the rms error of the clipped root
# Mach number beyond which no airspeed is valid: the relation of the pressures holds to Mach 1, but from here on shocks
# stand about a probe and its static holes. By hand, within the usual 0.9 … 0.98
TRANSONIC = 0.95
VALID = 2.0  # V*; from here on the airspeed is called valid


@one_of_ours("paper")
class PaperFilter(Estimator):
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
    A reading that is NaN, implausible or at the end of the part's range is missing; in the last case no airspeed is
    valid. A missing pressure lets that channel's variance grow; a missing
    temperature leaves the last one in use. Without a reading in its window the tare is 0. After a step of the clock
    both filters begin anew. Filtered pressures that are implausible have no airspeed, and an airspeed above
    `EstimatorSettings.fastest` is not valid.
    """

    __slots__ = (
        "_clipped",
        "_coldest",
        "_compressible",
        "_cover",
        "_difference",
        "_fastest",
        "_heating",
        "_law_ends",
        "_position",
        "_relation",
        "_relative",
        "_scale",
        "_scale_share",
        "_stamps",
        "_star",
        "_static",
        "_static_ends",
        "_static_within",
        "_t",
        "_tare",
        "_tare_variance",
        "_taring",
        "_temperature",
        "_temperature_share",
        "_total",
        "_total_ends",
        "_total_within",
        "_warmest",
        "_wind_sd",
        "lightness",
    )

    def __init__(
        self, settings: EstimatorSettings, noise: NoiseModel, tare_window: tuple[float, float] | None = None
    ) -> None:
        self._total, self._static = self._channels(settings, noise)
        self._difference, self._relative = Difference(noise.differential), 1.0 if noise.differential else 0.0
        self._scale_share = 0.5 * noise.difference_scale_sd
        self._compressible = settings.model == "compressible"
        self._relation: Callable[[float, float, float], float] = (
            airdata.compressible_airspeed if self._compressible else airdata.bernoulli_airspeed
        )
        # Airspeed over that of dry air with K = 1; the lighter moist air is faster for the same pressures.
        reference = {"pressure": 101_325.0, "temperature": 288.15, "compressibility": 1.0}
        moist = airdata.moist_air_density(**reference, vapour_fraction=settings.vapour_fraction or 0.0)
        self.lightness = airdata.moist_air_density(**reference) / moist
        scale_squared = settings.calibration**2 * self.lightness
        self._scale = sqrt(scale_squared)
        self._star = scale_squared * 2.0 * airdata.MOLAR_GAS_CONSTANT / airdata.MOLAR_MASS_DRY_AIR
        self._heating = 0.5 * (airdata.GAMMA - 1.0) / (airdata.GAMMA * airdata.GAS_CONSTANT_DRY_AIR * scale_squared)
        self._temperature_share = 0.5 * noise.temperature_sd
        self._wind_sd = settings.wind_sd
        self._fastest = FASTEST if settings.fastest is None else settings.fastest
        self._total_within, self._static_within, (self._coldest, self._warmest) = limits(noise)
        self._clipped = False
        self._position = noise.head.error / (1.0 - noise.head.error)
        self._law_ends = TRANSONIC**2 * airdata.GAMMA * airdata.GAS_CONSTANT_DRY_AIR * scale_squared
        self._t = -inf
        longest = jump(noise.head_rate)
        self._stamps, self._total_ends, self._static_ends = Stamps(longest), Conversions(longest), Conversions(longest)
        self._temperature = nan
        self._tare = self._tare_variance = 0.0
        self._taring = None if tare_window is None else Tare(*tare_window, noise)
        self._cover: Tare | None = None  # that a step of the clock has perhaps ended before its time

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
            brings no information and is not taken again; see `uavsim.onboard.stamps`.

        Returns
        -------
        tuple or None
            t, airspeed, airspeed_sd, airspeed_raw, p_total, p_static, valid, nis_total, nis_static, as `Estimate`;
            airspeed_raw is that of this reading alone, NaN where it lacks something; the pressures are the filtered
            ones, p_total tared; the last two are NaN where a channel has no new conversion. None if the reading is
            left out for its time stamp.
        """
        if not 0.0 < t - self._t <= self._stamps.longest:
            if not self._stamps.admit(t, self._t):
                return None
            if self._t > -inf:
                self._begin_anew(t)
        self._t = t
        end_total, end_static = self._total_ends.new(t_total, t), self._static_ends.new(t_static, t)
        new_total, new_static = end_total == end_total, end_static == end_static  # not NaN
        reading = self._difference.read(p_total, p_static)
        reading, clipped = _measured(reading, *self._total_within)
        if reading != reading:
            p_total = nan
        p_static, clipped_too = _measured(p_static, *self._static_within)
        self._clipped = clipped or clipped_too
        if new_total:
            self._total.add(reading)
        if new_static:
            self._static.add(p_static)
        if self._coldest <= temperature <= self._warmest:
            self._temperature = temperature
        else:
            temperature = nan
        measured = p_total == p_total and p_static == p_static
        covered = self._taring is not None and self._tared(t, p_total - p_static, new_total, new_static)

        tare = self._tare
        below = self._position * (p_total - tare - p_static)
        raw = self._scale * self._relation(p_total - tare, p_static - below, temperature) if measured else nan
        total, static = self._total.value - tare, self._static.value
        if self._relative:
            total += static - self._difference.zero
        if self._position:  # the static port's share is taken off, at any airspeed the same
            static -= self._position * (total - static)
        known = LEAST_PRESSURE <= static <= MOST_PRESSURE
        speed = self._scale * self._relation(total, static, self._temperature) if known else nan
        nis_total, nis_static = self._total.nis if new_total else nan, self._static.nis if new_static else nan
        if covered or isnan(speed):
            return t, 0.0, self._wind_sd, raw, total, static, False, nis_total, nis_static
        sd, valid = self._spread(speed, total / static, static)
        return t, speed, sd, raw, total, static, valid and not self._clipped, nis_total, nis_static

    def _tared(self, t: float, difference: float, new_total: bool, new_static: bool) -> bool:
        """Take the difference of a reading into the tare, Pa, or end it; return whether the head is covered."""
        taring = self._taring
        assert taring is not None
        if t <= taring.end:
            taring.add(t, difference, new_total, new_static)
            return True
        self._tare, self._tare_variance = taring.result()
        self._taring = None
        return False

    def _spread(self, speed: float, ratio: float, static: float) -> tuple[float, bool]:
        """Return the airspeed's standard deviation and whether it is valid, by the law above."""
        temperature = self._temperature
        share = ratio - self._relative
        sigma = sqrt(self._total.variance + self._tare_variance + share * share * self._static.variance)
        star_squared = self._star * temperature * sigma / static
        star = sqrt(star_squared)
        if self._compressible and speed > 0.0:  # ρ/ρ₀ = (T_t/T)/(p_t/p_s)
            star_squared *= (1.0 + self._heating * speed * speed / temperature) / ratio
        floor = FLOOR * star
        at = speed if speed > floor else floor
        pressure_share = 0.5 * star_squared / at if at > 0.0 else 0.0  # at = 0 only without any noise
        temperature_share = self._temperature_share * speed / temperature
        scale_share = self._scale_share * speed
        sd = sqrt(pressure_share * pressure_share + temperature_share * temperature_share + scale_share * scale_share)
        if speed < star and sd > self._wind_sd:
            sd = self._wind_sd
        subsonic = speed * speed <= self._law_ends * temperature
        return sd, VALID * star <= speed <= self._fastest and subsonic

    def restart(self) -> None:
        """Know nothing of the pressures, but their tare."""
        self.forget_time()
        self._total.restart()
        self._static.restart()

    def resume(self, total: float, static: float, reach: float) -> None:
        """Go on after a pause in which others have read both channels: anew, unless both are within `reach`, Pa."""
        if abs(total - self._total.value) <= reach and abs(static - self._static.value) <= reach:
            self.forget_time()
        else:
            self.restart()

    def forget_time(self) -> None:
        """Take the next reading whatever its time stamp, if that is one."""
        self._t = -inf
        self._total_ends.forget()
        self._static_ends.forget()

    def _begin_anew(self, t: float) -> None:
        """After a step of the clock the pressures may be any."""
        self.restart()
        if self._taring is not None:
            self._cover = self._taring
        elif self._cover is not None and t <= self._cover.end:
            self._taring = self._cover

    @property
    def static(self) -> Channel:
        """The filter of the static pressure."""
        return self._static

    @property
    def temperature(self) -> float:
        """Last temperature measured, K; NaN before."""
        return self._temperature

    @property
    def scale(self) -> float:
        """Airspeed over that of dry air with K = 1."""
        return self._scale

    def tare(self) -> tuple[float, float]:
        """Return the pair's tare, Pa, and its variance, Pa², by now."""
        return (self._tare, self._tare_variance) if self._taring is None else self._taring.result()


def _measured(pressure: float, low: float, high: float) -> tuple[float, bool]:
    """Return a pressure, NaN where it is none, and whether it has been clipped at an end of the range, Pa."""
    if low < pressure < high:
        return pressure, False
    return nan, LEAST_PRESSURE <= pressure <= MOST_PRESSURE
