"""Fly the fault campaigns and print a table: python scripts/fault_campaign.py --flights 500 [CASE …].

Two processors fly some two flights a second. Without CASE all of them; `--csv DIR` writes a row a flight.
"""

import argparse
import csv
import sys
from dataclasses import asdict, fields
from pathlib import Path

from uavsim.studies.faults import CASES, FaultFlight, Summary, campaign, summarise

HEAD = "| case | flights | flagged in 2 s | delay, s: median, 99 %, longest | in 2 s of 2 m/s off | right port | "
HEAD += "missed | false | taken back | crashed | coverage | greatest error, m/s | the same of invalid ones, too |"


def row(name: str, s: Summary) -> str:
    """One line of the table."""
    faulty = CASES[name].where is not None
    low, high = s.interval(s.within if faulty else s.false)
    delays = ", ".join(f"{d:.2f}" for d in s.delays)
    cells = [name, str(s.flights)]
    if faulty:
        cells += [
            f"{s.within} ({100 * low:.1f} … {100 * high:.1f} %)",
            delays,
            str(s.seen),
            str(s.blamed),
            str(s.missed),
        ]
        cells += [str(s.false), str(s.recovered), str(s.crashed), f"{s.coverage:.3f}", f"{s.error:.2f}"]
        cells += [f"{s.told_coverage:.3f}, {s.told_error:.2f}"]
    else:
        cells += ["", "", "", "", "", f"{s.false} (at most {100 * high:.2f} %)", "", str(s.crashed), "", "", ""]
    return f"| {' | '.join(cells)} |"


def write(path: Path, flown: list[FaultFlight]) -> None:
    """Write a row a flight."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [f.name for f in fields(FaultFlight)])
        writer.writeheader()
        writer.writerows(asdict(f) for f in flown)


def main() -> None:
    """Parse, fly, print."""
    parser = argparse.ArgumentParser(description="Fly the fault campaigns.")
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(CASES))
    parser.add_argument("--flights", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1, help="of the first flight")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    print(HEAD, "|---" * 13 + "|", sep="\n")
    for name in options.cases or CASES:
        try:
            flown = campaign(
                name,
                options.flights,
                first_seed=options.seed,
                workers=options.workers,
                extra=tuple(options.set),
                progress=lambda share: print(f"\r{100 * share:.0f} %", end="\r", file=sys.stderr),
            )
        except ValueError as error:
            sys.exit(f"Error: {error}")
        if options.csv:
            write(options.csv / f"{name}.csv", flown)
        print(row(name, summarise(name, flown)), flush=True)


if __name__ == "__main__":
    main()
