"""Whether the total pressure's port still tells the truth: four tests, each of which names what it has found.

With ν the innovation of the aided filter over its standard deviation, which is white and of variance 1 while filter and
port are as believed:

    frozen  the port holds its pressure although accelerometer, climb or gusts must move it (`frozen`): blocked, iced
    stuck   the same number again and again, which noise does not allow (`readmission`): the sensor
    drift   S₊ = max(0, S₊ + ν − κ) or S₋ = max(0, S₋ − ν − κ) is above h (Page 1954): the port says ever more, or ever
            less, than the accelerometer allows. A leak, a torn tube. Where the filter has been narrower than its
            innovations for long, ν is taken by their mean square
    slide   b, what f_x seems to be off by, is beyond five of its standard deviations, and has left its mean of the last
            10 s by as much (`watch`). Where a port drifts so slowly that each innovation is small, the filter believes
            in an acceleration that is not there. Told as drift. A b that stays is none: g sin α is 2 m/s² at 20 m/s

What moves no faster than gusts do cannot be told from them by these tests; `leak` sees it later.
"""

from math import sqrt

from uavsim.onboard.airspeed.frozen import FrozenTest
from uavsim.onboard.airspeed.readmission import Readmission

# nats of `frozen`, in declared gusts and without, above which the port is flagged. By hand: at 24 four of 396 healthy
# flights of manoeuvres were, in gusts that rested for 1 to 5 s; at 32 none of 296 others. A port that shuts in gusts
# passes 32 in about 1.2 s, 0.25 s later (docs/faults.md)
FROZEN, CALM = 32.0, 20.0
# standard deviations by which a constant fits worse than noise allows. Beyond it the readings are no constant: the port
# is not shut, and something else is wrong. True constants are there once in 30 000 times
UNFIT = 4.0
# times the level, from which on the total port is blamed whatever the static port does. By hand; docs/faults.md, column
# "right port", holds the check of this and the next
SURE = 2.0
CERTAIN = 3.0  # times the level, from which on it is blamed even if the readings are no constant. By hand
# κ and h, standard deviations. κ = 1/2 is best against a shift of one. White noise alone passes h = 18 once in
# 1/(2κ²)·e^{2κ(h + 1.17)} = 4·10⁸ readings (Siegmund 1985, 2.6). But a single gust, which is no noise, drives the sums
# to 41 (6 m/s in 2.5 s, in flight). h leaves three times that. By hand; a port that is far off passes it within half a
# second at 100 Hz
DRIFT, LEVEL = 0.5, 120.0
# readings over which the mean of ν², clipped as ν is, tells how narrow the filter is. By hand: ten seconds at 100 Hz,
# so that a leak, which is seen in half a second, is hardly in it. Without it turbulence at 140 m/s, where ν² is 15
# for seconds, was a drift twice in 58 flights
USUAL = 1000
CLIP = 3.0  # standard deviations at which ν is clipped, so that spikes, which are gated, count little. By hand
# b² over its variance, five standard deviations: beyond it b is no acceleration. Chance is there once in two million
SLIDE = 25.0


class PortMonitor:
    """Tests of one port.

    Parameters
    ----------
    bias_rate : float
        How fast b wanders in steady flight, (m/s²)/√s.
    variance : float
        Of a reading's noise, Pa².
    walk : float
        Random walk of the sensor's own error, Pa/√s.
    row : float
        How often its sensor may repeat a number (`uavsim.onboard.repeats`).
    gusts : bool
        Whether turbulence is declared, so that stillness is evidence.
    offset_sd : float
        Offset of f_x, m/s².

    Attributes
    ----------
    back : Readmission
        Whether the port is flagged, and its way back.
    frozen : FrozenTest
        The comparison of a live port with one that is shut.
    """

    __slots__ = ("_down", "_gusts", "_level", "_offset_sd", "_rate", "_up", "_usual", "_variance", "back", "frozen")

    def __init__(
        self, bias_rate: float, variance: float, walk: float, row: float, gusts: bool, offset_sd: float = 0.0
    ) -> None:
        self._variance, self._rate, self._gusts, self._offset_sd = variance, bias_rate, gusts, offset_sd
        self._level, self._usual = FROZEN if gusts else CALM, 1.0
        self.back = Readmission(variance, walk, row)
        self.restart()

    def restart(self) -> None:
        """Forget what has been seen."""
        self._up = self._down = 0.0
        self.frozen = FrozenTest(self._variance, self._rate, self._gusts, self._offset_sd)

    @property
    def unsure(self) -> bool:
        """Whether a port that seems shut may still be right, and the static port wrong: in still air, below `SURE`."""
        return not self._gusts and self.frozen.evidence < SURE * self._level

    def add(self, reading: float, innovation: float, nis: float, slide: float) -> str:
        """Take what a reading came to, after `frozen` has taken it.

        Parameters
        ----------
        reading, innovation : float
            Pa.
        nis : float
            ν².
        slide : float
            b² over the variance that b may have, or that of its change.

        Returns
        -------
        str
            What seems to be wrong: "frozen", "stuck", "drift", or "unfit": the readings fit no live port, and are no
            constant either. "" for nothing.
        """
        size = nis if nis < CLIP * CLIP else CLIP * CLIP
        usual = self._usual = self._usual + (size - self._usual) / USUAL
        nu = sqrt(size / usual if usual > 1.0 else size)
        if innovation < 0.0:
            nu = -nu
        up, down = self._up + nu - DRIFT, self._down - nu - DRIFT
        self._up, self._down = up if up > 0.0 else 0.0, down if down > 0.0 else 0.0
        test = self.frozen
        if self.back.repeats(reading):
            return "stuck"
        if test.evidence > self._level:
            unfit = test.evidence < CERTAIN * self._level and test.misfit > UNFIT * sqrt(2.0 * test.count)
            return "unfit" if unfit else "frozen"
        if up > LEVEL or down > LEVEL or slide > SLIDE:
            return "drift"
        return ""
