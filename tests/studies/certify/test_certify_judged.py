"""Verdicts on rows made by hand: a set in which all is well is met, and each thing that is wrong is found."""

from pathlib import Path
from typing import Any

import pytest

from uavsim.score_keys import PHASES
from uavsim.studies.certify import from_start, healthy, in_flight, offset
from uavsim.studies.certify.verdict import Verdict
from uavsim.views.certified import coverage, save_coverage

SD = {"stroke": 0.5, "transition": 0.1, "cruise": 0.05}


def row_of(number: int) -> dict[str, Any]:
    row: dict[str, Any] = {"number": number, **healthy.combination(number), "outcome": "cruise", "hours": 0.01}
    row |= {"flags": 0, "flag_t": None, "flag_channel": "", "flag_kind": "", "ready": True, "not_ready": ""}
    row |= {"worst_ratio": 3.0, "worst_ratio_t": 5.0, "worst_error": 0.4}
    for phase in PHASES:
        figures = {"rows": 100, "valid": 100, "within": 95, "within_valid": 95, "counted": 100, "sd": SD[phase]}
        figures |= {
            "square": 100 * SD[phase] ** 2,
            "bound": 95 * SD[phase] ** 2,
            "bounded_square": 100 * SD[phase] ** 2,
        }
        row |= {f"{phase}.{key}": value for key, value in figures.items()}
    return row


def all_well() -> list[dict[str, Any]]:
    return [row_of(number) for number in range(0, healthy.SIZE, 5)]


def found(verdict: Verdict, name: str) -> bool | None:
    (check,) = (check for check in verdict.checks if check.name.startswith(name))
    return check.met


def test_all_is_well() -> None:
    rows = [row_of(number) for number in range(healthy.SIZE)]
    verdict = healthy.judge(rows, 1, healthy.judge(all_well(), 1).to_dict())
    assert {check.name: check.met for check in verdict.checks if check.met is not True} == {}
    assert verdict.worst == []


@pytest.mark.parametrize(("change", "check"), [
    ({"outcome": "timeout"}, "all that are not refused"),
    ({"flags": 1, "flag_t": 9.0, "flag_channel": "total", "flag_kind": "frozen"}, "false flags"),
    ({"worst_ratio": 6.5}, "a valid airspeed off"),
    ({"worst_ratio": 7.0, "wrong_for": 1.2}, "valid and more than 3 m/s wrong"),
    ({"ready": False}, "not ready though"),
])  # fmt: skip
def test_one_flight_that_is_wrong_is_found(change: dict[str, Any], check: str) -> None:
    rows = all_well()
    rows[100] |= change
    verdict = healthy.judge(rows, 1)
    assert found(verdict, check) is False
    if "ready" not in change:
        assert [one["number"] for one in verdict.worst] == [rows[100]["number"]]
        assert f"index={rows[100]['number']} " in verdict.worst[0]["command"]


@pytest.mark.parametrize(("change", "check"), [
    ({"transition.within": 80, "transition.within_valid": 80}, "mean coverage of each level, transition, valid rows"),
    ({"cruise.within": 100, "cruise.within_valid": 100}, "mean coverage of each level, cruise, all rows"),
    ({"cruise.valid": 95, "cruise.within_valid": 90}, "valid share of each level, cruise"),
    ({"cruise.sd": 0.07}, "median claimed sd of each level, cruise"),
    ({"transition.bounded_square": 1.3}, "RMSE/√PCRB of each level, transition"),
])  # fmt: skip
def test_a_level_that_is_off_is_found(change: dict[str, Any], check: str) -> None:
    rows = [{**row, **change} if row["pressure"] == "bmp581" else row for row in all_well()]
    before = healthy.judge(all_well(), 1).to_dict()
    assert found(healthy.judge(rows, 1, before), check) is False


def test_levels_are_drawn(tmp_path: Path) -> None:
    levels = healthy.judge(all_well(), 1).to_dict()["tables"]["levels"]
    panels = coverage(levels).axes
    assert [panel.get_xlabel() for panel in panels] == list(PHASES)
    assert panels[-1].get_yticklabels()[0].get_text().startswith("accelerometer adxl345 (")
    save_coverage(levels, tmp_path / "coverage.png")
    assert (tmp_path / "coverage.png").read_bytes().startswith(b"\x89PNG")


def test_a_bar_that_grew_where_it_was_wrong_before_is_held_against_the_error() -> None:
    """Coverage 0.5 before: 1.4 times the old bar is allowed where the RMSE is as large."""
    wrong = [{**row, "cruise.within_valid": 50} for row in all_well()]
    rows = [{**row, "cruise.sd": 0.07, "cruise.square": 100 * 0.07**2} for row in all_well()]
    assert found(healthy.judge(rows, 1, healthy.judge(wrong, 1).to_dict()), "median claimed sd of each level, cruise")


