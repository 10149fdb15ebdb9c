"""What a launcher is to the rail: a force on the aircraft, along the rail, that pushes and never pulls.

A machine moves a carriage, too. With the force F of the drive, the aircraft's mass m and what holds it back against the
rail, f, the carriage's mass M and its friction f_c, and v̇ that both have,

    (m + M) (v̇ + g sin θ) = F − f_c − f        P = m (v̇ + g sin θ) + f

so that the aircraft gets

    P = [m (F − f_c) + M f]/(m + M)

What air and thrust do to the aircraft is not in f: on fw8 a drag of 3 N, of which P lacks M/(m + M).
"""

from dataclasses import dataclass
from typing import Protocol

IDEAL = "ideal"  # the kind that gives a specific force, whatever it has to move


@dataclass(frozen=True, slots=True)
class Load:
    """What a launcher has to move.

    Attributes
    ----------
    mass : float
        Of the aircraft, kg.
    backward : float
        g sin θ, m/s².
    stroke : float
        Way along the rail, m.
    step : float
        Over which forces are averaged, s.
    factor : float
        This launch's drive over the nominal one.
    pressure : float
        Of the air at the launcher, Pa.
    """

    mass: float
    backward: float
    stroke: float
    step: float
    factor: float = 1.0
    pressure: float = 101_325.0


class Push(Protocol):
    """What pushes.

    Attributes
    ----------
    peak : float
        About the greatest force on the aircraft, N: what the airframe is shaken by.
    rise : float
        About how long it takes to get there, s.
    """

    peak: float
    rise: float

    def mean(self, since: float, way: float, speed: float, held: float, against: float) -> float:
        """Mean force on the aircraft over a step, N.

        Parameters
        ----------
        since : float
            From the push's beginning to the step's, s; it begins within the step if that is below 0.
        way : float
            Along the rail at the beginning of the step, m.
        speed : float
            Along the rail in its middle, m/s.
        held : float
            Share of the step for which it acts.
        against : float
            Friction of the aircraft on the rail, N.
        """


def through_carriage(drive: float, load: Load, carriage: float, friction: float, against: float) -> float:
    """Force on the aircraft, N, of a drive, N, that moves a carriage, kg, with a friction, N; never below 0."""
    force = (load.mass * (drive - friction) + carriage * against) / (load.mass + carriage)
    return force if force > 0.0 else 0.0
