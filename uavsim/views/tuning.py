"""Settings that were found for a launch detector: the table, the lines for a scenario, and what is kept."""

from pathlib import Path
from typing import Any

import tomli_w

from uavsim.files import without_none, write_json, write_text, write_toml
from uavsim.studies.operating import level_of
from uavsim.studies.tuning import OTHERS, Score, Tuned, plain
from uavsim.views.terminal import _console, _print, _table

TABLE = {
    "launches detected": ("pd", 1.0, 4),
    "  at least (95 %)": ("pd_low", 1.0, 4),
    "too early": ("early", 1.0, 0),
    "latency from onset, median, ms": ("onset_median", 1e3, 1),
    "  95 % quantile, ms": ("onset_p95", 1e3, 1),
    "  from 4.5 g on, median, ms": ("crossing_median", 1e3, 1),
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
    return {"launches": launches, "false_alarms": alarms}


def print_tuned(found: Tuned) -> None:
    """Print the scores of what was found and of what was before, both on the fresh seed, and the lines."""
    console, name = _console(), found.scenario.name
    head = f"{found.before.kind} for {name}: {found.tried} settings tried on seed {found.seed}, scored on {found.fresh}"
    _print(console, f"\n{head}\n")
    table = _table(("", "tuned", "as it was", f"tuned, on seed {found.seed}"))
    scores = (found.tuned, found.was, found.own)
    for label, (key, factor, digits) in TABLE.items():
        table.add_row(label, *(_number(score.launches[key], factor, digits) for score in scores))
    for kind in ("mix", *OTHERS):
        table.add_row(f"false alarms, {kind}, 1/h", *(_alarms(score, kind) for score in scores))
        if kind == "mix":
            table.add_row("  at most (95 %)", *(f"{score.alarms[kind].interval()[1]:.3g}" for score in scores))
    _print(console, table, "")
    kept = "is kept" if found.within else "is not shown to be kept"
    _print(console, f"budget of {found.budget:g} false alarms an hour: {kept} on the fresh seed")
    if found.tuned.launches["detected"] == 0:
        level = level_of(found.before)
        assert level is not None  # or it could not have been tuned
        _print(console, f"no launch is detected: {level.key} within the budget is too high for them")
    _print(console, "", lines(found))


def _number(value: float, factor: float, digits: int) -> str:
    return "–" if value != value else f"{factor * value:.{digits}f}"


def _alarms(score: Score, kind: str) -> str:
    counted = score.alarms.get(kind)
    return "–" if counted is None else f"{counted.per_hour:.3g}"
