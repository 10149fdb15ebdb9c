"""What a sweep varies: `KEY=VALUES` read, and the grid of cells that it makes.

    a,b,c          values as TOML has them, quotes may be left out: 0.5,1,2   px4,inav   [0,0,1],[0,0,2]
    from:to:n      n values, evenly spaced, both ends among them: 0:2:9
    0.5x,1x,2x     factors of the scenario's own value; a list of numbers is multiplied number by number
    0.5x:2x:4      n factors, evenly spaced

A cell is one value of each key; the first key changes slowest. Every cell is checked as a scenario before anything
flies.
"""

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from sensors.choice import shown
from uavsim import settings
from uavsim.plants.air.weather import PRESETS
from uavsim.scenario import OPTIONS, PROPERTIES, WEATHER, Scenario, keys, value_of_text, with_kinds

MOST_CELLS = 1000
KINDS = ("detector.kind", "estimator.kind", "plant.kind")
NEVER = ("seed", "index", "name", "description", "plugins", "requirements", "expect", "dispersions", "correlations")
"""Keys that say which flight it is, or how it is judged, and not what flies."""

_ENTRY = re.compile(r"(.+)\[([0-9]{1,3})\]")
_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_FACTOR = re.compile(rf"({_NUMBER})x")
_RANGE = re.compile(rf"({_NUMBER})(x?):({_NUMBER})(x?)(?::(.*))?")

Cell = dict[str, Any]
"""A value of each varied key."""


@dataclass(frozen=True, slots=True)
class Varied:
    """A key and the values that it takes, in the order in which they were given.

    Attributes
    ----------
    key
        Of the scenario, joined by dots.
    choices
        Plain values, as TOML has them.
    """

    key: str
    choices: tuple[Any, ...]

    @property
    def numeric(self) -> bool:
        """Whether all values are numbers, so that there is a line from one to the next."""
        return all(_is_number(value) for value in self.choices)

    @property
    def labels(self) -> tuple[Any, ...]:
        """What a table's column `vary.KEY` holds of each."""
        return labels(self.choices)


def labels(values: Sequence[Any]) -> tuple[Any, ...]:
    """Return values as one column of a table can hold them: numbers, true and false as they are, all others as text."""
    if all(_is_number(value) for value in values):
        return tuple(float(value) for value in values)
    if all(isinstance(value, bool) for value in values):
        return tuple(values)
    return tuple(as_text(value) for value in values)


