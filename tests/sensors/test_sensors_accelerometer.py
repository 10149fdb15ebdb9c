"""The accelerometer, each error alone, then its noise against its density, then all of them over their whole domain."""

from dataclasses import fields, replace
from itertools import islice
from itertools import product as every
from math import inf, nan

import numpy as np
import pytest
from annotated_types import Interval
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2

from sensors import (
    Accelerometer,
    AccelerometerErrors,
    AccelerometerSettings,
    Streams,
    Vibration,
    VibrationSettings,
    accelerometer,
    noise,
    preset,
    presets,
)
from sensors.mounting import attitude, product
from sensors.settings import Fault, ThermalSettings
from sensors.unit import REFERENCE_TEMPERATURE

G0 = 9.80665
DT = 1e-3
LSM = preset("lsm6dso32")
# A part without noise and drift, in steps of 2e-9 m/s²: what is left is the error under test.
SILENT = replace(LSM, noise_densities=((0.0, 0.0, 0.0),) * 4, drift_sd=0.0, random_walk=0.0, bits=(38, 38, 38, 38))
FINE = 1e-8  # m/s²
OPEN = SILENT.scaled(1.0, AccelerometerErrors(bandwidth=False, quantisation=False))


class Air:
    """Surroundings of which only the temperature, K, is there."""

    def __init__(self, temperature):
        self._temperature = temperature

    def flow(self):
        return nan, nan, self._temperature(), nan, nan, nan, nan


def _fly(device, force, duration):
    """Readings of a device that feels force(t), as an array with the columns t, fx, fy, fz."""
    readings = []
    for k in range(round(duration / DT) + 1):
        t = k * DT
        readings += device.step((t, force(t)))
    return np.array(readings)


def _rest(_t):
    return (0.0, 0.0, -G0)


def _record(device, count):
    """Readings at rest: the force is steady, so it need not be felt at each plant step."""
    readings = []
    second = 0.0
    while len(readings) < count:
        readings += device.step((second, _rest(second)))
        second += 1.0
    return np.array(readings[:count])


def test_a_part_without_errors_reads_the_truth():
    readings = _fly(Accelerometer(SILENT, Streams(1), unit="ideal"), lambda t: (1.5, -2.5, -G0), 0.1)
    assert readings[:, 1:] == pytest.approx(np.tile([1.5, -2.5, -G0], (len(readings), 1)), abs=FINE)


@pytest.mark.parametrize("rate", [104.0, 833.0, 1666.0, 6664.0])
def test_sample_times_are_phase_plus_k_over_rate(rate):
    """Exactly, also after many samples and above the plant's rate; the phase lies in the first interval."""
    device = Accelerometer(SILENT.select(rate=rate), Streams(2), unit="ideal")
    phase = device.phase
    assert 0 <= phase < 1 / rate
    readings = _fly(device, _rest, 2.0)
    assert readings[:, 0].tolist() == [phase + k / rate for k in range(len(readings))]
    assert len(readings) == pytest.approx(2.0 * rate, abs=1)


def test_phases_are_uniform():
    """200 seeds; Kolmogorov-Smirnov distance below 0.138 (1 in 1000 by chance)."""
    phases = np.sort([Accelerometer(SILENT, Streams(seed)).phase * 833.0 for seed in range(200)])
    assert np.abs(phases - (np.arange(200) + 0.5) / 200).max() < 0.138


@pytest.mark.parametrize("rate", [52.0, 833.0])
def test_bandwidth_delays_a_ramp_by_its_time_constant(rate):
    """A one-pole low-pass follows a ramp with the lag 1/(2π f): also tests that samples fall between plant steps."""
    lag = 1 / (2 * np.pi * rate / 2)
    device = Accelerometer(SILENT.select(rate=rate), Streams(3), unit="ideal")
    readings = _fly(device, lambda t: (100 * t, -50 * t, 0.0), 1.0)
    late = readings[readings[:, 0] > 0.5]
    assert late[:, 1] == pytest.approx(100 * (late[:, 0] - lag), abs=1e-5)
    assert late[:, 2] == pytest.approx(-50 * (late[:, 0] - lag), abs=1e-5)


def _bias_read(streams):
    """What a unit reads of nothing: its bias."""
    return _fly(Accelerometer(SILENT, streams), lambda t: (0.0, 0.0, 0.0), 0.01)[0, 1:]


def test_scale_error_alone():
    device = Accelerometer(SILENT, Streams(5))
    assert all(0 < abs(error) <= SILENT.scale_limit for error in device.scale_error)
    truth = np.array([20.0, -30.0, 40.0])
    reading = _fly(device, lambda t: tuple(truth), 0.01)[0, 1:] - _bias_read(Streams(5))
    assert reading == pytest.approx(truth * (1 + np.array(device.scale_error)), abs=2 * FINE)


def test_bias_alone_and_extra_bias_on_top():
    unit = Accelerometer(SILENT, Streams(6))
    assert _bias_read(Streams(6)) == pytest.approx(unit.bias, abs=FINE)
    assert all(0 < abs(bias) <= limit for bias, limit in zip(unit.bias, SILENT.bias_limit, strict=True))
    extra = Accelerometer(SILENT, Streams(6), bias=(1.0, 0.0, -2.0))
    assert np.subtract(extra.bias, unit.bias) == pytest.approx([1.0, 0.0, -2.0])
    assert Accelerometer(SILENT, Streams(6), bias=0.5, unit="ideal").bias == (0.5, 0.5, 0.5)


@pytest.mark.parametrize("name", ["lsm6dso32", "adxl345"])
def test_units_are_drawn_within_the_datasheet(name):
    """400 units, 3 axes: sd of bias and scale within 4 sigma of the estimate (14 %, 8 %) and none beyond its limit.

    Cutting a normal at 3 sigma takes 1.3 % off its standard deviation.
    """
    part = preset(name)
    units = [Accelerometer(part, Streams(seed)) for seed in range(400)]
    bias = np.array([unit.bias for unit in units])
    scale = np.array([unit.scale_error for unit in units])
    assert bias.std(axis=0) / part.bias_sd == pytest.approx([1, 1, 1], abs=4 / np.sqrt(800))
    assert scale.std() / part.scale_sd == pytest.approx(1, abs=4 / np.sqrt(2400))
    assert np.all(np.abs(bias) <= part.bias_limit)
    assert np.abs(scale).max() <= part.scale_limit
    assert np.abs(bias.mean(axis=0) / part.bias_sd).max() < 4 / np.sqrt(400)


