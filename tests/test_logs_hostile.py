"""Logs that are damaged, huge, packed or made to do harm: one line or a remark, and nothing on the terminal."""

import bz2
import gzip
import io
import json
import lzma
import os
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from test_logs import dataflash, dataflash_text, frame, ulog

from sensors import bench_log, files, tables
from sensors.bench_log import read_bench_log
from uavsim.flight import Flight, load
from uavsim.logs import Recording, read_log, replay_log
from uavsim.logs.ulog import read_ulog

LONGEST = 1000  # characters of any line
FORCE = ("fx", "fy", "fz")
STATED = ",".join(f"{axis}={axis}*1" for axis in FORCE)  # the map says that it is m/s²


def refused(read: Callable[[], Any]) -> str:
    """Return the one line with which something is refused."""
    with pytest.raises(ValueError, match=r"^[^\n]*$") as caught:
        read()
    assert len(str(caught.value)) < LONGEST
    return str(caught.value)


def written(path: Path, table: pd.DataFrame | pa.Table) -> Path:
    if path.suffix == ".csv":
        table.to_csv(path, index=False)
    elif isinstance(table, pa.Table):
        pq.write_table(table, path)
    else:
        table.to_parquet(path)
    return path


# -- numbers that overflow -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", ["1e400", "-1e400", "1e308", "1e16", "0", "-0.0", "1e-16", "1e-400", "9" * 400])
@pytest.mark.parametrize("ours", ["t", "fx"])
def test_a_factor_that_no_unit_has_is_refused(tmp_path: Path, ours: str, factor: str) -> None:
    path = written(tmp_path / "a.csv", frame(end=1.0))
    said = refused(lambda: read_log([path], f"{ours}={ours}*{factor}"))
    assert "a.csv: the map has a factor of " in said
    assert "from 1e-15 to 1e+15" in said


@pytest.mark.parametrize("factor", ["nan", "inf", "1e", "0x10"])
def test_what_is_no_number_is_no_factor(tmp_path: Path, factor: str) -> None:
    path = written(tmp_path / "a.csv", frame(end=1.0))
    assert f"has no column 't*{factor}'" in refused(lambda: read_log([path], f"t=t*{factor}"))


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@pytest.mark.parametrize("value", [1e308, -1e300, 1.1e12, 2.0**63, -(2.0**63)])
def test_a_reading_beyond_all_readings_counts_as_none_and_is_told(tmp_path: Path, value: float, suffix: str) -> None:
    table = frame(end=2.0)
    table.loc[700, "fx"] = value
    recording = read_log([written(tmp_path / f"a{suffix}", table)])
    assert np.flatnonzero(np.isnan(recording.readings[:, 1])).tolist() == [700]
    assert recording.remarks[0].endswith("1 numbers of fx are beyond ±1e+12 and count as no reading")


@pytest.mark.parametrize("value", [1e300, -1e308, 1.1e20])
def test_a_time_beyond_all_times_counts_as_none_and_is_told(tmp_path: Path, value: float) -> None:
    table = frame(end=2.0)
    table.loc[700, "t"] = value
    recording = read_log([written(tmp_path / "a.csv", table)])
    assert np.array_equal(recording.readings, table.drop(index=700).to_numpy())
    assert recording.remarks[0].endswith("1 numbers of t are beyond ±1e+20 and count as no time")


@pytest.mark.parametrize("columns", [["t"], ["fx"], list(FORCE)])
@pytest.mark.parametrize("value", [1e300, 1e308, -(2.0**63), np.iinfo("int64").max, np.iinfo("uint64").max])
def test_columns_of_extremes_are_one_line(tmp_path: Path, columns: list[str], value: float) -> None:
    table = frame(end=1.0)
    for column in columns:
        table[column] = np.full(len(table), value)
    for suffix in (".csv", ".parquet"):
        path = written(tmp_path / f"a{suffix}", table)
        for mapping in (None, STATED):
            refused(lambda path=path, mapping=mapping: read_log([path], mapping))


