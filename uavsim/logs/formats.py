"""Tables of a log as they stand in its files: text, Parquet, Feather, PX4 ULog, ArduPilot DataFlash, MAVLink tlog.

Autopilots' logs name a column ``message.field``, or ``message[instance].field`` beyond the first; what each message
means is in `autopilots`.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sensors.bench_log import Source, listed, resolved
from sensors.files import Held, look
from sensors.tables import CsvTable, TableFile, table_of
from sensors.text import brief
from uavsim.logs import tlog
from uavsim.logs.autopilots import ARDUPILOT, MAVLINK, PX4, Autopilot, Fields
from uavsim.logs.dataflash import HEAD, TEXT, read_dataflash
from uavsim.logs.known import usual
from uavsim.logs.logged import Key, Logged, labelled
from uavsim.logs.recording import AXES, Array
from uavsim.logs.ulog import read_ulog

Mapped = Mapping[str, Source]
Read = Callable[[Collection[str]], Mapping[str, Array]]

MESSAGE = re.compile(r"[-+]?\s*(\w+)(?:\[(\d{1,9})\])?\.")  # as in sensor_accel[1].x: message, instance
BLACKBOX = b"H Product:Blackbox"  # with which a raw blackbox log begins
ARROW = b"ARROW1"  # with which a Feather file begins


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
    later : callable
        Returns remarks on what was read.
    label : str
        Of the message, if it is one of several in the file.
    counts : bool
        Whether forces are counts, of which 1 g is to be told.
    of_day : frozenset of str
        Columns that hold times of day.
    named : bool
        Whether the columns have names.
    file : TableFile or None
        The file, if it is a table.
    """

    name: str
    columns: tuple[str, ...]
    read: Read
    usual: Mapped
    remarks: tuple[str, ...] = ()
    later: Callable[[], tuple[str, ...]] = tuple
    label: str = ""
    counts: bool = False
    of_day: frozenset[str] = field(default_factory=frozenset)
    named: bool = True
    file: TableFile | None = None


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
        if held.head.startswith(BLACKBOX):
            raise ValueError(
                "is a raw blackbox log: decode it first (blackbox_decode, or save as CSV in the Blackbox Explorer)"
            )
        if held.head.startswith(b"ULog"):
            return _autopilot(path, PX4, lambda names: read_ulog(held.content(), names), sources)
        if held.head.startswith((HEAD, TEXT)):
            return _autopilot(path, ARDUPILOT, lambda names: read_dataflash(held, names), sources)
        if tlog.is_tlog(held.first(tlog.ENOUGH)):
            return _autopilot(path, MAVLINK, lambda names: tlog.read_tlog(held.content(), names), sources)
        return [_table(path, held, sources)]


def table_in(held: Held) -> TableFile | None:
    """Return the table that a file is; None if it is an autopilot's log."""
    autopilots = held.head.startswith((BLACKBOX, b"ULog", HEAD, TEXT)) or tlog.is_tlog(held.first(tlog.ENOUGH))
    return None if autopilots else table_of(held)


def _table(path: Path, held: Held, sources: Mapped) -> Table:
    """Return a file that is a table."""
    table: TableFile = table_of(held)
    mapped = {ours: source for ours, source in sources.items() if resolved(source, table.names).column in table.names}
    layout = table.layout if isinstance(table, CsvTable) else None
    has_names = layout is None or layout.named
    guessed = usual(table.names, layout.units if layout else (), mapped, named=has_names)
    clocks = frozenset(layout.names[i] for i in layout.clocks if i < len(layout.names)) if layout else frozenset()
    return Table(
        str(path),
        table.names,
        table.read,
        guessed.sources,
        guessed.remarks,
        lambda: table.remarks,
        counts=guessed.counts,
        of_day=clocks,
        named=has_names,
        file=table,
    )


# -- autopilots ------------------------------------------------------------------------------------------------------


def _asked(sources: Mapped) -> dict[Key, list[str]]:
    """Messages, with their instances, that the map names, and what of ours it takes from them."""
    found: dict[Key, list[str]] = {}
    for ours, source in sources.items():
        if match := MESSAGE.match(source.column):
            found.setdefault((match[1], int(match[2] or 0)), []).append(ours)
    return found


