"""One of a few allowed things, and the one line that helps when it is none of them."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from math import isfinite
from reprlib import Repr
from typing import Any, TypeVar

Item = TypeVar("Item", str, float, int)

COMPARED = 100  # characters of what was given; comparing takes the product of two lengths
LISTED = 30  # allowed items that are named; the shipped parts have up to 15 of a kind

_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = 60


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
    raise ValueError(f"{what} {shown(given)} is unknown; nearest: {_nearest(given, allowed)}; allowed: {_all(allowed)}")


def nearest(given: str, known: Iterable[str], cutoff: float = 0.5) -> str | None:
    """Return the known name that was most likely meant; None if none is near.

    A name counts that is the same but for its case, then one that begins with what was given, one that holds it, one
    that what was given begins with, and then the most alike. Of names joined by dots the last parts are compared so,
    within the same group.

    Parameters
    ----------
    given : str
    known : iterable of str
    cutoff : float
        Least ratio of `difflib`, 0 … 1, at which a name is alike; at 0 there is always one.

    Examples
    --------
    >>> nearest("launcher.peak", ["launcher.rise", "launcher.peak_specific_force_g"])
    'launcher.peak_specific_force_g'
    """
    names = list(known)
    given = given[:COMPARED]
    group, _, last = given.lower().rpartition(".")
    ends = {name: end for name in names for start, _, end in [name.lower().rpartition(".")] if start == group}
    for fits in (
        [name for name, end in ends.items() if end == last],
        [name for name, end in ends.items() if len(last) > 1 and end.startswith(last)],
        [name for name, end in ends.items() if len(last) > 2 and last in end],
    ):
        if fits:
            return min(fits, key=len)
    begun = [name for name, end in ends.items() if len(end) > 2 and last.startswith(end)]
    if begun:
        return max(begun, key=len)
    return next(iter(get_close_matches(given, names, n=1, cutoff=cutoff)), None)


def shown(value: Any) -> str:
    """Return a value as Python writes it, shortened; such a text holds nothing that a terminal would obey."""
    try:
        return _SHORT.repr(value)
    except ValueError:  # Python refuses to write a whole number of thousands of digits
        return "a number of thousands of digits"


def _all(allowed: Sequence[str] | Sequence[float]) -> str:
    more = f" and {len(allowed) - LISTED} more" if len(allowed) > LISTED else ""
    return ", ".join(_words(item) for item in allowed[:LISTED]) + more


def _nearest(given: str | float, allowed: Sequence[str] | Sequence[float]) -> str:
    names = [_words(item) for item in allowed]
    if isinstance(given, str):
        return nearest(given, names, cutoff=0.0) or names[0]
    if isinstance(given, float) and not isfinite(given):
        return names[0]
    return _words(min((item for item in allowed if not isinstance(item, str)), key=lambda item: abs(item - given)))


def _words(item: str | float) -> str:
    return f"{item:g}" if isinstance(item, float) else str(item)
