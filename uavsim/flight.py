"""One flight's record: its tables, events and score, and the folder they are kept in.

A folder holds ``scenario.toml`` (resolved; flies again to the same result), ``score.json``, ``events.json`` (what the
aircraft noticed and did, by its own clock), one Parquet file a table with the unit of each column in its field
metadata, and ``plots/``. It is written under another name and takes its place when it is whole.
"""

import json
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
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
        "nis_total": "1",
        "nis_static": "1",
    },
    "detector": {"t": "s", "level": "1", "count": "1", "total": "1", "triggered": "", "recognised": ""},
}
"""The tables of a flight: their columns and units, in order; what has no unit has an empty one."""

OURS = {f"{table}.parquet" for table in (*UNITS, "runs")} | {
    *("scenario.toml", "score.json", "events.json", "campaign.json", "report.html", "plots", "flights")
}
"""What is in the folders of flights and campaigns, and so is replaced when one is written again."""


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
            If there is something already and `overwrite` is false (FileExistsError), or it cannot be written.
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
        If it is not one, or is damaged; one line that names the file.
    """
    from sensors.data_files import parse_json, parse_toml

    folder = Path(path)
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a flight's folder: there is no such folder")
    scenario = _read(folder / "scenario.toml", parse_toml, dict)
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
    import pandas as pd

    try:
        table = pd.read_parquet(file)
    except (ValueError, OSError) as error:  # pyarrow's own errors are both
        raise ValueError(f"{file} cannot be read: {error}") from None
    missing = [column for column in UNITS[name] if column not in table]
    if missing:
        raise ValueError(f"{file} is not a flight's: the column {missing[0]!r} is missing")
    return table


def frame(name: str, columns: "Mapping[str, np.ndarray]") -> "pd.DataFrame":
    """Table `name` from its columns, in the order of `UNITS`."""
    import pandas as pd

    return pd.DataFrame({column: columns[column] for column in UNITS[name]})


def frame_of_rows(name: str, rows: list[tuple[Any, ...]]) -> "pd.DataFrame":
    """Table `name` from rows of numbers and flags."""
    import pandas as pd

    table = pd.DataFrame.from_records(rows, columns=list(UNITS[name]))
    return table if rows else table.astype(float)


def frame_of_floats(name: str, values: list[float]) -> "pd.DataFrame":
    """Table `name` from one flat list of floats, row after row."""
    import numpy as np
    import pandas as pd

    names = list(UNITS[name])
    return pd.DataFrame(np.array(values, dtype=float).reshape(-1, len(names)), columns=names)


# -- folders that are whole or not there -----------------------------------------------------------------------------


def claim(target: Path, *, overwrite: bool) -> None:
    """Make sure that `target` may be written, by writing there and leaving nothing.

    Raises
    ------
    OSError
        If it is a file, or a folder that is not empty and `overwrite` is false (FileExistsError), or it cannot be
        written.
    """
    try:
        if os.path.lexists(target) and not target.is_dir() and not target.is_symlink():
            raise FileExistsError(f"{target} is a file, not a folder")
        if target.is_dir() and any(target.iterdir()) and not overwrite:
            raise FileExistsError(f"{target} is not empty; choose another folder or give --overwrite")
        place = unfinished(target)
        place.__enter__()
        place.discard()
    except OSError as error:
        if error.strerror is None:
            raise
        raise OSError(f"{target} cannot be written: {error.strerror}") from None


class unfinished:  # noqa: N801 (a context manager reads as a word)
    """A folder that becomes `target` when the block ends well, and vanishes if not.

    A new target appears whole, by one rename. One that exists keeps what is not of a flight or a campaign: it may be
    somebody's home, the folder one stands in, or a mounted one that nobody can rename.
    """

    def __init__(self, target: Path) -> None:
        self.target = Path(os.path.realpath(target))  # a link stays, and leads to what is written

    def __enter__(self) -> Path:
        home = self.target if self.target.is_dir() else self.target.parent
        self._made = [parent for parent in (home, *home.parents) if not parent.exists()]
        self.folder = home / f".unfinished-{secrets.token_hex(4)}"
        try:
            self.folder.mkdir(parents=True)
        except BaseException:
            self.discard()
            raise
        return self.folder

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is not None:
                return
            if self.target.is_dir():
                self._move_in()
            else:
                self.folder.rename(self.target)
                self._made = []
        finally:
            self.discard()

    def _move_in(self) -> None:
        """Take the place of what was written there before."""
        new = list(self.folder.iterdir())
        old = self.folder / ".old"
        old.mkdir()
        replaced = OURS | {entry.name for entry in new}
        _move((entry for entry in list(self.target.iterdir()) if entry.name in replaced), old)
        _move(new, self.target)

    def discard(self) -> None:
        """Remove the unfinished folder, and the parents that were made for it."""
        shutil.rmtree(self.folder, ignore_errors=True)
        for parent in self._made:
            with suppress(OSError):  # somebody else may use it by now
                parent.rmdir()


def _move(entries: Iterable[Path], folder: Path) -> None:
    for entry in entries:
        entry.rename(folder / entry.name)


def write_table(path: Path, table: "pd.DataFrame", units: Mapping[str, str]) -> None:
    """Write a Parquet file with each column's unit in its field metadata (`unit`)."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrow = pa.Table.from_pandas(table, preserve_index=False)
    fields = [column.with_metadata({"unit": units.get(column.name, "")}) for column in arrow.schema]
    pq.write_table(arrow.cast(pa.schema(fields, metadata=arrow.schema.metadata)), path)


def write_json(path: Path, value: object) -> None:
    """Write JSON with numbers or null; a value that is not finite is an error of the caller."""
    text = json.dumps(value, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    path.write_text(text, encoding="utf-8", errors="replace")  # a file's name may hold bytes that are no text


def write_toml(path: Path, value: Mapping[str, Any]) -> None:
    """Write TOML; keys whose value is None are left out, as TOML has no null."""
    import tomli_w

    path.write_text(tomli_w.dumps(without_none(value)), encoding="utf-8", errors="replace")


def without_none(value: Any) -> Any:
    """The same nested value without the keys that hold None."""
    if isinstance(value, Mapping):
        return {key: without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [without_none(item) for item in value]
    return value
