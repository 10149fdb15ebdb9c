"""Figure of the trajectory: height over distance, attitude, throttle and wing; all of it, and around the launch."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from uavsim.views.curves import COLUMNS, thin
from uavsim.views.figure import (
    BLACK,
    BLUE,
    DARK,
    EARTH,
    GREY,
    ORANGE,
    PHASES,
    RED,
    SMALL,
    inches,
    label,
    legend,
    sheet,
    tint,
)
from uavsim.views.marks import Mark, flags, stack
from uavsim.views.record import Array, Record, Stretch, within

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 11.5, 8.6  # in
ROWS = ((5.7, 2.0), (2.4, 2.0), (0.6, 1.6))  # in, bottom and height of each row: the first has its own axis of distance
SUBTITLE = "height above the ground at the launcher over the way along the rail's heading"
LEAST_SAVED = 1.0  # s that an enlargement must leave out to be worth drawing beside the whole
LABELS = 6  # lines of them that the gap below the first row holds
SLOWEST = 3.0  # m/s of air from ahead below which the angle of attack has no meaning, as in a crosswind on the rail
EXAGGERATIONS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50, 100)
SHAPES = {"detected": "x", "rail exit": "s", "wing out": "D", "motor on": "o"}


def draw(record: Record) -> "Figure | None":
    """Way through the air, attitude, throttle and wing."""
    if not record.has("truth") or not flew(record):
        return None
    stretches = record.with_enlarged(record.opening)
    if record.span[1] - stretches[-1][1] < LEAST_SAVED:
        stretches = stretches[-1:]
    columns = (1.0,) * len(stretches)
    figure, axes = sheet(record.title, SUBTITLE, (1.0,) * 3, columns, size=(WIDTH, HEIGHT), share=False)
    for column, stretch in zip(zip(*axes, strict=True), stretches, strict=True):
        _arrange(column)
        path, attitude, controls = column
        _path(path, record, stretch)
        _attitude(attitude, record, stretch)
        _controls(controls, record, stretch)
        _over_time((attitude, controls), record, stretch)
    for row, name in zip(axes, ("height, m", "angle, °", "throttle, wing"), strict=True):
        label(row[0], name)
        legend(row[-1], row[0])
    return figure


def flew(record: Record) -> bool:
    """Whether there is a way to draw; a flight can diverge before its first row, and few rigs have one."""
    kind = record.scenario.plant.chosen
    if not (kind.flies or kind.air):
        return False
    return bool(np.isfinite(record.flight.truth["altitude"].to_numpy()).sum() > 1)


def _arrange(column: "Sequence[Axes]") -> None:
    for axes, (bottom, height) in zip(column, ROWS, strict=True):
        box = axes.get_position()
        axes.set_position((box.x0, bottom / HEIGHT, box.width, height / HEIGHT))


def _over_time(column: "Sequence[Axes]", record: Record, stretch: Stretch) -> None:
    """Give axes a common axis of time with phases and marks, the more of them the less time there is."""
    tint(column, record.phases)
    for axes in column:
        axes.set_xlim(*stretch)
    column[0].tick_params(labelbottom=False)
    label(column[-1], x="time, s")
    more = ("detected", "wings commanded", "wing out") if stretch != record.span else ()
    placed = stack(column[0], record.named("true launch", "rail exit", "motor on", *more))
    for _, name, _ in reversed(record.troubles):  # what was noticed on board before what was set
        fuller = stack(column[0], [*(mark for mark, _, _ in placed), *record.named(name)])
        if max((line for _, _, line in fuller), default=0) < LABELS:
            placed = fuller
    flags(column, placed)


# -- path ------------------------------------------------------------------------------------------------------------


def _path(axes: "Axes", record: Record, stretch: Stretch) -> None:
    """Height over distance, coloured by phase, with what happened on the way."""
    t, north, east, altitude = (record.column("truth", name) for name in ("t", "north", "east", "altitude"))
    heading = np.radians(record.scenario.launcher.heading_deg)
    distance = north * np.cos(heading) + east * np.sin(heading)
    height = altitude - record.scenario.environment.ground_elevation
    for name, first, last in parts(record, t):
        x, y = (a[:: max(1, a.size // COLUMNS)] for a in list(within((first, last), t, distance, height))[1:])
        axes.plot(x, y, color=PHASES.get(name, GREY), linewidth=2.0, label=name)
    for mark, shape in shapes(record):
        if stretch[0] <= mark.t <= stretch[1]:
            at = [np.interp(mark.t, t, a) for a in (distance, height)]
            axes.plot(*at, shape, color=mark.colour, fillstyle="none", markersize=7, label=mark.label, zorder=3)
    axes.axhline(0.0, color=EARTH, linewidth=1.5, label="ground")
    shown = (t >= stretch[0]) & (t <= stretch[1])
    _scale(axes, distance[shown], height[shown])
    label(axes, x="distance, m")


def parts(record: Record, t: Array) -> list[tuple[str, float, float]]:
    """Return the parts of the way that are drawn each in its colour: rail and phases; one of a rig."""
    name = "rail" if record.scenario.plant.chosen.flies else "course"
    return [(name, float(t[0]), record.phases[0][1] if record.phases else float(t[-1])), *record.phases]


def shapes(record: Record) -> Iterator[tuple[Mark, str]]:
    """Yield what happened on the way, and how it is drawn."""
    yield from ((mark, SHAPES[mark.label]) for mark in record.marks if mark.label in SHAPES)
    outcome = record.scored("outcome")
    if outcome in {"crashed", "landed", "missed_launch", "diverged"}:
        colour, shape = (BLUE, "v") if outcome == "landed" else (RED, "X")
        yield Mark(record.span[1], f"end ({outcome})", colour), shape


def _scale(axes: "Axes", distance: Array, height: Array) -> None:
    """Set limits that exaggerate the height by a round factor, and say which."""
    seen = np.isfinite(distance) & np.isfinite(height)
    distance, height = distance[seen], height[seen]
    width, tall = inches(axes)
    shape = tall / width
    first, last = float(distance.min()), float(distance.max())
    low, high = min(0.0, float(height.min())), max(1.0, float(height.max()))
    margin = 0.08 * (high - low)
    needed = (high - low) + 2.0 * margin
    across = max(1.06 * (last - first), needed / shape)
    factor = max(e for e in EXAGGERATIONS if e * needed <= shape * across * 1.000001)
    middle = 0.5 * (first + last)
    axes.set_xlim(middle - 0.5 * across, middle + 0.5 * across)
    axes.set_ylim(low - margin, low - margin + shape * across / factor)
    words = "true aspect" if factor == 1 else f"height exaggerated {factor}×"
    axes.set_title(words, fontsize=SMALL, loc="right", pad=3, color=DARK)


# -- over time -------------------------------------------------------------------------------------------------------


def _attitude(axes: "Axes", record: Record, stretch: Stretch) -> None:
    names = ("pitch", "roll", "alpha", "beta", "airspeed")
    t, pitch, roll, alpha, beta, airspeed = record.within(stretch, "truth", *names)
    alpha = np.where(airspeed * np.cos(beta) * np.cos(alpha) > SLOWEST, alpha, np.nan)
    for name, angle, colour in (("pitch", pitch, BLACK), ("roll", roll, ORANGE), ("angle of attack", alpha, BLUE)):
        axes.plot(*thin(t, np.degrees(angle)), color=colour, linewidth=1.1, label=name)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -1.0), max(high, 1.0))


def _controls(axes: "Axes", record: Record, stretch: Stretch) -> None:
    t, throttle, wing = record.within(stretch, "truth", "throttle", "wing")
    axes.plot(*thin(t, throttle), color=RED, linewidth=1.1, label="throttle")
    axes.plot(*thin(t, wing), color=BLACK, linewidth=1.1, label="wing (1 is out)")
    axes.set_ylim(-0.05, 1.08)
