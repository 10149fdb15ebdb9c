"""Readings that wrap at the range of an integer: beyond its greatest value the least one follows.

A sensor or a logger that keeps a reading in k bits and does not saturate turns a force just above the range into one
just below it: the reading jumps by all of the range from one sample to the next, and jumps back. No force does that.
Counts are whole numbers, and tell k; of readings in m/s² only the jump between the two ends is seen.

Where the force passes much of the range between two samples, a reading near neither end follows, and what it was cannot
be told. What is left is a jump from one side to the other by more than the greatest reading, as none of a force that
lasts: before and behind the spell it is passing, in between it stays. Such a spell is named and left as it is.
"""

import numpy as np

from uavsim.logs.recording import Array
from uavsim.truth import STANDARD_GRAVITY

BITS = (8, 10, 12, 13, 14, 16)
RANGES = (2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 64.0, 100.0, 200.0)  # g, of parts
BEYOND = 1.25  # share of what was seen that the range may have at most: its ends are seldom met
NEAR_END = 0.85  # share of the range beyond which both sides of a jump lie
SYMMETRIC = 0.05  # share by which the ends may differ in size
SIDE = 0.15  # share of the greatest reading that either side of a jump across has at least
PASSING, STAYS, LONGEST = 0.05, 0.05, 2.0  # s: outside a spell the side is passed, in it the reading stays so long
FEW = 3  # readings in a spell, at least
APART = 0.08  # share of the greatest reading, by which a spell differs from what is usual
CALM, CALM_STEP = 0.9, 0.25  # quantile of steps, and share of the greatest reading below which it lies
MOST_ACROSS = 0.02  # share of steps that may go across: more is vibration
LEAST_RANGE = 1.5 * STANDARD_GRAVITY  # m/s²; below, vibration about 0 does it


def unwrapped(values: Array, axis: str) -> tuple[Array, list[str]]:
    """Unwrap readings that jump between the two ends of a range and back.

    Parameters
    ----------
    values
        Of one axis, m/s², NaN where there is none.
    axis
        Its name.

    Returns
    -------
    numpy.ndarray
        Readings; the same if none wrapped.
    list of str
        What is to be said.
    """
    good = np.flatnonzero(np.isfinite(values))
    f = values[good]
    if f.size < 3:
        return values, []
    high, low = float(f.max()), float(f.min())
    end = min(high, -low)
    if end < LEAST_RANGE or max(high, -low) > (1.0 + SYMMETRIC) * end:
        return values, []
    step = np.diff(f)
    jumps = np.flatnonzero(
        (np.abs(step) > 2.0 * NEAR_END * end) & (np.minimum(abs(f[1:]), abs(f[:-1])) > NEAR_END * end)
    )
    if jumps.size < 2 or jumps.size % 2:
        return values, []
    down, up = jumps[0::2], jumps[1::2]
    if not (np.sign(step[down]) == -np.sign(step[up])).all() or (up - down).sum() > 0.1 * f.size:
        return values, []
    unit = _unit(f)
    width = _width(high, low, unit)
    unwrapped_f = f.copy()
    for first, last in zip(down, up, strict=True):
        unwrapped_f[first + 1 : last + 1] -= np.sign(step[first]) * width
    if not _smoother(f, unwrapped_f, jumps):
        return values, []
    found = values.copy()
    found[good] = unwrapped_f
    many = down.size
    said = (
        f"wrap: {axis} jumps between {high:.4g} and {low:.4g} m/s² and back, {many} times: readings beyond the range "
        f"of their integer are unwrapped by {width:.4g} m/s²"
    )
    return found, [said]


