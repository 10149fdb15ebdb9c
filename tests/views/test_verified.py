"""Verdicts as they are shown: 80 columns, JUnit that build servers read, a figure that nothing breaks."""

import json
from pathlib import Path
from xml.etree.ElementTree import fromstring

import numpy as np
import pandas as pd
import pytest

from uavsim.requirements import Requirement
from uavsim.requirements import read as read_pack
from uavsim.scenario import Scenario
from uavsim.studies.campaign.outlook import outlook
from uavsim.studies.campaign.verification import judge
from uavsim.studies.campaign.verify import Verified
from uavsim.views import verification as view

N = 80
EVERY = Requirement("launch.false_detections", maximum=0)
ALARMS = Requirement("launch.false_detections", "rate_per_hour", maximum=10.0, exposure="armed")


def frame(n: int = N) -> pd.DataFrame:
    rng = np.random.default_rng(1)
    keys = {one.key for one in read_pack("small-uav")} - {"outcome"}
    return pd.DataFrame(
        {
            **{key: rng.exponential(1.0, n) for key in keys},
            "outcome": np.where(np.arange(n) % 20 == 3, "crashed", "cruise"),
            "launch.false_detections": 0.0,
            "launch.release_time": 3.0,
            "launch.true_time": 3.01,
            "flight.duration": 35.0,
        }
    )


def verified(*requirements: Requirement, rows: pd.DataFrame | None = None, name: str = "catapult") -> Verified:
    rows = frame() if rows is None else rows
    asked = requirements or (*read_pack("small-uav"), EVERY, ALARMS)
    return Verified(judge(asked, rows), Scenario(name=name, requirements=tuple(asked)), rows)


def test_tables_fit_80_columns_and_say_everything(capsys: pytest.CaptureFixture[str]) -> None:
    found = verified()
    expected = [(one, outlook(one, 0.95, 3000, hours=1e-3)) for one in found.scenario.requirements]
    view.print_expected(expected, 0.95, 3000)
    view.print_verified(found)
    out = capsys.readouterr().out
    table = [line for line in out.splitlines() if not line.startswith(tuple(str(o) for o, _ in expected))]
    assert max(map(len, table)) <= 80
    for one in found.verification.judgements:
        assert one.verdict in out.lower()
    assert "NOT MET" in out
    assert "decided by" in out
    assert "met by" in out


def test_a_missing_value_is_counted_in_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    rows = frame()
    rows.loc[:2, "launch.latency"] = np.nan
    view.print_verified(verified(Requirement("launch.latency", "p95", maximum=9.0), rows=rows))
    assert "without a value: 3 flights" in capsys.readouterr().out


def test_junit_has_a_case_a_requirement() -> None:
    found = verified()
    root = fromstring(view.junit(found.verification, found.scenario, 12.0))
    (suite,) = root
    cases = suite.findall("testcase")
    words = [one.verdict for one in found.verification.judgements]
    assert root.tag == "testsuites"
    assert (int(suite.get("tests", "")), len(cases)) == (len(words), len(words))
    assert int(suite.get("failures", "")) == words.count("not met") == len(suite.findall("testcase/failure"))
    assert int(suite.get("errors", "")) == words.count("undecided") == len(suite.findall("testcase/error"))
    assert next(child.tag for child in suite) == "properties"
    for case, one in zip(cases, found.verification.judgements, strict=True):
        assert {"name", "classname", "time"} <= set(case.keys())
        assert case.get("name") == str(one.requirement)
    for problem in suite.findall("testcase/*"):
        assert {"message", "type"} == set(problem.keys())


def test_hostile_text_is_only_text() -> None:
    name = 'a"<b>&\x07]]>\x1b[31m\u202e\ud800'
    content = view.junit(verified(name=name).verification, Scenario(name=name), 0.0)
    suite = fromstring(content)[0]
    assert "\\x07" in suite.get("name", "")
    assert '"<b>&' in suite.get("name", "")
    assert b"\x07" not in content
    assert b"\x1b" not in content


@pytest.mark.parametrize("rows", [1, 9, 60])
def test_the_folder_gets_verdicts_and_a_figure(tmp_path: Path, rows: int) -> None:
    found = verified(*read_pack("small-uav")[:2], EVERY, ALARMS, rows=frame(rows))
    expected = [(EVERY, outlook(EVERY, 0.95, 100))]
    view.write(found, expected, tmp_path, plots=rows != 9)
    document = json.loads((tmp_path / "verify.json").read_text())
    assert document["runs"] == rows
    assert [one["verdict"] for one in document["requirements"]] == [o.verdict for o in found.verification.judgements]
    assert document["expected"][0]["least_flights"] == 59
    assert (tmp_path / "plots" / "verify.png").exists() == (rows != 9)
    assert (tmp_path / "junit.xml").read_bytes().startswith(b"<?xml")


def test_a_flight_that_diverged_does_not_break_the_figure(tmp_path: Path) -> None:
    rows = frame()
    rows.loc[5, "airspeed.rmse"] = 1e12
    rows.loc[6, "airspeed.rmse"] = np.nan
    asked = [Requirement("airspeed.rmse", statistic, maximum=2.0) for statistic in ("p95", "p50", "mean")]
    assert view.draw(verified(*asked, rows=rows), tmp_path / "a.png").stat().st_size > 10_000
