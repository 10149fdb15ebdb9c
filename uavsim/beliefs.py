"""What the estimator believes of its sensors and of the air.

Numbers of the same descriptions that the simulated units are drawn from, through the scenario's `[mismatch]`: this
module alone copies them from the one into the settings of the other. What no description holds:

* Vibration averages over a reading of the integral as noise of its density in its band does: a variance of
  σ_v² (f_s/2)/(f₂ − f₁) a reading at the rate f_s.
* A drift of standard deviation σ and correlation time τ wanders at first as a random walk of density 2σ²/τ.
* A tube of length L along the unit vector n, from the port to the sensor, holds a column of air that a specific force f
  presses on the sensor with −ρ L n·f.
* A membrane's sensitivity has been calibrated, with an error that is a share of what is usual for the part.
* An aircraft is never faster than four times the airspeed that it is to hold; a rig is as fast as sound, and what is
  felt on it is bounded by the part alone.
* Turbulence as MIL-F-8785C has it at low altitude, h and lengths in feet: σ_w = 0.1 W₂₀,
  σ_u = σ_w/(0.177 + 0.000823 h)^0.4, L_u = h/(0.177 + 0.000823 h)^1.2; it is flown through at the height of cruise.
"""

from dataclasses import replace
from math import hypot, pi, sqrt

from sensors import Streams
from sensors.accelerometer_description import AccelerometerDescription
from sensors.pneumatics import laminar_lag
from sensors.pressure_description import PressureDescription
from sensors.settings import AirDataSettings, PressureSettings, TubeSettings
from sensors.unit import G0, draw_error, unit_vector
from uavsim.airdata import GAS_CONSTANT_DRY_AIR, STANDARD_PRESSURE, STANDARD_TEMPERATURE
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel
from uavsim.onboard.plausible import FASTEST, MOST_FLIGHT_FORCE, MOST_FORCE
from uavsim.scenario import Scenario

FASTER = 4.0  # times the airspeed that is held: 128 m/s for 32, which no dive of such an aircraft reaches
FOOT = 0.3048  # m, ISO 80000-3
LOWEST, HIGHEST = 10.0, 1000.0  # ft, between which the law of low altitude holds
DENSITY = STANDARD_PRESSURE / (GAS_CONSTANT_DRY_AIR * STANDARD_TEMPERATURE)  # kg/m³
COLUMN_SD = 0.05  # share of the air column's pressure that is not known: the air's density at the place
AFT, DOWN, FORWARD = (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)  # as `sensors.head` has them


def calibrated(scenario: Scenario, streams: Streams) -> tuple[float, float]:
    """What a calibration found of the two membranes' sensitivity along body x, Pa/(m/s²); total, static.

    It is done on the units that fly, with an error of its own.
    """
    air, share = scenario.air_data, scenario.mismatch.acceleration_calibration
    found = []
    for part, normal, name in ((air.total, FORWARD, "total"), (air.static, DOWN, "static")):
        d = part.description()
        true = draw_error(streams(f"air_data.{name}.acceleration"), d.acceleration_sd, d.acceleration_limit, part.unit)
        error = share * d.acceleration_sd * float(streams(f"onboard.{name}.calibration").standard_normal())
        found.append((true + error) * _along(part, normal))
    return found[0], found[1]


def believed_noise(scenario: Scenario, calibration: tuple[float, float] = (0.0, 0.0)) -> NoiseModel:
    """What the estimator believes of the head and of the accelerometer."""
    air, belief = scenario.air_data, scenario.mismatch
    total, static = air.total.description(), air.static.description()
    known, unknown = _acceleration(scenario, calibration)
    accelerometer = scenario.accelerometer.description()
    return NoiseModel(
        total_sd=belief.total_noise * total.noise_sd,
        static_sd=belief.static_noise * static.noise_sd,
        temperature_sd=belief.temperature
        * hypot(static.temperature_noise_sd, static.temperature_offset_sd, air.thermal.self_heating),
        total_tuned_sd=total.noise_sd,
        static_tuned_sd=static.noise_sd,
        total_window=belief.lag * total.mode.conversion_time,
        static_window=belief.lag * static.mode.conversion_time,
        total_lag=belief.lag * _lag(total, _tube(air, air.total_port.tube)),
        static_lag=belief.lag * _lag(static, _tube(air, air.static_port.tube)),
        acceleration=belief.acceleration * known,
        acceleration_sd=belief.acceleration_sd * unknown,
        walk=belief.drift * hypot(_walk(total), _walk(static)),
        accelerometer_sd=belief.accelerometer_noise * hypot(accelerometer.noise_sd[0], _vibration(scenario)),
        accelerometer_scale_sd=belief.accelerometer_scale * accelerometer.scale_sd,
        accelerometer_rate=accelerometer.rate,
        accelerometer_lag=belief.accelerometer_lag * (scenario.accelerometer.delay + _delay(accelerometer)),
        head_rate=air.rate,
    )


