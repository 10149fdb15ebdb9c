"""A bench log of somebody's own part: a table with a time and readings, brought to SI and to equal spacing.

The statistics of `sensors.characterise` need equally spaced readings, and real logs have gaps, jittering stamps and
rows that are no numbers. Rows that are no numbers are dropped, what is missing is filled by straight lines as long as
that is little, and everything that was done is counted and told.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sensors.files import look
from sensors.tables import table_of
from sensors.text import brief

Array = NDArray[np.float64]

SPREAD = 64  # intervals in a stretch by which the rate is told: stamps may be rounded to much of an interval
GAP = 1.5  # intervals beyond which readings are missing
MOST_FILLED = 0.05  # share of readings that may be filled in; beyond, the longest stretch without a gap is taken
MOST_MISSING = 1e11  # readings in a gap, as they are counted: ten million such gaps are a whole number of 64 bits
FEWEST = 1000  # readings
SLOWEST, FASTEST = 0.01, 20_000.0  # Hz: what an accelerometer or a barometer gives, with a margin
_DIGITS = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
FACTOR = re.compile(rf"(.+?)\*\s*([-+]?{_DIGITS})", re.DOTALL)
OFFSET = re.compile(rf"(.+?)([-+])\s*({_DIGITS})", re.DOTALL)
LEAST_FACTOR, MOST_FACTOR = 1e-15, 1e15  # of a map: from femtoseconds to seconds, and back
MOST_OFFSET = 1e15  # of a map: milliseconds since 1970 are 2e12
MOST_READ = 1e12  # SI, of a reading: what is beyond is none, and its square still is a number
LATEST = 1e20  # s, of a time: what is beyond is none; nanoseconds since 1970 that count as seconds are below
LONGEST_MAP = 10_000  # characters


@dataclass(frozen=True, slots=True)
class Source:
    """Where a column comes from: a column of the file times a factor, plus an offset; see `resolved`."""

    column: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class BenchLog:
    """A log, equally spaced and in SI.

    Attributes
    ----------
    name : str
        The file's.
    columns : tuple of str
        t and what was asked for and found.
    table : numpy.ndarray
        Shape (n, len(columns)); t in s.
    rate : float
        Readings a second, Hz.
    dropped : int
        Rows that held something else than numbers.
    gaps, missing : int
        Places where readings are missing, and how many are.
    filled : bool
        Whether they were filled in by straight lines; else the longest stretch between gaps was taken.
    jitter : float
        Standard deviation of the intervals, s, gaps apart.
    """

    name: str
    columns: tuple[str, ...]
    table: Array
    rate: float
    dropped: int
    gaps: int
    missing: int
    filled: bool
    jitter: float

    @property
    def duration(self) -> float:
        """From the first to the last reading, s."""
        return float(self.table[-1, 0] - self.table[0, 0])

    def remarks(self) -> list[str]:
        """Say what was not as it should be, a sentence each."""
        said = []
        if self.dropped:
            said.append(f"{self.dropped} rows hold something else than numbers and are left out")
        if self.gaps:
            what = "filled in by straight lines" if self.filled else "the longest stretch without a gap is taken"
            said.append(f"{self.missing} readings are missing in {self.gaps} gaps: {what}")
        if self.jitter > 0.01 / self.rate:
            share = 100.0 * self.jitter * self.rate
            said.append(
                f"the time stamps jitter by {1e3 * self.jitter:.3g} ms (1 sd), {share:.3g} % of the interval: "
                "the readings count as equally spaced"
            )
        return said


def parse_map(text: str, known: Sequence[str]) -> dict[str, Source]:
    """Return the columns of `ours=theirs,…`; theirs may end in a factor and an offset, as in `fx=ax*9.80665+0.3`.

    Raises
    ------
    ValueError
        If it is not of that form, names a column of ours that is not `known`, or one twice.
    """
    if len(text) > LONGEST_MAP:
        raise ValueError(f"a map of {len(text)} characters; at most {LONGEST_MAP} are read")
    found: dict[str, Source] = {}
    for part in text.split(","):
        ours, sign, theirs = (piece.strip() for piece in part.partition("="))
        if not (ours and sign and theirs):
            raise ValueError(f"{part.strip()[:40]!r}: give it as ours=theirs,… as in t=time,{known[1]}=column*factor")
        if ours not in known:
            raise ValueError(f"{brief(ours)!r} is no column of ours; they are {', '.join(known)}")
        if ours in found:
            raise ValueError(f"{ours!r} is given twice")
        found[ours] = Source(theirs)
    return found


def read_bench_log(
    path: Path, columns: Sequence[str], optional: Sequence[str] = (), mapping: Mapping[str, Source] | None = None
) -> BenchLog:
    """Read a log.

    Parameters
    ----------
    path : Path
        A CSV file with a line of names, separated by commas, semicolons or tabs, or a Parquet file.
    columns, optional : sequence of str
        What is needed, t first, and what is taken if it is there; SI.
    mapping : mapping, optional
        Which column of the file each of ours is, as `parse_map` gives it; the others have the same name.

    Raises
    ------
    ValueError
        One line that names the file: if it is no such table, lacks a column, is too short, its time does not rise, or
        it cannot be read.
    """
    try:
        table = table_of(look(path))
        wanted = _sources(table.names, columns, optional, mapping or {})
        names = tuple(wanted)
        read = table.read({source.column for source in wanted.values()})
        values = np.column_stack([numbers(read[source.column], source, name)[0] for name, source in wanted.items()])
        good = np.isfinite(values).all(axis=1)
        dropped, values = int(np.count_nonzero(~good)), values[good]
        return _evenly(path.name, names, values, dropped)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _sources(
    found: Sequence[str], columns: Sequence[str], optional: Sequence[str], mapping: Mapping[str, Source]
) -> dict[str, Source]:
    """Return where each column of ours comes from."""
    wanted = {}
    for name in (*columns, *optional):
        source = resolved(mapping.get(name, Source(name)), found)
        if source.column in found:
            wanted[name] = source
        elif name in mapping or name in columns:
            lacking = [n for n in columns if n not in mapping and n not in found] or [name]
            hint = f"has no column {brief(source.column)!r}" if name in mapping else f"lacks {', '.join(lacking)}"
            ours = ",".join(f"{n}=…" for n in lacking)
            raise ValueError(f"{hint}; it has {listed(found)}; say which is which with --map {ours}")
    return wanted


def resolved(source: Source, found: Sequence[str]) -> Source:
    """Split sign, factor and offset off a name that is not itself a column: `-Ay`, `ax*9.80665`, `-ax*9.80665+0.3`.

    Raises
    ------
    ValueError
        If the factor is 0, or none that a unit can have, or the offset is beyond what can be.
    """
    whole = source.column
    signed = [(whole, 1.0)] + (
        [(whole[1:].strip(), -1.0 if whole[0] == "-" else 1.0)] if whole[:1] in ("-", "+") else []
    )
    for given, sign in signed:
        for name, factor, offset in _split(given):
            if name in found:
                _check_offset(offset)
                return Source(name, sign * source.factor * _factor(factor), source.offset + float(offset))
    return source


def _split(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield the ways to take a text as name, factor and offset; those that leave more to the name come first."""
    yield text, "1", "0"
    if times := FACTOR.fullmatch(text):
        yield times[1].strip(), times[2], "0"
    if plus := OFFSET.fullmatch(text):
        scaled, offset = plus[1].strip(), plus[2] + plus[3]
        yield scaled, "1", offset
        if times := FACTOR.fullmatch(scaled):
            yield times[1].strip(), times[2], offset


