"""The command line: parses, calls, prints. No physics."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.progress import Progress

    from uavsim.flight import Flight
    from uavsim.studies.batch import Batch

DONE, UNEXPECTED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

_UsageError = typer.BadParameter.__mro__[2]  # click's ClickException, wherever this typer keeps its click

Out = Annotated[Path | None, typer.Option("--out", help="Folder to write; made with its parents.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace a folder that is not empty.")]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no plots.")]


@app.callback(invoke_without_command=True)
def uavsim(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
) -> None:
    """Fly a folding-wing UAV from catapult to cruise in JSBSim.

    Launch detector and airspeed estimator are in the loop, everything is scored against the truth.

    Example: uavsim fly catapult --seed 7
    """
    if version:
        from uavsim import __version__  # noqa: PLC0415 (each command loads only what it needs)

        typer.echo(f"uavsim {__version__}")
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def scenarios() -> None:
    """List the packaged scenarios, a line each.

    Example: uavsim scenarios
    """
    from uavsim.scenario import packaged  # noqa: PLC0415 (each command loads only what it needs)

    known = packaged()
    width = max(map(len, known))
    for name, description in known.items():
        typer.echo(f"{name:<{width}}  {description}")


@app.command()
def fly(
    scenario: Annotated[str, typer.Argument(help="A packaged name or a TOML file.")] = "catapult",
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
    from uavsim.scenario import load_scenario  # noqa: PLC0415

    if seed is not None and seeds is not None:
        raise typer.BadParameter("give --seed or --seeds, not both")
    numbers = None if seeds is None else _seeds(seeds)
    loaded = load_scenario(scenario, overrides=settings or (), seed=numbers[0] if numbers else seed)
    target = _target(out, f"{loaded.name}-{seeds or loaded.seed}", overwrite=overwrite)
    if numbers is None:
        _fly_one(loaded, target, plots=not no_plots, overwrite=overwrite)
    else:
        _fly_many(loaded, numbers, target, plots=not no_plots, overwrite=overwrite)


def _fly_one(scenario: Any, target: Path, *, plots: bool, overwrite: bool) -> None:
    from uavsim.cosim import fly as fly_scenario  # noqa: PLC0415
    from uavsim.views import terminal  # noqa: PLC0415

    with _progress() as bar:
        task = bar.add_task(f"flying {scenario.name}, seed {scenario.seed}", total=1.0)
        flight = fly_scenario(scenario, progress=lambda share: bar.update(task, completed=share))
    terminal.print_score(flight)
    flight.save(target, overwrite=overwrite, extra=_plotter(flight) if plots else None)
    typer.echo(f"written to {target}")
    _leave(_as_expected(flight.score))


def _fly_many(scenario: Any, numbers: list[int], target: Path, *, plots: bool, overwrite: bool) -> None:
    from uavsim.studies.batch import fly_seeds  # noqa: PLC0415
    from uavsim.views import batch as view  # noqa: PLC0415
    from uavsim.views import terminal  # noqa: PLC0415

    with _progress() as bar:
        task = bar.add_task(f"flying {scenario.name}", total=len(numbers))
        flown = fly_seeds(scenario, numbers, progress=lambda done, _: bar.update(task, completed=done))
    if not len(flown.runs):
        raise KeyboardInterrupt
    terminal.print_batch(flown)
    view.save(flown, target, overwrite=overwrite, plots=plots)
    typer.echo(f"written to {target}")
    if not flown.complete:
        typer.echo(f"interrupted: {len(flown.runs)} of {len(numbers)} flights are kept", err=True)
        raise typer.Exit(INTERRUPTED)
    _leave(_all_as_expected(flown))


@app.command()
def replay(
    flight: Annotated[Path, typer.Argument(help="A flight's folder.")],
    out: Out = None,
    no_plots: NoPlots = False,
    overwrite: Overwrite = False,
) -> None:
    """Feed a flight's own readings through the same onboard code again.

    Its events and estimate.parquet come out byte for byte.

    Example: uavsim replay output/catapult-1 --out output/again
    """
    from uavsim.cosim import replay as replay_flight  # noqa: PLC0415
    from uavsim.flight import load  # noqa: PLC0415
    from uavsim.views import terminal  # noqa: PLC0415

    target = _target(out, f"{flight.resolve().name}-replay", overwrite=overwrite)
    again = replay_flight(load(flight))
    terminal.print_score(again)
    again.save(target, overwrite=overwrite, extra=_plotter(again) if not no_plots else None)
    typer.echo(f"written to {target}")


@app.command()
def sensors(
    name: Annotated[str | None, typer.Argument(help="A preset; without it all are listed.")] = None,
) -> None:
    """List the sensor presets, or show one with its values, units and sources.

    Example: uavsim sensors bmp390
    """
    from uavsim.views import terminal  # noqa: PLC0415

    if name is None:
        terminal.print_presets()
    else:
        terminal.print_preset(name)


@app.command()
def bench(
    scenario: Annotated[str, typer.Argument(help="A packaged name or a TOML file.")] = "catapult",
) -> None:
    """Measure what a step costs: in the loop, over the same JSBSim with the same truth recorded.

    The last line is `ratio X.XX`. Example: uavsim bench
    """
    from uavsim.scenario import load_scenario  # noqa: PLC0415
    from uavsim.studies.cost import measure  # noqa: PLC0415
    from uavsim.views import terminal  # noqa: PLC0415

    loaded = load_scenario(scenario)
    with _progress() as bar:
        task = bar.add_task("measuring", total=1.0)
        cost = measure(loaded, progress=lambda share: bar.update(task, completed=share))
    terminal.print_cost(cost)


# -- parts -----------------------------------------------------------------------------------------------------------


def _seeds(text: str) -> list[int]:
    """Seeds from `1-50` or `1,5,9-12`."""
    numbers: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not first.isdigit() or (dash and not last.isdigit()) or (dash and int(last) < int(first)):
            raise typer.BadParameter(f"{text!r}: give seeds as 1-50 or 1,5,9", param_hint="--seeds")
        numbers += range(int(first), int(last or first) + 1)
    if len(set(numbers)) != len(numbers):
        raise typer.BadParameter(f"{text!r} names a seed twice", param_hint="--seeds")
    return numbers


def _target(out: Path | None, name: str, *, overwrite: bool) -> Path:
    """Folder to write: the one asked for, or a free one below `output/`."""
    from uavsim.flight import claim  # noqa: PLC0415

    if out is not None:
        claim(out, overwrite=overwrite)
        return out
    candidate, number = Path("output") / name, 1
    while candidate.exists() and (not candidate.is_dir() or any(candidate.iterdir())):
        number += 1
        candidate = Path("output") / f"{name}-{number}"
    claim(candidate, overwrite=False)
    return candidate


def _plotter(flight: "Flight") -> Callable[[Path], None]:
    def draw(folder: Path) -> None:
        from uavsim.views.plots import save_plots  # noqa: PLC0415 (matplotlib takes its time)

        save_plots(flight, folder / "plots")

    return draw


def _progress() -> "Progress":
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)


def _as_expected(score: dict[str, Any]) -> bool:
    return score["outcome"] == score["expected"] and all(r["met"] for r in score["requirements"])


def _all_as_expected(flown: "Batch") -> bool:
    return bool((flown.runs["outcome"] == flown.runs["expected"]).all() and flown.runs["requirements.met"].all())


def _leave(as_expected: bool) -> None:
    if not as_expected:
        raise typer.Exit(UNEXPECTED)


def main() -> None:
    """Run the command line; every error of the user's is one line on standard error and status 2."""
    try:
        status = app(standalone_mode=False)
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    except _UsageError as error:
        status = _complain(error.format_message())  # type: ignore[attr-defined]  # the class is known at run time only
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = DONE
    except (ValueError, OSError) as error:
        status = _complain(str(error))
    sys.exit(status if isinstance(status, int) else DONE)


def _complain(message: str) -> int:
    typer.echo("Error: " + " ".join(message.split()), err=True)
    return WRONG_INPUT


if __name__ == "__main__":
    main()
