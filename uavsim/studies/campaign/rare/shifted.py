"""Importance sampling around the failures that subset simulation has found.

    P = E_q[1{g(u) ≤ 0} φ(u)/q(u)],        q(u) = ε φ(u) + (1 - ε) Σ_j π_j φ(u - m_j)

φ is the standard normal density of the inputs; the m_j are centres of the failures, one for each group of them, found
by expectation maximisation with as many groups as the Bayes information criterion asks for, each chain counted once.
The mirror images of the centres are looked at as well. A first round of samples gives weighted failures, to which the
mixture of the second is fitted; that alone is counted.

The estimate is unbiased whatever the m_j are; how much it scatters is not known where a region of failure has been
missed. It is therefore held against that of subset simulation before it is believed (`trusted`). `MOST_INPUTS` are the
most: each that plays no part adds the error of its centre to the weights.

Sources: Melchers, Structural Safety 6 (1989) 3 (centres at design points); Owen & Zhou, J. Am. Stat. Assoc. 95 (2000)
135 (mixtures, and why φ is one of them).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_INPUTS = 20  # with 30 the weights of linear limits scatter by 69 %, more than subset simulation
MOST_BESIDE_NOISE = 40  # the same where subset simulation does not serve
MOST_GROUPS = 4
PLAIN = 0.05  # ε
MIRRORED = 0.1  # –, of the samples, that look at the opposite side
ROUNDS = 50  # of expectation maximisation
LARGEST_SHARE = 0.1  # of the sum of weights, that one sample may have in a trusted estimate


@dataclass(frozen=True)
class Mixture:
    """q: weights π and centres m, shape (groups,) and (groups, d)."""

    weights: Floats
    centres: Floats

    def draw(self, n: int, rng: np.random.Generator) -> Floats:
        """Draw inputs, shape (n, d)."""
        u = rng.standard_normal((n, self.centres.shape[1]))
        group = rng.choice(len(self.weights), n, p=self.weights)
        return u + np.where((rng.random(n) >= PLAIN)[:, np.newaxis], self.centres[group], 0.0)

    def ratio(self, u: Floats) -> Floats:
        """φ(u)/q(u), shape (n,)."""
        exponent = u @ self.centres.T - 0.5 * (self.centres**2).sum(axis=1)
        with np.errstate(over="ignore"):
            return np.asarray(1.0 / (PLAIN + (1.0 - PLAIN) * np.exp(exponent) @ self.weights))


def fit(failures: Floats, weights: Floats, independent: float, rng: np.random.Generator) -> Mixture:
    """Fit q to weighted failures, as many as so many independent ones."""
    best, least = Mixture(np.ones(1), np.average(failures, axis=0, weights=weights)[np.newaxis]), np.inf
    n, d = failures.shape
    share = weights / weights.sum()
    for groups in range(1, min(MOST_GROUPS, n) + 1):
        mixture, likelihood = _maximise(failures, share, groups, rng)
        criterion = -2.0 * likelihood * independent + (groups * (d + 1) - 1) * np.log(max(2.0, independent))
        if criterion < least:
            best, least = mixture, criterion
    return best


def mirrored(mixture: Mixture) -> Mixture:
    """The same with each centre's mirror image beside it: a region of failure opposite to those that were found."""
    weights = np.concatenate([(1.0 - MIRRORED) * mixture.weights, MIRRORED * mixture.weights])
    return Mixture(weights, np.vstack([mixture.centres, -mixture.centres]))


def _maximise(u: Floats, share: Floats, groups: int, rng: np.random.Generator) -> tuple[Mixture, float]:
    """Fit so many groups; return the mean logarithm of their density too, less what all have in common."""
    centres = u[[int(rng.choice(len(u), p=share))]]
    while len(centres) < groups:  # far from each other
        away = ((u[:, np.newaxis] - centres) ** 2).sum(axis=2).min(axis=1)
        centres = np.vstack([centres, u[int(np.argmax(away))]])
    weights, total = np.full(groups, 1.0 / groups), -np.inf
    for _ in range(ROUNDS):
        logs = np.log(weights) - 0.5 * ((u[:, np.newaxis] - centres) ** 2).sum(axis=2)
        top = logs.max(axis=1, keepdims=True)
        sums = np.exp(logs - top).sum(axis=1, keepdims=True)
        belongs = np.exp(logs - top) / sums * share[:, np.newaxis]
        total = float(share @ (top + np.log(sums))[:, 0])
        mass = np.maximum(belongs.sum(axis=0), 1e-9)
        weights, centres = mass / mass.sum(), (belongs.T @ u) / mass[:, np.newaxis]
    return Mixture(weights, centres), total


def trusted(values: Floats, pilot: float, pilot_variation: float) -> bool:
    """Whether an estimate from weighted failures is not far below subset simulation's, and hangs on no one sample."""
    total = float(values.sum())
    if not total > 0.0 or float(values.max()) > LARGEST_SHARE * total:
        return False
    return bool(float(np.log(pilot / values.mean())) < 3.0 * np.sqrt(np.log1p(pilot_variation**2)) + 0.5)