def test_a_cell_that_is_off_is_shown_though_its_levels_are_not() -> None:
    """One part in one wind, 126 of 4410 flights, with a coverage of 0.6."""
    rows = [row_of(number) for number in range(healthy.SIZE)]
    off = {"cruise.within": 60, "cruise.within_valid": 60}
    rows = [{**row, **off} if (row["pressure"], row["wind"]) == ("bmp390", "head 15") else row for row in rows]
    verdict = healthy.judge(rows, 1)
    assert found(verdict, "single cells") is False
    (check,) = (check for check in verdict.checks if check.name == "single cells")
    assert check.found.startswith("1 of ")
    assert "bmp390, head 15, cruise 0.600 (126)" in check.found


def test_an_offset_that_costs_accuracy_is_found() -> None:
    rows = []
    for number in range(offset.SIZE):
        task = offset.task(number, 1)
        row = {
            "number": number,
            **task.levels,
            "outcome": "cruise",
            "flags": 0,
            "detections": 1,
            "since_crossing": 0.01,
        }
        rows.append({**row, "false_detections": 0, "worst_ratio": 3.0, "cruise.square": 1.0, "cruise.counted": 100})
    assert all(check.met for check in offset.judge(rows, 1).checks)
    worse = [{**row, "cruise.square": 1.5} if row["part"] == "small" else row for row in rows]
    assert found(offset.judge(worse, 1), "±5 m/s²: cruise RMSE") is False
    lost = [{**row, "outcome": "timeout"} if row["number"] == 450 else row for row in rows]
    assert found(offset.judge(lost, 1), "±20 m/s²") is False
    named = [{**row, "ready": False, "not_ready": "accelerometer: 12 m/s² off"} for row in lost]
    assert found(offset.judge(named, 1), "±20 m/s²") is True


def seen(name: str, **change: Any) -> list[dict[str, Any]]:
    """100 flights of a case, of which the last is changed."""
    place = list(in_flight.CASES).index(name)
    rows = []
    for flight in range(100):
        row = {"number": place * in_flight.SECTION + flight, "case": name, "seed": 1, "fault": 10.0, "flagged": 10.5}
        row |= {"recovered": None, "channel": in_flight.CASES[name].channel, "kind": "frozen", "false": 0, "off": None}
        row |= {"climb": 2.0, "outcome": "cruise", "coverage": 0.95, "valid": 5.0, "error": 1.0}
        rows.append({**row, "told_coverage": 0.95, "told_error": 1.0})
    rows[-1] |= change
    return rows


@pytest.mark.parametrize(("name", "change", "met"), [
    ("blocked-gusts", {}, True),
    ("blocked-gusts", {"flagged": 12.5}, True),  # 99 of 100
    ("blocked-gusts", {"false": 1}, False),
    ("blocked-gusts", {"outcome": "crashed"}, False),
    ("blocked-gusts", {"recovered": 15.0}, False),
    ("blocked-for-3-s", {"recovered": 15.0}, False),  # and 99 are not
    ("blocked-calm", {"flagged": 20.0, "off": 19.0}, True),
    ("slow-leak-gusts", {"flagged": None}, True),
    ("healthy-calm", {}, False),
])  # fmt: skip
def test_faults_in_flight_are_held_against_their_table(name: str, change: dict[str, Any], met: bool) -> None:
    (check,) = in_flight.judge(seen(name, **change), 1).checks
    assert check.met is met


def test_a_healthy_flight_without_a_flag() -> None:
    rows = [{**row, "flagged": None, "fault": None, "channel": ""} for row in seen("healthy-calm")]
    (check,) = in_flight.judge(rows, 1).checks
    assert check.met


def test_both_errors_of_readiness_are_counted() -> None:
    """By hand: 1 of 882 sound ones not ready; of 8 dead accelerometers, 2 of those that died late were ready."""
    rows = all_well()
    rows[0] |= {"ready": False}
    first = healthy.judge(rows, 1).tables["readiness"][0]
    assert (first["of"], first["told"], first["not ready"]) == ("all", 882, 1)
    assert first["low"] < 1 / 882 < first["high"]
    dead = [
        {
            "number": 50_000 + i, "case": "accelerometer dead", "outcome": "cruise", "right": True,
            "start": 0.7 if i % 2 else 0.0, "ready": i in (3, 5),
        }
        for i in range(8)
    ]  # fmt: skip
    verdict = from_start.judge([*dead, {**dead[0], "case": "cover on", "ready": True}], 1)
    early, late = verdict.tables["readiness"]
    assert (early["ready"], early["told"], late["ready"], late["told"]) == (0, 4, 2, 4)
    assert found(verdict, "ready though a sensor is dead") is True
    assert found(from_start.judge([{**dead[0], "ready": None}], 1), "ready though a sensor is dead") is None
