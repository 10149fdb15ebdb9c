"""The air's motion at the aircraft: mean wind, turbulence and gusts, a step at a time.

Every 20 ms the filters of the turbulence are set to the airspeed and the height, and run ahead over the steps up to the
next; within these the height goes on as the aircraft climbs, and wind and intensity go by it step by step. What they
give at a step's beginning blows through that step.
"""

from collections.abc import Callable, Iterator
from math import cos, exp, expm1, inf, pi, sin, sqrt
from struct import Struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import compiled
from uavsim.plants.air import wind
from uavsim.plants.air.dryden import (
    BASE,
    FOOT,
    HIGH,
    LENGTH_HIGH,
    LOW,
    LOWEST,
    ROOT3,
    SLOPE,
    SLOWEST,
    STATES,
    advance,
    at_rest,
    coefficients,
    roll_deviation,
    sd_above,
)
from uavsim.plants.air.gusts import Gusts
from uavsim.plants.air.settings import EnvironmentSettings
from uavsim.plants.air.wind import speed_at, towards_at

AHEAD = 0.020  # s that the filters run ahead
DRAWN = 1000  # steps for which normal numbers are drawn at once
COLUMNS = 8  # of the air's record: north, east, down, m/s; p, q, r, rad/s; mean wind to north and east, m/s

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
ROW = Struct(f"{COLUMNS}d")
NO_NOISE = np.zeros((0, STATES))

# Where the air's numbers and memory stand in one array, which costs a call less than many: the mean wind's law, W₂₀,
# span and step; states; coefficients of u, v, w and p, at low and at high altitude
LOW_STATE, HIGH_STATE = slice(8, 17), slice(17, 26)
TRANSITIONS, ROOTS, ROLLING = slice(26, 53), slice(53, 80), slice(80, 82)
UPPER_TRANSITIONS, UPPER_ROOTS, UPPER_ROLLING = slice(82, 109), slice(109, 136), slice(136, 138)
BOX = 138


class State(NamedTuple):
    """What the air is told of the aircraft."""

    height: float  # m above the ground
    climb: float  # m/s
    airspeed: float  # m/s
    roll: float  # rad
    pitch: float  # rad
    heading: float  # rad


@compiled
def low_lengths(feet: float) -> tuple[float, float]:
    """V T of u and v and of w at low altitude, m, in both specifications; see `dryden`."""
    within = min(max(feet, LOWEST), LOW)
    return within / (BASE + SLOPE * within) ** 1.2 * FOOT, within * FOOT


@compiled
def filters(along: float, down: float, speed: float, span: float, dt: float, f: Array, g: Array, p: Array) -> None:
    """Set the `coefficients` of u, v and w, and those of p, of unit variance; V T of u and v and of w, m."""
    turning = pi * speed / (3.0 * span)  # of r, about the vertical; of q and p below
    pitching = pi * speed / (4.0 * span)
    coefficients(speed / along, turning, dt, False, f[0], g[0])
    coefficients(speed / along, turning, dt, True, f[1], g[1])
    coefficients(speed / down, pitching, dt, True, f[2], g[2])
    p[0] = exp(-pitching * dt)
    p[1] = sqrt(-expm1(-2.0 * pitching * dt))


@compiled
def _of(state: Array, at: int) -> float:
    """Gust of unit variance from its filter's z₁ and z₂."""
    value: float = ROOT3 * state[at] + (1.0 - ROOT3) * state[at + 1]
    return value


