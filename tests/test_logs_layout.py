"""Files of numbers as loggers write them: preambles, names in comments, units, no names, separators, decimal commas."""

import gzip
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from test_logs import detections, frame

from uavsim.logs import Recording, read_log

FRAME = frame(rate=100.0).round(4)
TEXT = FRAME.to_csv(index=False)
NAMES, BODY = TEXT.split("\n", 1)
ROWS = BODY.strip().split("\n")
FOUND = 3.01  # s, when the launch is found


def read(tmp_path: Path, content: str | bytes, mapping: str | None = None) -> Recording:
    path = tmp_path / "log.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_log([path], mapping)


def lines(change: Callable[[str], str], names: str = NAMES) -> str:
    return "\n".join((names, *map(change, ROWS))) + "\n"


def said(recording: Recording) -> str:
    return " | ".join(remark.split("log.csv: ")[-1] for remark in recording.remarks)


@pytest.mark.parametrize(
    ("content", "remark"),
    [
        ("Logger 1.2\nSerial,12345\nStart,2026-05-01\n\n" + TEXT, ""),
        ("# Logger\n# Serial: 1\n#" + TEXT, "the names stand in a comment"),
        ("% a remark\n% t fx fy fz\n" + BODY.replace(",", " "), "the names stand in a comment"),
        (NAMES + "\ns,m/s^2,m/s^2,m/s^2\n" + BODY, "the line below the names is one of units"),
        (NAMES + "\n[s],(m/s²),(m/s²),(m/s²)\n" + BODY, "the line below the names is one of units"),
        (BODY, "columns 1 to 4 are taken for t, fx, fy, fz"),
        (TEXT.replace(",", ";").replace(".", ","), "numbers are written with a decimal comma"),
        (TEXT.replace(",", "\t").replace(".", ","), "numbers are written with a decimal comma"),
        (TEXT.replace(",", " "), ""),
        (FRAME.to_string(index=False), ""),
        (TEXT.replace(",", " | "), ""),
        (TEXT.replace(",", " , "), ""),
        (lines(lambda row: row + ","), "every line ends in a separator"),
        (lines(lambda row: row + ",", NAMES + ","), "every line ends in a separator"),
        (lines(lambda row: row.replace(",", ";") + ";;", NAMES.replace(",", ";")), "every line ends in a separator"),
        ("\n".join(",".join(f'"{cell}"' for cell in row.split(",")) for row in (NAMES, *ROWS)), ""),
        (lines(lambda row: row + ",armed", NAMES + ",mode"), ""),
        (TEXT[:8000].rpartition("\n")[0] + "\n# armed\n" + TEXT[:8000].rpartition("\n")[2] + TEXT[8000:], ""),
        (NAMES + "\n" + "\n".join((*ROWS[:200], NAMES, *ROWS[200:])), "1 rows have no time"),
        (NAMES + "\n" + "\n".join((*ROWS[:200], "\0" * 4096, *ROWS[200:])), "4096 zero bytes are passed over"),
        (NAMES + "\n" + "\n".join((*ROWS[:200], "9,9,9,9,9,9", *ROWS[200:])), "1 lines have more values"),
        (TEXT + "6.0", "1 lines have fewer values"),
        (TEXT.encode("utf-16-le"), ""),
        (b"\xef\xbb\xbf" + TEXT.encode(), ""),
        (TEXT.replace("\n", "\r"), ""),
        (gzip.compress(TEXT.encode()), ""),
        (
            TEXT.replace(NAMES, "Time (s),Accel_X [m/s^2],Accel_Y [m/s^2],Accel_Z [m/s^2]"),
            "fx, fy, fz are taken from columns 'Accel_X [m/s^2]'",
        ),
    ],
)
def test_however_a_table_is_laid_out_the_launch_is_found(tmp_path: Path, content: str | bytes, remark: str) -> None:
    recording = read(tmp_path, content)
    assert len(recording.readings) in (600, 601)
    assert recording.readings[:600] == pytest.approx(FRAME.to_numpy())
    assert detections(recording)[0] == pytest.approx(FOUND)
    assert remark in said(recording)
    assert remark or not recording.remarks


def test_times_with_a_date_and_of_the_day(tmp_path: Path) -> None:
    stamps = pd.to_datetime(1_777_636_799.0 + FRAME["t"], unit="s")
    for format_, start in (("%Y-%m-%dT%H:%M:%S.%f", 1_777_636_799.0), ("%Y-%m-%d %H:%M:%S.%fZ", 1_777_636_799.0)):
        table = FRAME.assign(t=stamps.dt.strftime(format_)).rename(columns={"t": "time"})
        recording = read(tmp_path, table.to_csv(index=False))
        assert detections(recording)[0] - start == pytest.approx(FOUND, abs=1e-5)
        assert "t is taken from column 'time'" in said(recording)
    table = FRAME.assign(t=(stamps + pd.Timedelta(hours=11, minutes=59, seconds=59)).dt.strftime("%H:%M:%S.%f"))
    recording = read(tmp_path, table.to_csv(index=False))
    assert detections(recording)[0] - recording.readings[0, 0] == pytest.approx(FOUND, abs=1e-5)
    assert "the clock wraps at a day" in said(recording)


