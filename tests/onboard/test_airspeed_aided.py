"""The aided filter's life: waiting, hand-over by replay, stroke, flight, gaps and what is no reading."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from uavsim import airdata
from uavsim.onboard import airspeed
from uavsim.onboard.airspeed import AidedFilter, AidedSettings, EstimatorSettings, JumpAdaptive, NoiseModel, PaperFilter

NAN, INF = math.nan, math.inf
STATIC, KELVIN = 101_325.0, 288.15
FLICKER = 1e-3  # Pa, of readings that are otherwise without noise: a real one never repeats for long
DENSITY = STATIC / (airdata.GAS_CONSTANT_DRY_AIR * KELVIN)
SETTINGS = EstimatorSettings(kind="aided", wind_sd=1.0)
NOISE = NoiseModel(1.2, 1.2, 0.0, total_window=8e-3, static_window=8e-3, accelerometer_sd=0.5)
REST, PUSH, START, STROKE = 2.5, 80.0, 2.0, 0.3  # m/s², m/s², s, s
COVERED = (0.3, 1.3)
DETECTED = START + 0.05


RISE = 0.02  # s
GRID = np.arange(0.0, 10.0, 1e-4)
FORCE = PUSH * np.clip(np.minimum(GRID - START, START + STROKE - GRID) / RISE, 0.0, 1.0)
SPEED = np.concatenate([[0.0], np.cumsum(0.5e-4 * (FORCE[1:] + FORCE[:-1]))])


def push_at(t):
    """A trapezoid, m/s²."""
    return float(np.interp(t, GRID, FORCE))


def speed_at(t):
    """To 22.4 m/s, then level cruise."""
    return float(np.interp(t, GRID, SPEED))


def mean_total(end, window, lag=0.0, static=STATIC):
    """Mean total pressure over a conversion."""
    times = np.linspace(end - lag - window, end - lag, 9)
    machs = np.array([speed_at(t) for t in times]) / airdata.speed_of_sound(KELVIN)
    total = np.mean(airdata.total_pressure(static=np.full(9, static), mach=machs))
    return float(total) + FLICKER * (round(1e4 * end) % 3)


def readings(until=4.0, offset=30.0, lag=0.0, membrane=0.0, noise=0.0, seed=1, rate=100.0):
    """(kind, time, …) of both sensors in the order of time; no noise but what is asked for."""
    generator = np.random.default_rng(seed)
    rows, static = [], STATIC
    for k in range(1, round(until * 1000.0) + 1):
        t = 0.001 * k
        push = push_at(t)
        slope = REST * min(1.0, max(0.0, 1.0 - (t - START - STROKE) / 1.0))  # level a second after the rail
        static -= DENSITY * speed_at(t) * slope * 0.001
        rows.append(("force", t, push + slope + generator.normal(0.0, 0.5 * bool(noise))))
        if k % round(1000.0 / rate) == 0:
            end = t - 0.002
            pushed = np.mean([push_at(x) for x in np.linspace(end - 8e-3, end, 9)])
            past = static + DENSITY * speed_at(t) * slope * 0.006
            total = mean_total(end, 8e-3, lag, past) + offset + membrane * pushed + generator.normal(0.0, noise)
            rows.append(("air", t, total, past + generator.normal(0.0, noise), end))
    return rows


def fly(estimator, rows, detected=DETECTED):
    """Estimates after each reading of the head."""
    found = []
    told = False
    for kind, t, *values in rows:
        if kind == "force":
            estimator.accelerometer(t, values[0], 0.0, -9.5)
            if t >= detected - 1e-9 and not told:
                estimator.launched(t)
                told = True
        else:
            found.append(estimator.step(t, values[0], values[1], KELVIN, values[2], values[2]))
    return found


def errors(found, start=DETECTED, end=INF):
    return np.array([row[1] - speed_at(row[0]) for row in found if start < row[0] <= end])


# -- launch ------------------------------------------------------------------------------------------------------------


def test_hand_over_knows_what_the_stroke_has_given_so_far():
    """80 m/s² for 50 ms, risen in 20, are 3.2 m/s at the recognition: the first estimate, 10 ms later, has them to 2 %.

    A filter started at the flag would miss all of it.
    """
    found = fly(AidedFilter(SETTINGS, NOISE, COVERED), readings())
    first = next(row for row in found if row[0] > DETECTED)
    assert speed_at(first[0]) > 3.2
    assert first[1] == pytest.approx(speed_at(first[0]), rel=0.02)
    assert abs(errors(found)).max() < 0.15
    assert abs(errors(found, 2.5)).max() < 0.05


def test_noisy_launch_is_within_what_is_claimed():
    """20 launches with noise as believed: mean NEES over the stroke, 0.25 s, within 0.4 … 1.9; far better than raw.

    An error of the stroke has the memory of some 0.1 s, so 50 independent squares; 4 deviations are 80 %.
    """
    squares, ours, raw = [], [], []
    for seed in range(20):
        found = fly(AidedFilter(SETTINGS, NOISE, COVERED), readings(until=2.6, noise=1.2, seed=seed))
        rows = [row for row in found if DETECTED < row[0] < START + STROKE]
        squares += [((row[1] - speed_at(row[0])) / row[2]) ** 2 for row in rows]
        ours += [row[1] - speed_at(row[0]) for row in rows]
        raw += [row[3] - speed_at(row[0]) for row in rows]
    assert 0.4 < np.mean(squares) < 1.9
    assert np.sqrt(np.mean(np.square(ours))) < 0.3 * np.sqrt(np.mean(np.square(raw)))


def test_before_the_launch_it_filters_the_pressures_alone():
    """Until it is told of a launch it is the jump-adaptive filter, tare and cover included, bit for bit."""
    rows = readings(until=1.9, noise=1.2)
    ours = fly(AidedFilter(SETTINGS, NOISE, COVERED), rows)
    theirs = fly(JumpAdaptive(SETTINGS, NOISE, COVERED), rows)
    np.testing.assert_array_equal(ours, theirs)
    assert all(row[1:3] == (0.0, 1.0) and not row[6] for row in ours if row[0] <= COVERED[1])


def test_lag_that_is_known_does_no_harm():
    """20 ms of tube lag are ρ V V̇ 20 ms = 2 kPa/s·20 ms, 1.6 m/s at 80 m/s²: modelled it leaves 0.15 m/s."""
    rows = readings(lag=0.020)
    known = fly(AidedFilter(SETTINGS, replace(NOISE, total_lag=0.020), COVERED), rows)
    unknown = fly(AidedFilter(SETTINGS, NOISE, COVERED), rows)
    stroke = (DETECTED + 0.05, START + STROKE)
    assert abs(errors(known, *stroke)).max() < 0.15
    assert abs(errors(unknown, *stroke)).max() > 0.5


def test_membranes_share_of_the_push():
    """0.2 Pa/(m/s²) are 16 Pa at 80 m/s²: known it is taken off; known to ±30 % it is learnt, not believed."""
    rows = readings(membrane=0.2)
    stroke = (DETECTED + 0.05, START + STROKE)
    ignorant = errors(fly(AidedFilter(SETTINGS, NOISE, COVERED), rows), *stroke)
    known = errors(
        fly(AidedFilter(SETTINGS, replace(NOISE, acceleration=0.2, acceleration_sd=0.06), COVERED), rows), *stroke
    )
    off = errors(
        fly(AidedFilter(SETTINGS, replace(NOISE, acceleration=0.14, acceleration_sd=0.06), COVERED), rows), *stroke
    )
    assert abs(ignorant).max() > 0.3
    assert abs(known).max() < 0.15
    assert abs(known).max() < 0.4 * abs(ignorant).max()
    assert abs(off).max() < 0.5 * abs(ignorant).max()


def test_climb_needs_no_attitude():
    """30 s at 28 m/s up a slope of 6°: f_x holds g·sin γ, and p_s falls; the airspeed stays within 0.05 m/s.

    With f_x alone it would run away by 1 m/s each second.
    """
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    fly(estimator, readings(until=4.0))
    slope = 9.80665 * math.sin(math.radians(6.0))
    speed = speed_at(4.0)
    static, found = estimator.energy.p, []
    for k in range(1, 30_001):
        t = 4.0 + 0.001 * k
        static -= static / (airdata.GAS_CONSTANT_DRY_AIR * KELVIN) * speed * slope * 0.001
        estimator.accelerometer(t, slope, 0.0, -9.7)
        if k % 10 == 0:
            past = static + DENSITY * speed * slope * 0.006
            total = airdata.total_pressure(static=past, mach=speed / airdata.speed_of_sound(KELVIN)) + 30.0
            found.append(estimator.step(t, total, past, KELVIN, t - 0.002, t - 0.002))
    late = [row for row in found if row[0] > 7.0]
    assert max(abs(row[1] - speed) for row in late) < 0.05
    assert max(abs(row[5] - static) for row in late[-1:]) < 2.0
    assert estimator.energy.s + estimator.energy.b == pytest.approx(slope, abs=0.02)
    assert estimator.energy.s == pytest.approx(slope, abs=0.15)


def test_rearmed_waits_again():
    """A knock is no launch: after it the filter is the jump-adaptive one, and the next launch is caught."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    rows = readings(noise=0.1)
    early = [row for row in rows if row[1] < 1.6]
    fly(estimator, early, detected=1.5)
    assert estimator.flying
    estimator.rearmed(1.6)
    assert not estimator.flying
    found = fly(estimator, [row for row in rows if row[1] > 1.6])
    assert estimator.flying
    assert abs(errors(found, 2.5)).max() < 0.3


