"""Which readings of the head count in flight: plausible values, no spikes, new conversions, sensors that speak.

A value at the end of a sensor's range, or beyond what is plausible, is a missing one. A pressure that no air can have
made is a spike (`spikes`). A conversion that is polled again is none (`uavsim.onboard.stamps`). A sensor of which
nothing that counts has been heard for a while is flagged, and taken back when it speaks again. Pressures come back by
themselves, when they agree (`readmission`).
"""

from math import inf, nan, sqrt

from uavsim.onboard.airspeed.die_warmth import DieWarmth
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.interface import NoiseModel, reading_variances
from uavsim.onboard.airspeed.measured import limits
from uavsim.onboard.airspeed.ports import Ports
from uavsim.onboard.airspeed.progress import Progress
from uavsim.onboard.airspeed.rail import pause
from uavsim.onboard.airspeed.spikes import JUMPED, Spikes
from uavsim.onboard.repeats import Row
from uavsim.onboard.stamps import Conversions

# by hand, all three; docs/airspeed.md, "What no reading can do", holds the check

# Pa, and standard deviations of a reading: the greater is how far a pressure may go at once. Beyond it, and the next, a
# reading is a spike and left out (`spikes`)
SUDDEN, SUDDEN_SD = 100.0, 15.0
# Pa/s that are granted beside: ρ V V̇ at 60 m/s and 40 m/s², or a dive at 250 m/s; in the stroke ρ V V̇ at 80 m/s and
# 500 m/s²
STEEP, STROKE = 3e3, 5e4

Counted = tuple[float, float, float, float, bool, bool, bool]
"""Total channel and static pressure, Pa, NaN if not measured; ends of both conversions, s, NaN if not new; whether each
pressure is new and no spike; whether both pressures and the temperature are such that an airspeed can be made of them
alone."""


