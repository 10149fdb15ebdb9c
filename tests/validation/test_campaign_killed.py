"""A campaign whose worker, driver or scheduler is killed at any time, and then taken up, ends in the same rows.

Twenty random instants each, from the first moment on, drawn by seed 14; the rows are compared byte for byte with those
of flights that were flown one after the other in one process.
"""

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from studies.test_cluster import begun
from test_cli_campaign import SHORT, Run, ended, run, start
from test_cli_killed import CHANGES, Start, alive, wait_until, workers_of

from uavsim.scenario import load_scenario
from uavsim.studies.campaign.campaign import fly_plan
from uavsim.studies.campaign.keep import NOTHING
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.record import Record
from uavsim.studies.engine import InTurn

__all__ = ["run", "start"]  # fixtures

pytestmark = pytest.mark.slow

KILLS = 20
RUNS = 100
SHORTEST, LONGEST = 0.8, 7.0  # s; about as long as it takes on two cores
ARGUMENTS = ("campaign", "catapult", *SHORT, "--runs", str(RUNS))
Table = Callable[[str], None]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Rows of flights that were flown one after the other in this process."""
    folder = tmp_path_factory.mktemp("whole")
    plan = Random(load_scenario("catapult", overrides=[*CHANGES, "expect=timeout"]), RUNS)
    fly_plan(Record(folder, plan), InTurn(), NOTHING)
    return (folder / "runs.parquet").read_bytes()


def instants() -> list[float]:
    return [float(t) for t in np.random.default_rng(14).uniform(SHORTEST, LONGEST, KILLS)]


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_any_number_of_workers(tmp_path: Path, run: Run, whole: bytes, workers: int) -> None:
    assert run(*ARGUMENTS, "--workers", str(workers), "--out", "here") == 0
    assert (tmp_path / "here" / "runs.parquet").read_bytes() == whole


@pytest.mark.parametrize("who", ["worker", "driver"])
def test_a_worker_or_the_driver(tmp_path: Path, start: Start, run: Run, whole: bytes, table: Table, who: str) -> None:
    rows = []
    for number, delay in enumerate(instants()):
        folder = tmp_path / f"{who}-{number}"
        flying = start(tmp_path, *ARGUMENTS, "--workers", "2", "--out", folder.name)
        kill_after(flying, delay, lambda pid: workers_of(pid)[:1] if who == "worker" else [pid])
        wait_until(lambda group=flying.pid: not alive(group))
        rows.append(ended(folder))
        if who == "worker":
            assert (flying.returncode, rows[-1]) == (0, RUNS)
        assert run(*ARGUMENTS, "--workers", "2", "--out", folder.name, "--resume") == 0
        assert (folder / "runs.parquet").read_bytes() == whole
    table(f"{who} killed, rows kept of {RUNS}: {sorted(rows)}")


def test_the_scheduler(tmp_path: Path, start: Start, run: Run, whole: bytes, table: Table) -> None:
    """One of the user's, with two workers; it is gone, so the rest is flown by processes of this machine."""
    rows = []
    for number, delay in enumerate(instants()):
        folder = tmp_path / f"scheduler-{number}"
        with begun(tmp_path, 2) as there:
            flying = start(tmp_path, *ARGUMENTS, "--scheduler", there.address, "--out", folder.name)
            kill_after(flying, delay, lambda _, pid=there.scheduler.pid: [pid])
        rows.append(ended(folder))
        assert flying.returncode in (0, 1, 2)
        assert run(*ARGUMENTS, "--workers", "2", "--out", folder.name, "--resume") == 0
        assert (folder / "runs.parquet").read_bytes() == whole
    table(f"scheduler killed, rows kept of {RUNS}: {sorted(rows)}")


def kill_after(flying: "subprocess.Popen[str]", delay: float, victims: Callable[[int], list[int]]) -> None:
    try:
        flying.wait(timeout=delay)
    except subprocess.TimeoutExpired:
        for victim in victims(flying.pid):
            os.kill(victim, signal.SIGKILL)
    flying.communicate(timeout=300)