def test_told_twice_changes_nothing():
    one, two = (AidedFilter(SETTINGS, NOISE, COVERED) for _ in range(2))
    first = fly(one, readings())
    two_rows = []
    for kind, t, *values in readings():
        if kind == "force":
            two.accelerometer(t, values[0], 0.0, 0.0)
            if t >= DETECTED - 1e-9:
                two.launched(t)
        else:
            two_rows.append(two.step(t, values[0], values[1], KELVIN, values[2], values[2]))
    np.testing.assert_array_equal(first, two_rows)


# -- gaps and nonsense -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("missing", [NAN, INF, -INF, 0.0, -5.0])
def test_missing_pressures_let_the_error_bar_grow(missing):
    """Coasting on the accelerometer: deviation grows, the airspeed stays; readings again bring it back."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    before = fly(estimator, readings(until=4.0))[-1]
    deviations = []
    for k in range(1, 4001):
        t = 4.0 + 0.001 * k
        estimator.accelerometer(t, 0.0, 0.0, -9.8)
        if k % 10 == 0:
            row = estimator.step(t, missing, missing, KELVIN, t, t)
            deviations.append(row[2])
            assert math.isnan(row[3])
            assert math.isnan(row[7])
    assert all(b > a for a, b in pairwise(deviations))
    assert deviations[-1] > 10.0 * before[2]
    assert row[1] == pytest.approx(before[1], abs=3.0 * row[2])
    for k in range(4001, 4501):
        t = 4.0 + 0.001 * k
        estimator.accelerometer(t, 0.0, 0.0, -9.8)
        if k % 10 == 0:
            total = mean_total(9.0 + 1e-4 * (k % 31), 0.0, 0.0, before[5]) + 30.0
            row = estimator.step(t, total, before[5] + 1e-3 * (k % 31), KELVIN, t, t)
    assert row[2] < 1.5 * before[2]
    assert row[1] == pytest.approx(speed_at(9.0), abs=0.1)


def test_total_pressure_alone_missing():
    """Static readings keep the height; the filter goes on in time, and the airspeed coasts."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    before = fly(estimator, readings(until=4.0))[-1]
    for k in range(1, 1001):
        t = 4.0 + 0.001 * k
        estimator.accelerometer(t, 0.0, 0.0, -9.8)
        if k % 10 == 0:
            row = estimator.step(t, NAN, before[5] + 1e-3 * (k % 31), KELVIN, t, t)
            assert math.isfinite(row[8])
    assert t - estimator.time < 0.05
    assert row[2] > 2.0 * before[2]


