"""The airspeed's error over time: the range of most flights, with the sampling band of each edge."""

from typing import TYPE_CHECKING

import numpy as np

from uavsim.studies.batch import ERROR_STEP
from uavsim.studies.campaign.envelopes import Envelope, envelopes
from uavsim.studies.campaign.far import reach
from uavsim.studies.campaign.many import Many, Mask
from uavsim.studies.quantiles import ranks
from uavsim.views.campaign.quantities import Array
from uavsim.views.campaign.words import flights, named, remark, title
from uavsim.views.figure import BLACK, BLUE, GREY, ORANGE, RED, SMALL, label, legend, make_room, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

QUANTILES = (0.05, 0.50, 0.95)
ENLARGED = 2.0  # s after the true launch to which the error is enlarged


def draw(flown: Many) -> "Figure | None":
    """Draw the envelope of the airspeed's error over the flights, raw and filtered; None without any."""
    time, there = error_times(flown)
    if not there.any():
        return None
    time, raw, filtered = time[there], flown.matrix("raw")[:, there], flown.matrix("filtered")[:, there]
    columns = (1.5, 1.0) if time[-1] > 2.0 * ENLARGED else (1.0,)
    figure, axes = sheet(
        title(flown), _words(len(flown.traces), len(flown)), (1.6, 1.0), columns, size=(12.5, 7.0), right=2.15
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(raw > 0.0, filtered / raw, np.nan)
    far = far_traces(flown, time, filtered) | far_traces(flown, time, raw)
    found = [envelopes(values, QUANTILES) for values in (raw, filtered, ratio)]
    near = ~far if (~far).any() else np.ones(far.size, dtype=bool)
    for i, (speed, share) in enumerate(zip(*axes, strict=True)):
        for envelope, values, colour, kind in (
            (found[0], raw, ORANGE, "raw"),
            (found[1], filtered, BLUE, "filtered"),
        ):
            _envelope(speed, time, envelope, colour, kind)
            with np.errstate(invalid="ignore"):
                worst = np.nanmax(np.where(np.isnan(values[near]), -np.inf, values[near]), axis=0)
            worst = np.where(np.isfinite(worst), worst, np.nan)
            speed.plot(time, worst, color=colour, linewidth=0.8, linestyle=":", label=f"{kind}, worst")
        _envelope(share, time, found[2], BLACK, "filtered / raw")
        share.axhline(1.0, color=RED, linewidth=0.9, linestyle="--", label="no help")
        speed.set_xlim(time[0], ENLARGED if i else time[-1])
        error_axes(speed, time, filtered[near], raw[near])
        share.set_ylim(0.0, _top(found[2]))
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


def far_traces(flown: Many, time: Array, errors: Array) -> Mask:
    """Return which flights' errors after launch are so large that no scale shows them and the others."""
    after = errors[:, time > 0.0] if (time > 0.0).any() else errors
    if not after.shape[1]:
        return np.zeros(len(errors), dtype=bool)
    peaks = np.where(np.isnan(after), -np.inf, np.abs(after)).max(axis=1)
    peaks[peaks == -np.inf] = np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        sizes = np.log10(peaks)
    beyond = reach(sizes, flown.sound[: peaks.size]).beyond & (peaks > 0.0)
    return beyond & (sizes > np.nanmedian(sizes) + 1.0)


def far_words(flown: Many, far: Mask, *, left_out: bool = False) -> str:
    """Name flights whose errors are beyond the scale; empty if there are none."""
    if not far.any():
        return ""
    what = "left out of these means" if left_out else "in the quantiles, but beyond the scale"
    outcomes = sorted({flown.words("outcome")[row] for row in np.flatnonzero(far)})
    return f"{what}: {named(flown, np.flatnonzero(far).tolist())} ({', '.join(outcomes)})"


def _words(traces: int, rows: int) -> str:
    whose = f"of the first {flights(traces)}" if traces < rows else f"of {flights(traces)}"
    words = f"rms in bins of {ERROR_STEP:g} s {whose}, as long as half of them last; darker: 95 % band of each quantile"
    needed = next(n for n in range(1, 1000) if ranks(n, QUANTILES[-1])[1] <= n)
    return words + (f" (of 5 and 95 % open outwards below {needed} flights)" if traces < needed else "")


def _envelope(axes: "Axes", time: Array, found: list[Envelope], colour: str, name: str) -> None:
    """Draw the median and the range of most flights, the bands of all three darker."""
    low, middle, high = found
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
    return max(1.15, 1.1 * float(np.quantile(values, 0.99))) if values.size else 1.15


def error_axes(axes: "Axes", time: Array, *errors: Array) -> None:
    """Scale an axis of errors by those in flight; the exact zeros of still air widen it not, nor what is infinite."""
    from matplotlib.ticker import LogLocator

    axes.set_yscale("log", subs=())
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    positive = np.concatenate([e[np.isfinite(e) & (e > 0.0)] for e in errors])
    flown = np.concatenate([e[:, time > 0.0].ravel() for e in errors])
    flown = flown[np.isfinite(flown) & (flown > 0.0)]
    sizes = flown if flown.size else positive
    if sizes.size:
        axes.set_ylim(0.6 * float(np.quantile(sizes, 0.002)), 1.3 * float(positive.max()))
