"""The tool that puts errors into the code: what it changes, what it leaves, and that its table names what exists."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

import mutants  # noqa: E402
from mutation.changes import Mutant, mutants_of  # noqa: E402
from mutation.report import explanations, reason, table  # noqa: E402
from mutation.strata import STRATA  # noqa: E402
from mutation.trial import Result  # noqa: E402

SOURCE = '''"""A docstring of 3 words."""

from typing import Annotated, Protocol

__slots__ = ("a", "b")
LIMIT: Annotated[float, "below 5.0"] = 4.0


class Shape(Protocol):
    """None of 2."""

    size = 7


def rule(x: float, side: str = "left", *, least=2) -> float:
    """Return 1."""
    assert x > 0
    if x < LIMIT and not x == least:
        raise ValueError(f"{x + 1} is too small")
    total = (
        min(x, 9.0)
        + abs(-x)
    )
    self.total = total
    log.info("x of %d", 3)
    found = search(total, x, side=side)
    total += found[0] if found else 0.0
    print("1 + 1")
    return total
'''


def changes() -> set[tuple[str, str, str]]:
    return {(m.kind, m.before, m.after) for m in mutants_of("x.py", SOURCE)}


@pytest.mark.parametrize(
    "change",
    [
        ("constant", "4.0", "(4.4)"),
        ("constant", "4.0", "(8.0)"),
        ("constant", "2", "(3)"),
        ("constant", "0.0", "(1.0)"),
        ("side", "'left'", "('right')"),
        ("comparison", "x < LIMIT", "(x <= LIMIT)"),
        ("comparison", "x < LIMIT", "(x > LIMIT)"),
        ("comparison", "x == least", "(x != least)"),
        ("boolean", "x < LIMIT and (not x == least)", "(x < LIMIT or not x == least)"),
        ("boolean", "not x == least", "(x == least)"),
        ("condition", "x < LIMIT and (not x == least)", "(not (x < LIMIT and (not x == least)))"),
        ("condition", "found[0] if found else 0.0", "(0.0 if found else found[0])"),
        ("arithmetic", "min(x, 9.0) + abs(-x)", "(min(x, 9.0) - abs(-x))"),
        ("function", "min(x, 9.0)", "(max(x, 9.0))"),
        ("sign", "-x", "(x)"),
        ("arguments", "search(total, x, side=side)", "(search(x, total, side=side))"),
        ("statement", "self.total = total", "pass"),
        ("statement", "total += found[0] if found else 0.0", "pass"),
        ("arithmetic", "total += found[0] if found else 0.0", "total -= found[0] if found else 0.0"),
    ],
)
def test_what_is_changed(change: tuple[str, str, str]) -> None:
    assert change in changes()


def test_what_is_left_alone() -> None:
    """Docstrings, annotations, protocols, what is raised, asserted, logged or printed, `__slots__`, plain names."""
    touched = {before for _, before, _ in changes()}
    assert not touched & {"7", "5.0", "3", "x > 0", "x + 1", "1", "total = min(x, 9.0) + abs(-x)", "'a'"}
    assert not any("docstring" in before or "print" in before or "log" in before for before in touched)


def test_a_mutant_is_a_module_whose_other_lines_stay_where_they_are() -> None:
    found = mutants_of("x.py", SOURCE)
    assert len(found) > 20
    for mutant in found:
        changed = mutant.applied(SOURCE)
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(SOURCE)), mutant
        assert len(changed.splitlines()) == len(SOURCE.splitlines())
        first, _, last, _ = mutant.span
        for i, line in enumerate(SOURCE.splitlines(), 1):
            assert first <= i <= last or changed.splitlines()[i - 1] == line


def test_a_draw_is_fixed_by_its_seed_and_a_longer_one_goes_on_from_it() -> None:
    assert mutants.drawn("rail", 5, 1) == mutants.drawn("rail", 9, 1)[:5]
    assert mutants.drawn("rail", 5, 1) != mutants.drawn("rail", 5, 2)


def test_the_table_names_files_and_tests_that_exist() -> None:
    """A failure means that a file was moved: rename it in scripts/mutation/strata.py."""
    assert mutants.missing(list(STRATA)) == ""


def test_a_file_that_has_moved_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(STRATA, "rail", (("uavsim/plants/gone.py",), ("tests/plants/test_rail.py",)))
    assert "uavsim/plants/gone.py of the stratum 'rail' does not exist" in mutants.missing(["rail"])


def test_every_explanation_is_of_a_mutant_that_there_is() -> None:
    """One whose line has changed goes, or speaks of the new one; a reason is a sentence."""
    for row in explanations():
        source = (ROOT / row["file"]).read_text(encoding="utf-8")
        lines = source.splitlines()
        found = [m for m in mutants_of(row["file"], source) if m.what == row["change"]]
        found = [m for m in found if row.get("line", lines[m.line - 1].strip()) == lines[m.line - 1].strip()]
        assert found, row
        assert len(row["why"]) > 20
        assert all(reason(m) for m in found)


def test_a_mutant_that_reads_the_same_on_another_line_is_not_explained() -> None:
    source = (ROOT / "sensors" / "pressure.py").read_text(encoding="utf-8")
    same = [m for m in mutants_of("sensors/pressure.py", source) if m.what == "1.0  →  (2.0)"]
    assert {reason(m) is None for m in same} == {True, False}


def test_counts_and_the_interval_of_the_share() -> None:
    """9 of 10: Clopper and Pearson's 55.5 to 99.7 %."""
    mutant = Mutant("x.py", 1, "sign", "-x", "x", (1, 0, 1, 2))
    results = [Result("rail", mutant, "passed" if i == 0 else "time" if i == 1 else "failed", 1.0) for i in range(10)]
    row = table(results).splitlines()[-1].split()
    assert row == ["all", "10", "9", "1", "1", "90.0", "%", "(55.5", "…", "99.7)"]
