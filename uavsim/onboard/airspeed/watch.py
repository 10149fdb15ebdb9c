"""The watch over both ports: the tests' bookkeeping, which of the two is to blame, and the way back.

A port that freezes is followed by the filter until the tests are sure, and V and b are by then what it made of them. So
the last instant at which the live port was the better explanation is kept, with V, b and p. If it was the total
pressure's, V is carried on from there by energy rate alone,

    V = V₀ + ∫ f_x dt − b T + (p − p₀)/(ρ V₀),        σ_V² = σ₀² + (σ_b T)² + gust · T + (σ_p/ρV₀)² + u²

with T the time since, b and σ_b what f_x is off by and how well the filter of `frozen` knows it, and u what a port may
have been off by before. A port that drifts is left 2 s before its flag, one that leaks (`wandering`) where for 2 s no
more than a gust had been between V and the force. If it was the static port, p is carried on with the climb c₀ of then,
p = p_held − ρ g c₀ T, and V is corrected for it; the total pressure is taken on, and tells the climb by p_t and f_x.

A static pressure that stands still in a climb makes the total pressure wrong, too: energy rate expects it to rise. Then
the total pressure is no constant, and the static pressure is: that one is to blame. Which of the two tests is first is
chance; the static pressure's goes by f_z alone and says nothing of a total pressure that is wrong, so it has the word.
"""

from math import exp, inf

from uavsim.onboard.airspeed.climb import GRAVITY, ClimbTest
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.frozen import STILL
from uavsim.onboard.airspeed.monitor import PortMonitor
from uavsim.onboard.airspeed.readmission import Readmission
from uavsim.onboard.airspeed.settings import AidedSettings
from uavsim.onboard.airspeed.wandering import WanderingTest

