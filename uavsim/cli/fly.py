"""`uavsim fly`: one flight, or a few with a table of all."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import (
    INTERRUPTED,
    LARGEST_SEED,
    Bar,
    NoPlots,
    Out,
    Overwrite,
    as_expected,
    folder,
    leave,
    plotter,
    user_input,
)

if TYPE_CHECKING:
    from uavsim.cosim import Cosimulation
    from uavsim.scenario import Scenario
    from uavsim.studies.batch import Batch

MOST_FLIGHTS = 100_000


def fly(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")] = "catapult",
    *,
    seed: Annotated[int | None, typer.Option(help="Draws sensors, clocks, wait, wind and force.")] = None,
    seeds: Annotated[str | None, typer.Option(help="Several flights: 1-50 or 1,5,9.")] = None,
    out: Out = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one key of the scenario.")
    ] = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
) -> None:
    """Fly a scenario, print its score, and write its folder.

    Example: uavsim fly catapult --seed 7 --set accelerometer.preset=adxl345

    Example: uavsim fly gusty --seeds 1-50 --out output/gusty-50
    """
    from uavsim.scenario import load_scenario

    if seed is not None and seeds is not None:
        raise typer.BadParameter("give --seed or --seeds, not both")
    numbers = [] if seeds is None else seeds_of(seeds)
    with user_input():
        first = numbers[0] if numbers else seed
        loaded = load_scenario(scenario, overrides=settings or (), seed=first, seed_name="--seed")

    def place() -> Path:
        return folder(out, f"{loaded.name}-{named(numbers) or loaded.seed}", overwrite=overwrite)

    place()  # before anything is flown in vain
    simulation = _ready(loaded, settings or ())
    if numbers:
        _fly_many(loaded, numbers, place, plots=not no_plots, overwrite=overwrite)
    else:
        _fly_one(simulation, place, plots=not no_plots, overwrite=overwrite)


def _ready(scenario: "Scenario", given: list[str] | tuple[()]) -> "Cosimulation":
    """Set a flight up: only JSBSim knows whether an aircraft has the properties that are asked for."""
    from uavsim.cosim import Cosimulation

    where = "--set" if any(g.strip().startswith("aircraft.") for g in given) else scenario.name
    with user_input(f"{where}: "):
        return Cosimulation(scenario)


def _fly_one(simulation: "Cosimulation", place: Callable[[], Path], *, plots: bool, overwrite: bool) -> None:
    from uavsim.cosim import CHUNK
    from uavsim.views import terminal

    with Bar(f"flying {simulation.scenario.name}, seed {simulation.scenario.seed}") as bar:
        while not simulation.ended:
            simulation.advance(CHUNK)
            bar.show(simulation.plant.k / simulation.steps)
    flight = simulation.finish()
    written = flight.save(place(), overwrite=overwrite, extra=plotter(flight) if plots else None)
    terminal.print_score(flight)
    terminal.say(f"written to {written}")
    leave(as_expected(flight.score))


def _fly_many(
    scenario: "Scenario", numbers: list[int], place: Callable[[], Path], *, plots: bool, overwrite: bool
) -> None:
    from uavsim.studies.batch import fly_seeds
    from uavsim.views import batch as view
    from uavsim.views import terminal

    with Bar(f"flying {scenario.name}") as bar:
        flown = fly_seeds(scenario, numbers, progress=lambda done, all_: bar.show(done / all_))
    if not len(flown.runs):
        raise KeyboardInterrupt
    written = place()
    view.save(flown, written, overwrite=overwrite, plots=plots)
    terminal.print_batch(flown)
    terminal.say(f"written to {written}")
    if not flown.complete:
        typer.echo(f"interrupted: {len(flown.runs)} of {len(numbers)} flights are kept", err=True)
        raise typer.Exit(INTERRUPTED)
    leave(_all_as_expected(flown))


def _all_as_expected(flown: "Batch") -> bool:
    return bool((flown.runs["outcome"] == flown.runs["expected"]).all() and flown.runs["requirements.met"].all())


def seeds_of(text: str) -> list[int]:
    """Seeds from `1-50` or `1,5,9-12`."""
    numbers: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"([0-9]{1,19})(?:-([0-9]{1,19}))?", part.strip())
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, -1)
        if last < first or last > LARGEST_SEED:
            raise typer.BadParameter(
                f"{text[:40]!r}: give seeds as 1-50 or 1,5,9, from 0 to {LARGEST_SEED}", param_hint="--seeds"
            )
        if last - first >= MOST_FLIGHTS - len(numbers):
            raise typer.BadParameter(f"{text[:40]!r}: more than {MOST_FLIGHTS} flights", param_hint="--seeds")
        numbers += range(first, last + 1)
    if len(set(numbers)) != len(numbers):
        raise typer.BadParameter(f"{text[:40]!r} names a seed twice", param_hint="--seeds")
    return numbers


def named(numbers: list[int]) -> str:
    """Name several seeds in a folder's name."""
    if len(numbers) > 1 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]}-{numbers[-1]}"
    listed = ",".join(map(str, numbers))
    return listed if len(listed) <= 40 else f"{len(numbers)}-seeds"
