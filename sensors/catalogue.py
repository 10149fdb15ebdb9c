"""The parts that are shipped: one TOML file each in `datasheets/`, read into a description.

A file holds the numbers in the datasheet's own units (µg/√Hz, mg, %) and, for each, where it was read, how the document
words it (typ, max) and how that is mapped to one standard deviation. A key that is not known, a number without its
source or a source without its number is an error.
"""

import tomllib
from pathlib import Path
from typing import Any

from sensors.accelerometer_description import AccelerometerDescription
from sensors.choice import choose
from sensors.pressure_description import PressureDescription, PressureMode
from sensors.unit import G0, Triple

Description = AccelerometerDescription | PressureDescription

FOLDER = Path(__file__).parent / "datasheets"

UG = 1e-6 * G0  # µg, m/s²
MG = 1e-3 * G0  # mg, m/s²

TOP_KEYS = ("kind", "part", "document", "values", "modes", "sources")
KINDS = ("accelerometer", "pressure")
ACCELEROMETER_KEYS = (
    "ranges_g", "default_range_g", "rates", "default_rate", "bits",
    "filters", "default_filter", "bandwidth_hz", "poles",
    "noise_density_ug", "noise_rate_floor",
    "offset_mg", "offset_limit_mg", "offset_tc_mg", "offset_tc_limit_mg",
    "scale_percent", "scale_limit_percent", "scale_tc_percent", "scale_tc_limit_percent",
    "cross_axis_percent", "cross_axis_limit_percent", "nonlinearity_percent", "rectification_ug",
    "drift_ug", "correlation_time", "random_walk_ug", "rate_percent", "rate_limit_percent",
)  # fmt: skip
PRESSURE_KEYS = (
    "default_mode", "range_pa", "iir_coefficients", "iir_weights", "reference_pressure_pa",
    "offset_pa", "offset_limit_pa", "offset_tc_pa", "offset_tc_limit_pa", "solder_pa",
    "acceleration_pa", "acceleration_limit_pa", "scale", "scale_limit", "rate_percent", "rate_limit_percent",
    "drift_pa", "correlation_time", "random_walk_pa",
    "temperature_offset_k", "temperature_offset_limit_k", "temperature_resolution_k",
)  # fmt: skip
MODE_KEYS = ("name", "noise_pa", "resolution_pa", "temperature_noise_k", "conversion_ms", "rate")