Kept = tuple[float, float, float, float, float, float, float]
"""When, s; ∫ f_x dt, V, its variance, p, b and its variance."""
NOTHING: Kept = (-inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
PACE, KEPT = 0.5, 5  # s between what is kept of V, and how many of them: a port that drifts is left 2 s before its flag
GAP = 0.1  # s without a pressure, after which its tests begin anew
UNSEEN = 0.5  # m/s, what a port may have been off by before the tests began to doubt it
SLOW, LEARNT = 10.0, 5.0  # s, over which what f_x is off by is averaged while gusts allow, and at first in any case
FINE = 6  # equal readings in a row that chance makes while noise is at least half a step
LOST_SD = 0.2  # m/s², of that mean
AGREE_SD = 5.0 / 3.0  # m/s; a port that drifted or leaked agrees within three of it, however little coasting knows
DOUBTFUL = 4.0  # nats; less has a static port that lives in a climb, as a rule
SHUT, SUSPECT = 14.0, 7.0  # nats, by which the static port is flagged, and if the total pressure seems to be wrong
CLIMB_SD = 0.5  # m/s, of the climb by which a shut static port is left
BIAS_SD = 0.1  # m/s², of the slow b
SLOWEST = 10.0  # m/s, below which no wing flies


def apart(usual: int) -> float:
    """Return how many readings say as much as one: a sensor whose steps exceed its noise stays on one for a row."""
    return max(1.0, usual / FINE)


def _part(energy: EnergyFilter) -> None:
    """Forget what V and b have to do with the rest."""
    energy.vp = energy.vs = energy.vd = energy.vk = energy.bp = energy.bs = energy.bd = energy.bk = 0.0


class TotalWatch:
    """Tests of the total pressure's port.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of the air.
    variance, walk : float
        Of a reading's noise, Pa², and random walk of the pair's difference, Pa/√s.
    usual : int
        The longest row of equal readings that the live sensor has been seen to give.
    offset_sd : float
        Offset of f_x, m/s².
    force_density : float
        By how much noise of f_x widens its integral, m²/s³.

    Attributes
    ----------
    port : PortMonitor
    faulty : bool
        Whether the port is flagged.
    """

    __slots__ = (
        "_astray", "_bb", "_before", "_bias", "_bias_sd", "_bias_time", "_declared", "_force_density", "_jumped",
        "_jumped_at", "_last", "_lost", "_near", "_p", "_sound", "_still", "_t", "_t0", "_taught", "_u", "_u0",
        "_v", "_vv", "_wandering", "faulty", "port",
    )  # fmt: skip

    def __init__(
        self,
        aided: AidedSettings,
        variance: float,
        walk: float,
        usual: int = 0,
        offset_sd: float = 0.0,
        force_density: float = 0.0,
    ) -> None:
        self._declared, self._force_density = aided.gust_sd > aided.gust_floor, force_density
        self._still = 2.0 * STILL * STILL / aided.gust_length
        self._bias_sd, self._bias_time = aided.bias_sd, aided.bias_time
        self._jumped, self._jumped_at = 0.0, -inf
        self._wandering = WanderingTest(aided.gust_sd, aided.gust_length)
        self.port = PortMonitor(aided.bias_rate, variance * apart(usual), walk, usual, self._declared, offset_sd)
        self.faulty = self._astray = False
        self._t = self._t0 = -inf
        self._before: tuple[Kept, ...] = (NOTHING,)
        self._sound, self._near, self._taught = NOTHING, 0, 0.0
        self._u = self._u0 = self._v = self._vv = self._p = self._bias = self._bb = self._last = self._lost = 0.0

    def take(
        self,
        energy: EnergyFilter,
        t: float,
        gained: float,
        lift: float,
        reading: float,
        nis: float,
        density: float,
        gust: float,
    ) -> str:
        """Take a reading that the filter has taken; return what seems to be wrong, as `PortMonitor.add`.

        Parameters
        ----------
        energy : EnergyFilter
            At `t`, the reading's instant, s.
        gained, lift : float
            ∫ f_x dt up to there, m/s, and −f_z, m/s².
        reading : float
            Tared, Pa.
        nis : float
            Normalised innovation squared.
        density, gust : float
            Of the air, kg/m³, and of its gusts, 2 σ²/L, m/s².
        """
        port, dt, v = self.port, t - self._t, energy.v
        if dt > GAP:
            port.restart()
            dt, self._u, self._t0 = 0.0, gained, -inf
            self._before, self._sound, self._last = (NOTHING,), NOTHING, v
            self._near, self._taught = 0, 0.0
            self._wandering.forget()
        test = port.frozen
        spread = (gust if self._declared else self._still) * v
        if spread < self._force_density:  # noqa: PLR1730 - a coarse accelerometer hides more of V than still air
            spread = self._force_density
        if t - self._before[-1][0] > PACE:
            now = t, gained, v, energy.vv, energy.p, test.lost, test.lost_variance
            self._before = (*self._before[1 - KEPT :], now)
            self._near = self._near + 1 if self._wandering.near else 0
            if self._near >= KEPT:
                self._sound = (*self._before[0][:5], self._lost, LOST_SD * LOST_SD)
        change, turn = gained - self._u, lift * lift / (v * v if v > SLOWEST else SLOWEST * SLOWEST)
        healthy = test.add(reading, energy.p, energy.pp, change, dt, density * v, spread * dt, turn) == 0.0
        if healthy or self._t0 == -inf:
            self._t0, self._u0, self._v, self._vv, self._p = t, gained, v, energy.vv, energy.p
            self._bias, self._bb = test.lost, test.lost_variance
        self._t, self._u = t, gained
        if self._wanders(v, change - energy.s * dt, test.lost, dt):
            return "leak"
        return port.add(reading, energy.innovation, nis, energy.b * energy.b / self._bias_variance(t))

    def _wanders(self, v: float, gained: float, lost: float, dt: float) -> bool:
        """Whether V has left what the force gave; what f_x is off by is learnt slowly, and not from a leak."""
        wandering = self._wandering
        if dt > 0.0 and (wandering.near or self._taught < LEARNT):
            self._taught += dt
            self._lost += (lost - self._lost) * dt / (self._taught if self._taught < SLOW else SLOW)
        away = wandering.add(v, v - self._last, gained - self._lost * dt, dt)
        self._last = v
        return away

    def pause(self) -> None:
        """Let the tests begin anew with the next reading."""
        self._t = -inf

    def jump(self, t: float, variance: float) -> None:
        """Be told by how much the push has widened b at `t`, s: its variance, (m/s²)², which b forgets in its time."""
        self._jumped, self._jumped_at = self._bias_variance(t) - self._bias_sd**2 + variance, t

    def _bias_variance(self, t: float) -> float:
        """What b may be off by at `t`, s, (m/s²)²."""
        since = t - self._jumped_at
        left = self._jumped * exp(-2.0 * since / self._bias_time) if since > 0.0 else self._jumped
        return self._bias_sd * self._bias_sd + left

    def flag(self, kind: str, energy: EnergyFilter, density: float, gust: float) -> None:
        """Flag the port, and put the filter to where it would be without what it took since."""
        test = self.port.frozen
        if kind == "jump":  # nothing has been taken of it
            self._t0, self._u0, self._v, self._vv, self._p = self._t, self._u, energy.v, energy.vv, energy.p
            self._bias, self._bb = test.lost, test.lost_variance
        elif kind != "frozen":  # it has been wrong for a while: to before that
            before = self._sound if kind == "leak" else self._before[0]
            if before[0] > -inf:
                self._t0, self._u0, self._v, self._vv, self._p, self._bias, self._bb = before
        speed = max(self._v, 1.0)
        since, slope = self._t - self._t0, density * speed
        if kind == "frozen":
            self.port.back.flag(self._t, test.held, test.held_variance)
        else:
            self.port.back.flag(self._t)
        self.faulty, self._astray = True, kind in ("drift", "leak")
        energy.v = self._v + self._u - self._u0 - self._bias * since + (energy.p - self._p) / slope
        bb = min(self._bb, self._bias_sd * self._bias_sd)
        energy.vv = self._vv + gust * speed * since + bb * since * since + UNSEEN * UNSEEN
        energy.vv += energy.pp / (slope * slope)
        energy.b, energy.bb = self._bias, bb
        energy.vb = -bb * since
        self._p = energy.p
        _part(energy)

    def carry(self, energy: EnergyFilter, dt: float, gained: float, variance: float, density: float) -> None:
        """While flagged, advance by energy rate: V takes what p gains, and p tells nothing of V and b in return.

        The arguments are those of `EnergyFilter.predict`. What b has been found to be stays; its deviation from that
        wanders as b does.
        """
        v, p = energy.v, energy.p
        energy.b = 0.0
        energy.predict(dt, gained, variance, density, False)
        energy.v = v + gained - dt * self._bias + (p - self._p) / (density * max(v, 1.0))
        energy.b, self._p = self._bias, p
        _part(energy)

    def coast(self, reading: float, pressure: float, difference: float, spread: float, t: float) -> bool:
        """While flagged, take a reading as `Readmission.hear` does; True if the flag falls."""
        if self._astray:
            spread = min(spread, AGREE_SD * AGREE_SD)
        if not self.port.back.hear(t, reading, pressure, difference, spread):
            return False
        self.faulty = False
        self.port.restart()
        self._t = -inf
        return True


class StaticWatch:
    """Tests of the static port.

    Parameters
    ----------
    variance, walk : float
        Of a reading's noise, Pa², and random walk of the sensor, Pa/√s.
    usual : int
        As of `TotalWatch`.
    offset_sd : float
        Offset of f_z, m/s².

    Attributes
    ----------
    faulty : bool
        Whether the port is flagged.
    """

    __slots__ = ("_back", "_offset_sd", "_t", "_test", "_variance", "faulty")

    def __init__(self, variance: float, walk: float, usual: int = 0, offset_sd: float = 0.0) -> None:
        self._variance, self._offset_sd = variance * apart(usual), offset_sd
        self._back = Readmission(variance, walk, usual)
        self._test, self._t, self.faulty = ClimbTest(variance, 0.0, offset_sd), -inf, False

    @property
    def suspect(self) -> bool:
        """Whether it is to blame for a total pressure that does not fit."""
        return self._test.evidence > SUSPECT

    @property
    def repeating(self) -> bool:
        """Whether its readings are perhaps stuck: too early to blame anybody."""
        return self._back.repeating

    @property
    def doubtful(self) -> bool:
        """Whether it perhaps stands still: too early to blame the total pressure for that."""
        return self._test.evidence > DOUBTFUL

    def take(self, t: float, reading: float, lift: float, density: float) -> str:
        """Take a reading; return what is wrong with the port, "frozen" or "stuck"; "" for nothing.

        Parameters
        ----------
        t : float
            Its instant, s.
        reading : float
            Pa.
        lift : float
            Mean of −f_z since the last one, m/s²; NaN where it is not known, and the port is not tested.
        density : float
            Of the air, kg/m³.
        """
        if self._back.repeats(reading):
            return "stuck"
        if not -inf < lift < inf:
            return ""
        dt = t - self._t
        if dt > GAP:
            self._test, dt = ClimbTest(self._variance, reading, self._offset_sd), 0.0
        self._t = t
        evidence = self._test.add(reading, dt, lift, density * GRAVITY)
        return "frozen" if evidence > SHUT else ""

    def flag(self, kind: str, energy: EnergyFilter, density: float, bias: float) -> None:
        """Flag the port; if it was shut, put the filter to where the climb of then would have led."""
        test = self._test
        self.faulty = True
        if kind != "frozen":
            self._back.flag(self._t)
            return
        self._back.flag(self._t, test.held, test.held_variance)
        weight, v = density * GRAVITY, max(energy.v, 1.0)
        off = weight * CLIMB_SD
        p = test.held - weight * test.climb_then * test.since
        energy.v += (energy.p - p) / (density * v)
        energy.pp += (off * test.since) ** 2 + test.held_variance
        energy.vv += energy.pp / (density * v) ** 2 + UNSEEN * UNSEEN
        energy.p, energy.s, energy.ss = p, GRAVITY * test.climb_then / v, (GRAVITY * CLIMB_SD / v) ** 2
        energy.ps = -off * test.since * GRAVITY * CLIMB_SD / v
        energy.b, energy.bb = bias, BIAS_SD * BIAS_SD
        energy.vb = energy.pd = energy.pk = energy.sd = energy.sk = 0.0
        _part(energy)

    def coast(self, t: float, reading: float, difference: float, spread: float) -> bool:
        """While flagged, take a reading as `Readmission.hear` does; True if the flag falls."""
        if not self._back.hear(t, reading, reading, difference, spread):
            return False
        self.faulty, self._t = False, -inf
        return True
