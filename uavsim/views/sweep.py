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
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.files import whole, write_json
from uavsim.studies.campaign.crossing import Crossing, fewest
from uavsim.studies.campaign.sweep import OUTCOME, Judged, Sweep
from uavsim.studies.campaign.vary import Varied, as_text, told
from uavsim.studies.intervals import share_interval
from uavsim.views.documents import plain, rows
from uavsim.views.figure import (
    BLACK,
    BLUE,
    DARK,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    PURPLE,
    RED,
    SMALL,
    label,
    legend,
    literal,
    sheet,
)
from uavsim.views.figure import save as save_figure

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Line = NDArray[np.int_]

COLOURS = (BLUE, ORANGE, GREEN, PURPLE, BLACK)
LOGARITHMIC = 8.0  # ratio of the greatest to the least value from which an axis is logarithmic
MOST_DRAWN = 24  # cells in `differences.png`
MOST_NUMBERS = 120  # tiles of a map that have their number written in
NAMES = {
    "launch.latency": ("latency", "ms", 1e3),
    "launch.latency_from_crossing": ("latency after 4.5 g", "ms", 1e3),
    "airspeed.rmse": ("RMSE of the airspeed", "m/s", 1.0),
    "airspeed.cruise.rmse": ("RMSE of the airspeed in cruise", "m/s", 1.0),
    "flight.rail_exit_speed": ("airspeed off the rail", "m/s", 1.0),
    "flight.cruise_airspeed": ("airspeed in cruise", "m/s", 1.0),
    OUTCOME: ("flights as expected", "%", 100.0),
}
"""What a number of the score is called, its unit, and the factor from SI."""


def named(key: str) -> tuple[str, str, float]:
    """What a number is called, its unit and the factor to it; a number without a name of its own is its key."""
    return NAMES.get(key, (key, "", 1.0))


def with_unit(key: str) -> str:
    """Name and unit of a number, for an axis."""
    name, unit, _ = named(key)
    return f"{literal(name)}, {unit}" if unit else literal(name)


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
        yield f"along-{_file(one.key)}", lambda axis=axis: draw_along(found, axis)
        if flown and one.numeric and len(one.choices) > 1:
            yield f"limits-{_file(one.key)}", lambda axis=axis: draw_limits(found, axis)
    for across, up in combinations(range(len(found.varies)), 2):
        if not flown or min(len(found.varies[axis].choices) for axis in (across, up)) < 2:
            continue
        names = "-".join(_file(found.varies[axis].key) for axis in (across, up))
        if _moved(found, OUTCOME):
            yield f"map-{names}", lambda across=across, up=up: draw_map(found, across, up)
        if (found.varies[across].numeric or found.varies[up].numeric) and _judged(found, across, up):
            yield f"limits-{names}", lambda across=across, up=up: draw_limit_map(found, across, up)
    if len(found.table) > 1 and _moved(found, OUTCOME):
        yield "differences", lambda: draw_differences(found)


def _file(key: str) -> str:
    return re.sub(r"[^\w.+-]", "_", key)[:60]


# -- what figures share ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Scale:
    """Where the values of a key stand on an axis: at their numbers, or one after another with their names."""

    key: str
    places: Array
    ticks: tuple[str, ...]
    numeric: bool
    log: bool

    def dress(self, axes: "Axes") -> None:
        """Scale an axis and mark the values."""
        if self.log:
            axes.set_xscale("log")
        axes.minorticks_off()
        axes.set_xticks(self.places, [literal(tick) for tick in self.ticks])
        if not self.numeric:
            axes.tick_params(axis="x", labelrotation=20 if max(map(len, self.ticks)) > 12 else 0)
        low, high = float(self.places.min()), float(self.places.max())
        if self.log:
            share = (high / low) ** 0.05
            axes.set_xlim(low / share, high * share)
        else:
            margin = 0.05 * (high - low) if self.numeric and high > low else 0.5
            axes.set_xlim(low - margin, high + margin)


def _scale(one: Varied) -> Scale:
    if one.numeric and len(one.choices) > 1:
        numbers = np.sort(np.array(one.labels, dtype=np.float64))
        log = bool(numbers[0] > 0.0 and numbers[-1] >= LOGARITHMIC * numbers[0])
        return Scale(one.key, numbers, tuple(f"{number:.4g}" for number in numbers), True, log)
    ticks = tuple(_value(value) for value in one.labels)
    return Scale(one.key, np.arange(len(ticks), dtype=np.float64), ticks, False, False)


def _title(found: Sweep, what: str) -> str:
    return f"{found.scenario.name}: {what}"


def _flights(found: Sweep) -> str:
    least, most = int(found.table["flights"].min()), int(found.table["flights"].max())
    count = f"{most}" if least == most else f"{least} to {most}"
    return f"{count} flights a cell, the same draws in all, seed {found.scenario.seed}"


def _line(found: Sweep, axis: int) -> Line:
    """The line of cells along a key in which the other keys are those of the reference."""
    return next(line for line in found.lines(axis) if found.reference in line)


