"""Tables in the terminal: figures with their units, in 80 columns, the same in a pipe, colour only if it is wanted."""

import dataclasses
import io
import re
import sys
from typing import Any

import numpy as np
import pandas as pd
import pytest

import uavsim
from uavsim.flight import Flight
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.batch import Batch
from uavsim.studies.batch_cramer_rao import AgainstBound
from uavsim.studies.bench import Cost, OnboardCost
from uavsim.studies.campaign.flown import ErrorTrace
from uavsim.studies.quantiles import quantile_band
from uavsim.views import terminal

ANSI = re.compile(r"\x1b\[[0-9;]*m")


@pytest.fixture(autouse=True)
def _plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("FORCE_COLOR", "NO_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self) -> bool:
        return True


def widest(text: str) -> int:
    return max(len(line) for line in text.splitlines())


def changed(flight: Flight, **score: Any) -> Flight:
    return dataclasses.replace(flight, score={**flight.score, **score})


def batch(flights: int) -> Batch:
    generator = np.random.default_rng(1)
    names = [
        "launch.latency", "launch.latency_from_crossing", "flight.rail_exit_speed", "airspeed.rmse",
        "airspeed.reduction_percent", "airspeed.stroke.reduction_percent", "airspeed.cruise.reduction_percent",
        "airspeed.cruise.coverage_95",
    ]  # fmt: skip
    runs = pd.DataFrame({name: generator.normal(0.02, 0.001, flights) for name in names})
    runs["airspeed.stroke.reduction_percent"] -= 1000.0
    runs["outcome"] = ["cruise"] * (flights - 1) + ["missed_launch"]
    runs["launch.false_detections"] = 2
    runs["requirements.met"] = [True] * (flights - 1) + [False]
    return Batch(Scenario(name="a name"), runs, [], {}, complete=True, wall_time=1.0)


# -- one flight ------------------------------------------------------------------------------------------------------


def test_a_score_shows_its_figures_with_units_in_80_columns(
    catapult: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.print_score(catapult)
    out = capsys.readouterr().out
    score = catapult.score
    assert "\x1b" not in out
    assert widest(out) <= 80
    assert "catapult, seed 1: cruise (as expected)" in out
    for value, unit in (
        (f"{score['launch']['release_time']:.3f}", "s"),
        (f"{1e3 * score['launch']['latency']:.1f}", "ms"),
        (f"{score['flight']['rail_exit_speed']:.2f}", "m/s"),
        (f"{score['flight']['lowest_altitude_after_exit']:.2f}", "m"),
    ):
        assert re.search(rf" {re.escape(value)} +{unit}( |$)", out, re.MULTILINE)
    row = next(line for line in out.splitlines() if line.startswith("RMSE filtered, m/s"))
    figures = [score["airspeed"]["rmse"], *(score["airspeed"][p]["rmse"] for p in ("stroke", "transition", "cruise"))]
    assert row.split()[3:] == [f"{figure:.3f}" for figure in figures]
    for requirement in score["requirements"]:
        line = next(line for line in out.splitlines() if line.startswith(requirement["key"]))
        assert line.split()[-1] == "yes"


def test_what_does_not_exist_is_a_dash_and_not_a_nought(
    weak_launch: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.print_score(weak_launch)
    out = capsys.readouterr().out
    assert "missed_launch (as expected)" in out
    assert re.search(r"^latency +– +ms", out, re.MULTILINE)
    assert re.search(r"wing out +– +s", out)
    assert widest(out) <= 80
    assert "nan" not in out
    assert "None" not in out


def test_an_unexpected_outcome_says_what_was_expected(catapult: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.print_score(changed(catapult, outcome="crashed"))
    assert "crashed (expected: cruise)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("low", "high", "value", "met", "row"),
    [
        (1.0, None, 0.5, False, "≥ 1 0.5 NO"),
        (None, 1.0, 0.5, True, "≤ 1 0.5 yes"),
        (0.25, 1.0, 0.5, True, "0.25 … 1 0.5 yes"),
        (None, None, 0.5, True, "a number 0.5 yes"),
        (None, 0, None, False, "≤ 0 – NO"),
        (None, 1e6, 123456.789, True, "≤ 1e+06 1.235e+05 yes"),
    ],
)
def test_requirements(
    catapult: Flight,
    capsys: pytest.CaptureFixture[str],
    low: float | None,
    high: float | None,
    value: float | None,
    met: bool,
    row: str,
) -> None:
    wanted = {"key": "airspeed.[x]", "minimum": low, "maximum": high, "value": value, "met": met}
    terminal.print_score(changed(catapult, requirements=[wanted]))
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("airspeed.[x]"))
    assert " ".join(line.split()[1:]) == row


@pytest.mark.parametrize("columns", [20, 80, 300])
def test_the_width_of_the_terminal_cuts_no_figure(
    catapult: Flight, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, columns: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    terminal.print_score(catapult)
    out = capsys.readouterr().out
    assert f"{catapult.score['airspeed']['cruise']['rmse']:.3f}\n" in out
    assert widest(out) <= max(80, min(columns, terminal.WIDEST))


@pytest.mark.parametrize(("variable", "colour"), [("", True), ("NO_COLOR", False)])
def test_colour_is_for_terminals_that_want_it(
    catapult: Flight, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], variable: str, colour: bool
) -> None:
    terminal.print_score(catapult)
    piped = capsys.readouterr().out
    screen = Screen()
    monkeypatch.setattr(sys, "stdout", screen)
    monkeypatch.setenv("TERM", "xterm-256color")
    if variable:
        monkeypatch.setenv(variable, "1")
    terminal.print_score(catapult)
    assert ("\x1b[1;32m" in screen.getvalue()) is colour
    assert ANSI.sub("", screen.getvalue()) == piped


def test_a_rig_shows_what_it_has_and_the_axis_of_its_load(capsys: pytest.CaptureFixture[str]) -> None:
    """A centrifuge loads z, and has neither rail nor wing nor phases."""
    flight = uavsim.fly("centrifuge-15g", seed=1)
    terminal.print_score(flight)
    out = capsys.readouterr().out
    assert re.search(rf"^true f_z above 4.5 g +{flight.score['launch']['crossing_time']:.3f} +s", out, re.MULTILINE)
    assert "f_x" not in out
    assert "rail" not in out
    terminal.print_score(uavsim.fly("mach06", seed=1))
    out = capsys.readouterr().out
    assert "RMSE filtered, m/s" in out
    assert "stroke" not in out
    assert re.findall("–", out) == ["–"]  # of the launch that was not detected


def test_no_minus_before_a_nought(weak_launch: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    """The last row of truth may be a few millimetres below the ground."""
    assert -0.01 < weak_launch.score["flight"]["lowest_altitude_after_exit"] < 0.0
    scored = {**weak_launch.score, "flight": {**weak_launch.score["flight"], "lowest_altitude_after_exit": -0.003}}
    terminal.print_score(dataclasses.replace(weak_launch, score=scored))
    assert re.search(r"lowest altitude since +0\.00 ", capsys.readouterr().out)


# -- several flights -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("flights", [1, 8, 400])
def test_several_flights_fit_80_columns(capsys: pytest.CaptureFixture[str], flights: int) -> None:
    flown = batch(flights)
    terminal.print_batch(flown)
    out = capsys.readouterr().out
    assert widest(out) <= 80
    assert f"a name, {flights} flight{'' if flights == 1 else 's'}: " in out
    assert f"False detections before release: {2 * flights}" in out
    assert "a requirement that is not met: 1" in out
    lines = out.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("latency, ms"))
    sample = 1e3 * flown.runs["launch.latency"].to_numpy()
    quantiles = [quantile_band(sample, q) for q in (0.05, 0.5, 0.95)]
    values = [*(q.value for q in quantiles), sample.min()]
    assert lines[at].split()[2:] == [f"{value:.1f}" for value in values]
    assert lines[at + 1].split()[-1] == f"{sample.max():.1f}"
    for q in quantiles:
        low, high = ("" if bound is None else f"{bound:.1f}" for bound in (q.low, q.high))
        band = f"{low}…{high}" if low and high else f"≥ {low}" if low else f"≤ {high}" if high else "–"
        assert band in lines[at + 1]


def test_flights_that_misled_are_counted_of_those_that_had_an_airspeed(capsys: pytest.CaptureFixture[str]) -> None:
    flown = batch(50)
    flown.runs["airspeed.hazard"] = [1.0] * 2 + [0.0] * 38 + [np.nan] * 10
    flown.runs["airspeed.false_flags"], flown.runs["airspeed.losses"] = 0.0, 3.0
    terminal.print_batch(flown)
    out = capsys.readouterr().out
    assert "Flights with a valid airspeed 3 m/s off for 1 s: 2 (at most 16.92 %)" in out  # of 40
    assert "Flights with a false flag: 0 (at most 7.11 %)" in out
    assert "Flights with a loss of validity: 50 (at most 100.00 %)" in out


def test_figures_that_no_flight_has_are_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    flown = batch(3)
    flown.runs["launch.latency"] = np.nan
    terminal.print_batch(flown)
    out = capsys.readouterr().out
    assert not any(line.startswith("latency, ms") for line in out.splitlines())
    assert "nan" not in out
    assert "RMSE filtered, m/s" in out
    flown.runs[flown.runs.select_dtypes(float).columns] = np.nan
    terminal.print_batch(flown)
    assert "Quantiles" not in capsys.readouterr().out


def test_flights_with_a_fault_say_which(capsys: pytest.CaptureFixture[str]) -> None:
    """Beside a bound that knows of none."""
    terminal.print_batch(batch(3))
    assert "go wrong" not in capsys.readouterr().out
    faults = ('air_data.static_port.faults=[{kind="leak",start=5,stop=9}]', "duration=20")
    flown = dataclasses.replace(batch(3), scenario=load_scenario("catapult", overrides=faults))
    terminal.print_batch(flown)
    assert "Set to go wrong: static port leaking from 5 s to 9 s; √PCRB knows" in capsys.readouterr().out


def test_few_flights_come_with_the_chance_that_they_leave(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Six flights: χ²_6/6 is within 0.206 and 2.408 in 95 % (tables of χ²), an RMSE over the bound within its roots."""
    found = {"after": AgainstBound(0.040, 0.051, 0.78)}
    monkeypatch.setattr("uavsim.views.campaign.summary.against_bound", lambda _: found)
    traces = [ErrorTrace(seed, *(np.empty(0) for _ in range(3))) for seed in range(6)]
    terminal.print_batch(dataclasses.replace(batch(6), traces=traces))
    out = capsys.readouterr().out
    assert "RMSE over √PCRB later: 0.040 / 0.051 m/s = 0.78" in out
    assert f"6 flights at the bound: 95 % within {0.206**0.5:.2f} … {2.408**0.5:.2f} " in out
    assert widest(out) <= 80


# -- cost -----------------------------------------------------------------------------------------------------------


def test_the_last_line_of_a_cost_is_its_ratio(capsys: pytest.CaptureFixture[str]) -> None:
    cost = Cost(15.0, 10.0, 5.0, ratio=1.504, ratio_over_bare=3.0, steps=7, same_state=True)
    terminal.print_cost(cost, OnboardCost(mean=1.234, p99=9.87, steps=7))
    assert capsys.readouterr().out.splitlines()[-1] == "ratio 1.50"


def test_a_line_is_printed_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    line = "written to [red]output[/red]/" + "x" * 300 + " 123"
    terminal.say(line)
    assert capsys.readouterr().out == line + "\n"


def test_an_unmet_requirement_stands_in_the_headline(catapult: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    unmet = {"key": "airspeed.rmse", "minimum": None, "maximum": 1e-6, "value": 0.1, "met": False}
    terminal.print_score(Flight(catapult.scenario, catapult.tables, [], {**catapult.score, "requirements": [unmet]}))
    assert "cruise (as expected; a requirement is not met)" in capsys.readouterr().out
