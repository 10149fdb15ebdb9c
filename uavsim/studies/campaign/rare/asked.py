"""What is asked of a scenario, answered: which problem an event is, its estimate, and what the numbers mean."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from uavsim.scenario import Scenario
from uavsim.studies.campaign.rare.detectors import REST, at_rest, in_stroke
from uavsim.studies.campaign.rare.estimate import Estimate, Inputs, estimate, per_hour
from uavsim.studies.campaign.rare.flights import Fly, event_of, failing, in_flight

FALSE_LAUNCH, MISSED = "false_launch", "missed_launch"


@dataclass(frozen=True)
class Found:
    """An answer.

    Attributes
    ----------
    scenario, event : str
    of : str
        What the probability is of: "5 s at rest", "a stroke", "a flight".
    levels : str
        What the levels count, with its unit.
    estimate : Estimate
    seconds : float, optional
        Of a sequence at rest; then there is a rate, too.
    failures : list of dict
        What fails first: `distance` from the middle of what is drawn, in standard deviations, and the values.
    """

    scenario: str
    event: str
    of: str
    levels: str
    estimate: Estimate
    seconds: float | None = None
    failures: tuple[dict[str, Any], ...] = ()

    @property
    def per_hour(self) -> tuple[float, float, float] | None:
        """Rate at rest and its interval, 1/h."""
        if self.seconds is None:
            return None
        found, seconds = self.estimate, self.seconds
        rate, low, high = (per_hour(p, seconds) for p in (found.probability, found.low, found.high))
        return rate, low, high


def of_detector(event: str) -> bool:
    """Whether an event is one of the detector alone, for which nothing is flown."""
    return event in (FALSE_LAUNCH, MISSED)


def of_signals(
    scenario: Scenario, event: str, *, seed: int, budget: float, sigma: float | None = None, seconds: float = REST
) -> Found:
    """Estimate a false launch at rest, or a stroke that is missed, of a scenario's detector.

    Parameters
    ----------
    scenario : Scenario
    event : str
        "false_launch" or "missed_launch".
    seed, budget
        As of `estimate`.
    sigma, seconds
        As of `detectors.at_rest`.

    Raises
    ------
    ValueError
        As `estimate`, `detectors.at_rest` and `detectors.in_stroke`.
    """
    if event == FALSE_LAUNCH:
        problem = at_rest(scenario, sigma=sigma, seconds=seconds)
        levels = "margin, m/s²" if isinstance(problem, Inputs) else "distance"
        found = estimate(problem, seed=seed, budget=budget)
        return Found(scenario.name, event, f"{seconds:g} s at rest", levels, found, seconds)
    found = estimate(in_stroke(scenario, sigma=sigma), seed=seed, budget=budget)
    return Found(scenario.name, event, "a stroke", "margin, m/s²", found)


def of_flights(
    scenario: Scenario,
    event: str,
    fly: Fly,
    *,
    seed: int,
    budget: float,
    progress: Callable[[float], None] | None = None,
) -> Found:
    """Estimate an event of whole flights.

    Parameters
    ----------
    scenario : Scenario
        With its dispersions.
    event : str
        "crashed", "missed_launch", "KEY<=VALUE" or "KEY>=VALUE".
    fly : callable
        See `flights.Fly`.
    seed, budget
        As of `estimate`.
    progress : callable, optional
        Called with the share of the budget that is used.

    Raises
    ------
    ValueError
        As `estimate`, `flights.event_of` and `flights.in_flight`.
    """
    flown = 0

    def counted(points: Any, indices: Any) -> Any:
        nonlocal flown
        rows = fly(points, indices)
        flown += len(rows)
        if progress is not None:
            progress(flown / budget)
        return rows

    found = estimate(in_flight(scenario, event_of(event), counted), seed=seed, budget=budget)
    return Found(scenario.name, event, "a flight", "margin", found, failures=tuple(failing(scenario, found)))
