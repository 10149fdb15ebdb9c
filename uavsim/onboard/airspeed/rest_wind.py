"""The wind that a head sees on the rail, between its tare and the launch.

With the mean pressure difference D of the last conversions at rest, tared, and its standard deviation σ,

    w = √(2 D/ρ),   V* = √(2 σ/ρ),   σ_w = V*²/(2 w)

if w is at least 2 V*. A smaller wind cannot be told from none. Then the airspeed along the launch is taken for 0, with
the standard deviation √(w² + (0.63 V*)²). The second part is what the clipped root of noise is off by (`paper`).

A pressure does not tell a headwind from a tailwind. A wind that is seen is taken for a headwind until the push tells
(`onset`).
"""

from collections.abc import Iterable
from math import inf, sqrt

from uavsim.onboard.airspeed.majority import Majority
from uavsim.onboard.plausible import LEAST_PRESSURE, MOST_PRESSURE

# V* from which on a wind is seen: there the root is linear in the noise, as for a valid airspeed (`paper`)
VISIBLE = 2.0
HIDDEN = 0.632  # V*, rms of the clipped root at rest, by the law of `paper`
OPENED = 0.02  # s after the tare, in which the last covered conversion leaves the head: two periods at 100 Hz. By hand
FEWEST = 3  # conversions; fewer say nothing of the wind. By hand
# m/s. Beyond it a port is broken, for nobody launches in a hurricane, and nothing is known of the wind
STRONGEST = 60.0

Row = tuple[float, float, float, float, float, float]


def rest_difference(rows: Iterable[Row], *, start: float, end: float, each: float) -> tuple[float, float] | None:
    """Return the pair's mean difference on the rail, Pa, and the variance of its noise, Pa²; None for too few.

    Parameters
    ----------
    rows : iterable of tuple
        Readings of the head.
    start, end : float
        Conversions that end between them count, s; the head is uncovered from `start` on.
    each : float
        Variance of one reading's difference, Pa².
    """
    differences, last = Majority(each), -inf
    for _, p_total, p_static, _, t_total, t_static in rows:
        if not (start + OPENED < t_total <= end and start + OPENED < t_static and t_total > last):
            continue
        last = t_total
        if LEAST_PRESSURE <= p_total <= MOST_PRESSURE and LEAST_PRESSURE <= p_static <= MOST_PRESSURE:
            differences.add(p_total - p_static)
    total, count = differences.most.sum, differences.most.count
    return None if count < FEWEST else (total / count, each / count)


def wind_at_rest(seen: tuple[float, float] | None, tare: float, variance: float, density: float) -> tuple[float, float]:
    """Return the airspeed on the rail and its standard deviation, m/s; 0 and infinity if nothing was read.

    Parameters
    ----------
    seen : tuple of float or None
        As of `rest_difference`.
    tare, variance : float
        Of the pair, Pa and Pa².
    density : float
        Of the air, kg/m³.
    """
    if seen is None or not density > 0.0:
        return 0.0, inf
    difference, sigma = seen[0] - tare, sqrt(seen[1] + variance)
    square = 2.0 * sigma / density
    wind = sqrt(2.0 * difference / density) if difference > 0.0 else 0.0
    if wind > STRONGEST:
        return 0.0, inf
    if wind * wind >= VISIBLE * VISIBLE * square:
        return wind, 0.5 * square / wind
    return 0.0, sqrt(wind * wind + HIDDEN * HIDDEN * square)


def turning(wind: float, each: float, density: float) -> float:
    """Airspeed from which a total pressure tells a headwind from a tailwind, if it was a headwind, m/s.

    By then the push has given u = V − w. The pressure is that of w + u in a headwind and of |u − w| in a tailwind. They
    are told apart where u is three standard deviations of an airspeed by one reading, σ/(ρ w), but at least 0.3 w and
    at most 1.5 w. Both bounds are by hand; test_a_launch_in_wind_is_known_by_its_end holds the check.
    """
    if not wind > 0.0:
        return 0.0
    return wind + min(1.5 * wind, max(0.3 * wind, 3.0 * sqrt(each) / (density * wind)))
