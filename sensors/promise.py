"""What a description promises of a record at rest: Allan deviation and density, term by term, and N, B, K.

White noise has the standard deviation σ_w a reading ahead of the part's low-pass or digital filter, so N = σ_w √τ_0,
and the filter bends the Allan deviation down at short τ. Rounding to steps q adds white noise of variance q²/12; an
accelerometer rounds behind its low-pass, a pressure sensor ahead of its digital filter. Drift is a Gauss-Markov
process or flicker noise of the same peak, with a random walk beside it. Turn-on errors do not show. The equations are
those of `sensors.allan`.
"""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors import allan
from sensors.accelerometer_description import AccelerometerDescription
from sensors.noise import FLICKER_SPAN, _correlation_times
from sensors.pressure_description import PressureDescription

Array = NDArray[np.float64]
Description = AccelerometerDescription | PressureDescription

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
    _response: Array | None
    _round_is_filtered: bool

    def terms(self, tau: ArrayLike) -> dict[str, Array]:
        """Return the Allan deviation of each of `TERMS`, u, at each `tau`, s."""
        interval, tau = 1.0 / self.rate, np.asarray(tau, dtype=float)
        kept = 1.0 if self._response is None else allan.filtered(tau, interval, self._response)
        discrete = allan.sampled(tau, interval)
        drift = (sd**2 * allan.gauss_markov(tau, time) * discrete for sd, time in self._drifts)
        variances = (
            self._white**2 * allan.white(tau) * kept,
            self._round**2 * allan.white(tau) * (kept if self._round_is_filtered else 1.0),
            sum(drift, np.zeros_like(tau)),
            self.K**2 * allan.random_walk(tau) * discrete,
        )
        return {name: np.sqrt(variance) for name, variance in zip(TERMS, variances, strict=True)}

    def deviation(self, tau: ArrayLike) -> Array:
        """Return the whole Allan deviation, u, at each `tau`, s."""
        whole: Array = np.sqrt(sum(term**2 for term in self.terms(tau).values()))
        return whole

    def density(self, f: ArrayLike) -> Array:
        """Return the whole one-sided root density, u/√Hz, at each frequency, Hz, up to half the rate."""
        interval, f = 1.0 / self.rate, np.asarray(f, dtype=float)
        kept = 1.0 if self._response is None else allan.gain(f, interval, self._response)
        drift = sum(sd**2 * allan.density_gauss_markov(f, time) for sd, time in self._drifts)
        white = self._white**2 * kept + self._round**2 * (kept if self._round_is_filtered else 1.0)
        whole: Array = np.sqrt(white * allan.density_white(f) + drift + self.K**2 * allan.density_random_walk(f))
        return whole


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
    1.41
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
    response = None if passes >= d.rate / 2.0 else low_pass(passes, d.rate, d.poles)
    per_reading = sqrt(1.0 / d.rate)
    rounding = d.resolution / sqrt(12.0)
    flicker = d.errors.drift_model == "flicker"
    return tuple(
        Promise(
            channel=channel,
            unit="m/s²",
            rate=d.rate,
            resolution=d.resolution,
            noise_sd=sqrt(noise**2 + rounding**2),
            N=per_reading * sqrt(white**2 + rounding**2),
            B=allan.INSTABILITY * d.drift_sd,
            K=d.random_walk,
            correlation_time=None if flicker else d.correlation_time,
            bandwidth=float("inf") if response is None else passes,
            _drifts=_drifts(d),
            _white=white * per_reading,
            _round=rounding * per_reading,
            _response=response,
            _round_is_filtered=False,
        )
        for channel, white, noise in zip(("fx", "fy", "fz"), d.white_sd, d.noise_sd, strict=True)
    )


def _pressure(d: PressureDescription) -> Promise:
    a, per_reading, rounding = d.iir_weight, sqrt(1.0 / d.rate), d.resolution / sqrt(12.0)
    before = sqrt(d.white_sd**2 + rounding**2)
    flicker = d.errors.drift_model == "flicker"
    return Promise(
        channel="pressure",
        unit="Pa",
        rate=d.rate,
        resolution=d.resolution,
        noise_sd=before * sqrt(a / (2.0 - a)),
        N=per_reading * before,
        B=allan.INSTABILITY * d.drift_sd,
        K=d.random_walk,
        correlation_time=None if flicker else d.correlation_time,
        bandwidth=float("inf") if a == 1.0 else d.bandwidth,
        _drifts=_drifts(d),
        _white=d.white_sd * per_reading,
        _round=rounding * per_reading,
        _response=None if a == 1.0 else _decay(a),
        _round_is_filtered=True,
    )


def _drifts(d: Description) -> tuple[tuple[float, float], ...]:
    """Standard deviations and correlation times of the Gauss-Markov processes that the drift is drawn from."""
    if d.errors.drift_model == "gauss-markov":
        return ((d.drift_sd, d.correlation_time),)
    times, ratio = _correlation_times(d.correlation_time / FLICKER_SPAN, d.correlation_time * FLICKER_SPAN)
    sd = allan.INSTABILITY * d.drift_sd * sqrt(log(ratio) / pi)
    return tuple((sd, float(time)) for time in times)


def _decay(a: float) -> Array:
    """Impulse response of y += a (x - y), down to 1e-12."""
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
        return _decay(float(np.sqrt(c * c + 2.0 * c) - c))  # |H|² = a²/(a² + 2 (1 - a) c) = 1/2
    from scipy.signal import butter, lfilter  # late: it takes half a second

    impulse = np.zeros(int(8.0 * rate / bandwidth) + 8)
    impulse[0] = 1.0
    response: Array = lfilter(*butter(2, bandwidth, fs=rate), impulse)
    return response
