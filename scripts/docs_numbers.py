"""Numbers of the documentation: each from the command that stands beside it.

A page has blocks

    <!-- numbers: NAME -->
    …
    <!-- end -->

`docs/numbers.toml` says for each name which commands are run and what is shown of them. This script runs them, keeps
what they gave in `docs/results/NAME.json` with the revision, the time and the versions, and writes the blocks anew:

    .venv/bin/python scripts/docs_numbers.py NAME…          these
    .venv/bin/python scripts/docs_numbers.py                all of them, some half an hour with --jobs 2
    .venv/bin/python scripts/docs_numbers.py --missing      those without a result, or with one of another command
    .venv/bin/python scripts/docs_numbers.py --pages        none: only the pages, from what is kept
    .venv/bin/python scripts/docs_numbers.py --tiny         all of them with a flight or two: whether each works
    .venv/bin/python scripts/docs_numbers.py --list         what there is, and about how long it takes

The cheapest come first, so that a run that is ended has most of them; `--jobs 2` runs two blocks at a time. Those that
measure time (`alone`) run before the others, with nothing beside them. `--missing` goes on where a run was ended.

`make test` holds every page against what is kept, what is kept against the commands of `docs/numbers.toml`, and runs
the blocks that say `quick` again. A block that has not been run says so.

Kinds of blocks, by what they have:

    rows, columns    a table, a row a command: flights of `uavsim fly … --seeds A-B` and what is asked of their scores
    command          what a command prints; `first` and `last` are patterns of the first and last line shown;
                     `fenced = false` where it prints Markdown
    figures          a table of what the tests of a file of tests/validation measured
"""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from time import monotonic
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
DECLARED = ROOT / "docs" / "numbers.toml"
RESULTS = ROOT / "docs" / "results"
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
BLOCK = re.compile(r"<!-- numbers: ([\w-]+) -->\n(.*?)<!-- end -->", re.DOTALL)
PACKAGES = ("uavsim", "jsbsim", "numpy", "numba")
NUMBER = re.compile(r"[-−]?\d+(?:\.\d+)?")
RUNS = {"uavsim": ("-m", "uavsim.cli"), "python": (), "pytest": ("-m", "pytest", "-n", "0")}
"""How the first word of a printed command is run with this interpreter."""
WIDTH = "100"  # characters of the terminal that commands print to
SHOWN = ("outcomes", "range", "median", "mean", "least", "greatest", "value")


@dataclass(frozen=True)
class Column:
    """What a table shows of some flights: `key` of the score, or two with - or / between them, by `show`."""

    head: str
    show: str = "range"
    key: str = ""
    factor: float = 1.0
    digits: int = 1

    def __post_init__(self) -> None:
        if self.show not in SHOWN:
            raise ValueError(f"show = {self.show!r}: must be one of {', '.join(SHOWN)}")


@dataclass(frozen=True)
class Block:
    """A block as it is declared.

    Attributes
    ----------
    name
        In its marker.
    command
        As it is printed; of a table `{}` stands for what differs from row to row.
    rows
        What stands for it, by the row's label; of one that has a command of its own that.
    columns
        Of a table.
    head
        Of its first column.
    first, last
        Patterns of the first and last line of what a command prints that are shown.
    fenced
        Whether that is shown as text, not as Markdown.
    figures
        File of tests whose figures are shown.
    whole
        Whether these tests fly all their seeds, `--whole`, and not the fixed part that `make validate` flies.
    minutes
        About how long it takes on two cores by itself.
    alone
        Whether it measures time, so that nothing may run beside it.
    quick
        Whether `make test` runs it again.
    """

    name: str
    command: str = ""
    rows: dict[str, str] = field(default_factory=dict)
    columns: tuple[Column, ...] = ()
    head: str = ""
    first: str = ""
    last: str = ""
    fenced: bool = True
    figures: str = ""
    whole: bool = False
    minutes: float = 1.0
    alone: bool = False
    quick: bool = False

    def commands(self) -> dict[str, str]:
        """What is run, by the row's label."""
        if self.figures:
            return {"": f"pytest -m slow{' --whole' if self.whole else ''} {self.figures}"}
        if not self.rows:
            return {"": self.command}
        return {label: self.command.replace("{}", own) if self.command else own for label, own in self.rows.items()}

    def printed(self) -> str:
        """The command as a page shows it."""
        if self.command:
            return f"`{self.command.replace('{}', '…')}`"
        if self.figures:
            return f"`{self.commands()['']}`"
        return "; ".join(f"`{one}`" for one in self.commands().values()) if len(self.rows) < 2 else ""


