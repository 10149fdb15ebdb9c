"""A vessel of compressed air that drives a piston, whose rope pulls a carriage with the aircraft.

Vessel (1) and cylinder (2) hold ideal gas and exchange no heat; between them a valve is an orifice of the area a(t):

    ṁ = C a p₁/√(R T₁) · ψ(p₂/p₁)        ψ = √(2γ/(γ−1) (π^(2/γ) − π^((γ+1)/γ)),  π no less than the critical ratio
    ṗ₁ = −γ R T₁ ṁ/V₁                    ṗ₂ = γ (R T₁ ṁ − p₂ A v/r)/V₂,          V₂ = V_d + A s/r

with A the piston's area, r how many metres the carriage moves for one of the piston, and s, v its way and speed (ISO
6358 has the orifice; the balance is that of the energy of each gas). The rope pulls with

    F = η (p₂ − p_a) A/r

until the piston meets its end. What is left out: heat, the mass of rope and piston, the rope's stretch, leaks, gas that
flows back.
"""

from math import pi, sqrt

from uavsim.plants.launchers.push import Load, through_carriage
from uavsim.plants.launchers.settings import PneumaticSettings

GAMMA, GAS = 1.4, 287.05  # dry air; J/(kg K)
CRITICAL = (2.0 / (GAMMA + 1.0)) ** (GAMMA / (GAMMA - 1.0))
TEMPERATURE = 288.15  # K, of the gas in the vessel: it has stood there. By hand; the force does not depend on it much
PARTS = 10  # of a step of 1 ms or less, in which the gas is followed


def outflow(ratio: float) -> float:
    """ψ, of the pressure behind an orifice over that before it."""
    if ratio >= 1.0:
        return 0.0
    p = ratio if ratio > CRITICAL else CRITICAL
    return sqrt(2.0 * GAMMA / (GAMMA - 1.0) * (p ** (2.0 / GAMMA) - p ** ((GAMMA + 1.0) / GAMMA)))


class Pneumatic:
    """The push of a pneumatic launcher, a `Push`.

    Parameters
    ----------
    settings : PneumaticSettings
    load : Load

    Attributes
    ----------
    vessel, cylinder : float
        Absolute pressures, Pa.
    gas : float
        Mass of what is in the vessel, kg.
    """

    def __init__(self, settings: PneumaticSettings, load: Load) -> None:
        self._settings, self._load = settings, load
        self._area = pi / 4.0 * settings.bore**2
        self._valve = settings.discharge * pi / 4.0 * settings.valve**2
        self.vessel = load.pressure + settings.pressure * load.factor
        self.cylinder = load.pressure
        self.gas = self.vessel * settings.vessel / (GAS * TEMPERATURE)
        drive = settings.efficiency * settings.pressure * load.factor * self._area / settings.ratio
        self.peak = through_carriage(drive, load, settings.carriage, settings.friction, 0.0)
        self.rise = settings.opening

    def mean(self, since: float, way: float, speed: float, held: float, against: float) -> float:
        """As of `Push`."""
        s, step = self._settings, self._load.step
        begins = max(0.0, -since)
        if begins >= step:
            return 0.0
        part, total = (step - begins) / PARTS, 0.0
        for k in range(PARTS):
            done = begins + (k + 0.5) * part
            here = way + speed * done
            if here >= s.travel or done > held * step:
                break
            self._flow(since + done, here, speed, part)
            drive = s.efficiency * (self.cylinder - self._load.pressure) * self._area / s.ratio
            total += part * through_carriage(drive, self._load, s.carriage, s.friction, against)
        return total / step

    def _flow(self, since: float, way: float, speed: float, time: float) -> None:
        """Let gas flow for a time, s."""
        s = self._settings
        volume = s.dead + self._area * max(way, 0.0) / s.ratio
        heat = self.vessel * s.vessel / self.gas  # R T₁
        open_to = self._valve * min(1.0, since / s.opening)
        flow = open_to * self.vessel / sqrt(heat) * outflow(self.cylinder / self.vessel) * time
        # no more than makes both pressures alike: a small cylinder fills faster than a step follows
        most = max(0.0, self.vessel - self.cylinder) / (GAMMA * heat * (1.0 / s.vessel + 1.0 / volume))
        flow = min(flow, most)
        self.vessel -= GAMMA * heat * flow / s.vessel
        self.cylinder += GAMMA * (heat * flow - self.cylinder * self._area * speed / s.ratio * time) / volume
        self.gas -= flow
