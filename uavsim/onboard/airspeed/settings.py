"""Which airspeed estimator is flown, and its settings."""

from dataclasses import dataclass, field
from typing import Annotated, Any

from annotated_types import Interval

from uavsim import airdata
from uavsim.onboard.plausible import FASTEST, MOST_FORCE


@dataclass(frozen=True, slots=True)
class AidedSettings:
    """What the aided filter believes of air and aircraft; its sensors are in `NoiseModel`.

    Attributes
    ----------
    gust_sd : float
        Standard deviation of the turbulence along the flight path, m/s; less than the floor is taken for it.
    gust_floor : float
        The least, m/s: what calm air has.
    gust_length : float
        Its scale length, m: the gust's correlation time is that over the airspeed.
    gust_height : float
        Height above the launch at which these hold, m; below and above it is as of `gust`; 0: they hold everywhere.
    shear : float
        How far it is unknown how fast the mean wind along the path grows with the logarithm of the height, m/s: so much
        more may the airspeed wander in a climb; 0: not at all.
    shear_along : float
        What is known of that, dW/d(ln h) of the headwind, m/s: so much does the airspeed grow in a climb.
    launch_height : float
        Of the aircraft above the ground at the launch, m.
    slope_rate : float
        How fast the climb's share of gravity, g·sin γ, wanders in flight, (m/s²)/√s.
    slope_time : float
        How long it remembers a climb, s; its standard deviation is slope_rate·√(slope_time/2).
    bias_sd : float
        What f_x is off by in flight beside the accelerometer's own offset, which its description tells, m/s²: the angle
        of attack turns f_x from the path.
    bias_time : float
        Correlation time of that, s.
    bias_rate : float
        How fast that wanders in steady flight and still air, the angle of attack apart, (m/s²)/√s: what the watch over
        the ports goes by; in declared turbulence five times as fast.
    static_walk : float
        What moves the static pressure beside the climb, Pa/√s.
    on_rail : float
        The aircraft is on its rail, where slope and angle of attack are fixed, while the mean specific force between
        two readings is by so much above that at rest, m/s².
    unfolding_time : float
        How long after the wings' command they push the accelerometer about, s.
    unfolding_rate : float
        How far the integral of f_x wanders from the airspeed meanwhile, (m/s)/√s.
    flight_force : float or None
        The greatest specific force along an axis with the wings out, m/s²: a reading beyond it is a missing one. None:
        6 g, on a rig what an accelerometer reads at all.
    rail_wind_along, rail_wind_side, rail_wind_down : float
        The mean wind past the aircraft on its rail as it is declared, body axes, m/s: a headwind, from the right, and
        from below.
    rail_wind_sd : float
        Standard deviation of each, m/s: turbulence, and what a declared wind is off by; 0: no wind is declared.
    lift_slope : float or None
        a of α = a n/(ρ V²) + α₀ with the wings out, n being −f_z, kg/m²: mass over half the wing's area and the slope
        of its lift; 0: the angle of attack is not known. None: the aircraft's own (`uavsim.beliefs`).
    lift_zero : float or None
        α₀, rad. None: the aircraft's own.
    lift_slope_sd, lift_zero_sd : float
        Standard deviations of both, kg/m² and rad.
    lift_gust_sd : float
        Of a vertical gust that changes the angle of attack and not the lift, m/s: of a course that gusts do not move.
    replay : float
        How long before its recognition a launch is replayed from, s; it has to begin on the rail.
    """

    gust_sd: Annotated[float, Interval(ge=0.0, le=20.0)] = 0.2
    gust_floor: Annotated[float, Interval(gt=0.0, le=5.0)] = 0.2
    gust_length: Annotated[float, Interval(gt=1.0, le=5000.0)] = 200.0
    gust_height: Annotated[float, Interval(ge=0.0, le=5000.0)] = 0.0
    shear: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.0
    shear_along: Annotated[float, Interval(ge=-50.0, le=50.0)] = 0.0
    launch_height: Annotated[float, Interval(gt=0.0, le=5000.0)] = 1.5
    slope_rate: Annotated[float, Interval(gt=0.0, le=50.0)] = 0.7
    slope_time: Annotated[float, Interval(gt=0.1, le=1000.0)] = 5.0
    bias_sd: Annotated[float, Interval(gt=0.0, le=10.0)] = 0.3
    bias_time: Annotated[float, Interval(gt=0.01, le=1000.0)] = 5.0
    bias_rate: Annotated[float, Interval(gt=0.0, le=10.0)] = 0.002
    static_walk: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.3
    on_rail: Annotated[float, Interval(gt=0.0, le=500.0)] = 20.0
    unfolding_time: Annotated[float, Interval(ge=0.0, le=10.0)] = 0.35
    unfolding_rate: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.0
    flight_force: Annotated[float, Interval(gt=0.0, le=MOST_FORCE)] | None = None
    rail_wind_along: Annotated[float, Interval(ge=-50.0, le=50.0)] = 0.0
    rail_wind_side: Annotated[float, Interval(ge=-50.0, le=50.0)] = 0.0
    rail_wind_down: Annotated[float, Interval(ge=-50.0, le=50.0)] = 0.0
    rail_wind_sd: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.0
    lift_slope: Annotated[float, Interval(ge=0.0, le=1000.0)] | None = None
    lift_zero: Annotated[float, Interval(ge=-0.5, le=0.5)] | None = None
    lift_slope_sd: Annotated[float, Interval(ge=0.0, le=1000.0)] = 0.0
    lift_zero_sd: Annotated[float, Interval(ge=0.0, le=0.5)] = 0.01
    lift_gust_sd: Annotated[float, Interval(ge=0.0, le=20.0)] = 0.0
    replay: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.3


