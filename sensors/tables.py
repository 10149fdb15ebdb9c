"""Tables in files, CSV and Parquet, looked at before they are read: which columns, how many rows, what they hold.

Only columns that are asked for are kept, as numbers: NaN where there is something else; times and durations in s.
"""

import re
from codecs import getincrementaldecoder
from collections.abc import Collection, Container, Iterable, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sensors.csv_layout import BLANKS, LINE, LONGEST_HEAD, MOST_COLUMNS, cut, is_time, layout_of
from sensors.files import Held
from sensors.text import brief

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

Array = NDArray[np.float64]

MOST_ROWS = 10_000_000  # in which a detector runs with 2 GB of memory
MOST_PACKED = 1_000_000_000  # B, of the columns of a Parquet file's group of rows that are asked for, when unpacked
BLOCK = 4_000_000  # B of a text file, read at once
MOST_LINE = 16_000_000  # B
BATCH = 100_000  # rows of a Parquet file, read at once
ROW = 24  # B of a row of a Feather file, by which its rows are guessed
LONGEST_REASON = 200  # characters of what a library says
REMARK = re.compile(rb"(?:(?<=[\r\n])|^|(?<=[ \t]))[ \t]*#[^\r\n]*")
HARD_BLANK = "\u00a0".encode()  # which some put between figures and around values
MANY_BLANKS = re.compile(rb"[ \t]+")
END_BLANKS = re.compile(rb"^ | (?=[\r\n])|(?<=[\r\n]) | $")
PARTS = re.compile(r"(.*?:\d\d(?::\d\d)?)(\.\d+)?(Z|[-+][\d:]+)?")  # of a date with a time: whole, fraction, zone
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
DAY = 86400.0  # s


