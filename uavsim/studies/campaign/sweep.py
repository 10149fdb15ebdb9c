"""A grid over assumptions: what each cell gives, how cells differ, and where each requirement breaks.

Every cell flies the same flights: flight i of each has the seed and the index i (common random numbers). So a
difference between two cells is taken flight by flight, and what the flights have in common falls out of it:
var(Y_a - Y_b) = var Y_a + var Y_b - 2 cov(Y_a, Y_b). Intervals:

share of flights as expected          Clopper-Pearson (`uavsim.studies.intervals`)
quantiles                             order statistics (`uavsim.studies.quantiles`)
mean of paired differences            Student's t with n - 1 degrees of freedom
difference of paired shares           Bonett and Price (J. Educational and Behavioral Statistics 37, 2012, 479-488):
                                      the two counts of pairs that differ, each with one more; then the normal interval
where a requirement breaks            `uavsim.studies.campaign.crossing`
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.folders import Place
from uavsim.requirements import Requirement
from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.campaign.crossing import Crossing, crossings
from uavsim.studies.campaign.vary import Cell, Varied, cells, own_values, parse, varied
from uavsim.studies.intervals import share_interval
from uavsim.studies.quantiles import quantile_band

if TYPE_CHECKING:
    import pandas as pd


Array = NDArray[np.float64]

OUTCOME = "outcome"
QUANTITIES = ("launch.latency", "airspeed.rmse", "flight.rail_exit_speed")
QUANTILES = {"p05": 0.05, "median": 0.5, "p95": 0.95}
WANTED = 0.95
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Sweep:
    """What a sweep gave.

    Attributes
    ----------
    scenario
        Whose keys were varied.
    varies
        The keys and their values.
    cells
        A value of each key, in the order of flying.
    flights
        In each cell.
    runs
        A row a flight: `index` = cell · flights + `run`, `vary.KEY`, and the score.
    wanted
        Probability with which a requirement shall be met.
    confidence
        Of all intervals.
    """

    scenario: Scenario
    varies: tuple[Varied, ...]
    cells: tuple[Cell, ...]
    flights: int
    runs: "pd.DataFrame"
    wanted: float = WANTED
    confidence: float = CONFIDENCE

    @property
    def quantities(self) -> tuple[str, ...]:
        """Numbers of the score that are looked at: latency, error, exit speed, and what a requirement bounds."""
        asked = (*QUANTITIES, *(r.key for r in self.scenario.requirements if r.of_each_flight))
        return tuple(key for key in dict.fromkeys(asked) if key in self.runs and self.runs[key].notna().any())

    @property
    def own(self) -> Cell:
        """The scenario's own values of the varied keys; None where it has none."""
        return own_values(self.scenario, self.varies)

    @cached_property
    def reference(self) -> int:
        """Number of the cell that others are compared with: the scenario's own, if it is there, else the first."""
        own = self.own
        return next((i for i, cell in enumerate(self.cells) if cell == own), 0)

    @property
    def nominal(self) -> bool:
        """Whether the reference is the scenario as it is."""
        return self.cells[self.reference] == self.own

    @cached_property
    def labels(self) -> "list[dict[str, Any]]":
        """What tables show of each cell: `vary.KEY` and its label."""
        shown = [dict(zip(map(_hashed, one.choices), one.labels, strict=True)) for one in self.varies]
        return [
            {f"vary.{one.key}": named[_hashed(cell[one.key])] for one, named in zip(self.varies, shown, strict=True)}
            for cell in self.cells
        ]

    def values(self, key: str) -> Array:
        """Return a number of the score, shape (cells, flights); NaN where it does not exist, or was not flown."""
        return self._spread(self.runs[key].to_numpy(np.float64))

    def expected(self) -> Array:
        """Return 1 where the outcome is as expected, 0 where not, NaN where not flown; shape (cells, flights)."""
        return self._spread((self.runs["outcome"] == self.runs["expected"]).to_numpy().astype(np.float64))

    def alike(self, key: str) -> bool:
        """Whether a number of the score, or `outcome`, is the same in all cells, flight by flight."""
        values = self.expected() if key == OUTCOME else self.values(key)
        return bool(np.array_equal(values, np.broadcast_to(values[:1], values.shape), equal_nan=True))

    def _spread(self, values: Array) -> Array:
        found = np.full(len(self.cells) * self.flights, np.nan)
        found[self.runs["index"].to_numpy(int)] = values
        return found.reshape(len(self.cells), self.flights)

    @cached_property
    def table(self) -> "pd.DataFrame":
        """A row a cell: `cell`, `vary.KEY`, `flights`, `expected` and its `share`, and quantiles, all with bounds.

        Of each quantity there are `KEY.missing`, flights that have none, and `KEY.p05`, `KEY.median`, `KEY.p95` of
        those that do, each with `_low` and `_high`; NaN where the flights are too few for a bound.
        """
        import pandas as pd

        good = self.expected()
        return pd.DataFrame([row for i in range(len(self.cells)) if (row := self._row(i, good[i]))])

    def _row(self, i: int, good: Array) -> dict[str, Any]:
        flown = np.isfinite(good)
        count, hits = int(flown.sum()), int(np.nansum(good))
        if not count:
            return {}
        low, high = share_interval(hits, count, self.confidence)
        row: dict[str, Any] = {"cell": i, **self.labels[i], "flights": count, "expected": hits}
        row |= {"share": hits / count, "share_low": low, "share_high": high}
        for key in self.quantities:
            sample = self.values(key)[i]
            sample = sample[np.isfinite(sample)]
            row[f"{key}.missing"] = count - sample.size
            for name, q in QUANTILES.items():
                band = quantile_band(sample, q, self.confidence) if sample.size else None
                for end in ("value", "low", "high"):
                    found = None if band is None else getattr(band, end)
                    row[f"{key}.{name}{'' if end == 'value' else '_' + end}"] = np.nan if found is None else found
        return row

    @cached_property
    def differences(self) -> "pd.DataFrame":
        """Each cell less the reference, flight by flight: a row a cell and quantity (`outcome`: share as expected).

        `pairs` have both; `difference` with `low` and `high`; `narrower`: how many times wider the interval would be
        of as many flights with draws of their own in each cell. NaN where there are no two pairs.
        """
        import pandas as pd

        rows = []
        for quantity in (OUTCOME, *self.quantities):
            values = self.expected() if quantity == OUTCOME else self.values(quantity)
            for i in range(len(self.cells)):
                if i != self.reference:
                    found = paired(values[i], values[self.reference], self.confidence, share=quantity == OUTCOME)
                    rows.append({"cell": i, **self.labels[i], "quantity": quantity, **found})
        return pd.DataFrame(rows)

    @cached_property
    def limits(self) -> "pd.DataFrame":
        """Where each requirement breaks along each key that is a number: a row a line of cells and direction.

        `requirement`, `key`, `vary.KEY` of the other keys, `direction` (up, down), and what `Crossing` has, with the
        band's ends as `low` and `high`.
        """
        import pandas as pd

        return pd.DataFrame([row for judged in self.judged() for row in self._limits(judged)], columns=self._columns())

    def _columns(self) -> list[str]:
        others = [f"vary.{one.key}" for one in self.varies] if len(self.varies) > 1 else []
        return [
            *("requirement", "key"),
            *others,
            *("direction", "wanted", "state", "start", "estimate", "low", "high", "quantile"),
            *("logistic", "logistic_low", "logistic_high"),
        ]

    def judged(self) -> "list[Judged]":
        """What shall be met: the outcome, and each requirement that bounds a number of a flight."""
        found = [Judged(f"outcome {self.scenario.expect}", self.expected())]
        for one in (r for r in self.scenario.requirements if r.of_each_flight):
            if one.key not in self.runs or (one.minimum is None and one.maximum is None):
                continue
            found.append(_judged(one, self.values(one.key), self.expected()))
        return found

    def _limits(self, judged: "Judged") -> Iterator[dict[str, Any]]:
        for axis, one in enumerate(self.varies):
            if not one.numeric or len(one.choices) < 2:
                continue
            for line in self.lines(axis):
                for found in self.limits_along(axis, line, judged):
                    others = {name: value for name, value in self.labels[line[0]].items() if name != f"vary.{one.key}"}
                    yield {
                        "requirement": judged.name,
                        "key": one.key,
                        **others,
                        **_plain(found),
                        "wanted": self.wanted,
                    }

    def lines(self, axis: int) -> Iterator[NDArray[np.int_]]:
        """Yield the numbers of the cells in which a key changes and all others stay, by rising value of the key."""
        shape = tuple(len(one.choices) for one in self.varies)
        grid = np.moveaxis(np.arange(len(self.cells)).reshape(shape), axis, -1)
        order = np.argsort(self.varies[axis].labels) if self.varies[axis].numeric else np.arange(shape[axis])
        yield from grid.reshape(-1, shape[axis])[:, order]

    def limits_along(self, axis: int, line: NDArray[np.int_], judged: "Judged") -> tuple[Crossing, ...]:
        """Where a requirement breaks along one line of cells; none where a cell was not flown."""
        met = judged.met[line].T
        if not np.isfinite(met).any(axis=0).all():
            return ()
        one, own = self.varies[axis], self.own[self.varies[axis].key]
        numbers = np.sort(np.array(one.labels, dtype=np.float64))
        return crossings(
            numbers,
            met,
            self.wanted,
            own=float(own) if isinstance(own, int | float) else None,
            confidence=self.confidence,
            values=None if judged.numbers is None else judged.numbers[line].T,
            minimum=judged.minimum,
            maximum=judged.maximum,
        )


