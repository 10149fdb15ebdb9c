"""A campaign's folder: rows in parts, what is kept, and what a later run takes up or refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uavsim.flight import load
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.batch import Batch, fly_seeds
from uavsim.studies.campaign import record
from uavsim.studies.campaign.campaign import Flights, fly_plan, opened
from uavsim.studies.campaign.flown import Flown, fly_position
from uavsim.studies.campaign.keep import FIRST_AND_FAILURES, NOTHING, Keep, keep_of
from uavsim.studies.campaign.plan import Cells, Points, Random, Seeds, plan_of, position_of
from uavsim.studies.campaign.record import Record, frame, plan_in, ranges, taken_up, traces
from uavsim.studies.engine import InTurn
from uavsim.studies.identity import differences, identity, processor_features

CHANGES = ("duration=2.5", "launcher.wait_min=1.6", "launcher.wait_max=1.7", "expect=timeout", "requirements=[]")
SHORT = load_scenario("catapult", overrides=CHANGES)
SEEDS = (7, 3, 5)
Results = list[tuple[int, Flown]]


@pytest.fixture(scope="module")
def flown() -> Results:
    plan = Seeds(SHORT, SEEDS)
    return [(i, fly_position(plan, FIRST_AND_FAILURES, None, i)) for i in range(3)]


@pytest.fixture(scope="module")
def together() -> Batch:
    return fly_seeds(SHORT, list(SEEDS), workers=1)


def test_rows_are_kept_in_the_order_that_was_asked_for(tmp_path: Path, flown: Results, together: Batch) -> None:
    kept = Record(tmp_path, Seeds(SHORT, SEEDS))
    kept.keep([flown[1], flown[0]])
    assert kept.missing == [2]
    kept.keep(flown[2:])
    kept.describe(complete=True, wall_time=1.5)
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "runs.parquet"), together.runs)
    described = json.loads((tmp_path / "campaign.json").read_text())
    assert (described["asked"], described["seeds"]) == ("7,3,5", [7, 3, 5])
    assert (described["root_seed"], described["complete"], described["wall_time"]) == (1, True, 1.5)
    assert Scenario.from_dict(described["scenario"]) == SHORT
    assert described["versions"]["numpy"] == np.__version__
    assert set(described["processor"]) == {"machine", "name", "features"}
    assert [path.name for path in (tmp_path / "flights").iterdir()] == ["7"]
    assert load(tmp_path / "flights" / "7").score["seed"] == 7
    assert {path.name for path in tmp_path.iterdir()} == {"campaign.json", "runs.parquet", "flights", "traces"}


def test_errors_over_time_come_back_as_they_were(tmp_path: Path, flown: Results, together: Batch) -> None:
    kept = Record(tmp_path, Seeds(SHORT, SEEDS))
    kept.keep(flown)
    for back, was in zip(traces(tmp_path), together.traces, strict=True):
        assert (back.index, back.seed) == (was.index, was.seed)
        for name in ("filtered", "raw", "nees"):
            np.testing.assert_array_equal(getattr(back, name), getattr(was, name))
        assert back.course is not None
        assert was.course is not None
        assert back.course.temperature == was.course.temperature
        for name in ("airspeed", "slope", "static", "force"):
            np.testing.assert_array_equal(getattr(back.course, name), getattr(was.course, name))


def test_it_says_from_the_beginning_what_it_is(tmp_path: Path) -> None:
    Record(tmp_path, Seeds(SHORT, (1, 2, 3, 9)))
    described = json.loads((tmp_path / "campaign.json").read_text())
    assert (described["asked"], described["seeds"], described["complete"]) == ("1-3,9", [], False)
    assert [path.name for path in tmp_path.iterdir()] == ["campaign.json"]


def test_many_rows_are_kept_in_several_files(
    tmp_path: Path, flown: Results, together: Batch, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file a thousand flights, here two; none of a part that is full is held any longer."""
    monkeypatch.setattr(record, "PART", 2)
    kept = Record(tmp_path, Seeds(SHORT, SEEDS))
    for result in flown:
        kept.keep([result])
    names = sorted(p.name for p in (tmp_path / "runs.parquet").iterdir())
    assert names == ["part-000000.parquet", "part-000001.parquet"]
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "runs.parquet"), together.runs)
    pd.testing.assert_frame_equal(frame(tmp_path), together.runs)
    assert kept._rows == {}