class TableFile(Protocol):
    """A table that was looked at and not read yet."""

    @property
    def names(self) -> tuple[str, ...]:
        """Its columns."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was unusual in what was read up to now, a sentence each."""

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers; ValueError, one line, if that cannot be."""

    @property
    def rows(self) -> int:
        """How many rows it has, more or less."""

    @property
    def share(self) -> float:
        """How much of it `batches` has passed, 0 to 1."""

    def batches(self, columns: Collection[str], only: Container[int] | None = None) -> Iterator[dict[str, Array]]:
        """Yield the same some rows at a time, of which there may be any number; `only` those batches, from 0 on."""


def table_of(held: Held) -> TableFile:
    """Look at a table; ValueError, one line, if it is none."""
    if held.head.startswith(b"ARROW1"):
        return FeatherTable(held)
    if held.head.startswith(b"FEA1"):
        raise ValueError("is a Feather file of version 1: write it anew, as version 2 or as Parquet")
    return ParquetTable(held) if held.head.startswith(b"PAR1") else CsvTable(held)


def _too_many(rows: str) -> ValueError:
    return ValueError(f"has {rows} rows; at most {MOST_ROWS} are read")


# -- CSV -------------------------------------------------------------------------------------------------------------


class CsvTable:
    """A text file of numbers, laid out as `csv_layout` tells; `#` begins a comment.

    Blocks of whole lines are read by pyarrow. What it cannot read (a text among numbers, a line that is too long) is
    read again line by line: a value that is no number is none, a line of more values than there are names is left out.
    """

    def __init__(self, held: Held) -> None:
        self._held = held
        self.layout = layout_of(held)
        self.names = self.layout.names
        self._long = self._short = self._zeros = 0
        self._places: list[tuple[int, int]] = []  # of the blocks in the file, once they are known
        self.share = 0.0

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was unusual in what was read up to now."""
        said = list(self.layout.remarks)
        if self._long:
            said.append(f"{self._long} lines have more values than there are names and are left out")
        if self._short:
            said.append(f"{self._short} lines have fewer values than there are names: what they lack is missing")
        if self._zeros:
            said.append(f"{self._zeros} zero bytes are passed over")
        return tuple(said)

    @property
    def rows(self) -> int:
        """How many rows it has, by the length of the first ones."""
        return int(self._held.size / max(1.0, self.layout.line))

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers."""
        return _joined(self.batches(columns), columns)

    def batches(self, columns: Collection[str], only: Container[int] | None = None) -> Iterator[dict[str, Array]]:
        """Yield columns of it as numbers, a block of lines at a time."""
        places = {name: self.names.index(name) for name in columns}
        for i, block in self._some(only) if only is not None and self._places else enumerate(self._blocks()):
            if only is None or i in only:
                yield self._read(block, places) or self._read(block, places, texts=True) or self._slowly(block, places)

    def _some(self, only: Container[int]) -> Iterator[tuple[int, bytes]]:
        """Yield blocks whose places are known from before."""
        with self._held.open() as file:
            for i, (start, size) in enumerate(self._places):
                if i in only:
                    file.seek(start)
                    yield i, self._plain(file.read(size))

    def _blocks(self) -> Iterator[bytes]:
        """Yield lines of numbers in UTF-8, whole ones, without comments."""
        layout = self.layout
        decode = None if layout.encoding.startswith("utf-8") else getincrementaldecoder(layout.encoding)("replace")
        skip, rest, marked = layout.start, b"", layout.encoding == "utf-8-sig"
        places: list[tuple[int, int]] = []
        passed, whole = 0, self._held.size
        with self._held.open() as file:
            while True:
                raw = file.read(BLOCK)
                self.share = file.tell() / whole
                text = raw if decode is None else decode.decode(raw, final=not raw).encode("utf-8", "replace")
                if marked:
                    text, marked = text.removeprefix(b"\xef\xbb\xbf"), False
                    passed = len(raw) - len(text)
                rest += text
                if skip and (len(rest) >= 4 * LONGEST_HEAD or not raw):
                    behind = _behind(rest, skip)
                    passed, rest, skip = passed + len(rest) - len(behind), behind, 0
                end = len(rest) if not raw else max(rest.rfind(b"\n"), rest.rfind(b"\r")) + 1
                if end and not skip:
                    places.append((passed, end))
                    yield self._plain(rest[:end])
                    passed, rest = passed + end, rest[end:]
                if len(rest) > MOST_LINE:
                    raise ValueError(f"has a line of more than {MOST_LINE // 10**6} MB")
                if not raw:
                    break
        if decode is None:
            self._places = places

    def _plain(self, block: bytes) -> bytes:
        """Return lines without comments and zeros, blanks between values made one."""
        if b"\0" in block:
            self._zeros += block.count(b"\0")
            block = block.replace(b"\0", b"")
        if HARD_BLANK in block:
            block = block.replace(HARD_BLANK, b" ")
        if b"#" in block:
            block = REMARK.sub(b"", block)
        if self.layout.separator == BLANKS:
            block = END_BLANKS.sub(b"", MANY_BLANKS.sub(b" ", block))
        return block

    def _read(self, block: bytes, places: Mapping[str, int], *, texts: bool = False) -> dict[str, Array] | None:
        """Return columns as pyarrow reads them, numbers or texts that may be some, or None if it does not."""
        import pyarrow as pa
        from pyarrow import csv

        layout = self.layout
        every = [str(i) for i in range(layout.width)]
        chosen = {name: every[place] for name, place in places.items()}
        kinds = {every[place]: pa.timestamp("ns") for place in places.values() if place in layout.dates}
        if any(place in layout.clocks for place in places.values()):
            return None
        kind = pa.string() if texts else pa.float64()
        odd = _Odd(layout.separator)
        try:
            table = csv.read_csv(
                pa.BufferReader(block),
                csv.ReadOptions(column_names=every, block_size=len(block) + 1, use_threads=False),
                csv.ParseOptions(delimiter=layout.separator, newlines_in_values=False, invalid_row_handler=odd.told),
                csv.ConvertOptions(
                    column_types={name: kinds.get(name, kind) for name in every},
                    include_columns=list(chosen.values()),
                    decimal_point=layout.decimal,
                ),
            )
        except pa.ArrowException:
            return None
        if odd.others:
            return None
        self._long += odd.longer
        return {name: _floats_of(table.column(own), layout.decimal) for name, own in chosen.items()}

    def _slowly(self, block: bytes, places: Mapping[str, int]) -> dict[str, Array]:
        """Return columns line by line."""
        layout = self.layout
        columns: dict[str, list[float]] = {name: [] for name in places}
        for line in LINE.split(block.decode("utf-8", errors="replace")):
            if not line.strip():
                continue
            values = cut(line, layout.separator)
            if len(values) > layout.width and any(values[layout.width :]):
                self._long += 1
                continue
            self._short += len(values) < len(layout.names)
            for name, place in places.items():
                columns[name].append(_value(values[place], layout.decimal) if place < len(values) else np.nan)
        return {name: np.array(values) for name, values in columns.items()}


class _Odd:
    """Lines of another number of values: those that have more are left out, for others all are read one by one."""

    def __init__(self, separator: str) -> None:
        self._separator = separator
        self.longer = self.others = 0

    def told(self, row: Any) -> str:
        """Count a line; pyarrow calls it."""
        longer = row.actual_columns > row.expected_columns and not row.text.rstrip().endswith(self._separator)
        self.longer, self.others = self.longer + longer, self.others + (not longer)
        return "skip"


def _behind(text: bytes, characters: int) -> bytes:
    """Return what comes behind so many characters."""
    return text[len(text.decode("utf-8", errors="surrogateescape")[:characters].encode("utf-8", "surrogateescape")) :]


def _joined(batches: Iterable[Mapping[str, Array]], columns: Collection[str]) -> dict[str, Array]:
    """Return columns as wholes."""
    parts: dict[str, list[Array]] = {name: [] for name in columns}
    rows = 0
    for batch in batches:
        rows += next((values.size for values in batch.values()), 0)
        if rows > MOST_ROWS:
            raise _too_many(f"more than {MOST_ROWS}")
        for name, values in parts.items():
            values.append(batch[name])
    return {name: np.concatenate(values) if values else np.empty(0) for name, values in parts.items()}


def _floats_of(column: "pa.ChunkedArray", decimal: str) -> Array:
    """Return a column of a text file as numbers."""
    from pyarrow import compute

    if decimal == "," and _is_text(column.type):
        column = compute.replace_substring(column, ",", ".")
    return np.concatenate([_floats(chunk) for chunk in column.chunks]) if column.num_chunks else np.empty(0)


def _value(text: str, decimal: str) -> float:
    """Return a value as a number, a date as seconds since 1970, a time of day as seconds; NaN for all else."""
    if is_time(text):
        return _seconds_of(text)
    try:
        return float(text.replace(",", ".") if decimal == "," else text) if "_" not in text else np.nan
    except ValueError:
        return np.nan


def _seconds_of(text: str) -> float:
    """Return a time in seconds: of the day, or since 1970, by UTC if it does not tell."""
    text = text.replace(",", ".")
    if "-" not in text:
        hours, minutes, seconds = text.split(":")
        return 3600.0 * int(hours) + 60.0 * int(minutes) + float(seconds)
    found = PARTS.fullmatch(text)
    if found is None:
        return np.nan
    try:
        whole = datetime.fromisoformat(f"{found[1]}{found[3] or '+00:00'}")
        return (whole if whole.tzinfo else whole.replace(tzinfo=UTC)).timestamp() + float(f"0{found[2] or ''}")
    except ValueError:
        return np.nan


def _numbers(column: "pd.Series[Any]") -> Array:
    """Return a column as numbers, NaN where it holds something else."""
    import pandas as pd

    try:
        return pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
    except OverflowError:  # whole numbers of hundreds of digits
        return np.array([_number(value) for value in column], dtype=float)


def _number(value: Any) -> float:
    try:
        return float(value)
    except (ValueError, TypeError, OverflowError):
        return np.nan


# -- Parquet ---------------------------------------------------------------------------------------------------------


class ParquetTable:
    """A Parquet file; what pandas wrote of an index into it is not believed, and an index that is a column is one."""

    def __init__(self, held: Held) -> None:
        self._held, self.share = held, 0.0
        with _parquet_understood(), self._opened() as file:
            columns = file.metadata.num_columns
            if columns > MOST_COLUMNS:
                raise ValueError(f"has {columns} columns; at most {MOST_COLUMNS} are read")
            self.rows: int = file.metadata.num_rows
            self._schema = file.schema_arrow
            self.names: tuple[str, ...] = tuple(self._schema.names)

    remarks: tuple[str, ...] = ()

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers."""
        self._check_rows()
        return _joined(self.batches(columns), columns)

    def batches(self, columns: Collection[str], only: Container[int] | None = None) -> Iterator[dict[str, Array]]:
        """Yield columns of it as numbers, some rows at a time."""
        rows = 0
        with _parquet_understood():
            for i, batch in enumerate(self._batches(columns)):
                rows += batch.num_rows
                self.share = rows / max(1, self.rows)
                if only is None or i in only:
                    yield {name: _floats(batch.column(name)) for name in columns}

    def _check_rows(self) -> None:
        if self.rows > MOST_ROWS:
            raise _too_many(str(self.rows))

    def frame(self, columns: Collection[str], texts: Collection[str] = ()) -> "pd.DataFrame":
        """Return columns of it as pandas has them: numbers, flags and, where they may be, texts."""
        import pyarrow as pa

        self._check_rows()
        chosen = pa.schema([self._schema.field(self.names.index(name)) for name in columns])
        for column in chosen:
            if not (_is_number(column.type) or (_is_text(column.type) and column.name in texts)):
                raise ValueError(f"column {brief(column.name)!r} holds {brief(str(column.type))}, not numbers")
        with _parquet_understood():
            table = pa.Table.from_batches(list(self._batches(columns, texts=False)), chosen.remove_metadata())
            found: pd.DataFrame = table.to_pandas(ignore_metadata=True)
        return found

    def _batches(self, columns: Collection[str], *, texts: bool = True) -> "Iterator[pa.RecordBatch]":
        """Yield columns, some rows at a time; ValueError if they hold no numbers, or are too large."""
        text = [name for name in columns if self._is_written(name)]
        with self._opened(read_dictionary=text if texts else None) as file:
            self._check_size(file.metadata, set(columns))
            yield from file.iter_batches(BATCH, columns=list(columns), use_threads=False)

    def _is_written(self, name: str) -> bool:
        return _is_written(self._schema, name)

    @staticmethod
    def _check_size(metadata: "pq.FileMetaData", columns: set[str]) -> None:
        for i in range(metadata.num_row_groups):
            size, group = 0, metadata.row_group(i)
            for j in range(group.num_columns):
                column = group.column(j)
                if column.path_in_schema in columns:
                    size += column.total_uncompressed_size
            if size > MOST_PACKED:
                raise ValueError(
                    f"has {size / 1e9:.3g} GB in the columns needed; at most {MOST_PACKED / 1e9:g} GB are read at once"
                )

    @contextmanager
    def _opened(self, **options: Any) -> "Iterator[pq.ParquetFile]":
        import pyarrow.parquet as pq

        with self._held.open() as file, pq.ParquetFile(file, pre_buffer=False, **options) as parquet:
            yield parquet


