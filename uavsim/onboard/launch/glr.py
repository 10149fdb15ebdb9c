"""Bank of clipped likelihood ratios: windows of several lengths, each against the noise of its own mean.

For white noise and a rise of the mean from c by an unknown amount at an unknown time, the generalised likelihood ratio
is the largest of the window sums over the root of their length:

    max over L of  Σ_L clip(f - c, -fall, +rise)·dt / √L  >  h

f is the force along the launch axis and c the `reference`, m/s²; L a window's length, s; h the `limit`, m/s² √s. A
short window sees a strong launch soon, a long one a weak launch at all; the clip bounds a shock's say. Source: Lorden,
Ann. Math. Statist. 42 (1971) 1897; the clip is Huber's.

One running sum serves all windows: a window's is what it has grown by since that window began. It is kept in whole
steps of 2⁻²⁰ m/s², so that nothing is rounded however long it runs; 64 bits last for years.
"""

from dataclasses import dataclass
from math import isfinite, sqrt
from typing import Annotated

import numpy as np
from annotated_types import Interval, MinLen

from uavsim.onboard.launch.axis import GRAVITY, Counting, whole
from uavsim.onboard.launch.bounds import Force, Time
from uavsim.onboard.launch.compiled import Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import REFERENCES, WIDELY, Level, Need, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE

SCALE = 2.0**20  # steps in 1 m/s²


@dataclass(frozen=True, slots=True)
class GlrSettings:
    """Bank of clipped likelihood ratios, `kind = "glr-bank"`.

    Attributes
    ----------
    reference : float
        c, m/s². 44.13 is 4.5 g.
    limit : float
        h, m/s² √s. 1.0854 is 3.5 g √ms.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    windows : tuple of float
        Lengths of the windows, s.
    """

    reference: Force = 44.13
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 1.0854
    rise: Force = 9.80665
    fall: Force = 9.80665
    windows: Annotated[tuple[Time, ...], MinLen(1)] = (0.006, 0.012, 0.024, 0.048, 0.096)


class GlrBank(Counting):
    """Recognise a launch by the likelihood ratio of the best of some windows.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    reference : float
        c, m/s²; 4.5 g.
    limit : float
        h, m/s² √s; 3.5 g √ms.
    rise, fall : float
        Bounds of what a sample adds and takes off, m/s²; 1 g each.
    windows : tuple of float
        Lengths, s; each is taken as round(L·rate) samples, at least 1.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    level, count, total : int
        0: the windows do not count.
    triggered : bool
        Whether a sample of the longest window has taken off less than `fall`.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    Before the first sample and before the end of a gap, and where the force is NaN or implausible, samples count as
    ones that take off `fall`. A sample that follows lost ones counts for them too.

    Examples
    --------
    >>> detector = GlrBank(1000.0)
    >>> [detector.step(0.001 * k, 60.0, 0.0, -9.8) for k in range(40)].index(True)  # 21 - 3 > 3.5 √24 in 24 ms
    20
    """

    __slots__ = ("_fall", "_k", "_longest_window", "_reference", "_ring", "_span", "_sum", "_windows")

    def __init__(
        self,
        rate: float,
        *,
        reference: float = 4.5 * GRAVITY,
        limit: float = 3.5 * GRAVITY * sqrt(0.001),
        rise: float = 1.0 * GRAVITY,
        fall: float = 1.0 * GRAVITY,
        windows: tuple[float, ...] = (0.006, 0.012, 0.024, 0.048, 0.096),
        axis: Axis = "+x",
    ) -> None:
        require(isfinite(reference), "reference must be finite")
        require(all(isfinite(x) and x > 0.0 for x in (limit, rise, fall)), "limit, rise and fall must be above 0")
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        require(len(windows) > 0, "windows must not be empty")
        self._reference, self._fall, self._span = reference, fall, rise + fall
        lengths = sorted({whole(window, rate, "windows") for window in windows})
        self._longest_window = lengths[-1]
        self._windows = tuple((n, int(SCALE * (limit * sqrt(n * rate) + n * fall))) for n in lengths)
        super().__init__(rate, axis)

    def _clear(self) -> None:
        self._ring = [0] * self._longest_window  # the running sum after each of the last samples
        self._sum = self._k = 0
        self.triggered = False

    def _count(self, f: float) -> bool:
        above = f - self._reference + self._fall
        total, ring, k, reached = self._sum, self._ring, self._k, False
        if above > 0.0 and f < MOST_FORCE:
            total += int(SCALE * (above if above < self._span else self._span))
            for n, limit in self._windows:
                if total - ring[k - n] > limit:
                    reached = True
                    break
        elif not self.triggered:  # NaN too
            return False  # a ring whose sums are equal need not turn
        self.triggered = total != ring[k]
        self._sum = ring[k] = total
        k += 1
        self._k = 0 if k == self._longest_window else k
        return reached

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        lengths, limits = [n for n, _ in self._windows], [limit for _, limit in self._windows]
        q = np.array([len(lengths), *lengths, *limits], np.int64)
        state = (0, 0, lengths[-1], *(0,) * (len(lengths) + lengths[-1]))
        return Loop(_loop, (self._reference, self._fall, self._span, SCALE), q, y=state)


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Wholes, x: Reals, y: Wholes, out: Wholes) -> int:
    """`GlrBank`: p reference, fall, rise + fall, steps in 1 m/s²; q the number, lengths and limits of the windows.

    y[1] place in the ring, y[2] samples since the last that spoke, then the windows' sums, then the ring.
    """
    reference, fall, span, scale = p
    windows = q[0]
    lengths, limits = q[1 : 1 + windows], q[1 + windows :]
    longest = lengths[windows - 1]
    place, quiet, alarms = y[1], y[2], 0
    sums, ring = y[3 : 3 + windows], y[3 + windows :]
    for i in range(f.size):
        v = wide(f[i])
        above = v - reference + fall
        added = 0
        if not (above > 0.0 and v < MOST_FORCE):  # NaN too
            if quiet >= longest:
                continue
            quiet += 1
        else:
            added = int(scale * (above if above < span else span))
            quiet = 0
        reached = False
        for j in range(windows):
            old = place - lengths[j]
            sums[j] += added - ring[old if old >= 0 else old + longest]
            reached |= sums[j] > limits[j]
        ring[place] = added
        place += 1
        if place == longest:
            place = 0
        if reached:
            place, quiet = 0, longest
            y[3:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2] = place, quiet
    return alarms


one_axis(
    "glr-bank",
    GlrBank,
    group="glr",
    level=Level("glr.limit", "m/s² √s", WIDELY),
    second=Second("glr.reference", REFERENCES, over_push=True),
    need=lambda s, _: Need("glr.reference", s.glr.reference, "glr.windows", min(s.glr.windows)),
    lines=lambda s: {"c": s.glr.reference},
)
