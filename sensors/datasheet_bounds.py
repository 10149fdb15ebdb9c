"""What each number of a preset may be: its type, its sign, and the bounds beyond which no sensor of its kind is.

A bound says where a number stops to be one of a part that could fly here, with room around everything that is sold. It
is not a judgement of quality: three times the worst part on the market passes.
"""

from collections.abc import Callable
from itertools import pairwise
from math import inf
from typing import Any

Rule = Callable[[str, Any], None]

HUGE = 1e15  # no part has such a number, in any of the units
ENTRIES = 100  # of a list: a part has up to 15 ranges, rates, filters or modes
NAME, SENTENCE = 100, 2000  # characters of a name, and of where a number was read


# -- one value -------------------------------------------------------------------------------------------------------


def number(low: float = -inf, high: float = inf, *, above: float = -inf) -> Rule:
    """Return the rule for a finite number with low ≤ number ≤ high and number > above."""

    def rule(where: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise _not("a number", where, value)
        if not abs(value) <= HUGE:  # NaN is not either
            raise ValueError(f"key {where} must be a finite number, up to {min(high, HUGE):g}")
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


def text(longest: int) -> Rule:
    """Return the rule for a text that says something, in at most `longest` characters."""

    def rule(where: str, value: Any) -> None:
        if not isinstance(value, str):
            raise _not("text", where, value)
        if not value.strip():
            raise ValueError(f"key {where} is empty")
        if len(value) > longest:
            raise ValueError(f"key {where} has {len(value)} characters; it must have {longest} at most")

    return rule


def listed(item: Rule, *, count: int | None = None, rising: bool = False) -> Rule:
    """Return the rule for a list of such items, of this length (else of 1 to 100), each above the one before it."""

    def rule(where: str, value: Any) -> None:
        if not isinstance(value, list):
            raise _not("a list", where, value)
        if not value:
            raise ValueError(f"key {where} is an empty list")
        if count is not None and len(value) != count:
            raise ValueError(f"key {where} must be a list of {count}, not of {len(value)}")
        if len(value) > ENTRIES:
            raise ValueError(f"key {where} is a list of {len(value)}; it must be one of {ENTRIES} at most")
        for index, entry in enumerate(value):
            item(f"{where}[{index}]", entry)
        if rising and any(after <= before for before, after in pairwise(value)):
            raise ValueError(f"key {where} must rise from each to the next")

    return rule


def table(where: str, value: Any) -> None:
    """Check that a value is a table."""
    if not isinstance(value, dict):
        raise _not("a table", where, value)


def _not(wanted: str, where: str, value: Any) -> ValueError:
    names = {bool: "true or false", str: "text", list: "a list", dict: "a table", float: "a number with a fraction"}
    given = names.get(type(value), "a number" if isinstance(value, int) else "a date or time")
    return ValueError(f"key {where} must be {wanted}, not {given}")


# -- every key -------------------------------------------------------------------------------------------------------

NAMES = text(NAME)
CLOCK = number(0.0, 50.0)  # %: the worst RC oscillators are off by 15 %, and at 100 % time would stand still
CORRELATION = number(1e-3, 1e6)  # s: shorter is white noise, longer is an offset for the longest flight, an hour
RANGE_G = number(0.1, 1e5)  # g: from seismic parts of ±0.5 g to shock accelerometers of ±100 000 g
RATE_HZ = number(0.1, 40_000.0)  # Hz: the fastest parts give 32 000; a tenth of a launch fits between two at 0.1 Hz
DENSITY = listed(number(0.0, 1e6), count=3)  # µg/√Hz: 1 g/√Hz; the coarsest part of ±400 g has 15 000
OFFSET_MG = listed(number(0.0, 1e5), count=3)  # mg: 100 g; a part of ±400 g is off by 1 g
OFFSET_TC_MG = listed(number(0.0, 1e3), count=3)  # mg/K: 1 g/K, of which the range must hold 100 K (`datasheet_check`)
SCALE = number(0.0, 50.0)  # %: at 100 % the axis would read nothing, or the other way round
SCALE_TC = number(0.0, 0.3)  # %/K: 30 % over the 100 K between the coldest and the warmest day
CROSS_AXIS = number(0.0, 50.0)  # %: the sine of 30°, where an axis would not be told from its neighbour

ACCELEROMETER: dict[str, Rule] = {
    "ranges_g": listed(RANGE_G, rising=True),
    "default_range_g": RANGE_G,
    "rates": listed(RATE_HZ, rising=True),
    "default_rate": RATE_HZ,
    "bits": listed(whole(2, 32)),  # a sign and a digit; no converter has more than 32
    "filters": listed(NAMES),
    "default_filter": NAMES,
    "bandwidth_hz": listed(listed(number(0.0, 20_000.0))),  # Hz: half of the highest rate; 0 is no such setting
    "poles": whole(0, 2),  # 0 is the mean over one output interval
    "noise_density_ug": listed(DENSITY),
    "noise_rate_floor": number(0.0, 40_000.0),  # Hz: a rate of the part, or 0
    "offset_mg": OFFSET_MG,
    "offset_limit_mg": OFFSET_MG,
    "offset_tc_mg": OFFSET_TC_MG,
    "offset_tc_limit_mg": OFFSET_TC_MG,
    "scale_percent": SCALE,
    "scale_limit_percent": SCALE,
    "scale_tc_percent": SCALE_TC,
    "scale_tc_limit_percent": SCALE_TC,
    "cross_axis_percent": CROSS_AXIS,
    "cross_axis_limit_percent": CROSS_AXIS,
    "nonlinearity_percent": number(0.0, 20.0),  # % of the range: the curve k₃ u³ turns back beyond 25 %
    "rectification_ug": number(0.0, 1e5),  # µg/g²: 0.1 g of offset from 1 g rms; the worst parts have 1000
    "drift_ug": number(0.0, 1e6),  # µg: 1 g of bias that wanders; parts have below 1000
    "correlation_time": CORRELATION,
    "random_walk_ug": number(0.0, 1e6),  # µg/√s: 1 g after a second; parts have below 100
    "rate_percent": CLOCK,
    "rate_limit_percent": CLOCK,
}

PRESSURE_PA = number(0.0, 1e7)  # Pa: a vacuum to 100 bar, of which barometers use the first 1.3
OFFSET_PA = number(0.0, 2e4)  # Pa: a fifth of the atmosphere; cheap parts are off by 1500
OFFSET_TC_PA = number(0.0, 100.0)  # Pa/K: 10 kPa over 100 K; the worst parts have 15
ACCELERATION_PA = number(0.0, 100.0)  # Pa/(m/s²): 1 kPa/g, a membrane of 100 kg/m²; parts have below 1
PRESSURE_SCALE = number(0.0, 0.5)  # a fraction: at 1 it would read nothing
WARMTH = number(0.0, 50.0)  # K: a thermometer that is further off tells no air from any other

PRESSURE: dict[str, Rule] = {
    "default_mode": NAMES,
    "range_pa": listed(PRESSURE_PA, count=2, rising=True),
    "iir_coefficients": listed(whole(0, 10**6), rising=True),
    "iir_weights": listed(number(1e-4, 1.0, above=0.0)),  # 1e-4 takes 10 000 readings to follow; parts have 1/128
    "reference_pressure_pa": PRESSURE_PA,
    "offset_pa": OFFSET_PA,
    "offset_limit_pa": OFFSET_PA,
    "offset_tc_pa": OFFSET_TC_PA,
    "offset_tc_limit_pa": OFFSET_TC_PA,
    "solder_pa": listed(number(-2e4, 2e4), count=2),  # Pa: as the offset
    "acceleration_pa": ACCELERATION_PA,
    "acceleration_limit_pa": ACCELERATION_PA,
    "scale": PRESSURE_SCALE,
    "scale_limit": PRESSURE_SCALE,
    "rate_percent": CLOCK,
    "rate_limit_percent": CLOCK,
    "drift_pa": number(0.0, 1e4),  # Pa: a tenth of the atmosphere, wandering; parts have below 10
    "correlation_time": CORRELATION,
    "random_walk_pa": number(0.0, 1e3),  # Pa/√s: 1 kPa after a second; parts have below 0.1
    "temperature_offset_k": WARMTH,
    "temperature_offset_limit_k": WARMTH,
    "temperature_resolution_k": number(1e-6, 10.0),  # K: below its noise by far, to a thermometer in tens of kelvin
}

MODE: dict[str, Rule] = {
    "name": NAMES,
    "noise_pa": number(0.0, 1e4),  # Pa: a tenth of the atmosphere, 130 m/s of airspeed; parts have below 100
    "resolution_pa": number(1e-6, 1e4),  # Pa: 43 bits of the largest range, to ten steps up to the ground's pressure
    "temperature_noise_k": number(0.0, 10.0),  # K: parts have below 0.1
    "conversion_ms": number(1e-2, 1e4),  # ms: the fastest converters take 0.1 ms; at 10 s a flight is half over
    "rate": number(0.1, 10_000.0),  # Hz: the fastest barometer gives 1800; below 0.1 a flight has three readings
}
