"""What flights say about one requirement: estimate, bounds, and how strongly they speak for either verdict.

Probabilities, quantiles and `every` become the probability of an event, rates a Poisson process, means what
`sequential` makes of them. What a flight without a value counts as stands in `uavsim.requirements`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.requirements import OUTCOME, Requirement
from uavsim.studies.campaign import sequential
from uavsim.studies.campaign.estimates import mean_bounds
from uavsim.studies.campaign.sequential import Exposure, Flights
from uavsim.studies.false_alarms import PIECE

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

EVERY_SHARE = 0.95  # of all flights, which flights without a failure must show
EVIDENCE = (0.5, 0.2, 0.1, 0.05, 0.01, 1e-3, 1e-4, 1e-6)  # levels that are tried besides Holm's
MEAN_EVIDENCE = (0.2, 0.05, 0.01)  # of means, whose looks spend a share of each
FURTHEST, MOST_EVENTS = 1_000_000, 1024.0  # flights, and expected events, to which is planned ahead
MOST_SURPLUS = 64.0  # the same for more events than are allowed
HOUR = 3600.0  # s


@dataclass(frozen=True, slots=True)
class Seen:
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

    def plan(self, word: str, error: float) -> tuple[int | None, int | None]:
        """Flights that would decide it, and that would if nothing spoke against it any more."""
        if word != "undecided" or min(self.p_met, self.p_not_met) <= error:  # the latter waits for the others
            return None, None
        found = [n for n in (self.met_flights, self.not_met_flights) if n is not None]
        return min(found, default=None), self.met_by


@dataclass(frozen=True, slots=True)
class Events:
    """A requirement as a bound on the probability of an event."""

    events: Flags
    bound: float
    met_if_few: bool
    without_value: int

    def complement(self) -> "Events":
        """The same by the event's absence."""
        return Events(~self.events, 1.0 - self.bound, not self.met_if_few, self.without_value)


def p_values(requirement: Requirement, flights: "pd.DataFrame", levels: tuple[float, ...]) -> tuple[float, float]:
    """Smallest levels at which flights have shown that a requirement is met, and that it is not; 1 where none has.

    Parameters
    ----------
    requirement, flights
        As `verification.judge` has them.
    levels
        Errors to try, the largest first.

    Raises
    ------
    ValueError
        No flight has such a number.
    """
    if requirement.kind == "mean":
        below, above = _mean_levels(_values(requirement, flights), float(requirement.bound or 0.0), levels)
        return (below, above) if requirement.is_upper else (above, below)
    if requirement.kind == "rate_per_hour":
        below, above = sequential.rate_levels(*counted(requirement, flights), float(requirement.bound or 0.0), levels)
        return (below, above) if requirement.is_upper else (above, below)
    found = events_of(requirement, flights)
    if requirement.kind == "every":  # one failure is enough; without one the chance of that tells
        return (1.0, 0.0) if found.events.any() else (EVERY_SHARE**found.events.size, 1.0)
    below, above = sequential.event_levels(found.events, found.bound, levels)
    return (below, above) if found.met_if_few else (above, below)


def _mean_levels(values: Floats, bound: float, levels: tuple[float, ...]) -> tuple[float, float]:
    if np.isnan(values).any():
        return 1.0, 1.0
    bounds = {level: mean_interval(values, level) for level in levels}
    below = min((level for level in levels if bounds[level][1] <= bound), default=1.0)
    return below, min((level for level in levels if bounds[level][0] >= bound), default=1.0)


def holm_levels(error: float, family: int) -> tuple[float, ...]:
    """Errors that Holm's procedure asks of a family of so many, the largest first."""
    return tuple(error / (i + 1) for i in range(family))


def seen(requirement: Requirement, flights: "pd.DataFrame", error: float, family: int) -> Seen:
    """Say what flights show of one requirement, one of a family of so many.

    Raises
    ------
    ValueError
        No flight has such a number.
    """
    more = MEAN_EVIDENCE if requirement.kind == "mean" else EVIDENCE
    levels = tuple(sorted({*holm_levels(error, family), *more}, reverse=True))
    p = p_values(requirement, flights, levels)
    if requirement.kind == "mean":
        return _seen_mean(requirement, flights, error, p)
    if requirement.kind == "rate_per_hour":
        return _seen_rate(requirement, flights, error, p)
    found = events_of(requirement, flights)
    if requirement.kind == "every":
        return _seen_every(found, error, p)
    if requirement.kind == "quantile":
        figures, method = _of_quantile(requirement, flights, error), "order statistics, sequential"
    else:
        figures, method = _of_probability(requirement, found, error, p), "exact binomial, sequential"
    bound = float(requirement.bound or 0.0)
    return Seen(*figures, bound, *p, found.without_value, method, *_planned_events(found, error))


def _values(requirement: Requirement, flights: "pd.DataFrame") -> Floats:
    if requirement.column not in flights:
        raise ValueError(f"{requirement.column}: no flight has such a number")
    found: Floats = flights[requirement.column].to_numpy(dtype=np.float64, na_value=np.nan)
    return found


