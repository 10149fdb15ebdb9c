"""Fly scenarios in several source trees and lay their scores side by side.

    python scripts/compare_versions.py 0.1=../v01 now=. [--seeds 1-20] [--set KEY=VALUE] [--out DIR] [SCENARIO …]

A tree is a checkout of uavsim, with a name before it if the table is to have one. Every one is flown by its own command
line, in a process of its own with the tree first on its path, so it needs only what is installed here. Without SCENARIO
all that are packaged in every tree. Medians over the flights, but for the outcomes, which are counted, and the lowest
altitude, which is the least. Flights stay in `--out` and are not flown again while they are there.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pandas as pd

COLUMNS = {  # heading: key of the score, factor, decimals
    "latency, ms": ("launch.latency", 1e3, 2),
    "rail's end, m/s": ("flight.rail_exit_speed", 1.0, 2),
    "RMSE stroke, m/s": ("airspeed.stroke.rmse", 1.0, 3),
    "transition": ("airspeed.transition.rmse", 1.0, 3),
    "cruise": ("airspeed.cruise.rmse", 1.0, 3),
    "whole": ("airspeed.rmse", 1.0, 3),
    "coverage": ("airspeed.coverage_95", 1.0, 3),
    "σ of true airspeed, m/s": ("flight.cruise_airspeed_sd", 1.0, 3),
}
LOWEST = "flight.lowest_altitude_after_exit"


def tree(text: str) -> tuple[str, Path]:
    """Return name and folder of `NAME=FOLDER` or `FOLDER`."""
    name, _, folder = text.rpartition("=")
    path = Path(folder).resolve()
    if not (path / "uavsim" / "cli").exists() and not (path / "uavsim" / "cli.py").exists():
        raise argparse.ArgumentTypeError(f"{folder}: no checkout of uavsim")
    return name or path.name, path


def scenarios(root: Path) -> list[str]:
    """Names of the packaged scenarios of a tree."""
    return sorted(path.stem for path in (root / "uavsim" / "scenarios").glob("*.toml"))


def run(root: Path, scenario: str, flights: list[str], changes: list[str], out: Path) -> str:
    """Fly a scenario with a tree's own command line; return what it told on standard error."""
    command = [sys.executable, "-m", "uavsim.cli", "fly", scenario, *flights, "--no-plots"]
    command += ["--out", str(out), "--overwrite", *(part for change in changes for part in ("--set", change))]
    path = {**os.environ, "PYTHONPATH": os.pathsep.join([str(root), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(command, cwd=root, env=path, capture_output=True, text=True, check=False)
    return done.stderr.strip()


def fly(root: Path, scenario: str, seeds: str, changes: list[str], out: Path) -> pd.DataFrame:
    """Fly several flights; one row a flight.

    Raises
    ------
    RuntimeError
        If the tree's command line left no table.
    """
    table = out / "runs.parquet"
    if not table.exists():
        told = run(root, scenario, ["--seeds", seeds], changes, out)
        if not table.exists():
            raise RuntimeError(f"{root}: {scenario}: {told}")
    return pd.read_parquet(table)


def row(name: str, runs: pd.DataFrame) -> str:
    """One line of the table."""
    outcomes = ", ".join(f"{count} `{outcome}`" for outcome, count in runs["outcome"].value_counts().items())
    cells = [name, outcomes]
    for key, factor, decimals in COLUMNS.values():
        value = factor * pd.to_numeric(runs[key]).median() if key in runs else float("nan")
        cells.append("–" if value != value else f"{value:.{decimals}f}")
    lowest = pd.to_numeric(runs[LOWEST]).min() if LOWEST in runs else float("nan")
    cells.append("–" if lowest != lowest else f"{lowest:.2f}")
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Parse, fly, print."""
    parser = argparse.ArgumentParser(description="Compare the scores of several source trees.")
    parser.add_argument("trees", nargs="+", metavar="[NAME=]FOLDER | SCENARIO")
    parser.add_argument("--seeds", default="1-20")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--out", type=Path, help="where the flights stay; a temporary folder without it")
    options = parser.parse_intermixed_args()
    named = [text for text in options.trees if "=" not in text and not Path(text).is_dir()]
    try:
        roots = dict(tree(text) for text in options.trees if text not in named)
    except argparse.ArgumentTypeError as error:
        parser.error(str(error))
    common = set.intersection(*(set(scenarios(root)) for root in roots.values())) if roots else set()
    if not roots or set(named) - common:
        parser.error(f"{', '.join(sorted(set(named) - common)) or 'no checkout'}: not in every tree")
    with tempfile.TemporaryDirectory() as temporary:
        out = (options.out or Path(temporary)).resolve()
        print(f"| scenario | | outcomes | {' | '.join(COLUMNS)} | lowest, m |")
        print("|---" * (len(COLUMNS) + 4) + "|")
        for scenario in named or sorted(common):
            for place, (name, root) in enumerate(roots.items()):
                runs = fly(root, scenario, options.seeds, options.set, out / name / scenario)
                print(f"| {f'`{scenario}`' if place == 0 else ''} {row(name, runs)}", flush=True)


if __name__ == "__main__":
    main()
