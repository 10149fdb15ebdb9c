"""Whether a table's rows are what JSBSim's reader takes for granted: as many numbers as its axes ask for, rising keys.

One axis: rows of key and value. Two: the columns' keys, then rows of a key and as many values. Three: several of those,
each with the third key in ``breakPoint``.
"""

import re
from itertools import pairwise
from math import isfinite

from uavsim.plants.airframe.markup import Element, MarkupError

MOST_ROWS = 1000  # JSBSim's longest has 213; it takes a time that grows as their square
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
GREATEST = 1e30  # no quantity of an aircraft is greater, in any unit


def number(text: str) -> float | None:
    """Return the number that a text is; None if it is none, or one that no quantity has."""
    if len(text) > 60 or NUMBER.fullmatch(text) is None:
        return None
    value = float(text)
    return value if isfinite(value) and abs(value) <= GREATEST else None


def check_table(table: Element) -> None:
    """Refuse a table that is none.

    Raises
    ------
    MarkupError
        One line.
    """
    data = [child for child in table.children if child.tag == "tableData"]
    axes = _axes(table)
    rows = [_rows(part) for part in data]
    if axes == 3 or (not axes and len(data) > 1):
        keys = [number(part.attributes.get("breakPoint", part.attributes.get("breakpoint", ""))) for part in data]
        if None in keys:
            raise MarkupError("<tableData>: each of several needs a breakPoint, a number", data[0].line)
        _check_rising([key for key in keys if key is not None], data[0].line, "breakPoint")
        for part, lines in zip(data, rows, strict=True):
            _check_two(lines, part.line)
    elif len(data) != 1:
        raise MarkupError(f"<table>: {axes} independentVar need one tableData", table.line)
    elif axes == 2 or (not axes and len(rows[0][-1]) != 2):
        _check_two(rows[0], data[0].line)
    else:
        _check_one(rows[0], data[0].line)


def check_traverse(traverse: Element) -> None:
    """Refuse a kinematic's settings that do not rise, or take negative times: JSBSim would search them for ever."""
    settings = [child for child in traverse.children if child.tag == "setting"]
    places = [_value(setting, "position") for setting in settings]
    _check_rising(places, traverse.line, "position", tag="traverse")
    if any(_value(setting, "time") < 0.0 for setting in settings):
        raise MarkupError("<traverse>: a time is negative", traverse.line)


def _value(element: Element, tag: str) -> float:
    child = element.find(tag)
    found = None if child is None else number(child.text)
    assert found is not None  # the grammar needs it
    return found


def _axes(table: Element) -> int:
    """Return how many axes a table names: rows, then columns, then tables."""
    axes = [child.attributes.get("lookup", "row") for child in table.children if child.tag == "independentVar"]
    if sorted(axes) != sorted(("row", "column", "table")[: len(axes)]):
        raise MarkupError(
            f"<table>: looked up by {', '.join(axes)[:60]}; allowed: row, column, table, in turn", table.line
        )
    if not axes and table.attributes.get("type") != "internal":
        raise MarkupError('<table>: needs an independentVar, or type="internal"', table.line)
    return len(axes)


def _rows(data: Element) -> list[list[float]]:
    lines = [line.split() for line in data.text.splitlines() if line.strip()]
    if not 1 <= len(lines) <= MOST_ROWS:
        raise MarkupError(f"<tableData>: has {len(lines)} rows; from 1 to {MOST_ROWS} are allowed", data.line)
    rows = []
    for line in lines:
        values = [number(word) for word in line]
        if None in values:
            wrong = line[values.index(None)]
            raise MarkupError(f"<tableData>: {wrong[:40]!r} is no number", data.line)
        rows.append([value for value in values if value is not None])
    return rows


def _check_one(rows: list[list[float]], line: int) -> None:
    if len(rows) < 2 or any(len(row) != 2 for row in rows):
        raise MarkupError("<tableData>: one axis needs at least two rows of two numbers", line)
    _check_rising([row[0] for row in rows], line, "key")


def _check_two(rows: list[list[float]], line: int) -> None:
    columns, *body = rows
    if len(columns) < 2 or len(body) < 2 or any(len(row) != len(columns) + 1 for row in body):
        raise MarkupError(
            "<tableData>: two axes need a row of at least two keys, then rows of a key and a value for each",
            line,
        )
    _check_rising(columns, line, "column")
    _check_rising([row[0] for row in body], line, "key")


def _check_rising(keys: list[float], line: int, what: str, tag: str = "tableData") -> None:
    if any(after <= before for before, after in pairwise(keys)):
        raise MarkupError(f"<{tag}>: each {what} must be above the one before", line)
