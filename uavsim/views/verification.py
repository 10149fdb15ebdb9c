"""Verdicts on requirements: tables, `verify.json`, `junit.xml`, and the figure of estimates against flights.

    verify.json     verdicts, estimates, bounds, and what was expected
    junit.xml       a test case a requirement: a failure if it is not met, an error if it is undecided
    verify.png      estimate and bounds of each requirement against the number of flights, with what is asked

JUnit's schema has no word for a test that could not be decided. `skipped` would leave a build green although nothing
is shown, so it is an error: the test did not come to an end. A user's text is made visible first: XML has no way to
write control characters.
"""

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring  # written, never read

import numpy as np

from uavsim.files import write_bytes, write_json
from uavsim.requirements import Requirement
from uavsim.studies.campaign.evidence import Course, course
from uavsim.studies.campaign.outlook import Outlook
from uavsim.studies.campaign.verification import Judgement, Verification, plain
from uavsim.studies.campaign.verify import Verified
from uavsim.views.figure import BLUE, DARK, GREEN, GREY, RED, SMALL, label, literal, save, sheet
from uavsim.views.terminal import _console, _print, _table, words
from uavsim.views.text import visible

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from uavsim.scenario import Scenario

VERDICTS, JUNIT, FIGURE = "verify.json", "junit.xml", "verify.png"
STYLES = {"met": "green", "not met": "red", "undecided": "yellow"}
COLOURS = {"met": GREEN, "not met": RED, "undecided": GREY}
COLUMNS = 3  # of the figure's panels
PANEL = 2.3  # in, height of one
MOST_PANELS = 30  # requirements that are drawn
NEVER = "more than can be planned"

Expected = Sequence[tuple[Requirement, Outlook]]


# -- terminal --------------------------------------------------------------------------------------------------------


def print_expected(expected: Expected, confidence: float, budget: int, *, text: bool = False) -> str | None:
    """Print, or return as text, the chance that each requirement is decided within the budget."""
    table = _table(("Chance of a verdict", "met", "not met", "half by", "least"))
    table.columns[0].no_wrap = False
    for requirement, one in expected:
        half = "–" if one.median is None else str(one.median)
        least = "–" if one.least is None else str(one.least)
        name = words(f"{requirement}\n", (f"if {one.truth}", "dim"))
        table.add_row(name, _percent(one.met), _percent(one.not_met), half, least)
    head = f"\nAt most {budget} flights, {100.0 * confidence:g} % confidence; each requirement taken by itself\n"
    console = _console()
    if text:
        with console.capture() as captured:
            _print(console, head, table, "")
        return captured.get()
    _print(console, head, table, "")
    return None


def _percent(share: float) -> str:
    if 0.0 < share < 0.0005:
        return "<0.1 %"
    if 0.9995 < share < 1.0:
        return ">99.9 %"
    return f"{100.0 * share:.3g} %"


def print_verified(found: Verified) -> None:
    """Print a line a requirement, then what all together come to, and what would decide those that are open."""
    seen, console = found.verification, _console()
    table = _table(("Requirement", "found", "bounds", "verdict"))
    table.columns[0].no_wrap = False
    for one in seen.judgements:
        name = f"{one.requirement}"
        if one.without_value:
            name += f"\n  without a value: {_flights(one.without_value)}"
        verdict = words((one.verdict.upper() if one.verdict == "not met" else one.verdict, STYLES[one.verdict]))
        table.add_row(name, _figure(one.estimate), _bounds(one), verdict)
    title = words("\n", (found.scenario.name, "bold"), f", {_flights(seen.runs)}, {100.0 * seen.confidence:g} %: ")
    head = words(title.plain, (_summary(seen), f"bold {STYLES[seen.verdict]}"), "\n")
    _print(
        console,
        head,
        table,
        "",
        *(_wrapped(_plan(one, seen.confidence)) for one in seen.judgements if one.verdict == "undecided"),
    )


WIDTH = 80  # characters of a terminal that is not told


def _wrapped(text: str) -> str:
    """In lines of the table's width."""
    return "\n".join(wrap(text, WIDTH, subsequent_indent="  ", break_long_words=False))


def _summary(seen: Verification) -> str:
    if seen.met:
        return "all requirements are met"
    count = {word: sum(one.verdict == word for one in seen.judgements) for word in STYLES}
    return ", ".join(f"{number} {word}" for word, number in count.items() if number)


def _flights(number: int) -> str:
    return f"{number} flight" if number == 1 else f"{number} flights"


