"""Settings from plain values, as a TOML file or a command line gives them, checked against their declarations.

Settings are frozen dataclasses whose fields carry their bounds (`typing.Annotated`). Every key must be known, every
value of the declared type and within its bounds; nothing is converted silently but whole numbers to numbers and lists
to tuples. Whatever is wrong becomes one line that names the key, the value and what is allowed.

Beside the bounds that stand with each setting these hold for all of them: a number is 0 or from 1e-30 to 1e15 in
magnitude, so that no product, square or ratio of a few of them overflows; a list has at most 1000 entries, a list of
groups 100, and a text 4096 characters.
"""

import json
import types
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from itertools import takewhile
from math import isfinite
from numbers import Integral, Real
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from sensors.choice import nearest, shown

if TYPE_CHECKING:
    from pydantic import TypeAdapter

T = TypeVar("T")
Path = tuple[Any, ...]
"""Keys, and numbers of entries of a list, from the outside in."""

LARGEST = 2**63 - 1  # TOML 1.0: whole numbers have 64 bits
SMALLEST_NUMBER, LARGEST_NUMBER = 1e-30, 1e15  # of a number with a fraction, unless it is 0
MOST_ENTRIES = 1000  # of a list of numbers; a power spectral density has some tens of points
MOST_GROUPS = 100  # of a list of groups, or of names with a number: each fault is asked about each reading
LONGEST_TEXT = 4096  # characters; a path has no more
DEEPEST = 16  # lists and groups within one another

_WORDS = {float: "a number", int: "a whole number", str: "text", bool: "true or false"}


class SettingError(Exception):
    """A setting that cannot be.

    Attributes
    ----------
    problem
        One line: key, value, what is allowed.
    keys
        The keys concerned, joined by dots; several where they do not fit together.
    """

    def __init__(self, problem: str, *keys: str) -> None:
        super().__init__(problem)
        self.problem = " ".join(problem.split())
        self.keys = keys


class _OddError(Exception):
    """Something that neither a number, nor text, nor a list, nor a group is, at a path."""


