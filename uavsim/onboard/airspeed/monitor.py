"""Whether the total pressure's port still tells the truth: two-sided tests, each of which names what it found.

With ν the innovation of the aided filter over its standard deviation, white and of variance 1 while filter and port are
as believed:

    frozen  the port holds its pressure although accelerometer, climb or gusts must move it (`frozen`): blocked, iced
    stuck   the same number again and again, which noise does not allow: the sensor
    drift   S₊ = max(0, S₊ + ν − κ),  S₋ = max(0, S₋ − ν − κ)  above h:  the port says ever more, or less, than the
            accelerometer allows (Page 1954): a leak, a torn tube
    slide   b, what f_x seems to be off by, beyond five of its standard deviations: a port that drifts so slowly that
            each innovation is small has the filter believe in an acceleration that is not there; told as drift

ν is clipped at ±3, so that spikes, which are gated, count little. With κ = 1/2 white noise passes h = 18 on one of the
two sides once in 1/(2κ²)·e^{2κ(h + 1.17)} = 4·10⁸ readings (Siegmund 1985, 2.6). A single gust is no noise, it drives
the sums to 41 (6 m/s in 2.5 s, in flight); h = 120 leaves that room and is passed within half a second at 100 Hz by a
port that is far off. What moves no faster than gusts do cannot be told from them.
"""

from math import sqrt

from uavsim.onboard.airspeed.frozen import FrozenTest
from uavsim.onboard.airspeed.readmission import Readmission

FROZEN, CALM = 24.0, 20.0  # nats, in declared gusts and without; in healthy flights below 14
UNFIT = 4.0  # standard deviations by which a constant fits worse than noise allows: it is no constant
SURE = 2.0  # times the level, from which on the total pressure is blamed whatever the static pressure does
CERTAIN = 3.0  # times that, from which on it does not matter
DRIFT, LEVEL = 0.5, 120.0  # κ, h: standard deviations
CLIP = 3.0  # standard deviations
SLIDE = 25.0  # b² over its variance


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
    usual : int
        The longest row of equal readings that the live sensor has been seen to give.
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

    __slots__ = ("_down", "_gusts", "_level", "_offset_sd", "_rate", "_up", "_variance", "back", "frozen")

    def __init__(
        self, bias_rate: float, variance: float, walk: float, usual: int, gusts: bool, offset_sd: float = 0.0
    ) -> None:
        self._variance, self._rate, self._gusts, self._offset_sd = variance, bias_rate, gusts, offset_sd
        self._level = FROZEN if gusts else CALM
        self.back = Readmission(variance, walk, usual)
        self.restart()

    def restart(self) -> None:
        """Forget what has been seen."""
        self._up = self._down = 0.0
        self.frozen = FrozenTest(self._variance, self._rate, self._gusts, self._offset_sd)

    @property
    def unsure(self) -> bool:
        """Whether a port that seems shut may still be right and the other wrong: in still air, and not for long."""
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
            b² over the variance that b may have.

        Returns
        -------
        str
            What seems to be wrong: "frozen", "stuck", "drift", or "unfit", frozen by what is expected of a live port,
            though the readings are no constant; "" otherwise.
        """
        nu = CLIP if nis > CLIP * CLIP else sqrt(nis)
        if innovation < 0.0:
            nu = -nu
        up, down = self._up + nu - DRIFT, self._down - nu - DRIFT
        self._up, self._down = up if up > 0.0 else 0.0, down if down > 0.0 else 0.0
        test = self.frozen
        if self.back.repeats(reading):
            return "stuck"
        if test.evidence > self._level:
            return (
                "unfit"
                if test.evidence < CERTAIN * self._level and test.misfit > UNFIT * sqrt(2.0 * test.count)
                else "frozen"
            )
        if up > LEVEL or down > LEVEL or slide > SLIDE:
            return "drift"
        return ""
