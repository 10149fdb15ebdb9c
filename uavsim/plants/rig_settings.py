"""Which plant flies, and what the rigs are told before they start."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Interval

from uavsim.plants.wind_tunnel_settings import WindTunnelSettings

PlantKind = Literal["jsbsim", "launch-curve", "centrifuge", "wind-tunnel"]
AIRCRAFT: PlantKind = "jsbsim"


@dataclass(frozen=True, slots=True)
class LaunchCurveSettings:
    """A prescribed launch force along body x, `plant.kind = "launch-curve"`.

    Its level A is `launcher.peak_specific_force_g`, its elevation and wait are the launcher's, too.

    Attributes
    ----------
    shape
        "ring": rises, and rings about its plateau; "half-sine"; "trapezoid": rises, stays and falls.
    length
        From no force to no force, s.
    rise
        Time in which ring and trapezoid rise, s.
    fall
        Time in which they fall at the end, s.
    ring_fraction
        Amplitude of the ring at the start, as a fraction of A.
    ring_hz
        Its frequency, Hz.
    ring_phase_deg
        Its phase at the start, degrees.
    ring_decay
        Time in which it decays to 1/e, s.
    noise_sd_g
        Standard deviation of white noise on the curve, independent each ms, g.
    """

    shape: Literal["ring", "half-sine", "trapezoid"] = "ring"
    length: Annotated[float, Interval(ge=0.01, le=10)] = 0.3
    rise: Annotated[float, Interval(ge=0.001, le=1)] = 0.003
    fall: Annotated[float, Interval(ge=0.001, le=1)] = 0.020
    ring_fraction: Annotated[float, Interval(ge=0, le=5)] = 0.5
    ring_hz: Annotated[float, Interval(gt=0, le=500)] = 120.0
    ring_phase_deg: Annotated[float, Interval(ge=-360, le=360)] = 315.0
    ring_decay: Annotated[float, Interval(gt=0, le=10)] = 0.050
    noise_sd_g: Annotated[float, Interval(ge=0, le=50)] = 0.0


@dataclass(frozen=True, slots=True)
class CentrifugeSettings:
    """A centrifuge, `plant.kind = "centrifuge"`: the arm at rest, spun up, held, spun down, at rest.

    It begins to turn when the launcher's wait is over.

    Attributes
    ----------
    arm
        Radius that the load is set for, m.
    load_g
        Centripetal load at that radius while the speed is held, g; the speed is the root of load/arm.
    radius_error
        How much further out the sensor sits than the arm is long, m.
    spin_up
        Time in which the speed grows evenly, s.
    hold
        Time for which it is held, s.
    spin_down
        Time in which it goes back to 0 evenly, s.
    """

    arm: Annotated[float, Interval(ge=0.05, le=20)] = 1.0
    load_g: Annotated[float, Interval(ge=0, le=200)] = 4.0
    radius_error: Annotated[float, Interval(ge=-1, le=1)] = 0.0
    spin_up: Annotated[float, Interval(ge=0.01, le=600)] = 5.0
    hold: Annotated[float, Interval(ge=0, le=3000)] = 8.0
    spin_down: Annotated[float, Interval(ge=0.01, le=600)] = 5.0


@dataclass(frozen=True, slots=True)
class PlantSettings:
    """Where the truth comes from.

    Attributes
    ----------
    kind
        "jsbsim" flies the aircraft off its catapult; the others are rigs that hold the sensors and the detector.
    """

    kind: PlantKind = AIRCRAFT
    launch_curve: LaunchCurveSettings = field(default_factory=LaunchCurveSettings)
    centrifuge: CentrifugeSettings = field(default_factory=CentrifugeSettings)
    wind_tunnel: WindTunnelSettings = field(default_factory=WindTunnelSettings)


def length(plant: PlantSettings) -> float:
    """How long a rig's run takes after the wait, s; 0 for what has no set length."""
    if plant.kind == "launch-curve":
        return plant.launch_curve.length
    if plant.kind == "centrifuge":
        turning = plant.centrifuge
        return turning.spin_up + turning.hold + turning.spin_down
    if plant.kind == "wind-tunnel":
        return plant.wind_tunnel.length
    return 0.0
