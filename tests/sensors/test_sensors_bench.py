"""What devices write on a bench, as anybody may read it."""

import numpy as np
import pandas as pd
import pytest

from sensors import Accelerometer, Streams, preset, presets, record_at_rest

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


def test_a_random_unit_is_off_by_its_bias_and_scale():
    unit = Accelerometer(preset("adxl345"), Streams(6))
    mean = record_at_rest("adxl345", duration=30.0, seed=6)[["fx", "fy", "fz"]].mean()
    expected = np.array([0, 0, -G0]) * (1 + np.array(unit.scale_error)) + unit.bias
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


@pytest.mark.parametrize(
    ("options", "message"),
    [
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
