"""`uavsim sweep` and `uavsim sensitivity`: what is wrong is one line, before anything flies."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from uavsim.cli import app
from uavsim.cli.common import WrongInputError


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--runs", "2"], "nothing is varied"),
        (["--runs", "2", "--vary", "launcher.strok=5,6"], "did you mean 'launcher.stroke'?"),
        (["--runs", "2", "--vary", "launcher.stroke=5,600"], "cell 2 of 2 (launcher.stroke=600)"),
        (["--runs", "2", "--vary", "launcher.stroke=6:5:2"], "reversed"),
        (["--runs", "2", "--vary", "launcher.stroke=5,6", "--vary", "launcher.stroke=7"], "varied twice"),
        (["--runs", "2", "--vary", "aircraft.properties.no/such=1,2"], "no/such"),
    ],
)
def test_a_sweep_that_cannot_be(arguments: list[str], words: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["sweep", "catapult", *arguments, "--out", str(tmp_path / "out")])
    assert isinstance(result.exception, WrongInputError)
    assert words in str(result.exception)
    assert "\n" not in str(result.exception)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["sweep", "sensitivity"])
def test_no_flights_are_none(command: str) -> None:
    vary = ["--vary", "launcher.stroke=5,6"] if command == "sweep" else []
    result = CliRunner().invoke(app, [command, "catapult", *vary, "--runs", "0"])
    assert result.exit_code == 2


def test_a_scenario_of_which_nothing_is_dispersed_says_what_to_add(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["sensitivity", "catapult", "--runs", "50", "--out", str(tmp_path / "out")])
    assert isinstance(result.exception, WrongInputError)
    assert 'add [[dispersions]] with key = "launcher.friction"' in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_an_output_that_no_score_has() -> None:
    result = CliRunner().invoke(app, ["sensitivity", "catapult", "--runs", "50", "--output", "launch.latenzy"])
    assert "did you mean 'launch.latency'?" in result.output
