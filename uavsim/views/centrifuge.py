"""Figure of a centrifuge's run: load along the arm, the other axes, and the speed of rotation."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.plants.rigs.centrifuge import CentrifugeSettings
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views.figure import BLACK, BLUE, GREY, RAW, RED, SKY, label, legend, sheet
from uavsim.views.launch import levels
from uavsim.views.marks import flag_all
from uavsim.views.record import CROSSING_G, Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROWS = (2.2, 1.0, 0.9)
RPM = 30.0 / np.pi  # 1/min for 1 rad/s


def draw(record: Record) -> "Figure | None":
    """The whole run, if it is one."""
    turning = record.scenario.plant.own
    if not isinstance(turning, CentrifugeSettings) or not record.has("accelerometer"):
        return None
    rows = ROWS if record.has("truth") else ROWS[:2]
    figure, axes = sheet(record.title, _words(record, turning), rows)
    column = [row[0] for row in axes]
    _load(column[0], record)
    _others(column[1], record)
    if record.has("truth"):
        t, speed = record.column("truth", "t"), record.column("truth", "p")
        column[2].plot(t, RPM * speed, color=BLACK, linewidth=1.2, label="true speed")
        label(column[2], "speed, 1/min")
    for one in column:
        one.set_xlim(*record.span)
        legend(one)
    label(column[-1], x="time, s")
    flag_all(figure, [column], [record.marks])
    return figure


def _words(record: Record, settings: CentrifugeSettings) -> str:
    found = record.scored("launch", "detections")
    words = f"set to {settings.load_g:g} g at {settings.arm:g} m; {record.scenario.detector.kind}: "
    words += "launch recognised" if found else "no launch recognised"
    held = _held(record, settings)
    return words if held is None else f"{words}; while held the sensor reads {held:.2f} g in the mean"


def _held(record: Record, settings: CentrifugeSettings) -> float | None:
    """Mean reading along the arm while the speed is held, g."""
    release = record.release
    if release is None:
        return None
    t, force = record.column("accelerometer", "t"), record.column("accelerometer", "fz")
    start = release + settings.spin_up
    rows = (t >= start) & (t <= start + settings.hold)
    return float(np.mean(force[rows])) / STANDARD_GRAVITY if rows.any() else None


def _load(axes: "Axes", record: Record) -> None:
    t, force = record.column("accelerometer", "t"), record.column("accelerometer", "fz")
    axes.plot(t, force / STANDARD_GRAVITY, color=RAW, linewidth=0.8, label="$f_z$ measured")
    if record.has("truth"):
        axes.plot(
            record.column("truth", "t"),
            record.column("truth", "fz") / STANDARD_GRAVITY,
            color=BLACK,
            linewidth=1.2,
            label="$f_z$ true",
        )
    for name, level in levels(record).items():
        axes.axhline(level, color=RED, linewidth=1.0, label=f"{name} = {level:.2f} g")
    axes.axhline(CROSSING_G, color=GREY, linewidth=1.0, linestyle=":", label=f"crossing level {CROSSING_G:g} g")
    axes.set_ylim(bottom=min(-0.5, axes.get_ylim()[0]))
    label(axes, "to the hub $f_z$, g")


def _others(axes: "Axes", record: Record) -> None:
    t = record.column("accelerometer", "t")
    for axis, colour, name in (("x", SKY, "$f_x$, up"), ("y", BLUE, "$f_y$, along the way")):
        axes.plot(t, record.column("accelerometer", f"f{axis}") / STANDARD_GRAVITY, color=colour, lw=0.8, label=name)
    label(axes, "$f_x$, $f_y$, g")
