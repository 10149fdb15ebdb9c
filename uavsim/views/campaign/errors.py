"""The airspeed's error over time: the range of most flights, with the sampling band of each edge."""

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.campaign.envelopes import Envelope, envelopes
from uavsim.studies.campaign.far import far_traces
from uavsim.studies.campaign.flown import ERROR_STEP
from uavsim.studies.campaign.many import Many, Mask
from uavsim.studies.quantiles import quantile_ranks
from uavsim.views.campaign.quantities import Array
from uavsim.views.campaign.words import flights, named, remark, title
from uavsim.views.figure import BLACK, BLUE, GREY, ORANGE, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

QUANTILES = (0.05, 0.50, 0.95)
ENLARGED = 2.0  # s after the true launch to which the error is enlarged
MOST = 4.0  # filtered over raw that is still on the axis
BINS = 120  # that can be told apart on the axis of a whole flight


def draw(flown: Many) -> "Figure | None":
    """Draw the envelope of the airspeed's error over the flights, raw and filtered; None without any.

    Flights whose errors no scale shows beside the others' are left out, and named.
    """
    time, there = error_times(flown)
    if not there.any():
        return None
    time, raw, filtered = time[there], flown.matrix("raw")[:, there], flown.matrix("filtered")[:, there]
    far = far_traces(flown, time, filtered) | far_traces(flown, time, raw)
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    words = _words(len(flown.traces), len(flown), together(time) if len(columns) > 1 else 1)
    figure, axes = sheet(title(flown), words, (1.6, 1.0), columns, size=(12.5, 7.0), right=2.15)
    raw, filtered = raw[~far], filtered[~far]
    for i, (speed, share) in enumerate(zip(*axes, strict=True)):
        every = together(time) if i == 0 and len(columns) > 1 else 1
        t, *errors = rebinned(every, time, raw, filtered)
        for values, colour, kind in zip(errors, (ORANGE, BLUE), ("raw", "filtered"), strict=True):
            _envelope(speed, t, envelopes(values, QUANTILES), colour, kind, len(raw))
            if len(raw) > 1:
                worst = np.where(np.isnan(values), -np.inf, values).max(axis=0)
                worst = np.where(np.isfinite(worst), worst, np.nan)
                speed.plot(t, worst, color=colour, linewidth=0.8, linestyle=":", label=f"{kind}, worst")
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = envelopes(np.where(errors[0] > 0.0, errors[1] / errors[0], np.nan), QUANTILES)
        _envelope(share, t, ratio, BLACK, "filtered / raw", len(raw))
        share.axhline(1.0, color=RED, linewidth=0.9, linestyle="--", label="no help")
        speed.set_xlim(time[0], ENLARGED if i else time[-1])
        error_axes(speed, time, filtered, raw)
        share.set_ylim(0.0, _top(ratio))
        share.set_xlabel("time since true launch, s", fontsize=SMALL + 1.0)
        for one in (speed, share):
            one.axvline(0.0, color=GREY, linewidth=0.9, linestyle="--")
    label(axes[0][0], "airspeed error, m/s")
    label(axes[1][0], "filtered / raw")
    for row in axes:
        legend(row[-1], row[0])
    make_room(figure, 0)
    remark(figure, [far_words(flown, far)])
    return figure


def error_times(flown: Many) -> tuple[Array, Mask]:
    """Return the traces' times, and at which of them half of the flights still have an error that means something."""
    time = flown.error_time
    air = flown.scenario.air_data
    both = np.isfinite(flown.matrix("raw") + flown.matrix("filtered"))
    there = both.sum(axis=0) * 2 >= max(len(flown.traces), 1)
    if air.tare == "covered":
        there &= time > -air.cover_off  # before that the head does not feel the wind
    return time, np.asarray(there, dtype=bool)


def far_words(flown: Many, far: Mask) -> str:
    """Name flights that are left out; empty if there are none."""
    if not far.any():
        return ""
    rows = np.flatnonzero(far).tolist()
    outcomes = flown.words("outcome")
    which = f"{named(flown, rows)} ({', '.join(sorted({outcomes[row] for row in rows}))})"
    return f"left out, far beyond the scale, {len(rows)} of {far.size}: {which}"


