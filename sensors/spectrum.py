"""Noise of a given spectrum, drawn in the frequency domain and so periodic: its end joins its beginning without a step.

    band        flat from one frequency to another, of rms 1
    density     straight lines in log-log between points (frequency, one-sided density), as vibration is specified

Each line of the spectrum has a normal real and a normal imaginary part: the noise is normal and of random phases.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import inf, log

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def band_limited(generator: np.random.Generator, count: int, dt: float, band: tuple[float, float], axes: int) -> Array:
    """Return noise with a flat spectrum inside a band and nothing outside, of rms exactly 1 on each axis.

    Drawn in the frequency domain, so it is periodic: its end joins its beginning without a step.

    Parameters
    ----------
    generator : numpy.random.Generator
    count : int
        Number of samples, the period.
    dt : float
        Time between samples, s.
    band : tuple of float
        Lower and upper edge, Hz, both inside.
    axes : int

    Returns
    -------
    numpy.ndarray
        Shape (count, axes).

    Raises
    ------
    ValueError
        If the band reaches half the sample rate or holds no line of the spectrum.
    """
    low, high = band
    frequency = np.fft.rfftfreq(count, dt)
    inside = (frequency >= low) & (frequency <= high)
    if not 0.0 < low < high < 0.5 / dt or not inside.any():
        raise ValueError(f"band_hz {low:g} to {high:g} must lie above 0 and below half the step rate, {0.5 / dt:g} Hz")
    spectrum = np.zeros((frequency.size, axes), dtype=complex)
    spectrum[inside] = generator.standard_normal((int(inside.sum()), axes, 2)) @ (1.0, 1.0j)
    noise = np.fft.irfft(spectrum, count, axis=0)
    unit: Array = noise / np.sqrt(np.mean(noise**2, axis=0))
    return unit


def spectral(
    generator: np.random.Generator, count: int, dt: float, psd: Sequence[tuple[float, float]], axes: int
) -> Array:
    """Return normal noise of a given power spectral density, periodic like `band_limited`.

    Each line of the spectrum carries, on the average, what the density has between the midpoints to its neighbours, so
    the mean square is on the average the integral of the density, however narrow it is.

    Parameters
    ----------
    generator : numpy.random.Generator
    count : int
        Number of samples, even, the period.
    dt : float
        Time between samples, s.
    psd : sequence of (float, float)
        Frequency, Hz, and one-sided density there, unit²/Hz; straight lines in log-log between, nothing outside.
    axes : int

    Returns
    -------
    numpy.ndarray
        Shape (count, axes).

    Raises
    ------
    ValueError
        As `check_psd`.
    """
    check_psd("psd", psd, 0.5 / dt)
    last = count // 2  # this line, at half the sample rate, and that at zero have no phase: they stay empty
    edges = np.arange(0.5, last) / (count * dt)
    edges[0], edges[-1] = 0.0, inf
    power = np.diff(power_below(psd, edges))
    drawn = generator.standard_normal((power.size, axes, 2)) @ (1.0, 1.0j)
    spectrum = np.zeros((last + 1, axes), dtype=complex)
    spectrum[1:last] = drawn * (0.5 * count * np.sqrt(power))[:, np.newaxis]
    noise: Array = np.fft.irfft(spectrum, count, axis=0)
    return noise


def check_psd(name: str, psd: Sequence[tuple[float, float]], half_rate: float) -> None:
    """Refuse what is no one-sided power spectral density below `half_rate`, Hz.

    Raises
    ------
    ValueError
        In one line that begins with `name`: fewer than two points, frequencies that do not rise or are not between 0
        and `half_rate`, densities that are not above 0.
    """
    if len(psd) < 2:
        raise ValueError(f"{name}: must have at least 2 points (frequency, density), not {len(psd)}")
    for frequency, density in psd:
        if not 0.0 < frequency < half_rate:
            raise ValueError(f"{name}: frequencies must lie above 0 and below {half_rate:g} Hz, not {frequency:g}")
        if not 0.0 < density < inf:
            raise ValueError(f"{name}: densities must be above 0 and finite, not {density:g} at {frequency:g} Hz")
    for (lower, _), (upper, _) in pairwise(psd):
        if not lower < upper:
            raise ValueError(f"{name}: frequencies must rise, not go from {lower:g} to {upper:g} Hz")


def power_below(psd: Sequence[tuple[float, float]], frequency: ArrayLike) -> Array:
    """Return the integral of a density that is straight in log-log, up to each frequency, Hz: the mean square there."""
    frequency = np.asarray(frequency, dtype=float)
    total = np.zeros_like(frequency)
    for (f0, s0), (f1, s1) in pairwise(psd):
        total += _power_between(f0, s0, f1, s1, np.clip(frequency, f0, f1))
    return total


def _power_between(f0: float, s0: float, f1: float, s1: float, f: Array) -> Array:
    """Return ∫ S df from f0 to f, S = s0 (f/f0)^m: (S f - s0 f0)/(m + 1), or s0 f0 ln(f/f0) where m + 1 = 0."""
    span = log(f1) - log(f0)
    slope = (log(s1) - log(s0)) / span if span > 1e-9 else 0.0  # that narrow, a line of any slope is a step
    nepers = np.log(f) - log(f0)
    x = (slope + 1.0) * nepers
    flat = np.abs(x) < 1.0  # where the difference of the first form loses digits
    growth = np.divide(np.expm1(x), x, out=np.ones_like(x), where=flat & (x != 0.0))
    steep = np.exp(log(s0) + slope * nepers) * f - s0 * f0
    power: Array = np.where(flat, s0 * f0 * nepers * growth, steep / (slope + 1.0 if slope != -1.0 else 1.0))
    return power
