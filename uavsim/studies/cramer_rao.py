"""How well the airspeed can be known: the posterior Cramér-Rao bound of what the aided filter is given.

For any estimator of the state x_k from readings up to k the mean square error is at least J_k⁻¹, with the information

    J_{k+1} = D₂₂ − D₁₂ᵀ (J_k + D₁₁)⁻¹ D₁₂,    D₁₁ = E[Fᵀ Q⁻¹ F],  D₁₂ = −E[Fᵀ] Q⁻¹,  D₂₂ = Q⁻¹ + E[Hᵀ R⁻¹ H]

(Tichavský, Muravchik & Nehorai 1998, eqs. 22–26, additive Gaussian noise). E is the mean over the true courses of many
flights, never over estimates. The model is the filter's own, `onboard.airspeed.energy_model`, fed by accelerometer,
total and static pressure, temperature and the tare on the rail. There is no attitude. The turbulence is that which is
declared, with its floor.

The bound holds for the mean over flights, not for one of them. Where F differs between flights and Q is small, E[Fᵀ
Q⁻¹ F] credits the estimator with that difference: the bound is then lower than any filter gets, never higher.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.energy_model import (
    RAIL_SHARE,
    K,
    V,
    covariance_at_rest,
    process_noise,
    static_slopes,
    total_slopes,
    transition,
)
from uavsim.onboard.airspeed.gust import gust_density
from uavsim.onboard.airspeed.hand_over import AROUND
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

SIZE = 6  # states, as of `energy_model`
PARAMETER_WALK = 1e-3  # of k's standard deviation, 1/√s: Q must be regular
LEAST = 1e-6  # of the deviation of k and the walk of d, in their units, for the same reason


def filled(entries: Mapping[tuple[int, int], float | Array], matrix: Array) -> Array:
    """Put entries of the model into a matrix, shape (…, n, n), and return it."""
    for (i, j), value in entries.items():
        matrix[..., i, j] = value
    return matrix


class Information:
    """Fisher information on a state, with expectations over flights.

    Parameters
    ----------
    initial : ndarray
        Shape (n, n): J₀, the inverse of the covariance at the start.
    """

    def __init__(self, initial: Array) -> None:
        self.matrix: Array = np.array(initial, dtype=np.float64)

    def predict(self, transition: Array, noise: Array) -> None:
        """Go a step on.

        Parameters
        ----------
        transition : ndarray
            Shape (m, n, n): F on each of m true courses.
        noise : ndarray
            Shape (n, n): Q, regular.
        """
        inverse = np.linalg.inv(noise)
        mean = transition.mean(axis=0)
        d12 = -mean.T @ inverse
        d11 = (transition.transpose(0, 2, 1) @ inverse @ transition).mean(axis=0)
        j = inverse - d12.T @ np.linalg.solve(self.matrix + d11, d12)
        self.matrix = 0.5 * (j + j.T)

    def update(self, slopes: Array, variance: float) -> None:
        """Take a scalar reading.

        Parameters
        ----------
        slopes : ndarray
            Shape (m, n): H on each course.
        variance : float
            R.
        """
        self.matrix = np.asarray(self.matrix + slopes.T @ slopes / (len(slopes) * variance), dtype=np.float64)

    def covariance(self) -> Array:
        """Return the bound on the covariance, shape (n, n)."""
        return np.asarray(np.linalg.inv(self.matrix), dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Courses:
    """True courses of flights on common times.

    Attributes
    ----------
    t : ndarray
        Shape (n,), s, rising.
    airspeed, slope, static : ndarray
        Shape (m, n): V, m/s; g·sin γ, m/s²; p, Pa.
    force : ndarray
        Shape (m, n): specific force along body x above that at rest, m/s².
    temperature : float
        Of the air, K.
    """

    t: Array
    airspeed: Array
    slope: Array
    static: Array
    force: Array
    temperature: float

    def at(self, column: Array, t: float) -> Array:
        """Interpolate one of them to a time; shape (m,)."""
        i = min(max(int(np.searchsorted(self.t, t, side="right")) - 1, 0), self.t.size - 2)
        share = (t - self.t[i]) / (self.t[i + 1] - self.t[i])
        found: Array = column[:, i] + share * (column[:, i + 1] - column[:, i])
        return found

    def mean(self, column: Array, start: float, end: float) -> Array:
        """Mean over a stretch, by the values at its ends and at the samples between; shape (m,)."""
        i, j = np.searchsorted(self.t, (start, end))
        values = np.column_stack([self.at(column, start), column[:, i:j], self.at(column, end)])
        times = np.concatenate([[start], self.t[i:j], [end]])
        found: Array = (0.5 * (values[:, 1:] + values[:, :-1]) @ np.diff(times)) / (end - start)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Schedule:
    """When the filter is told what.

    Attributes
    ----------
    start : float
        Where the filter starts, s, at rest.
    told : ndarray
        Shape (r,): times of the readings of the head, s.
    total_end, static_end : ndarray
        Shape (r,): ends of the conversions that they carry, s.
    unfolding : float
        When the wings are commanded out, s.
    """

    start: float
    told: Array
    total_end: Array
    static_end: Array
    unfolding: float = np.inf


@dataclass(frozen=True, slots=True)
class Start:
    """What is known at the start.

    Attributes
    ----------
    rest_sd : float
        Of f_x at rest, m/s².
    tare_sd : float
        Of the pair's difference, Pa.
    speed_sd : float or None
        Of the airspeed, m/s; None: that of the wind by the estimator's settings.
    """

    rest_sd: float
    tare_sd: float
    speed_sd: float | None = None


class AirspeedBound:
    """The bound of one schedule over many courses.

    Parameters
    ----------
    courses, schedule : Courses, Schedule
        At least 50 courses make a mean that no single flight decides.
    settings, noise : EstimatorSettings, NoiseModel
        What is believed, which here is so.
    start : Start
    """

    def __init__(
        self, courses: Courses, schedule: Schedule, settings: EstimatorSettings, noise: NoiseModel, start: Start
    ) -> None:
        self._courses, self._schedule, self._noise = courses, schedule, noise
        self._aided = with_offset(settings.aided, noise.accelerometer_offset_sd)
        self._gas = GAS_CONSTANT_DRY_AIR * courses.temperature
        # temperature and position error are off by the same all the time: no reading tells
        self._share = 0.5 * float(np.hypot(noise.temperature_sd / courses.temperature, noise.head.position_sd))
        initial = covariance_at_rest(
            speed_sd=settings.wind_sd if start.speed_sd is None else start.speed_sd,
            bias_sd=self._aided.bias_sd,
            static_sd=AROUND,
            rest_sd=start.rest_sd,
            difference_sd=start.tare_sd,
            acceleration_sd=max(noise.acceleration_sd, LEAST),
        )
        self._initial = filled(initial, np.zeros((SIZE, SIZE)))
        self.time = schedule.start
        self._pushed = self._scaled = 0.0  # mean force now, m/s², and what its changes add to b's variance, m²/s⁴

    def sd(self) -> Array:
        """Return the least standard deviation of the airspeed at each time told, m/s; shape (r,).

        NaN throughout where the settings are so far from each other that floats cannot solve the equations.
        """
        with np.errstate(all="ignore"), suppress(np.linalg.LinAlgError):
            found = self._sd()
            if np.isfinite(found).all():
                return found
        return np.full(self._schedule.told.size, np.nan)

    def _sd(self) -> Array:
        self.information = Information(np.asarray(np.linalg.inv(self._initial), dtype=np.float64))
        total_age = 0.5 * self._noise.total_window + self._noise.total_lag
        static_age = 0.5 * self._noise.static_window + self._noise.static_lag
        last_total = last_static = -np.inf
        found = []
        schedule = self._schedule
        for told, total_end, static_end in zip(
            schedule.told.tolist(), schedule.total_end.tolist(), schedule.static_end.tolist(), strict=True
        ):
            if total_end > last_total and total_end - total_age > self.time:
                self._advance(total_end - total_age)
                if static_end > last_static and static_end - static_age > schedule.start:
                    self._static(static_end - static_age)
                    last_static = static_end
                self._total(total_end)
                last_total = total_end
            found.append(self._told(told))
        return np.array(found)

    # The information's own terms; the same as in `energy` and `aided`, on true courses.

    def _model(self, start: float, end: float) -> tuple[Array, Array]:
        """Return F, shape (m, 6, 6), and Q, shape (6, 6), from one time to the next."""
        c, aided, noise = self._courses, self._aided, self._noise
        dt, middle = end - start, 0.5 * (start + end)
        speed, slope, static = (c.at(column, middle) for column in (c.airspeed, c.slope, c.static))
        density = static / self._gas
        force = c.mean(c.force, start, end)
        railed = bool(np.mean(force) > aided.on_rail)
        keep, stay = (1.0, 1.0) if railed else (1.0 - dt / aided.bias_time, 1.0 - dt / aided.slope_time)
        f = filled(
            transition(slope, speed, density=density, dt=dt, keep=keep, stay=stay),
            np.tile(np.eye(SIZE), (len(speed), 1, 1)),
        )
        share = RAIL_SHARE if railed else 1.0
        height = (float(c.static[:, 0].mean()) - float(static.mean())) / (STANDARD_GRAVITY * float(density.mean()))
        variance = gust_density(aided, height) * float(np.mean(np.maximum(speed, SLOWEST))) * dt
        unfolding = self._schedule.unfolding
        meanwhile = max(0.0, min(end, unfolding + aided.unfolding_time) - max(start, unfolding))
        variance += aided.unfolding_rate**2 * meanwhile
        variance += noise.accelerometer_sd**2 / noise.accelerometer_rate * dt
        entries = process_noise(
            -float(np.mean(density * speed)) * dt,
            dt=dt,
            variance=variance,
            bias=share * 2.0 * aided.bias_sd**2 / aided.bias_time * dt + self._scaled,
            slope=share * aided.slope_rate**2 * dt,
            walk=aided.static_walk**2 * dt,
            drift=max(noise.walk, LEAST) ** 2 * dt,
        )
        entries[K, K] = (PARAMETER_WALK * max(noise.acceleration_sd, LEAST)) ** 2 * dt
        return f, filled(entries, np.zeros((SIZE, SIZE)))

    def _advance(self, to: float) -> None:
        self.information.predict(*self._model(self.time, to))
        self.time, self._scaled = to, 0.0

    def _static(self, at: float) -> None:
        c = self._courses
        ahead = c.at(c.static, self.time) / self._gas * c.at(c.airspeed, self.time) * (self.time - at)
        self._take(static_slopes(ahead), self._noise.static_sd)

    def _total(self, end: float) -> None:
        c, noise = self._courses, self._noise
        speed, static = c.at(c.airspeed, self.time), c.at(c.static, self.time)
        window = noise.total_window or 1.0 / noise.accelerometer_rate
        push = c.mean(c.force, end - noise.total_lag - window, end - noise.total_lag)
        pushed = float(np.mean(push))
        self._scaled = noise.accelerometer_scale_sd**2 * abs(pushed**2 - self._pushed**2)
        self._pushed = pushed
        relative = 1.0 if noise.differential else 0.0
        slopes = total_slopes(speed, static, pushed=push, heat=SEVEN_R * c.temperature, relative=relative)
        self._take(slopes, noise.total_sd)

    def _take(self, slopes: Mapping[int, float | Array], sd: float) -> None:
        row = np.zeros((len(self._courses.airspeed), SIZE))
        for state, slope in slopes.items():
            row[:, state] = slope
        self.information.update(row, sd**2)

    def _told(self, t: float) -> float:
        """Least standard deviation at the time of a reading, later than the filter's own by the lag."""
        ahead = self.information
        if t > self.time:
            ahead = Information(self.information.matrix)
            ahead.predict(*self._model(self.time, t))
        variance = float(ahead.covariance()[V, V])
        speed = self._courses.at(self._courses.airspeed, t)
        return float(np.sqrt(variance + self._share**2 * np.mean(speed**2)))
