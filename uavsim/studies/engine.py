"""Work in parts, by many processes at once, that survives the death of any of them.

Each part is a function of its own argument alone, so the result depends neither on how many work, nor on the order in
which they finish, nor on whether a part is done twice. Parts are bundled so that a task lasts seconds; as many bundles
are under way as there are workers, so that a death tells which bundle it was. Parts of a bundle whose worker died are
done again one by one; a part that its worker dies of three times is given up and reported.

Ctrl-C and its kin end a run between two bundles: what is under way is waited for, unless they come a second time.
"""

import os
import pickle
import queue
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from hashlib import sha256
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Protocol, TypeVar

from uavsim.interrupts import Interrupts
from uavsim.plugins import PluginError, digests, load
from uavsim.studies.cluster import ClusterError, Remote, Site, local, of_client, remote
from uavsim.studies.identity import differences, identity

if TYPE_CHECKING:
    from distributed import Client as Client  # noqa: PLC0414 (others name it)
    from distributed import Future

A = TypeVar("A")
R = TypeVar("R")

LOOK = 0.2  # s between two looks whether somebody wants to end
BUNDLE = 3.0  # s that a task should last
LARGEST = 500  # parts in a bundle
LIVES = 3  # of a part: after as many deaths of its worker it is given up
PATIENCE = 1.5  # times its limit after which a part that does not end itself is ended with its worker
STUCK = 70  # exit status of a worker that was ended so


class TimeUp(Exception):  # noqa: N818 (nothing is wrong)
    """A part has taken longer than it may; it is left unfinished."""


@dataclass(frozen=True, slots=True)
class Left:
    """A part that is not done.

    Attributes
    ----------
    position : int
        Of its argument.
    why : str
        "its worker died 3 times", "it took longer than 60 s".
    """

    position: int
    why: str


class Crew(Protocol):
    """Who does work."""

    def each(
        self,
        work: Callable[[A], R],
        given: Sequence[A],
        *,
        done: Callable[[list[tuple[int, R]]], None],
        limit: float | None = None,
    ) -> list[Left]:
        """Do `work` on each of `given`, see `Engine.each`."""


class Setup(NamedTuple):
    """What a worker needs before it works: plug-ins by name and SHA-256 of their files, and who it has to be."""

    plugins: tuple[tuple[str, str], ...]
    identity: tuple[tuple[str, str], ...]


class Answer(NamedTuple):
    """What a bundle gave: of each part its position, whether it went well and what it gave; and how long all took."""

    parts: list[tuple[int, str, Any]]
    seconds: float


@contextmanager
def engine(
    *,
    workers: int | None = None,
    scheduler: Remote | None = None,
    client: "Client | None" = None,
    dashboard: bool = False,
) -> Iterator["Crew"]:
    """Have workers to the end of the block.

    Parameters
    ----------
    workers
        Processes of this machine; None: one a processor; 0: none, all is done in this one.
    scheduler
        A scheduler of the user's instead.
    client
        A client of the user's instead; used as it is.
    dashboard
        Serve dask's pages, of processes of this machine.

    Raises
    ------
    ClusterError
        One line: there are no workers, or they are not like us.
    """
    if workers is not None and not (isinstance(workers, int) and workers >= 0):
        raise ValueError(f"workers = {workers!r}: must be a whole number of at least 0")
    if client is not None and not all(hasattr(client, name) for name in ("submit", "nthreads", "run")):
        raise ValueError(f"client = {client!r}: must be a distributed.Client")
    if workers == 0 and client is None and scheduler is None:
        yield InTurn()
        return
    if client is not None:
        site = nullcontext(of_client(client))
    elif scheduler is not None:
        site = remote(scheduler)  # type: ignore[assignment]
    else:
        site = local(workers or os.cpu_count() or 1, dashboard=dashboard)  # type: ignore[assignment]
    with site as there:
        found = Engine(there)
        found.check()
        yield found


def processes(workers: int | None, parts: int) -> int:
    """Return how many processes do so many parts: none besides this one where one is enough."""
    wanted = min(workers or os.cpu_count() or 1, parts)
    return 0 if wanted <= 1 else wanted


