"""Estimates against the number of flights: whether there are enough of them."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.campaign.convergence import Running, running_quantile, running_share
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.quantities import LATENCY, RMSE, Quantity, number
from uavsim.views.campaign.words import limit_lines, title
from uavsim.views.figure import BLUE, GREY, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST = 2  # flights to draw anything

SHARE = Quantity("outcome", "as expected", "%", 100.0, 2)


def estimates(flown: Many, points: int = 80) -> dict[str, Running]:
    """Return what is watched: the share as expected, the median of the latency, the 95 % quantile of the RMSE. In SI."""
    found = {
        "as_expected": running_share(flown.expected, points),
        "launch.latency.median": running_quantile(flown.column(LATENCY.key), 0.50, points),
        "airspeed.rmse.p95": running_quantile(flown.column(RMSE.key), 0.95, points),
    }
    return {name: one for name, one in found.items() if np.isfinite(one.value).any()}


def draw(flown: Many) -> "Figure | None":
    """Draw running estimates with their intervals; None for a single flight."""
    if len(flown) < FEWEST:
        return None
    found = estimates(flown)
    panels = [
        (name, words, quantity)
        for name, words, quantity in (
            ("as_expected", f"ended as expected\n({flown.scenario.expect}), %", SHARE),
            ("launch.latency.median", "median of the\nlatency, ms", LATENCY),
            ("airspeed.rmse.p95", "95 % quantile of the\nairspeed RMSE, m/s", RMSE),
        )
        if name in found
    ]
    words = "estimates from the first n flights and their 95 % intervals (Clopper–Pearson; order statistics, where n allows)"
    size = (10.5, 1.3 + 2.0 * len(panels))
    figure, axes = sheet(title(flown), words, (1.0,) * len(panels), size=size, right=2.6, gap=(0.16, 0.0))
    for (one,), (name, what, quantity) in zip(axes, panels, strict=True):
        _panel(one, found[name], quantity)
        limit_lines(one, flown, quantity.key, quantity.factor)
        label(one, what)
        legend(one)
    bottom = axes[-1][0]
    bottom.set_xscale("log")
    bottom.set_xlim(1.0, len(flown))
    bottom.xaxis.set_major_formatter("{x:g}")
    label(bottom, x="flights n")
    make_room(figure, 0)
    return figure


def _panel(axes: "Axes", found: Running, quantity: Quantity) -> None:
    value, low, high = (quantity.factor * one for one in (found.value, found.low, found.high))
    axes.fill_between(found.n, low, high, color=BLUE, alpha=0.2, linewidth=0.0, label="95 % interval")
    axes.plot(found.n, value, color=BLUE, linewidth=1.3, marker="." if found.n.size < 12 else "", label="estimate")
    last = value[-1]
    bounds = f"[{number(low[-1], quantity.digits)}, {number(high[-1], quantity.digits)}]"
    words = f"all: {number(last, quantity.digits)} {bounds} {quantity.unit}"
    if np.isfinite(last):
        axes.axhline(last, color=GREY, linewidth=0.8, linestyle="--", label=words)
    _scale(axes, value, low, high, last)


def _scale(axes: "Axes", value: np.ndarray, low: np.ndarray, high: np.ndarray, last: float) -> None:  # type: ignore[type-arg]
    """Scale to the later two thirds of the curve, on whose log axis the first flights have no more than their due."""
    late = slice(value.size // 3, None)
    ends = np.concatenate([value[late], low[late], high[late]])
    ends = ends[np.isfinite(ends)]
    if not ends.size:
        return
    bottom, top = float(ends.min()), float(ends.max())
    if np.isfinite(last):  # absurd values at one end do not hide where the estimate is
        width = 12.0 * max(abs(last - np.nanquantile(ends, q)) for q in (0.25, 0.75)) or 0.1 * abs(last) or 1.0
        bottom, top = max(bottom, last - width), min(top, last + width)
    margin = 0.08 * (top - bottom) or 0.05 * abs(top) or 1.0
    axes.set_ylim(bottom - margin, top + margin)

