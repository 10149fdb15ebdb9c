"""Operating curves: how often launch detectors see a launch, how late, and how often they cry wolf, at each level.

Every detector is tried at several values of its own level, the threshold, limit or acceleration that its settings call
so, all others as they are. All of them read the same launches and the same disturbances, so two curves differ by the
detectors alone; points of one curve are not independent of each other. Probabilities have Clopper-Pearson bands, rates
Poisson (Garwood) bands, 95 % each at every point on its own. What counts as a detection is in `uavsim.studies.trials`.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.flight_computer import FlightComputerSettings
from uavsim.onboard.launch import KINDS, DetectorSettings
from uavsim.onboard.launch.kinds import OPTIONS, Level
from uavsim.onboard.launch.settings import get, kind_of
from uavsim.onboard.launch.settings import with_key as changed_key
from uavsim.plugins import check_options
from uavsim.settings import SettingError, read
from uavsim.studies.false_alarms import COMPUTER, DISTURBANCES, FalseAlarms, count
from uavsim.studies.intervals import share_interval
from uavsim.studies.signals import LaunchSettings
from uavsim.studies.trials import Drawn, Launches, Trials, Verdicts, join, judge
from uavsim.studies.workers import Progress, spread

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Cell = tuple[float, float, bool]

LOT = 50  # launches that are read at once
SHARES = {"mix": 1.0, "vibration": 0.25, "soft drops": 0.25, "centrifuge": 0.25}  # of the hours, by class
PEAKS, SIGMAS = (5.0, 6.0, 7.0, 10.0, 15.0), (0.05, 0.3, 1.0)  # g, cells of the comparison
CELLS: tuple[Cell, ...] = tuple((p, s, bump) for p in PEAKS for s in SIGMAS for bump in (False, True))
LATENCIES = ("crossing_median", "crossing_p95", "onset_median", "onset_p95")


# -- a detector's own level ------------------------------------------------------------------------------------------


def level_of(settings: DetectorSettings) -> Level | None:
    """What the detector's kind is swept along; None if its operating curve is a point."""
    return kind_of(settings).level


def level(settings: DetectorSettings) -> float:
    """Value of the level that a detector's kind is swept along; NaN if there is none."""
    own = level_of(settings)
    return nan if own is None else float(get(settings, own.key))


def at_level(settings: DetectorSettings, value: float) -> DetectorSettings:
    """The same detector at another level; what belongs to the level keeps its ratio to it.

    Raises
    ------
    SettingError
        If the level is out of its bounds.
    """
    own = level_of(settings)
    assert own is not None
    changed = with_key(settings, own.key, value)
    for other in own.beside:
        beside = get(settings, other)
        if beside is not None:
            changed = with_key(changed, other, beside * value / level(settings))
    return changed


def with_key(settings: DetectorSettings, key: str, value: Any) -> DetectorSettings:
    """The same detector with another value of one key, a group's joined by a dot; bounds are checked.

    Raises
    ------
    SettingError
        If the value is out of its bounds.
    """
    first, _, inner = key.partition(".")
    if first == OPTIONS:
        check_options("detector", kind_of(settings).options, {inner: value})
    else:
        read(DetectorSettings, {first: {inner: value} if inner else value})
    return changed_key(settings, key, value)


def levels(settings: DetectorSettings) -> Iterator[tuple[float, DetectorSettings]]:
    """The levels that are tried, over the one that is set, and the detectors; those out of bounds are left out."""
    own = level_of(settings)
    for factor in own.factors if own is not None else (1.0,):
        with suppress(SettingError):
            yield factor, at_level(settings, level(settings) * factor) if factor != 1.0 else settings


