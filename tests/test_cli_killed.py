"""Runs that are interrupted, killed, or out of room: what was finished is there and whole, and nobody is left."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uavsim import cli, cosim, files
from uavsim.cli import common
from uavsim.flight import UNITS, load
from uavsim.scenario import load_scenario
from uavsim.studies import engine
from uavsim.studies.batch import fly_seeds
from uavsim.studies.engine import InTurn, Left
from uavsim.views import batch as view

if os.name != "posix":
    pytest.skip("signals and process groups", allow_module_level=True)

CHANGES = ("duration=2.5", "launcher.wait_min=1.6", "launcher.wait_max=1.7", "requirements=[]")
SETS = tuple(part for change in CHANGES for part in ("--set", change))
SHORT = (*SETS, "--no-plots")
EXPECTED = (*SHORT, "--set", "expect=timeout")
SEEDS = "1-6"  # six flights
FILES = {"scenario.toml", "score.json", "events.json", *(f"{name}.parquet" for name in UNITS)}
GONE = 60.0  # s after which a process is one too many; it takes a tenth of one on an idle machine

TERMINAL = (  # not so in the background, nor under nohup
    "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "signal.signal(signal.SIGHUP, signal.SIG_DFL)\n"
)
TWO = "import os\nos.cpu_count = lambda: 2\n"  # workers, whatever the machine
MAIN = "from uavsim import cli\ncli.main()\n"
FLYING = """
from uavsim import cosim
advance = cosim.Cosimulation.advance
def tell(*arguments):
    print("flying", flush=True)
    advance(*arguments)
