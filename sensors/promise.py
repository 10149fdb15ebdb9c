"""What a description promises of a record at rest: Allan deviation and density, term by term, and N, B, K.

White noise has the standard deviation σ_w a reading ahead of the part's low-pass or digital filter, so N = σ_w √τ_0,
and the filter bends the Allan deviation down at short τ. Rounding to steps q adds noise of variance q²/12. Drift
is a Gauss-Markov process or flicker noise of the same peak, with a random walk beside it. An accelerometer drifts and
rounds behind its low-pass, a pressure sensor ahead of its digital filter. Turn-on errors do not show. The equations
are those of `sensors.allan`.
"""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors import allan
from sensors.accelerometer_description import AccelerometerDescription
from sensors.noise import FLICKER_SPAN, correlation_times
from sensors.pressure_description import PressureDescription

Array = NDArray[np.float64]
Description = AccelerometerDescription | PressureDescription

AGES = 1e6  # correlation times over the longest averaging time from which a drift is a random walk
TERMS = ("white noise", "quantisation", "bias instability", "random walk")


@dataclass(frozen=True, slots=True, eq=False)
class Promise:
    """What is promised of one channel; the unit u is m/s² or Pa.

    Attributes
    ----------
    channel, unit : str
        "fx", "fy", "fz" or "pressure"; "m/s²" or "Pa".
    rate : float
        Nominal readings a second, Hz.
    resolution : float
        Step of a reading, u.
    noise_sd : float
        Standard deviation a reading of white noise and rounding, behind the filters, u.
    N : float
        Of white noise and rounding together, u·√s: the density is √2 N, u/√Hz.
    B, K : float
        Bias instability, u, and random walk, u/√s.
    correlation_time : float or None
        Of the drift, s; None for flicker noise.
    bandwidth : float
        -3 dB frequency behind which the white noise is, Hz; infinite if nothing filters it.
    """

    channel: str
    unit: str
    rate: float
    resolution: float
    noise_sd: float
    N: float
    B: float
    K: float
    correlation_time: float | None
    bandwidth: float
    _drifts: tuple[tuple[float, float], ...]
    _white: float
    _round: float
    _white_covariance: Array | None
    _round_covariance: Array | None
    _pole: float

    def terms(self, tau: ArrayLike) -> dict[str, Array]:
        """Return the Allan deviation of each of `TERMS`, u, at each `tau`, s."""
        interval, tau = 1.0 / self.rate, np.asarray(tau, dtype=float)
        drift = (sd**2 * allan.drift_behind(tau, time, interval, self._pole) for sd, time in self._drifts)
        walk = AGES * float(np.max(tau, initial=interval))  # a random walk is a Gauss-Markov process of endless T
        variances = (
            self._white**2 * allan.white(tau) * _kept(tau, interval, self._white_covariance),
            self._round**2 * allan.white(tau) * _kept(tau, interval, self._round_covariance),
            sum(drift, np.zeros_like(tau)),
            self.K**2 * 0.5 * walk * allan.drift_behind(tau, walk, interval, self._pole),
        )
        return {name: np.sqrt(variance) for name, variance in zip(TERMS, variances, strict=True)}

    def deviation(self, tau: ArrayLike) -> Array:
        """Return the whole Allan deviation, u, at each `tau`, s."""
        whole: Array = np.sqrt(sum(term**2 for term in self.terms(tau).values()))
        return whole

    def density(self, f: ArrayLike) -> Array:
        """Return the whole one-sided root density, u/√Hz, at each frequency, Hz, up to half the rate."""
        interval, f = 1.0 / self.rate, np.asarray(f, dtype=float)
        drift = sum(sd**2 * allan.density_gauss_markov(f, time) for sd, time in self._drifts)
        drift += self.K**2 * allan.density_random_walk(f)
        white = self._white**2 * _shape(f, interval, self._white_covariance)
        white += self._round**2 * _shape(f, interval, self._round_covariance)
        behind = allan.gain_one_pole(f, interval, self._pole)
        whole: Array = np.sqrt(white * allan.density_white(f) + drift * behind)
        return whole


def _kept(tau: Array, interval: float, covariance: Array | None) -> Array | float:
    return 1.0 if covariance is None else allan.correlated(tau, interval, covariance)


def _shape(f: Array, interval: float, covariance: Array | None) -> Array:
    return np.ones_like(f) if covariance is None else allan.shape(f, interval, covariance)


