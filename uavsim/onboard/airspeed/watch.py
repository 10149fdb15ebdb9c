"""The watch over each port: its tests, where the filter goes on from after a flag, and the way back.

A port that freezes is followed by the filter until the tests are sure. By then V and b are what the frozen port has
made of them. So the watch keeps V, b and p of the last instant at which a live port explained the readings better.

**Total port.** After its flag V is carried on from that instant by energy rate alone,

    V = V₀ + ∫ f_x dt − b T + (p − p₀)/(ρ V₀),        σ_V² = σ₀² + (σ_b T)² + gust · T + (σ_p/ρV₀)² + u²

with T the time since; b and σ_b what f_x is off by and how well the filter of `frozen` knows that; u what the port may
have been off by before. After a drift V goes back to 2 s before the flag. After a leak (`leak`) it goes back to where,
for 2 s, no more than a gust had been between V and the force. After a jump nothing of it has been taken, and V stays.

**Static port.** After its flag p is carried on with the climb c₀ of that instant, p = p_held − ρ g c₀ T. V is corrected
for the difference. The total pressure is taken on; with f_x it tells the climb.

Which of the two ports is to blame where both seem wrong is weighed in `ports`.
"""

from math import exp, inf, nan

from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.climb import ClimbTest
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.frozen import STILL
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.leak import LeakTest
from uavsim.onboard.airspeed.lift import TURN, TURN_SD, Pull
from uavsim.onboard.airspeed.monitor import SLIDE, PortMonitor
from uavsim.onboard.airspeed.readmission import MUTE, Readmission
from uavsim.onboard.airspeed.settings import AidedSettings
from uavsim.onboard.airspeed.smooth import LEVEL, SmoothTest
from uavsim.onboard.repeats import LEAST, apart

