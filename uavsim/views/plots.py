"""One flight's plots: launch, pressure, airspeed, trajectory.

Each figure has the whole flight on the left and the launch enlarged on the right. Truth is black, raw readings are
light orange, what the aircraft makes of them is blue, detection is red; phases are tinted; the colours are those of
Okabe and Ito, which colour-blind readers tell apart. What a recording lacks is left out. Equal flights give equal
files, byte for byte, with equal versions of matplotlib.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uavsim.flight import Flight

Array = NDArray[np.float64]

DPI = 130
BLACK, GREY, LIGHT, DARK, EARTH = "#000000", "#7f7f7f", "#d9d9d9", "#404040", "#8c6d31"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"
RAW = "#F3BE55"  # a lighter orange
PHASES = {"stroke": PURPLE, "transition": GREEN, "cruise": SKY}
SMALL, TEXT = 8.0, 9.0  # pt
CHARACTER = 0.066  # in, mean width of a character of 8 pt
LINE = 0.15  # in, height of a line of labels
HEAD = 0.75  # in, height of the two lines of title
COLUMNS = 1500  # pixels that a curve is drawn for: more points than twice that do not show

CROSSING_G = 4.5  # g, the level of `uavsim.score.CROSSING`
SLOWEST = 3.0  # m/s of true airspeed below which the angle of attack has no meaning
BEFORE, AFTER_EXIT = 0.2, 0.4  # s, the launch is drawn from release - BEFORE to rail exit + AFTER_EXIT
WITHOUT_EXIT = 1.0  # s after release that are drawn if the aircraft never leaves the rail
AFTER_WING = 2.0  # s after the wing is out to which attitude and trajectory are enlarged
EXAGGERATIONS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50, 100)


def save_plots(flight: "Flight", folder: Path) -> list[Path]:
    """Draw a flight.

    Parameters
    ----------
    folder
        Made with its parents.

    Returns
    -------
    list of Path
        Those of `launch.png`, `pressure.png`, `airspeed.png` and `trajectory.png` for which there are data.
    """
    folder.mkdir(parents=True, exist_ok=True)
    record, written = _Record(flight), []
    for name, draw in (
        ("launch", _launch),
        ("pressure", _pressure),
        ("airspeed", _airspeed),
        ("trajectory", _trajectory),
    ):
        figure = draw(record)
        if figure is not None:
            written.append(save(figure, folder / f"{name}.png"))
    return written


# -- what there is to draw -------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Mark:
    """A moment, s, with its label and colour."""

    t: float
    label: str
    colour: str = GREY


@dataclass(frozen=True)
class _Record:
    """A flight with its columns as arrays and its moments by name; what is not there is None."""

    flight: "Flight"

    def has(self, table: str) -> bool:
        """Tell whether the table is there and has rows."""
        return table in self.flight.tables and len(self.flight.tables[table]) > 0

    def column(self, table: str, name: str) -> Array:
        """Return a column as floats."""
        return self.flight.tables[table][name].to_numpy(dtype=float)

    def setting(self, *keys: str) -> Any:
        """Return a scenario's value, None if it has none."""
        return _look_up(self.flight.scenario, *keys)

    def scored(self, *keys: str) -> Any:
        """Return a score's value, None if it has none."""
        return _look_up(self.flight.score, *keys)

    def event(self, name: str) -> float | None:
        """Return the time of the first event of that name, s."""
        return next((float(e["t"]) for e in self.flight.events if e["event"] == name), None)

    @cached_property
    def release(self) -> float | None:
        """When the latch let go, s."""
        value: float | None = self.scored("launch", "release_time")
        return value

    @cached_property
    def detected(self) -> float | None:
        """The detection that counts, s: in a recording without truth the one that the stroke's end confirmed."""
        value: float | None = self.scored("launch", "detected_time")
        if value is not None or self.release is not None:
            return value
        end = _first(self.event("stroke_end"), np.inf)
        times = [float(e["t"]) for e in self.flight.events if e["event"] == "launch_detected"]
        return max((t for t in times if t <= end), default=None) if np.isfinite(end) else _first(*times)

    @cached_property
    def start(self) -> float | None:
        """The best that is known of the launch's time, s."""
        value: float | None = _first(self.scored("launch", "true_time"), self.release, self.detected)
        return value

    @cached_property
    def rail_exit(self) -> float | None:
        """When the last shoe left, s."""
        value: float | None = self.scored("flight", "rail_exit_time")
        return value

    @cached_property
    def span(self) -> tuple[float, float]:
        """First and last time of the record, s."""
        times = [self.flight.tables[name]["t"] for name in self.flight.tables if self.has(name) and name != "detector"]
        return min(float(t.iloc[0]) for t in times), max(float(t.iloc[-1]) for t in times)

    @cached_property
    def launch(self) -> tuple[float, float] | None:
        """Stretch of time that shows the launch, s."""
        if self.start is None:
            return None
        first = _first(self.release, self.start)
        left = _first(self.rail_exit, None if self.release is not None else self.event("stroke_end"))
        last = first + WITHOUT_EXIT if left is None else left + AFTER_EXIT
        return max(first - BEFORE, self.span[0]), min(last, self.span[1])

    @cached_property
    def opening(self) -> tuple[float, float] | None:
        """Stretch of time from the launch until the wing has been out for a while, s."""
        if self.launch is None:
            return None
        wing = _first(self.scored("flight", "wing_out_time"), self.event("motor_on"), self.rail_exit, self.launch[1])
        return self.launch[0], min(max(wing + AFTER_WING, self.launch[1]), self.span[1])

    @cached_property
    def phases(self) -> list[tuple[str, float, float]]:
        """Scored phases with their first and last time, s."""
        if not self.has("truth") or "phase" not in self.flight.truth:
            return []
        names = self.flight.truth["phase"].to_numpy(dtype=object)
        time = self.column("truth", "t")
        edges = [0, *(np.flatnonzero(names[1:] != names[:-1]) + 1), len(names) - 1]
        return [(names[i], float(time[i]), float(time[j])) for i, j in pairwise(edges) if names[i] in PHASES]

    @cached_property
    def marks(self) -> list[Mark]:
        """What happened, in the order of time."""
        false = [e["t"] for e in self.flight.events if e["event"] == "launch_detected" and e["t"] != self.detected]
        known = [
            (self.release, "release", GREY),
            (self.scored("launch", "true_time"), "true launch", BLACK),
            (self.scored("launch", "crossing_time"), f"true {CROSSING_G:g} g", GREY),
            (self.detected, "detected", RED),
            *((t, "false detection", RED) for t in false),
            (self.rail_exit, "rail exit", BLACK),
            (self.event("stroke_end"), "stroke end noticed", BLUE),
            (self.event("not_a_launch"), "not a launch", BLUE),
            (self.event("wings_commanded"), "wings commanded", BLUE),
            (self.scored("flight", "wing_out_time"), "wing out", BLACK),
            (self.event("motor_on"), "motor on", BLUE),
        ]
        return sorted((Mark(t, label, colour) for t, label, colour in known if t is not None), key=lambda m: m.t)

    def named(self, *labels: str) -> list[Mark]:
        """Pick marks by their labels."""
        return [mark for mark in self.marks if mark.label in labels]

    @cached_property
    def milestones(self) -> list[Mark]:
        """The few marks that a whole flight has room for; where truth is missing, what was noticed on board."""
        pairs = (("true launch", "detected"), ("rail exit", "stroke end noticed"), ("wing out", "wings commanded"))
        return [mark for pair in pairs for mark in (self.named(pair[0]) or self.named(pair[1]))[:1]]

    @cached_property
    def title(self) -> str:
        """Scenario, seed and outcome."""
        outcome, expected = self.scored("outcome"), self.scored("expected")
        parts = [str(self.setting("name") or "recording")]
        if self.scored("seed") is not None:
            parts.append(f"seed {self.scored('seed')}")
        title = ", ".join(parts)
        if not outcome:
            return title
        verdict = " (as expected)" if outcome == expected else f" (expected {expected})" if expected else ""
        return f"{title}: {outcome}{verdict}"


