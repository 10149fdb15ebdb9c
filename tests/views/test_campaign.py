"""Many flights to look at: figures and tables for any number of them, whatever one of them holds."""

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray

from uavsim.flight import Flight
from uavsim.scenario import Requirement, Scenario
from uavsim.studies.batch_cramer_rao import Least
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP, ErrorTrace
from uavsim.studies.campaign.many import Many
from uavsim.views import documents
from uavsim.views.campaign import convergence, errors, latency, outcomes, overlay
from uavsim.views.campaign.plots import FIGURES, save_many_plots
from uavsim.views.campaign.quantities import number, precise
from uavsim.views.campaign.summary import summary
from uavsim.views.campaign.terminal import print_many
from uavsim.views.campaign.worst import again, worst
from uavsim.views.figure import save

Array = NDArray[np.float64]
BINS = 120  # 12 s
HOSTILE = "[bold]\x1b[31m$x^{ \u202e_mine$ " + "long words " * 30


def made(flights: int, *, traces: int = 60, seed: int = 1, scenario: Scenario | None = None) -> Many:
    """Make up flights: one seed, an index each, four per cent of them crashed at a low catapult's force."""
    rng = np.random.default_rng(seed)
    force = rng.normal(1.0, 0.02, flights)
    crashed = force < 0.965
    late = rng.gamma(60.0, 0.25e-3, flights)
    runs = pd.DataFrame(
        {
            "index": np.arange(flights),
            "seed": 7,
            "outcome": np.where(crashed, "crashed", "cruise"),
            "expected": "cruise",
            "reason": [
                f"touched the ground at {t:.2f} s: sink 4.2 m/s" if hit else None
                for t, hit in zip(rng.uniform(3.0, 9.0, flights), crashed, strict=True)
            ],
            "draw.force_factor": force,
            "draw.mass_factor": rng.normal(1.0, 0.03, flights),
            "draw.kind": "a word",
            "launch.true_time": 2.0,
            "launch.crossing_time": 2.004,
            "launch.detected_time": 2.0 + late,
            "launch.latency": late,
            "launch.latency_from_crossing": late - 0.004,
            "launch.false_detections": 0,
            "flight.rail_exit_speed": 33.0 * force,
            "requirements.met": ~crashed,
        }
    )
    for phase, size in (("", 0.1), ("stroke.", 0.2), ("transition.", 0.15), ("cruise.", 0.1)):
        runs[f"airspeed.{phase}rmse"] = size * rng.lognormal(0.0, 0.1, flights)
        runs[f"airspeed.{phase}reduction_percent"] = rng.normal(30.0, 5.0, flights)
    runs["airspeed.cruise.coverage_95"] = rng.uniform(0.93, 0.97, flights)
    time = ERROR_START + ERROR_STEP * (np.arange(BINS) + 0.5)
    size = 0.1 + np.exp(-np.maximum(time, 0.0))
    kept = [
        ErrorTrace(7, size * rng.lognormal(0.0, 0.2, BINS), 1.5 * size, rng.chisquare(1, BINS))
        for _ in range(min(flights, traces))
    ]
    return Many(scenario or Scenario(name="made up"), runs, kept, flights=flights)


def diverged(flights: int = 12) -> Many:
    """Make up flights of which one diverged, one has absurd numbers and one lacks some."""
    flown = made(flights)
    runs = flown.runs
    runs.loc[3, ["outcome", "reason"]] = ["diverged", HOSTILE]
    runs.loc[3, ["airspeed.rmse", "airspeed.cruise.rmse", "flight.rail_exit_speed"]] = [3.2e8, np.inf, -np.inf]
    runs.loc[5, ["airspeed.rmse", "launch.latency", "launch.detected_time"]] = np.nan
    runs.loc[6, ["launch.latency", "launch.detected_time"]] = 1e9
    grown = flown.traces[3].filtered.copy()
    grown[50:] = np.exp(np.arange(BINS - 50.0))
    grown[100:] = np.inf
    flown.traces[3] = dataclasses.replace(flown.traces[3], filtered=grown, nees=1e4 * grown**2)
    return flown


