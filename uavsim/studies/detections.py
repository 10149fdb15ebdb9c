"""What a launch detector makes of long records and of many short ones, decided as by `step`, at 1e8 samples a second.

A detector is built from its settings as for a flight, and its numbers are handed to the compiled loop of its kind
(`uavsim.studies.kernels`). Samples are taken at t_k = k / rate.

Notes
-----
A new kind of detector needs three things: a kernel, an entry in `MAKERS` that hands its numbers over, and nothing else:
the tests hold every kind that `uavsim.onboard.launch` has against its own `step`.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import repeat
from math import nan
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.launch import (
    AdaptiveCusum,
    AltOs,
    ArduPilot,
    Cusum,
    Detector,
    DetectorSettings,
    DoubleThreshold,
    GlrBank,
    Inav,
    MultiLevelWindow,
    Paparazzi,
    Px4,
    Px4Norm,
    SequenceWindow,
    SingleThreshold,
    SlidingWindow,
    ThresholdWindow,
    build,
)
from uavsim.onboard.launch.detector import ROUNDING
from uavsim.onboard.launch.field import BLOCK
from uavsim.onboard.launch.glr import SCALE
from uavsim.onboard.plausible import MOST_FORCE

Forces = NDArray[np.float64] | NDArray[np.float32]
Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Parts:
    """A kernel's name, a detector's numbers, and its state before the first sample; `rows`: what it reads."""

    kernel: str
    p: tuple[float, ...]
    q: tuple[int, ...] | Indices = (0,)
    x: tuple[float, ...] = (0.0,)
    y: tuple[int, ...] = (0,)
    rows: tuple[str, ...] = field(default=())  # signed axes, or "any"; () is the settings' own


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

    __slots__ = ("_k", "_kernel", "_parts", "_rows", "_x", "_y", "columns", "rate", "settings")

    def __init__(self, settings: DetectorSettings, rate: float) -> None:
        self.settings, self.rate = settings, float(rate)
        detector = build(settings, rate)
        self._parts = MAKERS[type(detector)](detector)
        self._rows = self._parts.rows or (("any",) if settings.axes == "any" else settings.axes)
        read = (0, 1, 2) if "any" in self._rows else sorted({"xyz".index(row[1]) for row in self._rows})
        self.columns = tuple(read)
        self._kernel = kernel(self._parts.kernel)
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next sample is number 0."""
        self._k = 0
        self._x, self._y = np.array(self._parts.x, np.float64), np.array(self._parts.y, np.int64)

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

    def _take(self, force: Forces, most: int, rate: float) -> Indices:
        out = np.empty(max(1, most), np.int64)
        p = self._parts
        count = self._kernel(self._read(force), self._k, rate, p.p, p.q, self._x, self._y, out)
        self._k += len(force)
        return out[:count]

    def _read(self, force: Forces) -> Forces:
        """Return what the kernel reads, contiguous."""
        if force.ndim == 1 and len(self.columns) == 1:
            rows = [force if self._rows[0][0] == "+" else -force]
        elif force.ndim == 2 and force.shape[1] == 3:
            rows = [_row(force, name) for name in self._rows]
        else:
            raise ValueError(f"force must have the shape (n, 3), or (n,) where one axis is read, not {force.shape}")
        if len(rows) == 1:
            return cast(Forces, np.ascontiguousarray(rows[0]))
        return cast(Forces, np.stack(rows))


def _row(force: Forces, name: str) -> Forces:
    if name == "any":
        size = np.abs(force)
        return cast(Forces, np.where(size < MOST_FORCE, size, 0.0).max(axis=1))  # NaN is not below either
    column = force[:, "xyz".index(name[1])]
    return column if name[0] == "+" else -column


def kernel(name: str) -> Callable[..., int]:
    """Return the compiled loop of a name; numba is loaded here."""
    from uavsim.studies import kernels, kernels_field
    from uavsim.studies.compiled import JIT, on_plain_numbers

    found: Callable[..., int] = getattr(kernels, name, None) or getattr(kernels_field, name)
    return found if JIT else on_plain_numbers(found)


