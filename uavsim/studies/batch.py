"""The same scenario flown with several seeds.

Each flight is one process's work from its seed alone, so the result does not depend on how many work or in which order
they finish. Of every flight its score is kept as one row, and its airspeed error on a common time axis; whole flights
are kept only where somebody will want to look: the first, and those that did not end as expected.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.flight import Flight
from uavsim.scenario import Scenario
from uavsim.studies.campaign.campaign import limit_of
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP, ErrorTrace, Flown, fly_position
from uavsim.studies.campaign.keep import FIRST_AND_FAILURES
from uavsim.studies.campaign.plan import Seeds
from uavsim.studies.engine import engine, processes

if TYPE_CHECKING:
    import pandas as pd

Progress = Callable[[int, int], None]
"""Called with the number of finished flights and of all."""


@dataclass(frozen=True)
class Batch:
    """What several flights gave.

    Attributes
    ----------
    runs
        A row a flight: index, seed, outcome, what was drawn (`draw.…`) and the score's keys joined by dots.
    traces
        Airspeed errors, in the order of `runs`.
    kept
        Whole flights by index; of `fly_seeds` that is the seed.
    complete
        False if it was interrupted, or a flight could not be flown.
    wall_time
        s.
    lost
        Indices of flights that could not be flown.
    """

    scenario: Scenario
    runs: "pd.DataFrame"
    traces: list[ErrorTrace]
    kept: dict[int, Flight]
    complete: bool
    wall_time: float
    lost: tuple[int, ...] = ()

    @property
    def error_time(self) -> NDArray[np.float64]:
        """Middles of the bins of `traces`, s after the true launch."""
        count = max((trace.filtered.size for trace in self.traces), default=0)
        return np.asarray(ERROR_START + ERROR_STEP * (np.arange(count) + 0.5), dtype=np.float64)


def fly_seeds(
    scenario: Scenario, seeds: list[int], *, workers: int | None = None, progress: Progress | None = None
) -> Batch:
    """Fly a scenario once a seed, and keep what it gave in memory: for some tens of flights.

    Parameters
    ----------
    scenario
        What to fly; its own seed is not used.
    seeds
        One flight each.
    workers
        Processes that fly; None: one a processor; with one, or one seed, this one flies.
    progress
        Called after each flight.

    Returns
    -------
    Batch
        Rows and traces in the order of `seeds`, whatever order they finished in. An interrupt (Ctrl-C) ends it early:
        then it holds the flights that were finished, with `complete` false.
    """
    import pandas as pd

    plan = Seeds(scenario.checked(), tuple(seeds))
    started = time.monotonic()
    done: dict[int, Flown] = {}
    lost: tuple[int, ...] = ()

    def finished(results: list[tuple[int, Flown]]) -> None:
        for position, result in results:
            done[position] = result
            if progress is not None:
                progress(len(done), len(seeds))

    limit = limit_of(plan)
    try:
        with engine(workers=processes(workers, len(seeds))) as crew:
            work = partial(fly_position, plan, FIRST_AND_FAILURES, limit)
            lost = tuple(seeds[one.position] for one in crew.each(work, range(len(seeds)), done=finished, limit=limit))
    except KeyboardInterrupt:
        pass  # what was finished tells it
    ordered = [done[position] for position in sorted(done)]
    return Batch(
        scenario=scenario,
        runs=pd.DataFrame([flown.row for flown in ordered]),
        traces=[flown.trace for flown in ordered if flown.trace is not None],
        kept={flown.row["index"]: flown.flight for flown in ordered if flown.flight is not None},
        complete=len(done) == len(seeds),
        wall_time=time.monotonic() - started,
        lost=lost,
    )
