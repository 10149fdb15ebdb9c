"""Exact chains against every pattern there is, against the onboard detector in noise, and against closed forms."""

import doctest
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest
from scipy.stats import beta, binom

from uavsim.onboard.launch import (
    Detector,
    DoubleThreshold,
    MultiLevelWindow,
    SequenceWindow,
    SingleThreshold,
    SlidingWindow,
    ThresholdWindow,
)
from uavsim.studies import exact

G = 9.80665  # m/s²
MS = 1e-3  # s


def ring(samples: int = 60) -> np.ndarray:
    """Plateau of 1 with a decaying structural ring that starts with it; the least launch-like reading of Table 2."""
    t = np.arange(samples) * MS
    return np.minimum(t / 0.003, 1.0) * (1.0 + 0.5 * np.exp(-t / 0.05) * np.cos(2 * np.pi * 120 * t + 7 * np.pi / 4))


def first_passage(readings: list[float], detector: Detector) -> tuple[int, int] | None:
    """Sample and level at which the onboard detector recognises."""
    detector.reset()
    for k, fx in enumerate(readings):
        if detector.step(k * MS, fx, 0.0, -G):
            return k, detector.level
    return None


def test_examples() -> None:
    result = doctest.testmod(exact)
    assert result.attempted > 0
    assert result.failed == 0


# ---- every pattern

SYMBOLS = list(product(range(3), repeat=8))  # below G2, between G2 and G1, above G1

TINY = [  # n, i, k₁, re-arm
    (1, 1, 1.0, True),
    (1, 3, 0.5, True),
    (2, 2, 0.75, True),
    (2, 2, 0.75, False),
    (3, 1, 0.6, True),
    (3, 2, 0.8, True),
    (2, 4, 0.8, True),
    (4, 2, 0.55, False),
]


@pytest.mark.parametrize(("samples", "levels", "ratio", "rearm"), TINY)
def test_nested_windows_sum_over_all_patterns(samples: int, levels: int, ratio: float, rearm: bool) -> None:
    """3⁸ sequences of below G2, between G2 and G1, above G1, each through the onboard detector; to 1e-12."""
    curve, sigma = np.random.default_rng(1).uniform(3.0, 6.0, 8), 1.3
    trigger, threshold = 5.0, 4.0
    settings = {"samples": samples, "levels": levels, "ratio": ratio, "rearm": rearm}
    detector = MultiLevelWindow(trigger=trigger, threshold=threshold, **settings)  # type: ignore[arg-type]
    high = exact.exceedance(curve, sigma, trigger)
    above = exact.exceedance(curve, sigma, threshold)
    share = np.stack([1.0 - above, above - high, high])
    expected = np.zeros((8, levels))
    for pattern in SYMBOLS:
        passage = first_passage([(0.0, 4.5, 9.0)[symbol] for symbol in pattern], detector)
        if passage is not None:
            expected[passage[0], passage[1] - 1] += share[pattern, range(8)].prod()
    result = exact.multi_level_window(curve, sigma, trigger=trigger, threshold=threshold, **settings)  # type: ignore[arg-type]
    np.testing.assert_allclose(result.mass, expected, rtol=0.0, atol=1e-12)
    assert 0.1 < result.probability <= 1.0  # there is something to compare


@pytest.mark.parametrize(
    ("samples", "ratio"), [(1, 1.0), (3, 0.6), (4, 0.25), (4, 0.5), (5, 0.8), (6, 0.55), (7, 1.0), (10, 0.7)]
)
def test_sliding_windows_sum_over_all_patterns(samples: int, ratio: float) -> None:
    """2¹² sequences by the definition: ratio·n or more of the last n above; to 1e-12."""
    curve, sigma = np.random.default_rng(2).uniform(3.0, 6.0, 12), np.linspace(0.5, 2.0, 12)
    above = exact.exceedance(curve, sigma, 4.5)
    patterns = np.array(list(product((0, 1), repeat=12)))
    weights = np.where(patterns == 1, above, 1.0 - above).prod(axis=1)
    padded = np.cumsum(np.hstack([np.zeros((len(patterns), samples), dtype=int), patterns]), axis=1)
    enough = padded[:, samples:] - padded[:, :-samples] >= ratio * samples - 1e-9
    first = np.where(enough.any(axis=1), enough.argmax(axis=1), 12)
    expected = np.bincount(first, weights=weights, minlength=13)[:12]
    result = exact.sliding_window(curve, sigma, threshold=4.5, samples=samples, ratio=ratio)
    np.testing.assert_allclose(result.mass[:, 0], expected, rtol=0.0, atol=1e-12)