Kept = tuple[float, float, float, float, float, float, float]
"""When, s; ∫ f_x dt, V, its variance, p, b and its variance."""
NOTHING: Kept = (-inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

# -- what is kept to go back to ----------------------------------------------------------------------------------------

# s between what is kept of V, and how many of them: V goes back 2 s. By hand; drifts are flagged within 2 s
# (docs/faults.md, leak-gusts and slow-leak-calm)
PACE, KEPT = 0.5, 5
# s before the last instant at which a live port was the better explanation. In still air a port that has just shut is
# that for some tenths of a second, in which b is learnt from it. By hand; docs/faults.md, blocked-descent: without it b
# was 0.4 m/s² off, and V 6 m/s in 10 s
EARLIER = 1.0
# m/s, u: what a port may have been off by before its test began to doubt it. By hand; docs/faults.md holds the check:
# after a flag 95 % of the valid estimates are within their error bars, but for a leak as slow as a gust
UNSEEN = 0.5
GAP = 0.1  # s without a pressure, after which a test begins anew: ten readings at 100 Hz. By hand

# -- what f_x is off by, for the leak's test ---------------------------------------------------------------------------

# s. It is averaged over the last 10 s, and only while no more than a usual gust is between V and the force, for a leak
# must not be learnt. In the first 5 s it is learnt in any case. By hand; docs/faults.md, the leaks, holds the check
SLOW, LEARNT = 10.0, 5.0
DOUBTED = 6.0  # nats of `smooth`: a port that wanders from the force and shows the gusts does not leak. By hand
REOPENED = 2.0  # s after a step of f_x, in which the healthy model knows too little of b to tell a leak. By hand
RELEARNT = 1.0  # s, over which it is averaged after a step of f_x. By hand
# m/s², beyond which a pull or a turn makes the healthy model wrong, and nothing is said for a leak. By hand
TURNS = 2.5
# m/s², of the pull beyond `lift.STRAIGHT`, from which on flight is no longer straight for the test of a shut port: a
# turn at 36°. Gusts of 1 m/s stay below as a rule. By hand
BENT = 1.5
# 1/m·m/s², of x = n²/V²: a c that is 5 m off is 0.4 m/s² then, 4 m/s in 10 s. A turn at 40° and 32 m/s has it. By hand;
# the scenario `manoeuvres` holds the check
UNTURNED = 0.08
LOST_SD = 0.2  # m/s², standard deviation of that mean, with which V is carried on after a leak. By hand, as `UNSEEN`

# -- the way back ------------------------------------------------------------------------------------------------------

# m/s. After a drift or a leak a port agrees within three of it, 5 m/s, however little the coasting filter knows: a port
# that goes on leaking would agree with any airspeed at last. By hand; docs/faults.md, "After a flag"
AGREE_SD = 5.0 / 3.0

# kinds of which the filter has taken nothing, and those after which a port must agree within `AGREE_SD`
UNTAKEN = ("jump", *MUTE)
ASTRAY = ("drift", "leak", "jump")
# kinds of a static port that is shut, to both sensors of a head that has a differential one; others are of its sensor
SHUT_IN = ("frozen", "swapped")
# kinds after which it must show the gusts that are declared: a port that is shut and leaks moves, but shows none
GUSTLESS = ("frozen", "drift", "leak")

# s from the last instant at which a live port was the better explanation to the flag. Beyond it an accelerometer that
# drifts explains a total pressure that stands still in still air as well. By hand
SLOWLY = 1.0

# Pa/s, of the total pressure before that: where it had moved no faster, only the force has changed, and nothing but an
# accelerometer that drifts may have been the reason. A climb of 2 m/s makes 24. By hand
MOVES = 15.0

# -- the static port's test, nats (`climb`) ----------------------------------------------------------------------------

# above it the port is flagged. By hand; docs/faults.md: in a climb 100 of 100 within 0.54 s, in 500 healthy flights
# none
SHUT = 14.0
# above it the static port is to blame where the total pressure seems wrong: half of `SHUT`, by hand. Without it a third
# of the static ports that shut in a climb had the total port flagged, with it 1 of 100
SUSPECT = 7.0
# above it, in still air, a total port that seems shut waits for the static port's test. By hand: a live static port in
# a climb stays below, as a rule
DOUBTFUL = 4.0
CLIMB_SD = 0.5  # m/s, of the climb by which p is carried on. By hand
BIAS_SD = 0.1  # m/s², of b after the flag, which is taken from the total port's test. By hand
LEAST_FLIGHT = 10.0  # m/s, below which no wing flies, and lift says nothing of the angle of attack


class TotalWatch:
    """Tests of the total pressure's port.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of the air.
    variance, walk : float
        Of a reading's noise, Pa², and random walk of the pair's difference, Pa/√s.
    row, alike : float
        How often its sensor may repeat a number, and how probable a repetition is (`uavsim.onboard.repeats`).
    offset_sd : float
        Offset of f_x, m/s².
    force_density : float
        By how much noise of f_x widens its integral, m²/s³.
    row_variance : float or None
        Of what `coast` takes, Pa²; None: `variance`.

    Attributes
    ----------
    port : PortMonitor
    faulty : bool
        Whether the port is flagged.
    coasts : bool
        Whether V is carried on apart from p; after mere silence the filter goes on as it is.
    undecided : bool
        Whether an accelerometer that drifts would explain the same: in still air the airspeed crept from the force.
    """

    __slots__ = (
        "_astray", "_before", "_bias", "_bias_sd", "_bias_time", "_declared", "_force_density", "_gust_variance",
        "_jumped", "_jumped_at", "_last", "_lost", "_near", "_opened", "_opened_by", "_p", "_pull", "_rough",
        "_silent", "_smooth", "_sound", "_static", "_still", "_t", "_taught", "_trusted", "_turn", "_u", "_usual_slide",
        "_wandering",
        "coasts", "faulty", "port", "undecided",
    )  # fmt: skip

    def __init__(
        self,
        aided: AidedSettings,
        variance: float,
        walk: float,
        row: float = LEAST,
        alike: float = 0.0,
        offset_sd: float = 0.0,
        force_density: float = 0.0,
        row_variance: float | None = None,
    ) -> None:
        self._declared, self._force_density = aided.gust_sd > aided.gust_floor, force_density
        self._still = 2.0 * STILL * STILL / aided.gust_length
        self._bias_sd, self._bias_time = aided.bias_sd, aided.bias_time
        self._usual_slide = SLIDE * aided.bias_sd**2
        self._jumped, self._jumped_at, self._opened = 0.0, -inf, -inf
        self._opened_by = aided.bias_sd**2, -inf
        self._wandering = LeakTest(max(aided.gust_sd, aided.shear), aided.gust_length)
        self.port = PortMonitor(aided.bias_rate, variance * apart(alike), walk, row, self._declared, offset_sd)
        if row_variance is not None:
            self.port.back = Readmission(row_variance * apart(alike), walk, row)
        self.faulty = self._astray = self.undecided = self._silent = self.coasts = False
        self._t, self._u, self._last, self._lost = -inf, 0.0, 0.0, 0.0
        self._trusted = self._sound = NOTHING  # when a live port was the better explanation, and when no leak was near
        self._before: tuple[Kept, ...] = (NOTHING,)
        self._near, self._taught, self._turn, self._static = 0, 0.0, 0.0, 0.0
        self._pull, self._gust_variance = Pull(), aided.gust_sd**2
        self._smooth, self._rough = SmoothTest(variance * apart(alike)), NOTHING
        self._p = self._bias = 0.0  # while flagged: what coasting goes by

    def take(
        self,
        energy: EnergyFilter,
        t: float,
        gained: float,
        lift: float,
        read: float,
        reading: float,
        nis: float,
        air: Air,
    ) -> str:
        """Take a reading that the filter has taken; return what seems to be wrong, as `PortMonitor.add`.

        Parameters
        ----------
        energy : EnergyFilter
            At `t`, the reading's instant, s.
        gained, lift : float
            ∫ f_x dt up to there, m/s, and −f_z, m/s².
        read, reading : float
            The channel as it came (`difference`), and the pressure tared, Pa.
        nis : float
            Normalised innovation squared.
        air : Air
        """
        port, dt, v = self.port, t - self._t, energy.v
        if dt > GAP:
            port.restart()
            dt, self._u, self._trusted = 0.0, gained, NOTHING
            self._before, self._sound, self._last = (NOTHING,), NOTHING, v
            self._near, self._taught, self._static = 0, 0.0, energy.p
            self._wandering.forget()
        test = port.frozen
        spread = (air.gust if self._declared else self._still + air.shear) * v
        if spread < self._force_density:  # noqa: PLR1730 - a coarse accelerometer hides more of V than still air
            spread = self._force_density
        if t - self._before[-1][0] > PACE:
            now = t, gained, v, energy.vv, energy.p, test.lost, test.lost_variance
            self._before = (*self._before[1 - KEPT :], now)
            self._near = self._near + 1 if self._wandering.near else 0
            if self._near >= KEPT:
                self._sound = (*self._before[0][:5], self._lost, LOST_SD * LOST_SD)
        change, turn = gained - self._u, lift * lift / (v * v if v > LEAST_FLIGHT else LEAST_FLIGHT * LEAST_FLIGHT)
        gust = spread * dt + self._pull.add(lift, dt)
        # of compressible flow, to the order of M²: ∂p_t/∂V = ρV (1 + M²/2), and ṗ_t has 2 + 1.2 M² of ṗ
        mach2 = 5.0 * v * v / air.heat
        slope = air.density * v * (1.0 + 0.5 * mach2)
        felt = change + 1.2 * mach2 * (energy.p - self._static) / slope
        self._static = energy.p
        straight = self._pull.size < BENT
        healthy = test.add(reading, energy.p, energy.pp, felt, dt, slope, gust, turn, straight) == 0.0
        if healthy or self._trusted is NOTHING:
            self._trusted = t, gained, v, energy.vv, energy.p, test.lost, test.lost_variance
        self._t, self._u = t, gained
        wandering = self._wandering
        wanders = self._wanders(v, change - energy.s * dt, test.lost, lift, dt)
        if self._declared:
            straight = self._pull.size < TURNS and t > self._opened
            smooth = self._smooth.add(reading, dt, test.nis, test.spread, straight)
            if smooth == 0.0 and not wandering.large:
                self._rough = t, gained, v, energy.vv, energy.p, self._lost, LOST_SD * LOST_SD
            if (smooth > LEVEL and wandering.large) or (wanders and smooth > DOUBTED):
                return "leak"
        elif wanders:
            return "leak"
        slide = energy.b * energy.b  # of what is usual it need not be known how usual it is
        slide = slide / self._bias_variance(t) if slide > self._usual_slide else 0.0
        if slide > SLIDE and wandering.near:
            slide = self._slide(energy.b, t, v, lift, slide)
        return port.add(read, energy.innovation, nis, slide)

    def _slide(self, b: float, t: float, v: float, lift: float, alone: float) -> float:
        """Return b² over its variance, or of its change, if that is less; `alone` is the former.

        A b that has long been there is α, or an offset: a port that drifts by as much had been far from the force.
        So it is asked only while V is near it; a leak of 1 s in gusts is then flagged as soon as b says so.
        """
        turned = self._by_force(v, lift) - self._turn
        off, doubt = b - self._lost - TURN * turned, TURN_SD * turned
        changed = off * off / (self._bias_variance(t) + doubt * doubt)
        return changed if changed < alone else alone

    def _by_force(self, v: float, lift: float) -> float:
        """Return x by the airspeed of the force, for a port that leaks must not look like slow flight."""
        forced = v - self._wandering.gust
        forced = forced if forced > LEAST_FLIGHT else LEAST_FLIGHT
        return lift * lift / (forced * forced)

    @property
    def lost(self) -> float:
        """What f_x is off by on average over the last `SLOW`, m/s²: a port that has just failed is hardly in it."""
        return self._lost

    def _wanders(self, v: float, gained: float, lost: float, lift: float, dt: float) -> bool:
        """Whether V has left what the force gave. What f_x is off by is learnt slowly, and not while V is far away.

        A turn, or flight at another speed, turns f_x by c (x − x̄) from where it was learnt. Where c matters too much,
        it is learnt anew.
        """
        wandering, turn = self._wandering, self._by_force(v, lift)
        if not -UNTURNED < turn - self._turn < UNTURNED:
            wandering.forget()
            self._taught = self._taught if self._taught < RELEARNT else RELEARNT
        if dt > 0.0 and (wandering.near or self._taught < LEARNT):
            self._taught += dt
            share = dt / (self._taught if self._taught < SLOW else SLOW)
            self._lost += (lost - self._lost) * share
            self._turn += (turn - self._turn) * share
        away = wandering.add(v, v - self._last, gained - (self._lost + TURN * (turn - self._turn)) * dt, dt)
        self._last = v
        return away

    def pause(self) -> None:
        """Let the tests begin anew with the next reading."""
        self._t = -inf

    def jump(self, t: float, variance: float) -> None:
        """Be told by which variance, (m/s²)², the push has widened b at `t`, s; b forgets that in its own time."""
        self._jumped, self._jumped_at = self._bias_variance(t) - self._bias_sd**2 + variance, t

    def open_bias(self, t: float, variance: float) -> None:
        """Be told at `t`, s, that b may have moved by that variance, (m/s²)²."""
        self._opened_by = self._bias_variance(t), t
        self.jump(t, variance)
        self.port.frozen.open_bias(variance)
        self._taught = min(self._taught, RELEARNT)
        self._wandering.forget()
        self._opened = t + REOPENED

    def close_bias(self, moved: float) -> None:
        """Be told that b has not taken up the last step, but only moved by so much, (m/s²)²."""
        variance, at = self._opened_by
        self._jumped, self._jumped_at = variance - self._bias_sd**2 + moved, at

    def _bias_variance(self, t: float) -> float:
        """What b may be off by at `t`, s, (m/s²)²."""
        since = t - self._jumped_at
        left = self._jumped * exp(-2.0 * since / self._bias_time) if since > 0.0 else self._jumped
        return self._bias_sd * self._bias_sd + left

    def flag(self, kind: str, energy: EnergyFilter, now: tuple[float, float], density: float, gust: float) -> None:
        """Flag the port, and put the filter to where it would be without what it has taken of it since it was wrong.

        Parameters
        ----------
        kind : str
        energy : EnergyFilter
        now : tuple of float
            The instant at which it stands, s, and ∫ f_x dt, m/s.
        density, gust : float
            ρ, kg/m³, and the gusts' density, m/s².
        """
        self.coasts = kind not in MUTE
        if not self.coasts:  # the filter goes on as it is
            self.port.back.flag(now[0], kind=kind)
            self.faulty, self._astray, self._silent, self.undecided = True, False, False, False
            return
        test = self.port.frozen
        trusted, (t, gained) = self._trusted, now
        slowly = t - trusted[0] > SLOWLY or self._was_still(trusted, density)
        self.undecided = kind == "frozen" and not self._declared and slowly
        if kind != "frozen" and kind not in UNTAKEN:  # it had been wrong for a while before the flag
            before = self._before[0]
            if kind == "leak":
                before = self._rough if self._smooth.evidence > LEVEL else self._sound
            if before is not NOTHING:
                trusted = before
        elif kind == "frozen" and not self._declared:
            trusted = self._earlier(trusted)
        if kind in UNTAKEN or trusted is NOTHING:  # the filter has taken nothing of it
            trusted = t, gained, energy.v, energy.vv, energy.p, test.lost, test.lost_variance
        then, u, v, vv, p, self._bias, bb = trusted
        speed = max(v, 1.0)
        since, slope = t - then, density * speed
        if kind == "frozen":
            self.port.back.flag(t, test.held, test.held_variance)
        else:
            self.port.back.flag(t, kind=kind)
        self.faulty, self._astray = True, kind in ASTRAY
        self._silent = self._declared and kind in GUSTLESS
        self._smooth.flag(t)
        v = v + gained - u - self._bias * since + (energy.p - p) / slope
        bb = min(bb, self._bias_sd * self._bias_sd)
        vv = vv + gust * speed * since + bb * since * since + UNSEEN * UNSEEN + energy.pp / (slope * slope)
        if kind == "leak":  # a gust that was there before cannot be told from its beginning
            vv += self._gust_variance
        energy.coast_from(v, vv, self._bias, bb, since)
        self._p = energy.p

    def _was_still(self, trusted: Kept, density: float) -> bool:
        """Whether the total pressure hardly moved before an instant: that it stands still then is no news."""
        before = self._before[0]
        since = trusted[0] - before[0]
        moved = trusted[4] - before[4] + density * trusted[2] * (trusted[2] - before[2])
        return 0.0 < since < inf and -MOVES * since < moved < MOVES * since

    def _earlier(self, trusted: Kept) -> Kept:
        """What is kept of `EARLIER` before an instant: in still air the force tells V well enough from there on."""
        if self._opened - REOPENED > trusted[0] - EARLIER:  # b was another then
            return trusted
        return next((kept for kept in reversed(self._before) if -inf < kept[0] <= trusted[0] - EARLIER), trusted)

    def flag_in_stroke(
        self, energy: EnergyFilter, t: float, held: tuple[float, float], speed: tuple[float, float]
    ) -> None:
        """Flag a port that has not risen in the stroke.

        `held` and `speed` are the pressure in it (`Readmission.flag`), Pa, and V by the force, m/s, each with its
        variance. Where gusts are declared, it has to show them.
        """
        self.port.back.flag(t, *held)
        self.faulty = self._astray = self.coasts = True
        self._silent = self._declared
        self._smooth.flag(t)
        self.undecided, self._bias = False, 0.0
        energy.coast_from(speed[0], speed[1], 0.0, self._bias_sd * self._bias_sd, 0.0)
        self._p = energy.p

    def carry(self, energy: EnergyFilter, dt: float, gained: float, variance: float, density: float) -> None:
        """While flagged, advance by energy rate; the arguments are those of `EnergyFilter.predict`."""
        self._p = energy.coast(dt, gained, variance, density, self._bias, self._p)

    def coast(self, reading: float, pressure: float, difference: float, spread: float, t: float) -> bool:
        """While flagged, take a reading as `Readmission.hear` does; True if the flag falls."""
        lives = not self._silent or self._smooth.lives(t, pressure)
        if self._astray:
            spread = min(spread, AGREE_SD * AGREE_SD)
        if not lives:
            difference = inf  # a port that shows no gusts agrees with nothing
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
    row, alike : float
        As of `TotalWatch`.
    offset_sd : float
        Offset of f_z, m/s².

    Attributes
    ----------
    faulty, shut : bool
        Whether the port is flagged, and whether that is because it has been shut.
    since : float
        When it was flagged, s.
    """

    __slots__ = ("_back", "_offset_sd", "_t", "_test", "_variance", "faulty", "shut", "since")

    def __init__(
        self,
        variance: float,
        walk: float,
        row: float = LEAST,
        alike: float = 0.0,
        offset_sd: float = 0.0,
    ) -> None:
        self._variance, self._offset_sd = variance * apart(alike), offset_sd
        self._back = Readmission(variance, walk, row)
        self._test, self._t = ClimbTest(variance, 0.0, offset_sd), -inf
        self.faulty, self.shut, self.since = False, False, inf

    @property
    def suspect(self) -> bool:
        """Whether this port is to blame where the total pressure seems wrong."""
        return self._test.evidence > SUSPECT

    @property
    def repeating(self) -> bool:
        """Whether its readings may be stuck. It is too early then to blame the total port."""
        return self._back.repeating

    @property
    def doubtful(self) -> bool:
        """Whether it may stand still. In still air it is too early then to blame the total port."""
        return self._test.evidence > DOUBTFUL

    def take(self, t: float, reading: float, lift: float, air: tuple[float, float], raw: float) -> str:
        """Take a reading; return what is wrong with the port, "frozen" or "stuck"; "" for nothing.

        Parameters
        ----------
        t : float
            Its instant, s.
        reading : float
            Pa.
        lift : float
            Mean of −f_z since the last one, m/s²; NaN where it is not known, and the port is not tested.
        air : tuple of float
            Its density, kg/m³, and the airspeed, m/s.
        raw : float
            The reading as it came, Pa.
        """
        if self._back.repeats(raw):
            return "stuck"
        if not -inf < lift < inf:
            return ""
        dt = t - self._t
        if dt > GAP:
            self._test, dt = ClimbTest(self._variance, reading, self._offset_sd), 0.0
        self._t = t
        evidence = self._test.add(reading, dt, lift, air[0] * GRAVITY, air[1])
        return "frozen" if evidence > SHUT else ""

    def flag(self, kind: str, energy: EnergyFilter, t: float, density: float, bias: float) -> None:
        """Flag the port at `t`, s; if it was shut, put the filter to where the climb before that would have led."""
        test = self._test
        self.faulty, self.shut, self.since = True, kind in SHUT_IN, t
        if kind != "frozen":
            self._back.flag(t, kind=kind)
            return
        self._back.flag(t, nan, self._variance)  # as it is read from now on: `held` is freed of the position error
        weight, v = density * GRAVITY, max(energy.v, 1.0)
        off = weight * CLIMB_SD
        p = test.held - weight * test.climb_then * test.since
        energy.leave_static(
            static=(p, (off * test.since) ** 2 + test.held_variance),
            slope=(GRAVITY * test.climb_then / v, (GRAVITY * CLIMB_SD / v) ** 2),
            bias=(bias, BIAS_SD * BIAS_SD),
            tied=-off * test.since * GRAVITY * CLIMB_SD / v,
            density=density,
            unseen=UNSEEN,
        )

    def flag_at_rest(
        self, energy: EnergyFilter, t: float, held: tuple[float, float], risen: float, density: float
    ) -> None:
        """Flag a port that was shut before the launch, and the height that it hides, m."""
        self.faulty, self.shut, self.since = True, True, t
        self._back.flag(t, *held)
        hidden = density * GRAVITY * risen
        energy.leave_static(
            static=(held[0] - hidden, hidden * hidden),
            slope=(energy.s, 1.0),
            bias=(0.0, BIAS_SD * BIAS_SD),
            tied=0.0,
            density=density,
            unseen=UNSEEN,
        )

    def coast(self, t: float, reading: float, pressure: float, difference: float, spread: float) -> bool:
        """While flagged, take a reading as `Readmission.hear` does; True if the flag falls."""
        if not self._back.hear(t, reading, pressure, difference, spread):
            return False
        self.faulty, self.shut, self._t = False, False, -inf
        return True