def test_ideal_and_typical_units():
    assert Accelerometer(LSM, Streams(1), unit="ideal").bias == (0.0, 0.0, 0.0)
    assert Accelerometer(LSM, Streams(1), unit="typical").bias == LSM.bias_sd
    assert Accelerometer(LSM, Streams(1), unit="typical").scale_error == (LSM.scale_sd,) * 3


def test_drift_alone_is_its_process():
    """Gauss-Markov and random walk are those of `noise`, on their own streams, at the sample interval."""
    part = replace(SILENT, drift_sd=0.5, correlation_time=2.0, random_walk=0.1)
    readings = _record(Accelerometer(part, Streams(7), unit="ideal"), 3000)
    drift = noise.gauss_markov(Streams(7)("accelerometer.drift"), 0.5, 2.0, 1 / 833.0, axes=3)
    walk = noise.random_walk(Streams(7)("accelerometer.walk"), 0.1, 1 / 833.0, axes=3)
    expected = np.concatenate([next(drift) + next(walk) for _ in range(3)])[:3000]
    assert readings[:, 1:] == pytest.approx(expected + np.array([0, 0, -G0]), abs=FINE)


def test_saturation_at_the_range():
    """Two's complement: the most positive reading is one step below the range."""
    part = LSM.select(range_g=16)
    device = Accelerometer(replace(part, noise_densities=SILENT.noise_densities), Streams(8), unit="ideal")
    readings = _fly(device, lambda t: (30 * G0, -30 * G0, 15.9 * G0), 0.05)
    assert readings[:, 1] == pytest.approx(16 * G0 - part.resolution, rel=1e-12)
    assert readings[:, 2] == pytest.approx(-16 * G0, rel=1e-12)
    assert readings[:, 3] == pytest.approx(15.9 * G0, abs=0.05)


def test_quantisation_to_the_least_significant_bit():
    part = replace(LSM, noise_densities=SILENT.noise_densities, drift_sd=0.0, random_walk=0.0)
    readings = _fly(Accelerometer(part, Streams(9), unit="ideal"), lambda t: (3.3 * t, -7.7 * t, 1.0), 1.0)
    counts = readings[:, 1:] / part.resolution
    assert counts == pytest.approx(np.round(counts), abs=1e-9)
    lag = 1 / (2 * np.pi * part.bandwidth)
    late = readings[readings[:, 0] > 0.1]
    error = late[:, 1] - 3.3 * (late[:, 0] - lag)
    assert np.abs(error).max() <= part.resolution / 2 * 1.001
    assert error.std() / (part.resolution / np.sqrt(12)) == pytest.approx(1, abs=0.05)  # uniform


def test_vibration_goes_through_the_bandwidth():
    settings = VibrationSettings(waiting_rms_g=1.0)
    rms = []
    for rate in (6664.0, 52.0):
        vibration = Vibration(settings, Streams(10), dt=DT, release_time=np.inf, plateau=0.0)
        device = Accelerometer(SILENT.select(rate=rate), Streams(10), unit="ideal")
        rms.append(_fly(device, lambda t, felt=vibration.on: felt((0.0, 0.0, 0.0)), 20.0)[:, 1:].std())
    assert rms[0] == pytest.approx(G0, rel=0.1)  # linear between steps takes up to (sinc 0.2)² at 200 Hz
    # Mean power of one pole at 26 Hz over a flat band of 5 to 200 Hz: 26/195 (atan(200/26) - atan(5/26)) = 0.166.
    assert rms[1] / G0 == pytest.approx(np.sqrt(0.166), rel=0.1)


