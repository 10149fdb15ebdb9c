"""The kinds of plant by the names that choose them: each says what it is, so that nobody asks for its name."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from uavsim.plants.plant import Plant, Run
from uavsim.registry import Registry

C = TypeVar("C", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of plant.

    Attributes
    ----------
    name
        What `plant.kind` calls it.
    make
        Makes the plant of one run from its own settings, None if it has none. Raises ValueError, one line that names
        the key, for what cannot be.
    group
        Key of its own settings in `[plant]`, "" if it has none. If they have a `length`, s, the record must hold it
        after the wait.
    options
        Dataclass of its settings in `[plant.options]`, if those are its own.
    flies
        Whether it flies an aircraft, with a rail, a wing and a cruise; else it is a rig and is scored as a whole run.
    rings
        Whether its push makes an airframe ring: vibration grows with it.
    launches
        Whether its load comes as a launch's does, within a fraction of a second.
    """

    name: str
    make: Callable[[Any, Run], Plant]
    group: str = ""
    flies: bool = False
    rings: bool = False
    launches: bool = True
    options: type | None = None

    @property
    def cls(self) -> Callable[[Any, Run], Plant]:
        """What makes one."""
        return self.make


KINDS: Registry[Kind] = Registry("plant")
"""Every kind that is registered."""


def plant(name: str, *, flies: bool = False, rings: bool = False, launches: bool = True) -> Callable[[C], C]:
    """Register a class or function as a kind of plant.

    It is called with its own ``Settings``, a frozen dataclass, or None if it has none, and the `Run`. A scenario gives
    the settings under ``[plant.options]``.

    Parameters
    ----------
    name : str
        What `plant.kind` calls it.
    flies, rings, launches : bool
        As of `Kind`.

    Raises
    ------
    ValueError
        If the name is taken.
    """

    def register(cls: C) -> C:
        KINDS.add(kind_of(cls, name, flies=flies, rings=rings, launches=launches))
        return cls

    return register


def kind_of(cls: Callable[..., Any], name: str, **says: Any) -> Kind:
    """Return the kind that a class or function is, without registering it.

    Raises
    ------
    ValueError
        If it cannot be called.
    """
    if not callable(cls):
        raise ValueError(f"plant {name!r}: {cls!r} cannot be called")  # noqa: TRY004 (one line for the user)
    return Kind(name, cls, options=getattr(cls, "Settings", None), **says)
