"""Work in parts, by several processes at once, that survives the death of any of them.

Each part is a function of its own argument alone, so the result does not depend on how many work. A worker has one part
at a time and a line of its own to its parent, so it is known which part a process died of, and no lock dies with it.

Workers end with their parent, however that ends: each waits for its end in a thread. Ctrl-C and its kin are not theirs,
though a terminal sends them to all.
"""

import os
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from pickle import PicklingError
from threading import Thread
from typing import Any, Generic, TypeVar

from uavsim.interrupts import Interrupts, ignore, withheld

if os.name == "posix":
    from multiprocessing import resource_tracker

A = TypeVar("A")
R = TypeVar("R")

SPAWN = get_context("spawn")
LOOK = 0.2  # s between two looks whether somebody wants to end
DYING = 5.0  # s that a process may take to end once its line is closed
LIVES = 2  # of a part: after as many deaths of its process it is given up


def each(
    work: Callable[[A], R],
    given: Sequence[A],
    *,
    workers: int,
    done: Callable[[list[tuple[int, R]]], None],
    first: Callable[[], object] | None = None,
) -> list[int]:
    """Do `work` on each of `given`.

    Parameters
    ----------
    work
        A function that can be pickled.
    given
        Its arguments.
    workers
        Processes.
    done
        Called with positions in `given` and what they gave, as they come; nothing interrupts it.
    first
        Called in each process before it takes in anything else: what `work` and its arguments need to be known.

    Returns
    -------
    list of int
        Positions whose process died twice, the second time with no other one working.

    Raises
    ------
    KeyboardInterrupt
        Somebody wants to end: no part was begun since, those under way are done. The second time they are not.
    """
    with Interrupts() as asked:
        crew = _Crew(work, given, workers, first)
        try:
            while asked.count < 2:
                if asked.count:
                    crew.call_off()
                else:
                    crew.hand_out()
                if not crew.busy:
                    break
                finished = crew.gather()
                if finished:
                    done(finished)
                if crew.error is not None:
                    raise crew.error
        finally:
            crew.end()
    return sorted(crew.lost)


class _Crew(Generic[A, R]):
    """Workers, what they do, and what is left to do."""

    def __init__(
        self, work: Callable[[A], R], given: Sequence[A], size: int, first: Callable[[], object] | None
    ) -> None:
        self._work, self._given, self._size, self._first = work, given, size, first
        self._workers: list[_Worker] = []
        self._fresh, self._again = deque(range(len(given))), deque[int]()
        self._died = [0] * len(given)
        self.lost: list[int] = []
        self.error: Exception | None = None

    @property
    def busy(self) -> "list[_Worker]":
        return [worker for worker in self._workers if worker.part is not None]

    def hand_out(self) -> None:
        """Give a part to all that have none; those that a process died of come last, one by one."""
        while self._fresh and len(self.busy) < self._size:
            self._give(self._fresh.popleft())
        if self._again and not self.busy:
            self._give(self._again.popleft())

    def _give(self, part: int) -> None:
        idle = next((worker for worker in self._workers if worker.part is None), None)
        if idle is None:
            idle = _Worker(self._work, self._first)
            self._workers.append(idle)
        idle.give(part, self._given[part])

    def call_off(self) -> None:
        """Stop those that are only getting ready."""
        for worker in self.busy:
            if not worker.began:
                worker.process.kill()
                worker.part = None

    def gather(self) -> list[tuple[int, R]]:
        """Wait for what is finished, not for long."""
        lines = {worker.line: worker for worker in self.busy}
        finished = []
        for line in wait(list(lines), timeout=LOOK):
            worker = lines[line]  # type: ignore[index]  # only lines were given
            try:
                message = worker.line.recv()
            except (EOFError, OSError):
                self._bury(worker)
                continue
            if not worker.began:
                worker.began = True
                continue
            part, worker.part = worker.part, None
            assert part is not None
            well, result = message
            if well:
                finished.append((part, result))
            else:
                self.error = result
        return finished

    def _bury(self, worker: "_Worker") -> None:
        self._workers.remove(worker)
        part = worker.part
        assert part is not None
        status = worker.end()
        if not worker.began and status > 0:  # it is not killed but cannot work, and said why
            raise RuntimeError(
                f"a process to work in ended before it began, with status {status}; it runs the main script anew: "
                "that needs to be a file whose work is below `if __name__ == '__main__':`"
            ) from None
        self._died[part] += 1
        (self._again if self._died[part] < LIVES else self.lost).append(part)

    def end(self) -> None:
        """End all, at once."""
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.end()


class _Worker:
    """A process that does one part after another.

    Attributes
    ----------
    line : Connection
        Closed on the other end when the process ends.
    part : int or None
        What it is doing.
    began : bool
        Whether it has said that it can work.
    """

    def __init__(self, work: Callable[[Any], Any], first: Callable[[], object] | None) -> None:
        self.part: int | None = None
        self.began = False
        self.line, theirs = SPAWN.Pipe()
        self.process = SPAWN.Process(target=_serve, args=(theirs,), daemon=True)
        if os.name == "posix":
            resource_tracker.ensure_running()  # starting it lets signals through
        with withheld():
            self.process.start()
        theirs.close()
        self._send(first)
        self._send(work)

    def give(self, part: int, argument: Any) -> None:
        self.part = part
        self._send(argument)

    def _send(self, message: Any) -> None:
        with suppress(OSError):  # it has died, and its line will say so
            self.line.send(message)

    def end(self) -> int:
        """Wait for the process, whose line is closed or which is killed; return its exit status."""
        self.line.close()
        self.process.join(DYING)
        self.process.kill()
        self.process.join()
        status = self.process.exitcode
        self.process.close()
        return 0 if status is None else status


def _serve(line: "Connection[Any, Any]") -> None:
    """Work, in a process of its own, until there is nothing more to do."""
    Thread(target=_end_with_parent, daemon=True).start()
    ignore()
    try:
        first = line.recv()
        if first is not None:
            first()
        work = line.recv()
        line.send(None)
        while True:
            _answer(line, work, line.recv())
    except (EOFError, OSError):  # the parent wants no more, or is no more
        pass


def _answer(line: "Connection[Any, Any]", work: Callable[[Any], Any], argument: Any) -> None:
    try:
        message = True, work(argument)
    except Exception as error:  # noqa: BLE001 (it is the caller's, who gets it)
        error.add_note(f"In a process of its own:\n{traceback.format_exc()}")
        message = False, error
    try:
        line.send(message)
    except (AttributeError, TypeError, PicklingError) as error:
        line.send((False, RuntimeError(f"what a process gave cannot be sent: {error}")))


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
