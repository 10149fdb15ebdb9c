"""Figure of the launch: specific force and what the detector makes of it, whole on the left, samples on the right."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.launch.kinds import Window
from uavsim.onboard.launch.settings import if_known
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views.figure import BLACK, BLUE, GREY, RAW, RED, SKY, label, legend, sheet
from uavsim.views.launch_sum import draw_panels, panels_of, read_again
from uavsim.views.marks import flag_all
from uavsim.views.record import CROSSING_G, Array, Record, Stretch, known

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORCE_HEIGHTS, WINDOW_HEIGHTS = (3.2, 1.4), (1.2, 0.9)
COMPONENTS = (("x", 0, RAW, BLACK), ("y", 1, SKY, BLUE), ("z", 1, RAW, RED))  # row, colour measured, colour true
BEFORE_SAMPLES, AFTER_DETECTION = 0.01, 0.025  # s, single samples are drawn from before the start to after detection
LEAST_SAMPLES, UNDETECTED_SAMPLES = 0.05, 0.12  # s after the start, at least, and without a detection


def draw(record: Record) -> "Figure | None":
    """Specific force and the detector's windows, or its sum, around the launch."""
    if record.start is None or record.launch is None or not record.has("accelerometer"):
        return None
    if not record.scenario.plant.chosen.launches:
        return None
    kind, origin = if_known(record.scenario.detector), record.start
    windows, panels = record.has("detector") and kind.window is not None, panels_of(kind)
    heights = FORCE_HEIGHTS + (WINDOW_HEIGHTS if windows else tuple(panel.height for panel in panels))
    figure, axes = sheet(record.title, _words(record), heights, (1.5, 1.0), size=(11.5, 8.0))
    columns = list(zip(*axes, strict=True))
    stretches = (record.launch, _recognition(record, origin, record.launch))
    state = read_again(record, panels, record.launch[1]) if panels and not windows else None
    for column, stretch in zip(columns, stretches, strict=True):
        column[0].set_xlim(*(1e3 * (t - origin) for t in stretch))
        _force(column, record, stretch, origin)
        if windows and kind.window is not None:
            _draw_windows(column[2:], kind.window(record.scenario.detector), _windows(record, stretch, origin))
        elif state is not None:
            draw_panels(column[2:], panels, state, stretch, origin)
    named = "true launch" if record.named("true launch") else "release" if record.release is not None else "detection"
    for one in axes[-1]:
        label(one, x=f"time since {named} (t = {origin:.3f} s), ms")
    for _, beside in axes:
        label(beside, "")
        legend(beside)
    flag_all(figure, columns, [record.marks] * 2, origin, 1e3)
    return figure


def _recognition(record: Record, start: float, launch: Stretch) -> Stretch:
    """Stretch of time in which single samples show."""
    first = known(record.release, start)
    last = start + UNDETECTED_SAMPLES
    if record.detected is not None and first <= record.detected <= launch[1]:
        last = max(record.detected + AFTER_DETECTION, start + LEAST_SAMPLES)
    return max(min(first, start) - BEFORE_SAMPLES, record.span[0]), min(last, record.span[1])


def _words(record: Record) -> str:
    latency, crossing = record.scored("launch", "latency"), record.scored("launch", "latency_from_crossing")
    words = record.scenario.detector.kind + ": "
    if latency is not None:
        words += f"detected {1e3 * latency:.1f} ms after the true launch"
    else:
        words += "no launch detected" if record.detected is None else "launch detected"
    if crossing is not None:
        axis = record.scenario.launch_axis
        force = f"${'-' if axis[0] == '-' else ''}f_{axis[1]}$"
        words += f", {1e3 * crossing:.1f} ms after the true {force} crossed {CROSSING_G:g} g"
    false = record.scored("launch", "false_detections")
    return words if false is None else f"{words}; false detections before release: {false}"


# -- specific force --------------------------------------------------------------------------------------------------


def _force(column: "Sequence[Axes]", record: Record, stretch: Stretch, origin: float) -> None:
    """Specific force along x above, along y and z below, in g."""
    for axis, row, light, _ in COMPONENTS:
        t, f = record.within(stretch, "accelerometer", f"f{axis}")
        x, g, name = 1e3 * (t - origin), f / STANDARD_GRAVITY, f"$f_{axis}$ measured"
        column[row].plot(x, g, color=light, linewidth=0.8, marker=".", markersize=3.5, label=name)
    if record.has("truth"):
        for axis, row, _, dark in COMPONENTS:
            t, f = record.within(stretch, "truth", f"f{axis}")
            x, g = 1e3 * (t - origin), f / STANDARD_GRAVITY
            column[row].plot(x, g, color=dark, linewidth=1.2, label=f"$f_{axis}$ true")
    for name, level in levels(record).items():
        column[0].axhline(level, color=RED, linewidth=1.0, label=f"{name} = {level:.2f} g")
    column[0].axhline(CROSSING_G, color=GREY, linewidth=1.0, linestyle=":", label=f"crossing level {CROSSING_G:g} g")
    label(column[0], "specific force $f_x$, g")
    label(column[1], "$f_y$, $f_z$, g")


def levels(record: Record) -> dict[str, float]:
    """Levels that the detector's kind draws across the force, in g, by their names."""
    settings = record.scenario.detector
    lines = if_known(settings).lines
    return {} if lines is None else {name: level / STANDARD_GRAVITY for name, level in lines(settings).items()}


# -- windows ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Windows:
    """The detector's windows, a row a sample.

    Attributes
    ----------
    x
        Time, ms.
    level, share
        Which window is open, and which share of its samples is above the threshold; NaN if none is.
    ended, recognised
        Samples at which a window ended in vain, and at which the launch was recognised.
    """

    x: Array
    level: Array
    share: Array
    ended: NDArray[np.bool_]
    recognised: NDArray[np.bool_]


def _windows(record: Record, stretch: Stretch, origin: float) -> _Windows:
    t, level, count, total, seen = record.within(stretch, "detector", "level", "count", "total", "recognised")
    held = np.cumsum(np.cumsum(seen)) > 1.0  # after recognition the detector keeps what it had
    opened = (total > 0.0) & ~held
    replaced = np.append((level[1:] != level[:-1]) | (total[1:] < total[:-1]), False)
    return _Windows(
        x=1e3 * (t - origin),
        level=np.where(held, np.nan, level),
        share=np.divide(count, total, out=np.full(total.size, np.nan), where=opened),
        ended=opened & (seen == 0.0) & replaced,
        recognised=seen > 0.0,
    )


def _draw_windows(column: "Sequence[Axes]", window: Window, windows: _Windows) -> None:
    """Share of samples above the threshold in the window that is open, and which window that is."""
    x, (share, level) = windows.x, column
    share.plot(x, windows.share, color=BLUE, linewidth=1.0, marker=".", markersize=3.5, label="share above $G_2$")
    share.axhline(window.ratio, color=RED, linewidth=1.0, linestyle="--", label=f"$k_1$ = {window.ratio:g}")
    for rows, fill, colour, name in (
        (windows.ended, "none", BLUE, "ends below $k_1$"),
        (windows.recognised, "full", RED, "recognised"),
    ):
        if rows.any():
            share.plot(x[rows], windows.share[rows], "o", color=colour, fillstyle=fill, markersize=6, label=name)
    share.set_ylim(-0.05, 1.1)
    label(share, "count / total")
    level.step(x, windows.level, where="post", color=BLUE, linewidth=1.2, label="window open")
    level.set_ylim(-0.3, window.levels + 0.4)
    level.set_yticks(range(0, window.levels + 1, max(1, window.levels // 4)))
    label(level, "level")
