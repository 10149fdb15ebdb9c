"""fw8 in the air: no corner where it flies, stall of each part in its own flow, all angles, the ground, turning air."""

from __future__ import annotations

import functools
import itertools
import math
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

from aircraft_modes import FOOT, SPEED, WINGS, Free, roots  # noqa: E402 - found by the line above

FW8 = ROOT / "aircraft" / "fw8"
MIRRORED = np.array([1, -1, 1, -1, 1, -1])  # of C_X, C_Y, C_Z, C_l, C_m, C_n, left for right
INCH = 0.0254  # m

with (FW8 / "geometry.toml").open("rb") as file:
    GEOMETRY = tomllib.load(file)


@functools.cache
def aircraft(w: float) -> Free:
    return Free(FW8, w, steady=True)


@pytest.fixture(params=WINGS)
def at(request: pytest.FixtureRequest) -> Free:
    """At each wing position: tail neutral, high up, in air that does not turn."""
    return neutral(request.param)


@pytest.fixture
def out() -> Free:
    return neutral(1.0)


def neutral(w: float) -> Free:
    free = aircraft(w)
    free.height = 1000.0
    free.set_controls(0.0, 0.0)
    free.fdm["ic/terrain-elevation-ft"] = 0.0
    for axis in "pqr":
        free.fdm[f"air/{axis}-rad_sec"] = 0.0
    return free


# -- where it flies ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tail_deg", [0.0, 2.0])
def test_static_margin_has_no_corner_and_is_at_least_eight_percent(out: Free, tail_deg: float) -> None:
    """-dCm/dCL with the wing out, from -6° to 10°, where wing and tail are attached.

    To 8°, where the wing begins to give way, it changes by less than 4 % of the chord in a degree and Cmα by less than
    a quarter: with free transition it was 6 % and 40 % at 0°.
    """
    out.set_controls(math.radians(tail_deg), 0.0)
    values = np.array([out.lift_and_moment(alpha) for alpha in np.arange(-6.5, 10.6, 1.0)])
    change = np.diff(values, axis=0)
    margin, slope = -change[:, 1] / change[:, 0], change[:, 1]
    assert margin.min() >= 0.08
    smooth = slice(0, -2)  # to 8°
    assert np.abs(np.diff(margin[smooth])).max() < 0.04
    assert np.abs(np.diff(slope[smooth]) / slope[smooth][1:]).max() < 0.25


def test_no_corner_in_the_moment_at_any_wing_position(at: Free) -> None:
    """From -6° to 8° lift grows and C_mα changes by less than a quarter in a degree."""
    lift, slope = np.diff([at.lift_and_moment(alpha) for alpha in np.arange(-6.5, 8.6, 1.0)], axis=0).T
    assert lift.min() > 0.0
    assert slope.max() < 0.0
    assert np.abs(np.diff(slope) / slope[1:]).max() < 0.25


def test_lift_slope_is_even_about_zero(out: Free) -> None:
    """What the corner came from: the wing's lift slope. Within 3 % of its mean from -4° to 4°."""
    lift = np.array([out.lift_and_moment(alpha)[0] for alpha in range(-4, 5)])
    slope = np.diff(lift)
    assert np.abs(slope / slope.mean() - 1).max() < 0.03


def test_modes_with_fixed_controls_are_those_of_a_stable_aircraft() -> None:
    """Authority: MIL-F-8785C, level 1 of class I: damping of the short period 0.3 to 2, of the phugoid 0.04 or more, of
    the Dutch roll 0.08 or more at 0.4 rad/s or more; roll within 1.4 s; a spiral that doubles in no less than 12 s.
    """
    longitudinal, lateral = roots(Free(FW8), SPEED)
    phugoid, short = sorted((value for value in longitudinal if value.imag > 0), key=abs)
    (dutch,) = (value for value in lateral if value.imag > 0)
    spiral, roll = sorted((value.real for value in lateral if not value.imag), key=abs)
    assert 0.3 < -short.real / abs(short) < 2
    assert -phugoid.real / abs(phugoid) > 0.04
    assert -dutch.real / abs(dutch) > 0.08
    assert abs(dutch) > 0.4
    assert -1 / 0.02 < roll < -1 / 1.4
    assert spiral < math.log(2) / 12


