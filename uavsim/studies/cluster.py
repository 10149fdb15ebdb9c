"""Where many flights are flown: processes of this machine, or a cluster of the user's, by dask.distributed.

The cluster of this machine begins and ends with the run. What listens is on loopback and speaks TLS with keys that are
made for this run and never written, so that no other account of the machine can send it work; it serves no HTTP. Its
processes end with this one, however that ends, and do not hear Ctrl-C: their parent does.

A scheduler of the user's is reached by its address or by its scheduler file. Whoever can talk to a scheduler can run
code on all its workers and hand results to its clients; so one that is neither on loopback nor encrypted is refused
unless the user insists.
"""

import asyncio
import ipaddress
import json
import logging
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import process
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from uavsim.files import reason
from uavsim.interrupts import ignore, withheld

if TYPE_CHECKING:
    from distributed import Client, LocalCluster, Security, Worker

PATIENCE = 10.0  # s that a scheduler has to answer
LOOK = 5.0  # s between two looks how many workers there are
ENDING = 5.0  # s that processes have to end by themselves
BEGINNINGS = 3
REPLACING = 10.0  # s that a nanny has to begin a new process, before it is looked at itself
GIVEN_UP = 300.0  # s without any process
ENDED = ("closed", "closing", "failed", "stopped", "undefined")
LARGEST_FILE = 1_000_000  # bytes of a scheduler file
SILENT = 100  # above every level
QUIET = {  # of the cluster of this machine
    "distributed.scheduler.allowed-failures": 0,  # who dies with a worker is ours to say
    "distributed.scheduler.work-stealing": False,  # there is one task a worker
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.worker.multiprocessing-method": "spawn",
    "distributed.worker.profile.enabled": False,  # it looks at every thread a hundred times a second
    "distributed.comm.timeouts.connect": "30s",
    "distributed.admin.tick.interval": "1s",  # 20 ms and a half, else: 4 % of a processor with nothing to do
    "distributed.admin.tick.limit": "1h",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.deploy.lost-worker-timeout": "1h",  # a busy machine takes its time; we look ourselves
}


class ClusterError(Exception):
    """A cluster that cannot be used, or is no more; one line."""


@dataclass(frozen=True, slots=True)
class Remote:
    """A scheduler of the user's.

    Attributes
    ----------
    address : str
        tcp://HOST:PORT or tls://HOST:PORT, or the path of a scheduler file.
    ca, certificate, key : str or None
        Files in PEM format for TLS.
    insecure : bool
        Use one that is neither on loopback nor encrypted.
    """

    address: str
    ca: str | None = None
    certificate: str | None = None
    key: str | None = None
    insecure: bool = False


@dataclass(frozen=True)
class Site:
    """Workers that can be given work.

    Attributes
    ----------
    client : distributed.Client
    workers : callable
        How many tasks may be under way.
    local : bool
        Whether they are ours: of this machine, and for this run alone.
    stop : callable
        Ends those that are ours at once, whatever they do.
    """

    client: "Client"
    workers: Callable[[], int]
    local: bool
    stop: Callable[[], None]


@contextmanager
def local(workers: int, *, dashboard: bool = False) -> Iterator[Site]:
    """Have processes of this machine to the end of the block.

    Parameters
    ----------
    workers : int
        Processes.
    dashboard : bool
        Serve dask's pages on loopback, at a port that is told by `client.dashboard_link`; without a password: for
        machines that nobody else uses.

    Raises
    ------
    ClusterError
        The processes cannot be started.
    """
    import dask
    from distributed import Client

    if getattr(process.current_process(), "_inheriting", False):
        os._exit(1)  # the main script, run anew by a process of ours: without its guard it would begin more of them
    settings = {key: value for key, value in QUIET.items() if not (dashboard and "http.routes" in key)}
    with dask.config.set({**settings, "temporary-directory": tempfile.gettempdir()}), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of ports in use, and of what tornado closes late
        with withheld():  # threads and processes that begin here never hear Ctrl-C
            cluster = _cluster(workers, dashboard=dashboard)
        client = Client(cluster, set_as_default=False)
        staff = _Staff(cluster, workers)
        try:
            if not dashboard:
                _stop_serving(cluster.scheduler)
                with suppress(OSError, RuntimeError):  # one that has died just now; its successor is told, too
                    client.register_plugin(_quiet())
            yield Site(client, staff, local=True, stop=lambda: _kill(cluster))
        finally:
            _end(client, cluster)


