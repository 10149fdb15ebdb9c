"""The flying wing x8 leaves its bungee and reaches cruise however it is built and set up.

Authority: the contract's outcomes; the promises of airspeed are the scenario's requirements.
"""

import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

RUNS = 20
# one standard deviation: by hand, what a foam airframe that is built and weighed in the field has
SPREAD = """dispersions=[
{key="aircraft.mass_factor",distribution="normal",sd=0.03},
{key="aircraft.lift_factor",distribution="normal",sd=0.05,relative=true},
{key="aircraft.drag_factor",distribution="normal",sd=0.1,relative=true},
{key="aircraft.pitch_factor",distribution="normal",sd=0.05,relative=true},
{key="launcher.elevation_deg",distribution="uniform",low=9,high=16},
{key="launcher.bungee.stiffness",distribution="normal",sd=0.05,relative=true}]""".replace("\n", "")


@pytest.mark.slow
def test_twenty_of_twenty_reach_cruise(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "uavsim.cli", "campaign", "x8-bungee", "--runs", str(RUNS), "--seed", "8101"]
    subprocess.run([*command, "--set", SPREAD, "--no-plots", "--out", str(tmp_path / "many")], check=True)
    rows = pd.read_parquet(tmp_path / "many" / "runs.parquet")
    assert list(rows["outcome"]) == ["cruise"] * RUNS
    assert rows["airspeed.rmse"].max() < 0.3
    assert (rows["airspeed.false_flags"] == 0).all()
    assert (rows["airspeed.hazard"] == 0).all()
