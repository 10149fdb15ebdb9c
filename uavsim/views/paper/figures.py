"""The paper's figures on launch detection, 7, 8, 9 and 17, drawn from what was reproduced."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.paper.centrifuge import held
from uavsim.studies.paper.complexity import NAMES, SIZES
from uavsim.studies.paper.recognition import RATE, RATIO, SAMPLES, SHOWN
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views.figure import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    RAW,
    RED,
    SKY,
    SMALL,
    label,
    legend,
    sheet,
)
from uavsim.views.launch import levels
from uavsim.views.paper.airspeed import AIRSPEED_FIGURES
from uavsim.views.record import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uavsim.flight import Flight
    from uavsim.studies.paper import Reproduction

COLOURS = {"algorithm1": BLUE, "algorithm2": GREEN, "algorithm3": ORANGE, "recount": RED}
TINTS = (BLUE, SKY, GREEN, ORANGE)
FLAGS = {False: "F1: not recognised", True: "1F: recognised"}  # the paper's own flags


def figure7(found: "Reproduction") -> "Figure":
    """Launch-force curve with noise, and the threshold."""
    curve = found.recognition.drawn
    words = f"ring at 120 Hz on the plateau A, white noise of {SHOWN:g} A; the paper gives neither numbers nor units"
    figure, axes = sheet("Figure 7: fitted launch-force curve and threshold", words, (1.0,), size=(10.0, 4.6))
    one = axes[0][0]
    _curve(one, found)
    one.axhline(curve.threshold, color=RED, linewidth=1.2, label=f"threshold {curve.threshold:g} A")
    legend(one)
    return figure


def _curve(axes: "Axes", found: "Reproduction") -> None:
    curve = found.recognition.drawn
    t = 1e3 * curve.t
    axes.plot(t, curve.force, color=BLACK, linewidth=1.0, label="without noise")
    axes.plot(t, curve.noisy, color=RAW, linewidth=0.8, marker=".", markersize=3.5, label="with noise")
    label(axes, "specific force over A", "time, ms")


def figure8(found: "Reproduction") -> "Figure":
    """The nested windows on that curve, with their counts."""
    curve = found.recognition.drawn
    verdict = "in none" if curve.recognised is None else f"in window {curve.recognised}"
    words = (
        f"n = {SAMPLES}, k₁ = {RATIO:g}; counts {_listed(curve.counts)} with this noise, "
        f"{_listed(found.recognition.counts)} without; recognised {verdict}"
    )
    figure, axes = sheet("Figure 8: recognition by the multi-level time window", words, (1.0,), size=(10.0, 5.2))
    one = axes[0][0]
    _curve(one, found)
    one.axhline(curve.threshold, color=RED, linewidth=1.2, label=f"threshold {curve.threshold:g} A")
    first = 1e3 * (curve.trigger - 0.5) / RATE
    for level, count in enumerate(curve.counts, 1):
        last, total = first + 1e3 * level * SAMPLES / RATE, level * SAMPLES
        height = 2.55 - 0.16 * level
        one.plot([first, last], [height, height], color=TINTS[level - 1], linewidth=5.0, solid_capstyle="butt")
        seen = "recognised" if level == curve.recognised else "no"
        one.text(last + 0.8, height, f"window {level}: {count} of {total}, {count / total:.2f}, {seen}",
                 va="center", fontsize=SMALL)  # fmt: skip
        one.plot([last, last], [0.0, height], color=TINTS[level - 1], linewidth=0.8, linestyle="--")
    one.set_ylim(0.0, 2.55)
    legend(one)
    return figure


def _listed(counts: tuple[int, ...]) -> str:
    return ", ".join(map(str, counts))


def figure9(found: "Reproduction") -> "Figure":
    """What a sample costs, against the window."""
    study = found.complexity
    words = "a running count costs the same whatever the window; only a recount of the whole window grows with it"
    figure, axes = sheet("Figure 9: cost of a sample", words, (1.0,), size=(10.0, 4.8), right=3.0)
    one = axes[0][0]
    for name, cost in study.cost.items():
        text = f"{NAMES[name]}\n(slope {study.slopes[name]:.2f})"
        one.loglog(SIZES, cost, color=COLOURS[name], marker="o", markersize=4, linewidth=1.2, label=text)
    one.grid(which="minor", color=LIGHT, linewidth=0.3)
    one.set_ylim(bottom=0.1)
    label(one, "cost of a sample, µs", "samples in the window, n")
    legend(one)
    return figure


def figure17(found: "Reproduction") -> "Figure":
    """Both centrifuge runs: sensor, level, recognition."""
    flights = found.centrifuge.flights
    figure, axes = sheet(
        "Figure 17: centrifuge, sensor along the arm",
        "flags as printed: F1 is not recognised, 1F is recognised",
        (1.0,),
        (1.0,) * len(flights),
        size=(11.5, 4.6),
        share=False,
    )
    for one, (load, flight) in zip(axes[0], flights.items(), strict=True):
        _run(one, load, flight)
    label(axes[0][0], "specific force to the hub, g")
    legend(axes[0][-1], *axes[0])
    return figure


def _run(axes: "Axes", load: str, flight: "Flight") -> None:
    record = Record(flight)
    t, force = record.column("accelerometer", "t"), record.column("accelerometer", "fz") / STANDARD_GRAVITY
    axes.plot(t, force, color=RAW, linewidth=0.8, label="$f_z$ measured")
    for level in levels(record).values():
        axes.axhline(level, color=RED, linewidth=1.0, label=f"detector's level {level:.2f} g")
    seen = record.detected
    if seen is not None:
        axes.axvline(seen, color=BLUE, linewidth=1.2, linestyle="--", label="recognised")
    axes.set_title(f"{load}: reads {held(flight):.2f} g, {FLAGS[seen is not None]}", fontsize=SMALL + 1.0, loc="left")
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    axes.set_ylim(min(-0.4, float(np.min(force))), 1.12 * max(float(np.max(force)), 5.0))
    label(axes, x="time, s")


FIGURES: "dict[str, Callable[[Reproduction], Figure]]" = {
    "figure7": figure7,
    "figure8": figure8,
    "figure9": figure9,
    **AIRSPEED_FIGURES,
    "figure17": figure17,
}
