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

At rates below 111 Hz h_min is what one sample adds, so that two are needed, down to 62 Hz, where it has reached h_max.
It begins rough, with h_max, so that nothing is decided soon before it is known to be smooth, and what is odd about a
sample (NaN, a shock) raises the limit. m follows at a bounded rate, so that a shock is forgotten soon. Sources: as
`cusum`; the exponent is Lorden's, Ann. Math. Statist. 42 (1971) 1897; the limit's rule and its numbers are this
project's, tuned on other seeds than those it is judged on.
"""

from math import inf, isfinite

from uavsim.onboard.launch.axis import GRAVITY, OneAxis
from uavsim.onboard.launch.detector import GAP_PERIODS, ROUNDING, Axis, require
from uavsim.onboard.plausible import MOST_FORCE


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
        h_min and h_max, m/s; 9 and 16 g·ms. h_min is at least what one sample adds, as far as h_max allows.
    gain : float
        κ, limit over roughness, s.
    mean, memory : float
        τ_m and τ_r, s. The memory is at least three nominal periods.
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
        axis: Axis = "+x",
    ) -> None:
        require(isfinite(reference), "reference must be finite")
        require(all(0.0 < x < inf for x in (rise, fall, limit, gain)), "rise, fall, limit and gain must be above 0")
        require(limit <= highest < inf, "highest must not be below limit")
        require(all(0.0 < x < inf for x in (mean, memory)), "mean and memory must be above 0 s")
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        self._reference, self._rise, self._fall = reference, rise, -fall
        alone = min(rise / rate, highest)  # what one sample adds
        self._least, self._highest = max(limit, alone) * ROUNDING, highest * ROUNDING  # reached is not passed
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
