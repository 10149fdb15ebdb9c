"""The speed that the specific force has given, kept for a short while so that it can be asked for at any recent time.

    u(t) = ∫ f_x dt,        w(t) = Σ (σ_a·Δt)²

u is summed by the trapezoidal rule. w is the variance that the white noise of the readings, of standard deviation σ_a
each, has brought into u. It grows with time alone.

Where readings are missing, for five periods and more, and beyond the newest reading, u goes on with the mean of the
readings beside. w then grows as by unknown accelerations of 5 m/s² standard deviation that last for 2 s each.

A force at the end of the accelerometer's range has been clipped: it is at least so large, and nobody knows how much
larger. It is summed as it is read, and w grows as by an unknown acceleration of a fifth of the range that lasts as long
as the readings stay there.

After a step of the clock (`uavsim.onboard.stamps`) nothing from before can be asked for. The ring begins anew, and u
goes on.

The memory is fixed: the readings of the last `SIZE` periods, and the last `GAPS` gaps. Of older gaps the variance
stays.
"""

from collections import deque
from math import inf, nan

from uavsim.onboard.plausible import MOST_FORCE
from uavsim.onboard.stamps import Stamps, jump

SIZE = 1024  # readings that are kept, a second at 1 kHz: the replay of a launch asks for 0.3 s
GAPS = 16  # gaps whose places are remembered. More of them in a second is no accelerometer: w is known in all only
GAP = 5.0  # periods without a reading, from which on it is a gap; fewer are jitter. By hand
# standard deviations of a reading up to which it is plausible in flight, where heavy shaking makes more than the bound
# of a force of flight. By hand
NOISY = 10.0
CLIPPED = 0.2  # share of the range, by which a force may be beyond it (standard deviation). By hand
# m/s², what an acceleration that nobody has read may be, and s, for which it lasts: that of a strong pull-up in flight.
# By hand
GAP_SD, LASTS = 5.0, 2.0


