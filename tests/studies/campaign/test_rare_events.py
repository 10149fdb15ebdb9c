"""Rare events: exactness where it is cheap to see, determinism, the budget, bad input.

Authorities: the Markov chain of `uavsim.studies.exact`, Φ(-β), OpenTURNS. Statistics over 200 repetitions are in
tests/validation/test_rare.py.
"""

import importlib.util

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from uavsim.onboard.launch import DetectorSettings
from uavsim.scenario import load_scenario
from uavsim.studies import exact
from uavsim.studies.campaign.rare import Estimate, Inputs, Watch, estimate, per_hour
from uavsim.studies.campaign.rare import subset as method
from uavsim.studies.campaign.rare.detectors import at_rest, in_stroke
from uavsim.studies.campaign.rare.flights import event_of, in_flight, located

Floats = NDArray[np.float64]

HOLD = DetectorSettings(kind="single-threshold", threshold=45.0, window=0.010)
BETA = 3.0


def same(one: Estimate, other: Estimate) -> bool:
    return (
        (one.probability, one.low, one.high, one.variation, one.work, one.steps)
        == (other.probability, other.low, other.high, other.variation, other.work, other.steps)
    ) and one.failures.tobytes() == other.failures.tobytes()


def linear(u: Floats) -> Floats:
    return BETA - u.sum(axis=1) / np.sqrt(u.shape[1])


@pytest.mark.parametrize(("mean", "power"), [(41.769, -3), (40.0574, -5), (38.6252, -7)])
def test_splitting_agrees_with_the_exact_markov_chain(mean: float, power: int) -> None:
    """One seed each: a 95 % interval of one estimate of 600, widened by half, misses by chance in less than 1 %."""
    curve = np.full(1000, mean)
    exactly = exact.hold(curve, 5.0, threshold=45.0, samples=10).probability
    assert exactly == pytest.approx(10.0**power, rel=1e-3)
    found = estimate(Watch(HOLD, curve, 5.0, push=70.0), seed=3, budget=2000)
    assert np.log(found.low / exactly) < 0.5 * np.log(found.high / found.low)
    assert np.log(exactly / found.high) < 0.5 * np.log(found.high / found.low)
    assert found.variation < 0.3
    assert found.work <= 2000


def test_a_seed_fixes_every_bit_of_splitting() -> None:
    watch = Watch(HOLD, np.full(300, 40.0), 5.0, push=70.0)
    one, other = (estimate(watch, seed=5, budget=300) for _ in range(2))
    assert same(one, other)
    assert not same(one, estimate(watch, seed=6, budget=300))


def test_what_cannot_be_reached_has_a_bound_and_says_so() -> None:
    found = estimate(Watch(HOLD, np.zeros(1000), 0.5, push=70.0), seed=1, budget=300)
    assert not found.reached
    assert found.probability == 0.0
    assert 0.0 < found.high <= 0.5


def test_subset_simulation_finds_a_linear_limit_and_what_fails_first() -> None:
    """Φ(-3) = 1.35e-3; twenty repetitions of 1000: the mean within 4 standard errors, most intervals hold it."""
    found = [estimate(Inputs(linear, 5), seed=seed, budget=1000) for seed in range(20)]
    p, exactly = np.array([one.probability for one in found]), float(ndtr(-BETA))
    assert abs(p.mean() - exactly) < 4.0 * p.std(ddof=1) / np.sqrt(20)
    assert sum(one.low <= exactly <= one.high for one in found) >= 16
    assert all(one.work <= 1000 for one in found)
    nearest = found[0].failures[0]
    assert BETA <= np.sqrt(nearest @ nearest) < BETA + 1.0
    assert linear(found[0].failures).max() <= 0.0


def test_a_seed_fixes_every_bit_of_subset_simulation() -> None:
    one, other = (estimate(Inputs(linear, 5), seed=8, budget=1000) for _ in range(2))
    assert same(one, other)


def test_many_inputs_are_left_to_subset_simulation() -> None:
    found = estimate(Inputs(linear, 100), seed=1, budget=2000)
    assert found.method == "subset simulation"
    assert 2e-4 < found.probability < 8e-3


