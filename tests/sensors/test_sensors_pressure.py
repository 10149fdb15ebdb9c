"""One pressure sensor, each error alone; its digital filter; its noise against the printed tables."""

from dataclasses import replace

import numpy as np
import pytest

from sensors import PressureSensor, Streams, noise, preset
from sensors.filters import DigitalFilter


def _silent(name="bmp390", **choice):
    """A part without noise and drift, in steps of 1e-9: what is left is the error under test."""
    part = preset(name).select(**choice)
    quiet = replace(part.mode, noise_sd=0.0, temperature_noise_sd=0.0, resolution=1e-9)
    return replace(part, mode=quiet, drift_sd=0.0, random_walk=0.0, temperature_resolution=1e-9)


def _record(device, count, truth=lambda t: 100_000.0, temperature=298.15):
    """Conversions of a true pressure p(t): columns pressure, temperature, end of conversion."""
    rows = []
    for _ in range(count):
        rows.append(device.read(device.end, lambda t: (truth(t), temperature)))
    return np.array(rows)


def test_a_part_without_errors_reads_the_truth():
    rows = _record(PressureSensor(_silent(), Streams(1), unit="ideal"), 5, truth=lambda t: 101_325.0)
    assert rows[:, 0] == pytest.approx(101_325.0, abs=1e-6)
    assert rows[:, 1] == pytest.approx(298.15, abs=1e-6)


@pytest.mark.parametrize("mode", ["x1/x1", "x8/x1", "x32/x2"])
def test_a_conversion_carries_the_truth_of_its_middle(mode):
    """A ramp of 2450 Pa/s, a catapult's, is read half a conversion late, at k/rate beyond the phase."""
    part = _silent(mode=mode)
    device = PressureSensor(part, Streams(2), unit="ideal")
    start = device.end - part.mode.conversion_time
    assert 0 <= start < 1 / part.rate
    rows = _record(device, 50, truth=lambda t: 100_000 + 2450 * t)
    ends = start + np.arange(50) / part.rate + part.mode.conversion_time
    assert rows[:, 2] == pytest.approx(ends, abs=1e-12)
    assert rows[:, 0] == pytest.approx(100_000 + 2450 * (ends - part.mode.conversion_time / 2), abs=1e-6)


def test_a_value_is_there_from_the_end_of_its_conversion_on():
    device = PressureSensor(_silent(), Streams(3), unit="ideal")
    end = device.end

    def truth(t):
        return (90_000.0 if t < end else 91_000.0), 300.0

    assert np.isnan(device.read(end - 1e-6, truth)).all()
    assert device.read(end, truth) == pytest.approx((90_000.0, 300.0, end))
    assert device.read(device.end - 1e-6, truth) == pytest.approx((90_000.0, 300.0, end))
    assert device.read(device.end, truth)[0] == pytest.approx(91_000.0)


def test_conversions_that_nobody_reads_change_nothing_of_those_that_somebody_does():
    """Read every third one, with drift and noise: the same values as when each is read; with the filter on too."""
    for iir in (0, 4):
        every = _record(PressureSensor(preset("bmp390").select(iir=iir), Streams(11)), 90)
        rarely = PressureSensor(preset("bmp390").select(iir=iir), Streams(11))
        third = [rarely.read(t, lambda _: (100_000.0, 298.15)) for t in every[2::3, 2]]
        assert np.array_equal(np.array(third), every[2::3])


def test_oscillators_are_off_and_the_conversion_with_them():
    """BMP390: typ ±2 %. 400 units at 4 sigma of the estimate: 14 %. The window keeps its share of the period."""
    units = [PressureSensor(preset("bmp390"), Streams(seed)) for seed in range(400)]
    errors = np.array([unit.rate_error for unit in units])
    assert errors.std() / 0.02 == pytest.approx(1, abs=4 / np.sqrt(800))
    assert np.abs(errors).max() <= 0.12
    unit = units[0]
    ends = _record(unit, 500)[:, 2]
    assert np.diff(ends) == pytest.approx(1 / (200 * (1 + unit.rate_error)), rel=1e-9)
    middles = []
    unit.read(unit.end, lambda t: (middles.append(t) or 100_000.0, 298.15))
    window = 2 * (unit.end - 1 / (200 * (1 + unit.rate_error)) - middles[0])
    assert window == pytest.approx(4.82e-3 / (1 + unit.rate_error), rel=1e-6)


