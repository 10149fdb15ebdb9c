"""Somebody's logs: what is read, how files are joined, what is refused in one line, what the detector finds."""

import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.bench_log import Source, resolved
from uavsim.flight import load
from uavsim.logs import PAUSE, Recording, read_log, replay_log
from uavsim.onboard.launch import DetectorSettings, default
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views import log as view

RECORDINGS = os.environ.get("UAVSIM_RECORDINGS")
ONSET, STROKE, PUSH = 3.0, 0.25, 80.0  # s, s, m/s²


def frame(rate: float = 500.0, start: float = 0.0, end: float = 6.0, onset: float = ONSET, seed: int = 1):
    """Make readings of a rest on a rail, a stroke, and level flight."""
    noise = np.random.default_rng(seed)
    t = start + np.arange(round((end - start) * rate)) / rate
    fx = 1.5 + np.where((t >= onset) & (t < onset + STROKE), PUSH, 0.0) + noise.normal(0.0, 0.3, t.size)
    return pd.DataFrame({"t": t, "fx": fx, "fy": noise.normal(0.0, 0.3, t.size), "fz": -9.7 + 0.0 * t})


@pytest.fixture
def read(tmp_path: Path):
    """Return a function that writes tables as CSV and reads them as one log."""

    def call(*tables: pd.DataFrame, mapping: str | None = None) -> Recording:
        paths = [tmp_path / f"part{i}.csv" for i in range(len(tables))]
        for path, table in zip(paths, tables, strict=True):
            table.to_csv(path, index=False)
        return read_log(paths, mapping)

    return call


def detections(recording: Recording, **settings: Any) -> list[float]:
    flight = replay_log(recording, DetectorSettings(**settings) if settings else None)
    return flight.score["recording"]["detections"]


# -- what is read ----------------------------------------------------------------------------------------------------


def test_csv_and_parquet_give_the_same_numbers(tmp_path: Path) -> None:
    table = frame()
    table.to_csv(tmp_path / "a.csv", index=False)
    table.to_parquet(tmp_path / "a.parquet")
    table.set_index("t").to_parquet(tmp_path / "indexed.pq")
    for name in ("a.csv", "a.parquet", "indexed.pq"):
        recording = read_log([tmp_path / name])
        assert np.array_equal(recording.readings, table.to_numpy())
        assert (recording.remarks, recording.gaps(), recording.clipping()) == ((), [], [])


def test_names_with_brackets_and_spaces_signs_and_factors(read) -> None:
    table = frame()
    theirs = pd.DataFrame(
        {
            "time [ms]": table["t"] * 1e3,
            "acc[0] x": -table["fx"] / STANDARD_GRAVITY,
            "-y": table["fy"] / STANDARD_GRAVITY,
            "a*2": -table["fz"] / STANDARD_GRAVITY,
        }
    )
    mapping = "t=time [ms]*1e-3, fx=-acc[0] x * 9.80665, fy=-y*9.80665, fz=a*2*-9.80665"
    assert read(theirs, mapping=mapping).readings == pytest.approx(table.to_numpy())


def test_dates_are_seconds_since_1970(tmp_path: Path) -> None:
    table = frame()
    stamped = table.assign(t=pd.to_datetime(1.7e9 + table["t"], unit="s"))
    stamped.to_parquet(tmp_path / "dated.parquet")
    recording = read_log([tmp_path / "dated.parquet"])
    assert recording.span == pytest.approx((1.7e9, 1.7e9 + table["t"].iloc[-1]), abs=1e-6)


@pytest.mark.parametrize("rate", [38.0, 50.0, 137.0, 1000.0, 4000.0])
def test_a_stroke_is_found_at_any_rate_with_jitter(read, rate: float) -> None:
    """The detection comes within the first window, 18 ms, and two periods of the onset, on the log's own time."""
    table = frame(rate, start=-1.0, end=2.0, onset=0.5)
    table["t"] += np.random.default_rng(2).uniform(-0.2, 0.2, len(table)) / rate
    recording = read(table)
    assert recording.rate == pytest.approx(rate, rel=0.02)
    (found,) = detections(recording)
    assert 0.5 <= found <= 0.5 + 0.018 + 2.5 / rate


