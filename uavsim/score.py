"""How well: launch timing, airspeed error, consistency of the claimed uncertainty, requirements.

Everything is judged against the plant's truth, by times that come from the truth and never from what was detected:

* true launch: the first truth row at which the aircraft has moved more than 1 mm along the rail after release and does
  not come back; crossing: the first true f_x above 4.5 g;
* stroke: 50 ms after the true launch … rail exit; transition: … wing out + 2 s (rail exit + 4 s without a wing);
  cruise: the rest. Headline figures are over the three together.

A rig has neither rail nor wing: it is scored over its whole run, its outcome is `completed`, and its crossing is that
of the true specific force along the detector's axis. Where there is no airspeed there is no figure of it.

Truth is interpolated linearly to the time of an estimate's row. Raw and filtered figures are over the same rows, those
at which both exist; rows that the estimator itself calls invalid count. A value that does not exist is None (null in
JSON), never 0.

Whether the claimed uncertainty is what it is: NEES, coverage, NIS and whiteness as in `consistency`. Below V*, the
speed that the noise hides, an error over its claim says nothing: there V < 2 σ_V.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.consistency import LAGS, LEAST, ljung_box
from uavsim.failure import FAILED
from uavsim.files import without_none
from uavsim.score_keys import PHASES, PRESSURE, PRESSURES
from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    from uavsim.requirements import Requirement
    from uavsim.scenario import Scenario

Array = NDArray[np.float64]

MOVED = 1e-3  # m along the rail: the true launch
CROSSING = 4.5 * STANDARD_GRAVITY  # m/s^2, lower edge of the paper's recognition range less its tolerance
STROKE_LEAD = 0.05  # s after the true launch at which scoring begins
MISSED_AFTER = 0.5  # s after the last shoe has left, until which a launch may be recognised
WING_OUT = 0.99
SETTLED = 0.05  # s after the tare in which the last covered conversion leaves the sensor and the filter
TRANSITION = 2.0  # s after the wing is out
TRANSITION_FOLDED = 4.0  # s after the rail if the wing never comes out
LAST = 5.0  # s at the end over which cruise is judged
SPEED_TOLERANCE = 2.0  # m/s
BANK_LIMIT = np.pi / 6.0  # rad, in cruise, and of an aircraft that is upright
SOFT = 1.5  # m/s of sink, below which an aircraft that touches the ground upright has landed
NOSE_LOW, NOSE_HIGH = -np.pi / 36.0, np.pi / 9.0  # rad, -5° and 20°: below it goes on its nose, above on its tail
TOUCHED = "touched"
ON_GROUND = (TOUCHED, "crashed", "landed")  # how a flight ended that touched it, in the loop and as a record has it
TWO_SIGMA = 1.959964  # standard normal quantile of 97.5 %
HIDDEN = 2.0  # σ_V: an airspeed below it is below V*
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
    """

    scenario: "Scenario"
    tables: Mapping[str, Any]
    events: list[dict[str, Any]]
    release_time: float
    ended: str
    versions: Mapping[str, str]

    def truth(self, column: str) -> Array:
        """Truth column as floats."""
        return np.asarray(self.tables["truth"][column], dtype=float)

    def estimate(self, column: str) -> Array:
        """Estimate column as floats."""
        return np.asarray(self.tables["estimate"][column], dtype=float)

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
    def wing_start_time(self) -> float | None:
        """When the wing begins to open, s."""
        return self._first(self.truth("wing") > 0.0, -np.inf)

    @cached_property
    def wing_out_time(self) -> float | None:
        """When the wing is out, s."""
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
        wing = self.wing_out_time
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


def score(flight: Judged) -> dict[str, Any]:
    """Judge a flight; keys, units and meanings as in `docs/score.md`."""
    with np.errstate(over="ignore", invalid="ignore"):  # a flight that diverged may hold any number
        return _score(flight)


def _score(flight: Judged) -> dict[str, Any]:
    launch = _launch(flight)
    airspeed = _airspeed(flight)
    result: dict[str, Any] = {
        "outcome": outcome(flight),
        "expected": flight.scenario.expect,
        "seed": flight.scenario.seed,
        "plugins": [without_none(asdict(source)) for source in flight.scenario.plugins],
        "versions": dict(flight.versions),
        "launch": launch,
        "airspeed": airspeed,
        "pressure": {name: _pressure(flight, name) for name in PRESSURES},
        "flight": _flight(flight),
        "requirements": [],
        "remarks": [],
    }
    result["requirements"] = [_requirement(result, r) for r in flight.scenario.requirements if r.of_each_flight]
    return result


