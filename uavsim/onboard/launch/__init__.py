"""Launch detectors, which tell from the specific force that the catapult has fired.

`adaptive_cusum` is what the packaged scenarios fly. `nested` is the published method, the windows and `hold` are those
it compares itself with, `cusum` and `glr` other statistical ones, and the others are what autopilots fly. All take
samples one by one in constant memory and in a time that does not grow with their windows.

One file a kind: its rule, its settings, the same rule compiled, and what it says of itself (`kinds`). To add one, write
such a file here; it is found by being here. What several have in common is in `detector` (time), `axis` (one signed
axis) and `autopilot`; what a scenario can choose in `settings`.
"""

from importlib import import_module
from pkgutil import iter_modules

# Kinds are listed in the order in which they are registered: the published method first.
# isort: off
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.launch.threshold_window import ThresholdWindow
from uavsim.onboard.launch.sliding_window import SlidingWindow
from uavsim.onboard.launch.sequence_window import SequenceWindow
from uavsim.onboard.launch.hold import DoubleThreshold, SingleThreshold
from uavsim.onboard.launch.cusum import Cusum, CusumSettings
from uavsim.onboard.launch.adaptive_cusum import AdaptiveCusum, AdaptiveCusumSettings
from uavsim.onboard.launch.glr import GlrBank, GlrSettings
from uavsim.onboard.launch.px4 import Px4, Px4Norm
from uavsim.onboard.launch.ardupilot import ArduPilot
from uavsim.onboard.launch.inav import Inav
from uavsim.onboard.launch.paparazzi import Paparazzi
from uavsim.onboard.launch.altos import AltOs
# isort: on

from uavsim.onboard.interface import Detector
from uavsim.onboard.launch.detector import GAP_PERIODS, Axis
from uavsim.onboard.launch.kinds import KINDS, Kind, detector
from uavsim.onboard.launch.settings import DetectorSettings, build, default

NOT_KINDS = {"compiled"}  # what a kind's file need not bring with it

for _module in iter_modules(__path__):
    if _module.name not in NOT_KINDS:
        import_module(f"{__name__}.{_module.name}")

__all__ = [
    "GAP_PERIODS",
    "KINDS",
    "AdaptiveCusum",
    "AdaptiveCusumSettings",
    "AltOs",
    "ArduPilot",
    "Axis",
    "Cusum",
    "CusumSettings",
    "Detector",
    "DetectorSettings",
    "DoubleThreshold",
    "GlrBank",
    "GlrSettings",
    "Inav",
    "Kind",
    "MultiLevelWindow",
    "Paparazzi",
    "Px4",
    "Px4Norm",
    "SequenceWindow",
    "SingleThreshold",
    "SlidingWindow",
    "ThresholdWindow",
    "build",
    "default",
    "detector",
]
