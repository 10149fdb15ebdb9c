"""Recordings against their right answers: what is found, what is wrong, and what of an answer is refused."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from uavsim.studies.recordings import Answer, answers_for, judged, read_answer, replayed
from uavsim.views.recordings import table

ROOT = Path(__file__).resolve().parents[2]
LAUNCHED = 3.0  # s


def write_log(path: Path) -> None:
    """A launch of 7 g for 0.3 s, from 3 s on."""
    t = np.arange(0.0, 6.0, 0.005)
    push = 68.6 * ((t >= LAUNCHED) & (t < LAUNCHED + 0.3))
    noise = np.random.default_rng(1).normal(0.0, 0.2, (3, t.size))
    pd.DataFrame({"t": t, "fx": push + noise[0], "fy": noise[1], "fz": noise[2] - 9.81}).to_csv(path, index=False)


def answer(folder: Path, text: str) -> None:
    (folder / "one.toml").write_text(text, encoding="utf-8")


def test_a_folder_is_replayed_with_and_without_answers(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        write_log(tmp_path / name)
    (tmp_path / "README.md").write_text("no log")
    answer(tmp_path, 'title = "mine"\nfiles = ["a.csv"]\nlaunches = [[2.99, 3.1]]\n')
    mine, other = replayed(tmp_path, answers_for(tmp_path, [tmp_path]))
    assert (mine.title, mine.expected, mine.found, mine.false_alarms, mine.wrong) == ("mine", 1, 1, 0, ())
    assert 0.02 < mine.delays[0] < 0.06
    assert (other.title, other.expected, other.found, other.judged) == ("b.csv", None, 1, False)
    lines = table([mine, other])
    assert "| mine | 1 of 1 |" in lines[2]
    assert lines[2].endswith("| right |")
    assert lines[3].endswith("| no answer |")


def test_a_wrong_answer_is_told_and_so_is_a_log_that_is_none(tmp_path: Path) -> None:
    write_log(tmp_path / "a.csv")
    (tmp_path / "z.csv").write_text("nothing\nhere\n")
    answer(tmp_path, 'files = ["a.csv"]\nlaunches = [[1.0, 1.1]]\n')
    found = list(replayed(tmp_path, answers_for(tmp_path, [tmp_path])))
    assert found[0].wrong[0] == "no launch recognised from 1 to 1.1 s"
    assert "1 false alarms" in found[0].wrong[1]
    assert found[1].wrong
    assert not found[1].judged
    told = "\n".join(table(found))
    assert "| wrong |" in told
    assert "| not read |" in told


def test_an_airspeed_is_judged_by_what_is_asked_of_it() -> None:
    score = {
        "airspeed": {"rmse": 0.8, "coverage_95": 0.91, "valid_fraction": 1.0, "flags": 1},
        "recording": {
            "detections": [3.0, 4.0, 5.0],
            "airspeed": {"reference": "log: v", "over_ground": {"difference": 0.9, "within": False}},
        },
    }
    events = [{"event": "airspeed_fault", "channel": "total", "t": 4.0}]
    asked = Answer("one", ("a",), launches=((2.9, 3.1),), lasts=((3.0, 4.5),), allowed_flags=("static",),
                   over_ground=True, coverage=0.95, error=0.5)  # fmt: skip
    wrong = judged(asked, score, events).wrong
    assert wrong == (
        "1 false alarms, the first at 5.000 s",
        "1 false flags, the first of the total port",
        "the airspeed is +0.90 m/s off the speed over ground, beyond both error bars",
        "coverage_95 is 0.91, and 0.95 is asked for",
        "rmse is 0.8, and 0.5 is asked for",
    )
    lax = Answer(
        "one", ("a",), launches=((2.9, 3.1),), lasts=((3.0, 5.5),), allowed_flags=("total",), coverage=0.9, error=1.0
    )
    assert judged(lax, score, events).wrong == ()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("files = 3", "files must be a list"),
        ('title = "x"', "files = […] is missing"),
        ('files = ["a"]\nspeed = 3', "'speed' is no word of an answer"),
        ('files = ["a"]\nlaunches = [3]', "launches must be pairs"),
        ("files = [", "one.toml: "),
    ],
)
def test_an_answer_that_is_none_is_refused_in_a_line(tmp_path: Path, text: str, said: str) -> None:
    answer(tmp_path, text)
    with pytest.raises(ValueError, match=r"^[^\n]*$") as error:
        read_answer(tmp_path / "one.toml")
    assert said in str(error.value)


def test_our_answers_can_be_read() -> None:
    assert len([read_answer(path) for path in (ROOT / "recordings").glob("*.toml")]) == 3


def test_the_command_tells_what_it_did(tmp_path: Path) -> None:
    write_log(tmp_path / "a.csv")
    answer(tmp_path, 'files = ["a.csv"]\nlaunches = [[1.0, 1.1]]\n')
    command = [sys.executable, str(ROOT / "scripts" / "recordings.py")]
    ran = subprocess.run(
        [*command, "--out", str(tmp_path / "out" / "table.md")],
        env={**os.environ, "UAVSIM_RECORDINGS": str(tmp_path), "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 1
    assert "| wrong |" in ran.stdout
    assert (tmp_path / "out" / "table.md").read_text() == ran.stdout
