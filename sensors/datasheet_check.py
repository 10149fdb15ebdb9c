"""Whether a preset's file says what a part is, completely and in the right units: looked at when it is read.

Keys come first: all that are unknown or missing are named in one line; the terms that have a default in the description
may be missing. Then each value by itself (`sensors.datasheet_bounds`), its sources, and then what has to fit together,
each in one line that names the key:

    bandwidth ≤ rate/2                  a sampled signal has no more
    limit ≥ standard deviation          a unit beyond the limit is drawn again: below it that would not end
    offset, and that of 100 K, ≤ range  a unit that is off by more shows nothing
    101 325 Pa within the range         where every part is put on the bench, and most flights begin
    0 Pa within it                      of a differential part: no airspeed
    a flow, and where it bends          go together
    conversion time ≤ 1/rate            a conversion ends before the next one begins
    0 < weight a ≤ 1                    y += a (x - y) follows its input
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from sensors.accelerometer_description import AccelerometerDescription
from sensors.choice import choose, nearest, shown
from sensors.datasheet_bounds import ACCELEROMETER, DIFFERENTIAL, MODE, NAMES, PRESSURE, SENTENCE
from sensors.differential_description import DifferentialDescription
from sensors.pressure_description import PressureDescription
from sensors.rules import Rule, listed, table, text
from sensors.term import optional

KINDS = ("accelerometer", "pressure", "differential")
HEAD_KEYS = ("kind", "part", "document", "values", "sources")

TEMPERATURES = 100.0  # K, between the coldest and the warmest that a sensor sees
STANDARD_PRESSURE = 101_325.0  # Pa (ISO 2533)
SLOWEST = 1e-6  # of the rate: a low-pass that takes a million readings to settle

UNITS = {"g": "g", "mg": "mg", "ug": "µg", "percent": "%", "hz": "Hz", "pa": "Pa", "k": "K", "ms": "ms"}
NOT_IN_THE_NAME = {"correlation_time": "s", "scale": "a fraction", "scale_limit": "a fraction", "bits": "bit"}
OTHER_SUFFIXES = ("hpa", "kpa", "mbar", "bar", "khz", "ppm", "fraction", "s", "us", "c", "degc", "mps2", "ms2", "m")

RULES = {"accelerometer": ACCELEROMETER, "pressure": PRESSURE, "differential": DIFFERENTIAL}
OPTIONAL = {  # keys that a file may lack
    "accelerometer": optional(AccelerometerDescription),
    "pressure": optional(PressureDescription),
    "differential": optional(DifferentialDescription),
}

TOLD = 3  # unknown keys that are told one by one


@dataclass(frozen=True, slots=True)
class Place:
    """A table of a file: the prefix of its keys, those it has, must have and may have, and a remark on where it is."""

    prefix: str
    found: Collection[str]
    wanted: Collection[str]
    allowed: Collection[str]
    where: str = ""


# -- a file ----------------------------------------------------------------------------------------------------------


def check(sheet: dict[str, Any]) -> None:
    """Check what a preset's file holds; ValueError, one line that names the key, at the first thing that is wrong."""
    if "kind" not in sheet:
        raise ValueError("key kind is missing")
    NAMES("kind", sheet["kind"])
    kind = choose("kind", sheet["kind"], KINDS)
    pressure = kind != "accelerometer"
    _check_keys(sheet, kind)
    text(SENTENCE)("part", sheet["part"])
    text(SENTENCE)("document", sheet["document"])
    values = sheet["values"]
    _entries("values.", values, RULES[kind])
    for mode in sheet["modes"] if pressure else ():
        _entries("modes.", mode, MODE)
    for key, source in sheet["sources"].items():
        text(SENTENCE)(f"sources.{key}", source)
    _limits(values)
    if pressure:
        _fits_modes(values, sheet["modes"])
    if kind == "accelerometer":
        _fits_accelerometer(values)
    elif kind == "pressure":
        _fits_pressure(values)
    else:
        _fits_differential(values)


