"""`--json`: standard output is one document, with the numbers of files and tables; an error leaves it empty."""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from sensors import presets
from uavsim import cli
from uavsim.scenario import packaged
from uavsim.views.documents import plain

SHORT = ("--set", "duration=6", "--set", "requirements=[]", "--set", "expect=timeout", "--no-plots")


@dataclass(frozen=True)
class Result:
    status: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """What was printed, if that is one object and nothing else, in standard JSON."""

        def refuse(constant: str) -> None:
            raise AssertionError(f"{constant} is no JSON")

        assert self.out.isascii()
        found = json.loads(self.out, parse_constant=refuse)
        assert isinstance(found, dict)
        return found


Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")

    def call(*arguments: str) -> Result:
        monkeypatch.setattr(sys, "argv", ["uavsim", *arguments])
        capsys.readouterr()
        with pytest.raises(SystemExit) as caught:
            cli.main()
        status = caught.value.code
        assert isinstance(status, int)
        return Result(status, *capsys.readouterr())

    return call


def test_scenarios(run: Run) -> None:
    result = run("scenarios", "--json")
    assert (result.status, result.err) == (0, "")
    assert {one["name"]: one["description"] for one in result.document["scenarios"]} == packaged()


def test_plugins(run: Run) -> None:
    found = run("plugins", "--json").document["plugins"]
    lines = run("plugins").out.splitlines()
    assert [[one["kind"], one["name"], one["source"]] for one in found] == [line.split()[:3] for line in lines]
    assert {"kind", "group", "name", "source", "version", "sha256"} == set(found[0])


def test_sensors(run: Run) -> None:
    result = run("sensors", "--json")
    assert (result.status, result.err) == (0, "")
    assert [one["name"] for one in result.document["presets"]] == presets()
    lines = run("sensors").out.splitlines()
    assert [" ".join(one.values()) for one in result.document["presets"]] == [" ".join(line.split()) for line in lines]


def test_a_part_on_the_bench(run: Run) -> None:
    result = run("sensors", "bmp390", "--hours", "0.05", "--no-plots", "--json", "--out", "bench")
    assert (result.status, result.err) == (0, "")
    found = result.document
    assert found["folder"] == "bench"
    assert found["bench"] == json.loads(Path("bench/bench.json").read_text())
    assert found["preset"]["values"]["range_pa"] == [30000, 125000]
    assert set(found["preset"]["values"]) <= set(found["preset"]["sources"])


def test_a_flight_and_its_replay(run: Run) -> None:
    """The document is the score on disk, and so is the table's."""
    flown = run("fly", *SHORT, "--json", "--out", "flight")
    assert (flown.status, flown.err) == (0, "")
    score = json.loads(Path("flight/score.json").read_text())
    assert flown.document == {"folder": "flight", "scenario": "catapult", "score": score}
    table = run("replay", "flight", "--no-plots").out
    assert f"{score['airspeed']['rmse']:.3f}" in table
    again = run("replay", "flight", "--no-plots", "--json", "--out", "again")
    assert (again.status, again.err) == (0, "")
    assert again.document == {"folder": "again", "scenario": "catapult", "score": score}


def test_another_outcome_is_1_with_the_document(run: Run) -> None:
    result = run("fly", *SHORT, "--set", "expect=cruise", "--json")
    assert (result.status, result.err) == (1, "")
    assert result.document["score"]["expected"] == "cruise"


def test_several_flights(run: Run) -> None:
    """Rows are those of runs.parquet to the last digit; the summary is of these rows."""
    result = run("fly", *SHORT, "--seeds", "1-3", "--json", "--out", "three")
    assert (result.status, result.err) == (0, "")
    found, runs = result.document, pd.read_parquet("three/runs.parquet")
    assert (found["folder"], found["scenario"], found["complete"], found["lost_seeds"]) == (
        "three", "catapult", True, [],
    )  # fmt: skip
    assert [list(row) for row in found["rows"]] == [list(runs.columns)] * 3
    for column in runs.columns:
        assert [row[column] for row in found["rows"]] == [plain(value) for value in runs[column]], column
    summary, latency = found["summary"], runs["launch.latency"]
    assert (summary["flights"], summary["outcomes"]) == (3, {"timeout": 3})
    assert (summary["false_detections"], summary["requirements_unmet"]) == (0, 0)
    quantiles = summary["quantiles"]["launch.latency"]
    assert (quantiles["least"], quantiles["greatest"]) == (latency.min(), latency.max())
    assert quantiles["median"]["value"] == pytest.approx(latency.median(), rel=1e-12)
    assert quantiles["median"]["low"] is None  # three flights bound no median
    kept = json.loads(Path("three/campaign.json").read_text())
    assert summary["airspeed_bound"] == kept["airspeed_bound"]
    row = next(line for line in run("fly", *SHORT, "--seeds", "1-3").out.splitlines() if line.startswith("latency, ms"))
    shown = [*(quantiles[q]["value"] for q in ("p05", "median", "p95")), quantiles["least"]]
    assert row.split()[2:] == [f"{1e3 * value:.1f}" for value in shown]


