"""The wind on the rail: along it u₀, across it c, and the airspeed V = √(u² + c²) until the rail is left.

The push changes the air's speed along the rail alone, u = u₀ + ∫(f_x − b − s) dt. So the filter's airspeed is u there,
and c² is kept beside it, with its variance and its covariances with the state. Both ports read what V and the angle
make of them (`head_errors`). Of an ideal head that is a straight line in c², in which a wind across of any size has no
bend.

u₀ and c are believed as the environment declares them, at the height of the head on the rail, ± the turbulence and a
share of the mean wind. After a covered tare the pair reads

    D = P(u₀, c²) = q_c(V) (c_t − c_s)

which corrects both. In the wind, or without a tare, the pair's difference at rest is d + P(u₀, c²) instead, and that
sum is all that is known. Until the rail is left the filter's d is e, that sum less what c² differed at rest from the
declared c̄². u₀ is a second quantity beside the state, and

    p_t − p_s = e + P(u, c²) − P(u₀, c̄²) = e + ½ρ (u − u₀)(u + u₀) + ½ρ (c² − c̄²)

The force knows u − u₀, so that is a straight line in u₀ as well: whatever the wind was, the push finds it. (With d and
u₀ for states it bends by ½ρσ² of each, by the same amount in each reading. Readings that count it as noise of their own
know d to a tenth of what they should.) At rest c² goes with e, so that what is read there says nothing of it. In the
push, over some metres of air, it wanders away from what it was.

**At the rail's end**, when the push is over, d = e − P(u₀, c̄²), and the path turns into the wind: V ← √(u² + c²), with
half the curvatures times the variances, and covariances by the slopes.
"""

from math import hypot, sqrt

from uavsim.onboard.airspeed.energy import Beside, EnergyFilter, Others
from uavsim.onboard.airspeed.energy_model import isentropic
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.airspeed.settings import AidedSettings

