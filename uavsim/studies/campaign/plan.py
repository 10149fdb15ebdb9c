"""What flies at each position of a campaign: a scenario that fixes every bit of the flight, and what its row says.

A plan is data: it is written into the campaign's record, and read again to fly what is missing, or one flight once
more. Flight `i` of `Random` depends on the scenario, its seed and `i` alone, so that a longer campaign has the shorter
one in it. What a design draws depends on the number of flights, which is a part of it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from uavsim import dispersions
from uavsim.cosim import draw
from uavsim.scenario import Scenario
from uavsim.studies.campaign.vary import applied, labels

LARGEST = 2**40  # flights
DRAW, VARY = "draw.", "vary."
Row = dict[str, Any]


@runtime_checkable
class Plan(Protocol):
    """Flights by position, 0 … `size` - 1.

    Attributes
    ----------
    kind : str
        By which it is written.
    """

    kind: ClassVar[str]

    @property
    def scenario(self) -> Scenario:
        """What all of them have in common; with its dispersions."""

    @property
    def size(self) -> int:
        """How many there are."""

    def index(self, position: int) -> int:
        """The number by which people know the flight: `--index`, the folder of one that is kept."""

    def flight(self, position: int) -> Scenario:
        """What flies; without dispersions."""

    def columns(self, position: int) -> Row:
        """What its row says besides the score."""

    def to_dict(self) -> Row:
        """Everything but the scenario, as plain values; `plan_of` takes it back."""


def _drawn(scenario: Scenario, values: Mapping[str, Any]) -> Row:
    """Columns of what a flight drew: its launch, and its dispersions."""
    launch = draw(scenario)
    return {
        "draw.release_time": launch.release_time,
        "draw.force_factor": launch.force_factor,
        **{DRAW + key: value for key, value in values.items()},
    }


@dataclass(frozen=True)
class Seeds:
    """One flight of each of several seeds, the first of its own campaign; known by its seed."""

    kind: ClassVar[str] = "seeds"
    scenario: Scenario
    seeds: tuple[int, ...]

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.seeds)

    def index(self, position: int) -> int:
        """Return the number by which people know the flight."""
        return self.seeds[position]

    def flight(self, position: int) -> Scenario:
        """Return what flies; without dispersions."""
        return dispersions.resolved(self._seeded(position), 0)

    def _seeded(self, position: int) -> Scenario:
        return replace(self.scenario, seed=self.seeds[position])

    def columns(self, position: int) -> Row:
        """Return what its row says besides the score."""
        return _drawn(self.flight(position), dispersions.drawn(self._seeded(position), 0))

    def to_dict(self) -> Row:
        """Return everything but the scenario, as plain values."""
        return {"kind": self.kind, "seeds": list(self.seeds)}


@dataclass(frozen=True)
class Random:
    """Flights of one seed, each with its own draws."""

    kind: ClassVar[str] = "random"
    scenario: Scenario
    runs: int

    @property
    def size(self) -> int:
        """How many there are."""
        return self.runs

    def index(self, position: int) -> int:
        """Return the number by which people know the flight."""
        return position

    def flight(self, position: int) -> Scenario:
        """Return what flies; without dispersions."""
        return dispersions.resolved(self.scenario, position)

    def columns(self, position: int) -> Row:
        """Return what its row says besides the score."""
        return _drawn(self.flight(position), dispersions.drawn(self.scenario, position))

    def to_dict(self) -> Row:
        """Return everything but the scenario, as plain values."""
        return {"kind": self.kind, "runs": self.runs}


@dataclass(frozen=True)
class Design:
    """Flights whose dispersions are spread evenly: a Latin hypercube, or Sobol's sequence, several times scrambled."""

    kind: ClassVar[str] = "design"
    scenario: Scenario
    runs: int
    sampling: str

    @property
    def size(self) -> int:
        """How many there are."""
        return self.runs

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Points of the unit cube, shape (runs, dispersions)."""
        from uavsim.studies.campaign.designs import points

        return points(self.sampling, self.runs, len(dispersions.keys(self.scenario)), self.scenario.seed)

    def index(self, position: int) -> int:
        """Return the number by which people know the flight."""
        return position

    def flight(self, position: int) -> Scenario:
        """Return what flies; without dispersions."""
        return dispersions.resolved(self.scenario, position, self.points[position])

    def columns(self, position: int) -> Row:
        """Return what its row says besides the score."""
        values = dispersions.drawn(self.scenario, position, self.points[position])
        return {**_drawn(self.flight(position), values), "replicate": self.replicate(position)}

    def replicate(self, position: int) -> int:
        """Return the scrambling that a flight belongs to."""
        from uavsim.studies.campaign.designs import replicate

        return replicate(self.sampling, self.runs, position)

    def to_dict(self) -> Row:
        """Return everything but the scenario, as plain values."""
        return {"kind": self.kind, "runs": self.runs, "sampling": self.sampling}


@dataclass(frozen=True)
class Points:
    """Flights whose dispersions, as points of the unit cube, and whose indices under the seed are given."""

    kind: ClassVar[str] = "points"
    scenario: Scenario
    points: tuple[tuple[float, ...], ...]
    indices: tuple[int, ...]

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.indices)

    def index(self, position: int) -> int:
        """Return the number by which people know the flight."""
        return position

    def flight(self, position: int) -> Scenario:
        """Return what flies; without dispersions."""
        return dispersions.resolved(self.scenario, self.indices[position], np.asarray(self.points[position]))

    def columns(self, position: int) -> Row:
        """Return what its row says besides the score."""
        index, point = self.indices[position], np.asarray(self.points[position])
        return {**_drawn(self.flight(position), dispersions.drawn(self.scenario, index, point)), "stream": index}

    def to_dict(self) -> Row:
        """Return everything but the scenario, as plain values."""
        return {"kind": self.kind, "points": [list(p) for p in self.points], "indices": list(self.indices)}


@dataclass(frozen=True)
class Cells:
    """The same flights under several assumptions: flight `run` of each cell has the same draws.

    Position `cell * runs + run`; a cell is a table of keys and values that are set in the scenario.
    """

    kind: ClassVar[str] = "cells"
    scenario: Scenario
    cells: tuple[Mapping[str, Any], ...]
    runs: int

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.cells) * self.runs

    @cached_property
    def scenarios(self) -> tuple[Scenario, ...]:
        """One a cell."""
        return tuple(applied(self.scenario, dict(cell)) for cell in self.cells)

    @cached_property
    def _labels(self) -> tuple[Row, ...]:
        """What the rows of each cell say of it."""
        columns = {key: labels([cell[key] for cell in self.cells]) for key in (self.cells[0] if self.cells else ())}
        return tuple({VARY + key: column[i] for key, column in columns.items()} for i in range(len(self.cells)))

    def index(self, position: int) -> int:
        """Return the number by which people know the flight."""
        return position

    def flight(self, position: int) -> Scenario:
        """Return what flies; without dispersions."""
        cell, run = divmod(position, self.runs)
        return dispersions.resolved(self.scenarios[cell], run)

    def columns(self, position: int) -> Row:
        """Return what its row says besides the score."""
        cell, run = divmod(position, self.runs)
        values = dispersions.drawn(self.scenarios[cell], run)
        return {"run": run, **self._labels[cell], **_drawn(self.flight(position), values)}

    def to_dict(self) -> Row:
        """Return everything but the scenario, as plain values."""
        return {"kind": self.kind, "cells": [dict(cell) for cell in self.cells], "runs": self.runs}


KINDS: dict[str, type[Any]] = {kind.kind: kind for kind in (Seeds, Random, Design, Points, Cells)}


def plan_of(told: Mapping[str, Any], scenario: Scenario) -> Plan:
    """Return the plan that a record tells of.

    Raises
    ------
    ValueError
        It tells of none.
    """
    try:
        kind = KINDS[told["kind"]]
        given = {name: _frozen(value) for name, value in told.items() if name != "kind"}
        found: Plan = kind(scenario, **given)
        size = found.size
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"plan: is none that can be flown ({type(error).__name__})") from None
    if not isinstance(size, int) or not 0 <= size < LARGEST:
        raise ValueError(f"plan: has {size!r} flights")
    return found


def _frozen(value: Any) -> Any:
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def position_of(plan: Plan, index: int) -> int | None:
    """Return the position of the flight that people know by this number; None if there is none."""
    if isinstance(plan, Seeds):
        return plan.seeds.index(index) if index in plan.seeds else None
    return index if 0 <= index < plan.size else None
