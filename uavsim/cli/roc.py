"""`uavsim roc`: operating curves of launch detectors on the same signals."""

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import LARGEST_SEED, Bar, NoPlots, Out, Overwrite, Plugin, finite, folder, plug_in, user_input
from uavsim.cli.printed import Json, document, remark

if TYPE_CHECKING:
    from uavsim.onboard.flight_computer import FlightComputerSettings
    from uavsim.onboard.launch import DetectorSettings
    from uavsim.scenario import Scenario
    from uavsim.studies.trials import Launches

SWEEP = 0.8  # of the progress bar; the rest is the comparison


def roc(
    *,
    detectors: Annotated[str | None, typer.Option(metavar="A,B,...", help="Kinds of detector; all without it.")] = None,
    hours: Annotated[
        float, typer.Option(min=0.01, max=1e5, callback=finite, help="Of the disturbance mix; a quarter of others.")
    ] = 20.0,
    trials: Annotated[int, typer.Option(min=1, max=10_000_000, help="Launches.")] = 1000,
    cells: Annotated[int, typer.Option(min=0, max=1_000_000, help="Launches in each cell of the comparison.")] = 200,
    sigma: Annotated[
        float, typer.Option(min=0.0, max=20.0, callback=finite, help="Noise of the launches that are drawn, g.")
    ] = 0.3,
    scenario: Annotated[str | None, typer.Option(help="Launches and settings of a scenario, flown in JSBSim.")] = None,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Draws launches and disturbances.")] = 1,
    workers: Annotated[int | None, typer.Option(min=1, max=1024, help="Threads; one a processor without it.")] = None,
    plugin: Plugin = None,
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
    as_json: Json = False,
) -> None:
    """Draw launch detectors' operating curves.

    How often each sees the launch, how late, and how often it cries wolf in each class of exposure, at each level of
    its own, all of them on the same signals; how often the wings would open, once the flight computer has looked at the
    speed gained; and the detectors as they are set in cells of peak, noise and bump. Says how long it takes.

    Example: uavsim roc --out output/roc

    Example: uavsim roc --detectors adaptive-cusum,px4 --hours 200 --trials 2000

    Example: uavsim roc --scenario catapult --trials 200

    Example: uavsim roc --plugin mine.py --detectors mine,adaptive-cusum
    """
    from uavsim.onboard.launch import KINDS, DetectorSettings
    from uavsim.studies import operating, reach
    from uavsim.studies.workers import threads
    from uavsim.views import documents, terminal
    from uavsim.views import operating as view
    from uavsim.views import operating_tables as tables

    plug_in(plugin)
    kinds = kinds_of(detectors)
    base, launches, name, computer = _launches(scenario, sigma)
    settings = [_of_kind(base, kind) for kind in kinds]
    with user_input():
        compared = _with_default(settings, base)
        plain = reach.plain(settings, launches.rate)
    asked = reach.Work(hours, trials, cells)
    work = reach.within_reach(
        asked,
        detectors=sum(1 for one in plain for _ in operating.levels(one)),
        compared=len(plain) * len(operating.CELLS),
        rate=launches.rate,
    )
    with folder(out, f"roc-{seed}", overwrite=overwrite) as place:  # before anything is computed in vain
        if left_out := reach.told(asked, work, reach.why(plain)):
            remark(left_out, as_json=as_json)
        elif wait := reach.patience(
            reach.lasts(
                work,
                settings=sum(1 for one in settings for _ in operating.levels(one)),
                compared=len(compared) * len(operating.CELLS),
                rate=launches.rate,
                threads=threads(workers),
            )
        ):
            remark(wait, as_json=as_json)
        with Bar("trying launch detectors") as bar, user_input():
            found = operating.operate(
                settings,
                launches,
                hours=work.hours,
                trials=work.trials,
                seed=seed,
                name=name,
                computer=computer,
                workers=workers,
                progress=lambda share: bar.show((SWEEP if cells else 1.0) * share),
            )
            table = None
            if cells:
                table = operating.compare(
                    compared,
                    trials=work.cells,
                    seed=seed,
                    workers=workers,
                    progress=lambda share: bar.show(SWEEP + (1.0 - SWEEP) * share),
                )
        view.save(found, table, place.folder, plots=not no_plots)
    if as_json:
        document(documents.operating(found, table, place.target))
        return
    tables.print_operating(found)
    if table is not None:
        tables.print_cells(table, DetectorSettings().kind, [kind for kind in kinds if not KINDS[kind].ours])
    terminal.say(f"written to {place.target}")


def _of_kind(base: "DetectorSettings", kind: str) -> "DetectorSettings":
    """The same settings for another kind; options are those of the kind that they were given for."""
    return replace(base, kind=kind, options=base.options if kind == base.kind else None)


def kinds_of(text: str | None) -> list[str]:
    """Kinds of detector from `A,B`; all that are registered without it."""
    from uavsim.onboard.launch import KINDS

    if text is None:
        return list(KINDS)
    kinds = [kind_of(part.strip(), "--detectors") for part in text.split(",")]
    if len(set(kinds)) != len(kinds):
        raise typer.BadParameter(f"{text[:60]!r} names a detector twice", param_hint="--detectors")
    return kinds


def kind_of(name: str, option: str) -> str:
    """Return the name of a kind of detector that is there, or refuse it."""
    from uavsim.plugins import PluginError, find

    try:
        found: str = find("detector", name).name
    except PluginError as error:
        raise typer.BadParameter(f"detector {error}", param_hint=option) from None
    return found


def _launches(source: str | None, sigma: float) -> "tuple[DetectorSettings, Launches, str, FlightComputerSettings]":
    """Return settings to start from, where launches come from, what they are called, and what opens the wings."""
    from uavsim.onboard.flight_computer import FlightComputerSettings
    from uavsim.onboard.launch import DetectorSettings
    from uavsim.studies.signals import LaunchSettings
    from uavsim.studies.trials import Drawn, Flown

    if source is None:
        return (
            DetectorSettings(),
            Drawn(LaunchSettings(sigma_g=sigma)),
            f"launches of 5-15 g, σ {sigma:g} g",
            FlightComputerSettings(),
        )
    scenario = load(source)
    return scenario.detector, Flown(scenario), f"launches of {scenario.name}", scenario.flight_computer


def load(source: str) -> "Scenario":
    """Read a scenario."""
    from uavsim.scenario import load_scenario

    with user_input():
        return load_scenario(source)


def _with_default(settings: "list[DetectorSettings]", base: "DetectorSettings") -> "list[DetectorSettings]":
    """The detectors, and the shipped one to compare with."""
    from uavsim.onboard.launch import DetectorSettings

    own = DetectorSettings()
    return settings if any(s.kind == own.kind for s in settings) else [*settings, own]
