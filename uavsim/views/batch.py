"""Several flights: what is added to their folder when all have been flown."""

from dataclasses import asdict
from typing import Any

from uavsim.studies.batch_cramer_rao import against_bound
from uavsim.studies.campaign.campaign import Flights
from uavsim.studies.campaign.many import Many
from uavsim.studies.campaign.record import FLIGHTS, Record
from uavsim.views.campaign.plots import save_many_plots
from uavsim.views.plots import save_plots

DRAWN = 8  # flights with plots of their own; `uavsim replay` draws any other


def close(record: Record, flights: Flights, flown: Many, *, plots: bool) -> None:
    """Say in the record how near the flights came to the bound, and draw: all, and the first `DRAWN` that are kept.

    An interrupt leaves out what is not yet drawn.
    """
    record.describe(
        complete=flights.complete,
        wall_time=flights.wall_time,
        left=flights.left,
        more={"airspeed_bound": bound_of(flown)},
    )
    if not plots or not len(flown.runs):
        return
    save_many_plots(flown, flights.folder / "plots")
    for index in flights.kept()[:DRAWN]:
        save_plots(flights.flight(index), flights.folder / FLIGHTS / str(index) / "plots")


def bound_of(flown: Many) -> dict[str, Any]:
    """How near several flights came to the bound, as `studies.batch_cramer_rao.against_bound` has it."""
    return {name: asdict(found) for name, found in against_bound(flown).items()}
