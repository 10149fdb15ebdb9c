"""Figures, files and tables of a sensitivity study.

effects.png    of Sobol: first-order and total indices, a panel an output; of Morris: the mean size of the
               elementary effects; both as bars with their intervals
tornado.png    how far each output goes when a factor goes from its 10 % to its 90 % point, with its sign
screening.png  of Morris: spread of the elementary effects against their mean size
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.files import whole, write_json
from uavsim.scenario import Scenario
from uavsim.studies.campaign.sensitivity import LEAST_BASES, REST, Design, Effects, flights_for
from uavsim.views.documents import plain, rows
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, ORANGE, RED, SMALL, label, literal, sheet
from uavsim.views.figure import save as save_figure
from uavsim.views.sweeping.shared import named, with_unit
from uavsim.views.terminal import _console, _print, _table, words

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from rich.table import Table

Array = NDArray[np.float64]

MOST_LETTERS = 36  # of a factor's name
MOST_BARS = 10  # factors in a panel
COLUMNS = 2  # of panels
NARROW = 30  # characters of a name in a table
MOST_ROWS = 12  # factors in a table
NOTHING = 1e-9  # of the greatest effect: rounding


@dataclass(frozen=True)
class Study:
    """A sensitivity study that was flown.

    Attributes
    ----------
    scenario
        With its dispersions.
    design
        Which flights were flown.
    effects
        What the factors do to each output.
    """

    scenario: Scenario
    design: Design
    effects: tuple[Effects, ...]


def remark(design: Design) -> str:
    """Say which method the flights suffice for, and what the other one needs."""
    d, flown = len(design.names) - 1, len(design.unit)
    rest = (
        f"; {design.asked - flown} of {design.asked} flights fill no block and are not flown"
        if design.asked > flown
        else ""
    )
    if design.method == "sobol":
        return f"Sobol indices from {design.bases} base points, {flown} flights of {d} dispersions and the rest{rest}"
    return (
        f"Morris screening only, {design.bases} trajectories, {flown} flights{rest}; Sobol indices of {d} dispersions "
        f"and the rest need {flights_for(d, 'sobol')} flights ({LEAST_BASES} base points)"
    )


def save(found: Study, folder: Path, *, plots: bool) -> list[Path]:
    """Write `sensitivity.json` and `sensitivity.csv`, and plots, into a folder."""
    import pandas as pd

    write_json(folder / "sensitivity.json", summary(found))
    table = pd.concat([one.rows.assign(output=one.output) for one in found.effects], ignore_index=True)
    with whole(folder / "sensitivity.csv") as part:
        table.to_csv(part, index=False)
    if not plots or not any(not one.why for one in found.effects):
        return []
    (folder / "plots").mkdir(exist_ok=True)
    return [save_figure(draw(found), folder / "plots" / f"{name}.png") for name, draw in figures(found)]


def summary(found: Study) -> dict[str, Any]:
    """What was flown and what came of it; null where there is no number."""
    design = found.design
    outputs = [
        {
            **{name: getattr(one, name) for name in ("output", "mean", "sd", "missing", "left_out", "why")},
            "factors": rows(one.rows),
        }
        for one in found.effects
    ]
    head = {
        "scenario": found.scenario.name,
        "seed": found.scenario.seed,
        "method": design.method,
        "flights": len(design.unit),
        "asked": design.asked,
        "bases": design.bases,
        "remark": remark(design),
        "factors": design.names,
    }
    return plain({**head, "outputs": outputs})  # type: ignore[no-any-return]


def figures(found: Study) -> Iterator[tuple[str, Callable[[Study], "Figure"]]]:
    """Yield the names of the figures, and what draws each."""
    yield "effects", draw_effects
    yield "tornado", draw_tornado
    if found.design.method == "morris":
        yield "screening", draw_screening


# -- figures ---------------------------------------------------------------------------------------------------------


def _panels(found: Study, what: str, words_: str, *, bars: int) -> "tuple[Figure, list[tuple[Axes, Effects]]]":
    """Make a panel for each output that has numbers; `bars`: how many rows of names one has at most."""
    shown = [one for one in found.effects if not one.why]
    columns = min(COLUMNS, len(shown))
    height = -(-len(shown) // columns)
    figure, axes = sheet(
        f"{found.scenario.name}: {what}",
        f"{remark(found.design).partition(';')[0]}, seed {found.scenario.seed}; {words_}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.4 + ((1.1 + 0.24 * bars) if bars else 3.6) * height),
        right=0.4,
        share=False,
        gap=(0.32 + 0.9 / (bars or 10), 0.62 if bars else 0.16),
    )
    panels = [panel for row in axes for panel in row]
    for panel in panels[len(shown) :]:
        panel.set_visible(False)
    if bars:
        figure.subplots_adjust(left=2.7 / 12.5)
    return figure, list(zip(panels, shown, strict=False))


def _name(factor: str) -> str:
    return literal(_left(factor, MOST_LETTERS)) if factor != REST else "rest: all else that is drawn"


def _left(name: str, longest: int) -> str:
    """Return a name without its beginning if it is too long."""
    return name if len(name) <= longest else f"…{name[1 - longest :]}"


def _greatest(one: Effects, column: str) -> "pd.DataFrame":
    """Rows of the factors that do most, and something, the greatest first."""
    size = one.rows[[column, f"{column}_low", f"{column}_high"]].abs().max(axis=1)
    moving: pd.DataFrame = one.rows[size > NOTHING * size.max()]
    order = np.argsort(-moving[column].abs().to_numpy(), kind="stable")
    return moving.iloc[order[:MOST_BARS]]


def _bars(axes: "Axes", table: "pd.DataFrame", rows_: int) -> Array:
    """Set a row a factor, the first at the top; return their heights."""
    y = -np.arange(len(table), dtype=np.float64)
    axes.set_ylim(-rows_ + 0.4, 0.6)
    axes.set_yticks(y, [_name(str(name)) for name in table["factor"]])
    axes.grid(visible=False, axis="y")
    return y


def _bar(axes: "Axes", y: Array, table: "pd.DataFrame", column: str, colour: str, name: str, *, factor: float) -> None:
    value, low, high = (factor * table[f"{column}{end}"].to_numpy(float) for end in ("", "_low", "_high"))
    axes.barh(y, value, height=0.34 if column != "mu_star" else 0.6, color=colour, alpha=0.75, label=name)
    axes.hlines(y, low, high, color=BLACK, linewidth=1.2)


def _most_bars(found: Study, column: str) -> int:
    return max(len(_greatest(one, column)) for one in found.effects if not one.why)


def draw_effects(found: Study) -> "Figure":
    """Draw the indices of Sobol, or the mean sizes of Morris' effects, with their intervals."""
    sobol = found.design.method == "sobol"
    column, what = ("total", "share of the variance") if sobol else ("mu_star", "change over a factor's range")
    count = _most_bars(found, column)
    figure, panels = _panels(found, "what drives each output", f"{what}; lines: 95 %, bootstrap", bars=count)
    for i, (panel, one) in enumerate(panels):
        table = _greatest(one, column)
        y = _bars(panel, table, count)
        name, unit, factor = named(one.output)
        if sobol:
            _bar(panel, y + 0.18, table, "total", ORANGE, "total", factor=1.0)
            _bar(panel, y - 0.18, table, "first", BLUE, "first order", factor=1.0)
            panel.axvline(0.0, color=GREY, linewidth=0.8)
            low, high = float(table["first_low"].min()), float(table["total_high"].max())
            panel.set_xlim(min(-0.05, 1.1 * low), max(1.05, 1.05 * high))
            if i == 0:
                panel.legend(loc="lower right", frameon=False, fontsize=SMALL)
        else:
            _bar(panel, y, table, "mu_star", BLUE, "mean size", factor=factor)
            panel.set_xlim(0.0, 1.05 * factor * float(table["mu_star_high"].max()))
        panel.set_title(f"{literal(name)}: {_spread(one)}", loc="left", fontsize=SMALL + 1.0)
        label(panel, None, what if sobol else f"mean size of the effect{', ' + unit if unit else ''}")
    return figure


