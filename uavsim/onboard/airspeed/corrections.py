"""What a pressure does to the filter: each corrects it at its own instant, freed of what is known of its error.

The filter stands at the middle of the last total pressure's conversion, less the lag of its tube: that is the instant
of which the reading is. A static pressure is of another instant, some milliseconds away. In those it moves by ρ V s Δt;
what else moves it is far below its noise. So it is compared across the difference.

**A differential sensor.** Its channel is Δp (`difference`), and the filter's total pressure is read relative to the
static one (`energy_model`). Where it reads Δp (1 + κ) all that it can say is V' = V (1 + κ/2), and V̇' is that by as
much. So the filter's airspeed is V', for which f_x has a scale error of κ/2 more, and σ_κ V/2 goes into what is told.
What the force would say of κ itself in the stroke, a third of its variance at the best, is not used. A static port that
is shut is shut for both sensors. Then Δp and the pressure that is shut in are together the total pressure.

**Push.** The specific force bends the membranes of the pressure sensors. The known part of that error is taken off.
What is not known of its coefficient is the state k until the flight is steady. The scale error of the accelerometer is
a bias that comes and goes with the push: when the mean force f changes, b gains the variance σ² |Δ(f²)|, σ being the
scale error's standard deviation.
"""

from math import nan

from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.difference import Difference
from uavsim.onboard.airspeed.energy_model import GATE
from uavsim.onboard.airspeed.interface import NoiseModel, reading_variances
from uavsim.onboard.airspeed.launch_checks import LaunchTests, scale_variance
from uavsim.onboard.airspeed.membrane_push import MembranePush
from uavsim.onboard.airspeed.onset import ONE_SIDED, Onset
from uavsim.onboard.airspeed.port_errors import PortErrors
from uavsim.onboard.airspeed.ports import PERSISTENT, Ports
from uavsim.onboard.airspeed.progress import Progress

# share of ρV², beside `sudden`, by which a total pressure may be below the static one, and still tell
# that the filter is wrong; a lower one is of no airspeed. By hand: four times what ports of a UAV are off by
NO_SPEED = 0.2
OLDEST = 0.05  # s by which a reading may be behind the filter; an older one is not taken
# s, two periods of a head at 100 Hz. Where a static pressure is so far ahead of the filter, total pressures have ceased
# to come, and the filter goes on without them
ALONE = 0.02


