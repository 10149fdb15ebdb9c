"""Several flights: the same whoever flies them, in the order of the seeds, and kept when they are interrupted."""

import os
import subprocess
import sys
import textwrap
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import uavsim
from uavsim.cosim import draw
from uavsim.scenario import load_scenario
from uavsim.studies import batch, engine
from uavsim.studies.batch import Batch, fly_seeds
from uavsim.studies.batch_cramer_rao import STRETCHES, against_bound, least_error
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP, Flown, fly_position
from uavsim.studies.campaign.keep import Keep
from uavsim.studies.campaign.plan import Plan
from uavsim.studies.engine import InTurn, Left

SHORT = load_scenario("catapult", overrides=["duration=6"])
SEEDS = [4, 2, 9]


@pytest.fixture(scope="module")
def alone() -> Batch:
    return fly_seeds(SHORT, SEEDS, workers=1)


def same(one: Batch, other: Batch) -> None:
    pd.testing.assert_frame_equal(one.runs, other.runs, check_exact=True)
    assert [t.seed for t in one.traces] == [t.seed for t in other.traces]
    for a, b in zip(one.traces, other.traces, strict=True):
        np.testing.assert_array_equal(a.filtered, b.filtered)
        np.testing.assert_array_equal(a.raw, b.raw)


def test_two_workers_give_what_one_gives(alone: Batch) -> None:
    """Runs, their order, traces and kept flights, bit for bit."""
    finished: list[tuple[int, int]] = []
    together = fly_seeds(SHORT, SEEDS, workers=2, progress=lambda done, all_: finished.append((done, all_)))
    same(together, alone)
    assert together.complete
    assert alone.complete
    assert finished == [(1, 3), (2, 3), (3, 3)]
    assert sorted(together.kept) == sorted(alone.kept)
    for seed, flight in alone.kept.items():
        pd.testing.assert_frame_equal(together.kept[seed].estimate, flight.estimate, check_exact=True)


class Mixed(InTurn):
    """Does its parts in another order."""

    def each(self, work: Any, given: Any, *, done: Any, limit: float | None = None) -> list[Left]:
        for position in (2, 0, 1):
            done([(position, work(given[position]))])
        return []


def test_rows_are_in_the_order_of_the_seeds_however_they_finish(alone: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "engine", lambda **_: nullcontext(Mixed()))
    same(fly_seeds(SHORT, SEEDS, workers=1), alone)


def test_a_row_is_a_flight_by_itself(alone: Batch) -> None:
    """The row of a seed holds the score of that seed flown alone, with its draws."""
    assert alone.runs["seed"].tolist() == SEEDS
    flight = uavsim.fly("catapult", seed=9, overrides=["duration=6"])
    row = alone.runs.iloc[2]
    assert row["outcome"] == flight.score["outcome"]
    assert row["launch.latency"] == flight.score["launch"]["latency"]
    assert row["airspeed.stroke.rmse"] == flight.score["airspeed"]["stroke"]["rmse"]
    assert row["pressure.total.bias"] == flight.score["pressure"]["total"]["bias"]
    draws = draw(SHORT.with_seed(9))
    assert (row["draw.release_time"], row["draw.force_factor"]) == (draws.release_time, draws.force_factor)
    assert row["requirements.met"] == all(r["met"] for r in flight.score["requirements"])


def test_whole_flights_are_kept_where_somebody_will_look(alone: Batch) -> None:
    """At six seconds none can have cruised, so all are kept; of expected ones only the first is."""
    assert (alone.runs["outcome"] == "timeout").all()
    assert set(alone.kept) == set(SEEDS)
    expected = fly_seeds(load_scenario("catapult", overrides=["duration=6", "expect=timeout"]), [3, 5], workers=1)
    assert set(expected.kept) == {3}


def test_what_does_not_exist_is_nan() -> None:
    missed = fly_seeds(load_scenario("weak-launch", overrides=["duration=5"]), [1], workers=1)
    row = missed.runs.iloc[0]
    assert row["outcome"] == "missed_launch"
    assert np.isnan(row["launch.detected_time"])
    assert np.isnan(row["launch.crossing_time"])
    assert np.isfinite(row["launch.true_time"])
    assert pd.api.types.is_float_dtype(missed.runs["launch.latency"])


def test_errors_are_binned_from_the_true_launch(alone: Batch) -> None:
    """Rms of the error in tenths of a second, beginning 1 s before; against a plain loop over one flight's rows."""
    flight, trace = alone.kept[4], alone.traces[0]
    true = flight.score["launch"]["true_time"]
    e, truth = flight.estimate, flight.truth
    error = e["airspeed"] - np.interp(e["t"], truth["t"], truth["airspeed"])
    for bin_ in (0, 9, 12, trace.filtered.size - 1):
        first = true + ERROR_START + bin_ * ERROR_STEP
        inside = error[(e["t"] >= first) & (e["t"] < first + ERROR_STEP)]
        assert trace.filtered[bin_] == pytest.approx(np.sqrt(np.mean(inside**2)))
    assert alone.error_time[0] == pytest.approx(ERROR_START + 0.5 * ERROR_STEP)
    assert alone.error_time.size == max(t.filtered.size for t in alone.traces)


def test_a_flight_that_is_not_launched_has_no_trace() -> None:
    stuck = load_scenario("catapult", overrides=["duration=5", "launcher.peak_specific_force_g=0.1"])
    flown = fly_seeds(stuck, [1], workers=1)
    assert flown.runs["outcome"].tolist() == ["timeout"]
    assert flown.traces[0].filtered.size == 0
    assert flown.error_time.size == 0


