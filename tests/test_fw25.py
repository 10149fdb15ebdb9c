"""fw25: its files agree with geometry.toml, thrust and lift with closed forms, and it dashes at Mach 0.6."""

import functools
import hashlib
import re
import sys
import tomllib
from math import degrees, pi, radians, sqrt
from pathlib import Path
from typing import Any

import jsbsim
import numpy as np
import pytest

import uavsim
from uavsim.plants.free import Free
from uavsim.plants.hangar import find_aircraft
from uavsim.studies.linearise import Point, linearise

sys.path.insert(0, str(Path(__file__).parents[1] / "scripts"))

from aircraft_build import turbine

ROOT = Path(__file__).parent.parent
FW25 = ROOT / "aircraft" / "fw25"
GEOMETRY: dict[str, Any] = tomllib.loads((FW25 / "geometry.toml").read_text(encoding="utf-8"))
REFERENCE, ENGINE = GEOMETRY["reference"], GEOMETRY["turbine"]
POUND, FOOT = 4.4482216152605, 0.3048  # N, m
DENSITY, SOUND = 1.1896, 339.1  # kg/m³, m/s: at the 1000 ft of `linearise` (US Standard Atmosphere 1976)
SLOW, FAST = 60.0, 0.6 * SOUND  # m/s
MASS, G = 25.0, 9.80665


@functools.cache
def level(speed: float) -> Point:
    """Level flight with the wing out."""
    return linearise(find_aircraft("fw25"), (speed,), (1.0,)).points[0]


def helmbold(aspect: float, mach: float) -> float:
    """Lift slope of a straight wing, per rad, by the rule of Prandtl and Glauert."""
    return 2.0 * pi * aspect / (2.0 + sqrt(4.0 + aspect**2 * (1.0 - mach**2)))


# -- files -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["fw25.xml", "engine/fw25_turbine.xml", "engine/fw25_jet.xml"])
def test_generated_file_was_built_from_this_geometry(name: str) -> None:
    digest = hashlib.sha256((FW25 / "geometry.toml").read_bytes()).hexdigest()
    assert re.findall(r"geometry\.toml sha256 ([0-9a-f]{64})", (FW25 / name).read_text()) == [digest]


@pytest.mark.parametrize("name", ["wing.xml", "stabiliser.xml"])
def test_systems_are_those_of_the_aircraft_that_the_geometry_names(name: str) -> None:
    theirs = FW25 / GEOMETRY["systems"] / name
    assert (FW25 / "systems" / name).read_bytes() == theirs.read_bytes()


def test_the_aircraft_weighs_what_its_parts_do() -> None:
    parts = sum(item["mass"] for item in GEOMETRY["item"]) + 2 * GEOMETRY["wing"]["mass"] + ENGINE["fuel"]
    assert parts == pytest.approx(MASS, abs=0.01)
    assert linearise(find_aircraft("fw25"), (SLOW,), (1.0,)).mass == pytest.approx(parts, abs=0.01)


# -- the turbine -----------------------------------------------------------------------------------------------------


def test_thrust_falls_by_the_rams_drag_at_first() -> None:
    """F = ṁ (V_j − V): the ram's own gain goes with M², so dF/dV at rest is −ṁ. To 5 % over Mach 0.01."""
    slow = 0.01
    hot = turbine._inlet_temperature(ENGINE)
    rest = turbine._specific(ENGINE, hot, 0.0, 288.15, 101325.0)
    moving = turbine._specific(ENGINE, hot, slow, 288.15, 101325.0)
    speed = slow * sqrt(1.4 * 287.05 * 288.15)
    fallen = (moving[0] * (moving[1] - speed)) / (rest[0] * rest[1]) - 1.0
    assert fallen * ENGINE["thrust"] / speed == pytest.approx(-ENGINE["mass_flow"], rel=0.05)


def test_the_cycle_burns_what_the_geometry_says() -> None:
    """Heat of the burnt fuel, 43 MJ/kg, against that of the gas between compressor and turbine: to 15 %.

    Authority: the energy balance of the combustor; the efficiency of small ones is 0.9 to 1.
    """
    warmer = 288.15 * (ENGINE["pressure_ratio"] ** (1 / 3.5) - 1.0) / turbine.COMPRESSOR
    heat = turbine.GAS_HEAT * (turbine._inlet_temperature(ENGINE) - 288.15 - warmer)
    burnt = ENGINE["consumption"] * ENGINE["thrust"] / 3600.0
    assert ENGINE["mass_flow"] * heat == pytest.approx(0.95 * 43e6 * burnt, rel=0.15)


