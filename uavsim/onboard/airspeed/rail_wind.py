"""The wind on the rail: along it u₀, across it c, and the airspeed V = √(u² + c²) until the rail is left.

The push changes the air's speed along the rail alone, u = u₀ + ∫(f_x − b − s) dt. So the filter's airspeed is u there,
and c is kept beside it, with its variance and its covariances with the state. Both ports read what V and the angle make
of them (`head_errors`).

u₀ and c are believed as the environment declares them, at the height of the head on the rail, ± the turbulence and a
share of the mean wind. After a covered tare the pair reads

    D = P(u₀, c) = q_c(V) (c_t − c_s)

which corrects both. In the wind, or without a tare, the pair's difference at rest is e = d + P(u₀, c) instead, and e is
all that is known. Until the rail is left the filter's d is this e, u₀ is a second quantity beside the state, and

    p_t − p_s = e + P(u, c) − P(u₀, c̄) = e + ½ρ (u − u₀)(u + u₀) + ½ρ c²    of an ideal head, less what M² makes

The force knows u − u₀, so that is a straight line in u₀: whatever the wind was, the push finds it without a bend. (With
d and u₀ for states it bends by ½ρσ² of each, by the same amount in each reading, and readings that count it as noise
of their own know d to a tenth of what they should.) What c was at rest differs from the c̄ that is declared, and from c
in the push, for a gust across is a few metres long: P(u₀, c) − P(u₀, c̄) stays in e, with its variance.

**At the rail's end**, when the push is over, d = e − P(u₀, c̄), and the path turns into the wind: V ← √(u² + c²), with
half the curvatures times the variances, and covariances by the slopes.
"""

from math import hypot, sqrt

from uavsim.onboard.airspeed.energy import Beside, EnergyFilter, Others
from uavsim.onboard.airspeed.energy_model import isentropic
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.airspeed.settings import AidedSettings

SMALL = 0.05  # m/s, of the differences by which the ports' readings are derived
TURNS = 4  # Gauss-Newton's on the rail, where D bends with both
CALM = 1.0  # m/s, standard deviation of a wind that nobody declares: Beaufort 1, which a crew calls calm
GROWTH = 0.28  # dW/W over dh/h near the ground: 1/ln(h/z₀) of the logarithmic law at 1.6 m over short grass
AGO = 0.25  # s, by which the readings on the rail are older than the filter's start: half of their stretch


