"""The measure of a step: the reference is the same flight, flown from its tape of commands. No times are tested."""

import pytest

from uavsim.cosim import Cosimulation, draw, plant_settings
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.scenario import load_scenario
from uavsim.studies import bench
from uavsim.studies.bench import Cost, measure

SHORT = load_scenario("catapult", overrides=["duration=6.3"])  # not a whole number of chunks


@pytest.fixture(scope="module")
def measured() -> tuple[Cost, list[float]]:
    shares: list[float] = []
    return measure(SHORT, progress=shares.append), shares


def test_the_reference_is_the_same_flight(measured: tuple[Cost, list[float]]) -> None:
    assert measured[0].same_state
    assert measured[0].steps == 6300


def test_progress_goes_to_the_end(measured: tuple[Cost, list[float]]) -> None:
    shares = measured[1]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) == 13


def test_ratios_are_of_the_same_kind_as_the_times(measured: tuple[Cost, list[float]]) -> None:
    result = measured[0]
    assert min(result.in_loop, result.reference, result.bare, result.ratio, result.ratio_over_bare) > 0.0
    assert result.in_loop / result.reference == pytest.approx(result.ratio, rel=0.5)
    assert result.in_loop / result.bare == pytest.approx(result.ratio_over_bare, rel=0.5)


def test_the_tape_replays_the_flight() -> None:
    """Commands given at the same steps to a plant without sensors: the same row at each step, the throttle included."""
    leader = bench._TapedPlant(SHORT)
    loop = Cosimulation(SHORT, plant=leader)
    while not loop.ended:
        loop.advance(1000)
    assert len(leader.tape) > 50
    follower = JsbsimPlant(plant_settings(SHORT, draw(SHORT)))
    bench._follow(follower, leader.k, leader.tape, follower.step)
    assert follower.k == leader.k
    assert follower.row == leader.row
    flown, followed = leader.truth(), follower.truth()
    assert all((flown[name] == followed[name]).all() for name in flown)


def test_a_tape_that_acts_a_step_late_is_another_flight() -> None:
    """Without this the test above could not fail."""
    leader = bench._TapedPlant(SHORT)
    loop = Cosimulation(SHORT, plant=leader)
    while not loop.ended:
        loop.advance(1000)
    late = [(min(k + 1, leader.k), commands) for k, commands in leader.tape]
    follower = JsbsimPlant(plant_settings(SHORT, draw(SHORT)))
    bench._follow(follower, leader.k, late, follower.step)
    assert follower.row != leader.row


def test_a_flight_that_ends_early_is_not_measured() -> None:
    crashing = load_scenario("weak-launch", overrides=["duration=10"])
    with pytest.raises(ValueError, match=r"weak-launch: the flight ends at .* \(touched\); nothing to compare"):
        measure(crashing, progress=lambda _: None)


def test_the_onboard_cost_is_of_a_flight_at_1_khz(monkeypatch: pytest.MonkeyPatch) -> None:
    """Detector and estimator see the launch and all readings; a percentile of single steps is above half the mean."""
    flown: list[bool] = []
    run = bench._run

    def watched(*given: object) -> float:
        flown.append(True)
        return run(*given)

    monkeypatch.setattr(bench, "_run", watched)
    found = bench.measure_onboard(SHORT)
    assert len(flown) == 2 * bench.REPEATS
    assert found.steps == pytest.approx(6300, rel=0.05)  # the part's own clock
    assert 0.0 < 0.5 * found.mean < found.p99


def test_a_step_that_records_nothing_flies_the_same() -> None:
    """Through the latch, the push and half a second beyond the rail: the next row is that of the plant that records."""
    launch = draw(SHORT)
    steps = round((launch.release_time + 0.9) * 1000.0)
    one, other = (JsbsimPlant(plant_settings(SHORT, launch)) for _ in range(2))
    for _ in range(steps):
        one.step()
        other.step_unrecorded()
    assert not one.on_rail
    assert (other.k, other.t, other.on_rail) == (one.k, one.t, one.on_rail)
    one.step()
    other.step()
    assert other.row == one.row
