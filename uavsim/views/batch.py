"""Several flights: plots over all of them.

The distribution of the detector's latency, the airspeed's error over time, outcomes and reductions; the folder itself
is `uavsim.studies.campaign.record`'s.
"""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.consistency import mean_band
from uavsim.studies.batch import Batch
from uavsim.studies.batch_cramer_rao import FEWEST, against_bound, least_error
from uavsim.studies.campaign.campaign import Flights
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP
from uavsim.studies.campaign.record import FLIGHTS, Record
from uavsim.studies.quantiles import ecdf_band, quantile_band
from uavsim.views.faults import set_faults
from uavsim.views.figure import (
    BLACK,
    BLUE,
    GREY,
    PHASES,
    RAW,
    RED,
    SMALL,
    dress,
    label,
    legend,
    make_room,
    sheet,
)
from uavsim.views.figure import save as save_figure
from uavsim.views.plots import save_plots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

QUANTILES = (0.05, 0.50, 0.95)
ENLARGED = 2.0  # s after the true launch to which the error is enlarged
DRAWN = 8  # flights with plots of their own; `uavsim replay` draws any other
GOLDEN = 0.6180339887498949  # spreads points evenly without a random draw


def close(record: Record, flights: Flights, flown: Batch, *, plots: bool) -> None:
    """Say in the record how near the flights came to the bound, and draw: all, and the first `DRAWN` that are kept.

    An interrupt leaves out what is not yet drawn.
    """
    record.describe(
        complete=flights.complete,
        wall_time=flights.wall_time,
        left=flights.left,
        more={"airspeed_bound": bound_of(flown)},
    )
    if not plots or not len(flown.runs):
        return
    save_batch_plots(flown, flights.folder / "plots")
    for index in flights.kept()[:DRAWN]:
        save_plots(flights.flight(index), flights.folder / FLIGHTS / str(index) / "plots")


def bound_of(flown: Batch) -> dict[str, Any]:
    """How near several flights came to the bound, as `studies.batch_cramer_rao.against_bound` has it."""
    return {name: asdict(found) for name, found in against_bound(flown).items()}


# -- plots -----------------------------------------------------------------------------------------------------------


def save_batch_plots(flown: Batch, folder: Path) -> list[Path]:
    """Draw several flights.

    Returns
    -------
    list of Path
        Those of `latency.png`, `airspeed_error.png`, `consistency.png` and `outcomes.png` for which there are data.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in (
        ("latency", _latency),
        ("airspeed_error", _airspeed_error),
        ("consistency", _consistency),
        ("outcomes", _outcomes),
    ):
        figure = draw(flown)
        if figure is not None:
            written.append(save_figure(figure, folder / f"{name}.png"))
    return written


def _title(flown: Batch) -> str:
    seeds = flown.runs["seed"]
    partly = "" if flown.complete else " (interrupted)"
    which = f"flights, seeds {seeds.min()} to {seeds.max()}" if len(seeds) > 1 else f"flight, seed {seeds.min()}"
    return f"{flown.scenario.name}, {len(seeds)} {which}{partly}"


def _latency(flown: Batch) -> "Figure | None":
    """Empirical distribution of the detector's latency."""
    kinds = [
        (name, latencies)
        for name, column in (("true launch", "true_time"), ("crossing of 4.5 g", "crossing_time"))
        if np.isfinite(latencies := latencies_since(flown, column)).any()
    ]
    if not kinds:
        return None
    words = "share of flights whose launch was detected within the time given; those that missed it count"
    figure, axes = sheet(
        _title(flown), words, (1.0,) * len(kinds), size=(10.5, 1.4 + 2.9 * len(kinds)), right=3.0, gap=(0.22, 0.0)
    )
    every = np.concatenate([latencies for _, latencies in kinds])
    every = every[np.isfinite(every)]
    margin = 0.08 * float(np.ptp(every)) or 1.0
    for (one,), (name, latencies) in zip(axes, kinds, strict=True):
        one.set_xlim(every.min() - margin, every.max() + margin)
        one.set_ylim(-0.02, 1.04)
        _distribution(one, latencies, "ms")
        label(one, "share of flights")
        one.set_title(f"since {name}", loc="left", fontsize=SMALL + 1.0)
        legend(one)
    axes[-1][0].set_xlabel("latency, ms", fontsize=SMALL + 1.0)
    make_room(figure, 1)
    return figure


