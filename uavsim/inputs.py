"""Outside inputs of a flight: presets and aircraft that a user keeps in files of their own.

They are read once, when the scenario is, and travel with it as they were read (`sensors.sheet.Sheet`,
`uavsim.plants.airframe.Airframe`). A flight's folder holds them in ``inputs/KEY/``, and its ``scenario.toml`` names
them there with their SHA-256: the flight flies again from its own folder, whatever became of the originals, and a copy
that was changed is refused.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from hashlib import sha256
from pathlib import Path, PurePosixPath
from typing import Any

from sensors.data_files import read_text
from sensors.sheet import Sheet
from uavsim.files import write_bytes
from uavsim.plants.airframe import Airframe, content_of
from uavsim.plants.airframe.check import check_files

FOLDER = "inputs"
HASHES = "inputs"
"""The scenario's table of hashes, by path below the flight's folder."""
AIRCRAFT = "aircraft.model"
PRESETS = ("accelerometer.preset", "air_data.total.preset", "air_data.static.preset", "air_data.differential.preset")
KEYS = (AIRCRAFT, *PRESETS)


def value_of(values: Mapping[str, Any], key: str) -> Any:
    """Return what stands under a key joined by dots in nested plain values; None if there is nothing."""
    found: Any = values
    for part in key.split("."):
        found = found.get(part) if isinstance(found, Mapping) else None
    return found


def write(folder: Path, scenario: Mapping[str, Any]) -> dict[str, Any]:
    """Write what a scenario has from outside into a flight's folder.

    Returns
    -------
    dict
        The scenario as the folder has it: paths below it, and the table of hashes. Unchanged without outside inputs.
    """
    recorded: dict[str, Any] = deepcopy(dict(scenario))
    hashes = {}
    for key in KEYS:
        value = value_of(scenario, key)
        if not isinstance(value, Sheet | Airframe):
            continue
        place = f"{FOLDER}/{key}/{Path(value).name}"
        for path, content in _files(place, value).items():
            file = folder / path
            file.parent.mkdir(parents=True, exist_ok=True)
            write_bytes(file, content)
            hashes[path] = sha256(content).hexdigest()
        _put(recorded, key, place)
    return {**recorded, HASHES: hashes} if hashes else recorded


def _files(place: str, value: Sheet | Airframe) -> dict[str, bytes]:
    if isinstance(value, Sheet):
        return {place: value.text.encode()}
    return {f"{place}/{path}": content for path, content in value.checked.files.items()}


def _put(values: dict[str, Any], key: str, value: Any) -> None:
    *groups, last = key.split(".")
    for group in groups:
        values = values[group]
    values[last] = value


def read(folder: Path, scenario: Mapping[str, Any]) -> dict[str, Any]:
    """Read what a scenario names in its own folder.

    Parameters
    ----------
    folder
        In which the scenario's file lies.
    scenario
        Nested plain values, as the file has them.

    Returns
    -------
    dict
        The scenario with its outside inputs, without the table of hashes.

    Raises
    ------
    ValueError
        One line: a file is missing, was changed, leads out of the folder, or is not what it should be.
    """
    values: dict[str, Any] = deepcopy(dict(scenario))
    hashes = values.pop(HASHES, {})
    if not isinstance(hashes, Mapping) or not all(isinstance(digest, str) for digest in hashes.values()):
        raise ValueError(f"{HASHES} must be a table of PATH = SHA-256")
    for path in hashes:
        if not path.startswith(tuple(f"{FOLDER}/{key}/" for key in KEYS)) or not {"", ".", ".."}.isdisjoint(
            path.split("/")
        ):
            raise ValueError(f"{HASHES}: {path!r} is no file of {FOLDER}/KEY/, KEY one of {', '.join(KEYS)}")
    read_file = _reader(folder.resolve(), hashes)
    for key in KEYS:
        value = value_of(values, key)
        if not isinstance(value, str) or not value.startswith(f"{FOLDER}/{key}/"):
            continue
        if value != f"{FOLDER}/{key}/{_name(value)}":
            raise ValueError(f"{key} = {value!r}: must be {FOLDER}/{key}/ and a name")
        if key == AIRCRAFT:
            checked = check_files(PurePosixPath(value).name, _below(value, read_file))
            _put(values, key, Airframe(str(folder / value), checked))
        elif read_file(value) is None:
            raise ValueError(f"{key} = {value!r}: is not in the table {HASHES!r} of its SHA-256")
        else:
            _put(values, key, Sheet(str(folder / value), read_text(folder / value)))
    return values


def _name(value: str) -> str:
    """Last part of a path; empty where it is none that names something."""
    last = value.rpartition("/")[2]
    return "" if last in {".", ".."} else last


def _below(place: str, read_file: Callable[[str], bytes | None]) -> Callable[[str], bytes | None]:
    return lambda path: read_file(f"{place}/{path}")


def _reader(folder: Path, hashes: Mapping[str, str]) -> Callable[[str], bytes | None]:
    """Return what reads a file of the folder that the table names; of others it returns None."""

    def read_file(path: str) -> bytes | None:
        digest = hashes.get(path)
        if digest is None:
            return None
        content = content_of(folder, path)
        if content is None:
            raise ValueError(f"{folder / path}: there is no such file; it was flown")
        if sha256(content).hexdigest() != digest:
            raise ValueError(f"{folder / path}: is not what was flown: its SHA-256 is another than in scenario.toml")
        return content

    return read_file
