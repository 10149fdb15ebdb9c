"""Whether requirements are met, with a stated confidence c, from a growing number of flights.

Each requirement has two tests of its own, `met` and `not met`, that may be looked at as often as one likes
(`sequential`). Each gives a p-value: the smallest error level at which it has decided so far. With α = 1 - c and m
requirements, three statements are made, each with its own error rate, at whatever number of flights one stops:

1. **All are met**: every p-value of `met` is α or less. This is an intersection-union test (Berger, Technometrics 24,
   1982, 295-300): if one requirement is not met, its own test errs with α at most, and the statement needs all of
   them. No correction is needed. `Verification.met`, exit status 0. P(said although one is not met) ≤ α.
2. **This one is met**, said of single ones where not all are: Holm's procedure (Scand. J. Statist. 6, 1979, 65-70)
   over the m p-values of `met`. P(it is said of any that is not met) ≤ α, whatever the dependence.
3. **This one is not met**: Holm's procedure over the m p-values of `not met`. P(it is said of any that is met) ≤ α,
   whatever the dependence. Sequential looks and Holm go together because a p-value that holds at every look is an
   ordinary p-value at the flight where one stops, and Holm's procedure rejects no less as p-values fall.

Statements 1 and 2 share the word "met". That any "met" of a report is wrong has probability α at most if one
requirement fails, and if several fail and their p-values depend positively (both are implied by Simes' test of the
failed ones; Sarkar, Ann. Statist. 26, 1998, 494-504); under any dependence it is (2 - 1/f) α at most with f failed
ones. A "met" and a "not met" of one report are each held by their own α. Where both tests of one requirement have
decided, neither is said.

`low` and `high` of a requirement are bounds at confidence c each, on its own and without correction, that hold at every
look together: `met` by statement 1 means that the bound on the wrong side lies within what is allowed.

**every** cannot be shown by any number of flights. It is `not met` with the first flight that does not meet it, with
no error. It is `met` once flights without a failure show with confidence c that at least 95 % of all flights meet it
(Wilks' 95/95 criterion: 59 flights). So its estimate is the share of flights that meet it, and its bound is 0.95.

What a flight without a value counts as stands in `uavsim.requirements`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from uavsim.requirements import OUTCOME, Requirement
from uavsim.studies.campaign import sequential
from uavsim.studies.campaign.estimates import mean_bounds
from uavsim.studies.campaign.sequential import Exposure, Flights

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Word = Literal["met", "not met", "undecided"]

EVERY_SHARE = 0.95  # of all flights, which flights without a failure must show
EVIDENCE = (0.5, 0.2, 0.1, 0.05, 0.01, 1e-3, 1e-4, 1e-6)  # levels that are tried besides Holm's
MEAN_EVIDENCE = (0.2, 0.05, 0.01)  # of means, whose looks spend a share of each
FIRST, GROWTH = 8, 1.1  # first look, and how much later each next one is
RARE, LOOKS_FOR_FEW = 0.02, 3  # n_0, n_1, n_2 of `few` are looks of their own where the event may not be more frequent
LEAST_GAP, CLOSE = 4, 0.05  # between looks, flights and share of them
FURTHEST, MOST_EVENTS = 1_000_000, 1024.0  # flights, and expected events, to which is planned ahead
MOST_SURPLUS = 64.0  # the same for more events than are allowed
HOUR = 3600.0  # s
BETTER = 5.0  # truth that is stated before the start: so many times fewer events than the bound allows
EFFECT = 0.5  # the same of means: standard deviations of one flight within the bound


@dataclass(frozen=True, slots=True)
class Judgement:
    """What flights say about one requirement.

    Attributes
    ----------
    requirement
        What is asked.
    verdict
        `met`, `not met` or `undecided`.
    estimate, low, high
        Of the statistic; None where there is none. Bounds hold with the confidence each, at every look together.
    bound
        Of the statistic.
    p_met, p_not_met
        Smallest level at which the tests have decided, of a few that are tried; they hold at every look.
    without_value
        Flights whose figure does not exist.
    method
        How the bounds were found.
    decided_by
        Number of flights that would decide it if the rest were as those so far; None if none would, or too many.
    met_by
        The same if nothing speaks against it from now on; None of means.
    """

    requirement: Requirement
    verdict: Word
    estimate: float | None
    low: float | None
    high: float | None
    bound: float
    p_met: float
    p_not_met: float
    without_value: int
    method: str
    decided_by: int | None
    met_by: int | None


@dataclass(frozen=True, slots=True)
class Verification:
    """What flights say about all requirements.

    Attributes
    ----------
    judgements
        One a requirement, in their order.
    runs
        Flights that were judged: the first ones by their index.
    confidence
        Of each statement.
    """

    judgements: tuple[Judgement, ...]
    runs: int
    confidence: float

    @property
    def met(self) -> bool:
        """Whether it is shown that all are met."""
        return all(one.verdict == "met" for one in self.judgements)

    @property
    def decided(self) -> bool:
        """Whether each one is decided."""
        return all(one.verdict != "undecided" for one in self.judgements)

    @property
    def verdict(self) -> Word:
        """Of all together: not met if one is not."""
        words = {one.verdict for one in self.judgements}
        return "not met" if "not met" in words else "undecided" if "undecided" in words else "met"


@dataclass(frozen=True, slots=True)
class Outlook:
    """What to expect before the start.

    Attributes
    ----------
    truth
        What is taken to be true, in words.
    met, not_met
        Probability of each verdict within the budget, of this requirement alone.
    flights
        Mean number of flights until then; None of means.
    median
        Flights by which half are decided; None if the budget ends before.
    least
        Flights without anything against it after which it is met; None if that cannot be told.
    """

    truth: str
    met: float
    not_met: float
    flights: float | None
    median: int | None
    least: int | None


def judge(requirements: Sequence[Requirement], flights: "pd.DataFrame", confidence: float = 0.95) -> Verification:
    """Judge requirements by the first flights of a campaign.

    Parameters
    ----------
    requirements
        At least one.
    flights
        A row a flight with the score's keys, flight 0 first and none left out: which flights are seen must not depend
        on how they went. Random draws only.
    confidence
        Of each statement, 0.5 … 1 exclusive.

    Returns
    -------
    Verification

    Raises
    ------
    ValueError
        If there is no requirement, no column for one, or the confidence is no such number.
    """
    _check_confidence(confidence)
    if not requirements:
        raise ValueError("there is no requirement to judge")
    error = 1.0 - confidence
    seen = [_seen(one, flights, error, len(requirements)) for one in requirements]
    met, not_met = [one.p_met for one in seen], [one.p_not_met for one in seen]
    all_met = all(p <= error for p in met)
    single_met, single_not = holm(met, error), holm(not_met, error)
    words: list[Word] = []
    for yes, no in zip(single_met, single_not, strict=True):
        right = yes or all_met
        words.append("undecided" if right == no else "met" if right else "not met")
    judgements = tuple(
        Judgement(requirement, word, *one.figures, *one.plan(word))
        for requirement, word, one in zip(requirements, words, seen, strict=True)
    )
    return Verification(judgements, len(flights), confidence)


def holm(p_values: Sequence[float], error: float) -> list[bool]:
    """Which hypotheses Holm's procedure rejects, with a familywise error rate of `error`."""
    order = np.argsort(p_values, kind="stable")
    rejected = [False] * len(p_values)
    for rank, i in enumerate(order):
        if p_values[i] > error / (len(p_values) - rank) * (1.0 + 1e-12):
            break
        rejected[i] = True
    return rejected


