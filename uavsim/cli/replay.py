"""`uavsim replay`: the onboard code over a flight's readings or somebody's log."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uavsim.cli.common import NoPlots, Out, Overwrite, Plugin, folder, plotter, plug_in, user_input
from uavsim.cli.printed import Json, document

if TYPE_CHECKING:
    from uavsim.flight import Flight
    from uavsim.logs import Recording


def replay(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="A flight's folder, or a log of any files.")],
    *,
    mapping: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="OURS=THEIRS,...", help="A log's columns, as t=time,fx=-Ay*9.80665; may repeat."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="For a log: a key of detector, estimator, parts."),
    ] = None,
    noise: Annotated[
        str | None, typer.Option("--noise", metavar="NAME=SD,...", help="Of a log's reading, as p_total=2.4,fx=0.5.")
    ] = None,
    all_launches: Annotated[
        bool, typer.Option("--all-launches", help="Cut a log into its flights, and replay each by itself.")
    ] = False,
    out: Out = None,
    plugin: Plugin = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Run the onboard code over a flight's readings or a log.

    A flight's events and estimate.parquet come out byte for byte. A log is CSV, Parquet, PX4 ULog or ArduPilot
    DataFlash: the launch detector runs over it, and what it finds is told by the log's own time.

    Example: uavsim replay output/catapult-1 --out output/again

    Example: uavsim replay imu.csv --map t=time,fx=ax,fy=ay,fz=az --set detector.kind=inav
    """
    plug_in(plugin)
    if len(logs) == 1 and _is_flight(logs[0]):
        if mapping is not None or settings or noise is not None or all_launches:
            given = {"--map": mapping is not None, "--set": bool(settings), "--noise": noise is not None}
            option = next((name for name, there in given.items() if there), "--all-launches")
            raise typer.BadParameter(f"is for logs, and {logs[0]} is a flight's folder", param_hint=option)
        _replay_flight(logs[0], out, plots=not no_plots, overwrite=overwrite, as_json=as_json)
    else:
        _replay_log(
            logs,
            ",".join(mapping) if mapping else None,
            settings or [],
            noise,
            out,
            all_launches=all_launches,
            plots=not no_plots,
            overwrite=overwrite,
            as_json=as_json,
        )


def _is_flight(path: Path) -> bool:
    """Tell a flight's folder, which may not be there, from a log."""
    return path.is_dir() or not (path.exists() or path.suffix)


def _replay_flight(flight: Path, out: Path | None, *, plots: bool, overwrite: bool, as_json: bool) -> None:
    from uavsim.cosim import check_units
    from uavsim.cosim import replay as replay_flight
    from uavsim.flight import UNITS, load
    from uavsim.scenario import Scenario
    from uavsim.views import documents, terminal

    name = f"{Path(os.path.realpath(flight)).name}-replay"  # of what a link leads to, unless it leads in circles
    with user_input():
        if (flight / "campaign.json").is_file():
            raise ValueError(f"{flight} holds several flights: give one of the folders in {flight / 'flights'}")
        recorded = load(flight)
        if "recording" in recorded.scenario:
            raise ValueError(f"{flight} is the replay of a log: replay the log itself")
        scenario = Scenario.from_dict(recorded.scenario, str(flight / "scenario.toml"))
        missing = [table for table in UNITS if table not in recorded.tables]
        if missing:
            raise ValueError(f"{flight} cannot be replayed: {missing[0]}.parquet is missing")
        check_units(recorded, scenario)
    with folder(out, name, overwrite=overwrite) as place:  # before anything is replayed in vain
        again = replay_flight(recorded)
        again.write(place.folder, plotter(again) if plots else None)
    if as_json:
        document(documents.flight(again, place.target))
    else:
        terminal.print_score(again)
        terminal.say(f"written to {place.target}")


def _replay_log(
    logs: list[Path],
    mapping: str | None,
    settings: list[str],
    noise: str | None,
    out: Path | None,
    *,
    all_launches: bool,
    plots: bool,
    overwrite: bool,
    as_json: bool,
) -> None:
    from uavsim.cli.replay_in_lots import in_lots
    from uavsim.logs import is_long, read_log, replay_log
    from uavsim.logs.aired import with_airspeed
    from uavsim.logs.airspeed import air_settings
    from uavsim.studies.low_rates import remark
    from uavsim.views import documents, terminal
    from uavsim.views import log as view

    with user_input():
        air = air_settings(settings, noise)
        in_parts = all_launches or is_long(logs)
        recording = None if in_parts else read_log(logs, mapping)
    detector = air.scenario.detector
    is_set = any(given.strip().startswith("detector.") for given in settings)

    def made(recording: "Recording") -> "Flight":
        flight = replay_log(recording, detector)
        if is_set and (said := remark(detector, recording.rate)):
            flight.score["recording"]["remarks"].append(said)
        return with_airspeed(flight, recording, air)

    def draw(folder: Path) -> None:
        view.save_plot(replayed, folder / "plots")

    with folder(out, f"{logs[0].stem}-replay", overwrite=overwrite) as place:
        with user_input(f"{logs[0]}: " if recording else ""):  # a detector may not fit the log's rate
            if recording is None:
                replayed = in_lots(logs, mapping, detector, made, place.folder, all_launches=all_launches, plots=plots)
            else:
                replayed = made(recording)
        if recording is not None:
            replayed.write(place.folder, draw if plots else None)
    if as_json:
        document(documents.flight(replayed, place.target))
        return
    for line in view.lines(replayed):
        terminal.say(line)
    terminal.say(f"written to {place.target}")
