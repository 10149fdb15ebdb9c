"""A linearised aircraft's folder: figures in `linearise.csv`, `modes.csv` and `linearise.json`, and `linearise.png`."""

import csv
import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.files import whole, write_json
from uavsim.studies.linearise import Linearised, Point, describe
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, RED, label, legend, sheet
from uavsim.views.figure import save as save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = (BLACK, BLUE, RED, GREY, DARK)
DRAWN = (
    ("alpha", "angle of attack, °"),
    ("control", "pitch control, °"),
    ("thrust", "thrust, N"),
    ("short period", "short period, 1/s"),
    ("phugoid", "phugoid, 1/s"),
    ("Dutch roll", "Dutch roll, 1/s"),
)


def save(found: Linearised, folder: Path, *, plots: bool) -> None:
    """Write it into a folder that is there."""
    write_json(folder / "linearise.json", summary(found))
    names = next((list(p.derivatives) for p in found.points if p.derivatives), [])
    rows: list[list[object]] = [["wing", "airspeed", "alpha_deg", "control_deg", "thrust", *names, "problem"]]
    modes: list[list[object]] = [["wing", "airspeed", "mode", "real", "imaginary", "frequency_hz", "damping"]]
    for p in found.points:
        given = p.derivatives or {}
        rows.append([p.wing, p.airspeed, *_trim(p), *(given.get(name, "") for name in names), p.problem])
        modes += [
            [p.wing, p.airspeed, m.name, m.value.real, m.value.imag, abs(m.value) / (2.0 * math.pi), m.damping]
            for m in p.modes
        ]
    for name, table in (("linearise", rows), ("modes", modes)):
        with whole(folder / f"{name}.csv") as part, part.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(table)
    if plots:
        save_figure(_draw(found), folder / "linearise.png")


def summary(found: Linearised) -> dict[str, Any]:
    """Return what `linearise.json` holds."""
    points = []
    for p in found.points:
        alpha, control, thrust = _trim(p)
        points.append(
            {
                "wing": p.wing,
                "airspeed": p.airspeed,
                "problem": p.problem or None,
                "trim": None if p.problem else {"alpha_deg": alpha, "control_deg": control, "thrust": thrust},
                "derivatives": p.derivatives,
                "modes": [{"name": m.name, "real": m.value.real, "imaginary": m.value.imag} for m in p.modes],
            }
        )
    return {**{k: v for k, v in asdict(found).items() if k != "points"}, "points": points}


def lines(found: Linearised) -> list[str]:
    """What is printed: the stall, and a line for each trim and mode."""
    said = [
        f"{found.name}: {found.mass:.2f} kg, pitched by {' and '.join(found.pitch)}; "
        f"stalls at {found.stall:.1f} m/s (C_L {found.greatest_lift:.2f}, control neutral)"
    ]
    for p in found.points:
        where = f"wing {p.wing:.2f}, {p.airspeed:g} m/s: "
        if p.problem or p.derivatives is None:
            said.append(where + p.problem)
            continue
        alpha, control, thrust = _trim(p)
        d = p.derivatives
        said.append(
            f"{where}angle of attack {alpha:.2f}°, control {control:.2f}°, thrust {thrust:.2f} N, "
            f"L/D {d['lift_over_drag']:.1f}, static margin {100.0 * d['static_margin']:.1f} %"
        )
        said += [f"  {m.name:16s} {describe(m.value)}" for m in p.modes]
    return said


def _trim(p: Point) -> tuple[Any, Any, Any]:
    """Angle of attack and control, degrees, and thrust, N; nothing where there is no level flight."""
    return ("", "", "") if p.problem else (math.degrees(p.alpha), math.degrees(p.control), p.thrust)


def _draw(found: Linearised) -> Any:
    figure, axes = sheet(
        f"{found.name}: trim and modes",
        f"Level flight with the controls fixed.  Of a mode: solid is its frequency |λ|, dashed its damping -Re λ.  "
        f"Stall at {found.stall:.1f} m/s.",
        (1.0, 1.0),
        (1.0, 1.0, 1.0),
        size=(11.0, 6.6),
        share=True,
        gap=(0.15, 0.28),
    )
    for place, (what, unit) in zip((a for row in axes for a in row), DRAWN, strict=True):
        for wing, colour in zip(sorted({p.wing for p in found.points}), _colours(found), strict=True):
            _curve(place, [p for p in found.points if p.wing == wing and not p.problem], what, colour)
        label(place, unit, "airspeed, m/s" if place in axes[1] else None)
    legend(axes[0][-1], axes[0][0])
    return figure


def _colours(found: Linearised) -> list[str]:
    wings = len({p.wing for p in found.points})
    return [COLOURS[i % len(COLOURS)] for i in range(wings)]


def _curve(axes: "Axes", points: list[Point], what: str, colour: str) -> None:
    if not points:
        return
    speed = [p.airspeed for p in points]
    named = f"wing {points[0].wing:g}"
    if what in ("alpha", "control", "thrust"):
        at = ("alpha", "control", "thrust").index(what)
        axes.plot(speed, [_trim(p)[at] for p in points], color=colour, marker=".", label=named)
        return
    values = [next((m.value for m in p.modes if m.name == what), complex(np.nan, np.nan)) for p in points]
    axes.plot(speed, np.abs(values), color=colour, marker=".")
    axes.plot(speed, [-v.real for v in values], color=colour, linestyle="--")
