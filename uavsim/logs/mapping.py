"""A log's tables turned into one recording: which column is which, in what unit, and files joined on time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from sensors.bench_log import LATEST, MOST_READ, Source, listed, numbers, parse_map, resolved
from sensors.tables import MOST_ROWS, brief
from uavsim.logs.formats import Mapped, Table, named, read_tables
from uavsim.logs.recording import AXES, COLUMNS, GAP, SERIES, Array, Recording, Series

SLOWEST, FASTEST = 10.0, 20_000.0  # Hz, median rates that are understood
FEWEST = 10  # readings
LOOKS_LIKE_G = (0.7, 1.4)  # median of |f|: at rest and in level flight it is 1 in g and 9.8 in m/s²
TOO_MUCH = 400.0  # m/s², median of |f|: no flight feels 40 g for most of the time, counts and mg read so
UNEQUAL = 1.2  # ratio of the axes' factors above which their units are mixed


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Columns of ours from one table: t, what it has of fx, fy, fz, with the map's factors, and what else."""

    name: str
    t: Array
    force: dict[str, Array]
    factors: dict[str, float | None]
    series: dict[str, Series] = field(default_factory=dict)


def read_log(paths: Sequence[Path], mapping: str | None = None) -> Recording:
    """Read a log of one file or several.

    Files that hold all axes follow each other; axes of different files (or messages) are brought to the times of the
    one with fx by straight lines. Rows without a time, and those whose time is that of the row before, are left out.

    Parameters
    ----------
    paths
        CSV, Parquet, ULog or DataFlash, told apart by what they hold; also packed by gzip, bzip2, xz or zip.
    mapping
        ``ours=theirs,…``, as in ``t=time,fx=-Ay,fy=ax*9.80665,fz=imu[0].z``; of ULog and DataFlash theirs is
        ``message.field`` or ``message[instance].field``. Without, columns are t, fx, fy, fz; ULog and DataFlash have
        defaults of their own, and their time in seconds.

    Raises
    ------
    ValueError
        One line that names the file, what was found and what to map.
    """
    sources = {} if mapping is None else parse_map(mapping, (*COLUMNS, *SERIES))
    tables = [table for path in paths for table in read_tables(path, sources)]
    remarks = [f"{table.name}: {said}" for table in tables for said in table.remarks]
    pieces = []
    for table in tables:
        with named(table.name):
            piece = _piece(table, sources, alone=len(tables) == 1, remarks=remarks)
        if piece is None:
            remarks.append(f"{table.name} holds none of {', '.join(AXES)} with a time and is left out")
        else:
            pieces.append(piece)
    names = tuple(path.name for path in paths)
    with named(", ".join(map(str, paths))):
        series = _series(pieces)
        pieces = [piece for piece in pieces if piece.force]
        missing = [axis for axis in AXES if not any(axis in piece.force for piece in pieces)]
        if missing:
            raise ValueError(_lacks(missing, [name for table in tables for name in table.columns]))
        factors = {axis: factor for piece in pieces for axis, factor in piece.factors.items()}
        _check_factors(factors)
        readings = _merged(pieces)
        if len(readings) > MOST_ROWS:
            raise ValueError(f"{len(readings)} rows; at most {MOST_ROWS} are replayed")
        recording = Recording(names, mapping or "", readings, (*remarks, *_remarks(readings)), series)
        _check_rate(recording)
        _check_numbers(readings[:, 1:])
        if not any(factors.values()):  # else somebody has thought of units
            _check_unit(readings[:, 1:])
    return recording


