"""Importance splitting along time: alarms of a launch detector in white noise, however rare.

A detector's memory and the number of the sample are a Markov state. Its distance from an alarm is counted in samples,

    m(state) = least number of samples of a launch's push after which it would recognise,

which is had by trying: the state is copied and fed with the push. This works for any rule, whatever it remembers. An
excursion begins at a sample at which m falls to a base m₀ or below, and ends when m is above m₀ again. Whoever alarms
does so in exactly one excursion, and before it has been at the distances m₀, m₀ - 1, …, 1. Therefore

    P(alarm in the sequence) = λ · p₁ · p₂ ⋯,      λ expected excursions in a sequence,
                                                   p_i share of those at distance m₀ - i + 1 or nearer that come nearer
                                                   by one, or alarm, before the excursion or the sequence ends

λ is counted in whole sequences; the states in which their excursions begin are kept. For each p_i a fixed number of
trials begin at states drawn from those kept at the level before, with fresh noise from there on ("fixed effort"). The
product is unbiased for any m₀ and any numbers of trials, if these are fixed beforehand: here by a pilot with noise of
its own. Work is counted in samples that a detector takes, those of the trying included, over the length of a sequence.

Sources: Garvels, The splitting method in rare event simulation, 2000 (fixed effort); Allen, Frenkel & ten Wolde,
J. Chem. Phys. 124 (2006) 024102 (flux times conditional probabilities); Cérou & Guyader, Stoch. Anal. Appl. 25 (2007)
417 (unbiasedness).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import nan
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import Compiled, compiled
from uavsim.onboard.launch import DetectorSettings, build
from uavsim.onboard.launch.compiled import Loop

Floats = NDArray[np.float64]
Wholes = NDArray[np.int64]

FARTHEST = 400  # samples of push after which a detector that has not recognised is taken for one that cannot
FREQUENT = 0.15  # largest share of samples within an excursion; the base is the farthest distance that keeps it
GATE = 0.5  # σ; outside excursions the distance is looked at after samples above the mean by as much
KEPT = 20_000  # most states kept at a level; of more, a uniform draw
PILOT_TRIALS = 100  # at each distance
PILOT_SHARE = 0.05  # of the budget, for the pilot's whole sequences
LEAST_TRIALS = 10  # at each distance of a run
VISITED = 1000  # samples of a sequence that are looked at to measure distances
LOOKS = 16  # about so often is the distance looked at on the shortest way to an alarm
EASY = 0.8  # –, share of trials above which a distance is left out
STEP = 1.2  # –, of the distance; it is the logarithm of a chance
FIRST_SHARE = 0.3  # of a run's work that counts excursions
FULL = 0.93  # of the budget that is planned for: trials have random lengths


class NoSplittingError(ValueError):
    """A detector that cannot be split; one line."""


@dataclass(frozen=True)
class Watch:
    """A detector on its launch axis while nothing is launched; it reads `mean[k]` + `sigma`·ξ_k, ξ_k standard normal.

    Attributes
    ----------
    settings : DetectorSettings
        Of the detector.
    mean : ndarray
        Shape (n,): mean reading along its axis, m/s².
    sigma : float
        Deviation of the white noise, m/s².
    rate : float
        Samples a second, Hz.
    push : float
        What a launch reads, m/s²: the distance of a state from an alarm is counted in samples of it.

    Raises
    ------
    ValueError
        If there are no samples, or something is not finite or out of bounds.
    """

    settings: DetectorSettings
    mean: Floats
    sigma: float
    rate: float = 1000.0
    push: float = 66.0

    def __post_init__(self) -> None:
        mean = np.asarray(self.mean, np.float64)
        object.__setattr__(self, "mean", mean)
        if mean.ndim != 1 or mean.size == 0 or not np.isfinite(mean).all():
            raise ValueError("mean must hold at least one sample, all finite")
        if not (0.0 < self.sigma < np.inf and 0.0 < self.rate < np.inf):
            raise ValueError("sigma and rate must be above 0 and finite")
        if not np.isfinite(self.push):
            raise ValueError("push must be finite")


# -- loops that are compiled with a detector's rule in them ------------------------------------------------------------
# A signal is (mean, sigma, rate, rest, push), a measure (most, table) with the farthest m that counts and the distance
# by m and d. `tried` holds the samples taken by trying, and the slack found last, at which the next search begins.

RULE: Any = None  # the detector's rule; takes its place when a loop is bound to it
DISTANCE: Any = None
TRY: Any = None


def _try(p: Any, q: Any, x: Any, y: Any, k: int, signal: Any, rests: int, most: int, work: Any) -> Any:
    """Samples until the alarm if pushes are read and at last so many rests, at most `most`; else `most` + 1."""
    _, _, rate, rest, push = signal
    f, out = np.empty(1), np.empty(1, np.int64)
    x1, y1 = x.copy(), y.copy()
    for m in range(1, most + 1):
        f[0] = push if m <= most - rests else rest
        if RULE(f, k, rate, p, q, x1, y1, out) > 0:
            work[0] += m
            return m
        k += 1
    work[0] += most
    return most + 1


def _distance(p: Any, q: Any, x: Any, y: Any, k: int, signal: Any, measure: Any, tried: Any) -> Any:
    """Distance of a state from an alarm; that of (most + 1, 0) if it cannot come there in `most` samples."""
    most, table = measure
    m = TRY(p, q, x, y, k, signal, 0, most, tried)
    if m > most:
        return table[most + 1, 0]
    slack = min(max(tried[1], 0), m - 1)
    if slack == 0 or TRY(p, q, x, y, k, signal, slack, m, tried) <= m:
        while slack < m - 1 and TRY(p, q, x, y, k, signal, slack + 1, m, tried) <= m:
            slack += 1
    else:
        slack -= 1
        while slack > 0 and TRY(p, q, x, y, k, signal, slack, m, tried) > m:
            slack -= 1
    tried[1] = slack
    return table[m, m - slack]


def _enter(
    p: Any, q: Any, x0: Any, y0: Any, signal: Any, measure: Any, base: int, gate: float, stride: int, paths: int,
    rng: Any, xs: Any, ys: Any, ks: Any,
) -> Any:  # fmt: skip
    """Follow whole sequences; return how many excursions began, and the samples that were taken.

    Their states go into xs, ys and ks (the next sample's number; negative: it has alarmed), a uniform draw of them.
    """
    mean, sigma, rate, _, _ = signal
    f, out, tried = np.empty(1), np.empty(1, np.int64), np.zeros(2, np.int64)
    x, y = x0.copy(), y0.copy()
    begun, work, n, room = 0, 0, mean.size, ks.size
    for _ in range(paths):
        x[:] = x0
        y[:] = y0
        inside = False
        for k in range(n):
            z = rng.standard_normal()
            f[0] = mean[k] + sigma * z
            alarm = RULE(f, k, rate, p, q, x, y, out) > 0
            work += 1
            near = alarm
            looked = k % stride == 0 and (inside or z > gate)
            if looked and not alarm:
                near = DISTANCE(p, q, x, y, k + 1, signal, measure, tried) <= base
            if near and not inside:
                place = begun if begun < room else int(rng.random() * (begun + 1))
                begun += 1
                if place < room:
                    xs[place] = x
                    ys[place] = y
                    ks[place] = -1 if alarm else k + 1
            if looked or alarm:
                inside = near
            if alarm:
                break
    return begun, work + tried[0]


def _advance(
    p: Any, q: Any, xs: Any, ys: Any, ks: Any, signal: Any, measure: Any, base: int, level: int, stride: int,
    trials: int, rng: Any, xs2: Any, ys2: Any, ks2: Any,
) -> Any:  # fmt: skip
    """Try to come from the states kept to a distance of `level` or an alarm; return successes and samples taken."""
    mean, sigma, rate, _, _ = signal
    f, out, tried = np.empty(1), np.empty(1, np.int64), np.zeros(2, np.int64)
    x, y = xs[0].copy(), ys[0].copy()
    work, n, kept, room, first, reached = 0, mean.size, ks.size, ks2.size, rng.random(), 0
    for i in range(trials):
        begin = min(kept - 1, int((i + first) * kept / trials))
        x[:] = xs[begin]
        y[:] = ys[begin]
        k = ks[begin]
        alarm = k < 0
        near = alarm or (level > 0 and DISTANCE(p, q, x, y, k, signal, measure, tried) <= level)
        while not near and k < n:
            f[0] = mean[k] + sigma * rng.standard_normal()
            alarm = RULE(f, k, rate, p, q, x, y, out) > 0
            work += 1
            k += 1
            near = alarm
            if not alarm and (k - 1) % stride == 0:
                distance = DISTANCE(p, q, x, y, k, signal, measure, tried)
                near = distance <= level
                if distance > base:
                    break
        if near:
            place = reached if reached < room else int(rng.random() * (reached + 1))
            reached += 1
            if place < room:
                xs2[place] = x
                ys2[place] = y
                ks2[place] = -1 if alarm else k
    return reached, work + tried[0]


def _visit(p: Any, q: Any, x0: Any, y0: Any, signal: Any, most: int, paths: int, rng: Any, found: Any) -> Any:
    """Count the m and d at which whole sequences are (found[m, d, 0]), and after which d has fallen (found[…, 1])."""
    mean, sigma, rate, _, _ = signal
    f, out, tried = np.empty(1), np.empty(1, np.int64), np.zeros(2, np.int64)
    x, y = x0.copy(), y0.copy()
    work = 0
    for _ in range(paths):
        x[:] = x0
        y[:] = y0
        before, left = 0, 0
        for k in range(mean.size):
            f[0] = mean[k] + sigma * rng.standard_normal()
            work += 1
            if RULE(f, k, rate, p, q, x, y, out) > 0:
                break
            m = TRY(p, q, x, y, k + 1, signal, 0, most, tried)
            d = 0
            if m <= most:
                slack = min(max(tried[1], 0), m - 1)
                while slack > 0 and TRY(p, q, x, y, k + 1, signal, slack, m, tried) > m:
                    slack -= 1
                while slack < m - 1 and TRY(p, q, x, y, k + 1, signal, slack + 1, m, tried) <= m:
                    slack += 1
                tried[1] = slack
                d = m - slack
            found[m, d, 0] += 1
            if left > 0 and 0 < d < left:
                found[before, left, 1] += 1
            before, left = m, d
    return work + tried[0]


def _bound(function: Callable[..., Any], name: str, **parts: Any) -> Compiled[..., Any]:
    """Return a loop with a detector's rule in it, compiled; `name` keeps their machine codes apart."""
    assert isinstance(function, FunctionType)
    made = FunctionType(function.__code__, {**function.__globals__, **parts}, function.__name__)
    made.__module__, made.__qualname__ = function.__module__, f"{function.__name__}_{name}"
    return compiled(made)


@dataclass(frozen=True)
class _Loops:
    attempt: Callable[..., Any]
    enter: Callable[..., Any]
    advance: Callable[..., Any]
    visit: Callable[..., Any]


@lru_cache(maxsize=64)
def _loops(rule: Any) -> _Loops:
    one = rule if isinstance(rule, Compiled) else compiled(rule)
    name = f"{one.function.__module__.rpartition('.')[2]}{one.function.__name__}"
    trying = _bound(_try, name, RULE=one)
    parts = {"RULE": one, "TRY": trying, "DISTANCE": _bound(_distance, name, RULE=one, TRY=trying)}
    return _Loops(trying, *(_bound(function, name, **parts) for function in (_enter, _advance, _visit)))


# -- the estimator -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Plan:
    """What a pilot has fixed.

    Attributes
    ----------
    base : int
        m₀.
    most : int
        Samples of push after which a state counts as far.
    table : ndarray
        Distance by m and d.
    paths : int
        Sequences followed.
    levels, trials : tuple of int
        Distances to come to, the last of them 0, the alarm; and trials for each.
    """

    base: int
    most: int
    table: Wholes
    paths: int
    levels: tuple[int, ...]
    trials: tuple[int, ...]

    @property
    def stride(self) -> int:
        """Every how many samples a distance is looked at: what has far to go comes no nearer in between."""
        return max(1, self.most // LOOKS)

    def scaled(self, factor: float) -> "Plan":
        """The same with so many times as many trials, at least `LEAST_TRIALS` at each distance."""
        trials = tuple(max(LEAST_TRIALS, int(factor * t)) for t in self.trials)
        return replace(self, paths=max(1, int(factor * self.paths)), trials=trials)


@dataclass(frozen=True)
class Run:
    """One run: its estimate, expected excursions a sequence, the shares p_i, and the work in sequences."""

    probability: float
    excursions: float
    shares: tuple[float, ...]
    work: float


class Splitter:
    """Importance splitting of one watch.

    Parameters
    ----------
    watch : Watch

    Raises
    ------
    NoSplittingError
        If the detector has no loop, reads several axes, or does not recognise the push.
    ValueError
        Settings that do not fit together.
    """

    def __init__(self, watch: Watch) -> None:
        self.watch = watch
        detector = build(watch.settings, watch.rate)
        kind = watch.settings.kind
        if not hasattr(detector, "loop"):
            raise NoSplittingError(f"detector {kind!r} has no loop, so that its state cannot be copied")
        loop: Loop = detector.loop()
        if len(loop.rows) > 1 or loop.rows == ("any",) or watch.settings.axes == "any":
            raise NoSplittingError(f"detector {kind!r} reads several axes; splitting takes one")
        if len(watch.settings.axes) != 1:
            raise NoSplittingError(f"detector {kind!r} reads {len(watch.settings.axes)} axes; splitting takes one")
        self._loops = _loops(loop.rule)
        state = np.array(loop.x, np.float64), np.array(loop.y, np.int64)
        self._detector = loop.p, loop.q, *state
        self._signal = watch.mean, float(watch.sigma), float(watch.rate), float(watch.mean.mean()), float(watch.push)

    @classmethod
    def takes(cls, watch: Watch) -> bool:
        """Whether a watch's detector can be split."""
        try:
            cls(watch)
        except NoSplittingError:
            return False
        return True

    def plan(self, seed: np.random.SeedSequence, budget: float, runs: int) -> tuple[Plan, float]:
        """Fix by a pilot what each run does, so that all take about `budget` sequences with the pilot; return its work.

        The pilot measures distances in one sequence and goes down once, with few trials. What it leaves is shared so
        that the variance is least: trials ∝ √((1 - p)/(p·cost)).
        """
        rng = np.random.default_rng(seed)
        base, most, table, work = self._measure(rng)
        n = self.watch.mean.size
        every = tuple(range(base - 1, -1, -1))
        paths = max(1, int(PILOT_SHARE * budget / (1.0 + most)))
        pilot, costs = self._run(rng, Plan(base, most, table, paths, every, (PILOT_TRIALS,) * base))
        work += pilot.work
        shares = np.array([*pilot.shares] + [nan] * (base - len(pilot.shares)))
        shares = np.where(np.isnan(shares), 0.1, shares)
        asked = (shares < EASY) | (np.array(every) == 0)
        cost = np.array([*costs[1:]] + [costs[-1] if len(costs) > 1 else 1.0] * (base - len(costs) + 1))
        cost, shares = np.maximum(cost[asked], 1.0) / n, np.clip(shares[asked], 0.01, 0.99)  # sequences a trial
        wanted = np.sqrt((1.0 - shares) / shares / cost)
        left = max(0.0, FULL * budget - work) / runs
        trials = np.maximum(LEAST_TRIALS, np.floor(wanted * ((1.0 - FIRST_SHARE) * left / (wanted @ cost)))).astype(int)
        paths = max(1, int(FIRST_SHARE * left / (costs[0] / n)))
        levels = tuple(int(level) for level in np.array(every)[asked])
        return Plan(base, most, table, paths, levels, tuple(int(t) for t in trials)), work

    def run(self, seed: np.random.SeedSequence, plan: Plan) -> Run:
        """Estimate once."""
        return self._run(np.random.default_rng(seed), plan)[0]

    def _measure(self, rng: np.random.Generator) -> tuple[int, int, Wholes, float]:
        """Measure how far sequences are from an alarm; return m₀, the farthest m, the table, and the work."""
        watch, (mean, *others) = self.watch, self._signal
        tried = np.zeros(2, np.int64)
        fresh = self._loops.attempt(*self._detector, 0, self._signal, 0, FARTHEST, tried)
        farthest = min(FARTHEST, fresh + fresh // 4 + 2)
        found = np.zeros((farthest + 2, farthest + 2, 2), np.int64)
        work = self._loops.visit(*self._detector, (mean[:VISITED], *others), farthest, 1, rng, found) + tried[0]
        near = found[: farthest + 1, :, 0]
        if not near.any() and found.any():
            raise NoSplittingError(
                f"detector {watch.settings.kind!r} does not recognise {watch.push:g} m/s² in {FARTHEST} samples: "
                "give a push that it does"
            )
        by = found.sum(axis=0)[1:]
        often = (by[:, 0] >= 50) & (by[:, 1] < 0.9 * by[:, 0])  # where all samples bring nearer, it is time that does
        like_push = float(np.max(by[often, 1] / by[often, 0], initial=0.0))
        table = _table(round(min(max(like_push, 0.02), 0.5), 2), farthest)
        known = table[: farthest + 1]
        at = np.bincount(known[near > 0], weights=near[near > 0], minlength=2)
        share = np.cumsum(at) / max(1, found[:, :, 0].sum())
        within = np.flatnonzero(share <= FREQUENT)
        nearest = int(np.argmax(at > 0)) if at.any() else 2
        base = max(1, int(within[-1]) if within.size and within[-1] >= nearest else nearest - 1)
        inside = np.flatnonzero(((known <= base) & (near > 0)).any(axis=1))
        seen = np.flatnonzero((near > 0).any(axis=1))
        most = int(inside[-1] if inside.size else seen[0] if seen.size else farthest)
        return base, most, table, work / mean.size

    def _run(self, rng: np.random.Generator, plan: Plan) -> tuple[Run, list[float]]:
        """One run, and what a sequence and a trial at each distance cost, in samples."""
        (p, q, x, y), n = self._detector, self.watch.mean.size
        measure, width = (plan.most, plan.table[[*range(plan.most + 1), -1]]), (x.size, y.size)
        kept = _kept(KEPT, *width)
        begun, work = self._loops.enter(
            *self._detector, self._signal, measure, plan.base, GATE, plan.stride, plan.paths, rng, *kept
        )
        costs, total = [work / plan.paths], work
        shares: list[float] = []
        excursions = begun / plan.paths
        probability, count = excursions, min(begun, KEPT)
        for level, trials in zip(plan.levels, plan.trials, strict=True):
            if not count:
                return Run(0.0, excursions, tuple(shares), total / n), costs
            pool = tuple(part[:count] for part in kept)
            kept = _kept(min(trials, KEPT), *width)
            reached, work = self._loops.advance(
                p, q, *pool, self._signal, measure, plan.base, level, plan.stride, trials, rng, *kept
            )
            total += work
            costs.append(work / trials)
            shares.append(reached / trials)
            probability *= reached / trials
            count = min(reached, KEPT)
        return Run(probability, excursions, tuple(shares), total / n), costs


@lru_cache(maxsize=32)
def _table(like_push: float, farthest: int) -> Wholes:
    """Distance by m and d: -ln P(at least d of m samples act like a push) over `STEP`, rounded up; last row: far."""
    from scipy.special import betainc

    m, d = np.ogrid[: farthest + 2, : farthest + 2]
    chance = np.where(
        d == 0, 1.0, np.where(d > m, 0.0, betainc(np.maximum(d, 1.0), np.maximum(m - d + 1.0, 1.0), like_push))
    )
    with np.errstate(divide="ignore"):
        value = -np.log(np.where(chance > 0.0, chance, 1e-300))
    table = np.maximum(1, np.ceil(value / STEP)).astype(np.int64)
    table[-1] = table.max() + 1
    return table


def _kept(count: int, reals: int, wholes: int) -> tuple[Floats, Wholes, Wholes]:
    return np.empty((count, reals)), np.empty((count, wholes), np.int64), np.empty(count, np.int64)
