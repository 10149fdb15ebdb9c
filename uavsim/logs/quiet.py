"""Stretches of a log in which the aircraft stands still, and how noisy its sensors are there.

An aircraft stands still where the mean of each axis of the specific force stays the same from block to block, and the
pair's difference is near its least: in smooth flight the force may be as quiet, the pressure is not.

The noise of a channel is the greatest of σ_A(m) √m, with σ_A(m) the Allan deviation of means of m readings and m up to
a quarter of a second: that of white noise which is as large where a filter averages it. Noise that is coloured, as of
a part with a digital filter, counts as what it leaves after averaging, which is more than the spread of its readings.
"""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from uavsim.logs.head import Channel, Head
from uavsim.logs.recording import Array

BLOCK = 0.25  # s of a mean: half of that on the rail (`uavsim.onboard.rail_offset`), for a log may begin late
SHAKES = 2.0  # m/s² rms within a block, up to which an aircraft stands still: a motor that runs while waiting
TURNS = 0.25  # m/s² by which means of blocks may differ: 1.5° of tilt. By hand
LEAST = 4  # blocks in a row that make a stretch
NEAR = 0.2  # of the way from the least to the greatest pressure difference, up to which it is one of rest. By hand
CALM = 40.0  # Pa: ½ρw² of 8 m/s, which a head at rest may see whatever the flight was
LONGEST = 60.0  # s of a stretch that are looked at for noise
AVERAGED = 0.25  # s, of the longest means
ROBUST = 1.4826  # sd of a Gaussian over its median absolute deviation


@dataclass(frozen=True, slots=True)
class Stretch:
    """From when to when, s."""

    start: float
    end: float

    @property
    def length(self) -> float:
        """s."""
        return self.end - self.start


def quiet(readings: Array, head: Head) -> list[Stretch]:
    """Return the stretches in which the aircraft stands still, in their order."""
    t, force = readings[:, 0], readings[:, 1:]
    edges = np.arange(t[0], t[-1], BLOCK)
    if edges.size <= LEAST:
        return []
    mean, spread = _blocks(t, force, edges)
    moved = np.full(edges.size, inf)
    moved[1:] = np.max(np.abs(np.diff(mean, axis=0)), axis=1)
    moved[0] = moved[1]
    apart, _ = _blocks(head.total.t, head.differences[:, None], edges)
    differences = apart[:, 0]
    known = np.isfinite(differences)
    if not known.any():
        return []
    low, high = np.percentile(differences[known], (2.0, 95.0))
    still = (np.max(spread, axis=1) <= SHAKES) & (moved <= TURNS) & (differences <= low + max(CALM, NEAR * (high - low)))
    still[:-1] &= moved[1:] <= TURNS
    return [
        Stretch(float(edges[a]), float(edges[b - 1] + BLOCK)) for a, b in _runs(still) if b - a >= LEAST
    ]


def _blocks(t: Array, values: Array, edges: Array) -> tuple[Array, Array]:
    """Mean and standard deviation of each column in each block; NaN where there is nothing."""
    place = np.searchsorted(edges, t, side="right") - 1
    good = (place >= 0) & np.isfinite(values).all(axis=1) & (t < edges[-1] + BLOCK)
    place, values = place[good], values[good]
    count = np.bincount(place, minlength=edges.size).astype(float)
    count[count == 0.0] = np.nan
    columns = values.T
    mean = np.column_stack([np.bincount(place, column, edges.size) / count for column in columns])
    square = np.column_stack(
        [np.bincount(place, (column - mean[place, i]) ** 2, edges.size) / count for i, column in enumerate(columns)]
    )
    return mean, np.sqrt(square)


def _runs(flags: Array) -> list[tuple[int, int]]:
    edges = np.diff(np.concatenate(([0], flags.astype(int), [0])))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


def noise_at_rest(channel: Channel, stretches: list[Stretch]) -> float | None:
    """Standard deviation of one reading as white noise, by what is averaged of it; None without enough readings."""
    most = max(1, int(AVERAGED / channel.period))
    sums, counts = np.zeros(most), np.zeros(most)
    for stretch in stretches:
        inside = (channel.t >= stretch.start) & (channel.t <= min(stretch.end, stretch.start + LONGEST))
        values = channel.values[inside]
        for m in range(1, most + 1):
            if values.size >= 4 * m:
                means = values[: values.size // m * m].reshape(-1, m).mean(axis=1)
                sums[m - 1] += m * float(np.sum(np.diff(means) ** 2)) / 2.0
                counts[m - 1] += means.size - 1
    enough = counts >= 8
    return sqrt(float(np.max(sums[enough] / counts[enough]))) if enough.any() else None


def noise_throughout(channel: Channel) -> float:
    """Standard deviation of one reading by its second differences, wherever the aircraft is."""
    bends = np.diff(channel.values, 2)
    return ROBUST * float(np.median(np.abs(bends))) / sqrt(6.0) if bends.size else 0.0


def walk_at_rest(channel: Channel, stretches: list[Stretch]) -> float:
    """How fast means of a second wander, per √s: what is more than their noise; 0 without enough of them."""
    found = []
    for stretch in stretches:
        edges = np.arange(stretch.start, stretch.end, 1.0)
        if edges.size >= 8:
            mean, _ = _blocks(channel.t, channel.values[:, None], edges)
            steps = mean[:, 0]
            steps = steps[np.isfinite(steps)]
            near, far = (float(np.mean((steps[k:] - steps[:-k]) ** 2)) for k in (1, 4))
            found.append(max(0.0, far - near) / 3.0)
    return sqrt(float(np.median(found))) if found else 0.0


def step_of(channel: Channel) -> float:
    """By which readings are rounded; 0 where no step shows."""
    values = np.unique(channel.values[:200_000])
    if values.size < 2:
        return 0.0
    steps = np.diff(values)
    least = float(np.min(steps[steps > 1e-9 * max(1.0, float(np.abs(values).max()))], initial=inf))
    whole = np.abs(steps / least - np.round(steps / least)) < 0.02 if least < inf else np.zeros(0)
    return least if least < inf and whole.mean() > 0.95 else 0.0
