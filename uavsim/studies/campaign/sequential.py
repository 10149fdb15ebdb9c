"""Sequential tests whose error rate is kept at every look: counts of events, rates, means.

**Events.** A flight shows an event or not, with probability q. Two tests are held against a bound q₀, each with its
own error `level`, and each may be looked at after every flight:

    few     q < q₀ is shown at the first flight n at which no more than k events have come and n ≥ n_k
    many    q > q₀ is shown at the first flight n at which k events or more have come and n ≤ m_k

n_0 < n_1 < … and m_1 ≤ m_2 ≤ … are chosen so that the probability of ever deciding wrongly is at most `level` under
q = q₀, and so under any q on the wrong side. It is computed exactly, by walking the distribution of the count from
flight to flight and taking out what has decided: the exact group-sequential binomial test of Jennison and Turnbull
(Group Sequential Methods, 2000, ch. 12) with an error-spending function (Lan & DeMets, Biometrika 70, 1983, 659-663).
Three things follow from the count's being a staircase:

* `few` can decide at the flights n_k only and `many` at an event only. Looking after every flight costs nothing, and
  looking less often can only lower the error. **So the error is kept for every schedule of looks**, one that was
  chosen on the way included, and whatever the budget is: a campaign may be prolonged after it was looked at.
* The tests of smaller levels lie within those of larger ones (this is enforced), so the smallest level at which a test
  has decided is a p-value that holds at every look, and Holm's procedure may be applied to it at any time.
* The bounds q that are not rejected at `level` form a confidence bound that holds at every look together.

**Spending.** `few` has spent the share F(k) = 1 - (1 - F₀)/(1 + k/k₀) of its error when n_k is reached, with F₀ = 0.8
and k₀ = 2. A fixed sample spends all of it at k = 0; then a single event ends every hope. The shape was chosen by exact
computation for q₀ = 0.005 at 95 %, flights until decided:

    F₀      no event    on average, if q is 0.001   0.002   0.003       93 % decided, 0.001
    0.5     736         1291                        2822    8823        2419
    0.7     669         1317                        3079    9897        2932
    0.8     643         1359                        3308    10783       3049
    0.85    631         1396                        3481    11424       3131
    fixed   598         (1549 whatever comes)                           1549
    Wald                1250, the least mean there is, with no limit on the largest

`many` spends G(t) = 1 - 1/(1 + t) of its error until t = n q₀ events are expected. Both have heavy tails, so that
flights go on to count when thousands have been flown.

**Quantiles** are counts: the Q-quantile lies below b if P(x ≤ b) > Q, and x > b is the event. The bound of a
quantile is an order statistic: at n_k the value that k of the first n_k flights exceed.

**Rates.** Events of a Poisson process of rate λ, seen over an exposure T, are the same with λ T in place of n q and no
steps between. How long each flight is exposed may depend on what happens in it, as long as nobody foresees the events
(the process in its own time stays a Poisson process: Watanabe, 1964). Boundaries are in expected events, the same for
every bound.

**Means** have no exact test without knowing the distribution. Looks at n = 32, 48, 72, … (each 3/2 of the one before)
use the levels at which a Brownian motion would have spent 1 - 1/(i + 2) of the error by look i (Armitage, McPherson &
Rowe's recursion), and those levels are asked of Student's or the studentised bootstrap's bound at that look
(`estimates.mean_bound`; Jennison & Turnbull's "significance level approach", ch. 3.8). This holds as well as that
bound does; it is measured in `tests/validation/test_verification.py`.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

FIRST_SHARE, EVENTS_SCALE = 0.8, 2.0  # F₀ and k₀ of `few`
EXPECTED_SCALE = 1.0  # expected events at which `many` has spent half of its error
BLOCK = 0.02  # expected events between steps of a boundary of `many`
NEGLIGIBLE = 1e-18  # probability that is left out of a walk; far below any error that is spent
FIRST_LOOK, LOOK_RATIO = 32, 1.5  # of means
MOST_LOOKS = 40
GRID = 241  # points of the recursion for means; odd, for Simpson's rule
LOWEST = -9.0  # standard deviations, where that grid begins


def spent_on_few(events: int) -> float:
    """Share of the error that may be spent when so many events still decide."""
    return 1.0 - (1.0 - FIRST_SHARE) / (1.0 + events / EVENTS_SCALE)


def spent_on_many(expected: float) -> float:
    """Share of the error that may be spent when so many events are expected."""
    return 1.0 - 1.0 / (1.0 + expected / EXPECTED_SCALE)


# -- walks: the distribution of a count as flights go on -------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Flights:
    """Events in flights, one at most in each, with a probability; the unit of time is a flight."""

    probability: float

    @property
    def hazard(self) -> float:
        """Rate at which the chance of no event falls, one over a unit."""
        return float(-np.log1p(-self.probability))

    def step(self, wait: float) -> float:
        """The wait as it can be: whole flights."""
        return float(np.ceil(wait - 1e-9))

    @property
    def block(self) -> float:
        """Units in which a boundary of `many` may step."""
        return float(max(1, int(BLOCK / self.probability)))

    def expected(self, time: float) -> float:
        """Events that are expected."""
        return self.probability * time

    def counts(self, time: float) -> Floats:
        """Probabilities of 0, 1, … events."""
        from scipy.special import gammaln

        n, q = round(time), self.probability
        k = np.arange(min(n, _most(n * q)) + 1, dtype=np.float64)
        log = gammaln(n + 1.0) - gammaln(k + 1.0) - gammaln(n - k + 1.0) + k * np.log(q) + (n - k) * np.log1p(-q)
        found: Floats = np.exp(log)
        return found


@dataclass(frozen=True, slots=True)
class Exposure:
    """Events of a Poisson process; the unit of time is the one in which one event is expected."""

    hazard: float = 1.0
    block: float = BLOCK

    def step(self, wait: float) -> float:
        """The wait as it can be: any."""
        return wait

    def expected(self, time: float) -> float:
        """Events that are expected."""
        return time

    def counts(self, time: float) -> Floats:
        """Probabilities of 0, 1, … events."""
        from scipy.special import gammaln

        k = np.arange(_most(time) + 1, dtype=np.float64)
        found: Floats = np.exp(k * np.log(time) - time - gammaln(k + 1.0)) if time > 0.0 else np.ones(1)
        return found


Walk = Flights | Exposure


def _most(mean: float) -> int:
    """Count beyond which a binomial or Poisson variable has no probability to speak of."""
    return int(mean + 9.5 * np.sqrt(mean) + 18.0)


@cache
def few_times(walk: Walk, level: float, horizon: float) -> Floats:
    """Times n_0 ≤ n_1 ≤ … up to the horizon: no more than k events by n_k show that there are fewer than thought."""
    times: list[float] = []
    time, spent, alive = 0.0, 0.0, np.ones(1)  # alive[j]: k + j events and not decided
    while alive.size:
        available = level * spent_on_few(len(times)) - spent
        wait = walk.step(max(0.0, float(np.log(alive[0] / available)) / walk.hazard)) if alive[0] > 0.0 else 0.0
        time += wait
        if time > horizon:
            break
        alive = np.convolve(alive, walk.counts(wait)) if wait else alive
        spent += alive[0]
        alive = _without_tail(alive[1:])
        times.append(time)
    return np.asarray(times, dtype=np.float64)


@cache
def many_times(walk: Walk, level: float, horizon: float) -> Floats:
    """Times m_1 ≤ m_2 ≤ … : k events by m_k show that there are more than thought; the last one is the horizon."""
    times: list[float] = []
    time, spent, events = 0.0, 0.0, 1
    alive, low = np.ones(1), 0  # alive[j]: low + j events and not decided
    counts = walk.counts(walk.block)
    while time < horizon:
        later = np.convolve(alive, counts)
        allowed = level * spent_on_many(walk.expected(time + walk.block)) - spent
        while (beyond := float(later[events - low :].sum())) > allowed:
            times.append(time)
            events += 1
        spent += beyond
        alive = later[: max(events - low, 0)]
        if alive.size > 1 and alive[0] < NEGLIGIBLE:
            alive, low = alive[1:], low + 1
        time += walk.block
    return np.asarray([*times, horizon], dtype=np.float64)


def _without_tail(values: Floats) -> Floats:
    much = np.flatnonzero(values > NEGLIGIBLE)
    return values[: much[-1] + 1] if much.size else values[:0]


def nested_few(walk: Walk, levels: tuple[float, ...], horizon: float) -> list[Floats]:
    """`few_times` of levels, the largest first, each within the one before."""
    found: list[Floats] = []
    for level in levels:
        times = few_times(walk, level, horizon).copy()
        if found:
            times = times[: found[-1].size]
            np.maximum(times, found[-1][: times.size], out=times)
        found.append(times)
    return found


def nested_many(walk: Walk, levels: tuple[float, ...], horizon: float) -> list[Floats]:
    """`many_times` of levels, the largest first, each within the one before."""
    found: list[Floats] = []
    for level in levels:
        times = many_times(walk, level, horizon).copy()
        if found:
            size = min(times.size, found[-1].size)
            np.minimum(times[:size], found[-1][:size], out=times[:size])
        found.append(times)
    return found


# -- what has been seen, against the boundaries ----------------------------------------------------------------------


def horizon_of(flights: float) -> float:
    """A power of two that is no less: boundaries are kept by it, and it changes nothing before it."""
    return float(2.0 ** np.ceil(np.log2(max(flights, 1.0))))


def event_levels(events: Flags, bound: float, levels: tuple[float, ...]) -> tuple[float, float]:
    """Smallest levels at which flights have shown that an event's probability is below, and above, a bound.

    Parameters
    ----------
    events
        Shape (n,), in the order of the flights: whether it came.
    bound
        Probability, 0 … 1 exclusive.
    levels
        Errors to try, the largest first.

    Returns
    -------
    tuple of float
        P-values that hold at every look: below and above. 1 where no level decides.
    """
    if bound > 0.5:  # boundaries step with the rarer of both
        above, below = event_levels(~events, 1.0 - bound, levels)
        return below, above
    walk, horizon = Flights(bound), horizon_of(events.size)
    few = [few_decides(times, events) is not None for times in nested_few(walk, levels, horizon)]
    many = [many_decides(times, events) is not None for times in nested_many(walk, levels, horizon)]
    return _smallest(levels, few), _smallest(levels, many)


def few_decides(times: Floats, events: Flags) -> int | None:
    """Number of flights after which so few events had come that it was decided."""
    count = np.concatenate([[0], np.cumsum(events)])
    reached = times[times <= events.size].astype(int)
    decided = np.flatnonzero(count[reached] <= np.arange(reached.size))
    return int(reached[decided[0]]) if decided.size else None


def many_decides(times: Floats, events: Flags) -> int | None:
    """Number of flights after which so many events had come that it was decided."""
    came = np.flatnonzero(events)[: times.size] + 1
    decided = np.flatnonzero(came <= times[: came.size])
    return int(came[decided[0]]) if decided.size else None


def _smallest(levels: tuple[float, ...], decided: list[bool]) -> float:
    return min((level for level, yes in zip(levels, decided, strict=True) if yes), default=1.0)


def event_interval(events: Flags, level: float) -> tuple[float, float]:
    """Bounds of an event's probability, each with the error `level`, that hold at every look together."""
    return _lowest(events, level), 1.0 - _lowest(~events, level)


