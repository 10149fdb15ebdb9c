"""The launch against mechanics: statics on the rail, work and energy, tip-off, free fall, kinematics.

Authority: Newton-Euler mechanics, evaluated here independently of the plant's own formulas. In "vacuum" JSBSim's air
density is overridden with zero, so drag and lift vanish and only rail, push and gravity are left.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from references import two_shoes

from uavsim.plants.columns import FT, INCH, INDEX, SLUG, SLUG_FT2
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.rail import CONTACT_FREQUENCY, DAMPING_RATIO, body_axes
from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings
from uavsim.truth import STANDARD_GRAVITY

RELEASE = 0.2
WIND = EnvironmentSettings(wind_speed=6.0, wind_from_deg=0.0)


class Vacuum(JsbsimPlant):
    """The plant without air."""

    def _load(self, aircraft: AircraftSettings) -> Any:
        fdm = super()._load(aircraft)
        fdm.set_property_value("atmosphere/override/density", 0.0)
        return fdm


def launch(
    launcher: LauncherSettings, kind: type[JsbsimPlant] = JsbsimPlant, duration: float = 1.0, **more: Any
) -> JsbsimPlant:
    settings = Run(more.pop("environment", EnvironmentSettings()), launcher, duration, RELEASE, **more)
    plant = kind(settings)
    for _ in range(round(duration * 1000)):
        plant.step()
    return plant


@pytest.fixture(scope="module")
def catapult() -> JsbsimPlant:
    return launch(LauncherSettings())


@pytest.fixture(scope="module")
def in_vacuum() -> JsbsimPlant:
    return launch(LauncherSettings(friction=0.0), Vacuum)


def gravity(plant: JsbsimPlant) -> float:
    return plant._value("accelerations/gravity-ft_sec2") * FT


@pytest.mark.parametrize("elevation", [0.0, 5.0, 12.5, 35.0])
def test_specific_force_at_rest_is_gravity_turned_by_the_rail(elevation: float) -> None:
    plant = launch(LauncherSettings(elevation_deg=elevation), duration=0.15)
    truth, g, angle = plant.truth(), gravity(plant), np.radians(elevation)
    expected = g * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    felt = np.array([truth[name] for name in ("fx", "fy", "fz")])
    assert np.abs(felt - expected[:, None]).max() < 0.005 * g
    assert np.abs(truth["rail_s"]).max() < 1e-5


def test_constant_push_reaches_the_speed_of_uniform_acceleration() -> None:
    """v = sqrt(2 a s) within 1 %, a = push/m - g sin(theta), without drag, friction, rise and fall."""
    launcher = LauncherSettings(friction=0.0, rise=0.001, fall=0.001, peak_specific_force_g=6.0, elevation_deg=20.0)
    plant = launch(launcher, Vacuum)
    truth = plant.truth()
    left = np.argmax(truth["rail_s"] >= launcher.stroke)
    acceleration = 6.0 * STANDARD_GRAVITY - gravity(plant) * np.sin(np.radians(20.0))
    speed = np.hypot(truth["vn"][left], truth["vd"][left])
    assert speed == pytest.approx(np.sqrt(2.0 * acceleration * truth["rail_s"][left]), rel=0.01)


def test_work_of_the_push_becomes_energy(in_vacuum: JsbsimPlant) -> None:
    """Work of the push along the stroke = kinetic + potential + rotational energy within 0.5 %."""
    truth = in_vacuum.truth()
    left = np.argmax(truth["rail_s"] >= 5.2)
    work = np.trapezoid(truth["catapult_force"][: left + 1], truth["rail_s"][: left + 1])
    mass = truth["mass"][0]
    speed2 = truth["vn"] ** 2 + truth["ve"] ** 2 + truth["vd"] ** 2
    energy = 0.5 * mass * speed2[left] + mass * gravity(in_vacuum) * (truth["altitude"][left] - truth["altitude"][0])
    assert work == pytest.approx(energy, rel=0.005)


def test_catapult_is_the_one_of_the_design(catapult: JsbsimPlant) -> None:
    """8 g, 30 ms rise, 60 ms fall, 5.2 m, 12.5°: about 26 m/s after 0.39 s; onset to 1 mm and 4.5 g as computed."""
    truth = catapult.truth()
    left = np.argmax(truth["rail_s"] >= 5.2)
    assert truth["airspeed"][left] == pytest.approx(26.0, abs=0.3)
    assert truth["t"][left] - RELEASE == pytest.approx(0.39, abs=0.01)
    assert 0.012 <= truth["t"][np.argmax(truth["rail_s"] > 1e-3)] - RELEASE <= 0.016
    assert 0.016 <= truth["t"][np.argmax(truth["fx"] > 4.5 * STANDARD_GRAVITY)] - RELEASE <= 0.020
    assert truth["fx"].max() / STANDARD_GRAVITY == pytest.approx(8.0, abs=0.05)


def test_push_dies_away_as_the_stroke_ends(catapult: JsbsimPlant) -> None:
    truth = catapult.truth()
    left = np.argmax(truth["rail_s"] >= 5.2)
    assert truth["catapult_force"][left - 1] < 0.05 * truth["catapult_force"].max()
    assert np.all(truth["catapult_force"][left + 1 :] == 0.0)


CASES = {
    "catapult": LauncherSettings(),
    "steep and short": LauncherSettings(
        stroke=1.7, elevation_deg=50.0, peak_specific_force_g=16.0, rise=0.02, fall=0.02, friction=0.2
    ),
    "level and long": LauncherSettings(
        stroke=10.3, elevation_deg=3.0, peak_specific_force_g=5.0, rise=0.11, fall=0.17, friction=0.0
    ),
    "rough": LauncherSettings(
        stroke=3.1, elevation_deg=35.0, peak_specific_force_g=12.0, rise=0.013, fall=0.041, friction=0.08
    ),
    "weak": LauncherSettings(
        stroke=6.0, elevation_deg=20.0, peak_specific_force_g=3.0, rise=0.05, fall=0.3, friction=0.03
    ),
}


def off_the_rail(
    launcher: LauncherSettings, kind: type[JsbsimPlant], rate: float
) -> tuple[JsbsimPlant, two_shoes.Exit]:
    """Launch until both shoes have left; the truth's first row after that is what a flight is judged by."""
    plant = kind(Run(EnvironmentSettings(), launcher, 2.0, RELEASE, step_rate=rate))
    while plant.on_rail:
        plant.step()
    truth = {name: column[-1] for name, column in plant.truth().items()}
    assert truth["rail_s"] >= launcher.stroke
    speed = float(np.sqrt(truth["vn"] ** 2 + truth["ve"] ** 2 + truth["vd"] ** 2))
    pitch = truth["pitch"] - np.radians(launcher.elevation_deg)
    return plant, two_shoes.Exit(truth["t"] - RELEASE, speed, truth["q"], pitch)


