"""The command line as a new user and as a hostile one meets it: exit status, one line of error, what is written."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest
import typer
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors import presets, record_at_rest
from sensors.catalogue import FOLDER
from uavsim import __version__, cli, cosim
from uavsim.cli import common
from uavsim.cli.fly import MOST_FLIGHTS, named, seeds_of
from uavsim.flight import UNITS, load
from uavsim.scenario import packaged

FILES = {"scenario.toml", "score.json", "events.json", *(f"{name}.parquet" for name in UNITS)}
SHORT = ("--set", "duration=6", "--set", "requirements=[]", "--set", "expect=timeout", "--no-plots")
PLOTS = {"plots/launch.png", "plots/pressure.png", "plots/airspeed.png", "plots/trajectory.png", "plots/track.png"}
COMMANDS = [command.callback.__name__ for command in cli.app.registered_commands if command.callback]


@dataclass(frozen=True)
class Result:
    status: int
    out: str
    err: str


Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("FORCE_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)

    def call(*arguments: str) -> Result:
        monkeypatch.setattr(sys, "argv", ["uavsim", *arguments])
        capsys.readouterr()
        with pytest.raises(SystemExit) as caught:
            cli.main()
        status = caught.value.code
        assert isinstance(status, int)
        return Result(status, *capsys.readouterr())

    return call


def written(folder: Path) -> set[str]:
    return {str(entry.relative_to(folder)) for entry in folder.rglob("*") if entry.is_file()}


def process(code: str, cwd: Path, *arguments: str, **more: object) -> "subprocess.Popen[str]":
    """Start a Python of its own, in a group of its own as a terminal has it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
    return subprocess.Popen(  # type: ignore[call-overload,no-any-return]
        [sys.executable, "-c", code, *arguments], cwd=cwd, env=environment, text=True, start_new_session=True, **pipes
    )


# -- as a new user ---------------------------------------------------------------------------------------------------


def test_without_a_command_there_is_help(run: Run) -> None:
    alone, asked = run(), run("--help")
    assert (alone.status, alone.err) == (0, "")
    assert alone.out == asked.out
    for command in COMMANDS:
        assert f"\n    uavsim {command}" in alone.out  # an example of each, on a line of its own
        assert f"\n  {command}" in alone.out
    assert "…" not in alone.out
    assert "..." not in alone.out.split("Commands:")[1]
    assert max(map(len, alone.out.splitlines())) <= 80


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_each_has_an_example(run: Run, command: str) -> None:
    result = run(command, "--help")
    assert (result.status, result.err) == (0, "")
    assert f"Example: uavsim {command}" in result.out
    assert not set("╭│╰┃") & set(result.out)


def test_version(run: Run) -> None:
    assert run("--version") == Result(0, f"uavsim {__version__}\n", "")


def test_scenarios_are_a_line_each(run: Run) -> None:
    result = run("scenarios")
    assert (result.status, result.err) == (0, "")
    assert [line.split()[0] for line in result.out.splitlines()] == sorted(packaged())


def test_sensors_are_a_line_each(run: Run) -> None:
    result = run("sensors")
    assert (result.status, result.err) == (0, "")
    assert [line.split()[0] for line in result.out.splitlines()] == presets()


BENCH = {"allan.png", "psd.png", "histogram.png", "bench.json"}


def test_a_part_on_the_bench(run: Run, tmp_path: Path) -> None:
    """Preset, figures and table; a second one goes beside it; the numbers are those of the record at rest."""
    first = run("sensors", "bmp390", "--hours", "0.05")
    assert (first.status, first.err) == (0, "")
    assert first.out.startswith("bmp390: ")
    assert "bmp390 on the bench: mode x1/x1, 200 Hz, filter off" in first.out
    assert first.out.endswith("written to output/sensors-bmp390\n")
    assert written(tmp_path / "output" / "sensors-bmp390") == BENCH
    assert max(map(len, first.out.split("\n\n", 1)[1].splitlines())) <= 80
    second = run("sensors", "bmp390", "--hours", "0.01", "--no-plots", "--seed", "2")
    assert second.out.endswith("written to output/sensors-bmp390-2\n")
    assert written(tmp_path / "output" / "sensors-bmp390-2") == {"bench.json"}
    numbers = json.loads((tmp_path / "output" / "sensors-bmp390" / "bench.json").read_text(encoding="utf-8"))
    record = record_at_rest("bmp390", duration=180.0, seed=1)
    assert numbers["simulated"]["pressure"]["count"] == len(record)
    assert numbers["simulated"]["pressure"]["mean"] == pytest.approx(record["pressure"].mean(), rel=1e-12)


