"""Batch evaluation over an hour-scale record: every kind as it is shipped, against its own step, sample by sample."""

import pytest

from uavsim.onboard.launch import KINDS, DetectorSettings, build
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import DISTURBANCES

pytestmark = pytest.mark.slow

RATE = 1000.0  # Hz


@pytest.mark.parametrize(
    "name", ["mix", *(pytest.param(n, marks=pytest.mark.certify) for n in DISTURBANCES if n != "mix")]
)
@pytest.mark.parametrize("kind", tuple(KINDS))
def test_ten_minutes_of_each_class_give_the_alarms_of_step(kind: str, name: str) -> None:
    """600 000 samples or more, with the vibration of every spell; no tolerance."""
    chosen = DetectorSettings(kind=kind)
    force = DISTURBANCES[name].piece(7, 2, RATE, (0, 1, 2))
    detector, found = build(chosen, RATE), []
    for k, (fx, fy, fz) in enumerate(force.tolist()):
        if detector.step(k / RATE, fx, fy, fz):
            found.append(k)
            detector.reset()
    assert BatchDetector(chosen, RATE).alarms(force).tolist() == found
