"""One pressure sensor, each error alone; its digital filter; its noise against the printed tables."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors import (
    AirDataHead,
    AirDataSettings,
    PressureDescription,
    PressureErrors,
    PressureSensor,
    Streams,
    noise,
    preset,
    presets,
)
from sensors.filters import DigitalFilter
from sensors.settings import Fault, ThermalSettings

PARTS = [name for name in presets() if type(preset(name)) is PressureDescription]


def _silent(name="bmp390", **choice):
    """A part without noise and drift, in steps of 1e-9: what is left is the error under test."""
    part = preset(name).select(**choice)
    quiet = replace(part.mode, noise_sd=0.0, temperature_noise_sd=0.0, resolution=1e-9)
    return replace(part, mode=quiet, drift_sd=0.0, random_walk=0.0, temperature_resolution=1e-9)


def _noise(name, blocks=20, temperature=298.15, **choice):
    """Pressures and temperatures at rest of an ideal unit without drift, the filter settled: 1024 a block."""
    part = replace(preset(name).select(**choice), drift_sd=0.0, random_walk=0.0)
    records = islice(PressureSensor(part, Streams(9), unit="ideal").at_rest(100_000.0, temperature), 1, blocks + 1)
    return [np.concatenate(column) for column in list(zip(*records, strict=True))[1:]]


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


@pytest.mark.parametrize("fault", [Fault("spike", probability=0.5, size=9.0), Fault("stuck", start=0.1, stop=0.3)])
def test_faults_are_the_same_whoever_reads(fault):
    """A spike is drawn for each conversion and what a stuck value holds is the last one, seen or not."""
    every = _record(PressureSensor(preset("bmp390"), Streams(11), faults=(fault,)), 90)
    rarely = PressureSensor(preset("bmp390"), Streams(11), faults=(fault,))
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


@pytest.mark.parametrize("name", PARTS)
def test_noise_a_conversion_is_the_datasheets_in_each_mode(name):
    """n = 20 480 conversions, drift off: 2 % in sigma is caught at 4 sigma, with the quantisation counted in.

    Where a step is coarser than the noise, rounding shows its variance only on the mean over where truth is in a step.
    """
    step = preset(name).temperature_resolution
    for mode in preset(name).modes:
        p, _ = _noise(name, mode=mode.name)
        assert p.std() / mode.noise_sd == pytest.approx(1, abs=4 / np.sqrt(2 * p.size))
        if mode.temperature_noise_sd**2 > step**2 / 12.0:
            truths = 298.15 + step * (np.arange(8) + 0.5) / 8
            errors = [_noise(name, 3, temperature=truth, mode=mode.name)[1] - truth for truth in truths]
            rms = np.sqrt(np.mean(np.square(errors)))
            assert rms / mode.temperature_noise_sd == pytest.approx(1, abs=4 / np.sqrt(2 * 3 * 8 * 1024))


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


# BMP388 DS001 r1.6 table 7: off, 1, 3, …, 127; "<.1" is typed 0.1. BMP280 DS001 r1.26 table 8: off, 2, …, 16. Pa rms.
PRINTED_388 = {
    "x1/x1": [6.6, 3.8, 2.5, 1.7, 1.2, 0.8, 0.6, 0.4],
    "x2/x1": [4.3, 2.5, 1.6, 1.1, 0.8, 0.5, 0.4, 0.3],
    "x4/x1": [3.2, 1.8, 1.2, 0.8, 0.6, 0.4, 0.3, 0.2],
    "x8/x1": [2.3, 1.3, 0.9, 0.6, 0.4, 0.3, 0.2, 0.1],
    "x16/x2": [1.6, 0.9, 0.6, 0.4, 0.2, 0.2, 0.1, 0.1],
    "x32/x2": [1.2, 0.7, 0.4, 0.3, 0.3, 0.1, 0.1, 0.1],
}
PRINTED_280 = {
    "x1/x1": [3.3, 1.9, 1.2, 0.9, 0.4],
    "x2/x1": [2.6, 1.5, 1.0, 0.6, 0.4],
    "x4/x1": [2.1, 1.2, 0.8, 0.5, 0.3],
    "x8/x1": [1.6, 1.0, 0.6, 0.4, 0.2],
    "x16/x2": [1.3, 0.8, 0.5, 0.4, 0.2],
}


@pytest.mark.parametrize("mode", PRINTED_388)
def test_filtered_noise_is_the_bmp388s_table(mode):
    """This one's table holds the standard deviation of a long record, to a unit of the last digit or 5 %."""
    for coefficient, printed in zip((0, 1, 3, 7, 15, 31, 63, 127), PRINTED_388[mode], strict=True):
        assert _noise("bmp388", mode=mode, iir=coefficient)[0].std() == pytest.approx(printed, abs=0.1, rel=0.05)


