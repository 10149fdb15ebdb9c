"""`uavsim sensitivity`: which dispersion drives latency, airspeed error, exit speed and outcome."""

from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import NoPlots, Out, Overwrite, Plugin, leave, plug_in, user_input
from uavsim.cli.flights import (
    Dashboard,
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

if TYPE_CHECKING:
    from pathlib import Path

    from uavsim.scenario import Scenario
    from uavsim.studies.campaign.keep import Keep
    from uavsim.studies.campaign.plan import Points
    from uavsim.studies.campaign.sensitivity import Design


def sensitivity(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")],
    *,
    runs: Runs,
    seed: Seed = None,
    output: Annotated[
        list[str] | None, typer.Option("--output", metavar="KEY", help="A number of the score; may repeat.")
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    keep: KeepRule = "none",
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
    """Say what drives latency, airspeed error and outcome.

    Sobol indices where the flights suffice for them, else Morris screening.

    Example: uavsim sensitivity dispersed --runs 200 --out output/screening

    Example: uavsim sensitivity dispersed-sensors --runs 2000 --output launch.latency
    """
    from uavsim import dispersions
    from uavsim.scenario import load_scenario
    from uavsim.studies.campaign.plan import Points
    from uavsim.studies.campaign.sensitivity import OUTPUTS, design

    plug_in(plugin)
    means = Means(workers, scheduler, tls_ca, tls_cert, tls_key, insecure, dashboard, flight_limit)
    means.check()
    rule = keep_rule(keep)
    outputs = _outputs(output) or OUTPUTS
    with user_input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=seed, seed_name="--seed")
        _check_dispersed(loaded)
    with user_input("--runs: "):
        flights = design(dispersions.keys(loaded), runs, loaded.seed)
    points = tuple(tuple(point) for point in flights.points.tolist())
    plan = Points(loaded, points, tuple(flights.indices.tolist()))
    _fly(plan, flights, outputs, means, rule=rule, out=out, given=settings, resume=resume, overwrite=overwrite,
         plots=not no_plots, as_json=as_json)  # fmt: skip


def _outputs(given: list[str] | None) -> tuple[str, ...]:
    """Check what is asked for: numbers of the score, or `outcome`."""
    from sensors.choice import nearest, shown
    from uavsim.score_keys import NUMBERS
    from uavsim.studies.campaign.sensitivity import AS_EXPECTED

    known = (AS_EXPECTED, *NUMBERS)
    for name in given or ():
        if name not in known:
            near = nearest(name, known)
            hint = f"; did you mean {near!r}?" if near else f"; there are {AS_EXPECTED} and the numbers of a score"
            raise typer.BadParameter(f"{shown(name)} is no number of the score{hint}", param_hint="--output")
    return tuple(dict.fromkeys(given or ()))


def _check_dispersed(scenario: "Scenario") -> None:
    """Refuse a scenario of which nothing is dispersed.

    Raises
    ------
    ValueError
        One line that says what to add.
    """
    from uavsim import dispersions

    if not dispersions.keys(scenario):
        raise ValueError(
            f"{scenario.name}: has no dispersions, so that there is nothing to be sensitive to; add [[dispersions]] "
            'with key = "launcher.friction", distribution = "uniform", low = 0.5, high = 2.0, relative = true to a '
            "file of it, or take the packaged scenario dispersed"
        )


def _fly(
    plan: "Points", design: "Design", outputs: tuple[str, ...], means: Means, *, rule: "Keep", out: "Path | None",
    given: list[str] | None, resume: bool, overwrite: bool, plots: bool, as_json: bool,
) -> None:  # fmt: skip
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.campaign.sensitivity import effects_of
    from uavsim.views import sensitivity as view
    from uavsim.views import terminal

    name = f"{plan.scenario.name}-{plan.scenario.seed}-sensitivity"
    with campaign_folder(out, name, overwrite=overwrite, resume=resume) as place:
        before = before_of(place, plan, resume=resume)
        remark([view.remark(design), *ready(plan.flight(0), given).remarks])
        flights = flown(Record(place.folder, plan, keep=str(rule), before=before), means, rule)
        found = view.Study(plan.scenario, design, effects_of(flights.runs, design, outputs, plan.scenario.seed))
        view.save(found, place.folder, plots=plots)
    if as_json:
        document({"folder": str(place.target), **view.summary(found)})
    else:
        view.print_study(found)
        terminal.say(f"written to {place.target}")
    say_unfinished(flights)
    leave(well=flights.complete)