def referred(launcher: LauncherSettings) -> two_shoes.Exit:
    """The same launch by the independent integration, without air."""
    plant = launch(launcher, Vacuum, duration=0.01)
    front, rear = plant._shoe_offsets(plant.row)
    mass = plant.row[INDEX["mass"]] * SLUG
    turning = 7.292115e-5 * np.cos(np.radians(47.0))  # rad/s; what is felt of gravity is less by the earth's rotation
    return two_shoes.fly(
        two_shoes.Launch(
            mass=mass,
            inertia=plant._value("inertia/iyy-slugs_ft2") * SLUG_FT2,
            gravity=gravity(plant) - turning**2 * 6.367e6,
            elevation=float(np.radians(launcher.elevation_deg)),
            front=(front[0], front[2]),
            rear=(rear[0], rear[2]),
            line=(plant._value("inertia/cg-z-in") - plant._value("external_reactions/push/location-z-in")) * INCH,
            push=mass * STANDARD_GRAVITY * launcher.peak_specific_force_g,
            rise=launcher.rise,
            fall=launcher.fall,
            stroke=launcher.stroke,
            friction=launcher.friction,
            frequency=CONTACT_FREQUENCY,
            damping=DAMPING_RATIO,
        )
    )


@pytest.mark.parametrize("case", CASES)
def test_speed_and_tip_off_are_those_of_an_independent_integration(case: str) -> None:
    """Without air, at 1 kHz: speed within 0.01 % and pitch rate within 0.15 % of `references.two_shoes`.

    The row that is judged is up to a step later than the shoe's leaving; so long gravity brakes and the nose turns on.
    """
    launcher = CASES[case]
    expected = referred(launcher)
    plant, found = off_the_rail(launcher, Vacuum, 1000.0)
    late = found.time - expected.time
    assert -1e-4 < late < 1.1e-3
    braked = late * gravity(plant) * np.sin(np.radians(launcher.elevation_deg))
    assert found.speed + braked == pytest.approx(expected.speed, rel=1e-4)
    assert expected.pitch_rate < -0.1
    assert found.pitch_rate == pytest.approx(expected.pitch_rate, rel=1.5e-3)
    assert found.pitch - late * found.pitch_rate == pytest.approx(expected.pitch, abs=np.radians(0.003))


