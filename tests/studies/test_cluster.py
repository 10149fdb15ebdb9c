"""Where flights are flown: nobody else's processes, no open door, and clusters of the user's that are like us."""

import gc
import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from uavsim.scenario import load_scenario
from uavsim.studies import cluster, engine, identity
from uavsim.studies.batch import fly_seeds
from uavsim.studies.campaign.campaign import fly_plan
from uavsim.studies.campaign.keep import NOTHING
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.record import Record
from uavsim.studies.cluster import ClusterError, Remote, local

if os.name != "posix":
    pytest.skip("processes and ports", allow_module_level=True)

CHANGES = ("duration=2.5", "launcher.wait_min=1.6", "launcher.wait_max=1.7", "expect=timeout", "requirements=[]")
SHORT = load_scenario("catapult", overrides=CHANGES)
FLIGHTS = 6


# -- of this machine ---------------------------------------------------------------------------------------------------


def listening(pids: set[int]) -> set[tuple[str, int]]:
    """Addresses and ports at which processes listen, by /proc."""
    inodes = set()
    for pid in pids:
        for link in Path(f"/proc/{pid}/fd").iterdir():
            target = os.readlink(link) if link.is_symlink() else ""
            if target.startswith("socket:["):
                inodes.add(target[8:-1])
    found = set()
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
        fields = line.split()
        if fields[3] == "0A" and fields[9] in inodes:
            host, port = fields[1].split(":")
            found.add((socket.inet_ntoa(bytes.fromhex(host)[::-1]), int(port, 16)))
    return found


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="no /proc")
def test_what_listens_is_on_loopback_and_wants_the_key_of_this_run() -> None:
    """A client without it, or with that of another run, gets nowhere; nothing answers to HTTP, at 8787 or elsewhere."""
    from distributed import Client, Security

    before = listening({os.getpid()})
    with local(2) as site:
        pids = {os.getpid(), *site.client.run(os.getpid).values()}
        ports = listening(pids) - before
        assert len(ports) == 5  # of the scheduler, of two workers and of what looks after each
        assert {host for host, _ in ports} == {"127.0.0.1"}
        assert 8787 not in {port for _, port in ports}
        for _, port in ports:
            assert answer(port, b"GET /info HTTP/1.0\r\n\r\n") == b""
        address = site.client.scheduler.address  # type: ignore[union-attr]
        assert address.startswith("tls://")
        for security in (Security.temporary(), None):
            with pytest.raises((OSError, TypeError, TimeoutError)):
                Client(address, security=security, timeout=2)
            gc.collect()  # what is left of it stops its loop now
        with pytest.raises(OSError, match=r"Timed out|timed out|refused|closed"):
            Client(address.replace("tls", "tcp"), timeout=2)
        gc.collect()
        assert site.client.submit(sum, [1, 2]).result() == 3  # all the while it works


def answer(port: int, question: bytes) -> bytes:
    with socket.create_connection(("127.0.0.1", port), timeout=5) as there:
        there.settimeout(1.0)
        try:
            there.sendall(question)
            said = there.recv(1000)
        except OSError:
            return b""
        return said if said.startswith(b"HTTP") else b""


def test_no_file_holds_a_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with local(1) as site:
        assert site.client.submit(sum, [1, 2]).result() == 3
        texts = [path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()]
        assert not any(b"PRIVATE KEY" in text for text in texts)


# -- of the user's -----------------------------------------------------------------------------------------------------


@dataclass
class Cluster:
    address: str
    scheduler: "subprocess.Popen[str]"
    workers: "list[subprocess.Popen[str]]"


def free_port() -> int:
    with socket.socket() as it:
        it.bind(("127.0.0.1", 0))
        return int(it.getsockname()[1])


@contextmanager
def begun(folder: Path, count: int, *more: str, environment: "dict[str, str] | None" = None) -> Iterator[Cluster]:
    """Begin a scheduler and workers by dask's own command, as the manual has it."""
    port = free_port()
    scheme = "tls" if more else "tcp"
    address = f"{scheme}://127.0.0.1:{port}"
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **(environment or {})}

    def start(*command: str) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *command, *more],
            cwd=folder, env=env, text=True, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    processes = [start("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")]
    try:
        for _ in range(count):
            processes.append(start("worker", address, "--nworkers", "1", "--nthreads", "1", "--no-dashboard"))
        yield Cluster(address, processes[0], processes[1:])
    finally:
        for process in processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def wait_for(site: Any, count: int) -> None:
    site.client.wait_for_workers(count, timeout=120)