@pytest.mark.parametrize(("name", "count"), [("lsm6dso32", 250_000), ("adxl345", 240_000)])
def test_white_noise_has_the_datasheets_density(name, count):
    """The low-frequency density of the record is n, one-sided, and its Allan deviation N/√τ with N = n/√2.

    Drift off, quantisation on (it adds q²/12 a sample). 300 s at 4 sigma: 30 000 lines below 100 Hz see 2.3 % in
    power, 3000 groups of 0.1 s see 13 % in Allan variance, that is a factor √2 or 2 in n many times over.
    """
    part = replace(preset(name), drift_sd=0.0, random_walk=0.0)
    values = _record(Accelerometer(part, Streams(11), unit="ideal"), count)[:, 1:]
    quantisation = part.resolution**2 / 12 / (part.rate / 2)  # its one-sided density, squared
    density = np.square(part.noise_density) + quantisation
    assert values.var(axis=0) / (density * part.rate / 2) == pytest.approx([1, 1, 1], abs=4 * np.sqrt(2 / count))

    spectrum = np.abs(np.fft.rfft(values - values.mean(axis=0), axis=0)) ** 2 * 2 / (part.rate * count)
    low = spectrum[1 : round(100.0 * count / part.rate)]
    assert low.mean(axis=0) / density == pytest.approx([1, 1, 1], abs=4 / np.sqrt(len(low)))

    group = round(0.1 * part.rate)
    means = values[: count // group * group].reshape(-1, group, 3).mean(axis=1)
    allan = np.mean(np.diff(means, axis=0) ** 2, axis=0) / 2
    expected = (density / 2) / (group / part.rate)
    assert allan / expected == pytest.approx([1, 1, 1], abs=4 * np.sqrt(3 / len(means)))


def test_noise_scale_holds_for_the_unit_and_for_the_filter():
    """n = 50 000 samples: 1.3 % in sigma is caught at 4 sigma; the quantisation is 6 % of it, 0.2 % in sigma."""
    part = AccelerometerSettings(noise_scale=3.0).description()
    assert part.noise_sd == pytest.approx(3 * np.array(LSM.noise_sd))
    record = _record(Accelerometer(part, Streams(12), unit="ideal"), 50_000)
    assert np.diff(record[:, 1:], axis=0).std(axis=0) / np.sqrt(2) / part.noise_sd == pytest.approx([1, 1, 1], abs=0.02)


# -- geometry ------------------------------------------------------------------------------------------------------

RIGHT_ANGLES = sorted(set(every((0.0, 90.0, 180.0, 270.0), (0.0, 90.0, 270.0), (0.0, 90.0, 180.0, 270.0))))
ANYHOW = [tuple(angles) for angles in np.random.default_rng(1).uniform(-180, 180, (20, 3))]


@pytest.mark.parametrize("angles", [*RIGHT_ANGLES[::2], *ANYHOW])
def test_one_g_at_rest_and_nothing_in_free_fall_on_every_mount(angles):
    """A case at any attitude reads g0 along the vertical as its axes see it: Rᵀ (0, 0, -g0)."""
    device = Accelerometer(SILENT, Streams(1), unit="ideal", mounting=attitude(*angles))
    reading = _fly(device, _rest, 0.01)[-1, 1:]
    assert reading == pytest.approx(np.array(attitude(*angles)).T @ _rest(0), abs=FINE)
    assert np.linalg.norm(reading) == pytest.approx(G0, abs=2 * FINE)
    falling = Accelerometer(SILENT, Streams(1), unit="ideal", mounting=attitude(*angles))
    assert set(_fly(falling, lambda t: (0.0, 0.0, 0.0), 0.01)[:, 1:].ravel()) == {0.0}


def test_right_angle_mounts_are_all_24_and_exact():
    mounts = {attitude(*angles) for angles in RIGHT_ANGLES}
    assert len(mounts) == 24
    for mount in mounts:
        device = Accelerometer(SILENT, Streams(1), unit="ideal", mounting=mount)
        reading = _fly(device, lambda t: (1.0, 2.0, 3.0), 0.005)[0, 1:]
        assert sorted(np.abs(reading)) == pytest.approx([1, 2, 3], abs=FINE)


def test_the_unknown_part_of_the_mounting_comes_after_the_known_one():
    """Nose up by 90°, then rolled by 2° about the case's own x: what is undone on board leaves a roll by 2°."""
    chosen = AccelerometerSettings(mounting_deg=(0, 90, 0), mounting_error_deg=(2, 0, 0), unit="ideal")
    device = Accelerometer.from_settings(chosen, Streams(1))
    mounting = product(attitude(0, 90, 0), attitude(2, 0, 0))
    assert np.array(mounting) == pytest.approx(np.array(attitude(0, 90, 0)) @ attitude(2, 0, 0))
    reading = next(device.at_rest((1.0, 2.0, 3.0)))[:, 1:].mean(axis=0)
    assert reading == pytest.approx(np.array(mounting).T @ (1, 2, 3), abs=0.02)


def test_vibration_is_turned_with_the_case():
    vibration = VibrationSettings(waiting_rms_g=1.0)

    def readings(mounting):
        shaking = Vibration(vibration, Streams(10), dt=DT, release_time=np.inf, plateau=0.0)
        device = Accelerometer(SILENT, Streams(10), unit="ideal", mounting=mounting)
        return _fly(device, lambda t: shaking.on((0.0, 0.0, 0.0)), 1.0)[:, 1:]

    straight, turned = readings(attitude(0, 0, 0)), readings(attitude(10, 20, 30))
    assert turned == pytest.approx(straight @ np.array(attitude(10, 20, 30)), abs=1e-6)


def test_vibration_is_felt_from_the_first_step_on():
    """At 6664 Hz six readings lie between the plant's first two steps."""
    steady = Vibration(VibrationSettings(), Streams(10), dt=DT, release_time=np.inf, plateau=0.0)
    steady.step = lambda: (5.0, 6.0, 7.0)
    device = Accelerometer(OPEN.select(rate=6664.0), Streams(1), unit="ideal")
    readings = _fly(device, lambda t: steady.on(_rest(t)), 0.01)
    assert readings[:, 1:] == pytest.approx(np.tile([5.0, 6.0, 7.0 - G0], (len(readings), 1)), abs=1e-9)


# -- nonlinearity --------------------------------------------------------------------------------------------------


def test_nonlinearity_is_the_datasheets_deviation_from_the_best_straight_line():
    """Authority: the best line over ±range by the Chebyshev alternation, here by a fine search; 1 % of 0.5 %."""
    part = replace(SILENT.scaled(1.0, AccelerometerErrors(saturation=False, bandwidth=False)), nonlinearity_sd=0.005)
    device = Accelerometer(replace(part, bias_sd=(0,) * 3, scale_sd=0.0), Streams(1), unit="typical")
    forces = np.linspace(-part.range, part.range, 401)
    readings = _fly(device, lambda t: (float(np.interp(t, np.arange(401) * 0.05, forces)),) * 3, 20.0)
    truth = np.interp(readings[:, 0], np.arange(401) * 0.05, forces)
    for axis in (1, 2, 3):
        off = readings[:, axis] - truth
        slopes = np.linspace(0.0, 0.04, 4001)
        best = min(np.abs(off - slope * truth).max() for slope in slopes)
        assert best / part.range == pytest.approx(0.005, rel=0.01)
    assert device.nonlinearity == (4 * 0.005 / part.range**2,) * 3


def test_rectification_turns_vibration_into_an_offset_before_the_bandwidth():
    """A sinusoid of rms s adds k₂ s² to the mean, also far above the bandwidth that hides the sinusoid itself: 1 %."""
    part = replace(SILENT, rectification_sd=1e-3, bias_sd=(0,) * 3, scale_sd=0.0)
    amplitude, frequency = 20.0, 200.0  # m/s² and Hz: four times the bandwidth, five steps a period
    low = replace(part.select(rate=104.0), bandwidths=((5.0,) * 10,), noise_densities=SILENT.noise_densities)
    device = Accelerometer(low, Streams(1), unit="typical")
    assert device.rectification == (1e-3,) * 3
    readings = _fly(device, lambda t: (amplitude * np.sin(2 * np.pi * frequency * t), 0.0, 0.0), 4.0)
    late = readings[readings[:, 0] > 2.0]
    assert late[:, 1].mean() == pytest.approx(1e-3 * amplitude**2 / 2, rel=0.01)
    assert late[:, 1].std() < 0.05 * amplitude
    assert np.abs(late[:, 2:]).max() < FINE


# -- bandwidth, delay, window --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("poles", "steps"), [(1, 1), (2, np.sqrt(2))])
def test_a_ramp_is_late_by_the_low_passes_own_delay(poles, steps):
    """One pole: 1/ω. Two, Butterworth: √2/ω."""
    part = replace(SILENT, poles=poles, bandwidths=((40.0,) * 10,))
    readings = _fly(Accelerometer(part, Streams(3), unit="ideal"), lambda t: (100 * t, -50 * t, 0.0), 1.0)
    late = readings[readings[:, 0] > 0.5]
    lag = steps / (2 * np.pi * 40.0)
    assert late[:, 1] == pytest.approx(100 * (late[:, 0] - lag), abs=1e-6)
    assert late[:, 2] == pytest.approx(-50 * (late[:, 0] - lag), abs=1e-6)


@pytest.mark.parametrize("poles", [1, 2])
def test_without_bandwidth_a_ramp_is_read_at_the_very_instant(poles):
    part = replace(OPEN, poles=poles)
    readings = _fly(Accelerometer(part, Streams(3), unit="ideal"), lambda t: (t, -t, 0.0), 0.5)
    assert readings[:, 1] == pytest.approx(readings[:, 0], abs=1e-9)


@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize("periods", [0.001, 1.37, 40.2])
def test_delay_of_a_ramp_to_the_nanosecond(periods, poles):
    """A delay of 1.37 sample periods is no multiple of the plant's step; the ramp rises by 1 m/s² a second."""
    part = replace(OPEN, poles=poles)
    delay = periods / part.rate
    readings = _fly(Accelerometer(part, Streams(3), unit="ideal", delay=delay), lambda t: (t, -2 * t, 0.0), 0.5)
    late = readings[readings[:, 0] > delay]
    assert late[:, 1] == pytest.approx(late[:, 0] - delay, abs=1e-9)
    assert late[:, 2] == pytest.approx(-2 * (late[:, 0] - delay), abs=2e-9)
    early = readings[readings[:, 0] < delay]
    assert np.abs(early[:, 1:]).max(initial=0.0) < 1e-9  # the first force was there before


def test_jitter_of_the_delay_is_not_in_the_time_stamps():
    """1 ms ± 0.1 ms over 8300 readings: mean to 5 sd of 1.1e-6 s, sd to 5 sd of 0.8 %; time stamps stay exact."""
    device = Accelerometer(OPEN, Streams(3), unit="ideal", delay=1e-3, delay_jitter=1e-4)
    readings = _fly(device, lambda t: (t, 0.0, 0.0), 10.0)[10:]
    ages = readings[:, 0] - readings[:, 1]
    assert np.diff(readings[:, 0]) == pytest.approx(np.full(len(readings) - 1, 1 / 833), abs=1e-12)
    assert ages.mean() == pytest.approx(1e-3, abs=5.5e-6)
    assert ages.std() == pytest.approx(1e-4, rel=0.04)
    assert np.corrcoef(ages[1:], ages[:-1])[0, 1] == pytest.approx(0.0, abs=5 / np.sqrt(len(ages)))


def test_a_delay_never_looks_into_the_future():
    device = Accelerometer(OPEN, Streams(3), unit="ideal", delay=0.0, delay_jitter=1e-4)
    readings = _fly(device, lambda t: (t, 0.0, 0.0), 5.0)
    assert (readings[:, 0] - readings[:, 1]).min() > -1e-9


@pytest.mark.parametrize("rate", [104.0, 833.0, 1666.0])
def test_a_part_without_poles_reads_the_mean_since_the_last_reading(rate):
    """Of a parabola over T: t² - T t + T²/3, the linear pieces of its steps add dt²/6; a ramp is late by T/2."""
    part = replace(OPEN.select(rate=rate), poles=0)
    readings = _fly(Accelerometer(part, Streams(3), unit="ideal"), lambda t: (t, t * t, -G0), 0.5)
    late, window = readings[readings[:, 0] > 0.1], 1 / rate
    assert late[:, 1] == pytest.approx(late[:, 0] - window / 2, abs=1e-9)
    assert late[:, 2] == pytest.approx(late[:, 0] ** 2 - window * late[:, 0] + window**2 / 3, abs=DT**2 / 4)
    assert late[:, 3] == pytest.approx(np.full(len(late), -G0), abs=1e-9)
    assert part.noise_sd == part.white_sd


# -- clock ---------------------------------------------------------------------------------------------------------


def test_rate_error_of_the_unit_and_of_the_scenario():
    part = replace(SILENT, rate_sd=0.01, rate_limit=0.03)
    unit = Accelerometer(part, Streams(4))
    assert 0 < abs(unit.rate_error) <= 0.03
    more = Accelerometer(part, Streams(4), rate_error=0.02)
    assert more.rate_error == pytest.approx(unit.rate_error + 0.02)
    readings = _fly(more, lambda t: (t, 0.0, 0.0), 2.0)
    assert np.diff(readings[:, 0]) == pytest.approx(np.full(len(readings) - 1, 1 / 833 / (1 + more.rate_error)))
    assert Accelerometer.from_settings(AccelerometerSettings(rate_error_percent=-3.0), Streams(4)).rate_error == -0.03


def test_jitter_moves_the_instants_and_the_time_stamps_with_them():
    """50 µs over 8300 readings: sd to 5 sd of 0.8 %; what is read is the truth at the very time stamp."""
    plain = _fly(Accelerometer(OPEN, Streams(4), unit="ideal"), lambda t: (t, 0.0, 0.0), 10.0)
    readings = _fly(Accelerometer(OPEN, Streams(4), unit="ideal", jitter=5e-5), lambda t: (t, 0.0, 0.0), 10.0)
    count = min(len(plain), len(readings))
    moved = readings[:count, 0] - plain[:count, 0]
    assert moved.std() == pytest.approx(5e-5, rel=0.04)
    assert readings[:, 1] == pytest.approx(readings[:, 0], abs=1e-9)
    assert np.diff(readings[:, 0]).min() > 0


# -- scale, cross-axis, temperature --------------------------------------------------------------------------------


def test_cross_axis_alone():
    """Each channel reads a share of the two others; six terms, each its own, within the bound."""
    part = replace(SILENT, cross_axis_sd=0.01, cross_axis_limit=0.02, bias_sd=(0,) * 3, scale_sd=0.0)
    device = Accelerometer(part, Streams(5))
    c = np.array(device.cross_axis)
    assert np.diag(c).tolist() == [0, 0, 0]
    terms = c[~np.eye(3, dtype=bool)]
    assert len(set(terms)) == 6
    assert np.abs(terms).max() <= 0.02
    truth = np.array([20.0, -30.0, 40.0])
    assert _fly(device, lambda t: tuple(truth), 0.01)[0, 1:] == pytest.approx((np.eye(3) + c) @ truth, abs=2 * FINE)


def test_cross_axis_is_of_the_case_and_not_of_the_body():
    part = replace(SILENT, cross_axis_sd=0.01, cross_axis_limit=inf, rectification_sd=1e-4)
    part = replace(part, bias_sd=(0,) * 3, scale_sd=0.0)
    mounting = attitude(10, 20, 30)
    device = Accelerometer(part, Streams(5), mounting=mounting)
    u = np.array(mounting).T @ (20.0, -30.0, 40.0)
    expected = (np.eye(3) + device.cross_axis) @ (u + np.array(device.rectification) * u**2)
    assert _fly(device, lambda t: (20.0, -30.0, 40.0), 0.01)[0, 1:] == pytest.approx(expected, abs=2 * FINE)


TC = replace(SILENT, bias_sd=(0,) * 3, scale_sd=0.0, bias_tc_sd=(0.1, 0.2, 0.3), bias_tc_limit=(inf,) * 3)
FORCE = (20.0, -30.0, 40.0)


def test_offset_and_scale_follow_the_dies_temperature():
    """tc (T - 25 °C), of an offset and of the scale; nothing at 25 °C."""
    part = replace(TC, scale_tc_sd=1e-3, scale_tc_limit=inf)

    def reading(kelvin):
        device = Accelerometer(
            part, Streams(5), unit="typical", surroundings=Air(lambda: REFERENCE_TEMPERATURE + kelvin)
        )
        return _fly(device, lambda t: FORCE, 0.01)[0, 1:]

    assert reading(0.0) == pytest.approx(FORCE, abs=FINE)
    for kelvin in (-40.0, 10.0):
        expected = np.array(FORCE) * (1 + 1e-3 * kelvin) + np.array([0.1, 0.2, 0.3]) * kelvin
        assert reading(kelvin) == pytest.approx(expected, abs=2 * FINE)


def test_a_part_whose_offset_alone_follows_the_temperature_is_warmed():
    """0.1, 0.2, 0.3 (m/s²)/K, 10 K above 25 °C, and a scale that does not change."""
    air = Air(lambda: REFERENCE_TEMPERATURE + 10.0)
    part = replace(TC, scale_tc_sd=0.0)
    readings = _fly(Accelerometer(part, Streams(5), unit="typical", surroundings=air), lambda t: FORCE, 0.01)
    assert readings[0, 1:] == pytest.approx(np.array(FORCE) + np.array([1.0, 2.0, 3.0]), abs=2 * FINE)


def test_without_an_air_temperature_it_is_25_degrees():
    assert _fly(Accelerometer(TC, Streams(5), unit="typical"), lambda t: FORCE, 3.0)[-1, 1:] == pytest.approx(
        FORCE, abs=FINE
    )


@pytest.mark.parametrize("rate", [12.5, 833.0, 6664.0])
def test_the_die_warms_up_with_its_lag(rate):
    """10 K of self-heating with 5 s from switching on; its temperature is renewed at least once a second: 2 K/s."""
    thermal = ThermalSettings(self_heating=10.0, lag=5.0, powered_for=0.0)
    device = Accelerometer(TC.select(rate=rate), Streams(5), unit="typical", thermal=thermal)
    readings = np.vstack(list(islice(device.at_rest((0.0, 0.0, 0.0)), round(20 * max(1, rate / 512)) + 20)))
    readings = readings[readings[:, 0] < 20.0]
    warmer = readings[:, 2] / 0.2
    now, before = (10 * (1 - np.exp(-np.maximum(readings[:, 0] - back, 0) / 5)) for back in (0.0, 1.0))
    assert np.all(warmer <= now + 1e-6)
    assert np.all(warmer >= before - 1e-6)
    assert warmer[-1] == pytest.approx(10.0, abs=0.3)


def test_the_air_is_asked_about_once_a_second_and_not_at_all_where_it_has_no_effect():
    asked = []
    part = replace(TC, bias_tc_sd=(0,) * 3, scale_tc_sd=0.0)
    for description in (TC, part):
        device = Accelerometer(description, Streams(5), surroundings=Air(lambda: asked.append(1) or 280.0))
        _fly(device, _rest, 10.0)
    assert 10 <= len(asked) <= 20


# -- draws ---------------------------------------------------------------------------------------------------------

EVERYTHING = replace(
    LSM,
    cross_axis_sd=0.01, cross_axis_limit=0.02, nonlinearity_sd=2e-3, rectification_sd=1e-4, rate_sd=0.01,
    rate_limit=0.02,
)  # fmt: skip


def test_a_typical_unit_is_off_by_one_standard_deviation_everywhere_and_an_ideal_one_nowhere():
    d, unit = EVERYTHING, Accelerometer(EVERYTHING, Streams(1), unit="typical")
    assert (unit.bias, unit.bias_tc) == (d.bias_sd, d.bias_tc_sd)
    assert (unit.scale_error, unit.scale_tc) == ((d.scale_sd,) * 3, (d.scale_tc_sd,) * 3)
    assert np.array(unit.cross_axis) == pytest.approx(d.cross_axis_sd * (1 - np.eye(3)), abs=0)
    assert unit.nonlinearity == (4 * d.nonlinearity_sd / d.range**2,) * 3
    assert unit.rectification == (d.rectification_sd,) * 3
    assert unit.rate_error == d.rate_sd
    ideal = Accelerometer(EVERYTHING, Streams(1), unit="ideal")
    terms = (ideal.bias, ideal.bias_tc, ideal.scale_error, ideal.scale_tc, *ideal.cross_axis, ideal.nonlinearity)
    assert {value for term in (*terms, ideal.rectification, (ideal.rate_error,)) for value in term} == {0.0}


TERMS = ("bias", "bias_tc", "scale_error", "scale_tc", "cross_axis", "nonlinearity", "rectification", "rate_error")


@pytest.mark.parametrize(
    ("off", "changed"),
    [
        ({"bias_sd": (0.0,) * 3}, {"bias"}),
        ({"bias_tc_sd": (0.0,) * 3}, {"bias_tc"}),
        ({"scale_sd": 0.0}, {"scale_error"}),
        ({"scale_tc_sd": 0.0}, {"scale_tc"}),
        ({"cross_axis_sd": 0.0}, {"cross_axis"}),
        ({"nonlinearity_sd": 0.0}, {"nonlinearity"}),
        ({"rectification_sd": 0.0}, {"rectification"}),
        ({"rate_sd": 0.0}, {"rate_error"}),
        ({"drift_sd": 0.0}, set()),
        ({"random_walk": 0.0}, set()),
        ({"noise_densities": ((0.0,) * 3,) * 4}, set()),
    ],
)
def test_a_term_that_is_off_changes_no_other_draw(off, changed):
    with_it, without = Accelerometer(EVERYTHING, Streams(9)), Accelerometer(replace(EVERYTHING, **off), Streams(9))
    assert {term for term in TERMS if getattr(with_it, term) != getattr(without, term)} == changed
    assert with_it.phase * (1 + with_it.rate_error) == pytest.approx(without.phase * (1 + without.rate_error))


@pytest.mark.parametrize(
    "more",
    [
        {"faults": (Fault("spike", start=5.0, size=1.0),)},
        {"surroundings": Air(lambda: REFERENCE_TEMPERATURE)},
        {"mounting": attitude(0, 0, 0)},
        {"thermal": ThermalSettings()},
    ],
)
def test_what_is_added_without_effect_leaves_each_reading_as_it_was(more):
    assert np.array_equal(
        _fly(Accelerometer(LSM, Streams(9), **more), _rest, 1.0), _fly(Accelerometer(LSM, Streams(9)), _rest, 1.0)
    )


def test_a_second_sensor_and_looking_at_rest_change_no_reading():
    """Nor does whoever else draws from the same seed; the second one has its own bias, noise and phase."""
    alone = _fly(Accelerometer(EVERYTHING, Streams(9)), _rest, 1.0)
    streams = Streams(9)
    first, second = Accelerometer(EVERYTHING, streams), Accelerometer(EVERYTHING, streams, name="second")
    streams("gyroscope.white").normal(size=1000)
    both = []
    for k in range(1001):
        both += first.step((k * DT, _rest(k)))
        second.step((k * DT, _rest(k)))
        if k == 500:
            next(first.at_rest(_rest(k)))
    assert np.array_equal(alone, np.array(both))
    assert first.bias != second.bias
    assert first.phase != second.phase


# -- bounds of a reading -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in presets() if hasattr(preset(name), "ranges_g")])
def test_no_reading_leaves_the_range(name):
    """Whatever is felt and at every range, in two's complement; and with saturation off it does."""
    part = preset(name)
    for range_g in part.ranges_g:
        limited = part.select(range_g=range_g)
        device = Accelerometer(limited, Streams(8))
        readings = _fly(device, lambda t, r=limited.range: (2 * r * np.sin(40 * t), -3 * r, 1.01 * r), 0.2)[:, 1:]
        assert readings.max() <= limited.range - limited.resolution * (1 - 1e-9)
        assert readings.min() >= -limited.range
    free = Accelerometer(part.scaled(1.0, AccelerometerErrors(saturation=False)), Streams(8), unit="ideal")
    assert _fly(free, lambda t: (0.0, 3 * part.range, 0.0), 0.2)[-1, 2] == pytest.approx(3 * part.range, rel=0.02)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1, 1])
