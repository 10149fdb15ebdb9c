"""Numbers of the documentation: blocks are made of what is kept, what is kept is of the command that is declared."""

import json
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pandas as pd
import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import docs_numbers as numbers  # noqa: E402

sys.path.remove(str(ROOT / "scripts"))

BLOCKS = numbers.declared()
TREES = "uavsim|sensors|tests|scripts|docs|aircraft"
DOCS = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *ROOT.glob("aircraft/*/README.md")]


@pytest.mark.parametrize("page", numbers.PAGES, ids=lambda p: p.name)
def test_pages_show_what_is_kept(page: Path) -> None:
    """A failure means that a block was edited by hand, or a command changed: `scripts/docs_numbers.py --pages`."""
    text = page.read_text(encoding="utf-8")
    assert text == numbers.refreshed(text, BLOCKS)


def test_every_block_is_on_a_page_and_every_marker_is_whole() -> None:
    pages = "".join(page.read_text(encoding="utf-8") for page in numbers.PAGES)
    assert {found[0] for found in numbers.BLOCK.findall(pages)} == set(BLOCKS)
    assert pages.count("<!-- numbers:") == len(numbers.BLOCK.findall(pages))


def test_what_is_kept_is_of_a_block() -> None:
    kept = [json.loads(path.read_text(encoding="utf-8")) for path in numbers.RESULTS.glob("*.json")]
    assert {one["name"] for one in kept if "lines" in one} <= set(BLOCKS)
    assert all(re.fullmatch(r"[0-9a-f]{7,}\+?", one["revision"]) for one in kept if "lines" in one)


@pytest.mark.parametrize("name", [name for name, block in BLOCKS.items() if block.quick])
def test_a_quick_one_gives_the_same_again(name: str) -> None:
    """A failure after a change that is meant: `scripts/docs_numbers.py --quick`."""
    found = numbers.kept(name)
    assert found is not None
    assert numbers.alike(numbers.run(BLOCKS[name])["lines"], found["lines"])


@pytest.mark.parametrize("command", [c for b in BLOCKS.values() for c in b.commands().values()])
def test_commands_are_ones_that_can_be_run(command: str) -> None:
    from uavsim.cli import app

    first, second, *rest = command.split()
    if first == "uavsim":
        assert second in {one.callback.__name__ for one in app.registered_commands if one.callback}
    else:
        assert first in numbers.RUNS
        assert any((ROOT / word).is_file() for word in (second, *rest))


@pytest.mark.parametrize("page", DOCS, ids=lambda p: str(p.relative_to(ROOT)))
def test_files_that_are_named_exist(page: Path) -> None:
    """Paths from the repository's root, wherever they stand; NAME is somebody's own, a module may be its folder's."""
    text = page.read_text(encoding="utf-8")
    named = set(re.findall(rf"(?<![\w/.-])((?:{TREES})/[\w./*-]*[\w*/])", text))
    missing = [
        one
        for one in named
        if "NAME" not in one
        and not one.startswith("docs/results/")  # kept by runs that may still have to be made
        and not any(ROOT.glob(one.rstrip("/")))
        and not (ROOT / f"{one}.py").is_file()
    ]
    assert missing == []


def test_numbers_may_differ_by_one_in_their_last_digit_and_words_may_not() -> None:
    assert numbers.alike(["a 1.23 m", "−4"], ["a 1.24 m", "−5"])
    assert not numbers.alike(["a 1.23"], ["a 1.25"])
    assert not numbers.alike(["a 1.2"], ["a 1.20"])
    assert not numbers.alike(["cruise 1"], ["crashed 1"])


def test_a_table_says_how_many_flights_have_a_value() -> None:
    frame = pd.DataFrame({"outcome": ["cruise", "cruise", "crashed"], "a": [1.0, None, 3.0], "b": [0.5, 1.0, 1.0]})
    assert numbers._cell(numbers.Column("", "outcomes"), frame) == "2 `cruise`, 1 `crashed`"
    assert numbers._cell(numbers.Column("", "range", "a"), frame) == "1.0 … 2.0 … 3.0 (2 of 3)"
    assert numbers._cell(numbers.Column("", "median", "b - b", digits=0), frame) == "0"
    assert numbers._cell(numbers.Column("", "greatest", "b", factor=-10.0), frame) == "−5.0"
    assert numbers._cell(numbers.Column("", "mean", "none"), frame.assign(none=None)) == "–"
    with pytest.raises(ValueError, match="must be one of outcomes"):
        numbers.Column("", "best")


def test_a_block_of_another_command_is_not_shown(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    module: ModuleType = numbers
    monkeypatch.setattr(module, "RESULTS", tmp_path)
    block = numbers.Block("one", "uavsim scenarios")
    page = "before\n<!-- numbers: one -->\nold\n<!-- end -->\nafter"
    assert "Not run with this version yet" in numbers.refreshed(page, {"one": block})
    result: dict[str, Any] = {"name": "one", "commands": block.commands(), "revision": "abc1234", "lines": ["x"]}
    numbers.write(result)
    assert numbers.refreshed(page, {"one": block}) == (
        "before\n<!-- numbers: one -->\n`uavsim scenarios`, revision abc1234:\n\nx\n<!-- end -->\nafter"
    )
    other = numbers.Block("one", "uavsim scenarios --json")
    assert "Not run" in numbers.refreshed(page, {"one": other})


def test_an_excerpt_is_from_one_pattern_to_another() -> None:
    block = numbers.Block("one", "uavsim x", first="^b", last="^d")
    assert numbers._excerpt(block, "a\nb\nc \nd\ne") == ["```text", "b", "c", "d", "```"]
    plain = numbers.Block("one", "uavsim x", fenced=False)
    assert numbers._excerpt(plain, "\n| a |\n\n") == ["| a |"]


def test_a_tiny_run_flies_a_flight_or_two() -> None:
    assert numbers.small("uavsim fly gusty --seeds 1-20 --set a=1") == "uavsim fly gusty --seeds 1-2 --set a=1"
    assert (
        numbers.small("uavsim roc --hours 20 --trials 1000 --cells 200")
        == "uavsim roc --hours 1 --trials 50 --cells 20"
    )


def test_the_cheapest_come_first_and_what_measures_time_is_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[str] = []
    monkeypatch.setattr(numbers, "run", lambda block: {"name": block.name, "seconds": 0.0})
    monkeypatch.setattr(numbers, "write", lambda result: order.append(result["name"]))
    monkeypatch.setattr(numbers, "write_pages", lambda blocks: None)
    monkeypatch.setattr(sys, "argv", ["docs_numbers.py"])
    assert numbers.main() == 0
    assert sorted(order) == sorted(BLOCKS)
    rank = [(not BLOCKS[name].alone, BLOCKS[name].minutes) for name in order]
    assert rank == sorted(rank)
