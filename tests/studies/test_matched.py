"""The matched ensemble, small: the aided filter at its bound and honest; the goals' sizes are in validation."""

from dataclasses import replace

import numpy as np
import pytest
from references import matched
from references.matched import MODES, MatchedSettings

from uavsim.consistency import mean_band
from uavsim.onboard.airspeed import AidedSettings, EstimatorSettings

CALM = EstimatorSettings(kind="aided", wind_sd=0.2)
SMALL = MatchedSettings(estimator=CALM, runs=30, duration=3.0, seed=5)


@pytest.fixture(scope="module")
def small():
    return matched.run(SMALL)


def test_reaches_the_bound(small):
    """30 runs, 2.85 s. Errors forget in about 0.3 s, so some 285 independent squares: 4 deviations are 17 % of RMSE."""
    assert small.ratio(0.15, 3.0) == pytest.approx(1.0, abs=0.17)
    claimed = np.sqrt(np.mean(small.sd[:, small.t > 0.3] ** 2) / np.mean(small.bound[small.t > 0.3] ** 2))
    assert claimed == pytest.approx(1.0, abs=0.03)


def test_knows_its_error(small):
    """NIS over 30·2·313 readings: 4·√(2/18 800) = 4 %. NEES as above, 4·√(2/285) = 34 %."""
    found = small.consistency(0.15, 3.0)
    assert found.nis == pytest.approx(1.0, abs=0.04)
    assert found.nees == pytest.approx(1.0, abs=0.34)
    assert found.nees_inside > 0.75
    low, high = mean_band(30)
    assert low < found.white / 0.95 < high


def test_is_far_better_than_the_raw_airspeed(small):
    part = small.t > 0.15
    assert small.rmse()[part].mean() < 0.5 * np.sqrt(np.mean(small.raw_error[:, part] ** 2))


def test_same_seed_same_bits():
    one, two = (matched.draw(replace(SMALL, runs=2, duration=0.5)) for _ in range(2))
    assert np.array_equal(one.total, two.total)
    assert np.array_equal(one.force_read, two.force_read)
    other = matched.draw(replace(SMALL, runs=2, duration=0.5, seed=6))
    assert not np.array_equal(one.total, other.total)


def test_course_is_the_launch_that_is_said():
    """To 24 m/s in 0.3 s at 8.9 g, by the trapezoid's area, to 1 %; cruise at 30 m/s."""
    drawn = matched.draw(replace(SMALL, runs=50, duration=15.0))
    c = drawn.courses
    at_end = c.at(c.airspeed, matched.REST + matched.STROKE).mean()
    assert at_end == pytest.approx(24.0, rel=0.01)
    assert c.airspeed[:, -1000:].mean() == pytest.approx(30.0, abs=0.1)
    assert c.force.max() == pytest.approx(8.9 * 9.80665, rel=0.02)


def test_modes_are_those_of_the_presets():
    """Noise, rate and conversion time as in the descriptions; MS5611's 110 Hz is by rare temperatures (9.04 ms)."""
    from sensors import catalogue

    for name, preset, mode in (("bmp390 x2", "bmp390", "x2/x1"), ("bmp581 x4", "bmp581", "x4/x1")):
        part = catalogue.pressure_sensor(preset).select(mode=mode).mode
        ours = MODES[name]
        assert (ours.noise, ours.rate, ours.window) == (part.noise_sd, part.rate, part.conversion_time)
    part = catalogue.pressure_sensor("ms5611").select(mode="x4096/x4096").mode
    assert (MODES["ms5611 x4096"].noise, MODES["ms5611 x4096"].window) == (part.noise_sd, part.conversion_time)


def test_wrong_belief_shows():
    """A filter that believes half the noise: NIS 2.5–4 times too high (4 for readings alone), NEES above 1.3."""
    drawn = matched.draw(SMALL)
    doubted = replace(SMALL, mode=replace(SMALL.mode, noise=0.6))
    found = matched.run(doubted, drawn).consistency(0.3, 3.0)
    assert 2.5 < found.nis < 4.0
    assert found.nees > 1.3


def test_aided_settings_matter():
    """A gust five times as strong leaves the filter and its bound less."""
    gusty = replace(SMALL, estimator=replace(CALM, aided=AidedSettings(gust_sd=1.0)), runs=20, duration=2.0)
    found = matched.run(gusty)
    assert found.bound[-1] > 2.0 * matched.run(replace(SMALL, runs=20, duration=2.0)).bound[-1]
