"""Faults of readings, each alone, together, and with readings that are no numbers."""

from math import isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sensors import Streams
from sensors.faults import reading_faults, value_faults
from sensors.settings import Fault

READINGS = [(0.01 * k, float(k), -float(k), 0.5 * k) for k in range(1000)]


def _arrived(*faults, seed=1, readings=READINGS, name="accelerometer"):
    arriving = reading_faults(faults, Streams(seed), name)
    return [arriving(reading) for reading in readings]


def test_no_fault_is_nothing_to_do():
    assert reading_faults((), Streams(1), "accelerometer") is None
    assert value_faults((), Streams(1), "static") is None


@pytest.mark.parametrize("kind", ["dropout", "invalid", "stuck", "dead", "spike", "offset"])
def test_outside_its_time_a_fault_changes_nothing(kind):
    arrived = _arrived(Fault(kind, start=3.0, stop=4.0, size=9.0))
    assert arrived[:300] == READINGS[:300]
    assert arrived[400:] == READINGS[400:]
    assert all(there != sent for there, sent in zip(arrived[300:400], READINGS[300:400], strict=True))


def test_dropout_takes_all_or_the_stated_share():
    """p = 0.3 of 1000: within 5 sd of the binomial, 0.073 (1 in 10^6)."""
    assert _arrived(Fault("dropout", start=1.0, stop=2.0))[100:200] == [None] * 100
    gone = np.array([reading is None for reading in _arrived(Fault("dropout", probability=0.3))])
    assert gone.mean() == pytest.approx(0.3, abs=0.073)
    pairs = np.mean(gone[1:] & gone[:-1])
    assert pairs == pytest.approx(0.09, abs=5 * np.sqrt(0.09 * 0.91 / 999) * 1.3)  # each by itself


def test_invalid_is_nan_on_its_axis_with_its_time_stamp():
    t, x, y, z = _arrived(Fault("invalid", axis="y"))[7]
    assert (t, x, z) == (READINGS[7][0], READINGS[7][1], READINGS[7][3])
    assert isnan(y)
    assert all(isnan(value) for value in _arrived(Fault("invalid"))[7][1:])


def test_stuck_repeats_the_last_value_before_it_with_new_time_stamps():
    arrived = _arrived(Fault("stuck", start=3.0, stop=4.0, axis="z"))
    for reading, sent in zip(arrived[300:400], READINGS[300:400], strict=True):
        assert reading == (*sent[:3], READINGS[299][3])
    everything = _arrived(Fault("stuck", start=3.0, stop=4.0))
    assert {reading[1:] for reading in everything[300:400]} == {READINGS[299][1:]}


def test_a_dead_sensor_says_one_number_on_its_axis_with_new_time_stamps():
    arrived = _arrived(Fault("dead", start=3.0, stop=4.0, size=-7.0, axis="y"))
    for reading, sent in zip(arrived[300:400], READINGS[300:400], strict=True):
        assert reading == (*sent[:2], -7.0, sent[3])
    assert {reading[1:] for reading in _arrived(Fault("dead"))} == {(0.0, 0.0, 0.0)}
    assert value_faults((Fault("dead", size=3.0),), Streams(1), "static")(0.5, 101_325.0) == 3.0


def test_stuck_from_the_start_repeats_the_first_value():
    assert {reading[1:] for reading in _arrived(Fault("stuck"))} == {READINGS[0][1:]}


def test_spikes_are_of_either_sign_on_the_stated_share():
    """p = 0.4 of 10 000, half of each sign: both within 5 sd, 0.025 and 0.04."""
    readings = [(0.01 * k, 0.0, 1.0, 2.0) for k in range(10_000)]
    arrived = _arrived(Fault("spike", probability=0.4, size=50.0, axis="x"), readings=readings)
    added = np.array([x for _, x, _, _ in arrived])
    assert set(added) == {-50.0, 0.0, 50.0}
    assert np.mean(added != 0) == pytest.approx(0.4, abs=0.025)
    assert np.mean(added[added != 0] > 0) == pytest.approx(0.5, abs=0.04)
    assert [reading[2:] for reading in arrived] == [sent[2:] for sent in readings]


def test_offset_is_added():
    assert _arrived(Fault("offset", size=2.5, axis="y"))[10] == (READINGS[10][0], 10.0, -7.5, 5.0)


def test_faults_act_one_after_the_other():
    """An offset before a stuck value is held with it, one after it is added to what is held; what is gone stays so."""
    first = _arrived(Fault("offset", size=1.0), Fault("stuck", start=5.0))
    then = _arrived(Fault("stuck", start=5.0), Fault("offset", size=1.0, start=5.0))
    assert first[600][1:] == tuple(value + 1.0 for value in READINGS[499][1:])
    assert then[600][1:] == tuple(value + 1.0 for value in READINGS[499][1:])
    assert _arrived(Fault("dropout"), Fault("spike", size=1.0))[5] is None


def test_each_fault_has_its_own_stream_and_adding_one_changes_no_other():
    drop = Fault("dropout", probability=0.5)
    alone = [reading is None for reading in _arrived(drop)]
    with_more = [reading is None for reading in _arrived(drop, Fault("spike", probability=0.5, size=1.0))]
    assert alone == with_more
    assert alone != [reading is None for reading in _arrived(drop, seed=2)]
    assert alone != [reading is None for reading in _arrived(drop, name="second")]


def test_values_break_as_readings_do_whatever_the_axis():
    arriving = value_faults([Fault("spike", probability=0.5, size=3.0, axis="z")], Streams(4), "static")
    values = {arriving(0.01 * k, 100.0) for k in range(100)}
    assert values == {97.0, 100.0, 103.0}
    assert value_faults([Fault("dropout")], Streams(4), "static")(1.0, 5.0) is None
    stuck = value_faults([Fault("stuck", start=1.0)], Streams(4), "static")
    assert [stuck(t, 10 * t) for t in (0.5, 1.5, 2.5)] == [5.0, 5.0, 5.0]


@pytest.mark.parametrize("kind", ["dropout", "invalid", "stuck", "spike", "offset"])
def test_a_reading_that_is_no_number_does_no_harm(kind):
    faults = [Fault(kind, start=1.0, stop=2.0, size=1.0)]
    readings = [(0.0, nan, 1.0, nan), (1.0, nan, 1.0, 2.0), (2.0, 1.0, 2.0, 3.0)]
    arrived = _arrived(*faults, readings=readings)
    assert arrived[2] == readings[2]
    assert isnan(arrived[0][1])


FAULTS = st.builds(
    Fault,
    st.sampled_from(["dropout", "invalid", "stuck", "spike", "offset"]),
    start=st.floats(0.0, 3600.0),
    stop=st.floats(0.0, 3600.0),
    probability=st.floats(0.0, 1.0),
    size=st.floats(-1e6, 1e6),
    axis=st.sampled_from(["x", "y", "z", "all"]),
)


@given(st.lists(FAULTS, max_size=4), st.lists(st.floats(0.0, 3600.0), max_size=30))
def test_any_faults_leave_time_stamps_and_give_numbers_or_invalid_ones(faults, times):
    readings = [(t, 1.0, 2.0, 3.0) for t in sorted(times)]
    arriving = reading_faults(faults, Streams(1), "accelerometer")
    kinds = {fault.kind for fault in faults}
    for reading in readings:
        got = reading if arriving is None else arriving(reading)
        if got is None:
            assert "dropout" in kinds
            continue
        assert got[0] == reading[0]
        assert np.isfinite(got[1:]).all() or "invalid" in kinds
