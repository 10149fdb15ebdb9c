"""A log's tables turned into one recording: which column is which, in what unit, and files joined on time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from sensors.bench_log import LATEST, MOST_READ, Source, listed, numbers, parse_map, resolved
from sensors.tables import MOST_ROWS
from sensors.text import brief
from uavsim.logs.formats import Mapped, Table, named, read_tables
from uavsim.logs.known import COUNTS
from uavsim.logs.recording import AXES, COLUMNS, GAP, SAMPLED_AND_HELD, SERIES, Array, Origin, Recording, Series
from uavsim.logs.stamps import FEWEST, BackwardsError, Stamped, stamped
from uavsim.logs.wraps import suspected, unwrapped
from uavsim.truth import STANDARD_GRAVITY

SLOWEST, FASTEST = 1.0, 20_000.0  # Hz, median rates that are understood
SLOW = 20.0  # Hz, below which a stroke of 0.3 s has a handful of readings
FAST = 5_000.0  # Hz, by hand: accelerometers of autopilots give up to 4 kHz; 100 Hz read so if t is in minutes
OTHER = "other "  # before the label of a message of another accelerometer
LOOKS_LIKE_G = (0.7, 1.4)  # median of |f|: at rest and in level flight it is 1 in g and 9.8 in m/s²
TOO_MUCH = 400.0  # m/s², median of |f|: no flight feels 40 g for most of the time, counts and mg read so
STRETCH = 25  # readings that are averaged to tell a force from noise about none
UNEQUAL = 1.2  # ratio of the axes' factors above which their units are mixed


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Columns of ours from one table: t, what it has of fx, fy, fz, with the map's factors, and what else."""

    name: str
    t: Array
    force: dict[str, Array]
    factors: dict[str, float | None]
    series: dict[str, Series] = field(default_factory=dict)
    cuts: list[int] = field(default_factory=list)
    other: str = ""  # the name of another accelerometer than that which is replayed
    origins: dict[str, Origin] = field(default_factory=dict)


def read_log(paths: Sequence[Path], mapping: str | None = None) -> Recording:
    """Read a log of one file or several.

    Files that hold all axes follow each other; axes of different files (or messages) are brought to the times of the
    one with fx by straight lines. Rows without a time, those whose time is that of the row before, and those whose time
    alone is out of order are left out; where the clock begins anew, or the rate changes, the log is cut into parts.

    Parameters
    ----------
    paths
        Text (CSV and its kin), Parquet, Feather, ULog, DataFlash or tlog, told apart by what they hold; also packed by
        gzip, bzip2, xz or zip.
    mapping
        ``ours=theirs,…``, as in ``t=time,fx=-Ay,fy=ax*9.80665+0.3,fz=imu[0].z``; of autopilots' logs theirs is
        ``message.field`` or ``message[instance].field``. Without, columns are t, fx, fy, fz, or names that leave no
        doubt, which is told; autopilots' logs have defaults of their own, and their time in seconds.

    Raises
    ------
    ValueError
        One line that names the file, what was found and what to map.
    """
    sources = sources_of(mapping)
    return recording_of(paths, mapping, [table for path in paths for table in read_tables(path, sources)])


def sources_of(mapping: str | None) -> dict[str, Source]:
    """Return what a map says."""
    return {} if mapping is None else parse_map(mapping, (*COLUMNS, *SERIES))


def recording_of(paths: Sequence[Path], mapping: str | None, tables: Sequence[Table]) -> Recording:
    """Return the recording that tables are; see `read_log`."""
    sources = sources_of(mapping)
    remarks = [f"{table.name}: {said}" for table in tables for said in table.remarks]
    pieces = []
    for table in tables:
        with named(table.name):
            piece = _piece(table, _of_other(table, sources), alone=len(tables) == 1, remarks=remarks)
        if piece is None and table.label.startswith(OTHER):
            continue  # the map is of columns that it does not have
        if piece is None:
            remarks.append(f"{table.name} holds none of {', '.join(AXES)} with a time and is left out")
        else:
            pieces.append(piece)
    names = tuple(path.name for path in paths)
    with named(", ".join(map(str, paths))):
        check_found(sources, tables)
        others = {piece.other: _table_of(piece) for piece in pieces if piece.other}
        pieces = [piece for piece in pieces if not piece.other]
        series = _series(pieces)
        pieces = [piece for piece in pieces if piece.force]
        if not pieces or not any("fx" in piece.force or set(piece.force) & set(sources) for piece in pieces):
            missing = [axis for axis in AXES if not any(axis in piece.force for piece in pieces)]
            raise ValueError(lacks(missing, [name for table in tables for name in table.columns], tables=tables))
        factors = {axis: factor for piece in pieces for axis, factor in piece.factors.items()}
        check_factors(factors)
        readings, cuts, unwrapped = _merged(pieces)
        remarks += unwrapped
        if len(readings) > MOST_ROWS:
            raise ValueError(f"{len(readings)} rows; at most {MOST_ROWS} are replayed")
        said = (*remarks, *_remarks(readings))
        origins = {name: origin for piece in reversed(pieces) for name, origin in piece.origins.items()}
        recording = Recording(names, mapping or "", readings, said, series, tuple(cuts), others, origins)
        _check_rate(recording)
        _check_numbers(readings[:, 1:])
        if not any(factors.values()):  # else somebody has thought of units
            check_unit(readings[:, 1:])
    return recording


