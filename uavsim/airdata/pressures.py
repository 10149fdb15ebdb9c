"""Mach number, total, static, impact and dynamic pressure in isentropic flow of a perfect gas, γ = 1.4.

NACA Report 1135, equations 43 and 44:

    p_t = p_s·(1 + (γ−1)/2·M²)^(γ/(γ−1))          q_c = p_t − p_s          q = γ/2·p_s·M² = ρ·V²/2

q_c is the impact pressure that a pair of sensors reads, q the dynamic pressure that a pressure coefficient is a share
of; q_c/q = 1 + M²/4 + M⁴/40 + … . log1p and expm1 in place of powers keep the digits of q_c at low speed.
"""

import math
from typing import Any

from uavsim.airdata.constants import EXPONENT, GAMMA, HALF_EXCESS
from uavsim.airdata.values import (
    Numbers,
    clip,
    nan_beyond_mach_1,
    nan_up_to_zero,
    numbers,
    require_mach,
    require_pressure,
    require_subsonic,
)


def total_pressure(*, static: Numbers, mach: Numbers | float) -> Numbers:
    """Pressure of air brought to rest without loss.

    Parameters
    ----------
    static : float or array
        Static pressure, Pa.
    mach : float or array
        Mach number, 0 to 1; 1e-6 beyond either end is taken for rounding.

    Returns
    -------
    float or array
        Total pressure, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or Mach number outside 0–1.

    Examples
    --------
    >>> round(total_pressure(static=100_000.0, mach=0.5), 2)
    118621.26
    """
    xp, (ps, m) = numbers(static, mach)
    require_pressure(ps)
    require_mach(m)
    total: Numbers = isentropic_total(ps, m, xp)
    return total


def total_pressure_gradient(*, static: Numbers, mach: Numbers | float) -> tuple[Numbers, Numbers]:
    """Derivatives of the total pressure.

    Parameters
    ----------
    static, mach : float or array
        Pa and Mach number.

    Returns
    -------
    tuple of two floats or arrays
        ∂p_t/∂p_s; ∂p_t/∂M, Pa.

    Raises
    ------
    ValueError
        As `total_pressure`.
    """
    xp, (ps, m) = numbers(static, mach)
    require_pressure(ps)
    require_mach(m)
    total = isentropic_total(ps, m, xp)
    return total / ps, GAMMA * m * total / (1.0 + HALF_EXCESS * m * m)


def static_pressure(*, total: Numbers, mach: Numbers | float) -> Numbers:
    """Find the static pressure of flow whose total pressure and Mach number are known.

    Parameters
    ----------
    total, mach : float or array
        Pa and Mach number, 0 to 1.

    Returns
    -------
    float or array
        Static pressure, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or Mach number outside 0–1.

    Examples
    --------
    >>> round(static_pressure(total=118_621.26, mach=0.5), 1)
    100000.0
    """
    xp, (pt, m) = numbers(total, mach)
    require_pressure(pt)
    require_mach(m)
    static: Numbers = pt * xp.exp(-xp.log1p(HALF_EXCESS * m * m) / EXPONENT)
    return static


def impact_pressure(*, static: Numbers, mach: Numbers | float) -> Numbers:
    """Total less static pressure, q_c, without the loss of digits of their difference.

    Parameters
    ----------
    static, mach : float or array
        Pa and Mach number, 0 to 1.

    Returns
    -------
    float or array
        q_c, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or Mach number outside 0–1.

    Examples
    --------
    >>> round(impact_pressure(static=101_325.0, mach=0.3), 2)
    6528.4
    """
    xp, (ps, m) = numbers(static, mach)
    require_pressure(ps)
    require_mach(m)
    impact: Numbers = ps * impact_share(m, xp)
    return impact


def dynamic_pressure(*, static: Numbers, mach: Numbers | float) -> Numbers:
    """Dynamic pressure, q = γ/2·p_s·M².

    Parameters
    ----------
    static, mach : float or array
        Pa and Mach number, 0 to 1.

    Returns
    -------
    float or array
        q, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or Mach number outside 0–1.

    Examples
    --------
    >>> round(dynamic_pressure(static=101_325.0, mach=0.3), 3)
    6383.475
    """
    _, (ps, m) = numbers(static, mach)
    require_pressure(ps)
    require_mach(m)
    pressure: Numbers = 0.5 * GAMMA * ps * m * m
    return pressure


def mach(*, total: Numbers, static: Numbers | float) -> Numbers:
    """Mach number from total and static pressure, the inverse of `total_pressure`.

    Parameters
    ----------
    total, static : float or array
        Pressures, Pa. A total pressure below the static one gives 0.

    Returns
    -------
    float or array
        Mach number; in an array NaN where the ratio is beyond that of Mach 1 (+ 1e-6): there a shock stands before the
        tube and the isentropic relation does not hold.

    Raises
    ------
    ValueError
        Pressure ≤ 0; two floats of such a ratio.

    Examples
    --------
    >>> round(mach(total=118_621.264, static=100_000.0), 6)
    0.5
    """
    xp, (pt, ps) = numbers(total, static)
    pt = nan_beyond_mach_1(pt, ps, xp)
    number: Numbers = isentropic_mach(clip(pt - ps) / ps, xp)
    return number


def mach_gradient(*, total: Numbers, static: Numbers | float) -> tuple[Numbers, Numbers]:
    """Derivatives of the Mach number, ∂M/∂p_t = (1 + 0.2·M²)/(γ·M·p_t) and ∂M/∂p_s = −(p_t/p_s)·∂M/∂p_t.

    The root has no slope at M = 0: where p_t ≤ p_s they are NaN, and a filter has to work in pressure there.

    Parameters
    ----------
    total, static : float or array
        Pressures, Pa.

    Returns
    -------
    tuple of two floats or arrays
        ∂M/∂p_t and ∂M/∂p_s, 1/Pa.

    Raises
    ------
    ValueError
        As `mach`.
    """
    xp, (pt, ps) = numbers(total, static)
    require_subsonic(pt, ps)
    m = isentropic_mach(nan_up_to_zero(pt - ps, xp) / ps, xp)
    slope = (1.0 + HALF_EXCESS * m * m) / (GAMMA * m * pt)
    return slope, -slope * pt / ps


# The equations themselves, for floats and arrays alike (`xp` is math or numpy), without checks. The loop calls those
# of total and static pressure directly: a keyword call with its checks costs a microsecond, they a quarter.


def isentropic_total(static: Any, mach: Any, xp: Any = math) -> Any:
    """Total pressure, Pa, without checks."""
    return static + static * impact_share(mach, xp)


def impact_share(mach: Any, xp: Any = math) -> Any:
    """q_c/p_s of a Mach number, without checks."""
    return xp.expm1(xp.log1p(HALF_EXCESS * mach * mach) / EXPONENT)


def isentropic_mach(share: Any, xp: Any = math) -> Any:
    """Mach number of q_c/p_s ≥ 0, without checks."""
    return xp.sqrt(xp.expm1(EXPONENT * xp.log1p(share)) / HALF_EXCESS)
