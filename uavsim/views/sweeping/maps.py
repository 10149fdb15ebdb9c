"""A sweep over two keys, as tiles: medians, and shares of flights as expected."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.sweep import OUTCOME, Sweep
from uavsim.views.figure import BLACK, SMALL, label, literal, sheet
from uavsim.views.sweeping.shared import alike, beside, flights, moved, named, plane_of, scale_of, title, with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]

MOST_NUMBERS = 120  # tiles of a map that have their number written in


def draw_tiles(
    axes: "Axes",
    values: Array,
    found: Sweep,
    across: int,
    up: int,
    colours: str,
    ends: tuple[float | None, float | None],
    *,
    lift: float = 0.0,
) -> None:
    """Draw numbers as tiles of one size, whatever the values of the keys are; `lift`: of what is written above."""
    image = axes.imshow(values, origin="lower", aspect="auto", cmap=colours, vmin=ends[0], vmax=ends[1])
    for axis, set_ticks in ((across, axes.set_xticks), (up, axes.set_yticks)):
        ticks = scale_of(found.varies[axis]).ticks
        set_ticks(range(len(ticks)), [literal(tick) for tick in ticks])
    if max(map(len, scale_of(found.varies[across]).ticks)) > 8:
        axes.tick_params(axis="x", labelrotation=20)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    if values.size > MOST_NUMBERS:
        axes.figure.colorbar(image, ax=axes, fraction=0.05)
        return
    shade = image.norm
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            dark = float(np.mean(image.cmap(float(np.asarray(shade(np.array(value)))))[:3])) < 0.5
            axes.text(
                column,
                row + lift,
                f"{value:.3g}",
                ha="center",
                va="center",
                fontsize=SMALL - 1.0,
                color="white" if dark else BLACK,
            )


def draw_map(found: Sweep, across: int, up: int) -> "Figure":
    """Draw share as expected and medians over two keys."""
    keys = moved(found, OUTCOME)
    columns = 2 if len(keys) > 1 else 1
    height = -(-len(keys) // columns)
    figure, axes = sheet(
        title(found, f"over {found.varies[across].key} and {found.varies[up].key}"),
        f"{flights(found)}{beside(found, (across, up))}; medians; share of flights as expected{alike(found)}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(11.5, 1.4 + 3.4 * height),
        right=0.5,
        share=False,
        gap=(0.42, 0.22),
    )
    plane, table = plane_of(found, across, up), found.table.set_index("cell")
    panels = [panel for row in axes for panel in row]
    for panel, key in zip(panels, keys, strict=False):
        factor = named(key)[2]
        column = "share" if key == OUTCOME else f"{key}.median"
        values = factor * table[column].to_numpy(float)[plane]
        ends = (0.0, 100.0) if key == OUTCOME else (None, None)
        draw_tiles(panel, values, found, across, up, "cividis" if key == OUTCOME else "viridis_r", ends)
        panel.set_title(with_unit(key), loc="left", fontsize=SMALL + 1.0)
        label(panel, literal(found.varies[up].key), literal(found.varies[across].key))
    for panel in panels[len(keys) :]:
        panel.set_visible(False)
    return figure
