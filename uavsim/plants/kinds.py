"""Kinds of plant: where a scenario's truth may come from, and what each says of itself.

A kind is registered where what makes it stands. One of somebody else's has its `Settings` under [plant.options]; ours
have a group of their own in [plant].
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from uavsim.registry import Registry, own_settings

if TYPE_CHECKING:
    from uavsim.plants.plant import Plant

C = TypeVar("C", bound="Callable[..., Plant]")

OPTIONS = "options"  # key of [plant] that holds the settings of a kind that is not ours


@dataclass(frozen=True)
class Kind:
    """One kind of plant.

    Attributes
    ----------
    name : str
        By which a scenario names it.
    cls : callable
        Makes the plant of one run from its own settings, None if it has none, and the `Run`; ValueError, one line that
        names the key, for what cannot be.
    group : str
        Key of its own settings in [plant], "" if it has none. If they have a `length`, s, the record must hold it
        after the wait.
    options : type, optional
        Dataclass of [plant.options], if it reads those.
    flies : bool
        Whether it flies an aircraft, with a rail, a wing and a cruise; else it is a rig and is scored as a whole run.
    rings : bool
        Whether its push makes an airframe ring: vibration grows with it.
    launches : bool
        Whether its load comes as a launch's does, within a fraction of a second.
    air : bool
        Whether wind, turbulence and gusts of the environment reach it; an aircraft's do.
    launcher : tuple of str
        Keys of the launcher that a rig reads beside the wait and the height.
    ours : bool
        Whether it comes with uavsim; others are guarded (`guarded`).
    """

    name: str
    cls: "Callable[..., Plant]"
    group: str = ""
    options: type | None = None
    flies: bool = False
    rings: bool = False
    launches: bool = True
    air: bool = False
    launcher: tuple[str, ...] = ()
    ours: bool = False

    @property
    def on_rail(self) -> bool:
        """Whether its run begins at rest on the launcher's rail, in the air of the environment."""
        return self.flies or self.air


KINDS: Registry[Kind] = Registry("plant")
"""Every kind that is registered."""


def plant(name: str, *, flies: bool = False, rings: bool = False, launches: bool = True) -> Callable[[C], C]:
    """Register a class or function as a kind of plant.

    It is called with its own ``Settings``, a frozen dataclass, or None if it has none, and the `Run`. A scenario gives
    them under ``[plant.options]``.

    Parameters
    ----------
    name : str
        By which a scenario names it.
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
    options = own_settings(cls, f"plant {name!r}")
    return Kind(name, cls, "" if options is None else OPTIONS, options, **says)
