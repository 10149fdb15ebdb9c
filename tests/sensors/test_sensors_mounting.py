"""Attitude of a case, and the specific force away from the point where it is known."""

from itertools import product as every

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sensors.mounting import IDENTITY, attitude, linear, product, transposed

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
