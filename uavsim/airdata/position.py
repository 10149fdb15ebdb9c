"""What ports read of pressures that are not theirs: position error, in shares of the impact pressure q_c = p_t − p_s.

    static port    p_s,read = p_s + q_c·c_s(M, α, β)               c_s = 0: a perfect place
    total port     p_t,read = p_s + q_c·c_t(M, α, β)               c_t = 1: a perfect place

A pressure coefficient of aerodynamics is a share of the dynamic pressure q = γ/2·p_s·M² instead,
Cp = (p − p_s)/q = c·q_c/q, with q_c/q = 1 + M²/4 + …: 1.064 at Mach 0.5.

Correcting solves q_c = (p_t,read − p_s,read)/(c_t − c_s) for the Mach number that c_t and c_s depend on, by repeated
insertion: where it does not settle to 1e-12 of a Mach number in 60 steps, the result is NaN.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from uavsim.airdata.constants import GAMMA
from uavsim.airdata.pressures import dynamic_pressure, impact_share, isentropic_mach, mach, mach_gradient
from uavsim.airdata.surfaces import Polynomial, Table
from uavsim.airdata.values import (
    Numbers,
    anywhere,
    clip,
    nan_up_to_zero,
    numbers,
    require_mach,
    require_pressure,
)

_STEPS = 60
_SETTLED = 1e-12  # of a Mach number


@dataclass(frozen=True, slots=True)
class PositionError:
    """The two ports' coefficients as functions of Mach number and flow angles.

    Attributes
    ----------
    static, total : Polynomial or Table
        c_s and c_t, shares of q_c.

    Examples
    --------
    >>> head = PositionError(static=Polynomial(((-0.05, 0, 0, 0),)))
    >>> head.read(total=101_900.0, static=101_325.0)
    (101900.0, 101296.25)
    >>> [round(p, 6) for p in head.correct(total=101_900.0, static=101_296.25)]
    [101900.0, 101325.0]
    """

    static: Polynomial | Table = field(default=Polynomial(()))
    total: Polynomial | Table = field(default=Polynomial(((1.0, 0, 0, 0),)))

    def read(
        self, *, total: Numbers, static: Numbers | float, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0
    ) -> tuple[Numbers, Numbers]:
        """Find what the ports read of the true pressures.

        Parameters
        ----------
        total, static : float or array
            True pressures, Pa.
        alpha, beta : float or array
            Angle of attack and sideslip, rad.

        Returns
        -------
        tuple of two floats or arrays
            Total and static pressure as read, Pa.

        Raises
        ------
        ValueError
            Pressure ≤ 0, or pressures of a Mach number above 1.
        """
        _, (pt, ps, a, b) = numbers(total, static, alpha, beta)
        m = mach(total=pt, static=ps)
        impact = pt - ps
        read_total = ps + impact * self.total(m, a, b)
        read_static = ps + impact * self.static(m, a, b)
        return read_total, read_static

    def correct(
        self, *, total: Numbers, static: Numbers | float, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0
    ) -> tuple[Numbers, Numbers]:
        """Find the true pressures of what the ports read, the inverse of `read`.

        Parameters
        ----------
        total, static : float or array
            Pressures as read, Pa.
        alpha, beta : float or array
            Angle of attack and sideslip, rad; 0 where they are not known.

        Returns
        -------
        tuple of two floats or arrays
            True total and static pressure, Pa.

        Raises
        ------
        ValueError
            Pressure ≤ 0.
        """
        xp, (pt, ps, a, b) = numbers(total, static, alpha, beta)
        require_pressure(pt, ps)
        m = isentropic_mach(clip(pt - ps) / ps, xp)
        change: Any = 0.0 * m
        true_static, impact = ps, pt - ps
        for _ in range(_STEPS):
            cs, ct = self.static(m, a, b), self.total(m, a, b)
            impact = _over(pt - ps, ct - cs, xp)
            true_static = nan_up_to_zero(ps - impact * cs, xp)
            found = isentropic_mach(clip(impact) / true_static, xp)
            change, m = abs(found - m), found
            if not anywhere(change > _SETTLED):
                break
        unsettled = _nan_where(change > _SETTLED, xp)
        return true_static + impact + unsettled, true_static + unsettled

    def table(self, *, mach: Iterable[float], alpha: Iterable[float], beta: Iterable[float]) -> str:
        """Write what the ports read over a grid as CSV: a calibration's file, for `air_data.calibration`.

        Parameters
        ----------
        mach, alpha, beta : iterable of float
            The grid's axes; angles in rad.

        Returns
        -------
        str
            The columns mach, alpha, beta, total_share, static_share, a line a point, to nine digits.

        Examples
        --------
        >>> head = PositionError(static=Polynomial(((-0.05, 0, 0, 0), (0.2, 0, 1, 0))))
        >>> print(head.table(mach=(0.1,), alpha=(0.0, 0.1), beta=(0.0,)), end="")
        mach,alpha,beta,total_share,static_share
        0.1,0,0,1,-0.05
        0.1,0.1,0,1,-0.03
        """
        points = product(mach, alpha, beta)
        rows = (",".join(f"{value:.9g}" for value in (*at, self.total(*at), self.static(*at))) for at in points)
        return "\n".join(("mach,alpha,beta,total_share,static_share", *rows, ""))

    def gradient(
        self, *, total: Numbers, static: Numbers | float, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0
    ) -> tuple[tuple[Numbers, Numbers], tuple[Numbers, Numbers]]:
        """Derivatives of the corrected pressures by those read, at true pressures: what a filter's H takes.

        Parameters
        ----------
        total, static : float or array
            True pressures (what `correct` returned), Pa; p_t > p_s.
        alpha, beta : float or array
            rad.

        Returns
        -------
        ((∂p_t/∂p_t,read, ∂p_t/∂p_s,read), (∂p_s/∂p_t,read, ∂p_s/∂p_s,read))
            NaN where p_t ≤ p_s.

        Raises
        ------
        ValueError
            As `read`.
        """
        _, (pt, ps, a, b) = numbers(total, static, alpha, beta)
        m = mach(total=pt, static=ps)
        by_total, by_static = mach_gradient(total=pt, static=ps)
        rows = []
        for surface in (self.total, self.static):
            share, slope = surface(m, a, b), (pt - ps) * surface.gradient(m, a, b)[0]
            rows.append((share + slope * by_total, 1.0 - share + slope * by_static))
        (tt, ts), (st, ss) = rows
        whole = tt * ss - ts * st
        return (ss / whole, -ts / whole), (-st / whole, tt / whole)


def pressure_coefficient(*, pressure: Numbers, static: Numbers | float, mach: Numbers | float) -> Numbers:
    """Pressure coefficient Cp = (p − p_s)/q.

    Parameters
    ----------
    pressure, static : float or array
        At the place and of the undisturbed air, Pa.
    mach : float or array
        Of the undisturbed air, above 0 to 1.

    Returns
    -------
    float or array
        Cp; NaN at Mach 0, where there is no q.

    Raises
    ------
    ValueError
        Pressure ≤ 0, or Mach number outside 0–1.

    Examples
    --------
    >>> round(pressure_coefficient(pressure=99_330.0, static=101_325.0, mach=0.3), 3)
    -0.313
    """
    xp, (p, ps, m) = numbers(pressure, static, mach)
    require_pressure(p)
    coefficient: Numbers = _over(p - ps, dynamic_pressure(static=ps, mach=m), xp)
    return coefficient


def impact_over_dynamic(mach: Numbers) -> Numbers:
    """Ratio q_c/q of a Mach number, 0 to 1: what turns shares of the one into shares of the other.

    Raises
    ------
    ValueError
        Mach number outside 0–1.

    Examples
    --------
    >>> round(impact_over_dynamic(0.5), 4)
    1.0641
    """
    xp, (m,) = numbers(mach)
    require_mach(m)
    least = 1e-6  # below, the ratio is 1 to the last digit
    safe = (least if abs(m) < least else m) if xp is math else np.where(np.abs(m) < least, least, m)
    ratio: Numbers = impact_share(safe, xp) / (0.5 * GAMMA * safe * safe)
    return ratio


def _nan_where(condition: Any, xp: Any) -> Any:
    """Return NaN where it holds, else 0."""
    if xp is math:
        return math.nan if condition else 0.0
    return np.where(condition, math.nan, 0.0)


def _over(numerator: Any, denominator: Any, xp: Any) -> Any:
    """Return the quotient, NaN over 0."""
    if xp is math:
        return math.nan if denominator == 0.0 else numerator / denominator
    return numerator / np.where(denominator == 0.0, math.nan, denominator)
