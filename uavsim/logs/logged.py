"""What an autopilot's log holds: messages of the kinds that were asked for, and how much of it could not be read."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sensors.tables import MOST_ROWS

Key = tuple[str, int]
"""A message's name, and its instance."""


@dataclass(frozen=True, slots=True)
class Logged:
    """What a log holds.

    Attributes
    ----------
    tables : dict
        Of each message asked for, by name and instance: its fields, in the order of the log.
    names : tuple of str
        All messages that were logged, an instance beyond the first as in ``name[1]``.
    silent : tuple of str
        Names of messages that are defined and were never logged.
    lost : int
        Bytes that could not be read, but those of a last message that is cut.
    truncated : bool
        Whether the last message is cut.
    """

    tables: dict[Key, dict[str, NDArray[np.generic]]]
    names: tuple[str, ...]
    silent: tuple[str, ...]
    lost: int
    truncated: bool

    @property
    def damage(self) -> str:
        """What is wrong with it, in words; empty if nothing is."""
        if self.lost:
            return f"is damaged and {self.lost} bytes of it could not be read"
        return "is truncated" if self.truncated else ""


def labelled(key: Key) -> str:
    """Return the name of a message with its instance."""
    return f"{key[0]}[{key[1]}]" if key[1] else key[0]


def check_rows(name: str, rows: int) -> None:
    """Refuse more messages than can be replayed."""
    if rows > MOST_ROWS:
        raise ValueError(f"has {rows} messages {name}; at most {MOST_ROWS} are read")