def test_an_index_is_kept_or_drawn_anew() -> None:
    """A third of the variance is noise that the index draws without any order: still Φ(-3); 4 standard errors of 10."""

    def margins(u: Floats) -> Floats:
        noise = ndtri(np.clip(np.modf(1e6 * ndtr(u[:, -1]))[0], 1e-12, 1.0 - 1e-12))
        return BETA - np.sqrt(2.0 / 3.0) * u[:, :-1].sum(axis=1) / np.sqrt(5.0) - np.sqrt(1.0 / 3.0) * noise

    found = [estimate(Inputs(margins, 6, whole=1), seed=seed, budget=2000).probability for seed in range(10)]
    assert abs(np.mean(found) - ndtr(-BETA)) < 4.0 * np.std(found, ddof=1) / np.sqrt(10)
    assert np.std(found) < 0.7 * ndtr(-BETA)


def test_margins_that_are_all_alike_end_at_once() -> None:
    found = estimate(Inputs(lambda u: np.ones(len(u)), 3), seed=1, budget=600)
    assert not found.reached
    assert found.work < 300


def test_bad_input_is_one_line() -> None:
    with pytest.raises(ValueError, match="budget must be at least 200"):
        estimate(Inputs(linear, 5), budget=100)
    with pytest.raises(ValueError, match="seed must be at least 0"):
        estimate(Inputs(linear, 5), seed=-1)
    with pytest.raises(ValueError, match="0 inputs"):
        Inputs(linear, 0)
    with pytest.raises(ValueError, match="2 names for 5 inputs"):
        Inputs(linear, 5, names=("a", "b"))
    with pytest.raises(ValueError, match="shape"):
        estimate(Inputs(lambda u: u, 5), budget=1000)
    with pytest.raises(ValueError, match="at least one sample"):
        Watch(HOLD, np.array([np.nan]), 1.0)
    with pytest.raises(ValueError, match="sigma and rate"):
        Watch(HOLD, np.zeros(5), 0.0)
    with pytest.raises(ValueError, match=r"does not recognise 20 m/s² in 400 samples"):
        estimate(Watch(HOLD, np.zeros(100), 1.0, push=20.0))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("timeout", "no number in a score"),
        ("nonsense", "must be crashed"),
        ("flight.nothing<=3", "is no number of a score"),
        ("flight.duration<=nan", "not a finite number"),
    ],
)
def test_an_event_that_is_none_is_one_line(text: str, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        event_of(text)


def test_margins_of_flights() -> None:
    late = {
        "outcome": "cruise",
        "flight.rail_exit_time": 2.0,
        "launch.detected_time": 1.9,
        "flight.lowest_altitude_after_exit": 3.0,
    }
    assert event_of("missed_launch").margin(late) == pytest.approx(0.6)
    assert event_of("crashed").margin(late) == pytest.approx(3.0)
    assert event_of("crashed").margin({"outcome": "crashed"}) == 0.0
    assert event_of("flight.rail_exit_time>=2.5").margin(late) == pytest.approx(0.5)
    assert event_of("flight.rail_exit_time <= 1.5").margin(late) == pytest.approx(0.5)
    assert np.isnan(event_of("airspeed.rmse>=1").margin(late))


def test_a_scenario_without_dispersions_is_refused() -> None:
    with pytest.raises(ValueError, match=r"has no \[\[dispersions\]\]"):
        in_flight(load_scenario("launch-curve"), event_of("crashed"), lambda *_: ())


def test_the_middle_of_the_inputs_is_the_middle_of_the_cube() -> None:
    points, indices = located(np.zeros((1, 3)))
    assert points.tolist() == [[0.5, 0.5]]
    assert indices == [2**30]


def test_a_rate_at_rest() -> None:
    assert per_hour(1e-6, 3600.0) == pytest.approx(1e-6)
    assert per_hour(1.0, 1.0) == np.inf


def test_a_detector_at_rest_is_split_where_it_can_be() -> None:
    scenario = load_scenario("catapult")
    watch = at_rest(scenario, sigma=2.0)
    assert isinstance(watch, Watch)
    assert watch.mean[0] == pytest.approx(9.80665 * np.sin(np.radians(scenario.launcher.elevation_deg)))
    assert watch.mean.size == 5.0 * watch.rate


@pytest.mark.slow
def test_a_stroke_is_missed_as_often_as_by_plain_counting() -> None:
    """Plain Monte Carlo of 4000 draws on the same margins: binomial, 3 standard errors."""
    scenario = load_scenario("weak-launch", overrides=["detector.kind=single-threshold", "detector.threshold=50"])
    problem = in_stroke(scenario, sigma=4.0)
    u = np.random.default_rng(1).standard_normal((4000, problem.dimension))
    share = float(np.mean(problem.margins(u) <= 0.0))
    found = estimate(problem, seed=1, budget=4000)
    assert abs(found.probability - share) < 3.0 * np.hypot(found.probability * found.variation, np.sqrt(share / 4000))


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("openturns") is None, reason="openturns is not installed")
@pytest.mark.parametrize("curvature", [0.0, 0.1])
def test_subset_simulation_agrees_with_openturns(curvature: float) -> None:
    """Ours and theirs on a linear and a parabolic limit of two inputs, 20 runs each, 4 standard errors apart at most.

    The linear one is Φ(-4); the parabolic one is ∫ φ(v) Φ(-4 - c v²) dv, by quadrature.
    """
    import openturns as ot
    from scipy.integrate import quad

    beta, runs = 4.0, 20
    exactly, _ = quad(lambda v: np.exp(-0.5 * v * v) / np.sqrt(2 * np.pi) * ndtr(-beta - curvature * v * v), -10, 10)

    def margins(u: Floats) -> Floats:
        return beta + curvature * u[:, 1] ** 2 - u[:, 0]

    ours = [method.run(margins, 2, np.random.SeedSequence(seed), 1000, 20_000).probability for seed in range(runs)]
    function = ot.PythonFunction(2, 1, func_sample=lambda x: margins(np.asarray(x))[:, np.newaxis])
    limit = ot.ThresholdEvent(ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(2))), ot.LessOrEqual(), 0.0)
    theirs = []
    for seed in range(runs):
        ot.RandomGenerator.SetSeed(seed)
        algorithm = ot.SubsetSampling(limit)
        algorithm.setMaximumOuterSampling(1000)
        algorithm.setBlockSize(1)
        algorithm.run()
        theirs.append(algorithm.getResult().getProbabilityEstimate())
    p, q = np.array(ours), np.array(theirs)
    error = np.hypot(p.std(ddof=1), q.std(ddof=1)) / np.sqrt(runs)
    assert abs(p.mean() - q.mean()) < 4.0 * error
    assert abs(p.mean() - exactly) < 4.0 * p.std(ddof=1) / np.sqrt(runs)


