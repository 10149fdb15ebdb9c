"""References of the aided filter: the unscented filter beside it and the smoother behind it."""

from dataclasses import replace

import numpy as np
import pytest
from references import matched
from references.matched import COVERED, MODES, REST, MatchedSettings
from references.smoother import RecordedFilter
from references.unscented import UnscentedFilter

from uavsim.onboard.airspeed import EstimatorSettings

SMALL = MatchedSettings(estimator=EstimatorSettings(kind="aided", wind_sd=0.2), runs=2, duration=1.0, seed=4)


@pytest.mark.parametrize("mode", ["ms5611 x4096", "bmp581 x4"])
def test_unscented_filter_agrees(mode):
    """No derivative by hand, the same airspeeds: within 0.5 % of the deviation claimed from 150 ms on, rms.

    Sigma points hold h to third order, so the agreement bounds what linearisation costs; a slope or noise term that is
    wrong by 1 % shows as several per cent.
    """
    settings = replace(SMALL, mode=MODES[mode])
    drawn = matched.draw(settings)
    ours, theirs = matched.run(settings, drawn), matched.run(settings, drawn, kind=UnscentedFilter)
    part = ours.t > 0.15
    difference = (ours.error - theirs.error)[:, part] / ours.sd[:, part]
    assert np.sqrt(np.mean(difference**2)) < 0.005
    np.testing.assert_allclose(ours.sd[:, part], theirs.sd[:, part], rtol=0.005)


def test_smoother_is_better_and_honest():
    """20 runs of 2 s: its RMSE is below 0.8 of the filter's, its NEES 1 within 4 deviations of 130 independent squares.

    The smoothed error is alike over about 0.3 s. The first 0.15 s of the launch, which it sees from both sides, are
    better known by a quarter at least.
    """
    settings = replace(SMALL, runs=20, duration=2.0)
    drawn = matched.draw(settings)
    filtered = matched.run(settings, drawn)
    squares, ratio, launch = [], [], []
    for i in range(settings.runs):
        recorder = RecordedFilter(settings.estimator, settings.noise(), COVERED)
        matched.fly_one(settings, drawn, i, recorder)
        smooth = recorder.smoothed()
        truth = np.interp(smooth.t, drawn.courses.t, drawn.courses.airspeed[i])
        late, early = smooth.t > REST + 0.15, (smooth.t > REST + 0.04) & (smooth.t < REST + 0.15)
        squares.append(np.mean((smooth.airspeed - truth)[late] ** 2))
        ratio.append(np.mean(((smooth.airspeed - truth) / smooth.sd)[late] ** 2))
        launch.append(np.mean((smooth.airspeed - truth)[early] ** 2))
    assert np.sqrt(np.mean(squares)) < 0.8 * np.sqrt(np.mean(filtered.error[:, filtered.t > 0.15] ** 2))
    assert np.mean(ratio) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / 130))
    assert np.sqrt(np.mean(launch)) < 0.75 * np.sqrt(np.mean(filtered.error[:, filtered.t < 0.15] ** 2))


def test_smoother_remembers_what_the_filter_does():
    """Recording changes no bit of the estimate."""
    drawn = matched.draw(SMALL)
    np.testing.assert_array_equal(matched.run(SMALL, drawn).error, matched.run(SMALL, drawn, kind=RecordedFilter).error)


def test_nothing_to_smooth():
    with pytest.raises(ValueError, match="nothing has been flown"):
        RecordedFilter(SMALL.estimator, SMALL.noise(), COVERED).smoothed()
