"""Which launcher a scenario chooses."""

from typing import TYPE_CHECKING

from uavsim.plants.launchers.push import Load, Push

if TYPE_CHECKING:
    from uavsim.plants.settings import LauncherSettings


def make_push(settings: "LauncherSettings", load: Load) -> Push:
    """Make what pushes one launch.

    Raises
    ------
    ValueError
        If it cannot move the aircraft; one line that names the key.
    """
    from uavsim.plants.launchers.bungee import Bungee
    from uavsim.plants.launchers.electromechanical import Electromechanical
    from uavsim.plants.launchers.ideal import Ideal
    from uavsim.plants.launchers.pneumatic import Pneumatic

    push: Push
    if settings.kind == "pneumatic":
        push = Pneumatic(settings.pneumatic, load)
    elif settings.kind == "bungee":
        push = Bungee(settings.bungee, load)
    elif settings.kind == "electromechanical":
        push = Electromechanical(settings.electromechanical, load)
    else:
        return Ideal(settings.peak_specific_force_g, settings.rise, settings.fall, load)
    weight = load.mass * load.backward
    if push.peak <= weight:
        raise ValueError(
            f"launcher.{settings.kind}: it pushes the aircraft of {load.mass:.3g} kg with no more than "
            f"{push.peak:.3g} N, and {weight:.3g} N of its weight lie along the rail"
        )
    return push