def _spread(one: Effects) -> str:
    """Mean and standard deviation of an output, and what is missing of it."""
    _, unit, factor = named(one.output)
    missing = f"; {one.missing} flights have none" if one.missing else ""
    return f"{factor * one.mean:.4g} ± {factor * one.sd:.3g} {unit}".rstrip() + missing


def draw_tornado(found: Study) -> "Figure":
    """Draw how far each output goes with each factor."""
    words_ = "change of the output from a factor's 10 % to its 90 % point; lines: 95 %, bootstrap"
    count = _most_bars(found, "swing")
    figure, panels = _panels(found, "how far each output goes with a factor", words_, bars=count)
    for panel, one in panels:
        table = _greatest(one, "swing")
        y = _bars(panel, table, count)
        _, unit, factor = named(one.output)
        value, low, high = (factor * table[f"swing{end}"].to_numpy(float) for end in ("", "_low", "_high"))
        panel.barh(y, value, height=0.6, color=[BLUE if v >= 0.0 else RED for v in value], alpha=0.75)
        panel.hlines(y, low, high, color=BLACK, linewidth=1.2)
        panel.axvline(0.0, color=DARK, linewidth=0.9)
        most = 1.08 * float(np.max(np.abs(np.concatenate([low, high])), initial=0.0)) or 1.0
        panel.set_xlim(-most, most)
        panel.set_title(f"{literal(named(one.output)[0])}: {_spread(one)}", loc="left", fontsize=SMALL + 1.0)
        label(panel, None, f"change{', ' + unit if unit else ''}")
    return figure


