"""Time stamps of a log brought to times that rise: what wraps is unwrapped, what is coarse spread, what resets cut.

Stamps are those of the device that wrote them. A counter of k bits wraps at 2^k steps, a time of day at 86 400 s; a
clock that begins anew after a reboot is another clock; a stamp that alone lies behind those around it is a wrong one.
Stamps with a coarser step than the readings have come in groups of equal ones, whose readings follow each other.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from uavsim.logs.recording import Array

Rows = NDArray[np.intp]

BITS = (16, 24, 31, 32)  # of counters that wrap
DAY, WEEK = 86_400.0, 604_800.0  # s, at which times of day, and of the week of GPS, begin anew
NEAR_WRAP = 100.0  # median intervals within which a wrap is passed
FEW_ASTRAY = 3  # rows in a row whose stamps may be wrong by anything
MOST_ASTRAY, MOST_BACK = 20, 1.0  # rows in a row that may lie behind one before them, and by how much, s
MOST_LEFT_OUT = 0.1  # share of rows that may be left out for their stamps: beyond, it is no time
FEWEST = 10  # readings in a part, and in a log
MOST_CUTS = 200  # clocks in a log: beyond, it is no time
COARSE = 0.2  # share of rows with the stamp of the row before, from which stamps are coarse and no row is twice
JUMP = 60.0  # s between two readings, from which each jump is told by itself
SKIPPED, SKIPPED_FOR = 5.0, 0.1  # median intervals, and s, between two readings, from which they jump
CHANGED = 1.4  # ratio of median intervals from which the rate changes; real oscillators keep 1.1
STRETCHES, STRETCH = 40, 40  # into which a log is cut to see that, and least rows of each


@dataclass(slots=True, eq=False)
class Stamped:
    """Rows with their times.

    Attributes
    ----------
    rows : numpy.ndarray
        Rows of the table that are kept.
    t : numpy.ndarray
        Their times, s, strictly rising within a part.
    cuts : list of int
        Places in both at which a part begins.
    remarks : list of str
    added : float
        What the last stamp was raised by, s, for the counter had wrapped.
    """

    rows: Rows
    t: Array
    cuts: list[int] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    added: float = 0.0


class BackwardsError(ValueError):
    """Times that run backwards: where, and from when to when."""

    def __init__(self, row: int, before: float, after: float) -> None:
        super().__init__(f"time runs backwards: {after:.10g} s comes after {before:.10g} s (row {row + 1})")


def stamped(stamps: Array, step: float, values: Array, *, of_day: bool = False) -> Stamped:
    """Bring stamps to times that rise.

    Parameters
    ----------
    stamps
        s, NaN where there is none.
    step
        What one step of the column is, s; 1 for one in seconds.
    values
        Shape (n, m): what each row holds besides, by which rows that are there twice are told.
    of_day
        Whether they are times of day.

    Raises
    ------
    BackwardsError
        If they are no times.
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    found = Stamped(rows, stamps[rows])
    if rows.size < stamps.size:
        found.remarks.append(f"{stamps.size - rows.size} rows have no time and are left out")
    if rows.size > 1:
        _unwrap(found, step, of_day=of_day)
        _put_in_order(found)
        _spread(found, values)
        _look_at_rates(found)
    return found


def _usual(t: Array) -> float:
    """Median interval of those that rise, s; 0 if there is none."""
    step = np.diff(t)
    step = step[step > 0.0]
    return float(np.median(step)) if step.size else 0.0


def _unwrap(of: Stamped, step: float, *, of_day: bool) -> None:
    """Add what a counter lost where it wrapped."""
    usual = _usual(of.t)
    back = np.flatnonzero(np.diff(of.t) < 0.0)
    if not back.size or usual == 0.0:
        return
    turns = [(step * 2.0**bits, f"{bits} bits") for bits in BITS] if step != 1.0 or _is_whole(of.t) else []
    turns += [(DAY, "a day"), (WEEK, "a week")] if of_day or of.t.max() <= WEEK else []
    added = np.zeros(of.t.size)
    for at in back:
        before, after = of.t[at], of.t[at + 1]
        for turn, name in turns:
            if before < turn * (1.0 + 1e-9) and after >= 0.0 and 0.0 < after + turn - before <= NEAR_WRAP * usual:
                added[at + 1 :] += turn
                of.remarks.append(f"the clock wraps at {name} ({turn:.10g} s) after {before:.10g} s and is unwrapped")
                break
    of.t = of.t + added
    of.added = float(added[-1])


