"""The aided filter's core: an extended Kalman filter of six states on the energy-rate relation, second order near rest.

States: airspeed V, m/s; what f_x is off by, b, m/s²; static pressure p, Pa; the climb's share of gravity s = g·sin γ,
m/s²; the pair's difference since the tare d, Pa; error k of the known pressure error per specific force, Pa/(m/s²).

    V̇ = f_x − b − s + gust,    ṗ = −ρ V s,    ρ = p/(R T)          and so  V V̇ + g ḣ = V (f_x − b)  with  ḣ = −ṗ/(ρ g)
    ḃ = −b/τ_b + noise,        ṡ = −s/τ_s + noise,        ḋ = noise,        k̇ = 0

which is the energy-rate relation: no attitude is needed. It is written with the slope s in place of ṗ because V̇ holds
ṗ/(ρ V), 0/0 at rest, where s is plain: before the launch b + s is what f_x reads, known from the tare, though neither b
nor s is. On the rail neither changes. The gust is a random walk of density 2 σ² V/L, what Dryden's first-order spectrum
is over less than its correlation time L/V.

A reading of the static pressure is p at its own instant; one of the total pressure, tared and freed of the known
error, is

    z = p (1 + V²/(7 R T))^(7/2) + d + k (f_x − f_x at rest) + noise

Its slope in V, ρ V, vanishes at rest, so the update is of second order in V: with h'' ≈ ρ and P the variance of V, the
expected reading is h + h'' P/2, its variance greater by (h'' P)²/2 (Athans, Wishner & Bertolini 1968; Jazwinski 1970,
9.3, Gaussian second-order filter). While that term counts against the reading's noise the slope is taken where the
reading leads to, by Newton's iteration. The covariance is kept as its 21 numbers and never made a matrix.
"""

from math import sqrt

from uavsim.airdata import GAS_CONSTANT_DRY_AIR

SEVEN_R = 7.0 * GAS_CONSTANT_DRY_AIR  # J/(kg·K): 2·c_p, V²/(7·R·T) = (γ − 1)/2·M²
CURVED = 0.01  # (h''·P)² over the reading's variance from which on the slope is looked for anew
GATE = 25.0  # NIS; a reading beyond it, one in two million of the Gaussian ones, is a spike or a fault and not taken
ITERATIONS = 4  # Newton's; the third is below a hundredth of the deviation from V = 3 σ_V on
RAIL_SHARE = 1e-4  # of the variance that slope and bias gain in flight, on the rail: none, but for a regular matrix


