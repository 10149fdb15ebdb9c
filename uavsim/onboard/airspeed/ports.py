"""The two ports in flight: what was read of them last, whether one is to blame, and what becomes of it.

Each port has its own watch (`watch`). What the filter has taken is kept here until the ports are judged, which waits
until the estimate has been told. A static port that is wrong makes the total pressure seem wrong, too. Which of the two
tests fires first is chance, so the rules below say which port is flagged:

* The total port's test has fired and the static port is suspect: the static port is flagged. Its own test goes by f_z
  alone, and a total pressure that is wrong does not move it.
* The total port's test has fired, and the static port's readings repeat themselves, or the total pressure moves and
  only does not fit: nothing is flagged yet.
* In still air, the total port seems shut and the static port is doubtful: it waits for the static port's test.
* Else the total port is flagged.
"""

from math import inf, nan

from uavsim.onboard.airspeed.air import SLOWEST, Air
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.interface import NoiseModel, reading_variances
from uavsim.onboard.airspeed.rail import rows_allowed
from uavsim.onboard.airspeed.settings import AidedSettings
from uavsim.onboard.airspeed.watch import StaticWatch, TotalWatch

# share of a static reading's variance that is left in the filter's own static pressure in steady flight. By hand: a
# twentieth is what the filter claims at 100 Hz and 3.7 Pa; what is left is no white noise
SMOOTHED = 0.1
MOST_NEWS = 64  # events that wait for somebody to take them out; then the oldest go, so that memory is constant
# static pressures in a row beyond the gate: no longer spikes, but a port or a filter that is wrong. By hand, as
# `stamps.AGREED`; docs/airspeed.md, "What no reading can do", holds the check
PERSISTENT = 5
# total pressures in a row beyond the gate, after which it may be a gust that has come at once, and V may be off by one.
# Without it the gate shut out a live port for as long as it took the filter's own gusts to reach it, 0.7 s, in which V
# was 2 m/s off and the port taken for one that drifts. By hand
SHUT_OUT = 5
# 1/s²: what V is off by without a static port, ½ a T² for each m/s of the gusts. A total pressure alone tells nothing
# of how V and p share it, but the filter's slopes are those of estimates that gusts have moved: it believes that it
# does, and where gusts are it ends far off. By hand; docs/faults.md, static-gusts, holds the check (7 … 18 m/s in
# 11 … 15 s)
RUNS_OFF = 0.1

News = tuple[float, str, str, str]
"""Time, s, event, channel and kind."""


