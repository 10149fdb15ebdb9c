"""Places that one process holds: refused to others, whole at the end, and nothing left of what failed."""

import errno
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from uavsim import folders
from uavsim.cli.common import folder
from uavsim.flight import UNITS
from uavsim.folders import OURS, FilePlace, Place, TakenError

HOLDING = """
import os, sys
from uavsim.folders import Place
with Place(sys.argv[1], overwrite="overwrite" in sys.argv) as place:
    (place.folder / "score.json" if "flown" in sys.argv else place.folder / "x").write_text("theirs")
    print("held", flush=True)
    sys.stdin.readline()
print("done", flush=True)
"""

Hold = Callable[..., "subprocess.Popen[str]"]


def everything(folder: Path) -> set[str]:
    return {str(entry.relative_to(folder)) for entry in folder.rglob("*")}


@pytest.fixture
def hold() -> Iterator[Hold]:
    """Return what starts a process that holds a place until it is told to end, or is killed."""
    begun = []

    def start(target: Path, *words: str) -> "subprocess.Popen[str]":
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", HOLDING, str(target), *words]
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, env=environment, text=True, stdin=pipe, stdout=pipe)
        begun.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        return process

    yield start
    for process in begun:
        process.kill()
        process.communicate()


def put(place: Place, **contents: str) -> None:
    for name, text in contents.items():
        (place.folder / name.replace("_", ".")).write_text(text)


def fail(place: Place, **contents: str) -> None:
    with place:
        put(place, **contents)
        raise RuntimeError


# -- whole or not there ----------------------------------------------------------------------------------------------


def test_it_is_written_beside_and_takes_its_place_at_the_end(tmp_path: Path) -> None:
    with Place(tmp_path / "a" / "new") as place:
        assert everything(tmp_path) == {"a", "a/new.unfinished", "a/new.unfinished/.lock"}
        put(place, x_txt="mine")
    assert everything(tmp_path) == {"a", "a/new", "a/new/x.txt"}


def test_where_a_folder_is_there_it_is_written_inside(tmp_path: Path) -> None:
    """It may be mounted: nobody can rename it, nor write beside it."""
    (tmp_path / "there").mkdir()
    number = (tmp_path / "there").stat().st_ino
    with Place(tmp_path / "there") as place:
        assert place.folder.parent == tmp_path / "there"
        put(place, x_txt="mine")
    assert everything(tmp_path) == {"there", "there/x.txt"}
    assert (tmp_path / "there").stat().st_ino == number


@pytest.mark.parametrize("inside", ["file", "file/x", "file/x/y", "loop/x", "n" * 300, "/proc/nowhere/x"])
def test_a_place_that_cannot_be_written_is_told_before_and_left_as_it_was(tmp_path: Path, inside: str) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    before = everything(tmp_path)
    with pytest.raises(OSError, match=r"is a file, not a folder|cannot be written: "):
        Place(tmp_path / inside, overwrite=True).claim()
    assert everything(tmp_path) == before


FULL = ("full", "missing/../full", "full/sub/../../full", "link", "link/../full", "a/b/../../full")


@pytest.mark.parametrize("inside", FULL)
def test_what_is_not_empty_is_refused_by_whichever_path_and_nothing_is_made(tmp_path: Path, inside: str) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").touch()
    (tmp_path / "link").symlink_to("full")
    before = everything(tmp_path)
    times = {p: p.stat().st_mtime_ns for p in (tmp_path, tmp_path / "full")}
    with pytest.raises(TakenError, match="is not empty; choose another folder or give --overwrite"):
        Place(tmp_path / inside).claim()
    assert everything(tmp_path) == before
    assert {p: p.stat().st_mtime_ns for p in times} == times  # not even for a moment


def test_parents_that_are_links_lead_to_where_it_is_written(tmp_path: Path) -> None:
    (tmp_path / "real" / "deep").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "link").symlink_to(tmp_path / "real" / "deep")
    with Place(tmp_path / "elsewhere" / "link" / ".." / "here") as place:
        assert place.folder.parent == tmp_path / "real"  # as the system reads such a path
        put(place, x="mine")
    assert everything(tmp_path / "real") == {"deep", "here", "here/x"}
    assert everything(tmp_path / "elsewhere") == {"link"}


def test_claiming_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for inside in ("a/b/c", "empty", "empty/d"):
        with pytest.raises(RuntimeError):
            fail(Place(tmp_path / inside))
    assert everything(tmp_path) == {"empty"}


def test_parents_that_another_uses_by_then_stay(tmp_path: Path) -> None:
    place = Place(tmp_path / "a" / "b").claim()
    (tmp_path / "a" / "other").touch()
    with pytest.raises(RuntimeError):
        fail(place)
    assert everything(tmp_path) == {"a", "a/other"}


def test_what_is_replaced_is_what_is_written() -> None:
    assert {"scenario.toml", "score.json", "events.json", *(f"{name}.parquet" for name in UNITS)} < OURS


