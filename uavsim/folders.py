"""Folders that are whole or not there, each written by one process at a time.

A place is claimed before anything is computed for it. From then on a folder `NAME.unfinished` beside the target (in it,
where it exists: it may be a mounted one that nobody can rename) belongs to this process, by a lock that the system
takes away however the process ends. Everything is written there and takes the target's place when it is whole.

What a killed process leaves is such a folder that nobody holds. The next one that claims the place clears it, unless
flights were finished in it: those are only replaced when that is asked for, as for those of the target.
"""

import os
import shutil
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from types import TracebackType

from uavsim.files import reason
from uavsim.interrupts import Interrupts
from uavsim.locks import lock

OURS = frozenset({
    *("truth.parquet", "accelerometer.parquet", "air_data.parquet", "estimate.parquet", "detector.parquet"),
    *("scenario.toml", "score.json", "events.json", "campaign.json", "report.html", "plots", "flights", "runs.parquet"),
    *("inputs", "traces", "sweep.json", "sensitivity.json", "verify.json", "junit.xml", "rare.json", ".keeping"),
    *("budget.json", "budget.png"),
})  # fmt: skip
"""What is in the folders of flights, campaigns and budgets, and so is replaced when one is written again."""

UNFINISHED = ".unfinished"
LOCK, OLD, STALE = ".lock", ".old", ".stale"
SCRATCH = ".scratch"
"""Folder in an unfinished one for what a run needs and does not give; it may be made there."""
FLOWN = ("score.json", "runs.parquet")
"""What is written of a flight, or of several, when it is finished."""
ATTEMPTS = 100  # to take a folder that others are just removing


class TakenError(FileExistsError):
    """Something is at the target already, or another process is writing there; one line."""


