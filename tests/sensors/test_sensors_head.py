"""The air-data head: what its bus reads, when, and under the cover."""

from dataclasses import replace

import numpy as np
import pytest

from sensors import AirDataHead, AirDataSettings, PressureSettings, Streams
from sensors.settings import ThermalSettings

DT = 1e-3
QUIET = AirDataSettings(
    thermal=ThermalSettings(lag=1e-9),  # a die as warm as the air
    total=PressureSettings(preset="bmp581", mode="x1/x1", noise_scale=0.0),
    static=PressureSettings(preset="bmp581", mode="x1/x1", noise_scale=0.0),
)
STEP = 1 / 64  # Pa, of a BMP581


def _fly(head, air, duration, dt=DT):
    """Rows polled while the truth is air(t)."""
    rows = []
    for k in range(1, round(duration / dt) + 1):
        t1 = k * dt
        if head.due <= t1:
            rows += head.step(t1, air)
    return np.array(rows)


def _calm(_t):
    return (101_325.0, 101_325.0, 288.15)


def test_polls_come_at_their_own_rate_and_phase():
    rows = _fly(AirDataHead(AirDataSettings(rate=100.0), Streams(1)), _calm, 2.0)
    phase = rows[0, 0]
    assert 0 <= phase < 0.01
    assert rows[:, 0].tolist() == [phase + k / 100.0 for k in range(200)]


def test_a_row_carries_finished_conversions_and_tells_their_ends():
    """Never from the future, never older than a period; not a number until there is one."""
    settings = AirDataSettings(rate=1000.0)
    head = AirDataHead(settings, Streams(2))
    rows = _fly(head, _calm, 1.0)
    for value, end, device in ((1, 4, head.total), (2, 5, head.static)):
        missing = np.isnan(rows[:, end])
        assert missing.any()
        assert np.array_equal(missing, np.isnan(rows[:, value]))
        first = np.argmin(missing)
        assert not missing[first:].any()
        age = rows[first:, 0] - rows[first:, end]
        assert age.min() >= 0
        assert age.max() <= 1 / (200 * (1 + device.rate_error)) + 1e-12


def test_a_value_polled_again_is_the_same_with_the_same_end():
    """A BMP390 at 200 Hz polled at 1 kHz: each value five times or so."""
    rows = _fly(AirDataHead(AirDataSettings(rate=1000.0), Streams(3)), _calm, 1.0)[20:]
    new = np.diff(rows[:, 4]) > 0
    assert new.sum() == pytest.approx(0.98 * 200, abs=15)
    assert np.array_equal(rows[1:][~new, 1], rows[:-1][~new, 1])


def test_the_pair_is_not_simultaneous_and_each_clock_drifts_its_own_way():
    rows = _fly(AirDataHead(AirDataSettings(), Streams(4)), _calm, 3.0)[5:]
    apart = rows[:, 4] - rows[:, 5]
    assert np.ptp(apart) > 1e-3


def test_values_are_the_truth_of_the_middle_of_the_conversion():
    """A ramp in total, static and temperature, noise off, an ideal unit: to a step of the reading."""

    def ramp(t):
        return (101_325 + 1000 * t, 101_325 - 200 * t, 288.15 + 2 * t)

    head = AirDataHead(QUIET, Streams(5), unit="ideal")
    rows = _fly(head, ramp, 0.5)[5:]
    half = 0.5e-3
    drift = 0.3  # Pa: half a second of random walk and Gauss-Markov drift is 0.05 Pa at 1 sigma
    assert rows[:, 1] == pytest.approx(101_325 + 1000 * (rows[:, 4] - half), abs=STEP + drift)
    assert rows[:, 2] == pytest.approx(101_325 - 200 * (rows[:, 5] - half), abs=STEP + drift)
    assert rows[:, 3] == pytest.approx(288.15 + 2 * (rows[:, 5] - half), abs=1e-4)


def test_rows_do_not_depend_on_the_plants_step():
    """Linear truth: a step of 4 ms, with several events in it, gives what one of 0.5 ms gives."""

    def ramp(t):
        return (101_325 + 500 * t, 101_325 - 100 * t, 288.15 + t)

    fine = _fly(AirDataHead(AirDataSettings(), Streams(6)), ramp, 1.0, dt=5e-4)
    coarse = _fly(AirDataHead(AirDataSettings(), Streams(6)), ramp, 1.0, dt=4e-3)
    assert coarse == pytest.approx(fine, abs=1e-9, nan_ok=True)


def test_the_cover_hides_the_wind_until_it_is_off():
    """Both ports feel the static pressure: 250 Pa of wind appear with the first conversion after the cover."""
    head = AirDataHead(QUIET, Streams(7), covered_until=0.5, unit="ideal")
    rows = _fly(head, lambda t: (101_575.0, 101_325.0, 288.15), 1.0)[5:]
    middle = rows[:, 4] - 0.5e-3
    covered = middle < 0.5
    assert 40 < covered.sum() < 60
    assert rows[covered, 1] == pytest.approx(101_325.0, abs=0.5)
    assert rows[~covered, 1] == pytest.approx(101_575.0, abs=0.5)
    assert rows[:, 2] == pytest.approx(101_325.0, abs=0.5)


def test_no_cover_by_default():
    rows = _fly(AirDataHead(QUIET, Streams(7), unit="ideal"), lambda t: (101_575.0, 101_325.0, 288.15), 0.2)[5:]
    assert rows[:, 1] == pytest.approx(101_575.0, abs=0.5)


def test_temperature_is_the_static_sensors():
    head = AirDataHead(AirDataSettings(), Streams(8))
    rows = _fly(head, _calm, 1.0)[5:]
    assert rows[:, 3].mean() == pytest.approx(288.15 + head.static.temperature_offset, abs=0.01)
    assert head.static.temperature_offset != head.total.temperature_offset


def test_each_sensor_is_as_its_own_settings_say():
    settings = AirDataSettings(
        total=PressureSettings(preset="bmp581", mode="x4/x1", offset_pa=40.0),
        static=PressureSettings(preset="bmp390", mode="x8/x1", iir=4),
    )
    head = AirDataHead(settings, Streams(9), unit="ideal")
    assert head.total.description.mode.name == "x4/x1"
    assert head.total.offset == 40.0
    assert (head.static.description.name, head.static.description.iir) == ("bmp390", 4)


def test_two_sensors_of_a_kind_are_two_units_with_independent_noise():
    """n = 2000 pairs; correlation below 4/√n by chance but for 6 in 100 000."""
    head = AirDataHead(replace(AirDataSettings(), rate=100.0), Streams(10))
    rows = _fly(head, _calm, 20.0)[5:]
    assert head.total.offset != head.static.offset
    assert abs(np.corrcoef(rows[:, 1], rows[:, 2])[0, 1]) < 4 / np.sqrt(len(rows))
