"""How the energy-rate filter begins: before a launch on the rail, or in flight.

A launch is recognised tens of milliseconds late; at 10 g and 30 ms the airspeed is then 2.9 m/s. So the energy-rate
filter (`energy`) starts before the launch, in the readings that were kept, with V = 0, or with the wind that was seen
on the rail, and the standard deviation of that. `onset` says from when on a total pressure is taken.

If force or pressures at the start are not those of an aircraft at rest, the filter begins in flight: V by the next
total pressure, climb and bias not known. So it does after a step of a clock.
"""

from collections import deque
from dataclasses import dataclass
from math import hypot, inf, sqrt

from uavsim import airdata
from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.interface import NoiseModel, pair_variance, reading_variances
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.onset import Onset
from uavsim.onboard.airspeed.progress import Progress
from uavsim.onboard.airspeed.rail_wind import AGO
from uavsim.onboard.airspeed.rest_wind import Row, rest_difference
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.plausible import LEAST_PRESSURE, MOST_PRESSURE

ROWS = 256  # readings of the head that are kept: those of 0.3 s at up to 850 Hz
# Pa, standard deviation of the static pressure at the start, where none has been read (3 km of height) and where one
# has. By hand: so wide that the first readings in the filter decide
ANYWHERE, AROUND = 3e4, 1e3
THINNEST, THICKEST = 1e3, 2e5  # Pa of the static pressure in flight: that at 31 km, and twice that at the sea

# s, and readings of the head, from the start on, by which it is judged whether the aircraft rests on its rail. By hand
AT_FIRST, FIRST_ROWS = 0.05, 5
IN_PUSH = 30.0  # m/s², mean force at the start of a replay that is a push: three times what any rest has. By hand
STORM = 25.0  # m/s, a wind beyond which nobody launches: 12 Beaufort are 33
UNLIKELY = 5.0  # standard deviations of the pair's difference beside it


@dataclass(frozen=True, slots=True)
class Beginning:
    """A filter that begins.

    Attributes
    ----------
    energy : EnergyFilter
    tare : float
        What is to be taken off the total channel, Pa.
    wind : tuple of float
        Along the launch, m/s, and its standard deviation.
    rest_sd : float
        How well f_x at rest is known, m/s².
    """

    energy: EnergyFilter
    tare: float
    wind: tuple[float, float] = (0.0, 0.0)
    rest_sd: float = 0.0


