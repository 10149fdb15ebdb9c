"""Makes the estimator that settings name."""

from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.constant_velocity import ConstantVelocity
from uavsim.onboard.airspeed.interface import Estimator, NoiseModel, TareWindow
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.airspeed.through_filterpy import FilterpyFilter


def build(settings: EstimatorSettings, noise: NoiseModel, tare_window: TareWindow | None = None) -> Estimator:
    """Make the estimator of the given kind.

    Parameters
    ----------
    settings : EstimatorSettings
        What to build.
    noise : NoiseModel
        What it believes of its sensors.
    tare_window : tuple of float, optional
        When the pair is under its cover, s, as `PaperFilter`.

    Returns
    -------
    Estimator
        Of the kind that the settings name.
    """
    if settings.kind == "paper-filterpy":
        return FilterpyFilter(settings, noise, tare_window)
    if settings.kind == "aided":
        return AidedFilter(settings, noise, tare_window)
    kinds = {"paper": PaperFilter, "constant-velocity": ConstantVelocity, "jump-adaptive": JumpAdaptive}
    return kinds[settings.kind](settings, noise, tare_window)
