"""A number as a function of Mach number, angle of attack and sideslip: a polynomial or a table, with its slopes.

    polynomial    c = Σ c_ijk·Mⁱ·αʲ·βᵏ
    table         linear between its points along each axis, constant beyond its ends

Angles in radians. Both serve as calibration K(M), as position error of a port, and take floats or arrays. NaN in any
argument gives NaN.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Any

import numpy as np

from uavsim.airdata.values import Numbers, numbers

Term = tuple[float, int, int, int]
"""Coefficient and its powers of Mach number, alpha, beta."""
Surface = Callable[[Any, Any, Any], Any]
"""Mach number, alpha, beta -> value."""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """Sum of terms c·Mⁱ·αʲ·βᵏ.

    Attributes
    ----------
    terms : tuple of (c, i, j, k)
        Coefficient, 1/radⁿ, and its powers, ≥ 0.

    Examples
    --------
    >>> k_of_mach = Polynomial(((0.98, 0, 0, 0), (0.05, 2, 0, 0)))
    >>> round(k_of_mach(0.6), 6)
    0.998
    """

    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        for coefficient, *powers in self.terms:
            if not isfinite(coefficient) or any(power < 0 or power != int(power) for power in powers):
                raise ValueError(
                    f"terms must be (finite coefficient, three powers ≥ 0), not {(coefficient, *powers)!r}"
                )

    def __call__(self, mach: Numbers, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0) -> Numbers:
        """Value at a Mach number and angles, rad."""
        _, (m, a, b) = numbers(mach, alpha, beta)
        value: Any = 0.0 * (m + a + b)  # the shape of all three, and NaN of each
        for coefficient, i, j, k in self.terms:
            value = value + coefficient * m**i * a**j * b**k
        total: Numbers = value
        return total

    def gradient(
        self, mach: Numbers, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0
    ) -> tuple[Numbers, Numbers, Numbers]:
        """Derivatives by Mach number, alpha and beta, 1/rad."""
        slopes = (
            Polynomial(tuple((c * i, i - 1, j, k) for c, i, j, k in self.terms if i)),
            Polynomial(tuple((c * j, i, j - 1, k) for c, i, j, k in self.terms if j)),
            Polynomial(tuple((c * k, i, j, k - 1) for c, i, j, k in self.terms if k)),
        )
        by_mach, by_alpha, by_beta = (slope(mach, alpha, beta) for slope in slopes)
        return by_mach, by_alpha, by_beta

    @classmethod
    def fit(
        cls,
        values: Any,
        powers: Iterable[tuple[int, int, int]],
        *,
        mach: Any = 0.0,
        alpha: Any = 0.0,
        beta: Any = 0.0,
        weights: Any = 1.0,
    ) -> "Polynomial":
        """Fit the coefficients of these powers to values by weighted least squares.

        Parameters
        ----------
        values : array
            What the polynomial shall give.
        powers : iterable of (i, j, k)
            Its terms.
        mach, alpha, beta : float or array
            Where; angles in rad.
        weights : float or array
            Of each value's squared error, ≥ 0.

        Raises
        ------
        ValueError
            Fewer values than terms.
        """
        y, m, a, b, w = np.broadcast_arrays(
            *(np.asarray(each, dtype=float) for each in (values, mach, alpha, beta, weights))
        )
        terms = list(powers)
        if y.size < len(terms):
            raise ValueError(f"{len(terms)} terms need as many values, not {y.size}")
        root = np.sqrt(w.ravel())
        design = np.stack([(m**i * a**j * b**k).ravel() * root for i, j, k in terms], axis=1)
        found = np.linalg.lstsq(design, y.ravel() * root, rcond=None)[0]
        return cls(tuple((float(c), i, j, k) for c, (i, j, k) in zip(found, terms, strict=True)))


@dataclass(frozen=True, slots=True)
class Table:
    """Values at the points of a grid, linear between them, constant beyond its ends.

    Attributes
    ----------
    mach, alpha, beta : tuple of float
        The grid, increasing; angles in rad. An axis of one point is one that the values do not depend on.
    values : nested tuples
        values[i][j][k] at mach[i], alpha[j], beta[k].

    Examples
    --------
    >>> static = Table.of_mach((0.3, 0.5), (-0.313, -0.222))
    >>> round(static(0.4), 4)
    -0.2675
    """

    mach: tuple[float, ...]
    alpha: tuple[float, ...]
    beta: tuple[float, ...]
    values: tuple[tuple[tuple[float, ...], ...], ...]

    def __post_init__(self) -> None:
        for name, axis in (("mach", self.mach), ("alpha", self.alpha), ("beta", self.beta)):
            if not axis or any(not low < high for low, high in pairwise(axis)):
                raise ValueError(f"{name} must increase from point to point, and have one at least")
        shape = (len(self.mach), len(self.alpha), len(self.beta))
        held = np.asarray(self.values, dtype=float) if _regular(self.values) else np.empty(0)
        if held.shape != shape or not np.isfinite(held).all():
            raise ValueError(f"values must be finite numbers in the shape of the axes, {shape}")

    @classmethod
    def of_mach(cls, mach: Sequence[float], values: Sequence[float]) -> "Table":
        """Table of the Mach number alone."""
        return cls(tuple(mach), (0.0,), (0.0,), tuple(((float(v),),) for v in values))

    def __call__(self, mach: Numbers, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0) -> Numbers:
        """Value at a Mach number and angles, rad."""
        xp, point = numbers(mach, alpha, beta)
        value: Numbers = self._value(self._cells(xp, point), xp)
        return value

    def gradient(
        self, mach: Numbers, alpha: Numbers | float = 0.0, beta: Numbers | float = 0.0
    ) -> tuple[Numbers, Numbers, Numbers]:
        """Derivatives by Mach number, alpha, beta: at a point of the grid those above it, 0 beyond its ends."""
        xp, point = numbers(mach, alpha, beta)
        cells = self._cells(xp, point)
        slopes = []
        for axis in range(3):
            low, high, weight, inverse = cells[axis]
            ends = [list(cells), list(cells)]
            ends[0][axis], ends[1][axis] = (low, low, 0.0 * weight, inverse), (high, high, 0.0 * weight, inverse)
            slopes.append((self._value(ends[1], xp) - self._value(ends[0], xp)) * inverse)
        return slopes[0], slopes[1], slopes[2]

    def _cells(self, xp: Any, point: list[Any]) -> list[Any]:
        find = _cell if xp is not np else _cells
        return [find(axis, x) for axis, x in zip((self.mach, self.alpha, self.beta), point, strict=True)]

    def _value(self, cells: Sequence[Any], xp: Any) -> Any:
        held: Any = np.asarray(self.values) if xp is np else self.values
        total: Any = 0.0
        for corner in range(8):
            indices, share = [], 1.0
            for axis, (low, high, weight, _) in enumerate(cells):
                upper = corner >> axis & 1
                indices.append(high if upper else low)
                share = share * (weight if upper else 1.0 - weight)
            i, j, k = indices
            total = total + share * (held[i, j, k] if xp is np else held[i][j][k])
        return total


def _cell(axis: Sequence[float], x: float) -> tuple[int, int, float, float]:
    """Return the points below and above, the weight of the one above, and 1/distance, 0 beyond the ends."""
    last = len(axis) - 1
    if last == 0:
        return 0, 0, 0.0 * x, 0.0 * x
    if x < axis[0]:
        return 0, 0, 0.0, 0.0
    if x >= axis[-1]:
        return last, last, 0.0, 0.0
    low = min(bisect_right(axis, x) - 1, last - 1)  # of NaN the last cell, with a weight of NaN
    inverse = 1.0 / (axis[low + 1] - axis[low])
    return low, low + 1, (x - axis[low]) * inverse, inverse + 0.0 * x


def _cells(axis: Sequence[float], x: Any) -> tuple[Any, Any, Any, Any]:
    """Return the same of arrays."""
    grid, last = np.asarray(axis), len(axis) - 1
    low = np.clip(np.searchsorted(grid, x, side="right") - 1, 0, max(last - 1, 0))
    high = np.minimum(low + 1, last)
    inside = ~((x < grid[0]) | (x >= grid[-1])) if last else np.isnan(x)
    width = np.where(high > low, grid[high] - grid[low], 1.0)
    inverse = np.where(inside, 1.0 / width, 0.0) + np.where(np.isnan(x), x, 0.0)
    weight = np.where(inside, (x - grid[low]) / width, np.where(x >= grid[-1], 1.0, 0.0))
    if last == 0:
        weight = np.where(np.isnan(x), x, 0.0)
    return low, high, weight, inverse


def _regular(values: Any) -> bool:
    """Tell whether nested sequences make a box."""
    try:
        np.asarray(values, dtype=float)
    except (ValueError, TypeError):
        return False
    return True