def test_the_error_budget_of_a_part(run: Run, tmp_path: Path) -> None:
    """A table in 80 columns, the same numbers as JSON, a folder where one is asked for and only there."""
    result = run("sensors", "bmp280", "--budget", "--iir", "2", "--set", "air_data.tare=open")
    assert (result.status, result.err) == (0, "")
    assert "Error budget: bmp280 " in result.out
    assert max(map(len, result.out.splitlines())) <= 80
    assert not (tmp_path / "output").exists()
    row = next(line for line in result.out.splitlines() if line.startswith("30 "))
    told = json.loads(run("sensors", "bmp280", "--budget", "--iir", "2", "--set", "air_data.tare=open", "--json").out)
    at = told["speed"].index(30.0)
    assert row.split()[-1] == f"{told['airspeed_sd']['total'][at]:.3f}"
    assert row.split()[2] == f"{told['airspeed_sd']['tare'][at]:.3f}"
    saved = run("sensors", "--budget", "--out", "here")
    assert saved.out.endswith("written to here\n")
    assert written(tmp_path / "here") == {"budget.json", "budget.png"}
    assert run("sensors", "--budget", "--out", "here", "--no-plots", "--overwrite").status == 0
    assert written(tmp_path / "here") == {"budget.json"}


def test_a_log_is_laid_over_a_part(run: Run, tmp_path: Path) -> None:
    log = record_at_rest("adxl345", duration=30.0, seed=5, rate=100.0)
    log[["fx", "fy", "fz"]] /= 9.80665
    log.columns = ["time s", "ax[0]", "ax[1]", "ax[2]"]
    log.to_csv(tmp_path / "mine.csv", index=False)
    names = "t=time s, fx=ax[0]*9.80665, fy=ax[1]*9.80665, fz=ax[2]*9.80665"
    bench = ("sensors", "adxl345", "--hours", "0.01", "--compare", "mine.csv", "--out", "here")
    result = run(*bench, "--map", names)
    assert (result.status, result.err) == (0, "")
    assert "mine.csv: 0.00833 h at 100 Hz" in result.out
    assert written(tmp_path / "here") == BENCH
    numbers = json.loads((tmp_path / "here" / "bench.json").read_text(encoding="utf-8"))
    assert numbers["compared"]["channels"]["fz"]["mean"] == pytest.approx(-9.8, abs=1.0)
    assert numbers["compared"]["remarks"] == []


def test_a_bench_takes_the_settings_of_its_part(run: Run, tmp_path: Path) -> None:
    run("sensors", "lsm6dso32", "--hours", "0.01", "--range-g", "4", "--rate", "104", "--unit", "ideal", "--out", "a")
    run("sensors", "bmp581", "--hours", "0.01", "--mode", "x1/x1", "--iir", "3", "--noise-scale", "3", "--out", "b")
    a, b = (json.loads((tmp_path / name / "bench.json").read_text(encoding="utf-8")) for name in "ab")
    assert (a["setting"], a["unit"]) == ("±4 g, 104 Hz, filter rate/2", "ideal")
    assert abs(a["simulated"]["fx"]["mean"]) < 0.01
    assert b["setting"] == "mode x1/x1, 498 Hz, filter coefficient 3"
    assert b["promised"]["pressure"]["N"] == pytest.approx(3.0 * 0.78 / 498**0.5, rel=1e-3)


def test_a_bench_may_be_written_over_only_if_that_is_asked_for(run: Run, tmp_path: Path) -> None:
    arguments = ("sensors", "bmp390", "--hours", "0.01", "--no-plots", "--out", "here")
    (tmp_path / "here").mkdir()
    assert run(*arguments).status == 0
    before = (tmp_path / "here" / "bench.json").read_bytes()
    refused = run(*arguments, "--seed", "2")
    assert (refused.status, refused.out) == (2, "")
    assert "here is not empty" in refused.err
    (tmp_path / "here" / "mine.txt").touch()
    assert run(*arguments, "--seed", "2", "--overwrite").status == 0
    assert (tmp_path / "here" / "bench.json").read_bytes() != before
    assert written(tmp_path / "here") == {"bench.json", "mine.txt"}