def test_offset_and_scale_alone():
    """The scale error turns about the pressure at which the absolute accuracy is stated."""
    part = replace(_silent(), solder=(0.0, 0.0), offset_tc_sd=0.0)
    unit = PressureSensor(part, Streams(4), offset_pa=100.0)
    assert unit.offset - PressureSensor(part, Streams(4)).offset == pytest.approx(100.0)
    assert unit.scale_error != 0
    for truth in (90_000.0, 100_000.0):
        expected = truth + unit.offset + unit.scale_error * (truth - part.reference_pressure)
        assert _record(unit, 1, truth=lambda t, p=truth: p)[0, 0] == pytest.approx(expected, abs=1e-6)
    assert _record(unit, 1)[0, 1] == pytest.approx(298.15 + unit.temperature_offset, abs=1e-6)


@pytest.mark.parametrize(("name", "sd", "limit"), [("bmp390", 50.0, 150.0), ("bmp581", 10.0, 30.0)])
def test_offsets_are_drawn_within_the_datasheet(name, sd, limit):
    """400 units at 4 sigma of the estimate: 14 %; cutting at 3 sigma takes 1.3 % off."""
    offsets = np.array([PressureSensor(preset(name), Streams(seed)).offset for seed in range(400)])
    assert offsets.std() / sd == pytest.approx(1, abs=4 / np.sqrt(800))
    assert np.abs(offsets).max() <= limit


def test_ideal_and_typical_units():
    ideal = PressureSensor(preset("bmp390"), Streams(1), unit="ideal")
    assert (ideal.offset, ideal.scale_error, ideal.rate_error, ideal.temperature_offset) == (0.0, 0.0, 0.0, 0.0)
    typical = PressureSensor(preset("bmp390"), Streams(1), unit="typical")
    assert (typical.offset, typical.rate_error) == (50.0, 0.02)


def test_drift_alone_is_its_process():
    part = replace(_silent(), drift_sd=2.0, correlation_time=1.0, random_walk=0.5)
    rows = _record(PressureSensor(part, Streams(5), unit="ideal"), 3000)
    drift = noise.gauss_markov(Streams(5)("pressure.drift"), 2.0, 1.0, 1 / 200)
    walk = noise.random_walk(Streams(5)("pressure.walk"), 0.5, 1 / 200)
    expected = np.concatenate([next(drift) + next(walk) for _ in range(3)])[:3000, 0]
    assert rows[:, 0] == pytest.approx(100_000 + expected, abs=1e-6)


def test_saturation_and_truth_that_is_not_a_number():
    device = PressureSensor(_silent(), Streams(6), unit="ideal")
    assert _record(device, 1, truth=lambda t: 1e6)[0, 0] == pytest.approx(125_000.0)
    assert _record(device, 1, truth=lambda t: 0.0)[0, 0] == pytest.approx(30_000.0)
    assert np.isnan(_record(device, 1, truth=lambda t: np.nan)[0, 0])
    assert _record(device, 1)[0, 0] == pytest.approx(100_000.0)


@pytest.mark.parametrize(("name", "mode", "step"), [("bmp390", "x1/x1", 2.64), ("bmp581", "x1/x1", 1 / 64)])
def test_quantisation(name, mode, step):
    rows = _record(PressureSensor(preset(name).select(mode=mode), Streams(7)), 200)
    counts = rows[:, 0] / step
    assert counts == pytest.approx(np.round(counts), abs=1e-6)


