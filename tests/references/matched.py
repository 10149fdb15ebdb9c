"""Flights drawn from the aided filter's own model: whether the filter reaches the bound and knows its own error.

Every run draws bias, wind, gust, climb, tare and noise as `onboard.airspeed.energy_model` has them,

    V̇ = f_x − b − s + gust,    ṗ = −ρ V s,    ḃ = −b/τ_b + noise,    ṡ = −s/τ_s + noise

in steps of a millisecond, 0.3 s of 8.9 g to 24 m/s, a climb that levels off, cruise at 30 m/s. A loop on the true
airspeed holds it near that course; its specific force is what the accelerometer reads, noise added, so that no filter
learns more from it than the model says. Readings are those of named parts in named modes, each of the instant at the
middle of its conversion. The filter gets them through its whole life: rest, tare, a launch recognised 40 ms late,
replay.

Here theory and filter must agree, so the figures measure the filter, not the aircraft; what the real flow adds is
measured in flight.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import copysign, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from uavsim.airdata import GAS_CONSTANT_DRY_AIR, STANDARD_PRESSURE, STANDARD_TEMPERATURE
from uavsim.consistency import Consistency, judge
from uavsim.onboard.airspeed import AidedFilter, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.energy_model import RAIL_SHARE, step, total_pressure
from uavsim.onboard.airspeed.frozen import TURNED
from uavsim.onboard.airspeed.rest_force import WANDER
from uavsim.studies.cramer_rao import AirspeedBound, Courses, Schedule, Start

Array = NDArray[np.float64]

STEP = 1e-3  # s
REST = 2.2  # s at rest before the launch, tare included
COVERED = (0.2, 1.2)  # s, the tare
PEAK, RISE, STROKE = 8.9 * 9.80665, 0.025, 0.300  # m/s², s, s: a trapezoid to 24 m/s
CRUISE, THRUST, HOLD = 30.0, 1.5, 0.5  # m/s, m/s², 1/s: after the rail, and how stiffly it is held
REST_FORCE = 2.5  # m/s², g·sin 15°
LATENCY = 0.040  # s after the launch at which it is recognised


@dataclass(frozen=True, slots=True)
class Mode:
    """A pair of pressure sensors in a named mode: noise, Pa, conversions a second, their length, s."""

    noise: float
    rate: float
    window: float


MODES = {
    "bmp390 x2": Mode(2.7, 100.0, 6.84e-3),
    "ms5611 x4096": Mode(1.2, 110.0, 8.22e-3),  # a temperature after every tenth pressure
    "bmp581 x4": Mode(0.41, 255.0, 2.9e-3),
}
"""Noise a conversion and typical conversion time by the parts' datasheets, as in the presets."""


@dataclass(frozen=True, slots=True)
class MatchedSettings:
    """An ensemble of matched flights.

    Attributes
    ----------
    mode : Mode
    estimator : EstimatorSettings
        What the filter believes, and what is so.
    duration : float
        From the launch on, s.
    runs, seed : int
    acceleration_sd : float
        Standard deviation of the pair's pressure error per specific force, Pa/(m/s²).
    """

    mode: Mode = MODES["ms5611 x4096"]
    estimator: EstimatorSettings = field(default_factory=lambda: EstimatorSettings(kind="aided", wind_sd=1.0))
    duration: float = 20.0
    runs: int = 100
    seed: int = 1
    acceleration_sd: float = 0.06

    def believed(self) -> EstimatorSettings:
        """Return what the filter believes: b wanders as the model has it, and its turbulence is there."""
        aided = self.estimator.aided
        rate = aided.bias_sd * sqrt(2.0 / aided.bias_time) / TURNED
        sd = max(aided.gust_sd, aided.gust_floor)
        return replace(self.estimator, aided=replace(aided, bias_rate=rate, gust_sd=sd, gust_floor=0.9 * sd))

    def noise(self) -> NoiseModel:
        """Return what the filter believes of the sensors."""
        m = self.mode
        return NoiseModel(
            total_sd=m.noise,
            static_sd=m.noise,
            temperature_sd=0.0,
            total_window=m.window,
            static_window=m.window,
            acceleration_sd=self.acceleration_sd,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """True courses and readings of an ensemble; times from switching on, the launch at `REST`.

    Attributes
    ----------
    courses : Courses
    schedule : Schedule
        Of all rows; `start` is where the filter will start.
    force_read : ndarray
        Shape (m, n), m/s².
    total, static : ndarray
        Shape (m, r), Pa.
    """

    courses: Courses
    schedule: Schedule
    force_read: Array
    total: Array
    static: Array


def draw(settings: MatchedSettings) -> Drawn:
    """Draw an ensemble; `settings.seed` fixes every bit."""
    generator = np.random.default_rng(settings.seed)
    noise = settings.noise()
    t: Array = STEP * np.arange(round((REST + settings.duration) / STEP) + 1, dtype=np.float64)
    start = REST + LATENCY - settings.estimator.aided.replay
    speed, slope, static, force, read = _fly(settings, noise, t, start, generator)
    courses = Courses(t, speed, slope, static, force, STANDARD_TEMPERATURE)
    rate, window = settings.mode.rate, settings.mode.window
    told = np.arange(np.ceil(2 * window * rate) + 1, t[-1] * rate) / rate
    ages = generator.uniform(0.0, 1.0 / rate, 2)  # of the conversions when polled
    schedule = Schedule(start, told, told - ages[0], told - ages[1])
    total_at = schedule.total_end - 0.5 * window
    shape = (settings.runs, told.size)
    v, p_t, p_s = (
        _at(t, speed, total_at), _at(t, static, total_at), _at(t, static, schedule.static_end - 0.5 * window),
    )  # fmt: skip
    v[:, total_at <= COVERED[1]] = 0.0
    pressed = np.column_stack([courses.mean(force, end - window, end) for end in schedule.total_end.tolist()])
    k = settings.acceleration_sd * generator.standard_normal((settings.runs, 1))
    walk = np.cumsum(noise.walk / sqrt(rate) * generator.standard_normal(shape), axis=1)
    total = total_pressure(v, p_t, walk, k, pushed=pressed, heat=SEVEN_R * STANDARD_TEMPERATURE)
    total += 30.0 + settings.mode.noise * generator.standard_normal(shape)
    return Drawn(courses, schedule, read, total, p_s + settings.mode.noise * generator.standard_normal(shape))


def _at(t: Array, column: Array, times: Array) -> Array:
    i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, t.size - 2)
    share = (times - t[i]) / (t[i + 1] - t[i])
    found: Array = column[:, i] + share * (column[:, i + 1] - column[:, i])
    return found


