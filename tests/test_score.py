"""Times, phases, outcomes and figures of the score, on small flights made by hand; what is expected is written out."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from uavsim import airdata
from uavsim.airspeeds import of_estimate, of_pressures
from uavsim.criteria import outcome, touchdown
from uavsim.judged import Judged
from uavsim.onboard.launch import DetectorSettings
from uavsim.plants.choice import PlantSettings
from uavsim.scenario import Scenario
from uavsim.score import score
from uavsim.score_keys import PHASES, no_airspeed
from uavsim.truth import STANDARD_GRAVITY

RELEASE, EXIT, WINGS, OUT, MOTOR, END = 2.0, 2.4, 2.52, 2.8, 2.77, 12.0
STROKE = 5.2
AIM = 32.0
EVENTS = (("launch_detected", 2.025), ("wings_commanded", WINGS), ("motor_on", MOTOR))


def row(time: float) -> int:
    """Index of the truth row at `time`."""
    return round(1000 * time)


def made(
    *,
    events: tuple[tuple[str, float], ...] = EVENTS,
    ended: str = "completed",
    end: float = END,
    change: Callable[[dict[str, np.ndarray]], None] | None = None,
    estimate: dict[str, np.ndarray] | None = None,
    readings: dict[str, np.ndarray] | None = None,
    **scenario: Any,
) -> Judged:
    """A flight that cruises: 10 ms after release it passes 1 mm, at 2.4 s the rail ends, at 2.8 s the wing is out."""
    t = np.arange(row(end) + 1) / 1000.0
    since = np.maximum(t - RELEASE, 0.0)
    way = np.minimum(10.001 * since**2 + 3.0 * STROKE * np.maximum(since - 0.2, 0.0), STROKE)
    way[t >= EXIT] = STROKE
    way[t < EXIT] = np.minimum(way[t < EXIT], 5.1)
    truth = {
        "t": t,
        "rail_s": way,
        "fx": np.where((t > RELEASE + 0.02) & (t < EXIT), 8.0 * STANDARD_GRAVITY, 2.0),
        "wing": np.clip((t - WINGS) / (OUT - WINGS) * 0.99, 0.0, 1.0),
        "airspeed": np.interp(t, [RELEASE, EXIT, 4.0], [0.0, 26.0, AIM]),
        "roll": np.zeros_like(t),
        "pitch": np.zeros_like(t),
        "vd": np.full_like(t, 3.0),
        "altitude": np.interp(t, [RELEASE, EXIT, END], [1.5, 2.5, 20.0]),
        "p_total": np.full_like(t, 101_000.0),
        "p_static": np.full_like(t, 100_500.0),
    }
    if change is not None:
        change(truth)
    if estimate is None:
        estimate = estimated(np.arange(0.005, end, 0.01), truth)
    if readings is None:
        readings = {name: estimate[name] for name in ("t", "p_total", "p_static")}
    return Judged(
        scenario=Scenario.from_dict(scenario),
        tables={"truth": truth, "estimate": estimate, "air_data": readings},
        events=[{"event": name, "t": time} for name, time in events],
        release_time=RELEASE,
        ended=ended,
        versions={"uavsim": "0"},
    )


def estimated(
    t: np.ndarray, truth: dict[str, np.ndarray], error: Any = 0.0, raw: Any = 0.0, sd: float = 1.0
) -> dict[str, np.ndarray]:
    speed = np.interp(t, truth["t"], truth["airspeed"])
    return {
        "t": t,
        "airspeed": speed + error,
        "airspeed_raw": speed + raw,
        "airspeed_sd": np.full_like(t, sd),
        "valid": np.ones(t.shape, bool),
        "nis_total": np.full(t.shape, 1.0),
        "nis_static": np.full(t.shape, 0.5),
        "p_total": np.interp(t, truth["t"], truth["p_total"]),
        "p_static": np.interp(t, truth["t"], truth["p_static"]),
    }


def setting(name: str, value: Any, first: float, last: float = math.inf) -> Callable[[dict[str, np.ndarray]], None]:
    """Set a truth column to a value from `first` up to `last`."""

    def change(truth: dict[str, np.ndarray]) -> None:
        truth[name][(truth["t"] >= first - 1e-9) & (truth["t"] < last - 1e-9)] = value

    return change


def holding(*changes: Callable[[dict[str, np.ndarray]], None]) -> Callable[[dict[str, np.ndarray]], None]:
    def change(truth: dict[str, np.ndarray]) -> None:
        for each in changes:
            each(truth)

    return change


def touching(sink: float = 1.0, roll: float = 0.0, pitch: float = 5.0) -> Callable[[dict[str, np.ndarray]], None]:
    """Let the last row, and only that, be of an aircraft that touches the ground so; degrees."""

    def change(truth: dict[str, np.ndarray]) -> None:
        for name, value in (("vd", sink), ("roll", math.radians(roll)), ("pitch", math.radians(pitch))):
            truth[name][-1] = value

    return change


NEVER_FREE = setting("rail_s", 4.0, 2.3)
FOLDED = setting("wing", 0.0, 0.0)


# -- times -----------------------------------------------------------------------------------------------------------


def test_times_of_a_plain_flight() -> None:
    launch, flight = score(made())["launch"], score(made())["flight"]
    assert launch["release_time"] == RELEASE
    assert launch["true_time"] == pytest.approx(RELEASE + 0.010)  # 10.001 (10 ms)^2 = 1.0001 mm
    assert launch["crossing_time"] == pytest.approx(RELEASE + 0.021)
    assert launch["detected_time"] == 2.025
    assert launch["latency"] == pytest.approx(0.015)
    assert launch["latency_from_crossing"] == pytest.approx(0.004)
    assert launch["false_detections"] == 0
    assert launch["detector"] == Scenario().detector.kind
    assert flight["rail_exit_time"] == EXIT
    assert flight["rail_exit_speed"] == pytest.approx(26.0)
    assert flight["wing_start_time"] == pytest.approx(WINGS, abs=1.1e-3)
    assert flight["wing_out_time"] == pytest.approx(OUT)
    assert flight["duration"] == END


def test_exactly_a_millimetre_is_not_yet_moved() -> None:
    flight = made(change=setting("rail_s", 1e-3, RELEASE, RELEASE + 0.05))
    assert flight.true_time == pytest.approx(RELEASE + 0.05)


def test_true_launch_does_not_come_back() -> None:
    """5 mm at once, back behind 1 mm for 20 ms: the launch is the last time it leaves."""
    flight = made(change=holding(setting("rail_s", 5e-3, RELEASE, RELEASE + 0.03), setting("rail_s", 0.0, 2.03, 2.05)))
    assert flight.true_time == pytest.approx(2.05)


def test_true_launch_is_not_before_release() -> None:
    """Handled on the rail: 2 mm ahead all the time before release."""
    assert made(change=setting("rail_s", 2e-3, 0.0, RELEASE + 0.02)).true_time == RELEASE
    knocked = made(change=setting("rail_s", 2e-3, 1.0, 1.1))
    assert knocked.true_time == pytest.approx(RELEASE + 0.010)


def test_an_aircraft_that_stays_or_returns_was_not_launched() -> None:
    for change in (setting("rail_s", 0.0, RELEASE), holding(NEVER_FREE, setting("rail_s", 0.0, 3.0))):
        flight = made(change=change, events=())
        assert flight.true_time is None
        assert flight.rail_exit_time is None
        assert score(flight)["airspeed"]["samples"] == 0


def test_a_way_that_is_no_number_is_no_return() -> None:
    flight = made(change=holding(NEVER_FREE, setting("rail_s", math.nan, 3.0)), ended="diverged")
    assert flight.true_time == pytest.approx(RELEASE + 0.010)


def test_crossing_is_above_four_and_a_half_g() -> None:
    weak = made(change=setting("fx", 4.5 * STANDARD_GRAVITY, 0.0))
    assert score(weak)["launch"]["crossing_time"] is None
    assert score(weak)["launch"]["latency_from_crossing"] is None
    above = made(change=holding(setting("fx", 2.0, 0.0), setting("fx", 44.14, 2.3)))
    assert above.crossing_time == pytest.approx(2.3)
    assert made(change=setting("fx", 4.4 * STANDARD_GRAVITY, 0.0)).crossing_time is None
    knocked = made(change=setting("fx", 60.0, 1.0, 1.05))
    assert knocked.crossing_time == pytest.approx(RELEASE + 0.021)


def test_a_launch_that_is_recognised_at_the_last_moment_is_not_missed() -> None:
    """0.5 s after the last shoe has left, to the bit; a millisecond later it is missed."""
    exit_time = made().rail_exit_time
    assert exit_time is not None
    others = tuple(event for event in EVENTS if event[0] != "launch_detected")
    at = made(events=(("launch_detected", exit_time + 0.5), *others))
    late = made(events=(("launch_detected", exit_time + 0.501), *others))
    assert (outcome(at) != "missed_launch", outcome(late)) == (True, "missed_launch")


def test_detections_before_release_are_false_and_never_the_detection() -> None:
    early = (("launch_detected", 0.7), ("launch_detected", 1.999), *EVENTS)
    launch = score(made(events=early))["launch"]
    assert launch["false_detections"] == 2
    assert launch["detected_time"] == 2.025
    only_early = score(made(events=early[:2]))
    assert only_early["launch"]["false_detections"] == 2
    assert only_early["launch"]["detected_time"] is None
    assert only_early["launch"]["latency"] is None
    assert only_early["outcome"] == "missed_launch"


def test_a_detection_at_release_counts() -> None:
    launch = score(made(events=(("launch_detected", RELEASE), *EVENTS)))["launch"]
    assert (launch["detected_time"], launch["false_detections"]) == (RELEASE, 0)
    assert launch["latency"] == pytest.approx(-0.010)


# -- phases ----------------------------------------------------------------------------------------------------------


def starts(flight: Judged) -> dict[str, float]:
    """Time of the first truth row of each phase, in order."""
    phases = flight.phases()
    changes = [0, *(np.flatnonzero(phases[1:] != phases[:-1]) + 1)]
    assert len({phases[i] for i in changes}) == len(changes)  # none comes twice
    return {phases[i]: float(flight.time[i]) for i in changes}


def test_phases_of_a_plain_flight() -> None:
    expected = {"rail": 0.0, "stroke": RELEASE + 0.060, "transition": EXIT, "cruise": OUT + 2.0}
    assert starts(made()) == pytest.approx(expected)


def test_phases_do_not_depend_on_what_was_detected() -> None:
    assert starts(made(events=())) == starts(made())


def test_a_wing_that_never_comes_out_ends_the_transition_after_four_seconds() -> None:
    assert starts(made(change=FOLDED))["cruise"] == pytest.approx(EXIT + 4.0)
    assert score(made(change=FOLDED))["flight"]["wing_out_time"] is None


@pytest.mark.parametrize(("out", "cruise"), [(1.0, 3.0), (0.2, EXIT)])
def test_a_wing_that_is_out_on_the_rail(out: float, cruise: float) -> None:
    assert starts(made(change=setting("wing", 1.0, out)))["cruise"] == pytest.approx(cruise)


def test_a_short_record_lacks_the_phases_it_did_not_reach() -> None:
    assert set(starts(made(end=4.0))) == {"rail", "stroke", "transition"}
    assert set(starts(made(end=2.3))) == {"rail", "stroke"}
    assert set(starts(made(end=1.9))) == {"rail"}
    result = score(made(end=4.0))["airspeed"]
    assert result["cruise"]["samples"] == 0
    assert result["cruise"] == no_airspeed() | {"samples": 0}
    assert result["stroke"]["samples"] > 0


def test_a_launch_that_stays_on_the_rail_is_all_stroke() -> None:
    assert set(starts(made(change=NEVER_FREE))) == {"rail", "stroke"}


def test_every_row_is_in_one_phase_and_the_headline_is_over_all_three() -> None:
    flight = made()
    t = flight.estimate("t")
    phases = [flight.rows(t, name) for name in ("stroke", "transition", "cruise")]
    assert np.array_equal(np.sum(phases, axis=0), flight.rows(t).astype(int))
    assert np.array_equal(flight.rows(t), t >= RELEASE + 0.060)
    figures = score(flight)["airspeed"]
    assert figures["samples"] == sum(figures[name]["samples"] for name in ("stroke", "transition", "cruise"))


# -- outcomes --------------------------------------------------------------------------------------------------------


def with_event(name: str, time: float | None) -> tuple[tuple[str, float], ...]:
    """Events of the plain flight with one at another time, or without it."""
    return tuple((n, t if n != name else time) for n, t in EVENTS if n != name or time is not None)


@pytest.mark.parametrize(
    ("expected", "flight"),
    [
        ("cruise", {}),
        ("diverged", {"ended": "diverged"}),
        ("diverged", {"ended": "diverged", "events": with_event("wings_commanded", 2.1)}),
        ("diverged", {"ended": "diverged", "events": ()}),
        ("false_launch", {"events": with_event("wings_commanded", EXIT - 0.001)}),
        ("cruise", {"events": with_event("wings_commanded", EXIT)}),
        ("false_launch", {"events": (("launch_detected", 1.0), ("wings_commanded", 1.2))}),
        ("false_launch", {"events": with_event("wings_commanded", 2.39), "ended": "crashed"}),
        ("false_launch", {"change": NEVER_FREE}),
        ("missed_launch", {"events": ()}),
        ("missed_launch", {"events": (), "ended": "crashed"}),
        ("missed_launch", {"events": (), "change": NEVER_FREE}),
        ("timeout", {"events": (), "change": setting("rail_s", 0.0, RELEASE)}),
        ("missed_launch", {"events": with_event("launch_detected", EXIT + 0.501)}),
        ("cruise", {"events": with_event("launch_detected", EXIT + 0.499)}),
        ("crashed", {"ended": "crashed"}),
        ("crashed", {"ended": "touched", "end": 3.0}),
        ("landed", {"ended": "touched", "end": 3.0, "change": touching(sink=1.49)}),
        ("landed", {"ended": "landed", "end": 3.0, "change": touching(sink=1.49)}),
        ("landed", {"ended": "touched", "change": touching(sink=-0.2)}),
        ("crashed", {"ended": "touched", "change": touching(sink=1.51)}),
        ("crashed", {"ended": "touched", "change": touching(sink=math.nan)}),
        ("landed", {"ended": "touched", "change": touching(roll=-29.9)}),
        ("crashed", {"ended": "touched", "change": touching(roll=-30.1)}),
        ("crashed", {"ended": "touched", "change": touching(roll=179.0)}),
        ("landed", {"ended": "touched", "change": touching(pitch=-4.9)}),
        ("crashed", {"ended": "touched", "change": touching(pitch=-5.1)}),
        ("landed", {"ended": "touched", "change": touching(pitch=19.9)}),
        ("crashed", {"ended": "touched", "change": touching(pitch=20.1)}),
        ("missed_launch", {"events": (), "ended": "touched", "change": touching()}),
        ("false_launch", {"events": with_event("wings_commanded", 2.39), "ended": "touched", "change": touching()}),
        ("timeout", {"change": setting("airspeed", AIM - 2.01, 9.0, 9.001)}),
        ("timeout", {"change": setting("airspeed", AIM + 2.01, 9.0, 9.001)}),
        ("cruise", {"change": setting("airspeed", AIM - 1.99, 9.0, 9.001)}),
        ("cruise", {"change": setting("airspeed", 25.0, 6.9, 6.99)}),
        ("timeout", {"change": setting("airspeed", 25.0, 7.01, 7.02)}),
        ("timeout", {"change": setting("airspeed", math.nan, 9.0, 9.001)}),
        ("timeout", {"change": setting("roll", math.radians(-30.0), 11.0, 11.001)}),
        ("cruise", {"change": setting("roll", math.radians(29.9), 7.0)}),
        ("timeout", {"change": setting("wing", 0.98, 8.0, 8.001)}),
        ("timeout", {"change": FOLDED}),
        ("timeout", {"events": with_event("motor_on", None)}),
        ("timeout", {"events": with_event("motor_on", 7.5)}),
        ("timeout", {"end": 6.0}),
        ("cruise", {"flight_computer": {"airspeed": 33.9}}),
        ("timeout", {"flight_computer": {"airspeed": 34.1}}),
    ],
)
def test_outcome_is_the_first_that_applies(expected: str, flight: dict[str, Any]) -> None:
    assert outcome(made(**flight)) == expected


def test_how_it_touched_is_told_in_one_line() -> None:
    flight = made(ended="touched", end=3.0, change=touching(sink=2.345, roll=-12.34, pitch=6.78))
    assert touchdown(flight) == "touched the ground at 3.00 s: sink 2.35 m/s, roll -12°, pitch 7°"


@pytest.mark.parametrize(
    ("flight", "said"),
    [
        (
            {"change": setting("airspeed", AIM - 2.34, 9.0, 9.001)},
            "true airspeed not held: -2.34 m/s off the set 32 m/s at 9.00 s, at most ±2 m/s over the last 5 s",
        ),
        (
            {"change": setting("wing", 0.98, 8.0, 8.001)},
            "wing not out: 0.98 at 8.00 s, at least 0.99 over the last 5 s",
        ),
        ({"events": with_event("motor_on", None)}, "motor never on"),
        ({"events": with_event("motor_on", 7.5)}, "motor on too late: at 7.50 s, at the latest at 7.00 s"),
        (
            {"change": setting("roll", math.radians(-31.0), 11.0, 11.001)},
            "bank too steep: 31.0° at 11.00 s, below 30° over the last 5 s",
        ),
        (
            {"events": with_event("wings_commanded", 2.1)},
            "wings commanded on the rail: at 2.100 s, the last shoe leaves the rail at 2.400 s",
        ),
        (
            {"events": with_event("launch_detected", EXIT + 0.6)},
            "launch recognised too late: 0.600 s after the last shoe has left, at most 0.5 s",
        ),
        ({"events": (), "change": setting("rail_s", 0.0, RELEASE)}, "the aircraft has not left its place"),
        (
            {"events": (), "change": setting("fx", 39.2, 0.0), "detector": {"kind": "altos"}},
            "launch not recognised: greatest true specific force along +x 4.00 g, level of a launch 4.5 g",
        ),
        ({"ended": "diverged", "change": setting("roll", math.nan, 9.5)}, "the state is not finite: roll from 9.500 s"),
        ({"expect": "timeout"}, "cruise all the same: wing out: 1.00 at "),
    ],
)
def test_what_did_not_end_as_wanted_says_the_criterion_its_worst_value_and_the_bound(
    flight: dict[str, Any], said: str
) -> None:
    told = score(made(**flight))["reason"]
    assert told.startswith(said), told


def test_every_criterion_that_is_not_met_is_told() -> None:
    folded = score(made(change=holding(FOLDED, setting("airspeed", 25.0, 8.0)), events=with_event("motor_on", None)))
    assert [said.split(":")[0] for said in folded["reason"].split("; ")] == [
        "wing not out",
        "motor never on",
        "true airspeed not held",
    ]


def test_a_speed_that_nobody_on_board_knows_is_said() -> None:
    slow = setting("airspeed", 25.0, 8.0)
    lost = (*EVENTS, ("airspeed_lost", 6.5))
    assert score(made(change=slow, events=lost))["reason"].endswith("; on board it was given up at 6.50 s")
    assert "given up" not in score(made(change=slow, events=(*lost, ("airspeed_back", 7.0))))["reason"]


def test_a_cruise_that_is_expected_needs_no_reason() -> None:
    assert score(made())["reason"] is None


def test_expected_outcome_is_the_scenarios() -> None:
    result = score(made(expect="missed_launch", seed=9))
    assert (result["outcome"], result["expected"], result["seed"]) == ("cruise", "missed_launch", 9)


# -- airspeed --------------------------------------------------------------------------------------------------------


def noisy(seed: int = 3) -> tuple[Judged, np.ndarray, np.ndarray, np.ndarray]:
    """A flight with errors drawn at random, its filtered and raw errors, and the times of the rows."""
    t = np.arange(0.0047, END, 0.01)
    generator = np.random.default_rng(seed)
    error, raw = 0.1 + 0.5 * generator.standard_normal(t.size), generator.standard_normal(t.size)
    return made(estimate=estimated(t, dict(made().tables["truth"]), error, raw, sd=0.4)), error, raw, t


@pytest.mark.parametrize(
    ("phase", "first", "last"),
    [
        (None, RELEASE + 0.06, math.inf),
        ("stroke", RELEASE + 0.06, EXIT),
        ("transition", EXIT, OUT + 2.0),
        ("cruise", OUT + 2.0, math.inf),
    ],
)
def test_figures_against_their_formulas(phase: str | None, first: float, last: float) -> None:
    flight, error, raw, t = noisy()
    figures = score(flight)["airspeed"] if phase is None else score(flight)["airspeed"][phase]
    rows = (t >= first) & (t < last)
    e, r = error[rows], raw[rows]
    assert figures["samples"] == rows.sum()
    assert figures["rmse"] == pytest.approx(math.sqrt(sum(x * x for x in e) / e.size))
    assert figures["rmse_raw"] == pytest.approx(math.sqrt(sum(x * x for x in r) / r.size))
    assert figures["reduction_percent"] == pytest.approx(100.0 - 100.0 * figures["rmse"] / figures["rmse_raw"])
    assert figures["bias"] == pytest.approx(math.fsum(e) / e.size)
    assert figures["max_error"] == pytest.approx(max(map(abs, e)))
    assert figures["nees_mean"] == pytest.approx(sum((x / 0.4) ** 2 for x in e) / e.size)
    assert figures["coverage_95"] == pytest.approx(sum(abs(x) <= 1.959964 * 0.4 for x in e) / e.size)
    assert figures["valid_fraction"] == 1.0


def test_truth_is_interpolated_to_the_row() -> None:
    """In the stroke the truth grows by 65 m/s in a second: a right estimate 0.7 ms after a truth row has no error."""
    truth = dict(made().tables["truth"])
    t = np.arange(2.1007, 2.39, 0.01)
    exact = estimated(t, truth)
    exact["airspeed"] = 65.0 * (t - RELEASE)
    assert score(made(estimate=exact))["airspeed"]["stroke"]["rmse"] == pytest.approx(0.0, abs=1e-9)


def test_invalid_rows_count_and_are_told() -> None:
    flight, error, _, t = noisy()
    flight.tables["estimate"]["valid"][t < 3.0] = False
    figures = score(flight)["airspeed"]
    rows = t >= RELEASE + 0.06
    assert figures["samples"] == rows.sum()
    assert figures["rmse"] == pytest.approx(np.sqrt(np.mean(error[rows] ** 2)))
    assert figures["valid_fraction"] == pytest.approx(np.mean(t[rows] >= 3.0))
    assert figures["stroke"]["valid_fraction"] == 0.0


def test_a_row_without_a_raw_value_counts_for_neither() -> None:
    flight, error, raw, t = noisy()
    missing = (t > 5.0) & (t < 6.0)
    flight.tables["estimate"]["airspeed_raw"][missing] = math.nan
    figures = score(flight)["airspeed"]["cruise"]
    rows = (t >= OUT + 2.0) & ~missing
    assert figures["samples"] == rows.sum()
    assert figures["rmse"] == pytest.approx(np.sqrt(np.mean(error[rows] ** 2)))
    assert figures["rmse_raw"] == pytest.approx(np.sqrt(np.mean(raw[rows] ** 2)))
    assert figures["valid_fraction"] == 1.0


def test_an_estimate_that_is_no_number_is_not_scored_but_told() -> None:
    flight, _, _, t = noisy()
    lost = t > 6.0
    flight.tables["estimate"]["airspeed"][lost] = math.nan
    flight.tables["estimate"]["valid"][lost] = False
    figures = score(flight)["airspeed"]["cruise"]
    rows = t >= OUT + 2.0
    assert figures["samples"] == (rows & ~lost).sum()
    assert figures["valid_fraction"] == pytest.approx(np.mean(~lost[rows]))


def test_without_a_claim_there_is_no_consistency_figure() -> None:
    flight, *_ = noisy()
    flight.tables["estimate"]["airspeed_sd"][:] = 0.0
    figures = score(flight)["airspeed"]
    assert figures["rmse"] is not None
    assert figures["nees_mean"] is None
    assert figures["coverage_95"] is None


def test_no_reduction_over_a_perfect_raw_value() -> None:
    figures = score(made())["airspeed"]
    assert (figures["rmse"], figures["rmse_raw"], figures["reduction_percent"]) == (0.0, 0.0, None)


# -- pressure --------------------------------------------------------------------------------------------------------


def pressed(tare: str, *, tare_taken: float, total: float = 120.0, static: float = 70.0, wind: float = 0.0) -> Judged:
    """Readings with constant offsets and alternating noise of 4 Pa; an estimate with 1 Pa of it, less the tare.

    Before release the free stream's total pressure is `wind` Pa above the static one; the cover keeps it out.
    """
    t = np.arange(0.005, END, 0.01)
    sign = np.where(np.arange(t.size) % 2, 1.0, -1.0)
    truth = dict(made().tables["truth"])
    truth["p_total"] = np.where(truth["t"] < RELEASE, 100_500.0 + wind, 101_000.0)
    free_total = np.where(t < RELEASE, 100_500.0 + wind, 101_000.0)
    covered = (t < RELEASE - 0.5) & (tare == "covered")
    port = np.where(covered, 100_500.0, free_total)
    tared_from = {"covered": RELEASE - 0.5, "open": RELEASE - 0.5, "none": math.inf}[tare]
    estimate = estimated(t, truth)
    estimate["p_total"] = port + total + sign - np.where(t > tared_from, tare_taken, 0.0)
    estimate["p_static"] = 100_500.0 + static + sign
    readings = {"t": t, "p_total": port + total + 4.0 * sign, "p_static": 100_500.0 + static + 4.0 * sign}

    def replaced(columns: dict[str, np.ndarray]) -> None:
        columns["p_total"] = truth["p_total"]

    return made(change=replaced, estimate=estimate, readings=readings, air_data={"tare": tare})


@pytest.mark.parametrize(
    ("tare", "taken", "wind", "bias_total"),
    [
        ("covered", 50.0, 0.0, 70.0),  # 120 - 50
        ("covered", 50.0, 30.0, 70.0),  # the wind is in the truth and, without the cover, in the reading
        ("open", 50.0, 0.0, 70.0),
        ("open", 80.0, 30.0, 40.0),  # a tare in the wind takes its dynamic pressure off for good: 120 - 50 - 30
        ("none", 0.0, 0.0, 120.0),
    ],
)
def test_pressure_error_is_without_its_mean_before_launch(
    tare: str, taken: float, wind: float, bias_total: float
) -> None:
    pressure = score(pressed(tare, tare_taken=taken, wind=wind))["pressure"]
    assert pressure["total"]["bias"] == pytest.approx(bias_total, abs=0.05)
    assert pressure["static"]["bias"] == pytest.approx(70.0, abs=0.05)
    for channel in ("total", "static"):
        figures = pressure[channel]
        assert figures["rmse"] == pytest.approx(1.0, abs=0.01)
        assert figures["rmse_raw"] == pytest.approx(4.0, abs=0.01)
        assert figures["reduction_percent"] == pytest.approx(75.0, abs=0.3)


@pytest.mark.parametrize("channel", ["total", "static"])
def test_the_reading_of_a_row_is_that_of_its_own_instant(channel: str) -> None:
    """On a pressure that rises by 1000 Pa/s from the launch on: the reading before would be 10 ms old, 10 Pa."""

    def rising(truth: dict[str, np.ndarray]) -> None:
        truth[f"p_{channel}"] += 1000.0 * np.maximum(truth["t"] - RELEASE, 0.0)

    flight = made(change=rising)
    assert score(flight)["pressure"][channel]["rmse_raw"] == pytest.approx(0.0, abs=1e-6)
    rows = {name: np.asarray(flight.tables["estimate"][name]).copy() for name in ("t", "p_total", "p_static")}
    late = {**rows, "t": rows["t"] + 0.004}  # the last reading of a row is now the one before it
    found = score(made(change=rising, readings=late))["pressure"][channel]
    assert found["rmse_raw"] == pytest.approx(10.0, rel=1e-3)
    assert found["rmse"] == pytest.approx(0.0, abs=1e-6)


def test_nis_is_the_mean_over_scored_rows_with_a_new_conversion() -> None:
    flight = pressed("covered", tare_taken=50.0)
    time = flight.estimate("t")
    flight.tables["estimate"]["nis_total"] = np.where(np.arange(time.size) % 2, np.nan, 1.5)
    flight.tables["estimate"]["nis_static"] = np.where(flight.rows(time), 0.25, 100.0)
    pressure = score(flight)["pressure"]
    assert pressure["total"]["nis_mean"] == pytest.approx(1.5)
    assert pressure["static"]["nis_mean"] == pytest.approx(0.25)


def test_without_readings_before_launch_there_is_no_pressure_figure() -> None:
    flight = pressed("covered", tare_taken=50.0)
    flight.tables["estimate"]["p_total"][flight.estimate("t") < RELEASE] = math.nan
    pressure = score(flight)["pressure"]
    assert set(pressure["total"].values()) == {None}
    assert pressure["static"]["rmse"] is not None


# -- flight ----------------------------------------------------------------------------------------------------------


def test_flight_figures() -> None:
    flight = made(change=holding(setting("altitude", 2.2, 3.0, 3.1), setting("altitude", 0.5, 1.0, 1.1)))
    figures = score(flight)["flight"]
    assert figures["rail_exit_altitude"] == pytest.approx(2.5)
    assert figures["lowest_altitude_after_exit"] == pytest.approx(2.2)
    assert figures["cruise_airspeed"] == pytest.approx(AIM)
    assert figures["cruise_airspeed_sd"] == pytest.approx(0.0, abs=1e-12)


def test_figures_of_a_diverged_flight_are_those_of_what_was_flown() -> None:
    nothing = [setting(name, math.nan, 8.0) for name in ("airspeed", "altitude", "fx", "p_total", "p_static")]
    result = score(made(change=holding(*nothing), end=8.0, ended="diverged"))
    assert result["outcome"] == "diverged"
    assert result["flight"]["lowest_altitude_after_exit"] == pytest.approx(2.5)
    assert result["flight"]["cruise_airspeed"] == pytest.approx(AIM)
    assert result["airspeed"]["cruise"]["samples"] > 300
    json.dumps(result, allow_nan=False)


# -- requirements and JSON -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "minimum", "maximum", "met"),
    [
        ("launch.false_detections", None, 0, True),
        ("launch.latency", 0.015 - 1e-6, 0.015 + 1e-6, True),
        ("launch.latency", 0.016, None, False),
        ("launch.latency", None, 0.014, False),
        ("airspeed.cruise.samples", 1, None, True),
        ("airspeed.reduction_percent", 10.0, None, False),  # null: raw is perfect
        ("airspeed.reduction_percent", None, None, False),
        ("airspeed.stroke", 0.0, None, False),
        ("no.such.key", None, 1.0, False),
        ("outcome", None, 1.0, False),
    ],
)
def test_requirements(key: str, minimum: float | None, maximum: float | None, met: bool) -> None:
    wanted = {k: v for k, v in (("key", key), ("minimum", minimum), ("maximum", maximum)) if v is not None}
    (result,) = score(made(requirements=[wanted]))["requirements"]
    assert result["met"] is met
    assert (result["key"], result["minimum"], result["maximum"]) == (key, minimum, maximum)
    assert result["value"] is None or isinstance(result["value"], int | float)


@pytest.mark.parametrize(
    "flight",
    [
        {},
        {"events": (), "end": 1.0},
        {"events": (), "change": setting("rail_s", 0.0, RELEASE)},
        {"change": setting("airspeed", math.nan, 0.0), "ended": "diverged"},
        {"estimate": {name: np.empty(0) for name in estimated(np.empty(0), dict(made().tables["truth"]))}},
    ],
)
def test_score_is_json_of_numbers_and_null(flight: dict[str, Any]) -> None:
    """Every value survives a strict JSON round trip as it is: no NaN, no numpy scalar."""
    result = score(made(**flight))
    assert json.loads(json.dumps(result, allow_nan=False)) == result


def test_what_does_not_exist_is_null_and_not_zero() -> None:
    """A flight that never moves has no launch, no phases, no figures; counts are counts."""
    result = score(made(events=(), change=setting("rail_s", 0.0, RELEASE)))
    launch, flight, airspeed = result["launch"], result["flight"], result["airspeed"]
    for value in (
        launch["true_time"], launch["detected_time"], launch["latency"], launch["latency_from_crossing"],
        flight["rail_exit_time"], flight["rail_exit_speed"], flight["rail_exit_altitude"], flight["cruise_airspeed"],
        flight["cruise_airspeed_sd"], flight["lowest_altitude_after_exit"],
        *(airspeed[key] for key in ("losses", "hazard", "hazard_time")),
    ):  # fmt: skip
        assert value is None
    counted = {"samples": 0}
    for group in (airspeed, *(airspeed[phase] for phase in PHASES)):
        assert {key: group[key] for key in no_airspeed()} == no_airspeed() | counted
    assert (airspeed["flags"], airspeed["false_flags"]) == (0, 0)
    assert result["pressure"]["total"]["rmse"] is None
    assert airspeed["samples"] == 0
    assert launch["false_detections"] == 0


def test_what_the_cover_left_in_sensor_and_filter_is_no_error_of_the_total_pressure() -> None:
    """For 40 ms after the cover a reading still shows the covered port, 30 Pa below the wind: the bias stays."""
    flight = pressed("covered", tare_taken=50.0, wind=30.0)
    estimate, lingering = flight.tables["estimate"], flight.estimate("t")
    just_uncovered = (lingering > RELEASE - 0.5) & (lingering < RELEASE - 0.46)
    assert just_uncovered.sum() >= 3
    estimate["p_total"] = np.where(just_uncovered, flight.estimate("p_total") - 30.0, flight.estimate("p_total"))
    assert score(flight)["pressure"]["total"]["bias"] == pytest.approx(70.0, abs=0.05)


# -- rigs ------------------------------------------------------------------------------------------------------------


def rigged(**more: Any) -> Judged:
    """The same tables as of the plain flight, but on a centrifuge that listens down."""
    return made(plant={"kind": "centrifuge"}, detector={"axes": ("-z",)}, expect="completed", **more)


def test_a_rig_is_scored_over_its_whole_run_and_completes() -> None:
    force = setting("fz", -5.0 * STANDARD_GRAVITY, 3.0)

    def change(truth: dict[str, np.ndarray]) -> None:
        truth["fz"] = np.zeros_like(truth["t"])
        force(truth)

    flight = rigged(change=change, events=(("launch_detected", 1.0), ("launch_detected", 3.02)))
    result = score(flight)
    assert result["outcome"] == "completed"
    assert result["launch"]["crossing_time"] == pytest.approx(3.0)
    assert result["launch"]["latency_from_crossing"] == pytest.approx(0.02)
    assert (result["launch"]["detections"], result["launch"]["false_detections"]) == (2, 1)
    assert result["flight"]["rail_exit_time"] is None
    assert result["airspeed"]["samples"] == len(flight.tables["estimate"]["t"])
    assert result["airspeed"]["cruise"]["samples"] == 0
    assert set(flight.phases()) == {"run"}


def test_a_rig_can_diverge() -> None:
    assert outcome(rigged(ended="diverged", change=setting("fx", math.nan, 3.0))) == "diverged"


def test_without_an_airspeed_there_is_no_figure_of_it() -> None:
    def change(truth: dict[str, np.ndarray]) -> None:
        truth["fz"] = np.zeros_like(truth["t"])
        truth["airspeed"] = np.full_like(truth["t"], np.nan)

    airspeed = score(rigged(change=change))["airspeed"]
    assert airspeed["rmse"] is airspeed["valid_fraction"] is airspeed["coverage_95"] is None
    assert airspeed["samples"] == 0


@pytest.mark.parametrize(
    ("kind", "axes", "axis"),
    [
        ("jsbsim", ("+z",), "+x"),
        ("centrifuge", ("+z",), "+z"),
        ("centrifuge", "any", "+x"),
        ("launch-curve", ("+x", "-x"), "+x"),
    ],
)
def test_the_launch_is_along_the_detectors_axis_of_a_rig(kind: Any, axes: Any, axis: str) -> None:
    scenario = replace(Scenario(), plant=PlantSettings(kind=kind), detector=DetectorSettings(axes=axes))
    assert scenario.launch_axis == axis


# -- consistency -----------------------------------------------------------------------------------------------------


def test_coverage_at_1_2_and_3_sigma_and_nees_above_v_star() -> None:
    """Errors of 0.5, 1.5, 2.5 and 3.5 claimed deviations in turn; where V < 2 sd an error says nothing of the claim."""
    flight = made()
    t = flight.estimate("t")
    error = np.resize([0.5, 1.5, 2.5, 3.5], t.shape)
    estimate = estimated(t, flight.tables["truth"], error=error)
    cruise = score(made(estimate=estimate))["airspeed"]["cruise"]
    for sigmas, share in ((1, 0.25), (2, 0.5), (3, 0.75)):
        assert cruise[f"coverage_{sigmas}_sigma"] == pytest.approx(share, abs=0.01)
    assert cruise["nees_mean"] == pytest.approx((0.25 + 2.25 + 6.25 + 12.25) / 4.0, rel=0.01)
    hidden = estimated(t, flight.tables["truth"], error=error, sd=20.0)  # 32 m/s < 2·20
    found = score(made(estimate=hidden))["airspeed"]["cruise"]
    assert found["nees_mean"] is None
    assert found["coverage_95"] == 1.0


def test_nis_is_the_mean_over_both_pressures_and_white_innovations_pass() -> None:
    """1000 squares of Gaussian numbers are white, a slow sine's are not; NaN is no innovation."""
    flight = made()
    t = flight.estimate("t")
    generator = np.random.default_rng(5)
    estimate = estimated(t, flight.tables["truth"])
    estimate["nis_total"] = generator.standard_normal(t.size) ** 2
    estimate["nis_static"] = np.where(np.arange(t.size) % 2, 3.0, np.nan)
    cruise = score(made(estimate=estimate))["airspeed"]["cruise"]
    rows = t >= OUT + 2.0
    both = np.concatenate([estimate["nis_total"][rows], estimate["nis_static"][rows]])
    assert cruise["nis_mean"] == pytest.approx(np.nanmean(both), rel=0.01)
    assert cruise["whiteness"] > 0.01
    estimate["nis_total"] = 1.0 + np.sin(3.0 * t)
    assert score(made(estimate=estimate))["airspeed"]["cruise"]["whiteness"] < 1e-6