class HandOver:
    """Begins the filter of a flight by what has been read on the rail.

    Parameters
    ----------
    core : type
        Of the filter.
    noise : NoiseModel
        What is believed of the sensors.
    settings : EstimatorSettings
        What is believed of air and aircraft.
    tare_end : float
        When the cover comes off, s; −inf without one.
    waiting : JumpAdaptive
        The filters of the pressures alone.
    progress : Progress
        Where the filter will stand.
    onset : Onset
        Of the airspeed by pressures.
    total_age : float
        From a total pressure's instant to the end of its conversion, s.

    Attributes
    ----------
    rows : deque of tuple
        The last readings of the head.
    """

    __slots__ = (
        "_aided", "_core", "_noise", "_onset", "_pair_variance", "_progress", "_row_variance", "_tare_end",
        "_total_age", "_waiting", "_wind_known", "_wind_sd", "rows",
    )  # fmt: skip

    def __init__(
        self,
        core: type[EnergyFilter],
        noise: NoiseModel,
        settings: EstimatorSettings,
        tare_end: float,
        *,
        waiting: JumpAdaptive,
        progress: Progress,
        onset: Onset,
        total_age: float,
    ) -> None:
        self._core, self._wind_sd, self._tare_end = core, settings.wind_sd, tare_end
        self.believe(noise, settings)
        self._waiting, self._progress, self._onset, self._total_age = waiting, progress, onset, total_age
        self._pair_variance, self._row_variance = pair_variance(noise), sum(reading_variances(noise))
        self._wind_known = progress.wind.declared or tare_end == -inf
        self.rows: deque[Row] = deque(maxlen=ROWS)

    def believe(self, noise: NoiseModel, settings: EstimatorSettings) -> None:
        """Be told what is believed from now on: the rail has shown the accelerometer's offset."""
        self._noise, self._aided = noise, settings.aided

    # -- on the rail -------------------------------------------------------------------------------------------------

    def on_rail(self, start: float) -> Beginning:
        """Make the filter of a launch, which starts on the rail at an instant, s."""
        progress = self._progress
        static = self._waiting.static.value
        known = LEAST_PRESSURE <= static <= MOST_PRESSURE
        tare, tare_variance = self._waiting.tare()
        progress.air.begin(self._waiting.temperature)
        progress.unfolding.forget()
        if not tare_variance > 0.0:
            tare_variance = self._noise.difference_sd**2  # nobody has tared the pair
        rest = progress.rest.result(start)
        at, density = (static, static / progress.air.gas) if known else (airdata.STANDARD_PRESSURE, 0.0)
        tied = 0.0
        if self._wind_known:
            along, along_sd, off, tare_variance, tied = self._look_at_wind(start, at, density, (tare, tare_variance))
        else:
            progress.wind.forget()
            off, along_sd = tare, self._onset.look(self._at_rest(start), (tare, tare_variance), density)
            along = self._onset.wind
        energy = self._begin(
            speed=(along, along_sd),
            rest=rest,
            static=(at, AROUND if known else ANYWHERE),
            difference_sd=sqrt(tare_variance),
        )
        energy.tie_difference(tied)
        return Beginning(energy, off, (along, along_sd), rest[1])

    def _at_rest(self, end: float, longest: float = inf) -> tuple[float, float] | None:
        """Return the pair's mean difference at rest in the last seconds until `end`, and its variance."""
        begun = max(self._tare_end, end - longest)
        return rest_difference(self.rows, start=begun, end=end, each=self._pair_variance)

    def _look_at_wind(
        self, start: float, static: float, density: float, tare: tuple[float, float]
    ) -> tuple[float, float, float, float, float]:
        """Return u₀, its standard deviation, the tare, the variance of d and their covariance; see `rail_wind`."""
        progress, noise = self._progress, self._noise
        air, wind = progress.air, progress.wind
        self._onset.know()
        tared = noise.covered and self._tare_end > -inf
        # A gust of the tare is over when the aircraft is launched. What is read last has the wind in it that the filter
        # begins in, so that the errors of both go together
        seen = self._at_rest(start, 2.0 * AGO)
        if tared and seen is not None:
            seen = seen[0] - tare[0], seen[1] + tare[1]
        elif not tared and self._tare_end > -inf and seen is None:
            seen = self._waiting.tare()
            seen = seen if seen[1] > 0.0 else None
        gusts = air.gust * max(wind.speed_declared, SLOWEST) * AGO
        along, sd, off, variance, tied = wind.begin(seen, tared=tared, air=(static, air.heat, gusts), density=density)
        if tared or seen is None:
            return along, sd, *tare, tied
        return along, sd, off, variance + noise.walk**2 * AGO, tied

    # -- in flight ---------------------------------------------------------------------------------------------------

    def is_aloft(self, start: float) -> bool:
        """Whether force or pressures at the start are not those of an aircraft that rests on its rail.

        The force is in a push already, or the pair's difference is more than any wind, and what is not known of its
        tare, can make. A launch that is told with no reading before it has the benefit of the doubt.
        """
        gained = self._progress.gained
        u, _ = gained.at(start)
        if gained.newest - start > AT_FIRST:
            pushed = (gained.at(start + AT_FIRST)[0] - u) / AT_FIRST
        elif gained.newest > start:
            pushed = (gained.at(gained.newest)[0] - u) / (gained.newest - start)
        else:
            pushed = 0.0
        if pushed > IN_PUSH:
            return True
        first = [row for row in self.rows if row[4] - self._total_age > start - AT_FIRST][:FIRST_ROWS]
        found = [row[1] - row[2] for row in first if row[1] == row[1] and row[2] == row[2]]
        static = self._waiting.static.value
        if not (found and LEAST_PRESSURE <= static <= MOST_PRESSURE):
            return False
        tare, variance = self._waiting.tare()
        spread = sqrt(self._row_variance / len(found) + (variance or self._noise.difference_sd**2))
        excess = sum(found) / len(found) - tare
        wind = hypot(STORM, self._progress.wind.speed_declared)
        return excess > 0.5 * static / self._progress.air.gas * wind * wind + UNLIKELY * spread

    def aloft(self, before: float) -> Beginning:
        """Begin in flight, or in a push; the static pressure was `before`, Pa, as the last filter had it."""
        static = self._waiting.static.value
        if not LEAST_PRESSURE <= static <= MOST_PRESSURE:
            static = before
        tare, variance = self._waiting.tare()
        progress, aided = self._progress, self._aided
        progress.air.begin(self._waiting.temperature)
        energy = self._begin(
            speed=(0.0, self._wind_sd),
            rest=(0.0, 0.0),
            static=(static if THINNEST < static < THICKEST else airdata.STANDARD_PRESSURE, ANYWHERE),
            difference_sd=sqrt(variance) if variance > 0.0 else self._noise.difference_sd,
        )
        energy.leave_rail(0.5 * aided.slope_rate**2 * aided.slope_time)
        progress.wind.forget()
        self._onset.know()
        progress.unfolding.forget()
        progress.rest.mean = 0.0
        return Beginning(energy, tare)

    def _begin(
        self, speed: tuple[float, float], rest: tuple[float, float], static: tuple[float, float], difference_sd: float
    ) -> EnergyFilter:
        """Make a filter; airspeed, what f_x reads at rest, and static pressure each with its standard deviation."""
        aided, noise, progress = self._aided, self._noise, self._progress
        energy = self._core(
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
            relative=noise.differential,
        )
        progress.energy = energy
        progress.air.ground = energy.p
        progress.angles.forget()
        return energy
