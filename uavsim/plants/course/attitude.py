"""How the body stands that flies along a path: rotation matrices whose columns are the body's axes in NED.

    R = R_z(χ) R_y(γ) R_x(μ) R_y(α)                                 coordinated: no sideslip in the mean wind
    α = α₀ + n g (m/S)/(q̄ a),   q̄ = ½ ρ V²                          from the normal load n, n g = L/m

with wing loading m/S, lift slope a, and α₀ where there is no lift. A rail holds the body otherwise, as the wind on it
is not along it. What is between the two when it is left, the rotation exp(φ), dies away as ½ (1 + cos πt/1 s):

    R(t) = R_coordinated(t) exp(r(t) φ)
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TURNING = 1.0  # s in which the body turns into the flow after the rail; a small one's modes take about that


def about(axis: str, angle: Array) -> Array:
    """Return rotations about a body axis, shape (n, 3, 3)."""
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    turned = np.zeros((angle.size, 3, 3))
    turned[:, i, i] = 1.0
    turned[:, j, j] = turned[:, k, k] = np.cos(angle)
    turned[:, k, j] = np.sin(angle)
    turned[:, j, k] = -turned[:, k, j]
    return turned


def vector_of(rotation: Array) -> Array:
    """Return the rotation vector, rad, of one rotation by less than π."""
    sine = 0.5 * np.array(
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    )
    size, cosine = float(np.linalg.norm(sine)), 0.5 * (float(np.trace(rotation)) - 1.0)
    found: Array = sine * (np.arctan2(size, cosine) / size if size > 1e-12 else 1.0)
    return found


def of_vectors(vectors: Array) -> Array:
    """Return the rotations by vectors, rad, shape (n, 3)."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = vectors.T
    cross = np.zeros((len(vectors), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross[:, 1, 0], cross[:, 2, 0], cross[:, 2, 1] = z, -y, x
    found: Array = np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * cross @ cross
    return found


def settling(rotations: Array, held: Array, since: Array) -> Array:
    """Return how the body stands from the end of the rail on.

    Parameters
    ----------
    rotations : ndarray, shape (n, 3, 3)
        Coordinated, from that row on.
    held : ndarray, shape (3, 3)
        As the rail holds it.
    since : ndarray, shape (n,)
        Time since then, s.
    """
    between = vector_of(rotations[0].T @ held)
    left = 0.5 * (1.0 + np.cos(np.pi * np.minimum(since / TURNING, 1.0)))
    found: Array = rotations @ of_vectors(left[:, None] * between)
    return found


def angles(rotations: Array) -> tuple[Array, Array, Array]:
    """Return roll, pitch and heading, rad; the heading is continuous."""
    roll = np.arctan2(rotations[:, 2, 1], rotations[:, 2, 2])
    pitch = np.arcsin(np.clip(-rotations[:, 2, 0], -1.0, 1.0))
    heading = np.unwrap(np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0]))
    return np.unwrap(roll), pitch, heading


def rates(rotations: Array, rate: float) -> Array:
    """Return the rates of turn about the body's axes, rad/s, shape (n, 3), from neighbouring rows."""
    slope = np.gradient(rotations, axis=0) * rate if len(rotations) > 1 else np.zeros_like(rotations)
    turning = np.swapaxes(rotations, 1, 2) @ slope
    found: Array = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
    return found