class Ports:
    """Both ports of a flight.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of the air.
    air : Air
        Of the filter; it changes as the flight goes on.
    noise : NoiseModel
        What is believed of the sensors.

    Attributes
    ----------
    news : list of tuple
        What was flagged and taken back; whoever reads them clears the list.
    total, static : TotalWatch, StaticWatch
        The watch over each port.
    seen_total : tuple or None
        A total pressure that the filter has taken and nobody has judged yet: the channel as it was read
        (`difference`), the pressure tared, Pa, and its NIS.
    seen_static : tuple or None
        A static pressure so: Pa, its instant, s, and the mean of −f_z since the one before, m/s².
    misses, gated : int
        How many static and total pressures in a row were beyond the gate.
    between : float
        While nobody can tell whether the flagged total port or the accelerometer is wrong: the square of what lies
        between the two airspeeds, m²/s², which is in the bar; else 0.
    raw_static : float
        The last static pressure as it came, Pa: a sensor that repeats itself does so before anything is taken off.
    torn : bool
        Whether readings of specific force have been missing since the ports were judged last.
    """

    __slots__ = (
        "_aided",
        "_air",
        "_lift",
        "_noise",
        "_static_variance",
        "_total_variance",
        "between",
        "gated",
        "misses",
        "news",
        "raw_static",
        "seen_static",
        "seen_total",
        "static",
        "torn",
        "total",
    )  # fmt: skip

    def __init__(self, aided: AidedSettings, air: Air, noise: NoiseModel) -> None:
        self._aided, self._air, self._noise = aided, air, noise
        self._total_variance, self._static_variance = reading_variances(noise)
        self.news: list[News] = []
        self.begin()

    def believe(self, noise: NoiseModel, aided: AidedSettings) -> None:
        """Be told what is believed from the next `begin` on: the rail has shown the accelerometer's offset."""
        self._noise, self._aided = noise, aided

    def begin(self) -> None:
        """Believe both ports, and begin to watch them."""
        noise = self._noise
        white = noise.accelerometer_sd**2 / noise.accelerometer_rate
        offset, lift_offset = noise.accelerometer_offset_sd, noise.lift_offset_sd
        total, static = rows_allowed(noise)
        # a total pressure of a differential sensor is relative to the filter's static one, or to the static reading
        variance, row_variance = self._total_variance, self._total_variance
        if noise.differential:
            variance, row_variance = variance + SMOOTHED * self._static_variance, variance + self._static_variance
        self.total = TotalWatch(self._aided, variance, noise.walk, *total, offset, white, row_variance)
        self.static = StaticWatch(self._static_variance, noise.walk, *static, lift_offset)
        self._lift, self.misses, self.gated, self.torn, self.between = GRAVITY, 0, 0, False, 0.0
        self.raw_static = nan
        self.forget_seen()

    def forget_seen(self) -> None:
        """Judge nothing of what was read last."""
        self.seen_total: tuple[float, float, float] | None = None
        self.seen_static: tuple[float, float, float] | None = None

    def tell(self, t: float, event: str, channel: str, kind: str = "") -> None:
        """Put something into the news."""
        self.news.append((t, event, channel, kind))
        if len(self.news) > MOST_NEWS:
            del self.news[0]

    def give_up(self, t: float, kind: str) -> None:
        """Be told at `t`, s, that the filter has ended: flags of ports end with it."""
        self.forget_seen()
        self.tell(t, "airspeed_fault", "both", kind)
        for watch, channel in ((self.total, "total"), (self.static, "static")):
            if watch.faulty:
                self.tell(t, "airspeed_recovered", channel)

    def gate(self, energy: EnergyFilter) -> None:
        """Be told that a total pressure was beyond the gate: where that lasts, V may be off by a gust."""
        self.gated += 1
        if self.gated % SHUT_OUT == 0:
            energy.widen_speed(self._aided.gust_sd**2)

    def astray(self, t: float) -> float:
        """Return what V may be off by beside its variance at `t`, s, without a static port, m²/s²."""
        since = t - self.static.since
        off = 0.5 * RUNS_OFF * self._aided.gust_sd * since * since if since > 0.0 else 0.0
        return off * off

    # -- blame ---------------------------------------------------------------------------------------------------------

    def judge(self, t: float, energy: EnergyFilter, time: float, gained: float) -> None:
        """Judge what was seen last; `time`, s, and ∫ f_x dt, m/s, are the filter's, `t` that of the reading, s."""
        if self.torn:  # what the force has done to the pressures meanwhile is not known
            self.torn = False
            self.total.pause()
        if self.seen_static is not None:
            reading, at, lift = self.seen_static
            self.seen_static = None
            if lift == lift:
                self._lift = lift
            kind = self.static.take(at, reading, lift, (self._air.density, energy.v), self.raw_static)
            if kind or self.misses >= PERSISTENT:
                self._flag_static(t, energy, kind or "jump")
        if self.seen_total is not None:
            read, tared, nis = self.seen_total
            self.seen_total = None
            if self.static.faulty:
                return
            air = self._air
            kind = self.total.take(energy, time, gained, self._lift, read, tared, nis, air)
            if kind:
                self._blame(t, energy, (time, gained), kind)

    def jumped(self, t: float, energy: EnergyFilter, now: tuple[float, float], total: bool, static: bool) -> None:
        """Flag the port whose pressure has jumped and stays there; `now` as of `TotalWatch.flag`."""
        if static and not self.static.faulty:
            self._flag_static(t, energy, "jump")
        if total and not (self.total.faulty or self.static.faulty):
            self._flag_total(t, energy, now, "jump")

    def _blame(self, t: float, energy: EnergyFilter, now: tuple[float, float], kind: str) -> None:
        """Flag the port that is to blame for a total pressure in which something seems wrong; see the module."""
        if kind != "stuck" and self.static.suspect:
            self._flag_static(t, energy, "frozen")
        elif kind == "unfit" or self.static.repeating:
            return
        elif kind != "frozen" or not (self.static.doubtful and self.total.port.unsure):
            self._flag_total(t, energy, now, kind)

    def condemn(self, t: float, energy: EnergyFilter, now: tuple[float, float], channel: str, kind: str) -> None:
        """Flag a channel whose sensor is dead for certain; `now` as of `TotalWatch.flag`."""
        if channel == "total":
            if not self.total.faulty:
                self._flag_total(t, energy, now, kind)
        elif not self.static.faulty:
            self._flag_static(t, energy, kind)

    def dead_at_rest(self, t: float, energy: EnergyFilter, channel: str, kind: str, speed: tuple[float, float]) -> None:
        """Flag a sensor that the rail has shown to be dead; V, m/s, and its variance at the start of the launch."""
        if channel == "total":
            self.total.flag_in_stroke(energy, t, (0.0, inf), speed)
            self.tell(t, "airspeed_fault", channel, kind)
        elif channel == "static":
            self._flag_static(t, energy, kind)
        else:
            self.tell(t, "airspeed_fault", channel, kind)

    def never_moved(self, t: float, energy: EnergyFilter, rest: float, risen: float, density: float) -> None:
        """Flag a static port that has been shut since before the launch; `rest` and `risen` as of `FirstClimb`."""
        self.static.flag_at_rest(energy, t, (rest, self._static_variance), risen, density)
        energy.read_relative(False)
        self.misses = 0
        self.total.port.restart()
        self.tell(t, "airspeed_fault", "static", "frozen")

    def not_risen(self, t: float, energy: EnergyFilter, kind: str, speed: tuple[float, float]) -> None:
        """Flag a total port that has not risen in the stroke; V and its variance. What is shut in shows from now on."""
        self.total.flag_in_stroke(energy, t, (nan, self._total_variance), speed)
        self.tell(t, "airspeed_fault", "total", kind)
        if kind == "swapped" and not self.static.faulty and not self._noise.differential:
            self._flag_static(t, energy, kind)

    def _flag_total(self, t: float, energy: EnergyFilter, now: tuple[float, float], kind: str) -> None:
        self.total.flag(kind, energy, now, self._air.density, self._air.gust)
        self.tell(t, "airspeed_fault", "total", kind)

    def _flag_static(self, t: float, energy: EnergyFilter, kind: str) -> None:
        self.static.flag(kind, energy, t, self._air.density, self.total.lost)
        energy.read_relative(self._noise.differential and not self.static.shut)
        self.misses = 0
        self.total.port.restart()
        self.tell(t, "airspeed_fault", "static", kind)

    # -- the way back --------------------------------------------------------------------------------------------------

    def hear_total(
        self, t: float, energy: EnergyFilter, end: float, reading: float, tared: float, variance: float
    ) -> None:
        """Compare a flagged total port with the filter that coasts; take it back when they have agreed for long enough.

        Parameters
        ----------
        t : float
            Time of the reading, s.
        energy : EnergyFilter
            The filter that coasts.
        end : float
            End of the conversion, s.
        reading, tared, variance : float
            The channel as it came, and the pressure tared, Pa; the variance of its noise, Pa².
        """
        speed = self._air.speed(tared, energy.p)
        slope = self._air.density * (speed if speed > SLOWEST else SLOWEST)
        difference = speed - energy.v
        self.between = difference * difference if self.total.undecided else 0.0
        spread = energy.vv + (2.0 * variance + energy.pp) / (slope * slope)
        if self.total.coast(reading, tared, difference, spread, end):
            energy.widen_speed(difference * difference)
            self.between = 0.0
            self.tell(t, "airspeed_recovered", "total")

    def hear_static(self, t: float, energy: EnergyFilter, at: float, reading: float, difference: float) -> None:
        """Compare a flagged static port in the same way.

        Its reading of an instant, s, has nothing taken off by a speed, with which a shut one would seem to move; how
        far off it is, Pa, is of one that is freed of its position error.
        """
        if self.static.coast(at, self.raw_static, reading, difference, energy.pp + self._static_variance):
            energy.widen_static(difference * difference)
            energy.read_relative(self._noise.differential)
            self.tell(t, "airspeed_recovered", "static")
