"""Integrity of the airspeed as a figure: python scripts/integrity.py --flights 60 --seed 5001 [--rates FILE].

Flies each class of faults of the file and, without a fault, each healthy scenario, then prints a table by class and the
totals. Two processors fly some two flights a second. docs/integrity.md says what the figures mean.
"""

import argparse
import sys
from pathlib import Path

from uavsim.studies.integrity import PACKAGED, Bounded, Integrity, read_rates, study

HEAD = "| fault | rate (stated) | flights | flagged | hazardous | P(hazard given the fault), 95 % | "
HEAD += "P(hazard) a flight, 95 % |"


def _three(value: Bounded) -> str:
    return f"{value.value:.2g} ({value.low:.2g} … {value.high:.2g})"


def table(found: Integrity) -> list[str]:
    """Lines of the table and of the totals, in Markdown."""
    lines = [HEAD, "|---" * 7 + "|"]
    for one in found.classes:
        per = "1/h" if one.fault.per == "hour" else "a flight"
        given = f"{one.given.value:.3f} ({one.given.low:.3f} … {one.given.high:.3f})"
        lines.append(
            f"| {one.fault.name} | {one.fault.rate:.2g} {per} | {one.flights} | {one.flagged} | {one.hazards} | "
            f"{given} | {_three(one.per_flight)} |"
        )
    lines += [
        "",
        f"Hazard by a fault: {_three(found.per_flight)} a flight of {found.rates.flight_hours:g} h, "
        f"{_three(found.per_hour)} per flight hour.",
        "",
        f"Without a fault, in {found.hours:.2f} h of flight:",
        "",
        "| event | count | per flight hour, 95 % |",
        "|---|---|---|",
    ]
    names = {"hazards": "hazard", "false_flags": "false flag", "losses": "loss of validity"}
    lines += [f"| {names[name]} | {found.counts[name]} | {_three(rate)} |" for name, rate in found.healthy.items()]
    return lines


def main() -> None:
    """Parse, fly, print."""
    parser = argparse.ArgumentParser(description="Fly faults and print how often a valid airspeed misleads.")
    parser.add_argument("--rates", type=Path, default=PACKAGED, help="fault rates, TOML")
    parser.add_argument("--flights", type=int, default=20, help="of each class and of each healthy scenario")
    parser.add_argument("--seed", type=int, default=1, help="of the first flight")
    parser.add_argument("--workers", type=int)
    options = parser.parse_args()
    try:
        found = study(
            read_rates(options.rates),
            options.flights,
            first_seed=options.seed,
            workers=options.workers,
            progress=lambda share: print(f"\r{100 * share:.0f} %", end="\r", file=sys.stderr),
        )
    except (ValueError, OSError) as error:
        sys.exit(f"Error: {error}")
    print(*table(found), sep="\n")


if __name__ == "__main__":
    main()