def test_each_axis_ends_at_the_range_by_itself(axis, sign):
    """A little beyond on one axis, nothing on the others."""
    force = tuple(sign * 1.01 * SILENT.range if i == axis else 0.0 for i in range(3))
    reading = _fly(Accelerometer(SILENT, Streams(8), unit="ideal"), lambda t: force, 0.01)[-1, 1:]
    assert reading[axis] == pytest.approx(sign * SILENT.range, rel=1e-9)
    assert np.delete(reading, axis).tolist() == [0.0, 0.0]


def test_quantisation_error_is_uniform():
    """Chi-square over 20 bins of 20 000 readings of a slow ramp, α = 1e-3: a bin 8 % too full is caught.

    The ramp takes an irrational share of a step, 0.46, from one reading to the next: all places within one alike.
    """
    part = replace(LSM, noise_densities=SILENT.noise_densities, drift_sd=0.0, random_walk=0.0)
    part = part.scaled(1.0, AccelerometerErrors(bandwidth=False, saturation=False))
    slope = 0.37 * part.resolution * part.rate * (np.sqrt(5) - 1)
    readings = _fly(Accelerometer(part, Streams(9), unit="ideal"), lambda t: (slope * t, 0.0, 0.0), 24.02)[:20_000]
    error = (readings[:, 1] - slope * readings[:, 0]) / part.resolution
    assert np.abs(error).max() <= 0.5 + 1e-6
    counts, _ = np.histogram(error, bins=20, range=(-0.5, 0.5))
    assert ((counts - 1000) ** 2 / 1000).sum() < chi2.ppf(1 - 1e-3, 19)
    assert error.mean() == pytest.approx(0.0, abs=5 / np.sqrt(12 * 20_000))  # it rounds, it does not cut


