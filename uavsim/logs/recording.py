"""Readings of specific force on a log's own time axis, with what is missing and what is clipped."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

COLUMNS = ("t", "fx", "fy", "fz")
AXES = COLUMNS[1:]
GAP = 3.0  # median intervals, beyond which readings are missing; as the detectors have it
CLIPPED = 1.5 * STANDARD_GRAVITY  # m/s²; an extreme below is no end of a range
HELD = 3  # readings in a row that hold the extreme value to call it clipped


@dataclass(frozen=True, slots=True)
class Gap:
    """Readings that are missing: the times of those before and after, s."""

    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Clipping:
    """An axis that stays at its extreme value.

    Attributes
    ----------
    axis : str
    level : float
        m/s².
    samples : int
        How many readings hold it.
    start : float
        The first of them, s.
    """

    axis: str
    level: float
    samples: int
    start: float


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Readings of specific force from somebody's log.

    Attributes
    ----------
    files : tuple of str
        Names of the files.
    mapping : str
        The map that was given, empty without one.
    readings : numpy.ndarray
        Shape (n, 4): t, s, strictly rising, and fx, fy, fz, m/s²; NaN where the log holds no number.
    remarks : tuple of str
        What was not as it should be, a sentence each.
    """

    files: tuple[str, ...]
    mapping: str
    readings: Array
    remarks: tuple[str, ...]

    @property
    def rate(self) -> float:
        """Median rate, Hz."""
        interval = float(np.median(np.diff(self.readings[:, 0])))
        return 1.0 / interval if interval > 0.0 else np.inf

    @property
    def span(self) -> tuple[float, float]:
        """First and last time, s."""
        return float(self.readings[0, 0]), float(self.readings[-1, 0])

    def gaps(self) -> list[Gap]:
        """Where more than `GAP` median intervals lie between two readings."""
        t = self.readings[:, 0]
        rows = np.flatnonzero(np.diff(t) > GAP / self.rate * (1.0 + 1e-6))
        return [Gap(float(t[i]), float(t[i + 1])) for i in rows]

    def clipping(self) -> list[Clipping]:
        """Return the axes whose greatest or least value is held for `HELD` readings in a row."""
        found = (self._held(axis, sign) for axis in AXES for sign in (1.0, -1.0))
        return [clipped for clipped in found if clipped is not None]

    def _held(self, axis: str, sign: float) -> Clipping | None:
        f = sign * self.readings[:, COLUMNS.index(axis)]
        if not np.isfinite(f).any() or (level := float(np.nanmax(f))) < CLIPPED:
            return None
        edges = np.diff(np.concatenate(([0], (f == level).astype(int), [0])))
        starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
        if (ends - starts).max() < HELD:
            return None
        first = starts[np.argmax(ends - starts >= HELD)]
        return Clipping(axis, sign * level, int((ends - starts).sum()), float(self.readings[first, 0]))
