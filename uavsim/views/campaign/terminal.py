"""Many flights in the terminal: outcomes by cause, quantiles, worst flights, draws that matter; in 80 columns."""

from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from uavsim.consistency import mean_band
from uavsim.studies.batch import Batch
from uavsim.studies.campaign.many import Many, many
from uavsim.views.campaign.quantities import SHOWN, number
from uavsim.views.campaign.summary import summary
from uavsim.views.campaign.words import flights
from uavsim.views.campaign.worst import LISTED
from uavsim.views.faults import told
from uavsim.views.terminal import _console, _print, _table, words
from uavsim.views.text import visible

QUANTILES = {"5 %": "p05", "median": "median", "95 %": "p95"}  # of `summary`
CAUSE, OUTCOME, KEY = 42, 24, 40  # characters of a cause, an outcome, and a draw's key
CAUSES, DRAWS = 8, 10  # lines


def print_many(flown: Batch | Many, folder: Path | None = None) -> None:
    """Print what many flights gave: outcomes, quantiles of latency and error, what was not as it should be.

    Parameters
    ----------
    folder
        Of the campaign; then the worst flights come with the command that flies each again.
    """
    kept = many(flown)
    console, found = _console(), summary(kept, folder)
    outcomes = ", ".join(f"{count} {name}" for name, count in found["outcomes"].items())
    _print(console, words("\n", (kept.scenario.name, "bold"), f", {flights(found['flights'])}: {outcomes}\n"))
    if not kept.complete:
        asked = f" of {kept.flights}" if kept.flights > found["flights"] else ""
        lost = f", {len(kept.lost)} of them could not be flown" if kept.lost else ""
        _print(console, f"Not all were flown: {found['flights']}{asked}{lost}\n")
    if not found["flights"]:
        return
    _print(console, _outcome_table(found), "")
    table = _quantile_table(found["quantiles"])
    if table.row_count:
        _print(console, table, "")
    _print(console, *_bound_lines(kept, found))
    _print(
        console,
        f"False detections before release: {found['false_detections']}",
        f"Flights with a requirement that is not met: {found['requirements_unmet']}",
        *_integrity_lines(found["integrity"]),
    )
    if found["draws"]:
        _print(console, "", _draws_table(found["draws"][:DRAWS]))
    if found["flights"] > 1:
        listed = found["worst"][:LISTED]
        _print(console, "", _worst_table(listed))
        commands = [one["command"] for one in listed if one["command"]]
        if commands:
            _print(console, "", "Each flies again by", *(f"  {command}" for command in commands))


def short(text: str, longest: int) -> str:
    """Return a user's text as it is shown, in as many characters at most."""
    shown = visible(" ".join(text.split()))
    return shown if len(shown) <= longest else f"{shown[: longest - 1]}…"


def _outcome_table(found: dict[str, Any]) -> Table:
    table = _table(("Outcomes and 95 % bounds", "flights", "share, %", "95 %"))
    causes = found["causes"]
    for cause in causes[:CAUSES]:
        name = short(f"{cause['outcome']}: {cause['cause']}" if cause["cause"] else cause["outcome"], CAUSE)
        table.add_row(
            words(name if cause["expected"] else (name, "red")), str(cause["flights"]), *_percent(cause, dim=True)
        )
    shown = sum(cause["flights"] for cause in causes[:CAUSES])
    if shown < found["flights"]:
        rest = found["flights"] - shown
        table.add_row("other causes", str(rest), f"{100.0 * rest / found['flights']:.2f}", "")
    right = found["as_expected"]
    table.add_row(words(("as expected", "bold")), str(right["flights"]), *_percent(right, dim=True))
    return table


def _percent(share: dict[str, Any], *, dim: bool) -> tuple[str, Text]:
    band = f"{100.0 * share['low']:.2f}…{100.0 * share['high']:.2f}"
    return f"{100.0 * share['share']:.2f}", words((band, "dim" if dim else ""))


