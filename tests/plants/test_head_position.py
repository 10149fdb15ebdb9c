"""The air-data head moves with ω × r beside the centre of gravity, and reads the flow where it is.

Authority: kinematics of a rigid body, v = v_0 + ω × r, with vectors written out here. The aircraft stands still in
JSBSim while its row is turned by hand, so speed, angles and rates are free. JSBSim's inch is off by 1e-9.
"""

from typing import Any

import numpy as np
import pytest

import uavsim
from uavsim import airdata
from uavsim.plants.columns import AT_HEAD, CENTRE, INCH, INDEX, PSF, RANKINE, ROW
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.scenario import Scenario

FT = 0.3048


@pytest.fixture(scope="module")
def plant() -> JsbsimPlant:
    return JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.5, 0.2, head_position=(0.65, -0.2, 0.1)))


def turned(plant: JsbsimPlant, **values: float) -> JsbsimPlant:
    """Let it have these values now, JSBSim's units."""
    row = list(plant.row)
    for name, value in values.items():
        row[INDEX[name]] = value
    plant.row = tuple(row)
    return plant


def arm(plant: JsbsimPlant) -> np.ndarray:
    """From the centre of gravity to the head, body axes, m, from the eyepoint at 0.6 m."""
    x, y, z = np.array(CENTRE(plant.row)) * INCH
    return np.array([x - 0.6 + 0.65, -0.2 - y, 0.1 + z])


def velocity(speed: float, alpha: float, beta: float) -> np.ndarray:
    return speed * np.array([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])


@pytest.mark.parametrize(
    "rates", [(0.0, 2.0, 0.0), (0.0, 0.0, -3.0), (4.0, 0.0, 0.0), (0.0, -1.0, 0.0), (1.0, -2.0, 1.5)]
)
@pytest.mark.parametrize(("speed", "alpha", "beta"), [(25.0, 0.1, -0.05), (30.0, -0.2, 0.3), (12.0, 0.0, 0.0)])
def test_the_flow_at_the_head_is_that_of_a_point_that_turns(
    plant: JsbsimPlant, speed: float, alpha: float, beta: float, rates: tuple[float, float, float]
) -> None:
    """About y alone q (z, 0, -x), about z alone r (-y, x, 0), about x alone p (0, -z, y), and all at once."""
    p, q, r = rates
    x, y, z = arm(plant)
    expected = velocity(speed, alpha, beta)
    expected = expected + q * np.array([z, 0.0, -x]) + r * np.array([-y, x, 0.0]) + p * np.array([0.0, -z, y])
    mach = speed / 340.0
    here = turned(plant, airspeed=speed / FT, mach=mach, alpha=alpha, beta=beta, p=p, q=q, r=r)
    total, static, _, found, a, b, _ = here.flow()
    assert found * 340.0 == pytest.approx(np.linalg.norm(expected), rel=1e-8)
    assert velocity(found * 340.0, a, b) == pytest.approx(expected, abs=1e-7)
    assert total == pytest.approx(airdata.isentropic_total(static, found), rel=1e-14)


def test_a_head_that_turns_in_still_air_feels_its_own_motion(plant: JsbsimPlant) -> None:
    """3 rad/s about y at no airspeed: |ω| times the arm in the plane, over the speed of sound of the air."""
    here = turned(plant, airspeed=0.0, mach=0.0, alpha=0.0, beta=0.0, p=0.0, q=3.0, r=0.0)
    _, _, temperature, mach, alpha, beta, _ = here.flow()
    x, _, z = arm(plant)
    assert mach * airdata.speed_of_sound(temperature) == pytest.approx(3.0 * np.hypot(x, z), rel=1e-8)
    assert (alpha, beta) == pytest.approx((np.arctan2(-x, z), 0.0), rel=1e-8)


def test_what_cannot_turn_so_fast_is_left_alone(plant: JsbsimPlant) -> None:
    """A flight about to diverge must end as one, not raise: rates without bounds are not followed."""
    here = turned(plant, airspeed=30.0 / FT, mach=0.09, alpha=0.1, beta=0.0, p=0.0, q=1e200, r=0.0)
    assert here.flow()[3] == 0.09
    assert turned(plant, q=np.nan).flow()[3] == 0.09


