"""Sensor presets in the terminal: all of them, one with its sources, and what a record on the bench shows of it."""

from collections.abc import Callable
from math import floor, isfinite, log10, sqrt
from typing import Any

from rich import box
from rich.table import Table

from sensors.catalogue import preset
from sensors.catalogue import sheet as sheet_of
from sensors.characterise import Characterisation
from sensors.differential_description import DifferentialDescription, fastest
from sensors.noise_fit import Coefficient
from sensors.promise import Promise
from sensors.unit import G0
from uavsim.studies.sensor_bench import Bench
from uavsim.views.characterisation import short, title
from uavsim.views.characterisation import words as setting
from uavsim.views.terminal import _console, _print, _table, say, words

PRESET_UNITS = {
    "ranges_g": "g",
    "default_range_g": "g",
    "rates": "Hz",
    "default_rate": "Hz",
    "bits": "bit",
    "bandwidth_hz": "Hz",
    "noise_density_ug": "µg/√Hz",
    "noise_rate_floor": "Hz",
    "offset_mg": "mg",
    "offset_limit_mg": "mg",
    "offset_tc_mg": "mg/K",
    "offset_tc_limit_mg": "mg/K",
    "scale_percent": "%",
    "scale_limit_percent": "%",
    "scale_tc_percent": "%/K",
    "scale_tc_limit_percent": "%/K",
    "cross_axis_percent": "%",
    "cross_axis_limit_percent": "%",
    "nonlinearity_percent": "% of the range",
    "rectification_ug": "µg/g²",
    "drift_ug": "µg",
    "correlation_time": "s",
    "random_walk_ug": "µg/√s",
    "range_pa": "Pa",
    "reference_pressure_pa": "Pa",
    "offset_pa": "Pa",
    "offset_limit_pa": "Pa",
    "offset_tc_pa": "Pa/K",
    "offset_tc_limit_pa": "Pa/K",
    "solder_pa": "Pa",
    "acceleration_pa": "Pa/(m/s²)",
    "acceleration_limit_pa": "Pa/(m/s²)",
    "rate_percent": "%",
    "rate_limit_percent": "%",
    "drift_pa": "Pa",
    "random_walk_pa": "Pa/√s",
    "temperature_offset_k": "K",
    "temperature_offset_limit_k": "K",
    "temperature_resolution_k": "K",
    "noise_pa": "Pa",
    "resolution_pa": "Pa",
    "temperature_noise_k": "K",
    "conversion_ms": "ms",
    "rate": "Hz",
    "calibration_pressure_pa": "Pa",
    "flow_kg": "kg/s",
    "flow_pressure_pa": "Pa",
}
"""Units of a datasheet's values; the others have none."""

HIGH_PRESSURE, HIGH_SOUND = 70_108.5, 328.58  # Pa and m/s, at 3000 m (ISO 2533)
SKEWED = 0.3  # by how much of half its interval a value may be off the middle and still be printed with ±
_SUFFIXES = ("_g", "_ug", "_mg", "_percent", "_pa", "_k", "_ms", "_hz")
_SCALES = {"m/s²": (1e3, "mm/s²"), "Pa": (1.0, "Pa")}  # how a unit is printed


# -- presets ---------------------------------------------------------------------------------------------------------


def preset_rows() -> list[dict[str, str]]:
    """Name, kind and part of each sensor preset, and of a differential one the airspeed at which it ends."""
    from sensors import presets

    sheets = {name: sheet_of(name) for name in presets()}
    return [
        {"name": name, "kind": sheet["kind"], "part": "; ".join((sheet["part"], *_ends(name)))}
        for name, sheet in sheets.items()
    ]


def _ends(name: str) -> list[str]:
    """Return in words at which airspeed a differential part ends; nothing of others."""
    part = preset(name)
    return [f"to {fastest(part):.0f} m/s"] if isinstance(part, DifferentialDescription) else []


def print_presets() -> None:
    """List the sensor presets, a line each."""
    rows = preset_rows()
    width = max(len(row["name"]) for row in rows)
    for row in rows:
        say(f"{row['name']:<{width}}  {row['kind']:<13}  {row['part']}")