class Admission:
    """Admits readings of the head.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of the sensors.
    longest : float
        s, beyond which a time stamp does not follow (`uavsim.onboard.stamps`).
    progress : Progress
        Where the filter stands.
    ports : Ports
        The watch over the two ports.
    warmth : Row
        How often the thermometer has repeated a number.

    Attributes
    ----------
    sudden : float
        How far a pressure may go at once, Pa.
    total, static : Spikes
        Of both channels.
    static_pause : float
        How long before the last static pressure the one before came, s.
    die : DieWarmth
        How far the thermometer is behind the air.
    muted : list of bool
        Whether nothing is heard of accelerometer and thermometer.
    """

    __slots__ = (
        "_coldest", "_heard", "_pause", "_ports", "_progress", "_static_ends", "_static_within", "_total_ends",
        "_total_within", "_warmed", "_warmest", "_warmth", "die", "muted", "static", "static_pause", "sudden", "total",
    )  # fmt: skip

    def __init__(self, noise: NoiseModel, longest: float, progress: Progress, ports: Ports, warmth: Row) -> None:
        self._progress, self._ports, self._warmth = progress, ports, warmth
        self._total_within, self._static_within, (self._coldest, self._warmest) = limits(noise)
        self._warmed, self.die = 0.2 * noise.thermometer_recovery, DieWarmth(noise.die_lag)
        self.sudden = max(SUDDEN, SUDDEN_SD * sqrt(max(reading_variances(noise))))
        self.total, self.static = Spikes(), Spikes()
        self._total_ends, self._static_ends = Conversions(longest), Conversions(longest)
        self._pause = pause(noise)
        self._heard, self.muted, self.static_pause = [-inf, -inf, -inf], [False, False], 0.0

    def begin(self, start: float) -> None:
        """Begin at an instant, s: all are heard."""
        self.total.forget()
        self.static.forget()
        self.die.forget()
        self._heard, self.muted = [start, start, start], [False, False]
        self.forget_ends()

    def forget_ends(self) -> None:
        """Take the next conversions for new."""
        self._total_ends.forget()
        self._static_ends.forget()

    def mute_thermometer(self) -> None:
        """Be told that the rail has shown it to be dead."""
        self.muted[1], self._heard[2] = True, -inf

    def alone(self, channel: float, p_static: float, elapsed: float) -> tuple[int, int]:
        """Return what `Spikes.take` says of both pressures, Pa, a time, s, after the last, where no filter runs."""
        most = self._pause
        reach = self.sudden + STEEP * (most if elapsed > most else max(elapsed, 0.0))
        return self.total.take(channel, reach), self.static.take(p_static, reach)

    def take(
        self,
        t: float,
        before: float,
        channel: float,
        p_static: float,
        temperature: float,
        t_total: float,
        t_static: float,
    ) -> Counted:
        """Return what counts of a reading at `t`, s, the last one being of `before`; the air is told of it."""
        progress = self._progress
        energy, air, steady = progress.energy, progress.air, progress.time > progress.steady_from
        heard, given = self._heard, (channel, p_static, temperature)
        if not progress.wind.on:
            self.die.add(energy.v * energy.s / GRAVITY, t - before)
        if self._coldest <= temperature <= self._warmest:
            if self._warmed > 0.0:
                temperature /= 1.0 + 5.0 * self._warmed * energy.v * energy.v / air.heat
            temperature += self.die.behind
            if temperature != air.temperature:
                air.warm(temperature)
            air.measured = True
            heard[2] = heard[2] if self._warmth.stuck else t
        else:
            temperature = nan
        air.at(energy.p, energy.s)
        low, high = self._total_within
        if not low < channel < high:
            channel = nan
        low, high = self._static_within
        if not low < p_static < high:
            p_static = nan
        reach = self.sudden + (STEEP if steady else STROKE) * (t - before)
        total, static = self.total.take(channel, reach), self.static.take(p_static, reach)
        if steady and (total == JUMPED or static == JUMPED):  # noqa: PLR1714 - no tuple for each reading
            self._ports.jumped(t, energy, progress.now, total == JUMPED, static == JUMPED)
        end_total, end_static = self._total_ends.new(t_total, t), self._static_ends.new(t_static, t)
        self._warmth.add(given[2] if end_static == end_static else nan)
        new_total, new_static = end_total == end_total and total > 0, end_static == end_static and static > 0
        if new_total:
            heard[0] = t
        if new_static:
            self.static_pause = t - heard[1]
            heard[1], self._ports.raw_static = t, p_static
        late = t - self._pause
        silent = progress.gained.newest < late or heard[0] < late or heard[1] < late or heard[2] < late
        if silent or self.muted[0] or self.muted[1]:
            self._listen(t, late, given, (end_total, end_static))
        whole = total > 0 and static > 0 and temperature > 0.0
        return channel, p_static, end_total, end_static, new_total, new_static, whole

    def _listen(self, t: float, late: float, given: tuple[float, ...], ends: tuple[float, ...]) -> None:
        """Flag a sensor of which nothing has been heard since `late`, s, and take back one that speaks again."""
        ports, progress = self._ports, self._progress
        for channel, heard, value, end in zip(("total", "static"), self._heard, given, ends, strict=False):
            if heard < late:
                kind = "silent" if end != end else "range" if value == value else "invalid"
                ports.condemn(t, progress.energy, progress.now, channel, kind)
        warmth = force = ""
        if self._heard[2] < late:
            warmth = "stuck" if self._warmth.stuck else "range" if given[2] == given[2] else "invalid"
        if progress.gained.newest < late:
            force = "stuck" if progress.gained.stuck else "silent"
        for i, (channel, kind) in enumerate((("accelerometer", force), ("thermometer", warmth))):
            if bool(kind) != self.muted[i]:
                self.muted[i] = bool(kind)
                ports.tell(t, "airspeed_fault" if kind else "airspeed_recovered", channel, kind)
