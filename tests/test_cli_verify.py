"""`uavsim verify` from outside: what it prints, writes and refuses."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree.ElementTree import parse

import pandas as pd
import pytest

SHORT = (
    *("--set", "duration=2.5", "--set", "launcher.wait_min=1.6", "--set", "launcher.wait_max=1.7"),
    *("--set", "expect=timeout", "--no-plots", "--workers", "2"),
)
LATE = '{key="launch.latency",statistic="p50",maximum=0.1}'
EARLY = '{key="launch.latency",statistic="p50",maximum=0.001}'


def verify(*arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "uavsim.cli", "verify", *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("requirements", "verdicts", "status"),
    [
        pytest.param(f"[{LATE}]", ["met"], 0, id="met", marks=pytest.mark.slow),
        pytest.param(f"[{EARLY}, {LATE}]", ["not met", "met"], 1, id="not met"),
    ],
)
def test_it_says_what_it_expects_and_what_it_found(
    tmp_path: Path, requirements: str, verdicts: list[str], status: int
) -> None:
    out = tmp_path / "new" / "verify"
    asked = ("catapult", "--runs", "16", "--set", f"requirements={requirements}", *SHORT, "--out", str(out))
    run = verify(*asked)
    assert run.returncode == status, run.stderr
    assert run.stdout.index("Chance of a verdict") < run.stdout.index("Requirement ")
    assert max(map(len, run.stdout.splitlines())) <= max(80, len(f"written to {out}"))
    document = json.loads((out / "verify.json").read_text())
    assert [one["verdict"] for one in document["requirements"]] == verdicts
    assert document["runs"] == len(pd.read_parquet(out / "runs.parquet"))
    assert len(parse(out / "junit.xml").findall(".//testcase")) == len(verdicts)
    again = verify(*asked, "--resume", "--json")
    assert again.returncode == status
    found = json.loads(again.stdout)
    assert {key: found[key] for key in document} == document
    assert "Chance of a verdict" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("catapult", "--sampling", "sobol"), "must be random"),
        (("catapult", "--runs", "0"), "--runs"),
        (("catapult", "--confidence", "0.5"), "must be above 0.5 and below 1"),
        (("catapult", "--confidence", "nan"), "is not a finite number"),
        (("catapult", "--requirements", "smal-uav"), "did you mean 'small-uav'"),
        (("catapult", "--set", "requirements=[]"), "has no [[requirements]] to verify"),
        (("catapult", "--set", 'requirements=[{key="launch.latency",statistic="p95"}]'), "needs minimum or maximum"),
    ],
)
def test_wrong_input_is_one_line(tmp_path: Path, arguments: tuple[str, ...], named: str) -> None:
    run = verify(*arguments, "--out", str(tmp_path / "none"))
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("Error: ")
    assert named in run.stderr
    assert not (tmp_path / "none").exists()