@pytest.mark.parametrize("kelvin", [NAN, 15.0, 0.0, -3.0, 500.0])
def test_a_temperature_that_is_none_keeps_the_last(kelvin):
    """Degrees Celsius by mistake are no temperature of air: the filter goes on with the last one."""
    usual, mistaken = (AidedFilter(SETTINGS, NOISE, COVERED) for _ in range(2))
    fly(usual, readings(until=4.0))
    fly(mistaken, readings(until=4.0))
    reading = 4.01, mean_total(4.0, 0.0) + 30.0, STATIC
    one, other = usual.step(*reading, KELVIN, 4.008, 4.008), mistaken.step(*reading, kelvin, 4.008, 4.008)
    assert other[1:3] == one[1:3]
    assert math.isnan(other[3])


def test_never_a_temperature_is_never_valid_or_raw():
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    for kind, t, *values in readings(until=2.5):
        if kind == "force":
            estimator.accelerometer(t, values[0], 0.0, 0.0)
            if t >= DETECTED:
                estimator.launched(t)
        else:
            row = estimator.step(t, values[0], values[1], 15.0, values[2], values[2])
            assert not row[6]
            assert math.isnan(row[3])


def test_static_port_in_other_air():
    """A static pressure that jumps by 45 Pa and stays is no spike: believed within 0.1 s, airspeed right again."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    static = fly(estimator, readings(until=4.0))[-1][5] + 45.0
    for k in range(1, 301):
        t = 4.0 + 0.001 * k
        estimator.accelerometer(t, 0.0, 0.0, -9.8)
        if k % 10 == 0:
            row = estimator.step(t, mean_total(9.0 + 1e-4 * (k % 31), 0.0, 0.0, static) + 30.0, static, KELVIN, t, t)
            assert k < 100 or abs(row[5] - static) < 5.0
    assert row[1] == pytest.approx(speed_at(9.0), abs=0.1)


def test_a_spike_is_not_taken():
    """300 Pa on one reading of either pressure leave the airspeed within 0.01 m/s of what it is without."""
    clean, total, static = (AidedFilter(SETTINGS, NOISE, COVERED) for _ in range(3))
    base, _, _ = (fly(f, readings(until=4.0))[-1] for f in (clean, total, static))
    reading = mean_total(9.0, 0.0, 0.0, base[5]) + 30.0
    expected = clean.step(4.01, reading, base[5], KELVIN, 4.008, 4.008)[1]
    assert total.step(4.01, reading + 300.0, base[5], KELVIN, 4.008, 4.008)[1] == pytest.approx(expected, abs=0.01)
    assert static.step(4.01, reading, base[5] - 300.0, KELVIN, 4.008, 4.008)[1] == pytest.approx(expected, abs=0.01)


def test_accelerometer_that_falls_silent():
    """Nothing for a second, as long as pressures come: the error bar is wider, the airspeed follows the pressures."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    before = fly(estimator, readings(until=4.0))[-1]
    for k in range(1, 101):
        t = 4.0 + 0.01 * k
        total = mean_total(9.0 + 1e-4 * (k % 31), 0.0, 0.0, before[5]) + 30.0
        row = estimator.step(t, total, before[5], KELVIN, t - 0.002, t - 0.002)
        assert abs(row[1] - speed_at(9.0)) < 0.3
    assert row[2] > before[2]