@pytest.mark.parametrize("case", CASES)
def test_nothing_of_the_rail_is_left_once_it_is_left(case: str) -> None:
    """Without air it turns as it did in the first row off the rail, to 1e-4 of it: no force is taken twice, or late."""
    plant, found = off_the_rail(CASES[case], Vacuum, 1000.0)
    for _ in range(6):
        plant.step()
        assert plant.row[INDEX["q"]] == pytest.approx(found.pitch_rate, rel=1e-4)


@pytest.mark.parametrize("kind", [JsbsimPlant, Vacuum])
@pytest.mark.parametrize("case", CASES)
def test_half_the_step_gives_the_same_launch(case: str, kind: type[JsbsimPlant]) -> None:
    """From 1 to 8 kHz: exit speed within 0.05 % and tip-off within 0.5 % of the finest, in air and without."""
    rates = (1000.0, 2000.0, 8000.0)
    *coarser, finest = (off_the_rail(CASES[case], kind, rate)[1] for rate in rates)
    for found in coarser:
        assert found.speed == pytest.approx(finest.speed, rel=5e-4)
        assert found.pitch_rate == pytest.approx(finest.pitch_rate, rel=5e-3)


def test_on_the_rail_the_force_felt_is_that_of_its_row() -> None:
    """As the push rises f_x is the push's at that very time, to 0.01 g: half a step off would be 0.13 g."""
    truth = launch(LauncherSettings(friction=0.0), Vacuum, duration=0.4).truth()
    since = truth["t"] - RELEASE
    rising = (since > 0.0055) & (since < 0.0285)
    felt = truth["fx"][rising] / STANDARD_GRAVITY
    assert felt == pytest.approx(8.0 * since[rising] / 0.030, abs=0.01)


def test_free_fall_reads_nothing(in_vacuum: JsbsimPlant) -> None:
    """After the rail, without air, an ideal accelerometer at the sensor's place reads only its own centripetal part."""
    truth = in_vacuum.truth()
    free = truth["rail_s"] >= 5.2
    free &= truth["t"] > truth["t"][np.argmax(free)] + 0.002
    spin = np.abs(truth["q"][free]).max() ** 2 * 0.1  # m/s^2 at most 0.1 m from the centre of gravity
    for axis in ("fx", "fy", "fz"):
        assert np.abs(truth[axis][free]).max() < 1e-3 + spin


HEAVIER = {"inertia/pointmass-weight-lbs[1]": 1.1}  # the right wing's outer half, 0.57 lb else


