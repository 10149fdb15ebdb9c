"""A set's folder: what was ended goes on where it was, and no other set, seed or software goes on with it."""

import json
from pathlib import Path

import pytest

from uavsim.studies.certify import record
from uavsim.studies.certify.record import about, rows_in, run
from uavsim.studies.certify.results import read, refreshed
from uavsim.studies.certify.tasks import Task
from uavsim.studies.engine import InTurn

TASKS = [Task(number, "catapult", (), 1, {"wind": "calm"}) for number in range(5)]
FLOWN: list[int] = []
DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    def fly(task: Task) -> dict[str, object]:
        if task.number == 3 and not FLOWN.count(3):
            FLOWN.append(3)
            raise KeyboardInterrupt
        FLOWN.append(task.number)
        return {"number": task.number, **task.levels, "outcome": "cruise", "sd": None if task.number else 0.25}

    FLOWN.clear()
    monkeypatch.setattr(record, "fly", fly)


def test_a_run_that_was_ended_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "set"
    with pytest.raises(KeyboardInterrupt):
        run(out, "healthy", 1, TASKS, InTurn())
    assert about(out)["finished"] == 3
    assert not about(out)["complete"]
    rows = run(out, "healthy", 1, TASKS, InTurn(), resume=True)
    assert FLOWN == [0, 1, 2, 3, 3, 4]  # each once but for the one that was ended
    assert [row["number"] for row in rows] == [0, 1, 2, 3, 4]
    assert rows_in(out) == rows
    assert about(out)["complete"]


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "set"
    run(out, "healthy", 1, TASKS[:3], InTurn())
    with pytest.raises(OSError, match="--resume"):
        run(out, "healthy", 1, TASKS[:3], InTurn())
    with pytest.raises(ValueError, match="seed is 1 there, 2 here"):
        run(out, "healthy", 2, TASKS[:3], InTurn(), resume=True)
    with pytest.raises(ValueError, match="flights is 3 there, 5 here"):
        run(out, "healthy", 1, TASKS, InTurn(), resume=True)
    told = about(out)
    told["identity"]["uavsim's files"] = "another"
    (out / record.ABOUT).write_text(json.dumps(told), encoding="utf-8")
    with pytest.raises(ValueError, match="another software"):
        run(out, "healthy", 1, TASKS[:3], InTurn(), resume=True)


# -- what the docs show ------------------------------------------------------------------------------------------------


def test_the_docs_agree_with_the_verdicts_that_are_kept() -> None:
    page = (DOCS / "certify.md").read_text(encoding="utf-8")
    assert refreshed(page, DOCS / "results") == page, "python scripts/certify.py --docs"


def test_a_block_is_made_of_its_verdict(tmp_path: Path) -> None:
    check = {"name": "false flags", "wanted": "0", "found": "2 of 9", "met": False, "note": ""}
    result = {"set": "healthy", "revision": "abc", "seed": 7, "flights": 9, "command": "python x", "checks": [check]}
    result["tables"] = {"phases": [{"phase": "stroke", "sd": 0.123456, "rmse": None}]}
    (tmp_path / "healthy.json").write_text(json.dumps(result), encoding="utf-8")
    assert read(tmp_path, "healthy") == result
    page = "A\n<!-- certify: healthy checks -->\nold\n<!-- end -->\nB\n<!-- certify: healthy phases -->\n<!-- end -->\n"
    made = refreshed(page, tmp_path)
    assert "9 flights, seed 7, revision abc: `python x`" in made
    assert "| false flags | 0 | 2 of 9 | **not met** |" in made
    assert "| stroke | 0.1235 | – |" in made
    assert "old" not in made
    assert refreshed(made, tmp_path) == made
    assert "not been flown" in refreshed("<!-- certify: offset checks -->\n<!-- end -->", tmp_path)
    with pytest.raises(ValueError, match="no table 'speeds'; there are checks, phases"):
        refreshed("<!-- certify: healthy speeds -->\n<!-- end -->", tmp_path)
