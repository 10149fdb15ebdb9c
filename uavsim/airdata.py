"""Air data: what pressures and temperature say about density, Mach number and airspeed.

Density of moist air, CIPM-2007 (Picard et al., Metrologia 45 (2008) 149), p in Pa, T in K, x_v the mole fraction of
water vapour:

    ρ = p·M_a / (Z·R·T) · [1 − x_v·(1 − M_v/M_a)]

Isentropic flow of a perfect gas, γ = 1.4 (NACA Report 1135, eqs. 43 and 44; R_a the specific gas constant of air):

    p_t = p_s·(1 + (γ−1)/2·M²)^(γ/(γ−1))          a = √(γ·R_a·T)
    V = M·a = √(2γ/(γ−1)·R_a·T·[(p_t/p_s)^((γ−1)/γ) − 1])          model "compressible"

Bernoulli's V = K·√(2·(p_t − p_s)/ρ) with Z = 1 is its limit at small M and the relation of the published method that
this project tests (model "bernoulli"); it reads 0.2 % high at Mach 0.12 and 4.6 % at 0.6.

Temperatures are those of the undisturbed air, not of a probe that the flow has warmed. Floats give floats through
`math` (fast enough for the loop), anything else gives float64 arrays through NumPy, element by element with
broadcasting; both take the same equations. NaN in gives NaN out.
"""

import math
from collections.abc import Callable
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

Numbers = TypeVar("Numbers", float, NDArray[np.float64])
Model = Literal["compressible", "bernoulli"]
Negative = Literal["clip", "signed", "nan"]

GAMMA = 1.4  # –, ratio of specific heats of air (ISO 2533:1975)
GAS_CONSTANT_DRY_AIR = 287.05287  # J/(kg·K) (ISO 2533:1975)
STANDARD_GRAVITY = 9.80665  # m/s² (ISO 80000-3)
MOLAR_GAS_CONSTANT = 8.314472  # J/(mol·K) (CODATA 2006, as in CIPM-2007)
MOLAR_MASS_DRY_AIR = 28.96546e-3  # kg/mol (CIPM-2007, 400 µmol/mol of CO₂)
MOLAR_MASS_WATER = 18.01528e-3  # kg/mol (CIPM-2007)
ZERO_CELSIUS = 273.15  # K
MIN_TEMPERATURE, MAX_TEMPERATURE = 150.0, 400.0  # K; outside is no air that anything here flies in
MACH_ROUNDING = 1e-6  # –; a Mach number this far outside 0…1 is taken for rounding

_EXPONENT = (GAMMA - 1.0) / GAMMA  # –, 2/7
_ENTHALPY = 2.0 * GAS_CONSTANT_DRY_AIR / _EXPONENT  # J/(kg·K), 2·c_p: V² = 2·c_p·T·[(p_t/p_s)^(2/7) − 1]
_BERNOULLI = 2.0 * MOLAR_GAS_CONSTANT / MOLAR_MASS_DRY_AIR  # J/(kg·K): V² = 2·R/M_a·T·(p_t − p_s)/p_s
_VAPOUR_DEFICIT = 1.0 - MOLAR_MASS_WATER / MOLAR_MASS_DRY_AIR  # –, 1 − M_v/M_a
_LIMIT_RATIO = (1.0 + 0.5 * (GAMMA - 1.0) * (1.0 + MACH_ROUNDING) ** 2) ** (1.0 / _EXPONENT)  # –, p_t/p_s at Mach 1

# Z of moist air: CIPM-2007, appendix A1.4; K/Pa, (K/Pa)² for the last row, with powers of 1/°C.
_A0, _A1, _A2 = 1.58123e-6, -2.9331e-8, 1.1043e-10
_B0, _B1 = 5.707e-6, -2.051e-8
_C0, _C1 = 1.9898e-4, -2.376e-6
_D, _E = 1.83e-11, -0.765e-8


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
    _, (p, t, xv) = _numbers(pressure, temperature, vapour_fraction)
    _require_pressure(p)
    _require_temperature(t)
    _require_fraction(xv)
    z = _compressibility(p, t, xv) if compressibility is None else compressibility
    density: Numbers = p * MOLAR_MASS_DRY_AIR / (z * MOLAR_GAS_CONSTANT * t) * (1.0 - xv * _VAPOUR_DEFICIT)
    return density


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
    xp, (ps, m) = _numbers(static, mach)
    _require_pressure(ps)
    if _any(m < -MACH_ROUNDING) or _any(m > 1.0 + MACH_ROUNDING):
        raise ValueError("Mach number must be from 0 to 1")
    total: Numbers = isentropic_total(ps, m, xp)
    return total


