"""The command line: parses, calls, prints. No physics."""

import io
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.progress import Progress

    from uavsim.cosim import Cosimulation
    from uavsim.flight import Flight
    from uavsim.scenario import Scenario
    from uavsim.studies.batch import Batch

DONE, UNEXPECTED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

PATIENCE = 1.0  # s without a progress bar
MOST_FLIGHTS = 100_000
LARGEST_SEED = 2**63 - 1

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

# click's ClickException, wherever this typer keeps its click
_UsageError: type[Exception] = typer.BadParameter.__mro__[2]

Out = Annotated[Path | None, typer.Option("--out", help="Folder to write; made with its parents.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what --out holds of ours.")]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no plots.")]


class _WrongInputError(Exception):
    """Something that the user gave and that cannot be; one line."""


@contextmanager
def _input(where: str = "") -> Iterator[None]:
    """Count a ValueError of what reads or checks input as the user's; any other is a bug of ours and shows itself."""
    try:
        yield
    except ValueError as error:
        raise _WrongInputError(f"{where}{error}") from error


@app.callback(invoke_without_command=True)
def uavsim(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
) -> None:
    """Fly a folding-wing UAV from catapult to cruise in JSBSim.

    Launch detector and airspeed estimator are in the loop, everything is scored against the truth.

    \b
    Examples:
      uavsim scenarios
      uavsim fly catapult --seed 7
      uavsim fly gusty --seeds 1-50 --out output/gusty-50
      uavsim replay output/catapult-7
      uavsim replay imu.csv --map t=time,fx=ax,fy=ay,fz=az
      uavsim sensors bmp390
      uavsim bench
    """  # noqa: D301 (click reads \b: keep these lines)
    if version:
        from uavsim import __version__

        typer.echo(f"uavsim {__version__}")
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def scenarios() -> None:
    """List the packaged scenarios, a line each.

    Example: uavsim scenarios
    """
    from uavsim.scenario import packaged

    known = packaged()
    width = max(map(len, known))
    for name, description in known.items():
        typer.echo(f"{name:<{width}}  {description}")


@app.command()
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
    numbers = [] if seeds is None else _seeds(seeds)
    with _input():
        loaded = load_scenario(scenario, overrides=settings or (), seed=numbers[0] if numbers else seed)

    def place() -> Path:
        return _place(out, f"{loaded.name}-{_named(numbers) or loaded.seed}", overwrite=overwrite)

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
    with _input(f"{where}: "):
        return Cosimulation(scenario)


def _fly_one(simulation: "Cosimulation", place: Callable[[], Path], *, plots: bool, overwrite: bool) -> None:
    from uavsim.cosim import CHUNK
    from uavsim.views import terminal

    with _Bar(f"flying {simulation.scenario.name}, seed {simulation.scenario.seed}") as bar:
        while not simulation.ended:
            simulation.advance(CHUNK)
            bar.show(simulation.plant.k / simulation.steps)
    flight = simulation.finish()
    written = flight.save(place(), overwrite=overwrite, extra=_plotter(flight) if plots else None)
    terminal.print_score(flight)
    terminal.say(f"written to {written}")
    _leave(_as_expected(flight.score))


def _fly_many(
    scenario: "Scenario", numbers: list[int], place: Callable[[], Path], *, plots: bool, overwrite: bool
) -> None:
    from uavsim.studies.batch import fly_seeds
    from uavsim.views import batch as view
    from uavsim.views import terminal

    with _Bar(f"flying {scenario.name}") as bar:
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
    _leave(_all_as_expected(flown))


@app.command()
def replay(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="A flight's folder, or a log of any files.")],
    *,
    mapping: Annotated[
        str | None, typer.Option("--map", metavar="OURS=THEIRS,...", help="A log's columns, as t=time,fx=-Ay*9.80665.")
    ] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="For a log: a key of the detector.")
    ] = None,
    out: Out = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
) -> None:
    """Run the onboard code over a flight's readings or a log.

    A flight's events and estimate.parquet come out byte for byte. A log is CSV, Parquet, PX4 ULog or ArduPilot
    DataFlash: the launch detector runs over it, and what it finds is told by the log's own time.

    Example: uavsim replay output/catapult-1 --out output/again

    Example: uavsim replay imu.csv --map t=time,fx=ax,fy=ay,fz=az --set detector.threshold=20
    """
    if len(logs) == 1 and _is_flight(logs[0]):
        if mapping is not None or settings:
            option = "--map" if mapping is not None else "--set"
            raise typer.BadParameter(f"is for logs, and {logs[0]} is a flight's folder", param_hint=option)
        _replay_flight(logs[0], out, plots=not no_plots, overwrite=overwrite)
    else:
        _replay_log(logs, mapping, settings or [], out, plots=not no_plots, overwrite=overwrite)


