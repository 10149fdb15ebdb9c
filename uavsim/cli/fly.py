"""`uavsim fly`: one flight, or a few with a table of all."""

import re
import shlex
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
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
from uavsim.cli.flights import Means, ready, remark
from uavsim.cli.printed import Json, document
from uavsim.cli.progress import FlightsBar
from uavsim.folders import Place

if TYPE_CHECKING:
    from uavsim.cosim import Cosimulation
    from uavsim.flight import Flight
    from uavsim.scenario import Scenario
    from uavsim.studies.campaign.campaign import Flights
    from uavsim.studies.campaign.many import Many
    from uavsim.studies.campaign.record import Record

Held = AbstractContextManager[Place]
Ready = Callable[[], "Cosimulation"]

MOST_FLIGHTS = 100_000


def fly(
    scenario: Annotated[
        str | None, typer.Argument(help="A packaged name (catapult if not given), a TOML file or a flight's folder.")
    ] = None,
    *,
    seed: Annotated[int | None, typer.Option(help="Draws sensors, clocks, wait, wind and force.")] = None,
    seeds: Annotated[str | None, typer.Option(help="Several flights: 1-50 or 1,5,9.")] = None,
    from_: Annotated[Path | None, typer.Option("--from", help="A campaign's folder: fly one of its flights.")] = None,
    index: Annotated[int | None, typer.Option(min=0, help="Which of them.")] = None,
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

    Example: uavsim fly --from output/dispersed-1-1000 --index 17

    Example: uavsim fly catapult --plugin mine.py --set detector.kind=mine --set detector.options.level=30
    """
    from uavsim.scenario import load_scenario

    plug_in(plugin)
    if seed is not None and seeds is not None:
        raise typer.BadParameter("give --seed or --seeds, not both")
    if from_ is not None:
        _refuse_with_from(scenario, seed, seeds, settings)
        loaded = _again(from_, index)
        where = folder(out, f"{loaded.name}-{loaded.seed}-flight-{loaded.index}", overwrite=overwrite)
        _fly_one(where, partial(ready, loaded, None), plots=not no_plots, as_json=as_json)
        return
    if index is not None:
        raise typer.BadParameter("--index needs --from, the campaign's folder")
    numbers = [] if seeds is None else seeds_of(seeds)
    with user_input():
        first = numbers[0] if numbers else seed
        loaded = load_scenario(scenario or "catapult", overrides=settings or (), seed=first, seed_name="--seed")

    place = folder(out, f"{loaded.name}-{named(numbers) or loaded.seed}", overwrite=overwrite)
    given = settings or []
    if numbers:
        again = shlex.join(
            ["uavsim", "fly", scenario or "catapult", *(part for change in given for part in ("--set", change))]
        )
        _fly_many(loaded, numbers, place, given, plots=not no_plots, as_json=as_json, again=again)
    else:
        _fly_one(place, partial(ready, loaded, given), plots=not no_plots, as_json=as_json)


def _refuse_with_from(scenario: str | None, seed: int | None, seeds: str | None, settings: list[str] | None) -> None:
    """A flight of a campaign is flown as it was."""
    given = {"SCENARIO": scenario, "--seed": seed, "--seeds": seeds, "--set": settings}
    wrong = next((name for name, value in given.items() if value), None)
    if wrong is not None:
        raise typer.BadParameter(f"--from flies what is in that folder; it goes with --index, not with {wrong}")


def _again(campaign: Path, index: int | None) -> "Scenario":
    """Return what flew as one flight of a campaign."""
    from uavsim.studies.campaign.campaign import scenario_in
    from uavsim.studies.campaign.record import plan_in

    if index is None:
        raise typer.BadParameter("--from needs --index, the flight's number")
    with user_input():
        return scenario_in(plan_in(campaign), index)


def _fly_one(place: Held, set_up: Ready, *, plots: bool, as_json: bool) -> None:
    from uavsim.views import documents, terminal

    with place as held:  # before anything is flown in vain
        simulation = set_up()
        remark(simulation.remarks)
        flight = _flown(simulation)
        flight.write(held.folder, plotter(flight) if plots else None)
    if as_json:
        document(documents.flight(flight, held.target))
    else:
        terminal.print_score(flight)
        terminal.say(f"written to {held.target}")
    leave(as_expected(flight.score))


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
    scenario: "Scenario", numbers: list[int], place: Held, given: list[str], *, plots: bool, as_json: bool, again: str
) -> None:
    from uavsim.studies.campaign.keep import FIRST_AND_FAILURES
    from uavsim.studies.campaign.many import many_of
    from uavsim.studies.campaign.plan import Seeds
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.engine import processes
    from uavsim.views import documents, terminal

    plan = Seeds(scenario, tuple(numbers))
    with place as held:
        remark(ready(plan.flight(0), given).remarks)  # and to see whether it can be flown
        record = Record(held.folder, plan, keep=str(FIRST_AND_FAILURES))
        flights = _flown_many(record, Means(workers=processes(None, len(numbers))))
        all_ = many_of(flights)
        left = _left(flights, again)
        if not len(all_.runs):
            raise KeyboardInterrupt if not left else WrongInputError(f"no flight is finished: {left}")
        drawn = _closed(record, flights, all_, plots=plots)
    if as_json:
        document(documents.batch(all_, held.target, seeds=True))
    else:
        terminal.print_batch(all_, held.target)
        terminal.say(f"written to {held.target}")
    if left:
        typer.echo(f"unfinished: {left}", err=True)
        leave(well=False)
    if not (flights.complete and drawn):
        words = "" if drawn else "; not all plots are drawn"
        raise Interrupted(f"{len(all_.runs)} of {len(numbers)} flights are kept{words}")
    leave(_all_as_expected(all_))


def _flown_many(record: "Record", means: Means) -> "Flights":
    """Fly all; an interrupt leaves what is finished."""
    from uavsim.studies.campaign.campaign import Flights, fly_plan
    from uavsim.studies.campaign.keep import FIRST_AND_FAILURES

    try:
        with FlightsBar(f"flying {record.plan.scenario.name}") as bar, means.crew() as crew:
            return fly_plan(record, crew, FIRST_AND_FAILURES, progress=bar.flew)
    except KeyboardInterrupt:
        return Flights(record.folder, record.plan, complete=False)


def _left(flights: "Flights", again: str) -> str:
    """Name the seeds that could not be flown, and the command that flies them; empty if there are none."""
    from uavsim.studies.campaign.record import ranges

    if not flights.left:
        return ""
    seeds = ranges(flights.plan.index(one.position) for one in flights.left)
    why = "; ".join(dict.fromkeys(one.why for one in flights.left))
    return f"seed {seeds}: {why}; what is left is flown by: {again} --seeds {seeds}"


def _closed(record: "Record", flights: "Flights", flown: "Many", *, plots: bool) -> bool:
    """Complete the folder; False if somebody did not want to wait for it."""
    from uavsim.views import batch as view

    try:
        view.close(record, flights, flown, plots=plots)
    except KeyboardInterrupt:
        return False
    return True


def _all_as_expected(flown: "Many") -> bool:
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
