"""Put small errors into the code, one at a time, and count how many the tests see.

    python scripts/mutants.py                        # 300 mutants, two workers: some half an hour
    python scripts/mutants.py --only rail --count 20 --workers 1
    python scripts/mutants.py --only rail --list     # what would be drawn; runs nothing

Where an error would lie to the user is in `mutation.strata`: each stratum is some files and the tests that are run
against an error in them, the quickest killers first. Every stratum gets the same number of mutants, drawn by the seed
without replacement; what is drawn of a stratum depends on the seed and its files alone.

A mutant changes one expression or statement:

    arithmetic      a + b → a − b, a · b → a / b, and back            sign        −a → a
    comparison      < → ≤ and back, < → >, == → !=                    boolean     and ↔ or, not a → a, True ↔ False
    constant        0 → 1, x → 1.1 x or 2 x, n → n + 1                side        "left" ↔ "right"
    function        min ↔ max, sin ↔ cos, any ↔ all, floor ↔ ceil     arguments   f(a, b) → f(b, a)
    statement       x += 1, self.x = 1 and calls are left out         condition   if a → if not a, b if c else a

Docstrings, annotations, messages (f-strings, what is raised), imports, asserts, `__slots__` and protocols stay.

Each runs in a copy of the tree of its worker's own, so that neither the user's tree nor another mutant is touched. The
tests run with `-x` and without xdist; a time of twice that of the sound code and ten seconds more counts as
killed. Compiled loops are compiled anew for each mutant of theirs. First the sound code runs: if its tests fail, there
is nothing to learn.

Printed are the mutants drawn, killed and alive of each stratum, the share killed with its Clopper-Pearson 95 %
interval, and the survivors with file, line and change. Of those that `mutation/explained.toml` lists, it prints why no
test can see them, or why none should; they count as alive all the same. Exit status: 0 if at least `--least` of them
are killed, 1 if not, 2 if something named here does not exist.

Why a tool of our own. Cosmic-ray and mutmut know one test command for all modules, rewrite one tree, and keep machine
code of compiled loops from one mutant to the next, as the file's time and size decide that; both draw without strata.
What is needed beside the drawing is a table of strata, and Python's `ast` gives the rest in few lines.
"""

import argparse
import json
import random
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from mutation.changes import Mutant, mutants_of
from mutation.report import survivors, table
from mutation.strata import ROOT, STRATA
from mutation.trial import Result, run


def drawn(stratum: str, count: int, seed: int) -> list[Mutant]:
    """Draw a stratum's mutants."""
    everywhere = []
    for file in STRATA[stratum][0]:
        everywhere += mutants_of(file, (ROOT / file).read_text(encoding="utf-8"))
    return random.Random(f"{seed} {stratum}").sample(everywhere, min(count, len(everywhere)))  # noqa: S311 - no secret


def missing(strata: list[str]) -> str:
    """Name the first file or test of some strata that does not exist; "" if all do."""
    named = ((name, path) for name in strata for paths in STRATA[name] for path in paths)
    lost = next(
        (f"{path} of the stratum {name!r}" for name, path in named if not (ROOT / path.partition("::")[0]).is_file()),
        "",
    )
    return lost and f"{lost} does not exist; scripts/mutation/strata.py names it"


def parsed() -> argparse.Namespace:
    """Return what was asked for; what is wrong ends the program with a line and status 2."""
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--count", type=int, default=300, help="mutants in all; each stratum gets the same number")
    options.add_argument("--only", nargs="+", metavar="STRATUM", default=list(STRATA), help=", ".join(STRATA))
    options.add_argument("--skip", type=int, default=0, help="mutants of each stratum that an earlier run has tried")
    options.add_argument("--workers", type=int, default=2)
    options.add_argument("--least", type=float, default=0.9, help="share killed below which the exit status is 1")
    options.add_argument("--out", type=Path, help="file of results, JSON")
    options.add_argument("--list", action="store_true", help="print what is drawn and run nothing")
    given = options.parse_args()
    unknown = [name for name in given.only if name not in STRATA]
    if unknown:
        problem = f"unknown stratum {unknown[0]!r}; there are {', '.join(STRATA)}"
    elif given.count < 1 or given.workers < 1 or given.skip < 0:
        problem = "--count and --workers must be at least 1, --skip at least 0"
    else:
        problem = missing(given.only)
    if problem:
        sys.stderr.write(f"Error: {problem}\n")
        sys.exit(2)
    return given


def written(path: Path, seed: int, results: list[Result]) -> None:
    """Write the results as JSON."""
    rows = [asdict(r.mutant) | {"stratum": r.stratum, "ended": r.ended, "seconds": r.seconds} for r in results]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"seed": seed, "mutants": rows}, indent=1) + "\n", encoding="utf-8")


def main() -> int:
    """Draw, run, tell."""
    given = parsed()
    each, more = divmod(given.count, len(given.only))
    counts = {name: given.skip + each + (i < more) for i, name in enumerate(given.only)}
    todo = [(name, m) for name, count in counts.items() for m in drawn(name, count, given.seed)[given.skip :]]
    if given.list:
        sys.stdout.writelines(f"{name}  {m.file}:{m.line}  {m.kind}  {m.what}\n" for name, m in todo)
        return 0
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        try:
            results = run(todo, given.workers, Path(folder))
        except RuntimeError as error:
            sys.stderr.write(f"Error: {error}\n")
            return 2
        except KeyboardInterrupt:  # while the sound code ran
            return 130
    results.sort(key=lambda r: (given.only.index(r.stratum), r.mutant.file, r.mutant.line))
    if results:
        sys.stdout.write(f"{table(results)}\n\nAlive:\n{survivors(results)}\n")
    if given.out:
        written(given.out, given.seed, results)
    if len(results) < len(todo):
        return 130
    return int(sum(r.killed for r in results) < given.least * len(results))


if __name__ == "__main__":
    sys.exit(main())
