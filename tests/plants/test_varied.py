"""An aircraft that is varied, as JSBSim has it: its own weight, centre of gravity, forces and thrust.

Authority: the factors' definition, and statics of a body with two masses more. JSBSim works in double precision, so
ratios hold to 1e-9 where nothing but a product lies between.
"""

from __future__ import annotations

import math
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import jsbsim
import pytest

from uavsim.cosim import Cosimulation, draw, make_plant
from uavsim.plants.hangar import hangar
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.settings import AircraftSettings
from uavsim.plants.varied import ballast
from uavsim.scenario import load_scenario

FT, SLUG, INCH = 0.3048, 14.593902937206364, 0.0254
SLUG_FT2 = SLUG * FT**2
EXACT = 1e-9


def plant(*sets: str) -> JsbsimPlant:
    """An aircraft on its rail, at rest."""
    scenario = load_scenario("catapult", overrides=["duration=6", *sets])
    found = make_plant(scenario, draw(scenario))
    assert isinstance(found, JsbsimPlant)
    return found


def get(aircraft: JsbsimPlant, name: str) -> float:
    return float(aircraft._fdm[name])


@cache
def as_it_is() -> JsbsimPlant:
    return plant()


def mass() -> float:
    return get(as_it_is(), "inertia/mass-slugs") * SLUG


def inertia(aircraft: JsbsimPlant) -> dict[str, float]:
    return {axes: get(aircraft, f"inertia/i{axes}-slugs_ft2") * SLUG_FT2 for axes in ("xx", "yy", "zz", "xz")}


@pytest.mark.parametrize("factor", [0.9, 1.1, 1.35])
def test_a_mass_factor_is_that_of_weight_and_inertia_and_moves_no_centre(factor: float) -> None:
    heavier = plant(f"aircraft.mass_factor={factor}")
    assert get(heavier, "inertia/weight-lbs") == pytest.approx(
        factor * get(as_it_is(), "inertia/weight-lbs"), rel=EXACT
    )
    for axis in "xyz":
        place = get(as_it_is(), f"inertia/cg-{axis}-in")
        assert get(heavier, f"inertia/cg-{axis}-in") == pytest.approx(place, abs=1e-9)
    was, now = inertia(as_it_is()), inertia(heavier)
    assert now["yy"] == pytest.approx(factor * was["yy"], rel=EXACT)
    assert now["zz"] == pytest.approx(was["zz"] + (factor - 1.0) * was["yy"], rel=EXACT)
    assert (now["xx"], now["xz"]) == pytest.approx((was["xx"], was["xz"]), rel=1e-6)


@pytest.mark.parametrize("shift", [-0.02, 0.013])
@pytest.mark.parametrize("factor", [1.0, 1.1])
def test_the_centre_of_gravity_moves_forward_by_what_is_said(shift: float, factor: float) -> None:
    moved = plant(f"aircraft.cg_shift={shift}", f"aircraft.mass_factor={factor}")
    forward = get(as_it_is(), "inertia/cg-x-in") - get(moved, "inertia/cg-x-in")  # structural x is aft
    assert forward * INCH == pytest.approx(shift, abs=1e-12)
    assert get(moved, "inertia/mass-slugs") * SLUG == pytest.approx(factor * mass(), rel=EXACT)
    about_it = factor * (inertia(as_it_is())["yy"] - mass() * shift**2)  # parallel axes
    assert get(moved, "inertia/iyy-slugs_ft2") * SLUG_FT2 == pytest.approx(about_it, rel=EXACT)


def test_ballast_is_the_statics_of_two_masses() -> None:
    two = ballast(AircraftSettings(mass_factor=1.2, cg_shift=0.01), mass=8.0, pitch_inertia=2.0)
    assert two.arm == pytest.approx(0.5)
    assert two.fore + two.aft == pytest.approx(0.2)
    assert (two.fore - two.aft) * two.arm == pytest.approx(1.2 * 0.01)


def test_the_catapult_is_set_for_the_aircraft_as_it_should_be() -> None:
    """The same force on more mass: the specific force falls by the factor."""
    heavier = plant("aircraft.mass_factor=1.1")
    assert heavier.rail.machine.peak == pytest.approx(as_it_is().rail.machine.peak, rel=EXACT)
    stronger = plant("launcher.force_factor=1.07")
    assert stronger.rail.machine.peak == pytest.approx(1.07 * as_it_is().rail.machine.peak, rel=EXACT)


def fw8() -> jsbsim.FGFDMExec:
    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    root = hangar() / "fw8"
    assert fdm.load_model_with_paths("fw8", str(hangar()), str(root / "engine"), str(root / "systems"), True)
    fdm["ic/h-sl-ft"], fdm["ic/vt-fps"], fdm["ic/alpha-deg"] = 500.0, 100.0, 3.0
    fdm["fcs/throttle-cmd-norm"] = 0.7
    assert fdm.run_ic()
    for _ in range(20):  # the propeller runs up
        fdm.run()
    return fdm


OF = {
    "lift": "forces/fwz-aero-lbs",
    "drag": "forces/fwx-aero-lbs",
    "pitch": "moments/m-aero-lbsft",
}
"""What of the aircraft each part adds to, at the centre of gravity."""