def read(kind: type[T], values: Mapping[str, Any]) -> T:
    """Make settings from nested plain values; keys that are left out keep their defaults.

    Raises
    ------
    SettingError
        On the first thing that is wrong.
    """
    from pydantic import ValidationError

    declared: Any = kind
    _check_keys(values, declared, kind, "")
    try:
        plain = _plain(values, ())
    except _OddError as odd:
        raise _blame(kind, values, odd.args) from None
    try:
        # As JSON, because pydantic's strictness then takes a list for a tuple, but neither "3" nor true for a number.
        found: T = _adapter(declared).validate_json(json.dumps(plain), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        if not first["loc"]:  # the settings' own check
            raise SettingError(first["msg"].removeprefix("Value error, ")) from None
        raise _blame(kind, plain, first["loc"]) from None
    return found


def read_value(hint: Any, key: str, value: Any) -> Any:
    """Return a value of one key as it is declared.

    Raises
    ------
    SettingError
        It is of another type or out of its bounds.
    """
    from pydantic import ValidationError

    try:
        return _adapter(hint).validate_json(json.dumps(_plain(value, ())), strict=True)
    except (_OddError, ValidationError):
        raise SettingError(f"{key} = {shown(value)}: must be {_allowed(hint)}{_remark(hint, value)}", key) from None


def keys(kind: Any, prefix: str = "") -> list[str]:
    """Every key of nested settings, joined by dots."""
    found: list[str] = []
    for name, hint in hints(kind).items():
        found += keys(hint, f"{prefix}{name}.") if _is_group(hint) else [prefix + name]
    return found


@cache
def hints(kind: Any) -> dict[str, Any]:
    """Types of a dataclass's fields, with their bounds."""
    found = get_type_hints(kind, include_extras=True)
    return {f.name: found[f.name] for f in fields(kind)}


def hint_of(kind: type, key: str) -> Any:
    """Declared type of a key that exists."""
    hint: Any = kind
    for part in key.split("."):
        hint = hints(hint)[part]
    return hint


def unknown(kind: type, key: str) -> SettingError:
    """Tell that a key does not exist, and the nearest one that does."""
    known = keys(kind)
    inside = [k.removeprefix(f"{key}.") for k in known if k.startswith(f"{key}.")]
    if inside:
        return SettingError(f"{key} is a group; its keys are {', '.join(inside)}", key)
    last = key.rpartition(".")[2]
    names = {k if "." in key else k.rpartition(".")[2]: k for k in reversed(known)}
    near = names.get(nearest(key, names) or "")
    near = near or next((k for k in known if k.rpartition(".")[2] == last), None)  # a right name in a wrong group
    hint = f"did you mean {near!r}?" if near else f"there are {', '.join(hints(kind))}"
    return SettingError(f"unknown key {shown(key)}; {hint}", key)


# -- from the outside in ---------------------------------------------------------------------------------------------


@cache
def _adapter(kind: Any) -> "TypeAdapter[Any]":
    from pydantic import TypeAdapter

    return TypeAdapter(kind)


def _is_group(hint: Any) -> bool:
    return is_dataclass(hint)


def _check_keys(values: Mapping[str, Any], kind: Any, root: type, prefix: str) -> None:
    """Refuse keys that nobody declared: pydantic would pass over them."""
    for name, value in values.items():
        key = f"{prefix}{name}"
        if name not in hints(kind):
            raise unknown(root, key)
        hint = hints(kind)[name]
        entry = _entry(hint)
        if _is_group(hint):
            if not isinstance(value, Mapping):
                raise SettingError(f"{key} = {shown(value)}: must be a group of keys, not a value", key)
            _check_keys(value, hint, root, f"{key}.")
        elif _is_group(entry) and isinstance(value, list | tuple):
            for i, item in enumerate(value):
                _check_entry(item, entry, key, f"{key}[{i}]")


def _check_entry(item: Any, kind: Any, key: str, where: str) -> None:
    """Refuse keys that nobody declared in one of a list of groups."""
    names = list(hints(kind))
    if not isinstance(item, Mapping):
        raise SettingError(f"{where} = {shown(item)}: must be {_allowed(kind)}", key)
    for name in item:
        if name not in names:
            near = nearest(str(name), names, cutoff=0.0)
            raise SettingError(f"unknown key {shown(name)} in {where}; did you mean {near!r}?", key)


def _plain(value: Any, path: Path) -> Any:
    """Return the same value of nothing but groups, lists, finite numbers and text, of a size that data of ours has."""
    if isinstance(value, list | tuple | Mapping):
        _check_size(value, path)
    if isinstance(value, Mapping):
        return {_name(name, path): _plain(item, (*path, name)) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, (*path, i)) for i, item in enumerate(value)]
    if value is None or isinstance(value, bool) or (_is_text(value) and len(value) <= LONGEST_TEXT):
        return value
    if isinstance(value, Integral) and abs(int(value)) <= LARGEST:
        return int(value)
    if isinstance(value, Real) and not isinstance(value, Integral) and _is_ordinary(float(value)):
        return float(value)
    raise _OddError(*path)


def _check_size(value: Any, path: Path) -> None:
    """Refuse a list or group that is longer or deeper than data of ours is."""
    groups = isinstance(value, Mapping) or any(isinstance(item, Mapping) for item in value)
    most = MOST_GROUPS if groups else MOST_ENTRIES
    if len(value) > most:
        raise SettingError(f"{_key(path)}: has {len(value)} entries; it must have {most} at most", _top(path))
    if len(path) > DEEPEST:
        raise SettingError(f"{_top(path)}: is nested too deep", _top(path))