def _series(found: Sweep, axis: int) -> list[tuple[str, str, Line]]:
    """Lines of cells to draw along a key: one for each value of one other key, if there are few; name, colour, cells."""
    lines, others = list(found.lines(axis)), [one for i, one in enumerate(found.varies) if i != axis]
    if len(others) != 1 or len(lines) > len(COLOURS):
        return [("", BLUE, _line(found, axis))]
    key = others[0].key
    return [
        (f"{key.rpartition('.')[2]} {_value(found.labels[line[0]][f'vary.{key}'])}", colour, line)
        for line, colour in zip(lines, COLOURS, strict=False)
    ]


def _value(value: Any) -> str:
    """Write a label of a cell."""
    return f"{value:.5g}" if isinstance(value, float) else _short(as_text(value), 24)


def _short(text: str, longest: int) -> str:
    return text if len(text) <= longest else f"{text[: longest - 1]}…"


def _moved(found: Sweep, *first: str) -> tuple[str, ...]:
    """Numbers of the score that are not the same in all cells, after those given of which it is true."""
    return tuple(key for key in (*first, *found.quantities) if not found.alike(key))


def _alike(found: Sweep) -> str:
    """Say which numbers of the score are the same in all cells, and so are not drawn."""
    same = [named(key)[0] for key in found.quantities if found.alike(key)]
    return f"; the same in every cell: {', '.join(same)}" if same else ""


def _beside(found: Sweep, axes: tuple[int, ...]) -> str:
    """Say what the keys are that a figure does not show."""
    others = {one.key: found.cells[found.reference][one.key] for i, one in enumerate(found.varies) if i not in axes}
    return f"; {told(others)}" if others else ""


# -- against one key -------------------------------------------------------------------------------------------------


def draw_along(found: Sweep, axis: int) -> "Figure":
    """Draw the share of flights as expected and quantiles against a key."""
    series, scale, quantities = _series(found, axis), _scale(found.varies[axis]), _moved(found)
    hidden = () if len(series) > 1 else tuple(i for i in range(len(found.varies)) if i != axis)
    beside = _beside(found, tuple(i for i in range(len(found.varies)) if i not in hidden))
    words = "95 % bands, each point on its own"
    figure, axes = sheet(
        _title(found, f"against {found.varies[axis].key}"),
        f"{_flights(found)}{beside}{_alike(found)}; {words}",
        (1.0,) * (1 + len(quantities)),
        size=(10.5, 1.6 + 2.3 * (1 + len(quantities))),
        right=2.4,
        gap=(0.18, 0.0),
    )
    table = found.table.set_index("cell")
    for i, (name, colour, line) in enumerate(series):
        there = np.isin(line, table.index)
        cells, x = table.loc[line[there]], scale.places[there]
        if not scale.numeric and len(series) > 1:
            x = x + 0.12 * (i - 0.5 * (len(series) - 1))
        _draw_share(axes[0][0], x, cells, colour, name, joined=scale.numeric)
        for (panel,), key in zip(axes[1:], quantities, strict=True):
            _draw_quantiles(panel, x, cells, key, colour, name, joined=scale.numeric, whole=len(series) == 1)
    label(axes[0][0], "as expected, %")
    for (panel,), key in zip(axes[1:], quantities, strict=True):
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


# -- limits along one key --------------------------------------------------------------------------------------------