@pytest.mark.parametrize(("coefficient", "samples"), [(1, 1), (2, 2), (4, 5), (8, 11), (16, 22)])
def test_filter_reaches_three_quarters_of_a_step(coefficient, samples):
    """Authority: BMP280 datasheet table 6: 1, 2, 5, 11, 22 samples for off, 2, 4, 8, 16."""
    stage = DigitalFilter(1 / coefficient)
    assert stage.step(0.0) == 0.0
    outputs = [stage.step(1.0) for _ in range(samples)]
    assert outputs[-1] >= 0.75
    assert all(output < 0.75 for output in outputs[:-1])


def test_filter_begins_with_its_first_value():
    """A sensor at 100 kPa does not start at nothing."""
    rows = _record(PressureSensor(_silent(iir=128), Streams(8), unit="ideal"), 3)
    assert rows[:, 0] == pytest.approx(100_000.0, abs=1e-6)
    assert rows[:, 1] == pytest.approx(298.15, abs=1e-6)


@pytest.mark.parametrize("name", ["bmp390", "bmp581"])
def test_noise_a_conversion_is_the_datasheets_in_each_mode(name):
    """n = 20 000 conversions, drift off: 2 % in sigma is caught at 4 sigma, with the quantisation counted in."""
    for mode in preset(name).modes:
        part = replace(preset(name).select(mode=mode.name), drift_sd=0.0, random_walk=0.0)
        rows = _record(PressureSensor(part, Streams(9), unit="ideal"), 20_000)
        assert rows[:, 0].std() / mode.noise_sd == pytest.approx(1, abs=4 / np.sqrt(40_000))
        assert rows[:, 1].std() / mode.temperature_noise_sd == pytest.approx(1, abs=4 / np.sqrt(40_000))


@pytest.mark.parametrize("coefficient", [2, 8])
def test_noise_behind_the_filter_is_what_the_description_says(coefficient):
    """n = 40 000, which a filter of weight a = 1/c leaves with n a/(2 - a) independent ones: at 4 sigma 3 to 6 %."""
    part = replace(preset("bmp390").select(iir=coefficient), drift_sd=0.0, random_walk=0.0)
    rows = _record(PressureSensor(part, Streams(10), unit="ideal"), 40_000)[1000:]
    independent = len(rows) / (2 * coefficient - 1)
    assert rows[:, 0].std() / part.noise_sd == pytest.approx(1, abs=4 / np.sqrt(2 * independent))


# BMP390 DS002 r1.7 table 8, Pa rms: columns are off, 2, 4, …, 128; "<.1" is typed 0.05
PRINTED = {
    "x1/x1": [3.7, 2.0, 1.2, 0.8, 0.4, 0.2, 0.1, 0.1],
    "x2/x1": [2.7, 1.5, 0.9, 0.5, 0.3, 0.2, 0.1, 0.1],
    "x4/x1": [2.0, 1.1, 0.7, 0.4, 0.3, 0.2, 0.1, 0.04],
    "x8/x1": [1.6, 0.9, 0.6, 0.3, 0.2, 0.1, 0.1, 0.03],
    "x16/x2": [1.2, 0.6, 0.4, 0.2, 0.1, 0.1, 0.04, 0.03],
    "x32/x2": [0.9, 0.5, 0.3, 0.2, 0.1, 0.1, 0.05, 0.05],
}


@pytest.mark.parametrize("mode", PRINTED)
def test_filtered_noise_is_the_printed_table(mode):
    """The datasheet's way: mean standard deviation of 32 consecutive samples. The filter is ours, the table is theirs.

    300 groups; within one unit of the last printed digit, 0.1 Pa, or 5 %: a filter weight of 1/(c + 1) in place of
    1/c would be 0.5 Pa off in the second column.
    """
    for coefficient, printed in zip((0, 2, 4, 8, 16, 32, 64, 128), PRINTED[mode], strict=True):
        part = replace(preset("bmp390").select(mode=mode, iir=coefficient), drift_sd=0.0, random_walk=0.0)
        values = _record(PressureSensor(part, Streams(11), unit="ideal"), 32 * 320)[32 * 20 :, 0]
        ours = values.reshape(-1, 32).std(axis=1, ddof=1).mean()
        assert ours == pytest.approx(printed, abs=0.1, rel=0.05)