# -- noise behind the part's low-pass ------------------------------------------------------------------------------


@pytest.mark.parametrize("poles", [1, 2])
@pytest.mark.parametrize("bandwidth", [40.0, 200.0])
def test_noise_has_the_standard_deviation_its_description_states(poles, bandwidth):
    """Behind a filter below half the rate; 100 000 readings, 1/4 to 1/20 of them independent: 5 sd are 2.3 to 5 %.

    Without the filter's effect on the noise it would be 1.4 to 3.4 times as much.
    """
    part = replace(LSM, poles=poles, bandwidths=((bandwidth,) * 10,), drift_sd=0.0, random_walk=0.0)
    assert np.all(np.array(part.noise_sd) < 0.8 * np.array(part.white_sd))
    values = _record_at_rest(Accelerometer(part, Streams(11), unit="ideal"), 100_000)[:, 1:]
    expected = np.sqrt(np.square(part.noise_sd) + part.resolution**2 / 12)
    assert values.std(axis=0) / expected == pytest.approx([1, 1, 1], abs=0.02 if bandwidth > 100 else 0.05)


def test_drift_can_be_flicker():
    part = replace(SILENT, drift_sd=0.5, correlation_time=2.0)
    part = part.scaled(1.0, AccelerometerErrors(drift_model="flicker"))
    values = _record_at_rest(Accelerometer(part, Streams(7), unit="ideal"), 1024)[:, 1:]
    drift = noise.drift(Streams(7)("accelerometer.drift"), "flicker", 0.5, 2.0, 1 / 833.0, axes=3)
    assert values == pytest.approx(next(drift) + np.array([0, 0, -G0]), abs=FINE)