def _look_up(values: Any, *keys: str) -> Any:
    for key in keys:
        values = values.get(key) if isinstance(values, dict) else None
    return values


def _first(*values: Any) -> Any:
    return next((value for value in values if value is not None), None)


# -- paper and ink ---------------------------------------------------------------------------------------------------


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
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 (matplotlib takes its time)

    width, height = size
    figure = Figure(figsize=size, dpi=DPI, facecolor="white")
    figure.text(0.12 / width, 1.0 - 0.12 / height, title, va="top", fontsize=12, fontweight="bold", parse_math=False)
    figure.text(0.12 / width, 1.0 - 0.36 / height, subtitle, va="top", fontsize=TEXT, color=DARK)
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
    axes: list[list[Axes]] = [list(row) for row in grid]
    for one in (one for row in axes for one in row):
        dress(one)
    return figure, axes


def dress(axes: "Axes") -> None:
    """Light grid, no box, small figures."""
    axes.grid(color=LIGHT, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SMALL)
    axes.margins(x=0.0)


def label(axes: "Axes", y: str = "", x: str = "") -> None:
    """Name the axes."""
    axes.set_ylabel(y, fontsize=TEXT)
    axes.set_xlabel(x, fontsize=TEXT)


def legend(beside: "Axes", *others: "Axes", lower: bool = False) -> None:
    """Put the legend of some axes right of the first one, where no data are."""
    entries: dict[str, Any] = {}
    for axes in (*others, beside):
        handles, labels = axes.get_legend_handles_labels()
        entries |= {name: handle for handle, name in zip(handles, labels, strict=True) if name not in entries}
    if entries:
        beside.legend(
            list(entries.values()),
            list(entries),
            loc="lower left" if lower else "upper left",
            bbox_to_anchor=(1.01, 0.0 if lower else 1.0),
            borderaxespad=0.0,
            frameon=False,
            fontsize=SMALL,
            handlelength=1.6,
        )


