"""The accelerometer, each error alone, then its noise against its density."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import cont2discrete

from sensors import Accelerometer, AccelerometerSettings, Streams, Vibration, VibrationSettings, noise, preset
from sensors.filters import one_pole

G0 = 9.80665
DT = 1e-3
LSM = preset("lsm6dso32")
# A part without noise and drift, in steps of 2e-9 m/s²: what is left is the error under test.
SILENT = replace(LSM, noise_densities=((0.0, 0.0, 0.0),) * 4, drift_sd=0.0, random_walk=0.0, bits=(38, 38, 38, 38))
FINE = 1e-8  # m/s²


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


def test_one_pole_is_the_first_order_hold():
    """Authority: scipy.signal.cont2discrete(method="foh")."""
    time_constant = 1 / (2 * np.pi * 52.0)
    numerator, denominator, _ = cont2discrete(([1.0], [time_constant, 1.0]), DT, method="foh")
    a, b0, b1 = one_pole(52.0, DT)
    assert (b1, b0) == pytest.approx(tuple(numerator.ravel()), rel=1e-9)
    assert (1.0, -a) == pytest.approx(tuple(denominator), rel=1e-12)


@pytest.mark.parametrize("rate", [52.0, 833.0])
def test_bandwidth_delays_a_ramp_by_its_time_constant(rate):
    """A one-pole low-pass follows a ramp with the lag 1/(2π f): also tests that samples fall between plant steps."""
    lag = 1 / (2 * np.pi * rate / 2)
    device = Accelerometer(SILENT.select(rate=rate), Streams(3), unit="ideal")
    readings = _fly(device, lambda t: (100 * t, -50 * t, 0.0), 1.0)
    late = readings[readings[:, 0] > 0.5]
    assert late[:, 1] == pytest.approx(100 * (late[:, 0] - lag), abs=1e-5)
    assert late[:, 2] == pytest.approx(-50 * (late[:, 0] - lag), abs=1e-5)


def test_bandwidth_passes_half_the_power_at_its_frequency():
    """52 Hz through one pole at 52 Hz: 1/√2 of the amplitude, 45° late (steps of 10 µs, linear between: 1e-6)."""
    dt = 1e-5
    a, b0, b1 = one_pole(52.0, dt)
    angle = 2 * np.pi * 52.0 * dt * np.arange(20_000)
    output, y = [0.0], 0.0
    for before, now in pairwise(np.sin(angle).tolist()):
        y = a * y + b0 * before + b1 * now
        output.append(y)
    assert output[10_000:] == pytest.approx(np.sin(angle - np.pi / 4)[10_000:] / np.sqrt(2), abs=1e-5)


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
        device = Accelerometer(SILENT.select(rate=rate), Streams(10), unit="ideal", vibration=vibration)
        rms.append(_fly(device, lambda t: (0.0, 0.0, 0.0), 20.0)[:, 1:].std())
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


def test_truth_that_is_not_a_number_is_read_as_such():
    """A diverged plant must not end in a stack trace inside a sensor."""
    device = Accelerometer(LSM, Streams(13))
    readings = _fly(device, lambda t: (np.nan, np.inf if t > 0.05 else 0.0, 0.0), 0.1)
    assert np.isnan(readings[:, 1]).all()
    assert np.isfinite(readings[:, 3]).all()