# -- calibrated and equivalent airspeed --------------------------------------------------------------------------------


def high(speed: float = 40.0, static: float = 70_000.0, temperature: float = 260.0) -> dict[str, float]:
    """Truth at a steady true airspeed, as a high field has it."""
    return {
        "airspeed": speed,
        "p_static": static,
        "p_total": airdata.total_at_airspeed(airspeed=speed, static=static, temperature=temperature),
    }


def test_calibrated_and_equivalent_airspeed_are_scored_beside_the_true_one() -> None:
    """An estimate 2 m/s too fast at 70 kPa: ρ/ρ0 = 0.766, so EAS is 1.750 m/s too fast and CAS a little more."""
    change = holding(*(setting(name, value, 0.0) for name, value in high().items()))
    told = high(42.0)
    flight = made(change=change)
    table = flight.tables["estimate"]
    for name in ("airspeed", "p_total"):
        table[name] = np.full_like(table["t"], told[name])
    figures = score(flight)["airspeed"]
    ratio = math.sqrt(70_000.0 / (287.05287 * 260.0) / 1.225)
    for part in (figures, figures["cruise"]):
        assert part["bias"] == pytest.approx(2.0)
        assert part["equivalent"] == pytest.approx(dict.fromkeys(("rmse", "bias", "max_error"), 2.0 * ratio), rel=1e-4)
        assert part["calibrated"]["bias"] == pytest.approx(
            airdata.calibrated_from_true(true=42.0, static=7e4, temperature=260.0)
            - airdata.calibrated_from_true(true=40.0, static=7e4, temperature=260.0)
        )
        assert part["calibrated"]["bias"] > part["equivalent"]["bias"]