def promises(description: Description) -> tuple[Promise, ...]:
    """Return what a part at its range, rate and filter promises: of fx, fy and fz, or of pressure.

    Parameters
    ----------
    description : AccelerometerDescription or PressureDescription

    Examples
    --------
    >>> from sensors import preset
    >>> x, y, z = promises(preset("adxl345"))
    >>> round(z.N / x.N, 2)
    1.47
    """
    if isinstance(description, AccelerometerDescription):
        return _accelerometer(description)
    return (_pressure(description),)


def promised(description: Description, tau: ArrayLike, channel: str | None = None) -> dict[str, Array]:
    """Return the Allan deviation that a part promises: each of `TERMS`, and their "total".

    Parameters
    ----------
    description : AccelerometerDescription or PressureDescription
    tau : array_like
        Averaging times, s.
    channel : str, optional
        "fx", "fy", "fz" or "pressure"; the first is the default.

    Returns
    -------
    dict of str to numpy.ndarray
        m/s² or Pa, of the shape of `tau`.
    """
    known = {promise.channel: promise for promise in promises(description)}
    promise = known[channel or next(iter(known))]
    return {**promise.terms(tau), "total": promise.deviation(tau)}


def _accelerometer(d: AccelerometerDescription) -> tuple[Promise, ...]:
    passes = d.noise_bandwidth
    filtered = passes < d.rate / 2.0
    covariance = allan.autocovariance(allan.low_pass(passes, d.rate, d.poles)) if filtered else None
    return tuple(
        _axis(d, channel, white, noise, covariance)
        for channel, white, noise in zip(("fx", "fy", "fz"), d.white_sd, d.noise_sd, strict=True)
    )


def _axis(d: AccelerometerDescription, channel: str, white: float, noise: float, covariance: Array | None) -> Promise:
    """Of one axis: `white` and `noise` are the standard deviations ahead of its low-pass and behind it."""
    q, per_reading = d.resolution, sqrt(1.0 / d.rate)
    rounded = None if covariance is None else allan.rounding(covariance / covariance[0], noise / q)
    error = q * sqrt(1.0 / 12.0 if rounded is None else rounded[0] + 2.0 * rounded[1:].sum())  # at f = 0
    return Promise(
        channel=channel,
        unit="m/s²",
        rate=d.rate,
        resolution=q,
        noise_sd=sqrt(noise**2 + q**2 / 12.0),
        N=per_reading * sqrt(white**2 + error**2),
        B=allan.INSTABILITY * d.drift_sd,
        K=d.random_walk,
        correlation_time=None if d.errors.drift_model == "flicker" else d.correlation_time,
        bandwidth=float("inf") if covariance is None else d.noise_bandwidth,
        _drifts=_drifts(d),
        _white=white * per_reading,
        _round=error * per_reading,
        _white_covariance=covariance,
        _round_covariance=rounded,
        _pole=0.0,
    )


def _pressure(d: PressureDescription) -> Promise:
    a, per_reading, rounding = d.iir_weight, sqrt(1.0 / d.rate), d.resolution / sqrt(12.0)
    before = sqrt(d.white_sd**2 + rounding**2)
    covariance = None if a == 1.0 else allan.autocovariance(allan.decay(a))
    return Promise(
        channel="pressure",
        unit="Pa",
        rate=d.rate,
        resolution=d.resolution,
        noise_sd=before * sqrt(a / (2.0 - a)),
        N=per_reading * before,
        B=allan.INSTABILITY * d.drift_sd,
        K=d.random_walk,
        correlation_time=None if d.errors.drift_model == "flicker" else d.correlation_time,
        bandwidth=float("inf") if a == 1.0 else d.bandwidth,
        _drifts=_drifts(d),
        _white=d.white_sd * per_reading,
        _round=rounding * per_reading,
        _white_covariance=covariance,
        _round_covariance=covariance,
        _pole=1.0 - a,
    )


def _drifts(d: Description) -> tuple[tuple[float, float], ...]:
    """Standard deviations and correlation times of the Gauss-Markov processes that the drift is drawn from."""
    if d.errors.drift_model == "gauss-markov":
        return ((d.drift_sd, d.correlation_time),)
    times, ratio = correlation_times(d.correlation_time / FLICKER_SPAN, d.correlation_time * FLICKER_SPAN)
    sd = allan.INSTABILITY * d.drift_sd * sqrt(log(ratio) / pi)
    return tuple((sd, float(time)) for time in times)
