"""A key of a scenario: what is declared of it, its own value there, and the same scenario with another value."""

import re
from dataclasses import dataclass, is_dataclass, replace
from math import inf
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from uavsim import settings
from uavsim.settings import SettingError

OF_PROPERTIES = "aircraft.properties."
_ENTRY = re.compile(r"(.+)\[([0-9]{1,3})\]")


@dataclass(frozen=True)
class Bounds:
    """What a number may be: from `low` to `high`; an end that is open is hit with a probability of 0."""

    low: float = -inf
    high: float = inf


@dataclass(frozen=True)
class Key:
    """A key that exists.

    Attributes
    ----------
    name
        As it was written.
    path
        Names of groups, of the field, and the number of an entry of its list or the name of a property.
    hint
        Declared type.
    """

    name: str
    path: tuple[str | int, ...]
    hint: Any

    @property
    def number(self) -> type | None:
        """Type `float` or `int`, if it takes a number; None if it does not."""
        kinds = {_plain(member) for member in _members(self.hint)}
        return float if float in kinds else int if int in kinds else None

    @property
    def bounds(self) -> Bounds:
        """Of its numbers."""
        member = next((m for m in _members(self.hint) if _plain(m) is self.number), None)
        limits = get_args(member)[1:]
        ge, gt, le, lt = (
            next((value for limit in limits if (value := getattr(limit, name, None)) is not None), None)
            for name in ("ge", "gt", "le", "lt")
        )
        low, high = (gt if ge is None else ge), (lt if le is None else le)
        return Bounds(-inf if low is None else float(low), inf if high is None else float(high))

    @property
    def single(self) -> bool:
        """Whether it takes a number, a text or a truth."""
        return any(_plain(member) in {float, int, str, bool, Literal} for member in _members(self.hint))

    def own(self, scenario: Any) -> Any:
        """Its value in a scenario; None if it has none."""
        found = scenario
        for part in self.path:
            if isinstance(part, int):
                found = found[part] if isinstance(found, tuple | list) and part < len(found) else None
            elif isinstance(found, dict):
                found = found.get(part)
            else:
                found = getattr(found, part)
        return found

    def checked(self, value: Any) -> Any:
        """Return a value as it is declared.

        Raises
        ------
        SettingError
            It is of another type or out of its bounds.
        """
        return settings.read_value(self.hint, self.name, value)

    def put(self, scenario: Any, value: Any) -> Any:
        """Return the same scenario with another value there, which is not checked."""
        return _put(scenario, self.path, value)


def find(scenario: Any, name: str) -> Key:
    """Return a key of a scenario.

    Raises
    ------
    SettingError
        There is none such; one line that names the nearest.
    """
    if name.startswith(OF_PROPERTIES) and name != OF_PROPERTIES:
        return Key(name, ("aircraft", "properties", name.removeprefix(OF_PROPERTIES)), float)
    plain, entry = _entry(name)
    for group in ("detector", "estimator", "plant"):
        options = getattr(getattr(scenario, group), "options", None)
        option = plain.removeprefix(f"{group}.options.")
        declared = _declared(type(options))
        if option != plain and option in declared:
            return _of(name, (group, "options", option), declared[option], entry, scenario)
    scenarios = type(scenario)
    if plain not in _known(scenarios):
        raise settings.unknown(scenarios, plain)
    return _of(name, tuple(plain.split(".")), settings.hint_of(scenarios, plain), entry, scenario)


def _declared(kind: Any) -> dict[str, Any]:
    """Types of the options of a plug-in, by name; nothing if it has none."""
    return dict(settings.hints(kind)) if hasattr(kind, "__dataclass_fields__") else {}


def _known(kind: type) -> frozenset[str]:
    if kind not in _KNOWN:
        _KNOWN[kind] = frozenset(settings.keys(kind))
    return _KNOWN[kind]


_KNOWN: dict[type, frozenset[str]] = {}


def _entry(name: str) -> tuple[str, int | None]:
    match = _ENTRY.fullmatch(name)
    return (match[1], int(match[2])) if match else (name, None)


def _of(name: str, path: tuple[str, ...], hint: Any, entry: int | None, scenario: Any) -> Key:
    whole = Key(name, path, hint)
    if entry is None:
        return whole
    own = whole.own(scenario)
    if not isinstance(own, tuple) or entry >= len(own) or is_dataclass(own[entry]):
        has = f"has {len(own)} entries" if isinstance(own, tuple) else "is no list there"
        raise SettingError(f"{name}: there is no such entry; {'.'.join(path)} {has}", ".".join(path))
    of_list = next((m for m in _members(hint) if get_origin(m) is tuple), None)
    members = [m for m in get_args(of_list) if m is not Ellipsis]
    return Key(name, (*path, entry), members[min(entry, len(members) - 1)])


def _members(hint: Any) -> tuple[Any, ...]:
    """What a declared type is one of."""
    return get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)


def _plain(member: Any) -> Any:
    """The type of one of them without its bounds; `Literal` of a choice of texts."""
    if get_origin(member) is Literal:
        return Literal
    return get_args(member)[0] if hasattr(member, "__metadata__") else member


def _put(group: Any, path: tuple[str | int, ...], value: Any) -> Any:
    first, *rest = path
    if isinstance(first, int):
        return (*group[:first], value, *group[first + 1 :])
    if isinstance(group, dict):
        return {**group, first: value}
    inner = getattr(group, first)
    return replace(group, **{first: _put(inner, tuple(rest), value) if rest else value})