@pytest.mark.parametrize("mode", PRINTED_280)
def test_filtered_noise_is_the_bmp280s_table(mode):
    """Between what 32 samples in a row show, the sheet's way, and a long record does, to a unit of the last digit."""
    for coefficient, printed in zip((0, 2, 4, 8, 16), PRINTED_280[mode], strict=True):
        values = _noise("bmp280", mode=mode, iir=coefficient)[0]
        assert values.reshape(-1, 32).std(axis=1, ddof=1).mean() - 0.1 < printed < values.std() + 0.1


# -- what a unit draws -------------------------------------------------------------------------------------------------


def test_solder_shift_lies_about_the_middle_of_its_bounds():
    """-50 … 200 Pa (a BMP280's): mean 75, sd 250/6 = 41.7 Pa. 400 units at 4 sigma of the estimates: 8.3 Pa, 14 %."""
    part = replace(preset("bmp390"), solder=(-50.0, 200.0))
    shifts = np.array([PressureSensor(part, Streams(seed)).solder for seed in range(400)])
    assert shifts.mean() == pytest.approx(75.0, abs=4 * 41.7 / 20)
    assert shifts.std() / (250 / 6) == pytest.approx(1, abs=4 / np.sqrt(800))
    assert shifts.min() >= -50.0
    assert shifts.max() <= 200.0
    assert PressureSensor(part, Streams(1), unit="ideal").solder == 0.0
    assert PressureSensor(part, Streams(1), unit="typical").solder == pytest.approx(75.0 + 250 / 6)


def test_solder_shift_is_read():
    part = replace(_silent(), solder=(30.0, 30.0), offset_sd=0.0, offset_tc_sd=0.0, scale_sd=0.0)
    assert _record(PressureSensor(part, Streams(1)), 1)[0, 0] == pytest.approx(100_030.0, abs=1e-6)


@pytest.mark.parametrize(("temperature", "kelvin"), [(298.15, 0.0), (308.15, 10.0), (268.15, -30.0)])
def test_temperature_coefficient_acts_from_25_degrees(temperature, kelvin):
    part = replace(_silent(), offset_sd=0.0, solder=(0.0, 0.0), scale_sd=0.0)
    unit = PressureSensor(part, Streams(3))
    assert unit.offset_tc != 0
    reading = _record(unit, 1, temperature=temperature)[0, 0]
    assert reading == pytest.approx(100_000.0 + unit.offset_tc * kelvin, abs=1e-6)
    tc = [PressureSensor(part, Streams(seed)).offset_tc for seed in range(400)]
    assert np.std(tc) / 0.62 == pytest.approx(1, abs=4 / np.sqrt(800))