def schedule(requirements: Sequence[Requirement], confidence: float, budget: int) -> tuple[int, ...]:
    """Numbers of flights at which to look, the budget last.

    The error is kept at any; these are where `met` may come, and often enough for `not met`. Looks that lie within a
    twentieth of the one before are left out, unless `met` may come there of what is rare.
    """
    error = 1.0 - confidence
    levels = {error, error / len(requirements)}
    wanted = {n for one in requirements for level in levels for n in _may_be_met(one, level, budget)}
    looks, at = {*sequential.mean_looks(budget)}, float(FIRST)
    while at < budget:
        looks.add(round(at))
        at = max(at + 1.0, at * GROWTH)
    kept: list[int] = []
    for n in sorted(looks | wanted):
        near = bool(kept) and n - kept[-1] < max(LEAST_GAP, CLOSE * n)
        if FIRST <= n < budget and not (near and n not in wanted):
            kept.append(n)
    return (*kept, budget)


def outlook(
    requirement: Requirement, confidence: float, budget: int, *, truth: float | None = None, hours: float | None = None
) -> Outlook:
    """Chance that a requirement is decided within the budget.

    Parameters
    ----------
    requirement
        One of them; taken by itself.
    confidence
        Of the statement.
    budget
        Flights.
    truth
        True probability of a `probability`, true share of flights within the bound of a quantile or of `every`, true
        rate, true distance of a mean from its bound in standard deviations of a flight (above 0: met). Without it, five
        times fewer flights are on the wrong side than the bound allows, and of means it is 0.5.
    hours
        Mean exposure of a flight, of rates.

    Raises
    ------
    ValueError
        If a rate comes without exposure, or the truth cannot be.
    """
    _check_confidence(confidence)
    error = 1.0 - confidence
    if requirement.kind == "mean":
        return _outlook_of_mean(EFFECT if truth is None else truth, error, budget)
    if requirement.kind == "rate_per_hour":
        return _outlook_of_rate(requirement, error, budget, truth, hours)
    return _outlook_of_events(requirement, error, budget, truth)


