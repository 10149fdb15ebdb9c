"""Subset simulation: the probability of a rare event of many standard normal inputs, by a chain of frequent ones.

The inputs u are d independent standard normals, the event is g(u) ≤ 0; g is the margin. Levels c₁ > c₂ > … > c_L = 0
make nested events {g ≤ c_j}, and

    P(g ≤ 0) = P₁ · P₂ ⋯ P_L,        P_j = P(g ≤ c_j | g ≤ c_{j-1})

c_j is the p₀-quantile of the N margins at level j, so that P_j = p₀ for all but the last. Those at or below it are the
seeds of Markov chains that are distributed as the inputs given g ≤ c_j. A step of a chain proposes for each input

    v_i = √(1 - s_i²) u_i + s_i ξ_i,     ξ_i standard normal,        accepted if g(v) ≤ c_j, else it stays

which leaves the normal distribution as it is in any number of dimensions (preconditioned Crank-Nicolson). s_i follows
the spread of the seeds and is scaled while the chains run, batch by batch, so that 44 % of the proposals are accepted.
Inputs in which nothing is continuous, such as the number of a flight's noise, are kept or drawn anew.
Chains cannot see a region of failure in which no seed lies: a margin with several valleys can be underestimated.

Coefficient of variation of one run, with the correlation ρ_j(k) of the chains' indicators at lag k:

    δ_j² = (1 - P_j)/(N P_j) · (1 + γ_j),     γ_j = 2 Σ_k (1 - k·N_c/N) ρ_j(k),       Σ δ_j² ≤ δ² ≤ (Σ δ_j)²

The bounds are those of levels that are independent and that go together. `variation` is the lower one; `estimate` takes
the geometric mean of both, which was found to hold (docs/rare.md).

Sources: Au & Beck, Prob. Engng Mech. 16 (2001) 263; Papaioannou, Betz, Zwirglmaier & Straub, Prob. Engng Mech. 41
(2015) 89 (adaptive conditional sampling).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

P0 = 0.1  # –, of each level
BATCHES = 10  # of chains, between which the proposals' spread is adapted
REDRAWN = 0.5  # –, of the proposals, in which inputs that move as a whole are drawn anew
ACCEPTED = 0.44  # –, share of proposals that is aimed at (Papaioannou et al.)
MOST_LEVELS = 40  # 1e-40


@dataclass(frozen=True)
class Level:
    """One level: its bound on the margin, the share at or below it, its coefficient of variation, and acceptance."""

    bound: float
    share: float
    variation: float
    accepted: float


@dataclass(frozen=True)
class Subset:
    """One run.

    Attributes
    ----------
    probability, variation : float
        Estimate, and its coefficient of variation as the chains tell it.
    levels : tuple of Level
    evaluations : int
        Margins that were evaluated.
    failures : ndarray
        Shape (n, d): inputs of the last level with g ≤ 0; the chains' states, some of them repeated.
    complete : bool
        Whether g ≤ 0 was reached.
    """

    probability: float
    variation: float
    levels: tuple[Level, ...]
    evaluations: int
    failures: Floats
    complete: bool


def run(
    margins: Callable[[Floats], Floats],
    dimension: int,
    seed: np.random.SeedSequence,
    samples: int,
    budget: int,
    whole: int = 0,
) -> Subset:
    """Estimate once.

    Parameters
    ----------
    margins : callable
        g of inputs of shape (n, d), shape (n,); NaN counts as safe.
    dimension : int
        d.
    seed : SeedSequence
        Fixes the result.
    samples : int
        N, of each level; a multiple of 10 is used.
    budget : int
        Most evaluations: a run that would need more ends without reaching 0.
    whole : int
        How many inputs, the last ones, are kept or drawn anew together, since nothing is continuous in them: the number
        of a flight's noise.

    Raises
    ------
    ValueError
        If the margins' shape is another.
    """
    rng = np.random.default_rng(seed)
    n = max(10, samples // 10 * 10)
    u = rng.standard_normal((n, dimension))
    g = _margins(margins, u)
    used, shape = n, (n, 1)  # g.reshape(shape): chains by steps
    probability, squares, accepted = 1.0, 0.0, 1.0
    levels: list[Level] = []
    scale = 0.6
    while True:
        order = np.argsort(g, kind="stable")
        bound = float(g[order[round(P0 * n) - 1]])
        last = bound <= 0.0
        bound = max(bound, 0.0)
        below = g <= bound
        share = float(below.mean())
        variation = _variation(below.reshape(shape), share) if share > 0.0 else np.inf
        stuck = share >= 1.0 and not last
        if np.isinf(bound) or stuck:
            return Subset(0.0, np.inf, tuple(levels), used, u[:0], complete=False)
        levels.append(Level(bound, share, variation, accepted))
        probability *= share
        squares += variation**2
        if last:
            return Subset(probability, sqrt(squares), tuple(levels), used, u[below], complete=True)
        chains = int(below.sum())
        steps = ceil(n / chains)
        if used + chains * (steps - 1) > budget or len(levels) == MOST_LEVELS:
            return Subset(0.0, np.inf, tuple(levels), used, u[:0], complete=False)
        seeds = rng.permutation(np.flatnonzero(below))
        u, g, accepted, scale = _chains(margins, u[seeds], g[seeds], bound, steps, scale, whole, rng)
        used += chains * (steps - 1)
        n, shape = len(g), (chains, steps)


def _chains(
    margins: Callable[[Floats], Floats],
    u: Floats,
    g: Floats,
    bound: float,
    steps: int,
    scale: float,
    whole: int,
    rng: np.random.Generator,
) -> tuple[Floats, Floats, float, float]:
    """Let chains run from seeds; return all of their states, chain by chain, the share accepted, and the scale."""
    chains, d = u.shape
    states, values = np.empty((chains, steps, d)), np.empty((chains, steps))
    spread = np.clip(u.std(axis=0), 0.1, 1.0) if chains > 1 else np.ones(d)
    taken = tried = 0
    for number, batch in enumerate(np.array_split(np.arange(chains), min(BATCHES, chains)), start=1):
        s = np.minimum(1.0, scale * spread)
        keep, at, value, moved = np.sqrt(1.0 - s**2), u[batch], g[batch], 0
        states[batch, 0], values[batch, 0] = at, value
        for k in range(1, steps):
            fresh = rng.standard_normal(at.shape)
            proposal = keep * at + s * fresh
            if whole:
                anew = rng.random((len(at), 1)) < REDRAWN
                proposal[:, -whole:] = np.where(anew, fresh[:, -whole:], at[:, -whole:])
            new = _margins(margins, proposal)
            accept = new <= bound
            at, value = np.where(accept[:, np.newaxis], proposal, at), np.where(accept, new, value)
            states[batch, k], values[batch, k] = at, value
            moved += int(accept.sum())
        here = len(batch) * (steps - 1)
        taken, tried = taken + moved, tried + here
        if here:
            scale = float(np.clip(scale * np.exp((moved / here - ACCEPTED) / sqrt(number)), 0.02, 2.0))
    return states.reshape(-1, d), values.reshape(-1), taken / max(1, tried), scale


def _variation(below: NDArray[np.bool_], share: float) -> float:
    """Coefficient of variation of a level's share, from indicators by chain and step."""
    steps = below.shape[1]
    n = below.size
    variance = share * (1.0 - share)
    if variance == 0.0:
        return 0.0
    away = below - share
    correlation = [float((away[:, : steps - k] * away[:, k:]).mean()) / variance for k in range(1, steps)]
    gamma = 2.0 * sum((1.0 - k / steps) * r for k, r in enumerate(correlation, start=1))
    return sqrt(variance * max(1.0 + gamma, 1.0) / n) / share


def _margins(margins: Callable[[Floats], Floats], u: Floats) -> Floats:
    g = np.asarray(margins(u), np.float64)
    if g.shape != (len(u),):
        raise ValueError(f"margins must have the shape ({len(u)},), not {g.shape}")
    return np.where(np.isnan(g), np.inf, g)
