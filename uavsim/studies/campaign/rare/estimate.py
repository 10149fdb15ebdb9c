"""Estimate the probability of a rare event within a budget of flights' worth of work.

What is asked decides how:

    Watch               alarms of a detector in white noise: importance splitting along time (`splitting`), a pilot and
                        ten independent runs; interval from the ten, Student's t on the logarithm
    Inputs, up to 20    subset simulation finds failures, importance sampling around them (`shifted`) tells how many;
                        normal interval on the logarithm. Where the two do not agree, or the weights hang on one
                        sample, a second subset simulation takes the place of the second half
    Inputs, more        subset simulation alone
    Inputs with a whole the number of a flight's noise moves as a whole, and a chain that has a lucky one would keep it:
                        importance sampling whose mixture goes down by rounds (cross entropy, Rubinstein & Kroese 2004),
                        the number drawn anew for every sample

The work of one flight is one simulation of the whole input. Splitting simulates parts: they count by their samples over
those of the whole, and `starts` counts each part as one.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import exp, expm1, inf, log1p, nan, sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.rare import shifted, subset
from uavsim.studies.campaign.rare.splitting import Plan, Run, Splitter, Watch

Floats = NDArray[np.float64]
Method = Literal[
    "splitting",
    "subset simulation",
    "subset simulation and importance sampling",
    "importance sampling by cross entropy",
]

RUNS = 10  # of splitting
AIM = 0.94  # of the budget; trials have random lengths, and the last run cannot be mended
PILOT = 0.45  # of the budget, for the subset simulation that finds failures
ROUND, MOST_ROUNDS = 0.08, 6  # of cross entropy: share of the budget, and how many
LEAST_ROUND = 100
SURE = 0.5  # variation of a round from which a bound is taken where the event was not reached
ELITE = 0.2  # –, of a round's samples, to which the next mixture is fitted
FIRST_ROUND = 0.3  # of the samples around failures, that fit the mixture of the others
DEEPEST = 7  # levels of a tenth that a budget is planned for: 1e-7
LEAST_BUDGET = 200  # flights' worth
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Inputs:
    """An event of standard normal inputs: it comes true where the margin is at or below 0.

    Attributes
    ----------
    margins : callable
        Margins g of inputs of shape (n, dimension), shape (n,); NaN counts as safe.
    dimension : int
        How many inputs.
    whole : int
        How many of them, the last, are kept or drawn anew together (see `subset`).
    names : tuple of str
        Of the inputs, for the table of failures.

    Raises
    ------
    ValueError
        If there are no inputs, or as many names as inputs are not given.
    """

    margins: Callable[[Floats], Floats]
    dimension: int
    whole: int = 0
    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.dimension < 1 or not 0 <= self.whole <= self.dimension:
            raise ValueError(f"a problem of {self.dimension} inputs, {self.whole} of them whole, cannot be")
        if self.names and len(self.names) != self.dimension:
            raise ValueError(f"{len(self.names)} names for {self.dimension} inputs")


@dataclass(frozen=True)
class Step:
    """A level of the way down.

    Attributes
    ----------
    level : float
        Bound on the margin; in splitting the distance from the alarm.
    probability : float
        Of coming there.
    variation : float
        Its coefficient of variation.
    share : float
        Of those that came to the level before.
    """

    level: float
    probability: float
    variation: float
    share: float


@dataclass(frozen=True)
class Estimate:
    """What was found.

    Attributes
    ----------
    probability : float
        0 where the event was not reached.
    low, high : float
        95 % interval; where the event was not reached, a bound from the last level that was.
    variation : float
        Coefficient of variation of the estimate; infinite where the event was not reached.
    method : str
    work : float
        Flights' worth.
    starts : int
        Simulations that were begun, parts counted as whole.
    seed : int
    steps : tuple of Step
    failures : ndarray
        Shape (n, dimension), most likely first, up to 10; none from splitting.
    names : tuple of str
        Of their columns.
    reached : bool
        Whether the event was reached at all.
    """

    probability: float
    low: float
    high: float
    variation: float
    method: Method
    work: float
    starts: int
    seed: int
    steps: tuple[Step, ...]
    failures: Floats = field(default_factory=lambda: np.empty((0, 0)))
    names: tuple[str, ...] = ()
    reached: bool = True


def estimate(problem: Watch | Inputs, *, seed: int = 1, budget: float = 6000.0) -> Estimate:
    """Estimate the probability of a rare event.

    Parameters
    ----------
    problem : Watch or Inputs
        A detector that is watched while nothing is launched, or an event of normal inputs.
    seed : int
        Fixes the result.
    budget : float
        Most flights' worth of work.

    Raises
    ------
    ValueError
        If the budget is below 200, the seed negative, or the detector cannot be split.

    Examples
    --------
    >>> import numpy as np
    >>> from uavsim.onboard.launch import DetectorSettings
    >>> hold = DetectorSettings(kind="single-threshold", threshold=45.0, window=0.010)
    >>> found = estimate(Watch(hold, np.full(1000, 39.3143), 5.0), seed=1)  # 1.0e-6 exactly
    >>> found.low < 1e-6 < found.high, found.work < 6000
    (True, True)
    """
    if not LEAST_BUDGET <= budget < inf:
        raise ValueError(f"the budget must be at least {LEAST_BUDGET} flights' worth, not {budget:g}")
    if seed < 0:
        raise ValueError(f"the seed must be at least 0, not {seed}")
    if isinstance(problem, Watch):
        return _split(problem, seed, float(budget))
    return _subset(problem, seed, int(budget))


def interval(probability: float, variation: float, factor: float = 1.959964) -> tuple[float, float]:
    """Lognormal interval of a probability with this coefficient of variation."""
    if not probability > 0.0:
        return 0.0, 1.0
    half = factor * sqrt(log1p(variation**2))
    return probability * exp(-half), min(1.0, probability * exp(half))


# -- splitting ---------------------------------------------------------------------------------------------------------


def _split(watch: Watch, seed: int, budget: float) -> Estimate:
    from scipy.special import stdtrit

    first, *others = np.random.SeedSequence(seed).spawn(1 + RUNS)
    splitter = Splitter(watch)
    plan, work = splitter.plan(first, budget, RUNS)
    runs: list[Run] = []
    scale, scales, spent = 1.0, 0.0, 0.0
    for number, other in enumerate(others):  # each is as long as what those before it took allows; its own noise has
        if spent:  # no part in that
            scale = min(1.5, (AIM * budget - work) / (RUNS - number) * scales / spent)
        runs.append(splitter.run(other, plan.scaled(scale)))
        work, spent, scales = work + runs[-1].work, spent + runs[-1].work, scales + scale
    found = np.array([run.probability for run in runs])
    probability = float(found.mean())
    variation = float(found.std(ddof=1)) / probability / sqrt(RUNS) if probability > 0.0 else inf
    steps = _steps(plan, runs)
    low, high = interval(probability, variation, float(stdtrit(RUNS - 1, 0.5 + 0.5 * CONFIDENCE)))
    if not probability > 0.0:
        low, high = 0.0, _not_reached(steps, plan)
    return Estimate(
        probability=probability,
        low=low,
        high=high,
        variation=variation,
        method="splitting",
        work=work,
        starts=RUNS * (plan.paths + sum(plan.trials)),
        seed=seed,
        steps=steps,
        reached=probability > 0.0,
    )


def _steps(plan: Plan, runs: list[Run]) -> tuple[Step, ...]:
    """Levels, each with the mean over the runs of the product up to there; the first is excursions a sequence."""
    depth = len(plan.levels)
    shares = np.zeros((len(runs), 1 + depth))
    for row, run in zip(shares, runs, strict=True):
        row[0] = run.excursions
        row[1 : 1 + len(run.shares)] = run.shares
    products = np.cumprod(shares, axis=1)
    means = products.mean(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        variations = np.where(means > 0.0, products.std(axis=0, ddof=1) / sqrt(len(runs)) / means, inf)
        step = np.where(means[:-1] > 0.0, means[1:] / means[:-1], nan)
    return tuple(
        Step(float(level), float(mean), float(variation), float(share))
        for level, mean, variation, share in zip(
            (plan.base, *plan.levels), means, variations, (means[0], *step), strict=True
        )
    )


def _not_reached(steps: tuple[Step, ...], plan: Plan) -> float:
    """Bound where nothing came to the alarm: the last level that was reached, times 3 over its trials (95 %)."""
    tried = (plan.paths, *plan.trials)
    for step, before, trials in zip(steps[::-1], (*steps[-2::-1], None), tried[::-1], strict=True):
        if before is None:
            return 1.0 if step.probability > 0.0 else min(1.0, 3.0 / (RUNS * trials))
        if before.probability > 0.0:
            return min(1.0, before.probability * 3.0 / (RUNS * trials))
    return 1.0


# -- subset simulation -------------------------------------------------------------------------------------------------


def _subset(problem: Inputs, seed: int, budget: int) -> Estimate:
    first, second = np.random.SeedSequence(seed).spawn(2)
    around = problem.dimension - problem.whole
    finish = 0 < around <= shifted.MOST_INPUTS
    if problem.whole and 0 < around <= shifted.MOST_BESIDE_NOISE:
        return _cross_entropy(problem, seed, budget, np.random.default_rng(first))
    share = PILOT if finish else 1.0
    samples = int(share * budget / (1.0 + (1.0 - subset.P0) * DEEPEST))
    found = subset.run(problem.margins, problem.dimension, first, samples, budget, problem.whole)
    if not found.complete:
        return _incomplete(found, problem, seed)
    if not finish:
        return _from_subset(found, problem, seed)
    left = budget - found.evaluations
    values, failures = _around(problem, found, left, max(1.0, subset.P0 * samples), np.random.default_rng(second))
    if not shifted.trusted(values, found.probability, _between(found)):
        return _from_subset(found, problem, seed, work=budget)
    probability = float(values.mean())
    variation = float(values.std(ddof=1)) / probability / sqrt(len(values))
    low, high = interval(probability, variation, _factor(values))
    return Estimate(
        probability=probability,
        low=low,
        high=high,
        variation=variation,
        method="subset simulation and importance sampling",
        work=float(budget),
        starts=budget,
        seed=seed,
        steps=_levels(found),
        failures=_most_likely(np.vstack([found.failures, failures]), around),
        names=problem.names,
    )


def _around(
    problem: Inputs, found: subset.Subset, n: int, independent: float, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Two rounds of samples around the failures found: weighted indicators of the second, and all that failed."""
    around = problem.dimension - problem.whole
    known = found.failures[:, :around]
    mixture = shifted.fit(known, np.ones(len(known)), min(independent, len(known)), rng)
    failures = []
    for size in (int(FIRST_ROUND * n), n - int(FIRST_ROUND * n)):
        mixture = shifted.mirrored(mixture)
        u = np.hstack([mixture.draw(size, rng), rng.standard_normal((size, problem.whole))])
        failed = np.asarray(problem.margins(u), np.float64) <= 0.0
        values = np.where(failed, mixture.ratio(u[:, :around]), 0.0)
        failures.append(u[failed])
        weights = values[failed]
        if len(weights):
            many = float(weights.sum() ** 2 / (weights @ weights))
            mixture = shifted.fit(u[failed][:, :around], weights, many, rng)
    return values, np.vstack(failures)


