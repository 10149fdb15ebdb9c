"""What the estimator believes of its sensors and of the air.

What may be known of the sensors (`sensors.knowledge`) goes through the scenario's `[mismatch]` into the settings of the
estimator: this module alone copies them from the one into the other. What no description holds:

* A membrane's sensitivity has been calibrated, with an error that is a share of what is usual for the part.
* An aircraft is never faster than four times the airspeed that it is to hold; a rig is as fast as sound, and what is
  felt on it is bounded by the part alone.
* The turbulence is that which the environment declares (`uavsim.plants.air`), at the height of cruise, along the flight
  path: of the wind's axes, u where the rail points along the wind and v where it points across.
* So is the humidity of the air.
* How an aircraft lifts is known of fw8 and fw25, by regression on four flights of each, and of a rig that has a wing,
  which gusts do not move. Any other is one of the light UAVs: 60 to 300 N/m² of wing loading, lift slope 4.5 to 5.5.
* Where the readings of a thermal differential sensor end, and how coarse they are, depends on the absolute pressure: it
  is that of the field.
"""

from dataclasses import dataclass, replace
from math import cos, hypot, radians, sin, sqrt

from sensors import HeadKnowledge, Streams, known_of_accelerometer, known_of_head, membranes
from uavsim.onboard.airspeed import AidedSettings, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.flow_through import FlowThroughSettings
from uavsim.onboard.plausible import FASTEST, MOST_FLIGHT_FORCE, MOST_FORCE
from uavsim.plants.air.dryden import FOOT, LOWEST, deviations, lengths
from uavsim.plants.air.settings import EnvironmentSettings
from uavsim.plants.air.weather import at_ground
from uavsim.plants.air.wind import growth, mean_wind
from uavsim.plants.rigs.flight_path import FlightPathSettings
from uavsim.scenario import MismatchSettings, Scenario

# of a thermal part's range: an aircraft is above its field, where what it reads is worth more; 1 % is 90 m
ENDS = 0.98
GROWN = 0.3  # share of the mean wind's growth along the path that is not known: place, veer and the aircraft's heading
DECLARED = 0.1  # share of the mean wind that a declared one is off by: a hand anemometer, gusts between its looks
# a, kg/m², α₀, rad, and their standard deviations (`AidedSettings`): of fw8, whose α is within 0.011 of the law at any
# time (pitch rate, wings that twist), of fw25, whose α is within 0.004 of it from 46 to 211 m/s (what the Mach number
# adds to the slope counts where α is small), and of light UAVs. By hand
KNOWN = {
    "fw8": {"lift_slope": 9.45, "lift_zero": -0.0695, "lift_slope_sd": 0.0, "lift_zero_sd": 0.01},
    "fw25": {"lift_slope": 25.0, "lift_zero": 0.0101, "lift_slope_sd": 0.0, "lift_zero_sd": 0.01},
}
LIGHT = {"lift_slope": 7.5, "lift_zero": -0.06, "lift_slope_sd": 3.0, "lift_zero_sd": 0.03}
RIG_SD = 0.03  # rad, of a rig's α₀: its motor pulls along the path and carries some of what the lift seems to. By hand
FASTER = 4.0  # times the airspeed that is held: 128 m/s for 32, which no dive of such an aircraft reaches


@dataclass(frozen=True, slots=True)
class Calibration:
    """What a calibration of the units that fly found, with errors of its own.

    Attributes
    ----------
    total, static : float
        The two membranes' sensitivity along body x, Pa/(m/s²).
    ports : tuple of float
        Its errors of the static port's coefficients c₀, c_α, c_αα and c_ββ, and of the slipstream, in their standard
        deviations.
    wind : tuple of float
        Those of the wind that is declared, its parts from the south and from the west, in `DECLARED` of the mean wind,
        and of its growth with the height, in `GROWN`.
    """

    total: float = 0.0
    static: float = 0.0
    ports: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    wind: tuple[float, float, float] = (0.0, 0.0, 0.0)


NO_CALIBRATION = Calibration()


def calibrated(scenario: Scenario, streams: Streams) -> Calibration:
    """What a calibration found: done on the units that fly, with errors of its own."""
    a, b, c, d, e = streams("onboard.ports.calibration").standard_normal(5).tolist()
    total, static = _membranes(scenario, streams)
    south, west, grown = streams("onboard.wind").standard_normal(3).tolist()
    return Calibration(total, static, (a, b, c, d, e), (south, west, grown))


