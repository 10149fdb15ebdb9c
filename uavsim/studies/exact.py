"""Exact performance of window detectors on a given force curve in white noise, without simulation.

Sample k reads x_k = s_k + v_k, m/s², v_k independent Gaussian of deviation σ_k, so that it exceeds a threshold G with

    P(x_k > G) = Φ((s_k - G) / σ_k)

independently of all others. What a window detector remembers of the past is one of finitely many states, and the
probabilities of these states advance sample by sample as a Markov chain whose recognised states absorb:

- nested windows: idle, or (samples since the trigger, how many of them were above), at most (i·n)²/2 of them; where a
  window is opened by some samples in a row, how long the row is;
- sliding window of n samples that asks for m above: not yet recognised means that the (n - m + 1)-th last sample not
  above is still in the window, so that the places of these last n - m + 1 are all there is to remember: C(n, m - 1)
  states instead of 2ⁿ. With m = n the one place is the length of the run above: a threshold with a hold.
  A hold that a higher level begins has the same states.

The chain counts samples, as the onboard detectors do at a steady rate without gaps; one signed axis.
Source of the method: Fu & Lou, Distribution Theory of Runs and Patterns and Its Applications, 2003, chapter 2 (finite
Markov chain imbedding).
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_STATES = 3_000_000  # –; of a sliding window: about 190 MB and 35 ms a sample. n = 22 has at most 705 432
_MOST_SAMPLES = 63  # –; the places in a sliding window are the bits of one word

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Recognition:
    """When, and in which window, a detector recognises: the distribution of the first passage.

    Attributes
    ----------
    mass : ndarray
        Shape (samples, levels): probability of being recognised at sample k at the end of window l (column l - 1).
        Detectors without levels have one column.
    period : float
        Time between samples, s.
    """

    mass: Floats
    period: float = 1e-3

    @property
    def cumulative(self) -> Floats:
        """Probability of having been recognised by each sample, that sample included, shape (samples,)."""
        return np.cumsum(self.mass.sum(axis=1))

    @property
    def probability(self) -> float:
        """Probability of being recognised at all."""
        return float(self.mass.sum())

    @property
    def levels(self) -> Floats:
        """Probability of being recognised in each window, shape (levels,)."""
        return np.asarray(self.mass.sum(axis=0))

    def latency(self, onset: int = 0) -> "Latency":
        """Distribution of the delay after a sample, given that the recognition comes there or later.

        Parameters
        ----------
        onset
            Sample from which the delay counts. Recognitions before it are false alarms and are left out.

        Raises
        ------
        ValueError
            If the onset is not one of the samples.
        """
        if not 0 <= onset < len(self.mass):
            raise ValueError(f"onset must be one of the {len(self.mass)} samples")
        passage = self.mass[onset:].sum(axis=1)
        return Latency(
            probability=float(passage.sum()),
            false_alarm=float(self.mass[:onset].sum()),
            passage=passage,
            period=self.period,
        )


@dataclass(frozen=True, slots=True)
class Latency:
    """Delay of the recognition after the onset.

    Attributes
    ----------
    probability, false_alarm : float
        Of being recognised at the onset or later, and before it.
    passage : ndarray
        Shape (samples from the onset on,): probability of being recognised at each.
    period : float
        Time between samples, s.
    """

    probability: float
    false_alarm: float
    passage: Floats
    period: float

    @property
    def mean(self) -> float:
        """Mean delay of those recognised, s; NaN if none can be."""
        if self.probability <= 0.0:
            return float("nan")
        return float(np.arange(self.passage.size) @ self.passage) / self.probability * self.period

    @property
    def median(self) -> float:
        """Delay by which half of those recognised are, s; NaN if none can be."""
        return self.quantile(0.5)

    def quantile(self, share: float) -> float:
        """Least delay by which this share of those recognised are, s; NaN if none can be.

        Raises
        ------
        ValueError
            If the share is not above 0 and at most 1.
        """
        if not 0.0 < share <= 1.0:
            raise ValueError("the share must be above 0 and at most 1")
        if self.probability <= 0.0:
            return float("nan")
        by = np.cumsum(self.passage)
        reached = by >= share * by[-1] * (1.0 - 1e-12)  # what is short by rounding is reached
        return float(np.argmax(reached)) * self.period


def exceedance(curve: ArrayLike, sigma: ArrayLike, threshold: float) -> Floats:
    """Probability that each sample reads above a threshold.

    Parameters
    ----------
    curve
        Shape (samples,): mean of each, m/s².
    sigma
        Standard deviation of all or of each, m/s²; where it is 0 a sample reads its mean.
    threshold
        m/s²; a sample is above it if it is strictly so.

    Raises
    ------
    ValueError
        If the curve is empty, something is not finite, or a sigma is negative.
    """
    from scipy.special import ndtr

    mean = np.asarray(curve, dtype=np.float64)
    if mean.ndim != 1 or mean.size == 0 or not np.isfinite(mean).all() or not np.isfinite(threshold):
        raise ValueError("curve must hold at least one value, and it and the thresholds be finite")
    deviation = np.broadcast_to(np.asarray(sigma, dtype=np.float64), mean.shape)
    if not (np.isfinite(deviation).all() and (deviation >= 0.0).all()):
        raise ValueError("sigma must be finite and not negative")
    quiet = deviation == 0.0
    with np.errstate(over="ignore"):  # a tiny sigma: infinitely many of them away is what is meant
        noisy = ndtr((mean - threshold) / np.where(quiet, 1.0, deviation))
    return np.where(quiet, mean > threshold, noisy)


def multi_level_window(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    levels: int,
    ratio: float,
    trigger: float | None = None,
    rearm: bool = True,
    period: float = 1e-3,
) -> Recognition:
    """Exact recognition by `uavsim.onboard.launch.MultiLevelWindow` along one axis.

    Parameters
    ----------
    curve, sigma
        As for `exceedance`. The detector starts idle at the first sample.
    threshold, samples, levels, ratio, trigger, rearm
        G2, n, i, k₁ and G1 of the detector (G1 = G2 if None), in m/s² and samples; the rule, count ≥ k₁·total, is
        decided in whole numbers as onboard.
    period
        Time between samples, s.

    Raises
    ------
    ValueError
        What `exceedance` raises, and settings that the detector refuses.

    Examples
    --------
    >>> result = multi_level_window([60.0] * 30, 0.0, threshold=45.0, samples=18, levels=4, ratio=0.8)
    >>> result.probability, result.latency().median
    (1.0, 0.017)
    """
    chain = _Nested(curve, sigma, threshold, samples, levels, ratio, trigger)
    return Recognition(chain.run(rearm), _positive(period))


def threshold_window(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    ratio: float,
    trigger: float | None = None,
    rearm: bool = True,
    period: float = 1e-3,
) -> Recognition:
    """Exact recognition by one window from the trigger on: nested windows with a single level.

    Parameters and errors are those of `multi_level_window`.
    """
    return multi_level_window(
        curve,
        sigma,
        threshold=threshold,
        samples=samples,
        levels=1,
        ratio=ratio,
        trigger=trigger,
        rearm=rearm,
        period=period,
    )


def sequence_window(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    ratio: float,
    sequence: int,
    trigger: float | None = None,
    period: float = 1e-3,
) -> Recognition:
    """Exact recognition by one window that some samples in a row open, those the first in it; it re-arms.

    Parameters
    ----------
    curve, sigma, threshold, samples, ratio, trigger, period
        As for `multi_level_window`.
    sequence
        How many in a row must be above the trigger, at most `samples`.

    Raises
    ------
    ValueError
        As `multi_level_window`, or if the sequence is out of bounds.
    """
    _check(samples, 1, ratio)
    if sequence != int(sequence) or not 1 <= sequence <= samples:
        raise ValueError("sequence must be a whole number, at least 1 and at most samples")
    chain = _Nested(curve, sigma, threshold, samples, 1, ratio, trigger, sequence)
    return Recognition(chain.run(rearm=True), _positive(period))


def count_sequence(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    counts: tuple[int, ...],
    trigger: float | None = None,
) -> float:
    """Probability that the windows of the first trigger end with just these counts.

    Parameters
    ----------
    curve, sigma, threshold, samples, trigger
        As for `multi_level_window`. Whether a count would recognise plays no part.
    counts
        N at the end of window 1, 2, …

    Raises
    ------
    ValueError
        As `multi_level_window`, or if there are no counts.
    """
    if not counts:
        raise ValueError("there must be at least one count")
    return _Nested(curve, sigma, threshold, samples, len(counts), 1.0, trigger).follow(counts)


def sliding_window(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    ratio: float,
    period: float = 1e-3,
) -> Recognition:
    """Exact recognition by a window of the last n samples, looked at after each.

    Recognised when count ≥ k₁·n; samples before the first are taken as not above, so that a window that is not yet
    full recognises only if what it has is enough for a full one.

    Parameters
    ----------
    curve, sigma, period
        As for `multi_level_window`.
    threshold, samples, ratio
        G, n and k₁, in m/s² and samples.

    Raises
    ------
    ValueError
        What `exceedance` raises; settings out of bounds; or a window of more than 63 samples or `MOST_STATES` states.
    """
    _check(samples, 1, ratio)
    needed = _needed(ratio, samples)
    if samples > _MOST_SAMPLES or comb(samples, needed - 1) > MOST_STATES:
        raise ValueError(
            f"{needed} of {samples} samples have {comb(samples, needed - 1):,} states; "
            f"exact are up to {MOST_STATES:,} and {_MOST_SAMPLES} samples"
        )
    return Recognition(_scan(exceedance(curve, sigma, threshold), samples, needed)[:, np.newaxis], _positive(period))


def hold(
    curve: ArrayLike,
    sigma: ArrayLike,
    *,
    threshold: float,
    samples: int,
    trigger: float | None = None,
    period: float = 1e-3,
) -> Recognition:
    """Exact recognition by a threshold exceeded by so many samples in a row, of any number.

    Parameters
    ----------
    curve, sigma, period
        As for `multi_level_window`.
    threshold, samples
        G, m/s², and how many in a row; the hold at a steady rate is `samples` periods.
    trigger
        Level that the first of them must exceed, m/s², not below the threshold (double threshold); None: the same.

    Raises
    ------
    ValueError
        What `exceedance` raises; settings out of bounds.
    """
    _check(samples, 1, 1.0)
    starts, above = _levels(curve, sigma, threshold, trigger)
    return Recognition(_run(starts, above, samples)[:, np.newaxis], _positive(period))


class _Nested:
    """The chain of nested windows: `at[s, c]` is the probability of s samples in the window, c of them above."""

    def __init__(
        self,
        curve: ArrayLike,
        sigma: ArrayLike,
        threshold: float,
        samples: int,
        levels: int,
        ratio: float,
        trigger: float | None,
        sequence: int = 1,
    ) -> None:
        _check(samples, levels, ratio)
        self._triggers, self._above = _levels(curve, sigma, threshold, trigger)
        self._sequence = sequence
        self._ends = samples * np.arange(1, levels + 1)
        self._needed = [_needed(ratio, int(end)) for end in self._ends]
        self._last = samples * levels

    def run(self, rearm: bool) -> Floats:
        """First-passage probabilities, shape (samples, levels)."""
        mass = np.zeros((self._above.size, self._ends.size))
        at, row = self._start()
        for k, (start, above) in enumerate(zip(self._triggers, self._above, strict=True)):
            at, row = self._step(at, row, start, above)
            for level, (end, needed) in enumerate(zip(self._ends, self._needed, strict=True)):
                mass[k, level] = at[end, needed:].sum()
                at[end, needed:] = 0.0
            if rearm:
                row[0] += at[-1].sum()  # it may trigger again at the next sample
        return mass

    def follow(self, counts: tuple[int, ...]) -> float:
        """Probability of these counts at the ends of the first trigger's windows."""
        total, (at, row) = 0.0, self._start()
        for start, above in zip(self._triggers, self._above, strict=True):
            at, row = self._step(at, row, start, above)
            for end, count in zip(self._ends, counts, strict=True):
                right = at[end, count] if 0 <= count <= end else 0.0
                at[end] = 0.0
                if right:
                    at[end, count] = right
            total += at[-1].sum()
        return float(total)

    def _start(self) -> tuple[Floats, Floats]:
        row = np.zeros(self._sequence)  # row[r]: no window is open, and the last r samples were above the trigger
        row[0] = 1.0
        return np.zeros((self._last + 1, self._last + 1)), row

    def _step(self, at: Floats, row: Floats, start: float, above: float) -> tuple[Floats, Floats]:
        """One sample: every open window grows by it (the full ones are done with), and another may open."""
        new, longer = np.zeros_like(at), np.zeros_like(row)
        new[1:] = (1.0 - above) * at[:-1]
        new[1:, 1:] += above * at[:-1, :-1]
        new[self._sequence, self._sequence] += start * row[-1]
        longer[1:] = start * row[:-1]
        longer[0] = (1.0 - start) * row.sum()
        return new, longer


