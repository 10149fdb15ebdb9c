"""How strong the turbulence is that a log's flight went through, by its own pressures and force.

With V_p the airspeed of the pressures and U = ∫f_x dt, the increments of X = V_p − U over a time τ have the variance

    D(τ) = n + q τ + c τ²,      q = 2 σ² V/L + σ_f²/f_s

n is the pressure's noise, q the turbulence along the path (a first-order process of the length L) with the
accelerometer's own noise, and c what gravity and the angle of attack turn into f_x. The variance is that of a Gaussian
with the same median of squares, so that manoeuvres and landings do not count. Turbulence comes and goes: what is believed
is that of a quieter stretch, one in three, for the watch over the ports takes stillness for a fault where gusts are
declared.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from uavsim.logs.head import Head
from uavsim.logs.recording import Array
from uavsim.onboard.airspeed import NoiseModel

LAGS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)  # s
FLIES = 8.0  # m/s, from which on it is a flight
RHO = 1.225  # kg/m³
FEWEST = 60  # increments of a stretch
BLOCK, MANY = 15.0, 600  # s and readings of a stretch, whichever is longer. By hand
QUIETER = 33.0  # percent of the stretches that are quieter than the one that counts. By hand
MEDIAN_SQUARE = 0.4549  # of a standard normal variable
MOST = 5.0  # m/s: severe turbulence


def gust_of(head: Head, readings: Array, noise: NoiseModel, *, zero: float, length: float) -> float | None:
    """Standard deviation of the turbulence along the path, m/s; None where the log shows too little of a flight.

    Parameters
    ----------
    head, readings
        The log.
    noise
        What is believed of its sensors.
    zero
        The pair's difference at rest, Pa.
    length
        L, m.
    """
    t = head.total.t
    difference = head.differences - zero
    flies = difference > 0.5 * RHO * FLIES**2
    good = np.isfinite(readings[:, 1])
    if np.count_nonzero(flies) < FEWEST or np.count_nonzero(good) < FEWEST:
        return None
    at, force = readings[good, 0], readings[good, 1]
    gained = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(at))))
    speed = np.sqrt(2.0 * np.maximum(difference, 0.0) / RHO)
    rest = speed - np.interp(t, at, gained)
    steps = [_steps(t, rest, flies, lag, head.total.period) for lag in LAGS]
    block = np.floor((t - t[0]) / max(BLOCK, MANY * head.total.period))
    rates = [_rate(t, steps, block == one) for one in np.unique(block[flies])]
    known = [rate for rate in rates if rate is not None]
    if not known:
        return None
    rate = float(np.percentile(known, QUIETER))
    own = noise.accelerometer_sd**2 / noise.accelerometer_rate
    mean = float(np.median(speed[flies]))
    return min(MOST, sqrt(max(0.0, rate - own) * length / (2.0 * mean)))


def _steps(t: Array, rest: Array, flies: NDArray[np.bool_], lag: float, period: float) -> tuple[Array, Array]:
    """Increments of X over a lag, m/s, and over which time each is, s; NaN where there is none."""
    later = np.searchsorted(t, t + lag - 0.25 * period)
    there = np.minimum(later, t.size - 1)
    both = flies & flies[there] & (later < t.size) & (np.abs(t[there] - t - lag) < 0.3 * lag)
    return np.where(both, rest[there] - rest, np.nan), t[there] - t


def _rate(t: Array, steps: list[tuple[Array, Array]], rows: NDArray[np.bool_]) -> float | None:
    """The rate q of a stretch, m²/s³; None where it has too few increments."""
    lags, variances = [], []
    for step, over in steps:
        use = rows & np.isfinite(step)
        if np.count_nonzero(use) >= FEWEST:
            lags.append(float(np.mean(over[use])))
            variances.append(max(float(np.median(step[use] ** 2)) / MEDIAN_SQUARE, 1e-12))
    if len(lags) < 4:
        return None
    from scipy.optimize import nnls  # late: a log without pressures does not need it

    tau, d = np.array(lags), np.array(variances)
    (_, rate, _), _ = nnls(np.column_stack([np.ones_like(tau), tau, tau**2]) / d[:, None], np.ones_like(d))
    return float(rate)
