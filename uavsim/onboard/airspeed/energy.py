"""The aided filter's core: the extended Kalman filter of the energy-rate model, and what it is told beside readings.

The model, `energy_model`, has the states, their dynamics and the two pressures, and the filter's steps on them. Here
stand the start, and everything else that changes a variance: the estimator and the watch over the ports say what has
happened, by a method of that name, and only the filter writes to its covariance.
"""

from dataclasses import dataclass

from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed.energy_model import B, D, EnergyModel, K, P, S, V, covariance_at_rest


@dataclass(slots=True)
class Beside:
    """A quantity c that stays as it is beside the state: its value, its variance, its covariances with the state.

    `of_other` is the covariance with another such quantity, if there is one; both hold it.
    """

    value: float = 0.0
    variance: float = 0.0
    of_v: float = 0.0
    of_b: float = 0.0
    of_p: float = 0.0
    of_s: float = 0.0
    of_d: float = 0.0
    of_k: float = 0.0
    of_other: float = 0.0


Others = tuple[tuple[float, Beside], ...]
"""Quantities beside the state, two at the most, each with the derivative of what is read by it."""

SEVEN_R = 7.0 * GAS_CONSTANT_DRY_AIR  # J/(kg·K): 2·c_p, v²/(7·R·T) = (γ − 1)/2·M²


