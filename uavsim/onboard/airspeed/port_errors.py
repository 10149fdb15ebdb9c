"""What both ports are off by in flight, as a calibration of the head knows it (`head_errors`), at the present airspeed.

With the flow angles as far as they are known on board (`flow_angles`) both ports are off by a share of the impact
pressure q_c = p_t − p_s, and by a share more that nobody knows. A share e of q_c is one of e/2 of the airspeed.
"""

from math import sqrt

from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.energy_model import isentropic
from uavsim.onboard.airspeed.flow_angles import FlowAngles
from uavsim.onboard.airspeed.head_errors import HeadErrors


class PortErrors:
    """Errors of both ports.

    Parameters
    ----------
    head : HeadErrors
        As the calibration knows them.
    angles : FlowAngles
        From where the air comes.
    air : Air
        That the filter flies in.

    Attributes
    ----------
    any : bool
        Whether there are errors at all.
    throttle : float
        What the propeller blows with, 0 … 1.
    speed_share : float
        Standard deviation of what is not known of them, a share of the airspeed.
    position : float
        c₀/(1 − c₀): the static port's error as a share of what the pair differs by.
    """

    __slots__ = ("_air", "_angles", "_head", "any", "position", "speed_share", "throttle")

    def __init__(self, head: HeadErrors, angles: FlowAngles, air: Air) -> None:
        self._head, self._angles, self._air = head, angles, air
        self.any, self.throttle, self.speed_share = not head.none, 0.0, 0.0
        self.position = head.error / (1.0 - head.error)

    def off(self, energy: EnergyFilter, time: float) -> tuple[float, float, float]:
        """Return what they are at an instant, s, Pa: total, static; and the variance of what is not known, Pa²."""
        head, angles, heat = self._head, self._angles, self._air.heat
        v, p = energy.v, energy.p
        impact = isentropic(v, p, heat) - p
        side2, side2_sd = angles.side(time, v)
        down, down_sd = angles.down(v, self._air.density)
        across = side2 + down * down
        total, static = head.shares(
            sqrt(1.0 - across) if across < 1.0 else 0.0, sqrt(side2), down, 5.0 * v * v / heat, self.throttle
        )
        share = head.spread(side2, side2_sd, down, down_sd, self.throttle)
        self.speed_share = 0.5 * share
        return impact * (total - 1.0), impact * static, (impact * share) ** 2
