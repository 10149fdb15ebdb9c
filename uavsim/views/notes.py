"""Remarks that a flight's report makes on its own figures: what they mean and why they are so."""

from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.onboard.airspeed.kinds import is_aided
from uavsim.scenario import Scenario, scenario_of
from uavsim.set_faults import set_faults
from uavsim.views.faults import noticed, told

if TYPE_CHECKING:
    from uavsim.flight import Flight


PAPER_GAIN = 0.8  # of the published method's filter on the total pressure
LITTLE = 5.0  # %, a reduction of the RMSE that is not worth a filter
QUIET = 0.5  # share of the lag below which a sensor's noise is too little to be worth it
FINDINGS = 6  # that are told one by one
MOSTLY = 0.7  # share of the RMSE that makes the bias the story
HALF = 0.5  # share of the estimate's bias that the readings must have for it to be theirs
ASTRAY = 1.0  # m/s, bias of an estimate whose readings have none that is worth a word
OFTEN = 0.1  # share of readings at the end of a sensor's range that tells where an error comes from


def notes(flight: "Flight") -> list[str]:
    """Sentences on a flight's score, none where nothing needs saying."""
    scenario = scenario_of(flight)
    found = [
        _faults(flight, scenario),
        _stroke(flight, scenario),
        _bias(flight, scenario) or _no_help(flight, scenario),
        _lag(flight, scenario),
        _single_flight(flight),
        *(f"{remark}." for remark in flight.score.get("remarks", ())),
    ]
    return [note for note in found if note]


def _faults(flight: "Flight", scenario: Scenario) -> str:
    """Say what was made to go wrong and what was found of it on board, or what was found where nothing was wrong.

    On a rig without air there is no airspeed to lose.
    """
    if not flight.score["airspeed"]["samples"]:
        return ""
    wrong = told(scenario, float(flight.score["flight"]["duration"]))
    found = [_found(event) for event in flight.events if noticed(event)]
    more = f" and {len(found) - FINDINGS} more" if len(found) > FINDINGS else ""
    listed = (", ".join(found[:FINDINGS]) or "nothing") + more
    if wrong:
        return f"set to go wrong: {wrong}. Found on board: {listed}."
    return f"nothing was set to go wrong; found on board: {listed}." if found else ""


def _found(event: dict[str, Any]) -> str:
    kind = f" as {event['kind']}" if event.get("kind") else ""
    return f"{noticed(event)}{kind} at {event['t']:.2f} s"


def _stroke(flight: "Flight", scenario: Scenario) -> str:
    stroke = flight.score["airspeed"]["stroke"]
    if stroke["reduction_percent"] is None:
        return ""
    ratio = stroke["rmse"] / stroke["rmse_raw"]
    said = f"in the stroke the filtered RMSE is {ratio:.2f} of the raw one"
    if ratio <= 1.0:
        return f"{said}."
    launch = flight.score["launch"]["detected_time"] is not None
    unaided = is_aided(scenario.estimator.kind) and not launch
    why = "; without a detected launch the specific force does not aid it." if unaided else "."
    return f"{said}: while the airspeed rises the filter's lag adds to the sensors' delay{why}"


def _lag(flight: "Flight", scenario: Scenario) -> str:
    """Say why a filtered pressure is worse than the readings, where no stroke has said it yet."""
    stroke = flight.score["airspeed"]["stroke"]
    pressure = flight.score["pressure"]
    gains = {name: pressure[name]["reduction_percent"] for name in ("total", "static")}
    worse = [name for name, gain in gains.items() if gain is not None and gain < -LITTLE]
    if (
        not worse
        or not flight.score["airspeed"]["samples"]
        or stroke["reduction_percent"] is not None
        or set_faults(scenario)
    ):
        return ""
    said = " and ".join(f"{name} pressure {1.0 - 0.01 * gains[name]:.2f}" for name in worse)
    return f"filtered RMSE over raw: {said}; while a pressure keeps rising or falling its filter lags behind."


def _bias(flight: "Flight", scenario: Scenario) -> str:
    """Say where an error comes from that is mostly a bias: from the readings, and why, or from the estimator."""
    airspeed = flight.score["airspeed"]
    if not airspeed["rmse"] or abs(airspeed["bias"]) < MOSTLY * airspeed["rmse"]:
        return ""
    raw = _raw_bias(flight)
    if raw is None or raw * airspeed["bias"] < HALF * airspeed["bias"] ** 2:
        return _astray(airspeed["bias"], raw)
    said = f"the airspeed error is mostly a bias of {airspeed['bias']:.2f} m/s"
    if set_faults(scenario):
        return f"{said}, a fault having been set."
    return f"{said}, which the readings have, too, and no filter takes away{_cause(flight, scenario)}."