@pytest.mark.parametrize(
    ("position", "properties"), [((0.0, 0.0, 0.0), {}), ((0.35, -0.15, 0.1), {}), ((0.35, -0.15, 0.1), HEAVIER)]
)
def test_specific_force_is_the_sensors_acceleration_less_gravity(
    position: tuple[float, float, float], properties: dict[str, float]
) -> None:
    """f = R^T (d2/dt2 of the sensor's place - g), differentiated numerically, through stroke, tip-off and opening.

    In air, wings opening at full speed, with wind: all terms of the lever arm and the moving centre of gravity count;
    with one wing heavier than the other, those to the side, too.
    Tolerance 0.03 m/s^2 rms of a second difference over 4 ms, away from the edges of the contact forces.
    """
    aircraft = AircraftSettings(properties=properties)
    settings = Run(WIND, LauncherSettings(), 1.4, RELEASE, aircraft=aircraft, accelerometer_position=position)
    plant = JsbsimPlant(settings)
    for k in range(1400):
        if k == 700:
            plant.command((1.0, 0.0, 0.1, 0.0, 1.0))
        plant.step()
    truth = plant.truth()
    eye = np.array(plant._eye) * INCH
    offset = np.stack([truth["cg_x"] - eye[0], eye[1] - truth["cg_y"], truth["cg_z"] - eye[2]])
    axes = np.array([np.array(body_axes(a)) for a in zip(truth["roll"], truth["pitch"], truth["heading"], strict=True)])
    place = np.stack([truth["north"], truth["east"], -truth["altitude"]]) + np.einsum("kij,ik->jk", axes, offset)
    step = 2  # rows
    second = (place[:, 2 * step :] - 2.0 * place[:, step:-step] + place[:, : -2 * step]) / (step * 1e-3) ** 2
    second[2] -= gravity(plant)
    expected = np.einsum("kij,jk->ik", axes[step:-step], second)
    felt = np.stack([truth["fx"], truth["fy"], truth["fz"]])[:, step:-step]
    time = truth["t"][step:-step]
    assert truth["wing"][-1] > 0.99
    opening = (time > 0.705) & (time < 1.38)
    pushed = (time > 0.25) & (time < 0.50)
    for rows in (opening, pushed):
        assert np.sqrt(np.mean((felt - expected)[:, rows] ** 2, axis=1)).max() < 0.03


@pytest.mark.parametrize(("level", "low", "high"), [(0.98, 3.9, 4.1), (1.02, 3.9, 4.1)])
def test_weak_push_stays_within_its_tolerance_for_every_force_factor(level: float, low: float, high: float) -> None:
    """4.0 ± 0.1 g of true peak specific force, held for 0.2 s, at both ends of the drawn force factor."""
    plant = launch(LauncherSettings(peak_specific_force_g=4.0), force_factor=level, duration=1.2)
    fx = plant.truth()["fx"] / STANDARD_GRAVITY
    assert low <= fx.max() <= high
    assert np.sum(fx > 0.95 * fx.max()) >= 200  # ms


def test_aircraft_does_not_leave_before_release_nor_roll_in_wind() -> None:
    side = EnvironmentSettings(wind_speed=8.0, wind_from_deg=90.0)
    plant = launch(LauncherSettings(), environment=side, duration=0.6)
    truth = plant.truth()
    waiting = truth["t"] < RELEASE
    assert np.abs(truth["rail_s"][waiting]).max() < 1e-4
    assert np.abs(truth["roll"][truth["rail_s"] < 5.2]).max() < np.radians(0.5)


def test_headwind_is_airspeed_on_the_rail() -> None:
    truth = launch(LauncherSettings(), environment=WIND, duration=0.15).truth()
    """MIL-F-8785C 3.7.3.2: 6 m/s at 20 ft are 6 ln(1.5/0.04572)/ln(6.096/0.04572) = 4.28 m/s at 1.5 m."""
    wind = 6.0 * np.log(1.5 / 0.04572) / np.log(6.096 / 0.04572)
    assert truth["airspeed"] == pytest.approx(wind, rel=1e-3)
    assert truth["wind_n"] == pytest.approx(-wind, rel=1e-5)


def test_gust_has_its_peak_shape_and_time() -> None:
    """A one-minus-cosine gust from ahead, its peak in the middle of its length, `gust_delay` after the wing is out."""
    air = EnvironmentSettings(gust_speed=4.0, gust_length_s=0.4, gust_delay=0.3)
    plant = JsbsimPlant(Run(air, LauncherSettings(), 2.0, RELEASE))
    for k in range(2000):
        if k == 650:
            plant.command((1.0, 0.0, 0.1, 0.0, 1.0))
        plant.step()
    truth = plant.truth()
    out = truth["t"][np.argmax(truth["wing"] >= 0.99)]
    peak = int(np.argmin(truth["wind_n"]))
    assert truth["wind_n"][peak] == pytest.approx(-4.0, rel=0.01)
    assert truth["t"][peak] - out == pytest.approx(0.5, abs=0.005)
    half = truth["t"][truth["wind_n"] < -2.0]
    assert half[-1] - half[0] == pytest.approx(0.2, abs=0.005)
    assert np.abs(truth["wind_n"][truth["t"] < out + 0.29]).max() == 0.0