def test_the_thermometer_is_no_error_of_the_calibrated_airspeed() -> None:
    """A true airspeed 3 % too high by 17 K of a warm thermometer, from the right pressures: CAS is right."""
    flight = made(change=holding(*(setting(name, value, 0.0) for name, value in high().items())))
    table = flight.tables["estimate"]
    table["airspeed"] = 1.03 * table["airspeed"]
    figures = score(flight)["airspeed"]
    assert figures["bias"] == pytest.approx(1.2)
    assert abs(figures["calibrated"]["max_error"]) < 1e-9


def test_pressures_that_are_none_have_no_airspeed() -> None:
    total = np.array([-1.0, math.nan, 1e5, 3e5, math.inf, 1e5, 1e5])
    static = np.array([1e5, 1e5, 1e5, 1e5, 1e5, -5.0, 2e5])
    for found in of_pressures(total, static):
        assert np.isnan(found[[0, 1, 3, 4, 5]]).all()
        assert (found[[2, 6]] == 0.0).all()


def test_an_estimator_of_ones_own_that_tells_an_airspeed_has_it_by_its_thermometer() -> None:
    estimate = {"t": np.array([1.0, 2.0]), "airspeed": np.array([40.0, 40.0]), "p_static": np.array([7e4, 7e4])}
    readings = {"t": np.array([1.5, 1.8]), "temperature": np.array([260.0, math.nan])}
    scenario = Scenario.from_dict({"environment": {"humidity": 0.0}})
    scenario = replace(scenario, estimator=replace(scenario.estimator, kind="somebody's"))
    found = of_estimate(estimate, readings, scenario)
    for i, temperature in enumerate((288.15, 260.0)):
        at = {"true": 40.0, "static": 7e4, "temperature": temperature}
        assert found.calibrated[i] == pytest.approx(airdata.calibrated_from_true(**at))
        assert found.equivalent[i] == pytest.approx(airdata.equivalent_from_true(**at))


