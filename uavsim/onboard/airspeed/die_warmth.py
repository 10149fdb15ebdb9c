"""What a climb does to a thermometer: its die follows the air with a lag.

The thermometer is one on a pressure sensor's die, and the die follows the air as a first-order lag τ. In a climb the
air gets colder by the lapse rate Λ, and the die stays behind it by

    Λ (h − h'),    τ ḣ' = h − h'

with the height h by the static pressure. By so much the reading is taken for too warm; `DOUBT` of it is not known, for
the lapse rate is anything between an inversion and that of dry air, and τ is a guess.
"""

LAPSE = 0.0065  # K/m of the standard atmosphere, ICAO Doc 7488
# standard deviation of what is taken off, as a share of it: the lapse is 0 … 0.01 K/m, and the lag is known to a third.
# By hand
DOUBT = 0.5


class DieWarmth:
    """One flight's.

    Parameters
    ----------
    lag : float
        τ, s; 0: the die has the temperature of the air.

    Attributes
    ----------
    behind : float
        Λ (h − h'), K, by which a reading is too cold; below 0 in a climb.
    """

    __slots__ = ("_lag", "_way", "behind")

    def __init__(self, lag: float) -> None:
        self._lag, self._way, self.behind = lag, 0.0, 0.0

    def forget(self) -> None:
        """Begin at rest, where the die has the temperature of the air."""
        self._way = self.behind = 0.0

    def add(self, rate: float, dt: float) -> None:
        """Take how fast the aircraft climbs, m/s, over a time, s."""
        lag = self._lag
        if lag > 0.0:
            self._way += rate * dt - self._way * (dt / lag if dt < lag else 1.0)
            self.behind = -LAPSE * self._way