def test_membrane_feels_along_its_normal_only():
    """400 units at 4 sigma: 14 % of the 0.2 Pa/(m/s²) that the part's sheet says."""
    part = preset("bmp390")
    units = [PressureSensor(part, Streams(seed), normal=(3.0, 0.0, -4.0)).acceleration for seed in range(400)]
    along = np.array(units) @ (0.6, 0.0, -0.8)
    assert along.std() / 0.2 == pytest.approx(1, abs=4 / np.sqrt(800))
    assert np.array(units) == pytest.approx(np.outer(along, (0.6, 0.0, -0.8)), abs=1e-12)
    assert {float(np.sign(value)) for value in along} == {-1.0, 1.0}
    assert PressureSensor(part, Streams(1), unit="ideal").acceleration == (0.0, 0.0, 0.0)
    assert PressureSensor(part, Streams(1), unit="typical").acceleration == (0.0, 0.0, 0.2)
    assert (
        PressureSensor(part, Streams(7)).acceleration == PressureSensor(part, Streams(7), normal=(0, 0, 1)).acceleration
    )
    with pytest.raises(ValueError, match="normal of a membrane"):
        PressureSensor(part, Streams(1), normal=(0.0, 0.0, 0.0))


def test_rate_error_beside_the_units():
    part = _silent()
    unit = PressureSensor(part, Streams(1), unit="ideal", rate_error_percent=-10.0)
    ends = _record(unit, 100)[:, 2]
    assert np.diff(ends) == pytest.approx(1 / 180, rel=1e-9)
    assert 2 * unit.half_window == pytest.approx(4.82e-3 / 0.9)


def test_a_new_term_changes_no_other_draw():
    """The reading of a unit without solder, coefficient and drift differs by them alone."""
    part = preset("bmp390")
    without = replace(part, solder=(0.0, 0.0), offset_tc_sd=0.0, acceleration_sd=0.0)
    one, other = (PressureSensor(p, Streams(5)) for p in (part, without))
    for name in ("offset", "scale_error", "rate_error", "temperature_offset", "end"):
        assert getattr(one, name) == getattr(other, name)
    same = replace(part.scaled(1.0), mode=replace(part.mode, resolution=1e-9))
    bare = replace(without, mode=same.mode)
    difference = _record(PressureSensor(same, Streams(5)), 300) - _record(PressureSensor(bare, Streams(5)), 300)
    assert difference[:, 0] == pytest.approx(one.solder, abs=1e-6)
    assert (difference[:, 1:] == 0).all()


def test_drift_model_is_chosen_by_the_errors():
    part = replace(_silent(), drift_sd=2.0, errors=PressureErrors(drift_model="flicker"))
    rows = _record(PressureSensor(part, Streams(5), unit="ideal"), 1000)
    expected = next(noise.drift(Streams(5)("pressure.drift"), "flicker", 2.0, part.correlation_time, 1 / 200, axes=1))
    assert rows[:, 0] == pytest.approx(100_000 + expected[:1000, 0], abs=1e-6)


def test_saturation_and_quantisation_can_be_off():
    part = preset("bmp390").scaled(1.0, PressureErrors(saturation=False, quantisation=False))
    quiet = replace(part.mode, noise_sd=0.0, temperature_noise_sd=0.0)
    part = replace(part, mode=quiet, drift_sd=0.0, random_walk=0.0)
    rows = _record(PressureSensor(part, Streams(6), unit="ideal"), 1, truth=lambda t: 200_000.123, temperature=250.0017)
    assert rows[0, :2] == pytest.approx([200_000.123, 250.0017], abs=1e-8)


def test_filter_recovers_from_what_was_no_number():
    """A filter of weight 1/16 begins again: the reading after is the truth, not a trace of it."""
    device = PressureSensor(_silent(iir=16), Streams(6), unit="ideal")
    _record(device, 3)
    assert np.isnan(_record(device, 2, truth=lambda t: np.nan)[:, 0]).all()
    assert _record(device, 1, truth=lambda t: 90_000.0)[0, 0] == pytest.approx(90_000.0, abs=1e-6)


def test_air_temperature_that_is_no_number_comes_and_goes():
    device = PressureSensor(_silent(iir=4), Streams(6), thermal=ThermalSettings(self_heating=2.0))
    assert np.isfinite(_record(device, 2)).all()
    assert np.isnan(_record(device, 2, temperature=np.nan)[:, :2]).all()
    assert np.isfinite(_record(device, 2)).all()


