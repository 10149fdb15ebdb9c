"""Noise processes: white, behind a low-pass, Gauss-Markov, flicker, random walk.

    white            w_k = σ ξ_k                                         σ = n √(ENBW) for a one-sided density n
    shaped           the same behind one or two discrete poles of unit gain at f = 0
    Gauss-Markov     b_k = φ b_{k-1} + s √(1 - φ²) ξ_k,  φ = e^{-Δt/τ}   stationary standard deviation s
    flicker          Σ Gauss-Markov, τ_i = τ_0 r^i, s² = B² ln r / π     one-sided density B²/(π f); ADEV 0.664 B
    random walk      r_k = r_{k-1} + K √Δt ξ_k                           K in unit/√s, variance K² t

with ξ standard normal. Gauss-Markov, flicker and random walk start at zero: what a unit is off by when it is switched
on is its turn-on offset, drift is what comes after. White noise, shaped or not, is stationary from its first sample.

All are endless sequences of blocks, arrays of shape (BLOCK, axes), so that a sensor needs no
duration and an hour costs no memory; `rows` turns their sum into plain Python lists, one per sample, which is
the cheapest thing that a loop in CPython can read. The size of a block does not depend on anything: the first
samples of a stream are the same whatever is drawn later.

Source: IEEE Std 952 (Allan variance terms); Brown & Hwang, "Introduction to Random Signals", ch. 3 (Gauss-Markov);
Oppenheim & Schafer, "Discrete-Time Signal Processing", ch. 7 (Butterworth by the bilinear transform).
"""

from collections.abc import Callable, Iterable, Iterator
from functools import reduce
from itertools import chain
from math import ceil, inf, log, pi, sin, sqrt, tan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.choice import choose
from sensors.unit import DriftModel

Array = NDArray[np.float64]
States = NDArray[Any]  # float or complex
Filter = tuple[float, complex, complex]

BLOCK = 1024  # samples drawn at once
DOUBLINGS = tuple(2**power for power in range(10))  # 1 … BLOCK/2
CHUNK = 32  # samples that one matrix product carries a recursion through; CHUNK² = BLOCK
LEAST_FREQUENCY = 1e-9  # cycles a sample: a low-pass below has too few digits left in its pole
FLICKER_RATIO = 4.0  # between correlation times: the density keeps to 1/f within 2 sech(π²/ln 4) = 0.3 %
FLICKER_SPAN = 256.0  # a drift's flicker reaches from its correlation time / 256 to 256 times it: nine processes
GAUSS_MARKOV_PEAK = 0.6173642831  # greatest Allan deviation over s, at 1.893 τ: max_x √(2/x (1 - (3-4e^-x+e^-2x)/2x))
FLICKER_FLAT = sqrt(2.0 * log(2.0) / pi)  # Allan deviation of flicker noise over B, 0.664 (IEEE 952)


def white(generator: np.random.Generator, sd: ArrayLike) -> Iterator[Array]:
    """Return blocks of white noise; `sd`, one standard deviation for each axis, sets the number of axes."""
    scale = np.atleast_1d(np.asarray(sd, dtype=float))
    _not_negative(sd=scale)

    def blocks() -> Iterator[Array]:
        while True:
            yield generator.standard_normal((BLOCK, scale.size)) * scale

    return blocks()


def shaped(generator: np.random.Generator, sd: ArrayLike, bandwidth: float, rate: float, poles: int) -> Iterator[Array]:
    """Return blocks of white noise behind a discrete low-pass, stationary from the first sample.

    Parameters
    ----------
    generator : numpy.random.Generator
    sd : float or sequence of float
        Standard deviation a sample ahead of the low-pass, one for each axis.
    bandwidth : float
        -3 dB frequency of the low-pass, Hz; from rate/2 on there is none, and this is `white`.
    rate : float
        Samples a second, Hz.
    poles : int
        1, y += a (x - y), or 2, Butterworth by the bilinear transform.

    Raises
    ------
    ValueError
        If a figure is negative, zero (of the frequencies) or no number, or there is no such low-pass.
    """
    _check_low_pass(bandwidth, rate, poles)
    if bandwidth >= 0.5 * rate:
        return white(generator, sd)
    scale = np.atleast_1d(np.asarray(sd, dtype=float))
    _not_negative(sd=scale)
    return _filtered(generator, scale, _low_pass(bandwidth / rate, poles))


