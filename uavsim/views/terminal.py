"""Tables for the terminal: a flight's score, several flights, sensor presets, the cost of a step. Units everywhere."""

import tomllib
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from uavsim.views.notes import notes

if TYPE_CHECKING:
    from uavsim.flight import Flight
    from uavsim.studies.batch import Batch
    from uavsim.studies.cost import Cost

QUANTILES = (0.05, 0.25, 0.50, 0.75, 0.95)


def _number(value: Any, digits: int = 3) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def _console() -> Console:
    return Console(highlight=False, soft_wrap=True)


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", header_style="", pad_edge=False)
    table.add_column(columns[0])
    for column in columns[1:]:
        table.add_column(column, justify="right")
    return table


def print_score(flight: "Flight") -> None:
    """Print a flight's score with its units, the requirements, and what deserves a remark."""
    score, console = flight.score, _console()
    verdict = "as expected" if score["outcome"] == score["expected"] else f"expected {score['expected']}"
    name = flight.scenario["name"]
    console.print(f"\n[bold]{name}[/bold], seed {score['seed']}: [bold]{score['outcome']}[/bold] ({verdict})\n")
    console.print(_launch_table(score))
    console.print(_airspeed_table(score["airspeed"]))
    console.print(_pressure_table(score["pressure"]))
    if score["requirements"]:
        console.print(_requirements_table(score["requirements"]))
    for note in notes(flight):
        console.print(f"Note: {note}")


def _launch_table(score: dict[str, Any]) -> Table:
    launch, flight = score["launch"], score["flight"]
    table = _table("Launch and flight", "", "value", "unit")
    for label, value, unit, digits in (
        ("release", launch["release_time"], "s", 3),
        ("true launch (1 mm along the rail)", launch["true_time"], "s", 3),
        ("true f_x above 4.5 g", launch["crossing_time"], "s", 3),
        ("launch detected", launch["detected_time"], "s", 4),
        ("latency from true launch", _milli(launch["latency"]), "ms", 1),
        ("latency from crossing", _milli(launch["latency_from_crossing"]), "ms", 1),
        ("false detections before release", launch["false_detections"], "", 0),
        ("last shoe leaves the rail", flight["rail_exit_time"], "s", 3),
        ("true airspeed there", flight["rail_exit_speed"], "m/s", 2),
        ("wing out", flight["wing_out_time"], "s", 3),
        ("mean true airspeed in cruise", flight["cruise_airspeed"], "m/s", 2),
        ("its standard deviation", flight["cruise_airspeed_sd"], "m/s", 2),
        ("lowest altitude after the rail", flight["lowest_altitude_after_exit"], "m", 2),
        ("altitude at its end", flight["rail_exit_altitude"], "m", 2),
        ("flown", flight["duration"], "s", 1),
    ):
        table.add_row(label, _number(value, digits), unit)
    return table


def _milli(value: float | None) -> float | None:
    return None if value is None else 1e3 * value


def _airspeed_table(airspeed: dict[str, Any]) -> Table:
    columns = {"all": airspeed, **{name: airspeed[name] for name in ("stroke", "transition", "cruise")}}
    table = _table("Airspeed against truth", "", *columns, "unit")
    for label, key, unit, digits in (
        ("RMSE raw", "rmse_raw", "m/s", 3),
        ("RMSE filtered", "rmse", "m/s", 3),
        ("reduction", "reduction_percent", "%", 1),
        ("bias", "bias", "m/s", 3),
        ("largest error", "max_error", "m/s", 3),
        ("mean e²/sd² (NEES)", "nees_mean", "", 2),
        ("within ±1.96 sd", "coverage_95", "", 3),
        ("valid", "valid_fraction", "", 3),
        ("samples", "samples", "", 0),
    ):
        table.add_row(label, *(_number(column[key], digits) for column in columns.values()), unit)
    return table


def _pressure_table(pressure: dict[str, Any]) -> Table:
    table = _table("Pressure against truth (mean error before launch removed)", "", "total", "static", "unit")
    for label, key, unit, digits in (
        ("RMSE raw", "rmse_raw", "Pa", 2),
        ("RMSE filtered", "rmse", "Pa", 2),
        ("reduction", "reduction_percent", "%", 1),
        ("mean error before launch", "bias", "Pa", 2),
    ):
        table.add_row(label, *(_number(pressure[name][key], digits) for name in ("total", "static")), unit)
    return table


def _requirements_table(requirements: list[dict[str, Any]]) -> Table:
    table = _table("Requirements", "", "at least", "at most", "value", "met")
    for r in requirements:
        bounds = ("" if r[side] is None else f"{r[side]:g}" for side in ("minimum", "maximum"))
        table.add_row(r["key"], *bounds, _number(r["value"]), "yes" if r["met"] else "NO")
    return table


