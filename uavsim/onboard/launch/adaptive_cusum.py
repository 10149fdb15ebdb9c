"""Clipped cumulative sum whose limit follows the roughness of the force; what the packaged scenarios fly.

The sum is that of `cusum`, S = max(0, S + clip(f - c, -fall, +rise)·dt). It is held against a limit that is as low as
shocks allow while the force is smooth, and rises with noise and vibration:

    d = clip(f - m, ±d_max),      m ← m + min(1, dt/τ_m)·d,      r ← r + (|d| - r)·dt/τ_r
    recognised at  S > h,         h = clip(κ·r, h_min, h_max),   d_max = 2 h_max/κ

f is the force along the launch axis, m/s²; m its short mean (τ_m 2 ms) and r its roughness, the mean size of what is
left (τ_r 0.2 s), both m/s²; S and h are speeds, m/s. In white noise of deviation σ a sum with the drift -δ passes a
limit about as often as exp(-2 δ h/(σ² T)), T the sample's period: what is fast and safe at 0.3 g is unsafe at 1 g. So

    h_min   9 g·ms: one shock of 5 ms adds 5 g·ms, its ringing less, and two that touch no more than 10
    κ       15 ms: r = 0.9 g in noise of 1 g gives 13.4 g·ms, where a run on the centrifuge at 4.1 g passes c by noise
    h_max   16 g·ms: vibration of 2-3 g would ask for 19-22, more than a weak launch of 0.1 s adds

At rates below 222 Hz h_min is what two samples add, up to 10 g·ms, and below 100 Hz what one adds; so is h_max below
62 Hz. So one sample alone never decides, which in readings slower than shocks and vibration may be anything, nor do two
at 200 Hz, which a shock that was filtered before it was sampled fills. `confirm` = false leaves the limits as they are:
20 ms sooner at 50 Hz, at thousands of alarms an hour in vibration that was not filtered (`uavsim.studies.low_rates`).
It begins rough, with h_max, so that nothing is decided soon before it is known to be smooth, and what is odd about a
sample (NaN, a shock) raises the limit. m follows at a bounded rate, so that a shock is forgotten soon. Sources: as
`cusum`; the exponent is Lorden's, Ann. Math. Statist. 42 (1971) 1897; the limit's rule and its numbers are this
project's, tuned on other seeds than those it is judged on.
"""

from dataclasses import asdict, dataclass
from math import inf, isfinite
from typing import TYPE_CHECKING, Annotated, Any

from annotated_types import Interval

from uavsim.onboard.launch.axis import GRAVITY, OneAxis
from uavsim.onboard.launch.bounds import Force, Time
from uavsim.onboard.launch.compiled import Counts, Forces, Loop, Numbers, Reals, Wholes, compiled, wide
from uavsim.onboard.launch.detector import GAP_PERIODS, ROUNDING, Axis, require
from uavsim.onboard.launch.kinds import REFERENCES, WIDELY, Level, Need, Panel, Second, one_axis
from uavsim.onboard.plausible import MOST_FORCE

if TYPE_CHECKING:
    from uavsim.onboard.launch.settings import DetectorSettings

G_MS = 1e-3 * GRAVITY  # m/s in 1 g·ms
FILLED = 10.0 * G_MS  # m/s, what a shock adds that was filtered below 80 Hz: in 5 h of the mix at 200 Hz 9 are too few
BELOW = 0.1 * GRAVITY  # m/s², of a threshold that samples exceed: where the sum begins to grow instead


@dataclass(frozen=True, slots=True)
class AdaptiveCusumSettings:
    """Clipped cumulative sum whose limit follows the roughness, `kind = "adaptive-cusum"`.

    Attributes
    ----------
    reference : float, optional
        c, m/s². None: the detector's threshold less 0.1 g, by default 4.5 g.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    limit : float
        Least limit, m/s; over the rise it is the time that a launch takes. 0.08826 is 9 g·ms.
    highest : float
        Highest limit, m/s, not below the least. 0.1569 is 16 g·ms.
    gain : float
        Limit over roughness, s.
    mean : float
        Time constant of the short mean, s.
    memory : float
        Time constant of the roughness, s; at least three periods of the accelerometer are taken.
    confirm : bool
        Whether one sample alone never decides, which below 222 Hz raises the limits.
    """

    reference: Force | None = None
    rise: Force = 9.80665
    fall: Force = 14.71
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.08826
    highest: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.1569
    gain: Time = 0.015
    mean: Time = 0.002
    memory: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.2
    confirm: bool = True


