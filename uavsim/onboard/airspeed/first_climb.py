"""Whether the static port lives: it has to leave the pressure of the rail when the aircraft climbs for the first time.

A static port that was shut before the launch reads that pressure for ever. It hides Δp = ρ g h, and the airspeed is too
low by Δp/(ρV) and, since the filter sees no climb, too high by g h/V for what the force says. So four things tell:

* **Life.** Any change of the mean static pressure by more than `MOVED`, of climb or of the port's own error, shows that
  it is open. On a rail of 12° that is so 0.1 m behind its end.
* **Odds.** On the rail the height is s sin θ, with s the way by the force. So an open port reads p₀ + e q − ρ g s sin θ
  with its known position error e, a shut one p₀. Each reading r of the noise σ says

      ln (P_shut/P_open) += ½ (r − p_open)²/S − ½ (r − p₀)²/σ² + ½ ln(S/σ²),    S = σ² + what is not known of p_open

* **Loss.** Energy rate is V V̇ = V f_x + ṗ/ρ. With V̂ the airspeed of the pressures since the push,

      D = V̂ − V̂₀ − ∫ (f_x − b) dt = −2 g h/V    if the port is shut, and −g h/V with the h that is seen, if it lives

  A static pressure that has not moved while D falls below `LOST` is shut: of the three that could be to blame (a total
  port that begins to leak, an offset of f_x that arises in the push) it is the one that has never shown life.
* **Climb.** Whatever the air does to V, the accelerometer says how the path bends (`felt_climb`). A port that should
  have moved by five standard deviations of that height more than it has is shut. In gusts D tells it too late: in a
  headwind that grows by 2 m/s over the first 10 m of height, and a gust of 1 m/s, −6 m/s is −3.

Until it has shown life, what it may hide is in the bar: ρ g h with the h that the rail's elevation gives, as far as
`HIGHEST`, or what D says, times √P_shut: the standard deviation of an error that is there with the probability P_shut.
D limits the h of the rail, too: what is hidden is −½ ρ V D, and D is known to `LOSS_SD`. Where D has stayed above
`LEVEL` for `SETTLES` after the aircraft should have been at `HIGHEST`, it flies level: an open port need not move.
"""

from math import exp, inf, log, nan, sin, sqrt

from uavsim.onboard.airspeed.felt_climb import UNSURE, FeltClimb
from uavsim.onboard.airspeed.gust import GRAVITY

