"""Somebody's log turned into readings, and the launch detector run over them.

A log is one file or several: a table (CSV, Parquet), a PX4 ULog or an ArduPilot DataFlash log. A map says which of its
columns are time t, s, and specific force fx, fy, fz, m/s² in body axes forward-right-down (what an accelerometer feels:
at rest, level, fz = -9.81 m/s²). Sign and factor stand in the map: ``fx=-Ay``, ``fx=ax*9.80665``. Time stays that of
the log, wherever it starts.

The detector is that of the packaged scenarios, built for the log's median rate 1/median(Δt), or another. What is true
is not known of a recording: the score holds the detections, and null for whatever needs the truth.
"""

import io
import re
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.bench_log import Source, listed, numbers, parse_map, read_table, resolved
from uavsim import __version__
from uavsim.flight import Flight, frame
from uavsim.onboard import launch
from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Mapped = Mapping[str, Source]

COLUMNS = ("t", "fx", "fy", "fz")
AXES = COLUMNS[1:]
SLOWEST, FASTEST = 10.0, 20_000.0  # Hz, median rates that are understood
FEWEST = 10  # readings
PAUSE = 1.0  # s from a detection until the detector is reset and watches again; strokes last up to 0.4 s
GAP = 3.0  # median intervals, beyond which readings are missing; as the detectors have it
LOOKS_LIKE_G = (0.7, 1.4)  # median of |f|: at rest and in level flight it is 1 in g and 9.8 in m/s²
TOO_MUCH = 400.0  # m/s², median of |f|: no flight feels 40 g for most of the time, counts and mg read so
UNEQUAL = 1.2  # ratio of the axes' factors above which their units are mixed
CLIPPED = 1.5 * STANDARD_GRAVITY  # m/s²; an extreme below is no end of a range
HELD = 3  # readings in a row that hold the extreme value to call it clipped

# Messages that hold the specific force, the best first, with their axes.
ULOG = {
    "sensor_combined": ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
    "vehicle_acceleration": ("xyz[0]", "xyz[1]", "xyz[2]"),
    "sensor_accel": ("x", "y", "z"),
}
DATAFLASH = {"IMU": ("AccX", "AccY", "AccZ"), "ACC": ("AccX", "AccY", "AccZ")}
MESSAGE = re.compile(r"[-+]?\s*(\w+)(?:\[(\d+)\])?\.")  # as in sensor_accel[1].x: message, instance

_AIRSPEED = ("rmse", "rmse_raw", "reduction_percent", "bias", "max_error", "nees_mean", "coverage_95", "valid_fraction")
_PRESSURE = ("rmse", "rmse_raw", "reduction_percent", "bias", "nis_mean")
_FLIGHT = (
    *("rail_exit_time", "rail_exit_speed", "wing_start_time", "wing_out_time"),
    *("cruise_airspeed", "cruise_airspeed_sd", "rail_exit_altitude", "lowest_altitude_after_exit"),
)