def mach(*, total: Numbers, static: Numbers | float) -> Numbers:
    """Mach number from total and static pressure, the inverse of `total_pressure`.

    Parameters
    ----------
    total, static : float or array
        Pressures, Pa. A total pressure below the static one gives 0.

    Returns
    -------
    float or array
        Mach number.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or a ratio beyond that of Mach 1 (+ 1e-6): there a shock stands before the tube and the
        isentropic relation does not hold.

    Examples
    --------
    >>> round(mach(total=118_621.264, static=100_000.0), 6)
    0.5
    """
    xp, (pt, ps) = _numbers(total, static)
    _require_pressure(pt)
    _require_pressure(ps)
    if _any(pt > _LIMIT_RATIO * ps):
        raise ValueError("the ratio of the pressures is that of a Mach number above 1")
    number: Numbers = xp.sqrt(2.0 / (GAMMA - 1.0) * xp.expm1(_EXPONENT * xp.log1p(_clip(pt - ps) / ps)))
    return number


def airspeed(
    *,
    total: Numbers,
    static: Numbers | float,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    calibration: float = 1.0,
    model: Model = "compressible",
    negative: Negative = "clip",
) -> Numbers:
    """Find true airspeed from total pressure, static pressure and temperature.

    Parameters
    ----------
    total, static : float or array
        Pressures, Pa.
    temperature : float or array
        Temperature of the air (not the recovery temperature of a probe), K.
    vapour_fraction : float or array
        Mole fraction of water vapour, which makes the air lighter.
    calibration : float
        K, which multiplies the airspeed.
    model : {"compressible", "bernoulli"}
        Isentropic flow, or the incompressible relation of the published method with Z = 1. Neither is refused above
        Mach 1, so that a spike of a sensor stays a number.
    negative : {"clip", "signed", "nan"}
        What a total pressure below the static one gives: 0, minus the airspeed of the opposite difference, or NaN.

    Returns
    -------
    float or array
        True airspeed, m/s.

    Raises
    ------
    ValueError
        Pressure ≤ 0, temperature outside 150–400 K, vapour fraction outside 0–1, or an unknown model or rule.

    Examples
    --------
    >>> round(airspeed(total=101_325.0 + 552.3219, static=101_325.0, temperature=288.15), 4)
    30.0
    """
    xp, (pt, ps, t, xv) = _numbers(total, static, temperature, vapour_fraction)
    _require_pressure(pt)
    _require_pressure(ps)
    _require_temperature(t)
    _require_fraction(xv)
    if model not in _SPEEDS:
        raise ValueError(f"model must be one of {', '.join(_SPEEDS)}, not {model!r}")
    if negative not in _NEGATIVE:
        raise ValueError(f"negative must be one of {', '.join(_NEGATIVE)}, not {negative!r}")
    difference = pt - ps
    size, sign = _NEGATIVE[negative](difference, xp)
    dry = _SPEEDS[model](size, ps, t, xp)
    speed: Numbers = calibration * sign * dry / xp.sqrt(1.0 - xv * _VAPOUR_DEFICIT)
    return speed


def speed_of_sound(temperature: Numbers) -> Numbers:
    """Speed of sound in dry air, a = √(γ·R_a·T).

    Parameters
    ----------
    temperature : float or array
        Temperature of the air, K.

    Returns
    -------
    float or array
        Speed of sound, m/s.

    Raises
    ------
    ValueError
        Temperature outside 150–400 K.

    Examples
    --------
    >>> round(speed_of_sound(288.15), 3)
    340.294
    """
    xp, (t,) = _numbers(temperature)
    _require_temperature(t)
    speed: Numbers = xp.sqrt(GAMMA * GAS_CONSTANT_DRY_AIR * t)
    return speed


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
    xp, (ps, reference_pressure, t) = _numbers(static, reference, temperature)
    _require_pressure(ps)
    _require_pressure(reference_pressure)
    _require_temperature(t)
    height: Numbers = hypsometric_height(ps, reference_pressure, t, xp)
    return height


