"""The documents against the code: the scenario's keys, links, commands, frozen versions."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

from uavsim.plants.air.weather import PRESETS
from uavsim.scenario import keys

ROOT = Path(__file__).resolve().parent.parent
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *ROOT.glob("aircraft/*/README.md")]


def test_scenario_page_is_what_the_settings_declare(monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure means that a setting changed: run `scripts/scenario_reference.py`."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "scenario_reference", raising=False)
    import scenario_reference

    page = scenario_reference.PAGE.read_text(encoding="utf-8")
    assert page == scenario_reference.page()
    missing = [key for key in keys() if f"`{key}`" not in page and key != "requirements"]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8"))
    assert [t for t in targets if "://" not in t and not (page.parent / t).exists()] == []


def test_the_page_on_the_air_has_every_key_and_every_weather() -> None:
    """Its table of presets is row for row what `PRESETS` says."""
    page = (ROOT / "docs" / "air.md").read_text(encoding="utf-8")
    assert "`gust_speed` … `gust_length_s`" in page  # the keys of one gust, in short
    own = [key.removeprefix("environment.") for key in keys() if key.startswith("environment.")]
    assert [key for key in own if f"`{key}`" not in page and not key.startswith("gust_")] == []
    rows = re.search(r"\| preset \|.*\n\|[-|]+\n((?:\|.*\n)+)", page)
    assert rows
    assert rows[1].splitlines() == [f"| `{name}` | {p.what} | {p.source} |" for name, p in PRESETS.items()]


def test_readme_names_only_commands_that_exist() -> None:
    from uavsim.cli import app

    known = {command.callback.__name__ for command in app.registered_commands if command.callback}
    named = set(re.findall(r"`(?:\.venv/bin/)?uavsim ([a-z]+)", (ROOT / "README.md").read_text(encoding="utf-8")))
    assert named
    assert named <= known


def test_constraints_are_names_and_versions_and_hold_every_dependency() -> None:
    """No addresses in it; every dependency and every tool of the dev extra is frozen, within its lower bound."""
    lines = [line for line in (ROOT / "constraints.txt").read_text().splitlines() if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[0-9][A-Za-z0-9.]*", line) for line in lines)
    frozen = {re.sub(r"[-_.]+", "-", line.split("==")[0]).lower() for line in lines}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = [
        *project["build-system"]["requires"],
        *project["project"]["dependencies"],
        *(name for extra in project["project"]["optional-dependencies"].values() for name in extra),
    ]
    names = {re.sub(r"[-_.]+", "-", re.split(r"[<>=\[ ;]", entry)[0]).lower() for entry in wanted}
    assert all(">=" in entry for entry in wanted)
    assert names <= frozen