@compiled
def blow(
    out: Array,
    box: Array,
    noise: Array,
    noise_high: Array,
    height: float,
    climb: float,
    airspeed: float,
    roll: float,
    pitch: float,
    heading: float,
    upper: float,
) -> None:
    """Run ahead over the steps of a block.

    Parameters
    ----------
    out : ndarray, shape (n, 8)
        Receives what blows through each step (`COLUMNS`).
    box : ndarray, shape (BOX,)
        The air's numbers and memory, as `MovingAir` fills it.
    noise, noise_high : ndarray, shape (n, 9)
        Independent standard normal numbers, for low altitude and for high.
    height, climb, airspeed, roll, pitch, heading : float
        The aircraft's `State` at the beginning.
    upper : float
        Standard deviation at high altitude, m/s.
    """
    kind, scale, own, direction, veer = box[0], box[1], box[2], box[3], box[4]
    w20, span, dt = box[5], box[6], box[7]
    low, high, p = box[LOW_STATE], box[HIGH_STATE], box[ROLLING]
    f, g = box[TRANSITIONS].reshape(3, 3, 3), box[ROOTS].reshape(3, 3, 3)
    f_high, g_high, p_high = (
        box[UPPER_TRANSITIONS].reshape(3, 3, 3),
        box[UPPER_ROOTS].reshape(3, 3, 3),
        box[UPPER_ROLLING],
    )
    k = min(max((height / FOOT - LOW) / (HIGH - LOW), 0.0), 1.0)
    speed = max(airspeed, SLOWEST)
    ch, sh = cos(heading), sin(heading)
    if w20 > 0.0 and k < 1.0:
        along, down = low_lengths(height / FOOT)
        filters(along, down, speed, span, dt, f, g, p)
    if w20 > 0.0 and k > 0.0:
        filters(LENGTH_HIGH, LENGTH_HIGH, speed, span, dt, f_high, g_high, p_high)
    cr, sr, cp, sp = cos(roll), sin(roll), cos(pitch), sin(pitch)
    per_q, per_r = pi / (4.0 * span), pi / (3.0 * span)
    towards = towards_at(height, direction, veer)
    c, s = cos(towards), sin(towards)
    for i in range(out.shape[0]):
        here = height + climb * dt * i
        mean = speed_at(here, kind, scale, own)
        if veer != 0.0:
            towards = towards_at(here, direction, veer)
            c, s = cos(towards), sin(towards)
        n, e, d, rate_p, rate_q, rate_r = mean * c, mean * s, 0.0, 0.0, 0.0, 0.0
        out[i, 6], out[i, 7] = n, e
        if w20 > 0.0 and k < 1.0:
            advance(low, noise[i], f, g, p)
            within = min(max(here / FOOT, LOWEST), LOW)
            sd_w = 0.1 * w20 * sqrt(1.0 - k)
            sd_u = sd_w / (BASE + SLOPE * within) ** 0.4
            u, v, w = sd_u * low[0], sd_u * _of(low, 2), sd_w * _of(low, 5)
            lag_u, lag_v = u - sd_u * low[1], v - sd_u * low[4]
            n += c * u - s * v
            e += s * u + c * v
            d += w
            rate_p += roll_deviation(sd_w, within * FOOT, span) * low[8]
            rate_q -= per_q * (w - sd_w * low[7])
            rate_r += per_r * ((s * lag_u + c * lag_v) * ch - (c * lag_u - s * lag_v) * sh)
        if w20 > 0.0 and k > 0.0:
            advance(high, noise_high[i], f_high, g_high, p_high)
            sd = upper * sqrt(k)
            u, v, w = sd * high[0], sd * _of(high, 2), sd * _of(high, 5)
            n += cp * ch * u + (sr * sp * ch - cr * sh) * v + (cr * sp * ch + sr * sh) * w
            e += cp * sh * u + (sr * sp * sh + cr * ch) * v + (cr * sp * sh - sr * ch) * w
            d += -sp * u + sr * cp * v + cr * cp * w
            rate_p += roll_deviation(sd, LENGTH_HIGH, span) * high[8]
            rate_q -= per_q * (w - sd * high[7])
            rate_r += per_r * (v - sd * high[4])
        out[i, 0], out[i, 1], out[i, 2] = n, e, d
        out[i, 3], out[i, 4], out[i, 5] = rate_p, rate_q, rate_r


