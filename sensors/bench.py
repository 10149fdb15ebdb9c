"""What a device writes on a bench: at rest, z down, 101 325 Pa, 25 °C.

At rest an accelerometer feels the push of the bench, upwards: with z down its specific force is (0, 0, -g0), so
the z axis reads -9.80665 m/s². The readings come from the very code that flies.
"""

from itertools import chain
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from sensors.accelerometer import Accelerometer
from sensors.accelerometer_description import AccelerometerDescription
from sensors.catalogue import preset
from sensors.choice import choose
from sensors.pressure import PressureSensor
from sensors.pressure_description import PressureDescription
from sensors.streams import Streams
from sensors.unit import G0, Unit

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd

PRESSURE = 101325.0  # Pa, standard atmosphere (ISO 2533)
TEMPERATURE = 298.15  # K, 25 °C, at which datasheets state their figures


def record_at_rest(name: str, *, duration: float, seed: int, unit: Unit = "random") -> "pd.DataFrame":
    """Return what a shipped part writes on a bench, at its largest range and default rate or mode.

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

    Returns
    -------
    pandas.DataFrame
        Columns t, fx, fy, fz (s, m/s², z down: at rest fz is -9.80665) of an accelerometer; t, pressure, temperature
        (s, the end of the conversion, Pa, K) of a pressure sensor.

    Raises
    ------
    ValueError
        For an unknown part or unit, or a duration that is not positive.

    Examples
    --------
    >>> frame = record_at_rest("lsm6dso32", duration=1.0, seed=1, unit="ideal")
    >>> round(float(frame["fz"].mean()), 1)
    -9.8
    """
    import pandas as pd  # late: it takes half a second

    if not 0.0 < duration < float("inf"):
        raise ValueError(f"duration must be positive, not {duration!r}")
    choose("unit", unit, ("random", "typical", "ideal"))
    description = preset(name)
    if isinstance(description, AccelerometerDescription):
        columns = ["t", "fx", "fy", "fz"]
        rows = _accelerometer_rows(description.select(range_g=max(description.ranges_g)), duration, seed, unit)
    else:
        columns = ["t", "pressure", "temperature"]
        rows = _pressure_rows(description, duration, seed, unit)
    # Straight into an array: an hour of tuples would take half a gigabyte.
    table = np.fromiter(chain.from_iterable(rows), dtype=float).reshape(-1, len(columns))
    return pd.DataFrame(table, columns=columns)


def _accelerometer_rows(
    description: AccelerometerDescription, duration: float, seed: int, unit: Unit
) -> "Iterator[tuple[float, ...]]":
    device = Accelerometer(description, Streams(seed), unit=unit)
    for second in range(ceil(duration) + 1):  # the force is steady: once a second is often enough
        for reading in device.step((float(second), (0.0, 0.0, -G0))):
            if reading[0] < duration:
                yield reading


def _pressure_rows(
    description: PressureDescription, duration: float, seed: int, unit: Unit
) -> "Iterator[tuple[float, ...]]":
    device = PressureSensor(description, Streams(seed), unit=unit)
    while device.end < duration:
        pressure, temperature, t = device.read(device.end, lambda _: (PRESSURE, TEMPERATURE))
        yield t, pressure, temperature