class Engine:
    """Workers, and what they are given.

    Parameters
    ----------
    site
        Where they are.
    """

    def __init__(self, site: Site) -> None:
        self.site = site
        self._setup = Setup(digests(), tuple(identity().items()))

    def check(self) -> None:
        """Refuse workers that have other versions, plug-ins or processors than we; ours are not asked."""
        if self.site.local:
            return
        with _blamed():
            found = self.site.client.run(_greet, self._setup, on_error="return")
        for worker, told in found.items():
            if isinstance(told, Exception):
                raise ClusterError(f"worker {worker}: {_words(told)}")
            if told:
                raise ClusterError(f"worker {worker}: {told}")

    def each(
        self,
        work: Callable[[A], R],
        given: Sequence[A],
        *,
        done: Callable[[list[tuple[int, R]]], None],
        limit: float | None = None,
    ) -> list[Left]:
        """Do `work` on each of `given`.

        Parameters
        ----------
        work
            A function that can be pickled.
        given
            Its arguments.
        done
            Called with positions in `given` and what they gave, as they come; nothing interrupts it.
        limit
            How long one part may take, s; `work` may look at it by itself and raise `TimeUp`. One that does not end
            half as long after that is ended with its worker.

        Returns
        -------
        list of Left
            What could not be done.

        Raises
        ------
        KeyboardInterrupt
            Somebody wants to end: nothing was begun since, what was under way is done. The second time it is not.
        ClusterError
            The scheduler is no more, or a worker is not like us.
        """
        with Interrupts() as asked:
            shift = _Shift(self, work, given, limit)
            try:
                while asked.count < 2:
                    if not asked.count:
                        shift.hand_out()
                    if not shift.under_way:
                        break
                    finished = shift.gather()
                    if not asked.count and shift.error is None:
                        shift.hand_out()  # before anything is written: nobody waits for the disk
                    if finished:
                        done(finished)
                    if shift.error is not None:
                        raise shift.error
            finally:
                shift.end()
        return sorted(shift.left, key=lambda left: left.position)


