"""N, B, K and Q from an Allan deviation: weighted least squares of the variances of `sensors.allan`.

    σ²(τ) = 3 Q²/τ² + N² κ(τ)/τ + B² h(τ) + K² τ/3,    N², B², K², Q² ≥ 0

κ is what a one-pole low-pass leaves (1: there is none), h the flat of flicker noise or the hump of a Gauss-Markov
process of the same height. The pole and the correlation time are searched; the rest is linear and found by non-negative
least squares. A residual is relative to the model, v/σ² - 1, of variance 2/ν + FLOOR², where ν are the equivalent
degrees of freedom of a point: for large ν that is least squares in log σ², for small ν it is free of the bias that the
logarithm has (it solves the gamma likelihood's equations).

Points of one record are correlated, as a stretch of noise is in all of them. Errors therefore come from the points'
covariance, which the fitted spectrum S and the Allan variance's window |H_τ|² = 2 sin⁴(πfτ)/(πfτ)² give,

    cov(v_i, v_j) ∝ ∫ S² |H_i|² |H_j|² df

through the sandwich (XᵀWX)⁻¹ XᵀWCWX (XᵀWX)⁻¹, pole and correlation time included. A term whose 95 % interval reaches
zero is not resolved by the record: then only its upper bound says something. In trials of 60 records of 36 correlation
times each, with the time given, 92 to 97 % of the intervals of N and 90 to 100 % of those of B and K held the truth;
with it searched only 60 to 95 % of those of B, as flicker noise, a Gauss-Markov process and a random walk are hard to
tell apart on a record of that length.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors import allan

Array = NDArray[np.float64]
Drift = float | Literal["flicker", "searched"]

FLOOR = 0.02  # relative error of the model itself: low-passes have more shapes than one pole
TWO_SIDED, ONE_SIDED = 1.959964, 1.644854  # normal quantiles of a 95 % interval and of a 95 % bound
WORTH = 20.0  # by how much the deviance must fall before a pole is believed
BELIEVED = 20.0  # by how much -2 ln L must fall before a correlation time is believed in place of flicker noise
SHOWS = 0.05  # share of the variance at some τ that a term must have to be called resolved
SLUGGISH = 10.0  # s, longest time constant of a low-pass: white noise behind a longer one is a drift
SLOW = 30.0  # least correlation time over that of the low-pass: low-passed white noise is itself Gauss-Markov
LEAST_TIME = 1.0  # s, correlation time of a drift
TIMES = 24  # correlation times that are tried
MOST_EDF = 1e12  # scipy's quantiles of χ² stay finite
PASSES = 8  # of reweighting; the weights settle within four
POLES = tuple(
    float(p) for p in np.exp(-2.0 * pi * np.geomspace(1e-3, 0.35, 16))
)  # of low-passes at these shares of the rate
LINES = 20_000  # of the spectrum under the covariance integral
LINEAR = ("Q", "N", "B", "K")


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One of N, B, K and Q.

    Attributes
    ----------
    value : float
        u·√s, u, u/√s and u·s, with u the unit of the readings.
    low, high : float
        95 % interval; if the term is not resolved, 0 and the 95 % upper bound.
    resolved : bool
        Whether the record shows the term at all.
    """

    value: float
    low: float
    high: float
    resolved: bool


@dataclass(frozen=True, slots=True)
class NoiseFit:
    """What a record's Allan deviation is made of.

    Attributes
    ----------
    N, B, K, Q : Coefficient
        White noise (its density is √2 N), bias instability, random walk, quantisation of an integral.
    correlation_time : float or None
        Of the drift as a Gauss-Markov process, s; None: flicker noise explains it as well.
    bandwidth : float
        -3 dB frequency of the low-pass that the noise shows, Hz; infinite if it shows none.
    rate : float
        Readings a second, Hz.
    """

    N: Coefficient
    B: Coefficient
    K: Coefficient
    Q: Coefficient
    correlation_time: float | None
    bandwidth: float
    rate: float
    pole: float

    def deviation(self, tau: ArrayLike) -> Array:
        """Return the fitted Allan deviation at each `tau`, s."""
        basis = _basis(np.asarray(tau, dtype=float), 1.0 / self.rate, self.pole, self.correlation_time)
        squares = np.array([getattr(self, name).value ** 2 for name in LINEAR])
        deviation: Array = np.sqrt(basis @ squares)
        return deviation


