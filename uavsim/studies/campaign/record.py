"""A campaign's folder: rows, errors over time and kept flights, written as flights end, each file whole.

    campaign.json          what is flown, by which software on which processor, and how far it is
    runs.parquet/          rows by index, 1000 a part; one file where there is only one part
    traces/                airspeed errors over time of the first 1000 flights
    flights/INDEX/         whole flights
    inputs/                what the scenario read from outside

A part is written anew with each bundle, under another name, forced to the disk and renamed, so that whatever ends the
process, what was finished can be read. Rows are only held until their part is full: a campaign of a million flights
takes no more memory than one of a thousand. What a row holds depends on scenario, seed and index alone, so a campaign
that is resumed ends in the same rows.
"""

import shutil
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sensors.data_files import parse_json
from uavsim import inputs
from uavsim.files import whole, write_json
from uavsim.flight import Flight
from uavsim.folders import OURS
from uavsim.scenario import Scenario
from uavsim.studies.airspeed_flights import Course
from uavsim.studies.campaign.flown import TRACED, WHOLE, ErrorTrace, Flown
from uavsim.studies.campaign.plan import Plan, Seeds, plan_of
from uavsim.studies.engine import Left
from uavsim.studies.identity import identity, processor, versions

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

RUNS, TRACES, FLIGHTS, ABOUT = "runs.parquet", "traces", "flights", "campaign.json"
PART = 1000  # rows in a file, which is written anew with each bundle
TRACES_PART = 20  # of errors over time, which are long
KEEPING = ".keeping"
TOLD = 5  # differences between two scenarios that are told
ENOUGH = 20  # flights that could not be done that are named
ALSO_TEXT = frozenset({"outcome", "expected", "reason", "launch.detector", "airspeed.estimator"})
LARGEST = 200_000_000  # bytes of a record; the points of a design are in it


