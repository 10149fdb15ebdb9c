"""What the detector found in somebody's recording: lines for the terminal, and the figure of the launch.

The figure has the whole recording on the left, and on the right the first detection, or the greatest f_x if there is
none, with the detector's windows below if it has any. Time is the log's own, in s.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.onboard.launch.settings import DetectorSettings, if_known
from uavsim.settings import read
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views import log_airspeed
from uavsim.views.curves import thin
from uavsim.views.figure import BLACK, BLUE, GREY, LIGHT, RED, SKY, label, legend, save, sheet
from uavsim.views.marks import Mark, flag_all
from uavsim.views.record import Array, Stretch, within

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uavsim.flight import Flight

HEIGHTS, WIDTHS = (3.0, 1.6, 1.2), (1.5, 1.0)
BEFORE, AFTER = 0.5, 1.0  # s around the first detection that the right column shows
MOST_LABELS, MOST_LINES = 10, 20  # detections that are labelled, and told on the terminal
DOTS = 400  # readings in a stretch, up to which each is a dot


def lines(flight: "Flight") -> list[str]:
    """Tell what was read and what was found."""
    of, found = flight.score["recording"], flight.score["recording"]["detections"]
    said = [
        f"{', '.join(of['files'])}: {of['readings']} readings from {of['start']:.3f} to {of['end']:.3f} s, "
        f"median rate {of['rate']:.4g} Hz"
    ]
    if of["gaps"]:
        longest = max(of["gaps"], key=lambda gap: gap["end"] - gap["start"])
        length = longest["end"] - longest["start"]
        said.append(f"gaps: {len(of['gaps'])}, the longest of {length:.3g} s at {longest['start']:.3f} s")
    said += [
        f"clipping: {clipped['axis']} stays at {clipped['level'] / STANDARD_GRAVITY:.3g} g for {clipped['samples']} "
        f"readings, first at {clipped['start']:.3f} s"
        for clipped in of["clipping"]
    ]
    said += [f"Warning: {remark}" for remark in of["remarks"]]
    said += [f"Warning: {flight.score['reason']}; what comes after is not read"] if flight.score["reason"] else []
    kind = flight.score["launch"]["detector"]
    air = log_airspeed.lines(flight)
    if not found:
        none = f"{kind}: no launch detected; the greatest f_x is {_greatest(flight)}"
        return [*said, none, *(_why(of["unseen"]) if of["unseen"] else ()), *air]
    said += [f"{kind}: launch detected at {t:.4f} s" for t in found[:MOST_LINES]]
    more = [f"… and {len(found) - MOST_LINES} more, in events.json"] if len(found) > MOST_LINES else []
    return [*said, *more, *air]


def _why(of: Mapping[str, Any]) -> list[str]:
    """Explain that there is no detection: what was seen, what is needed, what would have seen something."""
    forces = ", ".join(f"{s['axis']} {s['greatest'] / STANDARD_GRAVITY:.2f} g at {s['time']:.3f} s" for s in of["seen"])
    said = [f"  seen: the greatest forces are {forces}"]
    if of["level"] is not None:
        own = [f"{s['axis']} was for {1e3 * s['above']:.0f} ms" for s in of["seen"] if s["axis"] in of["axes"]]
        said.append(
            f"  needed: more than {of['level'] / STANDARD_GRAVITY:.3g} g along {' or '.join(of['axes'])} "
            f"(detector.{of['level_key']}) for some {1e3 * of['lasting']:.0f} ms (detector.{of['time_key']}); "
            + (", ".join(own) or "there was none")
        )
    said += [
        f"  nearest: --set {one['set']} would have seen one at {one['detected']:.3f} s along {one['axis']}"
        for one in of["nearest"]
    ]
    return said if of["nearest"] else [*said, "  nearest: no axis, kind or lower level would have seen one"]


def _greatest(flight: "Flight") -> str:
    table = flight.accelerometer
    row = int(np.nanargmax(table["fx"].to_numpy()))
    return f"{table['fx'].iloc[row] / STANDARD_GRAVITY:.2f} g at {table['t'].iloc[row]:.3f} s"


def save_plot(flight: "Flight", folder: Path) -> Path:
    """Draw `launch.png`, and `airspeed.png` where there is one, into a folder, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    airspeed = log_airspeed.draw(flight)
    if airspeed is not None:
        save(airspeed, folder / "airspeed.png")
    return save(draw(flight), folder / "launch.png")


