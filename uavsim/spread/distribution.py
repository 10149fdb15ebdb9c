"""Distributions as they are drawn from, in the key's own unit.

    normal              μ + σ z
    truncated-normal    μ + σ Φ⁻¹(Φ(a) + u (Φ(b) − Φ(a))),  a = (low − μ)/σ, b = (high − μ)/σ
    uniform             low + u (high − low);  whole numbers: low + ⌊u (high − low + 1)⌋
    choice              the first value whose cumulated weight is above u

z is standard normal, u uniform from 0 to 1; z = Φ⁻¹(u) gives the same value by the inverse of the distribution.
"""

from bisect import bisect_right
from dataclasses import dataclass
from itertools import accumulate
from math import erfc, floor, inf, sqrt

from uavsim.spread.settings import Chosen, Dispersion, Kind

NORMALS = ("normal", "truncated-normal")
LEAST_SHARE = 1e-12  # of a normal distribution that is left of it when it is truncated: beyond it Φ has no digits


def normal_below(z: float) -> float:
    """Probability of a standard normal value below z."""
    return 0.5 * erfc(-z / sqrt(2.0))


def normal_between(a: float, b: float) -> float:
    """Probability of a standard normal value from a to b; in the upper tail 1 - Φ has the digits that Φ has lost."""
    return normal_below(b) - normal_below(a) if a <= 0.0 else normal_below(-a) - normal_below(-b)


@dataclass(frozen=True, slots=True)
class Distribution:
    """Of one value.

    Attributes
    ----------
    kind
        As a dispersion has it.
    mean, sd
        Of the normal distribution, before it is truncated.
    low, high
        Ends.
    values, weights
        Of a choice; as many of both.
    whole
        Whether only whole numbers are drawn.
    """

    kind: Kind
    mean: float = 0.0
    sd: float = 1.0
    low: float = -inf
    high: float = inf
    values: tuple[Chosen, ...] = ()
    weights: tuple[float, ...] = ()
    whole: bool = False

    @property
    def is_normal(self) -> bool:
        """Whether it is made from a standard normal value, the others from a uniform one."""
        return self.kind == "normal"

    @property
    def median(self) -> Chosen:
        """The value in the middle; of a choice the first."""
        if self.kind == "choice":
            return self.tried[0]
        return self.of_normal(0.0) if self.is_normal else self.of_uniform(0.5)

    @property
    def tried(self) -> tuple[Chosen, ...]:
        """Ends, and what may be chosen, each once: what a scenario must be able to have."""
        if self.kind == "choice":
            return tuple(dict.fromkeys(v for v, weight in zip(self.values, self.weights, strict=True) if weight > 0.0))
        ends = (end for end in (self.low, self.high) if abs(end) < inf)
        return tuple(int(end) for end in ends) if self.whole else tuple(ends)

    def of_normal(self, z: float) -> float:
        """Return the value that a standard normal one stands for."""
        return self.mean + self.sd * z

    def of_uniform(self, u: float) -> Chosen:
        """Return the value that a uniform one, 0 ≤ u < 1, stands for."""
        if self.kind == "choice":
            sums = list(accumulate(self.weights))
            return self.values[min(bisect_right(sums, u * sums[-1]), self._last)]
        if self.kind == "truncated-normal":
            return self._truncated(u)
        if self.whole:
            return int(self.low) + min(floor(u * (self.high - self.low + 1.0)), int(self.high - self.low))
        return min(self.low + u * (self.high - self.low), self.high)

    @property
    def _last(self) -> int:
        return max(i for i, weight in enumerate(self.weights) if weight > 0.0)

    def _truncated(self, u: float) -> float:
        from scipy.special import ndtri

        a, b = self._ends
        mirrored = a > 0.0  # as of `normal_between`
        if mirrored:
            a, b, u = -b, -a, 1.0 - u
        below, above = normal_below(a), normal_below(b)
        z = float(ndtri(below + u * (above - below)))
        return min(max(self.mean + self.sd * (-z if mirrored else z), self.low), self.high)

    @property
    def _ends(self) -> tuple[float, float]:
        return (self.low - self.mean) / self.sd, (self.high - self.mean) / self.sd

    @property
    def left(self) -> float:
        """Share of the normal distribution that is left when it is truncated."""
        return normal_between(*self._ends)

    def below(self, bound: float) -> float:
        """Probability of a value below a bound."""
        if bound == -inf:
            return 0.0
        if self.kind == "uniform":
            width = self.high - self.low + (1.0 if self.whole else 0.0)
            return min(max((bound - self.low) / width, 0.0), 1.0)
        z = (bound - self.mean) / self.sd
        if self.kind == "normal":
            return normal_below(z)
        return 0.0 if bound <= self.low else min(normal_between(self._ends[0], z) / self.left, 1.0)

    def above(self, bound: float) -> float:
        """Probability of a value above a bound."""
        if bound == inf:
            return 0.0
        mirrored = Distribution(self.kind, -self.mean, self.sd, -self.high, -self.low, whole=self.whole)
        return mirrored.below(-bound)


def distribution(given: Dispersion, own: object, number: type | None) -> Distribution:
    """Return the distribution of a dispersion that was checked.

    Parameters
    ----------
    given
        The dispersion.
    own
        The key's own value.
    number
        What the key takes: float, int, or None if no number.
    """
    scale = float(own) if given.relative else 1.0  # type: ignore[arg-type]  # checked: a number
    ends = (
        (-inf if given.low is None else given.low) * scale,
        (inf if given.high is None else given.high) * scale,
    )
    mean = 0.0
    if given.mean is not None:
        mean = given.mean * scale
    elif given.distribution in NORMALS:
        mean = float(own)  # type: ignore[arg-type]  # likewise
    numbers = number is float and all(isinstance(v, int | float) and not isinstance(v, bool) for v in given.values)
    values = tuple(float(v) * scale for v in given.values) if numbers else given.values
    return Distribution(
        given.distribution,
        mean,
        (1.0 if given.sd is None else given.sd) * abs(scale),
        min(ends),
        max(ends),
        values,
        given.weights or (1.0,) * len(values),
        whole=number is int,
    )
