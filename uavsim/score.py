"""How well: launch timing, airspeed error, consistency of the claimed uncertainty, integrity, requirements.

Everything is judged against the plant's truth; its times and phases are in `judged`, outcomes and their reasons in
`criteria`, what of a valid airspeed misleads in `misleading`. Headline figures are over all phases together, those of a
rig over its whole run. Where there is no airspeed there is no figure of it.

Truth is interpolated linearly to the time of an estimate's row. Raw and filtered figures are over the same rows, those
at which both exist; rows that the estimator itself calls invalid count. A value that does not exist is None (null in
JSON), never 0. The error of calibrated and equivalent airspeed (`airspeeds`) is over the rows that have one.

Whether the claimed uncertainty is what it is: NEES, coverage, NIS and whiteness as in `consistency`. Below V*, the
speed that the noise hides, an error over its claim says nothing: there V < 2 σ_V.
"""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim import misleading
from uavsim.consistency import LAGS, LEAST, ljung_box
from uavsim.criteria import outcome, reason
from uavsim.files import without_none
from uavsim.judged import Array, Judged
from uavsim.score_keys import PHASES, PRESSURE, PRESSURES, SPEEDS

if TYPE_CHECKING:
    from uavsim.requirements import Requirement

SETTLED = 0.05  # s after the tare in which the last covered conversion leaves the sensor and the filter
TWO_SIGMA = 1.959964  # standard normal quantile of 97.5 %
HIDDEN = 2.0  # σ_V: an airspeed below it is below V*


def score(flight: Judged) -> dict[str, Any]:
    """Judge a flight; keys, units and meanings as in `docs/score.md`."""
    with np.errstate(over="ignore", invalid="ignore"):  # a flight that diverged may hold any number
        return _score(flight)


def _score(flight: Judged) -> dict[str, Any]:
    from uavsim.installation import installation  # late: a score that is read needs no sensors

    launch = _launch(flight)
    airspeed = _airspeed(flight)
    ended = outcome(flight)
    result: dict[str, Any] = {
        "outcome": ended,
        "expected": flight.scenario.expect,
        "reason": reason(flight, ended),
        "seed": flight.scenario.seed,
        "plugins": [without_none(asdict(source)) for source in flight.scenario.plugins],
        "versions": dict(flight.versions),
        "launch": launch,
        "airspeed": airspeed,
        "pressure": {name: _pressure(flight, name) for name in PRESSURES},
        "flight": _flight(flight),
        "installation": installation(flight.tables["truth"], flight.scenario.air_data, flies=not flight.is_rig),
        "requirements": [],
        "remarks": [],
    }
    result["requirements"] = [_requirement(result, r) for r in flight.scenario.requirements if r.of_each_flight]
    return result


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
    others = {
        name: told - np.interp(time, flight.time, true)
        for name, told, true in zip(SPEEDS, flight.told_airspeeds, flight.true_airspeeds, strict=True)
    }
    figures = {"": flight.rows(time) & exists} | {name: flight.rows(time, name) & exists for name in PHASES}
    result = {
        name: {
            **error_figures(error[rows], raw[rows], sd[rows], valid[rows], visible[rows]),
            **innovation_figures(nis[rows]),
            **{speed: _errors(other[rows]) for speed, other in others.items()},
        }
        for name, rows in figures.items()
    }
    return {
        "estimator": flight.scenario.estimator.kind,
        **result.pop(""),
        **misleading.figures(flight),
        **result,
    }


def _errors(error: Array) -> dict[str, float | None]:
    """Size, mean and worst of an error, over the rows that have one."""
    error = error[np.isfinite(error)]
    return {
        "rmse": _rms(error),
        "bias": _number(error.mean()) if error.size else None,
        "max_error": _number(np.abs(error).max()) if error.size else None,
    }


def error_figures(error: Array, raw: Array, sd: Array, valid: Array, visible: NDArray[np.bool_]) -> dict[str, Any]:
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


def innovation_figures(nis: Array) -> dict[str, Any]:
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