# -- integrity ---------------------------------------------------------------------------------------------------------


def misled(error: float, first: float, last: float, *, valid: bool = True) -> Judged:
    """The plain flight, whose estimate is off by so much for a while."""
    flight = made()
    table = flight.tables["estimate"]
    during = (table["t"] >= first) & (table["t"] < last)
    table["airspeed"] = table["airspeed"] + np.where(during, error, 0.0)
    table["valid"] = np.where(during, valid, True)
    return flight


@pytest.mark.parametrize(
    ("error", "lasts", "valid", "hazard"),
    [
        (3.1, 1.1, True, True), (-3.1, 1.1, True, True), (2.9, 5.0, True, False), (30.0, 0.9, True, False),
        (3.1, 1.1, False, False), (math.nan, 1.1, True, True),
    ],
)  # fmt: skip
def test_a_hazard_is_a_valid_airspeed_3_mps_off_for_more_than_a_second(
    error: float, lasts: float, valid: bool, hazard: bool
) -> None:
    figures = score(misled(error, 6.0, 6.0 + lasts, valid=valid))["airspeed"]
    assert figures["hazard"] is hazard
    assert figures["hazard_time"] == pytest.approx(lasts if valid and not abs(error) < 3.0 else 0.0, abs=0.02)
    assert figures["losses"] == (0 if valid else 1)


