"""Nothing is broken: each combination of parts, weather, tare, temperature and noise once.

    7 accelerometers × 7 pressure parts (both ports) × 5 winds × 2 tares × 3 temperatures × 3 noises = 4410 flights

over `catapult`. A part of the set has each level of each factor as often as the whole has it, to within one flight: its
levels are dealt out and shuffled factor by factor (a Latin square without its rows), each combination at most once.

The winds are those of the mean at 20 ft; `gusty` is the scenario of that name, with its turbulence, its single gust of
6 m/s, its height and its minute of flight (in 35 s at 60 m the air alone takes every second flight out of the 2 m/s
that `cruise` asks for). The others have no turbulence: there, as in calm air, the filter assumes a least gust that the
air does not have, so that in cruise a share above 0.99 is within the bars.
"""

from collections.abc import Sequence
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.score_keys import PHASES
from uavsim.studies.certify.coverage import holm, mean_above, mean_below
from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.tasks import Task
from uavsim.studies.certify.verdict import Check, Verdict
from uavsim.studies.intervals import rate_interval, share_interval

Array = NDArray[np.float64]

ACCELEROMETERS = ("adxl345", "adxl359", "bmi088", "h3lis331dl", "icm-42688-p", "lsm6dso32", "mpu-6050")
PRESSURES = ("bmp280", "bmp388", "bmp390", "bmp581", "dps368", "lps22df", "ms5611")
GUSTY = (
    "environment.wind_speed=8.8",
    "environment.wind_from_deg=0",
    "environment.turbulence_wind_20ft=8.8",
    "environment.gust_speed=6",
    "environment.gust_length_s=2.5",
    "environment.gust_delay=6",
    "flight_computer.height=40",
    "flight_computer.climb_pitch_deg=6",
    "flight_computer.height_gain=0.004",
    "duration=60",
)
WINDS: dict[str, tuple[str, ...]] = {
    "calm": (),
    "gusty": GUSTY,
    "cross 10": ("environment.wind_speed=10", "environment.wind_from_deg=90"),
    "tail 8": ("environment.wind_speed=8", "environment.wind_from_deg=180"),
    "head 15": ("environment.wind_speed=15", "environment.wind_from_deg=0"),
}
TEMPERATURES = {"-20 °C": -35.0, "15 °C": 0.0, "40 °C": 25.0}  # K from the standard atmosphere
FACTORS: dict[str, tuple[Any, ...]] = {
    "accelerometer": ACCELEROMETERS,
    "pressure": PRESSURES,
    "wind": tuple(WINDS),
    "tare": ("covered", "open"),
    "temperature": tuple(TEMPERATURES),
    "noise": ("0.3", "1", "3"),
}
SIZE = 4410
BOUNDED = 5  # of so many flights one has its Cramér-Rao bound computed
FEW = 210  # flights of a part up to which each has it: of fewer a fifth would say nothing of a level

LOW, HIGH = 0.90, 0.99  # of the coverage
LEAST_VALID = 0.99
FEWEST = 400  # flights of a level below which its figures are not judged
FARTHEST = 6.0  # standard deviations
MISLEADING = 1.0  # s
FALSE = 1e-3  # upper bound of the share of flights with a false flag
HOLM = 0.01
TIMES_BEFORE, TIMES_RMSE, TIMES_BOUND = 1.2, 1.3, 1.1
FEWEST_IN_A_CELL = 12  # flights of a pair of levels below which nothing could be shown
WORST = 12
NAMED = 6  # levels that a check names


def combination(number: int) -> dict[str, str]:
    """Return the levels of a combination, 0 … 4409."""
    index = np.unravel_index(number, [len(levels) for levels in FACTORS.values()])
    return {name: levels[int(i)] for (name, levels), i in zip(FACTORS.items(), index, strict=True)}


