"""Verdicts that are kept beside the docs: small files in JSON, and the tables that the docs show of them.

A page holds blocks

    <!-- certify: SET WHAT -->
    …
    <!-- end -->

whose inside is made of `docs/results/SET.json`: WHAT is `checks`, the name of one of its tables, or `levels` of the
healthy set, three numbers a cell for stroke, transition and cruise. `python scripts/certify.py --docs` writes them
anew; a test holds the page against the files.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from uavsim.score_keys import PHASES
from uavsim.studies.certify.verdict import Check, lines, table

BLOCK = re.compile(r"<!-- certify: ([\w-]+) ([\w -]+?) -->\n.*?<!-- end -->", re.DOTALL)
COMPACT = ("coverage", "coverage_all", "valid", "sd", "rmse", "to_bound")


def read(folder: Path, name: str) -> dict[str, Any] | None:
    """Return a verdict that was written, None if there is none."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def refreshed(page: str, folder: Path) -> str:
    """Return a page with its blocks made anew of the verdicts in a folder; one that is not there is said.

    Raises
    ------
    ValueError
        A block names a table that its verdict does not have.
    """

    def made(block: re.Match[str]) -> str:
        name, what = block.groups()
        result = read(folder, name)
        inside = shown(result, what) if result is not None else [f"`{name}` has not been flown with this version."]
        return "\n".join([f"<!-- certify: {name} {what} -->", *inside, "<!-- end -->"])

    return BLOCK.sub(made, page)


def shown(result: Mapping[str, Any], what: str) -> list[str]:
    """Return a block's lines: who flew it, and its table."""
    if what == "checks":
        said = f"{result['flights']} flights, seed {result['seed']}, revision {result['revision']}: "
        return [f"{said}`{result['command']}`", "", *lines([Check(**one) for one in result["checks"]])]
    if what not in result["tables"]:
        raise ValueError(f"{result['set']} has no table {what!r}; there are checks, {', '.join(result['tables'])}")
    rows = result["tables"][what]
    return table([compact(row) for row in rows] if what == "levels" and f"{PHASES[0]}.sd" in rows[0] else rows)


def compact(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a level's row with one cell a figure, for stroke, transition and cruise."""
    found = {key: value for key, value in row.items() if "." not in key}
    for key in COMPACT:
        values = [row.get(f"{phase}.{key}") for phase in PHASES]
        found[key] = " / ".join("–" if value is None else f"{value:.3g}" for value in values)
    return found
