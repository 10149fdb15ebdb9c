"""How well the airspeed can be known: the posterior Cramér-Rao bound of what the aided filter is given.

For any estimator of the state x_k from readings up to k the mean square error is at least J_k⁻¹, with the information

    J_{k+1} = D₂₂ − D₁₂ᵀ (J_k + D₁₁)⁻¹ D₁₂,    D₁₁ = E[Fᵀ Q⁻¹ F],  D₁₂ = −E[Fᵀ] Q⁻¹,  D₂₂ = Q⁻¹ + E[Hᵀ R⁻¹ H]

(Tichavský, Muravchik & Nehorai 1998, eqs. 22–26, additive Gaussian noise). E is the mean over the true courses of many
flights, never over estimates. The model is the filter's own, `onboard.airspeed.energy_model`, fed by accelerometer,
total and static pressure, temperature and the tare on the rail. There is no attitude. The turbulence is that which is
declared, with its floor.

**Constants of a flight.** Three more states do not change; what a description says of them, and the readings, is all
that is known:

    m    share of V by which the pressures' airspeed is off:  p_t = p [(1 + V²(1 + m)²/(7 R T))^(7/2) − r] + …
         σ_m² = (½ σ_T/T)² + (½ σ_p/p)² + (½ σ_κ)²    thermometer; offset of both pressures; scale of a differential one
    c    what a calibration has left of the static port's position error:  p_s = p + c q_c, q_c the impact pressure
    w    the wind across the rail: until the push ends V = √(u² + w²), u being the speed along the rail, which the force
         changes; then the path turns into the wind

m and c are seen by the force alone, in the stroke, as well as the accelerometer's scale is known: mostly not at all. In
flight the bound on V cannot be below ½ σ_c V and σ_m V together. The wind on the rail is known as it is declared. The
pair's mean difference at rest is d + P(u₀, w), P being what the wind makes of both ports. After a covered tare, d is
known, and this tells of the wind. After an open one, or none, it tells d, as well as the wind is known, ½ ρ w² and its
error; the push then tells u₀, not w.

**Angles** that no vane tells put the static port off by e q_c. e has the standard deviation that the filter believes
(`flow_angles`), and wanders within the time in which an aircraft swings into the wind, ė = −e/τ + noise. How the wind
grows in a climb is noise of V, as for the filter. Left out, so that the bound is rather too low, is the recovery factor
of the thermometer.

**Whose bound.** It is one of the mean over flights that are drawn as is believed. Of what is believed but not drawn, as
the error of a declared wind where the scenario's is declared exactly, flights may be better than the bound.

The bound holds for the mean over flights, not for one of them. Where F differs between flights and Q is small, E[Fᵀ
Q⁻¹ F] credits the estimator with that difference: the bound is then lower than any filter gets, never higher.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.energy_model import (
    RAIL_SHARE,
    D,
    K,
    V,
    covariance_at_rest,
    process_noise,
    static_slopes,
    total_slopes,
    transition,
)
from uavsim.onboard.airspeed.flow_angles import SWING, FlowAngles
from uavsim.onboard.airspeed.gust import gust_density, shear_density
from uavsim.onboard.airspeed.hand_over import AROUND
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

SHARE, POSITION, ACROSS, ANGLE = 6, 7, 8, 9  # m, c, w and e, beside the six states of `energy_model`
SIZE = 10
PARAMETER_WALK = 1e-3  # of a constant's standard deviation, 1/√s: Q must be regular
LEAST = 1e-6  # of the deviation of k and the walk of d, in their units, for the same reason
LEAST_WIND = 1e-3  # m/s, of w
SMALL = 0.05  # m/s, of the differences by which what both ports read on the rail is derived


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
    along : ndarray or None
        Shape (m, n): the air's speed along body x, m/s, which counts on the rail; None: the airspeed.
    """

    t: Array
    airspeed: Array
    slope: Array
    static: Array
    force: Array
    temperature: float
    along: Array | None = None

    def wind(self, t: float) -> tuple[Array, Array]:
        """The air's speed along and across body x at a time; shape (m,) each."""
        speed = self.at(self.airspeed, t)
        if self.along is None:
            return speed, np.zeros_like(speed)
        along = self.at(self.along, t)
        return along, np.sqrt(np.maximum(speed**2 - along**2, 0.0))

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
        Of the pair's difference by what tared it without wind, or by the parts' descriptions, Pa.
    speed_sd : float or None
        Of the airspeed, m/s; None: that of the wind by the estimator's settings. Of a declared wind that of either
        component.
    seen_sd : float or None
        Noise of the pair's mean difference at rest in a wind that is declared, Pa; None: none is.
    """

    rest_sd: float
    tare_sd: float
    speed_sd: float | None = None
    seen_sd: float | None = None


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
        self._heat = SEVEN_R * courses.temperature
        speed_sd = settings.wind_sd if start.speed_sd is None else start.speed_sd
        self._start = start
        self._share_sd, self._position_sd = share_sd(noise, courses), noise.head.position_sd
        self._angles = FlowAngles(settings.aided)
        initial = covariance_at_rest(
            speed_sd=speed_sd,
            bias_sd=self._aided.bias_sd,
            static_sd=AROUND,
            rest_sd=start.rest_sd,
            difference_sd=start.tare_sd,
            acceleration_sd=max(noise.acceleration_sd, LEAST),
        )
        self._initial = filled(initial, np.zeros((SIZE, SIZE)))
        for state in (SHARE, POSITION, ANGLE):  # in their standard deviations
            self._initial[state, state] = 1.0
        self._initial[ACROSS, ACROSS] = max(speed_sd if start.seen_sd is not None else 0.0, LEAST_WIND) ** 2
        self._railed = start.seen_sd is not None  # V stands for u, until the push has ended
        self._pushing = False
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
        if self._start.seen_sd is not None:
            along, across, _ = self._rail_slopes(self._schedule.start, relative=1.0)
            self._take({V: along, ACROSS: across, D: 1.0}, self._start.seen_sd)
        total_age, static_age = self._noise.total_age, self._noise.static_age
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
        f[:, ANGLE, ANGLE] = 1.0 - dt / SWING
        share = RAIL_SHARE if railed else 1.0
        height = (float(c.static[:, 0].mean()) - float(static.mean())) / (STANDARD_GRAVITY * float(density.mean()))
        density_of_gusts = gust_density(aided, height) + shear_density(aided, height, float(np.mean(slope)))
        variance = gust = density_of_gusts * float(np.mean(np.maximum(speed, SLOWEST))) * dt
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
        entries[SHARE, SHARE] = entries[POSITION, POSITION] = PARAMETER_WALK**2 * dt
        entries[ANGLE, ANGLE] = 2.0 * dt / SWING
        # gusts are across the rail, too
        entries[ACROSS, ACROSS] = gust if self._railed else (PARAMETER_WALK * LEAST_WIND) ** 2 * dt
        return f, filled(entries, np.zeros((SIZE, SIZE)))

    def _advance(self, to: float) -> None:
        self._predict(*self._model(self.time, to))
        if self._railed:
            pushed = float(np.mean(self._courses.mean(self._courses.force, self.time, to))) > self._aided.on_rail
            if self._pushing and not pushed:
                self._leave_rail(to)
            self._pushing = pushed
        self.time, self._scaled = to, 0.0

    def _predict(self, f: Array, noise: Array) -> None:
        self.information.predict(f, noise)

    def _leave_rail(self, t: float) -> None:
        """Turn u and w into V and what is across it, by the angle of the mean course."""
        self._railed = False
        along, across = (float(np.mean(one)) for one in self._courses.wind(t))
        speed = float(np.hypot(along, across))
        if speed > SLOWEST:
            across_share = np.hypot(self._aided.rail_wind_side, self._aided.rail_wind_down)
            side = self._aided.rail_wind_side / max(float(across_share), LEAST)
            self._angles.leave(t, across / speed * side)
            turn = np.eye(SIZE)
            turn[V, V] = turn[ACROSS, ACROSS] = along / speed
            turn[V, ACROSS], turn[ACROSS, V] = across / speed, -across / speed
            self._turn(turn)

    def _turn(self, turn: Array) -> None:
        """Take other coordinates of the state, an orthogonal matrix times these."""
        self.information.matrix = turn @ self.information.matrix @ turn.T

    def _impact(self, speed: Array, static: Array) -> Array:
        found: Array = static * ((1.0 + speed**2 / self._heat) ** 3.5 - 1.0)
        return found

    def _rail_slopes(self, t: float, relative: float) -> tuple[Array, Array, Array]:
        """Derivatives by u and w of what the total port reads above the static one, or above p, and q_c itself."""
        c, aided, head = self._courses, self._aided, self._noise.head
        side, below = aided.rail_wind_side, aided.rail_wind_down
        share = side / max(float(np.hypot(side, below)), LEAST)
        static = c.at(c.static, t)

        def read(u: Array, w: Array) -> Array:
            speed = np.maximum(np.hypot(u, w), SMALL)
            x, y = u / speed, w / speed
            shares = [
                head.shares(a, b * share, b * float(np.sqrt(1.0 - share**2)), 5.0 * float(v) ** 2 / self._heat)
                for a, b, v in zip(x.tolist(), y.tolist(), speed.tolist(), strict=True)
            ]
            found: Array = self._impact(speed, static) * np.array([one - relative * other for one, other in shares])
            return found

        u, w = c.wind(t)
        felt = read(u, w)
        return (
            (read(u + SMALL, w) - felt) / SMALL,
            (read(u, w + SMALL) - felt) / SMALL,
            self._impact(c.at(c.airspeed, t), static),
        )

    def _static(self, at: float) -> None:
        c = self._courses
        speed, static = c.at(c.airspeed, self.time), c.at(c.static, self.time)
        ahead = static / self._gas * speed * (self.time - at)
        slopes = {**static_slopes(ahead), **self._port(speed, static)}
        self._take(slopes, self._noise.static_sd)

    def _port(self, speed: Array, static: Array) -> dict[int, Array]:
        """Derivatives of what the static port reads, by c and e, in their standard deviations."""
        impact = self._impact(speed, static)
        unseen = self._unseen(self.time, float(np.mean(speed)), float(np.mean(static)))
        return {POSITION: impact * self._position_sd, ANGLE: impact * unseen}

    def _unseen(self, t: float, speed: float, static: float) -> float:
        """Return what angles put the static port off by, a share of q_c: one standard deviation."""
        if self._railed:
            return 0.0
        angles, density = self._angles, static / self._gas
        if t > self._schedule.unfolding + self._aided.unfolding_time:
            angles.lift = STANDARD_GRAVITY
        head = replace(self._noise.head, position_sd=0.0)
        return head.spread(*angles.side(t, speed), *angles.down(speed, density))

    def _total(self, end: float) -> None:
        c, noise = self._courses, self._noise
        speed, static = c.at(c.airspeed, self.time), c.at(c.static, self.time)
        window = noise.total_window or 1.0 / noise.accelerometer_rate
        push = c.mean(c.force, end - noise.total_lag - window, end - noise.total_lag)
        pushed = float(np.mean(push))
        self._scaled = noise.accelerometer_scale_sd**2 * abs(pushed**2 - self._pushed**2)
        self._pushed = pushed
        relative = 1.0 if noise.differential else 0.0
        slopes = total_slopes(speed, static, pushed=push, heat=self._heat, relative=relative)
        slopes[SHARE] = slopes[V] * speed * self._share_sd
        if relative:
            slopes |= {state: -slope for state, slope in self._port(speed, static).items()}
        if self._railed:
            slopes[V], slopes[ACROSS], _ = self._rail_slopes(self.time, relative)
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
        covariance = ahead.covariance()
        return float(np.sqrt(self._of_speed(covariance, t)))

    def _of_speed(self, covariance: Array, t: float) -> Array:
        """Variance of the airspeed by covariances of the state, shape (…, n, n)."""
        if not self._railed:
            return np.asarray(covariance[..., V, V])
        along, across = (float(np.mean(one)) for one in self._courses.wind(t))
        speed = max(float(np.hypot(along, across)), SMALL)
        x, y = along / speed, across / speed
        return np.asarray(
            x * x * covariance[..., V, V]
            + 2.0 * x * y * covariance[..., V, ACROSS]
            + y * y * covariance[..., ACROSS, ACROSS]
        )


def share_sd(noise: NoiseModel, courses: Courses) -> float:
    """Return σ_m, the share of the airspeed that the pressures are off by throughout a flight."""
    pressure = float(courses.static[:, 0].mean())
    parts = noise.temperature_sd / courses.temperature, noise.static_offset_sd / pressure, noise.difference_scale_sd
    return 0.5 * hypot(*parts)
