"""Airspeed from two pressures and the accelerometer, from the rail to cruise.

    waiting --launch recognised--> replay of the last 0.3 s --> flying        (rearmed: back to waiting)

Waiting, the pressures are filtered by themselves (`jump_adaptive`) and the root is taken last; the tare of the pair and
the mean of f_x at rest are taken, and the last readings of both kinds kept. A recognised launch comes tens of
milliseconds late, 2.9 m/s at 10 g and 30 ms; so the energy-rate filter (`energy`) starts before it, from the kept
readings, with V = 0 and the wind's standard deviation.

Flying, the filter stands at the middle of the last total pressure's conversion, less the lag of its tube: that is the
instant which the reading is of. What is told is predicted from there to the time of the reading. A static pressure is
of another instant, some milliseconds away; over those it moves by ρ V s, and what moves it beside is far below its
noise, so it is compared across. The specific force between is in `speed_gained`, so that a reading of it costs a sum.

At first V is as likely below 0 as above, and a total pressure, even in V, would split what is known in two. It is left
out until the push has brought V to 3 σ_V; what it would have said of the wind, later ones say better.

The specific force bends the membranes: of that pressure error the known part is taken off, and what is not known of its
coefficient is a state, until the flight is steady. The scale error of the accelerometer, σ_k, is a bias that comes and
goes with the push: b gains the variance σ_k² |Δ(f²)| when the mean specific force f changes.

Airspeed is valid from V = 8 σ_V on, which is 2 V* of the pressures' law (`paper`) and holds for a coasting filter, too.

A filter that has left all bounds has diverged: from there on the pressures alone are filtered, as before the launch.
After a step of a clock (`uavsim.onboard.stamps`) the filter begins anew in flight, V by the pressures, as soon as the
clocks of head and accelerometer agree.
"""

from collections import deque
from dataclasses import replace
from math import expm1, inf, log1p, nan, sqrt

from uavsim import airdata
from uavsim.airdata import GAS_CONSTANT_DRY_AIR
from uavsim.onboard.airspeed.energy import GATE, SEVEN_R, EnergyFilter
from uavsim.onboard.airspeed.gust import gust_density
from uavsim.onboard.airspeed.interface import Estimate, Feel, NoiseModel, TareWindow
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.onboard.airspeed.one_pass import OnePassFilter
from uavsim.onboard.airspeed.push import Push
from uavsim.onboard.airspeed.readmission import longest_row
from uavsim.onboard.airspeed.rest_force import RestForce
from uavsim.onboard.airspeed.rest_wind import turning, wind_at_rest
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.airspeed.speed_gained import SpeedGained
from uavsim.onboard.airspeed.spikes import JUMPED, Spikes
from uavsim.onboard.airspeed.watch import StaticWatch, TotalWatch
from uavsim.onboard.plausible import (
    FASTEST,
    LEAST_PRESSURE,
    LEAST_TEMPERATURE,
    MOST_FLIGHT_FORCE,
    MOST_FORCE,
    MOST_PRESSURE,
    MOST_TEMPERATURE,
)
from uavsim.onboard.stamps import LATEST, Conversions, Stamps, jump