def _push(t: float) -> float:
    """Specific force of the catapult, m/s²."""
    return PEAK * min(1.0, max(0.0, min(t - REST, REST + STROKE - t) / RISE))


def _fly(
    settings: MatchedSettings, noise: NoiseModel, t: Array, start: float, generator: np.random.Generator
) -> tuple[Array, Array, Array, Array, Array]:
    """Return airspeed, slope, static pressure, force above that at rest, and its reading; shape (m, n) each."""
    m, aided = settings.runs, settings.estimator.aided
    bias = aided.bias_sd * generator.standard_normal(m)
    slope = REST_FORCE - bias
    bias = bias + WANDER * generator.standard_normal(m)  # since the tare of the accelerometer
    v = settings.estimator.wind_sd * generator.standard_normal(m)
    p = np.full(m, STANDARD_PRESSURE)
    gust = 2.0 * max(aided.gust_sd, aided.gust_floor) ** 2 / aided.gust_length * STEP
    gas = GAS_CONSTANT_DRY_AIR * STANDARD_TEMPERATURE
    speeds, slopes, statics, forces = (np.empty((m, t.size)) for _ in range(4))
    reads = noise.accelerometer_sd * generator.standard_normal((m, t.size))
    nominal = 0.0
    for n, now in enumerate(t.tolist()):
        push, later = _push(now), _push(now + STEP)
        flown = now >= REST + STROKE
        command = push if not flown else min(THRUST, CRUISE - nominal)
        f = command + bias + slope + (HOLD * (nominal - v) if flown else 0.0)
        speeds[:, n], slopes[:, n], statics[:, n], forces[:, n] = v, slope, p, f - REST_FORCE
        reads[:, n] += f
        if now < start:
            continue
        railed = push > aided.on_rail
        w = generator.standard_normal((4, m))
        gained = STEP * f + 0.5 * STEP * (later - push)  # of the push the trapezoid
        variance = gust * np.maximum(v, SLOWEST)
        share = RAIL_SHARE if railed else 1.0
        wander = share * 2.0 * STEP / aided.bias_time * aided.bias_sd**2
        wander += noise.accelerometer_scale_sd**2 * abs(later**2 - push**2)
        keep, stay = (1.0, 1.0) if railed else (1.0 - STEP / aided.bias_time, 1.0 - STEP / aided.slope_time)
        v, bias, p, slope = step(v, bias, p, slope, dt=STEP, gained=gained, density=p / gas, keep=keep, stay=stay)
        p = p + aided.static_walk * sqrt(STEP) * w[0]
        v = v + np.sqrt(variance) * w[1]
        nominal += STEP * command
        bias = bias + sqrt(wander) * w[2]
        slope = slope + sqrt(share * STEP) * aided.slope_rate * w[3]
    return speeds, slopes, statics, forces, reads