def _check_confidence(confidence: float) -> None:
    if not 0.5 < confidence < 1.0:
        raise ValueError(f"confidence = {confidence:g}: must lie between 0.5 and 1")


# -- each kind of statistic as two tests -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Seen:
    """What flights say about one requirement, before the others are asked."""

    estimate: float | None
    low: float
    high: float
    bound: float
    p_met: float
    p_not_met: float
    without_value: int
    method: str
    met_flights: int | None
    not_met_flights: int | None
    met_by: int | None

    @property
    def figures(self) -> tuple[float | None, float | None, float | None, float, float, float, int, str]:
        """In the order of a judgement."""
        return (
            self.estimate,
            _finite(self.low),
            _finite(self.high),
            self.bound,
            self.p_met,
            self.p_not_met,
            self.without_value,
            self.method,
        )

    def plan(self, word: Word) -> tuple[int | None, int | None]:
        """Flights that would decide it, and that would if nothing spoke against it any more."""
        if word != "undecided":
            return None, None
        found = [n for n in (self.met_flights, self.not_met_flights) if n is not None]
        return min(found, default=None), self.met_by


@dataclass(frozen=True, slots=True)
class _Events:
    """A requirement as a bound on the probability of an event."""

    events: Flags
    bound: float
    met_if_few: bool
    without_value: int

    def complement(self) -> "_Events":
        """The same by the event's absence."""
        return _Events(~self.events, 1.0 - self.bound, not self.met_if_few, self.without_value)


def _seen(requirement: Requirement, flights: "pd.DataFrame", error: float, family: int) -> _Seen:
    if requirement.kind == "mean":
        return _seen_mean(requirement, flights, error, family)
    if requirement.kind == "rate_per_hour":
        return _seen_rate(requirement, flights, error, family)
    seen = _events(requirement, flights)
    if requirement.kind == "every":
        return _seen_every(seen, error)
    below, above = sequential.event_levels(seen.events, seen.bound, _levels(error, family))
    p_met, p_not_met = (below, above) if seen.met_if_few else (above, below)
    estimate, low, high = (
        _of_probability(requirement, seen, error)
        if requirement.kind == "probability"
        else _of_quantile(requirement, flights, error)
    )
    method = "exact binomial, sequential" if requirement.kind == "probability" else "order statistics, sequential"
    return _Seen(
        estimate,
        low,
        high,
        float(requirement.bound or 0.0),
        p_met,
        p_not_met,
        seen.without_value,
        method,
        *_planned_events(seen, error),
    )


def _levels(error: float, family: int) -> tuple[float, ...]:
    """Errors that are tried: those of Holm's procedure, and a few to tell how strong the evidence is."""
    return tuple(sorted({*(error / (i + 1) for i in range(family)), *EVIDENCE}, reverse=True))


def _values(requirement: Requirement, flights: "pd.DataFrame") -> Floats:
    if requirement.key not in flights:
        raise ValueError(f"{requirement.key}: no flight has such a number")
    found: Floats = flights[requirement.key].to_numpy(dtype=np.float64, na_value=np.nan)
    return found


