"""What is told of the airspeed: the filter predicted to the time of a reading, its standard deviation, its validity.

The filter stands some milliseconds before the reading. With ∫ f_x dt since then V is foretold, and its variance is that
of the filter and of what moved V meanwhile, and

    σ² += (V σ_T/(2 T))² + (V σ_p/(2 p))² + (V e/2)² + (V σ_κ/2)² + …

of the temperature and the static pressure, which make the density, of the ports' errors, a share e of the impact
pressure, and of a differential sensor's scale error κ. No reading tells the filter of these.

**Valid** is an airspeed from 8 σ_V on. That is 2 V* of the pressures' law (`paper`), and it also holds while coasting.
"""

from math import sqrt

from uavsim.onboard.airspeed.air import SLOWEST
from uavsim.onboard.airspeed.corrections import Corrections
from uavsim.onboard.airspeed.die_warmth import DOUBT, DieWarmth
from uavsim.onboard.airspeed.energy_model import isentropic
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.launch_checks import LaunchTests
from uavsim.onboard.airspeed.paper import TRANSONIC
from uavsim.onboard.airspeed.port_errors import PortErrors
from uavsim.onboard.airspeed.ports import Ports
from uavsim.onboard.airspeed.progress import Progress
from uavsim.onboard.interface import Estimate

VALID = 8.0  # σ_V from which on an airspeed is valid: 2 V* of the pressures' law (`paper`)
# m/s, σ_V up to which an airspeed that coasts is valid, whatever the reason, a flag, silence, NaN, a range's end;
# beyond it the airspeed hold falls back to a safe throttle. By hand; docs/faults.md says how long that lasts
COASTED = 2.0
FRESH = 0.2  # s since a total pressure was taken, up to which the airspeed does not coast. By hand
LAW_ENDS = 0.2 * TRANSONIC**2  # V² over 7 R T, beyond which no airspeed is valid: a² = 0.2 · 7 R T


class Told:
    """Tells the filter's airspeed at the time of a reading.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of the sensors.
    fastest : float
        The greatest airspeed that the aircraft can have, m/s.
    progress : Progress
        Where the filter stands.
    corrections, errors, tests, ports : Corrections, PortErrors, LaunchTests, Ports
        What else is in doubt.
    die : DieWarmth
        How far the thermometer is behind the air.
    """

    __slots__ = (
        "_climb", "_corrections", "_die", "_differential", "_errors", "_fastest", "_ports", "_progress", "_scale_share",
        "_static_share", "_stroke", "_temperature_share", "_tests", "_warmed_share",
    )  # fmt: skip

    def __init__(
        self,
        noise: NoiseModel,
        fastest: float,
        progress: Progress,
        *,
        corrections: Corrections,
        errors: PortErrors,
        tests: LaunchTests,
        die: DieWarmth,
        ports: Ports,
    ) -> None:
        self._progress, self._corrections, self._errors = progress, corrections, errors
        self._tests, self._ports, self._fastest = tests, ports, fastest
        self._die, self._climb, self._stroke = die, tests.climb, tests.stroke
        self._differential, self._scale_share = noise.differential, 0.5 * noise.difference_scale_sd
        self._temperature_share, self._static_share = 0.5 * noise.temperature_sd, 0.5 * noise.static_offset_sd
        self._warmed_share = 0.5 * noise.thermometer_recovery_sd

    def tell(self, t: float, raw: float, nis_total: float, nis_static: float) -> Estimate:
        """Predict to the time of the reading, s, and say what is known; `raw` is the airspeed without a filter, m/s."""
        progress, ports = self._progress, self._ports
        energy, air, wind, time = progress.energy, progress.air, progress.wind, progress.time
        dt = t - time
        if dt > 0.0:
            u, w = progress.gained.at(t)
            if w < progress.w:  # noqa: PLR1730 - as in `Progress.go`, and a call of max costs a tenth of a microsecond
                w = progress.w
        else:
            dt, u, w = 0.0, progress.u, progress.w
        speed, variance, static = energy.foretell(dt, u - progress.u, air.density)
        if wind.on:
            speed, variance = wind.told(speed, variance)
        variance += air.gust * (energy.v if energy.v > SLOWEST else SLOWEST) * dt + w - progress.w
        if time < progress.unfolding.end:
            variance += progress.unfolding.variance(time, t)
        if speed < 0.0:  # noqa: PLR1730
            speed = 0.0
        hidden = self._climb.hidden
        if hidden > 0.0:
            hidden /= air.density * (speed if speed > SLOWEST else SLOWEST)
            variance += hidden * hidden
        variance += self._tests.in_doubt(speed) if self._stroke.open else 0.0
        variance += ports.between
        lone = ports.static.faulty and (ports.static.shut or not self._differential)
        if lone:
            variance += ports.astray(t)
        warm = self._temperature_share * speed / air.temperature
        behind = 0.5 * DOUBT * self._die.behind * speed / air.temperature
        square = warm * warm + behind * behind
        if self._static_share > 0.0:
            dense = self._static_share * speed / static
            square += dense * dense
        if self._errors.any:
            position = self._errors.speed_share * speed
            if wind.on and speed > SLOWEST:
                position = sqrt(wind.unknown(energy.v, static, air.heat)) / (air.density * speed)
            square += position * position
        warmed = self._warmed_share * speed * speed / air.heat * speed
        square += warmed * warmed
        scale = self._scale_share * speed
        sd = sqrt((0.0 if variance < 0.0 else variance) + square + scale * scale)
        total = isentropic(speed, static, air.heat)
        valid = (
            VALID * sd <= speed <= self._fastest
            and speed * speed <= LAW_ENDS * air.heat
            and air.measured
            and (sd < COASTED or (t - self._corrections.fresh < FRESH and not ports.total.faulty))
            # without it V and the climb are hardly told apart, but for a difference that has been read
            and not lone
        )
        return t, speed, sd, raw, total, static, valid, nis_total, nis_static