@dataclass(frozen=True, slots=True)
class EstimatorSettings:
    """Which airspeed estimator is flown, and its settings.

    Attributes
    ----------
    kind : str
        "paper", the published method; "paper-filterpy", the same through the filterpy package; "constant-velocity" and
        "jump-adaptive", other filters of the two pressures; "aided", which takes in the accelerometer.
        Others come from packages, from `--plugin` or from Python.
    model : str
        Relation of pressures and airspeed, "compressible" or "bernoulli"; the aided filter has the first only.
    gain_total, gain_static : float
        Steady gains of the two filters: Q is set so that a sensor of the noise that the part's description says gets
        them. A quieter part of another description gets the same gain; what `[mismatch]` makes the filter believe does
        change it.
    q_total, q_static : float or None
        Q itself, growth of the pressure's variance from one sample to the next, Pa², in place of the gain.
    wind_sd : float
        Standard deviation of the airspeed while nothing is measured, m/s: that of the wind.
    vapour_fraction : float or None
        Mole fraction of water vapour in the air. None: that of the place's air; 0 where nothing is known of it.
    calibration : float
        K, which multiplies the airspeed.
    fastest : float or None
        The greatest airspeed that the aircraft can have, m/s: no estimate above it is valid. None: four times the
        airspeed that its flight computer holds, on a rig that of sound.
    aided : group
        Of the aided filter.
    options : group
        Settings of an estimator that is not one of ours, as that has them.
    """

    kind: str = "aided"
    model: airdata.Model = "compressible"
    gain_total: Annotated[float, Interval(gt=0.0, lt=1.0)] = 0.8
    gain_static: Annotated[float, Interval(gt=0.0, lt=1.0)] = 0.3
    q_total: Annotated[float, Interval(gt=0.0, le=1e8)] | None = None
    q_static: Annotated[float, Interval(gt=0.0, le=1e8)] | None = None
    wind_sd: Annotated[float, Interval(gt=0.0, le=100.0)] = 3.0
    vapour_fraction: Annotated[float, Interval(ge=0.0, le=0.2)] | None = None
    calibration: Annotated[float, Interval(gt=0.0, le=10.0)] = 1.0
    fastest: Annotated[float, Interval(gt=0.0, le=FASTEST)] | None = None
    aided: AidedSettings = field(default_factory=AidedSettings)
    options: dict[str, Any] | None = field(default=None, hash=False)
