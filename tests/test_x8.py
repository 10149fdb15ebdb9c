"""The Skywalker X8: its model against what its derivatives say by hand, and a flight.

Authority: the published derivatives (aircraft/x8/derivatives.toml), linear theory (Etkin and Reid 1996, chapter 6), the
motor's and propeller's published equations solved on their own (Coates et al. 2019), and the trim that the authors of
the derivatives give for their own simulation (repository krisgry/x8, simX8.m).
"""

import importlib.util
import tomllib
from math import degrees, sqrt
from pathlib import Path
from typing import Any

import jsbsim
import numpy as np
import pytest
from scipy.optimize import brentq

import uavsim
from uavsim.plants.hangar import find_aircraft
from uavsim.studies.linearise import Point, linearise

ROOT = Path(__file__).parent.parent
X8 = ROOT / "aircraft" / "x8"
D: dict[str, Any] = tomllib.loads((X8 / "derivatives.toml").read_text(encoding="utf-8"))
V, G = 18.0, 9.80665
DENSITY, AT_SEA = 1.1896, 1.225  # kg/m³, at the 1000 ft of `linearise` and at sea level (US Standard Atmosphere 1976)
Q = 0.5 * DENSITY * V * V
AREA, SPAN, CHORD = (D["reference"][name] for name in ("area", "span", "chord"))
MASS, IXX, IYY, IZZ = (D["mass"][name] for name in ("mass", "ixx", "iyy", "izz"))


@pytest.fixture(scope="module")
def level() -> Point:
    """Level flight at 18 m/s."""
    return linearise(find_aircraft("x8"), (V,), (1.0,)).points[0]


