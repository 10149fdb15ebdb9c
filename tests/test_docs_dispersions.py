"""The page on dispersions: its file is a scenario, its Python runs, its keys and distributions are those there are."""

import doctest
import re
import tomllib
from pathlib import Path
from typing import get_args

from uavsim.dispersions import keys, resolved
from uavsim.plants.varied import BALLAST, FACTORS
from uavsim.scenario import Scenario
from uavsim.scenario import keys as known
from uavsim.spread.settings import Kind

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "dispersions.md").read_text(encoding="utf-8")


def test_its_file_is_a_scenario_that_can_be_drawn() -> None:
    (block,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    scenario = Scenario.from_dict(tomllib.loads(block))
    assert len(keys(scenario)) == 5
    flown = [resolved(scenario, i) for i in range(10)]
    assert len({s.aircraft.mass_factor for s in flown}) == 10


def test_its_python_gives_what_it_says() -> None:
    tests = doctest.DocTestParser().get_doctest(PAGE, {}, "dispersions.md", "dispersions.md", 0)
    assert len(tests.examples) > 8
    assert doctest.DocTestRunner().run(tests).failed == 0


def test_it_has_every_distribution_and_everything_an_aircraft_may_differ_by() -> None:
    assert [name for name in get_args(Kind) if f"| `{name}` |" not in PAGE] == []
    varied = [key for key in known() if re.fullmatch(r"aircraft\.\w+_(factor|shift)|launcher\.force_factor", key)]
    assert len(varied) == 7
    assert [key for key in varied if f"`{key}`" not in PAGE] == []
    assert [name for name in (*FACTORS.values(), *BALLAST) if f"`{name}`" not in PAGE] == []
