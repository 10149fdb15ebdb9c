"""`uavsim linearise`: trim, derivatives and modes of an aircraft."""

import re
from typing import Annotated

import typer

from uavsim.cli.common import Bar, NoPlots, Out, Overwrite, folder, user_input


def linearise(
    aircraft: Annotated[str, typer.Argument(metavar="AIRCRAFT", help="A packaged name, or an aircraft's folder.")],
    *,
    airspeeds: Annotated[
        str | None, typer.Option(metavar="A,B,…", help="m/s; without, 1.2 to 3 times the speed of stall.")
    ] = None,
    wings: Annotated[
        str | None, typer.Option(metavar="A,B,…", help="Positions, 0 folded … 1 out; without, five.")
    ] = None,
    pitch: Annotated[
        str | None, typer.Option(metavar="NAME,…", help="Properties that pitch it, rad; without, they are found.")
    ] = None,
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
) -> None:
    """Trim, derivatives and modes over airspeed and wing position.

    Flies the aircraft in JSBSim with its controls fixed and writes a table, its modes and a plot. All that a folder
    lacks for flying is named in one line.

    Example: uavsim linearise fw8 --out output/fw8-linear

    Example: uavsim linearise my/c172x --airspeeds 30,40,50
    """
    from uavsim.plants.hangar import find_airframe
    from uavsim.studies.linearise import WINGS
    from uavsim.studies.linearise import linearise as study
    from uavsim.views import linearised as view
    from uavsim.views import terminal

    with user_input():
        speeds = _numbers("--airspeeds", airspeeds, 0.1, 1000.0)
        positions = _numbers("--wings", wings, 0.0, 1.0) or WINGS
        names = tuple(name.strip() for name in pitch.split(",")) if pitch else ()
        airframe = find_airframe(aircraft)
    name = f"linearise-{re.sub(r'[^A-Za-z0-9_-]+', '-', airframe.name)}"
    with folder(out, name, overwrite=overwrite) as place, user_input():
        with Bar(f"linearising {airframe.name}") as bar:
            found = study(airframe, speeds, positions, names, bar.show)
        view.save(found, place.folder, plots=not no_plots)
    for line in view.lines(found):
        terminal.say(line)
    terminal.say(f"written to {place.target}")


def _numbers(option: str, text: str | None, least: float, greatest: float) -> tuple[float, ...]:
    """Numbers of a list, each within its bounds."""
    found = []
    for word in text.split(",") if text else ():
        try:
            value = float(word)
        except ValueError:
            value = float("nan")
        if not least <= value <= greatest:
            raise ValueError(f"{option}: {word.strip()!r} is no number from {least:g} to {greatest:g}")
        found.append(value)
    return tuple(found)
