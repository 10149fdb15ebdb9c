"""Rigs: plants on the ground that hold the sensors and the detector, a file each with its settings and its kind.

To add one, write a file here that registers it (`uavsim.plants.kinds.plant`); it is found by being here.
"""

from importlib import import_module
from pkgutil import iter_modules

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
