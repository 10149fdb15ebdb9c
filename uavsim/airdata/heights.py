"""Height and pressure: a layer of one temperature, and the standard atmosphere (ISO 2533:1975, ICAO Doc 7488).

    h = R_a·T/g₀·ln(p_ref/p)                                                  hypsometric, T the layer's mean
    T = T₀ + L·H,    p = p₀·(T/T₀)^(−g₀/(R_a·L))                              0 to 11 km, L = −6.5 K/km
    p = p₁₁·exp(−g₀·(H − 11 km)/(R_a·T₁₁))                                    11 to 20 km

H is geopotential height; the pressure height of a static pressure is the H at which the standard atmosphere has it.
"""

import math
from typing import Any

import numpy as np

from uavsim.airdata.constants import (
    GAS_CONSTANT_DRY_AIR,
    HIGHEST_STANDARD_HEIGHT,
    LOWEST_STANDARD_HEIGHT,
    STANDARD_GRAVITY,
    STANDARD_LAPSE,
    STANDARD_PRESSURE,
    STANDARD_TEMPERATURE,
    TROPOPAUSE,
)
from uavsim.airdata.values import Numbers, anywhere, numbers, require_pressure, require_temperature

_GRADIENT = STANDARD_GRAVITY / GAS_CONSTANT_DRY_AIR  # K/m, g₀/R_a
_POWER = -_GRADIENT / STANDARD_LAPSE  # –, 5.2559
_COLD = STANDARD_TEMPERATURE + STANDARD_LAPSE * TROPOPAUSE  # K, 216.65
_HIGH = STANDARD_PRESSURE * (_COLD / STANDARD_TEMPERATURE) ** _POWER  # Pa, at the tropopause


def pressure_height(*, static: Numbers, reference: Numbers | float, temperature: Numbers | float) -> Numbers:
    """Height above the place where the reference pressure was read, h = R_a·T/g₀·ln(p_ref/p).

    The hypsometric equation of dry air at rest. T is the mean of the layer between; the temperature measured at one of
    its ends errs by half the layer's lapse, 0.11 % of the height per 100 m of it at 6.5 K/km.

    Parameters
    ----------
    static, reference : float or array
        Static pressure here and there, Pa.
    temperature : float or array
        Mean temperature of the layer, K.

    Returns
    -------
    float or array
        Height, m (geopotential), positive above.

    Raises
    ------
    ValueError
        Pressure ≤ 0 or temperature outside 150–400 K.

    Examples
    --------
    >>> round(pressure_height(static=100_129.44, reference=101_325.0, temperature=287.825), 2)
    100.0
    """
    xp, (ps, reference_pressure, t) = numbers(static, reference, temperature)
    require_pressure(ps, reference_pressure)
    require_temperature(t)
    height: Numbers = hypsometric_height(ps, reference_pressure, t, xp)
    return height


def pressure_height_gradient(
    *, static: Numbers, reference: Numbers | float, temperature: Numbers | float
) -> tuple[Numbers, Numbers, Numbers]:
    """Derivatives of `pressure_height`.

    Parameters
    ----------
    static, reference, temperature : float or array
        Pa, Pa, K.

    Returns
    -------
    tuple of three floats or arrays
        ∂h/∂p, ∂h/∂p_ref, m/Pa; ∂h/∂T, m/K.

    Raises
    ------
    ValueError
        As `pressure_height`.
    """
    xp, (ps, reference_pressure, t) = numbers(static, reference, temperature)
    require_pressure(ps, reference_pressure)
    require_temperature(t)
    scale = t / _GRADIENT
    return (
        -scale / ps,
        scale / reference_pressure,
        hypsometric_height(ps, reference_pressure, 1.0, xp) * (1.0 + 0.0 * t),
    )


def standard_temperature(height: Numbers) -> Numbers:
    """Temperature of the standard atmosphere, K, at a geopotential height of −5 to 20 km, m.

    Raises
    ------
    ValueError
        Height outside −5000…20 000 m.

    Examples
    --------
    >>> standard_temperature(1000.0)
    281.65
    """
    xp, (h,) = numbers(height)
    _require_height(h)
    temperature: Numbers = STANDARD_TEMPERATURE + STANDARD_LAPSE * _least(h, TROPOPAUSE, xp)
    return temperature


def standard_pressure(height: Numbers) -> Numbers:
    """Pressure of the standard atmosphere, Pa, at a geopotential height of −5 to 20 km, m.

    Raises
    ------
    ValueError
        Height outside −5000…20 000 m.

    Examples
    --------
    >>> round(standard_pressure(1000.0), 2)
    89874.56
    """
    xp, (h,) = numbers(height)
    _require_height(h)
    low = _least(h, TROPOPAUSE, xp)
    below = STANDARD_PRESSURE * xp.exp(_POWER * xp.log1p(STANDARD_LAPSE * low / STANDARD_TEMPERATURE))
    pressure: Numbers = below * xp.exp(-_GRADIENT * (h - low) / _COLD)
    return pressure


def standard_height(static: Numbers) -> Numbers:
    """Geopotential height, m, at which the standard atmosphere has this static pressure, Pa: the pressure altitude.

    Raises
    ------
    ValueError
        Pressure ≤ 0.

    Examples
    --------
    >>> round(standard_height(89_874.56), 2)
    1000.0
    """
    xp, (ps,) = numbers(static)
    require_pressure(ps)
    low = -_least(-ps, -_HIGH, xp)
    below = STANDARD_TEMPERATURE / STANDARD_LAPSE * xp.expm1(xp.log(low / STANDARD_PRESSURE) / _POWER)
    height: Numbers = below - _COLD / _GRADIENT * xp.log(_least(ps, _HIGH, xp) / _HIGH)
    return height


def hypsometric_height(static: Any, reference: Any, temperature: Any, xp: Any = math) -> Any:
    """Height above the place of the reference pressure in air of one temperature, m; Pa and K, without checks."""
    return GAS_CONSTANT_DRY_AIR / STANDARD_GRAVITY * temperature * xp.log(reference / static)


def _least(value: Any, most: float, xp: Any) -> Any:
    """Return the lesser of the two, NaN where the value is NaN."""
    if xp is math:
        return most if value > most else value
    return np.minimum(value, most)


def _require_height(height: Any) -> None:
    if anywhere(height < LOWEST_STANDARD_HEIGHT) or anywhere(height > HIGHEST_STANDARD_HEIGHT):
        raise ValueError(f"height must be from {LOWEST_STANDARD_HEIGHT:g} to {HIGHEST_STANDARD_HEIGHT:g} m")
