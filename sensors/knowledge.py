"""What anyone may believe of the readings who has the parts' descriptions and knows how they are set and mounted.

Plain frozen numbers, standard deviations where an error is meant. The drawn unit is left out, and so is what breaks. A
filter takes its model from here; what the simulator draws of the same descriptions is in the sensors. What no
description holds:

* Vibration averages over a reading of the integral as noise of its density in its band does: a variance of
  σ_v² (f_s/2)/(f₂ − f₁) a reading at the rate f_s.
* A tube of length L along the unit vector n, from the port to the sensor, holds a column of air that a specific force f
  presses on the sensor with −ρ L n·f.
* What a board heats itself by nobody has measured: it counts as a deviation of the thermometer.
* Of what the flow through a thermal differential part loses in the tubes a quarter is not known: two figures for where
  the flow bends, 59 and 101 Pa, are that far apart.
"""

from dataclasses import dataclass, replace
from math import exp, hypot, inf, sqrt

from sensors.accelerometer_description import AccelerometerDescription
from sensors.differential import hose, share_lost
from sensors.differential_description import DifferentialDescription
from sensors.mounting import attitude, product, transposed
from sensors.pneumatics import GAMMA, GAS_CONSTANT, STANDARD, laminar_lag
from sensors.port_calibration import CALIBRATED, CALIBRATED_SHARE, USUAL_MACH, WORDS, port_calibration
from sensors.pressure_description import PressureDescription
from sensors.probe import LIMITS, static_port, total_port
from sensors.settings import (
    AccelerometerSettings,
    AirDataSettings,
    ThermalSettings,
    TubeSettings,
    Vector,
    VibrationSettings,
)
from sensors.unit import G0, unit_vector

DENSITY = STANDARD["pressure"] / (GAS_CONSTANT * STANDARD["temperature"])  # kg/m³
WARMTH_SD = 15.0  # K, of a die about 25 °C beside its own heat: -20 … 70 °C are three of them
PLACE = 2e4  # Pa, between a place and where a part's accuracy is stated: 70 … 110 kPa are within one of them
LAPSE, CLIMB = 0.0065, 3.0  # K/m of the standard atmosphere; m/s, of an aircraft that climbs to its cruise
FLIGHT = 30.0  # s between tare and end for which a ramp of the temperature is covered by a random walk
TYPICAL = 600.0  # Pa, at which the share is taken that the tubes lose: 31 m/s at sea level
LOST_SD = 0.25  # of what they lose; see above
RECOVERY_SD = 0.1  # of a thermometer's recovery factor, which is read off a table
COLUMN_SD = 0.05  # share of the air column's pressure that is not known: the air's density at the place


@dataclass(frozen=True, slots=True)
class AccelerometerKnowledge:
    """What may be believed of a reading of the specific force f_x.

    Attributes
    ----------
    rate : float
        Readings a second, Hz.
    noise_sd : float
        White noise of one reading, vibration in flight included, m/s².
    scale_sd : float
        Scale error and what the temperature makes of it, a fraction.
    offset_sd, lift_offset_sd : float
        What f_x and f_z are off by at 1 g, constant in a flight or nearly so, m/s²: the part's offset, what temperature
        and a minute make of it, what vibration is rectified to, what of the 1 g a scale error, the cross-axis
        sensitivity and an error of the mounting bring into the axis, and the size of what `accelerometer.bias` adds.
    lag : float
        Age of a reading at its time stamp, s.
    side_offset_sd : float
        As `offset_sd`, of f_y.
    own_offset_sd, own_side_offset_sd, own_lift_offset_sd : float
        What the description of the part and its mounting allow of these, without the size of `accelerometer.bias`.
    wander_sd : float
        By how much an offset that was found at rest may have moved since, m/s².
    white_sd : float
        Noise of one reading of f_x by the part alone, without vibration, m/s²: a live part has at least that.
    step : float
        By which readings are rounded, m/s².
    range : float
        Greatest specific force of either sign that a reading can have, m/s²; infinite where readings do not end, or
        where the case is turned so that no body axis is one of its own.
    """

    rate: float
    noise_sd: float
    scale_sd: float
    offset_sd: float
    lift_offset_sd: float
    lag: float
    side_offset_sd: float
    own_offset_sd: float
    own_side_offset_sd: float
    own_lift_offset_sd: float
    wander_sd: float
    white_sd: float
    step: float
    range: float