class _Shift(Generic[A, R]):
    """One piece of work: what is left to do, what is under way, and what has died."""

    def __init__(self, crew: Engine, work: Callable[[A], R], given: Sequence[A], limit: float | None) -> None:
        from distributed.protocol import pickle as pickled

        self._crew, self._given, self._limit = crew, given, limit
        blob = pickled.dumps(work)
        self._task = partial(_bundle, blob, sha256(blob).hexdigest(), crew._setup, limit, os.getpid())
        self._fresh, self._again = deque(range(len(given))), deque[int]()
        self._died: dict[int, int] = {}
        self._cost = BUNDLE  # s a part; unknown, so the first bundles have one
        self._ended: queue.SimpleQueue[Future[Answer]] = queue.SimpleQueue()
        self.under_way: dict[Future[Answer], tuple[int, ...]] = {}
        self._begun: dict[Future[Answer], float] = {}
        self.left: list[Left] = []
        self.error: Exception | None = None

    def hand_out(self) -> None:
        """Give work to all that have none; parts that a worker died of come last, one by one."""
        free = self._crew.site.workers() - len(self.under_way)
        while free > 0 and (self._fresh or self._again):
            if self._fresh:
                size = self._size()
                self._submit(tuple(self._fresh.popleft() for _ in range(size)))
            elif not self.under_way or self._died[self._again[0]] < LIVES - 1:
                self._submit((self._again.popleft(),))
            else:
                break  # its last life it has by itself, so that no other one is blamed for it, or it for another
            free -= 1

    def _size(self) -> int:
        """Parts in the next bundle: seconds of work, but towards the end few enough that all have some."""
        share = -(-len(self._fresh) // (2 * self._crew.site.workers()))
        return max(1, min(round(BUNDLE / self._cost), share, LARGEST, len(self._fresh)))

    def _submit(self, positions: tuple[int, ...]) -> None:
        parts = [(position, self._given[position]) for position in positions]
        with _blamed():
            future = self._crew.site.client.submit(self._task, parts, pure=False, retries=0)
        self.under_way[future] = positions
        self._begun[future] = time.monotonic()
        future.add_done_callback(self._ended.put)

    def gather(self) -> list[tuple[int, R]]:
        """Wait for what is finished, not for long."""
        ended: list[Future[Answer]] = []
        with suppress(queue.Empty):
            ended.append(self._ended.get(timeout=LOOK))
            while True:
                ended.append(self._ended.get_nowait())
        if not ended and self._crew.site.client.status not in ("running", "connecting"):
            raise ClusterError("the scheduler is no more")
        finished: list[tuple[int, R]] = []
        for future in ended:
            positions, lasted = self.under_way.pop(future), time.monotonic() - self._begun.pop(future)
            finished += self._answers(future, positions, lasted)
            future.release()
        return finished

    def _answers(self, future: "Future[Answer]", positions: tuple[int, ...], lasted: float) -> list[tuple[int, R]]:
        from distributed import KilledWorker

        try:
            answer = future.result()
        except KilledWorker as killed:
            self._bury(positions, getattr(killed, "allowed_failures", 0) + 1, lasted)
            return []
        except (OSError, TimeoutError) as error:
            raise ClusterError(f"the scheduler is no more ({_words(error)})") from None
        except Exception as error:  # noqa: BLE001 (it is the caller's, who gets it)
            if "cancel" in type(error).__name__.lower():
                raise ClusterError("the scheduler is no more") from None
            self.error = error
            return []
        self._cost += 0.5 * (max(answer.seconds / len(positions), 1e-3) - self._cost)
        finished = []
        for position, how, result in answer.parts:
            if how == "done":
                finished.append((position, result))
            elif how == "left":
                self.left.append(Left(position, result))
            else:
                self.error = result
        return finished

    def _bury(self, positions: tuple[int, ...], deaths: int, lasted: float) -> None:
        """A worker has died of these, or beside them, or was ended as one of them took too long."""
        longest = None if self._limit is None else PATIENCE * self._limit
        alone = len(positions) == 1
        for position in positions:
            self._died[position] = self._died.get(position, 0) + (deaths if alone else 0)
            if self._died[position] >= LIVES:
                hung = longest is not None and lasted >= longest
                what = f"it took longer than {longest:g} s" if hung else "its worker died"
                self.left.append(Left(position, f"{what}, {self._died[position]} times"))
            else:
                self._again.append(position)

    def end(self) -> None:
        """Take back what is under way."""
        if self.under_way:
            self._crew.site.stop()
            with suppress(Exception):
                self._crew.site.client.cancel(list(self.under_way), force=True)
        self.under_way.clear()


class InTurn:
    """No workers: all is done here, one part after the other."""

    def each(
        self,
        work: Callable[[A], R],
        given: Sequence[A],
        *,
        done: Callable[[list[tuple[int, R]]], None],
        limit: float | None = None,
    ) -> list[Left]:
        """Do `work` on each of `given`, see `Engine.each`; an interrupt comes at once."""
        del limit  # `work` looks at it by itself
        left = []
        for position, argument in enumerate(given):
            try:
                result = work(argument)
            except TimeUp as late:
                left.append(Left(position, str(late)))
                continue
            with Interrupts():
                done([(position, result)])
        return left


@contextmanager
def _blamed() -> Iterator[None]:
    try:
        yield
    except (OSError, TimeoutError) as error:
        raise ClusterError(f"the scheduler does not answer ({_words(error)})") from None


def _words(error: BaseException) -> str:
    return " ".join(str(error).split())[:300] or type(error).__name__


# -- in a worker -------------------------------------------------------------------------------------------------------

_TURN = threading.Lock()  # JSBSim, and what a plug-in does, are not for several threads of a process at once


@lru_cache(maxsize=4)
def _greet(setup: Setup) -> str:
    """Get ready to work; return why that cannot be, in a line, or nothing."""
    different = differences(dict(setup.identity), identity())
    if different:
        return f"is not like this machine: {'; '.join(different)}"
    try:
        load(name for name, _ in setup.plugins)
    except PluginError as error:
        return f"lacks a plug-in: {error}"
    here = dict(digests())
    other = next((name for name, digest in setup.plugins if here.get(name) != digest), None)
    return (
        "" if other is None else f"has another --plugin {other}: that of an earlier run, or another file; begin it anew"
    )


_WORK: dict[str, Any] = {}


def _work(blob: bytes, digest: str) -> Any:
    """Return the work that bytes are, kept from one bundle to the next."""
    from distributed.protocol import pickle as pickled

    if digest not in _WORK:
        _WORK.clear()
        _WORK[digest] = pickled.loads(blob)
    return _WORK[digest]


def _bundle(
    blob: bytes, digest: str, setup: Setup, limit: float | None, driver: int, parts: list[tuple[int, Any]]
) -> Answer:
    """Do some parts, one after the other."""
    with _TURN:
        refused = _greet(setup)
        if refused:
            raise ClusterError(f"a worker {refused}")
        work = _work(blob, digest)
        started = time.monotonic()
        done = []
        for position, argument in parts:
            with _watched(limit if os.getpid() != driver else None):
                done.append((position, *_part(work, argument)))
            if done[-1][1] == "wrong":
                break
        return Answer(done, time.monotonic() - started)


def _part(work: Callable[[Any], Any], argument: Any) -> tuple[str, Any]:
    try:
        return "done", work(argument)
    except TimeUp as late:
        return "left", str(late)
    except Exception as error:  # noqa: BLE001 (it is the caller's, who gets it)
        note = f"In a process of its own:\n{traceback.format_exc()}"
        try:
            pickle.loads(pickle.dumps(error))  # noqa: S301 (of our own)
        except Exception:  # noqa: BLE001
            error = RuntimeError(_words(error))
        error.add_note(note)
        return "wrong", error


@contextmanager
def _watched(limit: float | None) -> Iterator[None]:
    """End this process if the block does not end in time: nothing else stops what hangs in a step."""
    if limit is None:
        yield
        return
    timer = threading.Timer(PATIENCE * limit, partial(os._exit, STUCK))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
