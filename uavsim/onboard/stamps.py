"""Which time stamps are believed: those of specific force, of the head's rows and of the conversions that they carry.

A stamp follows the last one that was taken if it is later by `JUMP` at the most: that is regular sampling, jitter, and
the gap that some lost readings leave. One that does not follow is nonsense in that one reading, or the clock has taken
a step, as after a pause of a log or a restart; one stamp cannot tell which. So it is left out with its reading, and the
next ones decide:

| stamp | its reading |
|---|---|
| later than the last by at most `JUMP` | taken |
| NaN, infinite, beyond ±`LATEST` | left out |
| equal to the last | left out: a repetition |
| earlier than the last, or later by more than `JUMP` | left out, but for the last of a row |

A row is `AGREED` stamps that were to be left out, each of which follows the one before it: the clock has taken a step.

A stamp that follows the last one taken ends the row: single wrong stamps, however many, are never believed. A step
costs `AGREED` - 1 readings; what had been begun before it (a window, a hold, a filter of the pressures) begins anew.
Where a source is slower than four times in `JUMP`, four of its periods take the place of `JUMP`.

A conversion ends before its reading: a stamp that says something else counts as that of the reading. One that is
earlier than the channel's last brings no news; after `AGREED` of them as above its clock has taken a step.
"""

from math import inf, nan

JUMP = 1.0  # s; longer than the pauses of a bus or a logger that loses some readings, far shorter than a restart
AGREED = 5  # stamps; so many in a row by chance are no nonsense of single readings, and cost 50 ms of a head at 100 Hz
LATEST = 1e11  # s, 3000 years; there a double still resolves 15 µs
SLOW = 4.0  # periods


def jump(rate: float) -> float:
    """Return by how much a stamp follows the last one at the most, s, where `rate` readings come a second, Hz."""
    return max(JUMP, SLOW / rate)


class Stamps:
    """Stamps of one source that do not follow the last one taken.

    The caller keeps the last one that was taken, and asks only about a stamp for which not 0 < t - last ≤ jump.

    Parameters
    ----------
    longest : float
        By how much a stamp follows the one before it at the most, s; see `jump`.

    Examples
    --------
    >>> stamps = Stamps()
    >>> stamps.admit(1e9, 5.0)  # one far ahead
    False
    >>> [stamps.admit(65.0 + 0.01 * k, 5.0) for k in range(5)]  # a pause of a minute
    [False, False, False, False, True]
    """

    __slots__ = ("_after", "_row", "_stamp", "longest")

    def __init__(self, longest: float = JUMP) -> None:
        self.longest = longest
        self._after = self._stamp = nan
        self._row = 0

    def admit(self, t: float, last: float) -> bool:
        """Whether the reading of such a stamp is taken.

        Parameters
        ----------
        t : float
            The stamp, s.
        last : float
            The one that was taken last, s; NaN or infinite if none was.
        """
        if not -LATEST < t < LATEST or t == last:
            return False
        if not -inf < last < inf or 0.0 < t - last <= self.longest:
            return True
        step = t - self._stamp
        if last != self._after or not -self.longest <= step <= self.longest:
            self._after, self._stamp, self._row = last, t, 1
            return False
        if step <= 0.0:  # late or repeated within the row
            return False
        self._stamp = t
        self._row += 1
        if self._row < AGREED:
            return False
        self._after = nan
        return True


class Conversions:
    """Ends of the conversions of one pressure.

    Parameters
    ----------
    longest : float
        As of `Stamps`.
    """

    __slots__ = ("_last", "_stamps")

    def __init__(self, longest: float = JUMP) -> None:
        self._stamps = Stamps(longest)
        self._last = -inf

    def forget(self) -> None:
        """Take the next one for new, whatever its stamp."""
        self._last = -inf

    def new(self, end: float, t: float) -> float:
        """Return when the conversion ended, s, if it is a new one; else NaN.

        Parameters
        ----------
        end : float
            Its stamp, s.
        t : float
            The stamp of the reading that carries it, s, which has been taken.
        """
        last = self._last
        if end > t and end < LATEST:
            end = t
        if not -LATEST < end <= t:
            return nan
        if end <= last and not self._stamps.admit(end, last):
            return nan
        self._last = end
        return end
