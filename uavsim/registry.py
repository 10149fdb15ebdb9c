"""Kinds by name: what a scenario may name as its detector, its estimator or its plant.

A registry is filled by those who have a kind: ours as they are imported, those of others when they are asked for
(`uavsim.plugins`). A name stands for one kind; it is never given to another.
"""

import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from typing import Any, Generic, Protocol, TypeVar

NAME = r"\w[\w.+-]{0,63}"


class Named(Protocol):
    """What has a name."""

    @property
    def name(self) -> str:
        """By which a scenario names it."""

    @property
    def cls(self) -> Any:
        """What makes one."""


K = TypeVar("K", bound=Named)


def _place(kind: Named) -> tuple[str, str]:
    """Return the module and the name by which a kind's class is defined."""
    return getattr(kind.cls, "__module__", ""), getattr(kind.cls, "__qualname__", "")


class TakenError(ValueError):
    """A name that another kind has."""


class Registry(Generic[K]):
    """Kinds of one sort, in the order in which they were registered.

    Parameters
    ----------
    what : str
        What they are: "detector", "estimator", "plant".
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self._kinds: dict[str, K] = {}

    @property
    def group(self) -> str:
        """Entry-point group under which packages register theirs."""
        return f"uavsim.{self.what}s"

    def add(self, kind: K) -> None:
        """Register a kind; one that is defined anew, in the same module and by the same name, takes its own place.

        Raises
        ------
        ValueError
            If its name is none.
        TakenError
            If it is taken.
        """
        if not isinstance(kind.name, str) or not re.fullmatch(NAME, kind.name) or kind.name.endswith(".py"):
            raise ValueError(
                f"{str(kind.name)[:60]!r} cannot be a {self.what}'s name: it is at most 64 letters, digits and .+-_, "
                "does not begin with a sign nor end in .py"
            )
        if kind.name in self._kinds and _place(self._kinds[kind.name]) != _place(kind):
            raise TakenError(f"there is already a {self.what} {kind.name!r}; choose another name")
        self._kinds[kind.name] = kind

    def remove(self, name: str) -> None:
        """Forget a kind; the name is free again."""
        del self._kinds[name]

    def __getitem__(self, name: str) -> K:
        return self._kinds[name]

    def __contains__(self, name: object) -> bool:
        return name in self._kinds

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)

    def get(self, name: str) -> K | None:
        """Kind of a name, None if nobody has registered it."""
        return self._kinds.get(name)

    def values(self) -> Iterator[K]:
        """The kinds themselves."""
        return iter(self._kinds.values())


def own_settings(cls: Any, who: str) -> type | None:
    """Return a class's own `Settings`, None if it has none.

    Raises
    ------
    ValueError
        If they are no dataclass.
    """
    options = getattr(cls, "Settings", None)
    if options is not None and not (isinstance(options, type) and is_dataclass(options)):
        raise ValueError(f"{who}: Settings must be a dataclass")
    return options


def made(options: type, given: Any) -> Any:
    """Return options as their class: they come as one, as a mapping, or not at all."""
    return given if isinstance(given, options) else options(**(given or {}))