class EnergyFilter:
    """State and covariance; `predict` and the two updates.

    Parameters
    ----------
    speed_sd : float
        Of the airspeed at the start, m/s; its mean is 0.
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

    Attributes
    ----------
    v, b, p, s, d, k : float
        The state.
    vv, vb, … kk : float
        Its covariance.
    innovation : float
        The last one, Pa.
    taken : bool
        Whether the last reading was within the gate of five standard deviations.
    """

    __slots__ = (
        "_bias_density", "_bias_time", "_difference_density", "_slope_density", "_slope_time", "_static_density", "b",
        "bb", "bd", "bk", "bp", "bs", "d", "dd", "dk", "innovation", "k", "kk", "p", "pd", "pk", "pp", "ps", "s", "sd",
        "sk", "ss", "taken", "v", "vb", "vd", "vk", "vp", "vs", "vv",
    )  # fmt: skip

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
    ) -> None:
        self._bias_time, self._bias_density = bias_time, 2.0 * bias_sd**2 / bias_time
        self._slope_density, self._slope_time = slope_rate**2, slope_time
        self._static_density = static_walk**2
        self._difference_density = difference_walk**2
        self.v = self.b = self.d = self.k = self.innovation = 0.0
        self.taken = True
        self.s, self.p = rest_force, static
        self.vb = self.vp = self.vs = self.vd = self.vk = self.bp = self.bd = self.bk = 0.0
        self.ps = self.pd = self.pk = self.sd = self.sk = self.dk = 0.0
        self.vv, self.bb, self.bs = speed_sd**2, bias_sd**2, -(bias_sd**2)
        self.ss = bias_sd**2 + rest_sd**2
        self.pp, self.dd, self.kk = static_sd**2, difference_sd**2, acceleration_sd**2

    def predict(self, dt: float, gained: float, variance: float, density: float, railed: bool) -> None:
        """Advance.

        Parameters
        ----------
        dt : float
            By how much, s.
        gained : float
            ∫ f_x dt over it, m/s.
        variance : float
            That is added to V's, of gust and accelerometer, m²/s².
        density : float
            ρ, kg/m³.
        railed : bool
            Whether slope and bias cannot change.
        """
        v, s = self.v, self.s
        change = gained - dt * (self.b + s)
        middle = v + 0.5 * change
        a = -density * s * dt  # p's slope in V and s
        c = -density * middle * dt
        self.p += c * s
        self.v = v + change
        vv, vb, vp, vs, vd, vk = self.vv, self.vb, self.vp, self.vs, self.vd, self.vk
        bs, ps, ss, sd, sk = self.bs, self.ps, self.ss, self.sd, self.sk
        bb, bp, bd, bk = self.bb, self.bp, self.bd, self.bk
        # p ← p + a V + c s, then V ← V − dt (b + s), each on rows and columns
        pv_new, ps_new = vp + a * vv + c * vs, ps + a * vs + c * ss
        self.pp += a * (vp + pv_new) + c * (ps + ps_new) + self._static_density * dt
        bp += a * vb + c * bs
        self.pd += a * vd + c * sd
        self.pk += a * vk + c * sk
        vb_new, vs_new = vb - dt * (bb + bs), vs - dt * (bs + ss)
        self.vv = vv - dt * (vb + vb_new + vs + vs_new) + variance
        self.vp = pv_new - dt * (bp + ps_new)
        self.vd = vd - dt * (bd + sd)
        self.vk = vk - dt * (bk + sk)
        self.dd += self._difference_density * dt
        slope, bias = self._slope_density * dt, self._bias_density * dt
        if railed:
            self.vb, self.bp, self.vs, self.ps = vb_new, bp, vs_new, ps_new
            self.ss = ss + RAIL_SHARE * slope
            self.bb = bb + RAIL_SHARE * bias
            return
        # Over the interval noise of b and s reaches V and p: its share to third order in dt
        keep, stay = 1.0 - dt / self._bias_time, 1.0 - dt / self._slope_time
        half, third = 0.5 * dt, dt * dt / 3.0
        self.b *= keep
        self.s = stay * s
        self.vv += third * (bias + slope)
        self.vb, self.bp = keep * vb_new - half * bias, keep * bp
        self.bs, self.bd, self.bk = keep * stay * bs, keep * bd, keep * bk
        self.bb = keep * keep * bb + bias
        self.vs, self.ps = stay * vs_new - half * slope, stay * ps_new + 0.5 * c * slope
        self.vp -= c * dt * slope / 3.0
        self.pp += c * c * slope / 3.0
        self.sd, self.sk = stay * sd, stay * sk
        self.ss = stay * stay * ss + slope

    def fly(
        self,
        dt: float,
        gained: float,
        variance: float,
        density: float,
        static: float,
        static_variance: float,
        ahead: float,
        total: float,
        total_variance: float,
        heat: float,
    ) -> tuple[float, float]:
        """Advance in flight and take both pressures, k being known: `predict`, `static` and `total` without a push.

        The arguments are theirs; returned are both normalised innovations squared.
        """
        self.predict(dt, gained, variance, density, False)
        nis = self.static(static, static_variance, ahead)
        return nis, self.total(total, total_variance, 0.0, heat)

    def know_push(self) -> float:
        """Take k for known from here on; return what its variance was, (Pa/(m/s²))²."""
        variance, self.kk = self.kk, 0.0
        self.vk = self.bk = self.pk = self.sk = self.dk = 0.0
        return variance

    def restart(self, speed: float, variance: float) -> None:
        """Forget the airspeed for another, m/s, of the given variance, m²/s²."""
        self.v, self.vv = speed, variance
        self.vb = self.vp = self.vs = self.vd = self.vk = 0.0

    def astray(self, variance: float, bias_sd: float) -> None:
        """Doubt what a bad port has taught: V by a variance more, m²/s², and b as at the start."""
        self.vv += variance
        self.b, self.bb = 0.0, bias_sd * bias_sd
        self.vb = self.bp = self.bs = self.bd = self.bk = 0.0

    def static(self, reading: float, variance: float, ahead: float) -> float:
        """Take a static pressure.

        Parameters
        ----------
        reading : float
            Pa.
        variance : float
            Of its noise, Pa².
        ahead : float
            ρ V Δt, Pa/(m/s²), with Δt by how much the filter is ahead of the reading's instant: p then was higher by
            s times this.

        Returns
        -------
        float
            Normalised innovation squared.
        """
        gv, gb, gp = self.vp + ahead * self.vs, self.bp + ahead * self.bs, self.pp + ahead * self.ps
        gs, gd, gk = self.ps + ahead * self.ss, self.pd + ahead * self.sd, self.pk + ahead * self.sk
        return self._correct(reading - self.p - ahead * self.s, gp + ahead * gs + variance, gv, gb, gp, gs, gd, gk)

    def total(self, reading: float, variance: float, pushed: float, heat: float) -> float:
        """Take a total pressure.

        Parameters
        ----------
        reading : float
            Tared and freed of the known error, Pa.
        variance : float
            Of its noise, Pa².
        pushed : float
            Specific force above that at rest, m/s².
        heat : float
            7 R T, m²/s², with the square of the airspeed's calibration in it.

        Returns
        -------
        float
            Normalised innovation squared.
        """
        v, p, vv = self.v, self.p, self.vv
        y = 1.0 + v * v / heat
        power = y * y * sqrt(y)
        curvature = 7.0 * p / heat * power  # ρ at low speed; the next term, 1 + 5 M²/5…, is below 1e-2 to Mach 0.1
        hv = curvature * v
        hp = power * y
        gv = hv * vv + hp * self.vp + self.vd + pushed * self.vk
        gb = hv * self.vb + hp * self.bp + self.bd + pushed * self.bk
        gp = hv * self.vp + hp * self.pp + self.pd + pushed * self.pk
        gs = hv * self.vs + hp * self.ps + self.sd + pushed * self.sk
        gd = hv * self.vd + hp * self.pd + self.dd + pushed * self.dk
        gk = hv * self.vk + hp * self.pk + self.dk + pushed * self.kk
        bend = curvature * vv
        if bend * bend > CURVED * variance:
            return self._curved(reading, variance, pushed, heat)
        spread = hv * gv + hp * gp + gd + pushed * gk + variance + 0.5 * bend * bend
        return self._correct(reading - hp * p - self.d - pushed * self.k - 0.5 * bend, spread, gv, gb, gp, gs, gd, gk)

    def _curved(self, reading: float, variance: float, pushed: float, heat: float) -> float:
        """Take a total pressure at which the slope depends on what is looked for: linearised where it leads to.

        Gauss-Newton on the posterior density, the iterated filter (Bell & Cathey 1993); h bends in V alone.
        """
        v, p, d, k = self.v, self.p, self.d, self.k
        at_v, at_p, shift = v, p, 0.0
        nis = gv = gb = gp = gs = gd = gk = 0.0
        spread = innovation = 1.0
        for step in range(ITERATIONS):
            y = 1.0 + at_v * at_v / heat
            power = y * y * sqrt(y)
            curvature = 7.0 * at_p / heat * power
            hv, hp = curvature * at_v, power * y
            gv = hv * self.vv + hp * self.vp + self.vd + pushed * self.vk
            gp = hv * self.vp + hp * self.pp + self.pd + pushed * self.pk
            gd = hv * self.vd + hp * self.pd + self.dd + pushed * self.dk
            gk = hv * self.vk + hp * self.pk + self.dk + pushed * self.kk
            spread = hv * gv + hp * gp + gd + pushed * gk + variance
            innovation = reading - hp * at_p - hv * (v - at_v) - hp * (p - at_p) - d - pushed * k
            if not step:
                bend = curvature * self.vv
                nis = (innovation - 0.5 * bend) ** 2 / (spread + 0.5 * bend * bend)
                if nis > GATE:
                    self.innovation, self.taken = innovation - 0.5 * bend, False
                    return nis
            left = self.vv - gv * gv / spread
            if left > 0.0:  # what h bends over the deviation that stays
                bend = curvature * left
                spread += 0.5 * bend * bend
                innovation -= 0.5 * bend
            shift = innovation / spread
            at_v, at_p = v + gv * shift, p + gp * shift
        gb = hv * self.vb + hp * self.bp + self.bd + pushed * self.bk
        gs = hv * self.vs + hp * self.ps + self.sd + pushed * self.sk
        self._correct(innovation, spread, gv, gb, gp, gs, gd, gk)
        return nis

    def _correct(
        self, innovation: float, spread: float, gv: float, gb: float, gp: float, gs: float, gd: float, gk: float
    ) -> float:
        """Correct by an innovation of variance `spread`; g… is its covariance with the state."""
        self.innovation = innovation
        nis = innovation * innovation / spread
        self.taken = nis <= GATE
        if not self.taken:
            return nis
        kv, kb, kp, ks, kd, kk = gv / spread, gb / spread, gp / spread, gs / spread, gd / spread, gk / spread
        self.v += kv * innovation
        self.b += kb * innovation
        self.p += kp * innovation
        self.s += ks * innovation
        self.d += kd * innovation
        self.k += kk * innovation
        self.vv -= kv * gv
        self.vb -= kv * gb
        self.vp -= kv * gp
        self.vs -= kv * gs
        self.vd -= kv * gd
        self.vk -= kv * gk
        self.bb -= kb * gb
        self.bp -= kb * gp
        self.bs -= kb * gs
        self.bd -= kb * gd
        self.bk -= kb * gk
        self.pp -= kp * gp
        self.ps -= kp * gs
        self.pd -= kp * gd
        self.pk -= kp * gk
        self.ss -= ks * gs
        self.sd -= ks * gd
        self.sk -= ks * gk
        self.dd -= kd * gd
        self.dk -= kd * gk
        self.kk -= kk * gk
        return nis