class AdaptiveCusum(OneAxis):
    """Recognise a launch by the clipped sum of what exceeds a level, sooner where the force is smooth.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    reference : float
        c, m/s²; 4.5 g.
    rise, fall : float
        Bounds of what a sample adds and takes off, m/s²; 1 g and 1.5 g.
    limit, highest : float
        h_min and h_max, m/s; 9 and 16 g·ms, and at low rates more, if a sample has to be confirmed.
    gain : float
        κ, limit over roughness, s.
    mean, memory : float
        τ_m and τ_r, s. The memory is at least three nominal periods.
    confirm : bool
        Whether one sample alone never decides.
    axis : str
        Signed body axis that points along the launch.

    Attributes
    ----------
    sum : float
        S, m/s.
    roughness : float
        r, m/s².
    level, count, total : int
        0: there are no windows.
    triggered : bool
        Whether S is above 0.

    Raises
    ------
    ValueError
        Settings outside their bounds.

    Notes
    -----
    A force that is NaN or implausible takes off as much as no force does, is as rough as d_max and leaves the mean
    alone. A sample after a gap counts for three nominal periods; S, m and r are kept.

    Examples
    --------
    >>> detector = AdaptiveCusum(1000.0)
    >>> any(detector.step(0.001 * k, 3.0, 0.0, -9.8) for k in range(500))  # smooth: the limit is the least
    False
    >>> [detector.step(0.001 * k, 60.0, 0.0, -9.8) for k in range(500, 520)].index(True)  # nine only reach it
    9
    """

    __slots__ = (
        "_fall",
        "_follow",
        "_forget",
        "_gain",
        "_highest",
        "_least",
        "_mean",
        "_most",
        "_reference",
        "_rise",
        "roughness",
        "sum",
    )

    def __init__(
        self,
        rate: float,
        *,
        reference: float = 4.5 * GRAVITY,
        rise: float = 1.0 * GRAVITY,
        fall: float = 1.5 * GRAVITY,
        limit: float = 0.009 * GRAVITY,
        highest: float = 0.016 * GRAVITY,
        gain: float = 0.015,
        mean: float = 0.002,
        memory: float = 0.2,
        confirm: bool = True,
        axis: Axis = "+x",
    ) -> None:
        require(isfinite(reference), "reference must be finite")
        require(all(0.0 < x < inf for x in (rise, fall, limit, gain)), "rise, fall, limit and gain must be above 0")
        require(limit <= highest < inf, "highest must not be below limit")
        require(all(0.0 < x < inf for x in (mean, memory)), "mean and memory must be above 0 s")
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        self._reference, self._rise, self._fall = reference, rise, -fall
        alone = rise / rate if confirm else 0.0  # what one sample adds
        least = max(limit, alone, min(2.0 * alone, FILLED))
        self._least, self._highest = least * ROUNDING, max(highest, least) * ROUNDING  # reached is not passed
        self._gain, self._most = gain, 2.0 * highest / gain
        self._follow, self._forget = 1.0 / mean, 1.0 / max(memory, GAP_PERIODS * ROUNDING / rate)
        super().__init__(rate, axis)

    @property
    def limit(self) -> float:
        """What the sum is held against now, m/s."""
        return min(max(self._gain * self.roughness, self._least), self._highest)

    def _clear(self) -> None:
        self.sum = 0.0
        self.roughness = 0.5 * self._most
        self._mean = 0.0

    def _take(self, f: float, dt: float, late: bool) -> bool:
        away, weight, size = f - self._mean, dt * self._follow, self._most
        if -size <= away <= size:
            self._mean += away * weight if weight < 1.0 else away
            size = away if away > 0.0 else -away
        else:
            self._hurry(f, away, weight)
        self.roughness += (size - self.roughness) * (dt * self._forget)
        excess = f - self._reference
        if excess > self._rise:
            excess = self._rise if f < MOST_FORCE else self._fall
        elif not excess > self._fall:  # NaN too
            excess = self._fall
        total = self.sum + excess * dt
        if total > 0.0:
            self.sum = total
            self.triggered = True
            return total > self._least and total > self.limit
        self.sum = 0.0
        self.triggered = False
        return False

    def _hurry(self, f: float, away: float, weight: float) -> None:
        """Let the mean follow a force that is far from it, as fast as it may; one that is none leaves it alone."""
        if not -MOST_FORCE < f < MOST_FORCE:
            return
        step = self._most if weight >= 1.0 else self._most * weight
        if away > 0.0:
            self._mean += step
        else:
            self._mean -= step

    def loop(self) -> Loop:
        """Return the same rule over arrays."""
        numbers = self._reference, self._rise, self._fall, self._least, self._highest, self._gain, self._most
        times = self._follow, self._forget, self._period
        return Loop(_loop, numbers + times, x=(0.0, 0.5 * self._most, 0.0))