@pytest.mark.parametrize("scale", [1e300, 1e200, 1e13, 1e10, 1e-300])
def test_values_of_any_size_are_replayed_and_drawn_without_a_warning(tmp_path: Path, scale: float) -> None:
    """Warnings are errors here."""
    from uavsim.views import log as view

    table = frame(end=2.0, onset=1.0)
    table[list(FORCE)] *= scale
    path = written(tmp_path / "a.csv", table)
    if scale > 1e12:
        assert "holds no number up to ±1e+12" in refused(lambda: read_log([path], STATED))
        assert "holds no number up to" in refused(lambda: read_bench_log(path, ("t", *FORCE)))
        return
    flight = replay_log(read_log([path], STATED))
    view.draw(flight)
    view.lines(flight)
    assert read_bench_log(path, ("t", *FORCE)).dropped == 0


@pytest.mark.parametrize("start", [1e14, 1e10, -1e14])
def test_times_far_from_0_are_drawn_without_a_warning(tmp_path: Path, start: float) -> None:
    from uavsim.views import log as view

    table = frame(rate=20.0, end=10.0)
    table["t"] += start
    flight = replay_log(read_log([written(tmp_path / "a.csv", table)]))
    view.draw(flight)
    assert view.lines(flight)


def test_numbers_of_hundreds_of_digits(tmp_path: Path) -> None:
    table = frame(end=1.0).astype(object)
    table.loc[5, "fx"] = table.loc[6, "t"] = "9" * 400
    recording = read_log([written(tmp_path / "a.csv", table)])
    assert len(recording.readings) == len(table) - 1
    assert np.isnan(recording.readings[5, 1])


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
@pytest.mark.parametrize("kind", ["timestamp", "duration"])
@pytest.mark.parametrize("first", [0, -(2**62), 2**63 - 3001])
def test_dates_and_durations_of_any_size(tmp_path: Path, kind: str, unit: str, first: int) -> None:
    step = {"ms": 2, "us": 2000, "ns": 2_000_000}[unit]
    steps = np.arange(min(3000, (2**63 - 1 - first) // step), dtype=np.int64) * step + first
    table = pa.table(frame()[: len(steps)])
    timed = table.set_column(0, "t", pa.array(steps).cast(getattr(pa, kind)(unit)))
    path = written(tmp_path / "a.parquet", timed)
    if first == 0:
        assert read_log([path]).readings[:, 0] == pytest.approx(np.arange(3000) * 0.002, abs=1e-9)
        return
    try:  # far from 0 the doubles nearest to the times need not rise
        assert np.all(np.diff(read_log([path]).readings[:, 0]) > 0.0)
    except ValueError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)


@pytest.mark.parametrize("year", [1, 9999])
def test_the_first_and_last_year_are_dates(tmp_path: Path, year: int) -> None:
    first = np.datetime64(f"{year:04}-06-01", "ms").astype(np.int64)
    stamps = pa.array(first + 2 * np.arange(3000)).cast(pa.timestamp("ms"))
    recording = read_log([written(tmp_path / "a.parquet", pa.table(frame()).set_column(0, "t", stamps))])
    assert recording.span[0] == pytest.approx(first * 1e-3)
    assert recording.rate == pytest.approx(500.0, rel=0.02)  # a double is good for 30 µs there


def test_dates_that_are_none(tmp_path: Path) -> None:
    table = frame(end=1.0)
    table["t"] = pd.to_datetime(1.7e9 + table["t"], unit="s")
    table.loc[5, "t"] = pd.NaT
    assert len(read_log([written(tmp_path / "a.parquet", table)]).readings) == len(table) - 1
    table["t"] = pd.NaT
    assert "holds no numbers" in refused(lambda: read_log([written(tmp_path / "a.parquet", table)]))


def test_gaps_of_any_length_in_a_bench_log(tmp_path: Path) -> None:
    table = frame(end=4.0)
    table.loc[1500:, "t"] += 1e11
    log = read_bench_log(written(tmp_path / "a.csv", table), ("t", *FORCE))
    assert (log.gaps, len(log.table)) == (1, 1500)


# -- Parquet, looked at before it is read ----------------------------------------------------------------------------


def test_rows_are_counted_before_they_are_read(tmp_path: Path) -> None:
    """Constant rows: 20 million take 300 kB of the disk."""
    path, n = tmp_path / "many.parquet", 1_000_000
    one = pa.table({name: pa.array(np.zeros(n)) for name in ("t", *FORCE)})
    with pq.ParquetWriter(path, one.schema) as writer:
        for _ in range(20):
            writer.write_table(one)
    for read in (lambda: read_log([path]), lambda: read_bench_log(path, ("t", *FORCE))):
        assert refused(read).endswith("many.parquet: has 20000000 rows; at most 10000000 are read")


def test_a_flights_tables_are_counted_too(tmp_path: Path, catapult: Flight, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = catapult.save(tmp_path / "flight")
    monkeypatch.setattr(tables, "MOST_ROWS", 1000)
    assert "rows; at most 1000 are read" in refused(lambda: load(folder))


@pytest.mark.parametrize(
    ("array", "says"),
    [
        (pa.array([{"a": 1.0}] * 500), "column 'fx' holds struct<a: double>, not numbers"),
        (pa.array([[1.0]] * 500), "column 'fx' holds list<"),
        (pa.array([[("a", 1)]] * 500, pa.map_(pa.string(), pa.int32())), "column 'fx' holds map<"),
        (pa.array([b"1.5"] * 500), "column 'fx' holds binary, not numbers"),
        (pa.nulls(500), "column 'fx' holds no numbers"),
        (pa.array(["x" * 100_000] * 500), "column 'fx' holds no numbers"),
    ],
)
def test_columns_that_hold_no_numbers_are_one_line_and_no_harm_beside_others(
    tmp_path: Path, array: pa.Array, says: str
) -> None:
    table = pa.table(frame(end=1.0))
    assert says in refused(lambda: read_log([written(tmp_path / "a.parquet", table.set_column(1, "fx", array))]))
    assert len(read_log([written(tmp_path / "a.parquet", table.append_column("more", array))]).readings) == 500


@pytest.mark.parametrize(
    "array",
    [
        pa.array([1.5] * 500).dictionary_encode(),
        pa.array(["1.5"] * 500),
        pa.array(["1.5"] * 500, pa.large_string()),
        pa.array(["1.5"] * 500).dictionary_encode(),
        pa.array([1.5] * 500).cast(pa.float16()),
        pa.array([1.5] * 500).cast(pa.decimal128(5, 2)),
    ],
)
def test_numbers_of_any_kind_are_numbers(tmp_path: Path, array: pa.Array) -> None:
    table = pa.table(frame(end=1.0)).set_column(1, "fx", array)
    assert read_log([written(tmp_path / "a.parquet", table)]).readings[:, 1].tolist() == [1.5] * 500


@pytest.mark.parametrize(
    "said",
    [
        {"index_columns": ["nothing"], "columns": [], "column_indexes": []},
        {"index_columns": [{"kind": "range", "name": "t", "start": 0, "stop": 10**18, "step": 1}], "columns": []},
        [1],
        "{",
    ],
)
def test_what_pandas_said_of_an_index_is_not_believed(tmp_path: Path, said: Any, catapult: Flight) -> None:
    told = {"pandas": said if said == "{" else json.dumps(said)}
    table = pa.table(frame(end=1.0))
    path = written(tmp_path / "a.parquet", table.replace_schema_metadata(told))
    assert np.array_equal(read_log([path]).readings, frame(end=1.0).to_numpy())
    folder = catapult.save(tmp_path / "flight")
    truth = pq.read_table(folder / "truth.parquet")
    pq.write_table(truth.replace_schema_metadata(told), folder / "truth.parquet")
    pd.testing.assert_frame_equal(load(folder).truth, catapult.truth)


def test_an_index_that_is_absent_is_one_line(tmp_path: Path) -> None:
    indexed = pa.Table.from_pandas(frame(end=1.0).set_index("t"))
    path = written(tmp_path / "a.parquet", indexed.drop_columns(["t"]).replace_schema_metadata(indexed.schema.metadata))
    assert "lacks t; it has fx, fy, fz" in refused(lambda: read_log([path]))


def test_a_flights_columns_must_be_numbers(tmp_path: Path, catapult: Flight) -> None:
    folder = catapult.save(tmp_path / "flight")
    table = pq.read_table(folder / "accelerometer.parquet")
    for array in (pa.array(["a"] * len(table)), pa.array([{"a": 1}] * len(table))):
        pq.write_table(table.set_column(1, "fx", array), folder / "accelerometer.parquet")
        assert "column 'fx' holds" in refused(lambda: load(folder))


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_ten_thousand_columns(tmp_path: Path, suffix: str) -> None:
    more = pd.DataFrame(np.ones((20, 9996)), columns=[f"column number {i}" for i in range(9996)])
    table = pd.concat([frame(end=0.04), more], axis=1)
    path = written(tmp_path / f"a{suffix}", table)
    assert len(read_log([path]).readings) == 20
    said = refused(lambda: read_log([written(tmp_path / f"a{suffix}", table.rename(columns={"fx": "q"}))]))
    assert "lacks fx; it has t, q, fy, fz, column number 0" in said
    assert "and 9988 more" in said


def test_columns_beyond_the_limit_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(",".join(f"c{i}" for i in range(30_000)) + "\n", encoding="ascii")
    assert "has 30000 columns; at most 20000 are read" in refused(lambda: read_log([path]))


@pytest.mark.parametrize("seed", range(30))
def test_a_damaged_parquet_file_is_read_or_one_line(tmp_path: Path, seed: int) -> None:
    noise = np.random.default_rng(seed)
    path = written(tmp_path / "a.parquet", frame(end=1.0))
    content = bytearray(path.read_bytes())
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    first = footer if seed % 2 else 4
    for place in noise.integers(first, len(content) - 4, 1 + seed % 5):
        content[place] ^= 1 << int(noise.integers(8))
    if seed % 7 == 0:
        del content[int(noise.integers(8, len(content))) :]
    path.write_bytes(content)
    try:
        assert isinstance(read_log([path]), Recording)
    except ValueError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)
        assert len(str(error)) < LONGEST  # noqa: PT017


# -- CSV -------------------------------------------------------------------------------------------------------------

TEXT = frame(end=1.0).to_csv(index=False)


@pytest.mark.parametrize(
    "content",
    [
        TEXT.encode("utf-16"),
        b"\xfe\xff" + TEXT.encode("utf-16-be"),
        TEXT.encode("utf-32"),
        b"\xef\xbb\xbf" + TEXT.encode(),
        TEXT.replace("\n", "\r").encode(),
        TEXT.replace("\n", "\r\n").encode(),
        TEXT.replace(",", "\t").encode(),
    ],
)
def test_text_in_any_encoding_is_read(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    assert np.array_equal(read_log([path]).readings, frame(end=1.0).to_numpy())


def test_names_in_latin_1_can_be_mapped(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(TEXT.replace("fx", "fx [m/s²]").encode("latin-1"))
    assert len(read_log([path], "fx=fx [m/s²]").readings) == 500


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "an empty file"),
        (bytes(4096), "a binary file"),
        (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20, "a binary file"),
        (b"t,fx,fy,fz", "holds a line of names (t, fx, fy, fz) and no line of numbers below it"),
        (b"t,fx,fy,fz\n", "holds a line of names (t, fx, fy, fz) and no line of numbers below it"),
        (b"t,fx,fy,fz\ns,m/s^2,m/s^2,m/s^2\n", "holds a line of names (t, fx, fy, fz) and no line of numbers"),
        (b"x" * 2_000_000, "no names in the first 1000 kB"),
        (b"# remark\n" * 200_000, "no names in the first 1000 kB"),
        (TEXT.replace("fx", "f" * 100_000).encode(), "it has t, ffffff"),
        (b"t,fx,fy,fz\n" + b"1,2,3,4,5,6\n" * 20, "has 4 names, and lines of 6 values"),
        (b"t,fx,fy,fz\n" + (b"1," * 50_000 + b"\n") * 3, "has 50001 columns; at most 20000 are read"),
        (b"\x28\xb5\x2f\xfd" + bytes(99), "is packed by zstd: unpack it first"),
        (b"7z\xbc\xaf\x27\x1c" + bytes(99), "is packed by 7-Zip"),
    ],
)
def test_what_is_no_table_is_one_line(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    assert says in refused(lambda: read_log([path]))
    assert says in refused(lambda: read_bench_log(path, ("t", *FORCE)))


def test_a_cell_of_1e5_characters_is_no_number(tmp_path: Path) -> None:
    table = frame(end=1.0).astype(object)
    table.loc[3, "fy"] = "z" * 100_000
    recording = read_log([written(tmp_path / "a.csv", table)])
    assert np.isnan(recording.readings[3, 2])


def test_a_line_of_more_values_than_names_is_left_out_and_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(TEXT.encode() + b"1,2,3,4,5,6\n")
    recording = read_log([path])
    assert len(recording.readings) == 500
    assert recording.remarks == (f"{path}: 1 lines have more values than there are names and are left out",)


def test_the_rows_of_a_csv_file_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MOST_ROWS", 400)
    path = written(tmp_path / "a.csv", frame(end=1.0))
    assert "a.csv: has more than 400 rows; at most 400 are read" in refused(lambda: read_log([path]))


def test_pieces_of_a_csv_file_change_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = frame(end=1.0).astype(object)
    table.loc[[3, 300], "fx"] = "n/a"
    path = written(tmp_path / "a.csv", table)
    whole = read_log([path]).readings
    monkeypatch.setattr(tables, "BLOCK", 500)
    assert np.array_equal(read_log([path]).readings, whole, equal_nan=True)


# -- maps and names --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "mapping",
    [
        ",".join(f"a{i}=b" for i in range(10_000)),
        "fx=" + "a" * 100_000,
        "fx=" + "a" * 9000,
        "f" * 9000 + "=a",
        "fx=a*" + "1" * 9000 + "x",
        "fx=" + "*1" * 4000,
        "fx=\x1b[31m\0\r\n",
        "fx=[bold]$\\frac{a}$",
    ],
)
def test_any_map_is_one_line_of_sane_length(tmp_path: Path, mapping: str) -> None:
    path = written(tmp_path / "a.csv", frame(end=0.1))
    refused(lambda: read_log([path], mapping))
    with pytest.raises(ValueError, match=r"^[^\n]*$"):
        bench_log.parse_map(mapping + "," * 10_000, ("t", "fx"))


