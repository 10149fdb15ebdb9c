"""How often launch detectors cry wolf: alarms in hours of disturbances without a launch, and wings that open.

    mix          handling: shocks, vibration of 0 to 3 g rms, rails: `uavsim.studies.signals`
    vibration    3 g rms without shocks
    soft drops   6-12 g for 15-25 ms, 1800 an hour
    centrifuge   runs up to 4.1 g, held for 60 s, σ 0.5 g; its hours are those of the holds

All detectors read the same samples. The time is cut into pieces of ten minutes; a detector begins anew with each, and
after each alarm. What goes over the end of a piece is therefore lost, once in ten minutes; each piece is drawn from
the seed and its number alone.

An alarm is the detector's own. A false wing command is what an aircraft does of it: the flight computer follows what
was recognised and opens the wings only if enough speed was gained (`uavsim.studies.wing_commands`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import ceil

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.flight_computer import FlightComputerSettings
from uavsim.onboard.launch import DetectorSettings
from uavsim.studies.detections import BatchDetector
from uavsim.studies.intervals import rate_interval
from uavsim.studies.signals import SOFT_DROPS, SPELL, CentrifugeSettings, Mix, MixSettings, centrifuge
from uavsim.studies.wing_commands import commands
from uavsim.studies.workers import Progress, spread
from uavsim.truth import STANDARD_GRAVITY as G0

Single = NDArray[np.float32]

PIECE = 600.0  # s
SPELLS = round(PIECE / SPELL)
PIECES_AN_HOUR = 3600.0 / PIECE
CENTRIFUGE_SIGMA = 0.5  # standard g
CENTRIFUGE = CentrifugeSettings()
CENTRIFUGE_RUNS = round(PIECE / CENTRIFUGE.hold)  # a piece; their holds make up its time
CLIP = 16.0  # standard g
COMPUTER = FlightComputerSettings()


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A class of disturbances: its name, its number among the seed's streams, and the mix, if it is one."""

    name: str
    index: int
    mix: MixSettings | None = None

    def piece(self, seed: int, k: int, rate: float, axes: tuple[int, ...]) -> Single:
        """Return piece `k`, shape (n, axes), m/s², columns contiguous."""
        if self.mix is None:
            return _runs(seed, self.index, k, rate, axes)
        mix = Mix(self.mix, seed, self.index, rate, axes)
        size = SPELLS * mix.spell
        return next(mix.blocks(size, size, k * size))


DISTURBANCES: dict[str, Disturbance] = {
    d.name: d
    for d in (
        Disturbance("mix", 0, MixSettings()),
        Disturbance("vibration", 1, MixSettings(shock_rate=0.0, vibration_g=(3.0,))),
        Disturbance("soft drops", 2, SOFT_DROPS),
        Disturbance("centrifuge", 3),
    )
}


def _runs(seed: int, index: int, k: int, rate: float, axes: tuple[int, ...]) -> Single:
    one = centrifuge(CENTRIFUGE, rate).astype(np.float32)
    columns = np.empty((len(axes), CENTRIFUGE_RUNS * len(one)), np.float32)
    limit = np.float32(CLIP * G0)
    for i, axis in enumerate(axes):
        column = columns[i]
        generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index, k, axis)))
        generator.standard_normal(dtype=np.float32, out=column)
        np.multiply(column, np.float32(CENTRIFUGE_SIGMA * G0), out=column)
        np.add(column, np.tile(one[:, axis], CENTRIFUGE_RUNS), out=column)
        np.clip(column, -limit, limit, out=column)
    return columns.T


@dataclass(frozen=True, slots=True)
class FalseAlarms:
    """Alarms of one detector in a class of disturbances, wing commands that came of them, and the time, h."""

    alarms: int
    commands: int
    hours: float

    @property
    def per_hour(self) -> float:
        """Rate of alarms, 1/h."""
        return self.alarms / self.hours

    @property
    def commands_per_hour(self) -> float:
        """Rate of wing commands, 1/h."""
        return self.commands / self.hours

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Bounds of the rate of alarms, 1/h."""
        return rate_interval(self.alarms, self.hours, confidence)

    def commands_interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Bounds of the rate of wing commands, 1/h."""
        return rate_interval(self.commands, self.hours, confidence)


def count(
    detectors: Sequence[DetectorSettings],
    hours: dict[str, float],
    *,
    seed: int,
    rate: float = 1000.0,
    computer: FlightComputerSettings = COMPUTER,
    workers: int | None = None,
    progress: Progress | None = None,
) -> dict[str, list[FalseAlarms]]:
    """Count the alarms of detectors on the same disturbances, and the wing commands that come of them.

    Parameters
    ----------
    detectors
        Their settings.
    hours
        Time of each class by its name in `DISTURBANCES`; rounded up to pieces of ten minutes.
    seed
        Of the disturbances.
    rate
        Samples a second, Hz.
    computer
        Of the aircraft behind the detector.
    workers, progress
        As of `uavsim.studies.workers.spread`; the result does not depend on them.

    Returns
    -------
    dict
        For each class those of each detector.

    Raises
    ------
    ValueError
        Settings that do not fit together, or a rate that cannot hold the vibration.
    """
    counters = [BatchDetector(settings, rate) for settings in detectors]
    used = {column for counter in counters for column in counter.columns}
    axes = (0, 1, 2) if len(used) > 1 else tuple(used)
    pieces = {name: ceil(time * PIECES_AN_HOUR - 1e-9) for name, time in hours.items()}
    parts: list[Callable[[], NDArray[np.int64]]] = [
        partial(count_piece, detectors, computer, DISTURBANCES[name], seed, k, rate, axes)
        for name, n in pieces.items()
        for k in range(n)
    ]
    found = iter(spread(parts, workers=workers, progress=progress))
    none = np.zeros((len(detectors), 2), int)
    totals = {name: sum((next(found) for _ in range(n)), none) for name, n in pieces.items()}
    return {
        name: [FalseAlarms(int(alarms), int(opened), pieces[name] / PIECES_AN_HOUR) for alarms, opened in total]
        for name, total in totals.items()
        if pieces[name]
    }


def count_piece(
    detectors: Sequence[DetectorSettings],
    computer: FlightComputerSettings,
    what: Disturbance,
    seed: int,
    k: int,
    rate: float,
    axes: tuple[int, ...],
) -> NDArray[np.int64]:
    """Alarms and wing commands of each detector in a piece, shape (detectors, 2)."""
    force = what.piece(seed, k, rate, axes)
    read = force[:, 0] if len(axes) == 1 else force
    found = np.zeros((len(detectors), 2), np.int64)
    for row, settings in zip(found, detectors, strict=True):
        detector = BatchDetector(settings, rate)
        alarms = detector.alarms(read)
        if alarms.size:
            row[:] = alarms.size, commands(detector, read, computer, first=int(alarms[0])).size
    return found