# -- stall of tail and fin -----------------------------------------------------------------------------------------


def test_fin_saturates_and_breaks_with_its_sideslip(out: Free) -> None:
    """Linear to 10°, greatest near 17°, a fifth less at 22°; odd; none along the flow."""

    def side(beta: float) -> float:
        out.coefficients(0.0, beta)
        return float(out.fdm["aero/fin-side"])

    assert side(10) == pytest.approx(2.5 * side(4), rel=0.05)
    forces = {beta: -side(beta) for beta in range(0, 26)}
    most = max(forces, key=lambda beta: forces[beta])
    assert 14 <= most <= 20
    assert forces[22] < 0.8 * forces[most]
    assert side(-17) == -side(17)
    assert side(0) == 0.0


def test_fin_meets_the_flow_of_its_own_place(out: Free) -> None:
    """Authority: kinematics, v - r l + p z with the fin's mean chord behind and above the centre of gravity."""
    fin = GEOMETRY["fin"]
    taper = (fin["root_chord"] + 2 * fin["tip_chord"]) / (fin["root_chord"] + fin["tip_chord"])
    z = fin["root_z"] + (fin["tip_z"] - fin["root_z"]) / 3 * taper
    behind = fin["quarter_chord_x"] - out.fdm["inertia/cg-x-in"] * INCH
    beta, p, r = math.radians(5.0), 1.5, -2.0
    out.coefficients(0.0, 5.0, (p, 0.0, r))
    expected = math.atan2(SPEED * math.sin(beta) - r * behind + p * z, SPEED * math.cos(beta))
    assert out.fdm["aero/fin-slip-rad"] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(("alpha", "beta", "slip"), [(0, 20, 20), (170, 20, 159.7), (-170, -20, -159.7)])
def test_flow_from_behind_meets_fin_and_body_from_behind(out: Free, alpha: float, beta: float, slip: float) -> None:
    """Authority: atan2(sin β, cos α cos β)."""
    out.coefficients(alpha, beta)
    for part in ("body", "fin"):
        assert math.degrees(out.fdm[f"aero/{part}-slip-rad"]) == pytest.approx(slip, abs=0.1)


def test_tail_stalls_with_its_local_angle(out: Free) -> None:
    """The last 3° of deflection turn the nose down at 0° and no more at 18°, where the tail meets 26°."""
    moments = {}
    for alpha, tail in itertools.product((0, 18), (11, 14)):
        out.set_controls(math.radians(tail), 0.0)
        moments[alpha, tail] = out.coefficients(alpha)[4]
    assert moments[0, 14] - moments[0, 11] < -0.15
    assert moments[18, 14] - moments[18, 11] > 0.05


def test_halves_of_the_tail_meet_the_roll(out: Free) -> None:
    """A right roll lowers the right half, which then meets p y/V more; the left one as much less."""
    p = 2.0
    out.coefficients(3.0, 0.0, (p, 0.0, 0.0))
    right, left = (out.fdm[f"aero/tail-{half}-rad"] for half in ("right", "left"))
    tail = GEOMETRY["tail"]
    taper = (tail["root_chord"] + 2 * tail["tip_chord"]) / (tail["root_chord"] + tail["tip_chord"])
    y = tail["root_y"] + (tail["tip_y"] - tail["root_y"]) / 3 * taper
    assert (right - left) / 2 == pytest.approx(p * y / SPEED * math.cos(math.radians(3)), rel=1e-4)


