"""Disturbances beside each flight: what its detector and its flight computer make of ten minutes without a launch.

A flight stands on its rail for some seconds, too short to show how often wings open that should not. So a requirement
may ask a rate of hours of a class of disturbances (`uavsim.studies.false_alarms`):

    handling      shocks, vibration of 0 to 3 g rms, rails: the mix     soft drops    6-12 g for 15-25 ms, 1800 an hour
    vibration     3 g rms without shocks                                held load     4.1 g for 60 s, σ 0.5 g

Flight i has piece i of each class that is asked, drawn from the campaign's seed and its number alone, read at the rate
of the accelerometer by the detector and the computer that the flight has after its draws. So a verdict depends on
neither workers nor looks, and what is taken up again counts the same. Of one piece at most `MOST` events count: a
detector that alarms 120 times an hour does it all the time, and bounds of tens of thousands of events take minutes.
"""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from uavsim.requirements import DISTURBED, WINGS, Requirement
from uavsim.scenario import Scenario
from uavsim.studies.campaign.plan import Plan
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import DISTURBANCES, count_piece
from uavsim.studies.workers import spread

if TYPE_CHECKING:
    import pandas as pd

CLASSES = dict(zip(DISTURBED, ("mix", "vibration", "soft drops", "centrifuge"), strict=True))
"""Which disturbances an exposure is of."""
MOST = 20  # events of a piece that count


class Exposures:
    """What requirements ask of disturbances beside the flights of a plan; each piece is counted once.

    Parameters
    ----------
    plan
        Of the flights; its scenario holds the requirements.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._asked = [one for one in plan.scenario.requirements if one.disturbed]
        self._classes = list(dict.fromkeys(str(one.exposure) for one in self._asked))
        self._known: dict[int, dict[str, tuple[int, int]]] = {}

    def beside(self, flights: "pd.DataFrame") -> "pd.DataFrame":
        """Return rows of flights with a column for each requirement that asks disturbances.

        Raises
        ------
        ValueError
            If the accelerometer is too slow for the disturbances.
        """
        if not self._asked:
            return flights
        wanted = flights["index"].astype(int).tolist()
        new = [i for i in wanted if i not in self._known]
        found = spread([partial(self._count, i) for i in new])
        self._known.update(zip(new, found, strict=True))
        return flights.assign(**{one.column: [self._of(i, one) for i in wanted] for one in self._asked})

    def _count(self, index: int) -> dict[str, tuple[int, int]]:
        scenario = self._plan.flight(index)
        return {name: _beside(scenario, self._plan.scenario.seed, index, CLASSES[name]) for name in self._classes}

    def _of(self, index: int, requirement: Requirement) -> float:
        alarms, wings = self._known[index][str(requirement.exposure)]
        return float(min(MOST, wings if requirement.key == WINGS else alarms))


def _beside(scenario: Scenario, seed: int, index: int, kind: str) -> tuple[int, int]:
    """Alarms and wing commands of one piece."""
    rate = scenario.accelerometer.description().rate
    columns: Sequence[int] = BatchDetector(scenario.detector, rate).columns
    axes = (0, 1, 2) if len(columns) > 1 else tuple(columns)
    ((alarms, wings),) = count_piece(
        [scenario.detector], scenario.flight_computer, DISTURBANCES[kind], seed, index, rate, axes
    ).tolist()
    return alarms, wings
