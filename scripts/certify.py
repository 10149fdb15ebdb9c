"""Fly the sets of docs/certify.md, whole or in part, and judge them: python scripts/certify.py --out DIR [SET …].

    python scripts/certify.py --out output/certify                       all of every set (hours)
    python scripts/certify.py --out output/certify --resume              goes on where it was ended
    python scripts/certify.py healthy --sample 90 --out output/part      90 flights in which each level has its share
    python scripts/certify.py healthy --out output/certify --judge       judges what is there once more

Each set is flown into DIR/SET, rows in `runs.parquet`. With `--results docs/results` the verdict is written to
docs/results/SET.json with revision, seed, command and versions. Exit status 1 if something is not met.
"""

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from uavsim.files import write_json, write_text
from uavsim.interrupts import like_ctrl_c
from uavsim.score_keys import PHASES
from uavsim.studies.certify.record import ROWS, about, rows_in, run
from uavsim.studies.certify.results import read, refreshed
from uavsim.studies.certify.sets import SETS, Set
from uavsim.studies.certify.verdict import lines
from uavsim.studies.engine import engine, processes
from uavsim.views.certified import save_coverage

REPOSITORY = Path(__file__).resolve().parent.parent
RESULTS = REPOSITORY / "docs" / "results"
PAGE = REPOSITORY / "docs" / "certify.md"


def revision() -> str:
    """Return the revision that is checked out, with a + if files were changed since."""
    git = shutil.which("git")
    if git is None:
        return "unknown"
    commands = (["rev-parse", "--short=10", "HEAD"], ["status", "--porcelain", "--untracked-files=no"])
    try:
        head, changed = (
            subprocess.run([git, *command], cwd=REPOSITORY, capture_output=True, text=True, check=True).stdout.strip()
            for command in commands
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return head + ("+" if changed else "")


def flown(one: Set, options: argparse.Namespace) -> list[dict[str, Any]]:
    """Fly a set, or read what was flown."""
    folder = options.out / one.name
    if options.judge:
        if not (folder / ROWS).is_file():
            raise ValueError(f"{folder} holds no flights")
        return rows_in(folder)
    tasks = one.tasks(options.seed if options.seed is not None else one.seed, options.sample)
    started = time.monotonic()

    def tell(done: int, of: int) -> None:
        spent = time.monotonic() - started
        print(f"\r{one.name}: {done} of {of}, {spent:.0f} s ", end="", file=sys.stderr, flush=True)

    with engine(workers=processes(options.workers, len(tasks))) as crew:
        rows = run(folder, one.name, options.seed if options.seed is not None else one.seed, tasks, crew,
                   resume=options.resume, revision=revision(), progress=tell)  # fmt: skip
    print(file=sys.stderr)
    return rows


def certify(one: Set, options: argparse.Namespace) -> bool:
    """Fly, judge and print a set; return whether nothing is not met."""
    rows = flown(one, options)
    told = about(options.out / one.name)
    before = read(options.before, f"{one.name}-before") if options.before else None
    verdict = one.judge(rows, int(told["seed"]), before)
    print(f"\n{one.name}: {len(rows)} flights of seed {told['seed']}")
    print(*lines(verdict.checks), sep="\n")
    for bad in verdict.worst[: options.worst]:
        print("  ".join(str(value) for value in bad.values()))
    if "levels" in verdict.tables and f"{PHASES[0]}.coverage" in verdict.tables["levels"][0]:
        save_coverage(verdict.tables["levels"], options.out / one.name / "coverage.png")
    if options.results:
        result = {
            "set": one.name,
            "revision": told["revision"],
            "command": f"python scripts/certify.py {one.name} --seed {told['seed']}"
            + (f" --sample {len(rows)}" if len(rows) < one.size else ""),
            "seed": told["seed"],
            "flights": len(rows),
            "versions": told["versions"],
            **verdict.to_dict(),
        }
        options.results.mkdir(parents=True, exist_ok=True)
        write_json(options.results / f"{one.name}{options.suffix}.json", result)
    return not any(check.met is False for check in verdict.checks)


def write_docs(results: Path) -> None:
    """Write the tables of docs/certify.md anew."""
    write_text(PAGE, refreshed(PAGE.read_text(encoding="utf-8"), results))


def main() -> int:
    """Parse, fly, judge, print."""
    parser = argparse.ArgumentParser(description="Fly the sets of docs/certify.md and judge them.")
    parser.add_argument("sets", nargs="*", metavar="SET", help=", ".join(SETS))
    parser.add_argument("--out", type=Path, required=True, help="folder of the flights' rows")
    parser.add_argument("--sample", type=int, metavar="N", help="a part of each set; each level keeps its share")
    parser.add_argument("--seed", type=int, help="root seed instead of the set's own")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--resume", action="store_true", help="go on with what is in --out")
    parser.add_argument("--judge", action="store_true", help="fly nothing; judge what is in --out")
    parser.add_argument("--results", type=Path, help="folder to write the verdicts to, docs/results")
    parser.add_argument("--docs", action="store_true", help="write the tables of docs/certify.md anew at the end")
    parser.add_argument("--suffix", default="", help="of the name of a verdict's file")
    parser.add_argument("--before", type=Path, default=RESULTS, help="folder with the verdicts of the version before")
    parser.add_argument("--worst", type=int, default=12, help="how many flights to look at are printed")
    options = parser.parse_args()
    unknown = [name for name in options.sets if name not in SETS]
    if unknown:
        sys.exit(f"Error: unknown set {unknown[0]!r}; there are {', '.join(SETS)}")
    try:
        with like_ctrl_c():
            met = [certify(SETS[name], options) for name in options.sets or SETS]
        if options.docs:
            write_docs(options.results or RESULTS)
    except (ValueError, OSError) as error:
        sys.exit(f"Error: {error}")
    except KeyboardInterrupt:
        return 130
    return 0 if all(met) else 1


if __name__ == "__main__":
    sys.exit(main())
