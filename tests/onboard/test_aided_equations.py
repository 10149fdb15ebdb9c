"""Equations of the aided filter on noiseless readings in which nothing is alike: windows, lags, rates, slope and bias.

Two equal windows hide which of the two is meant, a steady speed hides a reading that is late, and a bias of 0 hides
its sign. So here the static sensor is slower and later than the total one, the aircraft speeds up and slows down, and
it climbs. The truth is integrated beside it,

    V̇ = f_x − b − s,    ṗ_s = −ρ V s,    p_t = p_s (1 + V²/(7 R T))^3.5

and a reading is the mean over its conversion, as old as its tube is slow. Only what any estimator has is used: its
readings and what it tells.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed import AidedFilter, EstimatorSettings, NoiseModel

NAN = math.nan
KELVIN, SEA_LEVEL, DT = 285.0, 101_325.0, 1e-3
LAUNCH, STROKE, DETECTED = 2.0, 0.3, 2.04  # s
SETTINGS = EstimatorSettings(kind="aided", wind_sd=1.0)
NOISE = NoiseModel(
    total_sd=1.0, static_sd=0.7, temperature_sd=0.0, total_window=6e-3, static_window=18e-3, total_lag=3e-3,
    static_lag=21e-3, accelerometer_sd=0.2, accelerometer_scale_sd=0.0,
)  # fmt: skip
FLICKER = 1e-3  # Pa, so that no reading is the one before


@dataclass(frozen=True)
class Course:
    """A true flight in steps of a millisecond."""

    t: np.ndarray
    force: np.ndarray  # m/s², without bias
    speed: np.ndarray
    static: np.ndarray
    total: np.ndarray

    def mean(self, name: str, end: float, window: float, lag: float) -> float:
        """Mean of a pressure over a conversion that ends at `end`, behind a tube."""
        times = np.linspace(end - lag - window, end - lag, 13)
        return float(np.interp(times, self.t, getattr(self, name)).mean()) + FLICKER * (round(1e4 * end) % 7)

    def at(self, name: str, t: np.ndarray) -> np.ndarray:
        return np.interp(t, self.t, getattr(self, name))


def course(until: float = 8.0, *, climb: float = 1.5, surge: float = 4.0, period: float = 3.0) -> Course:
    """From rest to 25 m/s in 0.3 s; then a climb of g sin γ = `climb`, and ± `surge` m/s² in turns of half a period."""
    t = np.arange(round(until / DT) + 1) * DT
    since = t - LAUNCH
    pushed = np.clip(np.minimum(since, STROKE - since) / 0.02, 0.0, 1.0) * 25.0 / (STROKE - 0.02)
    after = since > STROKE + 0.3
    gained = pushed + np.where(after, surge * np.sign(np.sin(2.0 * np.pi * (since - STROKE - 0.3) / period)), 0.0)
    speed = np.concatenate([[0.0], np.cumsum(0.5 * DT * (gained[1:] + gained[:-1]))])
    slope = np.full(t.shape, climb)
    fall = -SEA_LEVEL / (GAS_CONSTANT_DRY_AIR * KELVIN) * speed * slope
    static = SEA_LEVEL + np.concatenate([[0.0], np.cumsum(0.5 * DT * (fall[1:] + fall[:-1]))])
    total = static * (1.0 + speed**2 / (7.0 * GAS_CONSTANT_DRY_AIR * KELVIN)) ** 3.5
    return Course(t, gained + slope, speed, static, total)


def flown(
    true: Course,
    noise: NoiseModel = NOISE,
    *,
    settings: EstimatorSettings = SETTINGS,
    bias: float = 0.0,
    total_every: int = 1,
    late: float = 0.0,
    deaf: tuple[float, float] = (math.inf, math.inf),
    silent: tuple[float, float] = (math.inf, math.inf),
    shut: float = math.inf,
    news: list[tuple[float, str, str, str]] | None = None,
) -> np.ndarray:
    """Estimates at 100 Hz: t, V, σ, raw, p_t, p_s, valid.

    `late` s pass from the end of a total pressure's conversion to its reading, and only each so many-th has one; in
    `deaf` there is no total pressure, in `silent` none at all; from `shut` on the static port is. `news` takes what the
    estimator has noticed.
    """
    estimator = AidedFilter(settings, noise, (0.3, 1.3))
    total = end_total = NAN
    found, told = [], False
    for k, (t, force) in enumerate(zip(true.t.tolist(), true.force.tolist(), strict=True)):
        estimator.accelerometer(t, force + bias, 0.0, -9.7)
        if not told and t >= DETECTED:
            estimator.launched(t)
            told = True
        if k % 10 == 5:
            if (k // 10) % total_every == 0:
                end_total = t - 1e-3 - late
                total = true.mean("total", end_total, noise.total_window, noise.total_lag)
            end_static = t - 2e-3
            static = true.mean("static", min(end_static, shut), noise.static_window, noise.static_lag)
            static += FLICKER * (k % 70)  # a sensor behind a shut port lives
            heard = not deaf[0] <= t < deaf[1] and not silent[0] <= t < silent[1]
            row = estimator.step(
                t, total if heard else NAN, NAN if silent[0] <= t < silent[1] else static, KELVIN, end_total, end_static
            )
            found.append(row[:7])
    if news is not None:
        news += estimator.news
    return np.array(found, dtype=float)


def errors(rows: np.ndarray, true: Course, first: float, last: float = math.inf) -> np.ndarray:
    """Errors of V and p_s between two times."""
    chosen = rows[(rows[:, 0] >= first) & (rows[:, 0] < last)]
    t = chosen[:, 0]
    return np.column_stack([chosen[:, 1] - true.at("speed", t), chosen[:, 5] - true.at("static", t)])


def test_each_pressure_is_of_its_own_instant() -> None:
    """Half its own window and its own tube before the end of its conversion: 6 ms and 30 ms.

    In a climb of 1.5 m/s² at 25 m/s the static pressure falls by 46 Pa/s, so that the other's age is 1.1 Pa.
    """
    true = course(surge=0.0)
    off = errors(flown(true), true, 4.0)
    assert np.abs(off[:, 1]).max() < 0.3
    assert np.abs(off[:, 0]).max() < 0.03


def test_the_push_is_felt_when_it_is_and_not_when_it_is_read() -> None:
    """4 m/s² to and fro: an age that is wrong by 10 ms would be 0.04 m/s, one that has the wrong sign twice that."""
    true = course(period=2.0)
    off = errors(flown(true), true, 4.0)
    assert np.abs(off[:, 0]).max() < 0.03


PROMPT = replace(NOISE, static_window=2e-3, static_lag=0.0)
"""A static sensor without delay: by it the filter has gone on beyond the instant of a late total pressure."""


def test_a_late_total_pressure_is_carried_on_by_what_was_felt_since() -> None:
    """Every fourth reading has a total pressure, of 42 ms before; static ones have taken the filter on by 19 to 39 ms.

    At 8 m/s² that is 0.3 m/s at the most; carried on with the wrong sign it would be twice as much off, not right.
    """
    true = course(surge=8.0, period=2.4)
    off = errors(flown(true, PROMPT, total_every=4, late=0.035), true, 4.0)
    assert np.abs(off[:, 0]).max() < 0.08


@pytest.mark.parametrize("climb", [5.0, -5.0])
def test_of_what_was_felt_since_the_climbs_share_is_no_airspeed(climb: float) -> None:
    """f_x feels 5 m/s² that V does not: over 39 ms 0.2 m/s, and twice that with the wrong sign.

    A climb for good is not what the filter expects: it believes it a little less than it is, and tells 0.08 m/s amiss.
    """
    true = course(surge=0.0, climb=climb)
    settings = replace(SETTINGS, aided=replace(SETTINGS.aided, slope_rate=3.0))
    off = errors(flown(true, PROMPT, settings=settings, total_every=4, late=0.035), true, 5.0)
    assert np.abs(off[:, 0]).max() < 0.2
    assert abs(off[:, 0].mean()) < 0.12


def test_a_total_pressure_that_comes_later_says_less() -> None:
    """In gusts V may have changed since: σ_t² + (ρV)² · 2σ²V/L · 30 ms, so that the error bar is wider."""
    gusty = replace(SETTINGS, aided=replace(SETTINGS.aided, gust_sd=6.0))
    true = course(surge=0.0)
    sds = []
    for late in (0.0, 0.035):
        rows = flown(true, replace(PROMPT, total_sd=0.3), settings=gusty, total_every=4, late=late)
        sds.append(rows[rows[:, 0] > 4.0, 2])
    assert (sds[1] > 1.2 * sds[0]).mean() > 0.9
    assert np.isfinite(sds[1]).all()


def test_the_error_bar_does_not_tell_where_the_filter_stands() -> None:
    """Without total pressures it goes on with every third static one and is told ahead between: σ² grows evenly.

    Var(V − T (b + s)) = σ_V² − 2 T (σ_Vb + σ_Vs) + T² (…): with the other sign σ² is a saw.
    """
    true = course(surge=0.0)
    rows = flown(true, deaf=(5.0, 9.0))
    coasted = rows[(rows[:, 0] > 5.3) & (rows[:, 0] < 7.9), 2] ** 2
    steps = np.diff(coasted)
    assert (steps > 0.0).all()
    assert (steps[1:] / steps[:-1]).max() < 1.35


def test_while_nothing_is_read_the_error_bar_holds_for_what_is_told() -> None:
    """A bias that came after the launch and a climb: after 0.5 s of silence V is within 2 σ, and σ has grown."""
    true = course(surge=0.0)
    rows = flown(true, silent=(6.0, 6.5))
    off = errors(rows, true, 6.0, 6.5)[:, 0]
    sd = rows[(rows[:, 0] >= 6.0) & (rows[:, 0] < 6.5), 2]
    assert (np.abs(off) < 2.0 * sd).all()
    assert (np.diff(sd) > 0.0).all()
    assert sd[-1] > 1.5 * sd[0]


@pytest.mark.parametrize("bias", [0.25, -0.25])
def test_the_bias_is_learnt_with_its_sign(bias: float) -> None:
    """0.25 m/s² that f_x reads too much or too little: after it is learnt a second without pressures costs little."""
    true = course(surge=0.0, climb=0.0)
    steady = replace(SETTINGS.aided, bias_time=1000.0, slope_rate=0.01)
    rows = flown(true, settings=replace(SETTINGS, aided=steady), bias=bias, silent=(6.5, 7.5))
    off = errors(rows, true, 7.3, 7.5)[:, 0]
    assert np.abs(off).max() < 0.5 * abs(bias)


# -- a static port that is flagged -------------------------------------------------------------------------------------

SHUT = 5.5  # s


@pytest.mark.parametrize("climb", [3.0, -3.0])
def test_a_shut_static_port_is_left_along_the_climb_that_it_was_shut_in(climb: float) -> None:
    """p = p_held − ρ g c₀ T and V by what p was wrong, and the climb goes on: c₀ = V s/g = ± 7.7 m/s, 92 Pa/s.

    Of every row for a second after the flag, none of which is valid. When it is flagged, after 0.1 s, the pressure has
    come to be wrong by 5 Pa and the airspeed by 0.15 m/s; the climb that is carried on is worth 92 Pa in that second.
    """
    true, news = course(surge=0.0, climb=climb), []
    settings = replace(SETTINGS, aided=replace(SETTINGS.aided, slope_rate=3.0))
    rows = flown(true, settings=settings, shut=SHUT, news=news)
    (flagged, event, channel, kind), *more = [n for n in news if n[1] == "airspeed_fault"]
    assert (event, channel, kind, more) == ("airspeed_fault", "static", "frozen", [])
    assert SHUT < flagged < SHUT + 1.0
    assert not rows[rows[:, 0] > flagged + 1e-9, 6].any()
    off = errors(rows, true, flagged + 1e-9, flagged + 1.0)
    assert np.abs(off[:, 0]).max() < 0.13
    assert np.abs(off[:, 1]).max() < 4.0


@pytest.mark.parametrize("climb", [3.0, -3.0])
def test_an_airspeed_is_freed_of_what_the_wrong_static_pressure_made_of_it(climb: float) -> None:
    """V + (p_wrong − p)/(ρ V): seen where no total pressure comes after the flag to put it right by itself."""
    true, news = course(surge=0.0, climb=climb), []
    settings = replace(SETTINGS, aided=replace(SETTINGS.aided, slope_rate=3.0))
    flown(true, settings=settings, shut=SHUT, news=news)
    flagged = news[0][0]
    rows = flown(true, settings=settings, shut=SHUT, deaf=(flagged - 5e-3, 9.0))
    before = errors(rows, true, flagged - 5e-3, flagged + 5e-3)[:, 0]
    after = errors(rows, true, flagged + 5e-3, flagged + 0.1)[:, 0]
    assert np.abs(before).max() > 0.12
    assert np.abs(after).max() < 0.06
