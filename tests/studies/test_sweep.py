"""A sweep of rows whose answers are known, and one that is flown."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t as student

from uavsim.scenario import load_scenario
from uavsim.studies.campaign.sweep import Sweep, of, paired, sweep
from uavsim.studies.campaign.vary import _check_dispersed, cells, parse
from uavsim.studies.intervals import share_interval

SHORT = ("duration=6", "launcher.wait_min=2.5", "launcher.wait_max=2.6", "expect=timeout")
BOUND = "requirements=[{key='airspeed.rmse',maximum=0.5}]"


def made_up(*texts: str, runs: int = 100, overrides: tuple[str, ...] = (BOUND,), seed: int = 1) -> Sweep:
    """RMSE = 0.1 a + 0.1 b + e with the same e in all cells, half of them above 0; latency 20 ms, one of 100 misses."""
    scenario = load_scenario("catapult", overrides=overrides)
    varies = [parse(scenario, text) for text in texts]
    grid, rows = cells(scenario, varies), []
    noise = np.random.default_rng(seed).normal(0.0, 0.02, runs)
    for number, cell in enumerate(grid):
        numbers = [value for value in cell.values() if isinstance(value, int | float)]
        for run in range(runs):
            missed = run == 7
            rows.append(
                {
                    "index": number * runs + run,
                    "run": run,
                    "outcome": "missed_launch" if missed else "cruise",
                    "expected": "cruise",
                    "launch.latency": np.nan if missed else 0.02,
                    "airspeed.rmse": 0.1 * sum(numbers) + noise[run],
                }
            )
    return of(scenario, varies, grid, runs, pd.DataFrame(rows).sample(frac=1.0, random_state=1))


def test_the_table_of_cells() -> None:
    found = made_up("air_data.total.noise_scale=1,2,4")
    row = found.table.iloc[2]
    assert (row["cell"], row["vary.air_data.total.noise_scale"], row["flights"], row["expected"]) == (2, 4.0, 100, 99)
    assert (row["share_low"], row["share_high"]) == share_interval(99, 100)
    assert (row["launch.latency.missing"], row["launch.latency.median"]) == (1, 0.02)
    rmse = found.values("airspeed.rmse")[2]
    assert row["airspeed.rmse.p95"] == pytest.approx(np.quantile(rmse, 0.95), rel=1e-12)
    assert row["airspeed.rmse.p95_low"] < row["airspeed.rmse.p95"] < row["airspeed.rmse.p95_high"]
    assert found.quantities == ("launch.latency", "airspeed.rmse")
    assert found.alike("launch.latency")
    assert not found.alike("airspeed.rmse")


def test_the_reference_is_the_scenario_as_it_is_if_it_is_there() -> None:
    assert (made_up("air_data.total.noise_scale=4,1,2").reference, made_up("launcher.stroke=4,5").reference) == (1, 0)
    assert made_up("air_data.total.noise_scale=4,1,2").nominal
    assert not made_up("launcher.stroke=4,5").nominal


def test_common_draws_fall_out_of_differences() -> None:
    """e is the same in both cells: the difference is 0.3 to rounding, and so is the interval."""
    found = made_up("air_data.total.noise_scale=1,4").differences.set_index("quantity").loc["airspeed.rmse"]
    assert found["difference"] == pytest.approx(0.3, abs=1e-12)
    assert found["high"] - found["low"] < 1e-12
    assert found["pairs"] == 100


def test_paired_means_by_student() -> None:
    """The authority is scipy.stats.ttest_rel."""
    from scipy.stats import ttest_rel

    rng = np.random.default_rng(3)
    shared = rng.normal(size=40)
    one, other = shared + rng.normal(0.5, 0.1, 40), shared + rng.normal(0.0, 0.1, 40)
    one[3] = np.nan
    found = paired(one, other)
    both = np.isfinite(one)
    theirs = ttest_rel(one[both], other[both]).confidence_interval(0.95)
    assert (found["low"], found["high"]) == pytest.approx((theirs.low, theirs.high), rel=1e-9)
    half = student.ppf(0.975, 38) * np.sqrt((one[both].var(ddof=1) + other[both].var(ddof=1)) / 39)
    assert found["narrower"] == pytest.approx(2.0 * half / (found["high"] - found["low"]), rel=1e-9)
    assert found["narrower"] > 3.0


def test_paired_shares_by_bonett_and_price() -> None:
    """10 of 100 pairs only in one, 4 only in the other: 0.0588 ± 1.96 · 0.0377 by hand."""
    one, other = np.ones(100), np.ones(100)
    other[:10], one[10:14] = 0.0, 0.0
    found = paired(one, other, share=True)
    more, less = 11 / 102, 5 / 102
    half = 1.959964 * np.sqrt((more + less - (more - less) ** 2) / 102)
    assert found["difference"] == pytest.approx(0.06)
    assert (found["low"], found["high"]) == pytest.approx((more - less - half, more - less + half), abs=1e-6)


@pytest.mark.parametrize("p", [0.02, 0.5, 0.97])
def test_paired_shares_hold_the_difference(p: float) -> None:
    """n = 2000 repetitions of 60 pairs, 0.94 or more wanted; 0.925 would pass with a chance of 0.5 %."""
    rng, inside = np.random.default_rng(7), 0
    for _ in range(2000):
        u = rng.random(60)
        found = paired((u < p).astype(float), (u < 0.8 * p).astype(float), share=True)
        inside += found["low"] <= 0.2 * p <= found["high"]
    assert inside / 2000 >= 0.94


def test_limits_along_one_key() -> None:
    """0.1 a + e ≤ 0.5 in 95 of 100 flights: a is 5 less ten times the 0.95-quantile of e, between cells 4 and 6."""
    found = made_up("air_data.total.noise_scale=1,2,4,6")
    limits = found.limits.set_index("requirement")
    rmse = limits.loc["airspeed.rmse ≤ 0.5"]
    e = found.values("airspeed.rmse")[0] - 0.1
    assert (rmse["state"], rmse["direction"], rmse["low"], rmse["high"]) == ("breaks", "up", 4.0, 6.0)
    assert rmse["quantile"] == pytest.approx(5.0 - 10.0 * np.quantile(e, 0.95), abs=1e-9)
    assert 4.0 < rmse["estimate"] < 6.0
    outcome = limits.loc["outcome cruise"]
    assert outcome["state"] == "holds"
    assert np.isnan(outcome["estimate"])


def test_limits_over_two_keys_are_line_by_line() -> None:
    found = made_up("air_data.total.noise_scale=1,2,4,6", "air_data.static.noise_scale=3,1")
    limits = found.limits
    rmse = limits[(limits["requirement"] == "airspeed.rmse ≤ 0.5") & (limits["key"] == "air_data.total.noise_scale")]
    assert dict(zip(rmse["vary.air_data.static.noise_scale"], rmse["high"], strict=True)) == {3.0: 2.0, 1.0: 4.0}
    assert set(limits["key"]) == {"air_data.total.noise_scale", "air_data.static.noise_scale"}


def test_names_have_no_limit() -> None:
    assert made_up("detector.kind=px4,inav").limits.empty


def test_flights_that_were_not_flown_are_missing_and_not_missed() -> None:
    whole = made_up("air_data.total.noise_scale=1,2")
    part = of(whole.scenario, whole.varies, whole.cells, 100, whole.runs[whole.runs["index"] < 130])
    assert part.table["flights"].tolist() == [100, 30]
    assert part.differences["pairs"].tolist() == [30] * 3 or part.differences["pairs"].max() == 30
    none = of(whole.scenario, whole.varies, whole.cells, 100, whole.runs[whole.runs["index"] < 90])
    assert none.table["cell"].tolist() == [0]
    assert none.limits.empty


@dataclass
class Drawn:
    key: str
    distribution: str
    relative: bool = False
    mean: float | None = None


@pytest.mark.parametrize(
    ("dispersion", "refused"),
    [
        (Drawn("launcher.friction", "uniform"), True),
        (Drawn("launcher.friction", "normal", mean=0.01), True),
        (Drawn("launcher.friction", "normal"), False),
        (Drawn("launcher.friction", "uniform", relative=True), False),
        (Drawn("launcher.stroke", "uniform"), False),
        (Drawn("launcher.friction[1]", "uniform"), True),
    ],
)
def test_a_key_that_a_dispersion_draws_over_is_refused(dispersion: Drawn, refused: bool) -> None:
    scenario: Any = type("S", (), {"dispersions": (dispersion,), "name": "s"})
    if refused:
        with pytest.raises(ValueError, match="is drawn anew for each flight"):
            _check_dispersed(scenario, "launcher.friction")
    else:
        _check_dispersed(scenario, "launcher.friction")


def test_it_flies(tmp_path: Path) -> None:
    """Noise of the air data leaves the launch as it is, flight by flight: to the last bit."""
    scenario = load_scenario("catapult", overrides=SHORT)
    found = sweep(scenario, {"air_data.total.noise_scale": "1x,8x"}, runs=2, workers=0, out=tmp_path / "out")
    assert found.runs["run"].tolist() == [0, 1, 0, 1]
    assert found.runs["vary.air_data.total.noise_scale"].tolist() == [1.0, 1.0, 8.0, 8.0]
    assert found.alike("launch.latency")
    assert found.runs["launch.latency"].nunique() == 2
    assert (found.differences.set_index("quantity").loc["airspeed.rmse"]["difference"]) > 0.05
    assert (tmp_path / "out" / "runs.parquet").exists()
    assert pd.read_parquet(tmp_path / "out" / "runs.parquet").shape[0] == 4


def test_python_refuses_what_the_command_does() -> None:
    with pytest.raises(ValueError, match="runs = 0: must be at least 1"):
        sweep("catapult", {"launcher.stroke": [5, 6]}, runs=0)
    with pytest.raises(ValueError, match="nothing is varied"):
        sweep("catapult", {}, runs=1)