def _sequence_by_definition(pattern: tuple[int, ...], samples: int, ratio: float, sequence: int) -> int | None:
    """Sample that recognises: a row above G1 opens, and ratio·n of the n samples from its first on are above G2."""
    k = row = 0
    while k < len(pattern):
        row = row + 1 if pattern[k] == 2 else 0
        if row == sequence:
            window = pattern[k + 1 - sequence : k + 1 - sequence + samples]
            k += samples - sequence
            row = 0
            if k < len(pattern) and sum(symbol > 0 for symbol in window) >= ratio * samples - 1e-9:
                return k
        k += 1
    return None


def _hold_by_definition(pattern: tuple[int, ...], samples: int) -> int | None:
    """Sample that ends the first stretch of n of which the first is above G1 and all are above G2."""
    for k in range(samples - 1, len(pattern)):
        stretch = pattern[k - samples + 1 : k + 1]
        if stretch[0] == 2 and min(stretch) > 0:
            return k
    return None


@pytest.mark.parametrize(
    ("samples", "ratio", "sequence"),
    [
        (1, 1.0, 1),
        (3, 0.6, 1),
        (3, 0.6, 2),
        (4, 0.75, 2),
        (5, 0.6, 3),
        (4, 1.0, 4),
        (None, 1, 1),
        (None, 3, 1),
        (None, 5, 1),
    ],
)
def test_rows_and_holds_sum_over_all_patterns(samples: int | None, ratio: float, sequence: int) -> None:
    """3⁸ sequences by the definitions, sequence windows and double thresholds (no window: held for `ratio`); 1e-12."""
    curve, sigma, levels = np.random.default_rng(4).uniform(3.0, 7.0, 8), 1.3, {"trigger": 5.0, "threshold": 4.0}
    above, high = exact.exceedance(curve, sigma, 4.0), exact.exceedance(curve, sigma, 5.0)
    share = np.stack([1.0 - above, above - high, high])
    expected = np.zeros(8)
    for pattern in SYMBOLS:
        if samples is None:
            k = _hold_by_definition(pattern, int(ratio))
        else:
            k = _sequence_by_definition(pattern, samples, ratio, sequence)
        if k is not None:
            expected[k] += share[pattern, range(8)].prod()
    if samples is None:
        result = exact.hold(curve, sigma, samples=int(ratio), **levels)
    else:
        result = exact.sequence_window(curve, sigma, samples=samples, ratio=ratio, sequence=sequence, **levels)
    np.testing.assert_allclose(result.mass[:, 0], expected, rtol=0.0, atol=1e-12)
    assert result.probability > 0.05  # there is something to compare


@pytest.mark.parametrize("counts", [(2,), (2, 3), (1, 3), (2, 3, 4), (1, 1, 3), (0, 1), (2, 5)])
def test_count_sequences_sum_over_all_patterns(counts: tuple[int, ...]) -> None:
    """2⁹ sequences by the definition: counts of the windows of 2, 4, 6 from the first sample above; to 1e-12."""
    curve, sigma = np.random.default_rng(3).uniform(3.0, 6.0, 9), 1.0
    above = exact.exceedance(curve, sigma, 4.5)
    expected = 0.0
    for pattern in product((0, 1), repeat=9):
        start = pattern.index(1) if 1 in pattern else 9
        if start + 2 * len(counts) <= 9:
            seen = tuple(sum(pattern[start : start + 2 * (level + 1)]) for level in range(len(counts)))
            expected += np.where(pattern, above, 1.0 - above).prod() * (seen == counts)
    found = exact.count_sequence(curve, sigma, threshold=4.5, samples=2, counts=counts)
    assert found == pytest.approx(expected, abs=1e-12)


# ---- the onboard detector in noise


@dataclass(frozen=True)
class Case:
    curve: str
    sigma: float  # g
    settings: str