def _check_keys(sheet: dict[str, Any], kind: str) -> None:
    """Name all keys that are missing, and those that are unknown."""
    places = list(_places(sheet, kind))
    missing = [f"{p.prefix}{key}{p.where}" for p in places for key in p.wanted if key not in p.found]
    unknown = [(p.prefix, key, p.allowed) for p in places for key in p.found if key not in p.allowed]
    said = [_unknown(*each) for each in unknown[:TOLD]]
    if len(unknown) > TOLD:
        said.append(f"{len(unknown) - TOLD} more keys are unknown")
    if missing:
        listed = f"keys {', '.join(missing)} are missing" if len(missing) > 1 else f"key {missing[0]} is missing"
        said.insert(0, listed + (": every number needs its source" if "sources." in missing[-1] else ""))
    if said:
        raise ValueError("; ".join(said))


def _places(sheet: dict[str, Any], kind: str) -> Iterator[Place]:
    """Yield the tables of a file that are there."""
    rules, pressure = RULES[kind], kind != "accelerometer"
    head = (*HEAD_KEYS, "modes") if pressure else HEAD_KEYS
    yield Place("", sheet, head, head)
    values, modes, sources = sheet.get("values", {}), sheet.get("modes", []), sheet.get("sources", {})
    table("values", values)
    table("sources", sources)
    wanted = [key for key in rules if key not in OPTIONAL[kind]]
    misspelt = any(key not in head for key in sheet)  # perhaps a table that is missing
    if "values" in sheet or not misspelt:
        yield Place("values.", values, wanted, rules)
    sourced, known = [key for key in rules if key in values], list(rules)
    if pressure and "modes" in sheet:
        listed(table)("modes", modes)
        for number, mode in enumerate(modes, 1):
            yield Place("modes.", mode, MODE, MODE, f" (mode {number})")
        sourced += [f"modes.{key}" for key in MODE if any(key in mode for mode in modes)]
        known += [f"modes.{key}" for key in MODE]
    elif pressure and not misspelt:
        yield Place("modes.", {}, MODE, MODE)
    if "sources" in sheet:
        yield Place("sources.", sources, sourced, known)


def _unknown(where: str, key: str, allowed: Collection[str]) -> str:
    """Return the line on a key that is not known; one that is known but for its unit says which unit is wanted."""
    name = shown(where + key)
    if where == "sources.":
        return f"key {name} is the source of nothing; nearest: sources.{nearest(key, allowed, cutoff=0.0)}"
    for known in allowed:
        if _stem(key) == _stem(known):
            unit = UNITS.get(known.rpartition("_")[2]) or NOT_IN_THE_NAME.get(known, "Hz")
            return f"key {name} has the wrong unit; wanted: {unit}, as {where}{known}"
    return f"key {name} is unknown; nearest: {where}{nearest(key, allowed, cutoff=0.0)}"


def _stem(key: str) -> str:
    """Return a key without the unit at its end."""
    stem, _, suffix = key.rpartition("_")
    return stem if stem and suffix in (*UNITS, *OTHER_SUFFIXES) else key


def _entries(where: str, values: dict[str, Any], rules: dict[str, Rule]) -> None:
    for key, rule in rules.items():
        if key in values:
            rule(f"{where}{key}", values[key])


# -- what has to fit together ----------------------------------------------------------------------------------------


def _limits(values: dict[str, Any]) -> None:
    for key, limit in values.items():
        if "limit" not in key.split("_"):
            continue
        of = key.replace("_limit", "")
        if of not in values:
            raise ValueError(f"key values.{key} limits values.{of}, which is missing")
        pairs = zip(_as_list(values[of]), _as_list(limit), strict=True)
        if any(bound < sd for sd, bound in pairs):
            raise ValueError(f"key values.{key} is below values.{of}, the standard deviation that it limits")


def _as_list(value: Any) -> list[float]:
    return value if isinstance(value, list) else [value]