def _lowest(events: Flags, level: float) -> float:
    """Greatest bound that the probability is shown to be above of; 0 if there is none."""
    if not events.any():
        return 0.0
    low, high = -35.0, 35.0  # logits
    for _ in range(32):
        middle = 0.5 * (low + high)
        if _is_above(events, float(1.0 / (1.0 + np.exp(-middle))), level):
            low = middle
        else:
            high = middle
    return float(1.0 / (1.0 + np.exp(-low))) if low > -35.0 else 0.0


def _is_above(events: Flags, bound: float, level: float) -> bool:
    horizon = float(events.size)
    if bound > 0.5:
        times = few_times.__wrapped__(Flights(1.0 - bound), level, horizon)
        return few_decides(times, ~events) is not None
    expected = bound * events.size
    if expected < 1e-3 * level:  # far beyond what a boundary is needed for: one event is more than this
        return True
    return many_decides(many_times.__wrapped__(Flights(bound), level, horizon), events) is not None


def quantile_interval(values: Floats, probability: float, level: float) -> tuple[float, float]:
    """Bounds of a quantile, each with the error `level`, that hold at every look together.

    Parameters
    ----------
    values
        Shape (n,), in the order of the flights; ±inf is allowed.
    probability
        Of the quantile, 0 … 1 exclusive.
    level
        Error of each bound.

    Returns
    -------
    tuple of float
        Low and high; -inf and inf where there are too few flights for one.
    """
    if probability < 0.5:
        low, high = quantile_interval(-values, 1.0 - probability, level)
        return -high, -low
    walk, n = Flights(1.0 - probability), values.size
    low, high = -np.inf, np.inf
    for k, time in enumerate(few_times(walk, level, horizon_of(n))):
        if time > n:
            break
        first = values[: int(time)]
        high = min(high, float(np.partition(first, first.size - 1 - k)[first.size - 1 - k]))
    for k, time in enumerate(many_times(walk, level, horizon_of(n)), start=1):
        first = values[: int(min(time, n))]
        if k <= first.size:
            low = max(low, float(np.partition(first, first.size - k)[first.size - k]))
        if k > n:
            break
    return low, high


