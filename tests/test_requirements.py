"""Requirements of single and of many flights: what is refused, what a single flight is judged by, and the pack."""

import pytest

from uavsim import requirements
from uavsim.requirements import Requirement
from uavsim.scenario import load_scenario

P = 'key="outcome",statistic="probability",equals="cruise"'
Q = 'key="launch.latency",statistic="p95"'


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ('key="launch.latency",statistic="p59x",maximum=1', "statistic = 'p59x': must be one of every, probability"),
        ('key="launch.latency",statistic="probabilty",maximum=1', "did you mean 'probability'?"),
        ('key="launch.latency",statistic="p0",maximum=1', "p with a number below 100"),
        ('key="launch.latncy",statistic="p95",maximum=1', "did you mean 'launch.latency'?"),
        ('key="outcome",statistic="p95",maximum=1', "is no number of the score"),
        (f"{Q}", "statistic = 'p95' needs minimum or maximum, one of them"),
        (f"{Q},minimum=0,maximum=1", "needs minimum or maximum, one of them"),
        (f"{Q},maximum=1,at_least=0.9", "at_least is not read by statistic = 'p95', which reads minimum, maximum"),
        (f"{Q},maximum=1,equals='cruise'", "equals is not read"),
        ('key="launch.latency",maximum=1,exposure="armed"', "exposure is not read by statistic = 'every'"),
        ('key="launch.latency",statistic="mean"', "needs minimum or maximum"),
        (P, "needs at_least or at_most, one of them"),
        (f"{P},at_least=0.9,at_most=0.95", "needs at_least or at_most, one of them"),
        (f"{P},at_least=1", "at_least = 1: must be a probability above 0 and below 1"),
        (f"{P},at_most=0", "at_most = 0: must be a probability"),
        (f"{P},at_least=-0.1", "must be a probability"),
        (f"{P},at_least=0.9,minimum=1", "has no minimum or maximum"),
        ('key="outcome",statistic="probability",at_least=0.9', "equals is missing; it must be one of cruise"),
        ('key="outcome",statistic="probability",equals="cruse",at_least=0.9', "did you mean 'cruise'?"),
        ('key="launch.latency",statistic="probability",equals="cruise",at_least=0.9', "equals is for outcome"),
        ('key="launch.latency",statistic="probability",at_least=0.9', "needs minimum or maximum, or both"),
        ('key="launch.latency",statistic="rate_per_hour",maximum=1,exposure="armed"', "counts launch.false_detections"),
        (
            'key="launch.false_detections",statistic="rate_per_hour",maximum=1',
            "exposure is missing; it must be one of armed, handling, vibration, soft drops, held load",
        ),
        ('key="launch.false_detections",statistic="rate_per_hour",maximum=1,exposure="flight"', "must be one of armed"),
        (
            'key="launch.false_wing_commands",statistic="rate_per_hour",maximum=1,exposure="armed"',
            "exposure = 'armed': must be one of handling, vibration, soft drops, held load",
        ),
        (
            'key="outcome",statistic="rate_per_hour",equals="crashed",maximum=1,exposure="handling"',
            "exposure = 'handling': must be one of armed, flight",
        ),
        ('key="launch.false_wing_commands",statistic="p95",maximum=1', "is no number of the score"),
        ('key="airspeed.hazard",statistic="rate_per_hour",maximum=1,exposure="armed"', "must be one of flight"),
        (
            'key="launch.false_detections",statistic="rate_per_hour",maximum=1,exposure="x"',
            "must be 'armed', 'flight', 'handling'",
        ),
        (
            'key="launch.false_detections",statistic="rate_per_hour",maximum=0,exposure="armed"',
            "must be a rate above 0",
        ),
        ('key="outcome",statistic="rate_per_hour",maximum=1,exposure="flight"', "equals is missing"),
    ],
)
def test_what_cannot_be_asked_is_one_line(given: str, says: str) -> None:
    with pytest.raises(ValueError, match=r"^--set: requirements\[0\]") as error:
        load_scenario("catapult", overrides=[f"requirements=[{{{given}}}]"])
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_every_statistic_can_be_asked_and_says_so_in_words() -> None:
    scenario = load_scenario(
        "catapult",
        overrides=[
            f"requirements=[{{{P},at_least=0.995}}, {{{Q},maximum=0.03}},"
            '{key="airspeed.rmse",statistic="mean",maximum=1},'
            '{key="airspeed.rmse",statistic="probability",minimum=0.1,maximum=1,at_most=0.9},'
            '{key="launch.false_detections",statistic="rate_per_hour",maximum=0.5,exposure="armed"},'
            '{key="outcome",statistic="rate_per_hour",equals="crashed",maximum=0.5,exposure="flight"},'
            '{key="launch.false_wing_commands",statistic="rate_per_hour",maximum=0.1,exposure="soft drops"},'
            '{key="launch.latency",minimum=0,maximum=0.05}]'
        ],
    )
    assert [str(one) for one in scenario.requirements] == [
        "P(outcome = cruise) ≥ 0.995",
        "p95 of launch.latency ≤ 0.03",
        "mean of airspeed.rmse ≤ 1",
        "P(0.1 ≤ airspeed.rmse ≤ 1) ≤ 0.9",
        "launch.false_detections ≤ 0.5 per armed hour",
        "outcome = crashed ≤ 0.5 per flight hour",
        "launch.false_wing_commands ≤ 0.1 per hour of soft drops",
        "0 ≤ launch.latency ≤ 0.05, every flight",
    ]
    assert [one.of_each_flight for one in scenario.requirements] == [False] * 7 + [True]
    again = type(scenario).from_dict(scenario.to_dict())
    assert again.requirements == scenario.requirements


def test_quantiles_are_those_between_0_and_100() -> None:
    assert Requirement("launch.latency", "p99.9", maximum=1.0).quantile == pytest.approx(0.999)
    assert Requirement("launch.latency", "p00", maximum=1.0).quantile is None
    assert Requirement("launch.latency", "p100", maximum=1.0).quantile is None


def test_the_shipped_pack_is_sound_and_says_whose_it_is() -> None:
    found = requirements.read("small-uav")
    assert {one.kind for one in found} >= {"probability", "quantile", "mean"}
    assert "Ours" in (requirements.PACKAGED / "small-uav.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "holds no [[requirements]]"),
        ("[[requirements]]\nkey='outcome'\n", "is no number of the score"),
        ("[[requirement]]\nkey='launch.latency'\n", "did you mean 'requirements'?"),
        ("x = = 1", "not valid TOML"),
    ],
)
def test_a_wrong_pack_is_one_line(tmp_path, content: str, says: str) -> None:
    file = tmp_path / "pack.toml"
    file.write_text(content)
    with pytest.raises(ValueError, match=r"pack\.toml") as error:
        requirements.read(file)
    assert says in str(error.value)


def test_a_pack_that_is_not_there_names_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'small-uav'"):
        requirements.read("smal-uav")