def bare(flights: int = 3) -> Many:
    """Make up rows that say nothing but how flights ended."""
    runs = pd.DataFrame({"index": range(flights), "outcome": ["cruise"] * flights})
    return Many(Scenario(name="bare"), runs)


def undetected() -> Many:
    """Make up flights whose launch nobody noticed."""
    flown = made(6, traces=0)
    late = [name for name in flown.runs if name.startswith("launch.lat") or name == "launch.detected_time"]
    flown.runs[late] = np.nan
    flown.runs["outcome"] = "missed_launch"
    return flown


def words(figure: Figure) -> str:
    """Return all text of a figure."""
    found = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        drawn = axes.get_legend()
        found += [text.get_text() for text in axes.texts] + [axes.get_title(loc="left")]
        found += [text.get_text() for text in drawn.get_texts()] if drawn else []
    return "\n".join(found)


ALL = set(FIGURES)
CASES = {
    "none": (lambda: Many(Scenario(name="none"), made(1).runs.iloc[:0]), set()),
    "one": (lambda: made(1), {"outcomes", "latency", "airspeed_error"}),
    "two": (lambda: made(2), ALL),
    "20 000": (lambda: made(20_000), ALL),
    "diverged": (diverged, ALL),
    "nothing but outcomes": (bare, {"outcomes", "convergence"}),
    "none detected": (undetected, {"outcomes", "distributions", "convergence"}),
}


@pytest.mark.parametrize("case", CASES)
def test_each_figure_that_has_data_is_drawn(case: str, tmp_path: Path) -> None:
    make, expected = CASES[case]
    if case in ("none", "diverged"):
        written = save_many_plots(make(), tmp_path)
        assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)
        assert {path.stem for path in written} == expected
        return
    flown = make()
    figures = {name: figure for name, draw in FIGURES.items() if (figure := draw(flown)) is not None}
    assert set(figures) == expected
    for name, figure in figures.items():  # no curve has more points than a figure shows
        points = [line.get_xydata().shape[0] for axes in figure.axes for line in axes.lines]
        assert max(points, default=0) <= 3_001, name
        figure.draw_without_rendering()


@pytest.mark.parametrize("name", ["airspeed_error", "consistency", "flights", "distributions", "convergence"])
def test_a_flight_that_diverged_is_named_and_decides_no_scale(name: str) -> None:
    """The axes are as without it, within a factor of two, and a remark names it."""
    figure, without = (FIGURES[name](flown) for flown in (diverged(), made(12)))
    assert figure is not None
    assert without is not None
    assert "flight 3" in words(figure)
    assert "diverged" in words(figure)
    assert "beyond the scale" not in words(without)
    assert "left out" not in words(without)
    for one, other in zip(figure.axes, without.axes, strict=True):
        for limits in ("get_xlim", "get_ylim"):
            (low, high), (bottom, top) = getattr(one, limits)(), getattr(other, limits)()
            assert high - low <= 2.0 * (top - bottom)


def test_an_absurd_latency_is_named_and_missed_launches_count() -> None:
    figure = latency.draw(diverged())
    assert figure is not None
    assert "beyond the scale: flight 6: 1.0e12 ms" in words(figure)
    assert "1 never detected" in words(figure)
    assert figure.axes[0].get_xlim()[1] < 40.0


def test_a_launch_that_was_missed_counts_as_one_detected_never() -> None:
    flown = made(3)
    flown.runs.loc[1, "launch.detected_time"] = np.nan
    flown.runs.loc[2, "launch.crossing_time"] = np.nan
    since = latency.latencies_since(flown, "true_time")
    assert since[[0, 2]] == pytest.approx(1e3 * flown.column("launch.latency")[[0, 2]])
    assert since[1] == np.inf
    # the third never reaches 4.5 g, so nothing is said of it since then
    assert np.isnan(latency.latencies_since(flown, "crossing_time")[2])


def test_the_error_axis_is_that_of_the_flight_not_of_still_air_before_it() -> None:
    """Before the launch an estimate of still air may be right to 1e-9 m/s, which is no scale for what follows."""
    flown = made(12)
    figure = errors.draw(flown)
    assert figure is not None
    expected = figure.axes[0].get_ylim()
    for trace in flown.traces:
        trace.filtered[flown.error_time <= 0.0] = 1e-9
    figure = errors.draw(flown)
    assert figure is not None
    assert figure.axes[0].get_ylim()[0] == expected[0] > 1e-3