def as_text(value: Any) -> str:
    """Write a value as a person would: text without quotes, all else as JSON has it."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def parse(scenario: Scenario, text: str) -> Varied:
    """Read `KEY=VALUES`.

    Raises
    ------
    ValueError
        One line: the key is unknown (with the nearest one that is), or what is wrong with its values.
    """
    key, equals, values = (part.strip() for part in text.partition("="))
    if not equals or not key or not values:
        raise ValueError(f"{shown(text)}: give it as KEY=VALUES, as in air_data.total.noise_scale=0.5,1,2")
    _check_key(scenario, key)
    own = _own(scenario, key)
    found = _range(key, values, own) or _listed(key, values, own)
    return varied(scenario, key, found)


def varied(scenario: Scenario, key: str, values: Iterable[Any]) -> Varied:
    """Return a key with values that were given as such, as in Python.

    Raises
    ------
    ValueError
        One line, as of `parse`; also for a text or a number in place of a list of values.
    """
    _check_key(scenario, key)
    if isinstance(values, str | Mapping) or not isinstance(values, Iterable):
        raise ValueError(f"{key}: give a list of values, not {shown(values)}")  # noqa: TRY004 (the user's)
    found = tuple(_whole(key, _plain(value)) for value in values)
    if not found:
        raise ValueError(f"{key}: there is no value in it")
    for i, one in enumerate(found):
        if any(one == other and isinstance(one, bool) is isinstance(other, bool) for other in found[:i]):
            raise ValueError(f"{key}: {_short(as_text(one))} is there twice")
    _check_dispersed(scenario, key)
    return Varied(key, found)


def cells(scenario: Scenario, varies: Sequence[Varied], most: int = MOST_CELLS) -> tuple[Cell, ...]:
    """Return every combination of the values, and see that each can be flown.

    Raises
    ------
    ValueError
        One line: nothing is varied, a key is varied twice, there are too many cells, or which cell cannot be, and why.
    """
    if not varies:
        raise ValueError("nothing is varied; give --vary KEY=VALUES")
    names = [one.key for one in varies]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise ValueError(f"{name} is varied twice")
    count = math.prod(len(one.choices) for one in varies)
    if count > most:
        sizes = " × ".join(str(len(one.choices)) for one in varies)
        raise ValueError(f"{sizes} = {count} cells; {most} are the most")
    found = tuple(dict(zip(names, values, strict=True)) for values in product(*(one.choices for one in varies)))
    for i, cell in enumerate(found):
        applied(scenario, cell, f"cell {i + 1} of {count} ({told(cell)})")
    return found


def told(cell: Cell) -> str:
    """Name a cell in words."""
    return ", ".join(f"{key}={_short(as_text(value))}" for key, value in cell.items())


def own_values(scenario: Scenario, varies: Sequence[Varied]) -> Cell:
    """What the scenario itself has for the keys that are varied; None where it has nothing."""
    return {one.key: _own(scenario, one.key) for one in varies}


def applied(scenario: Scenario, cell: Cell, where: str = "") -> Scenario:
    """The same scenario with the values of a cell.

    A kind brings its own settings and leaves those of the former behind; a weather brings all that its name says.

    Raises
    ------
    ValueError
        One line that begins with `where` and names the key and what is allowed.
    """
    head = f"{where}: " if where else ""
    chosen = {key.partition(".")[0]: cell[key] for key in KINDS if key in cell}
    try:
        for what, kind in chosen.items():
            scenario = with_kinds(scenario, **{what: as_text(kind)})
    except ValueError as error:
        raise ValueError(head + str(error).removeprefix(f"{scenario.name}: ")) from None
    values = scenario.to_dict()
    if WEATHER in cell:
        _take_weather(values["environment"], cell[WEATHER])
    for key, value in cell.items():
        if key not in KINDS:
            values = _put(values, _path(key), value)
    return Scenario.from_dict(values, where or scenario.name)


# -- keys ------------------------------------------------------------------------------------------------------------


def _check_key(scenario: Scenario, key: str) -> None:
    """Refuse a key that no scenario has, and one that does not say what flies."""
    if key.startswith((PROPERTIES, *OPTIONS)):  # an aircraft, or a plug-in, knows them
        return
    whole, entry = _entry(key)
    if whole not in keys():
        raise ValueError(settings.unknown(Scenario, whole).problem)
    if whole.partition(".")[0] in NEVER:
        raise ValueError(f"{key}: says which flight it is or how it is judged; it cannot be varied")
    if entry is not None:
        own = _own(scenario, whole)
        if not isinstance(own, list) or entry >= len(own):
            has = f"has {len(own)} entries" if isinstance(own, list) else "is no list"
            raise ValueError(f"{key}: there is no such entry; {whole} {has} in the scenario")


def _entry(key: str) -> tuple[str, int | None]:
    """Return a key without the number of an entry of its list, and that number."""
    match = _ENTRY.fullmatch(key)
    return (match[1], int(match[2])) if match and not key.startswith(PROPERTIES) else (key, None)


def _hint(key: str) -> Any:
    """Declared type of a key; None of what an aircraft or a plug-in knows, and of an entry of a list."""
    if key.startswith((PROPERTIES, *OPTIONS)) or _entry(key)[1] is not None:
        return None
    hint = settings.hint_of(Scenario, key)
    return getattr(hint, "__origin__", hint)


def _check_dispersed(scenario: Scenario, key: str) -> None:
    """Refuse a key whose value a dispersion draws over; one around the key's own value goes with what is varied."""
    for one in scenario.dispersions:
        around = one.relative or ("normal" in one.distribution and one.mean is None)
        apart = "[" in one.key and "[" in key and one.key != key  # another entry of the same list
        if _entry(one.key)[0] == _entry(key)[0] and not around and not apart:
            raise ValueError(
                f"{key}: is drawn anew for each flight by a dispersion of {scenario.name}, which would hide what is "
                "varied; take the dispersion out, or make it relative = true"
            )


def _path(key: str) -> list[str | int]:
    """Return the names of a key from the outside in; a property's own name may hold dots."""
    if key.startswith(PROPERTIES):
        return [*PROPERTIES.split(".")[:2], key.removeprefix(PROPERTIES)]
    whole, entry = _entry(key)
    return [*whole.split("."), *(() if entry is None else (entry,))]


def _own(scenario: Scenario, key: str) -> Any:
    """Return the scenario's own value of a key as a plain one; None if it has none."""
    group: Any = _plain(scenario.to_dict())
    for part in _path(key):
        if isinstance(part, int):
            group = group[part] if isinstance(group, list) and part < len(group) else None
        else:
            group = group.get(part) if isinstance(group, Mapping) else None
    return group


