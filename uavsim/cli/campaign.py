"""`uavsim campaign`: many flights of a scenario, each with its own draws."""

import shutil
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from uavsim.cli.common import NoPlots, Out, Overwrite, Plugin, as_expected, leave, plug_in, user_input
from uavsim.cli.flights import (
    Dashboard,
    DryRun,
    Insecure,
    KeepRule,
    Limit,
    Means,
    Resume,
    Runs,
    Scheduler,
    Seed,
    Settings,
    TlsCa,
    TlsCert,
    TlsKey,
    Workers,
    before_of,
    campaign_folder,
    flown,
    keep_rule,
    ready,
    remark,
    say_unfinished,
)
from uavsim.cli.printed import Json, document
from uavsim.studies.campaign.keep import DEFAULT

if TYPE_CHECKING:
    from uavsim.studies.campaign.keep import Keep
    from uavsim.studies.campaign.plan import Plan

MOST_ROWS = 1000  # in a document; those of more flights are in the folder


def campaign(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")],
    *,
    runs: Runs,
    seed: Seed = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    keep: KeepRule = DEFAULT,
    sampling: Annotated[
        str, typer.Option("--sampling", help="random, or for means latin-hypercube or sobol.")
    ] = "random",
    out: Out = None,
    resume: Resume = False,
    dry_run: DryRun = False,
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
    """Fly a scenario many times, each flight with draws of its own.

    Example: uavsim campaign dispersed --runs 1000 --out output/dispersed-1000

    Example: uavsim campaign dispersed --runs 1000 --out output/dispersed-1000 --resume
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.campaign.campaign import sampled

    plug_in(plugin)
    means = Means(workers, scheduler, tls_ca, tls_cert, tls_key, insecure, dashboard, flight_limit)
    means.check()
    rule = keep_rule(keep)
    with user_input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=seed, seed_name="--seed")
        plan = sampled(loaded, runs, sampling)
        first = plan.flight(0)
    if dry_run:
        _tell_cost(plan, rule, ready(first, settings), means)
        return
    _fly(plan, rule, means, out=out, given=settings, resume=resume, overwrite=overwrite, plots=not no_plots,
         as_json=as_json)  # fmt: skip


def _fly(
    plan: "Plan", rule: "Keep", means: Means, *, out: Any, given: list[str] | None, resume: bool, overwrite: bool,
    plots: bool, as_json: bool,
) -> None:  # fmt: skip
    from uavsim.studies.campaign.many import many_of
    from uavsim.studies.campaign.record import Record
    from uavsim.views import batch as view
    from uavsim.views import documents, terminal

    name = f"{plan.scenario.name}-{plan.scenario.seed}-{plan.size}"
    with campaign_folder(out, name, overwrite=overwrite, resume=resume) as place:
        before = before_of(place, plan, resume=resume)
        remark([*ready(plan.flight(0), given).remarks, *_need(plan, rule, place.folder)])
        record = Record(place.folder, plan, keep=str(rule), before=before)
        flights = flown(record, means, rule)
        all_ = many_of(flights)
        view.close(record, flights, all_, plots=plots)
    if as_json:
        document(documents.batch(all_, place.target, with_rows=len(all_.runs) <= MOST_ROWS))
    else:
        terminal.print_batch(all_, place.target)
        terminal.say(f"written to {place.target}")
    say_unfinished(flights)
    leave(bool((all_.runs["outcome"] == all_.runs["expected"]).all() and all_.runs["requirements.met"].all()))


def _need(plan: "Plan", rule: "Keep", folder: Any) -> list[str]:
    """Say what kept flights will take on the disk, if that is much."""
    from uavsim.studies.campaign.cost import flight_bytes

    count = rule.expected(plan.size)
    if count is None or count < 100:
        return []
    need, free = count * flight_bytes(plan.scenario), shutil.disk_usage(folder).free
    words = f"{count} kept flights take about {need / 1e9:.1f} GB, and {free / 1e9:.1f} GB are free"
    return [words]


def _tell_cost(plan: "Plan", rule: "Keep", simulation: Any, means: Means) -> None:
    """Fly one and say what all would take."""
    import os

    from uavsim.studies.campaign.cost import flight_bytes
    from uavsim.views import terminal

    started = monotonic()
    simulation.advance(simulation.steps)
    flight = simulation.finish()
    one = monotonic() - started
    workers = means.workers or os.cpu_count() or 1
    kept = rule.expected(plan.size)
    disk = (
        "as many flights as fail"
        if kept is None
        else f"{kept} kept flights, about " + _size(kept * flight_bytes(plan.scenario))
    )
    whose = "on the scheduler's workers" if means.scheduler else f"on {workers} processes"
    time = "" if means.scheduler else f", about {_duration(plan.size * one / workers)}"
    terminal.say(
        f"{plan.size} flights of {plan.scenario.name}: one took {one:.2f} s ({flight.score['outcome']}, "
        f"{'as' if as_expected(flight.score) else 'not as'} expected); {whose}{time}; {disk}"
    )


def _duration(seconds: float) -> str:
    return (
        f"{seconds:.0f} s"
        if seconds < 120
        else f"{seconds / 60:.0f} min"
        if seconds < 7200
        else (f"{seconds / 3600:.1f} h")
    )


def _size(count: float) -> str:
    return f"{count / 1e6:.0f} MB" if count < 1e9 else f"{count / 1e9:.1f} GB"
