"""Noise processes against their theory: variances, recursions, spectra, Allan deviations, and their whole domain."""

from itertools import islice
from math import log, pi, sqrt

import allantools
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, signal

from sensors import noise

BENDS = [(1.0, 1000.0), (100.0, 833.0), (300.0, 1000.0), (498.0, 1000.0), (400.0, 1666.0)]  # bandwidth, rate, Hz


def _blocks(source, count):
    return np.concatenate(list(islice(source, count)))


def _allan(source, m, pairs):
    """Return the Allan deviation at m samples from `pairs` pairs of neighbouring means or more, all axes, streamed."""
    held, squares, count = None, 0.0, 0
    while count < pairs:
        block = next(source)
        held = block if held is None else np.concatenate((held, block))
        whole = len(held) // m
        if whole < 2:
            continue
        means = held[: whole * m].reshape(whole, m, -1).mean(axis=1)
        squares += np.sum(np.diff(means, axis=0) ** 2)
        count += (whole - 1) * means.shape[1]
        held = held[(whole - 1) * m :]  # the last mean is the first of the next pair
    return sqrt(squares / count / 2.0)


def _coefficients(bandwidth, rate, poles):
    """Return (b, a) of the low-pass, from scipy for two poles and by bisection on |H|² = 1/2 for one."""
    if poles == 2:
        return signal.butter(2, bandwidth, fs=rate)
    z = np.exp(2j * pi * bandwidth / rate)
    low, high = 0.0, 1.0
    for _ in range(100):
        weight = 0.5 * (low + high)
        passed = abs(weight / (1.0 - (1.0 - weight) / z)) ** 2
        low, high = (weight, high) if passed < 0.5 else (low, weight)
    return np.array([weight]), np.array([1.0, weight - 1.0])


def test_white_noise_has_its_standard_deviation_and_no_memory():
    """n = 204 800 an axis; limits at 4 sigma of the estimate, so 1 % in sigma is caught; 6 in 100 000 by chance."""
    values = _blocks(noise.white(np.random.default_rng(1), [2.0, 3.0]), 200)
    n = len(values)
    assert values.std(axis=0) / [2.0, 3.0] == pytest.approx([1, 1], abs=4 / np.sqrt(2 * n))
    lag_one = np.mean(values[1:] * values[:-1], axis=0) / values.var(axis=0)
    assert np.all(np.abs(lag_one) < 4 / np.sqrt(n))


def test_gauss_markov_is_its_recursion_across_blocks():
    """Authority: b_k = φ b_{k-1} + s √(1 - φ²) ξ_k written out, on the same ξ; to rounding."""
    s, tau, dt = 0.7, 3.0, 0.01
    values = _blocks(noise.gauss_markov(np.random.default_rng(2), s, tau, dt, axes=2), 3)
    xi = np.random.default_rng(2).standard_normal((3 * noise.BLOCK, 2))
    phi = np.exp(-dt / tau)
    level, expected = np.zeros(2), []
    for row in xi:
        expected.append(level)
        level = phi * level + s * np.sqrt(1 - phi**2) * row
    assert values == pytest.approx(np.array(expected), abs=1e-12)


def test_gauss_markov_variance_grows_to_its_stationary_value():
    """Var b(t) = s² (1 - e^{-2t/τ}) from zero. n = 2000 paths, limits at 4 sigma: 13 % in variance is caught."""
    s, tau, dt, paths = 2.0, 1.0, 0.01, 2000
    values = next(noise.gauss_markov(np.random.default_rng(3), s, tau, dt, axes=paths))
    assert not values[0].any()
    for k in (5, 50, 100, 1000):
        expected = s**2 * (1 - np.exp(-2 * k * dt / tau))
        assert values[k].var() / expected == pytest.approx(1, abs=4 * np.sqrt(2 / paths))


def test_random_walk_has_variance_k_squared_t():
    """Var r(t) = K² t. n = 2000 paths, limits at 4 sigma; increments of one path across blocks have K √dt."""
    intensity, dt, paths = 0.3, 0.02, 2000
    values = _blocks(noise.random_walk(np.random.default_rng(4), intensity, dt, axes=paths), 2)
    assert not values[0].any()
    for k in (1, 100, 1024, 2000):
        assert values[k].var() / (intensity**2 * k * dt) == pytest.approx(1, abs=4 * np.sqrt(2 / paths))
    steps = np.diff(values, axis=0)
    assert steps.std() / (intensity * np.sqrt(dt)) == pytest.approx(1, abs=4 / np.sqrt(2 * steps.size))


