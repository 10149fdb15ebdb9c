"""No healthy port is condemned: prescribed flights of a point mass through the filter (`references.manoeuvres`)."""

from dataclasses import replace

import numpy as np
import pytest
from references.manoeuvres import LAUNCH, MANOEUVRES, Flight, believed, fly, run, without_force

HARD = ("steady50", "steady150", "turn60", "turns", "pushover", "pullup", "motor7", "bungee", "coarse", "quiet", "dive")


@pytest.mark.parametrize("name", HARD)
def test_a_healthy_flight_has_no_flag(name):
    """No fault, each estimate from 1 s after the launch on valid, 0.90 of them within 1.96 σ, 0.3 m/s rms."""
    flight = MANOEUVRES[name]
    for seed in (9100, 9101):
        flown = run(fly(flight, seed), believed(flight))
        rows = flown.after(max(1.0, flight.push + 0.5))
        assert not flown.faults, flown.faults
        assert rows[:, 3].all()
        assert np.mean(np.abs(rows[:, 4]) < 1.96 * rows[:, 2]) > 0.90
        assert np.sqrt(np.mean(rows[:, 4] ** 2)) < 0.3


def _spiked(readings, column, seed, size=500.0, share=0.02, start=8.0):
    generator, air = np.random.default_rng(seed), readings.air.copy()
    hit = (generator.random(len(air)) < share) & (air[:, 0] > start)
    air[hit, column] += size * np.sign(generator.random(int(hit.sum())) - 0.5)
    return replace(readings, air=air)


def _thinned(readings, column, seed, share):
    """Conversions that are lost: the row carries the last one again, with its end."""
    generator, air = np.random.default_rng(seed), readings.air.copy()
    for i in np.flatnonzero(generator.random(len(air)) < share):
        if i:
            air[i, [column, 3 + column]] = air[i - 1, [column, 3 + column]]
    return replace(readings, air=air)


@pytest.mark.parametrize("gust_sd", [0.0, 1.0])
def test_spikes_and_lost_readings_are_no_fault(gust_sd):
    """500 Pa in 2 % of the readings, 6 of 10 lost: no flag, and the airspeed is as good as without, to 1.3 times."""
    flight = Flight(duration=12.0, gust_sd=gust_sd)
    clean = fly(flight, 9200)
    usual = np.sqrt(np.mean(run(clean, believed(flight)).after(1.0)[:, 4] ** 2))
    both = _spiked(_spiked(clean, 1, 1), 2, 2)
    lost = _thinned(_thinned(clean, 1, 3, 0.6), 2, 4, 0.6)
    for readings, most in ((both, 1.3), (lost, 2.0)):
        flown = run(readings, believed(flight))
        assert not flown.faults
        assert np.sqrt(np.mean(flown.after(1.0)[:, 4] ** 2)) < most * usual


def test_an_accelerometer_that_is_silent_for_2_s_condemns_no_port():
    """It is named itself and taken back; the airspeed stays within 1 m/s."""
    flown = run(without_force(fly(Flight(duration=12.0), 9300), LAUNCH + 6.0, LAUNCH + 8.0))
    assert [(event, channel) for _, event, channel, _ in flown.news] == [
        ("airspeed_fault", "accelerometer"),
        ("airspeed_recovered", "accelerometer"),
    ]
    assert np.abs(flown.after(1.0)[:, 4]).max() < 1.0


@pytest.mark.parametrize("size", [2.5, -3.0])
def test_an_offset_that_jumps_is_charged_to_the_accelerometer(size):
    """In still air a step of f_x from one reading to the next: no port is flagged, V stays right, the part is named."""
    readings = fly(Flight(duration=15.0), 9400)
    force = readings.force.copy()
    force[force[:, 0] > LAUNCH + 7.0, 1] += size
    flown = run(replace(readings, force=force))
    assert {channel for _, _, channel, _ in flown.faults} == {"accelerometer"}
    assert np.abs(flown.after(1.0)[:, 4]).max() < 0.6
    assert flown.after(1.0)[:, 3].all()


def test_the_watch_begins_when_the_push_has_ended():
    """After a catapult 2 s after the recognition, after a motor of 7 s behind it."""
    for name, least, most in (("cruise", 1.5, 2.3), ("motor7", 7.0, 10.0)):
        flight = replace(MANOEUVRES[name], duration=11.0)
        begins = run(fly(flight, 9500), believed(flight)).filter._progress.steady_from - LAUNCH
        assert least < begins < most