def rate_levels(counts: Floats, exposures: Floats, bound: float, levels: tuple[float, ...]) -> tuple[float, float]:
    """Smallest levels at which flights have shown that a rate is below, and above, a bound.

    Parameters
    ----------
    counts, exposures
        Shape (n,), in the order of the flights: events, and the time in which they could come.
    bound
        Rate, one over the unit of the exposures.
    levels
        Errors to try, the largest first.

    Returns
    -------
    tuple of float
        P-values that hold at every look: below and above.
    """
    count, expected = np.cumsum(counts), bound * np.cumsum(exposures)
    horizon = horizon_of(expected[-1] if expected.size else 0.0)
    few = [
        bool(np.any(count < np.searchsorted(times, expected, side="right")))
        for times in nested_few(Exposure(), levels, horizon)
    ]
    many = [
        bool(np.any(count > np.searchsorted(times, expected, side="left")))
        for times in nested_many(Exposure(), levels, horizon)
    ]
    return _smallest(levels, few), _smallest(levels, many)


def rate_interval(counts: Floats, exposures: Floats, level: float) -> tuple[Floats, Floats]:
    """Bounds of a rate after each flight, each with the error `level`, that hold at every look together.

    Returns
    -------
    tuple of ndarray
        Shape (n,) each: low, 0 where there is none, and high, inf where there is none.
    """
    count, exposure = np.cumsum(counts).astype(int), np.cumsum(exposures)
    total = int(count[-1]) if count.size else 0
    horizon = horizon_of(total + 10.0 * np.sqrt(total) + 30.0)
    few, many = few_times(Exposure(), level, horizon), many_times(Exposure(), level, horizon)
    seen = exposure > 0.0
    high, low = np.full(count.size, np.inf), np.zeros(count.size)
    known = seen & (count < few.size)
    high[known] = few[count[known]] / exposure[known]
    known = seen & (count >= 1) & (count <= many.size)
    low[known] = many[count[known] - 1] / exposure[known]
    return np.maximum.accumulate(low), np.minimum.accumulate(high)