def print_preset(name: str) -> None:
    """Print a preset, by its name or path: every value with its unit, and where the datasheet has it.

    Raises
    ------
    ValueError
        If there is no such preset.
    """
    part = preset(name)
    sheet, console = sheet_of(name), _console()
    sources = sheet["sources"]
    _print(console, words((part.name, "bold"), f": {sheet['part']}\n{sheet['document']}\n{_reach(name)}"))
    table = _sources_table("value")
    for key, value in sheet["values"].items():
        unit = PRESET_UNITS.get(key, "")
        table.add_row(_words(key), f"{_plain(value)} {unit}".rstrip(), sources.get(key, ""))
    _print(console, table)
    modes = sheet.get("modes", [])
    if modes:
        table = _table(
            ["mode", *(", ".join(filter(None, (_words(k), PRESET_UNITS.get(k)))) for k in list(modes[0])[1:])]
        )
        for column in table.columns:
            column.no_wrap = False
        for mode in modes:
            table.add_row(*(_plain(value) for value in mode.values()))
        _print(console, "", table, "")
        table = _sources_table()
        for key in modes[0]:
            if f"modes.{key}" in sources:
                table.add_row(_words(key), sources[f"modes.{key}"])
        _print(console, table)


def _reach(name: str) -> str:
    """Return a line on the airspeeds at which a differential part ends; nothing of others."""
    part = preset(name)
    if not isinstance(part, DifferentialDescription):
        return ""
    high = fastest(part, pressure=HIGH_PRESSURE, sound=HIGH_SOUND)
    line = f"It ends at {fastest(part):.1f} m/s of airspeed at sea level and {high:.1f} m/s at 3000 m"
    if part.calibration_pressure > 0.0:
        off = part.calibration_pressure / HIGH_PRESSURE
        line += f", where it reads {100.0 * (1.0 - 1.0 / off):.0f} % less than the difference"
    return line + ".\n"


def _sources_table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    table.add_column("", no_wrap=True)
    for name in columns:
        table.add_column(name, max_width=24)
    table.add_column("where from, and how it is taken")
    return table


def _words(key: str) -> str:
    """Return a key as words, without the unit at its end."""
    if key in PRESET_UNITS:
        key = next((key.removesuffix(s) for s in _SUFFIXES if key.endswith(s)), key)
    return key.replace("_", " ")