def _is_flight(path: Path) -> bool:
    """Tell a flight's folder, which may not be there, from a log."""
    return path.is_dir() or not (path.exists() or path.suffix)


def _replay_flight(flight: Path, out: Path | None, *, plots: bool, overwrite: bool) -> None:
    from uavsim.cosim import replay as replay_flight
    from uavsim.flight import load
    from uavsim.scenario import Scenario
    from uavsim.views import terminal

    name = f"{flight.resolve().name}-replay"
    with _input():
        recorded = load(flight)
        Scenario.from_dict(recorded.scenario, str(flight / "scenario.toml"))
        missing = [table for table in ("accelerometer", "air_data", "truth") if table not in recorded.tables]
        if missing:
            raise ValueError(f"{flight} cannot be replayed: {missing[0]}.parquet is missing")
    _place(out, name, overwrite=overwrite)
    again = replay_flight(recorded)
    target = _place(out, name, overwrite=overwrite)
    written = again.save(target, overwrite=overwrite, extra=_plotter(again) if plots else None)
    terminal.print_score(again)
    terminal.say(f"written to {written}")


def _replay_log(
    logs: list[Path], mapping: str | None, settings: list[str], out: Path | None, *, plots: bool, overwrite: bool
) -> None:
    from uavsim.logs import read_log, replay_log
    from uavsim.scenario import load_scenario
    from uavsim.views import recording as view
    from uavsim.views import terminal

    other = [given for given in settings if not given.strip().startswith("detector.")]
    if other:
        raise typer.BadParameter(f"{other[0]!r}: of a log only detector.… can be set", param_hint="--set")
    with _input():
        detector = load_scenario("catapult", overrides=settings).detector if settings else None
        recording = read_log(logs, mapping)

    def place() -> Path:
        return _place(out, f"{logs[0].stem}-replay", overwrite=overwrite)

    def draw(folder: Path) -> None:
        view.save_plot(replayed, folder / "plots")

    place()
    with _input(f"{logs[0]}: "):  # a detector may not fit the log's rate
        replayed = replay_log(recording, detector)
    written = replayed.save(place(), overwrite=overwrite, extra=draw if plots else None)
    for line in view.lines(replayed):
        terminal.say(line)
    terminal.say(f"written to {written}")


@app.command()
def sensors(
    name: Annotated[
        str | None, typer.Argument(help="A preset or your own TOML file; without it all are listed.")
    ] = None,
    *,
    hours: Annotated[float, typer.Option(help="Length of the simulated record, h.")] = 3.0,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Draws the unit and its noise.")] = 1,
    unit: Annotated[str, typer.Option(help="Which unit: random, typical or ideal.")] = "random",
    range_g: Annotated[float | None, typer.Option("--range-g", help="An accelerometer's range, g.")] = None,
    rate: Annotated[float | None, typer.Option(help="An accelerometer's output rate, Hz.")] = None,
    low_pass: Annotated[str | None, typer.Option("--filter", help="An accelerometer's low-pass.")] = None,
    mode: Annotated[str | None, typer.Option(help="A pressure sensor's oversampling.")] = None,
    iir: Annotated[int | None, typer.Option(help="A pressure sensor's filter coefficient.")] = None,
    noise_scale: Annotated[float, typer.Option(help="Factor on the white noise.")] = 1.0,
    compare: Annotated[Path | None, typer.Option(help="Your bench log, CSV, SI: t and fx,fy,fz or pressure.")] = None,
    mapping: Annotated[
        str | None, typer.Option("--map", metavar="OURS=THEIRS,...", help="Your columns, as t=time,fx=ax*9.80665.")
    ] = None,
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
) -> None:
    """List the sensor presets, or put one on a bench.

    Prints a part with its sources, simulates hours of it at rest, and draws Allan deviation, density and histogram over
    what the datasheet promises, with your own bench log beside it.

    Example: uavsim sensors bmp390

    Example: uavsim sensors adxl345 --hours 1 --compare log.csv --map t=time,fx=ax,fy=ay,fz=az
    """
    from uavsim.views import datasheets, terminal

    if name is None:
        if compare is not None:
            raise typer.BadParameter(
                "name the part to compare with, as in uavsim sensors bmp390", param_hint="--compare"
            )
        datasheets.print_presets()
        return
    from sensors.bench import UNITS, on_bench
    from sensors.choice import choose
    from uavsim.studies.bench import check_hours, put_on_bench, read_log
    from uavsim.views.characterisation import save_bench

    if mapping is not None and compare is None:
        raise typer.BadParameter("names columns of a log: give --compare, too", param_hint="--map")
    with _input():
        part = on_bench(name, range_g=range_g, rate=rate, filter=low_pass, mode=mode, iir=iir, noise_scale=noise_scale)
        which = UNITS[UNITS.index(choose("--unit", unit, UNITS))]
    with _input("--hours: "):
        check_hours(part, hours)
    with _input("--compare: "):
        log = None if compare is None else read_log(compare, part, mapping)

    def place() -> Path:
        return _place(out, f"sensors-{part.name}", overwrite=overwrite)

    place()
    datasheets.print_preset(name)
    with _Bar(f"simulating {hours:g} h") as bar:
        measured = put_on_bench(part, hours=hours, seed=seed, unit=which, log=log, progress=bar.show)
    written = place()
    save_bench(measured, written, overwrite=overwrite, plots=not no_plots)
    datasheets.print_bench(measured)
    terminal.say(f"written to {written}")