def _figure(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _bounds(one: Judgement) -> str:
    if one.low is None and one.high is None:
        return "–"
    if one.low is None:
        return f"≤ {_figure(one.high)}"
    return f"≥ {_figure(one.low)}" if one.high is None else f"{_figure(one.low)} … {_figure(one.high)}"


def _plan(one: Judgement, confidence: float) -> str:
    """Say what number of flights would decide an open requirement."""
    if min(one.p_met, one.p_not_met) <= 1.0 - confidence:
        word = "met" if one.p_met <= one.p_not_met else "not met"
        return f"{one.requirement}: {word} by itself; said once all are met, or at Holm's level for single ones"
    as_now = NEVER if one.decided_by is None else f"{one.decided_by} flights"
    clean = "" if one.met_by is None else f", met by {one.met_by} if nothing speaks against it from now on"
    return f"{one.requirement}: as things are, decided by {as_now}{clean}"


# -- files -----------------------------------------------------------------------------------------------------------


def summary(found: Verified, expected: Expected) -> dict[str, Any]:
    """What `verify.json` holds."""
    chances = [
        {
            "says": str(requirement),
            "if": one.truth,
            "met": one.met,
            "not_met": one.not_met,
            "mean_flights": one.flights,
            "median_flights": one.median,
            "least_flights": one.least,
        }
        for requirement, one in expected
    ]
    return {
        **plain(found.verification),
        "scenario": found.scenario.name,
        "seed": found.scenario.seed,
        "sampling": "random",
        "unfinished": len(found.left),
        "expected": chances,
    }


def write(found: Verified, expected: Expected, folder: Path, *, plots: bool, seconds: float = 0.0) -> None:
    """Write `verify.json`, `junit.xml` and the figure into a folder that is there."""
    write_json(folder / VERDICTS, summary(found, expected))
    write_bytes(folder / JUNIT, junit(found.verification, found.scenario, seconds))
    if plots:
        (folder / "plots").mkdir(exist_ok=True)
        draw(found, folder / "plots" / FIGURE)


def junit(seen: Verification, scenario: "Scenario", seconds: float = 0.0) -> bytes:
    """Return the verdicts as JUnit XML, which build servers show.

    Parameters
    ----------
    seen
        Verdicts.
    scenario
        Names the suite.
    seconds
        How long it took; the only thing in it that a clock says.
    """
    name = visible(scenario.name)
    counts = {
        "tests": len(seen.judgements),
        "failures": sum(one.verdict == "not met" for one in seen.judgements),
        "errors": sum(one.verdict == "undecided" for one in seen.judgements),
        "skipped": 0,
    }
    told = {key: str(value) for key, value in counts.items()}
    root = Element("testsuites")
    suite = SubElement(root, "testsuite", {"name": f"uavsim verify {name}", "time": f"{seconds:.3f}", **told})
    properties = SubElement(suite, "properties")
    facts = {"runs": seen.runs, "confidence": seen.confidence, "seed": scenario.seed, "verdict": seen.verdict}
    for key, value in facts.items():
        SubElement(properties, "property", name=key, value=str(value))
    for one in seen.judgements:
        text = visible(str(one.requirement))
        case = SubElement(suite, "testcase", classname=f"uavsim.{name}", name=text, time="0.000")
        said = f"{text}: found {_figure(one.estimate)}, bounds {_bounds(one)} after {_flights(seen.runs)}"
        if one.verdict == "not met":
            SubElement(case, "failure", type="not met", message=said).text = said
        elif one.verdict == "undecided":
            said = f"undecided: {said}; {visible(_plan(one, seen.confidence))}"
            SubElement(case, "error", type="undecided", message=said).text = said
    indent(root)
    content: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return content


# -- figure ----------------------------------------------------------------------------------------------------------


def draw(found: Verified, path: Path) -> Path:
    """Draw each requirement's estimate and bounds against the number of flights, and what is asked."""
    seen = found.verification
    drawn = seen.judgements[:MOST_PANELS]
    columns = min(COLUMNS, len(drawn))
    rows = -(-len(drawn) // columns)
    left_out = f"; the first {MOST_PANELS} of {len(seen.judgements)}" if len(drawn) < len(seen.judgements) else ""
    about = f"bounds hold with {100.0 * seen.confidence:g} % each, at all numbers of flights together; dashed: asked"
    figure, grid = sheet(
        f"{found.scenario.name}: {_summary(seen)}",
        f"{_flights(seen.runs)}, seed {found.scenario.seed}; {about}{left_out}",
        (1.0,) * rows,
        (1.0,) * columns,
        size=(11.5 if columns > 1 else 6.5, PANEL * rows + 1.3),
        right=0.3,
        share=False,
        gap=(0.55, 0.3),
    )
    panels = [axes for row in grid for axes in row]
    for axes, one in zip(panels, drawn, strict=False):
        _panel(axes, one, course(one.requirement, found.frame, seen.confidence))
    for axes in panels[len(drawn) :]:
        axes.set_visible(False)
    return save(figure, path)


def _panel(axes: "Axes", one: Judgement, seen: Course) -> None:
    low, high = _limits(one, seen)
    bottom = np.where(np.isnan(seen.low), low, np.clip(seen.low, low, high))
    top = np.where(np.isnan(seen.high), high, np.clip(seen.high, low, high))
    axes.fill_between(seen.flights, bottom, top, color=BLUE, alpha=0.18, linewidth=0.0, step="post")
    axes.plot(seen.flights, seen.estimate, color=BLUE, linewidth=1.2)
    axes.axhline(one.bound, color=DARK, linewidth=1.0, linestyle="--")
    if seen.flights.size and seen.flights[-1] > seen.flights[0]:
        axes.set_xlim(0, seen.flights[-1])
    axes.set_ylim(low, high)
    axes.set_title(literal(str(one.requirement)), fontsize=SMALL, loc="left", color=DARK)
    axes.text(
        0.98, 0.95, one.verdict, transform=axes.transAxes, ha="right", va="top", fontsize=SMALL,
        color=COLOURS[one.verdict], fontweight="bold",
    )  # fmt: skip
    label(axes, x="flights")


def _limits(one: Judgement, seen: Course) -> tuple[float, float]:
    """Range that shows the bound, the estimate and the later bounds; what is far beyond is not drawn to scale."""
    later = slice(seen.flights.size // 2, None)
    shown = np.concatenate([[one.bound], seen.estimate[later], seen.low[later], seen.high[later]])
    shown = shown[np.isfinite(shown)]
    room = 0.15 * max(float(np.ptp(shown)), 1e-6 + 0.02 * abs(one.bound))
    low, high = float(shown.min()) - room, float(shown.max()) + room
    if one.requirement.kind in ("probability", "every"):
        low, high = max(low, -0.02), min(high, 1.0 + 0.2 * room)
    return low, high