def test_the_median_rate_is_not_the_mean(read) -> None:
    table = frame(100.0)
    table.loc[400:, "t"] += 30.0
    assert read(table).rate == pytest.approx(100.0, rel=1e-6)


def test_time_may_begin_below_0(read) -> None:
    recording = read(frame(start=-4.0, end=1.0, onset=-1.0))
    assert recording.span[0] == -4.0
    (found,) = detections(recording)
    assert -1.0 < found < -0.97


# -- what is not as it should be -------------------------------------------------------------------------------------


def test_a_gap_of_a_second_is_told_and_a_launch_after_it_found(read) -> None:
    table = frame()
    recording = read(table[(table["t"] < 1.9) | (table["t"] > 2.9)])
    (gap,) = recording.gaps()
    assert (gap.start, gap.end) == pytest.approx((1.898, 2.902))
    assert len(detections(recording)) == 1


def test_rows_without_numbers(read) -> None:
    """Without a time a row is left out; without an axis it stays, and the detector passes over it."""
    table = frame().astype(object)
    table.loc[10, "t"] = "n/a"
    table.loc[20, "fx"] = ""
    table.loc[30, "fy"] = "inf"
    recording = read(table)
    assert len(recording.readings) == len(table) - 1
    assert np.isnan(recording.readings[19, 1])
    assert np.isnan(recording.readings[29, 2])
    assert [remark.split(": ", 1)[1] for remark in recording.remarks[:1]] == ["1 rows have no time and are left out"]
    assert recording.remarks[1] == "2 readings lack an axis: the detector passes over them"
    assert len(detections(recording)) == 1


def test_equal_times_are_one_reading(read) -> None:
    table = frame()
    table.loc[100, "t"] = table.loc[99, "t"]
    recording = read(table)
    assert len(recording.readings) == len(table) - 1
    assert recording.remarks[0].endswith("1 rows have the time of the row before")


def test_clipping_is_seen_where_a_value_is_held(read) -> None:
    table = frame()
    assert read(table).clipping() == []
    table["fx"] = table["fx"].clip(upper=70.0)
    (clipped,) = read(table).clipping()
    assert (clipped.axis, clipped.level, clipped.samples) == ("fx", 70.0, round(STROKE * 500.0))
    assert clipped.start == pytest.approx(ONSET)
    table["fx"] *= -1.0
    assert [c.level for c in read(table).clipping()] == [-70.0]


# -- several files ---------------------------------------------------------------------------------------------------


def test_files_of_all_axes_follow_each_other_in_whatever_order(read) -> None:
    table = frame()
    assert np.array_equal(read(table[2000:], table[:2000]).readings, table.to_numpy())


def test_axes_of_other_files_come_to_the_times_of_fx(read) -> None:
    """A straight line between readings is exact on a straight line; outside and in gaps there is nothing."""
    table = frame()
    t = np.arange(0.5, 5.0, 0.013)
    other = pd.DataFrame({"t": t, "fy": 2.0 * t, "fz": -9.8 - t})
    recording = read(table[["t", "fx"]], other[(t < 1.0) | (t > 2.0)])
    at, inside = recording.readings[:, 0], ~np.isnan(recording.readings[:, 2])
    assert np.array_equal(recording.readings[:, :2], table[["t", "fx"]].to_numpy())
    assert recording.readings[inside, 2] == pytest.approx(2.0 * at[inside])
    assert recording.readings[inside, 3] == pytest.approx(-9.8 - at[inside])
    assert not inside[(at < 0.5) | (at > 4.999) | ((at > 1.0) & (at < 2.0))].any()
    assert inside[(at > 0.5) & (at < 0.98)].all()
    assert len(detections(recording)) == 1


def test_a_file_of_something_else_is_left_out_and_told(read) -> None:
    recording = read(frame(), pd.DataFrame({"t": [0.0, 1.0], "airspeed": [5.0, 6.0]}))
    assert recording.remarks[0].endswith("part1.csv holds none of fx, fy, fz with a time and is left out")