def _is_whole(t: Array) -> bool:
    return bool((t == np.floor(t)).all())


def _put_in_order(of: Stamped) -> None:
    """Leave out stamps that are only wrong, and cut where a clock begins anew."""
    keep = np.ones(of.t.size, bool)
    cuts: list[int] = []
    back = np.flatnonzero(np.diff(of.t) < 0.0).tolist()
    usual = _usual(of.t)
    for place in back:
        following, begin = place + 1, cuts[-1] if cuts else 0
        kept = begin + np.flatnonzero(keep[begin:following])
        if not keep[following] or not kept.size or of.t[following] > of.t[kept[-1]]:
            continue
        last = int(kept[-1])
        if behind := _behind(of.t, last, following):
            keep[following : following + behind] = False
        elif ahead := _ahead(of.t, begin, last, following, usual):
            keep[last - ahead + 1 : last + 1] = False
        else:
            cuts.append(following)
        if len(cuts) > MOST_CUTS:
            break
    left_out = int(np.count_nonzero(~keep))
    if (
        left_out > max(1.0, MOST_LEFT_OUT * of.t.size)
        or (cuts and of.t.size < FEWEST * len(cuts))
        or len(cuts) > MOST_CUTS
    ):
        row = int(back[0])
        raise BackwardsError(int(of.rows[row]) + 1, float(of.t[row]), float(of.t[row + 1]))
    if left_out:
        first = int(np.argmin(keep))
        of.remarks.append(
            f"{left_out} rows with a stamp out of order are left out, the first at {of.t[first]:.10g} s (row "
            f"{of.rows[first] + 1})"
        )
    if left_out or cuts:
        _cut(of, keep, cuts)


def _cut(of: Stamped, keep: NDArray[np.bool_], cuts: list[int]) -> None:
    """Keep rows, in parts that are long enough."""
    parts: list[Rows] = []
    for start, end in pairwise((0, *cuts, of.t.size)):
        part = start + np.flatnonzero(keep[start:end])
        if cuts and part.size < FEWEST:
            of.remarks.append(f"a part of {part.size} readings between two resets of the clock is left out")
        else:
            parts.append(part)
    for part, after in pairwise(parts):
        of.remarks.append(
            f"reset: the clock goes from {of.t[part[-1]]:.10g} s back to {of.t[after[0]]:.10g} s; the log is cut there "
            "and each part replayed by itself"
        )
    chosen = np.concatenate(parts)
    of.cuts = np.cumsum([part.size for part in parts])[:-1].tolist()
    of.t, of.rows = of.t[chosen], of.rows[chosen]


def _behind(t: Array, last: int, following: int) -> int:
    """How many stamps lie behind one before them, if they are few and the clock goes on from there; else 0."""
    some = t[following : following + MOST_ASTRAY + 1]
    caught = np.flatnonzero(some > t[last])
    if not caught.size:
        return 0
    few = caught[0] <= FEW_ASTRAY or t[last] - some[: caught[0]].min() <= MOST_BACK
    return int(caught[0]) if few else 0


def _ahead(t: Array, begin: int, last: int, following: int, usual: float) -> int:
    """How many stamps up to one jumped ahead of those around them; 0 if the clock went back."""
    for many in range(1, min(FEW_ASTRAY, last - begin) + 1):
        before = t[last - many]
        if before < t[following] <= before + NEAR_WRAP * usual:
            return many
    return 0


