"""A part on the bench: what its description promises, what a simulated record shows, what somebody's own log shows."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from sensors.accelerometer_description import AccelerometerDescription
from sensors.bench import Array, blocks, columns_of, gathered
from sensors.bench_log import BenchLog, parse_map, read_bench_log
from sensors.catalogue import Description
from sensors.characterise import FEWEST, Characterisation, characterise
from sensors.promise import Promise, promises
from sensors.unit import Unit

MOST_HOURS = 1000.0  # h
MOST_READINGS = 5e9  # in one record; about an hour of computing
HOUR = 3600.0  # s


@dataclass(frozen=True, slots=True, eq=False)
class Bench:
    """A part on the bench.

    Attributes
    ----------
    description : AccelerometerDescription or PressureDescription
    hours : float
        Length of the simulated record, h.
    seed : int
    unit : str
        Which unit was simulated.
    promises : tuple of Promise
        What the description promises, a channel each.
    simulated : tuple of Characterisation
        The same channels; the correlation time of the drift is taken as promised.
    log : BenchLog or None
        Somebody's own record.
    compared : tuple of Characterisation
        The same channels of the log; empty without one.
    """

    description: Description
    hours: float
    seed: int
    unit: Unit
    promises: tuple[Promise, ...]
    simulated: tuple[Characterisation, ...]
    log: BenchLog | None = None
    compared: tuple[Characterisation, ...] = ()

    @property
    def setting(self) -> str:
        """What the part is set to."""
        d = self.description
        if isinstance(d, AccelerometerDescription):
            return f"±{d.range_g:g} g, {d.rate:g} Hz, filter {d.filter}"
        return f"mode {d.mode.name}, {d.rate:g} Hz, filter {f'coefficient {d.iir}' if d.iir else 'off'}"


def check_hours(description: Description, hours: float) -> None:
    """Make sure that a record of so many hours can be made and says something; ValueError if not."""
    if not 0.0 < hours <= MOST_HOURS:
        raise ValueError(f"{hours!r}: give a number of hours above 0, at most {MOST_HOURS:g}")
    if hours * HOUR * description.rate > MOST_READINGS:
        most = MOST_READINGS / HOUR / description.rate
        raise ValueError(f"{hours:g} h are too long: give at most {most:.3g} at {description.rate:g} Hz")
    least = 2.0 * FEWEST / description.rate
    if hours * HOUR < least:
        raise ValueError(f"{hours:g} h are too short: give at least {least / HOUR:.2g} at {description.rate:g} Hz")


def read_log(path: Path, description: Description, mapping: str | None = None) -> BenchLog:
    """Read somebody's log of such a part.

    Parameters
    ----------
    path
        A CSV file with t and fx, fy, fz, or pressure and if it likes temperature, in SI.
    mapping
        Columns that have other names there, `ours=theirs,…`, theirs with a factor if need be: `fx=ax*9.80665`.

    Raises
    ------
    ValueError
        One line, if the file or the mapping is not as it should be.
    """
    columns = columns_of(description)
    needed = [name for name in columns if name != "temperature"]
    sources = {} if mapping is None else parse_map(mapping, columns)
    return read_bench_log(path, needed, columns[len(needed) :], sources)


def put_on_bench(
    description: Description,
    *,
    hours: float,
    seed: int,
    unit: Unit = "random",
    log: BenchLog | None = None,
    progress: Callable[[float], None] | None = None,
) -> Bench:
    """Simulate a record of a part at rest and characterise it, and a log beside it.

    Parameters
    ----------
    description
        The part, as `sensors.bench.on_bench` gives it.
    hours, seed, unit
        Length of the record, h; what is drawn.
    log
        A log of such a part.
    progress
        Called with the share that is done, 0 … 1.

    Raises
    ------
    ValueError
        If the hours are not positive or too few, or the unit is unknown.
    """
    check_hours(description, hours)
    promised = promises(description)
    channels = [promise.channel for promise in promised]
    pieces = gathered(blocks(description, duration=hours * HOUR, seed=seed, unit=unit))
    if progress is not None:
        pieces = _told(pieces, hours * HOUR, progress)
    return Bench(
        description=description,
        hours=hours,
        seed=seed,
        unit=unit,
        promises=promised,
        simulated=characterise(pieces, channels, promised[0].correlation_time or "flicker"),
        log=log,
        compared=() if log is None else characterise([log.table], channels),
    )


def _told(pieces: Iterator[Array], duration: float, progress: Callable[[float], None]) -> Iterator[Array]:
    for piece in pieces:
        yield piece
        progress(float(piece[-1, 0]) / duration)