# -- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "mapping", "says"),
    [
        (lambda f: f[["t", "fy"]].rename(columns={"fy": "b"}), None, "lacks fx, fy, fz; it has t, b; say which"),
        (lambda f: f.add_prefix("my "), None, "lacks t, fx, fy, fz; it has my t, my fx, my fy, my fz; say which"),
        (lambda f: f, "fx=ax", "has no column 'ax'; it has t, fx, fy, fz; say which is which with --map fx=…"),
        (lambda f: f.iloc[::-1], None, "time runs backwards: 5.996 s comes after 5.998 s (row 2)"),
        (lambda f: f.assign(t=f["t"] * 1e6), None, "map t=…*1e-6 if it is in microseconds"),
        (lambda f: f.assign(t=f["t"] * 1e-6), None, "from 1 to 20000 are understood"),
        (lambda f: f[:5], None, "5 rows with a time are too few; at least 10 are needed"),
        (lambda f: f.assign(fx="a"), None, "column 'fx' holds no numbers"),
        (lambda f: f.assign(fx=f["fx"].where(f.index % 2 == 0), fy=f["fy"].where(f.index % 2 == 1)), None, "no row"),
        (
            lambda f: f.assign(fx=f["fx"] / 9.8, fy=f["fy"] / 9.8, fz=f["fz"] / 9.8),
            None,
            "which looks like g and not m/s²: map fx=…*9.80665",
        ),
        (lambda f: f.assign(fz=f["fz"] * 200.0), None, "which looks like mg or counts and not m/s²"),
        (lambda f: f, "fx=fx*9.80665", "the map mixes units, scaling fx by 9.80665, fy by 1, fz by 1"),
    ],
)
def test_a_log_that_cannot_be_used_is_one_line_with_its_name(read, change, mapping, says) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*part0\.csv: [^\n]*$") as caught:
        read(change(frame()), mapping=mapping)
    assert says in str(caught.value)


@pytest.mark.parametrize("factor", ["9.80665", "1"])
def test_a_factor_in_the_map_states_the_unit(read, factor: str) -> None:
    table = frame()
    table[["fx", "fy", "fz"]] /= STANDARD_GRAVITY
    recording = read(table, mapping=",".join(f"{axis}={axis}*{factor}" for axis in ("fx", "fy", "fz")))
    assert recording.readings[:, 1:] == pytest.approx(table.to_numpy()[:, 1:] * float(factor))


@pytest.mark.parametrize(
    ("tables", "says"),
    [
        ((frame(), frame()), "part1.csv begins at 0 s, before"),
        ((frame(), frame()[["t", "fx"]]), "fx is found twice"),
        ((frame()[["t", "fx"]], frame(start=10.0, end=20.0)[["t", "fy", "fz"]]), "share no time: map t=…"),
        (
            (frame(), frame(start=10.0, end=20.0) / [1.0, 9.8, 9.8, 9.8]),
            "part1.csv: the median of |f| is 1, which looks like g",
        ),
        ((frame()[["t", "fx"]], frame()[["fy", "fz"]]), "part1.csv: lacks t; it has fy, fz"),
    ],
)
def test_files_that_do_not_fit_together(read, tables, says) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*$") as caught:
        read(*tables)
    assert says in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"PAR1", b"PAR1" + bytes(90), b"\x00\xff\xfe", b"ULog", b"\xa3\x95", b"FMT,"])
def test_a_file_that_is_nothing_is_one_line_with_its_name(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "odd.bin"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"odd\.bin: "):
        read_log([path])
    with pytest.raises(ValueError, match=r"nothing\.csv: there is no such file"):
        read_log([tmp_path / "nothing.csv"])


# -- maps ------------------------------------------------------------------------------------------------------------

NAMES = st.text(st.characters(codec="ascii", categories=("L", "N", "P", "S")), min_size=1, max_size=8).filter(
    lambda name: name.strip("-+* ") == name
)


@settings(deadline=None, derandomize=True)
@given(name=NAMES, sign=st.sampled_from(["", "+", "-"]), factor=st.floats(-1e6, 1e6).filter(lambda x: abs(x) > 1e-6))
def test_sign_and_factor_are_told_from_any_name(name: str, sign: str, factor: float) -> None:
    value = -1.0 if sign == "-" else 1.0
    assert resolved(Source(name), [name]) == Source(name)
    assert resolved(Source(sign + name), [name]) == Source(name, value)
    assert resolved(Source(f"{sign}{name} * {factor!r}"), [name]) == Source(name, value * factor)
    assert resolved(Source(f"{sign}{name}*{factor!r} - 2.5"), [name]) == Source(name, value * factor, -2.5)
    assert resolved(Source(f"{sign}{name}+0.3"), [name]) == Source(name, value, 0.3)


