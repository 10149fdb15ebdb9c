"""Logs that are read in lots are replayed as those that are read as wholes, and cut into flights."""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from test_logs import frame

from sensors import tables
from uavsim.cli import main
from uavsim.flight import load
from uavsim.logs import Stream, chunks, is_long, read_log, replay_log, replay_long, stream
from uavsim.onboard.launch import DetectorSettings


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let lots be small, and logs long."""
    monkeypatch.setattr(tables, "BLOCK", 3000)
    monkeypatch.setattr(tables, "BATCH", 83)
    monkeypatch.setattr(stream, "MOST_AT_ONCE", 1000)


def flights(rate: float = 200.0) -> pd.DataFrame:
    """Make a log of three flights, a minute apart, the second with two launches."""
    parts = [frame(rate, 60.0 * k, 60.0 * k + 40.0, 60.0 * k + 3.0 + k, seed=k) for k in range(3)]
    again = (parts[1]["t"] >= 71.0) & (parts[1]["t"] < 71.25)
    parts[1].loc[again, "fx"] += 80.0
    return pd.concat(parts, ignore_index=True)


def odd(table: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Give a log jitter, losses, gaps, missing numbers, stamps astray."""
    noise = np.random.default_rng(seed)
    table = table.assign(t=table["t"] + noise.uniform(-0.3, 0.3, len(table)) / 200.0)
    table.loc[noise.integers(0, len(table), 30), "fy"] = np.nan
    table = table.drop(index=noise.integers(0, len(table), 200)).reset_index(drop=True)
    table.loc[3000, "t"] = 1e7
    return table.drop(index=range(900, 1000)).reset_index(drop=True)


def written(table: pd.DataFrame, path: Path) -> Path:
    if path.suffix == ".csv":
        table.to_csv(path, index=False)
    elif path.suffix == ".feather":
        table.to_feather(path)
    else:
        table.to_parquet(path, row_group_size=500)
    return path


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".feather"])
def test_chunks_are_the_readings(tmp_path: Path, suffix: str) -> None:
    path = written(odd(flights(), 1), tmp_path / f"a{suffix}")
    assert is_long([path])
    joined = np.concatenate(list(chunks([path])))
    assert np.array_equal(joined, read_log([path]).readings, equal_nan=True)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("kind", ["adaptive-cusum", "multi-level-window", "px4"])
def test_a_long_log_is_replayed_as_a_short_one(tmp_path: Path, kind: str) -> None:
    path = written(odd(flights(), 2), tmp_path / "a.csv")
    settings = DetectorSettings(kind=kind)
    short = replay_log(read_log([path]), settings)
    said: list[float] = []
    folder = tmp_path / "out"
    folder.mkdir()
    long = replay_long(Stream([path]), settings, lambda r: replay_log(r, settings), folder, said.append)
    long.write(folder)
    found = load(folder)
    assert found.score["recording"]["detections"] == short.score["recording"]["detections"]
    assert found.score["launch"]["detected_time"] == short.score["launch"]["detected_time"]
    assert found.score["recording"]["readings"] == len(short.accelerometer)
    assert found.score["recording"]["gaps"] == short.score["recording"]["gaps"]
    assert found.score["recording"]["rate"] == pytest.approx(short.score["recording"]["rate"], rel=0.02)
    pd.testing.assert_frame_equal(found.accelerometer, short.accelerometer)
    assert said == sorted(said)
    assert said[-1] == 1.0


@pytest.mark.usefixtures("small")
def test_a_long_log_in_feet_is_taken_as_such_from_its_first_reading_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Throws whose numbers are above those of a launch: none is one, and the table that is written is in m/s²."""
    table = flights()
    table["fx"] = 0.4 * (table["fx"] - 1.5) + 1.5
    feet = table.assign(**{axis: table[axis] / 0.3048 for axis in ("fx", "fy", "fz")})
    path = written(feet, tmp_path / "a.csv")
    monkeypatch.setattr(sys, "argv", ["uavsim", "replay", str(path), "--no-plots", "--out", str(tmp_path / "out")])
    with pytest.raises(SystemExit):
        main()
    flight = load(tmp_path / "out")
    assert flight.score["recording"]["detections"] == []
    assert any("ft/s²" in remark for remark in flight.score["recording"]["remarks"])
    np.testing.assert_allclose(flight.accelerometer["fx"].to_numpy(), table["fx"].to_numpy(), rtol=1e-9, atol=1e-9)


@pytest.mark.usefixtures("small")
def test_a_clock_that_begins_anew_is_cut_in_lots_too(tmp_path: Path) -> None:
    one, other = frame(200.0, 0.0, 40.0), frame(200.0, 0.0, 40.0, onset=9.0)
    path = written(pd.concat([one, other]), tmp_path / "a.parquet")
    settings = DetectorSettings()
    short = replay_log(read_log([path]), settings)
    long = replay_long(Stream([path]), settings, replay_log, tmp_path)
    assert long.flight.score["recording"]["detections"] == short.score["recording"]["detections"]
    assert len(short.score["recording"]["detections"]) == 2
    assert any("reset" in remark for remark in long.flight.score["recording"]["remarks"])


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_log_is_cut_into_its_flights(tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(flights().assign(p_static=1e5), tmp_path / f"a{suffix}")
    monkeypatch.setattr(
        sys, "argv", ["uavsim", "replay", str(path), "--all-launches", "--no-plots", "--out", str(tmp_path / "out")]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    score = json.loads((tmp_path / "out" / "score.json").read_text(encoding="utf-8"))
    assert len(score["recording"]["detections"]) == 4
    assert [one["folder"] for one in score["recording"]["flights"]] == [f"flights/000{i}" for i in range(3)]
    found = [load(tmp_path / "out" / one["folder"]) for one in score["recording"]["flights"]]
    each = [flight.score["recording"]["detections"] for flight in found]
    assert [len(one) for one in each] == [1, 2, 1]
    assert [t for one in each for t in one] == score["recording"]["detections"]


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda f: f.assign(t=f["t"] * 1e6), "map t=…*1e-6"),
        (lambda f: f.assign(fx=f["fx"] / 9.8, fy=f["fy"] / 9.8, fz=f["fz"] / 9.8), "which looks like g"),
        (lambda f: f.rename(columns={"fx": "q"}), "lacks"),
        (lambda f: f.iloc[::-1], "time runs backwards"),
    ],
)
def test_a_long_log_that_cannot_be_used_is_one_line(tmp_path: Path, change, says: str) -> None:
    path = written(change(flights()), tmp_path / "a.csv")
    with pytest.raises(ValueError, match=r"^[^\n]*a\.csv: [^\n]*$") as caught:
        replay_long(Stream([path]), DetectorSettings(), replay_log, tmp_path)
    assert says in str(caught.value)


@pytest.mark.usefixtures("small")
def test_a_launch_along_another_axis_is_told_of_a_long_log_too(tmp_path: Path) -> None:
    table = flights().rename(columns={"fx": "fy", "fy": "fx"})
    path = written(table, tmp_path / "a.parquet")
    long = replay_long(Stream([path]), DetectorSettings(), replay_log, tmp_path)
    assert long.flight.score["recording"]["detections"] == []
    assert any("along +y" in remark for remark in long.flight.score["recording"]["remarks"])
