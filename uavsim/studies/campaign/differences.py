"""Which draws differ between flights that failed and those that did not.

Of each draw the two groups are compared by Mann and Whitney's test (Annals of Mathematical Statistics 18, 1947, 50-60),
two-sided. Many draws are looked at, so the probabilities are Holm's (Scandinavian Journal of Statistics 6, 1979,
65-70): the chance that any one of them is as small, if no draw has to do with failing, is at most that.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.many import Many

FEWEST = 5  # flights in each group, below which nothing is said
PREFIX = "draw."


@dataclass(frozen=True, slots=True)
class Difference:
    """A draw's median among flights that failed and among the others, and Holm's probability of no difference."""

    key: str
    failed: float
    others: float
    probability: float


def differences(flown: Many) -> list[Difference]:
    """Compare all draws that are numbers and differ between flights, the least probable first.

    A flight failed that did not end as expected, or did not meet a requirement. Empty with fewer than `FEWEST` flights
    in either group.
    """
    from scipy.stats import mannwhitneyu

    failed = ~(flown.expected & flown.met)
    if min(int(failed.sum()), int((~failed).sum())) < FEWEST:
        return []
    found = []
    for name in flown.runs.columns:
        if not str(name).startswith(PREFIX):
            continue
        values = flown.column(name)
        known = np.isfinite(values)
        one, other = values[known & failed], values[known & ~failed]
        if min(one.size, other.size) < FEWEST or np.ptp(values[known]) == 0.0:
            continue
        probability = float(mannwhitneyu(one, other, method="asymptotic").pvalue)
        found.append(Difference(str(name)[len(PREFIX) :], float(np.median(one)), float(np.median(other)), probability))
    found.sort(key=lambda one: one.probability)
    adjusted = holm(np.array([one.probability for one in found]))
    return [
        Difference(one.key, one.failed, one.others, float(p)) for one, p in zip(found, adjusted.tolist(), strict=True)
    ]


def holm(probabilities: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Holm's adjusted probabilities of tests, in the order given."""
    m = probabilities.size
    order = np.argsort(probabilities, kind="stable")
    scaled = np.maximum.accumulate(probabilities[order] * (m - np.arange(m)))
    adjusted = np.empty(m)
    adjusted[order] = np.minimum(scaled, 1.0)
    return adjusted
