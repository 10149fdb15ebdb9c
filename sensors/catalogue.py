"""The parts that are shipped: one TOML file each in `datasheets/`, read into a description.

A file holds the numbers in the datasheet's own units (µg/√Hz, mg, %) and, for each, where it was read, how the document
words it (typ, max) and how that is mapped to one standard deviation. It is data and nothing else: what is not as it
should be (`sensors.datasheet_check`) is refused when it is read, in one line that names file and key. A user's own file
is read by the same code.
"""

import os
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

from sensors import term
from sensors.accelerometer_description import AccelerometerDescription, micro_g
from sensors.choice import choose, shown
from sensors.data_files import parse_toml, read_text
from sensors.datasheet_check import check
from sensors.differential_description import DifferentialDescription
from sensors.pressure_description import PressureDescription, PressureMode, pair
from sensors.sheet import Sheet
from sensors.unit import Triple

Description = AccelerometerDescription | PressureDescription | DifferentialDescription

_KINDS: dict[type[Description], str] = {
    AccelerometerDescription: "an accelerometer",
    PressureDescription: "a pressure sensor",
    DifferentialDescription: "a differential pressure sensor",
}

FOLDER = Path(__file__).parent / "datasheets"


def presets() -> list[str]:
    """Return the names of the shipped parts."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def preset(name: str) -> Description:
    """Return the description of a part, at its default range, rate and filter or its default mode.

    Parameters
    ----------
    name : str
        A shipped part, lower case, as it is written: "lsm6dso32". Or the path of a TOML file of your own,
        "my-part.toml" or with a slash, written like those in `sensors/datasheets`; it is read as data only.

    Returns
    -------
    AccelerometerDescription, PressureDescription or DifferentialDescription

    Raises
    ------
    ValueError
        If there is no such part (names the nearest) or file, or the file is not as it should be (names file and key).

    Examples
    --------
    >>> preset("lsm6dso32").select(range_g=16, rate=416).bandwidth
    208.0
    """
    return _read(name.path, name.text) if isinstance(name, Sheet) else read(path_of(name))


def captured(name: str) -> str:
    """Return the name of a shipped part as it is, and the path of a file of one's own with what stands in it.

    Raises
    ------
    ValueError
        As of `preset`.
    """
    if isinstance(name, Sheet):
        return name
    path = path_of(name)
    if path.parent == FOLDER:
        return name
    own = Sheet(str(path.resolve()), read_text(path))
    preset(own)
    return own


def accelerometer(name: str) -> AccelerometerDescription:
    """Return the description of an accelerometer, by its name or path; ValueError if `name` is none."""
    description = preset(name)
    if isinstance(description, AccelerometerDescription):
        return description
    raise _other(name, description, AccelerometerDescription)


def pressure_sensor(name: str) -> PressureDescription:
    """Return the description of an absolute pressure sensor, by its name or path; ValueError if `name` is none."""
    description = preset(name)
    if isinstance(description, PressureDescription) and not isinstance(description, DifferentialDescription):
        return description
    raise _other(name, description, PressureDescription)


def differential_sensor(name: str) -> DifferentialDescription:
    """Return the description of a differential pressure sensor, by its name or path; ValueError if `name` is none."""
    description = preset(name)
    if isinstance(description, DifferentialDescription):
        return description
    raise _other(name, description, DifferentialDescription)


def _other(name: str, found: Description, wanted: type[Description]) -> ValueError:
    """Return the error of a part of another kind than the one that is wanted."""
    allowed = ", ".join(part for part in presets() if type(preset(part)) is wanted)
    return ValueError(f"preset {shown(name)} is {_KINDS[type(found)]}, not {_KINDS[wanted]}; allowed: {allowed}")


def read(path: Path) -> Description:
    """Return the description in one TOML file; ValueError, with file and key, if it is not as it should be."""
    try:
        text = read_text(path)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from error
    return _read(path, text)


def _read(path: Path, text: str) -> Description:
    try:
        return _described(path.stem, text)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from error


def sheet(name: str) -> dict[str, Any]:
    """Return what the file of a part holds, by its name or path; ValueError as of `preset`."""
    path = path_of(name)
    read(path)
    return parse_toml(read_text(path))


@lru_cache(maxsize=64)  # a flight asks for its parts several times; by text, so that an edited file is read anew
def _described(name: str, text: str) -> Description:
    sheet = parse_toml(text)
    check(sheet)
    document = f"{sheet['part']}: {sheet['document']}"
    return _BUILD[sheet["kind"]](name, document, sheet)


def path_of(name: str) -> Path:
    """Return the file of a part, by its name or path; ValueError if there is none."""
    separators = filter(None, ("/", os.sep, os.altsep))
    if not name.endswith(".toml") and not any(separator in name for separator in separators):
        return FOLDER / f"{choose('preset', name, presets())}.toml"
    path = Path(name)
    if not path.is_file():
        raise ValueError(f"preset {shown(name)} is unknown: there is no such file")
    return path


def _accelerometer(name: str, document: str, sheet: dict[str, Any]) -> AccelerometerDescription:
    v = sheet["values"]
    return AccelerometerDescription(
        name=name,
        document=document,
        ranges_g=tuple(float(value) for value in v["ranges_g"]),
        rates=tuple(float(value) for value in v["rates"]),
        range_g=float(v["default_range_g"]),
        rate=float(v["default_rate"]),
        filters=tuple(v["filters"]),
        filter=v["default_filter"],
        bandwidths=tuple(tuple(float(width) for width in row) for row in v["bandwidth_hz"]),
        poles=v["poles"],
        bits=tuple(v["bits"]),
        noise_densities=tuple(_densities(row) for row in v["noise_density_ug"]),
        **term.read(AccelerometerDescription, v),
    ).select(range_g=v["default_range_g"], rate=v["default_rate"], filter=v["default_filter"])


def _densities(row: list[float]) -> Triple:
    x, y, z = row
    return micro_g(x), micro_g(y), micro_g(z)


def _pressure(name: str, document: str, sheet: dict[str, Any]) -> PressureDescription:
    v = sheet["values"]
    return PressureDescription(
        name=name,
        document=document,
        reference_pressure=float(v["reference_pressure_pa"]),
        iir_weights=tuple(zip(v["iir_coefficients"], map(float, v["iir_weights"]), strict=True)),
        **_settings(sheet),
        **term.read(PressureDescription, v),
    ).select(mode=v["default_mode"])


def _differential(name: str, document: str, sheet: dict[str, Any]) -> DifferentialDescription:
    v = sheet["values"]
    return DifferentialDescription(
        name=name,
        document=document,
        reference_pressure=0.0,
        iir_weights=((0, 1.0),),
        **_settings(sheet),
        **term.read(DifferentialDescription, v),
    ).select(mode=v["default_mode"])


def _settings(sheet: dict[str, Any]) -> dict[str, Any]:
    """Return what a pressure sensor can be set to, and its range."""
    v = sheet["values"]
    modes = tuple(_mode(mode) for mode in sheet["modes"])
    return {
        "modes": modes,
        "mode": modes[0],
        "iir": 0,
        "range": pair(v["range_pa"]),
    }


def _mode(mode: dict[str, Any]) -> PressureMode:
    return PressureMode(
        name=mode["name"],
        noise_sd=float(mode["noise_pa"]),
        resolution=float(mode["resolution_pa"]),
        temperature_noise_sd=float(mode["temperature_noise_k"]),
        conversion_time=mode["conversion_ms"] / 1000,
        rate=float(mode["rate"]),
    )


_BUILD: dict[str, Callable[[str, str, dict[str, Any]], Description]] = {
    "accelerometer": _accelerometer,
    "pressure": _pressure,
    "differential": _differential,
}
