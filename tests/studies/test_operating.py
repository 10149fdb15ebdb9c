"""Operating curves: intervals against tables, counts against `step`, and what counts as a detection."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from pandas.testing import assert_frame_equal

from uavsim.onboard.flight_computer import FlightComputerSettings
from uavsim.onboard.launch import KINDS, DetectorSettings, build
from uavsim.scenario import load_scenario
from uavsim.settings import SettingError
from uavsim.studies.false_alarms import DISTURBANCES, count
from uavsim.studies.intervals import rate_interval, share_interval
from uavsim.studies.operating import at_level, compare, get, level, levels, not_better, operate
from uavsim.studies.signals import CROSSING, LaunchSettings, LaunchTruth
from uavsim.studies.trials import GRACE, Drawn, Flown, Trials, judge
from uavsim.studies.workers import spread

RATE = 1000.0  # Hz
HOLD = DetectorSettings(kind="single-threshold", threshold=20.0, window=0.003)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (share_interval(0, 10), (0.0, 0.3085)),  # Clopper & Pearson's chart; 1 - 0.025^(1/10)
        (share_interval(10, 10), (0.6915, 1.0)),
        (share_interval(5, 10), (0.1871, 0.8129)),  # Diem & Lentner, Scientific Tables, 1970
        (rate_interval(0, 1.0), (0.0, 3.689)),  # Garwood's table: -ln 0.025
        (rate_interval(10, 2.0), (4.795 / 2, 18.39 / 2)),  # Pearson & Hartley, Biometrika Tables I, table 40
    ],
)
def test_intervals_are_those_of_published_tables(found: tuple[float, float], expected: tuple[float, float]) -> None:
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("k", "n"), [(1, 0), (-1, 5), (6, 5)])
def test_shares_that_cannot_be_are_refused(k: int, n: int) -> None:
    with pytest.raises(ValueError, match="no share"):
        share_interval(k, n)


@pytest.mark.parametrize(("k", "time"), [(1, 0.0), (-1, 5.0)])
def test_rates_that_cannot_be_are_refused(k: int, time: float) -> None:
    with pytest.raises(ValueError, match="no rate"):
        rate_interval(k, time)


def test_parts_come_back_in_their_order_and_what_one_raises_comes_out() -> None:
    shares: list[float] = []
    assert spread([lambda k=k: k for k in range(9)], workers=3, progress=shares.append) == list(range(9))
    assert shares == pytest.approx([(k + 1) / 9 for k in range(9)])
    with pytest.raises(ZeroDivisionError):
        spread([lambda: 1 // 0, lambda: 1], workers=1)


# -- false alarms ----------------------------------------------------------------------------------------------------


def test_counts_are_those_of_step() -> None:
    """Ten minutes of two classes, at one that cries wolf in both; `make validate` looks at all of them."""
    touchy = DetectorSettings(kind="single-threshold", threshold=25.0, window=0.002)
    found = count([touchy, DetectorSettings(kind="px4-norm")], dict.fromkeys(("soft drops", "centrifuge"), 0.1), seed=3)
    for name in ("soft drops", "centrifuge"):
        disturbance = DISTURBANCES[name]
        detector, alarms = build(touchy, RATE), 0
        for k, (fx,) in enumerate(disturbance.piece(3, 0, RATE, (0,)).tolist()):
            if detector.step(k / RATE, fx, 0.0, 0.0):
                alarms += 1
                detector.reset()
        assert found[name][0].alarms == alarms > 0
        assert found[name][0].hours == pytest.approx(1 / 6)


def test_counts_do_not_depend_on_the_workers() -> None:
    detectors = [HOLD, DetectorSettings(kind="paparazzi")]
    one, three = (count(detectors, {"mix": 0.5}, seed=1, workers=n) for n in (1, 3))
    assert one == three
    assert one["mix"][0].alarms > 0
    assert one["mix"][0].hours == pytest.approx(0.5)


def test_no_hours_are_no_class() -> None:
    assert list(count([HOLD], {"mix": 0.0, "vibration": 0.01}, seed=1)) == ["vibration"]


# -- trials ----------------------------------------------------------------------------------------------------------


def pushed(begin: float, length: float = 0.01) -> np.ndarray:
    """Two seconds with one push; the truth below has the launch from 1 s to 1.2 s."""
    t = np.arange(2000) / RATE
    return np.column_stack([np.where((t >= begin) & (t < begin + length), 60.0, 3.0), 0.0 * t, 0.0 * t])


@pytest.mark.parametrize(
    ("begin", "early", "latency"),
    [
        (0.5, True, None),
        (1.0, False, 0.002),  # the third sample holds
        (1.1, False, 0.102),
        (1.2 + GRACE - 0.003, False, 0.2 + GRACE - 0.001),
        (1.2 + GRACE, False, None),
    ],
)
def test_the_first_alarm_decides(begin: float, early: bool, latency: float | None) -> None:
    truth = LaunchTruth(onset=1.0, crossing=1.001, peak=60.0, end=1.2)
    trials = Trials([pushed(begin) + pushed(1.05)], np.zeros(1), np.full(1, RATE), (truth,))
    if begin > 1.05:
        trials = Trials([pushed(begin)], np.zeros(1), np.full(1, RATE), (truth,))
    found = judge(HOLD, trials, RATE)
    assert found.early.tolist() == [early]
    assert found.detected.tolist() == [latency is not None]
    if latency is not None:
        assert found.since_onset[0] == pytest.approx(latency, abs=1e-12)
        assert found.since_crossing[0] == pytest.approx(latency - 0.001, abs=1e-12)


def test_trials_are_the_same_however_they_are_read() -> None:
    launches = Drawn(LaunchSettings(bump=True))
    some, all_ = launches.read(1, 3, 2), launches.read(1, 0, 5)
    assert all((a == b).all() for a, b in zip(some.force, all_.force[3:], strict=True))
    assert some.truths == all_.truths[3:]


def test_a_flight_serves_many_sensors() -> None:
    """Readings differ by the sensor alone: at rest and in the stroke their mean is the flight's truth."""
    launches = Flown(load_scenario("catapult"), flights=1)
    trials = launches.read(1, 0, 5)
    truth = trials.truths[0]
    assert all(t == truth for t in trials.truths)
    assert truth.crossing is not None
    assert truth.onset < truth.crossing < truth.end
    assert not np.array_equal(trials.force[0], trials.force[1])
    for force, start, rate in zip(trials.force, trials.start, trials.rate, strict=True):
        t = start + np.arange(len(force)) / rate
        assert force[t > truth.crossing + 0.05, 0].max() > CROSSING
        rest = force[t < truth.onset - 0.1, 0]
        assert rest.mean() == pytest.approx(9.80665 * np.sin(np.deg2rad(10.0)), abs=2.0)
    verdicts = judge(DetectorSettings(), trials, launches.rate)
    assert verdicts.detected.all()


