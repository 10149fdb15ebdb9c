"""Intervals of a fixed number of flights, against published numbers, their definition and each other."""

import numpy as np
import pytest
from scipy.stats import binom, skew
from scipy.stats import t as student

from uavsim.studies.campaign import estimates


def test_the_upper_bounds_of_p95_and_p99_need_59_and_299_flights() -> None:
    """0.95⁵⁹ < 0.05 < 0.95⁵⁸, 0.99²⁹⁹ < 0.05 < 0.99²⁹⁸ (Wilks, Ann. Math. Statist. 12, 1941, 91-96)."""
    for probability, least in ((0.95, 59), (0.99, 299)):
        values = np.arange(float(least))
        side = estimates.one_sided(0.95)
        assert estimates.quantile(values, probability, side).high == least - 1.0
        assert estimates.quantile(values[:-1], probability, side).high is None


def test_a_flight_without_a_value_is_the_worst() -> None:
    values = np.append(np.arange(99.0), np.inf)
    found = estimates.quantile(values, 0.99, estimates.one_sided(0.6))
    assert (found.value, found.high) == (None, None)
    assert estimates.quantile(values, 0.5).value == 50.0


def test_shares_and_rates_are_the_exact_ones() -> None:
    assert estimates.share(0, 598, 0.9).high == pytest.approx(1.0 - 0.05 ** (1 / 598))
    assert estimates.rate(0, 2.0, 0.9).high == pytest.approx(-np.log(0.05) / 2.0)
    low = estimates.share(3, 20).low
    assert low is not None
    assert binom.sf(2, 20, low) == pytest.approx(0.025)


def test_a_symmetric_sample_has_students_interval() -> None:
    values = np.concatenate([np.linspace(-1.0, 1.0, 41), [0.0]])
    found = estimates.mean(values)
    half = student.isf(0.025, 41) * values.std(ddof=1) / np.sqrt(42)
    assert found.method == "Student"
    assert (found.low, found.high) == pytest.approx((-half, half), abs=1e-12)


def test_a_skew_sample_has_the_further_of_the_bootstrap_and_student() -> None:
    values = np.random.default_rng(1).exponential(size=60)
    found = estimates.mean(values)
    half = student.isf(0.025, 59) * values.std(ddof=1) / np.sqrt(60)
    assert skew(values) > 1.0
    assert found.method == "studentised bootstrap"
    assert found.low is not None
    assert found.high is not None
    assert found.low == pytest.approx(values.mean() - half)
    assert found.high > values.mean() + half
    assert estimates.mean(values) == found


@pytest.mark.parametrize("values", [np.arange(19.0), np.full(100, 3.0)], ids=["few", "all alike"])
def test_no_interval_where_nothing_can_be_told(values: np.ndarray) -> None:
    found = estimates.mean(values)
    assert (found.low, found.high, found.method) == (None, None, "none")
    assert estimates.ratio(values, np.ones(values.size)).low is None


def test_a_ratio_over_equal_denominators_is_a_mean() -> None:
    values = np.random.default_rng(2).exponential(size=80)
    ratio, mean = estimates.ratio(values, np.full(80, 2.0)), estimates.mean(values)
    assert ratio.value == pytest.approx(mean.value / 2.0)
    assert ratio.high == pytest.approx(mean.high / 2.0, rel=0.02)


def test_one_sample_more_is_not_one_flight_more() -> None:
    """Each flight's samples ten times over: the interval of the pooled figure stays."""
    rng = np.random.default_rng(3)
    squares, samples = rng.gamma(2.0, 50.0, 40), np.full(40, 100.0)
    one, ten = estimates.ratio(squares, samples), estimates.ratio(10.0 * squares, 10.0 * samples)
    assert (ten.low, ten.high) == pytest.approx((one.low, one.high), rel=1e-12)