def test_whole_flights_on_their_dispersions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rail exit speed is normal with 20 ± 1 m/s in the first dispersion: P(at most 17) = Φ(-3)."""
    from uavsim import dispersions
    from uavsim.studies.campaign.rare.asked import of_flights

    scenario = load_scenario("catapult")
    monkeypatch.setattr(dispersions, "keys", lambda _: ("launcher.force", "aircraft.mass"))
    monkeypatch.setattr(dispersions, "drawn", lambda _, index, point: {"force": point[0], "mass": point[1]})

    def fly(points: Floats, indices: object) -> list[dict[str, object]]:
        return [{"outcome": "cruise", "flight.rail_exit_speed": 20.0 + v} for v in ndtri(points[:, 0])]

    told: list[float] = []
    found = of_flights(scenario, "flight.rail_exit_speed<=17", fly, seed=4, budget=1500, progress=told.append)
    assert found.estimate.low < ndtr(-3.0) < found.estimate.high
    assert found.estimate.variation < 0.3
    assert told[-1] == pytest.approx(1.0)
    first = found.failures[0]
    assert set(first) == {"distance", "index", "force", "mass"}
    assert first["force"] <= ndtr(-3.0)
    assert [one["distance"] for one in found.failures] == sorted(one["distance"] for one in found.failures)
