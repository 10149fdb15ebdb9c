"""Parts that are done by several processes, some of which die, in this machine and elsewhere."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from uavsim.studies import cluster
from uavsim.studies.cluster import ClusterError
from uavsim.studies.engine import Engine, InTurn, Left, TimeUp, engine, processes


def double(number: int) -> int:
    return 2 * number


def die_of_odd_ones(folder: Path, number: int) -> int:
    if number % 2:
        (folder / str(os.getpid())).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_once(folder: Path, number: int) -> int:
    """Of every number, but only the first time."""
    mark = folder / str(number)
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_once_or_take_long(folder: Path, number: int) -> int:
    if number:
        time.sleep(2.0)
        return number
    return die_once(folder, number)


def refuse(number: int) -> int:
    raise ValueError(f"no {number}")


def sleep_for(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


def look_at_the_clock(number: int) -> int:
    if number == 3:
        raise TimeUp("it took longer than 0 s")
    return number


@pytest.fixture(scope="module")
def crew() -> Iterator[Engine]:
    with engine(workers=2) as found:
        assert isinstance(found, Engine)
        yield found


def test_all_are_done_and_told_with_their_positions(crew: Engine) -> None:
    done: dict[int, int] = {}
    assert crew.each(double, [5, 6, 7, 8, 9], done=done.update) == []
    assert done == {0: 10, 1: 12, 2: 14, 3: 16, 4: 18}
    assert crew.each(double, [], done=done.update) == []


def test_work_of_little_cost_goes_in_bundles_and_comes_in_whole(crew: Engine) -> None:
    """A task lasts seconds, so thousands of parts are few tasks."""
    done: dict[int, int] = {}
    calls: list[int] = []

    def finished(found: list[tuple[int, int]]) -> None:
        done.update(found)
        calls.append(len(found))

    assert crew.each(double, range(5000), done=finished) == []
    assert done == {i: 2 * i for i in range(5000)}
    assert max(calls) > 100


def test_one_that_looks_at_a_clock_is_left_and_the_others_are_done(crew: Engine) -> None:
    for someone in (crew, InTurn()):
        done: dict[int, int] = {}
        assert someone.each(look_at_the_clock, [2, 3, 4], done=done.update) == [Left(1, "it took longer than 0 s")]
        assert done == {0: 2, 2: 4}


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_one_that_hangs_is_ended_with_its_worker_and_left(crew: Engine) -> None:
    done: dict[int, float] = {}
    assert crew.each(sleep_for, [0.0, 600.0, 0.01], done=done.update, limit=0.2) == [
        Left(1, "it took longer than 0.3 s, 3 times")
    ]
    assert done == {0: 0.0, 2: 0.01}


def test_no_more_processes_than_parts_and_none_for_one() -> None:
    assert [processes(4, 9), processes(4, 3), processes(4, 1), processes(1, 9), processes(None, 0)] == [4, 3, 0, 0, 0]


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_part_that_its_process_died_of_is_done_again(tmp_path: Path, crew: Engine) -> None:
    done: dict[int, int] = {}
    assert crew.each(partial(die_once, tmp_path), [1, 2, 3], done=done.update) == []
    assert done == {0: 1, 1: 2, 2: 3}


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_part_that_its_process_dies_of_three_times_is_left_and_the_others_are_done(
    tmp_path: Path, crew: Engine
) -> None:
    """The others of its bundle, too, one by one: 40 parts of little cost are one bundle or two."""
    done: dict[int, int] = {}
    crew.each(double, range(500), done=lambda _: None)  # so that it knows that the next ones are cheap
    left = crew.each(partial(die_of_odd_ones, tmp_path), [2, 3, *range(4, 84, 2)], done=done.update)
    assert left == [Left(1, "its worker died, 3 times")]
    assert done == {0: 2, **{i: 2 * i for i in range(2, 42)}}
    assert 3 <= len(list(tmp_path.iterdir())) <= 4  # once in a bundle, three times by itself


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_who_looks_after_a_worker_is_replaced_when_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine a new process may not come in time, and its nanny ends: here both are ended at once."""
    monkeypatch.setattr(cluster, "REPLACING", 0.3)
    with engine(workers=2) as own:
        assert isinstance(own, Engine)
        staff: Any = own.site.workers
        for nanny in list(staff._cluster.workers.values()):
            staff._cluster.sync(nanny.close)
        done: dict[int, int] = {}
        assert own.each(double, range(20), done=done.update) == []
        assert done == {i: 2 * i for i in range(20)}


def test_without_any_worker_it_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "GIVEN_UP", 0.3)
    with engine(workers=1) as own:
        assert isinstance(own, Engine)
        staff: Any = own.site.workers
        for nanny in list(staff._cluster.workers.values()):
            staff._cluster.sync(nanny.close)
        with pytest.raises(ClusterError, match=r"no process to fly in could be started for 0.3 s"):
            own.each(double, range(20), done=lambda _: None)


def test_an_error_of_a_part_is_the_callers_and_tells_where_it_was() -> None:
    with engine(workers=1) as own:
        with pytest.raises(ValueError, match=r"no [12]") as caught:
            own.each(refuse, [1, 2], done=lambda _: None)
        assert "in refuse" in caught.value.__notes__[0]


def test_an_error_of_the_caller_ends_it() -> None:
    def full(_: object) -> None:
        raise OSError("full")

    with pytest.raises(OSError, match="full"), engine(workers=2) as own:
        own.each(double, [1, 2, 3], done=full)


UNGUARDED = """
    from uavsim.studies.engine import engine
    with engine(workers=1) as crew:
        crew.each(print, [1, 2], done=print)
"""


def test_a_script_that_cannot_be_run_again_is_told_so(tmp_path: Path) -> None:
    """A process to work in runs the main module anew; without its guard that would begin processes without end."""
    (tmp_path / "script.py").write_text(textwrap.dedent(UNGUARDED))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "script.py"]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert "ClusterError: no process could be started to fly in" in run.stderr
    assert run.stderr.endswith("is below `if __name__ == '__main__':`\n")


LONG = """
    import os, signal, time
    from uavsim.studies.engine import engine

    def sleep(seconds):
        os.write(1, b"working\\n")  # one write: print sends the end of the line apart, and another's may come between
        time.sleep(seconds)

    if __name__ == "__main__":
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with engine(workers=2) as crew:
                crew.each(sleep, [600.0] * 4, done=print)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="process groups")
@pytest.mark.parametrize("how", ["killed", "interrupted twice"])
def test_nobody_works_on_for_one_who_has_gone(tmp_path: Path, how: str) -> None:
    """Killed, or interrupted a second time as from a terminal: its processes end in the midst of what they do."""
    (tmp_path / "script.py").write_text(textwrap.dedent(LONG))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=tmp_path, env=environment, stdout=pipe, stderr=pipe, text=True, start_new_session=True,
    ) as parent:  # fmt: skip
        assert parent.stdout is not None
        assert [parent.stdout.readline() for _ in range(2)] == ["working\n"] * 2
        if how == "killed":
            parent.kill()
        else:
            for _ in range(2):
                os.killpg(parent.pid, signal.SIGINT)
                time.sleep(0.5)  # two at once count as one
        out, err = parent.communicate(timeout=60)  # its output is closed when the last process has gone
    if how == "killed":  # Python's own watcher of semaphores says that it removed them
        err = "".join(
            line for line in err.splitlines(keepends=True) if "resource_tracker" not in line and "warn" not in line
        )
    assert err == ""
    assert (out, parent.returncode) == (("", -9) if how == "killed" else ("interrupted\n", 0))
