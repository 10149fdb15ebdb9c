"""Distributions of what matters over the flights: histograms, or points where flights are few, and quantiles."""

from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.studies.campaign.far import Reach, reach
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.quantities import SHOWN, Array, Quantity, bands, number
from uavsim.views.campaign.words import floor_of, limit_lines, not_to_scale, remark, title
from uavsim.views.figure import BLACK, BLUE, DARK, PHASES, RED, SMALL, label, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST = 2  # flights to speak of a distribution
FEW = 30  # flights, below which points say more than a histogram
MOST_BINS = 60
COLUMNS = 4
GOLDEN = 0.6180339887498949  # spreads points evenly without a random draw
ROW = 2.15  # in
REMARKS = 3  # lines of remarks; the others are counted


def draw(flown: Many) -> "Figure | None":
    """Draw all distributions; None where there are none, or a single flight."""
    if len(flown) < FEWEST:
        return None
    found = [
        (quantity, values, within)
        for quantity in SHOWN
        if (within := reach(values := quantity.of(flown), flown.sound)).shown.any()
    ]
    if not found:
        return None
    columns = min(COLUMNS, len(found))
    rows = ceil(len(found) / columns)
    few = len(flown) < FEW
    words = "a point is a flight" if few else "flights in each bin"
    words += "; above: quantiles 5, 50 and 95 % and their 95 % bands (order statistics)"
    words += "; a triangle: flights are too few for that end"
    required = {r.key for r in flown.scenario.requirements if r.of_each_flight}
    if required & {quantity.key for quantity, _, _ in found}:
        words += "; dashed: required"
    size = (max(4.5, 3.0 * columns), 1.2 + ROW * rows)
    figure, axes = sheet(
        title(flown), words, (1.0,) * rows, (1.0,) * columns, size=size, right=0.2, share=False, gap=(0.56, 0.18)
    )
    flat = [one for row in axes for one in row]
    remarks = []
    for one, (quantity, values, within) in zip(flat, found, strict=False):
        _panel(one, flown, quantity, values, within)
        beyond = np.flatnonzero(within.beyond).tolist()
        if beyond:
            told = not_to_scale(flown, beyond, values, quantity.unit, quantity.digits)
            remarks.append(f"{quantity.name} beyond the scale: {told}")
    for one in flat[len(found) :]:
        one.set_visible(False)
    for row in axes:
        label(row[0], None if few else "flights")
    make_room(figure, 0)
    more = len(remarks) - REMARKS
    remark(figure, [*remarks[:REMARKS], f"and {more} more such numbers" if more > 0 else ""])
    return figure


def _panel(axes: "Axes", flown: Many, quantity: Quantity, values: Array, within: Reach) -> None:
    shown = values[within.shown]
    margin = floor_of(shown)
    axes.set_xlim(within.low - margin, within.high + margin)
    phase = quantity.key.split(".")[1]
    colour = PHASES.get(phase, BLUE)
    if len(flown) < FEW:
        heights = 0.15 + 0.7 * (np.arange(shown.size) * GOLDEN % 1.0)
        axes.plot(shown, heights, "o", color=colour, markersize=4.5, markeredgecolor=DARK, markeredgewidth=0.3)
        top = 1.0
        axes.set_yticks([])
    else:
        counts, _, _ = axes.hist(shown, _bins(shown, within).tolist(), color=colour, alpha=0.75)
        top = float(np.max(counts))
        axes.locator_params(axis="y", nbins=4, integer=True)
    axes.locator_params(axis="x", nbins=5)
    _quantiles(axes, values[~np.isnan(values)], top)
    axes.set_ylim(0.0, 1.42 * top)
    axes.grid(visible=False, axis="y" if len(flown) < FEW else "x")
    limit_lines(axes, flown, quantity.key, quantity.factor, upright=True)
    label(axes, x=quantity.label)
    axes.xaxis.label.set_fontsize(SMALL + 0.5)
    there = int((~np.isnan(values)).sum())
    small: dict[str, Any] = {"fontsize": SMALL - 0.5, "color": DARK, "pad": 2.0}
    if there < len(flown):
        axes.set_title(f"n = {there}", loc="right", **small)
    median = bands(values[~np.isnan(values)], ("median",))["median"]
    ends = ", ".join("–" if end is None else number(end, quantity.digits) for end in (median.low, median.high))
    axes.set_title(f"median {number(median.value, quantity.digits)} [{ends}]", loc="left", **small)


def _bins(shown: Array, within: Reach) -> Array:
    """Return the edges of a histogram's bins: the usual rule's, but not too many; equal values have one bin."""
    if within.high <= within.low:
        width = floor_of(shown)
        return np.array([within.low - 0.1 * width, within.high + 0.1 * width])
    bins = np.histogram_bin_edges(shown, "auto", (within.low, within.high))
    return np.asarray(bins if bins.size <= MOST_BINS + 1 else np.linspace(within.low, within.high, MOST_BINS + 1))


def _quantiles(axes: "Axes", sample: Array, top: float) -> None:
    """Draw quantiles with their bands above the sample, the median highest."""
    left, right = axes.get_xlim()
    for (name, found), height in zip(bands(sample).items(), (1.14, 1.30, 1.14), strict=True):
        y = height * top
        colour = BLACK if name == "median" else RED
        low, high = left if found.low is None else found.low, right if found.high is None else found.high
        axes.plot(np.clip((low, high), left, right), (y, y), color=colour, linewidth=1.3, solid_capstyle="butt")
        for end, mark, place in ((found.low, "<", left), (found.high, ">", right)):
            if end is None:
                axes.plot(place, y, mark, color=colour, markersize=4.5, clip_on=False, zorder=4.0)
        axes.plot(np.clip(found.value, left, right), y, "o", color=colour, markersize=4.0, zorder=3.0)
