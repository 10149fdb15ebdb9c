"""What a log's readings show by themselves: how they rest, how far they reach, and whether they live.

Readings are cut into blocks of `BLOCK`; each has its mean vector and its deviation. What is quiet is rest, or steady
flight, and an accelerometer reads 1 g there, wherever it points. Rows that say what the row before said are held: by a
logger that is faster than its sensor, or by a sensor that has died.

All of it is collected in one pass over chunks of rows, in memory that grows by some numbers a block.
"""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from uavsim.logs.recording import AXES, Array
from uavsim.truth import STANDARD_GRAVITY

BLOCK = 0.25  # s: short beside the rest before a launch, and 12 readings at 50 Hz
FEWEST = 10  # readings in a block
FEWEST_BLOCKS = 4  # quiet ones: less may be a stroke
QUIET = 2.0  # times the deviation that a tenth of the blocks do not exceed, up to which a block is quiet
KNOWN = 0.1 * STANDARD_GRAVITY  # m/s², up to which the mean of a block may be unsure
LIVES = 2e-4  # g: a block that moves less than this repeats itself, in whatever unit
STILL = 0.1  # s, for which readings repeat at least to be told
STILL_ROWS, STILL_TIMES = 10, 8.0  # rows, and times what a row is held on average, likewise
MOST_STILL = 1000  # spells that are kept
SIGNED = tuple(sign + axis[1] for axis in AXES for sign in "+-")


@dataclass(frozen=True, slots=True)
class Still:
    """Rows that repeat the one before.

    Attributes
    ----------
    start, end : float
        Times of the first and the last of them, s.
    rows : int
    reads : tuple of float
        What they say, m/s².
    """

    start: float
    end: float
    rows: int
    reads: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """What quiet blocks read.

    Attributes
    ----------
    vectors : numpy.ndarray
        Shape (blocks, 3): mean of each, m/s².
    sizes : numpy.ndarray
        Their lengths.
    """

    vectors: Array
    sizes: Array

    def share(self, size: float, within: float) -> float:
        """Which part of them reads a size, up to a fraction of it."""
        return float(np.mean(np.abs(self.sizes - size) <= within * size)) if self.sizes.size else 0.0

    @property
    def axes(self) -> list[str]:
        """Those that there are."""
        return [axis for i, axis in enumerate(AXES) if np.isfinite(self.vectors[:, i]).any()]

    @property
    def middle(self) -> float:
        """Median of what they read, m/s²."""
        return float(np.median(self.sizes))


