"""`uavsim rare`: probabilities far below one over the flights that can be flown."""

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from uavsim.cli.common import LARGEST_SEED, Bar, NoPlots, Out, Overwrite, Plugin, finite, folder, plug_in, user_input
from uavsim.cli.flights import Means, Settings, Workers
from uavsim.cli.printed import Json, document
from uavsim.cli.roc import kind_of

if TYPE_CHECKING:
    from uavsim.studies.campaign.rare.asked import Found

G0 = 9.80665  # m/s²


def rare(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")],
    *,
    event: Annotated[
        str, typer.Option("--event", help="false_launch, missed_launch, crashed, KEY<=VALUE or KEY>=VALUE.")
    ] = "false_launch",
    runs: Annotated[
        int, typer.Option("--runs", min=200, max=10_000_000, help="Budget: flights' worth of work, at most.")
    ] = 6000,
    seed: Annotated[int, typer.Option("--seed", min=0, max=LARGEST_SEED, help="Fixes the result.")] = 1,
    detector: Annotated[
        str | None, typer.Option("--detector", metavar="KIND", help="Another kind than the scenario's.")
    ] = None,
    sigma: Annotated[
        float | None,
        typer.Option("--sigma", min=1e-6, max=100.0, callback=finite, help="Noise and vibration at the detector, g."),
    ] = None,
    seconds: Annotated[
        float, typer.Option("--seconds", min=0.01, max=600.0, callback=finite, help="Of a sequence at rest.")
    ] = 5.0,
    flights: Annotated[
        bool, typer.Option("--flights", help="missed_launch of whole flights, not of a stroke.")
    ] = False,
    workers: Workers = None,
    settings: Settings = None,
    plugin: Plugin = None,
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
    as_json: Json = False,
) -> None:
    """Estimate the probability of a rare event, with an error bar.

    false_launch and missed_launch are those of the detector in the noise of its accelerometer, at rest and in a stroke;
    other events are those of whole flights, on the scenario's dispersions.

    Example: uavsim rare catapult --event false_launch --detector single-threshold --sigma 1.2

    Example: uavsim rare dispersed --event crashed --runs 2000 --out output/crashes
    """
    from uavsim.scenario import load_scenario
    from uavsim.views import rare as view
    from uavsim.views import terminal

    plug_in(plugin)
    with user_input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=seed, seed_name="--seed")
    if detector is not None:
        kind = kind_of(detector, "--detector")
        loaded = replace(loaded, detector=replace(loaded.detector, kind=kind, options=None))
    noise = None if sigma is None else sigma * G0
    with folder(out, f"rare-{loaded.name}-{seed}", overwrite=overwrite) as place:
        found = _ask(loaded, event, seed, runs, noise, seconds, Means(workers), whole=flights)
        view.save(found, place.folder, plots=not no_plots)
    if as_json:
        document({"folder": str(place.target), **view.summary(found)})
        return
    view.print_found(found)
    terminal.say(f"written to {place.target}")


def _ask(
    scenario: Any, event: str, seed: int, budget: int, sigma: float | None, seconds: float, means: Means, *, whole: bool
) -> "Found":
    from uavsim.studies.campaign.rare import asked
    from uavsim.studies.campaign.rare.flights import event_of, flown_by, in_flight

    with Bar(f"looking for {event}") as bar:
        if asked.of_detector(event) and not (whole and event == asked.MISSED):
            with user_input():
                return asked.of_signals(scenario, event, seed=seed, budget=budget, sigma=sigma, seconds=seconds)
        if sigma is not None:
            raise typer.BadParameter("a whole flight has the noise of its own sensors", param_hint="--sigma")
        with user_input():  # before workers are there
            in_flight(scenario, event_of(event), lambda *_: ())
        with means.crew() as crew, user_input():
            return asked.of_flights(
                scenario, event, flown_by(crew, scenario), seed=seed, budget=budget, progress=bar.show
            )
