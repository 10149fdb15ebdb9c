"""Vibration: its rms in each phase, its band, the ring after release, tones and spectra."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, signal

from sensors import Streams, Vibration, VibrationSettings
from sensors.settings import Spectrum, Tone

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


def test_scale_multiplies_everything():
    assert _take(_make(scale=3.0), 3000) == pytest.approx(3 * _take(_make(), 3000), rel=1e-12)


def test_what_is_felt_is_the_force_and_the_step_that_comes() -> None:
    expected = np.add(_take(_make(), 50), (1.0, -2.0, 3.0))
    shaking = _make()
    assert [shaking.on((1.0, -2.0, 3.0)) for _ in range(50)] == [tuple(row) for row in expected.tolist()]


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


@pytest.mark.parametrize("spectra", [(), (Spectrum(((20.0, 1e-3), (300.0, 1e-3))),)])
def test_the_noise_is_the_same_in_time_at_every_step(spectra):
    """Its lines have the same frequencies and draws: at 4 kHz every fourth row is that at 1 kHz, to 1e-9 m/s²."""
    settings = VibrationSettings(band_hz=(20.0, 200.0), spectra=spectra)
    coarse, fine = (
        Vibration(settings, Streams(3), dt=dt, release_time=0.5, plateau=80.0, rise=0.03) for dt in (DT, DT / 4)
    )
    rows = _take(fine, 4 * 900)[::4]
    assert rows == pytest.approx(_take(coarse, 900), abs=1e-9)
    fine.leave_rail(0.9)
    coarse.leave_rail(0.9)
    assert _take(fine, 4 * 100)[::4] == pytest.approx(_take(coarse, 100), abs=1e-9)


# -- tones and spectra -----------------------------------------------------------------------------------------------

STILL = VibrationSettings(waiting_rms_g=0.0, stroke_rms_g=0.0, flight_rms_g=0.0, ring_fraction=0.0)
FLAT = ((20.0, 1e-3), (300.0, 1e-3))
SLOPES = ((10.0, 1e-5), (50.0, 2e-3), (150.0, 2e-3), (400.0, 1e-4))  # g²/Hz: up, flat, down
LONG = 6 * PERIOD + 4321


def _sine(tone, k):
    wave = np.sin(2.0 * np.pi * tone.frequency_hz * k * DT + np.radians(tone.phase_deg))
    return wave[:, np.newaxis] * np.array(tone.amplitude_g) * G0


def _integral(psd):
    """Return the mean square of a density that is straight in log-log, by the trapezoidal rule on a fine grid."""
    f, s = np.array(psd).T
    grid = np.geomspace(f[0], f[-1], 200_001)
    return integrate.trapezoid(np.exp(np.interp(np.log(grid), np.log(f), np.log(s))), grid)


def test_a_tone_is_exact_at_every_step_of_a_long_flight():
    """Authority: A g sin(2π f k dt + φ), over six periods of the noise, 200 s; to 1e-9 of the amplitude."""
    tone = Tone(37.77, (0.5, -1.0, 2.0), phase_deg=40.0)
    rows = _take(_make(replace(STILL, tones=(tone,))), LONG)
    assert rows == pytest.approx(_sine(tone, np.arange(LONG)), abs=2e-8)


def test_tones_add():
    tones = (Tone(37.77, (0.5, -1.0, 2.0)), Tone(120.0, (0.0, 0.3, 0.0), -90.0))
    rows = _take(_make(replace(STILL, tones=tones)), 3000)
    assert rows == pytest.approx(sum(_sine(tone, np.arange(3000)) for tone in tones), abs=1e-9)


def test_each_phase_begins_at_its_step():
    """Release between the steps 1500 and 1501, off the rail with step 2800: 1300 steps after a block began."""
    waiting, stroke, flight, always = (
        Tone(50.0 + 20.0 * i, (1.0, 2.0, 3.0), 10.0, when)
        for i, when in enumerate(("waiting", "stroke", "flight", "always"))
    )
    vibration = _make(replace(STILL, tones=(waiting, stroke, flight, always)), release_time=1.5005)
    rows = _take(vibration, 2800)
    vibration.leave_rail(2.8)
    rows = np.vstack((rows, _take(vibration, 2200)))
    k = np.arange(5000)
    expected = _sine(always, k)
    for tone, there in ((waiting, k < 1501), (stroke, (k >= 1501) & (k < 2800)), (flight, k >= 2800)):
        expected += _sine(tone, k) * there[:, np.newaxis]
    assert rows == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("taken", [0, 700, 1024, 2049])
def test_a_tone_goes_on_through_a_change_of_phase(taken):
    """Whether the time given is that of the step just taken or of the next: a tone is where its time is."""
    tone = Tone(37.77, (0.5, -1.0, 2.0))
    for told in (taken - 1, taken):
        vibration = _make(replace(STILL, tones=(tone,)))
        rows = _take(vibration, taken).reshape(-1, 3)
        vibration.leave_rail(max(told, 0) * DT)
        rows = np.vstack((rows, _take(vibration, 1500)))
        assert rows == pytest.approx(_sine(tone, np.arange(taken + 1500)), abs=1e-9)


@pytest.mark.parametrize("psd", [FLAT, SLOPES])
def test_rms_of_a_spectrum_is_the_integral_of_its_density(psd):
    """n = 8 seeds x 3 axes, one period each, of at least 3000 lines' worth (chi-squared, two degrees of freedom each):
    4.5 sigma is 1.7 % of the mean square, so an rms that is 1.2 % off is caught.
    """
    squares = [
        np.mean(_take(_make(replace(STILL, spectra=(Spectrum(psd),)), seed=seed), PERIOD) ** 2) for seed in range(8)
    ]
    assert np.mean(squares) == pytest.approx(_integral(psd) * G0**2, rel=4.5 / np.sqrt(24 * 3000))


def test_the_power_spectral_density_follows_its_lines():
    """Welch, one-sided, 2 Hz apart, from 14 to 390 Hz. n = 3 axes x 130 segments of 0.5 s in two periods, of which one
    is independent: 4.5 sigma of a mean over five frequencies is 14 %, over all of them 2.3 %.
    """
    rows = _take(_make(replace(STILL, spectra=(Spectrum(SLOPES),))), 2 * PERIOD) / G0
    frequency, power = signal.welch(rows, 1.0 / DT, nperseg=500, axis=0, detrend=False)
    power = power.mean(axis=1)
    f, s = np.array(SLOPES).T
    expected = np.exp(np.interp(np.log(frequency[1:]), np.log(f), np.log(s)))
    over = (power[1:] / expected)[6:195]
    assert over.mean() == pytest.approx(1, abs=0.025)
    assert np.convolve(over, np.full(5, 0.2), mode="valid") == pytest.approx(1, abs=0.15)
    assert power[frequency > 410.0].max() < 1e-6 * power.max()
    assert power[frequency < 4.0].max() < 1e-4 * power.max()


def test_axes_and_spectra_are_independent():
    """n = 1e4 degrees of freedom and more in a period of 280 Hz width: a correlation of 4.5 % is 4.5 sigma."""
    first = _take(_make(replace(STILL, spectra=(Spectrum(FLAT),))), PERIOD)
    both = _take(_make(replace(STILL, spectra=(Spectrum(FLAT), Spectrum(FLAT)))), PERIOD)
    correlation = np.corrcoef(np.hstack((first, both - first)), rowvar=False)
    assert np.abs(correlation - np.eye(6)).max() < 0.045


def test_what_is_added_changes_no_other_draw():
    base = VibrationSettings()
    more = replace(base, tones=(Tone(60.0, (0.1, 0.1, 0.1)),), spectra=(Spectrum(FLAT, "stroke"),))

    def fly(chosen):
        vibration = _make(chosen, release_time=1.2)
        rows = _take(vibration, 2000)
        vibration.leave_rail(2.0)
        return np.vstack((rows, _take(vibration, 1000)))

    tone = _sine(more.tones[0], np.arange(3000))
    rest = fly(more) - fly(base) - tone
    k = np.arange(3000)
    stroke = (k >= 1200) & (k < 2000)
    assert np.abs(rest[~stroke]).max() < 1e-12
    alone = _take(_make(replace(STILL, spectra=(Spectrum(FLAT),))), 2000)
    assert rest[stroke] == pytest.approx(alone[1200:2000], abs=1e-12)
    silent = replace(base, tones=(Tone(60.0, (0.0, 0.0, 0.0)),))
    assert np.array_equal(fly(silent), fly(base))


def test_scale_multiplies_tones_and_spectra_too():
    chosen = replace(VibrationSettings(), tones=(Tone(60.0, (0.1, 0.2, 0.3)),), spectra=(Spectrum(SLOPES),))
    assert _take(_make(chosen, scale=3.0), 3000) == pytest.approx(3 * _take(_make(chosen), 3000), rel=1e-12, abs=1e-12)
    assert not _take(_make(chosen, scale=0.0), 3000).any()


@pytest.mark.parametrize(
    ("psd", "message"),
    [
        (((10.0, 1.0),), r"vibration\.spectra\[1\]\.psd: must have at least 2 points \(frequency, density\), not 1"),
        (((10.0, 1.0), (10.0, 1.0)), r"vibration\.spectra\[1\]\.psd: frequencies must rise, not go from 10 to 10 Hz"),
        (((20.0, 1.0), (10.0, 1.0)), r"frequencies must rise, not go from 20 to 10 Hz"),
        (((10.0, 1.0), (20.0, -1.0)), r"psd: densities must be above 0 and finite, not -1 at 20 Hz"),
        (((10.0, 0.0), (20.0, 1.0)), r"psd: densities must be above 0 and finite, not 0 at 10 Hz"),
        (((10.0, float("nan")), (20.0, 1.0)), r"psd: densities must be above 0 and finite, not nan"),
        (((0.0, 1.0), (20.0, 1.0)), r"psd: frequencies must lie above 0 and below 500 Hz, not 0"),
        (((10.0, 1.0), (500.0, 1.0)), r"psd: frequencies must lie above 0 and below 500 Hz, not 500"),
        (((float("nan"), 1.0), (50.0, 1.0)), r"psd: frequencies must lie above 0 and below 500 Hz, not nan"),
    ],
)
def test_what_is_no_density_is_an_error_of_one_line(psd, message):
    with pytest.raises(ValueError, match=message) as caught:
        _make(replace(STILL, spectra=(Spectrum(FLAT), Spectrum(psd))))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("tone", "message"),
    [
        (Tone(500.0, (1.0, 1.0, 1.0)), r"vibration\.tones\[0\]\.frequency_hz: must be above 0 and below half the step"),
        (Tone(0.0, (1.0, 1.0, 1.0)), r"frequency_hz: must be above 0"),
        (Tone(50.0, (1.0, float("nan"), 1.0)), r"vibration\.tones\[0\]\.amplitude_g: must be finite"),
    ],
)
def test_a_tone_that_the_plant_cannot_carry_is_an_error(tone, message):
    with pytest.raises(ValueError, match=message):
        _make(replace(STILL, tones=(tone,)))


@given(
    st.lists(st.floats(1e-6, 499.999), min_size=2, max_size=4, unique=True),
    st.lists(st.floats(1e-30, 1e6), min_size=4, max_size=4),
    st.floats(1e-6, 499.999),
    st.floats(-1e6, 1e6),
    st.sampled_from(["always", "waiting", "stroke", "flight"]),
)
@settings(max_examples=20, deadline=None)
def test_finite_over_the_whole_domain(frequencies, densities, frequency, amplitude, when):
    spectrum = Spectrum(tuple(zip(sorted(frequencies), densities, strict=False)), when)
    tone = Tone(frequency, (amplitude, 0.0, -amplitude), 360.0, when)
    vibration = _make(VibrationSettings(tones=(tone,), spectra=(spectrum,)), release_time=0.5)
    rows = _take(vibration, 1100)
    vibration.leave_rail(1.1)
    assert np.isfinite(rows).all()
    assert np.isfinite(_take(vibration, 1100)).all()
