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
from uavsim.truth import STANDARD_GRAVITY

BLOCK = 0.25  # s of a mean: half of that on the rail (`uavsim.onboard.rail_offset`), for a log may begin late
SHAKES = 2.0  # m/s² rms within a block, up to which an aircraft stands still: a motor that runs while waiting
TURNS = 0.25  # m/s² by which means of blocks may differ: 1.5° of tilt. By hand
LEAST = 4  # blocks in a row that make a stretch
NEAR = 0.2  # of the way from the least to the greatest pressure difference, up to which it is one of rest. By hand
CALM = 40.0  # Pa: ½ρw² of 8 m/s, which a head at rest may see whatever the flight was
# times the least difference, at least `FAINT` Pa, that the greatest must be to show that the log has both rest and
# flight; else only a difference below `CALM` is one of rest. By hand: a flight of 10 to 17 m/s has 2.9
CONTRAST, FAINT = 3.0, 20.0
CARRIED = (0.7, 1.3)  # g, of the mean force of an aircraft that is carried about
LONGEST = 60.0  # s of a stretch that are looked at for noise
AVERAGED = 0.25  # s, of the longest means
SECOND, FEW = 1.0, 3  # s over which noise is judged, and differences in it at the least
ENOUGH = 100  # differences of means in all, of which the noise is known to a tenth
SHAKEN = 2.0  # times as much as at rest, from which on a sensor is noisier in flight; less is turbulence. By hand
COLOURED = 1.4  # times as much as single readings show, from which on noise is coloured. By hand
BEYOND = 3.0  # standard deviations, to which a second difference is cut: 1 % less of Gaussian noise
QUARTILE = 0.6745  # of a standard normal variable
ROBUST = 1.4826  # sd of a Gaussian over its median absolute deviation


@dataclass(frozen=True, slots=True)
class Stretch:
    """From when to when, s."""

    start: float
    end: float

    @property
    def length(self) -> float:
        """How long it is, s."""
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class Rests:
    """Stretches of a log at rest, in their order.

    Attributes
    ----------
    still : list of Stretch
        In which the aircraft stands still.
    calm : list of Stretch
        In which its head is in still air, whoever carries it.
    """

    still: list[Stretch]
    calm: list[Stretch]


def rests_of(readings: Array, head: Head) -> Rests:
    """Find where a log's aircraft is at rest."""
    t, force = readings[:, 0], readings[:, 1:]
    edges = np.arange(t[0], t[-1], BLOCK)
    if edges.size <= LEAST:
        return Rests([], [])
    mean, spread = _blocks(t, force, edges)
    moved = np.full(edges.size, inf)
    moved[1:] = np.max(np.abs(np.diff(mean, axis=0)), axis=1)
    moved[0] = moved[1]
    apart, _ = _blocks(head.total.t, head.differences[:, None], edges)
    differences = apart[:, 0]
    known = np.isfinite(differences)
    if not known.any():
        return Rests([], [])
    low, high = np.percentile(differences[known], (2.0, 95.0))
    both = high > CONTRAST * max(low, FAINT)
    size = np.linalg.norm(mean, axis=1) / STANDARD_GRAVITY
    calm = differences <= (low + max(CALM, NEAR * (high - low)) if both else CALM)
    still = calm & (np.max(spread, axis=1) <= SHAKES) & (moved <= TURNS)
    still[:-1] &= moved[1:] <= TURNS
    carried = calm & (size > CARRIED[0]) & (size < CARRIED[1])
    return Rests(
        *([_stretch(edges, *run) for run in _runs(rows) if run[1] - run[0] >= LEAST] for rows in (still, carried))
    )


