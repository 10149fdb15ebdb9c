"""What is said of many flights: envelopes, running estimates, causes, draws that matter, values far from all others."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

from uavsim.flight import Flight
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.airspeed_flights import bound, bound_of, course, together
from uavsim.studies.campaign.causes import cause_of, causes
from uavsim.studies.campaign.convergence import running_quantile, running_share, sizes
from uavsim.studies.campaign.differences import differences, holm
from uavsim.studies.campaign.envelopes import envelopes, mean_square_band
from uavsim.studies.campaign.far import far_traces, reach
from uavsim.studies.campaign.flown import ErrorTrace
from uavsim.studies.campaign.many import Many
from uavsim.studies.campaign.resampled_bound import RESAMPLES, ResampledBound
from uavsim.studies.intervals import share_interval
from uavsim.studies.quantiles import quantile_band, quantile_ranks


def test_an_envelope_is_the_quantile_and_band_of_the_flights_at_each_time() -> None:
    """The same as `quantile_band` of those that still fly; inf counts, NaN does not."""
    rng = np.random.default_rng(3)
    values = rng.normal(size=(90, 4))
    values[40:, 1] = np.nan
    values[3, 2] = np.inf
    values[:, 3] = np.nan
    for found in envelopes(values, (0.05, 0.5, 0.95)):
        for i, sample in enumerate((values[:, 0], values[:40, 1])):
            expected = quantile_band(sample, found.probability)
            assert found.value[i] == pytest.approx(expected.value, rel=1e-12)
            for one, other in ((found.low[i], expected.low), (found.high[i], expected.high)):
                assert np.isnan(one) if other is None else one == other
        assert found.value[2] >= np.quantile(values[values[:, 2] < np.inf, 2], found.probability)
        assert np.isnan((found.value[3], found.low[3], found.high[3])).all()


def test_the_band_of_an_envelope_covers_as_often_as_it_says() -> None:
    """Against the exact probability of its order statistics, P(l <= B < u); 20 000 independent times, 4 sd."""
    n, times = 80, 20_000
    values = np.random.default_rng(5).normal(size=(n, times))
    for probability, true in ((0.5, 0.0), (0.95, 1.6448536)):
        (found,) = envelopes(values, (probability,))
        low, high = quantile_ranks(n, probability)
        exact = binom.cdf(high - 1, n, probability) - binom.cdf(low - 1, n, probability)
        covered = np.mean((found.low <= true) & (true <= found.high))
        assert exact >= 0.95
        assert covered == pytest.approx(exact, abs=4.0 * np.sqrt(exact * (1.0 - exact) / times))


def test_the_bootstrap_of_a_mean_square_is_as_wide_as_theory_says() -> None:
    """Of m Gaussian errors the root mean square has a relative sd of 1/√(2m); 1000 times, 10 %."""
    m = 200
    low, high = mean_square_band(np.random.default_rng(7).normal(size=(m, 1000)) ** 2)
    width = float(np.mean(high - low))
    assert width == pytest.approx(2.0 * 1.96 / np.sqrt(2.0 * m), rel=0.10)


def test_running_estimates_are_those_of_the_first_flights() -> None:
    rng = np.random.default_rng(2)
    true, values = rng.random(500) < 0.9, rng.normal(size=500)
    values[::7] = np.nan
    n = sizes(500)
    assert (n[0], n[-1], np.all(np.diff(n) > 0)) == (1, 500, True)
    share, median = running_share(true), running_quantile(values, 0.5)
    for i in (0, 10, n.size - 1):
        first = true[: n[i]]
        assert share.value[i] == first.mean()
        assert (share.low[i], share.high[i]) == share_interval(int(first.sum()), int(n[i]))
    sample = values[~np.isnan(values)]
    expected = quantile_band(sample, 0.5)
    assert (median.value[-1], median.low[-1], median.high[-1]) == pytest.approx(
        (expected.value, expected.low, expected.high)
    )
    assert np.isnan(median.value[0])
    assert sizes(0).size == running_share(np.empty(0, dtype=bool)).n.size == 0


@pytest.mark.parametrize(
    ("reason", "cause"),
    [
        ("touched the ground at 3.21 s: sink 4.20 m/s, roll -3°", "touched the ground"),
        ("part mine2 raised ValueError: domain", "part mine2 raised ValueError: domain"),
        ("numbers left all bounds after −2.5e3 s", "numbers left all bounds"),
        ("12", "12"),
        ("", ""),
    ],
)
def test_a_cause_is_a_reason_without_its_numbers(reason: str, cause: str) -> None:
    assert cause_of(reason) == cause


def flown(**columns: object) -> Many:
    runs = pd.DataFrame(columns)
    return Many(Scenario(name="a"), runs.assign(index=np.arange(len(runs))))


def test_causes_are_counted_with_exact_intervals() -> None:
    reasons = [None, "touched the ground at 3 s", "touched the ground at 4 s: hard", None]
    found = causes(flown(outcome=["cruise", "crashed", "crashed", "cruise"], expected="cruise", reason=reasons))
    assert [(c.outcome, c.cause, c.expected, c.flights, c.row) for c in found] == [
        ("cruise", "", True, 2, 0),
        ("crashed", "touched the ground", False, 2, 1),
    ]
    assert (found[0].low, found[0].high) == share_interval(2, 4)


def test_holm_is_as_published() -> None:
    """The example of Wright, Biometrics 48 (1992), table 1, by hand: p times 4, 3, 2, 1, never falling."""
    assert holm(np.array([0.01, 0.04, 0.03, 0.005])) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm(np.array([0.6, 0.9])) == pytest.approx([1.0, 1.0])
    assert holm(np.empty(0)).size == 0


def test_a_draw_that_has_nothing_to_do_with_failing_is_rarely_said_to() -> None:
    """Any of 4 draws below 5 %, over 200 campaigns of 60 flights: at most 5 % and 3 sd of the count."""
    rng = np.random.default_rng(11)
    wrong = 0
    for _ in range(200):
        draws = {f"draw.{i}": rng.normal(size=60) for i in range(4)}
        many = flown(outcome=np.where(rng.random(60) < 0.3, "crashed", "cruise"), expected="cruise", **draws)
        wrong += any(one.probability < 0.05 for one in differences(many))
    assert wrong <= 200 * 0.05 + 3.0 * np.sqrt(200 * 0.05 * 0.95)


def test_a_draw_that_decides_is_found_and_few_failures_say_nothing() -> None:
    force = np.linspace(0.9, 1.1, 40)
    outcome = np.where(force < 0.93, "crashed", "cruise")
    found = differences(flown(outcome=outcome, expected="cruise", **{"draw.force": force, "draw.same": 1.0}))
    assert [one.key for one in found] == ["force"]
    assert found[0].probability < 0.001
    assert found[0].failed < 0.93 < found[0].others
    few = np.where(np.arange(40) < 4, "crashed", "cruise")
    assert differences(flown(outcome=few, expected="cruise", **{"draw.force": force})) == []


def test_what_is_far_decides_no_range() -> None:
    usual = np.random.default_rng(1).normal(10.0, 1.0, 50)
    found = reach(np.concatenate([usual, [1e9, np.inf, -np.inf, np.nan, 1e200]]))
    assert (found.low, found.high) == (usual.min(), usual.max())
    assert np.flatnonzero(found.beyond).tolist() == [50, 51, 52, 54]
    assert found.shown.sum() == 50
    equal = reach(np.array([0.1, 0.1, 0.1, 0.11]))  # nearly equal values are all shown
    assert (equal.low, equal.high) == (0.1, 0.11)
    four = reach(np.array([0.1, 0.1, 0.12, 1e6]))
    assert four.beyond.tolist() == [False, False, False, True]
    nothing = reach(np.array([np.nan, np.inf]))
    assert np.isnan(nothing.low)
    assert nothing.beyond.tolist() == [False, True]
    two = reach(np.array([0.1, 3e8]), np.array([True, False]))  # of two, the outcome tells which is odd
    assert two.beyond.tolist() == [False, True]


def test_a_lognormal_is_hardly_ever_far() -> None:
    """σ = 1 has a long tail; of 20 000 values no more than four thousandths are left out."""
    assert reach(np.random.default_rng(4).lognormal(0.0, 1.0, 20_000)).beyond.mean() < 4e-3


def test_errors_are_far_only_beside_others() -> None:
    time = np.array([-0.5, 0.5, 1.5])
    errors = np.tile(0.1, (4, 3))
    many = flown(outcome=["cruise"] * 4, expected="cruise")
    assert not far_traces(many, time, errors).any()
    errors[2, 0] = 1e6  # before the launch
    errors[3, 2] = 1e6
    assert far_traces(many, time, errors).tolist() == [False, False, False, True]
    assert not far_traces(many, time, np.full((4, 3), np.nan)).any()


def test_resampling_leaves_the_bound_and_equal_courses_have_no_spread(catapult: Flight) -> None:
    """The bound is that without resampling; its standard error vanishes where all courses are one."""
    own = course(catapult)
    n = 800  # 1 s after launch
    short = type(own)(own.airspeed[:n], own.slope[:n], own.static[:n], own.force[:n], own.temperature)
    other = type(own)(1.1 * short.airspeed, short.slope, short.static, 1.2 * short.force, own.temperature)
    courses = together([short, other])
    t, expected = bound(catapult, courses)
    times, resampled = bound_of(catapult, courses, ResampledBound)
    assert np.array_equal(times, t)
    assert np.array_equal(resampled.sd(), expected)
    assert resampled.resampled[0].shape == (RESAMPLES,)
    spread = np.std(np.log(np.array(resampled.resampled)), axis=1)
    assert spread.max() > 1e-4
    low, high = np.array(resampled.resampled).min(axis=1), np.array(resampled.resampled).max(axis=1)
    assert np.all((low <= expected[resampled.at] * 1.001) & (expected[resampled.at] <= 1.001 * high))
    _, same = bound_of(catapult, together([short, short]), ResampledBound)
    reference = same.sd()
    assert np.array(same.resampled) == pytest.approx(np.tile(reference[same.at], (RESAMPLES, 1)).T, rel=1e-9)


def test_a_trace_of_a_rig_has_no_errors_and_something_in_its_nees() -> None:
    """One that is never told an airspeed: both are as long as the errors are, which may be nothing."""
    traces = [ErrorTrace(1, np.empty(0), np.empty(0), np.full(26, np.nan))]
    flown = Many(load_scenario("launch-curve"), pd.DataFrame({"index": [0]}), traces)
    assert flown.matrix("nees").shape == flown.matrix("filtered").shape == (1, 0)
