"""Tables for the terminal: a flight's score, several flights, the cost of a step. Units everywhere.

All fit into 80 columns and are the same lines in a pipe; colours are for terminals that want them. Text is text: the
console reads no markup and makes everything visible that it is given (`uavsim.views.text`); what has a style is made
by `words`.
"""

import os
import sys
from collections.abc import Iterable
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from uavsim.scenario import scenario_of
from uavsim.views.notes import notes
from uavsim.views.text import visible

if TYPE_CHECKING:
    from uavsim.flight import Flight
    from uavsim.scenario import Scenario
    from uavsim.studies.batch import Batch
    from uavsim.studies.bench import Cost, OnboardCost
    from uavsim.studies.campaign.many import Many

NARROWEST, WIDEST = 80, 110  # columns; below the former figures would be cut, beyond the latter lines are hard to read


class _Console(Console):
    """Standard output to which text is text, and that outlives its reader, as in `uavsim fly | head -1`."""

    def render_str(self, text: str, **options: Any) -> Text:  # every plain text, in tables too, comes through here
        return super().render_str(visible(text, keep="\n"), **options)

    def on_broken_pipe(self) -> None:
        self.quiet = True
        mute()


def mute() -> None:
    """Send what is still printed nowhere: its reader has gone."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(text: str) -> None:
    """Print one line as it is."""
    _console().print(visible(text), soft_wrap=True)


def words(*parts: str | tuple[str, str]) -> Text:
    """Return text of which some parts, (text, style), have a style."""
    shown = (visible(part if isinstance(part, str) else part[0], keep="\n") for part in parts)
    return Text.assemble(
        *((text, "" if isinstance(part, str) else part[1]) for text, part in zip(shown, parts, strict=True))
    )


def _console() -> Console:
    console = _Console(highlight=False, markup=False, emoji=False)
    console.width = max(NARROWEST, min(console.width, WIDEST))
    return console


def _print(console: Console, *parts: RenderableType) -> None:
    """Print tables within the width, and text in lines of its own that only a reader may break."""
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, str | Text))


def _table(columns: Iterable[str]) -> Table:
    """Make a table whose first column is text and whose others are numbers."""
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for i, name in enumerate(columns):
        table.add_column(name, justify="right" if i else "left", no_wrap=True)
    return table


def _number(value: Any, digits: int = 3) -> str:
    return "–" if value is None else f"{round(value, digits) + 0:.{digits}f}"  # + 0: no minus before a nought


def _milli(value: float | None) -> float | None:
    return None if value is None else 1e3 * value


# -- one flight ------------------------------------------------------------------------------------------------------


def print_score(flight: "Flight") -> None:
    """Print a flight's score with its units, the requirements, and what deserves a remark."""
    score, scenario, console = flight.score, scenario_of(flight), _console()
    right = score["outcome"] == score["expected"]
    verdict = "as expected" if right else f"expected: {score['expected']}"
    if not all(r["met"] for r in score["requirements"]):
        verdict += "; a requirement is not met"
    outcome = (score["outcome"], f"bold {'green' if right else 'red'}")
    head = words("\n", (scenario.name, "bold"), f", seed {score['seed']}: ", outcome, f" ({verdict})\n")
    _print(console, head, _launch_table(score, scenario), "")
    if score.get("reason"):
        console.print(f"Reason: {score['reason']}\n")
    flew = scenario.plant.chosen.flies
    if flew or score["airspeed"]["samples"]:
        phases = ("stroke", "transition", "cruise") if flew else ()
        _print(console, _airspeed_table(score["airspeed"], phases), _integrity_line(score["airspeed"]), "")
        _print(console, _pressure_table(score["pressure"]), "")
    if score["requirements"]:
        _print(console, _requirements_table(score["requirements"]), "")
    for note in notes(flight):
        console.print(f"Note: {note}")


def _launch_table(score: dict[str, Any], scenario: "Scenario") -> Table:
    """Return the launch's times and what followed; of a rig only what it has."""
    launch, flight, axis = score["launch"], score["flight"], scenario.launch_axis
    force = f"{'−' if axis[0] == '-' else ''}f_{axis[1]}"
    left: tuple[tuple[str, str, str], ...] = (
        ("release", _number(launch["release_time"]), "s"),
        ("true launch, 1 mm moved", _number(launch["true_time"]), "s"),
        (f"true {force} above 4.5 g", _number(launch["crossing_time"]), "s"),
        ("launch detected", _number(launch["detected_time"], 4), "s"),
        ("latency", _number(_milli(launch["latency"]), 1), "ms"),
        ("  from the 4.5 g on", _number(_milli(launch["latency_from_crossing"]), 1), "ms"),
        ("false detections", _number(launch["false_detections"], 0), ""),
        ("flown", _number(flight["duration"], 1), "s"),
    )
    right: tuple[tuple[str, str, str], ...] = (
        ("last shoe off the rail", _number(flight["rail_exit_time"]), "s"),
        ("  true airspeed there", _number(flight["rail_exit_speed"], 2), "m/s"),
        ("  altitude there", _number(flight["rail_exit_altitude"], 2), "m"),
        ("lowest altitude since", _number(flight["lowest_altitude_after_exit"], 2), "m"),
        ("wing out", _number(flight["wing_out_time"]), "s"),
        ("true airspeed in cruise", _number(flight["cruise_airspeed"], 2), "m/s"),
        ("  its standard deviation", _number(flight["cruise_airspeed_sd"], 2), "m/s"),
    )
    table = Table(box=None, show_header=False, pad_edge=False)
    for justify in ("left", "right", "left") * 2:
        table.add_column(justify=justify, no_wrap=True)
    if not scenario.plant.chosen.flies:
        left = tuple(row for row in left if row[1] != "–" or row[0] == "launch detected")
        right = tuple(row for row in right if row[1] != "–")
    for one, other in zip_longest(left, right, fillvalue=("", "", "")):
        table.add_row(*one[:2], f"{one[2]:<6}", *other)
    return table


