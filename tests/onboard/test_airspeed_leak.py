"""Whether an airspeed has left what the force gave by more than gusts do."""

import numpy as np
import pytest

from uavsim.onboard.airspeed.leak import WAY, LeakTest

DT, SPEED, LENGTH = 0.01, 32.0, 200.0


def way(changes, sd=1.0):
    """D after each change of the airspeed, m/s, of which the force gave nothing."""
    test = LeakTest(sd, LENGTH)
    rows = []
    for change in changes:
        told = test.add(SPEED, change, 0.0, DT)
        rows.append((test.way, told, test.near))
    return np.array(rows)


def turbulence(seed, sd, seconds):
    """Changes of Dryden's longitudinal gust: first order, standard deviation sd, correlation time L/V."""
    generator = np.random.default_rng(seed)
    keep = np.exp(-DT * SPEED / LENGTH)
    gust = np.zeros(round(seconds / DT))
    for k in range(1, gust.size):
        gust[k] = keep * gust[k - 1] + sd * np.sqrt(1.0 - keep * keep) * generator.standard_normal()
    return np.diff(gust, prepend=0.0)


def single(height, seconds):
    """Changes of a 1 − cos gust, m/s."""
    t = np.arange(0.0, seconds, DT)
    return np.diff(0.5 * height * (1.0 - np.cos(2.0 * np.pi * t / seconds)), prepend=0.0)


@pytest.mark.parametrize("sd", [0.0, 1.0, 1.5])
def test_turbulence_is_no_leak(sd):
    """10 minutes at each of 6 seeds: a Gaussian process is beyond 5 σ in 6 of 10 million of the time."""
    for seed in range(6):
        assert not way(turbulence(seed, sd, 600.0), sd)[:, 1].any()


def test_a_single_gust_is_no_leak():
    """6 m/s in 2.5 s upon turbulence of 1 m/s, at 40 seeds: not half of what makes one."""
    for seed in range(40):
        changes = turbulence(seed, 1.0, 20.0)
        gust = single(6.0, 2.5)
        changes[1000 : 1000 + gust.size] += gust
        assert way(changes)[:, 0].max() < 0.75 * WAY


@pytest.mark.parametrize("rate", [-2.5, 2.5])
def test_an_airspeed_that_goes_on_and_on_is(rate):
    """A port that leaks at 2.5 m/s² against the force, either way, in turbulence: seen in 3 to 8 s."""
    for seed in range(20):
        rows = way(turbulence(seed, 1.0, 10.0) + rate * DT)
        assert 300 < np.argmax(rows[:, 1]) < 800


def test_what_a_gust_may_be_is_near():
    rows = way(single(6.0, 2.5))
    assert rows[0, 2]
    assert not rows[125, 2]
    assert rows[-1, 2]


def test_what_the_force_gave_is_no_gust():
    test = LeakTest(1.0, LENGTH)
    assert not any(test.add(SPEED, 0.1, 0.1, DT) for _ in range(3000))
    assert test.way == 0.0
