"""What a launch makes of the pressures: tubes that are swapped, a sign or a unit that is another.

The push gives u = ∫ (f_x − f_x at rest) dt, and then the pressures differ by ½ρ (u + w)², w being the wind. With r for
what they differ by, over ½ρu², r is (1 + w/u)²: 0.36 to 2 in a wind of 40 % of u. A fall, or a rise that is so by the
factor of a unit, is no wind's.
"""

from collections.abc import Sequence

import numpy as np

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.logs.head import UNITS, Head
from uavsim.logs.recording import Array

BEFORE, REST, AFTER = 2.0, 0.5, 1.5  # s: rest from BEFORE to REST before a launch; the push ends by AFTER behind it
SETTLES = 0.3  # s behind the push in which the pressures are looked at. By hand
LEAST_GAINED = 8.0  # m/s, less than which no push says enough. By hand: 39 Pa
CLEAR = 8.0  # standard deviations of the mean at rest by which a change is one. By hand
NOISIEST = (
    30.0  # Pa, noise of a differential sensor's reading: none is worse, so that a covered port is of no unit. By hand
)
FALLS, LEAST, MOST = -0.3, 0.3, 2.5  # r, below which tubes are swapped, and between which a unit is right. By hand


def odd_rise(head: Head, readings: Array, launches: Sequence[float]) -> str:
    """Say that the pressures do not rise with a launch as pressures in Pa do; empty if they do, or it cannot be seen.

    Parameters
    ----------
    head : Head
        Pressures.
    readings : numpy.ndarray
        Shape (n, 4): t, s, and f, m/s².
    launches : sequence of float
        When one was recognised, s.
    """
    for launch in launches:
        seen = _change(head, readings, launch)
        if seen is None:
            continue
        share, clear, noise = seen
        if not clear or LEAST <= share <= MOST:
            return ""
        if share < FALLS:
            mend = "p_difference=-…" if head.differential else "p_total and p_static the other way round"
            return f"the pressures differ the wrong way in the launch, as of tubes that are swapped: map {mend}"
        fits = (one for one in UNITS if LEAST <= share * one[1] <= MOST and noise * one[1] <= NOISIEST)
        unit = next(fits, None)
        if unit is None or not head.differential:
            return ""
        return (
            f"in the launch p_difference rises by {share:.2g} of what the force says, which looks like {unit[0]}: "
            f"map p_difference=…*{unit[1]:g}"
        )
    return ""


def _change(head: Head, readings: Array, launch: float) -> tuple[float, bool, float] | None:
    """Return r, whether the pressures have changed beyond their noise, and that; None where the push is not seen."""
    t, along = readings[:, 0], np.nan_to_num(readings[:, 1])
    rest = (t >= launch - BEFORE) & (t < launch - REST)
    push = np.flatnonzero((t >= launch - REST) & (t <= launch + AFTER))
    if rest.sum() < 5 or push.size < 5:
        return None
    gained = np.concatenate(([0.0], np.cumsum((along[push][1:] - np.median(along[rest])) * np.diff(t[push]))))
    most = int(np.argmax(gained))
    end = t[push[most]]
    at, differences = head.total.t, head.differences
    quiet = differences[(at >= launch - BEFORE) & (at < launch - REST)]
    moved = differences[(at >= end) & (at <= end + SETTLES)]
    quiet, moved = quiet[np.isfinite(quiet)], moved[np.isfinite(moved)]
    if gained[most] < LEAST_GAINED or quiet.size < 3 or moved.size < 3:
        return None
    density = float(np.median(head.static.values)) / (GAS_CONSTANT_DRY_AIR * head.assumed_temperature)
    change = float(np.median(moved) - np.median(quiet))
    noise = float(np.std(quiet))
    clear = abs(change) > CLEAR * noise / np.sqrt(min(quiet.size, moved.size))
    return change / (0.5 * density * gained[most] ** 2), clear, noise
