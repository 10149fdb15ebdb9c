"""What figures of many flights have in common: titles, names of flights, remarks on what is not to scale."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.quantities import number
from uavsim.views.figure import RED, SMALL, literal
from uavsim.views.text import cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NAMED = 3  # flights named in a remark; the others are counted
LONGEST = 190  # characters of a remark that fit below a figure
BOTTOM, REMARK = 0.55, 0.2  # in, margin below the axes, and what a line of remarks adds to it


def flights(count: int) -> str:
    """Return "1 flight", or "20 000 flights"."""
    shown = f"{count:,}".replace(",", " ") if count >= 10_000 else str(count)
    return f"{shown} flight" if count == 1 else f"{shown} flights"


def title(flown: Many) -> str:
    """Name the scenario, the flights and whether they are all that were wanted."""
    seeds = flown.column("seed")
    which = ""
    if seeds.size and np.isfinite(seeds).all():
        first, last = (f"{seeds.min():.0f}", f"{seeds.max():.0f}")
        which = f", seed {first}" if first == last else f", seeds {first} to {last}"
    partly = "" if flown.complete else " (not all were flown)"
    return f"{flown.scenario.name}, {flights(len(flown))}{which}{partly}"


def name(flown: Many, row: int) -> str:
    """Name a flight by its index, and by its seed where seeds differ."""
    seed = flown.seed(row)
    several = "seed" in flown.runs and flown.runs["seed"].nunique() > 1
    return f"flight {flown.index(row)}" + (f" (seed {seed})" if several else "")


def named(flown: Many, rows: Iterable[int]) -> str:
    """Name the first of some flights, and count the others."""
    listed = list(rows)
    more = f" and {len(listed) - NAMED} more" if len(listed) > NAMED else ""
    return ", ".join(name(flown, row) for row in listed[:NAMED]) + more


def not_to_scale(flown: Many, rows: Sequence[int], values: NDArray[np.float64], unit: str, digits: int) -> str:
    """Name flights that are beyond a scale, with their values; empty if there are none."""
    told = [
        f"{name(flown, row)}: {number(float(values[row]), digits)} {unit}".rstrip()
        + ("" if flown.sound[row] else f", {flown.words('outcome')[row]}")
        for row in rows[:NAMED]
    ]
    more = f" and {len(rows) - NAMED} more" if len(rows) > NAMED else ""
    return "; ".join(told) + more


def remark(figure: "Figure", lines: Iterable[str]) -> None:
    """Write remarks below the axes, in red; of user's text nothing is obeyed."""
    told = [literal(cut(line, LONGEST)) for line in lines if line]
    if not told:
        return
    width, height = figure.get_size_inches()
    figure.subplots_adjust(bottom=(BOTTOM + REMARK * len(told) + 0.05) / height)
    for i, line in enumerate(reversed(told)):
        y = (0.08 + REMARK * i) / height
        figure.text(0.12 / width, y, line, va="bottom", fontsize=SMALL, color=RED)


def floor_of(sample: NDArray[np.float64]) -> float:
    """Return a margin for a scale: 8 % of its range, or something for a single value."""
    return 0.08 * float(np.ptp(sample)) or 0.05 * float(np.abs(sample).max()) or 1.0


def limit_lines(axes: "Axes", flown: Many, key: str, factor: float = 1.0, *, upright: bool = False) -> None:
    """Draw the scenario's bounds of a number, where they lie within the scale."""
    low, high = axes.get_xlim() if upright else axes.get_ylim()
    for requirement in (r for r in flown.scenario.requirements if r.of_each_flight):
        if requirement.key != key:
            continue
        for bound in (requirement.minimum, requirement.maximum):
            if bound is not None and low <= factor * bound <= high:
                draw = axes.axvline if upright else axes.axhline
                draw(factor * bound, color=RED, linewidth=1.2, linestyle="--", label="required", zorder=2.5)
