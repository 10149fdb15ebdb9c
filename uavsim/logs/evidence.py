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
class Repeats:
    """Follows rows that say what the row before said.

    Attributes
    ----------
    rows, changes : int
        How many rows there are, and how many differ from the one before.
    longest : list of Still
        Spells of rows that repeat, of some length.
    """

    rows: int = 0
    changes: int = 0
    longest: list[Still] = field(default_factory=list)
    _last: Array | None = None
    _since: Still | None = None

    def add(self, t: Array, values: Array) -> None:
        """Take the next rows: times, s, and what they say, shape (n, columns)."""
        before = np.vstack((np.full((1, values.shape[1]), np.nan) if self._last is None else self._last, values[:-1]))
        same = ((values == before) | (np.isnan(values) & np.isnan(before))).all(axis=1) & ~np.isnan(values).all(axis=1)
        self.rows += t.size
        self.changes += int(np.count_nonzero(~same))
        edges = np.concatenate(([0], np.flatnonzero(~same[1:]) + 1, [t.size]))
        lengths = np.diff(edges)
        for i in sorted({*np.flatnonzero(lengths >= STILL_ROWS).tolist(), 0, lengths.size - 1}):
            first, stop = int(edges[i]), int(edges[i + 1])
            spell = Still(float(t[first]), float(t[stop - 1]), stop - first, tuple(values[first].tolist()))
            if i == 0 and same[0] and self._since is not None:
                spell = replace(self._since, end=spell.end, rows=self._since.rows + spell.rows)
                if self.longest and self.longest[-1] == self._since:
                    self.longest.pop()
            if spell.rows >= STILL_ROWS and spell.end - spell.start >= STILL and len(self.longest) < MOST_STILL:
                self.longest.append(spell)
            if stop == t.size:
                self._since = spell
        self._last = values[-1].copy()

    @property
    def spells(self) -> list[Still]:
        """Spells in which rows repeat for far longer than is usual, in the order of time.

        Where several say the same it is the step of a coarse sensor that rests.
        """
        usual = max(1.0, (self.rows - sum(s.rows for s in self.longest)) / max(self.changes - len(self.longest), 1))
        found = [spell for spell in self.longest if spell.rows >= STILL_TIMES * usual]
        often = Counter(repr(spell.reads) for spell in self.longest)
        return sorted((spell for spell in found if often[repr(spell.reads)] == 1), key=lambda spell: spell.start)


@dataclass(slots=True, eq=False)
class Evidence:
    """What is collected of a log's readings.

    Attributes
    ----------
    rate : float
        Median rate, Hz.
    """

    rate: float
    _all: Repeats = field(default_factory=Repeats)
    _each: tuple[Repeats, ...] = field(default_factory=lambda: tuple(Repeats() for _ in AXES))
    _least: Array = field(default_factory=lambda: np.full(len(AXES), np.inf))
    _most: Array = field(default_factory=lambda: np.full(len(AXES), -np.inf))
    _blocks: list[Array] = field(default_factory=list)
    _left: Array = field(default_factory=lambda: np.empty((0, 4)))

    @property
    def rows(self) -> int:
        """How many there were."""
        return self._all.rows

    def add(self, readings: Array) -> None:
        """Take the next rows: t, s, and fx, fy, fz, m/s²; shape (n, 4)."""
        if not len(readings):
            return
        t, force = readings[:, 0], readings[:, 1:]
        self._all.add(t, force)
        for i, axis in enumerate(self._each):
            axis.add(t, force[:, i : i + 1])
        self._least, self._most = (
            np.fmin(self._least, np.fmin.reduce(force)),
            np.fmax(self._most, np.fmax.reduce(force)),
        )
        size = max(FEWEST, round(BLOCK * self.rate))
        rows = np.concatenate((self._left, readings)) if len(self._left) else readings
        whole = len(rows) // size * size
        self._left = rows[whole:].copy()
        if whole:
            self._blocks.append(_blocks(rows[:whole].reshape(-1, size, 4)))

    @property
    def repeats(self) -> list[Still]:
        """Spells in which all axes repeat what they said before."""
        return self._all.spells

    @property
    def stuck(self) -> dict[str, list[Still]]:
        """Spells in which one axis repeats while others live, by its name; one that is at its extreme is clipped."""
        whole, found = self.repeats, {}
        for axis, of, least, most in zip(AXES, self._each, self._least.tolist(), self._most.tolist(), strict=True):
            spells = [
                spell
                for spell in of.spells
                if spell.reads[0] not in (least, most, 0.0)
                and not any(other.start <= spell.end and spell.start <= other.end for other in whole)
            ]
            if spells and any(other is not of and other.changes > 1 for other in self._each):
                found[axis] = spells
        return found

    @property
    def dead(self) -> dict[str, float]:
        """Axes that read the same from the first row to the last while others live, by name, with what they read."""
        lives = self._most > self._least
        ends = zip(AXES, self._least.tolist(), lives.tolist(), strict=True)
        return {axis: reads for axis, reads, alive in ends if not alive and np.isfinite(reads) and lives.any()}

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