# -- files -----------------------------------------------------------------------------------------------------------


def test_only_regular_files_are_opened(tmp_path: Path) -> None:
    """A pipe without a writer would be waited for for good, /dev/zero read without end."""
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), Path("/dev/stdin") if not os.path.isfile("/dev/stdin") else pipe):
        for read in (lambda p=path: read_log([p]), lambda p=path: read_bench_log(p, ("t", *FORCE))):
            assert "is a pipe, a device or a socket" in refused(read)
    (tmp_path / "leads.csv").symlink_to(tmp_path / "nowhere")
    assert "is a link that leads nowhere" in refused(lambda: read_log([tmp_path / "leads.csv"]))
    (tmp_path / "loop.csv").symlink_to(tmp_path / "loop.csv")
    assert "cannot be opened: " in refused(lambda: read_log([tmp_path / "loop.csv"]))
    assert "there is no such file, but a folder of that name" in refused(lambda: read_log([tmp_path]))
    assert "there is no such file" in refused(lambda: read_log([tmp_path / "none.csv"]))
    if Path("/proc/self/status").exists():
        assert "is a file of the system" in refused(lambda: read_log([Path("/proc/self/status")]))
    assert "cannot be opened: " in refused(lambda: read_log([tmp_path / ("a" * 300)]))


