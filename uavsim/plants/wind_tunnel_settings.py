"""What a wind tunnel is told before it starts."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval, MinLen

Speed = Annotated[float, Interval(ge=0.0, le=300.0)]  # m/s
Mach = Annotated[float, Interval(ge=0.0, le=0.9)]
Angle = Annotated[float, Interval(ge=-80.0, le=80.0)]  # degrees


@dataclass(frozen=True, slots=True)
class WindTunnelSettings:
    """A wind tunnel, `plant.kind = "wind-tunnel"`: at rest until the launcher's wait is over, then speed after speed.

    Pressure and temperature of the room are those of the standard atmosphere at the place (`environment`).

    Attributes
    ----------
    speeds
        Airspeeds that are set, m/s, in their order.
    machs
        Mach numbers that are set, in place of the speeds.
    hold
        Time for which each is set, s.
    ramp
        Time in which the set value goes evenly from one to the next, before it is held, s.
    settling
        Time constant with which the air follows what is set, s.
    turbulence
        Standard deviation of the turbulence along the stream, as a share of the airspeed.
    turbulence_length
        Its scale length, m: the correlation time is that over the airspeed.
    temperature_drift
        Rate at which the air warms from the start of the record, K/s.
    alpha_deg, beta_deg
        Angle of attack and of sideslip at which the head stands in the stream, degrees.
    """

    speeds: Annotated[tuple[Speed, ...], MinLen(1)] = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0)
    machs: tuple[Mach, ...] = ()
    hold: Annotated[float, Interval(ge=0.1, le=600.0)] = 10.0
    ramp: Annotated[float, Interval(ge=0.0, le=600.0)] = 0.0
    settling: Annotated[float, Interval(ge=0.0, le=60.0)] = 0.5
    turbulence: Annotated[float, Interval(ge=0.0, le=0.2)] = 0.0
    turbulence_length: Annotated[float, Interval(ge=0.001, le=1000.0)] = 0.5
    temperature_drift: Annotated[float, Interval(ge=-0.1, le=0.1)] = 0.0
    alpha_deg: Angle = 0.0
    beta_deg: Angle = 0.0

    @property
    def length(self) -> float:
        """How long the run takes after the wait, s."""
        return len(self.machs or self.speeds) * (self.ramp + self.hold)