def _piece(table: Table, sources: Mapped, *, alone: bool, remarks: list[str]) -> Piece | None:
    """Take ours out of a table; None if it has none of the axes, or no time."""
    found = table.columns
    wanted = {name: resolved(sources.get(name, table.usual.get(name, Source(name))), found) for name in COLUMNS}
    held = {name: source for name, source in wanted.items() if source.column in found}
    missing = [name for name in COLUMNS if name not in held]
    if "t" in missing and held and not alone:
        missing = ["t"]  # what it lacks besides may be in another file
    others = {name: resolved(sources.get(name, table.usual.get(name, Source(name))), found) for name in SERIES}
    others = {name: source for name, source in others.items() if source.column in found}
    if missing and (alone or missing == ["t"]):
        named = [sources[name].column for name in missing if name in sources]
        raise ValueError(_lacks(missing, found, named))
    if "t" in missing or len(held) + len(others) == 1:
        return None
    values = _values(table, {**held, **others}, remarks)
    t = values.pop("t")
    timed = np.isfinite(t)
    back = np.flatnonzero(np.diff(t[timed]) < 0.0)
    if back.size:
        before, after = t[timed][back[0]], t[timed][back[0] + 1]
        raise ValueError(
            f"time runs backwards: {after:.10g} s comes after {before:.10g} s (row {back[0] + 2}); map t=… to a column "
            f"that rises, of {listed(found)}"
        )
    axes = [axis for axis in AXES if axis in values]
    stated = {axis: "*" in sources[axis].column[len(held[axis].column) :] for axis in axes if axis in sources}
    factors = {axis: held[axis].factor if stated.get(axis) else None for axis in axes}
    keep = np.flatnonzero(timed)
    keep = keep[np.concatenate(([True], np.diff(t[keep]) > 0.0))] if keep.size else keep
    if not timed.all():
        remarks.append(f"{table.name}: {np.count_nonzero(~timed)} rows have no time and are left out")
    if keep.size < np.count_nonzero(timed):
        remarks.append(f"{table.name}: {np.count_nonzero(timed) - keep.size} rows have the time of the row before")
    force = {name: values[name][keep] for name in axes}
    if len(force) == len(AXES) and not any(factors.values()):
        _check_unit(np.column_stack([force[axis] for axis in AXES]))
    series = {
        name: Series(name, t[keep], values[name][keep], f"{table.name}: {source.column}")
        for name, source in others.items()
    }
    return Piece(table.name, t[keep], force, factors, series)


def _values(table: Table, held: Mapped, remarks: list[str]) -> dict[str, Array]:
    """Return ours as numbers, and tell what is beyond all readings."""
    read = table.read({source.column for source in held.values()})
    values = {}
    for name, source in held.items():
        values[name], beyond = numbers(read[source.column], source, name)
        if beyond:
            most, what = (LATEST, "time") if name == "t" else (MOST_READ, "reading")
            remarks.append(f"{table.name}: {beyond} numbers of {name} are beyond ±{most:g} and count as no {what}")
    return values


def _lacks(missing: Sequence[str], found: Sequence[str], named: Sequence[str] = ()) -> str:
    what = f"has no column {', '.join(repr(brief(name)) for name in named)}" if named else f"lacks {', '.join(missing)}"
    return f"{what}; it has {listed(found)}; say which is which with --map {','.join(f'{n}=…' for n in missing)}"


def _series(pieces: Sequence[Piece]) -> dict[str, Series]:
    """What the pieces hold besides force; of one that follow each other those of the same name are joined."""
    found: dict[str, Series] = {}
    for piece in sorted((piece for piece in pieces if piece.t.size), key=lambda piece: float(piece.t[0])):
        for name, one in piece.series.items():
            before = found.get(name)
            if before is not None and one.t[0] <= before.t[-1]:
                raise ValueError(f"{name} is found twice, in {before.source} and in {one.source}: say which with --map")
            found[name] = one if before is None else _behind(before, one)
    return found


def _behind(before: Series, after: Series) -> Series:
    t, values = np.concatenate((before.t, after.t)), np.concatenate((before.values, after.values))
    return Series(before.name, t, values, f"{before.source}, {after.source}")


# -- joining ---------------------------------------------------------------------------------------------------------


def _merged(pieces: list[Piece]) -> Array:
    """Join pieces: those of the same axes one after the other, different axes at the times of fx."""
    groups: dict[tuple[str, ...], list[Piece]] = {}
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


def _in_a_row(pieces: list[Piece]) -> Piece:
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
    return Piece(", ".join(p.name for p in ordered), np.concatenate([piece.t for piece in ordered]), force, {})


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


def _check_numbers(force: Array) -> None:
    """Refuse readings of which none has all axes."""
    if not np.isfinite(force).all(axis=1).any():
        raise ValueError(f"no row holds numbers for all of {', '.join(AXES)}: map columns that do")


def _check_unit(force: Array) -> None:
    """Refuse what looks like another unit than m/s²."""
    _check_numbers(force)
    sizes = np.linalg.norm(force, axis=1)
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
