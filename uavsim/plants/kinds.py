"""Kinds of plant: where a scenario's truth may come from, and what each says of itself."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from uavsim.registry import Registry

if TYPE_CHECKING:
    from uavsim.plants.plant import Plant

C = TypeVar("C", bound="Callable[..., Plant]")


@dataclass(frozen=True)
class Kind:
    """One kind of plant.

    Attributes
    ----------
    name : str
        By which a scenario names it.
    cls : callable
        Makes the plant of one run.
    options : type, optional
        Dataclass of [plant.options], if it reads those.
    """

    name: str
    cls: "Callable[..., Plant]"
    options: type | None = None


KINDS: Registry[Kind] = Registry("plant")
"""Every kind that is registered."""


def plant(name: str) -> Callable[[C], C]:
    """Register a class or function as a kind of plant.

    It is called with its own ``Settings``, a frozen dataclass, or None if it has none, and the `Run`.
    """

    def register(cls: C) -> C:
        options: Any = getattr(cls, "Settings", None)
        KINDS.add(Kind(name, cls, options))
        return cls

    return register