cosim.Cosimulation.advance = tell
"""
COUNTING = """
from uavsim.cli import common
common.Bar.show = lambda self, share: print(share, flush=True)
"""

Started = "subprocess.Popen[str]"
Start = Callable[..., Started]


@contextmanager
def starting() -> Iterator[Start]:
    """Give what starts the command line as from a terminal: in a group of its own, where Ctrl-C is not ignored."""
    begun: list[Started] = []

    def start(cwd: Path, *arguments: str, code: str = "") -> Started:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "80"}
        command = [sys.executable, "-c", TERMINAL + TWO + code + MAIN, *arguments]
        pipe = subprocess.PIPE
        process = subprocess.Popen(
            command, cwd=cwd, env=environment, text=True, start_new_session=True, stdout=pipe, stderr=pipe
        )
        begun.append(process)
        return process

    try:
        yield start
    finally:
        for process in begun:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


@pytest.fixture
def start() -> Iterator[Start]:
    with starting() as begin:
        yield begin


def lines(process: "subprocess.Popen[str]", number: int) -> list[str]:
    assert process.stdout is not None
    return [process.stdout.readline() for _ in range(number)]


def processes() -> list[list[str]]:
    """Number, parent, group, state and command of all processes."""
    columns = "pid=,ppid=,pgid=,stat=,args="
    listed = subprocess.run(["ps", "-A", "-ww", "-o", columns], capture_output=True, text=True, check=True)
    return [line.split(maxsplit=4) for line in listed.stdout.splitlines()]


def alive(group: int) -> list[str]:
    """Processes of a group that run; one that has ended and that nobody has asked about does not."""
    return [row[0] for row in processes() if int(row[2]) == group and not row[3].startswith("Z")]


def workers_of(parent: int) -> list[int]:
    return [int(row[0]) for row in processes() if int(row[1]) == parent and "spawn_main" in row[-1]]


def wait_until(condition: Callable[[], object]) -> None:
    """Wait for what must come; how long it takes is not looked at."""
    end = time.monotonic() + GONE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def kept(folder: Path) -> pd.DataFrame:
    """Rows of a folder of flights in which nothing is half-written: every file and every kept flight is read."""
    halves = {".lock", ".keeping", ".runs.parquet.part", ".campaign.json.part"}  # what a killed process may leave
    assert {p.name for p in folder.iterdir()} - halves <= {
        "campaign.json",
        "runs.parquet",
        "flights",
        "plots",
        "traces",
        ".scratch",
    }
    assert described(folder)["complete"] in (True, False)
    rows = pd.read_parquet(folder / "runs.parquet") if (folder / "runs.parquet").exists() else pd.DataFrame()
    flights = {p.name for p in (folder / "flights").iterdir()} if (folder / "flights").exists() else set()
    for name in flights:
        flight = load(folder / "flights" / name)
        assert flight.score["seed"] == int(name)
        assert list(flight.tables) == list(UNITS)
        assert {p.name for p in (folder / "flights" / name).iterdir()} == FILES
    if len(rows):
        unexpected = rows[rows["outcome"] != rows["expected"]]
        assert {str(seed) for seed in unexpected["seed"]} <= flights  # a row is only there when its flight is
    return rows


def described(folder: Path) -> dict[str, object]:
    told: dict[str, object] = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))
    return told


@pytest.fixture(scope="module")
def whole() -> pd.DataFrame:
    """Rows of flights that nobody disturbed; none cruises within 2.5 s, so all are kept."""
    return fly_seeds(load_scenario("catapult", overrides=CHANGES), list(range(1, 15)), workers=1).runs


def same_rows(rows: pd.DataFrame, whole: pd.DataFrame) -> None:
    """What is there is what an undisturbed run has there."""
    expected = whole[whole["seed"].isin(rows["seed"])].reset_index(drop=True)
    pd.testing.assert_frame_equal(rows, expected, check_exact=True)


Run = Callable[..., object]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Return what runs the command line in this process and gives its exit status."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "cpu_count", lambda: 1)

    def call(*arguments: str) -> object:
        monkeypatch.setattr(sys, "argv", ["uavsim", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        return caught.value.code

    return call


# -- killed ----------------------------------------------------------------------------------------------------------


def test_a_killed_batch_keeps_what_was_finished_and_leaves_nobody(
    tmp_path: Path, start: Start, run: Run, whole: pd.DataFrame, capsys: pytest.CaptureFixture[str]
) -> None:
    """As many rows as were told at least, each whole, none doubled; they go only when that is asked for."""
    left = {}
    for finished, later in ((1, 0.0), (4, 0.15)):
        name = f"after-{finished}"
        flying = start(tmp_path, "fly", *SHORT, "--seeds", SEEDS, "--out", name, code=COUNTING)
        lines(flying, finished)
        time.sleep(later)
        flying.kill()
        told = finished + len(flying.communicate(timeout=60)[0].split())
        wait_until(lambda group=flying.pid: not alive(group))
        left[name] = kept(tmp_path / f"{name}.unfinished")
        assert told <= len(left[name]) <= told + 2
        same_rows(left[name], whole)
        # between its last flight and its end it may be whole, and says so
        assert described(tmp_path / f"{name}.unfinished")["complete"] == (len(left[name]) == 6)
        assert not (tmp_path / name).exists()
    folder = tmp_path / "after-4.unfinished"
    for arguments in (("--seeds", "1-2"), ("--seed", "1")):
        assert run("fly", *SHORT, "--out", "after-4", *arguments) == 2
        says = f"Error: {folder} holds finished flights of a run that was killed; move it, or give --overwrite\n"
        assert capsys.readouterr().err == says
    assert run("fly", *SHORT, "--out", "after-4", "--overwrite", "--set", "aircraft.properties.no=1") == 2
    pd.testing.assert_frame_equal(kept(folder), left["after-4"])  # nothing has come to replace them
    assert run("fly", *SHORT, "--out", "after-4", "--overwrite", "--seeds", "3") == 1
    assert kept(tmp_path / "after-4")["seed"].tolist() == [3]
    assert {p.name for p in tmp_path.iterdir()} == {"after-4", "after-1.unfinished"}


def test_a_flight_that_was_killed_is_in_nobodys_way(tmp_path: Path, start: Start, run: Run) -> None:
    flying = start(tmp_path, "fly", "--set", "duration=3600", "--out", "here", code=FLYING)
    lines(flying, 1)
    assert [p.name for p in tmp_path.iterdir()] == ["here.unfinished"]
    flying.kill()
    flying.wait()
    assert run("fly", *EXPECTED, "--out", "here") == 0
    assert [p.name for p in tmp_path.iterdir()] == ["here"]
    assert {p.name for p in (tmp_path / "here").iterdir()} == FILES


def test_a_second_run_is_refused_while_the_first_one_lives(
    tmp_path: Path, start: Start, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    """From its beginning, whatever either does; with --overwrite, too."""
    flying = start(tmp_path, "fly", "--set", "duration=3600", "--out", "here", code=FLYING)
    lines(flying, 1)
    (tmp_path / "log.csv").write_text("t,fx,fy,fz\n" + "".join(f"{i / 100},0,0,-9.8\n" for i in range(200)))
    for command in ("fly", "fly --seeds 1-2", "replay log.csv", "sensors bmp390", "roc", "tune", "paper", "survey fw8"):
        for more in ((), ("--overwrite",)):
            assert run(*command.split(), "--out", "here", *more) == 2
            out, err = capsys.readouterr()
            assert (out, err) == (
                "",
                f"Error: here is being written by another process, in {tmp_path}/here.unfinished\n",
            )
    assert {p.name for p in tmp_path.iterdir()} == {"here.unfinished", "log.csv"}
    os.killpg(flying.pid, signal.SIGINT)
    assert flying.wait(timeout=60) == 130
    assert run("fly", *EXPECTED, "--out", "here") == 0


def test_flights_of_a_worker_that_is_killed_are_flown_again(tmp_path: Path, start: Start, whole: pd.DataFrame) -> None:
    flying = start(tmp_path, "fly", *SHORT, "--seeds", SEEDS, "--out", "here", code=COUNTING)
    for _ in range(2):
        lines(flying, 1)
        os.kill(workers_of(flying.pid)[0], signal.SIGKILL)
    assert (flying.communicate(timeout=120)[1], flying.returncode) == ("", 1)
    assert [p.name for p in tmp_path.iterdir()] == ["here"]
    pd.testing.assert_frame_equal(kept(tmp_path / "here"), whole.iloc[:6], check_exact=True)
    assert described(tmp_path / "here")["complete"] is True


def test_a_flight_that_kills_its_process_is_reported_with_the_command_that_flies_it(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Here of four seeds the second and third; `test_engine` tells how they are lost."""

    class Losing(InTurn):
        def each(self, work: Any, given: Any, *, done: Any, limit: float | None = None) -> list[Left]:
            done([(position, work(given[position])) for position in (3, 0)])
            return [Left(position, "its worker died, 3 times") for position in (1, 2)]

    monkeypatch.setattr(engine, "engine", lambda **_: nullcontext(Losing()))
    assert run("fly", "catapult", *EXPECTED, "--seeds", "1-3,9", "--out", "here") == 1
    changes = " ".join(f"--set '{c}'" if "[" in c else f"--set {c}" for c in (*CHANGES, "expect=timeout"))
    assert capsys.readouterr().err == (
        "unfinished: seed 2-3: its worker died, 3 times; what is left is flown by: "
        f"uavsim fly catapult {changes} --seeds 2-3\n"
    )
    assert kept(tmp_path / "here")["seed"].tolist() == [1, 9]
    told = described(tmp_path / "here")
    assert (told["complete"], told["asked"], told["seeds"]) == (False, "1-3,9", [1, 9])