def _membranes(scenario: Scenario, streams: Streams) -> tuple[float, float]:
    """The two membranes' sensitivity along body x as it was found, Pa/(m/s²); total, static."""
    air, share = scenario.air_data, scenario.mismatch.acceleration_calibration
    if not air.acceleration_sensitivity:
        return 0.0, 0.0
    head = known_of_head(air)
    found = []
    for part, unit, name in zip((head.total, head.static), membranes(air, streams), ("total", "static"), strict=True):
        error = share * part.membrane_sd * float(streams(f"onboard.{name}.calibration").standard_normal())
        found.append(unit[0] + error)
    return found[0], found[1]


def believed_noise(scenario: Scenario, calibration: Calibration = NO_CALIBRATION) -> NoiseModel:
    """What the estimator believes of the head and of the accelerometer."""
    belief = scenario.mismatch
    head, accelerometer = (
        known_of_head(scenario.air_data),
        known_of_accelerometer(scenario.accelerometer, scenario.vibration),
    )
    total, static = head.total, head.static
    thin = _thin(scenario, head)
    ends = thin if thin == 1.0 else ENDS * thin
    known, unknown = _acceleration(head, belief, (calibration.total, calibration.static))
    return NoiseModel(
        total_sd=belief.total_noise * thin * total.noise_sd,
        static_sd=belief.static_noise * static.noise_sd,
        temperature_sd=belief.temperature * head.temperature_sd,
        temperature_white_sd=head.temperature_white_sd,
        temperature_step=head.temperature_step,
        temperature_lag=belief.lag * head.temperature_lag,
        total_tuned_sd=thin * total.noise_sd,
        static_tuned_sd=static.noise_sd,
        total_window=belief.lag * total.window,
        static_window=belief.lag * static.window,
        total_lag=belief.lag * total.lag,
        static_lag=belief.lag * static.lag,
        acceleration=belief.acceleration * known,
        acceleration_sd=belief.acceleration_sd * unknown,
        walk=belief.drift * head.walk,
        accelerometer_sd=belief.accelerometer_noise * accelerometer.noise_sd,
        accelerometer_scale_sd=belief.accelerometer_scale * accelerometer.scale_sd,
        accelerometer_offset_sd=belief.accelerometer_offset * accelerometer.offset_sd,
        lift_offset_sd=belief.accelerometer_offset * accelerometer.lift_offset_sd,
        accelerometer_rate=accelerometer.rate,
        accelerometer_lag=belief.accelerometer_lag * accelerometer.lag,
        head_rate=head.rate,
        total_range=(ends * total.low, ends * total.high),
        static_range=(static.low, static.high),
        total_step=thin * total.step,
        static_step=static.step,
        accelerometer_range=(-accelerometer.range, accelerometer.range - accelerometer.step),
        accelerometer_step=accelerometer.step,
        accelerometer_white_sd=accelerometer.white_sd,
        side_offset_sd=belief.accelerometer_offset * accelerometer.side_offset_sd,
        own_offset_sd=belief.accelerometer_offset * accelerometer.own_offset_sd,
        own_side_offset_sd=belief.accelerometer_offset * accelerometer.own_side_offset_sd,
        own_lift_offset_sd=belief.accelerometer_offset * accelerometer.own_lift_offset_sd,
        accelerometer_wander_sd=belief.accelerometer_offset * accelerometer.wander_sd,
        rail_elevation=_elevation(scenario),
        rail_elevation_sd=radians(scenario.flight_computer.rail_elevation_sd_deg),
        rail_roll=radians(scenario.flight_computer.rail_roll_deg),
        difference_sd=belief.drift * thin * head.difference_sd,
        static_offset_sd=belief.drift * static.offset_sd,
        thermometer_recovery=min(1.0, head.thermometer_recovery),
        thermometer_recovery_sd=head.thermometer_recovery_sd,
        die_lag=belief.lag * head.die_lag,
        differential=head.difference is not None,
        difference_scale_sd=belief.difference_scale * head.scale_sd,
        head=_ports(head, belief, calibration),
        covered=scenario.air_data.tare == "covered",
    )


