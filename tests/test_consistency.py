"""Consistency statistics: on what is consistent by construction, and on what is not."""

import math

import numpy as np
import pytest

from uavsim import consistency
from uavsim.consistency import autocorrelation, coverage, judge, ljung_box, mean_band, nees


def test_band_is_chi_square():
    """Tables of χ² (Abramowitz & Stegun 26.8): m = 10: 3.24697 and 20.4832; m = 100: 74.222 and 129.561."""
    assert mean_band(10) == pytest.approx((0.324697, 2.04832), abs=1e-5)
    assert mean_band(100) == pytest.approx((0.74222, 1.29561), abs=1e-5)
    low, high = mean_band(10_000)
    assert (1.0 - low, high - 1.0) == pytest.approx((1.96 * math.sqrt(2e-4),) * 2, rel=0.02)


@pytest.mark.parametrize(("runs", "confidence"), [(0, 0.95), (5, 0.0), (5, 1.0), (5, math.nan)])
def test_band_refuses(runs, confidence):
    with pytest.raises(ValueError, match="at least one run"):
        mean_band(runs, confidence)


def test_gaussian_errors_are_consistent():
    """200 runs of 500 independent times: coverage to 4 binomial deviations, 95 % of times inside to 4."""
    generator = np.random.default_rng(1)
    sd = np.linspace(0.1, 2.0, 500)
    error = generator.normal(size=(200, 500)) * sd
    found = judge(
        error, np.broadcast_to(sd, error.shape), generator.chisquare(1, (200, 500)), generator.normal(size=(200, 500))
    )
    assert found.nees == pytest.approx(1.0, abs=4.0 * math.sqrt(2.0 / 1e5))
    assert found.nis == pytest.approx(1.0, abs=4.0 * math.sqrt(2.0 / 1e5))
    assert found.nees_inside == pytest.approx(0.95, abs=4.0 * math.sqrt(0.05 * 0.95 / 500))
    assert found.white == pytest.approx(0.95, abs=4.0 * math.sqrt(0.05 * 0.95 / 200))
    for share, expected in zip(found.coverage, consistency.EXPECTED_COVERAGE, strict=True):
        assert share == pytest.approx(expected, abs=4.0 * math.sqrt(expected * (1.0 - expected) / 1e5))
    assert (found.runs, found.samples, found.warning) == (200, 500, "")


def test_an_overconfident_filter_shows():
    generator = np.random.default_rng(2)
    found = judge(generator.normal(size=(100, 400)), np.full((100, 400), 0.8))
    assert found.nees == pytest.approx(1.0 / 0.64, abs=0.05)
    assert found.nees_inside < 0.15
    assert math.isnan(found.nis)
    assert math.isnan(found.white)


def test_coloured_innovations_show():
    """AR(1) with φ = 0.3, 500 values: r₁ near 0.3, and the test rejects; white noise of the same size passes."""
    generator = np.random.default_rng(3)
    white = generator.normal(size=500)
    coloured = np.empty(500)
    coloured[0] = white[0]
    for k in range(1, 500):
        coloured[k] = 0.3 * coloured[k - 1] + white[k]
    assert autocorrelation(coloured, 5)[0] == pytest.approx(0.3, abs=0.15)
    assert ljung_box(coloured)[1] < 1e-4
    assert ljung_box(white)[1] > 0.01


def test_ljung_box_is_uniform_on_white_noise():
    """p-values of 400 sequences of 300: the share below 5 % within 4 binomial deviations, 0.006 … 0.094."""
    generator = np.random.default_rng(4)
    values = [ljung_box(generator.normal(size=300))[1] for _ in range(400)]
    assert np.mean(np.array(values) < 0.05) == pytest.approx(0.05, abs=4.0 * math.sqrt(0.05 * 0.95 / 400))


def test_too_short_is_refused():
    with pytest.raises(ValueError, match="too few"):
        autocorrelation(np.arange(11.0))


def test_missing_values_and_no_claim_are_left_out():
    """A deviation of 0 claims nothing, as below V*: it counts in no figure."""
    error, sd = np.array([1.0, 2.0, math.nan, 0.1]), np.array([1.0, 0.0, 1.0, 0.1])
    assert np.isnan(nees(error, sd)).tolist() == [False, True, True, False]
    found = judge(error, sd)
    assert (found.nees, found.samples) == (1.0, 2)
    assert found.warning.startswith("one flight proves little")
    assert all(math.isnan(share) for share in coverage(np.array([math.nan]), np.array([1.0])))
    empty = judge(np.full(3, math.nan), np.ones(3))
    assert math.isnan(empty.nees)
    assert empty.samples == 0
