"""Attitude of a case, and the specific force away from the point where it is known."""

from itertools import product as every

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sensors.mounting import IDENTITY, attitude, lever_arm, linear, product, transposed

G0 = 9.80665
ANGLES = st.floats(-360.0, 360.0)
NUMBERS = st.floats(-100.0, 100.0)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@given(ANGLES, ANGLES, ANGLES)
def test_attitude_is_the_yaw_pitch_roll_sequence(roll, pitch, yaw):
    """Authority: scipy.spatial.transform, intrinsic "ZYX"; 1e-12."""
    expected = Rotation.from_euler("ZYX", [yaw, pitch, roll], degrees=True).as_matrix()
    assert np.array(attitude(roll, pitch, yaw)) == pytest.approx(expected, abs=1e-12)


@given(ANGLES, ANGLES, ANGLES)
def test_attitude_is_orthonormal_and_right_handed(roll, pitch, yaw):
    r = attitude(roll, pitch, yaw)
    assert np.array(product(r, transposed(r))) == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(r) == pytest.approx(1.0, abs=1e-14)


def test_there_are_24_right_angle_mounts_and_they_are_exact():
    mounts = {attitude(*angles) for angles in every((-90.0, 0.0, 90.0, 180.0, 270.0), repeat=3)}
    assert len(mounts) == 24
    for mount in mounts:
        assert {abs(value) for row in mount for value in row} == {0.0, 1.0}


def test_a_second_turn_is_about_the_axes_of_the_first():
    """Nose up by 90°, then rolled by 90° about the case's own x: its y axis points down where its z axis was."""
    r = product(attitude(0, 90, 0), attitude(90, 0, 0))
    assert np.array(r) @ [0, 1, 0] == pytest.approx(np.array(attitude(0, 90, 0)) @ [0, 0, 1])
    assert product(IDENTITY, r) == product(r, IDENTITY) == r


@given(VECTORS, ANGLES, ANGLES, ANGLES)
def test_linear_is_the_matrix_product(vector, roll, pitch, yaw):
    r = attitude(roll, pitch, yaw)
    stage = linear(r)
    got = vector if stage is None else stage(*vector)
    assert got == pytest.approx(tuple(np.array(r) @ vector), abs=1e-12)


def test_the_identity_is_nothing_to_do():
    assert linear(attitude(0, 0, 0)) is None
    assert linear(attitude(360, -360, 0)) is None


# -- lever arm -----------------------------------------------------------------------------------------------------


def test_constant_spin_pulls_outwards_with_the_square_of_the_rate():
    """A sensor 0.3 m ahead on a body that yaws at 5 rad/s feels -ω² r: the support pulls it towards the axis."""
    assert lever_arm((0, 0, -G0), (0, 0, 5.0), (0, 0, 0), (0.3, 0, 0)) == pytest.approx((-7.5, 0, -G0), abs=1e-12)


def test_spin_up_pushes_across():
    """At rest, at 20 rad/s² about z, a sensor 0.3 m ahead is accelerated to the right with r dω/dt."""
    assert lever_arm((0, 0, 0), (0, 0, 0), (0, 0, 20.0), (0.3, 0, 0)) == pytest.approx((0, 6.0, 0), abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_lever_arm_against_the_position_of_a_point_of_a_tumbling_body(seed):
    """Authority: second derivative of p(t) = p_0(t) + R(t) r, by central differences of fourth order (1e-5 m/s²).

    The body turns about all axes with an attitude that is a smooth function of time; its rate and acceleration come
    from R(t) by differences as well, so no formula of rotating frames is used on that side. Gravity points down.
    """
    rng = np.random.default_rng(seed)
    amplitude, frequency, phase = rng.uniform(0.2, 1.2, 3), rng.uniform(0.5, 2.0, 3), rng.uniform(0, 6, 3)
    arm, gravity = rng.uniform(-0.5, 0.5, 3), np.array([0, 0, G0])

    def turned(t):
        yaw, pitch, roll = amplitude * np.sin(2 * np.pi * frequency * t + phase)
        return Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()

    def reference(t):
        return np.array([3 * t**2, np.sin(4 * t), -0.5 * t**3])

    def second(function, t, h=2e-3):
        return (-function(t + 2 * h) + 16 * function(t + h) - 30 * function(t) + 16 * function(t - h)
                - function(t - 2 * h)) / (12 * h * h)  # fmt: skip

    def first(function, t, h=2e-3):
        return (-function(t + 2 * h) + 8 * function(t + h) - 8 * function(t - h) + function(t - 2 * h)) / (12 * h)

    def rate(t):  # body axes: Rᵀ dR/dt is the cross-product matrix of ω
        spin = turned(t).T @ first(turned, t)
        return np.array([spin[2, 1], spin[0, 2], spin[1, 0]])

    t, to_body = 0.7, turned(0.7).T
    force = to_body @ (second(reference, t) - gravity)
    expected = to_body @ (second(lambda s: reference(s) + turned(s) @ arm, t) - gravity)
    got = lever_arm(tuple(force), tuple(rate(t)), tuple(first(rate, t)), tuple(arm))
    assert got == pytest.approx(tuple(expected), abs=2e-5)
    assert np.linalg.norm(expected - force) > 1.0  # the arm matters


@given(VECTORS, VECTORS, VECTORS)
def test_nothing_is_felt_of_the_arm_at_the_reference_point(force, rate, acceleration):
    assert lever_arm(force, rate, acceleration, (0.0, 0.0, 0.0)) == force
