"""Airspeed from two pressures and the accelerometer, from the rail to cruise.

    waiting --launch recognised--> replay of the last 0.3 s --> flying        (rearmed: back to waiting)

**Waiting.** The pressures are filtered by themselves (`jump_adaptive`), and the root is taken last. Meanwhile the pair
is tared, the mean of f_x at rest is taken (`rest_force`), and the last readings of both kinds are kept. On a rail no
airspeed is valid before the launch is recognised.

**Flying.** The energy-rate filter (`energy`) begins before the launch, in the readings that were kept (`hand_over`).
Then each reading of the head is admitted (`admission`), brings the filter to its instant (`progress`), and corrects it
(`corrections`); what is known at the time of the reading is told (`told`). In the first seconds the launch itself tests
both ports (`launch_checks`), later they are watched (`ports`).

**When the filter ends.** Beyond all bounds it has diverged, and the pressures alone are filtered, as before the launch.
A step of a clock (`uavsim.onboard.stamps`) ends it, too. It then begins anew in flight, with V from the pressures, as
soon as the clocks of head and accelerometer agree.
"""

from dataclasses import replace
from math import hypot, inf, nan

from uavsim.onboard.airspeed.admission import Admission
from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.corrections import OLDEST, Corrections
from uavsim.onboard.airspeed.difference import Difference
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.energy_model import isentropic_speed
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.hand_over import STORM, THICKEST, THINNEST, Beginning, HandOver
from uavsim.onboard.airspeed.interface import NoiseModel, pair_variance
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.kinds import one_of_ours
from uavsim.onboard.airspeed.launch_checks import LaunchTests
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.onboard.airspeed.onset import Onset
from uavsim.onboard.airspeed.port_errors import PortErrors
from uavsim.onboard.airspeed.ports import Ports
from uavsim.onboard.airspeed.progress import Progress
from uavsim.onboard.airspeed.rail import RailCheck
from uavsim.onboard.airspeed.rest_force import RestForce
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.airspeed.speed_gained import SpeedGained
from uavsim.onboard.airspeed.spikes import JUMPED
from uavsim.onboard.airspeed.told import Told
from uavsim.onboard.interface import Estimate, Estimator, Feel, TareWindow
from uavsim.onboard.plausible import FASTEST, MOST_FLIGHT_FORCE, MOST_FORCE
from uavsim.onboard.repeats import force_row
from uavsim.onboard.stamps import LATEST, Stamps, jump

