"""Operating points of launch detectors in the terminal, and where the default is not better than the autopilots'."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from uavsim.onboard.launch import KINDS
from uavsim.studies.operating import Operating, not_better, rivals
from uavsim.views.terminal import _console, _print, _table

if TYPE_CHECKING:
    import pandas as pd

CLASSES = {"mix": "handling", "vibration": "3 g rms", "soft drops": "drops", "centrifuge": "4.1 g"}


def print_operating(found: Operating) -> None:
    """Print the detectors as they are set: a line each, with 95 % bands."""
    console = _console()
    _print(
        console,
        f"\n{found.launches}, seed {found.seed}: as set, 95 % bands; delays after 4.5 g, ms;"
        "\nwings: share of launches after which they open, for too little speed was gained in the others\n",
    )
    table = _table(("", "seen", "95 %", "median", "p95", "early", "wings"))
    alarms = _table(("false alarms, 1/h", *CLASSES.values(), "worst ≤"))
    wings = _table(("false wings, 1/h", *CLASSES.values(), "worst ≤"))
    for _, row in found.shipped().iterrows():
        name = str(row["detector"])
        band = f"{row['pd_low']:.4f}–{row['pd_high']:.4f}"
        delays = _ms(row["crossing_median"]), _ms(row["crossing_p95"])
        table.add_row(name, f"{row['pd']:.4f}", band, *delays, f"{row['early']}", f"{row['pc']:.3f}")
        for part, rate, high in ((alarms, "per_hour", "high"), (wings, "commands_per_hour", "commands_high")):
            worst = max(CLASSES, key=lambda kind: row[f"{kind}.{high}"])
            part.add_row(
                name,
                *(_rate(row[f"{kind}.{rate}"]) for kind in CLASSES),
                f"{CLASSES[worst]}, {_rate(row[f'{worst}.{high}'])}",
            )
    _print(console, table, "", alarms, "", wings, "")


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f}" if seconds == seconds else "–"


def _rate(value: float) -> str:
    return f"{value:.2g}" if 0.0 < value < 99.5 else f"{value:.0f}"


def print_cells(cells: "pd.DataFrame", own: str, also: Sequence[str] = ()) -> None:
    """Print detection probability and median delay in each cell, and where the default is not better."""
    console, there = _console(), set(cells["detector"])
    first = (next(iter(KINDS)), *also, *rivals())  # the published method, and what the user has brought
    names = [own, *(name for name in dict.fromkeys(first) if name in there and name != own)]
    trials = int(cells["trials"].iloc[0])
    _print(
        console,
        f"of {trials} launches a cell, median delay after 4.5 g, ms, and in brackets how many are lost; +: bump\n",
    )
    table = _table(("peak, σ", *(_short(name) for name in names)))
    for (peak, sigma, bump), rows in cells.groupby(["peak_g", "sigma_g", "bump"], sort=False):
        by_name = rows.set_index("detector")
        table.add_row(f"{peak:g} {sigma:g}{' +' if bump else ''}", *(_cell(by_name.T[name]) for name in names))
    _print(console, table, "")
    for line in shortfalls(cells, own):
        _print(console, line)


def _short(name: str) -> str:
    return (KINDS[name].short if name in KINDS else "") or name


def _cell(row: "pd.Series[float]") -> str:
    lost = int(row["trials"] - row["detected"])
    return _ms(row["crossing_median"]).split(".")[0] + (f" ({lost})" if lost else "")


def shortfalls(cells: "pd.DataFrame", own: str) -> list[str]:
    """A line for each rival: in which cells the detector is not better."""
    there, lines = set(cells["detector"]), []
    found = list(not_better(cells, own))
    for rival in (name for name in rivals() if name in there and name != own):
        places = [
            f"{s.cell[0]:g} g at σ {s.cell[1]:g} g{' with a bump' if s.cell[2] else ''} ({s.by})"
            for s in found
            if s.rival == rival
        ]
        lines.append(
            f"{own} against {rival}: " + ("better in every cell" if not places else "not in " + ", ".join(places))
        )
    return lines