SMALL, SQUARE = 0.05, 1.0  # m/s and m²/s², of the differences by which the ports' readings are derived
TURNS = 4  # Gauss-Newton's on the rail, where D bends with u₀
CALM = 1.0  # m/s, standard deviation of a wind that nobody declares: Beaufort 1, which a crew calls calm
VERTICAL = 0.5  # σ_w/σ_u of the turbulence at 10 ft, MIL-F-8785C
GROWTH = 0.28  # dW/W over dh/h near the ground: 1/ln(h/z₀) of the logarithmic law at 1.6 m over short grass


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
        "_across",
        "_at",
        "_declared_speed",
        "_down",
        "_head",
        "_height",
        "_mean",
        "_rest",
        "_sd",
        "_side",
        "_square_variance",
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
        one = self._sd * self._sd
        self._mean = aided.rail_wind_along, across * across + one  # u₀ and c²
        self._square_variance = 4.0 * one * (aided.rail_wind_side**2 + (VERTICAL * aided.rail_wind_down) ** 2)
        self._square_variance += 2.0 * one * one
        self._side, self._down = (
            (aided.rail_wind_side / across, aided.rail_wind_down / across) if across > 0.0 else (1.0, 0.0)
        )
        self._declared_speed = hypot(aided.rail_wind_along, across)
        self.on = self.pushed = False
        self.side = 0.0
        self._start, self._at = 0.0, aided.launch_height
        self._height = self._at
        self._across = Beside()
        self._rest: Beside | None = None  # u₀, where the pair's difference at rest has P(u₀, c) in it

    @property
    def speed_declared(self) -> float:
        """Of the mean wind on the rail, m/s."""
        return self._declared_speed

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
            Static pressure, Pa, 7 R T, m²/s², and by how much gusts have widened the wind since, m²/s².

        Returns
        -------
        tuple of float
            u₀ and its standard deviation, m/s; what is to be taken off the pair's difference, Pa, and its variance,
            Pa².
        """
        static, heat, gusts = air
        self.on = False
        if seen is not None:
            seen = seen[0], seen[1] + self.unknown(self._mean[0], static, heat)
        (u, side2), uu, ss = self._mean, self._sd * self._sd, self._square_variance
        us = sd = off = variance = 0.0
        self._rest = None
        if seen is not None and tared:
            u, side2, uu, ss, us = self._corrected(seen, static, heat)
        elif seen is not None:
            _, _, slope = self._at_rest(u, side2, static, heat)
            off, variance, sd = seen[0], seen[1] + slope * slope * ss, -slope * ss
            self._rest = Beside(u, uu, of_v=uu)
        self.on, self.pushed, self.side = True, False, 0.0
        self._start, self._height = u, self._at
        self._across = Beside(side2, ss + 4.0 * max(side2, 0.0) * gusts, of_v=us, of_d=sd)
        return u, sqrt(uu + gusts), off, variance

    def unknown(self, u: float, static: float, heat: float) -> float:
        """Return the variance of what is not known of the static port's error on the rail, Pa²."""
        side2 = max(self._across.value if self.on else self._mean[1], 0.0)
        v2 = u * u + side2
        if v2 < SMALL:
            return 0.0
        impact = isentropic(sqrt(v2), static, heat) - static
        share = side2 / v2
        return (impact * self._head.spread(share * self._side**2, 0.0, sqrt(share) * self._down, 0.0)) ** 2

    def _corrected(
        self, seen: tuple[float, float], static: float, heat: float
    ) -> tuple[float, float, float, float, float]:
        """Return u₀ and c² by what is declared and what the tared pair reads, with variances and covariance."""
        reading, variance = seen
        (u, side2), one, square = self._mean, self._sd * self._sd, self._square_variance
        at_u, at_side2, hu, hs, spread = u, side2, 0.0, 0.0, 1.0
        bend, uu = 7.0 * static / heat, 0.0
        for _ in range(TURNS):
            felt, hu, hs = self._at_rest(at_u, at_side2, static, heat)
            left = 0.5 * bend * uu  # E[P] is above P of the means, as in `total`
            spread = hu * hu * one + hs * hs * square + variance + 2.0 * left * left
            shift = (reading - felt - left - hu * (u - at_u) - hs * (side2 - at_side2)) / spread
            at_u, at_side2 = u + hu * one * shift, side2 + hs * square * shift
            uu = one - hu * hu * one * one / spread
        return at_u, at_side2, uu, square - hs * hs * square * square / spread, -hu * one * hs * square / spread

    def _at_rest(self, u: float, side2: float, static: float, heat: float) -> tuple[float, float, float]:
        """Return P(u, c²), Pa, and its derivatives."""
        felt = self._felt(u, side2, static, heat)
        by_u, by_side2 = self._felt(u + SMALL, side2, static, heat), self._felt(u, side2 + SQUARE, static, heat)
        return felt, (by_u - felt) / SMALL, (by_side2 - felt) / SQUARE

    def _felt(self, u: float, side2: float, static: float, heat: float) -> float:
        """Return P(u, c²), Pa."""
        total, below = self._ports(u, side2, static, heat)
        return total - below

    def _ports(self, u: float, side2: float, static: float, heat: float) -> tuple[float, float]:
        """Return what both ports read, Pa, total and static, of the air's speed along the rail and of c²."""
        side2 = side2 if side2 > 0.0 else 0.0
        v2 = u * u + side2
        speed, across = sqrt(v2), sqrt(side2)
        if speed < SMALL:
            return static, static
        impact = isentropic(speed, static, heat) - static
        total, at_static = self._head.shares(
            u / speed, across * self._side / speed, across * self._down / speed, 5.0 * v2 / heat
        )
        return static + impact * total, static + impact * at_static

    # -- the push ------------------------------------------------------------------------------------------------------

    def speed(self, u: float) -> float:
        """Return V, m/s, of the filter's airspeed."""
        return self._length(u) if self.on else u

    def _length(self, u: float) -> float:
        """Return √(u² + c²), m/s."""
        side2 = self._across.value
        return sqrt(u * u + side2) if side2 > 0.0 else abs(u)

    def gained(self, u: float) -> float:
        """Return the speed over the ground, m/s: what u has gained."""
        return u - self._start

    def advance(
        self, energy: EnergyFilter, dt: float, gained: float, variance: float, density: float, railed: bool
    ) -> None:
        """Go on, before `EnergyFilter.predict`, whose arguments these are; gusts widen c as they widen u."""
        across = self._across
        energy.predict_beside(across, dt, gained, 4.0 * max(across.value, 0.0) * variance, density, railed)
        if self._rest is not None:
            energy.predict_beside(self._rest, dt, gained, 0.0, density, railed)
        if self.pushed:  # up the rail the wind across grows, too
            climb = self.gained(energy.v) * energy.s / GRAVITY
            self._height += climb * dt
            across.value *= 1.0 + 2.0 * GROWTH * climb * dt / self._height

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
        u, p, across = energy.v, energy.p, self._across

        def read(along: float, side2: float) -> float:
            total, static = self._ports(along, side2, p, heat)
            return total - static if relative else total

        felt = read(u, across.value)
        hv, hs = (read(u + SMALL, across.value) - felt) / SMALL, (read(u, across.value + SQUARE) - felt) / SQUARE
        # E[h] is above h of the means by half its curvature times the variance of u, and scatters by as much
        bend, uu = 7.0 * p / heat, energy.vv
        spread, above = uu * uu, reading - felt - 0.5 * bend * uu
        others: Others = ((hs, across),)
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
        across = self._across
        off = self._ports(energy.v, across.value, energy.p, heat)[1] - energy.p
        more = self._ports(energy.v, across.value + SQUARE, energy.p, heat)[1] - energy.p
        others: Others = (((more - off) / SQUARE, across),)
        if self._rest is not None:
            others = (*others, (0.0, self._rest))
        return energy.static_beside(reading - off, variance, ahead, others)

    def told(self, u: float, variance: float) -> tuple[float, float]:
        """Return V, m/s, and its variance, m²/s², of u and its variance."""
        across, v = self._across, self._length(u)
        if v < SMALL:
            return v, variance + sqrt(across.variance)
        x, y = u / v, 0.5 / v
        found = x * x * variance + 2.0 * x * y * across.of_v + y * y * across.variance
        # half the curvature of √(u² + c²) times the variances
        bent = 0.5 * ((1.0 - x * x) * variance - y * y * across.variance - 2.0 * x * y * across.of_v) / v
        bent = bent if -0.5 * v < bent < 0.5 * v else 0.0
        return v + bent, (found if found > 0.0 else 0.0) + 2.0 * bent * bent

    def leave(self, energy: EnergyFilter, heat: float) -> None:
        """Turn the filter's airspeed from u into V, and its d into that of the pair: the rail ends."""
        across, length = self._across, self._length(energy.v)
        self._resolve(energy, heat)
        self.on = False
        if length < SMALL:
            energy.widen_speed(sqrt(across.variance))
            return
        v, variance = self.told(energy.v, energy.vv)
        self.side = sqrt(max(across.value, 0.0)) * self._side / length
        energy.turn(v, variance, energy.v / length, 0.5 / length, across)

    def _resolve(self, energy: EnergyFilter, heat: float) -> None:
        """Make d of e: P(u₀, c̄) is taken off."""
        rest, self._rest = self._rest, None
        if rest is None:
            return
        felt, hu, _ = self._at_rest(rest.value, self._mean[1], energy.p, heat)
        bend = 7.0 * energy.p / heat * rest.variance
        energy.resolve_difference(-felt - 0.5 * bend, 0.5 * bend * bend, ((-hu, rest), (0.0, self._across)))