@compiled
def _loop(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`AdaptiveCusum`: p as it is built, and the period; x sum, roughness, mean."""
    reference, rise, fall, least, highest, gain, most, follow, forget, period = p
    total, rough, mean = x[0], x[1], x[2]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        away, weight, size = v - mean, dt * follow, most
        if abs(away) <= most:
            mean += away * weight if weight < 1.0 else away
            size = abs(away)  # without a branch that noise would make unpredictable
        elif -MOST_FORCE < v < MOST_FORCE:
            mean += (most if away > 0.0 else -most) * min(1.0, weight)
        rough += (size - rough) * (dt * forget)
        excess: float = v - reference
        if total == 0.0 and not excess > 0.0:
            continue
        if excess > rise:
            excess = rise if v < MOST_FORCE else fall
        elif not excess > fall:  # NaN too
            excess = fall
        total += excess * dt
        if not total > 0.0:
            total = 0.0
        elif total > least and total > min(max(gain * rough, least), highest):
            total, rough, mean, first = 0.0, 0.5 * most, 0.0, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], y[0] = total, rough, mean, first
    return alarms


def reference(settings: "DetectorSettings") -> float:
    """Where the sum begins to grow, m/s²: its own setting, else as far below the threshold as `BELOW`."""
    own = settings.adaptive.reference
    return settings.threshold - BELOW if own is None else own


def _arguments(settings: "DetectorSettings") -> dict[str, Any]:
    return asdict(settings.adaptive) | {"reference": reference(settings)}


def _need(settings: "DetectorSettings", _: float) -> Need:
    own, time = settings.adaptive.reference, settings.adaptive.limit / settings.adaptive.rise
    if own is None:
        return Need("threshold", settings.threshold, "adaptive.limit", time)
    return Need("adaptive.reference", own, "adaptive.limit", time)


def _second(settings: "DetectorSettings") -> Second:
    """The threshold has no part in it where the reference is set."""
    return Second("threshold" if settings.adaptive.reference is None else "adaptive.reference", REFERENCES, True)


one_axis(
    "adaptive-cusum",
    AdaptiveCusum,
    group="adaptive",
    reads=("threshold",),
    arguments=_arguments,
    level=Level("adaptive.limit", "m/s", WIDELY, ("adaptive.highest", "adaptive.gain")),
    second=_second,
    need=_need,
    lines=lambda settings: {"c": reference(settings)},
    panels=(
        Panel("S, g·ms", (("sum S", "sum"), ("limit h", "limit")), G_MS),
        Panel("r, g", (("roughness r of $f_x$", "roughness"),), GRAVITY, 0.8),
    ),
    short="adaptive",
)
