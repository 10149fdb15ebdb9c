"""Calibrated and equivalent airspeed: what an instrument set for the standard sea level shows, and what loads follow.

    calibrated  q_c = p₀·[(1 + (γ−1)/2·(V_c/a₀)²)^(γ/(γ−1)) − 1]           the airspeed of this q_c at sea level
    equivalent  V_e = V·√(ρ/ρ₀) = a₀·M·√(p_s/p₀)                           the airspeed of this q = ρ·V²/2 there
    true        V = a·M

p₀ = 101 325 Pa, T₀ = 288.15 K, a₀ = 340.294 m/s, ρ₀ = 1.225 kg/m³ (ISO 2533:1975). Dry air, subsonic: a Mach number
above 1, also V_c/a₀ > 1, is refused where it would have to be believed. Calibrated and equivalent airspeed need no
temperature.
"""

import math
from typing import Any

from uavsim.airdata.constants import GAMMA, HALF_EXCESS, STANDARD_PRESSURE, STANDARD_TEMPERATURE
from uavsim.airdata.pressures import impact_share, isentropic_mach, mach
from uavsim.airdata.speeds import sound
from uavsim.airdata.values import (
    Numbers,
    clip,
    nan_up_to_zero,
    numbers,
    require_mach,
    require_pressure,
    require_speed,
    require_subsonic,
    require_temperature,
)

STANDARD_SPEED_OF_SOUND = sound(STANDARD_TEMPERATURE)  # m/s, a₀


def calibrated_airspeed(*, total: Numbers, static: Numbers | float) -> Numbers:
    """Calibrated airspeed from the two pressures; p_t < p_s gives 0.

    Parameters
    ----------
    total, static : float or array
        Pa.

    Returns
    -------
    float or array
        m/s.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or pressures of a Mach number above 1.

    Examples
    --------
    >>> round(calibrated_airspeed(total=101_325.0 + 552.3219, static=101_325.0), 4)
    30.0
    """
    xp, (pt, ps) = numbers(total, static)
    require_subsonic(pt, ps)
    speed: Numbers = _calibrated(clip(pt - ps), xp)
    return speed


def calibrated_airspeed_gradient(*, total: Numbers, static: Numbers | float) -> tuple[Numbers, Numbers]:
    """Derivatives of `calibrated_airspeed`, which depends on the difference alone; NaN where p_t ≤ p_s.

    Parameters
    ----------
    total, static : float or array
        Pa.

    Returns
    -------
    tuple of two floats or arrays
        ∂V_c/∂p_t and ∂V_c/∂p_s, m/(s·Pa).

    Raises
    ------
    ValueError
        As `calibrated_airspeed`.
    """
    xp, (pt, ps) = numbers(total, static)
    require_subsonic(pt, ps)
    difference = nan_up_to_zero(pt - ps, xp)
    number = isentropic_mach(difference / STANDARD_PRESSURE, xp)
    slope = (
        STANDARD_SPEED_OF_SOUND
        * (1.0 + HALF_EXCESS * number * number)
        / (GAMMA * number * (STANDARD_PRESSURE + difference))
    )
    return slope, -slope


def equivalent_airspeed(*, total: Numbers, static: Numbers | float) -> Numbers:
    """Equivalent airspeed from the two pressures; p_t < p_s gives 0.

    Parameters
    ----------
    total, static : float or array
        Pa.

    Returns
    -------
    float or array
        m/s.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or pressures of a Mach number above 1.
    """
    xp, (pt, ps) = numbers(total, static)
    speed: Numbers = _equivalent(mach(total=pt, static=ps), ps, xp)
    return speed


def equivalent_airspeed_gradient(*, total: Numbers, static: Numbers | float) -> tuple[Numbers, Numbers]:
    """Derivatives of `equivalent_airspeed`; NaN where p_t ≤ p_s.

    Parameters
    ----------
    total, static : float or array
        Pa.

    Returns
    -------
    tuple of two floats or arrays
        ∂V_e/∂p_t and ∂V_e/∂p_s, m/(s·Pa).

    Raises
    ------
    ValueError
        As `equivalent_airspeed`.
    """
    xp, (pt, ps) = numbers(total, static)
    require_subsonic(pt, ps)
    number = isentropic_mach(nan_up_to_zero(pt - ps, xp) / ps, xp)
    speed = _equivalent(number, ps, xp)
    by_total = speed * (1.0 + HALF_EXCESS * number * number) / (GAMMA * number * number * pt)
    return by_total, -by_total * pt / ps + 0.5 * speed / ps


def impact_pressure_at_calibrated(calibrated: Numbers) -> Numbers:
    """q_c, Pa, at a calibrated airspeed of 0 to a₀, m/s.

    Raises
    ------
    ValueError
        Airspeed below 0 or above a₀.

    Examples
    --------
    >>> round(impact_pressure_at_calibrated(30.0), 4)
    552.3219
    """
    xp, (vc,) = numbers(calibrated)
    impact: Numbers = _impact(vc, xp)
    return impact


def mach_from_calibrated(*, calibrated: Numbers, static: Numbers | float) -> Numbers:
    """Mach number at a calibrated airspeed, m/s, and a static pressure, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, airspeed below 0 or above a₀, or a Mach number above 1.

    Examples
    --------
    >>> round(mach_from_calibrated(calibrated=128.611, static=30_742.5), 3)
    0.662
    """
    xp, (vc, ps) = numbers(calibrated, static)
    number: Numbers = _mach(vc, ps, xp)
    return number


