"""Whether a pressure port still tells the truth: two-sided tests on the innovations of the aided filter.

With ν the innovation over its standard deviation, white and of variance 1 while filter and port are as believed:

    drift   S₊ = max(0, S₊ + ν − κ),  S₋ = max(0, S₋ − ν − κ)  above h:  the port says ever more, or less, than the
            accelerometer allows (Page 1954): ice, a leak, a port blocked while the aircraft climbs
    quiet   the running mean of ν² below half: a blocked port holds a constant pressure while the turbulence that is
            declared must move it. Only where that is to be seen, the reading's own variance being less than a fourth of
            what is expected of the innovation
    slide   b, what f_x seems to be off by, beyond five of its standard deviations: a port that drifts so slowly that
            each innovation is small has the filter believe in an acceleration that is not there
    frozen  the same number again and again, which noise does not allow

ν is clipped at ±3, so that spikes, which are gated, count little. With κ = 1/2 white noise passes h = 18 on one of the
two sides once in 1/(2κ²)·e^{2κ(h + 1.17)} = 4·10⁸ readings (Siegmund 1985, 2.6). A single gust is no noise, it drives
the sums to 41 (6 m/s in 2.5 s, in flight); h = 120 leaves that room and is passed within half a second at 100 Hz by a
port that is far off. What moves no faster than gusts do cannot be told from them.

A flag stays until the readings have
agreed with the coasting filter for a second; that time doubles whenever a flag comes back within ten seconds.
"""

from math import inf, sqrt

DRIFT, LEVEL = 0.5, 120.0  # κ, h: standard deviations
CLIP = 3.0  # standard deviations
MEMORY = 1.0 / 60.0  # of the running mean, 1/readings
QUIET = 0.4  # ν², the running mean of which is less
SHARE = 0.25  # of the reading's variance in the innovation's, above which quiet proves nothing
SLIDE = 25.0  # b² over its variance
SAME = 25  # readings of one value; noise at half a step's standard deviation repeats one time in three
AGREE = 3.0  # standard deviations within which a port agrees with the coasting filter
RETURN, SOON = 1.0, 10.0  # s: how long it must; how soon after a return a flag doubles that
LONGEST = 60.0  # s


class PortMonitor:
    """Tests of one port.

    Parameters
    ----------
    bias_sd : float
        Standard deviation of b, m/s².

    Attributes
    ----------
    faulty : bool
        Whether it is flagged.
    """

    __slots__ = ("_agreed", "_down", "_last", "_mean", "_returned", "_same", "_slide", "_up", "_wait", "faulty")

    def __init__(self, bias_sd: float) -> None:
        self._slide = SLIDE * bias_sd * bias_sd
        self.faulty = False
        self._wait, self._returned, self._agreed = RETURN, -inf, inf
        self._last, self._same = 0.0, 0
        self._up = self._down = 0.0
        self._mean = 1.0

    def add(self, t: float, reading: float, innovation: float, nis: float, variance: float, bias: float) -> bool:
        """Take what a reading came to.

        Parameters
        ----------
        t : float
            Time, s.
        reading, innovation : float
            Pa.
        nis : float
            ν².
        variance : float
            Of the reading's noise, Pa².
        bias : float
            b, m/s².

        Returns
        -------
        bool
            True if it raises the flag.
        """
        if reading == self._last:
            self._same += 1
        else:
            self._last, self._same = reading, 0
        nu = CLIP if nis > CLIP * CLIP else sqrt(nis)
        if innovation < 0.0:
            nu = -nu
        up, down = self._up + nu - DRIFT, self._down - nu - DRIFT
        self._up, self._down = up if up > 0.0 else 0.0, down if down > 0.0 else 0.0
        seen = variance * nis < SHARE * innovation * innovation  # variance/spread < SHARE
        mean = self._mean
        self._mean = mean + MEMORY * ((nu * nu if seen else 1.0) - mean)
        loud = self._up > LEVEL or self._down > LEVEL or bias * bias > self._slide
        if loud or self._mean < QUIET or (self._same >= SAME and variance > 0.0):
            self._raise(t)
            return True
        return False

    def _raise(self, t: float) -> None:
        self._wait = min(2.0 * self._wait, LONGEST) if t - self._returned < SOON else RETURN
        self.faulty, self._agreed = True, inf

    def coast(self, t: float, reading: float, difference: float, spread: float) -> bool:
        """While flagged: take the difference from the coasting filter and its variance; True if the flag falls."""
        if reading == self._last:
            self._same += 1
        else:
            self._last, self._same = reading, 0
        if difference * difference > AGREE * AGREE * spread or self._same >= SAME:
            self._agreed = inf
            return False
        if self._agreed == inf:
            self._agreed = t
        if t - self._agreed < self._wait:
            return False
        self.faulty, self._returned = False, t
        self._up = self._down = 0.0
        self._mean = 1.0
        return True