def _stretch(edges: Array, first: int, after: int) -> Stretch:
    return Stretch(float(edges[first]), float(edges[after - 1] + BLOCK))


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
    """Standard deviation of one reading as white noise, by what is averaged of it; None without enough readings.

    It is that of a calm second: one in four is calmer. What wind makes of a head at rest is none of its noise.
    """
    found: list[list[float]] = [[] for _ in _means(channel, AVERAGED)]
    number = [0] * len(found)
    for stretch in stretches:
        last = min(stretch.end, stretch.start + LONGEST)
        for start in np.arange(stretch.start, last - 0.5 * SECOND, SECOND):
            first, after = np.searchsorted(channel.t, (start, min(start + SECOND, last)))
            for i, m in enumerate(_means(channel, AVERAGED)):
                differences = int(after - first) // m - 1
                if differences >= FEW:
                    found[i].append(_allan(channel.values[first:after], m) / _usual(differences))
                    number[i] += differences
    known = [one for i, one in enumerate(found) if one and (i == 0 or number[i] >= ENOUGH)]
    return as_white([sqrt(float(np.percentile(one, 25.0))) for one in known]) if found[0] else None


def _usual(differences: int) -> float:
    """What is between the lower quartile of a variance by so many differences and the variance itself.

    By Wilson and Hilferty's cube root of χ²; neighbouring differences of white noise are worth two thirds of their
    number.
    """
    part = 2.0 / (9.0 * max(1.0, 2.0 / 3.0 * differences))
    return float((1.0 - part - QUARTILE * sqrt(part)) ** 3)


def noise_throughout(channel: Channel, averaged: float = 0.0) -> float:
    """The same by second differences of means, wherever the aircraft is; means of up to `averaged`, s.

    Second differences do not see a ramp (Hadamard's variance in place of Allan's), and those that are far beyond the
    usual count as if they were not. Of a channel that itself wanders, as the total pressure in turbulence, single
    readings say more of the sensor than means.
    """
    found = []
    for m in _means(channel, averaged) if channel.t.size > 1 else ():
        means = channel.values[: channel.values.size // m * m].reshape(-1, m).mean(axis=1)
        bends = np.abs(np.diff(means, 2))
        if bends.size >= 8:
            usual = np.minimum(bends, BEYOND * ROBUST * float(np.median(bends)) or np.inf)
            found.append(sqrt(m / 6.0 * float(np.mean(usual**2))))
    return as_white(found) if found else 0.0


def noise_of(channel: Channel, rests: Rests, averaged: float) -> float:
    """Noise of a channel of the head, by its rest, or by its flight if that is much noisier, or where there is no rest.

    Where the aircraft never stands still, as in a hand, single readings of its rest count: means of them hold the wind.
    """
    flying = noise_throughout(channel, averaged)
    resting = noise_at_rest(channel, rests.still)
    if resting is None and rests.calm:
        resting = noise_throughout(_within(channel, rests.calm))
    if not resting:
        return flying
    return flying if flying > SHAKEN * resting else resting


def _within(channel: Channel, stretches: list[Stretch]) -> Channel:
    inside = np.zeros(channel.t.size, bool)
    for stretch in stretches:
        inside |= (channel.t >= stretch.start) & (channel.t <= stretch.end)
    return Channel(channel.name, channel.t[inside], channel.values[inside], channel.source)


def _means(channel: Channel, averaged: float) -> list[int]:
    """How many readings the means have, by powers of two up to a time, s."""
    most = max(1, int(averaged / channel.period))
    return [2**k for k in range(most.bit_length())]


def as_white(found: list[float]) -> float:
    """The first of several estimates of the same noise, unless others show more than chance makes of it."""
    return max(found) if max(found) > COLOURED * found[0] else found[0]


def _allan(values: Array, m: int) -> float:
    """Allan variance of means of m readings, times m: of white noise that of one reading."""
    means = values[: values.size // m * m].reshape(-1, m).mean(axis=1)
    return m * float(np.mean(np.diff(means) ** 2)) / 2.0


def step_of(channel: Channel) -> float:
    """By which readings are rounded; 0 where no step shows."""
    values = np.unique(channel.values[:200_000])
    if values.size < 2:
        return 0.0
    steps = np.diff(values)
    least = float(np.min(steps[steps > 1e-9 * max(1.0, float(np.abs(values).max()))], initial=inf))
    whole = np.abs(steps / least - np.round(steps / least)) < 0.02 if least < inf else np.zeros(0)
    return least if least < inf and whole.mean() > 0.95 else 0.0
