"""What of a flight is judged: its tables and events, its times and its phases.

All times come from the plant's truth and never from what was detected:

* true launch: the first truth row at which the aircraft has moved more than 1 mm along the rail after release and does
  not come back; crossing: the first true f_x above 4.5 g;
* stroke: 50 ms after the true launch … rail exit; transition: … wing out + 2 s (rail exit + 4 s if the wing never comes
  out, + 2 s of a fixed wing, whose truth is 1 throughout); cruise: the rest.

A rig has neither rail nor wing: it has one phase, its whole run, and its crossing is that of the true specific force
along the detector's axis.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.airspeeds import Airspeeds, of_estimate, of_pressures
from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    from uavsim.scenario import Scenario

Array = NDArray[np.float64]

MOVED = 1e-3  # m along the rail: the true launch
CROSSING = 4.5 * STANDARD_GRAVITY  # m/s^2, lower edge of the paper's recognition range less its tolerance
STROKE_LEAD = 0.05  # s after the true launch at which scoring begins
WING_OUT = 0.99
TRANSITION = 2.0  # s after the wing is out
TRANSITION_FOLDED = 4.0  # s after the rail if the wing never comes out
RUN = "run"  # the one phase of a rig


@dataclass(frozen=True)
class Judged:
    """What is judged: a flight's tables and events, and how it ended.

    Attributes
    ----------
    scenario
        What was flown.
    tables
        'truth', 'estimate' and 'air_data': each gives its columns by name.
    events
        What was noticed and done on board, each with `t`, s, and `event`.
    release_time
        When the latch let go, s.
    ended
        Why the loop stopped: 'completed', 'touched' (the ground), 'diverged' or 'onboard_failed'; of a record its
        outcome.
    versions
        Of what was flown with.
    said
        What the plant or a part said when it ended the flight; of a record its reason.
    """

    scenario: "Scenario"
    tables: Mapping[str, Any]
    events: list[dict[str, Any]]
    release_time: float
    ended: str
    versions: Mapping[str, str]
    said: str = ""

    def truth(self, column: str) -> Array:
        """Truth column as floats."""
        return np.asarray(self.tables["truth"][column], dtype=float)

    def estimate(self, column: str) -> Array:
        """Estimate column as floats."""
        return np.asarray(self.tables["estimate"][column], dtype=float)

    @cached_property
    def true_airspeeds(self) -> Airspeeds:
        """Calibrated and equivalent airspeed of the truth's rows, m/s."""
        return of_pressures(self.truth("p_total"), self.truth("p_static"))

    @cached_property
    def told_airspeeds(self) -> Airspeeds:
        """Calibrated and equivalent airspeed of the estimate's rows, m/s."""
        return of_estimate(self.tables["estimate"], self.tables["air_data"], self.scenario)

    @property
    def is_rig(self) -> bool:
        """Whether it was on a rig and not in flight."""
        return not self.scenario.plant.chosen.flies

    @cached_property
    def time(self) -> Array:
        """Times of the truth's rows, s."""
        return self.truth("t")

    @cached_property
    def true_time(self) -> float | None:
        """When the aircraft began to move for good, s; a way that is not a number brings it back no more than on."""
        way = self.truth("rail_s")
        back = np.flatnonzero((way <= MOVED) | (self.time < self.release_time))
        moved = np.flatnonzero(way > MOVED)
        gone = moved[moved > (back[-1] if back.size else -1)]
        return float(self.time[gone[0]]) if gone.size else None

    @cached_property
    def crossing_time(self) -> float | None:
        """When the true specific force along the launch first exceeds 4.5 g, s."""
        axis = self.scenario.launch_axis
        force = self.truth(f"f{axis[1]}") * (-1.0 if axis[0] == "-" else 1.0)
        return self._first(force > CROSSING, self.release_time)

    @cached_property
    def rail_exit_time(self) -> float | None:
        """When the last shoe leaves, s: the way along the rail has become the stroke."""
        if self.is_rig:
            return None
        return self._first(self.truth("rail_s") >= self.scenario.launcher.stroke, self.release_time)

    @cached_property
    def is_fixed_wing(self) -> bool:
        """Whether the wing is out from the first row on: there is none to unfold."""
        wing = self.truth("wing")
        return bool(wing.size) and bool(wing[0] >= WING_OUT)

    @cached_property
    def wing_start_time(self) -> float | None:
        """When the wing begins to open, s; never of a fixed one."""
        if self.is_fixed_wing:
            return None
        return self._first(self.truth("wing") > 0.0, -np.inf)

    @cached_property
    def wing_out_time(self) -> float | None:
        """When the wing is out, s; a fixed one never comes out."""
        if self.is_fixed_wing:
            return None
        return self._first(self.truth("wing") >= WING_OUT, -np.inf)

    def _first(self, condition: NDArray[np.bool_], after: float) -> float | None:
        rows = np.flatnonzero(condition & (self.time >= after))
        return float(self.time[rows[0]]) if rows.size else None

    @cached_property
    def detections(self) -> list[float]:
        """Times at which the detector recognised a launch, s."""
        return [e["t"] for e in self.events if e["event"] == "launch_detected"]

    @cached_property
    def detected_time(self) -> float | None:
        """The detection that counts: the first one not before release, s."""
        return next((t for t in self.detections if t >= self.release_time), None)

    def event_time(self, name: str) -> float | None:
        """Time of the first event of that name, s."""
        return next((e["t"] for e in self.events if e["event"] == name), None)

    @cached_property
    def edges(self) -> dict[str, tuple[float, float]]:
        """First and last time of each scored phase, s; phases that were not reached are absent."""
        true, end = self.true_time, float(self.time[-1]) if self.time.size else 0.0
        if self.is_rig:
            return {RUN: (float(self.time[0]), end)} if self.time.size else {}
        if true is None:
            return {}
        start, exit_time = true + STROKE_LEAD, self.rail_exit_time
        if exit_time is None:
            return {"stroke": (start, end)}
        wing = exit_time if self.is_fixed_wing else self.wing_out_time
        cruise = exit_time + TRANSITION_FOLDED if wing is None else max(wing + TRANSITION, exit_time)
        edges = {"stroke": (start, exit_time), "transition": (exit_time, min(cruise, end))}
        if cruise < end:
            edges["cruise"] = (cruise, end)
        return edges

    def rows(self, time: Array, phase: str | None = None) -> NDArray[np.bool_]:
        """Which of `time` belong to a phase, or to any."""
        chosen = np.zeros(time.shape, bool)
        for name, (first, last) in self.edges.items():
            if phase in (None, name):
                chosen |= (time >= first) & ((time < last) | (name == list(self.edges)[-1]))
        return chosen

    def phases(self) -> NDArray[np.object_]:
        """Phase of each truth row: 'rail' before scoring begins, then the scored ones."""
        names = np.full(self.time.shape, "rail", dtype=object)
        for name in self.edges:
            names[self.rows(self.time, name)] = name
        return names
