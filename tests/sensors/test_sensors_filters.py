"""Low-passes against scipy, memory of a signal against its own definition."""

from itertools import pairwise
from math import inf, isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import cont2discrete, lfilter

from sensors.filters import DigitalFilter, History, lag, low_pass, one_pole, settled, two_pole

DT = 1e-3


def _through(a, m, values):
    """One axis of a signal behind a low-pass that has seen its first value for ever; the others carry its negatives."""
    stage = low_pass(a, m, (values[0], -values[0], 0.0))
    rows = [stage(value, -value, 0.0) for value in values[1:]]
    assert all(y == -x and z == 0.0 for x, y, z in rows)
    return np.array([values[0]] + [x for x, _, _ in rows])


def test_one_pole_is_the_first_order_hold():
    """Authority: scipy.signal.cont2discrete(method="foh")."""
    time_constant = 1 / (2 * np.pi * 52.0)
    numerator, denominator, _ = cont2discrete(([1.0], [time_constant, 1.0]), DT, method="foh")
    a, b0, b1 = one_pole(52.0, DT)
    assert (b1, b0) == pytest.approx(tuple(numerator.ravel()), rel=1e-9)
    assert (1.0, -a) == pytest.approx(tuple(denominator), rel=1e-12)


@pytest.mark.parametrize("bandwidth", [0.5, 20.0, 230.0, 3000.0])
@pytest.mark.parametrize("poles", [1, 2])
def test_low_passes_are_the_first_order_hold(bandwidth, poles):
    """Authority: scipy's first-order hold of 1/(1 + s/ω) and of Butterworth's ω²/(s² + √2 ω s + ω²), 1e-9 of 10."""
    omega = 2 * np.pi * bandwidth
    system = ([1.0], [1 / omega, 1.0]) if poles == 1 else ([1.0], [1 / omega**2, np.sqrt(2) / omega, 1.0])
    numerator, denominator, _ = cont2discrete(system, DT, method="foh")
    values = np.random.default_rng(1).uniform(-10.0, 10.0, 3000)
    values[0] = 0.0  # at rest before, as lfilter takes it
    a, m = lag(bandwidth, DT) if poles == 1 else two_pole(bandwidth, DT)
    assert _through(a, m, values) == pytest.approx(lfilter(numerator.ravel(), denominator, values), abs=1e-8)


@pytest.mark.parametrize(("poles", "phase"), [(1, np.pi / 4), (2, np.pi / 2)])
def test_low_passes_halve_the_power_at_their_bandwidth(poles, phase):
    """52 Hz through 52 Hz: 1/√2 of the amplitude, 45° or 90° late (steps of 10 µs, linear between: 1e-6)."""
    dt = 1e-5
    angle = 2 * np.pi * 52.0 * dt * np.arange(20_000)
    a, m = lag(52.0, dt) if poles == 1 else two_pole(52.0, dt)
    output = _through(a, m, np.sin(angle).tolist())
    assert output[10_000:] == pytest.approx(np.sin(angle - phase)[10_000:] / np.sqrt(2), abs=1e-5)


def test_one_pole_recursion_passes_half_the_power_at_its_frequency():
    dt = 1e-5
    a, b0, b1 = one_pole(52.0, dt)
    angle = 2 * np.pi * 52.0 * dt * np.arange(20_000)
    output, y = [0.0], 0.0
    for before, now in pairwise(np.sin(angle).tolist()):
        y = a * y + b0 * before + b1 * now
        output.append(y)
    assert output[10_000:] == pytest.approx(np.sin(angle - np.pi / 4)[10_000:] / np.sqrt(2), abs=1e-5)


@pytest.mark.parametrize("coefficients", [lag, two_pole])
def test_infinite_bandwidth_passes_everything(coefficients):
    values = np.random.default_rng(2).normal(size=50).tolist()
    assert _through(*coefficients(inf, DT), values).tolist() == values
    assert one_pole(inf, DT) == (0.0, 0.0, 1.0)