def test_it_idles_and_spools_up_at_rest() -> None:
    """Idle, full thrust and its fuel are the geometry's to 3 %. Small turbines take 3 to 6 s to spool up."""
    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    assert fdm.load_model_with_paths("fw25", str(FW25.parent), str(FW25 / "engine"), str(FW25 / "systems"), True)
    fdm.set_dt(0.01)
    fdm.run_ic()
    fdm["forces/hold-down"] = 1.0
    for _ in range(20):
        fdm.run()
    assert fdm["propulsion/engine/thrust-lbs"] * POUND == pytest.approx(ENGINE["idle_thrust"], rel=0.03)
    assert fdm["propulsion/engine/n2"] == pytest.approx(ENGINE["idle_speed"])
    fdm["fcs/throttle-cmd-norm"] = 1.0
    thrusts = []
    for _ in range(1000):
        fdm.run()
        thrusts.append(fdm["propulsion/engine/thrust-lbs"] * POUND)
    assert thrusts[-1] == pytest.approx(ENGINE["thrust"], rel=0.03)
    assert 2.5 < 0.01 * np.searchsorted(thrusts, 0.9 * ENGINE["thrust"]) < 6.0
    before = fdm["propulsion/total-fuel-lbs"]
    for _ in range(1000):
        fdm.run()
    flow = (before - fdm["propulsion/total-fuel-lbs"]) * 0.45359237 / 10.0
    assert flow == pytest.approx(ENGINE["consumption"] * ENGINE["thrust"] / 3600.0, rel=0.03)


# -- the aerodynamics ------------------------------------------------------------------------------------------------


def test_lift_grows_with_the_mach_number_as_prandtl_and_glauert_say() -> None:
    """Slope of the whole aircraft at Mach 0.6 over that at 60 m/s: wing and, of less aspect ratio, tail. To 3 %."""
    slopes = [(level(speed).derivatives or {})["CL_alpha"] for speed in (FAST, SLOW)]
    aspect = REFERENCE["span"] ** 2 / REFERENCE["area"]
    assert slopes[0] / slopes[1] == pytest.approx(helmbold(aspect, 0.6) / helmbold(aspect, SLOW / SOUND), rel=0.03)


def test_the_papers_condition_is_flown_level() -> None:
    """Mach 0.6 at 1° and the lift of its weight; the thrust is what the turbine has left there."""
    point = level(FAST)
    assert point.problem == ""
    assert degrees(point.alpha) == pytest.approx(1.0, abs=0.3)
    carried = 0.5 * DENSITY * FAST**2 * REFERENCE["area"]
    found = point.derivatives or {}
    assert found["CL"] == pytest.approx((MASS * G - point.thrust * point.alpha) / carried, rel=0.02)
    left = ENGINE["thrust"] * turbine.thrust_ratios(GEOMETRY)[turbine.MACHS.index(0.6)][1]
    assert point.thrust < 0.95 * left


def test_drag_is_the_sum_of_its_parts() -> None:
    """Turbulent skin friction by area, Schlichting's 0.455/(log Re)^2.58, Hoerner's form factors: C_D·S to 20 %.

    At 100 m/s, the speed of the tables; the tail's and the fin's are as a wing's of their chord.
    """
    speed = REFERENCE["airspeed"]

    def friction(length: float) -> float:
        return float(0.455 / np.log10(speed * length / 1.46e-5) ** 2.58)

    x, d = (np.array(GEOMETRY["fuselage"][name]) for name in ("x", "diameter"))
    wetted = pi * float(np.sum(np.diff(x) * (d[1:] + d[:-1]) / 2))
    slender = x[-1] / d.max()
    area = (
        wetted * friction(x[-1]) * (1 + 1.5 / slender**1.5 + 7 / slender**3) + GEOMETRY["fuselage"]["drag_area_extra"]
    )
    surfaces = {"wing": REFERENCE["area"], "tail": _panels("tail", "y", 2), "fin": _panels("fin", "z", 1)}
    for part, surface in surfaces.items():
        thick = int(GEOMETRY[part]["airfoil"][-2:]) / 100
        chord = (
            REFERENCE["chord"] if part == "wing" else (GEOMETRY[part]["root_chord"] + GEOMETRY[part]["tip_chord"]) / 2
        )
        area += 2 * surface * friction(chord) * (1 + 2 * thick + 60 * thick**4)
    found = (level(speed).derivatives or {})["CD"] * REFERENCE["area"]
    induced = ((level(speed).derivatives or {})["CL"] * REFERENCE["area"] / REFERENCE["span"]) ** 2 / pi
    assert found == pytest.approx(area + induced, rel=0.20)


