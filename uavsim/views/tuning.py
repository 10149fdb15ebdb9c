"""Settings that were found for a launch detector: the table, the lines for a scenario, and what is kept."""

from pathlib import Path
from typing import Any

import tomli_w

from uavsim.files import without_none, write_json, write_text, write_toml
from uavsim.studies.operating import level_of
from uavsim.studies.tuning import ALONE, CLASSES, SAID, Score, Tuned, plain
from uavsim.views.terminal import _console, _print, _table

SMALL_RATE = 10.0  # 1/h, below which a bound is printed beside a rate
TABLE = {
    "launches detected": ("pd", 1.0, 4),
    "  at least (95 %)": ("pd_low", 1.0, 4),
    "too early": ("early", 1.0, 0),
    "wings open after the launch": ("pc", 1.0, 4),
    "  on the rail": ("on_rail", 1.0, 0),
    "ms from onset on, median": ("onset_median", 1e3, 1),
    "  95 % quantile": ("onset_p95", 1e3, 1),
    "ms from 4.5 g on, median": ("crossing_median", 1e3, 1),
}


def lines(found: Tuned) -> str:
    """Lines for a scenario's file."""
    return tomli_w.dumps(without_none({"detector": plain(found.scenario.detector)}))


def save(found: Tuned, folder: Path) -> None:
    """Write the scenario with the detector, the detector alone and `tune.json` into a folder that is there."""
    write_toml(folder / "scenario.toml", found.scenario.to_dict())
    write_text(folder / "detector.toml", lines(found))
    write_json(folder / "tune.json", summary(found))


def summary(found: Tuned) -> dict[str, Any]:
    """Everything that was found as plain values; null where there is no number."""
    return {
        "scenario": found.scenario.name,
        "detector": plain(found.scenario.detector),
        "before": plain(found.before),
        "budget_per_hour": found.budget,
        "within_budget": found.within,
        "settings_tried": found.tried,
        "seed": {"tuned": found.seed, "scored": found.fresh},
        "scores": {"tuned": _score(found.tuned), "before": _score(found.was), "on_the_tuning_seed": _score(found.own)},
    }


def _score(score: Score) -> dict[str, Any]:
    launches = {key: value if value == value else None for key, value in score.launches.items()}
    alarms = {}
    for name, counted in score.alarms.items():
        low, high = counted.interval()
        alarms[name] = {"alarms": counted.alarms, "hours": counted.hours, "low": low, "high": high}
        low, high = counted.commands_interval()
        alarms[name] |= {"wing_commands": counted.commands, "wing_commands_low": low, "wing_commands_high": high}
    worst = score.worst()
    return {
        "launches": launches,
        "false_alarms": alarms,
        "worst": {"class": worst.exposure, "of": "wing command" if worst.wings else "detector", "high": worst.high},
    }


def print_tuned(found: Tuned) -> None:
    """Print the scores of what was found and of what was before, both on the fresh seed, and the lines."""
    console, name = _console(), found.scenario.name
    head = f"{found.before.kind} for {name}: {found.tried} settings tried on seed {found.seed}, scored on {found.fresh}"
    _print(console, f"\n{head}\n")
    table = _table(("", "tuned", "as it was", f"on seed {found.seed}"))
    scores = (found.tuned, found.was, found.own)
    for label, (key, factor, digits) in TABLE.items():
        table.add_row(label, *(_number(score.launches[key], factor, digits) for score in scores))
    for wings, title in ((False, "false alarms an hour"), (True, "false wing commands an hour")):
        table.add_row(title, "", "", "")
        for kind in CLASSES:
            free = "" if wings or kind in ALONE else " (not asked)"
            table.add_row(f"  {SAID[kind]}{free}", *(_rate(score, kind, wings=wings) for score in scores))
    _print(console, table, "")
    kept = "is kept" if found.within else "is not shown to be kept"
    _print(console, f"budget of {found.budget:g} an hour in every class: {kept} on the fresh seed")
    for name, score in (("tuned", found.tuned), ("as it was", found.was)):
        worst = score.worst()
        _print(console, f"  worst class, {name}: {worst.what}: {worst.count}, at most {worst.high:.3g} an hour (95 %)")
    if found.tuned.launches["detected"] == 0:
        level = level_of(found.before)
        assert level is not None  # or it could not have been tuned
        _print(console, f"no launch is detected: {level.key} within the budget is too high for them")
    _print(console, "", lines(found))


def _number(value: float, factor: float, digits: int) -> str:
    return "–" if value != value else f"{factor * value:.{digits}f}"


def _rate(score: Score, kind: str, *, wings: bool) -> str:
    """Rate in a class, 1/h, and where it is small its upper 95 % bound."""
    one = score.alarms[kind]
    rate, high = (one.commands_per_hour, one.commands_interval()[1]) if wings else (one.per_hour, one.interval()[1])
    return f"{rate:.3g}" if rate >= SMALL_RATE else f"{rate:.2g} (≤ {high:.2g})"
