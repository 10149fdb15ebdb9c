"""The height that the accelerometer says since a launch, without the static pressure.

While the aircraft is pushed it goes where the rail points, with the speed over the ground that the force has given:

    c = v_g sin θ

Behind that, wings level, the specific force turned up by the path's angle γ gives the change of climb, m/s²,

    ċ = −f_z cos γ + f_x sin γ − g,        sin γ = c/V,        h = ∫ c dt

What is not known of it: a share of the height on the rail; of the climb c₀ at the end of the push, which then lasts;
and of ċ, by f_z's offset and by a bank, a time T after it:

    σ_h² = (UNSURE h₀)² + ((CLIMB_SHARE c₀ + CLIMB_SD) T)² + (½ σ_a T²)²

The angle of attack, some hundredths, changes ċ by less. In launches in gusts h was 0.2 m off after 16 m.
"""

from math import hypot, inf, sqrt

from uavsim.onboard.airspeed.gust import GRAVITY

# m/s² of gain in speed, above which it is pushed, as `push_end.LEVEL`. By hand
PUSHED = 6.0
# s since the first 3 m/s, in which a push is that of the launcher. By hand: the longest stroke of a catapult. A motor
# that pushes on does not hold the path to the rail's direction
STROKE, BEGUN = 1.0, 3.0
# share of the height on the rail that is not known: elevation and way. By hand. For the odds of `first_climb`, which go
# without f_z, all of the height that the rail points to beyond its end is unknown
UNSURE = 0.15
# share of c₀, and m/s: elevation (half a degree at 26 m/s is 0.23 m/s), the scale of f_x, and when the push ended
CLIMB_SHARE, CLIMB_SD = 0.05, 0.2
FELT_SD = 0.3  # m/s², of ċ: a bank of 14°, at which 1 − cos φ is 0.03, all the time. By hand
MISSING = 0.1  # s without a plausible f_z, after which nothing is known of the height any more. By hand


class FeltClimb:
    """One launch.

    Parameters
    ----------
    slope : float
        sin θ of the rail.
    lift_sd : float
        What f_z may be off by, m/s².

    Attributes
    ----------
    height, height_sd : float
        Since the launch began, m.
    """

    __slots__ = (
        "_climb", "_gained", "_ground", "_left", "_missing", "_sd", "_since", "_slope", "_start", "height", "height_sd",
    )  # fmt: skip

    def __init__(self, slope: float, lift_sd: float) -> None:
        self._slope, self._sd = slope, hypot(FELT_SD, lift_sd)
        self._gained = self._ground = self._climb = self._start = self._since = self._missing = 0.0
        self._left = (0.0, 0.0)  # climb and height at the end of the push
        self.height = self.height_sd = 0.0

    def add(self, dt: float, speed: float, gained: float, ground: float, lift: float) -> None:
        """Go on by a time, s.

        Parameters
        ----------
        dt, speed, gained, ground : float
            As of `FirstClimb.add`.
        lift : float
            −f_z, m/s²; NaN where it is not known: 1 g then.
        """
        along, pushed = gained - self._gained, ground - self._ground > PUSHED * dt
        self._gained, self._ground = gained, ground
        if not dt > 0.0:
            return
        if ground > BEGUN:
            self._start += dt
        if ground <= BEGUN or (pushed and self._start <= STROKE):
            self._climb = self._slope * ground if ground > 0.0 else 0.0
            self._since, self._left = 0.0, (self._climb, self.height)
        else:
            share = self._climb / speed if speed > BEGUN else 0.0
            share = 0.9 if share > 0.9 else -0.9 if share < -0.9 else share
            felt = lift
            if lift != lift:
                felt, self._missing = GRAVITY, self._missing + dt
            self._climb += (felt * sqrt(1.0 - share * share) - GRAVITY) * dt + along * share
            self._since += dt
        self.height += self._climb * dt
        (climb, height), since = self._left, self._since
        spread = UNSURE * height, (CLIMB_SHARE * climb + CLIMB_SD) * since, 0.5 * self._sd * since * since
        self.height_sd = hypot(*spread) if self._missing < MISSING else inf