def presets() -> list[str]:
    """Return the names of the shipped parts."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def preset(name: str) -> Description:
    """Return the description of a shipped part, at its default range and rate or mode.

    Parameters
    ----------
    name : str
        Lower case, as the part is written: "lsm6dso32".

    Returns
    -------
    AccelerometerDescription or PressureDescription

    Raises
    ------
    ValueError
        If there is no such part; names the nearest.

    Examples
    --------
    >>> preset("lsm6dso32").select(range_g=16, rate=416).bandwidth
    208.0
    """
    return read(FOLDER / f"{choose('preset', name, presets())}.toml")


def accelerometer(name: str) -> AccelerometerDescription:
    """Return the description of a shipped accelerometer; ValueError if `name` is none."""
    description = preset(name)
    if isinstance(description, AccelerometerDescription):
        return description
    raise ValueError(
        f"preset {name!r} is a pressure sensor, not an accelerometer; allowed: {_of_kind('accelerometer')}"
    )


def pressure_sensor(name: str) -> PressureDescription:
    """Return the description of a shipped pressure sensor; ValueError if `name` is none."""
    description = preset(name)
    if isinstance(description, PressureDescription):
        return description
    raise ValueError(f"preset {name!r} is an accelerometer, not a pressure sensor; allowed: {_of_kind('pressure')}")


def read(path: Path) -> Description:
    """Return the description in one TOML file; ValueError, with file and key, if it is not as it should be."""
    sheet = tomllib.loads(path.read_text(encoding="utf-8"))
    try:
        return _describe(path.stem, sheet)
    except (ValueError, TypeError, IndexError) as error:
        raise ValueError(f"{path.name}: {error}") from error


def _describe(name: str, sheet: dict[str, Any]) -> Description:
    kind = choose("kind", sheet.get("kind", ""), KINDS)
    top = TOP_KEYS if kind == "pressure" else tuple(key for key in TOP_KEYS if key != "modes")
    _check_keys("", sheet, top)
    _check_keys("values.", sheet["values"], ACCELEROMETER_KEYS if kind == "accelerometer" else PRESSURE_KEYS)
    sourced = set(sheet["values"])
    for mode in sheet.get("modes", []):
        _check_keys("modes.", mode, MODE_KEYS)
        sourced |= {f"modes.{key}" for key in mode}
    _check_keys("sources.", sheet["sources"], tuple(sorted(sourced)))
    document = f"{sheet['part']}: {sheet['document']}"
    return _accelerometer(name, document, sheet) if kind == "accelerometer" else _pressure(name, document, sheet)


def _check_keys(where: str, table: dict[str, Any], allowed: tuple[str, ...]) -> None:
    for key in table:
        choose("key", f"{where}{key}", [f"{where}{known}" for known in allowed])
    for key in allowed:
        if key not in table:
            raise ValueError(f"key {where}{key} is missing")


def _accelerometer(name: str, document: str, sheet: dict[str, Any]) -> AccelerometerDescription:
    v = sheet["values"]
    ranges = tuple(float(value) for value in v["ranges_g"])
    for key in ("bits", "noise_density_ug"):
        if len(v[key]) != len(ranges):
            raise ValueError(f"key values.{key} needs one entry for each of ranges_g")
    return AccelerometerDescription(
        name=name,
        document=document,
        ranges_g=ranges,
        rates=tuple(float(value) for value in v["rates"]),
        range_g=float(v["default_range_g"]),
        rate=float(v["default_rate"]),
        filters=tuple(v["filters"]),
        filter=v["default_filter"],
        bandwidths=tuple(tuple(float(width) for width in row) for row in v["bandwidth_hz"]),
        poles=v["poles"],
        bits=tuple(v["bits"]),
        noise_densities=tuple(_triple(row, UG) for row in v["noise_density_ug"]),
        noise_rate_floor=float(v["noise_rate_floor"]),
        bias_sd=_triple(v["offset_mg"], MG),
        bias_limit=_triple(v["offset_limit_mg"], MG),
        bias_tc_sd=_triple(v["offset_tc_mg"], MG),
        bias_tc_limit=_triple(v["offset_tc_limit_mg"], MG),
        scale_sd=v["scale_percent"] / 100,
        scale_limit=v["scale_limit_percent"] / 100,
        scale_tc_sd=v["scale_tc_percent"] / 100,
        scale_tc_limit=v["scale_tc_limit_percent"] / 100,
        cross_axis_sd=v["cross_axis_percent"] / 100,
        cross_axis_limit=v["cross_axis_limit_percent"] / 100,
        nonlinearity_sd=v["nonlinearity_percent"] / 100,
        rectification_sd=v["rectification_ug"] * UG / G0**2,
        drift_sd=v["drift_ug"] * UG,
        correlation_time=float(v["correlation_time"]),
        random_walk=v["random_walk_ug"] * UG,
        rate_sd=v["rate_percent"] / 100,
        rate_limit=v["rate_limit_percent"] / 100,
    ).select(range_g=v["default_range_g"], rate=v["default_rate"], filter=v["default_filter"])


def _pressure(name: str, document: str, sheet: dict[str, Any]) -> PressureDescription:
    v = sheet["values"]
    modes = tuple(_mode(mode) for mode in sheet["modes"])
    return PressureDescription(
        name=name,
        document=document,
        modes=modes,
        mode=modes[0],
        iir_weights=tuple(zip(v["iir_coefficients"], map(float, v["iir_weights"]), strict=True)),
        iir=0,
        range=_pair(v["range_pa"]),
        reference_pressure=float(v["reference_pressure_pa"]),
        offset_sd=float(v["offset_pa"]),
        offset_limit=float(v["offset_limit_pa"]),
        offset_tc_sd=v["offset_tc_pa"],
        offset_tc_limit=v["offset_tc_limit_pa"],
        solder=_pair(v["solder_pa"]),
        acceleration_sd=v["acceleration_pa"],
        acceleration_limit=v["acceleration_limit_pa"],
        scale_sd=v["scale"],
        scale_limit=v["scale_limit"],
        rate_sd=v["rate_percent"] / 100,
        rate_limit=v["rate_limit_percent"] / 100,
        drift_sd=v["drift_pa"],
        correlation_time=float(v["correlation_time"]),
        random_walk=v["random_walk_pa"],
        temperature_offset_sd=v["temperature_offset_k"],
        temperature_offset_limit=v["temperature_offset_limit_k"],
        temperature_resolution=v["temperature_resolution_k"],
    ).select(mode=v["default_mode"])


def _mode(mode: dict[str, Any]) -> PressureMode:
    return PressureMode(
        name=mode["name"],
        noise_sd=float(mode["noise_pa"]),
        resolution=float(mode["resolution_pa"]),
        temperature_noise_sd=float(mode["temperature_noise_k"]),
        conversion_time=mode["conversion_ms"] / 1000,
        rate=float(mode["rate"]),
    )


def _triple(values: list[float], unit: float) -> Triple:
    x, y, z = values
    return x * unit, y * unit, z * unit


def _pair(values: list[float]) -> tuple[float, float]:
    low, high = values
    return float(low), float(high)


def _of_kind(kind: str) -> str:
    names = (path.stem for path in sorted(FOLDER.glob("*.toml")))
    return ", ".join(
        name for name in names if tomllib.loads((FOLDER / f"{name}.toml").read_text("utf-8"))["kind"] == kind
    )
