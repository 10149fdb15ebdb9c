"""`uavsim verify`: whether a scenario's requirements are met, with a stated confidence."""

from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import Interrupted, NoPlots, Out, Overwrite, Plugin, finite, leave, plug_in, user_input
from uavsim.cli.flights import (
    Dashboard,
    Insecure,
    KeepRule,
    Limit,
    Means,
    Resume,
    Scheduler,
    Seed,
    Settings,
    TlsCa,
    TlsCert,
    TlsKey,
    Workers,
    before_of,
    campaign_folder,
    keep_rule,
    ready,
    remark,
    say_unfinished,
)
from uavsim.cli.printed import Json, document
from uavsim.cli.progress import FlightsBar
from uavsim.studies.campaign.keep import DEFAULT

if TYPE_CHECKING:
    from uavsim.studies.campaign.keep import Keep
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.campaign.verify import Verified

MOST = 1_000_000


def verify(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")],
    *,
    runs: Annotated[
        int, typer.Option("--runs", min=1, max=MOST, help="Flights at most; fewer if all is decided.")
    ] = 3000,
    confidence: Annotated[
        float, typer.Option("--confidence", callback=finite, help="Of each statement, above 0.5 and below 1.")
    ] = 0.95,
    requirements: Annotated[
        str | None,
        typer.Option("--requirements", metavar="FILE|NAME", help="A pack, in place of the scenario's own."),
    ] = None,
    sampling: Annotated[str, typer.Option("--sampling", help="random: no other draws can be tested.")] = "random",
    seed: Seed = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    keep: KeepRule = DEFAULT,
    out: Out = None,
    resume: Resume = False,
    settings: Settings = None,
    plugin: Plugin = None,
    flight_limit: Limit = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
    dashboard: Dashboard = False,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    insecure: Insecure = False,
    as_json: Json = False,
) -> None:
    """Test a scenario's requirements statistically.

    It flies until each is decided, or the flights run out. Exit status 0 if all are met, 1 if one is not met or
    undecided.

    Example: uavsim verify dispersed --requirements small-uav --out output/verify

    Example: uavsim verify catapult --requirements launch-detector

    Example: uavsim verify mine.toml --runs 2000 --confidence 0.9 --resume --out output/mine
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.campaign.plan import Random
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.campaign.verify import asking, outlooks
    from uavsim.views import verification as view

    plug_in(plugin)
    means = Means(workers, scheduler, tls_ca, tls_cert, tls_key, insecure, dashboard, flight_limit)
    means.check()
    _check(confidence, sampling)
    rule = keep_rule(keep)
    with user_input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=seed, seed_name="--seed")
        asked = asking(loaded, requirements)
        plan = Random(asked, runs)
        first = plan.flight(0)
        expected = outlooks(asked, confidence, runs)
    with campaign_folder(out, f"verify-{asked.name}-{asked.seed}", overwrite=overwrite, resume=resume) as place:
        before = before_of(place, plan, resume=resume)
        remark(ready(first, settings).remarks)
        _expect(view.print_expected(expected, confidence, runs, text=as_json))
        started = monotonic()
        record = Record(place.folder, plan, keep=str(rule), before=before)
        found = _flown(record, means, rule, confidence)
        view.write(found, expected, place.folder, plots=not no_plots, seconds=monotonic() - started)
    if as_json:
        from uavsim.views.documents import plain

        document(plain({"folder": place.target, **view.summary(found, expected)}))
    else:
        from uavsim.views import terminal

        view.print_verified(found)
        terminal.say(f"written to {place.target}")
    _say_left(record, found)
    leave(found.met and not found.left)


def _check(confidence: float, sampling: str) -> None:
    if sampling != "random":
        raise typer.BadParameter(
            f"{sampling[:40]!r}: must be random; flights of a design are not independent, and no test of theirs keeps "
            "its error",
            param_hint="--sampling",
        )
    if not 0.5 < confidence < 1.0:
        raise typer.BadParameter(f"{confidence:g}: must be above 0.5 and below 1", param_hint="--confidence")


def _expect(text: str | None) -> None:
    """With `--json`, what is expected goes to standard error: it is to be read before the start."""
    if text is not None:
        typer.echo(text, err=True)


def _flown(record: "Record", means: Means, keep: "Keep", confidence: float) -> "Verified":
    from uavsim.studies.campaign.verify import fly_until_decided

    try:
        with FlightsBar(f"flying {record.plan.scenario.name}") as bar, means.crew() as crew, user_input():
            return fly_until_decided(record, crew, keep, confidence, limit=means.limit, progress=bar.flew)
    except KeyboardInterrupt:
        if not record.finished:
            raise
        raise Interrupted(f"{record.finished} flights are kept; go on with the same command and --resume") from None


def _say_left(record: "Record", found: "Verified") -> None:
    from uavsim.studies.campaign.verify import flights_of

    say_unfinished(flights_of(record, found), end=False)