def _events(requirement: Requirement, flights: "pd.DataFrame") -> _Events:
    """What counts in each flight, and how often it may."""
    if requirement.key == OUTCOME:
        came: Flags = (flights[OUTCOME] == requirement.equals).to_numpy(dtype=np.bool_)
        missing = np.zeros(came.size, np.bool_)
    else:
        values = _values(requirement, flights)
        missing = np.isnan(values)
        if (wanted := requirement.quantile) is not None:
            upper, limit = requirement.is_upper, float(requirement.bound or 0.0)
            with np.errstate(invalid="ignore"):
                beyond = values > limit if upper else values >= limit
            return _Events(np.where(missing, upper, beyond), 1.0 - wanted, upper, int(missing.sum()))
        low = -np.inf if requirement.minimum is None else requirement.minimum
        high = np.inf if requirement.maximum is None else requirement.maximum
        came = (values >= low) & (values <= high)
    if requirement.at_most is not None:
        return _Events(came | missing, requirement.at_most, True, int(missing.sum()))
    wanted = EVERY_SHARE if requirement.kind == "every" else float(requirement.at_least or 0.0)
    return _Events(~came, 1.0 - wanted, True, int(missing.sum()))


def _seen_every(seen: _Events, error: float) -> _Seen:
    """Flights without a failure; the first failure ends it."""
    n, failed = seen.events.size, int(seen.events.sum())
    low, high = sequential.event_interval(~seen.events, error) if failed else (error ** (1.0 / max(n, 1)), 1.0)
    enough = int(np.ceil(np.log(error) / np.log(EVERY_SHARE)))
    return _Seen(
        1.0 - failed / n if n else None,
        low if n else -np.inf,
        high,
        EVERY_SHARE,
        1.0 if failed else EVERY_SHARE**n,
        0.0 if failed else 1.0,
        seen.without_value,
        "flights without a failure",
        enough,
        None,
        enough,
    )


def _of_probability(requirement: Requirement, seen: _Events, error: float) -> tuple[float | None, float, float]:
    events = seen.events if requirement.at_least is None else ~seen.events
    estimate = float(events.mean()) if events.size else None
    return (estimate, *sequential.event_interval(events, error))


def _of_quantile(requirement: Requirement, flights: "pd.DataFrame", error: float) -> tuple[float | None, float, float]:
    values, wanted = _ranked(requirement, flights), float(requirement.quantile or 0.0)
    estimate = _finite(np.quantile(values, wanted, method="higher")) if values.size else None
    return (estimate, *sequential.quantile_interval(values, wanted, error))


def _ranked(requirement: Requirement, flights: "pd.DataFrame") -> Floats:
    """Values of flights, those without one at the worst end."""
    values = _values(requirement, flights)
    ranked: Floats = np.where(np.isnan(values), np.inf if requirement.maximum is not None else -np.inf, values)
    return ranked


def _seen_mean(requirement: Requirement, flights: "pd.DataFrame", error: float, family: int) -> _Seen:
    values, bound = _values(requirement, flights), float(requirement.bound or 0.0)
    missing = int(np.isnan(values).sum())
    if missing:
        return _Seen(None, -np.inf, np.inf, bound, 1.0, 1.0, missing, "none: flights without a value", None, None, None)
    levels = tuple(sorted({*(error / (i + 1) for i in range(family)), *MEAN_EVIDENCE}, reverse=True))
    bounds = {level: mean_interval(values, level) for level in levels}
    is_below = [level for level in levels if bounds[level][1] <= bound]
    is_above = [level for level in levels if bounds[level][0] >= bound]
    low, high, method = bounds[error]
    right, wrong = (is_below, is_above) if requirement.is_upper else (is_above, is_below)
    distance = (float(values.mean()) - bound) * (-1.0 if requirement.is_upper else 1.0) if values.size else 0.0
    planned = _planned_mean(distance / values.std(ddof=1), error) if values.size > 1 and np.ptp(values) > 0.0 else None
    return _Seen(
        float(values.mean()) if values.size else None,
        low,
        high,
        bound,
        min(right, default=1.0),
        min(wrong, default=1.0),
        0,
        method,
        planned if distance > 0.0 else None,
        planned if distance < 0.0 else None,
        None,
    )


def mean_interval(values: Floats, level: float) -> tuple[float, float, str]:
    """Bounds of a mean, each with the error `level`, over all looks up to now together, and the last look's method."""
    looks = sequential.mean_looks(values.size)
    low, high, method = -np.inf, np.inf, "none"
    for n, tail in zip(looks, sequential.mean_levels(level, len(looks)), strict=True):
        below, above, method = mean_bounds(values[:n], tail)
        low, high = max(low, below), min(high, above)
    return low, high, method


