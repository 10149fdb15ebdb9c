"""Makes the estimator that settings name."""

from uavsim.failure import built
from uavsim.onboard.airspeed.guarded import GuardedEstimator
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.kinds import KINDS
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.airspeed.settings import EstimatorSettings
from uavsim.onboard.interface import Estimator, TareWindow


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
        Of the kind that the settings name; one that is not ours is guarded (`guarded`).

    Raises
    ------
    ValueError
        If nobody has registered the kind.
    """
    if settings.kind not in KINDS:
        raise ValueError(f"estimator {settings.kind!r} is not registered; there are {', '.join(KINDS)}")
    kind = KINDS[settings.kind]
    if kind.ours:
        made = kind.build(settings, noise, tare_window)
        assert isinstance(made, Estimator)
        return made
    with built(f"estimator {kind.name!r}"):
        return GuardedEstimator(
            kind.name, kind.build(settings, noise, tare_window), PaperFilter(settings, noise, tare_window)
        )