def _curves() -> dict[str, np.ndarray]:
    """In g: quiet for 10 ms, then the launch or load."""
    t = np.arange(100) * MS
    rail = 0.34
    trapezoid = np.clip(np.minimum(t, 0.1 - t) / 0.02, 0.0, 1.0)
    still = np.full(10, rail)
    bump = np.full(25, rail)
    bump[5:9] = (30.0, -12.0, 16.0, 5.0)
    return {
        "trapezoid 5 g": np.concatenate([still, 5.0 * trapezoid + rail]),
        "half-sine 5 g": np.concatenate([still, 5.0 * np.sin(np.pi * t / 0.1) + rail]),
        "bump and trapezoid 6 g": np.concatenate([bump, 6.0 * trapezoid + rail]),
        "sustained 4.1 g": np.full(110, 4.1),
        "ring": np.concatenate([still, 5.9 * ring(80)]),
    }


CURVES = _curves()
SETTINGS: dict[str, dict[str, float | int | bool]] = {  # thresholds in g
    "n 10": {"trigger": 4.5, "threshold": 4.5, "samples": 10, "levels": 4, "ratio": 0.8, "rearm": True},
    "n 18": {"trigger": 4.6, "threshold": 4.6, "samples": 18, "levels": 4, "ratio": 0.8, "rearm": True},
    "latched": {"trigger": 4.5, "threshold": 4.5, "samples": 10, "levels": 4, "ratio": 0.8, "rearm": False},
    "hysteresis": {"trigger": 5.3, "threshold": 4.7, "samples": 7, "levels": 3, "ratio": 0.65, "rearm": True},
    "one window": {"trigger": 4.6, "threshold": 4.6, "samples": 22, "levels": 1, "ratio": 0.8, "rearm": True},
}
CASES = [Case(curve, sigma, name) for curve in CURVES for sigma in (0.3, 1.0) for name in SETTINGS]
TRIALS = 1500


def _exact(case: Case) -> exact.Recognition:
    settings = dict(SETTINGS[case.settings])
    if case.settings == "one window":
        del settings["levels"]
        return exact.threshold_window(CURVES[case.curve], case.sigma, **settings)  # type: ignore[arg-type]
    return exact.multi_level_window(CURVES[case.curve], case.sigma, **settings)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def simulated() -> dict[Case, np.ndarray]:
    """Counts of first passages, shape (samples, levels), of the onboard detector in drawn noise."""
    found = {}
    for number, case in enumerate(CASES):
        curve, settings = CURVES[case.curve], SETTINGS[case.settings]
        noise = np.random.default_rng([7, number]).standard_normal((TRIALS, curve.size))
        detector = MultiLevelWindow(**settings)  # type: ignore[arg-type]
        counts = np.zeros((curve.size, int(settings["levels"])), dtype=int)
        for readings in (curve + case.sigma * noise).tolist():
            passage = first_passage(readings, detector)
            if passage is not None:
                counts[passage[0], passage[1] - 1] += 1
        found[case] = counts
    return found


def _band(successes: int, trials: int, error: float) -> tuple[float, float]:
    """Clopper and Pearson's interval (Biometrika 26, 1934)."""
    low = beta.ppf(error / 2.0, successes, trials - successes + 1) if successes else 0.0
    high = beta.ppf(1.0 - error / 2.0, successes + 1, trials - successes) if successes < trials else 1.0
    return float(low), float(high)


def test_the_onboard_detector_agrees_in_every_level_and_quartile(simulated: dict[Case, np.ndarray]) -> None:
    """50 cases of curve, σ and settings, 1500 flights each: recognised in each level, and by each quartile of latency.

    Clopper-Pearson bands with 5 % of error in all of the comparisons together (Bonferroni), fixed seeds. A
    probability of one half is caught if it is wrong by 0.07 in nine of ten runs, one of 0.01 if it is by 0.02.
    """
    comparisons = []
    for case, counts in simulated.items():
        result = _exact(case)
        comparisons += [(case, counts[:, k].sum(), share) for k, share in enumerate(result.levels)]
        comparisons += [(case, counts.sum(), result.probability)]
        if result.probability > 1e-6:
            delays = [round(result.latency().quantile(share) / MS) for share in (0.25, 0.5, 0.75)]
            comparisons += [(case, counts[: k + 1].sum(), result.cumulative[k]) for k in delays]
    assert len({case for case, _, _ in comparisons}) == len(CASES) >= 30
    for case, successes, probability in comparisons:
        low, high = _band(int(successes), TRIALS, 0.05 / len(comparisons))
        assert low - 1e-12 <= probability <= high + 1e-12, case