def _run(starts: Floats, above: Floats, samples: int) -> Floats:
    """First passage of a run of this length: `length[r]` is the probability of a run of r up to now."""
    mass, length = np.zeros(above.size), np.zeros(samples + 1)
    length[0] = 1.0
    for k, (start, p) in enumerate(zip(starts, above, strict=True)):
        longer = np.empty_like(length)
        longer[0] = (1.0 - start) * length[0] + (1.0 - p) * length[1:].sum()
        longer[1] = start * length[0]
        longer[2:] = p * length[1:-1]
        mass[k], longer[-1] = longer[-1], 0.0
        length = longer
    return mass


def _scan(above: Floats, samples: int, needed: int) -> Floats:
    """First passage of `needed` of the last `samples` above."""
    older, full, newest, start = _places(samples, samples - needed + 1)
    mass, state = np.zeros(above.size), np.zeros(older.size + full.size)
    state[start] = 1.0
    open_ = np.setdiff1d(np.arange(state.size), full, assume_unique=True)
    for k, p in enumerate(above):
        mass[k] = p * state[full].sum()
        new = (1.0 - p) * np.bincount(newest, weights=state, minlength=state.size)
        new[older] += p * state[open_]
        state = new
    return mass


@lru_cache(maxsize=4)
def _places(samples: int, zeros: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], int]:
    """States of a sliding window: bit a of a word is set if the sample a ago is one of the last so many not above.

    Returns where a sample above takes the states in which the oldest stays in the window; the states in which it does
    not, so that they are recognised; where a sample not above takes every state; and the state before the first
    sample, all of them not above.
    """
    words = _words(samples, zeros)
    top = np.uint64(1) << np.uint64(samples - 1)
    leaves = (words & top) != 0
    one = np.uint64(1)
    highest = words.copy()
    for shift in (1, 2, 4, 8, 16, 32):  # all bits below the highest one
        highest |= highest >> np.uint64(shift)
    rest = words & (highest >> one)  # the oldest is forgotten
    older = np.searchsorted(words, words[~leaves] << one)
    newest = np.searchsorted(words, (rest << one) | one)
    return older, np.flatnonzero(leaves), newest, 0


