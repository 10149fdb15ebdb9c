"""Numbers of many flights that are told and drawn: names, units, quantiles with their bands."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, log10

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.many import Many
from uavsim.studies.quantiles import QuantileBand, quantile_band

Array = NDArray[np.float64]

QUANTILES = {"p05": 0.05, "median": 0.50, "p95": 0.95}
VAST = 1e300  # stands for infinity among order statistics


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of the score as it is shown: `factor` times what the row holds, in `unit`, with `digits`."""

    key: str
    name: str
    unit: str
    factor: float = 1.0
    digits: int = 3
    cell: str = ""  # how a table names it, if not so

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name}, {self.unit}" if self.unit else self.name

    @property
    def heading(self) -> str:
        """Name and unit in a table."""
        return self.cell or self.label

    def of(self, flown: Many) -> Array:
        """Return its values in its unit, a row each; NaN where a flight has none."""
        return self.factor * flown.column(self.key)


LATENCY = Quantity("launch.latency", "latency", "ms", 1e3, 1)
RMSE = Quantity("airspeed.rmse", "airspeed RMSE, filtered", "m/s", cell="RMSE filtered, m/s")
SHOWN = (
    LATENCY,
    Quantity("launch.latency_from_crossing", "latency from 4.5 g", "ms", 1e3, 1, "  from the 4.5 g, ms"),
    Quantity("flight.rail_exit_speed", "airspeed off the rail", "m/s", 1.0, 2),
    RMSE,
    Quantity("airspeed.stroke.rmse", "RMSE in the stroke", "m/s", cell="  in the stroke, m/s"),
    Quantity("airspeed.transition.rmse", "RMSE in transition", "m/s", cell="  in transition, m/s"),
    Quantity("airspeed.cruise.rmse", "RMSE in cruise", "m/s", cell="  in cruise, m/s"),
    Quantity("airspeed.reduction_percent", "reduction of the RMSE", "%", 1.0, 1, "reduction, %"),
    Quantity("airspeed.stroke.reduction_percent", "reduction in the stroke", "%", 1.0, 1, "  in the stroke, %"),
    Quantity("airspeed.transition.reduction_percent", "reduction in transition", "%", 1.0, 1, "  in transition, %"),
    Quantity("airspeed.cruise.reduction_percent", "reduction in cruise", "%", 1.0, 1, "  in cruise, %"),
    Quantity("airspeed.cruise.coverage_95", "within ±1.96 sd in cruise", "", cell="within ±1.96 sd, cruise"),
)
"""Numbers of the score whose distribution is told and drawn."""


def band(sample: Array, probability: float) -> QuantileBand:
    """Estimate a quantile with its 95 % band; infinite values lie beyond all others.

    Raises
    ------
    ValueError
        If the sample is empty or holds NaN.
    """
    found = quantile_band(np.clip(sample, -VAST, VAST), probability)
    value, low, high = (_unclipped(one) for one in (found.value, found.low, found.high))
    return QuantileBand(probability, np.nan if value is None else value, low, high)


def _unclipped(value: float | None) -> float | None:
    """Where an order statistic was infinite, or the value lies between one that was and one that was not."""
    return value if value is None or abs(value) < 1e-3 * VAST else float(np.copysign(np.inf, value))


def bands(sample: Array, names: Iterable[str] = QUANTILES) -> dict[str, QuantileBand]:
    """Return the quantiles of a sample by name."""
    return {name: band(sample, QUANTILES[name]) for name in names}


def precise(value: float, low: float, high: float, digits: int) -> str:
    """Return an estimate and its interval with as many digits as tell its ends apart."""
    width = high - low
    if np.isfinite(width) and width > 0.0:
        digits = min(max(digits, ceil(-log10(width)) + 1), 6)
    return f"{number(value, digits)} [{number(low, digits)}, {number(high, digits)}]"


def number(value: float, digits: int = 3) -> str:
    """Return a number as people read it, with a power of ten where it is absurd."""
    if np.isnan(value):
        return "–"
    if np.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    size = abs(value)
    if size >= 1e6:
        mantissa, exponent = f"{value:.1e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    digits = digits if size < 100.0 else min(digits, 1) if size < 1e4 else 0
    return f"{round(value, digits) + 0:.{digits}f}"  # + 0: no minus before a nought
