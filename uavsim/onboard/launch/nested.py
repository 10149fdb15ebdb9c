"""Multi-level time window with threshold: the published method.

A sample above G1 (`trigger`) at t₀ opens nested windows, the l-th holding the
first l·n samples from t₀ on, the sample at t₀ included. N counts those above G2 (`threshold`). At the end of each
window, l = 1 … i (`levels`), the launch is recognised if

    N / (l·n) ≥ k₁          (`ratio`; compared in whole numbers, so that 0.8 of 10 is 8)

If the last window fails, the next sample above G1 may open new ones. Windows are times: where samples are lost, the
next one stands for the periods since the last (`detector.periods`) and is counted that many times. Source: the
published method that this project tests (its multi-level time window and threshold), with G1 ≥ G2 and each signed body
axis counted on its own.

Thresholding before counting makes the level depend on the noise: with k₁ = 0.8 the force must exceed G2 by 0.84 σ of
white noise to be recognised half of the time. Shocks shorter than k₁·n samples, ring included, are not recognised
unless others follow; a launch must stay above G2 for longer than that.
"""

from fractions import Fraction
from math import inf, isfinite
from typing import TYPE_CHECKING, Literal, get_args

from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import Axis, periods, require
from uavsim.onboard.launch.kinds import KINDS, WINDOWS, Kind, Level, Second, Window
from uavsim.onboard.launch.levels import above_trigger, lines_of
from uavsim.onboard.plausible import MOST_FORCE
from uavsim.onboard.stamps import Stamps, jump

if TYPE_CHECKING:
    from uavsim.onboard.launch.settings import DetectorSettings


