"""Operating curves of launch detectors: the folder they are kept in, and its figures.

    detection.png   detection probability against false alarms per hour, a panel a class of disturbances
    latency.png     median and 95 % quantile of the delay after the 4.5 g crossing against false alarms in the mix
    levels.png      detection probability and false alarms against each detector's own level, with their bands

Where there was no false alarm the point is hollow and at the left end (`NONE`); that rate has an upper bound, which
`levels.png` and the tables give. A large point is the detector as it is set.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.files import whole, write_json
from uavsim.onboard.launch import KINDS
from uavsim.studies.false_alarms import DISTURBANCES
from uavsim.studies.operating import Operating
from uavsim.views.figure import (
    BLACK,
    BLUE,
    EARTH,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    SMALL,
    label,
    legend,
    sheet,
)
from uavsim.views.figure import save as save_figure

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLOURS = (BLACK, BLUE, RED, GREEN, ORANGE, PURPLE, SKY, EARTH)
LINES = ("-", "--", ":")
MISSED = (0.5, 0.1, 0.01, 1e-3, 1e-4)  # where the scale of probabilities is labelled
NONE = 0.3  # alarms, in place of none on a scale of powers of ten
DELAYS = (2, 5, 10, 20, 50, 100, 200, 500)  # ms
COLUMNS = 4  # of small multiples


def save(found: Operating, cells: "pd.DataFrame | None", folder: Path, *, plots: bool) -> None:
    """Write `roc.csv`, `roc.parquet`, `roc.json`, `cells.csv` of the comparison, and plots, into a folder."""
    with whole(folder / "roc.csv") as part:
        found.rows.to_csv(part, index=False)
    with whole(folder / "roc.parquet") as part:
        found.rows.to_parquet(part, index=False)
    write_json(folder / "roc.json", summary(found))
    if cells is not None:
        with whole(folder / "cells.csv") as part:
            cells.to_csv(part, index=False)
    if plots:
        (folder / "plots").mkdir()
        for name, draw in FIGURES.items():
            save_figure(draw(found), folder / "plots" / f"{name}.png")


def summary(found: Operating) -> dict[str, Any]:
    """What was run, and the detectors as they are set; null where there is no number."""
    rows = found.shipped().to_dict("records")
    plain = [{str(k): _plain(v) for k, v in row.items()} for row in rows]
    return {"launches": found.launches, "seed": found.seed, "rate": found.rate, "detectors": plain}


def _plain(value: Any) -> Any:
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value


# -- what curves share -----------------------------------------------------------------------------------------------


def _style(found: Operating, kind: str) -> dict[str, Any]:
    drawn = list(dict.fromkeys(found.rows["detector"]))  # few have a colour each; of many each has always the same
    i = (drawn if len(drawn) <= len(COLOURS) else list(dict.fromkeys([*KINDS, *drawn]))).index(kind)
    return {"color": COLOURS[i % len(COLOURS)], "linestyle": LINES[i // len(COLOURS) % len(LINES)]}


def _curves(found: Operating) -> Iterator[tuple[str, "pd.DataFrame"]]:
    for kind in dict.fromkeys(found.rows["detector"]):
        rows = found.rows[found.rows["detector"] == kind]
        if len(rows):
            yield kind, rows.sort_values("level")


def _rate(rows: "pd.DataFrame", kind: str) -> tuple[Array, NDArray[np.bool_]]:
    """Rate of false alarms, 1/h, a place left of all others where there was none, and where there was one."""
    alarms = rows[f"{kind}.alarms"].to_numpy()
    return np.maximum(alarms, NONE) / rows[f"{kind}.hours"].to_numpy(), alarms > 0


def _rates(axes: "Axes", hours: float) -> None:
    """Scale for rates of false alarms with a place for none."""
    from matplotlib.ticker import FixedLocator, FuncFormatter

    axes.set_xscale("log")
    axes.set_xlim(0.5 * NONE / hours, None)
    decades = [10.0**k for k in range(-4, 7) if 10.0**k > 3.0 * NONE / hours]
    axes.xaxis.set_major_locator(FixedLocator([NONE / hours, *decades]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: "none" if x <= NONE / hours else f"{x:g}"))
    axes.axvspan(0.5 * NONE / hours, 1.8 * NONE / hours, color=LIGHT, alpha=0.5, linewidth=0.0, zorder=0)


def _points(axes: "Axes", x: Array, y: Array, some: NDArray[np.bool_], set_: NDArray[np.bool_], style: Any) -> None:
    colour = style["color"]
    for solid in (True, False):
        for size, chosen in ((9.0, ~set_), (55.0, set_)):
            use = chosen & (some == solid)
            face = colour if solid else "none"
            axes.scatter(x[use], y[use], s=size, edgecolors=colour, facecolors=face, linewidths=1.0, zorder=3)


def _probability(axes: "Axes", least: float) -> None:
    """Scale for probabilities near 1: the share that is missed, upside down; `least` stands for none."""
    axes.set_yscale("log")
    axes.set_ylim(1.3, 0.7 * least)
    ticks = [m for m in MISSED if m > 2.0 * least]
    axes.set_yticks([1.0, *ticks, least], ["0", *(f"{1.0 - m:g}" for m in ticks), "all"])
    axes.minorticks_off()


def _missed(rows: "pd.DataFrame", column: str = "pd") -> Array:
    return np.asarray(np.maximum(1.0 - rows[column].to_numpy(), 0.3 / rows["trials"].to_numpy()))


def _subtitle(found: Operating) -> str:
    trials = int(found.rows["trials"].iloc[0])
    hours = ", ".join(f"{found.rows[f'{kind}.hours'].iloc[0]:.3g} h {kind}" for kind in DISTURBANCES)
    return f"{found.launches}; {trials} launches; {hours}; seed {found.seed}. Hollow: no alarm"


# -- figures ---------------------------------------------------------------------------------------------------------


def draw_detection(found: Operating) -> "Figure":
    """Draw detection probability against false alarms, a panel a class of disturbances."""
    figure, axes = sheet(
        "Launch detectors: detection probability against false alarms",
        _subtitle(found),
        (1.0, 1.0),
        (1.0, 1.0),
        size=(12.5, 8.5),
        share=False,
        gap=(0.24, 0.14),
    )
    panels = [panel for row in axes for panel in row]
    for panel, kind in zip(panels, DISTURBANCES, strict=True):
        for name, rows in _curves(found):
            style, (x, some) = _style(found, name), _rate(rows, kind)
            y = _missed(rows)
            panel.plot(x, y, linewidth=1.2, label=name, **style)
            _points(panel, x, y, some, rows["factor"].to_numpy() == 1.0, style)
        panel.margins(x=0.05)
        _rates(panel, float(found.rows[f"{kind}.hours"].iloc[0]))
        _probability(panel, 0.3 / float(found.rows["trials"].iloc[0]))
        panel.set_title(kind, fontsize=SMALL, loc="left")
        label(panel, "probability of detection", "false alarms, 1/h")
    legend(panels[1])
    return figure


def draw_latency(found: Operating) -> "Figure":
    """Draw the delay after the crossing against false alarms in the mix."""
    figure, ((middle, late),) = sheet(
        "Launch detectors: delay after the true force crosses 4.5 g, against false alarms in the mix",
        _subtitle(found),
        (1.0,),
        (1.0, 1.0),
        size=(12.5, 5.5),
        share=False,
    )
    for panel, column, name in ((middle, "crossing_median", "median"), (late, "crossing_p95", "95 % quantile")):
        for kind, rows in _curves(found):
            style, (x, some) = _style(found, kind), _rate(rows, "mix")
            y = 1e3 * rows[column].to_numpy()
            panel.plot(x, y, linewidth=1.2, label=kind, **style)
            _points(panel, x, y, some, rows["factor"].to_numpy() == 1.0, style)
        panel.margins(x=0.05)
        _rates(panel, float(found.rows["mix.hours"].iloc[0]))
        panel.set_yscale("log")
        panel.set_yticks(DELAYS, [f"{delay}" for delay in DELAYS])
        panel.minorticks_off()
        label(panel, f"{name} of the delay, ms", "false alarms in the mix, 1/h")
    legend(late)
    return figure


def draw_levels(found: Operating) -> "Figure":
    """Draw detection probability and false alarms against each detector's level."""
    curves = [curve for curve in _curves(found) if curve[1]["level"].notna().all()]
    height = -(-len(curves) // COLUMNS)
    figure, axes = sheet(
        "Launch detectors: detection probability (black) and false alarms in the mix (red) against the level",
        _subtitle(found).split(". Hollow")[0] + ". Bands: 95 %; dashed: as set",
        (1.0,) * height,
        (1.0,) * COLUMNS,
        size=(13.5, 1.6 + 2.5 * height),
        right=0.8,
        share=False,
        gap=(0.5, 0.5),
    )
    panels = [panel for row in axes for panel in row]
    for i, (panel, (name, rows)) in enumerate(zip(panels, curves, strict=False)):
        last = i % COLUMNS == COLUMNS - 1 or i == len(curves) - 1
        _draw_level(panel, name, rows, left=i % COLUMNS == 0, right=last)
    for panel in panels[len(curves) :]:
        panel.set_visible(False)
    return figure


def _draw_level(axes: "Axes", name: str, rows: "pd.DataFrame", *, left: bool, right: bool) -> None:
    """Draw one detector; only panels at the edges of a row name their scales, which all of them have."""
    x, key = rows["level"].to_numpy(), str(rows["key"].iloc[0])
    axes.fill_between(x, rows["pd_low"], rows["pd_high"], color=GREY, alpha=0.4, linewidth=0.0)
    axes.plot(x, rows["pd"], color=BLACK, marker=".", linewidth=1.2)
    axes.set_ylim(0.0, 1.02)
    axes.set_xscale("log")
    axes.set_xlim(x[0], x[-1])
    axes.minorticks_off()
    own = float(rows[rows["factor"] == 1.0]["level"].iloc[0])
    axes.set_xticks([x[0], own, x[-1]], [f"{value:.3g}" for value in (x[0], own, x[-1])])
    axes.axvline(own, color=GREY, linestyle="--", linewidth=1.0)
    axes.set_title(name, fontsize=SMALL, loc="left")
    unit = str(rows["unit"].iloc[0])
    label(axes, "probability of detection" if left else None, f"{key}, {unit}" if unit else key)
    beside = axes.twinx()
    rate, some = _rate(rows, "mix")
    beside.set_yscale("log")
    beside.fill_between(x, np.maximum(rows["mix.low"], 1e-6), rows["mix.high"], color=RED, alpha=0.25, linewidth=0.0)
    beside.plot(x, rate, color=RED, linewidth=1.0)
    beside.scatter(x, rate, s=12.0, edgecolors=RED, facecolors=np.where(some, RED, "none"), zorder=3)
    beside.set_ylim(0.2 * NONE / float(rows["mix.hours"].iloc[0]), 1e5)
    beside.tick_params(labelsize=SMALL, colors=RED)
    beside.spines["top"].set_visible(False)
    if right:
        beside.set_ylabel("false alarms, 1/h", fontsize=SMALL, color=RED)


FIGURES: dict[str, Callable[[Operating], "Figure"]] = {
    "detection": draw_detection,
    "latency": draw_latency,
    "levels": draw_levels,
}
