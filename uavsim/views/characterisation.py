"""A part on the bench: what its description promises, what a simulated record shows, what somebody's log shows.

Allan deviation, root density and histogram, a column of axes for each channel. What is promised is black, what was
simulated blue, the log red; dashed lines are the terms that make up the promise.
"""

from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.characterise import Characterisation
from sensors.noise_fit import Coefficient
from sensors.promise import Promise
from uavsim.files import write_json
from uavsim.studies.sensor_bench import Bench
from uavsim.views.figure import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SMALL,
    TEXT,
    label,
    legend,
    literal,
    save,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLOURS = {"white noise": ORANGE, "quantisation": GREY, "bias instability": GREEN, "random walk": PURPLE}
POINTS = 200  # of a promised curve
ROOM = 3.0  # factor by which an axis reaches below and above what was measured
DEPTH, HEADROOM = 1e-5, 0.3  # a histogram reaches so far below its peak, and above it by that power of as much
SIZES = {1: (9.5, 5.8), 3: (14.5, 5.4)}  # in, by number of channels


def save_bench(bench: Bench, folder: Path, *, plots: bool) -> None:
    """Write the numbers `bench.json` and the figures `allan.png`, `psd.png`, `histogram.png`.

    Parameters
    ----------
    folder
        One that is there, see `uavsim.folders`.
    plots
        Draw the figures.
    """
    write_json(folder / "bench.json", numbers(bench))
    if plots:
        for name, draw in FIGURES.items():
            save(draw(bench), folder / f"{name}.png")


# -- figures ---------------------------------------------------------------------------------------------------------


def allan(bench: Bench) -> "Figure":
    """Allan deviation with its intervals, and the promise with its terms."""
    figure, columns = _sheet(bench, f"{words(bench, literal)};  shaded: 68 % intervals")
    shown = [c.allan for c in (*bench.simulated, *bench.compared)]
    low, high = _span([a.deviation for a in shown])
    tau = np.geomspace(min(a.tau[0] for a in shown), max(a.tau[-1] for a in shown), POINTS)
    for axes, promise, measured in zip(columns, bench.promises, _pairs(bench), strict=True):
        own = np.unique(np.maximum(np.round(tau * promise.rate), 1.0)) / promise.rate  # whole readings
        for name, term in promise.terms(own).items():
            if np.any(term > low):
                axes.plot(own, term, color=COLOURS[name], linewidth=1.0, linestyle="--", label=f"promised: {name}")
        axes.plot(own, promise.deviation(own), color=BLACK, linewidth=1.4, label="promised: total", zorder=2.1)
        for what, colour, name in measured:
            a = what.allan
            axes.fill_between(a.tau, a.low, a.high, color=colour, alpha=0.2, linewidth=0.0)
            axes.plot(a.tau, a.deviation, color=colour, linewidth=0.9, marker=".", markersize=3.5, label=name)
        _logarithmic(axes, (tau[0], tau[-1]), (low, high))
        _name(axes, promise, "averaging time τ, s", f"Allan deviation σ(τ) of {promise.channel}, {promise.unit}")
    legend(columns[-1], *columns)
    return figure


def psd(bench: Bench) -> "Figure":
    """Root density, and the promised one with its white level and bandwidth."""
    figure, columns = _sheet(bench, f"{words(bench, literal)};  one-sided densities")
    shown = [c.spectrum for c in (*bench.simulated, *bench.compared)]
    low, high = _span([s.density for s in shown])
    first, last = min(s.frequency[0] for s in shown), max(s.frequency[-1] for s in shown)
    for axes, promise, measured in zip(columns, bench.promises, _pairs(bench), strict=True):
        f = np.geomspace(first, promise.rate / 2.0, POINTS)
        axes.plot(f, promise.density(f), color=BLACK, linewidth=1.4, label="promised", zorder=2.1)
        level = np.sqrt(2.0) * promise.N
        axes.axhline(level, color=ORANGE, linewidth=1.0, linestyle="--", label="promised: n = √2 N")
        if isfinite(promise.bandwidth):
            axes.axvline(promise.bandwidth, color=GREEN, linewidth=1.0, linestyle="--", label="promised: -3 dB")
        for what, colour, name in measured:
            axes.plot(what.spectrum.frequency, what.spectrum.density, color=colour, linewidth=0.9, label=name)
        _logarithmic(axes, (first, max(last, promise.rate / 2.0)), (low, high))
        _name(axes, promise, "frequency, Hz", f"root density of {promise.channel}, {_in_brackets(promise.unit)}/√Hz")
    legend(columns[-1], *columns)
    return figure


