"""A launch detector's settings for a scenario's launches and a budget of false alarms.

The budget, an hour, is asked of every class of exposure of `uavsim.studies.false_alarms`, and of two things:

    the detector alone    handling (the mix), vibration, the sustained load of 4.1 g
    the wing command      these and soft drops: what the flight computer makes of the detector's alarms

A soft drop along the launch axis is a launch until it ends. No detector that decides within 10 ms can tell, so the
detector alone is not asked for it; that the wings stay in is what the speed gained is for, and it is asked.

Two of a kind's settings are searched: its level (threshold, limit or acceleration) and what belongs to it (a window, a
reference, a hold). For each value of the second the lowest level is taken that is silent in a first look at all
classes, and at which the upper 95 % bound of the alarms in the mix is within a share (`MARGIN`) of the budget: a higher
one sees less and later. Among these those win after whose launches the wings open most often; then the most launches
detected; then the least median latency, and its 95 % quantile. The winner has to keep the share of the budget in every
class over all hours, or the next best takes its place. A second, finer grid follows around the winner. What is found is
scored on the launches and disturbances of another seed, the next one, of which nothing was seen while tuning. The
winner of a search is better on what it won on than it is: that is what the margin is for.

Launches are those of the scenario: one flight of JSBSim for several draws of sensor, noise and vibration
(`uavsim.studies.trials.Flown`). A scenario that expects its launch to be missed is refused: whoever tunes for it asks
for a detector that takes a load for a launch. Settings that the scenario would refuse, because its sensor cannot reach
them or its stroke is too short, are left out.
"""

from collections import Counter
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
from uavsim.studies.false_alarms import DISTURBANCES, FalseAlarms, count
from uavsim.studies.operating import at_level, level, level_of, opened, scored, tried, with_key
from uavsim.studies.trials import Flown, Trials, Verdicts
from uavsim.studies.workers import Progress
from uavsim.truth import STANDARD_GRAVITY as G0

MOST_HOURS = 1000.0  # h of the mix that are run for a budget
MOST_HOURS_PLAIN = 100.0  # h, where numba's JIT is off: an hour and a half on one core
FEW = 7.225  # upper 95 % bound of the mean of a Poisson count of 2: so many alarms the budget's hours leave room for
NONE = 3.689  # the same of a count of 0
MARGIN = 0.55  # of the budget, kept while tuning: none in the hours in which the budget leaves room for two
LEAST_HOURS = 1.0
ALONE = ("mix", "vibration", "centrifuge")  # classes in which the detector alone is asked for the budget
SAID = {"mix": "handling", "vibration": "vibration of 3 g", "soft drops": "soft drops", "centrifuge": "4.1 g held"}
CLASSES = tuple(DISTURBANCES)  # in all of them the wing command is
REFUSED = ("missed_launch", "false_launch")  # outcomes that no detector is tuned for
LIMITS = tuple(np.geomspace(0.2, 3.0, 10).tolist())  # over the limit that is set, which is tried too
PUSHES = tuple(np.linspace(0.25, 0.95, 11).tolist())  # over the force of the push; the level that is set is tried too
LOOK = dict.fromkeys(("vibration", "soft drops", "centrifuge"), 0.5)  # h of a first look at the other classes
SCREEN = 8.0  # a first look takes the hours over this
FULL = 3  # levels of a row that are counted over all hours
FINE = 6  # levels between two of the first grid
DIGITS = 4  # significant ones, of what is written


@dataclass(frozen=True, slots=True)
class Score:
    """What a detector does: launches (see `operating.scored`, `operating.opened`), s, and alarms by class."""

    launches: dict[str, float | int]
    alarms: dict[str, FalseAlarms]

    def worst(self) -> "Worst":
        """What comes closest to a budget, or exceeds it most, by the upper 95 % bound of its rate."""
        return max((one for name, found in self.alarms.items() for one in asked(name, found)), key=lambda one: one.high)


@dataclass(frozen=True, slots=True)
class Worst:
    """A rate that a budget is asked of: the class, whether of the wing command, count, and upper 95 % bound, 1/h."""

    exposure: str
    wings: bool
    count: int
    high: float

    @property
    def what(self) -> str:
        """Rate and class, for people."""
        return f"{'false wing commands' if self.wings else 'false alarms'}, {SAID[self.exposure]}"


