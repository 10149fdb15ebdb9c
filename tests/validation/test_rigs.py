"""What is promised of the rigs, over many drawn units: 4 g is never a launch, 15 g always is one, and only once."""

from collections.abc import Callable

import pytest

from uavsim.scenario import load_scenario
from uavsim.studies.batch import Batch, fly_seeds

pytestmark = pytest.mark.slow

Figure = Callable[..., None]
SEEDS = list(range(1, 21))
DRAWN = ("accelerometer.unit=random", "accelerometer.bias=0.0")


def flown(name: str, *overrides: str) -> Batch:
    return fly_seeds(load_scenario(name, overrides=overrides), SEEDS, workers=2)


@pytest.mark.parametrize("overrides", [(), DRAWN], ids=["published readings", "drawn units"])
def test_centrifuge_at_4_g(overrides: tuple[str, ...], figure: Figure) -> None:
    runs = flown("centrifuge-4g", *overrides).runs
    assert (runs["outcome"] == "completed").all()
    figure("detections at 4 g", runs["launch.detections"], "", 0, 0)


@pytest.mark.parametrize("overrides", [(), DRAWN], ids=["published readings", "drawn units"])
def test_centrifuge_at_15_g(overrides: tuple[str, ...], figure: Figure) -> None:
    runs = flown("centrifuge-15g", *overrides).runs
    assert (runs["outcome"] == "completed").all()
    figure("detections at 15 g", runs["launch.detections"], "", 1, 1)
    figure("after the crossing of 4.5 g", 1e3 * runs["launch.latency_from_crossing"], "ms", 0, 200)


def test_launch_curve(figure: Figure) -> None:
    runs = flown("launch-curve").runs
    assert runs["requirements.met"].all()
    figure("after the crossing of 4.5 g", 1e3 * runs["launch.latency_from_crossing"], "ms", 0, 60)
