"""Whether the static port lives: it has to leave the pressure of the rail when the aircraft climbs for the first time.

A static port that was shut before the launch reads that pressure for ever. It hides Δp = ρ g h, and the airspeed is too
low by Δp/(ρV) and, since the filter sees no climb, too high by g h/V for what the force says. So two things tell:

* **Life.** Any change of the mean static pressure by more than `MOVED`, of climb or of the port's own error, shows that
  it is open. On a rail of 12° that is so 0.1 m behind its end.
* **Loss.** Energy rate is V V̇ = V f_x + ṗ/ρ. With V̂ the airspeed of the pressures since the push,

      D = V̂ − V̂₀ − ∫ (f_x − b) dt = −2 g h/V    if the port is shut, and −g h/V with the h that is seen, if it lives

  A static pressure that has not moved while D falls below `LOST` is shut: of the three that could be to blame (a total
  port that begins to leak, an offset of f_x that arises in the push) it is the one that has never shown life.

Until it has shown life, what it may hide is in the bar: ρ g h with the h that the rail's elevation gives, as far as
`HIGHEST`, and what D says.
"""

from math import inf, sin

from uavsim.onboard.airspeed.gust import GRAVITY

MEAN = 0.1  # s, of the mean pressure
# Pa, and standard deviations of a reading, by which the mean must have left the rail's: a live port's, 0.6 m of height.
# Noise of the mean is a quarter of a reading's. By hand
MOVED, MOVED_SD = 6.0, 1.5
LIVES = 0.1  # s, for which it must have. By hand: no single spike
# m/s: 5 m of height at 25 m/s. Unfolding and an unknown b make 0.6 in the second that it takes. By hand
LOST = -3.0
HIGHEST = 10.0  # m of height, by which it is decided, or the flight is a level one, which tells nothing
PART = 1.0  # of the height that the rail points to: a standard deviation. By hand


class FirstClimb:
    """One launch.

    Attributes
    ----------
    open : bool
        Whether the port has neither shown life nor been named.
    hidden : float
        Standard deviation of what it may hide, Pa.
    lost : float
        D, m/s.
    rest : float
        The rail's pressure, Pa.
    """

    __slots__ = ("_height", "_mean", "_moved_for", "_need", "_reference", "_slope", "hidden", "lost", "open", "rest")

    def __init__(self) -> None:
        self.open = False
        self.hidden = self.lost = self.rest = self._mean = self._height = self._moved_for = self._slope = 0.0
        self._need, self._reference = inf, 0.0

    def begin(self, rest: float, sd: float, elevation: float) -> None:
        """Begin on the rail: its pressure, Pa, the noise of a reading, Pa, and its elevation, rad."""
        self.open = True
        self.rest = self._mean = rest
        self.hidden = self.lost = self._height = self._moved_for = 0.0
        self._need, self._slope = max(MOVED, MOVED_SD * sd), PART * sin(elevation) if elevation > 0.0 else 0.0
        self._reference = inf

    def add(self, reading: float, dt: float, speed: float, gained: float, density: float, pushed: bool) -> bool:
        """Take a static pressure; return whether the port is shut.

        Parameters
        ----------
        reading : float
            Pa.
        dt : float
            Since the last one, s.
        speed, gained : float
            V̂ and ∫ f_x dt, m/s.
        density : float
            kg/m³.
        pushed : bool
            Whether the push lasts.
        """
        self._mean += (reading - self._mean) * (dt / MEAN if dt < MEAN else 1.0)
        if not -self._need < self._mean - self.rest < self._need:
            self._moved_for += dt
            if self._moved_for >= LIVES:
                self.open, self.hidden = False, 0.0
            return False
        self._moved_for = 0.0
        if self._height < HIGHEST and speed > 0.0:
            self._height += self._slope * speed * dt
        if pushed or self._reference == inf:
            self._reference = speed - gained
        self.lost = lost = speed - gained - self._reference
        self.hidden = density * GRAVITY * self._height
        if lost < 0.0:
            self.hidden = max(self.hidden, -0.5 * density * speed * lost)
        if lost < LOST:
            self.open, self.hidden = False, 0.0
            return True
        return False
