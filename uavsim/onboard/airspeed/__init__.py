"""Airspeed estimators: of two pressures, a temperature and, the best of them, the specific force they make an airspeed.

With it they say how well it is known and whether it is to be trusted. `paper` is the published method,
`constant_velocity` and `jump_adaptive` are other filters of the pressures alone. `aided` takes in the accelerometer:
its model is `energy_model`, its filter `energy`, and `ports` watches the two ports. What may be believed of the sensors
is in `interface`, what a scenario can choose in `settings`.

To add one, write a file here that registers it (`kinds`); it is found by being here.
"""

from importlib import import_module
from pkgutil import iter_modules

from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.build import build
from uavsim.onboard.airspeed.constant_velocity import ConstantVelocity
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.kinds import KINDS, Kind, estimator
from uavsim.onboard.airspeed.paper import FLOOR, VALID, PaperFilter
from uavsim.onboard.airspeed.random_walk import Channel, RandomWalk, growth, process_noise, steady_gain
from uavsim.onboard.airspeed.settings import AidedSettings, EstimatorSettings
from uavsim.onboard.airspeed.through_filterpy import FilterpyFilter
from uavsim.onboard.interface import Estimate, Estimator, TareWindow

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")

__all__ = [
    "FLOOR",
    "KINDS",
    "VALID",
    "AidedFilter",
    "AidedSettings",
    "Channel",
    "ConstantVelocity",
    "EnergyFilter",
    "Estimate",
    "Estimator",
    "EstimatorSettings",
    "FilterpyFilter",
    "JumpAdaptive",
    "Kind",
    "NoiseModel",
    "PaperFilter",
    "RandomWalk",
    "TareWindow",
    "build",
    "estimator",
    "growth",
    "process_noise",
    "steady_gain",
]
