"""Settings of the machines that push: what their makers' sheets say, SI."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Gt, Interval, Len

Positive = Annotated[float, Gt(0.0)]


@dataclass(frozen=True, slots=True)
class PneumaticSettings:
    """Vessel, valve, cylinder and carriage; by hand, for 8 kg at some 25 m/s on a stroke of 5.2 m.

    Attributes
    ----------
    pressure
        In the vessel above that of the air, Pa.
    vessel
        Its volume, m³.
    valve
        Diameter of its bore, m.
    discharge
        Coefficient of its orifice.
    opening
        Time that it takes to open, at an even rate, s.
    bore
        Diameter of the cylinder, m.
    dead
        Volume between valve and piston before the stroke, m³.
    ratio
        Way of the carriage over that of the piston: pulleys.
    travel
        Way of the carriage at which the piston meets its end, m.
    efficiency
        Of pulleys and rope.
    carriage
        Mass that moves with the aircraft, the piston's share in it, kg.
    friction
        Of the carriage, N.
    """

    pressure: Annotated[float, Interval(gt=0, le=3e7)] = 8.0e5
    vessel: Annotated[float, Interval(gt=0, le=10)] = 0.020
    valve: Annotated[float, Interval(gt=0, le=1)] = 0.040
    discharge: Annotated[float, Interval(gt=0, le=1)] = 0.7
    opening: Annotated[float, Interval(ge=0.001, le=1)] = 0.030
    bore: Annotated[float, Interval(gt=0, le=1)] = 0.080
    dead: Annotated[float, Interval(gt=0, le=1)] = 0.0002
    ratio: Annotated[float, Interval(ge=0.1, le=20)] = 4.0
    travel: Annotated[float, Interval(gt=0, le=50)] = 5.0
    efficiency: Annotated[float, Interval(gt=0, le=1)] = 0.9
    carriage: Annotated[float, Interval(ge=0, le=1000)] = 4.0
    friction: Annotated[float, Interval(ge=0, le=10000)] = 20.0


@dataclass(frozen=True, slots=True)
class BungeeSettings:
    """The cord; by hand, for 8 kg at some 25 m/s on a stroke of 9 m.

    Attributes
    ----------
    stiffness
        Force over stretch while it is being stretched, N/m.
    stretch
        At the latch, m.
    hysteresis
        Share of the stored energy that does not come back; rubber 0.1 to 0.3.
    mass
        Of the cord, kg.
    """

    stiffness: Annotated[float, Interval(gt=0, le=1e5)] = 95.0
    stretch: Annotated[float, Interval(gt=0, le=100)] = 8.8
    hysteresis: Annotated[float, Interval(ge=0, lt=1)] = 0.15
    mass: Annotated[float, Interval(ge=0, le=100)] = 2.0


@dataclass(frozen=True, slots=True)
class ElectromechanicalSettings:
    """A linear motor and the curve that it follows.

    Attributes
    ----------
    curve
        Times from the beginning, s, and accelerations along the rail, m/s², straight between them, from 0 on.
    bandwidth
        Of its control of speed, Hz. By hand.
    largest_force
        N. By hand: 8 kg on its carriage take 890.
    carriage
        Its mass, kg. By hand.
    friction
        Of the carriage, N. By hand.
    """

    curve: Annotated[tuple[tuple[Positive, Annotated[float, Interval(ge=0, le=400)]], ...], Len(1, 50)] = (
        (0.030, 66.0),
        (0.180, 66.0),
        (0.280, 53.0),
        (0.470, 53.0),
        (0.611, 0.0),
    )
    bandwidth: Annotated[float, Interval(ge=0, le=20)] = 3.0
    largest_force: Annotated[float, Interval(gt=0, le=1e6)] = 1200.0
    carriage: Annotated[float, Interval(ge=0, le=1000)] = 5.0
    friction: Annotated[float, Interval(ge=0, le=10000)] = 15.0
