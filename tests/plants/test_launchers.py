"""What pushes, by itself: a mass on a frictionless line against closed forms, energy balances, recorded strokes."""

from math import sqrt
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest

from uavsim.cosim import draw, shaken
from uavsim.plants.launchers.bungee import MOVING, Bungee
from uavsim.plants.launchers.electromechanical import Electromechanical
from uavsim.plants.launchers.pneumatic import CRITICAL, GAMMA, Pneumatic, outflow
from uavsim.plants.launchers.push import Load, Push, through_carriage
from uavsim.plants.launchers.settings import BungeeSettings, ElectromechanicalSettings, PneumaticSettings
from uavsim.scenario import load_scenario

if TYPE_CHECKING:
    from uavsim.plants.plant import Plant

UP = 9.81 * 0.2164  # g sin 12.5°, m/s²
STEP = 1e-3


def load(mass: float = 8.0, *, backward: float = UP, stroke: float = 50.0, **more: Any) -> Load:
    return Load(mass, backward, stroke, STEP, **more)


def run(push: Push, on: Load, *, end: float = 1.5, way_end: float = 50.0) -> np.ndarray:
    """Time, way, speed and force of each step: the force is the mean of a step, as the rail asks for it."""
    rows, way, speed = [], 0.0, 0.0
    for k in range(round(end / STEP)):
        middle = speed + 0.5 * STEP * (rows[-1][3] / on.mass - on.backward if rows else 0.0)
        force = push.mean(k * STEP, way, max(middle, 0.0), 1.0, 0.0)
        rows.append((k * STEP, way, speed, force))
        change = STEP * max(force / on.mass - on.backward, 0.0 if way <= 0.0 else -np.inf)  # the stop behind it
        way += STEP * (speed + 0.5 * change)
        speed += change
        if way >= way_end:
            break
    return np.array(rows)


# -- through a carriage ----------------------------------------------------------------------------------------------


def test_aircraft_and_carriage_move_together() -> None:
    """Newton for both: what is left of the drive after the carriage accelerates is what the aircraft has."""
    on, carriage, friction, against, drive = load(8.0), 4.0, 30.0, 5.0, 900.0
    force = through_carriage(drive, on, carriage, friction, against)
    common = (drive - friction - against) / (8.0 + carriage) - UP
    assert (force - against) / 8.0 - UP == pytest.approx(common, rel=1e-12)
    assert through_carriage(10.0, on, carriage, friction, 0.0) == 0.0  # it pushes and does not pull


# -- cord ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mass", [4.0, 8.0, 16.0])
def test_a_cord_gives_the_speed_of_its_energy(mass: float) -> None:
    """½ (m + M/3) v² = (1 − h) k S²/2 − (m + M/3) g sin θ · S, to 0.1 %."""
    settings, on = BungeeSettings(stiffness=140.0, stretch=6.5, hysteresis=0.2, mass=2.4), load(mass)
    rows = run(Bungee(settings, on), on, way_end=6.5)
    moved = mass + MOVING * 2.4
    energy = 0.8 * 140.0 * 6.5**2 / 2.0 - moved * UP * 6.5
    assert rows[-1, 2] == pytest.approx(sqrt(2.0 * energy / moved), rel=1e-3)


def test_a_cord_that_is_slack_pulls_no_more() -> None:
    cord = Bungee(BungeeSettings(stretch=3.0), load())
    assert cord.mean(0.5, 2.99, 1.0, 1.0, 0.0) > 0.0
    assert cord.mean(0.5, 3.0, 1.0, 1.0, 0.0) == 0.0


# -- compressed air --------------------------------------------------------------------------------------------------


def test_outflow_of_an_orifice() -> None:
    """At γ = 1.4 the greatest is 0.6847 (ISO 6358's 0.0404 kg/(s N)·√K for air), below the critical ratio of 0.5283."""
    assert pytest.approx(0.5283, abs=1e-4) == CRITICAL
    assert outflow(0.2) == outflow(CRITICAL) == pytest.approx(0.6847, abs=1e-4)
    assert 0.0 < outflow(0.9) < outflow(0.6) < outflow(0.53)
    assert outflow(1.0) == outflow(1.2) == 0.0


def test_with_a_valve_that_is_wide_open_both_volumes_are_one_adiabatic_gas() -> None:
    """p (V₁ + V₂)^γ stays as it is, however the gas is shared and whatever it was throttled through: to 0.5 %."""
    settings = PneumaticSettings(valve=1.0, opening=0.001, dead=1e-5, travel=50.0, efficiency=1.0)
    on = load(8.0)
    air = Pneumatic(settings, on)
    start = (air.vessel * settings.vessel + air.cylinder * settings.dead) / (settings.vessel + settings.dead)
    rows = run(air, on, way_end=5.0)
    volume = settings.vessel + settings.dead + np.pi / 4.0 * settings.bore**2 * rows[-1, 1] / settings.ratio
    expected = start * ((settings.vessel + settings.dead) / volume) ** GAMMA
    assert air.cylinder == pytest.approx(expected, rel=5e-3)
    assert air.vessel == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("valve", [0.015, 0.04])
