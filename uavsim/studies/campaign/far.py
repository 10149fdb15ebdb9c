"""Values that lie so far from all others that no scale can show both: a flight that diverged, or an absurd number.

The range of the others is that of their quartiles, widened by `FAR` times the distance between them, so one flight's
value does not decide it. Flights that diverged or failed have no say in it.
"""

from dataclasses import dataclass
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.many import Many

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

FAR = 10.0  # distances of the quartiles beyond them; no value of a normal's, 3e-3 of a lognormal's of σ = 1
LEAST = 0.3  # of the size of the quartiles: their least distance, so that up to four times that size all is shown
TEN = 10.0  # times the usual: what an error must exceed besides, since errors are drawn on logarithmic axes
ABSURD = 1e30  # beyond that arithmetic overflows sooner or later


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """What a scale shows of a sample.

    Attributes
    ----------
    low, high : float
        Least and greatest of the values shown; NaN if there are none.
    shown : ndarray of bool
        Which values those are.
    beyond : ndarray of bool
        Which are numbers, or infinite, and not shown.
    """

    low: float
    high: float
    shown: Mask
    beyond: Mask


def reach(values: Array, sound: Mask | None = None) -> Reach:
    """Find the range of a sample that can be drawn.

    Parameters
    ----------
    values
        Shape (n,); NaN is neither shown nor beyond.
    sound
        Shape (n,): which values have a say in the range; if none has, all have.
    """
    usual = np.isfinite(values) & (np.abs(values) < ABSURD)
    base = usual if sound is None or not (usual & sound).any() else usual & sound
    if not base.any():
        return Reach(np.nan, np.nan, np.zeros(values.size, dtype=bool), ~np.isnan(values))
    ordered = np.sort(values[base])  # quartiles from within: one of four values decides none of them
    low, high = ordered[ceil(0.25 * (ordered.size - 1))], ordered[floor(0.75 * (ordered.size - 1))]
    low, high = min(low, high), max(low, high)
    spread = max(high - low, LEAST * max(abs(low), abs(high)), 1e-12)
    with np.errstate(invalid="ignore"):
        shown = usual & (values >= low - FAR * spread) & (values <= high + FAR * spread)
    return Reach(float(values[shown].min()), float(values[shown].max()), shown, ~np.isnan(values) & ~shown)


def far_traces(flown: Many, time: Array, errors: Array) -> Mask:
    """Return which flights' errors after launch are so large that no scale shows them and the others.

    Their peaks must be ten times the usual one besides; never all of them.

    Parameters
    ----------
    time
        Shape (n,), s since the true launch.
    errors
        Shape (traces, n), m/s; NaN where there is none.
    """
    after = errors[:, time > 0.0] if (time > 0.0).any() else errors
    if not after.shape[1]:
        return np.zeros(len(errors), dtype=bool)
    peaks = np.where(np.isnan(after), -np.inf, np.abs(after)).max(axis=1)
    peaks[peaks == -np.inf] = np.nan
    found = reach(peaks, flown.sound[: peaks.size])
    usual = float(np.median(peaks[found.shown])) if found.shown.any() else np.inf
    far = found.beyond & (np.nan_to_num(peaks) > TEN * usual)
    return np.asarray(far & ~far.all(), dtype=bool)