class MultiLevelWindow:
    """Recognise a launch by the share of samples above a threshold in nested windows.

    Parameters
    ----------
    trigger, threshold : float
        G1 and G2, m/s²; trigger ≥ threshold. A sample counts if it is strictly above.
    samples : int
        n, samples of the first window.
    levels : int
        i, number of windows.
    ratio : float
        k₁, the share of samples above the threshold at which the launch is recognised, 0 < k₁ ≤ 1.
    axes : tuple of str, or "any"
        Signed body axes, each with a counter of its own, or the published rule to the letter: one counter of the
        samples in which the magnitude along any axis exceeds.
    rearm : bool
        Whether an axis may trigger again after its last window failed; if not it is dead until `reset`.
    period : float, optional
        Time that a sample stands for, s. One that comes later, up to `GAP_PERIODS` of them, is counted once for each; a
        longer gap abandons the windows, and the sample after it is looked at as if there had been none. None: every
        sample counts once, whatever its time, and none is too far ahead of the last.

    Attributes
    ----------
    level, count, total : int
        Window being filled (or just ended), samples in it above the threshold, and samples in it, of the axis that is
        furthest; 0 while none is triggered.
    triggered : bool
        Whether a window is open or has recognised a launch.

    Raises
    ------
    ValueError
        Settings outside these bounds.

    Notes
    -----
    A sample that is NaN or implausible along an axis is one that does not exceed there. Which samples are left out for
    their times is said in `uavsim.onboard.stamps`; one that shows that the clock has taken a step comes after a gap.

    Examples
    --------
    >>> detector = MultiLevelWindow(trigger=45.0, threshold=45.0, samples=2, levels=2, ratio=0.75)
    >>> [detector.step(0.001 * k, fx, 0.0, -9.8) for k, fx in enumerate((3.0, 60.0, 40.0, 61.0, 62.0, 63.0))]
    [False, False, False, False, True, False]
    """

    __slots__ = (
        "_counters",
        "_idle",
        "_longest",
        "_lower",
        "_once",
        "_only_x",
        "_period",
        "_recognised",
        "_stamps",
        "_t",
        "_upper_x",
        "_upper_yz",
        "count",
        "level",
        "total",
        "triggered",
    )

    def __init__(
        self,
        *,
        trigger: float,
        threshold: float,
        samples: int,
        levels: int,
        ratio: float,
        axes: tuple[Axis, ...] | Literal["any"] = ("+x",),
        rearm: bool = True,
        period: float | None = None,
    ) -> None:
        require(isfinite(threshold) and isfinite(trigger), "trigger and threshold must be finite")
        require(trigger >= threshold, "trigger must not be below threshold")
        require(samples == int(samples) and levels == int(levels), "samples and levels must be whole numbers")
        require(samples >= 1 and levels >= 1, "samples and levels must be at least 1")
        require(0.0 < ratio <= 1.0, "ratio must be above 0 and at most 1")
        require(period is None or 0.0 < period < inf, "period must be above 0 s")
        if axes != "any":
            known = get_args(Axis)
            require(
                len(axes) == len(set(axes)) > 0 and all(axis in known for axis in axes),
                f'axes must be "any" or different ones of {", ".join(known)}',
            )
        self._period = inf if period is None else period
        self._once = 1.5 * self._period  # s; up to here a sample counts once
        self._stamps = Stamps(inf if period is None else jump(1.0 / period))
        self._longest = self._stamps.longest
        names: tuple[str, ...] = ("any",) if axes == "any" else axes
        self._counters = tuple(
            _Counter(
                name,
                trigger=trigger,
                threshold=threshold,
                samples=samples,
                levels=levels,
                ratio=ratio,
                rearm=rearm,
            )
            for name in names
        )
        # While every counter is idle, a sample inside these bounds triggers none: most samples need no more than that.
        limit = {name: trigger if name in names or axes == "any" else inf for name in get_args(Axis)}
        self._only_x = names == ("+x",)
        self._upper_x = limit["+x"]
        self._upper_yz = limit["+y"], limit["+z"]
        self._lower = -limit["-x"], -limit["-y"], -limit["-z"]
        self.reset()

    def reset(self) -> None:
        """Forget everything: ready for the first sample, whatever its time."""
        for counter in self._counters:
            counter.clear()
        self._t = -inf
        self._recognised = False
        self._idle = True
        self.level = self.count = self.total = 0
        self.triggered = False

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; True on the one at which the launch is recognised, then False until `reset`.

        Parameters
        ----------
        t : float
            Time of the sample, s.
        fx, fy, fz : float
            Specific force in body axes, m/s².
        """
        if not 0.0 < t - self._t <= self._longest:
            if not self._stamps.admit(t, self._t):
                return False
            self._t = -inf  # as if there had been none before
        if self._idle and fx <= self._upper_x and (self._only_x or self._inside(fx, fy, fz)):
            self._t = t
            return False
        return self._advance(t, (fx, fy, fz))

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        one, axes = self._counters[0], len(self._counters)
        q = one._samples, one._levels, one._needed, one._of, int(one._rearm)
        rule = _loop if axes == 1 else _loop_of_axes
        return Loop(rule, (one._trigger, one._threshold), q, y=(0,) * (1 + 4 * axes))

    def _inside(self, fx: float, fy: float, fz: float) -> bool:
        (y, z), (lower_x, lower_y, lower_z) = self._upper_yz, self._lower
        return fx >= lower_x and lower_y <= fy <= y and lower_z <= fz <= z

    def _advance(self, t: float, force: tuple[float, float, float]) -> bool:
        dt = t - self._t
        self._t = t
        if self._recognised:
            return False
        if dt > self._once and self._catch_up(dt, force):
            return True
        return self._count(force)

    def _catch_up(self, dt: float, force: tuple[float, float, float]) -> bool:
        """Count the sample for those that were lost before it; after a gap abandon the windows instead."""
        missed = periods(dt, self._period) - 1
        if missed < 0:
            for counter in self._counters:
                counter.abandon()
        return any(self._count(force) for _ in range(missed))

    def _count(self, force: tuple[float, float, float]) -> bool:
        busy = 0
        furthest = self._counters[0]
        for counter in self._counters:
            if counter.add(force):
                self._recognised = True
                furthest = counter
                break
            busy += counter.total
            if counter.total > furthest.total:
                furthest = counter
        self._idle = busy == 0
        self.level, self.count, self.total = furthest.level, furthest.count, furthest.total
        self.triggered = furthest.triggered
        return self._recognised


class _Counter:
    """The nested windows of one signed axis ("any": of the largest magnitude)."""

    __slots__ = (
        "_axis",
        "_dead",
        "_levels",
        "_needed",
        "_of",
        "_rearm",
        "_samples",
        "_sign",
        "_threshold",
        "_trigger",
        "count",
        "level",
        "total",
        "triggered",
    )

    def __init__(
        self,
        name: str,
        *,
        trigger: float,
        threshold: float,
        samples: int,
        levels: int,
        ratio: float,
        rearm: bool,
    ) -> None:
        self._axis = None if name == "any" else "xyz".index(name[1])
        self._sign = -1.0 if name[0] == "-" else 1.0
        self._trigger, self._threshold = trigger, threshold
        self._samples, self._levels = samples, levels
        self._needed, self._of = Fraction(ratio).limit_denominator().as_integer_ratio()
        self._rearm = rearm
        self.clear()

    def clear(self) -> None:
        self._dead = False
        self.abandon()

    def abandon(self) -> None:
        """Give up the windows that are open."""
        self.level = self.count = self.total = 0
        self.triggered = False

    def add(self, force: tuple[float, float, float]) -> bool:
        """Count one sample; True if it ends a window with a sufficient share above the threshold."""
        f = _largest(force) if self._axis is None else self._sign * force[self._axis]
        if not self.triggered:
            if self._dead or not self._trigger < f < MOST_FORCE:
                self.level = self.count = self.total = 0  # a window that failed is shown until the sample after it
                return False
            self.triggered = True
            self.level, self.count, self.total = 1, 1, 1
        else:
            if self.total == self.level * self._samples:
                self.level += 1
            self.total += 1
            if self._threshold < f < MOST_FORCE:
                self.count += 1
        if self.total < self.level * self._samples:
            return False
        if self.count * self._of >= self._needed * self.total:
            return True
        if self.level == self._levels:
            self.triggered = False
            self._dead = not self._rearm
        return False


def _largest(force: tuple[float, float, float]) -> float:
    """Largest magnitude of those that are plausible; 0 without any."""
    largest = 0.0
    for f in force:
        if largest < abs(f) < MOST_FORCE:
            largest = abs(f)
    return largest


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`MultiLevelWindow` on one axis: p trigger, threshold; q n, i, k₁ as a fraction, rearm; y open, level, N, total.

    Counts samples and knows no time. y[1] is 2 where the axis is dead.
    """
    trigger, threshold = p
    samples, levels, needed, of, rearm = q
    opened, level, count, total, alarms = y[1], y[2], y[3], y[4], 0
    for i in range(f.size):
        v = wide(f[i])
        if opened != 1:
            if opened == 2 or not trigger < v < MOST_FORCE:
                continue
            opened, level, count, total = 1, 1, 1, 1
        else:
            if total == level * samples:
                level += 1
            total += 1
            count += threshold < v < MOST_FORCE
        if total < level * samples:
            continue
        if count * of >= needed * total:
            opened = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
        elif level == levels:
            opened = 0 if rearm else 2
    y[1], y[2], y[3], y[4] = opened, level, count, total
    return alarms


