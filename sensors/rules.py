"""What a number of a preset's file may be: rules for one value, which say in one line what is wrong with it."""

from collections.abc import Callable
from itertools import pairwise
from math import inf
from typing import Any

Rule = Callable[[str, Any], None]

HUGE = 1e15  # no part has such a number, in any of the units
ENTRIES = 100  # of a list: a part has up to 15 ranges, rates, filters or modes


def number(low: float = -inf, high: float = inf, *, above: float = -inf) -> Rule:
    """Return the rule for a finite number with low ≤ number ≤ high and number > above."""

    def rule(where: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise _not("a number", where, value)
        if not abs(value) <= HUGE:  # NaN is not either
            raise ValueError(f"key {where} must be a finite number, up to {min(high, HUGE):g}")
        if value <= above:
            raise ValueError(f"key {where} is {value:g}; it must be above {above:g}")
        if not low <= value <= high:
            bounds = f"at least {low:g}" if high == inf else f"{low:g} to {high:g}"
            raise ValueError(f"key {where} is {value:g}; it must be {bounds}")

    return rule


def whole(low: int, high: int) -> Rule:
    """Return the rule for a whole number with low ≤ number ≤ high."""

    def rule(where: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, int):
            raise _not("a whole number", where, value)
        number(low, high)(where, value)

    return rule


def text(longest: int) -> Rule:
    """Return the rule for a text that says something, in at most `longest` characters."""

    def rule(where: str, value: Any) -> None:
        if not isinstance(value, str):
            raise _not("text", where, value)
        if not value.strip():
            raise ValueError(f"key {where} is empty")
        if len(value) > longest:
            raise ValueError(f"key {where} has {len(value)} characters; it must have {longest} at most")

    return rule


def listed(item: Rule, *, count: int | None = None, rising: bool = False) -> Rule:
    """Return the rule for a list of such items, of this length (else of 1 to 100), each above the one before it."""

    def rule(where: str, value: Any) -> None:
        if not isinstance(value, list):
            raise _not("a list", where, value)
        if not value:
            raise ValueError(f"key {where} is an empty list")
        if count is not None and len(value) != count:
            raise ValueError(f"key {where} must be a list of {count}, not of {len(value)}")
        if len(value) > ENTRIES:
            raise ValueError(f"key {where} is a list of {len(value)}; it must be one of {ENTRIES} at most")
        for index, entry in enumerate(value):
            item(f"{where}[{index}]", entry)
        if rising and any(after <= before for before, after in pairwise(value)):
            raise ValueError(f"key {where} must rise from each to the next")

    return rule


def table(where: str, value: Any) -> None:
    """Check that a value is a table."""
    if not isinstance(value, dict):
        raise _not("a table", where, value)


def _not(wanted: str, where: str, value: Any) -> ValueError:
    names = {bool: "true or false", str: "text", list: "a list", dict: "a table", float: "a number with a fraction"}
    given = names.get(type(value), "a number" if isinstance(value, int) else "a date or time")
    return ValueError(f"key {where} must be {wanted}, not {given}")
