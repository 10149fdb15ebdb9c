"""Allan variances and densities of the processes that a sensor's noise is made of, in closed form.

Convention, here and everywhere: a density S(f) is one-sided, over positive frequencies; n is its root for white noise,
and N = n/√2. With τ_0 the time between readings and τ = m τ_0 (IEEE Std 952, annex C; NIST SP 1065 for flicker):

    process                              S(f)                      Allan variance σ²(τ)
    white noise N                        2 N²                      N²/τ
    bias instability B (flicker)         B²/(π f)                  (2 ln 2/π) B² = (0.664 B)²
    Gauss-Markov, s and T                4 s² T/(1 + (2πfT)²)      2 s²/x (1 - (3 - 4 e^-x + e^-2x)/(2x)),  x = τ/T
    random walk K                        2 K²/(2πf)²               K² τ/3
    quantisation of the integral, Q      2 Q² (2πf)²               3 Q²/τ²

A Gauss-Markov process peaks at 0.617 s where τ = 1.89 T; it stands for a bias instability with the same peak,
0.664 B = 0.617 s. Sampled, not averaged, the two drifts have the further factor 1 + 1/(2m²) while τ is small against T.

Noise behind a low-pass has the autocovariance R_k; with V(m) the variance of a mean of m readings

    V(m) = Σ_{|k|<m} (1/m - |k|/m²) R_k,        σ²(m τ_0) = 2 (V(m) - V(2m))

White noise behind a filter of unit gain at f = 0 so keeps its N at long τ and lies below N²/τ at short τ. A part that
rounds its readings, not their integral, adds white noise of variance q²/12, as long as its noise is not far below q.
"""

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.noise import FLICKER_FLAT, GAUSS_MARKOV_PEAK

Array = NDArray[np.float64]

INSTABILITY = GAUSS_MARKOV_PEAK / FLICKER_FLAT  # B of the flicker noise as high as a Gauss-Markov process of s = 1
SHORT = 0.02  # τ/T below which the Gauss-Markov formula loses digits and its series is used


def white(tau: ArrayLike) -> Array:
    """Return the Allan variance of white noise with N = 1."""
    return 1.0 / np.asarray(tau, dtype=float)


def flicker(tau: ArrayLike) -> Array:
    """Return the Allan variance of flicker noise with B = 1."""
    return np.full_like(np.asarray(tau, dtype=float), FLICKER_FLAT**2)


def gauss_markov(tau: ArrayLike, correlation_time: float) -> Array:
    """Return the Allan variance of a Gauss-Markov process of standard deviation 1."""
    x = np.asarray(tau, dtype=float) / correlation_time
    small = np.minimum(x, SHORT)
    series = small * (2.0 / 3.0 - small * (1.0 / 2.0 - small * (7.0 / 30.0 - small / 12.0)))
    large = np.maximum(x, SHORT)
    decayed = -np.expm1(-large)
    whole = 2.0 / large * (1.0 - decayed * (2.0 + decayed) / (2.0 * large))
    return np.where(x < SHORT, series, whole)


def random_walk(tau: ArrayLike) -> Array:
    """Return the Allan variance of a random walk with K = 1."""
    return np.asarray(tau, dtype=float) / 3.0


def quantisation(tau: ArrayLike) -> Array:
    """Return the Allan variance of the quantisation of an integral, with Q = 1."""
    return 3.0 / np.asarray(tau, dtype=float) ** 2


def sampled(tau: ArrayLike, interval: float) -> Array:
    """Return 1 + 1/(2m²), by which the drifts' Allan variance is larger when they are sampled and not averaged."""
    return 1.0 + 0.5 * (interval / np.asarray(tau, dtype=float)) ** 2


def one_pole(tau: ArrayLike, interval: float, pole: float) -> Array:
    """Return by what fraction white noise behind y += (1 - pole)(x - y) keeps its Allan variance N²/τ.

    In closed form from R_k ∝ pole^|k|; `tau` need not be a multiple of `interval`.
    """
    m = np.asarray(tau, dtype=float) / interval
    if pole == 0.0:
        return np.ones_like(m)
    rest = pole / (1.0 - pole**2)  # m V(m) = 1 - 2 rest (1 - pole^m)/m, with variance 1 at f = 0
    fading = -np.expm1(m * np.log(pole))
    kept: Array = 1.0 - 2.0 * rest * fading * (2.0 - 0.5 * (1.0 + pole**m)) / m
    return kept


def filtered(tau: ArrayLike, interval: float, response: Array) -> Array:
    """Return by what fraction white noise behind a filter of unit gain at f = 0 keeps its Allan variance N²/τ.

    Parameters
    ----------
    tau : array_like
        s.
    interval : float
        Time between readings, s.
    response : numpy.ndarray
        The filter's impulse response, long enough to have died away, shape (n,).
    """
    size = 2 * response.size
    covariance = np.fft.irfft(np.abs(np.fft.rfft(response, size)) ** 2, size)[: response.size]
    covariance /= covariance[0] + 2.0 * covariance[1:].sum()
    lag = np.arange(covariance.size)
    twice = np.where(lag == 0, 1.0, 2.0) * covariance
    near, far = np.cumsum(twice), np.cumsum(twice * lag)
    m = np.asarray(tau, dtype=float) / interval

    def scaled_variance(count: Array) -> Array:
        """Return m V(m), linear between whole m."""
        whole = np.arange(1.0, lag.size + 1.0)
        return np.interp(count, whole, near - far / whole, right=np.nan)

    def variance(count: Array) -> Array:
        beyond = 1.0 - far[-1] / count
        return np.where(count < lag.size, scaled_variance(count), beyond)

    return 2.0 * variance(m) - variance(2.0 * m)


def density_white(f: ArrayLike) -> Array:
    """Return the density of white noise with N = 1."""
    return np.full_like(np.asarray(f, dtype=float), 2.0)


def density_flicker(f: ArrayLike) -> Array:
    """Return the density of flicker noise with B = 1."""
    return 1.0 / (pi * np.asarray(f, dtype=float))


def density_gauss_markov(f: ArrayLike, correlation_time: float) -> Array:
    """Return the density of a Gauss-Markov process of standard deviation 1."""
    return 4.0 * correlation_time / (1.0 + (2.0 * pi * correlation_time * np.asarray(f, dtype=float)) ** 2)


def density_random_walk(f: ArrayLike) -> Array:
    """Return the density of a random walk with K = 1."""
    return 2.0 / (2.0 * pi * np.asarray(f, dtype=float)) ** 2


def density_quantisation(f: ArrayLike) -> Array:
    """Return the density of the quantisation of an integral, with Q = 1."""
    return 2.0 * (2.0 * pi * np.asarray(f, dtype=float)) ** 2


def gain_one_pole(f: ArrayLike, interval: float, pole: float) -> Array:
    """Return |H(f)|² of y += (1 - pole)(x - y)."""
    cosine = np.cos(2.0 * pi * interval * np.asarray(f, dtype=float))
    passed: Array = (1.0 - pole) ** 2 / (1.0 - 2.0 * pole * cosine + pole**2)
    return passed


def gain(f: ArrayLike, interval: float, response: Array) -> Array:
    """Return |H(f)|² of a filter with this impulse response and unit gain at f = 0."""
    phase = -2j * pi * interval * np.asarray(f, dtype=float)
    lags = np.arange(response.size)
    heard = np.array([np.dot(response, np.exp(p * lags)) for p in np.atleast_1d(phase)]) / response.sum()
    passed: Array = np.abs(heard).reshape(np.shape(f)) ** 2
    return passed