def _piece(table: Table, sources: Mapped, *, alone: bool, remarks: list[str]) -> Piece | None:
    """Take ours out of a table; None if it has none of the axes, or no time."""
    found = table.columns
    wanted = {name: source_of(name, table, sources) for name in (*COLUMNS, *SERIES)}
    held = {name: source for name, source in wanted.items() if source.column in found}
    axes = [axis for axis in AXES if axis in held]
    lacking = [name for name in COLUMNS if name in sources and name not in held]
    headless = "fx" not in axes and not set(axes) & set(sources)
    if ("t" not in held and (held or alone)) or (alone and (lacking or headless)):
        missing = lacking or [name for name in COLUMNS if name not in held]
        if not alone and "t" in missing:
            missing = ["t"]  # what it lacks besides may be in another file
        raise ValueError(lacks(missing, found, [sources[name].column for name in missing if name in sources], [table]))
    if "t" not in held or len(held) == 1:
        return None
    values = _values(table, held, remarks)
    t = values.pop("t")
    scale = 1.0
    if table.counts and axes:
        scale = one_g(np.column_stack([values[axis] for axis in axes]), table.name, remarks)
        values |= {axis: values[axis] * scale for axis in axes}
    try:
        clock = held["t"]
        columns = np.column_stack([*values.values()])
        rows = stamped(t, abs(clock.factor), columns, of_day=clock.column in table.of_day)
    except BackwardsError as error:
        raise ValueError(f"{error}; map t=… to a column that rises, of {listed(found)}") from None
    where = f"{table.name}: {table.label}: " if table.label else f"{table.name}: "
    remarks += [f"{where}{said}" for said in rows.remarks]
    stated = {axis: "*" in sources[axis].column[len(held[axis].column) :] for axis in axes if axis in sources}
    known = not any(axis in sources for axis in axes) and (table.counts or is_scaled(held, axes))
    factors = {axis: held[axis].factor if stated.get(axis) or known else None for axis in axes}
    force = {axis: values[axis][rows.rows] for axis in axes}
    if len(force) == len(AXES) and not any(factors.values()):
        check_unit(np.column_stack([force[axis] for axis in AXES]))
    series = _series_of(table, held, values, rows, remarks)
    other = table.label.removeprefix(OTHER) if table.label.startswith(OTHER) else ""
    origins = {
        axis: Origin(replace(held[axis], factor=held[axis].factor * scale), factors[axis] is not None) for axis in axes
    }
    if not table.named:
        origins["t"] = Origin(clock)
    return Piece(table.name, rows.t, force, factors, series, rows.cuts, other, origins)


def _of_other(table: Table, sources: Mapped) -> Mapped:
    """Return a map as it is for another accelerometer: of the same fields of its own message."""
    if not table.label.startswith(OTHER):
        return sources
    own = table.label.removeprefix(OTHER)
    first = f"{own.partition('[')[0]}."
    return {ours: replace(one, column=one.column.replace(first, f"{own}.", 1)) for ours, one in sources.items()}


def is_scaled(held: Mapped, axes: Sequence[str]) -> bool:
    """Whether the axes have a unit that was known without a map."""
    return any(abs(held[axis].factor) != 1.0 or held[axis].offset for axis in axes)


def check_found(sources: Mapped, tables: Sequence[Table]) -> None:
    """Refuse a map that names columns which no table has."""
    held = {
        ours
        for table in tables
        for ours, source in sources.items()
        if resolved(source, table.columns).column in table.columns
    }
    if lacking := [ours for ours in sources if ours not in held]:
        found = [name for table in tables for name in table.columns]
        raise ValueError(lacks(lacking, found, [sources[ours].column for ours in lacking], tables))