@dataclass(frozen=True, slots=True)
class PressureKnowledge:
    """What may be believed of a reading of one of the head's pressures.

    Attributes
    ----------
    noise_sd : float
        White noise of one reading, Pa.
    window : float
        Length of the conversion that a reading is the mean over, s.
    lag : float
        Age of the pressure beside half of that, s: the part's digital filter, and the tube.
    walk : float
        What drift and random walk are together as a random walk, Pa/√s.
    column : float
        Pressure of the air column in the tube for specific force along body x, Pa/(m/s²).
    membrane_sd : float
        Sensitivity of the membrane to specific force along body x, Pa/(m/s²); 0 where it is not felt.
    low, high : float
        Where readings end, Pa; infinite where they do not.
    step : float
        By which they are rounded, Pa.
    offset_sd : float
        What a reading is off by at rest, Pa: turn-on offset, solder, temperature of the die, scale at a pressure
        `PLACE` away from that of the stated accuracy, and the size of `offset_pa`.
    """

    noise_sd: float
    window: float
    lag: float
    walk: float
    column: float
    membrane_sd: float
    low: float
    high: float
    step: float
    offset_sd: float


@dataclass(frozen=True, slots=True)
class DifferenceKnowledge:
    """What may be believed of a differential sensor beside what any pressure sensor has.

    Attributes
    ----------
    calibration_pressure : float
        Of a thermal part, as of `DifferentialDescription`, Pa; 0 of a membrane.
    flow, flow_pressure : float
        Of the air that flows through it, alike, kg/s and Pa.
    hose : float
        Σ L/d⁴ of the tubes, 1/m³.
    """

    calibration_pressure: float
    flow: float
    flow_pressure: float
    hose: float


@dataclass(frozen=True, slots=True)
class PortKnowledge:
    """What a calibration tells of both ports' errors, by the law of `sensors.probe`.

    Attributes
    ----------
    limit : float
        Angle at which the total port loses one hundredth, rad; infinite of one that loses nothing.
    error, error_alpha, error_alpha2, error_beta2, error_mach2 : float
        Coefficients of the static port; 0 where nothing is known but their size.
    total_slipstream, static_slipstream : float
        What the propeller adds at full throttle.
    position_sd, alpha_sd, alpha2_sd, beta2_sd, slipstream_sd : float
        Standard deviations of the coefficients: of `error` with `error_mach2`, of the three of the angles, and of both
        slipstreams as a share of them.
    exact : bool
        Whether the coefficients are those of the unit that flies: what a calibration in the simulation finds is drawn
        about them. Those of a file have their errors already.
    """

    limit: float
    error: float
    error_alpha: float
    error_alpha2: float
    error_beta2: float
    error_mach2: float
    total_slipstream: float
    static_slipstream: float
    position_sd: float
    alpha_sd: float
    alpha2_sd: float
    beta2_sd: float
    slipstream_sd: float
    exact: bool = False


