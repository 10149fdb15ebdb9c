"""Remarks of a report: each says what the flight's own figures show."""

import pytest

import uavsim
from uavsim.flight import Flight
from uavsim.views.notes import notes

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
    found = notes(_fly("air_data.tare=none", "air_data.total.offset_pa=80"))
    assert any("mostly a bias" in n and "'none'" in n for n in found)
    assert not any("cannot help" in n for n in found)


def test_a_filter_that_helps_needs_no_excuse(catapult: Flight, weak_launch: Flight) -> None:
    assert not any("cannot help" in n or "bias" in n for n in notes(catapult))
    assert any("prove little" in n for n in notes(catapult))
    assert not any("prove little" in n for n in notes(weak_launch))  # it never cruised


def test_a_fault_is_no_fault_of_the_filter():
    """Four seconds without readings of p_total spoil the RMSE; the BMP390's noise is worth a filter all the same."""
    found = notes(_fly('air_data.total.faults=[{kind="dropout",start=8,stop=12}]'))
    assert not any("cannot help" in n for n in found)