def source_of(name: str, table: Table, sources: Mapped) -> Source:
    """Where one of ours comes from in a table: as the map says, as it is usual there, or by its own name."""
    found = table.columns
    usual = table.usual.get(name, Source(name))
    if name not in sources:
        return Source(name) if name in found and name not in table.usual else usual
    mapped = resolved(sources[name], found)
    if mapped.column not in found and name == "t" and (usual.column in found):
        return usual  # a clock of the same name is not in every file
    return mapped


def _series_of(
    table: Table, held: Mapped, values: Mapping[str, Array], rows: Stamped, remarks: list[str]
) -> dict[str, Series]:
    """What a table has besides force; of a log whose clock began anew the longest part."""
    names = [name for name in held if name in SERIES]
    if not names:
        return {}
    parts = list(pairwise((0, *rows.cuts, rows.t.size)))
    clocks = [parts[0]] if parts else []
    for part in parts[1:]:  # where only the rate changed, the clock goes on
        if rows.t[part[0]] > rows.t[part[0] - 1]:
            clocks[-1] = (clocks[-1][0], part[1])
        else:
            clocks.append(part)
    start, end = max(clocks, key=lambda part: part[1] - part[0])
    if len(clocks) > 1:
        remarks.append(f"{table.name}: of {', '.join(names)} the longest part is kept, for the clock begins anew")
    chosen = rows.rows[start:end]
    return {
        name: Series(name, rows.t[start:end], values[name][chosen], f"{Path(table.name).name}: {held[name].column}")
        for name in names
    }


def _values(table: Table, held: Mapped, remarks: list[str]) -> dict[str, Array]:
    """Return ours as numbers, and tell what is beyond all readings."""
    read = table.read({source.column for source in held.values()})
    remarks += [f"{table.name}: {said}" for said in table.later()]
    values = {}
    for name, source in held.items():
        try:
            values[name], beyond = numbers(read[source.column], source, name)
        except ValueError:
            if name in COLUMNS or len(held) == 1:
                raise
            values[name] = np.full(read[source.column].shape, np.nan)
            remarks.append(f"{table.name}: column {brief(source.column)!r} holds no numbers: there is no {name}")
            continue
        if beyond:
            most, what = (LATEST, "time") if name == "t" else (MOST_READ, "reading")
            remarks.append(f"{table.name}: {beyond} numbers of {name} are beyond ±{most:g} and count as no {what}")
    return values


def one_g(force: Array, name: str, remarks: list[str]) -> float:
    """Return what one count is, m/s²: 1 g is the power of two that is next to the median of |f|."""
    sizes = np.sqrt(np.nansum(force**2, axis=1))
    middle = float(np.median(sizes)) if sizes.size else 0.0
    counts = min(COUNTS, key=lambda each: abs(np.log(each / max(middle, 1e-9))))
    if not 0.7 < middle / counts < 1.4:
        raise ValueError(
            f"the median of |f| is {middle:.4g} counts, and what 1 g is cannot be told: map fx=…*factor and so on"
        )
    remarks.append(f"{name}: counts are brought to m/s²: 1 g is taken to be {counts} counts, by the median of |f|")
    return STANDARD_GRAVITY / counts


def lacks(missing: Sequence[str], found: Sequence[str], named: Sequence[str] = (), tables: Sequence[Table] = ()) -> str:
    """Say what is lacking, what there is, and what to map."""
    what = f"has no column {', '.join(repr(brief(name)) for name in named)}" if named else f"lacks {', '.join(missing)}"
    if any(not table.named for table in tables):
        return (
            f"{what}; it has no line of names, and {len(found)} columns: say which is which by their numbers, with "
            f"--map t=1,fx=2,fy=3,fz=4 or as they stand"
        )
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


def _merged(pieces: list[Piece]) -> tuple[Array, list[int], list[str]]:
    """Join pieces: those of the same axes one after the other, different axes at the times of fx."""
    groups: dict[tuple[str, ...], list[Piece]] = {}
    for piece in pieces:
        groups.setdefault(tuple(piece.force), []).append(piece)
    joined = [_in_a_row(group) for group in groups.values()]
    for axis in AXES:
        holding = [piece.name for piece in joined if axis in piece.force]
        if len(holding) > 1:
            raise ValueError(f"{axis} is found twice, in {holding[0]} and in {holding[1]}: say which with --map")
    base = next(piece for axis in AXES for piece in joined if axis in piece.force)
    force = dict(base.force)
    for piece in joined:
        if piece is not base:
            if _goes_back(piece) or _goes_back(base):
                raise ValueError(
                    f"the clock of {piece.name} or {base.name} begins anew: axes of two files cannot be joined"
                )
            if piece.t[-1] < base.t[0] or piece.t[0] > base.t[-1]:
                raise ValueError(f"{base.name} and {piece.name} share no time: map t=… to the same clock")
            force |= {axis: _brought(values, piece.t, base.t) for axis, values in piece.force.items()}
    remarks = []
    for axis, values in force.items():
        force[axis], said = unwrapped(values, axis)
        remarks += said or suspected(values, base.t, axis)
    return _table_of(Piece(base.name, base.t, force, {})), base.cuts, remarks


