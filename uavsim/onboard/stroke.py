"""Whether what was recognised is a launch: the end of the stroke, and the speed gained until then.

f is the specific force along the launch axis, m/s², f₀ its mean on the rail, which holds gravity and the
accelerometer's offset. From the recognition at t₀ on

    v(t) = ∫ (f - f₀) dt                                              m/s, the speed gained
    the stroke is over when a mean of f - f₀ over a short time has stayed below a level for a hold
    it was a launch where v is then at least a least speed; a knock or a drop must not open the wings

f₀ is the mean of a block of 0.5 s. The block before the last whole one is used, for the last one may hold the beginning
of a stroke that has not been recognised yet; before there are two, it is that of the first, or 0.

The rule stands twice: `Stroke` is what flies, `follow` takes the same decisions, to the last bit, over the array of a
record that is sampled regularly, a hundred times as fast. With it a detector and this rule together are judged by hours
of disturbances (`uavsim.studies.wing_commands`).
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import compiled, wide
from uavsim.onboard.plausible import MOST_FORCE

LONGEST_STEP = 0.02  # s; a gap between readings counts as no more than this in an integral
RAIL_BLOCK = 0.5  # s, over which the mean on the rail is taken


class Stroke:
    """What follows a recognition, reading by reading, and the mean on the rail before it.

    Parameters
    ----------
    level : float
        The stroke is over when the short mean of f - f₀ has stayed below this, m/s², ...
    mean : float
        ... taken over this time, s, ...
    hold : float
        ... for this time, s.
    rate : float
        Nominal readings a second, Hz; sets how many the short mean holds.

    Attributes
    ----------
    speed_gain : float
        v since the recognition, m/s.
    rail_mean : float
        f₀, m/s².
    """

    __slots__ = (
        "_block_count",
        "_block_start",
        "_block_sum",
        "_hold",
        "_last",
        "_last_block",
        "_level",
        "_quiet_since",
        "_recent",
        "_samples",
        "rail_mean",
        "speed_gain",
    )

    def __init__(self, level: float, mean: float, hold: float, rate: float) -> None:
        self._level, self._hold = level, hold
        self._samples = samples_of(mean, rate)
        self._recent: deque[float] = deque(maxlen=self._samples)
        self._block_start: float | None = None
        self._block_sum, self._block_count = 0.0, 0
        self._last_block: float | None = None
        self.rail_mean = 0.0
        self._last = 0.0
        self.speed_gain = 0.0
        self._quiet_since: float | None = None

    def rest(self, t: float, f: float) -> None:
        """Take a reading on the rail, m/s², while no launch is recognised."""
        if not -MOST_FORCE < f < MOST_FORCE:
            return
        if self._block_start is None:
            self._block_start = t
        elif t - self._block_start >= RAIL_BLOCK and self._block_count:
            mean = self._block_sum / self._block_count
            self.rail_mean = mean if self._last_block is None else self._last_block
            self._last_block = mean
            self._block_start, self._block_sum, self._block_count = t, 0.0, 0
        self._block_sum += f
        self._block_count += 1

    def begin(self, t: float) -> None:
        """Be told that a launch has been recognised with the reading at `t`, s."""
        self._last = t
        self.speed_gain = 0.0
        self._quiet_since = None
        self._recent.clear()

    def follow(self, t: float, f: float) -> bool:
        """Take a reading after the recognition, m/s²; True on the one at which the stroke is over."""
        if not -MOST_FORCE < f < MOST_FORCE:
            return False
        above = f - self.rail_mean
        self.speed_gain += above * min(t - self._last, LONGEST_STEP)
        self._last = t
        recent = self._recent
        recent.append(above)
        total = 0.0
        for one in recent:  # not sum(), which from Python 3.12 on rounds otherwise than the loop below
            total += one
        if len(recent) < self._samples or total >= self._level * len(recent):
            self._quiet_since = None
        elif self._quiet_since is None:
            self._quiet_since = t
        elif t - self._quiet_since >= self._hold:
            return True
        return False

    def rest_again(self) -> None:
        """Be told that it was none: the next reading is one on the rail and begins a block."""
        self._block_start, self._block_sum, self._block_count = None, 0.0, 0

    def step_of_the_clock(self, step: float) -> None:
        """Move the times that are kept by a step of the clock, s."""
        self._last += step
        if self._block_start is not None:
            self._block_start += step
        if self._quiet_since is not None:
            self._quiet_since += step


def samples_of(mean: float, rate: float) -> int:
    """Readings that the short mean holds: a time, s, at a rate, Hz."""
    return max(1, round(mean * rate))


# -- over arrays -----------------------------------------------------------------------------------------------------


@compiled
def follow(
    f: NDArray[np.float64],
    rest: int,
    recognised: int,
    rate: float,
    level: float,
    hold: float,
    recent: NDArray[np.float64],
    state: NDArray[np.float64],
) -> int:
    """Follow what was recognised at a sample of a record to the end of its stroke: `Stroke.rest`, then `Stroke.follow`.

    Parameters
    ----------
    f : ndarray
        Specific force along the launch axis, shape (n,), m/s²; sample k at k / rate. Without a JIT a list is faster.
    rest, recognised : int
        Samples: the first on the rail since the computer began or rearmed, and that of the recognition.
    rate : float
        Samples a second, Hz.
    level, hold : float
        Of `Stroke`, m/s² and s.
    recent : ndarray
        Room for the short mean, twice as many numbers as it holds (`samples_of`).
    state : ndarray
        Shape (3,): rail mean, and mean of the last whole block (NaN before there is one), m/s², as `Stroke` has them at
        `rest`, which are kept up; and the speed gained, m/s, which is returned in it.

    Returns
    -------
    int
        Sample at which the stroke is over; -1 if it is not over in the record.
    """
    rail, last_block = state[0], state[1]
    start, total, count = -1.0, 0.0, 0
    for k in range(rest, recognised + 1):
        v = wide(f[k])
        if not -MOST_FORCE < v < MOST_FORCE:
            continue
        t = k / rate
        if start < 0.0:
            start = t
        elif t - start >= RAIL_BLOCK and count > 0:
            mean = total / count
            rail = mean if last_block != last_block else last_block
            last_block = mean
            start, total, count = t, 0.0, 0
        total += v
        count += 1
    state[0], state[1] = rail, last_block

    samples, held, at, gain = len(recent) // 2, 0, 0, 0.0
    last, quiet = recognised / rate, -1.0
    for k in range(recognised + 1, len(f)):
        v = wide(f[k])
        if not -MOST_FORCE < v < MOST_FORCE:
            continue
        t = k / rate
        above = v - rail
        step = t - last
        gain += above * (step if step < LONGEST_STEP else LONGEST_STEP)
        last = t
        recent[at] = recent[at + samples] = above  # twice, so that the last ones stand in a row, oldest first
        at = at + 1 if at + 1 < samples else 0
        held += 1
        short = 0.0
        if held >= samples:
            for i in range(at, at + samples):
                short += recent[i]
        if held < samples or short >= level * samples:
            quiet = -1.0
        elif quiet < 0.0:
            quiet = t
        elif t - quiet >= hold:
            state[2] = gain
            return k
    state[2] = gain
    return -1