def print_batch(flown: "Batch") -> None:
    """Print what several flights gave: outcomes, quantiles of latency and error, the worst of each."""
    console, runs = _console(), flown.runs
    counts = runs["outcome"].value_counts()
    summary = ", ".join(f"{count} {name}" for name, count in counts.items())
    console.print(f"\n[bold]{flown.scenario.name}[/bold], {len(runs)} flights: {summary}\n")
    console.print(_quantile_table(flown))
    console.print(f"False detections before release: {int(runs['launch.false_detections'].sum())}")
    unmet = int((~runs["requirements.met"].astype(bool)).sum())
    console.print(f"Flights with a requirement that is not met: {unmet}")


def _quantile_table(flown: "Batch") -> Table:
    from uavsim.studies.quantiles import quantile_band  # noqa: PLC0415

    names = [f"{100 * q:g} %" for q in QUANTILES]
    table = _table(
        "Over the flights: quantile [95 % band by order statistics]", "", "least", *names, "greatest", "unit"
    )
    for label, key, unit, factor, digits in (
        ("latency from true launch", "launch.latency", "ms", 1e3, 1),
        ("latency from crossing", "launch.latency_from_crossing", "ms", 1e3, 1),
        ("airspeed at the rail's end", "flight.rail_exit_speed", "m/s", 1.0, 2),
        ("RMSE filtered, all", "airspeed.rmse", "m/s", 1.0, 3),
        ("reduction, all", "airspeed.reduction_percent", "%", 1.0, 1),
        ("reduction, stroke", "airspeed.stroke.reduction_percent", "%", 1.0, 1),
        ("reduction, cruise", "airspeed.cruise.reduction_percent", "%", 1.0, 1),
        ("within ±1.96 sd, cruise", "airspeed.cruise.coverage_95", "", 1.0, 3),
    ):
        sample = factor * flown.runs[key].dropna().to_numpy(float)
        if sample.size == 0:
            continue
        bands = [quantile_band(sample, q) for q in QUANTILES]
        cells = [
            f"{b.value:.{digits}f} [{_number(b.low, digits)}, {_number(b.high, digits)}]".replace("[", "\\[")
            for b in bands
        ]
        table.add_row(label, _number(sample.min(), digits), *cells, _number(sample.max(), digits), unit)
    return table


def print_presets() -> None:
    """List the sensor presets, a line each."""
    from sensors import presets  # noqa: PLC0415

    console = _console()
    for name in presets():
        sheet = _datasheet(name)
        console.print(f"{name:<12} {sheet['kind']:<14} {sheet['part']}", markup=False)


def print_preset(name: str) -> None:
    """Print a preset: every value with its unit (part of its name) and its source.

    Raises
    ------
    ValueError
        If there is no such preset.
    """
    from sensors import preset  # noqa: PLC0415

    preset(name)
    sheet, console = _datasheet(name), _console()
    console.print(f"[bold]{name}[/bold]: {sheet['part']}\n{sheet['document']}\n")
    table = Table(title_justify="left", show_lines=False, pad_edge=False)
    for column in ("key", "value", "source and wording"):
        table.add_column(column, overflow="fold")
    sources = sheet["sources"]
    for key, value in sheet["values"].items():
        table.add_row(key, _plain(value), sources.get(key, ""))
    console.print(table)
    if "modes" in sheet:
        modes = _table("Modes", *sheet["modes"][0])
        for mode in sheet["modes"]:
            modes.add_row(*(_plain(value) for value in mode.values()))
        console.print(modes)
        for key in sheet["modes"][0]:
            if key in sources:
                console.print(f"{key}: {sources[key]}", markup=False)


def _datasheet(name: str) -> dict[str, Any]:
    from sensors.catalogue import FOLDER  # noqa: PLC0415

    return tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(_plain(item) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def print_cost(cost: "Cost") -> None:
    """Print what a step costs; the last line is the ratio that outside checks read."""
    console = _console()
    console.print(f"steps                      {cost.steps}")
    console.print(f"in the loop                {cost.in_loop:.2f} µs a step")
    console.print(f"JSBSim, truth recorded     {cost.reference:.2f} µs a step")
    console.print(f"JSBSim, nothing recorded   {cost.bare:.2f} µs a step")
    console.print(f"in the loop over bare      {cost.ratio_over_bare:.2f}")
    console.print(f"same final state           {'yes, bit for bit' if cost.same_state else 'NO'}")
    console.print(f"ratio {cost.ratio:.2f}")