class SpeedGained:
    """Ring of the last integrals of f_x, and the mean of −f_z.

    Parameters
    ----------
    sd : float
        White noise of one reading, m/s².
    rate : float
        Nominal rate of the readings, Hz.
    size : int
        How many are kept.
    lag : float
        Age of a reading at its time stamp, s.
    row : float
        How often a live accelerometer may repeat a number (`uavsim.onboard.repeats`). Beyond that its readings are
        missing ones until another comes.

    Attributes
    ----------
    newest : float
        Time stamp of the last reading taken, s; -inf before.
    steps : int
        How many steps the clock has taken.
    stuck : bool
        Whether it repeats a number for too long.
    """

    __slots__ = (
        "_beyond", "_clipped", "_f", "_first", "_gap", "_gaps", "_head", "_high", "_lag", "_lift", "_lifts", "_low",
        "_most", "_most_lift", "_old", "_rate", "_row", "_same", "_shake", "_size", "_stamps", "_sum", "_t",
        "_tear", "_u", "_white", "newest", "steps", "stuck",
    )  # fmt: skip

    def __init__(self, sd: float, rate: float, size: int = SIZE, lag: float = 0.0, row: float = inf) -> None:
        self._row, self._same, self.stuck = row, 0, False
        self._rate, self._size, self._lag = rate, size, lag
        self._gap = GAP / rate
        self._tear = 0.25 * (GAP_SD * self._gap) ** 2
        self._shake, self._most, self._most_lift = NOISY * sd, MOST_FORCE, MOST_FORCE
        self._white = sd * sd / rate
        self._t, self._u = [-inf] * size, [0.0] * size  # time stamps
        self._gaps: deque[tuple[float, float, float]] = deque(maxlen=GAPS)  # begin, end, variance
        self._head, self._sum, self._f = -1, 0.0, 0.0
        self._first, self.newest = inf, -inf
        self._old, self.steps, self._stamps = 0.0, 0, Stamps(jump(rate))
        self._lift, self._lifts = 0.0, 0
        self._clipped = 0.0  # s, for how long readings have been at an end
        self.end_at(-inf, inf)

    @property
    def oldest(self) -> float:
        """Instant of the oldest reading that is kept, s; inf without any."""
        oldest = self._t[self._head + 1 - self._size]
        return (oldest if oldest > -inf else self._first) - self._lag

    def add(self, t: float, fx: float, _fy: float = 0.0, fz: float = 0.0) -> None:
        """Take a reading; one that is NaN or implausible, or left out for its time stamp, is passed over."""
        if fx == self._f:
            self._same += 1
            if self._same >= self._row and self._low < fx < self._high:
                self.stuck = True
                return
        elif self._same:
            self._same, self.stuck = 0, False
        elapsed = t - self.newest
        if not (0.0 < elapsed <= self._gap and -self._most < fx < self._most):
            if not (-self._most < fx < self._most and self._stamps.admit(t, self.newest)):
                return
            elapsed = self._after_a_gap(t, fx)
        u = self._sum = self._sum + 0.5 * (self._f + fx) * elapsed
        if not self._low < fx < self._high:
            self._clip(t, elapsed)
        elif self._clipped:
            self._clipped = 0.0
        self._f, self.newest = fx, t
        self._lift -= fz
        self._lifts += 1
        head = self._head = (self._head + 1) % self._size
        self._t[head], self._u[head] = t, u

    def _clip(self, t: float, elapsed: float) -> None:
        """Note that a reading has been clipped: what is unknown in it is the same as in those before."""
        before = self._clipped
        self._clipped = before + elapsed
        if self._clipped > 0.0:
            gaps = self._gaps
            if len(gaps) == GAPS:
                self._old += gaps[0][2]
            gaps.append((t - elapsed, t, self._beyond**2 * (self._clipped**2 - before**2)))

    def _after_a_gap(self, t: float, fx: float) -> float:
        """Note what no reading tells of the time since the last; return that time, s: 0 after a step of the clock."""
        newest, gaps = self.newest, self._gaps
        elapsed = t - newest
        if 0.0 < elapsed <= self._stamps.longest:
            if len(gaps) == GAPS:
                self._old += gaps[0][2]
            gaps.append((newest, t, _unread(elapsed)))
            return elapsed
        if newest > -inf:
            self.steps += 1
            self._t, self._head, self._old = [-inf] * self._size, -1, 0.0
            gaps.clear()
        self._first, self._f = t, fx
        return 0.0

    def end_at(self, low: float, high: float) -> None:
        """Be told where readings end, m/s², the offset taken off: at an end they are clipped."""
        self._low, self._high = low, high
        self._beyond = CLIPPED * 0.5 * (high - low) if high - low < inf else 0.0

    def bound(self, most: float) -> None:
        """Be told the greatest plausible force, m/s²; in flight it is less than that of a launch."""
        self._most, self._most_lift = max(most, self._shake), most

    def torn(self, variance: float, time: float) -> bool:
        """Whether w has grown by so much, m²/s², in a time, s, that readings have been missing."""
        return variance > 4.0 * self._white * time + self._tear

    def lift(self) -> float:
        """Return the mean of −f_z since it was last asked for, m/s²; NaN without one that is plausible."""
        lift, lifts = self._lift, self._lifts
        self._lift, self._lifts = 0.0, 0
        return lift / lifts if lifts and -self._most_lift < lift / lifts < self._most_lift else nan

    def at(self, t: float) -> tuple[float, float]:
        """Return u, m/s, and w, m²/s², at a time; before the oldest reading those of the oldest."""
        t += self._lag
        beyond = t - self.newest
        if beyond >= 0.0:
            if beyond <= self._gap:
                return self._sum + self._f * beyond, self._variance(t)
            if beyond == inf:
                return 0.0, 0.0
            return self._sum + self._f * self._gap, self._variance(self.newest) + _unread(beyond)
        times, head = self._t, self._head
        last = self._size - 1
        back = int(-beyond * self._rate)  # a guess, right if no reading is missing
        if back > last:  # noqa: PLR1730 - a call of min costs a tenth of a microsecond
            back = last
        while back < last and times[head - back] > t:
            back += 1
        while back > 0 and times[head - back + 1] <= t:
            back -= 1
        i = head - back
        start = times[i]
        if start == -inf or t <= start:  # before the oldest
            oldest = self.oldest + self._lag
            return (self._u[0] if start == -inf else self._u[i]), self._variance(oldest if oldest > t else t)
        share = (t - start) / (times[i + 1] - start)
        u = self._u[i]
        return u + share * (self._u[i + 1] - u), self._variance(t)

    def _variance(self, t: float) -> float:
        """White noise until t, and what gaps have left."""
        variance = self._white * (t - self._first) + self._old
        for begin, end, unread in self._gaps:
            if t > begin:
                variance += unread if t >= end else unread * (t - begin) / (end - begin)
        return variance


def _unread(time: float) -> float:
    """Variance of the speed, m²/s², after a time, s, in which no acceleration has been read."""
    return GAP_SD * GAP_SD * (time * time if time < LASTS else LASTS * (2.0 * time - LASTS))
