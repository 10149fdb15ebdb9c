"""True airspeed from pressures and temperature, the way back, and its derivatives.

    model "compressible"    V = K·√(Z·2γ/(γ−1)·R_m·T·[(p_t/p_s)^((γ−1)/γ) − 1])
    model "bernoulli"       V = K·√(2·(p_t − p_s)/ρ),    ρ by CIPM-2007

with the gas constant of moist air R_m = R_a/[1 − x_v·(1 − M_v/M_a)]. Bernoulli's is the limit of the first at small M
and, with Z = 1, the relation (2)–(4) of the published method that this project tests; it reads 0.2 % high at Mach 0.12
and 4.6 % at 0.6. Z is 1 unless asked for: computed, it is worth −0.02 % of V in the open air (exact at small M, where
V² = 2·q_c/ρ; the γ of moist and of real air is not followed).

Derivatives, with ρ_t = ρ·(p_t/p_s)^(1/γ) the density at the stagnation point (ρ itself for Bernoulli):

    ∂V/∂p_t = K²/(ρ_t·V)        ∂V/∂p_s = −(p_t/p_s)·∂V/∂p_t        ∂V/∂T = V/(2T)
    ∂²V/∂p_t² = −(∂V/∂p_t)²/V − ∂V/∂p_t/(γ·p_t)        the last term for compressible flow only

They have no meaning at V = 0: NaN there, and a filter works in pressure below V* = √(2σ/ρ).
"""

import math
from collections.abc import Callable
from typing import Any, Literal

from uavsim.airdata.constants import (
    EXPONENT,
    GAMMA,
    GAS_CONSTANT_DRY_AIR,
    MOLAR_GAS_CONSTANT,
    MOLAR_MASS_DRY_AIR,
    VAPOUR_DEFICIT,
)
from uavsim.airdata.moist import virial_compressibility
from uavsim.airdata.pressures import isentropic_mach
from uavsim.airdata.values import (
    Numbers,
    clip,
    nan_below_zero,
    nan_up_to_zero,
    numbers,
    require_fraction,
    require_pressure,
    require_speed,
    require_temperature,
)

Model = Literal["compressible", "bernoulli"]
Negative = Literal["clip", "signed", "nan"]
MachCalibration = Callable[[Any], Any]
"""K(M): Mach number as read -> factor on the airspeed, floats and arrays."""

_ENTHALPY = 2.0 * GAS_CONSTANT_DRY_AIR / EXPONENT  # J/(kg·K), 2·c_p: V² = 2·c_p·T·[(p_t/p_s)^(2/7) − 1]
_BERNOULLI = 2.0 * MOLAR_GAS_CONSTANT / MOLAR_MASS_DRY_AIR  # J/(kg·K): V² = 2·R/M_a·T·(p_t − p_s)/p_s


