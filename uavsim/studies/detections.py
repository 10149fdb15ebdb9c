"""What a launch detector makes of long records and of many short ones, decided as by `step`, at 1e8 samples a second.

A detector is built from its settings as for a flight, and hands over its rule as a loop over arrays
(`uavsim.onboard.launch.compiled`). One that has none is stepped, a hundred times slower. Samples are taken at
t_k = k / rate.
"""

from collections.abc import Iterable
from itertools import repeat
from typing import cast

import numpy as np

from uavsim.onboard.launch import DetectorSettings, build
from uavsim.onboard.launch.compiled import Forces
from uavsim.onboard.launch.loops import Indices, loop_of, row_of

FIRST_BLOCK = 4096  # samples that are looked at before more are


class BatchDetector:
    """A detector over arrays; decisions are those of `step` at the times k / rate, each alarm followed by `reset`.

    Parameters
    ----------
    settings : DetectorSettings
        Which detector.
    rate : float
        Samples a second, Hz.

    Attributes
    ----------
    columns : tuple of int
        Body axes that it reads, of 0, 1, 2 = x, y, z.

    Raises
    ------
    ValueError
        Settings that do not fit together.
    """

    __slots__ = ("_k", "_loop", "_rows", "_run", "_x", "_y", "columns", "rate", "settings")

    def __init__(self, settings: DetectorSettings, rate: float) -> None:
        self.settings, self.rate = settings, float(rate)
        self._loop, self._run = loop_of(build(settings, rate))
        self._rows = self._loop.rows or (("any",) if settings.axes == "any" else settings.axes)
        read = (0, 1, 2) if "any" in self._rows else sorted({"xyz".index(row[1]) for row in self._rows})
        self.columns = tuple(read)
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next sample is number 0."""
        self._k = 0
        self._x, self._y = np.array(self._loop.x, np.float64), np.array(self._loop.y, np.int64)

    def alarms(self, force: Forces) -> Indices:
        """Take the next samples.

        Parameters
        ----------
        force : ndarray
            Specific force, m/s², float32 or float64: shape (n, 3), or (n,) along the body axis that is read.

        Returns
        -------
        ndarray
            Numbers of the samples at which a launch was recognised, counted since `reset`.

        Raises
        ------
        ValueError
            If the shape is another, or the detector needs more axes.
        """
        return self._take(force, len(force), self.rate)

    def first(self, trials: Iterable[Forces], rates: Iterable[float] | None = None) -> Indices:
        """Number of the sample of the first alarm in each of some records, -1 where there is none.

        Parameters
        ----------
        trials : iterable of ndarray
            Shape (n, 3) or (n,) each, m/s²; each begins at t = 0 with the detector as new.
        rates : iterable of float, optional
            Samples a second that the clock of each sensor really gave, Hz; the detector is built for its nominal rate.
        """
        found = []
        for force, rate in zip(trials, repeat(self.rate) if rates is None else rates, strict=False):
            self.reset()
            alarm = self._take(force, 1, float(rate))
            found.append(int(alarm[0]) if alarm.size else -1)
        self.reset()
        return np.array(found, np.int64)

    def read(self, force: Forces) -> Forces:
        """What the detector reads of a record, contiguous, for `next_alarm`; see `alarms` for the shape."""
        return self._read(force)

    def next_alarm(self, read: Forces, start: int, rate: float) -> int:
        """Number of the sample of the first alarm of a record by a detector that is new at sample `start`; -1: none.

        Parameters
        ----------
        read : ndarray
            What `read` gave of the record.
        start : int
            Times are those of the record: sample k at k / rate.
        rate : float
            Samples a second that the clock really gave, Hz.
        """
        x, y = np.array(self._loop.x, np.float64), np.array(self._loop.y, np.int64)
        y[0] = start
        out, size, end = np.empty(1, np.int64), FIRST_BLOCK, read.shape[-1]
        while start < end:  # in blocks that grow: rows are copied, and an alarm is often near
            block = np.ascontiguousarray(read[..., start : start + size])
            if self._run(block, start, rate, self._loop.p, self._loop.q, x, y, out):
                return int(out[0])
            start, size = start + size, 2 * size
        return -1

    def _take(self, force: Forces, most: int, rate: float) -> Indices:
        out = np.empty(max(1, most), np.int64)
        count = self._run(self._read(force), self._k, rate, self._loop.p, self._loop.q, self._x, self._y, out)
        self._k += len(force)
        return out[:count]

    def _read(self, force: Forces) -> Forces:
        """Return what the kernel reads, contiguous."""
        if force.ndim == 1 and len(self.columns) == 1:
            rows = [force if self._rows[0][0] == "+" else -force]
        elif force.ndim == 2 and force.shape[1] == 3:
            rows = [row_of(force, name) for name in self._rows]
        else:
            raise ValueError(f"force must have the shape (n, 3), or (n,) where one axis is read, not {force.shape}")
        if len(rows) == 1:
            return cast(Forces, np.ascontiguousarray(rows[0]))
        return cast(Forces, np.stack(rows))


def has_loop(settings: DetectorSettings, rate: float) -> bool:
    """Whether the detector that settings name has its rule as a loop."""
    return hasattr(build(settings, rate), "loop")