def _words(bits: int, ones: int) -> NDArray[np.uint64]:
    """All words of so many bits with so many ones, ascending."""
    if 2 * ones > bits:
        return (_words(bits, bits - ones) ^ np.uint64((1 << bits) - 1))[::-1]
    having = [np.zeros(1, dtype=np.uint64)] + [np.zeros(0, dtype=np.uint64)] * ones  # of the bits so far, by ones
    for bit in range(bits):
        for k in range(ones, 0, -1):
            having[k] = np.concatenate([having[k], having[k - 1] | (np.uint64(1) << np.uint64(bit))])
    return having[ones]


def _levels(curve: ArrayLike, sigma: ArrayLike, threshold: float, trigger: float | None) -> tuple[Floats, Floats]:
    """Probability that each sample is above the trigger, and above the threshold."""
    above = exceedance(curve, sigma, threshold)
    if trigger is None:
        return above, above
    if not trigger >= threshold:
        raise ValueError("trigger must not be below threshold")
    return exceedance(curve, sigma, trigger), above


def _needed(ratio: float, total: int) -> int:
    """Least count with count ≥ ratio·total, in whole numbers as the detectors decide."""
    share, of = Fraction(ratio).limit_denominator().as_integer_ratio()
    return -(-share * total // of)


def _check(samples: int, levels: int, ratio: float) -> None:
    if samples != int(samples) or levels != int(levels) or samples < 1 or levels < 1:
        raise ValueError("samples and levels must be whole numbers of at least 1")
    if not 0.0 < ratio <= 1.0:
        raise ValueError("ratio must be above 0 and at most 1")


def _positive(period: float) -> float:
    if not 0.0 < period < np.inf:
        raise ValueError("period must be above 0 and finite")
    return period
