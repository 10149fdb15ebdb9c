"""`uavsim paper`: what is written, the page, the exit status."""

import json
import re
import sys
from collections.abc import Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from uavsim import cli
from uavsim.studies import paper
from uavsim.studies.paper import Entry, Reproduction, centrifuge, complexity, recognition, tunnel
from uavsim.views.paper.page import page

FIGURES = (*(f"figure{n}" for n in (7, 8, 9, 12, 17, 19, 20, 21)), "pipes")
FILES = {"results.json", "index.html", *(f"figures/{name}.png" for name in FIGURES)}


@pytest.fixture(scope="module")
def found() -> Reproduction:
    """A reproduction with little noise drawn and little timed."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name, value in (
            (recognition, "TRIALS", 100),
            (recognition, "SIGMAS", (0.01,)),
            (complexity, "FED", 200),
            (complexity, "REPEATS", 1),
            (centrifuge, "UNITS", 0),
            (tunnel, "SEEDS", (1,)),
        ):
            patch.setattr(module, name, value)
        shares: list[float] = []
        result = paper.reproduce(shares.append)
    assert shares == sorted(shares)
    return result


def run(patch: pytest.MonkeyPatch, found: Reproduction, *arguments: str) -> object:
    patch.setattr(paper, "reproduce", lambda _: found)
    patch.setattr(sys, "argv", ["uavsim", "paper", *arguments])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    return caught.value.code


def test_the_folder(
    found: Reproduction, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "deep" / "paper"
    assert run(monkeypatch, found, "--out", str(out)) == 0
    assert {str(file.relative_to(out)) for file in out.rglob("*") if file.is_file()} == FILES
    results = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert {name: row["agrees"] for name, row in results.items()} == {
        "table1": True,
        "table2": True,
        "table3": False,
        "table5": True,
        "table7": True,
        "table8": False,
        "pipe": False,
        "centrifuge": True,
    }
    assert all(row.keys() >= {"paper", "ours", "agrees", "tolerance", "note"} for row in results.values())
    assert results["table2"]["ours"]["counts"] == [7, 14, 22, 32]
    printed = capsys.readouterr().out
    assert re.search(r"^Table 3 .* differs, as documented$", printed, re.MULTILINE)
    assert re.search(r"^Table 5 .* agrees$", printed, re.MULTILINE)

    assert run(monkeypatch, found, "--out", str(out)) == 2
    error = capsys.readouterr().err
    assert "not empty" in error
    assert error.count("\n") == 1
    (out / "mine.txt").write_text("stays")
    assert run(monkeypatch, found, "--out", str(out), "--overwrite") == 0
    assert (out / "mine.txt").exists()


def test_what_is_not_as_documented_is_status_1(
    found: Reproduction, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = replace(found, recognition=replace(found.recognition, counts=(7, 14, 22, 31)))
    assert run(monkeypatch, wrong, "--out", str(tmp_path / "paper")) == 1
    assert json.loads((tmp_path / "paper" / "results.json").read_text())["table2"]["agrees"] is False
    assert "NOT as documented" in capsys.readouterr().out


class Reader(HTMLParser):
    """Keeps what a page points to, and whether its tags close."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.sources += [value or "" for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def read(entries: Mapping[str, Entry], figures: Mapping[str, Path]) -> tuple[str, Reader]:
    text, reader = page(entries, figures), Reader()
    reader.feed(text)
    assert not reader.open
    return text, reader


def test_the_page_needs_nothing_else_and_holds_every_table(found: Reproduction, tmp_path: Path) -> None:
    picture = tmp_path / "f.png"
    picture.write_bytes(b"\x89PNG")
    text, reader = read(found.entries, dict.fromkeys(FIGURES, picture))
    assert sum(source.startswith("data:image/png;base64,") for source in reader.sources) == len(FIGURES)
    assert all(source.startswith(("data:", "#")) for source in reader.sources)
    assert all(f'id="{name}"' in text for name in found.entries)
    assert "Not reproduced" in text


def test_the_page_is_escaped(found: Reproduction) -> None:
    evil = "<script>alert('x')</script>"
    entry = Entry(evil, {evil: evil}, {evil: [evil]}, evil, details={evil: {evil: evil}})
    text, _ = read({evil: entry}, {})
    assert "<script" not in text
