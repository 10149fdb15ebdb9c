"""Verdicts on requirements: what counts, what a missing value counts as, families, looks, and when to stop."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from uavsim.requirements import Requirement
from uavsim.scenario import load_scenario
from uavsim.studies.campaign import sequential, verify
from uavsim.studies.campaign.evidence import counted, course
from uavsim.studies.campaign.flown import Flown
from uavsim.studies.campaign.keep import keep_of
from uavsim.studies.campaign.outlook import outlook
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.record import Record, taken_up
from uavsim.studies.campaign.verification import holm, judge, plain, schedule, verdicts
from uavsim.studies.engine import Left

CRUISE = Requirement("outcome", "probability", equals="cruise", at_least=0.995)
CRASH = Requirement("outcome", "probability", equals="crashed", at_most=0.01)
LATE = Requirement("launch.latency", "p95", maximum=0.03)
MEAN = Requirement("airspeed.rmse", "mean", maximum=1.0)
ALARMS = Requirement("launch.false_detections", "rate_per_hour", maximum=10.0, exposure="armed")
EVERY = Requirement("launch.false_detections", maximum=0)


def flights(n: int, *, crashed: tuple[int, ...] = (), seed: int = 1) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    frame = pd.DataFrame(
        {
            "index": np.arange(n),
            "outcome": "cruise",
            "launch.latency": rng.normal(0.02, 0.002, n),
            "airspeed.rmse": rng.normal(0.5, 0.1, n),
            "launch.false_detections": 0.0,
            "launch.release_time": 3.6,
            "launch.true_time": 3.61,
            "flight.duration": 36.0 + 3.61,
        }
    )
    frame.loc[list(crashed), "outcome"] = "crashed"
    return frame


def test_643_flights_in_cruise_show_995_of_1000_and_642_do_not() -> None:
    for n, verdict in ((642, "undecided"), (643, "met")):
        (found,) = judge([CRUISE], flights(n)).judgements
        assert found.verdict == verdict
    assert found.low is not None
    assert found.low >= 0.995
    assert found.estimate == 1.0


def test_a_decision_stands_whatever_comes_after_it() -> None:
    """The verdict fell with flight 643; the crash of flight 650 does not take it back."""
    (found,) = judge([CRUISE], flights(660, crashed=(650,))).judgements
    assert found.verdict == "met"
    assert found.estimate == pytest.approx(659 / 660)


def test_three_early_crashes_show_that_it_is_not_met() -> None:
    found = judge([CRUISE], flights(40, crashed=(1, 2, 3)))
    assert found.verdict == "not met"
    assert found.judgements[0].high is not None
    assert found.judgements[0].high < 0.995


def test_a_missing_value_counts_against_what_is_asked() -> None:
    frame = flights(200)
    frame.loc[:19, ["launch.latency", "airspeed.rmse"]] = np.nan
    low = Requirement("launch.latency", "p05", minimum=0.01)
    rare = Requirement("launch.latency", "probability", minimum=1.0, at_most=0.01)
    often = Requirement("launch.latency", "probability", maximum=1.0, at_least=0.99)
    each = Requirement("launch.latency", maximum=1.0)
    found = judge([LATE, low, rare, often, each, MEAN], frame).judgements
    assert [one.verdict for one in found] == ["not met"] * 5 + ["undecided"]
    assert [one.without_value for one in found] == [20] * 6
    assert found[2].estimate == 0.1
    assert found[3].estimate == 0.9
    assert found[0].high is None  # +inf: no bound
    assert found[5].estimate is None


def test_every_is_refuted_by_one_flight_and_shown_for_95_of_100_by_59() -> None:
    frame = flights(59)
    assert judge([EVERY], frame.iloc[:58]).verdict == "undecided"
    (found,) = judge([EVERY], frame).judgements
    assert (found.verdict, found.bound) == ("met", 0.95)
    assert found.low == pytest.approx(0.05 ** (1 / 59))
    frame.loc[58, "launch.false_detections"] = 1.0
    assert judge([EVERY], frame).verdict == "not met"


def test_exposures_are_those_of_the_score() -> None:
    frame = flights(3)
    frame.loc[1, ["launch.true_time", "flight.duration"]] = np.nan, 2.0
    assert counted(ALARMS, frame)[1] * 3600.0 == pytest.approx([3.6, 2.0, 3.6])
    crashes = Requirement("outcome", "rate_per_hour", equals="crashed", maximum=1.0, exposure="flight")
    assert counted(crashes, frame)[1] * 3600.0 == pytest.approx([36.0, 0.0, 36.0])


def test_a_flight_without_a_count_never_helps_a_rate() -> None:
    """Null counts as one event where there is exposure, and as nothing where there is none."""
    hazards = Requirement("airspeed.hazard", "rate_per_hour", maximum=1.0, exposure="flight")
    frame = flights(4).assign(**{"airspeed.hazard": [1.0, np.nan, np.nan, 0.0]})
    frame.loc[2, "launch.true_time"] = np.nan
    assert counted(hazards, frame)[0].tolist() == [1.0, 1.0, 0.0, 0.0]


def test_a_rate_is_met_after_the_exposure_of_its_first_look() -> None:
    """No event in t hours shows a rate below -ln(0.04)/t: 3.219 events expected."""
    need = int(np.ceil(-np.log(0.04) / 10.0 * 1000.0))
    assert judge([ALARMS], flights(need - 1)).verdict == "undecided"
    (found,) = judge([ALARMS], flights(need)).judgements
    assert found.verdict == "met"
    assert found.high == pytest.approx(-np.log(0.04) / (need / 1000.0))


def test_a_mean_says_which_interval_it_took() -> None:
    frame = flights(48).assign(**{"airspeed.rmse": np.tile([0.4, 0.6], 24)})
    (found,) = judge([MEAN], frame).judgements
    assert (found.verdict, found.method) == ("met", "Student")
    constant = flights(50).assign(**{"airspeed.rmse": 0.5})
    assert judge([MEAN], constant).verdict == "undecided"


def test_lower_bounds_mirror_upper_ones() -> None:
    frame = flights(300)
    mirrored = frame.assign(**{"launch.latency": -frame["launch.latency"], "airspeed.rmse": -frame["airspeed.rmse"]})
    for key, statistic, bound in (("launch.latency", "p95", 0.0235), ("airspeed.rmse", "mean", 0.505)):
        opposite = f"p{100 - int(statistic[1:])}" if statistic != "mean" else statistic
        (one,) = judge([Requirement(key, statistic, maximum=bound)], frame).judgements
        (other,) = judge([Requirement(key, opposite, minimum=-bound)], mirrored).judgements
        assert one.verdict == other.verdict
        assert (one.low, one.high) == pytest.approx((-other.high, -other.low))


def test_holm_is_holms() -> None:
    """Example: 0.01, 0.04, 0.03, 0.005 at 0.05: 0.005 ≤ 0.0125, 0.01 ≤ 0.0167, then 0.03 > 0.025 ends it."""
    assert holm([0.01, 0.04, 0.03, 0.005], 0.05) == [True, False, False, True]
    assert holm([0.05], 0.05) == [True]
    assert holm([0.026, 0.049], 0.05) == [False, False]


def test_all_met_needs_no_correction_but_single_ones_do() -> None:
    """643 flights suffice for all together; beside one that fails, a single one has to pass at half the error."""
    again = Requirement("outcome", "probability", equals="crashed", at_most=0.005)
    assert judge([CRUISE, again], flights(643)).met
    frame = flights(643)
    frame["launch.false_detections"] = 1.0
    found = judge([CRUISE, EVERY], frame)
    assert [one.verdict for one in found.judgements] == ["undecided", "not met"]
    assert (found.judgements[0].p_met, found.judgements[0].decided_by) == (pytest.approx(0.05), None)
    more = int(sequential.few_times(sequential.Flights(0.005), 0.025, 1024.0)[0])
    longer = flights(more).assign(**{"launch.false_detections": 1.0})
    assert [one.verdict for one in judge([CRUISE, EVERY], longer).judgements] == ["met", "not met"]


def test_undecided_says_what_would_decide() -> None:
    (clean,) = judge([CRUISE], flights(100)).judgements
    assert (clean.decided_by, clean.met_by) == (643, 643)
    (one,) = judge([CRUISE], flights(400, crashed=(5,))).judgements
    assert one.met_by == int(sequential.few_times(sequential.Flights(0.005), 0.05, 4096.0)[1])
    (bad,) = judge([CRASH], flights(60, crashed=(7, 50))).judgements
    assert bad.verdict == "undecided"
    assert bad.decided_by is not None


def test_looks_are_where_it_may_be_met_and_end_with_the_budget() -> None:
    looks = schedule([CRUISE, LATE, MEAN, EVERY], 0.95, 2000)
    assert {643, 63, 59} <= set(looks)
    assert looks[-1] == 2000
    assert list(looks) == sorted(set(looks))
    assert len(looks) < 80
    assert schedule([CRUISE], 0.95, 5) == (5,)


@pytest.mark.parametrize(
    ("requirement", "least"), [(CRUISE, 643), (LATE, 63), (EVERY, 59), (MEAN, 32), (CRASH, 321), (ALARMS, 322)]
)
def test_the_outlook_knows_the_least_number_of_flights(requirement: Requirement, least: int) -> None:
    found = outlook(requirement, 0.95, 1000, hours=1e-3)
    assert found.least == least
    assert 0.0 <= found.met + found.not_met <= 1.0 + 1e-5
    sooner = outlook(requirement, 0.95, least - 1, hours=1e-3)
    assert (sooner.least, sooner.met) == (least, 0.0)


def test_the_outlook_is_what_the_verdicts_come_to() -> None:
    """1000 campaigns of 200 flights at a stated truth, within four standard errors."""
    asked, rng = Requirement("outcome", "probability", equals="cruise", at_least=0.95), np.random.default_rng(2)
    names = np.array(["cruise", "crashed"])
    words = [
        verdicts([asked], pd.DataFrame({"outcome": names[(rng.random(200) < 0.03).astype(int)]}))[0]
        for _ in range(1000)
    ]
    expected = outlook(asked, 0.95, 200, truth=0.97)
    for word, chance in (("met", expected.met), ("not met", expected.not_met)):
        assert words.count(word) / 1000 == pytest.approx(chance, abs=4 * np.sqrt(chance * (1 - chance) / 1000) + 1e-3)


@pytest.mark.parametrize("requirement", [CRUISE, LATE, MEAN, ALARMS, EVERY])
def test_a_course_ends_at_the_verdicts_figures(requirement: Requirement) -> None:
    frame = flights(150, crashed=(20,))
    seen, (found,) = course(requirement, frame), judge([requirement], frame).judgements
    assert seen.flights[-1] == 150
    for values, value in ((seen.estimate, found.estimate), (seen.low, found.low), (seen.high, found.high)):
        assert values[-1] == pytest.approx(np.nan if value is None else value, rel=1e-4, nan_ok=True)


def test_a_document_has_the_keys_that_others_rely_on() -> None:
    document = plain(judge([CRUISE, LATE], flights(20)))
    assert (document["runs"], document["confidence"]) == (20, 0.95)
    for one in document["requirements"]:
        assert {"key", "statistic", "bound", "estimate", "low", "high", "verdict"} <= set(one)
    assert document["requirements"][1]["high"] is None


@pytest.mark.parametrize("confidence", [0.5, 1.0, 0.0, np.nan])
def test_a_confidence_is_one(confidence: float) -> None:
    with pytest.raises(ValueError, match=r"must lie between 0\.5 and 1"):
        judge([CRUISE], flights(3), confidence)


def test_a_number_that_no_flight_has_is_refused() -> None:
    with pytest.raises(ValueError, match=r"launch\.latency: no flight has"):
        judge([LATE], flights(3).drop(columns="launch.latency"))


# -- flying until decided ----------------------------------------------------------------------------------------------


class Rows:
    """A crew that has the rows ready: what flies is not of interest here."""

    def __init__(self, frame: pd.DataFrame, lost: int | None = None) -> None:
        self._frame, self._lost, self.asked = frame, lost, 0

    def each(self, work, given, *, done, limit=None):
        kept = [(i, p) for i, p in enumerate(given) if p != self._lost]
        done(
            [
                (i, Flown({**self._frame.iloc[p].to_dict(), "seed": 1, "expected": "cruise"}, None, None))
                for i, p in kept
            ]
        )
        self.asked = max(self.asked, *given, 0) + 1
        return [Left(i, "its worker died 3 times") for i, p in enumerate(given) if p == self._lost]


def flown(tmp_path: Path, frame: pd.DataFrame, *requirements: Requirement, lost: int | None = None, budget: int = 1000):
    scenario = verify.asking(load_scenario("catapult"), requirements)
    crew = Rows(frame, lost)
    record = Record(tmp_path, Random(scenario, budget), keep="none")
    return verify.fly_until_decided(record, crew, keep_of("none", ()), 0.95), crew, record


def test_it_flies_no_further_than_the_look_that_decides(tmp_path: Path) -> None:
    found, crew, record = flown(tmp_path, flights(100), LATE, MEAN, EVERY)
    assert found.met
    assert (found.verification.runs, crew.asked, record.finished) == (63, 63, 63)
    assert len(found.frame) == 63


def test_the_budget_ends_it_undecided(tmp_path: Path) -> None:
    found, _, record = flown(tmp_path, flights(30), CRUISE, budget=30)
    assert (found.verification.verdict, record.finished) == ("undecided", 30)


def test_nothing_after_a_flight_that_could_not_be_flown_is_judged(tmp_path: Path) -> None:
    """What is missing may be missing because of how it went."""
    found, _, _ = flown(tmp_path, flights(100), LATE, lost=20, budget=100)
    assert found.verification.runs == 20
    assert [one.why for one in found.left] == ["its worker died 3 times"]
    assert not found.met


def test_a_run_that_is_taken_up_comes_to_the_same(tmp_path: Path) -> None:
    frame = flights(100)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
    at_once, _, _ = flown(tmp_path / "a", frame, LATE, budget=100)
    flown(tmp_path / "b", frame, LATE, budget=20)
    scenario = verify.asking(load_scenario("catapult"), [LATE])
    plan = Random(scenario, 100)
    record = Record(tmp_path / "b", plan, keep="none", before=taken_up(tmp_path / "b", plan))
    later = verify.fly_until_decided(record, Rows(frame), keep_of("none", ()), 0.95)
    assert plain(later.verification) == plain(at_once.verification)
    assert later.verification.runs == 63


def test_a_scenario_without_requirements_is_refused() -> None:
    scenario = load_scenario("catapult", overrides=["requirements=[]"])
    with pytest.raises(ValueError, match="small-uav"):
        verify.asking(scenario)
    assert len(verify.asking(scenario, "small-uav").requirements) > 5


def test_python_flies_in_this_process(tmp_path: Path) -> None:
    changes = ("duration=2.5", "launcher.wait_min=1.6", "launcher.wait_max=1.7", "expect=timeout")
    wanted = [Requirement("launch.false_detections", maximum=0), Requirement("launch.latency", "p50", maximum=0.1)]
    found = verify.verify(load_scenario("catapult", overrides=changes), runs=7, requirements=wanted, workers=0)
    assert found.verification.runs == 7
    assert [one.verdict for one in found.verification.judgements] == ["undecided", "met"]
    assert len(found.frame) == 7
