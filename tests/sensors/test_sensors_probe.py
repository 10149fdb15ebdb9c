"""The ports: angle sensitivity, position error, slipstream, each alone."""

from math import acos, cos, nan, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sensors.probe import FREE_ANGLE, LIMITS, flow_angle, recovery, static_port, total_port
from sensors.settings import StaticPortSettings, TotalPortSettings

P_STATIC, Q = 1e5, 600.0
P_TOTAL = P_STATIC + Q
PROBES = ["plain", "bevelled", "kiel"]


NO_ERROR = {"error": 0.0, "error_alpha2": 0.0, "error_beta2": 0.0}


def _total(alpha_deg=0.0, beta_deg=0.0, throttle=0.0, **settings):
    port = total_port(TotalPortSettings(**settings))
    return port(P_TOTAL, P_STATIC, 0.1, radians(alpha_deg), radians(beta_deg), throttle)


def _error(alpha_deg=0.0, beta_deg=0.0, throttle=0.0, mach=0.0, **settings):
    """Position error in shares of the free impact pressure."""
    port = static_port(StaticPortSettings(**(NO_ERROR | settings)))
    return (port(P_TOTAL, P_STATIC, mach, radians(alpha_deg), radians(beta_deg), throttle) - P_STATIC) / Q


def test_ports_without_errors_are_none():
    assert total_port(TotalPortSettings(probe="ideal")) is None
    assert static_port(StaticPortSettings(**NO_ERROR)) is None
    assert (
        static_port(StaticPortSettings(**NO_ERROR, slipstream=1.0)) is None
    )  # it scales the position error: there is none


@pytest.mark.parametrize(("probe", "limit"), [("plain", 20.0), ("bevelled", 28.0), ("kiel", 40.0)])
def test_a_probe_loses_one_hundredth_at_its_quoted_limit(probe, limit):
    """Plain: basicairdata on NACA TN 2530; bevelled: NACA TN 3641; Kiel: the 1 % criterion, 40°."""
    assert _total(alpha_deg=limit, probe=probe) == pytest.approx(P_TOTAL - 0.01 * Q, abs=1e-9)
    assert _total(beta_deg=-limit, probe=probe) == pytest.approx(P_TOTAL - 0.01 * Q, abs=1e-9)
    assert _total(alpha_deg=10.0, probe=probe) == pytest.approx(P_TOTAL, abs=1e-9)
    assert _total(alpha_deg=0.9 * limit + 1.0, probe=probe) > P_TOTAL - 0.01 * Q


def test_a_better_probe_loses_less_at_every_angle():
    angles = np.linspace(0, pi, 91)
    plain, bevelled, kiel = ([recovery(a, LIMITS[probe]) for a in angles.tolist()] for probe in PROBES)
    assert (np.array(plain) <= np.array(bevelled)).all()
    assert (np.array(bevelled) <= np.array(kiel)).all()
    for losses in (plain, bevelled, kiel):
        assert (np.diff(losses) <= 0).all()
        assert min(losses) >= 0.0


def test_plain_tube_against_a_flow_from_behind_feels_the_static_pressure():
    assert _total(alpha_deg=175.0, probe="plain") == P_STATIC


@given(alpha=st.floats(-pi, pi), beta=st.floats(-pi / 2, pi / 2))
def test_flow_angle_is_that_of_the_velocity_vector(alpha, beta):
    """Velocity in body axes: V (cos α cos β, sin β, sin α cos β)."""
    v = np.array([cos(alpha) * cos(beta), np.sin(beta), np.sin(alpha) * cos(beta)])
    assert flow_angle(alpha, beta) == pytest.approx(acos(np.clip(v[0] / np.linalg.norm(v), -1, 1)), abs=1e-6)


def test_both_angles_together_are_the_total_angle():
    """15° and 15° are 21.1°: beyond the plain tube's limit, though neither alone is."""
    total = flow_angle(radians(15.0), radians(15.0))
    assert total == pytest.approx(radians(21.1), abs=radians(0.05))
    expected = P_TOTAL - Q * 0.01 * ((total - FREE_ANGLE) / radians(10.0)) ** 2
    assert _total(alpha_deg=15.0, beta_deg=15.0, probe="plain") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("probe", ["ideal", *PROBES])
