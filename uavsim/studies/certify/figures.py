"""What is kept of a flight: sums and extremes of its airspeed's error, what was flagged, and whether it was ready.

Over the rows of each scored phase (docs/score.md; of a rig its run), with e the error of the airspeed and s its claimed
standard deviation:

    rows, valid         how many, and of how many of them `valid` is true
    within, within_valid  |e| ≤ 1.96 s, of all rows and of valid ones; an estimate that is no number is outside
    square, bound       Σ e² over all rows with a number, and Σ of the Cramér-Rao bound's variance at the same rows
    sd                  median of s

and over the whole flight the greatest |e|/s and |e| of a valid row, and the longest time for which a valid airspeed was
more than 3 m/s wrong without a break.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.flight import Flight
from uavsim.judged import RUN
from uavsim.score_keys import PHASES
from uavsim.studies.airspeed_flights import LEAD, NORMAL_95, bound, course, together

Array = NDArray[np.float64]
Row = dict[str, Any]

WRONG = 3.0  # m/s, error from which on an airspeed misleads


def figures(flight: Flight, *, bounded: bool = False) -> Row:
    """Return a flight's figures as columns of a row.

    Parameters
    ----------
    flight
        Any; of one that was not launched the phases are empty.
    bounded
        Whether the Cramér-Rao bound of its own course is computed, for phases after the rail.
    """
    score = flight.score
    launch, times = score["launch"], score["flight"]
    errors = Errors(flight)
    row: Row = {
        "outcome": score["outcome"],
        "reason": score.get("reason") or "",
        "true_time": launch["true_time"],
        "latency": launch["latency"],
        "since_crossing": launch["latency_from_crossing"],
        "detections": launch["detections"],
        "false_detections": launch["false_detections"],
        "hours": _hours(flight),
        "ready": times.get("ready"),
        "not_ready": readiness(flight)[1],
        "wing_out": times["wing_out_time"],
    }
    row |= flags(flight)
    row |= errors.worst()
    allowed = _allowed(flight) if bounded and launch["detected_time"] is not None else None
    for phase in (*PHASES, RUN):
        row |= {f"{phase}.{key}": value for key, value in errors.phase(phase, allowed).items()}
    return row


class Errors:
    """A flight's airspeed held against the truth, row by row.

    Attributes
    ----------
    t, error, sd : ndarray
        Time, s, error and claimed standard deviation, m/s; shape (r,).
    valid : ndarray of bool
    phase_of : ndarray of str
    """

    def __init__(self, flight: Flight) -> None:
        estimate, truth = flight.estimate, flight.truth
        time = truth["t"].to_numpy(float)
        self.t: Array = estimate["t"].to_numpy(float)
        self.true: Array = np.interp(self.t, time, truth["airspeed"].to_numpy(float))
        self.error: Array = estimate["airspeed"].to_numpy(float) - self.true
        self.sd: Array = estimate["airspeed_sd"].to_numpy(float)
        self.valid = estimate["valid"].to_numpy(bool)
        at = np.clip(np.searchsorted(time, self.t, side="right") - 1, 0, max(time.size - 1, 0))
        self.phase_of = truth["phase"].to_numpy(object)[at]

    @property
    def within(self) -> NDArray[np.bool_]:
        """Whether the error is within 1.96 standard deviations; false where there is no number."""
        found: NDArray[np.bool_] = np.abs(self.error) <= NORMAL_95 * self.sd
        return found

    def phase(self, phase: str, allowed: tuple[Array, Array, float] | None) -> Row:
        """Return the sums over a phase."""
        rows = self.phase_of == phase
        error, sd, valid = self.error[rows], self.sd[rows], self.valid[rows]
        there = np.isfinite(error)
        found: Row = {
            "rows": int(rows.sum()),
            "valid": int(valid.sum()),
            "within": int(self.within[rows].sum()),
            "within_valid": int((self.within[rows] & valid).sum()),
            "square": float(np.sum(error[there] ** 2)),
            "counted": int(there.sum()),
            "sd": float(np.median(sd[np.isfinite(sd)])) if np.isfinite(sd).any() else None,
            "bound": None,
            "bounded_square": None,
        }
        if allowed is not None and phase != "stroke":
            t, least, true_time = allowed
            since = self.t[rows] - true_time
            known = there & (since >= t[0]) & (since <= t[-1])
            found["bound"] = float(np.sum(np.interp(since[known], t, least) ** 2))
            found["bounded_square"] = float(np.sum(error[known] ** 2))
        return found

    def worst(self) -> Row:
        """Return the greatest errors of valid rows, wherever they are."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(self.valid, np.abs(self.error) / self.sd, 0.0)
        ratio = np.where(np.isnan(ratio) & self.valid, np.inf, np.nan_to_num(ratio, nan=0.0, posinf=1e9))
        size = np.where(self.valid, np.abs(self.error), 0.0)
        k = int(np.argmax(ratio)) if ratio.size else 0
        return {
            "worst_ratio": min(float(ratio[k]), 1e9) if ratio.size else 0.0,
            "worst_ratio_t": float(self.t[k]) if ratio.size else None,
            "worst_error": float(np.nan_to_num(size, nan=1e9).max(initial=0.0)),
            "wrong_for": self.wrong_for(),
        }

    def wrong_for(self, after: float = -np.inf) -> float:
        """Longest time without a break for which a valid airspeed is more than `WRONG` off, s."""
        bad = self.valid & ~(np.abs(self.error) <= WRONG) & (self.t >= after)
        edges = np.diff(np.concatenate([[False], bad, [False]]).astype(int))
        first, end = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
        if not first.size:
            return 0.0
        return float(np.max(self.t[end - 1] - self.t[first]))


def flags(flight: Flight) -> Row:
    """Return what was blamed: how often, the first one, and how often one was taken back or the airspeed was lost.

    Every event with `fault` in its name blames a channel.
    """
    blamed = [event for event in flight.events if "fault" in event["event"]]
    first = blamed[0] if blamed else {}
    return {
        "flags": len(blamed),
        "flag_t": first.get("t"),
        "flag_channel": first.get("channel", ""),
        "flag_kind": first.get("kind", ""),
        "taken_back": sum(event["event"] == "airspeed_recovered" for event in flight.events),
        "losses": sum(event["event"] == "airspeed_lost" for event in flight.events),
    }


def _hours(flight: Flight) -> float:
    """How long it has flown since the true launch, h."""
    true = flight.score["launch"]["true_time"]
    end = float(flight.truth["t"].iloc[-1])
    return max(0.0, end - (end if true is None else true)) / 3600.0


def readiness(flight: Flight, until: float = np.inf) -> tuple[bool | None, str]:
    """Return the last word on whether it is ready up to a time, None if there is none, and the reasons against it."""
    said = [event for event in flight.events if event["event"] in ("ready", "not_ready") and event["t"] <= until]
    if not said:
        return None, ""
    reasons = said[-1].get("reasons") or ""
    told = reasons if isinstance(reasons, str) else "; ".join(map(str, reasons))
    return (True, "") if said[-1]["event"] == "ready" else (False, told)


def _allowed(flight: Flight) -> tuple[Array, Array, float] | None:
    """Times since the true launch, the bound's standard deviation there, and the true launch."""
    flown = course(flight)
    if flown.airspeed.size < 2 or flight.score["launch"]["true_time"] < LEAD:
        return None
    t, least = bound(flight, together([flown]))
    return (t, least, flight.score["launch"]["true_time"]) if t.size else None
