"""The error budget of an air-data head: table for the terminal, figure `budget.png`, numbers `budget.json`."""

from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.files import write_json
from uavsim.studies.error_budget import Budget
from uavsim.views.figure import (
    BLACK,
    BLUE,
    EARTH,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    label,
    legend,
    literal,
    save,
    sheet,
)
from uavsim.views.terminal import _console, _print, _table, words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = {
    "noise": ORANGE, "tare": BLUE, "drift": PURPLE, "warming": RED, "thermometer": EARTH, "position": GREEN, "lag": SKY,
    "force": GREY,
}  # fmt: skip
SHORT = {"warming": "warm", "thermometer": "therm.", "position": "place"}
DECADES = 1e-4  # of the greatest: what is less is not drawn


def print_budget(found: Budget) -> None:
    """Print standard deviations of the airspeed, m/s, a line a speed."""
    console = _console()
    _print(console, words("\n", (_title(found), "bold"), f"\n{_conditions(found)}\n"))
    table = _table(("V, m/s", *(SHORT.get(name, name) for name in found.terms), "all"))
    table.collapse_padding = True
    for i, speed in enumerate(found.speeds):
        values = [*(sd[i] for sd in found.terms.values()), found.total[i]]
        table.add_row(f"{speed:g}", *("–" if value < 5e-4 else f"{value:.3f}" for value in values))
    _print(console, table, "standard deviations of the airspeed, m/s; –: below 0.0005\n")


def _title(found: Budget) -> str:
    total, static = found.parts
    return f"Error budget: {total} on both ports" if total == static else f"Error budget: {total} and {static}"


def _conditions(found: Budget) -> str:
    c = found.conditions
    return (
        f"{c.static / 1e3:.1f} kPa, {c.temperature - 273.15:.0f} °C; {c.since_tare:g} s and {c.warmer:g} K after the "
        f"tare; {c.acceleration:g} m/s²,\nclimb {c.climb:g} m/s, α and β {degrees(c.alpha):.0f}°, wind {c.wind:g} m/s "
        "at an open tare"
    )


def draw(found: Budget) -> "Figure":
    """Draw each cause over the airspeed, and all together."""
    said = literal(_conditions(found).replace("\n", " "))
    figure, ((axes,),) = sheet(literal(_title(found)), said, (1.0,), size=(9.5, 6.0), share=False)
    greatest = float(found.total.max())
    for name, sd in found.terms.items():
        if sd.max() > DECADES * greatest:
            axes.plot(found.speeds, sd, color=COLOURS[name], linewidth=1.2, marker=".", label=name)
    axes.plot(found.speeds, found.total, color=BLACK, linewidth=2.0, label="all")
    axes.set_yscale("log")
    axes.set_ylim(max(DECADES * greatest, 1e-4), 2.0 * greatest)
    axes.set_xlim(0.0, float(found.speeds[-1]))
    label(axes, "standard deviation of the airspeed, m/s", "true airspeed, m/s")
    legend(axes)
    return figure


def save_budget(found: Budget, folder: Path, *, plots: bool) -> None:
    """Write the numbers and the figure into a folder that is there."""
    write_json(folder / "budget.json", found.numbers())
    if plots:
        save(draw(found), folder / "budget.png")