def test_a_file_that_may_not_be_read_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "a.csv", frame(end=0.1))

    def refuse(*_: object, **__: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(files.os, "open", refuse)
    assert refused(lambda: read_log([path])).endswith("a.csv: cannot be opened: Permission denied")


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    """A file with a hole: it takes no place on the disk."""
    path = tmp_path / "a.ulg"
    with path.open("wb") as file:
        file.write(b"ULog\x01\x12\x35")
        file.truncate(3_000_000_000)
    assert "a.ulg: has 3 GB; of its kind at most 1 GB are read" in refused(lambda: read_log([path]))
    with path.open("wb") as file:
        file.write(b"\x1f\x8b\x08")
        file.truncate(3_000_000_000)
    assert "a.ulg: has 3 GB; of its kind at most 1 GB are read" in refused(lambda: read_log([path]))


def zipped(**inside: bytes) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in inside.items():
            archive.writestr(f"{name}.csv", content)
    return packed.getvalue()


PACKERS = {"gz": gzip.compress, "bz2": bz2.compress, "xz": lzma.compress, "zip": lambda content: zipped(log=content)}


@pytest.mark.parametrize("name", PACKERS)
def test_packed_logs_are_read_cut_ones_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"a.csv.{name}"
    packed = PACKERS[name](TEXT.encode())
    path.write_bytes(packed)
    assert np.array_equal(read_log([path]).readings, frame(end=1.0).to_numpy())
    for cut in (1, 10, 100, 1000, len(packed) - 20):
        path.write_bytes(packed[:-cut])
        assert "cannot be unpacked" in refused(lambda: read_log([path]))


@pytest.mark.parametrize("name", PACKERS)
@pytest.mark.parametrize("seed", range(4))
def test_damaged_packed_logs_are_read_or_one_line(tmp_path: Path, name: str, seed: int) -> None:
    packed = bytearray(PACKERS[name](TEXT.encode()))
    packed[np.random.default_rng(seed).integers(4, len(packed))] ^= 0xFF
    path = tmp_path / "a.csv"
    path.write_bytes(packed)
    try:
        assert isinstance(read_log([path]), Recording)
    except ValueError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)


