"""Kinds of plant: what each says of itself, and which settings are its own."""

import pytest

from uavsim.plants.choice import PlantSettings
from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Run
from uavsim.plants.rigs.centrifuge import CentrifugeSettings
from uavsim.plants.rigs.launch_curve import LaunchCurveSettings
from uavsim.plants.rigs.wind_tunnel import WindTunnelSettings
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings


@pytest.mark.parametrize(
    ("name", "flies", "rings", "launches", "length"),
    [
        ("jsbsim", True, True, True, 0.0),
        ("launch-curve", False, False, True, 0.25),
        ("centrifuge", False, False, False, 3.0 + 7.0 + 2.0),
        ("wind-tunnel", False, False, False, 2 * (1.0 + 4.0)),
    ],
)
def test_a_kind_says_what_it_is_and_how_long_it_runs(
    name: str, flies: bool, rings: bool, launches: bool, length: float
) -> None:
    plant = PlantSettings(
        kind=name,
        launch_curve=LaunchCurveSettings(length=0.25),
        centrifuge=CentrifugeSettings(spin_up=3.0, hold=7.0, spin_down=2.0),
        wind_tunnel=WindTunnelSettings(speeds=(5.0, 10.0), ramp=1.0, hold=4.0),
    )
    kind = plant.chosen
    assert (kind.name, kind.flies, kind.rings, kind.launches) == (name, flies, rings, launches)
    assert plant.length == length


@pytest.mark.parametrize("name", [kind.name for kind in KINDS.values() if not kind.flies])
def test_a_rig_is_made_from_its_own_settings(name: str) -> None:
    plant = PlantSettings(kind=name)
    made = plant.chosen.cls(plant.own, Run(EnvironmentSettings(), LauncherSettings(), 10.0, release_time=2.0))
    assert plant.own is getattr(plant, plant.chosen.group)
    assert made.truth()["t"].tolist() == [0.0]


def test_a_name_that_is_taken_is_refused() -> None:
    with pytest.raises(ValueError, match="there is already a plant 'centrifuge'"):
        KINDS.add(Kind("centrifuge", KINDS["jsbsim"].cls))
