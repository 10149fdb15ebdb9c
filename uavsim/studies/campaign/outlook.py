"""The chance of a verdict before the start, at a stated truth, computed exactly for counts."""

from dataclasses import dataclass

import numpy as np

from uavsim.requirements import Requirement
from uavsim.studies.campaign import sequential
from uavsim.studies.campaign.evidence import EVERY_SHARE, HOUR, Events, no_flights
from uavsim.studies.campaign.sequential import Exposure, Flights

BETTER = 5.0  # truth that is stated: so many times fewer events than the bound allows
EFFECT = 0.5  # the same of means: standard deviations of one flight within the bound


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
    error = 1.0 - confidence
    if requirement.kind == "mean":
        return _outlook_of_mean(EFFECT if truth is None else truth, error, budget)
    if requirement.kind == "rate_per_hour":
        return _outlook_of_rate(requirement, error, budget, truth, hours)
    return _outlook_of_events(requirement, error, budget, truth)


def _outlook_of_events(requirement: Requirement, error: float, budget: int, truth: float | None) -> Outlook:
    event = no_flights(requirement)
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


def _truth_in_words(requirement: Requirement, event: Events, q: float) -> str:
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