class AtCentre(JsbsimPlant):
    """Its head is wherever the centre of gravity is."""

    def _beside(self, here: Any) -> Any:
        self._head = tuple(here[AT_HEAD.index(name)] for name in ("cg_x", "cg_y", "cg_z"))
        return super()._beside(here)


def test_a_head_at_the_centre_of_gravity_reads_the_truth_bit_for_bit() -> None:
    """Through stroke, tip-off and opening: no arm, no rounding."""
    plant = AtCentre(Run(EnvironmentSettings(wind_speed=5.0), LauncherSettings(), 1.2, 0.2))
    for k in range(1200):
        if k == 650:
            plant.command((1.0, 0.0, 0.1, 0.0, 1.0))
        plant.step()
        if k % 100 == 50:
            truth = {name: plant.row[INDEX[name]] for name in ("mach", "alpha", "beta", "p_static", "temperature")}
            static = truth["p_static"] * PSF
            total = airdata.isentropic_total(static, truth["mach"])
            temperature = truth["temperature"] * RANKINE
            angles = (truth["mach"], truth["alpha"], truth["beta"])
            assert plant.flow()[:6] == (total, static, temperature, *angles)
            rows = [ROW.unpack_from(plant._buffer, (plant.k - i) * ROW.size) for i in (1, 0)]
            (mach0, static0), (mach1, static1) = ((row[INDEX["mach"]], row[INDEX["p_static"]]) for row in rows)
            time = plant.t - 0.25e-3
            share = time * 1000.0 - (plant.k - 1)
            between = (static0 + share * (static1 - static0)) * PSF
            assert plant.air(time)[:2] == (airdata.isentropic_total(between, mach0 + share * (mach1 - mach0)), between)


def test_a_reading_in_between_and_the_flow_of_a_step_agree() -> None:
    """`air` at the time of a step gives what `flow` gave then, where the head moves beside the centre of gravity.

    Within a step it changes by less than 0.1 Pa: how the head moves is the nearest row's.
    """
    plant = JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.9, 0.2, head_position=(0.65, 0.3, -0.2)))
    seen = []
    for _ in range(800):
        plant.step()
        seen.append((plant.t, plant.flow()[:3]))
    beside = 0.0
    for time, (total, static, temperature) in seen[450::30]:
        assert plant.air(time) == pytest.approx((total, static, temperature), rel=1e-9)
        assert plant.air(time + 0.499e-3)[0] == pytest.approx(plant.air(time + 0.501e-3)[0], abs=0.1)
        mach = plant.truth()["mach"][round(1000 * time)]
        beside = max(beside, abs(total - airdata.isentropic_total(static, mach)))
    assert beside > 1.0  # Pa


def test_the_default_is_the_tube_on_fw8s_nose() -> None:
    """Its mouth is 50 mm ahead of the nose, which is the origin of the structural axes, as the survey has it."""
    from uavsim.studies.survey.flow import PIPE

    run = Run(EnvironmentSettings(), LauncherSettings(), 0.1, 0.2, head_position=Scenario().air_data.position)
    assert np.array(JsbsimPlant(run)._head) * INCH == pytest.approx([-PIPE, 0.0, 0.0], abs=1e-9)


def test_where_the_head_is_changes_what_is_read_and_not_what_is_true() -> None:
    """One step of the plant's truth is the same bit for bit; before the first command, which readings bring about."""
    changes = ("duration=4.2", "launcher.wait_min=2", "launcher.wait_max=2.1", "requirements=[]")
    here, there = (
        uavsim.fly("catapult", overrides=(*changes, f"air_data.position={place}"))
        for place in ("[0,0,0]", "[2,0.5,-1]")
    )
    same = here.truth["t"] < here.score["flight"]["rail_exit_time"]
    for name in ("airspeed", "mach", "p_total", "alpha", "beta"):
        assert np.array_equal(here.truth[name][same], there.truth[name][same])
    after = here.air_data["t"] > here.score["flight"]["rail_exit_time"] - 0.01
    assert (here.air_data["p_total"] - there.air_data["p_total"])[after].abs().max() > 2.0  # Pa