def fit_noise(tau: Array, deviation: Array, edf: Array, rate: float, drift: Drift = "searched") -> NoiseFit | None:
    """Fit the four terms to an Allan deviation.

    Parameters
    ----------
    tau, deviation, edf : numpy.ndarray
        Averaging times, s, Allan deviation, and the equivalent degrees of freedom of each, shape (n,).
    rate : float
        Readings a second, Hz.
    drift : float or {"flicker", "searched"}
        Correlation time of the drift if it is known, s; flicker noise; or what fits best of the two.

    Returns
    -------
    NoiseFit or None
        None if fewer than five points are above zero: a record that does not move has no noise to fit.
    """
    some = deviation > 0.0
    if np.count_nonzero(some) < len(LINEAR) + 1:
        return None
    data = _Data(tau[some], deviation[some] ** 2, edf[some], 1.0 / rate)
    pole, time = _shape(data, drift)
    squares, _ = data.solve(pole, time)
    errors = _standard_errors(data, pole, time, squares, searched=drift == "searched")
    parts = data.basis(pole, time) * squares
    shares = np.max(parts / parts.sum(axis=1, keepdims=True), axis=0)
    q, n, b, k = (_coefficient(*term) for term in zip(squares, errors, shares, strict=True))
    return NoiseFit(N=n, B=b, K=k, Q=q, correlation_time=time, bandwidth=_bandwidth(pole, rate), rate=rate, pole=pole)


def _coefficient(square: float, error: float, share: float) -> Coefficient:
    from scipy.stats import chi2

    value = sqrt(square)
    if square > TWO_SIDED * error and share > SHOWS:
        edf = min(2.0 * (square / max(error, 1e-300)) ** 2, MOST_EDF)  # a variance spreads as χ² does
        low, high = (value * sqrt(edf / float(chi2.ppf(p, edf))) for p in (0.975, 0.025))
        return Coefficient(value, low, high, resolved=True)
    return Coefficient(value, 0.0, sqrt(square + ONE_SIDED * error), resolved=False)


def _bandwidth(pole: float, rate: float) -> float:
    """-3 dB frequency of y += (1 - pole)(x - y); infinite if it is never reached below half the rate."""
    if pole == 0.0:
        return inf
    cosine = 1.0 - (1.0 - pole) ** 2 / (2.0 * pole)
    return float(np.arccos(cosine)) * rate / (2.0 * pi) if cosine > -1.0 else inf


def _basis(tau: Array, interval: float, pole: float, correlation_time: float | None) -> Array:
    """Allan variances of Q, N, B and K = 1, shape (n, 4)."""
    discrete = allan.sampled(tau, interval)
    if correlation_time is None:
        drift = allan.flicker(tau)
    else:
        drift = allan.gauss_markov(tau, correlation_time) * discrete / allan.INSTABILITY**2
    white = allan.white(tau) * allan.one_pole(tau, interval, pole)
    return np.stack((allan.quantisation(tau), white, drift, allan.random_walk(tau) * discrete), axis=1)


@dataclass(frozen=True)
class _Data:
    """The points and their weights."""

    tau: Array
    variance: Array
    edf: Array
    interval: float

    def basis(self, pole: float, correlation_time: float | None) -> Array:
        return _basis(self.tau, self.interval, pole, correlation_time)

    @property
    def weight(self) -> Array:
        """Of a relative residual."""
        return 1.0 / (2.0 / self.edf + FLOOR**2)

    def solve(self, pole: float, correlation_time: float | None) -> tuple[Array, float]:
        """Return the squares of Q, N, B and K, and the deviance that they leave."""
        from scipy.optimize import nnls  # late: it takes a quarter of a second

        basis, model, root = self.basis(pole, correlation_time), self.variance, np.sqrt(self.weight)
        scale = np.linalg.norm(basis / model[:, None] * root[:, None], axis=0)
        for _ in range(PASSES):
            row = root / model
            found, _ = nnls(basis * row[:, None] / scale, self.variance * row)
            model = np.maximum(basis @ (found / scale), 1e-6 * self.variance)
        ratio = self.variance / model
        return found / scale, float(np.sum(self.weight * 2.0 * (ratio - 1.0 - np.log(ratio))))


def _shape(data: _Data, drift: Drift) -> tuple[float, float | None]:
    """Return pole and correlation time (None: flicker noise)."""
    if drift == "searched":
        return _search(data)
    time = None if drift == "flicker" else float(drift)
    return _best_pole(data, time), time


