"""When a port that was flagged is believed again: it lives, and it agrees.

It lives when its readings leave the pressure that it was shut in with, faster than the sensor's own error wanders: a
port that is still shut would agree with a coasting filter whose error bar has grown wide enough. It agrees when for a
second its readings fit the filter that coasts. That second doubles whenever a flag comes back within ten.
"""

from collections.abc import Iterable
from math import inf, nan

WANDER = 4.0  # of the sensor's walk, in variance, that a pressure which is shut in is granted
CLIP = 9.0  # squared standard deviations
ALIVE, STIRRED = 2.0, 25.0  # squared standard deviations a reading that noise is granted, and their sum beyond it
AGREE = 9.0  # squared standard deviations within which a port agrees with the coasting filter
SAME, TIMES = 25, 4  # readings of one value; noise at half a step's standard deviation repeats one time in three; and
# so many times the longest row on the rail, where a sensor of coarser steps has shown what it does
FEW = 5  # of so many parts of that row the first is a beginning
RETURN, SOON = 1.0, 10.0  # s: how long it must; how soon after a return a flag doubles that
LONGEST = 60.0  # s


def longest_row(readings: Iterable[float]) -> int:
    """Return by how many readings, at the most, one value has been followed by itself."""
    longest, same, last = 0, 0, nan
    for reading in readings:
        same = same + 1 if reading == last else 0
        last, longest = reading, max(longest, same)
    return longest


class Readmission:
    """The way back of one port.

    Parameters
    ----------
    variance : float
        Of a reading's noise, Pa².
    walk : float
        Random walk of the sensor's own error, Pa/√s.
    usual : int
        The longest row of equal readings that the live sensor has been seen to give.

    Attributes
    ----------
    faulty : bool
        Whether the port is flagged.
    same : int
        How many readings have been the one before.
    """

    __slots__ = (
        "_agreed", "_heard", "_held", "_held_variance", "_last", "_most", "_returned", "_stirred", "_trapped",
        "_variance", "_wait", "_walk", "faulty", "same",
    )  # fmt: skip

    def __init__(self, variance: float, walk: float, usual: int = 0) -> None:
        self._most = max(SAME, TIMES * usual)
        self._variance, self._walk = variance, WANDER * walk * walk
        self.faulty = self._trapped = False
        self._wait, self._returned, self._agreed, self._heard = RETURN, -inf, inf, -inf
        self._held = self._held_variance = self._stirred = self._last = 0.0
        self.same = 0

    def flag(self, t: float, held: float = 0.0, held_variance: float = inf) -> None:
        """Flag the port at `t`, s; `held` is the pressure that it is shut in with, Pa, if it is shut."""
        self._wait = min(2.0 * self._wait, LONGEST) if t - self._returned < SOON else RETURN
        self.faulty, self._agreed, self._stirred, self._heard = True, inf, 0.0, t
        self._trapped, self._held, self._held_variance = held_variance < inf, held, held_variance

    @property
    def repeating(self) -> bool:
        """Whether the last readings may be the beginning of a row that is too long."""
        return FEW * self.same >= self._most

    def repeats(self, reading: float) -> bool:
        """Whether a sensor that has noise says the same number for too long."""
        if reading == self._last:
            self.same += 1
            return self.same >= self._most
        self._last, self.same = reading, 0
        return False

    def hear(self, t: float, reading: float, pressure: float, difference: float, spread: float) -> bool:
        """While flagged, take a reading; True if the flag falls.

        Parameters
        ----------
        t : float
            Time, s.
        reading, pressure : float
            As it came, and freed of what is known to be wrong with it, Pa.
        difference, spread : float
            What it says less what the coasting filter says, of any unit, and the variance of that.
        """
        repeats = self.repeats(reading)
        if self._trapped:
            self._stir(t, pressure)
        if self._trapped or repeats or difference * difference > AGREE * spread:
            self._agreed = inf
            return False
        if self._agreed == inf:
            self._agreed = t
        if t - self._agreed < self._wait:
            return False
        self.faulty, self._returned = False, t
        return True

    def _stir(self, t: float, pressure: float) -> None:
        """Whether the pressure that was shut in is being left."""
        left, prior = pressure - self._held, self._held_variance + self._walk * max(t - self._heard, 0.0)
        self._heard = t
        spread = prior + self._variance
        self._held += prior / spread * left
        self._held_variance = prior / spread * self._variance
        self._stirred = max(0.0, self._stirred + min(left * left / spread, CLIP) - ALIVE)
        self._trapped = self._stirred < STIRRED