def make_room(figure: "Figure", lines: int) -> None:
    """Lower the first row of axes to leave room for lines of labels above it."""
    figure.subplots_adjust(top=1.0 - (HEAD + LINE * (lines + 0.5)) / figure.get_size_inches()[1])


def stack(
    axes: "Axes", marks: Iterable[Mark], origin: float = 0.0, scale: float = 1.0
) -> list[tuple[Mark, float, int]]:
    """Find a line for the label of each mark within the axes' limits: (mark, x, line from below).

    A label begins at its mark and stands above those further right that it would cover, so nothing crosses a label.
    """
    low, high = axes.get_xlim()
    inch = (high - low) / _size(axes)[0]
    placed: list[tuple[Mark, float, int]] = []
    for mark in sorted(marks, key=lambda m: -m.t):
        x = scale * (mark.t - origin)
        if low <= x <= high:
            end = x + CHARACTER * (len(mark.label) + 1) * inch
            placed.append((mark, x, 1 + max((line for _, other, line in placed if other < end), default=-1)))
    return placed


def flags(column: "Sequence[Axes]", placed: Iterable[tuple[Mark, float, int]]) -> None:
    """Draw moments as lines through a column of axes, labelled above it as `stack` has found."""
    top = column[0]
    width, height = _size(top)
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
    axes: "Sequence[Sequence[Axes]]", marks: Sequence[list[Mark]], origin: float = 0.0, scale: float = 1.0
) -> None:
    """Flag each column of a sheet with its own marks, with as much room above as they need."""
    stacks = [stack(first, chosen, origin, scale) for first, chosen in zip(axes[0], marks, strict=True)]
    figure = axes[0][0].get_figure()
    make_room(figure, 1 + max((line for placed in stacks for _, _, line in placed), default=-1))  # type: ignore[arg-type]
    for i, placed in enumerate(stacks):
        flags([row[i] for row in axes], placed)


def _size(axes: "Axes") -> tuple[float, float]:
    """Width and height of axes, in."""
    figure = axes.get_figure()
    assert figure is not None
    box, (width, height) = axes.get_position(), figure.get_size_inches()  # type: ignore[union-attr]
    return box.width * width, box.height * height


