"""When a port that was flagged is believed again: it lives, and it agrees.

It lives when its readings leave the pressure that it was shut in with, faster than the sensor's own error wanders. That
is asked because the error bar of a coasting filter grows: at last a port that is still shut would agree with it. Nor
may it leave once and agree by chance long after: where it has not come to agree within two seconds, it is taken to be
shut in again, with the pressure that it has then, and has to leave that one, too. So what ends a flag is a change that
leads to where the air is; a pressure that only stands elsewhere (the push has ended, the sensor has become warm) would
meet the coasting filter some time.

It agrees when its readings fit the coasting filter for a second. That second doubles whenever a flag comes back within
ten.
"""

from math import inf, nan

from uavsim.onboard.repeats import LEAST

WANDER = 4.0  # times the sensor's walk, in variance, that a pressure which is shut in may wander. By hand
# squared standard deviations at which a reading's part is clipped: one spike does not show that a port lives
CLIP = 9.0
# squared standard deviations a reading that noise is granted, where its mean is 1, and their sum beyond that, above
# which the port lives. By hand; test_a_port_that_is_still_shut_is_not_taken_back. Noise alone passed 25 in one of some
# 40 flights with a shut port, 8 s after the flag
ALIVE, STIRRED = 2.0, 40.0
# s within which a port that has left its pressure must begin to agree. By hand: a port that thaws is open in one, and
# what it says follows the air from there on; a coasting filter in gusts may be 3 m/s off, and is met again in a gust
SETTLES = 2.0
AGREE = 9.0  # squared standard deviations within which a port agrees with the coasting filter: three of them, by hand
FEW = 5  # parts of that row. After the first it may be a beginning, and no other port is blamed meanwhile. By hand
# s: how long a port must agree, how soon after its return a flag doubles that, and the most that it must. By hand;
# docs/faults.md, column "taken back"
RETURN, SOON, LONGEST = 1.0, 10.0, 60.0
MUTE = ("silent", "invalid", "range")  # kinds of which there was nothing to take
BACK = 0.1  # s, the same after silence: ten readings. By hand


class Readmission:
    """The way back of one port.

    Parameters
    ----------
    variance : float
        Of a reading's noise, Pa².
    walk : float
        Random walk of the sensor's own error, Pa/√s.
    row : float
        How often its sensor may repeat a number (`uavsim.onboard.repeats`).

    Attributes
    ----------
    faulty : bool
        Whether the port is flagged.
    same : int
        How many readings have been the one before.
    """

    __slots__ = (
        "_agreed",
        "_heard",
        "_held",
        "_held_variance",
        "_last",
        "_left",
        "_most",
        "_returned",
        "_stirred",
        "_stuck",
        "_trapped",
        "_variance",
        "_wait",
        "_walk",
        "faulty",
        "same",
    )  # fmt: skip

    def __init__(self, variance: float, walk: float, row: float = LEAST) -> None:
        self._most = row
        self._variance, self._walk = variance, WANDER * walk * walk
        self.faulty = self._trapped = self._stuck = False
        self._wait, self._returned, self._agreed, self._heard = RETURN, -inf, inf, -inf
        self._left = inf
        self._held = self._held_variance = self._stirred = 0.0
        self._last = nan
        self.same = 0

    def flag(self, t: float, held: float = 0.0, held_variance: float = inf, kind: str = "") -> None:
        """Flag the port.

        Parameters
        ----------
        t : float
            s.
        held, held_variance : float
            The pressure that is shut in, Pa, and its variance, Pa², if it is shut. NaN: that of the next reading.
        kind : str
            What was wrong. If nothing came of it, it is back when readings come that agree; if it repeated one number,
            it has to say another one first, however long a live one may repeat itself.
        """
        mute = kind in MUTE
        self._wait = min(2.0 * self._wait, LONGEST) if t - self._returned < SOON else BACK if mute else RETURN
        self._stuck = kind == "stuck"
        self.faulty, self._agreed, self._stirred, self._heard = True, inf, 0.0, t
        self._trapped, self._held, self._held_variance, self._left = held_variance < inf, held, held_variance, inf

    @property
    def repeating(self) -> bool:
        """Whether the last readings may be the beginning of a row that is too long for a live sensor."""
        return FEW * self.same >= self._most

    def repeats(self, reading: float) -> bool:
        """Whether a sensor that has noise says the same number for too long."""
        if reading == self._last:
            self.same += 1
            return self.same >= self._most
        if self._last == self._last:
            self._stuck = False
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
        if self._trapped or self._stuck or repeats or difference * difference > AGREE * spread:
            self._agreed = inf
            if t - self._left > SETTLES:
                self._trap(pressure)
            return False
        if self._agreed == inf:
            self._agreed = t
        if t - self._agreed < self._wait:
            return False
        self.faulty, self._returned = False, t
        return True

    def _trap(self, pressure: float) -> None:
        """Believe the port to be shut in with a pressure, Pa."""
        self._trapped, self._stirred, self._left = True, 0.0, inf
        self._held, self._held_variance = pressure, self._variance

    def _stir(self, t: float, pressure: float) -> None:
        """Judge by a reading, Pa, whether the port has left the pressure that was shut in."""
        if self._held != self._held:
            self._held = pressure
        left, prior = pressure - self._held, self._held_variance + self._walk * max(t - self._heard, 0.0)
        self._heard = t
        spread = prior + self._variance
        self._held += prior / spread * left
        self._held_variance = prior / spread * self._variance
        self._stirred = max(0.0, self._stirred + min(left * left / spread, CLIP) - ALIVE)
        self._trapped = self._stirred < STIRRED
        if not self._trapped:
            self._left = t