def _fits_accelerometer(v: dict[str, Any]) -> None:
    most = 1000.0 * max(v["ranges_g"])  # mg
    for key, factor in (("offset_limit_mg", 1.0), ("offset_tc_limit_mg", TEMPERATURES)):
        if factor * max(v[key]) > most:
            over = f", over {TEMPERATURES:g} K," if factor > 1.0 else ""
            raise ValueError(f"key values.{key}{over} is beyond the range, {most:g} mg: nothing would be seen")
    for key in ("bits", "noise_density_ug"):
        if len(v[key]) != len(v["ranges_g"]):
            raise ValueError(f"key values.{key} needs one entry for each of ranges_g")
    _unlike("values.filters", v["filters"])
    rates, table = v["rates"], v["bandwidth_hz"]
    if len(table) != len(v["filters"]) or any(len(row) != len(rates) for row in table):
        raise ValueError("key values.bandwidth_hz needs one row for each of filters, with one entry for each of rates")
    for name, row in zip(v["filters"], table, strict=True):
        _bandwidths(name, rates, row)
    for rate, *column in zip(rates, *table, strict=True):
        if not any(column):
            raise ValueError(f"key values.bandwidth_hz is 0 at every filter for {rate:g} Hz: leave the rate out")
    choose("key values.default_range_g:", float(v["default_range_g"]), [float(r) for r in v["ranges_g"]])
    choose("key values.default_rate:", float(v["default_rate"]), [float(r) for r in rates])
    choose("key values.default_filter:", v["default_filter"], v["filters"])
    if not table[v["filters"].index(v["default_filter"])][rates.index(v["default_rate"])]:
        name, rate = shown(v["default_filter"]), v["default_rate"]
        raise ValueError(f"key values.default_filter {name} does not exist at default_rate {rate:g}")


def _bandwidths(name: str, rates: list[float], row: list[float]) -> None:
    for rate, width in zip(rates, row, strict=True):
        if width > rate / 2.0:
            raise ValueError(
                f"key values.bandwidth_hz has {width:g} Hz for filter {shown(name)} at {rate:g} Hz, above half the rate"
            )
        if 0.0 < width < SLOWEST * rate:
            raise ValueError(
                f"key values.bandwidth_hz has {width:g} Hz for filter {shown(name)} at {rate:g} Hz; it must be 0 (no "
                f"such setting), or at least {SLOWEST:g} of the rate"
            )
    if not any(row):
        raise ValueError(f"key values.bandwidth_hz is 0 at every rate for filter {shown(name)}: leave the filter out")


def _fits_modes(v: dict[str, Any], modes: list[dict[str, Any]]) -> None:
    names = [mode["name"] for mode in modes]
    _unlike("modes.name", names)
    choose("key values.default_mode:", v["default_mode"], names)
    for mode in modes:
        if mode["conversion_ms"] / 1000.0 > (1.0 + 1e-9) / mode["rate"]:
            raise ValueError(
                f"key modes.conversion_ms of mode {shown(mode['name'])}, {mode['conversion_ms']:g} ms, is longer than "
                f"the period of its rate, {1000.0 / mode['rate']:g} ms"
            )
    low, high = v["range_pa"]
    for mode in modes:
        if mode["resolution_pa"] > high - low:
            raise ValueError(f"key modes.resolution_pa of mode {shown(mode['name'])} is wider than range_pa")
    least, greatest = v.get("solder_pa", (0.0, 0.0))
    if least > greatest:
        raise ValueError("key values.solder_pa must have the least shift first")


def _fits_pressure(v: dict[str, Any]) -> None:
    if len(v["iir_weights"]) != len(v["iir_coefficients"]):
        raise ValueError("key values.iir_weights needs one entry for each of iir_coefficients")
    if v["iir_coefficients"][0] != 0 or v["iir_weights"][0] != 1:
        raise ValueError("key values.iir_coefficients must begin with 0, the filter off, and iir_weights with its 1")
    low, high = v["range_pa"]
    if not low <= STANDARD_PRESSURE <= high:
        span = f"{low:g} to {high:g} Pa"
        raise ValueError(f"key values.range_pa, {span}, does not hold {STANDARD_PRESSURE:g} Pa, the air's at sea level")
    if not low <= v["reference_pressure_pa"] <= high:
        raise ValueError("key values.reference_pressure_pa is outside range_pa")


def _fits_differential(v: dict[str, Any]) -> None:
    low, high = v["range_pa"]
    if not low <= 0.0 < high:
        raise ValueError(f"key values.range_pa, {low:g} to {high:g} Pa, does not hold 0 Pa and what is above it")
    if v.get("flow_kg", 0.0) > 0.0 and "flow_pressure_pa" not in v:
        raise ValueError("key values.flow_pressure_pa is missing: a flow needs the pressure at which it bends")


def _unlike(where: str, names: list[str]) -> None:
    if len(set(names)) != len(names):
        raise ValueError(f"key {where} has the same name twice")