def _ports(head: HeadKnowledge, belief: MismatchSettings, calibration: Calibration) -> HeadErrors:
    """What is believed of both ports' errors: as a calibration of the unit finds them, or a file has them."""
    ports, (error, alpha, alpha2, beta2, blown) = head.ports, calibration.ports
    known = belief.position
    nothing = ports.error == ports.error_alpha == ports.error_alpha2 == ports.error_beta2 == 0.0
    if nothing or not ports.exact:  # a file's numbers have their errors in them
        error = alpha = alpha2 = beta2 = blown = 0.0
    slipstream = known * (1.0 + blown * ports.slipstream_sd)
    return HeadErrors(
        limit=ports.limit,
        error=known * (ports.error + error * ports.position_sd),
        error_alpha=known * (ports.error_alpha + alpha * ports.alpha_sd),
        error_alpha2=known * (ports.error_alpha2 + alpha2 * ports.alpha2_sd),
        error_beta2=known * (ports.error_beta2 + beta2 * ports.beta2_sd),
        error_mach2=known * ports.error_mach2,
        total_slipstream=slipstream * ports.total_slipstream,
        static_slipstream=slipstream * ports.static_slipstream,
        position_sd=belief.position_sd * ports.position_sd,
        alpha_sd=belief.position_sd * ports.alpha_sd,
        alpha2_sd=belief.position_sd * ports.alpha2_sd,
        beta2_sd=belief.position_sd * ports.beta2_sd,
        slipstream_sd=belief.position_sd * ports.slipstream_sd,
    )


def believed_flow(scenario: Scenario) -> FlowThroughSettings | None:
    """What is undone of a thermal differential sensor's readings; None where the head has none."""
    known = known_of_head(scenario.air_data).difference
    share = scenario.mismatch.flow_through
    if known is None or not (known.calibration_pressure > 0.0 or known.hose > 0.0) or share == 0.0:
        return None
    return FlowThroughSettings(known.calibration_pressure, known.flow, known.flow_pressure, known.hose, share)


def _thin(scenario: Scenario, head: HeadKnowledge) -> float:
    """Factor on what a thermal part has read, in the air of the field; 1 of all others."""
    difference = head.difference
    if difference is None or not difference.calibration_pressure > 0.0:
        return 1.0
    factor = difference.calibration_pressure / at_ground(scenario.environment).pressure
    return 1.0 + scenario.mismatch.flow_through * (factor - 1.0)


def _elevation(scenario: Scenario) -> float | None:
    """Elevation of the rail as the crew believes it, rad; of a rig without one nothing is believed that is not said."""
    told = scenario.flight_computer.rail_elevation_deg
    if told is None and scenario.plant.chosen.on_rail:
        told = scenario.launcher.elevation_deg
    return None if told is None else radians(told)


def believed_air(scenario: Scenario, calibration: Calibration = NO_CALIBRATION) -> EstimatorSettings:
    """Return the estimator's settings with turbulence and humidity as the environment has them, and all bounds.

    The mean wind is declared as somebody has measured it, with errors as they are believed (`Calibration.wind`).
    """
    settings, belief = _bounded(scenario), scenario.mismatch
    if settings.vapour_fraction is None:
        settings = replace(settings, vapour_fraction=belief.humidity * at_ground(scenario.environment).vapour_fraction)
    height = max(scenario.flight_computer.height, LOWEST * FOOT)
    sd, length = turbulence(scenario.environment, height, scenario.launcher.heading_deg)
    grown = growth(scenario.environment, sqrt(height * scenario.launcher.height))
    if scenario.plant.chosen.on_rail:
        settings = replace(settings, aided=replace(settings.aided, launch_height=scenario.launcher.height))
    if grown > 0.0:
        angle = radians(scenario.launcher.heading_deg - scenario.environment.wind_from_deg)
        known = belief.wind * grown * (1.0 + GROWN * calibration.wind[2]) * cos(angle)
        settings = replace(
            settings, aided=replace(settings.aided, shear=belief.gust * GROWN * grown, shear_along=known)
        )
    settings = replace(settings, aided=replace(settings.aided, **_rail_wind(scenario, calibration), **_lift(scenario)))
    sd *= belief.gust
    if not sd > 0.0:
        return settings
    return replace(settings, aided=replace(settings.aided, gust_sd=sd, gust_length=length, gust_height=height))


