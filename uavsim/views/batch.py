"""Several flights: the folder they are kept in, and plots over all of them.

A folder holds ``runs.parquet`` (a row a flight), ``campaign.json`` (what was flown, with what, on what), whole flights
in ``flights/SEED/`` for those that were kept, and plots: the distribution of the detector's latency, the airspeed's
error over time, outcomes and reductions. Rows and kept flights are written as flights end, each whole: whatever ends
the process, what was finished can be read.
"""

import platform
import shutil
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim import inputs
from uavsim.consistency import mean_band
from uavsim.files import whole, write_json
from uavsim.studies.batch import ERROR_START, ERROR_STEP, Batch, Result
from uavsim.studies.batch_cramer_rao import FEWEST, against_bound, least_error
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
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uavsim.flight import Flight
    from uavsim.scenario import Scenario

Array = NDArray[np.float64]

PACKAGES = ("uavsim", "jsbsim", "numpy", "scipy", "filterpy", "pandas", "pyarrow")
FEATURES = ("avx", "fma", "sse4", "asimd", "sve")  # of the processor, that floating point may depend on
QUANTILES = (0.05, 0.50, 0.95)
ENLARGED = 2.0  # s after the true launch to which the error is enlarged
PART = 1000  # rows in a file, which is written anew with each of them
DRAWN = 8  # flights with plots of their own; `uavsim replay` draws any other
GOLDEN = 0.6180339887498949  # spreads points evenly without a random draw


class Record:
    """The folder of several flights, from the first to the last one.

    Parameters
    ----------
    folder
        One that is there, see `uavsim.folders`.
    scenario, seeds
        What is flown.
    """

    def __init__(self, folder: Path, scenario: "Scenario", seeds: list[int]) -> None:
        self._folder = folder
        self._asked = ranges(seeds)
        self._parts = -(-len(seeds) // PART)
        self._rows: dict[int, dict[int, dict[str, Any]]] = {}
        self._scenario = inputs.write(folder, scenario.to_dict())
        self._describe(Batch(scenario, _table([]), [], {}, complete=False, wall_time=0.0))

    def keep(self, results: list[tuple[int, Result]]) -> None:
        """Write finished flights: those that are kept, then the rows of all."""
        written = set()
        try:
            for position, (row, _, flight) in results:
                if flight is not None:
                    self._keep_flight(flight)
                self._rows.setdefault(position // PART, {})[position] = row
                written.add(position // PART)
        finally:
            for part in written:
                self._write_rows(part)

    def _write_rows(self, part: int) -> None:
        rows = self._rows[part]
        with whole(self._part(part)) as file:
            _table([rows[position] for position in sorted(rows)]).to_parquet(file, index=False)

    def _part(self, number: int) -> Path:
        """File of up to `PART` rows: `runs.parquet`, or one in a folder of that name, by position."""
        runs = self._folder / "runs.parquet"
        if self._parts == 1:
            return runs
        runs.mkdir(exist_ok=True)
        return runs / f"part-{number:05}.parquet"

    def _keep_flight(self, flight: "Flight") -> None:
        """A flight's folder appears in `flights/` when it is whole."""
        unfinished, flights = self._folder / ".keeping", self._folder / "flights"
        try:
            unfinished.mkdir()
            flight.write(unfinished)
            flights.mkdir(exist_ok=True)
            unfinished.rename(flights / str(flight.score["seed"]))
        except BaseException:
            shutil.rmtree(unfinished, ignore_errors=True)
            raise

    def close(self, flown: Batch, *, plots: bool) -> None:
        """Describe what was flown and draw it: plots of all flights, and of the first `DRAWN` that are kept.

        An interrupt leaves out what is not yet drawn.
        """
        self._describe(flown)
        self._describe(flown, bound=True)
        if not plots:
            return
        save_batch_plots(flown, self._folder / "plots")
        for seed, flight in list(flown.kept.items())[:DRAWN]:
            save_plots(flight, self._folder / "flights" / str(seed) / "plots")

    def _describe(self, flown: Batch, *, bound: bool = False) -> None:
        write_json(
            self._folder / "campaign.json",
            {"asked": self._asked, **campaign(flown, bound=bound), "scenario": self._scenario},
        )


def _table(rows: list[dict[str, Any]]) -> "pd.DataFrame":
    import pandas as pd

    return pd.DataFrame(rows)


def ranges(seeds: Iterable[int]) -> str:
    """Seeds as `--seeds` takes them: 1-4,9."""
    found: list[list[int]] = []
    for seed in seeds:
        if found and seed == found[-1][1] + 1:
            found[-1][1] = seed
        else:
            found.append([seed, seed])
    return ",".join(f"{first}-{last}" if last > first else f"{first}" for first, last in found)


def campaign(flown: Batch, *, bound: bool = True) -> dict[str, Any]:
    """Describe what was flown, with which software and on which processor, and how near it came to the bound.

    `wall_time` in s; `airspeed_bound` as `studies.batch_cramer_rao.against_bound` has it, empty without `bound`.
    """
    return {
        "scenario": flown.scenario.to_dict(),
        "root_seed": flown.scenario.seed,
        "seeds": [int(seed) for seed in flown.runs["seed"]] if len(flown.runs) else [],
        "complete": flown.complete,
        "versions": {**{name: _version(name) for name in PACKAGES}, "python": platform.python_version()},
        "processor": {
            "machine": platform.machine(),
            "name": platform.processor(),
            "features": processor_features(Path("/proc/cpuinfo")),
        },
        "wall_time": flown.wall_time,
        "airspeed_bound": {name: asdict(found) for name, found in against_bound(flown).items()} if bound else {},
    }


def processor_features(cpuinfo: Path) -> list[str]:
    """Features of the first processor that floating point may depend on; none where the system does not tell."""
    if not cpuinfo.is_file():
        return []
    for line in cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines():
        name, _, flags = line.partition(":")
        if name.strip() in {"flags", "Features"}:
            return sorted({flag for flag in flags.split() if flag.startswith(FEATURES)})
    return []


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


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
    if drawn & {r.key for r in flown.scenario.requirements if r.of_each_flight}:
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
    bounds = {r.key: (r.minimum, r.maximum) for r in flown.scenario.requirements if r.of_each_flight}
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