@pytest.mark.parametrize("seeds", [[], [1]])
def test_few_seeds_need_no_pool(seeds: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "Engine", None)
    flown = fly_seeds(SHORT, seeds, workers=2)
    assert len(flown.runs) == len(seeds)
    assert flown.complete


def interrupted(plan: Plan, keep: Keep, limit: float, position: int) -> Flown:
    if position == 2:
        raise KeyboardInterrupt
    return fly_position(plan, keep, limit, position)


def test_an_interrupt_keeps_what_was_finished(alone: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "fly_position", interrupted)
    flown = fly_seeds(SHORT, SEEDS, workers=1)
    assert not flown.complete
    assert flown.runs["seed"].tolist() == [4, 2]
    pd.testing.assert_frame_equal(flown.runs, alone.runs.iloc[:2], check_exact=True)


WITH_CTRL_C = """
    import os, signal, sys
    from uavsim.scenario import load_scenario
    from uavsim.studies.batch import fly_seeds

    def progress(done, _):
        if done == 1:
            os.killpg(0, signal.SIGINT)  # as a terminal does it: to every process of the group

    if __name__ == "__main__":
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background may have it ignored
        scenario = load_scenario("catapult", overrides=["duration=6"])
        flown = fly_seeds(scenario, list(range(1, 41)), workers=2, progress=progress)
        print(flown.complete, len(flown.runs), flown.runs["seed"].is_monotonic_increasing)
"""


@pytest.mark.skipif(os.name != "posix", reason="process groups")
def test_ctrl_c_reaches_the_one_who_asked_and_the_flights_under_way_are_kept(tmp_path: Path) -> None:
    """Two processes fly, the whole group is interrupted after the first flight: no traceback, a few flights kept."""
    script = tmp_path / "interrupted.py"
    script.write_text(textwrap.dedent(WITH_CTRL_C))
    run = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, start_new_session=True, check=False, timeout=120
    )
    assert (run.returncode, run.stderr) == (0, "")
    complete, count, ordered = run.stdout.split()
    assert (complete, ordered) == ("False", "True")
    assert 2 <= int(count) < 20  # the first, and what was under way


def test_an_error_in_a_flight_is_the_callers() -> None:
    unknown = load_scenario("catapult", overrides=["aircraft.properties.no/such-property=1", "duration=6"])
    with pytest.raises(ValueError, match="no/such-property"):
        fly_seeds(unknown, [1, 2], workers=2)


# -- consistency -----------------------------------------------------------------------------------------------------


def test_nees_is_that_of_the_last_row_of_a_bin_and_none_below_v_star(alone: Batch) -> None:
    """Against a plain loop over one flight's rows, at every bin."""
    flight, trace = alone.kept[4], alone.traces[0]
    true = flight.score["launch"]["true_time"]
    e, truth = flight.estimate, flight.truth
    error = (e["airspeed"] - np.interp(e["t"], truth["t"], truth["airspeed"])).to_numpy()
    speed, sd = e["airspeed"].to_numpy(), e["airspeed_sd"].to_numpy()
    bins = np.floor((e["t"].to_numpy() - true - ERROR_START) / ERROR_STEP).astype(int)
    for bin_ in range(trace.nees.size):
        rows = np.flatnonzero(bins == bin_)
        if rows.size and speed[rows[-1]] >= 2.0 * sd[rows[-1]]:
            assert trace.nees[bin_] == pytest.approx((error[rows[-1]] / sd[rows[-1]]) ** 2)
        else:
            assert np.isnan(trace.nees[bin_])
    assert np.isfinite(trace.nees[-5:]).all()


def test_courses_are_kept_for_the_bound_and_only_of_the_aided_estimator(alone: Batch) -> None:
    assert all(trace.course is not None for trace in alone.traces)
    paper = load_scenario("catapult", overrides=["duration=6", "estimator.kind=paper"])
    assert fly_seeds(paper, [3], workers=1).traces[0].course is None


def test_flights_are_put_against_the_bound(alone: Batch) -> None:
    """Both errors are root mean squares over the same bins; a filter near the bound is within half and twice of it."""
    least = least_error(alone)
    assert least is not None
    time, allowed = least.time, least.sd
    found = against_bound(alone)
    assert set(found) <= set(STRETCHES)
    for name, (start, end) in STRETCHES.items():
        part = (time >= start) & (time < end)
        if name not in found:
            assert not part.any()
            continue
        columns = np.round((time[part] - ERROR_START) / ERROR_STEP - 0.5).astype(int)
        pairs = [
            (trace.filtered[column] ** 2, limit**2)
            for trace in alone.traces
            for column, limit in zip(columns, allowed[part], strict=True)
            if column < trace.filtered.size and np.isfinite(trace.filtered[column])
        ]
        rmse, limit = np.sqrt(np.mean(pairs, axis=0))
        assert (found[name].rmse, found[name].bound) == (pytest.approx(rmse), pytest.approx(limit))
        assert found[name].ratio == pytest.approx(rmse / limit)
        assert 0.5 < found[name].ratio < 2.0


def test_there_is_no_bound_of_one_flight_or_of_another_estimator(alone: Batch) -> None:
    assert against_bound(replace(alone, traces=alone.traces[:1])) == {}
    assert against_bound(replace(alone, kept={})) == {}
    paper = load_scenario("catapult", overrides=["duration=5", "estimator.kind=paper"])
    assert against_bound(fly_seeds(paper, [3, 4], workers=1)) == {}
