"""`uavsim sweep`: a scenario flown over a grid of assumptions, the same flights in every cell."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from uavsim.cli.common import NoPlots, Out, Overwrite, Plugin, finite, leave, plug_in, user_input
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
    flown,
    keep_rule,
    remark,
    say_unfinished,
)
from uavsim.cli.printed import Json, document

if TYPE_CHECKING:
    from pathlib import Path

    from uavsim.studies.campaign.keep import Keep
    from uavsim.studies.campaign.plan import Cells
    from uavsim.studies.campaign.vary import Varied

MOST_RUNS = 1_000_000  # in a cell
AIRCRAFT = "aircraft."


def sweep(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")],
    *,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=VALUES", help="a,b,c or from:to:n or 0.5x,1x,2x; may repeat."),
    ] = None,
    runs: Annotated[int, typer.Option("--runs", min=1, max=MOST_RUNS, help="Flights in each cell.")],
    wanted: Annotated[
        float, typer.Option(min=0.01, max=0.9999, callback=finite, help="Probability of meeting a requirement.")
    ] = 0.95,
    seed: Seed = None,
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
    """Fly a scenario over a grid of assumptions.

    Every cell flies the same flights, so that cells differ by what is varied alone.

    Example: uavsim sweep catapult --vary air_data.total.noise_scale=1,2,4,8 --runs 80 --out output/noise

    Example: uavsim sweep catapult --vary detector.kind=adaptive-cusum,px4 --vary accelerometer.bias=0:2:5 --runs 20
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.campaign import vary as varying
    from uavsim.studies.campaign.plan import Cells

    plug_in(plugin)
    means = Means(workers, scheduler, tls_ca, tls_cert, tls_key, insecure, dashboard, flight_limit)
    means.check()
    rule = keep_rule(keep)
    with user_input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=seed, seed_name="--seed")
    with user_input("--vary: "):
        varies = [varying.parse(loaded, one) for one in vary or ()]
        plan = Cells(loaded, varying.cells(loaded, varies), runs)
    _fly(plan, varies, means, rule=rule, out=out, resume=resume, overwrite=overwrite,
         plots=not no_plots, wanted=wanted, as_json=as_json)  # fmt: skip


def _fly(
    plan: "Cells", varies: "list[Varied]", means: Means, *, rule: "Keep", out: "Path | None",
    resume: bool, overwrite: bool, plots: bool, wanted: float, as_json: bool,
) -> None:  # fmt: skip
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.campaign.sweep import of
    from uavsim.views import sweeping as view
    from uavsim.views import terminal
    from uavsim.views.sweeping import tables

    name = f"{plan.scenario.name}-{plan.scenario.seed}-sweep"
    with campaign_folder(out, name, overwrite=overwrite, resume=resume) as place:
        before = before_of(place, plan, resume=resume)
        remark([f"{len(plan.cells)} cells, {plan.runs} flights in each: {plan.size} in all", *_remarks(plan)])
        flights = flown(Record(place.folder, plan, keep=str(rule), before=before), means, rule)
        grid = tuple(dict(cell) for cell in plan.cells)
        found = of(plan.scenario, varies, grid, plan.runs, flights.runs, wanted=wanted)
        view.save(found, place.folder, plots=plots)
    if as_json:
        document({"folder": str(place.target), **view.summary(found)})
    else:
        tables.print_sweep(found)
        terminal.say(f"written to {place.target}")
    say_unfinished(flights)
    leave(well=flights.complete)


def _remarks(plan: "Cells") -> list[str]:
    """Set a flight of the first cell up, and of each whose aircraft is another one; what deserves a word."""
    from uavsim.cosim import Cosimulation
    from uavsim.studies.campaign.vary import told

    seen: list[dict[str, Any]] = []
    remarks: list[str] = []
    for number, cell in enumerate(plan.cells):
        own = {key: value for key, value in cell.items() if key.startswith(AIRCRAFT)}
        if own in seen:
            continue
        seen.append(own)
        with user_input(f"--vary: {told(own)}: " if own else f"{plan.scenario.name}: "):
            remarks += Cosimulation(plan.flight(number * plan.runs)).remarks  # JSBSim alone knows its properties
    return list(dict.fromkeys(remarks))
