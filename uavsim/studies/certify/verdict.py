"""What a set is asked and whether it is met, as plain data that becomes JSON and a table."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Check:
    """One question.

    Attributes
    ----------
    name : str
        What is asked.
    wanted, found : str
        As people write them.
    met : bool or None
        None: not decided, for want of flights or of something to compare with.
    note : str
        What explains it.
    """

    name: str
    wanted: str
    found: str
    met: bool | None
    note: str = ""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a set.

    Attributes
    ----------
    checks : tuple of Check
    tables : dict
        Rows of figures by the name of their table.
    worst : list of dict
        Flights to look at: what is wrong with each, and the command that flies it.
    """

    checks: tuple[Check, ...]
    tables: dict[str, list[dict[str, Any]]]
    worst: list[dict[str, Any]]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; numbers of tables have five digits, as what comes of a sample has no more."""
        tables = {name: [_short(row) for row in rows] for name, rows in self.tables.items()}
        return {"checks": [asdict(one) for one in self.checks], "tables": tables, "worst": self.worst}


def _short(row: dict[str, Any]) -> dict[str, Any]:
    return {key: float(f"{value:.5g}") if isinstance(value, float) else value for key, value in row.items()}


def lines(checks: Sequence[Check]) -> list[str]:
    """Return checks as lines of a Markdown table."""
    told = {True: "met", False: "**not met**", None: "undecided"}
    rows = [f"| {one.name} | {one.wanted} | {one.found} | {told[one.met]} |" for one in checks]
    return ["| asked | bound | found | verdict |", "|---|---|---|---|", *rows]


def table(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Return rows of figures as lines of a Markdown table; the first row's keys are the columns."""
    if not rows:
        return []
    keys = list(rows[0])
    body = [f"| {' | '.join(_cell(row.get(key)) for key in keys)} |" for row in rows]
    return [f"| {' | '.join(keys)} |", f"|{'---|' * len(keys)}", *body]


def _cell(value: Any) -> str:
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