def events_of(requirement: Requirement, flights: "pd.DataFrame") -> Events:
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
            return Events(np.where(missing, upper, beyond), 1.0 - wanted, upper, int(missing.sum()))
        low = -np.inf if requirement.minimum is None else requirement.minimum
        high = np.inf if requirement.maximum is None else requirement.maximum
        came = (values >= low) & (values <= high)
    if requirement.at_most is not None:
        return Events(came | missing, requirement.at_most, True, int(missing.sum()))
    wanted = EVERY_SHARE if requirement.kind == "every" else float(requirement.at_least or 0.0)
    return Events(~came, 1.0 - wanted, True, int(missing.sum()))


def _seen_every(seen: Events, error: float, p: tuple[float, float]) -> Seen:
    """Flights without a failure; the first failure ends it."""
    n, failed = seen.events.size, int(seen.events.sum())
    low, high = sequential.event_interval(~seen.events, error) if failed else (error ** (1.0 / max(n, 1)), 1.0)
    enough = int(np.ceil(np.log(error) / np.log(EVERY_SHARE)))
    return Seen(
        1.0 - failed / n if n else None,
        low if n else -np.inf,
        high,
        EVERY_SHARE,
        *p,
        seen.without_value,
        "flights without a failure",
        enough,
        None,
        enough,
    )


def _of_probability(
    requirement: Requirement, seen: Events, error: float, p: tuple[float, float] = (1.0, 1.0)
) -> tuple[float | None, float, float]:
    """Estimate and bounds; where a test has decided, the bound does not lie on the other side by a rounding."""
    events = seen.events if requirement.at_least is None else ~seen.events
    estimate = float(events.mean()) if events.size else None
    low, high = sequential.event_interval(events, error)
    asked, is_above = float(requirement.bound or 0.0), p[1 if requirement.is_upper else 0] <= error
    if is_above:
        return estimate, max(low, asked), high
    return estimate, low, min(high, asked) if p[0 if requirement.is_upper else 1] <= error else high


def _of_quantile(requirement: Requirement, flights: "pd.DataFrame", error: float) -> tuple[float | None, float, float]:
    values, wanted = _ranked(requirement, flights), float(requirement.quantile or 0.0)
    estimate = _finite(np.quantile(values, wanted, method="higher")) if values.size else None
    return (estimate, *sequential.quantile_interval(values, wanted, error))


def _ranked(requirement: Requirement, flights: "pd.DataFrame") -> Floats:
    """Values of flights, those without one at the worst end."""
    values = _values(requirement, flights)
    ranked: Floats = np.where(np.isnan(values), np.inf if requirement.maximum is not None else -np.inf, values)
    return ranked


def _seen_mean(requirement: Requirement, flights: "pd.DataFrame", error: float, p: tuple[float, float]) -> Seen:
    values, bound = _values(requirement, flights), float(requirement.bound or 0.0)
    missing = int(np.isnan(values).sum())
    if missing:
        return Seen(None, -np.inf, np.inf, bound, 1.0, 1.0, missing, "none: flights without a value", None, None, None)
    low, high, method = mean_interval(values, error)
    distance = (float(values.mean()) - bound) * (-1.0 if requirement.is_upper else 1.0) if values.size else 0.0
    planned = _planned_mean(distance / values.std(ddof=1), error) if values.size > 1 and np.ptp(values) > 0.0 else None
    return Seen(
        float(values.mean()) if values.size else None,
        low,
        high,
        bound,
        *p,
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


def _seen_rate(requirement: Requirement, flights: "pd.DataFrame", error: float, p: tuple[float, float]) -> Seen:
    counts, hours = counted(requirement, flights)
    bound, total = float(requirement.bound or 0.0), float(hours.sum())
    lows, highs = sequential.rate_interval(counts, hours, error)
    return Seen(
        float(counts.sum()) / total if total > 0.0 else None,
        float(lows[-1]) if lows.size else 0.0,
        float(highs[-1]) if highs.size else np.inf,
        bound,
        *p,
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
    if requirement.disturbed:
        return counts, np.full(counts.shape, PIECE / HOUR)
    duration, release, true = (
        flights[key].to_numpy(dtype=np.float64, na_value=np.nan)
        for key in ("flight.duration", "launch.release_time", "launch.true_time")
    )
    seconds = np.fmin(release, duration) if requirement.exposure == "armed" else duration - true
    hours: Floats = np.maximum(np.nan_to_num(seconds), 0.0) / HOUR
    unknown = np.isnan(counts)  # a flight without a value never helps; one without exposure says nothing either way
    return np.where(unknown, np.where(hours > 0.0, 1.0, 0.0), counts), hours


def _finite(value: float | np.floating[Any]) -> float | None:
    return float(value) if np.isfinite(value) else None


def no_flights(requirement: Requirement) -> Events:
    """The event of a requirement before any flight."""
    wanted = requirement.quantile
    nothing = np.zeros(0, np.bool_)
    if wanted is not None:
        return Events(nothing, 1.0 - wanted, requirement.maximum is not None, 0)
    if requirement.at_most is not None:
        return Events(nothing, requirement.at_most, True, 0)
    share = EVERY_SHARE if requirement.kind == "every" else float(requirement.at_least or 0.0)
    return Events(nothing, 1.0 - share, True, 0)


# -- what would decide -----------------------------------------------------------------------------------------------


def _planned_events(seen: Events, error: float) -> tuple[int | None, int | None, int | None]:
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
        return _of_probability(requirement, events_of(requirement, flights), error)
    if requirement.kind == "every":
        seen = _seen_every(events_of(requirement, flights), error, (1.0, 1.0))
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