# -- in blocks -----------------------------------------------------------------------------------------------------


def _record_at_rest(device, count):
    """Readings of the unit at rest, in blocks."""
    blocks, gathered = device.at_rest((0.0, 0.0, -G0)), []
    while sum(map(len, gathered)) < count:
        gathered.append(next(blocks))
    return np.vstack(gathered)[:count]


@pytest.mark.parametrize(
    ("part", "more"),
    [
        (LSM, {}),
        (LSM.select(rate=6664.0), {"surroundings": Air(lambda: 263.15)}),
        (EVERYTHING, {"mounting": attitude(3, 200, 50), "jitter": 1e-4, "delay": 2e-3, "delay_jitter": 1e-4}),
        (replace(EVERYTHING, poles=2, bandwidths=((60.0,) * 10,)), {"surroundings": Air(lambda: 263.15)}),
        (replace(EVERYTHING, poles=0), {"rate_error": 0.013}),
        (LSM.select(range_g=4).scaled(3.0, AccelerometerErrors(drift_model="flicker", scale=30.0)), {"bias": 36.0}),
        (preset("adxl345"), {"thermal": ThermalSettings(5.0, 2.0, 0.0)}),
    ],
)
def test_at_rest_it_reads_in_blocks_what_it_reads_step_by_step(part, more):
    """Bit for bit, over several blocks, with everything that a steady force can show, saturation included."""
    stepped = _fly(Accelerometer(part, Streams(12), **more), lambda t: (1.3, -0.4, -G0), 3.0)
    blocks = Accelerometer(part, Streams(12), **more).at_rest((1.3, -0.4, -G0))
    gathered = np.vstack(list(islice(blocks, 40)))
    assert np.array_equal(stepped, gathered[: len(stepped)])
    assert len(gathered) > len(stepped) > 1000