# -- numbers of each detector as it was built ------------------------------------------------------------------------


def _nested(d: Any) -> Parts:
    c = d._counters[0]
    q = c._samples, c._levels, c._needed, c._of, int(c._rearm)
    axes = len(d._counters)
    return Parts("nested" if axes == 1 else "nested_axes", (c._trigger, c._threshold), q, y=(0,) * (1 + 4 * axes))


def _sliding(d: Any) -> Parts:
    return Parts("sliding", (d._threshold,), (d._samples, d._needed), y=(0,) * (3 + d._samples))


def _sequence(d: Any) -> Parts:
    return Parts("sequence", (d._trigger, d._threshold), (d._samples, d._sequence, d._needed), y=(0,) * 4)


def _hold(d: Any) -> Parts:
    return Parts("hold", (d._trigger, d._threshold, d._window, d._period), y=(0, 0))


def _cusum(d: Any) -> Parts:
    return Parts("cusum", (d._reference, d._rise, d._fall, d._limit, d._period))


def _adaptive_cusum(d: Any) -> Parts:
    p = d._reference, d._rise, d._fall, d._least, d._highest, d._gain, d._most, d._follow, d._forget, d._period
    return Parts("adaptive_cusum", p, x=(0.0, 0.5 * d._most, 0.0))


def _glr(d: Any) -> Parts:
    lengths, limits = [n for n, _ in d._windows], [limit for _, limit in d._windows]
    q = np.array([len(lengths), *lengths, *limits], np.int64)
    state = (0, 0, lengths[-1], *(0,) * (len(lengths) + lengths[-1]))
    return Parts("glr", (d._reference, d._fall, d._span, SCALE), q, y=state)


_NO_MEAN = nan, nan, 0.0, 0.0


def _px4(d: Any) -> Parts:
    p = d._acceleration, d._exceeded, d._interval, d._period, BLOCK, ROUNDING
    return Parts("px4", p, x=(*_NO_MEAN, 0.0, 0.0))


def _px4_norm(d: Any) -> Parts:
    p = d._acceleration, d._exceeded, d._interval, d._period, BLOCK, ROUNDING
    return Parts("px4_norm", p, x=(nan,) * 6 + (0.0,) * 6, rows=("+x", "+y", "+z"))


def _ardupilot(d: Any) -> Parts:
    p = d._acceleration, d._delay, d._interval, d._period, BLOCK, ROUNDING
    return Parts("ardupilot", p, x=(*_NO_MEAN, *(0.0,) * 7), y=(0, 0))


def _inav(d: Any) -> Parts:
    p = d._acceleration, d._needed, d._period, d._b0, d._a1, d._a2
    return Parts("inav", p, (int(d._cutoff),), x=(0.0, 0.0, 0.0), y=(0, 0))


def _paparazzi(d: Any) -> Parts:
    return Parts("paparazzi", (d._acceleration, d._interval, d._period), (d._calls,), y=(0, 0))


def _altos(d: Any) -> Parts:
    return Parts("altos", (d._acceleration, d._speed, d._period, BLOCK, ROUNDING), x=(*_NO_MEAN, 0.0))


MAKERS: dict[type[Detector], Callable[[Any], Parts]] = {
    MultiLevelWindow: _nested,
    ThresholdWindow: _nested,
    SlidingWindow: _sliding,
    SequenceWindow: _sequence,
    SingleThreshold: _hold,
    DoubleThreshold: _hold,
    AdaptiveCusum: _adaptive_cusum,
    Cusum: _cusum,
    GlrBank: _glr,
    Px4: _px4,
    Px4Norm: _px4_norm,
    ArduPilot: _ardupilot,
    Inav: _inav,
    Paparazzi: _paparazzi,
    AltOs: _altos,
}
