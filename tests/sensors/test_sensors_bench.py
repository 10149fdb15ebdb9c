"""What devices write on a bench, as anybody may read it."""

import numpy as np
import pandas as pd
import pytest

from sensors import Accelerometer, Streams, preset, presets, record_at_rest
from sensors.bench import UNSOLDERED, blocks, columns_of, gathered, on_bench
from sensors.pressure import PressureSensor

G0 = 9.80665


@pytest.mark.parametrize("name", presets())
def test_columns_times_and_repeatability(name):
    frame = record_at_rest(name, duration=5.0, seed=3)
    kind = ["t", "fx", "fy", "fz"] if hasattr(preset(name), "range_g") else ["t", "pressure", "temperature"]
    assert list(frame.columns) == kind
    assert frame["t"].is_monotonic_increasing
    assert frame["t"].iloc[0] >= 0
    assert frame["t"].iloc[-1] < 5.0
    assert len(frame) / 5.0 == pytest.approx(preset(name).rate, rel=0.15)
    pd.testing.assert_frame_equal(frame, record_at_rest(name, duration=5.0, seed=3), check_exact=True)
    assert not frame.equals(record_at_rest(name, duration=5.0, seed=4))


def test_a_longer_record_begins_as_a_shorter_one():
    short, long = (record_at_rest("lsm6dso32", duration=duration, seed=1) for duration in (2.0, 5.0))
    pd.testing.assert_frame_equal(short, long.iloc[: len(short)], check_exact=True)


@pytest.mark.parametrize("name", ["lsm6dso32", "adxl345"])
def test_at_rest_z_down_reads_minus_g(name):
    """Ideal unit, 60 s: white noise leaves 3e-4 m/s² in the mean, drift 1e-3."""
    mean = record_at_rest(name, duration=60.0, seed=5, unit="ideal")[["fx", "fy", "fz"]].mean()
    assert mean.to_numpy() == pytest.approx([0, 0, -G0], abs=0.01)


def test_a_random_unit_is_off_by_its_bias_scale_and_misalignment():
    unit = Accelerometer(preset("adxl345"), Streams(6))
    mean = record_at_rest("adxl345", duration=30.0, seed=6)[["fx", "fy", "fz"]].mean()
    felt = np.array([0, 0, -G0])
    bent = felt + np.array(unit.rectification) * felt**2 + np.array(unit.nonlinearity) * felt**3
    expected = (bent + np.array(unit.cross_axis) @ bent) * (1 + np.array(unit.scale_error)) + unit.bias
    assert mean.to_numpy() == pytest.approx(expected, abs=0.01)
    assert np.abs(np.array(unit.bias)).max() > 0.05


def test_pressure_at_rest():
    frame = record_at_rest("bmp581", duration=30.0, seed=7, unit="ideal")
    assert frame["pressure"].mean() == pytest.approx(101_325.0, abs=1.0)
    assert frame["temperature"].mean() == pytest.approx(298.15, abs=0.01)


def test_the_bench_is_the_code_of_the_loop():
    """A device that feels the same rest step by step gives the same bits."""
    device = Accelerometer(preset("lsm6dso32"), Streams(8))
    rows = []
    for k in range(1001):
        rows += device.step((k * 1e-3, (0.0, 0.0, -G0)))
    frame = record_at_rest("lsm6dso32", duration=2.0, seed=8).iloc[: len(rows)]
    assert np.abs(frame.to_numpy() - np.array(rows)).max() == 0.0


def test_the_bench_is_the_code_of_the_head():
    """A pressure sensor that is read conversion by conversion gives the same bits, filter on."""
    part = on_bench("bmp390", mode="x2/x1", iir=4)
    device, rows = PressureSensor(part, Streams(9)), []
    while device.end < 20.0:
        pressure, temperature, t = device.read(device.end, lambda *_: (101_325.0, 298.15))
        rows.append((t, pressure, temperature))
    frame = record_at_rest("bmp390", duration=20.0, seed=9, mode="x2/x1", iir=4)
    assert np.array_equal(frame.to_numpy(), np.array(rows))


def test_a_part_on_the_bench_has_its_largest_range_and_is_not_soldered():
    part = on_bench("adxl345")
    assert part.range_g == 16
    assert on_bench("adxl345", range_g=4).range_g == 4
    baro = on_bench("bmp390", noise_scale=2.0)
    assert baro.errors == UNSOLDERED
    assert (baro.solder, baro.acceleration_sd) == ((0.0, 0.0), 0.0)
    assert baro.noise_sd == pytest.approx(2.0 * preset("bmp390").noise_sd)


def test_settings_of_a_record():
    slow = record_at_rest("lsm6dso32", duration=10.0, seed=1, rate=104, range_g=4, noise_scale=2.0, unit="ideal")
    assert len(slow) == pytest.approx(1040, abs=1)
    assert slow["fx"].std() == pytest.approx(2.0 * 120e-6 * G0 * 52**0.5, rel=0.15)


@pytest.mark.parametrize("name", ["icm-42688-p", "dps368"])
def test_blocks_are_the_record_and_need_no_memory(name):
    part = on_bench(name)
    pieces = list(blocks(part, duration=30.0, seed=4))
    frame = record_at_rest(name, duration=30.0, seed=4)
    assert tuple(frame.columns) == columns_of(part)
    assert np.array_equal(np.concatenate(pieces), frame.to_numpy())
    assert max(map(len, pieces)) <= 4096
    larger = list(gathered(iter(pieces), rows=10_000))
    assert np.array_equal(np.concatenate(larger), frame.to_numpy())
    assert all(len(piece) >= 10_000 for piece in larger[:-1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mode": "x1/x1"}, "adxl345 is an accelerometer and has no mode"),
        ({"iir": 0}, "has no iir"),
        ({"name": "bmp390", "range_g": 4}, "bmp390 is a pressure sensor and has no range_g"),
        ({"name": "bmp390", "filter": "rate/2"}, "has no filter"),
        ({"rate": 801}, "nearest: 800"),
        ({"noise_scale": -1.0}, "noise_scale must be"),
        ({"noise_scale": float("nan")}, "noise_scale must be"),
        ({"duration": float("inf")}, "positive"),
        ({"name": "adxl354"}, "adxl345"),
        ({"duration": 0.0}, "positive"),
        ({"duration": float("nan")}, "positive"),
        ({"unit": "perfect"}, "random, typical, ideal"),
    ],
)
def test_wrong_input_is_one_clear_line(options, message):
    call = {"name": "adxl345", "duration": 1.0, "seed": 1} | options
    with pytest.raises(ValueError, match=message):
        record_at_rest(call.pop("name"), **call)