def test_the_bound_is_drawn_with_its_band() -> None:
    flown = made(12)
    least = Least(flown.error_time, np.full(BINS, 0.1), np.full(BINS, 0.02), courses=12)
    flown.__dict__["least"] = least
    figure = FIGURES["consistency"](flown)
    assert figure is not None
    assert {"bound, √PCRB", "95 % (bootstrap, courses)", "95 % (bootstrap, flights)"} <= set(words(figure).splitlines())
    assert least.high / least.sd == pytest.approx(np.full(BINS, np.exp(1.96 * 0.02)), rel=1e-4)


def test_bars_are_causes_with_their_intervals_and_hostile_reasons_are_text(tmp_path: Path) -> None:
    flown = diverged(200)
    figure = outcomes.draw(flown)
    assert figure is not None
    told = words(figure)
    crashed = int((flown.runs["outcome"] == "crashed").sum())
    assert re.search(rf"^{crashed}   \[", told, re.MULTILINE)
    assert "crashed: touched the ground\n" in told
    assert "\x1b" not in told
    save(figure, tmp_path / "outcomes.png")


def test_the_worst_flights_are_those_highlighted() -> None:
    flown = made(30)
    flown.runs.loc[17, "airspeed.rmse"] = 0.5
    figure = overlay.draw(flown)
    assert figure is not None
    assert next(line for line in words(figure).splitlines() if line.startswith("flight ")) == "flight 17: 0.500 m/s"


def test_kept_flights_may_be_folders(catapult: Flight, tmp_path: Path) -> None:
    """Height and true speed are read from the folders, as from flights in memory; one that is gone is left out."""
    for name in ("0", "1"):
        (tmp_path / name).mkdir()
        catapult.write(tmp_path / name)
    flown = made(4)
    flown.runs["launch.true_time"] = catapult.score["launch"]["true_time"]
    flights = dataclasses.replace(flown, kept={0: catapult, 1: catapult})
    folders = dataclasses.replace(flown, kept={i: tmp_path / str(i) for i in range(3)})
    curves = []
    for one in (flights, folders):
        figure = overlay.draw(one)
        assert figure is not None
        assert [axes.get_ylabel() for axes in figure.axes[::2]][1].startswith("altitude")
        curves.append([line.get_xydata() for axes in figure.axes for line in axes.lines])
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*curves, strict=True))


def test_required_bounds_are_drawn_where_they_are() -> None:
    wanted = Requirement(key="airspeed.rmse", maximum=0.12)
    flown = made(50, scenario=Scenario(name="a", requirements=(wanted,)))
    figure = convergence.draw(flown)
    assert figure is not None
    lines = [line for line in figure.axes[2].lines if line.get_label() == "required"]
    assert [line.get_ydata()[0] for line in lines] in ([0.12], [])
    figure = FIGURES["distributions"](flown)
    assert figure is not None
    lines = [line for axes in figure.axes for line in axes.lines if line.get_label() == "required"]
    assert [line.get_xdata()[0] for line in lines] == [0.12]


