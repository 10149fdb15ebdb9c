"""A stretched cord that pulls a hook under the aircraft until it is slack.

    F(s) = (1 − h) k (S − s)    for s < S

with k its stiffness, S how far it is stretched at the latch and h the share of the stored energy that rubber keeps
(hysteresis: it comes back along a lower line than it was stretched along). A third of the cord's mass moves with the
aircraft, as of a spring whose one end is held. The hook lets go where the cord is slack, or at the end of the rail.
What is left out: the cord's weight and drag, its bend to the line of the rail, creep and cold.
"""

from uavsim.plants.launchers.push import Load, through_carriage
from uavsim.plants.launchers.settings import BungeeSettings

MOVING = 1.0 / 3.0  # of a spring's mass, whose one end is held (Rayleigh)
RISE = 0.002  # s: the hook is tight from the start. By hand, for what shakes the airframe only


class Bungee:
    """The push of a cord, a `Push`.

    Parameters
    ----------
    settings : BungeeSettings
    load : Load
    """

    def __init__(self, settings: BungeeSettings, load: Load) -> None:
        self._settings, self._load = settings, load
        self._carried = MOVING * settings.mass
        self._stiffness = (1.0 - settings.hysteresis) * settings.stiffness * load.factor
        self.peak = through_carriage(self._stiffness * settings.stretch, load, self._carried, 0.0, 0.0)
        self.rise = RISE

    def mean(self, since: float, way: float, speed: float, held: float, against: float) -> float:
        """As of `Push`."""
        step = self._load.step
        acts = min(held, 1.0 + since / step) if since < 0.0 else held
        stretched = self._settings.stretch - way - 0.5 * speed * step
        if stretched <= 0.0 or acts <= 0.0:
            return 0.0
        return acts * through_carriage(self._stiffness * stretched, self._load, self._carried, 0.0, against)
