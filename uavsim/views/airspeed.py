"""Figure of the airspeed: raw, estimated with its uncertainty, and true; its error below."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.onboard.airspeed.kinds import is_aided
from uavsim.set_faults import set_faults
from uavsim.studies.airspeed_flights import bound, course, together
from uavsim.views import curves
from uavsim.views.figure import BLACK, BLUE, PHASES, RED, label, legend, sheet, tint
from uavsim.views.marks import flag_all
from uavsim.views.record import Array, Record, Stretch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMOOTH = 0.1  # s, over which the bound is averaged where a whole flight is drawn: it rises between readings
FEW = 200  # values, below which each has its dot


def draw(record: Record) -> "Figure | None":
    """Airspeed and its error, over the whole flight and around the launch."""
    if not record.has("estimate") or not record.has_air:
        return None
    stretches = record.with_enlarged(record.launch)
    rows = (1.2, 1.0) if record.has("truth") else (1.0,)
    figure, axes = sheet(record.title, _words(record), rows, (1.0,) * len(stretches))
    columns = list(zip(*axes, strict=True))
    least = _bound(record)
    for column, stretch in zip(columns, stretches, strict=True):
        column[0].set_xlim(*stretch)
        _speeds(column[0], record, stretch)
        if record.has("truth"):
            _errors(column[1], record, stretch, least)
        tint(column, record.phases)
        label(column[-1], x="time, s")
    for row, name in zip(axes, ("airspeed, m/s", "error, m/s"), strict=False):
        label(row[0], name)
        legend(row[-1], row[0])
    flag_all(figure, columns, [record.milestones, record.marks][: len(columns)])
    return figure


def _words(record: Record) -> str:
    parts = []
    for name, keys in (("all", ()), *((phase, (phase,)) for phase in PHASES)):
        raw, filtered = (record.scored("airspeed", *keys, key) for key in ("rmse_raw", "rmse"))
        if filtered is not None:
            parts.append(f"{name} {raw:.3f} → {filtered:.3f}")
    kind = record.scenario.estimator.kind
    return f"{kind}: RMSE raw → filtered, m/s: {', '.join(parts)}" if parts else kind


def _speeds(axes: "Axes", record: Record, stretch: Stretch) -> None:
    t, speed, sd, raw, valid = record.within(stretch, "estimate", "airspeed", "airspeed_sd", "airspeed_raw", "valid")
    low = np.maximum(speed - 2.0 * sd, 0.0)
    axes.fill_between(t, low, speed + 2.0 * sd, color=BLUE, alpha=0.22, linewidth=0.0, label="estimate ± 2 sd")
    curves.dots(axes, t, raw, "raw")
    if record.has("truth"):
        curves.truth(axes, *record.within(stretch, "truth", "airspeed"))
    _line(axes, t, speed, "estimate")
    _not_valid(axes, t, valid)
    axes.set_ylim(bottom=0.0)


def _not_valid(axes: "Axes", t: Array, valid: Array) -> None:
    """Mark along the bottom where the estimator calls its rows invalid."""
    axes.fill_between(
        t,
        0.0,
        0.025,
        where=(valid == 0.0).tolist(),
        step="post",
        transform=axes.get_xaxis_transform(),
        color=RED,
        linewidth=0.0,
        label="not valid",
    )


def _bound(record: Record) -> tuple[Array, Array] | None:
    """Times and least standard deviation on this flight's own course, where the aided estimator flew; else None."""
    flown = record.scenario
    if not (record.has("truth") and flown.plant.chosen.flies and is_aided(flown.estimator.kind)):
        return None
    needed = (("launch", "true_time"), ("launch", "detected_time"), ("flight", "rail_exit_time"), ("airspeed", "rmse"))
    if any(record.scored(*keys) is None for keys in needed):
        return None
    if not all((record.column("truth", name) > 0.0).all() for name in ("p_static", "temperature")):
        return None
    t, sd = bound(record.flight, together([course(record.flight)]))
    if not np.isfinite(sd).all():
        return None
    return t + record.scored("launch", "true_time"), sd


def _errors(axes: "Axes", record: Record, stretch: Stretch, least: tuple[Array, Array] | None) -> None:
    t, speed, sd, raw = record.within(stretch, "estimate", "airspeed", "airspeed_sd", "airspeed_raw")
    true = np.interp(t, record.column("truth", "t"), record.column("truth", "airspeed"))
    axes.fill_between(t, -2.0 * sd, 2.0 * sd, color=BLUE, alpha=0.22, linewidth=0.0, label="± 2 sd")
    curves.dots(axes, t, raw - true, "raw − true")
    _line(axes, t, speed - true, "estimate − true")
    if least is not None:
        when, sd = _averaged(*least) if stretch == record.span else least
        shown = (when >= stretch[0]) & (when <= stretch[1])
        words = "± 2 √PCRB, no fault" if set_faults(record.scenario) else "± 2 √PCRB, the bound"
        for sign, name in ((2.0, words), (-2.0, None)):
            axes.plot(when[shown], sign * sd[shown], color=RED, linewidth=0.9, linestyle="--", label=name)
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    if stretch == record.span:
        curves.fit(axes, [(t, speed - true), (t, raw - true)], record.free, "m/s")


def _averaged(t: Array, sd: Array) -> tuple[Array, Array]:
    """Root mean squares over stretches of `SMOOTH`, at the mean of their times."""
    bins = ((t - t[0]) / SMOOTH).astype(int)
    counts = np.bincount(bins)
    there = counts > 0
    when, square = (np.bincount(bins, values)[there] / counts[there] for values in (t, sd**2))
    return when, np.sqrt(square)


def _line(axes: "Axes", t: Array, y: Array, name: str) -> None:
    few = t.size < FEW
    axes.plot(t, y, color=BLUE, linewidth=1.0 if few else 0.7, marker="." if few else "", markersize=4, label=name)