def test_a_log(run: Run) -> None:
    t = np.arange(3000) / 1000.0
    force = np.where((t > 1.0) & (t < 1.3), 80.0, 1.0)
    pd.DataFrame({"t": t, "fx": force, "fy": 0.0, "fz": -9.8}).to_csv("log.csv", index=False)
    result = run("replay", "log.csv", "--no-plots", "--json", "--out", "log")
    assert (result.status, result.err) == (0, "")
    found = result.document
    assert found["scenario"] == "log.csv"
    assert found["score"] == json.loads(Path("log/score.json").read_text())
    assert 1.0 < found["score"]["launch"]["detected_time"] < 1.05


def test_operating_curves(run: Run) -> None:
    arguments = ("roc", "--detectors", "cusum", "--hours", "0.1", "--trials", "10", "--no-plots", "--json")
    result = run(*arguments, "--cells", "2", "--out", "roc")
    assert result.status == 0
    found, points, cells = result.document, pd.read_csv("roc/roc.csv"), pd.read_csv("roc/cells.csv")
    assert {"folder": "roc", **json.loads(Path("roc/roc.json").read_text())}.items() <= found.items()
    assert [point["level"] for point in found["points"]] == points["level"].tolist()
    assert [list(point) for point in found["points"]] == [list(points.columns)] * len(points)
    assert [cell["detected"] for cell in found["cells"]] == cells["detected"].tolist()
    assert run(*arguments, "--cells", "0").document["cells"] == []


def test_a_remark_is_not_in_the_document(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """What people are told above the tables goes to standard error."""
    from uavsim.studies import reach

    monkeypatch.setattr(reach, "told", lambda *_: "only half of it is within reach")
    result = run(
        "roc", "--detectors", "cusum", "--hours", "0.1", "--trials", "10", "--cells", "0", "--no-plots", "--json"
    )
    assert result.err == "only half of it is within reach\n"
    assert result.document["launches"]


def test_tuned_settings(run: Run) -> None:
    given = ("tune", "catapult", "--detector", "double-threshold", "--false-alarms", "8", "--trials", "10", "--json")
    result = run(*given, "--out", "tuned")
    assert result.status == 0
    assert result.document == {"folder": "tuned", **json.loads(Path("tuned/tune.json").read_text())}


def test_what_a_step_costs(run: Run) -> None:
    result = run("bench", "--set", "duration=6", "--json")
    assert (result.status, result.err) == (0, "")
    found = result.document
    assert found["steps"] == 6000
    assert found["same_state"] is True
    assert 1e-6 < found["bare_s"] < found["in_loop_s"] < 1e-2  # seconds, not microseconds
    assert 0.5 < found["ratio"] < 20.0
    assert {"reference_s", "ratio_over_bare", "onboard_mean_s", "onboard_p99_s", "onboard_steps"} < set(found)


@pytest.mark.parametrize(
    "arguments",
    [
        ("scenarios", "catapult"),
        ("fly", "catapul"),
        ("fly", "--set", "seeed=1"),
        ("fly", "--seeds", "3-1"),
        ("replay", "nowhere"),
        ("replay", "nowhere.csv"),
        ("sensors", "bmp3900"),
        ("sensors", "bmp390", "--hours", "0"),
        ("roc", "--detectors", "cusm"),
        ("tune", "catapul"),
        ("bench", "catapul"),
        ("bench", "wind-tunnel"),
        ("plugins", "--plugin", "nowhere.py"),
    ],
    ids=" ".join,
)
def test_wrong_input_is_2_with_one_line_and_no_document(run: Run, arguments: tuple[str, ...]) -> None:
    result = run(*arguments, "--json")
    assert (result.status, result.out) == (2, "")
    assert result.err.startswith("Error: ")
    assert result.err.count("\n") == 1


def test_every_command_with_a_table_has_it(run: Run) -> None:
    page = (Path(cli.__file__).parents[2] / "docs" / "json.md").read_text(encoding="utf-8")
    for command in ("scenarios", "fly", "replay", "sensors", "roc", "tune", "bench", "plugins"):
        assert "--json" in run(command, "--help").out
        assert f"`{command}`" in page


def test_what_json_has_no_word_for_is_null() -> None:
    given = {
        "a": (1.5, float("nan"), np.float64("inf")),
        "b": np.arange(2),
        "c": np.bool_(True),
        "d": Path("x"),
        3: None,
    }
    assert plain(given) == {"a": [1.5, None, None], "b": [0, 1], "c": True, "d": "x", "3": None}