def gauss_markov(
    generator: np.random.Generator, sd: float, correlation_time: float, dt: float, axes: int = 1
) -> Iterator[Array]:
    """Return blocks of a first-order Gauss-Markov process that starts at zero.

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

    Raises
    ------
    ValueError
        If a figure is negative, zero (of the times) or no number.
    """
    _not_negative(sd=sd)
    _positive(correlation_time=correlation_time, dt=dt)
    return _gauss_markov(generator, sd, correlation_time, dt, axes)


def _gauss_markov(
    generator: np.random.Generator, sd: float, correlation_time: float, dt: float, axes: int
) -> Iterator[Array]:
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
    """Return blocks of a random walk of `intensity` K (unit/√s), `dt` s between samples, that starts at zero."""
    _not_negative(intensity=intensity)
    _positive(dt=dt)
    return _random_walk(generator, intensity, dt, axes)


def _random_walk(generator: np.random.Generator, intensity: float, dt: float, axes: int) -> Iterator[Array]:
    level = np.zeros((1, axes))
    while True:
        steps = generator.standard_normal((BLOCK, axes)) * (intensity * np.sqrt(dt))
        following = level + np.cumsum(steps, axis=0)
        yield np.vstack((level, following[:-1]))
        level = following[-1:]


def flicker(
    generator: np.random.Generator, instability: float, dt: float, axes: int, shortest: float, longest: float
) -> Iterator[Array]:
    """Return blocks of 1/f noise that starts at zero: Gauss-Markov processes, each exactly discretised.

    Their one-sided density is B²/(π f) between about 1/(2π longest) and 1/(2π shortest), flat below and 1/f² above, and
    the Allan deviation is 0.664 B where that band holds it.

    Parameters
    ----------
    generator : numpy.random.Generator
    instability : float
        B, the bias instability.
    dt : float
        Time between samples, s.
    axes : int
        Number of independent processes.
    shortest, longest : float
        First and last correlation time, s; the others lie between, at equal ratios of at most 4.

    Raises
    ------
    ValueError
        If a figure is negative, zero (of the times) or no number, or `longest` is not above `shortest`.
    """
    _not_negative(instability=instability)
    _positive(dt=dt, shortest=shortest, longest=longest)
    if not shortest < longest:
        raise ValueError(f"longest must be above shortest, {shortest:g} s, not {longest:g} s")
    times, ratio = correlation_times(shortest, longest)
    return _sum_of_gauss_markov(generator, instability * sqrt(log(ratio) / pi), times, dt, axes)


def drift(
    generator: np.random.Generator, model: DriftModel, sd: float, correlation_time: float, dt: float, axes: int
) -> Iterator[Array]:
    """Return blocks of in-run drift of a part that is described by a Gauss-Markov process.

    "gauss-markov" is that process. "flicker" is 1/f noise whose flat Allan deviation is the peak of that of the
    process: what a datasheet's plot shows as the floor is the same of both.

    Parameters
    ----------
    generator : numpy.random.Generator
    model : {"gauss-markov", "flicker"}
    sd : float
        Stationary standard deviation of the Gauss-Markov process.
    correlation_time : float
        Its τ, s.
    dt : float
        Time between samples, s.
    axes : int
        Number of independent processes.

    Raises
    ------
    ValueError
        For an unknown model, or a figure that is negative, zero (of the times) or no number.
    """
    if choose("drift_model", model, ("gauss-markov", "flicker")) == "gauss-markov":
        return gauss_markov(generator, sd, correlation_time, dt, axes)
    _not_negative(sd=sd)
    _positive(correlation_time=correlation_time)
    instability = sd * (GAUSS_MARKOV_PEAK / FLICKER_FLAT)
    return flicker(generator, instability, dt, axes, correlation_time / FLICKER_SPAN, correlation_time * FLICKER_SPAN)


