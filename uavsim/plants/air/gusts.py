"""Gusts that wait for an event: one-minus-cosine (MIL-F-8785C 3.7.2.3, CS-23.333) and sharp-edged."""

from dataclasses import dataclass
from math import cos, inf, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.air.settings import EnvironmentSettings, GustSettings

LENGTH = 2.0  # s, of a one-minus-cosine gust that says none

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


def direction(gust: GustSettings, heading: float) -> Vector:
    """Unit vector, north-east-down, in which a gust blows; `heading` of the rail, rad."""
    north, east = cos(heading), sin(heading)
    return {
        "head": (-north, -east, 0.0),
        "tail": (north, east, 0.0),
        "left": (-east, north, 0.0),  # from the left to the right
        "right": (east, -north, 0.0),
        "up": (0.0, 0.0, -1.0),
        "down": (0.0, 0.0, 1.0),
    }[gust.direction]


def length_of(gust: GustSettings) -> float:
    """How long it lasts, s."""
    if gust.length_s is not None:
        return gust.length_s
    return inf if gust.shape == "step" else LENGTH


def share(gust: GustSettings, since: float) -> float:
    """Share of a gust's peak at a time since its start, s; 0 before it and after it."""
    length = length_of(gust)
    if not 0.0 <= since < length:
        return 0.0
    return 1.0 if gust.shape == "step" else 0.5 * (1.0 - cos(2.0 * pi * since / length))


@dataclass(slots=True)
class Waiting:
    """A gust, and when it begins, s; None until its event comes."""

    gust: GustSettings
    vector: Vector  # m/s at its peak, north-east-down
    begin: float | None = None

    @property
    def end(self) -> float:
        """When it is over, s; inf as long as it has not begun."""
        return inf if self.begin is None else self.begin + length_of(self.gust)


class Gusts:
    """All gusts of a flight.

    Parameters
    ----------
    environment : EnvironmentSettings
    heading_deg : float
        Of the rail.

    Attributes
    ----------
    all : list of Waiting
    awaited : set of str
        Events that gusts still wait for.
    """

    def __init__(self, environment: EnvironmentSettings, heading_deg: float) -> None:
        heading = radians(heading_deg)
        self.all = [Waiting(gust, _scaled(direction(gust, heading), gust.speed)) for gust in environment.all_gusts]
        self.awaited: set[str] = {gust.gust.at for gust in self.all}

    def tell(self, event: str, time: float) -> None:
        """Say that an event has come; only the first of its kind counts."""
        if event in self.awaited:
            self.awaited.discard(event)
            for gust in self.all:
                if gust.gust.at == event:
                    gust.begin = time + gust.gust.delay

    def following(self, time: float) -> float:
        """Return when the next gust begins, s: `time` where one blows, inf where none is to come."""
        begun = [max(g.begin, time) for g in self.all if g.begin is not None and g.end > time]
        return min(begun, default=inf)

    def over(self, times: Array) -> Array:
        """Velocity of the air in all gusts, m/s, north-east-down, (n, 3), at ascending times, s."""
        total = np.zeros((times.size, 3))
        for gust in self.all:
            if gust.begin is not None:
                first, last = np.searchsorted(times, (gust.begin, gust.end))
                parts = [share(gust.gust, since) for since in (times[first:last] - gust.begin).tolist()]
                total[first:last] += np.outer(parts, gust.vector)
        return total

    def missed(self, end: float) -> list[str]:
        """Say, a line each, which gusts had not begun by the end of the record, s."""
        said = []
        for gust in self.all:
            name = f"the gust of {gust.gust.speed:g} m/s ({gust.gust.direction}, at {gust.gust.at})"
            if gust.begin is None:
                said.append(f"{name} never came: its event did not")
            elif gust.begin >= end:
                said.append(
                    f"{name} never came: it was to begin at {gust.begin:.2f} s, and the flight ended at {end:.2f} s"
                )
        return said


def _scaled(unit: Vector, by: float) -> Vector:
    x, y, z = unit
    return x * by, y * by, z * by
