"""Airspeed estimators: of two pressures, a temperature and, the best of them, the specific force they make an airspeed.

With it they say how well it is known and whether it is to be trusted. `paper` is the published method,
`constant_velocity` and `jump_adaptive` are other filters of the pressures alone. `aided` takes in the accelerometer:
its model is `energy_model`, its filter `energy`, and `ports` watches the two ports. What all have in common is in
`interface`, what a scenario can choose in `settings`.
"""

from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.build import build
from uavsim.onboard.airspeed.constant_velocity import ConstantVelocity
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.interface import Estimate, Estimator, NoiseModel, TareWindow
from uavsim.onboard.airspeed.jump_adaptive import JumpAdaptive
from uavsim.onboard.airspeed.paper import FLOOR, VALID, PaperFilter
from uavsim.onboard.airspeed.random_walk import Channel, RandomWalk, growth, process_noise, steady_gain
from uavsim.onboard.airspeed.settings import AidedSettings, EstimatorSettings
from uavsim.onboard.airspeed.through_filterpy import FilterpyFilter

__all__ = [
    "FLOOR",
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
    "NoiseModel",
    "PaperFilter",
    "RandomWalk",
    "TareWindow",
    "build",
    "growth",
    "process_noise",
    "steady_gain",
]