def thin(t: Array, y: Array, points: int = 2 * COLUMNS) -> tuple[Array, Array]:
    """Leave out what does not show, keeping the least and the greatest of each stretch.

    Parameters
    ----------
    t, y
        Shape (n,).
    points
        Most that are wanted; fewer than twice as many are returned as they are.
    """
    block = -(-2 * t.size // points)
    if block <= 4:
        return t, y
    whole = t.size // block * block
    blocks = y[:whole].reshape(-1, block)
    gap = np.isnan(blocks)
    least = np.argmin(np.where(gap, np.inf, blocks), axis=1)
    greatest = np.argmax(np.where(gap, -np.inf, blocks), axis=1)
    starts = np.arange(0, whole, block)
    chosen = np.unique(np.concatenate([starts + least, starts + greatest, [0, t.size - 1]]))
    return t[chosen], y[chosen]


def save(figure: "Figure", path: Path) -> Path:
    """Write a figure as PNG, without a trace of when or by what."""
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def _within(span: tuple[float, float], t: Array, *values: Array) -> Iterator[Array]:
    """Rows of a stretch of time, with one more on each side."""
    first = max(int(np.searchsorted(t, span[0])) - 1, 0)
    last = int(np.searchsorted(t, span[1], side="right")) + 1
    return (a[first:last] for a in (t, *values))


def _tint(column: "Sequence[Axes]", record: _Record) -> None:
    """Shade the scored phases."""
    for axes in column:
        for name, first, last in record.phases:
            named = name if axes is column[0] else None
            axes.axvspan(first, last, color=PHASES[name], alpha=0.13, linewidth=0.0, label=named, zorder=0)


def _columns(record: _Record, zoom: tuple[float, float] | None) -> list[tuple[float, float]]:
    """Stretches of time to draw: the whole flight and the one that is enlarged."""
    return [record.span] if zoom is None or zoom[1] <= zoom[0] else [record.span, zoom]


# -- launch ----------------------------------------------------------------------------------------------------------


def _launch(record: _Record) -> "Figure | None":
    """Specific force and the detector's windows around the launch."""
    if record.launch is None or not record.has("accelerometer"):
        return None
    stretches = [record.launch, _recognition(record)]
    windows = record.has("detector") and bool(np.isfinite(record.column("detector", "total")).any())
    heights = (3.2, 1.4, 1.2, 0.9) if windows else (3.2, 1.4)
    figure, axes = sheet(record.title, _launch_words(record), heights, (1.5, 1.0), size=(11.5, 8.0))
    origin = float(record.start or 0.0)
    for i, stretch in enumerate(stretches):
        column = [row[i] for row in axes]
        column[0].set_xlim(*(1e3 * (t - origin) for t in stretch))
        _force(column, record, stretch, origin)
        if windows:
            _windows(column[2:], record, stretch, origin)
    named = "true launch" if record.named("true launch") else "release" if record.release is not None else "detection"
    for one in axes[-1]:
        one.set_xlabel(f"time since {named} (t = {origin:.3f} s), ms", fontsize=TEXT)
    for row in axes:
        row[1].set_ylabel("")
        legend(row[1])
    flag_all(axes, [record.marks] * 2, origin, 1e3)
    return figure


def _recognition(record: _Record) -> tuple[float, float]:
    """Stretch of time in which single samples show, s."""
    assert record.start is not None
    assert record.launch is not None
    first = _first(record.release, record.start)
    seen = record.detected is not None and first <= record.detected <= record.launch[1]
    last = record.detected + 0.025 if seen and record.detected is not None else record.start + 0.12
    return max(min(first, record.start) - 0.01, record.span[0]), min(max(last, record.start + 0.05), record.span[1])


def _launch_words(record: _Record) -> str:
    latency, crossing = record.scored("launch", "latency"), record.scored("launch", "latency_from_crossing")
    kind = record.setting("detector", "kind") or "detector"
    if latency is None:
        words = f"{kind}: " + ("no launch detected" if record.detected is None else "launch detected")
    else:
        words = f"{kind}: detected {1e3 * latency:.1f} ms after the true launch"
        words += "" if crossing is None else f", {1e3 * crossing:.1f} ms after the true $f_x$ crossed {CROSSING_G:g} g"
    false = record.scored("launch", "false_detections")
    return words + ("" if false is None else f"; false detections before release: {false}")


def _force(column: "Sequence[Axes]", record: _Record, stretch: tuple[float, float], origin: float) -> None:
    """Specific force along x above, along y and z below, in g."""
    levels = {"$G_1$": record.setting("detector", "trigger"), "$G_2$": record.setting("detector", "threshold")}
    if levels["$G_1$"] in (None, levels["$G_2$"]):
        levels = {"$G_1$ = $G_2$": levels["$G_2$"]}
    for axes, parts in ((column[0], {"x": (RAW, BLACK)}), (column[1], {"y": (SKY, BLUE), "z": (RAW, RED)})):
        for axis, (light, _) in parts.items():
            t, f = _within(stretch, record.column("accelerometer", "t"), record.column("accelerometer", f"f{axis}"))
            axes.plot(
                1e3 * (t - origin),
                f / STANDARD_GRAVITY,
                color=light,
                linewidth=0.8,
                marker=".",
                markersize=3.5,
                label=f"$f_{axis}$ measured",
            )
        for axis, (_, dark) in parts.items():
            if record.has("truth"):
                t, f = _within(stretch, record.column("truth", "t"), record.column("truth", f"f{axis}"))
                axes.plot(1e3 * (t - origin), f / STANDARD_GRAVITY, color=dark, linewidth=1.2, label=f"$f_{axis}$ true")
    for name, value in levels.items():
        if value is not None:
            g = value / STANDARD_GRAVITY
            column[0].axhline(g, color=RED, linewidth=1.0, label=f"{name} = {g:.2f} g")
    column[0].axhline(CROSSING_G, color=GREY, linewidth=1.0, linestyle=":", label=f"crossing level {CROSSING_G:g} g")
    label(column[0], "specific force $f_x$, g")
    label(column[1], "$f_y$, $f_z$, g")


def _windows(column: "Sequence[Axes]", record: _Record, stretch: tuple[float, float], origin: float) -> None:
    """Share of samples above the threshold in the window that is open, and which window that is."""
    names = ("level", "count", "total", "recognised")
    t, level, count, total, recognised = _within(
        stretch, record.column("detector", "t"), *(record.column("detector", name) for name in names)
    )
    x = 1e3 * (t - origin)
    held = np.cumsum(np.cumsum(recognised)) > 1.0  # after recognition the detector keeps what it had
    open_ = (total > 0) & ~held
    share, lane = column
    part = np.divide(count, total, out=np.full(total.size, np.nan), where=open_)
    share.plot(x, part, color=BLUE, linewidth=1.0, marker=".", markersize=3.5, label="share above $G_2$")
    ratio = record.setting("detector", "ratio")
    if ratio is not None:
        share.axhline(ratio, color=RED, linewidth=1.0, linestyle="--", label=f"$k_1$ = {ratio:g}")
    ends = open_ & (recognised == 0.0) & np.append((level[1:] != level[:-1]) | (total[1:] < total[:-1]), False)
    for rows, fill, colour, name in (
        (ends, "none", BLUE, "ends below $k_1$"),
        (recognised > 0.0, "full", RED, "recognised"),
    ):
        if rows.any():
            share.plot(x[rows], part[rows], "o", color=colour, fillstyle=fill, markersize=6, label=name)
    share.set_ylim(-0.05, 1.1)
    lane.step(x, np.where(held, np.nan, level), where="post", color=BLUE, linewidth=1.2, label="window open")
    highest = record.setting("detector", "levels") or int(np.nanmax(level, initial=1.0))
    lane.set_ylim(-0.3, highest + 0.4)
    lane.set_yticks(range(0, highest + 1, max(1, highest // 4)))
    label(share, "count / total")
    label(lane, "level")


# -- pressure --------------------------------------------------------------------------------------------------------


def _pressure(record: _Record) -> "Figure | None":
    """Both pressures and their difference: values left, errors right."""
    if not record.has("air_data"):
        return None
    channels = _channels(record)
    reference = _reference(record)
    words = f"p₀ = {reference:.1f} Pa, " + (
        "the true static pressure at the start" if record.has("truth") else "the first static reading"
    )
    width = (1.0, 1.0) if record.has("truth") else (1.0,)
    figure, axes = sheet(record.title, _pressure_words(record) + words, (1.0,) * 3, width, gap=(0.12, 0.22))
    for row, channel in zip(axes, channels, strict=True):
        _values(row[0], channel, 0.0 if channel.name == "difference" else reference)
        label(row[0], {"total": "$p_t - p_0$, Pa", "static": "$p_s - p_0$, Pa"}.get(channel.name, "$p_t - p_s$, Pa"))
        if record.has("truth"):
            _errors(row[1], record, channel)
            name = {"total": "$p_t$", "static": "$p_s$"}.get(channel.name, "$p_t - p_s$")
            label(row[1], f"error of {name}, Pa")
    for i in range(len(width)):
        column = [row[i] for row in axes]
        column[0].set_xlim(*record.span)
        _cover(column, record)
        _tint(column, record)
        column[-1].set_xlabel("time, s", fontsize=TEXT)
    flag_all(axes, [record.milestones] * len(width))
    legend(axes[0][-1], *axes[0])
    if record.has("truth"):
        axes[1][1].text(
            1.01,
            1.0,
            "errors: from cover off,\nless their mean before\nlaunch, which the score\ngives as bias",
            transform=axes[1][1].transAxes,
            fontsize=SMALL,
            va="top",
            color=DARK,
        )
    return figure


@dataclass(frozen=True, slots=True)
class _Channel:
    """A pressure: what was read, what the estimator makes of it, and what is true, each (t, p); None if not there."""

    name: str
    raw: tuple[Array, Array]
    filtered: tuple[Array, Array] | None
    true: tuple[Array, Array] | None


def _channels(record: _Record) -> list[_Channel]:
    def both(table: str) -> dict[str, tuple[Array, Array]]:
        if not record.has(table):
            return {}
        t, total, static = (record.column(table, name) for name in ("t", "p_total", "p_static"))
        return {"total": (t, total), "static": (t, static), "difference": (t, total - static)}

    raw, filtered, true = both("air_data"), both("estimate"), both("truth")
    return [_Channel(name, raw[name], filtered.get(name), true.get(name)) for name in raw]


def _reference(record: _Record) -> float:
    if record.has("truth"):
        return float(record.column("truth", "p_static")[0])
    readings = record.column("air_data", "p_static")
    finite = readings[np.isfinite(readings)]
    return float(finite[0]) if finite.size else 0.0


def _pressure_words(record: _Record) -> str:
    parts = []
    for name in ("total", "static"):
        raw, rmse = record.scored("pressure", name, "rmse_raw"), record.scored("pressure", name, "rmse")
        if raw is not None and rmse is not None:
            parts.append(f"{name}: RMSE raw {raw:.2f}, filtered {rmse:.2f} Pa")
    return "".join(part + "; " for part in parts)


def _values(axes: "Axes", channel: _Channel, reference: float) -> None:
    _dots(axes, channel.raw[0], channel.raw[1] - reference, "raw readings")
    if channel.true is not None:
        axes.plot(*thin(channel.true[0], channel.true[1] - reference), color=BLACK, linewidth=1.3, label="true")
    if channel.filtered is not None:
        t, p = channel.filtered
        axes.plot(t, p - reference, color=BLUE, linewidth=0.8, label="filtered (tared)")


def _dots(axes: "Axes", t: Array, y: Array, name: str) -> None:
    axes.plot(t, y, linestyle="none", marker=".", markersize=2.5, color=RAW, label=name, zorder=1.8)


def _errors(axes: "Axes", record: _Record, channel: _Channel) -> None:
    """Raw and filtered error of a pressure less its mean before launch."""
    assert channel.true is not None
    shown = []
    for pair, draw in ((channel.raw, _dots), (channel.filtered, _line)):
        if pair is not None:
            t, p = pair
            error = p - np.interp(t, *channel.true)
            error[t <= _first(_covered_until(record), -np.inf)] = np.nan  # the cover keeps the true wind out
            before = (t < _first(record.release, np.inf)) & np.isfinite(error)
            error = error - (error[before].mean() if before.any() else 0.0)
            draw(axes, t, error, "")
            shown.append((t, error))
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    _fit(axes, record, shown, "Pa")


def _line(axes: "Axes", t: Array, y: Array, name: str) -> None:
    axes.plot(t, y, color=BLUE, linewidth=0.6, label=name)


def _covered_until(record: _Record) -> float | None:
    off = record.setting("air_data", "cover_off")
    covered = record.setting("air_data", "tare") == "covered" and record.release is not None and off is not None
    return record.release - off if covered and record.release is not None else None


def _cover(column: "Sequence[Axes]", record: _Record) -> None:
    """Shade the time under the cover, and within it that of the tare."""
    until = _covered_until(record)
    if until is None:
        return
    tare = record.setting("air_data", "tare_duration") or 0.0
    for axes in column:
        axes.axvspan(record.span[0], until, color=GREY, alpha=0.15, linewidth=0.0, label="head covered", zorder=0)
        axes.axvspan(until - tare, until, color=GREY, alpha=0.35, linewidth=0.0, label="tare measured", zorder=0)


def _fit(axes: "Axes", record: _Record, shown: list[tuple[Array, Array]], unit: str) -> None:
    """Scale an axis of errors to flight after the rail, and say what lies beyond it."""
    after = _first(record.rail_exit, record.start, record.span[0])
    sizes = [np.abs(y[(t > after) & np.isfinite(y)]) for t, y in shown]
    tops = [float(np.quantile(size, 0.995)) for size in sizes if size.size]
    largest = max((float(np.nanmax(np.abs(y))) for _, y in shown if np.isfinite(y).any()), default=0.0)
    limit = 1.5 * max(tops, default=0.0) or largest or 1.0
    if largest <= 1.5 * limit:
        limit = max(limit, 1.05 * largest)
    else:
        _remark(axes, f"beyond the axis: up to {largest:.{0 if largest > 20 else 1}f} {unit}")
    axes.set_ylim(-limit, limit)


def _remark(axes: "Axes", words: str) -> None:
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
    axes.text(0.99, 0.03, words, transform=axes.transAxes, ha="right", fontsize=SMALL, color=DARK, bbox=box)


# -- airspeed --------------------------------------------------------------------------------------------------------


def _airspeed(record: _Record) -> "Figure | None":
    """Airspeed and its error."""
    if not record.has("estimate"):
        return None
    columns = _columns(record, record.launch)
    rows = (1.2, 1.0) if record.has("truth") else (1.0,)
    figure, axes = sheet(record.title, _airspeed_words(record), rows, (1.0,) * len(columns))
    for i, stretch in enumerate(columns):
        column = [row[i] for row in axes]
        column[0].set_xlim(*stretch)
        _speeds(column[0], record, stretch)
        if record.has("truth"):
            _speed_errors(column[1], record, stretch, whole=i == 0)
        _tint(column, record)
        column[-1].set_xlabel("time, s", fontsize=TEXT)
    for row, name in zip(axes, ("airspeed, m/s", "error, m/s"), strict=False):
        row[0].set_ylabel(name, fontsize=TEXT)
        legend(row[-1], row[0])
    flag_all(axes, [record.milestones, record.marks][: len(columns)])
    return figure


def _airspeed_words(record: _Record) -> str:
    parts = []
    for name, keys in (("all", ()), *((phase, (phase,)) for phase in PHASES)):
        raw, rmse = record.scored("airspeed", *keys, "rmse_raw"), record.scored("airspeed", *keys, "rmse")
        if raw is not None and rmse is not None:
            parts.append(f"{name} {raw:.3f} → {rmse:.3f}")
    kind = record.setting("estimator", "kind") or "estimator"
    return f"{kind}: RMSE raw → filtered, m/s: {', '.join(parts)}" if parts else kind


def _speeds(axes: "Axes", record: _Record, stretch: tuple[float, float]) -> None:
    names = ("airspeed", "airspeed_sd", "airspeed_raw", "valid")
    t, speed, sd, raw, valid = _within(
        stretch, record.column("estimate", "t"), *(record.column("estimate", name) for name in names)
    )
    low = np.maximum(speed - 2.0 * sd, 0.0)
    axes.fill_between(t, low, speed + 2.0 * sd, color=BLUE, alpha=0.22, linewidth=0.0, label="estimate ± 2 sd")
    _dots(axes, t, raw, "raw")
    if record.has("truth"):
        true_t, true = _within(stretch, record.column("truth", "t"), record.column("truth", "airspeed"))
        axes.plot(*thin(true_t, true), color=BLACK, linewidth=1.3, label="true")
    _estimated(axes, t, speed, "estimate")
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
    axes.set_ylim(bottom=0.0)


def _speed_errors(axes: "Axes", record: _Record, stretch: tuple[float, float], *, whole: bool) -> None:
    names = ("airspeed", "airspeed_sd", "airspeed_raw")
    t, speed, sd, raw = _within(
        stretch, record.column("estimate", "t"), *(record.column("estimate", name) for name in names)
    )
    true = np.interp(t, record.column("truth", "t"), record.column("truth", "airspeed"))
    axes.fill_between(t, -2.0 * sd, 2.0 * sd, color=BLUE, alpha=0.22, linewidth=0.0, label="± 2 sd")
    _dots(axes, t, raw - true, "raw − true")
    _estimated(axes, t, speed - true, "estimate − true")
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    if whole:
        _fit(axes, record, [(t, speed - true), (t, raw - true)], "m/s")


def _estimated(axes: "Axes", t: Array, y: Array, name: str) -> None:
    """Draw a line, with a dot a value where there are few."""
    few = t.size < 200
    axes.plot(t, y, color=BLUE, linewidth=1.0 if few else 0.7, marker="." if few else "", markersize=4, label=name)


# -- trajectory ------------------------------------------------------------------------------------------------------


def _trajectory(record: _Record) -> "Figure | None":
    """Way through the air, attitude, throttle and wing."""
    if not record.has("truth"):
        return None
    columns = _columns(record, record.opening)
    if len(columns) == 2 and record.span[1] - columns[1][1] < 1.0:  # the enlargement would show all there is
        columns = columns[1:]
    words = "height above the ground at the launcher over the way along the rail's heading"
    figure, axes = sheet(record.title, words, (1.0,) * 3, (1.0,) * len(columns), size=(11.5, 8.6), share=False)
    for i, stretch in enumerate(columns):
        path, attitude, controls = column = [row[i] for row in axes]
        for one, bottom, height in zip(column, (5.7, 2.4, 0.6), (2.0, 2.0, 1.6), strict=True):
            box = one.get_position()
            one.set_position((box.x0, bottom / 8.6, box.width, height / 8.6))
        _path(path, record, stretch)
        _attitude(attitude, record, stretch)
        _controls(controls, record, stretch)
        _tint([attitude, controls], record)
        for one in (attitude, controls):
            one.set_xlim(*stretch)
        attitude.tick_params(labelbottom=False)
        path.set_xlabel("distance, m", fontsize=TEXT)
        controls.set_xlabel("time, s", fontsize=TEXT)
        names = ("detected", "wings commanded", "wing out") if stretch != record.span else ()
        flags([attitude, controls], stack(attitude, record.named("true launch", "rail exit", "motor on", *names)))
    for row, name in zip(axes, ("height, m", "angle, °", "throttle, wing"), strict=True):
        row[0].set_ylabel(name, fontsize=TEXT)
        legend(row[-1], row[0])
    return figure


def _path(axes: "Axes", record: _Record, stretch: tuple[float, float]) -> None:
    """Height over distance, coloured by phase, with what happened on the way."""
    t, north, east, altitude = (record.column("truth", name) for name in ("t", "north", "east", "altitude"))
    heading = np.radians(record.setting("launcher", "heading_deg") or 0.0)
    distance = north * np.cos(heading) + east * np.sin(heading)
    height = altitude - (record.setting("environment", "ground_elevation") or 0.0)
    phases = [("rail", t[0], record.phases[0][1] if record.phases else t[-1]), *record.phases]
    for name, first, last in phases:
        part = [a[:: max(1, a.size // COLUMNS)] for a in _within((first, last), t, distance, height)]
        axes.plot(part[1], part[2], color=PHASES.get(name, GREY), linewidth=2.0, label=name)
    shown = (t >= stretch[0]) & (t <= stretch[1])
    for mark, shape in _shapes(record):
        if stretch[0] <= mark.t <= stretch[1]:
            at = [np.interp(mark.t, t, a) for a in (distance, height)]
            axes.plot(*at, shape, color=mark.colour, fillstyle="none", markersize=7, label=mark.label, zorder=3)
    axes.axhline(0.0, color=EARTH, linewidth=1.5, label="ground")
    _scale(axes, distance[shown], height[shown])


def _shapes(record: _Record) -> Iterator[tuple[Mark, str]]:
    shapes = {"detected": "x", "rail exit": "s", "wing out": "D", "motor on": "o"}
    yield from ((mark, shapes[mark.label]) for mark in record.marks if mark.label in shapes)
    if record.scored("outcome") in {"crashed", "missed_launch", "diverged"}:
        yield Mark(record.span[1], f"end ({record.scored('outcome')})", RED), "X"


def _scale(axes: "Axes", distance: Array, height: Array) -> None:
    """Set limits that exaggerate the height by a round factor, and say which."""
    width, tall = _size(axes)
    shape = tall / width
    first, last = float(np.nanmin(distance)), float(np.nanmax(distance))
    low, high = min(0.0, float(np.nanmin(height))), max(1.0, float(np.nanmax(height)))
    margin = 0.08 * (high - low)
    needed = (high - low) + 2.0 * margin
    across = max(1.06 * (last - first), needed / shape)
    factor = max(e for e in EXAGGERATIONS if e * needed <= shape * across * 1.000001)
    middle = 0.5 * (first + last)
    axes.set_xlim(middle - 0.5 * across, middle + 0.5 * across)
    axes.set_ylim(low - margin, low - margin + shape * across / factor)
    words = "true aspect" if factor == 1 else f"height exaggerated {factor}×"
    axes.set_title(words, fontsize=SMALL, loc="right", pad=3, color=DARK)


def _attitude(axes: "Axes", record: _Record, stretch: tuple[float, float]) -> None:
    t, pitch, roll, alpha, airspeed = _within(
        stretch,
        *(record.column("truth", name) for name in ("t", "pitch", "roll", "alpha", "airspeed")),
    )
    alpha = np.where(airspeed > SLOWEST, alpha, np.nan)
    for name, angle, colour in (("pitch", pitch, BLACK), ("roll", roll, ORANGE), ("angle of attack", alpha, BLUE)):
        axes.plot(*thin(t, np.degrees(angle)), color=colour, linewidth=1.1, label=name)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -1.0), max(high, 1.0))


def _controls(axes: "Axes", record: _Record, stretch: tuple[float, float]) -> None:
    t, throttle, wing = _within(stretch, *(record.column("truth", name) for name in ("t", "throttle", "wing")))
    axes.plot(*thin(t, throttle), color=RED, linewidth=1.1, label="throttle")
    axes.plot(*thin(t, wing), color=BLACK, linewidth=1.1, label="wing (1 is out)")
    axes.set_ylim(-0.05, 1.08)
