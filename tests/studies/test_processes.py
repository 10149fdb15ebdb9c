"""Parts that are done by several processes, some of which die."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from functools import partial
from pathlib import Path

import pytest

from uavsim.studies import processes
from uavsim.studies.processes import each


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


def give_what_cannot_be_sent(_: int) -> object:
    return lambda: None


def test_all_are_done_and_told_with_their_positions() -> None:
    done: dict[int, int] = {}
    assert each(double, [5, 6, 7, 8, 9], workers=2, done=done.update) == []
    assert done == {0: 10, 1: 12, 2: 14, 3: 16, 4: 18}
    assert each(double, [], workers=2, done=done.update) == []


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_part_that_its_process_died_of_is_done_again(tmp_path: Path) -> None:
    done: dict[int, int] = {}
    assert each(partial(die_once, tmp_path), [1, 2, 3], workers=2, done=done.update) == []
    assert done == {0: 1, 1: 2, 2: 3}


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_it_is_done_again_when_no_other_one_works(tmp_path: Path) -> None:
    """What two at once have no memory for, one may."""
    order: list[int] = []
    each(
        partial(die_once_or_take_long, tmp_path),
        [0, 1],
        workers=2,
        done=lambda found: order.extend(i for i, _ in found),
    )
    assert order == [1, 0]


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_part_that_its_process_died_of_twice_is_lost_and_the_others_are_done(tmp_path: Path) -> None:
    done: dict[int, int] = {}
    assert each(partial(die_of_odd_ones, tmp_path), [2, 3, 4, 6], workers=2, done=done.update) == [1]
    assert done == {0: 2, 2: 4, 3: 6}
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_is_not_a_workers_even_while_it_gets_ready(monkeypatch: pytest.MonkeyPatch) -> None:
    """A terminal sends it to all; before a Python has begun it would end it, and with a traceback a moment later."""
    start = processes.SPAWN.Process.start

    def disturbed(process: "processes.SPAWN.Process") -> None:
        start(process)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(process.pid, number)

    monkeypatch.setattr(processes.SPAWN.Process, "start", disturbed)
    done: dict[int, int] = {}
    assert each(double, [1, 2], workers=2, done=done.update) == []
    assert done == {0: 2, 1: 4}


def test_an_error_of_a_part_is_the_callers_and_tells_where_it_was() -> None:
    with pytest.raises(ValueError, match=r"no [12]") as caught:
        each(refuse, [1, 2], workers=2, done=lambda _: None)
    assert "in refuse" in caught.value.__notes__[0]
    with pytest.raises(RuntimeError, match="what a process gave cannot be sent"):
        each(give_what_cannot_be_sent, [1], workers=1, done=lambda _: None)


def test_an_error_of_the_caller_ends_it() -> None:
    def full(_: object) -> None:
        raise OSError("full")

    with pytest.raises(OSError, match="full"):
        each(double, [1, 2, 3], workers=2, done=full)


UNGUARDED = """
    from uavsim.studies.processes import each
    each(print, [1, 2], workers=1, done=print)
"""


def test_a_script_that_cannot_be_run_again_is_told_so(tmp_path: Path) -> None:
    """A process to work in runs the main module anew; without its guard that would begin processes without end."""
    (tmp_path / "script.py").write_text(textwrap.dedent(UNGUARDED))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "script.py"]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert "RuntimeError: a process to work in ended before it began, with status 1; it runs the main" in run.stderr
    assert run.stderr.endswith("is below `if __name__ == '__main__':`\n")


LONG = """
    import os, signal, time
    from uavsim.studies.processes import each

    def sleep(seconds):
        os.write(1, b"working\\n")  # one write: print sends the end of the line apart, and another's may come between
        time.sleep(seconds)

    if __name__ == "__main__":
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            each(sleep, [600.0] * 4, workers=2, done=print)
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
    assert err == ""
    assert (out, parent.returncode) == (("", -9) if how == "killed" else ("interrupted\n", 0))