def test_a_break_divides_a_hazard() -> None:
    flight = misled(5.0, 6.0, 7.6)
    table = flight.tables["estimate"]
    table["valid"] = table["valid"] & ~((table["t"] > 6.8) & (table["t"] < 6.82))
    figures = score(flight)["airspeed"]
    assert (figures["hazard"], figures["losses"]) == (False, 0)  # 20 ms are no loss
    assert figures["hazard_time"] == pytest.approx(0.8, abs=0.03)


def test_what_is_not_renewed_holds() -> None:
    """The head falls silent at 32 m/s; the aircraft slows down, and what was told stays valid."""
    flight = made(change=setting("airspeed", 25.0, 9.0))
    table = flight.tables["estimate"]
    flight.tables["estimate"].update({name: values[table["t"] < 8.0] for name, values in list(table.items())})
    assert score(flight)["airspeed"]["hazard_time"] == pytest.approx(END - 9.0, abs=0.01)


def test_flags_before_the_first_fault_are_false() -> None:
    fault = {"air_data": {"total_port": {"faults": [{"kind": "blocked", "start": 6.0}]}}}
    flags = (*EVENTS, ("airspeed_fault", 5.0), ("airspeed_recovered", 5.5), ("airspeed_fault", 7.0))
    both = {"air_data": {"port_faults": [{"kind": "blocked", "start": 6.0}]}}
    warm = {"air_data": {"thermometer_faults": [{"kind": "dead", "start": 4.0}]}}
    covered, swapped = ({"air_data": {key: True}} for key in ("cover_left_on", "swapped_tubes"))
    for scenario, false in ((fault, 1), ({}, 2), (both, 1), (warm, 0), (covered, 0), (swapped, 0)):
        figures = score(made(events=flags, **scenario))["airspeed"]
        assert (figures["flags"], figures["false_flags"]) == (2, false)
