"""Somebody's bench log: what is read, what is mended and told, what is refused in one line."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.bench_log import Source, parse_map, read_bench_log

ACCELEROMETER = ("t", "fx", "fy", "fz")


def frame(rows=2000, rate=100.0, seed=1):
    rng = np.random.default_rng(seed)
    t = 50.0 + np.arange(rows) / rate
    return pd.DataFrame({"t": t, **{name: rng.normal(size=rows) for name in ACCELEROMETER[1:]}})


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a table and reads it as a log."""

    def read(table, columns=ACCELEROMETER, optional=(), text="", **mapping):
        path = tmp_path / "log.csv"
        path.write_text(text or table.to_csv(index=False), encoding="utf-8")
        return read_bench_log(path, columns, optional, {k: Source(v) for k, v in mapping.items()})

    return read


# -- what is read ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [0.1, 1.0, 104.0, 833.0, 10_000.0])
def test_an_even_log_is_taken_as_it_is(written, rate):
    table = frame(rate=rate)
    log = written(table)
    assert log.columns == ACCELEROMETER
    assert log.rate == pytest.approx(rate, rel=1e-6)
    assert log.duration == pytest.approx(1999 / rate, rel=1e-6)
    assert np.array_equal(log.table[:, 1:], table.to_numpy()[:, 1:])
    assert (log.dropped, log.gaps, log.missing, log.remarks()) == (0, 0, 0, [])


@pytest.mark.parametrize("separator", [",", ";", "\t", " , "])
def test_separators_comments_and_a_byte_order_mark(written, separator):
    table = frame()
    lines = [separator.join(map(str, row)) for row in [table.columns, *table.to_numpy().tolist()]]
    text = "\ufeff# my log, of a rainy day; see notes\n" + "\n".join([lines[0], "# warm", *lines[1:]])
    assert written(table, text=text).table == pytest.approx(table.to_numpy())


def test_other_names_and_units(written):
    table = frame()
    theirs = table.rename(columns={"t": "time ms", "fx": "imu[0].x", "fy": "a*b", "fz": "z"})
    theirs["time ms"] *= 1000.0
    theirs["imu[0].x"] /= 9.80665
    log = written(theirs, t="time ms*0.001", fx="imu[0].x * 9.80665", fy="a*b", fz="z*-1e0")
    assert log.table[:, 1:3] == pytest.approx(table.to_numpy()[:, 1:3])
    assert log.table[:, 3] == pytest.approx(-table["fz"].to_numpy())
    assert log.rate == pytest.approx(100.0)


def test_what_is_not_needed_may_be_there_or_not(written):
    table = frame().rename(columns={"fx": "pressure", "fy": "temperature"})
    assert written(table, ("t", "pressure"), ("temperature",)).columns == ("t", "pressure", "temperature")
    assert written(table[["t", "pressure"]], ("t", "pressure"), ("temperature",)).columns == ("t", "pressure")


def test_stamps_that_are_rounded_to_much_of_an_interval(written):
    """833 Hz stamped in whole milliseconds: the median interval would be 1 ms, and every fifth would be a gap."""
    table = frame(rows=5000, rate=833.0)
    table["t"] = np.floor(table["t"] * 1000.0) / 1000.0
    table = table[table["t"].diff().fillna(1.0) > 0.0]
    log = written(table)
    assert log.rate == pytest.approx(833.0, rel=2e-3)
    assert log.gaps == 0
    assert "jitter by 0.4" in log.remarks()[0]


# -- what is mended --------------------------------------------------------------------------------------------------


def test_rows_that_are_no_numbers_are_dropped_and_counted(written):
    table = frame().astype(object)
    table.loc[7, "fx"] = "n/a"
    table.loc[8, "fz"] = ""
    table.loc[90, "t"] = float("nan")
    table.loc[1000, "fy"] = "inf"
    log = written(table)
    assert log.dropped == 4
    assert (log.gaps, log.missing) == (3, 4)
    assert len(log.table) == 2000
    assert log.remarks()[0] == "4 rows hold something else than numbers and are left out"


