"""Curves over time as all figures have them: raw readings as dots, truth as a line, errors on an axis that fits."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.views.figure import BLACK, DARK, RAW, SMALL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

COLUMNS = 1500  # pixels that a curve is drawn for: more points than twice that do not show
QUANTILE, MARGIN = 0.995, 1.5  # an axis of errors reaches to this multiple of that quantile of their sizes


def thin(t: Array, y: Array, points: int = 2 * COLUMNS) -> tuple[Array, Array]:
    """Leave out what does not show, keeping the least and the greatest of each stretch.

    Parameters
    ----------
    t, y
        Shape (n,).
    points
        Most that are wanted; fewer than twice as many are returned as they are.
    """
    block = -(-2 * t.size // points)
    if block <= 4:
        return t, y
    whole = t.size // block * block
    blocks = y[:whole].reshape(-1, block)
    gap = np.isnan(blocks)
    least = np.argmin(np.where(gap, np.inf, blocks), axis=1)
    greatest = np.argmax(np.where(gap, -np.inf, blocks), axis=1)
    starts = np.arange(0, whole, block)
    chosen = np.unique(np.concatenate([starts + least, starts + greatest, [0, t.size - 1]]))
    return t[chosen], y[chosen]


def truth(axes: "Axes", t: Array, y: Array) -> None:
    """Draw what is true."""
    axes.plot(*thin(t, y), color=BLACK, linewidth=1.3, label="true")


def dots(axes: "Axes", t: Array, y: Array, name: str = "") -> None:
    """Draw raw readings."""
    axes.plot(t, y, linestyle="none", marker=".", markersize=2.5, color=RAW, label=name, zorder=1.8)


def fit(axes: "Axes", errors: Iterable[tuple[Array, Array]], after: float, unit: str) -> None:
    """Scale an axis of errors, each (t, error), to those later than `after`, s, and say what lies beyond it."""
    sizes = [(t, np.abs(y)) for t, y in errors]
    later = [size[(t > after) & np.isfinite(size)] for t, size in sizes]
    usual = max((float(np.quantile(size, QUANTILE)) for size in later if size.size), default=0.0)
    largest = max((float(np.nanmax(size)) for _, size in sizes if np.isfinite(size).any()), default=0.0)
    limit = MARGIN * usual or largest or 1.0
    if largest <= MARGIN * limit:
        limit = max(limit, 1.05 * largest)
    else:
        _remark(axes, f"beyond the axis: up to {largest:.{0 if largest > 20 else 1}f} {unit}")
    axes.set_ylim(-limit, limit)


def _remark(axes: "Axes", words: str) -> None:
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
    axes.text(0.99, 0.03, words, transform=axes.transAxes, ha="right", fontsize=SMALL, color=DARK, bbox=box)
