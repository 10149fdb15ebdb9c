"""Whether a total pressure goes too smoothly for the gusts that are declared: a port that leaks or is nearly shut.

A port that leaks passes no gusts: its pressure falls along an exponential, in a straight line for a second. A live one
in turbulence does not. So a constant-gain α-β filter predicts each reading by level and slope (Benedict & Bordner 1962,
β = α²/(2 − α)), and its errors e, of the variance

    S_t = R (1 + (2α² + 2β + αβ)/(α (4 − 2α − β)))    if only noise is left,

are held against the innovations ν of the healthy model of `frozen`, of the variance S:

    W = max(0, W + ½ ln(S/S_t) + ½ (ν²/S − e²/S_t))

A leak of 5 s at 32 m/s in gusts of 1 m/s lets the pressure fall by 120 Pa/s. A walk of the density D = (ρV)² 2σ²V/L,
487 Pa²/s, would do that with a loss of 120²/2D = 15 nats a second, and the missing gusts say 5 more. In healthy
turbulence e² is twice S_t, and W stays at 0.
"""

from math import inf, log

ALPHA = 0.12  # a memory of 0.1 s at 100 Hz: longer sees fewer gusts, shorter is at the slope of a leak sooner. By hand
BETA = ALPHA * ALPHA / (2.0 - ALPHA)
SHARE = 1.0 + (2.0 * ALPHA * ALPHA + 2.0 * BETA + ALPHA * BETA) / (ALPHA * (4.0 - 2.0 * ALPHA - BETA))
# nats, above which it is a leak. By hand; docs/faults.md, slow-leak-gusts and healthy-gusty, holds the check
LEVEL = 18.0
CLIP = 4.0  # squared standard deviations that ν² counts at the most. By hand: a gust that begins is no leak
LEAST, MOST = -4.0, 1.0  # nats that a reading may say, so that no spike decides. By hand

# e²/S_t at which a reading's part is clipped, what is taken off, 1 being noise, and the sum from which on a port shows
# gusts. In turbulence of 1 m/s the mean is 2.3, and it takes some 40 readings. By hand
MOST_ROUGH, LEAST_ROUGH, ROUGH = 9.0, 1.5, 25.0
# the sum's greatest value: what is above `ROUGH` of it is gone half a second later, before the port has agreed for long
# enough. Without it a single step of 40 Pa, which is no gust, was life for two seconds. By hand
MOST_SHOWN = 2.0 * ROUGH
GAP = 0.1  # s without a reading, after which the prediction begins anew


class SmoothTest:
    """The comparison, fed with every total pressure.

    Parameters
    ----------
    variance : float
        Of a reading's noise, R, Pa².

    Attributes
    ----------
    evidence : float
        W, nats.
    """

    __slots__ = ("_rough", "_slope", "_spread", "_t", "_value", "evidence")

    def __init__(self, variance: float) -> None:
        self._spread = SHARE * variance
        self._value = self._slope = self.evidence = self._rough = 0.0
        self._t = -inf

    def flag(self, t: float) -> None:
        """Be told at `t`, s, that the port is flagged: it has to show gusts before it is believed again."""
        self._rough, self._t = 0.0, t

    def lives(self, t: float, reading: float) -> bool:
        """While the port is flagged, take a reading; return whether it has shown gusts."""
        dt = t - self._t
        self._t = t
        if not 0.0 < dt < GAP:
            self._value, self._slope = reading, 0.0
            return self._rough > ROUGH
        error = reading - self._value - self._slope * dt
        self._value = reading - (1.0 - ALPHA) * error
        self._slope += BETA * error / dt
        size = error * error / self._spread
        self._rough += (size if size < MOST_ROUGH else MOST_ROUGH) - LEAST_ROUGH
        self._rough = min(max(self._rough, 0.0), MOST_SHOWN)
        return self._rough > ROUGH

    def add(self, reading: float, dt: float, nis: float, spread: float, straight: bool) -> float:
        """Take a reading; return W.

        Parameters
        ----------
        reading, dt : float
            Pa, and the time since the last, s.
        nis, spread : float
            ν²/S and S, Pa², of the healthy model.
        straight : bool
            Whether flight is straight; in a pull or a turn the healthy model is off, and nothing is said for a leak.
        """
        if not dt > 0.0:
            self._value, self._slope, self.evidence = reading, 0.0, 0.0
            return 0.0
        error = reading - self._value - self._slope * dt
        self._value = reading - (1.0 - ALPHA) * error
        self._slope += BETA * error / dt
        nis = nis if nis < CLIP else CLIP
        said = 0.5 * (log(spread / self._spread) + nis - error * error / self._spread)
        if said > 0.0 and not straight:
            said = 0.0
        said = MOST if said > MOST else LEAST if said < LEAST else said
        evidence = self.evidence + said
        self.evidence = evidence = evidence if evidence > 0.0 else 0.0
        return evidence
