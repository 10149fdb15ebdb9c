"""The flight computer: what the aircraft does with what it notices.

It runs the launch detector on every accelerometer reading and the airspeed estimator on every reading of the air-data
head, and turns detection into action:

    waiting --launch detected--> stroke --push over, speed gained--> coasting --delay--> wings out --delay--> flying
                                    |                                                              motor on, airspeed
                                    +--push over, no speed gained--> rearming --delay--> waiting   and height hold

The end of the stroke is a short mean of f_x less its mean on the rail that stays below a level. Whether it was a launch
tells the speed gained, the integral of the same since detection (`uavsim.onboard.stroke`): a knock must not open the
wings. The mean on the rail holds the accelerometer's offset, so no offset keeps the wings in. As far as the offset has
been found on the rail (`uavsim.onboard.rail_offset`), it is taken off each reading first, for detector and estimator,
too.

In flight the throttle holds the ESTIMATED airspeed and the pitch command the height by static pressure; pitch and roll
themselves are stabilised inside the aircraft:

    throttle = level + K_p e + K_i integral(e dt) + K_c (pitch - level pitch),    e = set airspeed - estimate
    pitch    = level pitch + K_h (set height - height), at most that of the climb; while more airspeed than a margin is
               still to be gained, that of the launch, and between the two in proportion.

An estimate that has not been valid for a while is not flown on: the throttle then goes to one that is safe at any
pitch, safe level + K_c (pitch - level pitch), and the height is held on, until the estimate has been valid for as long.
Nor is the height flown on of a static port that is flagged: the pitch is then that of level flight, at which the safe
throttle climbs.

Whatever the readings, it goes on: one that is NaN or implausible (`uavsim.onboard.plausible`) is a missing one, one
whose time stamp is not believed (`uavsim.onboard.stamps`) is left out, and after a step of the clock what is waited for
is still as far away as it was.

Sees readings and time, never truth. Scalar, constant memory.
"""

from dataclasses import dataclass
from math import isnan, nan, radians
from typing import Annotated, Any

from annotated_types import Interval

from uavsim import airdata
from uavsim.onboard.interface import Commands, Detector, Estimate, Estimator, News
from uavsim.onboard.plausible import LEAST_PRESSURE, LEAST_TEMPERATURE, MOST_PRESSURE, MOST_TEMPERATURE
from uavsim.onboard.rail_offset import RailOffset
from uavsim.onboard.readiness import Readiness
from uavsim.onboard.stamps import Stamps, jump
from uavsim.onboard.stroke import LONGEST_STEP, Stroke

STANDARD_GRAVITY = 9.80665  # m/s^2, ISO 80000-3
MOST_EVENTS = 10_000  # that are kept, then the oldest go; a flight has some ten


@dataclass(frozen=True, slots=True)
class FlightComputerSettings:
    """When to act, and how the cruise is held.

    Attributes
    ----------
    airspeed
        To hold, m/s.
    stroke_end_level_g
        The stroke is over when a short mean of f_x less its mean on the rail has stayed below this level, g, ...
    stroke_end_mean
        ... taken over this time, s, ...
    stroke_end_hold
        ... for this time, s.
    speed_gain_min
        Integral of f_x less its rail mean since detection that makes it a launch, m/s.
    rearm_delay
        After a detection that was none, s.
    wing_delay
        From the noticed end of the stroke to the command for the wings, s.
    motor_delay
        From that command to the motor, s.
    level_pitch_deg
        Pitch in level cruise, degrees.
    launch_pitch_deg
        Pitch from the rail until the airspeed is gained, degrees.
    climb_pitch_deg
        Greatest pitch in a climb, degrees.
    speed_margin
        Airspeed error from which on the launch's pitch is held, m/s.
    height
        Cruise height above the place of launch, m.
    height_gain
        Pitch for a height error, rad/m.
    throttle_level
        Throttle in level cruise, 0 ... 1.
    throttle_gain
        Throttle for an airspeed error, 1/(m/s).
    throttle_rate
        Throttle for an integrated airspeed error, 1/m.
    throttle_climb
        Throttle for pitch above level, 1/rad.
    safe_throttle
        Throttle in level flight while no airspeed is known, 0 ... 1.
    loss_time
        How long an estimate must have been invalid to be given up, and valid to be flown on again, s.
    rail_elevation_deg
        Elevation of the rail as the crew believes it, degrees; None: that of the launcher.
    rail_elevation_sd_deg
        Standard deviation of that, and of the roll, degrees.
    rail_roll_deg
        Roll of the aircraft on the rail as the crew believes it, degrees.
    """

    airspeed: Annotated[float, Interval(ge=10, le=280)] = 32.0
    stroke_end_level_g: Annotated[float, Interval(ge=0.1, le=10)] = 1.0
    stroke_end_mean: Annotated[float, Interval(ge=0.001, le=0.1)] = 0.010
    stroke_end_hold: Annotated[float, Interval(ge=0.001, le=0.5)] = 0.020
    speed_gain_min: Annotated[float, Interval(ge=0, le=100)] = 10.0
    rearm_delay: Annotated[float, Interval(ge=0, le=60)] = 1.0
    wing_delay: Annotated[float, Interval(ge=0, le=5)] = 0.10
    motor_delay: Annotated[float, Interval(ge=0, le=5)] = 0.25
    level_pitch_deg: Annotated[float, Interval(ge=-10, le=15)] = 0.0
    launch_pitch_deg: Annotated[float, Interval(ge=-10, le=30)] = 5.0
    climb_pitch_deg: Annotated[float, Interval(ge=-10, le=30)] = 3.0
    speed_margin: Annotated[float, Interval(ge=0.1, le=50)] = 3.0
    height: Annotated[float, Interval(ge=5, le=3000)] = 15.0
    height_gain: Annotated[float, Interval(ge=0, le=0.1)] = 0.006
    throttle_level: Annotated[float, Interval(ge=0, le=1)] = 0.6
    throttle_gain: Annotated[float, Interval(ge=0, le=1)] = 0.25
    throttle_rate: Annotated[float, Interval(ge=0, le=1)] = 0.05
    throttle_climb: Annotated[float, Interval(ge=0, le=10)] = 2.5
    safe_throttle: Annotated[float, Interval(ge=0, le=1)] = 0.7
    loss_time: Annotated[float, Interval(ge=0, le=10)] = 0.1
    rail_elevation_deg: Annotated[float, Interval(ge=-90, le=90)] | None = None
    rail_elevation_sd_deg: Annotated[float, Interval(ge=0.01, le=45)] = 0.5
    rail_roll_deg: Annotated[float, Interval(ge=-180, le=180)] = 0.0


