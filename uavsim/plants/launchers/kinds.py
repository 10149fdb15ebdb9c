"""Which launcher a scenario chooses, and which keys are of which."""

from typing import TYPE_CHECKING

from uavsim.plants.launchers.bungee import Bungee
from uavsim.plants.launchers.electromechanical import Electromechanical
from uavsim.plants.launchers.ideal import Ideal
from uavsim.plants.launchers.pneumatic import Pneumatic
from uavsim.plants.launchers.push import IDEAL, Load, Push

if TYPE_CHECKING:
    from uavsim.plants.settings import LauncherSettings

KEYS = {
    IDEAL: ("peak_specific_force_g", "rise", "fall"),
    "pneumatic": ("pneumatic",),
    "bungee": ("bungee",),
    "electromechanical": ("electromechanical",),
}
"""Kinds, and the keys of the launcher that no other reads."""


def make_push(settings: "LauncherSettings", load: Load) -> Push:
    """Make what pushes one launch.

    Raises
    ------
    ValueError
        If it cannot move the aircraft; one line that names the key.
    """
    push: Push
    match settings.kind:
        case "pneumatic":
            push = Pneumatic(settings.pneumatic, load)
        case "bungee":
            push = Bungee(settings.bungee, load)
        case "electromechanical":
            push = Electromechanical(settings.electromechanical, load)
        case _:
            return Ideal(settings.peak_specific_force_g, settings.rise, settings.fall, load)
    weight = load.mass * load.backward
    if push.peak <= weight:
        raise ValueError(
            f"launcher.{settings.kind}: it pushes the aircraft of {load.mass:.3g} kg with no more than "
            f"{push.peak:.3g} N, and {weight:.3g} N of its weight lie along the rail"
        )
    return push