def outcome(flight: Judged) -> str:
    """Name the first that applies, in the order of `docs/score.md`."""
    wings, exit_time, detected = flight.event_time("wings_commanded"), flight.rail_exit_time, flight.detected_time
    if flight.ended in ("diverged", FAILED):
        return flight.ended
    if flight.is_rig:
        return "completed"
    if wings is not None and (exit_time is None or wings < exit_time):
        return "false_launch"
    limit = np.inf if exit_time is None else exit_time + MISSED_AFTER
    if detected is None or detected > limit:
        return "missed_launch"
    if flight.ended in ON_GROUND:
        return "landed" if _lands(flight) else "crashed"
    return "cruise" if _cruises(flight) else "timeout"


def _at_touch(flight: Judged) -> tuple[float, float, float]:
    """Sink, m/s, roll and pitch, rad, of a flight's last row."""
    sink, roll, pitch = (float(flight.truth(name)[-1]) for name in ("vd", "roll", "pitch"))
    return sink, roll, pitch


def _lands(flight: Judged) -> bool:
    """Whether it has touched the ground as an aircraft that lands does: slowly, wings level, nose up."""
    sink, roll, pitch = _at_touch(flight)
    return sink < SOFT and abs(roll) < BANK_LIMIT and NOSE_LOW <= pitch <= NOSE_HIGH


def touchdown(flight: Judged) -> str:
    """Say in one line how a flight touched the ground."""
    sink, roll, pitch = _at_touch(flight)
    return (
        f"touched the ground at {flight.time[-1]:.2f} s: sink {sink:.2f} m/s, roll {np.degrees(roll):z.0f}°, "
        f"pitch {np.degrees(pitch):z.0f}°"
    )


def _cruises(flight: Judged) -> bool:
    last = flight.time >= flight.time[-1] - LAST
    motor = flight.event_time("motor_on")
    target = flight.scenario.flight_computer.airspeed
    return bool(
        motor is not None
        and motor <= flight.time[-1] - LAST
        and np.all(flight.truth("wing")[last] >= WING_OUT)
        and np.all(np.abs(flight.truth("airspeed")[last] - target) <= SPEED_TOLERANCE)
        and np.all(np.abs(flight.truth("roll")[last]) < BANK_LIMIT)
    )


def _launch(flight: Judged) -> dict[str, Any]:
    detected = flight.detected_time
    return {
        "release_time": flight.release_time,
        "true_time": flight.true_time,
        "crossing_time": flight.crossing_time,
        "detected_time": detected,
        "latency": _difference(detected, flight.true_time),
        "latency_from_crossing": _difference(detected, flight.crossing_time),
        "detections": len(flight.detections),
        "false_detections": sum(t < flight.release_time for t in flight.detections),
        "detector": flight.scenario.detector.kind,
    }


def _airspeed(flight: Judged) -> dict[str, Any]:
    time = flight.estimate("t")
    truth = np.interp(time, flight.time, flight.truth("airspeed"))
    error = flight.estimate("airspeed") - truth
    raw = flight.estimate("airspeed_raw") - truth
    sd = flight.estimate("airspeed_sd")
    valid = flight.estimate("valid")
    nis = np.column_stack([flight.estimate("nis_total"), flight.estimate("nis_static")])
    visible = flight.estimate("airspeed") >= HIDDEN * sd
    exists = not np.isnan(flight.truth("airspeed")).all()
    figures = {"": flight.rows(time) & exists} | {name: flight.rows(time, name) & exists for name in PHASES}
    result = {
        name: {**_figures(error[rows], raw[rows], sd[rows], valid[rows], visible[rows]), **_innovations(nis[rows])}
        for name, rows in figures.items()
    }
    return {"estimator": flight.scenario.estimator.kind, **result.pop(""), **result}


def _figures(error: Array, raw: Array, sd: Array, valid: Array, visible: NDArray[np.bool_]) -> dict[str, Any]:
    """Error figures over the rows at which raw and filtered value exist, and the share of all rows that are valid."""
    both = np.isfinite(error) & np.isfinite(raw)
    error, raw, sd, visible = error[both], raw[both], sd[both], visible[both]
    claimed = (sd > 0.0) & np.isfinite(sd)
    relative = error[claimed] / sd[claimed]
    nees = relative[visible[claimed]] ** 2
    rmse, rmse_raw = _rms(error), _rms(raw)
    return {
        "rmse": rmse,
        "rmse_raw": rmse_raw,
        "reduction_percent": _reduction(rmse, rmse_raw),
        "bias": _number(error.mean()) if error.size else None,
        "max_error": _number(np.abs(error).max()) if error.size else None,
        "nees_mean": _number(nees.mean()) if nees.size else None,
        "coverage_95": _covered(relative, TWO_SIGMA),
        "coverage_1_sigma": _covered(relative, 1.0),
        "coverage_2_sigma": _covered(relative, 2.0),
        "coverage_3_sigma": _covered(relative, 3.0),
        "valid_fraction": _number(valid.mean()) if valid.size else None,
        "samples": int(error.size),
    }