def test_rows_sum_and_scale_sample_by_sample():
    step = noise.rows((noise.constant([1.0, 2.0]), noise.white(np.random.default_rng(5), [1.0, 1.0])), scale=10.0)
    expected = 10 * (np.random.default_rng(5).standard_normal((1024, 2)) + np.array([1.0, 2.0]))
    assert np.array([step() for _ in range(1024)]) == pytest.approx(expected, rel=1e-15)


# -- equivalent noise bandwidth --------------------------------------------------------------------------------------


@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize(("bandwidth", "rate"), BENDS)
def test_enbw_is_the_integral_of_the_response(bandwidth, rate, poles):
    """Authority: ∫ |H|² df from 0 to rate/2, H of scipy's own design; to 1e-9."""
    b, a = _coefficients(bandwidth, rate, poles)
    passed, _ = integrate.quad(
        lambda f: abs(signal.freqz(b, a, worN=[f], fs=rate)[1][0]) ** 2,
        0.0,
        rate / 2.0,
        points=[bandwidth],
        limit=200,
    )
    assert noise.enbw(bandwidth, rate, poles) == pytest.approx(passed, rel=1e-9)


def test_enbw_far_below_the_rate_is_that_of_the_continuous_filter():
    assert noise.enbw(1.0, 1e6, 1) == pytest.approx(pi / 2, rel=1e-5)
    assert noise.enbw(1.0, 1e6, 2) == pytest.approx(pi / (2 * sqrt(2)), rel=1e-5)


@pytest.mark.parametrize("poles", [1, 2])
def test_a_bandwidth_from_half_the_rate_on_takes_nothing_away(poles):
    for bandwidth in (416.5, 500.0, float("inf")):
        assert noise.enbw(bandwidth, 833.0, poles) == 416.5
        plain = next(noise.white(np.random.default_rng(8), [1.0, 2.0]))
        assert np.array_equal(next(noise.shaped(np.random.default_rng(8), [1.0, 2.0], bandwidth, 833.0, poles)), plain)


# -- shaped noise ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize(("bandwidth", "rate"), BENDS)
def test_shaped_noise_is_the_filtered_white_noise(bandwidth, rate, poles):
    """Authority: scipy.signal.lfilter on the same ξ, over three blocks; what is left is the start's free response."""
    sd = np.array([2.0, 3.0])
    values = _blocks(noise.shaped(np.random.default_rng(9), sd, bandwidth, rate, poles), 3)
    generator = np.random.default_rng(9)
    generator.standard_normal((2, 2))  # the state at the start
    xi = np.hstack([generator.standard_normal((2, noise.BLOCK)) for _ in range(3)]) * sd[:, np.newaxis]
    b, a = _coefficients(bandwidth, rate, poles)
    left = values.T - signal.lfilter(b, a, xi)
    driven = np.array([np.convolve(a, row, mode="valid") for row in left])  # a free response obeys A(z) y = 0
    assert np.abs(driven).max() < 1e-12 * np.abs(values).max()


@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize(("bandwidth", "rate"), [(1.0, 1000.0), (100.0, 833.0), (400.0, 833.0)])
def test_shaped_noise_has_its_variance_and_memory_from_the_first_sample(bandwidth, rate, poles):
    """Var = σ² ENBW/(rate/2), and the correlation of neighbours is that of the impulse response.

    n = 6000 axes, limits at 4.5 sigma of the estimate (1 in 150 000 each): 12 % in variance is caught.
    """
    n = 6000
    first = next(noise.shaped(np.random.default_rng(10), np.full(n, 2.0), bandwidth, rate, poles))[:2]
    b, a = _coefficients(bandwidth, rate, poles)
    response = signal.lfilter(b, a, np.eye(1, 20_000)[0])
    expected = 4.0 * noise.enbw(bandwidth, rate, poles) / (rate / 2.0)
    assert np.mean(first**2, axis=1) / expected == pytest.approx([1, 1], abs=4.5 * sqrt(2 / n))
    correlation = response[1:] @ response[:-1] / (response @ response)
    assert np.mean(first[0] * first[1]) / expected == pytest.approx(correlation, abs=4.5 * sqrt(2 / n))