def test_a_flown_launch_is_detected_when_it_is_in_flight() -> None:
    """The loop's own flight, its readings included, gives the same truth; its latency is one of those of the units."""
    import uavsim

    scenario = load_scenario("catapult")
    own = uavsim.fly("catapult", seed=1).score["launch"]
    launches = Flown(scenario, flights=1)
    truth = launches.read(1, 0, 1).truths[0]
    assert truth.onset == own["true_time"]
    assert truth.crossing == own["crossing_time"]
    found = judge(scenario.detector, launches.read(1, 0, 8), launches.rate).since_onset
    assert found.min() - 0.002 <= own["latency"] <= found.max() + 0.002


def test_a_flown_launch_at_half_the_step_is_the_same_launch() -> None:
    """Same units at the same times, truth to a step; readings to 0.1 g rms, for vibration is linear between steps."""
    coarse, fine = (
        Flown(load_scenario("catapult", overrides=[f"plant.step_rate={rate}"]), flights=1).read(3, 0, 2)
        for rate in (1000, 2000)
    )
    assert np.array_equal(coarse.start, fine.start)
    assert fine.truths[0].onset == pytest.approx(coarse.truths[0].onset, abs=1.1e-3)
    assert fine.truths[0].end == pytest.approx(coarse.truths[0].end, abs=1.1e-3)
    for one, other in zip(coarse.force, fine.force, strict=True):
        assert one.shape == other.shape
        assert np.sqrt(np.mean((one - other) ** 2, axis=0)).max() < 0.98


# -- sweeps ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_has_a_level_that_changes_it(kind: str) -> None:
    own = DetectorSettings(kind=kind)  # type: ignore[arg-type]
    assert level(at_level(own, 2.0 * level(own))) == pytest.approx(2.0 * level(own))
    swept = dict(levels(own))
    assert swept[1.0] == own
    assert len(swept) >= 8
    for chosen in swept.values():
        build(chosen, RATE)


def test_a_trigger_and_the_highest_limit_keep_their_ratio() -> None:
    own = DetectorSettings(kind="threshold-window", threshold=40.0, trigger=50.0)
    assert at_level(own, 20.0).trigger == pytest.approx(25.0)
    adaptive = at_level(DetectorSettings(kind="adaptive-cusum"), 0.5)
    assert get(adaptive, "adaptive.highest") / 0.5 == pytest.approx(0.1569 / 0.08826)


def test_a_level_out_of_bounds_is_refused() -> None:
    with pytest.raises(SettingError, match="threshold"):
        at_level(HOLD, 5000.0)
    assert max(dict(levels(DetectorSettings(kind="single-threshold", threshold=1500.0)))) == 1.2


