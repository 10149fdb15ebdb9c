"""Values that lie so far from all others that no scale can show both: a flight that diverged, or an absurd number.

The range of the others is that of their quartiles, widened by `FAR` times the distance between them, so one flight's
value does not decide it. Flights that diverged or failed have no say in it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

FAR = 10.0  # distances of the quartiles beyond them; 1e-11 of a normal's values, 2e-4 of a lognormal's of σ = 1
LEAST = 0.1  # of the size of the quartiles: their least distance, for values that are nearly equal
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
    low, high = np.quantile(values[base], (0.25, 0.75))
    spread = max(high - low, LEAST * max(abs(low), abs(high)), 1e-12)
    with np.errstate(invalid="ignore"):
        shown = usual & (values >= low - FAR * spread) & (values <= high + FAR * spread)
    return Reach(float(values[shown].min()), float(values[shown].max()), shown, ~np.isnan(values) & ~shown)
