"""Estimates against the number of flights: whether there are enough of them."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.campaign.convergence import Running, running_quantile, running_share
from uavsim.studies.campaign.far import Reach, reach
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.quantities import LATENCY, RMSE, Quantity, precise
from uavsim.views.campaign.words import limit_lines, not_to_scale, remark, title
from uavsim.views.figure import BLUE, GREY, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST = 2  # flights to draw anything
LEFT = 1.1  # in

SHARE = Quantity("outcome", "as expected", "%", 100.0, 2)


def estimates(flown: Many, points: int = 80) -> dict[str, Running]:
    """Return what is watched, in SI: share as expected, median of the latency, 95 % quantile of the RMSE."""
    found = {
        "as_expected": running_share(flown.expected, points),
        "launch.latency.median": running_quantile(flown.column(LATENCY.key), 0.50, points),
        "airspeed.rmse.p95": running_quantile(flown.column(RMSE.key), 0.95, points),
    }
    return {name: one for name, one in found.items() if np.isfinite(one.value).any()}


def draw(flown: Many) -> "Figure | None":
    """Draw running estimates with their intervals; None for a single flight."""
    from matplotlib.ticker import LogLocator, NullLocator

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
    words = "estimates from the first n flights, 95 % intervals (Clopper–Pearson; order statistics, where n allows)"
    size = (10.5, 1.3 + 2.0 * len(panels))
    figure, axes = sheet(title(flown), words, (1.0,) * len(panels), size=size, right=2.6, gap=(0.16, 0.0))
    figure.subplots_adjust(left=LEFT / size[0])
    remarks = []
    for (one,), (name, what, quantity) in zip(axes, panels, strict=True):
        values = quantity.of(flown) if quantity is not SHARE else 100.0 * flown.expected.astype(np.float64)
        within = reach(values, flown.sound)
        _panel(one, found[name], quantity, within)
        beyond = np.flatnonzero(within.beyond).tolist() if quantity is not SHARE else []
        if beyond:
            told = not_to_scale(flown, beyond, values, quantity.unit, quantity.digits)
            remarks.append(f"{quantity.name} beyond the scale: {told}")
        limit_lines(one, flown, quantity.key, quantity.factor)
        if quantity is SHARE:
            one.set_ylim(one.get_ylim()[0], min(one.get_ylim()[1], 101.0))
        label(one, what)
        legend(one)
    bottom = axes[-1][0]
    bottom.set_xscale("log")
    bottom.set_xlim(1.0, len(flown))
    bottom.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    bottom.xaxis.set_major_formatter("{x:g}")
    bottom.xaxis.set_minor_locator(NullLocator())
    label(bottom, x="flights n")
    make_room(figure, 0)
    remark(figure, remarks)
    return figure


def _panel(axes: "Axes", found: Running, quantity: Quantity, within: Reach) -> None:
    value, low, high = (quantity.factor * one for one in (found.value, found.low, found.high))
    axes.fill_between(found.n, low, high, color=BLUE, alpha=0.2, linewidth=0.0, label="95 % interval")
    axes.plot(found.n, value, color=BLUE, linewidth=1.3, marker="." if found.n.size < 12 else "", label="estimate")
    last = value[-1]
    words = f"all: {precise(last, low[-1], high[-1], quantity.digits)} {quantity.unit}"
    if np.isfinite(last):
        axes.axhline(last, color=GREY, linewidth=0.8, linestyle="--", label=words)
    ends = np.concatenate([one[value.size // 3 :] for one in (value, low, high)])  # the first flights wander too far
    ends = ends[np.isfinite(ends)]
    if quantity is not SHARE and np.isfinite(within.low):
        ends = np.clip(ends, within.low, within.high)
    if ends.size:
        margin = 0.08 * float(np.ptp(ends)) or 0.05 * abs(float(ends[0])) or 1.0
        axes.set_ylim(float(ends.min()) - margin, float(ends.max()) + margin)
