"""How flights ended and why: a bar a cause, with the exact interval of its probability."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.campaign.causes import Cause, causes
from uavsim.studies.campaign.many import Many
from uavsim.studies.intervals import share_interval
from uavsim.views.campaign.words import flights, title
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, RED, SMALL, label, literal, make_room, sheet
from uavsim.views.text import visible

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 12  # causes with a bar of their own
LONGEST = 52  # characters of a cause
CHARACTER, LEAST = 0.078, 1.0  # in: mean width of a character, and room for the causes at least


def draw(flown: Many) -> "Figure | None":
    """Draw the causes, the most frequent on top; None without a flight."""
    if not len(flown):
        return None
    found = causes(flown)
    n, shown = len(flown), found[:MOST]
    others = n - sum(cause.flights for cause in shown)
    rows = [(_name(cause), cause.flights, BLUE if cause.expected else RED) for cause in shown]
    if others:
        rows.append((f"{len(found) - MOST} other causes", others, GREY))
    right = int(flown.expected.sum())
    low, high = share_interval(right, n)
    words = (
        f"as expected ({flown.scenario.expect}): {right} of {flights(n)}, {100 * right / n:.4g} % "
        f"[{100 * low:.2f}, {100 * high:.2f}]; whiskers: 95 % (Clopper–Pearson)"
    )
    size = (10.5, 1.65 + 0.42 * len(rows))
    figure, ((axes,),) = sheet(title(flown), words, (1.0,), size=size, right=1.75)
    left = max(LEAST, 0.35 + CHARACTER * max(len(name) for name, _, _ in rows))
    figure.subplots_adjust(left=left / size[0])
    across = axes.get_yaxis_transform()
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0.0, 100.0)
    for i, (name, count, colour) in enumerate(rows):
        low, high = (100.0 * bound for bound in share_interval(count, n))
        axes.barh(i, 100.0 * count / n, height=0.62, color=colour, alpha=0.85)
        axes.plot((low, high), (i, i), color=BLACK, linewidth=1.2)
        axes.plot((low, high), (i, i), "|", color=BLACK, markersize=7.0, clip_on=False)
        axes.text(-0.015, i, literal(name), transform=across, ha="right", va="center", fontsize=SMALL + 0.5)
        words = f"{count}   [{low:.2f}, {high:.2f}] %"
        axes.text(1.015, i, words, transform=across, ha="left", va="center", fontsize=SMALL, color=DARK)
    axes.set_yticks(np.arange(len(rows)), [""] * len(rows))
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")
    label(axes, x="share of flights, %")
    make_room(figure, 0)
    return figure


def _name(cause: Cause) -> str:
    words = f"{cause.outcome}: {cause.cause}" if cause.cause else cause.outcome
    words = visible(words)
    return words if len(words) <= LONGEST else f"{words[: LONGEST - 1]}…"
