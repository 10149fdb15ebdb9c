"""What a log tells a launch detector besides the specific force: attitude and the speed of its satellites.

A rule that can be told has the methods `attitude(roll, pitch)`, rad, and `satellites(speed, number)`, m/s. Attitude is
brought to the time of each reading by straight lines, and is not known where its own readings are more than `OLD` away;
a speed is the last one that was told.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from uavsim.logs.recording import Array, Series

OLD = 1.0  # s: logs have attitudes at 10 Hz and more, speeds at 5; beyond, they say nothing of now
Tell = Callable[[int], None]


def telling(detector: Any, t: Array, series: Mapping[str, Series]) -> Tell | None:
    """Return what tells a detector what is known at the reading of a number, before it takes that; None if nothing is.

    Parameters
    ----------
    detector
        Any.
    t
        Times of the readings, s.
    series
        Of the log.
    """
    tells: list[Tell] = []
    if hasattr(detector, "attitude") and {"roll", "pitch"} <= set(series):
        roll, pitch = (_lines(series[name], t).tolist() for name in ("roll", "pitch"))
        tells.append(lambda k: detector.attitude(roll[k], pitch[k]))
    if hasattr(detector, "satellites") and _speed_of(series):
        told = [_last(series[name], t) for name in _speed_of(series)]
        speeds = (np.hypot(*told) if len(told) > 1 else told[0]).tolist()
        numbers = _last(series["satellites"], t).tolist()
        tells.append(lambda k: detector.satellites(speeds[k], numbers[k]))
    if not tells:
        return None

    def tell(k: int) -> None:
        for one in tells:
            one(k)

    return tell


def sources(detector: Any, series: Mapping[str, Series]) -> list[str]:
    """Say what of a log a detector is told besides the force."""
    said = []
    if hasattr(detector, "attitude") and {"roll", "pitch"} <= set(series):
        said.append(f"the detector is told the log's attitude, {series['pitch'].source}")
    if hasattr(detector, "satellites") and (speed := _speed_of(series)):
        said.append(f"the detector is told the log's satellites, {series[speed[0]].source}")
    return said


def _speed_of(series: Mapping[str, Series]) -> tuple[str, ...]:
    """Which series tell the speed over ground; none where the number of satellites is not told."""
    ways = ((), ("north_speed", "east_speed"), ("ground_speed",))
    found = [names for names in ways if {*names, "satellites"} <= set(series)]
    return found[-1] if found else ()


def _sound(series: Series) -> tuple[Array, Array]:
    sound = np.isfinite(series.values) & np.isfinite(series.t)
    return series.t[sound], series.values[sound]


def _lines(series: Series, t: Array) -> Array:
    """Values at times by straight lines, the short way round for angles; NaN far from any."""
    own, values = _sound(series)
    if not own.size:
        return np.full(t.size, np.nan)
    found = np.interp(t, own, np.unwrap(values))
    after = np.clip(np.searchsorted(own, t), 0, own.size - 1)
    before = np.clip(after - 1, 0, own.size - 1)
    far = (np.abs(own[after] - t) > OLD) | ((np.abs(t - own[before]) > OLD) & (own[after] != t))
    found[far] = np.nan
    return found


def _last(series: Series, t: Array) -> Array:
    """The last value told before each time; NaN if that is long ago."""
    own, values = _sound(series)
    if not own.size:
        return np.full(t.size, np.nan)
    at = np.searchsorted(own, t, side="right") - 1
    found = values[np.maximum(at, 0)].astype(np.float64)
    found[(at < 0) | (t - own[np.maximum(at, 0)] > OLD)] = np.nan
    return found
