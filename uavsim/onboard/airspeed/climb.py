"""Whether a static pressure stands still although the aircraft climbs or sinks: two models of the same readings.

**Healthy.** The climb c changes by what the accelerometer feels across the wings, wings level or nearly so,

    ċ = −(f_z + g) − a + noise,        ṗ = −ρ g c

with a for the accelerometer's bias and for the attitude. The climb is measured by the static pressure itself. So a port
that shuts in a climb tells of a pull, from the climb to none, which f_z has not felt.

A bank φ takes n cos φ − g of the lift n = −f_z upwards, no more than n − g. So a pull may be a turn's, in which nothing
climbs, and widens c; what is felt the other way makes the aircraft sink at least by so much, unless n is below 0 and it
may lie on its back. In gusts every second pull is of that kind.

**Frozen.** The pressure in the tube is a constant. As in `frozen`, the evidence for this model is

    W = max(0, W + ½ (ν²/S − e²/S) − δ)

with ν and e what the two models are off by, and S the healthy one's variance for both. So still air and level flight
are no evidence.
"""

from uavsim.onboard.airspeed.frozen import LEAST, MOST, SURPRISE, by_chance
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.lift import STRAIGHT, Pull

# m/s and (m/s)/√s: the climb at the start, and what roll and pitch turn away from f_z. By hand: with a smaller rate a
# turn would look like a shut port, with a greater one a shut port like a turn
CLIMB_SD, CLIMB_RATE = 3.0, 0.12
# s for which a pull (`lift`) may be a turn's and no change of climb: in a level turn at 60° f_z says 1 g, and the climb
# stays. By hand: as long as it takes to roll; tests/onboard/test_airspeed_manoeuvres.py holds the check
TURNING = 1.0
# Pa, and Pa/(m/s) of V, the greater: the least standard deviation of a reading for the comparison. However quiet the
# sensor is, a gust of 1 m/s moves a static port whose position error is some hundredths of q by so much, and f_z tells
# the climb no better. By hand: without it 10 of 60 flights of manoeuvres had a quiet static port flagged, with it none
# of 118 passed 8 nats (docs/faults.md)
LEAST_NOISE, LEAST_OF_V = 3.0, 0.1
BIAS_SD, BIAS_RATE = 0.5, 0.05  # m/s² and (m/s²)/√s of a. By hand, as the rate above
DOUBT = 0.03  # nats that a reading takes off, so that chance does not add up. By hand; docs/faults.md holds the check


class ClimbTest:
    """The comparison, fed with every static pressure.

    Parameters
    ----------
    variance : float
        Of a reading's noise, Pa².
    static : float
        Static pressure at the start, Pa.
    offset_sd : float
        Offset of f_z, m/s².

    Attributes
    ----------
    evidence : float
        W, nats.
    held, held_variance : float
        The constant that the frozen model believes in, Pa and Pa².
    since, climb_then : float
        How long ago the healthy model was the better one, s, and its climb then, m/s.
    p, c, a : float
        State of the healthy model: Pa, m/s, m/s².
    """

    __slots__ = (
        "_aa",
        "_ca",
        "_cc",
        "_noise",
        "_pa",
        "_pc",
        "_pp",
        "_pull",
        "a",
        "c",
        "climb_then",
        "evidence",
        "held",
        "held_variance",
        "p",
        "since",
    )  # fmt: skip

    def __init__(self, variance: float, static: float, offset_sd: float = 0.0) -> None:
        self._noise = max(variance, LEAST_NOISE * LEAST_NOISE)
        self.p = self.held = static
        self._pull = Pull()
        self.c = self.a = self.evidence = self.since = self.climb_then = 0.0
        self._pp = self.held_variance = 1e6
        self._cc, self._aa = CLIMB_SD * CLIMB_SD, BIAS_SD * BIAS_SD + offset_sd * offset_sd
        self._pc = self._pa = self._ca = 0.0

    def add(self, reading: float, dt: float, lift: float, weight: float, speed: float = 0.0) -> float:
        """Take a reading; return the evidence.

        Parameters
        ----------
        reading : float
            Static pressure, Pa.
        dt : float
            Since the last one, s.
        lift : float
            −f_z, its mean over that time, m/s².
        weight : float
            ρ g, Pa/m.
        speed : float
            V, m/s.
        """
        r, noise, least = weight * dt, self._noise, LEAST_OF_V * speed
        if least > LEAST_NOISE and least * least > noise:
            noise = least * least
        pull = lift - GRAVITY
        self._pull.add(lift - self.a, dt)  # a turn is known by what is beyond f_z's own offset
        mean = self._pull.mean
        size = (mean if mean > 0.0 else -mean - GRAVITY) - STRAIGHT  # of what may be a turn's
        size = size if size > 0.0 else 0.0
        rate = CLIMB_RATE * CLIMB_RATE + size * size * TURNING
        self.c += (pull - self.a) * dt
        self.p -= r * self.c
        # c ← c − dt a, then p ← p − r c, each on rows and columns
        pa, ca, aa = self._pa, self._ca, self._aa
        pc = self._pc - dt * pa
        new_ca = ca - dt * aa
        cc = self._cc - dt * (ca + new_ca) + rate * dt
        ca = new_ca
        new_pc = pc - r * cc
        pp = self._pp - r * (pc + new_pc) + 1e-3 * noise
        pc, pa = new_pc, pa - r * ca
        aa += BIAS_RATE * BIAS_RATE * dt
        spread = pp + noise
        innovation, still = reading - self.p, reading - self.held
        nis = innovation * innovation / spread
        said = 0.5 * (nis - still * still / spread) - DOUBT - by_chance(noise / spread)
        evidence = self.evidence + (MOST if said > MOST else LEAST if said < LEAST else said)
        if not evidence > 0.0 and nis > SURPRISE:
            pp, pc, pa = pp + innovation * innovation, 0.0, 0.0
            spread += innovation * innovation
        kp, kc = pp / spread, pc / spread
        ka = pa / spread if size == 0.0 else 0.0  # a turn teaches nothing of what f_z is off by
        self.p += kp * innovation
        self.c += kc * innovation
        self.a += ka * innovation
        self._pp, self._pc, self._pa = pp - kp * pp, pc - kp * pc, pa - kp * pa
        self._cc, self._ca, self._aa = cc - kc * pc, ca - kc * pa, aa - ka * pa
        if evidence > 0.0:
            gain = self.held_variance / (self.held_variance + noise)
            self.held += gain * still
            self.held_variance = gain * noise
            self.evidence, self.since = evidence, self.since + dt
        else:
            self.held, self.held_variance, self.evidence = self.p, self._pp, 0.0
            self.since, self.climb_then = 0.0, self.c
        return self.evidence
