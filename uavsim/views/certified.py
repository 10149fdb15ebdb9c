"""Coverage of each level of the healthy set of the certification, a panel a phase: `coverage.png`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim.score_keys import PHASES
from uavsim.studies.certify.healthy import HIGH, LOW
from uavsim.views.figure import BLUE, GREY, ORANGE, label, save, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SURE = 1.96  # standard errors


def coverage(levels: Sequence[Mapping[str, Any]]) -> "Figure":
    """Draw the mean coverage of valid rows with its standard error's 95 % interval, and that of all rows.

    Parameters
    ----------
    levels
        Table of that name of the set's verdict.
    """
    figure, grid = sheet(
        "Coverage of ±1.96 sd, nothing broken",
        "mean over flights; dot and bar: valid rows and 95 % of their mean; orange: all rows; dashed: what is asked",
        (1.0,),
        (1.0,) * len(PHASES),
        size=(13.0, 1.6 + 0.24 * len(levels)),
        share=False,
        gap=(0.12, 0.05),
    )
    places = [-k for k in range(len(levels))]
    for axes, phase in zip(grid[0], PHASES, strict=True):
        for place, row in zip(places, levels, strict=True):
            mean, error = row.get(f"{phase}.coverage"), row.get(f"{phase}.error")
            if mean is not None:
                axes.errorbar(mean, place, xerr=SURE * (error or 0.0), color=BLUE, marker="o", markersize=4)
            if row.get(f"{phase}.coverage_all") is not None:
                axes.plot(row[f"{phase}.coverage_all"], place, color=ORANGE, marker="|", markersize=9)
        for bound in (LOW, HIGH):
            axes.axvline(bound, color=GREY, linestyle="--", linewidth=0.8)
        axes.set_yticks(places, [])
        label(axes, x=phase)
    last = grid[0][-1]  # beside it is room for names
    last.yaxis.tick_right()
    last.set_yticks(places, [f"{row['factor']} {row['level']} ({row['flights']})" for row in levels])
    return figure


def save_coverage(levels: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write the figure."""
    save(coverage(levels), path)