@dataclass(frozen=True, slots=True)
class HeadKnowledge:
    """What may be believed of a reading of the air-data head.

    Attributes
    ----------
    rate : float
        Readings a second, Hz.
    total, static : PressureKnowledge
        The first is the differential sensor where the head has one: pressures are differences then.
    ports : PortKnowledge
    temperature_sd : float
        Of the temperature, K: noise, turn-on offset, and what the board is warmer than the air.
    die_lag : float
        With which the thermometer follows the air, s.
    temperature_white_sd, temperature_step, temperature_lag : float
        Noise of one reading, rounding included, K; by which it is rounded, K; the time constant of the digital filter
        behind it, s.
    column, column_sd : float
        Error of the pair's difference per specific force along body x by the air in the tubes, and how far that is
        unknown, Pa/(m/s²).
    walk : float
        Random walk of the pair's difference, Pa/√s: that of both parts, and what both dies make of a climb's and of
        their own warmth (`_warming`).
    thermometer_recovery, thermometer_recovery_sd : float
        Share of the flow's warming that the thermometer reads, and its standard deviation.
    difference_sd : float
        What the pair's difference may be at rest where no tare has found it, Pa.
    scale_sd : float
        Scale error of what flight adds to the difference, a fraction: a tare takes off what it makes at rest. Of a
        differential sensor with what is not known of its tubes' loss.
    difference : DifferenceKnowledge or None
        Of the differential sensor, in a head that has one.
    """

    rate: float
    total: PressureKnowledge
    static: PressureKnowledge
    ports: PortKnowledge
    temperature_sd: float
    temperature_white_sd: float
    temperature_step: float
    temperature_lag: float
    column: float
    column_sd: float
    walk: float
    thermometer_recovery: float
    thermometer_recovery_sd: float
    difference_sd: float
    die_lag: float
    scale_sd: float
    difference: DifferenceKnowledge | None = None


def known_of_accelerometer(settings: AccelerometerSettings, vibration: VibrationSettings) -> AccelerometerKnowledge:
    """Return what may be believed of an accelerometer on an airframe that shakes so."""
    part, shaking = settings.description(), settings.vibration_scale * vibration.flight_rms_g * G0
    warmer = hypot(WARMTH_SD, settings.thermal.self_heating)
    noise = hypot(*(share * sd for share, sd in zip(attitude(*settings.mounting_deg)[0], part.reading_sd, strict=True)))
    offset, side_offset, lift_offset = _offsets(settings, part, warmer, shaking, _added(settings))
    own, own_side, own_lift = _offsets(settings, part, warmer, shaking, (0.0, 0.0, 0.0))
    return AccelerometerKnowledge(
        rate=part.rate,
        noise_sd=hypot(noise, shaking * _share(vibration, part.rate)),
        scale_sd=part.gain_sd(warmer),
        offset_sd=offset,
        lift_offset_sd=lift_offset,
        lag=settings.delay + part.lag,
        side_offset_sd=side_offset,
        own_offset_sd=own,
        own_side_offset_sd=own_side,
        own_lift_offset_sd=own_lift,
        wander_sd=part.wander_sd(shaking=shaking),
        white_sd=noise,
        step=part.resolution,
        range=part.range if part.errors.saturation and _in_axes(settings.mounting_deg) else inf,
    )


def known_of_head(settings: AirDataSettings) -> HeadKnowledge:
    """Return what may be believed of an air-data head."""
    felt = settings.acceleration_sensitivity
    chosen = settings.sensors()
    parts = chosen[0].description(), chosen[1].description()
    warmer = hypot(WARMTH_SD, settings.thermal.self_heating)
    total, static = (
        replace(
            _known_of_pressure(part, tube, direction, normal if felt else None),
            offset_sd=hypot(_at_rest(part, warmer), sensor.offset_pa),
        )
        for part, sensor, (tube, direction), normal in zip(
            parts, chosen, settings.tubes(), settings.normals(), strict=True
        )
    )
    column = static.column - total.column
    thermometer = parts[1]
    difference = _known_of_difference(parts[0], settings) if isinstance(parts[0], DifferentialDescription) else None
    paired = parts if difference is None else parts[:1]  # those whose errors are in the difference
    return HeadKnowledge(
        rate=settings.rate,
        total=total,
        static=static,
        ports=_known_of_ports(settings),
        temperature_sd=hypot(
            thermometer.temperature_noise_sd, thermometer.temperature_offset_sd, settings.thermal.self_heating
        ),
        temperature_white_sd=thermometer.temperature_noise_sd,
        temperature_step=thermometer.temperature_step,
        temperature_lag=thermometer.lag,
        die_lag=settings.thermal.lag,
        column=column,
        column_sd=COLUMN_SD * abs(column),
        walk=hypot(*(part.walk for part in paired), *(_warming(part, settings.thermal) for part in paired)),
        thermometer_recovery=settings.thermometer_recovery,
        thermometer_recovery_sd=RECOVERY_SD if settings.thermometer_recovery > 0.0 else 0.0,
        difference_sd=hypot(total.offset_sd, static.offset_sd) if difference is None else total.offset_sd,
        scale_sd=_scale(parts[0], settings),
        difference=difference,
    )


