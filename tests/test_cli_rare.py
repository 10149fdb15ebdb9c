"""`uavsim rare`: what it writes and prints, and what it refuses."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from uavsim.cli import app

HOLD = ("--set", "detector.kind=single-threshold", "--set", "detector.window=0.003", "--set", "detector.threshold=9")


def test_a_false_launch_is_written_and_printed_in_eighty_columns(tmp_path: Path) -> None:
    asked = [
        "rare",
        "catapult",
        "--runs",
        "200",
        "--seconds",
        "1",
        "--sigma",
        "0.35",
        "--out",
        str(tmp_path / "a"),
        *HOLD,
    ]
    result = CliRunner().invoke(app, asked)
    assert result.exit_code == 0, result.output
    assert max(len(line) for line in result.output.splitlines() if not line.startswith("written to")) <= 80
    kept = json.loads((tmp_path / "a" / "rare.json").read_text())
    assert kept["event"] == "false_launch"
    assert 0.0 < kept["low"] < kept["probability"] < kept["high"]
    assert kept["work"] <= 200
    assert kept["per_hour"]["rate"] > 0.0
    assert (tmp_path / "a" / "rare.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        (("--event", "nonsense"), "must be crashed"),
        (("--event", "timeout"), "no number in a score"),
        (("--event", "crashed"), "has no [[dispersions]]"),
        (("--event", "crashed", "--sigma", "1"), "--sigma"),
        (("--runs", "0"), "--runs"),
        (("--detector", "nobody"), "nobody"),
        (("--set", "detector.axes=['+x','-x']", "--detector", "hold"), "hold"),
    ],
)
def test_what_cannot_be_is_refused(more: tuple[str, ...], problem: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["rare", "launch-curve", *more, "--out", str(tmp_path / "a")])
    assert result.exit_code != 0
    assert problem in f"{result.output}{result.exception}"