def test_a_cluster_of_ones_own_gives_the_same_rows(tmp_path: Path) -> None:
    plan = Random(SHORT, FLIGHTS)
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    with begun(tmp_path, 2) as there, engine.engine(scheduler=Remote(there.address)) as crew:
        assert isinstance(crew, engine.Engine)
        wait_for(crew.site, 2)
        assert fly_plan(Record(tmp_path / "there", plan), crew, NOTHING).complete
    fly_plan(Record(tmp_path / "here", plan), engine.InTurn(), NOTHING)
    rows = [(tmp_path / name / "runs.parquet").read_bytes() for name in ("here", "there")]
    assert rows[0] == rows[1]


def test_a_scheduler_that_is_killed_is_told_and_what_was_finished_is_kept(tmp_path: Path) -> None:
    plan = Random(SHORT, 500)
    record = Record(tmp_path, plan)
    with begun(tmp_path, 1) as there, engine.engine(scheduler=Remote(there.address)) as crew:

        def kill(*_: object) -> None:
            os.killpg(there.scheduler.pid, signal.SIGKILL)

        with pytest.raises(ClusterError, match="the scheduler is no more"):
            fly_plan(record, crew, NOTHING, progress=kill)
    assert 0 < record.finished < 500
    whole = fly_seeds(SHORT, [1], workers=1).runs
    from uavsim.studies.campaign.record import frame

    rows = frame(tmp_path)
    assert len(rows) == record.finished
    assert rows["launch.latency"][0] == whole["launch.latency"][0]


def test_tls_files_of_ones_own(tmp_path: Path) -> None:
    """A certificate that names nobody and an authority that signed it: dask's tutorial, and the manual's."""
    ca = cert = key = None
    from distributed import Security

    made = Security.temporary()
    for name, text in (("ca", made.tls_ca_file), ("cert", made.tls_client_cert), ("key", made.tls_client_key)):
        (tmp_path / f"{name}.pem").write_text(str(text))
    ca, cert, key = (str(tmp_path / f"{name}.pem") for name in ("ca", "cert", "key"))
    more = ("--tls-ca-file", ca, "--tls-cert", cert, "--tls-key", key)
    with begun(tmp_path, 1, *more) as there:
        with engine.engine(scheduler=Remote(there.address, ca, cert, key)) as crew:
            done: list[tuple[int, int]] = []
            assert crew.each(abs, [-3, 4], done=done.extend) == []
            assert sorted(done) == [(0, 3), (1, 4)]
        with (
            pytest.raises(ClusterError, match="needs --tls-ca, --tls-cert and --tls-key"),
            engine.engine(scheduler=Remote(there.address)),
        ):
            pass


def test_a_worker_that_is_not_like_us_is_refused_and_both_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = {**identity.identity(), "numpy": "1.99", "processor features": "avx avx99"}
    monkeypatch.setattr(engine, "identity", lambda: mine)
    with begun(tmp_path, 1) as there:
        _until(there)
        with pytest.raises(ClusterError) as caught, engine.engine(scheduler=Remote(there.address)):
            pass
    said = str(caught.value)
    assert said.startswith("worker tcp://127.0.0.1:")
    assert f"numpy: {identity.identity()['numpy']} there, 1.99 here" in said
    assert "avx99 here" in said
    assert "\n" not in said


def test_a_worker_without_a_plug_in_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "digests", lambda: (("/nowhere/mine.py", "0" * 64),))
    with begun(tmp_path, 1) as there:
        _until(there)
        says = r"lacks a plug-in: --plugin '/nowhere/mine.py': there is no such file"
        with pytest.raises(ClusterError, match=says), engine.engine(scheduler=Remote(there.address)):
            pass


