"""Levels to be held: the launch is recognised when the force has stayed above a level for a time.

    single threshold:  f > G for t_h
    double threshold:  begun by f > G1, held as long as f > G2, for t_h;    G1 ≥ G2

A sample that is not above ends the hold at once. Sources: "single threshold + time window" and "double threshold + time
window", which the published method names.
"""

from math import inf, isfinite

from uavsim.onboard.launch.axis import OneAxis
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import WINDOWS, Level, Panel, Second, one_axis
from uavsim.onboard.launch.levels import above, above_trigger, line, lines_of
from uavsim.onboard.plausible import MOST_FORCE


class DoubleThreshold(OneAxis):
    """Recognise a launch by a force that exceeds one level and then stays above a lower one.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    threshold : float
        G2, m/s². Strictly above counts.
    window : float
        t_h, s.
    trigger : float, optional
        G1 ≥ G2, m/s². None: equal to it, which is a single threshold.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    held : float
        Time above so far, s.
    level, count, total : int
        0: there are no windows.
    triggered : bool
        Whether the level is being held.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    The first sample of a hold counts one nominal period, each other one the time since its predecessor. A force that
    is NaN or implausible and a gap end the hold; the sample after a gap may begin one.

    Examples
    --------
    >>> detector = DoubleThreshold(1000.0, trigger=50.0, threshold=40.0, window=0.003)
    >>> [detector.step(0.001 * k, f, 0.0, -9.8) for k, f in enumerate((45.0, 51.0, 45.0, 41.0))]
    [False, False, False, True]
    """

    __slots__ = ("_threshold", "_trigger", "_window", "held")

    def __init__(
        self, rate: float, *, threshold: float, window: float, trigger: float | None = None, axis: Axis = "+x"
    ) -> None:
        self._trigger, self._threshold = threshold if trigger is None else trigger, threshold
        require(isfinite(self._trigger) and isfinite(threshold), "trigger and threshold must be finite")
        require(self._trigger >= threshold, "trigger must not be below threshold")
        require(0.0 < window < inf, "window must be above 0 s")
        self._window = window / ROUNDING
        super().__init__(rate, axis)

    def _clear(self) -> None:
        self.held = 0.0
        self.triggered = False

    def _take(self, f: float, dt: float, late: bool) -> bool:
        if self.triggered and not late and self._threshold < f < MOST_FORCE:
            self.held += dt
        elif self._trigger < f < MOST_FORCE:
            self.held = self._period
            self.triggered = True
        else:
            self.held = 0.0
            self.triggered = False
            return False
        return self.held >= self._window

    @property
    def window(self) -> float:
        """Time to be held, s."""
        return self._window

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        return Loop(_loop, (self._trigger, self._threshold, self._window, self._period), y=(0, 0))


class SingleThreshold(DoubleThreshold):
    """Recognise a launch by a force that stays above one level.

    Parameters
    ----------
    rate, threshold, window, axis
        As of `DoubleThreshold`, whose levels are equal here.
    """

    __slots__ = ()

    def __init__(self, rate: float, *, threshold: float, window: float, axis: Axis = "+x") -> None:
        super().__init__(rate, threshold=threshold, window=window, axis=axis)


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SingleThreshold`, `DoubleThreshold`: p trigger, threshold, window, period; x held; y[1] whether held."""
    trigger, threshold, window, period = p
    held, holding, alarms = x[0], y[1] != 0, 0
    for i in range(f.size):
        v = wide(f[i])
        if not holding:
            if not trigger < v < MOST_FORCE:
                continue
            holding, held = True, period
        elif threshold < v < MOST_FORCE:
            held += (k0 + i) / rate - (k0 + i - 1) / rate
        else:
            holding, held = False, 0.0
            continue
        if held >= window:
            holding, held = False, 0.0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[1] = held, holding
    return alarms


HELD = Panel("held, ms", (("time held", "held"), ("time to be held", "window")), 1e-3)

one_axis(
    "single-threshold",
    SingleThreshold,
    reads=("threshold", "window"),
    level=Level("threshold"),
    second=Second("window", WINDOWS),
    need=above,
    lines=line,
    panels=(HELD,),
)
one_axis(
    "double-threshold",
    DoubleThreshold,
    reads=("threshold", "trigger", "window"),
    level=Level("threshold", beside=("trigger",)),
    second=Second("window", WINDOWS),
    need=above_trigger,
    lines=lines_of,
    panels=(HELD,),
)
