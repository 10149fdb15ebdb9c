"""Whether a preset's file says what a part is, completely and in the right units: looked at when it is read.

Every check is one line that names the key. What a file holds is looked at in this order: its keys, each value by itself
(type, sign, order, number of axes), its sources, and then what has to fit together:

    bandwidth ≤ rate/2                  a sampled signal has no more
    limit ≥ standard deviation          a unit beyond the limit is drawn again: below it that would not end
    conversion time ≤ 1/rate            a conversion ends before the next one begins
    0 < weight a ≤ 1                    y += a (x - y) follows its input
"""

from collections.abc import Callable, Collection, Sequence
from difflib import get_close_matches
from itertools import pairwise
from math import inf
from typing import Any

from sensors.choice import choose

Rule = Callable[[str, Any], None]

KINDS = ("accelerometer", "pressure")
HEAD_KEYS = ("kind", "part", "document", "values", "sources")

HUGE = 1e15  # no part has such a number, in any of the units

UNITS = {"g": "g", "mg": "mg", "ug": "µg", "percent": "%", "hz": "Hz", "pa": "Pa", "k": "K", "ms": "ms"}
NOT_IN_THE_NAME = {"correlation_time": "s", "scale": "a fraction", "scale_limit": "a fraction", "bits": "bit"}
OTHER_SUFFIXES = ("hpa", "kpa", "mbar", "bar", "khz", "ppm", "fraction", "s", "us", "c", "degc", "mps2", "ms2", "m")


# -- one value -------------------------------------------------------------------------------------------------------


