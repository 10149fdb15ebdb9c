"""A log that does not fit into memory: read in lots of readings, as often as it is needed.

Text, Parquet and Feather are read in parts; memory does not grow with them. Each lot's stamps are looked at as those of
a whole log are (`stamps`), with the last one before it. Other formats are read as wholes, within the limits of those.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from sensors.bench_log import Source, numbers
from sensors.files import look
from uavsim.logs.evidence import Evidence
from uavsim.logs.formats import Table, named, read_tables, table_in
from uavsim.logs.mapping import (
    FASTEST,
    SLOWEST,
    check_factors,
    check_found,
    check_unit,
    is_scaled,
    lacks,
    one_g,
    read_log,
    recording_of,
    source_of,
    sources_of,
)
from uavsim.logs.recording import AXES, GAP, Array, Recording
from uavsim.logs.stamps import CHANGED, BackwardsError, stamped

MOST_AT_ONCE = 1_500_000  # readings up to which a log is read as a whole: with all that is made of them 500 MB
LOT = 200_000  # readings of a log that is read as a whole
MOST_REMARKS = 40
MOST_GAPS = 1000  # that are kept
SAMPLE = 20_000  # readings by which the unit is told

Shown = Callable[[float], None]


@dataclass(frozen=True, slots=True, eq=False)
class Lot:
    """Readings that follow each other, or begin a part of the log.

    Attributes
    ----------
    readings : numpy.ndarray
        Shape (m, 4), as of a `Recording`.
    begins : bool
        Whether the clock began anew, or the rate is another one.
    """

    readings: Array
    begins: bool


@dataclass(slots=True, eq=False)
class Survey:
    """What a log is like, as one pass over it tells.

    Attributes
    ----------
    readings : int
    start, end : float
        Least and greatest time, s.
    duration : float
        Of all parts, s.
    rates : list of float
        Median rate of each part, Hz.
    gaps : list of tuple
        The first of them: the times before and after, s.
    axes : tuple of str
        Which it holds.
    evidence : Evidence
        What the readings show by themselves.
    """

    readings: int
    start: float
    end: float
    duration: float
    rates: list[float]
    gaps: list[tuple[float, float]]
    axes: tuple[str, ...]
    evidence: Evidence

    @property
    def rate(self) -> float:
        """Median rate of the longest part, Hz."""
        return float(np.median(self.rates))


def is_long(paths: Sequence[Path]) -> bool:
    """Whether a log is to be read in parts: it is a table, and has more readings than are held at once."""
    rows = 0
    for path in paths:
        with named(str(path)):
            table = table_in(look(path))
            if table is None:
                return False  # that of an autopilot is read as a whole
            rows += table.rows
    return rows > MOST_AT_ONCE


def _rows(table: Table) -> int:
    return 0 if table.file is None else table.file.rows


def chunks(paths: Sequence[Path], mapping: str | None = None) -> Iterator[Array]:
    """Yield readings, shape (m, 4), in the order of the log; see `read_log`."""
    for lot in Stream(paths, mapping).lots():
        yield lot.readings


class Stream:
    """A log that is read in lots.

    Parameters
    ----------
    paths, mapping
        As of `read_log`. All axes must be in each file, or in one of them; several follow each other as they are named.

    Attributes
    ----------
    remarks : list of str
        What was not as it should be in what was read up to now.
    """

    def __init__(self, paths: Sequence[Path], mapping: str | None = None) -> None:
        self.paths, self.mapping = tuple(paths), mapping
        self._sources = sources_of(mapping)
        self._tables = [table for path in paths for table in read_tables(path, self._sources)]
        self._whole: Recording | None = None
        self._spans: dict[str, list[tuple[float, float]]] = {}  # of the batches of each table: stamps as they stand
        self._remarks: Counter[str] = Counter()
        self._one_g: dict[str, float] = {}
        if any(table.file is None for table in self._tables):
            self._whole = read_log(paths, mapping)
            return
        with named(", ".join(map(str, paths))):
            check_found(self._sources, self._tables)
            holding = [table for table in self._tables if self._axes_of(table)]
            axes = {self._axes_of(table) for table in holding}
            held = {axis for each in axes for axis in each}
            if not {"fx", *self._sources} & held:
                found = [name for table in self._tables for name in table.columns]
                raise ValueError(lacks([axis for axis in AXES if axis not in held], found, (), self._tables))
            if len(axes) != 1:
                raise ValueError(
                    f"a log of more than {MOST_AT_ONCE} readings is read in parts, and must hold all axes, and a time, "
                    "in one file: map fx=… and so on to columns of one, or write it so"
                )
            self._holding = holding
            self.axes = next(iter(axes))
        for table in self._tables:
            for said in table.remarks:
                self._say(f"{table.name}: {said}")
            if table not in holding and not table.usual.keys() - {"t"} & set(self._sources):
                self._say(f"{table.name} is read where a launch is found")

    @property
    def remarks(self) -> list[str]:
        """What was not as it should be, each once, in what was read up to now."""
        said = [f"{said} ({many} times)" if many > 1 else said for said, many in self._remarks.items()]
        more = len(said) - MOST_REMARKS
        return [*said[:MOST_REMARKS], f"… and {more} more remarks"] if more > 0 else said

    def _say(self, said: str) -> None:
        self._remarks[said] = 1

    def _axes_of(self, table: Table) -> tuple[str, ...]:
        if source_of("t", table, self._sources).column not in table.columns:
            return ()
        return tuple(axis for axis in AXES if source_of(axis, table, self._sources).column in table.columns)

    # -- lots --------------------------------------------------------------------------------------------------------

    def lots(self, shown: Shown | None = None) -> Iterator[Lot]:
        """Yield all readings of the log, in lots; `shown` is told the share that is done."""
        if self._whole is not None:
            yield from _lots_of(self._whole)
            return
        self._remarks = Counter({said: 1 for said in self._remarks if "at " not in said})
        last: float | None = None
        before = 0.0
        sizes = [_rows(table) for table in self._holding]
        for i, table in enumerate(self._holding):
            with named(table.name):
                for lot in self._lots_of_file(table, last):
                    interval = _interval(lot.readings)
                    changed = bool(before and interval and not 1.0 / CHANGED < interval / before < CHANGED)
                    before = interval or before
                    last = float(lot.readings[-1, 0])
                    yield replace(lot, begins=True) if changed else lot
                    if shown is not None and table.file is not None:
                        shown((sum(sizes[:i]) + sizes[i] * table.file.share) / max(1, sum(sizes)))

    def _lots_of_file(self, table: Table, last: float | None) -> Iterator[Lot]:
        """Yield lots of one file; its first follows the last stamp of the file before it."""
        assert table.file is not None
        held = {name: source_of(name, table, self._sources) for name in ("t", *self.axes)}
        clock, added, first = held["t"], 0.0, last is None
        spans: list[tuple[float, float]] = []
        for batch in table.file.batches({source.column for source in held.values()}):
            values = {name: self._numbers(batch[source.column], source, name, table) for name, source in held.items()}
            stamps = values.pop("t")
            spans.append(_span(stamps))
            force = self._force(values, table)
            joined = stamps + added if last is None else np.concatenate(([last], stamps + added))
            rows = force if last is None else np.vstack((np.full((1, 3), np.nan), force))
            found = stamped(joined, abs(clock.factor), rows, of_day=clock.column in table.of_day)
            for said in found.remarks:
                self._remarks[f"{table.name}: {said}"] += 1
            added += found.added
            readings = np.column_stack((found.t, rows[found.rows]))
            for start, end in pairwise((0, *found.cuts, len(readings))):
                fresh = start > 0 or first
                part = readings[start:end]
                if last is not None and start == 0 and found.rows.size and found.rows[0] == 0:
                    part = part[1:]  # the stamp that was yielded before
                elif last is not None and start == 0:
                    fresh = True
                if len(part):
                    yield Lot(part, fresh)
                    last, first = float(part[-1, 0]), False
        self._spans[table.name] = spans
        for said in table.later():
            self._say(f"{table.name}: {said}")

    def _numbers(self, values: Array, source: Source, name: str, table: Table) -> Array:
        try:
            found, beyond = numbers(values, source, name)
        except ValueError:
            return np.full(values.shape, np.nan)
        if beyond:
            self._remarks[f"{table.name}: numbers of {name} are beyond all that can be, and count as none"] += beyond
        return found

    def _force(self, values: Mapping[str, Array], table: Table) -> Array:
        size = next(iter(values.values())).size
        force = np.column_stack([values.get(axis, np.full(size, np.nan)) for axis in AXES])
        if not table.counts or any(axis in self._sources for axis in AXES):
            return force
        if table.name not in self._one_g:
            said: list[str] = []
            self._one_g[table.name] = one_g(force, table.name, said)
            for line in said:
                self._say(line)
        return force * self._one_g[table.name]

    # -- what it is like ---------------------------------------------------------------------------------------------

    def survey(self, shown: Shown | None = None) -> Survey:
        """Go over the log once.

        Raises
        ------
        ValueError
            One line, if it cannot be replayed, as of `read_log`.
        """
        names = ", ".join(map(str, self.paths))
        readings, start, end, duration = 0, np.inf, -np.inf, 0.0
        intervals: list[list[tuple[float, int]]] = []
        gaps: list[tuple[float, float]] = []
        axes = np.zeros(3, bool)
        sample: list[Array] = []
        evidence: Evidence | None = None
        last = np.nan
        try:
            for lot in self.lots(shown):
                t = lot.readings[:, 0]
                readings += t.size
                start, end = min(start, float(t[0])), max(end, float(t[-1]))
                if lot.begins or not intervals:
                    intervals.append([])
                    last = np.nan
                duration += float(t[-1] - t[0]) + (float(t[0]) - last if last == last else 0.0)
                steps = np.diff(t, prepend=last)
                usual = _interval(lot.readings)
                intervals[-1].append((usual, t.size))
                for row in np.flatnonzero(steps > GAP * usual * (1.0 + 1e-6))[: MOST_GAPS - len(gaps)]:
                    gaps.append((float(t[row] - steps[row]), float(t[row])))
                axes |= np.isfinite(lot.readings[:, 1:]).any(axis=0)
                if evidence is None:
                    evidence = Evidence(1.0 / usual if usual else 1.0)
                evidence.add(lot.readings)
                if len(sample) < 100:
                    sample.append(lot.readings[:: max(1, t.size // 200), 1:].copy())  # else it holds the lot
                last = float(t[-1])
        except BackwardsError as error:
            raise ValueError(f"{names}: {error}; map t=… to a column that rises") from None
        with named(names):
            if evidence is None:
                raise ValueError("no row has a time: map t=…")
            rates = [1.0 / _middle(part) if _middle(part) else np.inf for part in intervals]
            self._check(rates, np.vstack(sample))
        held = tuple(axis for axis, is_held in zip(AXES, axes.tolist(), strict=True) if is_held)
        return Survey(readings, start, end, duration, rates, gaps, held, evidence)

    def _check(self, rates: Sequence[float], sample: Array) -> None:
        """Refuse what is no time, or no m/s²."""
        for rate in rates:
            if not SLOWEST <= rate <= FASTEST:
                raise ValueError(
                    f"{rate:.3g} readings a second, if t is in seconds; from {SLOWEST:g} to {FASTEST:g} are "
                    "understood: map t=…*1e-6 if it is in microseconds, t=…*1e-3 if in milliseconds"
                )
        if self._whole is not None:
            return
        table = self._holding[0]
        held = {axis: source_of(axis, table, self._sources) for axis in self.axes}
        stated = {
            axis: held[axis].factor if "*" in self._sources[axis].column[len(held[axis].column) :] else None
            for axis in self.axes
            if axis in self._sources
        }
        check_factors({axis: stated.get(axis) for axis in self.axes})
        if not any(stated.values()) and not table.counts and not is_scaled(held, self.axes):
            check_unit(sample)

    # -- a stretch ---------------------------------------------------------------------------------------------------

    def between(self, start: float, end: float) -> Recording:
        """Return the readings between two times, s, and what else the log holds then."""
        if self._whole is not None:
            return _cut_out(self._whole, start, end)
        tables = [replace(table, read=self._windowed(table, start, end)) for table in self._tables]
        return recording_of(self.paths, self.mapping, tables)

    def _windowed(self, table: Table, start: float, end: float) -> Callable[..., Mapping[str, Array]]:
        clock = source_of("t", table, self._sources)

        def read(columns: object) -> dict[str, Array]:
            assert table.file is not None
            chosen = {*columns, clock.column}  # type: ignore[misc]
            spans = self._spans.get(table.name)
            only = None if spans is None else {i for i, (a, b) in enumerate(spans) if a <= end and b >= start}
            parts: dict[str, list[Array]] = {name: [np.empty(0)] for name in chosen}
            for batch in table.file.batches(chosen, only):
                stamps = np.full(batch[clock.column].shape, np.nan)
                with suppress(ValueError):
                    stamps, _ = numbers(batch[clock.column], clock, "t")
                keep = (stamps >= start) & (stamps <= end)
                for name, values in parts.items():
                    values.append(batch[name][keep])
            return {name: np.concatenate(values) for name, values in parts.items()}

        return read


def _lots_of(whole: Recording) -> Iterator[Lot]:
    for part in whole.parts:
        for first in range(part.start, part.stop, LOT):
            yield Lot(whole.readings[first : min(first + LOT, part.stop)], first == part.start)


def _interval(readings: Array) -> float:
    """Median interval, s; 0 if there is none."""
    return float(np.median(np.diff(readings[:, 0]))) if len(readings) > 1 else 0.0


def _middle(intervals: Sequence[tuple[float, int]]) -> float:
    """Median of medians, each as often as it has readings."""
    ordered = sorted((interval, size) for interval, size in intervals if interval > 0.0)
    if not ordered:
        return 0.0
    passed = np.cumsum([size for _, size in ordered])
    return ordered[int(np.searchsorted(passed, 0.5 * passed[-1]))][0]


def _span(stamps: Array) -> tuple[float, float]:
    good = stamps[np.isfinite(stamps)]
    return (float(good.min()), float(good.max())) if good.size else (np.inf, -np.inf)


def _cut_out(of: Recording, start: float, end: float) -> Recording:
    """Return what a recording holds between two times, s."""
    t = of.readings[:, 0]
    keep = (t >= start) & (t <= end)
    place = np.cumsum(keep)
    cuts = sorted({int(place[cut - 1]) for cut in of.cuts} - {0, int(place[-1])})
    series = {}
    for name, one in of.series.items():
        inside = (one.t >= start) & (one.t <= end)
        series[name] = replace(one, t=one.t[inside], values=one.values[inside])
    others = {name: rows[(rows[:, 0] >= start) & (rows[:, 0] <= end)] for name, rows in of.others.items()}
    return replace(of, readings=of.readings[keep], cuts=tuple(cuts), series=series, others=others)