def _spread(of: Stamped, values: Array) -> None:
    """Leave out rows that are there twice; spread rows over coarse stamps."""
    same = np.diff(of.t) == 0.0
    if of.cuts:
        same[np.array(of.cuts) - 1] = False
    if not same.any():
        return
    held = values[of.rows]
    equal = np.all((held[1:] == held[:-1]) | (np.isnan(held[1:]) & np.isnan(held[:-1])), axis=1) & same
    if np.count_nonzero(same & ~equal) < COARSE * same.size:
        _keep(of, np.concatenate(([True], ~same)))
        of.remarks.append(f"{np.count_nonzero(same)} rows have the time of the row before")
        return
    starts = np.flatnonzero(np.concatenate(([True], ~same)))
    counts = np.diff(np.append(starts, of.t.size))
    begin = of.t[starts]
    reach = np.diff(begin, append=np.nan)
    usual = float(np.median(reach[reach > 0.0])) if (reach > 0.0).any() else 0.0
    each = usual / float(np.median(counts))
    reach = np.where((reach > 0.0) & (reach <= 1.5 * usual), reach, np.minimum(each * counts, usual))
    place = np.arange(of.t.size) - np.repeat(starts, counts)
    before = of.t
    of.t = np.repeat(begin, counts) + place * np.repeat(reach / counts, counts)
    rises = np.diff(of.t) > 0.0
    rises[np.array(of.cuts, int) - 1] = True
    if not rises.all():  # finer than a double is at that time, or all stamps are the same
        of.t = before
        _keep(of, np.concatenate(([True], ~same)))
        of.remarks.append(f"{np.count_nonzero(same)} rows have the time of the row before")
        return
    of.remarks.append(
        f"stamps are coarse: {np.median(counts):.3g} rows have the same; they are spread over the {usual:.4g} s up to "
        "the next stamp"
    )


def _keep(of: Stamped, keep: NDArray[np.bool_]) -> None:
    place = np.cumsum(keep)
    of.cuts = [int(place[cut - 1]) for cut in of.cuts]
    of.t, of.rows = of.t[keep], of.rows[keep]


def _look_at_rates(of: Stamped) -> None:
    """Tell jumps of the clock; cut where the rate changes for good."""
    step = np.diff(of.t)
    usual = _usual(of.t)
    _tell_jumps(of, step, usual)
    size = max(STRETCH, of.t.size // STRETCHES)
    if of.t.size < 2 * size:
        return
    edges = list(range(0, of.t.size - size + 1, size))
    rates = [(start, _usual(of.t[start : start + size + 1])) for start in edges]
    changes: list[tuple[int, float, float]] = []
    now = rates[0][1]
    for (start, here), (_, after) in zip(rates[1:], [*rates[2:], rates[-1]], strict=True):  # two stretches say so
        slower = min(here, after) > CHANGED * now
        if min(now, here, after) > 0.0 and (slower or max(here, after) * CHANGED < now):
            at = _changing(of.t, max(0, start - size), min(of.t.size, start + size), now, after)
            changes.append((at, now, after))
            now = after
    if not changes or len(changes) > MOST_CUTS:
        return
    for at, before, after in changes[:3]:
        of.remarks.append(
            f"rate changes from {1.0 / before:.4g} to {1.0 / after:.4g} Hz at {of.t[at]:.10g} s: the log is cut there "
            "and each part replayed at its own rate"
        )
    of.cuts = sorted({*of.cuts, *(at for at, _, _ in changes if FEWEST <= at <= of.t.size - FEWEST)})


def _tell_jumps(of: Stamped, step: Array, usual: float) -> None:
    """Tell where the clock jumps forward: the longest by themselves, the others together."""
    skips = np.flatnonzero(step > max(SKIPPED_FOR, SKIPPED * usual))
    skips = np.setdiff1d(skips, np.array(of.cuts, int) - 1)
    far = skips[step[skips] > max(JUMP, NEAR_WRAP * usual)][:3]
    for at in far:
        of.remarks.append(
            f"jump: from {of.t[at]:.10g} to {of.t[at + 1]:.10g} s there are no readings, or the clock was set forward"
        )
    rest = np.setdiff1d(skips, far)
    if rest.size:
        most = rest[int(np.argmax(step[rest]))]
        many = f" {rest.size} times" if rest.size > 1 else ""
        which = ", the longest" if many else ""
        of.remarks.append(
            f"jump: the stamps jump forward{many}{which} by {step[most]:.4g} s from {of.t[most]:.10g} to "
            f"{of.t[most + 1]:.10g} s: readings are missing, or the clock was set"
        )


def _changing(t: Array, start: int, end: int, before: float, after: float) -> int:
    """The row at which the interval goes from one to another."""
    step = np.diff(t[start:end])
    is_after = np.abs(np.log(np.maximum(step, 1e-12) / after)) < np.abs(np.log(np.maximum(step, 1e-12) / before))
    gain = np.cumsum(np.where(is_after, -1, 1))
    return start + 1 + int(np.argmax(gain))