# -- sweeps ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Operating:
    """Operating curves.

    Attributes
    ----------
    rows
        A row a detector and level: `detector`, `key` and `unit` of the level (empty: it has none), `level` (NaN),
        `factor` (1: as set), `trials`, `detected`, `early`
        (false alarms before the onset), `pd`, `pd_low`, `pd_high`; latencies `crossing_median`, `crossing_p95`,
        `onset_median`, `onset_p95`, s; launches after which the wings open `commanded`, `pc`, `pc_low`, `pc_high`,
        and before whose end they do `on_rail`; and for each class of disturbances `CLASS.hours`, `CLASS.alarms`,
        `CLASS.per_hour`, `CLASS.low`, `CLASS.high`, and `CLASS.commands`, `CLASS.commands_per_hour`,
        `CLASS.commands_low`, `CLASS.commands_high`: false wing commands of the flight computer behind the detector.
    seed, launches
        What was drawn, and from what, in words.
    rate
        Samples a second, Hz.
    """

    rows: "pd.DataFrame"
    seed: int
    launches: str
    rate: float

    def shipped(self) -> "pd.DataFrame":
        """Rows of the detectors as they are set."""
        return self.rows[self.rows["factor"] == 1.0]


def operate(
    detectors: Sequence[DetectorSettings],
    launches: Launches,
    *,
    hours: float,
    trials: int,
    seed: int,
    name: str = "",
    computer: FlightComputerSettings = COMPUTER,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Operating:
    """Sweep detectors along their levels.

    Parameters
    ----------
    detectors
        As they are set; different kinds.
    launches
        Where the trials come from.
    hours
        Of the mix; of the other classes a quarter, all in pieces of ten minutes.
    trials
        Number of launches.
    seed
        Of launches and disturbances.
    name
        Of the launches, for people.
    computer
        Of the aircraft behind each detector.
    workers, progress
        As of `uavsim.studies.workers.spread`; the result does not depend on them.

    Raises
    ------
    ValueError
        Settings that do not fit together or the rate; no trials or hours.
    """
    import pandas as pd

    if trials < 1 or not 0.0 < hours < np.inf:
        raise ValueError(f"needs at least one trial and hours above 0, not {trials} and {hours:g}")
    swept = [(d, factor, chosen) for d in detectors for factor, chosen in levels(d)]
    settings = [chosen for _, _, chosen in swept]
    report = progress or (lambda _: None)
    times = {kind: share * hours for kind, share in SHARES.items()}
    alarms = count(
        settings,
        times,
        seed=seed,
        rate=launches.rate,
        computer=computer,
        workers=workers,
        progress=lambda share: report(0.6 * share),
    )
    verdicts = tried(
        settings,
        launches,
        seed=seed,
        trials=trials,
        computer=computer,
        workers=workers,
        progress=lambda share: report(0.6 + 0.4 * share),
    )
    rows = []
    for i, (own, factor, chosen) in enumerate(swept):
        swept_along = level_of(own)
        named = ("", "") if swept_along is None else (swept_along.key, swept_along.unit)
        row = {"detector": own.kind, "key": named[0], "unit": named[1], "level": level(chosen), "factor": factor}
        row |= scored(verdicts[i]) | opened(verdicts[i])
        for kind in DISTURBANCES:
            row |= {f"{kind}.{key}": value for key, value in rated(alarms[kind][i]).items()}
        rows.append(row)
    return Operating(pd.DataFrame(rows), seed, name, launches.rate)


def tried(
    detectors: Sequence[DetectorSettings],
    launches: Launches,
    *,
    seed: int,
    trials: int,
    first: int = 0,
    computer: FlightComputerSettings | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> list[Verdicts]:
    """Try detectors on the same launches, `first` … `first` + `trials` - 1 of a seed; those of each detector.

    With a flight computer what it makes of them is judged, too.
    """

    def lot(begin: int) -> list[Verdicts]:
        read_: Trials = launches.read(seed, begin, min(LOT, first + trials - begin))
        return [judge(settings, read_, launches.rate, computer) for settings in detectors]

    fly = getattr(launches, "fly", None)
    if fly is not None:
        fly(seed)  # by one alone; the lots share the flights
    lots = [partial(lot, begin) for begin in range(first, first + trials, LOT)]
    done = spread(lots, workers=workers, progress=progress)
    return [join(parts) for parts in zip(*done, strict=True)]


def scored(verdicts: Verdicts) -> dict[str, float | int]:
    """Detection probability with its band, and latencies, s, of a detector."""
    trials, detected = verdicts.early.size, int(verdicts.detected.sum())
    low, high = share_interval(detected, trials)
    row: dict[str, float | int] = {"trials": trials, "detected": detected, "early": int(verdicts.early.sum())}
    row |= {"pd": detected / trials, "pd_low": low, "pd_high": high}
    for name, latency in (("crossing", verdicts.since_crossing), ("onset", verdicts.since_onset)):
        seen = latency[np.isfinite(latency)]
        for quantile, share in (("median", 0.5), ("p95", 0.95)):
            row[f"{name}_{quantile}"] = float(np.quantile(seen, share)) if seen.size else np.nan
    return row


def opened(verdicts: Verdicts) -> dict[str, float | int]:
    """Launches after which the wings open, with the band of their share, and those on whose rail they do."""
    trials, commanded = verdicts.commanded.size, int(verdicts.commanded.sum())
    low, high = share_interval(commanded, trials)
    row = {"commanded": commanded, "on_rail": int(verdicts.on_rail.sum())}
    return row | {"pc": commanded / trials, "pc_low": low, "pc_high": high}


def rated(found: FalseAlarms) -> dict[str, float | int]:
    """Alarms of a detector in a class of disturbances and false wing commands, with the bands of their rates, 1/h."""
    low, high = found.interval()
    row = {"hours": found.hours, "alarms": found.alarms, "per_hour": found.per_hour, "low": low, "high": high}
    low, high = found.commands_interval()
    row |= {"commands": found.commands, "commands_per_hour": found.commands_per_hour}
    return row | {"commands_low": low, "commands_high": high}


# -- comparison ------------------------------------------------------------------------------------------------------


def launches_of(cell: Cell, rate: float = 1000.0) -> Drawn:
    """Launches of a cell: kinematic peak, g, noise, g, and whether a bump strikes before."""
    peak, sigma, bump = cell
    return Drawn(LaunchSettings(peak_g=(peak, peak), sigma_g=sigma, bump=bump), rate)


def compare(
    detectors: Sequence[DetectorSettings],
    *,
    trials: int,
    seed: int,
    cells: Sequence[Cell] = CELLS,
    rate: float = 1000.0,
    workers: int | None = None,
    progress: Progress | None = None,
) -> "pd.DataFrame":
    """Try detectors as they are set in each cell of peak, noise and bump.

    Returns
    -------
    DataFrame
        A row a cell and detector: `peak_g`, `sigma_g`, `bump`, `detector` and what `scored` gives.
    """
    import pandas as pd

    rows = []
    for i, cell in enumerate(cells):
        verdicts = tried(detectors, launches_of(cell, rate), seed=seed, trials=trials, workers=workers)
        for settings, verdict in zip(detectors, verdicts, strict=True):
            named = {"peak_g": cell[0], "sigma_g": cell[1], "bump": cell[2], "detector": settings.kind}
            rows.append(named | scored(verdict))
        if progress is not None:
            progress((i + 1) / len(cells))
    return pd.DataFrame(rows)


@dataclass(frozen=True, slots=True)
class Shortfall:
    """A cell in which a detector is not better than a rival, and by what: "probability" or "delay"."""

    cell: Cell
    rival: str
    by: str


def rivals() -> list[str]:
    """What autopilots fly, which the default is compared with."""
    return [kind.name for kind in KINDS.values() if kind.autopilot]


def not_better(table: "pd.DataFrame", own: str) -> Iterator[Shortfall]:
    """Cells in which a detector is not better than a rival.

    Better is who detects more launches, all early alarms and misses being lost, and of two that detect as many the
    one with the smaller median delay after the 4.5 g crossing.
    """
    for _, rows in table.groupby(["peak_g", "sigma_g", "bump"], sort=False):
        place = float(rows["peak_g"].iloc[0]), float(rows["sigma_g"].iloc[0]), bool(rows["bump"].iloc[0])
        by_name = rows.set_index("detector")
        mine = by_name.loc[own]
        for rival in (r for r in rivals() if r in by_name.index and r != own):
            theirs = by_name.loc[rival]
            if theirs["detected"] > mine["detected"]:
                yield Shortfall(place, rival, "probability")
            elif theirs["detected"] == mine["detected"] and not mine["crossing_median"] < theirs["crossing_median"]:
                yield Shortfall(place, rival, "delay")
