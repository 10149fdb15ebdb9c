"""The aided filter's core in steady flight: prediction and both updates in one pass, k being known.

The same equations as `energy`, in the same order, of five states: without a push the error k of the membranes' known
error tells nothing and is told nothing, so `EnergyFilter.know_push` takes it for known. Written out on local variables,
of which each is loaded and stored once; three calls spend as much on loading and storing as on sums. Where the total
pressure bends over what is not known of V, near rest, and on the rail, the three calls of `energy` stay.
"""

from math import sqrt

from uavsim.onboard.airspeed.energy import CURVED, GATE, EnergyFilter


class OnePassFilter(EnergyFilter):
    """`EnergyFilter` whose `fly` costs half."""

    __slots__ = ()

    def fly(  # noqa: PLR0915 - that it is one is the point
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
        """Advance and take both pressures; see `EnergyFilter.fly`."""
        v, b, p, s, d = self.v, self.b, self.p, self.s, self.d
        vv, vb, vp, vs, vd = self.vv, self.vb, self.vp, self.vs, self.vd
        bb, bp, bs, bd = self.bb, self.bp, self.bs, self.bd
        pp, ps, pd, ss, sd, dd = self.pp, self.ps, self.pd, self.ss, self.sd, self.dd

        # p ← p + a V + c s, then V ← V − dt (b + s), each on rows and columns; then the noise
        change = gained - dt * (b + s)
        a, c = -density * s * dt, -density * (v + 0.5 * change) * dt
        p += c * s
        v += change
        pv, sp = vp + a * vv + c * vs, ps + a * vs + c * ss
        pp += a * (vp + pv) + c * (ps + sp) + self._static_density * dt
        bp += a * vb + c * bs
        pd += a * vd + c * sd
        bv, sv = vb - dt * (bb + bs), vs - dt * (bs + ss)
        vv += variance - dt * (vb + bv + vs + sv)
        vp = pv - dt * (bp + sp)
        vd -= dt * (bd + sd)
        dd += self._difference_density * dt
        slope, bias = self._slope_density * dt, self._bias_density * dt
        keep, stay = 1.0 - dt / self._bias_time, 1.0 - dt / self._slope_time
        half, third = 0.5 * dt, dt * dt / 3.0
        b *= keep
        s *= stay
        vv += third * (bias + slope)
        vb, bp, bs, bd = keep * bv - half * bias, keep * bp, keep * stay * bs, keep * bd
        bb = keep * keep * bb + bias
        vs, ps = stay * sv - half * slope, stay * sp + 0.5 * c * slope
        vp -= c * dt * slope / 3.0
        pp += c * c * slope / 3.0
        sd *= stay
        ss = stay * stay * ss + slope

        # The static pressure; g is the covariance of state and innovation
        gv, gb, gp = vp + ahead * vs, bp + ahead * bs, pp + ahead * ps
        gs, gd = ps + ahead * ss, pd + ahead * sd
        innovation, spread = static - p - ahead * s, gp + ahead * gs + static_variance
        nis_static = innovation * innovation / spread
        if nis_static <= GATE:
            kv, kb, kp, ks, kd = gv / spread, gb / spread, gp / spread, gs / spread, gd / spread
            v, b, p = v + kv * innovation, b + kb * innovation, p + kp * innovation
            s, d = s + ks * innovation, d + kd * innovation
            vv, vb, vp, vs, vd = vv - kv * gv, vb - kv * gb, vp - kv * gp, vs - kv * gs, vd - kv * gd
            bb, bp, bs, bd = bb - kb * gb, bp - kb * gp, bs - kb * gs, bd - kb * gd
            pp, ps, pd = pp - kp * gp, ps - kp * gs, pd - kp * gd
            ss, sd, dd = ss - ks * gs, sd - ks * gd, dd - kd * gd

        # The total pressure
        y = 1.0 + v * v / heat
        power = y * y * sqrt(y)
        curvature, hp = 7.0 * p / heat * power, power * y
        hv, bend = curvature * v, curvature * vv
        straight = bend * bend <= CURVED * total_variance
        nis_total = 0.0
        if straight:
            gv, gb, gp = hv * vv + hp * vp + vd, hv * vb + hp * bp + bd, hv * vp + hp * pp + pd
            gs, gd = hv * vs + hp * ps + sd, hv * vd + hp * pd + dd
            innovation = total - hp * p - d - 0.5 * bend
            spread = hv * gv + hp * gp + gd + total_variance + 0.5 * bend * bend
            nis_total = innovation * innovation / spread
            self.innovation = innovation
            if nis_total <= GATE:
                kv, kb, kp, ks, kd = gv / spread, gb / spread, gp / spread, gs / spread, gd / spread
                v, b, p = v + kv * innovation, b + kb * innovation, p + kp * innovation
                s, d = s + ks * innovation, d + kd * innovation
                vv, vb, vp, vs, vd = vv - kv * gv, vb - kv * gb, vp - kv * gp, vs - kv * gs, vd - kv * gd
                bb, bp, bs, bd = bb - kb * gb, bp - kb * gp, bs - kb * gs, bd - kb * gd
                pp, ps, pd = pp - kp * gp, ps - kp * gs, pd - kp * gd
                ss, sd, dd = ss - ks * gs, sd - ks * gd, dd - kd * gd

        self.v, self.b, self.p, self.s, self.d = v, b, p, s, d
        self.vv, self.vb, self.vp, self.vs, self.vd = vv, vb, vp, vs, vd
        self.bb, self.bp, self.bs, self.bd = bb, bp, bs, bd
        self.pp, self.ps, self.pd, self.ss, self.sd, self.dd = pp, ps, pd, ss, sd, dd
        return nis_static, nis_total if straight else self.total(total, total_variance, 0.0, heat)
