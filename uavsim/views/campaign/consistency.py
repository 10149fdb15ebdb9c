"""Whether the filter knows its own error, and how near it comes to the least: mean NEES and RMSE over the flights."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.consistency import mean_band
from uavsim.set_faults import set_faults
from uavsim.studies.batch_cramer_rao import ENOUGH, FEWEST, Least
from uavsim.studies.campaign.envelopes import mean_square_band
from uavsim.studies.campaign.far import far_traces
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP
from uavsim.studies.campaign.many import Many, Mask
from uavsim.views.campaign.errors import ENLARGED, far_words, log_axis, rebinned, together
from uavsim.views.campaign.quantities import Array
from uavsim.views.campaign.words import remark, title
from uavsim.views.figure import BLUE, GREY, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw(flown: Many) -> "Figure | None":
    """Draw NEES averaged over the flights against its band, and the RMSE over them against the bound.

    A flight whose errors are beyond any scale would decide the means alone; it is left out, and named.
    """
    found = ensemble(flown)
    if found is None:
        return None
    time, nees, errors, far = found
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    figure, axes = sheet(title(flown), _words(nees, flown.least), (1.2, 1.0), columns, size=(12.5, 6.8), right=2.15)
    for i, (upper, lower) in enumerate(zip(*axes, strict=True)):
        every = together(time) if i == 0 and len(columns) > 1 else 1
        _nees(upper, time[::every], nees[:, ::every])
        t, own = rebinned(every, time, errors)
        _error(lower, t, own, flown)
        upper.set_xlim(time[0], ENLARGED if i else time[-1])
    label(axes[0][0], "mean NEES")
    label(axes[1][0], "airspeed error, m/s")
    for row in axes:
        legend(row[-1], row[0])
    make_room(figure, 0)
    remark(figure, [far_words(flown, far)])
    return figure


def ensemble(flown: Many) -> tuple[Array, Array, Array, Mask] | None:
    """Return what means over the flights are made of; None where there is nothing.

    Returns
    -------
    tuple
        Times, shape (n,), s since the true launch; NEES and the filtered error, m/s, shape (flights, n), NaN where
        there is none; and which flights are left out of both, shape (traces,).
    """
    time, nees, filtered = flown.error_time, flown.matrix("nees"), flown.matrix("filtered")
    if not nees.size:
        return None
    far = far_traces(flown, time, filtered)
    nees, filtered = (np.where(np.isfinite(one), one, np.nan)[~far] for one in (nees, filtered))
    there = (np.isfinite(nees).sum(axis=0) >= FEWEST) & (time > ERROR_START + ERROR_STEP)
    there &= np.isfinite(filtered).any(axis=0)
    return (time[there], nees[:, there], filtered[:, there], far) if there.any() else None


def _nees(axes: "Axes", time: Array, nees: Array) -> None:
    bands = _bands(nees)
    means = np.nanmean(nees, axis=0)
    axes.fill_between(time, *bands, color=GREY, alpha=0.35, linewidth=0.0, label="95 % of such means")
    axes.plot(time, means, color=BLUE, linewidth=1.3, label="mean NEES")
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    log_axis(axes)
    positive = means[(means > 0.0) & (time > 0.0)]
    if positive.size:
        ends = np.quantile(positive, (0.01, 0.99))
        low, high = min(ends[0], np.median(bands[0])), max(ends[1], np.median(bands[1]))
        axes.set_ylim(0.7 * max(low, 1e-3), 1.4 * high)


def _error(axes: "Axes", time: Array, errors: Array, flown: Many) -> None:
    squares = errors**2
    rmse = np.sqrt(np.nanmean(squares, axis=0))
    if len(squares) >= ENOUGH:
        low, high = mean_square_band(squares)
        axes.fill_between(time, low, high, color=BLUE, alpha=0.25, linewidth=0.0, label="95 % (bootstrap, flights)")
    axes.plot(time, rmse, color=BLUE, linewidth=1.2, label="RMSE over the flights")
    least = flown.least
    sizes = [rmse[time > 0.0]]
    if least is not None:
        words = "√PCRB, no fault" if set_faults(flown.scenario) else "bound, √PCRB"
        axes.fill_between(
            least.time, least.low, least.high, color=RED, alpha=0.25, linewidth=0.0, label="95 % (bootstrap, courses)"
        )
        axes.plot(least.time, least.sd, color=RED, linewidth=1.1, linestyle="--", label=words)
        sizes.append(least.sd)
    log_axis(axes)
    every = np.concatenate(sizes)
    every = every[np.isfinite(every) & (every > 0.0)]
    if every.size:
        axes.set_ylim(0.8 * every.min(), 1.4 * every.max())
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
    words = f"(error/sd claimed)² over the flights: mean {mean:.2f}, in its 95 % band at {100 * share:.0f} % of times"
    if least is None:
        return words
    return (
        f"{words}; below: against the least that readings allow in the mean of many flights ({least.courses} courses)"
    )