class Corrections:
    """Takes pressures into the filter.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of the sensors.
    progress : Progress
        Where the filter stands.
    ports, errors, tests : Ports, PortErrors, LaunchTests
        What is watched, taken off and tested.
    difference, onset : Difference, Onset
        Of the total channel.
    sudden : float
        How far a pressure may go at once, Pa.

    Attributes
    ----------
    tare : float
        What is taken off the total channel, Pa.
    fresh : float
        When a total pressure was taken last, s.
    """

    __slots__ = (
        "_acceleration", "_difference", "_differential", "_errors", "_onset", "_ports", "_progress", "_push",
        "_push_variance", "_scale_variance", "_static_age", "_static_variance", "_sudden", "_tests", "_total_age",
        "_total_variance", "fresh", "tare",
    )  # fmt: skip

    def __init__(
        self,
        noise: NoiseModel,
        progress: Progress,
        *,
        ports: Ports,
        errors: PortErrors,
        tests: LaunchTests,
        difference: Difference,
        onset: Onset,
        sudden: float,
    ) -> None:
        self._progress, self._ports, self._errors, self._tests = progress, ports, errors, tests
        self._difference, self._differential, self._onset = difference, noise.differential, onset
        self._total_age, self._static_age = noise.total_age, noise.static_age
        self._total_variance, self._static_variance = reading_variances(noise)
        self._scale_variance, self._sudden = scale_variance(noise), sudden
        self._acceleration = noise.acceleration
        self._push, self._push_variance = MembranePush(noise, progress.gained, progress.rest), 0.0
        self.tare, self.fresh = 0.0, 0.0

    def begin(self, start: float, tare: float) -> None:
        """Begin at an instant, s, with a tare, Pa."""
        self._push.forget()
        self._push_variance = 0.0
        self.tare, self.fresh = tare, start

    def take(
        self, p_total: float, p_static: float, t_total: float, t_static: float, new_total: bool, new_static: bool
    ) -> tuple[float, float]:
        """Take what is new of a reading of the head, its channels; return the normalised innovations squared."""
        nis_total = nis_static = nan
        progress, ports = self._progress, self._ports
        to, at = t_total - self._total_age, t_static - self._static_age
        if (
            new_total
            and new_static
            and to > progress.time > progress.steady_from
            and -OLDEST < to - at < OLDEST  # both are later than the filter, and of about the same instant
            and self._onset.settled
            and not ports.total.faulty
            and not ports.static.faulty
        ):
            return self._take_both(p_total, p_static, t_total, to, at)
        if new_total:
            progress.advance(to)
        elif new_static and at - progress.time > ALONE:
            progress.advance(at)
        if new_static:
            nis_static = self._take_static(p_static, at)
        if new_total:
            nis_total = self._take_total(p_total, t_total)
        return nis_total, nis_static

    def _take_both(self, p_total: float, p_static: float, t_total: float, to: float, at: float) -> tuple[float, float]:
        """What `Progress.advance`, `_take_static` and `_take_total` do, at once."""
        progress, errors = self._progress, self._errors
        energy, air, dt = progress.energy, progress.air, to - progress.time
        density = air.density
        progress.feel_shock(to)
        if energy.learns:
            energy.hold_difference()
        if energy.kk > 0.0:
            self._push_variance = energy.know_push()
        gained, variance = progress.go(to, dt)
        pushed = self._pushed(t_total)
        tared = p_total - self.tare - self._difference.zero - self._acceleration * pushed
        unknown = 0.0
        if errors.any:
            if progress.lift == progress.lift:
                progress.angles.lift = progress.lift
            above, off, unknown = errors.off(energy, to)
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
            air.heat,
        )
        ports = self._ports
        if nis_total <= GATE:
            self.fresh, ports.gated = progress.t, 0
        else:
            ports.gate(energy)
        ports.misses = 0 if nis_static <= GATE else ports.misses + 1
        ports.seen_static = p_static, at, progress.lift
        ports.seen_total = p_total, tared + energy.p if self._differential else tared, nis_total
        return nis_total, nis_static

    def _take_static(self, reading: float, at: float) -> float:
        progress, ports, errors = self._progress, self._ports, self._errors
        energy, wind, density, heat = progress.energy, progress.wind, progress.air.density, progress.air.heat
        ahead = progress.time - at
        if not -OLDEST < ahead < OLDEST:
            return nan
        noise, as_read = self._static_variance, reading
        if errors.any:
            if wind.on:
                noise += wind.unknown(energy.v, energy.p, heat)
            else:
                _, off, unknown = errors.off(energy, progress.time)
                reading, noise = reading - off, noise + unknown
        if ports.static.faulty:
            off_by = reading - energy.p - density * energy.v * ahead * energy.s
            ports.hear_static(progress.t, energy, at, as_read, off_by)
            return nan
        if wind.on:
            nis = wind.static(energy, reading, noise, density * energy.v * ahead, heat)
        else:
            nis = energy.static(reading, noise, density * energy.v * ahead)
        ports.misses = 0 if energy.taken else ports.misses + 1
        if progress.time > progress.steady_from:
            ports.seen_static = reading, at, progress.lift
        elif ports.misses >= PERSISTENT:  # these are no spikes, and it is too early for a fault: the filter is wrong
            energy.widen_static(energy.innovation * energy.innovation)
            energy.static(reading, noise, 0.0)
            ports.misses = 0
        return nis

    def _of_channel(self, channel: float) -> tuple[float, float, float]:
        """Return what the total channel says, Pa, the variance of its noise, Pa², and what it is relative to, Pa."""
        if not self._differential:
            return channel, self._total_variance, 0.0
        difference = channel - self._difference.zero
        if self._ports.static.shut:  # to both sensors: the pressure that is shut in and Δp are the total pressure
            return difference + self._difference.static, self._total_variance + self._static_variance, 0.0
        return difference, self._total_variance, self._progress.energy.p

    def _measure(self, tared: float, variance: float, pushed: float, relative: bool) -> float:
        """Correct the filter by a total pressure, Pa, of a variance, Pa²; on the rail it has the side wind in it."""
        energy, wind, heat = self._progress.energy, self._progress.wind, self._progress.air.heat
        if not wind.on:
            return energy.total(tared, variance, pushed, heat)
        if self._errors.any:
            variance += wind.unknown(energy.v, energy.p, heat)
        return wind.total(energy, tared, variance, pushed, heat, relative=relative)

    def _take_total(self, reading: float, end: float) -> float:
        progress, ports = self._progress, self._ports
        energy, air = progress.energy, progress.air
        behind = progress.time - (end - self._total_age)
        if behind > OLDEST:
            return nan
        if self._tests.stroke.open and self._tests.shut(reading):
            return nan
        read, (reading, each, base) = reading, self._of_channel(reading)
        onset = self._onset
        if not onset.settled and not onset.settle(energy, progress.time, reading - self.tare + base, air):
            return nan
        pushed = self._pushed(end)
        variance = each + pushed * pushed * self._push_variance
        if behind > 0.0:  # the filter has taken a later one: as if V had changed by the force and the gust alone
            slope = air.density * energy.v
            given = progress.u - progress.gained.at(progress.time - behind)[0]
            reading += slope * (given - behind * (energy.b + energy.s))
            variance += slope * slope * air.gust * abs(energy.v) * behind
        tared = reading - self.tare - self._acceleration * pushed
        if self._errors.any and not progress.wind.on:
            above, off, _ = self._errors.off(energy, progress.time)
            tared -= above - off if base else above
        if ports.total.faulty:
            ports.hear_total(progress.t, energy, end, read, tared + base, variance)
            return nan
        on_rail = progress.wind.on
        nis = self._measure(tared, variance, pushed, base > 0.0)
        if energy.taken:
            self.fresh, ports.gated = progress.t, 0
        else:
            ports.gate(energy)
        below = (0.0 if base else energy.p) - tared > NO_SPEED * air.density * energy.v * energy.v + self._sudden
        if not (energy.taken or below) and progress.time < progress.steady_from:  # too early for a fault: it is wrong
            slope = air.density * (energy.v if energy.v > SLOWEST else SLOWEST)
            energy.widen_speed((energy.innovation / slope) ** 2)
        if not on_rail and energy.v < 0.0 and energy.taken and energy.v * energy.v > ONE_SIDED * energy.vv:
            energy.restart(-energy.v, energy.vv)  # the pressure is that of −V, too, and an aircraft flies forward
        if progress.time > progress.steady_from and not ports.static.faulty:
            ports.seen_total = read, tared + (energy.p if base else 0.0), nis
        return nis

    def _pushed(self, end: float) -> float:
        """Specific force over the total pressure's conversion that ends then; a change of it widens b."""
        before = self._push.held
        pushed = self._push.over(end, self._progress.force)
        if pushed != before:
            widened = self._scale_variance * abs(pushed * pushed - before * before)
            self._progress.energy.widen_bias(widened)
            self._ports.total.jump(self._progress.time, widened)
        return pushed