def declared() -> dict[str, Block]:
    """Return every block of `docs/numbers.toml`."""
    found = tomllib.loads(DECLARED.read_text(encoding="utf-8"))
    return {name: _block(name, values) for name, values in found.items()}


def _block(name: str, values: dict[str, Any]) -> Block:
    columns = tuple(Column(**one) for one in values.pop("columns", ()))
    rows = values.pop("rows", {})
    return Block(
        name, columns=columns, rows=rows if isinstance(rows, dict) else {f"`{one}`": one for one in rows}, **values
    )


# -- running ---------------------------------------------------------------------------------------------------------


def run(block: Block) -> dict[str, Any]:
    """Run a block's commands and return what is kept."""
    begun = monotonic()
    commands = block.commands()
    if block.figures:
        lines = _figures(block)
    elif block.rows:
        lines = _table(
            [block.head, *(one.head for one in block.columns)],
            [[label, *_cells(block.columns, command)] for label, command in commands.items()],
        )
    else:
        lines = _excerpt(block, _printed(commands[""]))
    return {
        "name": block.name,
        "commands": commands,
        "revision": revision(),
        "seconds": round(monotonic() - begun, 1),
        "versions": {name: version(name) for name in PACKAGES},
        "lines": lines,
    }


SMALL = {
    r"--seeds (\d+)-\d+": r"--seeds \1-2",
    r"--(flights|runs|hours) \d+": r"--\1 1",
    r"--trials \d+": "--trials 50",
    r"--cells [1-9]\d*": "--cells 20",
}
"""What is made smaller, by patterns, to see whether a block works."""


def small(command: str) -> str:
    """Return a command with a flight or two."""
    for pattern, smaller in SMALL.items():
        command = re.sub(pattern, smaller, command)
    return command


def tiny(block: Block) -> list[str]:
    """Run a block's commands with a flight or two, and return its lines; of a file of tests, only find them."""
    if block.figures:
        found = _run(block.commands()[""], "--collect-only", "-q")
        return [line for line in found.splitlines() if "::" in line]
    rows = dict(list(block.rows.items())[-1:])
    made = replace(block, command=small(block.command), rows={label: small(own) for label, own in rows.items()})
    lines: list[str] = run(made)["lines"]
    return lines


def revision() -> str:
    """Return the short hash of what is checked out, with + where files differ from it."""

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()  # noqa: S607

    changed = git("status", "--porcelain", "--untracked-files=no", "--", "uavsim", "sensors", "aircraft", "scripts")
    return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")


def _run(command: str, *more: str, **environment: str) -> str:
    """Run a printed command with this interpreter; an outcome that was not expected is one that may be shown."""
    first, *rest = shlex.split(command)
    done = subprocess.run(
        [sys.executable, *RUNS[first], *rest, *more],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": WIDTH, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{command}: exit status {done.returncode}: {done.stderr.strip()[-400:]}")
    return done.stdout


def _printed(command: str) -> str:
    if not command.startswith("uavsim"):
        return _run(command)
    with tempfile.TemporaryDirectory() as folder:
        writes = command.split()[1] in ("fly", "roc", "tune", "campaign", "sweep", "sensitivity", "verify", "paper")
        plain = ["--no-plots"] if command.split()[1] in ("fly", "roc") else []
        return _run(command, *plain, *(["--out", f"{folder}/out"] if writes else []))


