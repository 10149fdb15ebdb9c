"""Density of moist air, CIPM-2007 (Picard et al., Metrologia 45 (2008) 149), p in Pa, T in K, t in °C:

    ρ = p·M_a / (Z·R·T) · [1 − x_v·(1 − M_v/M_a)]                                            its equation (1)
    x_v = h·f·p_sv(T)/p = f(p, t_d)·p_sv(t_d)/p        h relative humidity, t_d dew point            (A1.2)
    p_sv = 1 Pa·exp(A·T² + B·T + C + D/T)              f = α + β·p + γ·t²                            (A1.1, A1.2)
    Z = 1 − p/T·[a₀ + a₁t + a₂t² + (b₀ + b₁t)x_v + (c₀ + c₁t)x_v²] + (p/T)²·(d + e·x_v²)             (A1.4)

Fitted to 600 to 1100 hPa and 15 to 27 °C, where the density's relative uncertainty is 2.2e-5; within 1e-4 of a real-gas
code down to −10 °C. Saturation is over water at all temperatures, not over ice.
"""  # noqa: D400 (the equation is the sentence's end)

import math
from typing import Any

from uavsim.airdata.constants import (
    MOLAR_GAS_CONSTANT,
    MOLAR_MASS_DRY_AIR,
    VAPOUR_DEFICIT,
    ZERO_CELSIUS,
)
from uavsim.airdata.values import Numbers, numbers, require_fraction, require_pressure, require_temperature

# A1.4; K/Pa, (K/Pa)² for the last row, with powers of 1/°C.
_A0, _A1, _A2 = 1.58123e-6, -2.9331e-8, 1.1043e-10
_B0, _B1 = 5.707e-6, -2.051e-8
_C0, _C1 = 1.9898e-4, -2.376e-6
_D, _E = 1.83e-11, -0.765e-8
# A1.1: 1/K², 1/K, –, K; A1.2: –, 1/Pa, 1/°C².
_SATURATION = (1.2378847e-5, -1.9121316e-2, 33.93711047, -6.3431645e3)
_ENHANCEMENT = (1.00062, 3.14e-8, 5.6e-7)


def moist_air_density(
    *,
    pressure: Numbers,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    compressibility: float | None = None,
) -> Numbers:
    """Density of moist air by CIPM-2007.

    Parameters
    ----------
    pressure : float or array
        Static pressure, Pa.
    temperature : float or array
        Temperature of the air, K.
    vapour_fraction : float or array
        Mole fraction of water vapour x_v.
    compressibility : float, optional
        Z. None computes it: fitted to 60…110 kPa and 15…27 °C, relative uncertainty of the density there 2.2e-5, within
        1e-4 of a real-gas code down to −10 °C. 1.0 is the perfect gas of the published method.

    Returns
    -------
    float or array
        Density, kg/m³.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, or vapour fraction outside 0–1.

    Examples
    --------
    >>> round(moist_air_density(pressure=101_325.0, temperature=293.15), 6)
    1.204557
    """
    _, (p, t, xv) = numbers(pressure, temperature, vapour_fraction)
    _require(p, t, xv)
    z = virial_compressibility(p, t, xv) if compressibility is None else compressibility
    density: Numbers = moist_density(p, t, xv, z)
    return density


def moist_air_density_gradient(
    *, pressure: Numbers, temperature: Numbers | float, vapour_fraction: Numbers | float = 0.0
) -> tuple[Numbers, Numbers, Numbers]:
    """Derivatives of the density of moist air, Z included.

    Parameters
    ----------
    pressure, temperature, vapour_fraction : float or array
        Pa, K and mole fraction.

    Returns
    -------
    tuple of three floats or arrays
        ∂ρ/∂p, kg/(m³·Pa); ∂ρ/∂T, kg/(m³·K); ∂ρ/∂x_v, kg/m³.

    Raises
    ------
    ValueError
        As `moist_air_density`.
    """
    _, (p, t, xv) = numbers(pressure, temperature, vapour_fraction)
    _require(p, t, xv)
    z = virial_compressibility(p, t, xv)
    density = moist_density(p, t, xv, z)
    zp, zt, zx = _compressibility_slopes(p, t, xv)
    return (
        density * (1.0 / p - zp / z),
        density * (-1.0 / t - zt / z),
        density * (-VAPOUR_DEFICIT / (1.0 - xv * VAPOUR_DEFICIT) - zx / z),
    )