def correlation_times(shortest: float, longest: float) -> tuple[Array, float]:
    """Return correlation times from the shortest to the longest and the ratio from one to the next, 4 at most."""
    span = log(longest) - log(shortest)
    ratios = max(1, ceil(span / log(FLICKER_RATIO) - 1e-9))
    return shortest * np.exp(span / ratios * np.arange(ratios + 1)), np.exp(span / ratios)


def _sum_of_gauss_markov(
    generator: np.random.Generator, sd: float, times: Array, dt: float, axes: int
) -> Iterator[Array]:
    """Yield blocks of the sum of Gauss-Markov processes, one for each correlation time, from zero."""
    phi = np.exp(-dt / times)
    drive = sd * np.sqrt(-np.expm1(-2.0 * dt / times))
    recursion = _Recursion(phi, drive)
    state = np.zeros((times.size, axes))
    total = np.zeros((axes, 1))
    while True:
        each, state = recursion.run(generator.standard_normal((times.size, axes, CHUNK, CHUNK)), state)
        following = each.sum(axis=0)
        yield np.hstack((total, following[:, :-1])).T
        total = following[:, -1:]


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

    With f = rate/2, one pole of weight a, y += a (x - y), leaves f a/(2 - a); two poles by the bilinear transform,
    |H|² = 1/(1 + (tan(ω/2)/K)⁴), leave f K (K³ + (1 - K²)/√2)/(1 + K⁴) with K = tan(π bandwidth/rate). For a
    bandwidth far below the rate these are π/2 and π/(2√2) of it, as of their continuous forms.

    Parameters
    ----------
    bandwidth : float
        Its -3 dB frequency, Hz; from rate/2 on it takes nothing away.
    rate : float
        Hz.
    poles : int
        1 or 2 (Butterworth), discrete at the output rate.

    Raises
    ------
    ValueError
        If a frequency is not above 0, or there are neither 1 nor 2 poles.
    """
    _check_low_pass(bandwidth, rate, poles)
    half = 0.5 * rate
    if bandwidth >= half:
        return half
    if poles == 1:
        a = _weight(bandwidth / rate)
        return half * a / (2.0 - a)
    k = tan(pi * bandwidth / rate)
    return half * k * (k**3 + (1.0 - k * k) / sqrt(2.0)) / (1.0 + k**4)


def _check_low_pass(bandwidth: float, rate: float, poles: int) -> None:
    _positive(rate=rate)
    if not bandwidth >= LEAST_FREQUENCY * rate:
        raise ValueError(f"bandwidth must be above 0, and at least 1e-9 of the rate {rate:g} Hz, not {bandwidth!r}")
    if poles not in (1, 2):
        raise ValueError(f"poles must be 1 or 2, not {poles!r}")


def _weight(frequency: float) -> float:
    """Return the weight a of y += a (x - y) that is 3 dB down at this frequency, in cycles a sample, below half.

    |H|² = a²/(a² + 2 (1 - a) c) with c = 1 - cos ω is 1/2 where a² = 2 (1 - a) c.
    """
    c = 2.0 * sin(pi * frequency) ** 2
    return sqrt(c * c + 2.0 * c) - c


def _low_pass(frequency: float, poles: int) -> Filter:
    """Return (direct, residue, s) of H(z) = direct + Re(residue/(1 - p/z)); `frequency` in cycles a sample.

    p = (1 + s)/(1 - s) is the pole. "Re" is of what a real signal becomes: a Butterworth has the conjugate one too.
    """
    if poles == 1:
        a = _weight(frequency)
        return 0.0, a, -a / (2.0 - a)
    s = tan(pi * frequency) * complex(-sqrt(0.5), sqrt(0.5))
    pole = (1.0 + s) / (1.0 - s)
    gain = abs(s) ** 2 / abs(1.0 - s) ** 2
    # pole + 1 = 2/(1 - s), and the two poles are 4i Im s/|1 - s|² apart; as differences they would lose their digits.
    residue = gain * (2.0 / (1.0 - s)) ** 2 / (pole * 4j * s.imag / abs(1.0 - s) ** 2)
    return gain / abs(pole) ** 2, 2.0 * residue, s


def _filtered(generator: np.random.Generator, sd: Array, low_pass: Filter) -> Iterator[Array]:
    """Yield blocks of white noise behind a low-pass, whose state is drawn from its stationary distribution."""
    direct, residue, s = low_pass
    recursion = _Recursion(np.array([(1.0 + s) / (1.0 - s)]), np.array([residue]), direct)
    state = _stationary(generator.standard_normal((2, sd.size)) * sd, s)[np.newaxis]
    while True:
        driven = generator.standard_normal((1, sd.size, CHUNK, CHUNK)) * sd[:, np.newaxis, np.newaxis]
        noise, state = recursion.run(driven, state)
        yield noise[0].T


class _Recursion:
    """The filters y_k = Re(c_i w_k) + d x_k, w_k = p_i w_{k-1} + x_k over a block, one for each pole p_i.

    By matrix products: within a chunk y is a lower triangular matrix of the impulse response times x, and w at its end
    follows the same recursion from chunk to chunk with p^CHUNK. No power exceeds 1, so this holds for any |p| ≤ 1. Each
    product is small and real, so that the linear algebra starts no threads for it.
    """

    __slots__ = ("_across", "_decay_across", "_ends", "_free", "_within")

    def __init__(self, pole: States, residue: States, direct: float = 0.0) -> None:
        lags, decay = _powers(pole)
        self._within = ((residue[:, np.newaxis, np.newaxis] * lags).real + direct * np.eye(CHUNK))[:, np.newaxis]
        self._free = (residue[:, np.newaxis] * decay)[:, np.newaxis, np.newaxis]
        self._ends = lags[:, np.newaxis, :, -1:]
        across, decay_across = _powers(pole**CHUNK)
        self._across, self._decay_across = across, decay_across[:, np.newaxis]

    def run(self, x: Array, w: States) -> tuple[Array, States]:
        """Return y, (poles, axes, BLOCK), and the w after it, for x, (poles, axes, CHUNK, CHUNK), and the w before."""
        w = w[..., np.newaxis]
        ends = (x @ self._ends)[..., 0] @ self._across + w * self._decay_across
        before = np.concatenate((w, ends[..., :-1]), axis=-1)[..., np.newaxis]
        y = x @ self._within + (before * self._free).real
        return y.reshape(*y.shape[:2], BLOCK), ends[..., -1]


def _powers(phi: States) -> tuple[States, States]:
    """Return, for each φ, the matrix of φ^(k-j) for j ≤ k (rows j, columns k) and the row φ^(k+1); k < CHUNK."""
    k = np.arange(CHUNK)
    table = phi[:, np.newaxis] ** np.arange(CHUNK + 1)
    lag = k - k[:, np.newaxis]
    return np.where(lag >= 0, table[:, np.maximum(lag, 0)], 0.0), table[:, 1:]


def _stationary(drawn: Array, s: complex) -> States:
    """Return states of w_k = p w_{k-1} + ξ_k, p = (1 + s)/(1 - s), in their stationary distribution.

    E|w|² = 1/(1 - |p|²) and E w² = 1/(1 - p²), written in s, which keeps its digits. `drawn` is ξ of shape (2, axes).
    """
    power, square = abs(1.0 - s) ** 2 / (-4.0 * s.real), (1.0 - s) ** 2 / (-4.0 * s)
    real = sqrt((power + square.real) / 2.0)
    state: States = real * drawn[0]
    if s.imag:
        cross = square.imag / 2.0 / real
        rest = sqrt(max((power - square.real) / 2.0 - cross * cross, 0.0))
        state = state + 1j * (cross * drawn[0] + rest * drawn[1])
    return state


def _not_negative(**given: ArrayLike) -> None:
    for name, value in given.items():
        if not np.all(np.isfinite(value)) or np.any(np.asarray(value) < 0.0):
            raise ValueError(f"{name} must be at least 0 and finite, not {np.asarray(value).tolist()}")


def _positive(**given: float) -> None:
    for name, value in given.items():
        if not 0.0 < value < inf:
            raise ValueError(f"{name} must be above 0 and finite, not {value!r}")