def calibrated_from_mach(*, mach: Numbers, static: Numbers | float) -> Numbers:
    """Calibrated airspeed, m/s, of a Mach number, 0 to 1, at a static pressure, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0 or Mach number outside 0–1.
    """
    xp, (m, ps) = numbers(mach, static)
    require_pressure(ps)
    require_mach(m)
    speed: Numbers = _calibrated(ps * impact_share(m, xp), xp)
    return speed


def true_from_calibrated(*, calibrated: Numbers, static: Numbers | float, temperature: Numbers | float) -> Numbers:
    """True airspeed, m/s, of a calibrated one at a static pressure, Pa, and a temperature, K.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, airspeed below 0 or above a₀, or a Mach number above 1.

    Examples
    --------
    >>> round(true_from_calibrated(calibrated=128.611, static=30_742.5, temperature=229.65), 1)
    201.0
    """
    xp, (vc, ps, t) = numbers(calibrated, static, temperature)
    require_temperature(t)
    speed: Numbers = _mach(vc, ps, xp) * sound(t, xp)
    return speed


def calibrated_from_true(*, true: Numbers, static: Numbers | float, temperature: Numbers | float) -> Numbers:
    """Calibrated airspeed, m/s, of a true one at a static pressure, Pa, and a temperature, K.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, airspeed below 0, or a Mach number above 1.
    """
    xp, (v, ps, t) = numbers(true, static, temperature)
    speed: Numbers = calibrated_from_mach(mach=_true_mach(v, ps, t, xp), static=ps)
    return speed


def equivalent_from_true(*, true: Numbers, static: Numbers | float, temperature: Numbers | float) -> Numbers:
    """Equivalent airspeed, m/s, of a true one at a static pressure, Pa, and a temperature, K.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, airspeed below 0, or a Mach number above 1.

    Examples
    --------
    >>> round(equivalent_from_true(true=100.0, static=54_019.89, temperature=255.65), 2)
    77.52
    """
    xp, (v, ps, t) = numbers(true, static, temperature)
    speed: Numbers = _equivalent(_true_mach(v, ps, t, xp), ps, xp)
    return speed


def true_from_equivalent(*, equivalent: Numbers, static: Numbers | float, temperature: Numbers | float) -> Numbers:
    """True airspeed, m/s, of an equivalent one at a static pressure, Pa, and a temperature, K.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, airspeed below 0, or a Mach number above 1.
    """
    xp, (ve, ps, t) = numbers(equivalent, static, temperature)
    require_temperature(t)
    speed: Numbers = _equivalent_mach(ve, ps, xp) * sound(t, xp)
    return speed


def equivalent_from_calibrated(*, calibrated: Numbers, static: Numbers | float) -> Numbers:
    """Equivalent airspeed, m/s, of a calibrated one at a static pressure, Pa: the correction for compressibility.

    Raises
    ------
    ValueError
        Pressure ≤ 0, airspeed below 0 or above a₀, or a Mach number above 1.
    """
    xp, (vc, ps) = numbers(calibrated, static)
    speed: Numbers = _equivalent(_mach(vc, ps, xp), ps, xp)
    return speed


def calibrated_from_equivalent(*, equivalent: Numbers, static: Numbers | float) -> Numbers:
    """Calibrated airspeed, m/s, of an equivalent one at a static pressure, Pa.

    Raises
    ------
    ValueError
        Pressure ≤ 0, airspeed below 0, or a Mach number above 1.
    """
    xp, (ve, ps) = numbers(equivalent, static)
    speed: Numbers = calibrated_from_mach(mach=_equivalent_mach(ve, ps, xp), static=ps)
    return speed


def _calibrated(impact: Any, xp: Any = math) -> Any:
    return STANDARD_SPEED_OF_SOUND * isentropic_mach(impact / STANDARD_PRESSURE, xp)


def _equivalent(mach: Any, static: Any, xp: Any) -> Any:
    return STANDARD_SPEED_OF_SOUND * mach * xp.sqrt(static / STANDARD_PRESSURE)


def _impact(calibrated: Any, xp: Any) -> Any:
    require_speed(calibrated)
    require_mach(calibrated / STANDARD_SPEED_OF_SOUND)
    return STANDARD_PRESSURE * impact_share(calibrated / STANDARD_SPEED_OF_SOUND, xp)


def _mach(calibrated: Any, static: Any, xp: Any) -> Any:
    require_pressure(static)
    impact = _impact(calibrated, xp)
    require_subsonic(static + impact, static)
    return isentropic_mach(impact / static, xp)


def _true_mach(true: Any, static: Any, temperature: Any, xp: Any) -> Any:
    require_pressure(static)
    require_temperature(temperature)
    require_speed(true)
    number = true / sound(temperature, xp)
    require_mach(number)
    return number


def _equivalent_mach(equivalent: Any, static: Any, xp: Any) -> Any:
    require_pressure(static)
    require_speed(equivalent)
    number = equivalent / (STANDARD_SPEED_OF_SOUND * xp.sqrt(static / STANDARD_PRESSURE))
    require_mach(number)
    return number