def _cluster(workers: int, *, dashboard: bool) -> "LocalCluster":
    """Begin processes; one that dies as it begins, for once, is no reason to give up."""
    said = ""
    for _ in range(BEGINNINGS):
        try:
            return _begun(workers, dashboard=dashboard)
        except (RuntimeError, OSError, TimeoutError) as error:
            said = _line(error)
    raise ClusterError(
        f"no process could be started to fly in ({said}); each of them runs the main script anew: that needs to be a "
        "file whose work is below `if __name__ == '__main__':`"
    )


def _begun(workers: int, *, dashboard: bool) -> "LocalCluster":
    from distributed import LocalCluster

    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        host="127.0.0.1",
        security=True,
        dashboard_address="127.0.0.1:0",
        scheduler_kwargs={"dashboard": dashboard},
        memory_limit=None,
        silence_logs=SILENT,
    )


class _Staff:
    """How many processes can be given work: not those that have died and are not there again.

    So none is blamed for another's death. Each is looked after by a nanny, which begins a new one; where that itself
    has failed (it does on a machine that is busy enough), there is a new nanny.
    """

    def __init__(self, cluster: "LocalCluster", wanted: int) -> None:
        self._cluster: Any = cluster
        self._wanted = wanted
        self._whole = self._some = monotonic()  # when all were there, and any

    def __call__(self) -> int:
        alive, now = len(self._cluster.scheduler.workers), monotonic()
        if alive >= self._wanted:
            self._whole = now
        if alive:
            self._some = now
        elif now - self._some > GIVEN_UP:
            raise ClusterError(f"no process to fly in could be started for {GIVEN_UP:g} s")
        if now - self._whole > REPLACING:
            self._whole = now
            self._cluster.loop.add_callback(self._replace)
        return max(1, alive)

    def _replace(self) -> None:
        """Have new nannies in place of those that have ended; by the loop that they live in."""
        for name in [name for name, nanny in self._cluster.workers.items() if nanny.status.name in ENDED]:
            del self._cluster.workers[name]
        self._cluster.scale(self._wanted)


def _quiet() -> Any:
    """What each worker is told when it begins."""
    from distributed import WorkerPlugin

    class Quiet(WorkerPlugin):
        """Ends the HTTP server, which has no routes, and lets nothing but its parent end the process."""

        name = "uavsim-quiet"

        def setup(self, worker: "Worker") -> None:
            ignore_signals()
            _stop_serving(worker)

    return Quiet()


def _stop_serving(server: Any) -> None:
    """End the HTTP server of a scheduler or worker."""
    if server.http_server is not None:
        server.http_server.stop()


def ignore_signals() -> None:
    """Let a worker go on; only its main thread may say so, and elsewhere they are withheld already."""
    with suppress(ValueError):
        ignore()


def _kill(cluster: "LocalCluster") -> None:
    for nanny in cluster.workers.values():
        nanny.auto_restart = False
        process = getattr(nanny, "process", None)
        pid = getattr(process, "pid", None)
        if pid:
            with suppress(ProcessLookupError):
                os.kill(pid, 9)


def _end(client: "Client", cluster: "LocalCluster") -> None:
    """End everything; nothing that goes wrong here is of interest to anybody."""
    for end in (lambda: client.close(timeout=ENDING), lambda: cluster.close(timeout=ENDING)):
        with suppress(Exception):
            end()


# -- of the user's -----------------------------------------------------------------------------------------------------


@contextmanager
def remote(where: Remote) -> Iterator[Site]:
    """Have the workers of a scheduler of the user's.

    Raises
    ------
    ClusterError
        One line: no such address or file, no encryption, or no answer within 10 s.
    """
    address, security = _address(where), _security(where)
    with _silent():
        yield from _reached(address, security)