def test_density_means_one_thing():
    """One-sided density n: σ = n √ENBW of a sample, S(0) = n² of Welch's one-sided spectrum, and Allan N = n/√2.

    n = 65 536 x 32 samples; ENBW = 110 Hz of 416 leaves 5e5 independent ones: 4.5 sigma is 0.5 % in σ. S(f) up to 10 Hz
    is the mean of 47 frequencies of 31 x 32 segments that overlap by half: 4.5 sigma is 3 %. N as below; the low-pass
    takes 0.4 % off at 30/bandwidth.
    """
    density, bandwidth, rate = 3e-3, 100.0, 833.0
    sd = np.full(32, density * sqrt(rate / 2.0))
    values = _blocks(noise.shaped(np.random.default_rng(11), sd, bandwidth, rate, 2), 64)
    assert values.std() == pytest.approx(density * sqrt(noise.enbw(bandwidth, rate, 2)), rel=0.005)
    frequency, power = signal.welch(values, rate, nperseg=4096, axis=0, detrend=False)
    low = (frequency > 0.5) & (frequency < 10.0)
    assert power[low].mean() == pytest.approx(density**2, rel=0.03)
    m = round(30.0 / bandwidth * rate)
    deviation = _allan(noise.shaped(np.random.default_rng(12), sd, bandwidth, rate, 2), m, PAIRS)
    assert deviation * sqrt(m / rate) == pytest.approx(density / sqrt(2.0), rel=WITHIN)


# -- Allan deviation: each process alone gives its figure back -------------------------------------------------------
#
# With M pairs of neighbouring means, each from its own samples, the variance of a squared Allan deviation is c/M of its
# square: c = 3 for white noise (differences of neighbours correlate by -1/2), 2.25 for a random walk (by 1/4), between
# the two for flicker. M = 20 000 makes one sigma of the deviation 0.61 % at most. The limit of 3 % is 4.5 sigma and a
# quarter of a per cent for the process itself (α = 1e-5 a figure): an error of 4.2 % is caught 97 times in 100.

PAIRS = 20_000
WITHIN = 0.03


def test_the_allan_deviation_of_this_test_is_that_of_allantools():
    values = np.random.default_rng(13).standard_normal(8 * noise.BLOCK)
    blocks = values.reshape(-1, noise.BLOCK, 1)
    _, expected, _, _ = allantools.adev(values, data_type="freq", taus=[16.0])
    assert _allan(iter(blocks), 16, 8 * noise.BLOCK // 16 - 1) == pytest.approx(expected[0], rel=1e-12)


def _white_deviation(bandwidth, rate, poles, seed):
    """Return N over n/√2, read at 30/bandwidth."""
    density = 2e-3
    sd = np.full(64, density * sqrt(rate / 2.0))
    m = round(30.0 / min(bandwidth, rate / 2.0) * rate)
    source = noise.shaped(np.random.default_rng(seed), sd, bandwidth, rate, poles)
    return _allan(source, m, PAIRS) * sqrt(m / rate) / (density / sqrt(2.0))


def _flicker_deviation(shortest, ratios, m, seed):
    """Return the Allan deviation over 0.664 B, dt = 1 s."""
    source = noise.flicker(np.random.default_rng(seed), 0.5, 1.0, 16, shortest, shortest * 4.0**ratios)
    return _allan(source, m, PAIRS) / (sqrt(2.0 * log(2.0) / pi) * 0.5)


def _walk_deviation(intensity, dt, m, seed):
    """Return the Allan deviation over K √(τ/3), which m samples a mean make √(1 + 1/2m²) of it."""
    source = noise.random_walk(np.random.default_rng(seed), intensity, dt, axes=16)
    return _allan(source, m, PAIRS) / (intensity * sqrt(m * dt / 3.0) * sqrt(1.0 + 0.5 / m**2))


@pytest.mark.parametrize(("bandwidth", "poles"), [(float("inf"), 1), (200.0, 1), (200.0, 2)])
def test_white_noise_gives_its_n_back(bandwidth, poles):
    assert _white_deviation(bandwidth, 833.0, poles, seed=14) == pytest.approx(1, abs=WITHIN)


def test_flicker_gives_its_b_back():
    """Flat, 0.664 B, from 60 times the shortest correlation time to a hundredth of the longest."""
    for m in (64, 256):
        assert _flicker_deviation(1.0, 8, m, seed=15) == pytest.approx(1, abs=WITHIN)


def test_random_walk_gives_its_k_back():
    assert _walk_deviation(0.02, 1.0, 32, seed=16) == pytest.approx(1, abs=WITHIN)


def test_both_models_of_drift_have_the_same_floor():
    """0.617 s: the peak of the Gauss-Markov process's Allan deviation, at 1.89 τ, and the flat of the flicker."""
    sd, tau = 0.3, 50.0
    markov = noise.drift(np.random.default_rng(17), "gauss-markov", sd, tau, 1.0, axes=16)
    assert np.array_equal(next(markov), next(noise.gauss_markov(np.random.default_rng(17), sd, tau, 1.0, axes=16)))
    assert _allan(markov, round(1.8926 * tau), PAIRS) / (0.617 * sd) == pytest.approx(1, abs=WITHIN)
    flicker = noise.drift(np.random.default_rng(18), "flicker", sd, tau, 1.0, axes=16)
    assert _allan(flicker, round(1.8926 * tau), PAIRS) / (0.617 * sd) == pytest.approx(1, abs=WITHIN)


@pytest.mark.slow
@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize("rate", [26.0, pytest.param(833.0, marks=pytest.mark.certify)])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.25, 0.45, 1.0])
def test_white_noise_gives_its_n_back_at_any_rate_and_bandwidth(share, rate, poles):
    """20 figures: a false alarm in 5000 runs of the grid."""
    assert _white_deviation(share * rate, rate, poles, seed=19) == pytest.approx(1, abs=WITHIN)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shortest", "ratios", "m"), [(0.6, 8, 16), (0.4, 8, 128), (1.0, 8, 512), (4.0, 8, 512), (2.0, 9, 128)]
)
def test_flicker_gives_its_b_back_over_decades(shortest, ratios, m):
    assert _flicker_deviation(shortest, ratios, m, seed=20) == pytest.approx(1, abs=WITHIN)