def test_a_part_of_ones_own(run: Run, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_bytes((FOLDER / "bmp390.toml").read_bytes())
    result = run("sensors", "mine.toml", "--hours", "0.01", "--no-plots")
    assert (result.status, result.err) == (0, "")
    assert result.out.endswith("written to output/sensors-mine\n")


def test_a_first_flight(run: Run, tmp_path: Path) -> None:
    """All defaults but the length: score, folder, plots; a second one goes beside it."""
    first = run("fly", *SHORT[:-1])
    assert (first.status, first.err) == (0, "")
    assert "catapult, seed 1: timeout (as expected)" in first.out
    assert first.out.endswith("written to output/catapult-1\n")
    assert written(tmp_path / "output" / "catapult-1") == FILES | PLOTS
    assert run("fly", *SHORT).out.endswith("written to output/catapult-1-2\n")
    assert run("fly", *SHORT, "--seed", "12").out.endswith("written to output/catapult-12\n")
    replayed = run("replay", "output/catapult-1")
    assert (replayed.status, replayed.err) == (0, "")
    again = tmp_path / "output" / "catapult-1-replay"
    for name in ("events.json", "estimate.parquet"):
        assert (again / name).read_bytes() == (tmp_path / "output" / "catapult-1" / name).read_bytes()
    assert written(again) == FILES | PLOTS


def imu() -> pd.DataFrame:
    """Make somebody's log: 3 s at 100 Hz from -1 s on, in g, with a push of 6 g along -y at 0.5 s."""
    t = pd.Series(range(300)) / 100.0 - 1.0
    return pd.DataFrame({"time": t, "a x": 0.0, "a[1]": -6.0 * t.between(0.495, 0.8), "z": 1.0})


def test_a_log_is_replayed(run: Run, tmp_path: Path) -> None:
    imu().to_csv(tmp_path / "imu.csv", index=False)
    names = "t=time,fx=-a[1]*9.80665,fy=a x*9.80665,fz=-z*9.80665"
    result = run("replay", "imu.csv", "--map", names)
    assert (result.status, result.err) == (0, "")
    assert "imu.csv: 300 readings from -1.000 to 1.990 s, median rate 100 Hz" in result.out
    assert "launch detected at 0.5" in result.out
    assert result.out.endswith("written to output/imu-replay\n")
    folder = tmp_path / "output" / "imu-replay"
    assert written(folder) == {
        *("scenario.toml", "score.json", "events.json", "accelerometer.parquet", "detector.parquet"),
        "plots/launch.png",
    }
    score = json.loads((folder / "score.json").read_text(encoding="utf-8"))
    assert 0.5 <= score["launch"]["detected_time"] <= 0.55
    unseen = run("replay", "imu.csv", "--map", names, "--set", "detector.threshold=70", "--out", "b", "--no-plots")
    assert (unseen.status, unseen.err) == (0, "")
    assert "no launch detected; the greatest f_x is 6.00 g at 0.500 s" in unseen.out
    assert load(tmp_path / "b").score["launch"]["detected_time"] is None


def test_a_flights_folder_flies_again(run: Run, tmp_path: Path) -> None:
    run("fly", *SHORT, "--out", "one", "--set", "name=mine", "--seed", "5")
    assert run("fly", "one", "--no-plots", "--out", "two").status == 0
    for name in FILES:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    assert run("fly", "one/scenario.toml", "--no-plots").out.endswith("written to output/mine-5\n")


def test_several_flights(run: Run, tmp_path: Path) -> None:
    result = run("fly", *SHORT, "--seeds", "2-3")
    assert (result.status, result.err) == (0, "")
    assert "catapult, 2 flights: 2 timeout" in result.out
    assert result.out.endswith("written to output/catapult-2-3\n")
    folder = tmp_path / "output" / "catapult-2-3"
    runs = pd.read_parquet(folder / "runs.parquet")
    assert list(runs["seed"]) == [2, 3]
    assert load(folder / "flights" / "2").score["seed"] == 2
    whole = run("replay", str(folder))
    assert whole.status == 2
    assert whole.err == f"Error: {folder} holds several flights: give one of the folders in {folder / 'flights'}\n"


# -- what comes out --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scenario", "sets", "outcome"),
    [
        ("weak-launch", ["expect=cruise"], "missed_launch"),
        ("catapult", ["duration=6", "requirements=[]"], "timeout"),
        ("catapult", ["duration=5", "expect=timeout", 'requirements=[{key="airspeed.rmse", maximum=1e-6}]'], "timeout"),
        ("catapult", ["duration=5", "aircraft.properties.metrics/Sw-sqft=1e9"], "diverged"),
    ],
)
def test_another_outcome_or_an_unmet_requirement_is_1_with_everything_written(
    run: Run, tmp_path: Path, scenario: str, sets: list[str], outcome: str
) -> None:
    changes = [part for change in sets for part in ("--set", change)]
    result = run("fly", scenario, *changes, "--no-plots", "--out", "here")
    assert (result.status, result.err) == (1, "")
    assert outcome in result.out
    assert written(tmp_path / "here") == FILES
    assert load(tmp_path / "here").score["outcome"] == outcome