def test_a_sweep_is_the_same_with_any_workers_and_falls_with_the_level() -> None:
    detectors = [DetectorSettings(kind="cusum"), DetectorSettings(kind="paparazzi")]
    one, two = (operate(detectors, Drawn(), hours=0.3, trials=60, seed=2, workers=n) for n in (1, 2))
    assert_frame_equal(one.rows, two.rows)
    cusum = one.rows[one.rows["detector"] == "cusum"]
    assert cusum["pd"].is_monotonic_decreasing
    assert cusum["crossing_median"].is_monotonic_increasing
    assert cusum["mix.alarms"].is_monotonic_decreasing
    assert cusum["mix.alarms"].iloc[0] > 0
    assert (one.rows["pd_low"] <= one.rows["pd"]).all()
    assert (one.rows["detected"] + one.rows["early"] <= 60).all()
    assert len(one.shipped()) == 2


@pytest.mark.parametrize(("hours", "trials"), [(0.0, 10), (float("inf"), 10), (1.0, 0)])
def test_sweeps_of_nothing_are_refused(hours: float, trials: int) -> None:
    with pytest.raises(ValueError, match="at least one trial"):
        operate([HOLD], Drawn(), hours=hours, trials=trials, seed=1)


def test_comparison_names_where_a_rival_is_better() -> None:
    rows = [(5.0, 10, 0.02), (6.0, 9, 0.02), (7.0, 10, 0.05)]
    table = pd.DataFrame(
        [
            {"peak_g": p, "sigma_g": 1.0, "bump": False, "detector": name, "detected": d, "crossing_median": delay}
            for p, detected, latency in rows
            for name, d, delay in (("cusum", detected, latency), ("px4", 10, 0.04))
        ]
    )
    assert [(s.cell[0], s.by) for s in not_better(table, "cusum")] == [(6.0, "probability"), (7.0, "delay")]


def test_a_cell_has_the_peak_noise_and_bump_that_it_says() -> None:
    table = compare([DetectorSettings(kind="cusum")], trials=20, seed=1, cells=[(15.0, 0.05, True), (5.0, 1.0, False)])
    assert table[["peak_g", "sigma_g", "bump"]].to_numpy().tolist() == [[15.0, 0.05, True], [5.0, 1.0, False]]
    assert table["crossing_median"].iloc[0] < table["crossing_median"].iloc[1]


# -- the wing command ------------------------------------------------------------------------------------------------


def test_wings_are_counted_beside_alarms() -> None:
    """A detector that takes drops for launches opens no wings for them; one at 4.1 g does, once a run."""
    touchy, low = (replace(HOLD, threshold=level) for level in (25.0, 30.0))
    found = count([touchy, replace(low, window=0.04)], {"soft drops": 0.1, "centrifuge": 0.1}, seed=3)
    assert found["soft drops"][0].alarms > found["soft drops"][0].commands == 0
    assert found["centrifuge"][1].commands == 10
    bounds = found["centrifuge"][1].commands_interval()
    assert bounds[0] < found["centrifuge"][1].commands_per_hour < bounds[1]
    assert found["centrifuge"][1].commands_per_hour == pytest.approx(60.0)


def test_a_launch_opens_the_wings_after_its_end_and_a_knock_does_not() -> None:
    """A push of 6 g for 0.3 s behind a knock, 1.5 s before, or 0.6 s before, when it is still deaf."""
    t = np.arange(6000) / RATE
    computer = FlightComputerSettings()
    truth = LaunchTruth(onset=4.0, crossing=4.001, peak=60.0, end=4.3)
    trials = []
    for knock in (2.5, 3.4):
        force = np.column_stack([np.full(t.size, 1.7), 0.0 * t, 0.0 * t])
        force[(t >= knock) & (t < knock + 0.02), 0] += 60.0
        force[(t >= 4.0) & (t < 4.3), 0] += 60.0
        trials.append(force)
    found = judge(HOLD, Trials(trials, np.zeros(2), np.full(2, RATE), (truth, truth)), RATE, computer)
    assert found.early.tolist() == [True, True]
    assert found.commanded.tolist() == [True, False]
    late = FlightComputerSettings(rearm_delay=2.0)
    found = judge(HOLD, Trials(trials, np.zeros(2), np.full(2, RATE), (truth, truth)), RATE, late)
    assert found.commanded.tolist() == [False, False]
    quick = FlightComputerSettings(speed_gain_min=0.5)
    found = judge(HOLD, Trials(trials, np.zeros(2), np.full(2, RATE), (truth, truth)), RATE, quick)
    assert found.on_rail.tolist() == [True, True]
    assert not judge(HOLD, Trials(trials, np.zeros(2), np.full(2, RATE), (truth, truth)), RATE).commanded.any()