def _until(there: Cluster) -> None:
    from distributed import Client

    with Client(there.address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(1, timeout=120)


def test_a_client_of_ones_own_is_used_and_left_open() -> None:
    """Threads of this process, too: they take turns."""
    from distributed import Client

    with Client(
        processes=False, n_workers=1, threads_per_worker=3, dashboard_address=":0", set_as_default=False
    ) as own:
        with engine.engine(client=own) as crew:
            found: dict[int, int] = {}
            assert crew.each(abs, range(-5, 0), done=found.update) == []
            assert found == {0: 5, 1: 4, 2: 3, 3: 2, 4: 1}
        assert own.submit(sum, [1, 2]).result() == 3


# -- what cannot be ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("where", "says"),
    [
        (Remote("tcp://192.0.2.7:8786"), "is neither encrypted nor on this machine"),
        (Remote("192.0.2.7:8786"), "is neither encrypted nor on this machine"),
        (Remote("tcp://cluster.example:8786"), "is neither encrypted nor on this machine"),
        (Remote("tls://192.0.2.7:8786"), "needs --tls-ca, --tls-cert and --tls-key"),
        (Remote("tls://192.0.2.7:8786", "no.pem", "no.pem", "no.pem"), "no.pem: there is no such file"),
        (Remote("http://127.0.0.1:8786"), "give tcp://HOST:PORT"),
        (Remote("tcp://127.0.0.1"), "give tcp://HOST:PORT"),
        (Remote("tcp://127.0.0.1:x"), "give tcp://HOST:PORT"),
        (Remote("tcp://[::1"), "give tcp://HOST:PORT"),
        (Remote(""), "give tcp://HOST:PORT"),
        (Remote("none.json"), "the scheduler file none.json"),
    ],
)
def test_an_address_that_is_none_is_one_line(where: Remote, says: str) -> None:
    with pytest.raises(ClusterError, match=r"scheduler|TLS") as caught, cluster.remote(where):
        pass
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "[]", "{", '{"address": 3}', '{"address": "tcp://192.0.2.7:1"}', "x" * 2_000_000])
def test_a_scheduler_file_that_is_none_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "scheduler.json").write_text(text)
    with pytest.raises(ClusterError) as caught, cluster.remote(Remote(str(tmp_path / "scheduler.json"))):
        pass
    assert "\n" not in str(caught.value)


def test_what_answers_and_is_no_scheduler_is_one_line() -> None:
    """A web server, or a proxy, on the port."""
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(8)

        def serve() -> None:
            with suppress(OSError):
                while True:
                    there, _ = server.accept()
                    there.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                    there.close()

        Thread(target=serve, daemon=True).start()
        where = Remote(f"tcp://127.0.0.1:{server.getsockname()[1]}")
        with pytest.raises(ClusterError, match="does not answer within") as caught, cluster.remote(where):
            pass
    assert "\n" not in str(caught.value)


MINE = """
from uavsim.plugins import detector
@detector("mine-of-workers", level="f", unit="m/s²")
class Mine:
    def __init__(self, rate, settings=None): self.reset()
    def step(self, t, fx, fy, fz): return False
    def reset(self): pass
"""
ASKING = """
import sys
from uavsim import plugins
from uavsim.studies.cluster import Remote
from uavsim.studies.engine import engine

def told(_):
    from uavsim import plugins
    return dict(plugins.digests())[sys.argv[1]]

plugins.load([sys.argv[1]])
found = {}
with engine(scheduler=Remote(sys.argv[2])) as crew:
    crew.each(told, [0], done=found.update)
print(found[0])
"""


def test_a_plug_in_that_was_changed_is_taken_anew_by_a_worker_that_lives_on(tmp_path: Path) -> None:
    mine = tmp_path / "mine_of_workers.py"
    with begun(tmp_path, 1) as there:
        _until(there)
        for text in (MINE, f"{MINE}# another\n"):
            mine.write_text(text)
            code = ASKING.replace("sys.argv[1]", repr(str(mine))).replace("sys.argv[2]", repr(there.address))
            asked = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
            assert asked.stdout.strip() == sha256(text.encode()).hexdigest()


def test_a_scheduler_file_names_its_address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody listens there, so it does not answer; how long it is waited for is shortened here."""
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    address = f"tcp://127.0.0.1:{free_port()}"
    (tmp_path / "scheduler.json").write_text(json.dumps({"address": address}))
    there = Remote(str(tmp_path / "scheduler.json"))
    says = f"the scheduler {address} does not answer within 0.5 s"
    with pytest.raises(ClusterError, match=says), cluster.remote(there):
        pass
