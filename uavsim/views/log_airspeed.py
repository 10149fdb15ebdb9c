"""The airspeed of somebody's recording: lines for the terminal, and the figure.

The figure has the airspeed with its band, what the pressures alone say, and the reference where the log has one; below
it the error against that, or else the normalised innovations; then specific force along the launch. On the right is the
first launch.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.views.curves import thin
from uavsim.views.figure import BLACK, BLUE, GREY, LIGHT, RED, SKY, label, legend, sheet
from uavsim.views.marks import Mark, flag_all
from uavsim.views.record import Array, Stretch, within

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uavsim.flight import Flight

HEIGHTS, WIDTHS = (3.0, 1.6), (1.7, 1.0)
BEFORE, AFTER = 1.0, 5.0  # s around the first launch that the right column shows
MOST_LABELS, MOST_FLAGS = 12, 6
TWO = 1.96


def lines(flight: "Flight") -> list[str]:
    """Tell what was believed, assumed and found of the airspeed; nothing where the log has none."""
    of = flight.score["recording"].get("airspeed")
    if of is None:
        return []
    said = [f"airspeed: {sentence}" for sentence in of["said"]]
    figures = flight.score["airspeed"]
    if figures["valid_fraction"] is not None:
        nis = figures["nis_mean"]
        words = f"valid in {100.0 * figures['valid_fraction']:.1f} % of the flight, {figures['flags']} flags"
        said.append(f"airspeed ({figures['estimator']}): {words}{'' if nis is None else f', mean NIS {nis:.2f}'}")
    else:
        said.append(f"airspeed ({figures['estimator']}): the log shows no flight")
    if of["reference"] is not None and figures["rmse"] is not None:
        said.append(
            f"against {of['reference']}: RMSE {figures['rmse']:.2f} m/s (raw {figures['rmse_raw']:.2f}), mean "
            f"{figures['bias']:+.2f}, {100.0 * figures['coverage_95']:.0f} % within ±1.96 sd"
        )
    ground = of["over_ground"]
    if ground is not None:
        said.append(
            f"over ground, {ground['turns']:.1f} turns: the airspeed is {_off(ground['difference'])} by "
            f"{abs(ground['difference']):.2f} ± {ground['sd']:.2f} m/s, its own bar ± {ground['claimed']:.2f} (1 sd); "
            f"the wind moves {ground['wind_north']:+.1f} north, {ground['wind_east']:+.1f} east"
        )
    return said + _flags(flight.events)


def _off(difference: float) -> str:
    return "too low" if difference > 0.0 else "too high"


def _flags(events: list[dict[str, Any]]) -> list[str]:
    flags = [event for event in events if event["event"] == "airspeed_fault"]
    told = [
        f"flag: {event['channel']} port {event.get('kind', '')} at {event['t']:.2f} s" for event in flags[:MOST_FLAGS]
    ]
    return [*told, f"… and {len(flags) - MOST_FLAGS} more flags"] if len(flags) > MOST_FLAGS else told


def draw(flight: "Flight") -> "Figure | None":
    """Airspeed over the whole recording and around the first launch; None where the log has none."""
    if flight.score["recording"].get("airspeed") is None or not len(flight.estimate):
        return None
    t = flight.estimate["t"].to_numpy(dtype=float)
    starts = [event["t"] for event in flight.events if event["event"] in ("launch_detected", "in_flight")]
    whole = float(t[0]), float(t[-1])
    centre = starts[0] if starts else whole[0]
    stretches: list[Stretch] = [whole, (max(centre - BEFORE, whole[0]), min(centre + AFTER, whole[1]))]
    figure, axes = sheet(flight.scenario["name"], _words(flight), HEIGHTS, WIDTHS, size=(11.5, 6.5))
    columns = list(zip(*axes, strict=True))
    for column, stretch in zip(columns, stretches, strict=True):
        column[0].set_xlim(*stretch)
        _speeds(column[0], flight, stretch)
        _below(column[1], flight, stretch)
        label(column[-1], x="time of the log, s")
    label(axes[0][0], "airspeed, m/s")
    label(axes[1][0], "error, m/s" if _has_reference(flight) else "NIS, total pressure")
    for row in axes:
        legend(row[-1], row[0])
    colours = {"launch_detected": RED, "in_flight": BLACK, "airspeed_fault": BLUE, "airspeed_recovered": GREY}
    words = {"launch_detected": "detected", "in_flight": "in flight", "airspeed_recovered": "taken back"}
    marks = [
        Mark(
            event["t"],
            words.get(event["event"], f"{event.get('channel', '')} {event.get('kind', '')}"),
            colours[event["event"]],
        )
        for event in flight.events
        if event["event"] in colours
    ]
    flag_all(figure, columns, [marks[:MOST_LABELS]] * 2)
    return figure


def _words(flight: "Flight") -> str:
    figures = flight.score["airspeed"]
    if figures["rmse"] is None:
        return f"{figures['estimator']}: no reference in the log"
    return f"{figures['estimator']}: RMSE raw → filtered {figures['rmse_raw']:.2f} → {figures['rmse']:.2f} m/s"


def _has_reference(flight: "Flight") -> bool:
    return "airspeed_reference" in flight.estimate


def _speeds(axes: "Axes", flight: "Flight", stretch: Stretch) -> None:
    t, speed, sd, raw = _columns(flight, stretch, "airspeed", "airspeed_sd", "airspeed_raw")
    axes.fill_between(
        t,
        np.maximum(speed - TWO * sd, 0.0),
        speed + TWO * sd,
        color=BLUE,
        alpha=0.22,
        linewidth=0.0,
        label="estimate ± 1.96 sd",
    )
    axes.plot(*thin(t, raw), color=LIGHT, linewidth=0.8, label="pressures alone", zorder=1)
    axes.plot(*thin(t, speed), color=BLUE, linewidth=1.2, label="estimate")
    if _has_reference(flight):
        t, reference = _columns(flight, stretch, "airspeed_reference")
        axes.plot(*thin(t, reference), color=BLACK, linewidth=1.0, linestyle="--", label="reference")
    axes.set_ylim(bottom=0.0, top=1.15 * float(np.nanmax(speed, initial=1.0)) + 1.0)


def _below(axes: "Axes", flight: "Flight", stretch: Stretch) -> None:
    if _has_reference(flight):
        t, speed, sd, reference = _columns(flight, stretch, "airspeed", "airspeed_sd", "airspeed_reference")
        axes.fill_between(t, -TWO * sd, TWO * sd, color=BLUE, alpha=0.22, linewidth=0.0, label="± 1.96 sd")
        axes.plot(*thin(t, speed - reference), color=BLUE, linewidth=1.0, label="estimate − reference")
        return
    t, nis = _columns(flight, stretch, "nis_total")
    there = np.isfinite(nis)
    axes.plot(*thin(t[there], nis[there]), color=SKY, linewidth=0.8, label="NIS")
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_ylim(0.0, 12.0)


def _columns(flight: "Flight", stretch: Stretch, *names: str) -> list[Array]:
    table = flight.estimate
    return list(
        within(stretch, table["t"].to_numpy(dtype=float), *(table[name].to_numpy(dtype=float) for name in names))
    )