ROWS = 256  # readings of the head that are kept; 0.3 s of them are replayed
TWO_SEVENTHS = 2.0 / 7.0  # (γ − 1)/γ
VALID = 8.0  # σ_V
ONE_SIDED = 9.0  # V²/σ_V², below which a total pressure cannot tell a headwind from a tailwind
PATIENCE = 1.0  # s after the recognition; then the push was none, and V is what the pressures say
STEADY = 2.0  # s after the recognition, from which on the ports are watched and k is known
BEYOND = 450.0  # m/s, far past Mach 1: a filter that is there has diverged
THINNEST, THICKEST = 1e3, 2e5  # Pa, of the filter's static pressure, alike
SUDDEN, SUDDEN_SD = 100.0, 15.0  # Pa, and standard deviations: how far a pressure goes at once, and beside that
STEEP, STROKE = 3e3, 5e4  # Pa/s: 60 m/s and 40 m/s², or a dive at 250 m/s; and in the stroke 80 m/s and 500 m/s²
MOST_NEWS = 64  # events that wait for somebody to take them out; then the oldest go
FARTHEST = 3.0  # standard deviations of an offset, by which a reading of a plausible force may be beyond its bound
COASTED = 2.0  # m/s, standard deviation up to which an airspeed without its port is valid
PERSISTENT = 5  # static pressures out of the gate one after another, then they are believed
MODEL = 0.1  # Pa, what the model of a pressure is off by, whatever its sensor: 0.1 ms of the stroke's rise
GRAVITY = 9.80665  # m/s², ISO 80000-3
OLDEST = 0.05  # s; a reading that is further behind the filter is not taken
ALONE = 0.02  # s; a static pressure so far ahead of the filter comes without a total pressure: it goes on by itself
SLOWEST = 1.0  # m/s; below it the gust's correlation time is that of this airspeed
ANYWHERE, AROUND = 3e4, 1e3  # Pa; what the static pressure may be off by before one has been read, and after

Row = tuple[float, float, float, float, float, float]