def draw_screening(found: Study) -> "Figure":
    """Draw the spread of the elementary effects against their mean size."""
    words_ = "on the right: matters; high up: interacts or bends"
    figure, panels = _panels(found, "screening", words_, bars=0)
    for panel, one in panels:
        factor = named(one.output)[2]
        x, low, high, y = (
            factor * one.rows[name].to_numpy(float) for name in ("mu_star", "mu_star_low", "mu_star_high", "sigma")
        )
        panel.hlines(y, low, high, color=GREY, linewidth=1.0)
        panel.plot(x, y, "o", color=BLUE, markersize=4.5)
        most = 1.25 * float(max(np.nanmax(high), np.nanmax(y)))
        for factor_, at, height in zip(one.rows["factor"], x, y, strict=True):
            if at > 0.1 * float(x.max()):
                panel.annotate(
                    literal(_left(str(factor_).rpartition(".")[2], MOST_LETTERS)),
                    (at, height),
                    xytext=(4, 4),
                    textcoords="offset points",
                    fontsize=SMALL - 1.0,
                )
        panel.plot((0.0, most), (0.0, most), color=GREY, linewidth=0.8, linestyle=":")
        panel.set_xlim(0.0, most)
        panel.set_ylim(0.0, 1.15 * float(np.nanmax(y)) or 1.0)
        panel.set_title(with_unit(one.output), loc="left", fontsize=SMALL + 1.0)
        label(panel, "standard deviation", "mean size of the effect")
    return figure


# -- tables ----------------------------------------------------------------------------------------------------------


def print_study(found: Study) -> None:
    """Print what drives each output: a line a factor, the greatest first; within 80 columns."""
    console = _console()
    _print(console, words("\n", (found.scenario.name, "bold"), f", seed {found.scenario.seed}\n"))
    console.print(remark(found.design))
    console.print()
    for one in found.effects:
        name, unit, factor = named(one.output)
        if one.why:
            console.print(f"{name}: no numbers: {one.why}\n")
            continue
        blocks = "base points" if found.design.method == "sobol" else "trajectories"
        left = f"; {one.missing} flights have none, {one.left_out} {blocks} are left out" if one.missing else ""
        console.print(f"{name}: {factor * one.mean:.4g} ± {factor * one.sd:.3g} {unit}".rstrip() + left)
        _print(console, _effects_table(found.design, one), "")


def _effects_table(design: Design, one: Effects) -> "Table":
    """Return the factors that matter most; those that change nothing at all take one line."""
    keys = ("first", "total", "swing") if design.method == "sobol" else ("mu_star", "sigma", "swing")
    heads = ("first order", "total", "swing") if design.method == "sobol" else ("mean size", "spread", "swing")
    _, unit, factor = named(one.output)
    by = [1.0 if key in {"first", "total"} else factor for key in keys]
    units = [f"{head}, {unit}" if (unit and scale != 1.0) or (unit and key == "swing") else head
             for head, key, scale in zip(heads, keys, by, strict=True)]  # fmt: skip
    size = "total" if design.method == "sobol" else "mu_star"
    ordered = one.rows.sort_values(size, ascending=False)
    moving = ordered[ordered[size].abs() > NOTHING * one.rows[size].abs().max()]
    table = _table(("", *units))
    digits = [_digits(scale * one.rows[key].dropna().to_numpy(float)) for key, scale in zip(keys, by, strict=True)]
    for _, row in moving.head(MOST_ROWS).iterrows():
        cells = [_with_interval(row, key, scale, d) for key, scale, d in zip(keys, by, digits, strict=True)]
        table.add_row(cut_name(str(row["factor"])), *cells)
    if len(moving) > MOST_ROWS:
        table.add_row(f"{len(moving) - MOST_ROWS} more, smaller", "", "", "")
    if len(moving) < len(ordered):
        table.add_row(f"{_others(len(ordered) - len(moving))} nothing", "", "", "")
    return table


def cut_name(name: str) -> str:
    """Write a factor's name so that a table has room for it."""
    return _left(name, NARROW)


def _others(count: int) -> str:
    return "one other changes" if count == 1 else f"{count} others change"


def _digits(values: Array) -> int:
    """Decimals that show the greatest of some numbers with three digits."""
    most = float(np.max(np.abs(values), initial=0.0))
    return max(0, min(6, 2 - int(np.floor(np.log10(most))))) if most > 0.0 else 0


def _with_interval(row: "pd.Series[Any]", key: str, factor: float, digits: int) -> Any:
    value, low, high = (factor * row[f"{key}{end}"] for end in ("", "_low", "_high"))
    if value != value:
        return "–"
    shown = [f"{round(number, digits) + 0.0:.{digits}f}" for number in (value, low, high)]  # + 0: no minus before 0
    return words(f"{shown[0]}\n", (f"{shown[1]}…{shown[2]}", "dim"))
