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

What flights say about one requirement is in `evidence`; what is expected before the start, in `outlook`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from uavsim.requirements import Requirement
from uavsim.studies.campaign import sequential
from uavsim.studies.campaign.evidence import EVERY_SHARE, holm_levels, no_flights, p_values, seen
from uavsim.studies.campaign.sequential import Flights

if TYPE_CHECKING:
    import pandas as pd

Word = Literal["met", "not met", "undecided"]

FIRST, GROWTH = 8, 1.1  # first look, and how much later each next one is
RARE, LOOKS_FOR_FEW = 0.02, 3  # n_0, n_1, n_2 of `few` are looks of their own where the event may not be more frequent
LEAST_GAP, CLOSE = 4, 0.05  # between looks, flights and share of them


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
    words = verdicts(requirements, flights, confidence)
    error = 1.0 - confidence
    found = [seen(one, flights, error, len(requirements)) for one in requirements]
    judgements = tuple(
        Judgement(requirement, word, *one.figures, *one.plan(word))
        for requirement, word, one in zip(requirements, words, found, strict=True)
    )
    return Verification(judgements, len(flights), confidence)


def verdicts(requirements: Sequence[Requirement], flights: "pd.DataFrame", confidence: float = 0.95) -> list[Word]:
    """The verdicts alone, as `judge` has them: for looks on the way.

    Raises
    ------
    ValueError
        As `judge`.
    """
    _check_confidence(confidence)
    if not requirements:
        raise ValueError("there is no requirement to judge")
    error, family = 1.0 - confidence, len(requirements)
    found = [p_values(one, flights, holm_levels(error, family)) for one in requirements]
    met, not_met = [p for p, _ in found], [p for _, p in found]
    all_met = all(p <= error for p in met)
    words: list[Word] = []
    for yes, no in zip(holm(met, error), holm(not_met, error), strict=True):
        right = yes or all_met
        words.append("undecided" if right == no else "met" if right else "not met")
    return words


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


def _check_confidence(confidence: float) -> None:
    if not 0.5 < confidence < 1.0:
        raise ValueError(f"confidence = {confidence:g}: must lie between 0.5 and 1")


def _may_be_met(requirement: Requirement, level: float, budget: int) -> list[int]:
    """Numbers of flights at which few events may show that it is met."""
    if requirement.kind in ("mean", "rate_per_hour"):
        return []
    if requirement.kind == "every":
        return [int(np.ceil(np.log(level) / np.log(EVERY_SHARE)))]
    event = no_flights(requirement)
    if event.bound > 0.5:
        event = event.complement()
    few = sequential.few_times(Flights(event.bound), level, float(budget))
    return [int(n) for n in few[: LOOKS_FOR_FEW if event.bound <= RARE else 1]]


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