def test_what_was_there_comes_back_when_it_cannot_be_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever of the renames fails."""
    old = {"score.json": "old", "events.json": "old", "notes.txt": "mine"}
    for name, text in old.items():
        (tmp_path / name).write_text(text)
    rename = Path.rename
    for fails in range(4):
        done = 0

        def sometimes(source: Path, to: Path, fails: int = fails) -> Path:
            nonlocal done
            done += 1
            if done == fails + 1:
                raise OSError(errno.ENOSPC, "no space")
            return rename(source, to)

        place = Place(tmp_path, overwrite=True).claim()
        put(place, scenario_toml="new", score_json="new")
        with monkeypatch.context() as patch:
            patch.setattr(Path, "rename", sometimes)
            with pytest.raises(OSError, match="no space"):
                place.__exit__(None, None, None)
        assert {name: (tmp_path / name).read_text() for name in old} == old
        assert everything(place.folder) == {".lock", "scenario.toml", "score.json"}  # whole, so not thrown away
        assert {p.name for p in tmp_path.iterdir()} == {*old, place.folder.name}
        with Place(tmp_path, overwrite=True) as place:
            put(place, score_json="old", events_json="old")
        assert everything(tmp_path) == set(old)


def test_what_makes_a_flight_whole_comes_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is moved in file by file, a kill in between leaves no folder that passes for a whole one."""
    rename = Path.rename

    def watch(source: Path, to: Path) -> Path:
        assert not (tmp_path / "score.json").exists()
        return rename(source, to)

    with Place(tmp_path) as place:
        put(place, score_json="{}", a_txt="", z_txt="")
        monkeypatch.setattr(Path, "rename", watch)
    assert everything(tmp_path) == {"score.json", "a.txt", "z.txt"}


def test_an_interrupt_while_it_takes_its_place_comes_too_late(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settle = Place._settle

    def interrupted(place: Place) -> None:
        signal.raise_signal(signal.SIGINT)
        settle(place)

    monkeypatch.setattr(Place, "_settle", interrupted)
    monkeypatch.setattr(signal, "getsignal", lambda number: signal.default_int_handler)
    with Place(tmp_path / "new") as place:
        put(place, x="mine")
    assert everything(tmp_path) == {"new", "new/x"}


def test_a_file_is_a_place_too(tmp_path: Path) -> None:
    target = tmp_path / "a" / "one.toml"
    with FilePlace(target) as place:
        assert not target.exists()
        put(place, one_toml="mine")
    assert everything(tmp_path) == {"a", "a/one.toml"}
    with pytest.raises(TakenError, match=r"one.toml exists; choose another file or give --overwrite"):
        FilePlace(target).claim()
    with pytest.raises(TakenError, match=r"a is a folder, not a file"):
        FilePlace(tmp_path / "a", overwrite=True).claim()
    with pytest.raises(RuntimeError):
        fail(FilePlace(target, overwrite=True), one_toml="new")
    assert target.read_text() == "mine"
    with FilePlace(target, overwrite=True) as place:
        put(place, one_toml="new")
    assert target.read_text() == "new"
    assert everything(tmp_path) == {"a", "a/one.toml"}


# -- one process at a time -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.parametrize("words", [(), ("overwrite",)])
def test_a_second_process_is_refused_until_the_first_has_ended(
    tmp_path: Path, hold: Hold, there: bool, words: tuple[str, ...]
) -> None:
    """By whichever path it comes, and whether or not it may overwrite."""
    target = tmp_path / "a" / "here"
    if there:
        target.mkdir(parents=True)
    first = hold(target, *words)
    (tmp_path / "link").symlink_to("a")
    before = everything(tmp_path)
    for path in (target, tmp_path / "link" / "here", tmp_path / "a" / "b" / ".." / "here"):
        for overwrite in (False, True):
            with pytest.raises(TakenError, match=r"here is being written by another process, in .*here.unfinished$"):
                Place(path, overwrite=overwrite).claim()
    assert everything(tmp_path) == before
    assert first.communicate("end\n", timeout=60)[0] == "done\n"
    assert (target / "x").read_text() == "theirs"
    with pytest.raises(TakenError, match="is not empty"):
        Place(target).claim()


def test_a_place_whose_folder_is_made_meanwhile_is_refused_all_the_same(tmp_path: Path, hold: Hold) -> None:
    first = hold(tmp_path / "here")
    (tmp_path / "here").mkdir()
    with pytest.raises(TakenError, match="here is being written by another process"):
        Place(tmp_path / "here").claim()
    assert everything(tmp_path / "here") == set()
    assert first.communicate("end\n", timeout=60)[0] == "done\n"
    assert (tmp_path / "here" / "x").read_text() == "theirs"


def test_a_place_that_another_process_has_filled_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    place = Place(tmp_path / "here").claim()
    put(place, score_json="mine")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "x").write_text("theirs")
    with pytest.raises(TakenError, match="is not empty"):
        place.__exit__(None, None, None)
    assert (tmp_path / "here" / "x").read_text() == "theirs"
    assert (tmp_path / "here.unfinished" / "score.json").read_text() == "mine"  # a finished flight is kept


