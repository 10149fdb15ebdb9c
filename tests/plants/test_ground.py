"""What touches the ground ends a flight: the centre of gravity, or off the rail any point of contact of the aircraft.

fw8 has no point of contact; here it gets a wheel under the nose and a bumper under the tail.
"""

from dataclasses import replace
from pathlib import Path

import hostile_aircraft as hostile
import numpy as np
import pytest

import uavsim
from uavsim.cosim import Cosimulation, replay
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings
from uavsim.scenario import load_scenario

WHEEL = -0.3  # m, of the wheel and the bumper below the axis
SHORT = ("launcher.wait_min=1.7", "launcher.wait_max=1.8", "duration=12", "requirements=[]")
FALLS = (*SHORT, "launcher.peak_specific_force_g=5.2", "launcher.stroke=3", "launcher.elevation_deg=3")


@pytest.fixture(scope="module")
def wheeled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    coefficients = "<static_friction>0.8</static_friction><dynamic_friction>0.5</dynamic_friction>"
    coefficients += '<spring_coeff unit="N/M">3000</spring_coeff><damping_coeff unit="N/M/SEC">200</damping_coeff>'
    points = "".join(
        f'<contact type="{kind}" name="{name}"><location unit="M"><x>{x}</x><y>0</y><z>{WHEEL}</z></location>'
        f"{coefficients}</contact>"
        for kind, name, x in (("BOGEY", "wheel", 0.2), ("STRUCTURE", "bumper", 1.4))
    )
    files = hostile.packaged()
    empty = b"<ground_reactions></ground_reactions>"
    assert files["fw8.xml"].count(empty) == 1
    files["fw8.xml"] = files["fw8.xml"].replace(empty, f"<ground_reactions>{points}</ground_reactions>".encode())
    return hostile.write(files, tmp_path_factory.mktemp("wheeled") / "fw8")


def lowest(truth: dict[str, np.ndarray], row: int) -> float:
    """Height of the lower of the two points of contact above the ground, m, from attitude and place alone."""
    heights = []
    for x in (0.2, 1.4):
        forward, down = truth["cg_x"][row] - x, truth["cg_z"][row] - WHEEL
        pitch, roll = truth["pitch"][row], truth["roll"][row]
        sunk = -np.sin(pitch) * forward + np.cos(pitch) * np.cos(roll) * down
        heights.append(truth["altitude"][row] - sunk)
    return float(min(heights))


def test_the_lowest_point_touches(wheeled: Path) -> None:
    """Within a step's sink of the ground, and the step before nothing had touched it."""
    plant = _fallen(wheeled)
    truth = plant.truth()
    assert plant.finite
    assert truth["altitude"][-1] > 0.1
    assert lowest(truth, -1) <= 0.0 < lowest(truth, -2)


def test_without_points_of_contact_it_is_the_centre_of_gravity() -> None:
    truth = _fallen("fw8").truth()
    assert truth["altitude"][-1] <= 0.0 < truth["altitude"][-2]


def _fallen(model: Path | str) -> JsbsimPlant:
    """Launch too weakly to fly, and go on until it touches."""
    launcher = LauncherSettings(peak_specific_force_g=4.0, stroke=2.0, elevation_deg=5.0)
    plant = JsbsimPlant(Run(EnvironmentSettings(), launcher, 5.0, 0.2, aircraft=AircraftSettings(model=str(model))))
    while plant.aloft and plant.t < 5.0:
        plant.step()
    assert not plant.aloft
    assert not plant.on_rail
    return plant


def test_wheels_on_the_ground_do_not_end_it_on_the_rail(wheeled: Path) -> None:
    """0.3 m above the ground they stand 10 mm in it until the rail is left, and then the flight is over at once."""
    launcher = LauncherSettings(height=0.3, elevation_deg=0.0)
    aircraft = AircraftSettings(model=str(wheeled))
    plant = JsbsimPlant(Run(EnvironmentSettings(), launcher, 1.0, 0.2, aircraft=aircraft))
    while plant.on_rail:
        plant.step()
        assert plant.aloft or not plant.on_rail
    assert plant.k > 300
    assert not plant.aloft


@pytest.mark.parametrize("own", [True, False])
def test_a_flight_that_falls_says_how_it_touched(own: bool, wheeled: Path) -> None:
    model = (f"aircraft.model={wheeled}",) if own else ()
    flight = uavsim.fly("catapult", seed=2, overrides=(*FALLS, *model))
    last = flight.truth.iloc[-1]
    assert flight.score["outcome"] == "crashed"
    assert flight.score["flight"]["duration"] < 12.0
    assert flight.score["reason"].startswith(
        f"touched the ground at {last['t']:.2f} s: sink {last['vd']:.2f} m/s, "
        f"roll {np.degrees(last['roll']):z.0f}°, pitch {np.degrees(last['pitch']):z.0f}°; "
        f"{last['north']:.0f} m ahead of the launcher"
    )
    again = replay(flight)
    assert again.score == flight.score


@pytest.mark.parametrize(("height", "outcome"), [(-4.0, "landed"), (-15.0, "crashed")])
def test_an_aircraft_that_sinks_gently_has_landed(height: float, outcome: str) -> None:
    """From level flight it is told to hold a height below the ground: the deeper, the steeper it comes down."""
    flown = Cosimulation(load_scenario("catapult", overrides=["duration=30", "requirements=[]", f"expect={outcome}"]))
    flown.advance(9000)
    computer = flown.onboard.computer
    computer.settings = replace(computer.settings, height=height)
    flown.advance(flown.steps)
    flight = flown.finish()
    last = flight.truth.iloc[-1]
    assert flight.score["outcome"] == outcome
    assert (last["vd"] < 1.5) == (outcome == "landed")
    assert -0.01 < last["altitude"] <= 0.0
    assert f"sink {last['vd']:.2f} m/s" in flight.score["reason"]


def test_a_flight_that_does_not_touch_does_not_say_so() -> None:
    flight = uavsim.fly("catapult", overrides=("duration=5", "requirements=[]"))
    assert flight.score["outcome"] == "timeout"
    assert "touched" not in flight.score["reason"]
