"""What only a launch can test: that the total pressure rises, and that the static one falls.

At rest a port that is shut reads as a live one does. In the stroke the force says by how much the total pressure has to
rise (`stroke`), and in the first climb by how much the static one has to fall (`first_climb`). Both go by the speed
that the force has given since the launch, u = ∫ (f_x − f_x at rest) dt.
"""

from collections.abc import Iterable

from uavsim.onboard.airspeed.admission import Admission
from uavsim.onboard.airspeed.difference import Difference
from uavsim.onboard.airspeed.first_climb import FirstClimb
from uavsim.onboard.airspeed.interface import NoiseModel, reading_variances
from uavsim.onboard.airspeed.port_errors import PortErrors
from uavsim.onboard.airspeed.ports import Ports
from uavsim.onboard.airspeed.progress import Progress
from uavsim.onboard.airspeed.rest_wind import Row
from uavsim.onboard.airspeed.stroke import StrokeTest

# m/s, speed over the ground up to which a push has not begun: V may change by what is learned of the wind. By hand: a
# tenth of any launch's
BEGUN = 3.0


class LaunchTests:
    """Both tests of one launch.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of the sensors.
    wind_sd : float
        Standard deviation of the airspeed while nothing is measured, m/s.
    progress : Progress
        Where the filter stands.
    ports, errors : Ports, PortErrors
        Of the head.
    admission : Admission
        Has the pressures of both channels that were taken last.
    difference : Difference
        Of the head's total channel.

    Attributes
    ----------
    stroke, climb : StrokeTest, FirstClimb
    """

    __slots__ = (
        "_acceleration", "_acceleration_sd", "_base", "_difference", "_errors", "_ports", "_progress", "_rest_sd",
        "_scale_variance", "_sided", "_static", "_total", "_total_variance", "_turned", "_wind", "_wind_variance",
        "climb", "stroke",
    )  # fmt: skip

    def __init__(
        self,
        noise: NoiseModel,
        wind_sd: float,
        progress: Progress,
        *,
        ports: Ports,
        errors: PortErrors,
        admission: Admission,
        difference: Difference,
    ) -> None:
        self._progress, self._ports, self._errors = progress, ports, errors
        self._total, self._static, self._difference = admission.total, admission.static, difference
        self._acceleration, self._acceleration_sd = noise.acceleration, noise.acceleration_sd
        self._scale_variance, self._wind_variance = scale_variance(noise), wind_sd**2
        self._total_variance = reading_variances(noise)[0]
        self._turned = 0.0  # what α has turned of f_x since, m/s
        self.stroke, self.climb = StrokeTest(difference.differential), FirstClimb()
        self._base = (0.0, 0.0, 0.0)  # when the launch began, s, and ∫ f_x dt, m/s, and its variance by then
        self._rest_sd, self._wind, self._sided = 0.0, (0.0, 0.0), True

    def close(self) -> None:
        """Test nothing: the filter begins, and not on its rail."""
        self.stroke.open = self.climb.open = False
        self.climb.hidden = 0.0

    def begin(self, rest_sd: float) -> None:
        """Count the speed that the force gives from here on; how well f_x at rest is known, m/s²."""
        progress = self._progress
        self._base, self._rest_sd, self._turned = (progress.time, progress.u, progress.w), rest_sd, 0.0

    def begin_stroke(
        self, rows: Iterable[Row], tare_end: float, end: float, wind: tuple[float, float], *, sided: bool
    ) -> None:
        """Begin the test of the stroke.

        Parameters
        ----------
        rows, tare_end, end
            As of `StrokeTest.begin`, the rows as they came from the head.
        wind : tuple of float
            Along the launch, m/s, and its standard deviation.
        sided : bool
            Whether it is known from which side it comes.
        """
        self._wind, self._sided = wind, sided
        read, progress = Difference(self._difference.differential).read, self._progress
        self.stroke.begin(
            ((row[0], read(row[1], row[2]), *row[2:]) for row in rows),
            tare_end=tare_end,
            end=end,
            variance=self._total_variance,
            wind=wind,
            sided=sided,
            density=progress.energy.p / progress.air.gas,
        )

    def begin_climb(self, rows: Iterable[Row], end: float, noise: NoiseModel) -> None:
        """Begin to doubt the static port until it has left the pressure that the rows until `end`, s, have in them."""
        statics = sorted(row[2] for row in rows if row[5] <= end and row[2] == row[2])
        if statics:
            elevation = 0.0 if noise.rail_elevation is None else noise.rail_elevation
            self.climb.begin(statics[len(statics) // 2], noise.static_sd, elevation, noise.lift_offset_sd)

    def speed_gained(self) -> float:
        """Return what the force has given since the launch at the filter's instant, m/s, that at rest taken off."""
        begun, u, _ = self._base
        progress = self._progress
        return progress.u - u - progress.rest.mean * (progress.time - begun)

    def shut(self, reading: float) -> bool:
        """Judge by a total pressure, Pa, whether it rises in the stroke; flag the port if it does not."""
        pushed = self._progress.force
        kind = self.stroke.add(
            reading - self._acceleration * pushed,
            self._static.last,
            self.speed_gained(),
            self._acceleration_sd * pushed,
        )
        if kind:
            self._not_risen(kind)
        return bool(kind)

    def in_doubt(self, speed: float) -> float:
        """Return what a total port that may be shut adds to the variance of an airspeed that is told, m/s; m²/s²."""
        (along, sd), gained, wind = self._wind, self.speed_gained(), self._progress.wind
        off = wind.speed(gained + along) - speed
        square = off * off + sd * sd
        if not self._sided:
            other = wind.speed(gained - along) - speed
            square = max(square, other * other + sd * sd)
        return self.stroke.shut * square

    def _not_risen(self, kind: str) -> None:
        """Flag the total port in the stroke. What it has told of the wind is void, and V is what the force gave."""
        progress = self._progress
        progress.lose_wind()
        begun, _, w = self._base
        since, gained = progress.time - begun, self.speed_gained()
        rest = self._rest_sd * since
        variance = self._wind_variance + progress.w - w + rest * rest + self._scale_variance * gained * gained
        self._ports.not_risen(progress.t, progress.energy, kind, (gained, variance))

    def climbed(self, reading: float, dt: float) -> None:
        """Judge by a static pressure, Pa, a time, s, after the last, whether its port lives."""
        test, progress, ports = self.climb, self._progress, self._ports
        energy, density, ground = progress.energy, progress.air.density, self.speed_gained()
        lift = progress.lift
        if lift > 0.0 and dt > 0.0:  # what α turns of f_x is no climb: 2 m/s in 3 s of slow flight
            self._turned += lift * progress.angles.down(energy.v, density)[0] * dt
        if ports.total.faulty or ports.static.faulty:
            test.open, test.hidden = False, 0.0
        elif test.add(
            reading,
            dt,
            energy.v,
            progress.u - self._turned,
            density,
            progress.push_end.lasts or progress.wind.on or ground < BEGUN,
            ground=ground,
            position=self._errors.position,
            position_sd=2.0 * self._errors.speed_share,
            lift=lift,
        ):
            ports.never_moved(progress.t, energy, test.rest, test.risen, density)


def scale_variance(noise: NoiseModel) -> float:
    """Return the variance of f_x's scale error; half of a differential sensor's is as good as one of f_x."""
    return noise.accelerometer_scale_sd**2 + (0.5 * noise.difference_scale_sd) ** 2
