"""Designs fill the cube as they should, and the interval of their mean covers the mean.

Authority: a Latin hypercube has one point in each of n slices of each coordinate, Sobol's sequence of 2^m points one in
each of 2^m boxes of two coordinates' halves; exp(½ Σ u) has the mean (2 (√e - 1))^d.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from uavsim.studies.campaign.designs import LATIN, SAMPLINGS, SOBOL, mean_interval, points, replicate, replicates, size

DIMENSION = 4
MEAN = (2.0 * (math.sqrt(math.e) - 1.0)) ** DIMENSION


def smooth(u: np.ndarray) -> np.ndarray:
    return np.asarray(np.exp(0.5 * u.sum(axis=1)))


@pytest.mark.parametrize(("sampling", "runs"), [(LATIN, 200), (LATIN, 20), (SOBOL, 160), (SOBOL, 304), (SOBOL, 30)])
def test_each_replicate_fills_each_coordinate_evenly(sampling: str, runs: int) -> None:
    found, each = points(sampling, runs, 5, seed=3), size(sampling, runs)
    assert found.shape == (runs, 5)
    assert 10 <= replicates(sampling, runs) == runs // each < 20
    labels = [replicate(sampling, runs, i) for i in range(runs)]
    assert labels == sorted(labels)
    for number in range(replicates(sampling, runs)):
        part = found[np.array(labels) == number]
        for column in part.T:
            assert sorted(np.floor(column * each).astype(int)) == list(range(each))


def test_the_points_are_those_of_runs_dimension_seed_and_sampling() -> None:
    first = points(SOBOL, 160, 3, seed=1)
    assert np.array_equal(first, points(SOBOL, 160, 3, seed=1))
    assert not np.isin(first, points(SOBOL, 160, 3, seed=2)).any()
    assert not np.isin(points(LATIN, 160, 3, seed=1), points(LATIN, 160, 3, seed=2)).any()
    replicated = first.reshape(10, 16, 3)
    assert not np.isin(replicated[0], replicated[1:]).any()  # each scrambled by itself


@pytest.mark.parametrize(
    ("sampling", "runs", "says"),
    [
        (SOBOL, 1000, "runs = 1000: sobol takes 10 … 19 times a power of 2, at least 20; the nearest: 960 or 1024"),
        (SOBOL, 1, "the nearest: 20"),
        (SOBOL, 0, "the nearest: 20"),
        (SOBOL, -3, "the nearest: 20"),
        (LATIN, 1001, "latin-hypercube takes a multiple of 10, at least 20; the nearest: 1000 or 1010"),
        (LATIN, 10, "the nearest: 20"),
        ("halton", 100, "sampling 'halton' is no design; there are latin-hypercube, sobol"),
    ],
)
def test_numbers_that_make_no_design_are_one_line_with_the_nearest(sampling: str, runs: int, says: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        points(sampling, runs, 3, seed=1)
    assert says in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("dimension", [0, 1001])
def test_a_design_of_nothing_or_too_much_is_refused(dimension: int) -> None:
    with pytest.raises(ValueError, match="from 1 to 1000 dispersions"):
        points(LATIN, 20, dimension, seed=1)


@pytest.mark.parametrize(("sampling", "repeated"), [(LATIN, 400), (SOBOL, 200)])
def test_the_interval_covers_the_mean_and_is_narrower_than_that_of_random_points(sampling: str, repeated: int) -> None:
    """95 % nominal, 400 (200) repetitions: within 3.4 standard errors, 3.7 % (5.2 %); by chance not once in 1500 times.

    Random points of the same number have 2·1.96 sd/√runs; a design's width is below a half of that here.
    """
    runs = 160
    labels = [replicate(sampling, runs, i) for i in range(runs)]
    found = [mean_interval(smooth(points(sampling, runs, DIMENSION, seed)), labels) for seed in range(repeated)]
    covered = float(np.mean([one.low <= MEAN <= one.high for one in found]))
    assert 0.95 - 3.4 * math.sqrt(0.95 * 0.05 / repeated) <= covered <= 0.95 + 3.4 * math.sqrt(0.95 * 0.05 / repeated)
    second = (math.e - 1.0) ** DIMENSION  # of exp(Σ u)
    of_random = 2.0 * 1.96 * math.sqrt((second - MEAN**2) / runs)
    assert float(np.mean([one.high - one.low for one in found])) < 0.5 * of_random


def test_the_interval_is_students_over_the_replicates_means() -> None:
    """Ten replicates of 1 … 10: mean 5.5, sd of the means 3.0277, t(9) = 2.2622."""
    values = np.repeat(np.arange(1.0, 11.0), 4) + np.tile([-1.0, 1.0, -0.5, 0.5], 10)
    found = mean_interval(values, np.repeat(np.arange(10), 4))
    assert found.mean == pytest.approx(5.5)
    assert (found.high - found.low) / 2.0 == pytest.approx(2.262157 * 3.027650 / math.sqrt(10.0), rel=1e-5)
    wider = mean_interval(values, np.repeat(np.arange(10), 4), confidence=0.99)
    assert (wider.high - wider.low) / (found.high - found.low) == pytest.approx(3.249836 / 2.262157, rel=1e-5)


@pytest.mark.parametrize(
    ("values", "labels", "says"),
    [
        (np.r_[np.nan, np.ones(39)], np.repeat(np.arange(10), 4), "1 of 40 results are no number"),
        (np.ones(36), np.repeat(np.arange(9), 4), "at least 10 whole replicates; there are 9"),
        (np.ones(39), np.repeat(np.arange(10), 4)[:39], "there are 10 of 3 to 4 results"),
        (np.ones(0), np.arange(0), "there are 0"),
    ],
)
def test_what_has_no_interval_is_one_line(values: np.ndarray, labels: np.ndarray, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        mean_interval(values, labels)


def test_samplings_are_those_that_a_campaign_names() -> None:
    assert SAMPLINGS == ("latin-hypercube", "sobol")