@compiled
def _loop_of_axes(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`MultiLevelWindow` on several axes, f (axes, n): as the other, with four numbers of state an axis."""
    trigger, threshold = p
    samples, levels, needed, of, rearm = q
    axes, alarms = f.shape[0], 0
    for i in range(f.shape[1]):
        recognised = False
        for axis in range(axes):
            v = wide(f[axis, i])
            at = 1 + 4 * axis
            if y[at] != 1:
                if y[at] == 2 or not trigger < v < MOST_FORCE:
                    continue
                y[at : at + 4] = 1
            else:
                if y[at + 3] == y[at + 1] * samples:
                    y[at + 1] += 1
                y[at + 3] += 1
                y[at + 2] += threshold < v < MOST_FORCE
            if y[at + 3] < y[at + 1] * samples:
                continue
            if y[at + 2] * of >= needed * y[at + 3]:
                recognised = True
            elif y[at + 1] == levels:
                y[at] = 0 if rearm else 2
        if recognised:
            y[1:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    return alarms


def _build(settings: "DetectorSettings", rate: float) -> MultiLevelWindow:
    return MultiLevelWindow(
        trigger=settings.threshold if settings.trigger is None else settings.trigger,
        threshold=settings.threshold,
        samples=max(1, round(settings.window * rate)),
        levels=settings.levels,
        ratio=settings.ratio,
        axes=settings.axes,
        rearm=settings.rearm,
        period=1.0 / rate,
    )


KINDS.add(
    Kind(
        "multi-level-window",
        MultiLevelWindow,
        _build,
        reads=("threshold", "trigger", "window", "levels", "ratio", "rearm"),
        level=Level("threshold", beside=("trigger",)),
        second=Second("window", WINDOWS),
        need=above_trigger,
        lines=lines_of,
        window=lambda settings: Window(settings.levels, settings.ratio),
        many_axes=True,
        short="paper",
        ours=True,
    )
)