def _reached(address: str, security: "Security | None") -> Iterator[Site]:
    from distributed import Client

    with ThreadPoolExecutor(1) as apart:  # a notebook has a loop of its own here
        problem = apart.submit(asyncio.run, _asked(address, security)).result()
    if problem:
        raise ClusterError(f"the scheduler {address} does not answer within {PATIENCE:g} s ({problem})")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # versions are compared by us
        client = Client(address, security=security, timeout=PATIENCE, set_as_default=False, name="uavsim")
    try:
        yield of_client(client)
    finally:
        with suppress(Exception):
            client.close(timeout=ENDING)


async def _asked(address: str, security: "Security | None") -> str:
    """Ask a scheduler who it is; return what went wrong, in words, or nothing. What is no scheduler may answer, too."""
    import dask
    from distributed.core import rpc

    given = None if security is None else security.get_connection_args("client")
    there = None
    try:
        with dask.config.set({"distributed.comm.timeouts.connect": PATIENCE}):
            there = rpc(address, connection_args=given)
            told = await asyncio.wait_for(there.identity(), PATIENCE)
            return "" if told.get("type", "").endswith("Scheduler") else "it is no scheduler"
    except MemoryError:  # what came back was read as the length of a message
        return "it is no scheduler"
    except Exception as error:  # noqa: BLE001 (whatever comes back over the line)
        return _line(error)
    finally:
        if there is not None:
            await there.close_rpc()


@contextmanager
def _silent() -> Iterator[None]:
    """Let distributed write no lines of its own: what matters of it becomes an error of ours."""
    import distributed  # noqa: F401 (has its loggers made)

    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    before = [(logger, logger.level) for logger in loggers]
    for logger in loggers:
        logger.setLevel(SILENT)
    try:
        yield
    finally:
        for logger, level in before:
            logger.setLevel(level)


def of_client(client: "Client") -> Site:
    """Have the workers of a client, which is used as it is and stays open."""
    return Site(client, _Count(client), local=False, stop=lambda: None)


class _Count:
    """How many threads a client's workers have; asked now and then. While there are none, one task waits for them."""

    def __init__(self, client: "Client") -> None:
        self._client, self._known, self._asked = client, 1, -LOOK

    def __call__(self) -> int:
        if monotonic() - self._asked > LOOK:
            with suppress(OSError, TimeoutError):
                self._known = max(1, sum(self._client.nthreads().values()))
            self._asked = monotonic()
        return self._known


def _address(where: Remote) -> str:
    address = where.address
    if "://" not in address and (address.endswith(".json") or os.path.exists(address)):
        address = _of_file(address)
    if "://" not in address:
        address = f"tcp://{address}"
    scheme, host, port = "", None, None
    with suppress(ValueError):
        parts = urlsplit(address)
        scheme, host, port = parts.scheme, parts.hostname, parts.port
    if scheme not in ("tcp", "tls") or not host or not port:
        raise ClusterError(f"the scheduler {where.address!r}: give tcp://HOST:PORT, tls://HOST:PORT or its file")
    if scheme != "tls" and not _is_loopback(host) and not where.insecure:
        raise ClusterError(
            f"the scheduler {address} is neither encrypted nor on this machine: whoever can reach it can run code as "
            "you, and change results; use tls:// (docs/clusters.md), or say --insecure on a network of your own"
        )
    if scheme == "tls" and not (where.ca and where.certificate and where.key):
        raise ClusterError(f"the scheduler {address} needs --tls-ca, --tls-cert and --tls-key")
    return address


def _of_file(path: str) -> str:
    try:
        with Path(path).open(encoding="utf-8") as file:
            told = json.loads(file.read(LARGEST_FILE))
        address = told["address"]
    except OSError as error:
        raise ClusterError(f"the scheduler file {path}: {reason(error)}") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise ClusterError(f"the scheduler file {path}: holds no address of a scheduler") from None
    if not isinstance(address, str):
        raise ClusterError(f"the scheduler file {path}: its address is no text")
    return address


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _security(where: Remote) -> "Security | None":
    from distributed import Security

    if not (where.ca or where.certificate or where.key):
        return None
    for path in (where.ca, where.certificate, where.key):
        if path is None or not os.path.isfile(path):
            raise ClusterError(f"TLS: {path or '--tls-ca, --tls-cert and --tls-key'}: there is no such file")
    return Security(
        tls_ca_file=where.ca,
        tls_client_cert=where.certificate,
        tls_client_key=where.key,
        require_encryption=True,
    )


def _line(error: BaseException) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
