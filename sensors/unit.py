"""One unit of a part, and what all descriptions share: standard gravity, rounding, the draw of a turn-on error.

A datasheet says how far units of a part spread; a unit is one draw of it. Typical figures are read as one standard
deviation where the document says nothing else, guaranteed limits as bounds that no unit sold exceeds.
"""

from math import inf, sqrt
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Interval

from sensors.rules import number
from sensors.streams import Streams

Triple = tuple[float, float, float]
Unit = Literal["random", "typical", "ideal"]
DriftModel = Literal["gauss-markov", "flicker"]
Factor = Annotated[float, Interval(ge=0.0, le=1000.0)]
CLOCK = number(0.0, 50.0)  # %: the worst RC oscillators are off by 15 %, and at 100 % time would stand still
CORRELATION = number(1e-3, 1e6)  # s: shorter is white noise, longer is an offset for the longest flight, an hour

G0 = 9.80665  # standard gravity, m/s² (CGPM 1901)
MOST_RATE_ERROR = 0.5  # –; whatever factor is put on an oscillator's error, a unit further off is not sold
REFERENCE_TEMPERATURE = 298.15  # K, 25 °C: where datasheets state their figures and temperature errors are zero

# x + ROUND - ROUND is x rounded to a whole number, ties to even, for |x| < 2^51, and NaN for NaN: the sum has no bits
# left below 1 (IEEE 754 double). It costs half of what round() does.
ROUND = 1.5 * 2.0**52


def draw_error(generator: np.random.Generator, sd: float, limit: float, unit: Unit) -> float:
    """Return a turn-on error of one unit.

    Parameters
    ----------
    generator : numpy.random.Generator
    sd : float
        Standard deviation over units.
    limit : float
        The datasheet's guaranteed bound: a part beyond it is not sold, so it is drawn again.
    unit : {"random", "typical", "ideal"}
        Drawn; off by exactly one standard deviation; without error.
    """
    if unit == "ideal":
        return 0.0
    if unit == "typical":
        return sd
    while True:
        error = float(generator.normal()) * sd
        if abs(error) <= limit:
            return error


class Batch(NamedTuple):
    """What the units of one batch have in common of an error: z = √s z_batch + √(1 - s) z_unit, of unit variance."""

    share: float  # s, of the variance
    common: float  # z_batch

    @classmethod
    def drawn(cls, share: float, streams: Streams, name: str) -> "Batch":
        """Draw a batch; nothing is drawn where its units have nothing in common."""
        return cls(share, float(streams(name).standard_normal()) if share > 0.0 else 0.0)


NO_BATCH = Batch(0.0, 0.0)


def draw_alike(generator: np.random.Generator, sd: float, limit: float, unit: Unit, batch: Batch) -> float:
    """Return a turn-on error of one unit of a batch; parameters as of `draw_error`.

    What the batch has in common is kept within the bound, too.
    """
    if unit != "random" or batch.share == 0.0 or sd == 0.0:
        return draw_error(generator, sd, limit, unit)
    common = sqrt(batch.share) * clip(sd * batch.common, -limit, limit)
    while True:
        error = common + sqrt(1.0 - batch.share) * float(generator.normal()) * sd
        if abs(error) <= limit:
            return error


def quantise(value: float, step: float) -> float:
    """Return `value` rounded to a multiple of `step`, ties to even; NaN stays NaN."""
    return (value / step + ROUND - ROUND) * step


def clip(value: float, low: float = -inf, high: float = inf) -> float:
    """Return `value` within its bounds; NaN stays NaN, which max and min would turn into a bound."""
    if value < low:
        return low
    return high if value > high else value


def unit_vector(vector: Triple, what: str) -> Triple:
    """Return `vector` with length 1; ValueError that names `what` if it has none."""
    x, y, z = vector
    length = sqrt(x * x + y * y + z * z)
    if not 0.0 < length < inf:
        raise ValueError(f"{what} must be a finite vector other than zero, not {vector!r}")
    return x / length, y / length, z / length