@pytest.mark.slow
@pytest.mark.parametrize("m", [1, 4, 32, 256])
@pytest.mark.parametrize(("intensity", "dt"), [(1e-4, 1.2e-3), (0.3, 0.1), (5.0, 10.0)])
def test_random_walk_gives_its_k_back_at_any_time(intensity, dt, m):
    assert _walk_deviation(intensity, dt, m, seed=21) == pytest.approx(1, abs=WITHIN)


@pytest.mark.slow
@pytest.mark.parametrize("tau", [20.0, 100.0, 400.0])
@pytest.mark.parametrize("share", [0.1, 1.8926, 10.0])
def test_gauss_markov_has_the_allan_deviation_of_its_correlation(tau, share):
    """σ²(x τ) = 2 s²/x (1 - (3 - 4 e^-x + e^-2x)/2x), of means of m ≥ 20 samples (IEEE 952, annex B)."""
    sd, m = 0.3, max(20, round(share * tau))
    x = m / tau
    expected = sd * sqrt(2.0 / x * (1.0 - (3.0 - 4.0 * np.exp(-x) + np.exp(-2.0 * x)) / (2.0 * x)))
    source = noise.gauss_markov(np.random.default_rng(22), sd, tau, 1.0, axes=16)
    for _ in range(4):  # from zero to stationary: e^-10 is left
        next(source)
    assert _allan(source, m, PAIRS) / expected == pytest.approx(1, abs=WITHIN)


def test_flicker_has_the_density_b_squared_over_pi_f():
    """Welch, one-sided, from 0.006 to 0.08 Hz.

    Sampled once a second, the shortest correlation time of 0.6 s is where what aliases and what the sum lacks above it
    make up for each other to 0.7 %. n = 128 x 1024 samples x 16 axes, 63 segments each that overlap by half; a band
    averages 16 frequencies: 4.5 sigma is 5 %.
    """
    b = 0.5
    values = _blocks(noise.flicker(np.random.default_rng(23), b, 1.0, 16, 0.6, 0.6 * 4.0**9), 128)
    frequency, power = signal.welch(values, 1.0, nperseg=4096, axis=0)
    over = power.mean(axis=1)[1:] * pi * frequency[1:] / b**2
    for first in (24, 64, 128, 200, 300):
        assert over[first : first + 16].mean() == pytest.approx(1, abs=0.06)


def test_flicker_is_its_sum_of_recursions_across_blocks():
    """Authority: b_k = φ b_{k-1} + s √(1 - φ²) ξ_k for each of the processes, on the same ξ; to rounding."""
    b, dt, shortest, longest = 0.7, 0.01, 0.02, 0.02 * 4.0**3
    values = _blocks(noise.flicker(np.random.default_rng(24), b, dt, 2, shortest, longest), 3)
    assert not values[0].any()
    generator = np.random.default_rng(24)
    xi = np.concatenate([generator.standard_normal((4, 2, noise.BLOCK)) for _ in range(3)], axis=2)
    phi = np.exp(-dt / (shortest * 4.0 ** np.arange(4)))[:, np.newaxis]
    level, expected = np.zeros((4, 2)), []
    for k in range(xi.shape[2]):
        expected.append(level.sum(axis=0))
        level = phi * level + b * sqrt(log(4.0) / pi) * np.sqrt(1.0 - phi**2) * xi[:, :, k]
    assert values == pytest.approx(np.array(expected), abs=1e-12)


