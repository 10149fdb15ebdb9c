"""Noise processes: white, Gauss-Markov, random walk, and noise limited to a band.

    white            w_k = σ ξ_k                                         σ = n √(ENBW) for a one-sided density n
    Gauss-Markov     b_k = φ b_{k-1} + s √(1 - φ²) ξ_k,  φ = e^{-Δt/τ}   stationary standard deviation s
    random walk      r_k = r_{k-1} + K √Δt ξ_k                           K in unit/√s, variance K² t

with ξ standard normal. Gauss-Markov and random walk start at zero: what a unit is off by when it is switched on is its
turn-on offset, drift is what comes after.

The first three are endless sequences of blocks, arrays of shape (BLOCK, axes), so that a sensor needs no
duration and an hour costs no memory; `rows` turns their sum into plain Python lists, one per sample, which is
the cheapest thing that a loop in CPython can read. The size of a block does not depend on anything: the first
samples of a stream are the same whatever is drawn later.

Source: IEEE Std 952 (Allan variance terms); Brown & Hwang, "Introduction to Random Signals", ch. 3 (Gauss-Markov).
"""

from collections.abc import Callable, Iterable, Iterator
from functools import reduce
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

BLOCK = 1024  # samples drawn at once
DOUBLINGS = tuple(2**power for power in range(10))  # 1 … BLOCK/2


def white(generator: np.random.Generator, sd: ArrayLike) -> Iterator[Array]:
    """Yield blocks of white noise; `sd`, one standard deviation for each axis, sets the number of axes."""
    scale = np.atleast_1d(np.asarray(sd, dtype=float))
    while True:
        yield generator.standard_normal((BLOCK, scale.size)) * scale


def gauss_markov(
    generator: np.random.Generator, sd: float, correlation_time: float, dt: float, axes: int = 1
) -> Iterator[Array]:
    """Yield blocks of a first-order Gauss-Markov process that starts at zero.

    Parameters
    ----------
    generator : numpy.random.Generator
    sd : float
        Stationary standard deviation, reached after a few correlation times.
    correlation_time : float
        τ, s.
    dt : float
        Time between samples, s.
    axes : int
        Number of independent processes.
    """
    phi = float(np.exp(-dt / correlation_time))
    drive = sd * float(np.sqrt(-np.expm1(-2.0 * dt / correlation_time)))
    level = np.zeros((1, axes))
    while True:
        following = generator.standard_normal((BLOCK, axes)) * drive
        following[:1] += phi * level
        # The recursion by doubling: after the passes 1, 2, 4, … each value has gathered all before it.
        for reach in DOUBLINGS:
            following[reach:] = following[reach:] + phi**reach * following[:-reach]
        yield np.vstack((level, following[:-1]))
        level = following[-1:]


def random_walk(generator: np.random.Generator, intensity: float, dt: float, axes: int = 1) -> Iterator[Array]:
    """Yield blocks of a random walk of `intensity` K (unit/√s) that starts at zero."""
    level = np.zeros((1, axes))
    while True:
        steps = generator.standard_normal((BLOCK, axes)) * (intensity * np.sqrt(dt))
        following = level + np.cumsum(steps, axis=0)
        yield np.vstack((level, following[:-1]))
        level = following[-1:]


def constant(value: ArrayLike) -> Iterator[Array]:
    """Yield blocks of one row that stands for all: a turn-on offset."""
    row = np.atleast_2d(np.asarray(value, dtype=float))
    while True:
        yield row


def rows(sources: Iterable[Iterator[Array]], scale: ArrayLike = 1.0) -> Callable[[], list[float]]:
    """Return a function that gives, sample by sample, the sum of all sources times `scale`, one float an axis."""
    factor = np.asarray(scale, dtype=float)
    blocks = zip(*sources, strict=True)
    return chain.from_iterable((reduce(np.add, block) * factor).tolist() for block in blocks).__next__


def values(sources: Iterable[Iterator[Array]]) -> Callable[[], float]:
    """Return a function that gives, sample by sample, the sum of all sources of a single axis."""
    blocks = zip(*sources, strict=True)
    return chain.from_iterable(reduce(np.add, block)[:, 0].tolist() for block in blocks).__next__


def enbw(bandwidth: float, rate: float, poles: int) -> float:
    """Return the equivalent noise bandwidth of what `rate` readings a second carry behind a low-pass, Hz.

    Parameters
    ----------
    bandwidth : float
        Its -3 dB frequency, Hz; from rate/2 on it takes nothing away.
    rate : float
        Hz.
    poles : int
        1 or 2 (Butterworth), discrete at the output rate.
    """
    return rate / 2.0


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