@dataclass(frozen=True)
class Judged:
    """Something that a flight meets or not: 1, 0, or NaN where it was not flown; shape (cells, flights)."""

    name: str
    met: Array
    numbers: Array | None = None
    minimum: float | None = None
    maximum: float | None = None


def _judged(one: Requirement, values: Array, flown: Array) -> Judged:
    """Judge each flight by a requirement; a number that does not exist meets no bound."""
    low, high = one.minimum, one.maximum
    good = (values >= (-np.inf if low is None else low)) & (values <= (np.inf if high is None else high))
    met = np.where(np.isfinite(flown), good.astype(np.float64), np.nan)
    if low is not None and high is not None:
        name = f"{low:g} ≤ {one.key} ≤ {high:g}"
    else:
        name = f"{one.key} ≥ {low:g}" if low is not None else f"{one.key} ≤ {high:g}"
    return Judged(name, met, values, low, high)


def _plain(found: Crossing) -> dict[str, Any]:
    names = ("state", "start", "estimate", "low", "high", "quantile", "logistic", "logistic_low", "logistic_high")
    values = {name: getattr(found, name) for name in names}
    return {"direction": "up" if found.rising else "down"} | {
        name: np.nan if value is None else value for name, value in values.items()
    }


def paired(one: Array, other: Array, confidence: float = CONFIDENCE, *, share: bool = False) -> dict[str, Any]:
    """Compare two cells flight by flight.

    Parameters
    ----------
    one, other
        The same flights in both, shape (n,); a pair counts where both are there.
    confidence
        Of the interval.
    share
        Whether they are 0 and 1.

    Returns
    -------
    dict
        `pairs`, `difference` of the means, one less other, with `low` and `high`, and `narrower`.
    """
    from scipy.special import ndtri, stdtrit

    both = np.isfinite(one) & np.isfinite(other)
    one, other = one[both], other[both]
    n = one.size
    if n < 2:
        return {"pairs": n, "difference": np.nan, "low": np.nan, "high": np.nan, "narrower": np.nan}
    change = one - other
    middle = float(change.mean())
    apart = float(np.sqrt((one.var(ddof=1) + other.var(ddof=1)) / n))
    if share:
        more, less = (int(np.sum(change > 0.0)) + 1) / (n + 2), (int(np.sum(change < 0.0)) + 1) / (n + 2)
        half = float(ndtri(0.5 * (1.0 + confidence))) * float(np.sqrt((more + less - (more - less) ** 2) / (n + 2)))
        low, high = max(-1.0, more - less - half), min(1.0, more - less + half)
    else:
        half = float(stdtrit(n - 1, 0.5 * (1.0 + confidence))) * float(change.std(ddof=1)) / float(np.sqrt(n))
        low, high = middle - half, middle + half
    beside = float(change.std(ddof=1)) / float(np.sqrt(n))
    narrower = apart / beside if beside > 0.0 else np.nan
    return {"pairs": n, "difference": middle, "low": low, "high": high, "narrower": narrower}


