"""Tables in files, CSV and Parquet, looked at before they are read: which columns, how many rows, what they hold.

Only columns that are asked for are kept, as numbers: NaN where there is something else; times and durations in s.
"""

import warnings
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray

from sensors.files import Held, is_binary

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

Array = NDArray[np.float64]

MOST_ROWS = 10_000_000  # in which a detector runs with 2 GB of memory
MOST_COLUMNS = 20_000
MOST_PACKED = 1_000_000_000  # B, of the columns of a Parquet file that are asked for, when unpacked
CELLS = 2_000_000  # of a CSV file, read at once
BATCH = 100_000  # rows of a Parquet file, read at once
LONGEST_LINE = 1_000_000  # B, in which a CSV file's line of names ends
LONGEST_NAME = 60  # characters of a name that are shown
LONGEST_REASON = 200  # characters of what a library says
SEPARATORS = (",", ";", "\t")
MARKS = {  # byte order marks, the longer before those that they begin with
    b"\xff\xfe\x00\x00": "utf-32",
    b"\x00\x00\xfe\xff": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
DAY = 86400.0  # s


class TableFile(Protocol):
    """A table that was looked at and not read yet."""

    @property
    def names(self) -> tuple[str, ...]:
        """Its columns."""

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers; ValueError, one line, if that cannot be."""


def table_of(held: Held) -> TableFile:
    """Look at a table; ValueError, one line, if it is none."""
    return ParquetTable(held) if held.head.startswith(b"PAR1") else CsvTable(held)


def brief(text: str, most: int = LONGEST_NAME) -> str:
    """Return a text of bounded length."""
    return text if len(text) <= most else f"{text[:most]}…"


def _too_many(rows: str) -> ValueError:
    return ValueError(f"has {rows} rows; at most {MOST_ROWS} are read")


# -- CSV -------------------------------------------------------------------------------------------------------------


class CsvTable:
    """A CSV file with a line of names, separated by commas, semicolons or tabs; `#` begins a comment.

    It is UTF-8, UTF-16 or UTF-32 with a byte order mark, or else Latin-1.
    """

    def __init__(self, held: Held) -> None:
        self._held = held
        self._encoding, lines = _first_lines(held)
        self._separator = max(SEPARATORS, key=lines[0].count)
        columns = max(line.count(self._separator) for line in lines) + 1
        if columns > MOST_COLUMNS:
            raise ValueError(f"has {columns} columns; at most {MOST_COLUMNS} are read")
        with _csv_understood(), held.open() as file:
            begun = self._csv(file, nrows=1)
        self.names = _told_apart(begun.columns)
        if (more := begun.index.nlevels) > 1:
            raise ValueError(f"has {len(self.names)} names, and lines of {len(self.names) + more} values")

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers."""
        parts: dict[str, list[Array]] = {name: [] for name in columns}
        rows = 0
        with _csv_understood(), self._held.open() as file:
            for piece in self._csv(file, chunksize=max(1, CELLS // len(self.names))):
                rows += len(piece)
                if rows > MOST_ROWS:
                    raise _too_many(f"more than {MOST_ROWS}")
                for name, values in parts.items():
                    values.append(_numbers(piece.iloc[:, self.names.index(name)]))
        return {name: np.concatenate(values) if values else np.empty(0) for name, values in parts.items()}

    def _csv(self, file: BinaryIO, **options: Any) -> Any:
        import pandas as pd  # late: it takes half a second

        return pd.read_csv(
            file,
            sep=self._separator,
            comment="#",
            skipinitialspace=True,
            encoding=self._encoding,
            encoding_errors="replace",
            low_memory=False,
            **options,
        )


@contextmanager
def _csv_understood() -> Iterator[None]:
    """Say in one line what pandas says of a file that is no table, and keep its warnings to ourselves."""
    import pandas as pd

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            yield
        except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeError, OverflowError) as error:
            said = brief(" ".join(str(error).split()), LONGEST_REASON)
            raise ValueError(f"not a table of comma-separated values ({said})") from error


def _first_lines(held: Held) -> tuple[str, list[str]]:
    """Return the encoding of a CSV file, the line of names, and the one behind it."""
    head = held.first(LONGEST_LINE)
    if not head:
        raise ValueError("not a table of comma-separated values (an empty file)")
    encoding = next((name for mark, name in MARKS.items() if head.startswith(mark)), "")
    if not encoding:
        if is_binary(head[:4096]):
            raise ValueError("not a table of comma-separated values (a binary file)")
        encoding = "utf-8-sig" if _is_utf8(head) else "latin-1"
    lines = head.decode(encoding, errors="replace").splitlines()
    whole = lines[:-1] if len(head) == LONGEST_LINE else lines
    said = [line for line in whole if line.strip() and not line.startswith("#")]
    if not said and whole != lines:
        raise ValueError(f"not a table of comma-separated values (no names in the first {LONGEST_LINE // 1000} kB)")
    return encoding, [*said[:2], ""][:2]


def _is_utf8(head: bytes) -> bool:
    """Whether text is UTF-8; its last character may be cut."""
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        return error.start >= len(head) - 3 and len(head) == LONGEST_LINE
    return True


def _told_apart(names: Iterable[Any]) -> tuple[str, ...]:
    """Names without spaces around them; those that are the same then get a number."""
    found: dict[str, None] = {}
    for given in names:
        name = stripped = str(given).strip()
        number = 0
        while name in found:
            number += 1
            name = f"{stripped}.{number}"
        found[name] = None
    return tuple(found)


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
        self._held = held
        with _parquet_understood(), self._opened() as file:
            columns = file.metadata.num_columns
            if columns > MOST_COLUMNS:
                raise ValueError(f"has {columns} columns; at most {MOST_COLUMNS} are read")
            if file.metadata.num_rows > MOST_ROWS:
                raise _too_many(str(file.metadata.num_rows))
            self._schema = file.schema_arrow
            self.names: tuple[str, ...] = tuple(self._schema.names)

    def read(self, columns: Collection[str]) -> dict[str, Array]:
        """Return columns of it as numbers."""
        parts: dict[str, list[Array]] = {name: [] for name in columns}
        with _parquet_understood():
            for batch in self._batches(columns):
                for name, values in parts.items():
                    values.append(_floats(batch.column(name)))
        return {name: np.concatenate(values) if values else np.empty(0) for name, values in parts.items()}

    def frame(self, columns: Collection[str], texts: Collection[str] = ()) -> "pd.DataFrame":
        """Return columns of it as pandas has them: numbers, flags and, where they may be, texts."""
        import pyarrow as pa

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
            rows = 0
            for batch in file.iter_batches(BATCH, columns=list(columns)):
                rows += batch.num_rows
                if rows > MOST_ROWS:
                    raise _too_many(f"more than {MOST_ROWS}")
                yield batch

    def _is_written(self, name: str) -> bool:
        """Whether a column is text; ValueError if it holds neither that nor numbers or times."""
        import pyarrow as pa

        if self.names.count(name) > 1:
            raise ValueError(f"has {self.names.count(name)} columns {brief(name)!r}")
        kind = self._schema.field(name).type
        values = kind.value_type if pa.types.is_dictionary(kind) else kind
        if _is_text(values):
            return True
        if not (_is_number(values) or _seconds(values)):
            raise ValueError(f"column {brief(name)!r} holds {brief(str(kind))}, not numbers")
        return False

    @staticmethod
    def _check_size(metadata: "pq.FileMetaData", columns: set[str]) -> None:
        size = 0
        for i in range(metadata.num_row_groups):
            group = metadata.row_group(i)
            for j in range(group.num_columns):
                column = group.column(j)
                if column.path_in_schema in columns:
                    size += column.total_uncompressed_size
        if size > MOST_PACKED:
            raise ValueError(
                f"has {size / 1e9:.3g} GB in the columns needed; at most {MOST_PACKED / 1e9:g} GB are read"
            )

    @contextmanager
    def _opened(self, **options: Any) -> "Iterator[pq.ParquetFile]":
        import pyarrow.parquet as pq

        with self._held.open() as file, pq.ParquetFile(file, **options) as parquet:
            yield parquet


@contextmanager
def _parquet_understood() -> Iterator[None]:
    """Say in one line what pyarrow says of a file that is damaged."""
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, OSError, UnicodeError) as error:
        said = brief(" ".join(str(error).split()), LONGEST_REASON)
        raise ValueError(f"not a Parquet file that can be read ({said})") from None
    except MemoryError:
        raise ValueError("not a Parquet file that can be read (it asks for more memory than there is)") from None


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
