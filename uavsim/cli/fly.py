"""`uavsim fly`: one flight, or a few with a table of all."""

import re
import shlex
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import (
    LARGEST_SEED,
    Bar,
    Interrupted,
    NoPlots,
    Out,
    Overwrite,
    Plugin,
    WrongInputError,
    as_expected,
    folder,
    leave,
    plotter,
    plug_in,
    user_input,
)
from uavsim.cli.printed import Json, document
from uavsim.folders import Place
from uavsim.views.text import visible

if TYPE_CHECKING:
    from uavsim.cosim import Cosimulation
    from uavsim.flight import Flight
    from uavsim.scenario import Scenario
    from uavsim.studies.batch import Batch
    from uavsim.views.batch import Record

Held = AbstractContextManager[Place]
Ready = Callable[[], "Cosimulation"]

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
    plugin: Plugin = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Fly a scenario, print its score, and write its folder.

    Example: uavsim fly catapult --seed 7 --set accelerometer.preset=adxl345

    Example: uavsim fly gusty --seeds 1-50 --out output/gusty-50

    Example: uavsim fly catapult --plugin mine.py --set detector.kind=mine --set detector.options.level=30
    """
    from uavsim.scenario import load_scenario

    plug_in(plugin)
    if seed is not None and seeds is not None:
        raise typer.BadParameter("give --seed or --seeds, not both")
    numbers = [] if seeds is None else seeds_of(seeds)
    with user_input():
        first = numbers[0] if numbers else seed
        loaded = load_scenario(scenario, overrides=settings or (), seed=first, seed_name="--seed")

    name = f"{loaded.name}-{named(numbers) or loaded.seed}"
    place = folder(out, name, overwrite=overwrite)
    ready = partial(_ready, loaded, settings or ())
    if numbers:
        given = [scenario, *(part for change in settings or () for part in ("--set", change))]
        _fly_many(loaded, numbers, place, ready, plots=not no_plots, given=given, as_json=as_json)
    else:
        _fly_one(place, ready, plots=not no_plots, as_json=as_json)


def _ready(scenario: "Scenario", given: list[str] | tuple[()]) -> "Cosimulation":
    """Set a flight up: only JSBSim knows whether an aircraft has the properties that are asked for."""
    from uavsim.cosim import Cosimulation

    where = "--set" if any(g.strip().startswith("aircraft.") for g in given) else scenario.name
    with user_input(f"{where}: "):
        return Cosimulation(scenario)


def _fly_one(place: Held, ready: Ready, *, plots: bool, as_json: bool) -> None:
    from uavsim.views import documents, terminal

    with place as held:  # before anything is flown in vain
        simulation = ready()
        _remark(simulation.remarks)
        flight = _flown(simulation)
        flight.write(held.folder, plotter(flight) if plots else None)
    if as_json:
        document(documents.flight(flight, held.target))
    else:
        terminal.print_score(flight)
        terminal.say(f"written to {held.target}")
    leave(as_expected(flight.score))


def _remark(remarks: list[str]) -> None:
    """Say at the start what deserves a word."""
    for remark in remarks:
        typer.echo(f"Note: {visible(remark)}", err=True)


def _flown(simulation: "Cosimulation") -> "Flight":
    from uavsim.cosim import CHUNK

    plant, scenario = simulation.plant, simulation.scenario
    try:
        with Bar(f"flying {scenario.name}, seed {scenario.seed}") as bar:
            while not simulation.ended:
                simulation.advance(CHUNK)
                bar.show(plant.k / simulation.steps)
        return simulation.finish()
    except KeyboardInterrupt:
        flown = f"{plant.t:.1f} of {scenario.duration:g} s were flown"
        raise Interrupted(f"{flown}; nothing is written") from None


def _fly_many(
    scenario: "Scenario",
    numbers: list[int],
    place: Held,
    ready: Ready,
    *,
    plots: bool,
    given: list[str],
    as_json: bool,
) -> None:
    from uavsim.studies.batch import fly_seeds
    from uavsim.views import batch as view
    from uavsim.views import documents, terminal

    with place as held:
        _remark(ready().remarks)  # and to see whether it can be flown
        record = view.Record(held.folder, scenario, numbers)
        with Bar(f"flying {scenario.name}") as bar:
            flown = fly_seeds(scenario, numbers, progress=lambda n, all_: bar.show(n / all_), keep=record.keep)
        left = _left(flown, given)
        if not len(flown.runs):
            raise KeyboardInterrupt if not flown.lost else WrongInputError(f"no flight is finished: {left}")
        drawn = _closed(record, flown, plots=plots)
    if as_json:
        document(documents.batch(flown, held.target))
    else:
        terminal.print_batch(flown)
        terminal.say(f"written to {held.target}")
    if left:
        typer.echo(f"unfinished: {left}", err=True)
        leave(well=False)
    if not (flown.complete and drawn):
        remark = "" if drawn else "; not all plots are drawn"
        raise Interrupted(f"{len(flown.runs)} of {len(numbers)} flights are kept{remark}")
    leave(_all_as_expected(flown))


def _left(flown: "Batch", given: list[str]) -> str:
    """Name the seeds whose process died, and the command that flies them; empty if there are none."""
    from uavsim.views.batch import ranges

    if not flown.lost:
        return ""
    seeds = ranges(flown.lost)
    command = shlex.join(["uavsim", "fly", *given, "--seeds", seeds])
    return f"seed {seeds}, whose process died twice; what is left is flown by: {command}"


def _closed(record: "Record", flown: "Batch", *, plots: bool) -> bool:
    """Complete the folder; False if somebody did not want to wait for it."""
    try:
        record.close(flown, plots=plots)
    except KeyboardInterrupt:
        return False
    return True


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