def _scale(part: PressureDescription, settings: AirDataSettings) -> float:
    """Scale error of what flight adds to a head's difference; the static pressure hardly changes beside it."""
    if not isinstance(part, DifferentialDescription):
        return part.scale_sd
    return hypot(part.scale_sd, LOST_SD * share_lost(part, [tube for tube, _ in settings.tubes()], TYPICAL))


def _known_of_difference(part: DifferentialDescription, settings: AirDataSettings) -> DifferenceKnowledge:
    tubes = [tube for tube, _ in settings.tubes()]
    return DifferenceKnowledge(
        calibration_pressure=part.calibration_pressure,
        flow=part.flow,
        flow_pressure=part.flow_pressure,
        hose=hose(tubes) if part.flow > 0.0 else 0.0,
    )


def _known_of_ports(settings: AirDataSettings) -> PortKnowledge:
    """Return what is known of the ports' errors: of a unit that was calibrated, of a file, or their size alone."""
    if settings.calibration not in WORDS:
        return _read_of_ports(settings)
    s, total = settings.static_port, settings.total_port
    limit = LIMITS.get(total.probe, inf)
    if settings.calibration == "unit":
        ideal = total_port(total) is None and static_port(s) is None
        return PortKnowledge(
            limit=limit,
            error=s.error,
            error_alpha=s.error_alpha,
            error_alpha2=s.error_alpha2,
            error_beta2=s.error_beta2,
            error_mach2=s.error_mach2,
            total_slipstream=total.slipstream,
            static_slipstream=s.slipstream,
            position_sd=0.0 if ideal else CALIBRATED,
            alpha_sd=CALIBRATED_SHARE * abs(s.error_alpha),
            alpha2_sd=CALIBRATED_SHARE * abs(s.error_alpha2),
            beta2_sd=CALIBRATED_SHARE * abs(s.error_beta2),
            slipstream_sd=CALIBRATED_SHARE,
            exact=True,
        )
    mach2 = s.error_mach2 * USUAL_MACH**2
    return PortKnowledge(
        limit=limit,
        error=0.0,
        error_alpha=0.0,
        error_alpha2=0.0,
        error_beta2=0.0,
        error_mach2=0.0,
        total_slipstream=total.slipstream,
        static_slipstream=s.slipstream,
        position_sd=hypot(s.error, mach2),
        alpha_sd=abs(s.error_alpha),
        alpha2_sd=abs(s.error_alpha2),
        beta2_sd=abs(s.error_beta2),
        slipstream_sd=1.0,
    )


def _read_of_ports(settings: AirDataSettings) -> PortKnowledge:
    """Return what a calibration's file says of the ports' errors; of what it does not hold, the size alone."""
    found, total = port_calibration(settings.calibration), settings.total_port
    blown = found.slipstream or (total.slipstream, settings.static_port.slipstream, 1.0)
    return PortKnowledge(
        limit=LIMITS.get(total.probe, inf) if found.limit is None else found.limit,
        error=found.error,
        error_alpha=found.error_alpha,
        error_alpha2=found.error_alpha2,
        error_beta2=found.error_beta2,
        error_mach2=found.error_mach2,
        total_slipstream=blown[0],
        static_slipstream=blown[1],
        position_sd=found.position_sd,
        alpha_sd=found.alpha_sd,
        alpha2_sd=found.alpha2_sd,
        beta2_sd=found.beta2_sd,
        slipstream_sd=blown[2],
    )