def _hashed(value: Any) -> str:
    return repr(value)


def of(
    scenario: Scenario,
    varies: Sequence[Varied],
    cells: Sequence[Cell],
    flights: int,
    runs: "pd.DataFrame",
    *,
    wanted: float = WANTED,
    confidence: float = CONFIDENCE,
) -> Sweep:
    """Return a sweep of rows that were flown, sorted by their index."""
    ordered = runs.sort_values("index", ignore_index=True)
    return Sweep(scenario, tuple(varies), tuple(cells), flights, ordered, wanted, confidence)


def sweep(
    scenario: Scenario | str | Path,
    vary: Mapping[str, Iterable[Any] | str],
    *,
    runs: int,
    seed: int | None = None,
    wanted: float = WANTED,
    confidence: float = CONFIDENCE,
    workers: int | None = None,
    client: Any = None,
    out: str | Path | None = None,
) -> Sweep:
    """Fly a scenario over a grid of assumptions, the same flights in every cell.

    Parameters
    ----------
    scenario
        Or what `load_scenario` takes.
    vary
        Values of each key, or as a text what `--vary` takes: "0.5x,1x,2x".
    runs
        Flights in each cell.
    seed
        In place of the scenario's.
    wanted
        Probability with which a requirement shall be met.
    confidence
        Of all intervals.
    workers
        Processes of this machine; None: one a processor; 0: this one.
    client
        A `distributed.Client` of your own in their place.
    out
        Folder for the rows, empty or not there; without it they are only returned.

    Returns
    -------
    Sweep
        With `runs`, `table`, `differences`, `limits`.

    Raises
    ------
    ValueError
        One line: a key or a value that cannot be, and in which cell; flights that could not be flown.
    """
    from uavsim.studies.campaign.campaign import fly_plan
    from uavsim.studies.campaign.keep import keep_of
    from uavsim.studies.campaign.plan import Cells
    from uavsim.studies.campaign.record import Record
    from uavsim.studies.engine import engine

    if runs < 1:
        raise ValueError(f"runs = {runs}: must be at least 1")
    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    if seed is not None:
        scenario = scenario.with_seed(seed)
    varies = [
        parse(scenario, f"{key}={values}") if isinstance(values, str) else varied(scenario, key, values)
        for key, values in vary.items()
    ]
    grid = cells(scenario, varies)
    with ExitStack() as stack:
        if out is None:
            folder = Path(stack.enter_context(TemporaryDirectory(prefix="uavsim-sweep-")))
        else:
            folder = stack.enter_context(Place(Path(out), overwrite=False).claim()).folder
        plan, rule = Cells(scenario, grid, runs), keep_of("none", ())
        crew = stack.enter_context(engine(workers=workers, client=client))
        flights = fly_plan(Record(folder, plan, keep=str(rule)), crew, rule)
        if flights.left:
            first = flights.left[0]
            raise ValueError(f"{len(flights.left)} flights could not be flown; index {first.position}: {first.why}")
        return of(scenario, varies, grid, runs, flights.runs, wanted=wanted, confidence=confidence)
