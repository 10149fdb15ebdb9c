"""What compressibility adds to tables of one Mach number: factors on lift, and the drag that rises.

    k(M, Λ) = a(M)/a(M_ref),   a(M) ~ A / (2 + √(4 + A² (β² + tan² Λ))),   β² = 1 - M²

is the Prandtl-Glauert rule for a wing of aspect ratio A and sweep Λ (DATCOM 4.1.3.2 with a section of 2π/β; Raymer,
Aircraft Design, eq. 12.6). A body and a folded wing have next to none of it. All that goes with a part's lift has its
factor: moments, damping, downwash. The drag of the wing has besides, of Lock's law with Korn's number (Mason,
Configuration Aerodynamics, ch. 7; κ = 0.87 of NACA's older sections),

    ΔC_D = 20 (M - M_crit)⁴ S_w/S beyond M_crit = M_dd - (0.1/80)^(1/3),
    M_dd = κ/cos Λ - (t/c)/cos² Λ - C_L/(10 cos³ Λ).

Left out: what C_L does to M_crit beside that of the dash, shock-induced separation, the friction's own change (-3 % at
Mach 0.6). Beyond Mach 0.8 the tables end, and with them what they hold.
"""

import math

import aerosandbox as asb  # type: ignore[import-untyped]
import numpy as np

from .geometry import WING_POSITIONS, Geometry, sweep
from .shape import fin_shape, tail_shape, wing_shape

MACHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8)
KORN = 0.87
LOCK = 20.0
CRITICAL_BELOW = (0.1 / 80.0) ** (1.0 / 3.0)  # of the drag divergence, where dC_D/dM is 0.1
STEEPEST = math.radians(80.0)  # Λ is held there: a folded wing has 90°, and tan Λ no bound
SWEPT = math.radians(60.0)  # … and there in Korn's number, which was made for wings of jets


def is_compressible(geometry: Geometry) -> bool:
    """Whether the aircraft is one for which the Mach number counts."""
    return "mach" in geometry


def mach_tables(geometry: Geometry) -> dict[str, np.ndarray]:
    """Factors over `MACHS`, of the wing over `WING_POSITIONS` too, and the rise of drag; nothing of a slow aircraft."""
    if not is_compressible(geometry):
        return {}
    wings = [wing_shape(geometry, w) for w in WING_POSITIONS]
    swept = [sweep(geometry, w) for w in WING_POSITIONS]
    flat = {"mach-tail": tail_shape(geometry), "mach-fin": fin_shape(geometry)}
    return {
        "mach-wing": np.array([factors(geometry, wing, angle) for wing, angle in zip(wings, swept, strict=True)]).T,
        **{name: factors(geometry, shape, 0.0)[:, np.newaxis] for name, shape in flat.items()},
        "drag-rise": np.array([rise(geometry, angle) for angle in swept]).T,
    }


def factors(geometry: Geometry, shape: asb.Wing, angle: float) -> np.ndarray:
    """The factor k of a part over `MACHS`."""
    aspect = float(shape.aspect_ratio())
    reference = geometry["reference"]
    of_tables = reference["airspeed"] / float(asb.Atmosphere(reference["altitude"]).speed_of_sound())
    tangent = math.tan(min(abs(angle), STEEPEST))

    def slope(mach: np.ndarray) -> np.ndarray:
        return np.asarray(aspect / (2.0 + np.sqrt(4.0 + aspect**2 * (1.0 - mach**2 + tangent**2))))

    return np.asarray(slope(np.array(MACHS)) / slope(np.array(of_tables)))


def rise(geometry: Geometry, angle: float) -> np.ndarray:
    """Drag coefficient that compressibility adds over `MACHS`."""
    mach, cos = geometry["mach"], math.cos(min(abs(angle), SWEPT))
    divergence = KORN / cos - mach["thickness"] / cos**2 - mach["lift"] / (10.0 * cos**3)
    beyond = np.maximum(0.0, np.array(MACHS) - (divergence - CRITICAL_BELOW))
    return np.asarray(LOCK * beyond**4)
