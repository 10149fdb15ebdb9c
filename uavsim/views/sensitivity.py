"""Figures, files and tables of a sensitivity study.

effects.png    of Sobol: first-order and total indices, a panel an output; of Morris: the mean size of the
               elementary effects; both as bars with their intervals
tornado.png    how far each output goes when a factor goes from its 10 % to its 90 % point, with its sign
screening.png  of Morris: spread of the elementary effects against their mean size
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.files import whole, write_json
from uavsim.scenario import Scenario
from uavsim.studies.campaign.sensitivity import LEAST_BASES, REST, Design, Effects, flights_for
from uavsim.views.documents import plain, rows
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, ORANGE, RED, SMALL, label, legend, literal, sheet
from uavsim.views.figure import save as save_figure
from uavsim.views.sweeping.shared import named, with_unit
from uavsim.views.terminal import _console, _print, _table, words
from uavsim.views.text import cut

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MOST_LETTERS = 34  # of a factor's name
COLUMNS = 2  # of panels


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


def _panels(found: Study, what: str, words_: str, *, wide: float) -> "tuple[Figure, list[tuple[Axes, Effects]]]":
    """Make a panel for each output that has numbers."""
    shown = [one for one in found.effects if not one.why]
    columns = min(COLUMNS, len(shown))
    height = -(-len(shown) // columns)
    least = 0.9 + 0.3 * len(found.design.names) if wide else 3.6
    figure, axes = sheet(
        f"{found.scenario.name}: {what}",
        f"{remark(found.design).partition(';')[0]}, seed {found.scenario.seed}; {words_}",
        (1.0,) * height,
        (1.0,) * columns,
        size=(12.5, 1.4 + least * height),
        right=1.5 if not wide else 1.3,
        share=False,
        gap=(0.35, 0.08 if wide else 0.2),
    )
    panels = [panel for row in axes for panel in row]
    for panel in panels[len(shown) :]:
        panel.set_visible(False)
    if wide:
        longest = max(len(_name(one)) for one in found.design.names)
        figure.subplots_adjust(left=min(0.3, (0.35 + 0.072 * longest) / 12.5))
    return figure, list(zip(panels, shown, strict=False))


def _name(factor: str) -> str:
    return literal(cut(factor, MOST_LETTERS)) if factor != REST else "rest: all else that is drawn"


def _bars(axes: "Axes", names: Sequence[str], first: bool) -> Array:
    """Set a row a factor, the first at the top; return their heights."""
    y = -np.arange(len(names), dtype=np.float64)
    axes.set_ylim(-len(names) + 0.4, 0.6)
    axes.set_yticks(y, [_name(name) for name in names] if first else [""] * len(names))
    axes.grid(visible=False, axis="y")
    return y


def _bar(
    axes: "Axes", y: Array, table: "pd.DataFrame", column: str, colour: str, name: str, factor: float = 1.0
) -> None:
    value, low, high = (factor * table[f"{column}{end}"].to_numpy(float) for end in ("", "_low", "_high"))
    axes.barh(y, value, height=0.34 if name in {"first order", "total"} else 0.6, color=colour, alpha=0.75, label=name)
    axes.hlines(y, low, high, color=BLACK, linewidth=1.2)


def _ordered(found: Study) -> list[str]:
    """Factors by what they do to all outputs together, the greatest first."""
    column = "total" if found.design.method == "sobol" else "mu_star"
    score = np.zeros(len(found.design.names))
    for one in found.effects:
        if not one.why:
            values = one.rows[column].to_numpy(float)
            score += values / max(float(values.max()), 1e-300)
    return [found.design.names[i] for i in np.argsort(-score, kind="stable")]


def draw_effects(found: Study) -> "Figure":
    """Draw the indices of Sobol, or the mean sizes of Morris' effects, with their intervals."""
    sobol = found.design.method == "sobol"
    words_ = (
        "share of the variance; lines: 95 %, bootstrap"
        if sobol
        else "change over a factor's range; lines: 95 %, bootstrap"
    )
    figure, panels = _panels(found, "what drives each output", words_, wide=True)
    names = _ordered(found)
    for i, (panel, one) in enumerate(panels):
        table, y = one.rows.set_index("factor").loc[names], _bars(panel, names, i % COLUMNS == 0)
        name, unit, factor = named(one.output)
        if sobol:
            _bar(panel, y + 0.18, table, "total", ORANGE, "total")
            _bar(panel, y - 0.18, table, "first", BLUE, "first order")
            panel.axvline(0.0, color=GREY, linewidth=0.8)
            panel.set_xlim(
                min(-0.05, 1.1 * float(table["first_low"].min())), max(1.05, 1.05 * float(table["total_high"].max()))
            )
        else:
            _bar(panel, y, table, "mu_star", BLUE, "mean size", factor)
            panel.set_xlim(0.0, 1.05 * factor * float(table["mu_star_high"].max()))
        panel.set_title(f"{literal(name)}: {_spread(one)}", loc="left", fontsize=SMALL + 1.0)
        label(
            panel, None, "share of the variance" if sobol else f"mean size of the effect{', ' + unit if unit else ''}"
        )
        if i == min(COLUMNS, len(panels)) - 1:
            legend(panel)
    return figure