def draw(flight: "Flight") -> "Figure":
    """Specific force and the detector's state over the whole recording and around the first detection.

    Of a log whose clock begins anew it is the part with the first detection, or with the greatest f_x.
    """
    flight = _part(flight)
    readings, found = flight.accelerometer, flight.score["recording"]["detections"]
    t = readings["t"].to_numpy()
    centre = found[0] if found else float(t[int(np.nanargmax(readings["fx"].to_numpy()))])
    whole = float(t[0]), float(t[-1])
    stretches: tuple[Stretch, Stretch] = (whole, (max(centre - BEFORE, whole[0]), min(centre + AFTER, whole[1])))
    detector = read(DetectorSettings, flight.scenario["detector"])
    windows = if_known(detector).window is not None
    heights = HEIGHTS if windows else HEIGHTS[:-1]
    figure, axes = sheet(flight.scenario["name"], _words(flight), heights, WIDTHS, size=(11.5, 7.0))
    columns = list(zip(*axes, strict=True))
    for column, stretch in zip(columns, stretches, strict=True):
        column[0].set_xlim(*stretch)
        _force(column, flight, stretch, detector)
        if windows:
            _windows(column[2], flight, stretch)
        label(column[-1], x="time of the log, s")
    for row, (left, beside) in enumerate(axes):
        label(left, ("specific force $f_x$, g", "$f_y$, $f_z$, g", "windows")[row])
        legend(beside)
    marks = [Mark(time, f"detected {time:.3f} s", RED) for time in found]
    if not found:
        marks = [Mark(centre, "greatest $f_x$", GREY)]
    flag_all(figure, columns, [marks[:MOST_LABELS]] * 2)
    return figure


def _part(flight: "Flight") -> "Flight":
    """Return the part of a log in which its clock runs on and the first detection lies, or the greatest f_x."""
    readings, detector = flight.accelerometer, flight.detector
    t = readings["t"].to_numpy()
    back = np.flatnonzero(np.diff(t) <= 0.0) + 1
    if not back.size or len(detector) != len(readings):
        return flight
    recognised = np.flatnonzero(detector["recognised"].to_numpy())
    row = int(recognised[0]) if recognised.size else int(np.nanargmax(readings["fx"].to_numpy()))
    edges = [0, *back.tolist(), len(t)]
    place = int(np.searchsorted(edges, row, side="right"))
    start, end = edges[place - 1], edges[place]
    tables = {name: flight.tables[name].iloc[start:end] for name in ("accelerometer", "detector")}
    found = [float(t[i]) for i in recognised if start <= i < end]
    recording = {**flight.score["recording"], "detections": found}
    return replace(flight, tables={**flight.tables, **tables}, score={**flight.score, "recording": recording})


def _words(flight: "Flight") -> str:
    of = flight.score["recording"]
    found = len(of["detections"])
    words = "no launch detected" if not found else "1 detection" if found == 1 else f"{found} detections"
    gaps = f", {len(of['gaps'])} gaps" if len(of["gaps"]) > 1 else ", 1 gap" if of["gaps"] else ""
    return f"{flight.score['launch']['detector']}: {words}; {of['rate']:.4g} Hz{gaps}"


def _force(column: "Sequence[Axes]", flight: "Flight", stretch: Stretch, detector: DetectorSettings) -> None:
    """Specific force along x above, along y and z below, in g."""
    for row, axis, colour in ((0, "fx", BLACK), (1, "fy", SKY), (1, "fz", BLUE)):
        times, f = thin(*_columns(flight, "accelerometer", axis, stretch))
        marker = "." if times.size <= DOTS else ""
        name = f"$f_{axis[1]}$"
        column[row].plot(times, f / STANDARD_GRAVITY, color=colour, linewidth=0.8, marker=marker, label=name)
    for name, level in _levels(detector).items():
        g = level / STANDARD_GRAVITY
        column[0].axhline(g, color=RED, linewidth=1.0, label=f"{name} {g:.2f} g")


def _levels(detector: DetectorSettings) -> dict[str, float]:
    """Levels that the detector's kind draws across the force, m/s², by their names."""
    lines = if_known(detector).lines
    return {} if lines is None else dict(lines(detector))


def _windows(axes: "Axes", flight: "Flight", stretch: Stretch) -> None:
    """Samples in the window that is open, and those of them above the threshold."""
    for name, colour, width in (("total", LIGHT, 4.0), ("count", BLUE, 1.0)):
        times, n = thin(*_columns(flight, "detector", name, stretch))
        axes.step(times, n, where="post", color=colour, linewidth=width, label=name)
    axes.set_ylim(bottom=0.0)


def _columns(flight: "Flight", table: str, name: str, stretch: Stretch) -> tuple[Array, Array]:
    columns = flight.tables[table]
    t, values = within(stretch, columns["t"].to_numpy(dtype=float), columns[name].to_numpy(dtype=float))
    return t, values