def together(time: Array) -> int:
    """Return how many bins to put together so that they can be told apart on the axis of a whole flight."""
    return max(1, ceil(time.size / BINS))


def rebinned(every: int, time: Array, *errors: Array) -> tuple[Array, ...]:
    """Put each `every` bins together: mean times, and root mean squares of errors of shape (flights, bins)."""
    if every == 1:
        return (time, *errors)
    n = time.size // every * every
    found = [time[:n].reshape(-1, every).mean(axis=1)]
    for one in errors:
        parts = one[:, :n].reshape(len(one), -1, every)
        there = ~np.isnan(parts)
        with np.errstate(over="ignore", invalid="ignore"):
            sums = (np.where(there, parts, 0.0) ** 2).sum(axis=2)
            found.append(np.sqrt(sums / there.sum(axis=2)))
    return tuple(found)


def _words(traces: int, rows: int, every: int) -> str:
    whose = f"of the first {flights(traces)}" if traces < rows else f"of {flights(traces)}"
    bins = f"{every * ERROR_STEP:g} s (right: {ERROR_STEP:g} s)" if every > 1 else f"{ERROR_STEP:g} s"
    if traces == 1:
        return f"rms in bins of {bins} {whose}"
    words = f"rms in bins of {bins} {whose}, as long as half of them last; darker: 95 % band of each quantile"
    needed = next(n for n in range(1, 1000) if quantile_ranks(n, QUANTILES[-1])[1] <= n)
    return words + (f" (of 5 and 95 % open outwards below {needed} flights)" if traces < needed else "")


def _envelope(axes: "Axes", time: Array, found: list[Envelope], colour: str, name: str, flights: int) -> None:
    """Draw the median and the range of most flights, the bands of all three darker."""
    low, middle, high = found
    if flights == 1:
        axes.plot(time, middle.value, color=colour, linewidth=1.4, label=name)
        return
    axes.fill_between(time, low.value, high.value, color=colour, alpha=0.2, linewidth=0.0, label=f"{name}, 5 to 95 %")
    for one, bottom, top in (
        (low, np.where(np.isnan(low.low), low.value, low.low), low.high),
        (middle, middle.low, middle.high),
        (high, high.low, np.where(np.isnan(high.high), high.value, high.high)),
    ):
        axes.fill_between(time, bottom, top, color=colour, alpha=0.3, linewidth=0.0)
        axes.plot(time, one.value, color=colour, linewidth=1.4 if one is middle else 0.6, label="_")
    axes.plot([], [], color=colour, linewidth=1.4, label=f"{name}, median")


def _top(found: list[Envelope]) -> float:
    """Return the end of an axis of ratios: what most of the 95 % line needs, and 1 at least."""
    values = np.concatenate([found[-1].value, found[1].value])
    values = values[np.isfinite(values)]
    return min(max(1.15, 1.1 * float(np.quantile(values, 0.99))), MOST) if values.size else 1.15


def log_axis(axes: "Axes") -> None:
    """Make a logarithmic axis whose figures are 1, 2 and 5."""
    from matplotlib.ticker import LogLocator

    axes.set_yscale("log", subs=())
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")


def error_axes(axes: "Axes", time: Array, *errors: Array) -> None:
    """Scale an axis of errors by those in flight; the exact zeros of still air widen it not, nor what is infinite."""
    log_axis(axes)
    positive = np.concatenate([e[np.isfinite(e) & (e > 0.0)] for e in errors])
    flown = np.concatenate([e[:, time > 0.0].ravel() for e in errors])
    flown = flown[np.isfinite(flown) & (flown > 0.0)]
    sizes = flown if flown.size else positive
    if sizes.size:
        axes.set_ylim(0.6 * float(np.quantile(sizes, 0.002)), 1.3 * float(positive.max()))
