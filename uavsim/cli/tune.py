"""`uavsim tune`: a launch detector's settings for a scenario and a budget of false alarms."""

from pathlib import Path
from typing import Annotated

import typer

from uavsim.cli.common import LARGEST_SEED, Bar, Overwrite, Plugin, finite, folder, plug_in, user_input
from uavsim.cli.printed import Json, document, remark
from uavsim.cli.roc import kind_of, load
from uavsim.files import write_toml
from uavsim.folders import FilePlace, Place


def tune(
    scenario: Annotated[str, typer.Argument(help="A packaged name, a TOML file or a flight's folder.")] = "catapult",
    *,
    detector: Annotated[str | None, typer.Option(metavar="KIND", help="Kind; the scenario's without it.")] = None,
    false_alarms: Annotated[
        float, typer.Option(metavar="PER_HOUR", max=1e6, callback=finite, help="Budget in each class of exposure, 1/h.")
    ] = 0.1,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Tuned on; the next one scores.")] = 1,
    trials: Annotated[int, typer.Option(min=10, max=20_000, help="Launches; twice as many score.")] = 200,
    workers: Annotated[int | None, typer.Option(min=1, max=1024, help="Threads; one a processor without it.")] = None,
    plugin: Plugin = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder, or file that ends in .toml, to write.")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Find a launch detector's settings.

    Most of the scenario's launches detected, then soonest, with no more false alarms and false wing commands than the
    budget in every class of exposure: handling, vibration, a load of 4.1 g that is held, soft drops (there the wing
    command alone). Scored on seeds that were not tuned on, with the worst class. Prints the lines for a scenario's
    file, and writes the scenario with them. A scenario that expects its launch to be missed is refused.

    Example: uavsim tune catapult --detector inav --false-alarms 1 --out output/tuned

    Example: uavsim tune catapult --out tuned.toml && uavsim fly tuned.toml
    """
    from uavsim.studies import reach, tuning
    from uavsim.studies.workers import threads
    from uavsim.views import documents, terminal
    from uavsim.views import tuning as view

    plug_in(plugin)
    kind = None if detector is None else kind_of(detector, "--detector")
    loaded = load(scenario)
    with user_input():
        tuning.check(loaded)
        hours = tuning.hours_for(false_alarms)

    one = out is not None and out.suffix == ".toml"
    place = folder(out, f"tune-{loaded.name}-{seed}", overwrite=overwrite, kind=FilePlace if one else Place)
    with place as held:  # before anything is computed in vain
        rate = loaded.accelerometer.description().rate
        if plain := reach.plain([tuning.own_keys(loaded.detector, kind)], rate):
            remark(reach.tuning_told(hours, rate, reach.why(plain)), as_json=as_json)
        elif wait := reach.patience(reach.tuning_lasts(hours, rate, threads(workers))):
            remark(wait, as_json=as_json)
        with Bar(f"tuning {kind or loaded.detector.kind}") as bar, user_input():
            found = tuning.tune(
                loaded,
                kind,
                budget=false_alarms,
                seed=seed,
                trials=trials,
                workers=workers,
                progress=bar.show,
            )
        if one:
            write_toml(held.folder / held.target.name, found.scenario.to_dict())
        else:
            view.save(found, held.folder)
    if as_json:
        document(documents.tuned(found, held.target))
        return
    view.print_tuned(found)
    terminal.say(f"written to {held.target}")
