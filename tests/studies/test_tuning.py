"""Tuning: keeps the budget it was given, prefers what it says, and writes what a scenario takes."""

import tomllib
from collections.abc import Iterator
from dataclasses import replace

import pytest

from uavsim.onboard.launch import KINDS, DetectorSettings
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies import tuning
from uavsim.studies.false_alarms import FalseAlarms, count
from uavsim.studies.tuning import CLASSES, MARGIN, Score, Tuned, hours_for, own_keys, plain, tune
from uavsim.views.tuning import lines, summary

BUDGET = 8.0  # false alarms an hour


@pytest.fixture(scope="module", autouse=True)
def short() -> Iterator[None]:
    """A grid and a first look that are small: what is kept, preferred and told is the same."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tuning, "LOOK", dict.fromkeys(tuning.LOOK, 0.1))
        patch.setattr(tuning, "PUSHES", tuning.PUSHES[::3])
        patch.setattr(tuning, "FINE", 2)
        yield


@pytest.fixture(scope="module")
def weak() -> Tuned:
    """A launch of 5 g that the hold of the scenario cannot see for its noise."""
    return tune(faint(), "single-threshold", budget=BUDGET, seed=1, trials=10)


def faint() -> Scenario:
    return load_scenario(
        "catapult",
        overrides=["launcher.peak_specific_force_g=4.9", "detector.kind=single-threshold", "detector.window=0.1"],
    )


def test_a_launch_that_was_missed_is_seen(weak: Tuned) -> None:
    assert weak.was.launches["detected"] == weak.was.launches["commanded"] == 0
    assert weak.tuned.launches["detected"] == weak.tuned.launches["trials"] == 20


def test_the_budget_is_kept_where_it_was_tuned(weak: Tuned) -> None:
    """Counted again, from the settings and the seed alone, in every class."""
    detector, rate = weak.scenario.detector, weak.scenario.accelerometer.description().rate
    again = count([detector], dict.fromkeys(CLASSES, hours_for(BUDGET)), seed=weak.seed, rate=rate)
    assert {name: found[0] for name, found in again.items()} == weak.own.alarms
    assert weak.own.worst().high <= MARGIN * BUDGET


def test_a_fresh_seed_scores(weak: Tuned) -> None:
    assert weak.fresh != weak.seed
    assert weak.within == (weak.tuned.worst().high <= BUDGET)
    detector, rate = weak.scenario.detector, weak.scenario.accelerometer.description().rate
    again = count([detector], dict.fromkeys(CLASSES, hours_for(BUDGET)), seed=weak.fresh, rate=rate)
    assert {name: found[0] for name, found in again.items()} == weak.tuned.alarms


def test_the_worst_class_is_the_one_that_is_told() -> None:
    """Of the detector alone soft drops are not asked, of the wing command they are."""
    quiet = FalseAlarms(0, 0, 1.0)
    drops = Score({}, {"mix": quiet, "soft drops": FalseAlarms(900, 0, 1.0), "centrifuge": FalseAlarms(2, 1, 1.0)})
    assert (drops.worst().exposure, drops.worst().wings, drops.worst().count) == ("centrifuge", False, 2)
    wings = Score({}, {"mix": FalseAlarms(1, 0, 1.0), "soft drops": FalseAlarms(900, 7, 1.0)})
    assert (wings.worst().exposure, wings.worst().wings, wings.worst().count) == ("soft drops", True, 7)


def test_a_load_that_is_held_counts() -> None:
    """INAV's rule as it ships: silent in the mix, at 4.1 g it fires all the time and opens the wings in each run."""
    (found,) = count([DetectorSettings(kind="inav")], {"centrifuge": 0.1}, seed=1)["centrifuge"]
    assert found.per_hour > 1e4
    assert found.commands == 10
    score = Score({}, {"mix": FalseAlarms(0, 0, 1.0), "centrifuge": found})
    assert (score.worst().exposure, score.worst().wings) == ("centrifuge", False)


def test_a_launch_that_is_to_be_missed_is_not_tuned_for() -> None:
    with pytest.raises(ValueError, match=r"weak-launch: expects 'missed_launch'.* tune for launches that must be"):
        tune(load_scenario("weak-launch"), "single-threshold", budget=BUDGET, seed=1, trials=10)


def test_the_same_again_with_other_workers(weak: Tuned) -> None:
    again = tune(faint(), "single-threshold", budget=BUDGET, seed=1, trials=10, workers=1)
    assert again == weak


def test_the_lines_are_a_scenario(weak: Tuned) -> None:
    values = tomllib.loads(lines(weak))
    assert list(values) == ["detector"]
    base = faint().to_dict()
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
    """A push of 4.1 g: whoever recognises it takes a load of 4.1 g that is held for a launch."""
    scenario = load_scenario("weak-launch", overrides=["launcher.peak_specific_force_g=4.0", "expect=cruise"])
    with pytest.raises(ValueError, match=r"hardest is false .*; allow more"):
        tune(scenario, "ardupilot", budget=2.0, seed=1, trials=10)
