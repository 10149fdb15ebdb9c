"""Single flights over each other: a few thin lines, the worst in colours; speed, height and the airspeed's error."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.airspeed_flights import LEAD, STEP
from uavsim.studies.campaign.far import far_traces, reach
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.errors import (
    ENLARGED,
    error_axes,
    error_times,
    far_words,
    rebinned,
    together,
)
from uavsim.views.campaign.quantities import RMSE, Array
from uavsim.views.campaign.words import flights, name, remark, title
from uavsim.views.curves import thin
from uavsim.views.figure import DARK, GREY, ORANGE, PURPLE, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST = 2  # flights to lay over each other
THIN = 40  # flights drawn as thin lines
WORST = (RED, PURPLE, ORANGE)
WHOLE = 12  # kept flights that are read for their height
ERROR = "airspeed error, m/s"
Curve = tuple[Array, Array]


def draw(flown: Many) -> "Figure | None":
    """Draw flights one by one; None where there is no error over time."""
    time, there = error_times(flown)
    if not there.any() or len(flown.traces) < FEWEST:
        return None
    errors = flown.matrix("filtered")
    far = far_traces(flown, time[there], errors[:, there])
    worst = _worst(flown, far)
    spread = np.unique(np.linspace(0, len(errors) - 1, min(THIN, len(errors))).round().astype(int)).tolist()
    drawn = [row for row in spread if row not in worst and not far[row]]
    begun = [row for row, trace in enumerate(flown.traces) if trace.course is not None and not far[row]][:THIN]
    speeds, heights = _paths(flown, {*drawn, *worst, *begun})
    shown = [*drawn, *worst]
    panels: list[tuple[str, dict[int, Curve]]] = [(ERROR, {})]
    if len(heights) > 1:
        panels.insert(0, ("altitude, m\n(kept flights)", heights))
    if speeds:
        panels.insert(0, ("true airspeed, m/s", speeds))
    words = flights(len(flown)) if len(flown) <= THIN else f"grey: {THIN} of {flights(len(flown))}"
    words += "; coloured: the greatest airspeed RMSE over the whole flight" if worst else ""
    end = float(time[np.isfinite(errors).any(axis=0)][-1])
    columns = (1.5, 1.0) if end > 2.0 * ENLARGED else (1.0,)
    size = (12.5, 1.6 + 1.9 * len(panels))
    figure, axes = sheet(title(flown), words, (1.0,) * len(panels), columns, size=size, right=2.3)
    for row, (what, curves) in zip(axes, panels, strict=True):
        for i, one in enumerate(row):
            one.set_xlim(float(time[there][0]), ENLARGED if i else end)
            if what == ERROR:
                every = together(time) if i == 0 and len(columns) > 1 else 1
                t, own = rebinned(every, time, errors[shown])
                _lines(one, {k: _cut(t, values) for k, values in zip(shown, own, strict=True)}, worst)
                error_axes(one, time[there], errors[np.ix_(~far, there)])
            else:
                _lines(one, curves, worst)
                _scale(one, curves)
            one.axvline(0.0, color=DARK, linewidth=0.8, linestyle="--")
        label(row[0], what)
    for one in axes[-1]:
        one.set_xlabel("time since true launch, s", fontsize=SMALL + 1.0)
    _legend(axes[0][-1], flown, worst)
    make_room(figure, 0)
    remark(figure, [far_words(flown, far)])
    return figure


def _lines(axes: "Axes", curves: dict[int, Curve], worst: list[int]) -> None:
    for row, curve in curves.items():
        if row not in worst:
            axes.plot(*thin(*curve, 1500), color=GREY, linewidth=0.5, alpha=0.7)
    for row, colour in zip(worst, WORST, strict=False):
        if row in curves:
            axes.plot(*thin(*curves[row], 3000), color=colour, linewidth=1.1)


def _worst(flown: Many, far: "np.ndarray[tuple[int], np.dtype[np.bool_]]") -> list[int]:
    """Return the rows with the greatest RMSE among those with traces that can be drawn."""
    if len(flown.traces) <= 1:
        return []
    rmse = RMSE.of(flown)[: len(flown.traces)]
    usual = np.isfinite(rmse) & ~far
    order = np.argsort(np.where(usual, -rmse, np.inf), kind="stable")
    return [int(row) for row in order[: min(len(WORST), max(1, len(order) // 2))] if usual[row]]


def _paths(flown: Many, rows: set[int]) -> tuple[dict[int, Curve], dict[int, Curve]]:
    """Return true airspeed and height over the time since the true launch, of the flights that have them."""
    speeds: dict[int, Curve] = {}
    for row, trace in enumerate(flown.traces):
        if row in rows and trace.course is not None:
            t = np.asarray(-LEAD + STEP * np.arange(trace.course.airspeed.size), dtype=np.float64)
            speeds[row] = (t, trace.course.airspeed)
    heights: dict[int, Curve] = {}
    launch = flown.column("launch.true_time")
    by_index = {flown.index(row): row for row in range(len(flown))}
    for index, kept in list(flown.kept.items())[:WHOLE]:
        row = by_index.get(index, -1)
        if row < 0 or not np.isfinite(launch[row]):
            continue
        truth = _truth(kept)
        if truth is not None:
            t = truth[0] - launch[row]
            speeds.setdefault(row, (t, truth[1]))
            heights[row] = (t, truth[2])
    return speeds, heights


def _truth(kept: object) -> tuple[Array, Array, Array] | None:
    """Return time, airspeed and height of a kept flight, of which only those are read."""
    import pandas as pd

    columns = ["t", "airspeed", "altitude"]
    try:
        table = pd.read_parquet(kept / "truth.parquet", columns=columns) if isinstance(kept, Path) else kept.truth  # type: ignore[attr-defined]
        t, speed, height = (table[column].to_numpy(float) for column in columns)
    except (OSError, KeyError, ValueError):
        return None
    return t, speed, height


def _cut(time: Array, errors: Array) -> Curve:
    known = np.isfinite(errors)
    last = int(np.flatnonzero(known)[-1]) + 1 if known.any() else 0
    return time[:last], np.where(errors[:last] > 0.0, errors[:last], np.nan)


def _scale(axes: "Axes", curves: dict[int, Curve]) -> None:
    """Scale an axis by what most of its curves need."""
    ends = np.array([(np.nanmin(y), np.nanmax(y)) for _, y in curves.values() if np.isfinite(y).any()])
    if not ends.size:
        return
    low, high = (reach(side) for side in ends.T)
    margin = 0.06 * (high.high - low.low) or 1.0
    if np.isfinite(margin):
        axes.set_ylim(low.low - margin, high.high + margin)


def _legend(axes: "Axes", flown: Many, worst: list[int]) -> None:
    axes.plot([], [], color=GREY, linewidth=0.8, label="a flight each")
    for row, colour in zip(worst, WORST, strict=False):
        words = f"{name(flown, row)}: {RMSE.of(flown)[row]:.3f} m/s"
        axes.plot([], [], color=colour, linewidth=1.4, label=words)
    legend(axes)
