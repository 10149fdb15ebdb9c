"""A launch detector's settings for a scenario's launches and a budget of false alarms.

Two of a kind's settings are searched: its level (threshold, limit or acceleration) and what belongs to it (a window, a
reference, a hold). For each value of the second the lowest level is taken at which the upper 95 % bound of the false
alarms in the mix (`uavsim.studies.false_alarms`) is within a share (`MARGIN`) of the budget: a higher one sees less and
later. Among these the most launches detected win; then those that are silent on the centrifuge at 4.1 g, if any are;
then the least median latency, and its 95 % quantile. A second, finer grid follows around the winner. What is found is
scored on the launches and disturbances of another seed, the next one, of which nothing was seen while tuning. The
winner of a search is better on what it won on than it is: that is what the margin is for.

Launches are those of the scenario: one flight of JSBSim for several draws of sensor, noise and vibration
(`uavsim.studies.trials.Flown`). Settings that the scenario would refuse, because its sensor cannot reach them or its
stroke is too short, are left out. The other disturbances are counted at the end and have no budget: a sustained load of
4 g cannot be told from a launch of 4 g.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from math import ceil, inf, nan
from typing import Any

import numpy as np

from uavsim.compiled import jit
from uavsim.onboard.launch import DetectorSettings
from uavsim.onboard.launch.kinds import FORCE, Second
from uavsim.onboard.launch.settings import get, kind_of
from uavsim.scenario import Scenario
from uavsim.settings import SettingError
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import FalseAlarms, count
from uavsim.studies.operating import at_level, level, level_of, scored, tried, with_key
from uavsim.studies.trials import Flown, Trials, Verdicts
from uavsim.studies.workers import Progress
from uavsim.truth import STANDARD_GRAVITY as G0

MOST_HOURS = 1000.0  # h of the mix that are run for a budget
MOST_HOURS_PLAIN = 100.0  # h, where numba's JIT is off: an hour and a half on one core
FEW = 7.225  # upper 95 % bound of the mean of a Poisson count of 2: so many alarms the budget's hours leave room for
NONE = 3.689  # the same of a count of 0
MARGIN = 0.55  # of the budget, kept while tuning: none in the hours in which the budget leaves room for two
LEAST_HOURS = 1.0
OTHERS = {"vibration": 1.0, "soft drops": 1.0, "centrifuge": 1.0}  # h, counted at the end
LIMITS = tuple(np.geomspace(0.2, 3.0, 10).tolist())  # over the limit that is set, which is tried too
PUSHES = tuple(np.linspace(0.25, 0.95, 11).tolist())  # over the force of the push; the level that is set is tried too
LOAD = {"centrifuge": 0.5}  # h, that decide between settings which detect as much
SCREEN = 8.0  # a first look takes the hours over this
FULL = 3  # levels of a row that are counted over all hours
FINE = 6  # levels between two of the first grid
DIGITS = 4  # significant ones, of what is written


@dataclass(frozen=True, slots=True)
class Score:
    """What a detector does: launches (see `operating.scored`), s, and alarms in the disturbances."""

    launches: dict[str, float | int]
    alarms: dict[str, FalseAlarms]


@dataclass(frozen=True, slots=True)
class Tuned:
    """Settings that were found.

    Attributes
    ----------
    scenario
        With them.
    before
        The detector of the same kind as it was.
    budget
        False alarms, 1/h.
    tuned, was
        Scores on the fresh seed of what was found and of what was before.
    own
        Score on the seed that it was tuned on.
    seed, fresh
        Tuned on, scored on.
    tried
        How many settings were looked at.
    """

    scenario: Scenario
    before: DetectorSettings
    budget: float
    tuned: Score
    was: Score
    own: Score
    seed: int
    fresh: int
    tried: int

    @property
    def within(self) -> bool:
        """Whether the fresh seed shows the budget to be kept, with its upper 95 % bound."""
        return self.tuned.alarms["mix"].interval()[1] <= self.budget


def tune(
    scenario: Scenario,
    kind: str | None = None,
    *,
    budget: float,
    seed: int,
    trials: int = 200,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Tuned:
    """Find a detector's settings.

    Parameters
    ----------
    scenario
        Whose launches, sensor and, unless `kind` is given, kind of detector.
    kind
        Of the detector.
    budget
        False alarms in the mix, 1/h.
    seed
        Of launches and disturbances that are tuned on; the next one scores.
    trials
        Launches for tuning; twice as many score.
    workers, progress
        As of `uavsim.studies.workers.spread`; the result does not depend on them.

    Raises
    ------
    ValueError
        A budget that cannot be shown or kept, an accelerometer too slow for the disturbances.
    """
    search = _Search(scenario, own_keys(scenario.detector, kind), budget, seed, trials, workers, progress)
    first = search.best(search.grid())
    best = search.best(search.finer(first), first)
    return search.scored(best)


def own_keys(settings: DetectorSettings, kind: str | None = None) -> DetectorSettings:
    """The same detector, or another kind, with nothing set that the kind does not read."""
    chosen = DetectorSettings(kind=settings.kind if kind is None else kind, axes=settings.axes)
    return replace(chosen, **{key: getattr(settings, key) for key in kind_of(chosen).reads})


def hours_for(budget: float) -> float:
    """Hours of the mix that a budget, 1/h, needs: so many that two alarms keep it, or none if that is too many.

    Raises
    ------
    ValueError
        If the budget is not above 0 or too small to be shown.
    """
    if not 0.0 < budget < inf:
        raise ValueError(f"--false-alarms = {budget:g}: must be above 0 an hour")
    most, where = (MOST_HOURS, "") if jit() else (MOST_HOURS_PLAIN, " where numba's JIT is off")
    needed = NONE / (MARGIN * budget)
    if needed > most:
        raise ValueError(
            f"--false-alarms = {budget:g}: to show so few takes {needed:.3g} h without an alarm, and at most "
            f"{most:g} h are run{where}; {NONE / (MARGIN * most):.4f} an hour can be shown"
        )
    return min(most, max(LEAST_HOURS, ceil(6.0 * FEW / budget) / 6.0))


@dataclass(frozen=True, slots=True)
class _Keeper:
    """Settings that keep the budget, the next lower level tried, and alarms in the mix and on the centrifuge."""

    settings: DetectorSettings
    below: float
    alarms: FalseAlarms
    loads: int


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Settings that keep the budget, the grid's value of the second of them, and what they see."""

    keeper: _Keeper
    second: float
    verdicts: Verdicts

    @property
    def rank(self) -> tuple[float, ...]:
        """Smaller is better."""
        result, one = scored(self.verdicts), self.keeper
        latencies = [result[name] for name in ("onset_median", "onset_p95")]
        return (-result["detected"], one.loads > 0, *(inf if x != x else x for x in latencies), level(one.settings))