def test_an_unmet_requirement_of_one_of_several_is_1(run: Run, tmp_path: Path) -> None:
    wanted = 'requirements=[{key="launch.release_time", maximum=3.0}]'
    result = run("fly", *SHORT, "--set", wanted, "--seeds", "1,2", "--out", "here")
    times = pd.read_parquet(tmp_path / "here" / "runs.parquet")["launch.release_time"]
    assert sorted(times > 3.0) == [False, True]
    assert (result.status, result.err) == (1, "")


def test_a_bug_of_ours_does_not_pass_for_wrong_input(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ValueError("operands could not be broadcast together")

    monkeypatch.setattr(cosim.Cosimulation, "advance", broken)
    with pytest.raises(ValueError, match="operands"):
        run("fly")
    assert written(tmp_path) == set()


# -- as a hostile one ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("fly catapalt", "unknown scenario 'catapalt'; did you mean 'catapult'?"),
        ("fly nothing.toml", "nothing.toml: there is no such file"),
        ("fly binary", "binary: is not text in UTF-8"),
        ("fly .", "this folder holds no scenario.toml"),
        ("fly one two", "unexpected extra argument"),
        ("fly --sets x=1", "No such option: --sets"),
        ("fly --set", "'--set' requires an argument"),
        ("fly --set x", "--set 'x': give it as KEY=VALUE"),
        ("fly --set =1", "give it as KEY=VALUE"),
        ("fly --set launcher.storke=1", "did you mean 'launcher.stroke'?"),
        ("fly --set launcher.stroke=nan", "must be a number from 0.6 to 50"),
        ("fly --set accelerometer.preset=adxl34", "nearest: adxl345"),
        ("fly --set air_data.total.mode=x9/x9", "allowed: x1/x1"),
        ("fly --set aircraft.model=fw9", "did you mean 'fw8'?"),
        ("fly --set aircraft.model=broken", "broken.xml: line 1: not well-formed XML"),
        ("fly --set aircraft.properties.NAME=1", "--set: aircraft.properties: 'NAME' is no property of 'fw8'"),
        ("fly --set aircraft.properties.=1", "'' is no property"),
        ("fly --set aircraft.properties.ap/gain/picth=1", "did you mean 'ap/gain/pitch'?"),
        ("fly --set aircraft.properties.inertia/cg-x-in=1", "'inertia/cg-x-in' is read-only in JSBSim"),
        ("fly --set aircraft.properties.inertia/pointmass-weight-lbs[1]=-1", "= -1: is a mass and must be at least 0"),
        ("fly --set environment.temperature_offset=288", "temperature_offset = 288: must be a number from -60 to 40"),
        ("fly --set air_data.calibration=units", "calibration 'units' is unknown; nearest: unit"),
        ("fly properties.toml", "properties: aircraft.properties: 'NAME' is no property"),
        ("fly --set vibration.band_hz=[5,2000]", "vibration.band_hz = [5, 2000]: must be a list of 2, each"),
        ("fly --set detector.threshold=400", "can never be sure to show it"),
        ("fly --set accelerometer.rate=1001", "allowed: 12.5, 26"),
        ("fly --set air_data.tare_duration=3", "must fit into the shortest wait"),
        ("fly --seed x", "--seed"),
        ("fly --seed 1.5", "--seed"),
        ("fly --seed -1", "--seed: seed = -1: must be a whole number from 0 to 9223372036854775807"),
        ("fly --seed 99999999999999999999", "--seed: seed = 99999999999999999999: must be a whole number"),
        ("fly --seed 1 --seeds 1-2", "give --seed or --seeds, not both"),
        ("fly --seeds x", "--seeds: 'x': give seeds as 1-50 or 1,5,9"),
        ("fly --seeds 2-1", "give seeds as"),
        ("fly --seeds 1,1", "names a seed twice"),
        ("fly --seeds 0-99999999999", "more than 100000 flights"),
        ("fly --seeds 1-2 --set expect=cruse", "did you mean 'cruise'?"),
        ("fly --seeds 1-2 --set aircraft.properties.NAME=1", "'NAME' is no property"),
        ("fly --out file", "file is a file, not a folder"),
        ("fly --out file/below/it", "file/below/it cannot be written: Not a directory"),
        ("fly --out full", "full is not empty; choose another folder or give --overwrite"),
        ("fly --seeds 1-2 --out full", "full is not empty"),
        ("replay nothing", "nothing is not a flight's folder: there is no such folder"),
        ("replay full", "full is not a flight's folder: scenario.toml is missing"),
        ("replay", "Missing argument"),
        ("replay full --map t=time", "--map: is for logs, and full is a flight's folder"),
        ("replay full --set detector.threshold=20", "--set: is for logs, and full is a flight's folder"),
        ("replay nothing.csv", "nothing.csv: there is no such file"),
        ("replay full full", "full: there is no such file"),
        ("replay file", "file: not a table of comma-separated values"),
        ("replay log.csv", "log.csv: 2 rows with a time are too few; at least 10 are needed"),
        ("replay log.csv --map t=time,fx=ay", "log.csv: has no column 'ay'; it has time, ax, p"),
        ("replay log.csv --map t=time,fx=ax,fy=ax,fz=p", "log.csv: 2 rows with a time are too few"),
        ("replay log.csv --map time", "'time': give it as ours=theirs"),
        ("replay log.csv --set seed=1", "--set 'seed': of a log only air_data.…, accelerometer.…, estimator.…"),
        ("replay log.csv --set detector.treshold=1", "did you mean 'detector.threshold'?"),
        ("replay imu.csv --map t=time,fx=a[1],fy=z,fz=z --out full", "full is not empty"),
        ("sensors bmp39", "nearest: bmp390"),
        ("sensors adxl345 --budget", "preset 'adxl345' is an accelerometer"),
        ("sensors bmp390 --budget --rate 100", "is for the bench"),
        ("sensors bmp390 --budget --iir 5", "iir 5 is unknown"),
        ("sensors bmp390 --budget --set air_data.tare=never", "air_data.tare = 'never'"),
        ("sensors bmp390 --set air_data.tare=open", "give --budget, too"),
        ("sensors ../sensors", "preset '../sensors' is unknown"),
        ("sensors properties.toml", "properties.toml: "),
        ("sensors bmp390 --hours -1", "--hours: -1.0: give a number of hours above 0, at most 1000"),
        ("sensors bmp390 --hours nan", "'--hours': nan is not a finite number"),
        ("sensors bmp390 --hours inf", "'--hours': inf is not a finite number"),
        ("sensors bmp390 --hours 1e-5", "--hours: 1e-05 h are too short: give at least 0.00018 at 200 Hz"),
        ("sensors bmp390 --hours x", "--hours"),
        ("sensors bmp390 --seed -1", "--seed"),
        ("sensors bmp390 --unit best", "--unit 'best' is unknown"),
        ("sensors bmp390 --rate 100", "bmp390 is a pressure sensor and has no rate"),
        ("sensors bmp390 --iir 5", "bmp390: iir 5 is unknown; nearest: "),
        ("sensors adxl345 --mode x1/x1", "adxl345 is an accelerometer and has no mode"),
        ("sensors adxl345 --range-g 3", "range_g 3.0 is unknown; nearest: "),
        ("sensors adxl345 --rate 801", "rate 801.0 is unknown; nearest: 800"),
        ("sensors adxl345 --filter none", "filter 'none' is unknown; nearest: rate/2"),
        ("sensors adxl345 --noise-scale -1", "noise_scale must be a number from 0 to 1000, not -1.0"),
        ("sensors adxl345 --noise-scale nan", "'--noise-scale': nan is not a finite number"),
        ("sensors adxl345 --map t=time", "--map: names columns of a log: give --compare, too"),
        ("sensors --compare log.csv", "--compare: name the part to compare with"),
        ("sensors adxl345 --compare nothing.csv", "--compare: nothing.csv: there is no such file"),
        ("sensors adxl345 --compare full", "--compare: full: there is no such file"),
        ("sensors adxl345 --compare log.csv", "log.csv: lacks t, fx, fy, fz; it has time, ax, p; say which"),
        (
            "sensors bmp390 --compare log.csv --map t=time",
            "lacks pressure; it has time, ax, p; say which is which with",
        ),
        ("sensors bmp390 --compare log.csv --map t=time,pressure=q", "has no column 'q'; it has time, ax, p"),
        ("sensors bmp390 --compare log.csv --map t=time,pressure=p", "2 rows of numbers are too few; at least 1000"),
        ("sensors bmp390 --compare log.csv --map t=time,fx=p", "'fx' is no column of ours; they are t, pressure"),
        ("sensors bmp390 --compare log.csv --map time", "'time': give it as ours=theirs"),
        ("sensors bmp390 --compare binary", "binary: "),
        ("sensors bmp390 --compare file", "file: not a table of comma-separated values"),
        ("sensors bmp390 --out full", "full is not empty"),
        ("sensors bmp390 --out file", "file is a file, not a folder"),
        ("bench nothing", "unknown scenario 'nothing'"),
        ("bench weak-launch", "nothing to compare"),
        ("flie", "No such command 'flie'"),
        ("--bogus", "No such option: --bogus"),
    ],
)
def test_wrong_input_is_2_with_one_line_and_nothing_written(
    run: Run, tmp_path: Path, arguments: str, says: str
) -> None:
    (tmp_path / "binary").write_bytes(b"\x00\xff")
    (tmp_path / "file").touch()
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").touch()
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "broken.xml").write_text("<fdm_config")
    (tmp_path / "properties.toml").write_text("[aircraft.properties]\nNAME = 1\n")
    (tmp_path / "log.csv").write_text("time, ax, p\n0, 1, 2\n1, 1, 2\n")
    imu().to_csv(tmp_path / "imu.csv", index=False)
    before = set(tmp_path.rglob("*"))
    result = run(*arguments.split(" "))
    assert (result.status, result.out) == (2, "")
    assert result.err.startswith("Error: ")
    assert result.err.endswith("\n")
    assert len(result.err.splitlines()) == 1
    assert says in result.err
    assert "Usage" not in result.err
    assert set(tmp_path.rglob("*")) == before