def test_times_that_do_not_increase_are_ignored():
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    fly(estimator, readings(until=4.0))
    assert estimator.step(4.0, 1e5, 1e5, KELVIN, 9.0, 9.0) is None
    assert estimator.step(NAN, 1e5, 1e5, KELVIN, 9.0, 9.0) is None
    estimator.accelerometer(3.0, 1e9, 0.0, 0.0)
    estimator.accelerometer(NAN, 1.0, 0.0, 0.0)
    row = estimator.step(4.01, mean_total(4.0, 0.0) + 30.0, STATIC, KELVIN, 4.008, 4.008)
    assert row[1] == pytest.approx(speed_at(9.0), abs=0.1)


def test_a_repeated_conversion_is_not_taken_again():
    """Polling at ten times the rate of the conversions tells the same at the end of each."""
    once, often = (AidedFilter(SETTINGS, NOISE, COVERED) for _ in range(2))
    expected = fly(once, readings(noise=1.2))
    found = []
    last = None
    for kind, t, *values in readings(noise=1.2):
        if kind == "force":
            often.accelerometer(t, values[0], 0.0, 0.0)
            if t >= DETECTED - 1e-9:
                often.launched(t)
            if last is not None and often.flying:
                often.step(t - 0.0004, last[0], last[1], KELVIN, last[2], last[2])
        else:
            last = values
            found.append(often.step(t, values[0], values[1], KELVIN, values[2], values[2]))
    np.testing.assert_allclose(
        [r[1] for r in found if r[0] > DETECTED], [r[1] for r in expected if r[0] > DETECTED], rtol=1e-12
    )


