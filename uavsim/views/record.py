"""What a flight has to draw: its columns as arrays, its moments by name, the stretches of time worth enlarging.

What a recording lacks is None, and whatever needs it is left out.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.judged import CROSSING
from uavsim.scenario import Scenario, scenario_of
from uavsim.set_faults import set_faults
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views.faults import noticed
from uavsim.views.figure import BLACK, BLUE, GREY, PHASES, RED
from uavsim.views.marks import Mark

if TYPE_CHECKING:
    from uavsim.flight import Flight

Array = NDArray[np.float64]
Stretch = tuple[float, float]  # first and last time, s

CROSSING_G = CROSSING / STANDARD_GRAVITY  # g
BEFORE, AFTER_EXIT = 0.2, 0.4  # s, the launch is drawn from release - BEFORE to rail exit + AFTER_EXIT
WITHOUT_EXIT = 1.0  # s after release that are drawn if the aircraft never leaves the rail
AFTER_WING = 2.0  # s after the wing is out to which attitude and trajectory are enlarged


@dataclass(frozen=True)
class Record:
    """A flight as the figures ask for it."""

    flight: "Flight"

    # -- tables, settings, score ---------------------------------------------------------------------------------------

    def has(self, table: str) -> bool:
        """Tell whether the table is there and has rows."""
        return len(self.flight.tables.get(table, ())) > 0

    def column(self, table: str, name: str) -> Array:
        """Return a column as floats."""
        return self.flight.tables[table][name].to_numpy(dtype=float)

    def within(self, stretch: Stretch, table: str, *names: str) -> Iterator[Array]:
        """Return the time and some columns over a stretch of time, with one more row on each side."""
        return within(stretch, *(self.column(table, name) for name in ("t", *names)))

    @cached_property
    def scenario(self) -> Scenario:
        """What was flown."""
        return scenario_of(self.flight)

    def scored(self, *keys: str) -> Any:
        """Return a score's value, None if it has none."""
        value: Any = self.flight.score
        for key in keys:
            value = value.get(key) if isinstance(value, dict) else None
        return value

    @cached_property
    def has_air(self) -> bool:
        """Tell whether there was an airspeed, as far as the truth knows."""
        return not self.has("truth") or bool(np.isfinite(self.column("truth", "airspeed")).any())

    @cached_property
    def title(self) -> str:
        """Scenario, seed and outcome."""
        name, outcome, expected = self.scenario.name, self.scored("outcome"), self.scored("expected")
        if outcome is None:
            return name
        verdict = "as expected" if outcome == expected else f"expected {expected}"
        return f"{name}, seed {self.scored('seed')}: {outcome} ({verdict})"

    # -- moments, s ----------------------------------------------------------------------------------------------------

    def times(self, event: str) -> list[float]:
        """Return when something was noticed or done on board."""
        return [float(e["t"]) for e in self.flight.events if e["event"] == event]

    def event(self, name: str) -> float | None:
        """Return when something was first noticed or done on board."""
        return next(iter(self.times(name)), None)

    @cached_property
    def release(self) -> float | None:
        """When the latch let go."""
        value: float | None = self.scored("launch", "release_time")
        return value

    @cached_property
    def rail_exit(self) -> float | None:
        """When the last shoe left."""
        value: float | None = self.scored("flight", "rail_exit_time")
        return value

    @cached_property
    def detected(self) -> float | None:
        """The detection that counts: in a recording without truth the one that the stroke's end confirmed."""
        if self.release is not None:
            value: float | None = self.scored("launch", "detected_time")
            return value
        end = self.event("stroke_end")
        if end is None:
            return self.event("launch_detected")
        return max((t for t in self.times("launch_detected") if t <= end), default=None)

    @cached_property
    def start(self) -> float | None:
        """The best that is known of the launch's time."""
        value: float | None = known(self.scored("launch", "true_time"), self.release, self.detected)
        return value

    @property
    def free(self) -> float:
        """From when on the aircraft flies free, as well as it is known."""
        value: float = known(self.rail_exit, self.start, self.span[0])
        return value

    @cached_property
    def marks(self) -> list[Mark]:
        """What happened, in the order of time."""
        moments = [
            (self.release, "release", GREY),
            (self.scored("launch", "true_time"), "true launch", BLACK),
            (self.scored("launch", "crossing_time"), f"true {CROSSING_G:g} g", GREY),
            (self.detected, "detected", RED),
            *((t, "false detection", RED) for t in self.times("launch_detected") if t != self.detected),
            (self.rail_exit, "rail exit", BLACK),
            (self.event("stroke_end"), "stroke end noticed", BLUE),
            (self.event("not_a_launch"), "not a launch", BLUE),
            (self.event("wings_commanded"), "wings commanded", BLUE),
            (self.scored("flight", "wing_out_time"), "wing out", BLACK),
            (self.event("motor_on"), "motor on", BLUE),
            *self.troubles,
        ]
        return sorted((Mark(t, label, colour) for t, label, colour in moments if t is not None), key=lambda m: m.t)

    @cached_property
    def troubles(self) -> list[tuple[float, str, str]]:
        """What was set to go wrong with a sensor within the record, and the first of each kind noticed on board."""
        first, last = self.span
        found: dict[str, tuple[float, str]] = {}
        for fault in set_faults(self.scenario):
            if fault.start < last:
                found.setdefault(fault.name, (max(fault.start, first), BLACK))
                if fault.stop < last:
                    found.setdefault(f"end of {fault.noun}", (fault.stop, BLACK))
        for event in self.flight.events:
            if words := noticed(event):
                found.setdefault(words, (float(event["t"]), BLUE))
        return [(t, words, colour) for words, (t, colour) in found.items()]

    def named(self, *labels: str) -> list[Mark]:
        """Pick marks by their labels."""
        return [mark for mark in self.marks if mark.label in labels]

    @cached_property
    def milestones(self) -> list[Mark]:
        """The few marks that a whole flight has room for; where truth is missing, what was noticed on board."""
        pairs = (("true launch", "detected"), ("rail exit", "stroke end noticed"), ("wing out", "wings commanded"))
        few = [mark for true, told in pairs for mark in (self.named(true) or self.named(told))[:1]]
        return [*few, *(Mark(t, words, colour) for t, words, colour in self.troubles)]

    # -- stretches of time ---------------------------------------------------------------------------------------------

    @cached_property
    def span(self) -> Stretch:
        """The whole record."""
        times = [self.flight.tables[name]["t"] for name in self.flight.tables if self.has(name)]
        return min(float(t.iloc[0]) for t in times), max(float(t.iloc[-1]) for t in times)

    @cached_property
    def launch(self) -> Stretch | None:
        """What shows the launch."""
        if self.start is None:
            return None
        first = known(self.release, self.start)
        left = known(self.rail_exit, None if self.release is not None else self.event("stroke_end"))
        last = first + WITHOUT_EXIT if left is None else left + AFTER_EXIT
        return max(first - BEFORE, self.span[0]), min(last, self.span[1])

    @cached_property
    def opening(self) -> Stretch | None:
        """From the launch until the wing has been out for a while."""
        if self.launch is None:
            return None
        wing = known(self.scored("flight", "wing_out_time"), self.event("motor_on"), self.rail_exit, self.launch[1])
        return self.launch[0], min(max(wing + AFTER_WING, self.launch[1]), self.span[1])

    def with_enlarged(self, stretch: Stretch | None) -> list[Stretch]:
        """Return the whole record, and a stretch of it if there is one."""
        return [self.span] if stretch is None or stretch[1] <= stretch[0] else [self.span, stretch]

    @cached_property
    def phases(self) -> list[tuple[str, float, float]]:
        """Scored phases with their first and last time."""
        if not self.has("truth"):
            return []
        names = self.flight.truth["phase"].to_numpy(dtype=object)
        time = self.column("truth", "t")
        edges = [0, *(np.flatnonzero(names[1:] != names[:-1]) + 1), len(names) - 1]
        return [(names[i], float(time[i]), float(time[j])) for i, j in pairwise(edges) if names[i] in PHASES]


def within(stretch: Stretch, t: Array, *values: Array) -> Iterator[Array]:
    """Cut a stretch of time out of times and what goes with them, with one more row on each side."""
    first = max(int(np.searchsorted(t, stretch[0])) - 1, 0)
    last = int(np.searchsorted(t, stretch[1], side="right")) + 1
    return (a[first:last] for a in (t, *values))


def known(*values: Any) -> Any:
    """Return the first value that is not None."""
    return next((value for value in values if value is not None), None)
