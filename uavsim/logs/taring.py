"""When the head of a log is tared: no crew has told of a cover, so its readings have to.

A head is in still air, under a cover or in a lull, where means of its difference over a quarter of a second stay at the
lowest level that a whole second of the rest has, within what its noise allows. Such a stretch is a tare of the pair, as
under a cover: what is read after it is the wind. Where there is none, the tare is taken in the open, over the last
seconds of rest, and holds the wind.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from uavsim.logs.head import Channel, Head
from uavsim.logs.quiet import BLOCK, Rests, Stretch, noise_throughout
from uavsim.onboard.interface import TareWindow
from uavsim.scenario import Scenario

LEAD = 0.5  # s before a recognised launch at which its tare ends, unless air_data.cover_off says when
TARED = 10.0  # s of rest that are averaged at the most, unless air_data.tare_duration says how many
LEAST = 0.5  # s
LEVEL = 4  # blocks whose mean is a level of the rest
FAR = 4.0  # standard deviations of a block's mean: beside its level by chance once in 16 000
LONG = 60.0  # s of rest that are looked through


@dataclass(frozen=True, slots=True)
class Tared:
    """When, s, whether in still air, and whether somebody said so."""

    window: TareWindow
    still: bool
    told: bool = False


def tared(
    head: Head, rests: Rests, start: float, end: float, launch: float | None, scenario: Scenario, named: tuple[str, ...]
) -> Tared | None:
    """Find the tare of a flight that is replayed from `start` to `end`, s; None if it has none.

    Parameters
    ----------
    head, rests
        Of the log.
    start, end, launch
        Of the flight, s.
    scenario, named
        What the user says of it: the keys `air_data.tare`, `air_data.tare_duration`, `air_data.cover_off`.
    """
    air, given = scenario.air_data, [key for key in named if key.startswith("air_data.")]
    covered = air.tare == "covered" and "air_data.tare" in given
    if air.tare == "none" and "air_data.tare" in given:
        return None
    lead = air.cover_off if "air_data.cover_off" in given else LEAD
    longest = air.tare_duration if "air_data.tare_duration" in given else TARED
    if launch is not None and ("air_data.cover_off" in given or "air_data.tare_duration" in given):
        return Tared((launch - lead - longest, launch - lead), covered, told=True)
    before = end if launch is None else launch - lead
    for stretches in (rests.still, rests.calm):
        usable = [rest for rest in stretches if rest.end > start and min(rest.end, before) - rest.start >= LEAST]
        if usable:
            rest = usable[0] if launch is None else usable[-1]
            over = min(rest.end, before)
            first = max(rest.start, start, over - LONG)
            lull = None if covered or "air_data.tare" in given else _lull(head, Stretch(first, over))
            if lull is not None:
                return Tared((max(lull.start, lull.end - longest), lull.end), still=True)
            return Tared((max(first, over - longest), over), covered, told="air_data.tare" in given)
    return None


def _lull(head: Head, rest: Stretch) -> Stretch | None:
    """The last second or more of a rest in which the head is in still air; None if it never is."""
    t, differences = head.total.t, head.differences
    inside = (t >= rest.start) & (t < rest.end) & np.isfinite(differences)
    t, differences = t[inside], differences[inside]
    count = int((rest.end - rest.start) / BLOCK)
    if count < LEVEL or t.size < 3 * count:
        return None
    place = np.minimum(((t - rest.start) / BLOCK).astype(int), count - 1)
    number = np.bincount(place, minlength=count)
    if not number.all():
        return None
    mean = np.bincount(place, differences, count) / number
    level = float(np.convolve(mean, np.full(LEVEL, 1.0 / LEVEL), mode="valid").min())
    each = noise_throughout(Channel("", t, differences, ""))
    still = np.abs(mean - level) <= FAR * each / np.sqrt(number) * sqrt(1.0 + 1.0 / LEVEL)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], still, [False])).astype(int)))
    runs = [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= LEVEL]
    if not runs:
        return None
    a, b = runs[-1]
    return Stretch(rest.start + a * BLOCK, rest.start + b * BLOCK)
