"""One of a few allowed things, and the one line that helps when it is none of them."""

from collections.abc import Sequence
from difflib import get_close_matches
from typing import TypeVar

Item = TypeVar("Item", str, float, int)


def choose(what: str, given: Item, allowed: Sequence[Item]) -> Item:
    """Return the allowed item that equals `given`.

    Raises
    ------
    ValueError
        One line that names the nearest allowed item and all of them.
    """
    for item in allowed:
        if item == given:
            return item
    listed = ", ".join(f"{item:g}" if isinstance(item, float) else str(item) for item in allowed)
    raise ValueError(f"{what} {given!r} is unknown; nearest: {_nearest(given, allowed)}; allowed: {listed}")


def _nearest(given: str | float, allowed: Sequence[str] | Sequence[float]) -> str:
    names = [item if isinstance(item, str) else f"{item:g}" for item in allowed]
    if isinstance(given, str):
        return get_close_matches(given, names, n=1, cutoff=0.0)[0]
    return min(names, key=lambda name: abs(float(name) - given))
