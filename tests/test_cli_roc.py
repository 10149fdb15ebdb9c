"""`uavsim roc` from outside: what it writes, what it refuses."""

import json
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest


def roc(*arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "uavsim.cli", "roc", *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def test_a_small_run_writes_its_folder(tmp_path: Path) -> None:
    out = tmp_path / "new" / "roc"
    run = roc("--detectors", "cusum,px4", "--hours", "0.2", "--trials", "20", "--cells", "2", "--out", str(out))
    assert run.returncode == 0, run.stderr
    rows, summary = pd.read_csv(out / "roc.csv"), json.loads((out / "roc.json").read_text())
    assert set(rows["detector"]) == {"cusum", "px4"}
    assert len(pd.read_parquet(out / "roc.parquet")) == len(rows)
    assert [d["detector"] for d in summary["detectors"]] == ["cusum", "px4"]
    assert sorted(p.name for p in (out / "plots").iterdir()) == ["detection.png", "latency.png", "levels.png"]
    assert len(pd.read_csv(out / "cells.csv")) == 30 * 3  # with the default to compare with
    assert "adaptive-cusum against px4" in run.stdout
    again = roc("--detectors", "cusum", "--out", str(out))
    assert again.returncode == 2
    assert "not empty" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--detectors", "adaptive-cusm"), "did you mean 'adaptive-cusum'"),
        (("--detectors", "px4,px4"), "twice"),
        (("--hours", "0"), "--hours"),
        (("--hours", "nan"), "hours"),
        (("--scenario", "catapul"), "did you mean 'catapult'"),
    ],
)
def test_wrong_input_is_one_line(tmp_path: Path, arguments: tuple[str, ...], named: str) -> None:
    run = roc(*arguments, "--out", str(tmp_path / "none"))
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("Error: ")
    assert named in run.stderr
    assert not (tmp_path / "none").exists()


def tune(*arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "uavsim.cli", "tune", *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def test_tune_writes_a_scenario_that_flies(tmp_path: Path) -> None:
    file = tmp_path / "tuned.toml"
    run = tune(
        "catapult", "--detector", "double-threshold", "--false-alarms", "8", "--trials", "10", "--out", str(file)
    )
    assert run.returncode == 0, run.stderr
    assert "[detector]" in run.stdout
    assert 'kind = "double-threshold"' in run.stdout
    assert "worst class, tuned: " in run.stdout
    fly = [sys.executable, "-m", "uavsim.cli", "fly", str(file), "--set", "duration=8", "--set", "expect=timeout"]
    flown = subprocess.run(
        [*fly, "--no-plots", "--out", str(tmp_path / "flight")], check=False, capture_output=True, text=True
    )
    assert flown.returncode in (0, 1), flown.stderr
    score = json.loads((tmp_path / "flight" / "score.json").read_text())
    assert score["launch"]["detector"] == "double-threshold"
    assert 0.0 < score["launch"]["latency"] < 0.05
    again = tune("catapult", "--out", str(file))
    assert again.returncode == 2
    assert "exists" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--detector", "cusm"), "did you mean 'cusum'"),
        (("--false-alarms", "0"), "must be above 0"),
        (("--false-alarms", "1e-6"), "an hour can be shown"),
        (("catapul",), "did you mean 'catapult'"),
        (("catapult", "--detector", "cusum", "--trials", "3"), "--trials"),
        (("weak-launch", "--detector", "cusum"), "expects 'missed_launch'"),
    ],
)
def test_what_cannot_be_tuned_is_one_line(tmp_path: Path, arguments: tuple[str, ...], named: str) -> None:
    run = tune(*arguments, "--out", str(tmp_path / "none"))
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert named in run.stderr
    assert not (tmp_path / "none").exists()