def subset(count: int, seed: int) -> list[int]:
    """Return the numbers of a part of the set in which each level has its share."""
    if not 1 <= count <= SIZE:
        raise ValueError(f"a sample of {count}: must be from 1 to {SIZE}")
    if count == SIZE:
        return list(range(SIZE))
    shape = [len(levels) for levels in FACTORS.values()]
    generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(count,)))
    if count > SIZE // 2:
        return sorted(generator.permutation(SIZE)[:count].tolist())  # of so many any will do
    dealt = []
    for levels in shape:
        column = np.concatenate([generator.permutation(levels) for _ in range(-(-count // levels))])[:count]
        dealt.append(generator.permutation(column))
    while True:  # a combination that came twice swaps one level with another flight
        numbers = np.ravel_multi_index(tuple(dealt), shape)
        _, first = np.unique(numbers, return_index=True)
        twice = np.setdiff1d(np.arange(count), first)
        if not twice.size:
            break
        for one in twice:
            factor, other = int(generator.integers(len(shape))), int(generator.integers(count))
            dealt[factor][[one, other]] = dealt[factor][[other, one]]
    return sorted(int(number) for number in numbers)


def task(number: int, seed: int, bounded: bool = False) -> Task:
    """Return the flight of a combination; every fifth has its bound computed, or it is asked for."""
    levels = combination(number)
    overrides = (
        f"accelerometer.preset={levels['accelerometer']}",
        f"accelerometer.noise_scale={levels['noise']}",
        *(
            f"air_data.{port}.{key}={value}"
            for port in ("total", "static")
            for key, value in (("preset", levels["pressure"]), ("noise_scale", levels["noise"]))
        ),
        *WINDS[levels["wind"]],
        f"air_data.tare={levels['tare']}",
        f"environment.temperature_offset={TEMPERATURES[levels['temperature']]:g}",
    )
    return Task(number, "catapult", overrides, seed, levels, bounded=bounded or number % BOUNDED == 0)


def tasks(seed: int, count: int | None = None) -> list[Task]:
    """Return the set, or a part of it."""
    size = SIZE if count is None else count
    return [task(number, seed, bounded=size <= FEW) for number in subset(size, seed)]


# -- what came ---------------------------------------------------------------------------------------------------------


def judge(rows: Sequence[Row], seed: int, before: dict[str, Any] | None = None) -> Verdict:
    """Hold the set against what is asked of it.

    Parameters
    ----------
    rows
        Of its flights.
    seed
        Its root, for the commands of the worst.
    before
        The verdict of an earlier version, whose standard deviations are the measure where it was sound.
    """
    flown = [row for row in rows if row["outcome"] != "refused"]
    levels = [level_row(flown, factor, level) for factor in FACTORS for level in FACTORS[factor]]
    checks = [*_outcomes(rows, flown), *_flags(flown), _farthest(flown), _misleading(flown), *_readiness(flown)]
    checks += _coverage(levels)
    checks.append(_cells(flown))
    checks += _fat(levels, before)
    tables = {
        "levels": levels,
        "false flags": flag_rows(flown),
        "phases": phase_rows(flown),
        "readiness": readiness_rows(flown),
    }
    return Verdict(tuple(checks), tables, worst(rows, seed))


def shares(flown: Sequence[Row], phase: str, part: str, whole: str) -> Array:
    """One sum of each flight in a phase over another one, NaN where that is 0; shape (flights,)."""
    counts = np.array([(row.get(f"{phase}.{part}") or 0, row.get(f"{phase}.{whole}") or 0) for row in flown], float)
    some = counts.reshape(-1, 2)
    found: Array = np.full(len(some), np.nan)
    np.divide(some[:, 0], some[:, 1], out=found, where=some[:, 1] > 0.0)
    return found


VALID_ROWS, ALL_ROWS = ("within_valid", "valid"), ("within", "rows")  # a coverage's parts


def _sum(flown: Sequence[Row], key: str) -> float:
    return float(sum(row.get(key) or 0.0 for row in flown))


def _root(square: float, count: float) -> float | None:
    return float(np.sqrt(square / count)) if count else None


def _mean(values: Array) -> float | None:
    there = values[np.isfinite(values)]
    return float(there.mean()) if there.size else None


def phase_figures(flown: Sequence[Row], phase: str) -> dict[str, float | None]:
    """Return what is told of some flights in one phase."""
    covered = shares(flown, phase, *VALID_ROWS)
    there = covered[np.isfinite(covered)]
    sd = np.array([row[f"{phase}.sd"] for row in flown if row.get(f"{phase}.sd") is not None])
    bounded = [row for row in flown if row.get(f"{phase}.bound") is not None]
    least = _root(_sum(bounded, f"{phase}.bound"), 1.0)
    got = _root(_sum(bounded, f"{phase}.bounded_square"), 1.0)
    return {
        "coverage": _mean(covered),
        "error": float(there.std(ddof=1) / np.sqrt(there.size)) if there.size > 1 else None,
        "coverage_all": _mean(shares(flown, phase, *ALL_ROWS)),
        "valid": _mean(shares(flown, phase, "valid", "rows")),
        "sd": float(np.median(sd)) if sd.size else None,
        "rmse": _root(_sum(flown, f"{phase}.square"), _sum(flown, f"{phase}.counted")),
        "to_bound": got / least if got is not None and least else None,
    }


def level_row(flown: Sequence[Row], factor: str, level: str) -> dict[str, Any]:
    """Return the figures of a level, pooled over all others."""
    some = [row for row in flown if row[factor] == level]
    row: dict[str, Any] = {"factor": factor, "level": level, "flights": len(some)}
    row["cruise"] = sum(one["outcome"] == "cruise" for one in some)
    row["flagged"] = sum(one["flags"] > 0 for one in some)
    for phase in PHASES:
        row |= {f"{phase}.{key}": value for key, value in phase_figures(some, phase).items()}
    return row


def phase_rows(flown: Sequence[Row]) -> list[dict[str, Any]]:
    """Return the figures of all flights, a row a phase."""
    return [{"phase": phase, **phase_figures(flown, phase)} for phase in PHASES]


def flag_rows(flown: Sequence[Row]) -> list[dict[str, Any]]:
    """Return false flags of all flights and of each part: how many, and 95 % bounds per flight and per hour."""
    found = []
    for name, some in _pools(flown):
        flagged, events = sum(row["flags"] > 0 for row in some), int(_sum(some, "flags"))
        hours = _sum(some, "hours")
        found.append(
            {
                "of": name,
                "flights": len(some),
                "flagged": flagged,
                "at most, of flights": share_interval(flagged, len(some))[1],
                "hours": hours,
                "at most, per hour": rate_interval(events, hours)[1] if hours > 0.0 else None,
            }
        )
    return found


def _pools(flown: Sequence[Row]) -> list[tuple[str, Sequence[Row]]]:
    """Return all flights and those of each level that has flown, by name."""
    pools: list[tuple[str, Sequence[Row]]] = [("all", flown)]
    for factor, levels in FACTORS.items():
        pools += [(f"{factor} {level}", [row for row in flown if row[factor] == level]) for level in levels]
    return [(name, some) for name, some in pools if some]


def readiness_rows(flown: Sequence[Row]) -> list[dict[str, Any]]:
    """Return how often a sound aircraft was not ready, of all flights and of each level, with 95 % bounds."""
    found = []
    for name, some in _pools(flown):
        told = [row for row in some if row.get("ready") is not None]
        wrong = sum(not row["ready"] for row in told)
        low, high = share_interval(wrong, len(told)) if told else (None, None)
        found.append(
            {"of": name, "flights": len(some), "told": len(told), "not ready": wrong, "low": low, "high": high}
        )
    return found


def _outcomes(rows: Sequence[Row], flown: Sequence[Row]) -> list[Check]:
    counts: dict[str, int] = {}
    for row in rows:
        counts[row["outcome"]] = counts.get(row["outcome"], 0) + 1
    told = ", ".join(f"{name} {count}" for name, count in sorted(counts.items(), key=lambda one: -one[1]))
    good = counts.get("cruise", 0)
    return [Check("all that are not refused end in cruise", f"{len(flown)} of {len(flown)}", told, good == len(flown))]


def _flags(flown: Sequence[Row]) -> list[Check]:
    flagged = sum(row["flags"] > 0 for row in flown)
    low, high = share_interval(flagged, len(flown))
    hours = _sum(flown, "hours")
    rate = rate_interval(int(_sum(flown, "flags")), hours)[1]
    found = f"{flagged} of {len(flown)}; {100 * low:.3f} … {100 * high:.3f} % a flight, ≤ {rate:.3g} an hour"
    met = False if flagged else (True if high <= FALSE else None)
    return [Check("false flags", "0, upper bound 0.1 % a flight", found, met, "two-sided 95 %, Clopper-Pearson")]


def _farthest(flown: Sequence[Row]) -> Check:
    ratios = np.array([row["worst_ratio"] for row in flown])
    over = int(np.sum(ratios > FARTHEST))
    found = f"{over} flights over; greatest {ratios.max(initial=0.0):.3g}"
    return Check("a valid airspeed off by more than 6 sd", "none", found, over == 0)


def _misleading(flown: Sequence[Row]) -> Check:
    count = sum((row.get("wrong_for") or 0.0) > MISLEADING for row in flown)
    longest = max((row.get("wrong_for") or 0.0 for row in flown), default=0.0)
    found = f"{count} flights; longest {longest:.2f} s"
    return Check("valid and more than 3 m/s wrong for more than 1 s", "none", found, count == 0)


def _readiness(flown: Sequence[Row]) -> list[Check]:
    told = [row for row in flown if row.get("ready") is not None]
    if not told:
        return [Check("not ready though nothing is broken", "told, none", "readiness is not told", None)]
    wrong = sum(not row["ready"] for row in told)
    _, high = share_interval(wrong, len(told))
    found = f"{wrong} of {len(told)}, at most {100 * high:.2f} %"
    return [Check("not ready though nothing is broken", "told, none", found, wrong == 0)]


def _some(names: Sequence[str]) -> str:
    """Return the first of some names and how many more there are."""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more if names else "none"


def _coverage(levels: Sequence[dict[str, Any]]) -> list[Check]:
    """Coverage of ±1.96 sd of each level, the flight being the unit."""
    checks = []
    for phase in PHASES:
        for rows_of, key in (("valid rows", "coverage"), ("all rows", "coverage_all")):
            outside = []
            known = [row for row in levels if row[f"{phase}.{key}"] is not None]
            for row in known:
                value, calm = row[f"{phase}.{key}"], row["level"] == "calm"
                if value < LOW or (value > HIGH and not calm):
                    outside.append(f"{row['factor']} {row['level']} {value:.3f}")
            few = any(row["flights"] < FEWEST for row in levels)
            values = [row[f"{phase}.{key}"] for row in known]
            spread = f"{min(values):.3f} … {max(values):.3f}" if values else "none"
            found = f"{spread}; outside: {_some(outside)}"
            met = None if not known or (few and not outside) else not outside
            wanted = f"{LOW:.2f} … {HIGH:.2f}, calm ≥ {LOW:.2f}"
            note = f"levels of fewer than {FEWEST} flights" if few else ""
            checks.append(Check(f"mean coverage of each level, {phase}, {rows_of}", wanted, found, met, note))
    return checks


def cells(flown: Sequence[Row]) -> list[dict[str, Any]]:
    """Return the tests of all pairs of levels in each phase, with the p-value of each."""
    tests: list[dict[str, Any]] = []
    covered = {phase: shares(flown, phase, *VALID_ROWS) for phase in PHASES}
    of = {factor: np.array([row[factor] for row in flown]) for factor in FACTORS}
    for one, other in combinations(FACTORS, 2):
        for a, b in product(FACTORS[one], FACTORS[other]):
            chosen = (of[one] == a) & (of[other] == b)
            if chosen.sum() < FEWEST_IN_A_CELL:
                continue
            for phase, all_values in covered.items():
                values = all_values[chosen]
                cell = {"cell": f"{a}, {b}", "phase": phase, "flights": int(chosen.sum()), "coverage": _mean(values)}
                tests.append({**cell, "side": f"below {LOW:.2f}", "p": mean_below(values, LOW)})
                if "calm" not in (a, b):
                    tests.append({**cell, "side": f"above {HIGH:.2f}", "p": mean_above(values, HIGH)})
    for test, refused in zip(tests, holm([float(test["p"]) for test in tests], HOLM), strict=True):
        test["shown"] = refused
    return tests


def _cells(flown: Sequence[Row]) -> Check:
    tests = cells(flown)
    shown = sorted((test for test in tests if test["shown"]), key=lambda test: float(test["p"]))
    named = "; ".join(
        f"{test['cell']}, {test['phase']} {test['coverage']:.3f} ({test['flights']})" for test in shown[:WORST]
    )
    found = f"{len(shown)} of {len(tests)} shown to be outside{': ' + named if named else ''}"
    note = "pairs of levels; bounded means by betting, flights as units, Holm at 1 %"
    return Check("single cells", "none shown outside", found, not shown, note)


def _fat(levels: Sequence[dict[str, Any]], before: dict[str, Any] | None) -> list[Check]:
    """No way out by bars that are too wide or by airspeeds that are not valid."""
    checks = []
    for phase in PHASES[1:]:
        least = [row for row in levels if row[f"{phase}.valid"] is not None and row[f"{phase}.valid"] < LEAST_VALID]
        values = [row[f"{phase}.valid"] for row in levels if row[f"{phase}.valid"] is not None]
        low = f"least {min(values):.4f}" if values else "none"
        named = [f"{row['factor']} {row['level']} {row[f'{phase}.valid']:.3f}" for row in least]
        found = f"{low}; below: {_some(named)}"
        checks.append(Check(f"valid share of each level, {phase}", f"≥ {LEAST_VALID:g}", found, not least))
    checks += [_wide(levels, before, phase) for phase in PHASES]
    for phase in PHASES[1:]:
        over = [row for row in levels if (row[f"{phase}.to_bound"] or 0.0) > TIMES_BOUND]
        values = [row[f"{phase}.to_bound"] for row in levels if row[f"{phase}.to_bound"] is not None]
        named = [f"{row['factor']} {row['level']} {row[f'{phase}.to_bound']:.2f}" for row in over]
        found = f"greatest {max(values):.2f}; above: {_some(named)}" if values else "none"
        met = None if not values else not over
        checks.append(Check(f"RMSE/√PCRB of each level, {phase}", f"≤ {TIMES_BOUND:g}", found, met))
    return checks


def _wide(levels: Sequence[dict[str, Any]], before: dict[str, Any] | None, phase: str) -> Check:
    """Whether the median claimed standard deviation is at most 1.2 times the earlier one where that was sound."""
    was = {(row["factor"], row["level"]): row for row in (before or {}).get("tables", {}).get("levels", ())}
    over, most = [], 0.0
    for row in levels:
        sd, rmse, old = row[f"{phase}.sd"], row[f"{phase}.rmse"], was.get((row["factor"], row["level"]))
        if sd is None or rmse is None:
            continue
        sound = old is not None and is_sound(old, phase)
        limit = TIMES_BEFORE * old[f"{phase}.sd"] if old is not None and sound else TIMES_RMSE * rmse
        most = max(most, sd / limit)
        if sd > limit:
            named = f"{row['factor']} {row['level']} {sd:.3f}/{limit:.3f}"
            over.append(named + (" before" if sound else " rmse"))
    wanted = f"≤ {TIMES_BEFORE:g} × before where sound, else ≤ {TIMES_RMSE:g} × RMSE"
    found = f"greatest share of the limit {most:.2f}; above: {_some(over)}"
    return Check(f"median claimed sd of each level, {phase}", wanted, found, not over if was else None)


def is_sound(row: dict[str, Any], phase: str) -> bool:
    """Whether a level's bars held in an earlier version: coverage and valid share as asked."""
    covered, valid = row[f"{phase}.coverage"], row[f"{phase}.valid"]
    return bool(covered is not None and covered >= LOW and (phase == PHASES[0] or (valid or 0.0) >= LEAST_VALID))


def worst(rows: Sequence[Row], seed: int) -> list[dict[str, Any]]:
    """Return flights to look at: refused, not in cruise, flagged, or far off their bars."""
    found = []
    for row in rows:
        wrong = []
        if row["outcome"] != "cruise":
            wrong.append(row["outcome"])
        if row.get("flags"):
            wrong.append(f"{row['flag_channel']} {row['flag_kind']} at {row['flag_t']:.2f} s")
        if (row.get("worst_ratio") or 0.0) > FARTHEST:
            wrong.append(f"{row['worst_ratio']:.1f} sd at {row['worst_ratio_t']:.2f} s")
        if wrong:
            rank = (bool(row.get("flags")), row["outcome"] != "cruise", row.get("worst_ratio") or 0.0)
            found.append((rank, {"number": row["number"], "wrong": "; ".join(wrong), **_named(row, seed)}))
    found.sort(key=lambda one: one[0], reverse=True)
    return [one for _, one in found[: 2 * WORST]]


def _named(row: Row, seed: int) -> dict[str, Any]:
    levels = {name: row[name] for name in FACTORS}
    return {**levels, "command": task(int(row["number"]), seed).command()}
