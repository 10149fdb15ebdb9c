"""How late launches are detected: the empirical distribution over the flights, with its band."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.far import reach
from uavsim.studies.campaign.many import Many
from uavsim.studies.quantiles import ecdf_band
from uavsim.views.campaign.quantities import band, number
from uavsim.views.campaign.words import flights, floor_of, limit_lines, not_to_scale, remark, title
from uavsim.views.figure import BLUE, GREY, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

KINDS = (("true launch", "true_time", "latency"), ("crossing of 4.5 g", "crossing_time", "latency_from_crossing"))
QUANTILES = (0.05, 0.50, 0.95)
STEPS = 1500  # of a distribution function: more do not show


def draw(flown: Many) -> "Figure | None":
    """Draw the distribution of latencies; None if no launch was detected."""
    kinds = [
        (name, key, latencies)
        for name, column, key in KINDS
        if np.isfinite(latencies := latencies_since(flown, column)).any()
    ]
    if not kinds:
        return None
    words = "share of flights whose launch was detected within the time given; those that missed it count"
    size = (10.5, 1.6 + 2.9 * len(kinds))
    figure, axes = sheet(title(flown), words, (1.0,) * len(kinds), size=size, right=3.0, gap=(0.22, 0.0))
    reaches = [reach(latencies, flown.sound) for _, _, latencies in kinds]
    ends = np.array([(found.low, found.high) for found in reaches])
    ends = ends[np.isfinite(ends).all(axis=1)]
    if not ends.size:
        return None
    margin = floor_of(ends)
    beyond: dict[int, float] = {}
    for (one,), (name, key, latencies), found in zip(axes, kinds, reaches, strict=True):
        one.set_xlim(ends.min() - margin, ends.max() + margin)
        one.set_ylim(-0.02, 1.04)
        _distribution(one, latencies[~np.isnan(latencies)], found.high)
        limit_lines(one, flown, f"launch.{key}", 1e3, upright=True)
        label(one, "share of flights")
        one.set_title(f"since {name}", loc="left", fontsize=SMALL + 1.0)
        legend(one)
        for row in np.flatnonzero(found.beyond & np.isfinite(latencies)):
            beyond.setdefault(int(row), float(latencies[row]))
    axes[-1][0].set_xlabel("latency, ms", fontsize=SMALL + 1.0)
    make_room(figure, 1)
    if beyond:
        values = np.full(len(flown), np.nan)
        values[list(beyond)] = list(beyond.values())
        remark(figure, [f"beyond the scale: {not_to_scale(flown, sorted(beyond), values, 'ms', 1)}"])
    return figure


def latencies_since(flown: Many, column: str) -> Array:
    """Latencies, ms, from `launch.<column>`, a row each; NaN without such a time, inf for those never detected."""
    start, detected = flown.column(f"launch.{column}"), flown.column("launch.detected_time")
    with np.errstate(invalid="ignore", over="ignore"):
        latencies = 1e3 * np.where(np.isfinite(detected), detected - start, np.inf)
    return np.where(np.isfinite(start), latencies, np.nan)


def _distribution(axes: "Axes", sample: Array, greatest: float) -> None:
    """Draw an empirical distribution function with its band, and some quantiles with theirs."""
    found = ecdf_band(sample)
    left, right = axes.get_xlim()
    few = np.unique(np.linspace(0, found.value.size - 1, min(found.value.size, STEPS)).round().astype(int))
    value, *curves = (y[few] for y in (found.value, found.share, found.low, found.high))
    x = np.append(np.clip(value, left, right), right)
    share, low, high = (np.append(y, y[-1]) for y in curves)
    words = "95 % pointwise (Clopper–Pearson)"
    axes.fill_between(x, low, high, step="post", color=BLUE, alpha=0.2, linewidth=0.0, label=words)
    axes.step(x, share, where="post", color=BLUE, linewidth=1.4, label=flights(sample.size))
    finite = sample[np.isfinite(sample)]
    if finite.size < sample.size:
        words = f"{sample.size - finite.size} never detected"
        axes.axhline(found.share[-1], color=GREY, linewidth=0.8, label=words)
    for q in QUANTILES:
        quantile = band(finite, q)
        height = q * finite.size / sample.size
        ends = [end if end is not None else other for end, other in ((quantile.low, left), (quantile.high, right))]
        axes.plot(ends, (height, height), color=RED, linewidth=1.2)
        bounds = ", ".join("–" if end is None else number(end, 1) for end in (quantile.low, quantile.high))
        words = f"{100 * q:g} %: {number(quantile.value, 1)} [{bounds}] ms"
        if finite.size < sample.size:
            words += ", if detected"
        there = min(quantile.value, right)
        axes.plot(there, height, "o", color=RED, markersize=4.5, label=words, clip_on=quantile.value <= greatest)