def _seen_rate(requirement: Requirement, flights: "pd.DataFrame", error: float, family: int) -> _Seen:
    counts, hours = counted(requirement, flights)
    bound, total = float(requirement.bound or 0.0), float(hours.sum())
    below, above = sequential.rate_levels(counts, hours, bound, _levels(error, family))
    lows, highs = sequential.rate_interval(counts, hours, error)
    p_met, p_not_met = (below, above) if requirement.is_upper else (above, below)
    return _Seen(
        float(counts.sum()) / total if total > 0.0 else None,
        float(lows[-1]) if lows.size else 0.0,
        float(highs[-1]) if highs.size else np.inf,
        bound,
        p_met,
        p_not_met,
        0,
        "exact Poisson, sequential",
        *_planned_rate(requirement, counts, hours, error),
    )


def counted(requirement: Requirement, flights: "pd.DataFrame") -> tuple[Floats, Floats]:
    """Events of each flight, and its exposure in hours, of a rate."""
    if requirement.key == OUTCOME:
        counts = np.asarray(flights[OUTCOME] == requirement.equals, dtype=np.float64)
    else:
        counts = _values(requirement, flights)
    duration, release, true = (
        flights[key].to_numpy(dtype=np.float64, na_value=np.nan)
        for key in ("flight.duration", "launch.release_time", "launch.true_time")
    )
    seconds = np.fmin(release, duration) if requirement.exposure == "armed" else duration - true
    hours: Floats = np.maximum(np.nan_to_num(seconds), 0.0) / HOUR
    return counts, hours


def _finite(value: float | np.floating[Any]) -> float | None:
    return float(value) if np.isfinite(value) else None


# -- what would decide -----------------------------------------------------------------------------------------------


def _planned_events(seen: _Events, error: float) -> tuple[int | None, int | None, int | None]:
    """Flights for met and for not met at the share so far, and for met if nothing speaks against it any more."""
    if seen.bound > 0.5:
        return _planned_events(seen.complement(), error)
    n, count, walk = seen.events.size, int(seen.events.sum()), Flights(seen.bound)
    horizon = sequential.horizon_of(min(FURTHEST, max(2.0 * n, MOST_EVENTS / seen.bound)))
    horizon_many = sequential.horizon_of(min(FURTHEST, max(2.0 * n, MOST_SURPLUS / seen.bound)))
    few, many = sequential.few_times(walk, error, horizon), sequential.many_times(walk, error, horizon_many)
    share = count / n if n else 0.0
    by_few = _first(few >= max(n, 1), np.round(share * few) <= np.arange(few.size), few)
    when = _when_many(n, count, share, many)
    if seen.met_if_few:
        return by_few, when, int(few[count]) if count < few.size else None
    always = _when_many(n, count, 1.0, many)
    return when, by_few, always


def _first(later: Flags, decided: Flags, times: Floats) -> int | None:
    found = np.flatnonzero(later & decided)
    return int(np.ceil(times[found[0]])) if found.size else None


def _when_many(n: int, count: int, share: float, many: Floats) -> int | None:
    """First flight from now on by which enough events come if they come with that share."""
    if share <= 0.0:
        return None
    events = np.arange(1, many.size)  # the last one is where the walk ended
    when = n + np.ceil((events - count) / share)
    found = np.flatnonzero((events > count) & (when <= many[:-1]))
    return int(when[found[0]]) if found.size else None


def _planned_rate(
    requirement: Requirement, counts: Floats, hours: Floats, error: float
) -> tuple[int | None, int | None, int | None]:
    n, count, total, bound = counts.size, int(counts.sum()), float(hours.sum()), float(requirement.bound or 0.0)
    if not total > 0.0:
        return None, None, None
    each = total / n
    few = sequential.few_times(Exposure(), error, MOST_EVENTS) / (bound * each)
    many = sequential.many_times(Exposure(), error, max(MOST_SURPLUS, sequential.horizon_of(2.0 * bound * total)))
    many = many / (bound * each)
    by_few = _first(few >= n, np.round(count / n * few) <= np.arange(few.size), few)
    by_many = _when_many(n, count, count / n, many)
    if requirement.is_upper:
        return by_few, by_many, int(np.ceil(few[count])) if count < few.size else None
    return by_many, by_few, None


def _planned_mean(effect: float, error: float) -> int | None:
    """Look by which a mean at this distance, in standard deviations, is decided with even chances."""
    chances = sequential.mean_chance(error, sequential.MOST_LOOKS, abs(effect))
    looks = sequential.mean_looks(FURTHEST)
    found = np.flatnonzero(chances[: len(looks)] >= 0.5)
    return looks[found[0]] if found.size else None


