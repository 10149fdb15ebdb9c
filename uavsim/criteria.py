"""How a flight ended, and why it did not end otherwise: the criteria of each outcome, with the worst value of each.

An outcome other than `cruise` and `completed`, and either of these where it is not expected, has a reason: the
criterion in words, then its worst value, when, and the bound. The words before the first number are the cause by which
campaigns count flights (`uavsim.studies.campaign.causes`).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.failure import FAILED
from uavsim.judged import CROSSING, WING_OUT, Judged
from uavsim.onboard.launch.settings import if_known
from uavsim.truth import STANDARD_GRAVITY

if TYPE_CHECKING:
    from collections.abc import Callable

Array = NDArray[np.float64]

MISSED_AFTER = 0.5  # s after the last shoe has left, until which a launch may be recognised
LAST = 5.0  # s at the end over which cruise is judged
SPEED_TOLERANCE = 2.0  # m/s
BANK_LIMIT = np.pi / 6.0  # rad, in cruise, and of an aircraft that is upright
SOFT = 1.5  # m/s of sink, below which an aircraft that touches the ground upright has landed
NOSE_LOW, NOSE_HIGH = -np.pi / 36.0, np.pi / 9.0  # rad, -5° and 20°: below it goes on its nose, above on its tail
TOUCHED = "touched"
ON_GROUND = (TOUCHED, "crashed", "landed")  # how a flight ended that touched it, in the loop and as a record has it


def outcome(flight: Judged) -> str:
    """Name the first that applies, in the order of `docs/score.md`."""
    (_, acted), exit_time = _acts(flight), flight.rail_exit_time
    if flight.ended in ("diverged", FAILED):
        return flight.ended
    if flight.is_rig:
        return "completed"
    if acted is not None and (exit_time is None or acted < exit_time):
        return "false_launch"
    if _is_missed(flight):
        return "missed_launch"
    if flight.ended in ON_GROUND:
        return "landed" if _lands(flight) else "crashed"
    return "cruise" if all(criterion.met for criterion in criteria(flight)) else "timeout"


def reason(flight: Judged, ended: str) -> str | None:
    """Say why a flight ended with an outcome; None of a cruise or a rig's end that is expected."""
    expected = flight.scenario.expect
    if ended == expected and ended in ("cruise", "completed"):
        return None
    told: dict[str, Callable[[Judged], str]] = {
        "diverged": _diverged,
        FAILED: lambda flight: flight.said,
        "false_launch": _too_soon,
        "missed_launch": _missed,
        "crashed": touchdown,
        "landed": touchdown,
        "timeout": _timeout,
        "cruise": lambda flight: f"cruise all the same: {'; '.join(one.said for one in criteria(flight))}",
        "completed": lambda _: "a rig ends with this outcome, whatever is expected of it",
    }
    return told[ended](flight) or None


def _timeout(flight: Judged) -> str:
    if flight.true_time is None and flight.detected_time is None:
        return _missed(flight)
    return "; ".join(one.said for one in criteria(flight) if not one.met)


# -- cruise ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Criterion:
    """One of those that make a cruise.

    Attributes
    ----------
    met
        Whether it is.
    said
        In words: what is judged, its worst value, and the bound.
    """

    met: bool
    said: str


def criteria(flight: Judged) -> list[Criterion]:
    """Return what makes a cruise: wing out, motor on, airspeed held and wings level through the last 5 s."""
    return [_wing(flight), _motor(flight), _airspeed(flight), _bank(flight)]


def _last(flight: Judged) -> NDArray[np.bool_]:
    return np.asarray(flight.time >= flight.time[-1] - LAST)


def _worst(flight: Judged, badness: Array) -> tuple[float, int]:
    """Time and place of the worst row of the last 5 s; what is no number is worst of all."""
    rows = np.flatnonzero(_last(flight))
    worst = int(rows[np.argmax(np.where(np.isnan(badness[rows]), np.inf, badness[rows]))])
    return float(flight.time[worst]), worst


def _wing(flight: Judged) -> Criterion:
    wing = flight.truth("wing")
    when, row = _worst(flight, -wing)
    met = bool(np.all(wing[_last(flight)] >= WING_OUT))
    words = "wing out" if met else "wing not out"
    return Criterion(met, f"{words}: {wing[row]:.2f} at {when:.2f} s, at least {WING_OUT:g} over the last {LAST:g} s")


def _motor(flight: Judged) -> Criterion:
    motor, latest = flight.event_time("motor_on"), float(flight.time[-1]) - LAST
    if motor is None:
        return Criterion(met=False, said="motor never on")
    met = motor <= latest
    return Criterion(met, f"motor {'on' if met else 'on too late'}: at {motor:.2f} s, at the latest at {latest:.2f} s")


def _airspeed(flight: Judged) -> Criterion:
    target = flight.scenario.flight_computer.airspeed
    off = flight.truth("airspeed") - target
    when, row = _worst(flight, np.abs(off))
    met = bool(np.all(np.abs(off[_last(flight)]) <= SPEED_TOLERANCE))
    words = "true airspeed held" if met else "true airspeed not held"
    return Criterion(
        met,
        f"{words}: {off[row]:+.2f} m/s off the set {target:g} m/s at {when:.2f} s, "
        f"at most ±{SPEED_TOLERANCE:g} m/s over the last {LAST:g} s{'' if met else _given_up(flight)}",
    )