def _excerpt(block: Block, text: str) -> list[str]:
    """Lines from the first that has one pattern to the first after it that has the other."""
    lines = [line.rstrip() for line in text.splitlines()]
    begin = next((i for i, line in enumerate(lines) if re.search(block.first, line)), 0) if block.first else 0
    end = len(lines)
    if block.last:
        end = next((i + 1 for i in range(begin, len(lines)) if re.search(block.last, lines[i])), len(lines))
    kept = lines[begin:end]
    while kept and not kept[-1].strip():
        kept.pop()
    while kept and (not kept[0].strip() or kept[0].startswith("written to")):
        kept.pop(0)
    return ["```text", *kept, "```"] if block.fenced else kept


def _cells(columns: Iterable[Column], command: str) -> list[str]:
    import pandas as pd

    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        _run(command, "--no-plots", "--out", str(out))
        if (out / "runs.parquet").exists():
            frame = pd.read_parquet(out / "runs.parquet")
        else:
            frame = pd.DataFrame([_flat(json.loads((out / "score.json").read_text(encoding="utf-8")))])
    return [_cell(one, frame) for one in columns]


def _flat(score: dict[str, Any], before: str = "") -> dict[str, Any]:
    row: dict[str, Any] = {}
    for key, value in score.items():
        row |= _flat(value, f"{before}{key}.") if isinstance(value, dict) else {f"{before}{key}": value}
    return row


def _cell(column: Column, frame: Any) -> str:
    if column.show == "outcomes":
        return ", ".join(f"{n} `{name}`" for name, n in Counter(frame["outcome"]).most_common())
    values = _values(column.key, frame) * column.factor
    there = values.dropna()
    if there.empty:
        return "–"
    text = {
        "range": lambda: " … ".join(_number(one, column.digits) for one in (there.min(), there.median(), there.max())),
        "median": lambda: _number(there.median(), column.digits),
        "mean": lambda: _number(there.mean(), column.digits),
        "least": lambda: _number(there.min(), column.digits),
        "greatest": lambda: _number(there.max(), column.digits),
        "value": lambda: _number(there.iloc[0], column.digits),
    }[column.show]()
    return text if len(there) == len(values) else f"{text} ({len(there)} of {len(values)})"


def _values(key: str, frame: Any) -> Any:
    import pandas as pd

    for sign in (" - ", " / "):
        if sign in key:
            a, b = (pd.to_numeric(frame[one]) for one in key.split(sign))
            return a - b if sign == " - " else a / b
    return pd.to_numeric(frame[key])


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace("-", "−")


def _table(heads: list[str], rows: list[list[str]]) -> list[str]:
    return [f"| {' | '.join(row)} |" for row in (heads, ["---"] * len(heads), *rows)]


def _figures(block: Block) -> list[str]:
    """What the tests of a file measured: least … median … greatest, and what is asked."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "figures.json"
        _run(block.commands()[""], UAVSIM_FIGURES=str(out))
        found = json.loads(out.read_text(encoding="utf-8"))
    return _table(list(FIGURE.values()), [[one[key] for key in FIGURE] for one in found])


FIGURE = {"check": "check", "label": "figure", "found": "measured", "size": "values", "asked": "asked"}


# -- pages -----------------------------------------------------------------------------------------------------------


def kept(name: str) -> dict[str, Any] | None:
    """Return what was kept of a block; None where it has not been run."""
    path = RESULTS / f"{name}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None


def inside(block: Block, result: dict[str, Any] | None) -> str:
    """What stands between a block's markers."""
    ask = f"python scripts/docs_numbers.py {block.name}"
    if result is None or result["commands"] != block.commands():
        return f"*Not run with this version yet; `{ask}` does.* {block.printed()}".rstrip() + "\n"
    by = block.printed() or f"`{ask}`"
    told = f"{by}, revision {result['revision']}:"
    return "\n".join([told, "", *result["lines"], ""])


