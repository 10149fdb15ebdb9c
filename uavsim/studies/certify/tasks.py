"""One flight of a set, and who flies it.

The flight's seed is the root seed of the set and its index is its number in the set (`sensors.streams`), so that a part
of a set consists of flights of the whole, and each can be flown again by

    uavsim fly SCENARIO --seed ROOT --set index=NUMBER --set …
"""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from uavsim.cosim import Cosimulation
from uavsim.flight import Flight
from uavsim.scenario import load_scenario
from uavsim.studies.certify.figures import Row, figures

Rule = Callable[[Flight], Row]
"""Holds a flight against the rule of its case; the keys are columns of its row."""


def numbers(cases: int, each: int, section: int, count: int | None) -> list[int]:
    """Return the numbers of a set's flights, case by case.

    Parameters
    ----------
    cases, each : int
        Of the whole set: how many, and the flights of each.
    section : int
        From one case's first number to the next's.
    count : int or None
        About how many flights a part of the set has: the first of each case, one at least. None: the whole set.
    """
    flown = each if count is None else max(1, min(each, count // cases))
    return [place * section + flight for place in range(cases) for flight in range(flown)]


@dataclass(frozen=True, slots=True)
class Task:
    """A flight that is to be flown.

    Attributes
    ----------
    number : int
        In its set.
    scenario : str
        Packaged name.
    overrides : tuple of str
        ``KEY=VALUE`` each.
    seed : int
        The set's root.
    levels : mapping
        What its row says besides: factors and their levels.
    rule : callable or None
        A function of a module, so that it can be sent to another process.
    bounded : bool
        Whether the Cramér-Rao bound of its course is computed, which costs as much as the flight.
    index : int or None
        Under the seed; None: its number. Two flights with the same one differ by their overrides alone.
    """

    number: int
    scenario: str
    overrides: tuple[str, ...]
    seed: int
    levels: Mapping[str, Any] = field(default_factory=dict)
    rule: Rule | None = None
    bounded: bool = False
    index: int | None = None

    def command(self) -> str:
        """Return what flies it again."""
        index = self.number if self.index is None else self.index
        sets = " ".join(f"--set {shlex.quote(one)}" for one in (f"index={index}", *self.overrides))
        return f"uavsim fly {self.scenario} --seed {self.seed} {sets}"

    def fly(self) -> Row:
        """Fly it; a scenario that is refused is a row as well, with the outcome `refused` and the reason."""
        row: Row = {"number": self.number, **self.levels}
        index = self.number if self.index is None else self.index
        try:
            overrides = (*self.overrides, f"seed={self.seed}", f"index={index}")
            flight = Cosimulation(load_scenario(self.scenario, overrides=overrides))
        except ValueError as error:
            return {**row, "outcome": "refused", "reason": " ".join(str(error).split())[:300]}
        flight.advance(flight.steps)
        flown = flight.finish()
        row |= figures(flown, bounded=self.bounded)
        if self.rule is not None:
            row |= self.rule(flown)
        return row


class Flyable(Protocol):
    """A flight of a set."""

    @property
    def number(self) -> int:
        """In its set."""

    def fly(self) -> Row:
        """Return its row, with its `number` and `outcome`."""

    def command(self) -> str:
        """Return what flies it again."""


def fly(task: Flyable) -> Row:
    """Fly one, in whatever process."""
    return task.fly()
