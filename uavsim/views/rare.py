"""A rare event: `rare.json`, the table of 80 columns, and `rare.png`, probability against level with its band."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.files import write_json
from uavsim.studies.campaign.rare.asked import Found
from uavsim.views.documents import plain
from uavsim.views.figure import BLUE, RED, label, legend, literal, sheet
from uavsim.views.figure import save as save_figure
from uavsim.views.terminal import _console, _print, _table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = 12  # levels and failures in a table
COLUMNS = 4  # keys in the table of failures


def summary(found: Found) -> dict[str, Any]:
    """Everything as plain values; null where there is no number."""
    e = found.estimate
    rate = found.per_hour
    told: dict[str, Any] = {
        "scenario": found.scenario,
        "event": found.event,
        "of": found.of,
        "method": e.method,
        "seed": e.seed,
        "reached": e.reached,
        "probability": e.probability,
        "low": e.low,
        "high": e.high,
        "variation": e.variation,
        "per_hour": None if rate is None else dict(zip(("rate", "low", "high"), rate, strict=True)),
        "seconds": found.seconds,
        "work": e.work,
        "starts": e.starts,
        "levels": [
            {"level": s.level, "share": s.share, "probability": s.probability, "variation": s.variation}
            for s in e.steps
        ],
        "level": found.levels,
        "failures": list(found.failures),
    }
    return plain(told)  # type: ignore[no-any-return]


UNSURE = 0.3  # coefficient of variation above which the interval held the truth in too few of the known cases


def save(found: Found, folder: Path, *, plots: bool) -> None:
    """Write `rare.json` and `rare.png` into a folder that is there."""
    write_json(folder / "rare.json", summary(found))
    if plots:
        save_figure(figure(found), folder / "rare.png")


def headline(found: Found) -> list[str]:
    """Lines that say what was found."""
    e, lines = found.estimate, []
    if e.reached:
        lines.append(f"probability in {found.of}: {e.probability:.3g}, 95 % {e.low:.3g} to {e.high:.3g}")
        lines.append(f"coefficient of variation {100.0 * e.variation:.0f} %")
        if e.variation > UNSURE:
            lines.append(
                "so much variation makes the interval too narrow (it held 85 % of known cases): fly more --runs"
            )
    else:
        lines.append(f"not reached: probability in {found.of} at most about {e.high:.2g}")
    rate = found.per_hour
    if rate is not None and e.reached:
        lines.append(f"at rest, an hour: {rate[0]:.3g}, 95 % {rate[1]:.3g} to {rate[2]:.3g}")
    elif rate is not None:
        lines.append(f"at rest, an hour: at most about {rate[2]:.2g}")
    lines.append(f"{e.method}, {e.work:.0f} flights' worth of work ({e.starts} simulations begun), seed {e.seed}")
    return lines


def print_found(found: Found) -> None:
    """Print what was found, its levels, and what fails first."""
    console = _console()
    _print(console, f"\n{found.scenario}: {found.event}\n")
    for line in headline(found):
        _print(console, line)
    table = _table((found.levels, "share", "probability", "variation"))
    steps = found.estimate.steps
    for step in _some(steps):
        spread = "–" if not np.isfinite(step.variation) else f"{100.0 * step.variation:.0f} %"
        share = "–" if not np.isfinite(step.share) else f"{step.share:.3g}"
        table.add_row(f"{step.level:.3g}", share, f"{step.probability:.3g}", spread)
    _print(console, "", table, "")
    if found.failures:
        keys = [key for key in found.failures[0] if key not in ("distance", "index")]
        few = _table(("σ away", "index", *(_short(key) for key in keys[:COLUMNS])))
        for one in found.failures[:SHOWN]:
            few.add_row(f"{one['distance']:.2f}", str(one["index"]), *(_value(one[key]) for key in keys[:COLUMNS]))
        _print(console, "what fails first, most likely at the top; all keys are in rare.json\n", few, "")


def _some(steps: tuple[Any, ...]) -> list[Any]:
    """Up to `SHOWN` of the levels, the first and the last among them."""
    if len(steps) <= SHOWN:
        return list(steps)
    return [steps[i] for i in np.unique(np.linspace(0, len(steps) - 1, SHOWN).round().astype(int))]


def _short(key: str) -> str:
    return key if len(key) <= 14 else "…" + key[-13:]


def _value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value)[:12]


def figure(found: Found) -> "Figure":
    """Probability of coming to each level, with its 95 % band."""
    e = found.estimate
    told = headline(found)
    page, ((axes,),) = sheet(f"{found.scenario}: {found.event}", f"{told[0]}; {told[-1]}", (1.0,), size=(8.5, 5.0))
    steps = [s for s in e.steps if s.probability > 0.0 and np.isfinite(s.variation)]
    if steps:
        level = np.array([s.level for s in steps])
        p = np.array([s.probability for s in steps])
        half = np.exp(1.96 * np.sqrt(np.log1p(np.array([s.variation for s in steps]) ** 2)))
        axes.fill_between(level, p / half, p * half, color=BLUE, alpha=0.2, linewidth=0.0, label="95 %")
        axes.plot(level, p, "o-", color=BLUE, markersize=3.5, linewidth=1.2, label="on the way")
        axes.set_yscale("log")
        axes.invert_xaxis()
        axes.margins(x=0.04)
    if e.reached:
        axes.errorbar(
            0.0, e.probability, yerr=[[e.probability - e.low], [e.high - e.probability]],
            fmt="s", color=RED, capsize=3.0, markersize=5.0, label="estimate",
        )  # fmt: skip
        axes.set_yscale("log")
    label(axes, f"probability in {found.of}", literal(found.levels))
    legend(axes)
    return page
