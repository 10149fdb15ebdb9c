"""A launch detector over a long log, by its loop over arrays.

The loop takes samples at the times k / rate. A log's stamps jitter and leave some out: a reading that stands for n
periods, up to three, is given n times, as `step` counts it, and after a longer gap the detector begins anew. What the
loop finds is looked at again by `step` at the readings' own times, from some seconds before on, and counts where that
says so.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from uavsim.logs.recording import AXES, GAP, Array
from uavsim.onboard import launch
from uavsim.onboard.launch.detector import ROUNDING
from uavsim.onboard.launch.loops import loop_of, row_of

PAUSE = 1.0  # s from a detection until the detector is reset and watches again; strokes last up to 0.4 s
BEFORE = 5.0  # s that `step` is given before what the loop found; what it keeps of the force before is younger
AROUND = 0.2  # s by which `step` and the loop may differ, for jitter


@dataclass(slots=True, eq=False)
class Watch:
    """A detector that watches lots of readings.

    Attributes
    ----------
    settings : DetectorSettings
    rate : float
        Of the part that is watched, Hz.
    axes : tuple of str
        That the log holds; the others read 0.
    detections : list of float
        Times at which it recognised a launch, s.
    """

    settings: launch.DetectorSettings
    rate: float
    axes: Sequence[str] = AXES
    detections: list[float] = field(default_factory=list)
    _resume: float = -np.inf  # from when on it watches, s
    _recent: Array = field(default_factory=lambda: np.empty((0, 4)))
    _loop: Any = None
    _run: Any = None
    _rows: tuple[str, ...] = ()
    _x: Any = None
    _y: Any = None
    _k: int = 0
    _last: float = np.nan

    def begin(self, rate: float) -> None:
        """Begin a part of the log, with its rate, Hz."""
        self.rate = rate
        detector = launch.build(self.settings, rate)
        self._loop, self._run = loop_of(detector)
        told = ("any",) if self.settings.axes == "any" else self.settings.axes
        self._rows = self._loop.rows or told
        self._recent, self._last, self._resume, self._k = np.empty((0, 4)), np.nan, -np.inf, 0
        self._anew()

    def _anew(self) -> None:
        self._x, self._y = np.array(self._loop.x, np.float64), np.array(self._loop.y, np.int64)
        self._y[0] = self._k

    def take(self, readings: Array) -> None:
        """Watch readings that follow those before."""
        if len(self.axes) < len(AXES):
            readings = readings.copy()
            readings[:, [1 + i for i, axis in enumerate(AXES) if axis not in self.axes]] = 0.0
        known = np.vstack((self._recent, readings))
        offset = len(self._recent)
        t = readings[:, 0]
        periods = np.diff(t, prepend=self._last) * self.rate
        gaps = np.flatnonzero(~(periods <= GAP * ROUNDING))  # the first reading of all, too
        many = np.clip(np.rint(np.where(np.isfinite(periods), periods, 1.0)), 1, GAP).astype(np.intp)
        many[gaps] = 1
        edges = [0, *[int(gap) for gap in gaps if gap > 0], len(readings)]
        anew = {int(gap) for gap in gaps}
        for start, end in pairwise(edges):
            if start in anew:
                self._anew()
            self._segment(readings, start, end, many, known, offset)
        self._last = float(t[-1])
        keep = np.searchsorted(known[:, 0], self._last - BEFORE - AROUND)
        self._recent = known[keep:].copy()

    def _segment(self, readings: Array, start: int, end: int, many: Any, known: Array, offset: int) -> None:
        """Watch readings without a gap between them."""
        out = np.empty(1, np.int64)
        while start < end:
            if readings[start, 0] < self._resume:
                start += int(np.searchsorted(readings[start:end, 0], self._resume))
                self._anew()
                continue
            times = many[start:end]
            force = np.repeat(readings[start:end, 1:], times, axis=0) if times.max() > 1 else readings[start:end, 1:]
            rows = [row_of(force, name) for name in self._rows]
            block = np.ascontiguousarray(rows[0]) if len(rows) == 1 else np.stack(rows)
            if not self._run(block, self._k, self.rate, self._loop.p, self._loop.q, self._x, self._y, out):
                self._k += block.shape[-1]
                return
            place = start + int(np.searchsorted(np.cumsum(times), int(out[0]) - self._k, side="right"))
            self._k += int(times[: place - start + 1].sum())
            t = self._decided(known, offset + place)
            self.detections.append(t)
            self._resume = t + PAUSE
            start = place + 1
            if start < end and readings[start, 0] >= self._resume:
                self._anew()

    def _decided(self, known: Array, place: int) -> float:
        """When `step` recognises what the loop found."""
        found = float(known[place, 0])
        begin = max(self._resume, found - BEFORE)
        detector = launch.build(self.settings, self.rate)
        first = int(np.searchsorted(known[:, 0], begin))
        last = int(np.searchsorted(known[:, 0], found + AROUND))
        for t, fx, fy, fz in known[first:last].tolist():
            if detector.step(t, fx, fy, fz):
                if abs(t - found) <= AROUND:
                    return float(t)
                detector.reset()
        return found