def _raw_bias(flight: "Flight") -> float | None:
    """Mean error of the airspeed of the readings over the rows that are scored, m/s; None if there is none."""
    truth, estimate = flight.truth, flight.estimate
    time = truth["t"].to_numpy(float)
    scored = truth["phase"].to_numpy(object) != "rail"
    if not scored.any():
        return None
    told = estimate[estimate["t"] >= time[scored][0]]
    error = told["airspeed_raw"].to_numpy(float) - np.interp(told["t"], time, truth["airspeed"])
    error = error[np.isfinite(error)]
    return float(error.mean()) if error.size else None


def _astray(bias: float, raw: float | None) -> str:
    """Say that it is the estimator which is off and not the readings, where that is worth a word."""
    if raw is None or abs(bias) < ASTRAY or abs(raw) >= abs(bias):
        return ""
    return (
        f"the estimate is {bias:+.2f} m/s off in the mean and the airspeed of the readings {raw:+.2f} m/s: it is the "
        "estimator that is off, not the sensors."
    )


def _cause(flight: "Flight", scenario: Scenario) -> str:
    """Name what makes the readings' bias as far as they show it: the end of a range, or a pair that nobody tared."""
    air = scenario.air_data
    for name, settings in (("total", air.total), ("static", air.static)):
        part = settings.description()
        values = flight.air_data[f"p_{name}"].to_numpy(float)
        step = max(part.noise_sd, 1.0)
        low, high = (float(np.mean(np.abs(values - end) <= step)) for end in part.range)
        if max(low, high) > OFTEN:
            end = part.range[1] if high >= low else part.range[0]
            share = 100.0 * max(low, high)
            return f": the {name} pressure stands at its sensor's end, {end / 1e3:g} kPa, in {share:.0f} % of readings"
    return " (air_data.tare is 'none': nobody has tared the pair)" if air.tare == "none" else ""


def _no_help(flight: "Flight", scenario: Scenario) -> str:
    """Why a constant-gain filter cannot help sensors that are quieter than its lag."""
    airspeed = flight.score["airspeed"]
    if airspeed["reduction_percent"] is None or airspeed["reduction_percent"] > LITTLE:
        return ""
    noise, gain, slope, interval = _total_channel(flight, scenario)
    lag = slope * interval * (1.0 - PAPER_GAIN) / PAPER_GAIN
    if noise > QUIET * lag:
        return ""  # it is something else: a fault, an offset
    kept = (PAPER_GAIN / (2.0 - PAPER_GAIN)) ** 0.5
    return (
        f"this filter cannot help here: the sensor's noise is {noise:.2f} Pa rms every {1e3 * interval:.1f} ms. A gain "
        f"of {PAPER_GAIN} would leave {noise * kept:.2f} Pa of it, and lag {lag:.1f} Pa behind the stroke's pressure "
        f"rise of {slope:.0f} Pa/s; in this scenario the gain is {gain:.2f}."
    )


def _total_channel(flight: "Flight", scenario: Scenario) -> tuple[float, float, float, float]:
    """Noise, Pa, steady gain, steepest rise in the stroke, Pa/s, and interval, s, of the total pressure.

    A random-walk filter of steady gain K leaves sqrt(K / (2 - K)) of white noise and follows a ramp with an error of
    slope * interval * (1 - K) / K.
    """
    from uavsim.beliefs import believed_noise
    from uavsim.onboard.airspeed import process_noise, steady_gain

    believed = believed_noise(scenario)
    noise = believed.total_sd
    stroke = flight.truth[flight.truth["phase"] == "stroke"]
    slope = float(np.max(np.gradient(stroke["p_total"].to_numpy(), stroke["t"].to_numpy()))) if len(stroke) > 1 else 0.0
    interval = float(np.median(np.diff(np.unique(flight.air_data["t_total"].dropna().to_numpy()))))
    return noise, steady_gain(process_noise(scenario.estimator, believed)[0], noise**2), slope, interval


def _single_flight(flight: "Flight") -> str:
    cruise: dict[str, Any] = flight.score["airspeed"]["cruise"]
    if cruise["coverage_95"] is None:
        return ""
    return "coverage and NEES of one flight prove little; judge them over many (--seeds 1-50)."