@app.command()
def bench(
    scenario: Annotated[str, typer.Argument(help="A packaged name or a TOML file.")] = "catapult",
) -> None:
    """Measure what a step in the loop costs, over bare JSBSim.

    That is over the same JSBSim stepped from Python with the same truth recorded. The last line is `ratio X.XX`.

    Example: uavsim bench
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.cost import measure
    from uavsim.views import terminal

    with _input(), _Bar("measuring") as bar:
        cost = measure(load_scenario(scenario), progress=bar.show)
    terminal.print_cost(cost)


# -- parts -----------------------------------------------------------------------------------------------------------


def _seeds(text: str) -> list[int]:
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


def _named(numbers: list[int]) -> str:
    """Name several seeds in a folder's name."""
    if len(numbers) > 1 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]}-{numbers[-1]}"
    listed = ",".join(map(str, numbers))
    return listed if len(listed) <= 40 else f"{len(numbers)}-seeds"


def _place(out: Path | None, name: str, *, overwrite: bool) -> Path:
    """Folder to write: the one asked for, or a free one below `output/`."""
    from uavsim.flight import claim

    target, number = out or Path("output") / name, 1
    while out is None and target.exists() and (not target.is_dir() or any(target.iterdir())):
        number += 1
        target = Path("output") / f"{name}-{number}"
    claim(target, overwrite=overwrite)
    return target


def _plotter(flight: "Flight") -> Callable[[Path], None]:
    def draw(folder: Path) -> None:
        from uavsim.views.plots import save_plots

        save_plots(flight, folder / "plots")

    return draw


class _Bar:
    """A progress bar on standard error, for what takes longer than a second and is watched on a terminal."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._since = monotonic()
        self._progress: Progress | None = None

    def __enter__(self) -> "_Bar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def show(self, share: float) -> None:
        """Show that `share`, 0 … 1, is done."""
        if self._progress is None and sys.stderr.isatty() and monotonic() - self._since > PATIENCE:
            self._progress = self._start()
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], completed=share)

    def _start(self) -> "Progress":
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        progress = Progress(*columns, console=Console(stderr=True), transient=True)
        progress.add_task(self._what, total=1.0)
        progress.start()
        return progress


def _as_expected(score: dict[str, Any]) -> bool:
    return score["outcome"] == score["expected"] and all(r["met"] for r in score["requirements"])


def _all_as_expected(flown: "Batch") -> bool:
    return bool((flown.runs["outcome"] == flown.runs["expected"]).all() and flown.runs["requirements.met"].all())


def _leave(as_expected: bool) -> None:
    if not as_expected:
        raise typer.Exit(UNEXPECTED)


def main() -> None:
    """Run the command line; every error of the user's is one line on standard error and status 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without Greek is no reason to fail
    try:
        status = app(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    except _UsageError as error:
        status = _complain(error.format_message())  # type: ignore[attr-defined]  # the class is known at run time only
    except (BrokenPipeError, SystemExit):  # the reader of our output left; click ends the program at that
        from uavsim.views.terminal import mute

        mute()
        status = DONE
    except (_WrongInputError, OSError) as error:
        status = _complain(str(error))
    sys.exit(status if isinstance(status, int) else DONE)


def _complain(message: str) -> int:
    typer.echo("Error: " + " ".join(message.split()), err=True)
    return WRONG_INPUT


if __name__ == "__main__":
    main()
