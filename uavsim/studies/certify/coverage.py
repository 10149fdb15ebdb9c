"""Whether a mean coverage is what it should be, the flight being the unit.

The rows of one flight are not independent of each other: an offset of a tare or a push of air lasts for seconds. So
each flight gives one number x_i in [0, 1], the share of its rows that are within their bars, and what is tested is the
mean of such numbers. Their distribution is far from normal (most are 1), so the test is one of bounded numbers
(Waudby-Smith and Ramdas, J. Royal Statistical Society B 86, 2024, 1-27): against the hypothesis that the mean is at
most m the wealth

    W_n = Π (1 + λ_i (x_i - m)),    λ_i = (μ̂ - m)/(σ̂² + (μ̂ - m)²) of those before, within 0 … 0.75/m

is a fair game or a losing one, so that P(max W ≥ 1/a) ≤ a (Ville), and 1/max W is a p-value at any number of flights.
"At least m" is the same with 1 - x and 1 - m. Many tests at once are held to a common level by Holm's procedure
(Scandinavian J. Statistics 6, 1979, 65-70): the probability that any true hypothesis is refused is at most that level.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BET = 0.75  # largest share of the wealth that one flight may cost
SHUFFLE = 20_261_129  # seed of the order of flights, which the factors of a set must not decide


def mean_above(values: Array, bound: float) -> float:
    """Return the p-value of "the mean is at most `bound`" from independent numbers in [0, 1].

    Parameters
    ----------
    values
        Shape (n,); NaN is left out.
    bound
        Within (0, 1).
    """
    if not 0.0 < bound < 1.0:
        raise ValueError(f"bound = {bound}: must lie between 0 and 1")
    x = values[np.isfinite(values)]
    x = np.random.default_rng(SHUFFLE).permutation(x)
    log_wealth = best = 0.0
    total, squares, n = 0.5, 0.25, 1  # as if one flight before had given 1/2, off by 1/2
    for one in x.tolist():
        mean = total / n
        lead = mean - bound
        bet = min(max(0.0, lead / (squares / n + lead * lead)), BET / bound)
        log_wealth += float(np.log1p(bet * (one - bound)))
        best = max(best, log_wealth)
        total, n = total + one, n + 1
        squares += (one - total / n) ** 2
    return float(np.exp(-best))


def mean_below(values: Array, bound: float) -> float:
    """Return the p-value of "the mean is at least `bound`"."""
    return mean_above(1.0 - values, 1.0 - bound)


def holm(p_values: Sequence[float], level: float) -> list[bool]:
    """Return which hypotheses are refused at a common level."""
    order = sorted(range(len(p_values)), key=lambda i: p_values[i])
    refused = [False] * len(p_values)
    for rank, i in enumerate(order):
        if not p_values[i] <= level / (len(p_values) - rank):
            break
        refused[i] = True
    return refused