@pytest.mark.parametrize("name", PACKERS)
def test_what_unpacks_without_end_is_one_line(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "UNPACKED", 1_000_000)
    path = tmp_path / "bomb"
    path.write_bytes(PACKERS[name](bytes(20_000_000)))
    assert "unpacks to more than 1 MB: unpack it first" in refused(lambda: read_log([path]))


def test_other_archives_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(zipped(a=b"1", b=b"2"))
    assert "is a zip archive of 2 files, not of one" in refused(lambda: read_log([path]))
    path.write_bytes(zipped())
    assert "is a zip archive of 0 files" in refused(lambda: read_log([path]))
    path.write_bytes(gzip.compress(gzip.compress(TEXT.encode())))
    assert "is packed twice" in refused(lambda: read_log([path]))
    with tarfile.open(tmp_path / "a.tar", "w") as archive:
        archive.add(path)
    assert "is packed by tar" in refused(lambda: read_log([tmp_path / "a.tar"]))


# -- autopilots' logs that are damaged -------------------------------------------------------------------------------

ROWS = frame(rate=200.0, end=3.0)
MAKERS = {"ulog": ulog, "binary": dataflash, "text": dataflash_text}
SIZES = {"ulog": 25, "binary": 24, "text": 10**9}  # B, of a message
HEADERS = {"ulog": b"\x16\x00D", "binary": b"\xa3\x95", "text": b"IMU"}
WAYS = ("truncate", "zero", "flip", "header", "insert", "double")


