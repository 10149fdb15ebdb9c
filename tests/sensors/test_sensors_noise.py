"""Noise processes against their theory: variances, recursions, spectra."""

from itertools import islice

import numpy as np
import pytest

from sensors import noise


def _blocks(source, count):
    return np.concatenate(list(islice(source, count)))


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


def test_band_limited_noise_stays_in_its_band_and_is_flat():
    """Nothing outside to rounding; inside, thirds of the band hold a third of the power each (4 sigma of its lines)."""
    count, dt, band = 32768, 1e-3, (5.0, 200.0)
    values = noise.band_limited(np.random.default_rng(6), count, dt, band, axes=3)
    assert np.sqrt(np.mean(values**2, axis=0)) == pytest.approx([1, 1, 1], rel=1e-12)
    power = np.abs(np.fft.rfft(values, axis=0)) ** 2
    frequency = np.fft.rfftfreq(count, dt)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    assert power[~inside].max() < 1e-20 * power.max()
    for third in np.array_split(power[inside], 3):
        assert third.mean(axis=0) / power[inside].mean(axis=0) == pytest.approx([1, 1, 1], abs=4 / np.sqrt(len(third)))


def test_band_beyond_half_the_rate_is_an_error():
    with pytest.raises(ValueError, match="500 Hz"):
        noise.band_limited(np.random.default_rng(7), 1024, 1e-3, (5.0, 600.0), axes=1)