# -- faults --------------------------------------------------------------------------------------------------------


def test_faults_hit_the_readings_in_their_time():
    faults = (Fault("dropout", start=0.2, stop=0.3), Fault("invalid", start=0.4, stop=0.5, axis="x"))
    plain, broken = (_fly(Accelerometer(LSM, Streams(3), faults=f), _rest, 1.0) for f in ((), faults))
    kept = plain[(plain[:, 0] < 0.2) | (plain[:, 0] >= 0.3)]
    assert np.array_equal(broken[:, 0], kept[:, 0])
    invalid = (kept[:, 0] >= 0.4) & (kept[:, 0] < 0.5)
    assert np.array_equal(np.isnan(broken[:, 1]), invalid)
    assert np.array_equal(broken[:, 2:], kept[:, 2:])
    assert np.array_equal(broken[~invalid], kept[~invalid])


# -- what is no number ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("bad", [nan, inf, -inf])
@pytest.mark.parametrize("rate", [104.0, 833.0, 6664.0])
@pytest.mark.parametrize(
    ("changes", "more"),
    [
        ({}, {}),
        ({"poles": 2}, {}),
        ({"poles": 0}, {}),
        ({}, {"delay": 0.003}),
        ({"poles": 2, "rectification_sd": 1e-4, "cross_axis_sd": 0.01}, {"delay": 0.003, "delay_jitter": 1e-4}),
        ({"errors": AccelerometerErrors(saturation=False, bandwidth=False)}, {}),
    ],
)
def test_truth_that_is_no_number_is_read_as_such_and_forgotten(bad, rate, changes, more):
    """Invalid or at the end of the range while it lasts (a delay later), a number again three readings after it."""
    device = Accelerometer(replace(SILENT.select(rate=rate), **changes), Streams(13), unit="typical", **more)
    readings = _fly(device, lambda t: (bad if 0.2 <= t < 0.3 else 1.0, 2.0, -G0), 0.6)
    t, x, delay = readings[:, 0], readings[:, 1], more.get("delay", 0.0)
    during = (t > 0.202 + 1.5 * delay + 1 / rate) & (t < 0.298)
    assert during.any()
    assert not np.any(np.isfinite(x[during]) & (np.abs(x[during]) < 0.99 * (SILENT.range - SILENT.resolution)))
    after = t > 0.3 + 2 * delay + 3 / rate + 3 * DT
    assert np.isfinite(readings[after]).all()
    assert np.isfinite(readings[t < 0.199]).all()
    settled = readings[t > 0.5]
    quiet = Accelerometer(replace(SILENT.select(rate=rate), **changes), Streams(13), unit="typical", **more)
    expected = next(quiet.at_rest((1.0, 2.0, -G0)))[0, 1:]
    assert settled[:, 1:] == pytest.approx(np.tile(expected, (len(settled), 1)), abs=0.02)


def test_a_diverged_plant_leaves_the_other_axes_alone():
    device = Accelerometer(LSM, Streams(13))
    readings = _fly(device, lambda t: (np.nan, np.inf if t > 0.05 else 0.0, 0.0), 0.1)
    assert np.isnan(readings[:, 1]).all()
    assert np.isfinite(readings[:, 3]).all()


