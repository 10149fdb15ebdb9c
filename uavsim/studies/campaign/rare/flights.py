"""Rare events of whole flights: crashes, misses, or a score's number beyond a bound, on what a scenario draws.

The inputs are the standard normals u of the dispersions, whose point of the unit cube is Φ(u), and one more for the
flight's index under the seed, which draws sensor units, noise and gusts. Nothing is continuous in the index: a chain
keeps it or draws another. Where noise alone decides, chains therefore stand still; then a detector's noise
(`detectors`) is what can be made rare.

An event needs a margin that tells how near a flight has come to it:

    crashed         lowest height above ground after the rail's end, m; 0 of a flight that crashed
    missed_launch   time from the recognition to that at which the launch counts as missed, s; 0 if it is missed
    KEY<=VALUE      score less value; a flight without that number is taken for one without the event
    KEY>=VALUE      value less score

Other outcomes have no such number, and a flight that never sinks below the rail's end tells nothing of a crash but that
it is far: with margins that are all alike subset simulation ends at once and says so.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, isfinite, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim import dispersions
from uavsim.criteria import MISSED_AFTER
from uavsim.scenario import Scenario
from uavsim.score_keys import NUMBERS
from uavsim.studies.campaign.flown import fly_position
from uavsim.studies.campaign.keep import Keep
from uavsim.studies.campaign.plan import Points
from uavsim.studies.campaign.rare.estimate import Estimate, Inputs
from uavsim.studies.engine import Crew

Floats = NDArray[np.float64]
Row = Mapping[str, Any]
Fly = Callable[[Floats, Sequence[int]], Sequence[Row]]
"""Flies points of the unit cube, shape (n, d), with an index each, and returns the rows in their order."""

INDICES = 2**31  # of flights under a seed
OUTCOMES = ("crashed", "missed_launch")
UNFLYABLE = "unflyable"  # outcome of what is drawn and cannot be flown
NEAREST = 1e-9  # the margin of a flight without the event is above 0

_BOUND = re.compile(r"\s*([a-z0-9_.]+)\s*(<=|>=)\s*(\S+)\s*")


@dataclass(frozen=True)
class Event:
    """What is asked of a flight.

    Attributes
    ----------
    text : str
        As it was asked.
    key : str
        Of the score's number that is bounded.
    above : bool
        Whether the event is to be at or above the bound.
    bound : float
    ground : float
        Elevation of the ground above mean sea level, m.
    """

    text: str
    key: str = ""
    above: bool = False
    bound: float = nan
    ground: float = 0.0

    def margin(self, row: Row) -> float:
        """Margin of a flight: at or below 0 if the event has come true; NaN counts as far from it."""
        if self.key:
            value = float(row.get(self.key, nan))
            return self.bound - value if self.above else value - self.bound
        if row["outcome"] == self.text:
            return 0.0
        if row["outcome"] == UNFLYABLE:
            return nan
        if self.text == "crashed":
            return max(NEAREST, float(row.get("flight.lowest_altitude_after_exit", nan)) - self.ground)
        exit_time, detected = (float(row.get(k, nan)) for k in ("flight.rail_exit_time", "launch.detected_time"))
        return max(NEAREST, exit_time + MISSED_AFTER - detected)


def event_of(text: str) -> Event:
    """Read an event of whole flights.

    Raises
    ------
    ValueError
        It is none; one line.
    """
    if text in OUTCOMES:
        return Event(text)
    if text in ("timeout", "false_launch", "landed", "diverged", "failed", "cruise"):
        raise ValueError(
            f"no number in a score tells how near a flight is to {text!r}, so that it cannot be made rare: "
            f"ask for {', '.join(OUTCOMES)} or KEY<=VALUE"
        )
    found = _BOUND.fullmatch(text)
    if found is None:
        raise ValueError(f"event {text[:60]!r}: must be {', '.join(OUTCOMES)}, KEY<=VALUE or KEY>=VALUE")
    key, sign, number = found.groups()
    if key not in NUMBERS or key == "seed":
        raise ValueError(f"event {text[:60]!r}: {key!r} is no number of a score; see docs/score.md")
    try:
        bound = float(number)
    except ValueError:
        bound = inf
    if not isfinite(bound):
        raise ValueError(f"event {text[:60]!r}: {number[:20]!r} is not a finite number")
    return Event(text, key, sign == ">=", bound)


def in_flight(scenario: Scenario, event: Event, fly: Fly) -> Inputs:
    """Whole flights of a scenario.

    Parameters
    ----------
    scenario : Scenario
        With its dispersions and its seed.
    event : Event
    fly : callable
        Who flies; `flown_by` makes it of a crew.

    Raises
    ------
    ValueError
        If the scenario has no dispersions.
    """
    keys = dispersions.keys(scenario)
    if not keys:
        raise ValueError(
            f"{scenario.name} has no [[dispersions]]: its flights differ by their noise alone, which subset simulation "
            "cannot move; ask for false_launch or missed_launch of the detector"
        )

    event = replace(event, ground=scenario.environment.ground_elevation)

    def margins(u: Floats) -> Floats:
        points, indices = located(u)
        return np.array([event.margin(row) for row in fly(points, indices)], np.float64)

    return Inputs(margins, len(keys) + 1, whole=1, names=(*keys, "index"))


def located(u: Floats) -> tuple[Floats, list[int]]:
    """Points of the unit cube and indices of inputs, the last of which is the index."""
    from scipy.special import ndtr

    cube = np.clip(ndtr(u), 1e-16, 1.0 - 1e-16)
    return cube[:, :-1], [min(INDICES - 1, int(x * INDICES)) for x in cube[:, -1]]


def failing(scenario: Scenario, found: Estimate) -> list[dict[str, Any]]:
    """What fails first: the failures nearest to the middle of what is drawn, with the values that were drawn."""
    points, indices = located(found.failures) if len(found.failures) else (np.empty((0, 0)), [])
    return [
        {"distance": float(np.sqrt(u[:-1] @ u[:-1])), "index": index, **dispersions.drawn(scenario, index, point)}
        for u, point, index in zip(found.failures, points, indices, strict=True)
    ]


def _row(plan: Points, limit: float | None, position: int) -> Row:
    try:
        return fly_position(plan, Keep("none"), limit, position).row
    except ValueError:  # such as air that holds more water than it can
        return {"outcome": UNFLYABLE}


def flown_by(crew: Crew, scenario: Scenario, limit: float | None = None) -> Fly:
    """Let a crew fly: see `Fly`. What is drawn and cannot be flown is taken for a flight without the event.

    Raises
    ------
    ValueError
        From what is returned: a flight is left unfinished.
    """

    def fly(points: Floats, indices: Sequence[int]) -> list[Row]:
        plan = Points(scenario, tuple(map(tuple, points.tolist())), tuple(indices))
        rows: dict[int, Row] = {}

        def done(results: list[tuple[int, Row]]) -> None:
            rows.update(results)

        left = crew.each(partial(_row, plan, limit), range(plan.size), done=done, limit=limit)
        if left:
            raise ValueError(f"flight with index {indices[left[0].position]} was not flown: {left[0].why}")
        return [rows[i] for i in range(plan.size)]

    return fly
