"""Noise of an accelerometer that shakes: white, and in a band of frequencies."""

from math import ceil, floor

import numpy as np

from uavsim.studies.signals.ranges import Array, Range, Single
from uavsim.truth import STANDARD_GRAVITY as G0


def sense(force: Array, sigma_g: float, clip_g: float, generator: np.random.Generator) -> Array:
    """Return what is read of a true force: white noise added, then clipped.

    Before detection the truth does not depend on the noise, so one flight's force serves any number of readings.

    Parameters
    ----------
    force
        Any shape, m/s².
    sigma_g, clip_g
        Standard deviation and range, standard g.
    generator
        Of the noise.
    """
    reading = force + sigma_g * G0 * generator.standard_normal(force.shape)
    return np.clip(reading, -clip_g * G0, clip_g * G0, out=reading)


def band_noise(n: int, rate: float, band_hz: Range, generator: np.random.Generator) -> Single:
    """Return normal noise of unit rms with a flat spectrum in a band, shape (n,).

    Each frequency of the band has a complex normal amplitude of its own, so the samples are exactly normal.

    Raises
    ------
    ValueError
        If the band is empty in `n` samples or reaches half the rate: sample faster then and take every k-th sample.
    """
    from scipy.fft import irfft, next_fast_len

    m = next_fast_len(n, real=True)
    low, high = ceil(band_hz[0] * m / rate), floor(band_hz[1] * m / rate)
    if not 1 <= low <= high < m / 2:
        raise ValueError(f"vibration of {band_hz[0]:g}-{band_hz[1]:g} Hz does not fit {n} samples at {rate:g} Hz")
    spectrum = np.zeros(m // 2 + 1, np.complex64)
    spectrum[low : high + 1] = generator.standard_normal(2 * (high + 1 - low), dtype=np.float32).view(np.complex64)
    noise: Single = irfft(spectrum, m, norm="forward", overwrite_x=True)[:n]
    noise *= np.float32(0.5 / np.sqrt(high + 1 - low))  # a frequency's 2 (a cos - b sin) has variance 4
    return noise
