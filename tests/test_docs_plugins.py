"""The page on parts of one's own: what it shows runs, and the example in C flies."""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import uavsim
from uavsim import plugins
from uavsim.onboard.launch import DetectorSettings, build
from uavsim.plugins import REGISTRIES
from uavsim.studies.detections import BatchDetector
from uavsim.testing import check_detector, check_estimator, check_plant
from uavsim.testing.hostile import readings

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
EXAMPLE = ROOT / "docs" / "examples" / "launch_rule_in_c"
SHORT = ("duration=6", "launcher.wait_min=2.5", "launcher.wait_max=2.6")


@pytest.fixture(autouse=True)
def _forgotten() -> Iterator[None]:
    before = {what: list(registry) for what, registry in REGISTRIES.items()}
    yield
    for what, registry in REGISTRIES.items():
        for name in [name for name in registry if name not in before[what]]:
            registry.remove(name)


def block(word: str) -> dict[str, Any]:
    """Run the block that holds a word; return its names."""
    (code,) = [code for code in BLOCKS if word in code]
    names: dict[str, Any] = {"__name__": f"page_{abs(hash(word))}"}
    exec(code, names)  # the page is ours
    return names


def test_the_detector_in_ten_lines_flies() -> None:
    mine = block('@detector("mine")')["Mine"]
    flight = uavsim.fly("catapult", overrides=SHORT, detector=mine)
    assert flight.score["launch"]["detector"] == "mine"
    assert 0.0 < flight.score["launch"]["latency"] < 0.030
    check_detector(mine)


def test_the_detector_with_settings_passes_and_its_loop_decides_as_it_steps() -> None:
    held = block('@detector("held"')["Held"]
    check_detector(held)
    held.loop = block("def held_loop")["loop"]
    force = np.random.default_rng(1).normal(40.0, 20.0, (20_000, 3))
    force[::7, 0] = np.nan
    force[:, 0] = np.where(np.arange(20_000) % 400 < 100, 60.0, force[:, 0])
    chosen, found = DetectorSettings(kind="held", options={"hold": 0.004}), []
    detector = build(chosen, 1000.0)
    for k, (fx, fy, fz) in enumerate(force.tolist()):
        if detector.step(k / 1000.0, fx, fy, fz):
            found.append(k)
            detector.reset()
    assert len(found) > 20
    assert BatchDetector(chosen, 1000.0).alarms(force).tolist() == found


def test_the_estimator_in_fifteen_lines_flies_and_passes() -> None:
    mean = block("mean-of-five")["MeanOfFive"]
    check_estimator(mean)
    flight = uavsim.fly("catapult", seed=3, estimator=mean)
    assert flight.score["outcome"] == "cruise"
    assert flight.score["airspeed"]["cruise"]["rmse"] < 1.0


def test_the_plant_flies_and_passes() -> None:
    tower = block("drop-tower")["DropTower"]
    check_plant(tower)
    flight = uavsim.fly("catapult", overrides=(*SHORT, "expect=completed"), plant=tower)
    assert flight.score["outcome"] == "completed"
    assert flight.truth["fz"].min() == pytest.approx(-20.0 * 9.80665)


def test_every_block_is_looked_at() -> None:
    words = (
        '@detector("mine")',
        "from mine import",
        '@detector("held"',
        "mean-of-five",
        "drop-tower",
        "from held import",
    )
    words += ("def held_loop", "BatchDetector(")
    assert [sum(word in code for word in words) for code in BLOCKS] == [1] * len(BLOCKS)


# -- in C ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def in_c(tmp_path: Path) -> Path:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    pytest.importorskip("cffi")
    for name in ("held.c", "held.py"):
        shutil.copy(EXAMPLE / name, tmp_path)
    flags = "-O2 -ffp-contract=off -shared -fPIC -o libheld.so held.c"
    assert f"cc {flags}" in PAGE
    subprocess.run([compiler, "-Wall", "-Werror", *flags.split()], check=True, cwd=tmp_path)
    return tmp_path / "held.py"


def test_a_rule_in_c_flies_decision_for_decision_as_in_python(in_c: Path) -> None:
    plugins.load([str(in_c)])
    flights = [uavsim.fly("catapult", overrides=SHORT, detector=name) for name in ("held-in-c", "held-in-python")]
    assert flights[0].score["launch"]["detector"] == "held-in-c"
    assert flights[0].score["launch"]["latency"] is not None
    assert flights[0].events == flights[1].events
    assert flights[0].detector.equals(flights[1].detector)
    assert len(flights[0].score["plugins"][0]["sha256"]) == 64
    one, other = (build(DetectorSettings(kind=name), 1000.0) for name in ("held-in-c", "held-in-python"))
    found = 0
    for reading in readings(5, 40_000):
        if len(reading) != 4:
            continue
        seen = one.step(*reading)
        assert seen == other.step(*reading)
        if seen:
            found += 1
            one.reset()
            other.reset()
    assert found > 3


def test_a_rule_in_c_passes(in_c: Path) -> None:
    plugins.load([str(in_c)])
    check_detector(lambda rate: build(DetectorSettings(kind="held-in-c"), rate))


def test_a_rule_in_c_without_its_library_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("cffi")
    shutil.copy(EXAMPLE / "held.py", tmp_path)
    command = [sys.executable, "-m", "uavsim.cli", "fly", "--plugin", "held.py", "--set", "detector.kind=held-in-c"]
    refused = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1
    assert "detector 'held-in-c' cannot be made: OSError: " in refused.stderr