def _goes_back(piece: Piece) -> bool:
    return bool((np.diff(piece.t) <= 0.0).any())


def _table_of(piece: Piece) -> Array:
    """Return t, fx, fy, fz; an axis that is not there is NaN."""
    return np.column_stack([piece.t, *(piece.force.get(axis, np.full(piece.t.size, np.nan)) for axis in AXES)])


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
    cuts, before = [], 0
    for piece in ordered:
        cuts += [before + cut for cut in piece.cuts]
        before += piece.t.size
    names, t = ", ".join(piece.name for piece in ordered), np.concatenate([piece.t for piece in ordered])
    return Piece(names, t, force, {}, cuts=cuts)


def _brought(values: Array, t: Array, to: Array) -> Array:
    """Straight lines between readings, NaN where there are none: outside, and in gaps."""
    brought = np.interp(to, t, values, left=np.nan, right=np.nan)
    if t.size > 1:
        step = np.diff(t)
        place = np.clip(np.searchsorted(t, to) - 1, 0, step.size - 1)
        brought[(step[place] > GAP * np.median(step)) & ~np.isin(to, t)] = np.nan
    return brought


def check_factors(factors: Mapping[str, float | None]) -> None:
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
    """Refuse readings of which none has all axes that the log holds."""
    held = np.isfinite(force)
    if not held[:, held.any(axis=0)].all(axis=1).any() or not held.any():
        raise ValueError(f"no row holds numbers for all of {', '.join(AXES)}: map columns that do")


def check_unit(force: Array) -> None:
    """Refuse what looks like another unit than m/s²."""
    _check_numbers(force)
    if not np.isfinite(force).any(axis=0).all():
        return  # of one axis alone the rest may be anything
    sizes = np.linalg.norm(force, axis=1)
    middle = float(np.nanmedian(sizes))
    if LOOKS_LIKE_G[0] <= middle <= LOOKS_LIKE_G[1] and _about(force) >= LOOKS_LIKE_G[0]:
        raise ValueError(
            f"the median of |f| is {middle:.3g}, which looks like g and not m/s²: map fx=…*9.80665 and so on (…*1 if "
            "it is m/s² all the same)"
        )
    if middle > TOO_MUCH:
        raise ValueError(
            f"the median of |f| is {middle:.4g}, which looks like mg or counts and not m/s²: map "
            f"fx=…*{STANDARD_GRAVITY / middle:.4g} and so on, by which it is 1 g"
        )


def _about(force: Array) -> float:
    """Median of what |f| is about: noise alone, as where gravity has been taken off, is about 0."""
    whole = len(force) // STRETCH * STRETCH
    stretches = (force[:whole] if whole else force).reshape(-1, min(STRETCH, len(force)), len(AXES))
    return float(np.median(np.linalg.norm(np.nan_to_num(stretches).mean(axis=1), axis=1)))


def _remarks(readings: Array) -> list[str]:
    """Say how many readings lack a number."""
    held = np.isfinite(readings[:, 1:])
    there = np.atleast_1d(held.any(axis=0))
    said = []
    if 0 < np.count_nonzero(there) < len(AXES):
        absent = [axis for axis, is_there in zip(AXES, there.tolist(), strict=True) if not is_there]
        said.append(f"the log holds no {', '.join(absent)}: one axis is enough for a detector that reads one")
    if lacking := int(np.count_nonzero(~held[:, there].all(axis=1))):
        said.append(f"{lacking} readings lack an axis: the detector passes over them")
    same = np.all((readings[1:, 1:] == readings[:-1, 1:]) | ~held[1:], axis=1)
    if (share := float(np.mean(same)) if same.size else 0.0) > SAMPLED_AND_HELD:
        said.append(f"readings repeat: {share:.0%} of the rows are as those before, as of a sensor slower than the log")
    rate = 1.0 / max(float(np.median(np.diff(readings[:, 0]))), 1e-9) if len(readings) > 1 else np.inf
    if rate > FAST:
        said.append(f"{rate:.4g} readings a second are many: is t in s? Map t=…*60 if it is in minutes")
    if rate < SLOW:
        said.append(f"{rate:.3g} readings a second are few: a stroke may lie between two of them")
    return said
