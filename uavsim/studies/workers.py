"""Work in parts, by several threads at once: numpy and the compiled kernels let go of the interpreter while they work.

Each part is a function of its own arguments alone, so the result does not depend on how many work.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from typing import TypeVar

T = TypeVar("T")
Progress = Callable[[float], None]
"""Called with the share of the work that is done, 0 … 1."""


def threads(workers: int | None) -> int:
    """How many work; None: one a processor."""
    return workers or os.cpu_count() or 1


def spread(
    parts: Sequence[Callable[[], T]], *, workers: int | None = None, progress: Progress | None = None
) -> list[T]:
    """Do all parts; return what they gave, in their order.

    Parameters
    ----------
    parts
        Functions without arguments.
    workers
        Threads; None: one a processor. Where numba's JIT is off the parts are done one after the other.
    progress
        Called after each part.

    Notes
    -----
    An interrupt, or what a part raises, ends it: parts that have not begun are left out, those that have are waited
    for.
    """
    from uavsim.compiled import jit

    if not jit():  # threads of plain Python wait for each other, and keep an interrupt waiting
        return _one_by_one(parts, progress)
    with ThreadPoolExecutor(threads(workers)) as pool:
        waiting: list[Future[T]] = [pool.submit(part) for part in parts]
        try:
            for done, future in enumerate(as_completed(waiting), 1):
                future.result()
                if progress is not None:
                    progress(done / len(waiting))
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return [future.result() for future in waiting]


def _one_by_one(parts: Sequence[Callable[[], T]], progress: Progress | None) -> list[T]:
    found = []
    for done, part in enumerate(parts, 1):
        found.append(part())
        if progress is not None:
            progress(done / len(parts))
    return found