def _spread(one: Effects) -> str:
    """Mean and standard deviation of an output, and what is missing of it."""
    _, unit, factor = named(one.output)
    missing = f"; {one.missing} flights have none" if one.missing else ""
    return f"{factor * one.mean:.4g} ± {factor * one.sd:.3g} {unit}".rstrip() + missing


def draw_tornado(found: Study) -> "Figure":
    """Draw how far each output goes with each factor."""
    words_ = "change of the output from a factor's 10 % to its 90 % point; lines: 95 %, bootstrap"
    figure, panels = _panels(found, "how far each output goes with a factor", words_, wide=True)
    names = [name for name in found.design.names if name != REST]
    mean_size = np.zeros(len(names))
    for one in found.effects:
        if not one.why:
            size = one.rows.set_index("factor").loc[names, "swing"].abs().to_numpy(float)
            mean_size += size / max(float(size.max()), 1e-300)
    names = [names[i] for i in np.argsort(-mean_size, kind="stable")]
    for i, (panel, one) in enumerate(panels):
        table, y = one.rows.set_index("factor").loc[names], _bars(panel, names, i % COLUMNS == 0)
        _, unit, factor = named(one.output)
        value, low, high = (factor * table[f"swing{end}"].to_numpy(float) for end in ("", "_low", "_high"))
        panel.barh(y, value, height=0.6, color=[BLUE if v >= 0.0 else RED for v in value], alpha=0.75)
        panel.hlines(y, low, high, color=BLACK, linewidth=1.2)
        panel.axvline(0.0, color=DARK, linewidth=0.9)
        most = 1.08 * float(np.nanmax(np.abs(np.concatenate([low, high]))))
        panel.set_xlim(-most, most)
        panel.set_title(f"{literal(named(one.output)[0])}: {_spread(one)}", loc="left", fontsize=SMALL + 1.0)
        label(panel, None, f"change{', ' + unit if unit else ''}")
    return figure


def draw_screening(found: Study) -> "Figure":
    """Draw the spread of the elementary effects against their mean size."""
    words_ = "on the right: matters; high up: interacts or bends"
    figure, panels = _panels(found, "screening", words_, wide=False)
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
                    _name(str(factor_)).partition(":")[0].rpartition(".")[2] or _name(str(factor_)),
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
    columns = ("first order", "total", "swing") if found.design.method == "sobol" else ("mean size", "spread", "swing")
    for one in found.effects:
        name, unit, factor = named(one.output)
        if one.why:
            console.print(f"{name}: no numbers: {one.why}\n")
            continue
        blocks = "base points" if found.design.method == "sobol" else "trajectories"
        left = f"; {one.missing} flights have none, {one.left_out} {blocks} are left out" if one.missing else ""
        table = _table((f"{name}, {unit}" if unit else name, *columns))
        keys = ("first", "total", "swing") if found.design.method == "sobol" else ("mu_star", "sigma", "swing")
        for _, row in one.rows.sort_values(keys[1] if keys[1] == "total" else keys[0], ascending=False).iterrows():
            scaled = [factor if key in {"swing", "mu_star", "sigma"} else 1.0 for key in keys]
            cells = [_with_interval(row, key, by) for key, by in zip(keys, scaled, strict=True)]
            table.add_row(cut_name(str(row["factor"])), *cells)
        _print(console, f"{factor * one.mean:.4g} ± {factor * one.sd:.3g} {unit}".rstrip() + left, table, "")


def cut_name(name: str) -> str:
    """Write a factor's name so that a table has room for it."""
    return name if len(name) <= MOST_LETTERS else f"…{name[1 - MOST_LETTERS :]}"


def _with_interval(row: "pd.Series[Any]", key: str, factor: float) -> Any:
    value, low, high = (factor * row[f"{key}{end}"] for end in ("", "_low", "_high"))
    if value != value:
        return "–"
    return words(f"{value:.3g}\n", (f"{low:.2g} … {high:.2g}", "dim"))
