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
rounds its readings, not their integral, adds noise of variance q²/12, white if the noise is, as long as that is not
far below q.
"""

from functools import lru_cache
from math import exp, expm1, log, pi, sqrt, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.noise import FLICKER_FLAT, GAUSS_MARKOV_PEAK

Array = NDArray[np.float64]

INSTABILITY = GAUSS_MARKOV_PEAK / FLICKER_FLAT  # B of the flicker noise as high as a Gauss-Markov process of s = 1
HARMONICS = 40  # of the rounding error's series: what is left out of it is 2 % of one hundredth
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


def drift_behind(tau: ArrayLike, correlation_time: float, interval: float, pole: float) -> Array:
    """Return the Allan variance of a sampled Gauss-Markov process of standard deviation 1 behind a one-pole filter.

    With ψ = e^{-τ_0/T} and the filter y += (1 - φ)(x - y), R_k = A ψ^|k| + C φ^|k| by partial fractions,

        A = (1 - φ)²/((1 - φ/ψ)(1 - φψ)),    C = (1 - φ)² (1 - ψ²)/((1 - ψ/φ)(1 - φψ)(1 - φ²))

    which slow drift passes at τ far above the filter's time constant, and not below.
    """
    tau = np.asarray(tau, dtype=float)
    slow = gauss_markov(tau, correlation_time) * sampled(tau, interval)
    if pole == 0.0:
        return slow
    step = interval / correlation_time
    psi, common = exp(-step), (1.0 - pole) ** 2 / (1.0 - pole * exp(-step))
    of_slow = common / (1.0 - pole / psi)
    of_filter = common * -expm1(-2.0 * step) / ((1.0 - psi / pole) * (1.0 - pole**2))
    fast = (1.0 + pole) / (1.0 - pole) * one_pole(tau, interval, pole) * interval / tau
    behind: Array = of_slow * slow + of_filter * fast
    return behind


def decay(a: float) -> Array:
    """Return the impulse response of y += a (x - y), down to 1e-12."""
    response: Array = a * (1.0 - a) ** np.arange(int(28.0 / a) + 1, dtype=float)
    return response


def low_pass(bandwidth: float, rate: float, poles: int) -> Array:
    """Return the impulse response of the discrete low-pass behind which an accelerometer's noise is.

    Parameters
    ----------
    bandwidth : float
        -3 dB frequency, below half the rate, Hz.
    rate : float
        Hz.
    poles : int
        1: y += a (x - y); 2: Butterworth by the bilinear transform.
    """
    if poles == 1:
        c = 1.0 - np.cos(2.0 * np.pi * bandwidth / rate)
        return decay(float(np.sqrt(c * c + 2.0 * c) - c))  # |H|² = a²/(a² + 2 (1 - a) c) = 1/2
    from scipy.signal import butter, lfilter  # late: it takes half a second

    b, a = butter(2, bandwidth, fs=rate)
    slowest = float(np.max(np.abs(np.roots(a))))
    impulse = np.zeros(int(28.0 / -log(slowest)) + 8)  # down to 1e-12
    impulse[0] = 1.0
    response: Array = lfilter(b, a, impulse)
    return response


def autocovariance(response: Array) -> Array:
    """Return R_k, k ≥ 0, of white noise of variance 1 behind a filter, from its impulse response; shape (n,)."""
    size = 2 * response.size
    covariance: Array = np.fft.irfft(np.abs(np.fft.rfft(response, size)) ** 2, size)[: response.size]
    return covariance


def rounding(correlation: Array, ratio: float) -> Array:
    """Return R_k of what rounding to steps of 1 adds to normal noise of standard deviation `ratio`.

    A sine series of the rounding error, each harmonic's characteristic function: with ρ_k the noise's correlation,

        R_k = 1/(2π²) Σ_n exp(-4π² n² ratio² (1 - ρ_k))/n²

    which is 1/12 at k = 0, and nothing else if the noise is white. Good to 1 % from ratio = 1/2 on.

    Parameters
    ----------
    correlation : numpy.ndarray
        ρ_k, k ≥ 0, shape (n,).
    ratio : float
        Of the noise's standard deviation to the step.
    """
    harmonic = np.arange(1.0, HARMONICS + 1.0)[:, np.newaxis] ** 2
    series = np.exp(-4.0 * pi**2 * ratio**2 * harmonic * (1.0 - correlation)) / harmonic
    covariance: Array = series.sum(axis=0) / (2.0 * pi**2)
    covariance[0] = 1.0 / 12.0
    return covariance


def correlated(tau: ArrayLike, interval: float, covariance: Array) -> Array:
    """Return the Allan variance of noise of this autocovariance over that of white noise of the same level at f = 0.

    Parameters
    ----------
    tau : array_like
        s; need not be a multiple of `interval`.
    interval : float
        Time between readings, s.
    covariance : numpy.ndarray
        R_k, k ≥ 0, until it has died away, shape (n,).
    """
    lag = np.arange(covariance.size)
    twice = np.where(lag == 0, 1.0, 2.0) * covariance
    near, far = np.cumsum(twice), np.cumsum(twice * lag)
    whole = np.arange(1.0, lag.size + 1.0)
    m = np.asarray(tau, dtype=float) / interval

    def scaled_variance(count: Array) -> Array:
        """Return m V(m), linear between whole m."""
        within = np.interp(count, whole, near - far / whole)
        return np.where(count < lag.size, within, near[-1] - far[-1] / count)

    kept: Array = (2.0 * scaled_variance(m) - scaled_variance(2.0 * m)) / near[-1]
    return kept


def low_passed(tau: ArrayLike, interval: float, share: float, poles: int) -> Array:
    """Return by what fraction white noise behind a low-pass keeps its Allan variance N²/τ, in closed form.

    Parameters
    ----------
    tau : array_like
        s; need not be a multiple of `interval`.
    interval : float
        Time between readings, s.
    share : float
        -3 dB frequency over the rate, below 0.5.
    poles : int
        As of `low_pass`.
    """
    p, c, r0 = _pole_and_residue(share, poles)  # R_k = Re(c p^k) for k > 0
    m = np.asarray(tau, dtype=float) / interval

    def scaled_variance(count: Array) -> Array:
        """Return m V(m)."""
        correlated = c * (p / (1.0 - p) - p * (1.0 - p**count) / (count * (1.0 - p) ** 2))
        return r0 + 2.0 * np.real(correlated)

    kept: Array = (2.0 * scaled_variance(m) - scaled_variance(2.0 * m)) / (r0 + 2.0 * (c * p / (1.0 - p)).real)
    return kept


@lru_cache(maxsize=1024)
def _pole_and_residue(share: float, poles: int) -> tuple[complex, complex, float]:
    response = low_pass(share, 1.0, poles)
    if poles == 1:
        return complex(1.0 - response[0]), 1.0 + 0.0j, 1.0
    s = tan(pi * share) * complex(-sqrt(0.5), sqrt(0.5))
    p = (1.0 + s) / (1.0 - s)
    r0, r1, r2 = autocovariance(response)[:3]
    square = p * p
    real, imaginary = np.linalg.solve([[p.real, -p.imag], [square.real, -square.imag]], [r1, r2])
    return p, complex(real, imaginary), float(r0)


def gain_low_pass(f: ArrayLike, interval: float, share: float, poles: int) -> Array:
    """Return |H(f)|² of such a low-pass, up to half the rate."""
    if poles == 1:
        return gain_one_pole(f, interval, _pole_and_residue(share, 1)[0].real)
    passed: Array = 1.0 / (1.0 + (np.tan(pi * interval * np.asarray(f, dtype=float)) / tan(pi * share)) ** 4)
    return passed


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


def shape(f: ArrayLike, interval: float, covariance: Array) -> Array:
    """Return the density of noise of this autocovariance over what it is at f = 0."""
    lag = np.arange(1, covariance.size)
    angle = 2.0 * pi * interval * np.atleast_1d(np.asarray(f, dtype=float))
    level = [covariance[0] + 2.0 * float(covariance[1:] @ np.cos(a * lag)) for a in angle]
    relative: Array = np.array(level).reshape(np.shape(f)) / (covariance[0] + 2.0 * covariance[1:].sum())
    return np.maximum(relative, 0.0)
