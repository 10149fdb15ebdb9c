"""What the commands share: the application, its options, progress, the folder to write and how a run ends."""

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from math import isfinite
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from uavsim.folders import SCRATCH, Place, TakenError, holds_flights
from uavsim.views.text import message

if TYPE_CHECKING:
    from rich.progress import Progress

    from uavsim.flight import Flight

DONE, UNEXPECTED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

PATIENCE = 1.0  # s without a progress bar
LARGEST_SEED = 2**63 - 1

Out = Annotated[Path | None, typer.Option("--out", help="Folder to write; made with its parents.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what --out holds of ours.")]
Plugin = Annotated[
    list[str] | None,
    typer.Option("--plugin", metavar="FILE.py|MODULE", help="Detectors, estimators, plants of one's own; may repeat."),
]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no plots.")]


class WrongInputError(Exception):
    """Something that the user gave and that cannot be; one line."""


def finite(number: float | None) -> float | None:
    """Refuse a number of an option that is none or infinite: both pass any test for being too large."""
    if number is not None and not isfinite(number):
        raise typer.BadParameter(f"{number} is not a finite number")
    return number


class Interrupted(Exception):  # noqa: N818 (nothing is wrong)
    """Somebody wants to end; what became of the work, if there is something to say."""


def told(error: OSError) -> str:
    """One line: what, and where."""
    named = error.filename is not None and error.strerror is not None
    return f"{error.filename}: {error.strerror}" if named else str(error)


@contextmanager
def user_input(where: str = "") -> Iterator[None]:
    """Count a ValueError of what reads or checks input as the user's; any other is a bug of ours and shows itself."""
    try:
        yield
    except ValueError as error:
        raise WrongInputError(f"{where}{error}") from error


def plug_in(names: list[str] | None) -> None:
    """Import what `--plugin` names."""
    if names:
        from uavsim.plugins import load

        with user_input():
            load(names)


@contextmanager
def folder(out: Path | None, name: str, *, overwrite: bool, kind: Callable[..., Place] = Place) -> Iterator[Place]:
    """Hold the folder to write to the end of the block: the one asked for, or a free one below `output/`."""
    place = _free(name, kind) if out is None else kind(out, overwrite=overwrite).claim()
    try:
        with place, _scratch_in(place.folder / SCRATCH), _matplotlib_in(place.folder / SCRATCH):
            yield place
    except KeyboardInterrupt:
        raise Interrupted(_kept(place) or "nothing is written") from None
    except OSError as error:
        kept = _kept(place)
        if not kept:
            raise
        raise OSError(f"{told(error)}; {kept}") from error


def _kept(place: Place) -> str:
    """Where finished flights are that could not take their place."""
    return f"finished flights are in {place.folder}" if holds_flights(place.folder) else ""


@contextmanager
def _scratch_in(scratch: Path) -> Iterator[None]:
    """Keep what is written in passing, such as an aircraft laid out for JSBSim, in a folder that vanishes.

    The processes that are started here do the same.
    """
    before = os.environ.get("TMPDIR"), tempfile.tempdir
    scratch.mkdir(exist_ok=True)
    os.environ["TMPDIR"] = tempfile.tempdir = str(scratch)
    try:
        yield
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
        shared, tempfile.tempdir = before
        if shared is None:
            del os.environ["TMPDIR"]
        else:
            os.environ["TMPDIR"] = shared


@contextmanager
def _matplotlib_in(scratch: Path) -> Iterator[None]:
    """Where matplotlib cannot write what it keeps for the next run, give it a folder that vanishes with this one."""
    homes = {"XDG_CONFIG_HOME": "~/.config", "XDG_CACHE_HOME": "~/.cache"}
    kept = (Path(os.environ.get(name) or os.path.expanduser(home)) / "matplotlib" for name, home in homes.items())
    if "MPLCONFIGDIR" in os.environ or all(map(_may_write, kept)):
        yield
        return
    os.environ["MPLCONFIGDIR"] = str(scratch)
    try:
        yield
    finally:
        del os.environ["MPLCONFIGDIR"]


def _may_write(folder: Path) -> bool:
    """Whether files can be made in a folder that may have to be made, too."""
    there = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    return there.is_dir() and os.access(there, os.W_OK | os.X_OK)


def _free(name: str, kind: Callable[..., Place]) -> Place:
    """The first place of this name, or with a number, that nobody has."""
    for number in count(1):
        place = kind(Path("output") / (name if number == 1 else f"{name}-{number}"))
        with suppress(TakenError):
            return place.claim()
    raise AssertionError


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
            with suppress(OSError):  # the terminal may have been closed
                self._progress.stop()

    def show(self, share: float) -> None:
        """Show that `share`, 0 … 1, is done."""
        if (
            self._progress is None
            and sys.stderr is not None
            and sys.stderr.isatty()
            and monotonic() - self._since > PATIENCE
        ):
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