def _put(values: Any, path: list[str | int], value: Any) -> Any:
    """Return plain values with another one at a path; groups on the way that are not there are made."""
    if not path:
        return value
    name, *rest = path
    if isinstance(name, int):
        return [_put(item, rest, value) if i == name else item for i, item in enumerate(values)]
    group = dict(values) if isinstance(values, Mapping) else {}
    group[name] = _put(group.get(name), rest, value)
    return group


def _take_weather(air: dict[str, Any], name: Any) -> None:
    """Take out what the former weather said by its name, and what the new one will say."""
    before = PRESETS[air["preset"]].keys if air.get("preset") in PRESETS else {}
    said = PRESETS[name].keys if name in PRESETS else {}
    for key in list(air):
        if key in said or (key in before and _plain(air[key]) == _plain(before[key])):
            del air[key]


# -- values ----------------------------------------------------------------------------------------------------------


def _range(key: str, text: str, own: Any) -> list[Any] | None:
    """Return the values of `from:to:n`; None if it is not written so."""
    match = _RANGE.fullmatch(text)
    if match is None:
        return None
    first, last = float(match[1]), float(match[3])
    if match[5] is None or not re.fullmatch(r"[0-9]{1,9}", match[5].strip()):
        raise ValueError(f"{key}={text}: give a range as from:to:n, as in 0:2:9")
    if bool(match[2]) != bool(match[4]):
        raise ValueError(f"{key}={text}: both ends are factors, or none is")
    count = int(match[5])
    if count < 2:
        raise ValueError(f"{key}={text}: a range has 2 values or more, not {count}")
    if count > MOST_CELLS:
        raise ValueError(f"{key}={text}: {count} values; {MOST_CELLS} are the most")
    if not first < last:
        why = "is empty" if first == last else "is reversed"
        raise ValueError(f"{key}={text}: the range {why}; its first value must be below its last")
    step = (last - first) / (count - 1)
    found: list[Any] = [float(f"{first + i * step:.12g}") for i in range(count)]
    return [_multiplied(key, own, factor) for factor in found] if match[2] else found


def _listed(key: str, text: str, own: Any) -> list[Any]:
    """Return the values of `a,b,c` or of `0.5x,1x,2x`."""
    parts = _split(key, text)
    factors = [_FACTOR.fullmatch(part) for part in parts]
    if any(factors):
        if not all(factors):
            raise ValueError(f"{key}={text}: all values are factors, such as 0.5x, or none is")
        return [_multiplied(key, own, float(factor[1])) for factor in factors if factor]
    is_text = _hint(key) is str
    found = [value_of_text(part) for part in parts]
    return [part if is_text and not isinstance(value, str) else value for part, value in zip(parts, found, strict=True)]


def _split(key: str, text: str) -> list[str]:
    """Cut at the commas that stand outside brackets and quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        elif letter in "[{":
            depth += 1
        elif letter in "]}":
            depth -= 1
        if letter == "," and not depth and not quote:
            parts.append("")
        else:
            parts[-1] += letter
        if depth < 0:
            break
    if depth or quote:
        raise ValueError(f"{key}={_short(text)}: a bracket or a quote is not closed, or not opened")
    parts = [part.strip() for part in parts]
    if not all(parts):
        raise ValueError(f"{key}={_short(text)}: a value between commas is empty; for an empty text write ''")
    return parts


def _multiplied(key: str, own: Any, factor: float) -> Any:
    """Return a factor of the scenario's own value."""
    if own is None:
        raise ValueError(f"{key}: the scenario sets no value, so that there is nothing to take a factor of")
    if _is_number(own):
        if own == 0:
            raise ValueError(f"{key}: is 0 in the scenario, and so is every factor of it; give values")
        found = float(f"{own * factor:.12g}")
        return int(found) if isinstance(own, int) and found.is_integer() else found
    if isinstance(own, list) and own and all(map(_is_numeric, own)):
        return [_multiplied_inside(item, factor) for item in own]
    raise ValueError(f"{key}: is {_short(as_text(own))} in the scenario, of which there are no factors; give values")


def _multiplied_inside(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [_multiplied_inside(item, factor) for item in value]
    return float(f"{value * factor:.12g}")


def _whole(key: str, value: Any) -> Any:
    """Return a whole number for a key that takes no other, where the value is one."""
    return int(value) if isinstance(value, float) and value.is_integer() and _hint(key) is int else value


def _plain(value: Any) -> Any:
    """Return a value as TOML has it: lists for tuples and arrays, Python's own numbers."""
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_numeric(value: Any) -> bool:
    return _is_number(value) or (isinstance(value, list) and bool(value) and all(map(_is_numeric, value)))


def _short(text: str, longest: int = 60) -> str:
    return text if len(text) <= longest else f"{text[: longest - 1]}…"