@given(st.floats(0.01, 1e5), st.sampled_from([lag, two_pole]), st.floats(-1e6, 1e6))
def test_a_steady_signal_comes_out_as_it_is(bandwidth, coefficients, value):
    """Exactly, from the first step on: what makes readings at rest the same in blocks and step by step."""
    assert set(_through(*coefficients(bandwidth, DT), [value] * 20).tolist()) == {value}


@pytest.mark.parametrize("coefficients", [lag, two_pole])
@pytest.mark.parametrize("bad", [nan, inf, -inf])
def test_low_pass_starts_again_after_what_is_no_number(coefficients, bad):
    stage = low_pass(*coefficients(20.0, DT), (1.0, 2.0, 3.0))
    stage(2.0, 2.0, 3.0)
    assert not np.isfinite(stage(bad, 2.0, 3.0)[0])
    x, y, z = stage(5.0, 2.0, 3.0)
    assert np.isfinite([x, y, z]).all()
    assert (y, z) == (2.0, 3.0)
    for _ in range(3):
        x, y, z = stage(5.0, 2.0, 3.0)
    assert (x, y, z) == (5.0, 2.0, 3.0)


def test_settled_keeps_numbers_only():
    assert (settled(0.5), settled(nan), settled(inf)) == (0.5, 0.0, 0.0)


# -- memory --------------------------------------------------------------------------------------------------------


def _history(values, longest=0.05):
    history = History(DT, longest, (values[0],) * 3)
    for value in values[1:]:
        history.keep((value, 2 * value, -value))
    return history


@given(st.floats(0.0, 0.05), st.integers(0, 100))
def test_history_is_linear_between_steps(age, seed):
    values = np.random.default_rng(seed).normal(size=80)
    times = DT * np.arange(80) - DT * 79
    expected = np.interp(-age, times, values)
    assert _history(values).at(age) == pytest.approx((expected, 2 * expected, -expected), abs=1e-9)


@given(st.floats(0.0, 0.02), st.floats(1e-4, 0.03), st.integers(0, 100))
def test_mean_over_a_window_is_the_integral(age, window, seed):
    """Authority: the trapezium rule, exact on each straight piece."""
    values = np.random.default_rng(seed).normal(size=80)
    times = DT * np.arange(80) - DT * 79
    edges = np.unique([*np.clip(times, -age - window, -age).tolist(), -age - window, -age])
    expected = np.trapezoid(np.interp(edges, times, values), edges) / window
    assert _history(values).mean(window, age) == pytest.approx((expected, 2 * expected, -expected), abs=1e-9)


def test_history_of_a_steady_signal_is_exact_and_before_the_first_step_it_was_the_same():
    history = History(DT, 0.02, (0.1, 0.2, 0.3))
    for age in (0.0, 0.0123, 0.02, 5.0):
        assert history.at(age) == (0.1, 0.2, 0.3)
        assert history.mean(0.0017, age) == (0.1, 0.2, 0.3)


def test_what_is_no_number_leaves_the_memory_with_time():
    history = _history([1.0, nan, 1.0, 1.0, 1.0])
    assert history.at(0.0005)[0] == 1.0
    assert history.mean(0.0015, 0.0)[0] == 1.0
    assert isnan(history.at(0.0025)[0])
    assert isnan(history.mean(0.003, 0.0)[0])


# -- digital filter ------------------------------------------------------------------------------------------------


def test_digital_filter_begins_with_its_first_input_and_again_after_nan():
    stage = DigitalFilter(0.25)
    assert [stage.step(x) for x in (8.0, 4.0)] == [8.0, 7.0]
    assert isnan(stage.step(nan))
    assert [stage.step(x) for x in (2.0, 6.0)] == [2.0, 3.0]


@pytest.mark.parametrize(("weight", "count"), [(1.0, 1), (0.5, 2), (0.25, 5), (0.125, 11), (0.0625, 22)])
def test_digital_filter_reaches_three_quarters_as_the_bmp280_does(weight, count):
    """BMP280 data sheet BST-BMP280-DS001-26, table 6: samples to reach at least 75 % of a step, coefficients 1 … 16."""
    stage = DigitalFilter(weight)
    stage.step(0.0)
    outputs = [stage.step(1.0) for _ in range(count)]
    assert outputs[-1] >= 0.75
    assert all(output < 0.75 for output in outputs[:-1])