# -- the whole domain: finite in, finite out, or a stated error ------------------------------------------------------

SIZE = st.floats(0.0, 1e12)
TIME = st.floats(1e-9, 1e9)
SEED = st.integers(0, 2**32)
NOT_POSITIVE = st.sampled_from([0.0, -1.0, float("nan"), float("inf"), float("-inf")])
NEGATIVE = st.sampled_from([-1e-300, -1.0, float("nan"), float("inf"), float("-inf")])


def _finite(source, axes):
    first, second = islice(source, 2)
    for block in (first, second):
        assert block.shape == (noise.BLOCK, axes)
        assert np.isfinite(block).all()
    return first


@given(SEED, st.lists(SIZE, min_size=1, max_size=3), TIME, st.floats(1e-9, 1e6), st.sampled_from([1, 2]))
@settings(max_examples=60, deadline=None)
def test_shaped_noise_is_finite_everywhere(seed, sd, rate, share, poles):
    _finite(noise.shaped(np.random.default_rng(seed), sd, share * rate * (1.0 + 1e-12), rate, poles), len(sd))
    assert 0.0 < noise.enbw(share * rate * (1.0 + 1e-12), rate, poles) <= rate / 2.0


@given(SEED, SIZE, TIME, TIME)
@settings(max_examples=60, deadline=None)
def test_drift_is_finite_and_starts_at_zero_everywhere(seed, size, correlation_time, dt):
    for model in ("gauss-markov", "flicker"):
        source = noise.drift(np.random.default_rng(seed), model, size, correlation_time, dt, axes=3)
        assert not _finite(source, 3)[0].any()
    assert not _finite(noise.random_walk(np.random.default_rng(seed), size, dt), 1)[0].any()


@given(SEED, SIZE, TIME, TIME, st.floats(1.000001, 1e9))
@settings(max_examples=60, deadline=None)
def test_flicker_is_finite_everywhere(seed, instability, dt, shortest, span):
    _finite(noise.flicker(np.random.default_rng(seed), instability, dt, 1, shortest, shortest * span), 1)


@given(NEGATIVE, NOT_POSITIVE)
def test_what_no_noise_has_is_refused_before_anything_is_drawn(negative, not_positive):
    generator = np.random.default_rng(25)
    calls = {
        "sd": [
            lambda: noise.white(generator, [1.0, negative]),
            lambda: noise.shaped(generator, [1.0, negative], 10.0, 100.0, 1),
            lambda: noise.gauss_markov(generator, negative, 1.0, 0.1),
            lambda: noise.drift(generator, "flicker", negative, 1.0, 0.1, 1),
        ],
        "intensity": [lambda: noise.random_walk(generator, negative, 0.1)],
        "instability": [lambda: noise.flicker(generator, negative, 0.1, 1, 1.0, 10.0)],
        "dt": [
            lambda: noise.random_walk(generator, 1.0, not_positive),
            lambda: noise.gauss_markov(generator, 1.0, 1.0, not_positive),
            lambda: noise.flicker(generator, 1.0, not_positive, 1, 1.0, 10.0),
        ],
        "correlation_time": [
            lambda: noise.gauss_markov(generator, 1.0, not_positive, 0.1),
            lambda: noise.drift(generator, "flicker", 1.0, not_positive, 0.1, 1),
        ],
        "shortest": [lambda: noise.flicker(generator, 1.0, 0.1, 1, not_positive, 10.0)],
        "longest": [lambda: noise.flicker(generator, 1.0, 0.1, 1, 1.0, not_positive)],
        "rate": [
            lambda: noise.enbw(10.0, not_positive, 1),
            lambda: noise.shaped(generator, 1.0, 10.0, not_positive, 2),
        ],
    }
    for name, refused in calls.items():
        for call in refused:
            with pytest.raises(ValueError, match=rf"^{name} must be"):
                call()


def test_a_low_pass_or_a_model_that_does_not_exist_is_an_error():
    for bandwidth in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="bandwidth must be above 0"):
            noise.enbw(bandwidth, 100.0, 1)
    with pytest.raises(ValueError, match="poles must be 1 or 2, not 3"):
        noise.shaped(np.random.default_rng(26), 1.0, 10.0, 100.0, 3)
    with pytest.raises(ValueError, match="longest must be above shortest"):
        noise.flicker(np.random.default_rng(26), 1.0, 0.1, 1, 10.0, 10.0)
    with pytest.raises(ValueError, match="drift_model 'pink' is unknown"):
        noise.drift(np.random.default_rng(26), "pink", 1.0, 1.0, 0.1, 1)
