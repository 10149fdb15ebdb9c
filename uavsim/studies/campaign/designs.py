"""Designs: points of the unit cube that fill it more evenly than random ones, for means of what is drawn.

A Latin hypercube of n points has one in each of n slices of each coordinate; Sobol's sequence, scrambled, one in each
of many boxes. Either lowers the variance of a mean, most where the result is smooth and nearly additive in few
coordinates. The points of one design are not independent, so nothing can be said about the error from within one: a
design here is `REPLICATES` or more of them, each scrambled by itself (`Streams(seed, replicate)`), and the interval of
a mean is Student's over the replicates' means.

    runs = R n:  R = 10 replicates of n points for the Latin hypercube,  R = 10 … 19 of n = 2^m for Sobol's sequence

Quantiles and probabilities of a requirement are for independent flights: verification takes random ones.

McKay, Beckman, Conover, "A comparison of three methods for selecting values of input variables in the analysis of
output from a computer code", Technometrics 21 (1979). Matoušek, "On the L2-discrepancy for anchored boxes", 1998 (the
scrambling that scipy has). L'Ecuyer, Lemieux, "Recent advances in randomized quasi-Monte Carlo methods", 2002.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sensors import Streams

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Array = NDArray[np.float64]

REPLICATES = 10  # the least number; Student's factor is then 2.26 in place of 1.96
LATIN, SOBOL = "latin-hypercube", "sobol"
SAMPLINGS = (LATIN, SOBOL)
MOST_DIMENSIONS = 1000  # of one design; a scenario has at most 100 dispersions


class MeanInterval(NamedTuple):
    """A mean with its interval of confidence."""

    mean: float
    low: float
    high: float


def size(sampling: str, runs: int) -> int:
    """Return the number of points of one replicate.

    Raises
    ------
    ValueError
        One line that names the nearest numbers of runs that can be.
    """
    if sampling not in SAMPLINGS:
        raise ValueError(f"sampling {sampling!r} is no design; there are {', '.join(SAMPLINGS)}")
    found = _size(sampling, runs)
    if not found:
        below = next((n for n in range(runs, 0, -1) if _size(sampling, n)), None)
        above = next(n for n in range(max(runs, 1), 2 * max(runs, 2 * REPLICATES) + 1) if _size(sampling, n))
        near = f"{above}" if below is None else f"{below} or {above}"
        rule = "10 … 19 times a power of 2" if sampling == SOBOL else f"a multiple of {REPLICATES}"
        raise ValueError(f"runs = {runs}: {sampling} takes {rule}, at least {2 * REPLICATES}; the nearest: {near}")
    return found


def _size(sampling: str, runs: int) -> int:
    """Points of one replicate; 0 if there can be none."""
    if runs < 2 * REPLICATES:
        return 0
    if sampling == LATIN:
        return 0 if runs % REPLICATES else runs // REPLICATES
    power = 1 << ((runs // REPLICATES).bit_length() - 1)
    return 0 if runs % power else power


def replicates(sampling: str, runs: int) -> int:
    """Return the number of replicates."""
    return runs // size(sampling, runs)


def replicate(sampling: str, runs: int, position: int) -> int:
    """Return the number of the replicate that a position, 0 … runs - 1, belongs to: they follow each other."""
    return position // size(sampling, runs)


def points(sampling: str, runs: int, dimension: int, seed: int) -> Array:
    """Return the points of a design.

    Parameters
    ----------
    sampling
        "latin-hypercube" or "sobol".
    runs
        Number of points in all; another number is another design.
    dimension
        Of the cube.
    seed
        Of the scrambling.

    Returns
    -------
    ndarray
        Shape (runs, dimension), 0 ≤ u < 1, replicate after replicate.

    Raises
    ------
    ValueError
        One line: no such design, or none of so many points.
    """
    from scipy.stats import qmc

    each = size(sampling, runs)
    if not 1 <= dimension <= MOST_DIMENSIONS:
        raise ValueError(f"a design needs from 1 to {MOST_DIMENSIONS} dispersions, not {dimension}")
    parts: list[Array] = []
    for number in range(runs // each):
        source = Streams(seed, number)(f"design.{sampling}")
        if sampling == SOBOL:
            parts.append(qmc.Sobol(dimension, scramble=True, rng=source).random_base2(each.bit_length() - 1))
        else:
            parts.append(qmc.LatinHypercube(dimension, rng=source).random(each))
    return np.concatenate(parts)


def mean_interval(
    values: "ArrayLike", replicate: Sequence[int] | NDArray[Any], confidence: float = 0.95
) -> MeanInterval:
    """Return the mean of a design's results and its interval, by Student's distribution of the replicates' means.

    Parameters
    ----------
    values
        A result of each flight, numbers.
    replicate
        Which replicate each of them is of.
    confidence
        0 … 1.

    Raises
    ------
    ValueError
        One line: too few replicates, replicates of different size, or a result that is no number.
    """
    from scipy.special import stdtrit

    results, labels = np.asarray(values, dtype=float), np.asarray(replicate)
    lost = int(np.count_nonzero(~np.isfinite(results)))
    if lost:
        raise ValueError(f"{lost} of {results.size} results are no number; a design's mean needs all of them")
    _, which, counts = np.unique(labels, return_inverse=True, return_counts=True)
    if counts.size < REPLICATES or counts.min() != counts.max():
        has = f"{counts.size} of {counts.min()} to {counts.max()} results" if counts.size else "0"
        raise ValueError(f"the interval needs at least {REPLICATES} whole replicates; there are {has}")
    means = np.bincount(which, weights=results) / counts
    mean = float(means.mean())
    half = float(stdtrit(counts.size - 1, 0.5 + 0.5 * confidence)) * float(means.std(ddof=1)) / counts.size**0.5
    return MeanInterval(mean, mean - half, mean + half)
