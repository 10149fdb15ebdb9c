"""The pages on sweeps and sensitivity: what they show runs, and numbers that stand in them are those of the code."""

import re
from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from uavsim.cli import app
from uavsim.scenario import load_scenario
from uavsim.studies.campaign.crossing import FEWEST_LOGISTIC, fewest
from uavsim.studies.campaign.sensitivity import LEAST_BASES, LEAST_TRAJECTORIES, LEFT_OUT
from uavsim.studies.campaign.vary import MOST_CELLS

DOCS = Path(__file__).resolve().parent.parent / "docs"
SWEEP, SENSITIVITY = ((DOCS / f"{name}.md").read_text(encoding="utf-8") for name in ("sweep", "sensitivity"))


def test_the_example_in_python_runs() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", SWEEP, re.DOTALL)
    names: dict[str, Any] = {}
    exec(code, names)  # the page is ours
    assert len(names["found"].runs) == 4


def test_the_error_that_is_shown_is_the_one_that_comes() -> None:
    result = CliRunner().invoke(app, ["sweep", "catapult", "--vary", "launcher.stroke=5,99", "--runs", "1"])
    (shown,) = re.findall(r"`(cell 2 of 2 .*?)`", SWEEP)
    assert shown in str(result.exception)


def test_numbers_are_those_of_the_code() -> None:
    assert f"at w = 0.95 by {fewest(0.95)} flights" in SWEEP
    assert f"at 0.9 by {fewest(0.9)}, at 0.5 by {fewest(0.5)}" in SWEEP
    assert f"at most {MOST_CELLS} cells" in SWEEP
    assert f"fewer than {FEWEST_LOGISTIC} flights a cell" in SWEEP
    assert f"N at least {LEAST_BASES}" in SENSITIVITY
    assert f"r at least {LEAST_TRAJECTORIES}" in SENSITIVITY
    assert f"up to {100 * LEFT_OUT:g} % of them" in SENSITIVITY


def test_scenarios_that_are_flown_there_exist_and_what_is_varied_can_be() -> None:
    """Of every command that is shown, without a plug-in of one's own."""
    from uavsim.studies.campaign.vary import cells, parse

    for name, rest in re.findall(r"^uavsim sweep (\S+) (.*)$", SWEEP, re.MULTILINE):
        scenario = load_scenario(name)
        texts = re.findall(r'--vary (?:"(.*?)"|(\S+))', rest)
        assert cells(scenario, [parse(scenario, quoted or plain) for quoted, plain in texts])