# -- means -----------------------------------------------------------------------------------------------------------


def mean_looks(flights: int) -> tuple[int, ...]:
    """Numbers of flights, up to so many, at which a mean is looked at."""
    looks = [round(FIRST_LOOK * LOOK_RATIO**i) for i in range(MOST_LOOKS)]
    return tuple(n for n in looks if n <= flights)


@cache
def mean_levels(level: float, looks: int) -> tuple[float, ...]:
    """Nominal one-sided error of each look at a mean, such that all looks together err with `level` at most."""
    return tuple(float(x) for x in _normal_tail(_criticals(level, looks)))


def mean_chance(level: float, looks: int, effect: float) -> Floats:
    """Chance that a mean is decided by each look.

    Parameters
    ----------
    level
        Error of the test.
    looks
        How many.
    effect
        True distance of the mean from its bound on the right side, in standard deviations of one flight.
    """
    found, alive = [], _Alive(effect)
    for number, critical in zip(mean_looks(2**62)[:looks], _criticals(level, looks), strict=True):
        found.append(alive.look(number, critical))
    return np.asarray(np.minimum(np.cumsum(found), 1.0), dtype=np.float64)


@cache
def _criticals(level: float, looks: int) -> Floats:
    from scipy.optimize import brentq

    found, spent, alive = [], 0.0, _Alive(0.0)
    for i, number in enumerate(mean_looks(2**62)[:looks]):
        allowed = level * (1.0 - 1.0 / (i + 2.0)) - spent
        critical = float(brentq(lambda c, n=number, a=allowed: alive.beyond(n, c) - a, -1.0, 12.0, xtol=1e-10))
        spent += alive.look(number, critical)
        found.append(critical)
    return np.asarray(found, dtype=np.float64)