class MovingAir:
    """The air's motion along one flight.

    Parameters
    ----------
    environment : EnvironmentSettings
    heading_deg : float
        Of the rail: what head and side of a gust mean.
    span : float
        The wing's, m.
    step_rate : float
        Hz.
    steps : int
        The most that will be asked for.
    seed : int
        Of the turbulence.

    Attributes
    ----------
    blows : bool
        Whether there is mean wind or turbulence.
    active : bool
        Whether `motion` is to be asked: there is, or a gust may bring it without another event.
    gusts : Gusts
    """

    def __init__(
        self, environment: EnvironmentSettings, heading_deg: float, span: float, step_rate: float, steps: int, seed: int
    ) -> None:
        self._severity = environment.turbulence_severity
        self._rough = environment.turbulence_wind_20ft > 0.0
        self.blows = self._rough or environment.wind_speed > 0.0
        self.gusts = Gusts(environment, heading_deg)
        self.active, self._told = self.blows, False
        self._rate, self._ahead = step_rate, max(1, round(AHEAD * step_rate))
        self._random = [np.random.Generator(np.random.PCG64(s)) for s in np.random.SeedSequence(seed).spawn(2)]
        self._noise: list[Iterator[Array]] = [iter(()), iter(())]
        self._box = np.zeros(BOX)
        self._box[:8] = *wind.law(environment), environment.turbulence_wind_20ft, span, 1.0 / step_rate
        self._record = np.zeros((steps + self._ahead if self.blows else 0, COLUMNS))
        self._size = 0

    def motion(self, time: float, state: Callable[[], State]) -> Iterator[tuple[float, ...]]:
        """Yield step by step what blows through it, `COLUMNS` with the gusts; it ends when there is none to come.

        Parameters
        ----------
        time : float
            At which the first step begins, s.
        state : callable
            Tells of the aircraft; asked every 20 ms.
        """
        first, gusts = round(time * self._rate), self.gusts
        while True:
            times = np.arange(first, first + self._ahead) / self._rate  # the plant's own, to the last digit
            first += self._ahead
            waits = gusts.following(float(times[0])) < inf
            if not self.blows and not waits:
                self.active = False
                yield ROW.unpack(bytes(ROW.size))
                return
            block = self.ahead(state()) if self.blows else np.zeros((self._ahead, COLUMNS))
            if not waits and not gusts.awaited:
                yield from ROW.iter_unpack(block.data)  # nothing can come between
                continue
            done = 0
            while done < len(block):
                self._told = False
                for row in self._with_gusts(block[done:], times[done:]):
                    yield row
                    done += 1
                    if self._told:
                        break

    def _with_gusts(self, block: Array, times: Array) -> Iterator[tuple[float, ...]]:
        """Return the rows of a block, of steps that begin at `times`, with the gusts that blow then."""
        if self.gusts.following(float(times[0])) <= times[-1]:
            block = block.copy()
            block[:, :3] += self.gusts.over(times)
        return ROW.iter_unpack(block.data)

    def ahead(self, state: State) -> Array:
        """Return what blows through each of the steps of the next 20 ms, gusts apart: rows of `COLUMNS`."""
        if not self._size and self._rough:
            self._begin(state)
        if self._size + self._ahead > len(self._record):  # flown for longer than was said
            self._record = np.concatenate([self._record, np.zeros((max(DRAWN, len(self._record)), COLUMNS))])
        out = self._record[self._size : self._size + self._ahead]
        low, high, upper = self._normal(0) if self._rough else NO_NOISE, NO_NOISE, 0.0
        if self._rough and state.height > LOW * FOOT:
            high, upper = self._normal(1), sd_above(state.height, self._severity)
        blow.code(out, self._box, low, high, *state, upper)
        self._size += self._ahead
        return out

    def tell(self, event: str, time: float) -> None:
        """Say that an event has come (`Gusts.tell`); a gust without delay blows from the next step on."""
        if event in self.gusts.awaited:
            self.gusts.tell(event, time)
            self._told = self.active = True

    def record(self, first: int, times: Array) -> dict[str, Array]:
        """Return columns of the truth at the times of a record's rows, s.

        Parameters
        ----------
        first : int
            Number of steps before the record's first row.
        times : ndarray, shape (n,)
        """
        rows = np.zeros((len(times), COLUMNS))
        if self.blows:  # what is felt in a row was set at the beginning of the step that led to it
            rows[:] = self._record[first - 1 : first - 1 + len(times)]
        begun = np.append(times[:1] - self._box[7], times[:-1])  # the very numbers of `motion`
        gust = self.gusts.over(begun)
        named = {"mean_wind_n": rows[:, 6], "mean_wind_e": rows[:, 7]}
        named |= {f"gust_{axis}": gust[:, i] for i, axis in enumerate("ned")}
        return named | {f"air_{axis}": rows[:, 3 + i] for i, axis in enumerate("pqr")}

    def _normal(self, which: int) -> Array:
        """Return the normal numbers of a block's steps, for low altitude, 0, or high, 1."""
        block = next(self._noise[which], None)
        if block is None:
            rows = (-(-DRAWN // self._ahead), self._ahead, STATES)
            self._noise[which] = iter(self._random[which].standard_normal(rows))
            block = next(self._noise[which])
        return block

    def _begin(self, state: State) -> None:
        """Draw filters that have run for ever at the airspeed and height of the beginning."""
        speed, (along, down) = max(state.airspeed, SLOWEST), low_lengths(state.height / FOOT)
        span, dt = self._box[6:8]
        f, g, p = np.zeros((3, 3, 3)), np.zeros((3, 3, 3)), np.zeros(2)
        for part, random, (u, w) in zip(
            (LOW_STATE, HIGH_STATE), self._random, ((along, down), (LENGTH_HIGH, LENGTH_HIGH)), strict=True
        ):
            filters(u, w, speed, span, dt, f, g, p)
            self._box[part] = at_rest(f, g, random.standard_normal(STATES))
