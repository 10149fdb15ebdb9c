"""Single readings that no air can have made: left out, as the time stamps that do not follow (`uavsim.onboard.stamps`).

A value that is further from the last one taken than the air can move it in the time between is a spike, or the port is
in another place. It is left out, until `AGREED` such values have come in a row of which each is as near to the one
before it as it should be: then the last of them is taken. One that is near the last one taken ends the row.
"""

from math import nan

from uavsim.onboard.stamps import AGREED


class Spikes:
    """Values of one channel that are too far from the last one taken."""

    __slots__ = ("_after", "_row", "_value")

    def __init__(self) -> None:
        self._after, self._value, self._row = nan, nan, 0

    def believe(self, value: float, last: float, reach: float) -> bool:
        """Whether such a value is taken.

        Parameters
        ----------
        value : float
            Not within `reach` of the last one.
        last : float
            The one that was taken last; NaN if none was.
        reach : float
            How far the value can move.
        """
        if last != last:
            return True
        follows = last == self._after and -reach <= value - self._value <= reach
        self._row = self._row + 1 if follows else 1
        self._after, self._value = last, value
        if self._row < AGREED:
            return False
        self._after = nan
        return True
