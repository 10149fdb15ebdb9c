"""An airspeed against the speed over ground: by how much they differ, with the wind that fits both best.

With the velocity over ground g, its descent g_d, and a wind w that stays the same, each estimate V says

    |g − w| = √((V + c)² − g_d²)                                       g from a receiver, north and east
    |(V + c) (cos ψ, sin ψ) + w| = s                                   where the log has but a speed s and a heading ψ

c is what the airspeed is off by, the mean over all headings. One leg cannot tell it from the wind: two full turns are
asked for. Turbulence, a wind that changes and sideslip are in the residuals, which are alike for many seconds: so the
standard deviation of c is that of a jackknife over blocks.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from uavsim.logs.recording import Array, Series

TURNS = 2.0  # full turns, of which fewer tell no wind
BLOCK = 20.0  # s of a block, longer than a circle of a small aircraft. By hand
FEWEST = 50  # moments
Known = tuple[Array, ...]
Residuals = Callable[[Array, Known], Array]

PACE = 0.2  # s between two moments: what receivers give
STALE = 1.0  # s, how far a reading may be from a moment
SMOOTH = 5  # moments, over which a track is averaged before its turns are counted


@dataclass(frozen=True, slots=True)
class OverGround:
    """What the comparison gives.

    Attributes
    ----------
    difference, sd : float
        c and its standard deviation, m/s: positive where the airspeed is told too low.
    claimed : float
        What the estimates claim for a mean, m/s: the median of their standard deviations, for their errors are alike.
    wind_north, wind_east : float
        To where the air moves, m/s.
    turns : float
        Full turns that were flown.
    moments : int
    residual : float
        Rms of what remains, m/s.
    """

    difference: float
    sd: float
    claimed: float
    wind_north: float
    wind_east: float
    turns: float
    moments: int
    residual: float

    @property
    def within(self) -> bool:
        """Whether the difference is within both error bars together, 1.96 standard deviations."""
        return abs(self.difference) <= 1.96 * sqrt(self.sd**2 + self.claimed**2)


def over_ground(estimate: Mapping[str, Array], series: Mapping[str, Series]) -> OverGround | None:
    """Hold an airspeed against a log's speed over ground; None without one, or without two turns.

    Parameters
    ----------
    estimate
        Columns t, airspeed, airspeed_sd and valid of the rows in flight.
    series
        What the log holds.
    """
    use = estimate["valid"].astype(bool) & np.isfinite(estimate["airspeed"])
    if np.count_nonzero(use) < FEWEST:
        return None
    t, speed, sd = (estimate[name][use] for name in ("t", "airspeed", "airspeed_sd"))
    picked = np.unique(np.searchsorted(t, np.arange(t[0], t[-1], PACE)))
    t, speed, sd = t[picked], speed[picked], sd[picked]
    down = _at(series.get("down_speed"), t)
    down = np.where(np.isfinite(down), down, 0.0)
    if "north_speed" in series and "east_speed" in series:
        north, east = _at(series["north_speed"], t), _at(series["east_speed"], t)
        good = np.isfinite(north) & np.isfinite(east)
        known = (t[good], speed[good], down[good], north[good], east[good])
        residuals, track = _of_velocity, _track
    elif "ground_speed" in series and "heading" in series:
        heading = _at(series["heading"], t, angle=True)
        ground = _at(series["ground_speed"], t)
        good = np.isfinite(heading) & np.isfinite(ground)
        known = (t[good], speed[good], down[good], ground[good], heading[good])
        residuals, track = _of_speed, _heading
    else:
        return None
    if np.count_nonzero(good) < FEWEST:
        return None
    found = _fit(residuals, known)
    turns = _turns(track(found, known))
    if turns < TURNS:
        return None
    block = np.floor((known[0] - known[0][0]) / BLOCK)
    without = np.array([
        _fit(residuals, tuple(column[block != one] for column in known), found)[2] for one in np.unique(block)
    ])  # fmt: skip
    n = without.size
    spread = sqrt((n - 1) / n * float(np.sum((without - without.mean()) ** 2))) if n > 1 else float("inf")
    left = residuals(found, known)
    return OverGround(
        float(found[2]), spread, float(np.median(sd[good])), float(found[0]), float(found[1]), turns,
        int(known[0].size), float(np.sqrt(np.mean(left**2))),
    )  # fmt: skip


def _at(series: Series | None, t: Array, *, angle: bool = False) -> Array:
    """A series at each moment, NaN where it has nothing near."""
    if series is None:
        return np.full(t.shape, np.nan)
    good = np.isfinite(series.values) & np.isfinite(series.t)
    at, values = series.t[good], series.values[good]
    if not at.size:
        return np.full(t.shape, np.nan)
    found = np.interp(t, at, np.unwrap(values) if angle else values)
    near = np.minimum(np.searchsorted(at, t), at.size - 1)
    apart = np.minimum(np.abs(at[near] - t), np.abs(at[np.maximum(near - 1, 0)] - t))
    return np.where(apart <= STALE, found, np.nan)


def _of_velocity(x: Array, known: tuple[Array, ...]) -> Array:
    _, speed, down, north, east = known
    flat = np.sqrt(np.maximum((speed + x[2]) ** 2 - down**2, 0.0))
    return np.asarray(np.hypot(north - x[0], east - x[1]) - flat)


def _of_speed(x: Array, known: tuple[Array, ...]) -> Array:
    _, speed, down, ground, heading = known
    flat = np.sqrt(np.maximum((speed + x[2]) ** 2 - down**2, 0.0))
    return np.asarray(ground - np.hypot(flat * np.cos(heading) + x[0], flat * np.sin(heading) + x[1]))


def _fit(residuals: Residuals, known: tuple[Array, ...], start: Array | None = None) -> Array:
    from scipy.optimize import least_squares  # late: a log without a receiver does not need it

    first = np.zeros(3) if start is None else start
    return np.asarray(least_squares(residuals, first, args=(known,), loss="soft_l1", f_scale=2.0).x)


def _track(x: Array, known: tuple[Array, ...]) -> Array:
    _, _, _, north, east = known
    return np.asarray(np.unwrap(np.arctan2(east - x[1], north - x[0])))


def _heading(x: Array, known: tuple[Array, ...]) -> Array:
    return np.asarray(np.unwrap(known[4]))


def _turns(track: Array) -> float:
    """Full turns of a track, rad, whichever way round."""
    if track.size < 2 * SMOOTH:
        return 0.0
    smooth = np.convolve(track, np.full(SMOOTH, 1.0 / SMOOTH), mode="valid")
    return float(np.sum(np.abs(np.diff(smooth[::SMOOTH])))) / (2.0 * pi)