@dataclass(frozen=True, slots=True)
class Gap:
    """Readings that are missing: the times of those before and after, s."""

    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Clipping:
    """An axis that stays at its extreme value.

    Attributes
    ----------
    axis : str
    level : float
        m/s².
    samples : int
        How many readings hold it.
    start : float
        The first of them, s.
    """

    axis: str
    level: float
    samples: int
    start: float


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Readings of specific force from somebody's log.

    Attributes
    ----------
    files : tuple of str
        Names of the files.
    mapping : str
        The map that was given, empty without one.
    readings : numpy.ndarray
        Shape (n, 4): t, s, strictly rising, and fx, fy, fz, m/s²; NaN where the log holds no number.
    remarks : tuple of str
        What was not as it should be, a sentence each.
    """

    files: tuple[str, ...]
    mapping: str
    readings: Array
    remarks: tuple[str, ...]

    @property
    def rate(self) -> float:
        """Median rate, Hz."""
        return float(1.0 / np.median(np.diff(self.readings[:, 0])))

    @property
    def span(self) -> tuple[float, float]:
        """First and last time, s."""
        return float(self.readings[0, 0]), float(self.readings[-1, 0])

    def gaps(self) -> list[Gap]:
        """Where more than `GAP` median intervals lie between two readings."""
        t = self.readings[:, 0]
        rows = np.flatnonzero(np.diff(t) > GAP / self.rate * (1.0 + 1e-6))
        return [Gap(float(t[i]), float(t[i + 1])) for i in rows]

    def clipping(self) -> list[Clipping]:
        """Return the axes whose greatest or least value is held for `HELD` readings in a row."""
        found = (self._held(axis, sign) for axis in AXES for sign in (1.0, -1.0))
        return [clipped for clipped in found if clipped is not None]

    def _held(self, axis: str, sign: float) -> Clipping | None:
        f = sign * self.readings[:, COLUMNS.index(axis)]
        if not np.isfinite(f).any() or (level := float(np.nanmax(f))) < CLIPPED:
            return None
        edges = np.diff(np.concatenate(([0], (f == level).astype(int), [0])))
        starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
        if (ends - starts).max() < HELD:
            return None
        first = starts[np.argmax(ends - starts >= HELD)]
        return Clipping(axis, sign * level, int((ends - starts).sum()), float(self.readings[first, 0]))


# -- reading ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Table:
    """One table of a log: a file, or a message of it."""

    name: str
    frame: "pd.DataFrame"
    usual: Mapped  # what ours are called if no map says so
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """Columns of ours from one table: t, and what it has of fx, fy, fz, each with the factor that the map gives."""

    name: str
    t: Array
    force: dict[str, Array]
    factors: dict[str, float | None]


def read_log(paths: Sequence[Path], mapping: str | None = None) -> Recording:
    """Read a log of one file or several.

    Files that hold all axes follow each other; axes of different files (or messages) are brought to the times of the
    one with fx by straight lines. Rows without a time, and those whose time is that of the row before, are left out.

    Parameters
    ----------
    paths
        CSV, Parquet, ULog (needs pyulog) or DataFlash (needs pymavlink); told apart by what they hold.
    mapping
        ``ours=theirs,…``, as in ``t=time,fx=-Ay,fy=ax*9.80665,fz=imu[0].z``; of ULog and DataFlash theirs is
        ``message.field`` or ``message[instance].field``. Without, columns are t, fx, fy, fz; ULog and DataFlash have
        defaults of their own, and their time in seconds.

    Raises
    ------
    ValueError
        One line that names the file, what was found and what to map.
    """
    sources = {} if mapping is None else parse_map(mapping, COLUMNS)
    tables = [table for path in paths for table in _tables(path, sources)]
    remarks = [f"{table.name}: {said}" for table in tables for said in table.remarks]
    pieces = []
    for table in tables:
        with _named(table.name):
            piece = _piece(table, sources, alone=len(tables) == 1, remarks=remarks)
        if piece is None:
            remarks.append(f"{table.name} holds none of {', '.join(AXES)} with a time and is left out")
        else:
            pieces.append(piece)
    names = tuple(path.name for path in paths)
    with _named(", ".join(map(str, paths))):
        missing = [axis for axis in AXES if not any(axis in piece.force for piece in pieces)]
        if missing:
            raise ValueError(_lacks(missing, [str(name) for table in tables for name in table.frame.columns]))
        factors = {axis: factor for piece in pieces for axis, factor in piece.factors.items()}
        _check_factors(factors)
        readings = _merged(pieces)
        recording = Recording(names, mapping or "", readings, (*remarks, *_remarks(readings)))
        _check_rate(recording)
        if not any(factors.values()):  # else somebody has thought of units
            _check_unit(readings[:, 1:])
    return recording


@contextmanager
def _named(name: str) -> Iterator[None]:
    """Put the file's name before what is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def _tables(path: Path, sources: Mapped) -> list[_Table]:
    """Return the tables of a file that the map asks for."""
    try:
        with path.open("rb") as file:
            head = file.read(8)
    except (FileNotFoundError, IsADirectoryError) as error:
        raise ValueError(f"{path}: there is no such file") from error
    with _named(str(path)):
        if head[:4] == b"ULog":
            return _ulog(path, sources)
        if head[:2] == b"\xa3\x95" or head[:4] == b"FMT,":
            return _dataflash(path, sources)
        return [_Table(str(path), _parquet(path) if head[:4] == b"PAR1" else read_table(path), {})]


