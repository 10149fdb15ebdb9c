"""Time stamps of logs: out of order, wrapped, reset, coarse, jumping; rates that change; readings that wrap."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_logs import detections, frame

from uavsim.logs import Recording, read_log, replay_log
from uavsim.logs.stamps import BackwardsError, stamped
from uavsim.logs.wraps import suspected, unwrapped

FOUND = 3.01


def read(tmp_path: Path, table: pd.DataFrame, mapping: str | None = None) -> Recording:
    path = tmp_path / "log.csv"
    table.to_csv(path, index=False)
    return read_log([path], mapping)


def said(recording: Recording) -> str:
    return " | ".join(recording.remarks)


@pytest.mark.parametrize("stamp", [0.0, -5.0, 2.5, 1e9, 20.0])
@pytest.mark.parametrize("row", [50, 299, 400])
def test_a_stamp_that_alone_is_wrong_is_left_out(tmp_path: Path, stamp: float, row: int) -> None:
    table = frame(rate=100.0)
    table.loc[row, "t"] = stamp
    if abs(stamp - row / 100.0) < 2.0 and stamp > row / 100.0:
        return  # it lies ahead by less than a jump
    recording = read(tmp_path, table)
    assert len(recording.readings) == 599
    assert "1 rows with a stamp out of order are left out" in said(recording)
    assert detections(recording) == pytest.approx([FOUND], abs=0.011)


@pytest.mark.parametrize("bits", [16, 24, 31, 32])
def test_a_counter_that_wraps_is_unwrapped(tmp_path: Path, bits: int) -> None:
    table = frame(rate=100.0)
    steps = (np.round(table["t"] * 1e3) + 2**bits - 1500).astype(np.int64) % 2**bits
    recording = read(tmp_path, table.assign(t=steps), "t=t*1e-3")
    assert f"the clock wraps at {bits} bits" in said(recording)
    assert detections(recording) == pytest.approx([1e-3 * (2**bits - 1500) + FOUND])
    assert recording.cuts == ()


def test_a_clock_that_begins_anew_cuts_the_log(tmp_path: Path) -> None:
    table = frame(rate=100.0)
    table.loc[150:, "t"] -= table.loc[150, "t"]
    recording = read(tmp_path, table.assign(p_static=1e5))
    assert recording.cuts == (150,)
    assert [len(part) for part in recording.parts] == [150, 450]
    assert detections(recording) == pytest.approx([FOUND - 1.5])
    assert recording.duration == pytest.approx(5.98)
    assert "reset: the clock goes from 1.49 s back to 0 s" in said(recording)
    assert recording.series["p_static"].t.size == 450


def test_coarse_stamps_are_spread(tmp_path: Path) -> None:
    table = frame(rate=400.0)
    recording = read(tmp_path, table.assign(t=np.floor(table["t"] * 50.0 + 1e-6) / 50.0))
    assert recording.readings[:, 0] == pytest.approx(table["t"], abs=1e-6)
    assert "stamps are coarse: 8 rows have the same" in said(recording)
    assert detections(recording) == pytest.approx(detections(read(tmp_path, table)))


def test_rows_that_are_there_twice_are_one(tmp_path: Path) -> None:
    table = frame(rate=100.0)
    recording = read(tmp_path, pd.concat([table, table.iloc[::2]]).sort_values("t"))
    assert np.array_equal(recording.readings, table.to_numpy())
    assert "300 rows have the time of the row before" in said(recording)


def test_readings_that_are_held_are_no_clipping(tmp_path: Path) -> None:
    table = frame(rate=100.0)
    held = table.iloc[np.arange(600) // 4 * 4].assign(t=table["t"].to_numpy())
    recording = read(tmp_path, held)
    assert recording.clipping() == []
    assert "readings repeat: 75% of the rows" in said(recording)
    clipped = table.assign(fx=table["fx"].clip(upper=40.0))
    assert read(tmp_path, clipped).clipping() != []


@pytest.mark.parametrize("rates", [(25.0, 200.0), (400.0, 100.0)])
def test_a_rate_that_changes_cuts_the_log(tmp_path: Path, rates: tuple[float, float]) -> None:
    table = pd.concat([frame(rate=rates[0], end=2.9), frame(rate=rates[1], start=2.9)])
    recording = read(tmp_path, table)
    assert recording.cuts == (round(2.9 * rates[0]),)
    assert [recording.rate_of(part) for part in recording.parts] == pytest.approx(list(rates))
    assert f"rate changes from {rates[0]:g} to {rates[1]:g} Hz at 2.9 s" in said(recording)
    assert len(detections(recording)) == 1


def test_a_clock_that_is_set_is_told(tmp_path: Path) -> None:
    table = frame(rate=100.0)
    table.loc[100:, "t"] += 1.7e9
    recording = read(tmp_path, table)
    assert "jump: from 0.99 to 1700000001 s" in said(recording)
    assert len(detections(recording)) == 1


def test_what_runs_backwards_is_refused(tmp_path: Path) -> None:
    for stamps in (-frame()["t"], np.tile([3.0, 1.0], 1500), np.random.default_rng(1).normal(size=3000)):
        with pytest.raises(ValueError, match=r"^[^\n]*time runs backwards: [^\n]*map t=…"):
            read(tmp_path, frame().assign(t=stamps))


@settings(deadline=None, derandomize=True, max_examples=150)
@given(st.lists(st.one_of(st.floats(-1e3, 1e3), st.just(float("nan")), st.integers(0, 30)), max_size=60))
def test_whatever_the_stamps_times_rise_within_parts(stamps: list[float]) -> None:
    given_ = np.array(stamps, float)
    try:
        found = stamped(given_, 1.0, np.arange(given_.size, dtype=float)[:, None])
    except BackwardsError:
        return
    rises = np.diff(found.t) > 0.0
    rises[[cut - 1 for cut in found.cuts]] = True
    assert rises.all()
    assert found.rows.size == found.t.size


@pytest.mark.parametrize("limit", [39.2, 60.0])
def test_readings_that_wrap_are_unwrapped(limit: float) -> None:
    t = np.arange(600) / 100.0
    push = np.interp(t, [3.0, 3.1, 3.2, 3.3], [0.0, 75.0, 75.0, 0.0])
    true = np.round((1.5 + push) * 100.0) / 100.0
    wrapped = (true + limit) % (2.0 * limit) - limit
    found, remarks = unwrapped(wrapped, "fx")
    assert len(remarks) <= 1
    if remarks:
        assert np.abs(found - true).max() < 0.05 * limit
        assert remarks[0].startswith("wrap: fx jumps between")


def test_what_does_not_wrap_stays() -> None:
    noise = np.random.default_rng(1)
    for values in (noise.normal(0.0, 30.0, 5000), np.tile([-20.0, 20.0], 500), 50.0 * np.sin(np.arange(2000) / 3.0)):
        found, remarks = unwrapped(values, "fx")
        assert remarks == []
        assert np.array_equal(found, values)


@pytest.mark.parametrize(("rate", "by"), [(50.0, 0.3), (200.0, 2.0), (1000.0, 20.0)])
def test_stamps_that_jump_forward_are_told(tmp_path: Path, rate: float, by: float) -> None:
    table = frame(rate=rate)
    assert "jump" not in said(read(tmp_path, table))
    table.loc[table["t"] > 1.0, "t"] += by
    table.loc[table["t"] > 2.0 + by, "t"] += 0.5 * by
    assert "jump: the stamps jump forward 2 times, the longest by" in said(read(tmp_path, table))


@pytest.mark.parametrize("rate", [50.0, 100.0, 200.0, 500.0])
@pytest.mark.parametrize(("reach", "peak"), [(5.0, 7.0), (6.0, 9.0), (8.0, 11.0)])
def test_readings_that_wrap_to_the_middle_are_named(tmp_path: Path, rate: float, reach: float, peak: float) -> None:
    """A stroke passes the end of the range between two samples: the reading after it is near neither end."""
    table, g = frame(rate=rate), 9.80665
    push = peak * g * np.clip(np.minimum((table["t"] - 3.0) / 0.01, (3.3 - table["t"]) / 0.02), 0.0, 1.0)
    force = np.random.default_rng(7).normal(1.5, 0.5, len(table)) + push
    table["fx"] = (force + reach * g) % (2.0 * reach * g) - reach * g
    score = replay_log(read(tmp_path, table)).score["recording"]
    right = bool(score["detections"]) and score["detections"][0] < 3.1
    told = " | ".join(score["remarks"])
    assert right or "wrap" in told or "lies along −x" in told


def test_shocks_arrests_and_burnouts_do_not_wrap() -> None:
    t = np.arange(4000) / 200.0
    for seed in range(60):
        noise = np.random.default_rng(seed)
        f = noise.normal(0.0, noise.choice([0.1, 0.5, 2.0, 5.0]), t.size) + 1.0
        f += 68.0 * ((t > 3.0) & (t < 3.3)) - 25.0 * ((t > 3.3) & (t < 5.0))  # a stroke, and drag behind it
        since = np.maximum(t - noise.uniform(6.0, 12.0), 0.0)
        f += noise.uniform(20.0, 100.0) * np.exp(-since / 0.03) * np.sin(2.0 * np.pi * 40.0 * since)
        f -= 78.0 * ((t > 15.0) & (t < 15.4))
        for limit in (40.0, 80.0, 160.0):
            assert suspected(np.clip(f, -limit, limit), t, "fx") == []
