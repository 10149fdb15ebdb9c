"""Launch detectors, which tell from the specific force that the catapult has fired.

`nested` is the published method. All take samples one by one in constant memory and in a time that does not grow with
their windows; what they have in common is in `detector`, what a scenario can choose in `settings`.
"""

from uavsim.onboard.launch.detector import GAP_PERIODS, Axis, Detector
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.launch.settings import DetectorSettings, build, default

__all__ = ["GAP_PERIODS", "Axis", "Detector", "DetectorSettings", "MultiLevelWindow", "build", "default"]
