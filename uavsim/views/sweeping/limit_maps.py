"""Where requirements break over two keys: a line with its band."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.sweep import Judged, Sweep
from uavsim.studies.intervals import share_interval
from uavsim.views.figure import RED, SMALL, label, literal, sheet
from uavsim.views.sweeping.maps import draw_tiles
from uavsim.views.sweeping.shared import beside, flights, plane_of, scale_of, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]


def draw_limit_map(found: Sweep, across: int, up: int) -> "Figure":
    """Draw the probability of meeting each requirement over two keys, and the line where it crosses the wanted one."""
    judged = judged_over(found, across, up)
    columns = 2 if len(judged) > 1 else 1
    height = -(-len(judged) // columns)
    line = f"red: where it crosses {100.0 * found.wanted:g} %, with its 95 % band, line by line"
    words = f"share of flights that meet it, %; {line}"
    figure, axes = sheet(
        title(found, "how much can be afforded of two things at once"),
        f"{flights(found)}{beside(found, (across, up))}; {words}; hatched: shown neither good nor bad",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.4 + 4.0 * height),
        right=0.5,
        share=False,
        gap=(0.36, 0.2),
    )
    plane = plane_of(found, across, up)
    panels = [panel for row in axes for panel in row]
    for panel, one in zip(panels, judged, strict=False):
        met = one.met[plane]
        with np.errstate(invalid="ignore"):
            draw_tiles(panel, 100.0 * np.nanmean(met, axis=2), found, across, up, "cividis", (0.0, 100.0), lift=0.3)
        _hatch(panel, met, found)
        remark = _draw_contour(panel, found, across, up, plane, one)
        panel.set_title(literal(one.name) + remark, loc="left", fontsize=SMALL + 1.0)
        label(panel, literal(found.varies[up].key), literal(found.varies[across].key))
    for panel in panels[len(judged) :]:
        panel.set_visible(False)
    return figure


def judged_over(found: Sweep, across: int, up: int) -> list[Judged]:
    """What is met in one cell and not in another, of those over two keys."""
    plane = plane_of(found, across, up)
    shares = [(one, np.nanmean(one.met[plane], axis=2)) for one in found.judged()]
    return [one for one, share in shares if np.ptp(share) > 0.0]


def _hatch(axes: "Axes", met: Array, found: Sweep) -> None:
    """Mark cells whose probability may lie on either side of the wanted one."""
    from matplotlib.patches import Rectangle

    for row, column in np.ndindex(met.shape[:2]):
        flights = met[row, column][np.isfinite(met[row, column])]
        low, high = share_interval(int(flights.sum()), flights.size, found.confidence)
        if low < found.wanted <= high:
            tile = Rectangle(
                (column - 0.5, row - 0.5), 1.0, 1.0, fill=False, hatch="///", edgecolor="#ffffff88", linewidth=0.0
            )
            axes.add_patch(tile)


def _draw_contour(axes: "Axes", found: Sweep, across: int, up: int, plane: Line, one: Judged) -> str:
    """Draw the limits along the key in which more are found, row by row or column by column; say if there is none."""
    ways = []
    for axis, lines in ((across, plane), (up, plane.T)):
        if found.varies[axis].numeric:
            limits = [(i, limit) for i, line in enumerate(lines) for limit in found.limits_along(axis, line, one)]
            ways.append((axis, limits))
    axis, limits = max(ways, key=lambda way: sum(limit.state == "breaks" for _, limit in way[1]))
    breaking = [(i, limit) for i, limit in limits if limit.state == "breaks"]
    if not breaking:
        states = {limit.state for _, limit in limits}
        return (
            ": holds all over the grid"
            if states == {"holds"}
            else ": no limit on the grid"
            if "holds" in states
            else ": broken all over the grid"
        )
    numbers = scale_of(found.varies[axis]).places
    inner = np.arange(numbers.size, dtype=np.float64)
    for rising in (True, False):
        points = [(i, limit) for i, limit in breaking if limit.rising is rising]
        if not points:
            continue
        place = np.array([np.interp(limit.estimate or 0.0, numbers, inner) for _, limit in points])
        low = np.array([-0.5 if p.low is None else np.interp(p.low, numbers, inner) for _, p in points])
        high = np.array(
            [numbers.size - 0.5 if p.high is None else np.interp(p.high, numbers, inner) for _, p in points]
        )
        beside = np.array([i for i, _ in points], dtype=np.float64)
        if axis == across:
            axes.hlines(beside, low, high, color=RED, linewidth=3.0, alpha=0.45)
            axes.plot(place, beside, color=RED, marker="o", markersize=4.0, linewidth=1.6)
        else:
            axes.vlines(beside, low, high, color=RED, linewidth=3.0, alpha=0.45)
            axes.plot(beside, place, color=RED, marker="o", markersize=4.0, linewidth=1.6)
    axes.set_xlim(-0.5, plane.shape[1] - 0.5)
    axes.set_ylim(-0.5, plane.shape[0] - 0.5)
    return ""