def asked(name: str, found: FalseAlarms) -> list[Worst]:
    """What a budget is asked of in a class of exposure."""
    wings = Worst(name, True, found.commands, found.commands_interval()[1])
    return [Worst(name, False, found.alarms, found.interval()[1]), wings] if name in ALONE else [wings]


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
        """Whether the fresh seed shows the budget to be kept in the worst class, with its upper 95 % bound."""
        return self.tuned.worst().high <= self.budget


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
        False alarms and false wing commands in every class of exposure, 1/h.
    seed
        Of launches and disturbances that are tuned on; the next one scores.
    trials
        Launches for tuning; twice as many score.
    workers, progress
        As of `uavsim.studies.workers.spread`; the result does not depend on them.

    Raises
    ------
    ValueError
        A scenario whose launch is to be missed; a budget that cannot be shown or kept; an accelerometer too slow for
        the disturbances.
    """
    check(scenario)
    search = _Search(scenario, own_keys(scenario.detector, kind), budget, seed, trials, workers, progress)
    first = search.best(search.grid())
    best = search.best(search.finer(first), first)
    return search.scored(best)


def check(scenario: Scenario) -> None:
    """Refuse a scenario whose launch is not to be recognised.

    Raises
    ------
    ValueError
        One line that says what to do.
    """
    if scenario.expect in REFUSED:
        raise ValueError(
            f"{scenario.name}: expects {scenario.expect!r}, so a detector that recognises its launch is wrong; tune "
            'for launches that must be recognised, e.g. catapult, or copy it with expect = "cruise" if these must be'
        )


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
    """Settings that keep the budget, the next lower level tried, and alarms in the mix."""

    settings: DetectorSettings
    below: float
    alarms: FalseAlarms


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Settings that keep the budget, the grid's value of the second of them, and what they see."""

    keeper: _Keeper
    second: float
    verdicts: Verdicts
    alarms: dict[str, FalseAlarms]

    @property
    def rank(self) -> tuple[float, ...]:
        """Smaller is better."""
        result, wings = scored(self.verdicts), opened(self.verdicts)
        latencies = [inf if x != x else x for x in (result["onset_median"], result["onset_p95"])]
        return (-wings["commanded"], -result["detected"], *latencies, level(self.keeper.settings))


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
        self.hours, self._share = hours_for(budget), MARGIN * budget
        self._broken: Counter[str] = Counter()
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
        verdicts = self._tried([one.settings for one in kept], self.seed, self.trials, 0.05)
        found = [
            _Candidate(one, self._nearest(one.settings), verdict, {"mix": one.alarms})
            for one, verdict in zip(kept, verdicts, strict=True)
        ]
        for one in sorted(found, key=lambda candidate: candidate.rank):
            if known is not None and known.rank <= one.rank:
                break
            every = self._every_class(one)
            if self._keeps(every):
                return replace(one, alarms=every)
        if known is not None:
            return known
        raise ValueError(
            f"--false-alarms = {self.budget:g}: none of {len(flat)} settings of {self.base.kind} keeps it; hardest is "
            f"{self._hardest()}; allow more, or try another --detector"
        )

    def _every_class(self, one: _Candidate) -> dict[str, FalseAlarms]:
        """Alarms in the mix, as counted, and in the other classes over as many hours."""
        alarms = self._alarms([one.keeper.settings], self.seed, dict.fromkeys(LOOK, self.hours), 0.0)
        return {**one.alarms, **{name: found[0] for name, found in alarms.items()}}

    def _keeps(self, alarms: dict[str, FalseAlarms]) -> bool:
        """Whether the upper bounds are within the share of the budget, in every class that is asked."""
        broken = {one.what for name, found in alarms.items() for one in asked(name, found) if one.high > self._share}
        self._broken.update(broken)
        return not broken

    def _hardest(self) -> str:
        return self._broken.most_common(1)[0][0] if self._broken else "that none suits the sensor and stroke"

    def _kept(self, rows: list[list[DetectorSettings]]) -> list[_Keeper]:
        """For each row the lowest level that is silent in a first look and keeps the budget in the mix.

        A part of the hours shows which levels are far too low; of the others the lowest few are counted in full, as
        alarms fall with the level.
        """
        flat = [chosen for row in rows for chosen in row]
        if not flat:
            return []
        seen = self._alarms(flat, self.seed, {"mix": self.hours / SCREEN, **LOOK}, 0.15)
        silent = [self._silent({name: found[i] for name, found in seen.items()}) for i in range(len(flat))]
        picked, at = [], 0
        for row in rows:
            loud = [i for i in range(len(row)) if not silent[at + i]]
            first = loud[-1] + 1 if loud else 0
            picked += [(row, i) for i in range(len(row))[first : first + FULL]]
            at += len(row)
        full = list(dict.fromkeys(row[i] for row, i in picked))
        counted = dict(
            zip(full, self._alarms(full, self.seed, {"mix": self.hours}, 0.2)["mix"] if full else (), strict=True)
        )
        kept: dict[int, _Keeper] = {}
        for row, i in picked:
            if self._keeps({"mix": counted[row[i]]}):
                below = level(row[i - 1]) if i else 0.7 * level(row[i])
                kept.setdefault(id(row), _Keeper(row[i], below, counted[row[i]]))
        return list(kept.values())

    def _silent(self, seen: dict[str, FalseAlarms]) -> bool:
        """Whether a first look counts no more than the share of the budget leaves room for, in every class."""
        loud = {
            one.what
            for name, found in seen.items()
            for one in asked(name, found)
            if one.count > self._share * found.hours
        }
        self._broken.update(loud)
        return not loud

    def _nearest(self, settings: DetectorSettings) -> float:
        """The grid's own value of the second setting, which was rounded."""
        if self.second is None:
            return self.values[0]
        value = float(get(settings, self.second.key))
        return min(self.values, key=lambda own: abs(own - value))

    def scored(self, best: _Candidate) -> Tuned:
        """Score what was found, and what was before, on the fresh seed."""
        both = [best.keeper.settings, self.base]
        alarms = self._alarms(both, self.fresh, dict.fromkeys(CLASSES, self.hours), 0.2)
        verdicts = self._tried(both, self.fresh, 2 * self.trials, 0.1)
        tuned, was = (
            Score(scored(verdict) | opened(verdict), {name: found[i] for name, found in alarms.items()})
            for i, verdict in enumerate(verdicts)
        )
        own = Score(scored(best.verdicts) | opened(best.verdicts), best.alarms)
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
            computer=self.scenario.flight_computer,
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
            computer=self.scenario.flight_computer,
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
