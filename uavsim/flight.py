"""One flight's record: its tables, events and score, and the folder they are kept in.

A folder holds ``scenario.toml`` (resolved; flies again to the same result), ``score.json``, ``events.json`` (what the
aircraft noticed and did, by its own clock), one Parquet file a table with the unit of each column in its field
metadata, and ``plots/``. It is written under another name and renamed when it is whole.
"""

import json
import os
import shutil
import tempfile
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim.truth import UNITS as TRUTH_UNITS

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd

UNITS: dict[str, dict[str, str]] = {
    "truth": {**TRUTH_UNITS, "phase": ""},
    "accelerometer": {"t": "s", "fx": "m/s^2", "fy": "m/s^2", "fz": "m/s^2"},
    "air_data": {"t": "s", "p_total": "Pa", "p_static": "Pa", "temperature": "K", "t_total": "s", "t_static": "s"},
    "estimate": {
        "t": "s",
        "airspeed": "m/s",
        "airspeed_sd": "m/s",
        "airspeed_raw": "m/s",
        "p_total": "Pa",
        "p_static": "Pa",
        "valid": "",
    },
    "detector": {"t": "s", "level": "1", "count": "1", "total": "1", "triggered": "", "recognised": ""},
}
"""The tables of a flight: their columns and units, in order."""


@dataclass(frozen=True)
class Flight:
    """One flight.

    Attributes
    ----------
    scenario
        The resolved scenario, as nested plain values.
    tables
        'truth', 'accelerometer', 'air_data', 'estimate', 'detector': DataFrames with the columns of `UNITS`, each
        also an attribute. A recording may lack some.
    events
        What was noticed and done on board, each with `t`, s, and `event`.
    score
        See `uavsim.score`.
    """

    scenario: dict[str, Any]
    tables: dict[str, "pd.DataFrame"]
    events: list[dict[str, Any]]
    score: dict[str, Any] = field(default_factory=dict)

    def _table(self, name: str) -> "pd.DataFrame":
        if name not in self.tables:
            raise AttributeError(f"this flight has no table {name!r}; it has {', '.join(self.tables)}")
        return self.tables[name]

    @property
    def truth(self) -> "pd.DataFrame":
        """What JSBSim flew, one row a plant step."""
        return self._table("truth")

    @property
    def accelerometer(self) -> "pd.DataFrame":
        """Readings of specific force."""
        return self._table("accelerometer")

    @property
    def air_data(self) -> "pd.DataFrame":
        """Readings of the pressure head, one row a poll."""
        return self._table("air_data")

    @property
    def estimate(self) -> "pd.DataFrame":
        """Estimated airspeed, raw airspeed and filtered pressures."""
        return self._table("estimate")

    @property
    def detector(self) -> "pd.DataFrame":
        """The launch detector's state around the launch."""
        return self._table("detector")

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        overwrite: bool = False,
        extra: Callable[[Path], None] | None = None,
    ) -> Path:
        """Write the folder, whole or not at all.

        Parameters
        ----------
        path
            Made with its parents; an empty folder counts as none.
        overwrite
            Replace a folder that is not empty.
        extra
            Called with the unfinished folder, to add to it (plots).

        Raises
        ------
        FileExistsError
            If there is something already and `overwrite` is false.
        """
        target = Path(path)
        claim(target, overwrite=overwrite)
        with unfinished(target) as folder:
            write_toml(folder / "scenario.toml", self.scenario)
            write_json(folder / "score.json", self.score)
            write_json(folder / "events.json", self.events)
            for name, table in self.tables.items():
                write_table(folder / f"{name}.parquet", table, UNITS[name])
            if extra is not None:
                extra(folder)
        return target


def load(path: str | os.PathLike[str]) -> Flight:
    """Read a flight's folder.

    Raises
    ------
    ValueError
        If it is not one.
    """
    import pandas as pd  # noqa: PLC0415 (half a second that an import of uavsim need not cost)

    folder = Path(path)
    try:
        scenario = tomllib.loads((folder / "scenario.toml").read_text(encoding="utf-8"))
        events = json.loads((folder / "events.json").read_text(encoding="utf-8"))
        score = json.loads((folder / "score.json").read_text(encoding="utf-8"))
        tables = {
            name: pd.read_parquet(folder / f"{name}.parquet")
            for name in UNITS
            if (folder / f"{name}.parquet").is_file()
        }
    except FileNotFoundError as error:
        raise ValueError(f"{folder} is not a flight's folder: {Path(error.filename).name} is missing") from None
    except (tomllib.TOMLDecodeError, json.JSONDecodeError, UnicodeDecodeError, OSError) as error:
        raise ValueError(f"{folder} cannot be read as a flight: {error}") from None
    return Flight(scenario, tables, events, score)


