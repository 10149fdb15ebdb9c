"""The aircraft's measures as geometry.toml has them, and where the turning wing panel is.

The right panel turns about its pivot; its sweep Λ goes linearly with the wing position w, 0 folded to 1 out. A point
`out` along and `forward` across the panel from the pivot is at x = x_p + out sin Λ - forward cos Λ and
y = y_p + out cos Λ + forward sin Λ. Structural frame: x aft, y right, z up, in m.
"""

import math
import tomllib
from pathlib import Path
from typing import Any

Geometry = dict[str, Any]
Vector = tuple[float, float, float]

WING_POSITIONS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0)


def read_geometry(path: Path) -> Geometry:
    """Read geometry.toml."""
    with path.open("rb") as file:
        return tomllib.load(file)


def sweep(geometry: Geometry, w: float) -> float:
    """Sweep angle (rad) at wing position w."""
    wing = geometry["wing"]
    return math.radians(wing["sweep_folded_deg"] + w * (wing["sweep_out_deg"] - wing["sweep_folded_deg"]))


def place(geometry: Geometry, w: float, out: float, forward: float) -> tuple[float, float]:
    """Structural x, y (m) of a point of the right panel given along and across the panel from its pivot."""
    s, c = math.sin(sweep(geometry, w)), math.cos(sweep(geometry, w))
    x, y = geometry["wing"]["pivot"]
    return x + out * s - forward * c, y + out * c + forward * s