class FeatherTable:
    """A Feather file of version 2, which is an Arrow file: batches of columns."""

    remarks: tuple[str, ...] = ()

    def __init__(self, held: Held) -> None:
        self._held, self.share = held, 0.0
        with _parquet_understood("Feather"), self._opened() as file:
            self._schema = file.schema
            self._count = file.num_record_batches
            self.rows = held.size // ROW
        self.names: tuple[str, ...] = tuple(self._schema.names)
        if len(self.names) > MOST_COLUMNS:
            raise ValueError(f"has {len(self.names)} columns; at most {MOST_COLUMNS} are read")

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers."""
        return _joined(self.batches(columns), columns)

    def batches(self, columns: Collection[str], only: Container[int] | None = None) -> Iterator[dict[str, Array]]:
        """Yield columns of it as numbers, some rows at a time."""
        for name in columns:
            _is_written(self._schema, name)
        places = {name: self.names.index(name) for name in columns}
        with _parquet_understood("Feather"), self._opened(sorted(places.values())) as file:
            number = 0
            for i in range(self._count):
                batch = file.get_batch(i)
                for first in range(0, batch.num_rows, BATCH):
                    if only is None or number in only:
                        some = batch.slice(first, BATCH)
                        yield {name: _floats(some.column(name)) for name in places}
                    number += 1
                self.share = (i + 1) / self._count

    @contextmanager
    def _opened(self, places: list[int] | None = None) -> "Iterator[pa.ipc.RecordBatchFileReader]":
        import pyarrow as pa

        options = pa.ipc.IpcReadOptions(included_fields=places, use_threads=False)
        with self._held.open() as file, pa.ipc.open_file(file, options=options) as reader:
            yield reader


def _is_written(schema: "pa.Schema", name: str) -> bool:
    """Whether a column is text; ValueError if it holds neither that nor numbers or times."""
    import pyarrow as pa

    if schema.names.count(name) > 1:
        raise ValueError(f"has {schema.names.count(name)} columns {brief(name)!r}")
    kind = schema.field(name).type
    values = kind.value_type if pa.types.is_dictionary(kind) else kind
    if _is_text(values):
        return True
    if not (_is_number(values) or _seconds(values)):
        raise ValueError(f"column {brief(name)!r} holds {brief(str(kind))}, not numbers")
    return False


@contextmanager
def _parquet_understood(what: str = "Parquet") -> Iterator[None]:
    """Say in one line what pyarrow says of a file that is damaged."""
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, OSError, UnicodeError) as error:
        said = brief(" ".join(str(error).split()), LONGEST_REASON)
        raise ValueError(f"not a {what} file that can be read ({said})") from None
    except MemoryError:
        raise ValueError(f"not a {what} file that can be read (it asks for more memory than there is)") from None


def _is_number(kind: "pa.DataType") -> bool:
    from pyarrow import types

    return bool(
        types.is_integer(kind)
        or types.is_floating(kind)
        or types.is_boolean(kind)
        or types.is_decimal(kind)
        or types.is_null(kind)
    )


def _is_text(kind: "pa.DataType") -> bool:
    from pyarrow import types

    return bool(types.is_string(kind) or types.is_large_string(kind))


def _seconds(kind: "pa.DataType") -> float:
    """Return what a step of a time is, s; 0 for what is no time."""
    from pyarrow import types

    if types.is_date32(kind):
        return DAY
    if types.is_date64(kind):
        return SECONDS["ms"]
    if types.is_timestamp(kind) or types.is_duration(kind) or types.is_time(kind):
        return SECONDS[kind.unit]
    return 0.0


def _floats(array: "pa.Array") -> Array:
    """Return a column of a batch as numbers."""
    import pyarrow as pa

    kind = array.type
    if pa.types.is_dictionary(kind):
        places = array.indices.cast(pa.int64()).fill_null(-1).to_numpy(zero_copy_only=False)
        values: Array = np.append(_floats(array.dictionary), np.nan)
        return values[np.where(places < len(values), places, -1)]
    if _is_text(kind):
        return _numbers(array.to_pandas())
    if step := _seconds(kind):
        wide = kind.bit_width == 64
        return _plain(array.cast(pa.int64() if wide else pa.int32()).cast(pa.float64(), safe=False)) * step
    return _plain(array.cast(pa.float64(), safe=False))


def _plain(array: "pa.Array") -> Array:
    values: Array = array.to_numpy(zero_copy_only=False)
    return values
