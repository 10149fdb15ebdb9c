"""An aircraft that is not quite as it should be: factors on its forces, another mass, another centre of gravity.

Lift, drag, pitching moment and thrust are multiplied by properties that the aircraft's own functions read (factor/…).
Mass and centre of gravity come from two point masses of the aircraft, ballast of either sign on its body x axis:

    W_fore + W_aft = (f - 1) W          f: factor on the mass, W: weight without ballast
    (W_fore - W_aft) k = f W Δx         Δx: shift of the centre of gravity, forward; k = √(I_yy/m)

They lie k ahead of and behind the centre of gravity without them, so that the moments of inertia about y and z grow
with the mass (I_yy by exactly f, less f m Δx²) and that about x stays.
"""

from dataclasses import dataclass
from math import sqrt

from uavsim.plants.settings import AircraftSettings

FACTORS = {
    "lift_factor": "factor/lift",
    "drag_factor": "factor/drag",
    "pitch_factor": "factor/pitch",
    "thrust_factor": "factor/thrust",
}
"""Settings of the aircraft, and the property that each of them is."""
BALLAST = ("ballast/fore-pointmass", "ballast/aft-pointmass")
"""Properties with the numbers of an aircraft's two point masses for ballast."""


@dataclass(frozen=True, slots=True)
class Ballast:
    """Two masses that change an aircraft's mass and centre of gravity.

    Attributes
    ----------
    fore, aft
        Of the aircraft's mass without them; negative takes away.
    arm
        How far ahead of and behind the centre of gravity they lie, m.
    """

    fore: float
    aft: float
    arm: float


def factors(aircraft: AircraftSettings) -> dict[str, float]:
    """Settings that differ from 1, by their name."""
    return {name: value for name in FACTORS if (value := float(getattr(aircraft, name))) != 1.0}


def is_ballasted(aircraft: AircraftSettings) -> bool:
    """Whether its mass or its centre of gravity is another one."""
    return aircraft.mass_factor != 1.0 or aircraft.cg_shift != 0.0


def ballast(aircraft: AircraftSettings, mass: float, pitch_inertia: float) -> Ballast:
    """Return the ballast that an aircraft of this mass, kg, and moment of inertia about y, kg m², is given."""
    arm = sqrt(pitch_inertia / mass)
    more, moment = aircraft.mass_factor - 1.0, aircraft.mass_factor * aircraft.cg_shift / arm
    return Ballast(0.5 * (more + moment), 0.5 * (more - moment), arm)


def missing(aircraft: AircraftSettings, name: str, value: float, needed: str) -> str:
    """Say in one line which property an aircraft lacks for a setting."""
    return (
        f"aircraft.{name} = {value:g}: {aircraft.model!r} lacks the property {needed!r}, by which it would be "
        "varied (docs/dispersions.md)"
    )