def _parquet(path: Path) -> "pd.DataFrame":
    import pandas as pd

    try:
        table = pd.read_parquet(path)
    except (ValueError, OSError) as error:  # pyarrow's own errors are both
        raise ValueError(f"not a Parquet file that can be read ({error})") from None
    return table.reset_index() if table.index.name else table


def _piece(table: _Table, sources: Mapped, *, alone: bool, remarks: list[str]) -> _Piece | None:
    """Take ours out of a table; None if it has none of the axes, or no time."""
    found = list(map(str, table.frame.columns))
    wanted = {name: resolved(sources.get(name, table.usual.get(name, Source(name))), found) for name in COLUMNS}
    held = {name: source for name, source in wanted.items() if source.column in found}
    missing = [name for name in COLUMNS if name not in held]
    if "t" in missing and held and not alone:
        missing = ["t"]  # what it lacks besides may be in another file
    if missing and (alone or missing == ["t"]):
        named = [sources[name].column for name in missing if name in sources]
        raise ValueError(_lacks(missing, found, named))
    if "t" in missing or len(held) == 1:
        return None
    values = {name: _values(table.frame, source) for name, source in held.items()}
    t = values.pop("t")
    timed = np.isfinite(t)
    back = np.flatnonzero(np.diff(t[timed]) < 0.0)
    if back.size:
        before, after = t[timed][back[0]], t[timed][back[0] + 1]
        raise ValueError(
            f"time runs backwards: {after:.10g} s comes after {before:.10g} s (row {back[0] + 2}); map t=… to a column "
            f"that rises, of {listed(found)}"
        )
    stated = {axis: "*" in sources[axis].column[len(held[axis].column) :] for axis in values if axis in sources}
    factors = {axis: held[axis].factor if stated.get(axis) else None for axis in values}
    keep = np.flatnonzero(timed)
    keep = keep[np.concatenate(([True], np.diff(t[keep]) > 0.0))] if keep.size else keep
    if not timed.all():
        remarks.append(f"{table.name}: {np.count_nonzero(~timed)} rows have no time and are left out")
    if keep.size < np.count_nonzero(timed):
        remarks.append(f"{table.name}: {np.count_nonzero(timed) - keep.size} rows have the time of the row before")
    force = {name: column[keep] for name, column in values.items()}
    if len(force) == len(AXES) and not any(factors.values()):
        _check_unit(np.column_stack([force[axis] for axis in AXES]))
    return _Piece(table.name, t[keep], force, factors)


def _values(table: "pd.DataFrame", source: Source) -> Array:
    """Return a column as floats; dates are seconds since 1970."""
    if table[source.column].dtype.kind == "M":
        stamps = table[source.column].to_numpy(dtype="datetime64[ns]")
        seconds = stamps.astype("int64") * 1e-9
        return np.where(np.isnat(stamps), np.nan, seconds) * source.factor
    values = np.array(numbers(table, source), dtype=float)
    values[~np.isfinite(values)] = np.nan
    return values


def _lacks(missing: Sequence[str], found: Sequence[str], named: Sequence[str] = ()) -> str:
    what = f"has no column {', '.join(map(repr, named))}" if named else f"lacks {', '.join(missing)}"
    return f"{what}; it has {listed(found)}; say which is which with --map {','.join(f'{n}=…' for n in missing)}"


# -- joining ---------------------------------------------------------------------------------------------------------


def _merged(pieces: list[_Piece]) -> Array:
    """Join pieces: those of the same axes one after the other, different axes at the times of fx."""
    groups: dict[tuple[str, ...], list[_Piece]] = {}
    for piece in pieces:
        groups.setdefault(tuple(piece.force), []).append(piece)
    joined = [_in_a_row(group) for group in groups.values()]
    for axis in AXES:
        holding = [piece.name for piece in joined if axis in piece.force]
        if len(holding) > 1:
            raise ValueError(f"{axis} is found twice, in {holding[0]} and in {holding[1]}: say which with --map")
    base = next(piece for piece in joined if "fx" in piece.force)
    force = dict(base.force)
    for piece in joined:
        if piece is not base:
            if piece.t[-1] < base.t[0] or piece.t[0] > base.t[-1]:
                raise ValueError(f"{base.name} and {piece.name} share no time: map t=… to the same clock")
            force |= {axis: _brought(values, piece.t, base.t) for axis, values in piece.force.items()}
    return np.column_stack([base.t, *(force[axis] for axis in AXES)])


