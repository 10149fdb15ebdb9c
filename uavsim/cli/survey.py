"""`uavsim survey`: where to mount the air-data head."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import LARGEST_SEED, Bar, NoPlots, Out, Overwrite, folder, user_input

if TYPE_CHECKING:
    from uavsim.studies.survey import Envelope


def survey(
    aircraft: Annotated[
        str, typer.Argument(metavar="AIRCRAFT", help="A packaged name, or a folder with geometry.toml.")
    ],
    *,
    flights: Annotated[
        list[Path] | None,
        typer.Option("--flights", metavar="DIR", help="A flight's folder or a campaign's; may be given again."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Of the flights flown without --flights.")] = 1,
    sections: Annotated[str, typer.Option(help="Speed along the wing: auto, neuralfoil or panels.")] = "auto",
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
) -> None:
    """Find where to mount the air-data head.

    Computes the surface pressure at candidate places over the angles and Mach numbers that flights visit, ranks the
    places by airspeed error, and writes the position error as a scenario, tables and a map. Without --flights it flies
    catapult and gusty.

    Example: uavsim survey fw8 --out output/survey

    Example: uavsim survey fw8 --flights output/gusty-1-50 --sections panels
    """
    from sensors.choice import choose
    from uavsim.studies.survey import check_envelope, choose_source, read_outline
    from uavsim.studies.survey import survey as study
    from uavsim.studies.survey.edge import SOURCES
    from uavsim.views import survey as view
    from uavsim.views import terminal

    with user_input():
        outline = read_outline(aircraft)
        source = choose_source(SOURCES[SOURCES.index(choose("--sections", sections, SOURCES))])

    name = f"survey-{re.sub(r'[^A-Za-z0-9_-]+', '-', outline.name)}"
    with folder(out, name, overwrite=overwrite) as place:  # before anything is computed in vain
        envelope = _envelope(aircraft, flights or [], seed)
        with user_input("--flights: "):
            check_envelope(envelope)
        with Bar(f"surveying {outline.name}") as bar:
            found = study(outline, envelope, source, progress=bar.show)
        view.save(found, place.folder, plots=not no_plots)
    for line in view.lines(found):
        terminal.say(line)
    terminal.say(f"written to {place.target}")


def _envelope(aircraft: str, flights: list[Path], seed: int) -> "Envelope":
    """Envelope of the flights given, or of two that are flown with the aircraft, or with fw8 if it has no model."""
    from uavsim.studies.survey import fly_envelope, load_envelope, model_of

    if flights:
        with user_input("--flights: "):
            return load_envelope(flights)
    with Bar("flying") as bar, user_input(f"{aircraft}: "):
        return fly_envelope(seed, model=model_of(aircraft), progress=bar.show)
