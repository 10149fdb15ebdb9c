"""Ports and sensors that fail in flight: how soon it is flagged, what is made of it, and how often for nothing.

Each case is a packaged scenario, its overrides and a fault whose beginning is drawn from the flight's seed, so that
(case, seed) fixes every bit. A flight tells

    delay      from the fault to the event `airspeed_fault`, s; of a port that ice shuts, from when it is shut
    false      flags before the fault, or in a flight without one
    unseen     from the instant at which the airspeed that is told is 2 m/s off to the flag, s; 0 if flagged before
    coverage   share of valid estimates after the flag whose true error is within 1.96 of their standard deviations
    told       the same of all estimates after the flag, valid or not: without a static port none is valid, and what is
               told then still has to be right

Shares have Clopper-Pearson intervals.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import inf, nan
from typing import Any

import numpy as np

from sensors import Streams
from uavsim.cosim import Cosimulation
from uavsim.scenario import load_scenario
from uavsim.studies.engine import engine, processes
from uavsim.studies.intervals import share_interval

OFF = 2.0  # m/s, true error from which on a fault has to be seen
WITHIN = 2.0  # s
CLIMBS = ("flight_computer.height=300", "flight_computer.climb_pitch_deg=4", "flight_computer.height_gain=0.01")
GUSTS = (  # a wind whose turbulence has σ_u 1 m/s at 60 m, which is where it is flown
    "environment.gust_speed=0",
    "environment.wind_speed=6.49",
    "environment.turbulence_wind_20ft=6.49",
    "flight_computer.height=60",
)


@dataclass(frozen=True, slots=True)
class Case:
    """What is flown.

    Attributes
    ----------
    scenario : str
        Packaged name.
    overrides : tuple of str
        ``KEY=VALUE`` each.
    where : str or None
        Key of the list of faults; None: nothing breaks.
    fault : str
        The fault but for its times, in TOML.
    window : (s, s)
        Within which it begins.
    lasts : float
        s.
    late : float
        How long after its beginning it has its effect, s.
    channel : str
        Which pressure it falsifies.
    orders : tuple of (s, str, float)
        When, and which of the flight computer's settings is changed to what.
    """

    scenario: str
    overrides: tuple[str, ...] = ()
    where: str | None = None
    fault: str = ""
    window: tuple[float, float] = (9.5, 18.0)
    lasts: float = inf
    late: float = 0.0
    channel: str = "total"
    orders: tuple[tuple[float, str, float], ...] = ()


TOTAL, STATIC = "air_data.total_port.faults", "air_data.static_port.faults"
BLOCKED = 'kind="blocked"'
DOWN = ((16.0, "height", 8.0),)
CASES = {
    "healthy-gusty": Case("gusty", ("duration=25",)),
    "healthy-calm": Case("catapult", ("duration=40",)),
    "healthy-climb": Case("catapult", ("duration=28", *CLIMBS), orders=DOWN),
    "healthy-speeds": Case("catapult", ("duration=32",), orders=((14.0, "airspeed", 26.0), (22.0, "airspeed", 38.0))),
    "blocked-gusts": Case("gusty", ("duration=25", *GUSTS), TOTAL, BLOCKED),
    "blocked-climb": Case("catapult", ("duration=25", *CLIMBS), TOTAL, BLOCKED, (8.5, 18.0)),
    "blocked-descent": Case("catapult", ("duration=28", *CLIMBS), TOTAL, BLOCKED, (17.0, 18.5), orders=DOWN),
    "blocked-calm": Case("catapult", ("duration=40",), TOTAL, BLOCKED, (14.0, 18.0)),
    "blocked-for-3-s": Case("gusty", ("duration=30", *GUSTS), TOTAL, BLOCKED, (9.5, 15.0), lasts=3.0),
    "iced-climb": Case("catapult", ("duration=25", *CLIMBS), TOTAL, 'kind="ice",duration=4.0', (7.0, 12.0), late=4.0),
    "leak-gusts": Case("gusty", ("duration=25", *GUSTS), TOTAL, 'kind="leak",time_constant=1.0|kind="blocked"'),
    "slow-leak-calm": Case("catapult", ("duration=25",), TOTAL, 'kind="leak",time_constant=5.0|kind="blocked"'),
    "slow-leak-gusts": Case("gusty", ("duration=25", *GUSTS), TOTAL, 'kind="leak",time_constant=5.0|kind="blocked"'),
    "stuck": Case("catapult", ("duration=25",), "air_data.total.faults", 'kind="stuck"'),
    "spikes": Case("gusty", ("duration=25",), "air_data.total.faults", 'kind="spike",size=500.0,probability=0.02'),
    "static-climb": Case("catapult", ("duration=25", *CLIMBS), STATIC, BLOCKED, (8.5, 16.0), channel="static"),
    "static-gusts": Case("gusty", ("duration=25", *GUSTS), STATIC, BLOCKED, (9.5, 14.0), channel="static"),
    "static-stuck": Case("catapult", ("duration=25",), "air_data.static.faults", 'kind="stuck"', channel="static"),
}


@dataclass(frozen=True, slots=True)
class FaultFlight:
    """What became of one flight; times of none are NaN.

    Attributes
    ----------
    seed : int
    fault, flagged, recovered : float
        When the fault had its effect, and the first flag and return after it, s.
    channel, kind : str
        What was flagged first.
    false : int
        Flags before.
    off : float
        When the airspeed told was first 2 m/s off after the fault, s.
    climb : float
        Mean climb over the 2 s after the fault, m/s.
    outcome : str
    coverage, valid, error : float
        After the flag: share of valid estimates within 1.96 standard deviations; how long they were valid, s; the
        greatest error of a valid one, m/s.
    told_coverage, told_error : float
        The same share and error of all estimates after the flag, whatever `valid` says.
    """

    seed: int
    fault: float
    flagged: float
    recovered: float
    channel: str
    kind: str
    false: int
    off: float
    climb: float
    outcome: str
    coverage: float
    valid: float
    error: float
    told_coverage: float = nan
    told_error: float = nan

    @property
    def delay(self) -> float:
        """From the fault to the flag, s; inf if there was none."""
        return self.flagged - self.fault if self.flagged == self.flagged else inf

    @property
    def unseen(self) -> float:
        """How long the airspeed told was off by 2 m/s before the flag, s; 0 if it never was, inf if never flagged."""
        if self.off != self.off:
            return 0.0
        return max(0.0, self.flagged - self.off) if self.flagged == self.flagged else inf


def fly_case(case: Case, seed: int, extra: tuple[str, ...] = ()) -> FaultFlight:
    """Fly one flight of a case."""
    begins, flight = flown_case(case, seed, extra)
    return _judge(case, seed, begins + case.late, flight)


def flown_case(case: Case, seed: int, extra: tuple[str, ...] = ()) -> tuple[float, Cosimulation]:
    """Fly one flight of a case; return when its fault began, s (NaN if it has none), and the flight to its end."""
    begins = nan
    overrides = [*case.overrides, *extra]
    if case.where is not None:
        begins = round(float(Streams(seed)("study.fault").uniform(*case.window)), 3)
        stop = f",stop={begins + case.lasts}" if case.lasts < inf else ""
        rows = ",".join(f"{{{fault},start={begins}{stop}}}" for fault in case.fault.split("|"))
        overrides.append(f"{case.where}=[{rows}]")
    flight = Cosimulation(load_scenario(case.scenario, overrides=overrides).with_seed(seed))
    computer = flight.onboard.computer
    for when, setting, value in case.orders:
        flight.advance(round(when * flight.scenario.plant.step_rate) - flight.plant.k)
        computer.settings = replace(computer.settings, **{setting: value})
    flight.advance(flight.steps)
    return begins, flight


def _judge(case: Case, seed: int, fault: float, flown: Cosimulation) -> FaultFlight:
    flight = flown.finish()
    truth = flight.truth
    flags = [e for e in flight.events if e["event"] == "airspeed_fault"]
    effect = fault - case.late  # a flag while the ice grows is none before the fault
    after = [e for e in flags if e["t"] >= effect]
    first: dict[str, Any] = after[0] if after else {"t": nan, "channel": "", "kind": ""}
    back = [e["t"] for e in flight.events if e["event"] == "airspeed_recovered" and e["t"] >= first["t"]]
    t, speed, sd, valid = (flight.estimate[c].to_numpy() for c in ("t", "airspeed", "airspeed_sd", "valid"))
    error = speed - np.interp(t, truth["t"].to_numpy(), truth["airspeed"].to_numpy())
    off = t[(t >= effect) & (np.abs(error) > OFF) & ~(t >= first["t"])]
    told = t > first["t"]  # of that reading itself it was told before the port was judged
    trusted = told & valid.astype(bool)
    covered, size = np.abs(error) < 1.96 * sd, np.abs(error)
    span = truth[(truth["t"] >= fault) & (truth["t"] < fault + WITHIN)]
    return FaultFlight(
        seed=seed,
        fault=fault,
        flagged=first["t"],
        recovered=back[0] if back else nan,
        channel=first["channel"],
        kind=first["kind"],
        false=len(flags) - len(after),
        off=float(off[0]) if off.size else nan,
        climb=float(-span["vd"].mean()) if len(span) else nan,
        outcome=flight.score["outcome"],
        coverage=float(np.mean(covered[trusted])) if trusted.any() else nan,
        valid=float(trusted.sum() * np.median(np.diff(t))),
        error=float(size[trusted].max()) if trusted.any() else nan,
        told_coverage=float(np.mean(covered[told])) if told.any() else nan,
        told_error=float(size[told].max()) if told.any() else nan,
    )


def campaign(
    name: str,
    flights: int,
    *,
    first_seed: int = 1,
    workers: int | None = None,
    extra: tuple[str, ...] = (),
    progress: Callable[[float], None] | None = None,
) -> list[FaultFlight]:
    """Fly a case with the seeds `first_seed` … and on, in several processes.

    Raises
    ------
    ValueError
        If there is no such case, or no flight.
    """
    if name not in CASES:
        raise ValueError(f"unknown case {name!r}; there are {', '.join(CASES)}")
    if flights < 1:
        raise ValueError(f"flights: {flights} is not at least 1")
    seeds = range(first_seed, first_seed + flights)
    flown: dict[int, FaultFlight] = {}

    def done(results: list[tuple[int, FaultFlight]]) -> None:
        flown.update(results)
        if progress is not None:
            progress(len(flown) / flights)

    with engine(workers=processes(workers, flights)) as crew:
        left = crew.each(partial(_fly_seed, name, extra), seeds, done=done)
    if left:
        raise RuntimeError(f"seed {seeds[left[0].position]} of {name}: {left[0].why}")
    return [flown[position] for position in range(flights)]


def _fly_seed(name: str, extra: tuple[str, ...], seed: int) -> FaultFlight:
    return fly_case(CASES[name], seed, extra)


@dataclass(frozen=True, slots=True)
class Summary:
    """A campaign's counts.

    Attributes
    ----------
    flights, false, crashed, missed, blamed, recovered : int
        Of the flights those with a flag for no fault, those that crashed or diverged, those never flagged, those in
        which the right pressure was flagged first, those in which one was taken back.
    within, seen : int
        Flagged within 2 s of the fault; within 2 s of the error passing 2 m/s.
    delays : tuple of float
        Median, 99th percentile and greatest delay, s.
    coverage, error, valid : float
        Mean of the flights' coverage, greatest error of a valid estimate after a flag, m/s, median time valid, s.
    told_coverage, told_error : float
        The same mean and greatest error of all estimates after a flag, valid or not.
    """

    flights: int
    false: int
    crashed: int
    missed: int
    blamed: int
    recovered: int
    within: int
    seen: int
    delays: tuple[float, float, float]
    coverage: float
    error: float
    valid: float
    told_coverage: float
    told_error: float

    def interval(self, count: int) -> tuple[float, float]:
        """Clopper-Pearson 95 % interval of a count's share."""
        return share_interval(count, self.flights)


