"""Quantiles with distribution-free bands, against published tables, their definition and their promise."""

import numpy as np
import pytest
from scipy.stats import binom

from uavsim.studies.quantiles import quantile_band

RANKS = [  # n, quantile, ranks of the bounds of the two-sided 95 % band; None: none exists
    (5, 0.5, None, None),  # 2 · 0.5⁵ = 0.0625
    (6, 0.5, 1, 6),  # the smallest sample with a band for the median; Conover, Practical Nonparametric Statistics, A3
    (10, 0.5, 2, 9),
    (15, 0.5, 4, 12),
    (20, 0.5, 6, 15),
    (50, 0.5, 18, 33),
    (50, 0.95, 44, None),  # P(B >= 50) = 0.95⁵⁰ = 0.077
    (50, 0.05, None, 7),
    (100, 0.9, 84, 96),
]


@pytest.mark.parametrize(("n", "quantile", "low", "high"), RANKS)
def test_bounds_are_the_tabulated_order_statistics(n: int, quantile: float, low: int | None, high: int | None) -> None:
    sample = np.random.default_rng(n).permutation(np.arange(1.0, n + 1))
    band = quantile_band(sample, quantile)
    assert (band.low, band.high) == (low, high)
    assert band.probability == quantile


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("quantile", [0.05, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("n", [1, 7, 50, 333])
def test_each_side_is_the_narrowest_that_holds_its_half(n: int, quantile: float, confidence: float) -> None:
    """By the definition: P(B <= l - 1) <= tail < P(B <= l), and P(B >= u) <= tail < P(B >= u - 1)."""
    band, tail = quantile_band(np.arange(1.0, n + 1), quantile, confidence), (1.0 - confidence) / 2.0
    tie = 1e-12  # rounding, where a tail is met exactly
    low = 0 if band.low is None else int(band.low)
    high = n + 1 if band.high is None else int(band.high)
    assert low == 0 or binom.cdf(low - 1, n, quantile) <= tail + tie
    assert binom.cdf(low, n, quantile) > tail - tie
    assert high == n + 1 or binom.sf(high - 1, n, quantile) <= tail + tie
    assert binom.sf(high - 2, n, quantile) > tail - tie


@pytest.mark.parametrize(("n", "quantile"), [(10, 0.5), (50, 0.5), (50, 0.9), (200, 0.05)])
def test_the_band_covers_what_it_promises(n: int, quantile: float) -> None:
    """4000 exponential samples: at least 95 % of the bands hold the true quantile.

    Fails by chance with less than 10⁻⁴ if the coverage is just 95 %; one of 93.7 % is caught in half of the runs.
    """
    truth = -np.log(1.0 - quantile)
    samples = np.random.default_rng(20 + n).exponential(size=(4000, n))
    covered = 0
    for sample in samples:
        band = quantile_band(sample, quantile)
        covered += (band.low is None or band.low <= truth) and (band.high is None or truth <= band.high)
    assert covered >= binom.ppf(1e-4, 4000, 0.95)


def test_the_value_is_the_samples_quantile() -> None:
    assert quantile_band(np.array([3.0, 1.0, 2.0, 10.0]), 0.5).value == 2.5
    assert quantile_band(np.array([4.0]), 0.3).value == 4.0


def test_equal_values_give_a_band_of_no_width() -> None:
    band = quantile_band(np.full(20, 7.0), 0.5)
    assert (band.low, band.value, band.high) == (7.0, 7.0, 7.0)


@pytest.mark.parametrize(
    ("sample", "quantile", "confidence"),
    [([], 0.5, 0.95), ([1.0], 0.0, 0.95), ([1.0], 1.0, 0.95), ([1.0], 0.5, 0.0), ([1.0], 0.5, 1.0)],
)
def test_what_has_no_band_is_refused(sample: list[float], quantile: float, confidence: float) -> None:
    with pytest.raises(ValueError, match=r"at least one|between 0 and 1"):
        quantile_band(np.array(sample), quantile, confidence)


@pytest.mark.parametrize("sample", [[], [1.0, np.nan], [np.inf, 2.0]])
def test_a_quantile_needs_finite_values(sample: list[float]) -> None:
    with pytest.raises(ValueError, match="finite"):
        quantile_band(np.array(sample), 0.5)
