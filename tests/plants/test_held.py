"""Whether the rail's springs survive a step: frequencies against closed forms, and stability against JSBSim itself.

The shoes are moved apart along fw8 by its properties: moments of inertia that are small against their distance make a
stiff mode of pitch and yaw.
"""

import math

import numpy as np
import pytest

from uavsim.plants import held
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import STEP_RATES, Run
from uavsim.plants.rail import CONTACT_FREQUENCY, ROLL_FREQUENCY
from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings

MASS = 8.0
INCH = 0.0254


def frequencies(inertia: tuple[float, ...], front: float, rear: float) -> list[float]:
    springs, _ = held._per_inertia(MASS, inertia, (front, 0.0, 0.1), (rear, 0.0, 0.1))
    return sorted(float(f) for f in np.sqrt(np.abs(np.linalg.eigvals(springs))) / (2.0 * math.pi))


def test_frequencies_are_those_of_a_body_on_two_springs() -> None:
    """Shoes alike before and behind: heave and sway 40 Hz, roll 15 Hz, pitch and yaw 40 Hz b √(m/I), b the arm."""
    arm, yy, zz = 0.3, 1.3, 0.5
    pitch, yaw = (CONTACT_FREQUENCY * arm * math.sqrt(MASS / inertia) for inertia in (yy, zz))
    expected = sorted([CONTACT_FREQUENCY, CONTACT_FREQUENCY, ROLL_FREQUENCY, pitch, yaw])
    assert frequencies((0.03, yy, zz, 0.0, 0.0, 0.0), arm, -arm) == pytest.approx(expected)


def test_heave_and_pitch_are_coupled_by_shoes_that_are_not_alike() -> None:
    """Roots of (k − m ω²)(k (a² + b²)/2 − I ω²) = (k (a + b)/2)² with both shoes ahead, a and b from the centre."""
    a, b, inertia = 0.5, 0.1, 0.9
    k = MASS * (2.0 * math.pi * CONTACT_FREQUENCY) ** 2
    rotation, coupling = 0.5 * k * (a * a + b * b), 0.5 * k * (a + b)
    squares = np.roots([MASS * inertia, -(k * inertia + rotation * MASS), k * rotation - coupling**2])
    found = frequencies((0.03, inertia, inertia, 0.0, 0.0, 0.0), a, b)
    for square in squares:
        assert sum(f == pytest.approx(math.sqrt(square) / (2.0 * math.pi)) for f in found) == 2  # pitch and yaw


def apart(distance: float, rate: float, monkeypatch: pytest.MonkeyPatch | None = None) -> JsbsimPlant:
    """Load fw8 with its shoes so far apart, m, about its eyepoint; with a patch, however it swings."""
    if monkeypatch is not None:
        monkeypatch.setattr(held, "problem", lambda *_: "")
    places = {"front": 0.6 - 0.5 * distance, "rear": 0.6 + 0.5 * distance}
    properties = {
        f"external_reactions/{end}-shoe-{kind}/location-x-in": place / INCH
        for end, place in places.items()
        for kind in ("normal", "lateral")
    }
    run = Run(
        EnvironmentSettings(),
        LauncherSettings(),
        0.4,
        5.0,
        step_rate=rate,
        aircraft=AircraftSettings(properties=properties),
    )
    return JsbsimPlant(run)


@pytest.mark.parametrize(("distance", "rate"), [(0.45, 1000), (1.25, 1000), (1.3, 2000), (1.8, 2000), (2.0, 4000)])
def test_what_is_let_through_rests(distance: float, rate: int) -> None:
    plant = apart(distance, float(rate))
    for _ in range(rate // 5):
        plant.step()
    truth = plant.truth()
    assert np.abs(truth["q"]).max() < 1e-6
    assert np.abs(truth["r"]).max() < 1e-6


@pytest.mark.parametrize(("distance", "rate", "needed"), [(1.3, 1000, 2000), (1.4, 1000, 2000), (2.0, 2000, 4000)])
def test_what_is_refused_would_have_shaken_itself_apart(
    distance: float, rate: int, needed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bound is JSBSim's own, to 4 % of the distance: 1.25 m rests at 1 kHz, 1.3 m does not."""
    with pytest.raises(ValueError, match=rf"^plant.step_rate = {rate}: the aircraft swings .* it takes {needed} Hz$"):
        apart(distance, float(rate))
    plant = apart(distance, float(rate), monkeypatch)
    for _ in range(rate // 5):
        plant.step()
    assert not abs(plant.truth()["q"][-1]) < 1.0  # rad/s, or no number at all


def test_500_hz_is_too_coarse_for_any_aircraft_on_40_hz(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"^plant.step_rate = 500: the aircraft swings on its shoes at 40 Hz"):
        apart(0.45, 500.0)
    plant = apart(0.45, 500.0, monkeypatch)
    assert not plant.finite


def test_where_no_step_helps_it_is_the_aircraft() -> None:
    said = held.problem(MASS, (0.03, 0.01, 0.01, 0.0, 0.0, 0.0), (1.0, 0.0, 0.1), (-1.0, 0.0, 0.1), 1000.0)
    assert said.startswith(
        "aircraft.model: the aircraft swings on its shoes at 1131 Hz, which no plant.step_rate up to"
    )
    assert "\n" not in said


@pytest.mark.parametrize("rate", STEP_RATES)
def test_fw8_is_held_at_every_rate(rate: int) -> None:
    assert apart(0.45, float(rate)).finite
