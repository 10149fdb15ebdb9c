"""The paper's figures on airspeed, 12 and 19 to 21, and what its pipes do, drawn from what was reproduced."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.scenario import scenario_of
from uavsim.studies.paper import air_data, pipe
from uavsim.studies.paper.tunnel import BEST, STATIC_ERROR
from uavsim.views.curves import dots, fit, thin, truth
from uavsim.views.figure import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, SMALL, label, legend, sheet
from uavsim.views.record import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from uavsim.flight import Flight
    from uavsim.studies.paper import Reproduction

Array = NDArray[np.float64]

NAMES = {"paper": "paper's filter", BEST: "jump-adaptive filter"}
COLOURS = {"paper": GREEN, BEST: BLUE}
ENLARGED = (1.0, 4.0)  # s before and after the step that is drawn large
STEP_SHOWN = 4  # the level at whose beginning that is


def figure12(found: "Reproduction") -> "Figure":
    """Both pressures of table 5 over the Mach number, beside the free stream's, and the Mach numbers that they give."""
    study = found.air_data
    words = "the head's own flow field lowers both pressures; the printed Mach numbers need a = 333 to 336 m/s"
    figure, axes = sheet(
        "Figure 12 and table 5: pressures and Mach numbers of four conditions", words, (1.0,), (1.0, 1.0),
        size=(12.5, 5.2), right=2.7, share=False, gap=(0.12, 0.24),
    )  # fmt: skip
    left, right = axes[0]
    mach, free = np.linspace(0.0, 0.95, 96), air_data.FREE_STREAM
    isentropic = airdata.total_pressure(static=np.full_like(mach, free), mach=mach)
    left.plot(mach, 1e-3 * isentropic, color=BLACK, label="$p_t$ isentropic")
    left.axhline(1e-3 * free, color=GREY, linewidth=1.0, label="$p_s$ free stream")
    left.plot(air_data.SET, 1e-3 * np.array(air_data.TOTAL), "o", color=RED, label="$p_t$ printed")
    left.plot(air_data.SET, 1e-3 * np.array(air_data.STATIC), "s", color=ORANGE, label="$p_s$ printed")
    suction = float(np.mean(study.static_coefficient))
    drop = free * (1.0 + suction * 0.5 * airdata.GAMMA * mach**2)
    left.plot(mach, 1e-3 * drop, color=ORANGE, linewidth=1.0, linestyle="--", label=f"$p_s$ at $C_p$ = {suction:.2f}")
    label(left, "pressure, kPa", "Mach number of the stream")
    for name, values, colour, mark in (
        ("printed", np.array(air_data.PRINTED), RED, "o"),
        (f"paper's relation, a = {air_data.PAPER_SOUND:g} m/s", study.paper, GREY, "x"),
        ("the same, a at its temperature", study.local, SKY, "^"),
        ("compressible", study.compressible, BLUE, "s"),
    ):
        right.plot(air_data.SET, air_data.errors(values), marker=mark, color=colour, linewidth=1.0, label=name)
    right.axhline(0.0, color=BLACK, linewidth=0.8)
    label(right, "error of the Mach number, %", "Mach number of the stream")
    for one in (left, right):
        one.margins(x=0.03)
    legend(right, left)
    return figure


def figure19(found: "Reproduction") -> "Figure":
    """What the head reads in the tunnel: both pressures and the temperature."""
    study = found.tunnel
    words = (
        f"steps of 5 m/s, 10 s each, printed noise; right: a static port at $C_p$ = {STATIC_ERROR:g}, the mean of "
        "table 5, falls as the printed one does"
    )
    figure, axes = sheet(
        "Figure 19: pressures and temperature in the wind tunnel", words, (1.0, 1.0, 0.7), (1.0, 1.0), gap=(0.12, 0.2)
    )
    for column, flight in enumerate((study.flights["paper"], study.suction)):
        record = Record(flight)
        t = record.column("air_data", "t")
        for row, (name, unit) in enumerate((("p_total", "Pa"), ("p_static", "Pa"), ("temperature", "K"))):
            one = axes[row][column]
            zero = record.column("truth", name)[0] if unit == "Pa" else 0.0
            dots(one, t, record.column("air_data", name) - zero, "as read")
            truth(one, record.column("truth", "t"), record.column("truth", name) - zero)
            one.margins(y=0.1)
        label(axes[-1][column], x="time, s")
    label(axes[0][0], "$p_t$ over that at rest, Pa")
    label(axes[1][0], "$p_s$ over that at rest, Pa")
    label(axes[2][0], "temperature, K")
    axes[0][0].set_title("static port without error", fontsize=SMALL + 1.0, loc="left")
    axes[0][1].set_title("static port in suction", fontsize=SMALL + 1.0, loc="left")
    legend(axes[0][1])
    return figure


