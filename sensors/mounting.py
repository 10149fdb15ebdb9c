"""How a sensor is turned: rigid-body kinematics.

    z = Rᵀ f,   R = R_z(ψ) R_y(θ) R_x(φ)  what the axes of a case read that has the attitude roll φ, pitch θ, yaw ψ

R turns components in the case into components in the body: its columns are the case's axes. Right angles are exact:
their sines and cosines are -1, 0 and 1.

Source: Titterton & Weston, "Strapdown Inertial Navigation Technology", ch. 3.6 (attitude).
"""

from collections.abc import Callable
from math import cos, radians, sin

from sensors.unit import Triple

Matrix = tuple[Triple, Triple, Triple]
"""Rows of a 3×3 matrix."""

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def attitude(roll_deg: float, pitch_deg: float, yaw_deg: float) -> Matrix:
    """Return R of a case that was turned by yaw, then pitch, then roll, each about its own axis, degrees."""
    (cr, sr), (cp, sp), (cy, sy) = map(_cosine_and_sine, (roll_deg, pitch_deg, yaw_deg))
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def product(a: Matrix, b: Matrix) -> Matrix:
    """Return a b: of attitudes, that of a case turned by b from where a has turned it."""
    across = transposed(b)
    first, second, third = (tuple(_dot(row, column) for column in across) for row in a)
    return _row(first), _row(second), _row(third)


def transposed(matrix: Matrix) -> Matrix:
    """Return the transpose: of an attitude, its inverse."""
    first, second, third = zip(*matrix, strict=True)
    return _row(first), _row(second), _row(third)


def linear(matrix: Matrix) -> Callable[[float, float, float], Triple] | None:
    """Return what multiplies a vector by a matrix; None for the identity."""
    if matrix == IDENTITY:
        return None
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix

    def multiply(x: float, y: float, z: float) -> Triple:
        return xx * x + xy * y + xz * z, yx * x + yy * y + yz * z, zx * x + zy * y + zz * z

    return multiply


def _cosine_and_sine(angle_deg: float) -> tuple[float, float]:
    if angle_deg % 90.0 == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(angle_deg // 90.0) % 4]
    return cos(radians(angle_deg)), sin(radians(angle_deg))


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _row(values: tuple[float, ...]) -> Triple:
    x, y, z = values
    return x, y, z
