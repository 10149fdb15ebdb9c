"""Airspeed from two pressures and the accelerometer, from the rail to cruise.

    waiting --launch recognised--> replay of the last 0.3 s --> flying        (rearmed: back to waiting)

**Waiting.** The pressures are filtered by themselves (`jump_adaptive`), and the root is taken last. Meanwhile the pair
is tared, the mean of f_x at rest is taken (`rest_force`), and the last readings of both kinds are kept.

**Hand-over.** A launch is recognised tens of milliseconds late; at 10 g and 30 ms the airspeed is then 2.9 m/s. So the
energy-rate filter (`energy`) starts before the launch, in the readings that were kept, with V = 0, or with the wind
that was seen on the rail, and the standard deviation of that. `onset` says from when on a total pressure is taken.

**Flying.** The filter stands at the middle of the last total pressure's conversion, less the lag of its tube: that is
the instant of which the reading is. An estimate is predicted from there to the time of the reading. A static pressure
is of another instant, some milliseconds away. In those it moves by ρ V s Δt; what else moves it is far below its noise.
So it is compared across the difference. The integral of the specific force is kept in `speed_gained`, so that a reading
of the accelerometer costs one sum.

**A differential sensor.** Its channel is Δp (`difference`), and the filter's total pressure is read relative to the
static one (`energy_model`). Where it reads Δp (1 + κ) all that it can say is V' = V (1 + κ/2), and V̇' is that by as
much. So the filter's airspeed is V', for which f_x has a scale error of κ/2 more, and σ_κ V/2 goes into what is told.
What the force would say of κ itself in the stroke, a third of its variance at the best, is not used. A static port that
is shut is shut for both sensors. Then Δp and the pressure that is shut in are together the total pressure.

**Push.** The specific force bends the membranes of the pressure sensors. The known part of that error is taken off.
What is not known of its coefficient is the state k until the flight is steady. The scale error of the accelerometer is
a bias that comes and goes with the push: when the mean force f changes, b gains the variance σ² |Δ(f²)|, σ being the
scale error's standard deviation.

**Valid** is an airspeed from 8 σ_V on. That is 2 V* of the pressures' law (`paper`), and it also holds while coasting.
On a rail none is valid before the launch is recognised.

**When the filter ends.** Beyond all bounds it has diverged, and the pressures alone are filtered, as before the launch.
A step of a clock (`uavsim.onboard.stamps`) ends it, too. It then begins anew in flight, with V from the pressures, as
soon as the clocks of head and accelerometer agree.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from math import hypot, inf, nan, sqrt

from uavsim import airdata
from uavsim.onboard.airspeed.air import SLOWEST, Air
from uavsim.onboard.airspeed.difference import Difference, channel_range
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.energy_model import GATE, isentropic, isentropic_speed
from uavsim.onboard.airspeed.first_climb import FirstClimb
from uavsim.onboard.airspeed.flow_angles import FlowAngles
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.interface import NoiseModel, within
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.lift import pulled
from uavsim.onboard.airspeed.membrane_push import MembranePush
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.onboard.airspeed.onset import ONE_SIDED, Onset
from uavsim.onboard.airspeed.paper import TRANSONIC
from uavsim.onboard.airspeed.ports import PERSISTENT, Ports
from uavsim.onboard.airspeed.push_end import PushEnd
from uavsim.onboard.airspeed.rail import RailCheck, pause
from uavsim.onboard.airspeed.rail_wind import AGO, RailWind
from uavsim.onboard.airspeed.rest_force import RestForce
from uavsim.onboard.airspeed.rest_wind import Row, rest_difference
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.airspeed.shock import Shock
from uavsim.onboard.airspeed.speed_gained import SpeedGained
from uavsim.onboard.airspeed.spikes import JUMPED, Spikes
from uavsim.onboard.airspeed.stroke import StrokeTest, most_wind
from uavsim.onboard.airspeed.unfolding import Unfolding
from uavsim.onboard.interface import Estimate, Estimator, Feel, TareWindow
from uavsim.onboard.plausible import (
    FASTEST,
    LEAST_PRESSURE,
    LEAST_TEMPERATURE,
    MOST_FLIGHT_FORCE,
    MOST_FORCE,
    MOST_PRESSURE,
    MOST_TEMPERATURE,
)
from uavsim.onboard.repeats import force_row
from uavsim.onboard.stamps import LATEST, Conversions, Stamps, jump

# -- the hand-over -----------------------------------------------------------------------------------------------------

ROWS = 256  # readings of the head that are kept: those of 0.3 s at up to 850 Hz
# s after the recognition in which a push has to show, three strokes of the catapult; after that V is what the pressures
# say. By hand
PATIENCE = 1.0
# Pa, standard deviation of the static pressure at the start, where none has been read (3 km of height) and where one
# has. By hand: so wide that the first readings in the filter decide
ANYWHERE, AROUND = 3e4, 1e3

# s, and readings of the head, from the start on, by which it is judged whether the aircraft rests on its rail. By hand
AT_FIRST, FIRST_ROWS = 0.05, 5
# m/s, speed over the ground up to which a push has not begun: V may change by what is learned of the wind. By hand: a
# tenth of any launch's
BEGUN = 3.0
IN_PUSH = 30.0  # m/s², mean force at the start of a replay that is a push: three times what any rest has. By hand
STORM = 25.0  # m/s, a wind beyond which nobody launches: 12 Beaufort are 33
UNLIKELY = 5.0  # standard deviations of the pair's difference beside it

# -- steady flight -----------------------------------------------------------------------------------------------------

# s after a filter that begins in flight, from which on the ports are watched and k is taken for known. After a launch
# the force tells (`push_end`): stroke, unfolding and pull-up would seem faults. By hand
STEADY = 2.0

# -- which readings are taken; by hand, and docs/airspeed.md, "What no reading can do", holds the check ----------------

# Pa, and standard deviations of a reading: the greater is how far a pressure may go at once. Beyond it, and the next, a
# reading is a spike and left out (`spikes`)
SUDDEN, SUDDEN_SD = 100.0, 15.0
# Pa/s that are granted beside: ρ V V̇ at 60 m/s and 40 m/s², or a dive at 250 m/s; in the stroke ρ V V̇ at 80 m/s and
# 500 m/s²
STEEP, STROKE = 3e3, 5e4
# share of ρV², beside `SUDDEN`, by which a total pressure may be below the static one, and still tell that the filter
# is wrong; a lower one is of no airspeed. By hand: four times what ports of a UAV are off by
NO_SPEED = 0.2
# standard deviations of the accelerometer's offset, by which a reading of a plausible force may be beyond its bound.
# Beyond it a reading is a missing one. By hand: the usual three
FARTHEST = 3.0
OLDEST = 0.05  # s by which a reading may be behind the filter; an older one is not taken
# s, two periods of a head at 100 Hz. Where a static pressure is so far ahead of the filter, total pressures have ceased
# to come, and the filter goes on without them
ALONE = 0.02

# -- what is claimed ---------------------------------------------------------------------------------------------------

VALID = 8.0  # σ_V from which on an airspeed is valid: 2 V* of the pressures' law (`paper`)
# m/s, σ_V up to which an airspeed that coasts is valid, whatever the reason, a flag, silence, NaN, a range's end;
# beyond it the airspeed hold falls back to a safe throttle. By hand; docs/faults.md says how long that lasts
COASTED = 2.0
FRESH = 0.2  # s since a total pressure was taken, up to which the airspeed does not coast. By hand
LAW_ENDS = 0.2 * TRANSONIC**2  # V² over 7 R T, beyond which no airspeed is valid: a² = 0.2 · 7 R T
MODEL = 0.1  # Pa, the least standard deviation of a reading: what the model is off by, 0.1 ms of the stroke's rise

# s for which pressures alone are not valid after the filter has ended, or after they have jumped: what they say then is
# as much in doubt as what it said. By hand
WILD = 1.0

# -- when the filter has diverged --------------------------------------------------------------------------------------

BEYOND = 450.0  # m/s of V, far past Mach 1, where the relation of pressures and airspeed ends
THINNEST, THICKEST = 1e3, 2e5  # Pa of the static pressure: that at 31 km, and twice that at the sea


@one_of_ours("aided")
class AidedFilter(Estimator):
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
        That filter; of no meaning before.
    time : float
        The instant at which it stands, s.
    ports : Ports
        The watch over the two ports. A reading of a port that is flagged is not taken.
    news : list of tuple
        What was flagged and taken back: time, s, event, channel and kind. The flight computer clears it.
    """

    core: type[EnergyFilter] = EnergyFilter
    __slots__ = (
        "_air", "_angles", "_apart", "_base", "_coldest", "_difference", "_differential", "_fastest", "_first_climb",
        "_flight_force", "_force", "_fresh", "_gained", "_gated", "_grown", "_head", "_heard", "_lift", "_longest",
        "_muted", "_noise", "_on_rail", "_onset", "_pair_variance", "_pause", "_plain", "_plain_tare", "_position",
        "_position_share", "_push", "_push_end", "_push_variance", "_rail", "_read", "_rest", "_rest_sd",
        "_rows", "_scale_share", "_scale_variance", "_settings", "_shock", "_stamps", "_start_wind", "_static_age",
        "_static_ends", "_static_share", "_static_spikes", "_static_variance", "_static_within", "_steady_from",
        "_steps", "_stroke", "_sudden", "_t", "_tare", "_tare_end", "_temperature_share", "_throttle",
        "_total_age", "_total_ends", "_total_spikes", "_total_variance", "_total_within", "_u", "_unfolding", "_w",
        "_waiting", "_warmed", "_warmed_share", "_warmest", "_warmth", "_wind", "_wind_known", "_wrong", "energy",
        "flying", "news", "ports", "time",
    )  # fmt: skip

    def __init__(self, settings: EstimatorSettings, noise: NoiseModel, tare_window: TareWindow | None = None) -> None:
        aided = self._plain = settings.aided
        self._settings, self._noise = settings, noise
        self._waiting = JumpAdaptive(settings, noise, tare_window)
        self._tare_end = -inf if tare_window is None else tare_window[1]
        self._gained = SpeedGained(
            noise.accelerometer_sd, noise.accelerometer_rate, lag=noise.accelerometer_lag, row=force_row(noise)
        )
        self._believe_offset(noise.accelerometer_offset_sd)
        self._gained.end_at(*noise.accelerometer_range)
        self._rest = RestForce(noise.accelerometer_sd, self._flight_force)
        self._push, self._force = MembranePush(noise, self._gained, self._rest), 0.0
        self._rows: deque[Row] = deque(maxlen=ROWS)
        self._total_age = 0.5 * noise.total_window + noise.total_lag
        self._static_age = 0.5 * noise.static_window + noise.static_lag
        self._total_variance = max(noise.total_sd, MODEL) ** 2
        self._static_variance = max(noise.static_sd, MODEL) ** 2
        self._pair_variance = self._total_variance + (0.0 if noise.differential else self._static_variance)
        self._difference, self._differential = Difference(noise.differential), noise.differential
        self._scale_share = 0.5 * noise.difference_scale_sd
        self._scale_variance = noise.accelerometer_scale_sd**2 + self._scale_share**2
        self._temperature_share, self._static_share = 0.5 * noise.temperature_sd, 0.5 * noise.static_offset_sd
        self._warmed_share = 0.5 * noise.thermometer_recovery_sd
        self._on_rail = aided.on_rail
        self._fastest = FASTEST if settings.fastest is None else settings.fastest
        self._coldest, self._warmest = within(noise.temperature_range, 0.0, LEAST_TEMPERATURE, MOST_TEMPERATURE)
        self._longest = jump(noise.head_rate)
        self._stamps = Stamps(self._longest)
        self._total_ends, self._static_ends = Conversions(self._longest), Conversions(self._longest)
        sd = sqrt(max(self._total_variance, self._static_variance))
        self._sudden = max(SUDDEN, SUDDEN_SD * sd)
        self._total_spikes, self._static_spikes = Spikes(), Spikes()
        self._watch_sensors(noise)
        self._total_within = within(channel_range(noise), noise.total_step, LEAST_PRESSURE, MOST_PRESSURE)
        self._static_within = within(noise.static_range, noise.static_step, LEAST_PRESSURE, MOST_PRESSURE)
        self._air = Air(aided, self._waiting.scale, self._waiting.lightness)
        self._wind, self._angles, self._head = RailWind(aided, noise.head), FlowAngles(aided), noise.head
        self._wind_known = self._wind.declared or self._tare_end == -inf
        self._wrong, self._throttle, self._position_share = not noise.head.none, 0.0, 0.0
        self._position = noise.head.error / (1.0 - noise.head.error)
        self._warmed = 0.2 * noise.thermometer_recovery
        self._onset = Onset(self._pair_variance, self._tare_end, settings.wind_sd)
        self._unfolding = Unfolding(aided)
        self.ports = Ports(self._settings.aided, self._air, noise, self._total_variance, self._static_variance)
        self.news = self.ports.news
        self.flying = self._apart = False
        self._steps, self._read = 0, -inf
        self.time = self._t = -inf
        self._tare = self._plain_tare = 0.0
        self._push_variance, self._steady_from = 0.0, inf
        self._u = self._w = self._grown = 0.0
        self._lift = GRAVITY
        self.energy = self._begin(-inf)

    def _watch_sensors(self, noise: NoiseModel) -> None:
        """Make what watches the sensors beside the ports."""
        self._rail, self._pause = RailCheck(noise, self._tare_end), pause(noise)
        self._warmth = self._rail.sensors["thermometer"].row
        self._stroke, self._push_end, self._first_climb = StrokeTest(), PushEnd(), FirstClimb()
        self._shock = Shock(noise.accelerometer_sd / sqrt(max(1.0, noise.accelerometer_rate / noise.head_rate)))
        self._base = (0.0, 0.0, 0.0)  # when the launch began, s, and ∫ f_x dt, m/s, and its variance by then
        self._heard, self._fresh, self._muted = [-inf, -inf, -inf], -inf, [False, False]
        self._gated = inf  # s, from which on pressures alone are valid again after the filter has ended

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
            if self.flying and self._muted[0] and -self._longest <= t - self._gained.newest <= self._longest:
                self._u, self._w = self._gained.at(self.time)  # it was silent, and the clocks agree as before
                self.ports.torn = True
            else:
                self._lose_time(t)
        if self._apart and -self._longest <= t - self._gained.newest <= self._longest:
            self._begin_in_flight(t)
        if self.flying:
            try:
                estimate = self._fly(t, p_total, p_static, temperature, t_total, t_static)
                if estimate is None or self._sound(estimate):
                    return estimate
            except (ArithmeticError, ValueError):  # Python raises these where other arithmetic gives inf or NaN
                pass
            self._fall_back(t, "diverged")
        return self._pressures_alone(t, p_total, p_static, temperature, t_total, t_static)

    def _pressures_alone(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Filter the pressures by themselves: on the rail, and after the filter has ended."""
        channel = self._difference.read(p_total, p_static)
        if self._gated < inf:
            reach = self._sudden + STEEP * (self._pause if t - self._t > self._pause else max(t - self._t, 0.0))
            self._t = t
            total, static = self._total_spikes.take(channel, reach), self._static_spikes.take(p_static, reach)
            p_total, p_static = p_total if total else nan, p_static if static else nan
            if JUMPED in (total, static):
                self._gated = max(self._gated, t + WILD)
        self._rail.add(t, channel, p_static, temperature, t_total, t_static)
        estimate = self._waiting.step(t, p_total, p_static, temperature, t_total, t_static)
        if estimate is None:
            return None
        self._rows.append((t, p_total, p_static, temperature, t_total, t_static))
        if estimate[6] and (t < self._gated < inf or self._of_rail(estimate[1]) or self._rail.broken(t)):
            return (*estimate[:6], False, *estimate[7:])
        return estimate

    def _of_rail(self, speed: float) -> bool:
        """Whether an airspeed of the pressures alone, m/s, may be that of the wind on a rail.

        What is read there is no airspeed of a flight: an open tare holds the wind, and after a cover the filter still
        runs in. It begins with the launch. A launch that is missed is known by what no wind can be.
        """
        on_rail = self._noise.rail_elevation is not None and self._gated == inf
        return on_rail and speed < hypot(STORM, self._wind.speed_declared)

    def doubts(self, t: float) -> tuple[str, ...] | None:
        """Why the head is not ready to be launched; see `Estimator.doubts`."""
        return self._rail.doubts(t) if self._rail.decided(t) else None

    def tidy(self) -> None:
        """Watch the ports by what was read last; the filter still stands where it stood then."""
        try:
            self.ports.judge(self._t, self.energy, self.time, self._u + self._grown)
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(self._t, "diverged")

    def _sound(self, estimate: Estimate) -> bool:
        """Whether the filter is within all bounds, which NaN is not, and none of its variances is below 0."""
        energy = self.energy
        if estimate[7] < 0.0 or estimate[8] < 0.0:
            return False
        return -BEYOND < energy.v < BEYOND and THINNEST < energy.p < THICKEST and energy.vv > 0.0 and energy.pp > 0.0

    def _fall_back(self, t: float, kind: str) -> None:
        """Go on with the pressures alone, both ports believed: the force is of no flight, or of another time."""
        self.flying = False
        self._gated = LATEST if self.ports.total.faulty or self.ports.static.faulty else t + WILD
        self._waiting.resume(self._total_spikes.last, self._static_spikes.last, self._sudden)
        self.ports.give_up(t, kind)

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
        """End the filter after a step of a clock: the integral of f_x and the filter's own time mean nothing then."""
        if self.flying:
            self._apart = True
            self._fall_back(t, "clock")

    # -- the filter's life -------------------------------------------------------------------------------------------

    def rested(self, offset: tuple[float, float, float], sd: tuple[float, float, float]) -> None:
        """Know the offset of f_x and f_z by what was found on the rail; see `Estimator`."""
        noise = self._noise = replace(self._noise, accelerometer_offset_sd=sd[0], lift_offset_sd=sd[2])
        self._believe_offset(sd[0])
        low, high = noise.accelerometer_range
        self._gained.end_at(low - offset[0], high - offset[0])
        self.ports.believe(noise, self._settings.aided)

    def _believe_offset(self, sd: float) -> None:
        """Let b hold an offset of f_x of this standard deviation, m/s², beside the angle of attack."""
        plain = self._plain
        self._settings = replace(self._settings, aided=with_offset(plain, sd))
        most = MOST_FLIGHT_FORCE if plain.flight_force is None else plain.flight_force
        self._flight_force = most + FARTHEST * sd

    def launched(self, t: float) -> None:
        """Start the filter before a launch that has been recognised at `t`, and bring it up to date."""
        if self.flying or not -LATEST < t < LATEST:
            return
        self._gained.bound(MOST_FORCE)
        start = max(t - self._settings.aided.replay, self._gained.oldest, self._tare_end)
        start = min(start, t)
        self._apart = False
        broken = self._rail.broken(t)
        self._gated = inf
        if not broken and self._aloft(start):
            self._begin_aloft(start, t)
        else:
            self.energy = self._begin(start)
            self._start(start, t + PATIENCE, inf)
            self._begin_stroke(t, start, broken)
            self._begin_first_climb(start)
        try:
            for row in self._rows:
                if row[4] - self._total_age > start or row[5] - self._static_age > start:
                    self._fly(*row)
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(t, "diverged")
        self._rows.clear()

    def throttle(self, t: float, value: float) -> None:
        """Know what the propeller blows with."""
        self._throttle = value

    def unfolding(self, t: float) -> None:
        """Trust the integral of f_x less for a while."""
        if self._wind.on:
            self._leave_rail()
        self._gained.bound(self._flight_force)
        self._unfolding.begin(t)
        if self.flying:  # slow, it has to pitch up, and f_x is turned further from the path than b grants
            turned = GRAVITY * self._angles.needed(self.energy.v, self._air.density)
            self.energy.widen_bias(turned * turned)
            self.ports.total.jump(self.time, turned * turned)

    def rearmed(self, t: float) -> None:
        """Go back to waiting: the launch was none."""
        self.flying = self._apart = False
        self._waiting.forget_time()
        self._rest.forget()
        self._rail.forget()
        self._gated = inf
        self._gained.bound(MOST_FORCE)

    def _begin_stroke(self, t: float, start: float, broken: dict[str, str]) -> None:
        """Begin the test of the stroke, and flag what the rail has shown to be dead."""
        energy, onset = self.energy, self._onset
        self._base = self.time, self._u, self._w
        if "total" in broken or "static" in broken:  # then nothing has been seen of the wind
            onset.know()
            self._wind.forget()
            energy.restart(0.0, self._settings.wind_sd**2)
        for channel, kind in broken.items():
            if channel == "thermometer":
                self._muted[1], self._heard[2] = True, -inf
            self.ports.dead_at_rest(t, energy, channel, kind, (0.0, self._settings.wind_sd**2))
        self._stroke.begin(
            () if broken else self._channels(),
            tare_end=self._tare_end if self._noise.covered else -inf,
            end=start,
            variance=self._total_variance,
            wind=most_wind(*self._start_wind),
            density=energy.p / self._air.gas,
        )

    def _channels(self) -> Iterator[Row]:
        """Return the rows that were kept, each with its total channel in the place of the total pressure."""
        read = Difference(self._differential).read
        return ((row[0], read(row[1], row[2]), *row[2:]) for row in self._rows)

    def _climbed(self, reading: float, before: float) -> None:
        """Judge by a static pressure, Pa, whether its port lives; the last one was of a time `before`, s."""
        test, energy, density = self._first_climb, self.energy, self._air.density
        ground = self._speed_since_launch()
        if self.ports.total.faulty or self.ports.static.faulty:
            test.open, test.hidden = False, 0.0
        elif test.add(
            reading,
            self._t - before,
            energy.v,
            self._u,
            density,
            self._push_end.lasts or self._wind.on or ground < BEGUN,
            ground=ground,
            position=self._position,
            position_sd=2.0 * self._position_share,
        ):
            self.ports.never_moved(self._t, energy, test.rest, test.lost, density)

    def _not_risen(self, kind: str) -> None:
        """Flag the total port in the stroke. What it has told of the wind is void, and V is what the force gave."""
        self._wind.forget()
        begun, _, w = self._base
        since, gained = self.time - begun, self._speed_since_launch()
        rest = self._rest_sd * since
        variance = self._settings.wind_sd**2 + self._w - w + rest * rest + self._scale_variance * gained * gained
        held = self._total_spikes.last
        if self._differential:
            held += self._difference.static - self._difference.zero
        self.ports.not_risen(self._t, self.energy, kind, held, (gained, variance))

    def _speed_since_launch(self) -> float:
        """Return what the force has given since the launch at the filter's instant, m/s, that at rest taken off."""
        begun, u, _ = self._base
        return self._u - u - self._rest.mean * (self.time - begun)

    def _begin_first_climb(self, start: float) -> None:
        """Begin to doubt the static port until it has left the rail's pressure."""
        statics = sorted(row[2] for row in self._rows if row[5] <= start and row[2] == row[2])
        rail = self._noise.rail_elevation
        if statics:
            self._first_climb.begin(statics[len(statics) // 2], self._noise.static_sd, 0.0 if rail is None else rail)

    def _begin(self, start: float) -> EnergyFilter:
        """Make the filter of a launch, which starts on the rail at an instant, s."""
        static = self._waiting.static.value
        known = LEAST_PRESSURE <= static <= MOST_PRESSURE
        self._tare, tare_variance = self._waiting.tare()
        self._plain_tare = self._tare
        self._air.begin(self._waiting.temperature)
        self._unfolding.forget()
        if not tare_variance > 0.0:
            tare_variance = self._noise.difference_sd**2  # nobody has tared the pair
        rest = self._rest.result(start)
        self._rest_sd = rest[1]
        at, density = (static, static / self._air.gas) if known else (airdata.STANDARD_PRESSURE, 0.0)
        tied = 0.0
        if self._wind_known:
            along, along_sd, tare_variance, tied = self._look_at_wind(start, at, density, tare_variance)
        else:
            self._wind.forget()
            along_sd = self._onset.look(self._on_the_rail(start), (self._tare, tare_variance), density)
            along = self._onset.wind
        self._start_wind = along, along_sd
        core = self._core(
            speed=(along, along_sd),
            rest=rest,
            static=(at, AROUND if known else ANYWHERE),
            difference_sd=sqrt(tare_variance),
        )
        core.tie_difference(tied)
        self._air.ground = core.p
        self._angles.forget()
        return core

    def _on_the_rail(self, end: float, longest: float = inf) -> tuple[float, float] | None:
        """Return the pair's mean difference at rest in the last seconds until `end`, and its variance."""
        begun = max(self._tare_end, end - longest)
        return rest_difference(self._rows, start=begun, end=end, each=self._pair_variance)

    def _look_at_wind(
        self, start: float, static: float, density: float, tare_variance: float
    ) -> tuple[float, float, float, float]:
        """Return u₀, its standard deviation, the variance of d and its covariance with u₀; see `rail_wind`."""
        air, noise = self._air, self._noise
        self._onset.know()
        tared = noise.covered and self._tare_end > -inf
        # A gust of the tare is over when the aircraft is launched. What is read last has the wind in it that the filter
        # begins in, so that the errors of both go together
        seen = self._on_the_rail(start, 2.0 * AGO)
        if tared and seen is not None:
            seen = seen[0] - self._tare, seen[1] + tare_variance
        elif not tared and self._tare_end > -inf and seen is None:
            seen = self._waiting.tare()
            seen = seen if seen[1] > 0.0 else None
        gusts = air.gust * max(self._wind.speed_declared, SLOWEST) * AGO
        along, sd, off, variance, tied = self._wind.begin(
            seen, tared=tared, air=(static, air.heat, gusts), density=density
        )
        if tared or seen is None:
            return along, sd, tare_variance, tied
        self._tare = off
        return along, sd, variance + noise.walk**2 * AGO, tied

    def _begin_in_flight(self, t: float) -> None:
        """Begin anew at `t`, s: V by the next total pressure, both ports believed, climb and bias not known."""
        self._begin_aloft(t - OLDEST, t)
        self._apart = False
        self.ports.tell(t, "airspeed_recovered", "both")

    def _aloft(self, start: float) -> bool:
        """Whether force or pressures at the start are not those of an aircraft that rests on its rail.

        The force is in a push already, or the pair's difference is more than any wind, and what is not known of its
        tare, can make. A launch that is told with no reading before it has the benefit of the doubt.
        """
        u, _ = self._gained.at(start)
        if self._gained.newest - start > AT_FIRST:
            pushed = (self._gained.at(start + AT_FIRST)[0] - u) / AT_FIRST
        elif self._gained.newest > start:
            pushed = (self._gained.at(self._gained.newest)[0] - u) / (self._gained.newest - start)
        else:
            pushed = 0.0
        if pushed > IN_PUSH:
            return True
        first = [row for row in self._rows if row[4] - self._total_age > start - AT_FIRST][:FIRST_ROWS]
        found = [row[1] - row[2] for row in first if row[1] == row[1] and row[2] == row[2]]
        static = self._waiting.static.value
        if not (found and LEAST_PRESSURE <= static <= MOST_PRESSURE):
            return False
        tare, variance = self._waiting.tare()
        spread = sqrt(
            (self._total_variance + self._static_variance) / len(found) + (variance or self._noise.difference_sd**2)
        )
        excess = sum(found) / len(found) - tare
        wind = hypot(STORM, self._wind.speed_declared)
        return excess > 0.5 * static / self._air.gas * wind * wind + UNLIKELY * spread

    def _begin_aloft(self, start: float, t: float) -> None:
        """Begin in flight, or in a push, at an instant, s: V by the next total pressure, climb and bias not known."""
        aided, before = self._settings.aided, self._waiting.static.value
        if not LEAST_PRESSURE <= before <= MOST_PRESSURE:
            before = self.energy.p
        self._tare, variance = self._waiting.tare()
        self._plain_tare = self._tare
        self._air.begin(self._waiting.temperature)
        core = self._core(
            speed=(0.0, self._settings.wind_sd),
            rest=(0.0, 0.0),
            static=(before if THINNEST < before < THICKEST else airdata.STANDARD_PRESSURE, ANYWHERE),
            difference_sd=sqrt(variance) if variance > 0.0 else self._noise.difference_sd,
        )
        core.leave_rail(0.5 * aided.slope_rate**2 * aided.slope_time)
        self._wind.forget()
        self._angles.forget()
        self.energy = core
        self._air.ground = core.p
        self._onset.know()
        self._unfolding.forget()
        self._rest.mean = 0.0
        self._start(start, -inf, t + STEADY)

    def _core(
        self, speed: tuple[float, float], rest: tuple[float, float], static: tuple[float, float], difference_sd: float
    ) -> EnergyFilter:
        """Make a filter; airspeed, what f_x reads at rest, and static pressure each with its standard deviation."""
        aided, noise = self._settings.aided, self._noise
        return self.core(
            speed=speed[0],
            speed_sd=speed[1],
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
            relative=self._differential,
        )

    def _start(self, start: float, patience: float, steady_from: float) -> None:
        """Fly from an instant on, s; see `PATIENCE` and `STEADY`."""
        self.flying = True
        self.time = self._t = start
        self._u, self._w = self._gained.at(start)
        self._push.forget()
        self._onset.begin(patience)
        self._push_variance, self._steady_from = 0.0, steady_from
        self._total_spikes.forget()
        self._static_spikes.forget()
        self.ports.begin()
        self._push_end.forget(steady_from)
        self._shock.forget()
        self._heard, self._fresh, self._muted = [start, start, start], start, [False, False]
        self._stroke.open = self._first_climb.open = False
        self._first_climb.hidden = 0.0
        self._total_ends.forget()
        self._static_ends.forget()

    # -- flight ------------------------------------------------------------------------------------------------------

    def _fly(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        if not t > self._t:
            return None
        ports, air, energy = self.ports, self._air, self.energy
        if ports.seen_total is not None or ports.seen_static is not None:
            ports.judge(self._t, energy, self.time, self._u + self._grown)
        before, self._t = self._t, t
        channel = self._difference.read(p_total, p_static) if self._differential else p_total
        heard, given = self._heard, (channel, p_static, temperature)
        if self._coldest <= temperature <= self._warmest:
            if self._warmed > 0.0:
                temperature /= 1.0 + 5.0 * self._warmed * energy.v * energy.v / air.heat
            if temperature != air.temperature:
                air.warm(temperature)
            air.measured = True
            heard[2] = heard[2] if self._warmth.stuck else t
        else:
            temperature = nan
        air.at(energy.p, energy.s)
        low, high = self._total_within
        if not low <= channel <= high:
            channel = nan
        low, high = self._static_within
        if not low <= p_static <= high:
            p_static = nan
        reach = self._sudden + (STEEP if self.time > self._steady_from else STROKE) * (t - before)
        total, static = self._total_spikes.take(channel, reach), self._static_spikes.take(p_static, reach)
        if JUMPED in (total, static) and self.time > self._steady_from:
            ports.jumped(t, energy, (self.time, self._u + self._grown), total == JUMPED, static == JUMPED)
        end_total, end_static = self._total_ends.new(t_total, t), self._static_ends.new(t_static, t)
        self._warmth.add(given[2] if end_static == end_static else nan)
        new_total, new_static = end_total == end_total and total, end_static == end_static and static
        if self._first_climb.open and new_static > 0:
            self._climbed(p_static, heard[1])
        heard[0] = t if new_total > 0 else heard[0]
        heard[1], ports.raw_static = (t, p_static) if new_static > 0 else (heard[1], ports.raw_static)
        late = t - self._pause
        if self._gained.newest < late or min(heard) < late or True in self._muted:
            self._listen(t, late, given, (end_total, end_static))
        nis_total, nis_static = self._take(channel, p_static, end_total, end_static, new_total > 0, new_static > 0)
        raw = nan
        if total and static and temperature > 0.0:
            difference = p_total - self._plain_tare - p_static
            static_port = p_static - self._position * difference  # as the pressures alone have it (`paper`)
            excess = (p_total - self._plain_tare - static_port) / static_port
            raw = isentropic_speed(excess, air.heat) if excess > 0.0 else 0.0
        return self._tell(t, raw, nis_total, nis_static)

    def _listen(self, t: float, late: float, values: tuple[float, ...], ends: tuple[float, ...]) -> None:
        """Flag a sensor of which nothing has been heard since `late`, s, and take back one that speaks again.

        Pressures come back by themselves, when they agree (`readmission`).
        """
        ports, now = self.ports, (self.time, self._u + self._grown)
        for channel, heard, value, end in zip(("total", "static"), self._heard, values, ends, strict=False):
            if heard < late:
                kind = "silent" if end != end else "range" if value == value else "invalid"
                ports.condemn(t, self.energy, now, channel, kind)
        warmth = force = ""
        if self._heard[2] < late:
            warmth = "stuck" if self._warmth.stuck else "range" if values[2] == values[2] else "invalid"
        if self._gained.newest < late:
            force = "stuck" if self._gained.stuck else "silent"
        for i, (channel, kind) in enumerate((("accelerometer", force), ("thermometer", warmth))):
            if bool(kind) != self._muted[i]:
                self._muted[i] = bool(kind)
                ports.tell(t, "airspeed_fault" if kind else "airspeed_recovered", channel, kind)

    def _take(
        self, p_total: float, p_static: float, t_total: float, t_static: float, new_total: bool, new_static: bool
    ) -> tuple[float, float]:
        """Take what is new of a reading of the head, its channels; return the normalised innovations squared."""
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

    def _steady(self, to: float, at: float) -> bool:
        """Whether both ports are sound, and both readings are later than the filter and of about the same instant."""
        return (
            self.time > self._steady_from
            and to > self.time
            and -OLDEST < to - at < OLDEST
            and self._onset.settled
            and not self.ports.total.faulty
            and not self.ports.static.faulty
        )

    def _take_both(self, p_total: float, p_static: float, t_total: float, to: float, at: float) -> tuple[float, float]:
        """What `_advance`, `_take_static` and `_take_total` do, at once."""
        energy, density, dt = self.energy, self._air.density, to - self.time
        self._feel_shock(to)
        if energy.kk > 0.0:
            self._push_variance = energy.know_push()
        gained, variance = self._go(to, dt)
        pushed = self._pushed(t_total)
        tared = p_total - self._tare - self._difference.zero - self._noise.acceleration * pushed
        unknown = 0.0
        if self._wrong:
            if self._lift == self._lift:
                self._angles.lift = self._lift
            above, off, unknown = self._off()
            tared, p_static = tared - above + (off if self._differential else 0.0), p_static - off
        nis_static, nis_total = energy.fly(
            dt,
            gained,
            variance,
            density,
            p_static,
            self._static_variance + unknown,
            density * energy.v * (to - at),
            tared - pushed * energy.k,
            self._total_variance + pushed * pushed * self._push_variance,
            self._air.heat,
        )
        ports = self.ports
        if nis_total <= GATE:
            self._fresh, ports.gated = self._t, 0
        else:
            ports.gate(energy)
        ports.misses = 0 if nis_static <= GATE else ports.misses + 1
        ports.seen_static = p_static, at, self._lift
        ports.seen_total = p_total, tared + energy.p if self._differential else tared, nis_total
        return nis_total, nis_static

    def _feel_shock(self, to: float) -> None:
        """Open b after a step of f_x; name the accelerometer where b has taken it up."""
        shock, energy, ports = self._shock, self.energy, self.ports
        size = shock.add(to, self._force, energy.b)
        if size != 0.0:
            energy.widen_bias(size * size)
            ports.total.open_bias(self.time, size * size)
        elif to > shock.due:
            offset, moved = shock.judge(energy.b, energy.bb)
            if offset:
                ports.tell(self._t, "airspeed_fault", "accelerometer", "offset")
            else:
                ports.total.close_bias(moved * moved)

    def _advance(self, to: float) -> None:
        """Predict to a later time; an earlier one leaves the filter where it is."""
        dt = to - self.time
        if not dt > 0.0:
            return
        gained, variance = self._go(to, dt)
        if self.ports.total.faulty and self.ports.total.coasts:
            self.ports.total.carry(self.energy, dt, gained, variance, self._air.density)
        else:
            self.energy.predict(dt, gained, variance, self._air.density, self._force > self._on_rail)
            if self._wind.on:  # the model climbs by the airspeed, the aircraft up its rail by that over the ground
                energy = self.energy
                energy.shift_static(self._air.density * energy.s * (energy.v - self._wind.gained(energy.v)) * dt)

    def _go(self, to: float, dt: float) -> tuple[float, float]:
        """Go on to a later time; return ∫ f_x dt, m/s, and the variance that gust and accelerometer add to V's."""
        wind = self._wind
        v = self.energy.v if not wind.on else wind.speed(self.energy.v)
        u, w = self._gained.at(to)
        gained = u - self._u
        self._force = gained / dt - self._rest.mean
        if self._steady_from == inf:
            self._push_end.add(to, self._force, dt)
            self._steady_from = self._push_end.steady_from
        if self._air.growth:
            grown = self._air.growth * (wind.gained(self.energy.v) if wind.on else v) * dt
            gained += grown
            self._grown += grown
        variance = self._air.gust * (v if v > SLOWEST else SLOWEST) * dt
        if wind.on:
            railed = self._force > self._on_rail
            wind.advance(self.energy, dt, gained, variance, self._air.density, railed)
            if self._force > self._on_rail:
                wind.pushed = True
            elif wind.pushed or to > self._onset.patience:
                self._leave_rail()
        if w > self._w:  # else readings have come late, and w has counted already that they might be lost
            variance = variance + w - self._w
            if self._gained.torn(w - self._w, dt):
                self.ports.torn = True
        if self.time < self._unfolding.end:
            variance += self._unfolding.variance(self.time, to)
        lift = self._lift = self._gained.lift()
        if lift == lift and to > self._unfolding.end > -inf:  # the wings are out
            self._angles.lift = lift
        if self.time > self._steady_from and lift == lift:
            turned, doubt = pulled(lift, v)
            gained -= turned * dt
            variance += doubt * dt
        self.time, self._u, self._w = to, u, w
        return gained, variance

    def _take_static(self, reading: float, at: float) -> float:
        energy, ports, density = self.energy, self.ports, self._air.density
        ahead = self.time - at
        if not -OLDEST < ahead < OLDEST:
            return nan
        noise = self._static_variance
        if self._wrong:
            if self._wind.on:
                noise += self._wind.unknown(energy.v, energy.p, self._air.heat)
            else:
                _, off, unknown = self._off()
                reading, noise = reading - off, noise + unknown
        if ports.static.faulty:
            ports.hear_static(self._t, energy, at, reading, reading - energy.p - density * energy.v * ahead * energy.s)
            return nan
        if self._wind.on:
            nis = self._wind.static(energy, reading, noise, density * energy.v * ahead, self._air.heat)
        else:
            nis = energy.static(reading, noise, density * energy.v * ahead)
        ports.misses = 0 if energy.taken else ports.misses + 1
        if self.time > self._steady_from:
            ports.seen_static = reading, at, self._lift
        elif ports.misses >= PERSISTENT:  # these are no spikes, and it is too early for a fault: the filter is wrong
            energy.widen_static(energy.innovation * energy.innovation)
            energy.static(reading, noise, 0.0)
            ports.misses = 0
        return nis

    def _shut_in_stroke(self, reading: float) -> bool:
        """Judge by a total pressure, Pa, whether it rises in the stroke; flag the port if it does not."""
        pushed, noise = self._force, self._noise
        kind = self._stroke.add(
            reading - noise.acceleration * pushed,
            self._static_spikes.last,
            self._speed_since_launch(),
            noise.acceleration_sd * pushed,
        )
        if kind:
            self._not_risen(kind)
        return bool(kind)

    def _of_channel(self, channel: float) -> tuple[float, float, float]:
        """Return what the total channel says, Pa, the variance of its noise, Pa², and what it is relative to, Pa."""
        if not self._differential:
            return channel, self._total_variance, 0.0
        difference = channel - self._difference.zero
        if self.ports.static.shut:  # to both sensors: the pressure that is shut in and Δp are the total pressure
            return difference + self._difference.static, self._total_variance + self._static_variance, 0.0
        return difference, self._total_variance, self.energy.p

    def _measure(self, tared: float, variance: float, pushed: float, relative: bool) -> float:
        """Correct the filter by a total pressure, Pa, of a variance, Pa²; on the rail it has the side wind in it."""
        energy, heat = self.energy, self._air.heat
        if not self._wind.on:
            return energy.total(tared, variance, pushed, heat)
        if self._wrong:
            variance += self._wind.unknown(energy.v, energy.p, heat)
        return self._wind.total(energy, tared, variance, pushed, heat, relative=relative)

    def _take_total(self, reading: float, end: float) -> float:
        energy, air = self.energy, self._air
        behind = self.time - (end - self._total_age)
        if behind > OLDEST:
            return nan
        if self._stroke.open and self._shut_in_stroke(reading):
            return nan
        read, (reading, each, base) = reading, self._of_channel(reading)
        onset = self._onset
        if not onset.settled and not onset.settle(energy, self.time, reading - self._tare + base, air):
            return nan
        pushed = self._pushed(end)
        variance = each + pushed * pushed * self._push_variance
        if behind > 0.0:  # the filter has taken a later one: as if V had changed by the force and the gust alone
            slope = air.density * energy.v
            reading += slope * (self._u - self._gained.at(self.time - behind)[0] - behind * (energy.b + energy.s))
            variance += slope * slope * air.gust * abs(energy.v) * behind
        tared = reading - self._tare - self._noise.acceleration * pushed
        if self._wrong and not self._wind.on:
            above, off, _ = self._off()
            tared -= above - off if base else above
        if self.ports.total.faulty:
            self.ports.hear_total(self._t, energy, end, read, tared + base, variance)
            return nan
        on_rail = self._wind.on
        nis = self._measure(tared, variance, pushed, base > 0.0)
        if energy.taken:
            self._fresh, self.ports.gated = self._t, 0
        else:
            self.ports.gate(energy)
        below = (0.0 if base else energy.p) - tared > NO_SPEED * air.density * energy.v * energy.v + self._sudden
        if not (energy.taken or below) and self.time < self._steady_from:  # too early for a fault: the filter is wrong
            slope = air.density * (energy.v if energy.v > SLOWEST else SLOWEST)
            energy.widen_speed((energy.innovation / slope) ** 2)
        if not on_rail and energy.v < 0.0 and energy.taken and energy.v * energy.v > ONE_SIDED * energy.vv:
            energy.restart(-energy.v, energy.vv)  # the pressure is that of −V, too, and an aircraft flies forward
        if self.time > self._steady_from and not self.ports.static.faulty:
            self.ports.seen_total = read, tared + (energy.p if base else 0.0), nis
        return nis

    def _leave_rail(self) -> None:
        """Be told that the push is over: from here on the filter's airspeed is along the path."""
        self._wind.leave(self.energy)
        self._angles.leave(self.time, self._wind.side)

    def _off(self) -> tuple[float, float, float]:
        """What both ports are off by in flight, Pa: total, static; and the variance of what is not known, Pa²."""
        energy, air, head, angles = self.energy, self._air, self._head, self._angles
        v, p = energy.v, energy.p
        impact = isentropic(v, p, air.heat) - p
        side2, side2_sd = angles.side(self.time, v)
        down, down_sd = angles.down(v, air.density)
        across = side2 + down * down
        total, static = head.shares(
            sqrt(1.0 - across) if across < 1.0 else 0.0, sqrt(side2), down, 5.0 * v * v / air.heat, self._throttle
        )
        share = head.spread(side2, side2_sd, down, down_sd, self._throttle)
        self._position_share = 0.5 * share
        return impact * (total - 1.0), impact * static, (impact * share) ** 2

    def _pushed(self, end: float) -> float:
        """Specific force over the total pressure's conversion that ends then; a change of it widens b."""
        before = self._push.held
        pushed = self._push.over(end, self._force)
        if pushed != before:
            widened = self._scale_variance * abs(pushed * pushed - before * before)
            self.energy.widen_bias(widened)
            self.ports.total.jump(self.time, widened)
        return pushed

    def _tell(self, t: float, raw: float, nis_total: float, nis_static: float) -> Estimate:
        """Predict to the time of the reading and say what is known."""
        energy, air = self.energy, self._air
        dt = t - self.time
        if dt > 0.0:
            u, w = self._gained.at(t)
            if w < self._w:  # noqa: PLR1730 - as in `_go`, and a call of max costs a tenth of a microsecond
                w = self._w
        else:
            dt, u, w = 0.0, self._u, self._w
        speed, variance, static = energy.foretell(dt, u - self._u, air.density)
        if self._wind.on:
            speed, variance = self._wind.told(speed, variance)
        variance += air.gust * (energy.v if energy.v > SLOWEST else SLOWEST) * dt + w - self._w
        if self.time < self._unfolding.end:
            variance += self._unfolding.variance(self.time, t)
        if speed < 0.0:  # noqa: PLR1730
            speed = 0.0
        hidden = self._first_climb.hidden
        if hidden > 0.0:
            hidden /= air.density * (speed if speed > SLOWEST else SLOWEST)
            variance += hidden * hidden
        variance += self.ports.between
        share = self._temperature_share * speed / air.temperature
        if self._static_share > 0.0:
            dense = self._static_share * speed / static
            share = sqrt(share * share + dense * dense)
        if self._wrong:
            position = self._position_share * speed
            if self._wind.on and speed > SLOWEST:
                position = sqrt(self._wind.unknown(energy.v, static, air.heat)) / (air.density * speed)
            share = sqrt(share * share + position * position)
        if self._warmed_share > 0.0:
            warmed = self._warmed_share * speed * speed / air.heat * speed
            share = sqrt(share * share + warmed * warmed)
        scale = self._scale_share * speed
        sd = sqrt(max(variance, 0.0) + share * share + scale * scale)
        total = isentropic(speed, static, air.heat)
        ports = self.ports
        valid = (
            VALID * sd <= speed <= self._fastest
            and speed * speed <= LAW_ENDS * air.heat
            and air.measured
            and (sd < COASTED or (t - self._fresh < FRESH and not ports.total.faulty))
            # without it V and the climb are hardly told apart, but for a difference that has been read
            and not (ports.static.faulty and (ports.static.shut or not self._differential))
        )
        return t, speed, sd, raw, total, static, valid, nis_total, nis_static