def test_air_that_is_no_number_makes_readings_that_are_none_and_is_forgotten():
    now = [0.0]
    device = Accelerometer(TC, Streams(5), surroundings=Air(lambda: nan if 2.0 < now[0] < 4.0 else 280.0))
    readings = []
    for k in range(8001):
        now[0] = k * DT
        readings += device.step((now[0], _rest(0)))
    readings = np.array(readings)
    assert np.isnan(readings[(readings[:, 0] > 3.0) & (readings[:, 0] < 3.9), 1]).all()
    assert np.isfinite(readings[readings[:, 0] > 5.0]).all()


# -- the whole domain ----------------------------------------------------------------------------------------------


def _domain(kind, field):
    """Any value that a field's annotation allows."""
    annotation = kind.__annotations__[field]
    bounds = [m for m in getattr(annotation, "__metadata__", ()) if isinstance(m, Interval)]
    if bounds:
        low = bounds[0].ge if bounds[0].ge is not None else bounds[0].gt
        high = bounds[0].le if bounds[0].le is not None else bounds[0].lt
        return st.floats(low, high, exclude_min=bounds[0].gt is not None, exclude_max=bounds[0].lt is not None)
    values = {bool: st.booleans(), noise.DriftModel: st.sampled_from(["gauss-markov", "flicker"])}
    return values[annotation]


ERRORS = st.builds(
    AccelerometerErrors, **{f.name: _domain(AccelerometerErrors, f.name) for f in fields(AccelerometerErrors)}
)
THERMAL = st.builds(ThermalSettings, **{f.name: _domain(ThermalSettings, f.name) for f in fields(ThermalSettings)})
ANGLES = st.tuples(*[st.floats(-360.0, 360.0)] * 3)
BIAS = st.floats(-1000.0, 1000.0)
CHOSEN = st.builds(
    AccelerometerSettings,
    preset=st.sampled_from([name for name in presets() if hasattr(preset(name), "ranges_g")]),
    errors=ERRORS,
    thermal=THERMAL,
    unit=st.sampled_from(["random", "typical", "ideal"]),
    bias=st.one_of(BIAS, st.tuples(BIAS, BIAS, BIAS)),
    mounting_deg=ANGLES,
    mounting_error_deg=ANGLES,
    **{
        name: _domain(AccelerometerSettings, name)
        for name in ("noise_scale", "rate_error_percent", "jitter", "delay", "delay_jitter")
    },
)
FORCES = st.lists(st.tuples(*[st.floats(-1e5, 1e5)] * 3), min_size=1, max_size=5)


@settings(max_examples=150, deadline=None)
@given(CHOSEN, FORCES, st.floats(150.0, 400.0), st.sampled_from([0, 1, 2]))
def test_finite_in_finite_out_over_the_whole_domain_of_the_settings(chosen, forces, air, poles):
    """Every factor, preset, unit, mount, clock, delay and temperature that a scenario may choose, together.

    Errors of a thousand times the datasheet's included: what a scenario may not be is refused by ValueError, nothing
    else is raised, and no reading is anything but a number within the range.
    """
    try:
        description = replace(chosen.description(), poles=poles)
        device = Accelerometer(
            description,
            Streams(1),
            unit=chosen.unit,
            bias=chosen.bias,
            mounting=product(attitude(*chosen.mounting_deg), attitude(*chosen.mounting_error_deg)),
            rate_error=0.01 * chosen.rate_error_percent,
            jitter=chosen.jitter,
            delay=chosen.delay,
            delay_jitter=chosen.delay_jitter,
            thermal=chosen.thermal,
            surroundings=Air(lambda: air),
        )
    except ValueError as error:
        if "rate must be above 0" in str(error):  # an oscillator a thousand times as bad as the datasheet's
            return
        raise
    readings = _fly(device, lambda t: forces[round(t / DT) % len(forces)], 0.1)
    assert np.isfinite(readings).all()
    if chosen.errors.saturation and len(readings):
        assert np.abs(readings[:, 1:]).max() <= description.range
    assert np.all(np.diff(readings[:, 0]) > 0)


@pytest.mark.parametrize("figure", [-1e-3, nan, inf])
@pytest.mark.parametrize("name", ["delay", "delay_jitter", "jitter"])
def test_times_that_cannot_be_are_refused(name, figure):
    with pytest.raises(ValueError, match=name):
        Accelerometer(LSM, Streams(1), **{name: figure})


def test_from_settings_takes_what_a_scenario_chooses():
    chosen = AccelerometerSettings(
        preset="adxl345", noise_scale=0.0, bias=(1.0, 2.0, 3.0), unit="ideal", mounting_deg=(0.0, 0.0, 90.0),
        rate_error_percent=1.0, delay=0.01, faults=(Fault("offset", size=5.0, axis="z"),),
        errors=AccelerometerErrors(drift=0.0, random_walk=0.0, quantisation=False),
    )  # fmt: skip
    device = Accelerometer.from_settings(chosen, Streams(1), surroundings=Air(lambda: 300.0))
    assert device.description == chosen.description()
    assert device.bias == (1.0, 2.0, 3.0)
    assert device.rate_error == 0.01
    reading = _fly(device, lambda t: (10.0, 0.0, -G0), 0.05)[-1, 1:]
    assert reading == pytest.approx([1.0, -10.0 + 2.0, -G0 + 3.0 + 5.0], abs=1e-6)


def test_no_delay_is_longer_than_the_widest(monkeypatch):
    """At 1.5 standard deviations one in 15 is cut off there, and one in 40 would be below 0."""
    monkeypatch.setattr(accelerometer, "WIDEST_DELAY", 1.5)
    found = np.array(list(islice(accelerometer._delays(2e-3, 1e-3, np.random.default_rng(5)), 20_000)))
    assert (found.min(), found.max()) == pytest.approx((0.0, 3.5e-3), abs=1e-15)
    assert np.mean(found == found.max()) == pytest.approx(0.0668, abs=0.009)  # 5 sd of a share of 20 000