# -- interrupted -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_one_flight_that_is_interrupted_is_130_with_a_line_and_leaves_nothing(
    tmp_path: Path, start: Start, number: int
) -> None:
    flying = start(tmp_path, "fly", "--set", "duration=3600", "--out", "a/here", code=FLYING)
    lines(flying, 2)
    os.killpg(flying.pid, number)
    err = flying.communicate(timeout=60)[1]
    assert flying.returncode == 130
    assert err.startswith("interrupted: ")
    assert err.endswith(" of 3600 s were flown; nothing is written\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("number", "send"), [(signal.SIGINT, os.killpg), (signal.SIGTERM, os.kill)])
def test_several_that_are_interrupted_keep_what_was_finished(
    tmp_path: Path, start: Start, whole: pd.DataFrame, number: int, send: Callable[[int, int], None]
) -> None:
    """Ctrl-C as a terminal sends it to all processes of the group, SIGTERM as `timeout` does it to the first one."""
    flying = start(tmp_path, "fly", *SHORT, "--seeds", "1-500", "--out", "here", code=COUNTING)
    one, more = (round(float(line) * 500) for line in lines(flying, 2))
    assert (one, more > 1) == (1, True)
    send(flying.pid, number)
    out, err = flying.communicate(timeout=60)
    rows = kept(tmp_path / "here")
    assert more <= len(rows) <= 14  # and what both workers had under way, some flights each on a quick machine
    assert (flying.returncode, err) == (130, f"interrupted: {len(rows)} of 500 flights are kept\n")
    assert f"catapult, {len(rows)} flights: {len(rows)} timeout" in out
    same_rows(rows, whole)
    told = described(tmp_path / "here")
    assert (told["complete"], told["seeds"]) == (False, rows["seed"].tolist())
    assert [p.name for p in tmp_path.iterdir()] == ["here"]
    assert alive(flying.pid) == []


@pytest.mark.parametrize("slow", ["bound_of", "save_many_plots"])
def test_an_interrupt_of_what_follows_keeps_all_flights(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], slow: str
) -> None:
    """While the bound is computed, or plots are drawn; one that is a second one, too."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(view, slow, interrupt)
    assert run("fly", *SETS, "--seeds", "2", "--out", "here") == 130
    assert capsys.readouterr().err == "interrupted: 1 of 1 flights are kept; not all plots are drawn\n"
    assert described(tmp_path / "here")["seeds"] == [2]
    assert pd.read_parquet(tmp_path / "here" / "runs.parquet")["seed"].tolist() == [2]
    assert load(tmp_path / "here" / "flights" / "2").score["seed"] == 2
    assert [p.name for p in tmp_path.iterdir()] == ["here"]


@pytest.mark.parametrize(
    "arguments",
    [
        *(("fly",), ("fly", "--seeds", "1"), ("sensors", "bmp390", "--hours", "0.1")),
        *(("roc",), ("tune",), ("tune", "--out", "new/one.toml"), ("paper",), ("survey", "fw8")),
    ],
)
def test_an_interrupt_before_anything_is_finished_leaves_nothing(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: tuple[str]
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(common.Bar, "show", interrupt)
    if arguments[0] == "fly":
        monkeypatch.setattr(cosim.Cosimulation, "advance", interrupt)
    if arguments[0] in ("roc", "tune"):
        monkeypatch.setattr(common.Bar, "__enter__", interrupt)
    assert run(*arguments) == 130
    err = capsys.readouterr().err
    assert err.startswith("interrupted: ")
    assert err.endswith("nothing is written\n")
    assert list(tmp_path.iterdir()) == []


# -- no room ---------------------------------------------------------------------------------------------------------


@contextmanager
def small_disk(folder: Path, size: str) -> Iterator[Path]:
    """Mount a small file system; skip where that is not allowed."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("a small disk cannot be mounted: there is no mount")
    if mounted.returncode:
        pytest.skip(f"a small disk cannot be mounted: {mounted.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_names_the_file_and_leaves_nothing_of_one_flight(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    with small_disk(tmp_path / "disk", "100k") as disk:
        assert run("fly", *SHORT, "--out", "disk/a/here") == 2
        err = capsys.readouterr().err
        assert err.startswith(f"Error: {disk}/a/here.unfinished/")
        assert err.endswith(".parquet cannot be written: No space left on device\n")
        assert list(disk.iterdir()) == []


def test_a_full_disk_keeps_what_was_finished_of_several(
    tmp_path: Path, run: Run, whole: pd.DataFrame, capsys: pytest.CaptureFixture[str]
) -> None:
    with small_disk(tmp_path / "disk", "2m") as disk:
        assert run("fly", *SHORT, "--seeds", SEEDS, "--out", "disk/here") == 2
        err, left = capsys.readouterr().err, disk / "here.unfinished"
        assert err.startswith(f"Error: {left}/")
        assert err.endswith(f" cannot be written: No space left on device; finished flights are in {left}\n")
        assert len(err.splitlines()) == 1
        rows = kept(left)
        assert 0 < len(rows) < len(whole)
        same_rows(rows, whole)
        assert not (left / ".keeping").exists()
        assert [p.name for p in disk.iterdir()] == ["here.unfinished"]


@pytest.mark.parametrize(
    ("number", "file", "seeds"),
    [
        (errno.ENOSPC, "runs.parquet", [1]),
        (errno.EROFS, "truth.parquet", [1]),
        (errno.EDQUOT, "campaign.json", [1, 2]),
    ],
)
def test_an_error_of_the_system_names_the_file_and_keeps_what_was_finished(
    tmp_path: Path,
    run: Run,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    number: int,
    file: str,
    seeds: list[int],
) -> None:
    """The second time that a file is written: a full disk, a folder that has become read-only, a quota."""
    seen: list[Path] = []

    def fail(path: Path, fsync: Callable[[Path], None] = files.force) -> None:
        seen.append(path)
        if [p.name for p in seen].count(f".{file}.part") == 2:
            raise OSError(number, os.strerror(number))
        fsync(path)

    monkeypatch.setattr(files, "force", fail)
    assert run("fly", *SHORT, "--seeds", "1-2", "--out", "here") == 2
    err, left = capsys.readouterr().err, tmp_path / "here.unfinished"
    assert err.startswith(f"Error: {left}/")
    assert err.endswith(f"{file} cannot be written: {os.strerror(number)}; finished flights are in {left}\n")
    assert len(err.splitlines()) == 1
    assert kept(left)["seed"].tolist() == seeds


# -- elsewhere -------------------------------------------------------------------------------------------------------


def test_a_home_that_cannot_be_written_is_no_reason_to_fail(tmp_path: Path, start: Start) -> None:
    """Nor to say anything: what libraries keep for the next run goes into the unfinished folder, and with it."""
    (tmp_path / "file").touch()
    (tmp_path / "empty").mkdir()
    nowhere = str(tmp_path / "file" / "home")
    names = ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR")
    code = "import os, tempfile\n" + "".join(f"os.environ[{name!r}] = {nowhere!r}\n" for name in names)
    code += f"os.environ.pop('MPLCONFIGDIR', None)\ntempfile.tempdir = {nowhere!r}\n"
    flown = start(tmp_path / "empty", "sensors", "bmp390", "--hours", "0.01", "--out", "here", code=code)
    assert flown.communicate(timeout=120)[1] == ""
    assert flown.returncode == 0
    assert [p.name for p in (tmp_path / "empty").iterdir()] == ["here"]
    pictures = {"allan.png", "psd.png", "histogram.png"}
    assert {p.name for p in (tmp_path / "empty" / "here").iterdir()} == {"bench.json", *pictures}


READ_ONLY = """
mount --bind "$1/out" "$1/out" && mount -o remount,bind,ro / && cd "$1" && ! touch x 2>/dev/null || exit 99
shift
exec "$@"
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        *(("fly", *SETS), ("fly", *SETS, "--seeds", "1-2"), ("sensors", "bmp390", "--hours", "0.01")),
        *(("roc", "--detectors", "cusum", "--hours", "0.05", "--trials", "10", "--cells", "0"), ("survey", "fw8")),
        ("tune", "catapult", "--detector", "double-threshold", "--false-alarms", "8", "--trials", "10"),
    ],
)
def test_nothing_is_written_elsewhere(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    """Where nothing but the folder around `--out` can be written, home and working folder included."""
    (tmp_path / "out").mkdir()
    there = ["unshare", "-m", "--propagation", "private", "sh", "-c", READ_ONLY, "sh", str(tmp_path)]
    command = [*there, sys.executable, "-c", MAIN, *arguments, "--out", "out/here"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "HOME": str(tmp_path)}
    try:
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("nothing can be made read-only: there is no unshare")
    if run.returncode == 99 or run.stderr.startswith("unshare"):
        pytest.skip(f"nothing can be made read-only: {run.stderr.strip()}")
    assert run.stderr == ""
    assert run.returncode in (0, 1)
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["here"]


# -- at any time -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[float, pd.DataFrame]:
    """How long `fly --seeds 1-20` takes here, s, and its rows."""
    folder = tmp_path_factory.mktemp("undisturbed")
    began = time.monotonic()
    with starting() as start:
        flown = start(folder, "fly", "--seeds", "1-20", "--no-plots", "--out", "here")
        assert flown.communicate()[1] == ""
    return time.monotonic() - began, kept(folder / "here")


@pytest.mark.slow
@pytest.mark.parametrize(("number", "times"), [(signal.SIGKILL, 20), (signal.SIGTERM, 4), (signal.SIGINT, 4)])
def test_a_batch_may_be_ended_at_any_time(
    tmp_path: Path,
    start: Start,
    undisturbed: tuple[float, pd.DataFrame],
    capsys: pytest.CaptureFixture[str],
    number: int,
    times: int,
) -> None:
    """`fly --seeds 1-20`, at times drawn over its whole course: what was told as finished can be read, nobody stays."""
    took, whole = undisturbed
    last, rows = 0.0, []
    for i, share in enumerate(np.sort(np.random.default_rng(20).uniform(0.0, 1.0, times))):
        flying = start(tmp_path, "fly", "--seeds", "1-20", "--no-plots", "--out", f"{i}", code=COUNTING)
        if number != signal.SIGKILL:
            wait_until((tmp_path / f"{i}.unfinished").exists)  # before, it is no run yet
        time.sleep(share * took)
        ended = time.monotonic()
        os.kill(flying.pid, number)
        out, err = flying.communicate()
        told = sum(line.startswith(("0.", "1.0")) for line in out.splitlines())
        wait_until(lambda group=flying.pid: not alive(group))
        last = max(last, time.monotonic() - ended)
        folders = [p for p in tmp_path.iterdir() if p.name in (f"{i}", f"{i}.unfinished")]
        assert len(folders) <= 1
        found = kept(folders[0]) if folders and (folders[0] / "campaign.json").exists() else pd.DataFrame()
        assert told <= len(found) <= 20
        if len(found):
            same_rows(found, whole)
        if number != signal.SIGKILL and flying.returncode:
            kept_words = f"{len(found)} of 20 flights are kept" if len(found) else "nothing is written"
            assert (flying.returncode, err) == (130, f"interrupted: {kept_words}\n")
            assert [p.name for p in folders] == ([f"{i}"] if len(found) else [])
        rows.append(len(found))
    with capsys.disabled():
        sys.stdout.write(f"\nrows kept: {rows}; the last process was gone after at most {last:.2f} s\n")
    assert len(set(rows)) > 2  # the times were spread over the run
