"""Tables of a log as they stand in its files: CSV, Parquet, PX4 ULog, ArduPilot DataFlash.

ULog and DataFlash name a column ``message.field``, or ``message[instance].field`` beyond the first; their time is in
microseconds since boot.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sensors.bench_log import Source, listed
from sensors.files import look
from sensors.tables import brief, table_of
from uavsim.logs.dataflash import HEAD, TEXT, read_dataflash
from uavsim.logs.logged import Key, Logged, labelled
from uavsim.logs.recording import AXES, Array
from uavsim.logs.ulog import read_ulog

Mapped = Mapping[str, Source]
Read = Callable[[Collection[str]], Mapping[str, Array]]

MESSAGE = re.compile(r"[-+]?\s*(\w+)(?:\[(\d{1,9})\])?\.")  # as in sensor_accel[1].x: message, instance


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """One table of a log: a file, or a message of it.

    Attributes
    ----------
    name : str
        Of the file.
    columns : tuple of str
        Which there are.
    read : callable
        Returns columns as numbers; ValueError if they are none.
    usual : mapping
        What ours are called if no map says so.
    remarks : tuple of str
    """

    name: str
    columns: tuple[str, ...]
    read: Read
    usual: Mapped
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Autopilot:
    """What an autopilot's logs are like.

    Attributes
    ----------
    log : str
        What they are called.
    time : str
        Field of every message that is its time, µs since boot.
    force : mapping
        Messages that hold the specific force, the best first, with their axes.
    """

    log: str
    time: str
    force: Mapping[str, tuple[str, str, str]]


PX4 = Autopilot(
    "ULog",
    "timestamp",
    {
        "sensor_combined": ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
        "vehicle_acceleration": ("xyz[0]", "xyz[1]", "xyz[2]"),
        "sensor_accel": ("x", "y", "z"),
    },
)
ARDUPILOT = Autopilot("DataFlash log", "TimeUS", {"IMU": ("AccX", "AccY", "AccZ"), "ACC": ("AccX", "AccY", "AccZ")})


@contextmanager
def named(name: str) -> Iterator[None]:
    """Put the file's name before what is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def read_tables(path: Path, sources: Mapped) -> list[Table]:
    """Return the tables of a file that the map asks for."""
    with named(str(path)):
        held = look(path)
        wanted = _asked(sources)
        if held.head.startswith(b"ULog"):
            names = {name for name, _ in wanted} or set(PX4.force)
            return _messages(path, PX4, read_ulog(held.content(), names), wanted)
        if held.head.startswith((HEAD, TEXT)):
            names = {name for name, _ in wanted} or set(ARDUPILOT.force)
            return _messages(path, ARDUPILOT, read_dataflash(held, names), wanted)
        table = table_of(held)
        return [Table(str(path), table.names, table.read, {})]


def _asked(sources: Mapped) -> list[Key]:
    """Messages, with their instances, that the map names."""
    found = [MESSAGE.match(source.column) for source in sources.values()]
    return list(dict.fromkeys((match[1], int(match[2] or 0)) for match in found if match))


def _messages(path: Path, kind: Autopilot, log: Logged, wanted: Sequence[Key]) -> list[Table]:
    """Tables of an autopilot's log: the messages that the map asks for, or the best that holds the specific force."""
    chosen = list(wanted) or [key for key in ((name, 0) for name in kind.force) if key in log.tables][:1]
    lacking = [key for key in chosen if key not in log.tables]
    if lacking or not chosen:
        raise _missing_message(lacking, kind, log)
    tables, end = [], -np.inf
    for key in chosen:
        fields = log.tables[key]
        columns = {_column(key, field): field for field in fields}
        time = Source(_column(key, kind.time), 1e-6)
        if kind.time in fields:
            end = max(end, float(_floats(fields[kind.time])[-1]) * time.factor)
        axes = dict(zip(AXES, kind.force.get(key[0], ()), strict=False))
        usual = {"t": time, **{axis: Source(_column(key, field)) for axis, field in axes.items()}}
        tables.append(Table(str(path), tuple(columns), _reader(fields, columns), usual))
    if log.damage:
        until = f"; it ends at {end:.3f} s" if np.isfinite(end) else ""
        said = f"the {kind.log} {log.damage}: what could be read is replayed{until}"
        tables[0] = Table(tables[0].name, tables[0].columns, tables[0].read, tables[0].usual, (said,))
    return tables


def _missing_message(lacking: Sequence[Key], kind: Autopilot, log: Logged) -> ValueError:
    what = brief(labelled(lacking[0])) if lacking else " or ".join(kind.force)
    never = f" that was logged ({what} was never logged)" if lacking and lacking[0][0] in log.silent else ""
    first, axes = next(iter(kind.force.items()))
    damage = f" (the {kind.log} {log.damage})" if log.damage else ""
    return ValueError(
        f"has no message {what}{never}; it has {listed(log.names, 30)}; map fx={first}.{axes[0]}, or what holds the "
        f"specific force{damage}"
    )


def _column(key: Key, field: str) -> str:
    return f"{labelled(key)}.{field}"


def _reader(fields: Mapping[str, NDArray[np.generic]], columns: Mapping[str, str]) -> Read:
    return lambda chosen: {name: _floats(fields[columns[name]]) for name in chosen}


def _floats(values: NDArray[np.generic]) -> Array:
    """Return a field as numbers; NaN if it is text."""
    if values.dtype.kind not in "biuf":
        return np.full(values.shape, np.nan)
    with np.errstate(invalid="ignore"):  # damage makes NaN that signal
        return values.astype(np.float64)
