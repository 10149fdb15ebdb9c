"""What the ports of an air-data probe feel: pressure as a function of the flow's angle, Mach number and the propeller.

Total port, with the impact pressure q_c = p_t - p_s and the angle θ between flow and probe, cos θ = cos α cos β:

    p = p_s + q_c (1 + e η) max(0, 1 - k max(0, θ - θ₀)²),   θ₀ = 10°,   k = 0.01/(θ_1% - θ₀)²

A probe loses nothing up to θ₀ and one hundredth of q_c at its quoted limit θ_1%. The parabola is a fit about it;
further out it ends at the static pressure, as what a probe reads of a flow from the side or from behind is its own.

Static port, with its position error as a polynomial, in shares of the local impact pressure:

    p = p_s + q_c (1 + e η) (c₀ + c_α z + c_αα z² + c_ββ y² + c_M M²),   z = sin α cos β,  y = sin β

At small angles z and y are α and β. Further out they are the air's speed across the body over that past it: holes in a
tube feel its square, down to the −1 of a cylinder in potential flow.

e is how much of the dynamic pressure the propeller adds at full throttle η = 1 where the port stands.
"""

from collections.abc import Callable
from math import acos, cos, isfinite, nan, radians, sin

from sensors.settings import StaticPortSettings, TotalPortSettings

FREE_ANGLE = radians(10.0)  # θ₀: a plain pitot tube is "acceptable below about 10°" (basicairdata, on NACA TN 2530)

LIMITS = {
    # Angle at which one hundredth of the impact pressure is lost, rad.
    "plain": radians(20.0),  # "remarkable loss" beyond it (same place); square-cut thin tubes 20 … 23° (NACA TN 3641)
    "bevelled": radians(28.0),  # bevelled inside (NACA TN 3641, as recalled: the report was not at hand)
    "kiel": radians(40.0),  # "Kiel ~40° at the 1 % total-pressure-error criterion" (same place); makers' data ±40°
}

Port = Callable[[float, float, float, float, float, float], float]
"""p_total, p_static, Pa, Mach number, alpha, beta, rad, throttle 0 … 1 -> pressure at the port, Pa."""


def flow_angle(alpha: float, beta: float) -> float:
    """Return the angle between the flow and the body's x axis, rad, of angle of attack and sideslip, rad.

    NaN where they are no angles.
    """
    if not (isfinite(alpha) and isfinite(beta)):
        return nan
    return acos(cos(alpha) * cos(beta))


def recovery(angle: float, limit: float) -> float:
    """Return the share of the impact pressure that a probe with this 1 % `limit` feels at a flow `angle`, rad.

    Examples
    --------
    >>> from math import radians
    >>> recovery(radians(5.0), radians(20.0))
    1.0
    >>> round(recovery(radians(20.0), radians(20.0)), 12)
    0.99
    """
    beyond = angle - FREE_ANGLE
    if beyond <= 0.0:
        return 1.0
    share = 1.0 - 0.01 * (beyond / (limit - FREE_ANGLE)) ** 2
    return 0.0 if share < 0.0 else share


def total_port(settings: TotalPortSettings) -> Port | None:
    """Return what the total port feels, or None where that is the total pressure itself."""
    slipstream = settings.slipstream
    if settings.probe == "ideal":
        if slipstream == 0.0:
            return None
        return lambda p_total, p_static, _mach, _alpha, _beta, throttle: (
            p_total + slipstream * throttle * (p_total - p_static)
        )
    limit = LIMITS[settings.probe]

    def port(p_total: float, p_static: float, _mach: float, alpha: float, beta: float, throttle: float) -> float:
        share = recovery(flow_angle(alpha, beta), limit)
        return p_static + (p_total - p_static) * (1.0 + slipstream * throttle) * share

    return port


def static_port(settings: StaticPortSettings) -> Port | None:
    """Return what the static port feels, or None where that is the static pressure itself."""
    s = settings
    c0, c1, c2, cb, cm, slipstream = (
        s.error, s.error_alpha, s.error_alpha2, s.error_beta2, s.error_mach2, s.slipstream,
    )  # fmt: skip
    if not (c0 or c1 or c2 or cb or cm):
        return None

    def port(p_total: float, p_static: float, mach: float, alpha: float, beta: float, throttle: float) -> float:
        if not (isfinite(alpha) and isfinite(beta)):
            return nan
        side, down = sin(beta), sin(alpha) * cos(beta)
        error = c0 + (c1 + c2 * down) * down + cb * side * side + cm * mach * mach
        return p_static + (p_total - p_static) * (1.0 + slipstream * throttle) * error

    return port