@dataclass(frozen=True, slots=True, eq=False)
class Matched:
    """What the filter made of an ensemble, at the times told from the launch's recognition on.

    Attributes
    ----------
    t : ndarray
        Shape (r,), s after the launch.
    error, sd : ndarray
        Shape (m, r): airspeed less the true one, and what is claimed, m/s.
    raw_error : ndarray
        Shape (m, r): of the raw airspeed.
    nis : ndarray
        Shape (m, r, 2): normalised innovations squared of total and static pressure.
    innovation : ndarray
        Shape (m, r): innovations of the total pressure over their standard deviation.
    bound : ndarray
        Shape (r,): the least standard deviation that the information allows, m/s.
    """

    t: Array
    error: Array
    sd: Array
    raw_error: Array
    nis: Array
    innovation: Array
    bound: Array

    def rmse(self) -> Array:
        """Root mean square error over the runs, shape (r,), m/s."""
        found: Array = np.sqrt(np.mean(self.error**2, axis=0))
        return found

    def consistency(self, start: float, end: float) -> Consistency:
        """Judge the filter's own claims from `start` to `end`, s after the launch."""
        part = (self.t >= start) & (self.t <= end)
        return judge(self.error[:, part], self.sd[:, part], self.nis[:, part], self.innovation[:, part])

    def ratio(self, start: float, end: float) -> float:
        """RMSE over the bound's root mean square, from `start` to `end`, s after the launch."""
        part = (self.t >= start) & (self.t <= end)
        return float(np.sqrt(np.mean(self.error[:, part] ** 2) / np.mean(self.bound[part] ** 2)))


def run(
    settings: MatchedSettings,
    drawn: Drawn | None = None,
    told: Callable[[float], None] | None = None,
    kind: type[AidedFilter] = AidedFilter,
) -> Matched:
    """Fly the filter through an ensemble.

    Parameters
    ----------
    settings : MatchedSettings
    drawn : Drawn, optional
        Drawn before with the same settings.
    told : callable, optional
        Called with the share that is done.
    kind : type
        `AidedFilter`, or a reference that stands in for it.
    """
    drawn = draw(settings) if drawn is None else drawn
    rows = []
    for i in range(settings.runs):
        rows.append(fly_one(settings, drawn, i, kind(settings.believed(), settings.noise(), COVERED)))
        if told is not None:
            told((i + 1) / settings.runs)
    table = np.array(rows)  # (m, r, 6)
    s = drawn.schedule
    kept = s.told > REST + LATENCY
    truth = _at(drawn.courses.t, drawn.courses.airspeed, s.told[kept])
    schedule = Schedule(
        s.start, s.told[s.told > s.start], s.total_end[s.told > s.start], s.static_end[s.told > s.start]
    )
    tare = settings.mode.noise * sqrt(2.0 / max(1.0, (COVERED[1] - COVERED[0]) * settings.mode.rate))
    noise = settings.noise()
    rest = sqrt(noise.accelerometer_sd**2 / (0.5 * noise.accelerometer_rate) + WANDER**2)
    bound = AirspeedBound(drawn.courses, schedule, settings.estimator, noise, Start(rest, tare)).sd()
    return Matched(
        t=s.told[kept] - REST,
        error=table[:, :, 0] - truth,
        sd=table[:, :, 1],
        raw_error=table[:, :, 2] - truth,
        nis=table[:, :, 3:5],
        innovation=table[:, :, 5],
        bound=bound[-int(kept.sum()) :],
    )


def fly_one(settings: MatchedSettings, drawn: Drawn, i: int, estimator: AidedFilter) -> list[tuple[float, ...]]:
    """Fly run `i`; return airspeed, its deviation, raw airspeed, both NIS and the innovation at each time told."""
    forces = zip(drawn.courses.t.tolist(), drawn.force_read[i].tolist(), strict=True)
    s = drawn.schedule
    rows = zip(
        s.told.tolist(), drawn.total[i].tolist(), drawn.static[i].tolist(), s.total_end.tolist(),
        s.static_end.tolist(), strict=True,
    )  # fmt: skip
    found: list[tuple[float, ...]] = []
    t, f = next(forces)
    launch = REST + LATENCY
    for told, total, static, total_end, static_end in rows:
        while t <= told:
            estimator.accelerometer(t, f, nan, nan)
            if t >= launch and not estimator.flying:
                estimator.launched(t)
            t, f = next(forces, (np.inf, 0.0))
        estimate = estimator.step(told, total, static, STANDARD_TEMPERATURE, total_end, static_end)
        if told > launch and estimate is not None:
            _, speed, sd, raw, _, _, _, nis_total, nis_static = estimate
            innovation = copysign(sqrt(nis_total), estimator.energy.innovation)
            found.append((speed, sd, raw, nis_total, nis_static, innovation))
    return found
