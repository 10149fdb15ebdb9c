"""Flights with a differential sensor in the head: believed, watched and flown as the pair is."""

from pathlib import Path

import numpy as np
import pytest

import uavsim
from uavsim.cosim import replay
from uavsim.flight import Flight
from uavsim.part_range import fastest_read, remark
from uavsim.scenario import load_scenario

KIND = "air_data.kind=differential"


def fly(*given: str, seed: int = 41, scenario: str = "catapult") -> Flight:
    return uavsim.fly(scenario, seed=seed, overrides=[KIND, *given])


def faults(flight: Flight) -> list[tuple[str, str]]:
    return [(e["channel"], e.get("kind", "")) for e in flight.events if e["event"] == "airspeed_fault"]


@pytest.mark.parametrize("part", ["ms4525do", "ms4525do-005d", "dlvr-l10d", "sdp33"])
def test_each_part_flies_and_its_bar_holds_its_error(part: str, tmp_path: Path) -> None:
    """Seed 41. The thermal part's 3 % of the difference are 0.5 m/s, in the error and in the bar."""
    flight = fly(f"air_data.differential.preset={part}", "duration=9", "air_data.pipe=0.1")

    assert faults(flight) == []
    air = flight.score["airspeed"]
    assert air["transition"]["valid_fraction"] == 1.0
    assert air["cruise"]["rmse"] < (1.3 if part == "sdp33" else 0.25)
    estimate = flight.estimate[flight.estimate["t"] > flight.score["launch"]["true_time"] + 1.0]
    true = np.interp(estimate["t"], flight.truth["t"], flight.truth["airspeed"])
    assert (np.abs(estimate["airspeed"] - true) < 4.0 * estimate["airspeed_sd"]).all()
    assert replay(uavsim.load(flight.save(tmp_path / "flight"))).estimate.equals(flight.estimate)


def test_thin_air_is_undone_and_left_alone_it_is_17_per_cent_of_the_airspeed() -> None:
    """3000 m: √(966/701) of the airspeed that a thermal part's own reading gives (Sensirion; the issue's figure)."""
    given = (
        "air_data.differential.preset=sdp33", "air_data.differential.unit=ideal", "air_data.static.unit=ideal",
        "environment.ground_elevation=3000", "duration=7", "estimator.kind=paper",
    )  # fmt: skip
    for kept, factor in ((1.0, 1.0), (0.0, np.sqrt(701.1 / 966.0))):
        flight = fly(*given, f"mismatch.flow_through={kept}")
        late = flight.estimate[flight.estimate["t"] > flight.score["flight"]["rail_exit_time"] + 1.0]
        true = np.interp(late["t"], flight.truth["t"], flight.truth["airspeed"])
        assert np.median(late["airspeed_raw"] / true) == pytest.approx(factor, abs=0.008)


def test_swapped_tubes_end_in_no_airspeed_rather_than_a_wrong_one() -> None:
    """Flagged by name in the stroke; from 0.3 s after the launch on no valid airspeed is 3 m/s off."""
    flight = fly("air_data.differential.polarity=reversed", "duration=9")
    assert faults(flight) == [("total", "swapped")]
    estimate, launch = flight.estimate, flight.score["launch"]["true_time"]
    true = np.interp(estimate["t"], flight.truth["t"], flight.truth["airspeed"])
    wrong = (estimate["t"] > launch + 0.3) & estimate["valid"] & (np.abs(estimate["airspeed"] - true) > 3.0)
    assert not wrong.any()


def test_a_static_sensor_that_dies_costs_the_difference_nothing() -> None:
    """It is named; the airspeed of the difference, with the density of before, stays valid and right."""
    flight = fly('air_data.static.faults=[{kind="invalid",start=7}]', "duration=12")
    assert faults(flight) == [("static", "invalid")]
    late = flight.estimate[flight.estimate["t"] > 8.0]
    true = np.interp(late["t"], flight.truth["t"], flight.truth["airspeed"])
    assert late["valid"].all()
    assert np.abs(late["airspeed"] - true).max() < 0.5


def test_a_stuck_difference_is_known_by_its_own_number() -> None:
    """The row's total pressure moves with the static sensor's noise all the while."""
    flight = fly('air_data.differential.faults=[{kind="stuck",start=7}]', "duration=9")
    assert faults(flight) == [("total", "stuck")]


def test_where_readings_end_is_said_at_the_start() -> None:
    """1500 Pa: 48 m/s at sea level, by the part's page; a pair of BMP390 ends at 125 kPa, Mach 0.56."""
    sdp33 = [KIND, "air_data.differential.preset=sdp33"]
    fast = load_scenario("catapult", overrides=[*sdp33, "flight_computer.airspeed=46"])
    assert fastest_read(fast) == pytest.approx(48.2, abs=0.1)
    assert remark(fast) == [
        "air_data.differential.preset = 'sdp33' ends at 48 m/s in the air of the field, and flight_computer.airspeed = "
        "46 m/s is to be held: beyond its end there is no airspeed"
    ]
    assert remark(load_scenario("catapult", overrides=sdp33)) == []
    assert fastest_read(load_scenario("catapult")) == pytest.approx(0.5562 * 340.3, rel=2e-3)
    assert remark(load_scenario("wind-tunnel", overrides=[*sdp33, "flight_computer.airspeed=60"])) == []


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("air_data.total.preset=sdp33", "preset 'sdp33' is a differential pressure sensor, not a pressure sensor"),
        ("air_data.differential.faults=[{kind='stuck'}]", "a head of air_data.kind = 'absolute' has no such sensor"),
        ("air_data.kind=relative", "air_data.kind"),
    ],
)
def test_what_does_not_go_with_the_kind_is_one_line(given: str, said: str) -> None:
    with pytest.raises(ValueError, match=said) as caught:
        load_scenario("catapult", overrides=[given])
    assert "\n" not in str(caught.value)


def test_faults_of_the_sensor_that_is_not_there_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"air_data\.total\.faults: a head of air_data\.kind = 'differential' has no such"
    ):
        load_scenario("catapult", overrides=[KIND, "air_data.total.faults=[{kind='stuck'}]"])


def test_the_budget_of_a_differential_part_is_of_its_difference_alone() -> None:
    """At 30 m/s: 1.5 Pa/(ρV) = 0.041 m/s of noise, whatever the barometer has; 3 % of a thermal part make 0.45 m/s."""
    from uavsim.studies.error_budget import of_scenario

    def terms(*given: str) -> dict[str, float]:
        found = of_scenario(load_scenario("catapult", overrides=[KIND, *given]), (30.0,))
        return {name: float(sd[0]) for name, sd in found.terms.items()}

    plain, noisy = terms(), terms("air_data.static.noise_scale=3")
    assert plain["noise"] == pytest.approx(1.5 / (1.2264 * 30.0), rel=0.01)
    assert noisy["noise"] == pytest.approx(plain["noise"], rel=0.02)
    assert {name: noisy[name] for name in ("tare", "drift", "warming")} == pytest.approx(
        {name: plain[name] for name in ("tare", "drift", "warming")}
    )
    assert terms("air_data.differential.preset=sdp33")["position"] == pytest.approx(0.5 * 0.03 * 30.0, rel=0.01)
