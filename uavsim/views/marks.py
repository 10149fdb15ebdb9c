"""Moments on a time axis: dashed lines through the axes, labelled above them where no label covers another."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from uavsim.views.figure import GREY, LINE, SMALL, inches, make_room

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CHARACTER = 0.066  # in, mean width of a character of 8 pt


@dataclass(frozen=True, slots=True)
class Mark:
    """A moment, s, with its label and colour."""

    t: float
    label: str
    colour: str = GREY


Placed = list[tuple[Mark, float, int]]
"""Marks with their x and the line of their label, counted from below."""


def stack(axes: "Axes", marks: Iterable[Mark], origin: float = 0.0, scale: float = 1.0) -> Placed:
    """Find a line for the label of each mark within the axes' limits, at x = scale (t - origin).

    A label begins at its mark and stands above those further right that it would cover, so nothing crosses a label.
    """
    low, high = axes.get_xlim()
    inch = (high - low) / inches(axes)[0]
    placed: Placed = []
    for mark in sorted(marks, key=lambda m: -m.t):
        x = scale * (mark.t - origin)
        if low <= x <= high:
            end = x + CHARACTER * (len(mark.label) + 1) * inch
            placed.append((mark, x, 1 + max((line for _, other, line in placed if other < end), default=-1)))
    return placed


def flags(column: "Sequence[Axes]", placed: Placed) -> None:
    """Draw moments as lines through a column of axes, labelled above it as `stack` has found."""
    top = column[0]
    width, height = inches(top)
    low, high = top.get_xlim()
    across = top.get_xaxis_transform()
    for mark, x, line in placed:
        for axes in column:
            axes.axvline(x, color=mark.colour, linewidth=0.9, linestyle=(0, (4, 2)), zorder=1.5)
        y = 1.0 + LINE * (line + 0.5) / height
        top.plot([x, x], [1.0, y], color=mark.colour, linewidth=0.9, transform=across, clip_on=False, zorder=1.5)
        right = x + 0.03 / width * (high - low)
        top.text(right, y, mark.label, color=mark.colour, fontsize=SMALL, va="center", transform=across)


def flag_all(
    figure: "Figure",
    columns: "Iterable[Sequence[Axes]]",
    marks: Iterable[list[Mark]],
    origin: float = 0.0,
    scale: float = 1.0,
) -> None:
    """Flag each column of a sheet with its own marks, with as much room above as they need."""
    stacks = [(column, stack(column[0], own, origin, scale)) for column, own in zip(columns, marks, strict=True)]
    make_room(figure, 1 + max((line for _, placed in stacks for _, _, line in placed), default=-1))
    for column, placed in stacks:
        flags(column, placed)
