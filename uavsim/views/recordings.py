"""The table of the recordings that were replayed, in Markdown."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from uavsim.studies.recordings import Replayed

HEAD = ("recording", "launches found", "delay, ms", "false alarms", "airspeed", "over ground, m/s", "flags", "verdict")
NOTHING = "–"


def table(found: "Iterable[Replayed]") -> list[str]:
    """Lines of a Markdown table, a row each, and below it what is wrong."""
    rows = list(found)
    lines = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
    lines += ["| " + " | ".join(row(one)) + " |" for one in rows]
    wrong = [f"- {_cell(one.title)}: {_cell(said)}" for one in rows for said in one.wrong]
    return [*lines, "", *wrong] if wrong else lines


def row(one: "Replayed") -> list[str]:
    """Cells of a recording."""
    launches = (
        NOTHING if one.found is None else str(one.found) if one.expected is None else f"{one.found} of {one.expected}"
    )
    delays = ", ".join(f"{1e3 * delay:.0f}" for delay in one.delays) or NOTHING
    false = NOTHING if one.false_alarms is None else str(one.false_alarms)
    verdict = ("wrong" if one.wrong else "right") if one.judged else "not read" if one.wrong else "no answer"
    flags = one.airspeed.get("flags")
    return [
        _cell(one.title), launches, delays, false, _airspeed(one.airspeed), _ground(one.airspeed.get("over_ground")),
        NOTHING if flags is None else str(flags), verdict,
    ]  # fmt: skip


def _airspeed(figures: "Any") -> str:
    if figures.get("rmse") is not None:
        return f"RMSE {figures['rmse']:.2f} m/s, {100.0 * figures['coverage_95']:.0f} % within ±1.96 sd"
    if figures.get("valid_fraction") is not None:
        return f"valid {100.0 * figures['valid_fraction']:.0f} %, no reference"
    return NOTHING


def _ground(found: "Any") -> str:
    if not found:
        return NOTHING
    return f"{-found['difference']:+.2f} ± {found['sd']:.2f} ± {found['claimed']:.2f} ({found['turns']:.0f} turns)"


def _cell(text: str) -> str:
    return text.replace("|", "/").replace("\n", " ")
