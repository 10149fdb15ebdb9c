"""Figure of the pressures: total, static and their difference; values on the left, errors on the right."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from uavsim.views import curves
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, SMALL, label, legend, sheet, tint
from uavsim.views.marks import flag_all
from uavsim.views.record import Array, Record, known

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COVERED = "errors: from cover off,\nless their mean before\nlaunch, which the score\ngives as bias"
OPEN = "errors: less their mean\nbefore launch, which the\nscore gives as bias"

Series = tuple[Array, Array]  # time, s, and pressure, Pa


def draw(record: Record) -> "Figure | None":
    """Both pressures and their difference."""
    if not record.has("air_data") or not record.has_air:
        return None
    judged = record.has("truth")
    reference = _reference(record)
    words = _words(record, reference)
    untared = record.scenario.air_data.tare == "none"
    figure, axes = sheet(record.title, words, (1.0,) * 3, (1.0,) * (1 + judged), gap=(0.12, 0.22))
    for row, channel in zip(axes, _channels(record, reference), strict=True):
        _values(row[0], channel, "filtered" if untared else "filtered (tared)")
        if channel.true is not None:
            _errors(row[1], record, channel, channel.true)
    columns = list(zip(*axes, strict=True))
    for column in columns:
        column[0].set_xlim(*record.span)
        _cover(column, record)
        tint(column, record.phases)
        label(column[-1], x="time, s")
    flag_all(figure, columns, [record.milestones] * len(columns))
    legend(axes[0][-1], *axes[0])
    if judged:
        beside = axes[1][-1]
        words = OPEN if _covered_until(record) is None else COVERED
        beside.text(1.01, 1.0, words, transform=beside.transAxes, fontsize=SMALL, va="top", color=DARK)
    return figure


def _words(record: Record, reference: float) -> str:
    words = ""
    for name in ("total", "static"):
        raw, filtered = (record.scored("pressure", name, key) for key in ("rmse_raw", "rmse"))
        if filtered is not None:
            words += f"{name}: RMSE raw {raw:.2f}, filtered {filtered:.2f} Pa; "
    what = "the true static pressure at the start" if record.has("truth") else "the first static reading"
    return f"{words}p₀ = {reference:.1f} Pa, {what}"


def _reference(record: Record) -> float:
    """Static pressure, Pa, from which total and static pressure are drawn."""
    if record.has("truth"):
        return float(record.column("truth", "p_static")[0])
    readings = record.column("air_data", "p_static")
    return float(next(iter(readings[np.isfinite(readings)]), 0.0))


@dataclass(frozen=True, slots=True)
class _Channel:
    """A pressure by its symbol: what was read, what the estimator makes of it, and what is true; None if not there."""

    symbol: str
    reference: float | None
    raw: Series
    filtered: Series | None
    true: Series | None


def _channels(record: Record, reference: float) -> list[_Channel]:
    def series(table: str) -> Sequence[Series | None]:
        if not record.has(table):
            return (None,) * 3
        t, total, static = (record.column(table, name) for name in ("t", "p_total", "p_static"))
        return (t, total), (t, static), (t, total - static)

    references = (("p_t", reference), ("p_s", reference), ("p_t - p_s", None))
    three = zip(references, series("air_data"), series("estimate"), series("truth"), strict=True)
    return [_Channel(*named, raw, filtered, true) for named, raw, filtered, true in three if raw is not None]


def _values(axes: "Axes", channel: _Channel, filtered: str) -> None:
    reference = channel.reference or 0.0
    curves.dots(axes, channel.raw[0], channel.raw[1] - reference, "raw readings")
    if channel.true is not None:
        curves.truth(axes, channel.true[0], channel.true[1] - reference)
    if channel.filtered is not None:
        t, p = channel.filtered
        axes.plot(t, p - reference, color=BLUE, linewidth=0.8, label=filtered)
    label(axes, f"${channel.symbol}$, Pa" if channel.reference is None else f"${channel.symbol} - p_0$, Pa")


def _errors(axes: "Axes", record: Record, channel: _Channel, true: Series) -> None:
    """Raw and filtered error of a pressure less its mean before launch."""
    raw = _error(record, channel.raw, true)
    curves.dots(axes, *raw)
    shown = [raw]
    if channel.filtered is not None:
        filtered = _error(record, channel.filtered, true)
        axes.plot(*filtered, color=BLUE, linewidth=0.6)
        shown.append(filtered)
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    curves.fit(axes, shown, record.free, "Pa")
    label(axes, f"error of ${channel.symbol}$, Pa")


def _error(record: Record, series: Series, true: Series) -> Series:
    t, p = series
    error = p - np.interp(t, *true)
    error[t <= known(_covered_until(record), -np.inf)] = np.nan  # the cover keeps the true wind out
    before = (t < known(record.release, np.inf)) & np.isfinite(error)
    return t, error - error[before].mean() if before.any() else error


def _covered_until(record: Record) -> float | None:
    """When the cover came off the head, s; None if there was none or it is not known."""
    settings = record.scenario.air_data
    if settings.tare != "covered" or record.release is None:
        return None
    return record.release - settings.cover_off


def _cover(column: "Sequence[Axes]", record: Record) -> None:
    """Shade the time under the cover, and within it that of the tare."""
    until = _covered_until(record)
    if until is None:
        return
    tare = until - record.scenario.air_data.tare_duration
    for axes in column:
        axes.axvspan(record.span[0], until, color=GREY, alpha=0.15, linewidth=0.0, label="head covered", zorder=0)
        axes.axvspan(tare, until, color=GREY, alpha=0.35, linewidth=0.0, label="tare measured", zorder=0)
