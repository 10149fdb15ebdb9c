"""The Neyman-Pearson bound against published deadlines, closed forms, simulation and detectors that it must bound."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import beta, norm

from uavsim.studies.exact import multi_level_window, sliding_window
from uavsim.studies.neyman_pearson import detection_probability, earliest_deadline

T = np.arange(101) * 1e-3  # s
G = 9.80665  # m/s²
RAIL = 0.34  # g; gravity along a rail of 20°


def trapezoid(peak: float) -> np.ndarray:
    """0.1 s, 20 ms of rise and of fall."""
    return peak * np.clip(np.minimum(T, 0.1 - T) / 0.02, 0.0, 1.0) + RAIL


def half_sine(peak: float) -> np.ndarray:
    return peak * np.sin(np.pi * T / 0.1) + RAIL


PEAKS = (5.0, 6.0, 7.0, 10.0, 15.0)  # g
DEADLINES = [  # ms, of a numerical study made before this one and apart from it; None: impossible
    (trapezoid, 0.05, (17, 14, 12, 9, 6)),
    (trapezoid, 0.3, (21, 18, 16, 11, 8)),
    (trapezoid, 1.0, (51, 27, 22, 16, 11)),
    (trapezoid, 3.0, (None, None, 60, 27, 18)),
    (half_sine, 0.05, (30, 24, 20, 14, 9)),
    (half_sine, 0.3, (39, 31, 26, 18, 12)),
    (half_sine, 1.0, (None, 45, 37, 25, 17)),
    (half_sine, 3.0, (None, None, None, 42, 28)),
]


@pytest.mark.parametrize(("shape", "sigma", "expected"), DEADLINES)
def test_the_table_of_deadlines(
    shape: Callable[[float], np.ndarray], sigma: float, expected: tuple[int | None, ...]
) -> None:
    """P_D 0.99 at P_FA 1e-6 against a sustained 4.1 g: every one of the 40 entries, to the sample of 1 ms."""
    for peak, milliseconds in zip(PEAKS, expected, strict=True):
        deadline = earliest_deadline(shape(peak) * G, level=4.1 * G, sigma=sigma * G)
        assert deadline == (None if milliseconds is None else pytest.approx(1e-3 * milliseconds, abs=1e-9))


@pytest.mark.parametrize("false_alarm", [1e-9, 1e-3, 0.3])
def test_a_constant_shift_has_its_closed_form(false_alarm: float) -> None:
    """Kay II, 3.7: after N samples P_D = Q(Q⁻¹(P_FA) - √N·A/σ); to 1e-12."""
    shift, sigma, n = 0.7, 2.0, np.arange(1, 81)
    expected = norm.sf(norm.isf(false_alarm) - np.sqrt(n) * shift / sigma)
    bound = detection_probability(np.full(80, 5.0 + shift), level=5.0, sigma=sigma, false_alarm=false_alarm)
    np.testing.assert_allclose(bound, expected, rtol=1e-12, atol=1e-12)


def test_nothing_can_be_told_before_the_level() -> None:
    bound = detection_probability(np.array([0.0, 3.0, 4.0]), level=4.0, sigma=0.1, false_alarm=1e-3)
    np.testing.assert_allclose(bound, 1e-3, rtol=1e-12)


def _inside(successes: int, trials: int, probability: float, error: float) -> bool:
    """Whether the Clopper-Pearson interval holds the probability; neither 0 nor all may succeed."""
    low = beta.ppf(error / 2.0, successes, trials - successes + 1)
    high = beta.ppf(1.0 - error / 2.0, successes + 1, trials - successes)
    return bool(low <= probability <= high)


@pytest.mark.parametrize(("shape", "seed"), [(trapezoid, 1), (half_sine, 2)])
def test_the_likelihood_ratio_reaches_it_in_simulation(shape: Callable[[float], np.ndarray], seed: int) -> None:
    """40 000 draws each of the 5 g launch and of the load that follows it up to 4.1 g, σ = 3 g, P_FA = 0.01.

    Decisions by Σ(x - s₀)(s - s₀) after 35 and 60 ms: both rates inside 99 % Clopper-Pearson bands; 8 comparisons in
    all fail by chance in 8 %, seeds fixed. A P_D that is wrong by 0.01 is caught in nine of ten runs.
    """
    launch = shape(5.0)
    load = np.minimum(launch, 4.1)
    noise = 3.0 * np.random.default_rng(seed).standard_normal((40_000, T.size))
    bound = detection_probability(launch, level=4.1, sigma=3.0, false_alarm=0.01)
    for k in (35, 60):
        weights = (launch - load)[: k + 1]
        threshold = norm.isf(0.01) * 3.0 * np.linalg.norm(weights)
        false = int((noise[:, : k + 1] @ weights > threshold).sum())
        found = int(((noise + launch - load)[:, : k + 1] @ weights > threshold).sum())
        assert _inside(false, 40_000, 0.01, 0.01)
        assert _inside(found, 40_000, float(bound[k]), 0.01)


@pytest.mark.parametrize("sigma", [0.3, 1.0])
@pytest.mark.parametrize("peak", [5.0, 6.0, 10.0])
@pytest.mark.parametrize("shape", [trapezoid, half_sine])
def test_no_window_detector_is_better(shape: Callable[[float], np.ndarray], peak: float, sigma: float) -> None:
    """By exact chains on both sides: at the false alarms that each has on min(s, L), none exceeds the bound."""
    launch = shape(peak)
    load = np.minimum(launch, 4.1)
    for threshold in (4.1, 4.6, 5.2):
        for find, more in ((multi_level_window, {"levels": 4}), (sliding_window, {})):
            found, false = (
                find(curve, sigma, threshold=threshold, samples=8, ratio=0.8, **more).cumulative
                for curve in (launch, load)
            )
            for k in range(10, T.size, 10):
                if 0.0 < false[k] < 1.0:
                    best = detection_probability(launch, level=4.1, sigma=sigma, false_alarm=float(false[k]))[k]
                    assert found[k] <= best + 1e-12


def test_a_wanted_probability_is_reached_at_the_deadline_and_not_before() -> None:
    curve = half_sine(7.0)
    bound = detection_probability(curve, level=4.1, sigma=0.5, false_alarm=1e-4)
    for probability in (0.5, 0.9, 0.999):
        deadline = earliest_deadline(
            curve, level=4.1, sigma=0.5, probability=probability, false_alarm=1e-4, period=0.01
        )
        assert deadline is not None
        k = round(deadline / 0.01)
        assert bound[k - 1] < probability <= bound[k]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"curve": np.array([])}, "at least one value"),
        ({"curve": np.array([1.0, np.nan])}, "finite"),
        ({"level": np.inf}, "finite"),
        ({"sigma": 0.0}, "sigma"),
        ({"false_alarm": 1.0}, "false_alarm"),
        ({"probability": 0.0}, "probability"),
        ({"period": 0.0}, "period"),
    ],
)
def test_bad_input_is_refused(changes: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"curve": np.ones(3), "level": 0.5, "sigma": 1.0} | changes
    with pytest.raises(ValueError, match=message):
        earliest_deadline(arguments.pop("curve"), **arguments)  # type: ignore[arg-type]