def suspected(values: Array, t: Array, axis: str) -> list[str]:
    """Name spells that look as if a reading had wrapped, but not from one end of its range to the other.

    Parameters
    ----------
    values, t
        Of one axis, m/s², NaN where there is none, and their times, s.
    axis
        Its name.
    """
    good = np.flatnonzero(np.isfinite(values))
    f, at = values[good], t[good]
    if f.size < 2 * FEW or (most := float(np.abs(f).max())) < LEAST_RANGE:
        return []
    step = np.diff(f)
    across = (np.abs(step) > most) & (np.minimum(np.abs(f[1:]), np.abs(f[:-1])) > SIDE * most)
    jumps = np.flatnonzero(across & (np.sign(f[1:]) == -np.sign(f[:-1])))
    if not jumps.size or jumps.size > max(2.0, MOST_ACROSS * f.size):
        return []
    if float(np.quantile(np.abs(step), CALM)) > CALM_STEP * most or _saturates(f):
        return []
    usual = float(np.median(f))
    for place in jumps.tolist():
        for first, last, way in ((place + 1, None, 1), (None, place, -1)):
            spell = _spell(f, at, first, last, usual, APART * most)
            outside = place if way > 0 else place + 1
            if spell is not None and _passed(f, at, outside, -way, usual):
                begin, end = spell
                return [
                    f"wrap: {axis} jumps from {f[place]:.4g} to {f[place + 1]:.4g} m/s² at {at[place + 1]:.10g} s, by "
                    f"more than any reading, {'and then' if way > 0 else 'and before'} stays away from rest for "
                    f"{at[end] - at[begin]:.3g} s: as of readings beyond the range of their integer. They are left as "
                    "they are, and a launch in them cannot be seen: log a wider range"
                ]
    return []


def _saturates(f: Array) -> bool:
    """Whether an extreme is held: what saturates does not wrap."""
    ends = (f == f.max()) | (f == f.min())
    return bool((ends[2:] & ends[1:-1] & ends[:-2] & (f[2:] == f[1:-1]) & (f[1:-1] == f[:-2])).any())


def _spell(
    f: Array, t: Array, first: int | None, last: int | None, usual: float, away: float
) -> tuple[int, int] | None:
    """Return where readings away from what is usual begin and end that begin or end with a jump; None if too short."""
    way, start = (1, first) if first is not None else (-1, last)
    assert start is not None
    here, side = start, np.sign(f[start] - usual)
    while (
        0 <= here + way < f.size and abs(t[here + way] - t[start]) <= LONGEST and side * (f[here + way] - usual) > away
    ):
        here += way
    begin, end = min(start, here), max(start, here)
    long_enough = end - begin + 1 >= FEW and STAYS <= t[end] - t[begin] < LONGEST
    return (begin, end) if long_enough else None


def _passed(f: Array, t: Array, start: int, way: int, usual: float) -> bool:
    """Whether a reading at a side of a jump is passed on the way from or to what is usual: it does not stay."""
    here, level = start, 0.5 * (f[start] - usual)
    while 0 <= here < f.size and (f[here] - usual) * np.sign(level) > abs(level):
        here += way
    return abs(float(t[min(max(here, 0), f.size - 1)] - t[start])) <= PASSING


def _unit(f: Array) -> float:
    """What one count is: the least step between readings; 0 if that is too fine to be one."""
    steps = np.abs(np.diff(np.unique(f[:20_000])))
    return float(steps.min()) if steps.size else 0.0


def _width(high: float, low: float, unit: float) -> float:
    """Width of the range: of an integer, if the counts are seen; of a part; else what lies between the ends."""
    if unit > 0.0:
        for bits in BITS:
            width = unit * 2.0**bits
            if (high - low) <= width <= 1.05 * (high - low) + 2.0 * unit:
                return width
    for most in RANGES:
        width = 2.0 * most * STANDARD_GRAVITY
        if (high - low) <= 1.001 * width and width <= BEYOND * (high - low):
            return width
    return high - low + max(unit, 0.0)


def _smoother(before: Array, after: Array, jumps: "np.ndarray[tuple[int], np.dtype[np.intp]]") -> bool:
    """Whether no step is left where the jumps were that is like them."""
    return bool((np.abs(np.diff(after))[jumps] < 0.3 * np.abs(np.diff(before))[jumps]).all())