def compressibility_factor(
    *, pressure: Numbers, temperature: Numbers | float, vapour_fraction: Numbers | float = 0.0
) -> Numbers:
    """Z of moist air by CIPM-2007, A1.4.

    Parameters
    ----------
    pressure, temperature, vapour_fraction : float or array
        Pa, K and mole fraction.

    Returns
    -------
    float or array
        Z.

    Raises
    ------
    ValueError
        As `moist_air_density`.

    Examples
    --------
    >>> round(compressibility_factor(pressure=101_325.0, temperature=293.15), 6)
    0.999643
    """
    _, (p, t, xv) = numbers(pressure, temperature, vapour_fraction)
    _require(p, t, xv)
    z: Numbers = virial_compressibility(p, t, xv)
    return z


def saturation_vapour_pressure(temperature: Numbers) -> Numbers:
    """Vapour pressure of water at saturation by CIPM-2007, A1.1, over water.

    Parameters
    ----------
    temperature : float or array
        K.

    Returns
    -------
    float or array
        Pa.

    Raises
    ------
    ValueError
        Temperature outside 150–400 K.

    Examples
    --------
    >>> round(saturation_vapour_pressure(293.15), 2)
    2339.16
    """
    xp, (t,) = numbers(temperature)
    require_temperature(t)
    pressure: Numbers = _saturation(t, xp)
    return pressure


def vapour_fraction(*, relative_humidity: Numbers, pressure: Numbers | float, temperature: Numbers | float) -> Numbers:
    """Mole fraction of water vapour, x_v = h·f·p_sv/p.

    Parameters
    ----------
    relative_humidity : float or array
        h, 0 to 1.
    pressure, temperature : float or array
        Pa, K.

    Returns
    -------
    float or array
        x_v.

    Raises
    ------
    ValueError
        Relative humidity outside 0–1, pressure ≤ 0, temperature outside 150–400 K.

    Examples
    --------
    >>> round(vapour_fraction(relative_humidity=0.5, pressure=101_325.0, temperature=293.15), 6)
    0.011589
    """
    xp, (h, p, t) = numbers(relative_humidity, pressure, temperature)
    require_fraction(h, "relative humidity")
    require_pressure(p)
    require_temperature(t)
    fraction: Numbers = h * _enhancement(p, t) * _saturation(t, xp) / p
    return fraction


def vapour_fraction_at_dew_point(*, dew_point: Numbers, pressure: Numbers | float) -> Numbers:
    """Mole fraction of water vapour from the dew point, x_v = f(p, t_d)·p_sv(t_d)/p.

    Parameters
    ----------
    dew_point, pressure : float or array
        K, Pa.

    Returns
    -------
    float or array
        x_v.

    Raises
    ------
    ValueError
        Pressure ≤ 0, dew point outside 150–400 K.
    """
    saturated: Any = 1.0
    fraction: Numbers = vapour_fraction(relative_humidity=saturated, pressure=pressure, temperature=dew_point)
    return fraction


# The equations without checks.


def moist_density(p: Any, t: Any, xv: Any, z: Any) -> Any:
    """Density, kg/m³, of p Pa, T K, x_v and Z, without checks."""
    return p * MOLAR_MASS_DRY_AIR / (z * MOLAR_GAS_CONSTANT * t) * (1.0 - xv * VAPOUR_DEFICIT)


def virial_compressibility(p: Any, t: Any, xv: Any) -> Any:
    """Z of p Pa, T K and x_v, without checks."""
    return 1.0 - p / t * _virial(t - ZERO_CELSIUS, xv) + (p / t) ** 2 * (_D + _E * xv * xv)


def _virial(c: Any, xv: Any) -> Any:
    """Return the bracket of A1.4, K/Pa, at c °C."""
    return _A0 + (_A1 + _A2 * c) * c + (_B0 + _B1 * c) * xv + (_C0 + _C1 * c) * xv * xv


def _compressibility_slopes(p: Any, t: Any, xv: Any) -> tuple[Any, Any, Any]:
    """Return ∂Z/∂p, ∂Z/∂T and ∂Z/∂x_v."""
    c, u = t - ZERO_CELSIUS, p / t
    warming = _A1 + 2.0 * _A2 * c + _B1 * xv + _C1 * xv * xv
    wetting = _B0 + _B1 * c + 2.0 * (_C0 + _C1 * c) * xv
    by_u = -_virial(c, xv) + 2.0 * u * (_D + _E * xv * xv)
    return by_u / t, -by_u * u / t - u * warming, -u * wetting + 2.0 * u * u * _E * xv


def _saturation(t: Any, xp: Any = math) -> Any:
    a, b, c, d = _SATURATION
    return xp.exp((a * t + b) * t + c + d / t)


def _enhancement(p: Any, t: Any) -> Any:
    alpha, beta, gamma = _ENHANCEMENT
    return alpha + beta * p + gamma * (t - ZERO_CELSIUS) ** 2


def _require(p: Any, t: Any, xv: Any) -> None:
    require_pressure(p)
    require_temperature(t)
    require_fraction(xv)
