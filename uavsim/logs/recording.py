"""Readings of specific force on a log's own time axis, what is missing and clipped, and what else the log holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sensors.bench_log import Source
from sensors.text import brief
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

COLUMNS = ("t", "fx", "fy", "fz")
AXES = COLUMNS[1:]
SERIES = {
    "p_total": "Pa",
    "p_static": "Pa",
    "p_difference": "Pa",
    "temperature": "K",
    "airspeed_reference": "m/s",
    "equivalent_airspeed": "m/s",
    "baro_height": "m",
    "roll": "rad",
    "pitch": "rad",
    "heading": "rad",
    "north_speed": "m/s",
    "east_speed": "m/s",
    "down_speed": "m/s",
    "ground_speed": "m/s",
    "clips_x": "",
    "clips_y": "",
    "clips_z": "",
    "satellites": "",
}
"""What else a log may hold, with its unit: pressures, temperature of the air, airspeeds of others (true, equivalent),
pressure height, attitude, velocity over ground, the log's own counts of clipped readings, satellites in use."""
GAP = 3.0  # median intervals, beyond which readings are missing; as the detectors have it
CLIPPED = 1.5 * STANDARD_GRAVITY  # m/s²; an extreme below is no end of a range
SAMPLED_AND_HELD = 0.3  # share of rows that repeat those before them, from which a log holds each reading for some
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
class Series:
    """One quantity of a log, with time stamps of its own.

    Attributes
    ----------
    name : str
        One of `SERIES`.
    t : numpy.ndarray
        s, on the log's clock, strictly rising.
    values : numpy.ndarray
        In the unit of `SERIES`; NaN where the log holds no number.
    source : str
        Which file and column it is.
    """

    name: str
    t: Array
    values: Array
    source: str


@dataclass(frozen=True, slots=True)
class Origin:
    """What one of ours was read from.

    Attributes
    ----------
    source : Source
    stated : bool
        Whether its factor was stated, or known by the format, be it 1.
    """

    source: Source
    stated: bool = False

    def written(self, *, negated: bool = False) -> str:
        """Return it as a map says it, or with the other sign."""
        sign = -1.0 if negated else 1.0
        factor, offset = sign * self.source.factor, sign * self.source.offset
        times = f"*{abs(factor):.10g}" if self.stated or abs(factor) != 1.0 else ""
        return f"{'-' if factor < 0.0 else ''}{brief(self.source.column)}{times}{f'{offset:+.10g}' if offset else ''}"


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Readings of specific force from somebody's log, and what else it holds.

    Attributes
    ----------
    files : tuple of str
        Names of the files.
    mapping : str
        The map that was given, empty without one.
    readings : numpy.ndarray
        Shape (n, 4): t, s, strictly rising within a part, and fx, fy, fz, m/s²; NaN where the log holds no number.
    remarks : tuple of str
        What was not as it should be, and what was assumed, a sentence each.
    series : mapping
        What else the log holds, by the names of `SERIES`.
    cuts : tuple of int
        Rows at which a part begins, whose clock began anew or whose rate is another; none if the log is of one part.
    others : mapping
        Readings of the log's other accelerometers, as `readings`, by the names of their messages.
    origins : mapping
        What each axis was read from; and t, where a map must say it.
    """

    files: tuple[str, ...]
    mapping: str
    readings: Array
    remarks: tuple[str, ...]
    series: Mapping[str, Series] = field(default_factory=dict)
    cuts: tuple[int, ...] = ()
    others: Mapping[str, Array] = field(default_factory=dict)
    origins: Mapping[str, Origin] = field(default_factory=dict)

    @property
    def parts(self) -> list[range]:
        """Rows of each part: a detector of its own is for each of them."""
        return [range(*ends) for ends in pairwise((0, *self.cuts, len(self.readings)))]

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes that the log holds."""
        held = np.atleast_1d(np.isfinite(self.readings[:, 1:]).any(axis=0)).tolist()
        return tuple(axis for axis, is_held in zip(AXES, held, strict=True) if is_held)

    @property
    def rate(self) -> float:
        """Median rate, Hz."""
        return self.rate_of(range(len(self.readings)))

    def rate_of(self, part: range) -> float:
        """Median rate of a part, Hz."""
        step = np.diff(self.readings[part.start : part.stop, 0])
        step = step[step > 0.0]
        return 1.0 / float(np.median(step)) if step.size else np.inf

    @property
    def span(self) -> tuple[float, float]:
        """Least and greatest time, s."""
        return float(self.readings[:, 0].min()), float(self.readings[:, 0].max())

    @property
    def duration(self) -> float:
        """Of all parts together, s."""
        t = self.readings[:, 0]
        return float(sum(t[part.stop - 1] - t[part.start] for part in self.parts))

    def gaps(self) -> list[Gap]:
        """Where more than `GAP` median intervals of its part lie between two readings."""
        found = []
        for part in self.parts:
            t = self.readings[part.start : part.stop, 0]
            rows = np.flatnonzero(np.diff(t) > GAP / self.rate_of(part) * (1.0 + 1e-6))
            found += [Gap(float(t[i]), float(t[i + 1])) for i in rows]
        return found

    def clipping(self) -> list[Clipping]:
        """Return the axes whose greatest or least value is held for `HELD` readings in a row that differ otherwise.

        Rows that say in all axes what the row before said are one reading: a logger that is faster than its sensor
        writes each more than once. Where there is but one axis a reading counts for as many rows as is usual.
        """
        found = (self._held(axis, sign) for axis in AXES for sign in (1.0, -1.0))
        return [clipped for clipped in found if clipped is not None]

    def _held(self, axis: str, sign: float) -> Clipping | None:
        f = sign * self.readings[:, COLUMNS.index(axis)]
        if not np.isfinite(f).any() or (level := float(np.nanmax(f))) < CLIPPED:
            return None
        edges = np.diff(np.concatenate(([0], (f == level).astype(int), [0])))
        starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
        lengths = self._readings_in(starts, ends)
        if lengths.max() < HELD:
            return None
        first = starts[np.argmax(lengths >= HELD)]
        return Clipping(axis, sign * level, int((ends - starts).sum()), float(self.readings[first, 0]))

    def _readings_in(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> Array:
        """How many readings there are in runs of rows, those that say the same counted once."""
        force = self.readings[:, 1:]
        axes = np.isfinite(force).any(axis=0)
        new = np.concatenate(([True], (force[1:, axes] != force[:-1, axes]).any(axis=1)))
        if np.count_nonzero(axes) < 2:
            usual: float = np.count_nonzero(new) / new.size
            return np.asarray((ends - starts) * usual, np.float64)
        before = np.concatenate(([0], np.cumsum(new)))
        return np.asarray(np.maximum(before[ends] - before[starts + 1] + 1, 1), np.float64)