def test_a_few_missing_readings_are_straight_lines(written):
    table = frame()
    log = written(table.drop(index=[*range(100, 110), 500]))
    assert (log.gaps, log.missing, log.filled) == (2, 11, True)
    assert log.table[:, 0] == pytest.approx(table["t"])
    line = np.linspace(table["fx"][99], table["fx"][110], 12)
    assert log.table[99:111, 1] == pytest.approx(line)
    assert np.array_equal(log.table[110:500, 1:], table.to_numpy()[110:500, 1:])
    assert log.remarks() == ["11 readings are missing in 2 gaps: filled in by straight lines"]


def test_of_many_gaps_the_longest_stretch_is_left(written):
    table = frame(rows=4000)
    log = written(table.drop(index=[*range(100, 600), *range(2000, 2300)]))
    assert (log.gaps, log.missing, log.filled) == (2, 800, False)
    assert np.array_equal(log.table[:, 1:], table.to_numpy()[2300:, 1:])
    assert "the longest stretch without a gap is taken" in log.remarks()[0]


def test_jitter_is_told_and_evened_out(written):
    table = frame()
    table["t"] += np.random.default_rng(2).uniform(-1e-3, 1e-3, len(table))
    log = written(table)
    assert np.ptp(np.diff(log.table[:, 0])) < 1e-9
    assert log.jitter == pytest.approx(1e-3 * (2.0 / 3.0) ** 0.5, rel=0.1)  # of differences of two uniform ones
    assert log.rate == pytest.approx(100.0, rel=1e-3)


# -- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda f: f.drop(columns="fy"), "lacks fy; it has t, fx, fz; say which is which with --map fy=…"),
        (lambda f: f.rename(columns=str.upper), "lacks t, fx, fy, fz; it has T, FX, FY, FZ"),
        (lambda f: f.iloc[:500], "500 rows of numbers are too few; at least 1000 are needed"),
        (lambda f: f.iloc[:0], "no line of numbers below it"),
        (lambda f: f.assign(fx="a"), "column 'fx' holds no numbers"),
        (lambda f: f.iloc[::-1], "t does not rise: 69.98 s comes after 69.99 s (row 2 of numbers)"),
        (lambda f: f.assign(t=f["t"].where(f.index != 40, 50.39)), "50.39 s comes after 50.39 s (row 41 of numbers)"),
        (lambda f: f.assign(t=f["t"] * 1e-6), "is t in seconds?"),
        (lambda f: f.assign(t=f["t"] * 1e9), "is t in seconds?"),
        (lambda f: f.assign(t=f["t"] + 5.0 * (f.index // 500)), "the longest stretch without a gap has 500 readings"),
    ],
)
def test_a_log_that_cannot_be_used_is_one_line_with_its_name(written, change, says):
    with pytest.raises(ValueError, match=r"^[^\n]*log\.csv: [^\n]*$") as caught:
        written(change(frame()))
    assert says in str(caught.value)


@pytest.mark.parametrize("text", ["\x00\x01", "a,b\n1,2,3\n4,5,6,7\n", "one word", '"never closed\n1,2', "\n\n"])
def test_what_is_no_table_is_one_line_with_its_name(written, text):
    with pytest.raises(ValueError, match=r"^[^\n]*log\.csv: [^\n]+$"):
        written(frame(), text=text)


def test_a_mapped_column_that_is_not_there(written):
    with pytest.raises(ValueError, match=r"has no column 'ax\*\*2'; it has t, fx, fy, fz"):
        written(frame(), fx="ax**2")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "give it as ours=theirs"),
        ("t", "'t': give it as ours=theirs"),
        ("t=", "give it as"),
        ("=time", "give it as"),
        ("t=a,,fx=b", "give it as"),
        ("x=a", "'x' is no column of ours; they are t, fx, fy, fz"),
        ("t=a,t=b", "'t' is given twice"),
    ],
)
def test_a_map_that_is_none_is_refused(text, says):
    with pytest.raises(ValueError, match=r"^[^\n]*$") as caught:
        parse_map(text, ACCELEROMETER)
    assert says in str(caught.value)


@settings(deadline=None, derandomize=True)
@given(st.text("tfxyz=,* ab0.", max_size=20) | st.text(max_size=10))
def test_any_text_is_a_map_or_refused(text):
    try:
        found = parse_map(text, ACCELEROMETER)
    except ValueError:
        return
    assert set(found) <= set(ACCELEROMETER)
    assert all(source.column for source in found.values())