def _covered(relative: Array, sigmas: float) -> float | None:
    """Share of errors within so many claimed standard deviations."""
    return _number((np.abs(relative) <= sigmas).mean()) if relative.size else None


def _innovations(nis: Array) -> dict[str, Any]:
    """Mean NIS of both pressures' readings, and the probability that white innovations look as coloured as these.

    The latter is McLeod and Li's test on the total pressure's: autocorrelations of the squares.
    """
    total, both = nis[:, 0][np.isfinite(nis[:, 0])], nis[np.isfinite(nis)]
    return {
        "nis_mean": _number(both.mean()) if both.size else None,
        "whiteness": _number(ljung_box(total)[1]) if total.size >= LAGS + LEAST else None,
    }


def _pressure(flight: Judged, channel: str) -> dict[str, Any]:
    """Error of a pressure channel after its own mean before launch (given as `bias`) is removed."""
    name = f"p_{channel}"
    time = flight.estimate("t")
    truth = np.interp(time, flight.time, flight.truth(name))
    error = flight.estimate(name) - truth
    raw = _reading(flight, name, time) - truth
    air = flight.scenario.air_data
    exist = np.isfinite(error) & np.isfinite(raw)
    before, rows = exist & (time < flight.release_time), exist & flight.rows(time)
    if channel == "total" and air.tare != "none":  # before, it is not tared, and a cover keeps the free stream out
        before &= time > flight.release_time - air.cover_off + SETTLED
    if not before.any():
        return dict.fromkeys(PRESSURE)
    bias = error[before].mean()
    rmse, rmse_raw = _rms(error[rows] - bias), _rms(raw[rows] - raw[before].mean())
    nis = flight.estimate(f"nis_{channel}")[rows]
    nis = nis[np.isfinite(nis)]
    return {
        "rmse": rmse,
        "rmse_raw": rmse_raw,
        "reduction_percent": _reduction(rmse, rmse_raw),
        "bias": _number(bias),
        "nis_mean": _number(nis.mean()) if nis.size else None,
    }


def _reading(flight: Judged, name: str, time: Array) -> Array:
    """Return the head's last reading at each time."""
    readings = flight.tables["air_data"]
    at = np.searchsorted(np.asarray(readings["t"], dtype=float), time, side="right") - 1
    return np.asarray(readings[name], dtype=float)[np.maximum(at, 0)]


def _flight(flight: Judged) -> dict[str, Any]:
    time, speed = flight.time, flight.truth("airspeed")
    exit_time = flight.rail_exit_time
    cruise = speed[flight.rows(time, "cruise") & np.isfinite(speed)]
    altitude = flight.truth("altitude")[time >= (np.inf if exit_time is None else exit_time)]
    altitude = altitude[np.isfinite(altitude)]
    return {
        "ready": _ready(flight),
        "rail_exit_time": exit_time,
        "rail_exit_speed": None if exit_time is None else _number(np.interp(exit_time, time, speed)),
        "wing_start_time": flight.wing_start_time,
        "wing_out_time": flight.wing_out_time,
        "cruise_airspeed": _number(cruise.mean()) if cruise.size else None,
        "cruise_airspeed_sd": _number(cruise.std()) if cruise.size else None,
        "duration": _number(time[-1]) if time.size else None,
        "rail_exit_altitude": _number(altitude[0]) if altitude.size else None,
        "lowest_altitude_after_exit": _number(altitude.min()) if altitude.size else None,
    }


def _ready(flight: Judged) -> bool | None:
    """Whether the flight computer called itself ready when the latch let go; None if it had said nothing."""
    said = [e["event"] for e in flight.events if e["event"] in ("ready", "not_ready") and e["t"] <= flight.release_time]
    return said[-1] == "ready" if said else None


def _requirement(result: dict[str, Any], wanted: "Requirement") -> dict[str, Any]:
    """Hold a figure against its bounds; one that does not exist, or is no number, does not meet them."""
    found: Any = result
    for part in wanted.key.split("."):
        found = found.get(part) if isinstance(found, dict) else None
    value = found if isinstance(found, int | float) else None
    low, high = wanted.minimum, wanted.maximum
    met = value is not None and (low is None or value >= low) and (high is None or value <= high)
    return {"key": wanted.key, "minimum": low, "maximum": high, "value": value, "met": met}


def _difference(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a - b


def _rms(error: Array) -> float | None:
    return _number(np.sqrt(np.mean(error**2))) if error.size else None


def _reduction(rmse: float | None, raw: float | None) -> float | None:
    return None if rmse is None or not raw else 100.0 * (1.0 - rmse / raw)


def _number(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None
