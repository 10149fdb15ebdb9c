"""What many flights gave, as figures and tables take it: a row a flight, and the error over time of some of them.

Rows may hold any columns of `runs.parquet`; a figure whose columns are missing is not drawn. Traces, kept flights and
what costs memory may be left out: there are as many of them as the campaign has kept.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.batch import Batch
from uavsim.studies.campaign.campaign import Flights
from uavsim.studies.campaign.flown import ERROR_START, ERROR_STEP, ErrorTrace
from uavsim.studies.campaign.record import FLIGHTS

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.flight import Flight
    from uavsim.scenario import Scenario
    from uavsim.studies.batch_cramer_rao import Least

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BROKEN = ("diverged", "failed")  # outcomes after which a flight's numbers say nothing


@dataclass(frozen=True, eq=False)
class Many:
    """Rows, traces and kept flights of a campaign.

    Attributes
    ----------
    scenario : Scenario
    runs : DataFrame
        A row a flight, sorted by `index`, which no two rows share; a column that is missing counts as NaN.
    traces : list of ErrorTrace
        Airspeed errors of the first rows, in their order: the i-th belongs to the i-th row.
    complete : bool
        False if it was interrupted, or a flight could not be flown.
    kept : mapping
        Whole flights, or their folders, by index; may be empty.
    wall_time : float
        s.
    lost : tuple of int
        Indices of flights that could not be flown.
    flights : int
        How many were asked for; 0: as many as there are rows.
    """

    scenario: "Scenario"
    runs: "pd.DataFrame"
    traces: list[ErrorTrace] = field(default_factory=list)
    complete: bool = True
    kept: "Mapping[int, Flight | Path]" = field(default_factory=dict)
    wall_time: float = 0.0
    lost: tuple[int, ...] = ()
    flights: int = 0

    def __len__(self) -> int:
        return len(self.runs)

    @property
    def error_time(self) -> Array:
        """Middles of the bins of `traces`, s after the true launch."""
        count = max((trace.filtered.size for trace in self.traces), default=0)
        return np.asarray(ERROR_START + ERROR_STEP * (np.arange(count) + 0.5), dtype=np.float64)

    def column(self, key: str) -> Array:
        """Return numbers of the rows; NaN where a row has none."""
        import pandas as pd

        if key not in self.runs:
            return np.full(len(self.runs), np.nan)
        return np.asarray(pd.to_numeric(self.runs[key], errors="coerce").to_numpy(dtype=float, na_value=np.nan))

    def words(self, key: str) -> list[str]:
        """Return text of the rows; empty where a row has none."""
        if key not in self.runs:
            return [""] * len(self.runs)
        return self.runs[key].astype(object).where(self.runs[key].notna(), "").astype(str).tolist()

    def matrix(self, kind: str) -> Array:
        """Return `filtered`, `raw` or `nees` of all traces, shape (traces, bins); NaN after a flight's end."""
        found = np.full((len(self.traces), self.error_time.size), np.nan)
        for row, trace in zip(found, self.traces, strict=True):
            values = getattr(trace, kind)[: row.size]
            row[: values.size] = values
        return found

    @cached_property
    def expected(self) -> Mask:
        """Whether a row's flight ended as its scenario expects."""
        wanted = self.words("expected") if "expected" in self.runs else [self.scenario.expect] * len(self.runs)
        return np.array([a == b for a, b in zip(self.words("outcome"), wanted, strict=True)], dtype=bool)

    @cached_property
    def met(self) -> Mask:
        """Whether a row's flight met its requirements; true where nothing is said of them."""
        return np.asarray(self.column("requirements.met") != 0.0)

    @cached_property
    def sound(self) -> Mask:
        """Whether a row's flight has numbers that mean something: it neither diverged nor failed."""
        return np.array([outcome not in BROKEN for outcome in self.words("outcome")], dtype=bool)

    @cached_property
    def least(self) -> "Least | None":
        """The least error that readings allow, computed once."""
        from uavsim.studies.batch_cramer_rao import least_error

        return least_error(self)

    def index(self, row: int) -> int:
        """Return the index of a row's flight."""
        return int(self.runs["index"].iloc[row])

    def seed(self, row: int) -> int | None:
        """Return the seed of a row's flight, if its rows tell."""
        return int(self.runs["seed"].iloc[row]) if "seed" in self.runs else None


def many(flown: Batch | Many) -> Many:
    """Return several flights as many; where rows do not tell their flights apart, a row's position is its index."""
    if isinstance(flown, Many):
        return flown
    runs = flown.runs
    if "index" not in runs or not runs["index"].is_unique:
        runs = runs.assign(index=np.arange(len(runs)))
    by_seed = dict(zip(runs["seed"], runs["index"], strict=True)) if "seed" in runs else {}
    kept = {int(by_seed[seed]): flight for seed, flight in flown.kept.items() if seed in by_seed}
    return Many(
        scenario=flown.scenario,
        runs=runs,
        traces=flown.traces,
        complete=flown.complete,
        kept=kept,
        wall_time=flown.wall_time,
        lost=flown.lost,
        flights=len(runs) + len(flown.lost),
    )


def many_of(flights: Flights) -> Many:
    """Return what a campaign's folder holds of all flights together.

    The first flight that was kept is read: the bound is computed for its readings, and by then the folder may have
    been renamed.
    """
    kept: dict[int, Flight | Path] = {index: flights.folder / FLIGHTS / str(index) for index in flights.kept()}
    if kept:
        first = min(kept)
        kept[first] = flights.flight(first)
    return Many(
        scenario=flights.scenario,
        runs=flights.runs,
        traces=flights.traces,
        complete=flights.complete,
        kept=kept,
        wall_time=flights.wall_time,
        lost=tuple(flights.plan.index(one.position) for one in flights.left),
        flights=flights.plan.size,
    )