# -- the die -----------------------------------------------------------------------------------------------------------


def test_thermometer_reads_the_die():
    """Long powered: air + 4 K. Just switched on: air + 4 K (1 - e^{-t/τ})."""
    warm = ThermalSettings(self_heating=4.0, lag=2.0, powered_for=1e6)
    assert _record(PressureSensor(_silent(), Streams(1), unit="ideal", thermal=warm), 5)[:, 1] == pytest.approx(302.15)
    cold = replace(warm, powered_for=0.0)
    rows = _record(PressureSensor(_silent(), Streams(1), unit="ideal", thermal=cold), 2000)
    since = rows[:, 2] - rows[0, 2]
    assert rows[:, 1] == pytest.approx(298.15 + 4.0 * -np.expm1(-since / 2.0), abs=1e-6)


def test_self_heating_moves_the_pressure_by_the_temperature_coefficient():
    part = replace(_silent(), offset_sd=0.0, solder=(0.0, 0.0), scale_sd=0.0)
    unit = PressureSensor(part, Streams(3), thermal=ThermalSettings(self_heating=4.0))
    assert _record(unit, 1)[0, 0] == pytest.approx(100_000.0 + 4.0 * unit.offset_tc, abs=1e-4)


# -- faults ------------------------------------------------------------------------------------------------------------


def _broken(*faults, **choice):
    """Readings of 1 s of a ramp of 1000 Pa/s, with and without the faults: columns p, T, end."""
    return [
        _record(PressureSensor(_silent(**choice), Streams(1), unit="ideal", faults=f), 200, lambda t: 1e5 + 1e3 * t)
        for f in (faults, ())
    ]


def test_dropout_delivers_nothing():
    """The last reading stays, with its own end; what comes after is as if nothing had been."""
    rows, clean = _broken(Fault("dropout", start=0.3, stop=0.5))
    hit = (clean[:, 2] >= 0.3) & (clean[:, 2] < 0.5)
    assert 38 <= hit.sum() <= 41
    last = clean[np.flatnonzero(hit)[0] - 1]
    assert (rows[hit] == last).all()
    assert np.array_equal(rows[~hit], clean[~hit])


@pytest.mark.parametrize(
    ("fault", "change"),
    [
        (Fault("invalid", start=0.3, stop=0.5), lambda clean, hit: np.full(hit.sum(), np.nan)),
        (Fault("stuck", start=0.3, stop=0.5), lambda clean, hit: clean[np.flatnonzero(hit)[0] - 1].repeat(hit.sum())),
        (Fault("offset", start=0.3, stop=0.5, size=25.0), lambda clean, hit: clean[hit] + 25.0),
    ],
)
@pytest.mark.parametrize("iir", [0, 4])
def test_faults_that_come_with_new_ends(fault, change, iir):
    """They act on what the bus carries, behind the filter: it knows nothing of them."""
    rows, clean = _broken(fault, iir=iir)
    hit = (clean[:, 2] >= 0.3) & (clean[:, 2] < 0.5)
    assert np.array_equal(rows[:, 1:], clean[:, 1:])
    assert np.array_equal(rows[~hit], clean[~hit])
    assert np.array_equal(rows[hit, 0], change(clean[:, 0], hit), equal_nan=True)


def test_spikes_hit_their_share():
    """Half of 200 readings, at 4 sigma: 28; both signs."""
    rows, clean = _broken(Fault("spike", probability=0.5, size=500.0))
    size = rows[:, 0] - clean[:, 0]
    assert (np.abs(size) > 1).sum() == pytest.approx(100, abs=4 * np.sqrt(50))
    assert sorted(np.unique(np.round(size))) == [-500.0, 0.0, 500.0]