class EnergyFilter(EnergyModel):
    """State and covariance of one flight; `EnergyModel` has the steps.

    Parameters
    ----------
    speed_sd : float
        Of the airspeed at the start, m/s.
    rest_force, rest_sd : float
        What f_x reads at rest and how well that is known, m/s².
    bias_sd, bias_time : float
        Of b, m/s² and s.
    slope_rate, slope_time : float
        Of s, (m/s²)/√s and s.
    static, static_sd, static_walk : float
        Static pressure at the start, Pa, and its random walk beside the climb, Pa/√s.
    difference_sd, difference_walk : float
        Of d at the start, Pa, and its random walk, Pa/√s.
    acceleration_sd : float
        Of k, Pa/(m/s²).
    speed : float
        Airspeed at the start, m/s.
    relative : bool
        Whether the total pressure is read relative to the static one, by a differential sensor.
    """

    __slots__ = ()

    def __init__(
        self,
        *,
        speed_sd: float,
        rest_force: float,
        rest_sd: float,
        bias_sd: float,
        bias_time: float,
        slope_rate: float,
        slope_time: float,
        static: float,
        static_sd: float,
        static_walk: float,
        difference_sd: float,
        difference_walk: float,
        acceleration_sd: float,
        speed: float = 0.0,
        relative: bool = False,
    ) -> None:
        self._bias_time, self._bias_density = bias_time, 2.0 * bias_sd**2 / bias_time
        self._slope_density, self._slope_time = slope_rate**2, slope_time
        self._static_density = static_walk**2
        self._difference_density = difference_walk**2
        self._relative, self._learns = 1.0 if relative else 0.0, 1.0
        self.b = self.d = self.k = self.innovation = 0.0
        self.taken = True
        self.v, self.s, self.p = speed, rest_force, static
        self.vb = self.vp = self.vs = self.vd = self.vk = self.bp = self.bd = self.bk = 0.0
        self.ps = self.pd = self.pk = self.sd = self.sk = self.dk = 0.0
        known = covariance_at_rest(
            speed_sd=speed_sd,
            bias_sd=bias_sd,
            static_sd=static_sd,
            rest_sd=rest_sd,
            difference_sd=difference_sd,
            acceleration_sd=acceleration_sd,
        )
        self.vv, self.bb, self.bs, self.ss = known[V, V], known[B, B], known[B, S], known[S, S]
        self.pp, self.dd, self.kk = known[P, P], known[D, D], known[K, K]

    # -- what it is told beside readings ------------------------------------------------------------------------------

    def know_push(self) -> float:
        """Take k for known from here on; return what its variance was, (Pa/(m/s²))²."""
        variance, self.kk = self.kk, 0.0
        self.vk = self.bk = self.pk = self.sk = self.dk = 0.0
        return variance

    @property
    def learns(self) -> bool:
        """Whether readings correct d."""
        return self._learns > 0.0

    def hold_difference(self) -> None:
        """Let d be what it is from here on, and as well known; it keeps its part in what is not known of V (Schmidt).

        In flight δd = −ρV δV can hardly be read: only by a change of V that the force knows. What the filter makes of
        gusts is false, for its slopes are those of estimates that gusts have moved: with d known to 8 Pa, V drifts away
        by 3 m/s in a minute of turbulence.
        """
        self._learns = 0.0

    def read_relative(self, relative: bool) -> None:
        """Be told whether total pressures are read relative to the static one from here on."""
        self._relative = 1.0 if relative else 0.0

    def restart(self, speed: float, variance: float) -> None:
        """Forget the airspeed for another, m/s, of the given variance, m²/s²."""
        self.v, self.vv = speed, variance
        self.vb = self.vp = self.vs = self.vd = self.vk = 0.0

    def turn(self, speed: float, variance: float, x: float, y: float, beside: Beside) -> None:
        """Be told that the airspeed is along another path, m/s, with this variance, m²/s²: V = x v + y c."""
        self.v, self.vv = speed, variance
        self.vb = x * self.vb + y * beside.of_b
        self.vp = x * self.vp + y * beside.of_p
        self.vs = x * self.vs + y * beside.of_s
        self.vd = x * self.vd + y * beside.of_d
        self.vk = x * self.vk + y * beside.of_k

    def resolve_difference(self, change: float, variance: float, others: Others) -> None:
        """Be told that d is more than it was by a function of quantities beside the state, whose covariances follow.

        Parameters
        ----------
        change, variance : float
            The function's value, Pa, and what its curvature adds to the variance of d, Pa².
        others : tuple
            The quantities and the function's derivatives by them.
        """
        self.d += change
        of = 0.0
        for h, c in others:
            of += h * c.of_d
            self.vd += h * c.of_v
            self.bd += h * c.of_b
            self.pd += h * c.of_p
            self.sd += h * c.of_s
            self.dk += h * c.of_k
        for h, c in others:
            c.of_d += h * c.variance + sum(g * c.of_other for g, other in others if other is not c)
        self.dd += variance + of + sum(h * c.of_d for h, c in others)

    def tie_difference(self, covariance: float) -> None:
        """Know that d goes with the airspeed, by as much more, Pa·m/s."""
        self.vd += covariance

    def total_beside(self, above: float, variance: float, pushed: float, hv: float, others: Others) -> float:
        """Take a total pressure that depends on v and on quantities beside the state, which are corrected, too.

        Parameters
        ----------
        above : float
            By how much the reading, tared and freed of the known error, is above what the port reads of v and of the
            quantities at p, Pa.
        variance, pushed : float
            As of `total`.
        hv : float
            Derivative of what the port reads by v.
        others : tuple
            The quantities, and those by them.

        Returns
        -------
        float
            Normalised innovation squared.
        """
        hp = 1.0 - self._relative
        gv = hv * self.vv + hp * self.vp + self.vd + pushed * self.vk
        gb = hv * self.vb + hp * self.bp + self.bd + pushed * self.bk
        gp = hv * self.vp + hp * self.pp + self.pd + pushed * self.pk
        gs = hv * self.vs + hp * self.ps + self.sd + pushed * self.sk
        gd = hv * self.vd + hp * self.pd + self.dd + pushed * self.dk
        gk = hv * self.vk + hp * self.pk + self.dk + pushed * self.kk
        for h, c in others:
            gv += h * c.of_v
            gb += h * c.of_b
            gp += h * c.of_p
            gs += h * c.of_s
            gd += h * c.of_d
            gk += h * c.of_k
        spread = hv * gv + hp * gp + gd + pushed * gk + variance
        of = []
        for h, c in others:
            gc = hv * c.of_v + hp * c.of_p + c.of_d + pushed * c.of_k + h * c.variance
            for g, other in others:
                if other is not c:
                    gc += g * c.of_other
            spread += h * gc
            of.append((gc, c))
        return self._correct_beside(above - self.d - pushed * self.k, spread, (gv, gb, gp, gs, gd, gk), of)

    def predict_beside(
        self, beside: Beside, dt: float, gained: float, variance: float, density: float, railed: bool
    ) -> None:
        """Advance a quantity's covariances with the state, before `predict`, whose arguments these are.

        The quantity stays, but for a variance of its own, m²/s², as large as that of v.
        """
        c = beside
        slope, steep = self.s, -density * (self.v + 0.5 * (gained - dt * (self.b + self.s))) * dt
        c.of_p += -density * slope * dt * c.of_v + steep * c.of_s
        c.of_v -= dt * (c.of_b + c.of_s)
        if not railed:
            c.of_b *= 1.0 - dt / self._bias_time
            c.of_s *= 1.0 - dt / self._slope_time
        c.variance += variance

    def static_beside(self, reading: float, variance: float, ahead: float, others: Others) -> float:
        """Take a static pressure as `static`, which depends on quantities beside the state, too."""
        gv = self.vp + ahead * self.vs
        gb = self.bp + ahead * self.bs
        gp = self.pp + ahead * self.ps
        gs = self.ps + ahead * self.ss
        gd = self.pd + ahead * self.sd
        gk = self.pk + ahead * self.sk
        for h, c in others:
            gv += h * c.of_v
            gb += h * c.of_b
            gp += h * c.of_p
            gs += h * c.of_s
            gd += h * c.of_d
            gk += h * c.of_k
        innovation, spread = reading - self.p - ahead * self.s, gp + ahead * gs + variance
        of = []
        for h, c in others:
            gc = c.of_p + ahead * c.of_s + h * c.variance
            for g, other in others:
                if other is not c:
                    gc += g * c.of_other
            spread += h * gc
            of.append((gc, c))
        return self._correct_beside(innovation, spread, (gv, gb, gp, gs, gd, gk), of)

    def _correct_beside(
        self,
        innovation: float,
        spread: float,
        g: tuple[float, float, float, float, float, float],
        of: list[tuple[float, Beside]],
    ) -> float:
        """Correct state and quantities by an innovation; g and those of `of` are their covariances with it."""
        nis = self._correct(innovation, spread, *g)
        if not self.taken:
            return nis
        gv, gb, gp, gs, gd, gk = g
        for gc, c in of:
            gain = gc / spread
            c.value += gain * innovation
            c.variance -= gain * gc
            c.of_v -= gain * gv
            c.of_b -= gain * gb
            c.of_p -= gain * gp
            c.of_s -= gain * gs
            c.of_d -= gain * gd
            c.of_k -= gain * gk
        if len(of) == 2:
            (one, c), (two, other) = of
            c.of_other = other.of_other = c.of_other - one * two / spread
        return nis

    def shift_speed(self, change: float) -> None:
        """Move the airspeed, m/s, which is known as well as before."""
        self.v += change

    def shift_static(self, change: float) -> None:
        """Move the static pressure, Pa, which is known as well as before."""
        self.p += change

    def widen_speed(self, variance: float) -> None:
        """Know the airspeed less well, by a variance of that, m²/s²."""
        self.vv += variance

    def widen_bias(self, variance: float) -> None:
        """Know b less well, by a variance of that, (m/s²)²."""
        self.bb += variance

    def widen_static(self, variance: float) -> None:
        """Know the static pressure less well, by a variance of that, Pa²."""
        self.pp += variance

    def leave_rail(self, climb_variance: float) -> None:
        """Know nothing of the rail: s is of the given variance, (m/s²)², and has nothing to do with b."""
        self.bs, self.ss = 0.0, climb_variance

    # -- without the total pressure's port -----------------------------------------------------------------------------

    def coast_from(self, speed: float, variance: float, bias: float, bias_variance: float, since: float) -> None:
        """Begin to coast: V and b are what they were a time `since`, s, ago, carried on without the total pressure.

        Parameters
        ----------
        speed, variance : float
            V now, m/s, and its variance, m²/s².
        bias, bias_variance : float
            b then, m/s² and (m/s²)²; over the time its error has gone into V.
        since : float
            s.
        """
        self.v, self.vv = speed, variance
        self.b, self.bb = bias, bias_variance
        self.vb = -bias_variance * since
        self._part()

    def coast(self, dt: float, gained: float, variance: float, density: float, bias: float, static: float) -> float:
        """Advance by energy rate alone: V takes what p gains, and p tells nothing of V and b in return.

        Parameters
        ----------
        dt, gained, variance, density
            As of `predict`.
        bias : float
            b, m/s², which stays; its deviation from that wanders as b does.
        static : float
            Static pressure at the last step, Pa: what p has gained since goes into V.

        Returns
        -------
        float
            The static pressure for the next step, Pa.
        """
        v, p = self.v, self.p
        self.b = 0.0
        self.predict(dt, gained, variance, density, False)
        self.v = v + gained - dt * bias + (p - static) / (density * max(v, 10.0))
        self.b = bias
        self._part()
        return p

    def _part(self) -> None:
        """Forget what V and b have to do with the rest."""
        self.vp = self.vs = self.vd = self.vk = self.bp = self.bs = self.bd = self.bk = 0.0

    # -- without the static port ---------------------------------------------------------------------------------------

    def leave_static(
        self,
        *,
        static: tuple[float, float],
        slope: tuple[float, float],
        bias: tuple[float, float],
        tied: float,
        density: float,
        unseen: float,
    ) -> None:
        """Be told that the static pressure has been wrong for a while, and V by what the total pressure made of it.

        Parameters
        ----------
        static, slope, bias : tuple of float
            p, Pa, s and b, m/s²: what they are rather; of s and b the variance, of p what is added to its variance.
        tied : float
            Covariance of p and s.
        density : float
            ρ, kg/m³.
        unseen : float
            What V may have been off by before, m/s.
        """
        p, added = static
        slope_v = density * max(self.v, 1.0)
        self.v += (self.p - p) / slope_v
        self.pp += added
        self.vv += self.pp / slope_v**2 + unseen * unseen
        self.p = p
        self.s, self.ss = slope
        self.b, self.bb = bias
        self.ps = tied
        self.vb = self.pd = self.pk = self.sd = self.sk = 0.0
        self._part()