def stroke_settings(settings: FlightComputerSettings) -> tuple[float, float, float]:
    """Level m/s², mean s and hold s of the end of the stroke."""
    return settings.stroke_end_level_g * STANDARD_GRAVITY, settings.stroke_end_mean, settings.stroke_end_hold


class FlightComputer:
    """One aircraft's computer.

    Parameters
    ----------
    settings
        See `FlightComputerSettings`.
    detector, estimator
        What it asks.
    accelerometer_rate
        Nominal output data rate, Hz; sets how many readings the short mean of f_x holds.
    axis
        Signed body axis that points along the launch; what is said of f_x holds for it.
    rail
        Finds the accelerometer's offset while the aircraft waits; None: nothing is taken off the readings.
    readiness
        Judges on the rail whether the sensors are fit for a launch; None: nothing is said of that.

    Attributes
    ----------
    state
        'waiting', 'stroke', 'rearming', 'coasting', 'wings' or 'flying'.
    commands
        The present commands; a new tuple whenever one changes.
    events
        What it noticed and did, each a dict with `t`, s, and `event`.
    """

    def __init__(
        self,
        settings: FlightComputerSettings,
        detector: Detector,
        estimator: Estimator,
        accelerometer_rate: float,
        axis: str = "+x",
        rail: RailOffset | None = None,
        readiness: Readiness | None = None,
    ) -> None:
        self.settings = settings
        self.detector = detector
        self.estimator = estimator
        self.state = "waiting"
        self.commands: Commands = (0.0, 0.0, radians(settings.launch_pitch_deg), 0.0, 0.0)
        self.events: list[dict[str, Any]] = []
        self._feel = estimator.accelerometer if estimator.aided else None
        self._news: News = estimator.news
        self._rail, self._readiness = rail, readiness
        self._doubts: tuple[str, ...] | None = None
        self._begun = nan
        self._offset = (0.0, 0.0, 0.0)
        self._axis = None if axis == "+x" else ("xyz".index(axis[1]), -1.0 if axis[0] == "-" else 1.0)
        self._stroke = Stroke(*stroke_settings(settings), accelerometer_rate)
        self._level_pitch = radians(settings.level_pitch_deg)
        self._lowest_pitch = 2.0 * self._level_pitch - radians(settings.climb_pitch_deg)
        self._t = nan
        self._stamps = Stamps(jump(accelerometer_rate))
        self._longest = self._stamps.longest
        self._next_action = 0.0
        self._reference_pressure: float | None = None
        self._throttle_integral = settings.throttle_level
        self._last_estimate = 0.0
        self._trusted = True
        self._changed_since: float | None = None
        self._temperature = nan
        self._height_known = True

    def accelerometer(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take one reading of specific force, m/s^2, body axes."""
        state, raw = self.state, fx
        if self._rail is not None:
            if state == "waiting":
                self._rest(t, fx, fy, fz)
            x, y, z = self._offset
            fx, fy, fz = fx - x, fy - y, fz - z
        if self._feel is not None:
            self._feel(t, fx, fy, fz)
        if state == "flying":
            return
        if not 0.0 < t - self._t <= self._longest:
            if not self._stamps.admit(t, self._t):
                return
            self._step_of_the_clock(t - self._t)
        self._t = t
        readiness = self._readiness
        if readiness is not None and state == "waiting":
            readiness.add(t, raw)
            if t >= readiness.due:
                self._look(t)
        along = fx if self._axis is None else self._axis[1] * (fx, fy, fz)[self._axis[0]]
        if state == "waiting":
            self._stroke.rest(t, along)
            if self.detector.step(t, fx, fy, fz):
                self._detected(t)
        elif state == "stroke":
            self._follow_stroke(t, along)
        elif t >= self._next_action:
            self._act(t)

    def _step_of_the_clock(self, step: float) -> None:
        """Move what is waited for, and what has been waited for, by a step, s; NaN before the first reading."""
        if isnan(step):
            return
        self._next_action += step
        self._stroke.step_of_the_clock(step)

    def air_data(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head, Pa and K; return the estimate that it leads to."""
        estimate = self.estimator.step(t, p_total, p_static, temperature, t_total, t_static)
        if estimate is None:
            return None
        if self._feel is not None:
            self._feel = self._tidy
        if self._news:
            self._report()
        if self._reference_pressure is None and LEAST_PRESSURE <= estimate[5] <= MOST_PRESSURE:
            self._reference_pressure = estimate[5]
        if self.state == "flying":
            self._hold(estimate, temperature)
        elif self.state == "waiting" and self._readiness is not None and t >= self._readiness.due:
            self._look(t)
        return estimate

    def _look(self, t: float) -> None:
        """Note whether all is ready for a launch, and why not, whenever that changes."""
        readiness = self._readiness
        assert readiness is not None
        if self._begun != self._begun:
            self._begun = t
        reasons = readiness.look(t, self.estimator.doubts(t), self._begun)
        if reasons is None or _alike(reasons, self._doubts):
            return
        self._doubts = reasons
        if reasons:
            self._note(t, "not_ready", reasons="; ".join(reasons))
        else:
            self._note(t, "ready")

    def _tidy(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take the reading after one of the head: there is time for what the estimator has put off."""
        self._feel = self.estimator.accelerometer
        self._feel(t, fx, fy, fz)
        self.estimator.tidy()

    def _report(self) -> None:
        """Note what the estimator has found of its sensors: what was flagged and what was taken back."""
        for t, event, channel, kind in self._news:
            if channel == "static":
                self._height_known = event == "airspeed_recovered"
            self._note(t, event, channel=channel, **({"kind": kind} if kind else {}))
        self._news.clear()

    def airborne(self, t: float) -> None:
        """Be told that the aircraft is in flight at `t`, s, without a launch that was recognised."""
        if self.state == "waiting":
            self._note(t, "in_flight")
            self.estimator.airborne(t)
            self.state, self._last_estimate = "flying", t

    # -- launch ------------------------------------------------------------------------------------------------------

    def _rest(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Look for the offset in a reading as it came; what has been found is taken off from here on."""
        rail = self._rail
        assert rail is not None
        if not 0.0 < t - self._t <= self._longest:  # before its stamp is believed
            return
        rail.add(t, fx, fy, fz)
        if rail.offset is not self._offset:
            self._offset = rail.offset
            if rail.odd is not None:
                along, lift, elevation = rail.odd
                rail.odd = None
                self._note(t, "accelerometer_offset", offset=along, lift_offset=lift, elevation_error_deg=elevation)

    def _detected(self, t: float) -> None:
        self._note(t, "launch_detected")
        if self._rail is not None and self._rail.found:
            self.estimator.rested(self._rail.offset, self._rail.sd)
        self.state = "stroke"
        self._stroke.begin(t)
        self.estimator.launched(t)

    def _follow_stroke(self, t: float, f: float) -> None:
        if self._stroke.follow(t, f):
            self._stroke_over(t)

    def _stroke_over(self, t: float) -> None:
        s = self.settings
        gained = self._stroke.speed_gain
        launched = gained >= s.speed_gain_min
        self._note(t, "stroke_end" if launched else "not_a_launch", speed_gain=gained)
        if launched:
            self.state, self._next_action = "coasting", t + s.wing_delay
            self._command(engaged=1.0)
        else:
            self.state, self._next_action = "rearming", t + s.rearm_delay
            self.estimator.rearmed(t)

    def _act(self, t: float) -> None:
        """Take the step that was waited for."""
        if self.state == "coasting":
            self._note(t, "wings_commanded")
            self._command(wing=1.0)
            self.estimator.unfolding(t)
            self.state, self._next_action = "wings", t + self.settings.motor_delay
        elif self.state == "wings":
            self._note(t, "motor_on")
            self._command(throttle=self.settings.throttle_level)
            self.estimator.throttle(t, self.settings.throttle_level)
            self.state, self._last_estimate = "flying", t
        else:
            self._note(t, "rearmed")
            if self._readiness is not None:
                self._readiness.forget()
            self._begun, self._doubts = nan, None
            self.detector.reset()
            self._stroke.rest_again()
            if self._rail is not None:
                self._rail.forget()
            self.state = "waiting"

    # -- cruise ------------------------------------------------------------------------------------------------------

    def _hold(self, estimate: Estimate, temperature: float) -> None:
        """Airspeed by throttle, height by pitch. Without a valid estimate both stay as they are until it is given up.

        A static pressure or temperature that is NaN or implausible leaves the height at what it was last.
        """
        t, airspeed, _, _, _, p_static, valid, _, _ = estimate
        dt = _within(t - self._last_estimate, 0.0, 10 * LONGEST_STEP)
        self._last_estimate = t
        if valid == self._trusted:
            self._changed_since = None
        else:
            self._doubt(t, valid)
        if LEAST_TEMPERATURE <= temperature <= MOST_TEMPERATURE:
            self._temperature = temperature
        if self._reference_pressure is None or isnan(self._temperature):
            return
        if not LEAST_PRESSURE <= p_static <= MOST_PRESSURE:
            return
        if self._trusted and not valid:
            return
        error = self.settings.airspeed - airspeed if self._trusted else 0.0
        pitch = self._level_pitch
        if self._height_known:
            height = airdata.hypsometric_height(p_static, self._reference_pressure, self._temperature)
            pitch = self._pitch(error, height)
        throttle = self._throttle(error, pitch, dt) if self._trusted else self._safe(pitch)
        wing, _, _, roll, engaged = self.commands
        self.commands = (wing, throttle, pitch, roll, engaged)
        self.estimator.throttle(t, throttle)

    def _doubt(self, t: float, valid: bool) -> None:
        """Give up an estimate that stays invalid; take it up again when it has stayed valid."""
        since = self._changed_since
        if since is None or t < since:  # at first, or after a step of the clock
            since = self._changed_since = t
        if t - since >= self.settings.loss_time:
            self._trusted, self._changed_since = valid, None
            self._note(t, "airspeed_back" if valid else "airspeed_lost")

    def _safe(self, pitch: float) -> float:
        """Throttle, 0 … 1, that keeps flying at a pitch command, rad, whatever the airspeed is."""
        s = self.settings
        return _within(s.safe_throttle + s.throttle_climb * (pitch - self._level_pitch), 0.0, 1.0)

    def _pitch(self, error: float, height: float) -> float:
        """Pitch command, rad, for an airspeed error, m/s, at a height, m."""
        s = self.settings
        lacking = _within(error / s.speed_margin, 0.0, 1.0)
        steepest = radians(s.climb_pitch_deg + (s.launch_pitch_deg - s.climb_pitch_deg) * lacking)
        return _within(self._level_pitch + s.height_gain * (s.height - height), self._lowest_pitch, steepest)

    def _throttle(self, error: float, pitch: float, dt: float) -> float:
        """Throttle, 0 … 1, for an airspeed error, m/s, and a pitch command, rad."""
        s = self.settings
        steady = self._throttle_integral + s.throttle_climb * (pitch - self._level_pitch)
        wanted = steady + s.throttle_gain * error
        throttle = _within(wanted, 0.0, 1.0)
        if throttle == wanted:  # against a stop the integral would only wind up
            self._throttle_integral += s.throttle_rate * error * dt
        return throttle

    def _command(
        self,
        wing: float | None = None,
        throttle: float | None = None,
        pitch: float | None = None,
        engaged: float | None = None,
    ) -> None:
        now = self.commands
        self.commands = (
            now[0] if wing is None else wing,
            now[1] if throttle is None else throttle,
            now[2] if pitch is None else pitch,
            now[3],
            now[4] if engaged is None else engaged,
        )

    def _note(self, t: float, event: str, **details: float | str) -> None:
        self.events.append({"t": t, "event": event, **details})
        if len(self.events) > MOST_EVENTS:
            del self.events[0]


def _alike(reasons: tuple[str, ...], others: tuple[str, ...] | None) -> bool:
    """Whether two rows of reasons name the same channels: numbers in them may change."""
    if others is None:
        return False
    return [reason.split(":")[0] for reason in reasons] == [reason.split(":")[0] for reason in others]


def _within(value: float, low: float, high: float) -> float:
    """Return `value` within its bounds; `high` counts where they cross."""
    if value < low:  # noqa: PLR1730 - calls of max and min cost thrice as much
        value = low
    return high if value > high else value