# -- the bench's way ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("iir", [0, 8])
@pytest.mark.parametrize("thermal", [None, ThermalSettings(self_heating=3.0, powered_for=0.0)])
@pytest.mark.parametrize("faults", [(), (Fault("dropout", probability=0.3), Fault("spike", probability=0.1, size=9.0))])
@pytest.mark.parametrize("name", ["bmp390", "bmp581"])
def test_blocks_at_rest_are_what_read_gives(name, iir, thermal, faults):
    """Bit for bit; n = 2500 conversions, over two seams of blocks."""
    if iir and name == "bmp581":
        iir = 7
    part = preset(name).select(iir=iir)
    device = PressureSensor(part, Streams(4), thermal=thermal, faults=faults)
    ends, readings = [], []
    while len(ends) < 2500:
        conversion = device.read(device.end, lambda _: (101_325.0, 290.0))
        if not ends or conversion[2] != ends[-1]:
            ends.append(conversion[2])
            readings.append(conversion[:2])
    readings, ends = np.array(readings)[1:], np.array(ends)[1:]  # the first may be "none yet"
    blocks = list(islice(PressureSensor(part, Streams(4), thermal=thermal, faults=faults).at_rest(101_325.0, 290.0), 4))
    t, p, temperature = (np.concatenate(column) for column in zip(*blocks, strict=True))
    place = np.searchsorted(t, ends)
    assert np.array_equal(t[place], ends)
    assert (np.diff(place) == 1).all()
    assert np.array_equal(p[place], readings[:, 0])
    assert np.array_equal(temperature[place], readings[:, 1])


def test_at_rest_leaves_the_unit_alone():
    device, other = (PressureSensor(preset("bmp390").select(iir=4), Streams(4)) for _ in range(2))
    first = _record(device, 10)
    next(device.at_rest(1e5, 290.0))
    assert np.array_equal(np.vstack((first, _record(device, 10))), _record(other, 20))


# -- datasheets --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("coefficient", "cut"),
    [(1, 0.1147), (3, 0.0459), (7, 0.0212), (15, 0.01025), (31, 0.005041), (63, 0.00250), (127, 0.00125)],
)
def test_filter_has_the_bmp581s_bandwidths(coefficient, cut):
    """Authority: BMP581 datasheet, f(-3 dB)/ODR of its IIR, reproduced to 0.5 %; y += (x - y)/(c + 1)."""
    stage = DigitalFilter(1 / (coefficient + 1))
    stage.step(0.0)
    response = np.array([stage.step(1.0)] + [stage.step(0.0) for _ in range(40 * (coefficient + 1))])
    frequency = cut * np.linspace(0.98, 1.02, 401)
    gain = np.abs(np.exp(-2j * np.pi * np.outer(frequency, np.arange(response.size))) @ response)
    assert np.interp(-np.sqrt(0.5), -gain, frequency) == pytest.approx(cut, rel=0.005)


@pytest.mark.parametrize(
    ("mode", "p", "t"), [("x1/x1", 1, 1), ("x2/x1", 2, 1), ("x4/x1", 4, 1), ("x16/x2", 16, 2), ("x32/x2", 32, 2)]
)
def test_conversions_take_as_long_as_the_bmp390s(mode, p, t):
    """Authority: the driver's sum, 234 + (392 + 2020 osr_p) + (163 + 2020 osr_t) µs; the sheet's are cut to 10 µs.

    x8 is not its own: the sheet prints 18.69 ms where the sum gives 18.97.
    """
    device = PressureSensor(preset("bmp390").select(mode=mode), Streams(1), unit="ideal")
    assert 2e6 * device.half_window == pytest.approx(234 + 392 + 2020 * p + 163 + 2020 * t, abs=10)