def number(low: float = -inf, high: float = inf, *, above: float = -inf) -> Rule:
    """Return the rule for a finite number with low ≤ number ≤ high and number > above."""

    def rule(where: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise _not("a number", where, value)
        if not abs(value) <= HUGE:  # NaN is not either
            raise ValueError(f"key {where} must be a finite number, up to {HUGE:g}")
        if value <= above:
            raise ValueError(f"key {where} is {value:g}; it must be above {above:g}")
        if not low <= value <= high:
            bounds = f"at least {low:g}" if high == inf else f"{low:g} to {high:g}"
            raise ValueError(f"key {where} is {value:g}; it must be {bounds}")

    return rule


def whole(low: int, high: int) -> Rule:
    """Return the rule for a whole number with low ≤ number ≤ high."""

    def rule(where: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, int):
            raise _not("a whole number", where, value)
        number(low, high)(where, value)

    return rule


def text(where: str, value: Any) -> None:
    """Check that a value is text and says something."""
    if not isinstance(value, str):
        raise _not("text", where, value)
    if not value.strip():
        raise ValueError(f"key {where} is empty")


def listed(item: Rule, *, count: int | None = None, rising: bool = False) -> Rule:
    """Return the rule for a list of such items, of this length (else of any but 0), each above the one before it."""

    def rule(where: str, value: Any) -> None:
        if not isinstance(value, list):
            raise _not("a list", where, value)
        if not value:
            raise ValueError(f"key {where} is an empty list")
        if count is not None and len(value) != count:
            raise ValueError(f"key {where} must be a list of {count}, not of {len(value)}")
        for index, entry in enumerate(value):
            item(f"{where}[{index}]", entry)
        if rising and any(after <= before for before, after in pairwise(value)):
            raise ValueError(f"key {where} must rise from each to the next")

    return rule


def _not(wanted: str, where: str, value: Any) -> ValueError:
    names = {bool: "true or false", str: "text", list: "a list", dict: "a table", float: "a number with a fraction"}
    given = names.get(type(value), "a number" if isinstance(value, int) else "a date or time")
    return ValueError(f"key {where} must be {wanted}, not {given}")


AT_LEAST_0 = number(0.0)
ABOVE_0 = number(above=0.0)
PERCENT = number(0.0, 100.0)
CLOCK_PERCENT = number(0.0, 50.0)
AXES = listed(AT_LEAST_0, count=3)

ACCELEROMETER: dict[str, Rule] = {
    "ranges_g": listed(ABOVE_0, rising=True),
    "default_range_g": ABOVE_0,
    "rates": listed(ABOVE_0, rising=True),
    "default_rate": ABOVE_0,
    "bits": listed(whole(2, 32)),
    "filters": listed(text),
    "default_filter": text,
    "bandwidth_hz": listed(listed(AT_LEAST_0)),
    "poles": whole(0, 2),  # 0 is the mean over one output interval
    "noise_density_ug": listed(AXES),
    "noise_rate_floor": AT_LEAST_0,
    "offset_mg": AXES,
    "offset_limit_mg": AXES,
    "offset_tc_mg": AXES,
    "offset_tc_limit_mg": AXES,
    "scale_percent": PERCENT,
    "scale_limit_percent": PERCENT,
    "scale_tc_percent": PERCENT,
    "scale_tc_limit_percent": PERCENT,
    "cross_axis_percent": PERCENT,
    "cross_axis_limit_percent": PERCENT,
    "nonlinearity_percent": PERCENT,
    "rectification_ug": AT_LEAST_0,
    "drift_ug": AT_LEAST_0,
    "correlation_time": ABOVE_0,
    "random_walk_ug": AT_LEAST_0,
    "rate_percent": CLOCK_PERCENT,
    "rate_limit_percent": CLOCK_PERCENT,
}
PRESSURE: dict[str, Rule] = {
    "default_mode": text,
    "range_pa": listed(AT_LEAST_0, count=2, rising=True),
    "iir_coefficients": listed(whole(0, 10**6), rising=True),
    "iir_weights": listed(number(0.0, 1.0, above=0.0)),
    "reference_pressure_pa": AT_LEAST_0,
    "offset_pa": AT_LEAST_0,
    "offset_limit_pa": AT_LEAST_0,
    "offset_tc_pa": AT_LEAST_0,
    "offset_tc_limit_pa": AT_LEAST_0,
    "solder_pa": listed(number(), count=2),
    "acceleration_pa": AT_LEAST_0,
    "acceleration_limit_pa": AT_LEAST_0,
    "scale": number(0.0, 1.0),
    "scale_limit": number(0.0, 1.0),
    "rate_percent": CLOCK_PERCENT,
    "rate_limit_percent": CLOCK_PERCENT,
    "drift_pa": AT_LEAST_0,
    "correlation_time": ABOVE_0,
    "random_walk_pa": AT_LEAST_0,
    "temperature_offset_k": AT_LEAST_0,
    "temperature_offset_limit_k": AT_LEAST_0,
    "temperature_resolution_k": ABOVE_0,
}
MODE: dict[str, Rule] = {
    "name": text,
    "noise_pa": AT_LEAST_0,
    "resolution_pa": ABOVE_0,
    "temperature_noise_k": AT_LEAST_0,
    "conversion_ms": ABOVE_0,
    "rate": ABOVE_0,
}


# -- a file ----------------------------------------------------------------------------------------------------------


def check(sheet: dict[str, Any]) -> None:
    """Check what a preset's file holds; ValueError, one line that names the key, at the first thing that is wrong."""
    if "kind" not in sheet:
        raise ValueError("key kind is missing")
    text("kind", sheet["kind"])
    pressure = choose("kind", sheet["kind"], KINDS) == "pressure"
    _keys("", sheet, (*HEAD_KEYS, "modes") if pressure else HEAD_KEYS)
    text("part", sheet["part"])
    text("document", sheet["document"])
    values = sheet["values"]
    _table("values", values)
    _entries("values.", values, PRESSURE if pressure else ACCELEROMETER)
    sourced = list(values)
    if pressure:
        listed(_table)("modes", sheet["modes"])
        for mode in sheet["modes"]:
            _entries("modes.", mode, MODE)
        sourced += [f"modes.{key}" for key in MODE]
    _table("sources", sheet["sources"])
    _sources(sheet["sources"], sourced)
    _limits(values)
    if pressure:
        _fits_pressure(values, sheet["modes"])
    else:
        _fits_accelerometer(values)


def _table(where: str, value: Any) -> None:
    if not isinstance(value, dict):
        raise _not("a table", where, value)


def _entries(where: str, table: dict[str, Any], rules: dict[str, Rule]) -> None:
    _keys(where, table, rules)
    for key, rule in rules.items():
        rule(f"{where}{key}", table[key])


def _keys(where: str, table: dict[str, Any], allowed: Collection[str]) -> None:
    for key in table:
        if key not in allowed:
            raise ValueError(_unknown(where, key, allowed))
    for key in allowed:
        if key not in table:
            raise ValueError(f"key {where}{key} is missing")


def _unknown(where: str, key: str, allowed: Collection[str]) -> str:
    """Return the line on a key that is not known; one that is known but for its unit says which unit is wanted."""
    for known in allowed:
        if _stem(key) == _stem(known):
            unit = UNITS.get(known.rpartition("_")[2]) or NOT_IN_THE_NAME.get(known, "Hz")
            return f"key {where + key!r} has the wrong unit; wanted: {unit}, as {where}{known}"
    nearest = get_close_matches(key, allowed, n=1, cutoff=0.0)[0]
    return f"key {where + key!r} is unknown; nearest: {where}{nearest}"


def _stem(key: str) -> str:
    """Return a key without the unit at its end."""
    stem, _, suffix = key.rpartition("_")
    return stem if stem and suffix in (*UNITS, *OTHER_SUFFIXES) else key


def _sources(sources: dict[str, Any], numbers: Sequence[str]) -> None:
    for key in sources:
        if key not in numbers:
            nearest = get_close_matches(key, numbers, n=1, cutoff=0.0)[0]
            raise ValueError(f"key {'sources.' + key!r} is the source of nothing; nearest: sources.{nearest}")
    for key in numbers:
        if key not in sources:
            raise ValueError(f"key sources.{key} is missing: every number needs its source")
        text(f"sources.{key}", sources[key])


# -- what has to fit together ----------------------------------------------------------------------------------------


def _limits(values: dict[str, Any]) -> None:
    for key, limit in values.items():
        if "limit" not in key.split("_"):
            continue
        of = key.replace("_limit", "")
        pairs = zip(_as_list(values[of]), _as_list(limit), strict=True)
        if any(bound < sd for sd, bound in pairs):
            raise ValueError(f"key values.{key} is below values.{of}, the standard deviation that it limits")


def _as_list(value: Any) -> list[float]:
    return value if isinstance(value, list) else [value]


def _fits_accelerometer(v: dict[str, Any]) -> None:
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
        raise ValueError(
            f"key values.default_filter {v['default_filter']!r} does not exist at default_rate {v['default_rate']:g}"
        )


def _bandwidths(name: str, rates: list[float], row: list[float]) -> None:
    for rate, width in zip(rates, row, strict=True):
        if width > rate / 2.0:
            raise ValueError(
                f"key values.bandwidth_hz has {width:g} Hz for filter {name!r} at {rate:g} Hz, above half the rate"
            )
    if not any(row):
        raise ValueError(f"key values.bandwidth_hz is 0 at every rate for filter {name!r}: leave the filter out")


def _fits_pressure(v: dict[str, Any], modes: list[dict[str, Any]]) -> None:
    names = [mode["name"] for mode in modes]
    _unlike("modes.name", names)
    choose("key values.default_mode:", v["default_mode"], names)
    for mode in modes:
        if mode["conversion_ms"] / 1000.0 > (1.0 + 1e-9) / mode["rate"]:
            raise ValueError(
                f"key modes.conversion_ms of mode {mode['name']!r}, {mode['conversion_ms']:g} ms, is longer than the"
                f" period of its rate, {1000.0 / mode['rate']:g} ms"
            )
    if len(v["iir_weights"]) != len(v["iir_coefficients"]):
        raise ValueError("key values.iir_weights needs one entry for each of iir_coefficients")
    if v["iir_coefficients"][0] != 0 or v["iir_weights"][0] != 1:
        raise ValueError("key values.iir_coefficients must begin with 0, the filter off, and iir_weights with its 1")
    low, high = v["range_pa"]
    if not low <= v["reference_pressure_pa"] <= high:
        raise ValueError("key values.reference_pressure_pa is outside range_pa")
    if v["solder_pa"][0] > v["solder_pa"][1]:
        raise ValueError("key values.solder_pa must have the least shift first")


def _unlike(where: str, names: list[str]) -> None:
    if len(set(names)) != len(names):
        raise ValueError(f"key {where} has the same name twice")