def _key(path: Path) -> str:
    """Return a path as it is written, requirements[0].key."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)[1:]


def _top(path: Path) -> str:
    """Return the key that a path leads through, without what is in its list."""
    return _key(tuple(takewhile(lambda part: not isinstance(part, int), path)))


def _is_ordinary(value: float) -> bool:
    return value == 0.0 or SMALLEST_NUMBER <= abs(value) <= LARGEST_NUMBER  # NaN is not


def _name(name: Any, path: Path) -> str:
    if not _is_text(name):
        raise SettingError(f"{shown(name)} is no name", ".".join(map(str, path)))
    return str(name)


def _is_text(value: Any) -> bool:
    """Whether it is text that UTF-8 can hold; a lone surrogate, from bytes that were no text, is not."""
    return isinstance(value, str) and not any("\ud800" <= letter <= "\udfff" for letter in value)


# -- one line --------------------------------------------------------------------------------------------------------


def _blame(kind: Any, values: Any, path: Path) -> SettingError:
    """Say what is wrong at a path; pydantic puts names of its own into it, which end the walk."""
    hint, value, key, top = kind, values, "", ""
    for part in path:
        entry = _entry(hint)
        if _is_group(hint) and part in hints(hint):
            if part not in value:
                return SettingError(f"{key}: {part} is missing" if key else f"{part} is missing", top)
            hint, key = hints(hint)[part], f"{key}.{part}" if key else part
            top = top if "[" in key else key
        elif get_origin(hint) is dict and isinstance(value, Mapping) and part in value:
            hint, key = get_args(hint)[1], f"{key}.{part}"
        elif _is_group(entry) and isinstance(value, list | tuple) and isinstance(part, int):
            hint, key = entry, f"{key}[{part}]"
        else:
            break
        value = value[part]
    return SettingError(f"{key} = {shown(value)}: must be {_allowed(hint)}{_remark(hint, value)}", top)


def _remark(hint: Any, value: Any) -> str:
    """Return what helps beside what is allowed."""
    if isinstance(value, float) and isfinite(value) and not _is_ordinary(value) and " from " not in _allowed(hint):
        return f", 0 or from {SMALLEST_NUMBER:g} to {LARGEST_NUMBER:g} in magnitude"
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        return f" of at most {LONGEST_TEXT} characters" if hint is str else ""
    near = nearest(value, _choices(hint)) if isinstance(value, str) else None
    return f"; did you mean {near!r}?" if near else ""


def _choices(hint: Any) -> Iterator[str]:
    for item in get_args(hint):
        if isinstance(item, str):
            yield item
        else:
            yield from _choices(item)


def _entry(hint: Any) -> Any:
    """Return what a list holds, if all its entries are alike; None if it is no list."""
    members = get_args(hint) if get_origin(hint) is tuple else ()
    return members[0] if members and set(members[1:]) <= {members[0], Ellipsis} else None


def _allowed(hint: Any) -> str:
    """Say in words what a declared type allows."""
    if _is_group(hint):
        return f"a group of {_listed(list(hints(hint)), 'and')}"
    origin, members = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return " ".join(filter(None, (_allowed(members[0]), *map(_bounds, members[1:]))))
    if origin is Literal:
        return _listed([repr(choice) for choice in members])
    if origin in (Union, types.UnionType):
        return _listed([_allowed(member) for member in members if member is not type(None)])
    if origin is tuple:
        return _allowed_list(members)
    return _WORDS[hint] if origin is None else _allowed_group(members)


def _allowed_group(members: tuple[Any, ...]) -> str:
    return "a group of keys" if members[1] is Any else "a group of NAME = number"


def _allowed_list(members: tuple[Any, ...]) -> str:
    if len(set(members) - {Ellipsis}) > 1:
        return f"a list of {_listed([_allowed(member) for member in members], 'and')}"
    count = "" if Ellipsis in members else f" of {len(members)}"
    return f"a list{count}, each {_allowed(members[0])}"


def _bounds(bound: Any) -> str:
    low, above, high, below = (getattr(bound, name, None) for name in ("ge", "gt", "le", "lt"))
    if low is not None and high is not None:
        return f"from {_number(low)} to {_number(high)}"
    words = (("of at least", low), ("above", above), ("of at most", high), ("below", below))
    found = [f"{word} {_number(value)}" for word, value in words if value is not None]
    if getattr(bound, "min_length", None):
        found.append(f"(at least {bound.min_length})")
    return " and ".join(found)


def _number(value: float) -> str:
    return f"{value:d}" if isinstance(value, int) else f"{value:g}"


def _listed(items: list[str], last: str = "or") -> str:
    return f" {last} ".join(filter(None, (", ".join(items[:-1]), items[-1])))