def _given_up(flight: Judged) -> str:
    """Say since when nobody on board has known the airspeed, if nobody does at the end."""
    told = [event for event in flight.events if event["event"] in ("airspeed_lost", "airspeed_back")]
    lost = told and told[-1]["event"] == "airspeed_lost"
    return f"; on board it was given up at {told[-1]['t']:.2f} s" if lost else ""


def _bank(flight: Judged) -> Criterion:
    roll = np.abs(flight.truth("roll"))
    when, row = _worst(flight, roll)
    met = bool(np.all(roll[_last(flight)] < BANK_LIMIT))
    words = "bank" if met else "bank too steep"
    return Criterion(
        met,
        f"{words}: {np.degrees(roll[row]):.1f}° at {when:.2f} s, below {np.degrees(BANK_LIMIT):.0f}° over the "
        f"last {LAST:g} s",
    )


# -- the ground ------------------------------------------------------------------------------------------------------


def _at_touch(flight: Judged) -> tuple[float, float, float]:
    """Sink, m/s, roll and pitch, rad, of a flight's last row."""
    sink, roll, pitch = (float(flight.truth(name)[-1]) for name in ("vd", "roll", "pitch"))
    return sink, roll, pitch


def _lands(flight: Judged) -> bool:
    """Whether it has touched the ground as an aircraft that lands does: slowly, wings level, nose up."""
    sink, roll, pitch = _at_touch(flight)
    return sink < SOFT and abs(roll) < BANK_LIMIT and NOSE_LOW <= pitch <= NOSE_HIGH


def touchdown(flight: Judged) -> str:
    """Say in one line how and where a flight touched the ground."""
    sink, roll, pitch = _at_touch(flight)
    return (
        f"touched the ground at {flight.time[-1]:.2f} s: sink {sink:.2f} m/s, roll {np.degrees(roll):z.0f}°, "
        f"pitch {np.degrees(pitch):z.0f}°{_place(flight)}"
    )


def _place(flight: Judged) -> str:
    """Say where the last row is, along the launch and across it; nothing of a record without a place."""
    truth = flight.tables["truth"]
    if "north" not in truth or "east" not in truth:
        return ""
    north, east = (float(flight.truth(name)[-1]) for name in ("north", "east"))
    heading = np.radians(flight.scenario.launcher.heading_deg)
    ahead = north * np.cos(heading) + east * np.sin(heading)
    right = east * np.cos(heading) - north * np.sin(heading)
    aside = "" if abs(right) < 0.5 else f", {abs(right):.0f} m to the {'right' if right > 0.0 else 'left'}"
    return f"; {abs(ahead):.0f} m {'ahead of' if ahead >= 0.0 else 'behind'} the launcher{aside}"


# -- the launch and its end ------------------------------------------------------------------------------------------


def _acts(flight: Judged) -> tuple[str, float | None]:
    """What must not happen on the rail, and when it does: the wings' command, of a fixed wing the motor's."""
    if flight.is_fixed_wing:
        return "motor running", flight.event_time("motor_on")
    return "wings commanded", flight.event_time("wings_commanded")


def _too_soon(flight: Judged) -> str:
    (what, when), exit_time = _acts(flight), flight.rail_exit_time
    left = "never leaves the rail" if exit_time is None else f"leaves the rail at {exit_time:.3f} s"
    return f"{what} on the rail: at {when:.3f} s, the last shoe {left}"


def _is_missed(flight: Judged) -> bool:
    """Whether there was a launch, and it was not recognised in time; where nothing moves there is none to miss."""
    exit_time, detected = flight.rail_exit_time, flight.detected_time
    if detected is None:
        return flight.true_time is not None
    return exit_time is not None and detected > exit_time + MISSED_AFTER


def _missed(flight: Judged) -> str:
    exit_time, detected = flight.rail_exit_time, flight.detected_time
    if detected is not None and exit_time is not None:
        return (
            f"launch recognised too late: {detected - exit_time:.3f} s after the last shoe has left, at most "
            f"{MISSED_AFTER:g} s"
        )
    if flight.true_time is None:
        return f"the aircraft has not left its place: no launch by {flight.time[-1]:.2f} s"
    settings, axis = flight.scenario.detector, flight.scenario.launch_axis
    force = flight.truth(f"f{axis[1]}") * (-1.0 if axis[0] == "-" else 1.0)
    greatest = float(np.nanmax(np.where(flight.time >= flight.release_time, force, np.nan), initial=-np.inf))
    lines = if_known(settings).lines
    levels = {} if lines is None else lines(settings)
    told = "".join(f", {name} of the detector {level / STANDARD_GRAVITY:.2f} g" for name, level in levels.items())
    return (
        f"launch not recognised: greatest true specific force along {axis} {greatest / STANDARD_GRAVITY:.2f} g, "
        f"level of a launch {CROSSING / STANDARD_GRAVITY:g} g{told}"
    )


def _diverged(flight: Judged) -> str:
    if flight.said:
        return flight.said
    truth = flight.tables["truth"]
    first: tuple[float, str] | None = None
    for name in truth:
        values = np.asarray(truth[name])
        if values.dtype.kind != "f":
            continue
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size and wrong.size < values.size and (first is None or flight.time[wrong[0]] < first[0]):
            first = float(flight.time[wrong[0]]), name
    return "" if first is None else f"the state is not finite: {first[1]} from {first[0]:.3f} s on"