def test_as_many_cases_lie_in_their_95_percent_bands_as_should(simulated: dict[Case, np.ndarray]) -> None:
    """One comparison a case, each with its own noise, where there is chance: recognised by the median sample.

    Outside of a 95 % band are at most 5 %: more than the 0.999 quantile of the binomial fails.
    """
    outside = cases = 0
    for case, counts in simulated.items():
        result = _exact(case)
        if result.probability < 0.01:
            continue
        k = round(result.latency().median / MS)
        low, high = _band(int(counts[: k + 1].sum()), TRIALS, 0.05)
        cases += 1
        outside += not low <= result.cumulative[k] <= high
    assert cases >= 30
    assert outside <= binom.ppf(0.999, cases, 0.05)


RIVALS: dict[str, tuple[Detector, Callable[..., exact.Recognition], dict[str, float]]] = {  # onboard, exact, in samples
    "threshold window, latched": (
        ThresholdWindow(1000.0, trigger=4.8, threshold=4.4, window=0.015, ratio=0.7, rearm=False),
        exact.threshold_window,
        {"trigger": 4.8, "threshold": 4.4, "samples": 15, "ratio": 0.7, "rearm": False},
    ),
    "sliding window": (
        SlidingWindow(1000.0, threshold=4.6, window=0.022, ratio=0.8),
        exact.sliding_window,
        {"threshold": 4.6, "samples": 22, "ratio": 0.8},
    ),
    "sequence window": (
        SequenceWindow(1000.0, trigger=4.5, threshold=4.3, window=0.020, ratio=0.75, sequence=0.003),
        exact.sequence_window,
        {"trigger": 4.5, "threshold": 4.3, "samples": 20, "ratio": 0.75, "sequence": 3},
    ),
    "single threshold": (
        SingleThreshold(1000.0, threshold=4.4, window=0.014),
        exact.hold,
        {"threshold": 4.4, "samples": 14},
    ),
    "double threshold": (
        DoubleThreshold(1000.0, trigger=4.8, threshold=4.0, window=0.016),
        exact.hold,
        {"trigger": 4.8, "threshold": 4.0, "samples": 16},
    ),
}
RIVAL_TRIALS = 600


def test_the_other_onboard_detectors_agree() -> None:
    """50 cases of curve, σ and detector, 600 flights each: recognised at all, and by each quartile of latency.

    Bands as above, 5 % of error in all of the comparisons together. A probability of one half is caught if it is wrong
    by 0.1 in nine of ten runs: a sample more or less in a window or a hold is.
    """
    comparisons = []
    for number, (name, curve, sigma) in enumerate(product(RIVALS, CURVES, (0.3, 1.0))):
        detector, find, settings = RIVALS[name]
        mean = CURVES[curve]
        noise = np.random.default_rng([8, number]).standard_normal((RIVAL_TRIALS, mean.size))
        found = [first_passage(readings, detector) for readings in (mean + sigma * noise).tolist()]
        at = np.array([mean.size if passage is None else passage[0] for passage in found])
        result = find(mean, sigma, **settings)
        ends = [mean.size - 1]
        if result.probability > 1e-6:
            ends += [round(result.latency().quantile(share) / MS) for share in (0.25, 0.5, 0.75)]
        comparisons += [((name, curve, sigma), int((at <= k).sum()), result.cumulative[k]) for k in ends]
    assert len({case for case, _, _ in comparisons}) == 50
    for case, successes, probability in comparisons:
        low, high = _band(successes, RIVAL_TRIALS, 0.05 / len(comparisons))
        assert low - 1e-12 <= probability <= high + 1e-12, case


