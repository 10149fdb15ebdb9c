"""A sweep in the terminal: a line a cell, where each requirement breaks, and differences; within 80 columns."""

from typing import TYPE_CHECKING, Any

from uavsim.studies.campaign.crossing import fewest
from uavsim.studies.campaign.sweep import OUTCOME, QUANTILES, Sweep
from uavsim.studies.campaign.vary import as_text, told
from uavsim.views.campaign.terminal import with_band
from uavsim.views.sweeping.shared import named, short
from uavsim.views.terminal import _console, _print, _table, words

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType
    from rich.table import Table

MOST_ROWS = 20  # cells that a table shows
MOST_LETTERS = 18  # of a value in a table
QUANTITY_WORDS = {"p05": "5 %", "median": "median", "p95": "95 %"}
STATES = {"holds": "not reached", "broken": "broken everywhere"}


def print_sweep(found: Sweep) -> None:
    """Print what each cell gave, where the requirements break, and how cells differ from the reference."""
    console = _console()
    cells, flights = len(found.table), int(found.table["flights"].max())
    head = f", {cells} cell{'s' * (cells != 1)} of {flights} flight{'s' * (flights != 1)}, seed {found.scenario.seed}\n"
    _print(console, words("\n", (found.scenario.name, "bold"), head))
    for letter, one in zip(_letters(found), found.varies, strict=True):
        _print(console, f"{letter} = {one.key}")
    _print(console, "")
    parts: list[RenderableType] = [_outcomes(found), ""]
    for key in found.quantities:
        parts += [_quantiles(found, key), ""]
    if len(found.table) > MOST_ROWS:
        parts.append(f"{MOST_ROWS} of {len(found.table)} cells are shown; cells.csv has all")
    _print(console, *parts)
    _print_limits(console, found)
    _print_differences(console, found)


def _letters(found: Sweep) -> list[str]:
    return [chr(ord("a") + i) if i < 26 else f"a{i}" for i in range(len(found.varies))]


def _values(found: Sweep, row: "pd.Series[Any]") -> list[str]:
    """Return the values of a cell's keys, short."""
    return [cut_value(row[f"vary.{one.key}"]) for one in found.varies]


def cut_value(value: Any) -> str:
    """Write a value so that a table has room for it."""
    text = f"{value:.5g}" if isinstance(value, float) else as_text(value)
    return text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 1]}…"


def _rows(table: "pd.DataFrame") -> "list[pd.Series[Any]]":
    return [row for _, row in table.head(MOST_ROWS).iterrows()]


def _outcomes(found: Sweep) -> "Table":
    table = _table((*_letters(found), "flights", "as expected", "share, %", f"{100 * found.confidence:g} % bounds, %"))
    for row in _rows(found.table):
        bounds = f"{100 * row['share_low']:.1f} … {100 * row['share_high']:.1f}"
        marked = " *" if row["cell"] == found.reference else ""
        table.add_row(
            *_values(found, row),
            *(f"{row[name]:.0f}" for name in ("flights", "expected")),
            f"{100 * row['share']:.1f}",
            bounds + marked,
        )
    return table


def _quantiles(found: Sweep, key: str) -> "Table":
    """Return a table of one number: its quantiles above their bounds."""
    name, unit, factor = named(key)
    table = _table((*_letters(found), *QUANTITY_WORDS.values(), "none"))
    table.title, table.title_justify, table.title_style = f"{name}, {unit}" if unit else name, "left", ""
    digits = 1 if unit == "ms" else 3
    alike = found.alike(key) and len(found.table) > 1
    for row in _rows(found.table)[: 1 if alike else None]:
        cells = [
            with_band(
                {
                    end: _or_none(row[f"{key}.{q}{tail}"])
                    for end, tail in (("value", ""), ("low", "_low"), ("high", "_high"))
                },
                factor,
                digits,
            )
            for q in QUANTILES
        ]
        table.add_row(
            *(["all"] * len(found.varies) if alike else _values(found, row)), *cells, f"{row[f'{key}.missing']:.0f}"
        )
    return table


def _or_none(value: float) -> float | None:
    return value if value == value else None


def _print_limits(console: Any, found: Sweep) -> None:
    """Print where each requirement breaks; a requirement that does so nowhere takes one line."""
    limits = found.limits
    if limits.empty:
        return
    table = _table((f"met by {100 * found.wanted:g} %", "estimate", "band", "quantile"))
    for name, rows in limits.groupby("requirement", sort=False):
        states = set(rows["state"])
        shown = short(str(name), 40)
        if len(states) == 1 and "breaks" not in states:
            row = rows.iloc[0]
            held = _band(row) if len(rows) == 1 else ""
            table.add_row(shown, STATES[row["state"]], held, "")
            continue
        table.add_row(shown, "", "", "")
        for row in _rows(rows):
            estimate = _number(row["estimate"]) if row["state"] == "breaks" else STATES[row["state"]]
            table.add_row(f"  {_where(found, row)}", estimate, _band(row), _number(row["quantile"]))
        if len(rows) > MOST_ROWS:
            table.add_row(f"  … and {len(rows) - MOST_ROWS} more in limits.csv", "", "", "")
    _print(console, "How much can be afforded\n", table, "")
    least = fewest(found.wanted, found.confidence)
    if int(found.table["flights"].max()) < least:
        console.print(f"A cell is shown to be good by {least} flights that all are; with fewer a band stays open.\n")


def _where(found: Sweep, row: "pd.Series[Any]") -> str:
    """Say along which key a limit lies, and where the other keys stand."""
    letters = dict(zip((one.key for one in found.varies), _letters(found), strict=True))
    beside = (
        f"{letters[one.key]} {cut_value(row[f'vary.{one.key}'])}" for one in found.varies if one.key != row["key"]
    )
    return ", ".join((f"{letters[row['key']]} {'up to' if row['direction'] == 'up' else 'down to'}", *beside))


def _band(row: "pd.Series[Any]") -> str:
    return f"{_number(row['low'], 'open')} … {_number(row['high'], 'open')}"


def _number(value: float, none: str = "–") -> str:
    return f"{value:.3g}" if value == value else none


def _print_differences(console: Any, found: Sweep) -> None:
    """Print each cell less the reference, a table a number that is not the same everywhere."""
    keys = [key for key in (OUTCOME, *found.quantities) if not found.alike(key)]
    if len(found.table) < 2 or not keys:
        return
    what = "the scenario as it is" if found.nominal else told(found.cells[found.reference])
    console.print(f"Less {short(what, 200)} (*), flight by flight\n")
    for key in keys:
        name, unit, factor = named(key)
        bounds = f"{100 * found.confidence:g} % bounds"
        table = _table((*_letters(found), "difference", bounds, "narrower by"))
        table.title, table.title_justify, table.title_style = f"{name}, {unit}" if unit else name, "left", ""
        for row in _rows(found.differences[found.differences["quantity"] == key]):
            middle, low, high = (factor * row[end] for end in ("difference", "low", "high"))
            shown = ("–", "–") if middle != middle else (f"{middle:+.3g}", f"{low:+.3g} … {high:+.3g}")
            table.add_row(*_values(found, row), *shown, _number(row["narrower"]) if row["narrower"] < 1e4 else "–")
        _print(console, table, "")