# The equations themselves, for floats and arrays alike (`xp` is math or numpy), without checks. The loop calls those
# of total and static pressure directly: a keyword call with its checks costs a microsecond, they a quarter.


# log1p and expm1 instead of powers keep the digits of p_t − p_s at low speed.


def isentropic_total(static: Any, mach: Any, xp: Any = math) -> Any:
    """Total pressure, Pa, without checks."""
    return static + static * xp.expm1(xp.log1p(0.5 * (GAMMA - 1.0) * mach * mach) / _EXPONENT)


def _compressible_speed(difference: Any, static: Any, temperature: Any, xp: Any = math) -> Any:
    return xp.sqrt(_ENTHALPY * temperature * xp.expm1(_EXPONENT * xp.log1p(difference / static)))


def _bernoulli_speed(difference: Any, static: Any, temperature: Any, xp: Any = math) -> Any:
    return xp.sqrt(_BERNOULLI * temperature * difference / static)


def hypsometric_height(static: Any, reference: Any, temperature: Any, xp: Any = math) -> Any:
    """Height above the place of the reference pressure in air of one temperature, m; Pa and K, without checks."""
    return GAS_CONSTANT_DRY_AIR / STANDARD_GRAVITY * temperature * xp.log(reference / static)


def compressible_airspeed(total: float, static: float, temperature: float) -> float:
    """Airspeed of dry air, floats only, clipped at 0; NaN in any argument gives NaN."""
    speed: float = _compressible_speed(0.0 if total < static else total - static, static, temperature)
    return speed


def bernoulli_airspeed(total: float, static: float, temperature: float) -> float:
    """Airspeed of dry air by the incompressible relation, floats only, clipped at 0; NaN gives NaN."""
    speed: float = _bernoulli_speed(0.0 if total < static else total - static, static, temperature)
    return speed


def _compressibility(p: Any, t: Any, xv: Any) -> Any:
    c = t - ZERO_CELSIUS
    virial = _A0 + (_A1 + _A2 * c) * c + (_B0 + _B1 * c) * xv + (_C0 + _C1 * c) * xv * xv
    return 1.0 - p / t * virial + (p / t) ** 2 * (_D + _E * xv * xv)


_SPEEDS = {"compressible": _compressible_speed, "bernoulli": _bernoulli_speed}


def _clip(value: Any) -> Any:
    if isinstance(value, float):
        return 0.0 if value < 0.0 else value
    return np.maximum(value, 0.0)


def _nan_below_zero(value: Any) -> Any:
    if isinstance(value, float):
        return math.nan if value < 0.0 else value
    return np.where(value < 0.0, math.nan, value)


# What is done with p_t − p_s: its size, which goes under the root, and the sign that the airspeed gets.
_NEGATIVE: dict[str, Callable[[Any, Any], tuple[Any, Any]]] = {
    "clip": lambda difference, xp: (_clip(difference), 1.0),
    "nan": lambda difference, xp: (_nan_below_zero(difference), 1.0),
    "signed": lambda difference, xp: (abs(difference), xp.copysign(1.0, difference)),
}


def _numbers(*values: Any) -> tuple[Any, list[Any]]:
    """Return `math` and floats if all values are plain numbers, else `numpy` and float64 arrays."""
    for value in values:
        if not isinstance(value, (float, int)):
            return np, [np.asarray(each, dtype=np.float64) for each in values]
    return math, [float(value) for value in values]


def _any(condition: Any) -> bool:
    return condition if isinstance(condition, bool) else bool(np.any(condition))


# Comparisons with NaN are false, so NaN passes every check below.


def _require_pressure(pressure: Any) -> None:
    if _any(pressure <= 0.0):
        raise ValueError("pressure must be above 0 Pa")


def _require_temperature(temperature: Any) -> None:
    if _any(temperature < MIN_TEMPERATURE) or _any(temperature > MAX_TEMPERATURE):
        raise ValueError(f"temperature must be from {MIN_TEMPERATURE:g} to {MAX_TEMPERATURE:g} K")


def _require_fraction(vapour_fraction: Any) -> None:
    if _any(vapour_fraction < 0.0) or _any(vapour_fraction > 1.0):
        raise ValueError("vapour fraction must be from 0 to 1")