def test_no_names_and_a_map_of_numbers(tmp_path: Path) -> None:
    wide = "\n".join(f"{i},{row}" for i, row in enumerate(ROWS))
    recording = read(tmp_path, wide, "t=2,fx=3*1+0.5,fy=4,fz=5")
    assert recording.readings[:, 1] == pytest.approx(FRAME["fx"] + 0.5)
    with pytest.raises(ValueError, match=r"no line of names, and 5 columns: say which is which by their numbers"):
        read(tmp_path, wide)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (
            lines(lambda row: row.replace(",", ", ").replace(".", ",").replace(", ", ",")),
            "a decimal comma cannot be told",
        ),
        (lines(lambda row: f"1,{row}"), "has 4 names, and lines of 5 values"),
        (b"H Product:Blackbox flight data recorder by Nicholas Sherlock\n" + bytes(range(200)), "decode it first"),
        ("t,fx,fy,fz\n" + "1,a,b,c\n" * 30, "column 'fx' holds no numbers"),
    ],
)
def test_what_cannot_be_told_is_one_line_that_helps(tmp_path: Path, content: str | bytes, says: str) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*log\.csv: [^\n]*$") as caught:
        read(tmp_path, content)
    assert says in str(caught.value)


def test_one_axis_is_enough(tmp_path: Path) -> None:
    recording = read(tmp_path, FRAME[["t", "fx"]].to_csv(index=False))
    assert recording.axes == ("fx",)
    assert np.isnan(recording.readings[:, 2:]).all()
    assert detections(recording)[0] == pytest.approx(FOUND)
    with pytest.raises(ValueError, match=r"the detector reads fx, fy, fz, and the log holds no fy, fz"):
        detections(recording, kind="multi-level-window", axes="any")
    with pytest.raises(ValueError, match="the log holds no fy"):
        detections(recording, axes=("-y",))


def test_feather_is_read(tmp_path: Path) -> None:
    path = tmp_path / "log.feather"
    FRAME.assign(note="text").to_feather(path)
    assert np.array_equal(read_log([path]).readings, FRAME.to_numpy())
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(ValueError, match=r"not a Feather file that can be read"):
        read_log([path])


# -- formats of loggers ----------------------------------------------------------------------------------------------


def betaflight(unit: str = "", one_g: float = 2048.0) -> str:
    names = ", ".join(("loopIteration", "time (us)", *(f"accSmooth[{i}]{unit}" for i in range(3)), "GPS_numSat"))
    table = "\n".join(
        f"{i}, {1e6 * t + 5e6:.0f}, {one_g * fx / 9.80665:.2f}, {-one_g * fy / 9.80665:.2f}, {-one_g * fz / 9.80665:.2f}, 9"  # noqa: E501
        for i, (t, fx, fy, fz) in enumerate(FRAME.itertuples(index=False, name=None))
    )
    return f'"Product","Blackbox flight data recorder by Nicholas Sherlock"\n"looptime",125\n{names}\n{table}\n'


@pytest.mark.parametrize(("unit", "one_g"), [("", 2048.0), ("", 512.0), (" (g)", 1.0), (" (m/s/s)", 9.80665)])
def test_decoded_blackbox_logs(tmp_path: Path, unit: str, one_g: float) -> None:
    recording = read(tmp_path, betaflight(unit, one_g))
    assert recording.readings[:, 1:] == pytest.approx(FRAME.to_numpy()[:, 1:], abs=0.06)
    assert recording.readings[0, 0] == pytest.approx(5.0)
    assert "forward-left-up" in said(recording)
    assert ("count" in said(recording)) == (not unit)
    assert recording.series["satellites"].values[0] == 9.0  # noqa: PD011


def test_altos(tmp_path: Path) -> None:
    names = "#version,serial,flight,call,time,state,state_name,acceleration,pressure,temperature"
    rows = "\n".join(
        f"5, 1234, 2, KD7, {t:8.2f}, 3,     pad, {fx - 1.5:8.2f}, 101325.00, {21.5:5.1f}"
        for t, fx in FRAME[["t", "fx"]].itertuples(index=False, name=None)
    )
    recording = read(tmp_path, f"{names}\n{rows}\n")
    assert recording.readings[:, 1] == pytest.approx(FRAME["fx"] - 1.5 + 9.80665, abs=0.006)
    assert recording.series["p_static"].values[0] == 101325.0  # noqa: PD011
    assert recording.series["temperature"].values[0] == pytest.approx(294.65)  # noqa: PD011
    assert "gravity" in said(recording)


def test_columns_of_the_same_name_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,fx,fy,fz,fx\n" + "".join(f"{0.01 * k},1,2,-9.8,7\n" for k in range(100)))
    recording = read_log([path])
    assert recording.readings[0, 1] == 1.0
    said = " | ".join(recording.remarks)
    assert "columns have the same name: 'fx' (2 columns)" in said
    assert read_log([path], "fx=fx.1").readings[0, 1] == 7.0


@pytest.mark.parametrize(
    "text",
    [
        "t,fx,fy,fz\nfloat,double,float32,float\n" + "".join(f"{0.01 * k},1.5,2,-9.8\n" for k in range(100)),
        "t,fx,fy,fz\n" + "".join(f"{0.01 * k}\u00a0,1.5\u00a0,2,-9.8\n" for k in range(100)),
        "t,fx,fy,fz\n" + "".join(f'"0,{k:02d}","1,5","2,0","-9,8"\n' for k in range(100)),
    ],
    ids=["a row of types", "hard blanks", "decimal commas in quotes"],
)
def test_values_are_read_through_what_stands_around_them(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    assert read_log([path]).readings[-1] == pytest.approx([0.99, 1.5, 2.0, -9.8])


def test_times_in_minutes_are_doubted(tmp_path: Path) -> None:
    table = frame(rate=100.0)
    path = tmp_path / "a.csv"
    table.assign(t=table["t"] / 60.0).to_csv(path, index=False)
    assert "is t in s? Map t=…*60 if it is in minutes" in " | ".join(read_log([path]).remarks)
    assert len(detections(read_log([path], "t=t*60"))) == 1
