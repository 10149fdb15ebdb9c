"""The speed that the specific force has given, kept for a short while so that it can be asked for at any recent time.

    u(t) = ∫ f_x dt,        w(t) = Σ (σ_a·Δt)²

u by the trapezoidal rule between readings, w the variance that white noise of standard deviation σ_a a reading has
brought into it. A gap in the readings, five periods and more, and the time beyond the newest one count with the mean of
the readings beside them and with an unknown acceleration of 5 m/s² standard deviation throughout.

Fixed memory: the readings of the last `SIZE` periods.
"""

from math import inf

SIZE = 1024  # readings; at 1 kHz a second
GAP = 5.0  # periods
GAP_SD = 5.0  # m/s², what an acceleration that nobody has read may be: that of a strong pull-up in flight


class SpeedGained:
    """Ring of the last readings of f_x, summed.

    Parameters
    ----------
    sd : float
        White noise of one reading, m/s².
    rate : float
        Nominal rate of the readings, Hz.
    size : int
        How many are kept.

    Attributes
    ----------
    newest : float
        Time of the last reading, s; -inf before the first.
    """

    __slots__ = ("_f", "_filled", "_gap", "_head", "_period", "_rate", "_size", "_t", "_u", "_w", "_white", "newest")

    def __init__(self, sd: float, rate: float, size: int = SIZE) -> None:
        self._rate, self._period, self._size = rate, 1.0 / rate, size
        self._gap = GAP / rate
        self._white = sd * sd / rate
        self._t, self._u, self._w, self._f = ([0.0] * size for _ in range(4))
        self._head, self._filled = -1, 0
        self.newest = -inf

    @property
    def oldest(self) -> float:
        """Time of the oldest reading that is kept, s; inf without any."""
        return self._t[self._head - self._filled + 1] if self._filled else inf

    def add(self, t: float, f: float) -> None:
        """Take a reading; one that is no number, or not newer than the last, is passed over."""
        elapsed = t - self.newest
        if not (elapsed > 0.0 and -inf < f < inf):
            return
        head = self._head
        following = head + 1 if head + 1 < self._size else 0
        if elapsed <= self._gap:
            self._u[following] = self._u[head] + 0.5 * (self._f[head] + f) * elapsed
            self._w[following] = self._w[head] + self._white * elapsed
        elif elapsed < inf:
            self._u[following] = self._u[head] + 0.5 * (self._f[head] + f) * elapsed
            self._w[following] = self._w[head] + self._white * elapsed + (GAP_SD * elapsed) ** 2
        self._t[following], self._f[following] = t, f
        self._head, self.newest = following, t
        if self._filled < self._size:
            self._filled += 1

    def at(self, t: float) -> tuple[float, float]:
        """Return u, m/s, and w, m²/s², at a time; before the oldest reading those of the oldest."""
        head = self._head
        if t >= self.newest:
            beyond = t - self.newest
            if beyond <= self._gap:
                return self._u[head] + self._f[head] * beyond, self._w[head] + self._white * beyond
            if beyond == inf:
                return 0.0, 0.0
            return self._u[head] + self._f[head] * self._gap, self._w[head] + (GAP_SD * beyond) ** 2
        times, last = self._t, self._filled - 1
        back = int((self.newest - t) * self._rate)  # a guess, right if no reading is missing
        if back > last:  # noqa: PLR1730 - a call of min costs a tenth of a microsecond
            back = last
        while back < last and times[head - back] > t:
            back += 1
        while back > 0 and times[head - back + 1] <= t:
            back -= 1
        i = head - back
        start = times[i]
        if back == 0 or t <= start:
            return self._u[i], self._w[i]
        share = (t - start) / (times[i + 1] - start)
        u, w = self._u[i], self._w[i]
        return u + share * (self._u[i + 1] - u), w + share * (self._w[i + 1] - w)
