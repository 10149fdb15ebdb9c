"""A bench log of somebody's own part: a CSV file with a time and readings, brought to SI and to equal spacing.

The statistics of `sensors.characterise` need equally spaced readings, and real logs have gaps, jittering stamps and
rows that are no numbers. Rows that are no numbers are dropped, what is missing is filled by straight lines as long as
that is little, and everything that was done is counted and told.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

SEPARATORS = (",", ";", "\t")
SPREAD = 64  # intervals in a stretch by which the rate is told: stamps may be rounded to much of an interval
GAP = 1.5  # intervals beyond which readings are missing
MOST_FILLED = 0.05  # share of readings that may be filled in; beyond, the longest stretch without a gap is taken
FEWEST = 1000  # readings
SLOWEST, FASTEST = 0.01, 20_000.0  # Hz: what an accelerometer or a barometer gives, with a margin
NUMBER = re.compile(r"(.+?)\*\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")


@dataclass(frozen=True, slots=True)
class Source:
    """Where a column comes from: a column of the file times a factor; see `resolved` for how it is told apart."""

    column: str
    factor: float = 1.0


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
    """Return the columns of `ours=theirs,…`; theirs may end in a factor, as in `fx=ax*9.80665`.

    Raises
    ------
    ValueError
        If it is not of that form, names a column of ours that is not `known`, or one twice.
    """
    found: dict[str, Source] = {}
    for part in text.split(","):
        ours, sign, theirs = (piece.strip() for piece in part.partition("="))
        if not (ours and sign and theirs):
            raise ValueError(f"{part.strip()[:40]!r}: give it as ours=theirs,… as in t=time,{known[1]}=column*factor")
        if ours not in known:
            raise ValueError(f"{ours!r} is no column of ours; they are {', '.join(known)}")
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
        A CSV file with a line of names; separated by commas, semicolons or tabs, `#` begins a comment.
    columns, optional : sequence of str
        What is needed, t first, and what is taken if it is there; SI.
    mapping : mapping, optional
        Which column of the file each of ours is, as `parse_map` gives it; the others have the same name.

    Raises
    ------
    ValueError
        One line that names the file: if it is no such table, lacks a column, is too short, or its time does not rise.
    OSError
        If it cannot be read.
    """
    try:
        frame = read_table(path)
        wanted = _sources(list(map(str, frame.columns)), columns, optional, mapping or {})
        names = tuple(wanted)
        values = np.column_stack([numbers(frame, source) for source in wanted.values()])
        good = np.isfinite(values).all(axis=1)
        dropped, values = int(np.count_nonzero(~good)), values[good]
        return _evenly(path.name, names, values, dropped)
    except (FileNotFoundError, IsADirectoryError) as error:
        raise ValueError(f"{path}: there is no such file") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def read_table(path: Path) -> "pd.DataFrame":
    """Read a CSV file as it is; ValueError if it is no table."""
    import pandas as pd  # late: it takes half a second

    with path.open(encoding="utf-8-sig", errors="replace") as file:
        head = next((line for line in file if line.strip() and not line.startswith("#")), "")
    separator = max(SEPARATORS, key=head.count)
    try:
        frame = pd.read_csv(
            path, sep=separator, comment="#", skipinitialspace=True, encoding="utf-8-sig", low_memory=False
        )
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise ValueError(f"not a table of comma-separated values ({str(error).strip()})") from error
    return frame.rename(columns=lambda name: str(name).strip())


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
            hint = f"has no column {source.column!r}" if name in mapping else f"lacks {', '.join(lacking)}"
            ours = ",".join(f"{n}=…" for n in lacking)
            raise ValueError(f"{hint}; it has {listed(found)}; say which is which with --map {ours}")
    return wanted


def resolved(source: Source, found: Sequence[str]) -> Source:
    """Split a sign and a factor off a name that is not itself a column: `-Ay`, `ax*9.80665`, `-ax*9.80665`."""
    whole = source.column
    signed = [(whole, 1.0)] + (
        [(whole[1:].strip(), -1.0 if whole[0] == "-" else 1.0)] if whole[:1] in ("-", "+") else []
    )
    for name, sign in signed:
        if name in found:
            return Source(name, sign * source.factor)
        match = NUMBER.fullmatch(name)
        if match is not None and match[1].strip() in found:
            return Source(match[1].strip(), sign * source.factor * float(match[2]))
    return source


def listed(names: Sequence[str], most: int = 12) -> str:
    """Name columns, not too many."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more if names else "no columns"


def numbers(frame: "pd.DataFrame", source: Source) -> Array:
    """Return a column in our unit, NaN where it holds something else than a number; ValueError if it holds none."""
    import pandas as pd

    column = pd.to_numeric(frame[source.column], errors="coerce").to_numpy(dtype=float)
    if not np.isfinite(column).any():
        raise ValueError(f"column {source.column!r} holds no numbers")
    return column * source.factor


def _evenly(name: str, columns: tuple[str, ...], values: Array, dropped: int) -> BenchLog:
    if len(values) < FEWEST:
        raise ValueError(f"{len(values)} rows of numbers are too few; at least {FEWEST} are needed")
    interval = np.diff(values[:, 0])
    if not np.all(interval > 0.0):
        at = int(np.argmax(~(interval > 0.0)))
        before, after = values[at, 0], values[at + 1, 0]
        raise ValueError(f"t does not rise: {after:.10g} s comes after {before:.10g} s (row {at + 2} of numbers)")
    usual = _interval(values[:, 0])
    if not SLOWEST <= 1.0 / usual <= FASTEST:
        raise ValueError(
            f"{1.0 / usual:.3g} readings a second; from {SLOWEST:g} to {FASTEST:g} are understood: is t in seconds?"
        )
    uneven = float(np.subtract(*np.percentile(interval, (90.0, 10.0))))
    gap = interval > GAP * usual + uneven
    regular = interval[~gap]
    usual = float(regular.mean())
    missing = np.where(gap, np.maximum(np.round(interval / usual) - 1.0, 0.0), 0.0).astype(int)
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
