"""Vibration: its rms in each phase, its band, and the ring after release."""

import numpy as np
import pytest

from sensors import Streams, Vibration, VibrationSettings

G0 = 9.80665
DT = 1e-3
PERIOD = 32768  # steps of the noise


def _make(settings=None, release_time=2.5, plateau=80.0, seed=1, **options):
    settings = VibrationSettings() if settings is None else settings
    return Vibration(settings, Streams(seed), dt=DT, release_time=release_time, plateau=plateau, **options)


def _take(vibration, count):
    return np.array([vibration.step() for _ in range(count)])


def test_rms_is_that_of_the_phase_on_each_axis():
    """Over whole periods the rms is exact: the noise is made so."""
    settings = VibrationSettings(waiting_rms_g=0.05, stroke_rms_g=0.3, flight_rms_g=0.1, ring_fraction=0.0)
    vibration = _make(settings, release_time=PERIOD * DT)
    for expected in (0.05, 0.3):
        assert np.sqrt(np.mean(_take(vibration, PERIOD) ** 2, axis=0)) == pytest.approx([expected * G0] * 3, rel=1e-9)
    vibration.leave_rail(2 * PERIOD * DT)
    assert np.sqrt(np.mean(_take(vibration, PERIOD) ** 2, axis=0)) == pytest.approx([0.1 * G0] * 3, rel=1e-9)


def test_the_same_noise_goes_on_through_the_phases():
    """A change of phase changes the rms, not the noise: no step but that of the factor."""
    settings = VibrationSettings(waiting_rms_g=0.1, stroke_rms_g=0.1, flight_rms_g=0.1, ring_fraction=0.0)
    switched = _make(settings, release_time=0.1)
    rows = _take(switched, 300)
    switched.leave_rail(0.3)
    rows = np.vstack((rows, _take(switched, 700)))
    assert rows == pytest.approx(_take(_make(settings, release_time=np.inf), 1000), abs=1e-14)


def test_ring_grows_with_the_push_and_decays_from_its_plateau():
    settings = VibrationSettings(waiting_rms_g=0.0, stroke_rms_g=0.0, ring_hz=120.0, ring_fraction=0.3, ring_decay=0.05)
    rows = _take(_make(settings, release_time=0.25, rise=0.03), 800)
    tau = np.arange(800) * DT - 0.25
    envelope = np.where(tau < 0.03, tau / 0.03, np.exp(-(tau - 0.03) / 0.05))
    expected = np.where(tau >= 0, 0.3 * 80.0 * envelope * np.sin(2 * np.pi * 120.0 * tau), 0.0)
    assert rows[:, 0] == pytest.approx(expected, abs=1e-9)
    assert np.abs(rows[:, 0]).max() == pytest.approx(0.3 * 80.0, rel=0.05)


def test_ring_is_a_decaying_sine_along_x_from_release_on():
    settings = VibrationSettings(waiting_rms_g=0.0, stroke_rms_g=0.0, ring_hz=120.0, ring_fraction=0.3, ring_decay=0.05)
    release = 0.2503  # between two steps
    rows = _take(_make(settings, release_time=release), 800)
    tau = np.arange(800) * DT - release
    expected = np.where(tau >= 0, 0.3 * 80.0 * np.exp(-tau / 0.05) * np.sin(2 * np.pi * 120.0 * tau), 0.0)
    assert rows[:, 0] == pytest.approx(expected, abs=1e-9)
    assert not rows[:, 1:].any()


def test_scale_multiplies_everything_and_none_is_still():
    assert _take(_make(scale=3.0), 3000) == pytest.approx(3 * _take(_make(), 3000), rel=1e-12)
    assert not _take(Vibration.still(), 10).any()


def test_vibration_is_drawn_by_the_seed():
    assert np.array_equal(_take(_make(), 100), _take(_make(), 100))
    assert not np.array_equal(_take(_make(), 100), _take(_make(seed=2), 100))


def test_band_is_held():
    rows = _take(_make(VibrationSettings(band_hz=(20.0, 60.0)), release_time=np.inf), PERIOD)
    power = np.abs(np.fft.rfft(rows, axis=0)) ** 2
    frequency = np.fft.rfftfreq(PERIOD, DT)
    outside = (frequency < 20.0) | (frequency > 60.0)
    assert power[outside].sum() < 1e-20 * power.sum()


def test_band_beyond_the_plant_is_an_error():
    with pytest.raises(ValueError, match="half the step rate"):
        _make(VibrationSettings(band_hz=(5.0, 500.0)))
