"""Remarks of a report: each says what the flight's own figures show."""

import dataclasses

import numpy as np
import pytest

import uavsim
from uavsim.flight import Flight
from uavsim.views.notes import _astray, notes

SHORT = "duration=12"


def _fly(*overrides: str) -> Flight:
    return uavsim.fly("catapult", seed=1, overrides=[SHORT, *overrides])


def test_quiet_sensors_cannot_be_helped_and_the_note_says_why() -> None:
    """BMP581: 0.21 Pa of noise against the lag of a gain of 0.8 behind about 2100 Pa/s every 11 ms."""
    pair = ("air_data.total.preset=bmp581", "air_data.static.preset=bmp581")
    flight = _fly("estimator.kind=paper", *pair)
    (note,) = [n for n in notes(flight) if "cannot help" in n]
    assert flight.score["airspeed"]["reduction_percent"] < 5.0
    assert "0.21 Pa rms" in note
    lag = float(note.partition(", and lag ")[2].split()[0])
    assert lag == pytest.approx(2100 * 0.0107 * 0.25, rel=0.1)


def test_untared_pair_is_a_bias_not_a_matter_of_the_filter() -> None:
    found = notes(_fly("estimator.kind=paper", "air_data.tare=none", "air_data.total.offset_pa=80"))
    assert any("mostly a bias" in n and "'none'" in n for n in found)
    assert not any("cannot help" in n for n in found)


def _seen(flight: Flight, raw: float, filtered: float, **readings: float) -> Flight:
    """The same flight with constant errors of both airspeeds, m/s, and constant pressures."""
    truth = np.interp(flight.estimate["t"], flight.truth["t"], flight.truth["airspeed"])
    estimate = flight.estimate.assign(airspeed=truth + filtered, airspeed_raw=truth + raw)
    airspeed = flight.score["airspeed"] | {"rmse": abs(filtered), "bias": filtered, "rmse_raw": abs(raw)}
    return dataclasses.replace(
        flight,
        tables={**flight.tables, "estimate": estimate, "air_data": flight.air_data.assign(**readings)},
        score={**flight.score, "airspeed": airspeed},
    )


def test_a_bias_that_the_readings_have_not_is_the_estimators(catapult: Flight) -> None:
    """20 m/s in the estimate and 0.1 in the readings, noise of 25 m/s beside it or not: no word of the sensors."""
    flight = _seen(catapult, 0.1, 20.0)
    loud = {**flight.score, "airspeed": flight.score["airspeed"] | {"rmse_raw": 25.0}}
    for one in (flight, dataclasses.replace(flight, score=loud)):
        found = notes(one)
        assert not any("no filter takes away" in note for note in found)
        assert any("+20.00 m/s off in the mean" in note and "+0.10 m/s" in note for note in found)
    assert not any("off in the mean" in note for note in notes(_seen(catapult, 0.0, 0.3)))


def test_a_bias_of_readings_at_the_end_of_their_range_is_not_blamed_on_the_tare(catapult: Flight) -> None:
    (note,) = [n for n in notes(_seen(catapult, -12.0, -12.0, p_total=125_000.0)) if "mostly a bias" in n]
    assert "the total pressure stands at its sensor's end, 125 kPa, in 100 % of readings" in note
    assert "tare" not in note
    (note,) = [n for n in notes(_seen(catapult, -12.0, -12.0)) if "mostly a bias" in n]
    assert note.endswith("no filter takes away.")  # it was tared: nothing is known of why


def test_a_filter_that_helps_needs_no_excuse(catapult: Flight, weak_launch: Flight) -> None:
    assert not any("cannot help" in n or "bias" in n for n in notes(catapult))
    assert any("prove little" in n for n in notes(catapult))
    assert not any("prove little" in n for n in notes(weak_launch))  # it never cruised


def test_a_fault_is_no_fault_of_the_filter():
    """Four seconds without readings of p_total spoil the RMSE; the BMP390's noise is worth a filter all the same."""
    found = notes(_fly('air_data.total.faults=[{kind="dropout",start=8,stop=12}]'))
    assert not any("cannot help" in n for n in found)


def test_a_fault_is_told_with_what_was_found_of_it() -> None:
    """What was set, from when, and the watch's own events; a bias of such a flight is not blamed on the tare."""
    flight = _fly('air_data.total_port.faults=[{kind="blocked",start=6}]')
    (told,) = [n for n in notes(flight) if n.startswith("set to go wrong")]
    assert "total port blocked from 6 s." in told
    flags = [e for e in flight.events if e["event"] == "airspeed_fault"]
    assert flags
    assert f"total flagged as {flags[0]['kind']} at {flags[0]['t']:.2f} s" in told
    assert not any("tare" in n for n in notes(flight))


def test_a_fault_after_the_end_did_nothing_and_the_note_says_so() -> None:
    found = notes(_fly('air_data.static.faults=[{kind="stuck",start=500}]'))
    assert "set to go wrong: static sensor stuck from 500 s, after the end at 12 s. Found on board: nothing." in found


def test_what_was_flagged_without_a_fault_is_told(catapult: Flight) -> None:
    assert not any("go wrong" in n for n in notes(catapult))
    events = [*catapult.events, {"t": 7.0, "event": "airspeed_fault", "channel": "static", "kind": "frozen"}]
    found = notes(dataclasses.replace(catapult, events=events))
    assert found[0] == "nothing was set to go wrong; found on board: static flagged as frozen at 7.00 s."


def test_a_filter_that_was_never_told_of_the_launch_says_why_it_lags(weak_launch: Flight) -> None:
    (told,) = [n for n in notes(weak_launch) if n.startswith("in the stroke")]
    assert told.endswith("without a detected launch the specific force does not aid it.")


def test_a_rig_says_why_its_pressures_lag_only_if_there_is_air() -> None:
    tunnel = notes(uavsim.fly("mach06", seed=1))
    assert any(n.startswith("filtered RMSE over raw: total pressure ") for n in tunnel)
    assert notes(uavsim.fly("launch-curve", seed=1)) == []


def test_the_estimator_is_blamed_only_where_the_readings_are_better() -> None:
    """With the cover on the readings were 19 m/s off, the estimate 1.2: the note said that it was not the sensors."""
    assert _astray(1.19, -18.86) == ""
    assert "estimator that is off" in _astray(2.5, 0.1)
