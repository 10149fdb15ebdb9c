"""The law of both ports' errors (`sensors.probe`) by a table of what they read, as ``uavsim survey`` writes it.

With shares of the impact pressure q_c, at Mach number M and angles α, β in rad, least squares over the rows of

    static_share    c₀ + c_α z + c_αα z² + c_ββ y² + c_M M²          z = sin α cos β,  y = sin β
    total_share     1 − k (θ − 10°)² beyond 10°                      k = 0.01/(θ_1 − 10°)²

The law is linear in the c and in k. Of a table at one Mach number c_M is 0: what it makes there is in c₀. A table that
ends before 20° of flow does not tell θ_1.
"""

import csv
from dataclasses import dataclass
from math import degrees, hypot, inf, pi, radians, sqrt

from sensors.choice import shown

COLUMNS = ("mach", "alpha", "beta", "total_share", "static_share")
MOST_ROWS = 20_000  # 40 Mach numbers, 25 angles of attack and 20 sideslips
FREE = radians(10.0)  # up to which a total port loses nothing, as in `sensors.probe`
LEAST_WIDTH = 1e-3  # rad, of an axis whose coefficients can be told from c₀: 0.06°
LEAST_MACH2 = 1e-4  # of M², the same: Mach 0.01
LEAST_ANGLE = radians(20.0)  # to which a table must reach to tell θ_1: where a plain tube loses its hundredth
COEFFICIENTS = 5
UNITS = ("deg", "rad", "percent", "pa")
_BOUNDS = {
    "mach": (0.0, 0.95, ""),
    "alpha": (-0.5 * pi, 0.5 * pi, " rad"),
    "beta": (-0.5 * pi, 0.5 * pi, " rad"),
    "total_share": (-2.0, 2.0, ""),
    "static_share": (-2.0, 2.0, ""),
}


@dataclass(frozen=True, slots=True)
class Fit:
    """The law that comes nearest to a table.

    Attributes
    ----------
    static : tuple of float
        c₀, c_α, c_αα, c_ββ, c_M.
    limit : float or None
        θ_1, rad; infinite of a total port that loses nothing; None where the table does not tell.
    left : float
        Root of the mean square of what the law leaves of both ports, a share of q_c.
    """

    static: tuple[float, float, float, float, float]
    limit: float | None
    left: float


def fit(content: str) -> Fit:
    """Fit the law to a table in CSV with the columns `COLUMNS`, in any order.

    Raises
    ------
    ValueError
        One line: a column is missing or unknown, a number is none, an angle is no rad, or the table does not tell what
        an angle makes.
    """
    import numpy as np

    mach, alpha, beta, total, static = np.asarray(_rows(content), dtype=float).T
    for name, axis, least in (("alpha", alpha, 3), ("|beta|", np.abs(beta), 2)):
        if len(np.unique(axis.round(6))) < least or np.ptp(axis) < LEAST_WIDTH:
            raise ValueError(f"has fewer than {least} values of {name}: what that angle makes cannot be told")
    down, mach2 = np.sin(alpha) * np.cos(beta), mach**2
    columns = [np.ones_like(mach), down, down**2, np.sin(beta) ** 2]
    if np.ptp(mach2) > LEAST_MACH2:
        columns.append(mach2)
    design = np.stack(columns, axis=1)
    if np.linalg.matrix_rank(design) < len(columns):
        raise ValueError("does not tell apart what alpha, beta and mach make: give a grid of them")
    found = np.linalg.lstsq(design, static, rcond=None)[0]
    angle = np.arccos(np.clip(np.cos(alpha) * np.cos(beta), -1.0, 1.0))
    beyond, told = np.maximum(0.0, angle - FREE) ** 2, bool(angle.max() >= LEAST_ANGLE)
    k = max(0.0, float(beyond @ (1.0 - total) / (beyond @ beyond))) if told else 0.0
    left = (float(np.sqrt(np.mean(each**2))) for each in (design @ found - static, 1.0 - k * beyond - total))
    c0, c1, c2, cb, *cm = (float(value) for value in found)
    limit = None if not told else FREE + sqrt(0.01 / k) if k > 0.0 else inf
    return Fit((c0, c1, c2, cb, sum(cm)), limit, hypot(*left))


def _rows(content: str) -> list[list[float]]:
    """Return a table's numbers, in the order of the columns."""
    lines = content.splitlines()
    if len(lines) - 1 > MOST_ROWS:
        raise ValueError(f"has more than {MOST_ROWS} rows")
    try:
        head, *body = csv.reader(lines, strict=True)
    except ValueError:
        raise ValueError("is empty") from None
    except csv.Error as error:
        raise ValueError(f"is no CSV: {error}") from None
    order = _order([name.strip() for name in head])
    rows = [_row(number, cells, order) for number, cells in enumerate(body, start=2) if cells]
    if len(rows) < COEFFICIENTS:
        raise ValueError(f"has {len(rows)} rows; the law has {COEFFICIENTS} coefficients")
    return rows


def _order(head: list[str]) -> list[int]:
    """Return where each column is."""
    for name in head:
        stem, _, unit = name.rpartition("_")
        for known in COLUMNS if unit in UNITS else ():
            if stem in {known, known.removesuffix("_share")}:
                wanted = "rad" if known in {"alpha", "beta"} else "a number" if known == "mach" else "a share of q_c"
                raise ValueError(f"column {shown(name)} has the wrong unit; wanted: {known}, {wanted}")
        if name not in COLUMNS:
            raise ValueError(f"column {shown(name)} is unknown; the columns are {', '.join(COLUMNS)}")
    missing = [name for name in COLUMNS if name not in head]
    if missing:
        raise ValueError(f"column {', '.join(missing)} is missing; the columns are {', '.join(COLUMNS)}")
    if len(head) > len(COLUMNS):
        raise ValueError(f"has a column twice; the columns are {', '.join(COLUMNS)}")
    return [head.index(name) for name in COLUMNS]


def _row(line: int, cells: list[str], order: list[int]) -> list[float]:
    if len(cells) != len(order):
        raise ValueError(f"line {line} has {len(cells)} cells; there are {len(order)} columns")
    values = []
    for name, place in zip(COLUMNS, order, strict=True):
        low, high, unit = _BOUNDS[name]
        try:
            value = float(cells[place])
        except ValueError:
            raise ValueError(f"line {line}: {name} {shown(cells[place])} is no number") from None
        if not low <= value <= high:  # NaN is not either
            hint = "; perhaps it is in degrees" if unit and abs(value) <= degrees(high) else ""
            raise ValueError(f"line {line}: {name} must be {low:.3g} to {high:.3g}{unit}, not {value:g}{hint}")
        values.append(value)
    return values
