"""Filters of the pressures alone: constant velocity and jump-adaptive, and the tunnel of speed steps."""

import math

import numpy as np
import pytest

from uavsim import airdata
from uavsim.onboard import airspeed
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.constant_velocity import RampChannel, rate_growth
from uavsim.onboard.airspeed.jump_adaptive import JumpChannel

KELVIN, STATIC = 288.15, 101_325.0
PLATEAUS = np.arange(0.0, 45.0, 5.0)  # m/s, 10 s each


# -- constant velocity -------------------------------------------------------------------------------------------------


def test_equals_filterpy():
    """The same model through filterpy's KalmanFilter, 300 readings with gaps, to 1e-9."""
    from filterpy.kalman import KalmanFilter

    q, r = 0.7, 4.0
    ours, theirs = RampChannel(q, r), KalmanFilter(dim_x=2, dim_z=1)
    theirs.F, theirs.H, theirs.R = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0]]), np.array([[r]])
    theirs.Q = q * np.array([[0.25, 0.5], [0.5, 1.0]])
    generator = np.random.default_rng(1)
    ours.add(1000.0)
    theirs.x, theirs.P = np.array([[1000.0], [0.0]]), np.diag([r, r + q])
    for k in range(300):
        reading = 1000.0 + 3.0 * k + generator.normal(0.0, 2.0) if k % 7 else math.nan
        ours.add(reading)
        theirs.predict()
        if k % 7:
            theirs.update(reading)
            assert ours.nis == pytest.approx(float(theirs.y[0, 0] ** 2 / theirs.S[0, 0]), rel=1e-9, abs=1e-12)
        assert ours.value == pytest.approx(theirs.x[0, 0], rel=1e-9)
        assert ours.variance == pytest.approx(theirs.P[0, 0], rel=1e-9)


@pytest.mark.parametrize("gain", [0.1, 0.3, 0.8])
def test_settles_at_its_gain(gain):
    """Kalata's relation gives q for which α is the gain, to 1e-6: P after an update is α R."""
    channel = RampChannel(rate_growth(gain, 9.0), 9.0)
    for _ in range(2000):
        channel.add(5000.0)
    assert channel.variance == pytest.approx(gain * 9.0, rel=1e-6)


def test_follows_a_ramp_without_lag():
    """2 Pa a sample: the lag of a random walk of the same gain would be 2·(1 − α)/α Pa."""
    channel = RampChannel(rate_growth(0.2, 1.0), 1.0)
    for k in range(2000):
        channel.add(1000.0 + 2.0 * k)
    assert channel.value == pytest.approx(1000.0 + 2.0 * 1999, abs=1e-6)


# -- jump-adaptive -----------------------------------------------------------------------------------------------------


def test_jump_is_followed_at_once_and_rest_is_averaged():
    """White noise of 16.5 Pa: at rest the rms error is below a quarter of it; 0.1 s after 300 Pa it is below 16.5."""
    generator = np.random.default_rng(6)
    rest, after = [], []
    for _ in range(40):
        channel = JumpChannel(16.5**2)
        for _ in range(500):
            channel.add(1e5 + generator.normal(0.0, 16.5))
        rest.append(channel.value - 1e5)
        for _ in range(10):
            channel.add(1e5 + 300.0 + generator.normal(0.0, 16.5))
        after.append(channel.value - 1e5 - 300.0)
    assert np.sqrt(np.mean(np.square(rest))) < 16.5 / 4.0
    assert np.sqrt(np.mean(np.square(after))) < 16.5


def test_missing_readings_widen():
    channel = JumpChannel(4.0)
    channel.add(1000.0)
    before = channel.variance
    channel.add(math.nan)
    assert channel.variance > before
    assert channel.value == 1000.0
    assert math.isnan(channel.nis)


# -- the tunnel of speed steps -----------------------------------------------------------------------------------------


def tunnel(seed):
    """Noise of the publication, 16.54 and 2.40 Pa white at 100 Hz; steps followed with 0.5 s; (t, V, p_t, p_s)."""
    generator = np.random.default_rng(seed)
    target = np.repeat(PLATEAUS, 1000)
    t = 0.01 * np.arange(1, target.size + 1)
    speed, now, keep = np.empty_like(target), 0.0, math.exp(-0.01 / 0.5)
    for i, wanted in enumerate(target.tolist()):
        now = wanted + (now - wanted) * keep
        speed[i] = now
    total = airdata.total_pressure(static=np.full(t.size, STATIC), mach=speed / airdata.speed_of_sound(KELVIN))
    return t, speed, total, total + generator.normal(0.0, 16.54, t.size), STATIC + generator.normal(0.0, 2.40, t.size)


def through(kind, seed):
    t, speed, clean, total, static = tunnel(seed)
    estimator = airspeed.build(EstimatorSettings(kind=kind), NoiseModel(16.54, 2.40, 0.0))
    rows = [
        estimator.step(a, b, c, KELVIN, a, a)
        for a, b, c in zip(t.tolist(), total.tolist(), static.tolist(), strict=True)
    ]
    table = np.array([row[:6] for row in rows])
    return {
        "error": table[:, 1] - speed, "raw": table[:, 3] - speed, "total": table[:, 4] - clean,
        "total_raw": total - clean, "sd": table[:, 2],
    }  # fmt: skip


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_published_gain_reproduces_the_published_reduction():
    """18.3 ± 0.5 % on total pressure: K = 0.8 leaves √(K/(2 − K)) of white noise (the steps add a little)."""
    found = through("paper", 101)
    assert 100.0 * (1.0 - rms(found["total"]) / rms(found["total_raw"])) == pytest.approx(18.3, abs=0.5)


@pytest.mark.parametrize("kind", ["jump-adaptive", "aided"])
def test_best_causal_filter_in_the_tunnel(kind):
    """At least 68 % below the raw airspeed overall, 85 % on the settled halves of plateaus of 10 m/s and more.

    Its settings were chosen on seeds 0 … 3; these are others. The accelerometer says nothing in a tunnel and no launch
    is recognised, so the aided kind flies the same filter there.
    """
    runs = [through(kind, seed) for seed in (101, 102, 103)]
    error, raw, sd = (np.concatenate([run[name] for run in runs]) for name in ("error", "raw", "sd"))
    assert 1.0 - rms(error) / rms(raw) > 0.68
    settled = np.tile((np.arange(9000) % 1000 >= 500) & (np.arange(9000) >= 2000), 3)
    assert 1.0 - rms(error[settled]) / rms(raw[settled]) > 0.85
    assert np.mean(np.abs(error) < 1.96 * sd) > 0.85
