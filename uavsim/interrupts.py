"""What asks a run to end: Ctrl-C, and as Ctrl-C SIGTERM (timeout, Docker, SLURM) and SIGHUP (a terminal that closes).

Python raises KeyboardInterrupt wherever it stands. Where files are written that would leave half of them, so there
signals are counted, and KeyboardInterrupt is raised when the block has ended.
"""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType, TracebackType
from typing import Any

SIGNALS = tuple(
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP")
    if hasattr(signal, name)  # Windows has no SIGHUP
)
Handler = Callable[[int, FrameType | None], Any] | int | None


@contextmanager
def like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP raise KeyboardInterrupt inside the block; one that is ignored (nohup) stays so."""
    changed: dict[int, Handler] = {}
    if current_thread() is main_thread():  # only there may handlers be set
        for number in SIGNALS:
            if signal.getsignal(number) is signal.SIG_DFL:
                changed[number] = signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number, handler in changed.items():
            signal.signal(number, handler)


class Interrupts:
    """A block in which signals that ask to end are counted; KeyboardInterrupt comes after it, when all is whole.

    Handlers of the caller's own, signals that are ignored and an `Interrupts` around this one are left as they are.

    Attributes
    ----------
    count : int
        Signals so far.
    """

    def __init__(self) -> None:
        self.count = 0
        self._before: dict[int, Handler] = {}

    def __enter__(self) -> "Interrupts":
        if current_thread() is main_thread():
            for number in SIGNALS:
                if signal.getsignal(number) is signal.default_int_handler:
                    self._before[number] = signal.signal(number, self._note)
        return self

    def _note(self, *_: object) -> None:
        self.count += 1

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        if self.count and kind is None:
            raise KeyboardInterrupt


@contextmanager
def withheld() -> Iterator[None]:
    """Start processes that never get these signals; those for this process come at the end of the block."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows; there they are told to ignore them
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore() -> None:
    """Let this process, a worker, go on; it ends with its parent."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