# -- all angles ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("beta", [0.0, 25.0, -70.0])
def test_coefficients_are_continuous_over_all_angles_of_attack(at: Free, beta: float) -> None:
    """In steps of 0.2° nothing changes by more than a slope of 0.2 per degree gives; ±180° are one."""
    values = np.array([at.coefficients(alpha, beta) for alpha in np.arange(-180, 180.1, 0.2)])
    assert np.isfinite(values).all()
    assert np.abs(np.diff(values, axis=0)).max() < 0.04
    np.testing.assert_allclose(at.coefficients(180.0, beta), at.coefficients(-180.0, beta), atol=1e-4)
    np.testing.assert_allclose(at.coefficients(179.99, beta), at.coefficients(-179.99, beta), atol=2e-3)


@pytest.mark.parametrize("alpha", [0.0, 20.0, 90.0, 170.0])
def test_coefficients_are_continuous_over_all_sideslips(at: Free, alpha: float) -> None:
    values = np.array([at.coefficients(alpha, beta) for beta in np.arange(-90, 90.1, 0.2)])
    assert np.isfinite(values).all()
    assert np.abs(np.diff(values, axis=0)).max() < 0.04


def test_the_air_takes_energy_whatever_the_attitude(at: Free) -> None:
    """Authority: the second law. Drag, against the flow, at every angle of attack and sideslip."""
    for alpha, beta in itertools.product(range(-180, 181, 10), range(-90, 91, 15)):
        a, b = math.radians(alpha), math.radians(beta)
        flow = np.array([math.cos(a) * math.cos(b), math.sin(b), math.sin(a) * math.cos(b)])
        assert at.coefficients(alpha, beta)[:3] @ flow < -0.015, (alpha, beta)


@pytest.mark.parametrize("alpha", [-170.0, 0.0, 4.0, 170.0])
def test_turning_is_damped_in_flow_from_ahead_and_behind(out: Free, alpha: float) -> None:
    still = out.coefficients(alpha)
    for k, axis in enumerate(np.eye(3)):
        turned = out.coefficients(alpha, 0.0, tuple(axis)) - still
        assert turned[3 + k] < 0.0, "pqr"[k]


def test_left_is_right_mirrored(at: Free) -> None:
    for alpha, beta, p, r, tail in [(3, 7, 0.5, -0.3, 0.05), (24, -31, -2, 1, -0.2), (-150, 60, 1, 1, 0.1)]:
        both = []
        for side in (1, -1):
            at.fdm["fcs/tail-right-rad"], at.fdm["fcs/tail-left-rad"] = 0.02 + side * tail, 0.02 - side * tail
            both.append(at.coefficients(alpha, side * beta, (side * p, 0.4, side * r)))
        np.testing.assert_allclose(both[0], MIRRORED * both[1], atol=1e-9)
        assert np.abs(both[0][[1, 3, 5]]).min() > 1e-4  # it does turn


# -- the ground ----------------------------------------------------------------------------------------------------


def height_over_span(free: Free) -> float:
    return float(free.fdm["aero/h_b-mac-ft"])


@pytest.mark.parametrize("spans", [0.05, 0.1, 0.2, 0.45, 0.8, 1.7])
def test_ground_effect_is_the_published_one(out: Free, spans: float) -> None:
    """Authority: McCormick's φ = (16 h/b)²/(1 + (16 h/b)²) on induced drag, and a lifting line's slope with it.

    Tolerance 1 % of the factors; wing and fuselage alone, of what the tail adds the lift is taken off.
    """
    ref, alpha = GEOMETRY["reference"], 6.0
    aspect = ref["span"] ** 2 / ref["area"]
    a, found = math.radians(alpha), {}
    for height in (1000.0, spans * ref["span"] / FOOT):
        out.height = height
        x, _, z, *_ = out.coefficients(alpha)
        normal, axial = out.fdm["aero/tail-normal"], out.fdm["aero/tail-axial"]
        lift, drag = x * math.sin(a) - z * math.cos(a), -x * math.cos(a) - z * math.sin(a)
        lift -= normal * math.cos(a) - axial * math.sin(a)
        found[height] = lift, drag - normal * math.sin(a) - axial * math.cos(a)
    h = height_over_span(out)
    assert h == pytest.approx(spans, rel=0.02)
    (free_lift, free_drag), (lift, drag) = found.values()
    phi, s = (16 * h) ** 2 / (1 + (16 * h) ** 2), 2 / aspect
    assert lift / free_lift == pytest.approx((1 + s) / (1 + s * phi), rel=0.01)
    saved = (free_lift**2 - phi * lift**2) / (math.pi * aspect)
    assert free_drag - drag == pytest.approx(saved, abs=0.01 * free_lift**2 / (math.pi * aspect))
    assert lift > free_lift


