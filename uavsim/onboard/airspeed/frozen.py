"""Whether a total pressure stands still although it should move: two models of the same readings, compared.

**Healthy.** Energy rate (`energy_model`) without the climb is V V̇ = V (f_x − b) + ṗ/ρ. So the total pressure
p_t = p + ρV²/2 obeys

    ṗ_t = 2 ṗ + ρ V (f_x − b − c x) + ρ V · gust,        x = n²/V²

The last part of the force is that of the angle of attack. Lift needs one, and it turns f_x from the path. With n = −f_z
and m n = ½ρV²S C_Lα (α − α₀), f_x is n α more than the acceleration along the path. That is n²/V² times c = 2m/(ρ S
C_Lα), some metres, different for each aircraft (Etkin 1972, 5.1).

A filter of three states, P of p_t, the bias b, and c, predicts each reading from the aided filter's static pressure p
and the integral of f_x. Its b hardly wanders, while that of the aided filter has to follow launches and pulls. So a
port that freezes has no acceleration to hide behind that is not there. Nor does c give it one: where a port is shut V
is a constant.

**Frozen.** The pressure in the tube is a constant, and a reading is that and noise. The constant is the healthy model's
P, with its variance, at the last instant at which the healthy model was the better one.

**Evidence.** With z the reading,

    W = max(0, W + ln N(z; frozen) − ln N(z; healthy))

is Page's (1954) sum for a change from the healthy to the frozen model. It grows for two reasons. The healthy model
expects motion, by climb or acceleration, that does not come. And it expects gusts, so that its variance S is greater
than the reading's R: that gives ½ ln(S/R) − ½ (1 − R/S) a reading. The second reason needs gusts that are there. Air
for which none are declared may be still. There both models get the variance S, stillness is no evidence, and `STILL`
takes the place of the gusts that the aided filter grants in calm air.
"""

from math import log

BIAS_SD = 0.5  # m/s², α₀; the part's offset comes on top. By hand
# m, c and its standard deviation: 160 N/m² of wing loading at a lift slope of 5.3, and none to 300 N/m². Without c
# flights from 32 to 26 m/s were as a rule taken for shut ports (docs/faults.md)
TURN, TURN_SD = 5.0, 5.0
# 1/m·m/s², of x, averaged over `EASE` s: whenever it has left by so much what it was, a mean over `USED` s, c may have
# moved by `BENT` m. The slope of lift is no constant up to the stall: without it a port was taken for shut in still air
# where the aircraft had slowed down from 80 to 20 m/s. Level flight at 28 … 36 m/s is within it. By hand; the scenario
# `manoeuvres` and docs/faults.md, blocked-calm, hold the check
STEP, EASE, USED, BENT = 0.05, 1.0, 5.0, 0.8
# of an acceleration, which what the pressures and the force say of it may differ by: density, 1 % with a thermometer
# that is 3 K off, the total port, the accelerometer. By hand; without it a flight that had gone from 50 to 127 m/s in
# still air had its total port taken for shut later
SCALE_SD = 0.02
# m/s, turbulence that is expected where none is declared. With more, a shut port in calm flight is seen later. By hand;
# docs/faults.md, blocked-calm, healthy-calm and healthy-speeds, holds the check
STILL = 0.06
# nats that one reading may say at the least and at the most, so that no spike decides: a flag takes ten readings or
# more. By hand
LEAST, MOST = -4.0, 2.0
TURNED = 5.0  # times as fast as in still air b wanders in declared turbulence, whose vertical gusts turn f_x. By hand
DOUBT = 0.035  # nats that a reading in still air takes off beside `by_chance`. By hand, as `STILL`
# readings that are judged as one, their mean, where stillness is no evidence: what chance says is the less, the less of
# S is noise, and it is asked for the less often. By hand; docs/faults.md, blocked-calm, and the still flights of
# tests/onboard/test_airspeed_manoeuvres.py hold the check
TOGETHER = 5
Row = tuple[float, float, float, float, float, float]
# NIS beyond which a healthy model that is ahead doubts its own pressure: three standard deviations, by hand
SURPRISE = 9.0


