"""Remarks that a flight's report makes on its own figures: what they mean and why they are so."""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from uavsim.flight import Flight


def notes(flight: "Flight") -> list[str]:
    """Sentences on a flight's score, none where nothing needs saying."""
    found = [_stroke(flight), _no_help(flight), _single_flight(flight)]
    return [note for note in found if note]


def _stroke(flight: "Flight") -> str:
    stroke = flight.score["airspeed"]["stroke"]
    if stroke["reduction_percent"] is None:
        return ""
    ratio = stroke["rmse"] / stroke["rmse_raw"]
    return f"in the stroke the filtered RMSE is {ratio:.2f} of the raw one" + (
        ": while the airspeed rises the filter's lag adds to the sensors' delay." if ratio > 1.0 else "."
    )


def _no_help(flight: "Flight") -> str:
    """Why a constant-gain filter cannot help sensors that are quieter than its lag."""
    airspeed = flight.score["airspeed"]
    if airspeed["reduction_percent"] is None or airspeed["reduction_percent"] > 0.0:
        return ""
    lag, noise, gain, interval = _lag_against_noise(flight)
    return (
        f"this filter cannot help here: with a gain of {gain:.2f} every {1e3 * interval:.1f} ms the stroke's pressure "
        f"rise makes it lag by up to {lag:.1f} Pa, and the sensor's noise, all that it could take away, is "
        f"{noise:.2f} Pa rms."
    )


def _lag_against_noise(flight: "Flight") -> tuple[float, float, float, float]:
    """Largest ramp lag, noise, Pa, gain and interval, s, of the total channel.

    A random-walk filter of steady gain K follows a ramp with an error of slope * interval * (1 - K) / K.
    """
    from uavsim.cosim import believed_noise  # noqa: PLC0415
    from uavsim.onboard.airspeed import steady_gain  # noqa: PLC0415
    from uavsim.scenario import Scenario  # noqa: PLC0415

    scenario = Scenario.from_dict(flight.scenario)
    noise = believed_noise(scenario).total_sd
    gain = steady_gain(scenario.estimator.q_total, noise**2)
    truth = flight.truth
    slope = float(np.max(np.abs(np.diff(truth["p_total"].to_numpy())))) / float(np.diff(truth["t"].to_numpy()[:2])[0])
    interval = float(np.median(np.diff(np.unique(flight.air_data["t_total"].dropna().to_numpy()))))
    return slope * interval * (1.0 - gain) / gain, noise, gain, interval


def _single_flight(flight: "Flight") -> str:
    cruise: dict[str, Any] = flight.score["airspeed"]["cruise"]
    if cruise["coverage_95"] is None:
        return ""
    return "coverage and NEES of one flight prove little; judge them over many (--seeds 1-50)."