def refreshed(page: str, blocks: dict[str, Block]) -> str:
    """Return a page with its blocks made of what is kept.

    Raises
    ------
    KeyError
        A block that is not declared.
    """

    def made(found: re.Match[str]) -> str:
        name = found[1]
        return f"<!-- numbers: {name} -->\n{inside(blocks[name], kept(name))}<!-- end -->"

    return BLOCK.sub(made, page)


def write_pages(blocks: dict[str, Block]) -> None:
    """Write the blocks of every page anew."""
    for path in PAGES:
        page = path.read_text(encoding="utf-8")
        new = refreshed(page, blocks)
        if new != page:
            path.write_text(new, encoding="utf-8")
            print(path.relative_to(ROOT))


def alike(a: Iterable[str], b: Iterable[str]) -> bool:
    """Whether lines say the same; numbers may differ by one in their last digit, as processors round differently."""
    one, other = "\n".join(a), "\n".join(b)
    if NUMBER.sub("#", one) != NUMBER.sub("#", other):
        return False
    return all(_close(x, y) for x, y in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True))


def _close(x: str, y: str) -> bool:
    digits = len(x.partition(".")[2])
    if digits != len(y.partition(".")[2]):
        return False
    return abs(float(x.replace("−", "-")) - float(y.replace("−", "-"))) <= 1.01 * 10.0**-digits


def write(result: dict[str, Any]) -> None:
    """Keep what a block's commands gave."""
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps(result, ensure_ascii=False, indent=1)
    (RESULTS / f"{result['name']}.json").write_text(text + "\n", encoding="utf-8")


def main() -> int:
    """Run what is asked for and write the pages."""
    parser = argparse.ArgumentParser(description="Numbers of the documentation, by the commands beside them.")
    parser.add_argument("names", nargs="*", help="blocks; all without it")
    parser.add_argument("--missing", action="store_true", help="those without a result of their command")
    parser.add_argument("--quick", action="store_true", help="those that make test runs again")
    parser.add_argument("--tiny", action="store_true", help="a flight or two of each; nothing is kept")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="blocks that run at a time")
    parser.add_argument("--pages", action="store_true", help="run none, write the pages")
    parser.add_argument("--list", action="store_true", help="what there is")
    options = parser.parse_args()
    blocks = declared()
    if unknown := [name for name in options.names if name not in blocks]:
        parser.error(f"no block is named {', '.join(unknown)}; there are {', '.join(blocks)}")
    chosen = [blocks[name] for name in options.names or blocks]
    if options.quick:
        chosen = [one for one in chosen if one.quick]
    if options.missing:
        chosen = [one for one in chosen if (found := kept(one.name)) is None or found["commands"] != one.commands()]
    if options.list:
        for one in chosen:
            print(f"{one.name}: about {one.minutes:g} min{', quick' if one.quick else ''}")
        return 0
    chosen.sort(key=lambda one: (not one.alone, one.minutes))
    if options.tiny:
        for one in chosen:
            begun = monotonic()
            print(f"{one.name}:", *(tiny(one) or ["nothing"]), f"{monotonic() - begun:.0f} s", sep="\n", flush=True)
        return 0
    if not options.pages:
        keep(chosen, max(1, options.jobs))
    write_pages(blocks)
    return 0


def keep(chosen: Iterable[Block], jobs: int) -> None:
    """Run blocks, so many at a time, and keep what each gave; of those that fail the first is raised at the end."""

    def one(block: Block) -> None:
        result = run(block)
        write(result)
        print(f"{block.name}: {result['seconds']:.0f} s", flush=True)

    blocks = list(chosen)
    print(f"{len(blocks)} blocks, about {sum(block.minutes for block in blocks):g} min", flush=True)
    for block in blocks:
        if block.alone:
            one(block)
    with ThreadPoolExecutor(jobs) as crew:
        running = [crew.submit(one, block) for block in blocks if not block.alone]
    for each in running:
        each.result()


if __name__ == "__main__":
    sys.exit(main())