def _check_offset(text: str) -> None:
    if not abs(float(text)) <= MOST_OFFSET:
        raise ValueError(f"the map has an offset of {brief(text)}: give one up to ±{MOST_OFFSET:g}")


def _factor(text: str) -> float:
    factor = float(text)
    if not LEAST_FACTOR <= abs(factor) <= MOST_FACTOR:
        raise ValueError(
            f"the map has a factor of {brief(text)}: give one from {LEAST_FACTOR:g} to {MOST_FACTOR:g}, with a sign if "
            "need be"
        )
    return factor


def listed(names: Sequence[str], most: int = 12, what: str = "columns") -> str:
    """Name columns, or what else they are, not too many, and none at length."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(brief, names[:most])) + more if names else f"no {what}"


def numbers(values: Array, source: Source, name: str) -> tuple[Array, int]:
    """Return readings in our unit, NaN where there is no number or one beyond what can be, and how many are beyond.

    Parameters
    ----------
    values
        Of the file's column.
    source
        Which it is, and the factor to our unit.
    name
        Of our column; t has another bound than readings.

    Raises
    ------
    ValueError
        If there is none that can be.
    """
    most = LATEST if name == "t" else MOST_READ
    finite = np.isfinite(values)
    with np.errstate(over="ignore", invalid="ignore"):
        brought = values * source.factor + source.offset
        good = finite & (np.abs(brought) <= most)
    if not good.any():
        what = f"no number up to ±{most:g} in our unit" if finite.any() else "no numbers"
        raise ValueError(f"column {brief(source.column)!r} holds {what}")
    return np.where(good, brought, np.nan), int(np.count_nonzero(finite & ~good))


def _evenly(name: str, columns: tuple[str, ...], values: Array, dropped: int) -> BenchLog:
    if len(values) < FEWEST:
        raise ValueError(f"{len(values)} rows of numbers are too few; at least {FEWEST} are needed")
    interval = np.diff(values[:, 0])
    if not np.all(interval > 0.0):
        at = int(np.argmax(~(interval > 0.0)))
        before, after = values[at, 0], values[at + 1, 0]
        raise ValueError(f"t does not rise: {after:.10g} s comes after {before:.10g} s (row {at + 2} of numbers)")
    usual = _interval(values[:, 0])
    if not 1.0 / FASTEST <= usual <= 1.0 / SLOWEST:
        a_second = f"{1.0 / usual:.3g}" if usual > 0.0 else "no end of"
        raise ValueError(
            f"{a_second} readings a second; from {SLOWEST:g} to {FASTEST:g} are understood: is t in seconds?"
        )
    uneven = float(np.subtract(*np.percentile(interval, (90.0, 10.0))))
    gap = interval > GAP * usual + uneven
    regular = interval[~gap]
    usual = float(regular.mean())
    missing = np.where(gap, np.clip(np.round(interval / usual) - 1.0, 0.0, MOST_MISSING), 0.0).astype(int)
    lost = int(missing.sum())
    filled = lost <= MOST_FILLED * len(values)
    even = _filled(values, missing) if filled else _longest(values, gap)
    if len(even) < FEWEST:
        raise ValueError(f"the longest stretch without a gap has {len(even)} readings; at least {FEWEST} are needed")
    even[:, 0] = even[0, 0] + usual * np.arange(len(even))
    return BenchLog(
        name=name,
        columns=columns,
        table=even,
        rate=1.0 / usual,
        dropped=dropped,
        gaps=int(np.count_nonzero(gap)),
        missing=lost,
        filled=filled,
        jitter=float(regular.std()),
    )


def _interval(t: Array) -> float:
    """Median interval, over stretches, as stamps may be rounded."""
    reach = min(SPREAD, t.size // 8)
    return float(np.median(t[reach:] - t[:-reach])) / reach


def _filled(values: Array, missing: Array) -> Array:
    """Put straight lines where readings are missing."""
    place = np.concatenate(([0], np.cumsum(missing + 1)))
    if place[-1] == len(values) - 1:
        return values.copy()
    every = np.arange(place[-1] + 1)
    return np.column_stack([np.interp(every, place, column) for column in values.T])


def _longest(values: Array, gap: NDArray[np.bool_]) -> Array:
    edges = np.concatenate(([0], np.flatnonzero(gap) + 1, [len(values)]))
    longest = int(np.argmax(np.diff(edges)))
    return values[edges[longest] : edges[longest + 1]].copy()
