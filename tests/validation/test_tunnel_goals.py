"""What is promised of the wind tunnel, over drawn noise.

Each claim is about a mean over seeds, tested by Student's t at 99 % one-sided (or 99 % two-sided for a band) on 20
independent runs. The power is in each docstring: the smallest shortfall that would be caught nine times in ten, from
the spread of single runs: t(0.99, 19) + t(0.9, 19) = 3.87 standard errors.
"""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import t as student

from uavsim.cosim import fly
from uavsim.flight import Flight
from uavsim.scenario import load_scenario
from uavsim.studies.paper import tunnel

pytestmark = pytest.mark.slow

RUNS = 20
SEEDS = range(1, 1 + RUNS)
Array = NDArray[np.float64]


def least(values: Array) -> float:
    """Lower bound of the mean, one-sided 99 %."""
    return float(values.mean() - student.ppf(0.99, values.size - 1) * values.std(ddof=1) / np.sqrt(values.size))


def band(values: Array) -> tuple[float, float]:
    """Band of the mean, two-sided 99 %."""
    half = student.ppf(0.995, values.size - 1) * values.std(ddof=1) / np.sqrt(values.size)
    return float(values.mean() - half), float(values.mean() + half)


def figure(flight: Flight, key: str) -> float:
    value: Any = flight.score
    for part in key.split("."):
        value = value[part]
    return float(value)


@pytest.fixture(scope="module")
def paper() -> list[Flight]:
    return [tunnel.run("paper", seed) for seed in SEEDS]


@pytest.fixture(scope="module")
def best() -> list[Flight]:
    return [fly("wind-tunnel", seed=seed) for seed in SEEDS]


def test_the_packaged_scenario_flies_the_best_filter(best: list[Flight]) -> None:
    assert all(f.scenario["estimator"]["kind"] == tunnel.BEST for f in best)
    assert all(f.score["outcome"] == "completed" for f in best)


@pytest.mark.parametrize(("channel", "printed"), [("total", 18.26), ("static", 22.08)])
def test_the_papers_gain_reproduces_table_7(paper: list[Flight], channel: str, printed: float) -> None:
    """Within 0.5 points of what is printed; single runs spread by 0.17, so 0.15 points beyond are caught."""
    low, high = band(np.array([figure(f, f"pressure.{channel}.reduction_percent") for f in paper]))
    assert printed - 0.5 < low
    assert high < printed + 0.5


def test_the_best_causal_filter_takes_at_least_68_percent(best: list[Flight]) -> None:
    """60 % is the aim, 68 % the stretch; single runs spread by 3.2, so 2.8 points below either are caught."""
    reductions = np.array([figure(f, "airspeed.reduction_percent") for f in best])
    assert least(reductions) > 68.0
    assert reductions.min() > 60.0


def test_on_fast_plateaus_it_takes_at_least_85_percent(best: list[Flight]) -> None:
    """Levels of 10 m/s and more, from five time constants after their step; per run, all levels pooled.

    Single runs spread by 1.5 points, so 1.3 points below are caught.
    """
    reductions = []
    for f in best:
        found = tunnel.plateaus({tunnel.BEST: [f]})
        fast = [p for p in found if p.speed >= tunnel.FAST]
        raw = np.sqrt(np.mean([p.raw**2 for p in fast]))
        filtered = np.sqrt(np.mean([p.filtered[tunnel.BEST] ** 2 for p in fast]))
        reductions.append(100.0 * (1.0 - filtered / raw))
    assert least(np.array(reductions)) > 85.0


def test_no_filter_does_better_than_who_knows_the_steps(best: list[Flight]) -> None:
    """On fast plateaus, where the bound has a meaning: pooled over all runs."""
    found = tunnel.plateaus({tunnel.BEST: best})
    filtered = np.sqrt(np.mean([p.filtered[tunnel.BEST] ** 2 for p in found if p.speed >= tunnel.FAST]))
    assert filtered > tunnel.allowed(best[0])[1]


def steady_bias(flight: Flight) -> float:
    """Mean error from 5 s after the end of the ramp on, % of the airspeed."""
    t = flight.estimate["t"].to_numpy()
    true = np.interp(t, flight.truth["t"].to_numpy(), flight.truth["airspeed"].to_numpy())
    late = t > flight.score["launch"]["release_time"] + flight.scenario["plant"]["wind_tunnel"]["ramp"] + 5.0
    return float(100.0 * np.mean(flight.estimate["airspeed"].to_numpy()[late] / true[late] - 1.0))


def test_at_mach_06_the_bias_is_below_three_thousandths() -> None:
    """Drawn units: the mean's 99 % band, and each run but two of 20.

    A unit's thermometer alone, 0.5 K, is off by 0.08 %: beyond 0.3 % lie less than 1 in 1000, of 20 more than two less
    than 1 in 10 000 times.
    """
    biases = np.array([steady_bias(fly("mach06", seed=seed)) for seed in SEEDS])
    low, high = band(biases)
    assert low > -0.3
    assert high < 0.3
    assert np.sum(np.abs(biases) > 0.3) <= 2


def test_at_mach_06_the_incompressible_relation_reads_4_6_percent_high() -> None:
    """4.56 % and what the units are off by: 99 % band of six runs about it, no wider than 0.3 %."""
    overrides = ["estimator.model=bernoulli"]
    biases = np.array(
        [steady_bias(fly(load_scenario("mach06", overrides=overrides, seed=seed))) for seed in range(1, 7)]
    )
    low, high = band(biases)
    assert low < 4.56 < high
    assert high - low < 0.6