def once_more(factor: str = "", value: float = 1.0) -> dict[str, float]:
    """Forces and moments of one state, where JSBSim holds, with a factor that is set there."""
    fdm = fw8()
    fdm.suspend_integration()
    if factor:
        fdm[factor] = value
    fdm.run()
    names = [*OF.values(), *(f"aero/{part}" for part in OF)]
    names += ["forces/fbx-external-lbs", "propulsion/engine/thrust-lbs", "moments/m-external-lbsft"]
    names += ["propulsion/engine/z-position", "inertia/cg-z-in"]
    return {name: float(fdm[name]) for name in names}


@pytest.mark.parametrize("part", list(OF))
def test_a_factor_changes_its_own_force_by_exactly_that_share(part: str) -> None:
    before, after = once_more(), once_more(f"factor/{part}", 1.13)
    for name in (f"aero/{p}" for p in OF):
        wanted = 1.13 if name == f"aero/{part}" else 1.0
        assert after[name] == pytest.approx(wanted * before[name], rel=EXACT), name
        assert abs(before[name]) > 0.01
    felt = OF[part]  # to the sideslip's cosine, with the lift's sign up and the moment about the reference point
    assert abs(after[felt] - before[felt]) == pytest.approx(0.13 * abs(before[f"aero/{part}"]), rel=1e-3)


def test_a_thrust_factor_adds_its_share_of_the_thrust() -> None:
    before, after = once_more(), once_more("factor/thrust", 0.9)
    assert before["forces/fbx-external-lbs"] == 0.0
    assert before["propulsion/engine/thrust-lbs"] > 0.5
    thrust = after["propulsion/engine/thrust-lbs"]
    assert thrust == pytest.approx(before["propulsion/engine/thrust-lbs"], rel=EXACT)
    assert after["forces/fbx-external-lbs"] == pytest.approx(-0.1 * thrust, rel=EXACT)
    arm = (after["propulsion/engine/z-position"] - after["inertia/cg-z-in"]) / 12.0
    assert after["moments/m-external-lbsft"] == pytest.approx(0.1 * thrust * arm, abs=1e-9)


@pytest.mark.parametrize(
    ("given", "element", "lacks"),
    [
        ("aircraft.lift_factor=1.1", '<property value="1">factor/lift</property>', "factor/lift"),
        ("aircraft.mass_factor=1.1", '<property value="4">ballast/fore-pointmass</property>', "ballast/fore-pointmass"),
        ("aircraft.cg_shift=0.01", '<property value="5">ballast/aft-pointmass</property>', "ballast/aft-pointmass"),
    ],
)
def test_an_aircraft_that_cannot_be_varied_is_refused_with_what_it_lacks(
    tmp_path: Path, given: str, element: str, lacks: str
) -> None:
    model = own(tmp_path, {element: "", "<property>factor/lift</property>": "<value>1</value>"})
    scenario = load_scenario("catapult", overrides=[f"aircraft.model={model}", given])
    with pytest.raises(ValueError, match=rf"^aircraft\.\w+ = [\d.]+: .* lacks the property '{lacks}'") as caught:
        Cosimulation(scenario)
    assert len(str(caught.value).splitlines()) == 1
    Cosimulation(load_scenario("catapult", overrides=[f"aircraft.model={model}"]))  # as it is it flies


def test_a_ballast_that_is_no_point_mass_is_refused(tmp_path: Path) -> None:
    old = '<property value="4">ballast/fore-pointmass</property>'
    model = own(tmp_path, {old: old.replace("4", "9")})
    scenario = load_scenario("catapult", overrides=[f"aircraft.model={model}", "aircraft.mass_factor=1.1"])
    with pytest.raises(ValueError, match=r"lacks the property 'inertia/pointmass-location-X-inches\[9\]'"):
        Cosimulation(scenario)


def own(folder: Path, changes: dict[str, Any]) -> Path:
    """fw8 in a folder of one's own, with changes of its text."""
    place = folder / "fw8"
    shutil.copytree(hangar() / "fw8", place)
    file = place / "fw8.xml"
    text = file.read_text()
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    file.write_text(text)
    return place


def test_a_heavier_aircraft_leaves_the_rail_slower_as_energy_says() -> None:
    """v² ≈ 2 s (F/m - g sin θ - friction): to 1 %, for what the push's rise and fall take is not in it."""
    speeds = []
    for factor in (1.0, 1.1):
        simulation = Cosimulation(load_scenario("catapult", overrides=["duration=6", f"aircraft.mass_factor={factor}"]))
        while not simulation.ended and simulation.plant.on_rail:
            simulation.advance(50)
        truth = simulation.plant.truth()
        speeds.append(float(truth["airspeed"][-1]))
    scenario = load_scenario("catapult")
    g, slope = 9.80665, math.radians(scenario.launcher.elevation_deg)
    against = g * (math.sin(slope) + scenario.launcher.friction * math.cos(slope))
    push = scenario.launcher.peak_specific_force_g * g * draw(scenario).force_factor
    assert (speeds[1] / speeds[0]) ** 2 == pytest.approx((push / 1.1 - against) / (push - against), rel=0.01)
