"""Kinds by name: what a scenario may name as its detector, its estimator or its plant.

A registry is filled by those who have a kind: ours as they are imported, those of others when they are asked for
(`uavsim.plugins`). A name stands for one kind; it is never given to another.
"""

from collections.abc import Iterator
from typing import Any, Generic, Protocol, TypeVar


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
        TakenError
            If its name is taken.
        """
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

    def values(self) -> Iterator[K]:
        """The kinds themselves."""
        return iter(self._kinds.values())
