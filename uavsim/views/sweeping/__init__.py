"""Figures of a sweep: what each cell gives, how it differs from the reference, and where the requirements break.

    along-KEY.png          share of flights as expected and quantiles against a key, with bands
    limits-KEY.png         probability of meeting each requirement against a key, and where it crosses the wanted one
    map-KEY-KEY.png        the same numbers over two keys
    limits-KEY-KEY.png     that probability over two keys, with the line where it crosses the wanted one
    differences.png        each cell less the reference, flight by flight

Where more keys are varied than a figure shows, it shows the cells in which the others are those of the reference.
"""

import re
from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim.files import whole, write_json
from uavsim.studies.campaign.sweep import OUTCOME, Sweep
from uavsim.views.documents import plain, rows
from uavsim.views.figure import save as save_figure
from uavsim.views.sweeping.along import draw_along
from uavsim.views.sweeping.differences import draw_differences
from uavsim.views.sweeping.limit_maps import draw_limit_map, judged_over
from uavsim.views.sweeping.limits import draw_limits
from uavsim.views.sweeping.maps import draw_map
from uavsim.views.sweeping.shared import moved

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


def save(found: Sweep, folder: Path, *, plots: bool) -> list[Path]:
    """Write `sweep.json`, `cells.csv`, `limits.csv` and `differences.csv`, and plots, into a folder."""
    write_json(folder / "sweep.json", summary(found))
    for name in ("table", "limits", "differences"):
        table: pd.DataFrame = getattr(found, name)
        with whole(folder / f"{'cells' if name == 'table' else name}.csv") as part:
            table.to_csv(part, index=False)
    if not plots:
        return []
    (folder / "plots").mkdir(exist_ok=True)
    return [save_figure(draw(), folder / "plots" / f"{name}.png") for name, draw in figures(found)]


def summary(found: Sweep) -> dict[str, Any]:
    """What was varied and what came of it; null where there is no number."""
    document: dict[str, Any] = plain(
        {
            "scenario": found.scenario.name,
            "seed": found.scenario.seed,
            "flights": found.flights,
            "flown": len(found.runs),
            "wanted": found.wanted,
            "confidence": found.confidence,
            "vary": {one.key: one.choices for one in found.varies},
            "reference": {"cell": found.reference, "nominal": found.nominal, **found.cells[found.reference]},
        }
    )
    tables = {"cells": found.table, "limits": found.limits, "differences": found.differences}
    return document | {name: rows(table) for name, table in tables.items()}


def figures(found: Sweep) -> Iterator[tuple[str, Callable[[], "Figure"]]]:
    """Yield the names of the figures for which there are data, and what draws each."""
    flown = len(found.table) == len(found.cells)
    for axis, one in enumerate(found.varies):
        yield f"along-{_file(one.key)}", partial(draw_along, found, axis)
        if flown and one.numeric and len(one.choices) > 1:
            yield f"limits-{_file(one.key)}", partial(draw_limits, found, axis)
    for across, up in combinations(range(len(found.varies)), 2):
        if not flown or min(len(found.varies[axis].choices) for axis in (across, up)) < 2:
            continue
        names = "-".join(_file(found.varies[axis].key) for axis in (across, up))
        if moved(found, OUTCOME):
            yield f"map-{names}", partial(draw_map, found, across, up)
        if (found.varies[across].numeric or found.varies[up].numeric) and judged_over(found, across, up):
            yield f"limits-{names}", partial(draw_limit_map, found, across, up)
    if len(found.table) > 1 and moved(found, OUTCOME):
        yield "differences", partial(draw_differences, found)


def _file(key: str) -> str:
    return re.sub(r"[^\w.+-]", "_", key)[:60]