def by_chance(share: float) -> float:
    """Return what a reading says for "frozen" on average, in nats, where the true pressure stands still.

    The healthy model follows the noise of its readings with the gain K = 1 − ρ, the constant does not. So ν² is greater
    than e² by R·K/(2 − K), and ½ (ν² − e²)/S adds up in a flight at constant speed in still air. As much again, times
    ρ, makes e^W a martingale: chance then passes a level of h nats once in e^h.

    Parameters
    ----------
    share : float
        ρ = R/S, the reading's variance over that of the innovation.
    """
    return 0.5 * share * (1.0 - share)


class FrozenTest:
    """The comparison, fed with every total pressure.

    Parameters
    ----------
    variance : float
        Of a reading's noise, Pa².
    bias_rate : float
        How fast b wanders in steady flight and still air, (m/s²)/√s.
    declared : bool
        Whether turbulence is declared, so that stillness is evidence.
    offset_sd : float
        Offset of f_x, m/s².

    Attributes
    ----------
    evidence : float
        W, nats.
    held : float
        The constant that the frozen model believes in, Pa.
    misfit, count : float, int
        Σ (e²/σ² − 1) of the frozen model since it began, and of how many readings: 0 ± √(2n) if it is true.
    pressure : float
        P less twice the static pressure, Pa, of the healthy model.
    nis, spread : float
        ν²/S and S, Pa², of the last reading.
    lost, lost_variance : float
        b + c x at the last reading, in still air with the mean x of `EASE`: what f_x then was off by, m/s², and its
        variance.
    """

    __slots__ = (
        "_b", "_bb", "_bc", "_bias_density", "_c", "_cc", "_declared", "_last", "_noise", "_pb", "_pc", "_pp",
        "_pushed", "_rows", "_turn", "_turned", "count", "evidence", "held", "held_variance", "lost", "lost_variance",
        "misfit", "nis", "pressure", "spread",
    )  # fmt: skip

    def __init__(self, variance: float, bias_rate: float, declared: bool, offset_sd: float = 0.0) -> None:
        self._noise, self._declared = variance if declared else variance / TOGETHER, declared
        self._rows: list[Row] = []  # fewer than `TOGETHER`
        self._last = (0.0, 0.0, 0.0)
        self._bias_density = (TURNED * bias_rate if declared else bias_rate) ** 2
        self.evidence = self.misfit = self.pressure = self.held = 0.0
        self.count, self.nis, self.spread = 0, 1.0, variance
        self._b, self._c, self.lost = 0.0, TURN, 0.0
        self._turn = self._turned = self._pushed = 0.0
        self._pp, self._bb, self._cc = 1e12, BIAS_SD * BIAS_SD + offset_sd * offset_sd, TURN_SD * TURN_SD
        self._pb = self._pc = self._bc = 0.0
        self.held_variance, self.lost_variance = 1e12, self._bb

    def open_bias(self, variance: float) -> None:
        """Know b less well, by that variance, (m/s²)²; in still air, what has been said against the port is void."""
        self._bb += variance
        if not self._declared:
            self.evidence = 0.0

    def _gather(self, row: Row) -> Row | None:
        """Take what `add` is told, but slope; return the mean of `TOGETHER` readings and what has come between two."""
        rows = self._rows
        rows.append(row)
        if len(rows) < TOGETHER:
            return None
        a = b = c = d = e = f = 0.0
        for reading, static, gained, dt, gust, turn in rows:
            a, b, c, d, e, f = a + reading, b + static, c + gained, d + dt, e + gust, f + turn
        rows.clear()
        share, (x, y, z) = 1.0 / TOGETHER, self._last
        self._last = c, d, e
        return share * a, share * b, 0.5 * (x + c), 0.5 * (y + d), 0.5 * (z + e), share * f

    def _bend(self, turn: float, dt: float) -> None:
        """Know c less well where x has changed."""
        self._turned += (turn - self._turned) * (dt / EASE if dt < EASE else 1.0)
        if not -STEP < self._turned - self._turn < STEP:
            self._turn = self._turned
            self._cc += BENT * BENT
        self._turn += (self._turned - self._turn) * (dt / USED if dt < USED else 1.0)

    def _push(self, gained: float, dt: float) -> None:
        """Know b less well where the acceleration has changed: density, the ports and f_x have scale errors."""
        before = self._pushed * self._pushed
        self._pushed += (gained / dt - self.lost - self._pushed) * (dt / EASE if dt < EASE else 1.0)
        widened = self._pushed * self._pushed - before
        self._bb += SCALE_SD * SCALE_SD * (widened if widened > 0.0 else -widened)

    def add(
        self,
        reading: float,
        static: float,
        static_variance: float,
        gained: float,
        dt: float,
        slope: float,
        gust: float,
        turn: float,
        straight: bool = True,
    ) -> float:
        """Take a reading; return the evidence.

        Parameters
        ----------
        reading : float
            Total pressure, Pa.
        static, static_variance : float
            Static pressure as it is believed at that instant, Pa, and its variance, Pa².
        gained, dt : float
            ∫ f_x dt since the last reading, m/s, and the time, s.
        slope : float
            ρ V, Pa/(m/s).
        gust : float
            Variance that the gust adds to the airspeed in that time, m²/s².
        turn : float
            x = n²/V², 1/m·m/s².
        straight : bool
            Whether flight is straight. In a pull or a turn the healthy model is off by what is not known of lift, and
            nothing is said for a shut port.
        """
        if not self._declared:
            together = self._gather((reading, static, gained, dt, gust, turn))
            if together is None:
                return self.evidence
            reading, static, gained, dt, gust, turn = together
            self._bend(turn, dt)
            self._push(gained, dt)
        noise, bb, bc, cc, pb, pc = self._noise, self._bb, self._bc, self._cc, self._pb, self._pc
        reach = slope * dt
        turned = reach * turn
        self.pressure += slope * gained - reach * self._b - turned * self._c
        new_pb, new_pc = pb - reach * bb - turned * bc, pc - reach * bc - turned * cc
        pp = self._pp - reach * (pb + new_pb) - turned * (pc + new_pc) + slope * slope * gust
        pb, pc = new_pb, new_pc
        bb += self._bias_density * dt
        spread = pp + noise + 4.0 * static_variance
        innovation = reading - 2.0 * static - self.pressure
        nis = innovation * innovation / spread
        self.nis, self.spread = nis, spread
        still, steady = reading - self.held, self.held_variance + noise
        if self._declared:
            said = 0.5 * (log(spread / steady) + nis - still * still / steady)
        else:
            said = 0.5 * (nis - still * still / spread) - TOGETHER * DOUBT - by_chance(noise / spread)
        most = MOST if straight else 0.0
        said = most if said > most else LEAST if said < LEAST else said
        evidence = self.evidence + said
        if not evidence > 0.0 and nis > SURPRISE:
            pp, pb, pc = pp + innovation * innovation, 0.0, 0.0
            spread += innovation * innovation
        kp, kb, kc = pp / spread, pb / spread, pc / spread
        self.pressure += kp * innovation
        self._b += kb * innovation
        self._c += kc * innovation
        self._pp, self._pb, self._pc = pp - kp * pp, pb - kp * pb, pc - kp * pc
        self._bb, self._bc, self._cc = bb - kb * pb, bc - kb * pc, cc - kc * pc
        turn = turn if self._declared else self._turned  # V is not carried on with a moment's n
        self.lost = self._b + self._c * turn
        self.lost_variance = self._bb + turn * (2.0 * self._bc + turn * self._cc)
        if evidence > 0.0:
            gain = self.held_variance / steady
            self.held += gain * still
            self.held_variance = gain * noise
            self.evidence = evidence
            self.misfit += still * still / steady - 1.0
            self.count += 1
        else:
            self.held, self.held_variance = self.pressure + 2.0 * static, self._pp
            self.evidence, self.misfit, self.count = 0.0, 0.0, 0
        return self.evidence
