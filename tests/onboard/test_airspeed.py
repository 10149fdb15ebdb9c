"""The published airspeed filter: textbook identities, statistics of its output, and its defined effects.

Statistical tests have fixed seeds and two-sided intervals of 4 standard deviations (a false alarm in 16 000 seeds).
"""

import doctest
import math
import random
import subprocess
import sys

import numpy as np
import pydantic
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uavsim import airdata
from uavsim.onboard import airspeed
from uavsim.onboard.airspeed import (
    EstimatorSettings,
    NoiseModel,
    PaperFilter,
    RandomWalk,
    process_noise,
    steady_gain,
)
from uavsim.onboard.plausible import FASTEST

NAN, INF = math.nan, math.inf
STATIC = 101_325.0  # Pa
KELVIN = 288.15  # K
QUIET = NoiseModel(total_sd=3.7, static_sd=3.7, temperature_sd=0.0)
Q_TOTAL, Q_STATIC = 3.2 * 3.7**2, 0.09 / 0.7 * 3.7**2  # Pa², K²/(1 − K) R at gains of 0.8 and 0.3
DENSITY = airdata.moist_air_density(pressure=STATIC, temperature=KELVIN, compressibility=1.0)


def test_examples():
    assert doctest.testmod(airspeed).failed == 0


def total_at(speed):
    return airdata.total_pressure(static=STATIC, mach=speed / airdata.speed_of_sound(KELVIN))


def run(estimator, readings):
    """Estimates for (p_total, p_static) polled at 100 Hz, each a conversion of its own."""
    return [
        estimator.step(0.01 * k, p_total, p_static, KELVIN, 0.01 * k, 0.01 * k)
        for k, (p_total, p_static) in enumerate(readings, 1)
    ]


# -- the scalar filter -------------------------------------------------------------------------------------------------


@settings(derandomize=True, deadline=None)
@given(q=st.floats(1e-6, 1e6), r=st.floats(1e-6, 1e6))
def test_steady_gain_solves_its_equation(q, r):
    gain = steady_gain(q, r)
    assert gain * gain * r == pytest.approx((1.0 - gain) * q, rel=1e-6, abs=1e-9 * q)
    assert 0.0 < gain <= 1.0


@pytest.mark.parametrize(("gain", "ratio"), [(0.8, 3.2), (0.3, 0.09 / 0.7)])
def test_filter_settles_at_the_steady_gain(gain, ratio):
    """K²/(1 − K) = Q/R to 1e-6, and P settles at K·R."""
    r = 3.7**2
    assert steady_gain(ratio * r, r) == pytest.approx(gain, abs=1e-6)
    walk = RandomWalk(ratio * r, r)
    for _ in range(100):
        walk.add(STATIC)
    assert walk.variance == pytest.approx(gain * r, rel=1e-6)
    before = walk.value
    walk.add(STATIC + 1.0)
    assert walk.value - before == pytest.approx(gain, abs=1e-6)


@pytest.mark.parametrize("sd", [0.2, 3.7, 16.54])
def test_default_gains_are_those_of_the_sensor_that_is_described(sd):
    """0.8 and 0.3 whatever the part; doubted threefold the gain falls to the root of K²/(1 − K) = 3.2/9."""
    q_total, q_static = process_noise(EstimatorSettings(), NoiseModel(sd, 2.0 * sd, 0.0))
    assert steady_gain(q_total, sd**2) == pytest.approx(0.8, rel=1e-12)
    assert steady_gain(q_static, (2.0 * sd) ** 2) == pytest.approx(0.3, rel=1e-12)
    doubted = NoiseModel(3.0 * sd, 3.0 * sd, 0.0, total_tuned_sd=sd, static_tuned_sd=sd)
    q_doubted, _ = process_noise(EstimatorSettings(), doubted)
    assert q_doubted == pytest.approx(q_total, rel=1e-12)
    assert steady_gain(q_doubted, 9.0 * sd**2) == pytest.approx(
        (-3.2 + math.sqrt(3.2**2 + 36.0 * 3.2)) / 18.0, rel=1e-9
    )


