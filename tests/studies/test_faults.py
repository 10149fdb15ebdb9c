"""Campaigns with faults: what is counted, and one flight of a case."""

from dataclasses import replace
from math import inf, nan

import pytest

from uavsim.beliefs import believed_air
from uavsim.scenario import load_scenario
from uavsim.studies.faults import CASES, FaultFlight, campaign, fly_case, summarise

SEEN = FaultFlight(
    seed=1, fault=10.0, flagged=10.5, recovered=nan, channel="total", kind="frozen", false=0, off=nan, climb=2.4,
    outcome="cruise", coverage=0.9, valid=8.0, error=1.5, told_coverage=0.8, told_error=1.7,
)  # fmt: skip
MISSED = replace(
    SEEN, seed=2, flagged=nan, channel="", kind="", off=12.0, coverage=nan, error=nan, told_coverage=nan, told_error=nan
)
LATE = replace(SEEN, seed=3, flagged=15.0, off=12.5, coverage=1.0, error=3.0, told_error=3.5)
WRONG = replace(SEEN, seed=4, channel="static", false=1, outcome="crashed", recovered=11.5)


def test_delays_and_what_was_unseen() -> None:
    assert [f.delay for f in (SEEN, MISSED, LATE)] == [0.5, inf, 5.0]
    assert [f.unseen for f in (SEEN, MISSED, LATE)] == [0.0, inf, 2.5]


def test_a_campaign_is_counted() -> None:
    s = summarise("blocked-gusts", [SEEN, MISSED, LATE, WRONG])
    assert (s.flights, s.within, s.seen, s.missed) == (4, 2, 2, 1)
    assert (s.blamed, s.false, s.crashed, s.recovered) == (2, 1, 1, 1)
    assert s.delays == (5.0, inf, inf)
    assert (s.coverage, s.error) == (pytest.approx((0.9 + 1.0 + 0.9) / 3), 3.0)
    assert (s.told_coverage, s.told_error) == (pytest.approx(0.8), 3.5)
    low, high = s.interval(s.within)
    assert 0.0 < low < 0.5 < high < 1.0


def test_flights_that_are_never_valid_have_no_coverage() -> None:
    """Without a static port no airspeed is valid: numpy's mean of nothing was a warning."""
    s = summarise("static-climb", [replace(SEEN, coverage=nan, error=nan)] * 2)
    assert s.coverage != s.coverage
    assert s.error != s.error
    assert (s.told_coverage, s.told_error) == (0.8, 1.7)


@pytest.mark.parametrize("seed", [2, 8])
def test_what_is_told_without_a_static_port_is_scored_though_it_is_not_valid(seed: int) -> None:
    """A static port that shuts in a climb, flown 4 s on: below 0.8 m/s off and in 4 of 5 rows within the bar.

    Nothing is valid after the flag, so that the figures of valid estimates say nothing of it.
    """
    case = replace(CASES["static-climb"], overrides=("duration=12", *CASES["static-climb"].overrides[1:]))
    found = fly_case(replace(case, window=(6.5, 7.5)), seed)
    assert (found.channel, found.kind) == ("static", "frozen")
    assert found.valid == 0.0
    assert found.error != found.error
    assert found.told_error < 0.8
    assert found.told_coverage > 0.8


def test_a_fault_that_is_flown_is_seen() -> None:
    """A sensor that sticks: 25 readings at 100 Hz."""
    case = replace(CASES["stuck"], overrides=("duration=8",), window=(6.0, 7.0))
    found = fly_case(case, 5)
    assert (found.channel, found.kind, found.false) == ("total", "stuck", 0)
    assert 0.2 < found.delay < 0.4
    assert repr(fly_case(case, 5)) == repr(found)


@pytest.mark.parametrize(("name", "flights"), [("blocked", 1), ("stuck", 0)])
def test_what_is_no_campaign(name: str, flights: int) -> None:
    with pytest.raises(ValueError, match=r"unknown case|not at least 1"):
        campaign(name, flights)


@pytest.mark.parametrize("name", [name for name in CASES if name.endswith("gusts") or name == "blocked-for-3-s"])
def test_gusts_are_of_1_m_s_where_they_are_flown(name: str) -> None:
    """Their heights and winds are the cases' own: `gusty` was lowered to 40 m, where the same wind has 1.07 m/s."""
    scenario = load_scenario(CASES[name].scenario, overrides=CASES[name].overrides)
    air = scenario.environment
    assert believed_air(scenario).aided.gust_sd == pytest.approx(1.0, abs=0.005)
    assert air.wind_speed == air.turbulence_wind_20ft
    assert air.gust_speed == 0.0
