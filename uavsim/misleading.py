"""An airspeed that is called valid and is wrong: how long, and how often the validity is lost.

Misleading is a valid airspeed that is more than 3 m/s off the true one; hazardous one that stays so for more than 1 s.
That is the event whose probability the integrity of an air-data system is about; what is lost instead, validity, is its
continuity (RTCA DO-229 gives both words for navigation, and they mean the same here).

What is told holds until something else is told: an airspeed that is not renewed stays as it was, valid or not.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.set_faults import set_faults

if TYPE_CHECKING:
    from uavsim.judged import Judged

Array = NDArray[np.float64]

OFF = 3.0  # m/s from which on a valid airspeed misleads: a tenth of what is flown, and the margin over the stall
HAZARD = 1.0  # s of it without a break from which on that is a hazard
LOST = 0.1  # s for which an airspeed that was valid is not, to count as a loss: as the flight computer gives it up
FLAG = "airspeed_fault"


def figures(flight: "Judged") -> dict[str, Any]:
    """Return the score's figures of integrity and continuity; those of the airspeed None where there is none."""
    flags = [event["t"] for event in flight.events if event["event"] == FLAG]
    begins = min((fault.start for fault in set_faults(flight.scenario)), default=np.inf)
    result: dict[str, Any] = {
        "flags": len(flags),
        "false_flags": sum(t < begins for t in flags),
        "losses": None,
        "hazard": None,
        "hazard_time": None,
    }
    rows = flight.rows(flight.time) & np.isfinite(flight.truth("airspeed"))
    told = flight.estimate("t")
    if not rows.any() or not told.size:
        return result
    time = flight.time[rows]
    at = np.searchsorted(told, time, side="right") - 1
    valid = (flight.estimate("valid")[at] == 1.0) & (at >= 0)
    with np.errstate(invalid="ignore"):
        near = np.abs(flight.estimate("airspeed")[at] - flight.truth("airspeed")[rows]) <= OFF
    longest = max(spells(time, valid & ~near), default=0.0)
    first = int(np.argmax(valid)) if valid.any() else valid.size
    losses = sum(spell >= LOST for spell in spells(time[first:], ~valid[first:]))
    return result | {"losses": losses, "hazard": bool(longest > HAZARD), "hazard_time": longest}


def spells(time: Array, during: NDArray[np.bool_]) -> list[float]:
    """Return how long each spell lasts in which a condition holds without a break, s: to the first row without it."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], during, [False])).astype(np.int8)))
    last = time.size - 1
    return [float(time[min(end, last)] - time[start]) for start, end in edges.reshape(-1, 2).tolist()]
