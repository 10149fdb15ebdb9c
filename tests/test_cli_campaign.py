"""`uavsim campaign`: what it writes, what it refuses, and what is left of it when it, or any part of it, is killed."""

import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
from test_cli_killed import CHANGES, Start, alive, starting, wait_until, workers_of

from uavsim import cli
from uavsim.flight import load
from uavsim.scenario import load_scenario
from uavsim.studies.campaign.campaign import fly_plan
from uavsim.studies.campaign.keep import NOTHING
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.record import Record
from uavsim.studies.engine import InTurn

if os.name != "posix":
    pytest.skip("signals and process groups", allow_module_level=True)

SETS = tuple(part for change in (*CHANGES, "expect=timeout") for part in ("--set", change))
SHORT = (*SETS, "--no-plots")
RUNS = 12
Run = Callable[..., object]


@pytest.fixture
def start() -> "Start":  # type: ignore[misc]
    with starting() as begin:
        yield begin


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Return what runs the command line in this process and gives its exit status."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str) -> object:
        monkeypatch.setattr(sys, "argv", ["uavsim", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        return caught.value.code

    return call


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The rows of a campaign that nobody disturbed, flown one after the other in this process."""
    folder = tmp_path_factory.mktemp("whole")
    plan = Random(load_scenario("catapult", overrides=[*CHANGES, "expect=timeout"]), RUNS)
    fly_plan(Record(folder, plan), InTurn(), NOTHING)
    return (folder / "runs.parquet").read_bytes()


def test_a_campaign_is_written_and_each_flight_flies_again(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str], whole: bytes
) -> None:
    """Two workers give what one process gives, byte for byte; a flight of it flies again, byte for byte."""
    arguments = ("campaign", "catapult", *SETS, "--runs", str(RUNS), "--workers", "2", "--keep", "every:5")
    assert run(*arguments, "--out", "here") == 0
    assert f"{RUNS} flights" in capsys.readouterr().out
    here = tmp_path / "here"
    assert (here / "runs.parquet").read_bytes() == whole
    assert {p.name for p in here.iterdir()} == {"campaign.json", "runs.parquet", "traces", "flights", "plots"}
    assert {p.name for p in (here / "flights").iterdir()} == {"0", "5", "10"}
    told = json.loads((here / "campaign.json").read_text())
    assert (told["complete"], told["flights"], told["plan"]) == (True, RUNS, {"kind": "random", "runs": RUNS})
    assert run("fly", "--from", "here", "--index", "5", "--out", "again", "--no-plots") == 0
    for name in ("score.json", "events.json", "estimate.parquet", "truth.parquet", "scenario.toml"):
        assert (tmp_path / "again" / name).read_bytes() == (here / "flights" / "5" / name).read_bytes()
    assert run("fly", "again", "--out", "once-more", "--no-plots") == 0
    assert (tmp_path / "once-more" / "score.json").read_bytes() == (tmp_path / "again" / "score.json").read_bytes()
    row = pd.read_parquet(here / "runs.parquet").iloc[5]
    assert load(tmp_path / "again").score["launch"]["latency"] == row["launch.latency"]

    capsys.readouterr()
    assert run(*arguments, "--out", "here") == 2
    says = "Error: here is not empty; choose another folder, or give --resume or --overwrite\n"
    assert capsys.readouterr().err == says
    assert run(*arguments, "--out", "here", "--resume", "--no-plots") == 0  # a finished one: nothing to fly
    assert (here / "runs.parquet").read_bytes() == whole


def test_flight_0_is_what_fly_flies_of_the_seed(tmp_path: Path, run: Run, whole: bytes) -> None:
    (tmp_path / "runs.parquet").write_bytes(whole)
    assert run("fly", "catapult", *SHORT, "--seed", "1", "--out", "one") == 0
    row = pd.read_parquet(tmp_path / "runs.parquet").iloc[0]
    score = load(tmp_path / "one").score
    assert score["launch"]["latency"] == row["launch.latency"]
    assert score["airspeed"]["rmse"] == row["airspeed.rmse"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--runs", "0"), "--runs"),
        ((), "--runs"),
        (("--runs", "5", "--keep", "some"), "--keep 'some': must be none, all"),
        (("--runs", "5", "--keep", "worst:3:airspeed.rms"), "did you mean 'airspeed.rmse'"),
        (("--runs", "5", "--sampling", "halton"), "must be one of random, latin-hypercube, sobol"),
        (("--runs", "5", "--workers", "0"), "--workers"),
        (("--runs", "5", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"), "has workers of its own"),
        (("--runs", "5", "--insecure"), "say how to reach a --scheduler"),
        (("--runs", "5", "--resume"), "--resume needs --out"),
        (("--runs", "5", "--resume", "--overwrite", "--out", "x"), "not both"),
        (("--runs", "5", "--scheduler", "tcp://192.0.2.1:8786"), "neither encrypted nor on this machine"),
        (("--runs", "5", "--scheduler", "none.json"), "the scheduler file none.json"),
        (("--runs", "5", "--set", "launcher.frictoin=0.1"), "did you mean 'launcher.friction'"),
        (("--runs", "5", "--plugin", "none.py"), "there is no such file"),
        (("--runs", "5", "--set", "aircraft.properties.no/such=1"), "no/such"),
    ],
)
def test_what_cannot_be_is_one_line_and_nothing_is_written(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], says: str
) -> None:
    assert run("campaign", "catapult", *arguments) == 2
    err = capsys.readouterr().err
    assert err.startswith("Error: ")
    assert err.count("\n") == 1
    assert says in err
    assert [p.name for p in tmp_path.iterdir() if p.name != "output"] == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--from", "here"), "--from needs --index"),
        (("--index", "3"), "--index needs --from"),
        (("--from", "none", "--index", "0"), "none: there is no such folder"),
        (("--from", ".", "--index", "0"), "this folder holds no campaign.json"),
        (("--from", "here", "--index", "0", "--seed", "4"), "not with --seed"),
        (("--from", "here", "--index", "0", "--set", "duration=9"), "not with --set"),
    ],
)
def test_what_cannot_be_flown_again_is_one_line(
    run: Run, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], says: str
) -> None:
    assert run("fly", *arguments) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1


def test_a_dry_run_says_what_it_would_cost_and_writes_nothing(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("campaign", "catapult", *SHORT, "--runs", "5000", "--keep", "every:100", "--dry-run") == 0
    out = " ".join(capsys.readouterr().out.split())
    assert out.startswith("5000 flights of catapult: one took ")
    assert "50 kept flights, about " in out
    assert list(tmp_path.iterdir()) == []


# -- killed ------------------------------------------------------------------------------------------------------------

TELLING = """
from uavsim.cli.progress import FlightsBar
FlightsBar.flew = lambda self, done, total, outcomes: print(done, flush=True)
"""


def ended(folder: Path) -> int:
    """Rows that are there, in whichever parts."""
    try:
        return len(pd.read_parquet(folder / "runs.parquet"))
    except (OSError, FileNotFoundError):
        return 0


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_one_that_is_ended_is_taken_up_and_ends_in_the_same_rows(
    tmp_path: Path, start: Start, run: Run, whole: bytes, number: int
) -> None:
    arguments = ("campaign", "catapult", *SHORT, "--runs", str(RUNS), "--workers", "2", "--out", "here")
    flying = start(tmp_path, *arguments, code=TELLING)
    assert flying.stdout is not None
    flying.stdout.readline()  # the first is written
    (os.kill if number == signal.SIGKILL else os.killpg)(flying.pid, number)
    err = flying.communicate(timeout=120)[1]
    wait_until(lambda: not alive(flying.pid))
    if number != signal.SIGKILL:
        assert flying.returncode == 130
        assert err.endswith(f"of {RUNS} flights are kept; go on with the same command and --resume\n")
    assert ended(tmp_path / "here") >= 1
    assert json.loads((tmp_path / "here" / "campaign.json").read_text())["complete"] is False
    assert run(*arguments[:-1], "here", "--resume") == 0
    assert (tmp_path / "here" / "runs.parquet").read_bytes() == whole
    assert not (tmp_path / "here" / ".lock").exists()


def test_a_worker_that_is_killed_is_replaced_and_its_flights_are_flown_again(
    tmp_path: Path, start: Start, whole: bytes
) -> None:
    arguments = ("campaign", "catapult", *SHORT, "--runs", str(RUNS), "--workers", "2", "--out", "here")
    flying = start(tmp_path, *arguments, code=TELLING)
    assert flying.stdout is not None
    for _ in range(2):
        flying.stdout.readline()
        for worker in workers_of(flying.pid)[:1]:
            os.kill(worker, signal.SIGKILL)
    assert flying.communicate(timeout=120)[1] == ""
    assert flying.returncode == 0
    assert (tmp_path / "here" / "runs.parquet").read_bytes() == whole


def test_a_folder_that_another_campaign_is_writing_to_is_refused(
    tmp_path: Path, start: Start, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("campaign", "catapult", *SHORT, "--runs", "5000", "--workers", "1", "--out", "here")
    flying = start(tmp_path, *arguments, code=TELLING)
    assert flying.stdout is not None
    flying.stdout.readline()
    for more in ((), ("--resume",), ("--overwrite",)):
        assert run(*arguments, *more) == 2
        assert capsys.readouterr().err == "Error: here is being written by another process\n"
    assert run("fly", *SHORT, "--out", "here") == 2
    os.killpg(flying.pid, signal.SIGINT)
    flying.communicate(timeout=120)


def test_another_seed_scenario_or_number_is_refused_with_the_difference(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("campaign", "catapult", *SHORT, "--out", "here", "--workers", "1")
    assert run(*arguments, "--runs", "2") == 0
    before = (tmp_path / "here" / "campaign.json").read_bytes()
    capsys.readouterr()
    for more, says in (
        (("--runs", "2", "--seed", "5"), "seed was 1 and is 5"),
        (("--runs", "2", "--set", "launcher.friction=0.05"), "launcher.friction was 0.01 and is 0.05"),
        (("--runs", "1"), "runs was 2 and is 1"),
    ):
        assert run(*arguments, *more, "--resume") == 2
        err = capsys.readouterr().err
        assert says in err
        assert err.count("\n") == 1
    assert (tmp_path / "here" / "campaign.json").read_bytes() == before
    assert not (tmp_path / "here" / ".lock").exists()
