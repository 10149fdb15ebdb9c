"""Tables of a log as they stand in its files: CSV, Parquet, PX4 ULog, ArduPilot DataFlash.

ULog and DataFlash name a column ``message.field``, or ``message[instance].field`` beyond the first; their time is in
microseconds since boot.
"""

import io
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sensors.bench_log import Source, listed, read_table
from uavsim.logs.recording import AXES

if TYPE_CHECKING:
    import pandas as pd

Mapped = Mapping[str, Source]

# Messages that hold the specific force, the best first, with their axes.
ULOG = {
    "sensor_combined": ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
    "vehicle_acceleration": ("xyz[0]", "xyz[1]", "xyz[2]"),
    "sensor_accel": ("x", "y", "z"),
}
DATAFLASH = {"IMU": ("AccX", "AccY", "AccZ"), "ACC": ("AccX", "AccY", "AccZ")}
MESSAGE = re.compile(r"[-+]?\s*(\w+)(?:\[(\d+)\])?\.")  # as in sensor_accel[1].x: message, instance


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """One table of a log: a file, or a message of it."""

    name: str
    frame: "pd.DataFrame"
    usual: Mapped  # what ours are called if no map says so
    remarks: tuple[str, ...] = ()


@contextmanager
def named(name: str) -> Iterator[None]:
    """Put the file's name before what is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def read_tables(path: Path, sources: Mapped) -> list[Table]:
    """Return the tables of a file that the map asks for."""
    try:
        with path.open("rb") as file:
            head = file.read(8)
    except (FileNotFoundError, IsADirectoryError) as error:
        raise ValueError(f"{path}: there is no such file") from error
    with named(str(path)):
        if head[:4] == b"ULog":
            return _ulog(path, sources)
        if head[:2] == b"\xa3\x95" or head[:4] == b"FMT,":
            return _dataflash(path, sources)
        return [Table(str(path), _parquet(path) if head[:4] == b"PAR1" else read_table(path), {})]


def _parquet(path: Path) -> "pd.DataFrame":
    import pandas as pd

    try:
        table = pd.read_parquet(path)
    except (ValueError, OSError) as error:  # pyarrow's own errors are both
        raise ValueError(f"not a Parquet file that can be read ({error})") from None
    return table.reset_index() if table.index.name else table


def _asked(sources: Mapped) -> list[tuple[str, int]]:
    """Messages, with their instances, that the map names."""
    found = [MESSAGE.match(source.column) for source in sources.values()]
    return list(dict.fromkeys((match[1], int(match[2] or 0)) for match in found if match))


def _missing_message(
    wanted: Sequence[tuple[str, int]], usual: Mapping[str, Sequence[str]], found: Sequence[str]
) -> ValueError:
    name, instance = wanted[0] if wanted else (" or ".join(usual), 0)
    what = f"{name}[{instance}]" if instance else name
    first = next(iter(usual))
    return ValueError(
        f"has no message {what}; it has {listed(sorted(found), 30)}; map fx={first}.{usual[first][0]}, or what "
        "holds the specific force"
    )


def _column(message: str, instance: int, field: str) -> str:
    return f"{message}[{instance}].{field}" if instance else f"{message}.{field}"


def _usual(message: str, instance: int, fields: Sequence[str], time: Source) -> dict[str, Source]:
    axes = {axis: Source(_column(message, instance, field)) for axis, field in zip(AXES, fields, strict=True)}
    return {"t": time, **axes}


def _ulog(path: Path, sources: Mapped) -> list[Table]:
    """Messages of a PX4 ULog; t is `timestamp`, µs since boot, in s."""
    import pandas as pd

    try:
        from pyulog import ULog
        from pyulog.core import ULogException
    except ImportError as error:
        raise ValueError("reading a PX4 ULog needs pyulog: pip install 'uavsim[logs]'") from error
    wanted = _asked(sources)
    log = _quietly(
        lambda: ULog(io.BytesIO(path.read_bytes()), [name for name, _ in wanted] or list(ULOG)), ULogException
    )
    held = {(data.name, data.multi_id): data.data for data in log.data_list}
    chosen = wanted or [key for key in ((name, 0) for name in ULOG) if key in held][:1]
    if not chosen or any(key not in held for key in chosen):
        everything = _quietly(lambda: ULog(io.BytesIO(path.read_bytes())), ULogException)
        lacking = [key for key in chosen if key not in held]
        raise _missing_message(lacking, ULOG, [_column(d.name, d.multi_id, "")[:-1] for d in everything.data_list])
    tables = []
    for name, instance in chosen:
        columns = {_column(name, instance, field): values for field, values in held[name, instance].items()}
        time = Source(_column(name, instance, "timestamp"), 1e-6)
        usual = _usual(name, instance, ULOG[name], time) if name in ULOG else {"t": time}
        tables.append(Table(str(path), pd.DataFrame(columns), usual))
    end = max(float(table.frame[table.usual["t"].column].iloc[-1]) * 1e-6 for table in tables)
    if said := _damage(path, corrupt=log.file_corruption):
        tables[0] = Table(str(path), tables[0].frame, tables[0].usual, (f"the ULog {said}; it ends at {end:.3f} s",))
    return tables


def _damage(path: Path, *, corrupt: bool) -> str:
    """Say what is wrong with a ULog: whether its last message is whole (a ULog has no end mark), or what pyulog saw."""
    content, at = path.read_bytes(), 16  # B, the header
    while at + 3 <= len(content):
        at += 3 + int.from_bytes(content[at : at + 2], "little")
    if at != len(content):
        return "is truncated: what could be read is replayed"
    return "is damaged: what could be read is replayed" if corrupt else ""


def _dataflash(path: Path, sources: Mapped) -> list[Table]:
    """Messages of an ArduPilot DataFlash log, binary or text; t is `TimeUS`, µs since boot, in s."""
    import pandas as pd

    try:
        from pymavlink import DFReader
    except ImportError as error:
        raise ValueError("reading an ArduPilot DataFlash log needs pymavlink: pip install 'uavsim[logs]'") from error
    with path.open("rb") as file:
        binary = file.read(2) == b"\xa3\x95"
    log = _quietly(lambda: (DFReader.DFReader_binary if binary else DFReader.DFReader_text)(str(path)), Exception)
    known = sorted(log.name_to_id)
    wanted = _asked(sources)
    chosen = wanted or [(name, 0) for name in DATAFLASH if name in known]
    try:
        rows = _quietly(lambda: _messages(log, {name for name, _ in chosen}), Exception)
    finally:
        log.close()
    chosen = wanted or [key for key in chosen if key in rows][:1]
    lacking = [key for key in chosen if key not in rows]
    if lacking or not chosen:
        raise _missing_message(lacking, DATAFLASH, known)
    tables = []
    for name, instance in chosen:
        table = pd.DataFrame.from_records(rows[name, instance]).drop(columns="mavpackettype", errors="ignore")
        table.columns = pd.Index([_column(name, instance, str(field)) for field in table.columns])
        time = Source(_column(name, instance, "TimeUS"), 1e-6)
        usual = _usual(name, instance, DATAFLASH[name], time) if name in DATAFLASH else {"t": time}
        tables.append(Table(str(path), table, usual))
    return tables


def _messages(log: Any, names: set[str]) -> dict[tuple[str, int], list[dict[str, Any]]]:
    """Messages of these names, by name and instance."""
    rows: dict[tuple[str, int], list[dict[str, Any]]] = {}
    while (message := log.recv_match(type=list(names))) is not None:
        instance = getattr(message.fmt, "instance_field", None) or "I"
        values = message.to_dict()
        number = values.get(instance, 0)
        rows.setdefault((message.get_type(), number if isinstance(number, int) else 0), []).append(values)
    return rows


def _quietly(read: Callable[[], Any], failure: type[Exception]) -> Any:
    """Read with a library that prints; what it raises becomes a line."""
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            return read()
    except (failure, ValueError, KeyError, IndexError) as error:
        raise ValueError(f"cannot be read: {type(error).__name__}: {error}") from error