def _autopilot(path: Path, kind: Autopilot, read: Callable[[set[str]], Logged], sources: Mapped) -> list[Table]:
    """Tables of an autopilot's log: the messages that the map asks for, and the best that hold what it leaves open."""
    asked = _asked(sources)
    log = read({name for name, _ in asked} | set(kind.force) | set(kind.series))
    chosen = dict.fromkeys(asked)
    mapped = set(sources)
    if not any(axis in mapped for axis in AXES):
        best = next((key for key in _instances(kind.force, log)), None)
        if best is None:
            raise _missing_message((), kind, log)
        chosen[best] = None
    if lacking := [key for key in chosen if key not in log.tables]:
        raise _missing_message(lacking, kind, log)
    for key in _instances(kind.series, log):
        chosen.setdefault(key, None)
    tables, taken, end = [], set(mapped - {"t"}), -np.inf
    for key in chosen:
        fields = kind.completed(key[0], log.tables[key])
        table, at_end = _message(path, kind, key, fields, taken)
        end = max(end, at_end)
        if key in asked or key[0] in kind.force or table.usual.keys() - {"t"}:
            tables.append(table)
            taken |= table.usual.keys() - {"t"}
    if not tables:  # the map names no message of it: what there is is told by whoever looks for its columns
        tables = [Table(str(path), tuple(f"{name}.…" for name in log.names), lambda _: {}, {})]
    tables += _others(path, kind, log, chosen)
    if log.damage:
        until = f"; it ends at {end:.3f} s" if np.isfinite(end) else ""
        said = f"the {kind.log} {log.damage}: what could be read is replayed{until}"
        first = tables[0]
        tables[0] = Table(first.name, first.columns, first.read, first.usual, (said, *first.remarks), label=first.label)
    return tables


def _instances(names: Collection[str], log: Logged) -> list[Key]:
    """The first instance of each message that was logged."""
    found = []
    for name in names:
        numbers = sorted(number for logged, number in log.tables if logged == name)
        found += [(name, numbers[0])] if numbers else []
    return found


def _message(path: Path, kind: Autopilot, key: Key, fields: Fields, taken: set[str]) -> tuple[Table, float]:
    """Return a message as a table, and the last time in it, s."""
    columns = {_column(key, name): name for name in fields}
    usual_ones, end = {}, -np.inf
    clock = next(((name, unit) for name, unit in kind.times_of(key[0]) if name in fields), None)
    if clock is not None:
        usual_ones["t"] = Source(_column(key, clock[0]), clock[1])
        end = float(_floats(fields[clock[0]])[-1]) * clock[1]
    axes = dict(zip(AXES, kind.force.get(key[0], ()), strict=False))
    signs = kind.signs.get(key[0], 1.0)
    usual_ones |= {
        axis: Source(_column(key, name), signs) for axis, name in axes.items() if axis not in taken and name in fields
    }
    remarks = []
    for ours, choices in kind.series.get(key[0], {}).items():
        for name, factor, offset, said in choices:
            if name in fields and ours not in taken and ours not in usual_ones:
                usual_ones[ours] = Source(_column(key, name), factor, offset)
                if said:
                    remarks.append(f"{ours} is taken from {_column(key, name)}: {said}")
    table = Table(str(path), tuple(columns), _reader(fields, columns), usual_ones, tuple(remarks), label=labelled(key))
    return table, end


def _others(path: Path, kind: Autopilot, log: Logged, chosen: Mapping[Key, None]) -> list[Table]:
    """Other accelerometers of the same message."""
    force = next((key for key in chosen if key[0] in kind.force), None)
    if force is None:
        return []
    again = kind.again.get(force[0], force[0])
    keys = [key for key in log.tables if key[0] == again and key not in chosen and (again == force[0] or key[1] > 0)]
    tables = []
    for key in keys:
        fields = kind.completed(key[0], log.tables[key])
        table, _ = _message(path, kind, key, fields, set())
        mine = {ours: source for ours, source in table.usual.items() if ours in ("t", *AXES)}
        if len(mine) == 4:
            tables.append(Table(table.name, table.columns, table.read, mine, label=f"other {table.label}"))
    return tables


def _missing_message(lacking: Sequence[Key], kind: Autopilot, log: Logged) -> ValueError:
    what = brief(labelled(lacking[0])) if lacking else " or ".join(kind.force)
    silent = [name for name in ([lacking[0][0]] if lacking else kind.force) if name in log.silent]
    never = f" that was logged ({', '.join(silent)} was never logged)" if silent else ""
    first, axes = next(iter(kind.force.items()))
    damage = f" (the {kind.log} {log.damage})" if log.damage else ""
    has = listed(log.names, 30, "logged messages")
    return ValueError(
        f"has no message {what}{never}; it has {has}; map fx={first}.{axes[0]}, or what holds the "
        f"specific force{damage}"
    )


def _column(key: Key, name: str) -> str:
    return f"{labelled(key)}.{name}"


def _reader(fields: Fields, columns: Mapping[str, str]) -> Read:
    return lambda chosen: {name: _floats(fields[columns[name]]) for name in chosen}


def _floats(values: NDArray[np.generic]) -> Array:
    """Return a field as numbers; NaN if it is text."""
    if values.dtype.kind not in "biuf":
        return np.full(values.shape, np.nan)
    with np.errstate(invalid="ignore"):  # damage makes NaN that signal
        return values.astype(np.float64)