class _Alive:
    """Density of the standardised sum of those that have not decided, from look to look.

    Z_n √n is a random walk of unit steps with a drift; it decides at a look where Z_n exceeds a critical value.
    """

    def __init__(self, effect: float) -> None:
        self._effect = effect
        self._number = 0
        self._z: Floats = np.zeros(1)
        self._mass: Floats = np.ones(1)  # density times the rule's weight

    def beyond(self, number: int, critical: float) -> float:
        """Probability of not having decided before and to be beyond the critical value at this look."""
        return float(self._mass @ _normal_tail(self._distance(number, np.asarray([critical]))[0]))

    def look(self, number: int, critical: float) -> float:
        """Decide; return the probability that it was at this look."""
        decided = self.beyond(number, critical)
        lowest = LOWEST + min(0.0, self._effect * np.sqrt(number))
        z = np.linspace(min(lowest, critical - 1.0), critical, GRID)
        distance = self._distance(number, z)
        spread = np.sqrt(number / (number - self._number))
        density = np.exp(-0.5 * distance**2) @ self._mass * spread / np.sqrt(2.0 * np.pi)
        weights = np.ones(GRID)
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        self._number, self._z, self._mass = number, z, density * weights * (z[1] - z[0]) / 3.0
        return decided

    def _distance(self, number: int, z: Floats) -> Floats:
        """Steps' standard deviations from each value before (last axis) to each value now."""
        step = number - self._number
        start: Floats = self._z * np.sqrt(self._number) + self._effect * step
        distance: Floats = (z[:, None] * np.sqrt(number) - start) / np.sqrt(step)
        return distance


def _normal_tail(z: Floats) -> Floats:
    from scipy.special import ndtr

    tail: Floats = ndtr(-z)
    return tail


# -- before the start ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Chance:
    """What a test will come to at a stated truth.

    Attributes
    ----------
    few, many
        Probability that it is shown within the budget that there are fewer, or more, than the bound says.
    flights
        Mean number of flights until it is decided or the budget ends.
    median
        Number of flights by which half of the tests are decided; None if the budget ends before.
    """

    few: float
    many: float
    flights: float
    median: int | None


def chance(few: Floats, many: Floats, each: Floats, budget: int) -> Chance:
    """Walk both tests of a bound together under a stated truth.

    Parameters
    ----------
    few, many
        Boundaries, in flights.
    each
        Probabilities of 0, 1, … events in one flight.
    budget
        Flights.
    """
    alive = np.ones(1)
    decided = {"few": 0.0, "many": 0.0}
    flights, median = 0.0, None
    fewest = np.searchsorted(few, np.arange(budget + 1), side="right")  # decided if fewer events than this
    most = np.searchsorted(many, np.arange(budget + 1), side="left") + 1  # decided if this many
    for n in range(1, budget + 1):
        flights += float(alive.sum())
        alive = np.convolve(alive, each)
        decided["many"] += float(alive[most[n] :].sum())
        alive = alive[: most[n]]
        decided["few"] += float(alive[: fewest[n]].sum())
        alive[: fewest[n]] = 0.0
        if median is None and decided["few"] + decided["many"] >= 0.5:
            median = n
    return Chance(decided["few"], decided["many"], flights, median)