def _known_of_pressure(
    part: PressureDescription, tube: TubeSettings, direction: Vector, normal: Vector | None
) -> PressureKnowledge:
    """Return what may be believed of one pressure; `normal` is None where the membrane feels nothing."""
    along = 0.0 if normal is None else unit_vector(normal, "normal of a membrane")[0]
    return PressureKnowledge(
        noise_sd=part.noise_sd,
        window=part.mode.conversion_time,
        lag=_lag(part, tube),
        walk=part.walk,
        column=DENSITY * tube.length * unit_vector(direction, "direction of a tube")[0],
        membrane_sd=abs(part.acceleration_sd * along),
        low=part.range[0] if part.errors.saturation else -inf,
        high=part.range[1] if part.errors.saturation else inf,
        step=part.resolution,
        offset_sd=0.0,
    )


def _at_rest(part: PressureDescription, warmer: float) -> float:
    """What a reading is off by at rest, Pa, of a die off 25 °C by so much, K: one standard deviation."""
    low, high = part.solder
    solder = hypot((high - low) / 6.0, 0.5 * (low + high))
    away = 0.0 if isinstance(part, DifferentialDescription) else PLACE  # at rest there is no difference
    return hypot(part.offset_sd, solder, part.offset_tc_sd * warmer, part.scale_sd * away, part.drift_sd)


def _warming(part: PressureDescription, thermal: ThermalSettings) -> float:
    """What a die's change of temperature makes of its offset, as a random walk, Pa/√s.

    The temperature coefficient times a rate of r K/s is a ramp, r t after the time t. A random walk of r √T is at least
    as wide until T. The rates are that of a climb through the standard atmosphere, and that at which the die still
    warms itself after it has been switched on.
    """
    own = thermal.self_heating / thermal.lag * exp(-thermal.powered_for / thermal.lag)
    until = min(thermal.lag, FLIGHT)
    return part.offset_tc_sd * hypot(LAPSE * CLIMB * sqrt(FLIGHT), own * sqrt(until))


def _lag(part: PressureDescription, tube: TubeSettings) -> float:
    """Age of a pressure beside half the conversion, s: digital filter and tube."""
    if tube.length == 0.0:
        return part.lag
    shape = {"length": tube.length, "diameter": tube.diameter, "volume": tube.volume}
    return part.lag + laminar_lag(**shape, **STANDARD, polytropic=GAMMA)


def _share(vibration: VibrationSettings, rate: float) -> float:
    """White noise a reading that stands for vibration of unit rms."""
    low, high = vibration.band_hz
    return sqrt(0.5 * rate / (high - low))


def _in_axes(mounting_deg: Vector) -> bool:
    """Whether each axis of the case is one of the body's, of either sign."""
    return all(abs(angle / 90.0 - round(angle / 90.0)) < 1e-9 for angle in mounting_deg)


def _added(settings: AccelerometerSettings) -> Vector:
    """Size of the offset beside that of the unit, m/s², in the case."""
    return settings.bias if isinstance(settings.bias, tuple) else (settings.bias,) * 3


def _offsets(
    settings: AccelerometerSettings, part: AccelerometerDescription, warmer: float, shaking: float, added: Vector
) -> tuple[float, ...]:
    """Standard deviations of the offsets along the body's axes at 1 g, m/s², of a die off 25 °C by so much, K."""
    mounting = attitude(*settings.mounting_deg)
    in_case = [
        hypot(part.offset_sd(i, warmer=warmer, shaking=shaking, down=down), added[i])
        for i, down in enumerate(mounting[2])  # the body's z axis in the case: along it there is 1 g
    ]
    turned = product(product(mounting, transposed(attitude(*settings.mounting_error_deg))), transposed(mounting))
    return tuple(
        hypot(*(share * sd for share, sd in zip(row, in_case, strict=True)), G0 * (seen[2] - level))
        for row, seen, level in zip(mounting, turned, (0.0, 0.0, 1.0), strict=True)
    )
