"""Prescribed flights of a point mass as its sensors read them: airspeed, flight path and bank over time, in any air.

    f_path = dV_i/dt + g sin γ,   L = (g cos γ + V γ̇)/cos φ,   α = α₀ + c L/V²,
    f_x = f_path cos α + L sin α,   f_z = f_path sin α − L cos α,   ṗ_s = −ρ g V sin γ,   p_t = p_s (1 + V²/(7RT))^3.5

V_i is the speed less the gust G, V = V_i + G; c is 2m/(ρ S C_Lα), some metres. On the rail and in the push the body's
axis is the path. It is all of numpy, and a flight of 30 s costs a tenth of a second in the filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed import AidedFilter, AidedSettings, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.gust import GRAVITY

# what the default head and accelerometer are believed to do (two BMP390, an MPU-6050-like part at 833 Hz)
NOISE = NoiseModel(
    total_sd=3.7,
    static_sd=3.7,
    temperature_sd=0.5,
    total_window=0.0048,
    static_window=0.0048,
    walk=0.12,
    accelerometer_sd=0.72,
    accelerometer_scale_sd=0.005,
    accelerometer_offset_sd=0.2,
    lift_offset_sd=0.2,
    accelerometer_rate=500.0,
    accelerometer_white_sd=0.1,
    accelerometer_step=0.01,
    head_rate=100.0,
)
SETTINGS = EstimatorSettings(kind="aided", fastest=340.0, aided=AidedSettings())
COVERED = (0.0, 4.0)  # s, of the tare
LAUNCH = 5.0  # s, when the push begins
LATENCY = 0.015  # s until it is recognised
SMOOTH = 0.3  # s, over which a prescribed course is made smooth

Course = Sequence[tuple[float, float]]
"""Corners (s, value), linear between them."""


@dataclass(frozen=True)
class Flight:
    """What is flown.

    Attributes
    ----------
    speed, path_deg, bank_deg : course
        V_i, m/s, γ and φ, degrees; times are those after the launch, s. In the push the speed is `speed` itself.
    elevation_deg : float
        Of the rail.
    duration : float
        After the launch, s.
    push : float
        How long the push lasts, s.
    gust_sd, gust_length : float
        Of the first-order gust along the path, m/s and m.
    ground, temperature : float
        Static pressure, Pa, and K.
    turn, alpha0 : float
        c, m, and α₀, rad.
    total_sd, static_sd, force_sd : float
        Noise of a reading, Pa and m/s².
    total_step, static_step : float
        Rounding, Pa; 0 for none.
    offset : tuple of float
        Of the accelerometer, m/s².
    wind : float
        Headwind on the rail, m/s: V = V_i + wind.
    """

    speed: Course = ((0.0, 0.0), (0.3, 26.0), (4.0, 32.0))
    path_deg: Course = ((0.0, 12.0), (0.3, 12.0), (1.0, 4.0), (4.0, 3.0), (6.0, 0.0))
    bank_deg: Course = ((0.0, 0.0),)
    elevation_deg: float = 12.0
    duration: float = 20.0
    push: float = 0.3
    gust_sd: float = 0.0
    gust_length: float = 200.0
    ground: float = 101_325.0
    temperature: float = 288.15
    turn: float = 5.0
    alpha0: float = -0.03
    total_sd: float = 3.7
    static_sd: float = 3.7
    force_sd: float = 0.72
    total_step: float = 0.0
    static_step: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wind: float = 0.0
    rate: float = 500.0
    head_rate: float = 100.0


@dataclass
class Readings:
    """What the sensors would read: `force` rows (t, fx, fy, fz), `air` rows (t, p_t, p_s, T, t_t, t_s); and truth."""

    force: np.ndarray
    air: np.ndarray
    t: np.ndarray
    airspeed: np.ndarray
    height: np.ndarray
    flight: Flight = field(repr=False)

    def truth(self, t: float) -> float:
        """True airspeed, m/s."""
        return float(np.interp(t, self.t, self.airspeed))


def _course(course: Course, t: np.ndarray, dt: float, smooth: float) -> np.ndarray:
    times, values = zip(*course, strict=True)
    wide = np.interp(t, times, values)
    n = max(1, int(smooth / dt))
    if n < 3:
        return wide
    window = np.hanning(n + 2)[1:-1]
    padded = np.pad(wide, (n, n), mode="edge")
    return np.convolve(padded, window / window.sum(), mode="same")[n:-n]


def fly(flight: Flight, seed: int) -> Readings:
    """Draw the readings of a flight."""
    rng = np.random.default_rng(seed)
    dt = 1.0 / flight.rate
    n = round((LAUNCH + flight.duration) * flight.rate)
    t = dt * np.arange(n)
    tau = t - LAUNCH
    smooth = _course(flight.speed, tau, dt, SMOOTH)
    sharp = _course(flight.speed, tau, dt, 0.02)
    weight = np.clip((tau - flight.push - 0.1) / 0.5, 0.0, 1.0)
    inertial = np.where(tau <= 0.0, 0.0, (1.0 - weight) * sharp + weight * smooth)
    gamma = np.radians(_course(flight.path_deg, tau, dt, SMOOTH))
    gamma = np.where(tau < flight.push, np.radians(flight.elevation_deg), gamma)
    phi = np.radians(_course(flight.bank_deg, tau, dt, SMOOTH))
    gust = np.zeros(n)
    if flight.gust_sd > 0.0:
        white = rng.standard_normal(n)
        state = flight.gust_sd * rng.standard_normal()
        for i in range(n):
            keep = np.exp(-max(inertial[i], 5.0) * dt / flight.gust_length)
            state = keep * state + flight.gust_sd * np.sqrt(1.0 - keep * keep) * white[i]
            gust[i] = state
        gust *= np.clip((tau - flight.push) / 0.5, 0.0, 1.0)
    airspeed = np.abs(inertial + gust + flight.wind)
    flying = tau >= flight.push
    v = np.maximum(inertial + flight.wind, 5.0)
    along = np.gradient(inertial, dt) + GRAVITY * np.sin(gamma)
    along = np.where(tau < 0.0, GRAVITY * np.sin(np.radians(flight.elevation_deg)), along)
    pull = GRAVITY * np.cos(gamma) + v * np.gradient(gamma, dt)
    lift = np.where(flying, pull / np.cos(phi), GRAVITY * np.cos(gamma))
    lift = np.clip(lift, -60.0, 60.0)
    alpha = np.where(flying, flight.alpha0 + flight.turn * lift / v**2, 0.0)
    fx = along * np.cos(alpha) + lift * np.sin(alpha)
    fz = along * np.sin(alpha) - lift * np.cos(alpha)
    climb = np.where(tau > 0.0, inertial, 0.0) * np.sin(gamma)
    height = np.cumsum(climb) * dt
    gas = GAS_CONSTANT_DRY_AIR * flight.temperature
    static = flight.ground * np.exp(-GRAVITY * height / gas)
    total = static * (1.0 + airspeed**2 / (7.0 * gas)) ** 3.5
    total = np.where(t < COVERED[1], static, total)
    noise = flight.force_sd * rng.standard_normal((n, 3))
    force = np.column_stack([t, fx + noise[:, 0], noise[:, 1], fz + noise[:, 2]])
    force[:, 1:] += flight.offset
    told = np.arange(0.0, t[-1], 1.0 / flight.head_rate)
    middle = told - 0.5 * 0.0048

    def read(pressure: np.ndarray, sd: float, step: float) -> np.ndarray:
        read = np.interp(middle, t, pressure) + sd * rng.standard_normal(told.size)
        return np.round(read / step) * step if step > 0.0 else read

    air = np.column_stack(
        [
            told,
            read(total, flight.total_sd, flight.total_step),
            read(static, flight.static_sd, flight.static_step),
            np.full(told.size, flight.temperature),
            told,
            told,
        ]
    )
    return Readings(force, air, t, airspeed, height, flight)


# -- what breaks, on the readings -------------------------------------------------------------------------------------


def spoil(readings: Readings, column: int, start: float, how: str, seed: int = 0, size: float = 0.0) -> Readings:
    """Return readings whose head has a fault from `start` on, s of the clock.

    `column`: 1 total, 2 static, 3 temperature. `how`: shut (the pressure is held, noise goes on), stuck, nan, value
    (`size`), offset (`size`), leak (the pressure leaks to static with the time constant `size`, s), silent.
    """
    rng = np.random.default_rng(seed)
    air = readings.air.copy()
    told = air[:, 0]
    bad = told >= start
    first = int(np.argmax(bad))
    noise = (readings.flight.total_sd, readings.flight.static_sd)[min(column, 2) - 1] if column < 3 else 0.1
    step = (readings.flight.total_step, readings.flight.static_step)[min(column, 2) - 1] if column < 3 else 0.0
    fresh = noise * rng.standard_normal(int(bad.sum()))
    base = readings.air[max(0, first - 20) : max(first, 1), column].mean()
    if how == "shut":
        air[bad, column] = base + fresh
    elif how == "stuck":
        air[bad, column] = air[max(first - 1, 0), column]
    elif how == "nan":
        air[bad, column] = np.nan
    elif how == "value":
        air[bad, column] = size
    elif how == "offset":
        air[bad, column] += size
    elif how == "leak":
        q = base - readings.air[max(0, first - 20) : max(first, 1), 2].mean()
        start_static = readings.air[max(0, first - 20) : max(first, 1), 2].mean()
        air[bad, column] = start_static + q * np.exp(-(told[bad] - start) / size) + fresh
    elif how == "silent":
        air[bad, column] = air[max(first - 1, 0), column]
        air[bad, 3 + column] = air[max(first - 1, 0), 3 + column]
    if step > 0.0 and how in ("shut", "leak"):
        air[bad, column] = np.round(air[bad, column] / step) * step
    return replace(readings, air=air)


def without_force(readings: Readings, start: float, stop: float) -> Readings:
    """Return readings whose accelerometer is silent for a while, s of the clock."""
    t = readings.force[:, 0]
    return replace(readings, force=readings.force[(t < start) | (t >= stop)])


# -- through the filter -----------------------------------------------------------------------------------------------


@dataclass
class Flown:
    """What the filter made of it: rows t, airspeed, sd, valid, error; its news; the filter."""

    rows: np.ndarray
    news: list
    filter: AidedFilter

    @property
    def faults(self) -> list:
        return [n for n in self.news if "fault" in n[1]]

    def after(self, t: float) -> np.ndarray:
        """Rows from so long after the launch on."""
        return self.rows[self.rows[:, 0] >= LAUNCH + t]


def run(
    readings: Readings,
    settings: EstimatorSettings = SETTINGS,
    noise: NoiseModel | None = None,
    tare: tuple[float, float] | None = COVERED,
    wings: float | None = 0.2,
    recognised: float = LAUNCH + LATENCY,
) -> Flown:
    """Feed the filter; `wings` is how long after the push they are commanded out, s."""
    flight = readings.flight
    if noise is None:
        noise = replace(
            NOISE,
            total_sd=float(np.hypot(flight.total_sd, flight.total_step / np.sqrt(12.0))),
            static_sd=float(np.hypot(flight.static_sd, flight.static_step / np.sqrt(12.0))),
            accelerometer_sd=flight.force_sd,
            accelerometer_rate=flight.rate,
            head_rate=flight.head_rate,
            rail_elevation=float(np.radians(flight.elevation_deg)),
            total_step=flight.total_step,
            static_step=flight.static_step,
        )
    estimator = AidedFilter(settings, noise, tare)
    tidy, out = False, []
    launched = opened = False
    forces, k = readings.force.tolist(), 0
    news: list = []
    for row in readings.air.tolist():
        while k < len(forces) and forces[k][0] <= row[0]:
            force = forces[k]
            k += 1
            estimator.accelerometer(*force)
            if tidy:
                estimator.tidy()
                tidy = False
            if not launched and force[0] >= recognised:
                launched = True
                estimator.launched(force[0])
            if not opened and wings is not None and force[0] >= LAUNCH + flight.push + wings:
                opened = True
                estimator.unfolding(force[0])
        e = estimator.step(*row)
        tidy = True
        if estimator.news:
            news += [(n[0], *n[1:]) for n in estimator.news]
            estimator.news.clear()
        if e is not None:
            out.append((e[0], e[1], e[2], float(e[6]), e[1] - readings.truth(e[0])))
    estimator.tidy()
    news += estimator.news
    return Flown(np.array(out), news, estimator)


# -- healthy manoeuvres -----------------------------------------------------------------------------------------------


def boost(top: float, g: float = 8.0) -> tuple[Course, float]:
    """A push of `g` up to a speed, m/s; the course and how long it lasts, s."""
    lasts = top / (g * GRAVITY)
    return ((0.0, 0.0), (lasts, top)), lasts


def steady(v: float, **more: object) -> Flight:
    """Constant speed in still air from the push on."""
    course, lasts = boost(v)
    return Flight(speed=course, push=lasts, path_deg=((0.0, 12.0), (lasts, 12.0), (lasts + 1.5, 0.0)), **more)  # type: ignore[arg-type]


MANOEUVRES: dict[str, Flight] = {
    "cruise": Flight(duration=30.0),
    "gusty": Flight(duration=30.0, gust_sd=1.0),
    "steady20": steady(20.0, duration=25.0),
    "steady50": steady(50.0, duration=25.0),
    "steady90": steady(90.0, duration=25.0),
    "steady150": steady(150.0, duration=25.0),
    "turn60": Flight(duration=30.0, bank_deg=((0.0, 0.0), (8.0, 0.0), (9.0, 60.0), (18.0, 60.0), (19.0, 0.0))),
    "turns": Flight(
        duration=40.0,
        gust_sd=0.5,
        bank_deg=((0, 0), (7, 0), (7.7, 60), (12, 60), (13.4, -60), (18, -60), (19, 0), (24, 0), (25, 45), (35, 45)),
    ),
    "pushover": Flight(
        duration=25.0,
        path_deg=((0, 12), (0.3, 12), (1, 4), (4, 10), (8, 10), (9, -6.5), (11, -6.5), (12.5, 0)),
        speed=((0, 0), (0.3, 26), (4, 32), (9, 32), (12, 34), (16, 32)),
    ),
    "pullup": Flight(
        duration=25.0,
        path_deg=((0, 12), (0.3, 12), (1, 4), (4, -10), (8, -10), (8.6, 22), (9.3, 22), (10.6, 0)),
        speed=((0, 0), (0.3, 26), (4, 36), (8, 40), (11, 32), (16, 32)),
    ),
    "speeds": Flight(
        duration=35.0,
        speed=((0, 0), (0.3, 26), (4, 32), (9, 32), (12, 26), (18, 26), (24, 38), (30, 38), (33, 28)),
    ),
    "climbs": Flight(
        duration=35.0,
        path_deg=((0, 12), (0.3, 12), (1, 4), (8, 6), (12, 6), (13, -6), (17, -6), (18, 5), (25, 5), (26, 0)),
    ),
    "motor7": Flight(
        duration=25.0,
        speed=((0, 0), (0.3, 26), (7.0, 120.0), (12.0, 95.0), (25.0, 60.0)),
        path_deg=((0, 20), (0.3, 20), (2, 15), (7, 12), (12, 3), (16, 0)),
        elevation_deg=20.0,
    ),
    "bungee": Flight(
        duration=25.0,
        speed=((0, 0), (0.4, 12), (0.8, 19), (1.2, 23), (1.6, 25), (2.0, 26), (6, 30)),
        push=2.0,
        path_deg=((0, 10), (2.0, 10), (4, 5), (8, 0)),
        elevation_deg=10.0,
    ),
    "fast200": Flight(
        duration=40.0,
        speed=((0, 0), (0.4, 30), (20, 200), (25, 200), (38, 60)),
        push=0.4,
        gust_sd=0.5,
        gust_length=400.0,
    ),
    "dive": Flight(
        duration=30.0,
        path_deg=((0, 12), (0.3, 12), (1, 12), (8, 12), (9, 0), (10, -25), (14, -25), (15.5, 0)),
        speed=((0, 0), (0.3, 26), (4, 32), (10, 30), (14, 45), (20, 32)),
    ),
    "orbit": Flight(
        duration=40.0,
        gust_sd=1.0,
        bank_deg=((0, 0), (7, 0), (8, 30), (38, 30)),
        path_deg=((0, 12), (1, 4), (8, 3), (38, 3)),
    ),
    "high": Flight(duration=25.0, ground=61_640.0, temperature=262.0),
    "cold": Flight(duration=25.0, ground=105_000.0, temperature=233.0),
    "hot": Flight(duration=25.0, temperature=328.0),
    "quiet": Flight(duration=25.0, total_sd=0.8, static_sd=0.8),
    "coarse": Flight(duration=25.0, total_sd=2.0, static_sd=2.0, total_step=10.0, static_step=10.0),
    "cheap": Flight(duration=25.0, total_sd=12.0, static_sd=12.0),
    "headwind": Flight(duration=25.0, wind=8.0, gust_sd=1.0),
    "roughquiet": Flight(duration=25.0, total_sd=0.8, static_sd=0.8, gust_sd=1.5),
}


def believed(flight: Flight) -> EstimatorSettings:
    """What the filter would be told of the air of a flight."""
    if flight.gust_sd > 0.2:
        return replace(SETTINGS, aided=replace(SETTINGS.aided, gust_sd=flight.gust_sd, gust_length=flight.gust_length))
    return SETTINGS
