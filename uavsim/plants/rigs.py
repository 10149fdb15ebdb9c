"""The rigs by the kind that chooses them: a line each, a module each, a group of settings each."""

from collections.abc import Callable

from uavsim.plants.centrifuge import centrifuge
from uavsim.plants.launch_curve import launch_curve
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.plants.rig_settings import PlantKind, PlantSettings
from uavsim.plants.wind_tunnel import wind_tunnel

RIGS: dict[PlantKind, Callable[[PlantSettings, Run], PrescribedPlant]] = {
    "launch-curve": lambda plant, run: launch_curve(plant.launch_curve, run),
    "centrifuge": lambda plant, run: centrifuge(plant.centrifuge, run),
    "wind-tunnel": lambda plant, run: wind_tunnel(plant.wind_tunnel, run),
}