def _quantile_table(quantiles: dict[str, Any]) -> Table:
    """Return the numbers that there are, in the units of the table."""
    table = _table(("Quantiles and\n95 % bands", *QUANTILES, "least\ngreatest"))
    table.collapse_padding = True
    for quantity in SHOWN:
        if quantity.key not in quantiles:
            continue
        found = quantiles[quantity.key]
        cells = (with_band(found[name], quantity.factor, quantity.digits) for name in QUANTILES.values())
        ends = (number(quantity.factor * found[name], quantity.digits) for name in ("least", "greatest"))
        table.add_row(quantity.heading, *cells, "\n".join(ends))
    return table


def with_band(quantile: dict[str, float | None], factor: float, digits: int) -> Text:
    """Return a quantile above its band, which few flights leave open on a side."""
    value, low, high = (
        None if one is None else number(factor * one, digits)
        for one in (quantile["value"], quantile["low"], quantile["high"])
    )
    band = f"{low}…{high}" if low and high else f"≥ {low}" if low else f"≤ {high}" if high else "–"
    return words(f"{value}\n", (band, "dim"))


def _integrity_lines(found: dict[str, Any]) -> list[str]:
    """Say in how many flights a valid airspeed misled, a channel was flagged falsely, and validity was lost."""
    names = {"hazard": "a valid airspeed 3 m/s off for 1 s", "false_flag": "a false flag", "loss": "a loss of validity"}
    return [
        f"Flights with {said}: {one['flights']} (at most {100.0 * one['high']:.2f} %)"
        for name, said in names.items()
        if (one := found[name])["high"] is not None
    ]


def _bound_lines(flown: Many, found: dict[str, Any]) -> list[str]:
    """Say how near the estimator came to the least error, and whether it knows its own."""
    lines = []
    wrong = told(flown.scenario, flown.scenario.duration)
    if wrong:
        lines.append(f"Set to go wrong: {wrong}; √PCRB knows of no fault")
    consistency = found["consistency"]
    if consistency:
        inside = f"in its band at {100.0 * consistency['inside_band']:.0f} % of times"
        left = f", without {flights(len(consistency['left_out']))}" if consistency["left_out"] else ""
        lines.append(f"Mean NEES of the flights: {number(consistency['nees_mean'], 2)}, {inside}{left}")
    for name, error in found["airspeed_bound"].items():
        when = "0.1 … 2 s after launch" if name == "first_2_s" else "later"
        ratio = f"{error['rmse']:.3f} / {error['bound']:.3f} m/s = {error['ratio']:.2f}"
        band = "" if error["low"] is None else f" [{error['low']:.2f}, {error['high']:.2f}]"
        lines.append(f"RMSE over √PCRB {when}: {ratio}{band}")
    if found["airspeed_bound"]:
        low, high = (bound**0.5 for bound in mean_band(len(flown.traces)))
        at_bound = f"{flights(len(flown.traces))} at the bound"
        lines.append(f"  {at_bound}: 95 % within {low:.2f} … {high:.2f} (constant errors)")
    return lines


def _worst_table(listed: list[dict[str, Any]]) -> Table:
    table = _table(("Worst flights", "index", "seed", "RMSE, m/s", "latency, ms"))
    for one in listed:
        name = short(one["outcome"], OUTCOME)
        if one["expected"] and not one["met"]:
            name = f"{name}, unmet"
        seed = "–" if one["seed"] is None else str(one["seed"])
        values = number(one["rmse"]), number(1e3 * one["latency"], 1)
        table.add_row(
            words(name if one["expected"] and one["met"] else (name, "red")), str(one["index"]), seed, *values
        )
    return table


def _draws_table(draws: list[dict[str, Any]]) -> Table:
    """Return draws by how unlikely it is that they have nothing to do with failing."""
    table = _table(("Medians of draws", "failed", "others", "p (Holm)"))
    for one in draws:
        p = one["probability"]
        shown = "< 0.0001" if p < 1e-4 else f"{p:.4f}"
        table.add_row(
            short(one["key"], KEY),
            f"{one['failed']:.4g}",
            f"{one['others']:.4g}",
            words((shown, "bold" if p < 0.05 else "")),
        )
    return table
