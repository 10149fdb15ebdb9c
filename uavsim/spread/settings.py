"""How values of a scenario differ from flight to flight, as a file says it."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Interval

Kind = Literal["normal", "uniform", "truncated-normal", "choice"]
Chosen = bool | int | float | str


@dataclass(frozen=True, slots=True)
class Dispersion:
    """A value that is drawn anew for each flight; see [dispersions.md](dispersions.md).

    Attributes
    ----------
    key
        Of the scenario, joined by dots; one entry of a list of numbers as `accelerometer.mounting_error_deg[1]`; a
        property as `aircraft.properties.NAME`.
    distribution
        "normal" has `mean` and `sd`; "truncated-normal" has `low`, `high` or both beside them; "uniform" has `low` and
        `high`; "choice" has `values` and may have `weights`.
    mean
        Of the normal distribution, before it is truncated. Without it the key's own value; of a factor, 1.
    sd
        Standard deviation, likewise.
    low, high
        Ends. Of a key that takes whole numbers, "uniform" draws each of them from `low` to `high` equally often.
    values
        Of which one is chosen.
    weights
        How often each of them is, in proportion; equally often without them.
    relative
        Whether mean, sd, low, high and values are factors on the key's own value.
    """

    key: str
    distribution: Kind
    mean: float | None = None
    sd: Annotated[float, Gt(0)] | None = None
    low: float | None = None
    high: float | None = None
    values: tuple[Chosen, ...] = ()
    weights: tuple[Annotated[float, Ge(0)], ...] = ()
    relative: bool = False


@dataclass(frozen=True, slots=True)
class Correlation:
    """How two dispersions with normal distributions go together.

    Attributes
    ----------
    between
        Their keys.
    coefficient
        Coefficient of correlation.
    """

    between: tuple[str, str]
    coefficient: Annotated[float, Interval(ge=-1, le=1)]
