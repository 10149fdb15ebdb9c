"""Each cell less the reference, flight by flight."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.sweep import OUTCOME, Sweep
from uavsim.studies.campaign.vary import told
from uavsim.views.figure import BLUE, GREY, LIGHT, label, literal, sheet
from uavsim.views.sweeping.shared import alike, brief_key, moved, named, short, title, value_text, with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]

MOST_DRAWN = 24  # cells


def draw_differences(found: Sweep) -> "Figure":
    """Draw each cell less the reference, flight by flight, and the interval without that."""
    table = found.differences
    cells = [i for i in range(len(found.cells)) if i != found.reference and i in set(found.table["cell"])]
    shown, keys = cells[:MOST_DRAWN], moved(found, OUTCOME)
    more = f"; the first {len(shown)} of {len(cells)} cells" if len(cells) > len(shown) else ""
    what = "the scenario as it is" if found.nominal else told(found.cells[found.reference])
    columns = min(3, len(keys))
    height = -(-len(keys) // columns)
    figure, axes = sheet(
        title(found, f"each cell less {short(what, 70)}"),
        f"mean difference flight by flight and its 95 % interval (blue); with draws of their own as wide as the "
        f"grey{more}{alike(found)}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.5 + height * (1.0 + 0.22 * len(shown))),
        right=0.4,
        share=False,
        gap=(0.35, 0.08),
    )
    names = [literal(short(_brief(found, i), 44)) for i in shown]
    panels = [panel for row in axes for panel in row]
    y = -np.arange(len(shown), dtype=np.float64)
    for n, (panel, key) in enumerate(zip(panels, keys, strict=False)):
        rows_ = table[table["quantity"] == key].set_index("cell").loc[shown]
        factor = named(key)[2]
        middle, low, high = (factor * rows_[column].to_numpy(float) for column in ("difference", "low", "high"))
        half = 0.5 * (high - low) * rows_["narrower"].to_numpy(float)
        panel.axvline(0.0, color=GREY, linewidth=1.0)
        panel.hlines(y, middle - half, middle + half, color=LIGHT, linewidth=6.0)
        panel.hlines(y, low, high, color=BLUE, linewidth=1.6)
        panel.plot(middle, y, "o", color=BLUE, markersize=4.0)
        panel.set_ylim(-len(shown) + 0.4, 0.6)
        panel.set_yticks(y, names if n % columns == 0 else [""] * len(shown))
        panel.margins(x=0.06)
        label(panel, None, with_unit(key))
    for panel in panels[len(keys) :]:
        panel.set_visible(False)
    longest = max(map(len, names), default=0)
    figure.subplots_adjust(left=min(0.3, (0.35 + 0.068 * longest) / 12.5))
    return figure


def _brief(found: Sweep, i: int) -> str:
    """Name a cell by the last parts of its keys."""
    return ", ".join(f"{brief_key(found, key)} {value_text(value)}" for key, value in found.cells[i].items())
