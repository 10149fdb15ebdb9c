"""Tuning: keeps the budget it was given, prefers what it says, and writes what a scenario takes."""

import tomllib
from dataclasses import replace

import pytest

from uavsim.onboard.launch import KINDS, DetectorSettings
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.false_alarms import count
from uavsim.studies.tuning import MARGIN, Tuned, hours_for, own_keys, plain, tune
from uavsim.views.tuning import lines, summary

BUDGET = 5.0  # false alarms an hour


@pytest.fixture(scope="module")
def weak() -> Tuned:
    """A weak launch that the hold as shipped can never see: 4 g against a level of 4.6 g."""
    return tune(load_scenario("weak-launch"), "single-threshold", budget=BUDGET, seed=1, trials=10)


def test_a_launch_that_was_missed_is_seen(weak: Tuned) -> None:
    assert weak.was.launches["detected"] == 0
    assert weak.tuned.launches["detected"] == weak.tuned.launches["trials"] == 20


def test_the_budget_is_kept_where_it_was_tuned(weak: Tuned) -> None:
    """Counted again, from the settings and the seed alone."""
    detector, rate = weak.scenario.detector, weak.scenario.accelerometer.description().rate
    (again,) = count([detector], {"mix": hours_for(BUDGET)}, seed=weak.seed, rate=rate)["mix"]
    assert again == weak.own.alarms["mix"]
    assert again.interval()[1] <= MARGIN * BUDGET


def test_a_fresh_seed_scores(weak: Tuned) -> None:
    assert weak.fresh != weak.seed
    assert weak.within == (weak.tuned.alarms["mix"].interval()[1] <= BUDGET)
    detector, rate = weak.scenario.detector, weak.scenario.accelerometer.description().rate
    (again,) = count([detector], {"mix": hours_for(BUDGET)}, seed=weak.fresh, rate=rate)["mix"]
    assert again == weak.tuned.alarms["mix"]


def test_the_same_again_with_other_workers(weak: Tuned) -> None:
    again = tune(load_scenario("weak-launch"), "single-threshold", budget=BUDGET, seed=1, trials=10, workers=1)
    assert again == weak


def test_the_lines_are_a_scenario(weak: Tuned) -> None:
    values = tomllib.loads(lines(weak))
    assert list(values) == ["detector"]
    base = load_scenario("weak-launch").to_dict()
    assert Scenario.from_dict({**base, **values}).detector == weak.scenario.detector
    assert summary(weak)["detector"]["kind"] == "single-threshold"


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_plain_lines_that_it_reads(kind: str) -> None:
    """Keys of another kind are left behind: a scenario refuses those that are not read."""
    loaded = replace(DetectorSettings(), threshold=30.0, ratio=0.7)
    own = own_keys(loaded, kind)
    values = {"detector": plain(own), "launcher": {"peak_specific_force_g": 8.0}}
    if kind != "paparazzi":  # its rule takes longer than the stroke
        assert Scenario.from_dict(values).detector == own
    assert KINDS[kind].level is not None
    assert KINDS[kind].second_of(own) is not None


@pytest.mark.parametrize("budget", [0.0, -1.0, float("nan"), float("inf")])
def test_budgets_that_are_none_are_refused(budget: float) -> None:
    with pytest.raises(ValueError, match="must be above 0"):
        hours_for(budget)


def test_a_budget_too_small_to_show_is_refused() -> None:
    with pytest.raises(ValueError, match=r"0\.0067 an hour can be shown"):
        hours_for(1e-4)
    assert hours_for(0.0068) == 1000.0
    assert hours_for(0.1) == pytest.approx(72.25, abs=0.1)


def test_a_budget_that_no_settings_keep_is_refused() -> None:
    """ArduPilot's rule on a weak catapult: its level can rise no further than the push, and shocks pass that."""
    scenario = load_scenario("weak-launch", overrides=["launcher.peak_specific_force_g=2.5"])
    with pytest.raises(ValueError, match="allow more"):
        tune(scenario, "ardupilot", budget=2.0, seed=1, trials=10)
