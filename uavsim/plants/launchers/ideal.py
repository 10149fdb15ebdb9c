"""A constant specific force: rises linearly to its plateau, stays, and falls linearly to 0 at the end of the stroke.

    F(t) = m g0 n(t)

where the fall begins at the first moment at which the remaining way is no longer than what the aircraft will run while
the push dies away: v t_fall + (n g0 / 3 − g sin(θ) / 2) t_fall². It is integrated in closed form, with its fall
beginning where it does, within a step.
"""

from uavsim.plants.launchers.push import Load
from uavsim.truth import STANDARD_GRAVITY


def ramp(since: float, length: float) -> float:
    """Integral of what rises evenly from 0 to 1 in `length` and then stays, s."""
    if since <= 0.0:
        return 0.0
    return 0.5 * since * since / length if since < length else since - 0.5 * length


class Ideal:
    """The push of a specific force, a `Push`.

    Parameters
    ----------
    level : float
        Of the plateau, standard g.
    rise, fall : float
        s.
    load : Load
    """

    def __init__(self, level: float, rise: float, fall: float, load: Load) -> None:
        self.peak = load.mass * STANDARD_GRAVITY * level * load.factor
        self.rise, self._fall, self._load = rise, fall, load
        self._pushed = self.peak / load.mass - load.backward  # m/s² along the rail on the plateau
        self._run_out = (self.peak / load.mass / 3.0 - load.backward / 2.0) * fall**2  # m, at no speed
        self._fall_start: float | None = None

    def mean(self, since: float, way: float, speed: float, held: float, against: float) -> float:
        """As of `Push`."""
        step = self._load.step
        if self._fall_start is None:
            left = self._load.stroke - way - self._run_out - (speed - 0.5 * step * self._pushed) * self._fall
            gained = step * (speed + self._pushed * self._fall)  # what of it is used up in this step
            begins = max(since + step * left / gained if 0.0 < left < gained else since, self.rise)
            if left < gained and begins < since + step:
                self._fall_start = begins
        return (self._impulse(since + held * step) - self._impulse(since)) / step

    def _impulse(self, since: float) -> float:
        """Integral of the push from its beginning until `since` later, N s."""
        lost = 0.0 if self._fall_start is None else ramp(since - self._fall_start, self._fall)
        return self.peak * (ramp(since, self.rise) - lost)