def test_a_log_may_hold_more_than_force(read) -> None:
    table = frame(rate=50.0).assign(degrees=15.0, hPa=1013.25)
    recording = read(table, mapping="temperature=degrees+273.15,p_static=hPa*100,fx=fx+0.3")
    assert recording.readings[:, 1] == pytest.approx(table["fx"] + 0.3)
    assert set(recording.series) == {"temperature", "p_static"}
    assert recording.series["temperature"].values == pytest.approx(288.15)  # noqa: PD011
    assert recording.series["p_static"].values == pytest.approx(101325.0)  # noqa: PD011
    assert recording.series["p_static"].t == pytest.approx(table["t"])


@settings(deadline=None, derandomize=True, max_examples=200)
@given(st.text("tfxyz=,*-+ ab0[].", max_size=30))
def test_any_map_is_read_or_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.getbasetemp() / "any.csv"
    if not path.exists():
        frame(end=0.2).rename(columns={"fx": "a[0]", "fy": "b 0"}).to_csv(path, index=False)
    try:
        recording = read_log([path], text)
    except ValueError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017 (either outcome is right)
    else:
        assert recording.readings.shape[1] == 4


# -- what the detector finds -----------------------------------------------------------------------------------------


def test_what_is_found_is_what_the_detector_says_step_by_step(read) -> None:
    recording = read(frame())
    flight = replay_log(recording)
    detector = default(rate=recording.rate)
    stepped = [row[0] for row in recording.readings.tolist() if detector.step(*row)]
    assert flight.score["recording"]["detections"] == stepped == [flight.score["launch"]["detected_time"]]
    assert [event["t"] for event in flight.events] == stepped
    table = flight.detector
    assert list(table["t"][table["recognised"]]) == stepped
    assert len(table) == len(recording.readings)


def test_later_launches_are_found_after_a_pause(read) -> None:
    table = frame(end=12.0)
    later = frame(end=12.0, onset=8.0)
    again = frame(end=12.0, onset=ONSET + 0.6)  # within the pause of the first
    table["fx"] = np.maximum(np.maximum(table["fx"], later["fx"]), again["fx"])
    found = detections(read(table), kind="multi-level-window")
    assert found == pytest.approx([ONSET + 0.018, 8.018], abs=0.006)


def test_a_force_that_lasts_is_found_again_each_pause(read) -> None:
    table = frame()
    table.loc[table["t"] >= ONSET, "fx"] = 60.0
    found = detections(read(table), kind="multi-level-window")
    assert len(found) == 3
    assert np.diff(found) == pytest.approx(PAUSE + 0.018, abs=0.006)


def test_nothing_found_is_null(read) -> None:
    flight = replay_log(read(frame(end=2.0)))
    assert flight.score["launch"]["detected_time"] is None
    assert flight.events == []
    none = next(line for line in view.lines(flight) if line.startswith(DetectorSettings().kind))
    assert none.startswith(f"{DetectorSettings().kind}: no launch detected; the greatest f_x is 0.")


def test_the_score_has_the_keys_of_a_flights(read, catapult) -> None:
    """Whatever needs the truth is null; the rest of a flight's keys is there."""

    def keys(score: dict[str, object], above: str = "") -> set[str]:
        found = set()
        for name, value in score.items():
            found |= keys(value, f"{above}{name}.") if isinstance(value, dict) else {above + name}
        return {key for key in found if not key.startswith(("recording", "versions"))}

    score = replay_log(read(frame())).score
    assert keys(score) == keys(catapult.score)
    values = {key: score[key] for key in ("outcome", "expected", "seed")}
    assert set(values.values()) == {None}
    assert score["launch"]["false_detections"] is None
    assert score["airspeed"]["cruise"]["samples"] is None


def test_the_folder_is_read_again(read, tmp_path: Path) -> None:
    flight = replay_log(read(frame()))
    folder = flight.save(tmp_path / "out", extra=lambda place: view.save_plot(flight, place / "plots") and None)
    again = load(folder)
    pd.testing.assert_frame_equal(again.accelerometer, flight.accelerometer)
    pd.testing.assert_frame_equal(again.detector, flight.detector)
    assert (again.events, again.score) == (flight.events, flight.score)
    assert (folder / "plots" / "launch.png").stat().st_size > 10_000