def builder() -> Any:
    spec = importlib.util.spec_from_file_location("build_from_derivatives", ROOT / "scripts/build_from_derivatives.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_model_is_the_one_that_its_derivatives_make() -> None:
    for path, text in builder().build(X8).items():
        assert path.read_text(encoding="utf-8") == text


def test_lift_is_linear_up_to_the_stall_and_a_plates_beyond() -> None:
    make = builder()
    alpha = np.radians([-8.0, 0.0, 8.0, 45.0, 90.0])
    lift, drag = make.polar(D, alpha)
    lin = D["lift"]["zero"] + D["lift"]["alpha"] * alpha
    assert lift[:3] == pytest.approx(lin[:3], rel=0.01)
    assert lift[3:] == pytest.approx([sqrt(0.5), 0.0], abs=0.01)  # 2 sin² α cos α
    assert drag[4] == pytest.approx(2.0, abs=0.01)
    assert drag[1] == pytest.approx(D["drag"]["zero"], rel=0.01)


def by_hand(density: float = DENSITY) -> tuple[float, float, float]:
    """Angle of attack and elevator, rad, and drag, N, of level flight, from two linear equations."""
    lift, pitch, drag = D["lift"], D["pitch"], D["drag"]
    carried = 0.5 * density * V * V * AREA
    a = np.array([[lift["alpha"], lift["elevator"]], [pitch["alpha"], pitch["elevator"]]])
    b = np.array([MASS * G / carried - lift["zero"], -pitch["zero"]])
    alpha, elevator = np.linalg.solve(a, b)
    coefficient = drag["zero"] + drag["alpha"] * alpha + drag["alpha2"] * alpha**2 + drag["elevator2"] * elevator**2
    return float(alpha), float(elevator), float(carried * coefficient)


def test_trim_is_that_of_the_derivatives(level: Point) -> None:
    """Angles to 0.05°, drag to 3 %: the thrust carries 0.3 % of the weight, α turns it."""
    alpha, elevator, drag = by_hand()
    assert degrees(level.alpha) == pytest.approx(degrees(alpha), abs=0.05)
    assert degrees(level.control) == pytest.approx(degrees(elevator), abs=0.05)
    assert level.thrust == pytest.approx(drag, rel=0.03)


def test_the_model_has_the_published_derivatives(level: Point) -> None:
    """As JSBSim's forces and moments have them at 18 m/s, to 1 %; the lift's slope is bent by the blend."""
    found = level.derivatives
    assert found is not None
    lift, pitch, side, roll, yaw = (D[name] for name in ("lift", "pitch", "side", "roll", "yaw"))
    published = {
        "CL_alpha": lift["alpha"], "CL_q": lift["pitch_rate"], "CL_control": lift["elevator"],
        "Cm_alpha": pitch["alpha"], "Cm_q": pitch["pitch_rate"], "Cm_control": pitch["elevator"],
        "CY_beta": side["beta"], "CY_p": side["roll_rate"], "CY_r": side["yaw_rate"],
        "Cl_beta": roll["beta"], "Cl_p": roll["roll_rate"], "Cl_r": roll["yaw_rate"],
        "Cn_beta": yaw["beta"], "Cn_p": yaw["roll_rate"], "Cn_r": yaw["yaw_rate"],
    }  # fmt: skip
    assert {name: found[name] for name in published} == pytest.approx(published, rel=0.01)


def test_the_trim_is_the_one_that_the_authors_fly() -> None:
    """At 18 m/s α is 0.0308 and the elevator 0.0370 rad: to 0.001 rad, without the thrust's share of the weight."""
    alpha, elevator, _ = by_hand(AT_SEA)
    assert alpha == pytest.approx(0.0308, abs=0.001)
    assert elevator == pytest.approx(0.0370, abs=0.001)


def test_the_pitching_moment_is_the_tunnels_about_a_point_30_mm_ahead() -> None:
    """C_m − 0.03/c C_L of table V, to 1 %: why the centre of gravity is at 0.41 m in place of 0.44."""
    tunnel = {"zero": 0.0302, "alpha": -0.126, "elevator": -0.206}
    for name, value in tunnel.items():
        assert D["pitch"][name] == pytest.approx(value - 0.03 / CHORD * D["lift"][name], rel=0.01)
    assert D["mass"]["centre"] == pytest.approx(0.44 - 0.03)


def test_the_moments_of_inertia_are_a_bodys() -> None:
    x_z = np.linalg.eigvalsh([[IXX, D["mass"]["ixz"]], [D["mass"]["ixz"], IZZ]])
    assert x_z[1] < x_z[0] + IYY
    assert x_z[0] < x_z[1] + IYY
    assert x_z.sum() > IYY


def test_motor_and_propeller_are_in_balance_where_their_equations_are() -> None:
    """U δ = R I + K ω, K (I − I₀) = Q: speed and thrust to 2 %."""
    motor, prop = D["motor"], D["propeller"]
    constant, throttle = 60.0 / (2.0 * np.pi * motor["velocity_constant"]), 0.5
    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    assert fdm.load_model_with_paths("x8", str(X8.parent), str(X8 / "engine"), str(X8 / "systems"), True)
    fdm.set_dt(0.002)
    fdm["ic/h-sl-ft"], fdm["ic/vt-fps"] = 1000.0, V / 0.3048
    fdm.run_ic()
    fdm["propulsion/engine/set-running"] = 1
    fdm["fcs/throttle-cmd-norm"] = throttle
    for _ in range(300):
        fdm.run()
    speed, density = fdm["velocities/u-aero-fps"] * 0.3048, fdm["atmosphere/rho-slugs_ft3"] * 515.378818
    thrust, torque = np.polynomial.Polynomial(prop["thrust"]), np.polynomial.Polynomial(prop["torque"])

    def surplus(n: float) -> float:
        current = (motor["voltage"] * throttle - constant * 2.0 * np.pi * n) / motor["resistance"]
        drag = density * n**2 * prop["diameter"] ** 5 * torque(speed / (n * prop["diameter"]))
        return float(constant * (current - motor["no_load_current"]) - drag)

    n = brentq(surplus, 40.0, 130.0)
    expected = density * n**2 * prop["diameter"] ** 4 * thrust(speed / (n * prop["diameter"]))
    assert fdm["propulsion/engine/propeller-rpm"] / 60.0 == pytest.approx(n, rel=0.02)
    assert fdm["propulsion/engine/thrust-lbs"] * 4.4482216 == pytest.approx(expected, rel=0.02)


def phase_margin(loop: np.ndarray) -> float:
    """At its last crossing of gain 1, degrees."""
    last = np.flatnonzero((np.abs(loop[:-1]) > 1.0) & (np.abs(loop[1:]) <= 1.0))[-1]
    return 180.0 + degrees(np.angle(loop[last]))


def test_the_stabilisers_gains_leave_margins() -> None:
    """Pitch and roll at 18 m/s, by short period, roll and the servo's lag: 45° of phase, |1 + L| of a half."""
    s = 1j * np.geomspace(0.05, 300.0, 20000)
    servo = D["limits"]["elevon_lag"] / (s + D["limits"]["elevon_lag"])
    gain, scale = D["stabiliser"], D["stabiliser"]["reference_pressure"] / Q
    heave = -Q * AREA / (MASS * V) * D["lift"]["alpha"]
    push = -Q * AREA / (MASS * V) * D["lift"]["elevator"]
    per = Q * AREA * CHORD / IYY
    stiff, turn = per * D["pitch"]["alpha"], per * D["pitch"]["elevator"]
    damping = per * D["pitch"]["pitch_rate"] * CHORD / (2.0 * V)
    rate = (turn * (s - heave) + stiff * push) / ((s - heave) * (s - damping) - stiff)
    pitch = -(gain["pitch"] / s + gain["pitch_integral"] / s**2 + gain["pitch_rate"]) * rate * servo * scale
    per = Q * AREA * SPAN / IXX
    rolling = per * D["roll"]["aileron"] / (s - per * D["roll"]["roll_rate"] * SPAN / (2.0 * V))
    roll = (gain["roll"] / s + gain["roll_integral"] / s**2 + gain["roll_rate"]) * rolling * servo * scale
    for loop in (pitch, roll):
        assert phase_margin(loop) > 45.0
        assert np.abs(1.0 + loop).min() > 0.5


def test_modes_are_those_of_the_derivatives(level: Point) -> None:
    """Within 15 %: short period and Dutch roll of two states, Lanchester's phugoid, roll alone."""
    modes = {mode.name: mode.value for mode in level.modes}
    per_mass, per_pitch = Q * AREA / MASS, Q * AREA * CHORD / IYY
    rate = CHORD / (2.0 * V)
    heave, damping = per_mass * D["lift"]["alpha"] / V, per_pitch * D["pitch"]["pitch_rate"] * rate
    short = sqrt(-per_pitch * D["pitch"]["alpha"] - heave * damping)
    assert abs(modes["short period"]) == pytest.approx(short, rel=0.15)
    assert -modes["short period"].real == pytest.approx(0.5 * (heave - damping), rel=0.15)
    assert abs(modes["phugoid"]) == pytest.approx(sqrt(2.0) * G / V, rel=0.15)
    around = SPAN / (2.0 * V)
    roll = Q * AREA * SPAN / IXX * D["roll"]["roll_rate"] * around
    assert modes["roll"].real == pytest.approx(roll, rel=0.15)
    per_yaw = Q * AREA * SPAN / IZZ
    yawing, slip = per_yaw * D["yaw"]["yaw_rate"] * around, per_mass * D["side"]["beta"] / V
    dutch = sqrt(per_yaw * D["yaw"]["beta"] + yawing * slip)
    assert abs(modes["Dutch roll"]) == pytest.approx(dutch, rel=0.15)


def test_stall_is_that_of_the_blend() -> None:
    """Greatest lift of the polar, elevons neutral, to 1 %."""
    alpha = np.radians(np.arange(5.0, 25.0, 0.01))
    greatest = builder().polar(D, alpha)[0].max()
    found = linearise(find_aircraft("x8"), (V,), (1.0,))
    assert found.greatest_lift == pytest.approx(greatest, rel=0.02)
    assert found.stall == pytest.approx(sqrt(2.0 * MASS * G / (DENSITY * AREA * greatest)), rel=0.02)


def test_it_leaves_its_bungee_and_cruises() -> None:
    """Its wing is out throughout; the transition ends 2 s after the rail."""
    flight = uavsim.fly("x8-bungee", seed=17, overrides=["duration=14"])
    score, truth = flight.score, flight.truth
    assert score["outcome"] == "cruise", score["reason"]
    assert (truth["wing"] == 1.0).all()
    assert score["flight"]["wing_out_time"] is None
    assert all(one["met"] for one in score["requirements"])
    assert 13.5 < score["flight"]["rail_exit_speed"] < 16.0
