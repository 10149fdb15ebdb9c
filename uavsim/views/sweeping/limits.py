"""Where requirements break along one key: probability of meeting each, its limit, and the band of that."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.crossing import Crossing, fewest
from uavsim.studies.campaign.sweep import Sweep
from uavsim.studies.intervals import share_interval
from uavsim.views.figure import BLACK, BLUE, GREY, PURPLE, RED, SMALL, label, legend, literal, sheet
from uavsim.views.sweeping.shared import Scale, beside, flights, line_of, scale_of, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]


def draw_limits(found: Sweep, axis: int) -> "Figure":
    """Draw the probability of meeting each requirement against a key, and where it crosses the wanted one."""
    judged, scale, line = found.judged(), scale_of(found.varies[axis]), line_of(found, axis)
    figure, axes = sheet(
        title(found, f"how much of {found.varies[axis].key} can be afforded"),
        f"{flights(found)}{beside(found, (axis,))}; bars: 95 % (Clopper–Pearson)",
        (1.0,) * len(judged),
        size=(10.5, 1.6 + 2.6 * len(judged)),
        right=3.3,
        gap=(0.3, 0.0),
    )
    for (panel,), one in zip(axes, judged, strict=True):
        _draw_shares(panel, found, scale, one.met[line])
        scale.dress(panel)
        low, high = panel.get_xlim()
        for limit in found.limits_along(axis, line, one):
            _draw_limit(panel, limit, found, low, high)
        panel.set_title(literal(one.name), loc="left", fontsize=SMALL + 1.0)
        panel.set_ylim(-3.0, 104.0)
        label(panel, "flights that meet it, %")
        legend(panel)
    label(axes[-1][0], None, literal(scale.key))
    return figure


def _draw_shares(axes: "Axes", found: Sweep, scale: Scale, met: Array) -> None:
    flown, good = np.isfinite(met).sum(axis=1), np.nansum(met, axis=1)
    bounds = 100.0 * np.array(
        [share_interval(int(k), int(n), found.confidence) for k, n in zip(good, flown, strict=True)]
    )
    axes.axhline(
        100.0 * found.wanted, color=GREY, linewidth=1.0, linestyle="--", label=f"wanted: {100.0 * found.wanted:g} %"
    )
    axes.vlines(scale.places, bounds[:, 0], bounds[:, 1], color=BLACK, linewidth=1.2)
    share = 100.0 * good / flown
    axes.plot(scale.places, share, color=BLACK, linewidth=0.8)
    axes.plot(scale.places, share, "o", color=BLACK, markersize=4.5, label="share of the flights")


def _draw_limit(axes: "Axes", limit: Crossing, found: Sweep, low: float, high: float) -> None:
    """Shade the band of a limit, mark its estimate, and say both."""
    way = "up to" if limit.rising else "down to"
    if limit.state == "holds":
        axes.plot([], [], " ", label=f"{way}: beyond the grid{_shown_to(limit)}")
        return
    if limit.estimate is None:
        axes.plot([], [], " ", label=f"{way}: nothing, broken everywhere")
        return
    ends = (low if limit.low is None else limit.low, high if limit.high is None else limit.high)
    axes.axvspan(*ends, color=RED, alpha=0.13, linewidth=0.0, label=f"95 % band: {_range(limit, found)}")
    axes.axvline(limit.estimate, color=RED, linewidth=1.4, label=f"{way} {limit.estimate:.3g}, estimate")
    if limit.quantile is not None:
        axes.axvline(
            limit.quantile,
            color=PURPLE,
            linewidth=1.2,
            linestyle=":",
            label=f"{way} {limit.quantile:.3g}, by quantiles",
        )
    if limit.logistic is not None:
        interval = " … ".join("–" if end is None else f"{end:.3g}" for end in (limit.logistic_low, limit.logistic_high))
        words = f"{way} {limit.logistic:.3g} [{interval}], if logistic"
        axes.axvline(limit.logistic, color=BLUE, linewidth=1.2, linestyle="--", label=words)


def _shown_to(limit: Crossing) -> str:
    return "" if limit.held is None else f";\n  shown to hold to {limit.held:.3g}"


def _range(limit: Crossing, found: Sweep) -> str:
    """Write the band; an open end says why."""
    if limit.held is None and limit.lost is None:
        return f"open;\n  a cell is shown good by {fewest(found.wanted, found.confidence)} flights"
    low, high = ("open" if end is None else f"{end:.3g}" for end in (limit.low, limit.high))
    remark = ""
    if limit.held is None:
        remark = f";\n  a cell is shown good by {fewest(found.wanted, found.confidence)} flights"
    return f"{low} … {high}{remark}"