@pytest.mark.parametrize(("samples", "ratio"), [(22, 0.8), (22, 0.65), (30, 0.9)])
def test_wide_sliding_windows_agree_with_simulation(samples: int, ratio: float) -> None:
    """The 5 g half-sine at σ = 1 g, 20 000 flights: by the quartiles, inside 99.9 % Clopper-Pearson bands.

    Nine comparisons: 1 % of error together. A probability wrong by 0.017 is caught in nine of ten runs.
    """
    curve = CURVES["half-sine 5 g"]
    above = curve + np.random.default_rng(samples).standard_normal((20_000, curve.size)) > 4.3
    padded = np.cumsum(np.hstack([np.zeros((20_000, samples), dtype=int), above]), axis=1)
    enough = padded[:, samples:] - padded[:, :-samples] >= ratio * samples - 1e-9
    result = exact.sliding_window(curve, 1.0, threshold=4.3, samples=samples, ratio=ratio)
    for share in (0.25, 0.5, 0.75):
        k = round(result.latency().quantile(share) / MS)
        low, high = _band(int(enough[:, : k + 1].any(axis=1).sum()), 20_000, 0.001)
        assert low <= result.cumulative[k] <= high


# ---- limits and closed forms


@pytest.mark.parametrize("case", CASES[:5] + CASES[20:25], ids=str)
def test_without_noise_it_is_the_onboard_detector(case: Case) -> None:
    settings = SETTINGS[case.settings]
    result = exact.multi_level_window(CURVES[case.curve], 0.0, **settings)  # type: ignore[arg-type]
    passage = first_passage(CURVES[case.curve].tolist(), MultiLevelWindow(**settings))  # type: ignore[arg-type]
    expected = np.zeros_like(result.mass)
    if passage is not None:
        expected[passage[0], passage[1] - 1] = 1.0
    np.testing.assert_array_equal(result.mass, expected)


def test_vanishing_noise_tends_to_none() -> None:
    settings = {"threshold": 0.75, "samples": 10, "levels": 4, "ratio": 0.8}
    none, little = (exact.multi_level_window(ring(), sigma, **settings) for sigma in (0.0, 1e-6))  # type: ignore[arg-type]
    np.testing.assert_allclose(little.mass, none.mass, atol=1e-9)


PAPER = {"threshold": 0.75, "samples": 10, "levels": 4, "ratio": 0.8}  # thresholds in parts of the plateau


def test_table_2_on_the_ring() -> None:
    """Counts 7, 14, 22 and 32 of 10, 20, 30 and 40: recognised in window 4, without noise for certain."""
    assert exact.multi_level_window(ring(), 0.0, **PAPER).levels.tolist() == [0.0, 0.0, 0.0, 1.0]  # type: ignore[arg-type]
    assert exact.count_sequence(ring(), 0.0, threshold=0.75, samples=10, counts=(7, 14, 22, 32)) == 1.0
    assert exact.count_sequence(ring(), 0.0, threshold=0.75, samples=10, counts=(7, 14, 22, 31)) == 0.0


@pytest.mark.parametrize(
    ("sigma", "counts", "window_4"), [(0.01, 0.81, 0.99), (0.02, 0.47, 0.81), (0.03, 0.26, 0.60), (0.05, 0.11, 0.36)]
)
def test_table_2_under_noise(sigma: float, counts: float, window_4: float) -> None:
    """Shares of simulated flights in a study made apart from this one, to the two digits that it gives."""
    settings = PAPER | {"rearm": False}  # the first trigger's windows
    result = exact.multi_level_window(ring(), sigma, **settings)  # type: ignore[arg-type]
    assert result.levels[3] == pytest.approx(window_4, abs=0.0051)
    found = exact.count_sequence(ring(), sigma, threshold=0.75, samples=10, counts=(7, 14, 22, 32))
    assert found == pytest.approx(counts, abs=0.0051)


@pytest.mark.parametrize("samples", [1, 3, 6])
def test_the_mean_wait_for_a_run_is_fellers(samples: int) -> None:
    """Feller, Probability Theory I, XIII.7: samples until r in a row are (1 - pʳ)/(q·pʳ) on average; to 1e-9."""
    p = float(exact.exceedance([0.3], 1.0, 0.0)[0])
    result = exact.hold(np.full(3000, 0.3), 1.0, threshold=0.0, samples=samples, period=1.0)
    assert result.probability == pytest.approx(1.0, abs=1e-12)
    assert result.latency().mean + 1.0 == pytest.approx((1.0 - p**samples) / ((1.0 - p) * p**samples), rel=1e-9)