# -- before the start ------------------------------------------------------------------------------------------------


def _may_be_met(requirement: Requirement, level: float, budget: int) -> list[int]:
    """Numbers of flights at which few events may show that it is met."""
    if requirement.kind in ("mean", "rate_per_hour"):
        return []
    if requirement.kind == "every":
        return [int(np.ceil(np.log(level) / np.log(EVERY_SHARE)))]
    event = _empty(requirement)
    if event.bound > 0.5:
        event = event.complement()
    few = sequential.few_times(Flights(event.bound), level, float(budget))
    return [int(n) for n in few[: LOOKS_FOR_FEW if event.bound <= RARE else 1]]


def _empty(requirement: Requirement) -> _Events:
    """The event of a requirement before any flight."""
    wanted = requirement.quantile
    nothing = np.zeros(0, np.bool_)
    if wanted is not None:
        return _Events(nothing, 1.0 - wanted, requirement.maximum is not None, 0)
    if requirement.at_most is not None:
        return _Events(nothing, requirement.at_most, True, 0)
    share = EVERY_SHARE if requirement.kind == "every" else float(requirement.at_least or 0.0)
    return _Events(nothing, 1.0 - share, True, 0)


def _outlook_of_events(requirement: Requirement, error: float, budget: int, truth: float | None) -> Outlook:
    event = _empty(requirement)
    if truth is not None and not 0.0 <= truth <= 1.0:
        raise ValueError(f"{truth:g} is no probability")
    if truth is None:
        q = event.bound / BETTER if event.met_if_few else 1.0 - (1.0 - event.bound) / BETTER
    else:
        turned = requirement.at_most is not None or not event.met_if_few
        q = truth if turned else 1.0 - truth
    said = _truth_in_words(requirement, event, q)
    if requirement.kind == "every":
        return _outlook_of_every(q, error, budget, said)
    if event.bound > 0.5:
        event, q = event.complement(), 1.0 - q
    few, many = (
        times(Flights(event.bound), error, sequential.horizon_of(budget))
        for times in (sequential.few_times, sequential.many_times)
    )
    found = sequential.chance(few, many, np.array([1.0 - q, q]), budget)
    met, not_met = (found.few, found.many) if event.met_if_few else (found.many, found.few)
    least = int(few[0]) if few.size else None
    if not event.met_if_few:
        least = int(np.flatnonzero(many >= np.arange(1, many.size + 1))[0]) + 1
    return Outlook(said, met, not_met, found.flights, found.median, least)


def _truth_in_words(requirement: Requirement, event: _Events, q: float) -> str:
    if requirement.kind == "probability":
        return f"a true probability of {q if requirement.at_most is not None else 1.0 - q:.4g}"
    return f"{100.0 * (1.0 - q if event.met_if_few else q):.4g} % of flights within the bound"


def _outlook_of_every(q: float, error: float, budget: int, said: str) -> Outlook:
    enough = int(np.ceil(np.log(error) / np.log(EVERY_SHARE)))
    n = min(enough, budget)
    clean = (1.0 - q) ** n
    flights = float(n) if q == 0.0 else (1.0 - clean) / q
    median = enough if clean >= 0.5 and budget >= enough else None
    if clean < 0.5:
        median = int(np.ceil(np.log(0.5) / np.log1p(-q)))
    return Outlook(said, clean if budget >= enough else 0.0, 1.0 - clean, flights, median, enough)


def _outlook_of_rate(
    requirement: Requirement, error: float, budget: int, truth: float | None, hours: float | None
) -> Outlook:
    if hours is None or not hours > 0.0:
        raise ValueError("the chance of a rate needs the mean exposure of a flight, in hours")
    bound = float(requirement.bound or 0.0)
    true = (bound / BETTER if requirement.is_upper else bound * BETTER) if truth is None else truth
    if not true >= 0.0:
        raise ValueError(f"{true:g} is no rate")
    horizon = sequential.horizon_of(bound * hours * budget)
    few, many = (
        times(Exposure(), error, horizon) / (bound * hours) for times in (sequential.few_times, sequential.many_times)
    )
    found = sequential.chance(few, many, Exposure().counts(true * hours), budget)
    met, not_met = (found.few, found.many) if requirement.is_upper else (found.many, found.few)
    first = sequential.few_times(Exposure(), error, 64.0)[0]
    least = int(np.ceil(first / (bound * hours))) if requirement.is_upper else None
    said = f"a true rate of {true:.4g} per hour, {hours * HOUR:.3g} s a flight"
    return Outlook(said, met, not_met, found.flights, found.median, least)


