"""Launch detectors, which tell from the specific force that the catapult has fired.

`adaptive_cusum` is what the packaged scenarios fly. `nested` is the published method, `window` and `hold` are those it
compares itself with, `cusum` and `glr` other statistical ones, and `field` holds what autopilots fly. All take samples
one by one in constant memory and in a time that does not grow with their windows; what they have in common is in
`detector` and `axis`, what a scenario can choose in `settings`.
"""

from uavsim.onboard.launch.adaptive_cusum import AdaptiveCusum
from uavsim.onboard.launch.cusum import Cusum
from uavsim.onboard.launch.detector import GAP_PERIODS, Axis, Detector
from uavsim.onboard.launch.field import AltOs, ArduPilot, Inav, Paparazzi, Px4, Px4Norm
from uavsim.onboard.launch.glr import GlrBank
from uavsim.onboard.launch.hold import DoubleThreshold, SingleThreshold
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.launch.settings import (
    AdaptiveCusumSettings,
    CusumSettings,
    DetectorSettings,
    GlrSettings,
    Kind,
    build,
    default,
)
from uavsim.onboard.launch.window import SequenceWindow, SlidingWindow, ThresholdWindow

__all__ = [
    "GAP_PERIODS",
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
]