def _plain(value: Any) -> str:
    """Return a value as text; axes that are alike count once, and a row of a table stands in a pair of brackets."""
    if isinstance(value, list):
        return ", ".join(_together(list(map(_plain, v))) if isinstance(v, list) else _plain(v) for v in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _together(values: list[str]) -> str:
    return "/".join(dict.fromkeys(values)) if len(values) <= len("xyz") else f"({', '.join(values)})"


# -- the bench -------------------------------------------------------------------------------------------------------


def print_bench(bench: Bench) -> None:
    """Print what a part promises, what a simulated record of it shows, and somebody's log if there is one."""
    console = _console()
    console.print(words("\n", (title(bench), "bold"), f"\n{setting(bench)}\n"))
    columns = ["", "", "promised", "simulated", *([short(bench.log.name)] if bench.log else [])]
    table = _table(columns)
    table.columns[1].justify = "left"
    scale, unit = _SCALES[bench.promises[0].unit]
    for heading, promised, measured in ROWS:
        rows = []
        for i, promise in enumerate(bench.promises):
            cells = [measured(c, scale) for c in (bench.simulated[i], *bench.compared[i : i + 1])]
            if any(cells):
                rows.append((promise.channel, promised(promise, scale), *(cell or "–" for cell in cells)))
        if len(rows) == len(bench.promises) and len({row[1:] for row in rows}) == 1:
            rows = [("", *rows[0][1:])]
        for i, row in enumerate(rows):
            table.add_row("" if i else heading.format(unit=unit), *row)
    _print(console, table, "")
    for note in _notes(bench):
        console.print(f"Note: {note}")


def _figure(value: float | None) -> str:
    return "–" if value is None or not isfinite(value) else f"{value:.4g}"


def _with_interval(c: Coefficient, factor: float) -> str:
    """Return a value with half its interval, to two digits of that; or the bound below which it is.

    Where the value is far from the middle of its interval, that stands alone.
    """
    if not c.resolved:
        return f"below {factor * c.high:.2g}"
    if abs(2.0 * c.value - c.low - c.high) > SKEWED * (c.high - c.low):
        return f"{factor * c.low:.2g} … {factor * c.high:.2g}"
    half = float(f"{0.5 * factor * (c.high - c.low):.2g}")
    digits = max(0, 1 - floor(log10(half))) if half > 0.0 else 3
    return f"{factor * c.value:.{digits}f} ± {half:.{digits}f}"


def _fitted(name: str, factor: float = 1.0) -> Callable[[Characterisation, float], str]:
    return lambda c, scale: "" if c.fit is None else _with_interval(getattr(c.fit, name), factor * scale)


def _density(c: Characterisation, scale: float) -> str:
    """White noise in the datasheets' unit, of an accelerometer only."""
    return "" if c.channel == "pressure" or c.fit is None else _with_interval(c.fit.N, sqrt(2.0) * 1e6 / G0)


def _quantised(c: Characterisation, scale: float) -> str:
    return "" if c.fit is None or not c.fit.Q.resolved else _with_interval(c.fit.Q, scale)


def _time(c: Characterisation, _: float) -> str:
    """Correlation time of a drift that is there."""
    if c.fit is None or not c.fit.B.resolved:
        return ""
    return "1/f noise" if c.fit.correlation_time is None else f"{c.fit.correlation_time:.3g}"


def _promised_time(promise: Promise, _: float) -> str:
    return "1/f noise" if promise.correlation_time is None else f"{promise.correlation_time:.3g}"


def _low_pass(c: Characterisation, _: float) -> str:
    return f"{c.fit.bandwidth:.3g}" if c.fit is not None and isfinite(c.fit.bandwidth) else ""


ROWS: tuple[tuple[str, Callable[[Promise, float], str], Callable[[Characterisation, float], str]], ...] = (
    ("rate, Hz", lambda p, _: _figure(p.rate), lambda c, _: _figure(c.rate)),
    ("mean, {unit}", lambda *_: "", lambda c, scale: f"{scale * c.mean:.2f}"),
    ("step, {unit}", lambda p, s: _figure(s * p.resolution),
     lambda c, s: "" if c.histogram.resolution is None else _figure(s * c.histogram.resolution)),
    ("noise a reading, {unit}", lambda p, s: _figure(s * p.noise_sd), lambda c, s: _figure(s * c.histogram.sd)),
    ("its low-pass, -3 dB, Hz", lambda p, _: _figure(p.bandwidth), _low_pass),
    ("density n = √2 N, µg/√Hz", lambda p, _: _figure(sqrt(2.0) * p.N * 1e6 / G0), _density),
    ("white noise N, {unit}·√s", lambda p, s: _figure(s * p.N), _fitted("N")),
    ("bias instability B, {unit}", lambda p, s: _figure(s * p.B), _fitted("B")),
    ("  correlation time, s", _promised_time, _time),
    ("random walk K, {unit}/√s", lambda p, s: _figure(s * p.K), _fitted("K")),
    ("quantisation Q, {unit}·s", lambda *_: "–", _quantised),
)  # fmt: skip
"""What is printed: name, what is promised, what is measured; a row without anything measured is left out."""


def _notes(bench: Bench) -> list[str]:
    fits = [c.fit for c in (*bench.simulated, *bench.compared)]
    said = ["N, B, K are fitted to the Allan deviation (IEEE Std 952); ± is half of a 95 % interval, a … b is one."]
    if any(not getattr(fit, name).resolved for fit in fits if fit is not None for name in ("N", "B", "K")):
        said.append("below …: the record does not show the term; 95 % upper bound.")
    if None in fits:
        said.append("a record that does not move has nothing to fit: its noise is far below its step.")
    if bench.log is not None:
        said.append(
            "the drift's correlation time is taken as promised in the simulated record, and searched in the log."
        )
        said += [f"{bench.log.name}: {remark}." for remark in bench.log.remarks()]
        if bench.simulated[0].channel == "pressure":
            said.append(f"{bench.log.name}: what the weather did is part of its drift.")
    return said