def draw_limits(found: Sweep, axis: int) -> "Figure":
    """Draw the probability of meeting each requirement against a key, and where it crosses the wanted one."""
    judged, scale, line = found.judged(), _scale(found.varies[axis]), _line(found, axis)
    figure, axes = sheet(
        _title(found, f"how much of {found.varies[axis].key} can be afforded"),
        f"{_flights(found)}{_beside(found, (axis,))}; bars: 95 % (Clopper–Pearson)",
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
    if limit.state == "broken":
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


# -- over two keys ---------------------------------------------------------------------------------------------------


def _plane(found: Sweep, across: int, up: int) -> Line:
    """Numbers of the cells over two keys, shape (values of up, values of across), others as in the reference."""
    shape = tuple(len(one.choices) for one in found.varies)
    at = np.unravel_index(found.reference, shape)
    grid = np.arange(len(found.cells)).reshape(shape)
    chosen = grid[tuple(slice(None) if i in {across, up} else int(at[i]) for i in range(len(shape)))]
    plane = chosen.T if across < up else chosen
    for turned, axis in ((1, across), (0, up)):
        if found.varies[axis].numeric:
            plane = np.take(plane, np.argsort(found.varies[axis].labels), axis=turned)
    return plane


def _tiles(
    axes: "Axes",
    values: Array,
    found: Sweep,
    across: int,
    up: int,
    colours: str,
    ends: tuple[float | None, float | None],
) -> None:
    """Draw numbers as tiles of one size, whatever the values of the keys are."""
    image = axes.imshow(values, origin="lower", aspect="auto", cmap=colours, vmin=ends[0], vmax=ends[1])
    for axis, set_ticks in ((across, axes.set_xticks), (up, axes.set_yticks)):
        ticks = _scale(found.varies[axis]).ticks
        set_ticks(range(len(ticks)), [literal(tick) for tick in ticks])
    if max(map(len, _scale(found.varies[across]).ticks)) > 8:
        axes.tick_params(axis="x", labelrotation=20)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    if values.size > MOST_NUMBERS:
        axes.figure.colorbar(image, ax=axes, fraction=0.05)
        return
    shade = image.norm
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            dark = float(np.mean(image.cmap(shade(value))[:3])) < 0.5
            axes.text(
                column,
                row,
                f"{value:.3g}",
                ha="center",
                va="center",
                fontsize=SMALL - 1.0,
                color="white" if dark else BLACK,
            )


def draw_map(found: Sweep, across: int, up: int) -> "Figure":
    """Draw share as expected and medians over two keys."""
    keys = _moved(found, OUTCOME)
    columns = 2 if len(keys) > 1 else 1
    height = -(-len(keys) // columns)
    figure, axes = sheet(
        _title(found, f"over {found.varies[across].key} and {found.varies[up].key}"),
        f"{_flights(found)}{_beside(found, (across, up))}; medians; share of flights as expected{_alike(found)}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(11.5, 1.4 + 3.4 * height),
        right=0.5,
        share=False,
        gap=(0.42, 0.22),
    )
    plane, table = _plane(found, across, up), found.table.set_index("cell")
    panels = [panel for row in axes for panel in row]
    for panel, key in zip(panels, keys, strict=False):
        factor = named(key)[2]
        column = "share" if key == OUTCOME else f"{key}.median"
        values = factor * table[column].to_numpy(float)[plane]
        ends = (0.0, 100.0) if key == OUTCOME else (None, None)
        _tiles(panel, values, found, across, up, "cividis" if key == OUTCOME else "viridis_r", ends)
        panel.set_title(with_unit(key), loc="left", fontsize=SMALL + 1.0)
        label(panel, literal(found.varies[up].key), literal(found.varies[across].key))
    for panel in panels[len(keys) :]:
        panel.set_visible(False)
    return figure


def draw_limit_map(found: Sweep, across: int, up: int) -> "Figure":
    """Draw the probability of meeting each requirement over two keys, and the line where it crosses the wanted one."""
    judged = _judged(found, across, up)
    columns = 2 if len(judged) > 1 else 1
    height = -(-len(judged) // columns)
    words = f"share of flights that meet it, %; red: where it crosses {100.0 * found.wanted:g} %, with its 95 % band"
    figure, axes = sheet(
        _title(found, "how much can be afforded of two things at once"),
        f"{_flights(found)}{_beside(found, (across, up))}; {words}; hatched: shown neither good nor bad",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.4 + 4.0 * height),
        right=0.5,
        share=False,
        gap=(0.36, 0.2),
    )
    plane = _plane(found, across, up)
    panels = [panel for row in axes for panel in row]
    for panel, one in zip(panels, judged, strict=False):
        met = one.met[plane]
        with np.errstate(invalid="ignore"):
            _tiles(panel, 100.0 * np.nanmean(met, axis=2), found, across, up, "cividis", (0.0, 100.0))
        _hatch(panel, met, found)
        remark = _draw_contour(panel, found, across, up, plane, one)
        panel.set_title(literal(one.name) + remark, loc="left", fontsize=SMALL + 1.0)
        label(panel, literal(found.varies[up].key), literal(found.varies[across].key))
    for panel in panels[len(judged) :]:
        panel.set_visible(False)
    return figure


def _judged(found: Sweep, across: int, up: int) -> list[Judged]:
    """What is met in one cell and not in another, of those over two keys."""
    plane = _plane(found, across, up)
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
    numbers = _scale(found.varies[axis]).places
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


# -- differences -----------------------------------------------------------------------------------------------------


def draw_differences(found: Sweep) -> "Figure":
    """Draw each cell less the reference, flight by flight, and the interval without that."""
    table = found.differences
    cells = [i for i in range(len(found.cells)) if i != found.reference and i in set(found.table["cell"])]
    shown, keys = cells[:MOST_DRAWN], _moved(found, OUTCOME)
    more = f"; the first {len(shown)} of {len(cells)} cells" if len(cells) > len(shown) else ""
    what = "the scenario as it is" if found.nominal else told(found.cells[found.reference])
    columns = min(3, len(keys))
    height = -(-len(keys) // columns)
    figure, axes = sheet(
        _title(found, f"each cell less {_short(what, 70)}"),
        f"mean difference flight by flight and its 95 % interval (blue); with draws of their own it would be as wide as the grey{more}{_alike(found)}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.5 + height * (1.0 + 0.22 * len(shown))),
        right=0.4,
        share=False,
        gap=(0.35, 0.08),
    )
    names = [literal(_short(_brief(found, i), 44)) for i in shown]
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
    return ", ".join(f"{key.rpartition('.')[2]} {_value(value)}" for key, value in found.cells[i].items())
