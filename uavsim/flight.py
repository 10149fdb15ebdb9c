"""One flight's record: its tables, events and score, and the folder they are kept in.

A folder holds ``scenario.toml`` (resolved; flies again to the same result), ``inputs/`` where something came from
outside (`uavsim.inputs`), ``score.json``, ``events.json`` (what the
aircraft noticed and did, by its own clock), one Parquet file a table with the unit of each column in its field
metadata, and ``plots/``. It is whole or not there, see `uavsim.folders`.
"""

import os
from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim.files import whole, write_json, write_toml
from uavsim.folders import Place
from uavsim.truth import UNITS as TRUTH_UNITS

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd

DERIVED = {"calibrated_airspeed": "m/s", "equivalent_airspeed": "m/s"}
"""Columns that follow from others after the flight (`uavsim.airspeeds`); a flight of an earlier version lacks them."""

OF_LOGS = {"airspeed_reference": "m/s"}
"""Columns of an estimate that only a log's has."""

UNITS: dict[str, dict[str, str]] = {
    "truth": {**TRUTH_UNITS, "phase": "", **DERIVED},
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
        "nis_total": "1",
        "nis_static": "1",
        **DERIVED,
    },
    "detector": {"t": "s", "level": "1", "count": "1", "total": "1", "triggered": "", "recognised": ""},
}
"""The tables of a flight: their columns and units, in order; what has no unit has an empty one."""


LONGEST_TIME = 1e18  # s; a clock in microseconds since 1970 that was taken for seconds has 2e15
LARGEST_JSON = 50_000_000  # bytes; a recording of a million detections has as much


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
            Into a folder that is not empty: replace what a flight or a campaign left there; other files stay.
        extra
            Called with the unfinished folder, to add to it (plots).

        Raises
        ------
        OSError
            If there is something already and `overwrite` is false, or another process is writing there
            (FileExistsError); or it cannot be written.
        """
        with Place(path, overwrite=overwrite) as place:
            self.write(place.folder, extra)
        return place.target

    def write(self, folder: Path, extra: Callable[[Path], None] | None = None) -> None:
        """Write the files into a folder that is there; `score.json` is the last one: with it the flight is whole."""
        from uavsim import inputs  # late: a flight that is looked at needs no sensors

        write_json(folder / "events.json", self.events)
        for name, table in self.tables.items():
            write_table(folder / f"{name}.parquet", table, UNITS[name] | OF_LOGS)
        if extra is not None:
            extra(folder)
        write_toml(folder / "scenario.toml", inputs.write(folder, self.scenario))
        write_json(folder / "score.json", self.score)


def load(path: str | os.PathLike[str]) -> Flight:
    """Read a flight's folder.

    Raises
    ------
    ValueError
        If it is not one, or is damaged; one line that names the file.
    """
    from sensors.data_files import parse_json, parse_toml
    from uavsim import inputs

    folder = Path(path)
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a flight's folder: there is no such folder")
    recorded = _read(folder / "scenario.toml", parse_toml, dict)
    try:
        scenario = inputs.read(folder, recorded)
    except ValueError as error:
        raise ValueError(f"{folder / 'scenario.toml'}: {error}") from None
    events = _read(folder / "events.json", parse_json, list)
    score = _read(folder / "score.json", parse_json, dict)
    if not all(map(_is_event, events)):
        raise ValueError(f"{folder / 'events.json'} is not a flight's: an event has a time t, s, and a name")
    files = {name: folder / f"{name}.parquet" for name in UNITS}
    return Flight(scenario, {n: _read_table(n, file) for n, file in files.items() if file.is_file()}, events, score)


def _read(file: Path, parse: Callable[[str], Any], kind: type) -> Any:
    from sensors.data_files import LARGEST, read_text

    if not file.exists():
        raise ValueError(f"{file.parent} is not a flight's folder: {file.name} is missing")
    try:
        text = read_text(file, LARGEST_JSON if file.suffix == ".json" else LARGEST)
    except ValueError as error:
        raise ValueError(f"{file} {error}") from None
    try:
        value = parse(text)
    except ValueError as error:
        raise ValueError(f"{file} is damaged: {error}") from None
    if not isinstance(value, kind):
        raise ValueError(  # noqa: TRY004 (what is wrong is the file)
            f"{file} is not a flight's: it holds a {type(value).__name__}, not a {kind.__name__}"
        )
    return value


def _is_event(value: Any) -> bool:
    if not isinstance(value, dict) or not isinstance(value.get("event"), str):
        return False
    return isinstance(value.get("t"), int | float) and abs(value["t"]) < LONGEST_TIME


def _read_table(name: str, file: Path) -> "pd.DataFrame":
    from sensors.files import look
    from sensors.tables import ParquetTable

    try:
        table = ParquetTable(look(file))
        missing = [column for column in UNITS[name] if column not in table.names and column not in DERIVED]
        if not missing:
            found = table.frame(
                [column for column in table.names if column in UNITS[name] or column in OF_LOGS], texts=("phase",)
            )
            if name == "truth":
                _check_clock(found["t"].to_numpy(float))
            return found
    except ValueError as error:
        raise ValueError(f"{file} cannot be read: {error}") from None
    raise ValueError(f"{file} is not a flight's: the column {missing[0]!r} is missing")


def _check_clock(t: "np.ndarray") -> None:
    """Refuse a truth whose times are none: everything else is looked up by them."""
    import numpy as np

    if len(t) < 2 or not np.isfinite(t).all() or np.abs(t).max() > LONGEST_TIME or not (np.diff(t) > 0.0).all():
        raise ValueError(
            f"its column t must have at least two times, s, that rise from row to row, up to {LONGEST_TIME:g}"
        )


def frame(name: str, columns: "Mapping[str, np.ndarray]") -> "pd.DataFrame":
    """Table `name` from its columns, in the order of `UNITS`."""
    import pandas as pd

    return pd.DataFrame({column: columns[column] for column in UNITS[name]})


def frame_of_rows(name: str, rows: list[tuple[Any, ...]]) -> "pd.DataFrame":
    """Table `name` from rows of numbers and flags, without the columns that follow from others."""
    import pandas as pd

    table = pd.DataFrame.from_records(rows, columns=[column for column in UNITS[name] if column not in DERIVED])
    if not rows:
        return table.astype(float)
    told = {column: float for column in table if table[column].dtype == object}  # None is not a number
    return table.astype(told) if told else table


def frame_of_floats(name: str, values: "array[float]") -> "pd.DataFrame":
    """Table `name` from one flat array of floats, row after row."""
    import numpy as np
    import pandas as pd

    names = list(UNITS[name])
    return pd.DataFrame(np.array(values, dtype=float).reshape(-1, len(names)), columns=names)


def write_table(path: Path, table: "pd.DataFrame", units: Mapping[str, str]) -> None:
    """Write a Parquet file with each column's unit in its field metadata (`unit`)."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrow = pa.Table.from_pandas(table, preserve_index=False)
    fields = [column.with_metadata({"unit": units.get(column.name, "")}) for column in arrow.schema]
    with whole(path) as part:
        pq.write_table(arrow.cast(pa.schema(fields, metadata=arrow.schema.metadata)), part)