# -- tables and documents --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", [name for name in CASES if name != "none"])
def test_tables_fit_80_columns_and_show_no_control(
    case: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    flown = CASES[case][0]()
    if "draw.mass_factor" in flown.runs:
        flown.runs[f"draw.{HOSTILE}"] = flown.runs["draw.force_factor"]
    print_many(flown, Path("output/some-campaign"))
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert not re.search("[\x00-\x09\x0b-\x1f\u202e]", out)
    assert "nan" not in out
    assert "as expected" in out
    assert not re.search(r"\d…( |$)", out, re.MULTILINE)  # no number is cut
    if len(flown) > 1:
        assert re.search(r"^  uavsim fly --from output/some-campaign --index \d+$", out, re.MULTILINE)


def test_no_flight_is_said_to_be_none(capsys: pytest.CaptureFixture[str]) -> None:
    flown = dataclasses.replace(CASES["none"][0](), complete=False, lost=(0,), flights=1)
    print_many(flown)
    assert "Not all were flown: 0 of 1, 1 of them could not be flown" in capsys.readouterr().out


def test_worst_flights_are_the_broken_then_the_unexpected_then_the_odd() -> None:
    flown = diverged(40)
    listed = worst(flown, Path("a b"), most=40)
    crashed = [one.index for one in listed if one.outcome == "crashed"]
    assert listed[0].index == 3
    assert [one.index for one in listed[1 : 1 + len(crashed)]] == crashed
    assert listed[1 + len(crashed)].index == 6  # its latency is absurd
    rest = [one.rmse for one in listed[2 + len(crashed) :]]
    assert rest[:-1] == sorted(rest[:-1], reverse=True)
    assert np.isnan(rest[-1])
    assert again(Path("a b"), 3) == "uavsim fly --from 'a b' --index 3"


def test_draws_that_matter_are_told_when_enough_failed(capsys: pytest.CaptureFixture[str]) -> None:
    print_many(made(400))
    out = capsys.readouterr().out
    assert re.search(r"^force_factor +0\.9\d+ +[01]\S* +< 0\.0001$", out, re.MULTILINE)
    assert re.search(r"^mass_factor .* (0\.[1-9]\d+|1\.0000)$", out, re.MULTILINE)
    print_many(made(40))
    assert "Medians of draws" not in capsys.readouterr().out


@pytest.mark.parametrize("case", CASES)
def test_the_document_is_json_and_says_what_the_tables_say(case: str) -> None:
    flown = CASES[case][0]()
    found = json.loads(json.dumps(documents.batch(flown, Path("out"), with_rows=False), allow_nan=False))
    told = found["summary"]
    assert "rows" not in found
    assert told["flights"] == len(flown) == sum(told["outcomes"].values()) == sum(c["flights"] for c in told["causes"])
    assert set(told["beyond_scale"].get("airspeed.rmse", [])) == ({3} if case == "diverged" else set())
    if len(flown) > 1:
        assert told["worst"][0]["command"].startswith("uavsim fly --from out --index ")
        running = found["convergence"]["as_expected"]
        assert running["value"][-1] == told["as_expected"]["share"]
        assert running["flights"][-1] == len(flown)
    if case == "diverged":
        assert found["airspeed_error"]["left_out"] == told["consistency"]["left_out"] == [3]
        assert found["airspeed_error"]["flights"] == 11


def test_an_envelope_in_the_document_is_that_of_the_traces() -> None:
    flown = made(40)
    found = documents.batch(flown, Path("out"))
    assert len(found["rows"]) == 40
    median = np.array(found["airspeed_error"]["filtered"]["median"]["value"])
    there = flown.error_time > -flown.scenario.air_data.cover_off
    expected = np.median(flown.matrix("filtered")[:, there], axis=0)
    assert median == pytest.approx(expected, rel=1e-12)
    assert found["airspeed_error"]["filtered"]["p95"]["high"][0] is None  # from 72 flights on


def test_rows_without_index_are_numbered_and_the_summary_takes_several_seeds() -> None:
    from uavsim.studies.batch import Batch

    runs = made(4).runs.assign(index=0, seed=[4, 5, 6, 9])
    told = summary(Batch(Scenario(name="a"), runs, [], {}, complete=True, wall_time=1.0))
    assert sorted((one["index"], one["seed"]) for one in told["worst"]) == [(0, 4), (1, 5), (2, 6), (3, 9)]


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0.12345, "0.123"), (-0.0001, "0.000"), (123.456, "123.5"), (45678.9, "45679"), (3.2e8, "3.2e8"), (np.inf, "∞")],
)
def test_numbers_are_as_people_read_them(value: float, shown: str) -> None:
    assert number(value, 3) == shown


def test_an_estimate_has_as_many_digits_as_its_interval_needs() -> None:
    assert precise(0.124781, 0.124630, 0.125040, 3) == "0.12478 [0.12463, 0.12504]"
    assert precise(0.12, np.nan, 0.2, 2) == "0.12 [–, 0.20]"