class AidedFilter:
    """The aided estimator, stepped with each reading of the head and of the accelerometer.

    Parameters
    ----------
    settings : EstimatorSettings
        Its tuning.
    noise : NoiseModel
        What it believes of the sensors.
    tare_window : tuple of float, optional
        As of `PaperFilter`.

    Attributes
    ----------
    flying : bool
        Whether the energy-rate filter runs.
    energy : EnergyFilter
        It; of no meaning before.
    time : float
        The instant that it stands at, s.
    watch, static_watch : TotalWatch, StaticWatch
        Over the two ports: one that is flagged is not taken; the airspeed is valid while it is well known all the same.
    news : list of tuple
        What was flagged and taken back: time, s, event, channel and kind; the flight computer takes them out.
    """

    aided = True
    core: type[EnergyFilter] = OnePassFilter
    __slots__ = (
        "_apart", "_density", "_either", "_fastest", "_flight_force", "_folded", "_force", "_gained", "_gas", "_ground",
        "_gust", "_gust_falls", "_heat", "_lift", "_longest", "_measured", "_misses", "_noise", "_on_rail", "_patience",
        "_push", "_push_variance", "_raw_scale", "_read", "_rest", "_rows", "_scale_variance", "_settings", "_settled",
        "_stamps", "_static_age", "_static_ends", "_static_seen", "_static_spikes", "_static_variance",
        "_steady_from", "_steps", "_sudden", "_t", "_tare", "_tare_end", "_temperature", "_temperature_share", "_torn",
        "_total_age", "_total_ends", "_total_seen", "_total_spikes", "_total_variance", "_turning", "_u",
        "_usual", "_w", "_waiting", "_wind", "energy", "flying", "news", "static_watch", "time", "watch",
    )  # fmt: skip

    def __init__(self, settings: EstimatorSettings, noise: NoiseModel, tare_window: TareWindow | None = None) -> None:
        settings = replace(settings, aided=with_offset(settings.aided, noise.accelerometer_offset_sd))
        self._settings, self._noise = settings, noise
        self._waiting = JumpAdaptive(settings, noise, tare_window)
        self._tare_end = -inf if tare_window is None else tare_window[1]
        self._gained = SpeedGained(noise.accelerometer_sd, noise.accelerometer_rate, lag=noise.accelerometer_lag)
        force = settings.aided.flight_force
        self._flight_force = MOST_FLIGHT_FORCE if force is None else force
        self._flight_force += FARTHEST * noise.accelerometer_offset_sd
        self._rest = RestForce(noise.accelerometer_sd, self._flight_force)
        self._rows: deque[Row] = deque(maxlen=ROWS)
        self._total_age = 0.5 * noise.total_window + noise.total_lag
        self._static_age = 0.5 * noise.static_window + noise.static_lag
        self._total_variance = max(noise.total_sd, MODEL) ** 2
        self._static_variance = max(noise.static_sd, MODEL) ** 2
        self._scale_variance = noise.accelerometer_scale_sd**2
        aided = settings.aided
        self._gust, self._ground = gust_density(aided, 0.0), nan
        self._gust_falls = aided.gust_height > 0.0 and aided.gust_sd > 0.0
        self._push, self._force = Push(noise, self._gained, self._rest), 0.0
        self._on_rail = aided.on_rail
        self._temperature_share = 0.5 * noise.temperature_sd
        self._raw_scale = self._waiting.scale
        self._fastest = FASTEST if settings.fastest is None else settings.fastest
        self._longest = jump(noise.head_rate)
        self._stamps = Stamps(self._longest)
        self._total_ends, self._static_ends = Conversions(self._longest), Conversions(self._longest)
        sd = sqrt(max(self._total_variance, self._static_variance))
        self._sudden = max(SUDDEN, SUDDEN_SD * sd)
        self._total_spikes, self._static_spikes = Spikes(), Spikes()
        self._torn = self._either = False
        self.flying = self._apart = False
        self._steps, self._read = 0, -inf
        self.time = self._t = -inf
        self._temperature = self._density = self._gas = self._heat = nan
        self._tare = 0.0
        self._settled, self._patience, self._misses, self._push_variance = False, inf, 0, 0.0
        self._steady_from = inf
        self._static_seen: tuple[float, float, float] | None = None  # Pa, its instant, s, mean of −f_z since, m/s²
        self._total_seen: tuple[float, float] | None = None  # tared, Pa, and NIS
        self._usual = [0, 0]
        self._begin_watch()
        self.news: list[tuple[float, str, str, str]] = []
        self._u = self._w = 0.0
        self.energy = self._begin(-inf)

    # -- readings ----------------------------------------------------------------------------------------------------

    @property
    def accelerometer(self) -> Feel:
        """What takes a reading of specific force; see `Estimator`. Flying, that is the integral, without a detour."""
        return self._gained.add if self.flying else self._wait

    def _wait(self, t: float, fx: float, fy: float, fz: float) -> None:
        self._gained.add(t, fx, fy, fz)
        if not self.flying and self._gained.newest == t:  # it has been taken
            self._rest.add(t, fx)

    def step(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head; as `PaperFilter.step`, the pressures being the filter's own at `t`."""
        if not 0.0 < t - self._read <= self._longest and not self._admit(t):
            return None
        self._read = t
        if self._steps != self._gained.steps:
            self._steps = self._gained.steps
            self._lose_time(t)
        if self._apart and -self._longest <= t - self._gained.newest <= self._longest:
            self._begin_in_flight(t)
        if self.flying:
            try:
                estimate = self._fly(t, p_total, p_static, temperature, t_total, t_static)
                if estimate is None or self._sound(estimate):
                    return estimate
            except (ArithmeticError, ValueError):  # Python's for what is inf or NaN on the aircraft
                pass
            self._fall_back(t, "diverged")
        estimate = self._waiting.step(t, p_total, p_static, temperature, t_total, t_static)
        if estimate is not None:
            self._rows.append((t, p_total, p_static, temperature, t_total, t_static))
        return estimate

    def _sound(self, estimate: Estimate) -> bool:
        """Whether the filter is within all bounds, which NaN is not, and no variance of it is below 0."""
        energy = self.energy
        if estimate[7] < 0.0 or estimate[8] < 0.0:
            return False
        return -BEYOND < energy.v < BEYOND and THINNEST < energy.p < THICKEST and energy.vv > 0.0 and energy.pp > 0.0

    def _fall_back(self, t: float, kind: str) -> None:
        """From here on go by the pressures alone, both ports believed: the force is of no flight or another time."""
        self.flying = False
        self._total_seen = self._static_seen = None
        self._waiting.resume(self._total_spikes.last, self._static_spikes.last, self._sudden)
        self._tell_of(t, "airspeed_fault", "both", kind)
        for watch, channel in ((self.watch, "total"), (self.static_watch, "static")):
            if watch.faulty:
                self._tell_of(t, "airspeed_recovered", channel)

    def _tell_of(self, t: float, event: str, channel: str, kind: str = "") -> None:
        """Put something into the news."""
        self.news.append((t, event, channel, kind))
        if len(self.news) > MOST_NEWS:
            del self.news[0]

    # -- clocks ------------------------------------------------------------------------------------------------------

    def _admit(self, t: float) -> bool:
        """Whether a reading is taken whose stamp does not follow the last."""
        if not self._stamps.admit(t, self._read):
            return False
        if self._read > -inf:
            self._lose_time(t)
            self._rows.clear()
        self._total_ends.forget()
        self._static_ends.forget()
        return True

    def _lose_time(self, t: float) -> None:
        """After a step of a clock in flight the integral of f_x and the filter's time mean nothing."""
        if self.flying:
            self._apart = True
            self._fall_back(t, "clock")

    def _begin_in_flight(self, t: float) -> None:
        """Begin anew at `t`, s: V by the next total pressure, both ports believed, climb and bias not known."""
        aided, before = self._settings.aided, self.energy.p
        core = self._core(
            speed_sd=self._settings.wind_sd,
            rest=(0.0, 0.0),
            static=(before if THINNEST < before < THICKEST else airdata.STANDARD_PRESSURE, ANYWHERE),
            difference_sd=sqrt(self._waiting.tare()[1]),
        )
        core.bs, core.ss = 0.0, 0.5 * aided.slope_rate**2 * aided.slope_time
        self.energy, self._wind, self._folded = core, 0.0, (inf, inf, 0.0)
        self._start(t - OLDEST, -inf, t + STEADY)
        self._apart = False
        self._tell_of(t, "airspeed_recovered", "both")

    def _start(self, start: float, patience: float, steady_from: float) -> None:
        """Fly from an instant on, s; see `PATIENCE` and `STEADY`."""
        self.flying = True
        self.time = self._t = start
        self._u, self._w = self._gained.at(start)
        self._push.forget()
        self._settled, self._patience, self._push_variance = False, patience, 0.0
        self._steady_from = steady_from
        self._misses, self._torn, self._either = 0, False, False
        self._total_spikes.forget()
        self._static_spikes.forget()
        self._begin_watch()
        self._total_ends.forget()
        self._static_ends.forget()

    def launched(self, t: float) -> None:
        """Start the energy-rate filter before a launch that has been recognised at `t`, and bring it up to date."""
        if self.flying or not -LATEST < t < LATEST:
            return
        self._gained.bound(MOST_FORCE)
        start = max(t - self._settings.aided.replay, self._gained.oldest, self._tare_end)
        start = min(start, t)
        self.energy = self._begin(start)
        self._apart = False
        self._start(start, t + PATIENCE, t + STEADY)
        try:
            for row in self._rows:
                if row[4] - self._total_age > start or row[5] - self._static_age > start:
                    self._fly(*row)
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(t, "diverged")
        self._rows.clear()

    def _begin_watch(self) -> None:
        """Look at how the sensors repeat themselves on the rail, and begin to watch their ports."""
        if self._rows:
            self._usual = [longest_row(row[i] for row in self._rows) for i in (1, 2)]
        usual, noise = self._usual, self._noise
        off, lift_off = noise.accelerometer_offset_sd, noise.lift_offset_sd
        white = noise.accelerometer_sd**2 / noise.accelerometer_rate
        self.watch = TotalWatch(self._settings.aided, self._total_variance, noise.walk, usual[0], off, white)
        self.static_watch = StaticWatch(self._static_variance, noise.walk, usual[1], lift_off)
        self._lift = GRAVITY
        self._static_seen = self._total_seen = None

    def unfolding(self, t: float) -> None:
        """For a while trust the integral of f_x less."""
        aided = self._settings.aided
        self._gained.bound(self._flight_force)
        self._folded = (t, t + aided.unfolding_time, aided.unfolding_rate**2)

    def rearmed(self, t: float) -> None:
        """Go back to waiting: the launch was none."""
        self.flying = self._apart = False
        self._waiting.forget_time()
        self._rest.forget()
        self._gained.bound(MOST_FORCE)

    def _begin(self, start: float) -> EnergyFilter:
        static = self._waiting.static.value
        known = LEAST_PRESSURE <= static <= MOST_PRESSURE
        self._tare, tare_variance = self._waiting.tare()
        warm = self._waiting.temperature
        self._measured = warm > 0.0
        self._warm(warm if self._measured else airdata.STANDARD_TEMPERATURE)
        rest, rest_sd = self._rest.result(start)
        self._folded = (inf, inf, 0.0)
        wind_sd = self._look_at_wind(start, tare_variance, static / self._gas)
        core = self._core(
            speed_sd=wind_sd,
            rest=(rest, rest_sd),
            static=(static, AROUND) if known else (airdata.STANDARD_PRESSURE, ANYWHERE),
            difference_sd=sqrt(tare_variance),
        )
        core.v, self._ground = self._wind, core.p
        return core

    def _core(
        self, speed_sd: float, rest: tuple[float, float], static: tuple[float, float], difference_sd: float
    ) -> EnergyFilter:
        """Make the filter; what f_x reads at rest and the static pressure each with its standard deviation."""
        aided, noise = self._settings.aided, self._noise
        return self.core(
            speed_sd=speed_sd,
            rest_force=rest[0],
            rest_sd=rest[1],
            bias_sd=aided.bias_sd,
            bias_time=aided.bias_time,
            slope_rate=aided.slope_rate,
            slope_time=aided.slope_time,
            static=static[0],
            static_sd=static[1],
            static_walk=aided.static_walk,
            difference_sd=difference_sd,
            difference_walk=noise.walk,
            acceleration_sd=noise.acceleration_sd,
        )

    def _look_at_wind(self, start: float, tare_variance: float, density: float) -> float:
        """Find the airspeed on the rail by the pressures there; return its standard deviation, m/s."""
        each = self._total_variance + self._static_variance
        self._wind, sd = 0.0, inf
        if self._tare_end > -inf:
            self._wind, sd = wind_at_rest(
                self._rows,
                start=self._tare_end,
                end=start,
                tare=self._tare,
                variance=tare_variance,
                each=each,
                density=density,
            )
        self._turning = turning(self._wind, each, density)
        return min(sd, self._settings.wind_sd)

    # -- flight ------------------------------------------------------------------------------------------------------

    def _fly(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        if not t > self._t:
            return None
        if self._total_seen is not None or self._static_seen is not None:
            self._judge()
        before, self._t = self._t, t
        energy = self.energy
        if LEAST_TEMPERATURE <= temperature <= MOST_TEMPERATURE:
            if temperature != self._temperature:
                self._warm(temperature)
            self._measured = True
        else:
            temperature = nan
        self._density = energy.p / self._gas
        if self._gust_falls:
            self._gust = gust_density(self._settings.aided, (self._ground - energy.p) / (GRAVITY * self._density))
        reach = self._sudden + (STEEP if self.time > self._steady_from else STROKE) * (t - before)
        total, static = self._total_spikes.take(p_total, reach), self._static_spikes.take(p_static, reach)
        if JUMPED in (total, static):
            self._jump(total, static)
        end_total, end_static = self._total_ends.new(t_total, t), self._static_ends.new(t_static, t)
        new_total, new_static = end_total == end_total and total, end_static == end_static and static
        nis_total, nis_static = self._take(p_total, p_static, end_total, end_static, new_total > 0, new_static > 0)
        raw = nan
        if total and static and temperature > 0.0:  # as `airdata.compressible_airspeed`
            excess = (p_total - self._tare - p_static) / p_static
            raw = sqrt(self._heat * expm1(TWO_SEVENTHS * log1p(excess))) if excess > 0.0 else 0.0
        return self._tell(t, raw, nis_total, nis_static)

    def _jump(self, total: int, static: int) -> None:
        """A pressure has jumped: it is taken for what it is, and once the ports are watched its port is flagged."""
        self._either = True
        if not self.time > self._steady_from:
            return
        if static == JUMPED and not self.static_watch.faulty:
            self._flag_static("jump")
        if total == JUMPED and not (self.watch.faulty or self.static_watch.faulty):
            self.watch.flag("jump", self.energy, self._density, self._gust)
            self._tell_of(self._t, "airspeed_fault", "total", "jump")

    def _take(
        self, p_total: float, p_static: float, t_total: float, t_static: float, new_total: bool, new_static: bool
    ) -> tuple[float, float]:
        """Take what is new of a reading of the head; return the normalised innovations squared."""
        nis_total = nis_static = nan
        to, at = t_total - self._total_age, t_static - self._static_age
        if new_total and new_static and self._steady(to, at):
            nis_total, nis_static = self._take_both(p_total, p_static, t_total, to, at)
        else:
            if new_total:
                self._advance(to)
            elif new_static and at - self.time > ALONE:
                self._advance(at)
            if new_static:
                nis_static = self._take_static(p_static, at)
            if new_total:
                nis_total = self._take_total(p_total, t_total)
        return nis_total, nis_static

    def _warm(self, temperature: float) -> None:
        """Take a temperature of the air."""
        self._temperature, self._gas = temperature, GAS_CONSTANT_DRY_AIR * temperature
        self._heat = SEVEN_R * temperature * self._raw_scale * self._raw_scale

    def _steady(self, to: float, at: float) -> bool:
        """Whether both ports are sound, and both readings of after the filter's time and of about the same instant."""
        return (
            self.time > self._steady_from
            and to > self.time
            and -OLDEST < to - at < OLDEST
            and self._settled
            and not self.watch.faulty
            and not self.static_watch.faulty
        )

    def _take_both(self, p_total: float, p_static: float, t_total: float, to: float, at: float) -> tuple[float, float]:
        """What `_advance`, `_take_static` and `_take_total` do, at once."""
        energy, density, dt = self.energy, self._density, to - self.time
        if energy.kk > 0.0:
            self._push_variance = energy.know_push()
        gained, variance = self._go(to, dt)
        pushed = self._pushed(t_total)
        tared = p_total - self._tare - self._noise.acceleration * pushed
        nis_static, nis_total = energy.fly(
            dt,
            gained,
            variance,
            density,
            p_static,
            self._static_variance,
            density * energy.v * (to - at),
            tared - pushed * energy.k,
            self._total_variance + pushed * pushed * self._push_variance,
            self._heat,
        )
        self._misses = 0 if nis_static <= GATE else self._misses + 1
        self._static_seen = p_static, at, self._gained.lift()
        self._total_seen = tared, nis_total
        return nis_total, nis_static

    def _advance(self, to: float) -> None:
        """Predict to a later time; an earlier one leaves the filter where it is."""
        dt = to - self.time
        if not dt > 0.0:
            return
        gained, variance = self._go(to, dt)
        if self.watch.faulty:
            self.watch.carry(self.energy, dt, gained, variance, self._density)
        else:
            self.energy.predict(dt, gained, variance, self._density, self._force > self._on_rail)

    def _go(self, to: float, dt: float) -> tuple[float, float]:
        """Go on to a later time; return ∫ f_x dt, m/s, and the variance that gust and accelerometer add to V's."""
        v = self.energy.v
        u, w = self._gained.at(to)
        gained = u - self._u
        self._force = gained / dt - self._rest.mean
        variance = self._gust * (v if v > SLOWEST else SLOWEST) * dt
        if w > self._w:  # else readings have come late, and that they might be lost has been counted
            variance = variance + w - self._w
            if self._gained.torn(w - self._w, dt):
                self._torn = True
        begin, end, rate = self._folded
        if to > begin and self.time < end:
            variance += rate * (min(to, end) - max(self.time, begin))
        self.time, self._u, self._w = to, u, w
        return gained, variance

    def _take_static(self, reading: float, at: float) -> float:
        energy = self.energy
        ahead = self.time - at
        if not -OLDEST < ahead < OLDEST:
            return nan
        if self.static_watch.faulty:
            difference = reading - energy.p - self._density * energy.v * ahead * energy.s
            spread = energy.pp + self._static_variance
            if self.static_watch.coast(at, reading, difference, spread):
                energy.pp += difference * difference
                self._tell_of(self._t, "airspeed_recovered", "static")
            return nan
        nis = energy.static(reading, self._static_variance, self._density * energy.v * ahead)
        self._misses = 0 if energy.taken else self._misses + 1
        if self.time > self._steady_from:
            self._static_seen = reading, at, self._gained.lift()
        elif self._misses >= PERSISTENT:  # no spike, and too early for a fault: it is rather the filter that is wrong
            energy.pp += energy.innovation * energy.innovation
            energy.static(reading, self._static_variance, 0.0)
            self._misses = 0
        return nis

    def _flag_static(self, kind: str) -> None:
        self.static_watch.flag(kind, self.energy, self._density, self.watch.port.frozen.lost)
        self._misses = 0
        self.watch.port.restart()
        self._tell_of(self._t, "airspeed_fault", "static", kind)

    def _take_total(self, reading: float, end: float) -> float:
        energy = self.energy
        behind = self.time - (end - self._total_age)
        if behind > OLDEST:
            return nan
        if not self._settled and not self._settle(reading):
            return nan
        pushed = self._pushed(end)
        variance = self._total_variance + pushed * pushed * self._push_variance
        if behind > 0.0:  # an older reading than the filter has taken: as if V had not moved by more than its gust
            slope = self._density * energy.v
            reading += slope * (self._u - self._gained.at(self.time - behind)[0] - behind * (energy.b + energy.s))
            variance += slope * slope * self._gust * abs(energy.v) * behind
        tared = reading - self._tare - self._noise.acceleration * pushed
        if self.watch.faulty:
            self._coast(end, reading, tared, variance)
            return nan
        nis = energy.total(tared, variance, pushed, self._heat)
        if not energy.taken and self.time < self._steady_from:  # so early it is rather the filter that is wrong
            slope = self._density * (energy.v if energy.v > SLOWEST else SLOWEST)
            energy.vv += (energy.innovation / slope) ** 2
        if self._either and energy.taken and energy.v * energy.v > ONE_SIDED * energy.vv:
            self._either = False
            if energy.v < 0.0:  # of an airspeed and its opposite the pressure is the same
                energy.restart(-energy.v, energy.vv)
        if self.time > self._steady_from and not self.static_watch.faulty:
            self._total_seen = tared, nis
        return nis

    def tidy(self) -> None:
        """Watch the ports by what was read last; the filter still stands where it stood then."""
        try:
            self._judge()
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(self._t, "diverged")

    def _judge(self) -> None:
        """Judge the ports; see `tidy`."""
        if self._torn:  # nobody knows what the force has made of the pressures meanwhile
            self._torn = False
            self.watch.pause()
        if self._static_seen is not None:
            reading, at, lift = self._static_seen
            self._static_seen = None
            if lift == lift:
                self._lift = lift
            kind = self.static_watch.take(at, reading, lift, self._density)
            if kind or self._misses >= PERSISTENT:
                self._flag_static(kind or "jump")
        if self._total_seen is not None:
            tared, nis = self._total_seen
            self._total_seen = None
            if self.static_watch.faulty:
                return
            kind = self.watch.take(self.energy, self.time, self._u, self._lift, tared, nis, self._density, self._gust)
            if kind:
                self._flag_total(kind)

    def _flag_total(self, kind: str) -> None:
        """Blame the port for what its readings show, or the other: without it the total pressure does not fit."""
        if kind != "stuck" and self.static_watch.suspect:
            self._flag_static("frozen")
        elif kind == "unfit" or self.static_watch.repeating:
            return
        elif kind != "frozen" or not (self.static_watch.doubtful and self.watch.port.unsure):
            self.watch.flag(kind, self.energy, self._density, self._gust)
            self._tell_of(self._t, "airspeed_fault", "total", kind)

    def _coast(self, end: float, reading: float, tared: float, variance: float) -> None:
        """Compare a flagged port with the coasting filter; take it back when they have agreed for long enough."""
        energy = self.energy
        excess = max(0.0, (tared - energy.p) / energy.p)
        speed = sqrt(self._heat * expm1(TWO_SEVENTHS * log1p(excess)))
        slope = self._density * (speed if speed > SLOWEST else SLOWEST)
        difference = speed - energy.v
        spread = energy.vv + (2.0 * variance + energy.pp) / (slope * slope)
        if self.watch.coast(reading, tared, difference, spread, end):
            energy.vv += difference * difference
            self._tell_of(self._t, "airspeed_recovered", "total")

    def _settle(self, reading: float) -> bool:
        """Whether the push has brought V far enough from 0 for a total pressure; if it never does, take V from that."""
        energy = self.energy
        if energy.v * abs(energy.v) < ONE_SIDED * energy.vv:
            if self.time < self._patience:
                return False
            excess = max(0.0, (reading - self._tare - energy.p) / energy.p)
            speed = sqrt(self._heat * expm1(TWO_SEVENTHS * log1p(excess)))
            energy.restart(speed, max(energy.vv, speed * speed / ONE_SIDED))
        elif self._wind > 0.0:
            if energy.v < self._turning and self.time < self._patience:
                return False
            wind, self._wind = self._wind, 0.0
            excess = max(0.0, (reading - self._tare - energy.p) / energy.p)
            speed = sqrt(self._heat * expm1(TWO_SEVENTHS * log1p(excess)))
            if 2.0 * speed < energy.v + abs(energy.v - 2.0 * wind):  # it was a tailwind
                energy.v -= 2.0 * wind
                return False
        self._settled = True
        return True

    def _pushed(self, end: float) -> float:
        """Specific force over the total pressure's conversion that ends then; a change of it widens b."""
        before = self._push.held
        pushed = self._push.over(end, self._force)
        if pushed != before:
            widened = self._scale_variance * abs(pushed * pushed - before * before)
            self.energy.bb += widened
            self.watch.jump(self.time, widened)
        return pushed

    def _tell(self, t: float, raw: float, nis_total: float, nis_static: float) -> Estimate:
        """Predict to the time of the reading and say what is known."""
        energy = self.energy
        dt = t - self.time
        if dt > 0.0:
            u, w = self._gained.at(t)
            if w < self._w:  # noqa: PLR1730 - as in `_go`, and a call of max costs a tenth of a microsecond
                w = self._w
        else:
            dt, u, w = 0.0, self._u, self._w
        gained = u - self._u
        drift = energy.b + energy.s
        speed = energy.v + gained - dt * drift
        variance = energy.vv + dt * (dt * (energy.bb + 2.0 * energy.bs + energy.ss) - 2.0 * (energy.vb + energy.vs))
        variance += self._gust * (energy.v if energy.v > SLOWEST else SLOWEST) * dt + w - self._w
        begin, end, rate = self._folded
        if t > begin and self.time < end:
            variance += rate * (min(t, end) - max(self.time, begin))
        static = energy.p - self._density * energy.v * energy.s * dt
        if speed < 0.0:  # noqa: PLR1730
            speed = 0.0
        share = self._temperature_share * speed / self._temperature
        sd = sqrt(max(variance, 0.0) + share * share)
        y = 1.0 + speed * speed / self._heat
        total = static * y * y * y * sqrt(y)
        valid = (
            VALID * sd <= speed <= self._fastest
            and self._measured
            and (sd < COASTED or not self.watch.faulty)
            and not self.static_watch.faulty  # without it V and the climb are hardly told apart
        )
        return t, speed, sd, raw, total, static, valid, nis_total, nis_static