def summarise(name: str, flown: list[FaultFlight]) -> Summary:
    """Count."""
    case = CASES[name]
    delays = np.sort([f.delay for f in flown])
    flagged = [f for f in flown if f.delay < inf]
    told = [f for f in flagged if f.coverage == f.coverage]  # without a static port no airspeed is valid

    def share(q: float) -> float:
        return float(delays[min(len(delays) - 1, int(q * len(delays)))])

    return Summary(
        flights=len(flown),
        false=sum(f.false > 0 for f in flown) if case.where else sum(f.false > 0 or f.flagged > 0.0 for f in flown),
        crashed=sum(f.outcome in ("crashed", "diverged") for f in flown),
        missed=len(flown) - len(flagged),
        blamed=sum(f.channel == case.channel for f in flagged),
        recovered=sum(f.recovered == f.recovered for f in flown),
        within=sum(f.delay <= WITHIN for f in flown),
        seen=sum(f.unseen <= WITHIN for f in flown),
        delays=(share(0.5), share(0.99), float(delays[-1])),
        coverage=float(np.mean([f.coverage for f in told])) if told else nan,
        error=float(np.max([f.error for f in told])) if told else nan,
        valid=float(np.median([f.valid for f in flagged])) if flagged else nan,
        told_coverage=float(np.mean([f.told_coverage for f in flagged])) if flagged else nan,
        told_error=float(np.max([f.told_error for f in flagged])) if flagged else nan,
    )