def test_nothing_is_flown_in_vain(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A place that cannot be written is told before the flight."""
    monkeypatch.setattr(cosim.Cosimulation, "__init__", lambda *_: pytest.fail("set up a flight"))
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").touch()
    assert run("fly", "--out", "full").status == 2
    assert run("fly", "--out", "full", "--seeds", "1-2").status == 2


def test_a_flight_may_be_written_over_only_if_that_is_asked_for(run: Run, tmp_path: Path) -> None:
    arguments = ("fly", *SHORT, "--out", "here")
    assert run(*arguments, "--seed", "1").status == 0
    assert run(*arguments, "--seed", "2").status == 2
    assert load(tmp_path / "here").score["seed"] == 1
    assert run(*arguments, "--seed", "2", "--overwrite").status == 0
    assert load(tmp_path / "here").score["seed"] == 2
    (tmp_path / "empty").mkdir()
    assert run(*arguments[:-1], "empty").status == 0
    assert run("replay", "here", "--out", "empty", "--no-plots").status == 2
    assert run("replay", "here", "--out", "empty", "--no-plots", "--overwrite").status == 0
    assert load(tmp_path / "empty").score["seed"] == 2


def test_what_cannot_be_replayed_is_told(run: Run, tmp_path: Path) -> None:
    run("fly", *SHORT, "--out", "here")
    (tmp_path / "here" / "air_data.parquet").rename(tmp_path / "air_data.parquet")
    assert run("replay", "here").err == "Error: here cannot be replayed: air_data.parquet is missing\n"
    (tmp_path / "air_data.parquet").rename(tmp_path / "here" / "air_data.parquet")
    (tmp_path / "here" / "scenario.toml").write_text("duration = -1")
    assert run("replay", "here").err.startswith("Error: here/scenario.toml: duration = -1: must be")
    assert not (tmp_path / "output").exists()


# -- seeds -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "seeds", "name"),
    [
        ("7", [7], "7"),
        ("1-3", [1, 2, 3], "1-3"),
        ("0,5,3", [0, 5, 3], "0,5,3"),
        ("1, 3-4 ,9", [1, 3, 4, 9], "1,3,4,9"),
        (str(2**63 - 1), [2**63 - 1], str(2**63 - 1)),
        (",".join(map(str, range(0, 60, 2))), list(range(0, 60, 2)), "30-seeds"),
    ],
)
def test_seeds(text: str, seeds: list[int], name: str) -> None:
    assert seeds_of(text) == seeds
    assert named(seeds) == name


@settings(deadline=None, derandomize=True)
@given(st.text("0123456789-, ²x", max_size=12) | st.text(max_size=8))
def test_any_text_is_seeds_or_refused(text: str) -> None:
    try:
        seeds = seeds_of(text)
    except typer.BadParameter:
        return
    assert 0 < len(seeds) == len(set(seeds)) <= MOST_FLIGHTS
    assert all(0 <= seed < 2**63 for seed in seeds)


# -- other people's ends of the pipe ---------------------------------------------------------------------------------

MAIN = "from uavsim.cli import main\nmain()"


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (("scenarios",), 0),
        (("--help",), 0),
        (("sensors", "bmp390", "--hours", "0.01", "--no-plots"), 0),
        (("fly", *SHORT, "--out", "here"), 0),
        (("fly", *SHORT, "--set", "expect=cruise", "--out", "here"), 1),
    ],
)
def test_a_reader_that_leaves_costs_nothing(tmp_path: Path, arguments: tuple[str, ...], status: int) -> None:
    read, write = os.pipe()
    os.close(read)
    gone = process(MAIN, tmp_path, *arguments, stdout=write)
    os.close(write)
    _, err = gone.communicate(timeout=60)
    assert (gone.returncode, err) == (status, "")
    if "here" in arguments:
        assert written(tmp_path / "here") == FILES


def test_a_terminal_without_greek_is_no_reason_to_fail(tmp_path: Path) -> None:
    code = "import os, sys\nsys.stdout.reconfigure(encoding='ascii')\n" + MAIN
    plain = process(code, tmp_path, "sensors", "bmp390", "--hours", "0.01", "--no-plots")
    out, err = plain.communicate(timeout=60)
    assert (plain.returncode, err) == (0, "")
    assert out.isascii()
    assert "rate limit" in out


def test_a_closed_output_is_no_reason_to_fail(tmp_path: Path) -> None:
    closed = process("import os\nos.close(1)\nimport sys\nsys.stdout = None\n" + MAIN, tmp_path, "scenarios")
    _, err = closed.communicate(timeout=60)
    assert (closed.returncode, err) == (0, "")


# -- progress --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("terminal", "patience", "shown"), [(True, -1.0, True), (True, 60.0, False), (False, -1.0, False)]
)
def test_progress_is_shown_on_a_terminal_to_those_who_wait(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], terminal: bool, patience: float, shown: bool
) -> None:
    monkeypatch.setattr(common, "PATIENCE", patience)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    with common.Bar("flying") as bar:
        bar.show(0.5)
        bar.show(0.9)
    out, err = capsys.readouterr()
    assert out == ""
    assert ("flying" in err) is shown


@pytest.mark.skipif(os.name != "posix", reason="a shell that closes standard error")
def test_a_flight_needs_no_standard_error(tmp_path: Path) -> None:
    command = (
        f"exec {sys.executable} -m uavsim.cli fly catapult --no-plots --set duration=12 --out {tmp_path}/here 2>&-"
    )
    done = subprocess.run(["sh", "-c", command], stdout=subprocess.PIPE, text=True, check=False)
    assert done.returncode in {0, 1}  # as it went
    assert f"written to {tmp_path}/here" in done.stdout
    assert (tmp_path / "here" / "score.json").is_file()
