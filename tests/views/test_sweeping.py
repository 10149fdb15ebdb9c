"""Figures, files and tables of sweeps and sensitivity studies, from made-up rows."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uavsim.scenario import load_scenario
from uavsim.studies.campaign.sensitivity import design, effects_of
from uavsim.studies.campaign.sweep import Sweep, of
from uavsim.studies.campaign.vary import cells, parse
from uavsim.views import sensitivity, sweeping
from uavsim.views.sweeping import tables

BOUND = "requirements=[{key='airspeed.rmse',maximum=0.5},{key='launch.latency',maximum=0.0205}]"


def made_up(*texts: str, runs: int = 12) -> Sweep:
    scenario = load_scenario("catapult", overrides=(BOUND,))
    varies = [parse(scenario, text) for text in texts]
    grid, rng = cells(scenario, varies), np.random.default_rng(1)
    noise = rng.normal(0.0, 0.05, runs)
    rows: list[dict[str, Any]] = [
        {
            "index": number * runs + run,
            "outcome": "cruise" if noise[run] < 0.05 + 0.02 * number else "crashed",
            "expected": "cruise",
            "launch.latency": 0.02 + 0.01 * noise[run],
            "airspeed.rmse": 0.1 * sum(v for v in cell.values() if isinstance(v, int | float)) + noise[run] + 0.2,
        }
        for number, cell in enumerate(grid)
        for run in range(runs)
    ]
    return of(scenario, varies, grid, runs, pd.DataFrame(rows))


GRIDS = (
    ("air_data.total.noise_scale=1,2,4,8",),
    ("accelerometer.bias=-1:1:5",),
    ("detector.kind=px4,inav",),
    ("air_data.total.noise_scale=1,2,4", "air_data.static.noise_scale=1,2,8"),
    ("detector.kind=px4,inav", "accelerometer.bias=0,[0,0,1]"),
    ("detector.kind=px4,inav", "accelerometer.noise_scale=1,2", "launcher.height=1,2"),
    ("launcher.stroke=5",),
)


@pytest.mark.parametrize("texts", GRIDS, ids=lambda texts: texts[-1].partition("=")[0] + str(len(texts)))
def test_a_sweep_is_written_and_printed(
    texts: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = made_up(*texts)
    sweeping.save(found, tmp_path, plots=False)
    tables.print_sweep(found)
    printed = capsys.readouterr().out
    assert max(len(line.rstrip()) for line in printed.splitlines()) <= 80
    summary = json.loads((tmp_path / "sweep.json").read_text())
    assert len(summary["cells"]) == len(found.cells)
    assert summary["vary"] == {one.key: list(one.choices) for one in found.varies}


@pytest.mark.parametrize("texts", [GRIDS[1], GRIDS[4]], ids=["numbers", "names"])
def test_a_sweep_is_drawn(texts: tuple[str, ...]) -> None:
    for name, draw in sweeping.figures(made_up(*texts)):
        assert draw().axes, name


def test_which_figures_there_are() -> None:
    one = [name for name, _ in sweeping.figures(made_up(*GRIDS[0]))]
    assert one == ["along-air_data.total.noise_scale", "limits-air_data.total.noise_scale", "differences"]
    two = [name for name, _ in sweeping.figures(made_up(*GRIDS[3]))]
    pair = "air_data.total.noise_scale-air_data.static.noise_scale"
    assert {f"map-{pair}", f"limits-{pair}", "differences"} < set(two)
    assert [name for name, _ in sweeping.figures(made_up(*GRIDS[6]))] == ["along-launcher.stroke"]


def test_a_part_of_a_sweep_is_drawn_and_printed(tmp_path: Path) -> None:
    whole = made_up(*GRIDS[3])
    part = of(whole.scenario, whole.varies, whole.cells, whole.flights, whole.runs.head(30))
    sweeping.save(part, tmp_path, plots=True)
    tables.print_sweep(part)
    assert (tmp_path / "plots" / "differences.png").stat().st_size > 5000


@pytest.mark.parametrize("runs", [40, 64 * 6])
def test_a_study_is_written_drawn_and_printed(runs: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ("launcher.friction", "accelerometer.mounting_error_deg[1]", "air_data.static_port.tube.length")
    flown = design(names, runs, seed=1)
    rows = pd.DataFrame({"index": range(len(flown.unit)), "outcome": "cruise", "expected": "cruise"})
    rows["launch.latency"] = 0.02 + 1e-3 * flown.points @ np.array([1.0, -2.0, 0.0])
    rows["airspeed.rmse"] = flown.points[:, 0] * flown.points[:, 2]
    rows.loc[5, "launch.latency"] = np.nan
    outputs = ("launch.latency", "airspeed.rmse", "flight.rail_exit_speed", "outcome")
    found = sensitivity.Study(load_scenario("catapult"), flown, effects_of(rows, flown, outputs, 1))
    written = sensitivity.save(found, tmp_path, plots=True)
    assert len(written) == (3 if flown.method == "morris" else 2)
    sensitivity.print_study(found)
    printed = capsys.readouterr().out
    assert max(len(line.rstrip()) for line in printed.splitlines()) <= 80
    assert "flights as expected: no numbers: it is the same in every flight" in printed
    summary = json.loads((tmp_path / "sensitivity.json").read_text())
    assert (summary["method"], summary["flights"]) == (flown.method, len(flown.unit))
    assert summary["outputs"][3]["factors"][0]["swing"] is None
    assert ("Sobol indices of 3 dispersions and the rest need 384 flights" in summary["remark"]) == (runs == 40)
