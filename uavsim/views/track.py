"""Figure of the ground track: the way over the ground as seen from above, to scale, with the rail and the mean wind."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.views.curves import COLUMNS
from uavsim.views.figure import BLACK, BLUE, GREY, PHASES, SMALL, inches, label, legend, sheet
from uavsim.views.record import Record, within
from uavsim.views.trajectory import flew, parts, shapes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUBTITLE = "way over the ground from above, to scale; north is up"
WIDTH, HEIGHT = 9.5, 6.5  # in
LEAST = 20.0  # m that the shorter side shows at least
MARGIN = 1.15  # of what is shown to what is flown
ARROW = 0.12  # of the axes' height, length of the wind's arrow


def draw(record: Record) -> "Figure | None":
    """North over east, coloured by phase."""
    if not record.has("truth") or not flew(record):
        return None
    figure, ((axes,),) = sheet(record.title, SUBTITLE, (1.0,), size=(WIDTH, HEIGHT), share=False)
    t, north, east = (record.column("truth", name) for name in ("t", "north", "east"))
    for name, first, last in parts(record, t):
        y, x = (a[:: max(1, a.size // COLUMNS)] for a in list(within((first, last), t, north, east))[1:])
        axes.plot(x, y, color=PHASES.get(name, GREY), linewidth=2.0, label=name)
    for mark, shape in shapes(record):
        at = [np.interp(mark.t, t, a) for a in (east, north)]
        axes.plot(*at, shape, color=mark.colour, fillstyle="none", markersize=7, label=mark.label, zorder=3)
    heading = np.radians(record.scenario.launcher.heading_deg)
    _frame(axes, record, np.sin(heading), np.cos(heading))
    _wind(axes, record)
    label(axes, "north, m", "east, m")
    legend(axes)
    return figure


def _frame(axes: "Axes", record: Record, east: float, north: float) -> None:
    """Set equal scales that show the whole way, and draw the launch's direction through the launcher."""
    ends = []
    for name in ("east", "north"):
        values = record.column("truth", name)
        values = values[np.isfinite(values)]
        ends.append((float(values.min(initial=0.0)), float(values.max(initial=0.0))))
    width, height = inches(axes)
    spans = [max(MARGIN * (high - low), LEAST) for low, high in ends]
    scale = max(spans[0] / width, spans[1] / height)
    (left, right), (bottom, top) = (
        (0.5 * (low + high - scale * inch), 0.5 * (low + high + scale * inch))
        for (low, high), inch in zip(ends, (width, height), strict=True)
    )
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    reach = 2.0 * scale * (width + height)
    axes.plot(
        [0.0, reach * east], [0.0, reach * north], color=BLACK, linewidth=0.8, linestyle=":", label="along the rail"
    )


def _wind(axes: "Axes", record: Record) -> None:
    """Draw an arrow along the mean wind at the place of the end, with its speed; none in calm air."""
    parts = [record.column("truth", name) for name in ("mean_wind_e", "mean_wind_n")]
    known = np.isfinite(parts[0]) & np.isfinite(parts[1])
    if not known.any():
        return
    east, north = (float(part[known][-1]) for part in parts)
    speed = float(np.hypot(east, north))
    if speed < 0.05:  # m/s; less is calm
        return
    width, height = inches(axes)
    dx, dy = ARROW * east / speed * height / width, ARROW * north / speed
    tail, head = (0.08 - 0.5 * dx, 0.88 - 0.5 * dy), (0.08 + 0.5 * dx, 0.88 + 0.5 * dy)
    arrow = {"arrowstyle": "->", "color": BLUE, "linewidth": 1.5}
    axes.annotate("", head, tail, xycoords="axes fraction", textcoords="axes fraction", arrowprops=arrow)
    axes.text(
        0.16, 0.88, f"mean wind {speed:.1f} m/s", transform=axes.transAxes, fontsize=SMALL, color=BLUE, va="center"
    )
