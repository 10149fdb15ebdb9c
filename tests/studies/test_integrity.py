"""Integrity: stated rates times what flights showed, by hand; files of rates that cannot be; a fault that misleads."""

from dataclasses import replace
from pathlib import Path

import pytest

from uavsim.studies.integrity import PACKAGED, FaultClass, Rates, Seen, combine, fly_one, read_rates, seen
from uavsim.studies.intervals import rate_interval, share_interval

RIGHT = Seen(hazard=False, flags=1, false_flags=0, losses=1, hours=0.01)
HAZARD = replace(RIGHT, hazard=True)
UNSEEN = replace(HAZARD, flags=1, false_flags=1)
HEALTHY = Seen(hazard=False, flags=0, false_flags=0, losses=0, hours=0.01)
HOURLY = FaultClass("port", 1e-3, "hour", "assumed")
ALREADY = FaultClass("cover", 2e-3, "flight", "assumed")
RATES = Rates(flight_hours=0.5, classes=(HOURLY, ALREADY))


def test_the_hazard_of_a_flight_is_the_sum_of_rates_times_missed() -> None:
    """1e-3/h for 0.5 h with 1 of 4, and 2e-3 a flight with 3 of 4: 1.25e-4 and 1.5e-3."""
    found = combine(RATES, [[HAZARD, RIGHT, RIGHT, RIGHT], [HAZARD, UNSEEN, HAZARD, RIGHT]], [HEALTHY] * 50)
    assert [one.per_flight.value for one in found.classes] == pytest.approx([1.25e-4, 1.5e-3])
    assert found.per_flight.value == pytest.approx(1.25e-4 + 1.5e-3, rel=1e-3)  # two at once are 2e-7
    assert found.per_hour.value == pytest.approx(2.0 * found.per_flight.value)
    assert [(one.hazards, one.flagged) for one in found.classes] == [(1, 4), (3, 3)]


def test_the_bounds_of_the_total_hold_for_all_classes_at_once() -> None:
    found = combine(RATES, [[RIGHT] * 20, [HAZARD] * 20], [HEALTHY] * 50)
    upper = share_interval(0, 20, 0.975)[1]  # α/2 for each of two classes
    lower = share_interval(20, 20, 0.975)[0]
    assert found.per_flight.high == pytest.approx(5e-4 * upper + 2e-3, rel=1e-3)
    assert found.per_flight.low == pytest.approx(2e-3 * lower)
    assert found.classes[0].given.high == pytest.approx(share_interval(0, 20)[1])  # its own
    assert found.classes[0].given.high < upper


def test_flights_without_a_fault_have_their_own_rates() -> None:
    odd = replace(HEALTHY, flags=2, false_flags=2, losses=1)
    found = combine(RATES, [[RIGHT], [RIGHT]], [odd, *[HEALTHY] * 49])
    assert found.hours == pytest.approx(0.5)
    assert found.counts == {"hazards": 0, "false_flags": 2, "losses": 1}
    assert found.healthy["false_flags"].value == pytest.approx(4.0)
    assert (found.healthy["hazards"].low, found.healthy["hazards"].high) == pytest.approx(rate_interval(0, 0.5))


def test_a_rate_is_no_more_than_certain() -> None:
    often = Rates(flight_hours=10.0, classes=(replace(HOURLY, rate=5.0),))
    assert combine(often, [[HAZARD]], [HEALTHY]).per_flight.value == 1.0


def test_every_shipped_class_flies_and_says_where_its_rate_is_from() -> None:
    rates = read_rates()
    assert len(rates.classes) >= 10
    assert all(one.source.startswith("assumption") for one in rates.classes)
    assert {one.per for one in rates.classes} == {"hour", "flight"}


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (("rate = 5e-4", "rate = -1.0"), "classes[0].rate = -1.0"),
        (('per = "hour"', 'per = "year"'), "classes[0].per = 'year'"),
        (("rate = 1e-3", "rate = 3.0"), "per flight it is a probability"),
        (('source = "assumption: water', 'sauce = "assumption: water'), "sauce"),
        (("fault = 'kind=\"blocked\"'", "fault = ''"), "where and fault come together"),
        (('"duration=25"', '"durration=25"'), "durration"),
        (('kind="blocked"', 'kind="clogged"'), "clogged"),
        (("begins = [9.5, 14.0]", "begins = [14.0, 9.5]"), "begins: must be two times"),
        (('name = "total port shut, still air"', 'name = "total port shut, gusts"'), "two of that name"),
        (('scenario = "gusty"', 'scenario = "gustyy"'), "gustyy"),
        (("flight_hours = 0.5", "flight_hours = 0.0"), "flight_hours"),
    ],
)
def test_a_file_of_rates_that_cannot_be_is_refused_in_one_line(
    tmp_path: Path, change: tuple[str, str], problem: str
) -> None:
    file = tmp_path / "rates.toml"
    text = PACKAGED.read_text(encoding="utf-8")
    assert change[0] in text
    file.write_text(text.replace(*change, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=r"rates\.toml: ") as told:
        read_rates(file)
    assert problem in str(told.value)
    assert "\n" not in str(told.value)


def test_a_flight_with_a_fault_tells_what_it_did() -> None:
    """A total sensor that hangs at 32 m/s in a climb of the airspeed: the flight's own score, no more."""
    case = replace(HOURLY, overrides=("duration=10",), where="air_data.total.faults", fault='kind="stuck"').case
    found = fly_one(replace(case, window=(7.0, 7.0)), 5)
    assert (found.flags >= 1, found.false_flags, found.hazard) == (True, 0, False)
    assert found.hours == pytest.approx(7.0 / 3600.0, rel=0.15)
    assert seen({
        "airspeed": {"hazard": None, "flags": 0, "false_flags": 0, "losses": None},
        "launch": {"true_time": None}, "flight": {"duration": 3.0},
    }) == Seen(hazard=False, flags=0, false_flags=0, losses=0, hours=0.0)  # fmt: skip
