"""How an accelerometer sits in the aircraft, and the map that turns its axes into ours.

Ours are forward-right-down and right-handed: with `f` the sensor's axis that points forward and `u` the one that
points up, x is f, z is −u, and y is z × x. Both are signed axes of the sensor. Where up is not known, or lies along f
(a launch straight upwards), any axis across f serves; the one that leaves most as it is, is taken.
"""

from collections.abc import Mapping, Sequence

from sensors.bench_log import Source
from uavsim.logs.recording import AXES, Origin

FORWARD, UP = "+x", "-z"  # of ours
OTHER_UP = "+x"  # where forward is along z
OPPOSITE = {"+": "-", "-": "+"}


def opposite(axis: str) -> str:
    """Return the axis that points the other way."""
    return OPPOSITE[axis[0]] + axis[1:]


def turned(forward: str, up: str | None = None) -> dict[str, str]:
    """Return which signed axis of the sensor each of ours is.

    Parameters
    ----------
    forward
        Signed axis of the sensor that points forward, as in ``-z``.
    up
        The one that points up; None if it is not known.
    """
    if up is None or up[1] == forward[1]:
        up = OTHER_UP if forward[1] == UP[1] else UP
    down = opposite(up)
    return {"fx": forward, "fy": _across(down, forward), "fz": down}


def _across(first: str, second: str) -> str:
    """Vector product of two signed axes across each other."""
    i, j = "xyz".index(first[1]), "xyz".index(second[1])
    rises = (j - i) % 3 == 1
    negative = (first[0] == "-") ^ (second[0] == "-") ^ (not rises)
    return ("-" if negative else "+") + "xyz"[3 - i - j]


def map_of(mapping: str, origins: Mapping[str, Origin], forward: str, up: str | None) -> str:
    """Return the map that replaces the present one of a log and makes an axis fx.

    Parameters
    ----------
    mapping
        The present one, empty without.
    origins
        What each axis, and t where it must be said, is read from now.
    forward, up
        As of `turned`, along the axes as they are now.
    """
    kept = [entry.strip() for entry in mapping.split(",") if entry.strip() and _ours(entry) not in AXES]
    if "t" in origins and "t" not in map(_ours, kept):
        kept.insert(0, f"t={origins['t'].written()}")
    axes = []
    for ours, axis in turned(forward, up).items():
        own = f"f{axis[1]}"
        if own in origins or not origins:  # of a log of one axis there is no other
            axes.append(f"{ours}={origins.get(own, Origin(Source(own))).written(negated=axis[0] == '-')}")
    return ",".join((*kept, *axes))


def _ours(entry: str) -> str:
    return entry.partition("=")[0].strip()


def advised(mapping: str, origins: Mapping[str, Origin], forward: str, up: str | None) -> str:
    """Return the option that gives such a map, as it stands on a command line."""
    return f'--map "{map_of(mapping, origins, forward, up)}"'


def forward_of(axes: str | Sequence[str]) -> str:
    """Return what is forward by the axes that a detector reads: the first of them, x if it reads any."""
    return FORWARD if isinstance(axes, str) else axes[0]