def _in_a_row(pieces: list[_Piece]) -> _Piece:
    ordered = sorted((piece for piece in pieces if piece.t.size), key=lambda piece: float(piece.t[0]))
    if not ordered:
        raise ValueError("no row has a time: map t=…")
    for one, other in pairwise(ordered):
        if other.t[0] <= one.t[-1]:
            raise ValueError(
                f"{other.name} begins at {other.t[0]:.10g} s, before {one.name} ends at {one.t[-1]:.10g} s: two files "
                "with the same axes must follow each other"
            )
    force = {axis: np.concatenate([piece.force[axis] for piece in ordered]) for axis in ordered[0].force}
    return _Piece(", ".join(p.name for p in ordered), np.concatenate([piece.t for piece in ordered]), force, {})


def _brought(values: Array, t: Array, to: Array) -> Array:
    """Straight lines between readings, NaN where there are none: outside, and in gaps."""
    brought = np.interp(to, t, values, left=np.nan, right=np.nan)
    if t.size > 1:
        step = np.diff(t)
        place = np.clip(np.searchsorted(t, to) - 1, 0, step.size - 1)
        brought[(step[place] > GAP * np.median(step)) & ~np.isin(to, t)] = np.nan
    return brought


def _check_factors(factors: Mapping[str, float | None]) -> None:
    """Refuse axes of different units."""
    sizes = {axis: abs(1.0 if factor is None else factor) for axis, factor in factors.items()}
    if max(sizes.values()) > UNEQUAL * min(sizes.values()):
        told = ", ".join(f"{axis} by {size:g}" for axis, size in sizes.items())
        raise ValueError(f"the map mixes units, scaling {told}: map all axes with the same factor")


def _check_rate(recording: Recording) -> None:
    """Refuse too few readings, and times that are no seconds."""
    if len(recording.readings) < FEWEST:
        raise ValueError(f"{len(recording.readings)} rows with a time are too few; at least {FEWEST} are needed")
    if not SLOWEST <= recording.rate <= FASTEST:
        raise ValueError(
            f"{recording.rate:.3g} readings a second, if t is in seconds; from {SLOWEST:g} to {FASTEST:g} are "
            "understood: map t=…*1e-6 if it is in microseconds, t=…*1e-3 if in milliseconds"
        )


def _check_unit(force: Array) -> None:
    """Refuse what looks like another unit than m/s²."""
    sizes = np.linalg.norm(force, axis=1)
    if not np.isfinite(sizes).any():
        raise ValueError(f"no row holds numbers for all of {', '.join(AXES)}: map columns that do")
    middle = float(np.nanmedian(sizes))
    if LOOKS_LIKE_G[0] <= middle <= LOOKS_LIKE_G[1]:
        raise ValueError(
            f"the median of |f| is {middle:.3g}, which looks like g and not m/s²: map fx=…*9.80665 and so on (…*1 if "
            "it is m/s² all the same)"
        )
    if middle > TOO_MUCH:
        raise ValueError(
            f"the median of |f| is {middle:.4g}, which looks like mg or counts and not m/s²: map fx=…*factor and so on"
        )


def _remarks(readings: Array) -> list[str]:
    """Say how many readings lack a number."""
    lacking = int(np.count_nonzero(~np.isfinite(readings[:, 1:]).all(axis=1)))
    return [f"{lacking} readings lack an axis: the detector passes over them"] if lacking else []


# -- other people's formats ------------------------------------------------------------------------------------------


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


def _ulog(path: Path, sources: Mapped) -> list[_Table]:
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
        tables.append(_Table(str(path), pd.DataFrame(columns), usual))
    end = max(float(table.frame[table.usual["t"].column].iloc[-1]) * 1e-6 for table in tables)
    if said := _damage(path, corrupt=log.file_corruption):
        tables[0] = _Table(str(path), tables[0].frame, tables[0].usual, (f"the ULog {said}; it ends at {end:.3f} s",))
    return tables