MEAN = 0.1  # s, of the mean pressure
# Pa, and standard deviations of a reading, by which the mean must have left the rail's: a live port's, 0.6 m of height.
# Noise of the mean is a quarter of a reading's. By hand
MOVED, MOVED_SD = 6.0, 1.5
LIVES = 0.1  # s, for which it must have. By hand: no single spike
# m/s: 5 m of height at 25 m/s. Unfolding and an unknown b make 0.6 in the second that it takes. By hand
LOST = -3.0
SUDDEN = 0.3  # m/s between two readings, which no climb takes from V. By hand
HIGHEST = 10.0  # m of height, by which it is decided, or the flight is a level one, which tells nothing
# m/s, standard deviation of D in the first seconds: wings that unfold, 0.6, a change of the gust, 1, an unknown b. By
# hand
LOSS_SD = 1.5
# m/s, and s: a climb of 1.5 m at 30 m/s in the 4 s since the rail makes −1. Where V is so great that the 10 m make less
# than −2, half of theirs. A port that is shut in level flight shows in the next climb (`frozen`). By hand
LEVEL, SETTLES = -1.0, 2.0
# nats: one port in a thousand is shut before a launch, by hand: a crew looks. Between the bounds a wrong turn can be
# taken back within some readings
PRIOR, LEAST_ODDS, MOST_ODDS = -7.0, -16.0, 5.0
SAID = 3.0  # nats that one reading may say at the most: no spike decides. By hand
# standard deviations by which the climb that f_z says must be more than the port has moved. By hand: at 3 a shut port
# off a rail of 12° was named at 2 or 3 m of height, sooner than the 10 m that are asked; 5 leaves a live one more room
SURE = 5.0
# Pa/(m/s) of V: a live port's least standard deviation from what the climb says, as `climb.LEAST_OF_V`
LEAST_OF_V = 0.1


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
    risen : float
        When it was found shut, the height that it hides, m.
    """

    __slots__ = (
        "_beyond", "_climbed_for", "_felt", "_height", "_level_for", "_mean", "_moved_for", "_need", "_odds",
        "_reference", "_slope", "_variance", "hidden", "lost", "open", "rest", "risen",
    )  # fmt: skip

    def __init__(self) -> None:
        self.open = False
        self.hidden = self.lost = self.rest = self._mean = self._height = self._moved_for = self._slope = 0.0
        self._level_for = self._climbed_for = self.risen = 0.0
        self._felt = FeltClimb(0.0, 0.0)
        self._need, self._reference, self._beyond, self._odds, self._variance = inf, 0.0, 0.0, PRIOR, 1.0

    def begin(self, rest: float, sd: float, elevation: float, lift_sd: float = 0.0) -> None:
        """Begin on the rail.

        Parameters
        ----------
        rest, sd : float
            Its pressure and the noise of a reading, Pa.
        elevation : float
            rad.
        lift_sd : float
            What f_z may be off by, m/s².
        """
        self.open = True
        self.rest = self._mean = rest
        self.hidden = self.lost = self._height = self._moved_for = self._level_for = self._climbed_for = 0.0
        self._need, self._slope = max(MOVED, MOVED_SD * sd), sin(elevation) if elevation > 0.0 else 0.0
        self._felt = FeltClimb(self._slope, lift_sd)
        self._reference, self._beyond, self._odds, self._variance = inf, 0.0, PRIOR, sd * sd

    def add(
        self,
        reading: float,
        dt: float,
        speed: float,
        gained: float,
        density: float,
        pushed: bool,
        *,
        ground: float,
        position: float,
        position_sd: float,
        lift: float = nan,
    ) -> bool:
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
        ground : float
            Speed over the ground by the force, m/s.
        position, position_sd : float
            The port's known position error and the standard deviation of the rest, shares of q.
        lift : float
            −f_z, m/s²; NaN where it is not known.
        """
        self._felt.add(dt, speed, gained, ground, lift)
        self._mean += (reading - self._mean) * (dt / MEAN if dt < MEAN else 1.0)
        if not -self._need < self._mean - self.rest < self._need:
            self._moved_for += dt
            if self._moved_for >= LIVES:
                self.open, self.hidden = False, 0.0
            return False
        self._moved_for = 0.0
        if self._height < HIGHEST and ground > 0.0:
            risen = self._slope * ground * dt
            self._height += risen
            self._beyond += 0.0 if pushed else risen
        if pushed or self._reference == inf:
            self._reference = speed - gained
        lost = speed - gained - self._reference
        if not -SUDDEN < lost - self.lost < SUDDEN:  # no climb, but a total pressure that was wrong
            self._reference += lost - self.lost
            lost = self.lost
        self.lost = lost
        impact = 0.5 * density * speed * speed
        self._weigh(reading, density * GRAVITY, position * impact, position_sd * impact)
        hidden, halved = density * GRAVITY * self._height, 0.5 * density * speed
        if not pushed:
            hidden = min(hidden, halved * (max(0.0, -lost) + LOSS_SD))
        if lost < 0.0:
            hidden = max(hidden, -halved * lost)
        self.hidden = hidden / sqrt(1.0 + exp(-self._odds))
        shut = lost < LOST and self._odds > PRIOR - SAID  # a gust can lose as much while the readings speak for life
        self.risen = -0.5 * lost * speed / GRAVITY
        if self._climbs(dt, density * GRAVITY, position * impact, position_sd * impact, speed):
            shut, self.risen = True, self._felt.height
        if shut or self._flies_level(dt, speed):
            self.open, self.hidden = False, 0.0
        return shut

    def _climbs(self, dt: float, weight: float, error: float, error_sd: float, speed: float) -> bool:
        """Whether f_z has said for long enough that an open port would have moved; arguments as of `_weigh`."""
        felt, least = self._felt, LEAST_OF_V * speed
        spread = (weight * felt.height_sd) ** 2 + error_sd * error_sd + least * least
        moves = weight * felt.height - error - self._need
        self._climbed_for = self._climbed_for + dt if moves > 0.0 and moves * moves > SURE * SURE * spread else 0.0
        return self._climbed_for >= LIVES

    def _flies_level(self, dt: float, speed: float) -> bool:
        """Whether the force has shown for long enough that the aircraft has not climbed as its rail points."""
        if self._height >= HIGHEST and self.lost > LEVEL and self.lost * speed > -GRAVITY * HIGHEST:
            self._level_for += dt
        else:
            self._level_for = 0.0
        return self._level_for >= SETTLES

    def _weigh(self, reading: float, weight: float, error: float, error_sd: float) -> None:
        """Weigh a shut port against an open one by a reading, Pa, in air of ρ g, Pa/m; both of the errors in Pa."""
        shut = reading - self.rest
        on_rail = self._height - self._beyond
        spread = self._variance + (UNSURE * weight * on_rail) ** 2 + (weight * self._beyond) ** 2 + error_sd * error_sd
        risen = shut - error + weight * on_rail
        said = 0.5 * (risen * risen / spread - shut * shut / self._variance + log(spread / self._variance))
        odds = self._odds + (SAID if said > SAID else -SAID if said < -SAID else said)
        self._odds = LEAST_ODDS if odds < LEAST_ODDS else MOST_ODDS if odds > MOST_ODDS else odds