def _outlook_of_mean(effect: float, error: float, budget: int) -> Outlook:
    looks = sequential.mean_looks(budget)
    said = f"a true mean {abs(effect):g} sd of a flight {'within' if effect >= 0.0 else 'beyond'} the bound"
    if not looks:
        return Outlook(said, 0.0, 0.0, None, None, sequential.FIRST_LOOK)
    right, wrong = (sequential.mean_chance(error, len(looks), sign * effect) for sign in (1.0, -1.0))
    half = np.flatnonzero(right + wrong >= 0.5)
    median = looks[half[0]] if half.size else None
    return Outlook(said, float(right[-1]), float(wrong[-1]), None, median, sequential.FIRST_LOOK)


# -- how it went ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Course:
    """Estimate and bounds of a requirement as flights went on.

    Attributes
    ----------
    flights, estimate, low, high
        Shape (n,) each; NaN where there is no figure.
    """

    flights: NDArray[np.int_]
    estimate: Floats
    low: Floats
    high: Floats


def course(requirement: Requirement, flights: "pd.DataFrame", confidence: float = 0.95, points: int = 40) -> Course:
    """Follow a requirement's estimate and bounds over the number of flights, at so many of them."""
    n = len(flights)
    at = np.unique(np.round(np.geomspace(min(8, n), n, points)).astype(int)) if n else np.zeros(0, int)
    error = 1.0 - confidence
    rows = np.array([_course_point(requirement, flights.iloc[:k], error) for k in at], dtype=np.float64).reshape(-1, 3)
    low, high = np.fmax.accumulate(rows[:, 1]), np.fmin.accumulate(rows[:, 2])
    low[~np.isfinite(low)], high[~np.isfinite(high)] = np.nan, np.nan
    return Course(at, rows[:, 0], low, high)


def _course_point(requirement: Requirement, flights: "pd.DataFrame", error: float) -> tuple[float, float, float]:
    seen = _seen_briefly(requirement, flights, error)
    return (np.nan if seen[0] is None else seen[0], seen[1], seen[2])


def _seen_briefly(requirement: Requirement, flights: "pd.DataFrame", error: float) -> tuple[float | None, float, float]:
    """Estimate and bounds alone."""
    if requirement.kind == "quantile":
        return _of_quantile(requirement, flights, error)
    if requirement.kind == "probability":
        return _of_probability(requirement, _events(requirement, flights), error)
    if requirement.kind == "every":
        seen = _seen_every(_events(requirement, flights), error)
        return seen.estimate, seen.low, seen.high
    if requirement.kind == "mean":
        values = _values(requirement, flights)
        if np.isnan(values).any():
            return None, -np.inf, np.inf
        return (float(values.mean()), *mean_interval(values, error)[:2])
    counts, hours = counted(requirement, flights)
    lows, highs = sequential.rate_interval(counts, hours, error)
    total = float(hours.sum())
    return (float(counts.sum()) / total if total > 0.0 else None, float(lows[-1]), float(highs[-1]))


# -- as plain values -------------------------------------------------------------------------------------------------


def plain(found: Verification) -> dict[str, Any]:
    """What `verify.json` holds; see docs/verification.md."""
    return {
        "requirements": [_plain_judgement(one) for one in found.judgements],
        "runs": found.runs,
        "confidence": found.confidence,
        "verdict": found.verdict,
    }


def _plain_judgement(one: Judgement) -> Mapping[str, Any]:
    r = one.requirement
    return {
        "key": r.key,
        "statistic": r.statistic,
        "bound": one.bound,
        "estimate": one.estimate,
        "low": one.low,
        "high": one.high,
        "verdict": one.verdict,
        "says": str(r),
        "sense": "at most" if r.is_upper and r.kind != "every" else "at least",
        "equals": r.equals,
        "minimum": r.minimum,
        "maximum": r.maximum,
        "exposure": r.exposure,
        "p_met": one.p_met,
        "p_not_met": one.p_not_met,
        "flights_without_value": one.without_value,
        "method": one.method,
        "decided_by": one.decided_by,
        "met_by": one.met_by,
    }