def test_q_in_place_of_a_gain():
    settings = EstimatorSettings(q_total=875.5, q_static=2.0)
    assert process_noise(settings, NoiseModel(3.7, 3.7, 0.0)) == (875.5, 2.0)
    assert process_noise(EstimatorSettings(), NoiseModel(0.0, 0.0, 0.0)) == (1.0, 1.0)  # the gain is 1 with any


@pytest.mark.parametrize(("q", "r"), [(0.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (NAN, 1.0), (1.0, NAN)])
def test_steady_gain_refuses_what_is_no_variance(q, r):
    with pytest.raises(ValueError, match="q must be above 0"):
        steady_gain(q, r)


def test_without_noise_the_reading_is_the_state():
    assert steady_gain(1.0, 0.0) == 1.0
    walk = RandomWalk(1.0, 0.0)
    for reading in (5.0, 9.0, 2.0):
        walk.add(reading)
        assert (walk.value, walk.variance) == (reading, 0.0)


def test_constant_state_is_averaged():
    """Q → 0: the mean of all readings, with variance R/n (Gelb, Applied Optimal Estimation, example 4.2-1)."""
    readings = [100.0, 107.0, 95.5, 101.25, 99.0]
    walk = RandomWalk(1e-15, 4.0)
    for n, reading in enumerate(readings, 1):
        walk.add(reading)
        assert walk.value == pytest.approx(sum(readings[:n]) / n, rel=1e-13)
        assert walk.variance == pytest.approx(4.0 / n, rel=1e-13)


@settings(derandomize=True, deadline=None)
@given(
    q=st.floats(0.01, 100.0),
    r=st.floats(0.01, 100.0),
    readings=st.lists(st.one_of(st.floats(50.0, 150.0), st.just(NAN)), min_size=1, max_size=30),
)
def test_is_the_least_squares_estimate(q, r, readings):
    """The Kalman filter is weighted least squares over all readings and steps of the walk, solved here in one piece."""
    first = next((k for k, z in enumerate(readings) if not math.isnan(z)), None)
    walk = RandomWalk(q, r)
    for reading in readings:
        walk.add(reading)
    if first is None:
        assert math.isnan(walk.value)
        assert walk.variance == INF
        return
    kept = readings[first:]
    size = len(kept)
    information, pull = np.zeros((size, size)), np.zeros(size)
    for k, reading in enumerate(kept):
        if not math.isnan(reading):
            information[k, k] += 1.0 / r
            pull[k] += reading / r
        if k:
            information[k - 1 : k + 1, k - 1 : k + 1] += np.array([[1.0, -1.0], [-1.0, 1.0]]) / q
    assert walk.value == pytest.approx(np.linalg.solve(information, pull)[-1], rel=1e-7)
    assert walk.variance == pytest.approx(np.linalg.inv(information)[-1, -1], rel=1e-7)


@pytest.mark.parametrize("gain", [0.8, 0.3])
def test_white_noise_on_a_constant(gain):
    """The output is first order with φ = 1 − K: its rms is √(K/(2 − K)) of the reading's, and NEES 1/(2 − K).

    n = 40 000; the relative deviation of a mean square of such a sequence is √(2/n·(1 + φ²)/(1 − φ²)); 4 of them is
    3.1 % of variance for K = 0.8 and 4.8 % for 0.3.
    """
    n, sd, level = 40_000, 3.7, 1000.0
    walk = RandomWalk(gain**2 / (1.0 - gain) * sd**2, sd**2)
    noise = np.random.default_rng(7).normal(0.0, sd, n + 100)
    errors = []
    for z in noise.tolist():
        walk.add(level + z)
        errors.append(walk.value - level)
    square = np.mean(np.square(errors[100:]))
    phi = 1.0 - gain
    spread = math.sqrt(2.0 / n * (1.0 + phi**2) / (1.0 - phi**2))
    assert square / sd**2 == pytest.approx(gain / (2.0 - gain), rel=4.0 * spread)
    assert square / walk.variance == pytest.approx(1.0 / (2.0 - gain), rel=4.0 * spread)


@pytest.mark.parametrize(("noise", "belief"), [(1.0, 1.0), (3.0, 3.0), (3.0, 1.0), (1.0, 3.0)])
def test_nis_is_one_where_the_filter_believes_the_truth(noise, belief):
    """A walk of the default Q read through 3.7 Pa times `noise` by a filter that believes 3.7 Pa times `belief`.

    Right, innovations are white: n = 40 000, 4 deviations of a mean of χ²₁ are 4 √(2/n) = 2.8 %. Wrong, NIS is off by
    more than a factor of 1.5 either way (its own value by the Riccati equation of the wrong filter, to 5 %).
    """
    n, q, r = 40_000, 43.8, 3.7**2
    generator = np.random.default_rng(13)
    truth = 1e5 + np.cumsum(generator.normal(0.0, math.sqrt(q), n))
    readings = truth + generator.normal(0.0, noise * math.sqrt(r), n)
    walk = RandomWalk(q, belief**2 * r)
    nis = []
    for z in readings.tolist():
        walk.add(z)
        nis.append(walk.nis)
    assert math.isnan(nis[0])
    mean = np.mean(nis[100:])
    gain = steady_gain(q, belief**2 * r)
    error = (q * (1.0 - gain) ** 2 + gain**2 * noise**2 * r) / (1.0 - (1.0 - gain) ** 2)  # variance of x − truth
    expected = (error + q + noise**2 * r) / (belief**2 * r / (1.0 - gain))
    assert mean == pytest.approx(expected, rel=0.05)
    if noise == belief:
        assert expected == pytest.approx(1.0, rel=1e-9)
        assert mean == pytest.approx(1.0, rel=0.028)
    else:
        assert abs(math.log(mean)) > math.log(1.5)


def test_a_missing_reading_has_no_nis():
    walk = RandomWalk(43.8, 3.7**2)
    for z in (1e5, 1e5 + 1.0, math.nan):
        walk.add(z)
    assert math.isnan(walk.nis)


def test_consistent_on_a_random_walk():
    """On the truth that it believes in NEES is 1: n = 40 000 of φ = 1 − K = 0.2; 4 deviations are 3 %."""
    n, q, r = 40_000, 3.2, 1.0
    generator = np.random.default_rng(11)
    truth = 1e4 + np.cumsum(generator.normal(0.0, math.sqrt(q), n))
    readings = truth + generator.normal(0.0, math.sqrt(r), n)
    walk = RandomWalk(q, r)
    errors = []
    for z, x in zip(readings.tolist(), truth.tolist(), strict=True):
        walk.add(z)
        errors.append(walk.value - x)
    spread = math.sqrt(2.0 / n * (1.0 + 0.2**2) / (1.0 - 0.2**2))
    assert np.mean(np.square(errors)) / walk.variance == pytest.approx(1.0, rel=4.0 * spread)


# -- airspeed ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_airspeed_is_that_of_the_filtered_pressures(model):
    options = {"vapour_fraction": 0.02, "calibration": 0.97, "model": model}
    estimator = PaperFilter(EstimatorSettings(**options), QUIET)
    generator = random.Random(5)
    readings = [
        (total_at(5.0 + 0.1 * k) + generator.gauss(0.0, 3.7), STATIC + generator.gauss(0.0, 3.7)) for k in range(300)
    ]
    total, static = RandomWalk(Q_TOTAL, 3.7**2), RandomWalk(Q_STATIC, 3.7**2)
    for k, ((p_total, p_static), row) in enumerate(zip(readings, run(estimator, readings), strict=True), 1):
        total.add(p_total)
        static.add(p_static)
        t, speed, _, raw, filtered_total, filtered_static, *_ = row
        assert (t, filtered_total, filtered_static) == pytest.approx((0.01 * k, total.value, static.value), rel=1e-13)
        assert speed == pytest.approx(
            airdata.airspeed(total=total.value, static=static.value, temperature=KELVIN, **options), rel=1e-12
        )
        assert raw == pytest.approx(
            airdata.airspeed(total=p_total, static=p_static, temperature=KELVIN, **options), rel=1e-12
        )


@pytest.mark.parametrize("speed", [10.0, 40.0, 204.0, 300.0])
@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_deviation_is_the_propagated_one(model, speed):
    """Far above V* it is √Σ(∂V/∂·)²·variance, with the derivatives taken numerically.

    Relative 3e-5: the gas constants of ISO 2533 and CIPM-2007 differ by 1.8e-5.
    """
    options = {"model": model, "calibration": 1.1, "vapour_fraction": 0.01}
    noise = NoiseModel(total_sd=0.5, static_sd=0.3, temperature_sd=0.7)
    point = {"total": total_at(speed), "static": STATIC, "temperature": KELVIN}
    row = PaperFilter(EstimatorSettings(**options), noise).step(1.0, *point.values(), 1.0, 1.0)
    variance = 0.0
    for (name, value), sd in zip(point.items(), (0.5, 0.3, 0.7), strict=True):
        step = 1e-6 * value
        ends = [airdata.airspeed(**point | {name: value + h}, **options) for h in (-step, step)]
        variance += ((ends[1] - ends[0]) / (2.0 * step) * sd) ** 2
    assert row[2] == pytest.approx(math.sqrt(variance), rel=3e-5)
    assert row[6] is (row[1] <= FASTEST)  # 363 m/s by Bernoulli with this calibration is none


# rms error of the clipped root in V* at V/V* = 0, 0.5 … 2: an independent numerical study of the Gaussian's root.
@pytest.mark.parametrize(
    ("ratio", "rms"), [(0.0, 0.63), (0.5, 0.51), (0.75, None), (1.0, 0.53), (1.5, 0.38), (2.0, 0.26), (3.0, None)]
)
@pytest.mark.parametrize("sd", [0.3, 3.7])
def test_deviation_near_zero(sd, ratio, rms):
    """What the filter claims is the rms error of its airspeed to −6…+13 %, for every airspeed, V = 0 included.

    n = 8000 single readings each; 4 deviations of the rms are 3.2 % (0.02 of the study's two digits on top).
    """
    generator = random.Random(round(1000 * ratio))
    star = math.sqrt(2.0 * math.sqrt(2.0) * sd / DENSITY)
    truth = ratio * star
    total = total_at(truth)
    noise = NoiseModel(sd, sd, 0.0)
    square = claimed = 0.0
    n = 8000
    for _ in range(n):
        estimator = PaperFilter(EstimatorSettings(wind_sd=99.0), noise)
        reading = total + generator.gauss(0.0, sd), STATIC + generator.gauss(0.0, sd)
        _, speed, speed_sd, *_ = estimator.step(0.0, *reading, KELVIN, 0.0, 0.0)
        square += (speed - truth) ** 2
        claimed += speed_sd**2
    root = math.sqrt(square / n)
    if rms is not None:
        assert root / star == pytest.approx(rms, abs=0.032 * rms + 0.01)
    assert 0.94 / 1.032 < math.sqrt(claimed / square) < 1.13 * 1.032


def test_validity_begins_at_twice_v_star():
    sd = 2.0
    star = math.sqrt(2.0 * math.sqrt(2.0) * sd / DENSITY)
    settings_ = EstimatorSettings(model="bernoulli", wind_sd=1.0)
    for ratio, valid in ((0.0, False), (1.99, False), (2.01, True), (10.0, True)):
        total = STATIC + 0.5 * DENSITY * (ratio * star) ** 2
        row = PaperFilter(settings_, NoiseModel(sd, sd, 0.0)).step(0.0, total, STATIC, KELVIN, 0.0, 0.0)
        assert row[1] == pytest.approx(ratio * star, abs=1e-6)
        assert row[6] is valid
    below = PaperFilter(settings_, NoiseModel(sd, sd, 0.0)).step(0.0, STATIC - 9.0, STATIC, KELVIN, 0.0, 0.0)
    assert below[1:4] == (0.0, 1.0, 0.0)  # clipped, and no worse known than the wind


def test_wind_bounds_the_deviation_below_v_star_only():
    """Above V* the pressures speak, and their deviation V*²/(2·V) may exceed the wind's."""
    sd, wind = 30.0, 2.0
    star = math.sqrt(2.0 * math.sqrt(2.0) * sd / DENSITY)
    settings_ = EstimatorSettings(model="bernoulli", wind_sd=wind)
    for ratio, expected in ((0.99, wind), (1.01, star / 2.02)):
        total = STATIC + 0.5 * DENSITY * (ratio * star) ** 2
        row = PaperFilter(settings_, NoiseModel(sd, sd, 0.0)).step(0.0, total, STATIC, KELVIN, 0.0, 0.0)
        assert row[2] == pytest.approx(expected, rel=2e-3)  # p_t/p_s is 1.0005


def test_sensors_without_noise():
    estimator = PaperFilter(EstimatorSettings(), NoiseModel(0.0, 0.0, 0.0))
    assert estimator.step(0.0, STATIC, STATIC, KELVIN, 0.0, 0.0)[1:3] == (0.0, 0.0)
    _, speed, sd, raw, _, _, valid, *_ = estimator.step(0.1, total_at(30.0), STATIC, KELVIN, 0.1, 0.1)
    assert (speed, raw) == (pytest.approx(30.0, rel=1e-9), speed)
    assert (sd, valid) == (0.0, True)


# -- tare and cover ----------------------------------------------------------------------------------------------------


def test_tare_removes_the_pairs_offset():
    """+50 Pa between the sensors; the tare is the mean over start < t ≤ end, and covers both airspeeds."""
    estimator = PaperFilter(EstimatorSettings(), QUIET, (0.10, 0.20))
    offset = [50.0] * 10 + [52.0] * 5 + [56.0] * 5 + [54.0] * 40  # at t = 0.01 … 0.60
    rows = run(estimator, [(STATIC + d, STATIC) for d in offset])
    for row in rows[:20]:
        assert (row[1], row[2], row[6]) == (0.0, 3.0, False)
        assert row[3] > 8.0  # what the offset alone reads
    assert rows[20][4] == pytest.approx(STATIC + 54.0 - 54.0, abs=3.0)
    assert rows[-1][4] == pytest.approx(STATIC, abs=1e-9)
    assert all(row[3] == 0.0 for row in rows[20:])
    flying = estimator.step(1.5, total_at(30.0) + 54.0, STATIC, KELVIN, 1.5, 1.5)
    assert flying[3] == pytest.approx(30.0, abs=1e-9)


def test_filter_is_the_same_with_and_without_an_offset():
    """A tare measured without noise leaves nothing of the offset, in the raw and the filtered path."""
    generator = random.Random(2)
    noise = [(generator.gauss(0.0, 3.7), generator.gauss(0.0, 3.7)) for _ in range(200)]
    rows = []
    for offset in (0.0, 64.0):
        still = [(STATIC + offset, STATIC)] * 50
        moving = [(total_at(20.0) + offset + a, STATIC + b) for a, b in noise]
        rows.append(run(PaperFilter(EstimatorSettings(), QUIET, (0.0, 0.5)), still + moving)[50:])
    np.testing.assert_allclose(rows[0], rows[1], rtol=1e-10)


@pytest.mark.parametrize("count", [1, 25, 100])
def test_tare_adds_its_variance(count):
    """Mean of n pairs of white noise: (R_t + R_s)/n more variance of p_t − p_s, at Bernoulli's 1/(ρ·V)."""
    noise = NoiseModel(3.0, 4.0, 0.0)
    plain = EstimatorSettings(model="bernoulli")
    end = 0.01 * count + 0.001
    still = [(STATIC, STATIC)] * count
    moving = [(STATIC + 0.5 * DENSITY * 30.0**2, STATIC)] * 60
    tared = run(PaperFilter(plain, noise, (0.0, end)), still + moving)[-1]
    untared = run(PaperFilter(plain, noise), still + moving)[-1]
    slope = 1.0 / (DENSITY * 30.0)
    assert tared[2] ** 2 - untared[2] ** 2 == pytest.approx(slope**2 * (9.0 + 16.0) / count, rel=1e-6)


def test_tare_passes_over_what_is_missing_and_counts_conversions():
    estimator = PaperFilter(EstimatorSettings(model="bernoulli"), QUIET, (0.0, 0.1))
    polls = [(STATIC + 10.0, 0.01), (NAN, 0.02), (STATIC + 20.0, 0.03), (STATIC + 20.0, 0.03), (STATIC + 30.0, 0.04)]
    for k, (p_total, t_total) in enumerate(polls):
        estimator.step(0.02 * (k + 1), p_total, STATIC, KELVIN, t_total, 0.02 * (k + 1))
    row = estimator.step(0.2, total_at(30.0) + 20.0, STATIC, KELVIN, 0.2, 0.2)
    assert row[3] == pytest.approx(
        airdata.airspeed(total=total_at(30.0), static=STATIC, temperature=KELVIN, model="bernoulli"), rel=1e-12
    )


def test_tare_without_a_reading_is_zero():
    estimator = PaperFilter(EstimatorSettings(), QUIET, (5.0, 6.0))
    assert estimator.step(5.5, NAN, STATIC, KELVIN, 5.5, 5.5)[1] == 0.0
    row = estimator.step(6.1, total_at(30.0), STATIC, KELVIN, 6.1, 6.1)
    assert row[3] == pytest.approx(30.0, abs=1e-9)


# -- gaps, repeats and missing readings --------------------------------------------------------------------------------


def test_times_that_do_not_increase_are_ignored():
    estimator = PaperFilter(EstimatorSettings(), QUIET)
    reading = total_at(30.0), STATIC, KELVIN
    first = estimator.step(1.0, *reading, 1.0, 1.0)
    for t in (1.0, 0.5, NAN):
        assert estimator.step(t, 2.0 * STATIC, STATIC, KELVIN, 9.0, 9.0) is None
    again = estimator.step(1.1, *reading, 1.0, 1.0)
    assert again[1:] == first[1:]


def test_a_repeated_conversion_is_not_taken_again():
    """Polling at ten times the conversion rate gives the estimates of polling each conversion once."""
    generator = random.Random(8)
    once, often = (PaperFilter(EstimatorSettings(), QUIET, (0.0, 0.3)) for _ in range(2))
    for k in range(1, 200):
        reading = total_at(20.0) + generator.gauss(0.0, 3.7), STATIC + generator.gauss(0.0, 3.7), KELVIN
        expected = once.step(0.1 * k, *reading, 0.1 * k, 0.1 * k)
        for poll in range(10):
            row = often.step(0.1 * k + 0.01 * poll, *reading, 0.1 * k, 0.1 * k)
            assert row[1:3] == pytest.approx(expected[1:3], rel=1e-12)
            assert row[4:6] == pytest.approx(expected[4:6], rel=1e-12)


def test_channels_convert_at_their_own_rates():
    """Static every poll, total every third: each is filtered over its own conversions."""
    estimator = PaperFilter(EstimatorSettings(), QUIET)
    total, static = RandomWalk(Q_TOTAL, 3.7**2), RandomWalk(Q_STATIC, 3.7**2)
    generator = random.Random(4)
    for k in range(1, 100):
        t = 0.01 * k
        if k % 3 == 1:
            t_total, p_total = t, total_at(25.0) + generator.gauss(0.0, 3.7)
            total.add(p_total)
        p_static = STATIC + generator.gauss(0.0, 3.7)
        static.add(p_static)
        row = estimator.step(t, p_total, p_static, KELVIN, t_total, t)
        assert row[4:6] == pytest.approx((total.value, static.value), rel=1e-13)


@pytest.mark.parametrize("missing", [NAN, INF, 0.0, -5.0])
def test_a_missing_pressure_lets_the_variance_grow(missing):
    estimator = PaperFilter(EstimatorSettings(), QUIET)
    before = run(estimator, [(total_at(30.0), STATIC)] * 50)[-1]
    deviations = [before[2]]
    for k in range(51, 60):
        row = estimator.step(0.01 * k, missing, STATIC, KELVIN, 0.01 * k, 0.01 * k)
        assert row[1] == pytest.approx(before[1], rel=1e-12)
        assert math.isnan(row[3])
        deviations.append(row[2])
    growth = np.diff(np.square(deviations))
    # Q a sample, at the slope 1/(ρ₀·V); the static channel stays settled.
    stagnation = DENSITY * (total_at(30.0) / STATIC) ** (1.0 / 1.4)
    assert growth == pytest.approx(Q_TOTAL / (stagnation * 30.0) ** 2, rel=1e-4)


def test_a_missing_temperature_keeps_the_last():
    estimator = PaperFilter(EstimatorSettings(), QUIET)
    reading = total_at(30.0), STATIC
    for k, kelvin in enumerate((NAN, 0.0)):
        row = estimator.step(0.1 * k, *reading, kelvin, 0.1 * k, 0.1 * k)
        assert row[1:3] == (0.0, 3.0)
        assert math.isnan(row[3])
        assert row[6] is False
    first = estimator.step(0.3, *reading, KELVIN, 0.3, 0.3)
    later = estimator.step(0.4, *reading, NAN, 0.4, 0.4)
    assert first[1] == later[1] == pytest.approx(30.0, rel=1e-9)
    assert first[3] == pytest.approx(30.0, rel=1e-9)
    assert math.isnan(later[3])


def test_before_the_first_pair_the_airspeed_is_zero():
    estimator = PaperFilter(EstimatorSettings(wind_sd=2.5), QUIET)
    for t, p_total, p_static in ((0.1, NAN, NAN), (0.2, STATIC, NAN), (0.3, NAN, NAN)):
        row = estimator.step(t, p_total, p_static, KELVIN, t, t)
        assert row[1:3] == (0.0, 2.5)
        assert row[6] is False
    assert estimator.step(0.4, NAN, STATIC, KELVIN, 0.4, 0.4)[5] == STATIC


def test_head_that_has_not_converted_yet():
    """A head's rows before its first conversion hold NaN times as well; nothing is filtered."""
    estimator = PaperFilter(EstimatorSettings(), QUIET)
    assert estimator.step(0.1, NAN, NAN, NAN, NAN, NAN)[1:3] == (0.0, 3.0)
    row = estimator.step(0.2, total_at(30.0), STATIC, KELVIN, 0.15, 0.15)
    assert row[1] == row[3] == pytest.approx(30.0, rel=1e-9)


# -- filterpy ----------------------------------------------------------------------------------------------------------


def test_equals_filterpy():
    """3000 noisy readings from rest to 40 m/s with missing values, repeats, late rows and a tare: equal to 1e-9."""
    generator = random.Random(20)
    noise = NoiseModel(3.7, 2.4, 0.4)
    ours = airspeed.build(EstimatorSettings(kind="paper", vapour_fraction=0.01), noise, (0.5, 2.0))
    theirs = airspeed.build(EstimatorSettings(kind="paper-filterpy", vapour_fraction=0.01), noise, (0.5, 2.0))
    assert type(ours) is PaperFilter
    assert type(theirs) is airspeed.FilterpyFilter
    t, t_total, t_static = 0.0, NAN, NAN
    p_total = p_static = NAN
    valid = 0
    for k in range(3000):
        t += generator.choice((0.01, 0.01, 0.011, 0.05, -0.02))
        if generator.random() < 0.7:
            t_total, p_total = t, total_at(min(40.0, 0.02 * max(0, k - 200))) + 30.0 + generator.gauss(0.0, 3.7)
        if generator.random() < 0.8:
            t_static, p_static = t, STATIC + generator.gauss(0.0, 2.4)
        values = [v if generator.random() < 0.95 else NAN for v in (p_total, p_static, KELVIN)]
        one, other = (f.step(t, *values, t_total, t_static) for f in (ours, theirs))
        if one is None:
            assert other is None
        else:
            np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9, equal_nan=True)
            valid += one[6]
    assert valid > 1000