def test_turbulence_follows_its_seed() -> None:
    air = replace(WIND, turbulence_wind_20ft=7.5)
    first, again, other = (
        launch(LauncherSettings(), environment=air, random_seed=seed).truth()["wind_n"] for seed in (5, 5, 6)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert first.std() > 0.1


def test_mass_is_what_the_aircraft_weighs(catapult: JsbsimPlant) -> None:
    assert catapult.row[INDEX["mass"]] * SLUG == pytest.approx(8.0, abs=0.3)


def test_a_flight_that_diverges_beyond_sound_still_gives_its_record() -> None:
    """The truth's equations take any Mach number; that the state is no longer finite is told, not raised."""
    plant = JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.2, RELEASE))
    for k in range(100):
        if k == 97:
            plant._set("atmosphere/wind-north-fps", 1e9)
        plant.step()
    truth = plant.truth()
    assert truth["mach"].max() > 1.0
    assert len(truth["p_total"]) == 101


def test_the_accelerometers_place_is_forward_right_and_down_of_the_eyepoint() -> None:
    """Structural axes point aft and up: 1 m forward, 2 m right, 3 m down of it, exactly."""
    short = LauncherSettings()
    here, there = (
        JsbsimPlant(Run(EnvironmentSettings(), short, 0.01, RELEASE, accelerometer_position=place))
        for place in ((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    )
    moved = np.subtract(there._lever(there.row), here._lever(here.row))
    assert moved == pytest.approx([1.0, 2.0, 3.0], abs=1e-12)


def test_flow_is_the_recorded_air(catapult: JsbsimPlant) -> None:
    """What the head is stepped with is what it would be asked for afterwards, and the truth's own columns."""
    truth = catapult.truth()
    total, static, temperature, mach, alpha, beta, throttle = catapult.flow()
    assert (total, static, temperature) == pytest.approx(catapult.air(catapult.t), rel=1e-12)
    assert (static, temperature, throttle) == tuple(truth[name][-1] for name in ("p_static", "temperature", "throttle"))
    names = ("mach", "alpha", "beta")
    assert (mach, alpha, beta) == pytest.approx(tuple(truth[name][-1] for name in names), abs=1e-3)


def test_a_centre_of_gravity_that_moves_in_the_body_is_felt() -> None:
    """2 ω × r' + r'' of the accelerometer seen from it, every component away from zero."""
    plant = JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.01, RELEASE))
    velocity, change, rates = np.array([0.3, 0.5, -0.9]), np.array([40.0, -25.0, 60.0]), (1.1, -0.7, 0.4)
    times = -plant.dt * np.arange(4)
    now, *past = (tuple(velocity * t + 0.5 * change * t * t) for t in times)
    plant._offsets = (past[0], past[1], past[2])
    felt = plant._with_moving_cg((1.0, 2.0, 3.0), now, rates)
    assert felt == pytest.approx(np.array([1.0, 2.0, 3.0]) + 2.0 * np.cross(rates, velocity) + change, abs=1e-6)
    assert not plant._still
    still = []
    for _ in range(2):
        plant._with_moving_cg((1.0, 2.0, 3.0), now, rates)
        still.append(plant._still)
    assert still == [False, True]


def test_one_number_that_is_none_is_a_state_that_is_none() -> None:
    plant = JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.01, RELEASE))
    assert plant.finite
    sound = plant.row
    for k in (0, len(sound) // 2, len(sound) - 1):
        plant.row = (*sound[:k], np.inf, *sound[k + 1 :])
        assert not plant.finite


@pytest.mark.parametrize("axis", [0, 2])
def test_a_centre_of_gravity_that_has_begun_to_move_is_followed(axis: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Forward or down alone: what is felt is worked out with its motion from the first step on, and not before."""
    plant = JsbsimPlant(Run(EnvironmentSettings(), LauncherSettings(), 0.01, RELEASE))
    plant.step()
    asked: list[int] = []
    monkeypatch.setattr(JsbsimPlant, "_with_moving_cg", lambda self, felt, *_: asked.append(1) or felt)
    plant._felt(plant.row)
    assert plant._still
    assert not asked
    now, *past = plant._offsets
    moved = tuple(value + 1e-4 * (k == axis) for k, value in enumerate(now))
    plant._offsets = (moved, *past)
    plant._felt(plant.row)
    assert asked
