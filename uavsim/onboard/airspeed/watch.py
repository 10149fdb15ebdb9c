"""The watch over the total pressure: the tests' bookkeeping, and the way back to where the port was last believed.

A port that freezes is followed by the filter until the tests are sure, and V and b are by then what it made of them. So
the last instant at which the live port was the better explanation is kept, with V, b and p. From there V is carried on
by energy rate alone,

    V = V₀ + ∫ f_x dt − b T + (p − p₀)/(ρ V₀),        σ_V² = σ₀² + (σ_b T)² + gust · T + (σ_p/ρV₀)² + u²

with T the time since, b and σ_b those of the slower filter of `frozen`, and u what a port may have been off by before.
"""

from math import inf

from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.frozen import STILL, FrozenTest
from uavsim.onboard.airspeed.monitor import PortMonitor
from uavsim.onboard.airspeed.settings import AidedSettings

GAP = 0.1  # s without a total pressure, after which the tests begin anew
UNSEEN = 0.5  # m/s, what a port may have been off by before the tests began to doubt it


class TotalWatch:
    """Tests of the total pressure's port.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of the air.
    variance : float
        Of a reading's noise, Pa².
    walk : float
        Random walk of the pair's difference, Pa/√s.

    Attributes
    ----------
    port : PortMonitor
    """

    __slots__ = ("_bb", "_bias", "_bias_sd", "_declared", "_p", "_still", "_t", "_t0", "_u", "_u0", "_v", "_vv", "port")

    def __init__(self, aided: AidedSettings, variance: float, walk: float) -> None:
        self._declared = aided.gust_sd > aided.gust_floor
        self._still = 2.0 * STILL * STILL / aided.gust_length
        self._bias_sd = aided.bias_sd
        self.port = PortMonitor(aided.bias_sd, variance, walk, self._declared)
        self._t = self._t0 = -inf
        self._u = self._u0 = self._v = self._vv = self._p = self._bias = self._bb = 0.0

    def take(
        self, energy: EnergyFilter, t: float, gained: float, reading: float, nis: float, density: float, gust: float
    ) -> str:
        """Take a reading that the filter has taken; return what is wrong with the port, "" for nothing.

        Parameters
        ----------
        energy : EnergyFilter
            At `t`, the reading's instant, s.
        gained : float
            ∫ f_x dt up to there, m/s.
        reading : float
            Tared, Pa.
        nis : float
            Normalised innovation squared.
        density, gust : float
            Of the air, kg/m³, and of its gusts, 2 σ²/L, m/s².
        """
        port, dt, v = self.port, t - self._t, energy.v
        test = port.frozen
        if dt > GAP:
            test = port.frozen = FrozenTest(port.variance, self._declared)
            dt, self._u, self._t0 = 0.0, gained, -inf
        believed = gust if self._declared else self._still
        reach = believed * v * dt
        if test.add(reading, energy.p, energy.pp, gained - self._u, dt, density * v, reach) == 0.0 or self._t0 == -inf:
            self._t0, self._u0, self._v, self._vv, self._p = t, gained, v, energy.vv, energy.p
            self._bias, self._bb = test.bias, test.bb
        self._t, self._u = t, gained
        return port.add(t, reading, energy.innovation, nis, energy.b)

    def go_back(self, energy: EnergyFilter, density: float, gust: float) -> float:
        """Put the filter to where it would be without what it took since the port was last believed; return b, m/s²."""
        since, slope = self._t - self._t0, density * self._v
        energy.v = self._v + self._u - self._u0 - self._bias * since + (energy.p - self._p) / slope
        bb = min(self._bb, self._bias_sd * self._bias_sd)
        energy.vv = self._vv + gust * self._v * since + bb * since * since + UNSEEN * UNSEEN
        energy.vv += energy.pp / (slope * slope)
        energy.b, energy.bb = 0.0, bb
        energy.vb = -bb * since
        energy.vp = energy.vs = energy.vd = energy.vk = energy.bp = energy.bs = energy.bd = energy.bk = 0.0
        return self._bias
