"""Rare events against exact probabilities, by 200 repetitions; run with -s for the table of `docs/rare.md`.

Authorities: the finite Markov chains of `uavsim.studies.exact`, Φ(-β), and the parabola of Schuëller & Stix. With 200
repetitions a coverage of 95 % is seen as 90 % or less with a probability of 0.3 %, and a mean off by three standard
errors comes with 0.3 %.
"""

from collections.abc import Callable
from statistics import median

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr

from uavsim.onboard.launch import DetectorSettings
from uavsim.studies import exact
from uavsim.studies.campaign.rare import Estimate, Inputs, Watch, estimate

pytestmark = pytest.mark.slow

N, SIGMA = 1000, 5.0
CERTIFY = pytest.mark.certify  # one of each kind is enough for `make validate`
NESTED = DetectorSettings(kind="multi-level-window", threshold=45.0, window=0.018, levels=4, ratio=0.8)
SLIDING = DetectorSettings(kind="sliding-window", threshold=45.0, window=0.010, ratio=0.8)
HOLD = DetectorSettings(kind="single-threshold", threshold=45.0, window=0.010)
WIDE = DetectorSettings(kind="threshold-window", threshold=45.0, window=0.050, ratio=0.6)


def truth(settings: DetectorSettings, mean: float) -> float:
    """Exact probability of an alarm in the sequence."""
    curve, n = np.full(N, mean), round(1000 * settings.window)
    if settings is NESTED:
        found = exact.multi_level_window(curve, SIGMA, threshold=45.0, samples=n, levels=4, ratio=0.8)
    elif settings is SLIDING:
        found = exact.sliding_window(curve, SIGMA, threshold=45.0, samples=n, ratio=0.8)
    elif settings is HOLD:
        found = exact.hold(curve, SIGMA, threshold=45.0, samples=n)
    else:
        found = exact.threshold_window(curve, SIGMA, threshold=45.0, samples=n, ratio=0.6)
    return found.probability


def judged(name: str, found: list[Estimate], exactly: float) -> tuple[float, float, float]:
    """Return distance of the mean in standard errors, observed coefficient of variation, and coverage; print them."""
    p = np.array([one.probability for one in found])
    covered = np.mean([one.low <= exactly <= one.high for one in found])
    variation, error = p.std(ddof=1) / exactly, p.std(ddof=1) / np.sqrt(len(p))
    away = (p.mean() - exactly) / error
    told = median(one.variation for one in found)
    work = max(one.work for one in found)
    print(  # noqa: T201 (what docs/rare.md records)
        f"\n{name:28s} exact {exactly:.3e} mean/exact {p.mean() / exactly:.3f} ± {error / exactly:.3f} "
        f"variation {variation:.3f} told {told:.3f} covered {covered:.3f} work ≤ {work:.0f} n {len(p)}",
        flush=True,
    )
    assert work <= 6000.0
    return float(away), float(variation), float(covered)


@pytest.mark.parametrize(
    ("name", "settings", "mean"),
    [
        pytest.param("nested", NESTED, 40.8522, marks=CERTIFY),
        pytest.param("sliding", SLIDING, 36.7247, marks=CERTIFY),
        ("hold", HOLD, 39.3143),
    ],
)
def test_one_in_a_million_from_six_thousand_flights(name: str, settings: DetectorSettings, mean: float) -> None:
    watch = Watch(settings, np.full(N, mean), SIGMA, push=70.0)
    away, variation, covered = judged(f"{name}, 1e-6", repeat(watch, 200), truth(settings, mean))
    assert abs(away) < 3.0
    assert variation < 0.30
    assert covered >= 0.90


@pytest.mark.parametrize("mean", [*(pytest.param(m, marks=CERTIFY) for m in (43.0037, 42.2048, 41.4960)), 40.2568])
def test_the_nested_windows_from_1e_3_to_1e_7(mean: float) -> None:
    watch = Watch(NESTED, np.full(N, mean), SIGMA, push=70.0)
    exactly = truth(NESTED, mean)
    away, variation, covered = judged(f"nested, {exactly:.0e}", repeat(watch, 60), exactly)
    assert abs(away) < 3.5
    assert variation < 0.50
    assert covered >= 0.85


@CERTIFY
def test_a_window_of_fifty_samples_is_at_the_edge() -> None:
    watch = Watch(WIDE, np.full(N, 41.2961), SIGMA, push=70.0)
    away, variation, _ = judged("50 samples, 1e-6", repeat(watch, 200), truth(WIDE, 41.2961))
    assert abs(away) < 3.5
    assert variation < 1.0


def repeat(problem: Watch | Inputs, times: int) -> list[Estimate]:
    return [estimate(problem, seed=seed) for seed in range(times)]


def linear(beta: float, d: int) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    return lambda u: beta - u.sum(axis=1) / np.sqrt(d)


BETA = 4.753424  # Φ(-β) = 1e-6


@pytest.mark.parametrize("d", [pytest.param(2, marks=CERTIFY), 10, pytest.param(20, marks=CERTIFY)])
def test_a_linear_limit_of_few_inputs(d: int) -> None:
    away, variation, covered = judged(
        f"linear, {d} inputs", repeat(Inputs(linear(BETA, d), d), 200), float(ndtr(-BETA))
    )
    assert abs(away) < 3.0
    assert variation < 0.30
    assert covered >= 0.90


def test_two_opposite_regions() -> None:
    problem = Inputs(lambda u: BETA - np.abs(u.sum(axis=1)) / np.sqrt(10.0), 10)
    away, variation, covered = judged("two sides, 10 inputs", repeat(problem, 200), 2.0 * float(ndtr(-BETA)))
    assert abs(away) < 3.0
    assert variation < 0.30
    assert covered >= 0.90


@CERTIFY
def test_a_linear_limit_of_many_inputs_by_subset_simulation_alone() -> None:
    problem = Inputs(linear(BETA, 200), 200)
    _, variation, covered = judged("linear, 200 inputs", repeat(problem, 200), float(ndtr(-BETA)))
    assert variation < 0.60
    assert covered >= 0.90
