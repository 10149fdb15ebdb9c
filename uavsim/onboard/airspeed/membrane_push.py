"""What pushes the membranes of the pressure sensors: the specific force above that at rest, m/s².

It is the mean over a total pressure's conversion. In flight the force changes so slowly that the mean since the last
reading serves. The answer is held and averaged while it changes by no more than its noise. Else the filter would take
that noise for a push, and believe that it learns from it what a push does to the membranes.
"""

from math import sqrt

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.rest_force import RestForce
from uavsim.onboard.airspeed.speed_gained import SpeedGained

# standard deviations of a mean force within which it is taken for the one before: some 1 in 16 000 of the same are
# beyond. By hand
SAME = 4.0
# m/s². In flight the force less that at rest is below it, and the mean since the last reading serves. Above it, in the
# stroke, the mean over the conversion itself is taken. By hand
GENTLE = 10.0
SETTLED = 32  # readings, after which a mean is left as it is: a sixth of one reading's noise is no push. By hand


class MembranePush:
    """The present push.

    Parameters
    ----------
    noise : NoiseModel
        Of head and accelerometer.
    gained, rest : SpeedGained, RestForce
        Of the readings of specific force.

    Attributes
    ----------
    held : float
        The last answer, m/s².
    """

    __slots__ = ("_count", "_gained", "_lag", "_rest", "_same", "_window", "held")

    def __init__(self, noise: NoiseModel, gained: SpeedGained, rest: RestForce) -> None:
        self._gained, self._rest, self._lag = gained, rest, noise.total_lag
        self._window = noise.total_window or 1.0 / noise.accelerometer_rate
        self._same = SAME * noise.accelerometer_sd / sqrt(max(1.0, noise.total_window * noise.accelerometer_rate))
        self.forget()

    def forget(self) -> None:
        """Begin at rest."""
        self.held, self._count = 0.0, 1

    def over(self, end: float, force: float) -> float:
        """Return the push over a conversion that ends then, s; `force` is that since the last reading, m/s²."""
        if not (-GENTLE < force < GENTLE and -GENTLE < self.held < GENTLE):
            end -= self._lag
            at = self._gained.at
            force = (at(end)[0] - at(end - self._window)[0]) / self._window - self._rest.mean
        if abs(force - self.held) < self._same:
            if self._count < SETTLED:
                self._count += 1
                self.held += (force - self.held) / self._count
        else:
            self.held, self._count = force, 1
        return self.held
