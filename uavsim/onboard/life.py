"""Whether a sensor lives, by what comes of it: the one rule for the head on the rail and for the accelerometer.

silent   no new reading for a pause
invalid  nothing but NaN for so long
range    nothing but readings at or beyond the ends of the range for so long
stuck    the same number for longer than its noise allows (`repeats`)
"""

from math import inf, isfinite

from uavsim.onboard.repeats import Row

WORDS = {
    "silent": "no reading comes",
    "invalid": "its readings are no numbers",
    "range": "its readings are at or beyond the ends of its range",
    "stuck": "it repeats one number for longer than its noise allows",
}


class SensorLife:
    """One sensor: when it was heard last, and what of.

    Parameters
    ----------
    bounds : (low, high)
        Between which a reading is a measurement; the ends are not.
    pause : float
        How long it may be silent, s.
    row : float
        How often it may repeat a number; infinity: repetition says nothing.

    Attributes
    ----------
    row : Row
        How often it has.
    """

    __slots__ = ("_came", "_first", "_good", "_high", "_low", "_nan", "_pause", "row")

    def __init__(self, bounds: tuple[float, float], pause: float, row: float = inf) -> None:
        (self._low, self._high), self._pause, self.row = bounds, pause, Row(row)
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._first, self._came, self._good = inf, -inf, -inf
        self._nan = False
        self.row.forget()

    def add(self, t: float, reading: float, new: bool = True, counts: bool = True) -> None:
        """Take a value at a time, s, and whether it is a new one; a conversion that is polled again is not.

        One that does not count may be of a conversion that has been read before: it is no repetition.
        """
        if self._first == inf:
            self._first = t
        if not new:
            return
        self._came = t
        if self._low < reading < self._high:
            self._good = t
            if counts:
                self.row.add(reading)
        else:
            self._nan = not isfinite(reading)

    def wrong(self, t: float) -> str:
        """Return what is wrong with it at `t`, s; "" for nothing, or for too little time to tell."""
        since = t - self._pause
        if self._first > since:
            return ""
        if self._came < since:
            return "silent"
        if self._good < since:
            return "invalid" if self._nan else "range"
        return "stuck" if self.row.stuck else ""
