"""What the commands share: the application, its options, progress, the folder to write and how a run ends."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from uavsim.views.text import message

if TYPE_CHECKING:
    from rich.progress import Progress

    from uavsim.flight import Flight

DONE, UNEXPECTED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

PATIENCE = 1.0  # s without a progress bar
LARGEST_SEED = 2**63 - 1

Out = Annotated[Path | None, typer.Option("--out", help="Folder to write; made with its parents.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what --out holds of ours.")]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no plots.")]


class WrongInputError(Exception):
    """Something that the user gave and that cannot be; one line."""


def finite(number: float | None) -> float | None:
    """Refuse a number of an option that is none or infinite: both pass any test for being too large."""
    if number is not None and not isfinite(number):
        raise typer.BadParameter(f"{number} is not a finite number")
    return number


@contextmanager
def user_input(where: str = "") -> Iterator[None]:
    """Count a ValueError of what reads or checks input as the user's; any other is a bug of ours and shows itself."""
    try:
        yield
    except ValueError as error:
        raise WrongInputError(f"{where}{error}") from error


def folder(out: Path | None, name: str, *, overwrite: bool) -> Path:
    """Folder to write: the one asked for, or a free one below `output/`."""
    from uavsim.flight import claim

    target, number = out or Path("output") / name, 1
    while out is None and target.exists() and (not target.is_dir() or any(target.iterdir())):
        number += 1
        target = Path("output") / f"{name}-{number}"
    claim(target, overwrite=overwrite)
    return target


def plotter(flight: "Flight") -> Callable[[Path], None]:
    """What draws a flight's plots into its folder."""

    def draw(folder: Path) -> None:
        from uavsim.views.plots import save_plots

        save_plots(flight, folder / "plots")

    return draw


class Bar:
    """A progress bar on standard error, for what takes longer than a second and is watched on a terminal."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._since = monotonic()
        self._progress: Progress | None = None

    def __enter__(self) -> "Bar":
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

        what = TextColumn("{task.description}", markup=False)
        columns = (what, BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        progress = Progress(*columns, console=Console(stderr=True), transient=True)
        progress.add_task(message(self._what, 60), total=1.0)
        progress.start()
        return progress


def as_expected(score: dict[str, Any]) -> bool:
    """Whether a flight ended as its scenario expects and met its requirements."""
    return score["outcome"] == score["expected"] and all(r["met"] for r in score["requirements"])


def leave(well: bool) -> None:
    """End the program with status 1 unless all was as expected."""
    if not well:
        raise typer.Exit(UNEXPECTED)