class RailWind:
    """What is known of the wind while the aircraft is on its rail.

    Parameters
    ----------
    aided : AidedSettings
        What is declared of the wind.
    head : HeadErrors
        Of both ports.

    Attributes
    ----------
    declared : bool
        Whether there is a wind that one knows of.
    on : bool
        Whether the filter's airspeed is u.
    pushed : bool
        Whether the push has been felt.
    side : float
        Sine of the sideslip that the rail has been left with.
    """

    __slots__ = (
        "_at",
        "_beside",
        "_down",
        "_head",
        "_height",
        "_mean",
        "_rest",
        "_sd",
        "_side",
        "_start",
        "declared",
        "on",
        "pushed",
        "side",
    )

    def __init__(self, aided: AidedSettings, head: HeadErrors) -> None:
        self.declared = aided.rail_wind_sd > 0.0
        self._head, self._sd = head, aided.rail_wind_sd if self.declared else CALM
        across = hypot(aided.rail_wind_side, aided.rail_wind_down)
        self._mean = aided.rail_wind_along, across
        self._side, self._down = (
            (aided.rail_wind_side / across, aided.rail_wind_down / across) if across > 0.0 else (1.0, 0.0)
        )
        self.on = self.pushed = False
        self.side = 0.0
        self._start, self._at = 0.0, aided.launch_height
        self._height = self._at
        self._beside = Beside()
        self._rest: Beside | None = None  # u₀, where the pair's difference at rest has P(u₀, c) in it

    @property
    def speed_declared(self) -> float:
        """Of the mean wind on the rail, m/s."""
        return hypot(*self._mean)

    def forget(self) -> None:
        """Be told that the aircraft is in flight, wherever the filter begins."""
        self.on, self.side, self._rest = False, 0.0, None

    def drop(self, energy: EnergyFilter, heat: float) -> None:
        """Be told that nothing is known of the wind but what was declared; the filter gets its d back."""
        self._resolve(energy, heat)
        self.forget()

    def begin(
        self,
        seen: tuple[float, float] | None,
        *,
        tared: bool,
        air: tuple[float, float, float],
    ) -> tuple[float, float, float, float]:
        """Begin on the rail.

        Parameters
        ----------
        seen : tuple of float or None
            The pair's mean difference at rest, Pa, less its tare where that was covered, and its variance, Pa²; None:
            nothing was read.
        tared : bool
            Whether a covered tare has been taken off, so that what is left is the wind's.
        air : tuple of float
            Static pressure, Pa, 7 R T, m²/s², and by how much gusts widen the wind in `AGO`, m²/s².

        Returns
        -------
        tuple of float
            u₀ and its standard deviation, m/s; what is to be taken off the pair's difference, Pa, and its variance, Pa².
        """
        static, heat, gusts = air
        self.on = False
        if seen is not None:
            seen = seen[0], seen[1] + self.unknown(self._mean[0], static, heat)
        (u, c), one = self._mean, self._sd * self._sd
        uu, cc, uc = one, one, 0.0
        off = variance = cd = 0.0
        self._rest = None
        if seen is not None and tared:
            u, c, uu, cc, uc = self._corrected(seen, static, heat)
        elif seen is not None:
            more, spread, cd = self._across_at_rest(static, heat)
            off, variance = seen[0] - more, seen[1] + spread
            self._rest = Beside(u, uu, of_v=uu)
        self.on, self.pushed, self.side = True, False, 0.0
        uu, cc = uu + gusts, cc + gusts
        self._start, self._height = u, self._at
        self._beside = Beside(c, cc, of_v=uc, of_d=-cd)
        return u, sqrt(uu), off, variance

    def _across_at_rest(self, static: float, heat: float) -> tuple[float, float, float]:
        """Return what c − c̄ makes of P at rest: its mean, Pa, its variance, Pa², and its covariance with c.

        By Gauss and Hermite's three points, exact for a parabola, which P is in c.
        """
        (u, c), off = self._mean, sqrt(3.0) * self._sd
        at_mean = self._felt(u, c, static, heat)
        above, below = self._felt(u, c + off, static, heat) - at_mean, self._felt(u, c - off, static, heat) - at_mean
        mean = (above + below) / 6.0
        return mean, (above * above + below * below) / 6.0 - mean * mean, off * (above - below) / 6.0

    def unknown(self, u: float, static: float, heat: float) -> float:
        """Return the variance of what is not known of the static port's error on the rail, Pa²."""
        c = self._beside.value if self.on else self._mean[1]
        v2 = u * u + c * c
        if v2 < SMALL:
            return 0.0
        impact = isentropic(sqrt(v2), static, heat) - static
        side2, down2 = c * c * self._side * self._side / v2, c * c * self._down * self._down / v2
        return (impact * self._head.spread(side2, 0.0, sqrt(down2), 0.0)) ** 2

    def _corrected(
        self, seen: tuple[float, float], static: float, heat: float
    ) -> tuple[float, float, float, float, float]:
        """Return u₀ and c by what is declared and what the tared pair reads, with variances and covariance."""
        reading, variance = seen
        (u, c), one = self._mean, self._sd * self._sd
        at_u, at_c, hu, hc, spread = u, c, 0.0, 0.0, 1.0
        uu = cc = uc = 0.0
        bend = 7.0 * static / heat  # as in `total`: the ridge of equal V is a circle, and its mean is within
        for _ in range(TURNS):
            felt, hu, hc = self._at_rest(at_u, at_c, static, heat)
            spread = (hu * hu + hc * hc) * one + variance
            shift = (reading - felt - 0.5 * bend * (uu + cc) - hu * (u - at_u) - hc * (c - at_c)) / spread
            at_u, at_c = u + hu * one * shift, c + hc * one * shift
            gain = one * one / spread
            uu, cc, uc = one - gain * hu * hu, one - gain * hc * hc, gain * hu * hc
        gain = one * one / (spread + 0.5 * bend * bend * (uu * uu + 2.0 * uc * uc + cc * cc))
        return at_u, at_c, one - gain * hu * hu, one - gain * hc * hc, -gain * hu * hc

    def _at_rest(self, u: float, c: float, static: float, heat: float) -> tuple[float, float, float]:
        """Return P(u, c), Pa, and its derivatives."""
        felt = self._felt(u, c, static, heat)
        by_u, by_c = self._felt(u + SMALL, c, static, heat), self._felt(u, c + SMALL, static, heat)
        return felt, (by_u - felt) / SMALL, (by_c - felt) / SMALL

    def _felt(self, u: float, c: float, static: float, heat: float) -> float:
        """Return P(u, c), Pa."""
        total, below = self._ports(u, c, static, heat)
        return total - below

    def _ports(self, u: float, c: float, static: float, heat: float) -> tuple[float, float]:
        """Return what both ports read of the air's speed along and across the rail, Pa: total, static."""
        v2 = u * u + c * c
        speed = sqrt(v2)
        if speed < SMALL:
            return static, static
        impact = isentropic(speed, static, heat) - static
        total, at_static = self._head.shares(u / speed, c * self._side / speed, c * self._down / speed, 5.0 * v2 / heat)
        return static + impact * total, static + impact * at_static

    # -- the push ------------------------------------------------------------------------------------------------------

    def speed(self, u: float) -> float:
        """Return V, m/s, of the filter's airspeed."""
        return hypot(u, self._beside.value) if self.on else u

    def gained(self, u: float) -> float:
        """Return the speed over the ground, m/s: what u has gained."""
        return u - self._start

    def advance(
        self, energy: EnergyFilter, dt: float, gained: float, variance: float, density: float, railed: bool
    ) -> None:
        """Go on, before `EnergyFilter.predict`, whose arguments these are; gusts widen c as they widen u."""
        energy.predict_beside(self._beside, dt, gained, variance, density, railed)
        if self._rest is not None:
            energy.predict_beside(self._rest, dt, gained, 0.0, density, railed)
        if self.pushed:  # up the rail the wind across grows, too
            climb = self.gained(energy.v) * energy.s / GRAVITY
            self._height += climb * dt
            self._beside.value *= 1.0 + GROWTH * climb * dt / self._height

    def total(
        self,
        energy: EnergyFilter,
        reading: float,
        variance: float,
        pushed: float,
        heat: float,
        *,
        relative: bool = False,
    ) -> float:
        """Take a total pressure, which is that of V at an angle, as `EnergyFilter.total` does; return the NIS.

        `relative` says whether it is read relative to what the static port reads, by a differential sensor.
        """
        u, p, c = energy.v, energy.p, self._beside.value

        def read(along: float, across: float) -> float:
            total, static = self._ports(along, across, p, heat)
            return total - static if relative else total

        felt = read(u, c)
        hv, hc = (read(u + SMALL, c) - felt) / SMALL, (read(u, c + SMALL) - felt) / SMALL
        # E[h] is above h of the means by half its curvature times the variances, and scatters by as much
        bend, uu = 7.0 * p / heat, energy.vv
        cc, uc = self._beside.variance, self._beside.of_v
        spread, above = uu * uu + 2.0 * uc * uc + cc * cc, reading - felt - 0.5 * bend * (uu + cc)
        others: Others = ((hc, self._beside),)
        rest = self._rest
        if rest is not None:
            at_rest, hu, _ = self._at_rest(rest.value, self._mean[1], p, heat)
            above += at_rest + 0.5 * bend * rest.variance
            spread += rest.variance * rest.variance - 2.0 * rest.of_v * rest.of_v
            others = (*others, (-hu, rest))
        variance += 0.5 * bend * bend * (spread if spread > 0.0 else 0.0)
        return energy.total_beside(above, variance, pushed, hv, others)

    def static(self, energy: EnergyFilter, reading: float, variance: float, ahead: float, heat: float) -> float:
        """Take a static pressure, whose port the wind blows at, as `EnergyFilter.static` does; return the NIS."""
        c = self._beside.value
        off = self._ports(energy.v, c, energy.p, heat)[1] - energy.p
        more = self._ports(energy.v, c + SMALL, energy.p, heat)[1] - energy.p
        others: Others = (((more - off) / SMALL, self._beside),)
        if self._rest is not None:
            others = (*others, (0.0, self._rest))
        return energy.static_beside(reading - off, variance, ahead, others)

    def told(self, u: float, variance: float) -> tuple[float, float]:
        """Return V, m/s, and its variance, m²/s², of u and its variance."""
        c = self._beside.value
        v = hypot(u, c)
        if v < SMALL:
            return v, variance + self._beside.variance
        x, y = u / v, c / v
        across = self._across(x, y, variance)
        found = x * x * variance + 2.0 * x * y * self._beside.of_v + y * y * self._beside.variance
        bend = across / v if across < v * v else v  # where V is not known better than that it bends no further
        return v + 0.5 * bend, (found if found > 0.0 else 0.0) + 0.5 * bend * bend

    def _across(self, x: float, y: float, variance: float) -> float:
        """Variance across (x, y), the direction of V: by it V is greater than √(u² + c²) of the means."""
        beside = self._beside
        across = y * y * variance - 2.0 * x * y * beside.of_v + x * x * beside.variance
        return across if across > 0.0 else 0.0

    def leave(self, energy: EnergyFilter, heat: float) -> None:
        """Turn the filter's airspeed from u into V, and its d into that of the pair: the rail ends."""
        c = self._beside.value
        length = hypot(energy.v, c)
        self._resolve(energy, heat)
        self.on = False
        if length < SMALL:
            energy.widen_speed(self._beside.variance)
            return
        v, variance = self.told(energy.v, energy.vv)
        self.side = c * self._side / length
        energy.turn(v, variance, energy.v / length, c / length, self._beside)

    def _resolve(self, energy: EnergyFilter, heat: float) -> None:
        """Make d of e: P(u₀, c) is taken off."""
        rest, self._rest = self._rest, None
        if rest is None:
            return
        felt, hu, _ = self._at_rest(rest.value, self._mean[1], energy.p, heat)
        bend = 7.0 * energy.p / heat * rest.variance
        energy.resolve_difference(-felt - 0.5 * bend, 0.5 * bend * bend, ((-hu, rest), (0.0, self._beside)))
