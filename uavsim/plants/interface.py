"""What the plant asks of an aircraft: properties that it reads and sets, and the parts that an aircraft may go without.

Three kinds. `NEEDED` every aircraft has: JSBSim gives most of them to whatever it loads, the rest are the forces by
which the rail holds and the push drives it, and an engine with its throttle. A part of `PARTS` an aircraft has as a
whole or not at all: without a wing to fold the wing counts as out from the start (truth `wing` is 1 throughout), and
without a stabiliser the commands of pitch and roll reach nothing. `TURNS` it may have: damping that reads them meets
the rotation of the air. All that is missing is named in one line.
"""

from collections.abc import Container, Mapping
from dataclasses import dataclass

from uavsim.plants.columns import FT, LBF, RAW

WING_COMMAND, WING_POSITION = "fcs/wing-cmd-norm", "fcs/wing-pos-norm"
PITCH, ROLL, ENGAGED = "ap/pitch-cmd-rad", "ap/roll-cmd-rad", "ap/engaged"
COMMANDS = (WING_COMMAND, "fcs/throttle-cmd-norm", PITCH, ROLL, ENGAGED)
"""What the flight computer sets, in the order of `uavsim.plants.plant.Commands`."""

FORCES = (
    ("external_reactions/push/magnitude", LBF),
    ("external_reactions/front-shoe-normal/magnitude", -LBF),  # its direction is up, the rail's normal is down
    ("external_reactions/front-shoe-lateral/magnitude", LBF),
    ("external_reactions/rear-shoe-normal/magnitude", -LBF),
    ("external_reactions/rear-shoe-lateral/magnitude", LBF),
    ("external_reactions/rail-roll/magnitude-lbsft", LBF * FT),
)
"""Forces and the moment that the launcher sets, with the factor to SI; in the order of `RailForces`."""
SHOES = tuple(
    tuple(f"external_reactions/{end}-shoe-normal/location-{axis}-in" for axis in "xyz") for end in ("front", "rear")
)
"""Where the front and the rear shoe are, in structural axes."""

TURNS = ("air/p-rad_sec", "air/q-rad_sec", "air/r-rad_sec")
"""Rotation of the air, which an aircraft's damping may read."""
PARTS = {"wing": (WING_COMMAND, WING_POSITION), "stabiliser": (PITCH, ROLL, ENGAGED)}
"""What an aircraft has as a whole or not at all."""

_OF_PARTS = tuple(name for names in PARTS.values() for name in names)
SET = (*(name for name in COMMANDS if name not in _OF_PARTS), *(name for name, _ in FORCES))
"""Properties that every aircraft lets us set."""
SET_OF_PARTS = tuple(name for name in COMMANDS if name in _OF_PARTS)
"""Those that one with the part lets us set."""
READ = (*(name for name, _ in RAW.values() if name not in _OF_PARTS), *(name for shoe in SHOES for name in shoe))
"""Properties that are read of every aircraft."""
NEEDED = tuple(dict.fromkeys((*READ, *SET)))
"""What every aircraft has."""


@dataclass(frozen=True, slots=True)
class Interface:
    """Which parts an aircraft has.

    Attributes
    ----------
    folds
        Whether it has a wing to unfold.
    stabilised
        Whether it holds the pitch and roll that it is commanded.
    turns
        Whether its damping meets the rotation of the air.
    """

    folds: bool
    stabilised: bool
    turns: bool

    @property
    def absent(self) -> tuple[str, ...]:
        """Properties of the parts that it goes without."""
        has = {"wing": self.folds, "stabiliser": self.stabilised}
        return tuple(name for part, names in PARTS.items() if not has[part] for name in names)


def interface_of(catalogue: Mapping[str, str]) -> Interface:
    """Tell which parts an aircraft has, of its properties with their access ('R', 'W' or 'RW')."""
    wing, stabiliser = (any(name in catalogue for name in PARTS[part]) for part in ("wing", "stabiliser"))
    return Interface(wing, stabiliser, all(name in catalogue for name in TURNS))


def problems(catalogue: Mapping[str, str], functions: Container[str]) -> list[str]:
    """All that keeps an aircraft from being flown, in clauses; none if it has what it needs.

    Parameters
    ----------
    catalogue
        Its properties with their access: 'R', 'W' or 'RW'.
    functions
        Those that functions of its own work out.
    """
    found = []
    if missing := [name for name in NEEDED if name not in catalogue]:
        found.append(f"it lacks {_listed(missing)} that uavsim needs")
    for part, names in PARTS.items():
        lacking = [name for name in names if name not in catalogue]
        if lacking and len(lacking) < len(names):
            has = next(name for name in names if name in catalogue)
            found.append(f"it has {has!r} and so a {part}, which lacks {_listed(lacking)}")
    for name in (*NEEDED, *_OF_PARTS):
        if name in functions:  # what fails in one that is read from Python ends the process
            found.append(f"{name!r} is a function, and uavsim reads or sets it: make it the output of a component")
    for name in (*SET, *SET_OF_PARTS):
        if name in catalogue and name not in functions and "W" not in catalogue[name]:
            found.append(f"{name!r} cannot be set, and uavsim sets it")
    return found


def _listed(names: list[str]) -> str:
    """Names in a row, as one thing or as several."""
    return f"the propert{'y' if len(names) == 1 else 'ies'} {', '.join(map(repr, names))}"
