"""Noise of a given spectrum: its power, its band, its bounds."""

from itertools import pairwise
from math import log

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate

from sensors import spectrum


def test_band_limited_noise_stays_in_its_band_and_is_flat():
    """Nothing outside to rounding; inside, thirds of the band hold a third of the power each (4 sigma of its lines)."""
    count, dt, band = 32768, 1e-3, (5.0, 200.0)
    values = spectrum.band_limited(np.random.default_rng(6), count, dt, band, axes=3)
    assert np.sqrt(np.mean(values**2, axis=0)) == pytest.approx([1, 1, 1], rel=1e-12)
    power = np.abs(np.fft.rfft(values, axis=0)) ** 2
    frequency = np.fft.rfftfreq(count, dt)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    assert power[~inside].max() < 1e-20 * power.max()
    for third in np.array_split(power[inside], 3):
        assert third.mean(axis=0) / power[inside].mean(axis=0) == pytest.approx([1, 1, 1], abs=4 / np.sqrt(len(third)))


def test_band_beyond_half_the_rate_is_an_error():
    with pytest.raises(ValueError, match="500 Hz"):
        spectrum.band_limited(np.random.default_rng(7), 1024, 1e-3, (5.0, 600.0), axes=1)


def test_power_below_is_the_integral_of_lines_in_log_log():
    """Authority: numerical integration; slopes up, flat, 1/f and steep down."""
    psd = ((2.0, 1e-3), (10.0, 4e-3), (20.0, 4e-3), (80.0, 1e-3), (200.0, 1e-5))
    f, s = np.array(psd).T
    for upper in (1.0, 5.0, 10.0, 15.0, 50.0, 150.0, 200.0, 400.0):
        expected = sum(
            integrate.quad(lambda x: float(np.exp(np.interp(log(x), np.log(f), np.log(s)))), low, min(high, upper))[0]
            for low, high in pairwise(f)
            if low < upper
        )
        assert spectrum.power_below(psd, upper) == pytest.approx(expected, rel=1e-9)


@given(st.floats(1e-3, 400.0), st.floats(1e-12, 5.0), st.floats(1e-30, 1e6), st.floats(1e-30, 1e6))
@settings(max_examples=200, deadline=None)
def test_the_power_of_one_line_lies_between_its_ends(frequency, width, s0, s1):
    """However steep or narrow: finite, and between the smaller and the greater density times the width."""
    upper = frequency * (1.0 + width)
    if upper > frequency:
        power = float(spectrum.power_below(((frequency, s0), (upper, s1)), 1e9))
        flat = upper - frequency
        assert min(s0, s1) * flat * (1 - 1e-3) <= power <= max(s0, s1) * flat * (1 + 1e-3)


def test_a_spectrum_narrower_than_a_line_keeps_its_power():
    """n = 2000 axes, one line, two degrees of freedom each: 4.5 sigma is 10 %."""
    values = spectrum.spectral(np.random.default_rng(27), 1024, 1e-3, ((100.0, 4.0), (100.1, 4.0)), axes=2000)
    assert np.mean(values**2) == pytest.approx(0.4, rel=0.1)
