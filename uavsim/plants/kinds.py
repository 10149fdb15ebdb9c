"""The kinds of plant by the names that choose them: each says what it is, so that nobody asks for its name."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from uavsim.plants.plant import Plant, Run


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


KINDS: dict[str, Kind] = {}


def register(kind: Kind) -> None:
    """Let scenarios choose a kind.

    Raises
    ------
    ValueError
        If the name is taken.
    """
    if kind.name in KINDS:
        raise ValueError(f"plant.kind = {kind.name!r} is taken")
    KINDS[kind.name] = kind