class Record:
    """The folder of a campaign, from the first to the last flight.

    Parameters
    ----------
    folder
        One that is there.
    plan
        What is flown.
    keep
        The rule by which flights are kept, as it is written.
    before
        What an earlier run has left there, see `taken_up`.

    Attributes
    ----------
    outcomes : Counter
        How many flights that are written ended in which way.
    """

    def __init__(self, folder: Path, plan: Plan, *, keep: str = "", before: "Before | None" = None) -> None:
        self.folder, self.plan = folder, plan
        self._keep = keep
        self._parts = -(-plan.size // PART)
        self._rows: dict[int, Part] = {}
        self._traces: dict[int, Part] = {}
        self._earlier = 0.0 if before is None else before.wall_time
        self.outcomes: Counter[str] = Counter() if before is None else Counter(before.outcomes)
        self._done = np.zeros(plan.size, dtype=bool)
        if before is not None:
            self._done[before.done] = True
        self._scenario = inputs.write(folder, plan.scenario.to_dict())
        if before is not None and self._parts > 1:
            _into_parts(folder)
        self.describe(complete=False, wall_time=0.0)

    @property
    def missing(self) -> list[int]:
        """Positions that are still to be flown."""
        return [int(position) for position in np.flatnonzero(~self._done)]

    @property
    def finished(self) -> int:
        """How many flights are written."""
        return int(self._done.sum())

    def keep(self, results: Iterable[tuple[int, Flown]]) -> None:
        """Write finished flights: those that are kept, then the rows of all."""
        rows: dict[int, dict[int, dict[str, Any]]] = {}
        traces: dict[int, dict[int, ErrorTrace]] = {}
        try:
            for position, flown in results:
                index = flown.row["index"]
                if flown.flight is not None:
                    self.keep_flight(index, flown.flight)
                if flown.trace is not None:
                    traces.setdefault(position // TRACES_PART, {})[position] = flown.trace
                rows.setdefault(position // PART, {})[position] = flown.row
        finally:
            for number, some in traces.items():
                self._write_traces(number, some)
            for number, new in rows.items():
                self._write_rows(number, new)

    def _write_rows(self, number: int, new: dict[int, dict[str, Any]]) -> None:
        most = min(PART, self.plan.size - number * PART)
        self._write(self._rows, number, self._part(number), _table(list(new.values())), tuple(new), most)
        self.outcomes.update(row["outcome"] for position, row in new.items() if not self._done[position])
        self._done[list(new)] = True

    def _write_traces(self, number: int, new: dict[int, ErrorTrace]) -> None:
        for trace in new.values():
            if trace.course is not None:
                _write_table(_course_table(trace.course), self._traces_folder / course_name(trace.index))
        most = min(TRACES_PART, min(TRACED, self.plan.size) - number * TRACES_PART)
        path = self._traces_folder / part_name(number)
        self._write(self._traces, number, path, _traces_table(list(new.values())), tuple(new), most)

    def _write(
        self, parts: dict[int, "Part"], number: int, path: Path, new: "pa.Table", positions: tuple[int, ...], most: int
    ) -> None:
        """Write a part with what is new; it is held until it is full. One of an earlier run is read."""
        part = parts.get(number)
        if part is None:
            part = Part.read(path, self.plan) if path.is_file() else Part()
        part = part.joined(new, positions)
        assert part.table is not None
        _write_table(part.table, path)
        parts[number] = part
        if len(part.positions) == most:
            del parts[number]

    def _part(self, number: int) -> Path:
        """File of up to `PART` rows: `runs.parquet`, or one in a folder of that name, by position."""
        runs = self.folder / RUNS
        if self._parts <= 1:
            return runs
        runs.mkdir(exist_ok=True)
        return runs / part_name(number)

    @property
    def _traces_folder(self) -> Path:
        folder = self.folder / TRACES
        folder.mkdir(exist_ok=True)
        return folder

    def keep_flight(self, index: int, flight: Flight) -> None:
        """A flight's folder appears in `flights/` when it is whole."""
        unfinished, flights = self.folder / KEEPING, self.folder / FLIGHTS
        shutil.rmtree(unfinished, ignore_errors=True)
        try:
            unfinished.mkdir()
            flight.write(unfinished)
            flights.mkdir(exist_ok=True)
            shutil.rmtree(flights / str(index), ignore_errors=True)  # the same flight
            unfinished.rename(flights / str(index))
        except BaseException:
            shutil.rmtree(unfinished, ignore_errors=True)
            raise

    def describe(
        self, *, complete: bool, wall_time: float, left: Iterable[Left] = (), more: Mapping[str, Any] | None = None
    ) -> None:
        """Write what is flown and how far it is."""
        plan = self.plan
        left = list(left)
        write_json(
            self.folder / ABOUT,
            {
                **({"asked": ranges(plan.seeds), "seeds": self._seeds(plan)} if isinstance(plan, Seeds) else {}),
                "plan": plan.to_dict(),
                "root_seed": plan.scenario.seed,
                "flights": self.finished,
                "complete": complete,
                "unfinished": [{"index": plan.index(one.position), "why": one.why} for one in left[:ENOUGH]],
                "unfinished_count": len(left),
                "keep": self._keep,
                "versions": versions(),
                "identity": identity(),
                "processor": processor(),
                "wall_time": self._earlier + wall_time,
                **(more or {}),
                "scenario": self._scenario,
            },
        )

    def _seeds(self, plan: Seeds) -> list[int]:
        return [plan.seeds[position] for position in np.flatnonzero(self._done)]


class Part(NamedTuple):
    """Rows by position, and the positions; kept as they are written, so that a bundle costs what it brings."""

    table: "pa.Table | None" = None
    positions: tuple[int, ...] = ()

    def joined(self, new: "pa.Table", positions: tuple[int, ...]) -> "Part":
        """The same with more rows, or with others in their place, in the order of the positions."""
        import pyarrow as pa

        tables, where = [new], [*positions]
        if self.table is not None:
            stay = [i for i, position in enumerate(self.positions) if position not in set(positions)]
            tables.append(self.table if len(stay) == len(self.positions) else self.table.take(stay))
            where += [self.positions[i] for i in stay]
        order = np.argsort(where, kind="stable")
        table = pa.concat_tables(tables, promote_options="permissive").take(order).combine_chunks()
        return Part(table, tuple(where[i] for i in order))

    @classmethod
    def read(cls, path: Path, plan: Plan) -> "Part":
        """Read what an earlier run has written."""
        import pyarrow.parquet as pq

        return cls(pq.ParquetFile(path).read(), tuple(_positions(path, plan)))


# -- an earlier run ----------------------------------------------------------------------------------------------------


class Before(NamedTuple):
    """What an earlier run has left: positions that are done, how long it took, s, and how many ended in which way."""

    done: list[int]
    wall_time: float
    outcomes: Mapping[str, int]


def read_about(folder: Path) -> dict[str, Any]:
    """Read a campaign's record.

    Raises
    ------
    ValueError
        It is none; one line that names the file.
    """
    path = folder / ABOUT
    if not folder.is_dir():
        raise ValueError(f"{folder}: there is no such folder")
    if not path.is_file():
        raise ValueError(f"{folder}: this folder holds no {ABOUT}")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path}: has more than {LARGEST} bytes")
    try:
        told = parse_json(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(told, dict) or not {"plan", "scenario", "identity"} <= set(told):
        raise ValueError(f"{path}: is no record of a campaign that can be taken up")
    return told


def plan_in(folder: Path) -> Plan:
    """Read what a campaign's folder is about.

    Raises
    ------
    ValueError
        One line that names the file.
    """
    told = read_about(folder)
    try:
        scenario = Scenario.from_dict(inputs.read(folder, told["scenario"]))
        return plan_of(told["plan"], scenario)
    except (ValueError, AttributeError, TypeError) as error:
        raise ValueError(f"{folder / ABOUT}: {error}") from None


def taken_up(folder: Path, plan: Plan) -> Before:
    """Check that a plan is the one that a folder holds a part of, and say what is done.

    Raises
    ------
    ValueError
        Another scenario, seed, number or version; one line that says what differs.
    """
    link = next((entry.name for entry in sorted(folder.iterdir()) if entry.name in OURS and entry.is_symlink()), None)
    if link is not None:
        raise ValueError(f"{folder / link}: is a link; nothing is written through one")
    there, told = plan_in(folder), read_about(folder)
    different = _plan_differences(there, plan) + _identity_differences(told["identity"])
    if different:
        more = f" and {len(different) - TOLD} more" if len(different) > TOLD else ""
        raise ValueError(f"{folder}: --resume: is another campaign: {'; '.join(different[:TOLD])}{more}")
    done = [position for path in _parts_in(folder) for position in _positions(path, plan)]
    if len(set(done)) != len(done):
        raise ValueError(f"{folder / RUNS}: is damaged (a flight is in it twice)")
    wall_time = told.get("wall_time")
    outcomes = Counter(map(str, frame(folder, ["outcome"])["outcome"])) if done else Counter[str]()
    return Before(done, float(wall_time) if isinstance(wall_time, int | float) else 0.0, outcomes)


def _plan_differences(there: Plan, here: Plan) -> list[str]:
    one, other = _leaves(there.scenario.to_dict()), _leaves(here.scenario.to_dict())
    found = [
        f"{key} was {one.get(key, 'not set')!r} and is {other.get(key, 'not set')!r}"
        for key in dict.fromkeys((*one, *other))
        if one.get(key) != other.get(key)
    ]
    first, second = there.to_dict(), here.to_dict()
    for key in dict.fromkeys((*first, *second)):
        a, b = first.get(key), second.get(key)
        longer = key == "runs" and first["kind"] == "random" and isinstance(b, int) and isinstance(a, int) and b >= a
        if a != b and not longer:
            found.append(_difference(key, a, b))
    return found


def _difference(key: str, was: Any, now: Any) -> str:
    """Of two lists the first entry that they do not share."""
    if isinstance(was, list) and isinstance(now, list):
        i = next((i for i, (a, b) in enumerate(zip(was, now, strict=False)) if a != b), min(len(was), len(now)))
        ends = [value[i] if i < len(value) else "none" for value in (was, now)]
        return f"{key}[{i}] was {_brief(ends[0])} and is {_brief(ends[1])}"
    return f"{key} was {_brief(was)} and is {_brief(now)}"


def _brief(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}…"


def _identity_differences(told: object) -> list[str]:
    if not isinstance(told, Mapping):
        return ["its versions are not told"]
    return [
        f"{name} was {_brief(told.get(name))} and is {_brief(now)}"
        for name, now in identity().items()
        if told.get(name) != now
    ]


def _leaves(value: Any, prefix: str = "") -> dict[str, Any]:
    if isinstance(value, Mapping):
        found: dict[str, Any] = {}
        for key, item in value.items():
            found |= _leaves(item, f"{prefix}.{key}" if prefix else str(key))
        return found
    return {prefix: value}


def _into_parts(folder: Path) -> None:
    """A campaign that becomes longer has its one file as the first of several."""
    runs = folder / RUNS
    if runs.is_file():
        kept = folder / f".{part_name(0)}"
        runs.rename(kept)
        runs.mkdir()
        kept.rename(runs / part_name(0))


# -- tables ------------------------------------------------------------------------------------------------------------


def part_name(number: int) -> str:
    """Return the name of a part's file."""
    return f"part-{number:06}.parquet"


def course_name(index: int) -> str:
    """Return the name of the file of a flight's true course."""
    return f"course-{index}.parquet"


def _parts_in(folder: Path) -> list[Path]:
    runs = folder / RUNS
    if runs.is_file():
        return [runs]
    return sorted(runs.glob("part-*.parquet")) if runs.is_dir() else []


def read_columns(path: Path, columns: list[str] | None) -> "pd.DataFrame":
    """Read columns of one part that there are.

    Raises
    ------
    ValueError
        It is damaged.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.ParquetFile(path)
        there = None if columns is None else [name for name in columns if name in file.schema_arrow.names]
        found: pd.DataFrame = file.read(there).to_pandas()
    except (OSError, pa.ArrowException) as error:
        raise ValueError(f"{path}: is damaged ({' '.join(str(error).split())[:100]})") from None
    return found


def frame(folder: Path, columns: list[str] | None = None) -> "pd.DataFrame":
    """Read rows, sorted as they were asked for.

    Parameters
    ----------
    folder
        Of a campaign.
    columns
        Those that are wanted; None: all. One that is not there is left out.
    """
    import pandas as pd

    parts = [read_columns(path, columns) for path in _parts_in(folder)]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)


def traces(folder: Path) -> list[ErrorTrace]:
    """Read errors over time, in the order of the flights."""
    paths = sorted((folder / TRACES).glob("part-*.parquet")) if (folder / TRACES).is_dir() else []
    return [found for path in paths for found in traces_of(path).values()]


def _positions(path: Path, plan: Plan) -> list[int]:
    """Positions of the rows of a part.

    Raises
    ------
    ValueError
        It is damaged, or its rows are not those of the plan.
    """
    rows = read_columns(path, ["index", "seed", "outcome"])
    missing = {"index", "seed"} - set(rows.columns)
    if path.parent.name != TRACES and "outcome" not in rows.columns:
        missing |= {"outcome"}
    if missing:
        raise ValueError(f"{path}: is damaged (it has no column {sorted(missing)[0]!r})")
    if not all(pd_kind == "i" for pd_kind in (rows["index"].dtype.kind, rows["seed"].dtype.kind)):
        raise ValueError(f"{path}: is damaged (index and seed are no whole numbers)")
    positions = _by_index(plan, rows["index"].tolist())
    found = []
    for index, seed in zip(rows["index"].tolist(), rows["seed"].tolist(), strict=True):
        position = positions.get(index)
        if position is None or seed != _seed(plan, position):
            raise ValueError(f"{path}: is damaged (index {index} of seed {seed} is no flight of this campaign)")
        found.append(position)
    return found


def _seed(plan: Plan, position: int) -> int:
    return plan.seeds[position] if isinstance(plan, Seeds) else plan.scenario.seed


def _by_index(plan: Plan, indices: Iterable[int]) -> dict[int, int]:
    """Positions of flights by the numbers that people know them by."""
    if isinstance(plan, Seeds):
        positions = {seed: position for position, seed in enumerate(plan.seeds)}
        return {int(index): positions[index] for index in indices if index in positions}
    return {int(index): int(index) for index in indices if 0 <= index < plan.size}


def _table(rows: list[dict[str, Any]]) -> "pa.Table":
    """Rows with one type a column, whatever is missing in them."""
    import pyarrow as pa

    names = dict.fromkeys(name for row in rows for name in row)
    columns, fields = [], []
    for name in names:
        values = [row.get(name) for row in rows]
        kind = _kind(name, values)
        if pa.types.is_string(kind):
            values = [value if isinstance(value, str) else None for value in values]
        columns.append(pa.array(values, type=kind))
        fields.append(pa.field(name, kind))
    return pa.Table.from_arrays(columns, schema=pa.schema(fields))


def _kind(name: str, values: list[Any]) -> "pa.DataType":
    import pyarrow as pa

    if name in WHOLE:
        return pa.int64()
    if name in ALSO_TEXT or any(isinstance(value, str) for value in values):
        return pa.string()
    if any(isinstance(value, bool | np.bool_) for value in values):
        return pa.bool_()
    return pa.float64()


LISTS = ("filtered", "raw", "nees")
COURSE = ("airspeed", "slope", "static", "force", "along")


def _traces_table(found: list[ErrorTrace]) -> "pa.Table":
    import pyarrow as pa

    columns: dict[str, Any] = {
        "index": pa.array([trace.index for trace in found], pa.int64()),
        "seed": pa.array([trace.seed for trace in found], pa.int64()),
    }
    several = pa.list_(pa.float64())
    for name in LISTS:
        columns[name] = pa.array([getattr(trace, name) for trace in found], several)
    return pa.table(columns)


def _course_table(course: Course) -> "pa.Table":
    import pyarrow as pa

    there = {name: getattr(course, name) for name in COURSE}
    columns = {name: pa.array(values, pa.float64()) for name, values in there.items() if values is not None}
    return pa.table(columns).replace_schema_metadata({"temperature": repr(float(course.temperature))})


def _course_of(path: Path) -> Course | None:
    import pyarrow.parquet as pq

    if not path.is_file():
        return None
    table = pq.ParquetFile(path).read()
    arrays = {name: table[name].to_numpy() for name in COURSE if name in table.column_names}  # `along` is newer
    return Course(**arrays, temperature=float(table.schema.metadata[b"temperature"]))


def _write_table(table: "pa.Table", path: Path) -> None:
    """Write a table; numbers as they are, for hardly two of them are alike."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    words = [field.name for field in table.schema if pa.types.is_string(field.type)]
    with whole(path) as file:
        pq.write_table(table, file, use_dictionary=words or False)


def traces_of(path: Path) -> dict[int, ErrorTrace]:
    """Read errors over time of one file, by index.

    Raises
    ------
    ValueError
        It is damaged.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    found = {}
    try:
        for row in pq.ParquetFile(path).read().to_pylist():
            course = _course_of(path.with_name(course_name(row["index"])))
            lists = {name: _array(row[name]) for name in LISTS}
            found[row["index"]] = ErrorTrace(row["seed"], **lists, course=course, index=row["index"])
    except (OSError, KeyError, TypeError, ValueError, pa.ArrowException) as error:
        raise ValueError(f"{path}: is damaged ({' '.join(str(error).split())[:100]})") from None
    return found


def _array(values: list[float | None]) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def ranges(seeds: Iterable[int]) -> str:
    """Numbers as `--seeds` takes them: 1-4,9."""
    found: list[list[int]] = []
    for seed in seeds:
        if found and seed == found[-1][1] + 1:
            found[-1][1] = seed
        else:
            found.append([seed, seed])
    return ",".join(f"{first}-{last}" if last > first else f"{first}" for first, last in found)


def clear(folder: Path) -> None:
    """Remove what a run that was killed left half-done."""
    with suppress(OSError):
        shutil.rmtree(folder / KEEPING, ignore_errors=True)