def latencies_since(flown: Batch, column: str) -> Array:
    """Latencies, ms, from `launch.<column>` of the flights that have it; inf for those never detected."""
    if f"launch.{column}" not in flown.runs:
        return np.empty(0)
    start = flown.runs[f"launch.{column}"].to_numpy(float)
    detected = flown.runs["launch.detected_time"].to_numpy(float)
    latencies: Array = 1e3 * np.where(np.isfinite(detected), detected - start, np.inf)
    had: Array = latencies[np.isfinite(start)]
    return had


def _distribution(axes: "Axes", sample: Array, unit: str) -> None:
    """Draw an empirical distribution function with its band and some quantiles with theirs."""
    band = ecdf_band(sample)
    left, right = axes.get_xlim()
    x = np.append(np.maximum(band.value, left), right)
    share, low, high = (np.append(y, y[-1]) for y in (band.share, band.low, band.high))
    words = "95 % pointwise (Clopper–Pearson)"
    axes.fill_between(x, low, high, step="post", color=BLUE, alpha=0.2, linewidth=0.0, label=words)
    axes.step(x, share, where="post", color=BLUE, linewidth=1.4, label=f"{sample.size} flight{'s' * (sample.size > 1)}")
    finite = sample[np.isfinite(sample)]
    if finite.size < sample.size:
        axes.axhline(share[-1], color=GREY, linewidth=0.8, label=f"{sample.size - finite.size} never detected")
    for q in QUANTILES:
        quantile = quantile_band(finite, q)
        ends = (_or(quantile.low, left), _or(quantile.high, right))
        height = q * finite.size / sample.size
        axes.plot(ends, (height, height), color=RED, linewidth=1.2)
        bounds = ", ".join("–" if end is None else f"{end:.1f}" for end in (quantile.low, quantile.high))
        words = f"{100 * q:g} %: {quantile.value:.1f} [{bounds}] {unit}"
        axes.plot(quantile.value, height, "o", color=RED, markersize=4.5, label=words)