@pytest.mark.parametrize("samples", [1, 2, 14, 40])
def test_a_hold_is_a_sliding_window_of_all(samples: int) -> None:
    curve = CURVES["trapezoid 5 g"]
    run = exact.hold(curve, 0.6, threshold=4.4, samples=samples)
    scan = exact.sliding_window(curve, 0.6, threshold=4.4, samples=samples, ratio=1.0)
    np.testing.assert_allclose(run.mass, scan.mass, rtol=0.0, atol=1e-13)


def test_ratio_is_decided_in_whole_numbers() -> None:
    """0.55 of 20 is 11, though 0.55·20 is above it in floating point; the 11 samples above come first."""
    curve = [5.0] * 11 + [0.0] * 9
    settings = {"threshold": 1.0, "samples": 20, "ratio": 0.55}
    assert exact.threshold_window(curve, 0.0, **settings).probability == 1.0  # type: ignore[arg-type]
    assert exact.sliding_window(curve, 0.0, **settings).latency().median == pytest.approx(0.010)  # type: ignore[arg-type]


def test_latency_counts_from_the_onset() -> None:
    """Masses 0.1, 0.2, 0.3, 0.2 at samples 1, 3, 4, 6; onsets 2 and 3: by hand."""
    mass = np.zeros((8, 1))
    mass[[1, 3, 4, 6], 0] = (0.1, 0.2, 0.3, 0.2)
    result = exact.Recognition(mass, 0.5)
    np.testing.assert_allclose(result.cumulative, [0.0, 0.1, 0.1, 0.3, 0.6, 0.6, 0.8, 0.8])
    delay = result.latency(2)
    assert (delay.probability, delay.false_alarm) == pytest.approx((0.7, 0.1))
    assert delay.mean == pytest.approx((1 * 0.2 + 2 * 0.3 + 4 * 0.2) / 0.7 * 0.5)
    assert [delay.quantile(share) for share in (0.01, 0.28, 0.5, 0.9, 1.0)] == [0.5, 0.5, 1.0, 2.0, 2.0]
    assert delay.median == 1.0
    assert result.latency(3).false_alarm == pytest.approx(0.1)
    assert (result.latency(3).quantile(0.28), result.latency(4).false_alarm) == pytest.approx((0.0, 0.3))


@pytest.mark.parametrize("seed", range(5))
def test_the_quantiles_stand_rounding(seed: int) -> None:
    """Sums of 2000 masses and of n equal ones: all are reached at the last, and k of n at the k-th."""
    mass = np.random.default_rng(seed).uniform(size=(2000, 1)) / 2000.0
    assert exact.Recognition(mass, 1.0).latency().quantile(1.0) == 1999.0
    n = 49 + seed
    equal = exact.Recognition(np.full((n, 1), 0.9 / n), 1.0).latency()
    assert [equal.quantile(k / n) for k in range(1, n + 1)] == list(range(n))


def test_a_sample_at_the_threshold_is_not_above() -> None:
    assert exact.exceedance([0.9, 1.0, 1.1], 0.0, 1.0).tolist() == [0.0, 0.0, 1.0]
    assert exact.exceedance([1.0, 1.0], [0.0, 0.3], 1.0).tolist() == [0.0, 0.5]


def test_there_is_no_latency_without_recognition() -> None:
    delay = exact.hold(np.zeros(20), 0.0, threshold=1.0, samples=2).latency(5)
    assert (delay.probability, delay.false_alarm) == (0.0, 0.0)
    assert np.isnan([delay.mean, delay.median, delay.quantile(0.95)]).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"curve": []}, "at least one value"),
        ({"curve": [np.nan]}, "finite"),
        ({"sigma": -1.0}, "sigma"),
        ({"threshold": np.nan}, "threshold"),
        ({"trigger": 0.5}, "trigger"),
        ({"samples": 0}, "samples"),
        ({"samples": 1.5}, "whole"),
        ({"levels": 0}, "levels"),
        ({"ratio": 0.0}, "ratio"),
        ({"ratio": 1.1}, "ratio"),
        ({"period": 0.0}, "period"),
    ],
)
def test_bad_input_is_refused(changes: dict[str, object], message: str) -> None:
    good = {"curve": [1.0], "sigma": 1.0, "threshold": 1.0, "samples": 2, "levels": 2, "ratio": 0.8}
    with pytest.raises(ValueError, match=message):
        exact.multi_level_window(**(good | changes))  # type: ignore[arg-type]


