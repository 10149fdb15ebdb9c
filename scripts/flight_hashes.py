"""Hash what the packaged scenarios give, so that two revisions can be compared bit for bit.

    python scripts/flight_hashes.py > before.txt      # at one revision
    python scripts/flight_hashes.py --against before.txt      # at another one, on the same machine and versions

Each line names scenario, seed and table, and holds the SHA-256 of the table's columns, of the events or of the score
without its versions. Exit status 1 if a line differs. Equal versions of the packages and equal processor features are
needed: floating point depends on both.
"""

import argparse
import hashlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd

import uavsim
from uavsim.scenario import packaged_names

WHO = ("versions", "plugins", "estimator")


def of_table(table: pd.DataFrame) -> str:
    """Hash names, types and bytes of a table's columns."""
    digest = hashlib.sha256()
    for name in table.columns:
        column = table[name]
        digest.update(f"{name} {column.dtype}\n".encode())
        numeric = column.dtype.kind in "biuf"
        digest.update(column.to_numpy().tobytes() if numeric else "\n".join(map(str, column)).encode())
    return digest.hexdigest()


def of_plain(value: object) -> str:
    """Hash plain nested values."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def judged(score: Any) -> Any:
    """Return a score without who flew, which one revision names and another does not."""
    if not isinstance(score, dict):
        return score
    return {name: judged(value) for name, value in score.items() if name not in WHO}


def hashes(names: list[str], seeds: list[int]) -> Iterator[tuple[str, str]]:
    """Yield a key, and the hash of what stands there, of each flight."""
    for name in names:
        for seed in seeds:
            flight = uavsim.fly(name, seed=seed)
            for table, frame in flight.tables.items():
                yield f"{name} {seed} {table}", of_table(frame)
            yield f"{name} {seed} events", of_plain(flight.events)
            yield f"{name} {seed} score", of_plain(judged(flight.score))


def main() -> int:
    """Print the hashes; with --against, compare them."""
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--against", type=Path, help="file of hashes to compare with")
    options.add_argument("--scenarios", nargs="+", default=packaged_names(), help="packaged names; all without it")
    options.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    given = options.parse_args()
    known = {}
    if given.against:
        lines = given.against.read_text(encoding="utf-8").splitlines()
        known = {key: value for key, _, value in (line.rpartition(" ") for line in lines)}
    different = 0
    for key, value in hashes(given.scenarios, given.seeds):
        if not given.against:
            print(key, value, flush=True)
        elif known.get(key) != value:
            different += 1
            print(f"{key}: {'differs' if key in known else 'is new'}", flush=True)
    if given.against:
        print(f"{different} of {len(known)} differ", flush=True)
    return int(different > 0)


if __name__ == "__main__":
    sys.exit(main())
