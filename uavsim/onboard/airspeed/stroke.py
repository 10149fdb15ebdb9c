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

**Odds.** Until then both are possible. A live port has risen by ½ρ (u² + 2uw), a shut one by nothing. Each reading that
has risen by x, of the noise σ, says

    ln (P_shut/P_live) += ½ (x − ½ρ (u² + 2uw))²/S − ½ x²/σ² + ½ ln(S/σ²),    S = σ² + (ρ u σ_w)² + (`UNSURE` ½ρu²)²

with −w, too, where it is not known from which side the wind comes. A fall beyond `FALLEN` σ is of no live port: it
counts as none risen. If the port is shut V is u ± w by the force alone, Δ from what the filter says, and the second
moment about that has P_shut (Δ² + σ_w²) more.
"""

from collections.abc import Iterable
from math import exp, log, sqrt

from uavsim.onboard.airspeed.rest_wind import OPENED, Row

SURE = 15.0  # standard deviations of a reading, by which a live one must have risen. By hand: 9 m/s at 3.7 Pa
AGREED = 5  # readings in a row that decide, so that no spike does
SHUT, LIVE = 0.25, 0.5  # of r, below which a port is shut, and above which it lives
FEWEST = 3  # readings at rest; fewer say nothing of the pressure there
# ln of the odds that one port in a thousand is left covered, by hand: a crew looks; and bounds, between which a wrong
# turn is taken back within some readings; nats that one reading may say, so that no spike decides
PRIOR, LEAST_ODDS, MOST_ODDS, SAID = -7.0, -16.0, 5.0, 3.0
FALLEN = 4.0  # standard deviations of a reading; by hand: one in 30 000 of a shut port's
UNSURE = 0.1  # share of ½ρu² that is not known: the force's scale, the air's density, the port's error. By hand
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
    shut : float
        P_shut.
    """

    __slots__ = (
        "_along", "_dead", "_density", "_differential", "_lives", "_odds", "_sided", "_static_rest", "_total_rest",
        "_variance", "_wind", "open", "shut",
    )  # fmt: skip

    def __init__(self, differential: bool = False) -> None:
        self.open, self._differential = False, differential
        self._lives = self._dead = 0
        self._total_rest = self._static_rest = self._variance = self._wind = self._density = 0.0
        self._along, self._sided = (0.0, 0.0), True
        self._odds, self.shut = PRIOR, 0.0

    def begin(
        self,
        rows: Iterable[Row],
        *,
        tare_end: float,
        end: float,
        variance: float,
        wind: tuple[float, float],
        sided: bool,
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
        wind : tuple of float
            w along the launch, m/s, and its standard deviation.
        sided : bool
            Whether it is known from which side it comes.
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
        self._odds, self.shut = PRIOR, 0.0
        self.open = min(len(totals), len(statics)) >= FEWEST and density > 0.0
        if not self.open:
            return
        totals.sort()
        statics.sort()
        self._total_rest, self._static_rest = totals[len(totals) // 2], statics[len(statics) // 2]
        self._variance = variance * (1.0 + 1.6 / len(totals))
        self._wind, self._density = most_wind(*wind), density
        self._along, self._sided = wind, sided

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
        if gained <= 0.0:
            return ""
        variance, risen = self._variance + unknown * unknown, total - self._total_rest
        self._weigh(risen, gained, variance)
        rise = 0.5 * self._density * gained * (gained - 2.0 * self._wind)
        if rise < SURE * sqrt(variance):
            return ""
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

    def _weigh(self, risen: float, gained: float, variance: float) -> None:
        """Weigh a shut port against a live one by what a reading has risen by, Pa, of a variance, Pa²."""
        (along, sd), slope = self._along, self._density * gained
        own = 0.5 * slope * gained
        spread = variance + (slope * sd) ** 2 + (UNSURE * own) ** 2
        off = risen - own - slope * along
        if not self._sided:
            off = min(off, risen - own + slope * along, key=abs)
        stays = risen * risen / variance if risen > -FALLEN * sqrt(variance) else 0.0
        said = 0.5 * (off * off / spread - stays + log(spread / variance))
        odds = self._odds + min(max(said, -SAID), SAID)
        self._odds = min(max(odds, LEAST_ODDS), MOST_ODDS)
        self.shut = 1.0 / (1.0 + exp(-self._odds))


def most_wind(wind: float, sd: float) -> float:
    """Return w⁺, m/s, of the wind along the launch that is believed, either sign, and its standard deviation."""
    return min(abs(wind) + DEVIATIONS * sd, MOST_WIND)