def believed_air(scenario: Scenario) -> EstimatorSettings:
    """Return the estimator's settings with the turbulence that the environment declares, and the aircraft's bound."""
    settings = _bounded(scenario)
    height = max(scenario.flight_computer.height, LOWEST * FOOT)
    sd, length = turbulence(scenario.environment.turbulence_wind_20ft, height)
    sd *= scenario.mismatch.gust
    if not sd > 0.0:
        return settings
    return replace(settings, aided=replace(settings.aided, gust_sd=sd, gust_length=length, gust_height=height))


def _bounded(scenario: Scenario) -> EstimatorSettings:
    """Return the estimator's settings with the greatest airspeed and force that there can be."""
    flown, settings = scenario.plant.chosen.flies, scenario.estimator
    aided, fastest = settings.aided, settings.fastest
    if fastest is None:
        fastest = min(FASTER * scenario.flight_computer.airspeed, FASTEST) if flown else FASTEST
    if aided.flight_force is None:
        aided = replace(aided, flight_force=MOST_FLIGHT_FORCE if flown else MOST_FORCE)
    return replace(settings, fastest=fastest, aided=aided)


def turbulence(wind_20ft: float, height: float) -> tuple[float, float]:
    """Standard deviation, m/s, and length, m, of the longitudinal turbulence at a height above ground.

    Parameters
    ----------
    wind_20ft : float
        Wind speed at 20 ft, m/s.
    height : float
        m.
    """
    feet = min(max(height / FOOT, LOWEST), HIGHEST)
    shape = 0.177 + 0.000823 * feet
    return 0.1 * wind_20ft / shape**0.4, feet / shape**1.2 * FOOT


def _acceleration(scenario: Scenario, calibration: tuple[float, float]) -> tuple[float, float]:
    """Pressure error of the pair's difference per specific force along body x, and its standard deviation."""
    air = scenario.air_data
    column = _column(_tube(air, air.static_port.tube), DOWN) - _column(_tube(air, air.total_port.tube), AFT)
    known, unknown = column, COLUMN_SD * abs(column)
    if air.acceleration_sensitivity:
        share = scenario.mismatch.acceleration_calibration
        known += calibration[0] - calibration[1]
        for part, normal in ((air.total, FORWARD), (air.static, DOWN)):
            unknown = hypot(unknown, share * part.description().acceleration_sd * _along(part, normal))
    return known, unknown


def _along(part: PressureSettings, normal: tuple[float, float, float]) -> float:
    """Body x component of a membrane's normal."""
    return unit_vector(normal if part.normal is None else part.normal, "normal of a membrane")[0]


def _tube(air: AirDataSettings, tube: TubeSettings) -> TubeSettings:
    return replace(tube, length=air.pipe) if air.pipe > 0.0 else tube


def _column(tube: TubeSettings, usual: tuple[float, float, float]) -> float:
    """ρ L n_x, Pa/(m/s²)."""
    direction = unit_vector(usual if tube.direction is None else tube.direction, "direction of a tube")
    return DENSITY * tube.length * direction[0]


def _lag(part: PressureDescription, tube: TubeSettings) -> float:
    """Age of a pressure beside half the conversion, s: digital filter and tube."""
    a = part.iir_weight
    filtered = (1.0 - a) / a / part.rate
    if tube.length == 0.0:
        return filtered
    return filtered + laminar_lag(
        length=tube.length,
        diameter=tube.diameter,
        volume=tube.volume,
        pressure=STANDARD_PRESSURE,
        temperature=STANDARD_TEMPERATURE,
        polytropic=1.4,
    )


def _delay(part: AccelerometerDescription) -> float:
    """Delay of a steady signal in the part's low-pass, s."""
    if not part.errors.bandwidth:
        return 0.0
    if not part.poles:
        return 0.5 / part.rate
    return sqrt(part.poles) / (2.0 * pi * part.bandwidth)  # Butterworth: 1/ω for one pole, √2/ω for two


def _walk(part: PressureDescription) -> float:
    """Random walk that drift and walk are together, Pa/√s."""
    return sqrt(2.0 * part.drift_sd**2 / part.correlation_time + part.random_walk**2)


def _vibration(scenario: Scenario) -> float:
    """White noise a reading that stands for the vibration in flight, m/s²."""
    v, rate = scenario.vibration, scenario.accelerometer.description().rate
    low, high = v.band_hz
    return v.flight_rms_g * G0 * scenario.accelerometer.vibration_scale * sqrt(0.5 * rate / (high - low))