def _cross_entropy(problem: Inputs, seed: int, budget: int, rng: np.random.Generator) -> Estimate:
    """Importance sampling whose mixture goes down by rounds; what moves as a whole is drawn anew for every sample."""
    around = problem.dimension - problem.whole
    size, used, steps = max(LEAST_ROUND, int(ROUND * budget)), 0, list[Step]()
    mixture = shifted.Mixture(np.ones(1), np.zeros((1, around)))
    for _ in range(min(MOST_ROUNDS, budget // (2 * size))):
        u, g, ratio = _drawn(problem, mixture, size, rng)
        used += size
        bound = max(0.0, float(np.partition(g, int(ELITE * size))[int(ELITE * size)]))
        below = g <= bound
        weights = ratio[below]
        if np.isinf(bound) or not below.any():
            break
        p = float(weights.sum()) / size
        before = steps[-1].probability if steps else 1.0
        variation = float(np.where(below, ratio, 0.0).std(ddof=1)) / p / sqrt(size)
        steps.append(Step(bound, p, variation, p / before))
        if below.all():
            break
        many = float(weights.sum() ** 2 / (weights @ weights))
        mixture = shifted.mirrored(shifted.fit(u[below][:, :around], weights, many, rng))
        if bound == 0.0:
            break
    u, g, ratio = _drawn(problem, mixture, budget - used, rng)
    failed = g <= 0.0
    values = np.where(failed, ratio, 0.0)
    if not failed.any():
        sure = [step for step in steps if step.variation < SURE]
        last = min(sure, key=lambda step: step.probability, default=Step(nan, 1.0, 0.0, 1.0))
        return _incomplete_at(last, tuple(steps), problem, seed, budget)
    probability = float(values.mean())
    variation = float(values.std(ddof=1)) / probability / sqrt(len(values))
    low, high = interval(probability, variation, _factor(values))
    return Estimate(
        probability=probability,
        low=low,
        high=high,
        variation=variation,
        method="importance sampling by cross entropy",
        work=float(budget),
        starts=budget,
        seed=seed,
        steps=tuple(steps),
        failures=_most_likely(u[failed], around),
        names=problem.names,
    )


def _drawn(
    problem: Inputs, mixture: shifted.Mixture, n: int, rng: np.random.Generator
) -> tuple[Floats, Floats, Floats]:
    """Inputs from a mixture, their margins, and their weights."""
    u = np.hstack([mixture.draw(n, rng), rng.standard_normal((n, problem.whole))])
    g = np.asarray(problem.margins(u), np.float64)
    return u, np.where(np.isnan(g), inf, g), mixture.ratio(u[:, : mixture.centres.shape[1]])


def _factor(values: Floats) -> float:
    """Student's quantile for as many samples as the weights are worth."""
    from scipy.special import stdtrit

    many = float(values.sum() ** 2 / (values @ values))
    return float(stdtrit(max(1.0, many - 1.0), 0.5 + 0.5 * CONFIDENCE))


def _from_subset(found: subset.Subset, problem: Inputs, seed: int, work: int | None = None) -> Estimate:
    variation = _between(found)
    low, high = interval(found.probability, variation)
    used = found.evaluations if work is None else work
    return Estimate(
        probability=found.probability,
        low=low,
        high=high,
        variation=variation,
        method="subset simulation",
        work=float(used),
        starts=used,
        seed=seed,
        steps=_levels(found),
        failures=_most_likely(found.failures, problem.dimension - problem.whole),
        names=problem.names,
    )


def _between(found: subset.Subset) -> float:
    """Coefficient of variation between those of levels that are independent and that go together."""
    return sqrt(found.variation * sum(level.variation for level in found.levels))


def _incomplete(found: subset.Subset, problem: Inputs, seed: int) -> Estimate:
    steps = _levels(found)
    last = steps[-1] if steps else Step(nan, 1.0, 0.0, 1.0)
    return _incomplete_at(last, steps, problem, seed, found.evaluations)


def _incomplete_at(last: Step, steps: tuple[Step, ...], problem: Inputs, seed: int, used: int) -> Estimate:
    return Estimate(
        probability=0.0,
        low=0.0,
        high=interval(last.probability, last.variation)[1],
        variation=inf,
        method="importance sampling by cross entropy" if problem.whole else "subset simulation",
        work=float(used),
        starts=used,
        seed=seed,
        steps=steps,
        failures=np.empty((0, problem.dimension)),
        names=problem.names,
        reached=False,
    )


def _levels(found: subset.Subset) -> tuple[Step, ...]:
    steps, probability, squares = [], 1.0, 0.0
    for level in found.levels:
        probability *= level.share
        squares += level.variation**2
        steps.append(Step(level.bound, probability, sqrt(squares), level.share))
    return tuple(steps)


def _most_likely(failures: Floats, around: int) -> Floats:
    """Up to ten failures, nearest to the origin first: where the inputs' density is largest."""
    distinct = np.unique(failures, axis=0)
    return distinct[np.argsort((distinct[:, :around] ** 2).sum(axis=1), kind="stable")[:10]]


def per_hour(probability: float, seconds: float) -> float:
    """Rate of a Poisson process, 1/h, that comes in so many seconds with a probability."""
    return inf if probability >= 1.0 else -log1p(-probability) * 3600.0 / seconds


def within(rate: float, seconds: float) -> float:
    """Probability of coming in so many seconds, from a rate, 1/h."""
    return -expm1(-rate * seconds / 3600.0)