@pytest.mark.parametrize("mode", [mode.name for mode in preset("bmp390").modes])
@pytest.mark.parametrize("coefficient", [2, 8])
def test_filter_correlates_what_it_passes(mode, coefficient):
    """Neighbours by 1 - a. n = 30 000, of which n a/(2 - a) are independent; at 4 sigma of (1 - ρ²)/√n_i.

    Modes in which the noise is below a few steps would show the rounding instead: it is off.
    """
    part = preset("bmp390").select(mode=mode, iir=coefficient).scaled(1.0, PressureErrors(quantisation=False))
    part = replace(part, drift_sd=0.0, random_walk=0.0)
    blocks = islice(PressureSensor(part, Streams(12), unit="ideal").at_rest(1e5, 298.15), 30)
    values = np.concatenate([p for _, p, _ in blocks])[500:]
    rho = np.corrcoef(values[1:], values[:-1])[0, 1]
    expected = 1 - 1 / coefficient
    independent = values.size / (2 * coefficient - 1)
    assert rho == pytest.approx(expected, abs=4 * (1 - expected**2) / np.sqrt(independent))


# -- anything ----------------------------------------------------------------------------------------------------------

FACTORS = st.floats(0, 1000)
ERRORS = st.builds(
    PressureErrors,
    offset=FACTORS,
    solder=FACTORS,
    scale=FACTORS,
    temperature=FACTORS,
    acceleration=FACTORS,
    thermometer=FACTORS,
    drift=FACTORS,
    random_walk=FACTORS,
    clock=FACTORS,
    drift_model=st.sampled_from(["gauss-markov", "flicker"]),
    saturation=st.booleans(),
    quantisation=st.booleans(),
)


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(PARTS),
    data=st.data(),
    noise_scale=FACTORS,
    errors=ERRORS,
    offset_pa=st.floats(-1e5, 1e5),
    unit=st.sampled_from(["random", "typical", "ideal"]),
    rate_error_percent=st.floats(-20, 20),
    thermal=st.builds(
        ThermalSettings,
        self_heating=st.floats(0, 60),
        lag=st.floats(0, 3600, exclude_min=True),
        powered_for=st.floats(0, 1e6),
    ),
    seed=st.integers(0, 2**31),
    truth=st.floats(0, 2e5),
)
def test_finite_in_finite_out(
    name, data, noise_scale, errors, offset_pa, unit, rate_error_percent, thermal, seed, truth
):
    part = preset(name)
    mode = data.draw(st.sampled_from([mode.name for mode in part.modes]))
    iir = data.draw(st.sampled_from([coefficient for coefficient, _ in part.iir_weights]))
    part = part.select(mode=mode, iir=iir).scaled(noise_scale, errors)
    device = PressureSensor(
        part, Streams(seed), offset_pa=offset_pa, unit=unit, rate_error_percent=rate_error_percent, thermal=thermal
    )
    rows = _record(device, 6, truth=lambda _: truth, temperature=270.0)
    assert np.isfinite(rows).all()
    assert (np.diff(rows[:, 2]) > 0).all()
    if errors.saturation:
        low, high = part.range
        assert (rows[:, 0] >= low - part.resolution).all()
        assert (rows[:, 0] <= high + part.resolution).all()


@pytest.mark.parametrize(("share", "low", "high"), [(0.0, -0.22, 0.22), (0.6, 0.46, 0.74), (1.0, 1.0, 1.0)])
def test_parts_of_one_batch_drift_alike_with_temperature(share, low, high):
    """Correlation of the pair's coefficients over 200 heads, ± 3 (1 - s²)/√200."""
    chosen = AirDataSettings(batch=share)
    heads = [AirDataHead(chosen, Streams(seed)) for seed in range(200)]
    total = np.array([head.total.offset_tc for head in heads])
    static = np.array([head.static.offset_tc for head in heads])
    part = chosen.total.description()
    assert low - 1e-9 <= np.corrcoef(total, static)[0, 1] <= high + 1e-9
    for tc in (total, static):
        assert np.abs(tc).max() <= part.offset_tc_limit
        assert tc.std() == pytest.approx(part.offset_tc_sd, rel=0.2)
    assert heads[3].total.offset == AirDataHead(AirDataSettings(), Streams(3)).total.offset  # other draws stay