def whole(kind: str) -> bytes:
    return MAKERS[kind](list(ROWS.itertuples(index=False, name=None)))


def damaged(content: bytes, way: str, noise: np.random.Generator, header: bytes) -> bytes:
    """Damage a log somewhere behind its first 300 bytes, in which its formats are."""
    place, size = int(noise.integers(300, len(content) - 500)), int(noise.integers(100, 500))
    if way == "truncate":
        return content[:place]
    if way == "zero":
        return content[:place] + bytes(size) + content[place + size :]
    if way == "insert":
        return content[:place] + noise.bytes(size) + content[place:]
    if way == "double":
        return content[: place + size] + content[place:]
    spoilt = bytearray(content)
    places = noise.integers(300, len(content) - 500, 3).tolist()
    if way == "header":
        places = [content.index(header, at) + int(noise.integers(len(header))) for at in places]
    for at in places:
        spoilt[at] ^= 1 << int(noise.integers(8))
    return bytes(spoilt)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", MAKERS)
def test_what_is_lost_of_a_damaged_log_is_told_and_the_rest_is_right(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], kind: str, way: str
) -> None:
    """25 of each: what could be read is what was written, what is missing is remarked, nothing is printed.

    A bit that is flipped in a value cannot be seen; that way there is nothing to compare. Where a block comes
    twice, two halves may make one reading that is as it should be.
    """
    content, path = whole(kind), tmp_path / f"a.{kind}"
    path.write_bytes(content)
    good = read_log([path])
    written = {tuple(row) for row in good.readings.tolist()}
    read = 0
    for seed in range(25):
        path.write_bytes(damaged(content, way, np.random.default_rng(seed), HEADERS[kind]))
        try:
            recording = read_log([path])
        except ValueError as error:
            assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)
            assert len(str(error)) < LONGEST  # noqa: PT017
            allowed = {"double": "time runs backwards", "truncate": "too few"}
            assert way == "flip" or allowed[way] in str(error)  # noqa: PT017
            continue
        read += 1
        rows = recording.readings.tolist()
        if way != "flip":
            assert len({tuple(row) for row in rows} - written) <= (way == "double")
        if (
            way != "flip"
            and len(rows) < len(written)
            and not (way == "truncate" and _between_messages(path, recording))
        ):
            (remark, *_) = recording.remarks
            assert "what could be read is replayed; it ends at" in remark
            assert ("is truncated" in remark) == (way == "truncate")
            assert len(remark) < LONGEST
        assert len(rows) > 0.7 * len(written) or way == "truncate"
    assert read > 5 or way == "double"
    assert capfd.readouterr() == ("", "")