def _rail_wind(scenario: Scenario, calibration: Calibration) -> dict[str, float]:
    """The wind past the aircraft on its rail as it is declared, unless the estimator's settings have one."""
    environment, launcher, share = scenario.environment, scenario.launcher, scenario.mismatch.wind
    if scenario.estimator.aided.rail_wind_sd > 0.0 or not scenario.plant.chosen.on_rail:
        return {}
    up = radians(launcher.elevation_deg)
    north, east = mean_wind(environment, launcher.height)
    turbulent, _ = deviations(environment.turbulence_wind_20ft, launcher.height)
    sd = hypot(scenario.mismatch.gust * turbulent, share * DECLARED * hypot(north, east)) if share > 0.0 else 0.0
    if not sd > 0.0:
        return {}
    off = DECLARED * hypot(north, east)
    north, east = north + off * calibration.wind[0], east + off * calibration.wind[1]
    heading = radians(launcher.heading_deg)
    head = -(north * cos(heading) + east * sin(heading))
    right = north * sin(heading) - east * cos(heading)
    return {
        "rail_wind_along": share * head * cos(up),
        "rail_wind_side": share * right,
        "rail_wind_down": share * head * sin(up),
        "rail_wind_sd": sd,
    }


def _lift(scenario: Scenario) -> dict[str, float]:
    """How the aircraft lifts, unless the estimator's settings say it."""
    aided, rig = scenario.estimator.aided, scenario.plant.own
    if aided.lift_slope is not None and aided.lift_zero is not None:
        return {}
    known = KNOWN.get(scenario.aircraft.model, LIGHT)
    if isinstance(rig, FlightPathSettings):
        vertical = deviations(scenario.environment.turbulence_wind_20ft, scenario.flight_computer.height)[1]
        known = {
            "lift_slope": 2.0 * rig.wing_loading / rig.lift_slope,
            "lift_zero": radians(rig.zero_lift_deg),
            "lift_zero_sd": RIG_SD,
            "lift_gust_sd": scenario.mismatch.gust * vertical,
        }
    return {key: value for key, value in known.items() if getattr(aided, key) == getattr(AidedSettings(), key)}


def _bounded(scenario: Scenario) -> EstimatorSettings:
    """Return the estimator's settings with the greatest airspeed and force that there can be."""
    flown, settings = scenario.plant.chosen.flies, scenario.estimator
    aided, fastest = settings.aided, settings.fastest
    if fastest is None:
        fastest = min(FASTER * scenario.flight_computer.airspeed, FASTEST) if flown else FASTEST
    if aided.flight_force is None:
        aided = replace(aided, flight_force=MOST_FLIGHT_FORCE if flown else MOST_FORCE)
    return replace(settings, fastest=fastest, aided=aided)


def turbulence(environment: EnvironmentSettings, height: float, heading_deg: float) -> tuple[float, float]:
    """Standard deviation, m/s, and length, m, of the turbulence along the flight path, as of a first-order process.

    What counts over a few readings is how fast it wanders, 2 σ²/L. Of u the process is of first order, L = L_u; v
    wanders by 3 σ²/L_v, with L_v that of MIL-F-8785C.

    Parameters
    ----------
    environment : EnvironmentSettings
    height : float
        Above the ground, m.
    heading_deg : float
        Of the flight path.
    """
    sd, _ = deviations(environment.turbulence_wind_20ft, height)
    along, across, _ = lengths("mil-f-8785c", height)
    angle = radians(heading_deg - environment.wind_from_deg)
    density = 2.0 * cos(angle) ** 2 / along + 3.0 * sin(angle) ** 2 / across
    return sd, 2.0 / density


def _acceleration(
    head: HeadKnowledge, belief: MismatchSettings, calibration: tuple[float, float]
) -> tuple[float, float]:
    """Pressure error of the pair's difference per specific force along body x, and its standard deviation."""
    known, unknown = head.column, head.column_sd
    both = ((head.total, calibration[0], 1.0), (head.static, calibration[1], -1.0))
    for part, found, sign in both if head.difference is None else both[:1]:
        if part.membrane_sd > 0.0:
            known += sign * found
            unknown = hypot(unknown, belief.acceleration_calibration * part.membrane_sd)
    return known, unknown