def histogram(bench: Bench) -> "Figure":
    """Distribution of the readings about their drift, and the Gaussian of the promised noise."""
    windows = [c.histogram.window for c in (*bench.simulated, *bench.compared)]
    span = " … ".join(dict.fromkeys(f"{window:.3g}" for window in (min(windows), max(windows))))
    said = f"{words(bench, literal)};  less the means over {span} s"
    figure, columns = _sheet(bench, said, right=0.4)
    for axes, promise, measured in zip(columns, bench.promises, _pairs(bench), strict=True):
        for what, colour, name in measured:
            h = what.histogram
            grid = h.resolution is not None and h.edges[1] - h.edges[0] >= 0.99 * h.resolution
            axes.stairs(h.density, h.edges, color=colour, fill=True, alpha=0.25)
            note = f"{name}, sd {h.sd:.3g} {promise.unit}" + ("\n(bins are steps)" if grid else "")
            axes.stairs(h.density, h.edges, color=colour, linewidth=0.9, label=note)
        reach = max(what.histogram.edges[-1] for what, _, _ in measured)
        if promise.noise_sd > 0.0:
            x = np.linspace(-reach, reach, POINTS)
            gauss = np.exp(-0.5 * (x / promise.noise_sd) ** 2) / (np.sqrt(2.0 * np.pi) * promise.noise_sd)
            axes.plot(x, gauss, color=BLACK, linewidth=1.2, label=f"promised, sd {promise.noise_sd:.3g} {promise.unit}")
        axes.set_xlim(-reach, reach)
        peaks = [float(what.histogram.density.max()) for what, _, _ in measured]
        axes.set_yscale("log")
        axes.set_ylim(DEPTH * min(peaks), max(peaks) / DEPTH**HEADROOM)
        _name(
            axes,
            promise,
            f"{promise.channel} less its drift, {promise.unit}",
            f"share of readings, 1/{_in_brackets(promise.unit)}",
        )
        axes.legend(loc="upper left", fontsize=SMALL, frameon=False, handlelength=1.4)
    return figure


FIGURES: dict[str, Callable[[Bench], "Figure"]] = {"allan": allan, "psd": psd, "histogram": histogram}


def title(bench: Bench) -> str:
    """Part and setting."""
    return f"{bench.description.name} on the bench: {bench.setting}"


def short(name: str, most: int = 20) -> str:
    """Return the end of a long name."""
    return name if len(name) <= most else f"…{name[1 - most :]}"


def words(bench: Bench, named: Callable[[str], str] = str) -> str:
    """What was simulated and compared; `named` makes a file's name fit for where it is shown."""
    said = f"simulated: {bench.hours:g} h, seed {bench.seed}, {bench.unit} unit"
    if bench.log is None:
        return said
    return (
        f"{said};  {named(short(bench.log.name, 24))}: {bench.log.duration / 3600.0:.3g} h at {bench.log.rate:.4g} Hz"
    )


def _sheet(bench: Bench, said: str, right: float = 1.9) -> "tuple[Figure, list[Axes]]":
    channels = len(bench.simulated)
    figure, (columns,) = sheet(
        title(bench), said, (1.0,), (1.0,) * channels, size=SIZES[channels], right=right, share=False, gap=(0.1, 0.24)
    )
    return figure, columns


def _pairs(bench: Bench) -> list[list[tuple[Characterisation, str, str]]]:
    """What was measured of each channel, with colour and name."""
    pairs = [[(channel, BLUE, "simulated")] for channel in bench.simulated]
    assert bench.log is not None or not bench.compared
    for pair, channel in zip(pairs, bench.compared, strict=False):
        pair.append((channel, RED, literal(short(bench.log.name)) if bench.log else ""))
    return pairs


def _span(values: Sequence[Array]) -> tuple[float, float]:
    """Bounds of a logarithmic axis that shows all values above zero with some room."""
    some = np.concatenate(values)
    some = some[some > 0.0]
    return (float(some.min()) / ROOM, float(some.max()) * ROOM) if some.size else (0.1, 10.0)


def _logarithmic(axes: "Axes", x: tuple[float, float], y: tuple[float, float]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*x)
    axes.set_ylim(*y)


def _in_brackets(unit: str) -> str:
    return f"({unit})" if "/" in unit else unit


def _name(axes: "Axes", promise: Promise, x: str, y: str) -> None:
    label(axes, y=y, x=x)
    axes.set_title(promise.channel, fontsize=TEXT)


# -- numbers ---------------------------------------------------------------------------------------------------------


def numbers(bench: Bench) -> dict[str, Any]:
    """Return everything that is drawn and printed as plain numbers, SI; what does not exist is None."""
    return {
        "part": bench.description.name,
        "document": bench.description.document,
        "setting": bench.setting,
        "hours": bench.hours,
        "seed": bench.seed,
        "unit": bench.unit,
        "promised": {promise.channel: _promised(promise) for promise in bench.promises},
        "simulated": {c.channel: _measured(c) for c in bench.simulated},
        "compared": _compared(bench),
    }


def _promised(promise: Promise) -> dict[str, Any]:
    names = ("unit", "rate", "resolution", "noise_sd", "N", "B", "K", "correlation_time")
    return {**{name: getattr(promise, name) for name in names}, "bandwidth": _finite(promise.bandwidth)}


def _measured(c: Characterisation) -> dict[str, Any]:
    return {
        "rate": c.rate,
        "duration": c.duration,
        "count": c.count,
        "mean": c.mean,
        "noise_sd": c.histogram.sd,
        "resolution": c.histogram.resolution,
        "fit": None if c.fit is None else {
            **{name: _coefficient(getattr(c.fit, name)) for name in ("N", "B", "K", "Q")},
            "correlation_time": c.fit.correlation_time,
            "bandwidth": _finite(c.fit.bandwidth),
        },
        "allan": {name: getattr(c.allan, name).tolist() for name in ("tau", "deviation", "low", "high", "edf")},
        "spectrum": {name: getattr(c.spectrum, name).tolist() for name in ("frequency", "density")},
    }  # fmt: skip


def _coefficient(c: Coefficient) -> dict[str, Any]:
    return {"value": c.value, "low": c.low, "high": c.high, "resolved": c.resolved}


def _compared(bench: Bench) -> dict[str, Any] | None:
    log = bench.log
    if log is None:
        return None
    channels = {c.channel: _measured(c) for c in bench.compared}
    return {"log": log.name, "rate": log.rate, "remarks": log.remarks(), "channels": channels}


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