def test_the_figure_marks_the_detections_and_keeps_the_peaks(read) -> None:
    table = frame(4000.0)
    table.loc[20_000, "fx"] = 300.0  # one reading of 24 000
    flight = replay_log(read(table))
    figure = view.draw(flight)
    labels = [text.get_text() for axes in figure.axes for text in axes.texts]
    found = flight.score["launch"]["detected_time"]
    assert labels == [f"detected {found:.3f} s"] * 2
    whole = figure.axes[0].lines[0]
    assert np.nanmax(whole.get_ydata()) == pytest.approx(300.0 / STANDARD_GRAVITY)
    assert len(whole.get_xdata()) < 5000


@pytest.mark.parametrize(
    ("kind", "level"),
    [
        ("adaptive-cusum", "c 4.50 g"),
        ("cusum", "c 4.50 g"),
        ("glr-bank", "c 4.50 g"),
        ("single-threshold", "level 4.60 g"),
    ],
)
def test_any_kind_of_detector_runs_and_is_drawn_with_its_level(read, kind: str, level: str) -> None:
    flight = replay_log(read(frame()), DetectorSettings(kind=kind))
    assert flight.score["launch"]["detector"] == kind
    (found,) = flight.score["recording"]["detections"]
    assert ONSET < found < ONSET + 0.1
    lines = [str(line.get_label()) for line in view.draw(flight).axes[0].lines]
    assert any(line.startswith(level) for line in lines)


# -- PX4 and ArduPilot -----------------------------------------------------------------------------------------------