class _Kept:
    """Launches that are read once and kept, for every setting is tried on the same."""

    def __init__(self, launches: Flown) -> None:
        self._launches, self.rate = launches, launches.rate
        self._known: dict[tuple[int, int, int], Trials] = {}

    def fly(self, seed: int) -> None:
        """Fly what a seed needs."""
        self._launches.fly(seed)

    def read(self, seed: int, first: int, count: int) -> Trials:
        """Return some trials."""
        key = seed, first, count
        if key not in self._known:
            self._known[key] = self._launches.read(seed, first, count)
        return self._known[key]


class _Search:
    """A search under way: what it is for, and how much of it is done."""

    def __init__(
        self,
        scenario: Scenario,
        base: DetectorSettings,
        budget: float,
        seed: int,
        trials: int,
        workers: int | None,
        progress: Progress | None,
    ) -> None:
        self.hours = hours_for(budget)
        self.scenario, self.base, self.budget, self.seed, self.trials = scenario, base, budget, seed, trials
        self.fresh = (seed + 1) % 2**63
        self.launches, self.workers = _Kept(Flown(scenario)), workers
        self.push = scenario.launcher.peak_specific_force_g * G0 * scenario.push_factor
        self.level = level_of(base)
        if self.level is None:
            raise ValueError(f"detector {base.kind!r} has no level to tune; it flies with the settings that it has")
        self.second = kind_of(base).second_of(base)
        self.values = self._seconds(self.second)
        self.tried = 0
        self._report = progress or (lambda _: None)
        self._begun = 0.0
        BatchDetector(base, self.launches.rate)  # does it fit the rate at all?

    def _seconds(self, second: Second | None) -> tuple[float, ...]:
        """Values of the second setting, the one that is set among them; NaN where there is no such setting."""
        if second is None:
            return (nan,)
        scale = self.push if second.over_push else 1.0
        return tuple(sorted({float(get(self.base, second.key)), *(value * scale for value in second.values)}))

    def grid(self) -> list[list[DetectorSettings]]:
        """For each value of the second setting its levels, rising; what the scenario refuses is left out."""
        force = self.level is not None and self.level.unit == FORCE
        levels = [f * self.push for f in PUSHES] if force else [f * level(self.base) for f in LIMITS]
        return [self._row(value, sorted({level(self.base), *levels})) for value in self.values]

    def finer(self, found: _Candidate) -> list[list[DetectorSettings]]:
        """The same around a winner: between it and the level below, and half way to its neighbours."""
        values = [found.second]
        if self.second is not None and not self.second.whole:
            values += [0.5 * (a + b) for a, b in pairwise(self.values) if found.second in (a, b)]
        top = level(found.keeper.settings)
        around = np.geomspace(found.keeper.below, top, FINE + 1)[1:].tolist()
        wider = np.geomspace(0.5 * found.keeper.below, 1.5 * top, 2 * FINE).tolist()
        return [self._row(value, around if value == found.second else wider) for value in values]

    def _row(self, value: float, levels: Sequence[float]) -> list[DetectorSettings]:
        row = []
        for one in levels:
            try:
                chosen = self.base
                if self.second is not None:
                    chosen = with_key(chosen, self.second.key, int(value) if self.second.whole else _short(value))
                chosen = _rounded(at_level(chosen, one))
                self._placed(chosen)
            except (SettingError, ValueError):
                continue
            row.append(chosen)
        return row

    def _placed(self, settings: DetectorSettings) -> Scenario:
        """Return the scenario with these settings, or refuse them."""
        return Scenario.from_dict({**self.scenario.to_dict(), "detector": plain(settings)}, self.scenario.name)

    def best(self, rows: list[list[DetectorSettings]], known: _Candidate | None = None) -> _Candidate:
        """Return the best of rows of rising levels."""
        flat = [chosen for row in rows for chosen in row]
        self.tried += len(flat)
        if not flat and known is None:
            raise ValueError(
                f"{self.scenario.name}: no settings of {self.base.kind} that were tried suit its sensor and stroke"
            )
        kept = self._kept(rows)
        verdicts = self._tried([one.settings for one in kept], self.seed, self.trials, 0.1)
        found = [
            _Candidate(one, self._nearest(one.settings), verdict) for one, verdict in zip(kept, verdicts, strict=True)
        ]
        found += [] if known is None else [known]
        if not found:
            raise ValueError(
                f"--false-alarms = {self.budget:g}: none of {len(flat)} settings of {self.base.kind} keeps it in "
                f"{self.hours:.3g} h of the mix; allow more"
            )
        return min(found, key=lambda candidate: candidate.rank)

    def _kept(self, rows: list[list[DetectorSettings]]) -> list[_Keeper]:
        """For each row the lowest level that keeps the budget, and the lowest that is silent on the centrifuge, too.

        A part of the hours shows which levels are far too low; of the others the lowest few are counted in full, as
        alarms fall with the level.
        """
        flat = [chosen for row in rows for chosen in row]
        if not flat:
            return []
        seen = self._alarms(flat, self.seed, {"mix": self.hours / SCREEN, **LOAD}, 0.08)
        most, picked, at = MARGIN * self.budget * self.hours, [], 0
        for row in rows:
            begun = range(at, at := at + len(row))
            start = sum(seen["mix"][i].alarms > most for i in begun)
            silent = start + sum(seen["centrifuge"][i].alarms > 0 for i in begun[start:])
            for first in dict.fromkeys((start, silent)):
                picked += [(row, i, seen["centrifuge"][begun[i]].alarms) for i in range(len(row))[first : first + FULL]]
        full = list(dict.fromkeys(row[i] for row, i, _ in picked))
        counted = dict(
            zip(full, self._alarms(full, self.seed, {"mix": self.hours}, 0.2)["mix"] if full else (), strict=True)
        )
        kept: dict[tuple[int, bool], _Keeper] = {}
        for row, i, loads in picked:
            alarms = counted[row[i]]
            if alarms.interval()[1] <= MARGIN * self.budget:
                below = level(row[i - 1]) if i else 0.7 * level(row[i])
                for silent in {False, loads == 0}:
                    kept.setdefault((id(row), silent), _Keeper(row[i], below, alarms, loads))
        return list(dict.fromkeys(kept.values()))

    def _nearest(self, settings: DetectorSettings) -> float:
        """The grid's own value of the second setting, which was rounded."""
        if self.second is None:
            return self.values[0]
        value = float(get(settings, self.second.key))
        return min(self.values, key=lambda own: abs(own - value))

    def scored(self, best: _Candidate) -> Tuned:
        """Score what was found, and what was before, on the fresh seed."""
        both = [best.keeper.settings, self.base]
        alarms = self._alarms(both, self.fresh, {"mix": self.hours, **OTHERS}, 0.1)
        verdicts = self._tried(both, self.fresh, 2 * self.trials, 0.1)
        tuned, was = (
            Score(scored(verdict), {name: found[i] for name, found in alarms.items()})
            for i, verdict in enumerate(verdicts)
        )
        own = Score(scored(best.verdicts), {"mix": best.keeper.alarms})
        return Tuned(
            scenario=self._placed(best.keeper.settings),
            before=self.base,
            budget=self.budget,
            tuned=tuned,
            was=was,
            own=own,
            seed=self.seed,
            fresh=self.fresh,
            tried=self.tried,
        )

    def _alarms(
        self, settings: list[DetectorSettings], seed: int, hours: dict[str, float], share: float
    ) -> dict[str, list[FalseAlarms]]:
        begun, self._begun = self._begun, self._begun + share
        return count(
            settings,
            hours,
            seed=seed,
            rate=self.launches.rate,
            workers=self.workers,
            progress=lambda done: self._report(begun + share * done),
        )

    def _tried(self, settings: list[DetectorSettings], seed: int, trials: int, share: float) -> list[Verdicts]:
        begun, self._begun = self._begun, self._begun + share
        if not settings:
            return []
        return tried(
            settings,
            self.launches,
            seed=seed,
            trials=trials,
            workers=self.workers,
            progress=lambda done: self._report(begun + share * done),
        )


def plain(settings: DetectorSettings) -> dict[str, Any]:
    """Keys and values of a detector that its kind reads, as a scenario's [detector] has them; None is left out."""
    values = asdict(settings)
    own = {key: values[key] for key in ("kind", *kind_of(settings).reads, "axes") if values[key] is not None}
    return {key: list(value) if isinstance(value, tuple) else value for key, value in own.items()}


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _rounded(settings: DetectorSettings) -> DetectorSettings:
    """The same with a level, and what goes with it, of few digits."""
    own = level_of(settings)
    for one in () if own is None else (own.key, *own.beside):
        value = get(settings, one)
        if value is not None:
            settings = with_key(settings, one, _short(value))
    return settings