def test_what_the_gas_loses_is_what_it_moves(valve: float) -> None:
    """Σ pV/(γ − 1) against the energy of aircraft and carriage, friction and the air that is pushed away: 0.5 %."""
    settings, on = PneumaticSettings(valve=valve, efficiency=1.0, travel=50.0), load(8.0)
    air = Pneumatic(settings, on)
    before = (air.vessel * settings.vessel + air.cylinder * settings.dead) / (GAMMA - 1.0)
    rows = run(air, on, way_end=5.0)
    way, speed = rows[-1, 1] + STEP * rows[-1, 2], rows[-1, 2] + STEP * (rows[-1, 3] / on.mass - UP)
    swept = np.pi / 4.0 * settings.bore**2 * way / settings.ratio
    after = (air.vessel * settings.vessel + air.cylinder * (settings.dead + swept)) / (GAMMA - 1.0)
    moved = on.mass + settings.carriage
    work = 0.5 * moved * speed**2 + moved * UP * way + settings.friction * way + on.pressure * swept
    assert before - after == pytest.approx(work, rel=5e-3)


@pytest.mark.parametrize("kind", [Pneumatic, Bungee])
def test_a_heavier_aircraft_leaves_slower_and_with_more_energy(kind: Any) -> None:
    settings = PneumaticSettings() if kind is Pneumatic else BungeeSettings()
    light, heavy = (run(kind(settings, load(mass)), load(mass), way_end=5.0)[-1] for mass in (8.0, 11.1))
    assert heavy[2] < 0.93 * light[2]
    assert 11.1 * heavy[2] ** 2 > 8.0 * light[2] ** 2


def test_a_piston_that_has_met_its_end_pushes_no_more() -> None:
    air = Pneumatic(PneumaticSettings(travel=2.0), load())
    rows = run(air, load(), way_end=4.0)
    assert (rows[rows[:, 1] > 2.0, 3] == 0.0).all()
    assert (rows[(rows[:, 1] > 0.1) & (rows[:, 1] < 1.9), 3] > 100.0).all()


# -- a motor that follows a curve ------------------------------------------------------------------------------------


@pytest.mark.parametrize("mass", [5.0, 8.0, 10.0])
def test_the_recorded_strokes_are_flown_whatever_the_mass(mass: float) -> None:
    """The mean of 90 of them: 66 m/s² to 0.18 s, 53 from 0.28 s, zero at 0.611 s; 30.5 m/s over 10.6 m."""
    on = load(mass)
    rows = run(Electromechanical(ElectromechanicalSettings(), on), on, end=0.611)
    felt = rows[:, 3] / mass - UP
    assert felt.max() == pytest.approx(65.5, abs=2.0)
    assert np.median(felt[40:175]) == pytest.approx(66.0, abs=0.5)
    assert np.median(felt[285:465]) == pytest.approx(53.0, abs=0.5)
    assert rows[-1, 2] == pytest.approx(30.5, abs=0.5)
    assert rows[-1, 1] == pytest.approx(10.6, abs=0.2)


def test_beyond_its_greatest_force_a_motor_falls_behind_its_curve() -> None:
    on = load(24.0)
    rows = run(Electromechanical(ElectromechanicalSettings(), on), on, end=0.611)
    assert rows[:, 3].max() == pytest.approx((24.0 * (1200.0 - 15.0)) / 29.0, rel=1e-6)
    assert rows[-1, 2] < 25.0


# -- what is wrong ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (('launcher.kind="bungee"', "launcher.rise=0.05"), "launcher.rise: is not read by launcher.kind = 'bungee'"),
        (("launcher.bungee.mass=1",), "launcher.bungee: is not read by launcher.kind = 'ideal'"),
        (("launcher.ends_at=5.2",), "launcher.ends_at = 5.2 m: must be below launcher.stroke = 5.2 m"),
        (
            ('launcher.kind="electromechanical"', "launcher.electromechanical.curve=[[0.2,5],[0.1,3]]"),
            "launcher.electromechanical.curve: its times must rise",
        ),
    ],
)
def test_what_cannot_be_is_said_in_a_line(overrides: tuple[str, ...], says: str) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*$") as error:
        load_scenario("catapult", overrides=overrides)
    assert says in str(error.value)


def test_a_rig_has_no_machine() -> None:
    with pytest.raises(ValueError, match=r"launcher\.kind: is not read by plant\.kind = 'centrifuge', a rig"):
        load_scenario("centrifuge-4g", overrides=('launcher.kind="bungee"',))


def test_a_plant_that_does_not_say_what_its_machine_does_makes_nothing_ring() -> None:
    """One of somebody else's flies with a bungee all the same."""
    flown = load_scenario("catapult", overrides=('launcher.kind="bungee"',))
    assert shaken(flown, draw(flown), cast("Plant", object())) == (0.0, flown.launcher.rise)