# s after the recognition in which a push has to show, three strokes of the catapult; after that V is what the pressures
# say. By hand
PATIENCE = 1.0
# s after a filter that begins in flight, from which on the ports are watched and k is taken for known. After a launch
# the force tells (`push_end`): stroke, unfolding and pull-up would seem faults. By hand
STEADY = 2.0
# standard deviations of the accelerometer's offset, by which a reading of a plausible force may be beyond its bound.
# Beyond it a reading is a missing one. By hand: the usual three
FARTHEST = 3.0
# s for which pressures alone are not valid after the filter has ended, or after they have jumped: what they say then is
# as much in doubt as what it said. By hand
WILD = 1.0
BEYOND = 450.0  # m/s of V, far past Mach 1, where the relation of pressures and airspeed ends: the filter has diverged


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
    ports : Ports
        The watch over the two ports. A reading of a port that is flagged is not taken.
    news : list of tuple
        What was flagged and taken back: time, s, event, channel and kind. The flight computer clears it.
    """

    core: type[EnergyFilter] = EnergyFilter
    progress: type[Progress] = Progress
    __slots__ = (
        "_admission", "_apart", "_corrections", "_difference", "_differential", "_errors", "_flight_force", "_gained",
        "_gated", "_hand_over", "_longest", "_noise", "_onset", "_plain", "_progress", "_rail", "_read", "_rest",
        "_settings", "_stamps", "_steps", "_tare", "_tare_end", "_tests", "_told", "_waiting", "flying", "news",
        "ports",
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
        self._difference, self._differential = Difference(noise.differential), noise.differential
        self._longest = jump(noise.head_rate)
        self._stamps = Stamps(self._longest)
        self._rail = RailCheck(noise, self._tare_end)
        self._onset = Onset(pair_variance(noise), self._tare_end, settings.wind_sd)
        self._join(Air(aided, self._waiting.scale, self._waiting.lightness), noise)
        self.news = self.ports.news
        self.flying = self._apart = False
        self._steps, self._read = 0, -inf
        self._gated = inf  # s, from which on pressures alone are valid again after the filter has ended
        self._tare = 0.0
        self._hand_over.on_rail(-inf)

    def _join(self, air: Air, noise: NoiseModel) -> None:
        """Make the parts of the filter in flight, each with those that it goes by."""
        settings = self._settings
        ports = self.ports = Ports(settings.aided, air, noise)
        progress = self._progress = self.progress(
            self._plain, noise, air=air, gained=self._gained, rest=self._rest, onset=self._onset, ports=ports
        )
        admission = self._admission = Admission(
            noise, self._longest, progress, ports, self._rail.sensors["thermometer"].row
        )
        errors = self._errors = PortErrors(noise.head, progress.angles, air)
        tests = self._tests = LaunchTests(
            noise,
            settings.wind_sd,
            progress,
            ports=ports,
            errors=errors,
            admission=admission,
            difference=self._difference,
        )
        corrections = self._corrections = Corrections(
            noise, progress, ports=ports, errors=errors, tests=tests, difference=self._difference, onset=self._onset,
            sudden=admission.sudden,
        )  # fmt: skip
        fastest = FASTEST if settings.fastest is None else settings.fastest
        self._told = Told(
            noise, fastest, progress,
            corrections=corrections, errors=errors, tests=tests, ports=ports, die=admission.die,
        )  # fmt: skip
        self._hand_over = HandOver(
            self.core, noise, settings, self._tare_end,
            waiting=self._waiting, progress=progress, onset=self._onset,
        )  # fmt: skip

    @property
    def energy(self) -> EnergyFilter:
        """The energy-rate filter; of no meaning before it flies."""
        return self._progress.energy

    @property
    def time(self) -> float:
        """The instant at which it stands, s."""
        return self._progress.time

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
            if self.flying and self._admission.muted[0] and -self._longest <= t - self._gained.newest <= self._longest:
                self._progress.reread()  # it was silent, and the clocks agree as before
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
            elapsed, self._progress.t = t - self._progress.t, t
            total, static = self._admission.alone(channel, p_static, elapsed)
            p_total, p_static = p_total if total else nan, p_static if static else nan
            if JUMPED in (total, static):
                self._gated = max(self._gated, t + WILD)
        self._rail.add(t, channel, p_static, temperature, t_total, t_static)
        estimate = self._waiting.step(t, p_total, p_static, temperature, t_total, t_static)
        if estimate is None:
            return None
        if self._gated == inf:  # before a launch; in flight they would be kept for none
            self._hand_over.rows.append((t, p_total, p_static, temperature, t_total, t_static))
        if estimate[6] and (t < self._gated < inf or self._of_rail(estimate[1]) or self._rail.broken(t)):
            return (*estimate[:6], False, *estimate[7:])
        return estimate

    def _of_rail(self, speed: float) -> bool:
        """Whether an airspeed of the pressures alone, m/s, may be that of the wind on a rail.

        What is read there is no airspeed of a flight: an open tare holds the wind, and after a cover the filter still
        runs in. It begins with the launch. A launch that is missed is known by what no wind can be.
        """
        on_rail = self._noise.rail_elevation is not None and self._gated == inf
        return on_rail and speed < hypot(STORM, self._progress.wind.speed_declared)

    def doubts(self, t: float) -> tuple[str, ...] | None:
        """Why the head is not ready to be launched; see `Estimator.doubts`."""
        return self._rail.doubts(t) if self._rail.decided(t) else None

    def tidy(self) -> None:
        """Watch the ports by what was read last; the filter still stands where it stood then."""
        progress = self._progress
        try:
            self.ports.judge(progress.t, progress.energy, progress.time, progress.u + progress.grown)
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(progress.t, "diverged")

    def _sound(self, estimate: Estimate) -> bool:
        """Whether the filter is within all bounds, which NaN is not, and none of its variances is below 0."""
        energy = self._progress.energy
        if estimate[7] < 0.0 or estimate[8] < 0.0:
            return False
        return -BEYOND < energy.v < BEYOND and THINNEST < energy.p < THICKEST and energy.vv > 0.0 and energy.pp > 0.0

    def _fall_back(self, t: float, kind: str) -> None:
        """Go on with the pressures alone, both ports believed: the force is of no flight, or of another time."""
        self.flying = False
        self._gated = LATEST if self.ports.total.faulty or self.ports.static.faulty else t + WILD
        self._waiting.resume(self._admission.total.last, self._admission.static.last, self._admission.sudden)
        self.ports.give_up(t, kind)

    # -- clocks ------------------------------------------------------------------------------------------------------

    def _admit(self, t: float) -> bool:
        """Whether a reading is taken whose stamp does not follow the last."""
        if not self._stamps.admit(t, self._read):
            return False
        if self._read > -inf:
            self._lose_time(t)
            self._hand_over.rows.clear()
        self._admission.forget_ends()
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
        self._hand_over.believe(noise, self._settings)

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
        start = max(t - self._plain.replay, self._gained.oldest, self._tare_end)
        start = min(start, t)
        self._apart = False
        broken = self._rail.broken(t)
        self._gated = inf
        if not broken and self._hand_over.is_aloft(start):
            self._begin_aloft(start, t)
        else:
            self._begin_on_rail(start, t, broken)
        total_age, static_age = self._noise.total_age, self._noise.static_age
        try:
            for row in self._hand_over.rows:
                if row[4] - total_age > start or row[5] - static_age > start:
                    self._fly(*row)
        except (ArithmeticError, ValueError):  # as in `step`
            self._fall_back(t, "diverged")
        self._hand_over.rows.clear()

    def airborne(self, t: float) -> None:
        """Begin in flight: V by the next total pressure, climb and bias not known."""
        if not self.flying and -LATEST < t < LATEST:
            self._gated = inf
            self._gained.bound(self._flight_force)
            self._begin_aloft(t - OLDEST, t)

    def throttle(self, t: float, value: float) -> None:
        """Know what the propeller blows with."""
        self._errors.throttle = value

    def unfolding(self, t: float) -> None:
        """Trust the integral of f_x less for a while."""
        progress = self._progress
        self._gained.bound(self._flight_force)
        progress.unfold(t)
        if self.flying:  # slow, it has to pitch up, and f_x is turned further from the path than b grants
            turned = GRAVITY * progress.angles.unfold(progress.energy.v, progress.air.density)
            progress.energy.widen_bias(turned * turned)
            self.ports.total.jump(progress.time, turned * turned)

    def rearmed(self, t: float) -> None:
        """Go back to waiting: the launch was none."""
        self.flying = self._apart = False
        self._waiting.forget_time()
        self._rest.forget()
        self._rail.forget()
        self._gated = inf
        self._gained.bound(MOST_FORCE)

    def _begin_on_rail(self, start: float, t: float, broken: dict[str, str]) -> None:
        """Begin at rest on the rail at an instant, s; what the rail has shown to be dead is flagged at `t`, s."""
        hand_over, tests = self._hand_over, self._tests
        start = hand_over.still_until(start, t)
        begun = hand_over.on_rail(start)
        self._start(start, begun, t + PATIENCE, inf)
        tests.begin(begun.rest_sd)
        if broken:
            self._flag(t, broken)
        noise = self._noise
        tests.begin_stroke(
            () if broken else hand_over.rows,
            self._tare_end if noise.covered else -inf,
            start,
            begun.wind,
            sided=self._onset.wind == 0.0,
        )
        tests.begin_climb(hand_over.rows, start, noise)

    def _flag(self, t: float, broken: dict[str, str]) -> None:
        """Flag what the rail has shown to be dead."""
        energy, variance = self.energy, self._settings.wind_sd**2
        if "total" in broken or "static" in broken:  # then nothing has been seen of the wind
            self._onset.know()
            self._progress.lose_wind()
            energy.restart(0.0, variance)
        for channel, kind in broken.items():
            if channel == "thermometer":
                self._admission.mute_thermometer()
            self.ports.dead_at_rest(t, energy, channel, kind, (0.0, variance))

    def _begin_in_flight(self, t: float) -> None:
        """Begin anew at `t`, s: V by the next total pressure, both ports believed, climb and bias not known."""
        self._begin_aloft(t - OLDEST, t)
        self._apart = False
        self.ports.tell(t, "airspeed_recovered", "both")

    def _begin_aloft(self, start: float, t: float) -> None:
        """Begin in flight, or in a push, at an instant, s."""
        self._start(start, self._hand_over.aloft(self.energy.p), -inf, t + STEADY)

    def _start(self, start: float, begun: Beginning, patience: float, steady_from: float) -> None:
        """Fly from an instant on, s; see `PATIENCE` and `STEADY`."""
        self.flying = True
        self._tare = self._waiting.tare()[0]
        self._progress.start(start, steady_from)
        self._onset.begin(patience)
        self._corrections.begin(start, begun.tare)
        self._admission.begin(start)
        self._tests.close()
        self.ports.begin()

    # -- flight ------------------------------------------------------------------------------------------------------

    def _fly(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head into the filter."""
        progress, ports, admission = self._progress, self.ports, self._admission
        if not t > progress.t:
            return None
        if ports.seen_total is not None or ports.seen_static is not None:
            ports.judge(progress.t, progress.energy, progress.time, progress.u + progress.grown)
        before, progress.t = progress.t, t
        channel = self._difference.read(p_total, p_static) if self._differential else p_total
        total, static, end_total, end_static, new_total, new_static, whole = admission.take(
            t, before, channel, p_static, temperature, t_total, t_static
        )
        if new_static and self._tests.climb.open:
            self._tests.climbed(static, admission.static_pause)
        nis_total, nis_static = self._corrections.take(total, static, end_total, end_static, new_total, new_static)
        raw = nan
        if whole:
            difference = p_total - self._tare - static
            static_port = static - self._errors.position * difference  # as the pressures alone have it (`paper`)
            excess = (p_total - self._tare - static_port) / static_port
            raw = isentropic_speed(excess, progress.air.heat) if excess > 0.0 else 0.0
        return self._told.tell(t, raw, nis_total, nis_static)
