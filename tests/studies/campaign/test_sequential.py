"""Sequential tests against a walk of their own: error rates, least and mean numbers of flights, exactly computed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.stats import norm

from uavsim.studies.campaign import sequential
from uavsim.studies.campaign.sequential import Exposure, Flights, few_times, many_times


def walked(few: np.ndarray, many: np.ndarray, q: float, flights: int) -> dict[str, float]:
    """Both boundaries by their definition, flight by flight, with dictionaries: nothing shared with the code tested."""
    alive, few_sum, many_sum, mean = {0: 1.0}, 0.0, 0.0, 0.0
    for n in range(1, flights + 1):
        mean += sum(alive.values())
        after: dict[int, float] = {}
        for count, p in alive.items():
            after[count] = after.get(count, 0.0) + p * (1.0 - q)
            after[count + 1] = after.get(count + 1, 0.0) + p * q
        alive = {}
        for count, p in after.items():
            if any(n <= m and count >= k for k, m in enumerate(many, start=1)):
                many_sum += p
            elif any(n >= m and count <= k for k, m in enumerate(few)):
                few_sum += p
            elif p > 1e-15:
                alive[count] = p
    return {"few": few_sum, "many": many_sum, "mean": mean}


@pytest.mark.parametrize(("q", "level", "flights"), [(0.005, 0.05, 900), (0.05, 0.05, 250), (0.3, 0.01, 60)])
def test_the_error_is_kept_exactly(q: float, level: float, flights: int) -> None:
    """Each test by itself, at its bound; the other one is taken away so that nothing ends it early."""
    none = np.zeros(0)
    few, many = few_times(Flights(q), level, flights), many_times(Flights(q), level, flights)
    assert few.size
    found = walked(few, none, q, flights)["few"], walked(none, many[:12], q, min(flights, int(many[10])))["many"]
    assert all(0.0 < error <= level for error in found)


def test_what_is_spent_is_what_was_planned() -> None:
    """0.8 of the error at the first look but for what whole flights leave: 0.995⁶⁴³ = 0.0398 ≤ 0.04 < 0.995⁶⁴²."""
    few = few_times(Flights(0.005), 0.05, 4096.0)
    assert few[0] == 643
    assert 0.995**643 <= 0.04 < 0.995**642
    assert walked(few, np.zeros(0), 0.005, 643)["few"] == pytest.approx(0.995**643, rel=1e-12)


@pytest.mark.parametrize(
    ("bound", "least"), [(0.05, 63), (0.01, 321), (0.005, 643)], ids=["p95", "p99", "P at least 0.995"]
)
def test_least_numbers_of_flights(bound: float, least: int) -> None:
    assert few_times(Flights(bound), 0.05, 1024.0)[0] == least


def test_what_the_requirement_of_cruise_takes() -> None:
    """P(cruise) ≥ 0.995 at 95 %: Wald's mean for 0.999 is ln 20 / (0.001 ln 0.2 + 0.999 ln(0.999/0.995)) = 1248."""
    few, many = few_times(Flights(0.005), 0.05, 4096.0), many_times(Flights(0.005), 0.05, 4096.0)
    clean = sequential.chance(few, many, np.array([1.0, 0.0]), 4000)
    assert (clean.few, clean.flights, clean.median) == (1.0, 643.0, 643)
    good = sequential.chance(few, many, np.array([0.999, 0.001]), 4000)
    assert good.few == pytest.approx(0.976, abs=0.002)
    assert good.median == 643
    assert good.flights == pytest.approx(1320, abs=25)
    within = {n: sequential.chance(few, many, np.array([0.999, 0.001]), n).few for n in (1549, 3049)}
    assert within[1549] == pytest.approx(0.69, abs=0.01)
    assert within[3049] >= 0.93
    wald = np.log(20.0) / (0.001 * np.log(0.2) + 0.999 * np.log(0.999 / 0.995))
    assert good.flights < 1.1 * wald


def test_a_chance_is_what_a_walk_of_another_kind_gives() -> None:
    few, many = few_times(Flights(0.05), 0.05, 256.0), many_times(Flights(0.05), 0.05, 256.0)
    found = sequential.chance(few, many, np.array([0.97, 0.03]), 200)
    other = walked(few[:20], many[:25], 0.03, 200)
    assert (found.few, found.many, found.flights) == pytest.approx(
        (other["few"], other["many"], other["mean"]), rel=1e-9
    )


@pytest.mark.parametrize("walk", [Flights(0.005), Flights(0.1), Flights(0.5), Exposure()])
def test_tests_of_smaller_levels_lie_within_those_of_larger_ones(walk: Flights | Exposure) -> None:
    levels = (0.2, 0.05, 0.025, 0.01, 0.001)
    horizon = 40.0 if isinstance(walk, Exposure) else 800.0
    for loose, strict in pairwise(sequential.nested_few(walk, levels, horizon)):
        assert strict.size <= loose.size
        assert (strict >= loose[: strict.size]).all()
    for loose, strict in pairwise(sequential.nested_many(walk, levels, horizon)):
        size = min(strict.size, loose.size)
        assert (strict[:size] <= loose[:size]).all()


