"""Each import contract of pyproject.toml can fail: a module that is new breaks it, and it alone.

The packages' sources are copied, one new file is put into a room, import-linter reads the copy. What the contracts do
not name is thereby held, too: none of them knows the newcomer.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
LINT = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CONTRACTS = [contract["name"] for contract in PROJECT["tool"]["importlinter"]["contracts"]]

FLOORS = "No import goes up a floor, and every module has its floor"
ONBOARD = "Onboard sees readings and time, never truth: of uavsim it knows air data, registry and failure"
PLANTS = "Plants know of uavsim the truth's names, air data, registry and failure"
NUMBA = "Loops are compiled in one place"
SENSORS = "Sensors know nothing of uavsim"
EQUATIONS = "Truth and air data are equations and names"
JSBSIM = "JSBSim only in its plant"
FILTERPY = "filterpy only where a filter of ours is held against it"
TYPER = "The command line is parsed in cli"
MATPLOTLIB = "Figures are drawn in views"
RICH = "Terminals are written to by views and cli"
PYDANTIC = "Settings are validated in one place"
DASK = "Work is spread over processes in one place"
XML = "XML of a stranger's aircraft is read in one place"

BREAKS = [
    ("uavsim/newcomer.py", "", {FLOORS}),  # a module at the top that has no floor
    ("uavsim/studies/newcomer.py", "import uavsim.views.text", {FLOORS}),
    ("uavsim/views/newcomer.py", "import uavsim.cli.common", {FLOORS}),
    ("uavsim/logs/newcomer.py", "def late():\n    from uavsim.studies import batch", {FLOORS}),
    ("uavsim/onboard/newcomer.py", "import sensors.noise", {ONBOARD}),
    ("uavsim/onboard/launch/newcomer.py", "import uavsim.truth", {ONBOARD}),
    ("uavsim/onboard/airspeed/newcomer.py", "def late():\n    import pandas", {ONBOARD}),
    ("uavsim/onboard/newcomer.py", "import uavsim.plants.rail", {ONBOARD, FLOORS}),
    ("uavsim/plants/newcomer.py", "from sensors import noise", {PLANTS}),
    ("uavsim/plants/airframe/newcomer.py", "import uavsim.files", {PLANTS}),
    ("uavsim/plants/newcomer.py", "import uavsim.onboard.stamps", {PLANTS, FLOORS}),
    ("sensors/newcomer.py", "import uavsim.airdata", {SENSORS}),
    ("sensors/newcomer.py", "from uavsim.truth import STANDARD_GRAVITY", {SENSORS}),
    ("uavsim/airdata/newcomer.py", "import uavsim.truth", {EQUATIONS, FLOORS}),
    ("uavsim/airdata/newcomer.py", "import scipy.special", {EQUATIONS}),
    ("uavsim/studies/newcomer.py", "import jsbsim", {JSBSIM}),
    ("uavsim/logs/newcomer.py", "from jsbsim import FGFDMExec", {JSBSIM}),
    ("uavsim/plants/newcomer.py", "import jsbsim", {JSBSIM}),
    ("uavsim/studies/newcomer.py", "import filterpy.kalman", {FILTERPY}),
    ("uavsim/onboard/launch/newcomer.py", "from numba import njit", {NUMBA}),
    ("uavsim/studies/newcomer.py", "def late():\n    import numba", {NUMBA}),
    ("uavsim/studies/campaign/newcomer.py", "def late():\n    import distributed", {DASK}),
    ("uavsim/cli/newcomer.py", "from dask import config", {DASK}),
    ("uavsim/views/newcomer.py", "import typer", {TYPER}),
    ("uavsim/studies/newcomer.py", "def late():\n    import matplotlib.figure", {MATPLOTLIB}),
    ("uavsim/studies/newcomer.py", "import rich.table", {RICH}),
    ("uavsim/logs/newcomer.py", "import pydantic", {PYDANTIC}),
    ("uavsim/plants/airframe/newcomer.py", "import defusedxml.ElementTree", {XML}),
]


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources and of pyproject.toml."""
    folder = tmp_path_factory.mktemp("tree")
    for package in ("uavsim", "sensors"):
        for source in (ROOT / package).rglob("*.py"):
            copy = folder / source.relative_to(ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    shutil.copyfile(ROOT / "pyproject.toml", folder / "pyproject.toml")
    return folder


def broken(tree: Path) -> set[str]:
    """Names of the contracts that import-linter finds broken in the tree."""
    command = [sys.executable, "-c", LINT, "--no-logo"]
    plain = os.environ | {"PYTHONPATH": str(tree), "COLUMNS": "400", "NO_COLOR": "1"}
    run = subprocess.run(command, check=False, cwd=tree, env=plain, capture_output=True, text=True)
    found = dict(re.findall(r"^(.+?) (KEPT|BROKEN)\b", run.stdout, re.MULTILINE))
    assert list(found) == CONTRACTS, run.stdout + run.stderr  # all of them were looked at
    assert run.returncode == ("BROKEN" in found.values())
    return {name for name, verdict in found.items() if verdict == "BROKEN"}


def test_the_tree_keeps_them_all(tree: Path) -> None:
    assert broken(tree) == set()


@pytest.mark.parametrize(
    ("file", "text", "contracts"),
    BREAKS,
    ids=lambda value: "" if isinstance(value, set) else value[:40].replace("\n", " "),
)
def test_a_newcomer_breaks(tree: Path, file: str, text: str, contracts: set[str]) -> None:
    newcomer = tree / file
    assert not newcomer.exists()
    newcomer.write_text(f'"""New."""\n\n{text}\n', encoding="utf-8")
    try:
        assert broken(tree) == contracts
    finally:
        newcomer.unlink()


def test_each_contract_is_broken_by_itself() -> None:
    """Those that also break the floors are seen alone elsewhere."""
    alone = {name for _, _, contracts in BREAKS for name in contracts if len(contracts) == 1}
    assert alone == set(CONTRACTS)
