"""The test of a mean coverage: it errs as rarely as it says, whatever the distribution, and finds what is far off."""

import numpy as np
import pytest

from uavsim.studies.certify.coverage import holm, mean_above, mean_below

RUNS = 300


@pytest.mark.parametrize("spread", ["two values", "beta"])
def test_a_true_hypothesis_is_refused_as_rarely_as_is_said(spread: str) -> None:
    """At 5 %: of 300 runs 15 are expected at most; more than 27 come with 0.2 % by chance."""
    generator = np.random.default_rng(31)
    refused = 0
    for _ in range(RUNS):
        share = generator.random(120)
        sample = generator.beta(9.0, 1.0, 120) if spread == "beta" else (share < 0.9).astype(float)
        refused += mean_below(sample, 0.9) <= 0.05
    assert refused <= 27


def test_a_mean_that_is_far_off_is_shown() -> None:
    """90 flights with a mean of 0.75 and a spread of 0.2, at the level of one in a thousand hypotheses at 1 %."""
    generator = np.random.default_rng(32)
    shown = [mean_below(generator.beta(2.77, 0.92, 90), 0.9) <= 1e-5 for _ in range(50)]
    assert np.mean(shown) > 0.7


def test_above_is_below_of_what_is_left() -> None:
    sample = np.random.default_rng(33).beta(5.0, 1.0, 60)
    assert mean_below(sample, 0.9) == mean_above(1.0 - sample, 1.0 - 0.9)


def test_all_within_the_bar_is_shown_to_be_above_only_by_many() -> None:
    """ln 1.0076 a flight: 126 flights at 1.0 do not show a mean above 0.99 at 1 %, 2000 do."""
    assert mean_above(np.ones(126), 0.99) > 0.01
    assert mean_above(np.ones(2000), 0.99) < 1e-5


def test_no_flight_shows_nothing() -> None:
    assert mean_below(np.full(3, np.nan), 0.9) == 1.0
    with pytest.raises(ValueError, match="between 0 and 1"):
        mean_above(np.ones(3), 1.0)


def test_holm() -> None:
    """Holm 1979: 0.01 ≤ 0.05/4, 0.013 ≤ 0.05/3, 0.03 > 0.05/2, and what comes after falls with it."""
    assert holm([0.03, 0.01, 0.04, 0.013], 0.05) == [False, True, False, True]
    assert holm([], 0.05) == []
