"""uavsim: catapult to cruise, flown in the loop and scored against the truth.

>>> import uavsim
>>> flight = uavsim.fly("catapult", seed=7)          # doctest: +SKIP
>>> flight.score["launch"]["latency"]                # doctest: +SKIP

Frames: NED for positions and velocities, body axes forward-right-down. Units: SI, angles in radians; another
unit is part of the name. Everything here is loaded when it is first used (PEP 562), so that
``from uavsim.onboard import launch`` loads neither JSBSim nor pandas.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from uavsim.cosim import fly as fly
    from uavsim.flight import Flight as Flight
    from uavsim.flight import load as load
    from uavsim.scenario import Scenario as Scenario
    from uavsim.studies.campaign.campaign import campaign as campaign
    from uavsim.studies.campaign.sweep import sweep as sweep
    from uavsim.studies.campaign.verify import verify as verify

__version__ = "0.1.0"
__all__ = [
    "Flight",
    "Scenario",
    "__version__",
    "airdata",
    "campaign",
    "fly",
    "load",
    "onboard",
    "plugins",
    "sweep",
    "testing",
    "verify",
]

_HOMES = {
    "fly": "uavsim.cosim",
    "Flight": "uavsim.flight",
    "load": "uavsim.flight",
    "Scenario": "uavsim.scenario",
    "campaign": "uavsim.studies.campaign.campaign",
    "sweep": "uavsim.studies.campaign.sweep",
    "verify": "uavsim.studies.campaign.verify",
}


_MODULES = ("airdata", "onboard", "plugins", "testing")


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name in _MODULES:
        return import_module(f"uavsim.{name}")
    raise AttributeError(f"module 'uavsim' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
