"""From the speed of incompressible flow to the pressure at a Mach number.

Kármán and Tsien's rule for the speed, with β = √(1 − M²) and λ = M²/(1 + β)² (Tsien, J. Aeronautical Sciences 6 (1939)
399), then the isentropic relation along the streamline:

    u/U = q·(1 − λ)/(1 − λ·q²)        q the speed in incompressible flow
    Cp = 2/(γM²)·{[1 + (γ−1)/2·M²·(1 − (u/U)²)]^(γ/(γ−1)) − 1}

For small disturbances it is Prandtl and Glauert's Cp/β; at a stagnation point it is exact, q_c/q. A body of revolution
disturbs the air less than a wing: its axial flow is that about the body with all radii times β, its disturbances over
β² (Göthert's rule). Being linear it would be wrong where the flow stands still, so it fades out there as (u/U)².

Above the critical Mach number of a place the rules do not hold: `critical_coefficient` tells.
"""

import math
from typing import Any

import numpy as np

from uavsim.airdata.constants import EXPONENT, GAMMA, HALF_EXCESS

LEAST = 1e-4  # Mach number below which the share is that of incompressible flow to the last digits


def speed_ratio(speed: Any, mach: Any) -> Any:
    """Kármán–Tsien: u/U at a Mach number below 1 of the incompressible speed q, both over the stream's.

    Where the rule's own limit λ·q² = 1 is near, far above the speed of sound, it is held at 0.9.
    """
    beta = np.sqrt(1.0 - mach * mach)
    lam = (mach / (1.0 + beta)) ** 2
    return speed * (1.0 - lam) / (1.0 - np.minimum(lam * speed * speed, 0.9))


def axial_ratio(speed: Any, thin: Any, mach: Any) -> Any:
    """Göthert: u/U along a body of the incompressible speeds of the body and of that with radii times β."""
    disturbance = 1.0 + (thin - 1.0) / (1.0 - mach * mach)
    return speed + (disturbance - speed) * np.minimum(speed * speed, 1.0)


def impact_share_of(square: Any, mach: Any) -> Any:
    """Share of q_c that a place where (u/U)² is `square` reads, (p − p_s)/q_c: 1 where the flow stands still."""
    loss = HALF_EXCESS * np.maximum(mach, LEAST) ** 2
    rise = np.log1p(np.maximum(loss * (1.0 - square), -0.999)) / EXPONENT
    return np.expm1(rise) / np.expm1(np.log1p(loss) / EXPONENT)


def critical_coefficient(mach: float) -> float:
    """Pressure coefficient where the local flow is as fast as sound; −∞ at Mach 0."""
    if mach == 0.0:
        return -math.inf
    ratio = (1.0 + HALF_EXCESS * mach * mach) / (1.0 + HALF_EXCESS)
    return float((ratio ** (1.0 / EXPONENT) - 1.0) / (0.5 * GAMMA * mach * mach))
