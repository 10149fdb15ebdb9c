"""Readings that wrap at the range of an integer: beyond its greatest value the least one follows.

A sensor or a logger that keeps a reading in k bits and does not saturate turns a force just above the range into one
just below it: the reading jumps by all of the range from one sample to the next, and jumps back. No force does that.
Counts are whole numbers, and tell k; of readings in m/s² only the jump between the two ends is seen.
"""

import numpy as np

from uavsim.logs.recording import Array
from uavsim.truth import STANDARD_GRAVITY

BITS = (8, 10, 12, 13, 14, 16)
RANGES = (2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 64.0, 100.0, 200.0)  # g, of parts
BEYOND = 1.25  # share of what was seen that the range may have at most: its ends are seldom met
NEAR_END = 0.85  # share of the range beyond which both sides of a jump lie
SYMMETRIC = 0.05  # share by which the ends may differ in size
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