def _damage(path: Path, *, corrupt: bool) -> str:
    """Say what is wrong with a ULog: whether its last message is whole (a ULog has no end mark), or what pyulog saw."""
    content, at = path.read_bytes(), 16  # B, the header
    while at + 3 <= len(content):
        at += 3 + int.from_bytes(content[at : at + 2], "little")
    if at != len(content):
        return "is truncated: what could be read is replayed"
    return "is damaged: what could be read is replayed" if corrupt else ""


def _dataflash(path: Path, sources: Mapped) -> list[_Table]:
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
        tables.append(_Table(str(path), table, usual))
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


# -- replay ----------------------------------------------------------------------------------------------------------


def replay_log(recording: Recording, settings: launch.DetectorSettings | None = None) -> Flight:
    """Run the launch detector over a recording.

    After a detection the detector is left alone for `PAUSE`, then reset: later ones are found, too, and a force that
    lasts longer than that is found again.

    Parameters
    ----------
    recording
        Readings.
    settings
        Of the detector; without, it is that of the packaged scenarios.

    Returns
    -------
    Flight
        Tables 'accelerometer' and 'detector' (every reading); an event ``launch_detected`` a detection; a score with
        ``launch.detected_time`` (the first), null for what needs the truth, and ``recording``: files, rate, gaps,
        clipping, all detections. Its ``scenario`` says what was replayed, and does not fly.
    """
    rate = recording.rate
    detector = launch.default(rate=rate) if settings is None else launch.build(settings, rate)
    columns, detections = _watch(detector, recording.readings)
    t, fx, fy, fz = recording.readings.T
    tables = {
        "accelerometer": frame("accelerometer", {"t": t, "fx": fx, "fy": fy, "fz": fz}),
        "detector": frame("detector", {"t": t, **columns}),
    }
    events = [{"t": when, "event": "launch_detected"} for when in detections]
    used = launch.DetectorSettings() if settings is None else settings
    about: dict[str, Any] = {
        "name": recording.files[0],
        "recording": {"files": list(recording.files), "map": recording.mapping, "rate": rate},
        "detector": asdict(used),
    }
    return Flight(about, tables, events, _score(recording, used.kind, detections))


def _watch(detector: Any, readings: Array) -> tuple[dict[str, NDArray[Any]], list[float]]:
    """Return the detector's state at each reading, and when it recognised a launch."""
    level, count, total = array("q"), array("q"), array("q")
    triggered, recognised = array("b"), array("b")
    detections: list[float] = []
    resume = np.inf
    step = detector.step
    for t, fx, fy, fz in readings.tolist():
        if t >= resume:
            detector.reset()
            resume = np.inf
        seen = step(t, fx, fy, fz)
        if seen:
            detections.append(t)
            resume = t + PAUSE
        level.append(detector.level)
        count.append(detector.count)
        total.append(detector.total)
        triggered.append(detector.triggered)
        recognised.append(seen)
    whole = {name: np.array(values) for name, values in (("level", level), ("count", count), ("total", total))}
    flags = {name: np.array(v, dtype=bool) for name, v in (("triggered", triggered), ("recognised", recognised))}
    return {**whole, **flags}, detections


def _score(recording: Recording, kind: str, detections: list[float]) -> dict[str, Any]:
    start, end = recording.span
    nothing = dict.fromkeys((*_AIRSPEED, "samples"))
    return {
        "outcome": None,
        "expected": None,
        "seed": None,
        "versions": {"uavsim": __version__, "numpy": version("numpy")},
        "launch": {
            "release_time": None,
            "true_time": None,
            "crossing_time": None,
            "detected_time": detections[0] if detections else None,
            "latency": None,
            "latency_from_crossing": None,
            "false_detections": None,
            "detector": kind,
        },
        "airspeed": {**nothing, **{phase: dict(nothing) for phase in ("stroke", "transition", "cruise")}},
        "pressure": {name: dict.fromkeys(_PRESSURE) for name in ("total", "static")},
        "flight": {**dict.fromkeys(_FLIGHT), "duration": end - start},
        "requirements": [],
        "recording": {
            "files": list(recording.files),
            "map": recording.mapping,
            "start": start,
            "end": end,
            "readings": len(recording.readings),
            "rate": recording.rate,
            "gaps": [asdict(gap) for gap in recording.gaps()],
            "clipping": [asdict(clipped) for clipped in recording.clipping()],
            "detections": detections,
            "pause": PAUSE,
            "remarks": list(recording.remarks),
        },
    }
