"""JSBSim's own c172x, put on the rail as docs/own-aircraft.md says, leaves it and reaches cruise.

Authority: the contract's outcomes, and constant acceleration: v² = 2 a s with a = 6 g - g sin θ less drag and friction.
"""

import math
import subprocess
import sys
from pathlib import Path

import pytest

import uavsim
from uavsim.scenario import load_scenario

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "docs" / "examples" / "own-aircraft" / "own_aircraft.py"
GRAVITY = 9.80665


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("own") / "my"
    subprocess.run([sys.executable, str(SCRIPT), str(folder)], check=True, capture_output=True)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_the_c172x_reaches_cruise(place: Path, seed: int) -> None:
    model = f"aircraft.model={place / 'c172x'}"
    flight = uavsim.fly(load_scenario(str(place / "c172x.toml"), overrides=[model]), seed=seed)
    score = flight.score
    assert score["outcome"] == "cruise"
    assert score["launch"]["false_detections"] == 0
    assert score["flight"]["wing_out_time"] is None
    most = math.sqrt(2.0 * 18.0 * 6.12 * GRAVITY)  # 2 % is the spread of the force
    assert 0.9 * most < score["flight"]["rail_exit_speed"] < most


@pytest.mark.slow
def test_the_c172x_is_linearised(place: Path) -> None:
    command = [sys.executable, "-m", "uavsim.cli", "linearise", str(place / "c172x"), "--airspeeds", "35,45"]
    done = subprocess.run([*command, "--out", str(place / "linear")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "pitched by fcs/elevator-pos-rad" in done.stdout
    assert sorted(file.name for file in (place / "linear").iterdir()) == [
        "linearise.csv", "linearise.json", "linearise.png", "modes.csv",
    ]  # fmt: skip


@pytest.mark.slow
def test_as_it_comes_from_jsbsim_it_is_refused_in_one_line(place: Path) -> None:
    import jsbsim

    stock = Path(jsbsim.get_default_root_dir()) / "aircraft" / "c172x"
    command = [sys.executable, "-m", "uavsim.cli", "linearise", str(stock), "--out", str(place / "none")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert not (place / "none").exists()
