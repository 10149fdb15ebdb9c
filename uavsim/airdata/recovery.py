"""Temperature of air that the flow past a thermometer has warmed.

    T = T_s·(1 + r·(γ−1)/2·M²)          T_s = T/(1 + 0.2·r·M²)

T_s is the temperature of the undisturbed air, T that of the thermometer, r its recovery factor: 1 reads the total
temperature, 0 the static one; a laminar boundary layer has √Pr = 0.85, a turbulent one ∛Pr = 0.89, a probe as measured.
Taken for T_s, the warmed temperature makes the airspeed read √(1 + 0.2·r·M²) high: 3.2 % at Mach 0.6 and r = 0.9.
"""

from typing import Any

from uavsim.airdata.constants import HALF_EXCESS
from uavsim.airdata.values import Numbers, numbers, require_fraction, require_mach, require_temperature


def static_temperature(*, recovery: Numbers, mach: Numbers | float, factor: Numbers | float = 1.0) -> Numbers:
    """Temperature of the undisturbed air, T_s = T/(1 + 0.2·r·M²).

    Parameters
    ----------
    recovery : float or array
        What the thermometer reads, K.
    mach : float or array
        Mach number, 0 to 1.
    factor : float or array
        Recovery factor r, 0 to 1.

    Returns
    -------
    float or array
        K.

    Raises
    ------
    ValueError
        Temperature outside 150–400 K, Mach number or factor outside 0–1.

    Examples
    --------
    >>> round(static_temperature(recovery=319.0, mach=0.7, factor=0.62), 2)
    300.73
    """
    _, (t, m, r) = numbers(recovery, mach, factor)
    _require(t, m, r)
    temperature: Numbers = t / _warming(m, r)
    return temperature


def recovery_temperature(*, static: Numbers, mach: Numbers | float, factor: Numbers | float = 1.0) -> Numbers:
    """Temperature that a thermometer of this recovery factor reads; with factor 1 the total temperature.

    Parameters
    ----------
    static : float or array
        Temperature of the undisturbed air, K.
    mach, factor : float or array
        Mach number and recovery factor, 0 to 1.

    Returns
    -------
    float or array
        K.

    Raises
    ------
    ValueError
        As `static_temperature`.

    Examples
    --------
    >>> round(recovery_temperature(static=300.0, mach=0.6), 1)
    321.6
    """
    _, (t, m, r) = numbers(static, mach, factor)
    _require(t, m, r)
    temperature: Numbers = t * _warming(m, r)
    return temperature


def static_temperature_gradient(
    *, recovery: Numbers, mach: Numbers | float, factor: Numbers | float = 1.0
) -> tuple[Numbers, Numbers, Numbers]:
    """Derivatives of `static_temperature`.

    Parameters
    ----------
    recovery, mach, factor : float or array
        As for `static_temperature`.

    Returns
    -------
    tuple of three floats or arrays
        ∂T_s/∂T; ∂T_s/∂M, K; ∂T_s/∂r, K.

    Raises
    ------
    ValueError
        As `static_temperature`.
    """
    _, (t, m, r) = numbers(recovery, mach, factor)
    _require(t, m, r)
    warming = _warming(m, r)
    scale = -t / (warming * warming) * HALF_EXCESS
    # what does not depend on T still has the shape of all three, and its NaN
    return 1.0 / warming + 0.0 * t, scale * 2.0 * r * m, scale * m * m


def _warming(mach: Any, factor: Any) -> Any:
    return 1.0 + HALF_EXCESS * factor * mach * mach


def _require(temperature: Any, mach: Any, factor: Any) -> None:
    require_temperature(temperature)
    require_mach(mach)
    require_fraction(factor, "recovery factor")
