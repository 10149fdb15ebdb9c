"""The tables of docs/two-barometers.md: python scripts/two_barometers.py --runs 8 --seed 5001 [--out DIR].

Each is made of `uavsim sweep catapult` over the head's parts, a command a part, which is printed before it is flown.
With --out the sweeps stay, and what is already in the folder is not flown again. At 8 flights a cell it is 320 flights,
some four minutes of two processors.
"""

import argparse
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

PAIRS = ("bmp280", "bmp390", "bmp581")
DIFFERENTIAL = ("ms4525do", "dlvr-l10d", "sdp33")
COLUMNS = {
    "the pressures alone, m/s": "airspeed.cruise.rmse_raw",
    "the aided filter, m/s": "airspeed.cruise.rmse",
}


@dataclass(frozen=True)
class Table:
    """One table: its name, the parts that it is of, and what is set and varied."""

    name: str
    title: str
    parts: tuple[str, ...]
    given: tuple[str, ...]
    vary: tuple[str, ...]


TABLES = (
    Table(
        "tare",
        "Tare and temperature (15 °C less 35, and more 25)",
        (*PAIRS, *DIFFERENTIAL),
        (),
        ("air_data.tare=covered,none", "environment.temperature_offset=-35,25"),
    ),
    Table(
        "warm",
        "Switched on 5 s or 10 min before, dies that warm themselves by 15 K with 60 s",
        ("bmp280", "bmp390", "ms4525do", "sdp33"),
        ("air_data.thermal.self_heating=15", "air_data.thermal.lag=60"),
        ("air_data.thermal.powered_for=5,600",),
    ),
    Table(
        "wind",
        "Tared in 8 m/s of wind, under the cover and in the open",
        ("bmp280", "bmp390", "ms4525do", "sdp33"),
        ("environment.wind_speed=8",),
        ("air_data.tare=covered,open",),
    ),
)


def head(part: str) -> list[str]:
    """Return what puts a pair of barometers, or a differential sensor, into the head."""
    if part in DIFFERENTIAL:
        return ["air_data.kind=differential", f"air_data.differential.preset={part}"]
    return [f"air_data.total.preset={part}", f"air_data.static.preset={part}"]


def swept(table: Table, part: str, out: Path, options: argparse.Namespace) -> pd.DataFrame:
    """Fly a sweep, or take what the folder has of it."""
    folder = out / f"{table.name}-{part}"
    words = ["sweep", "catapult", "--seed", str(options.seed), "--runs", str(options.runs), "--set", "duration=25"]
    for one in (*head(part), *table.given):
        words += ["--set", one]
    for one in table.vary:
        words += ["--vary", one]
    print(f"uavsim {shlex.join(words)}", file=sys.stderr)
    if not (folder / "runs.parquet").exists():
        command = [sys.executable, "-m", "uavsim.cli", *words, "--no-plots", "--out", str(folder)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return pd.read_parquet(folder / "runs.parquet")


def rows(table: Table, part: str, runs: pd.DataFrame) -> list[str]:
    """Return the lines of a part: root mean squares over flights, the worst flight, the mean coverage, outcomes."""
    varied = [f"vary.{one.partition('=')[0]}" for one in table.vary]
    lines = []
    for key, cell in runs.groupby(varied, sort=False):
        figures = [np.sqrt(np.mean(np.square(cell[column].astype(float)))) for column in COLUMNS.values()]
        worst = cell["airspeed.cruise.rmse"].astype(float).max()
        inside = cell["airspeed.cruise.coverage_95"].astype(float).mean()
        arrived = int((cell["outcome"] == "cruise").sum())
        name = f"`{part}`" if part in DIFFERENTIAL else f"two `{part}`"
        cells = [name, *(f"{value:g}" if isinstance(value, float) else str(value) for value in key)]
        cells += [*(f"{value:.2f}" for value in figures), f"{worst:.2f}", f"{inside:.2f}", f"{arrived} of {len(cell)}"]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def main() -> None:
    """Fly the sweeps and print the tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, help="folder that the sweeps stay in")
    parser.add_argument("--runs", type=int, default=8, help="flights a cell")
    parser.add_argument("--seed", type=int, default=5001)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = options.out or Path(folder)
        for table in TABLES:
            keys = [f"`{one.partition('=')[0].rpartition('.')[2]}`" for one in table.vary]
            titles = ["head", *keys, *COLUMNS, "its worst flight", "coverage", "`cruise`"]
            print(f"**{table.title}**\n\n| {' | '.join(titles)} |\n{'|---' * len(titles)}|")
            for part in table.parts:
                print("\n".join(rows(table, part, swept(table, part, out, options))))
            print()


if __name__ == "__main__":
    main()
