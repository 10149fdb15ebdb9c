"""A number of a part's description, declared once: its key in a preset's file, its unit, its bounds, its factor.

    bias_sd: Triple = term("offset_mg", OFFSET_MG, milli_g, factor="bias")
    cross_axis_sd: float = term("cross_axis_percent", CROSS_AXIS, percent, factor="cross_axis", default=0.0)

A term with a default is optional: a file that lacks it, such as one that was written before the term was known, has
that default, which is an error of 0, or no bound. All others are required. `factor` names the field of the errors'
settings that scales the term.
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from math import isinf
from typing import Any

from sensors.rules import Rule


@dataclass(frozen=True, slots=True)
class Term:
    """Of one field of a description.

    Attributes
    ----------
    key : str
        In the table [values] of a preset's file.
    rule : Rule
        What may stand there.
    read : callable
        What it is in SI.
    factor : str
        Name of its factor in the errors' settings; "" has none.
    """

    key: str
    rule: Rule
    read: Callable[[Any], Any]
    factor: str


def term(key: str, rule: Rule, read: Callable[[Any], Any] = float, *, factor: str = "", default: Any = MISSING) -> Any:
    """Return the field of a description for a term; see `Term`. With a default it is optional."""
    return field(default=default, metadata={"term": Term(key, rule, read, factor)})


def percent(value: float) -> float:
    """Return a fraction."""
    return value / 100


def terms(kind: type[Any]) -> dict[str, Term]:
    """Return the terms of a description, by the names of their fields."""
    return {f.name: f.metadata["term"] for f in fields(kind) if "term" in f.metadata}


def rules(kind: type[Any]) -> dict[str, Rule]:
    """Return what may stand in a file, by key."""
    return {one.key: one.rule for one in terms(kind).values()}


def optional(kind: type[Any]) -> set[str]:
    """Return the keys that a file may lack."""
    return {f.metadata["term"].key for f in fields(kind) if "term" in f.metadata and f.default is not MISSING}


def read(kind: type[Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a description that a file tells, SI."""
    return {name: one.read(values[one.key]) for name, one in terms(kind).items() if one.key in values}


def scaled(description: Any, errors: Any) -> dict[str, Any]:
    """Return the fields of a description that have a factor, times that factor."""
    return {
        name: _times(getattr(description, name), getattr(errors, one.factor))
        for name, one in terms(type(description)).items()
        if one.factor
    }


def _times(value: Any, factor: float) -> Any:
    """Return a number or a tuple of them times a factor; no bound times 0 is 0."""
    if isinstance(value, tuple):
        return tuple(_times(one, factor) for one in value)
    return 0.0 if isinf(value) and factor == 0.0 else value * factor