def _between_messages(path: Path, recording: Recording) -> bool:
    """Whether a log was cut exactly between two messages, which nobody can see."""
    content, kind = path.read_bytes(), path.suffix[1:]
    return not recording.remarks and (content.endswith(b"\n") or (len(whole(kind)) - len(content)) % SIZES[kind] == 0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", MAKERS)
def test_damage_of_any_size_and_place_is_read_or_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], kind: str
) -> None:
    """2000 of each kind: several ways at once, from the first byte on, up to half of the log."""
    content, path = whole(kind), tmp_path / f"a.{kind}"
    for seed in range(2000):
        noise = np.random.default_rng(10_000 + seed)
        spoilt = bytearray(content)
        for _ in range(1 + seed % 4):
            place, size = int(noise.integers(len(spoilt))), int(2 ** noise.uniform(0.0, 14.0))
            change = [b"", bytes(size), noise.bytes(size), b"\xff" * size, spoilt[:size]][int(noise.integers(5))]
            spoilt[place : place + (size if noise.integers(2) else 0)] = change
        path.write_bytes(spoilt)
        try:
            replay_log(read_log([path]))
        except ValueError as error:
            assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)
            assert len(str(error)) < LONGEST  # noqa: PT017
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", MAKERS)
def test_twenty_thousand_zeros_are_one_remark(tmp_path: Path, capfd: pytest.CaptureFixture[str], kind: str) -> None:
    content, path = whole(kind), tmp_path / "a.bin"
    middle = content.index(b"\n", len(content) // 2) + 1 if kind == "text" else len(content) // 2
    path.write_bytes(content[:middle] + bytes(20_000) + content[middle:])
    (remark,) = read_log([path]).remarks
    lost = int(remark.split("damaged and ")[1].split()[0])
    assert 20_000 <= lost <= 20_100  # and the message before, or in, which they are
    assert capfd.readouterr() == ("", "")


def formats(*texts: str) -> bytes:
    """Make a ULog of formats, and a subscription to the last."""
    log = b"ULog\x01\x12\x35\x01" + bytes(8)
    for text in texts:
        log += len(text).to_bytes(2, "little") + b"F" + text.encode()
    name = texts[-1].partition(":")[0].encode()
    return log + (3 + len(name)).to_bytes(2, "little") + b"A" + bytes(3) + name


@pytest.mark.parametrize(
    "texts",
    [
        ("a:a x;",),
        ("a:b x;", "b:a x;"),
        ("a:float[60000] x;",),
        ("a:a[9999] x;",),
        ("a:float[9000] x;", "b:a[9000] x;", "c:b[9000] x;"),
        ("a:float x;float x;",),
        ("a:uint8_t _padding0;",),
        ("a:unknown x;",),
    ],
)
def test_formats_that_are_made_to_grow_are_left_out(texts: tuple[str, ...]) -> None:
    found = read_ulog(formats(*texts), {"a", "b", "c"})
    assert found.tables == {}
    assert found.damage.startswith("is damaged and ")


def test_a_ulog_that_is_all_beginnings_is_given_up() -> None:
    """Each place looks like data of a known number, and at none can reading go on."""
    content = formats("a:uint16_t[7] x;") + b"\x01" + b"\x10\x00D\x00\x00\x01" * 200_000
    with pytest.raises(ValueError, match="damaged in too many places to be read"):
        read_ulog(content, {"a"})


def test_a_ulog_with_damage_in_every_message_is_given_up() -> None:
    """Each search for where reading goes on ends at once, and there are a hundred thousand."""
    content = formats("a:uint16_t[7] x;") + b"\x02\x00A\x00\x00" * 100_000 + b"\x04\x00A\x00\x00\x00b--" * 100_000
    with pytest.raises(ValueError, match="damaged in too many places to be read"):
        read_ulog(content, {"a"})


def test_cut_messages_one_behind_the_other_are_no_ladder() -> None:
    """Whether the log ends at one of them is not asked of the next."""
    rung = b"\x10\x00D\x00\x00" + bytes(14) + b"\xff\x3fR"
    found = read_ulog(formats("a:uint16_t[7] x;") + rung * 600, {"a"})
    assert found.damage


@pytest.mark.parametrize("size", [0, 1, 2, 3, 255])
def test_a_dataflash_format_that_leads_nowhere_is_left_out(tmp_path: Path, size: int) -> None:
    """A message of no length would be read for ever."""
    content = bytearray(whole("binary"))
    place = content.index(b"IMU\0") - 1
    content[place] = size
    path = tmp_path / "a.bin"
    path.write_bytes(content)
    assert "no message with its format is in it" in refused(lambda: read_log([path]))


def test_a_message_that_was_never_logged_is_said(tmp_path: Path) -> None:
    path = tmp_path / "a.ulg"
    path.write_bytes(whole("ulog")[: 16 + 3 + 62 + 2 * 21])
    said = refused(lambda: read_log([path], "fx=sensor_combined.x"))
    assert "has no message sensor_combined that was logged (sensor_combined was never logged)" in said
    assert "it has no logged messages" in said


def test_the_command_says_what_is_lost_once_and_nothing_else(tmp_path: Path) -> None:
    path, out = tmp_path / "a.bin", tmp_path / "out"
    content = whole("binary")
    path.write_bytes(content[:20_000] + bytes(20_000) + content[20_000:])
    command = [sys.executable, "-m", "uavsim.cli", "replay", str(path), "--no-plots", "--out", str(out)]
    run = subprocess.run(command, check=False, capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
    assert sum("could not be read" in line for line in run.stdout.splitlines()) == 1
    remarks = json.loads((out / "score.json").read_text(encoding="utf-8"))["recording"]["remarks"]
    assert remarks[0].split(": ", 1)[1].startswith("the DataFlash log is damaged and 200")


def test_a_log_whose_name_leads_in_circles_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    command = [sys.executable, "-m", "uavsim.cli", "replay", str(tmp_path / "loop")]
    run = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