def ulog(rows: list[tuple[float, float, float, float]], message: str = "sensor_combined") -> bytes:
    """Make a minimal ULog: header, format, subscriptions of two instances, data."""

    def packed(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    text = f"{message}:uint64_t timestamp;float[3] accelerometer_m_s2;".encode()
    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + packed(b"F", text)
    log += b"".join(packed(b"A", struct.pack("<BH", i, i) + message.encode()) for i in (0, 1))
    for t, fx, fy, fz in rows:
        for i, factor in ((0, 1.0), (1, -1.0)):
            values = struct.pack("<HQ3f", i, round(t * 1e6), factor * fx, factor * fy, factor * fz)
            log += packed(b"D", values)
    return log


def dataflash(rows: list[tuple[float, float, float, float]], name: str = "IMU") -> bytes:
    """Make a minimal DataFlash log: formats, then two instances of the message."""

    def described(kind: int, length: int, message: str, layout: str, columns: str) -> bytes:
        texts = [text.encode().ljust(size, b"\0") for text, size in ((message, 4), (layout, 16), (columns, 64))]
        return b"\xa3\x95\x80" + struct.pack("<BB", kind, length) + b"".join(texts)

    log = described(0x80, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
    log += described(0x90, 24, name, "QBfff", "TimeUS,I,AccX,AccY,AccZ")
    for t, fx, fy, fz in rows:
        for i, factor in ((0, 1.0), (1, -1.0)):
            log += b"\xa3\x95\x90" + struct.pack("<QB3f", round(t * 1e6), i, factor * fx, factor * fy, factor * fz)
    return log


def dataflash_text(rows: list[tuple[float, float, float, float]], name: str = "IMU") -> bytes:
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"]
    lines += [f"FMT, 144, 24, {name}, QBfff, TimeUS,I,AccX,AccY,AccZ"]
    for t, *force in rows:
        lines += [
            f"{name}, {round(t * 1e6)}, {i}, " + ", ".join(str(s * f) for f in force) for i, s in ((0, 1), (1, -1))
        ]
    return ("\n".join(lines) + "\n").encode()


FORMATS = [
    pytest.param("log.ulg", ulog, "sensor_combined{}.accelerometer_m_s2[{}]", "012", id="ulog"),
    pytest.param("log.bin", dataflash, "IMU{}.Acc{}", "XYZ", id="dataflash"),
    pytest.param("log.log", dataflash_text, "IMU{}.Acc{}", "XYZ", id="dataflash-text"),
]


@pytest.mark.parametrize(("name", "write", "column", "axes"), FORMATS)
def test_an_autopilots_log_is_read_with_and_without_a_map(tmp_path: Path, name, write, column, axes) -> None:
    table = frame(end=4.0, start=1.0)
    path = tmp_path / name
    path.write_bytes(write(list(table.itertuples(index=False, name=None))))
    plain = read_log([path])
    assert plain.readings == pytest.approx(table.to_numpy(), abs=1e-5)  # single precision, and whole microseconds
    assert plain.remarks == ()
    assert len(detections(plain)) == 1
    second = read_log(
        [path], ",".join(f"f{a}=-{column.format('[1]', axis)}" for a, axis in zip("xyz", axes, strict=True))
    )
    assert np.array_equal(second.readings, plain.readings)


@pytest.mark.parametrize(("name", "write", "column", "axes"), FORMATS)
def test_an_unknown_message_is_one_line_with_those_there_are(tmp_path: Path, name, write, column, axes) -> None:
    rows = list(frame(end=1.0).itertuples(index=False, name=None))
    path = tmp_path / name
    path.write_bytes(write(rows))
    known = column.partition("{")[0]
    with pytest.raises(
        ValueError, match=rf"^[^\n]*{name}: has no message XYZ; it has [^\n]*{known}[^\n]*map fx=[^\n]*$"
    ):
        read_log([path], "fx=XYZ.a,fy=XYZ.b,fz=XYZ.c")
    with pytest.raises(ValueError, match=r"has no message \w+\[2\]; it has "):
        read_log([path], f"fx={column.format('[2]', axes[0])}")
    with pytest.raises(ValueError, match=rf"has no column '{known}\.nothing'; it has {known}"):
        read_log([path], f"fx={known}.nothing")
    path.write_bytes(write(rows, "ODD"))
    with pytest.raises(
        ValueError, match=rf"^[^\n]*{name}: has no message \w+ or [^\n]*; it has [^\n]*ODD[^\n]*; map fx="
    ):
        read_log([path])


@pytest.mark.parametrize("cut", [1, 5, 20, 4003])
def test_a_truncated_ulog_is_replayed_as_far_as_it_goes(tmp_path: Path, cut: int) -> None:
    table = frame(end=4.0)
    path = tmp_path / "cut.ulg"
    path.write_bytes(ulog(list(table.itertuples(index=False, name=None)))[:-cut])
    recording = read_log([path])
    end = recording.span[1]
    lost = -(-cut // (2 * 25))  # a reading is of two messages of 25 B
    assert len(table) - lost <= len(recording.readings) <= len(table)
    assert recording.readings == pytest.approx(table.to_numpy()[: len(recording.readings)], abs=1e-5)
    assert 3.8 < end <= table["t"].iloc[-1]
    (remark,) = recording.remarks
    assert remark.endswith(f"is truncated: what could be read is replayed; it ends at {end:.3f} s")
    assert len(detections(recording)) == 1


# -- recordings of real hardware -------------------------------------------------------------------------------------


@pytest.mark.skipif(RECORDINGS is None, reason="UAVSIM_RECORDINGS names no folder")
@pytest.mark.parametrize(
    ("name", "mapping", "threshold", "first", "last"),
    [
        ("TestLog2_imu.csv", "fx=ax,fy=ay,fz=az", 20.0, 261.8, 262.14),  # a throw of 2.9 g: onset … peak
        ("SwissLog1_imu.csv", "fx=ax,fy=ay,fz=az", 20.0, 16.49, 16.71),  # a throw of 2.7 g: onset … peak
        ("hedy_cats_tust_imu.csv", "t=ts,fx=-Ay,fy=Ax,fz=Az", None, -0.12, -0.06),  # a rocket leaves at -0.10 s
    ],
)
def test_real_launches_are_found(name: str, mapping: str, threshold: float | None, first: float, last: float) -> None:
    recording = read_log([Path(str(RECORDINGS)) / name], mapping)
    found = detections(
        recording, **({} if threshold is None else {"kind": "multi-level-window", "threshold": threshold})
    )
    assert first <= found[0] <= last
    if threshold is not None:
        assert len(found) == 1
        assert json.dumps(detections(recording)) == "[]"  # the default sees no throw by hand
