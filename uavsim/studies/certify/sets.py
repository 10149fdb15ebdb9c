"""The sets by name: what flies, with which root seed, and who judges it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from uavsim.studies.certify import from_start, healthy, in_flight, manoeuvres, offset
from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.tasks import Flyable
from uavsim.studies.certify.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Set:
    """A set of flights.

    Attributes
    ----------
    name : str
    seed : int
        Root seed, named before anything was flown with it.
    size : int
        Flights of the whole.
    tasks : callable
        Of a root seed and a number of flights, None for all.
    judge : callable
        Of rows, root seed and the verdict of the version before.
    """

    name: str
    seed: int
    size: int
    tasks: Callable[[int, int | None], Sequence[Flyable]]
    judge: Callable[[Sequence[Row], int, dict[str, Any] | None], Verdict]


SETS = {
    one.name: one
    for one in (
        Set("healthy", 150_001, healthy.SIZE, healthy.tasks, healthy.judge),
        Set("offset", 150_002, offset.SIZE, offset.tasks, offset.judge),
        Set("from-start", 150_003, from_start.SIZE, from_start.tasks, from_start.judge),
        Set("in-flight", 150_005, in_flight.SIZE, in_flight.tasks, in_flight.judge),
        Set("manoeuvres", 150_004, manoeuvres.SIZE, manoeuvres.tasks, manoeuvres.judge),
    )
}