def test_slipstream_adds_its_share_at_full_throttle(probe):
    assert _total(throttle=1.0, probe=probe, slipstream=0.4) == pytest.approx(P_STATIC + 1.4 * Q)
    assert _total(throttle=0.5, probe=probe, slipstream=0.4) == pytest.approx(P_STATIC + 1.2 * Q)
    assert _total(throttle=0.0, probe=probe, slipstream=0.4) == pytest.approx(P_TOTAL)


def test_position_error_term_by_term():
    alpha, beta = radians(8.0), radians(-6.0)
    place = {"alpha_deg": 8.0, "beta_deg": -6.0, "mach": 0.3}
    assert _error(error=0.05) == pytest.approx(0.05)
    assert _error(**place, error=0.05) == pytest.approx(0.05)
    down, side = sin(alpha) * cos(beta), sin(beta)
    assert _error(**place, error_alpha=-0.5) == pytest.approx(-0.5 * down)
    assert _error(**place, error_alpha2=-2.0) == pytest.approx(-2.0 * down**2)
    assert _error(**place, error_beta2=-3.0) == pytest.approx(-3.0 * side**2)
    assert _error(**place, error_mach2=0.2) == pytest.approx(0.2 * 0.09)
    everything = {"error": 0.05, "error_alpha": -0.5, "error_alpha2": -2.0, "error_beta2": -3.0, "error_mach2": 0.2}
    assert _error(**place, **everything) == pytest.approx(sum(_error(**place, **{k: v}) for k, v in everything.items()))


def test_ring_of_holes_in_cross_flow():
    """Potential flow around a tube with holes all around: -sin²α = -0.030 q at 10°; the quadratic term gives it.

    Across the tube it is the -1 of a cylinder, from whichever side, and never more.
    """
    assert _error(alpha_deg=90.0, error_alpha2=-1.0) == pytest.approx(-1.0)
    assert _error(beta_deg=-90.0, error_beta2=-1.0) == pytest.approx(-1.0)
    assert _error(alpha_deg=180.0, error_alpha2=-1.0) == pytest.approx(0.0, abs=1e-12)
    assert _error(alpha_deg=10.0, error_alpha2=-1.0) == pytest.approx(-0.030, abs=0.0006)


def test_slipstream_scales_the_position_error():
    assert _error(error=0.05, slipstream=0.4, throttle=1.0) == pytest.approx(0.05 * 1.4)
    assert _error(error=0.05, slipstream=0.4, throttle=0.0) == pytest.approx(0.05)


@pytest.mark.parametrize("angle", [nan, float("inf")])
def test_an_angle_that_is_none_gives_no_number(angle):
    port = total_port(TotalPortSettings(probe="plain"))
    assert np.isnan(port(P_TOTAL, P_STATIC, 0.1, angle, 0.0, 0.0))
    assert np.isnan(total_port(TotalPortSettings(slipstream=1.0))(nan, P_STATIC, 0.1, 0.0, 0.0, 1.0))


TOTAL = st.builds(TotalPortSettings, probe=st.sampled_from(["ideal", *PROBES]), slipstream=st.floats(-0.9, 5))
STATIC = st.builds(
    StaticPortSettings,
    error=st.floats(-1, 1),
    error_alpha=st.floats(-10, 10),
    error_alpha2=st.floats(-100, 100),
    error_beta2=st.floats(-100, 100),
    error_mach2=st.floats(-10, 10),
    slipstream=st.floats(-0.9, 5),
)


@given(
    total=TOTAL,
    static=STATIC,
    impact=st.floats(0, 1e5),
    mach=st.floats(0, 1),
    alpha=st.floats(-pi, pi),
    beta=st.floats(-pi / 2, pi / 2),
    throttle=st.floats(0, 1),
)
def test_finite_in_finite_out(total, static, impact, mach, alpha, beta, throttle):
    flow = (1e5 + impact, 1e5, mach, alpha, beta, throttle)
    for port in (total_port(total), static_port(static)):
        assert port is None or np.isfinite(port(*flow))
    port = total_port(total)
    if port is not None:
        assert 1e5 - 1e-9 <= port(*flow) <= 1e5 + 6.0 * impact + 1e-6
