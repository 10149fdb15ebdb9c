"""How flights ended and why: outcomes by cause, each with the exact interval of its probability.

Two flights that crashed did so at different times and speeds, so their reasons differ in every figure. What is the same
is the cause: the reason up to its first number, "touched the ground" of "touched the ground at 3.21 s: sink 4.2 m/s".
"""

import re
from collections import Counter
from dataclasses import dataclass

from uavsim.studies.campaign.many import Many
from uavsim.studies.intervals import share_interval

_NUMBER = re.compile(r"\s*(?:\b(?:at|after|in|of|by|from|to|is|was)\s+)?(?<![\w.])[-+−]?\d.*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Cause:
    """One way to end: how many flights did, and the bounds of its probability.

    Attributes
    ----------
    outcome, cause : str
        As in the score; the cause may be empty.
    expected : bool
        Whether it is what the scenario expects.
    flights : int
    share, low, high : float
        Clopper-Pearson, 95 %.
    row : int
        The first row that ended so.
    """

    outcome: str
    cause: str
    expected: bool
    flights: int
    share: float
    low: float
    high: float
    row: int


def cause_of(reason: str) -> str:
    """Return what a reason says before its first number.

    Examples
    --------
    >>> cause_of("touched the ground at 3.21 s: sink 4.20 m/s")
    'touched the ground'
    """
    return _NUMBER.sub("", " ".join(reason.split()), count=1).rstrip(" :,;(") or reason.strip()


def causes(flown: Many) -> list[Cause]:
    """Return all ways to end, the most frequent first."""
    keys = list(zip(flown.words("outcome"), map(cause_of, flown.words("reason")), flown.expected.tolist(), strict=True))
    first: dict[tuple[str, str, bool], int] = {}
    for row, key in enumerate(keys):
        first.setdefault(key, row)
    return [
        Cause(*key, count, count / len(keys), *share_interval(count, len(keys)), first[key])
        for key, count in Counter(keys).most_common()
    ]