@pytest.mark.parametrize(
    ("seeds", "text"),
    [([], ""), ([7], "7"), ([1, 2, 3, 4, 9], "1-4,9"), ([3, 2, 1], "3,2,1"), ([5, 6, 8, 9], "5-6,8-9")],
)
def test_seeds_are_told_as_they_are_given(seeds: list[int], text: str) -> None:
    assert ranges(seeds) == text


def test_a_column_has_one_type_whatever_is_missing_in_it(tmp_path: Path) -> None:
    """A part in which nobody detected a launch, or all have a reason, reads like any other."""
    row = {"index": 0, "seed": 4, "outcome": "cruise", "reason": None, "launch.latency": None, "requirements.met": True}
    other = {**row, "index": 1, "reason": "hit a tree", "launch.latency": 0.1}
    types = [record._table([one]).schema for one in (row, other)]
    assert types[0] == types[1]


# -- taken up ----------------------------------------------------------------------------------------------------------


def fly_into(folder: Path, plan: Any, *, positions: Any = None, before: Any = None, keep: Keep = NOTHING) -> Flights:
    return fly_plan(Record(folder, plan, before=before), InTurn(), keep, positions=positions)


def test_a_campaign_that_is_taken_up_ends_in_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Flown in three goes, the second of which ends within a part; and longer than it was first meant to be."""
    monkeypatch.setattr(record, "PART", 2)
    plan = Random(SHORT, 5)
    for name in ("whole", "goes"):
        (tmp_path / name).mkdir()
    fly_into(tmp_path / "whole", plan)
    fly_into(tmp_path / "goes", Random(SHORT, 2), positions=[1])
    for positions, finished in (([3], 1), (None, 2)):
        before = taken_up(tmp_path / "goes", plan)
        assert before.outcomes == {"timeout": finished}
        fly_into(tmp_path / "goes", plan, positions=positions, before=before)
    for part in sorted((tmp_path / "whole" / "runs.parquet").iterdir()):
        assert (tmp_path / "goes" / "runs.parquet" / part.name).read_bytes() == part.read_bytes()
    assert opened(tmp_path / "goes").complete
    rows = frame(tmp_path / "goes")
    assert rows["index"].tolist() == [0, 1, 2, 3, 4]
    assert set(rows["seed"]) == {1}
    assert rows["draw.release_time"].nunique() == 5


@pytest.mark.parametrize(
    ("plan", "says"),
    [
        (Random(load_scenario("catapult", overrides=[*CHANGES, "launcher.friction=0.02"]), 2), "launcher.friction was"),
        (Random(SHORT.with_seed(9), 2), "seed was 1 and is 9"),
        (Random(SHORT, 1), "runs was 2 and is 1"),
        (Seeds(SHORT, (1, 2)), "kind was 'random' and is 'seeds'"),
    ],
)
def test_another_campaign_is_refused_with_the_difference(tmp_path: Path, plan: Any, says: str) -> None:
    Record(tmp_path, Random(SHORT, 2))
    with pytest.raises(ValueError, match="--resume: is another campaign") as caught:
        taken_up(tmp_path, plan)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_another_version_is_refused_with_the_difference(tmp_path: Path) -> None:
    Record(tmp_path, Random(SHORT, 2))
    about = tmp_path / "campaign.json"
    told = json.loads(about.read_text())
    told["identity"]["numpy"] = "1.0"
    about.write_text(json.dumps(told))
    with pytest.raises(ValueError, match=r"numpy was '1.0' and is "):
        taken_up(tmp_path, Random(SHORT, 2))


@pytest.mark.parametrize(
    "text", ["", "[]", "{", '{"plan": 3, "scenario": {}, "identity": {}}', '{"plan": {"kind": "random"}, "x": 1}',
             '{"plan": {"kind": "os.system", "runs": 1}, "scenario": {}, "identity": {}}',
             '{"plan": {"kind": "random", "runs": "9"}, "scenario": {}, "identity": {}}',
             '{"plan": {"kind": "random", "runs": 9}, "scenario": {"duration": -1}, "identity": {}}'],
)  # fmt: skip
def test_a_damaged_record_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "campaign.json").write_text(text)
    with pytest.raises(ValueError, match=r"campaign\.json") as caught:
        plan_in(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_damaged_part_is_one_line(tmp_path: Path, flown: Results) -> None:
    kept = Record(tmp_path, Seeds(SHORT, SEEDS))
    kept.keep(flown)
    (tmp_path / "runs.parquet").write_bytes(b"PAR1 no")
    with pytest.raises(ValueError, match=r"runs\.parquet: is damaged"):
        frame(tmp_path)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda rows: rows.assign(index=[10**9, 0, 1]), "index 1000000000 of seed 1 is no flight"),
        (lambda rows: rows.assign(index=[-1, 0, 1]), "index -1 of seed 1 is no flight"),
        (lambda rows: rows.assign(seed=77), "index 0 of seed 77 is no flight"),
        (lambda rows: rows.assign(index=["a", "b", "c"]), "are no whole numbers"),
        (lambda rows: rows.drop(columns="index"), "has no column 'index'"),
        (lambda rows: rows.drop(columns="outcome"), "has no column 'outcome'"),
        (lambda rows: pd.concat([rows, rows]), "is in it twice"),
    ],
)
def test_rows_of_another_campaign_are_not_taken_up(tmp_path: Path, change: Any, says: str) -> None:
    plan = Random(SHORT, 3)
    fly_into(tmp_path, plan)
    change(frame(tmp_path)).to_parquet(tmp_path / "runs.parquet", index=False)
    with pytest.raises(ValueError, match=r"runs\.parquet: is damaged") as caught:
        taken_up(tmp_path, plan)
    assert says in str(caught.value)


@pytest.mark.parametrize("name", ["flights", "traces", "runs.parquet", "campaign.json"])
def test_nothing_is_written_through_a_link(tmp_path: Path, name: str) -> None:
    here, elsewhere = tmp_path / "here", tmp_path / "elsewhere"
    here.mkdir()
    plan = Random(SHORT, 2)
    fly_into(here, plan, positions=[0], keep=Keep("all"))
    (here / name).rename(elsewhere)
    (here / name).symlink_to(elsewhere)
    with pytest.raises(ValueError, match="is a link"):
        taken_up(here, plan)


# -- plans -------------------------------------------------------------------------------------------------------------


CELLS = ({"launcher.friction": 0.01}, {"launcher.friction": 0.2, "detector.kind": "cusum"})


@pytest.mark.parametrize(
    "plan",
    [Seeds(SHORT, SEEDS), Random(SHORT, 4), Cells(SHORT, CELLS, 3), Points(SHORT, ((), (), ()), (5, 0, 2**31))],
)
def test_a_plan_is_data_that_comes_back(plan: Any) -> None:
    back = plan_of(json.loads(json.dumps(plan.to_dict())), SHORT)
    assert back.to_dict() == plan.to_dict()
    assert back.size == plan.size
    for position in range(plan.size):
        assert back.flight(position) == plan.flight(position)
        assert position_of(plan, plan.index(position)) == position
    assert position_of(plan, 10**9) is None


def test_flights_of_a_cell_have_the_draws_of_any_other(tmp_path: Path) -> None:
    plan = Cells(SHORT, CELLS, 2)
    rows = [plan.columns(position) for position in range(4)]
    assert [(row["run"], row["vary.launcher.friction"]) for row in rows] == [(0, 0.01), (1, 0.01), (0, 0.2), (1, 0.2)]
    assert rows[0]["draw.release_time"] == rows[2]["draw.release_time"] != rows[1]["draw.release_time"]
    flights = [plan.flight(position) for position in range(4)]
    assert [flight.index for flight in flights] == [0, 1, 0, 1]
    assert flights[2].detector.kind == "cusum"
    assert flights[2].seed == flights[0].seed


# -- kept flights ------------------------------------------------------------------------------------------------------


def runs() -> pd.DataFrame:
    rows = [("cruise", True, 0.3), ("crashed", True, np.nan), ("cruise", False, 0.1), ("crashed", True, 0.9)]
    table = pd.DataFrame(rows, columns=["outcome", "requirements.met", "airspeed.rmse"])
    return table.assign(index=[10, 11, 12, 13], expected="cruise")


@pytest.mark.parametrize(
    ("text", "kept"),
    [("failures:2", [11, 12]), ("worst:2:airspeed.rmse", [11, 13]), ("least:1:airspeed.rmse", [11]),
     ("least:2:airspeed.rmse", [11, 12]), ("failures:9", [11, 12, 13])],
)  # fmt: skip
def test_what_only_all_flights_tell(text: str, kept: list[int]) -> None:
    """A null is the worst there is, whichever side is bad."""
    rule = keep_of(text, ["airspeed.rmse"])
    assert rule.later
    assert rule.among(runs()) == kept
    assert str(rule) == text


@pytest.mark.parametrize(
    ("text", "wanted"), [("none", []), ("all", [0, 1, 2, 3]), ("every:2", [0, 2]), ("failures", [0, 1, 2, 3])]
)
def test_what_is_kept_as_it_comes(text: str, wanted: list[int]) -> None:
    rule, rows = keep_of(text, []), runs().to_dict("records")
    assert [i for i, row in enumerate(rows) if rule.wants(i, row)] == wanted
    assert not rule.later


@pytest.mark.parametrize(
    ("text", "says"),
    [("some", "must be none, all"), ("every", "must be"), ("every:0", "must be"), ("worst:5", "must be"),
     ("all:3", "must be"), ("worst:5:airspeed.rms", "did you mean 'airspeed.rmse'"), ("failures:-1", "must be"),
     ("every:5:airspeed.rmse", "must be"), ("", "must be"), ("worst:x:airspeed.rmse", "must be")],
)  # fmt: skip
def test_a_rule_that_is_none_is_refused(text: str, says: str) -> None:
    with pytest.raises(ValueError, match="--keep") as caught:
        keep_of(text, ["airspeed.rmse"])
    assert says in str(caught.value)


def test_flights_that_only_all_tell_are_flown_once_more(tmp_path: Path) -> None:
    done = fly_into(tmp_path, Random(SHORT, 3), keep=keep_of("worst:1:launch.latency", ["launch.latency"]))
    worst = int(done.runs["index"][done.runs["launch.latency"].idxmax()])
    assert done.kept() == sorted({0, worst})
    assert done.flight(worst).score["launch"]["latency"] == done.runs["launch.latency"].max()


# -- who flies ---------------------------------------------------------------------------------------------------------


def test_processor_features_are_those_of_floating_point(tmp_path: Path) -> None:
    cpuinfo = tmp_path / "cpuinfo"
    cpuinfo.write_text("processor : 0\nflags\t\t: fpu sse4_2 avx2 fma ht avx\n\nflags : avx512f\n")
    assert processor_features(cpuinfo) == ["avx", "avx2", "fma", "sse4_2"]
    assert processor_features(tmp_path / "none") == []


def test_a_difference_names_both() -> None:
    ours = {"numpy": "2.4", "processor features": "avx avx2 fma"}
    assert differences(ours, dict(ours)) == []
    assert differences(ours, {"numpy": "2.3", "processor features": "avx fma"}) == [
        "numpy: 2.3 there, 2.4 here",
        "processor features: avx fma there, avx2 here",
    ]
    assert {"uavsim", "jsbsim", "numba", "python", "uavsim's files"} <= set(identity())
