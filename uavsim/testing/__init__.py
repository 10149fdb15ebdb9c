"""Conformance of detectors, estimators and plants of one's own: what ours are held to, for any class.

>>> import uavsim
>>> uavsim.testing.check_detector(uavsim.onboard.launch.default)

Each check drives a part through readings that are fixed by a seed, so it says the same every time. Every fault is an
AssertionError that says what is wrong and when. What is asked for is in `uavsim.onboard.interface` and
`uavsim.plants.plant`.
"""

from uavsim.testing.detectors import check_detector
from uavsim.testing.estimators import check_estimator
from uavsim.testing.plants import check_plant

__all__ = ["check_detector", "check_estimator", "check_plant"]