def _airspeed_table(airspeed: dict[str, Any], phases: tuple[str, ...]) -> Table:
    columns = {"all": airspeed, **{name: airspeed[name] for name in phases}}
    table = _table(["Airspeed against truth", *columns])
    for label, key, digits in (
        ("RMSE raw, m/s", "rmse_raw", 3),
        ("RMSE filtered, m/s", "rmse", 3),
        ("reduction, %", "reduction_percent", 1),
        ("bias, m/s", "bias", 3),
        ("largest error, m/s", "max_error", 3),
        ("RMSE of calibrated, m/s", "calibrated.rmse", 3),
        ("RMSE of equivalent, m/s", "equivalent.rmse", 3),
        ("mean e²/sd² (NEES)", "nees_mean", 2),
        ("share within ±1.96 sd", "coverage_95", 3),
        ("share valid", "valid_fraction", 3),
        ("samples", "samples", 0),
    ):
        table.add_row(label, *(_number(_at(column, key), digits) for column in columns.values()))
    return table


def _integrity_line(airspeed: dict[str, Any]) -> str:
    """Say how long a valid airspeed misled, how often validity was lost, and how often a channel was flagged."""
    longest, losses = airspeed.get("hazard_time"), airspeed.get("losses")
    if longest is None or losses is None:
        return ""
    verdict = "a hazard" if airspeed["hazard"] else "no hazard"
    return (
        f"Longest spell of a valid airspeed more than 3 m/s off: {longest:.2f} s, {verdict}\n"
        f"Losses of validity: {losses}; flags of a channel: {airspeed['flags']}, false {airspeed['false_flags']}"
    )


def _at(figures: dict[str, Any], key: str) -> Any:
    """Return a figure by its key, joined by dots; None of a score that lacks it, as one of an earlier version does."""
    found: Any = figures
    for name in key.split("."):
        found = found.get(name) if isinstance(found, dict) else None
    return found


def _pressure_table(pressure: dict[str, Any]) -> Table:
    table = _table(("Pressure against truth, less its bias", "total", "static"))
    for label, key, digits in (
        ("RMSE raw, Pa", "rmse_raw", 2),
        ("RMSE filtered, Pa", "rmse", 2),
        ("reduction, %", "reduction_percent", 1),
        ("bias: mean error before launch, Pa", "bias", 2),
    ):
        table.add_row(label, *(_number(pressure[name][key], digits) for name in ("total", "static")))
    return table


def _requirements_table(requirements: list[dict[str, Any]]) -> Table:
    table = _table(("Requirements", "wanted", "found", "met"))
    table.columns[0].no_wrap = False
    for r in requirements:
        found = "–" if r["value"] is None else f"{r['value']:.4g}"
        met = "yes" if r["met"] else words(("NO", "red"))
        table.add_row(r["key"], _wanted(r["minimum"], r["maximum"]), found, met)
    return table


def _wanted(low: float | None, high: float | None) -> str:
    if low is not None and high is not None:
        return f"{low:g} … {high:g}"
    bounds = (f"{sign} {bound:g}" for sign, bound in (("≥", low), ("≤", high)) if bound is not None)
    return next(bounds, "a number")


# -- several flights -------------------------------------------------------------------------------------------------


def print_batch(flown: "Batch | Many", folder: Path | None = None) -> None:
    """Print what many flights gave, `campaign.terminal.print_many`."""
    from uavsim.views.campaign.terminal import print_many

    print_many(flown, folder)


# -- cost ------------------------------------------------------------------------------------------------------------


def print_cost(cost: "Cost", onboard: "OnboardCost") -> None:
    """Print what a step costs; the last line is the ratio that outside checks read."""
    for line in (
        f"steps                      {cost.steps}",
        f"in the loop                {cost.in_loop:.2f} µs a step",
        f"JSBSim, truth recorded     {cost.reference:.2f} µs a step",
        f"JSBSim, nothing recorded   {cost.bare:.2f} µs a step",
        f"in the loop over bare      {cost.ratio_over_bare:.2f}",
        f"detector and estimator     {onboard.mean:.2f} µs a step, one in ten with pressures; p99 {onboard.p99:.1f}",
        f"same final state           {'yes, bit for bit' if cost.same_state else 'NO'}",
        f"ratio {cost.ratio:.2f}",
    ):
        say(line)
