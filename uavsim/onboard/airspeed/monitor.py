"""Whether the total pressure's port still tells the truth: two-sided tests, each of which names what it found.

With ν the innovation of the aided filter over its standard deviation, white and of variance 1 while filter and port are
as believed:

    frozen  the port holds its pressure although accelerometer, climb or gusts must move it (`frozen`): blocked, iced
    stuck   the same number again and again, which noise does not allow: the sensor
    drift   S₊ = max(0, S₊ + ν − κ),  S₋ = max(0, S₋ − ν − κ)  above h:  the port says ever more, or less, than the
            accelerometer allows (Page 1954): a leak, a torn tube
    slide   b, what f_x seems to be off by, beyond five of its standard deviations: a port that drifts so slowly that
            each innovation is small has the filter believe in an acceleration that is not there

ν is clipped at ±3, so that spikes, which are gated, count little. With κ = 1/2 white noise passes h = 18 on one of the
two sides once in 1/(2κ²)·e^{2κ(h + 1.17)} = 4·10⁸ readings (Siegmund 1985, 2.6). A single gust is no noise, it drives
the sums to 41 (6 m/s in 2.5 s, in flight); h = 120 leaves that room and is passed within half a second at 100 Hz by a
port that is far off. What moves no faster than gusts do cannot be told from them.

A flag stays until the port lives and agrees. It lives when its readings leave the pressure that it was shut in with; it
agrees when for a second they fit the filter that coasts on the accelerometer. That second doubles whenever a flag comes
back within ten.
"""

from math import inf, sqrt

from uavsim.onboard.airspeed.frozen import FrozenTest

FROZEN = 22.0  # nats; in healthy flights the evidence stays below 14
DRIFT, LEVEL = 0.5, 120.0  # κ, h: standard deviations
CLIP = 3.0  # standard deviations
SLIDE = 25.0  # b² over its variance
SAME = 25  # readings of one value; noise at half a step's standard deviation repeats one time in three
WANDER = 4.0  # of the sensor's walk, in variance, that a pressure which is shut in is granted
ALIVE, STIRRED = 2.0, 25.0  # squared standard deviations a reading that noise is granted, and their sum beyond it
AGREE = 3.0  # standard deviations within which a port agrees with the coasting filter
RETURN, SOON = 1.0, 10.0  # s: how long it must; how soon after a return a flag doubles that
LONGEST = 60.0  # s


class PortMonitor:
    """Tests of one port.

    Parameters
    ----------
    bias_sd : float
        Standard deviation of b, m/s².
    variance : float
        Of a reading's noise, Pa².
    walk : float
        Random walk of the sensor's own error, Pa/√s.
    gusts : bool
        Whether turbulence is declared, so that stillness is evidence.

    Attributes
    ----------
    faulty : bool
        Whether it is flagged.
    variance : float
        Of a reading's noise, Pa².
    frozen : FrozenTest
        The comparison of a live port with one that is shut.
    """

    __slots__ = (
        "_agreed", "_down", "_gusts", "_heard", "_last", "_returned", "_same", "_slide", "_stirred", "_trapped", "_up", "_wait", "_walk",
        "faulty", "frozen", "variance",
    )  # fmt: skip

    def __init__(self, bias_sd: float, variance: float, walk: float, gusts: bool) -> None:
        self._slide = SLIDE * bias_sd * bias_sd
        self.variance, self._walk, self._gusts = variance, WANDER * walk * walk, gusts
        self.faulty = self._trapped = False
        self._wait, self._returned, self._agreed = RETURN, -inf, inf
        self._last, self._same, self._heard = 0.0, 0, -inf
        self._up = self._down = self._stirred = 0.0
        self.frozen = FrozenTest(variance, gusts)

    def add(self, t: float, reading: float, innovation: float, nis: float, bias: float) -> str:
        """Take what a reading came to, after `frozen` has taken it.

        Parameters
        ----------
        t : float
            Time, s.
        reading, innovation : float
            Pa.
        nis : float
            ν².
        bias : float
            b, m/s².

        Returns
        -------
        str
            What is wrong if this raises the flag: "frozen", "stuck" or "drift"; "" otherwise.
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
        if self.frozen.evidence > FROZEN:
            return self._raise(t, "frozen")
        if up > LEVEL or down > LEVEL or bias * bias > self._slide:
            return self._raise(t, "drift")
        if self._same >= SAME and self.variance > 0.0:
            return self._raise(t, "stuck")
        return ""

    def _raise(self, t: float, kind: str) -> str:
        self._wait = min(2.0 * self._wait, LONGEST) if t - self._returned < SOON else RETURN
        self.faulty, self._agreed, self._stirred, self._heard = True, inf, 0.0, t
        self._trapped = kind == "frozen"
        return kind

    def coast(self, t: float, reading: float, tared: float, difference: float, spread: float) -> bool:
        """While flagged, take a reading; True if the flag falls.

        Parameters
        ----------
        t : float
            Time, s.
        reading, tared : float
            As it came, and as the tests took it, Pa.
        difference, spread : float
            Airspeed by it less that of the coasting filter, m/s, and the variance of that, m²/s².
        """
        if reading == self._last:
            self._same += 1
        else:
            self._last, self._same = reading, 0
        if self._trapped:
            self._stir(t, tared)
        if self._trapped or difference * difference > AGREE * AGREE * spread or self._same >= SAME:
            self._agreed = inf
            return False
        if self._agreed == inf:
            self._agreed = t
        if t - self._agreed < self._wait:
            return False
        self.faulty, self._returned = False, t
        self._up = self._down = 0.0
        self.frozen = FrozenTest(self.variance, self._gusts)
        return True

    def _stir(self, t: float, tared: float) -> None:
        """Whether a port that was shut lives: it leaves the pressure that was shut in, faster than sensors wander."""
        test = self.frozen
        left, prior = tared - test.held, test.held_variance + self._walk * max(t - self._heard, 0.0)
        self._heard = t
        spread = prior + self.variance
        test.held += prior / spread * left
        test.held_variance = prior / spread * self.variance
        self._stirred = max(0.0, self._stirred + min(left * left / spread, CLIP * CLIP) - ALIVE)
        self._trapped = self._stirred < STIRRED