class Place:
    """A target that this process alone writes, from the claim to the end of the block.

    Parameters
    ----------
    target
        Made with its parents; an empty folder counts as none. A link stays, and leads to what is written.
    overwrite
        Into a folder that is not empty: replace what a flight or a campaign left there; other files stay.

    Attributes
    ----------
    target : Path
        As it was given.
    folder : Path
        Where to write. When the block ends well it becomes `target`, by one rename if that is new. If not, it vanishes
        with the parents that were made for it, unless it holds finished flights.

    Raises
    ------
    OSError
        By the claim: there is something already, or another process is writing there (TakenError), or it cannot be
        written. Nothing is left.
    """

    def __init__(self, target: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        self.target = Path(target)
        self._real = Path(os.path.realpath(target))
        self._overwrite = overwrite
        self.folder = self._real.parent / self._name
        self._made: list[Path] = []
        self._file: int | None = None

    def __enter__(self) -> "Place":
        return self.claim() if self._file is None else self

    def claim(self) -> "Place":
        """Take the place."""
        try:
            with Interrupts():
                self._refuse()  # before anything is made
                self._take()
                self._refuse()  # whoever had it may have finished in between
                self._clear()
        except BaseException as error:
            self._give_up()
            if isinstance(error, OSError) and not isinstance(error, TakenError):
                raise OSError(f"{self.target} cannot be written: {reason(error)}") from None
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        with suppress(KeyboardInterrupt), Interrupts():  # it is too late to be interrupted, or it is already
            try:
                if kind is None:
                    self._refuse()
                    for name in (STALE, SCRATCH):
                        shutil.rmtree(self.folder / name, ignore_errors=True)
                    self._settle()
            finally:
                self._give_up()

    def _refuse(self) -> None:
        """Raise TakenError if what is there may not be replaced."""
        if os.path.lexists(self._real) and not self._real.is_dir():
            raise TakenError(f"{self.target} is a file, not a folder")
        if not self._overwrite and self._real.is_dir() and any(e.name != self._name for e in self._real.iterdir()):
            raise TakenError(f"{self.target} is not empty; choose another folder or give --overwrite")

    @property
    def _name(self) -> str:
        return f"{self._real.name}{UNFINISHED}"

    def _home(self) -> Path:
        """Folder to write in that is on the same file system as the target."""
        return self._real if self._real.is_dir() else self._real.parent

    def _take(self) -> None:
        home = self._home()
        self._made = [parent for parent in (home, *home.parents) if not parent.exists()]
        self.folder = home / self._name
        self._file = _hold(self.folder)
        beside = self._real.parent / self._name  # of one that began before the target was made
        if self._file is None or (beside != self.folder and _is_held(beside)):
            raise TakenError(f"{self.target} is being written by another process, in {self.folder}")

    def _clear(self) -> None:
        """Empty what a dead process left; finished flights wait for the end of the block."""
        stale = self.folder / STALE
        if holds_flights(self.folder):
            if not self._overwrite:
                raise TakenError(
                    f"{self.folder} holds finished flights of a run that was killed; move it, or give --overwrite"
                )
            if _is_flown(self.folder):
                shutil.rmtree(stale, ignore_errors=True)
                stale.mkdir()
                _move((e for e in list(self.folder.iterdir()) if e.name not in (LOCK, STALE)), stale)
        _empty(self.folder, but=(LOCK, STALE))

    def _settle(self) -> None:
        """Let what is written take the target's place."""
        if self._real.is_dir():
            self._move_in()
            return
        if os.name == "nt":
            self._unlock()  # no folder with an open file is renamed there
        self.folder.rename(self._real)
        with suppress(OSError):
            (self._real / LOCK).unlink()
        self._unlock()
        self._made = []

    def _move_in(self) -> None:
        """Take the place of what was written there before; all back if that fails."""
        new = sorted((e for e in self.folder.iterdir() if e.name != LOCK), key=lambda e: e.name in FLOWN)
        replaced = OURS | {entry.name for entry in new}
        before = [e for e in self._real.iterdir() if e.name in replaced]
        (self.folder / OLD).mkdir()
        moves = [(e, self.folder / OLD / e.name) for e in before] + [(e, self._real / e.name) for e in new]
        for done, (source, to) in enumerate(moves):
            try:
                source.rename(to)
            except BaseException:
                for back, there in reversed(moves[:done]):
                    there.rename(back)
                (self.folder / OLD).rmdir()
                raise
        _empty(self.folder, but=(LOCK,))

    def _give_up(self) -> None:
        """Let go; remove what is not finished, and the parents that were made for it."""
        if self._file is not None:
            with suppress(OSError):
                self._remove()
        self._unlock()
        for parent in self._made:
            with suppress(OSError):  # somebody else may use it by now
                parent.rmdir()

    def _remove(self) -> None:
        stale = self.folder / STALE
        if stale.is_dir() and not _is_flown(self.folder):  # nothing came to replace them
            _empty(self.folder, but=(LOCK, STALE))
            _move(list(stale.iterdir()), self.folder)
            stale.rmdir()
        if not holds_flights(self.folder):
            _empty(self.folder, but=(LOCK,))
            (self.folder / LOCK).unlink()  # the last one: from now on the folder is another's who takes it
            self.folder.rmdir()

    def _unlock(self) -> None:
        if self._file is not None:
            os.close(self._file)
            self._file = None


class StandingPlace(Place):
    """A target that is written where it stands, for runs that take long and are taken up again: each file is whole.

    What was finished stays there however the run ends; without a finished flight nothing is left.

    Parameters
    ----------
    target
        Made with its parents; an empty folder counts as none.
    overwrite
        Replace what a flight or a campaign left there; other files stay.
    resume
        Go on with the campaign that is there, if there is one.
    """

    def __init__(self, target: str | os.PathLike[str], *, overwrite: bool = False, resume: bool = False) -> None:
        super().__init__(target, overwrite=overwrite)
        self._resume = resume
        self.folder = self._real

    def _refuse(self) -> None:
        if os.path.lexists(self._real) and not self._real.is_dir():
            raise TakenError(f"{self.target} is a file, not a folder")
        if not self._real.is_dir():
            return
        if _is_held(self._real):
            raise TakenError(f"{self.target} is being written by another process")
        names = {entry.name for entry in self._real.iterdir()}
        if self._resume and not names <= {*OURS, LOCK, SCRATCH, ".keeping"} and "campaign.json" not in names:
            raise TakenError(f"{self.target} holds no campaign that could be resumed; choose another folder")
        if names - {LOCK} and not self._overwrite and not self._resume:
            raise TakenError(f"{self.target} is not empty; choose another folder, or give --resume or --overwrite")

    def claim(self) -> "Place":
        """Take the place."""
        try:
            with Interrupts():
                self._refuse()
                self._made = [parent for parent in (self._real, *self._real.parents) if not parent.exists()]
                self._real.mkdir(parents=True, exist_ok=True)
                self._file = os.open(self._real / LOCK, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
                self._hold()
                if self._overwrite and not self._resume:
                    _discard(entry for entry in self._real.iterdir() if entry.name in OURS)
        except BaseException as error:
            self._give_up()
            if isinstance(error, OSError) and not isinstance(error, TakenError):
                raise OSError(f"{self.target} cannot be written: {reason(error)}") from None
            raise
        return self

    def _hold(self) -> None:
        assert self._file is not None
        try:
            held = lock(self._file)
        except OSError:  # a file system without locks
            held = True
        if not held:
            os.close(self._file)
            self._file, self._made = None, []
            raise TakenError(f"{self.target} is being written by another process")

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        with suppress(KeyboardInterrupt), Interrupts():
            self._give_up()

    def _give_up(self) -> None:
        if self._file is not None:
            with suppress(OSError):
                shutil.rmtree(self._real / SCRATCH, ignore_errors=True)
                if self._made and not _is_flown(self._real):
                    _discard(entry for entry in self._real.iterdir() if entry.name in OURS)
                (self._real / LOCK).unlink()
        self._unlock()
        for parent in self._made:
            with suppress(OSError):  # it is not empty
                parent.rmdir()


class FilePlace(Place):
    """The same for one file: what is written as `folder / target.name` becomes it."""

    def _refuse(self) -> None:
        if self._real.is_dir():
            raise TakenError(f"{self.target} is a folder, not a file")
        if os.path.lexists(self._real) and not self._overwrite:
            raise TakenError(f"{self.target} exists; choose another file or give --overwrite")

    def _home(self) -> Path:
        return self._real.parent

    def _settle(self) -> None:
        (self.folder / self.target.name).replace(self._real)
        self._made = []


def holds_flights(folder: Path) -> bool:
    """Whether an unfinished folder holds finished flights, or some that were to be replaced."""
    return _is_flown(folder) or (folder / STALE).exists()


def _is_flown(folder: Path) -> bool:
    return any((folder / name).exists() for name in (*FLOWN, OLD))


def _hold(folder: Path) -> int | None:
    """Make a folder or take over that of a dead process; return what holds it, None if another process does."""
    for left in reversed(range(ATTEMPTS)):
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            new = _make(folder)
            file = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        except FileNotFoundError:  # its last holder has just removed it
            if left:
                continue
            raise
        try:
            held = lock(file)
        except OSError:  # a file system without locks: only a folder that was not there is surely ours
            held = new
        with suppress(FileNotFoundError):
            if held and os.path.samestat(os.fstat(file), os.stat(folder / LOCK)):
                return file
        os.close(file)
        if not held:
            break
    return None


def _make(folder: Path) -> bool:
    """Make a folder; False if there is one that may be of a run that was killed."""
    try:
        folder.mkdir()
    except FileExistsError:
        if _is_ours(folder):
            return False
        raise TakenError(f"{folder} is in the way: no run of yours has left it") from None
    return True


def _is_ours(folder: Path) -> bool:
    """Tell what a run of this user left from what somebody else put there, a link to elsewhere even."""
    status = folder.lstat()
    own = not hasattr(os, "geteuid") or status.st_uid == os.geteuid()
    return stat.S_ISDIR(status.st_mode) and own and ((folder / LOCK).is_file() or not any(folder.iterdir()))


def _is_held(folder: Path) -> bool:
    """Whether a process is writing into this folder, which may not be there."""
    try:
        file = os.open(folder / LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return False
    try:
        return not lock(file)
    except OSError:
        return True
    finally:
        os.close(file)


def _discard(entries: Iterable[Path]) -> None:
    for entry in entries:
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()


def _move(entries: Iterable[Path], folder: Path) -> None:
    for entry in entries:
        entry.rename(folder / entry.name)


def _empty(folder: Path, *, but: tuple[str, ...]) -> None:
    _discard(entry for entry in folder.iterdir() if entry.name not in but)
