"""What a device writes on a bench: at rest, z down, 101 325 Pa, 25 °C.

At rest an accelerometer feels the push of the bench, upwards: with z down its specific force is (0, 0, -g0), so the
z axis reads -9.80665 m/s². A pressure sensor on a bench is not soldered to a board yet and its membrane feels no
acceleration worth the name. Both ports of a differential one are open. The readings are, bit for bit, those of the
device that flies.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sensors.accelerometer import Accelerometer
from sensors.accelerometer_description import AccelerometerDescription
from sensors.catalogue import Description, preset
from sensors.choice import choose
from sensors.differential_description import DifferentialDescription
from sensors.pressure import PressureSensor
from sensors.pressure_description import PressureErrors
from sensors.streams import Streams
from sensors.unit import G0, REFERENCE_TEMPERATURE, Unit

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

PRESSURE = 101325.0  # Pa, standard atmosphere (ISO 2533)
UNITS: tuple[Unit, ...] = ("random", "typical", "ideal")
UNSOLDERED = PressureErrors(solder=0.0, acceleration=0.0)
COLUMNS = {"accelerometer": ("t", "fx", "fy", "fz"), "pressure": ("t", "pressure", "temperature")}


def record_at_rest(
    name: str,
    *,
    duration: float,
    seed: int,
    unit: Unit = "random",
    range_g: float | None = None,
    rate: float | None = None,
    filter: str | None = None,
    mode: str | None = None,
    iir: int | None = None,
    noise_scale: float = 1.0,
) -> "pd.DataFrame":
    """Return what a part writes on a bench, by default at its largest range and its default rate or mode.

    Parameters
    ----------
    name : str
        The preset.
    duration : float
        Length of the record, s.
    seed : int
        Draws the unit, its clock's phase and its noise: the same seed gives the same frame.
    unit : {"random", "typical", "ideal"}
        Turn-on errors: drawn within the datasheet, exactly one standard deviation, or none.
    range_g, rate, filter, mode, iir, noise_scale
        As of `on_bench`.

    Returns
    -------
    pandas.DataFrame
        Columns t, fx, fy, fz (s, m/s², z down: at rest fz is -9.80665) of an accelerometer; t, pressure, temperature
        (s, the end of the conversion, Pa, K) of a pressure sensor.

    Raises
    ------
    ValueError
        For an unknown part, setting or unit, or a duration that is not positive.

    Examples
    --------
    >>> frame = record_at_rest("lsm6dso32", duration=1.0, seed=1, unit="ideal")
    >>> round(float(frame["fz"].mean()), 1)
    -9.8
    """
    import pandas as pd  # late: it takes half a second

    part = on_bench(name, range_g=range_g, rate=rate, filter=filter, mode=mode, iir=iir, noise_scale=noise_scale)
    columns = columns_of(part)
    rows = list(blocks(part, duration=duration, seed=seed, unit=unit))
    return pd.DataFrame(np.concatenate(rows) if rows else np.empty((0, len(columns))), columns=list(columns))


def on_bench(
    name: str,
    *,
    range_g: float | None = None,
    rate: float | None = None,
    filter: str | None = None,
    mode: str | None = None,
    iir: int | None = None,
    noise_scale: float = 1.0,
) -> Description:
    """Return the description of a part as it lies on a bench.

    Parameters
    ----------
    name : str
        The preset.
    range_g, rate, filter
        Of an accelerometer: range, ±g, its largest by default, output rate, Hz, and low-pass setting.
    mode, iir
        Of a pressure sensor: oversampling, "x1/x1", and coefficient of the digital filter.
    noise_scale : float
        Factor on the white noise.

    Raises
    ------
    ValueError
        For an unknown part, or a setting that it does not have.
    """
    if not 0.0 <= noise_scale <= 1000.0:
        raise ValueError(f"noise_scale must be a number from 0 to 1000, not {noise_scale!r}")
    description = preset(name)
    if isinstance(description, AccelerometerDescription):
        _refuse(description.name, "an accelerometer", mode=mode, iir=iir)
        largest = max(description.ranges_g) if range_g is None else range_g
        return description.select(range_g=largest, rate=rate, filter=filter).scaled(noise_scale)
    _refuse(description.name, "a pressure sensor", range_g=range_g, rate=rate, filter=filter)
    return description.select(mode=mode, iir=iir).scaled(noise_scale, UNSOLDERED)


def _refuse(name: str, kind: str, **settings: object) -> None:
    for key, value in settings.items():
        if value is not None:
            raise ValueError(f"{name} is {kind} and has no {key}")


def columns_of(description: Description) -> tuple[str, ...]:
    """Return the columns of a record of this part."""
    return COLUMNS["accelerometer" if isinstance(description, AccelerometerDescription) else "pressure"]


def blocks(description: Description, *, duration: float, seed: int, unit: Unit = "random") -> Iterator[Array]:
    """Return a record piece by piece, so that hours of it need no memory.

    Parameters
    ----------
    description : AccelerometerDescription or PressureDescription
        As `on_bench` gives it.
    duration, seed, unit
        As of `record_at_rest`.

    Returns
    -------
    iterator of numpy.ndarray
        Shape (n, 4) or (n, 3), with the columns of `columns_of`; a longer record begins as a shorter one.

    Raises
    ------
    ValueError
        For an unknown unit, or a duration that is not positive.
    """
    if not 0.0 < duration < float("inf"):
        raise ValueError(f"duration must be positive, not {duration!r}")
    choose("unit", unit, UNITS)
    return _until(duration, _endless(description, Streams(seed), unit))


def _endless(description: Description, streams: Streams, unit: Unit) -> Iterator[Array]:
    if isinstance(description, AccelerometerDescription):
        yield from Accelerometer(description, streams, unit=unit).at_rest((0.0, 0.0, -G0))
    else:
        sensor = PressureSensor(description, streams, unit=unit)
        at = 0.0 if isinstance(description, DifferentialDescription) else PRESSURE
        for end, pressure, temperature in sensor.at_rest(at, REFERENCE_TEMPERATURE):
            yield np.column_stack((end, pressure, temperature))


def _until(duration: float, endless: Iterator[Array]) -> Iterator[Array]:
    for block in endless:
        if block.size and block[-1, 0] >= duration:
            yield block[: np.searchsorted(block[:, 0], duration)]
            return
        yield block


def gathered(pieces: Iterator[Array], rows: int = 1 << 16) -> Iterator[Array]:
    """Yield the same record in larger pieces, which cost less to look at each."""
    waiting: list[Array] = []
    for piece in pieces:
        waiting.append(piece)
        if sum(map(len, waiting)) >= rows:
            yield np.concatenate(waiting)
            waiting = []
    if waiting:
        yield np.concatenate(waiting)


__all__ = ["COLUMNS", "UNITS", "blocks", "columns_of", "gathered", "on_bench", "record_at_rest"]
