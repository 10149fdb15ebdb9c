"""How long `roc` and `tune` take, and what is within reach of detectors that run in plain Python.

In plain Python run detectors without a compiled loop, and all of them where numba's JIT is off. It takes `COST` for a
sample and detector, a hundred times and more what a compiled loop takes. So that `roc` ends in about ten minutes, hours
and launches beyond `MOST` and `MOST_TRIED` are then left out, which is told. What is left gives what it gives with a
loop.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil

from uavsim.compiled import jit
from uavsim.onboard.launch import DetectorSettings
from uavsim.studies.detections import has_loop
from uavsim.studies.false_alarms import PIECE, PIECES_AN_HOUR
from uavsim.studies.operating import SHARES

COST = 0.4e-6  # s a sample and detector of a loop in plain Python, the mean over our kinds on one core of 2024
STEPPED = 1.2e-6  # s of a detector that is stepped: what ours take, 0.3 to 1.5, and their guard
MOST = 1.0e9  # samples times detectors of disturbances, 7 minutes
MOST_TRIED = 1.5e8  # samples times detectors of launches, a minute, and as many in the cells
LAUNCH = 1.9  # s of a launch until it is decided; most of it is the wait before
COUNTED = 40.0  # settings that `tune` counts over all its hours, about
DRAWS = 12.0  # times that `tune` draws its hours of a class, about
COMPILED = 7e-9  # s a sample and detector of a compiled loop and the flight computer behind it, on one core of 2024
DRAWN = 8e-8  # s a sample of disturbances that is drawn, the mean over the classes
PATIENCE = 10.0  # s, from which on it is said beforehand how long it takes
OFF = "numba's JIT is off (NUMBA_DISABLE_JIT)"


@dataclass(frozen=True, slots=True)
class Work:
    """What `roc` does: hours of the mix, launches, and launches in each cell."""

    hours: float
    trials: int
    cells: int


def plain(detectors: Iterable[DetectorSettings], rate: float) -> list[DetectorSettings]:
    """Return those of some detectors that run in plain Python."""
    return [one for one in detectors if not (jit() and has_loop(one, rate))]


def why(detectors: Iterable[DetectorSettings]) -> str:
    """Say why some detectors run in plain Python."""
    names = list(dict.fromkeys(one.kind for one in detectors))
    return f"{', '.join(names)}: without a compiled loop" if jit() else OFF


def cost() -> float:
    """Time that plain Python takes for a sample and detector, s."""
    return STEPPED if jit() else COST


def within_reach(asked: Work, *, detectors: int, compared: int, rate: float) -> Work:
    """Return what ends in about ten minutes; nothing grows, and without plain Python nothing changes.

    Parameters
    ----------
    asked
        What the user wants.
    detectors, compared
        Settings in the sweep, and settings times cells in the comparison, that run in plain Python.
    rate
        Samples a second, Hz.
    """
    if not detectors and not compared:
        return asked
    share = COST / cost()
    pieces = int(MOST * share / (PIECE * rate * max(1, detectors)))
    mix = 1
    while mix + 1 + 3 * ceil((mix + 1) / 4) <= pieces:  # three classes have a quarter of the hours each
        mix += 1
    tried = MOST_TRIED * share / (LAUNCH * rate)
    return Work(
        min(asked.hours, mix / PIECES_AN_HOUR),
        min(asked.trials, max(1, int(tried / max(1, detectors)))),
        min(asked.cells, max(1, int(tried / max(1, compared)))),
    )


def lasts(work: Work, *, settings: int, compared: int, rate: float, threads: int) -> float:
    """Time that `roc` takes with compiled loops, s, by what it costs on one core of 2024.

    Parameters
    ----------
    work
        What it does.
    settings, compared
        Settings in the sweep, and settings times cells in the comparison.
    rate
        Samples a second, Hz.
    threads
        How many work.
    """
    samples = sum(SHARES.values()) * work.hours * 3600.0 * rate
    launches = LAUNCH * rate * (work.trials * settings + work.cells * compared)
    return (samples * (DRAWN + COMPILED * settings) + launches * COMPILED) / threads


def tuning_lasts(hours: float, rate: float, threads: int) -> float:
    """Time that `tune` takes with compiled loops for the hours that its budget needs, s."""
    samples = hours * 3600.0 * rate
    return samples * (DRAWS * DRAWN + COUNTED * COMPILED) / threads


def patience(seconds: float) -> str:
    """Say how long it takes; empty where nobody has to wait."""
    if seconds < PATIENCE:
        return ""
    return f"this takes about {seconds:.0f} s" if seconds < 100.0 else f"this takes about {seconds / 60.0:.0f} min"


def told(asked: Work, done: Work, reason: str) -> str:
    """Say what is left out, and why; empty if nothing is."""
    names = (("hours", "h of the mix"), ("trials", "launches"), ("cells", "launches a cell"))
    changed = [
        f"{getattr(done, key):.2g} {what} instead of {getattr(asked, key):g}"
        if key == "hours"
        else f"{getattr(done, key)} {what} instead of {getattr(asked, key)}"
        for key, what in names
        if getattr(done, key) != getattr(asked, key)
    ]
    return f"{reason}: so that it ends in about ten minutes, {', '.join(changed)}" if changed else ""


def tuning_told(hours: float, rate: float, reason: str) -> str:
    """Say how long `tune` takes in plain Python for the hours that its budget needs, and why."""
    minutes = COUNTED * hours * 3600.0 * rate * cost() / 60.0
    return f"{reason}: this takes about {minutes:.0f} min, and less for a larger --false-alarms"
