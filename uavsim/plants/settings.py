"""What a JSBSim flight is told before it starts: aircraft and launcher. Free of jsbsim, so scenarios load fast."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Interval

from uavsim.plants.air.settings import EnvironmentSettings
from uavsim.plants.launchers.settings import BungeeSettings, ElectromechanicalSettings, PneumaticSettings

__all__ = ["AircraftSettings", "EnvironmentSettings", "LauncherSettings"]


@dataclass(frozen=True, slots=True)
class AircraftSettings:
    """The aircraft.

    Attributes
    ----------
    model
        Name of a folder of ``aircraft/``, or the path of such a folder, whose files are checked (SECURITY.md).
    properties
        JSBSim properties of the aircraft that are written once before the flight, in JSBSim's own units; not those of
        the air, the place, the motion or the simulator.
    mass_factor
        Factor on the mass and on the moments of inertia about y and z. The catapult is set for the aircraft as it
        should be: its force stays, and a heavier aircraft is accelerated less.
    cg_shift
        How far ahead of its place the centre of gravity is, m.
    lift_factor
        Factor on the whole aerodynamic force across the flow, in the plane of symmetry.
    drag_factor
        Factor on the whole aerodynamic force along the flow.
    pitch_factor
        Factor on the aerodynamic pitching moment about the reference point, that of the tail included.
    thrust_factor
        Factor on the propeller's thrust; what drives it stays.
    """

    model: str = "fw8"
    properties: dict[str, float] = field(default_factory=dict)
    mass_factor: Annotated[float, Interval(ge=0.5, le=2)] = 1.0
    cg_shift: Annotated[float, Interval(ge=-0.5, le=0.5)] = 0.0
    lift_factor: Annotated[float, Interval(ge=0, le=3)] = 1.0
    drag_factor: Annotated[float, Interval(ge=0, le=10)] = 1.0
    pitch_factor: Annotated[float, Interval(ge=0, le=3)] = 1.0
    thrust_factor: Annotated[float, Interval(ge=0, le=3)] = 1.0


@dataclass(frozen=True, slots=True)
class LauncherSettings:
    """Catapult and rail.

    Attributes
    ----------
    kind
        What pushes: "ideal", a specific force that is the same for any mass, "pneumatic", "bungee" or
        "electromechanical". The latter have groups of their own; peak_specific_force_g, rise and fall are the ideal's.
    peak_specific_force_g
        Specific force along body x that the push gives on its plateau, standard g. The acceleration along the rail
        is that less g sin(elevation), friction and drag.
    rise
        Time in which the push grows to the plateau, s.
    fall
        Time in which it dies away, s.
    stroke
        Way along the rail over which the aircraft is pushed, m; its end is where the rear shoe leaves.
    elevation_deg
        Of the rail above the horizon, degrees.
    heading_deg
        Of the rail, degrees from north.
    height
        Of the aircraft's centre of gravity above the ground before release, m.
    friction
        Coulomb coefficient between shoes and rail.
    hang_fire
        How long after the latch the push begins, s.
    ends_at
        Way along the rail at which the push fails, m; the aircraft runs on as it is.
    misfire
        Whether the push never comes.
    pneumatic, bungee, electromechanical
        The machines.
    force_factor
        Factor on the force of the push, beside the one that is drawn.
    force_spread
        Half-width of the uniform distribution from which a flight's force factor is drawn (0.02: ±2 %).
    wait_min
        Least waiting time before release, s; a flight's is drawn evenly between the two.
    wait_max
        Greatest waiting time, s.
    """

    kind: Literal["ideal", "pneumatic", "bungee", "electromechanical"] = "ideal"
    peak_specific_force_g: Annotated[float, Interval(ge=0.1, le=40)] = 8.0
    rise: Annotated[float, Interval(ge=0.001, le=1)] = 0.030
    fall: Annotated[float, Interval(ge=0.001, le=1)] = 0.060
    stroke: Annotated[float, Interval(ge=0.6, le=50)] = 5.2
    elevation_deg: Annotated[float, Interval(ge=0, le=60)] = 12.5
    heading_deg: Annotated[float, Interval(ge=-360, le=360)] = 0.0
    height: Annotated[float, Interval(ge=0.3, le=100)] = 1.5
    friction: Annotated[float, Interval(ge=0, le=0.5)] = 0.01
    hang_fire: Annotated[float, Interval(ge=0, le=60)] = 0.0
    ends_at: Annotated[float, Interval(gt=0, le=50)] | None = None
    misfire: bool = False
    pneumatic: PneumaticSettings = field(default_factory=PneumaticSettings)
    bungee: BungeeSettings = field(default_factory=BungeeSettings)
    electromechanical: ElectromechanicalSettings = field(default_factory=ElectromechanicalSettings)
    force_factor: Annotated[float, Interval(gt=0, le=3)] = 1.0
    force_spread: Annotated[float, Interval(ge=0, le=0.3)] = 0.02
    wait_min: Annotated[float, Ge(1.6)] = 2.0
    wait_max: Annotated[float, Gt(1.6)] = 4.0
