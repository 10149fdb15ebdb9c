"""The first total pressure of a launch: from when on it is taken, and on which side of 0 the airspeed is.

A total pressure is the same of V and −V. At rest V is as likely below 0 as above, and a reading would split what is
known in two. So total pressures are left out until the push has brought V to 3 σ_V. What they would have told of the
wind, later ones tell better.

A wind that is seen on the rail is taken for a headwind, V = w. If it was a tailwind, V is 2 w too high. The total
pressure tells as soon as both cases differ by enough for one reading (`rest_wind.turning`).
"""

from math import inf

from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.rest_wind import turning, wind_at_rest

ONE_SIDED = 9.0  # V²/σ_V², three standard deviations, below which V may be of either sign


class Onset:
    """The airspeed before it is known by the pressures.

    Parameters
    ----------
    each : float
        Variance of one reading's pressure difference, Pa².
    tare_end : float
        When the cover comes off, s; −inf without one, and then no wind can be seen.
    wind_sd : float
        Standard deviation of the wind where nothing is read, m/s.

    Attributes
    ----------
    wind : float
        The wind that is taken for a headwind, m/s; 0 for none, or once it is known which it was.
    settled : bool
        Whether total pressures are taken.
    patience : float
        Until when a push is waited for, s.
    """

    __slots__ = ("_each", "_tare_end", "_turning", "_wind_sd", "patience", "settled", "wind")

    def __init__(self, each: float, tare_end: float, wind_sd: float) -> None:
        self._each, self._tare_end, self._wind_sd = each, tare_end, wind_sd
        self.wind = self._turning = 0.0
        self.settled, self.patience = False, inf

    def know(self) -> None:
        """Be told that the wind is known, and its side."""
        self.wind = self._turning = 0.0

    def look(self, seen: tuple[float, float] | None, tare: tuple[float, float], density: float) -> float:
        """Find the wind by what was read on the rail; return its standard deviation, m/s.

        Parameters
        ----------
        seen : tuple of float or None
            The pair's mean difference at rest, Pa, and its variance, Pa².
        tare : tuple of float
            Of the pair, Pa, and its variance, Pa².
        density : float
            Of the air, kg/m³.
        """
        self.wind, sd = 0.0, inf
        if self._tare_end > -inf:
            self.wind, sd = wind_at_rest(seen, *tare, density)
        self._turning = turning(self.wind, self._each, density)
        return min(sd, self._wind_sd)

    def begin(self, patience: float) -> None:
        """Leave total pressures out from now on; from `patience`, s, on V is what they say, without a push, too."""
        self.settled, self.patience = False, patience

    def settle(self, energy: EnergyFilter, time: float, total: float, air: Air) -> bool:
        """Judge by a total pressure, tared, Pa, of an instant, s, whether it and those to come are taken."""
        late = not time < self.patience
        if energy.v * abs(energy.v) < ONE_SIDED * energy.vv:
            if not late:
                return False
            speed = air.speed(total, energy.p)
            energy.restart(speed, max(energy.vv, speed * speed / ONE_SIDED))
        elif self.wind > 0.0:
            if energy.v < self._turning and not late:
                return False
            wind, self.wind = self.wind, 0.0
            if 2.0 * air.speed(total, energy.p) < energy.v + abs(energy.v - 2.0 * wind):  # it was a tailwind
                energy.shift_speed(-2.0 * wind)
                return False
        self.settled = True
        return True