# -- settings and independence -----------------------------------------------------------------------------------------


def test_settings_validate():
    adapter = pydantic.TypeAdapter(EstimatorSettings)
    assert adapter.validate_python({}) == EstimatorSettings()
    read = adapter.validate_python({"kind": "paper-filterpy", "model": "bernoulli", "q_total": 875.5})
    assert (read.model, read.q_total) == ("bernoulli", 875.5)
    for wrong in ({"model": "newton"}, {"q_total": 0.0}, {"wind_sd": -1.0}, {"calibration": 0.0}):
        with pytest.raises(pydantic.ValidationError):
            adapter.validate_python(wrong)
    with pytest.raises(pydantic.ValidationError):
        pydantic.TypeAdapter(NoiseModel).validate_python({"total_sd": -1.0, "static_sd": 1.0, "temperature_sd": 0.0})


def test_onboard_knows_no_truth():
    """Importing and stepping both parts loads nothing of plants, sensors or truth, nor what is heavy."""
    code = """
import sys
from uavsim.onboard import airspeed, launch
launch.default().step(0.0, 1.0, 0.0, 0.0)
airspeed.build(airspeed.EstimatorSettings(), airspeed.NoiseModel(1.0, 1.0, 0.1)).step(0.0, 1e5, 1e5, 288.0, 0.0, 0.0)
foreign = "uavsim.truth uavsim.plants sensors jsbsim pandas scipy filterpy matplotlib pydantic".split()
print(*(name for name in foreign if name in sys.modules))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