def _search(data: _Data) -> tuple[float, float | None]:
    """Return the pole and the correlation time (None: flicker noise) that fit best."""
    flicker = _best_pole(data, None)
    shortest = SLOW * max(data.interval, -data.interval / np.log(flicker) if flicker else 0.0)
    times = np.geomspace(max(shortest, LEAST_TIME), 0.5 * data.tau[-1], TIMES)
    if times[-1] <= times[0]:
        return flicker, None
    nearest = float(min(times, key=lambda t: data.solve(flicker, t)[1]))
    reach = float(np.log(times[1] / times[0]))
    time = _refine(lambda z: nearest * float(np.exp(z)), lambda t: data.solve(flicker, t)[1], -reach, reach)
    pole = _best_pole(data, time)
    gain = _surprise(data, flicker, None) - _surprise(data, pole, time)
    return (pole, time) if gain > BELIEVED else (flicker, None)


def _best_pole(data: _Data, time: float | None) -> float:
    poles = [pole for pole in POLES if -data.interval / np.log(pole) < SLUGGISH]
    deviance = {pole: data.solve(pole, time)[1] for pole in (0.0, *poles)}
    pole = min(deviance, key=lambda p: deviance[p] + (WORTH if p else 0.0))
    if pole == 0.0:
        return pole
    at = poles.index(pole)
    slow, fast = (float(np.log(-np.log(poles[i]))) for i in (max(at - 1, 0), min(at + 1, len(poles) - 1)))
    return _refine(lambda z: float(np.exp(-np.exp(z))), lambda p: data.solve(p, time)[1], slow, fast)


def _surprise(data: _Data, pole: float, time: float | None) -> float:
    """Return -2 ln L of the points as correlated normal ones about the best model of this shape."""
    squares, _ = data.solve(pole, time)
    model = data.basis(pole, time) @ squares
    covariance = _correlation(data, pole, time, squares) * _spread(data) + FLOOR**2 * np.eye(data.tau.size)
    residual = data.variance / model - 1.0
    chi_square = float(residual @ np.linalg.solve(covariance, residual))
    return chi_square + float(np.linalg.slogdet(covariance)[1] + 2.0 * np.sum(np.log(model)))


def _refine(back: Callable[[float], float], cost: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(lambda z: cost(back(z)), bounds=(low, high), method="bounded", options={"xatol": 1e-3})
    return float(back(found.x))


def _standard_errors(
    data: _Data, pole: float, correlation_time: float | None, squares: Array, *, searched: bool
) -> Array:
    """Return the standard errors of the squares of Q, N, B and K, the searched shapes' uncertainty included."""
    basis = data.basis(pole, correlation_time)
    model = basis @ squares
    columns = [basis]
    step = 1e-3
    if searched and correlation_time is not None and squares[2] > 0.0:
        columns.append((data.basis(pole, correlation_time * (1.0 + step)) @ squares - model)[:, None] / step)
    if pole > 0.0 and squares[1] > 0.0:
        columns.append((data.basis(pole ** (1.0 + step), correlation_time) @ squares - model)[:, None] / step)
    x = np.hstack(columns) / model[:, None]
    size = np.linalg.norm(x, axis=0)
    x = x / size
    gain = np.linalg.pinv(x * np.sqrt(data.weight)[:, None], rcond=1e-10) * np.sqrt(data.weight)
    covariance = gain @ (_correlation(data, pole, correlation_time, squares) * _spread(data)) @ gain.T
    errors: Array = (np.sqrt(np.maximum(np.diag(covariance), 0.0)) / size)[: len(LINEAR)]
    return errors


def _spread(data: _Data) -> Array:
    sd = np.sqrt(2.0 / data.edf)
    return np.outer(sd, sd)


def _correlation(data: _Data, pole: float, correlation_time: float | None, squares: Array) -> Array:
    """Return how the points of one record are correlated, shape (n, n)."""
    f = np.geomspace(1e-2 / data.tau[-1], 0.5 / data.interval, LINES)
    q, n, b, k = squares
    density = n * allan.density_white(f) * allan.gain_one_pole(f, data.interval, pole)
    density += q * allan.density_quantisation(f) + k * allan.density_random_walk(f)
    if correlation_time is None:
        density += b * allan.density_flicker(f)
    else:
        density += b / allan.INSTABILITY**2 * allan.density_gauss_markov(f, correlation_time)
    x = pi * np.outer(data.tau, f)
    heard = 2.0 * np.sin(x) ** 4 / x**2 * density * np.sqrt(f)  # df = f d(ln f)
    product = heard @ heard.T
    size = np.sqrt(np.diag(product))
    correlation: Array = product / np.outer(size, size)
    return correlation