def test_what_waits_may_be_done_early_or_late():
    """`tidy` after each reading of the head, or never: bit for bit the same estimates, and the same flags."""
    rows = readings(until=9.0, noise=1.2)
    shut = next(row[2] for row in rows if row[0] == "air" and row[1] > 6.0)
    rows = [(kind, t, shut, *rest[1:]) if kind == "air" and t > 6.0 else (kind, t, *rest) for kind, t, *rest in rows]
    late = AidedFilter(SETTINGS, NOISE, COVERED)
    early = AidedFilter(SETTINGS, NOISE, COVERED)
    step, told = early.step, []

    def tidied(*reading):
        estimate = step(*reading)
        told.append(estimate)
        early.tidy()
        return estimate

    class Tidy:
        accelerometer, launched, step = property(lambda _: early.accelerometer), early.launched, staticmethod(tidied)

    one, other = fly(late, rows), fly(Tidy(), rows)
    late.tidy()
    assert repr(one) == repr(other)
    assert late.news == early.news
    assert [event[1:] for event in late.news] == [("airspeed_fault", "total", "stuck")]


def test_launch_without_any_reading_before():
    """Told of a launch out of nothing it starts where it is, says so by its error bar, and gets there."""
    estimator = AidedFilter(SETTINGS, NOISE)
    estimator.launched(1.0)
    row = estimator.step(1.01, NAN, NAN, NAN, NAN, NAN)
    assert not row[6]
    for k in range(1, 3001):
        t = 1.01 + 0.001 * k
        estimator.accelerometer(t, 0.0, 0.0, -9.81)  # level; 0 would be a fall, which the static port denies
        if k % 10 == 0:
            row = estimator.step(t, mean_total(9.0 + 1e-4 * (k % 31), 0.0), STATIC + 1e-3 * (k % 31), KELVIN, t, t)
    assert row[1] == pytest.approx(speed_at(9.0), abs=0.3)
    assert row[6]


def test_a_force_that_is_of_no_flight_ends_in_the_pressures_alone():
    """On a centrifuge at 15 g the filter went beyond every number; now it says so and goes by the pressures."""
    estimator = AidedFilter(SETTINGS, NOISE)
    estimator.launched(1.0)
    for k in range(1, 20_001):
        t = 1.0 + 0.001 * k
        estimator.accelerometer(t, 150.0, 0.0, -9.81)
        if k % 10 == 0:
            row = estimator.step(t, mean_total(9.0 + 1e-4 * (k % 31), 0.0), STATIC + 1e-3 * (k % 31), KELVIN, t, t)
    assert "diverged" in [kind for *_, kind in estimator.news]
    assert not estimator.flying
    assert row[1] == pytest.approx(speed_at(9.0), abs=0.3)
    assert row[5] == pytest.approx(STATIC, abs=1.0)