def test_two_without_a_folder_take_two(tmp_path: Path, hold: Hold, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first = hold(tmp_path / "output" / "catapult-1")
    with folder(None, "catapult-1", overwrite=False) as second, folder(None, "catapult-1", overwrite=True) as third:
        assert [str(place.target) for place in (second, third)] == ["output/catapult-1-2", "output/catapult-1-3"]
        assert first.communicate("end\n", timeout=60)[0] == "done\n"
    assert everything(tmp_path / "output") == {"catapult-1", "catapult-1/x", "catapult-1-2", "catapult-1-3"}


def test_what_a_dead_process_left_is_cleared(tmp_path: Path, hold: Hold) -> None:
    first = hold(tmp_path / "here")
    first.kill()
    first.wait()
    assert "here.unfinished/x" in everything(tmp_path)
    with Place(tmp_path / "here") as place:
        assert everything(place.folder) == {".lock"}
        put(place, y="mine")
    assert everything(tmp_path) == {"here", "here/y"}


@pytest.mark.parametrize("there", [False, True])
def test_finished_flights_of_a_dead_process_are_replaced_only_when_asked_and_when_others_are_there(
    tmp_path: Path, hold: Hold, there: bool
) -> None:
    if there:
        (tmp_path / "here").mkdir()
    first = hold(tmp_path / "here", "flown")
    first.kill()
    first.wait()
    left = everything(tmp_path)
    with pytest.raises(
        TakenError, match=r"here.unfinished holds finished flights of a run that was killed; move it, or"
    ):
        Place(tmp_path / "here").claim()
    assert everything(tmp_path) == left
    place = Place(tmp_path / "here", overwrite=True)
    with pytest.raises(RuntimeError):
        fail(place, x="mine")
    assert everything(tmp_path) == left
    assert (place.folder / "score.json").read_text() == "theirs"
    with Place(tmp_path / "here", overwrite=True) as place:
        put(place, score_json="mine")
    assert everything(tmp_path) == {"here", "here/score.json"}
    assert (tmp_path / "here" / "score.json").read_text() == "mine"


def test_killed_while_it_replaces_a_killed_one_keeps_both(tmp_path: Path, hold: Hold) -> None:
    for words in (("flown",), ("flown", "overwrite")):
        process = hold(tmp_path / "here", *words)
        process.kill()
        process.wait()
    kept = {"score.json", ".stale", ".stale/score.json", ".lock"}
    assert everything(tmp_path / "here.unfinished") == kept
    with pytest.raises(TakenError, match="holds finished flights"):
        Place(tmp_path / "here").claim()
    assert everything(tmp_path / "here.unfinished") == kept


def test_what_is_not_of_a_run_is_left_alone(tmp_path: Path) -> None:
    """A folder of that name that somebody else has made, and a link in a place where others may write, too."""
    (tmp_path / "a.unfinished").mkdir()
    (tmp_path / "a.unfinished" / "letter").touch()
    (tmp_path / "victim").mkdir()
    (tmp_path / "victim" / ".lock").touch()
    (tmp_path / "b.unfinished").symlink_to("victim")
    (tmp_path / "c.unfinished").touch()
    before = everything(tmp_path)
    for name in "abc":
        with pytest.raises(TakenError, match=f"{name}.unfinished is in the way: no run of yours has left it"):
            Place(tmp_path / name, overwrite=True).claim()
    assert everything(tmp_path) == before


def test_what_another_user_left_is_not_taken_over(tmp_path: Path, hold: Hold, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a place where all may write they could have put links into it."""
    if not hasattr(os, "geteuid"):
        pytest.skip("no users")
    first = hold(tmp_path / "here")
    first.kill()
    first.wait()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    with pytest.raises(TakenError, match=r"here.unfinished is in the way"):
        Place(tmp_path / "here").claim()


def test_a_folder_that_its_holder_removes_meanwhile_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between the opening of its file and the locking."""
    lock, locked = folders.lock, []

    def late(file: int) -> bool:
        if not locked:
            shutil.rmtree(tmp_path / "here.unfinished")
        locked.append(file)
        return lock(file)

    monkeypatch.setattr(folders, "lock", late)
    with Place(tmp_path / "here") as place:
        put(place, x="mine")
    assert len(locked) == 2
    assert everything(tmp_path) == {"here", "here/x"}


def test_without_locks_a_folder_that_is_there_counts_as_held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some file systems that come over a network have none."""

    def none(_: int) -> bool:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(folders, "lock", none)
    with Place(tmp_path / "here") as place:
        with pytest.raises(TakenError, match=r"is being written by another process, in .*here.unfinished"):
            Place(tmp_path / "here").claim()
        put(place, x="mine")
    assert everything(tmp_path) == {"here", "here/x"}
