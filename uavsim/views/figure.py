"""The paper that all figures are drawn on: sheet, axes, colours, legend, file.

Truth is black, raw readings are light orange, what the aircraft makes of them is blue, detection is red; phases are
tinted. The colours are those of Okabe and Ito, which colour-blind readers tell apart.

Text is text: of what stands between dollar signs only our own symbols are drawn as such, a letter with an index as in
$f_x$ or $p_t - p_s$. Everything else is drawn as it is written (`save`).
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim.files import whole
from uavsim.views.text import cut, visible

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

DPI = 130
BLACK, GREY, LIGHT, DARK, EARTH = "#000000", "#7f7f7f", "#d9d9d9", "#404040", "#8c6d31"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"
RAW = "#F3BE55"  # a lighter orange
PHASES = {"stroke": PURPLE, "transition": GREEN, "cruise": SKY}
SMALL, TEXT = 8.0, 9.0  # pt
LINE = 0.15  # in, height of a line of labels
HEAD = 0.75  # in, height of the two lines of title
TITLE, SUBTITLE = 120, 400  # characters, beyond which they would leave the sheet

_SYMBOL = re.compile(r"(\$-?[A-Za-z]_[A-Za-z0-9](?: - [A-Za-z]_[A-Za-z0-9])*\$)")
_DOLLAR = "\ue024"  # stands for a dollar sign of a user's until the figure is drawn; a user's own is made visible


def sheet(
    title: str,
    subtitle: str,
    rows: Sequence[float],
    columns: Sequence[float] = (1.0,),
    *,
    size: tuple[float, float] = (11.5, 7.5),
    right: float = 1.75,
    share: bool = True,
    gap: tuple[float, float] = (0.12, 0.16),
) -> "tuple[Figure, list[list[Axes]]]":
    """Make a figure with a title and a grid of axes.

    Parameters
    ----------
    rows, columns
        Relative heights and widths.
    size, right
        Width and height, and the margin for legends, in.
    share
        Whether the axes of a column have one time axis.
    gap
        Between rows and between columns, as a share of the mean axes.

    Returns
    -------
    tuple
        The figure and its axes, row by row.
    """
    from matplotlib.figure import Figure

    width, height = size
    figure = Figure(figsize=size, dpi=DPI, facecolor="white")
    head, below = cut(visible(title), TITLE), cut(visible(subtitle, keep=_DOLLAR), SUBTITLE)
    figure.text(0.12 / width, 1.0 - 0.12 / height, head, va="top", fontsize=12, fontweight="bold", parse_math=False)
    figure.text(0.12 / width, 1.0 - 0.36 / height, below, va="top", fontsize=TEXT, color=DARK)
    grid = figure.subplots(
        len(rows),
        len(columns),
        squeeze=False,
        sharex="col" if share else False,
        gridspec_kw={"height_ratios": rows, "width_ratios": columns},
    )
    figure.subplots_adjust(
        left=0.8 / width,
        right=1.0 - right / width,
        top=1.0 - HEAD / height,
        bottom=0.55 / height,
        hspace=gap[0],
        wspace=gap[1],
    )
    for axes in grid.flat:
        dress(axes)
    return figure, [list(row) for row in grid]


def make_room(figure: "Figure", lines: int) -> None:
    """Lower the first row of axes to leave room for lines of labels above it."""
    figure.subplots_adjust(top=1.0 - (HEAD + LINE * (lines + 0.5)) / figure.get_size_inches()[1])


def inches(axes: "Axes") -> tuple[float, float]:
    """Width and height of axes, in."""
    share, page = axes.get_position(), axes.figure.bbox
    return share.width * (page.width / DPI), share.height * (page.height / DPI)


def dress(axes: "Axes") -> None:
    """Light grid, no box, small figures."""
    axes.grid(color=LIGHT, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SMALL)
    axes.margins(x=0.0)


def label(axes: "Axes", y: str | None = None, x: str | None = None) -> None:
    """Name the axes."""
    if y is not None:
        axes.set_ylabel(y, fontsize=TEXT)
    if x is not None:
        axes.set_xlabel(x, fontsize=TEXT)


def tint(column: "Sequence[Axes]", phases: Iterable[tuple[str, float, float]]) -> None:
    """Shade the scored phases, each with its first and last time."""
    for name, first, last in phases:
        for axes in column:
            named = name if axes is column[0] else None
            axes.axvspan(first, last, color=PHASES[name], alpha=0.13, linewidth=0.0, label=named, zorder=0)


def legend(beside: "Axes", *others: "Axes") -> None:
    """Put the legend of some axes right of the first one, where no data are."""
    entries: dict[str, Any] = {}
    for axes in (*others, beside):
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(name, handle)
    beside.legend(
        list(entries.values()),
        list(entries),
        loc="upper left",
        bbox_to_anchor=(1.01, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.6,
    )


def literal(name: str) -> str:
    """Return a user's name for a label: drawn as it is written, whatever it holds, and never left out of a legend."""
    shown = visible(name).replace("$", _DOLLAR)
    return f" {shown}" if shown.startswith("_") else shown  # matplotlib hides what begins with an underscore


def save(figure: "Figure", path: Path) -> Path:
    """Write a figure as PNG, without a trace of when or by what, and with all text drawn as it is written."""
    for text in _texts(figure):
        text.set_text(_drawn(text))
    with whole(path) as part:
        figure.savefig(part, dpi=DPI, format="png", metadata={"Software": None})
    return path


def _texts(figure: "Figure") -> "Iterator[Text]":
    """Yield titles, labels, legends and remarks; what stands at the ticks are numbers and names of our own."""
    from matplotlib.text import Text

    yield from figure.texts
    for axes in figure.axes:
        yield from (child for child in axes.get_children() if isinstance(child, Text))
        yield from (axes.xaxis.label, axes.yaxis.label)
        drawn = axes.get_legend()
        if drawn is not None:
            yield from drawn.get_texts()


def _drawn(text: "Text") -> str:
    """Return what makes matplotlib draw a text as it is written; letters that its font lacks stand as escapes."""
    from matplotlib.font_manager import findfont

    there = _letters(findfont(text.get_fontproperties()))
    written = visible(text.get_text(), keep=f"\n{_DOLLAR}")
    written = "".join(c if ord(c) in there or c in f"\n{_DOLLAR}" else ascii(c)[1:-1] for c in written)
    if not text.get_parse_math():
        return written.replace(_DOLLAR, "$")
    parts = _SYMBOL.split(written)  # every second one is a symbol
    parts[::2] = [part.replace("$", r"\$") for part in parts[::2]]
    return "".join(parts).replace(_DOLLAR, r"\$")


@cache
def _letters(font: str) -> frozenset[int]:
    """Letters that a font file has."""
    from matplotlib.font_manager import get_font

    return frozenset(get_font(font).get_charmap())
