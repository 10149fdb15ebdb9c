"""Whether the total pressure rises in the stroke as the force says: a cover left on, a shut port, a dead sensor.

Since the launch the push has given u = ∫ (f_x − f_x at rest) dt. With the wind w along the launch that was seen on the
rail, V = u ± w, and a live port's pressure has risen since by ½ρ (u² ± 2uw): at least by

    r = ½ρ (u² − 2u w⁺),    w⁺ = w + 3 σ_w

A covered, shut or dead port has not risen at all. Once r is `SURE` standard deviations of a reading, and the pressure
of `AGREED` readings in a row has risen by less than a quarter of it, the port is none. Of readings of a live port not
one is that low (11 standard deviations), of a shut one all are. Tubes that have been swapped let the total pressure
stand still and the static one rise: then both are named. A differential sensor then reads the same with the other sign.
Of an absolute one a fall says nothing of the static port. A pressure that has risen by half of r lives, and the test is
over.
"""

from collections.abc import Iterable
from math import sqrt

from uavsim.onboard.airspeed.rest_wind import OPENED, Row

SURE = 15.0  # standard deviations of a reading, by which a live one must have risen. By hand: 9 m/s at 3.7 Pa
AGREED = 5  # readings in a row that decide, so that no spike does
SHUT, LIVE = 0.25, 0.5  # of r, below which a port is shut, and above which it lives
FEWEST = 3  # readings at rest; fewer say nothing of the pressure there
DEVIATIONS, MOST_WIND = 3.0, 9.0  # of the wind; m/s, of what is not known, or no stroke would decide. By hand


class StrokeTest:
    """One launch.

    Parameters
    ----------
    differential : bool
        Whether the total channel is that of a differential sensor (`difference`).

    Attributes
    ----------
    open : bool
        Whether it is still going on.
    """

    __slots__ = (
        "_dead", "_density", "_differential", "_lives", "_static_rest", "_total_rest", "_variance", "_wind", "open",
    )  # fmt: skip

    def __init__(self, differential: bool = False) -> None:
        self.open, self._differential = False, differential
        self._lives = self._dead = 0
        self._total_rest = self._static_rest = self._variance = self._wind = self._density = 0.0

    def begin(
        self,
        rows: Iterable[Row],
        *,
        tare_end: float,
        end: float,
        variance: float,
        wind: float,
        density: float,
    ) -> None:
        """Begin with what was read at rest.

        Parameters
        ----------
        rows : iterable of tuple
            Readings of the head, the total channel (`difference`) in the place of the total pressure.
        tare_end, end : float
            Those of conversions between them count, s.
        variance : float
            Of a reading of the total pressure, Pa².
        wind : float
            w⁺, m/s.
        density : float
            Of the air, kg/m³.
        """
        totals, statics = [], []
        for _, total, static, _, t_total, t_static in rows:
            if tare_end + OPENED < t_total <= end and total == total:
                totals.append(total)
            if t_static <= end and static == static:
                statics.append(static)
        self._lives = self._dead = 0
        self.open = min(len(totals), len(statics)) >= FEWEST and density > 0.0
        if not self.open:
            return
        totals.sort()
        statics.sort()
        self._total_rest, self._static_rest = totals[len(totals) // 2], statics[len(statics) // 2]
        self._variance = variance * (1.0 + 1.6 / len(totals))
        self._wind, self._density = wind, density

    def add(self, total: float, static: float, gained: float, unknown: float) -> str:
        """Take a reading.

        Parameters
        ----------
        total, static : float
            The channels as they came, Pa.
        gained : float
            u at the instant of the reading, m/s.
        unknown : float
            What the push may do to the sensor, Pa, standard deviation.

        Returns
        -------
        str
            "frozen": the total pressure has not risen. "swapped": the static one has, in its place. "" for nothing.
        """
        rise = 0.5 * self._density * gained * (gained - 2.0 * self._wind)
        if gained <= 0.0 or rise < SURE * sqrt(self._variance + unknown * unknown):
            return ""
        risen = total - self._total_rest
        if risen > LIVE * rise:
            self._lives, self._dead = self._lives + 1, 0
            self.open = self._lives < AGREED
            return ""
        self._lives = 0
        self._dead = self._dead + 1 if risen < SHUT * rise else 0
        if self._dead < AGREED:
            return ""
        self.open = False
        other = -risen if self._differential else static - self._static_rest
        swapped = other > LIVE * rise
        return "swapped" if swapped else "frozen"


def most_wind(wind: float, sd: float) -> float:
    """Return w⁺, m/s, of the wind along the launch that is believed, either sign, and its standard deviation."""
    return min(abs(wind) + DEVIATIONS * sd, MOST_WIND)