def test_a_boundary_does_not_depend_on_how_far_it_is_computed() -> None:
    short, long = few_times(Flights(0.02), 0.05, 500.0), few_times(Flights(0.02), 0.05, 5000.0)
    assert long[: short.size].tolist() == short.tolist()
    short, long = many_times(Flights(0.02), 0.05, 500.0), many_times(Flights(0.02), 0.05, 5000.0)
    assert long[: short.size - 1].tolist() == short[:-1].tolist()


def test_rare_events_of_flights_are_a_poisson_process() -> None:
    """Boundaries of flights, times the probability, tend to those of an exposure."""
    flights = 1e-5 * few_times(Flights(1e-5), 0.05, 1e6)
    exposure = few_times(Exposure(), 0.05, 10.0)
    assert flights[:4] == pytest.approx(exposure[:4], rel=1e-4)


@pytest.mark.parametrize("share", [0.003, 0.1, 0.5, 0.9])
def test_bounds_are_where_the_tests_turn(share: float) -> None:
    """The verdict on any bound is read off the interval."""
    events = np.random.default_rng(1).random(300) < share
    low, high = sequential.event_interval(events, 0.05)
    assert low <= events.mean() <= high
    for bound, side in ((low * 0.98, 1), (low * 1.02, None), (high + 0.02 * (1 - high), 0), (high * 0.98, None)):
        if 0.0 < bound < 1.0:
            below, above = sequential.event_levels(events, bound, (0.05,))
            assert ((below <= 0.05), (above <= 0.05)) == (side == 0, side == 1)


def test_without_an_event_the_bound_is_that_of_the_first_look() -> None:
    """n flights without an event: (1 - q)ⁿ = 0.8 · 0.05 and nothing more is spent before the next one."""
    _, high = sequential.event_interval(np.zeros(200, bool), 0.05)
    assert high == pytest.approx(1.0 - 0.04 ** (1 / 200), rel=1e-6)
    assert sequential.event_interval(np.zeros(200, bool), 0.05)[0] == 0.0


def test_quantile_bounds_agree_with_the_tests_of_any_bound() -> None:
    values = np.random.default_rng(2).normal(size=400)
    low, high = sequential.quantile_interval(values, 0.95, 0.05)
    for bound in np.linspace(1.0, 2.6, 60):
        below, above = sequential.event_levels(values > bound, 0.05, (0.05,))
        assert (below <= 0.05) == (bound >= high)
        assert (above <= 0.05) == (bound < low)


def test_few_flights_have_no_bound_on_a_quantile() -> None:
    values = np.random.default_rng(3).normal(size=62)
    assert sequential.quantile_interval(values, 0.95, 0.05)[1] == np.inf
    assert sequential.quantile_interval(np.append(values, 0.0), 0.95, 0.05)[1] == values.max()


def test_low_quantiles_mirror_high_ones() -> None:
    values = np.random.default_rng(4).normal(size=300)
    low, high = sequential.quantile_interval(values, 0.05, 0.05)
    assert (-high, -low) == sequential.quantile_interval(-values, 0.95, 0.05)


def test_looks_at_a_mean_spend_what_they_may() -> None:
    """200 000 random walks of unit steps: at most 8/9 of the error by the eighth look, within 4 standard errors."""
    looks, levels = sequential.mean_looks(600), sequential.mean_levels(0.05, 8)
    steps = np.random.default_rng(5).normal(size=(200_000, 8)) * np.sqrt(np.diff([0, *looks]))
    z = steps.cumsum(axis=1) / np.sqrt(looks)
    share = (z > norm.isf(levels)).any(axis=1).mean()
    assert looks == (32, 48, 72, 108, 162, 243, 364, 547)
    assert share == pytest.approx(0.05 * 8 / 9, abs=4 * np.sqrt(0.0444 / 200_000))
    assert levels[0] == pytest.approx(0.025, rel=1e-6)


def test_the_chance_of_a_mean_is_that_of_its_walk() -> None:
    looks = sequential.mean_looks(200)
    chances = sequential.mean_chance(0.05, len(looks), 0.2)
    steps = np.random.default_rng(6).normal(size=(100_000, len(looks))) * np.sqrt(np.diff([0, *looks]))
    z = (steps.cumsum(axis=1) + 0.2 * np.asarray(looks)) / np.sqrt(looks)
    beyond = z > norm.isf(sequential.mean_levels(0.05, len(looks)))
    assert chances == pytest.approx(np.maximum.accumulate(beyond, axis=1).mean(axis=0), abs=0.006)
