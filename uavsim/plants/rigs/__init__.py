"""Rigs that hold the sensors and the detector, a file each.

To add one, write a file here that registers it (`uavsim.plants.kinds.plant`); it is found by being here, and its
settings stand under [plant.options].
"""

from importlib import import_module
from pkgutil import iter_modules

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
