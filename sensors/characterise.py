"""What a record at rest says of a sensor: Allan deviation, power spectral density, histogram, and fitted N, B and K.

Convention: densities are one-sided, n = √2 N (`sensors.allan` has all the equations; IEEE Std 952, NIST SP 1065).

    overlapping Allan deviation    σ²(τ) = ½ ⟨(ȳ(t + τ) - ȳ(t))²⟩ at log-spaced τ, up to a quarter of the record;
                                   68 % intervals of χ² with the equivalent degrees of freedom of Greenhall and Riley
    density                        Welch's periodograms of Hann windows, averaged in log-spaced bands
    histogram                      of the readings less their mean over the τ of the least Allan deviation: of the
                                   noise, that is, without the drift

Hours at a kilohertz are tens of millions of readings. They are kept as a pyramid: the first 2^20 readings as they are,
of the means over 4 the first 2^20, of the means over 16, and so on, which bounds memory and time. An Allan deviation
at τ is taken where τ has 16 to 63 entries (from 1 on the lowest level): the same expectation, and an overlap of 16 a τ
loses less than 1 % of the degrees of freedom of overlapping at each reading. Frequencies are shared out in the same
way.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import log10

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.allan_record import degrees_of_freedom, interval, overlapping
from sensors.noise_fit import Drift, NoiseFit, fit_noise
from sensors.promise import Promise, promised, promises

__all__ = ["Allan", "Characterisation", "Histogram", "NoiseFit", "Promise", "Pyramid", "Spectrum", "allan_deviation",
           "characterise", "fit_noise", "promised", "promises"]  # fmt: skip

Array = NDArray[np.float64]

ROWS = 1 << 20  # kept on each level
RATIO = 4  # readings of a level that make one of the next
LEAST = 2048  # rows that make another level worth while
PER_DECADE = 10  # averaging times
FIRST = 16  # entries a τ from which a level is used, times RATIO where the next takes over
CONFIDENCE = 0.6826895  # one standard deviation of a normal law
SEGMENT = 4096  # readings in a periodogram
BANDS = 24  # a decade of frequency
OVERLAP_BAND = 0.1  # share of a level's rate up to which its means have the density of the readings
NEAR = 3  # points on each side by which a slope is told
BINS, SPAN = 10, 5.0  # bins a standard deviation, where the readings' own steps are finer; half width in such
NARROWEST = 1e-6  # bin of a record that does not move, m/s² or Pa
GRID, OFTEN = 4096, 3  # readings by which the steps are told; how often a value must be among them
SURE = 30.0  # degrees of freedom that an Allan deviation must have to count as the least
FEWEST = 64  # readings below which there is nothing to say


@dataclass(frozen=True, slots=True, eq=False)
class Allan:
    """Overlapping Allan deviation.

    Attributes
    ----------
    tau : numpy.ndarray
        Averaging times, s.
    deviation, low, high : numpy.ndarray
        Allan deviation and its 68 % interval, in the readings' unit.
    edf : numpy.ndarray
        Equivalent degrees of freedom.
    """

    tau: Array
    deviation: Array
    low: Array
    high: Array
    edf: Array


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """One-sided root density, unit/√Hz, at frequencies in Hz."""

    frequency: Array
    density: Array


@dataclass(frozen=True, slots=True, eq=False)
class Histogram:
    """Readings less their drift.

    Attributes
    ----------
    edges, density : numpy.ndarray
        Of the bins, in the readings' unit; share of readings a unit, shape (n + 1,) and (n,).
    sd : float
        Standard deviation.
    resolution : float or None
        Step of the readings; None if they are on no grid.
    window : float
        Length of the means that were taken off, s.
    """

    edges: Array
    density: Array
    sd: float
    resolution: float | None
    window: float


@dataclass(frozen=True, slots=True, eq=False)
class Characterisation:
    """One channel of a record.

    Attributes
    ----------
    channel : str
    rate, duration : float
        Readings a second, Hz, and the time from the first to the last, s.
    count : int
        Readings.
    mean : float
    allan : Allan
    spectrum : Spectrum
    histogram : Histogram
    fit : NoiseFit or None
        None if the record does not move.
    """

    channel: str
    rate: float
    duration: float
    count: int
    mean: float
    allan: Allan
    spectrum: Spectrum
    histogram: Histogram
    fit: NoiseFit | None


class Pyramid:
    """A long record at several grains, in bounded memory.

    Parameters
    ----------
    axes : int
        Columns.
    rows : int
        Most that are kept on a level.

    Attributes
    ----------
    count : int
        Readings taken in.
    mean : numpy.ndarray
        Of all of them, shape (axes,).
    """

    def __init__(self, axes: int, rows: int = ROWS) -> None:
        self._axes, self._rows = axes, rows
        self._kept: list[list[Array]] = []
        self._stored: list[int] = []
        self._rest: list[Array] = []
        self._sum = np.zeros(axes)
        self._origin: Array | None = None
        self.count = 0

    @property
    def mean(self) -> Array:
        """Of all readings, shape (axes,)."""
        assert self._origin is not None
        return self._origin + self._sum / self.count

    def add(self, block: Array) -> None:
        """Take in the next readings, shape (n, axes)."""
        if not len(block):
            return
        if self._origin is None:
            self._origin = block[0].copy()
        block = block - self._origin  # small numbers: sums of 10^8 pascals would lose digits
        self.count += len(block)
        self._sum += block.sum(axis=0)
        level = 0
        while len(block):
            self._keep(level, block)
            block = np.concatenate((self._rest[level], block))
            whole = len(block) // RATIO * RATIO
            self._rest[level] = block[whole:]
            block = block[:whole].reshape(-1, RATIO, self._axes).mean(axis=1)
            level += 1

    def levels(self) -> list[Array]:
        """Return the readings less the first of all, the means over 4, over 16, …, each of shape (n, axes)."""
        return [np.concatenate(kept) for kept in self._kept]

    def _keep(self, level: int, block: Array) -> None:
        if level == len(self._kept):
            self._kept.append([])
            self._stored.append(0)
            self._rest.append(np.empty((0, self._axes)))
        part = block[: self._rows - self._stored[level]]
        if len(part):
            self._kept[level].append(part)
            self._stored[level] += len(part)


def characterise(
    blocks: Iterable[Array], channels: Sequence[str], drift: Drift = "searched"
) -> tuple[Characterisation, ...]:
    """Return the statistics of a record, channel by channel.

    Parameters
    ----------
    blocks : iterable of numpy.ndarray
        The record in turn, shape (n, 1 + len(channels)) or wider: t, s, and the channels; what is beyond is ignored.
        The readings count as equally spaced, at the rate that the first and the last t give.
    channels : sequence of str
        Names of the columns after t.
    drift : float or {"flicker", "searched"}
        What is known of the drift's shape, as of `fit_noise`.

    Returns
    -------
    tuple of Characterisation

    Raises
    ------
    ValueError
        If there are fewer than 64 readings.
    """
    pyramid = Pyramid(len(channels))
    start, end = 0.0, 0.0
    for block in blocks:
        if len(block):
            start, end = (start if pyramid.count else float(block[0, 0])), float(block[-1, 0])
            pyramid.add(block[:, 1 : 1 + len(channels)])
    if pyramid.count < FEWEST:
        raise ValueError(f"{pyramid.count} readings are too few: at least {FEWEST} are needed")
    levels = [level for i, level in enumerate(pyramid.levels()) if i == 0 or len(level) >= LEAST]
    rate = (pyramid.count - 1) / (end - start)
    return tuple(
        _characterise(channel, [np.ascontiguousarray(level[:, axis]) for level in levels], rate, pyramid, axis, drift)
        for axis, channel in enumerate(channels)
    )


def _characterise(
    channel: str, series: list[Array], rate: float, pyramid: Pyramid, axis: int, drift: Drift
) -> Characterisation:
    deviation = _allan(series, rate)
    histogram = _histogram(series[0], rate, deviation)
    step = histogram.resolution or 0.0
    return Characterisation(
        channel=channel,
        rate=rate,
        duration=(pyramid.count - 1) / rate,
        count=pyramid.count,
        mean=float(pyramid.mean[axis]),
        allan=deviation,
        spectrum=_spectrum(series, rate),
        histogram=histogram,
        fit=fit_noise(deviation.tau, deviation.deviation, deviation.edf, rate, drift, step),
    )


# -- Allan deviation -------------------------------------------------------------------------------------------------


def allan_deviation(values: ArrayLike, rate: float, multiples: Sequence[int] | None = None) -> Allan:
    """Return the overlapping Allan deviation of equally spaced readings.

    Parameters
    ----------
    values : array_like
        Shape (n,).
    rate : float
        Readings a second, Hz.
    multiples : sequence of int, optional
        Averaging times in readings; log-spaced up to a quarter of the record if not given.

    Returns
    -------
    Allan
    """
    series = np.asarray(values, dtype=float)
    m = _multiples(1, max(series.size // 4, 1)) if multiples is None else list(multiples)
    deviation, size = overlapping(series, m), [series.size] * len(m)
    return _with_intervals(np.array(m) / rate, deviation, m, size)


def _allan(series: Sequence[Array], rate: float) -> Allan:
    """Allan deviation over a pyramid: each averaging time on the level where it is FIRST to RATIO·FIRST entries."""
    tau: list[float] = []
    deviation: list[float] = []
    multiples: list[int] = []
    sizes: list[int] = []
    for level, values in enumerate(series):
        last = level == len(series) - 1
        m = _multiples(FIRST if level else 1, values.size // 4 if last else RATIO * FIRST - 1)
        tau += [entries * RATIO**level / rate for entries in m]
        deviation += list(overlapping(values, m))
        multiples += m
        sizes += [values.size] * len(m)
    return _with_intervals(np.array(tau), np.array(deviation), multiples, sizes)


def _multiples(first: int, last: int) -> list[int]:
    """Return log-spaced whole numbers."""
    exponents = np.arange(round(PER_DECADE * log10(last)) + 1)
    chosen = {round(float(m)) for m in 10.0 ** (exponents / PER_DECADE)}
    return sorted(m for m in chosen if first <= m <= last)


def _with_intervals(tau: Array, deviation: Array, multiples: Sequence[int], sizes: Sequence[int]) -> Allan:
    points = zip(_exponents(tau, deviation), multiples, sizes, strict=True)
    edf = np.array([degrees_of_freedom(*point) for point in points])
    return Allan(tau, deviation, *interval(deviation, edf, CONFIDENCE), edf)


def _exponents(tau: Array, deviation: Array) -> list[int]:
    """Return α of S(f) ∝ f^α about each point, 0, -1 or -2, from the slope of the Allan variance, τ^(-α-1)."""
    x, y = np.log(tau), 2.0 * np.log(np.maximum(deviation, np.finfo(float).tiny))
    found = []
    for i in range(tau.size):
        near = slice(max(i - NEAR, 0), i + NEAR + 1)
        dx, dy = x[near] - x[near].mean(), y[near] - y[near].mean()
        slope = float(dx @ dy / max(dx @ dx, 1e-12))
        found.append(int(np.clip(round(-1.0 - slope), -2, 0)))
    return found


# -- spectrum and histogram ------------------------------------------------------------------------------------------


def _spectrum(series: Sequence[Array], rate: float) -> Spectrum:
    """Root density over a pyramid: each frequency on the coarsest level whose means still have it."""
    from scipy.signal import welch  # late: it takes half a second

    frequencies, densities = [], []
    for level, values in enumerate(series):
        own, last = rate / RATIO**level, level == len(series) - 1
        f, power = welch(values, fs=own, nperseg=min(SEGMENT, values.size // 4), detrend="constant")
        top = own * (OVERLAP_BAND if level else 0.5)
        least = 2.5 * f[1] if last else OVERLAP_BAND * own / RATIO  # the lowest lines hold what the window leaks
        inside = (f >= least) & (f <= top)
        frequencies.append(f[inside])
        densities.append(power[inside])
    f, power = np.concatenate(frequencies), np.concatenate(densities)
    return Spectrum(*_in_bands(f, power))


def _in_bands(f: Array, power: Array) -> tuple[Array, Array]:
    """Average a density in log-spaced bands; return mean frequencies and root densities."""
    band = np.floor(BANDS * np.log10(f)).astype(int)
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    return np.bincount(index, f) / count, np.sqrt(np.bincount(index, power) / count)


def _histogram(values: Array, rate: float, deviation: Allan) -> Histogram:
    step = _resolution(values)
    sure = deviation.edf >= min(SURE, float(deviation.edf.max()))
    quietest = float(deviation.tau[sure][np.argmin(deviation.deviation[sure])])
    length = min(max(round(quietest * rate), FEWEST), values.size)
    whole = values.size // length * length
    windows = values[:whole].reshape(-1, length)
    means = windows.mean(axis=1, keepdims=True)
    if step is not None:
        means = np.round(means / step) * step  # so that the grid stays
    rest = (windows - means).ravel()
    sd = float(np.sqrt(np.mean((windows - windows.mean(axis=1, keepdims=True)) ** 2)))
    width = sd / BINS or NARROWEST
    if step is not None:
        width = step * (2 * int(width / step / 2.0) + 1)  # whole steps, an odd number: no reading is on an edge
    half = int(np.ceil(SPAN * sd / width)) + 0.5
    edges = width * np.arange(-half, half + 1.0)
    count, _ = np.histogram(rest, edges)
    return Histogram(edges, count / (rest.size * width), sd, step, length / rate)


def _resolution(values: Array) -> float | None:
    """Return the step of the readings, or None if they are on no grid."""
    found, count = np.unique(values[:GRID], return_counts=True)
    levels = found[count >= OFTEN]  # a reading that was filled in stands alone
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * gaps.sum()]  # the same step, but for rounding
    if not gaps.size:
        return None
    steps = gaps / gaps.min()
    on_grid = bool(np.all(np.abs(steps - np.round(steps)) < 0.01))
    return float(gaps.min()) if on_grid and gaps.size > 1 else None