def airspeed(
    *,
    total: Numbers,
    static: Numbers | float,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    calibration: float | MachCalibration = 1.0,
    model: Model = "compressible",
    negative: Negative = "clip",
    compressibility: float | None = 1.0,
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
    calibration : float or function
        K, which multiplies the airspeed, or K(M) of the Mach number that the pressures give
        (`Polynomial` and `Table` of `uavsim.airdata` are such functions).
    model : {"compressible", "bernoulli"}
        Isentropic flow, or the incompressible relation of the published method. Neither is refused above
        Mach 1, so that a spike of a sensor stays a number.
    negative : {"clip", "signed", "nan"}
        What a total pressure below the static one gives: 0, minus the airspeed of the opposite difference, or NaN.
    compressibility : float, optional
        Z of the density, 1 as in the published method; None computes it by CIPM-2007.

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
    xp, (pt, ps, t, xv) = numbers(total, static, temperature, vapour_fraction)
    _require(pt, ps, t, xv, model)
    if negative not in _NEGATIVE:
        raise ValueError(f"negative must be one of {', '.join(_NEGATIVE)}, not {negative!r}")
    size, sign = _NEGATIVE[negative](pt - ps, xp)
    dry = _SPEEDS[model](size, ps, t, xp)
    factor = calibration(isentropic_mach(size / ps, xp)) if callable(calibration) else calibration
    speed: Numbers = factor * sign * dry * _lightness(ps, t, xv, compressibility, xp)
    return speed


def total_at_airspeed(
    *,
    airspeed: Numbers,
    static: Numbers | float,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    calibration: float = 1.0,
    model: Model = "compressible",
    compressibility: float | None = 1.0,
) -> Numbers:
    """Find the total pressure at which `airspeed` gives this true airspeed.

    Parameters
    ----------
    airspeed : float or array
        True airspeed, m/s, not negative.
    static, temperature, vapour_fraction, calibration, model, compressibility
        As for `airspeed`; the calibration a number.

    Returns
    -------
    float or array
        Total pressure, Pa.

    Raises
    ------
    ValueError
        As `airspeed`, or an airspeed below 0.

    Examples
    --------
    >>> round(total_at_airspeed(airspeed=30.0, static=101_325.0, temperature=288.15) - 101_325.0, 4)
    552.3219
    """
    xp, (v, ps, t, xv) = numbers(airspeed, static, temperature, vapour_fraction)
    _require(ps, ps, t, xv, model)
    require_speed(v)
    dry = v / (calibration * _lightness(ps, t, xv, compressibility, xp))
    total: Numbers = ps + _DIFFERENCES[model](dry, ps, t, xp)
    return total


def airspeed_gradient(
    *,
    total: Numbers,
    static: Numbers | float,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    calibration: float = 1.0,
    model: Model = "compressible",
) -> tuple[Numbers, Numbers, Numbers]:
    """Derivatives of `airspeed` with Z = 1.

    Parameters
    ----------
    total, static, temperature, vapour_fraction, calibration, model
        As for `airspeed`; the calibration a number.

    Returns
    -------
    tuple of three floats or arrays
        ∂V/∂p_t and ∂V/∂p_s, m/(s·Pa); ∂V/∂T, m/(s·K). NaN where p_t ≤ p_s.

    Raises
    ------
    ValueError
        As `airspeed`.

    Examples
    --------
    >>> [round(d, 5) for d in airspeed_gradient(total=101_877.3219, static=101_325.0, temperature=288.15)]
    [0.02711, -0.02725, 0.05206]
    """
    xp, (pt, ps, t, xv) = numbers(total, static, temperature, vapour_fraction)
    _require(pt, ps, t, xv, model)
    light = calibration * _lightness(ps, t, xv, 1.0, xp)
    speed = light * _SPEEDS[model](nan_up_to_zero(pt - ps, xp), ps, t, xp)
    by_total = light * light * _SLOPES[model](pt, ps, t, xp) / (2.0 * speed)
    return by_total, -by_total * pt / ps, speed / (2.0 * t)


def airspeed_curvature(
    *,
    total: Numbers,
    static: Numbers | float,
    temperature: Numbers | float,
    vapour_fraction: Numbers | float = 0.0,
    calibration: float = 1.0,
    model: Model = "compressible",
) -> Numbers:
    """Second derivative of `airspeed` by the total pressure: what makes the root of a noisy pressure read low.

    To second order, E[V] = V(E[p_t]) + ½·σ²·∂²V/∂p_t².

    Parameters
    ----------
    total, static, temperature, vapour_fraction, calibration, model
        As for `airspeed`; the calibration a number.

    Returns
    -------
    float or array
        ∂²V/∂p_t², m/(s·Pa²). NaN where p_t ≤ p_s.

    Raises
    ------
    ValueError
        As `airspeed`.
    """
    xp, (pt, ps, t, xv) = numbers(total, static, temperature, vapour_fraction)
    _require(pt, ps, t, xv, model)
    light = calibration * _lightness(ps, t, xv, 1.0, xp)
    speed = light * _SPEEDS[model](nan_up_to_zero(pt - ps, xp), ps, t, xp)
    square = light * light * _SLOPES[model](pt, ps, t, xp)  # ∂V²/∂p_t
    bend = (EXPONENT - 1.0) / pt * square if model == "compressible" else 0.0  # ∂²V²/∂p_t²
    curvature: Numbers = (bend - 0.5 * square * square / (speed * speed)) / (2.0 * speed)
    return curvature


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
    xp, (t,) = numbers(temperature)
    require_temperature(t)
    speed: Numbers = sound(t, xp)
    return speed


# The equations themselves, without checks.


def compressible_airspeed(total: float, static: float, temperature: float) -> float:
    """Airspeed of dry air, floats only, clipped at 0; NaN in any argument gives NaN."""
    speed: float = _compressible_speed(0.0 if total < static else total - static, static, temperature)
    return speed


def bernoulli_airspeed(total: float, static: float, temperature: float) -> float:
    """Airspeed of dry air by the incompressible relation, floats only, clipped at 0; NaN gives NaN."""
    speed: float = _bernoulli_speed(0.0 if total < static else total - static, static, temperature)
    return speed


def sound(temperature: Any, xp: Any = math) -> Any:
    """Speed of sound in dry air, m/s, without checks."""
    return xp.sqrt(GAMMA * GAS_CONSTANT_DRY_AIR * temperature)


def _compressible_speed(difference: Any, static: Any, temperature: Any, xp: Any = math) -> Any:
    return xp.sqrt(_ENTHALPY * temperature * xp.expm1(EXPONENT * xp.log1p(difference / static)))


def _bernoulli_speed(difference: Any, static: Any, temperature: Any, xp: Any = math) -> Any:
    return xp.sqrt(_BERNOULLI * temperature * difference / static)


def _compressible_difference(speed: Any, static: Any, temperature: Any, xp: Any) -> Any:
    return static * xp.expm1(xp.log1p(speed * speed / (_ENTHALPY * temperature)) / EXPONENT)


def _bernoulli_difference(speed: Any, static: Any, temperature: Any, _xp: Any) -> Any:
    return static * speed * speed / (_BERNOULLI * temperature)


def _compressible_slope(total: Any, static: Any, temperature: Any, xp: Any) -> Any:
    return _ENTHALPY * temperature * EXPONENT * xp.exp(EXPONENT * xp.log(total / static)) / total


def _bernoulli_slope(_total: Any, static: Any, temperature: Any, _xp: Any) -> Any:
    return _BERNOULLI * temperature / static


def _lightness(static: Any, temperature: Any, xv: Any, compressibility: float | None, xp: Any) -> Any:
    """Return V over that of dry perfect air."""
    z = virial_compressibility(static, temperature, xv) if compressibility is None else compressibility
    return xp.sqrt(z / (1.0 - xv * VAPOUR_DEFICIT))


_SPEEDS = {"compressible": _compressible_speed, "bernoulli": _bernoulli_speed}
_DIFFERENCES = {"compressible": _compressible_difference, "bernoulli": _bernoulli_difference}
_SLOPES = {"compressible": _compressible_slope, "bernoulli": _bernoulli_slope}  # of V² by p_t

# What is done with p_t − p_s: its size, which goes under the root, and the sign that the airspeed gets.
_NEGATIVE: dict[str, Callable[[Any, Any], tuple[Any, Any]]] = {
    "clip": lambda difference, xp: (clip(difference), 1.0),
    "nan": lambda difference, xp: (nan_below_zero(difference), 1.0),
    "signed": lambda difference, xp: (abs(difference), xp.copysign(1.0, difference)),
}


def _require(pt: Any, ps: Any, t: Any, xv: Any, model: str) -> None:
    require_pressure(pt, ps)
    require_temperature(t)
    require_fraction(xv)
    if model not in _SPEEDS:
        raise ValueError(f"model must be one of {', '.join(_SPEEDS)}, not {model!r}")
