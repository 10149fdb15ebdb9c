"""What commands that fly many flights share: their options, who flies, where it is written, and what is said of it."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import (
    LARGEST_SEED,
    UNEXPECTED,
    Interrupted,
    WrongInputError,
    finite,
    folder,
    leave,
    user_input,
)
from uavsim.cli.progress import FlightsBar
from uavsim.folders import Place, StandingPlace
from uavsim.views.text import visible

if TYPE_CHECKING:
    from uavsim.cosim import Cosimulation
    from uavsim.scenario import Scenario
    from uavsim.studies.campaign.campaign import Flights
    from uavsim.studies.campaign.keep import Keep
    from uavsim.studies.campaign.plan import Plan
    from uavsim.studies.campaign.record import Before, Record
    from uavsim.studies.engine import Crew

MOST_FLIGHTS = 10_000_000

Runs = Annotated[int, typer.Option("--runs", min=1, max=MOST_FLIGHTS, help="How many flights.")]
Seed = Annotated[int | None, typer.Option("--seed", min=0, max=LARGEST_SEED, help="Root of all that is drawn.")]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one key of the scenario.")
]
Workers = Annotated[
    int | None, typer.Option("--workers", min=1, max=1000, help="Processes of this machine; one a processor if not.")
]
Scheduler = Annotated[
    str | None, typer.Option("--scheduler", metavar="ADDRESS|FILE", help="A dask scheduler of yours, in their place.")
]
TlsCa = Annotated[str | None, typer.Option("--tls-ca", metavar="FILE", help="Certificate authority of its TLS.")]
TlsCert = Annotated[str | None, typer.Option("--tls-cert", metavar="FILE", help="Our certificate.")]
TlsKey = Annotated[str | None, typer.Option("--tls-key", metavar="FILE", help="Our key.")]
Insecure = Annotated[bool, typer.Option("--insecure", help="Use one that is neither local nor encrypted.")]
Dashboard = Annotated[bool, typer.Option("--dashboard", help="Serve dask's pages on this machine while it flies.")]
KeepRule = Annotated[
    str, typer.Option("--keep", metavar="RULE", help="Flights kept whole: none, all, failures:N, every:N, worst:N:KEY.")
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with what --out holds; fly only what is missing.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Fly one, say what all would cost, and write nothing.")]
Limit = Annotated[
    float | None,
    typer.Option("--flight-limit", min=1.0, metavar="S", callback=finite, help="Time that one flight may take."),
]


@dataclass(frozen=True, slots=True)
class Means:
    """Who flies: options as they were given."""

    workers: int | None = None
    scheduler: str | None = None
    tls_ca: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None
    insecure: bool = False
    dashboard: bool = False
    limit: float | None = None

    def check(self) -> None:
        """Refuse options that do not go together."""
        if self.scheduler is not None and (self.workers is not None or self.dashboard):
            raise typer.BadParameter("--scheduler has workers of its own: give no --workers and no --dashboard")
        if self.scheduler is None and (self.tls_ca or self.tls_cert or self.tls_key or self.insecure):
            raise typer.BadParameter("--tls-… and --insecure say how to reach a --scheduler; give its address")

    @contextmanager
    def crew(self) -> Iterator["Crew"]:
        """Have workers; what is wrong with them is one line."""
        from uavsim.studies.cluster import ClusterError, Remote
        from uavsim.studies.engine import engine

        there = None
        if self.scheduler is not None:
            there = Remote(self.scheduler, self.tls_ca, self.tls_cert, self.tls_key, self.insecure)
        try:
            with engine(workers=self.workers, scheduler=there, dashboard=self.dashboard) as crew:
                if self.dashboard:
                    link = crew.site.client.dashboard_link  # type: ignore[attr-defined]
                    typer.echo(f"dashboard: {link}", err=True)
                if there is not None and not crew.site.client.nthreads():  # type: ignore[attr-defined]
                    typer.echo(f"Note: {there.address} has no workers yet; waiting for some", err=True)
                yield crew
        except ClusterError as error:
            raise WrongInputError(str(error)) from None


def keep_rule(text: str) -> "Keep":
    """Read `--keep`."""
    from uavsim.score_keys import NUMBERS
    from uavsim.studies.campaign.keep import keep_of

    with user_input():
        return keep_of(text, NUMBERS)


def ready(scenario: "Scenario", given: list[str] | None) -> "Cosimulation":
    """Set a flight up: only JSBSim knows whether an aircraft has the properties that are asked for."""
    from uavsim.cosim import Cosimulation

    where = "--set" if any(g.strip().startswith("aircraft.") for g in given or ()) else scenario.name
    with user_input(f"{where}: "):
        return Cosimulation(scenario)


def remark(remarks: list[str]) -> None:
    """Say at the start what deserves a word."""
    for one in remarks:
        typer.echo(f"Note: {visible(one)}", err=True)


@contextmanager
def campaign_folder(out: Path | None, name: str, *, overwrite: bool, resume: bool) -> Iterator[Place]:
    """Hold the folder of a campaign, which is written where it stands."""
    if resume and overwrite:
        raise typer.BadParameter("give --resume or --overwrite, not both")
    if resume and out is None:
        raise typer.BadParameter("--resume needs --out, the folder to go on with")

    with folder(out, name, overwrite=overwrite, kind=partial(StandingPlace, resume=resume)) as place:
        yield place


def before_of(place: Place, plan: "Plan", *, resume: bool) -> "Before | None":
    """What is there to go on with; another campaign is refused."""
    from uavsim.studies.campaign.record import ABOUT, clear, taken_up

    if not resume or not (place.folder / ABOUT).is_file():
        return None
    clear(place.folder)
    with user_input():
        return taken_up(place.folder, plan)


def flown(
    record: "Record", means: Means, keep: "Keep", *, positions: "range | None" = None, crew: "Crew | None" = None
) -> "Flights":
    """Fly what is missing; an interrupt is told with how to go on."""
    from uavsim.studies.campaign.campaign import fly_plan

    name, before = record.plan.scenario.name, record.finished
    try:
        with FlightsBar(f"flying {name}") as bar:
            if crew is not None:
                return fly_plan(record, crew, keep, positions=positions, limit=means.limit, progress=bar.flew)
            with means.crew() as own:
                return fly_plan(record, own, keep, positions=positions, limit=means.limit, progress=bar.flew)
    except KeyboardInterrupt:
        if not record.finished:
            raise
        raise Interrupted(_kept(record)) from None
    except WrongInputError as error:
        if record.finished == before:
            raise
        typer.echo(f"Error: {visible(str(error))}; {_kept(record)}", err=True)
        raise typer.Exit(UNEXPECTED) from None


def _kept(record: "Record") -> str:
    return f"{record.finished} of {record.plan.size} flights are kept; go on with the same command and --resume"


def say_unfinished(flights: "Flights", *, end: bool = True) -> None:
    """Tell which flights could not be flown and why; then the run did not do what was asked for."""
    from uavsim.studies.campaign.record import ranges

    if not flights.left:
        return
    for why in dict.fromkeys(one.why for one in flights.left):
        indices = ranges(flights.plan.index(one.position) for one in flights.left if one.why == why)
        flown = "flight" if indices.isdigit() else "flights"
        typer.echo(f"unfinished: {flown} {_brief(indices)}: {visible(why)}; --resume tries again", err=True)
    if end:
        leave(well=False)


def _brief(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}…"