def _panels(part: str, axis: str, count: int) -> float:
    shape = GEOMETRY[part]
    return float(
        count * (shape[f"tip_{axis}"] - shape[f"root_{axis}"]) * (shape["root_chord"] + shape["tip_chord"]) / 2
    )


@pytest.mark.parametrize("speed", [SLOW, FAST])
def test_modes_are_those_of_the_derivatives(speed: float) -> None:
    """Short period, roll and Dutch roll by the approximations of Etkin and Reid (1996, ch. 6), 15 %."""
    point = level(speed)
    d, modes = point.derivatives or {}, {mode.name: mode.value for mode in point.modes}
    ixx, iyy, izz = _inertia()
    q = 0.5 * DENSITY * speed**2
    by_chord, by_span = (REFERENCE[name] / (2.0 * speed) for name in ("chord", "span"))
    lift = q * REFERENCE["area"] * (d["CL_alpha"] + d["CD"]) / (MASS * speed)
    pitch = q * REFERENCE["area"] * REFERENCE["chord"] / iyy
    damping = pitch * d["Cm_q"] * by_chord
    assert abs(modes["short period"]) == pytest.approx(sqrt(-pitch * d["Cm_alpha"] - damping * lift), rel=0.15)
    per_roll, per_yaw = (q * REFERENCE["area"] * REFERENCE["span"] / inertia for inertia in (ixx, izz))
    assert modes["roll"].real == pytest.approx(per_roll * d["Cl_p"] * by_span, rel=0.15)
    side = q * REFERENCE["area"] * d["CY_beta"] / (MASS * speed)
    dutch = sqrt(per_yaw * d["Cn_beta"] + per_yaw * d["Cn_r"] * by_span * side)
    assert abs(modes["Dutch roll"]) == pytest.approx(dutch, rel=0.15)


@functools.cache
def _inertia() -> tuple[float, float, float]:
    """Moments of inertia with the wing out, kg m²."""
    fdm = Free("fw25", 1.0).fdm
    return tuple(fdm[f"inertia/{axis}-slugs_ft2"] * 1.3558179 for axis in ("ixx", "iyy", "izz"))  # type: ignore[return-value]


@pytest.mark.slow
def test_static_stability_at_every_wing_position() -> None:
    for point in linearise(find_aircraft("fw25"), (SLOW, FAST), (0.0, 0.25, 0.5, 0.75, 1.0)).points:
        assert point.problem == ""
        assert (point.derivatives or {})["Cm_alpha"] < 0.0


# -- the dash --------------------------------------------------------------------------------------------------------


def test_the_dash_ends_at_mach_06_with_its_airspeed_known() -> None:
    """The paper's condition: Mach 0.6, 300 K, 1°; the estimate is valid and within 1 %."""
    flight = uavsim.fly("dash", seed=7)
    score, truth, estimate = flight.score, flight.truth, flight.tables["estimate"]
    assert score["outcome"] == "cruise", score["reason"]
    assert all(one["met"] for one in score["requirements"])
    assert 12.0 * G < truth["fx"].max() < 15.0 * G
    late = truth[truth["t"] > 50.0]
    assert late["mach"].min() >= 0.6
    assert late["temperature"].to_numpy() == pytest.approx(300.0, abs=0.5)
    assert np.degrees(late["alpha"].to_numpy()) == pytest.approx(1.0, abs=0.3)
    assert 126e3 < late["p_total"].min() < 130e3
    shown = estimate[estimate["t"] > 50.0]
    assert shown["valid"].all()
    true = np.interp(shown["t"], truth["t"], truth["airspeed"])
    assert np.abs(shown["airspeed"] / true - 1.0).max() < 0.01
    assert (truth["throttle"][truth["t"] < score["flight"]["rail_exit_time"]] == 0.0).all()
    assert radians(20.0) > np.abs(truth["roll"]).max()
