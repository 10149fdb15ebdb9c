"""A linear motor that makes its carriage follow a curve of acceleration along the rail, whatever it carries.

The motor's controller asks for what moves aircraft and carriage along the curve a(t), and corrects by the speed:

    F = (m + M) [a(t) + ω (∫ a dt − v) + g sin θ] + f_c + f,        no more than its greatest force

The curve is straight between points. The shipped one is that of the recorded strokes of an electromechanical catapult,
the mean of 90: 66 m/s² to 0.18 s, 53 from 0.28 to 0.47 s, zero at 0.611 s, i.e. 30.6 m/s over 10.6 m.
"""

from math import pi

from uavsim.plants.launchers.push import Load, through_carriage
from uavsim.plants.launchers.settings import ElectromechanicalSettings


class Electromechanical:
    """The push of a motor that follows a curve, a `Push`.

    Parameters
    ----------
    settings : ElectromechanicalSettings
    load : Load
    """

    def __init__(self, settings: ElectromechanicalSettings, load: Load) -> None:
        self._settings, self._load = settings, load
        self._curve = [(0.0, 0.0), *settings.curve]
        self._loop = 2.0 * pi * settings.bandwidth
        level = max(a for _, a in self._curve) * load.factor
        self.peak = min(settings.largest_force, (load.mass + settings.carriage) * (level + load.backward))
        self.peak *= load.mass / (load.mass + settings.carriage)
        self.rise = settings.curve[0][0]

    def asked(self, since: float) -> float:
        """Speed that the curve asks for, m/s, `since` its beginning, s."""
        speed = 0.0
        for (t0, a0), (t1, a1) in zip(self._curve, self._curve[1:], strict=False):
            if since <= t0:
                break
            share = min(1.0, (since - t0) / (t1 - t0))
            speed += share * (t1 - t0) * (a0 + 0.5 * share * (a1 - a0))
        return speed * self._load.factor

    def mean(self, since: float, way: float, speed: float, held: float, against: float) -> float:
        """As of `Push`."""
        s, load = self._settings, self._load
        if since + load.step <= 0.0 or since >= self._curve[-1][0]:
            return 0.0
        before, after = self.asked(since), self.asked(since + load.step)
        asked = (after - before) / load.step + self._loop * (0.5 * (before + after) - speed)
        drive = (load.mass + s.carriage) * (asked + load.backward) + s.friction + against
        drive = min(drive, s.largest_force)
        return held * through_carriage(drive, load, s.carriage, s.friction, against)
