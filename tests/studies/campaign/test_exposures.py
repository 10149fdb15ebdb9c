"""Disturbances beside the flights: what is counted, by whom, and that a verdict can come of it."""

from dataclasses import replace

import pandas as pd
import pytest

from uavsim import requirements
from uavsim.requirements import Requirement
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.campaign.exposures import MOST, Exposures
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.verification import judge
from uavsim.studies.campaign.verify import asking, outlooks
from uavsim.studies.false_alarms import count

WINGS = Requirement(
    "launch.false_wing_commands", "rate_per_hour", maximum=100.0, exposure="held load"
)  # of INAV's rule at 4.1 g: one a run, sixty an hour
ALARMS = Requirement("launch.false_detections", "rate_per_hour", maximum=0.1, exposure="held load")


def plan(*asked: Requirement, kind: str = "inav", runs: int = 1000) -> Random:
    return Random(asking(load_scenario("catapult", overrides=[f"detector.kind={kind}"]), asked), runs)


def rows(count: int) -> pd.DataFrame:
    flights = {"flight.duration": 10.0, "launch.release_time": 3.0, "launch.true_time": 3.1}
    return pd.DataFrame({"index": range(count), "outcome": "cruise", **flights})


def test_pieces_are_those_of_the_detectors_study() -> None:
    """Pieces 0 and 1 of ten minutes of the same seed."""
    its = plan(WINGS, ALARMS)
    found = Exposures(its).beside(rows(2))
    rate = its.scenario.accelerometer.description().rate
    (same,) = count([its.scenario.detector], {"centrifuge": 2 / 6}, seed=its.scenario.seed, rate=rate)["centrifuge"]
    assert found[WINGS.column].tolist() == [10.0, 10.0]
    assert same.commands == 20
    assert same.alarms > 1000
    assert found[ALARMS.column].tolist() == [MOST, MOST]


def test_what_was_counted_is_not_counted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    exposures = Exposures(plan(WINGS))
    first = exposures.beside(rows(1))
    monkeypatch.setattr(exposures, "_count", None)
    pd.testing.assert_frame_equal(exposures.beside(rows(1)), first)


def test_verdicts_come_of_the_hours() -> None:
    its = plan(replace(WINGS, maximum=300.0), ALARMS)
    found = Exposures(its).beside(rows(1))
    frame = pd.concat([found.assign(index=found["index"] + k) for k in range(3)], ignore_index=True)
    wings, alarms = judge(its.scenario.requirements, frame).judgements
    assert wings.estimate == pytest.approx(60.0)
    assert wings.verdict == "met"
    assert alarms.verdict == "not met"


def test_flights_without_such_requirements_stay_as_they_are() -> None:
    frame = rows(2)
    assert Exposures(plan(requirements.read("small-uav")[0])).beside(frame) is frame


def test_what_to_expect_is_by_the_ten_minutes_of_a_flight() -> None:
    """Without an event 3.7 expected ones show a rate: 16.7 in ten minutes do, 0.167 take some 20 flights."""
    scenario: Scenario = plan(WINGS).scenario
    ((_, one),) = outlooks(scenario, 0.95, 2)
    assert one.least == 1
    rare = plan(replace(WINGS, maximum=1.0)).scenario
    ((_, one),) = outlooks(rare, 0.95, 100)
    assert one.least is not None
    assert 18 <= one.least <= 30


def test_the_pack_asks_every_class_of_the_wings() -> None:
    found = requirements.read("launch-detector")
    wings = [one.exposure for one in found if one.key == "launch.false_wing_commands"]
    assert wings == ["handling", "vibration", "soft drops", "held load"]