def frame(name: str, columns: "Mapping[str, np.ndarray]") -> "pd.DataFrame":
    """Table `name` from its columns, in the order of `UNITS`."""
    import pandas as pd  # noqa: PLC0415

    return pd.DataFrame({column: columns[column] for column in UNITS[name]})


def frame_of_rows(name: str, rows: list[tuple[Any, ...]]) -> "pd.DataFrame":
    """Table `name` from rows of numbers and flags."""
    import pandas as pd  # noqa: PLC0415

    table = pd.DataFrame.from_records(rows, columns=list(UNITS[name]))
    return table if rows else table.astype(float)


def frame_of_floats(name: str, values: list[float]) -> "pd.DataFrame":
    """Table `name` from one flat list of floats, row after row."""
    import numpy as np  # noqa: PLC0415
    import pandas as pd  # noqa: PLC0415

    names = list(UNITS[name])
    return pd.DataFrame(np.array(values, dtype=float).reshape(-1, len(names)), columns=names)


# -- folders that are whole or not there -----------------------------------------------------------------------------


def claim(target: Path, *, overwrite: bool) -> None:
    """Make sure that `target` may be written.

    Raises
    ------
    FileExistsError
        If it is a file, or a folder that is not empty and `overwrite` is false.
    OSError
        If it cannot be written.
    """
    if target.exists():
        if not target.is_dir():
            raise FileExistsError(f"{target} is a file, not a folder")
        if any(target.iterdir()) and not overwrite:
            raise FileExistsError(f"{target} is not empty; choose another folder or give --overwrite")
    anchor = target.absolute().parent
    while not anchor.exists():
        anchor = anchor.parent
    if not anchor.is_dir() or not os.access(anchor, os.W_OK):
        raise PermissionError(f"{target} cannot be written: {anchor} is not a writable folder")


class unfinished:  # noqa: N801 (a context manager reads as a word)
    """A folder under another name that takes `target`'s place when the block ends well, and vanishes if not."""

    def __init__(self, target: Path) -> None:
        self.target = target.absolute()

    def __enter__(self) -> Path:
        self.target.parent.mkdir(parents=True, exist_ok=True)
        self.folder = Path(tempfile.mkdtemp(prefix=f".{self.target.name}-", dir=self.target.parent))
        self.folder.chmod(0o755)
        return self.folder

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            shutil.rmtree(self.folder, ignore_errors=True)
            return
        if self.target.exists():
            old = self.folder.with_name(self.folder.name + "-old")
            self.target.rename(old)
            self.folder.rename(self.target)
            shutil.rmtree(old)
        else:
            self.folder.rename(self.target)


def write_table(path: Path, table: "pd.DataFrame", units: Mapping[str, str]) -> None:
    """Write a Parquet file with each column's unit in its field metadata (`unit`)."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    arrow = pa.Table.from_pandas(table, preserve_index=False)
    fields = [
        column.with_metadata({"unit": units[column.name]}) if units.get(column.name) else column
        for column in arrow.schema
    ]
    pq.write_table(arrow.cast(pa.schema(fields, metadata=arrow.schema.metadata)), path)


def write_json(path: Path, value: object) -> None:
    """Write JSON with numbers or null; a value that is not finite is an error of the caller."""
    path.write_text(json.dumps(value, indent=2, allow_nan=False, ensure_ascii=False) + "\n", encoding="utf-8")


def write_toml(path: Path, value: Mapping[str, Any]) -> None:
    """Write TOML; keys whose value is None are left out, as TOML has no null."""
    import tomli_w  # noqa: PLC0415

    path.write_text(tomli_w.dumps(without_none(value)), encoding="utf-8")


def without_none(value: Any) -> Any:
    """The same nested value without the keys that hold None."""
    if isinstance(value, Mapping):
        return {key: without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [without_none(item) for item in value]
    return value
