"""A sweep against one key: share of flights as expected, and quantiles, with bands."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.sweep import OUTCOME, Sweep
from uavsim.views.figure import DARK, GREY, RED, SMALL, label, legend, literal, sheet
from uavsim.views.sweeping.shared import alike, beside, flights, moved, named, scale_of, series, title, with_unit

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]


def draw_along(found: Sweep, axis: int) -> "Figure":
    """Draw the share of flights as expected and quantiles against a key."""
    lines, scale, quantities = series(found, axis), scale_of(found.varies[axis]), moved(found, OUTCOME) or (OUTCOME,)
    hidden = () if len(lines) > 1 else tuple(i for i in range(len(found.varies)) if i != axis)
    others = beside(found, tuple(i for i in range(len(found.varies)) if i not in hidden))
    words = "95 % bands, each point on its own"
    figure, axes = sheet(
        title(found, f"against {found.varies[axis].key}"),
        f"{flights(found)}{others}{alike(found)}; {words}",
        (1.0,) * len(quantities),
        size=(10.5, 1.6 + 2.3 * len(quantities)),
        right=2.4,
        gap=(0.18, 0.0),
    )
    table = found.table.set_index("cell")
    for i, (name, colour, line) in enumerate(lines):
        there = np.isin(line, table.index)
        cells, x = table.loc[line[there]], scale.places[there]
        if not scale.numeric and len(lines) > 1:
            x = x + 0.12 * (i - 0.5 * (len(lines) - 1))
        for (panel,), key in zip(axes, quantities, strict=True):
            if key == OUTCOME:
                _draw_share(panel, x, cells, colour, name, joined=scale.numeric)
            else:
                _draw_quantiles(panel, x, cells, key, colour, name, joined=scale.numeric, whole=len(lines) == 1)
    for (panel,), key in zip(axes, quantities, strict=True):
        label(panel, with_unit(key))
    for (panel,) in axes:
        scale.dress(panel)
        legend(panel)
    label(axes[-1][0], None, literal(scale.key))
    return figure


def _draw_share(axes: "Axes", x: Array, cells: "pd.DataFrame", colour: str, name: str, *, joined: bool) -> None:
    share, low, high = (100.0 * cells[column].to_numpy(float) for column in ("share", "share_low", "share_high"))
    _draw_band(axes, x, share, low, high, colour, literal(name) if name else "share and 95 % band", joined=joined)
    axes.set_ylim(-3.0, 104.0)


def _draw_band(
    axes: "Axes", x: Array, y: Array, low: Array, high: Array, colour: str, name: str | None, *, joined: bool
) -> None:
    """Draw values with their bounds: a shaded band along a line of numbers, bars at names; to where they are closed."""
    low, high = np.where(np.isnan(low), y, low), np.where(np.isnan(high), y, high)
    if joined:
        axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0.0)
        axes.plot(x, y, color=colour, marker="o", markersize=3.5, linewidth=1.3, label=name)
        return
    axes.vlines(x, low, high, color=colour, linewidth=1.2)
    axes.plot(x, y, "o", color=colour, markersize=4.5, label=name)


def _draw_quantiles(
    axes: "Axes", x: Array, cells: "pd.DataFrame", key: str, colour: str, name: str, *, joined: bool, whole: bool
) -> None:
    """Draw the median and, where a figure has one series, the 5 and 95 % quantiles."""
    factor = named(key)[2]
    shown = (("median", "median", colour), ("p95", "95 %", RED), ("p05", "5 %", GREY)) if whole else ()
    for column, words, paint in shown or (("median", f"{name}, median", colour),):
        y, low, high = (factor * cells[f"{key}.{column}{end}"].to_numpy(float) for end in ("", "_low", "_high"))
        _draw_band(axes, x, y, low, high, paint, literal(words), joined=joined)
    missing = int(cells[f"{key}.missing"].sum())
    if missing and (whole or not axes.texts):
        axes.text(
            0.01, 0.97, f"{missing} flights have none", transform=axes.transAxes, va="top", fontsize=SMALL, color=DARK
        )
    axes.margins(y=0.08)