def test_windows_too_wide_to_be_exact_are_refused_with_the_numbers() -> None:
    with pytest.raises(ValueError, match=r"20 of 30 samples have 54,627,300 states"):
        exact.sliding_window([1.0], 1.0, threshold=1.0, samples=30, ratio=0.65)
    with pytest.raises(ValueError, match="63 samples"):
        exact.sliding_window([1.0], 1.0, threshold=1.0, samples=64, ratio=1.0)
    assert exact.hold(np.ones(100), 0.0, threshold=0.0, samples=64).probability == 1.0


@pytest.mark.parametrize("sequence", [0, 4, 1.5])
def test_a_sequence_out_of_its_window_is_refused(sequence: int) -> None:
    with pytest.raises(ValueError, match="at most samples"):
        exact.sequence_window([1.0], 1.0, threshold=1.0, samples=3, ratio=0.8, sequence=sequence)


def test_no_count_is_no_sequence() -> None:
    with pytest.raises(ValueError, match="at least one count"):
        exact.count_sequence([1.0], 1.0, threshold=1.0, samples=1, counts=())


def test_onset_outside_of_the_curve_is_refused() -> None:
    with pytest.raises(ValueError, match="20 samples"):
        exact.hold(np.zeros(20), 0.0, threshold=1.0, samples=2).latency(20)


@pytest.mark.parametrize("ratio", [0.0, -0.1, 1.1])
def test_a_share_that_is_none_is_refused_by_every_window(ratio: float) -> None:
    one = {"threshold": 1.0, "samples": 3, "ratio": ratio}
    for refused in (
        lambda: exact.multi_level_window([1.0], 1.0, levels=2, **one),
        lambda: exact.threshold_window([1.0], 1.0, **one),
        lambda: exact.sequence_window([1.0], 1.0, sequence=1, **one),
        lambda: exact.sliding_window([1.0], 1.0, **one),
    ):
        with pytest.raises(ValueError, match="ratio must be above 0 and at most 1"):
            refused()


def test_a_long_sliding_window_with_one_miss_allowed() -> None:
    """39 of the last 40, by the places of the last two misses alone: recognised when the second last has left."""
    n, above, length = 40, 0.97, 90
    found = exact.sliding_window([above_as_curve(above)] * length, 1.0, threshold=0.0, samples=n, ratio=39.0 / n)
    waiting, passage = {(0, 1): 1.0}, []  # how long ago the last two misses were; before the first sample all are
    for _ in range(length):
        after: dict[tuple[int, int], float] = {}
        passed = 0.0
        for (last, second), mass in waiting.items():
            if second + 1 >= n:
                passed += above * mass
            else:
                after[last + 1, second + 1] = after.get((last + 1, second + 1), 0.0) + above * mass
            after[0, last + 1] = after.get((0, last + 1), 0.0) + (1.0 - above) * mass
        waiting = after
        passage.append(passed)
    assert found.mass.sum(axis=1) == pytest.approx(passage, rel=1e-9, abs=1e-15)
    assert 0.3 < sum(passage) < 0.99


def above_as_curve(probability: float) -> float:
    """Mean, in standard deviations above the threshold, that is exceeded with this probability."""
    from scipy.special import ndtri

    return float(ndtri(probability))


def test_no_quantile_beyond_all() -> None:
    delay = exact.Recognition(np.array([[0.0], [0.4], [0.6]]), 0.5).latency(0)
    assert delay.quantile(1.0) == 1.0
    for share in (0.0, 1.05):
        with pytest.raises(ValueError, match="share must be above 0 and at most 1"):
            delay.quantile(share)


def test_a_curve_or_a_noise_with_one_value_that_is_none_is_refused() -> None:
    for wrong in (np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            exact.exceedance([50.0, wrong, 40.0], 1.0, 45.0)
        with pytest.raises(ValueError, match="sigma must be finite"):
            exact.exceedance([50.0, 46.0, 40.0], [1.0, wrong, 2.0], 45.0)
