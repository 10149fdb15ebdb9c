"""Single readings that no air can have made: left out, as the time stamps that do not follow (`uavsim.onboard.stamps`).

A pressure that is further from the last one taken than the air can move it in the time between is a spike, or the port
is in another place. It is left out, until `AGREED` such pressures have come in a row of which each is as near to the
one before it as it should be: then the last of them is taken. One that is near the last one taken ends the row.
"""

from math import nan

from uavsim.onboard.plausible import LEAST_PRESSURE, MOST_PRESSURE
from uavsim.onboard.stamps import AGREED

LEFT_OUT, TAKEN, JUMPED = 0, 1, 2
"""What `Spikes.take` says of a pressure; the last is of one that is taken though it is far from the one before."""


class Spikes:
    """The pressures of one channel.

    Parameters
    ----------
    bounds : (low, high)
        Between which a pressure is a measurement, Pa; the ends of a sensor's range are none.

    Attributes
    ----------
    last : float
        The one that was taken last, Pa; NaN before.
    """

    __slots__ = ("_after", "_high", "_low", "_row", "_value", "last")

    def __init__(self, bounds: tuple[float, float] = (LEAST_PRESSURE, MOST_PRESSURE)) -> None:
        self._low, self._high = bounds
        self.forget()

    def forget(self) -> None:
        """Take the next one that is plausible."""
        self.last = self._after = self._value = nan
        self._row = 0

    def take(self, value: float, reach: float) -> int:
        """Return whether a pressure, Pa, is left out, taken, or taken as one that has jumped.

        Parameters
        ----------
        value : float
            Pa; one that is NaN or no measurement is left out.
        reach : float
            How far it can have moved since the last one, Pa.
        """
        if not self._low < value < self._high:
            return LEFT_OUT
        last = self.last
        if -reach <= value - last <= reach or last != last:
            self.last = value
            return TAKEN
        follows = last == self._after and -reach <= value - self._value <= reach
        self._row = self._row + 1 if follows else 1
        self._after, self._value = last, value
        if self._row < AGREED:
            return LEFT_OUT
        self.last, self._after = value, nan
        return JUMPED
