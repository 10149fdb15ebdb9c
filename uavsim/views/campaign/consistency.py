"""Whether the filter knows its own error, and how near it comes to the least: mean NEES and RMSE over the flights."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.consistency import mean_band
from uavsim.studies.batch import ERROR_START, ERROR_STEP
from uavsim.studies.batch_cramer_rao import ENOUGH, FEWEST, Least
from uavsim.studies.campaign.envelopes import mean_square_band
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.errors import ENLARGED, far_traces, far_words
from uavsim.views.campaign.quantities import Array
from uavsim.views.campaign.words import remark, title
from uavsim.views.faults import set_faults
from uavsim.views.figure import BLUE, GREY, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw(flown: Many) -> "Figure | None":
    """Draw NEES averaged over the flights against its band, and the RMSE over them against the bound.

    Flights that diverged, or whose errors are beyond any scale, would decide the means alone; they are left out, named.
    """
    time, nees, filtered, far = flown.error_time, flown.matrix("nees"), flown.matrix("filtered"), None
    if not nees.size:
        return None
    far = far_traces(flown, time, filtered) | ~flown.sound[: len(filtered)]
    if far.all():
        far = np.zeros(far.size, dtype=bool)
    nees, filtered = nees[~far], filtered[~far]
    with np.errstate(over="ignore"):
        squares = np.where(np.isfinite(filtered), filtered, np.nan) ** 2
    nees = np.where(np.isfinite(nees), nees, np.nan)
    counts = np.isfinite(nees).sum(axis=0)
    there = (counts >= FEWEST) & (time > ERROR_START + ERROR_STEP) & (np.isfinite(squares).sum(axis=0) >= 1)
    if not there.any():
        return None
    time, nees, squares = time[there], nees[:, there], squares[:, there]
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    figure, axes = sheet(title(flown), _words(nees, flown.least), (1.2, 1.0), columns, size=(12.5, 6.8), right=2.15)
    for i, (upper, lower) in enumerate(zip(*axes, strict=True)):
        _nees(upper, time, nees)
        _error(lower, time, squares, flown)
        upper.set_xlim(time[0], ENLARGED if i else time[-1])
    label(axes[0][0], "mean NEES")
    label(axes[1][0], "airspeed error, m/s")
    for row in axes:
        legend(row[-1], row[0])
    make_room(figure, 0)
    remark(figure, [far_words(flown, far, left_out=True)])
    return figure


def _nees(axes: "Axes", time: Array, nees: Array) -> None:
    bands = _bands(nees)
    means = np.nanmean(nees, axis=0)
    axes.fill_between(time, *bands, color=GREY, alpha=0.35, linewidth=0.0, label="95 % of such means")
    axes.plot(time, means, color=BLUE, linewidth=1.3, label="mean NEES")
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    positive = means[means > 0.0]
    if positive.size:
        ends = np.quantile(positive, (0.01, 0.99))
        low, high = min(ends[0], np.median(bands[0])), max(ends[1], np.median(bands[1]))
        axes.set_ylim(0.7 * max(low, 1e-3), 1.4 * high)


def _error(axes: "Axes", time: Array, squares: Array, flown: Many) -> None:
    rmse = np.sqrt(np.nanmean(squares, axis=0))
    if len(squares) >= ENOUGH:
        low, high = mean_square_band(squares)
        axes.fill_between(time, low, high, color=BLUE, alpha=0.25, linewidth=0.0, label="95 % (bootstrap, flights)")
    axes.plot(time, rmse, color=BLUE, linewidth=1.2, label="RMSE over the flights")
    least = flown.least
    sizes = [rmse]
    if least is not None:
        words = "√PCRB, no fault" if set_faults(flown.scenario) else "bound, √PCRB"
        axes.fill_between(
            least.time, least.low, least.high, color=RED, alpha=0.25, linewidth=0.0, label="95 % (bootstrap, courses)"
        )
        axes.plot(least.time, least.sd, color=RED, linewidth=1.1, linestyle="--", label=words)
        sizes.append(least.sd)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter("")
    every = np.concatenate(sizes)
    every = every[np.isfinite(every) & (every > 0.0)]
    if every.size:
        axes.set_ylim(0.7 * every.min(), 1.4 * every.max())
    axes.set_xlabel("time since true launch, s", fontsize=SMALL + 1.0)


def _bands(nees: Array) -> Array:
    counts = np.isfinite(nees).sum(axis=0)
    known = {int(count): mean_band(int(count)) for count in np.unique(counts)}
    return np.array([known[int(count)] for count in counts]).T


def inside(nees: Array) -> tuple[float, float]:
    """Return the mean of NEES, and the share of times at which the mean over the flights is in its band."""
    means = np.nanmean(nees, axis=0)
    low, high = _bands(nees)
    return float(np.nanmean(means)), float(np.mean((means >= low) & (means <= high)))


def _words(nees: Array, least: Least | None) -> str:
    mean, share = inside(nees)
    words = f"(error/sd claimed)² over the flights: mean {mean:.2f}, in its band at {100 * share:.0f} % of times"
    if least is None:
        return words
    return f"{words}; below: against the least that readings allow in the mean of many flights ({least.courses} courses)"