@dataclass(slots=True, eq=False)
class Evidence:
    """What is collected of a log's readings.

    Attributes
    ----------
    rate : float
        Median rate, Hz.
    rows, changes : int
        How many rows there are, and how many differ from the one before.
    longest : list of Still
        Spells of rows that repeat, of some length.
    """

    rate: float
    rows: int = 0
    changes: int = 0
    longest: list[Still] = field(default_factory=list)
    _blocks: list[Array] = field(default_factory=list)
    _left: Array = field(default_factory=lambda: np.empty((0, 4)))
    _last: Array | None = None
    _since: Still | None = None

    def add(self, readings: Array) -> None:
        """Take the next rows: t, s, and fx, fy, fz, m/s²; shape (n, 4)."""
        if not len(readings):
            return
        self._watch(readings)
        size = max(FEWEST, round(BLOCK * self.rate))
        rows = np.concatenate((self._left, readings)) if len(self._left) else readings
        whole = len(rows) // size * size
        self._left = rows[whole:].copy()
        if whole:
            self._blocks.append(_blocks(rows[:whole].reshape(-1, size, 4)))

    def _watch(self, readings: Array) -> None:
        """Follow rows that repeat."""
        force = readings[:, 1:]
        before = np.vstack((np.full((1, 3), np.nan) if self._last is None else self._last, force[:-1]))
        same = ((force == before) | (np.isnan(force) & np.isnan(before))).all(axis=1) & np.isfinite(force).any(axis=1)
        self.rows += len(readings)
        self.changes += int(np.count_nonzero(~same))
        t = readings[:, 0]
        edges = [0, *(np.flatnonzero(~same[1:]) + 1).tolist(), len(readings)]
        lengths = np.diff(edges)
        least = max(3, STILL_ROWS - 1)
        for i in {*np.flatnonzero(lengths >= least).tolist(), 0, len(lengths) - 1}:
            a, b = edges[i], edges[i + 1]
            spell = Still(float(t[a]), float(t[b - 1]), int(lengths[i]), tuple(force[a].tolist()))
            if i == 0 and same[0] and self._since is not None:
                spell = replace(self._since, end=spell.end, rows=self._since.rows + spell.rows)
                if self.longest and self.longest[-1] == self._since:
                    self.longest.pop()
            if spell.rows >= STILL_ROWS and spell.end - spell.start >= STILL and len(self.longest) < MOST_STILL:
                self.longest.append(spell)
            if b == len(readings):
                self._since = spell
        self._last = force[-1].copy()

    @property
    def held(self) -> float:
        """For how many rows a reading is held on average."""
        return self.rows / max(self.changes, 1)

    @property
    def repeats(self) -> list[Still]:
        """Spells in which readings repeat for far longer than is usual in this log, in the order of time.

        Where several say the same it is the step of a coarse sensor that rests.
        """
        usual = max(1.0, (self.rows - sum(s.rows for s in self.longest)) / max(self.changes - len(self.longest), 1))
        found = [spell for spell in self.longest if spell.rows >= STILL_TIMES * usual]
        often = Counter(repr(spell.reads) for spell in self.longest)
        return sorted((spell for spell in found if often[repr(spell.reads)] == 1), key=lambda spell: spell.start)

    def rest(self) -> Rest:
        """Return what quiet blocks read whose mean is known well enough; along axes that the log has."""
        table = np.concatenate(self._blocks) if self._blocks else np.empty((0, 7))
        vectors, deviation, n = table[:, :3], table[:, 3:6], table[:, 6]
        present = np.isfinite(vectors).any(axis=0)
        sizes = np.sqrt(np.nansum(vectors[:, present] ** 2, axis=1)) if present.any() else np.zeros(len(table))
        moving = np.sqrt(np.nansum(deviation**2, axis=1))
        sound = np.isfinite(vectors[:, present]).all(axis=1) & (n >= FEWEST)
        lives = sound & (moving > LIVES * np.maximum(sizes, 1.0))
        chosen = lives if lives.any() else sound
        if not chosen.any():
            return Rest(np.empty((0, 3)), np.empty(0))
        quiet = chosen & (moving <= QUIET * float(np.quantile(moving[chosen], 0.1)))
        unsure = moving / np.sqrt(np.maximum(n, 1.0))
        quiet &= unsure <= np.maximum(KNOWN, 0.1 * sizes)
        if np.count_nonzero(quiet) < FEWEST_BLOCKS:
            return Rest(np.empty((0, 3)), np.empty(0))
        return Rest(vectors[quiet], sizes[quiet])


def _blocks(rows: NDArray[np.float64]) -> Array:
    """Mean, deviation and number of blocks, shape (blocks, 7); of an axis that has no number in one, NaN."""
    force = rows[:, :, 1:]
    sound = np.isfinite(force)
    n = sound.sum(axis=1)
    some = np.where(n > 0, n, 1)
    mean = np.where(sound, force, 0.0).sum(axis=1) / some
    away = np.where(sound, force - mean[:, np.newaxis], 0.0)
    deviation = np.sqrt((away**2).sum(axis=1) / some)
    absent = n == 0
    mean[absent] = deviation[absent] = np.nan
    return np.column_stack([mean, deviation, n.max(axis=1)])


def collected(readings: Array, rate: float) -> Evidence:
    """Return what readings that are in memory show."""
    evidence = Evidence(rate)
    evidence.add(readings)
    return evidence