def _or(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value


# -- error over time -------------------------------------------------------------------------------------------------


def _airspeed_error(flown: Batch) -> "Figure | None":
    """Envelope of the airspeed's error over the flights, raw and filtered."""
    time = flown.error_time
    raw, filtered = (_matrix(flown, kind, time.size) for kind in ("raw", "filtered"))
    air = flown.scenario.air_data
    there = np.isfinite(raw + filtered).sum(axis=0) * 2 >= max(len(flown.traces), 1)
    if air.tare == "covered":
        there &= time > -air.cover_off  # before that the head does not feel the wind
    if not there.any():
        return None
    time, raw, filtered = time[there], raw[:, there], filtered[:, there]
    words = f"rms in bins of {ERROR_STEP:g} s, as long as half of the flights last; below: filtered over raw"
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    figure, axes = sheet(_title(flown), words, (1.5, 1.0), columns, size=(11.5, 6.5))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(raw > 0.0, filtered / raw, np.nan)
    for i, (speed, share) in enumerate(zip(*axes, strict=True)):
        _envelope(speed, time, raw, RAW, "raw")
        _envelope(speed, time, filtered, BLUE, "filtered")
        _envelope(share, time, ratio, BLACK, "filtered / raw", worst=False)
        share.axhline(1.0, color=RED, linewidth=0.9, linestyle="--", label="no help")
        speed.set_xlim(time[0], ENLARGED if i else time[-1])
        _error_axes(speed, share, time, filtered, raw)
    label(axes[0][0], "airspeed error, m/s")
    label(axes[1][0], "filtered / raw", "time since true launch, s")
    for row in axes:
        legend(row[-1], row[0])
    make_room(figure, 0)
    return figure


def _matrix(flown: Batch, kind: str, bins: int) -> Array:
    """Errors of all flights, shape (flights, bins); NaN after a flight's end."""
    errors = np.full((len(flown.traces), bins), np.nan)
    for row, trace in zip(errors, flown.traces, strict=True):
        values = getattr(trace, kind)[:bins]
        row[: values.size] = values
    return errors


def _envelope(axes: "Axes", time: Array, values: Array, colour: str, name: str, *, worst: bool = True) -> None:
    """Draw the median over the flights, the range of most, and the worst."""
    there = np.isfinite(values).any(axis=0)
    time, values = time[there], values[:, there]
    low, middle, high = np.nanquantile(values, QUANTILES, axis=0)
    axes.fill_between(time, low, high, color=colour, alpha=0.25, linewidth=0.0, label=f"{name}, 5 to 95 %")
    axes.plot(time, middle, color=colour, linewidth=1.4, label=f"{name}, median")
    if worst:
        greatest = np.nanmax(values, axis=0)
        axes.plot(time, greatest, color=colour, linewidth=0.9, linestyle=":", label=f"{name}, worst")


def _error_axes(speed: "Axes", share: "Axes", time: Array, *errors: Array) -> None:
    """Scale the axes of an error and of a ratio of errors; the exact zeros of still air widen neither."""
    from matplotlib.ticker import LogLocator

    positive = np.concatenate([e[np.isfinite(e) & (e > 0.0)] for e in errors])
    speed.set_yscale("log", subs=())
    speed.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    flown = np.concatenate([e[:, time > 0.0].ravel() for e in errors])
    flown = flown[np.isfinite(flown) & (flown > 0.0)]
    speed.set_ylim(0.6 * float(np.quantile(flown if flown.size else positive, 0.002)), 1.3 * float(positive.max()))
    speed.yaxis.set_major_formatter("{x:g}")
    share.set_ylim(bottom=0.0)
    share.set_xlabel("time since true launch, s", fontsize=SMALL + 1.0)
    for axes in (speed, share):
        axes.axvline(0.0, color=GREY, linewidth=0.9, linestyle="--")


# -- consistency and bound -------------------------------------------------------------------------------------------


def _consistency(flown: Batch) -> "Figure | None":
    """NEES averaged over the flights against its band, and the RMSE over the flights against the bound."""
    time = flown.error_time
    nees = _matrix(flown, "nees", time.size)
    counts = np.isfinite(nees).sum(axis=0)
    there = (counts >= FEWEST) & (time > ERROR_START + ERROR_STEP)
    if not there.any():
        return None
    least = least_error(flown)
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    figure, axes = sheet(
        _title(flown), _consistency_words(nees[:, there], least), (1.2, 1.0), columns, size=(11.5, 6.5)
    )
    filtered = np.sqrt(
        np.nanmean(np.where(there, _matrix(flown, "filtered", time.size), np.nan)[:, there] ** 2, axis=0)
    )
    bands = np.array([mean_band(int(count)) for count in counts[there]]).T
    for i, (upper, lower) in enumerate(zip(*axes, strict=True)):
        words = "95 % of such means"
        upper.fill_between(time[there], *bands, color=GREY, alpha=0.35, linewidth=0.0, label=words)
        upper.plot(time[there], np.nanmean(nees[:, there], axis=0), color=BLUE, linewidth=1.3, label="mean NEES")
        upper.axhline(1.0, color=GREY, linewidth=0.8)
        upper.set_yscale("log")
        upper.yaxis.set_major_formatter("{x:g}")
        lower.plot(time[there], filtered, color=BLUE, linewidth=1.3, label="RMSE over the flights")
        if least is not None:
            words = "√PCRB, no fault" if set_faults(flown.scenario) else "bound, √PCRB"
            lower.plot(*least, color=RED, linewidth=1.1, linestyle="--", label=words)
        lower.set_yscale("log")
        lower.yaxis.set_major_formatter("{x:g}")
        lower.set_xlabel("time since true launch, s", fontsize=SMALL + 1.0)
        upper.set_xlim(time[there][0], ENLARGED if i else time[there][-1])
    label(axes[0][0], "NEES")
    label(axes[1][0], "airspeed error, m/s")
    for row in axes:
        legend(row[-1], row[0])
    make_room(figure, 0)
    return figure


def _consistency_words(nees: Array, least: "tuple[Array, Array] | None") -> str:
    means = np.nanmean(nees, axis=0)
    bands = np.array([mean_band(int(count)) for count in np.isfinite(nees).sum(axis=0)]).T
    inside = np.mean((means >= bands[0]) & (means <= bands[1]))
    words = (
        f"(error/sd claimed)² over the flights: mean {means.mean():.2f}, in its band at {100 * inside:.0f} % of times"
    )
    return words + (
        "" if least is None else "; below: against the least that readings allow in the mean of many flights"
    )


# -- outcomes --------------------------------------------------------------------------------------------------------


def _outcomes(flown: Batch) -> "Figure":
    """How the flights ended, how much the filter helped in each phase, and whether it knows how well."""
    strips = (
        ("reduction_percent", "reduction of the airspeed's RMSE, %", 0.0),
        ("coverage_95", "share within ±1.96 sd", 0.95),
    )
    expected = flown.scenario.expect
    drawn = {column for key, _, _ in strips for _, column, _ in _samples(flown, key)}
    words = f"expected: {expected}; a point is a flight; cross: median and its 95 % band"
    if drawn & {r.key for r in flown.scenario.requirements}:
        words += "; red: the scenario's bounds"
    figure, axes = sheet(
        _title(flown), words, (1.0,), (0.8, 1.2, 1.2), size=(11.5, 4.6), right=0.3, share=False, gap=(0.1, 0.32)
    )
    counts = flown.runs["outcome"].value_counts().sort_index()
    first, *others = axes[0]
    colours = [BLUE if name == expected else RED for name in counts.index]
    bars = first.bar(range(len(counts)), counts.to_numpy(), color=colours, width=0.6)
    first.bar_label(bars, fontsize=SMALL)
    first.set_xticks(range(len(counts)), [str(name).replace("_", "\n") for name in counts.index])
    first.set_xlim(-0.7, len(counts) - 0.3)
    first.set_ylim(0.0, 1.1 * float(counts.max()))
    first.locator_params(axis="y", integer=True)
    first.grid(visible=False, axis="x")
    label(first, "flights")
    for one, (key, name, neutral) in zip(others, strips, strict=True):
        one.axhline(neutral, color=GREY, linewidth=1.0, linestyle=":")
        _strips(one, flown, key)
        label(one, name)
    make_room(figure, 0)
    return figure


def _strips(axes: "Axes", flown: Batch, key: str) -> None:
    """Draw a column of points for all phases together and one for each."""
    bounds = {r.key: (r.minimum, r.maximum) for r in flown.scenario.requirements}
    for i, (name, column, sample) in enumerate(_samples(flown, key)):
        colour = PHASES.get(name, GREY)
        x = i + 0.5 * (np.arange(sample.size) * GOLDEN % 1.0 - 0.5)
        axes.plot(x, sample, ".", color=colour, markersize=4, alpha=0.8)
        if sample.size:
            band = quantile_band(sample, 0.5)
            axes.plot((i - 0.3, i + 0.3), (band.value, band.value), color=BLACK, linewidth=1.6)
            if band.low is not None and band.high is not None:
                axes.plot((i, i), (band.low, band.high), color=BLACK, linewidth=1.6)
        for limit in bounds.get(column, ()):
            if limit is not None:
                axes.plot((i - 0.4, i + 0.4), (limit, limit), color=RED, linewidth=1.2, linestyle="--")
    axes.set_xticks(range(1 + len(PHASES)), ["all", *PHASES])
    axes.set_xlim(-0.6, len(PHASES) + 0.6)
    dress(axes)
    axes.grid(visible=False, axis="x")


def _samples(flown: Batch, key: str) -> Iterator[tuple[str, str, Array]]:
    for name, column in (("all", f"airspeed.{key}"), *((phase, f"airspeed.{phase}.{key}") for phase in PHASES)):
        values = flown.runs[column].to_numpy(float) if column in flown.runs else np.empty(0)
        yield name, column, values[np.isfinite(values)]