def figure20(found: "Reproduction") -> "Figure":
    """Both pressures before and after filtering."""
    flights = found.tunnel.flights
    begin, end = _step(flights["paper"])
    words = "right: around one step; the paper's gains, 0.80 and 0.76, hardly filter; the other averages between steps"
    figure, axes = sheet(
        "Figure 20: pressures before and after filtering", words, (1.0, 1.0), (1.4, 1.0), gap=(0.12, 0.2)
    )
    for row, name in enumerate(("p_total", "p_static")):
        for column, (first, last) in enumerate(((0.0, np.inf), (begin, end))):
            one = axes[row][column]
            zero = float(flights["paper"].truth[name].iloc[0])
            dots(one, *_within(flights["paper"], "air_data", name, first, last, zero), "as read")
            for kind, flight in flights.items():
                t, value = _within(flight, "estimate", name, first, last, zero)
                one.plot(*thin(t, value), color=COLOURS[kind], linewidth=0.9, label=NAMES[kind])
            truth(one, *_within(flights["paper"], "truth", name, first, last, zero))
        label(axes[row][0], f"${name[0]}_{name[2]}$ over that at rest, Pa")
    for one in axes[-1]:
        label(one, x="time, s")
    legend(axes[0][1])
    return figure


def figure21(found: "Reproduction") -> "Figure":
    """Airspeed: measured, filtered, true."""
    study = found.tunnel
    flights = study.flights
    begin, end = _step(flights["paper"])
    each = ", ".join(
        f"{NAMES[kind]} {100.0 * (1.0 - v['filtered'] / v['original']):.1f} %" for kind, v in study.airspeed.items()
    )
    words = f"reduction of the error: {each}; printed 26.42 %"
    figure, axes = sheet("Figure 21: airspeed in the wind tunnel", words, (1.3, 1.0), (1.4, 1.0), gap=(0.12, 0.2))
    for column, (first, last) in enumerate(((0.0, np.inf), (begin, end))):
        top, bottom = axes[0][column], axes[1][column]
        raw = _within(flights["paper"], "estimate", "airspeed_raw", first, last)
        dots(top, *raw, "from the readings")
        errors = [(raw[0], raw[1] - _true(flights["paper"], raw[0]))]
        dots(bottom, *errors[0])
        for kind, flight in flights.items():
            t, value = _within(flight, "estimate", "airspeed", first, last)
            top.plot(*thin(t, value), color=COLOURS[kind], linewidth=0.9, label=NAMES[kind])
            errors.append((t, value - _true(flight, t)))
            bottom.plot(*thin(*errors[-1]), color=COLOURS[kind], linewidth=0.9)
        truth(top, *_within(flights["paper"], "truth", "airspeed", first, last))
        bottom.axhline(0.0, color=BLACK, linewidth=0.8)
        fit(bottom, errors, first, "m/s")
        label(bottom, x="time, s")
    label(axes[0][0], "airspeed, m/s")
    label(axes[1][0], "error, m/s")
    legend(axes[0][1])
    return figure


def pipes(found: "Reproduction") -> "Figure":
    """What 5 cm of pipe do: to a step, and at an angle."""
    study = found.pipe
    words = (
        f"5 cm of pipe; under 10 g its air adds {study.weight:.1f} Pa, "
        f"{study.weight / (pipe.DENSITY * pipe.SPEED):.2f} m/s at {pipe.SPEED:g} m/s; without a pipe there is neither"
    )
    figure, axes = sheet(
        "Figures 4 to 6: pressure sensor with and without pipe", words, (1.0,), (1.0, 1.0), size=(12.5, 4.8),
        right=2.7, share=False, gap=(0.12, 0.2),
    )  # fmt: skip
    left, right = axes[0]
    t = 1e3 * study.time
    left.plot(t, np.where(study.time >= 1e-3, pipe.SIZE, 0.0), color=BLACK, linewidth=1.0, label="without pipe")
    for tube, colour in zip(study.tubes, (RED, ORANGE, BLUE), strict=True):
        text = f"⌀ {1e3 * tube.diameter:g} mm: lag {1e3 * tube.lag:.2f} ms"
        left.plot(t, tube.response, color=colour, linewidth=1.0, label=text)
    label(left, f"answer to a step of {pipe.SIZE:g} Pa, Pa", "time, ms")
    for (name, share), colour in zip(study.angles.items(), (PURPLE, SKY, GREEN), strict=True):
        loss = 100.0 * (1.0 - share)
        right.plot(np.degrees(pipe.ANGLES), loss, color=colour, linewidth=1.2, label=f"{name} mouth")
    right.axhline(1.0, color=GREY, linewidth=0.8, linestyle=":", label="1 %")
    right.set_ylim(0.0, 10.0)
    label(right, "impact pressure lost, %", "angle to the stream, degrees")
    legend(right, left)
    return figure


def _step(flight: "Flight") -> tuple[float, float]:
    """First and last time around the step that is drawn large, s."""
    tunnel = scenario_of(flight).plant.wind_tunnel
    at = flight.score["launch"]["release_time"] + STEP_SHOWN * (tunnel.ramp + tunnel.hold)
    return at - ENLARGED[0], at + ENLARGED[1]


def _within(
    flight: "Flight", table: str, name: str, first: float, last: float, zero: float = 0.0
) -> tuple[Array, Array]:
    """Time and a column over `zero` from a first to a last time."""
    record = Record(flight)
    t, value = record.column(table, "t"), record.column(table, name)
    rows = (t >= first) & (t <= last)
    return t[rows], value[rows] - zero


def _true(flight: "Flight", t: Array) -> Array:
    record = Record(flight)
    return np.interp(t, record.column("truth", "t"), record.column("truth", "airspeed"))


AIRSPEED_FIGURES: "dict[str, Callable[[Reproduction], Figure]]" = {
    "figure12": figure12,
    "figure19": figure19,
    "figure20": figure20,
    "figure21": figure21,
    "pipes": pipes,
}