def test_ground_is_where_the_terrain_is(out: Free) -> None:
    """2 m above ground at 600 m is as 2 m above the sea, and is not free flight."""
    out.height = 2.0 / FOOT
    low = out.coefficients(6.0)
    out.height, out.fdm["ic/terrain-elevation-ft"] = 602.0 / FOOT, 600.0 / FOOT
    high = out.coefficients(6.0)
    out.fdm["ic/terrain-elevation-ft"] = 0.0
    free = out.coefficients(6.0)
    np.testing.assert_allclose(high, low, atol=2e-4)
    assert abs(free[4] - low[4]) > 0.005


def test_ground_takes_downwash_off_the_tail_and_leaves_a_folded_wing_alone(out: Free) -> None:
    """Authority: 1/(1 + (b/4h)²) of the downwash. Folded, the span is a sixth: the ground is as many times farther."""
    out.coefficients(6.0)
    free = out.fdm["aero/alpha-rad"] - out.fdm["aero/tail-flow-rad"]
    out.height = 0.5 / FOOT
    out.coefficients(6.0)
    near = out.fdm["aero/alpha-rad"] - out.fdm["aero/tail-flow-rad"]
    h = height_over_span(out)
    assert near / free == pytest.approx(1 / (1 + 1 / (4 * h) ** 2), rel=0.02)
    folded = neutral(0.0)
    high = folded.coefficients(6.0)
    folded.height = 0.5 / FOOT
    np.testing.assert_allclose(folded.coefficients(6.0), high, rtol=0.02, atol=1e-3)


# -- air that turns ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rates", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (-0.7, 0.4, 1.1)])
@pytest.mark.parametrize(("alpha", "beta"), [(3.0, 0.0), (14.0, 20.0), (-160.0, -40.0)])
def test_air_that_turns_as_the_body_does_damps_nothing(
    at: Free, alpha: float, beta: float, rates: tuple[float, float, float]
) -> None:
    still = at.coefficients(alpha, beta)
    turning = at.coefficients(alpha, beta, rates)
    for axis, rate in zip("pqr", rates, strict=True):
        at.fdm[f"air/{axis}-rad_sec"] = rate
    np.testing.assert_allclose(at.coefficients(alpha, beta, rates), still, atol=1e-9)
    assert np.abs(turning - still).max() > 1e-4  # in still air it does


def test_air_that_turns_acts_as_a_body_that_turns_the_other_way(out: Free) -> None:
    body = out.coefficients(4.0, 3.0, (0.8, -0.5, 0.6))
    for axis, rate in zip("pqr", (-0.8, 0.5, -0.6), strict=True):
        out.fdm[f"air/{axis}-rad_sec"] = rate
    np.testing.assert_allclose(out.coefficients(4.0, 3.0), body, atol=1e-9)


def test_gyros_of_the_stabiliser_read_the_body() -> None:
    text = (FW8 / "systems" / "stabiliser.xml").read_text(encoding="utf-8")
    assert "air/" not in text
    assert "velocities/p-rad_sec" in text
    assert "velocities/q-rad_sec" in text
