"""One set of equations for floats and arrays: which library evaluates them, and what is refused.

Plain numbers go through `math`, anything else becomes float64 arrays and goes through NumPy. Comparisons with NaN are
false, so NaN passes every check here and comes out as NaN.
"""

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from uavsim.airdata.constants import LIMIT_RATIO, MACH_ROUNDING, MAX_TEMPERATURE, MIN_TEMPERATURE

Numbers = TypeVar("Numbers", float, NDArray[np.float64])


def numbers(*values: Any) -> tuple[Any, list[Any]]:
    """Return `math` and floats if all values are plain numbers, else `numpy` and float64 arrays."""
    for value in values:
        if not isinstance(value, (float, int)):
            return np, [np.asarray(each, dtype=np.float64) for each in values]
    return math, [float(value) for value in values]


def clip(value: Any) -> Any:
    """Return what is above 0, and 0 for the rest."""
    if isinstance(value, float):
        return 0.0 if value < 0.0 else value
    return np.maximum(value, 0.0)


def nan_below_zero(value: Any) -> Any:
    """Return what is not below 0, and NaN for the rest."""
    if isinstance(value, float):
        return math.nan if value < 0.0 else value
    return np.where(value < 0.0, math.nan, value)


def nan_up_to_zero(value: Any, xp: Any) -> Any:
    """Return what is above 0, and NaN for the rest: a root has no slope at 0, and no air has that pressure."""
    if xp is math:
        return value if value > 0.0 else math.nan
    return np.where(value > 0.0, value, math.nan)


def anywhere(condition: Any) -> bool:
    """Tell whether a comparison holds anywhere."""
    return condition if isinstance(condition, bool) else bool(np.any(condition))


def require_pressure(*pressures: Any) -> None:
    """Refuse pressures that no air has.

    Raises
    ------
    ValueError
        Pressure ≤ 0.
    """
    for pressure in pressures:
        if anywhere(pressure <= 0.0):
            raise ValueError("pressure must be above 0 Pa")


def require_temperature(temperature: Any) -> None:
    """Refuse temperatures that no air flown in has, degrees Celsius given by mistake among them.

    Raises
    ------
    ValueError
        Temperature outside 150–400 K.
    """
    if anywhere(temperature < MIN_TEMPERATURE) or anywhere(temperature > MAX_TEMPERATURE):
        raise ValueError(f"temperature must be from {MIN_TEMPERATURE:g} to {MAX_TEMPERATURE:g} K")


def require_fraction(fraction: Any, what: str = "vapour fraction") -> None:
    """Refuse a share outside 0 to 1.

    Raises
    ------
    ValueError
        Outside 0–1.
    """
    if anywhere(fraction < 0.0) or anywhere(fraction > 1.0):
        raise ValueError(f"{what} must be from 0 to 1")


def require_mach(mach: Any) -> None:
    """Refuse a Mach number outside 0 to 1; 1e-6 beyond either end is taken for rounding.

    Raises
    ------
    ValueError
        Outside 0–1.
    """
    if anywhere(mach < -MACH_ROUNDING) or anywhere(mach > 1.0 + MACH_ROUNDING):
        raise ValueError("Mach number must be from 0 to 1")


def require_subsonic(total: Any, static: Any) -> None:
    """Refuse pressures that no air has, or of a Mach number above 1 (+ 1e-6).

    Raises
    ------
    ValueError
        Pressure ≤ 0. Above Mach 1 a shock stands before the tube and the isentropic relation does not hold.
    """
    require_pressure(total, static)
    if anywhere(total > LIMIT_RATIO * static):
        raise ValueError("the ratio of the pressures is that of a Mach number above 1")


def nan_beyond_mach_1(total: Any, static: Any, xp: Any) -> Any:
    """Return the total pressure, in an array NaN where it is that of a Mach number above 1; a float is refused there.

    Raises
    ------
    ValueError
        As `require_subsonic`; of an array for a pressure ≤ 0 alone.
    """
    if xp is math:
        require_subsonic(total, static)
        return total
    require_pressure(total, static)
    return np.where(total > LIMIT_RATIO * static, np.nan, total)


def require_speed(speed: Any) -> None:
    """Refuse a negative speed.

    Raises
    ------
    ValueError
        Below 0.
    """
    if anywhere(speed < 0.0):
        raise ValueError("airspeed must not be below 0 m/s")