def test_what_waits_of_a_filter_that_has_diverged_is_left():
    """Its ports are not judged by an airspeed that was none: one event, and no exception."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    fly(estimator, readings(until=6.0, noise=1.2))
    estimator.tidy()
    estimator.energy.v = 1e6
    estimator.accelerometer(6.011, 0.0, 0.0, -9.8)
    estimator.step(6.011, STATIC + 300.0, STATIC, KELVIN, 6.01, 6.01)
    estimator.tidy()
    assert not estimator.flying
    assert [event[1:] for event in estimator.news] == [("airspeed_fault", "both", "diverged")]


def test_memory_is_constant():
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    for k in range(20_000):
        estimator.accelerometer(0.001 * k, 2.5, 0.0, 0.0)
        estimator.step(0.001 * k, STATIC, STATIC, KELVIN, 0.001 * k, 0.001 * k)
    assert len(estimator._hand_over.rows) == estimator._hand_over.rows.maxlen
    assert len(estimator._gained._t) == 1024


def test_readings_are_never_too_strange():
    """Anything finite or not, in any order, for 3000 readings: never an exception, and a deviation that is a number."""
    generator = np.random.default_rng(9)
    values = [NAN, INF, -INF, 0.0, -1.0, 1e-3, 1e9, STATIC, STATIC + 300.0]
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    fly(estimator, readings(until=4.0))
    t = 4.0
    for _ in range(3000):
        t += generator.choice([0.001, 0.01, 0.5, -0.1])
        estimator.accelerometer(t, generator.choice([0.0, NAN, 150.0, -INF, 3.0]), 0.0, 0.0)
        row = estimator.step(
            t, generator.choice(values), generator.choice(values), generator.choice([KELVIN, NAN, 15.0]),
            t - generator.choice([0.0, 0.3, -0.2]), t,
        )  # fmt: skip
        if row is not None:
            assert row[2] >= 0.0


# -- settings ----------------------------------------------------------------------------------------------------------


def test_build_makes_each_kind():
    kinds = {
        "paper": PaperFilter, "jump-adaptive": JumpAdaptive, "aided": AidedFilter,
        "constant-velocity": airspeed.ConstantVelocity, "paper-filterpy": airspeed.FilterpyFilter,
    }  # fmt: skip
    for kind, expected in kinds.items():
        assert type(airspeed.build(EstimatorSettings(kind=kind), NOISE)) is expected


def test_every_kind_takes_all_that_a_flight_computer_says():
    for kind in ("paper", "jump-adaptive", "constant-velocity", "paper-filterpy", "aided"):
        estimator = airspeed.build(EstimatorSettings(kind=kind), NOISE)
        estimator.accelerometer(0.0, 1.0, 0.0, 0.0)
        estimator.launched(0.0)
        estimator.rearmed(0.0)
        row = estimator.step(0.1, STATIC, STATIC, KELVIN, 0.1, 0.1)
        assert len(row) == 9


def test_more_gust_means_less_trust():
    calm, gusty = (
        fly(AidedFilter(replace(SETTINGS, aided=AidedSettings(gust_sd=sd)), NOISE, COVERED), readings())[-1][2]
        for sd in (0.2, 2.0)
    )
    assert gusty > 1.5 * calm


def test_temperature_widens_the_error_bar():
    """σ_V gains V σ_T/(2T)."""
    plain, doubted = (
        fly(AidedFilter(SETTINGS, replace(NOISE, temperature_sd=sd), COVERED), readings(until=4.5))[-1]
        for sd in (0.0, 0.5)
    )
    share = plain[1] * 0.5 / (2.0 * KELVIN)
    assert doubted[2] == pytest.approx(math.hypot(plain[2], share), rel=1e-9)


def test_a_replay_that_fails_leaves_the_pressures_and_says_when(monkeypatch):
    """What has been kept of before the launch cannot be filtered: flagged at the detection, by both channels."""
    estimator = AidedFilter(SETTINGS, NOISE, COVERED)
    fly(estimator, readings(until=2.0, noise=1.2))

    def fails(*row):
        raise ArithmeticError

    monkeypatch.setattr(type(estimator), "_fly", fails)
    estimator.launched(DETECTED)
    assert estimator.news == [(DETECTED, "airspeed_fault", "both", "diverged")]
    assert not estimator.flying
